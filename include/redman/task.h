/* redman/task.h: tasks of your own. Experimental. */
#ifndef REDMAN_TASK_H
#define REDMAN_TASK_H
#include <redman/robot.h>
#include <redman/object.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A task is a description and functions that the library calls: `build` for each pool that is made,
 * to make the scene of its worlds; the others in the resets and control steps of a world.
 * Registered, it is a task like the library's own for all that takes one by name: pools and
 * threads, states, cameras and points, learners, checkpoints, the tool (--plugin).
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
 * What the functions promise, and rdm_task_check tries:
 *   - What happens follows from the options, the world, its state and the random numbers that are
 *     given, alone: threads call them for many worlds at a time, and a world that was saved
 *     continues elsewhere. Contacts and touches are those of the step just made, and no part of a
 *     saved world: they are for judge and observe.
 *   - `build` may be called more often than pools are made (to ask for sizes).
 *   - State and instance are plain bytes, zeroed before reset and build. No pointers in a state.
 *   - No memory is left behind by a step; nothing is kept of a pointer after the call.
 *   - They return RDM_OK, or an error. One of build is that of making the pool. One of control,
 *     judge or observe ends the episode of its world: truncated, RDM_STATUS_TASK, reward and cost 0
 *     in that step; the other worlds continue and the step returns RDM_OK. rdm_pool_world_error has
 *     the text of the call that failed in them, or of rdm_fail. A reset that fails within a step
 *     flags the world too, which shows the end that it had until one succeeds in a later step, with
 *     the draws that follow; one within rdm_pool_reset is that call's error.
 *   - They do not leave by longjmp, which nothing here survives: a runtime whose errors do (Lua,
 *     Ruby, PHP) catches them within the function and returns an error. An exception of C++ that
 *     comes out counts as an ARGUMENT, out of `release` it goes to the log.
 *   - They do not call the handle that they are called for (STATE). */
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
/* a robot in a scene: one of the list, or a tree of its own (a drawer, a door) */
typedef struct rdm_scene_robot {
  uint32_t struct_size;    /* bytes, set by rdm_scene_robot_init */
  int32_t robot;           /* of rdm_robot_find; default -1: left out */
  const rdm_robot_def *own; /* a robot of this scene alone, in the place of `robot`; NULL */
  const char *name;        /* begins, with '_', the names of its links, joints and shapes; unique */
  const char *material;    /* of its shapes; NULL: "default" */
  rdm_pose pose;           /* of its base at the start */
  double base_damping;     /* of a free base: of all links, 1/s */
  int32_t free_base;       /* flag: the base moves */
  int32_t left;            /* flag: the mirror image */
  int32_t gravity;         /* flag: its links feel gravity */
  int32_t filled;          /* flag, set by rdm_scene_robot_init: without it a robot of 0 was left
                            * out */
} rdm_scene_robot;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
 * version's. */
RDM_API rdm_result rdm_scene_robot_init(rdm_scene_robot *robot, size_t size);
/* rdm_pool_config.user of the pool that is made, NULL where a task is asked about without a config
 * (rdm_task_at); NULL of a scene that is none. */
RDM_API void *rdm_scene_user(const rdm_scene *scene);
/* what rdm_scene_find looks for; numbers count from 0 in the order of adding */
enum rdm_scene_part {
  RDM_SCENE_ROBOT = 0, RDM_SCENE_BODY = 1,
  RDM_SCENE_LINK = 2,   /* of all robots, robot by robot; joint i moves link i */
  RDM_SCENE_JOINT = 3,
  RDM_SCENE_SHAPE = 4,  /* as rdm_pool_shape_at: robots, bodies, those that stand still */
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
typedef struct rdm_contact_law { /* how two materials meet beside their friction */
  uint32_t struct_size;    /* bytes, set by rdm_contact_law_init */
  int32_t pyramid;         /* flag, of soft contacts: friction by edges, as MuJoCo has it by
                            * default: the softer the more it rubs, and sliding lifts */
  double restitution;      /* 0 to 1: share of the speed at which a hard contact closed, above
                            * 0.05 m/s, that it parts with */
  double torsional;        /* m, 0 to 10: rotation about the normal is opposed by at most this
                            * times the normal force */
  double rolling;          /* m, 0 to 10: rolling likewise */
  double time_constant;    /* s, to 10: a spring and damper, as MuJoCo's solref; 0: hard. At
                            * least two substeps count */
  double damping_ratio;    /* of it, 0.01 to 100; default 1 */
  double impedance_min;    /* 1e-4 to 0.9999, of a touch, as MuJoCo's solimp; default 0.9 */
  double impedance_max;    /* likewise, deeper than the width; default 0.95 */
  double impedance_width;  /* m, to 10; default 0.001 */
} rdm_contact_law;
RDM_API rdm_result rdm_contact_law_init(rdm_contact_law *law,
                                        size_t size); /* defaults into the first `size` bytes */
enum rdm_friction { RDM_FRICTION_PASSES = -1 }; /* in the place of a coefficient */
/* What is added gets the next number. A friction is that of two materials, or of one with itself; 1
 * unless set; RDM_FRICTION_PASSES: they go through each other. Gravity [3] is in the place of the
 * option's. The texts of errors name the part; all is STATE after the first find, touch or joint.
 * A scene that could not be completed there, or in the end, stays so: all later calls on it, and
 * what `build` is called for, have that error. A robot that is neither `own` nor given by number is
 * an ARGUMENT. */
RDM_API rdm_result rdm_scene_add_material(rdm_scene *scene,
                                          const char *name); /* "default" is one, 15 more */
RDM_API rdm_result rdm_scene_set_friction(rdm_scene *scene, const char *a, const char *b,
                                          double mu); /* 0 or more */
/* RANGE, ARGUMENT: the text names the field. Making the pool is UNSUPPORTED with engine=ode where a
 * law has more than a restitution. Fingertips feel the forces of such contacts, not their
 * torsional torques. */
RDM_API rdm_result rdm_scene_set_contact_law(rdm_scene *scene, const char *a, const char *b,
                                             const rdm_contact_law *law);
RDM_API rdm_result rdm_scene_set_gravity(rdm_scene *scene, const double gravity[3]); /* m/s2 */
RDM_API rdm_result rdm_scene_set_feedforward(rdm_scene *scene); /* worlds take
                                                                 * rdm_world_set_feedforward */
RDM_API rdm_result rdm_scene_set_adjustable(rdm_scene *scene); /* worlds take
                                                                * rdm_world_set_factors */
RDM_API rdm_result rdm_scene_add_robot(rdm_scene *scene, const rdm_scene_robot *robot,
                                       int32_t *index); /* index: NULL */
RDM_API rdm_result rdm_scene_add_body(rdm_scene *scene, const rdm_body_def *body,
                                      int32_t *index); /* index: NULL */
/* An object whose centre of mass has that pose, as the body and first shape `name` (others: name_1,
 * name_2 ...), `scale` times as large, 0.05 to 20, its mass as it is; index: NULL. Its material is
 * one of the scene: a new one rubs on each that is there with the object's friction, on another
 * object's with the lower of the two. */
RDM_API rdm_result rdm_scene_add_object(rdm_scene *scene, int32_t object, const char *name,
                                        const rdm_pose *pose, double scale, int32_t *index);
RDM_API rdm_result rdm_scene_add_static(rdm_scene *scene,
                                        const rdm_shape_def *shape); /* stands still */
/* For a task whose numbers follow from its options: another count for a field, in the order of
 * rdm_task_def.fields; another count of actions, with hold [count] and mean [count] as in
 * rdm_task_def (NULL: 0). */
RDM_API rdm_result rdm_scene_set_field(rdm_scene *scene, const char *field, size_t count);
RDM_API rdm_result rdm_scene_set_actions(rdm_scene *scene, size_t count, const float *hold,
                                         const float *mean);
/* These look at the scene as a whole, which is complete from the first of them on. */
RDM_API rdm_result rdm_scene_find(rdm_scene *scene, int32_t part, const char *name,
                                  int32_t *index); /* NOT_FOUND: nearest */
RDM_API rdm_result rdm_scene_joint_at(rdm_scene *scene, int32_t i,
                                      rdm_joint_info *io); /* of all robots, robot by robot */
/* *group, for rdm_world_get_touch: all contacts of a shape of `a` with one of `b`, each the name of
 * a shape, body or robot, or a pattern of such names with '*' and '?'. NOT_FOUND where nothing has
 * it. */
RDM_API rdm_result rdm_scene_add_touch(rdm_scene *scene, const char *a, const char *b,
                                       int32_t *group);

/* Which world of its pool it is, from 0 on; -1 in rdm_task_check's trials of one world alone, and
 * of a world that is none. */
RDM_API int32_t rdm_world_number(const rdm_world *world);
/* rdm_pool_config.user of the world's pool: a pool keeps its own, whatever it takes of states and
 * of other pools. What it leads to is for what is outside of a world (a viewer, a log); what
 * happens within must not depend on it, nor on the number. NULL of a world that is none. */
RDM_API void *rdm_world_user(const rdm_world *world);
/* the joints of all robots of a world; the addresses hold within the call */
typedef struct rdm_joints {
  uint32_t struct_size;    /* in: bytes */
  int32_t count;           /* of joints */
  double control_dt;       /* s of a control step */
  const double *q;         /* [count] rad (m) */
  const double *qd;        /* [count] rad/s (m/s) */
  const double *target;    /* [count] what the drives go for */
  const double *torque;    /* [count] of the drives, mean over the step, N m (N) */
} rdm_joints;
typedef struct rdm_motion { /* frozen layout: of a frame, in the world */
  rdm_pose pose;           /* where it is */
  double v[3];             /* velocity of the frame's origin, m/s */
  double w[3];             /* angular velocity, world axes, rad/s */
} rdm_motion;
/* Indices are those of the scene, out of range is RANGE; numbers that are not finite or no world
 * can have are ARGUMENT; the world then is as before. In observe nothing can be set: STATE. */
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
/* *pairs is how many pairs of a group's shapes touched in the step; *force (N) the sum of the
 * group's contact forces in its last substep. Either may be NULL. */
RDM_API rdm_result rdm_world_get_touch(const rdm_world *world, int32_t group, int32_t *pairs,
                                       double *force);
/* Contacts of the last substep to out [capacity], of sleeping bodies as they were when they fell
 * asleep; *count is how many there are. */
RDM_API rdm_result rdm_world_get_contacts(const rdm_world *world, rdm_contact *out,
                                          size_t capacity, size_t *count);
/* By *depth (m) a body at its present place is within something that it may touch; 0: it is
 * clear. */
RDM_API rdm_result rdm_world_get_overlap(rdm_world *world, int32_t body, double *depth);
/* Places for what moves freely; joints q [n] and velocities qd [n] (NULL: 0) of a robot of n
 * joints, within their ranges, and with them the targets of its drives. */
RDM_API rdm_result rdm_world_set_body(rdm_world *world, int32_t body, const rdm_motion *motion);
RDM_API rdm_result rdm_world_set_base(rdm_world *world, int32_t robot,
                                      const rdm_motion *motion); /* STATE: it is fixed */
RDM_API rdm_result rdm_world_set_joints(rdm_world *world, int32_t robot, const double *q,
                                        const double *qd, size_t n); /* all n */
/* What drives go for: targets [n] (rad, m) of the joints from `first` on; or commands [n]
 * in [-1, 1] of all n commands of a robot, which become targets as its description says: ranges or
 * curves, no faster than its joints' velocity. */
RDM_API rdm_result rdm_world_set_targets(rdm_world *world, int32_t first, const double *targets,
                                         size_t n);
RDM_API rdm_result rdm_world_set_commands(rdm_world *world, int32_t robot, const double *commands,
                                          size_t n);
/* Adds efforts [n] (N m, N) to the springs of the drives from `first` on, until they are set again;
 * STATE unless the scene has them. rdm_world_get_gravity gives those that hold a robot of n joints
 * against gravity where it is. */
RDM_API rdm_result rdm_world_set_feedforward(rdm_world *world, int32_t first, const double *efforts,
                                             size_t n);
RDM_API rdm_result rdm_world_get_gravity(const rdm_world *world, int32_t robot, double *efforts,
                                         size_t n);
enum rdm_scale { /* what a factor is on, and in brackets its bounds */
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
typedef struct rdm_factor { /* frozen layout: on a constant of the scene, in one world */
  int32_t what;            /* RDM_SCALE_* */
  int32_t index;           /* of the link, robot or body, or the first material */
  int32_t other;           /* the second material of a friction */
  int32_t reserved;        /* 0 */
  double factor;           /* times the scene's value */
} rdm_factor;
/* Lays factors [count] over those that the world has, all 1 at the start of an episode; reset may
 * draw them. All are taken or none. STATE unless the scene is adjustable. */
RDM_API rdm_result rdm_world_set_factors(rdm_world *world, const rdm_factor *factors, size_t count);
/* Pushes during the next step, world axes: force [3] (N) at the centre of mass and torque [3] (N
 * m); of a link at `point` [3]. */
RDM_API rdm_result rdm_world_push_body(rdm_world *world, int32_t body, const double force[3],
                                       const double torque[3]);
RDM_API rdm_result rdm_world_push_base(rdm_world *world, int32_t robot, const double force[3],
                                       const double torque[3]);
RDM_API rdm_result rdm_world_push_link(rdm_world *world, int32_t link, const double force[3],
                                       const double point[3]);

enum rdm_quantity { /* of worlds, each so many doubles */
  RDM_QUANTITY_Q = 0,          /* 1: coordinate of a joint, rad (m) */
  RDM_QUANTITY_QD = 1,         /* 1: its velocity, rad/s (m/s) */
  RDM_QUANTITY_TARGET = 2,     /* 1: what its drive goes for; can be set */
  RDM_QUANTITY_TORQUE = 3,     /* 1: of its drive, mean over the step, N m (N) */
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
/* The quantity `what` of items first to first + count - 1 of each of n worlds to (or from) x
 * [n][count][width], width the doubles of one. What is set is what the function of one world sets,
 * row by row: an error leaves the rows before it set. RANGE for items that the scene does not have,
 * and of those that are set together for another count. */
RDM_API rdm_result rdm_world_get_many(rdm_world **worlds, size_t n, int32_t what,
                                      int32_t first, size_t count, double *x);
RDM_API rdm_result rdm_world_set_many(rdm_world **worlds, size_t n, int32_t what,
                                      int32_t first, size_t count, const double *x);

typedef struct rdm_random { /* frozen layout: a stream of random numbers; may be part of a state */
  uint64_t seed;           /* its name */
  uint64_t counter;        /* draws so far */
  uint32_t world;          /* its name */
  uint32_t purpose;        /* its name */
} rdm_random;
/* Draws from the stream; 0 without one. The same numbers on every machine. */
RDM_API uint64_t rdm_random_bits(rdm_random *random);
RDM_API double rdm_random_uniform(rdm_random *random, double low, double high); /* in [low, high) */
RDM_API double rdm_random_normal(rdm_random *random); /* mean 0, deviation 1 */
/* Another stream to *out, for draws within an episode: reset makes it and keeps it in the state. */
RDM_API rdm_result rdm_random_split(rdm_random *random, rdm_random *out);
/* The turn by `angle` (rad) about the unit vector axis [3] to q [4]: the same bits on every
 * machine, where those of a C library's sine are not. */
RDM_API rdm_result rdm_rotation(const double axis[3], double angle, double q[4]);

typedef struct rdm_verdict { /* what judge fills; zeroed before */
  double reward;           /* of the step */
  double cost[RDM_MAX_COSTS];     /* each column of the step, 0 or more */
  double cost_raw[RDM_MAX_COSTS]; /* the measured value behind each */
  int32_t terminated;      /* flag: the episode ends here */
  int32_t success;         /* flag */
} rdm_verdict;
/* what a function of many worlds is called with; row i is of worlds[i] */
typedef struct rdm_task_rows {
  uint32_t struct_size;    /* bytes */
  int32_t count;           /* of worlds, 1 to 256 */
  rdm_world **worlds;      /* [count] in the order of their numbers */
  void *states;            /* [count][state_bytes] copies, which go back where the function may
                            * change them; NULL with state_bytes 0 */
  rdm_result *results;     /* [count] RDM_OK; another code fails that world alone */
  rdm_random *randoms;     /* [count] reset: as its `random` */
  const float *actions;    /* [count][action_dim] control */
  const int32_t *steps;    /* [count] judge: control steps of the episode, from 1 */
  rdm_verdict *verdicts;   /* [count] judge: zeroed before */
  float *obs;              /* [count][obs_dim] observe: all fields */
} rdm_task_rows;
typedef struct rdm_field_def { /* frozen layout: a run of observation entries */
  const char *name;        /* unique, at most 31 characters: "cup.position" */
  const char *unit;        /* of a stored 1: "m", "5 rad/s", "1" */
  int32_t count;           /* entries */
  float low;               /* what no entry leaves; low equal to high: none but obs_limit */
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
  const char *help;        /* one line, with the unit; unused of one that every task has */
  const char *text;        /* default of a text option, or of a number that is a range, else NULL */
  const char *choices;     /* text: allowed words "a|b|c", NULL: any; number, integer: "a..b":
                            * takes a range too; else NULL */
  double number;           /* default of number, integer, flag; of a range its middle */
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
  int32_t max_steps;       /* control steps of an episode: default of the option max_steps;
                            * default 100 */
  const char *name;        /* letters, digits, '_', '-', '.'; at most 40 */
  const char *summary;     /* one line; NULL: none */
  const rdm_field_def *fields;     /* [num_fields] of an observation, in order */
  const rdm_cost_def *costs;       /* [num_costs] column 0 is the one that learners limit */
  const rdm_option_def *options;   /* [num_options] rows, and defaults of its own for those that
                                    * every task has */
  const rdm_camera_def *cameras;   /* [num_cameras] NULL with num_cameras 0: "front", made for
                                    * the origin */
  const rdm_option *defaults;      /* [num_defaults] of agent options; NULL with num_defaults 0 */
  int32_t num_fields;      /* 1 or more */
  int32_t num_costs;       /* 1 to RDM_MAX_COSTS */
  int32_t num_options;     /* count */
  int32_t num_cameras;     /* count */
  int32_t num_defaults;    /* count */
  int32_t action_dim;      /* 1 to 1024 */
  const float *hold;       /* [action_dim] the action that holds still; NULL: 0 */
  const float *mean;       /* [action_dim] that a new policy starts from; NULL: 0 */
  const char *action_order;        /* what the entries are, for the layout hash; NULL: "action" */
  double obs_limit;        /* every observation entry is cut at +- this; 0: none */
  uint64_t state_bytes;    /* of a world's own state, to 2^20 */
  uint64_t instance_bytes; /* of what build leaves for the others, to 2^24 */
  void *user;              /* passed to all; may be NULL */
  /* makes the scene, and the constants of this pool. Required */
  rdm_result (*build)(void *user, rdm_scene *scene, void *instance);
  /* starts an episode, the world is as it was built. Required */
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
  /* FORMAT for a saved state that no world can have: indices out of range, numbers that are not
   * finite. NULL: all are good */
  rdm_result (*check_state)(void *user, const void *instance, const void *state);
  /* called once, when the task was destroyed and its last pool is gone. NULL: none */
  void (*release)(void *user);
  /* In the place of the functions above, for many worlds at once; NULL: none. Where one is given
   * the function of one world may be NULL. A pool calls them on the thread that called it, for up
   * to 256 worlds together, between two steps of its engine: a runtime is then entered once a step
   * and not once a world. A row depends on its own world alone, as rdm_task_check tries. What they
   * return is of all rows */
  rdm_result (*reset_many)(void *user, const void *instance, const rdm_task_rows *rows);
  /* as reset_many, in the place of control */
  rdm_result (*control_many)(void *user, const void *instance, const rdm_task_rows *rows);
  /* as reset_many, in the place of judge */
  rdm_result (*judge_many)(void *user, const void *instance, const rdm_task_rows *rows);
  /* as reset_many, in the place of observe */
  rdm_result (*observe_many)(void *user, const void *instance, const rdm_task_rows *rows);
} rdm_task_def;
RDM_API rdm_result rdm_task_def_init(rdm_task_def *def,
                                     size_t size); /* defaults into the first `size` bytes */
/* Adds a task under a number of its own, *out for rdm_task_at and its like. ARGUMENT,
 * RANGE: the text names the row; a name that is taken is an ARGUMENT. Tasks belong to the process;
 * any number of threads may look meanwhile. */
RDM_API rdm_result rdm_task_create(int32_t *out, const rdm_task_def *def);
/* Pools that have it keep it. ARGUMENT for the library's own. */
RDM_API rdm_result rdm_task_destroy(int32_t task);
/* Tries what a task promises, any task: the same bytes for the same seed, any threads and after
 * save and restore, rows within their fields and bounds, costs of 0 or more, nothing written past a
 * state or a row, no memory left behind. OK, or the error of making a pool, or ARGUMENT: the text
 * names the function, the step and the entry where a promise broke first; it goes to
 * error [error_size] too, NULL: not. `settings` as in rdm_pool_config; NULL: none. Seconds: `stop`,
 * NULL: never, is asked before every step of its worlds, and given `user`; CANCELLED where it says
 * so, nothing is left behind. */
RDM_API rdm_result rdm_task_check(const char *task, const char *settings, rdm_stop stop, void *user,
                                  char *error, size_t error_size);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_TASK_H */
