/* redman/base.h: results, version, hooks, options, rows of tables. Stable since 1.0. */
#ifndef REDMAN_BASE_H
#define REDMAN_BASE_H
#include <stddef.h>
#include <stdint.h>

#if !defined(RDM_API)
#if defined(RDM_STATIC)
#define RDM_API /* the library is part of the program, which exports none of it */
#elif defined(_WIN32)
#define RDM_API /* the library exports the names of its list; programs need no mark */
#elif defined(__GNUC__)
#define RDM_API __attribute__((visibility("default")))
#else
#define RDM_API
#endif
#endif

/* What a name of an older release is called now: the text of the compiler's warning. */
#if defined(RDM_NO_DEPRECATION_WARNINGS)
#define RDM_DEPRECATED(text)
#elif defined(__GNUC__)
#define RDM_DEPRECATED(text) __attribute__((deprecated(text)))
#else
#define RDM_DEPRECATED(text)
#endif

#ifdef __cplusplus
/* A struct that says its size, all else 0: `rdm_buffers b = RDM_INIT(rdm_buffers);`. For those that
 * have no _init function; those that have one have defaults that are not 0. */
#define RDM_INIT(T) ([]() -> T { T x = T(); x.struct_size = uint32_t(sizeof(T)); return x; }())
#else
#define RDM_INIT(T) {.struct_size = (uint32_t)sizeof(T)} /* the same; C++ has no such list */
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
  RDM_ERROR_PHYSICS = -9,          /* the physics engine gave up where no world could be flagged */
  RDM_ERROR_NOT_FOUND = -10,       /* unknown name (the text offers the nearest), missing file */
  RDM_ERROR_CANCELLED = -11,       /* the host ended the call; the handle is good */
  RDM_ERROR_INTERNAL = -99         /* a defect of redman */
};
RDM_API const char *rdm_result_string(rdm_result r); /* static, never NULL, also for unknown
                                                      * values */
/* This OS thread's last failure, one line; valid until its next failing rdm call; stale after a
 * success. Runtimes that move calls between threads (Go, asynchronous FFI) read config.error,
 * rdm_pool_error and their like instead. */
RDM_API const char *rdm_last_error(void);

/* ---- version and build ----------------------------------------------------------------------- */
/* The halves of the library: worlds, learners; and frozen policies, which a build may have without
 * the learners. */
enum rdm_feature { RDM_FEATURE_SIM = 1, RDM_FEATURE_LEARN = 2, RDM_FEATURE_POLICY = 4 };
RDM_API uint32_t rdm_version(void);  /* RDM_VERSION of the library that runs */
RDM_API uint32_t rdm_features(void); /* RDM_FEATURE_*: what this build has */
/* VERSION_MISMATCH unless the library has this ABI and at least this version. */
RDM_API rdm_result rdm_check_abi(uint32_t abi, uint32_t version);
/* For programs that call experimental functions: VERSION_MISMATCH unless major and minor of
 * `version`, the header's RDM_VERSION, are the library's. With ELF's symbol versions the loader has
 * checked it; a program that finds functions by name at run time, or that runs where symbols have
 * no versions, asks here. */
RDM_API rdm_result rdm_check_experimental(uint32_t version);
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
  const char *differs;    /* "ODE", "libccd", "ODE, libccd": these compute other bytes here than
                           * on the machines of the recorded hashes (compiled with fused
                           * multiply-adds, as by Debian for arm64, or another version), and so
                           * do worlds with contacts; "": none, or no simulation half */
} rdm_build;
RDM_API rdm_result rdm_build_info(rdm_build *io); /* fills io; strings are static */

/* ---- host hooks ------------------------------------------------------------------------------ */
typedef void (*rdm_body)(void *context, int32_t index); /* one piece of parallel work */
/* Whether a call that takes long is to end now: not 0. Asked in that call's thread, at places that
 * do not depend on the number of threads. `steps`: the control steps that worlds have taken for it
 * so far, by which a host that has no clock can bound it. */
typedef int32_t (*rdm_stop)(void *user, int64_t steps);
typedef struct rdm_host { /* what a host gives in the place of the C library and of our threads */
  uint32_t struct_size;   /* bytes */
  uint32_t reserved;      /* 0 */
  void *user;             /* passed back to every hook; may be NULL */
  /* `bytes` at a multiple of `align` (a power of two up to 64), or NULL. NULL hook: the C
   * library's. */
  void *(*alloc)(void *user, size_t bytes, size_t align);
  void (*release)(void *user, void *p, size_t bytes, size_t align); /* required with alloc */
  /* 0 info, 1 warning, 2 error; NULL: silent */
  void (*log)(void *user, int32_t level, const char *line);
  /* Must run body(context, i) once for every i in [0, n), each on one OS thread, and return when
   * all are done; may be serial. NULL: redman's own workers. Where it runs fewer, one twice or
   * another one, or returns before all are done, the call that needed it is STATE and says so: it
   * was done in part, and bodies that come later do nothing. */
  void (*parallel)(void *user, int32_t n, rdm_body body, void *context);
} rdm_host;
/* Process-wide hooks for handles made later, whose configs give none. Counted; NULL: defaults.
 * Optional. */
RDM_API rdm_result rdm_init(const rdm_host *host);
RDM_API void rdm_shutdown(void); /* the last call puts the default hooks back; handles stay valid */

/* ---- options --------------------------------------------------------------------------------- */
enum rdm_option_kind { /* of an option */
  RDM_KIND_NUMBER = 0, RDM_KIND_INTEGER = 1, RDM_KIND_FLAG = 2, RDM_KIND_TEXT = 3
};
enum rdm_option_level { /* whom an option is for */
  RDM_LEVEL_BASIC = 0,    /* all users: lists begin with these; rows of tasks of your own are */
  RDM_LEVEL_ADVANCED = 1, /* those who tune */
  RDM_LEVEL_LEGACY = 2    /* those who compare with the paper, an older release or another engine */
};
typedef struct rdm_option { /* frozen layout: one key and its value */
  const char *key;          /* case is ignored and '-' equals '_'                             */
  const char *text;         /* value as one line of text ("0.5", "0.7..1.3", "egg"); NULL: number
                             * is it */
  double number;            /* value when text is NULL                                        */
} rdm_option;
typedef struct rdm_option_spec { /* one row of an option table */
  uint32_t struct_size;     /* in: bytes                                                      */
  int32_t kind;             /* RDM_KIND_NUMBER, RDM_KIND_INTEGER, RDM_KIND_FLAG, RDM_KIND_TEXT */
  int32_t live;             /* flag: rdm_agent_set_option may change it after creation */
  int32_t level;            /* RDM_LEVEL_BASIC, RDM_LEVEL_ADVANCED, RDM_LEVEL_LEGACY          */
  const char *key;          /* static; its last word FIELD: any name of a field, or a pattern
                             * with '*' */
  const char *help;         /* one line, with the unit                                        */
  const char *text;         /* default of a text option, or of a number that is a range, else
                             * NULL */
  const char *choices;      /* text: allowed words "a|b|c", NULL: any; number, integer: "a..b":
                             * takes a range "0.7..1.3" too, which each world draws from at a
                             * reset; else NULL */
  double number;            /* default of number, integer, flag; of a range its middle        */
  double low, high;         /* inclusive bounds                                               */
} rdm_option_spec;
/* Options as one text, wherever a config has `settings`: lines `key=value`; spaces about either,
 * '\r' and lines that are empty do not count. They are laid over the config's `options`, later ones
 * over earlier ones; an error names the line. A NULL is none. */
/* What the texts of NOT_FOUND end with, for names of your own: writes to text [capacity] "; nearest
 * is gamma", "; nearest are a, b and c" of several that are equally near, or "" when nobody can
 * have meant one of `names`, one a line, of which the first 500 count. Case is ignored, '-' equals
 * '_'. Cut at capacity >= 1 bytes; 4 * RDM_TEXT_SIZE hold all. */
RDM_API rdm_result rdm_nearest_names(const char *name, const char *names, char *text,
                                     size_t capacity);

/* ---- poses ----------------------------------------------------------------------------------- */
typedef struct rdm_pose {   /* frozen layout: 7 doubles, where a frame is in another */
  double p[3];              /* its origin, m                                                  */
  double q[4];              /* its rotation (x, y, z, w), unit; given, all 0: none            */
} rdm_pose;

/* ---- rows of tables that several groups share ------------------------------------------------ */
typedef struct rdm_field {  /* frozen layout: a run of observation entries */
  const char *name;         /* "right.joint_position"                                         */
  const char *unit;         /* "rad", "m/s", "1" after scaling ...                            */
  int32_t offset;           /* first entry                                                    */
  int32_t count;            /* entries                                                        */
} rdm_field;
typedef struct rdm_field_info { /* what a run of observation entries is */
  uint32_t struct_size;     /* in: bytes                                                      */
  int32_t offset;           /* first entry                                                    */
  int32_t count;            /* entries                                                        */
  int32_t reserved;         /* 0                                                              */
  const char *name;         /* "right.joint_position"                                         */
  const char *unit;         /* "rad", "m/s", "1" after scaling ...                            */
  float low, high;          /* bounds that every entry keeps; NaN: none                       */
} rdm_field_info;
typedef struct rdm_tensor {   /* frozen layout: a named block of parameters */
  const char *name;           /* "actor.0.weight", "actor.log_std", "reward_critic.1.bias" */
  int32_t rows, cols;         /* row-major; cols 1 for vectors */
} rdm_tensor;
enum rdm_shape_kind { /* of rdm_shape_info */
  RDM_SHAPE_SPHERE = 0, RDM_SHAPE_CAPSULE = 1, RDM_SHAPE_BOX = 2, RDM_SHAPE_CYLINDER = 3,
  RDM_SHAPE_PLANE = 4, RDM_SHAPE_ELLIPSOID = 5, RDM_SHAPE_HULL = 6
};
typedef struct rdm_spec { /* sizes of a pool's rows; what a policy is checked against */
  uint32_t struct_size;      /* in: bytes */
  float control_dt;          /* s between steps */
  int32_t obs_dim;           /* count */
  int32_t action_dim;        /* count */
  int32_t cost_dim;          /* count */
  int32_t max_steps;         /* control steps of an episode */
  uint64_t layout_hash;      /* of field names, counts and action order: policies carry it */
  int32_t num_fields;        /* for rdm_pool_field_at */
  int32_t num_shapes;        /* for rdm_pool_shape_at */
  int32_t num_joints;        /* of all robots */
  int32_t task;              /* index for rdm_task_at and its like */
  int32_t action_repeat;     /* control steps in one rdm_pool_step: option action_repeat */
  int32_t reserved;          /* 0 */
} rdm_spec;

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_BASE_H */
