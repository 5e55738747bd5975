// Gradient steps of SAC and TD3 with a limit beside the same in double: rows and noise from the same streams, targets,
// critics, the actor's loss by differences, the temperature. Rows come as they do from worlds.
#include <cmath>

#include "algos/off_policy/sac.hpp"
#include "nn/squash.hpp"
#include "offline_oracle.hpp"
#include "oracle_squash.hpp"

namespace rdm::test {
namespace {

constexpr size_t kObs = 3, kAct = 2, kBatch = 12;
constexpr double kRate = 1e-2, kTau = 0.2, kWeight = 0.6;

// Epochs of 40 decisions of one world, a gradient step in each.
AgentSetup one_step_an_epoch(const char* algo) {
  AgentSetup s = step_by_step(algo, kObs, kAct, "12",
                              {{"horizon", "40", 0},
                               {"start_steps", "0", 0},
                               {"updates_per_step", "0.025", 0},
                               {"cost_limit", "1", 0},
                               {"multiplier_init", "0.6", 0},
                               {"multiplier_lr", "0", 0}});
  s.config.seed = 7;
  return s;
}

// What both have in common; a policy says what its actions are.
struct Plain {
  Agent& agent;
  const Replay& memory;
  Stream draws, noise;
  PlainNet actor, q[4], slow[4];
  PlainAdam actor_adam, adam[4];
  std::vector<int32_t> rows = std::vector<int32_t>(kBatch);

  explicit Plain(Agent& a, uint64_t seed)
      : agent(a),
        memory(static_cast<ReplayAgent&>(a).replay()),
        draws(seed, 1 << 20, Purpose::kMinibatch),
        noise(seed, (1 << 20) + 1, Purpose::kMinibatch),
        actor(net_of(a, "actor")) {
    const char* const names[] = {"reward_q1", "reward_q2", "cost0_q1", "cost0_q2"};
    for (int net = 0; net < 4; ++net) q[net] = slow[net] = net_of(a, names[net]);
  }
  Numbers normals() {
    std::vector<float> z(kBatch * kAct);
    noise.normals(z.data(), static_cast<int>(z.size()));
    return Numbers(z.begin(), z.end());
  }
  Numbers obs(size_t k) const { return numbers(memory.obs(rows[k]), kObs); }
  Numbers next_obs(size_t k) const { return numbers(memory.next_obs(rows[k]), kObs); }
  // next(k): the next action of row k, and what is added to the reward's next value.
  template <class Next>
  void step_critics(Next&& next) {
    memory.draw(draws, kBatch, rows.data());
    Numbers y[2];
    for (size_t k = 0; k < kBatch; ++k) {
      const auto [action, bonus] = next(k);
      const Numbers x = joined(next_obs(k), action);
      const auto d = static_cast<double>(memory.discount(rows[k]));
      y[0].push_back(static_cast<double>(memory.reward(rows[k])) +
                     d * (std::min(slow[0](x)[0], slow[1](x)[0]) + bonus));
      y[1].push_back(static_cast<double>(memory.cost(rows[k])[0]) +
                     d * std::max({slow[2](x)[0], slow[3](x)[0], 0.0}));
    }
    for (int net = 0; net < 4; ++net) {
      const Numbers g = differences(q[net].p, [&] {
        double sum = 0;
        for (size_t k = 0; k < kBatch; ++k) {
          const double e = q[net](joined(obs(k), numbers(memory.action(rows[k]), kAct)))[0] - y[net / 2][k];
          sum += e * e / kBatch;
        }
        return sum;
      });
      const float* const found = static_cast<OffPolicy&>(agent).critics().gradient(net);
      for (size_t i = 0; i < g.size(); ++i)
        EXPECT_NEAR(static_cast<double>(found[i]), g[i], 1e-5) << net << ' ' << i;
      adam[net].step(q[net].p, g, kRate);
      for (size_t i = 0; i < g.size(); ++i) slow[net].p[i] += kTau * (q[net].p[i] - slow[net].p[i]);
    }
  }
  // loss(k, row of critics): of row k.
  template <class Loss>
  void step_actor(Loss&& loss) {
    const Numbers g = differences(actor.p, [&] {
      double sum = 0;
      for (size_t k = 0; k < kBatch; ++k) sum += loss(k) / (kBatch * (1 + kWeight));
      return sum;
    });
    actor_adam.step(actor.p, g, kRate);
  }
  double cost_value(const Numbers& x) const { return kWeight * std::max(q[2](x)[0], q[3](x)[0]); }
  void compare() {
    expect_nets(agent,
                {{"actor", &actor},
                 {"reward_q1", &q[0]},
                 {"reward_q2", &q[1]},
                 {"cost0_q1", &q[2]},
                 {"cost0_q2", &q[3]}},
                1e-4);
  }
};

// An epoch whose rows are all valid.
void play(NoiseWorld& world, Agent& a) {
  Epoch e;
  while (a.missing() > 0) {
    a.act(world.obs(), true, world.action());
    world.draw();
    Transition t = world.transition();
    t.valid = nullptr;
    a.record(t);
  }
  a.update(world.obs(), &e);
  ASSERT_EQ(e.passes, 1);
}

}  // namespace

// log p and its slopes as SAC has them, d / dm = 2 a and d / d log std = 2 a std z - 1, beside torch's, whose
// softplus leaves out what is below 2e-9.
TEST(OffPolicySteps, SquashedNormalsAreTorchs) {
  for (const auto& [mean, log_std, z, log_prob, slope, std_slope] : oracle::kSquash) {
    const double std = std::exp(log_std), u = mean + std * z, a = std::tanh(u);
    const double found = -0.5 * z * z - log_std - 0.9189385332046727 - log_slope_of_tanh(u);
    EXPECT_NEAR(found, log_prob, 1e-7) << mean << ' ' << log_std << ' ' << z;
    EXPECT_NEAR(2 * a, slope, 1e-7) << mean << ' ' << log_std << ' ' << z;
    EXPECT_NEAR(2 * a * std * z - 1, std_slope, 1e-7) << mean << ' ' << log_std << ' ' << z;
  }
}

TEST(OffPolicySteps, SacLagIsThatInDouble) {
  AgentSetup s = one_step_an_epoch("sac_lag");
  s.with("temperature", "0.3").with("temperature_learning_rate", "0.05").with("target_entropy", "-0.7");
  s.with("std_min", "0.3").with("std_max", "1.2");  // both bounds are met
  const AgentPtr a = s.make();
  Plain plain(*a, s.config.seed);
  NoiseWorld world(s.config);
  double log_alpha = std::log(0.3);
  Numbers alpha_at = {log_alpha};
  PlainAdam alpha_adam;
  // Action and log probability at obs by the noise z: log pi = log N(u) - sum log(1 - tanh(u)^2).
  const auto sample = [&](const Numbers& obs, const double* z, Numbers* action) {
    const Numbers y = plain.actor(obs);
    action->assign(kAct, 0);
    double log_prob = 0;
    for (size_t j = 0; j < kAct; ++j) {
      const double std = std::exp(std::clamp(y[kAct + j], std::log(0.3), std::log(1.2)));
      const double u = y[j] + std * z[j], t = std::tanh(u);
      (*action)[j] = t;
      log_prob +=
          -0.5 * z[j] * z[j] - std::log(std) - 0.5 * std::log(2 * std::acos(-1.0)) - std::log(1 - t * t);
    }
    return log_prob;
  };
  for (int step = 0; step < 8 && !HasFailure(); ++step) {
    play(world, *a);
    const double alpha = std::exp(log_alpha);
    const Numbers next = plain.normals(), own = plain.normals();
    plain.step_critics([&](size_t k) {
      Numbers action;
      const double log_prob = sample(plain.next_obs(k), &next[k * kAct], &action);
      return std::pair(action, -alpha * log_prob);
    });
    double gap = 0;  // of the policy before its step
    for (size_t k = 0; k < kBatch; ++k) {
      Numbers action;
      gap += (sample(plain.obs(k), &own[k * kAct], &action) - 0.7 * kAct) / kBatch;
    }
    plain.step_actor([&](size_t k) {
      Numbers action;
      const double log_prob = sample(plain.obs(k), &own[k * kAct], &action);
      const Numbers x = joined(plain.obs(k), action);
      return alpha * log_prob - std::min(plain.q[0](x)[0], plain.q[1](x)[0]) + plain.cost_value(x);
    });
    alpha_at[0] = log_alpha;
    alpha_adam.step(alpha_at, {-gap}, 0.05);
    log_alpha = alpha_at[0];
    EXPECT_NEAR(static_cast<Sac&>(*a).temperature(), std::exp(log_alpha), 1e-6) << "step " << step;
    plain.compare();
  }
}

TEST(OffPolicySteps, Td3LagIsThatInDouble) {
  AgentSetup s = one_step_an_epoch("td3_lag");
  s.with("target_std", "0.3").with("target_clip", "0.25");
  const AgentPtr a = s.make();
  Plain plain(*a, s.config.seed);
  PlainNet slow_actor = plain.actor;
  NoiseWorld world(s.config);
  const auto acts = [](const PlainNet& net, const Numbers& x) { return with_tanh(net(x)); };
  for (int step = 1; step <= 8 && !HasFailure(); ++step) {
    play(world, *a);
    const Numbers z = plain.normals();
    plain.step_critics([&](size_t k) {
      Numbers action = acts(slow_actor, plain.next_obs(k));
      for (size_t j = 0; j < kAct; ++j)
        action[j] = std::clamp(action[j] + std::clamp(0.3 * z[k * kAct + j], -0.25, 0.25), -1.0, 1.0);
      return std::pair(action, 0.0);
    });
    if (step % 2 == 0) {  // policy_delay
      plain.step_actor([&](size_t k) {
        const Numbers x = joined(plain.obs(k), acts(plain.actor, plain.obs(k)));
        return plain.cost_value(x) - plain.q[0](x)[0];
      });
      for (size_t i = 0; i < slow_actor.p.size(); ++i)
        slow_actor.p[i] += kTau * (plain.actor.p[i] - slow_actor.p[i]);
    }
    plain.compare();
  }
}

}  // namespace rdm::test
