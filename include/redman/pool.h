/* redman/pool.h: what exists, and worlds of one task, stepped together. Stable since 1.0. */
#ifndef REDMAN_POOL_H
#define REDMAN_POOL_H
#include <redman/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- discovery: what exists, and what every number in a row means ---------------------------- */
typedef struct rdm_task { /* a task with its default options */
  uint32_t struct_size;     /* in: bytes                                                      */
  float control_dt;         /* s between steps, default options                               */
  const char *name;         /* "hand_over_safe_finger"                                        */
  const char *summary;      /* one line                                                       */
  int32_t obs_dim;          /* count, default options                                         */
  int32_t action_dim;       /* count, default options                                         */
  int32_t cost_dim;         /* count of cost columns                                          */
  int32_t max_steps;        /* control steps of an episode, default options                   */
  int32_t num_fields;       /* for rdm_task_field_at                                          */
  int32_t num_options;      /* for rdm_task_option_at                                         */
  int32_t num_cameras;      /* for rdm_task_camera_at                                         */
  int32_t num_defaults;     /* for rdm_task_default_at                                           */
  const char *action_order; /* what the entries of the action are: "thrust, turn"; for hands groups
                             * of entries, "right joints, force, torque"; default options */
} rdm_task;
typedef struct rdm_cost_info { /* a cost column */
  uint32_t struct_size;     /* in: bytes                                                      */
  uint32_t reserved;        /* 0                                                              */
  const char *name;         /* column 0 is "cost", the paper's                                */
  const char *help;         /* one line                                                       */
  double limit;             /* default limit on the sum over an episode; < 0: none            */
} rdm_cost_info;
typedef struct rdm_camera_info { /* a pinhole camera */
  uint32_t struct_size;     /* in: bytes                                                      */
  int32_t mount;            /* what it is fixed to; 0: the world; k > 0: link k - 1 of the scene;
                             * -k: the base of its articulation (robot) k - 1 */
  const char *name;         /* "front"                                                        */
  float eye[3];             /* m, in the frame that mount names                               */
  float target[3];          /* m, likewise; the optical axis runs from eye to target          */
  float up[3];              /* likewise: what points up in the picture; where it is parallel to the
                             * optical axis, -x of the world is used */
  float fov_y;              /* vertical field of view, rad; the focal length in pixels is half the
                             * picture's height / tan(fov_y / 2) */
  float cx;                 /* where the optical axis meets the picture: to the right of its
                             * centre, as a share of its width                                */
  float cy;                 /* likewise: below its centre, as a share of its height           */
} rdm_camera_info;
RDM_API int32_t rdm_task_count(void); /* one more than the highest number of a task; 0 in a build
                                       * without simulation */
RDM_API rdm_result rdm_task_at(int32_t index, rdm_task *io); /* NOT_FOUND: destroyed; RANGE: no
                                                              * task had this number */
RDM_API rdm_result rdm_task_find(const char *name,
                                 int32_t *index); /* NOT_FOUND: the text offers the nearest */
RDM_API rdm_result rdm_task_field_at(int32_t task, int32_t i,
                                     rdm_field_info *io); /* default options; i < num_fields */
RDM_API rdm_result rdm_task_cost_at(int32_t task, int32_t i, rdm_cost_info *io); /* i < cost_dim */
RDM_API rdm_result rdm_task_option_at(int32_t task, int32_t i,
                                      rdm_option_spec *io); /* i < num_options */
RDM_API rdm_result rdm_task_camera_at(int32_t task, int32_t i,
                                      rdm_camera_info *io); /* i < num_cameras */
/* The task's own defaults for options of agents, to be given as rdm_agent_config.defaults. A key
 * "shield:key" is a default for shields, which read it from their pool. */
RDM_API rdm_result rdm_task_default_at(int32_t task, int32_t i,
                                       rdm_option *out); /* i < num_defaults */

typedef struct rdm_robot { /* a robot description */
  uint32_t struct_size;     /* in: bytes                                                      */
  int32_t num_joints;       /* count                                                          */
  int32_t num_actuated;     /* count of joints with a motor of their own                      */
  int32_t reserved;         /* 0                                                              */
  const char *name;         /* "shadow_hand"                                                  */
  const char *summary;      /* one line                                                       */
} rdm_robot;
RDM_API int32_t rdm_robot_count(void); /* as rdm_task_count */
RDM_API rdm_result rdm_robot_at(int32_t index, rdm_robot *io); /* errors as rdm_task_at */
RDM_API rdm_result rdm_robot_find(const char *name, int32_t *index); /* name or alias; NOT_FOUND:
                                                                      * the text offers the
                                                                      * nearest */
enum rdm_joint_kind { RDM_JOINT_REVOLUTE = 0, RDM_JOINT_PRISMATIC = 1 };  /* of a joint */
typedef struct rdm_joint_info { /* a joint of a robot, a scene or a pool's worlds */
  uint32_t struct_size;     /* in: bytes                                                      */
  int32_t kind;             /* RDM_JOINT_*: revolute joints in rad and N m, prismatic in m and N */
  int32_t parent;           /* the joint before it on the way from the base, -1: none         */
  int32_t action;           /* the entry of the action that moves it (of a robot, or in a scene: its
                             * command); -1: none, or known only to the functions of a host's
                             * task */
  const char *name;         /* "FFJ2"; of a pool "right_FFJ2"                                 */
  double lower, upper;      /* range, rad (m)                                                 */
  double velocity;          /* how fast its drive's target may move, rad/s (m/s); NaN: not known */
  double kp;                /* stiffness of its drive, N m/rad (N/m); 0: coupled, or no spring */
  double kd;                /* damping of its drive, N m s/rad (N s/m)                        */
  double effort;            /* largest torque (force) of its drive, N m (N)                   */
} rdm_joint_info;
RDM_API rdm_result rdm_robot_joint_at(int32_t robot, int32_t i,
                                      rdm_joint_info *io); /* i < num_joints; RANGE past the end */

typedef struct rdm_object_info { /* an object by name, for option object=... */
  uint32_t struct_size;     /* in: bytes                                                      */
  int32_t kind;             /* RDM_SHAPE_* of its only shape; -1: it has several              */
  int32_t num_shapes;       /* count                                                          */
  int32_t own;              /* flag: a host's own, by rdm_object_create                       */
  const char *name;         /* "egg"                                                          */
  const char *alias;        /* another name, "025_mug"; NULL: none                            */
  const char *summary;      /* one line, may be ""                                            */
  const char *shape;        /* "capsule r 0.03, straight part 0.02": kind and sizes in m      */
  double mass;              /* kg; for "hull": of its default points, at 500 kg/m3            */
  double friction;          /* friction coefficient, on dry surfaces                          */
  double low[3];            /* m, lowest corner of the box around its touchable shapes, relative to
                             * its centre of mass, along the axes of its description */
  double high[3];           /* m, highest corner of the box                                   */
} rdm_object_info;
RDM_API int32_t rdm_object_count(void); /* as rdm_task_count */
RDM_API rdm_result rdm_object_info_at(int32_t index,
                                      rdm_object_info *io); /* errors as rdm_task_at */
RDM_API rdm_result rdm_object_find(const char *name, int32_t *index); /* name or alias; NOT_FOUND:
                                                                       * the text offers the
                                                                       * nearest */

/* ---- pool: worlds of one task, stepped together ---------------------------------------------- */
typedef struct rdm_pool rdm_pool; /* handle */
/* When a world begins again by itself: in the step that ended its episode, in the next, or
 * never. */
enum rdm_autoreset {
  RDM_AUTORESET_SAME_STEP = 0, RDM_AUTORESET_NEXT_STEP = 1, RDM_AUTORESET_OFF = 2
};
enum rdm_status {                  /* bits of rdm_buffers.status */
  RDM_STATUS_CONTACTS = 1,         /* contacts beyond contacts_max were left out              */
  RDM_STATUS_DIVERGED = 2,         /* a value was not finite: the episode was truncated       */
  RDM_STATUS_BAD_ACTION = 4,       /* the row of actions was not finite: likewise             */
  RDM_STATUS_TASK = 8,             /* a function of a host's own task failed: likewise        */
  RDM_STATUS_SOLVER = 16,          /* the contact solver did not converge (engine ode does not
                                    * report this): a contact was wrong by more than 1 m/s along its
                                    * normal when the sweeps ended (something light under something
                                    * much heavier, with few iterations), or it kept giving way
                                    * (contact_max_speed below 0.02 m/s) */
  RDM_STATUS_SLOWED = 32           /* a free body that turned by more than 3 rad in a substep was
                                    * slowed to that */
};
typedef struct rdm_pool_config { /* what a pool is made from */
  uint32_t struct_size;      /* bytes, set by rdm_pool_config_init */
  int32_t num_envs;          /* worlds, 1..65536, default 1 */
  const char *task;          /* name, required; copied */
  uint64_t seed;             /* world i draws from stream (seed, i), until a reset names another */
  int32_t num_threads;       /* 0 or 1: the caller's thread only; up to 256; default 0 */
  int32_t autoreset;         /* RDM_AUTORESET_*, default same step */
  const rdm_option *options; /* [num_options], copied; NULL: none */
  int32_t num_options;       /* count, default 0 */
  int32_t reserved;          /* 0 */
  const rdm_host *host;      /* hooks of this handle, copied; NULL: those of rdm_init */
  const char *settings;      /* options as lines key=value, which override `options`, copied; NULL:
                              * none */
  char *error;               /* [error_size] receives the text when a call that takes this config
                              * fails; NULL: not wanted */
  int32_t error_size;        /* bytes, terminator included; a longer text is cut */
  int32_t reserved2;         /* 0 */
  void *user;                /* for a host's own task, which reads it by rdm_scene_user and
                              * rdm_world_user; may be NULL */
} rdm_pool_config;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
 * version's. */
RDM_API rdm_result rdm_pool_config_init(rdm_pool_config *c, size_t size);

/* The sizes that a pool of this config would have. Returns what rdm_pool_create would return,
 * memory aside. Makes the task for a moment and no world; nothing is kept. */
RDM_API rdm_result rdm_pool_config_spec(const rdm_pool_config *c, rdm_spec *io);
/* Bytes that creation takes: *ours in one block, exact; *engines by the physics engine from the C
 * library, an estimate. Either may be NULL. No hook is called: the task is made to find out, in
 * memory of the C library that is freed at the end. */
RDM_API rdm_result rdm_pool_config_memory(const rdm_pool_config *c, size_t *ours, size_t *engines);
/* Makes the worlds. They are not reset yet: call rdm_pool_reset before the first step. A host's
 * alloc hook is called once, for one block that holds all of the pool; to know its size the task is
 * made once before, as by rdm_pool_config_memory. Without the hook, each part comes from the C
 * library. */
RDM_API rdm_result rdm_pool_create(rdm_pool **out, const rdm_pool_config *c);
/* The same in memory [bytes] at any address: at least *ours of rdm_pool_config_memory, else RANGE,
 * and the text says how many are needed. The pool uses the memory until it is destroyed; the caller
 * owns it throughout. Neither alloc hook nor C library are asked for memory, now or later, except
 * by the physics engine, for threads by the system, and in clean_house by OctoMap for its map
 * (0.9 MB); what rdm_pool_set_starts keeps must fit into what is left (MEMORY). */
RDM_API rdm_result rdm_pool_create_in(rdm_pool **out, const rdm_pool_config *c, void *memory,
                                      size_t bytes);
RDM_API void rdm_pool_destroy(rdm_pool *p);                 /* NULL is fine */
RDM_API const char *rdm_pool_error(const rdm_pool *p); /* last failure on this handle; "" at
                                                        * first */
RDM_API rdm_result rdm_pool_get_spec(const rdm_pool *p,
                                     rdm_spec *io); /* as rdm_pool_config_spec, for a pool */
RDM_API rdm_result rdm_pool_field_at(const rdm_pool *p, int32_t i,
                                     rdm_field_info *io); /* i < num_fields */
/* The mean action [action_dim] that a new policy starts from: the task's start pose, which usually
 * differs from the action of RDM_BASELINE_HOLD. */
RDM_API rdm_result rdm_pool_get_initial_mean(const rdm_pool *p, float *action);
/* The value of option i of this pool: its key, and the value as text [RDM_TEXT_SIZE], which reads
 * back exactly. RANGE for a longer text, with *key set: rdm_pool_get_settings has it. The rows are
 * those of rdm_task_option_at, but for joints and links, which are those of the pool's robots. The
 * keys with a FIELD that were set follow, in order, then RANGE. */
RDM_API rdm_result rdm_pool_setting_at(const rdm_pool *p, int32_t i, const char **key, char *text);
/* All options as text [capacity] of lines key=value, except those that option level draws and those
 * of joints and links that were not set; given as settings they make the same pool again. */
RDM_API rdm_result rdm_pool_get_settings(const rdm_pool *p, char *text, size_t capacity,
                                         size_t *size);

/* Rows of world i begin at i * width. Arrays are 64-byte aligned and keep their addresses until
 * rdm_pool_destroy or rdm_pool_set_buffers. The library writes them only within calls that change
 * worlds. */
typedef struct rdm_buffers {
  uint32_t struct_size;      /* in: bytes */
  uint32_t reserved;         /* 0 */
  float *obs;                /* [num_envs][obs_dim]; tasks with hands cut each entry at +-5 */
  float *final_obs;          /* [num_envs][obs_dim] last observation where an episode ended, else
                              * as obs */
  float *action;             /* [num_envs][action_dim] in [-1, 1], clipped; the host writes */
  float *reward;             /* [num_envs] */
  float *cost;               /* [num_envs][cost_dim] >= 0; column 0 is the cost of the paper */
  float *cost_raw;           /* [num_envs][cost_dim] the measured value behind each cost */
  float *episode_return;     /* [num_envs] sum of rewards; the finished episode's where one ended */
  float *episode_cost;       /* [num_envs][cost_dim] likewise */
  int32_t *episode_step;     /* [num_envs] control steps, likewise */
  uint32_t *status;          /* [num_envs] RDM_STATUS_* of the last step or reset */
  uint8_t *terminated;       /* [num_envs] 1: the task ended (a fall) */
  uint8_t *truncated;        /* [num_envs] 1: ended by the time limit or a bad status */
  uint8_t *success;          /* [num_envs] 1: the task's success holds in this step */
  uint32_t *episode_status;  /* [num_envs] all RDM_STATUS_* of the episode; the finished one's
                              * where one ended */
} rdm_buffers;
RDM_API rdm_result rdm_pool_get_buffers(const rdm_pool *p, rdm_buffers *io); /* borrowed pointers */
/* Replaces the pool's arrays by those of b that are not NULL (sizes as above, at least 4-byte
 * aligned); they must live until the pool is destroyed or they are replaced again. Present contents
 * are copied into them. */
RDM_API rdm_result rdm_pool_set_buffers(rdm_pool *p, const rdm_buffers *b);

/* Starts new episodes where mask [num_envs] is not 0 (NULL: everywhere). seeds [num_envs] give
 * these worlds new random streams, which depend on the seed alone and not on the world's number:
 * seed s gives the episode of a pool of one world created with seed s. seeds NULL: the worlds
 * continue their own streams, which after create are (config.seed, i). Costs are 0 afterwards. An
 * entry of the first observation that is not finite is written as 0, and the world and its episode
 * are flagged RDM_STATUS_DIVERGED. Where a host's own task fails, the error of the lowest such
 * world is returned; all such worlds are flagged RDM_STATUS_TASK and count as never reset, the
 * others have begun. */
RDM_API rdm_result rdm_pool_reset(rdm_pool *p, const uint64_t *seeds, const uint8_t *mask);
/* One control step of every world: reads action, writes all other rows. STATE before the first
 * reset, and with autoreset off while a world that ended was not reset. A world that diverges, gets
 * an action that is not finite, or whose task of a host's own fails, is truncated and flagged, with
 * reward and cost 0 in that step; the call still returns OK. With option action_repeat it makes
 * that many control steps with the same action, or as many as the episode has left: reward and cost
 * are sums over them, success is 1 if it was in any, status has the bits of all, the other rows are
 * those after the last. */
RDM_API rdm_result rdm_pool_step(rdm_pool *p);
/* The same for worlds whose mask [num_envs] is not 0; rows of the others do not change. */
RDM_API rdm_result rdm_pool_step_masked(rdm_pool *p, const uint8_t *mask);

/* simple actions to compare learned ones with */
enum rdm_baseline_kind { RDM_BASELINE_ZERO = 0, RDM_BASELINE_HOLD = 1, RDM_BASELINE_RANDOM = 2 };
/* Fills the action buffer: all 0 (the middle of each joint's range), the nominal start pose, or
 * uniform in [-1, 1] from the stream (seed, world, policy). */
RDM_API rdm_result rdm_pool_baseline(rdm_pool *p, int32_t kind);

/* The complete and exact state of world env: a pool of the same task and options that reads it
 * continues with the same bytes. env -1: all worlds in one block. read_state also rewrites obs and
 * what rdm_sensors shows, and clears the other rows of that world but terminated, truncated and
 * episode_status; sums and steps of its episode go on with the next step. FORMAT for bytes that are
 * truncated, of another task or other options, or hold values that no world can have; nothing
 * changes then. Only action_repeat, sense_every and the options of images, clouds of points and
 * voxel grids may differ. The bytes are meant for files and other processes. For snapshots within a
 * process, as to go back some steps, copy worlds into a second pool by rdm_pool_copy: in a task of
 * hands that takes a thirtieth of the time. */
RDM_API rdm_result rdm_pool_write_state(const rdm_pool *p, int32_t env, void *bytes,
                                        size_t capacity, size_t *size); /* to bytes [capacity];
                                                                         * NULL asks for the
                                                                         * size */
RDM_API rdm_result rdm_pool_read_state(rdm_pool *p, int32_t env, const void *bytes,
                                       size_t size); /* of bytes [size] */
RDM_API rdm_result rdm_pool_get_hash(const rdm_pool *p, int32_t env,
                                     uint64_t *hash); /* of the state of world env; -1: of all */

typedef struct rdm_shape_info { /* a shape of the scene, the same for all worlds */
  uint32_t struct_size;      /* in: bytes */
  int32_t kind;              /* RDM_SHAPE_SPHERE ... RDM_SHAPE_HULL; plane: the half space below
                              * z = 0 of its frame */
  int32_t fixed;             /* flag: never moves */
  uint8_t color[4];          /* red, green, blue, 255 */
  const char *name;          /* "right.ff_distal" */
  double size[3];            /* m: radius | radius, half length along z | half sizes (hull: of
                              * its box) */
} rdm_shape_info;
RDM_API rdm_result rdm_pool_shape_at(const rdm_pool *p, int32_t i,
                                     rdm_shape_info *io); /* i < num_shapes */
/* Writes the poses of the shapes of world env to poses [num_shapes], in that world's frame. */
RDM_API rdm_result rdm_pool_get_poses(const rdm_pool *p, int32_t env, rdm_pose *poses);
typedef struct rdm_contact { /* frozen layout: one contact point of the last substep */
  int32_t shape_a, shape_b;  /* for rdm_pool_shape_at */
  float position[3];         /* m */
  float normal[3];           /* unit, from b into a */
  float force[3];            /* N, on a */
  float depth;               /* m */
} rdm_contact;
/* Writes up to capacity contacts to out [capacity]; *count is how many there are. Contacts of
 * sleeping bodies are those of the moment when they fell asleep. */
RDM_API rdm_result rdm_pool_get_contacts(const rdm_pool *p, int32_t env, rdm_contact *out,
                                         size_t capacity, size_t *count);
/* A picture of world env by the task's camera of that name. rgb [h][w][3], depth [h][w] (m along
 * the optical axis, 0: nothing hit), segmentation [h][w] (shape, -1: nothing); each may be NULL. 1
 * <= w, h <= 8192. The colours are made for people; rdm_pool_draw in sense.h has a plainer look at
 * half the price, as observations have it, and draws several worlds in one picture. */
RDM_API rdm_result rdm_pool_render(rdm_pool *p, int32_t env, const char *camera, int32_t w,
                                   int32_t h, uint8_t *rgb, float *depth, int32_t *segmentation);
typedef struct rdm_pool_stats { /* counts since create */
  uint32_t struct_size;      /* in: bytes */
  int32_t contacts_max;      /* largest number of contacts in the last substep of a control step
                              * since create, of all worlds; other substeps may have had more */
  double contacts_mean;      /* mean number of contacts in these substeps; 0 before the first */
  double joint_drift;        /* m, largest gap in any joint now, of all worlds */
  int64_t steps;             /* control steps that the engine simulated, summed over worlds */
  int64_t diverged;          /* steps and resets flagged RDM_STATUS_DIVERGED so far */
  int64_t overflowed;        /* steps flagged RDM_STATUS_CONTACTS so far */
  int64_t bad_actions;       /* steps flagged RDM_STATUS_BAD_ACTION so far */
  int64_t task_failed;       /* steps flagged RDM_STATUS_TASK so far */
  int64_t unconverged;       /* steps flagged RDM_STATUS_SOLVER so far */
  int64_t slowed;            /* steps flagged RDM_STATUS_SLOWED so far */
  double solver_residual;    /* m/s, largest error of a contact's normal velocity that the solver's
                              * last sweep of the last step found, of all worlds; NaN: engine ode
                              * does not measure it */
  int64_t violations;        /* control steps so far in which column 0, or a cost that the task
                              * limits, was above 0 */
} rdm_pool_stats;
RDM_API rdm_result rdm_pool_get_stats(const rdm_pool *p, rdm_pool_stats *io); /* fills io */
/* Makes world dst_env of dst (-1: every world) a copy of world src_env of src, at the price of
 * copying memory: it continues with the same bytes as after write_state and read_state, and its
 * rows are copied too, except action and those of rdm_sensors. Both pools must have the same task
 * and options; sizes, threads and seeds may differ, and src may be dst. ARGUMENT for pools that
 * differ, RANGE for worlds that do not exist; nothing changes then. No heap. */
RDM_API rdm_result rdm_pool_copy(rdm_pool *dst, int32_t dst_env, const rdm_pool *src,
                                 int32_t src_env);
/* Joint i of a world's robots, the same for all worlds; i < num_joints of rdm_spec. */
RDM_API rdm_result rdm_pool_joint_at(const rdm_pool *p, int32_t i,
                                     rdm_joint_info *io); /* RANGE past the end */
/* Positions q [count] and velocities qd [count] of the joints of world env (rad, rad/s; m, m/s), in
 * the order of rdm_pool_joint_at; count: num_joints. Either array may be NULL. */
RDM_API rdm_result rdm_pool_get_joints(const rdm_pool *p, int32_t env, double *q, double *qd,
                                       size_t count);
/* Sets positions q [count], and the targets of the drives with them, and velocities qd [count];
 * what is NULL stays. RANGE names a joint that is further beyond its range than its ends yield
 * (option limit_margin; 10 where ends are soft), or as fast as 1e6; ARGUMENT one that is not
 * finite. STATE where no episode runs. Nothing changes then. A coupled joint may be set off its
 * coupling; its drive pulls it back. NaN for one means the position, or velocity, that follows from
 * the joint that it is coupled to. Bases, bodies and what the task remembers of commands stay.
 * Numbers are rounded to float where the engine keeps floats. Like read_state, it rewrites obs and
 * what rdm_sensors shows, and clears the other rows. Where a host's own task fails to observe, its
 * error is returned; the joints are set then, and obs is as before. */
RDM_API rdm_result rdm_pool_set_joints(rdm_pool *p, int32_t env, const double *q, const double *qd,
                                       size_t count);
typedef struct rdm_ray_hit { /* what a ray hits first */
  uint32_t struct_size;      /* in: bytes */
  int32_t shape;             /* for rdm_pool_shape_at; -1: nothing, all else is NaN */
  double distance;           /* m, from the origin */
  double point[3];           /* m, where the ray enters it */
  double normal[3];          /* unit, out of the shape there */
} rdm_ray_hit;
/* Finds the nearest shape of world env that the ray from origin [3] (m, world axes) along direction
 * [3] (any length above 0) enters within `range` m (above 0; may be INFINITY). It hits the shapes
 * that pictures show, except those that contain the origin. */
RDM_API rdm_result rdm_pool_raycast(const rdm_pool *p, int32_t env, const double origin[3],
                                    const double direction[3], double range, rdm_ray_hit *io);
/* Pushes the body or link that has this shape during the next step: force [3] (N, world axes) at
 * its centre of mass. */
RDM_API rdm_result rdm_pool_push(rdm_pool *p, int32_t env, int32_t shape, const float force[3]);
/* The text of the last failure in world env: "world 3: task press: judge: sensor lost", at most 255
 * bytes; "" at first, and always for the library's own tasks. It is kept until the world's next
 * failure and is not part of a saved state. */
RDM_API const char *rdm_pool_world_error(const rdm_pool *p, int32_t env);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_POOL_H */
