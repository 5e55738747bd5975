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
 *   - A pool and an agent: one thread at a time, not bound to a thread; rdm_agent_cancel and the _error functions from
 *     any. A policy: immutable, shared freely. What takes no handle: any number of threads.
 *   - One call at a time changes a pool, agent, planner, recording or map; while none does, any number read one (take it
 *     as `const`; an agent never). A call that comes while another is within is STATE, and does nothing: of a second
 *     thread, or of a callback or hook on the handle that it is called for. Its text is rdm_last_error() alone. A
 *     rollout is within its agent and its pool, a plan within its planner and its critic's agent, and reads its pool.
 *     To destroy a handle while a call is within does nothing either, and the log hook of the handle is told: destroy
 *     it once more afterwards.
 *   - fork: in the child, handles with threads of their own (num_threads above 1 and no parallel hook) answer
 *     STATE to what needs those, and can be destroyed; all others go on as in the parent.
 *   - A handle of another kind, or one that was destroyed and whose memory has not been used since, is an
 *     ARGUMENT; to destroy such a one does nothing.
 *   - Structs begin with struct_size = sizeof of your version: set it yourself or through the _init function.
 *     ARGUMENT for less than the first version had or more than 4096.
 *   - Strings that are returned live as long as their handle (those of tasks, algorithms, robots and objects: for ever, also
 *     where these are removed; equal ones are kept once). UTF-8.
 *     What is no UTF-8 in a name that was given stands in a text as \xNN.
 *   - Arrays are row-major. SI units, radians. Quaternions are (x, y, z, w) here and in observations.
 *   - Same seed, same bytes: for any number of threads; worlds on every little-endian machine whose ODE and libccd were
 *     compiled without fused multiply-adds (rdm_build.differs), learners on every machine with the same rdm_build.kernels.
 *
 * How to read the declarations, for generators of bindings (tests/rules/check_contract.py holds them to it):
 *   - `const T *x` is read, `T *x` is written. `x [rows][obs_dim]` in the comment of the function, or `[rows][obs_dim]`
 *     first in the comment of a member, makes x an array of that shape; without one it is a single value. A
 *     function's comment is what stands behind it, then what stands above the run of functions that it is in.
 *   - Words in a shape are arguments of the function, members of structs, or macros; n0 is the first number of n.
 *   - An array whose comment says so may be NULL; a struct with struct_size that is no config is in and out.
 *   - `const char *` is a text that ends in 0. `rdm_pool *`, `rdm_agent *`, `rdm_policy *`, `rdm_actor *`, `rdm_recording *`, `rdm_planner *`,
 *     `rdm_map *`, `rdm_scene *` and `rdm_world *` are handles, through `**` new ones. `void *` with a shape is bytes; other ones are passed through.
 *   - Text and bytes of any length come as (T *x, size_t capacity, size_t *size): x NULL asks for the size alone, a
 *     capacity below it is RANGE. The size of a text is without its 0, for which the capacity must have room.
 */
#ifndef REDMAN_H
#define REDMAN_H
#include <stddef.h>
#include <stdint.h>

#if !defined(RDM_API)
#if defined(_WIN32)
#define RDM_API /* the library exports the names of its list; programs need no mark */
#elif defined(__GNUC__)
#define RDM_API __attribute__((visibility("default")))
#else
#define RDM_API
#endif
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Of this header; that of the library is rdm_version(). */
#define RDM_VERSION_MAJOR 0
#define RDM_VERSION_MINOR 1
#define RDM_VERSION_PATCH 0
#define RDM_VERSION (RDM_VERSION_MAJOR * 1000000 + RDM_VERSION_MINOR * 1000 + RDM_VERSION_PATCH)
#define RDM_ABI 1          /* = SONAME; moves only when an old binary would break */
#define RDM_MAX_COSTS 16   /* cost columns of a task or an agent */
#define RDM_TEXT_SIZE 64   /* bytes of an option's text value, terminator included */

/* ---- results ------------------------------------------------------------------------------------------ */
typedef int32_t rdm_result; /* frozen values; positive ones are reserved */
enum rdm_result_code { /* values of rdm_result */
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
/* The halves of the library: worlds, learners; and frozen policies, which a build may have without the learners. */
enum rdm_feature { RDM_FEATURE_SIM = 1, RDM_FEATURE_LEARN = 2, RDM_FEATURE_POLICY = 4 };
RDM_API uint32_t rdm_version(void);  /* RDM_VERSION of the library that runs */
RDM_API uint32_t rdm_features(void); /* RDM_FEATURE_*: what this build has */
/* VERSION_MISMATCH unless the library has this ABI and at least this version. */
RDM_API rdm_result rdm_check_abi(uint32_t abi, uint32_t version);
typedef struct rdm_build { /* what this library was made of */
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
  const char *differs;    /* "ODE", "libccd", "ODE, libccd": these compute other bytes here than on the machines of the
                           * recorded hashes (compiled with fused multiply-adds, as by Debian for arm64, or another
                           * version), and so do worlds with contacts; "": none, or no simulation half */
} rdm_build;
RDM_API rdm_result rdm_build_info(rdm_build *io); /* fills io; strings are static */

/* ---- host hooks --------------------------------------------------------------------------------------- */
typedef void (*rdm_body)(void *context, int32_t index); /* one piece of parallel work */
typedef struct rdm_host { /* what a host gives in the place of the C library and of our threads */
  uint32_t struct_size;   /* bytes                                                                     */
  uint32_t reserved;      /* 0                                                                         */
  void *user;             /* passed back to every hook; may be NULL                                    */
  /* `bytes` at a multiple of `align` (a power of two up to 64), or NULL. NULL hook: the C library's.   */
  void *(*alloc)(void *user, size_t bytes, size_t align);
  void (*release)(void *user, void *p, size_t bytes, size_t align); /* required with alloc             */
  void (*log)(void *user, int32_t level, const char *line); /* 0 info, 1 warning, 2 error; NULL: silent */
  /* Must run body(context, i) once for every i in [0, n), each on one OS thread, and return when all are
   * done; may be serial. NULL: redman's own workers. Where it runs fewer, one twice or another one, or returns
   * before all are done, the call that needed it is STATE and says so: it was done in part, and bodies that
   * come later do nothing.                                                                              */
  void (*parallel)(void *user, int32_t n, rdm_body body, void *context);
} rdm_host;
/* Process-wide hooks for handles made later, whose configs give none. Counted; NULL: defaults. Optional. */
RDM_API rdm_result rdm_init(const rdm_host *host);
RDM_API void rdm_shutdown(void); /* the last call puts the default hooks back; handles stay valid */

/* ---- options ------------------------------------------------------------------------------------------ */
enum rdm_option_kind { RDM_NUMBER = 0, RDM_INTEGER = 1, RDM_FLAG = 2, RDM_TEXT = 3 }; /* of an option */
typedef struct rdm_option { /* frozen layout: one key and its value */
  const char *key;          /* case is ignored and '-' equals '_'                             */
  const char *text;         /* value as one line of text ("0.5", "0.7..1.3", "egg"); NULL: number is it */
  double number;            /* value when text is NULL                                        */
} rdm_option;
typedef struct rdm_option_info { /* frozen layout: one row of an option table */
  const char *key;          /* static; its last word FIELD: any name of a field, or a pattern with '*' */
  const char *help;         /* one line, with the unit                                        */
  const char *text;         /* default of a text option, or of a number that is a range, else NULL */
  const char *choices;      /* text: allowed words "a|b|c", NULL: any; number, integer: "a..b": takes a range
                             * "0.7..1.3" too, which each world draws from at a reset; else NULL */
  double number;            /* default of number, integer, flag; of a range its middle        */
  double low, high;         /* inclusive bounds                                               */
  int32_t kind;             /* RDM_NUMBER, RDM_INTEGER, RDM_FLAG, RDM_TEXT                    */
  int32_t live;             /* flag: rdm_agent_set may change it after creation               */
} rdm_option_info;
/* Options as one text, wherever a config has `settings`: lines `key=value`; spaces about either, '\r' and lines that
 * are empty do not count. They are laid over the config's `options`, later ones over earlier ones; an error names
 * the line. A NULL is none. */

/* ---- discovery: what exists, and what every number in a row means --------------------------------------- */
typedef struct rdm_task { /* a task with its default options */
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
  float eye[3];             /* m, in the frame that mount names                               */
  float target[3];          /* m, likewise; the picture's centre looks from eye to target     */
  float fov_y;              /* rad, vertical field of view                                    */
  int32_t mount;            /* 0: the world's frame; k > 0: of link k - 1 of the scene; -k: of the base of its
                             * articulation k - 1 (cameras that ride on a robot)              */
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

typedef struct rdm_algo { /* an algorithm */
  uint32_t struct_size;     /* in: bytes                                                      */
  int32_t num_options;      /* for rdm_algo_option                                            */
  const char *name;         /* "ppo_lag"                                                      */
  const char *summary;      /* one line with the paper                                        */
} rdm_algo;
RDM_API int32_t rdm_algo_count(void); /* number of algorithms; 0 without the learning half */
RDM_API rdm_result rdm_algo_at(int32_t index, rdm_algo *io);                   /* RANGE past the end */
RDM_API rdm_result rdm_algo_find(const char *name, int32_t *index);            /* NOT_FOUND: nearest in the text */
RDM_API rdm_result rdm_algo_option(int32_t algo, int32_t i, rdm_option_info *out); /* i < num_options */

typedef struct rdm_robot { /* a robot description */
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

typedef struct rdm_object { /* frozen layout: a thing by name, for option object=... */
  const char *name;         /* "egg"                                                          */
  const char *shape;        /* "capsule r 0.03, straight part 0.02": kind and sizes in m      */
  double mass;              /* kg; hull: of the default points, 500 kg/m3                     */
} rdm_object;
RDM_API int32_t rdm_object_count(void); /* number of objects, those that were removed too */
RDM_API rdm_result rdm_object_at(int32_t index, rdm_object *out);              /* RANGE past the end; NOT_FOUND: removed */

/* ---- pool: worlds of one task, stepped together ----------------------------------------------------------- */
typedef struct rdm_pool rdm_pool; /* handle */
/* When a world begins again by itself: in the step that ended its episode, in the next, or never. */
enum rdm_autoreset { RDM_AUTORESET_SAME_STEP = 0, RDM_AUTORESET_NEXT_STEP = 1, RDM_AUTORESET_OFF = 2 };
enum rdm_status {                  /* bits of rdm_buffers.status */
  RDM_STATUS_CONTACTS = 1,         /* contacts beyond contacts_max were left out              */
  RDM_STATUS_DIVERGED = 2,         /* a value was not finite: the episode was truncated       */
  RDM_STATUS_BAD_ACTION = 4,       /* the row of actions was not finite: likewise             */
  RDM_STATUS_TASK = 8,             /* a function of a host's own task failed: likewise        */
  RDM_STATUS_SOLVER = 16,          /* contacts were not solved, not seen in engine ode: one was wrong by more than 1 m/s
                                    * along its normal when the sweeps ended (much under something heavier, with few
                                    * iterations), or gave way for ever (a contact_max_speed below 0.02 m/s) */
  RDM_STATUS_SLOWED = 32           /* a free body that turned by more than 3 rad in a substep was slowed to that */
};
typedef struct rdm_pool_config { /* what a pool is made from */
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

typedef struct rdm_spec { /* sizes of a pool's rows; what a policy is checked against */
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
/* Option i of the task as this pool has it: key and the value as text [RDM_TEXT_SIZE], which reads back exactly. RANGE
 * for a text that is longer: rdm_pool_settings has it. Behind the task's num_options come keys with a FIELD that were
 * set, in order; RANGE ends them. */
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
  uint32_t *status;          /* [num_envs] RDM_STATUS_* of the last step or reset                         */
  uint8_t *terminated;       /* [num_envs] 1: the task ended (a fall)                                     */
  uint8_t *truncated;        /* [num_envs] 1: cut by the time limit or a bad status                       */
  uint8_t *success;          /* [num_envs] 1: the task's success holds in this step                       */
  uint32_t *episode_status;  /* [num_envs] all RDM_STATUS_* of the episode; the finished one's where one ended */
} rdm_buffers;
RDM_API rdm_result rdm_pool_buffers(const rdm_pool *p, rdm_buffers *io); /* borrowed pointers */
/* Non-NULL pointers of b take the place of the pool's (sizes as above, at least 4-byte aligned; they must
 * outlive the pool or the next bind); NULL ones keep what is there. Contents are copied over. */
RDM_API rdm_result rdm_pool_bind(rdm_pool *p, const rdm_buffers *b);

/* Starts new episodes where mask [num_envs] is not 0 (NULL: everywhere). seeds [num_envs] name new streams: the seed
 * alone, whatever the world's number, so that seed s gives what a pool of one world created with seed s has. NULL: go
 * on with the worlds' own, which after create is (config.seed, i). Costs are 0 afterwards. An entry of the first
 * observation that is not finite is written as 0, and the world is flagged RDM_STATUS_DIVERGED, its episode with it.
 * Where a host's own task fails: its error, for the lowest such world; these are flagged RDM_STATUS_TASK and stand as if
 * they were never reset, the others have begun. */
RDM_API rdm_result rdm_pool_reset(rdm_pool *p, const uint64_t *seeds, const uint8_t *mask);
/* One control step of every world: reads action, writes all the rest. STATE before the first reset, and with
 * autoreset off while an ended world was not reset. Worlds that diverge, get an action that is not finite, or whose
 * task of a host's own fails, are truncated and flagged, with reward and cost 0 in that step; the call returns OK.
 * With option action_repeat it is that many control steps with the same action, or as many as the episode has left:
 * reward and cost are sums over them, success is set if any had it, status has the bits of all, the other rows are
 * those after the last. */
RDM_API rdm_result rdm_pool_step(rdm_pool *p);
/* The same for worlds whose mask [num_envs] is not 0; rows of the others do not change. */
RDM_API rdm_result rdm_pool_step_masked(rdm_pool *p, const uint8_t *mask);

enum rdm_baseline_kind { RDM_BASELINE_ZERO = 0, RDM_BASELINE_HOLD = 1, RDM_BASELINE_RANDOM = 2 }; /* actions that nobody learned */
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

enum rdm_shape_kind { /* of rdm_shape */
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
/* Writes up to capacity contacts to out [capacity], of things asleep as they fell asleep; *count is how many there are. */
RDM_API rdm_result rdm_pool_contacts(const rdm_pool *p, int32_t env, rdm_contact *out, int32_t capacity,
                                     int32_t *count);
/* A picture of world env. camera: a name of the task's. rgb [h][w][3], depth [h][w] (m along the optical
 * axis, 0: nothing hit), segmentation [h][w] (shape, -1: nothing); each may be NULL. 1 <= w, h <= 8192. */
RDM_API rdm_result rdm_pool_render(rdm_pool *p, int32_t env, const char *camera, int32_t w, int32_t h,
                                   uint8_t *rgb, float *depth, int32_t *segmentation);
typedef struct rdm_pool_stats { /* counts since create */
  uint32_t struct_size;      /* in: bytes                                                                 */
  int32_t contacts_max;      /* largest number of contacts in a substep's list since create, all worlds   */
  double contacts_mean;      /* mean of the same                                                          */
  double joint_drift;        /* m, largest gap of any joint now, all worlds                               */
  int64_t steps;             /* control steps of one world, summed over worlds                            */
  int64_t diverged;          /* steps and resets flagged RDM_STATUS_DIVERGED so far                       */
  int64_t overflowed;        /* steps flagged RDM_STATUS_CONTACTS so far                                  */
  int64_t bad_actions;       /* steps flagged RDM_STATUS_BAD_ACTION so far                                */
  int64_t task_failed;       /* steps flagged RDM_STATUS_TASK so far                                      */
  int64_t unconverged;       /* steps flagged RDM_STATUS_SOLVER so far                                    */
  int64_t slowed;            /* steps flagged RDM_STATUS_SLOWED so far                                    */
  double solver_residual;    /* m/s, what a contact's normal velocity was still wrong by when the last sweep of the last step
                              * came to it, the largest of all worlds; NaN: engine ode, not measured */
} rdm_pool_stats;
RDM_API rdm_result rdm_pool_get_stats(const rdm_pool *p, rdm_pool_stats *io); /* fills io */

/* ---- agent: one algorithm that acts and learns ---------------------------------------------------------------- */
typedef struct rdm_agent rdm_agent; /* handle */
enum rdm_act_mode { RDM_SAMPLE = 0, RDM_MEAN = 1 }; /* of rdm_agent_act */
typedef struct rdm_agent_config { /* what an agent is made from */
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
  int32_t max_steps;          /* control steps of an episode: one that is longer is counted as ended there; 0: unknown */
  const float *initial_mean;  /* [action_dim] mean action of the new policy, copied; NULL: 0              */
  const rdm_option *defaults; /* [num_defaults] laid under options (a task's); "algo:key" is for one algo */
  const rdm_option *options;  /* [num_options] the caller's; NULL: none                                   */
  int32_t num_defaults;       /* count, default 0                                                         */
  int32_t num_options;        /* count, default 0                                                         */
  const double *cost_limits;  /* [cost_dim] on the sum over an episode, < 0: none; NULL: option cost_limit for column 0, which
                               * stands over [0] where both are given */
  const rdm_host *host;       /* hooks of this handle, copied; NULL: those of rdm_init                    */
  const char *settings;       /* options as lines key=value, laid over `options`, copied; NULL: none      */
  char *error;                /* [error_size] the text of a failing call that takes this config; NULL     */
  int32_t error_size;         /* bytes, terminator included; what is longer is cut                        */
  int32_t reserved2;          /* 0                                                                        */
  const rdm_field *fields;    /* [num_fields] parts of a row of obs, for actor_obs and critic_obs, copied; NULL: none */
  int32_t num_fields;         /* count, 0..4096, default 0                                                */
  int32_t reserved3;          /* 0                                                                        */
} rdm_agent_config;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first version's. */
RDM_API rdm_result rdm_agent_config_init(rdm_agent_config *c, size_t size);
/* Sets dims, num_envs, task, layout_hash, control_dt, max_steps, defaults, initial_mean, cost_limits and fields from a
 * pool. Pointers are borrowed from the pool. */
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
  const uint8_t *valid;       /* [num_envs] 0: not learned from; NULL: all valid                          */
  const uint8_t *success;     /* [num_envs] for the statistics; NULL: none                                */
  const int32_t *steps;       /* [num_envs] control steps in this decision; NULL: action_repeat           */
  const uint32_t *status;     /* [num_envs] RDM_STATUS_* of the decision, for the epoch's counts; NULL: none */
} rdm_transition;
/* STATE unless a sampled act came before, or when the horizon is full. ARGUMENT for a flag that is neither 0 nor 1, a
 * cost that is not finite or below 0, in any row, and for a reward or final_obs that is not finite in a valid one.
 * A row with valid 0 is not learned from and its reward does not count; its cost counts, and an end in it ends the
 * episode. Its steps count too, but in a row that neither ends an episode nor follows another row of one: that is what
 * next-step autoreset returns for the step that only resets.
 * An episode that is not over after max_steps control steps counts as one there (RDM_EPOCH_CUT): its sums are closed and
 * begin anew. The path goes on, so the value of the next observation follows, as after a truncation. Option
 * episode_steps sets that length, cost_limit_per_step a limit on the cost per control step, which needs no ends. */
RDM_API rdm_result rdm_agent_record(rdm_agent *a, const rdm_transition *t);

enum rdm_epoch_flag {          /* of rdm_epoch.flags */
  RDM_EPOCH_NO_EPISODE = 1,        /* no episode has ended so far: ret, cost, length and rates are NaN         */
  RDM_EPOCH_SKIPPED_GRADIENTS = 2, /* gradients that were not finite were left out                             */
  RDM_EPOCH_INVALID_ROWS = 4,      /* rows with valid 0                                                        */
  RDM_EPOCH_CUT = 8,               /* episodes were counted as ended at max_steps or episode_steps             */
  RDM_EPOCH_DIVERGED = 16,         /* decisions flagged RDM_STATUS_DIVERGED                                    */
  RDM_EPOCH_CONTACTS = 32,         /* decisions flagged RDM_STATUS_CONTACTS                                    */
  RDM_EPOCH_BAD_ACTION = 64,       /* decisions flagged RDM_STATUS_BAD_ACTION                                  */
  RDM_EPOCH_TASK = 128,            /* decisions flagged RDM_STATUS_TASK                                        */
  RDM_EPOCH_SOLVER = 256,          /* decisions flagged RDM_STATUS_SOLVER                                      */
  RDM_EPOCH_SLOWED = 512           /* decisions flagged RDM_STATUS_SLOWED                                      */
};
/* One row of the learning curve; means over the last 100 finished episodes. NaN: nothing was measured. */
typedef struct rdm_epoch {
  uint32_t struct_size;       /* in: bytes                                                                */
  int32_t epoch;              /* count from 1                                                             */
  int64_t env_steps;          /* control steps so far, all environments                                   */
  int64_t episodes;           /* finished so far                                                          */
  double ret;                 /* sum of rewards of an episode                                             */
  double cost[RDM_MAX_COSTS]; /* sum of each cost column of an episode, of what cost_signal says          */
  double cost_per_step;       /* column 0, per control step; of this epoch's decisions while no episode has ended, and
                               * with option cost_limit_per_step                                          */
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
  int32_t cost_signal;        /* costs are sums of 0: costs, 1: their magnitudes (option cost_signal=raw) */
  int32_t reserved2;          /* 0                                                                        */
  uint32_t flags;             /* RDM_EPOCH_*                                                              */
  uint32_t reserved3;         /* 0                                                                        */
  int64_t skipped_gradients;  /* in this epoch, as all counts below: steps left out                       */
  int64_t invalid_rows;       /* decisions with valid 0 that did not only reset                           */
  int64_t diverged;           /* decisions flagged RDM_STATUS_DIVERGED                                    */
  int64_t contacts_left_out;  /* decisions flagged RDM_STATUS_CONTACTS                                    */
  int64_t bad_actions;        /* decisions flagged RDM_STATUS_BAD_ACTION                                  */
  int64_t task_failed;        /* decisions flagged RDM_STATUS_TASK                                        */
  int64_t unconverged;        /* decisions flagged RDM_STATUS_SOLVER                                      */
  int64_t slowed;             /* decisions flagged RDM_STATUS_SLOWED                                      */
} rdm_epoch;
/* Learns from a full horizon; last_obs [num_envs][obs_dim] follows the last record. io may be NULL. CANCELLED after
 * rdm_agent_cancel (the horizon is dropped, full or not), STATE when the horizon is not full. */
RDM_API rdm_result rdm_agent_update(rdm_agent *a, const float *last_obs, rdm_epoch *io);
/* One epoch natively: act, step (action_repeat control steps), record until the horizon is full, then update. The
 * pool must have been reset and must not have autoreset off; dims and num_envs must agree. A pool that repeats
 * actions itself takes as many steps at a time: the agent's action_repeat must be a multiple of the pool's, as the
 * defaults are that rdm_agent_config_for_pool sets. With the agent's option cost_signal=raw the costs are sums over
 * control steps of cost_raw where that is above 0. */
RDM_API rdm_result rdm_agent_rollout(rdm_agent *a, rdm_pool *p, rdm_epoch *io);
/* Async-signal-safe, from any thread: the running rollout or update returns CANCELLED. A horizon that has begun by act
 * and record is dropped by its update; between horizons, the next rollout, update or first act with RDM_SAMPLE
 * returns CANCELLED, before anything is collected. */
RDM_API void rdm_agent_cancel(rdm_agent *a);
/* Drops the horizon that has begun, and a cancel that waits: from any state back to between epochs. Nothing is learned from
 * what it drops. Episodes that run go on, with what was recorded of them. */
RDM_API rdm_result rdm_agent_discard(rdm_agent *a);
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
typedef struct rdm_policy rdm_policy; /* handle */
typedef struct rdm_policy_info { /* what a policy file tells of its network */
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
  int32_t num_points;         /* of the cloud beside each row, for rdm_policy_act_points; 0: it sees none  */
  int32_t num_point_classes;  /* that it tells points apart by, 0: none                                   */
  int32_t num_features;       /* that its encoder makes of a cloud, 0 without                             */
  int32_t point_color;        /* whether it sees the colours of points: 0, 1                              */
} rdm_policy_info;
RDM_API rdm_result rdm_policy_load(rdm_policy **out, const void *bytes, size_t size); /* copies bytes [size] */
RDM_API rdm_result rdm_policy_load_file(rdm_policy **out, const char *path);          /* NOT_FOUND, FORMAT ... */
RDM_API void rdm_policy_destroy(rdm_policy *p);             /* NULL is fine */
RDM_API rdm_result rdm_policy_get_info(const rdm_policy *p, rdm_policy_info *io); /* fills io */
RDM_API size_t rdm_policy_scratch(const rdm_policy *p, int32_t rows); /* bytes for act, at any address; 0: bad arguments */
/* One decision, to be held for rdm_policy_info.action_repeat control steps (rdm_actor_act counts them):
 * action [rows][action_dim] = clip(mean + std noise, -1, 1) for obs [rows][obs_dim]. noise [rows][action_dim] are
 * the caller's standard normals, NULL: the mean. scratch [scratch_bytes]: rdm_policy_scratch bytes or more, aligned
 * in any way. No heap, no hidden state: any number of threads, each with its own scratch. ARGUMENT when obs or noise
 * is not finite, or so large that the network overflows (action is written then, and of no use). STATE for a policy
 * that sees points. */
RDM_API rdm_result rdm_policy_act(const rdm_policy *p, const float *obs, int32_t rows, const float *noise,
                                  float *action, void *scratch, size_t scratch_bytes);
/* "actor.0.weight" of rows outputs and cols inputs, "actor.log_std" or "actor.log_std_bounds",
 * "normalizer.shift|scale|clip", "example.obs|action". RANGE ends the list. All are over whole rows of obs_dim: a
 * weight of an entry that the policy does not see is 0. Of one that sees points "actor.0.weight" has a column for each
 * feature behind those, and there are "encoder.0.weight" and so on, "encoder.origin" and "encoder.range", in m,
 * "encoder.activation" (0 tanh, 1 elu, 2 relu), "example.points", in m, and "example.point_class". */
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

/* What the texts of NOT_FOUND end with, for names of your own: writes to text [capacity] "; nearest is gamma",
 * "; nearest are a, b and c" of several that are equally near, or "" when nobody can have meant one of `names`, one a
 * line, of which the first 500 count. Case is ignored, '-' equals '_'. Cut at capacity >= 1 bytes; 4 * RDM_TEXT_SIZE
 * hold all. */
RDM_API rdm_result rdm_nearest_names(const char *name, const char *names, char *text, size_t capacity);

/* Pushes a shape's carrier during the next step: force [3] at its centre of mass, N, world axes. */
RDM_API rdm_result rdm_pool_push(rdm_pool *p, int32_t env, int32_t shape, const float force[3]);

/* Which entries of a row of obs_dim the policy sees (agent option actor_obs), ascending: writes up to capacity of them
 * to columns [capacity]; *count is how many there are. */
RDM_API rdm_result rdm_policy_columns(const rdm_policy *p, int32_t *columns, int32_t capacity, int32_t *count);

/* World dst_env of dst (-1: all of them) becomes what world src_env of src is, at the price of copying memory: afterwards
 * it goes on with the bytes that set_state(get_state) would give, and its rows (but action, and those of rdm_sensors)
 * are the other's. Pools of the same task and options, of any sizes, threads and seeds; src may be dst. ARGUMENT for
 * pools that differ, RANGE for worlds that are not there: nothing changes. No heap. */
RDM_API rdm_result rdm_pool_copy(rdm_pool *dst, int32_t dst_env, const rdm_pool *src, int32_t src_env);

/* What the agent's critics say of obs [rows][obs_dim], for any number of rows: value [rows], the discounted sum of rewards
 * to come, and the same of the cost columns that it limits, cost [rows][RDM_MAX_COSTS] by column, others 0; cost may be
 * NULL. UNSUPPORTED with options normalize_reward or normalize_cost, which leave critics no unit. */
RDM_API rdm_result rdm_agent_values(const rdm_agent *a, const float *obs, int32_t rows, float *value, float *cost);

/* ---- ranks: one learner of many processes ---------------------------------------------------------------------- */
/* Each process has a pool and an agent of num_envs worlds; together they are one learner with ranks * num_envs of them, whose
 * bytes are those of one process with as many worlds and the same option `blocks`, for any number of ranks. redman links no
 * MPI: messages go through a hook.
 *
 *   rdm_ranks r = {.struct_size = sizeof r, .rank = 1, .ranks = 4, .user = &mine, .gather = my_allgather};
 *   rdm_pool_set_rank(pool, r.rank, r.ranks);
 *   c.settings = "blocks=16";                      // ranks times a power of two, which divides all worlds
 *   rdm_agent_create_ranked(&agent, &c, &r);
 *   for (...) rdm_agent_rollout(agent, pool, &e);  // e, the policy and the saved state are the same on each rank
 *
 * Configs are the same on all ranks but for num_threads, hooks and texts. All of them make the same calls of rollout, act with
 * RDM_SAMPLE, record, update, save with memory, rdm_checkpoint_write: these exchange messages, in one order. Loading does not:
 * each takes its own part. A state that was saved by some ranks goes on with any other number that `blocks` allows.
 *   - CANCELLED: a hook failed (a rank is gone), or rdm_agent_cancel was called on one rank, which stops all of them at one
 *     place. The handles are good; after a failed hook, what ranks have learned may differ: load a state that was saved.
 *   - STATE: ranks are set up differently, which the first exchange looks for (the rank and number of ranks, the library's
 *     version, seed, sizes and options of agent and pool); or are out of step; or one has drifted, which each update looks
 *     for. The text names what and whose.
 *   - a rank whose call fails otherwise leaves the others waiting in their hooks, unless it ends and these notice. */
typedef struct rdm_ranks {  /* who learns together, and how messages go from one to the other                     */
  uint32_t struct_size;     /* bytes                                                                              */
  int32_t rank;             /* of this process, 0..ranks - 1; its world 0 is number rank * num_envs of all        */
  int32_t ranks;            /* processes, 1..4096                                                                 */
  int32_t reserved;         /* 0                                                                                  */
  void *user;               /* passed back to the hooks; may be NULL                                              */
  /* An allgather: `mine`, `bytes` of them, stands at `all` + r * bytes for each rank r afterwards, on all ranks; bytes is the
   * same on each. Blocks until all have come. Any number but 0 is a failure. NULL only for one rank.              */
  int32_t (*gather)(void *user, const void *mine, size_t bytes, void *all);
  /* Sends mine to rank `partner`, which sends as much here: `theirs`. Takes the place of gather in sums of gradients where
   * ranks is a power of two: each receives 2 of them in 2 log2(ranks) messages, not ranks - 1. NULL on all ranks, or on none. */
  int32_t (*swap)(void *user, int32_t partner, const void *mine, size_t bytes, void *theirs);
} rdm_ranks;
/* As rdm_agent_create, of a rank's agent: c.num_envs worlds of ranks * c.num_envs. Takes more memory than rdm_agent_memory says:
 * a message, half a MiB at most where rows are no wider, for each rank. The hooks must outlive the agent. */
RDM_API rdm_result rdm_agent_create_ranked(rdm_agent **out, const rdm_agent_config *c, const rdm_ranks *ranks);
/* Worlds of the pool are numbers rank * num_envs on of ranks * num_envs: of their streams, and of a state of all worlds (env -1),
 * from which set_state takes them. Before the first reset; STATE afterwards. rdm_agent_rollout needs agent and pool of one rank. */
RDM_API rdm_result rdm_pool_set_rank(rdm_pool *p, int32_t rank, int32_t ranks);

/* ---- eyes: agents and policies that see points ---------------------------------------------------------------- */
/* With the agent option `encoder` ("64,128") a PointNet makes features of a cloud for the actor, beside the entries of the
 * row that it sees (actor_obs, "vision": nothing of an object); critics see rows alone. Of rdm_sensors:
 *
 *   rdm_points seen = {.struct_size = sizeof seen, .num_points = s.num_points, .points = s.points};
 *   rdm_agent_act_points(agent, b.obs, &seen, RDM_SAMPLE, b.action);  rdm_pool_step(pool);  rdm_agent_record(agent, &t);
 *
 * or rdm_agent_rollout with a pool whose modality has points. Points count as whole millimetres from `encoder_origin`,
 * within +-32.767 m; their order and what comes twice change nothing. Several clouds (of two cameras, of a goal) are one
 * whose points have classes that tell them apart. */
typedef struct rdm_points {     /* a cloud for each row of obs, in the call that takes it                         */
  uint32_t struct_size;         /* bytes                                                                           */
  int32_t num_points;           /* of each cloud: the agent's option encoder_points, the policy's num_points       */
  const float *points;          /* [rows][num_points][3], world, m, required                                       */
  const uint8_t *point_class;   /* [rows][num_points] less than option encoder_classes; NULL only where that is 0  */
  const uint8_t *point_color;   /* [rows][num_points][3]; NULL only without option encoder_color                   */
} rdm_points;
/* As rdm_agent_act: action [num_envs][action_dim] for obs [num_envs][obs_dim] and as many clouds, of an agent with the option
 * encoder; STATE without it. ARGUMENT for a point that is not finite, RANGE for another number of points or a class that
 * there is not: nothing is remembered. */
RDM_API rdm_result rdm_agent_act_points(rdm_agent *a, const float *obs, const rdm_points *points, int32_t mode,
                                        float *action);
/* As rdm_policy_act, of obs [rows][obs_dim], noise [rows][action_dim] or NULL, action [rows][action_dim] and scratch
 * [scratch_bytes], for a policy whose num_points is not 0; STATE for others, errors as above. */
RDM_API rdm_result rdm_policy_act_points(const rdm_policy *p, const float *obs, const rdm_points *points, int32_t rows,
                                         const float *noise, float *action, void *scratch, size_t scratch_bytes);
typedef struct rdm_pretrain_config { /* how rdm_agent_pretrain learns */
  uint32_t struct_size;       /* bytes, set by rdm_pretrain_config_init                                    */
  int32_t num_labels;         /* kinds of points to tell apart, 2..64, required                            */
  int32_t epochs;             /* passes over the clouds, 1..100000, default 20                             */
  int32_t batch_rows;         /* clouds of a minibatch, 1..4096, default 16                                */
  double learning_rate;       /* Adam's, 0..10, default 1e-3, falling in a line to a tenth                 */
  double validation;          /* share of the clouds that are not learned from, 0..0.9, default 0.1        */
  uint64_t seed;              /* of the head's weights, of shuffling and of the choice, default 0          */
} rdm_pretrain_config;
RDM_API rdm_result rdm_pretrain_config_init(rdm_pretrain_config *how, size_t size); /* defaults into the first `size` bytes */
typedef struct rdm_pretrain_report { /* what rdm_agent_pretrain did */
  uint32_t struct_size;       /* in: bytes                                                                 */
  int32_t train_rows;         /* clouds                                                                    */
  int32_t validation_rows;    /* clouds                                                                    */
  int32_t reserved;           /* 0                                                                         */
  double train_loss;          /* of the last epoch, mean cross-entropy of a point, nats                    */
  double validation_loss;     /* likewise, of the clouds held back; 0 without                              */
  double accuracy;            /* share of points of these that are told right; of all clouds without       */
  double most_common;         /* share that whoever always says the commonest label tells right            */
} rdm_pretrain_report;
/* The agent's encoder learns to tell the points of clouds [rows] apart by label [rows][num_points], each less than
 * num_labels: a head sees a point's last hidden layer and the cloud's features, and is thrown away afterwards. Nothing else
 * changes. Same seed, same bytes, for any number of threads. STATE inside a horizon or without an encoder; CANCELLED after
 * rdm_agent_cancel: the encoder as before. io may be NULL. */
RDM_API rdm_result rdm_agent_pretrain(rdm_agent *a, const rdm_points *points, const uint8_t *label, int32_t rows,
                                      const rdm_pretrain_config *how, rdm_pretrain_report *io);

/* ---- actors: a policy that plays ------------------------------------------------------------------------------ */
/* A policy decides every rdm_policy_info.action_repeat control steps, and its action is held between. An actor does the counting
 * for worlds of a pool, or of an environment of your own, so that a policy earns the same wherever it plays:
 *
 *   rdm_actor_config c;  rdm_actor *actor;
 *   rdm_actor_config_init(&c, sizeof c);
 *   c.policy = policy;  c.spec = &spec;  c.num_envs = n;              // spec: of rdm_pool_get_spec
 *   if (rdm_actor_create(&actor, &c)) puts(rdm_last_error());
 *   for (...) {
 *     rdm_actor_act(actor, b.obs, NULL, NULL, b.action);  rdm_pool_step(pool);
 *     rdm_actor_reset(actor, b.terminated, b.truncated);             // of a pool with RDM_AUTORESET_SAME_STEP
 *   }
 *   rdm_actor_destroy(actor);
 *
 * With RDM_AUTORESET_OFF reset the actor where the pool is reset; with RDM_AUTORESET_NEXT_STEP after the step that resets, by the
 * ends of the step before. One thread at a time. Same policy, seed and calls: the same bytes. */
typedef struct rdm_actor rdm_actor; /* handle */
typedef struct rdm_actor_config { /* what an actor is made from */
  uint32_t struct_size;      /* bytes, set by rdm_actor_config_init                                       */
  int32_t num_envs;          /* rows of an act, 1..65536, required                                        */
  const rdm_policy *policy;  /* required; must outlive the actor                                          */
  const rdm_spec *spec;      /* of the pool that it plays in, checked as rdm_policy_check does; its action_repeat must divide the
                              * policy's. NULL: nothing is checked, and a step is one control step        */
  uint64_t seed;             /* of the noise; default 0                                                   */
  int32_t stochastic;        /* 1: actions are sampled, with the noise correlation of the policy; default 0: the mean */
  int32_t reserved;          /* 0                                                                         */
  const float *center;       /* [action_dim] in [-1, 1] that the environment adds to every action it is given, and the actor
                              * subtracts (the sum is right to a rounding); copied; NULL: 0               */
  const rdm_host *host;      /* hooks of this handle, copied; NULL: those of rdm_init                     */
  char *error;               /* [error_size] the text of a failing call that takes this config; NULL      */
  int32_t error_size;        /* bytes, terminator included; what is longer is cut                         */
  int32_t reserved2;         /* 0                                                                         */
} rdm_actor_config;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first version's. */
RDM_API rdm_result rdm_actor_config_init(rdm_actor_config *c, size_t size);
/* Bytes *bytes that creation takes from the alloc hook, exact. */
RDM_API rdm_result rdm_actor_memory(const rdm_actor_config *c, size_t *bytes);
/* Makes the actor; every world begins an episode. ARGUMENT for a step that does not divide the policy's decision,
 * VERSION_MISMATCH for a spec that the policy does not fit, RANGE for sizes and a center out of bounds. */
RDM_API rdm_result rdm_actor_create(rdm_actor **out, const rdm_actor_config *c);
RDM_API void rdm_actor_destroy(rdm_actor *actor);             /* NULL is fine */
RDM_API const char *rdm_actor_error(const rdm_actor *actor);  /* last failure on this handle; "" at first */
/* action [num_envs][action_dim] for one step of the worlds whose mask [num_envs] is not 0 (NULL: all): a new decision on
 * obs [num_envs][obs_dim] where one is due, else the one that is held; rows of other worlds are not written. points: clouds of
 * the worlds for a policy that sees points, NULL for others. No heap. ARGUMENT for rows that are not finite where a decision is
 * due: nothing is counted then. */
RDM_API rdm_result rdm_actor_act(rdm_actor *actor, const float *obs, const rdm_points *points, const uint8_t *mask,
                                 float *action);
/* Episodes begin anew where terminated [num_envs] or truncated [num_envs] is not 0: a decision is due there, and its noise is
 * fresh. Either may be NULL; both NULL: everywhere. Any mask will do in the place of one of them. */
RDM_API rdm_result rdm_actor_reset(rdm_actor *actor, const uint8_t *terminated, const uint8_t *truncated);
/* Held actions, counts and noise as bytes [capacity]; NULL asks for the size. An actor of the same policy and config that reads
 * them goes on with the same bytes. */
RDM_API rdm_result rdm_actor_write_state(const rdm_actor *actor, void *bytes, size_t capacity, size_t *size);
/* Of bytes [size]. FORMAT for bytes that are not whole, or of another actor: nothing changes. */
RDM_API rdm_result rdm_actor_read_state(rdm_actor *actor, const void *bytes, size_t size);

/* ---- planning: actions by trying them out -------------------------------------------------------------------- */
/* A planner rolls many worlds out from where one stands, each under a noisy plan, and moves the plan to what went best
 * (predictive sampling, cross-entropy, model predictive path integral). Costs come first: of plans within what the
 * episode's limits leave the one with the highest return is best, then those that cost least.
 *
 *   rdm_planner_config c;  rdm_planner *planner;
 *   rdm_planner_config_init(&c, sizeof c);
 *   c.pool = pool;  c.settings = "method=cem\nsamples=128\nhorizon=20";
 *   if (rdm_planner_create(&planner, &c)) puts(rdm_last_error());
 *   for (...) { rdm_planner_act(planner, pool, 0, b.action, NULL);  rdm_pool_step(pool); }
 *   rdm_planner_destroy(planner);
 *
 * The model is the world itself: rollouts know the draws that it will make. One planner follows one world's episode: call
 * rdm_planner_reset when another begins. One thread at a time. Same seed, same calls: the same bytes, for any threads.
 * A plan is an action for each of the next `horizon` steps of the pool. */
typedef struct rdm_planner rdm_planner; /* handle */
typedef struct rdm_planner_config { /* what a planner is made from */
  uint32_t struct_size;      /* bytes, set by rdm_planner_config_init                                     */
  int32_t num_threads;       /* of the rollouts; 0: as many as the pool has; default 0                    */
  const rdm_pool *pool;      /* rollouts have its task and options; required; not kept                    */
  uint64_t seed;             /* of the noise; default 0                                                   */
  const float *noise;        /* [action_dim] standard deviation of each entry, 0 to 10, copied; NULL: option noise */
  const double *cost_limits; /* [cost_dim] on the sum over an episode, < 0: none, copied; NULL: the task's on column 0 */
  const rdm_policy *policy;  /* proposes: sample 0 of the first iteration is its rollout, the others add noise to that; must
                              * outlive the planner; NULL: none                                           */
  const rdm_agent *agent;    /* its critic values states at the horizon's end; must outlive the planner, and not be in another
                              * thread's use while one plans; NULL: none                                  */
  const rdm_option *options; /* [num_options] as rdm_planner_option_at lists them, copied; NULL: none     */
  int32_t num_options;       /* count, default 0                                                          */
  int32_t reserved;          /* 0                                                                         */
  const rdm_host *host;      /* hooks of this handle, copied; NULL: those of rdm_init                     */
  const char *settings;      /* options as lines key=value, laid over `options`, copied; NULL: none       */
  char *error;               /* [error_size] the text of a failing call that takes this config; NULL      */
  int32_t error_size;        /* bytes, terminator included; what is longer is cut                         */
  int32_t reserved2;         /* 0                                                                         */
} rdm_planner_config;
typedef struct rdm_planner_spec { /* sizes of a planner */
  uint32_t struct_size;      /* in: bytes                                                                 */
  int32_t samples;           /* worlds rolled out in an iteration                                         */
  int32_t horizon;           /* steps of the pool                                                         */
  int32_t knots;             /* of the noise, the horizon at most                                         */
  int32_t action_dim;        /* count                                                                     */
  int32_t cost_dim;          /* count                                                                     */
} rdm_planner_spec;
typedef struct rdm_plan_info { /* what a call of rdm_planner_act found */
  uint32_t struct_size;      /* in: bytes                                                                 */
  int32_t planned;           /* 1; 0: the plan was followed (option replan), the rest is 0                */
  int32_t best;              /* sample that is best in the last iteration                                 */
  int32_t reserved;          /* 0                                                                         */
  double ret;                /* of that sample: discounted sum of rewards, and the critic's value         */
  double cost[RDM_MAX_COSTS]; /* of that sample, sums of each column                                      */
  double feasible_share;     /* of the last iteration's samples: within what the limits leave             */
  int64_t steps;             /* control steps of all rollouts                                             */
} rdm_plan_info;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first version's. */
RDM_API rdm_result rdm_planner_config_init(rdm_planner_config *c, size_t size);
/* Makes the planner and its worlds. ARGUMENT, RANGE, NOT_FOUND name what is wrong; VERSION_MISMATCH for a policy that
 * does not fit the pool, UNSUPPORTED for an agent whose critics have no unit (rdm_agent_values). */
RDM_API rdm_result rdm_planner_create(rdm_planner **out, const rdm_planner_config *c);
RDM_API void rdm_planner_destroy(rdm_planner *planner);           /* NULL is fine */
RDM_API const char *rdm_planner_error(const rdm_planner *planner); /* last failure on this handle; "" at first */
RDM_API rdm_result rdm_planner_get_spec(const rdm_planner *planner, rdm_planner_spec *io); /* fills io */
/* Option i of planners: method, samples, horizon, knots, interpolation, noise, elites, temperature, iterations, costs, and
 * others. RANGE past the end. */
RDM_API rdm_result rdm_planner_option_at(int32_t i, rdm_option_info *out);
/* All options as text [capacity] of lines key=value: given as settings they make a planner of the same options. */
RDM_API rdm_result rdm_planner_settings(const rdm_planner *planner, char *text, size_t capacity, size_t *size);

/* Plans from the state that world env of the pool is in now, and writes the plan's first action to action [action_dim]. The
 * pool is only read; it has the task and options of the one that the planner was made for, else ARGUMENT. io may be NULL.
 * STATE where no episode runs. No heap. */
RDM_API rdm_result rdm_planner_act(rdm_planner *planner, const rdm_pool *pool, int32_t env, float *action,
                                   rdm_plan_info *io);
/* Forgets the plan; the noise goes on. The next plan begins at rdm_pool_initial_mean, or the policy's rollout. */
RDM_API rdm_result rdm_planner_reset(rdm_planner *planner);
/* The plan as it is to plan [horizon][action_dim]: row 0 is the action that rdm_planner_act gave. */
RDM_API rdm_result rdm_planner_get_plan(const rdm_planner *planner, float *plan);
/* The next call begins at plan [horizon][action_dim], cut to [-1, 1], not shifted. ARGUMENT for entries that are not
 * finite. With a policy it is tried as sample 1. */
RDM_API rdm_result rdm_planner_set_plan(rdm_planner *planner, const float *plan);
/* Plan, noise and counters as bytes [capacity]; NULL asks for the size. A planner of the same task, options, noise and limits
 * that reads them goes on with the same bytes. */
RDM_API rdm_result rdm_planner_write_state(const rdm_planner *planner, void *bytes, size_t capacity, size_t *size);
/* Of bytes [size]. FORMAT for bytes that are not whole, or of another planner: nothing changes. */
RDM_API rdm_result rdm_planner_read_state(rdm_planner *planner, const void *bytes, size_t size);

/* ---- robots of your own -------------------------------------------------------------------------------------- */
/* A robot is a tree of links on a root, as plain arrays; the library's own are described in the same way
 * (rdm_robot_get, rdm_robot_link_at ...). Frames: a link's frame is that of its joint; it stands at (p, q) in its parent's
 * frame while the joint is at 0, and turns about (slides along) `axis` of its own. A hand is given as the right one: fingers
 * and palm by their rows; options hand= and arm= of the hand tasks take robots by name.
 *
 *   rdm_robot_def d;  int32_t robot;
 *   rdm_robot_def_init(&d, sizeof d);
 *   d.name = "my_hand";  d.kind = RDM_ROBOT_HAND;  d.links = links;  d.num_links = 9; ...
 *   if (rdm_robot_create(&robot, &d)) puts(rdm_last_error());          names the row and the number
 *   config.settings = "hand=my_hand\narm=ur5e";  ... rdm_pool_create(&p, &config) ...
 *   rdm_robot_remove(robot);
 *
 * Robots belong to the process; any number of threads may look while others add and remove. */
enum rdm_robot_kind { RDM_ROBOT_OTHER = 0, RDM_ROBOT_HAND = 1, RDM_ROBOT_ARM = 2 }; /* of a robot */
enum rdm_joint_kind { RDM_REVOLUTE = 0, RDM_PRISMATIC = 1 };  /* of a joint */
enum rdm_robot_row { RDM_ROOT_LINK = -1, RDM_NO_LINK = -2 };  /* in the place of a row of links */
#define RDM_ROBOT_LINKS 64   /* links of a robot, at most */
#define RDM_ROBOT_KNOTS 4    /* of a curve, at most */
typedef struct rdm_robot_link { /* frozen layout: a link and the joint that moves it; m, rad, kg, N, s */
  const char *name;        /* of the link, unique                                                         */
  const char *joint;       /* of the joint, unique                                                        */
  int32_t parent;          /* an earlier row, RDM_ROOT_LINK                                               */
  int32_t kind;            /* RDM_REVOLUTE, RDM_PRISMATIC                                                 */
  double p[3];             /* position in the parent's frame with the joint at 0                          */
  double q[4];             /* rotation, unit                                                              */
  double axis[3];          /* in the link's own frame, unit                                               */
  double lower;            /* range, below upper                                                          */
  double upper;            /* range                                                                       */
  double velocity;         /* how fast the drive's target may move; 0: at once                            */
  double kp;               /* drive: effort kp (target - q) - kd rate                                     */
  double kd;               /* drive                                                                       */
  double effort;           /* bound of the drive's effort, N m (N)                                        */
  double armature;         /* inertia added about the axis, kg m2; revolute joints alone                  */
  double friction;         /* dry friction, N m (N)                                                       */
  double mass;             /* 0 with moments of 0: none                                                   */
  double com[3];           /* centre of mass in the link's frame                                          */
  double moment[6];        /* xx yy zz xy xz yz about com, axes of the link                               */
} rdm_robot_link;
typedef struct rdm_robot_shape { /* frozen layout: what of a link can be touched and seen */
  const char *name;        /* unique                                                                      */
  int32_t link;            /* row, RDM_ROOT_LINK                                                          */
  int32_t kind;            /* RDM_SPHERE, RDM_CAPSULE, RDM_BOX, RDM_CYLINDER, RDM_ELLIPSOID               */
  double size[3];          /* as rdm_shape, m                                                             */
  double p[3];             /* position in the link's frame, m                                             */
  double q[4];             /* rotation, unit                                                              */
  uint8_t color[4];        /* red, green, blue, 255                                                       */
  uint8_t reserved[4];     /* 0                                                                           */
} rdm_robot_shape;
typedef struct rdm_robot_pair { /* frozen layout: two shapes of one robot that may touch each other */
  int32_t a, b;            /* rows of shapes                                                              */
} rdm_robot_pair;
typedef struct rdm_robot_coupling { /* frozen layout: a joint that a tendon or belt lets follow another */
  int32_t link;            /* row whose joint follows                                                     */
  int32_t other;           /* row whose joint leads; itself no follower                                   */
  double ratio;            /* q = ratio q_other                                                           */
  double slack;            /* rad: within it the joint goes freely                                        */
} rdm_robot_coupling;
typedef struct rdm_robot_curve { /* frozen layout: the target of a joint, piecewise linear in a command of -1 to 1 */
  int32_t link;            /* row                                                                         */
  int32_t driver;          /* row whose command it is: the same, or that of the motor                     */
  int32_t num_knots;       /* 2 to RDM_ROBOT_KNOTS                                                        */
  int32_t reserved;        /* 0                                                                           */
  double command[4];       /* ascending                                                                   */
  double angle[4];         /* in the joint's range, rad (m)                                               */
} rdm_robot_curve;
typedef struct rdm_robot_finger { /* frozen layout: its rows stand together, from `first` to `tip` */
  const char *name;        /* short: it begins the names of its observations                              */
  int32_t first;           /* row of its first link                                                       */
  int32_t tip;             /* row of its last; it carries the force sensor                                */
  int32_t lateral;         /* row of the joint that spreads it to a side, -1: none                        */
  int32_t proximal;        /* row of the joint that bends it at its base, -1: none                        */
  int32_t middle;          /* row of the next joint that bends it, -1: none                               */
  int32_t thumb;           /* flag                                                                        */
  double p_tip[3];         /* its end, in the frame of `tip`, m                                           */
} rdm_robot_finger;
typedef struct rdm_robot_def { /* a whole robot; the arrays are copied by rdm_robot_create */
  uint32_t struct_size;    /* bytes, set by rdm_robot_def_init                                            */
  int32_t kind;            /* RDM_ROBOT_*                                                                 */
  const char *name;        /* letters, digits, '_', '-', '+'; at most 25                                  */
  const char *alias;       /* another name; NULL                                                          */
  const char *summary;     /* one line; NULL: none                                                        */
  const rdm_robot_link *links;         /* [num_links] a parent before its children                        */
  const rdm_robot_shape *shapes;       /* [num_shapes] NULL with num_shapes 0                             */
  const rdm_robot_pair *pairs;         /* [num_pairs] NULL with num_pairs 0; num_pairs -1: all but neighbours */
  const rdm_robot_coupling *couplings; /* [num_couplings] NULL with num_couplings 0                       */
  const rdm_robot_curve *curves;       /* [num_curves] NULL with num_curves 0                             */
  const int32_t *commands; /* [num_commands] rows in the order of actions; NULL: all but the followers, by row */
  const rdm_robot_finger *fingers;     /* [num_fingers] the first finger first; NULL with num_fingers 0   */
  const double *home;      /* [num_links] start pose, rad (m); NULL: 0, or the limit nearest to it        */
  const double *folded;    /* [num_links] of a hand: fingers straight, thumb across the palm; NULL        */
  const float *closed;     /* [num_commands] of a hand: commands that close it around 5 cm; NULL          */
  int32_t num_links;       /* 1 to RDM_ROBOT_LINKS                                                        */
  int32_t num_shapes;      /* count                                                                       */
  int32_t num_pairs;       /* count                                                                       */
  int32_t num_couplings;   /* count                                                                       */
  int32_t num_curves;      /* count                                                                       */
  int32_t num_commands;    /* count; -1: none, springs hold joints at home (of RDM_ROBOT_OTHER: a door, scissors) */
  int32_t num_fingers;     /* count                                                                       */
  int32_t mirror;          /* root axis (0, 1, 2) normal to the plane that a left one is mirrored in; -1: none */
  double root_mass;        /* of the root link, kg                                                        */
  double root_com[3];      /* in the root frame, m                                                        */
  double root_moment[6];   /* as rdm_robot_link.moment                                                    */
  double mount_p[3];       /* of hands: the frame, z to the fingers, that comes onto an arm's flange; in the root frame */
  double mount_q[4];       /* rotation                                                                    */
  double flange_p[3];      /* of arms: the frame, z out of the arm, that carries a hand; in flange_link's frame */
  double flange_q[4];      /* rotation                                                                    */
  int32_t flange_link;     /* row, RDM_NO_LINK                                                            */
  int32_t palm_link;       /* row, RDM_ROOT_LINK, RDM_NO_LINK                                             */
  double palm_p[3];        /* centre of the palm's surface, in palm_link's frame, m                       */
  double palm_normal[3];   /* unit: out of the palm                                                       */
  double palm_fingers[3];  /* unit: the way the fingers point; of a gripper any in the palm's plane       */
  double hold_p[3];        /* where a thing is that the hand holds, in palm_link's frame, m               */
} rdm_robot_def;
RDM_API rdm_result rdm_robot_def_init(rdm_robot_def *def, size_t size); /* defaults into the first `size` bytes */
/* Adds a robot under a number that no other gets, also later: 2^31 of them in a process; what a removed one took comes
 * back. *out is for rdm_robot_at and what follows here. ARGUMENT, RANGE: the
 * text names the row; a name that is taken is an ARGUMENT. Moments must be positive and keep the triangle rule. */
RDM_API rdm_result rdm_robot_create(int32_t *out, const rdm_robot_def *def);
/* Pools that use it keep it. ARGUMENT for the library's own. */
RDM_API rdm_result rdm_robot_remove(int32_t robot);
RDM_API rdm_result rdm_robot_find(const char *name, int32_t *index); /* name or alias; NOT_FOUND: nearest in the text */
/* A hand on an arm as a robot of its own, under `name`: its root and the arm's last link are one body. The hand is turned by
 * `yaw` (rad) about the flange's z and stands off by `adapter` (m); left: its mirror image. UNSUPPORTED: no arm, no hand. */
RDM_API rdm_result rdm_robot_mount(int32_t *out, const char *name, int32_t arm, int32_t hand, double yaw, double adapter,
                                   int32_t left);
/* What rdm_robot_create took, but for the arrays, which are NULL here. */
RDM_API rdm_result rdm_robot_get(int32_t robot, rdm_robot_def *io);
RDM_API rdm_result rdm_robot_link_at(int32_t robot, int32_t i, rdm_robot_link *out);         /* i < num_links */
RDM_API rdm_result rdm_robot_shape_at(int32_t robot, int32_t i, rdm_robot_shape *out);       /* i < num_shapes */
RDM_API rdm_result rdm_robot_pair_at(int32_t robot, int32_t i, rdm_robot_pair *out);         /* i < num_pairs */
RDM_API rdm_result rdm_robot_coupling_at(int32_t robot, int32_t i, rdm_robot_coupling *out); /* i < num_couplings */
RDM_API rdm_result rdm_robot_curve_at(int32_t robot, int32_t i, rdm_robot_curve *out);       /* i < num_curves */
RDM_API rdm_result rdm_robot_finger_at(int32_t robot, int32_t i, rdm_robot_finger *out);     /* i < num_fingers */
/* Numbers of the robot's poses and commands: commands [num_commands], home [num_links], folded [num_links] and
 * closed [num_commands] may be NULL. The counts are those of rdm_robot_get; folded and closed are 0 where it has none. */
RDM_API rdm_result rdm_robot_poses_of(int32_t robot, int32_t *commands, double *home, double *folded, float *closed);
/* For joints q [num_links], in the root frame: poses [num_links][7] of the links, position (m) and quaternion. flange [7],
 * tips [num_fingers][3] and palm [7] (origin at hold_p, y into the palm, z as the fingers point) may be NULL. */
RDM_API rdm_result rdm_robot_kinematics(int32_t robot, const double *q, double *poses, double *flange, double *tips,
                                        double *palm);
/* Joints q [num_links], from where they are, to where the arm's flange has pose [7] in the root frame. *found is 0 when the
 * least squares end elsewhere. UNSUPPORTED: no flange. */
RDM_API rdm_result rdm_robot_reach(int32_t robot, const double pose[7], double *q, int32_t *found);

/* ---- objects: a catalogue of everyday things, and your own ------------------------------------------------------ */
/* An object is shapes, a mass, its moments and the friction of its surface, by name: option object=NAME of the tasks of hands,
 * rdm_scene_add_object in a scene. Those of the YCB set are found by their number too ("025_mug"), with or without it.
 *
 *   rdm_object_def d;  int32_t object;
 *   rdm_shape_def s = {.kind = RDM_BOX, .size = {0.02, 0.03, 0.06}};
 *   rdm_object_def_init(&d, sizeof d);
 *   d.name = "my_box";  d.shapes = &s;  d.num_shapes = 1;  d.mass = 0.2;
 *   if (rdm_object_create(&object, &d)) puts(rdm_last_error());
 */
typedef struct rdm_shape_def { /* frozen layout: a shape of a body or an object, or one that stands still */
  const char *name;        /* unique in the scene; NULL: that of the body. Of an object unused            */
  const char *material;    /* of rdm_scene_add_material; NULL: "default". Of an object unused             */
  const double *points;    /* [num_points][3] of an RDM_HULL: 4 to 32 points, m; else NULL                */
  int32_t num_points;      /* count                                                                       */
  int32_t kind;            /* RDM_SPHERE ... RDM_HULL; an RDM_PLANE stands still                          */
  double size[3];          /* as rdm_shape, m; of a hull unused                                           */
  double p[3];             /* position in the frame of the body, or in the world, m                       */
  double q[4];             /* rotation; all 0: none                                                       */
  uint8_t color[4];        /* red, green, blue, 255; all 0: grey                                          */
  int32_t seen_only;       /* flag: nothing touches it                                                    */
} rdm_shape_def;
#define RDM_OBJECT_SHAPES 64 /* most shapes of an object */
typedef struct rdm_object_def { /* a whole object; rdm_object_create copies it with its shapes */
  uint32_t struct_size;    /* bytes, set by rdm_object_def_init                                           */
  int32_t num_shapes;      /* 1 to RDM_OBJECT_SHAPES                                                      */
  const char *name;        /* letters, digits, '_', '-', '+'; at most 25                                  */
  const char *alias;       /* another name; NULL                                                          */
  const char *summary;     /* one line; NULL: none                                                        */
  const char *material;    /* what its surface is: a name for scenes; NULL: "object"                      */
  const rdm_shape_def *shapes; /* [num_shapes] in any one frame: a body's is at its centre of mass, axes stay */
  double mass;             /* kg, 1e-6 to 1000                                                            */
  double moment[6];        /* xx yy zz xy xz yz, kg m2, the frame's origin then is the centre of mass; all 0: of the
                            * shapes, solid, of one density; where two overlap, both count                */
  double friction;         /* coefficient of its surface on dry things, 0 to 10; default 0.5              */
} rdm_object_def;
RDM_API rdm_result rdm_object_def_init(rdm_object_def *def, size_t size); /* defaults into the first `size` bytes */
RDM_API rdm_result rdm_object_find(const char *name, int32_t *index); /* name or alias; NOT_FOUND: nearest in the text */
/* What rdm_object_create took, with the moments about the centre of mass, but for the shapes, which are NULL here.
 * Shape i < num_shapes is in the frame at the centre of mass; the points of a hull live as long as the object. */
RDM_API rdm_result rdm_object_get(int32_t object, rdm_object_def *io);
RDM_API rdm_result rdm_object_shape_at(int32_t object, int32_t i, rdm_shape_def *out);
/* Adds an object under a number that no other gets, *out for rdm_object_at and what is here. ARGUMENT, RANGE: the text names
 * the row; a name that is taken is an ARGUMENT. Objects belong to the process; any number of threads may look meanwhile. */
RDM_API rdm_result rdm_object_create(int32_t *out, const rdm_object_def *def);
/* What rdm_object_create would say of it, but for a name that is taken; adds nothing. */
RDM_API rdm_result rdm_object_check(const rdm_object_def *def);
/* Pools that have it keep it. ARGUMENT for the library's own. */
RDM_API rdm_result rdm_object_remove(int32_t object);

/* ---- tasks of your own --------------------------------------------------------------------------------------- */
/* A task is a description and functions that the library calls: `build` for each pool that is made, to make the scene of
 * its worlds; the others in the resets and control steps of a world. Registered, it is a task like the library's own for
 * all that takes one by name: pools and threads, states, cameras and points, learners, checkpoints, the tool (--plugin).
 *
 *   static rdm_result build(void *user, rdm_scene *scene, void *instance) {
 *     struct ids *ids = instance;
 *     if (rdm_scene_add_body(scene, &cup, &ids->cup)) return rdm_fail(RDM_ARGUMENT, "the cup cannot be");  ... }
 *   ...
 *   rdm_task_def d;  int32_t task;
 *   rdm_task_def_init(&d, sizeof d);
 *   d.name = "press";  d.build = build;  d.reset = reset; ...
 *   if (rdm_task_register(&task, &d)) puts(rdm_last_error());
 *   if (rdm_task_check("press", NULL, NULL, 0)) puts(rdm_last_error());     the first promise that is broken
 *   config.task = "press"; ... rdm_pool_create(&p, &config) ...
 *
 * What the functions promise, and rdm_task_check tries:
 *   - What happens follows from the options, the world, its state and the random numbers that are given, alone: threads
 *     call them for many worlds at a time, and a world that was saved goes on elsewhere. Contacts and touches are those
 *     of the step just made, and no part of a saved world: they are for judge and observe.
 *   - `build` may be called more often than pools are made (to ask for sizes).
 *   - State and instance are plain bytes, zeroed before reset and build. No pointers in a state.
 *   - No memory is left behind by a step; nothing is kept of a pointer after the call.
 *   - They return RDM_OK, or an error. One of build is that of making the pool. One of control, judge or observe ends the
 *     episode of its world: truncated, RDM_STATUS_TASK, reward and cost 0 in that step; the other worlds go on and the
 *     step returns RDM_OK. rdm_pool_world_error has the text of the call that failed in them, or of rdm_fail. A reset that
 *     fails within a step flags the world too, which shows the end that it had until one succeeds in a later step, with
 *     the draws that follow; one within rdm_pool_reset is that call's error.
 *   - They do not leave by longjmp, which nothing here survives: a runtime whose errors do (Lua, Ruby, PHP) catches them
 *     within the function and returns an error. An exception of C++ that comes out counts as an ARGUMENT, out of `release`
 *     it goes to the log.
 *   - They do not call the handle that they are called for (STATE). */
typedef struct rdm_scene rdm_scene; /* handle, within build: what a world is made of */
typedef struct rdm_world rdm_world; /* handle, within a call of the others: one world */
/* Sets rdm_last_error of this thread to `text` and returns `code`. */
RDM_API rdm_result rdm_fail(rdm_result code, const char *text);
/* What failed last in world env of the pool: "world 3: task press: judge: sensor lost", at most 255 bytes; "" at first, and
 * for the library's own tasks. Kept until the world's next failure; no part of a saved state. */
RDM_API const char *rdm_pool_world_error(const rdm_pool *p, int32_t env);

typedef struct rdm_body_def { /* a free body; its frame is at its centre of mass */
  uint32_t struct_size;    /* bytes                                                                       */
  int32_t num_shapes;      /* count                                                                       */
  const char *name;        /* unique among bodies and robots                                              */
  const rdm_shape_def *shapes; /* [num_shapes] 1 or more                                                  */
  double p[3];             /* position at the start, m                                                    */
  double q[4];             /* rotation; all 0: none                                                       */
  double mass;             /* kg                                                                          */
  double moment[6];        /* xx yy zz xy xz yz, kg m2; all 0: of the shapes, solid, of one density       */
  double linear_damping;   /* 1/s                                                                         */
  double angular_damping;  /* 1/s; stands for rolling friction                                            */
  int32_t weightless;      /* flag: feels no gravity                                                      */
  int32_t reserved;        /* 0                                                                           */
} rdm_body_def;
typedef struct rdm_scene_robot { /* a robot in a scene: one of the list, or a tree of its own (a drawer, a door) */
  uint32_t struct_size;    /* bytes, set by rdm_scene_robot_init                                          */
  int32_t robot;           /* of rdm_robot_find; default -1: left out                                     */
  const rdm_robot_def *own; /* a robot of this scene alone, in the place of `robot`; NULL                 */
  const char *name;        /* begins, with '_', the names of its links, joints and shapes; unique         */
  const char *material;    /* of its shapes; NULL: "default"                                              */
  double p[3];             /* its base at the start, m                                                    */
  double q[4];             /* rotation; all 0: none                                                       */
  double base_damping;     /* of a free base: of all links, 1/s                                           */
  int32_t free_base;       /* flag: the base moves                                                        */
  int32_t left;            /* flag: the mirror image                                                      */
  int32_t gravity;         /* flag: its links feel gravity                                                */
  int32_t filled;          /* flag, set by rdm_scene_robot_init: without it a robot of 0 was left out     */
} rdm_scene_robot;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first version's. */
RDM_API rdm_result rdm_scene_robot_init(rdm_scene_robot *robot, size_t size);
enum rdm_scene_part { /* what rdm_scene_find looks for; numbers count from 0 in the order of adding */
  RDM_SCENE_ROBOT = 0, RDM_SCENE_BODY = 1,
  RDM_SCENE_LINK = 2,   /* of all robots, robot by robot; joint i moves link i */
  RDM_SCENE_JOINT = 3,
  RDM_SCENE_SHAPE = 4,  /* as rdm_pool_shape: robots, bodies, those that stand still */
  RDM_SCENE_SENSOR = 5, /* the link of a fingertip, for rdm_world_sensor */
  RDM_SCENE_MATERIAL = 6 /* "default" is 0 */
};
/* Value of the pool's option `key`: *value of a number, integer or flag, *text of a text. NOT_FOUND, ARGUMENT. */
RDM_API rdm_result rdm_scene_number(rdm_scene *scene, const char *key, double *value);
RDM_API rdm_result rdm_scene_text(rdm_scene *scene, const char *key, const char **text);
/* Bounds *low and *high of a number or integer whose row takes a range (choices "a..b"), for reset to draw from; equal: a number. */
RDM_API rdm_result rdm_scene_range(rdm_scene *scene, const char *key, double *low, double *high);
typedef struct rdm_contact_law { /* how two materials meet beside their friction */
  uint32_t struct_size;    /* bytes, set by rdm_contact_law_init                                          */
  int32_t pyramid;         /* flag, of soft contacts: friction by edges, as MuJoCo has it by default: the softer the more
                            * it rubs, and sliding lifts                                                  */
  double restitution;      /* 0 to 1: share of the speed at which a hard contact closed, above 0.05 m/s, that it parts with */
  double torsional;        /* m, 0 to 10: turning about the normal is opposed by at most this times the normal force */
  double rolling;          /* m, 0 to 10: rolling likewise                                                */
  double time_constant;    /* s, to 10: a spring and damper, as MuJoCo's solref; 0: hard. At least two substeps count */
  double damping_ratio;    /* of it, 0.01 to 100; default 1                                               */
  double impedance_min;    /* 1e-4 to 0.9999, of a touch, as MuJoCo's solimp; default 0.9                 */
  double impedance_max;    /* likewise, deeper than the width; default 0.95                               */
  double impedance_width;  /* m, to 10; default 0.001                                                     */
} rdm_contact_law;
RDM_API rdm_result rdm_contact_law_init(rdm_contact_law *law, size_t size); /* defaults into the first `size` bytes */
enum rdm_friction { RDM_PASSES = -1 }; /* in the place of a coefficient */
/* What is added gets the next number. A friction is that of two materials, or of one with itself; 1 unless
 * said; RDM_PASSES: they go through each other. Gravity [3] is in the place of the option's. The texts of errors name the
 * thing; all is STATE after the first find, touch or joint. A scene that could not be completed there, or in the end,
 * stays so: all later calls on it, and what `build` is called for, have that error. A robot that is neither `own` nor
 * given by number is an ARGUMENT. */
RDM_API rdm_result rdm_scene_add_material(rdm_scene *scene, const char *name); /* "default" is one, 15 more */
RDM_API rdm_result rdm_scene_set_friction(rdm_scene *scene, const char *a, const char *b, double mu); /* 0 or more */
/* RANGE, ARGUMENT: the text names the field. Making the pool is UNSUPPORTED with engine=ode where a law has more than a
 * restitution. Fingertips feel the forces of such contacts, not the torques of turning. */
RDM_API rdm_result rdm_scene_set_contact(rdm_scene *scene, const char *a, const char *b, const rdm_contact_law *law);
RDM_API rdm_result rdm_scene_set_gravity(rdm_scene *scene, const double gravity[3]); /* m/s2 */
RDM_API rdm_result rdm_scene_set_feedforward(rdm_scene *scene); /* worlds take rdm_world_set_feedforward */
RDM_API rdm_result rdm_scene_set_adjustable(rdm_scene *scene);  /* worlds take rdm_world_scale */
RDM_API rdm_result rdm_scene_add_robot(rdm_scene *scene, const rdm_scene_robot *robot, int32_t *index); /* index: NULL */
RDM_API rdm_result rdm_scene_add_body(rdm_scene *scene, const rdm_body_def *body, int32_t *index); /* index: NULL */
/* An object at the pose p [3] (m), q [4] (all 0: none) of its centre of mass, as the body and first shape `name` (others:
 * name_1, name_2 ...), `scale` times as large, 0.05 to 20, its mass as it is; index: NULL. Its material is one of the scene: a
 * new one rubs on each that is there with the object's friction, on another object's with the lower of the two. */
RDM_API rdm_result rdm_scene_add_object(rdm_scene *scene, int32_t object, const char *name, const double p[3], const double q[4],
                                        double scale, int32_t *index);
RDM_API rdm_result rdm_scene_add_static(rdm_scene *scene, const rdm_shape_def *shape); /* stands still */
/* For a task whose numbers follow from its options: another count for a field, in the order of rdm_task_def.fields; another
 * count of actions, with hold [count] and mean [count] as in rdm_task_def (NULL: 0). */
RDM_API rdm_result rdm_scene_set_field(rdm_scene *scene, const char *field, int32_t count);
RDM_API rdm_result rdm_scene_set_actions(rdm_scene *scene, int32_t count, const float *hold, const float *mean);
/* These look at the scene as a whole, which is complete from the first of them on. */
RDM_API rdm_result rdm_scene_find(rdm_scene *scene, int32_t part, const char *name, int32_t *index); /* NOT_FOUND: nearest */
RDM_API rdm_result rdm_scene_joint(rdm_scene *scene, int32_t i, rdm_joint *out); /* action: its robot's command, -1 */
/* *group, for rdm_world_touch: all contacts of a shape of `a` with one of `b`, each the name of a shape, body or robot, or a
 * pattern of such names with '*' and '?'. NOT_FOUND where nothing has it. */
RDM_API rdm_result rdm_scene_touch(rdm_scene *scene, const char *a, const char *b, int32_t *group);

typedef struct rdm_joints { /* the joints of all robots of a world; the addresses hold within the call */
  uint32_t struct_size;    /* in: bytes                                                                   */
  int32_t count;           /* of joints                                                                   */
  double control_dt;       /* s of a control step                                                         */
  const double *q;         /* [count] rad (m)                                                             */
  const double *qd;        /* [count] rad/s (m/s)                                                         */
  const double *target;    /* [count] what the drives go for                                              */
  const double *torque;    /* [count] of the drives, mean over the step, N m (N)                          */
} rdm_joints;
typedef struct rdm_motion { /* frozen layout: of a frame, in the world */
  double p[3];             /* m                                                                           */
  double q[4];             /* rotation                                                                    */
  double v[3];             /* velocity of the frame's origin, m/s                                         */
  double w[3];             /* angular velocity, world axes, rad/s                                         */
} rdm_motion;
/* Indices are those of the scene, out of range is RANGE; numbers that are not finite or no world can have are ARGUMENT; the
 * world then is as before. In observe nothing can be set: STATE. */
RDM_API rdm_result rdm_world_joints(const rdm_world *world, rdm_joints *io); /* fills io */
RDM_API rdm_result rdm_world_link(const rdm_world *world, int32_t link, rdm_motion *out);   /* of its joint's frame */
RDM_API rdm_result rdm_world_base(const rdm_world *world, int32_t robot, rdm_motion *out);  /* of its base */
RDM_API rdm_result rdm_world_body(const rdm_world *world, int32_t body, rdm_motion *out);   /* of its centre of mass */
RDM_API rdm_result rdm_world_shape(const rdm_world *world, int32_t shape, double pose[7]);  /* position, rotation */
/* Contact force [3] (N) and torque [3] (N m) on a fingertip, mean over the step, in the link's frame, about its origin. */
RDM_API rdm_result rdm_world_sensor(const rdm_world *world, int32_t sensor, double force[3], double torque[3]);
/* *pairs is how many pairs of a group's shapes touched in the step; *force (N) the sum of the group's contact forces in its
 * last substep. Either may be NULL. */
RDM_API rdm_result rdm_world_touch(const rdm_world *world, int32_t group, int32_t *pairs, double *force);
/* Contacts of the last substep to out [capacity], of things asleep as they fell asleep; *count is how many there are. */
RDM_API rdm_result rdm_world_contacts(const rdm_world *world, rdm_contact *out, int32_t capacity, int32_t *count);
/* By *depth (m) a body at its present place is within something that it may touch; 0: it is clear. */
RDM_API rdm_result rdm_world_overlap(rdm_world *world, int32_t body, double *depth);
/* Places for what moves freely; joints q [n] and rates qd [n] (NULL: 0) of a robot of n joints, within their ranges, and with
 * them the targets of its drives. */
RDM_API rdm_result rdm_world_set_body(rdm_world *world, int32_t body, const rdm_motion *motion);
RDM_API rdm_result rdm_world_set_base(rdm_world *world, int32_t robot, const rdm_motion *motion); /* STATE: it is fixed */
RDM_API rdm_result rdm_world_set_joints(rdm_world *world, int32_t robot, const double *q, const double *qd, int32_t n); /* all n */
/* What drives go for: targets [n] (rad, m) of the joints from `first` on; or commands [n] in [-1, 1] of all n commands of a
 * robot, which become targets as its description says: ranges or curves, no faster than its joints' velocity. */
RDM_API rdm_result rdm_world_set_targets(rdm_world *world, int32_t first, const double *targets, int32_t n);
RDM_API rdm_result rdm_world_command(rdm_world *world, int32_t robot, const double *commands, int32_t n);
/* Adds efforts [n] (N m, N) to the springs of the drives from `first` on, until they are set again; STATE unless the scene has
 * them. rdm_world_gravity gives those that hold a robot of n joints against gravity where it is. */
RDM_API rdm_result rdm_world_set_feedforward(rdm_world *world, int32_t first, const double *efforts, int32_t n);
RDM_API rdm_result rdm_world_gravity(const rdm_world *world, int32_t robot, double *efforts, int32_t n);
enum rdm_scale { /* what a factor is on, and in brackets its bounds */
  RDM_SCALE_GRAVITY = 0,        /* [-10, 10] */
  RDM_SCALE_LINK_MASS = 1,      /* [0.001, 1000], moments with it; index: link */
  RDM_SCALE_LINK_KP = 2, RDM_SCALE_LINK_KD = 3, RDM_SCALE_LINK_EFFORT = 4, RDM_SCALE_LINK_FRICTION = 5, /* [0, 1000] */
  RDM_SCALE_BASE_MASS = 6,      /* [0.001, 1000] of a free base; index: robot */
  RDM_SCALE_BASE_DAMPING = 7,   /* [0, 1000] of all links of a robot with a free base */
  RDM_SCALE_BODY_MASS = 8,      /* [0.001, 1000], moments with it; index: body */
  RDM_SCALE_BODY_SIZE = 9,      /* [0.05, 20] of all its shapes, moments with the square */
  RDM_SCALE_BODY_LINEAR_DAMPING = 10, RDM_SCALE_BODY_ANGULAR_DAMPING = 11, /* [0, 1000] */
  RDM_SCALE_FRICTION = 12       /* [0, 1000] of two materials, index and other */
};
typedef struct rdm_factor { /* frozen layout: on a constant of the scene, in one world */
  int32_t what;            /* RDM_SCALE_*                                                                 */
  int32_t index;           /* of the thing                                                                */
  int32_t other;           /* the second material of a friction                                           */
  int32_t reserved;        /* 0                                                                           */
  double factor;           /* times the scene's value                                                     */
} rdm_factor;
/* Lays factors [count] over those that the world has, all 1 at the start of an episode; reset may draw them. All are taken
 * or none. STATE unless the scene is adjustable. */
RDM_API rdm_result rdm_world_scale(rdm_world *world, const rdm_factor *factors, int32_t count);
/* Pushes during the next step, world axes: force [3] (N) at the centre of mass and torque [3] (N m); of a link at `point` [3]. */
RDM_API rdm_result rdm_world_push_body(rdm_world *world, int32_t body, const double force[3], const double torque[3]);
RDM_API rdm_result rdm_world_push_base(rdm_world *world, int32_t robot, const double force[3], const double torque[3]);
RDM_API rdm_result rdm_world_push_link(rdm_world *world, int32_t link, const double force[3], const double point[3]);

typedef struct rdm_random { /* frozen layout: a stream of random numbers; may be part of a state */
  uint64_t seed;           /* its name                                                                    */
  uint64_t counter;        /* draws so far                                                                */
  uint32_t world;          /* its name                                                                    */
  uint32_t purpose;        /* its name                                                                    */
} rdm_random;
/* Draws from the stream; 0 without one. The same numbers on every machine. */
RDM_API uint64_t rdm_random_bits(rdm_random *random);
RDM_API double rdm_random_uniform(rdm_random *random, double low, double high); /* in [low, high) */
RDM_API double rdm_random_normal(rdm_random *random);                           /* mean 0, deviation 1 */
/* Another stream to *out, for draws within an episode: reset makes it and keeps it in the state. */
RDM_API rdm_result rdm_random_split(rdm_random *random, rdm_random *out);
/* The turn by `angle` (rad) about the unit vector axis [3] to q [4]: the same bits on every machine, where those of a C library's
 * sine are not. */
RDM_API rdm_result rdm_rotation(const double axis[3], double angle, double q[4]);

typedef struct rdm_verdict { /* what judge fills; zeroed before */
  double reward;           /* of the step                                                                 */
  double cost[RDM_MAX_COSTS];     /* each column of the step, 0 or more                                   */
  double cost_raw[RDM_MAX_COSTS]; /* the measured value behind each                                       */
  int32_t terminated;      /* flag: the episode ends here                                                 */
  int32_t success;         /* flag                                                                        */
} rdm_verdict;
typedef struct rdm_field_def { /* frozen layout: a run of observation entries */
  const char *name;        /* unique, at most 31 characters: "cup.position"                               */
  const char *unit;        /* of a stored 1: "m", "5 rad/s", "1"                                          */
  int32_t count;           /* entries                                                                     */
  float low;               /* what no entry leaves; low equal to high: none but obs_limit                 */
  float high;              /* likewise                                                                    */
  int32_t reserved;        /* 0                                                                           */
} rdm_field_def;
typedef struct rdm_task_def { /* a whole task; all but `user` is copied by rdm_task_register */
  uint32_t struct_size;    /* bytes, set by rdm_task_def_init                                             */
  int32_t max_steps;       /* control steps of an episode: default of the option max_steps; default 100   */
  const char *name;        /* letters, digits, '_', '-', '.'; at most 40                                  */
  const char *summary;     /* one line; NULL: none                                                        */
  const rdm_field_def *fields;     /* [num_fields] of an observation, in order                            */
  const rdm_cost *costs;   /* [num_costs] column 0 is the one that learners limit                         */
  const rdm_option_info *options;  /* [num_options] rows, and defaults of its own for those that every task has */
  const rdm_camera *cameras;       /* [num_cameras] NULL with num_cameras 0: "front", made for the origin */
  const rdm_option *defaults;      /* [num_defaults] of agent options; NULL with num_defaults 0           */
  int32_t num_fields;      /* 1 or more                                                                   */
  int32_t num_costs;       /* 1 to RDM_MAX_COSTS                                                          */
  int32_t num_options;     /* count                                                                       */
  int32_t num_cameras;     /* count                                                                       */
  int32_t num_defaults;    /* count                                                                       */
  int32_t action_dim;      /* 1 to 1024                                                                   */
  const float *hold;       /* [action_dim] the action that holds still; NULL: 0                           */
  const float *mean;       /* [action_dim] that a new policy starts from; NULL: 0                         */
  const char *action_order;        /* what the entries are, for the layout hash; NULL: "action"           */
  double obs_limit;        /* every observation entry is cut at +- this; 0: none                          */
  uint64_t state_bytes;    /* of a world's own state, to 2^20                                             */
  uint64_t instance_bytes; /* of what build leaves for the others, to 2^24                                */
  void *user;              /* passed to all; may be NULL                                                  */
  /* makes the scene, and the constants of this pool. Required */
  rdm_result (*build)(void *user, rdm_scene *scene, void *instance);
  /* starts an episode, the world is as it was built. Required */
  rdm_result (*reset)(void *user, const void *instance, rdm_world *world, void *state, rdm_random *random);
  /* before a step: from the clipped action to targets and pushes. Required */
  rdm_result (*control)(void *user, const void *instance, rdm_world *world, void *state, const float *action);
  /* after a step, `step` counts from 1: reward, costs and the end. Required */
  rdm_result (*judge)(void *user, const void *instance, rdm_world *world, void *state, int32_t step, rdm_verdict *out);
  /* writes all entries of the observation, after reset and after judge. Required */
  rdm_result (*observe)(void *user, const void *instance, const rdm_world *world, const void *state, float *obs);
  /* FORMAT for a saved state that no world can have: indices out of range, numbers that are not finite. NULL: all are good */
  rdm_result (*check_state)(void *user, const void *instance, const void *state);
  /* called once, when the task was removed and its last pool is gone. NULL: none */
  void (*release)(void *user);
} rdm_task_def;
RDM_API rdm_result rdm_task_def_init(rdm_task_def *def, size_t size); /* defaults into the first `size` bytes */
/* Adds a task under a number that no other gets, *out for rdm_task_at and its like. ARGUMENT, RANGE: the text names the row;
 * a name that is taken is an ARGUMENT. Tasks belong to the process; any number of threads may look meanwhile. */
RDM_API rdm_result rdm_task_register(int32_t *out, const rdm_task_def *def);
/* Pools that have it keep it. ARGUMENT for the library's own. */
RDM_API rdm_result rdm_task_remove(int32_t task);
/* Tries what a task promises, any task: the same bytes for the same seed, any threads and after save and restore, rows within
 * their fields and bounds, costs of 0 or more, nothing written past a state or a row, no memory left behind. OK, or the error
 * of making a pool, or ARGUMENT: the text names the function, the step and the entry where a promise broke first; it goes to
 * error [error_size] too, NULL: not. `settings` as in rdm_pool_config; NULL: none. Seconds. */
RDM_API rdm_result rdm_task_check(const char *task, const char *settings, char *error, int32_t error_size);

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
typedef struct rdm_map rdm_map; /* handle */
typedef struct rdm_map_config { /* what a map is made from */
  uint32_t struct_size;    /* bytes, set by rdm_map_config_init                                           */
  uint32_t reserved;       /* 0                                                                           */
  double resolution;       /* side of a voxel, m, 0.001 to 10, default 0.02                               */
  uint64_t memory;         /* bytes that tree and workspace may take, 2^20 to 2^36, default 2^26          */
  double max_range;        /* m; longer rays clear their way so far and add no occupied voxel; 0: none is
                            * too long; default 4, with which looks of a pool's cameras fit into memory   */
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
typedef struct rdm_map_info { /* how full a map is */
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
 * rays pass. Points that are not finite are left out, and those nearer to the origin than a voxel's side: a depth of 0
 * says that nothing was seen. A full map grows no more: the call returns OK, *dropped (may
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
  const int32_t *point_count;     /* [num_envs] points that differ; the rest repeats them in turn, up to those of option
                                   * goal_points, which come last: the first free body where it is to be brought   */
  const int8_t *voxels;           /* [num_envs][num_voxels][num_voxels][num_voxels] (x, y, z) about the task's
                                   * object: 1 occupied, 0 free, -1 not seen                                       */
  const uint8_t *point_class;     /* [num_envs][num_points] what a point lies on: one of the articulations (hands,
                                   * arms included), then of the free bodies, then anything else, or nothing; last
                                   * the goal, with option goal_points                                             */
  int32_t num_classes;            /* of those; 0 where points are off                                              */
  int32_t reserved2;              /* 0                                                                             */
  const uint8_t *point_color;     /* [num_envs][num_points][3] of what a point lies on, sRGB, 0 for nothing; NULL without
                                   * option point_color                                                            */
} rdm_sensors;
RDM_API rdm_result rdm_pool_sensors(const rdm_pool *p, rdm_sensors *io); /* fills io */
/* The i-th camera by whose name this pool can look: the task's, then those that ride on its robots ("right_palm" and
 * "left_palm" of hands), then those for clouds. RANGE ends. */
RDM_API rdm_result rdm_pool_camera(const rdm_pool *p, int32_t i, rdm_camera *out);
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

/* ---- recordings: trajectories as data, and what is learned from them ------------------------------------------ */
/* Rows of what was seen, done and meant, of a pool, of arrays of yours or of a file that numpy opens. An agent clones
 * them, is held near them, and worlds begin at their states.
 *
 *   rdm_recording_config c;  rdm_recording *r;
 *   rdm_recording_config_init(&c, sizeof c);
 *   rdm_recording_config_for_pool(&c, pool);
 *   if (rdm_recording_create(&r, &c)) puts(rdm_last_error());
 *   for (...) {
 *     fill label with what the teacher would do, b.action with label and noise;
 *     rdm_recording_begin_step(r, pool, label, NULL);  rdm_pool_step(pool);  rdm_recording_end_step(r, pool, NULL);
 *   }
 *   rdm_agent_clone(agent, r, NULL, NULL);
 *   rdm_recording_destroy(r);
 *
 * One thread at a time; while none writes, any number may read. */
typedef struct rdm_recording rdm_recording; /* handle */
typedef struct rdm_recording_config { /* what a recording is made from */
  uint32_t struct_size;    /* bytes, set by rdm_recording_config_init                                      */
  int32_t obs_dim;         /* count, 1..16384, required                                                    */
  int32_t action_dim;      /* count, 1..1024, required                                                     */
  int32_t cost_dim;        /* count, 0..RDM_MAX_COSTS, default 0                                           */
  const char *task;        /* kept in files, "" for a host's own environment; to 63 bytes, copied; default "" */
  uint64_t layout_hash;    /* kept in files; 0: unknown                                                    */
  uint64_t state_bytes;    /* of one world's state, to 2^30; 0: no states are kept; default 0              */
  int64_t capacity;        /* rows, 0..2^40, for which memory is taken at once; more grow; default 0       */
  int32_t state_stride;    /* begin_step keeps the state of every n-th row of an episode, 1..2^30, default 8 */
  int32_t error_size;      /* bytes of error, terminator included; what is longer is cut                   */
  char *error;             /* [error_size] the text of a failing call that takes this config; NULL         */
  const rdm_host *host;    /* hooks of this handle, copied; NULL: those of rdm_init                        */
  int32_t num_points;      /* of the cloud beside each row, 0..65536; 0: none are kept; default 0          */
  int32_t point_color;     /* whether its points have colours: 0, 1; default 0                             */
} rdm_recording_config;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first version's. */
RDM_API rdm_result rdm_recording_config_init(rdm_recording_config *c, size_t size);
/* Sets dims, task, layout_hash, state_bytes, num_points and point_color from a pool. Pointers are borrowed from the pool. */
RDM_API rdm_result rdm_recording_config_for_pool(rdm_recording_config *c, const rdm_pool *p);
RDM_API rdm_result rdm_recording_create(rdm_recording **out, const rdm_recording_config *c); /* empty */
RDM_API void rdm_recording_destroy(rdm_recording *r);             /* NULL is fine */
/* Last failure of a call that may change it; "" at first. Of those that only read: rdm_last_error(). */
RDM_API const char *rdm_recording_error(const rdm_recording *r);

typedef struct rdm_recording_info { /* what a recording holds */
  uint32_t struct_size;    /* in: bytes                                                                    */
  int32_t obs_dim;         /* count                                                                        */
  int32_t action_dim;      /* count                                                                        */
  int32_t cost_dim;        /* count                                                                        */
  int64_t rows;            /* count                                                                        */
  int64_t episodes;        /* count, those that have not ended too                                         */
  int64_t num_states;      /* count                                                                        */
  uint64_t state_bytes;    /* of each                                                                      */
  uint64_t layout_hash;    /* 0: unknown                                                                   */
  uint64_t fingerprint;    /* of obs and label of all rows; what an agent that uses them is resumed by     */
  const char *task;        /* "" for a host's own environment                                              */
  int32_t num_points;      /* of each row's cloud; 0: it has none                                          */
  int32_t reserved;        /* 0                                                                            */
} rdm_recording_info;
RDM_API rdm_result rdm_recording_get_info(const rdm_recording *r, rdm_recording_info *io); /* fills io */

/* Rows in the order in which they came; those of an episode are in time, those of several may stand in turn. */
typedef struct rdm_recording_rows {
  uint32_t struct_size;       /* in: bytes                                                                 */
  uint32_t reserved;          /* 0                                                                         */
  int64_t rows;               /* count                                                                     */
  const float *obs;           /* [rows][obs_dim] before the action                                         */
  const float *action;        /* [rows][action_dim] that was done                                          */
  const float *label;         /* [rows][action_dim] that the teacher meant; to append, NULL: as action     */
  const float *reward;        /* [rows] to append, NULL: 0                                                 */
  const float *cost;          /* [rows][cost_dim] to append, NULL: 0                                       */
  const uint8_t *terminated;  /* [rows] to append, NULL: none                                              */
  const uint8_t *truncated;   /* [rows] to append, NULL: none                                              */
  const uint8_t *success;     /* [rows] to append, NULL: none                                              */
  const int64_t *episode;     /* [rows] number of its episode from 0; to append, NULL: each end begins one */
  int64_t num_states;         /* count                                                                     */
  const int64_t *state_row;   /* [num_states] row before which the world had the state, ascending          */
  const uint8_t *state;       /* [num_states][state_bytes] what rdm_pool_set_state takes                   */
  const int16_t *points;      /* [rows][num_points][3] mm, world, before the action; NULL without clouds    */
  const uint8_t *point_class; /* [rows][num_points] as of rdm_sensors; to append, NULL: 0                  */
  const uint8_t *point_color; /* [rows][num_points][3] likewise; NULL without colours                      */
} rdm_recording_rows;
/* Borrowed pointers, until the next call that changes the recording. */
RDM_API rdm_result rdm_recording_get_rows(const rdm_recording *r, rdm_recording_rows *io);
/* Adds rows of a host's own; their episodes are numbered behind those that are there, actions and labels are cut to
 * [-1, 1]. ARGUMENT for numbers that are not finite, flags that are not 0 or 1, episodes or states out of order: nothing changes. */
RDM_API rdm_result rdm_recording_append(rdm_recording *r, const rdm_recording_rows *rows);
/* Adds all of another one with the same dims, layout_hash and state_bytes. */
RDM_API rdm_result rdm_recording_append_all(rdm_recording *r, const rdm_recording *other);
/* Around rdm_pool_step, for worlds whose mask [num_envs] is not 0 (NULL: all): begin_step adds a row with the pool's obs and
 * action, and label [num_envs][action_dim] (NULL: as the action); actions and labels are cut to [-1, 1]. end_step adds the
 * step's reward, costs and flags to it; several steps between two begin_step make one row, of sums. A world that ended
 * begins an episode with its next row; one that a pool with next-step autoreset is about to reset gets none. A
 * recording follows one pool at a time: another one begins new episodes. */
RDM_API rdm_result rdm_recording_begin_step(rdm_recording *r, const rdm_pool *p, const float *label, const uint8_t *mask);
RDM_API rdm_result rdm_recording_end_step(rdm_recording *r, const rdm_pool *p, const uint8_t *mask);
/* Drops whole episodes: with need_success 1 those without a success, those whose sum of a cost is above its
 * max_cost [cost_dim] (NULL, or a negative number: any). *dropped (may be NULL) says how many. The others are numbered anew;
 * episodes that still run are closed. */
RDM_API rdm_result rdm_recording_filter(rdm_recording *r, int32_t need_success, const double *max_cost, int64_t *dropped);
RDM_API rdm_result rdm_recording_clear(rdm_recording *r);         /* no rows; memory stays */
/* A file of arrays, .npz, that numpy.load opens: obs, action, label, reward, cost, terminated, truncated, success, episode,
 * state_row, state, points, point_class; task, layout_hash, format. Replaced atomically. */
RDM_API rdm_result rdm_recording_save_file(const rdm_recording *r, const char *path);
/* Makes one of such a file, also as numpy.savez writes it, or of one that `redman rollout --record` wrote. NOT_FOUND; FORMAT when a
 * checksum, a shape or a number is wrong, VERSION_MISMATCH for a newer one. */
RDM_API rdm_result rdm_recording_load_file(rdm_recording **out, const char *path);

typedef struct rdm_clone_config { /* how rdm_agent_clone learns */
  uint32_t struct_size;       /* bytes, set by rdm_clone_config_init                                       */
  int32_t epochs;             /* passes over the rows, at most, 1..100000, default 30                      */
  int32_t batch_rows;         /* of a minibatch, 1..2^20, default 512                                      */
  int32_t patience;           /* epochs without a better validation loss that end it, 0: never; default 5  */
  double learning_rate;       /* Adam's, in the first epoch, 0..10, default 1e-3                           */
  double learning_rate_end;   /* in the last, linear between, 0..10, default 1e-5                          */
  double validation;          /* share of the rows that are not learned from, whole episodes, 0..0.9, default 0.1 */
  double action_std;          /* deviation of the actor's actions afterwards; 0: as it is; default 0       */
  uint64_t seed;              /* of shuffling and of the choice for validation, default 0                  */
  int32_t feed_normalizer;    /* flag: the statistics of observations become the recording's first, default 1 */
  int32_t capacity;           /* entries of the two below                                                  */
  double *train_loss;         /* [capacity] of each epoch, mean squared error of an entry; NULL: not wanted */
  double *validation_loss;    /* [capacity] likewise, after it                                             */
} rdm_clone_config;
RDM_API rdm_result rdm_clone_config_init(rdm_clone_config *how, size_t size); /* defaults into the first `size` bytes */
typedef struct rdm_clone_report { /* what rdm_agent_clone did */
  uint32_t struct_size;       /* in: bytes                                                                 */
  int32_t epochs;             /* that were run                                                             */
  int32_t best_epoch;         /* from 1: whose weights were kept; without validation the last one's        */
  int32_t stopped;            /* flag: it ended early                                                      */
  int64_t train_rows;         /* count                                                                     */
  int64_t validation_rows;    /* count                                                                     */
  double train_loss;          /* of the best epoch, mean squared error of an entry                         */
  double validation_loss;     /* likewise, 0 without validation                                            */
} rdm_clone_report;
/* Behaviour cloning: the actor's mean is fitted to the labels by Adam on minibatches, and the weights with the least validation
 * loss are kept; critics and multipliers stay, and the actor's optimiser begins anew. Between epochs of the agent: STATE
 * inside a horizon. how NULL: defaults; io may be NULL. CANCELLED after rdm_agent_cancel: weights and statistics as before. */
RDM_API rdm_result rdm_agent_clone(rdm_agent *a, const rdm_recording *r, const rdm_clone_config *how, rdm_clone_report *io);
/* The rows that the options `imitation` and `imitation_decay` hold the actor near; obs and label are copied. NULL: none. A
 * state that was saved with some loads only beside the same ones. */
RDM_API rdm_result rdm_agent_set_recording(rdm_agent *a, const rdm_recording *r);
/* Warm start: the actor, its deviation and the statistics of observations become the policy's, which count for `samples` (2 to
 * 10^12) observations; its optimiser begins anew. STATE inside a horizon; ARGUMENT where layout, hidden layers, activation,
 * std_mode, actor_obs, encoder or normalize_obs differ: the text says which, and nothing changes. */
RDM_API rdm_result rdm_agent_load_policy(rdm_agent *a, const rdm_policy *p, double samples);
/* Worlds begin an episode, with probability `share` (0 to 1), at a state of the recording, drawn from a stream of their own: all
 * other draws are what they are without. Such an episode has the steps that are left; sums begin at 0. States are copied, and
 * each is tried: FORMAT, and nothing changes. r NULL: the states of the last call, with another share; 0 at first. The
 * streams and the share are part of the state of all worlds (env -1), which loads only beside the same states. */
RDM_API rdm_result rdm_pool_set_starts(rdm_pool *p, const rdm_recording *r, double share);

#ifdef __cplusplus
}
#endif
#endif /* RDM_EXPERIMENTAL */
