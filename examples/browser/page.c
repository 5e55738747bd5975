/* page.c: what the page and its worker call, over redman.h alone: a world to look at, an agent that learns,
 * and loops to time. Texts are JSON; a call that fails gives a negative number or NULL, and page_error says
 * why. */
#define RDM_EXPERIMENTAL
#include <emscripten.h>
#include <math.h>
#include <redman/memory.h>
#include <redman/redman.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT EMSCRIPTEN_KEEPALIVE
enum { kWorlds = 4, kContacts = 128, kContactNumbers = 6 };
enum actor { kZero, kPolicy, kGiven, kRandom };

/* ---- text ---- */
static char* text;
static size_t text_size, text_capacity;

static void put(const char* format, ...) {
  for (;;) {
    va_list list;
    va_start(list, format);
    const int n = vsnprintf(text + text_size, text_capacity - text_size, format, list);
    va_end(list);
    if (n >= 0 && (size_t)n < text_capacity - text_size) {
      text_size += (size_t)n;
      return;
    }
    char* more = realloc(text, 2 * text_capacity + 4096);
    if (!more) abort();
    text = more;
    text_capacity = 2 * text_capacity + 4096;
  }
}
static void begin(void) {
  text_size = 0;
  put("%s", "");
}
/* Strings of the library are one line of UTF-8 without control characters. */
static void put_string(const char* s) {
  put("%s", "\"");
  for (; *s; ++s) put(*s == '"' || *s == '\\' ? "\\%c" : "%c", *s);
  put("%s", "\"");
}
static void put_member(const char* key, const char* value) {
  put("\"%s\":", key);
  put_string(value);
}
/* Entry i of a list. */
static void put_named(int i, const char* name, const char* summary) {
  put("%s", i ? ",{" : "{");
  put_member("name", name);
  put("%s", ",");
  put_member("summary", summary);
  put("%s", "}");
}
static void put_floats(const char* key, const float* v, int count) {
  put("\"%s\":[", key);
  for (int i = 0; i < count; ++i) put(i ? ",%.9g" : "%.9g", (double)v[i]);
  put("%s", "]");
}

EXPORT const char* page_error(void) {
  return rdm_last_error();
}

/* What the library is, and what it has. */
EXPORT const char* page_about(void) {
  rdm_build build = {.struct_size = sizeof build};
  if (rdm_build_info(&build)) return NULL;
  begin();
  put("%s", "{");
  put_member("version", build.version);
  put("%s", ",");
  put_member("compiler", build.compiler);
  put("%s", ",");
  put_member("differs", build.differs);
  put("%s", ",\"tasks\":[");
  for (int i = 0; i < rdm_task_count(); ++i) {
    rdm_task task = {.struct_size = sizeof task};
    if (rdm_task_at(i, &task)) return NULL;
    put_named(i, task.name, task.summary);
  }
  put("%s", "],\"algos\":[");
  for (int i = 0; i < rdm_algo_count(); ++i) {
    rdm_algo algo = {.struct_size = sizeof algo};
    if (rdm_algo_at(i, &algo)) return NULL;
    put_named(i, algo.name, algo.summary);
  }
  put("%s", "]}");
  return text;
}

/* ---- the world on the page ---- */
static rdm_pool* pool;
static rdm_spec spec;
static rdm_buffers rows;
static rdm_policy* policy;
static rdm_policy_info policy_info;
static void* scratch;
static size_t scratch_size;
static float *poses, *held;
static float* memory; /* of the policy, of the episode that runs */
static rdm_pose* placed;
static double numbers[6 + 3 * RDM_MAX_COSTS];
static float touches[kContacts * kContactNumbers];
static int decision_age;

static void begin_episode(void) {
  decision_age = 0;
  if (policy) memset(memory, 0, (size_t)policy_info.state_dim * sizeof(float));
}
static rdm_result act(void) {
  return rdm_policy_act_state(policy, rows.obs, memory, 1, NULL, held, scratch, scratch_size);
}

static rdm_pool* make_pool(const char* task, int worlds, double seed, const char* settings) {
  rdm_pool_config config;
  rdm_pool* made = NULL;
  if (rdm_pool_config_init(&config, sizeof config)) return NULL;
  config.task = task;
  config.num_envs = worlds;
  config.seed = (uint64_t)seed;
  config.settings = settings;
  return rdm_pool_create(&made, &config) ? NULL : made;
}

/* A new world in the place of the old one, which stays when the call fails. */
EXPORT int page_open(const char* task, double seed, const char* settings) {
  rdm_pool* made = make_pool(task, 1, seed, settings);
  if (!made) return -1;
  rdm_pool_destroy(pool);
  rdm_policy_destroy(policy);
  policy = NULL;
  pool = made;
  spec = (rdm_spec){.struct_size = sizeof spec};
  rows = (rdm_buffers){.struct_size = sizeof rows};
  if (rdm_pool_get_spec(pool, &spec) || rdm_pool_get_buffers(pool, &rows) || rdm_pool_reset(pool, NULL, NULL))
    return -1;
  free(poses);
  free(placed);
  free(held);
  poses = calloc((size_t)spec.num_shapes * 7 + 1, sizeof *poses);
  placed = calloc((size_t)spec.num_shapes + 1, sizeof *placed);
  held = calloc((size_t)spec.action_dim, sizeof *held);
  begin_episode();
  return poses && placed && held ? 0 : -1;
}

/* The episode that this seed begins. */
EXPORT int page_reset(double seed) {
  const uint64_t s = (uint64_t)seed;
  begin_episode();
  return rdm_pool_reset(pool, &s, NULL) ? -1 : 0;
}

/* Of the episode that runs: a limit of option limit_range. */
EXPORT int page_limit(double limit) {
  return rdm_pool_set_limit(pool, -1, limit) ? -1 : 0;
}

/* Shapes, costs and cameras of the world. */
EXPORT const char* page_scene(void) {
  rdm_task task = {.struct_size = sizeof task};
  if (!pool || rdm_task_at(spec.task, &task)) return NULL;
  begin();
  put("{\"dt\":%.9g,\"steps\":%d,\"obs\":%d,\"actions\":%d,", (double)spec.control_dt, spec.max_steps,
      spec.obs_dim, spec.action_dim);
  put_member("task", task.name);
  put("%s", ",");
  put_member("summary", task.summary);
  put("%s", ",\"shapes\":[");
  for (int i = 0; i < spec.num_shapes; ++i) {
    rdm_shape_info shape = RDM_INIT(rdm_shape_info);
    if (rdm_pool_shape_at(pool, i, &shape)) return NULL;
    put("%s", i ? ",{" : "{");
    put_member("name", shape.name);
    put(",\"kind\":%d,\"fixed\":%d,\"color\":[%d,%d,%d],", shape.kind, shape.fixed, shape.color[0],
        shape.color[1], shape.color[2]);
    float size[3];
    for (int k = 0; k < 3; ++k) size[k] = (float)shape.size[k];
    put_floats("size", size, 3);
    put("%s", "}");
  }
  put("%s", "],\"costs\":[");
  for (int i = 0; i < spec.cost_dim; ++i) {
    rdm_cost_info cost = RDM_INIT(rdm_cost_info);
    if (rdm_task_cost_at(spec.task, i, &cost)) return NULL;
    put("%s", i ? ",{" : "{");
    put_member("name", cost.name);
    put("%s", ",");
    put_member("help", cost.help);
    put(",\"limit\":%.9g}", cost.limit);
  }
  put("%s", "],\"cameras\":[");
  for (int i = 0, shown = 0; i < task.num_cameras; ++i) {
    rdm_camera_info camera = RDM_INIT(rdm_camera_info);
    if (rdm_task_camera_at(spec.task, i, &camera)) return NULL;
    if (camera.mount) continue;
    put("%s", shown++ ? ",{" : "{");
    put_member("name", camera.name);
    put(",\"fov_y\":%.9g,", (double)camera.fov_y);
    put_floats("eye", camera.eye, 3);
    put("%s", ",");
    put_floats("target", camera.target, 3);
    put("%s", "}");
  }
  put("%s", "]}");
  return text;
}

/* The policy that acts as kPolicy from now on. */
EXPORT int page_policy(const void* bytes, int size) {
  rdm_policy* read = NULL;
  if (rdm_policy_read(&read, bytes, (size_t)size)) return -1;
  if (rdm_policy_check(read, &spec)) {
    rdm_policy_destroy(read);
    return -1;
  }
  rdm_policy_destroy(policy);
  policy = read;
  policy_info = (rdm_policy_info){.struct_size = sizeof policy_info};
  rdm_policy_get_info(policy, &policy_info);
  scratch_size = rdm_policy_scratch(policy, 1);
  free(scratch);
  free(memory);
  scratch = malloc(scratch_size);
  memory = malloc(((size_t)policy_info.state_dim + 1) * sizeof(float));
  if (!scratch || !memory) return -1;
  begin_episode();
  return 0;
}

/* One control step; the actor is one of `enum actor`, `given` [actions] what kGiven does. Afterwards
 * page_numbers has reward, return, step, terminated, truncated, success, then cost, episode cost and raw cost
 * of each column. */
EXPORT int page_step(int actor, const float* given) {
  const size_t bytes = (size_t)spec.action_dim * sizeof(float);
  if (actor == kPolicy && !policy) return -1;
  if (actor == kPolicy) {
    const int repeat = policy_info.action_repeat > 1 ? policy_info.action_repeat : 1;
    if (decision_age++ % repeat == 0) {
      if (act()) return -1;
    }
    memcpy(rows.action, held, bytes);
  } else if (actor == kGiven) {
    memcpy(rows.action, given, bytes);
  } else if (rdm_pool_baseline(pool, actor == kRandom ? RDM_BASELINE_RANDOM : RDM_BASELINE_ZERO)) {
    return -1;
  }
  if (rdm_pool_step(pool)) return -1;
  const double head[] = {rows.reward[0],     rows.episode_return[0], rows.episode_step[0],
                         rows.terminated[0], rows.truncated[0],      rows.success[0]};
  memcpy(numbers, head, sizeof head);
  for (int k = 0; k < spec.cost_dim; ++k) {
    numbers[6 + k] = rows.cost[k];
    numbers[6 + spec.cost_dim + k] = rows.episode_cost[k];
    numbers[6 + 2 * spec.cost_dim + k] = rows.cost_raw[k];
  }
  if (rows.terminated[0] || rows.truncated[0]) begin_episode();
  return 0;
}
EXPORT const double* page_numbers(void) {
  return numbers;
}

/* [shapes][7], as rdm_pool_get_poses, in float. */
EXPORT const float* page_poses(void) {
  if (rdm_pool_get_poses(pool, 0, placed)) return NULL;
  for (int i = 0; i < spec.num_shapes; ++i) {
    for (int k = 0; k < 3; ++k) poses[7 * i + k] = (float)placed[i].p[k];
    for (int k = 0; k < 4; ++k) poses[7 * i + 3 + k] = (float)placed[i].q[k];
  }
  return poses;
}

/* How many contact points there are; page_touches has position (m) and force (N) of each. */
EXPORT int page_contacts(void) {
  static rdm_contact found[kContacts];
  size_t count = 0;
  if (rdm_pool_get_contacts(pool, 0, found, kContacts, &count)) return -1;
  if (count > kContacts) count = kContacts;
  for (size_t i = 0; i < count; ++i) {
    memcpy(&touches[i * kContactNumbers], found[i].position, sizeof found[i].position);
    memcpy(&touches[i * kContactNumbers + 3], found[i].force, sizeof found[i].force);
  }
  return (int)count;
}
EXPORT const float* page_touches(void) {
  return touches;
}

/* N, world axes, during the next step. */
EXPORT int page_push(int shape, double x, double y, double z) {
  const float force[3] = {(float)x, (float)y, (float)z};
  return rdm_pool_push(pool, 0, shape, force) ? -1 : 0;
}

/* ---- an agent that learns ---- */
static rdm_pool* class_pool;
static rdm_agent* agent;
static rdm_epoch epoch;
static void* learned;

EXPORT int page_learn(const char* task, const char* algo, int worlds, double pool_seed, double seed,
                      const char* settings, const char* world_settings) {
  rdm_agent_config config;
  rdm_agent_destroy(agent);
  rdm_pool_destroy(class_pool);
  agent = NULL;
  class_pool = make_pool(task, worlds, pool_seed, world_settings);
  if (!class_pool || rdm_pool_reset(class_pool, NULL, NULL)) return -1;
  if (rdm_agent_config_init(&config, sizeof config) || rdm_agent_config_for_pool(&config, class_pool))
    return -1;
  config.algo = algo;
  config.seed = (uint64_t)seed;
  config.settings = settings;
  return rdm_agent_create(&agent, &config) ? -1 : 0;
}

/* One epoch, as JSON. */
EXPORT const char* page_epoch(void) {
  epoch = (rdm_epoch){.struct_size = sizeof epoch};
  if (rdm_agent_rollout(agent, class_pool, &epoch)) return NULL;
  begin();
  put("{\"epoch\":%d,\"steps\":%.17g,\"episodes\":%.17g,\"ret\":%.9g,\"length\":%.9g,\"success\":%.9g,"
      "\"cost\":[",
      epoch.epoch, (double)epoch.env_steps, (double)epoch.episodes, epoch.ret, epoch.length,
      epoch.success_rate);
  rdm_spec its = {.struct_size = sizeof its};
  rdm_pool_get_spec(class_pool, &its);
  for (int k = 0; k < its.cost_dim; ++k) put(k ? ",%.9g" : "%.9g", epoch.cost[k]);
  put("],\"multiplier\":%.9g}", epoch.multiplier[0]);
  return text;
}

/* The policy as it is now: its size in bytes, behind page_learned. */
EXPORT int page_freeze(void) {
  size_t size = 0;
  if (rdm_agent_write_policy(agent, NULL, 0, &size)) return -1;
  free(learned);
  learned = malloc(size);
  if (!learned || rdm_agent_write_policy(agent, learned, size, &size)) return -1;
  return (int)size;
}
EXPORT const void* page_learned(void) {
  return learned;
}

/* ---- proof and speed ---- */
static const uint64_t kHashSeed = 14695981039346656037u; /* FNV-1a */
static const char* put_hash(uint64_t hash) {
  begin();
  put("%08x%08x", (unsigned)(hash >> 32), (unsigned)hash);
  return text;
}
static uint64_t join(const void* data, size_t size, uint64_t hash) {
  const unsigned char* p = data;
  for (size_t i = 0; i < size; ++i) hash = (hash ^ p[i]) * 1099511628211u;
  return hash;
}

/* The hash of a line of tests/golden/tasks.txt: 200 steps of random actions in four worlds. */
EXPORT const char* page_hash(const char* task, const char* engine) {
  char settings[40];
  snprintf(settings, sizeof settings, "%s%s", strcmp(engine, "-") ? "engine=" : "",
           strcmp(engine, "-") ? engine : "");
  rdm_pool* p = make_pool(task, kWorlds, 7, settings);
  rdm_spec s = {.struct_size = sizeof s};
  rdm_buffers b = {.struct_size = sizeof b};
  uint64_t hash = kHashSeed, state = 0;
  int good = p && !rdm_pool_get_spec(p, &s) && !rdm_pool_get_buffers(p, &b) && !rdm_pool_reset(p, NULL, NULL);
  for (int step = 0; good && step < 200; ++step) {
    good = !rdm_pool_baseline(p, RDM_BASELINE_RANDOM) && !rdm_pool_step(p);
    hash = join(b.obs, sizeof(float) * kWorlds * (size_t)s.obs_dim, hash);
    hash = join(b.reward, sizeof(float) * kWorlds, hash);
    hash = join(b.cost, sizeof(float) * kWorlds * (size_t)s.cost_dim, hash);
  }
  good = good && !rdm_pool_get_hash(p, -1, &state);
  rdm_pool_destroy(p);
  return good ? put_hash(join(&state, sizeof state, hash)) : NULL;
}

/* Algorithms with a replay memory have other options: both lists are those of tests/algos/test_golden_learners.cpp. */
static int has_replay(const char* name) {
  rdm_algo algo = RDM_INIT(rdm_algo);
  rdm_option_spec option = RDM_INIT(rdm_option_spec);
  int32_t index = 0;
  if (rdm_algo_find(name, &index) || rdm_algo_at(index, &algo)) return 0;
  for (int32_t i = 0; i < algo.num_options; ++i)
    if (!rdm_algo_option_at(index, i, &option) && !strcmp(option.key, "replay_rows")) return 1;
  return 0;
}
/* The hash of a line of tests/golden/learners.txt: an agent after three epochs. */
EXPORT const char* page_learner_hash(const char* algo, const char* task) {
  const char* settings = has_replay(algo) ? "hidden=32,16\nhorizon=24\nreplay_rows=900\nbatch_rows=300\n"
                                            "start_steps=100\nupdates_per_step=0.03"
                                          : "hidden=32,16\nhorizon=24\npasses=2\nminibatches=2";
  size_t size = 0;
  int good = page_learn(task, algo, 16, 7, 11, settings, NULL) == 0;
  for (int i = 0; good && i < 3; ++i) good = rdm_agent_rollout(agent, class_pool, NULL) == RDM_OK;
  if (!good || rdm_agent_write_state(agent, NULL, 0, &size)) return NULL;
  void* bytes = malloc(size);
  const char* hash = bytes && !rdm_agent_write_state(agent, bytes, size, &size)
                         ? put_hash(join(bytes, size, kHashSeed))
                         : NULL;
  free(bytes);
  return hash;
}

/* The rates of the table: worlds that step, rows that a policy acts on, transitions that are learned from. */
EXPORT int page_steps(int steps) {
  for (int i = 0; i < steps; ++i)
    if (rdm_pool_baseline(class_pool, RDM_BASELINE_RANDOM) || rdm_pool_step(class_pool)) return -1;
  return 0;
}
EXPORT int page_acts(int acts) {
  for (int i = 0; i < acts; ++i)
    if (act()) return -1;
  return 0;
}
