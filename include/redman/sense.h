/* redman/sense.h: what worlds observe, and policies that read points. Experimental. */
#ifndef REDMAN_SENSE_H
#define REDMAN_SENSE_H
#include <redman/agent.h>
#include <redman/policy.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- limits that the worlds of a pool see ---------------------------------------------------- */
/* Gives the episode that runs in world env, -1: in every world, another cost limit, between the
 * ends of option limit_range. What is left of the budget changes by as much, what was spent stays
 * spent, and obs shows both (fields budget.left, budget.limit); other rows stay. The next episode
 * draws its limit, or has that of option `limit`. RANGE for a limit outside of limit_range, STATE
 * where no episode runs, UNSUPPORTED without limit_range; nothing changes then. No heap. */
RDM_API rdm_result rdm_pool_set_limit(rdm_pool *p, int32_t env, double limit);

/* ---- what the worlds of a pool see, beside rdm_buffers --------------------------------------- */
/* Option `modality` of every task says which of these each reset and step makes ("points",
 * "rgb+depth"); other options choose the cameras and sizes. They show the same state as obs; unlike
 * final_obs, nothing shows the last state before an automatic reset.
 *
 *   rdm_option seen[] = {{"modality", "points", 0}, {"points", NULL, 1024}};
 *   config.options = seen;  config.num_options = 2;  ... rdm_pool_create(&p, &config) ...
 *   rdm_sensors s = {.struct_size = sizeof s};
 *   rdm_pool_get_sensors(p, &s);
 *   for (...) { rdm_pool_step(p);  use s.points + 3 * s.num_points * env; }
 * / */
/* addresses stay until rdm_pool_destroy; NULL where the modality is off */
typedef struct rdm_sensors {
  uint32_t struct_size;           /* in: bytes */
  int32_t num_cameras;            /* of rgb, depth and segmentation, in the order of the option
                                   * `cameras` */
  int32_t width;                  /* pixels */
  int32_t height;                 /* pixels */
  int32_t num_points;             /* points of each world, option `points` */
  int32_t num_voxels;             /* along each side of the local grid, option `voxels` */
  float voxel_size;               /* m */
  int32_t reserved;               /* 0 */
  const uint8_t *rgb;             /* [num_envs][num_cameras][height][width][3] */
  const float *depth;             /* [num_envs][num_cameras][height][width], m along the optical
                                   * axis, 0: nothing */
  const int32_t *segmentation;    /* [num_envs][num_cameras][height][width], shape of
                                   * rdm_pool_shape_at, -1: nothing */
  const float *points;            /* [num_envs][num_points][3], world, m; planes are left out */
  const int32_t *point_shape;     /* [num_envs][num_points], -1: nothing was seen */
  const int32_t *point_count;     /* [num_envs] number of different points; later rows repeat them
                                   * in turn, up to those of option goal_points, which come last:
                                   * the first free body at its goal */
  const int8_t *voxels;           /* [num_envs][num_voxels][num_voxels][num_voxels] (x, y, z) around
                                   * the task's object: 1 occupied, 0 free, -1 not seen */
  const uint8_t *point_class;     /* [num_envs][num_points] what a point lies on, numbered in this
                                   * order: the articulations (a hand with its arm), the free
                                   * bodies, anything else or nothing, and with option goal_points
                                   * the goal */
  int32_t num_classes;            /* number of these classes; 0 where points are off */
  int32_t reserved2;              /* 0 */
  const uint8_t *point_color;     /* [num_envs][num_points][3] colour of what a point lies on, sRGB,
                                   * 0 for nothing; NULL without option point_color */
} rdm_sensors;
RDM_API rdm_result rdm_pool_get_sensors(const rdm_pool *p, rdm_sensors *io); /* fills io */
/* Camera i of those that this pool knows by name: the task's, then those on its robots
 * ("right_palm" and "left_palm" of hands), then those for clouds. RANGE past the end. */
RDM_API rdm_result rdm_pool_camera_at(const rdm_pool *p, int32_t i, rdm_camera_info *io);
/* Camera i of the pictures (cloud 0), or of those that points and voxels come from (cloud 1). RANGE
 * past the end. */
RDM_API rdm_result rdm_pool_sensor_camera_at(const rdm_pool *p, int32_t cloud, int32_t i,
                                             rdm_camera_info *io);

/* Writes up to capacity corners of shape i, an RDM_SHAPE_HULL, to points [capacity][3], in its own
 * frame, m; *count is how many there are. */
RDM_API rdm_result rdm_pool_get_hull(const rdm_pool *p, int32_t i, float *points, size_t capacity,
                                     size_t *count);

/* ---- pictures for people --------------------------------------------------------------------- */
/* How pictures look. */
enum rdm_look {
  RDM_LOOK_FINE = 0,  /* for people: soft shadows, materials, round edges, fingernails */
  RDM_LOOK_PLAIN = 1  /* as rdm_sensors shows them, in half the time or less */
};
/* What rdm_pool_draw draws. */
typedef struct rdm_picture {
  uint32_t struct_size;         /* bytes */
  int32_t env;                  /* world, the first of several */
  int32_t num_envs;             /* worlds side by side in one scene, from env on; 0: one */
  int32_t width;                /* pixels, 1..8192 */
  int32_t height;               /* pixels, 1..8192 */
  int32_t look;                 /* enum rdm_look */
  const char *camera;           /* of the task, by name; it is moved back until several worlds fit
                                 * into the picture */
  uint8_t *rgb;                 /* [height][width][3], or NULL */
  float *depth;                 /* [height][width] m along the optical axis, 0: nothing; or NULL */
  int32_t *segmentation;        /* [height][width], or NULL: shape i of world env + k is
                                 * k * num_shapes + i, -1: nothing */
} rdm_picture;
/* Draws worlds as rdm_pool_render does, which is this for one world and RDM_LOOK_FINE. Same state,
 * same bytes. Depth and segmentation are those of the shapes that collide, whatever the look.
 * Several worlds take memory for the time of the call. ARGUMENT without a camera, NOT_FOUND for one
 * that the task does not have, RANGE for another member outside of what it may be. */
RDM_API rdm_result rdm_pool_draw(rdm_pool *p, const rdm_picture *picture);

/* Farthest point sampling: chooses `wanted` of points [count][3], first number `start`, then always
 * the one that is farthest from all chosen before, and writes their numbers to chosen [wanted].
 * Exact. scratch [scratch_bytes]: rdm_sample_scratch bytes or more, of any alignment; no heap. */
RDM_API rdm_result rdm_sample_furthest(const float *points, size_t count, size_t wanted,
                                       int32_t start, int32_t *chosen, void *scratch,
                                       size_t scratch_bytes);
RDM_API size_t rdm_sample_scratch(size_t count); /* bytes, at any address; 0: count is outside
                                                  * [1, 2^22] */

/* ---- encoders: agents and policies that read points ------------------------------------------ */
/* With agent option `encoder` ("64,128") a PointNet computes features of a cloud for the actor,
 * beside the entries of the observation that it reads (option actor_obs; "vision": all but those of
 * an object); critics read observations alone. With rdm_sensors:
 *
 *   rdm_points seen = {.struct_size = sizeof seen, .num_points = s.num_points, .points = s.points};
 *   rdm_agent_act_points(agent, b.obs, &seen, RDM_ACT_SAMPLE, b.action);
 *   rdm_pool_step(pool);
 *   rdm_agent_record(agent, &t);
 *
 * or rdm_agent_rollout with a pool whose modality has points. Points are rounded to millimetres
 * from `encoder_origin`, within +-32.767 m; neither their order nor duplicates matter. Several
 * clouds (of two cameras, or of a goal) are given as one, with classes that tell their points
 * apart. */
typedef struct rdm_points {     /* a cloud for each row of obs, in the call that takes it */
  uint32_t struct_size;         /* bytes */
  int32_t num_points;           /* of each cloud: the agent's option encoder_points, the policy's
                                 * num_points */
  const float *points;          /* [rows][num_points][3], world, m, required */
  const uint8_t *point_class;   /* [rows][num_points] less than option encoder_classes; NULL only
                                 * where that is 0 */
  const uint8_t *point_color;   /* [rows][num_points][3]; NULL only without option encoder_color */
} rdm_points;
/* As rdm_agent_act: action [num_envs][action_dim] for obs [num_envs][obs_dim] and as many clouds,
 * of an agent with the option encoder; STATE without it. ARGUMENT for a point that is not finite,
 * RANGE for another number of points or a class that does not exist; nothing is remembered then. */
RDM_API rdm_result rdm_agent_act_points(rdm_agent *a, const float *obs, const rdm_points *points,
                                        int32_t mode, float *action);
/* As rdm_policy_act, of obs [rows][obs_dim], noise [rows][action_dim] or NULL,
 * action [rows][action_dim] and scratch [scratch_bytes], for a policy whose num_points is not 0;
 * STATE for others, errors as above. */
RDM_API rdm_result rdm_policy_act_points(const rdm_policy *p, const float *obs,
                                         const rdm_points *points, int32_t rows, const float *noise,
                                         float *action, void *scratch, size_t scratch_bytes);
/* As rdm_policy_act_points, of obs [rows][obs_dim], noise [rows][action_dim] or NULL,
 * action [rows][action_dim] and scratch [scratch_bytes], for a policy that also has a memory
 * (option history beside encoder): state [rows][state_dim] is that of rdm_policy_act_state in
 * memory.h; NULL only where state_dim is 0. */
RDM_API rdm_result rdm_policy_act_points_state(const rdm_policy *p, const float *obs,
                                               const rdm_points *points, float *state,
                                               int32_t rows, const float *noise, float *action,
                                               void *scratch, size_t scratch_bytes);
typedef struct rdm_pretrain_config { /* how rdm_agent_pretrain learns */
  uint32_t struct_size;       /* bytes, set by rdm_pretrain_config_init */
  int32_t num_labels;         /* kinds of points to tell apart, 2..64, required */
  int32_t epochs;             /* passes over the clouds, 1..100000, default 20 */
  int32_t batch_rows;         /* clouds of a minibatch, 1..4096, default 16 */
  double learning_rate;       /* of Adam, 0..10, default 1e-3, falling linearly to a tenth */
  double validation;          /* share of the clouds held back for validation, 0..0.9, default
                               * 0.1 */
  uint64_t seed;              /* of the head's weights, of shuffling and of the choice, default 0 */
} rdm_pretrain_config;
RDM_API rdm_result rdm_pretrain_config_init(rdm_pretrain_config *how,
                                            size_t size); /* defaults into the first `size` bytes */
typedef struct rdm_pretrain_report { /* what rdm_agent_pretrain did */
  uint32_t struct_size;       /* in: bytes */
  int32_t train_rows;         /* clouds */
  int32_t validation_rows;    /* clouds */
  int32_t reserved;           /* 0 */
  double train_loss;          /* of the last epoch, mean cross-entropy of a point, nats */
  double validation_loss;     /* likewise, over the clouds held back; NaN without these */
  double accuracy;            /* share of points classified correctly, of the clouds held back;
                               * without these, of all clouds */
  double most_common;         /* accuracy of always answering with the most common label */
} rdm_pretrain_report;
/* Trains the agent's encoder to classify the points of clouds [rows] by label [rows][num_points],
 * each less than num_labels: a head that reads a point's last hidden layer and the cloud's features
 * is added, and thrown away afterwards. Nothing else changes. Same seed, same bytes, for any number
 * of threads. STATE inside a horizon or without an encoder; CANCELLED after rdm_agent_cancel: the
 * encoder is as before. io may be NULL. */
RDM_API rdm_result rdm_agent_pretrain(rdm_agent *a, const rdm_points *points, const uint8_t *label,
                                      int32_t rows, const rdm_pretrain_config *how,
                                      rdm_pretrain_report *io);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_SENSE_H */
