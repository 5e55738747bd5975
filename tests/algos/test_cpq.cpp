// CPQ: each step of all its networks against the same in double, and what its model of actions tells apart.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "offline_oracle.hpp"

namespace rdm::test {
namespace {

constexpr size_t kBatch = 10, kObs = 3, kAction = 2, kLatent = 2 * kAction;
constexpr double kRate = 1e-2, kTau = 0.2, kLiftRate = 3, kLiftMax = 4;

// tanh(m + std z) of the actor's head, z [kAction] from one at.
Numbers sampled(const PlainNet& actor, const Numbers& obs, const Numbers& z, size_t at) {
  const Numbers y = actor(obs);
  Numbers a(kAction);
  for (size_t j = 0; j < kAction; ++j) a[j] = std::tanh(y[j] + std::exp(y[kAction + j]) * z[at + j]);
  return a;
}

struct Branches {
  int safe = 0, unsafe = 0, lifted = 0;
};

// Six steps, with rows and noise by the same streams.
void compare(const char* cost_limit, Branches& branches) {
  const Recorded r = noise(12, kObs, kAction);
  AgentSetup s = step_by_step(
      "cpq", kObs, kAction, "10",
      {{"outside", "0.5", 0}, {"lift_lr", "3", 0}, {"lift_max", "4", 0}, {"cost_limit", cost_limit, 0}});
  const AgentPtr a = s.make();
  a->learn(r.rows(), 0);
  PlainNet actor = net_of(*a, "actor"), encoder = net_of(*a, "action_encoder"),
           decoder = net_of(*a, "action_decoder");
  PlainCritics q = critics_of(*a);
  PlainCritics slow = q;
  PlainAdam actor_adam, encoder_adam, decoder_adam, adam[4];
  double lift = 0;
  const double limit = as_value(std::strtod(cost_limit, nullptr), r, 0.9);
  const Replay& m = memory_of(*a);
  Stream draws(s.config.seed, 1 << 20, Purpose::kMinibatch),
      noise(s.config.seed, (1 << 20) + 1, Purpose::kMinibatch);
  for (int step = 0; step < 6; ++step) {
    int32_t rows[kBatch];
    m.draw(draws, kBatch, rows);
    std::vector<Numbers> obs(kBatch), taken(kBatch), both(kBatch);
    for (size_t i = 0; i < kBatch; ++i) {
      obs[i] = numbers(m.obs(rows[i]), kObs), taken[i] = numbers(m.action(rows[i]), kAction);
      both[i] = joined(obs[i], taken[i]);
    }
    Numbers z = normals(noise, kBatch * kAction), target[2];
    for (size_t i = 0; i < kBatch; ++i) {
      const Numbers next = numbers(m.next_obs(rows[i]), kObs),
                    x = joined(next, sampled(actor, next, z, i * kAction));
      const auto d = static_cast<double>(m.discount(rows[i]));
      const double cost = larger(slow[2], slow[3], x), value = std::min(slow[0](x)[0], slow[1](x)[0]);
      target[0].push_back(static_cast<double>(m.reward(rows[i])) +
                          d * (cost <= limit ? value : std::min(value, 0.0)));
      target[1].push_back(static_cast<double>(m.cost(rows[i])[0]) + d * std::max(cost, 0.0));
    }
    // The model of actions.
    z = normals(noise, kBatch * kLatent);
    const auto model_loss = [&] { return model_loss_of(encoder, decoder, obs, taken, z); };
    const Numbers encoder_slope = differences(encoder.p, model_loss),
                  decoder_slope = differences(decoder.p, model_loss);
    // Actions of the policy that are outside.
    Numbers inside;
    for (const Numbers& x : both) inside.push_back(kl_of(encoder(x)));
    std::sort(inside.begin(), inside.end());
    z = normals(noise, kBatch * kAction);
    std::vector<Numbers> outside;
    for (size_t i = 0; i < kBatch; ++i) {
      const Numbers x = joined(obs[i], sampled(actor, obs[i], z, i * kAction));
      if (kl_of(encoder(x)) > inside[kBatch / 2]) outside.push_back(x);
    }
    double mean_outside = 0;
    for (const Numbers& x : outside)
      mean_outside += (q[2](x)[0] + q[3](x)[0]) / 2 / static_cast<double>(outside.size());
    for (int net = 0; net < 4; ++net) {
      const Numbers g = differences(q[net].p, [&] {
        double sum = 0;
        for (size_t i = 0; i < kBatch; ++i)
          sum += std::pow(q[net](both[i])[0] - target[net / 2][i], 2) / kBatch;
        if (net >= 2)
          for (const Numbers& x : outside) sum -= lift * q[net](x)[0] / kBatch;
        return sum;
      });
      adam[net].step(q[net].p, g, kRate);
      for (size_t i = 0; i < g.size(); ++i) slow[net].p[i] += kTau * (q[net].p[i] - slow[net].p[i]);
    }
    encoder_adam.step(encoder.p, encoder_slope, kRate);
    decoder_adam.step(decoder.p, decoder_slope, kRate);
    branches.lifted += lift > 0 && !outside.empty();
    if (!outside.empty()) lift = std::clamp(lift + kLiftRate * (limit - mean_outside), 0.0, kLiftMax);
    // The policy.
    z = normals(noise, kBatch * kAction);
    const auto now_at = [&](size_t i) { return joined(obs[i], sampled(actor, obs[i], z, i * kAction)); };
    bool safe[kBatch];
    for (size_t i = 0; i < kBatch; ++i) safe[i] = larger(q[2], q[3], now_at(i)) <= limit;
    for (const bool is : safe) ++(is ? branches.safe : branches.unsafe);
    double scale = 0;
    for (size_t i = 0; i < kBatch; ++i) scale += std::abs(q[0](now_at(i))[0]) / kBatch;
    const Numbers g = differences(actor.p, [&] {
      double sum = 0;
      for (size_t i = 0; i < kBatch; ++i) {
        const Numbers x = now_at(i);
        sum -= safe[i] ? std::min(q[0](x)[0], q[1](x)[0]) / scale / kBatch
                       : -std::max(q[2](x)[0], q[3](x)[0]) / limit / kBatch;
      }
      return sum;
    });
    actor_adam.step(actor.p, g, kRate);
    a->learn(r.rows(), 1);
    SCOPED_TRACE("step " + std::to_string(step));
    expect_critics(*a, q, 3e-4);
    expect_nets(*a, {{"actor", &actor}, {"action_encoder", &encoder}, {"action_decoder", &decoder}}, 3e-4);
    ASSERT_FALSE(::testing::Test::HasFailure());
  }
}

}  // namespace

TEST(Cpq, StepsAreThoseInDouble) {
  Branches taken;
  for (const char* cost_limit : {"0.1", "0.3", "1"}) compare(cost_limit, taken);
  EXPECT_GT(taken.safe, 10);
  EXPECT_GT(taken.unsafe, 10);
  EXPECT_GT(taken.lifted, 5);
}

// Actions near 0.5 are recorded: those near -0.5 are far from N(0, 1), recorded ones are not.
TEST(Cpq, ItsModelTellsOtherActionsApart) {
  Recorded r = noise(60, kObs, kAction);
  for (float& v : r.action) v = 0.5f + 0.1f * v;
  AgentSetup s("cpq", kObs, kAction, 1,
               {{"hidden", "16", 0},
                {"activation", "tanh", 0},
                {"replay_rows", "600", 0},
                {"batch_rows", "32", 0},
                {"learning_rate", "3e-3", 0},
                {"normalize_obs", "off", 0}});
  s.config.max_steps = 12;
  const AgentPtr a = s.make();
  a->learn(r.rows(), 1500);
  const PlainNet encoder = net_of(*a, "action_encoder");
  double recorded = 0, other = 0;
  for (size_t i = 0; i < r.reward.size(); ++i) {
    const Numbers obs = numbers(r.obs.data() + i * kObs, kObs);
    recorded += kl_of(encoder(joined(obs, numbers(r.action.data() + i * kAction, kAction))));
    other += kl_of(encoder(joined(obs, {-0.5, -0.5})));
  }
  EXPECT_GT(other, 3 * recorded);
}

}  // namespace rdm::test
