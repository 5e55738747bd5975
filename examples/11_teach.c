/* 11: a teacher of your own, and a student that is taught where it goes itself (DAgger).
 *
 *   11_teach [a policy of ant_run] [rounds] [decisions of a round] [file of the student's policy]
 *   redman train --task ant_reach --from FILE --algo ppo_lag ...
 *
 * The teacher is the policy of another task: ant_run's walks along x. An ant looks the same from its four
 * sides, so seen from a frame whose x points where it shall go, with the legs counted from the one that is
 * first there, it walks anywhere: to one goal of ant_reach after the other, around what lies in the way. It
 * acts in all worlds in the first round and then in a quarter of them, says everywhere what it would do, and
 * after each round the student clones that. */
#define RDM_EXPERIMENTAL
#include <math.h>
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORLDS = 32, LEGS = 4, SECTORS = 24, RUN_OBS = 33, REACH_OBS = 83, ACTIONS = 2 * LEGS };
/* where a row of ant_reach, and for the first 33 numbers of ant_run, has what: `redman tasks --json` */
enum {
  POSITION = 0,
  VELOCITY = 3,
  ROTATION = 6,
  SPIN = 10,
  JOINTS = 13,
  FEET = 29,
  OBSTACLES = 57,
  GOAL = 81
};
static const float pi = 3.14159265f;
static const float sight = 5, berth = 2.8f, edge = 1.7f; /* m */
static const float noise = 0.05f;                        /* deviation of an action */
static const float bent[LEGS] = {1, -1, -1, 1};          /* the side of an ankle */

static uint32_t drawn = 1;
static float draw(void) { /* about normal, deviation 1 */
  float sum = 0;
  for (int i = 0; i < 12; ++i) {
    drawn = drawn * 1664525u + 1013904223u;
    sum += (float)(drawn >> 8) / 16777216.0f;
  }
  return sum - 6;
}

/* Where to go, rad in the world: as near to the goal's direction as leaves `berth` m to what lies on the way.
 */
static float choose_way(const float* obs) {
  const float gx = 20 * obs[GOAL], gy = 20 * obs[GOAL + 1], far = hypotf(gx, gy);
  for (int i = 0; i <= 72; ++i) { /* 0, 5, -5, 10, -10 ... 180 degrees off */
    const float way = atan2f(gy, gx) + (i % 2 ? 1.0f : -1.0f) * (float)((i + 1) / 2) * pi / 36;
    int blocked = 0;
    for (int k = 0; k < SECTORS && !blocked; ++k) { /* from y to x, 15 degrees each: 1 - distance / sight */
      const float off = way - (pi / 2 - 2 * pi * ((float)k + 0.5f) / SECTORS);
      const float d = sight * (1 - obs[OBSTACLES + k]), ahead = d * cosf(off), beside = d * fabsf(sinf(off));
      const int inside = d < edge && ahead > -0.7f * d; /* and does not lead out */
      blocked = obs[OBSTACLES + k] > 0 &&
                (inside || (ahead > 0 && ahead < far + 0.5f && beside < fminf(berth, 0.98f * d)));
    }
    if (!blocked) return way;
  }
  return atan2f(gy, gx);
}

/* q = a turn by `angle` about z, times q; or q times it. */
static void turn_before(float angle, float* q) {
  const float s = sinf(angle / 2), c = cosf(angle / 2), x = q[0], y = q[1];
  q[0] = c * x - s * y, q[1] = c * y + s * x;
  const float z = q[2];
  q[2] = c * z + s * q[3], q[3] = c * q[3] - s * z;
}
static void turn_after(float angle, float* q) {
  const float s = sinf(angle / 2), c = cosf(angle / 2), x = q[0], y = q[1];
  q[0] = c * x + s * y, q[1] = c * y - s * x;
  const float z = q[2];
  q[2] = c * z + s * q[3], q[3] = c * q[3] - s * z;
}

/* The row of ant_run that the ant of ant_reach makes, for someone who looks along `way`; the leg that is
 * first there. */
static int see_from(float way, const float* obs, float* run) {
  float* q = run + ROTATION;
  memcpy(run, obs, RUN_OBS * sizeof *run);
  const float yaw = atan2f(2 * (q[3] * q[2] + q[0] * q[1]), 1 - 2 * (q[1] * q[1] + q[2] * q[2]));
  const int quarters = (int)lroundf((way - yaw) / (pi / 2)), first = (quarters % LEGS + LEGS) % LEGS;
  run[POSITION] = 0.5f, run[POSITION + 1] = 0; /* 5 m down the middle of its lane */
  for (int part = VELOCITY; part <= SPIN; part += SPIN - VELOCITY) {
    run[part] = cosf(way) * obs[part] + sinf(way) * obs[part + 1];
    run[part + 1] = cosf(way) * obs[part + 1] - sinf(way) * obs[part];
  }
  turn_before(-way, q);
  turn_after((float)quarters * pi / 2, q);
  if (q[3] < 0)
    for (int i = 0; i < 4; ++i) q[i] = -q[i];
  for (int leg = 0; leg < LEGS; ++leg) {
    const int from = (leg + first) % LEGS;
    const float same = bent[leg] * bent[from]; /* an ankle's angle counts to the other side, or not */
    for (int i = 0; i < 4; ++i) run[JOINTS + 4 * leg + i] = (i < 2 ? 1 : same) * obs[JOINTS + 4 * from + i];
    run[FEET + leg] = obs[FEET + from];
  }
  return first;
}

/* What the teacher would do in each world: label [WORLDS][ACTIONS]. */
static rdm_result teach(const rdm_policy* walker, const float* obs, float* label, void* scratch,
                        size_t bytes) {
  for (int w = 0; w < WORLDS; ++w, obs += REACH_OBS, label += ACTIONS) {
    float run[RUN_OBS], act[ACTIONS];
    const int first = see_from(choose_way(obs), obs, run);
    const rdm_result result = rdm_policy_act(walker, run, 1, NULL, act, scratch, bytes);
    if (result) return result;
    for (int leg = 0; leg < LEGS; ++leg) {
      const int to = (leg + first) % LEGS;
      label[2 * to] = act[2 * leg];
      label[2 * to + 1] = bent[leg] * bent[to] * act[2 * leg + 1];
    }
  }
  return RDM_OK;
}

/* Of the worlds below `teachers`, or of the others: episodes that ended in a round. */
typedef struct tally {
  int episodes, falls;
  double earned, spent;
} tally;
static void print_tally(const char* who, const tally* t) {
  if (t->episodes)
    printf("  %s %6.2f @ %5.1f, %3.0f %% fall", who, t->earned / t->episodes, t->spent / t->episodes,
           100.0 * t->falls / t->episodes);
}

int main(int argc, char** argv) {
  const char* path = argc > 1 ? argv[1] : "examples/policies/ant_run.rdm";
  const int rounds = argc > 2 ? atoi(argv[2]) : 10, decisions = argc > 3 ? atoi(argv[3]) : 1000;
  rdm_policy* walker = NULL;
  rdm_policy_info info = {.struct_size = sizeof info};
  rdm_pool_config config;
  rdm_pool* pool = NULL;
  rdm_spec spec = {.struct_size = sizeof spec};
  rdm_buffers b = {.struct_size = sizeof b};
  rdm_recording_config kept;
  rdm_recording* rows = NULL;
  rdm_agent_config student;
  rdm_agent* agent = NULL;
  rdm_clone_config how;
  rdm_clone_report report = {.struct_size = sizeof report};
  void* scratch = NULL;
  static float label[WORLDS * ACTIONS], own[WORLDS * ACTIONS];
  int failed = 1;

  if (rdm_pool_config_init(&config, sizeof config) || rdm_recording_config_init(&kept, sizeof kept) ||
      rdm_agent_config_init(&student, sizeof student) || rdm_clone_config_init(&how, sizeof how))
    goto end;
  config.task = "ant_reach";
  config.num_envs = WORLDS;
  if (rdm_policy_read_file(&walker, path) || rdm_policy_get_info(walker, &info) ||
      rdm_pool_create(&pool, &config) || rdm_pool_get_spec(pool, &spec) || rdm_pool_get_buffers(pool, &b) ||
      rdm_recording_config_for_pool(&kept, pool) || rdm_recording_create(&rows, &kept) ||
      rdm_agent_config_for_pool(&student, pool))
    goto end;
  student.settings = "hidden=256,128";
  if (rdm_agent_create(&agent, &student)) goto end;
  if (info.obs_dim != RUN_OBS || info.action_dim != ACTIONS) {
    fprintf(stderr, "11_teach: %s is no policy of ant_run\n", path);
    goto done;
  }
  const size_t scratch_bytes = rdm_policy_scratch(walker, 1);
  scratch = malloc(scratch_bytes);
  if (!scratch) {
    fprintf(stderr, "11_teach: out of memory\n");
    goto done;
  }
  if (rdm_pool_reset(pool, NULL, NULL)) goto end;
  for (int round = 0; round < rounds; ++round) {
    const int teachers = round ? WORLDS / 4 : WORLDS;
    tally by[2] = {{0, 0, 0, 0}, {0, 0, 0, 0}};
    for (int t = 0; t < decisions; ++t) {
      if (teach(walker, b.obs, label, scratch, scratch_bytes) ||
          rdm_agent_act(agent, b.obs, RDM_ACT_MEAN, own))
        goto end;
      for (int i = 0; i < WORLDS * ACTIONS; ++i)
        b.action[i] = (i < teachers * ACTIONS ? label : own)[i] + noise * draw();
      if (rdm_recording_begin_step(rows, pool, label, NULL) || rdm_pool_step(pool) ||
          rdm_recording_end_step(rows, pool, NULL))
        goto end;
      for (int w = 0; w < WORLDS; ++w) {
        tally* of = &by[w >= teachers];
        if (!b.terminated[w] && !b.truncated[w]) continue;
        of->earned += (double)b.episode_return[w];
        of->spent += (double)b.episode_cost[w * spec.cost_dim];
        of->falls += b.terminated[w];
        ++of->episodes;
      }
    }
    how.epochs = round + 1 < rounds ? 3 : 15;
    how.feed_normalizer = round == 0;
    if (rdm_agent_clone(agent, rows, &how, &report)) goto end;
    printf("round %2d: error %.4f, of others %.4f;", round + 1, report.train_loss, report.validation_loss);
    print_tally("teacher", &by[0]);
    print_tally("student", &by[1]);
    printf("\n");
    fflush(stdout);
  }
  if (argc > 4 && rdm_agent_write_policy_file(agent, argv[4])) {
    fprintf(stderr, "11_teach: cannot write %s\n", argv[4]);
    goto done;
  }
  failed = 0;
end:
  if (failed) fprintf(stderr, "11_teach: %s\n", rdm_last_error());
done:
  free(scratch);
  rdm_agent_destroy(agent);
  rdm_recording_destroy(rows);
  rdm_pool_destroy(pool);
  rdm_policy_destroy(walker);
  return failed;
}
