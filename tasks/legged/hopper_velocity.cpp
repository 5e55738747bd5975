// Safety-Gymnasium's HopperVelocity: hop along x, but slower than the limit. flat_walker.hpp has reward and
// cost.
#include <cmath>

#include "tasks/catalog.hpp"
#include "tasks/legged/flat_walker.hpp"
#include "tasks/legged/legged_learner.hpp"

namespace rdm {
namespace {

constexpr double kLimbMu = 1, kFootMu = 2;  // the larger of limb and floor
constexpr MujocoContact kContact{0.8, 0.8, 0.01, 0.001};
constexpr FlatLeg kLeg{"thigh", "leg", "foot", -0.13, 0.26, 1, 1, 200, kFootMaterial, kMarkBlue};

class HopperVelocity final : public FlatWalker {
 public:
  explicit HopperVelocity(const FlatOptions& o)
      : FlatWalker(make(), o, {0.7, HUGE_VAL, 0.2, 100}, "thigh, leg, foot") {}

 private:
  static Scene make() {
    PlanarScene scene = flat_scene("hopper", kLimbMu, kFootMu);
    add_flat_leg(kLeg, scene);
    soften(kContact, scene);
    return scene.build();
  }
};

constexpr auto kRows = flat_rows(0.7402);

}  // namespace

constinit const TaskInfo kHopperVelocity =
    task_info<HopperVelocity, kRows, kFlatCosts, kFlatCameras, kLeggedLearner>(
        "hopper_velocity", "HopperVelocity", "a one-legged robot hops along x; cost: faster than 0.7402 m/s");

}  // namespace rdm
