// The numbers of a frozen policy, read through the C ABI: they are enough to compute its actions again.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>

#include "contract.hpp"
#include "written.hpp"

namespace {

using Tensors = std::map<std::string, std::vector<float>>;

struct Loaded {
  explicit Loaded(const std::vector<rdm_option>& options) {
    rdm_agent_config c = agent_config();
    c.obs_dim = 5;
    c.action_dim = 3;
    c.num_envs = 4;
    c.algo = "ppo";
    c.options = options.data();
    c.num_options = static_cast<int32_t>(options.size());
    rdm_agent* a = nullptr;
    EXPECT_EQ(rdm_agent_create(&a, &c), RDM_OK) << rdm_last_error();
    // observations that move the normaliser off its start
    std::vector<float> obs(20), action(12), reward(4, 1), cost(4, 0);
    rdm_transition t{};
    t.struct_size = sizeof t;
    t.reward = reward.data();
    t.cost = cost.data();
    for (int step = 0; step < 4; ++step) {
      for (size_t i = 0; i < obs.size(); ++i)
        obs[i] = 3 + std::sin(static_cast<float>(7 * i) + static_cast<float>(step));
      EXPECT_EQ(rdm_agent_act(a, obs.data(), RDM_ACT_SAMPLE, action.data()), RDM_OK);
      EXPECT_EQ(rdm_agent_record(a, &t), RDM_OK) << rdm_agent_error(a);
    }
    EXPECT_EQ(rdm_agent_update(a, obs.data(), nullptr), RDM_OK) << rdm_agent_error(a);
    const auto bytes = written_bytes(
        [&](void* out, size_t n, size_t* size) { return rdm_agent_write_policy(a, out, n, size); });
    rdm_agent_destroy(a);
    EXPECT_EQ(rdm_policy_read(&policy, bytes.data(), bytes.size()), RDM_OK) << rdm_last_error();
    rdm_tensor tensor;
    for (int32_t i = 0; rdm_policy_tensor_at(policy, i, &tensor) == RDM_OK; ++i) {
      auto& values = tensors[tensor.name];
      values.resize(static_cast<size_t>(tensor.rows) * static_cast<size_t>(tensor.cols));
      EXPECT_EQ(rdm_policy_get_tensor(policy, tensor.name, values.data(), values.size()), RDM_OK);
    }
    info.struct_size = sizeof info;
    EXPECT_EQ(rdm_policy_get_info(policy, &info), RDM_OK);
  }
  ~Loaded() { rdm_policy_destroy(policy); }

  // The mean action, in double, from the tensors alone.
  std::vector<double> act(const std::vector<float>& obs) {
    std::vector<double> x(obs.begin(), obs.end());
    if (tensors.count("normalizer.shift"))
      for (size_t i = 0; i < x.size(); ++i) {
        const double clip = tensors["normalizer.clip"][0];
        x[i] =
            std::clamp((x[i] - tensors["normalizer.shift"][i]) * tensors["normalizer.scale"][i], -clip, clip);
      }
    for (int l = 0; tensors.count(name(l, "weight")); ++l) {
      const auto &w = tensors[name(l, "weight")], &b = tensors[name(l, "bias")];
      std::vector<double> y(b.begin(), b.end());
      for (size_t o = 0; o < y.size(); ++o)
        for (size_t i = 0; i < x.size(); ++i) y[o] += static_cast<double>(w[o * x.size() + i]) * x[i];
      if (tensors.count(name(l + 1, "weight")))
        for (double& v : y) v = activate(v);
      x = y;
    }
    for (double& v : x) v = std::clamp(v, -1.0, 1.0);
    return x;
  }

  rdm_policy* policy = nullptr;
  rdm_policy_info info{};
  Tensors tensors;

 private:
  static std::string name(int layer, const char* what) {
    return "actor." + std::to_string(layer) + "." + what;
  }
  double activate(double v) const {
    const std::string a = info.activation;
    if (a == "tanh") return std::tanh(v);
    if (a == "elu") return v > 0 ? v : std::expm1(v);
    return std::max(v, 0.0);
  }
};

class PolicyTensors : public testing::TestWithParam<const char*> {};

TEST_P(PolicyTensors, AreTheWholePolicy) {
  Loaded p({{"hidden", "8,6", 0},
            {"activation", GetParam(), 0},
            {"horizon", nullptr, 4},
            {"minibatches", nullptr, 1}});
  EXPECT_STREQ(p.info.activation, GetParam());
  EXPECT_EQ(p.tensors["actor.0.weight"].size(), 40u);
  EXPECT_EQ(p.tensors["actor.2.bias"].size(), 3u);
  EXPECT_EQ(p.tensors["actor.log_std"].size(), 3u);
  EXPECT_NE(p.tensors["normalizer.shift"][0], 0);
  size_t count = 0;
  for (const auto& [key, values] : p.tensors)
    if (key.find("weight") != std::string::npos || key.find("bias") != std::string::npos)
      count += values.size();
  EXPECT_EQ(count, p.info.num_params);

  std::vector<unsigned char> scratch(rdm_policy_scratch(p.policy, 1));
  for (int k = 0; k < 50; ++k) {
    std::vector<float> obs(5), action(3);
    for (size_t i = 0; i < 5; ++i)
      obs[i] = 3 + 2 * std::sin(static_cast<float>(k) * 1.7f + static_cast<float>(3 * i));
    ASSERT_EQ(rdm_policy_act(p.policy, obs.data(), 1, nullptr, action.data(), scratch.data(), scratch.size()),
              RDM_OK);
    const auto want = p.act(obs);
    for (size_t j = 0; j < 3; ++j) EXPECT_NEAR(action[j], want[j], 1e-6);
  }
  const auto want = p.act(p.tensors["example.obs"]);
  for (size_t j = 0; j < 3; ++j) EXPECT_NEAR(p.tensors["example.action"][j], want[j], 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Activations, PolicyTensors, testing::Values("tanh", "elu", "relu"));

TEST(PolicyTensorList, DeviationsOfTheStateAreTheLastOutputs) {
  Loaded p({{"std_mode", "state", 0}, {"hidden", "8", 0}, {"horizon", nullptr, 4}, {"std_max", nullptr, 2}});
  EXPECT_EQ(p.info.action_dim, 3);
  EXPECT_EQ(p.tensors.count("actor.log_std"), 0u);
  EXPECT_EQ(p.tensors["actor.1.bias"].size(), 6u);
  ASSERT_EQ(p.tensors["actor.log_std_bounds"].size(), 2u);
  EXPECT_FLOAT_EQ(p.tensors["actor.log_std_bounds"][1], std::log(2.0f));
  const auto y = p.act(p.tensors["example.obs"]);
  for (size_t j = 0; j < 3; ++j) EXPECT_NEAR(p.tensors["example.action"][j], y[j], 1e-6);
}

TEST(PolicyTensorList, BadQuestionsGetAnswers) {
  Loaded p({{"horizon", nullptr, 4}, {"minibatches", nullptr, 1}});
  rdm_tensor t;
  float x[5];
  EXPECT_EQ(rdm_policy_tensor_at(nullptr, 0, &t), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_tensor_at(p.policy, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_tensor_at(p.policy, -1, &t), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_policy_tensor_at(p.policy, 1000, &t), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_policy_get_tensor(nullptr, "example.obs", x, 5), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_get_tensor(p.policy, nullptr, x, 5), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_get_tensor(p.policy, "example.obs", nullptr, 5), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_get_tensor(p.policy, "example.obs", x, 4), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_policy_get_tensor(p.policy, "example.ob", x, 5), RDM_ERROR_NOT_FOUND);
  EXPECT_NE(std::string(rdm_last_error()).find("example.obs"), std::string::npos);
}

TEST(PolicyTensorList, AnOlderCallersInfoIsNotOverrun) {
  Loaded p({{"horizon", nullptr, 4}, {"minibatches", nullptr, 1}});
  rdm_policy_info info{};
  info.struct_size = offsetof(rdm_policy_info, activation);  // the struct as the first version had it
  info.activation = "mine";
  ASSERT_EQ(rdm_policy_get_info(p.policy, &info), RDM_OK);
  EXPECT_EQ(info.obs_dim, 5);
  EXPECT_STREQ(info.activation, "mine");
}

}  // namespace
