// Bullet-Safety-Gym's CarRun with a kinematic bicycle in the place of the race car: the wheels' motors pull
// the speed v to 6 a0 m/s, the front wheels stand at d = 0.5 a1 rad,
//   x' = v cos yaw, y' = v sin yaw, yaw' = v tan(d) / 0.975 m,
// in four steps of 1/240 s. An upper bound on the original, not a copy. run_track.hpp has reward and cost.
#include <algorithm>
#include <iterator>

#include "base/elementary.hpp"
#include "tasks/catalog.hpp"
#include "tasks/planar/planar_learner.hpp"
#include "tasks/planar/run_track.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kControlDt = 1.0 / 60;
constexpr int kSubsteps = 4;
constexpr double kStep = kControlDt / kSubsteps;   // s
constexpr double kTopSpeed = 6;                    // m/s: 40 rad/s on wheels of 0.15 m
constexpr double kAcceleration = 20 / 0.15 / 5.9;  // m/s2: 20 N m at the wheels, 5.9 kg
constexpr double kSteer = 0.5;                     // rad
constexpr double kWheelbase = 0.975;               // m
constexpr Vec3 kChassis{0.6, 0.25, 0.1};           // m, half sizes in pictures
constexpr double kHeight = 0.2;                    // m

struct State {
  double x, y, yaw, speed, rate;  // m, rad, m/s, rad/s
  double gain;
};

class CarRun final : public PlanarTask {
 public:
  explicit CarRun(const Options& o)
      : PlanarTask(
            PlanarScene(kControlDt)
                .body("car", ShapeKind::kBox, kChassis, kMarkBlue)
                .shape("nose", ShapeKind::kBox, {0.1, 0.2, 0.12}, kMarkYellow, {{kChassis.x, 0, 0}, {}})
                .also([&](PlanarScene& s) { add_track(track_from(o), s); })
                .build(),
            o.integer("max_steps"),
            {{"position", "10 m", 2},
             {"velocity", "m/s", 2},
             {"heading", "1", 2, -1, 1},
             {"turn_rate", "10 rad/s", 1}}),
        track_(track_from(o)) {}

  int32_t action_dim() const override { return 2; }
  const char* action_order() const override { return "speed, steering"; }
  size_t state_bytes() const override { return sizeof(State); }
  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    const double values[] = {s.x, s.y, s.yaw, s.speed, s.rate, s.gain};
    check_numbers("car", values, std::size(values));
  }

  void reset(World& world, void* state, Stream& stream) const override {
    State& s = *static_cast<State*>(state);
    s.x = kTrackNoise * stream.signed_unit();
    s.y = kTrackNoise * stream.signed_unit();
    place(world, s);
  }

  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    const double before = track_distance(s.x, s.y);
    const elementary::SinCos steer = elementary::sincos(kSteer * static_cast<double>(action[1]));
    const double curvature = steer.sin / steer.cos / kWheelbase;
    const double wanted = kTopSpeed * static_cast<double>(action[0]);
    for (int i = 0; i < kSubsteps; ++i) {
      s.speed += std::clamp(wanted - s.speed, -kAcceleration * kStep, kAcceleration * kStep);
      s.rate = s.speed * curvature;
      s.yaw += kStep * s.rate;
      const elementary::SinCos heading = elementary::sincos(s.yaw);
      s.x += kStep * s.speed * heading.cos;
      s.y += kStep * s.speed * heading.sin;
    }
    s.gain = before - track_distance(s.x, s.y);
    place(world, s);
  }

  Verdict judge(World&, void* state, int32_t) const override {
    const State& s = *static_cast<State*>(state);
    return judge_run(track_, {s.x, s.y, std::fabs(s.speed)}, s.gain, 0);
  }

  void observe(const World&, const void* state, float* obs) const override {
    const State& s = *static_cast<const State*>(state);
    const elementary::SinCos heading = elementary::sincos(s.yaw);
    const double row[] = {0.1 * s.x,   0.1 * s.y,   s.speed * heading.cos, s.speed * heading.sin,
                          heading.sin, heading.cos, 0.1 * s.rate};
    for (const double value : row) *obs++ = static_cast<float>(value);
  }

 private:
  static void place(World& world, const State& s) {
    const elementary::SinCos heading = elementary::sincos(s.yaw);
    world.set_body(
        0, planar_motion({s.x, s.y, kHeight}, s.yaw, s.speed * heading.cos, s.speed * heading.sin, s.rate));
  }
  RunTrack track_;
};

constexpr auto kOptions = track_options(1.5, 11, 500);
constexpr auto kDefaults = join_defaults(kSafetyLearner, {{"horizon", "250"},
                                                          {"learning_rate", "3e-4"},
                                                          {"minibatches", "32"},
                                                          {"discount", "0.95"},
                                                          {"init_std", "0.05"},
                                                          {"std_min", "0.01"},
                                                          {"multiplier_init", "1"},
                                                          {"p3o:penalty", "60"},
                                                          {"p3o:penalty_max", "60"},
                                                          {"ipo:barrier_kappa", "20"},
                                                          {"multiplier_lr", "0.2"}});

}  // namespace

constinit const TaskInfo kCarRun = task_info<CarRun, kRunCosts, kRunCameras, kDefaults>(
    "car_run", "CarRun",
    "a kinematic bicycle in the place of a race car runs along x; cost: faster than 1.5 m/s, or outside its "
    "lane",
    &constant_options<kOptions>);

}  // namespace rdm
