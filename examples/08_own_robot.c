/* 08: a hand out of a file, on an arm: it learns to grasp a cube.
 *
 *   08_own_robot [FILE] [arm] [epochs]      FILE: URDF, MJCF or .robot; default examples/robots/tripod.urdf
 *
 * The importer says what it guessed and what it left out; then the hand has a name like any other, for the
 * options of the tasks. */
#include <redman/import.h>
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  const char* file = argc > 1 ? argv[1] : "examples/robots/tripod.urdf";
  const int epochs = argc > 3 ? atoi(argv[3]) : 20;
  rdm_import* import = NULL;
  rdm_robot_def hand;
  rdm_import_note note;
  rdm_pool_config w;
  rdm_agent_config l;
  rdm_pool* pool = NULL;
  rdm_agent* agent = NULL;
  rdm_epoch e = {.struct_size = sizeof e};
  char settings[200];
  int32_t robot;
  int status = 1;

  if (rdm_import_read_file(&import, file, NULL)) {
    fprintf(stderr, "08_own_robot: %s\n", rdm_import_error());
    return 1;
  }
  for (int32_t i = 0; i < rdm_import_note_count(import); ++i)
    if (!rdm_import_note_at(import, i, &note))
      printf("line %d, %s: %s\n", (int)note.line, note.kind == RDM_NOTE_DROPPED ? "left out" : "guessed",
             note.text);
  if (rdm_robot_def_init(&hand, sizeof hand)) goto done;
  if (rdm_import_get_robot_def(import, &hand)) {
    fprintf(stderr, "08_own_robot: %s\n", rdm_import_error()); /* of another library, with texts of its own */
    rdm_import_destroy(import);
    return 1;
  }
  if (rdm_robot_create(&robot, &hand)) goto done;
  printf("%s: %d joints, %d fingers\n", hand.name, (int)hand.num_links, (int)hand.num_fingers);

  if (rdm_pool_config_init(&w, sizeof w)) goto done;
  if (snprintf(settings, sizeof settings, "hand=%s\narm=%s", hand.name, argc > 2 ? argv[2] : "ur5e") >=
      (int)sizeof settings) {
    fprintf(stderr, "08_own_robot: the names are too long\n");
    rdm_import_destroy(import);
    return 1;
  }
  w.task = "grasp", w.num_envs = 64, w.settings = settings;
  if (rdm_pool_create(&pool, &w) || rdm_pool_reset(pool, NULL, NULL)) goto done;
  if (rdm_agent_config_init(&l, sizeof l) || rdm_agent_config_for_pool(&l, pool)) goto done;
  if (rdm_agent_create(&agent, &l)) goto done;
  for (int i = 0; i < epochs; ++i) {
    if (rdm_agent_rollout(agent, pool, &e)) goto done;
    if ((i + 1) % 5 == 0)
      printf("epoch %3d: return %7.2f, cost %5.2f (limit %g), lifted in %3.0f%%\n", i + 1, e.ret, e.cost[0],
             l.cost_limits[0], 100 * e.success_rate);
  }
  status = 0;
done:
  if (status) fprintf(stderr, "08_own_robot: %s\n", rdm_last_error());
  rdm_agent_destroy(agent);
  rdm_pool_destroy(pool); /* the robot stays in the list as long as the program */
  rdm_import_destroy(import);
  return status;
}
