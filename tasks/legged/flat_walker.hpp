// MuJoCo's walkers in a plane, Hopper and Walker2d: a torso that slides along x and z and turns about y, legs
// with motors on hinges about -y.
//
//   r = vx + 1 - 1e-3 |a|^2     vx: mean speed of the torso's joint along x over the step, m/s
//   c = [vx > speed_limit]
//
// The episode ends when the torso is lower, higher or turned further than it may be. Observed are all joint
// coordinates but x, then all rates, cut at +-10. walker_scene.hpp says what differs from MuJoCo.
#pragma once
#include "base/option_rows.hpp"
#include "tasks/legged/walker_scene.hpp"

namespace rdm {

inline constexpr double kTorsoHeight = 1.25;  // m, of the root joint at q = 0
inline constexpr double kFlatStep = 0.001;    // s
inline constexpr int32_t kFlatSubsteps = 8, kFlatRoot = 3, kMaxFlatMotors = 6;

struct FlatLimits {
  double lowest, highest, tilt;  // m, m, rad
  double state;                  // of any coordinate but x, and any rate
};

struct FlatOptions {
  double speed_limit, effort_weight, healthy_reward, reset_noise;
  int32_t max_steps;
};
consteval auto flat_rows(double speed_limit) {
  return option_rows<FlatOptions>(
      row<&FlatOptions::speed_limit>(basic(number_option("speed_limit", speed_limit, 0, 100,
                                                         "speed along x above which a step costs 1, m/s"))),
      row<&FlatOptions::effort_weight>(
          basic(number_option("effort_weight", 1e-3, 0, 10, "weight of the squared action in the reward"))),
      row<&FlatOptions::healthy_reward>(basic(
          number_option("healthy_reward", 1, 0, 100,
                        "reward for each control step in which the robot is healthy (has not fallen)"))),
      row<&FlatOptions::reset_noise>(number_option(
          "reset_noise", 5e-3, 0, 0.1,
          "half width of the uniform noise on start positions (m, rad) and velocities (m/s, rad/s)")),
      row<&FlatOptions::max_steps>(
          basic(integer_option("max_steps", 1000, 1, 100000, "number of control steps in an episode"))));
}

class FlatWalker : public PlanarTask {
 public:
  EngineKind engine() const override { return EngineKind::kArticulated; }
  int32_t action_dim() const override { return motors_; }
  const char* action_order() const override { return order_; }
  size_t state_bytes() const override;
  void check_state(const void* state) const override;
  void reset(World& world, void* state, Stream& stream) const override;
  void control(World& world, void* state, const float* action) const override;
  Verdict judge(World& world, void* state, int32_t step) const override;
  void observe(const World& world, const void* state, float* obs) const override;

 protected:
  // `order` names the motors, static; motor i moves link kFlatRoot + i.
  FlatWalker(Scene&& scene, const FlatOptions& options, const FlatLimits& limits, const char* order);

 private:
  FlatLimits limits_;
  const char* order_;
  int32_t motors_;
  FlatOptions options_;
};

// A scene with the root joints and the torso; legs are added to its articulation 0.
PlanarScene flat_scene(const char* name, double limb_mu, double foot_mu);
// Thigh, leg and foot of one leg below the torso, the foot from heel to toe along x, m.
struct FlatLeg {
  const char *thigh, *leg, *foot;
  double heel, toe, damping, armature, gear;
  int32_t foot_material;
  Color color;
};
void add_flat_leg(const FlatLeg& leg, PlanarScene& scene);

inline constexpr CostSpec kFlatCosts[] = {
    {"cost", "1 if the robot is above the speed limit; raw: its speed along x, m/s", 25}};
inline constexpr CameraSpec kFlatCameras[] = {
    {"front", {2, -6, 1.8}, {2, 0, 0.8}, 0.9},
    {"top", {2, -4, 6}, {2, 0, 0.6}, 0.9},
};

}  // namespace rdm
