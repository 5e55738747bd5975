/* redman/base.h: results, version, hooks, options, rows of tables. Stable since 1.0. */
#ifndef REDMAN_BASE_H
#define REDMAN_BASE_H
#include <stddef.h>
#include <stdint.h>

#if !defined(RDM_API)
#if defined(RDM_STATIC)
#define RDM_API /* users of redman::redman_static and redman-static.pc define it */
#elif defined(_WIN32)
#define RDM_API /* the library exports the names of its list; programs need no mark */
#elif defined(__GNUC__)
#define RDM_API __attribute__((visibility("default")))
#else
#define RDM_API
#endif
#endif

/* Marks a name of an older release; `text`, its new name, is what the compiler's warning says. */
#if defined(RDM_NO_DEPRECATION_WARNINGS)
#define RDM_DEPRECATED(text)
#elif defined(__GNUC__)
#define RDM_DEPRECATED(text) __attribute__((deprecated(text)))
#else
#define RDM_DEPRECATED(text)
#endif

#ifdef __cplusplus
/* A struct with struct_size set and all other members 0: `rdm_buffers b = RDM_INIT(rdm_buffers);`.
 * For structs without an _init function; those with one have defaults that are not 0. */
#define RDM_INIT(T) ([]() -> T { T x = T(); x.struct_size = uint32_t(sizeof(T)); return x; }())
#else
#define RDM_INIT(T) {.struct_size = (uint32_t)sizeof(T)} /* the same; C++17 has no designators */
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this header; rdm_version() is that of the library. */
#define RDM_VERSION_MAJOR 1
#define RDM_VERSION_MINOR 0
#define RDM_VERSION_PATCH 0
#define RDM_VERSION (RDM_VERSION_MAJOR * 1000000 + RDM_VERSION_MINOR * 1000 + RDM_VERSION_PATCH)
#define RDM_ABI 1          /* also the SONAME; changes only when an old binary would break */
#define RDM_MAX_COSTS 16   /* cost columns of a task or an agent */
#define RDM_TEXT_SIZE 64   /* bytes of an option's text value, terminator included */

/* ---- results --------------------------------------------------------------------------------- */
typedef int32_t rdm_result; /* frozen values; positive ones are reserved */
enum rdm_result_code { /* values of rdm_result */
  RDM_OK = 0,
  RDM_ERROR_ARGUMENT = -1,         /* NULL, wrong struct_size, not finite, malformed */
  RDM_ERROR_RANGE = -2,            /* outside the documented bounds; index past the end */
  RDM_ERROR_STATE = -3,            /* calls in the wrong order */
  RDM_ERROR_MEMORY = -4,           /* the allocator refused */
  RDM_ERROR_IO = -5,               /* file system */
  RDM_ERROR_FORMAT = -6,           /* truncated, corrupt or foreign bytes */
  RDM_ERROR_VERSION_MISMATCH = -7, /* newer file, newer struct, other ABI */
  RDM_ERROR_UNSUPPORTED = -8,      /* left out of this build, or not defined for this combination */
  RDM_ERROR_PHYSICS = -9,          /* the physics engine failed, and no single world could be
                                    * flagged */
  RDM_ERROR_NOT_FOUND = -10,       /* unknown name (the text offers the nearest), missing file */
  RDM_ERROR_CANCELLED = -11,       /* the host ended the call; the handle is still usable */
  RDM_ERROR_INTERNAL = -99         /* a bug in redman */
};
RDM_API const char *rdm_result_string(rdm_result r); /* static, never NULL, also for unknown
                                                      * values */
/* The text of the last failure on this OS thread, one line. It is valid until the thread's next
 * failing rdm call; a call that succeeds does not clear it. Runtimes that move calls between
 * threads (Go, asynchronous FFI) should read config.error, rdm_pool_error and the like instead. */
RDM_API const char *rdm_last_error(void);

/* ---- version and build ----------------------------------------------------------------------- */
/* Parts of the library that a build may leave out: simulation, learning, and frozen policies, which
 * a build may have without learning. */
enum rdm_feature { RDM_FEATURE_SIM = 1, RDM_FEATURE_LEARN = 2, RDM_FEATURE_POLICY = 4 };
RDM_API uint32_t rdm_version(void);  /* RDM_VERSION of the library at run time */
RDM_API uint32_t rdm_features(void); /* RDM_FEATURE_*: what this build has */
/* VERSION_MISMATCH unless the library has this ABI and at least this version. */
RDM_API rdm_result rdm_check_abi(uint32_t abi, uint32_t version);
/* For programs that call experimental functions: VERSION_MISMATCH unless the library has the major
 * and minor version of `version`, the RDM_VERSION of the program's header. On ELF systems the
 * loader has already checked this by symbol versions; programs that look functions up by name at
 * run time, or run where symbols have no versions, should call it. */
RDM_API rdm_result rdm_check_experimental(uint32_t version);
typedef struct rdm_build { /* what this library was built from */
  uint32_t struct_size;   /* in: bytes                                              */
  uint32_t abi;           /* RDM_ABI of the library                                 */
  const char *version;    /* "1.0.0"                                                */
  const char *ode;        /* version of ODE; "" in a build without simulation       */
  const char *eigen;      /* version of Eigen                                       */
  const char *ccd;        /* version of libccd                                      */
  const char *octomap;    /* version of OctoMap                                     */
  const char *precision;  /* "double physics, float networks"                       */
  const char *compiler;   /* name and version                                       */
  const char *kernels;    /* instruction set that networks use on this machine      */
  const char *differs;    /* "ODE", "libccd" or "ODE, libccd": libraries whose results here differ
                           * in their last bits from those behind the recorded hashes (another
                           * version, or compiled with fused multiply-adds, as Debian does for
                           * arm64); worlds with contacts differ too then. "": none, or a build
                           * without simulation */
} rdm_build;
RDM_API rdm_result rdm_build_info(rdm_build *io); /* fills io; strings are static */

/* ---- host hooks ------------------------------------------------------------------------------ */
typedef void (*rdm_body)(void *context, int32_t index); /* one piece of parallel work */
/* Returns not 0 to end a long call now. It is called in that call's thread, at points that do not
 * depend on the number of threads. `steps` is the number of control steps simulated for the call so
 * far, by which a host without a clock can bound it. */
typedef int32_t (*rdm_stop)(void *user, int64_t steps);
typedef struct rdm_host { /* memory, log and threads of the host, used instead of the C library's
                           * and redman's own */
  uint32_t struct_size;   /* bytes */
  uint32_t reserved;      /* 0 */
  void *user;             /* passed back to every hook; may be NULL */
  /* Returns `bytes` of memory at a multiple of `align` (a power of two up to 64), or NULL when
   * there is none. Hook NULL: the C library's allocator. */
  void *(*alloc)(void *user, size_t bytes, size_t align);
  void (*release)(void *user, void *p, size_t bytes, size_t align); /* required with alloc */
  /* level: 0 info, 1 warning, 2 error; hook NULL: nothing is logged */
  void (*log)(void *user, int32_t level, const char *line);
  /* Must call body(context, i) exactly once for each i in [0, n), each call within one OS thread,
   * and return when all have returned; one after the other is fine. Hook NULL: redman's own worker
   * threads. If it skips an i, repeats one, passes another number or returns early, the redman call
   * that used it returns STATE and says so: its work was done in part, and late calls of body do
   * nothing. */
  void (*parallel)(void *user, int32_t n, rdm_body body, void *context);
} rdm_host;
/* Sets process-wide hooks for handles that are made later from configs whose host is NULL; host
 * NULL: the defaults. The first call sets them. Later ones are counted and change nothing with
 * NULL, and are STATE with hooks, until rdm_shutdown has undone all. Optional. */
RDM_API rdm_result rdm_init(const rdm_host *host);
RDM_API void rdm_shutdown(void); /* undoes one rdm_init; the last one restores the default hooks;
                                  * handles stay valid */

/* ---- options --------------------------------------------------------------------------------- */
enum rdm_option_kind { /* of an option */
  RDM_KIND_NUMBER = 0, RDM_KIND_INTEGER = 1, RDM_KIND_FLAG = 2, RDM_KIND_TEXT = 3
};
enum rdm_option_level { /* whom an option is for */
  RDM_LEVEL_BASIC = 0,    /* for all users: lists begin with these; options of tasks of your own are
                           * of this level */
  RDM_LEVEL_ADVANCED = 1, /* for tuning */
  RDM_LEVEL_LEGACY = 2    /* for comparisons with the paper, an older release or another engine */
};
typedef struct rdm_option { /* frozen layout: one key and its value */
  const char *key;          /* case is ignored and '-' equals '_'                             */
  const char *text;         /* value as one line of text ("0.5", "0.7..1.3", "egg"); NULL: `number`
                             * is the value */
  double number;            /* value when text is NULL                                        */
} rdm_option;
typedef struct rdm_option_spec { /* one row of an option table */
  uint32_t struct_size;     /* in: bytes                                                      */
  int32_t kind;             /* RDM_KIND_NUMBER, RDM_KIND_INTEGER, RDM_KIND_FLAG, RDM_KIND_TEXT */
  int32_t live;             /* flag: rdm_agent_set_option may change it after creation */
  int32_t level;            /* RDM_LEVEL_BASIC, RDM_LEVEL_ADVANCED, RDM_LEVEL_LEGACY          */
  const char *key;          /* static; a last word FIELD stands for the name of any field, or a
                             * pattern with '*' */
  const char *help;         /* one line, with the unit                                        */
  const char *text;         /* default of a text option, or of a number whose default is a range;
                             * else NULL */
  const char *choices;      /* text: the allowed words "a|b|c", NULL: any text; number, integer:
                             * "a..b" where a range "0.7..1.3" is allowed too, from which each world
                             * draws at a reset; else NULL */
  double number;            /* default of a number, integer or flag; for a range, its middle  */
  double low, high;         /* inclusive bounds                                               */
} rdm_option_spec;
/* Member `settings` of a config holds options as one text of lines `key=value`. Spaces around keys
 * and values, '\r' and empty lines are ignored. Settings override the config's `options`, and later
 * lines override earlier ones. The error for a line that is no key=value names the line; errors for
 * keys and values name the key. NULL: no settings. */
/* Writes to text [capacity] the hint that texts of NOT_FOUND end with, for names of your own: ";
 * nearest is gamma", "; nearest are a, b and c" for several that are equally near, or "" when
 * `name` resembles none of `names`, which has one name a line; the first 500 count. Case is ignored
 * and '-' equals '_'. The hint is cut at capacity (>= 1) bytes; 4 * RDM_TEXT_SIZE are always
 * enough. */
RDM_API rdm_result rdm_nearest_names(const char *name, const char *names, char *text,
                                     size_t capacity);

/* ---- poses ----------------------------------------------------------------------------------- */
typedef struct rdm_pose {   /* frozen layout, 7 doubles: where one frame is in another */
  double p[3];              /* its origin, m                                                  */
  double q[4];              /* its rotation, a unit quaternion (x, y, z, w); all 0 in an argument:
                             * no rotation */
} rdm_pose;

/* ---- rows of tables that several groups share ------------------------------------------------ */
typedef struct rdm_field {  /* frozen layout: consecutive entries of an observation */
  const char *name;         /* "right.joint_position"                                         */
  const char *unit;         /* what an entry of 1 is: "rad", "5 m/s", "1" for shares          */
  int32_t offset;           /* first entry                                                    */
  int32_t count;            /* entries                                                        */
} rdm_field;
typedef struct rdm_field_info { /* what consecutive entries of an observation are */
  uint32_t struct_size;     /* in: bytes                                                      */
  int32_t offset;           /* first entry                                                    */
  int32_t count;            /* entries                                                        */
  int32_t reserved;         /* 0                                                              */
  const char *name;         /* "right.joint_position"                                         */
  const char *unit;         /* what an entry of 1 is: "rad", "5 m/s", "1" for shares          */
  float low, high;          /* bounds of every entry; NaN: none                               */
} rdm_field_info;
typedef struct rdm_tensor {   /* frozen layout: a named block of parameters */
  const char *name;           /* "actor.0.weight", "actor.log_std", "reward_critic.1.bias" */
  int32_t rows, cols;         /* row-major; cols 1 for vectors */
} rdm_tensor;
enum rdm_shape_kind { /* of rdm_shape_info */
  RDM_SHAPE_SPHERE = 0, RDM_SHAPE_CAPSULE = 1, RDM_SHAPE_BOX = 2, RDM_SHAPE_CYLINDER = 3,
  RDM_SHAPE_PLANE = 4, RDM_SHAPE_ELLIPSOID = 5, RDM_SHAPE_HULL = 6
};
typedef struct rdm_spec { /* sizes of a pool's rows; policies are checked against it */
  uint32_t struct_size;      /* in: bytes */
  float control_dt;          /* s between steps */
  int32_t obs_dim;           /* count */
  int32_t action_dim;        /* count */
  int32_t cost_dim;          /* count */
  int32_t max_steps;         /* control steps of an episode */
  uint64_t layout_hash;      /* hash of field names, counts and action order; policy files keep
                              * it */
  int32_t num_fields;        /* for rdm_pool_field_at */
  int32_t num_shapes;        /* for rdm_pool_shape_at */
  int32_t num_joints;        /* of all robots */
  int32_t task;              /* index for rdm_task_at and the like */
  int32_t action_repeat;     /* control steps in one rdm_pool_step: option action_repeat */
  int32_t reserved;          /* 0 */
} rdm_spec;

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_BASE_H */
