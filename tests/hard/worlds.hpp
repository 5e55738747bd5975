// What the hard checks share: every task on every engine that it has, small pools, agents of every algorithm,
// and the promises that hold after any call.
#pragma once
#include <redman/redman.h>

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "has_option.hpp"
#include "own_task.hpp"
#include "records.hpp"

namespace hard {

// Where the text of a broken promise goes; stderr when it is null.
inline void (*on_broken)(const char* text) = nullptr;

// Ends the program with a text: a broken promise is a finding.
[[noreturn]] __attribute__((format(printf, 4, 5))) inline void broken(const char* file, int line,
                                                                      const char* condition,
                                                                      const char* format, ...) {
  char why[400], text[700];
  va_list list;
  va_start(list, format);
  std::vsnprintf(why, sizeof why, format, list);
  va_end(list);
  const char* name = std::strrchr(file, '/');
  std::snprintf(text, sizeof text, "%s:%d: not so: %s: %s", name ? name + 1 : file, line, condition, why);
  if (on_broken)
    on_broken(text);
  else
    std::fprintf(stderr, "%s\n", text);
  std::abort();
}
#define HARD_REQUIRE(condition, ...)                                               \
  do {                                                                             \
    if (!(condition)) ::hard::broken(__FILE__, __LINE__, #condition, __VA_ARGS__); \
  } while (0)

inline std::string argument(int argc, char** argv, const char* flag, const char* otherwise) {
  for (int i = 1; i + 1 < argc; ++i)
    if (std::strcmp(argv[i], flag) == 0) return argv[i + 1];
  return otherwise;
}

// A task on one of its engines; tasks without an engine of their own have one entry, engine "".
struct World {
  std::string task, engine;
  int32_t index = 0, max_steps = 0;
  std::string settings = {}, title = {};  // options as text; a name that says them
  std::string name() const { return !title.empty() ? title : engine.empty() ? task : task + "/" + engine; }
};

// Of the library's tasks, and of one through callbacks.
inline std::vector<World> all_worlds() {
  static rdm::test::BallTask own("own_ball");
  static const rdm::test::Registered registered(own.def);
  std::vector<World> out;
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    rdm_task t{};
    t.struct_size = sizeof t;
    HARD_REQUIRE(rdm_task_at(i, &t) == RDM_OK, "%s", rdm_last_error());
    bool has_engine = false;
    for (int32_t k = 0; k < t.num_options; ++k) {
      rdm_option_spec o = RDM_INIT(rdm_option_spec);
      if (rdm_task_option_at(i, k, &o) != RDM_OK || std::strcmp(o.key, "engine") != 0) continue;
      has_engine = true;
      std::string choices = o.choices ? o.choices : "";
      for (size_t at = 0; at < choices.size();) {
        const size_t bar = std::min(choices.find('|', at), choices.size());
        out.push_back({t.name, choices.substr(at, bar - at), i, t.max_steps});
        at = bar + 1;
      }
    }
    if (!has_engine) out.push_back({t.name, "", i, t.max_steps});
  }
  return out;
}

// A task with every hand on every arm.
inline std::vector<World> all_pairs(const std::string& task) {
  std::vector<World> out;
  int32_t index = 0;
  HARD_REQUIRE(rdm_task_find(task.c_str(), &index) == RDM_OK, "%s", rdm_last_error());
  std::vector<std::string> of[3];
  for (int32_t i = 0; i < rdm_robot_count(); ++i) {
    rdm_robot_def d{};
    d.struct_size = sizeof d;
    HARD_REQUIRE(rdm_robot_get_def(i, &d) == RDM_OK, "%s", rdm_last_error());
    of[d.kind].push_back(d.name);
  }
  for (const std::string& hand : of[RDM_ROBOT_HAND])
    for (const std::string& arm : of[RDM_ROBOT_ARM])
      out.push_back({task, "", index, 0, "hand=" + hand + "\narm=" + arm, hand + "+" + arm});
  return out;
}

struct PoolOf {
  rdm_pool* handle = nullptr;
  rdm_buffers rows{};
  rdm_spec spec{};
  rdm_pool_config config{};
  int32_t num_envs = 1;

  PoolOf() = default;
  PoolOf(const PoolOf&) = delete;
  PoolOf& operator=(const PoolOf&) = delete;
  ~PoolOf() { reset(); }
  void reset() {
    rdm_pool_destroy(handle);
    handle = nullptr;
  }
  // make is configure and create; create takes no memory of its own.
  void configure(const World& w, int32_t envs, const rdm_host* host = nullptr, int32_t threads = 0,
                 const std::vector<rdm_option>& options = {}) {
    world_ = w;
    options_ = options;
    if (!w.engine.empty()) options_.push_back({"engine", world_.engine.c_str(), 0});
    rdm_pool_config_init(&config, sizeof config);
    config.task = world_.task.c_str();
    config.num_envs = envs;
    config.num_threads = threads;
    config.host = host;
    config.options = options_.data();
    config.num_options = static_cast<int32_t>(options_.size());
    config.settings = world_.settings.c_str();
    num_envs = envs;
  }
  rdm_result create() {
    const rdm_result r = rdm_pool_create(&handle, &config);
    if (r != RDM_OK) return r;
    rows.struct_size = sizeof rows;
    spec.struct_size = sizeof spec;
    rdm_pool_get_buffers(handle, &rows);
    rdm_pool_get_spec(handle, &spec);
    return RDM_OK;
  }
  rdm_result make(const World& w, int32_t envs, const rdm_host* host = nullptr, int32_t threads = 0,
                  const std::vector<rdm_option>& options = {}) {
    configure(w, envs, host, threads, options);
    return create();
  }
  static size_t count(int32_t width) { return static_cast<size_t>(width); }
  // Actions that differ from step to step, the same in every run.
  void fill_actions(uint32_t step) {
    const size_t n = count(num_envs) * count(spec.action_dim);
    for (size_t i = 0; i < n; ++i)
      rows.action[i] =
          static_cast<float>(static_cast<int32_t>((i * 2654435761u + step * 40503u) >> 8 & 255) - 128) / 128;
  }
  Bytes state() const {
    size_t n = 0;
    HARD_REQUIRE(rdm_pool_write_state(handle, -1, nullptr, 0, &n) == RDM_OK, "%s", rdm_last_error());
    Bytes out(n);
    HARD_REQUIRE(rdm_pool_write_state(handle, -1, out.data(), n, &n) == RDM_OK, "%s", rdm_last_error());
    return out;
  }
  // All that a step writes is finite, costs are not negative.
  const char* broken_row() const {
    const size_t n = count(num_envs), obs = n * count(spec.obs_dim), costs = n * count(spec.cost_dim);
    for (size_t i = 0; i < obs; ++i)
      if (!std::isfinite(rows.obs[i])) return "obs";
    for (size_t i = 0; i < obs; ++i)
      if (!std::isfinite(rows.final_obs[i])) return "final_obs";
    for (size_t i = 0; i < n; ++i) {
      if (!std::isfinite(rows.reward[i])) return "reward";
      if (!std::isfinite(rows.episode_return[i])) return "episode_return";
    }
    for (size_t i = 0; i < costs; ++i) {
      if (!(std::isfinite(rows.cost[i]) && rows.cost[i] >= 0)) return "cost";
      if (!std::isfinite(rows.cost_raw[i])) return "cost_raw";
      if (!std::isfinite(rows.episode_cost[i])) return "episode_cost";
    }
    return nullptr;
  }

 private:
  World world_;
  std::vector<rdm_option> options_;
};

// The text of a failure: UTF-8, one line, no control characters.
inline bool good_text(const char* text) {
  const auto* s = reinterpret_cast<const unsigned char*>(text);
  while (*s) {
    if (*s < 0x20 || *s == 0x7f) return false;
    const int more = *s < 0x80                 ? 0
                     : *s >= 0xc2 && *s < 0xe0 ? 1
                     : (*s & 0xf0) == 0xe0     ? 2
                     : *s >= 0xf0 && *s < 0xf5 ? 3
                                               : -1;
    if (more < 0) return false;
    ++s;
    for (int k = 0; k < more; ++k, ++s)
      if ((*s & 0xc0) != 0x80) return false;
  }
  return true;
}

// After a refusal: a known code, and a text that a program may print.
inline void require_refusal(rdm_result r) {
  HARD_REQUIRE(r != RDM_ERROR_INTERNAL && std::strcmp(rdm_result_string(r), rdm_result_string(-1234567)) != 0,
               "code %d: %s", r, rdm_last_error());
  HARD_REQUIRE(*rdm_last_error() && good_text(rdm_last_error()), "text of code %d: %s", r, rdm_last_error());
}

// A small agent for rows of 3 observations, 2 actions and 2 costs: 4 rows, 8 decisions a horizon.
struct AgentOf {
  static constexpr int32_t kObs = 3, kActions = 2, kCosts = 2, kRows = 4, kHorizon = 8;
  rdm_agent* handle = nullptr;
  rdm_agent_config config{};

  AgentOf() = default;
  AgentOf(const AgentOf&) = delete;
  AgentOf& operator=(const AgentOf&) = delete;
  ~AgentOf() { reset(); }
  void reset() {
    rdm_agent_destroy(handle);
    handle = nullptr;
  }
  void configure(const std::string& algo, const rdm_host* host = nullptr, int32_t threads = 0) {
    static const rdm_option usual[] = {{"hidden", "4,4", 0},
                                       {"horizon", nullptr, kHorizon},
                                       {"passes", nullptr, 2},
                                       {"minibatches", nullptr, 2}};
    static const rdm_option replay[] = {{"hidden", "4,4", 0},
                                        {"horizon", nullptr, kHorizon},
                                        {"replay_rows", nullptr, 64},
                                        {"batch_rows", nullptr, 8},
                                        {"start_steps", nullptr, 4}};
    static const double limits[kCosts] = {1, -1};
    algo_ = algo;
    rdm_agent_config_init(&config, sizeof config);
    config.algo = algo_.c_str();
    config.obs_dim = kObs;
    config.action_dim = kActions;
    config.cost_dim = kCosts;
    config.num_envs = kRows;
    config.num_threads = threads;
    config.cost_limits = limits;
    const bool replays = has_option(algo.c_str(), "replay_rows");
    config.options = replays ? replay : usual;
    config.num_options = replays ? 5 : 4;
    config.host = host;
  }
  rdm_result create() { return rdm_agent_create(&handle, &config); }
  rdm_result make(const std::string& algo, const rdm_host* host = nullptr, int32_t threads = 0) {
    configure(algo, host, threads);
    return create();
  }
  // One epoch of made-up data; every number that comes out is finite.
  rdm_result epoch(bool require_finite = true) {
    float obs[kRows * kObs], action[kRows * kActions], reward[kRows], cost[kRows * kCosts];
    uint8_t ended[kRows];
    for (int h = 0; h < kHorizon; ++h) {
      for (int i = 0; i < kRows * kObs; ++i) obs[i] = static_cast<float>((7 * i + 3 * h) % 11) * 0.1f;
      if (const rdm_result r = rdm_agent_act(handle, obs, RDM_ACT_SAMPLE, action)) return r;
      for (float a : action) HARD_REQUIRE(!require_finite || std::isfinite(a), "an action is not finite");
      for (int i = 0; i < kRows; ++i) {
        reward[i] = -0.1f * static_cast<float>(h % 3);
        for (int k = 0; k < kCosts; ++k) cost[i * kCosts + k] = static_cast<float>((i + h + k) % 2);
        ended[i] = h % 4 == 3;
      }
      rdm_transition t{};
      t.struct_size = sizeof t;
      t.reward = reward;
      t.cost = cost;
      t.terminated = ended;
      if (const rdm_result r = rdm_agent_record(handle, &t)) return r;
    }
    return rdm_agent_update(handle, obs, nullptr);
  }
  Bytes state() const {
    size_t n = 0;
    HARD_REQUIRE(rdm_agent_write_state(handle, nullptr, 0, &n) == RDM_OK, "%s", rdm_last_error());
    Bytes out(n);
    HARD_REQUIRE(rdm_agent_write_state(handle, out.data(), n, &n) == RDM_OK, "%s", rdm_last_error());
    return out;
  }
  Bytes policy() const {
    size_t n = 0;
    HARD_REQUIRE(rdm_agent_write_policy(handle, nullptr, 0, &n) == RDM_OK, "%s", rdm_last_error());
    Bytes out(n);
    HARD_REQUIRE(rdm_agent_write_policy(handle, out.data(), n, &n) == RDM_OK, "%s", rdm_last_error());
    return out;
  }

 private:
  std::string algo_;
};

inline std::vector<std::string> all_algos() {
  std::vector<std::string> out;
  for (int32_t i = 0; i < rdm_algo_count(); ++i) {
    rdm_algo a{};
    a.struct_size = sizeof a;
    HARD_REQUIRE(rdm_algo_at(i, &a) == RDM_OK, "%s", rdm_last_error());
    out.emplace_back(a.name);
  }
  return out;
}

}  // namespace hard
