// bcq_lag: each step of all its networks against the same in double.
#include <algorithm>
#include <cmath>

#include "offline_oracle.hpp"

namespace rdm::test {
namespace {

constexpr size_t kBatch = 10, kObs = 3, kAction = 2, kLatent = 2 * kAction, kCandidates = 3;
constexpr double kRate = 1e-2, kTau = 0.2, kWeight = 0.6, kPerturb = 0.3;

// Latent vector z [kLatent] from one at, decoded and moved.
Numbers candidate(const PlainNet& decoder, const PlainNet& perturb, const Numbers& obs, const Numbers& z,
                  size_t at) {
  Numbers latent(kLatent);
  for (size_t j = 0; j < kLatent; ++j) latent[j] = std::clamp(z[at + j], -0.5, 0.5);
  Numbers a = with_tanh(decoder(joined(obs, latent)));
  const Numbers added = with_tanh(perturb(joined(obs, a)));
  for (size_t j = 0; j < kAction; ++j) a[j] = std::clamp(a[j] + kPerturb * added[j], -1.0, 1.0);
  return a;
}

}  // namespace

// Rows and noise are drawn by the same streams.
TEST(Bcq, StepsAreThoseInDouble) {
  const Recorded r = noise(12, kObs, kAction);
  AgentSetup s = step_by_step("bcq_lag", kObs, kAction, "10",
                              {{"candidates", "3", 0},
                               {"perturb", "0.3", 0},
                               {"multiplier_init", "0.6", 0},
                               {"multiplier_lr", "0", 0}});
  const AgentPtr a = s.make();
  a->learn(r.rows(), 0);
  PlainNet actor = net_of(*a, "actor"), encoder = net_of(*a, "action_encoder"),
           decoder = net_of(*a, "action_decoder"), perturb = net_of(*a, "perturb");
  PlainCritics q = critics_of(*a);
  PlainCritics slow = q;
  PlainAdam actor_adam, encoder_adam, decoder_adam, perturb_adam, adam[4];
  const Replay& m = memory_of(*a);
  Stream draws(s.config.seed, 1 << 20, Purpose::kMinibatch),
      noise(s.config.seed, (1 << 20) + 1, Purpose::kMinibatch);
  for (int step = 0; step < 6; ++step) {
    int32_t rows[kBatch];
    m.draw(draws, kBatch, rows);
    std::vector<Numbers> obs, next, taken, chosen(kBatch);
    for (const int32_t i : rows) {
      obs.push_back(numbers(m.obs(i), kObs)), next.push_back(numbers(m.next_obs(i), kObs));
      taken.push_back(numbers(m.action(i), kAction));
    }
    // The best of some candidates, the targets that it gives, and the actor's distance to it.
    Numbers best(kBatch, -1e9), target[2], z;
    for (size_t n = 0; n < kCandidates; ++n) {
      z = normals(noise, kBatch * kLatent);
      for (size_t i = 0; i < kBatch; ++i) {
        const Numbers now = candidate(decoder, perturb, next[i], z, i * kLatent), x = joined(next[i], now);
        const double worth = std::min(slow[0](x)[0], slow[1](x)[0]) - kWeight * larger(slow[2], slow[3], x);
        if (worth > best[i]) best[i] = worth, chosen[i] = now;
      }
    }
    for (size_t i = 0; i < kBatch; ++i) {
      const Numbers x = joined(next[i], chosen[i]);
      const auto d = static_cast<double>(m.discount(rows[i]));
      target[0].push_back(static_cast<double>(m.reward(rows[i])) +
                          d * std::min(slow[0](x)[0], slow[1](x)[0]));
      target[1].push_back(static_cast<double>(m.cost(rows[i])[0]) +
                          d * std::max(larger(slow[2], slow[3], x), 0.0));
    }
    const Numbers actor_slope = differences(actor.p, [&] {
      double sum = 0;
      for (size_t i = 0; i < kBatch; ++i) {
        const Numbers now = with_tanh(actor(next[i]));
        for (size_t j = 0; j < kAction; ++j) sum += std::pow(now[j] - chosen[i][j], 2) / (kBatch * kAction);
      }
      return sum;
    });
    z = normals(noise, kBatch * kLatent);
    const auto model_loss = [&] { return model_loss_of(encoder, decoder, obs, taken, z); };
    const Numbers encoder_slope = differences(encoder.p, model_loss),
                  decoder_slope = differences(decoder.p, model_loss);
    for (int net = 0; net < 4; ++net) {
      const Numbers g = differences(q[net].p, [&] {
        double sum = 0;
        for (size_t i = 0; i < kBatch; ++i)
          sum += std::pow(q[net](joined(obs[i], taken[i]))[0] - target[net / 2][i], 2) / kBatch;
        return sum;
      });
      adam[net].step(q[net].p, g, kRate);
      for (size_t i = 0; i < g.size(); ++i) slow[net].p[i] += kTau * (q[net].p[i] - slow[net].p[i]);
    }
    encoder_adam.step(encoder.p, encoder_slope, kRate);
    decoder_adam.step(decoder.p, decoder_slope, kRate);
    // What moves a candidate climbs.
    z = normals(noise, kBatch * kLatent);
    const Numbers perturb_slope = differences(perturb.p, [&] {
      double sum = 0;
      for (size_t i = 0; i < kBatch; ++i) {
        const Numbers x = joined(obs[i], candidate(decoder, perturb, obs[i], z, i * kLatent));
        sum -= (q[0](x)[0] - kWeight * larger(q[2], q[3], x)) / (kBatch * (1 + kWeight));
      }
      return sum;
    });
    perturb_adam.step(perturb.p, perturb_slope, kRate);
    actor_adam.step(actor.p, actor_slope, kRate);
    a->learn(r.rows(), 1);
    SCOPED_TRACE("step " + std::to_string(step));
    expect_critics(*a, q, 3e-4);
    expect_nets(*a,
                {{"actor", &actor},
                 {"perturb", &perturb},
                 {"action_encoder", &encoder},
                 {"action_decoder", &decoder}},
                3e-4);
    ASSERT_FALSE(HasFailure());
  }
}

}  // namespace rdm::test
