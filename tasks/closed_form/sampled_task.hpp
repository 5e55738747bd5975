// A task of few action entries that draws its own noise: a step is settled when the action is taken, the
// verdict only tells it. State is plain, with members noise, reward and cost.
#pragma once
#include <utility>

#include "tasks/planar/planar_scene.hpp"

namespace rdm {

template <class State, int32_t kEntries = 1>
class SampledTask : public PlanarTask {
 public:
  int32_t action_dim() const override { return kEntries; }
  size_t state_bytes() const override { return sizeof(State); }

  void reset(World& world, void* state, Stream& stream) const override {
    State& s = *static_cast<State*>(state);
    s.noise = Stream(stream.next(), 0, Purpose::kWorldNoise);
    start(&s);
    place(world, s);
  }

  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    take(action, &s);
    place(world, s);
  }

  Verdict judge(World&, void* state, int32_t) const override {
    const State& s = *static_cast<const State*>(state);
    Verdict v;
    v.reward = s.reward;
    v.cost[0] = v.cost_raw[0] = s.cost;
    judge_place(s, &v);
    return v;
  }

 protected:
  SampledTask(Scene&& scene, int32_t max_steps, std::initializer_list<FieldSpec> fields)
      : PlanarTask(std::move(scene), max_steps, fields) {}
  // A new episode of a zeroed state.
  virtual void start(State* state) const = 0;
  // The action [kEntries] in [-1, 1]: reward, cost, the next place.
  virtual void take(const float* action, State* state) const = 0;
  // Success and end.
  virtual void judge_place(const State& state, Verdict* verdict) const = 0;
  // The body for pictures.
  virtual void place(World& world, const State& state) const = 0;
};

// On bodies between -1 and 1.
inline constexpr CameraSpec kSampledCameras[] = {
    {"front", {0, -4, 2.5}, {0, 0, 0}, 0.8},
    {"top", {0, -0.01, 5}, {0, 0, 0}, 0.8},
};

}  // namespace rdm
