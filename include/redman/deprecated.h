/* redman/deprecated.h: the names of 0.1, and some since. Each is, or calls, the new name that its
 * warning gives.
 *
 * Included by redman.h and import.h unless RDM_NO_DEPRECATED is defined; it goes with 1.1. The
 * symbols of 0.1 stay in the library as long as RDM_ABI: capi/stubs.awk writes them from the
 * functions of the first part. RDM_NO_DEPRECATION_WARNINGS keeps the compiler quiet. */
#ifndef REDMAN_DEPRECATED_H
#define REDMAN_DEPRECATED_H
#include <redman/agent.h>
#include <redman/policy.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct rdm_option_info { /* frozen layout: one row of an option table */
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
  int32_t kind;             /* RDM_KIND_NUMBER, RDM_KIND_INTEGER, RDM_KIND_FLAG, RDM_KIND_TEXT */
  int32_t live;             /* flag: rdm_agent_set_option may change it after creation */
} rdm_option_info;
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
  int32_t mount;            /* what it is fixed to; 0: the world; k > 0: link k - 1 of the scene;
                             * -k: the base of its articulation (robot) k - 1 */
} rdm_camera;
typedef struct rdm_joint {  /* frozen layout */
  const char *name;         /* "FFJ2"                                                         */
  double lower, upper;      /* rad                                                            */
  double kp;                /* N m/rad, 0: coupled                                            */
  double kd;                /* N m s/rad                                                      */
  double effort;            /* N m                                                            */
  int32_t action;           /* entry of the hand's action, -1: none                           */
  int32_t reserved;         /* 0                                                              */
} rdm_joint;
typedef struct rdm_object { /* frozen layout: an object by name, for option object=... */
  const char *name;         /* "egg"                                                          */
  const char *shape;        /* "capsule r 0.03, straight part 0.02": kind and sizes in m      */
  double mass;              /* kg; for "hull": of its default points, at 500 kg/m3            */
} rdm_object;
typedef struct rdm_shape {   /* frozen layout: a shape of the scene, the same for all worlds */
  const char *name;          /* "right.ff_distal" */
  float size[3];             /* m: radius | radius, half length along z | half sizes (hull: of
                              * its box) */
  int32_t kind;              /* RDM_SHAPE_SPHERE ... RDM_SHAPE_HULL; plane: the half space below
                              * z = 0 of its frame */
  uint8_t color[4];          /* red, green, blue, 255 */
  int32_t fixed;             /* flag: never moves */
} rdm_shape;
#if defined(REDMAN_AGENT_H) /* not there beside a library of policies alone */
/* pose [num_shapes][7]: position (m), quaternion (x, y, z, w); world frame of that world. A
 * function of the library, for there is nowhere here to put the doubles of rdm_pool_get_poses. */
RDM_API RDM_DEPRECATED("rdm_pool_get_poses")
rdm_result rdm_pool_poses(const rdm_pool *p, int32_t env, float *pose);
#endif

#if !defined(RDM_NO_DEPRECATED)
enum {
  RDM_ARGUMENT RDM_DEPRECATED("RDM_ERROR_ARGUMENT") = RDM_ERROR_ARGUMENT,
  RDM_RANGE RDM_DEPRECATED("RDM_ERROR_RANGE") = RDM_ERROR_RANGE,
  RDM_STATE RDM_DEPRECATED("RDM_ERROR_STATE") = RDM_ERROR_STATE,
  RDM_MEMORY RDM_DEPRECATED("RDM_ERROR_MEMORY") = RDM_ERROR_MEMORY,
  RDM_IO RDM_DEPRECATED("RDM_ERROR_IO") = RDM_ERROR_IO,
  RDM_FORMAT RDM_DEPRECATED("RDM_ERROR_FORMAT") = RDM_ERROR_FORMAT,
  RDM_VERSION_MISMATCH RDM_DEPRECATED("RDM_ERROR_VERSION_MISMATCH") = RDM_ERROR_VERSION_MISMATCH,
  RDM_UNSUPPORTED RDM_DEPRECATED("RDM_ERROR_UNSUPPORTED") = RDM_ERROR_UNSUPPORTED,
  RDM_PHYSICS RDM_DEPRECATED("RDM_ERROR_PHYSICS") = RDM_ERROR_PHYSICS,
  RDM_NOT_FOUND RDM_DEPRECATED("RDM_ERROR_NOT_FOUND") = RDM_ERROR_NOT_FOUND,
  RDM_CANCELLED RDM_DEPRECATED("RDM_ERROR_CANCELLED") = RDM_ERROR_CANCELLED,
  RDM_INTERNAL RDM_DEPRECATED("RDM_ERROR_INTERNAL") = RDM_ERROR_INTERNAL,
  RDM_NUMBER RDM_DEPRECATED("RDM_KIND_NUMBER") = RDM_KIND_NUMBER,
  RDM_INTEGER RDM_DEPRECATED("RDM_KIND_INTEGER") = RDM_KIND_INTEGER,
  RDM_FLAG RDM_DEPRECATED("RDM_KIND_FLAG") = RDM_KIND_FLAG,
  RDM_TEXT RDM_DEPRECATED("RDM_KIND_TEXT") = RDM_KIND_TEXT,
  RDM_SPHERE RDM_DEPRECATED("RDM_SHAPE_SPHERE") = RDM_SHAPE_SPHERE,
  RDM_CAPSULE RDM_DEPRECATED("RDM_SHAPE_CAPSULE") = RDM_SHAPE_CAPSULE,
  RDM_BOX RDM_DEPRECATED("RDM_SHAPE_BOX") = RDM_SHAPE_BOX,
  RDM_CYLINDER RDM_DEPRECATED("RDM_SHAPE_CYLINDER") = RDM_SHAPE_CYLINDER,
  RDM_PLANE RDM_DEPRECATED("RDM_SHAPE_PLANE") = RDM_SHAPE_PLANE,
  RDM_ELLIPSOID RDM_DEPRECATED("RDM_SHAPE_ELLIPSOID") = RDM_SHAPE_ELLIPSOID,
  RDM_HULL RDM_DEPRECATED("RDM_SHAPE_HULL") = RDM_SHAPE_HULL
};

static inline RDM_DEPRECATED("rdm_policy_read")
rdm_result rdm_policy_load(rdm_policy **out, const void *bytes, size_t size) {
  return rdm_policy_read(out, bytes, size);
}

static inline RDM_DEPRECATED("rdm_policy_read_file")
rdm_result rdm_policy_load_file(rdm_policy **out, const char *path) {
  return rdm_policy_read_file(out, path);
}

static inline RDM_DEPRECATED("rdm_policy_tensor_at")
rdm_result rdm_policy_tensor(const rdm_policy *p, int32_t i, rdm_tensor *out) {
  return rdm_policy_tensor_at(p, i, out);
}

static inline RDM_DEPRECATED("rdm_policy_get_tensor")
rdm_result rdm_policy_tensor_read(const rdm_policy *p, const char *name, float *out, size_t count) {
  return rdm_policy_get_tensor(p, name, out, count);
}

#if defined(REDMAN_AGENT_H)
enum {
  RDM_SAMPLE RDM_DEPRECATED("RDM_ACT_SAMPLE") = RDM_ACT_SAMPLE,
  RDM_MEAN RDM_DEPRECATED("RDM_ACT_MEAN") = RDM_ACT_MEAN
};

static inline RDM_DEPRECATED("rdm_task_field_at")
rdm_result rdm_task_field(int32_t task, int32_t i, rdm_field *out) {
  rdm_field_info info = RDM_INIT(rdm_field_info);
  const rdm_result r = rdm_task_field_at(task, i, out ? &info : NULL);
  if (r == RDM_OK) {
    out->name = info.name;
    out->unit = info.unit;
    out->offset = info.offset;
    out->count = info.count;
  }
  return r;
}

static inline RDM_DEPRECATED("rdm_task_field_at")
rdm_result rdm_task_field_bounds(int32_t task, int32_t i, float *low, float *high) {
  rdm_field_info info = RDM_INIT(rdm_field_info);
  const rdm_result r = rdm_task_field_at(task, i, low && high ? &info : NULL);
  if (r == RDM_OK) {
    *low = info.low;
    *high = info.high;
  }
  return r;
}

static inline RDM_DEPRECATED("rdm_task_cost_at")
rdm_result rdm_task_cost(int32_t task, int32_t i, rdm_cost *out) {
  rdm_cost_info info = RDM_INIT(rdm_cost_info);
  const rdm_result r = rdm_task_cost_at(task, i, out ? &info : NULL);
  if (r == RDM_OK) {
    out->name = info.name;
    out->help = info.help;
    out->limit = info.limit;
  }
  return r;
}

static inline RDM_DEPRECATED("rdm_task_option_at")
rdm_result rdm_task_option(int32_t task, int32_t i, rdm_option_info *out) {
  rdm_option_spec spec = RDM_INIT(rdm_option_spec);
  const rdm_result r = rdm_task_option_at(task, i, out ? &spec : NULL);
  if (r == RDM_OK) {
    out->key = spec.key;
    out->help = spec.help;
    out->text = spec.text;
    out->choices = spec.choices;
    out->number = spec.number;
    out->low = spec.low;
    out->high = spec.high;
    out->kind = spec.kind;
    out->live = spec.live;
  }
  return r;
}

static inline RDM_DEPRECATED("rdm_task_camera_at")
rdm_result rdm_task_camera(int32_t task, int32_t i, rdm_camera *out) {
  rdm_camera_info info = RDM_INIT(rdm_camera_info);
  const rdm_result r = rdm_task_camera_at(task, i, out ? &info : NULL);
  if (r == RDM_OK) {
    int k;
    out->name = info.name;
    for (k = 0; k < 3; ++k) {
      out->eye[k] = info.eye[k];
      out->target[k] = info.target[k];
    }
    out->fov_y = info.fov_y;
    out->mount = info.mount;
  }
  return r;
}

static inline RDM_DEPRECATED("rdm_robot_joint_at")
rdm_result rdm_robot_joint(int32_t robot, int32_t i, rdm_joint *out) {
  rdm_joint_info info = RDM_INIT(rdm_joint_info);
  const rdm_result r = rdm_robot_joint_at(robot, i, out ? &info : NULL);
  if (r == RDM_OK) {
    out->name = info.name;
    out->lower = info.lower;
    out->upper = info.upper;
    out->kp = info.kp;
    out->kd = info.kd;
    out->effort = info.effort;
    out->action = info.action;
    out->reserved = 0;
  }
  return r;
}

static inline RDM_DEPRECATED("rdm_object_info_at")
rdm_result rdm_object_at(int32_t index, rdm_object *out) {
  rdm_object_info info = RDM_INIT(rdm_object_info);
  const rdm_result r = rdm_object_info_at(index, out ? &info : NULL);
  if (r == RDM_OK) {
    out->name = info.name;
    out->shape = info.shape;
    out->mass = info.mass;
  }
  return r;
}

static inline RDM_DEPRECATED("rdm_task_default_at")
rdm_result rdm_task_default(int32_t task, int32_t i, rdm_option *out) {
  return rdm_task_default_at(task, i, out);
}

static inline RDM_DEPRECATED("rdm_pool_config_spec")
rdm_result rdm_pool_spec(const rdm_pool_config *c, rdm_spec *io) {
  return rdm_pool_config_spec(c, io);
}

static inline RDM_DEPRECATED("rdm_pool_config_memory")
rdm_result rdm_pool_memory(const rdm_pool_config *c, size_t *ours, size_t *engines) {
  return rdm_pool_config_memory(c, ours, engines);
}

static inline RDM_DEPRECATED("rdm_pool_field_at")
rdm_result rdm_pool_field(const rdm_pool *p, int32_t i, rdm_field *out) {
  rdm_field_info info = RDM_INIT(rdm_field_info);
  const rdm_result r = rdm_pool_field_at(p, i, out ? &info : NULL);
  if (r == RDM_OK) {
    out->name = info.name;
    out->unit = info.unit;
    out->offset = info.offset;
    out->count = info.count;
  }
  return r;
}

static inline RDM_DEPRECATED("rdm_pool_field_at")
rdm_result rdm_pool_field_bounds(const rdm_pool *p, int32_t i, float *low, float *high) {
  rdm_field_info info = RDM_INIT(rdm_field_info);
  const rdm_result r = rdm_pool_field_at(p, i, low && high ? &info : NULL);
  if (r == RDM_OK) {
    *low = info.low;
    *high = info.high;
  }
  return r;
}

static inline RDM_DEPRECATED("rdm_pool_get_initial_mean")
rdm_result rdm_pool_initial_mean(const rdm_pool *p, float *action) {
  return rdm_pool_get_initial_mean(p, action);
}

static inline RDM_DEPRECATED("rdm_pool_setting_at")
rdm_result rdm_pool_option(const rdm_pool *p, int32_t i, const char **key, char *text) {
  return rdm_pool_setting_at(p, i, key, text);
}

static inline RDM_DEPRECATED("rdm_pool_get_settings")
rdm_result rdm_pool_settings(const rdm_pool *p, char *text, size_t capacity, size_t *size) {
  return rdm_pool_get_settings(p, text, capacity, size);
}

static inline RDM_DEPRECATED("rdm_pool_get_buffers")
rdm_result rdm_pool_buffers(const rdm_pool *p, rdm_buffers *io) {
  return rdm_pool_get_buffers(p, io);
}

static inline RDM_DEPRECATED("rdm_pool_set_buffers")
rdm_result rdm_pool_bind(rdm_pool *p, const rdm_buffers *b) {
  return rdm_pool_set_buffers(p, b);
}

static inline RDM_DEPRECATED("rdm_pool_write_state")
rdm_result rdm_pool_state_size(const rdm_pool *p, int32_t env, size_t *bytes) {
  return rdm_pool_write_state(p, env, NULL, 0, bytes);
}

static inline RDM_DEPRECATED("rdm_pool_write_state")
rdm_result rdm_pool_get_state(const rdm_pool *p, int32_t env, void *bytes, size_t capacity,
                              size_t *size) {
  return rdm_pool_write_state(p, env, bytes, capacity, size);
}

static inline RDM_DEPRECATED("rdm_pool_read_state")
rdm_result rdm_pool_set_state(rdm_pool *p, int32_t env, const void *bytes, size_t size) {
  return rdm_pool_read_state(p, env, bytes, size);
}

static inline RDM_DEPRECATED("rdm_pool_get_hash")
rdm_result rdm_pool_hash(const rdm_pool *p, int32_t env, uint64_t *hash) {
  return rdm_pool_get_hash(p, env, hash);
}

static inline RDM_DEPRECATED("rdm_algo_option_at")
rdm_result rdm_algo_option(int32_t algo, int32_t i, rdm_option_info *out) {
  rdm_option_spec spec = RDM_INIT(rdm_option_spec);
  const rdm_result r = rdm_algo_option_at(algo, i, out ? &spec : NULL);
  if (r == RDM_OK) {
    out->key = spec.key;
    out->help = spec.help;
    out->text = spec.text;
    out->choices = spec.choices;
    out->number = spec.number;
    out->low = spec.low;
    out->high = spec.high;
    out->kind = spec.kind;
    out->live = spec.live;
  }
  return r;
}

static inline RDM_DEPRECATED("rdm_pool_shape_at")
rdm_result rdm_pool_shape(const rdm_pool *p, int32_t i, rdm_shape *out) {
  rdm_shape_info info = RDM_INIT(rdm_shape_info);
  const rdm_result r = rdm_pool_shape_at(p, i, out ? &info : NULL);
  if (r == RDM_OK) {
    int k;
    out->name = info.name;
    for (k = 0; k < 3; ++k) out->size[k] = (float)info.size[k];
    out->kind = info.kind;
    for (k = 0; k < 4; ++k) out->color[k] = info.color[k];
    out->fixed = info.fixed;
  }
  return r;
}

static inline RDM_DEPRECATED("rdm_pool_get_contacts")
rdm_result rdm_pool_contacts(const rdm_pool *p, int32_t env, rdm_contact *out, int32_t capacity,
                             int32_t *count) {
  size_t n = 0;
  const rdm_result r = rdm_pool_get_contacts(p, env, out, (size_t)capacity, count ? &n : NULL);
  if (r == RDM_OK) *count = (int32_t)n;
  return r;
}

static inline RDM_DEPRECATED("rdm_agent_config_memory")
rdm_result rdm_agent_memory(const rdm_agent_config *c, size_t *bytes) {
  return rdm_agent_config_memory(c, bytes);
}

static inline RDM_DEPRECATED("rdm_agent_set_option")
rdm_result rdm_agent_set(rdm_agent *a, const rdm_option *option) {
  return rdm_agent_set_option(a, option);
}

static inline RDM_DEPRECATED("rdm_agent_setting_at")
rdm_result rdm_agent_option(const rdm_agent *a, int32_t i, const char **key, char *text) {
  return rdm_agent_setting_at(a, i, key, text);
}

static inline RDM_DEPRECATED("rdm_agent_get_settings")
rdm_result rdm_agent_settings(const rdm_agent *a, char *text, size_t capacity, size_t *size) {
  return rdm_agent_get_settings(a, text, capacity, size);
}

static inline RDM_DEPRECATED("rdm_agent_tensor_at")
rdm_result rdm_agent_tensor(const rdm_agent *a, int32_t i, rdm_tensor *out) {
  return rdm_agent_tensor_at(a, i, out);
}

static inline RDM_DEPRECATED("rdm_agent_get_tensor")
rdm_result rdm_agent_tensor_read(const rdm_agent *a, const char *name, float *out, size_t count) {
  return rdm_agent_get_tensor(a, name, out, count);
}

static inline RDM_DEPRECATED("rdm_agent_set_tensor")
rdm_result rdm_agent_tensor_write(rdm_agent *a, const char *name, const float *values,
                                  size_t count) {
  return rdm_agent_set_tensor(a, name, values, count);
}

static inline RDM_DEPRECATED("rdm_agent_write_policy")
rdm_result rdm_agent_policy(const rdm_agent *a, void *bytes, size_t capacity, size_t *size) {
  return rdm_agent_write_policy(a, bytes, capacity, size);
}

static inline RDM_DEPRECATED("rdm_agent_write_policy_file")
rdm_result rdm_agent_policy_file(const rdm_agent *a, const char *path) {
  return rdm_agent_write_policy_file(a, path);
}

static inline RDM_DEPRECATED("rdm_agent_write_state")
rdm_result rdm_agent_save(const rdm_agent *a, void *bytes, size_t capacity, size_t *size) {
  return rdm_agent_write_state(a, bytes, capacity, size);
}

static inline RDM_DEPRECATED("rdm_agent_read_state")
rdm_result rdm_agent_load(rdm_agent *a, const void *bytes, size_t size) {
  return rdm_agent_read_state(a, bytes, size);
}

/* ---- names that no release had: no symbols --------------------------------------------------- */
static inline RDM_DEPRECATED("rdm_pool_setting_at")
rdm_result rdm_pool_option_at(const rdm_pool *p, int32_t i, const char **key, char *text) {
  return rdm_pool_setting_at(p, i, key, text);
}

static inline RDM_DEPRECATED("rdm_agent_setting_at")
rdm_result rdm_agent_option_at(const rdm_agent *a, int32_t i, const char **key, char *text) {
  return rdm_agent_setting_at(a, i, key, text);
}
#endif /* REDMAN_AGENT_H */
#endif /* RDM_NO_DEPRECATED */

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_DEPRECATED_H */

#if defined(RDM_EXPERIMENTAL) && !defined(RDM_NO_DEPRECATED) && defined(REDMAN_AGENT_H) \
    && !defined(REDMAN_DEPRECATED_EXPERIMENTAL_H)
#define REDMAN_DEPRECATED_EXPERIMENTAL_H
#include <redman/map.h>
#include <redman/plan.h>
#include <redman/record.h>
#include <redman/task.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
  RDM_REVOLUTE RDM_DEPRECATED("RDM_JOINT_REVOLUTE") = RDM_JOINT_REVOLUTE,
  RDM_PRISMATIC RDM_DEPRECATED("RDM_JOINT_PRISMATIC") = RDM_JOINT_PRISMATIC,
  RDM_ROOT_LINK RDM_DEPRECATED("RDM_LINK_ROOT") = RDM_LINK_ROOT,
  RDM_NO_LINK RDM_DEPRECATED("RDM_LINK_NONE") = RDM_LINK_NONE,
  RDM_PASSES RDM_DEPRECATED("RDM_FRICTION_PASSES") = RDM_FRICTION_PASSES
};
#define RDM_ROBOT_LINKS RDM_MAX_LINKS
#define RDM_ROBOT_KNOTS RDM_MAX_KNOTS
#define RDM_OBJECT_SHAPES RDM_MAX_SHAPES

static inline RDM_DEPRECATED("rdm_policy_get_columns")
rdm_result rdm_policy_columns(const rdm_policy *p, int32_t *columns, int32_t capacity,
                              int32_t *count) {
  size_t n = 0;
  const rdm_result r = rdm_policy_get_columns(p, columns, (size_t)capacity, count ? &n : NULL);
  if (r == RDM_OK) *count = (int32_t)n;
  return r;
}

static inline RDM_DEPRECATED("rdm_pool_get_sensors")
rdm_result rdm_pool_sensors(const rdm_pool *p, rdm_sensors *io) {
  return rdm_pool_get_sensors(p, io);
}

static inline RDM_DEPRECATED("rdm_pool_get_hull")
rdm_result rdm_pool_hull(const rdm_pool *p, int32_t i, float *points, int32_t capacity,
                         int32_t *count) {
  size_t n = 0;
  const rdm_result r = rdm_pool_get_hull(p, i, points, (size_t)capacity, count ? &n : NULL);
  if (r == RDM_OK) *count = (int32_t)n;
  return r;
}

static inline RDM_DEPRECATED("rdm_map_get_probabilities")
rdm_result rdm_map_query(const rdm_map *m, const float *points, size_t count, float *probability) {
  return rdm_map_get_probabilities(m, points, count, probability);
}

static inline RDM_DEPRECATED("rdm_map_get_voxels")
rdm_result rdm_map_box(const rdm_map *m, const float low[3], const float high[3], rdm_voxel *out,
                       size_t capacity, size_t *count) {
  return rdm_map_get_voxels(m, low, high, out, capacity, count);
}

static inline RDM_DEPRECATED("rdm_map_get_distances")
rdm_result rdm_map_distance(const rdm_map *m, const float *points, size_t count, float most,
                            float *distance) {
  return rdm_map_get_distances(m, points, count, most, distance);
}

static inline RDM_DEPRECATED("rdm_map_get_grid")
rdm_result rdm_map_grid(const rdm_map *m, const rdm_pose *pose, const int32_t n[3], float side,
                        int8_t *out) {
  return rdm_map_get_grid(m, pose, n, side, out);
}

static inline RDM_DEPRECATED("rdm_map_write")
rdm_result rdm_map_save(const rdm_map *m, int32_t format, void *bytes, size_t capacity,
                        size_t *size) {
  return rdm_map_write(m, format, bytes, capacity, size);
}

static inline RDM_DEPRECATED("rdm_map_write_file")
rdm_result rdm_map_save_file(const rdm_map *m, const char *path) {
  return rdm_map_write_file(m, path);
}

static inline RDM_DEPRECATED("rdm_map_read")
rdm_result rdm_map_load(rdm_map *m, const void *bytes, size_t size) {
  return rdm_map_read(m, bytes, size);
}

static inline RDM_DEPRECATED("rdm_map_read_file")
rdm_result rdm_map_load_file(rdm_map *m, const char *path) {
  return rdm_map_read_file(m, path);
}

static inline RDM_DEPRECATED("rdm_actor_config_memory")
rdm_result rdm_actor_memory(const rdm_actor_config *c, size_t *bytes) {
  return rdm_actor_config_memory(c, bytes);
}

static inline RDM_DEPRECATED("rdm_planner_get_settings")
rdm_result rdm_planner_settings(const rdm_planner *planner, char *text, size_t capacity,
                                size_t *size) {
  return rdm_planner_get_settings(planner, text, capacity, size);
}

static inline RDM_DEPRECATED("rdm_agent_get_values")
rdm_result rdm_agent_values(const rdm_agent *a, const float *obs, int32_t rows, float *value,
                            float *cost) {
  return rdm_agent_get_values(a, obs, rows, value, cost);
}

static inline RDM_DEPRECATED("rdm_recording_write_file")
rdm_result rdm_recording_save_file(const rdm_recording *r, const char *path) {
  return rdm_recording_write_file(r, path);
}

static inline RDM_DEPRECATED("rdm_recording_read_file")
rdm_result rdm_recording_load_file(rdm_recording **out, const char *path) {
  return rdm_recording_read_file(out, path);
}

static inline RDM_DEPRECATED("rdm_agent_set_policy")
rdm_result rdm_agent_load_policy(rdm_agent *a, const rdm_policy *p, double samples) {
  return rdm_agent_set_policy(a, p, samples);
}

static inline RDM_DEPRECATED("rdm_robot_destroy")
rdm_result rdm_robot_remove(int32_t robot) {
  return rdm_robot_destroy(robot);
}

static inline RDM_DEPRECATED("rdm_robot_create_mounted")
rdm_result rdm_robot_mount(int32_t *out, const char *name, int32_t arm, int32_t hand, double yaw,
                           double adapter, int32_t left) {
  return rdm_robot_create_mounted(out, name, arm, hand, yaw, adapter, left);
}

static inline RDM_DEPRECATED("rdm_robot_get_def")
rdm_result rdm_robot_get(int32_t robot, rdm_robot_def *io) {
  return rdm_robot_get_def(robot, io);
}

static inline RDM_DEPRECATED("rdm_robot_get_postures")
rdm_result rdm_robot_poses_of(int32_t robot, int32_t *commands, double *home, double *folded,
                              float *closed) {
  return rdm_robot_get_postures(robot, commands, home, folded, closed);
}

static inline RDM_DEPRECATED("rdm_robot_get_poses")
rdm_result rdm_robot_kinematics(int32_t robot, const double *q, rdm_pose *links, rdm_pose *flange,
                                double *tips, rdm_pose *palm) {
  return rdm_robot_get_poses(robot, q, links, flange, tips, palm);
}

static inline RDM_DEPRECATED("rdm_object_destroy")
rdm_result rdm_object_remove(int32_t object) {
  return rdm_object_destroy(object);
}

static inline RDM_DEPRECATED("rdm_object_get_def")
rdm_result rdm_object_get(int32_t object, rdm_object_def *io) {
  return rdm_object_get_def(object, io);
}

static inline RDM_DEPRECATED("rdm_scene_get_number")
rdm_result rdm_scene_number(rdm_scene *scene, const char *key, double *value) {
  return rdm_scene_get_number(scene, key, value);
}

static inline RDM_DEPRECATED("rdm_scene_get_text")
rdm_result rdm_scene_text(rdm_scene *scene, const char *key, const char **text) {
  return rdm_scene_get_text(scene, key, text);
}

static inline RDM_DEPRECATED("rdm_scene_get_range")
rdm_result rdm_scene_range(rdm_scene *scene, const char *key, double *low, double *high) {
  return rdm_scene_get_range(scene, key, low, high);
}

static inline RDM_DEPRECATED("rdm_scene_set_contact_law")
rdm_result rdm_scene_set_contact(rdm_scene *scene, const char *a, const char *b,
                                 const rdm_contact_law *law) {
  return rdm_scene_set_contact_law(scene, a, b, law);
}

static inline RDM_DEPRECATED("rdm_scene_joint_at")
rdm_result rdm_scene_joint(rdm_scene *scene, int32_t i, rdm_joint *out) {
  rdm_joint_info info = RDM_INIT(rdm_joint_info);
  const rdm_result r = rdm_scene_joint_at(scene, i, out ? &info : NULL);
  if (r == RDM_OK) {
    out->name = info.name;
    out->lower = info.lower;
    out->upper = info.upper;
    out->kp = info.kp;
    out->kd = info.kd;
    out->effort = info.effort;
    out->action = info.action;
    out->reserved = 0;
  }
  return r;
}

static inline RDM_DEPRECATED("rdm_scene_add_touch")
rdm_result rdm_scene_touch(rdm_scene *scene, const char *a, const char *b, int32_t *group) {
  return rdm_scene_add_touch(scene, a, b, group);
}

static inline RDM_DEPRECATED("rdm_world_get_joints")
rdm_result rdm_world_joints(const rdm_world *world, rdm_joints *io) {
  return rdm_world_get_joints(world, io);
}

static inline RDM_DEPRECATED("rdm_world_get_link")
rdm_result rdm_world_link(const rdm_world *world, int32_t link, rdm_motion *out) {
  return rdm_world_get_link(world, link, out);
}

static inline RDM_DEPRECATED("rdm_world_get_base")
rdm_result rdm_world_base(const rdm_world *world, int32_t robot, rdm_motion *out) {
  return rdm_world_get_base(world, robot, out);
}

static inline RDM_DEPRECATED("rdm_world_get_body")
rdm_result rdm_world_body(const rdm_world *world, int32_t body, rdm_motion *out) {
  return rdm_world_get_body(world, body, out);
}

static inline RDM_DEPRECATED("rdm_world_get_sensor")
rdm_result rdm_world_sensor(const rdm_world *world, int32_t sensor, double force[3],
                            double torque[3]) {
  return rdm_world_get_sensor(world, sensor, force, torque);
}

static inline RDM_DEPRECATED("rdm_world_get_touch")
rdm_result rdm_world_touch(const rdm_world *world, int32_t group, int32_t *pairs, double *force) {
  return rdm_world_get_touch(world, group, pairs, force);
}

static inline RDM_DEPRECATED("rdm_world_get_contacts")
rdm_result rdm_world_contacts(const rdm_world *world, rdm_contact *out, int32_t capacity,
                              int32_t *count) {
  size_t n = 0;
  const rdm_result r = rdm_world_get_contacts(world, out, (size_t)capacity, count ? &n : NULL);
  if (r == RDM_OK) *count = (int32_t)n;
  return r;
}

static inline RDM_DEPRECATED("rdm_world_get_overlap")
rdm_result rdm_world_overlap(rdm_world *world, int32_t body, double *depth) {
  return rdm_world_get_overlap(world, body, depth);
}

static inline RDM_DEPRECATED("rdm_world_get_gravity")
rdm_result rdm_world_gravity(const rdm_world *world, int32_t robot, double *efforts, int32_t n) {
  return rdm_world_get_gravity(world, robot, efforts, (size_t)n);
}

static inline RDM_DEPRECATED("rdm_world_set_commands")
rdm_result rdm_world_command(rdm_world *world, int32_t robot, const double *commands, int32_t n) {
  return rdm_world_set_commands(world, robot, commands, (size_t)n);
}

static inline RDM_DEPRECATED("rdm_world_set_factors")
rdm_result rdm_world_scale(rdm_world *world, const rdm_factor *factors, int32_t count) {
  return rdm_world_set_factors(world, factors, (size_t)count);
}

static inline RDM_DEPRECATED("rdm_task_create")
rdm_result rdm_task_register(int32_t *out, const rdm_task_def *def) {
  return rdm_task_create(out, def);
}

static inline RDM_DEPRECATED("rdm_task_destroy")
rdm_result rdm_task_remove(int32_t task) {
  return rdm_task_destroy(task);
}

#ifdef __cplusplus
}
#endif
#endif /* RDM_EXPERIMENTAL */

#if defined(REDMAN_IMPORT_H) && !defined(RDM_NO_DEPRECATED) \
    && !defined(REDMAN_DEPRECATED_IMPORT_H)
#define REDMAN_DEPRECATED_IMPORT_H
#ifdef __cplusplus
extern "C" {
#endif

typedef rdm_import_config rdm_import_options RDM_DEPRECATED("rdm_import_config");

static inline RDM_DEPRECATED("rdm_import_config_init")
rdm_result rdm_import_options_init(rdm_import_config *c, size_t size) {
  return rdm_import_config_init(c, size);
}

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_IMPORT_H */
