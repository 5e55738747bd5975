/* 06: what the worlds see, and a map made of it.
 *
 *   06_see_and_map [file.bt]
 *
 * Two worlds of the cleaning task give point clouds with every step. Three looks at the first world become an
 * occupancy map; a plan of the broom is asked whether it meets something, and the map is written for
 * OctoMap's programs when a file is named. */
#define RDM_EXPERIMENTAL /* what worlds see, and maps: the last part of the header */
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORLDS = 2, POINTS = 256 };

/* Numbers of the shapes whose names begin with one of the words, to be left out of a map: what moves by
 * itself. out [num_shapes]; fails as rdm_pool_shape_at does. */
static rdm_result shapes_named(const rdm_pool* pool, int num_shapes, const char* const* words, int32_t* out,
                               size_t* count) {
  *count = 0;
  for (int i = 0; i < num_shapes; ++i) {
    rdm_shape_info shape = RDM_INIT(rdm_shape_info);
    const rdm_result r = rdm_pool_shape_at(pool, i, &shape);
    if (r != RDM_OK) return r;
    const char* const* word = words;
    while (*word && strncmp(shape.name, *word, strlen(*word)) != 0) ++word;
    if (*word) out[(*count)++] = i;
  }
  return RDM_OK;
}

int main(int argc, char** argv) {
  const rdm_option seen[] = {{"modality", "points", 0}, {"points", NULL, POINTS}};
  const char* const cameras[] = {"top", "side_left", "side_right"};
  const char* const movable[] = {"right", "left", "broom", "trash", "ground", NULL};
  /* the broom's head, 0.5 m wide, half way down the room: along the middle, and half a metre to the left */
  const float half[3] = {0.25f, 0.05f, 0.3f};
  const rdm_pose plans[2] = {{.p = {0, -1.6, 0.3}}, {.p = {-0.5, -1.6, 0.3}}};
  int32_t *skip = NULL, meets;
  size_t num_skip = 0;
  uint64_t dropped = 0;
  rdm_pool_config pool_config;
  rdm_map_config map_config;
  rdm_pool* pool = NULL;
  rdm_map* map = NULL;
  rdm_spec spec = {.struct_size = sizeof spec};
  rdm_sensors sensors = {.struct_size = sizeof sensors};
  rdm_map_info info = {.struct_size = sizeof info};
  int status = 1;

  if (rdm_pool_config_init(&pool_config, sizeof pool_config)) goto done;
  pool_config.task = "clean_house";
  pool_config.num_envs = WORLDS;
  pool_config.options = seen;
  pool_config.num_options = 2;
  if (rdm_pool_create(&pool, &pool_config)) goto done;
  if (rdm_pool_get_spec(pool, &spec) || rdm_pool_get_sensors(pool, &sensors)) goto done;
  if (rdm_pool_reset(pool, NULL, NULL)) goto done;
  if (rdm_pool_baseline(pool, RDM_BASELINE_HOLD) || rdm_pool_step(pool)) goto done;
  for (int w = 0; w < WORLDS; ++w) {
    const float* p = sensors.points + 3 * sensors.num_points * w;
    printf("world %d: %d points, the first at %.2f %.2f %.2f m\n", w, (int)sensors.point_count[w],
           (double)p[0], (double)p[1], (double)p[2]);
  }

  if (rdm_map_config_init(&map_config, sizeof map_config)) goto done;
  map_config.resolution = 0.04;
  map_config.max_range = 6;
  if (rdm_map_create(&map, &map_config)) goto done;
  skip = malloc((size_t)spec.num_shapes * sizeof *skip);
  if (!skip) goto done;
  if (shapes_named(pool, spec.num_shapes, movable, skip, &num_skip)) goto done;
  for (int i = 0; i < 3; ++i)
    if (rdm_map_scan(map, pool, 0, cameras[i], 128, 128, skip, num_skip, &dropped)) goto done;
  if (rdm_map_get_info(map, &info)) goto done;
  printf("map: %llu nodes, %llu kB, %llu voxels dropped\n", (unsigned long long)info.nodes,
         (unsigned long long)info.bytes / 1000, (unsigned long long)dropped);
  for (int i = 0; i < 2; ++i) {
    const double* p = plans[i].p;
    const float middle[3] = {(float)p[0], (float)p[1], (float)p[2]};
    float distance;
    if (rdm_map_meets(map, &plans[i], half, &meets)) goto done;
    if (rdm_map_get_distances(map, middle, 1, 2.0f, &distance)) goto done;
    printf("broom at x %.1f m: %s, the nearest thing %.2f m from its middle\n", p[0],
           meets ? "meets something" : "is free", (double)distance);
  }
  if (argc > 1 && rdm_map_write_file(map, argv[1])) goto done;
  status = 0;
done:
  if (status)
    fprintf(stderr, "06_see_and_map: %s\n", pool && map && !skip ? "out of memory" : rdm_last_error());
  free(skip);
  rdm_map_destroy(map);
  rdm_pool_destroy(pool);
  return status;
}
