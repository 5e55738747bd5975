/* redman/task.h: tasks of your own. Experimental. */
#ifndef REDMAN_TASK_H
#define REDMAN_TASK_H
#include <redman/robot.h>
#include <redman/object.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A task is a description and functions that the library calls: `build` for each pool that is made,
 * to make the scene of its worlds; the others in the resets and control steps of a world. Once
 * registered, its name works wherever that of a task of the library does: for pools and threads,
 * states, cameras and points, learners, checkpoints, the tool (--plugin).
 *
 *   static rdm_result build(void *user, rdm_scene *scene, void *instance) {
 *     struct ids *ids = instance;
 *     if (rdm_scene_add_body(scene, &cup, &ids->cup))
 *       return rdm_fail(RDM_ERROR_ARGUMENT, "the cup cannot be");
 *     ... }
 *   ...
 *   rdm_task_def d;  int32_t task;
 *   rdm_task_def_init(&d, sizeof d);
 *   d.name = "press";  d.build = build;  d.reset = reset; ...
 *   if (rdm_task_create(&task, &d)) puts(rdm_last_error());
 *   if (rdm_task_check("press", NULL, NULL, NULL, NULL, 0)) puts(rdm_last_error());  what it breaks
 *   config.task = "press"; ... rdm_pool_create(&p, &config) ...
 *
 * What the functions must promise, and rdm_task_check tests:
 *   - What they do depends only on the options, the world, its state and the random numbers that
 *     they are given: threads call them for many worlds at a time, and a saved world may continue
 *     elsewhere. Contacts and touches are those of the step just made and not part of a saved
 *     world: use them in judge and observe alone.
 *   - `build` may be called more often than pools are made (to ask for sizes).
 *   - State and instance are plain bytes, zeroed before reset and build. No pointers in a state.
 *   - A step leaves no allocated memory behind; pointers are not used after the call.
 *   - They return RDM_OK, or an error. An error of build is that of making the pool. An error of
 *     control, judge or observe ends the episode of its world: truncated, RDM_STATUS_TASK, reward
 *     and cost 0 in that step; the other worlds continue and the step returns RDM_OK.
 *     rdm_pool_world_error has the text of the call that failed in them, or of rdm_fail. A reset
 *     that fails within a step flags the world too, which then keeps showing its last end until a
 *     reset succeeds in a later step, with the random numbers that follow. A reset that fails
 *     within rdm_pool_reset is that call's error.
 *   - They must not leave by longjmp, which the library does not survive: a runtime whose errors do
 *     (Lua, Ruby, PHP) must catch them within the function and return an error. A C++ exception
 *     that leaves a function counts as an ARGUMENT; one that leaves `release` is logged.
 *   - They must not call functions on the handle that they are called for (STATE). */
typedef struct rdm_scene rdm_scene; /* handle, within build: what a world is made of */
typedef struct rdm_world rdm_world; /* handle, within a call of the others: one world */
/* Sets rdm_last_error of this thread to `text` and returns `code`. */
RDM_API rdm_result rdm_fail(rdm_result code, const char *text);

typedef struct rdm_body_def { /* a free body; its frame is at its centre of mass */
  uint32_t struct_size;    /* bytes */
  int32_t num_shapes;      /* count */
  const char *name;        /* unique among bodies and robots */
  const rdm_shape_def *shapes; /* [num_shapes] 1 or more */
  rdm_pose pose;           /* at the start */
  double mass;             /* kg */
  double moment[6];        /* xx yy zz xy xz yz, kg m2; all 0: of the shapes, solid, of one
                            * density */
  double linear_damping;   /* 1/s */
  double angular_damping;  /* 1/s; stands for rolling friction */
  int32_t weightless;      /* flag: feels no gravity */
  int32_t reserved;        /* 0 */
} rdm_body_def;
/* a robot in a scene: a registered one, or one of this scene alone (a drawer, a door) */
typedef struct rdm_scene_robot {
  uint32_t struct_size;    /* bytes, set by rdm_scene_robot_init */
  int32_t robot;           /* number from rdm_robot_find; default -1: not given */
  const rdm_robot_def *own; /* a robot of this scene alone, instead of `robot`; NULL: none */
  const char *name;        /* begins, with '_', the names of its links, joints and shapes; unique */
  const char *material;    /* of its shapes; NULL: "default" */
  rdm_pose pose;           /* of its base at the start */
  double base_damping;     /* damping of all links, 1/s; without a free base it has no
                            * effect */
  int32_t free_base;       /* flag: the base moves */
  int32_t left;            /* flag: the mirror image */
  int32_t gravity;         /* flag: its links feel gravity */
  int32_t filled;          /* flag, set by rdm_scene_robot_init; without it robot 0 counts as not
                            * given */
} rdm_scene_robot;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
 * version's. */
RDM_API rdm_result rdm_scene_robot_init(rdm_scene_robot *robot, size_t size);
/* rdm_pool_config.user of the pool that is being made; NULL where there is no config (rdm_task_at),
 * and for an invalid scene. */
RDM_API void *rdm_scene_user(const rdm_scene *scene);
/* what rdm_scene_find looks for; numbers count from 0 in the order of adding */
enum rdm_scene_part {
  RDM_SCENE_ROBOT = 0, RDM_SCENE_BODY = 1,
  RDM_SCENE_LINK = 2,   /* of all robots, robot by robot; joint i moves link i */
  RDM_SCENE_JOINT = 3,
  RDM_SCENE_SHAPE = 4,  /* as rdm_pool_shape_at: of robots, of bodies, then fixed ones */
  RDM_SCENE_SENSOR = 5, /* the link of a fingertip, for rdm_world_get_sensor */
  RDM_SCENE_MATERIAL = 6 /* "default" is 0 */
};
/* Value of the pool's option `key`: *value of a number, integer or flag, *text of a text.
 * NOT_FOUND, ARGUMENT. */
RDM_API rdm_result rdm_scene_get_number(rdm_scene *scene, const char *key, double *value);
RDM_API rdm_result rdm_scene_get_text(rdm_scene *scene, const char *key, const char **text);
/* Bounds *low and *high of a number or integer whose row takes a range (choices "a..b"), for reset
 * to draw from; equal: a number. */
RDM_API rdm_result rdm_scene_get_range(rdm_scene *scene, const char *key, double *low,
                                       double *high);
typedef struct rdm_contact_law { /* contacts of two materials, apart from their friction */
  uint32_t struct_size;    /* bytes, set by rdm_contact_law_init */
  int32_t pyramid;         /* flag, for soft contacts: pyramidal friction, MuJoCo's default, in
                            * which contacts are softer the more friction they have, and sliding
                            * lifts a body */
  double restitution;      /* 0 to 1: share of its closing speed with which a hard contact opens,
                            * where that is above 0.05 m/s */
  double torsional;        /* m, 0 to 10: rotation about the normal is opposed by at most this
                            * times the normal force */
  double rolling;          /* m, 0 to 10: rolling likewise */
  double time_constant;    /* s, up to 10: soft contacts by a spring and damper, as in MuJoCo's
                            * solref, of two substeps at least; 0: hard contacts */
  double damping_ratio;    /* of that spring, 0.01 to 100; default 1 */
  double impedance_min;    /* 1e-4 to 0.9999, at first touch, as in MuJoCo's solimp; default 0.9 */
  double impedance_max;    /* likewise, deeper than the width; default 0.95 */
  double impedance_width;  /* m, up to 10; default 0.001 */
} rdm_contact_law;
RDM_API rdm_result rdm_contact_law_init(rdm_contact_law *law,
                                        size_t size); /* defaults into the first `size` bytes */
enum rdm_friction { RDM_FRICTION_PASSES = -1 }; /* instead of a coefficient */
/* What is added gets the next number. A friction is that of two materials, or of one with itself; 1
 * unless set; RDM_FRICTION_PASSES: they pass through each other. gravity [3] replaces that of the
 * option. The texts of errors name the part; all of these are STATE after the first find, touch or
 * joint. When a scene cannot be completed at that call, or at the end of `build`, all later calls
 * on it and the making of the pool have that error. A robot that is given neither by `own` nor by
 * number is an ARGUMENT. */
RDM_API rdm_result rdm_scene_add_material(rdm_scene *scene,
                                          const char *name); /* "default" is one, 15 more */
RDM_API rdm_result rdm_scene_set_friction(rdm_scene *scene, const char *a, const char *b,
                                          double mu); /* 0 or more */
/* RANGE, ARGUMENT: the text names the field. Making the pool is UNSUPPORTED with engine=ode where a
 * law has more than a restitution. Sensors of fingertips measure the forces of such contacts, not
 * their torsional torques. */
RDM_API rdm_result rdm_scene_set_contact_law(rdm_scene *scene, const char *a, const char *b,
                                             const rdm_contact_law *law);
RDM_API rdm_result rdm_scene_set_gravity(rdm_scene *scene, const double gravity[3]); /* m/s2 */
RDM_API rdm_result rdm_scene_set_feedforward(rdm_scene *scene); /* allows
                                                                 * rdm_world_set_feedforward */
RDM_API rdm_result rdm_scene_set_adjustable(rdm_scene *scene); /* allows rdm_world_set_factors */
RDM_API rdm_result rdm_scene_add_robot(rdm_scene *scene, const rdm_scene_robot *robot,
                                       int32_t *index); /* index may be NULL */
RDM_API rdm_result rdm_scene_add_body(rdm_scene *scene, const rdm_body_def *body,
                                      int32_t *index); /* index may be NULL */
/* Adds an object as a free body with its centre of mass at `pose`, `scale` times as large (0.05 to
 * 20) and with the same mass; index may be NULL. The body and its first shape are called `name`,
 * further shapes name_1, name_2 ... The object's material is added to the scene if it is new: with
 * each material that is there it has the object's friction, with that of another object the lower
 * of the two. */
RDM_API rdm_result rdm_scene_add_object(rdm_scene *scene, int32_t object, const char *name,
                                        const rdm_pose *pose, double scale, int32_t *index);
RDM_API rdm_result rdm_scene_add_static(rdm_scene *scene,
                                        const rdm_shape_def *shape); /* a fixed shape */
/* For a task whose sizes depend on its options: sets another count for a field, in the order of
 * rdm_task_def.fields; or another count of actions, with hold [count] and mean [count] as in
 * rdm_task_def (NULL: 0). */
RDM_API rdm_result rdm_scene_set_field(rdm_scene *scene, const char *field, size_t count);
RDM_API rdm_result rdm_scene_set_actions(rdm_scene *scene, size_t count, const float *hold,
                                         const float *mean);
/* These read the scene, which the first of them completes: nothing can be added afterwards. */
RDM_API rdm_result rdm_scene_find(rdm_scene *scene, int32_t part, const char *name,
                                  int32_t *index); /* NOT_FOUND: nearest */
RDM_API rdm_result rdm_scene_joint_at(rdm_scene *scene, int32_t i,
                                      rdm_joint_info *io); /* of all robots, robot by robot */
/* Makes *group, for rdm_world_get_touch: all contacts of a shape of `a` with one of `b`; each is
 * the name of a shape, body or robot, or a pattern of such names with '*' and '?'. NOT_FOUND where
 * nothing matches. */
RDM_API rdm_result rdm_scene_add_touch(rdm_scene *scene, const char *a, const char *b,
                                       int32_t *group);

/* The number of the world in its pool, from 0; -1 where rdm_task_check tries a world alone, and for
 * an invalid world. */
RDM_API int32_t rdm_world_number(const rdm_world *world);
/* rdm_pool_config.user of the world's pool, also after it read states or copied worlds of other
 * pools. It is for what is outside of the world (a viewer, a log): what happens in the world must
 * depend neither on it nor on the number. NULL for an invalid world. */
RDM_API void *rdm_world_user(const rdm_world *world);
/* the joints of all robots of a world; the addresses are valid during the call */
typedef struct rdm_joints {
  uint32_t struct_size;    /* in: bytes */
  int32_t count;           /* of joints */
  double control_dt;       /* s of a control step */
  const double *q;         /* [count] rad (m) */
  const double *qd;        /* [count] rad/s (m/s) */
  const double *target;    /* [count] targets of the drives, rad (m) */
  const double *torque;    /* [count] of the drives, mean over the step, N m (N) */
} rdm_joints;
typedef struct rdm_motion { /* frozen layout: of a frame, in the world */
  rdm_pose pose;           /* where it is */
  double v[3];             /* velocity of the frame's origin, m/s */
  double w[3];             /* angular velocity, world axes, rad/s */
} rdm_motion;
/* Indices are those of the scene. RANGE for one that does not exist, ARGUMENT for numbers that are
 * not finite or that no world can have; the world is as before then. In observe nothing can be set:
 * STATE. */
RDM_API rdm_result rdm_world_get_joints(const rdm_world *world, rdm_joints *io); /* fills io */
RDM_API rdm_result rdm_world_get_link(const rdm_world *world, int32_t link,
                                      rdm_motion *out); /* of its joint's frame */
RDM_API rdm_result rdm_world_get_base(const rdm_world *world, int32_t robot,
                                      rdm_motion *out); /* of its base */
RDM_API rdm_result rdm_world_get_body(const rdm_world *world, int32_t body,
                                      rdm_motion *out); /* of its centre of mass */
RDM_API rdm_result rdm_world_get_shape(const rdm_world *world, int32_t shape,
                                       rdm_pose *out); /* of its frame */
/* Contact force [3] (N) and torque [3] (N m) on a fingertip, mean over the step, in the link's
 * frame, about its origin. */
RDM_API rdm_result rdm_world_get_sensor(const rdm_world *world, int32_t sensor, double force[3],
                                        double torque[3]);
/* *pairs is how many pairs of a group's shapes touched in the step, *force (N) the sum of the
 * group's contact forces in its last substep. Either may be NULL. */
RDM_API rdm_result rdm_world_get_touch(const rdm_world *world, int32_t group, int32_t *pairs,
                                       double *force);
/* Writes up to capacity contacts of the last substep to out [capacity]; *count is how many there
 * are. Contacts of sleeping bodies are those of the moment when they fell asleep. */
RDM_API rdm_result rdm_world_get_contacts(const rdm_world *world, rdm_contact *out,
                                          size_t capacity, size_t *count);
/* Writes to *depth (m) how deep a body, where it is now, is inside something that it can touch; 0:
 * it is free. */
RDM_API rdm_result rdm_world_get_overlap(rdm_world *world, int32_t body, double *depth);
/* Place a free body or a free base; or set joints q [n] and velocities qd [n] (NULL: 0) of a robot
 * of n joints, clipped to their ranges, and with them the targets of its drives. */
RDM_API rdm_result rdm_world_set_body(rdm_world *world, int32_t body, const rdm_motion *motion);
RDM_API rdm_result rdm_world_set_base(rdm_world *world, int32_t robot,
                                      const rdm_motion *motion); /* STATE: it is fixed */
RDM_API rdm_result rdm_world_set_joints(rdm_world *world, int32_t robot, const double *q,
                                        const double *qd, size_t n); /* all n */
/* Set the targets of drives: targets [n] (rad, m) of the joints from `first` on; or commands [n],
 * clipped to [-1, 1], all n of a robot, which its description turns into targets (by ranges or
 * curves, no faster than its joints' velocity). */
RDM_API rdm_result rdm_world_set_targets(rdm_world *world, int32_t first, const double *targets,
                                         size_t n);
RDM_API rdm_result rdm_world_set_commands(rdm_world *world, int32_t robot, const double *commands,
                                          size_t n);
/* Adds efforts [n] (N m, N) to those of the drives from `first` on, until they are set again; STATE
 * unless the scene allows it (rdm_scene_set_feedforward). rdm_world_get_gravity gives the efforts
 * that hold a robot of n joints against gravity where it is. */
RDM_API rdm_result rdm_world_set_feedforward(rdm_world *world, int32_t first, const double *efforts,
                                             size_t n);
RDM_API rdm_result rdm_world_get_gravity(const rdm_world *world, int32_t robot, double *efforts,
                                         size_t n);
enum rdm_scale { /* what a factor scales, and in brackets its bounds */
  RDM_SCALE_GRAVITY = 0,        /* [-10, 10] */
  RDM_SCALE_LINK_MASS = 1,      /* [0.001, 1000], moments with it; index: link */
/* [0, 1000] */
  RDM_SCALE_LINK_KP = 2, RDM_SCALE_LINK_KD = 3, RDM_SCALE_LINK_EFFORT = 4,
  RDM_SCALE_LINK_FRICTION = 5,
  RDM_SCALE_BASE_MASS = 6,      /* [0.001, 1000] of a free base; index: robot */
  RDM_SCALE_BASE_DAMPING = 7,   /* [0, 1000] of all links of a robot with a free base */
  RDM_SCALE_BODY_MASS = 8,      /* [0.001, 1000], moments with it; index: body */
  RDM_SCALE_BODY_SIZE = 9,      /* [0.05, 20] of all its shapes, moments with the square */
  RDM_SCALE_BODY_LINEAR_DAMPING = 10, RDM_SCALE_BODY_ANGULAR_DAMPING = 11, /* [0, 1000] */
  RDM_SCALE_FRICTION = 12       /* [0, 1000] of two materials, index and other */
};
typedef struct rdm_factor { /* frozen layout: scales a constant of the scene in one world */
  int32_t what;            /* RDM_SCALE_* */
  int32_t index;           /* of the link, robot or body, or the first material */
  int32_t other;           /* the second material of a friction */
  int32_t reserved;        /* 0 */
  double factor;           /* times the scene's value */
} rdm_factor;
/* Sets factors [count] of the world, and keeps its others; all are 1 at the start of an episode,
 * and reset may draw some. On an error none is set. STATE unless the scene allows it
 * (rdm_scene_set_adjustable). */
RDM_API rdm_result rdm_world_set_factors(rdm_world *world, const rdm_factor *factors, size_t count);
/* Push a body, a base or a link during the next step: force [3] (N, world axes) at the centre of
 * mass, of a link at `point` [3] (m), and torque [3] (N m). */
RDM_API rdm_result rdm_world_push_body(rdm_world *world, int32_t body, const double force[3],
                                       const double torque[3]);
RDM_API rdm_result rdm_world_push_base(rdm_world *world, int32_t robot, const double force[3],
                                       const double torque[3]);
RDM_API rdm_result rdm_world_push_link(rdm_world *world, int32_t link, const double force[3],
                                       const double point[3]);

enum rdm_quantity { /* a quantity of worlds, and how many doubles it has */
  RDM_QUANTITY_Q = 0,          /* 1: coordinate of a joint, rad (m) */
  RDM_QUANTITY_QD = 1,         /* 1: its velocity, rad/s (m/s) */
  RDM_QUANTITY_TARGET = 2,     /* 1: target of its drive; can be set */
  RDM_QUANTITY_TORQUE = 3,     /* 1: torque of its drive, mean over the step, N m (N) */
  RDM_QUANTITY_LINK = 4,       /* 13: p, q, v, w as rdm_motion */
  RDM_QUANTITY_BASE = 5,       /* 13: likewise, of a robot; can be set where it is free */
  RDM_QUANTITY_BODY = 6,       /* 13: likewise; can be set */
  RDM_QUANTITY_SHAPE = 7,      /* 7: p, q */
  RDM_QUANTITY_SENSOR = 8,     /* 6: force, torque as rdm_world_get_sensor */
  RDM_QUANTITY_TOUCH = 9,      /* 2: pairs and force as rdm_world_get_touch */
/* can only be set */
  RDM_QUANTITY_JOINT = 10,     /* 2: coordinate and velocity; all joints of robot `first` */
  RDM_QUANTITY_COMMAND = 11,   /* 1: in [-1, 1]; all commands of one robot, whose number is
                                * `first` */
  RDM_QUANTITY_FEEDFORWARD = 12, /* 1: effort of a joint, N m (N) */
  RDM_QUANTITY_BODY_PUSH = 13, /* 6: force and torque as rdm_world_push_body */
  RDM_QUANTITY_BASE_PUSH = 14, /* 6: as rdm_world_push_base */
  RDM_QUANTITY_LINK_PUSH = 15  /* 6: force and point as rdm_world_push_link */
};
/* Gets or sets quantity `what` of items first to first + count - 1 in each of n worlds, in x
 * [n][count][width], where width is the number of doubles of one. Setting does what the function
 * for one world does, row by row: on an error, the rows before it are set, or written. At most
 * 65536 worlds and 4096 items. RANGE for items that the scene does not have, and for a count that
 * is not that of items which are only set together. */
RDM_API rdm_result rdm_world_get_many(rdm_world **worlds, size_t n, int32_t what,
                                      int32_t first, size_t count, double *x);
RDM_API rdm_result rdm_world_set_many(rdm_world **worlds, size_t n, int32_t what,
                                      int32_t first, size_t count, const double *x);

typedef struct rdm_random { /* frozen layout: a stream of random numbers; may be part of a state */
  uint64_t seed;           /* with world and purpose: which stream it is */
  uint64_t counter;        /* draws so far */
  uint32_t world;          /* likewise */
  uint32_t purpose;        /* likewise */
} rdm_random;
/* Draw from the stream; 0 if random is NULL. The same numbers on every machine. */
RDM_API uint64_t rdm_random_bits(rdm_random *random);
RDM_API double rdm_random_uniform(rdm_random *random, double low,
                                  double high); /* in [low, high), up to rounding */
RDM_API double rdm_random_normal(rdm_random *random); /* mean 0, deviation 1 */
/* Makes another stream *out for draws within an episode: call it in reset and keep the stream in
 * the state. */
RDM_API rdm_result rdm_random_split(rdm_random *random, rdm_random *out);
/* Writes the rotation by `angle` (rad) about the unit vector axis [3] to q [4]: the same bits on
 * every machine, which those from a C library's sine are not. */
RDM_API rdm_result rdm_rotation(const double axis[3], double angle, double q[4]);

typedef struct rdm_verdict { /* frozen layout: what judge fills; zeroed before */
  double reward;           /* of the step */
  double cost[RDM_MAX_COSTS];     /* each column of the step, 0 or more */
  double cost_raw[RDM_MAX_COSTS]; /* the measured value behind each */
  int32_t terminated;      /* flag: the episode ends here */
  int32_t success;         /* flag */
} rdm_verdict;
/* what a function for many worlds is called with; row i belongs to worlds[i] */
typedef struct rdm_task_rows {
  uint32_t struct_size;    /* bytes */
  int32_t count;           /* of worlds, 1 to 256 */
  rdm_world **worlds;      /* [count] in the order of their numbers */
  void *states;            /* [count][state_bytes] copies of the states, written back where the
                            * function may change them; NULL with state_bytes 0 */
  rdm_result *results;     /* [count] RDM_OK; any other code makes that world alone fail */
  rdm_random *randoms;     /* [count] reset: as its `random` */
  const float *actions;    /* [count][action_dim] control */
  const int32_t *steps;    /* [count] judge: control steps of the episode, from 1 */
  rdm_verdict *verdicts;   /* [count] judge: zeroed before */
  float *obs;              /* [count][obs_dim] observe: all fields */
} rdm_task_rows;
typedef struct rdm_field_def { /* frozen layout: a run of observation entries */
  const char *name;        /* unique, at most 31 characters: "cup.position" */
  const char *unit;        /* what an entry of 1 stands for: "m", "5 rad/s", "1" */
  int32_t count;           /* entries */
  float low;               /* lower bound of the entries; low equal to high: no bounds but
                            * obs_limit */
  float high;              /* likewise */
  int32_t reserved;        /* 0 */
} rdm_field_def;
typedef struct rdm_cost_def { /* frozen layout: a cost column */
  const char *name;        /* unique: "touch" */
  const char *help;        /* one line */
  double limit;            /* default limit on the sum over an episode; < 0: none */
} rdm_cost_def;
typedef struct rdm_option_def { /* frozen layout: one row of an option table, as rdm_option_spec */
  const char *key;         /* letters, digits, '_', '-', '.' */
  const char *help;        /* one line, with the unit; unused for an option that every task has */
  const char *text;        /* default of a text option, or of a number whose default is a range;
                            * else NULL */
  const char *choices;     /* text: the allowed words "a|b|c", NULL: any text; number, integer:
                            * "a..b" where a range is allowed too; else NULL */
  double number;           /* default of a number, integer or flag; for a range, its middle */
  double low, high;        /* inclusive bounds */
  int32_t kind;            /* RDM_KIND_NUMBER, RDM_KIND_INTEGER, RDM_KIND_FLAG, RDM_KIND_TEXT */
  int32_t live;            /* unused */
} rdm_option_def;
typedef struct rdm_camera_def { /* frozen layout: a pinhole camera, as rdm_camera_info */
  const char *name;        /* unique: "front" */
  float eye[3];            /* m, in the frame that mount names */
  float target[3];         /* m, likewise; the optical axis runs from eye to target */
  float fov_y;             /* vertical field of view, rad, 0.01 to 3 */
  int32_t mount;           /* 0: the world's frame; k > 0: of link k - 1; -k: of base k - 1 */
  float up[3];             /* likewise: what points up in the picture; all 0: z */
  float cx;                /* where the optical axis meets the picture: to the right of its centre,
                            * as a share of its width, within +-10 */
  float cy;                /* likewise: below its centre, as a share of its height */
  int32_t reserved;        /* 0 */
} rdm_camera_def;
typedef struct rdm_task_def { /* a whole task; all but `user` is copied by rdm_task_create */
  uint32_t struct_size;    /* bytes, set by rdm_task_def_init */
  int32_t max_steps;       /* control steps of an episode: default of the option max_steps, 1
                            * to 100000; default 100 */
  const char *name;        /* letters, digits, '_', '-', '.'; at most 40 */
  const char *summary;     /* one line; NULL: none */
  const rdm_field_def *fields;     /* [num_fields] of an observation, in order */
  const rdm_cost_def *costs;       /* [num_costs] column 0 is the task's; learners keep limits */
  const rdm_option_def *options;   /* [num_options] rows, and defaults of its own for those that
                                    * every task has */
  const rdm_camera_def *cameras;   /* [num_cameras] NULL with num_cameras 0: one called "front",
                                    * which looks at the origin */
  const rdm_option *defaults;      /* [num_defaults] of agent options; NULL with num_defaults 0 */
  int32_t num_fields;      /* 1 or more */
  int32_t num_costs;       /* 1 to RDM_MAX_COSTS */
  int32_t num_options;     /* count */
  int32_t num_cameras;     /* count */
  int32_t num_defaults;    /* count */
  int32_t action_dim;      /* 1 to 1024 */
  const float *hold;       /* [action_dim] the action that keeps robots still; NULL: 0 */
  const float *mean;       /* [action_dim] mean action of a new policy; NULL: 0 */
  const char *action_order;        /* what the entries are, for the layout hash; NULL: "action" */
  double obs_limit;        /* every observation entry is clipped to +- this; 0: no limit */
  uint64_t state_bytes;    /* size of a world's own state, up to 2^20 */
  uint64_t instance_bytes; /* size of what build leaves for the other functions, up to 2^24 */
  void *user;              /* passed to all; may be NULL */
  /* makes the scene, and the constants of this pool. Required */
  rdm_result (*build)(void *user, rdm_scene *scene, void *instance);
  /* starts an episode; the world is as it was built. Required */
  rdm_result (*reset)(void *user, const void *instance, rdm_world *world, void *state,
              rdm_random *random);
  /* before a step: from the clipped action to targets and pushes. Required */
  rdm_result (*control)(void *user, const void *instance, rdm_world *world, void *state,
              const float *action);
  /* after a step, `step` counts from 1: reward, costs and the end. Required */
  rdm_result (*judge)(void *user, const void *instance, rdm_world *world, void *state, int32_t step,
              rdm_verdict *out);
  /* writes all entries of the observation, after reset and after judge. Required */
  rdm_result (*observe)(void *user, const void *instance, const rdm_world *world, const void *state,
              float *obs);
  /* returns FORMAT for a saved state that no world can have: indices out of range, numbers that are
   * not finite. NULL: all are accepted */
  rdm_result (*check_state)(void *user, const void *instance, const void *state);
  /* called once, after the task and its last pool were destroyed. NULL: none */
  void (*release)(void *user);
  /* For many worlds at once, instead of the functions above; NULL: none. Where one is given, the
   * function for one world may be NULL. A pool calls them on the thread that called it, for up to
   * 256 worlds together, between two steps of its engine, so that a runtime is entered once a step
   * and not once a world. A row must depend on its own world alone, which rdm_task_check tests.
   * What they return is the result of all rows */
  rdm_result (*reset_many)(void *user, const void *instance, const rdm_task_rows *rows);
  /* as reset_many, instead of control */
  rdm_result (*control_many)(void *user, const void *instance, const rdm_task_rows *rows);
  /* as reset_many, instead of judge */
  rdm_result (*judge_many)(void *user, const void *instance, const rdm_task_rows *rows);
  /* as reset_many, instead of observe */
  rdm_result (*observe_many)(void *user, const void *instance, const rdm_task_rows *rows);
} rdm_task_def;
RDM_API rdm_result rdm_task_def_init(rdm_task_def *def,
                                     size_t size); /* defaults into the first `size` bytes */
/* Adds a task and writes its number to *out, for rdm_task_at and the like. ARGUMENT, RANGE: the
 * text names the row; ARGUMENT for a name that is already used. Tasks belong to the process; any
 * number of threads may read them meanwhile. */
RDM_API rdm_result rdm_task_create(int32_t *out, const rdm_task_def *def);
/* Pools that have it keep it. ARGUMENT for the library's own. */
RDM_API rdm_result rdm_task_destroy(int32_t task);
/* Tests what a task must promise, for any task: the same bytes for the same seed, with any number
 * of threads and after save and restore; rows within their fields and bounds; costs of 0 or more;
 * nothing written past a state or a row; no memory left behind. Returns OK, or the error of making
 * a pool, or ARGUMENT: the text names the function, the step and the entry of the first broken
 * promise, and is also written to error [error_size] (may be NULL). `settings` as in
 * rdm_pool_config; NULL: none. It takes seconds: `stop` (NULL: never) is called with `user` before
 * every step of its worlds, and ends it with CANCELLED; nothing is left behind then. */
RDM_API rdm_result rdm_task_check(const char *task, const char *settings, rdm_stop stop, void *user,
                                  char *error, size_t error_size);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_TASK_H */
