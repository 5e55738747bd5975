/* 10: a policy that sees through a sensor of your own.
 *
 *   10_own_eyes [demonstrations [scenes]]
 *
 * The machine: a fingertip above a table, which shall touch a ball and not the bottle that stands somewhere.
 * Where they are, a depth camera alone can tell; its rays, the machine and the frame of the points are this
 * program's, and there is no pool. Who knows the scene demonstrates, a policy that sees points clones that,
 * and closes the loop: with its eyes open, and with the lens covered. */
#define RDM_EXPERIMENTAL
#include <math.h>
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>

enum { POINTS = 64, WIDE = 48, HIGH = 36, LENGTH = 60 };
static const float ball_radius = 0.03f, bottle_radius = 0.035f, bottle_height = 0.18f, finger_radius = 0.01f;

typedef struct scene { /* m, in the machine's frame: x to the right, y away, z up from the table */
  float ball[2], bottle[2], finger[2];
} scene;

static uint32_t drawn = 1;
static float draw(float low, float high) {
  drawn = drawn * 1664525u + 1013904223u;
  return low + (high - low) * (float)(drawn >> 8) / 16777216.0f;
}
static float distance(const float* a, const float* b) {
  return hypotf(a[0] - b[0], a[1] - b[1]);
}

static scene draw_scene(void) {
  scene s;
  do {
    s.finger[0] = draw(-0.25f, 0.25f), s.finger[1] = draw(-0.25f, -0.2f);
    s.ball[0] = draw(-0.2f, 0.2f), s.ball[1] = draw(0, 0.2f);
    s.bottle[0] = draw(-0.2f, 0.2f), s.bottle[1] = draw(-0.1f, 0.2f);
  } while (distance(s.ball, s.bottle) < 0.1f);
  return s;
}

/* ---- the sensor ------------------------------------------------------------------------------------------
 */
/* How far along the ray from `eye` the ball (what 0) or the bottle (1) is met; a large number: not at all. */
static float meet(const scene* s, int what, const float* eye, const float* ray) {
  const float* at = what ? s->bottle : s->ball;
  const float radius = what ? bottle_radius : ball_radius;
  const float x = eye[0] - at[0], y = eye[1] - at[1], z = what ? 0 : eye[2] - ball_radius,
              w = what ? 0 : ray[2];
  const float a = ray[0] * ray[0] + ray[1] * ray[1] + w * w, b = x * ray[0] + y * ray[1] + z * w;
  const float root = b * b - a * (x * x + y * y + z * z - radius * radius);
  if (root > 0 && a > 0) {
    const float t = (-b - sqrtf(root)) / a, height = eye[2] + t * ray[2];
    if (t > 0 && height > 0 && (!what || height < bottle_height)) return t;
  }
  if (what) { /* its lid */
    const float t = (bottle_height - eye[2]) / ray[2];
    if (hypotf(x + t * ray[0], y + t * ray[1]) < radius) return t;
  }
  return 1e9f;
}

/* POINTS points [POINTS][3] and on what they lie: 0 ball, 1 bottle. Every 2 mm of noise is the camera's own.
 */
static void look(const scene* s, float* points, uint8_t* kind) {
  static float seen[WIDE * HIGH][3];
  static uint8_t what[WIDE * HIGH];
  const float eye[3] = {0, -0.6f, 0.7f}; /* it looks half down */
  int count = 0;
  for (int i = 0; i < WIDE * HIGH; ++i) {
    const float u = 0.8f * ((float)(i % WIDE) / (WIDE - 1) - 0.5f),
                v = 0.7f * ((float)(i / WIDE) / (HIGH - 1) - 0.5f);
    const float ray[3] = {u, 0.7071f * (1 + v), -0.7071f * (1 - v)};
    const float t[2] = {meet(s, 0, eye, ray), meet(s, 1, eye, ray)};
    const int nearest = t[1] < t[0];
    if (t[nearest] > 1e8f) continue;
    for (int k = 0; k < 3; ++k) seen[count][k] = eye[k] + t[nearest] * ray[k] + draw(-0.002f, 0.002f);
    what[count++] = (uint8_t)nearest;
  }
  for (int i = 0; i < POINTS;
       ++i) { /* evenly out of all; where there are fewer some come twice, as they may */
    const int from = count ? (count > POINTS ? i * count / POINTS : i % count) : 0;
    for (int k = 0; k < 3; ++k) points[3 * i + k] = count ? seen[from][k] : eye[k];
    kind[i] = count ? what[from] : 0;
  }
}

/* ---- the machine -----------------------------------------------------------------------------------------
 */
/* One step of 50 ms at up to 0.4 m/s. Returns 1 once the ball is touched. */
static int move(scene* s, const float* action, int* hits) {
  for (int k = 0; k < 2; ++k) s->finger[k] += 0.02f * fminf(1.0f, fmaxf(-1.0f, action[k]));
  *hits += distance(s->finger, s->bottle) < bottle_radius + finger_radius;
  return distance(s->finger, s->ball) < ball_radius + finger_radius;
}

/* Who knows where things are: straight to the ball, pushed aside by the bottle. */
static void demonstrate(const scene* s, float* action) {
  const float to[2] = {s->ball[0] - s->finger[0], s->ball[1] - s->finger[1]};
  const float off[2] = {s->finger[0] - s->bottle[0], s->finger[1] - s->bottle[1]};
  const float far = hypotf(to[0], to[1]) + 1e-6f, gap = hypotf(off[0], off[1]) + 1e-6f;
  const float side = to[0] * off[1] - to[1] * off[0] > 0 ? 1.0f : -1.0f; /* on which the bottle is passed */
  const float push = fmaxf(0, fminf(1.5f, (0.125f - gap) / 0.04f));
  const float ahead = to[0] * off[0] + to[1] * off[1] < 0 ? 1.0f : 0.0f;
  for (int k = 0; k < 2; ++k) {
    const float turn = k ? side * to[0] : -side * to[1];
    action[k] = to[k] / far + push * (off[k] / gap + ahead * turn / far);
  }
  const float size = fmaxf(1.0f, hypotf(action[0], action[1]));
  for (int k = 0; k < 2; ++k) action[k] /= size;
}

/* ---- learning and acting ---------------------------------------------------------------------------------
 */
static int append(rdm_recording* r, int scenes) {
  for (int e = 0; e < scenes; ++e) {
    scene s = draw_scene();
    for (int step = 0, hits = 0, done = 0; step < LENGTH && !done; ++step) {
      float points[3 * POINTS], label[2], action[2];
      int16_t mm[3 * POINTS];
      uint8_t kind[POINTS], touched, cut;
      rdm_recording_rows rows = {.struct_size = sizeof rows};
      const scene before = s;
      look(&s, points, kind);
      for (int i = 0; i < 3 * POINTS; ++i) mm[i] = (int16_t)lrintf(1000 * points[i]);
      demonstrate(&s, label);
      for (int k = 0; k < 2; ++k)
        action[k] = label[k] + draw(-0.6f, 0.6f); /* to see what is beside its path, too */
      done = move(&s, action, &hits);
      touched = (uint8_t)(done != 0);
      cut = (uint8_t)(!done && step == LENGTH - 1);
      rows.rows = 1;
      rows.obs = before.finger;
      rows.action = action; /* what was done; the label is what the teacher meant */
      rows.label = label;
      rows.terminated = &touched;
      rows.truncated = &cut;
      rows.points = mm;
      rows.point_class = kind;
      if (rdm_recording_append(r, &rows)) return 1;
    }
  }
  return 0;
}

/* Plays scenes and says how they went; policy NULL: the demonstration. -1 on failure, else balls touched. */
static int play(const char* who, const rdm_policy* policy, int covered, int scenes, void* scratch,
                size_t size) {
  int touched = 0, bad = 0;
  drawn = 7;
  for (int e = 0; e < scenes; ++e) {
    scene s = draw_scene();
    const uint32_t next = drawn;
    int hits = 0, done = 0;
    for (int step = 0; step < LENGTH && !done; ++step) {
      float points[3 * POINTS] = {0}, action[2];
      uint8_t kind[POINTS] = {0};
      rdm_points seen = {
          .struct_size = sizeof seen, .num_points = POINTS, .points = points, .point_class = kind};
      if (!covered) look(&s, points, kind);
      if (!policy)
        demonstrate(&s, action);
      else if (rdm_policy_act_points(policy, s.finger, &seen, 1, NULL, action, scratch, size))
        return -1;
      done = move(&s, action, &hits);
    }
    touched += done;
    bad += hits > 0;
    drawn = next; /* the same scenes for all */
  }
  printf("%-14s ball touched in %3d of %d scenes, bottle in %3d\n", who, touched, scenes, bad);
  return touched;
}

int main(int argc, char** argv) {
  const int demonstrations = argc > 1 ? atoi(argv[1]) : 600, scenes = argc > 2 ? atoi(argv[2]) : 200;
  rdm_agent_config config;
  rdm_recording_config rows;
  rdm_clone_config how;
  rdm_clone_report report = {.struct_size = sizeof report};
  rdm_agent* agent = NULL;
  rdm_recording* recording = NULL;
  rdm_policy* policy = NULL;
  void *bytes = NULL, *scratch = NULL;
  size_t size = 0;
  int status = 1;

  if (rdm_recording_config_init(&rows, sizeof rows)) goto done;
  rows.obs_dim = rows.action_dim = 2;
  rows.num_points = POINTS;
  if (rdm_recording_create(&recording, &rows) || append(recording, demonstrations)) goto done;

  if (rdm_agent_config_init(&config, sizeof config)) goto done;
  config.obs_dim = config.action_dim = 2;
  config.num_envs = 1;
  config.settings = "encoder=32,64\nencoder_points=64\nencoder_classes=2\nhidden=64,64\nminibatches=1";
  if (rdm_agent_create(&agent, &config) || rdm_clone_config_init(&how, sizeof how)) goto done;
  how.batch_rows = 64;
  how.epochs = 60;
  how.learning_rate = 3e-3;
  if (rdm_agent_clone(agent, recording, &how, &report)) goto done;
  printf("learned from %lld decisions: mean squared error %.4f, of others %.4f\n",
         (long long)report.train_rows, report.train_loss, report.validation_loss);

  /* What a robot's controller has: the policy, and memory for its calls. */
  if (rdm_agent_write_policy(agent, NULL, 0, &size) || !(bytes = malloc(size))) goto done;
  if (rdm_agent_write_policy(agent, bytes, size, &size) || rdm_policy_read(&policy, bytes, size)) goto done;
  const size_t scratch_size = rdm_policy_scratch(policy, 1);
  if (!(scratch = malloc(scratch_size))) goto done;
  play("demonstration:", NULL, 0, scenes, NULL, 0);
  const int open = play("eyes open:", policy, 0, scenes, scratch, scratch_size);
  const int closed = play("eyes closed:", policy, 1, scenes, scratch, scratch_size);
  if (open < 0 || closed < 0) goto done;
  status = 0;
done:
  if (status) fprintf(stderr, "10_own_eyes: %s\n", rdm_last_error());
  free(scratch);
  free(bytes);
  rdm_policy_destroy(policy);
  rdm_agent_destroy(agent);
  rdm_recording_destroy(recording);
  return status;
}
