// Hand Over Wall (ReDMan B.5): the right hand throws an object through a hole in a wall to the left hand.
//
//   r = exp(-0.2 (50 d + theta))   eq. (B5), as Hand Over
//   c = [the object touches the wall]
#include <algorithm>
#include <cmath>
#include <iterator>

#include "tasks/catalog.hpp"
#include "tasks/hand/hand_learner.hpp"
#include "tasks/throw/throw_task.hpp"
#include "tasks/throw/wall.hpp"

namespace rdm {
namespace {

constexpr int32_t kWall = kOwnMaterial, kMaterials = kOwnMaterial + 1;

const ThrowConfig kConfig = {.hands = {.bases = {{{0, 0, 0.5}, {}}, {{0, -1.05, 0.5}, {0, 1, 0, 0}}}},
                             .place = {{0, -0.39, 0.54}, {0, -0.66, 0.54}},
                             .fall_height = 0.1};

// The released hole, on the object's centre, m.
constexpr double kSourceHalfWidth = 0.25, kSourceLow = 0.60, kSourceHigh = 0.70;

enum class WallKind { kAuto, kSolid, kGhost };
struct OverWallOptions {
  bool literal;  // cost_mode
  WallKind wall;
  bool count_hands;
  DrawnOption friction;
  double throw_height;  // m
  ThrowMean initial_mean;
};
constexpr auto kRows = option_rows<OverWallOptions>(
    row<&OverWallOptions::literal, false, false, true>(
        legacy(text_option("cost_mode", "default", "default|paper|literal",
                           "default, paper: contact with the wall; literal: the object's centre in the "
                           "wall's slab but not its hole"))),
    row<&OverWallOptions::wall, WallKind::kAuto, WallKind::kSolid, WallKind::kGhost>(basic(text_option(
        "wall", "auto", "auto|solid|ghost",
        "solid: the wall can be touched; ghost: everything passes; auto: ghost with cost_mode=literal"))),
    row<&OverWallOptions::count_hands>(
        flag_option("count_hands", false, "contact of a hand with the wall costs too")),
    row<&OverWallOptions::friction>(drawable(number_option(
        "friction.wall", 0.5, 0, 10, "friction coefficient between the wall and hands or object"))),
    row<&OverWallOptions::throw_height>(basic(number_option(
        "throw_height", 0.8, 0, 10, "height of the object above which column throw_height costs 1, m"))),
    row<&OverWallOptions::initial_mean, ThrowMean::kAuto, ThrowMean::kFlat, ThrowMean::kHold,
        ThrowMean::kZero>(text_option(
        "initial_mean", "auto", "auto|flat|hold|zero",
        "mean action of a new policy: flat (right hand flat), hold (the hold action) or zero; auto: flat")));

enum : int { kCost, kWallObject, kWallHand, kThrowHeight, kNumCosts };
constexpr CostSpec kCosts[kNumCosts] = {
    {"cost",
     "1 if the wall is hit as cost_mode defines; raw: number of touching pairs, or depth in the slab, m", 3},
    {"wall_object", "1 if the object touches the wall; raw: number of touching pairs of shapes", -1},
    {"wall_hand", "1 if a hand touches the wall; raw: number of touching pairs of shapes", -1},
    {"throw_height", "1 if the object is above throw_height; raw: its height, m", -1},
};

void add_options(OptionTable& table) {
  add_throw_task_options(kConfig, table);
  add_wall_options(table);
  table.add(kRows);
}

HandScene make_wall_scene(const Options& o) {
  HandScene s = make_throw_scene(kConfig, o, kMaterials);
  const OverWallOptions options = kRows.read(o);
  const bool ghost = options.wall == WallKind::kGhost || (options.wall == WallKind::kAuto && options.literal);
  Vector<ShapeDef> shapes = wall_boxes(o, kWall);
  if (shapes.empty()) shapes = wall_panels(wall_from(o), kWall);
  for (ShapeDef& shape : shapes) {
    shape.collides = !ghost;
    s.statics.push_back(shape);
  }
  for (const int32_t other : {kRightHand, kLeftHand, kObject})
    set_friction(&s, kWall, other, options.friction);
  return s;
}

class HandOverWall final : public ThrowTask {
 public:
  explicit HandOverWall(const Options& o)
      : ThrowTask(kConfig, o, make_wall_scene(o)), wall_(wall_from(o)), options_(kRows.read(o)) {
    const auto wall = [](const SceneShape& x) { return x.def.material == kWall; };
    object_pairs_ = pairs_between(
        scene(), [](const SceneShape& x) { return x.carrier == Carrier::kBody; }, wall);
    hand_pairs_ = pairs_between(
        scene(), [](const SceneShape& x) { return x.carrier != Carrier::kBody; }, wall);
    choose_mean(options_.initial_mean, &flat_throw_mean, FirstFinger::kFlat);
  }

 private:
  // How deep the object's centre is in the slab, m, where that is not the released hole; else 0 or less.
  double slab_depth(const Vec3& p) const {
    const bool hole = std::fabs(p.x) <= kSourceHalfWidth && p.z >= kSourceLow && p.z <= kSourceHigh;
    return hole ? 0 : 0.5 * wall_.thickness - std::fabs(p.y - wall_.y);
  }

  void judge_costs(const Step& step, Verdict* v) const override {
    const Vec3& p = step.world.body(0).X.p;
    const int object = touching(step.world, object_pairs_), hands = touching(step.world, hand_pairs_);
    v->cost_raw[kWallObject] = object;
    v->cost_raw[kWallHand] = hands;
    v->cost_raw[kThrowHeight] = p.z;
    v->cost_raw[kCost] = options_.literal ? slab_depth(p) : object + (options_.count_hands ? hands : 0);
    v->cost[kThrowHeight] = p.z > options_.throw_height;
    for (const int k : {kCost, kWallObject, kWallHand}) v->cost[k] = v->cost_raw[k] > 0;
  }

  Wall wall_;
  OverWallOptions options_;
  Vector<int32_t> object_pairs_, hand_pairs_;  // with the wall: indices of Scene::pairs
};

const CameraSpec kCameras[] = {
    {"front", {1.2, 0.25, 1.15}, {0, -0.5, 0.6}, 45 * kDegree},
    {"top", {0, -0.5, 2.2}, {0, -0.5, 0.5}, 45 * kDegree},
    {"right", {0.55, 0.5, 0.95}, {0, -0.5, 0.58}, 45 * kDegree},
    {"left", {0.6, -1.5, 0.95}, {0, -0.55, 0.58}, 45 * kDegree},
    {"close", {0.3, 0.05, 0.85}, {0, -0.5, 0.6}, 45 * kDegree},
    // for point clouds: above and to both sides of the wall
    {"cloud_above", {0, -0.525, 1.5}, {0, -0.52, 1.0}, 57 * kDegree},
    {"cloud_right", {0, 0.475, 1.5}, {0.1, -1.525, 0.5}, 57 * kDegree},
    {"cloud_left", {0, -1.525, 1.5}, {0.1, 0.475, 0.5}, 57 * kDegree},
};

// Until it is learned to throw through the hole, every throw costs: the limit has to wait.
constexpr auto kLearner = join_defaults(
    join_defaults(throw_learner("3"), kFineDecisions),
    {{"multiplier_lr", "0.0005"}, {"multiplier_warmup", "2000"}, {"kl_target_end", "0"}, {"lr_min", "1e-5"}});

}  // namespace

constinit const TaskInfo kHandOverWall = task_info<HandOverWall, kCosts, kCameras, kLearner>(
    "hand_over_wall", nullptr, "throw an object through a hole in a wall; cost: the object touches the wall",
    &filled_options<add_options>);

}  // namespace rdm
