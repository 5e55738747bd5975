// rdm_actor_*: the same episodes whatever a step of the pool is, noise that is correlated as the policy says,
// ends, states, a center; and each refusal.
#include <algorithm>
#include <cmath>
#include <redman/plan.hpp>
#include <redman/redman.hpp>

#include "contract.hpp"
#include "heap_count.hpp"
#include "owned.hpp"

namespace {

Pool pool_of(const std::string& settings, int32_t envs, int32_t autoreset = RDM_AUTORESET_OFF) {
  rdm_pool_config c = pool_config(envs);
  c.settings = settings.c_str();
  c.autoreset = autoreset;
  c.seed = 5;
  Pool p(make_pool(c));
  EXPECT_EQ(rdm_pool_reset(p.get(), nullptr, nullptr), RDM_OK);
  return p;
}

// A policy of pools like this one that has learned nothing: it reacts to what it sees, with weights of its
// seed.
Policy policy_of(const rdm_pool* pool, const char* settings) {
  rdm_agent_config c;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, pool), RDM_OK);
  c.settings = settings;
  c.seed = 3;
  rdm_agent* agent = make_agent(c);
  const auto bytes = policy_bytes(agent);
  rdm_agent_destroy(agent);
  rdm_policy* p = nullptr;
  EXPECT_EQ(rdm_policy_read(&p, bytes.data(), bytes.size()), RDM_OK) << rdm_last_error();
  return Policy(p);
}
constexpr const char* kEverySix = "hidden=16\naction_repeat=6\nhorizon=8\nnormalize_obs=false\n";

rdm_actor_config config_of(const Policy& policy, const rdm_spec* spec, int32_t envs) {
  rdm_actor_config c;
  EXPECT_EQ(rdm_actor_config_init(&c, sizeof c), RDM_OK);
  c.policy = policy.get();
  c.spec = spec;
  c.num_envs = envs;
  return c;
}
Actor actor_of(const rdm_actor_config& c) {
  rdm_actor* a = nullptr;
  EXPECT_EQ(rdm_actor_create(&a, &c), RDM_OK) << rdm_last_error();
  return Actor(a);
}

struct Episode {
  float ret = 0;
  std::vector<float> cost;
  int32_t length = 0;
  bool operator==(const Episode& o) const { return ret == o.ret && cost == o.cost && length == o.length; }
};

// Episode e of `count` is the e-th that ends, world by world, of worlds that all play `each` of them.
std::vector<std::vector<Episode>> played(rdm_pool* pool, const Actor& actor, int32_t autoreset, size_t each) {
  const rdm_buffers b = buffers_of(pool);
  const rdm_spec s = spec_of(pool);
  const size_t costs = static_cast<size_t>(s.cost_dim);
  std::vector<std::vector<Episode>> out(3);
  std::vector<uint8_t> ended(3);
  const auto some_plays = [&] {
    return std::any_of(out.begin(), out.end(), [&](const auto& world) { return world.size() < each; });
  };
  while (some_plays()) {
    EXPECT_EQ(rdm_actor_act(actor.get(), b.obs, nullptr, nullptr, b.action), RDM_OK) << rdm_last_error();
    EXPECT_EQ(rdm_pool_step(pool), RDM_OK) << rdm_last_error();
    if (autoreset == RDM_AUTORESET_NEXT_STEP) {
      EXPECT_EQ(rdm_actor_reset(actor.get(), ended.data(), nullptr), 0);
    }
    bool any = false;
    for (size_t i = 0; i < 3; ++i) {
      ended[i] = b.terminated[i] || b.truncated[i];
      any |= ended[i] != 0;
      if (ended[i])
        out[i].push_back({b.episode_return[i],
                          {b.episode_cost + i * costs, b.episode_cost + (i + 1) * costs},
                          b.episode_step[i]});
    }
    if (autoreset == RDM_AUTORESET_SAME_STEP) {
      EXPECT_EQ(rdm_actor_reset(actor.get(), b.terminated, b.truncated), RDM_OK);
    }
    if (autoreset == RDM_AUTORESET_OFF && any) {
      EXPECT_EQ(rdm_pool_reset(pool, nullptr, ended.data()), RDM_OK);
      EXPECT_EQ(rdm_actor_reset(actor.get(), nullptr, ended.data()), RDM_OK);
    }
  }
  for (auto& world : out) world.resize(each);
  return out;
}

TEST(Actor, TheSameEpisodesWhateverAStepOfThePoolIs) {
  const Pool plain = pool_of("", 3);
  const Policy policy = policy_of(plain.get(), kEverySix);
  for (const bool stochastic : {false, true}) {
    std::vector<std::vector<Episode>> first;
    for (const int32_t autoreset : {RDM_AUTORESET_OFF, RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP})
      for (const int32_t repeat : {1, 2, 3, 6}) {
        // worlds go out of step with each other in another order there, and noise is drawn in that order
        if (stochastic && autoreset != RDM_AUTORESET_OFF) continue;
        const Pool pool = pool_of("max_steps=40\naction_repeat=" + std::to_string(repeat), 3, autoreset);
        const rdm_spec spec = spec_of(pool.get());
        rdm_actor_config c = config_of(policy, &spec, 3);
        c.stochastic = stochastic;
        const auto now = played(pool.get(), actor_of(c), autoreset, 2);
        if (first.empty()) first = now;
        EXPECT_TRUE(now == first) << "action_repeat " << repeat << " autoreset " << autoreset;
      }
  }
}

TEST(Actor, WhatDoesNotDivideIsRefusedWithBothNumbers) {
  const Policy policy = policy_of(pool_of("", 1).get(), kEverySix);
  for (const int32_t repeat : {4, 12}) {
    const rdm_spec spec = spec_of(pool_of("action_repeat=" + std::to_string(repeat), 1).get());
    char error[256] = "";
    rdm_actor_config c = config_of(policy, &spec, 1);
    c.error = error;
    c.error_size = sizeof error;
    rdm_actor* a = nullptr;
    EXPECT_EQ(rdm_actor_create(&a, &c), RDM_ERROR_ARGUMENT);
    EXPECT_EQ(a, nullptr);
    EXPECT_NE(std::strstr(error, "every 6 control steps"), nullptr) << error;
    EXPECT_NE(std::strstr(error, ("step of " + std::to_string(repeat)).c_str()), nullptr) << error;
    size_t bytes = 0;
    EXPECT_EQ(rdm_actor_config_memory(&c, &bytes), RDM_ERROR_ARGUMENT);
  }
}

TEST(Actor, EachBadArgumentHasAnError) {
  const Pool pool = pool_of("", 2);
  const rdm_spec spec = spec_of(pool.get());
  const Policy policy = policy_of(pool.get(), kEverySix);
  rdm_actor* a = nullptr;
  rdm_actor_config c = config_of(policy, &spec, 0);
  EXPECT_EQ(rdm_actor_create(&a, &c), RDM_ERROR_RANGE);
  c.num_envs = 65537;
  EXPECT_EQ(rdm_actor_create(&a, &c), RDM_ERROR_RANGE);
  c = config_of(policy, &spec, 2);
  c.policy = nullptr;
  EXPECT_EQ(rdm_actor_create(&a, &c), RDM_ERROR_ARGUMENT);
  std::vector<float> center(static_cast<size_t>(spec.action_dim), 1.5f);
  c = config_of(policy, &spec, 2);
  c.center = center.data();
  EXPECT_EQ(rdm_actor_create(&a, &c), RDM_ERROR_RANGE);
  rdm_spec other = spec;
  other.obs_dim += 1;
  c = config_of(policy, &other, 2);
  EXPECT_EQ(rdm_actor_create(&a, &c), RDM_ERROR_VERSION_MISMATCH);
  EXPECT_EQ(a, nullptr);
  EXPECT_NE(std::strstr(rdm_actor_error(nullptr), "NULL"), nullptr);
  rdm_actor_destroy(nullptr);

  const Actor actor = actor_of(config_of(policy, &spec, 2));
  const rdm_buffers b = buffers_of(pool.get());
  rdm_points clouds{};
  clouds.struct_size = sizeof clouds;
  EXPECT_EQ(rdm_actor_act(actor.get(), nullptr, nullptr, nullptr, b.action), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_actor_act(actor.get(), b.obs, nullptr, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_actor_act(actor.get(), b.obs, &clouds, nullptr, b.action), RDM_ERROR_STATE);
  EXPECT_NE(std::strstr(rdm_actor_error(actor.get()), "does not read points"), nullptr);
}

// A row that is not finite is refused where a decision is due, and nothing has been counted; where the action
// is held nobody reads it.
TEST(Actor, ARefusedCallCountsNothing) {
  const Pool pool = pool_of("", 2);
  const rdm_spec spec = spec_of(pool.get());
  const Policy policy = policy_of(pool.get(), kEverySix);
  rdm_actor_config c = config_of(policy, &spec, 2);
  c.stochastic = 1;
  const Actor refused = actor_of(c), untouched = actor_of(c);
  const rdm_buffers b = buffers_of(pool.get());
  std::vector<float> obs(b.obs, b.obs + 2 * spec.obs_dim);
  const size_t width = static_cast<size_t>(2 * spec.action_dim);
  std::vector<float> action(width, 7), expected(width);
  obs.back() = NAN;
  EXPECT_EQ(rdm_actor_act(refused.get(), obs.data(), nullptr, nullptr, action.data()), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::strstr(rdm_actor_error(refused.get()), "obs: row 1"), nullptr);
  EXPECT_EQ(action, std::vector<float>(width, 7));
  EXPECT_EQ(rdm_actor_act(refused.get(), b.obs, nullptr, nullptr, action.data()), RDM_OK);
  EXPECT_EQ(rdm_actor_act(untouched.get(), b.obs, nullptr, nullptr, expected.data()), RDM_OK);
  EXPECT_EQ(action, expected);
  for (int t = 1; t < 6; ++t) {
    EXPECT_EQ(rdm_actor_act(refused.get(), obs.data(), nullptr, nullptr, action.data()), RDM_OK);
    EXPECT_EQ(action, expected);
  }
  EXPECT_EQ(rdm_actor_act(refused.get(), obs.data(), nullptr, nullptr, action.data()), RDM_ERROR_ARGUMENT);
}

TEST(Actor, RowsOutsideTheMaskAreNeitherWrittenNorCounted) {
  const Pool pool = pool_of("", 2);
  const rdm_spec spec = spec_of(pool.get());
  const Policy policy = policy_of(pool.get(), kEverySix);
  const Actor actor = actor_of(config_of(policy, &spec, 2));
  const rdm_buffers b = buffers_of(pool.get());
  const size_t width = static_cast<size_t>(spec.action_dim);
  std::vector<float> action(2 * width, 7);
  const uint8_t second[2] = {0, 1};
  for (int t = 0; t < 6; ++t)
    EXPECT_EQ(rdm_actor_act(actor.get(), b.obs, nullptr, second, action.data()), RDM_OK);
  EXPECT_EQ(std::count(action.begin(), action.begin() + static_cast<long>(width), 7.0f),
            static_cast<long>(width));
  EXPECT_EQ(std::count(action.begin() + static_cast<long>(width), action.end(), 7.0f), 0);
  // world 0 decides at its first step, world 1 at its seventh: both now
  std::vector<float> nothing(static_cast<size_t>(2 * spec.obs_dim), 0.25f), decided(2 * width);
  EXPECT_EQ(rdm_actor_act(actor.get(), nothing.data(), nullptr, nullptr, decided.data()), RDM_OK);
  EXPECT_TRUE(std::equal(decided.begin(), decided.begin() + static_cast<long>(width),
                         decided.begin() + static_cast<long>(width)));
}

// z' = rho z + sqrt(1 - rho^2) n of the policy's deviation, anew at an episode's first decision.
TEST(Actor, NoiseIsCorrelatedAsThePolicySays) {
  const Pool pool = pool_of("", 1);
  const Policy policy =
      policy_of(pool.get(),
                "hidden=16\naction_repeat=1\nhorizon=8\nnormalize_obs=false\nnoise_correlation="
                "0.8\nstd_min=0.01\ninit_std=0.05\n");
  const rdm_spec spec = spec_of(pool.get());
  const size_t width = static_cast<size_t>(spec.action_dim);
  const std::vector<float> obs(static_cast<size_t>(spec.obs_dim));
  std::vector<float> mean(width), action(width);
  rdm_actor_config c = config_of(policy, &spec, 1);
  EXPECT_EQ(rdm_actor_act(actor_of(c).get(), obs.data(), nullptr, nullptr, mean.data()), RDM_OK);
  c.stochastic = 1;
  const auto correlation = [&](bool begins_anew) {
    const Actor actor = actor_of(c);
    double product = 0, square = 0;
    std::vector<float> before;
    for (int t = 0; t < 4000; ++t) {
      if (begins_anew) rdm_actor_reset(actor.get(), nullptr, nullptr);
      EXPECT_EQ(rdm_actor_act(actor.get(), obs.data(), nullptr, nullptr, action.data()), RDM_OK);
      for (size_t j = 0; j < width; ++j) {
        const double z = static_cast<double>(action[j]) - static_cast<double>(mean[j]);
        if (std::abs(mean[j]) > 0.7f) continue;  // what may be cut
        square += z * z;
        if (!before.empty()) product += z * (static_cast<double>(before[j]) - static_cast<double>(mean[j]));
      }
      before = action;
    }
    return product / square;
  };
  EXPECT_NEAR(correlation(false), 0.8, 0.02);
  EXPECT_NEAR(correlation(true), 0, 0.02);
}

TEST(Actor, ACenterIsTakenFromWhatIsGiven) {
  const Pool pool = pool_of("", 2);
  const rdm_spec spec = spec_of(pool.get());
  const Policy policy = policy_of(pool.get(), kEverySix);
  const size_t width = static_cast<size_t>(spec.action_dim);
  std::vector<float> center(width), action(2 * width), about(2 * width);
  EXPECT_EQ(rdm_pool_get_initial_mean(pool.get(), center.data()), RDM_OK);
  rdm_actor_config c = config_of(policy, &spec, 2);
  const rdm_buffers b = buffers_of(pool.get());
  EXPECT_EQ(rdm_actor_act(actor_of(c).get(), b.obs, nullptr, nullptr, action.data()), RDM_OK);
  c.center = center.data();
  EXPECT_EQ(rdm_actor_act(actor_of(c).get(), b.obs, nullptr, nullptr, about.data()), RDM_OK);
  for (size_t k = 0; k < action.size(); ++k) {
    EXPECT_EQ(about[k], action[k] - center[k % width]);
    EXPECT_NEAR(about[k] + center[k % width], action[k], 1.2e-7);
  }
}

TEST(Actor, AStateGoesOnWithTheSameBytes) {
  const Pool pool = pool_of("", 2);
  const rdm_spec spec = spec_of(pool.get());
  const Policy policy = policy_of(pool.get(), kEverySix);
  rdm_actor_config c = config_of(policy, &spec, 2);
  c.stochastic = 1;
  const Actor first = actor_of(c);
  c.seed = 9;
  const Actor second = actor_of(c);
  const rdm_buffers b = buffers_of(pool.get());
  const size_t width = static_cast<size_t>(2 * spec.action_dim);
  std::vector<float> mine(width), other(width);
  const uint8_t late[2] = {0, 1};
  const auto step = [&](const Actor& a, std::vector<float>& action) {
    EXPECT_EQ(rdm_actor_act(a.get(), b.obs, nullptr, nullptr, action.data()), RDM_OK);
  };
  for (int t = 0; t < 8; ++t) step(first, mine);
  EXPECT_EQ(rdm_actor_reset(first.get(), late, nullptr), RDM_OK);
  size_t size = 0;
  EXPECT_EQ(rdm_actor_write_state(first.get(), nullptr, 0, &size), RDM_OK);
  std::vector<unsigned char> bytes(size);
  EXPECT_EQ(rdm_actor_write_state(first.get(), bytes.data(), size - 1, &size), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_actor_write_state(first.get(), bytes.data(), size, &size), RDM_OK);
  EXPECT_EQ(rdm_actor_read_state(second.get(), bytes.data(), size), RDM_OK) << rdm_last_error();
  for (int t = 0; t < 15; ++t) {
    step(first, mine), step(second, other);
    EXPECT_EQ(mine, other) << t;
  }
  // whole, of this actor, and with numbers that an actor can have
  for (size_t cut = 0; cut < size; cut += 7)
    EXPECT_NE(rdm_actor_read_state(second.get(), bytes.data(), cut), RDM_OK);
  c.stochastic = 0;
  EXPECT_EQ(rdm_actor_read_state(actor_of(c).get(), bytes.data(), size), RDM_ERROR_FORMAT);
  c.num_envs = 1;
  EXPECT_EQ(rdm_actor_read_state(actor_of(c).get(), bytes.data(), size), RDM_ERROR_FORMAT);
  for (size_t i = 0; i < size; ++i) {
    auto wrong = bytes;
    wrong[i] = static_cast<unsigned char>(wrong[i] ^ 0x40);
    EXPECT_NE(rdm_actor_read_state(second.get(), wrong.data(), size), RDM_OK) << i;
  }
  step(first, mine), step(second, other);
  EXPECT_EQ(mine, other);
}

TEST(Actor, MemoryIsAskedForOnceAsItSaysAndAllOfItGoesBack) {
  const Pool pool = pool_of("", 2);
  const rdm_spec spec = spec_of(pool.get());
  const Policy policy = policy_of(pool.get(), kEverySix);
  for (const int32_t stochastic : {0, 1}) {
    CountingHost host;
    rdm_actor_config c = config_of(policy, &spec, 2);
    c.stochastic = stochastic;
    c.host = &host.hooks;
    size_t bytes = 0;
    ASSERT_EQ(rdm_actor_config_memory(&c, &bytes), RDM_OK);
    {
      const Actor actor = actor_of(c);
      EXPECT_EQ(host.live, bytes);
      const size_t calls = host.calls;
      const rdm_buffers b = buffers_of(pool.get());
      const int64_t heap = heap_count();
      for (int t = 0; t < 20; ++t) rdm_actor_act(actor.get(), b.obs, nullptr, nullptr, b.action);
      rdm_actor_reset(actor.get(), b.terminated, b.truncated);
      EXPECT_EQ(heap_count(), heap);  // always 0 where the heap is not counted
      EXPECT_EQ(host.calls, calls);
    }
    EXPECT_EQ(host.live, 0u);
    const size_t calls = host.calls;
    for (size_t i = 0; i < calls; ++i) {
      host.calls = 0;
      host.refuse_at = i;
      rdm_actor* a = nullptr;
      if (rdm_actor_create(&a, &c) == RDM_OK) break;
      EXPECT_EQ(host.live, 0u);
      EXPECT_NE(std::strstr(rdm_last_error(), "memory"), nullptr);
    }
  }
}

TEST(RedmanActorHpp, APolicyPlaysAPool) {
  redman::Pool pool(redman::pool_config("hand_over_safe_finger", 2));
  pool.reset();
  redman::Agent agent(redman::agent_config(pool));
  const redman::Policy policy(agent.policy());
  redman::Actor actor(redman::actor_config(policy, pool));
  actor.act(pool);
  const std::vector<float> first(pool.action()[0].begin(), pool.action()[0].end());
  pool.step();
  const redman::Bytes state = actor.state();
  actor.act(pool);
  EXPECT_TRUE(std::equal(first.begin(), first.end(), pool.action()[0].begin()));
  actor.reset();
  actor.act(pool);
  EXPECT_FALSE(std::equal(first.begin(), first.end(), pool.action()[0].begin()));
  actor.set_state(state);
  actor.act(pool);
  EXPECT_TRUE(std::equal(first.begin(), first.end(), pool.action()[0].begin()));
}

}  // namespace
