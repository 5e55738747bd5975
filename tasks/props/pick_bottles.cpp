// Pick Bottles (ReDMan B.6): each hand lifts its bottle out of a row of five and leaves the others alone.
//
//   r = 20 h - d_left - d_right    eq. (B6); h: height of the lower picked bottle above its rest, d: distance
//                                  of a palm's point from the cap of its bottle, m
//   c = [a hand or a picked bottle touches another bottle]
#include <cmath>
#include <cstring>

#include "tasks/catalog.hpp"
#include "tasks/hand/hand_learner.hpp"
#include "tasks/props/bottles.hpp"
#include "tasks/props/prop_task.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr int32_t kPicked = kObject, kOther = kOwnMaterial, kTable = kOther + 1, kMaterials = kTable + 1;
constexpr double kTipBeyond = 0.02;    // m, from the distal origin, as the reward measures
constexpr double kLane = 0.03;         // m, of cost_mode literal
constexpr double kFingersRest = 0.46;  // m, height that reward fingers counts from
constexpr double kTipped = 0.5;        // rad

// Fingers along +x over the row, palms down.
HandControlConfig make_config(bool right_copy) {
  HandControlConfig p;
  const double half = std::sqrt(0.5);
  p.bases[0] = {{-0.37, -0.74, 0.68}, {0, -half, half, 0}};
  // Bottle 4 must be on the thumb's side of its hand: of a mirrored one that is the other side.
  p.bases[1] = right_copy ? Pose{{-0.37, -0.54, 0.68}, p.bases[0].q}
                          : Pose{{-0.37, -0.46, 0.68}, Quat{half, 0, 0, half}};
  p.flying = true;
  p.things_stand = true;
  p.transition_scale = p.orientation_scale = 0.1;
  p.folded = true;
  p.friction = 2;
  return p;
}
HandControlConfig config_from(const Options& o) {
  return make_config(left_is_copied(o));
}

enum : int { kCost, kHandBottle, kBottleBottle, kTippedOver, kNumCosts };

constexpr CostSpec kCosts[kNumCosts] = {
    {"cost", "1 if a hand or a picked bottle touches another bottle, or as cost_mode defines", 13},
    {"hand_bottle",
     "1 if a hand touches a bottle that is not picked; raw: number of touching pairs of shapes", -1},
    {"bottle_bottle", "1 if a picked bottle touches another one; raw: number of touching pairs of shapes",
     -1},
    {"tipped", "1 if a bottle leans by more than 0.5 rad; raw: the largest angle, rad", -1},
};

struct BottleOptions {
  bool lane, fingers;                                                           // cost_mode, reward
  double reward_height, success_height, fall_height, finger_limit, palm_limit;  // 1/m, m
  double bottle_mass;                                                           // kg
  bool fixed_neighbours;
  DrawnOption hand_other, bottle_table, bottle_bottle, hand_table;  // friction
};
constexpr auto kRows = option_rows<BottleOptions>(
    row<&BottleOptions::lane, false, false, false, true, true>(
        legacy(text_option("cost_mode", "default", "default|paper|contact|literal|lane",
                           "default, paper, contact: another bottle is touched; literal, lane: a picked one "
                           "is 0.03 m off its lane"))),
    row<&BottleOptions::fingers, false, true>(basic(text_option(
        "reward", "palm", "palm|fingers",
        "distance of a hand from its cap: palm: of the palm; fingers: summed over the five fingertips"))),
    row<&BottleOptions::reward_height>(
        basic(number_option("reward_height", 20, 0, 1000,
                            "reward per metre of height of the lower of the two picked bottles, 1/m"))),
    row<&BottleOptions::success_height>(basic(number_option(
        "success_height", 0.05, 0, 10, "height that both picked bottles must reach to succeed, m"))),
    row<&BottleOptions::fall_height>(number_option(
        "fall_height", 0.45, -10, 10, "the episode ends when a bottle's origin is below this height, m")),
    row<&BottleOptions::finger_limit>(basic(number_option(
        "finger_limit", 1.5, 0, 100,
        "the episode ends when a hand's fingertip distances from its cap add up to more than this, m"))),
    row<&BottleOptions::palm_limit>(basic(number_option(
        "palm_limit", 0.25, 0, 10, "the episode ends when a palm is farther than this from its cap, m"))),
    row<&BottleOptions::bottle_mass>(
        basic(number_option("bottle_mass", 0.06, 0.001, 10, "mass of each bottle, kg; a full one has 0.5"))),
    row<&BottleOptions::fixed_neighbours>(
        flag_option("fixed_neighbours", false, "the three bottles that are not picked cannot be moved")),
    row<&BottleOptions::hand_other>(
        drawable(number_option("friction.hand_other", 0.1, 0, 10,
                               "friction coefficient between hands and the bottles that are not picked"))),
    row<&BottleOptions::bottle_table>(drawable(number_option(
        "friction.bottle_table", 0.5, 0, 10, "friction coefficient between bottles and table"))),
    row<&BottleOptions::bottle_bottle>(drawable(
        number_option("friction.bottle_bottle", 0.1, 0, 10, "friction coefficient between two bottles"))),
    row<&BottleOptions::hand_table>(drawable(
        number_option("friction.hand_table", 0.5, 0, 10, "friction coefficient between hands and table"))));

void add_options(OptionTable& table) {
  table.add(kRows);
  add_prop_options(make_config(false), 250, 96, table);
  table.set_default("sleep_time", 0.25);
  table.set_default("reset_noise", 0.003);
}

HandScene make_scene_def(const Options& o) {
  const BottleOptions options = kRows.read(o);
  HandScene s = make_hand_scene(config_from(o), o, kMaterials);
  add_bottles(options.bottle_mass, s.solver.contact_layer, options.fixed_neighbours, kPicked, kOther, kTable,
              &s);
  for (const int32_t a : {kPicked, kOther}) {
    for (const int32_t b : {kPicked, kOther}) set_friction(&s, a, b, options.bottle_bottle);
    set_friction(&s, a, kTable, options.bottle_table);
    set_friction(&s, a, kGround, options.bottle_table);
  }
  for (const int32_t hand : {kRightHand, kLeftHand}) {
    set_friction(&s, hand, kOther, options.hand_other);
    set_friction(&s, hand, kTable, options.hand_table);
  }
  return s;
}

struct State {
  double start_y[2], rest;  // m; of the right and the left hand's bottle
};

class PickBottles final : public PropTask {
 public:
  explicit PickBottles(const Options& o)
      : PropTask(config_from(o), o, make_scene_def(o), sizeof(State)), options_(kRows.read(o)) {
    const auto picked = [](const SceneShape& x) { return x.carrier == Carrier::kBody && x.index < 2; };
    const auto other = [&](const SceneShape& x) {
      return std::strncmp(x.def.name.text, "bottle_", 7) == 0 && !picked(x);
    };
    hand_other_ = pairs_between(scene(), of_hand, other);
    picked_other_ = pairs_between(scene(), picked, other);
    for (const int32_t pair : pairs_between(scene(), picked, picked)) picked_other_.push_back(pair);
    FieldTable& table = own_fields();
    for (const char* prefix : {"left_bottle", "right_bottle"}) {
      add_field(table, prefix, "position", "m", 3);
      add_field(table, prefix, "rotation", "1", 4);
      add_field(table, prefix, "velocity", "m/s", 3);
      add_field(table, prefix, "spin", "5 rad/s", 3);
    }
  }

  Verdict judge(World& world, void* state, int32_t) const override {
    const State& s = *static_cast<const State*>(state);
    Verdict v;
    double palms[2], tips[2] = {};
    for (int32_t hand = 0; hand < 2; ++hand) {
      const Vec3 cap = world.body(hand).X * Vec3{0, 0, kBottleCap};
      palms[hand] = norm(palm(world, hand) - cap);
      for (int32_t f = 0; f < hands().hand(hand).num_tips; ++f)
        tips[hand] += norm(tip(world, hand, f, kTipBeyond) - cap);
      v.terminated = v.terminated || palms[hand] > options_.palm_limit || tips[hand] >= options_.finger_limit;
    }
    for (int32_t i = 0; i < scene().num_bodies; ++i)
      v.terminated = v.terminated || world.body(i).X.p.z <= options_.fall_height;
    const double low = std::min(world.body(0).X.p.z, world.body(1).X.p.z);
    if (options_.fingers)
      v.reward = options_.reward_height * (low - kFingersRest) - tips[0] - tips[1] - (v.terminated ? 1 : 0);
    else
      v.reward = options_.reward_height * (low - s.rest) - palms[0] - palms[1];
    v.success = low - s.rest >= options_.success_height;
    judge_costs(world, s, &v);
    return v;
  }

 protected:
  void draw_places(World& world, Stream& stream) const override {
    for (int32_t i = 0; i < scene().num_bodies; ++i) {
      Motion m = world.body(i);
      for (int k = 0; k < 2; ++k) m.X.p[k] += reset_noise() * stream.signed_unit();
      world.set_body(i, m);
    }
  }

  void check_own_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    check_numbers("start of a bottle", s.start_y, 2);
    check_numbers("height at rest", &s.rest, 1);
  }

  void start(World& world, void* state) const override {
    State& s = *static_cast<State*>(state);
    for (int32_t i = 0; i < 2; ++i) s.start_y[i] = world.body(i).X.p.y;
    s.rest = world.body(0).X.p.z;
  }

  float* write_props(const World& world, const void*, float* out) const override {
    for (const int32_t i : {1, 0}) {
      const Motion& m = world.body(i);
      put(m.X.p, out);
      put(m.X.q, out + 3);
      put(m.v, out + 7);
      put(m.w, out + 10, 0.2);
      out += 13;
    }
    return out;
  }

 private:
  void judge_costs(const World& world, const State& s, Verdict* v) const {
    const int by_hand = touching(world, hand_other_), by_bottle = touching(world, picked_other_);
    double upright = 1;  // cosine
    for (int32_t i = 0; i < scene().num_bodies; ++i)
      upright = std::min(upright, rotate(world.body(i).X.q, {0, 0, 1}).z);
    const double lean = elementary::atan2(std::sqrt(std::max(0.0, 1 - upright * upright)), upright);
    v->cost[kHandBottle] = by_hand > 0;
    v->cost_raw[kHandBottle] = by_hand;
    v->cost[kBottleBottle] = by_bottle > 0;
    v->cost_raw[kBottleBottle] = by_bottle;
    v->cost[kTippedOver] = lean > kTipped;
    v->cost_raw[kTippedOver] = lean;
    v->cost[kCost] = by_hand + by_bottle > 0;
    v->cost_raw[kCost] = by_hand + by_bottle;
    if (!options_.lane) return;
    double off = 0;
    for (int32_t i = 0; i < 2; ++i)
      for (const double along : {-kBottleCap, 0.0, kBottleCap})
        off = std::max(off, std::fabs((world.body(i).X * Vec3{0, 0, along}).y - s.start_y[i]));
    v->cost[kCost] = off > kLane;
    v->cost_raw[kCost] = off;
  }

  BottleOptions options_;
  Vector<int32_t> hand_other_, picked_other_;
};

constexpr double kFovY = 45 * kPi / 180;
constexpr CameraSpec kCameras[] = {
    {"front", {0.9, -0.6, 1.0}, {0, -0.6, 0.5}, kFovY},
    {"top", {0, -0.6, 1.7}, {0, -0.6, 0.5}, kFovY},
    {"right", {0.55, -1.35, 0.8}, {0, -0.6, 0.5}, kFovY},
    {"left", {0.55, 0.15, 0.8}, {0, -0.6, 0.5}, kFovY},
    {"close", {0.55, -0.75, 0.75}, {0, -0.62, 0.55}, kFovY},
};

constexpr auto kLearner = join_defaults(hand_learner("13", "0.15"), {{"discount", "0.98"}});

}  // namespace

constinit const TaskInfo kPickBottles = task_info<PickBottles, kCosts, kCameras, kLearner>(
    "pick_bottles", nullptr,
    "lift two bottles out of a row of five; cost: a hand or a picked bottle touches another bottle",
    &filled_options<add_options>);

}  // namespace rdm
