/* redman_sense.h: what the worlds of a pool see, beside rdm_buffers: pictures, depths, point clouds, voxels.
 *
 * The option `modality` of every task says what is made in each reset and step ("points", "rgb+depth"); other
 * options say from which cameras and how large. Rows show the state that obs shows; nothing is kept of the state
 * before an automatic reset.
 *
 *   rdm_option seen[] = {{"modality", "points", 0}, {"points", NULL, 1024}};
 *   config.options = seen;  config.num_options = 2;  ... rdm_pool_create(&p, &config) ...
 *   rdm_sensors s = {sizeof s};
 *   rdm_pool_sensors(p, &s);
 *   for (...) { rdm_pool_step(p);  use s.points + 3 * s.num_points * env; }
 *
 * The rules of redman.h hold. May change until version 1.
 */
#ifndef REDMAN_SENSE_H
#define REDMAN_SENSE_H
#include <redman/redman.h>

#ifdef __cplusplus
extern "C" {
#endif

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
  const int32_t *segmentation;    /* the same, shape of rdm_pool_shape, -1: nothing                                */
  const float *points;            /* [num_envs][num_points][3], world, m; planes are left out                      */
  const int32_t *point_shape;     /* [num_envs][num_points], -1: nothing was seen                                  */
  const int32_t *point_count;     /* [num_envs] points that differ; the rest repeats them in turn                  */
  const int8_t *voxels;           /* [num_envs][x][y][z] about the task's object: 1 occupied, 0 free, -1 not seen  */
} rdm_sensors;
RDM_API rdm_result rdm_pool_sensors(const rdm_pool *p, rdm_sensors *io); /* fills io */
/* The cameras that rows stand for: i-th of the pictures (cloud 0) or of points and voxels (cloud 1). RANGE ends. */
RDM_API rdm_result rdm_pool_sensor_camera(const rdm_pool *p, int32_t cloud, int32_t i, rdm_camera *out);

/* Corners [capacity][3] of shape i, an RDM_HULL, in its own frame, m. Writes up to capacity of them; *count is how
 * many there are. */
RDM_API rdm_result rdm_pool_hull(const rdm_pool *p, int32_t i, float *points, int32_t capacity, int32_t *count);

/* `wanted` of points [count][3] that lie furthest from each other: their numbers, in order of choice, to chosen
 * [wanted]. `start` is the first. Exact. scratch: rdm_sample_scratch(count) bytes, 64-byte aligned; no heap. */
RDM_API rdm_result rdm_sample_furthest(const float *points, int32_t count, int32_t wanted, int32_t start,
                                       int32_t *chosen, void *scratch, size_t scratch_bytes);
RDM_API size_t rdm_sample_scratch(int32_t count); /* bytes; 0: count is outside [1, 2^22] */

#ifdef __cplusplus
}
#endif
#endif
