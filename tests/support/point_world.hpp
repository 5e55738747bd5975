// A world that can only be seen: an object stands somewhere on a table, the action is a guess of where, and
// an episode is one decision. The row has a robot's own numbers, which say nothing, and the object's place,
// which is for critics; the cloud has the object among points of the table.
#pragma once
#include "agents.hpp"

namespace rdm::test {

inline constexpr int32_t kWorldPoints = 24;
inline constexpr ObsField kWorldFields[] = {{"robot_joint_position", 0, 3}, {"object_position", 3, 2}};

class PointWorld {
 public:
  explicit PointWorld(int32_t envs, uint64_t seed = 1)
      : envs_(size_of(envs)), stream_(seed, 0, Purpose::kTest) {
    obs.resize(envs_ * 5), points.resize(envs_ * kWorldPoints * 3), point_class.resize(envs_ * kWorldPoints);
    action.resize(envs_ * 2), reward.resize(envs_), cost.resize(envs_), ended.assign(envs_, 1);
    draw();
  }
  static AgentSetup setup(const char* algo, int32_t envs, const char* encoder = "16,16") {
    AgentSetup s(algo, 5, 2, envs);
    s.config.fields = kWorldFields, s.config.num_fields = 2;
    s.config.max_steps = 1;
    s.with("encoder", encoder).with("encoder_points", "24").with("actor_obs", "vision");
    s.with("hidden", "32").with("horizon", "4").with("passes", "4").with("minibatches", "2");
    s.with("learning_rate", "3e-3").with("init_std", "0.3").with("cost_limit", "0.5");
    return s;
  }
  // Object and cloud of the next decision. Half of the points are the object's, of class 1.
  void draw() {
    for (size_t i = 0; i < envs_; ++i) {
      const float at[2] = {static_cast<float>(stream_.signed_unit()),
                           static_cast<float>(stream_.signed_unit())};
      for (size_t k = 0; k < 3; ++k) obs[i * 5 + k] = static_cast<float>(stream_.signed_unit());
      obs[i * 5 + 3] = at[0], obs[i * 5 + 4] = at[1];
      for (size_t p = 0; p < kWorldPoints; ++p) {
        float* x = &points[(i * kWorldPoints + p) * 3];
        const bool object = p % 2;
        for (size_t k = 0; k < 2; ++k)
          x[k] = 0.2f * (object ? at[k] : static_cast<float>(stream_.signed_unit())) +
                 0.01f * static_cast<float>(stream_.signed_unit());
        x[2] = object ? 0.2f : 0;
        point_class[i * kWorldPoints + p] = object;
      }
    }
  }
  PointRows clouds() const {
    PointRows r;
    r.metres = points.data(), r.classes = point_class.data();
    return r;
  }
  // Mean reward of the actions in place.
  double score() {
    double sum = 0;
    for (size_t i = 0; i < envs_; ++i) {
      const float x = action[2 * i] - obs[i * 5 + 3], y = action[2 * i + 1] - obs[i * 5 + 4];
      reward[i] = -(x * x + y * y);
      cost[i] = action[2 * i] > 0.9f;
      sum += static_cast<double>(reward[i]);
    }
    return sum / static_cast<double>(envs_);
  }
  void decide(Agent& a) {
    a.act(obs.data(), true, action.data(), a.eyes().points ? clouds() : PointRows{});
    score();
    draw();
    Transition t;
    t.reward = reward.data(), t.cost = cost.data(), t.terminated = ended.data();
    a.record(t);
  }
  void epoch(Agent& a, Epoch* out = nullptr) {
    while (a.missing() > 0) decide(a);
    a.update(obs.data(), out);
  }
  // Of the mean actions over some decisions.
  double judge(Agent& a, int decisions) {
    double sum = 0;
    for (int i = 0; i < decisions; ++i) {
      draw();
      a.act(obs.data(), false, action.data(), a.eyes().points ? clouds() : PointRows{});
      sum += score();
    }
    return sum / decisions;
  }

  std::vector<float> obs, points, action, reward, cost;
  std::vector<uint8_t> point_class, ended;

 private:
  size_t envs_;
  Stream stream_;
};

}  // namespace rdm::test
