/* redman: safe dexterous manipulation in a C library.
 *
 * A pool steps N worlds of one task and writes observations, rewards, costs and end flags into buffers; an
 * agent acts on and learns from such buffers, of a pool or of your own environment; a policy is the frozen
 * network, loadable on a machine that has nothing else.
 *
 *   rdm_pool_config c;  rdm_pool *p;  rdm_buffers b = {.struct_size = sizeof b};
 *   rdm_pool_config_init(&c, sizeof c);
 *   c.task = "hand_over_safe_finger";  c.num_envs = 16;
 *   if (rdm_pool_create(&p, &c)) puts(rdm_last_error());
 *   rdm_pool_buffers(p, &b);
 *   rdm_pool_reset(p, NULL, NULL);
 *   for (...) { fill b.action;  rdm_pool_step(p);  read b.obs, b.reward, b.cost, ... }
 *   rdm_pool_destroy(p);
 *
 * Rules that hold for every function:
 *   - Fallible functions return rdm_result: 0 is good, negative is bad; nothing else is written then, unless
 *     said. They never print, exit, abort or throw. The text of a failure is rdm_last_error() of the calling
 *     thread, for calls on a pool or an agent also rdm_pool_error(p) or rdm_agent_error(a) (where a call takes
 *     both: the agent's), and names the argument and its range.
 *   - Handles are made through `out` and ended by a void destroy function that takes NULL.
 *   - A pool and an agent: one thread at a time, not bound to a thread; rdm_agent_cancel from any. A policy:
 *     immutable, shared freely. What takes no handle: any number of threads.
 *   - fork: in the child, handles with threads of their own (num_threads above 1 and no parallel hook) answer
 *     STATE to what needs those, and can be destroyed; all others go on as in the parent.
 *   - A handle of another kind, or one that was destroyed and whose memory has not been used since, is an
 *     ARGUMENT; to destroy such a one does nothing.
 *   - Structs begin with struct_size = sizeof of your version: set it yourself or through the _init function.
 *     ARGUMENT for less than the first version had or more than 4096.
 *   - Strings that are returned live as long as their handle (static ones: for ever). UTF-8.
 *     What is no UTF-8 in a name that was given stands in a text as \xNN.
 *   - Arrays are row-major. SI units, radians. Quaternions are (x, y, z, w) here and in observations.
 *   - Same seed, same bytes: for any number of threads; worlds on every x86-64 machine, learners on
 *     every machine of the same vector unit.
 *
 * How to read the declarations, for generators of bindings (tests/rules/check_contract.py holds them to it):
 *   - `const T *x` is read, `T *x` is written. `x [rows][obs_dim]` in the comment of the function, or `[rows][obs_dim]`
 *     first in the comment of a member, makes x an array of that shape; without one it is a single value. A
 *     function's comment is what stands behind it, then what stands above the run of functions that it is in.
 *   - Words in a shape are arguments of the function, members of structs, or macros; n0 is the first number of n.
 *   - An array whose comment says so may be NULL; a struct with struct_size that is no config is in and out.
 *   - `const char *` is a text that ends in 0. `rdm_pool *`, `rdm_agent *`, `rdm_policy *` and `rdm_map *` are handles,
 *     through `**` new ones. `void *` with a shape is bytes; other ones are passed through.
 *   - Text and bytes of any length come as (T *x, size_t capacity, size_t *size): x NULL asks for the size alone, a
 *     capacity below it is RANGE. The size of a text is without its 0, for which the capacity must have room.
 */
#ifndef REDMAN_H
#define REDMAN_H
#include <stddef.h>
#include <stdint.h>

#if !defined(RDM_API)
#if defined(__GNUC__)
#define RDM_API __attribute__((visibility("default")))
#else
#define RDM_API
#endif
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define RDM_VERSION_MAJOR 0
#define RDM_VERSION_MINOR 1
#define RDM_VERSION_PATCH 0
#define RDM_VERSION (RDM_VERSION_MAJOR * 1000000 + RDM_VERSION_MINOR * 1000 + RDM_VERSION_PATCH)
#define RDM_ABI 1          /* = SONAME; moves only when an old binary would break */
#define RDM_MAX_COSTS 16   /* cost columns of a task or an agent */
#define RDM_TEXT_SIZE 64   /* bytes of an option's text value, terminator included */

/* ---- results ------------------------------------------------------------------------------------------ */
typedef int32_t rdm_result; /* frozen values; positive ones are reserved */
enum rdm_result_code {
  RDM_OK = 0,
  RDM_ARGUMENT = -1,    /* NULL, wrong struct_size, not finite, malformed                        */
  RDM_RANGE = -2,       /* outside the documented bounds; index past the end                     */
  RDM_STATE = -3,       /* calls in the wrong order                                              */
  RDM_MEMORY = -4,      /* the allocator refused                                                 */
  RDM_IO = -5,          /* file system                                                           */
  RDM_FORMAT = -6,      /* truncated, corrupt or foreign bytes                                   */
  RDM_VERSION_MISMATCH = -7, /* newer file, newer struct, other ABI                              */
  RDM_UNSUPPORTED = -8, /* left out of this build, or not defined for this combination           */
  RDM_PHYSICS = -9,     /* the physics engine gave up where no world could be flagged            */
  RDM_NOT_FOUND = -10,  /* unknown name (the text offers the nearest), missing file              */
  RDM_CANCELLED = -11,  /* rdm_agent_cancel was called; the handle is good                       */
  RDM_INTERNAL = -99    /* a defect of redman                                                    */
};
RDM_API const char *rdm_result_string(rdm_result r); /* static, never NULL, also for unknown values */
/* This OS thread's last failure, one line; valid until its next failing rdm call; stale after a success. Runtimes that
 * move calls between threads (Go, asynchronous FFI) read config.error, rdm_pool_error and their like instead. */
RDM_API const char *rdm_last_error(void);

/* ---- version and build -------------------------------------------------------------------------------- */
enum rdm_feature { RDM_FEATURE_SIM = 1, RDM_FEATURE_LEARN = 2 };
RDM_API uint32_t rdm_version(void);  /* RDM_VERSION of the library that runs */
RDM_API uint32_t rdm_features(void); /* RDM_FEATURE_*: which halves this build has */
/* VERSION_MISMATCH unless the library has this ABI and at least this version. */
RDM_API rdm_result rdm_check_abi(uint32_t abi, uint32_t version);
typedef struct rdm_build {
  uint32_t struct_size;   /* in: bytes                                              */
  uint32_t abi;           /* RDM_ABI of the library                                 */
  const char *version;    /* "0.1.0"                                                */
  const char *ode;        /* version of ODE, "" without the simulation half         */
  const char *eigen;      /* version of Eigen                                       */
  const char *ccd;        /* version of libccd                                      */
  const char *octomap;    /* version of OctoMap                                     */
  const char *precision;  /* of physics and networks: "double physics, float nets"  */
  const char *compiler;   /* name and version                                       */
  const char *kernels;    /* instruction set that the networks run on here          */
} rdm_build;
RDM_API rdm_result rdm_build_info(rdm_build *io); /* fills io; strings are static */

/* ---- host hooks --------------------------------------------------------------------------------------- */
typedef void (*rdm_body)(void *context, int32_t index);
typedef struct rdm_host {
  uint32_t struct_size;   /* bytes                                                                     */
  uint32_t reserved;      /* 0                                                                         */
  void *user;             /* passed back to every hook; may be NULL                                    */
  /* `bytes` at a multiple of `align` (a power of two up to 64), or NULL. NULL hook: the C library's.   */
  void *(*alloc)(void *user, size_t bytes, size_t align);
  void (*release)(void *user, void *p, size_t bytes, size_t align); /* required with alloc             */
  void (*log)(void *user, int32_t level, const char *line); /* 0 info, 1 warning, 2 error; NULL: silent */
  /* Must run body(context, i) once for every i in [0, n), each on one OS thread, and return when all are
   * done; may be serial. NULL: redman's own workers.                                                   */
  void (*parallel)(void *user, int32_t n, rdm_body body, void *context);
} rdm_host;
/* Process-wide hooks for handles made later, whose configs give none. Counted; NULL: defaults. Optional. */
RDM_API rdm_result rdm_init(const rdm_host *host);
RDM_API void rdm_shutdown(void); /* the last call puts the default hooks back; handles stay valid */

/* ---- options ------------------------------------------------------------------------------------------ */
enum rdm_option_kind { RDM_NUMBER = 0, RDM_INTEGER = 1, RDM_FLAG = 2, RDM_TEXT = 3 };
typedef struct rdm_option { /* frozen layout: one key and its value */
  const char *key;          /* case is ignored and '-' equals '_'                             */
  const char *text;         /* value as one line of text ("0.5", "egg"); NULL: number is it   */
  double number;            /* value when text is NULL                                        */
} rdm_option;
typedef struct rdm_option_info { /* frozen layout: one row of an option table */
  const char *key;          /* static                                                         */
  const char *help;         /* one line, with the unit                                        */
  const char *text;         /* default of a text option, else NULL                            */
  const char *choices;      /* allowed words "a|b|c", NULL: any text, or not a text           */
  double number;            /* default of number, integer, flag                               */
  double low, high;         /* inclusive bounds                                               */
  int32_t kind;             /* RDM_NUMBER, RDM_INTEGER, RDM_FLAG, RDM_TEXT                    */
  int32_t live;             /* flag: rdm_agent_set may change it after creation               */
} rdm_option_info;
/* Options as one text, wherever a config has `settings`: lines `key=value`; spaces about either, '\r' and lines that
 * are empty do not count. They are laid over the config's `options`, later ones over earlier ones; an error names
 * the line. A NULL is none. */

/* ---- discovery: what exists, and what every number in a row means --------------------------------------- */
typedef struct rdm_task {
  uint32_t struct_size;     /* in: bytes                                                      */
  float control_dt;         /* s between steps, default options                               */
  const char *name;         /* "hand_over_safe_finger"                                        */
  const char *summary;      /* one line                                                       */
  int32_t obs_dim;          /* count, default options                                         */
  int32_t action_dim;       /* count, default options                                         */
  int32_t cost_dim;         /* count of cost columns                                          */
  int32_t max_steps;        /* control steps of an episode, default options                   */
  int32_t num_fields;       /* for rdm_task_field                                             */
  int32_t num_options;      /* for rdm_task_option                                            */
  int32_t num_cameras;      /* for rdm_task_camera                                            */
  int32_t num_defaults;     /* for rdm_task_default                                           */
} rdm_task;
typedef struct rdm_field {  /* frozen layout: a run of observation entries */
  const char *name;         /* "right.joint_position"                                         */
  const char *unit;         /* "rad", "m/s", "1" after scaling ...                            */
  int32_t offset;           /* first entry                                                    */
  int32_t count;            /* entries                                                        */
} rdm_field;
typedef struct rdm_cost {   /* frozen layout: a cost column */
  const char *name;         /* column 0 is "cost", the paper's                                */
  const char *help;         /* one line                                                       */
  double limit;             /* default limit on the sum over an episode; < 0: none            */
} rdm_cost;
typedef struct rdm_camera { /* frozen layout */
  const char *name;         /* "front"                                                        */
  float eye[3];             /* m, world                                                       */
  float target[3];          /* m, world                                                       */
  float fov_y;              /* rad, vertical field of view                                    */
  int32_t reserved;         /* 0                                                              */
} rdm_camera;
RDM_API int32_t rdm_task_count(void); /* number of tasks; 0 without the simulation half */
RDM_API rdm_result rdm_task_at(int32_t index, rdm_task *io);                   /* RANGE past the end */
RDM_API rdm_result rdm_task_find(const char *name, int32_t *index);            /* NOT_FOUND: nearest in the text */
RDM_API rdm_result rdm_task_field(int32_t task, int32_t i, rdm_field *out);    /* default options */
/* Bounds *low and *high that every entry of field i keeps, default options; NAN: none. */
RDM_API rdm_result rdm_task_field_bounds(int32_t task, int32_t i, float *low, float *high);
RDM_API rdm_result rdm_task_cost(int32_t task, int32_t i, rdm_cost *out);      /* i < cost_dim */
RDM_API rdm_result rdm_task_option(int32_t task, int32_t i, rdm_option_info *out); /* i < num_options */
RDM_API rdm_result rdm_task_camera(int32_t task, int32_t i, rdm_camera *out);  /* i < num_cameras */
/* The task's own defaults of agent options, to be given as rdm_agent_config.defaults. */
RDM_API rdm_result rdm_task_default(int32_t task, int32_t i, rdm_option *out); /* i < num_defaults */

typedef struct rdm_algo {
  uint32_t struct_size;     /* in: bytes                                                      */
  int32_t num_options;      /* for rdm_algo_option                                            */
  const char *name;         /* "ppo_lag"                                                      */
  const char *summary;      /* one line with the paper                                        */
} rdm_algo;
RDM_API int32_t rdm_algo_count(void); /* number of algorithms; 0 without the learning half */
RDM_API rdm_result rdm_algo_at(int32_t index, rdm_algo *io);                   /* RANGE past the end */
RDM_API rdm_result rdm_algo_find(const char *name, int32_t *index);            /* NOT_FOUND: nearest in the text */
RDM_API rdm_result rdm_algo_option(int32_t algo, int32_t i, rdm_option_info *out); /* i < num_options */

typedef struct rdm_robot {
  uint32_t struct_size;     /* in: bytes                                                      */
  int32_t num_joints;       /* count                                                          */
  int32_t num_actuated;     /* count of joints with a motor of their own                      */
  int32_t reserved;         /* 0                                                              */
  const char *name;         /* "shadow_hand"                                                  */
  const char *summary;      /* one line                                                       */
} rdm_robot;
typedef struct rdm_joint {  /* frozen layout */
  const char *name;         /* "FFJ2"                                                         */
  double lower, upper;      /* rad                                                            */
  double kp;                /* N m/rad, 0: coupled                                            */
  double kd;                /* N m s/rad                                                      */
  double effort;            /* N m                                                            */
  int32_t action;           /* entry of the hand's action, -1: none                           */
  int32_t reserved;         /* 0                                                              */
} rdm_joint;
RDM_API int32_t rdm_robot_count(void); /* number of robot descriptions */
RDM_API rdm_result rdm_robot_at(int32_t index, rdm_robot *io);                 /* RANGE past the end */
RDM_API rdm_result rdm_robot_joint(int32_t robot, int32_t i, rdm_joint *out);  /* i < num_joints */

typedef struct rdm_object { /* frozen layout: an object of the throw tasks, by option object=... */
  const char *name;         /* "egg"                                                          */
  const char *shape;        /* "capsule r 0.03, straight part 0.02": kind and sizes in m      */
  double mass;              /* kg; hull: of the default points, 500 kg/m3                     */
} rdm_object;
RDM_API int32_t rdm_object_count(void); /* number of objects */
RDM_API rdm_result rdm_object_at(int32_t index, rdm_object *out);              /* RANGE past the end */

/* ---- pool: worlds of one task, stepped together ----------------------------------------------------------- */
typedef struct rdm_pool rdm_pool;
enum rdm_autoreset { RDM_AUTORESET_SAME_STEP = 0, RDM_AUTORESET_NEXT_STEP = 1, RDM_AUTORESET_OFF = 2 };
enum rdm_status {                  /* bits of rdm_buffers.status */
  RDM_STATUS_CONTACTS = 1,         /* contacts beyond contacts_max were left out              */
  RDM_STATUS_DIVERGED = 2,         /* a value was not finite: the episode was truncated       */
  RDM_STATUS_BAD_ACTION = 4        /* the row of actions was not finite: likewise             */
};
typedef struct rdm_pool_config {
  uint32_t struct_size;      /* bytes, set by rdm_pool_config_init                                        */
  int32_t num_envs;          /* worlds, 1..65536, default 1                                               */
  const char *task;          /* name, required; copied                                                    */
  uint64_t seed;             /* world i draws from stream (seed, i), until a reset names another          */
  int32_t num_threads;       /* 0 or 1: the caller's only; up to 256; default 0                           */
  int32_t autoreset;         /* RDM_AUTORESET_*, default same step                                        */
  const rdm_option *options; /* [num_options], copied; NULL: none                                         */
  int32_t num_options;       /* count, default 0                                                          */
  int32_t reserved;          /* 0                                                                         */
  const rdm_host *host;      /* hooks of this handle, copied; NULL: those of rdm_init                     */
  const char *settings;      /* options as lines key=value, laid over `options`, copied; NULL: none       */
  char *error;               /* [error_size] the text of a failing call that takes this config; NULL      */
  int32_t error_size;        /* bytes, terminator included; what is longer is cut                         */
  int32_t reserved2;         /* 0                                                                         */
} rdm_pool_config;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first version's. */
RDM_API rdm_result rdm_pool_config_init(rdm_pool_config *c, size_t size);

typedef struct rdm_spec {
  uint32_t struct_size;      /* in: bytes                                                                 */
  float control_dt;          /* s between steps                                                           */
  int32_t obs_dim;           /* count                                                                     */
  int32_t action_dim;        /* count                                                                     */
  int32_t cost_dim;          /* count                                                                     */
  int32_t max_steps;         /* control steps of an episode                                               */
  uint64_t layout_hash;      /* of field names, counts and action order: policies carry it                */
  int32_t num_fields;        /* for rdm_pool_field                                                        */
  int32_t num_shapes;        /* for rdm_pool_shape                                                        */
  int32_t num_joints;        /* of all robots                                                             */
  int32_t task;              /* index for rdm_task_at and its like                                        */
  int32_t action_repeat;     /* control steps in one rdm_pool_step: option action_repeat                  */
  int32_t reserved;          /* 0                                                                         */
} rdm_spec;
/* What a pool of this config would be: OK where rdm_pool_create would be, memory aside, else its error. Makes
 * the task to ask it, and no world; nothing is kept. */
RDM_API rdm_result rdm_pool_spec(const rdm_pool_config *c, rdm_spec *io);
/* Bytes that creation takes: `ours` from the alloc hook, exact; `engines` by the physics engine from the
 * C library, an estimate. Either may be NULL. */
RDM_API rdm_result rdm_pool_memory(const rdm_pool_config *c, size_t *ours, size_t *engines);
/* Makes the worlds. They are not reset yet: call rdm_pool_reset before the first step. */
RDM_API rdm_result rdm_pool_create(rdm_pool **out, const rdm_pool_config *c);
RDM_API void rdm_pool_destroy(rdm_pool *p);                 /* NULL is fine */
RDM_API const char *rdm_pool_error(const rdm_pool *p);      /* last failure on this handle; "" at first */
RDM_API rdm_result rdm_pool_get_spec(const rdm_pool *p, rdm_spec *io); /* as rdm_pool_spec, of a pool */
RDM_API rdm_result rdm_pool_field(const rdm_pool *p, int32_t i, rdm_field *out); /* i < num_fields */
/* Bounds *low and *high that every entry of field i keeps; NAN: none. */
RDM_API rdm_result rdm_pool_field_bounds(const rdm_pool *p, int32_t i, float *low, float *high);
/* Mean action [action_dim] that a new policy starts from: the task's start pose, seldom that of RDM_BASELINE_HOLD. */
RDM_API rdm_result rdm_pool_initial_mean(const rdm_pool *p, float *action);
/* Option i of the task as this pool has it: key (static) and the value as text [RDM_TEXT_SIZE], which reads back
 * exactly. RANGE for a text that is longer: rdm_pool_settings has it. */
RDM_API rdm_result rdm_pool_option(const rdm_pool *p, int32_t i, const char **key, char *text);
/* All options as text [capacity] of lines key=value: given as settings they make the same pool again. */
RDM_API rdm_result rdm_pool_settings(const rdm_pool *p, char *text, size_t capacity, size_t *size);

/* Rows of world i begin at i * width; 64-byte aligned; the same addresses until destroy or bind. The
 * library writes them inside reset, step and set_state only. */
typedef struct rdm_buffers {
  uint32_t struct_size;      /* in: bytes                                                                 */
  uint32_t reserved;         /* 0                                                                         */
  float *obs;                /* [num_envs][obs_dim]; tasks with hands cut each entry at +-5               */
  float *final_obs;          /* [num_envs][obs_dim] last observation where an episode ended, else as obs  */
  float *action;             /* [num_envs][action_dim] in [-1, 1], clipped; the host writes               */
  float *reward;             /* [num_envs]                                                                */
  float *cost;               /* [num_envs][cost_dim] >= 0; column 0 is the task's paper cost              */
  float *cost_raw;           /* [num_envs][cost_dim] the measured value behind each cost                  */
  float *episode_return;     /* [num_envs] sum of rewards; the finished episode's where one ended         */
  float *episode_cost;       /* [num_envs][cost_dim] likewise                                             */
  int32_t *episode_step;     /* [num_envs] control steps, likewise                                        */
  uint32_t *status;          /* [num_envs] RDM_STATUS_* of the last step                                  */
  uint8_t *terminated;       /* [num_envs] 1: the task ended (a fall)                                     */
  uint8_t *truncated;        /* [num_envs] 1: cut by the time limit or a bad status                       */
  uint8_t *success;          /* [num_envs] 1: the task's success holds in this step                       */
  void *reserved_pointer;    /* NULL                                                                      */
} rdm_buffers;
RDM_API rdm_result rdm_pool_buffers(const rdm_pool *p, rdm_buffers *io); /* borrowed pointers */
/* Non-NULL pointers of b take the place of the pool's (sizes as above, at least 4-byte aligned; they must
 * outlive the pool or the next bind); NULL ones keep what is there. Contents are copied over. */
RDM_API rdm_result rdm_pool_bind(rdm_pool *p, const rdm_buffers *b);

/* Starts new episodes where mask [num_envs] is not 0 (NULL: everywhere). seeds [num_envs] name new streams: the seed
 * alone, whatever the world's number, so that seed s gives what a pool of one world created with seed s has. NULL: go
 * on with the worlds' own, which after create is (config.seed, i). Costs are 0 afterwards. */
RDM_API rdm_result rdm_pool_reset(rdm_pool *p, const uint64_t *seeds, const uint8_t *mask);
/* One control step of every world: reads action, writes all the rest. STATE before the first reset, and with
 * autoreset off while an ended world was not reset. Worlds that diverge or get an action that is not finite
 * are truncated and flagged, with reward and cost 0 in that step; the call returns OK.
 * With option action_repeat it is that many control steps with the same action, or as many as the episode has left:
 * reward and cost are sums over them, success is set if any had it, status has the bits of all, the other rows are
 * those after the last. */
RDM_API rdm_result rdm_pool_step(rdm_pool *p);
/* The same for worlds whose mask [num_envs] is not 0; rows of the others do not change. */
RDM_API rdm_result rdm_pool_step_masked(rdm_pool *p, const uint8_t *mask);

enum rdm_baseline_kind { RDM_BASELINE_ZERO = 0, RDM_BASELINE_HOLD = 1, RDM_BASELINE_RANDOM = 2 };
/* Fills the action buffer: all 0 (the middle of each joint's range), the nominal start pose, or uniform in
 * [-1, 1] from the stream (seed, world, policy). */
RDM_API rdm_result rdm_pool_baseline(rdm_pool *p, int32_t kind);

/* The whole state of world env, exact: a pool of the same task and options that sets it goes on with the same
 * bytes. set_state also rewrites obs and clears the other rows of that world. env -1: all worlds in one block.
 * FORMAT for bytes that are not whole, of another task or options, or hold what no world can have: nothing changes. */
RDM_API rdm_result rdm_pool_state_size(const rdm_pool *p, int32_t env, size_t *bytes);
RDM_API rdm_result rdm_pool_get_state(const rdm_pool *p, int32_t env, void *bytes, size_t capacity,
                                      size_t *size); /* to bytes [capacity]; *size is how many there are */
RDM_API rdm_result rdm_pool_set_state(rdm_pool *p, int32_t env, const void *bytes, size_t size); /* of bytes [size] */
RDM_API rdm_result rdm_pool_hash(const rdm_pool *p, int32_t env, uint64_t *hash); /* of the state; -1: all */

enum rdm_shape_kind {
  RDM_SPHERE = 0, RDM_CAPSULE = 1, RDM_BOX = 2, RDM_CYLINDER = 3, RDM_PLANE = 4, RDM_ELLIPSOID = 5, RDM_HULL = 6
};
typedef struct rdm_shape {   /* frozen layout: what the scene is made of, the same for all worlds */
  const char *name;          /* "right.ff_distal"                                                         */
  float size[3];             /* m: radius | radius, half length along z | half sizes (hull: of its box)   */
  int32_t kind;              /* RDM_SPHERE ... RDM_HULL; plane: the half space below z = 0 of its frame   */
  uint8_t color[4];          /* red, green, blue, 255                                                     */
  int32_t fixed;             /* flag: never moves                                                         */
} rdm_shape;
RDM_API rdm_result rdm_pool_shape(const rdm_pool *p, int32_t i, rdm_shape *out); /* i < num_shapes */
/* pose [num_shapes][7]: position (m), quaternion (x, y, z, w); world frame of that world. */
RDM_API rdm_result rdm_pool_poses(const rdm_pool *p, int32_t env, float *pose);
typedef struct rdm_contact { /* frozen layout: one contact point of the last substep */
  int32_t shape_a, shape_b;  /* for rdm_pool_shape                                                        */
  float position[3];         /* m                                                                         */
  float normal[3];           /* unit, from b into a                                                       */
  float force[3];            /* N, on a                                                                   */
  float depth;               /* m                                                                         */
} rdm_contact;
/* Writes up to capacity contacts to out [capacity]; *count is how many there are. */
RDM_API rdm_result rdm_pool_contacts(const rdm_pool *p, int32_t env, rdm_contact *out, int32_t capacity,
                                     int32_t *count);
/* A picture of world env. camera: a name of the task's. rgb [h][w][3], depth [h][w] (m along the optical
 * axis, 0: nothing hit), segmentation [h][w] (shape, -1: nothing); each may be NULL. 1 <= w, h <= 8192. */
RDM_API rdm_result rdm_pool_render(rdm_pool *p, int32_t env, const char *camera, int32_t w, int32_t h,
                                   uint8_t *rgb, float *depth, int32_t *segmentation);
typedef struct rdm_pool_stats {
  uint32_t struct_size;      /* in: bytes                                                                 */
  int32_t contacts_max;      /* largest number of contacts in a substep's list since create, all worlds   */
  double contacts_mean;      /* mean of the same                                                          */
  double joint_drift;        /* m, largest gap of any joint now, all worlds                               */
  int64_t steps;             /* control steps of one world, summed over worlds                            */
  int64_t diverged;          /* worlds flagged RDM_STATUS_DIVERGED so far                                 */
  int64_t overflowed;        /* steps flagged RDM_STATUS_CONTACTS so far                                  */
} rdm_pool_stats;
RDM_API rdm_result rdm_pool_get_stats(const rdm_pool *p, rdm_pool_stats *io); /* fills io */

/* ---- agent: one algorithm that acts and learns ---------------------------------------------------------------- */
typedef struct rdm_agent rdm_agent;
enum rdm_act_mode { RDM_SAMPLE = 0, RDM_MEAN = 1 };
typedef struct rdm_agent_config {
  uint32_t struct_size;       /* bytes, set by rdm_agent_config_init                                      */
  int32_t obs_dim;            /* count, 1..16384, required                                                */
  int32_t action_dim;         /* count, 1..1024, required                                                 */
  int32_t cost_dim;           /* cost columns recorded, 0..RDM_MAX_COSTS, default 1                       */
  int32_t num_envs;           /* rows per act, 1..65536, required                                         */
  int32_t num_threads;        /* 0 or 1: the caller's only; up to 256; default 0                          */
  const char *algo;           /* "ppo", "ppo_lag"; copied; default "ppo_lag"                              */
  const char *task;           /* kept in policy files, "" for a host's own environment; copied            */
  uint64_t seed;              /* of weights, noise, shuffling; default 0                                  */
  uint64_t layout_hash;       /* kept in policy files; 0: unknown                                         */
  float control_dt;           /* s, kept in policy files; 0: unknown                                      */
  int32_t max_steps;          /* control steps of an episode, for terminal_cost; 0: unknown               */
  const float *initial_mean;  /* [action_dim] mean action of the new policy, copied; NULL: 0              */
  const rdm_option *defaults; /* [num_defaults] laid under options (a task's); "algo:key" is for one algo */
  const rdm_option *options;  /* [num_options] the caller's; NULL: none                                   */
  int32_t num_defaults;       /* count, default 0                                                         */
  int32_t num_options;        /* count, default 0                                                         */
  const double *cost_limits;  /* [cost_dim] on the sum over an episode, < 0: none; NULL: option cost_limit for column 0 */
  const rdm_host *host;       /* hooks of this handle, copied; NULL: those of rdm_init                    */
  const char *settings;       /* options as lines key=value, laid over `options`, copied; NULL: none      */
  char *error;                /* [error_size] the text of a failing call that takes this config; NULL     */
  int32_t error_size;         /* bytes, terminator included; what is longer is cut                        */
  int32_t reserved2;          /* 0                                                                        */
} rdm_agent_config;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first version's. */
RDM_API rdm_result rdm_agent_config_init(rdm_agent_config *c, size_t size);
/* Sets dims, num_envs, task, layout_hash, control_dt, max_steps, defaults, initial_mean and cost_limits from a pool.
 * Pointers are borrowed from the pool. */
RDM_API rdm_result rdm_agent_config_for_pool(rdm_agent_config *c, const rdm_pool *p);
/* Bytes that creation takes from the alloc hook, exact. */
RDM_API rdm_result rdm_agent_memory(const rdm_agent_config *c, size_t *bytes);
/* Makes the agent; the config's arrays are copied. */
RDM_API rdm_result rdm_agent_create(rdm_agent **out, const rdm_agent_config *c);
RDM_API void rdm_agent_destroy(rdm_agent *a);               /* NULL is fine */
RDM_API const char *rdm_agent_error(const rdm_agent *a);    /* last failure on this handle; "" at first */

/* action [num_envs][action_dim]: a sample (it is remembered, and record must follow) or the mean of the policy
 * for obs [num_envs][obs_dim] (nothing is remembered). One call is one decision: hold the action for the option
 * action_repeat control steps. Samples are not clipped. */
RDM_API rdm_result rdm_agent_act(rdm_agent *a, const float *obs, int32_t mode, float *action);
typedef struct rdm_transition { /* what followed the last sampled actions; a row per environment */
  uint32_t struct_size;       /* bytes                                                                    */
  uint32_t reserved;          /* 0                                                                        */
  const float *reward;        /* [num_envs] summed over the decision, required                            */
  const float *cost;          /* [num_envs][cost_dim] likewise; NULL only if cost_dim is 0                */
  const uint8_t *terminated;  /* [num_envs] NULL: none                                                    */
  const uint8_t *truncated;   /* [num_envs] NULL: none                                                    */
  const float *final_obs;     /* [num_envs][obs_dim] read where truncated; NULL: truncation has value 0   */
  const uint8_t *valid;       /* [num_envs] 0: a dead transition, not learned from; NULL: all valid       */
  const uint8_t *success;     /* [num_envs] for the statistics; NULL: none                                */
  const int32_t *steps;       /* [num_envs] control steps in this decision; NULL: action_repeat           */
} rdm_transition;
/* STATE unless a sampled act came before, or when the horizon is full. */
RDM_API rdm_result rdm_agent_record(rdm_agent *a, const rdm_transition *t);

typedef struct rdm_epoch {    /* one row of the learning curve; means over the last 100 finished episodes */
  uint32_t struct_size;       /* in: bytes                                                                */
  int32_t epoch;              /* count from 1                                                             */
  int64_t env_steps;          /* control steps so far, all environments                                   */
  int64_t episodes;           /* finished so far                                                          */
  double ret;                 /* sum of rewards of an episode                                             */
  double cost[RDM_MAX_COSTS]; /* sum of each cost column of an episode                                    */
  double cost_per_step;       /* column 0, per control step                                               */
  double length;              /* control steps of an episode                                              */
  double fall_rate;           /* share of episodes that terminated                                        */
  double success_rate;        /* share of episodes with at least one success                              */
  double multiplier[RDM_MAX_COSTS]; /* of each cost, 0 where the algorithm has none                       */
  /* KL(old || new), summed over action dimensions. First-order algorithms: the mean over the last pass, of each
   * minibatch before its step, so 0 after one pass in one step. Trust regions: of the step that was taken. */
  double kl;
  double entropy;             /* of the policy                                                            */
  double learning_rate;       /* of the actor, used in this epoch                                         */
  double action_std;          /* mean over dimensions                                                     */
  double loss_policy;         /* mean over minibatches                                                    */
  double loss_reward_value;   /* mean squared error                                                       */
  double loss_cost_value;     /* mean squared error                                                       */
  double clip_fraction;       /* share of samples whose ratio was clipped                                 */
  double value_reward;        /* mean prediction over the batch                                           */
  double value_cost;          /* mean prediction over the batch                                           */
  int32_t passes;             /* over the data, fewer after an early stop                                 */
  int32_t reserved;           /* 0                                                                        */
} rdm_epoch;
/* Learns from a full horizon; last_obs [num_envs][obs_dim] follows the last record. io may be NULL. STATE when
 * the horizon is not full, CANCELLED after rdm_agent_cancel (the horizon is dropped). */
RDM_API rdm_result rdm_agent_update(rdm_agent *a, const float *last_obs, rdm_epoch *io);
/* One epoch natively: act, step (action_repeat control steps), record until the horizon is full, then update. The
 * pool must have been reset and must not have autoreset off; dims and num_envs must agree. A pool that repeats
 * actions itself takes as many steps at a time: the agent's action_repeat must be a multiple of the pool's, as the
 * defaults are that rdm_agent_config_for_pool sets. */
RDM_API rdm_result rdm_agent_rollout(rdm_agent *a, rdm_pool *p, rdm_epoch *io);
/* Async-signal-safe, from any thread: the running or next rollout or update returns CANCELLED. */
RDM_API void rdm_agent_cancel(rdm_agent *a);
/* Changes a live option. NOT_FOUND, RANGE, or STATE when it is not live. */
RDM_API rdm_result rdm_agent_set(rdm_agent *a, const rdm_option *option);
/* Option i of the algorithm as this agent has it: key (static) and the value as text [RDM_TEXT_SIZE], which reads
 * back exactly. RANGE for a text that is longer: rdm_agent_settings has it. */
RDM_API rdm_result rdm_agent_option(const rdm_agent *a, int32_t i, const char **key, char *text);
/* All options as text [capacity] of lines key=value: given as settings they make an agent of the same options. */
RDM_API rdm_result rdm_agent_settings(const rdm_agent *a, char *text, size_t capacity, size_t *size);

typedef struct rdm_tensor {   /* frozen layout: a named block of parameters */
  const char *name;           /* "actor.0.weight", "actor.log_std", "reward_critic.1.bias"                */
  int32_t rows, cols;         /* row-major; cols 1 for vectors                                            */
} rdm_tensor;
RDM_API rdm_result rdm_agent_tensor(const rdm_agent *a, int32_t i, rdm_tensor *out); /* RANGE ends the list */
/* Copies the named tensor to out [count] or from values [count]; count must be rows * cols. NOT_FOUND, RANGE. */
RDM_API rdm_result rdm_agent_tensor_read(const rdm_agent *a, const char *name, float *out, size_t count);
RDM_API rdm_result rdm_agent_tensor_write(rdm_agent *a, const char *name, const float *values, size_t count);

/* The frozen policy as the bytes [capacity] of a policy file; NULL asks for the size. */
RDM_API rdm_result rdm_agent_policy(const rdm_agent *a, void *bytes, size_t capacity, size_t *size);
RDM_API rdm_result rdm_agent_policy_file(const rdm_agent *a, const char *path); /* replaced atomically */
/* All state of the agent (networks, optimiser, multipliers, normaliser, streams, counters), between epochs:
 * STATE inside a horizon. load needs an agent of the same config and changes nothing when it fails. */
RDM_API rdm_result rdm_agent_save(const rdm_agent *a, void *bytes, size_t capacity,
                                  size_t *size); /* to bytes [capacity]; NULL asks for the size */
RDM_API rdm_result rdm_agent_load(rdm_agent *a, const void *bytes, size_t size); /* of bytes [size] */
/* Agent, pool (may be NULL) and a note [note_size] of the host's own, to 2^26 bytes, in one file, replaced
 * atomically. */
RDM_API rdm_result rdm_checkpoint_write(const char *path, const rdm_agent *a, const rdm_pool *p,
                                        const void *note, size_t note_size);
/* Reads it back; note [capacity] gets as many bytes, *note_size is how many there are. Nothing changes on failure. */
RDM_API rdm_result rdm_checkpoint_read(const char *path, rdm_agent *a, rdm_pool *p, void *note, size_t capacity,
                                       size_t *note_size);

/* ---- policy: the frozen network -------------------------------------------------------------------------------- */
typedef struct rdm_policy rdm_policy;
typedef struct rdm_policy_info {
  uint32_t struct_size;       /* in: bytes                                                                */
  int32_t obs_dim;            /* count                                                                    */
  int32_t action_dim;         /* count                                                                    */
  int32_t action_repeat;      /* control steps to hold each action                                        */
  float control_dt;           /* s, 0: unknown                                                            */
  float noise_correlation;    /* AR(1) coefficient of the noise it was trained with                       */
  uint64_t layout_hash;       /* 0: unknown                                                               */
  uint64_t num_params;        /* of the network                                                           */
  const char *task;           /* "" for a host's own environment                                          */
  const char *activation;     /* of the hidden layers: "tanh", "elu", "relu"; static                      */
} rdm_policy_info;
RDM_API rdm_result rdm_policy_load(rdm_policy **out, const void *bytes, size_t size); /* copies bytes [size] */
RDM_API rdm_result rdm_policy_load_file(rdm_policy **out, const char *path);          /* NOT_FOUND, FORMAT ... */
RDM_API void rdm_policy_destroy(rdm_policy *p);             /* NULL is fine */
RDM_API rdm_result rdm_policy_get_info(const rdm_policy *p, rdm_policy_info *io); /* fills io */
RDM_API size_t rdm_policy_scratch(const rdm_policy *p, int32_t rows); /* bytes for act, at any address; 0: bad arguments */
/* action [rows][action_dim] = clip(mean + std noise, -1, 1) for obs [rows][obs_dim]. noise [rows][action_dim] are
 * the caller's standard normals, NULL: the mean. scratch [scratch_bytes]: rdm_policy_scratch bytes or more, aligned
 * in any way. No heap, no hidden state: any number of threads, each with its own scratch. ARGUMENT when obs or noise
 * is not finite, or so large that the network overflows (action is written then, and of no use). */
RDM_API rdm_result rdm_policy_act(const rdm_policy *p, const float *obs, int32_t rows, const float *noise,
                                  float *action, void *scratch, size_t scratch_bytes);
/* "actor.0.weight" of rows outputs and cols inputs, "actor.log_std" or "actor.log_std_bounds",
 * "normalizer.shift|scale|clip", "example.obs|action". RANGE ends the list. */
RDM_API rdm_result rdm_policy_tensor(const rdm_policy *p, int32_t i, rdm_tensor *out);
/* Copies the named tensor to out [count]; count must be rows * cols. NOT_FOUND, RANGE. */
RDM_API rdm_result rdm_policy_tensor_read(const rdm_policy *p, const char *name, float *out, size_t count);
/* OK, or VERSION_MISMATCH with a text that says which field of the spec differs. */
RDM_API rdm_result rdm_policy_check(const rdm_policy *p, const rdm_spec *spec);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_H */

/* ==== experimental: all below this line may change in any release until version 1 ===========================
 * #define RDM_EXPERIMENTAL before the #include to see it, in a file that has seen the rest before, too. */
#if defined(RDM_EXPERIMENTAL) && !defined(REDMAN_H_EXPERIMENTAL)
#define REDMAN_H_EXPERIMENTAL
#ifdef __cplusplus
extern "C" {
#endif

/* Pushes a shape's carrier during the next step: force [3] at its centre of mass, N, world axes. */
RDM_API rdm_result rdm_pool_push(rdm_pool *p, int32_t env, int32_t shape, const float force[3]);

/* ---- maps: what is occupied, free and unknown in space ------------------------------------------------------ */
/* Built from scans: point clouds of your own, or of a pool's cameras. Files are those of OctoMap (.bt, .ot).
 *
 *   rdm_map_config c;  rdm_map *m;
 *   rdm_map_config_init(&c, sizeof c);
 *   c.resolution = 0.02;
 *   if (rdm_map_create(&m, &c)) puts(rdm_last_error());
 *   rdm_map_scan(m, pool, 0, "top", 96, 96, NULL, 0, &dropped);   a look of world 0's camera, or
 *   rdm_map_insert(m, origin, points, count, &dropped);           points of your own sensor
 *   rdm_map_query(m, points, count, probability);
 *   rdm_map_destroy(m);
 *
 * One thread writes a map at a time; while none does, any number may read. All points are float [3] in m. */
typedef struct rdm_map rdm_map;
typedef struct rdm_map_config {
  uint32_t struct_size;    /* bytes, set by rdm_map_config_init                                           */
  uint32_t reserved;       /* 0                                                                           */
  double resolution;       /* side of a voxel, m, 0.001 to 10, default 0.02                               */
  uint64_t memory;         /* bytes that tree and workspace may take, 2^20 to 2^36, default 2^26          */
  double max_range;        /* m; longer rays clear their way so far; 0: none is too long; default 0       */
  double hit;              /* probability of occupied where a ray ends, 0.5 to 0.999, default 0.7         */
  double miss;             /* the same where one passes, 0.001 to 0.5, default 0.4                        */
  double low;              /* no probability goes below, 0.001 to 0.5, default 0.1192                     */
  double high;             /* no probability goes above, 0.5 to 0.999, default 0.971                      */
  double threshold;        /* occupied from this probability on, low to high, default 0.5                 */
  const rdm_host *host;    /* hooks for the workspace, copied; NULL: those of rdm_init                    */
  char *error;             /* [error_size] the text of a failing call that takes this config; NULL        */
  int32_t error_size;      /* bytes, terminator included; what is longer is cut                           */
  int32_t reserved2;       /* 0                                                                           */
} rdm_map_config;
typedef struct rdm_map_info {
  uint32_t struct_size;    /* in: bytes                                                                   */
  uint32_t full;           /* 1: updates have been dropped since create, clear or load                    */
  double resolution;       /* m; a load takes the file's                                                  */
  uint64_t nodes;          /* of the tree                                                                 */
  uint64_t bytes;          /* of the tree                                                                 */
  uint64_t bytes_max;      /* memory less the workspace                                                   */
  uint64_t dropped;        /* voxel updates that found no memory, since create, clear or load             */
} rdm_map_info;
typedef struct rdm_voxel { /* frozen layout */
  float centre[3];         /* m                                                                           */
  float side;              /* m; a multiple of the resolution where voxels were joined                    */
} rdm_voxel;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first version's. */
RDM_API rdm_result rdm_map_config_init(rdm_map_config *c, size_t size);
RDM_API rdm_result rdm_map_create(rdm_map **out, const rdm_map_config *c); /* RANGE outside the bounds */
RDM_API void rdm_map_destroy(rdm_map *m);                   /* NULL is fine */
/* Last failure of a call that may change the map; "" at first. Of those that only read, which many threads may
 * make at a time: rdm_last_error(). */
RDM_API const char *rdm_map_error(const rdm_map *m);
RDM_API rdm_result rdm_map_get_info(const rdm_map *m, rdm_map_info *io); /* fills io */
RDM_API rdm_result rdm_map_clear(rdm_map *m);               /* all is unknown again */

/* One scan: rays from origin [3] to points [count][3]. Each voxel changes once: up where a ray ends, else down where
 * rays pass. Points that are not finite are left out. A full map grows no more: the call returns OK, *dropped (may
 * be NULL) says how many voxels were left out, and voxels that exist go on being updated. */
RDM_API rdm_result rdm_map_insert(rdm_map *m, const float origin[3], const float *points, size_t count,
                                  uint64_t *dropped);
/* One scan by a camera of the pool's task: depths of w x h rays of world env. Rays that end on one of the num_skip
 * shapes in skip [num_skip], or meet nothing, are left out. *dropped as above. */
RDM_API rdm_result rdm_map_scan(rdm_map *m, rdm_pool *p, int32_t env, const char *camera, int32_t w, int32_t h,
                                const int32_t *skip, int32_t num_skip, uint64_t *dropped);

/* probability [count] that the voxel of each of points [count][3] is occupied; -1: unknown. */
RDM_API rdm_result rdm_map_query(const rdm_map *m, const float *points, size_t count, float *probability);
/* Occupied voxels that meet the box from low [3] to high [3]: writes up to capacity to out [capacity], *count is how
 * many there are. */
RDM_API rdm_result rdm_map_box(const rdm_map *m, const float low[3], const float high[3], rdm_voxel *out,
                               size_t capacity, size_t *count);
/* *meets is 1 when an occupied voxel meets the turned box: pose [7] (position, quaternion), half sizes half [3]. */
RDM_API rdm_result rdm_map_meets(const rdm_map *m, const float pose[7], const float half[3], int32_t *meets);
/* Where the ray from origin [3] along direction [3] enters the first occupied voxel within `range` m: *found is 1 and
 * hit [3] is written. An unknown voxel ends the ray unless through_unknown is 1. */
RDM_API rdm_result rdm_map_raycast(const rdm_map *m, const float origin[3], const float direction[3], float range,
                                   int32_t through_unknown, float hit[3], int32_t *found);
/* distance [count] from each of points [count][3] to the nearest point of an occupied voxel, m; `most` if none is so
 * near. */
RDM_API rdm_result rdm_map_distance(const rdm_map *m, const float *points, size_t count, float most,
                                    float *distance);
/* A grid of counts n [3] of cells of `side` m (each count 1 to 1024) about pose [7]: what the map says at their
 * centres, out [n0][n1][n2], x outermost: 1 occupied, 0 free, -1 unknown. */
RDM_API rdm_result rdm_map_grid(const rdm_map *m, const float pose[7], const int32_t n[3], float side, int8_t *out);

/* OctoMap's files: RDM_MAP_BINARY (.bt: occupied or free) and RDM_MAP_FULL (.ot: the probabilities too). */
enum rdm_map_format { RDM_MAP_BINARY = 0, RDM_MAP_FULL = 1 };
/* The map as the bytes [capacity] of a file; NULL asks for the size. */
RDM_API rdm_result rdm_map_save(const rdm_map *m, int32_t format, void *bytes, size_t capacity, size_t *size);
RDM_API rdm_result rdm_map_save_file(const rdm_map *m, const char *path); /* by its ending; replaced atomically */
/* bytes [size] of a file take the place of what the map holds, resolution included. FORMAT, or MEMORY when it does not fit: unchanged. */
RDM_API rdm_result rdm_map_load(rdm_map *m, const void *bytes, size_t size);
RDM_API rdm_result rdm_map_load_file(rdm_map *m, const char *path);       /* NOT_FOUND, FORMAT ... */

/* ---- what the worlds of a pool see, beside rdm_buffers -------------------------------------------------------- */
/* The option `modality` of every task says what is made in each reset and step ("points", "rgb+depth"); other
 * options say from which cameras and how large. Rows show the state that obs shows; nothing is kept of the state
 * before an automatic reset.
 *
 *   rdm_option seen[] = {{"modality", "points", 0}, {"points", NULL, 1024}};
 *   config.options = seen;  config.num_options = 2;  ... rdm_pool_create(&p, &config) ...
 *   rdm_sensors s = {.struct_size = sizeof s};
 *   rdm_pool_sensors(p, &s);
 *   for (...) { rdm_pool_step(p);  use s.points + 3 * s.num_points * env; }
 */
typedef struct rdm_sensors {      /* the same addresses until destroy; NULL where the modality is off              */
  uint32_t struct_size;           /* in: bytes                                                                     */
  int32_t num_cameras;            /* of rgb, depth and segmentation, in the order of the option `cameras`          */
  int32_t width;                  /* pixels                                                                        */
  int32_t height;                 /* pixels                                                                        */
  int32_t num_points;             /* of a world, option `points`                                                   */
  int32_t num_voxels;             /* along each side of the local grid, option `voxels`                            */
  float voxel_size;               /* m                                                                             */
  int32_t reserved;               /* 0                                                                             */
  const uint8_t *rgb;             /* [num_envs][num_cameras][height][width][3]                                     */
  const float *depth;             /* [num_envs][num_cameras][height][width], m along the optical axis, 0: nothing  */
  const int32_t *segmentation;    /* [num_envs][num_cameras][height][width], shape of rdm_pool_shape, -1: nothing  */
  const float *points;            /* [num_envs][num_points][3], world, m; planes are left out                      */
  const int32_t *point_shape;     /* [num_envs][num_points], -1: nothing was seen                                  */
  const int32_t *point_count;     /* [num_envs] points that differ; the rest repeats them in turn                  */
  const int8_t *voxels;           /* [num_envs][num_voxels][num_voxels][num_voxels] (x, y, z) about the task's
                                   * object: 1 occupied, 0 free, -1 not seen                                       */
} rdm_sensors;
RDM_API rdm_result rdm_pool_sensors(const rdm_pool *p, rdm_sensors *io); /* fills io */
/* The cameras that rows stand for: i-th of the pictures (cloud 0) or of points and voxels (cloud 1). RANGE ends. */
RDM_API rdm_result rdm_pool_sensor_camera(const rdm_pool *p, int32_t cloud, int32_t i, rdm_camera *out);

/* Corners, points [capacity][3], of shape i, an RDM_HULL, in its own frame, m. Writes up to capacity of them; *count
 * is how many there are. */
RDM_API rdm_result rdm_pool_hull(const rdm_pool *p, int32_t i, float *points, int32_t capacity, int32_t *count);

/* `wanted` of points [count][3] that lie furthest from each other: their numbers, in order of choice, to chosen
 * [wanted]. `start` is the first. Exact. scratch [scratch_bytes]: rdm_sample_scratch bytes or more, aligned in any
 * way; no heap. */
RDM_API rdm_result rdm_sample_furthest(const float *points, int32_t count, int32_t wanted, int32_t start,
                                       int32_t *chosen, void *scratch, size_t scratch_bytes);
RDM_API size_t rdm_sample_scratch(int32_t count); /* bytes, at any address; 0: count is outside [1, 2^22] */

#ifdef __cplusplus
}
#endif
#endif /* RDM_EXPERIMENTAL */
