// Clean House (ReDMan B.8): two hands sweep a bottle to a dustpan with a broom, past a chair.
//
//   r = 50 - 10 d_target - 5 d_left - 5 d_right   eq. (B8): distances of the trash from the dustpan and of
//                                                 the palms from their places on the broom's handle, m
//   c = [the broom touches the chair, and it moves]
//
// The text beside eq. (B8) has a fourth part, the distance from trash to broom, which the formula has not:
// option reward_bottom is its weight.
#include <algorithm>
#include <cmath>
#include <memory>

#include "sense/map/scene_map.hpp"
#include "tasks/catalog.hpp"
#include "tasks/hand/hand_learner.hpp"
#include "tasks/props/house_scene.hpp"
#include "tasks/props/prop_task.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr HouseMaterials kHouse = {kObject, kOwnMaterial, kOwnMaterial + 1, kOwnMaterial + 2,
                                   kOwnMaterial + 3};
constexpr int32_t kMaterials = kOwnMaterial + 4;
constexpr double kTipBeyond = 0.02;    // m, from the distal origin, as the reward measures
constexpr double kMovingSpeed = 0.01;  // m/s, of a chair that a broom pushes
constexpr double kMovingWay = 0.01;    // m
constexpr double kOnFloor = 1e-3;      // m
constexpr double kStill = 0.01;        // rad/s
constexpr double kNear = 0.25;         // m, of reward full: the broom is at the trash

// Of the trash's lowest point, m.
double trash_height(const Pose& X) {
  const double up = rotate(X.q, {0, 0, 1}).z;
  return X.p.z - kTrashHalf * std::fabs(up) - kTrashRadius * std::sqrt(std::max(0.0, 1 - up * up));
}

// Thumbs up, fingers along -x on both sides of the handle; the left hand above the right.
HandControlConfig make_config() {
  HandControlConfig p;
  const Quat q = {0.5, 0.5, 0.5, -0.5};
  p.bases[0] = {{0.35, -0.45, 1.3}, q};
  p.bases[1] = {{0.35, -0.59, 1.6}, q};
  p.flying = true;
  p.things_stand = true;
  p.transition_scale = 0.2;
  p.orientation_scale = 0.5;
  p.folded = true;
  p.friction = 1.5;
  return p;
}

enum : int { kCost, kBroomChair, kChairMoved, kHandChair, kOccupancy, kNumCosts };

constexpr CostSpec kCosts[kNumCosts] = {
    {"cost", "1 if the broom touches the chair and the chair moves, or as cost_mode defines", 100},
    {"broom_chair", "1 if the broom touches the chair; raw: number of touching pairs of shapes", -1},
    {"chair_moved", "1 if the chair is farther than chair_limit from its start; raw: its displacement, m",
     -1},
    {"hand_chair", "1 if a hand touches the chair; raw: number of touching pairs of shapes", -1},
    {"occupancy",
     "1 if the broom is where the map of the start shows the chair; raw: number of its parts there", -1},
};

constexpr double kFovY = 45 * kPi / 180;
constexpr CameraSpec kCameras[] = {
    {"front", {2.5, -1.6, 2.2}, {0, -1.6, 0.6}, kFovY},
    {"top", {0, -1.7, 4.5}, {0, -1.7, 0}, kFovY},
    {"right", {1.2, 1.2, 2}, {0, -0.9, 0.8}, kFovY},
    {"left", {-2.4, -2.2, 2}, {0, -1.4, 0.6}, kFovY},
    {"wide", {3.6, -1.6, 2.3}, {0, -1.6, 0.75}, kFovY},
    {"close", {1.0, -1.2, 1.8}, {0, -0.5, 1.4}, kFovY},
    {"above", {0, -1.6, 4.5}, {0, -1.6, 0}, kFovY},
    {"side_right", {2.6, -1.6, 1}, {0, -1.6, 0.5}, kFovY},
    {"side_left", {-2.6, -1.6, 1}, {0, -1.6, 0.5}, kFovY},
};

constexpr int32_t kMapRays = 128;               // along a side of a scan
constexpr size_t kMapMemory = size_t{4} << 20;  // bytes; of voxels below 5 cm twice as many
constexpr double kMapReach = 100;               // m, about all that the scans see
constexpr double kMapSlack = 1e-6;              // m, of the bounds about what is occupied

struct CleanOptions {
  bool displacement, count_hands;                                                   // of the cost
  double map_resolution, chair_limit;                                               // m
  bool full;                                                                        // reward
  double reward_bottom, palm_limit, handle_height, trash_height, success_distance;  // 1/m, m
  bool obs_broom_quat;
  double goal_x, goal_y, goal_z;                 // m
  double trash_mass, trash_rolling, chair_mass;  // kg, N m, kg
  bool grip_assist;
  double grip_force;                                                    // N
  DrawnOption head_floor, head_trash, trash_floor, chair_floor, other;  // friction
};
constexpr auto kRows = option_rows<CleanOptions>(
    row<&CleanOptions::displacement, false, false, false, true, true>(
        legacy(text_option("cost_mode", "default", "default|paper|event|literal|displacement",
                           "default, paper, event: the broom touches the chair and it moves; literal, "
                           "displacement: the chair was moved"))),
    row<&CleanOptions::count_hands>(
        flag_option("count_hands", false, "hands that touch the moving chair cost too (cost_mode=event)")),
    row<&CleanOptions::map_resolution>(number_option(
        "map_resolution", 0.05, 0.01, 0.5, "side of a voxel of the map behind column occupancy, m")),
    row<&CleanOptions::chair_limit>(basic(number_option(
        "chair_limit", 0.1, 0, 10,
        "displacement of the chair that column chair_moved and cost_mode=displacement count, m"))),
    row<&CleanOptions::full, false, true>(basic(text_option(
        "reward", "paper", "paper|full",
        "paper: distances of palms and trash, eq. (B8); full: all five terms of the paper's code"))),
    row<&CleanOptions::reward_bottom>(
        number_option("reward_bottom", 0, 0, 1000,
                      "reward=paper: amount subtracted per metre between broom and trash, 1/m")),
    row<&CleanOptions::palm_limit>(basic(
        number_option("palm_limit", 0.15, 0, 10,
                      "the episode ends when a palm is farther than this from its place on the handle, m"))),
    row<&CleanOptions::handle_height>(basic(
        number_option("handle_height", 1.0, -10, 10,
                      "the episode ends when the right hand's place on the handle is below this height, m"))),
    row<&CleanOptions::trash_height>(number_option(
        "trash_height", -0.3, -10, 10, "the episode ends when the trash is below this height, m")),
    row<&CleanOptions::success_distance>(basic(number_option(
        "success_distance", 0.25, 0, 10, "distance of the trash from its goal that counts as success, m"))),
    row<&CleanOptions::obs_broom_quat>(
        flag_option("obs_broom_quat", false, "append the broom's rotation to the observation")),
    row<&CleanOptions::goal_x>(number_option("goal.x", 0, -10, 10, "x of the trash's goal position, m")),
    row<&CleanOptions::goal_y>(number_option("goal.y", -2.9, -10, 10, "y of the trash's goal position, m")),
    row<&CleanOptions::goal_z>(number_option("goal.z", 0.03, -10, 10, "z of the trash's goal position, m")),
    row<&CleanOptions::trash_mass>(basic(number_option(
        "trash_mass", 0.06, 0.001, 10, "mass of the trash, an empty bottle, kg; a full one has 0.5"))),
    row<&CleanOptions::trash_rolling>(number_option(
        "trash_rolling", 0.002, 0, 1, "torque against the rolling of the trash on the floor, N m")),
    row<&CleanOptions::chair_mass>(basic(number_option("chair_mass", 4, 0.1, 100, "mass of the chair, kg"))),
    row<&CleanOptions::grip_assist>(
        basic(flag_option("grip_assist", false, "hold the handle in both palms by soft ball joints"))),
    row<&CleanOptions::grip_force>(
        number_option("grip_force", 50, 0, 1000, "largest force of each joint of grip_assist, N")),
    row<&CleanOptions::head_floor>(drawable(number_option(
        "friction.head_floor", 0.2, 0, 10, "friction coefficient between broom head and floor"))),
    row<&CleanOptions::head_trash>(drawable(number_option(
        "friction.head_trash", 0.6, 0, 10, "friction coefficient between broom head and trash"))),
    row<&CleanOptions::trash_floor>(drawable(
        number_option("friction.trash_floor", 0.3, 0, 10, "friction coefficient between trash and floor"))),
    row<&CleanOptions::chair_floor>(drawable(
        number_option("friction.chair_floor", 0.3, 0, 10, "friction coefficient between chair and floor"))),
    row<&CleanOptions::other>(
        drawable(number_option("friction.other", 0.5, 0, 10, "friction coefficient of all other pairs"))));

void add_options(OptionTable& table) {
  table.add(kRows);
  add_prop_options(make_config(), 500, 96, table);
  table.set_default("reset_noise", 0.003);
  if (same_name(table.choice("engine"), "ode")) return;
  table.set_default("sleep_time", 0.05);
  table.set_default("iterations", 16);  // a grip is few points, each of which waits for the others
}

HandScene make_scene_def(const Options& o) {
  const CleanOptions options = kRows.read(o);
  HandScene s = make_hand_scene(make_config(), o, kMaterials);
  const int32_t things[] = {kHouse.handle, kHouse.head, kHouse.trash, kHouse.chair, kHouse.pan};
  const double other = options.other.middle;
  for (const int32_t a : things) {
    for (const int32_t b : things) set_friction(&s, a, b, other);
    set_friction(&s, a, kGround, other);
    if (a == kHouse.handle) continue;
    for (const int32_t hand : {kRightHand, kLeftHand}) set_friction(&s, hand, a, other);
  }
  set_friction(&s, kHouse.head, kGround, options.head_floor);
  set_friction(&s, kHouse.head, kHouse.trash, options.head_trash);
  set_friction(&s, kHouse.trash, kGround, options.trash_floor);
  set_friction(&s, kHouse.chair, kGround, options.chair_floor);
  HouseDef house;
  house.trash_mass = options.trash_mass;
  house.chair_mass = options.chair_mass;
  house.sink = s.solver.contact_layer;
  add_house(house, kHouse, &s);
  return s;
}

struct State {
  Vec3 chair;  // where it was at the start
};

class CleanHouse final : public PropTask {
 public:
  explicit CleanHouse(const Options& o)
      : PropTask(make_config(), o, make_scene_def(o), sizeof(State)),
        options_(kRows.read(o)),
        grip_(options_.grip_assist ? options_.grip_force : 0),
        goal_{options_.goal_x, options_.goal_y, options_.goal_z} {
    const auto body = [](int32_t i) {
      return [i](const SceneShape& x) { return x.carrier == Carrier::kBody && x.index == i; };
    };
    map_house(options_.map_resolution);
    broom_chair_ = pairs_between(scene(), body(kBroom), body(kChair));
    hand_chair_ = pairs_between(scene(), of_hand, body(kChair));
    for (const FieldSpec& f : std::initializer_list<FieldSpec>{{"trash.position", "m", 3},
                                                               {"trash.rotation", "1", 4},
                                                               {"trash.velocity", "m/s", 3},
                                                               {"trash.spin", "5 rad/s", 3},
                                                               {"goal.position", "m", 3},
                                                               {"goal.rotation", "1", 4},
                                                               {"trash.rotation_error", "1", 4},
                                                               {"broom.bottom", "m", 3},
                                                               {"broom.left_hold", "m", 3},
                                                               {"broom.right_hold", "m", 3}})
      own_fields().push_back(f);
    if (options_.obs_broom_quat) add_field(own_fields(), "broom", "rotation", "1", 4);
  }

  Vec3 focus(const World& world, const void*) const override { return broom_point(world, kBroomBottom); }

  void control(World& world, void* state, const float* action) const override {
    PropTask::control(world, state, action);
    stop_rolling(world);
    if (grip_ > 0)
      for (int32_t hand = 0; hand < 2; ++hand) hold_handle(world, hand);
  }

  Verdict judge(World& world, void* state, int32_t) const override {
    const State& s = *static_cast<const State*>(state);
    Verdict v;
    const Vec3& trash = world.body(kTrash).X.p;
    const double to_goal = norm(trash - goal_);
    double palms[2], tips = 0;
    for (int32_t hand = 0; hand < 2; ++hand) {
      const Vec3 hold = hold_point(world, hand);
      palms[hand] = norm(palm(world, hand) - hold);
      for (int32_t f = 0; options_.full && f < hands().hand(hand).num_tips; ++f)
        tips += norm(tip(world, hand, f, kTipBeyond) - hold);
      v.terminated = v.terminated || palms[hand] >= options_.palm_limit;
    }
    v.terminated =
        v.terminated || trash.z <= options_.trash_height || hold_point(world, 0).z <= options_.handle_height;
    const double to_trash = norm(broom_point(world, kBroomBottom) - trash);
    v.reward = 50 - 5 * (palms[0] + palms[1]);
    if (options_.full)
      v.reward -= tips + (to_trash > kNear ? 40 : 20 * to_goal) + 10 * to_trash;
    else
      v.reward -= 10 * to_goal + options_.reward_bottom * to_trash;
    v.success = to_goal <= options_.success_distance;
    judge_costs(world, s, &v);
    return v;
  }

 protected:
  // The trash alone.
  void draw_places(World& world, Stream& stream) const override {
    Motion m = world.body(kTrash);
    for (int k = 0; k < 2; ++k) m.X.p[k] += reset_noise() * stream.signed_unit();
    world.set_body(kTrash, m);
  }

  void check_own_state(const void* state) const override {
    check_point("start of the chair", static_cast<const State*>(state)->chair);
  }

  void start(World& world, void* state) const override {
    static_cast<State*>(state)->chair = world.body(kChair).X.p;
  }

  float* write_props(const World& world, const void*, float* out) const override {
    const Motion& m = world.body(kTrash);
    put(m.X.p, out);
    put(m.X.q, out + 3);
    put(m.v, out + 7);
    put(m.w, out + 10, 0.2);
    put(goal_, out + 13);
    put(Quat{}, out + 16);
    put(m.X.q, out + 20);  // the goal's rotation is the identity
    put(broom_point(world, kBroomBottom), out + 24);
    put(hold_point(world, 1), out + 27);
    put(hold_point(world, 0), out + 30);
    out += 33;
    if (!options_.obs_broom_quat) return out;
    put(world.body(kBroom).X.q, out);
    return out + 4;
  }

 private:
  Vec3 broom_point(const World& world, const Vec3& from_middle) const {
    return world.body(kBroom).X * (broom_middle() + from_middle);
  }
  Vec3 hold_point(const World& world, int32_t hand) const {
    return broom_point(world, hand == 0 ? kRightHold : kLeftHold);
  }

  // A cylinder would roll on for ever: a torque against its rolling, never more than stops it; none once it
  // stands, so that it may fall asleep, which a push would keep it from.
  void stop_rolling(World& world) const {
    const Motion& m = world.body(kTrash);
    const double spin = norm(m.w);
    if (scene().def.solver.sleep_time > 0 && spin < kStill) return;
    if (options_.trash_rolling == 0 || spin == 0 || trash_height(m.X) > kOnFloor) return;
    const double mass = scene().def.bodies[kTrash].inertia.mass;
    const double stops = 1.5 * mass * kTrashRadius * kTrashRadius * spin / scene().control_dt();
    world.push_body(kTrash, {}, (-std::min(options_.trash_rolling, stops) / spin) * m.w);
  }

  void hold_handle(World& world, int32_t hand) const {
    constexpr double kStiffness = 500, kDamping = 15;  // N/m, N s/m
    const Motion& broom = world.body(kBroom);
    const Vec3 hold = hold_point(world, hand), at_palm = palm(world, hand), arm = hold - broom.X.p;
    const Motion& base = world.base(hands().hand(hand).articulation);
    Vec3 force = kStiffness * (at_palm - hold) + kDamping * (base.v - broom.v - cross(broom.w, arm));
    const double size = norm(force);
    if (size > grip_) force = (grip_ / size) * force;
    world.push_body(kBroom, force, cross(arm, force));
    push_palm(world, hand, -force, at_palm);
  }

  // The chair at its start, as the three cameras for clouds see it.
  void map_house(double resolution) {
    OccupancyConfig config;
    config.resolution = resolution;
    config.memory = resolution < 0.05 ? 2 * kMapMemory : kMapMemory;
    map_.reset(Occupancy::create(config, host()));
    Vector<Camera> cameras;
    for (const CameraSpec& c : kCameras)
      if (same_name(c.name, "above") || same_name(c.name, "side_right") || same_name(c.name, "side_left"))
        cameras.push_back({c.name, c.eye, c.target, c.fov_y});
    const int32_t chair = kChair;
    scan_scene(scene(), false, &chair, 1, cameras.data(), static_cast<int32_t>(cameras.size()), kMapRays,
               map_.get());
    map_->end_inserts();
    map_->box({-kMapReach, -kMapReach, -kMapReach}, {kMapReach, kMapReach, kMapReach},
              [this](const OccupiedVoxel& v) {
                for (int k = 0; k < 3; ++k) {
                  map_low_[k] = std::min(map_low_[k], v.centre[k] - 0.5 * v.side - kMapSlack);
                  map_high_[k] = std::max(map_high_[k], v.centre[k] + 0.5 * v.side + kMapSlack);
                }
              });
  }

  // False: what the turned box takes up along the axes meets nothing that is occupied.
  bool near_map(const Pose& X_WB, const Vec3& half) const {
    const Mat3 R = to_matrix(X_WB.q);
    for (int k = 0; k < 3; ++k) {
      const double reach =
          std::fabs(R(k, 0)) * half.x + std::fabs(R(k, 1)) * half.y + std::fabs(R(k, 2)) * half.z;
      if (X_WB.p[k] + reach < map_low_[k] || X_WB.p[k] - reach > map_high_[k]) return false;
    }
    return true;
  }

  int32_t parts_in_map(const World& world) const {
    int32_t count = 0;
    for (const SceneShape& s : scene().shapes) {
      if (s.carrier != Carrier::kBody || s.index != kBroom) continue;
      const Vec3& size = s.def.size;
      const Vec3 half = s.def.kind == ShapeKind::kBox ? size : Vec3{size.x, size.x, size.y};
      const Pose X_WS = world.body(kBroom).X * s.def.X_LS;
      count += near_map(X_WS, half) && map_->meets_box(X_WS, half);
    }
    return count;
  }

  void judge_costs(const World& world, const State& s, Verdict* v) const {
    const int by_broom = touching(world, broom_chair_), by_hand = touching(world, hand_chair_);
    const Motion& chair = world.body(kChair);
    const double way = norm(chair.X.p - s.chair);
    const bool moves = norm(chair.v) > kMovingSpeed || way > kMovingWay;
    v->cost[kBroomChair] = by_broom > 0;
    v->cost_raw[kBroomChair] = by_broom;
    v->cost[kHandChair] = by_hand > 0;
    v->cost_raw[kHandChair] = by_hand;
    v->cost[kChairMoved] = way > options_.chair_limit;
    v->cost_raw[kChairMoved] = way;
    v->cost_raw[kOccupancy] = parts_in_map(world);
    v->cost[kOccupancy] = v->cost_raw[kOccupancy] > 0;
    v->cost[kCost] = options_.displacement ? v->cost[kChairMoved]
                                           : moves && by_broom + (options_.count_hands ? by_hand : 0) > 0;
    v->cost_raw[kCost] = way;
  }

  CleanOptions options_;
  double grip_;  // N, 0: none
  Vec3 goal_;
  Vector<int32_t> broom_chair_, hand_chair_;
  struct DestroyMap {
    void operator()(Occupancy* map) const { Occupancy::destroy(map); }
  };
  std::unique_ptr<Occupancy, DestroyMap> map_;  // gives its memory back also when a constructor throws
  Vec3 map_low_ = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, map_high_ = -map_low_;  // box about what it has occupied
};

// Rewards are near 30 a step.
constexpr auto kLearner =
    join_defaults(hand_learner("100", "0.05"), {{"discount", "0.98"}, {"reward_factor", "0.01"}});

}  // namespace

constinit const TaskInfo kCleanHouse = task_info<CleanHouse, kCosts, kCameras, kLearner>(
    "clean_house", nullptr,
    "sweep trash to a dustpan with a broom in two hands; cost: the broom touches the chair and it moves",
    &filled_options<add_options>);

}  // namespace rdm
