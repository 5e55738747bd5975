/* 01: make one world, step it with the zero action, read what happened.
 *
 *   01_step [steps]
 *
 * The zero action holds every joint of both hands in the middle of its range. */
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An observation is one row of numbers; its fields have names. */
static int field_offset(const rdm_pool* pool, int num_fields, const char* name) {
  for (int i = 0; i < num_fields; ++i) {
    rdm_field_info field = RDM_INIT(rdm_field_info);
    if (rdm_pool_field_at(pool, i, &field) == RDM_OK && strcmp(field.name, name) == 0) return field.offset;
  }
  return -1;
}

int main(int argc, char** argv) {
  const int steps = argc > 1 ? atoi(argv[1]) : 60;
  rdm_pool_config config;
  rdm_pool* pool = NULL;
  rdm_spec spec = {.struct_size = sizeof spec};
  rdm_buffers b = {.struct_size = sizeof b};
  int status = 1;

  if (rdm_pool_config_init(&config, sizeof config)) goto done;
  config.task = "hand_over_safe_finger";
  if (rdm_pool_create(&pool, &config)) goto done;
  if (rdm_pool_get_spec(pool, &spec) || rdm_pool_get_buffers(pool, &b)) goto done;
  if (rdm_pool_reset(pool, NULL, NULL)) goto done;

  const int object = field_offset(pool, spec.num_fields, "object.position");
  if (object < 0) {
    fprintf(stderr, "01_step: the task has no field object.position\n");
    goto done_quietly;
  }
  printf("%s: %d observations, %d actions, %d costs, a step every %.4f s\n", config.task, spec.obs_dim,
         spec.action_dim, spec.cost_dim, (double)spec.control_dt);
  for (int i = 1; i <= steps; ++i) {
    memset(b.action, 0, sizeof(float) * (size_t)spec.action_dim);
    if (rdm_pool_step(pool)) goto done;
    if (i % 10 == 0 || i == steps)
      printf("step %3d: object height %.3f m, reward %.4f, cost %.0f\n", i, (double)b.obs[object + 2],
             (double)b.reward[0], (double)b.cost[0]);
  }
  status = 0;
done:
  if (status) fprintf(stderr, "01_step: %s\n", rdm_last_error());
done_quietly:
  rdm_pool_destroy(pool);
  return status;
}
