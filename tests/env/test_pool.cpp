// Making and describing pools, and binding a host's buffers.
#include "env/resolved_config.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

TEST(Pool, DescribesItself) {
  register_toy();
  PoolConfig c;
  c.seed = 4;
  TestPool p("Toy-Push", 3, {{"max_steps", nullptr, 20}}, c);
  EXPECT_EQ(p->obs_dim(), kToyObs);
  EXPECT_EQ(p->cost_dim(), kToyCosts);
  EXPECT_EQ(p->task().max_steps(), 20);
  EXPECT_EQ(p->options().integer("max_steps"), 20);
  EXPECT_STREQ(task_at(p->task_index()).name, "toy_push");
  EXPECT_STREQ(p->config().task, "toy_push");
  EXPECT_EQ(p->config().num_envs, 3);
  EXPECT_EQ(p->config().seed, 4u);
}

TEST(Pool, BuffersAreAlignedAndClear) {
  register_toy();
  TestPool p("toy_push", 3);
  const Buffers& b = p.rows();
  for (const void* q : {static_cast<const void*>(b.obs), static_cast<const void*>(b.final_obs),
                        static_cast<const void*>(b.action), static_cast<const void*>(b.cost),
                        static_cast<const void*>(b.truncated)})
    EXPECT_EQ(reinterpret_cast<uintptr_t>(q) % 64, 0u);
  for (int i = 0; i < 3 * kToyObs; ++i) EXPECT_EQ(b.obs[i], 0);
}

TEST(Pool, RefusesBadConfigs) {
  register_toy();
  const auto code = [](auto&& change) {
    PoolConfig c;
    c.task = "toy_push";
    change(c);
    return code_of([&] { Pool::destroy(Pool::create(c)); });
  };
  EXPECT_EQ(code([](PoolConfig&) {}), Code::kOk);
  EXPECT_EQ(code([](PoolConfig& c) { c.num_envs = 0; }), Code::kRange);
  EXPECT_EQ(code([](PoolConfig& c) { c.num_envs = 65537; }), Code::kRange);
  EXPECT_EQ(code([](PoolConfig& c) { c.num_threads = -1; }), Code::kRange);
  EXPECT_EQ(code([](PoolConfig& c) { c.num_threads = 257; }), Code::kRange);
  EXPECT_EQ(code([](PoolConfig& c) { c.task = nullptr; }), Code::kArgument);
  EXPECT_EQ(code([](PoolConfig& c) { c.task = "toy_pusk"; }), Code::kNotFound);
  EXPECT_NE(std::strstr(last_error(), "toy_push"), nullptr);
  const OptionInput unknown{"max_step", nullptr, 3}, outside{"max_steps", nullptr, 0};
  EXPECT_EQ(code([&](PoolConfig& c) { c.options = &unknown, c.num_options = 1; }), Code::kNotFound);
  EXPECT_EQ(code([&](PoolConfig& c) { c.options = &outside, c.num_options = 1; }), Code::kRange);
  EXPECT_EQ(code([&](PoolConfig& c) { c.num_options = 1; }), Code::kArgument);
}

TEST(Pool, BoundBuffersTakeOver) {
  register_toy();
  TestPool p("toy_push", 2), plain("toy_push", 2);
  p->reset(nullptr, nullptr);
  plain->reset(nullptr, nullptr);
  float obs[2 * kToyObs], action[2 * kToyActions], cost[2 * kToyCosts];
  uint8_t truncated[2] = {9, 9};
  const float first = p.obs(0)[0];
  Buffers host;
  host.obs = obs;
  host.action = action;
  host.cost = cost;
  host.truncated = truncated;
  const float* reward = p.rows().reward;
  p->bind(host);
  EXPECT_EQ(p.rows().obs, obs);
  EXPECT_EQ(p.rows().reward, reward);
  EXPECT_EQ(obs[0], first);
  EXPECT_EQ(truncated[1], 0);
  EXPECT_EQ(action[3], 0);
  for (int t = 0; t < 10; ++t) {
    action[2] = plain.action(1)[0] = 0.75f;
    p->step(nullptr);
    plain->step(nullptr);
    EXPECT_EQ(std::memcmp(obs, plain.rows().obs, sizeof obs), 0);
    EXPECT_EQ(cost[2], 1);
    EXPECT_EQ(cost[0], 0);
  }
  EXPECT_EQ(truncated[0], 1);
  // on to another place: contents follow
  float moved[2 * kToyObs] = {};
  host = {};
  host.obs = moved;
  p->bind(host);
  EXPECT_EQ(std::memcmp(moved, obs, sizeof obs), 0);
  EXPECT_EQ(p.rows().action, action);
}

TEST(Pool, StatsCount) {
  register_toy();
  TestPool p("toy_push", 2);
  p->reset(nullptr, nullptr);
  for (int t = 0; t < 5; ++t) p->step(nullptr);
  EXPECT_EQ(p->stats().steps, 10);
  EXPECT_EQ(p->stats().diverged, 0);
  EXPECT_EQ(p->stats().contacts_max, 0);
}

TEST(Pool, AnEngineThatIsNotThereIsUnsupported) {
  register_toy();
  PoolConfig c;
  c.task = "toy_push";
  const OptionInput engine{"engine", "absent", 0};
  c.options = &engine;
  c.num_options = 1;
  EXPECT_EQ(code_of([&] { Pool::destroy(Pool::create(c)); }), Code::kUnsupported);
  MemoryCount count;
  c.hooks = count.hooks();
  EXPECT_EQ(code_of([&] { Pool::measure(c, &count, nullptr); }), Code::kUnsupported);
}

TEST(Pool, MadeTasksCanBeAsked) {
  register_toy();
  PoolConfig c;
  c.task = "toy_push";
  const ResolvedPoolConfig made(c);
  EXPECT_EQ(obs_dim(*made.task), kToyObs);
  EXPECT_EQ(made.cost_dim, kToyCosts);
}

}  // namespace
}  // namespace rdm::test
