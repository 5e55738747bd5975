// A net 2 -> 2 tanh -> 2 with two samples whose numbers were worked out in double by an independent script.
#pragma once
#include "learner_bench.hpp"

namespace rdm::test {

struct GoldenNet : Bench {
  static AgentSetup setup(const char* algo) {
    AgentSetup s(algo, 2, 2, 2);
    s.with("hidden", "2").with("horizon", "1").with("minibatches", "1").with("normalize_obs", "false");
    return s;
  }
  explicit GoldenNet(AgentSetup s = setup("cpo")) : Bench(std::move(s)) {
    const double theta[] = {-.2, .1, .5, -.3, .2, .4, .1, -.1, .7, -.6, .3, .9, .05, -.05};
    put(theta, nets.params);
    const float obs[] = {1, -.5f, .2f, .8f}, action[] = {.5f, -.2f, -.3f, .6f};
    std::copy_n(obs, 4, rollout.obs);
    std::copy_n(action, 4, rollout.action);
    for (size_t j = 0; j < 2; ++j) rollout.log_std[j] = nets.log_std()[j];
    for (size_t i = 0; i < 2; ++i) {
      const std::vector<double> m = network(params(), Networks::kActor, i);
      for (size_t j = 0; j < 2; ++j) rollout.mean[2 * i + j] = static_cast<float>(m[j]);
      rollout.log_prob[i] = static_cast<float>(log_prob(params(), i));
      rollout.linear[i] = 0;
    }
    rollout.gain[0] = 1, rollout.gain[1] = -.5f;
    rollout.cost_advantage[0] = .2f, rollout.cost_advantage[1] = .7f;
  }
  // The golden order (log_std, network) in the padded block of the actor, and back.
  void put(const double* x, float* block) const {
    for (size_t j = 0; j < 2; ++j) block[j] = static_cast<float>(x[j]);
    for (size_t j = 2; j < 14; ++j) block[nets.std_size + j - 2] = static_cast<float>(x[j]);
  }
  std::vector<double> get(const float* block) const {
    std::vector<double> x(block, block + 2);
    x.insert(x.end(), block + nets.std_size, block + nets.std_size + 12);
    return x;
  }
};

inline void expect_near(const std::vector<double>& got, const double* wanted, double tolerance) {
  for (size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], wanted[i], tolerance) << i;
}

inline constexpr double kGoldenG[] = {
    -0.2584994026, -0.2626401028, -0.0318034923, 0.0317513315,  -0.0894114637, -0.0543775718, -0.0177149720,
    -0.1774855114, -0.0283016040, 0.0201143145,  -0.0616770528, -0.0123096751, 0.0226113920,  -0.1913403666};
inline constexpr double kGoldenB[] = {
    -0.4345683017, -0.3910906157, -0.0119961066, -0.0161913662, 0.0173473263, 0.1300429619,  -0.0317200351,
    0.1406509931,  -0.0016181372, -0.0216885721, -0.0180062250, 0.0336088596, -0.0965862027, 0.1035778892};
inline constexpr double kGoldenV[] = {.3, -.2, .1, .4, -.5, .2, .3, -.1, .6, -.4, .2, .1, -.3, .5};
inline constexpr double kGoldenFv[] = {
    0.6,           -0.4,         0.2165132186,  -0.0130627099, -0.2213710926, 0.3035867227, 0.3011300181,
    -0.0499033803, 0.2925668526, -0.0377647527, -0.0034839289, 0.0691267474,  0.495534172,  0.2884270974};

}  // namespace rdm::test
