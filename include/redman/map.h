/* redman/map.h: what is occupied, free and unknown in space. Experimental. */
#ifndef REDMAN_MAP_H
#define REDMAN_MAP_H
#include <redman/pool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A map divides space into voxels that are occupied, free or unknown. It is built from scans: point
 * clouds of your own, or of a pool's cameras. Its files are those of OctoMap (.bt, .ot).
 *
 *   rdm_map_config c;  rdm_map *m;
 *   rdm_map_config_init(&c, sizeof c);
 *   c.resolution = 0.02;
 *   if (rdm_map_create(&m, &c)) puts(rdm_last_error());
 *   rdm_map_scan(m, pool, 0, "top", 96, 96, NULL, 0, &dropped);   by a camera of world 0, or
 *   rdm_map_insert(m, origin, points, count, &dropped);           from points of your sensor
 *   rdm_map_get_probabilities(m, points, count, probability);
 *   rdm_map_destroy(m);
 *
 * One thread writes a map at a time; while none does, any number may read. All points are float [3]
 * in m. */
typedef struct rdm_map rdm_map; /* handle */
typedef struct rdm_map_config { /* what a map is made from */
  uint32_t struct_size;    /* bytes, set by rdm_map_config_init */
  uint32_t reserved;       /* 0 */
  double resolution;       /* side of a voxel, m, 0.001 to 10, default 0.02 */
  uint64_t memory;         /* bytes that tree and workspace may take, 2^20 to 2^36, default 2^26 */
  double max_range;        /* m; longer rays clear voxels up to here and add no occupied one; 0: no
                            * limit; default 4, with which scans by a pool's cameras fit into
                            * memory */
  double hit;              /* probability that a voxel is occupied where a ray ends, 0.5 to 0.999,
                            * default 0.7 */
  double miss;             /* the same where a ray passes, 0.001 to 0.5, default 0.4 */
  double low;              /* lowest probability of a voxel, 0.001 to 0.5, default 0.1192 */
  double high;             /* highest probability of a voxel, 0.5 to 0.999, default 0.971 */
  double threshold;        /* occupied from this probability on, low to high, default 0.5 */
  const rdm_host *host;    /* hooks for the workspace, copied; NULL: those of rdm_init */
  char *error;             /* [error_size] receives the text when a call that takes this config
                            * fails; NULL: not wanted */
  int32_t error_size;      /* bytes, terminator included; a longer text is cut */
  int32_t reserved2;       /* 0 */
} rdm_map_config;
typedef struct rdm_map_info { /* how full a map is */
  uint32_t struct_size;    /* in: bytes */
  uint32_t full;           /* 1: updates have been dropped since create, clear or read */
  double resolution;       /* m; reading a file takes over the file's */
  uint64_t nodes;          /* of the tree */
  uint64_t bytes;          /* of the tree */
  uint64_t bytes_max;      /* memory less the workspace */
  uint64_t dropped;        /* voxel updates that found no memory, since create, clear or read */
} rdm_map_info;
typedef struct rdm_voxel { /* frozen layout */
  float centre[3];         /* m */
  float side;              /* m; a multiple of the resolution where voxels were joined */
} rdm_voxel;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
 * version's. */
RDM_API rdm_result rdm_map_config_init(rdm_map_config *c, size_t size);
RDM_API rdm_result rdm_map_create(rdm_map **out,
                                  const rdm_map_config *c); /* RANGE outside the bounds */
RDM_API void rdm_map_destroy(rdm_map *m);                   /* NULL is fine */
/* Last failure of a call that may change the map; "" at first. Failures of calls that only read,
 * which many threads may make at a time, are in rdm_last_error(). */
RDM_API const char *rdm_map_error(const rdm_map *m);
RDM_API rdm_result rdm_map_get_info(const rdm_map *m, rdm_map_info *io); /* fills io */
RDM_API rdm_result rdm_map_clear(rdm_map *m);               /* all is unknown again */

/* Adds one scan: rays from origin [3] to points [count][3]. Each voxel changes once: its
 * probability rises where a ray ends, else falls where rays pass. Points that are not finite are
 * left out, and those nearer to the origin than a voxel's side: a depth of 0 says that nothing was
 * seen. A map has 65536 voxels along each axis, with 0 in its middle: RANGE for an origin outside;
 * points outside are left out, and their rays. A full map does not grow further: the call returns
 * OK, *dropped (may be NULL) says how many voxels were left out, and voxels that exist are still
 * updated. */
RDM_API rdm_result rdm_map_insert(rdm_map *m, const float origin[3], const float *points,
                                  size_t count, uint64_t *dropped);
/* Adds one scan by a camera of the pool's task: depths of w x h rays of world env. Rays that end on
 * one of the num_skip shapes in skip [num_skip], or meet nothing, are left out. *dropped as
 * above. RANGE for a shape, a world or w, h (1 to 8192) that does not exist. */
RDM_API rdm_result rdm_map_scan(rdm_map *m, rdm_pool *p, int32_t env, const char *camera, int32_t w,
                                int32_t h, const int32_t *skip, size_t num_skip,
                                uint64_t *dropped);

/* probability [count] that the voxel of each of points [count][3] is occupied; -1: unknown, also
 * outside of the map. ARGUMENT for a point that is not finite; nothing is written then. */
RDM_API rdm_result rdm_map_get_probabilities(const rdm_map *m, const float *points, size_t count,
                                             float *probability);
/* Occupied voxels that overlap the box from low [3] to high [3]: writes up to capacity to out
 * [capacity], *count is how many there are. */
RDM_API rdm_result rdm_map_get_voxels(const rdm_map *m, const float low[3], const float high[3],
                                      rdm_voxel *out, size_t capacity, size_t *count);
/* *meets is 1 when an occupied voxel overlaps the box of half sizes half [3] at `pose`. */
RDM_API rdm_result rdm_map_meets(const rdm_map *m, const rdm_pose *pose, const float half[3],
                                 int32_t *meets);
/* Where the ray from origin [3] along direction [3] enters the first occupied voxel within `range`
 * m: *found is 1 and hit [3] is written. An unknown voxel ends the ray unless through_unknown is
 * 1. */
RDM_API rdm_result rdm_map_raycast(const rdm_map *m, const float origin[3],
                                   const float direction[3], float range, int32_t through_unknown,
                                   float hit[3], int32_t *found);
/* distance [count] from each of points [count][3] to the nearest point of an occupied voxel, m;
 * `most` when none is that near. ARGUMENT for a point that is not finite; nothing is written
 * then. */
RDM_API rdm_result rdm_map_get_distances(const rdm_map *m, const float *points, size_t count,
                                         float most, float *distance);
/* Samples the map at the centres of a grid around `pose`, of n [3] cells (1 to 1024 each) of `side`
 * m, to out [n0][n1][n2], x outermost: 1 occupied, 0 free, -1 unknown. */
RDM_API rdm_result rdm_map_get_grid(const rdm_map *m, const rdm_pose *pose, const int32_t n[3],
                                    float side, int8_t *out);

/* OctoMap's files: RDM_MAP_BINARY (.bt: occupied or free) and RDM_MAP_FULL (.ot: the probabilities
 * too). */
enum rdm_map_format { RDM_MAP_BINARY = 0, RDM_MAP_FULL = 1 };
/* The map as the bytes [capacity] of a file; NULL asks for the size. */
RDM_API rdm_result rdm_map_write(const rdm_map *m, int32_t format, void *bytes, size_t capacity,
                                 size_t *size);
RDM_API rdm_result rdm_map_write_file(const rdm_map *m,
                                      const char *path); /* format by the file's ending; replaced
                                                          * atomically */
/* Replaces what the map holds, resolution included, by bytes [size] of a file. FORMAT, or MEMORY
 * when it does not fit; the map is unchanged then. */
RDM_API rdm_result rdm_map_read(rdm_map *m, const void *bytes, size_t size);
RDM_API rdm_result rdm_map_read_file(rdm_map *m, const char *path); /* NOT_FOUND, FORMAT ... */

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_MAP_H */
