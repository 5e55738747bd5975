// What a learner sees of a pool's rows and takes for cost: actor_obs, critic_obs, cost_signal.
#include <algorithm>
#include <cmath>

#include "contract.hpp"

namespace {

rdm_pool* pool_of(const char* task, const char* settings, int32_t threads = 0) {
  rdm_pool_config c = pool_config(4);
  c.task = task;
  c.settings = settings;
  c.num_threads = threads;
  rdm_pool* p = make_pool(c);
  EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  return p;
}

rdm_agent* agent_of(const rdm_pool* p, const std::string& settings, rdm_result wanted = RDM_OK) {
  rdm_agent_config c;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, p), RDM_OK);
  c.settings = settings.c_str();
  rdm_agent* a = nullptr;
  EXPECT_EQ(rdm_agent_create(&a, &c), wanted) << rdm_last_error();
  return a;
}

rdm_policy* policy_of(const rdm_agent* a) {
  const std::vector<unsigned char> bytes = policy_bytes(a);
  rdm_policy* p = nullptr;
  EXPECT_EQ(rdm_policy_read(&p, bytes.data(), bytes.size()), RDM_OK) << rdm_last_error();
  return p;
}

std::vector<float> tensor(const rdm_policy* p, const char* name, int32_t rows, int32_t cols) {
  std::vector<float> out(static_cast<size_t>(rows) * static_cast<size_t>(cols));
  EXPECT_EQ(rdm_policy_get_tensor(p, name, out.data(), out.size()), RDM_OK) << rdm_last_error();
  return out;
}

// Of tasks with hands: nothing but hands and goals.
void expect_no_object(const rdm_pool* p, const rdm_policy* policy, size_t count) {
  std::vector<int32_t> columns(count);
  ASSERT_EQ(rdm_policy_get_columns(policy, columns.data(), count, &count), RDM_OK);
  rdm_field_info f = RDM_INIT(rdm_field_info);
  for (int i = 0; rdm_pool_field_at(p, i, &f) == RDM_OK; ++i) {
    const std::string name = f.name;
    const bool hidden = name.find("object") == 0 || name.find("target") == 0 ||
                        name.find("_bottle.") != std::string::npos || name.find("trash") == 0 ||
                        name.find("broom") == 0;
    for (const int32_t c : columns)
      EXPECT_FALSE(hidden && c >= f.offset && c < f.offset + f.count) << name << " entry " << c;
  }
}

TEST(LearnerView, APolicyOfAPartTakesWholeRows) {
  rdm_pool* p = pool_of("grasp", nullptr);
  rdm_agent* a = agent_of(p, "hidden=16\nhorizon=16\nactor_obs=touch,!right.ff_tip_*\ncritic_obs=*");
  ASSERT_EQ(rdm_agent_rollout(a, p, nullptr), RDM_OK) << rdm_agent_error(a);
  rdm_policy* policy = policy_of(a);
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  ASSERT_EQ(rdm_pool_get_spec(p, &spec), RDM_OK);
  EXPECT_EQ(rdm_policy_check(policy, &spec), RDM_OK) << rdm_last_error();

  std::vector<int32_t> wanted;
  for (int32_t i = 0; i < spec.num_fields; ++i) {
    rdm_field_info f = RDM_INIT(rdm_field_info);
    ASSERT_EQ(rdm_pool_field_at(p, i, &f), RDM_OK);
    const std::string name = f.name;
    if (name.rfind("right.", 0) == 0 && name.rfind("right.ff_tip_", 0) != 0)
      for (int32_t k = 0; k < f.count; ++k) wanted.push_back(f.offset + k);
  }
  std::vector<int32_t> columns(static_cast<size_t>(spec.obs_dim), -1);
  size_t count = 0;
  ASSERT_EQ(rdm_policy_get_columns(policy, nullptr, 0, &count), RDM_OK);
  EXPECT_EQ(count, wanted.size());
  ASSERT_EQ(rdm_policy_get_columns(policy, columns.data(), count, &count), RDM_OK);
  columns.resize(wanted.size());
  EXPECT_EQ(columns, wanted);
  EXPECT_EQ(rdm_policy_get_columns(policy, nullptr, 1, &count), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_get_columns(policy, columns.data(), static_cast<size_t>(-1), &count), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_policy_get_columns(policy, columns.data(), 1, nullptr), RDM_ERROR_ARGUMENT);

  // tensors are over whole rows: who computes with them need not know of the part
  rdm_policy_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(rdm_policy_get_info(policy, &info), RDM_OK);
  EXPECT_EQ(info.obs_dim, spec.obs_dim);
  rdm_tensor t;
  ASSERT_EQ(rdm_policy_tensor_at(policy, 0, &t), RDM_OK);
  EXPECT_STREQ(t.name, "actor.0.weight");
  EXPECT_EQ(t.rows, 16);
  EXPECT_EQ(t.cols, spec.obs_dim);
  const auto row = static_cast<size_t>(spec.obs_dim), actions = static_cast<size_t>(spec.action_dim);
  const auto weight = tensor(policy, "actor.0.weight", 16, spec.obs_dim),
             bias = tensor(policy, "actor.0.bias", 16, 1);
  const auto last = tensor(policy, "actor.1.weight", spec.action_dim, 16),
             last_bias = tensor(policy, "actor.1.bias", spec.action_dim, 1);
  const auto shift = tensor(policy, "normalizer.shift", spec.obs_dim, 1),
             scale = tensor(policy, "normalizer.scale", spec.obs_dim, 1),
             clip = tensor(policy, "normalizer.clip", 1, 1);
  const auto example = tensor(policy, "example.obs", spec.obs_dim, 1);
  EXPECT_EQ(example.size(), row);
  const rdm_buffers b = buffers_of(p);
  std::vector<float> action(4 * actions);
  std::vector<unsigned char> scratch(rdm_policy_scratch(policy, 4));
  ASSERT_EQ(rdm_policy_act(policy, b.obs, 4, nullptr, action.data(), scratch.data(), scratch.size()), RDM_OK);
  for (size_t r = 0; r < 4; ++r) {
    double hidden[16];
    for (size_t u = 0; u < 16; ++u) {
      double sum = static_cast<double>(bias[u]);
      for (size_t i = 0; i < row; ++i)
        sum += static_cast<double>(weight[u * row + i] *
                                   std::clamp((b.obs[r * row + i] - shift[i]) * scale[i], -clip[0], clip[0]));
      hidden[u] = std::tanh(sum);
    }
    for (size_t j = 0; j < actions; ++j) {
      double mean = static_cast<double>(last_bias[j]);
      for (size_t u = 0; u < 16; ++u) mean += static_cast<double>(last[j * 16 + u]) * hidden[u];
      EXPECT_NEAR(action[r * actions + j], std::clamp(mean, -1.0, 1.0), 1e-4);
    }
  }
  for (size_t i = 0; i < row; ++i) {
    const bool seen = std::binary_search(wanted.begin(), wanted.end(), static_cast<int32_t>(i));
    if (!seen) {
      EXPECT_EQ(weight[i], 0) << i;
    }
  }
  rdm_policy_destroy(policy);
  rdm_agent_destroy(a);
  // a policy that sees all says so
  a = agent_of(p, "hidden=16\nhorizon=16\nactor_obs=state");
  policy = policy_of(a);
  ASSERT_EQ(rdm_policy_get_columns(policy, nullptr, 0, &count), RDM_OK);
  EXPECT_EQ(count, static_cast<size_t>(spec.obs_dim));
  rdm_policy_destroy(policy);
  rdm_agent_destroy(a);
  rdm_pool_destroy(p);
}

TEST(LearnerView, PresetsFitEveryTaskWithARobot) {
  for (const std::string& task : task_names()) {
    SCOPED_TRACE(task);
    rdm_pool* p = pool_of(task.c_str(), nullptr);
    rdm_field_info f = RDM_INIT(rdm_field_info);
    ASSERT_EQ(rdm_pool_field_at(p, 0, &f), RDM_OK);
    const std::string first = f.name;
    const bool hands = first == "right.joint_position", sensors = first == "accelerometer";
    bool joints = false;
    for (int i = 0; rdm_pool_field_at(p, i, &f) == RDM_OK; ++i)
      joints |= std::string(f.name) == "joint_position";
    size_t counts[4] = {};
    const char* presets[] = {"state", "touch", "proprioception", "vision"};
    for (int k = 0; k < 4; ++k) {
      const bool known = k == 0 || hands || sensors || joints;
      rdm_agent* a =
          agent_of(p, std::string("actor_obs=") + presets[k], known ? RDM_OK : RDM_ERROR_NOT_FOUND);
      if (!a) continue;
      rdm_policy* policy = policy_of(a);
      EXPECT_EQ(rdm_policy_get_columns(policy, nullptr, 0, &counts[k]), RDM_OK);
      if (k == 3) expect_no_object(p, policy, counts[k]);
      rdm_policy_destroy(policy);
      rdm_agent_destroy(a);
    }
    if (hands) {
      EXPECT_GT(counts[0], counts[1]);
      EXPECT_GT(counts[1], counts[2]);
      EXPECT_GE(counts[3], counts[1]);
      EXPECT_LE(counts[3], counts[1] + 7);  // a goal's pose, where there is one
      EXPECT_LT(counts[3], counts[0]);
      EXPECT_EQ((counts[1] - counts[2]) % 30, 0u);  // six numbers of each of five fingertips
    }
    rdm_pool_destroy(p);
  }
}

TEST(LearnerView, APoolLendsTheNamesOfItsFields) {
  rdm_pool* p = pool_of("grasp", nullptr);
  rdm_agent_config c;
  ASSERT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(c.fields, nullptr);
  ASSERT_EQ(rdm_agent_config_for_pool(&c, p), RDM_OK);
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  ASSERT_EQ(rdm_pool_get_spec(p, &spec), RDM_OK);
  ASSERT_EQ(c.num_fields, spec.num_fields);
  for (int32_t i = 0; i < spec.num_fields; ++i) {
    rdm_field_info f = RDM_INIT(rdm_field_info);
    ASSERT_EQ(rdm_pool_field_at(p, i, &f), RDM_OK);
    EXPECT_STREQ(c.fields[i].name, f.name);
    EXPECT_EQ(c.fields[i].offset, f.offset);
    EXPECT_EQ(c.fields[i].count, f.count);
  }
  // an older caller has no such members, and its agent sees all
  rdm_agent* a = nullptr;
  c.struct_size = offsetof(rdm_agent_config, fields);
  EXPECT_EQ(rdm_agent_create(&a, &c), RDM_OK) << rdm_last_error();
  rdm_agent_destroy(a);
  c.settings = "actor_obs=touch";
  EXPECT_EQ(rdm_agent_create(&a, &c), RDM_ERROR_ARGUMENT);
  c.struct_size = sizeof c;
  c.settings = "critic_obs=object.positon";
  EXPECT_EQ(rdm_agent_create(&a, &c), RDM_ERROR_NOT_FOUND);
  EXPECT_STREQ(rdm_last_error(),
               "critic_obs: 'object.positon' names no field of the observation; nearest is object.position");
  c.settings = nullptr;
  c.num_fields = -1;
  EXPECT_EQ(rdm_agent_create(&a, &c), RDM_ERROR_RANGE);
  c.num_fields = 1;
  c.fields = nullptr;
  EXPECT_EQ(rdm_agent_create(&a, &c), RDM_ERROR_ARGUMENT);
  rdm_pool_destroy(p);
}

TEST(LearnerView, MemoryIsToldExactlyWithAPart) {
  rdm_pool* p = pool_of("grasp", nullptr);
  for (const char* settings : {"", "actor_obs=touch",
                               "actor_obs=proprioception,right.ff_tip_force,right.mf_tip_force,"
                               "right.rf_tip_force\ncritic_obs=!goal.*\ncritic_hidden=300,20"}) {
    CountingHost host;
    rdm_agent_config c;
    ASSERT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
    ASSERT_EQ(rdm_agent_config_for_pool(&c, p), RDM_OK);
    c.settings = settings;
    c.host = &host.hooks;
    size_t bytes = 0;
    ASSERT_EQ(rdm_agent_config_memory(&c, &bytes), RDM_OK) << rdm_last_error();
    EXPECT_EQ(host.live, 0u);
    rdm_agent* a = make_agent(c);
    EXPECT_EQ(host.live, bytes) << settings;
    const size_t calls = host.calls;
    EXPECT_EQ(rdm_agent_rollout(a, p, nullptr), RDM_OK);
    EXPECT_EQ(host.calls, calls);
    rdm_agent_destroy(a);
    EXPECT_EQ(host.live, 0u);
  }
  rdm_pool_destroy(p);
}

// Plays the first horizon of an agent by hand: sums over finished episodes of costs, and of cost_raw above 0.
struct Sums {
  double flag = 0, raw = 0;
  int episodes = 0;
};
Sums played(const char* task, const std::string& settings, int horizon) {
  rdm_pool* p = pool_of(task, "max_steps=20");
  rdm_agent* a = agent_of(p, settings);
  const rdm_buffers b = buffers_of(p);
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  EXPECT_EQ(rdm_pool_get_spec(p, &spec), RDM_OK);
  const auto costs = static_cast<size_t>(spec.cost_dim);
  Sums s;
  double flag[4] = {}, raw[4] = {};
  for (int t = 0; t < horizon; ++t) {
    EXPECT_EQ(rdm_agent_act(a, b.obs, RDM_ACT_SAMPLE, b.action), RDM_OK);
    EXPECT_EQ(rdm_pool_step(p), RDM_OK);
    rdm_transition x{};
    x.struct_size = sizeof x;
    x.reward = b.reward, x.cost = b.cost;
    x.terminated = b.terminated, x.truncated = b.truncated, x.final_obs = b.final_obs;
    EXPECT_EQ(rdm_agent_record(a, &x), RDM_OK) << rdm_agent_error(a);
    for (size_t i = 0; i < 4; ++i) {
      flag[i] += static_cast<double>(b.cost[i * costs]);
      raw[i] += std::max(static_cast<double>(b.cost_raw[i * costs]), 0.0);
      if (!b.terminated[i] && !b.truncated[i]) continue;
      s.flag += flag[i], s.raw += raw[i], ++s.episodes;
      flag[i] = raw[i] = 0;
    }
  }
  rdm_agent_destroy(a);
  rdm_pool_destroy(p);
  return s;
}

TEST(LearnerView, CostsAreFlagsOrMagnitudes) {
  for (const char* task : {"ball_circle", "grasp"}) {
    SCOPED_TRACE(task);
    const std::string base = "horizon=40\naction_repeat=1\ncost_limit=3\nhidden=8\n";
    const Sums by_hand = played(task, base, 40);
    ASSERT_GE(by_hand.episodes, 8);
    rdm_epoch e[2]{};
    std::vector<unsigned char> parameters[2];
    for (const int raw : {0, 1}) {
      rdm_pool* p = pool_of(task, "max_steps=20");
      rdm_agent* a = agent_of(p, base + (raw ? "cost_signal=raw" : "cost_signal=flag"));
      e[raw].struct_size = sizeof e[raw];
      ASSERT_EQ(rdm_agent_rollout(a, p, &e[raw]), RDM_OK) << rdm_agent_error(a);
      EXPECT_EQ(e[raw].cost_signal, raw);
      EXPECT_EQ(e[raw].episodes, by_hand.episodes);
      parameters[raw] = policy_bytes(a);
      rdm_agent_destroy(a);
      rdm_pool_destroy(p);
    }
    EXPECT_NEAR(e[0].cost[0], by_hand.flag / by_hand.episodes, 1e-4);
    EXPECT_NEAR(e[1].cost[0], by_hand.raw / by_hand.episodes, 1e-4 * (1 + by_hand.raw));
    EXPECT_NE(e[0].cost[0], e[1].cost[0]);
    EXPECT_EQ(e[0].ret, e[1].ret);
    EXPECT_NE(parameters[0], parameters[1]);
  }
}

// A pool that repeats actions itself shows cost_raw of its last control step alone; the agent learns all.
TEST(LearnerView, MagnitudesAreSummedWhoeverRepeats) {
  std::vector<unsigned char> policies[2];
  for (const int by_pool : {0, 1}) {
    rdm_pool* p = pool_of("ball_circle", by_pool ? "max_steps=20\naction_repeat=4" : "max_steps=20");
    rdm_agent* a = agent_of(p, "horizon=20\naction_repeat=4\ncost_limit=3\nhidden=8\ncost_signal=raw");
    rdm_epoch e{};
    e.struct_size = sizeof e;
    ASSERT_EQ(rdm_agent_rollout(a, p, &e), RDM_OK) << rdm_agent_error(a);
    ASSERT_EQ(rdm_agent_rollout(a, p, &e), RDM_OK) << rdm_agent_error(a);
    policies[by_pool] = policy_bytes(a);
    rdm_agent_destroy(a);
    rdm_pool_destroy(p);
  }
  EXPECT_EQ(policies[0].size(), policies[1].size());
  rdm_policy* p[2] = {};
  for (int k = 0; k < 2; ++k)
    ASSERT_EQ(rdm_policy_read(&p[k], policies[k].data(), policies[k].size()), RDM_OK);
  const auto a = tensor(p[0], "actor.0.bias", 8, 1), b = tensor(p[1], "actor.0.bias", 8, 1);
  for (size_t i = 0; i < 8; ++i) EXPECT_NEAR(a[i], b[i], 1e-5);  // sums of float and of double
  for (rdm_policy* one : p) rdm_policy_destroy(one);
}

TEST(LearnerView, AnEpochOfAnOlderCallerIsFilledAsFarAsItGoes) {
  rdm_pool* p = pool_of("ball_circle", nullptr);
  rdm_agent* a = agent_of(p, "horizon=8\ncost_signal=raw");
  rdm_epoch e{};
  e.struct_size = offsetof(rdm_epoch, cost_signal);
  e.cost_signal = 77;
  ASSERT_EQ(rdm_agent_rollout(a, p, &e), RDM_OK) << rdm_agent_error(a);
  EXPECT_EQ(e.epoch, 1);
  EXPECT_EQ(e.cost_signal, 77);
  rdm_agent_destroy(a);
  rdm_pool_destroy(p);
}

}  // namespace
