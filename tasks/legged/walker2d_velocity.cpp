// Safety-Gymnasium's Walker2dVelocity: walk along x, but slower than the limit. flat_walker.hpp has reward
// and cost.
#include <cmath>

#include "tasks/catalog.hpp"
#include "tasks/legged/flat_walker.hpp"
#include "tasks/legged/legged_learner.hpp"

namespace rdm {
namespace {

constexpr double kLimbMu = 0.9, kLeftFootMu = 1.9;  // the right foot rubs as the limbs do
constexpr MujocoContact kContact{0.9, 0.95, 0.001, 0};
constexpr FlatLeg kRight{"thigh", "leg", "foot", 0, 0.2, 0.1, 0.01, 100, kLimbMaterial, kMarkBlue},
    kLeft{"thigh_left", "leg_left", "foot_left", 0, 0.2, 0.1, 0.01, 100, kFootMaterial, kMarkCyan};

class Walker2dVelocity final : public FlatWalker {
 public:
  explicit Walker2dVelocity(const FlatOptions& o)
      : FlatWalker(make(), o, {0.8, 2, 1, HUGE_VAL}, "thigh, leg, foot, left thigh, left leg, left foot") {}

 private:
  static Scene make() {
    PlanarScene scene = flat_scene("walker", kLimbMu, kLeftFootMu);
    add_flat_leg(kRight, scene);
    add_flat_leg(kLeft, scene);
    soften(kContact, scene);
    return scene.build();
  }
};

constexpr auto kRows = flat_rows(2.3415);

}  // namespace

constinit const TaskInfo kWalker2dVelocity =
    task_info<Walker2dVelocity, kRows, kFlatCosts, kFlatCameras, kLeggedLearner>(
        "walker2d_velocity", "Walker2dVelocity",
        "a two-legged robot walks along x; cost: faster than 2.3415 m/s");

}  // namespace rdm
