// Jenga (ReDMan B.7): one hand pushes the target block out of a tower that must not move.
//
//   r = 30 min(y - y0, 0.3) - |tip - end|     the target's way along +y and the distance of a middle finger's
//                                             tip from the target's end at -y, m
//   c = [some other block is more than 0.01 m from its start]
//
// Eq. (B7) has 30 (y + 0.6), with the start at y = -0.6, the left middle finger and the left end, and no
// bound on y. The paper's cost asks that all blocks move more than 0.01 cm (cost_mode = paper), while its
// words are "we can not touch other blocks" (column blocks_contact); the default lies between.
#include <cmath>

#include "base/error.hpp"
#include "env/options/simulation.hpp"
#include "tasks/catalog.hpp"
#include "tasks/hand/hand_learner.hpp"
#include "tasks/props/jenga_tower.hpp"
#include "tasks/props/prop_task.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kTilt = 130 * kPi / 180;
constexpr int32_t kTarget = kObject, kBlock = kOwnMaterial, kTable = kBlock + 1, kMaterials = kTable + 1;
constexpr double kTipBeyond = 0.02;  // m, from the distal origin, as the reward measures
constexpr int kMiddle = 1;           // finger

// On arms: fingers level and towards the tower, palms down, as the demonstration comes to lie.
constexpr Quat kOver = {0, 1, 0, 0};
constexpr Pose kArmedBases[kMaxHands] = {{{0, -1.2, 0.4035}, kOver}, {{0, 0.08, 0.5}, {}}},
               kArmedCopies[kMaxHands] = {kArmedBases[0], {{0, 0.08, 0.5}, {0, 0, 1, 0}}};

// The pair of the paper's code (shadow_hand_allegro_hand_arm_jenga); what it calls left is at -y and pushes,
// right here. Its bases, 0.5 m from the tower, would have both hands in it: these stand as other arms do.
constexpr HandDefault kPaperPair[kMaxHands] = {{"shadow_hand", "kuka_iiwa7", "", ""},
                                               {"allegro_hand", "xarm6", "", ""}};

// Fingers up and towards the tower from both sides, palms down.
HandControlConfig make_config(bool right_copy, bool paper_pair) {
  HandControlConfig p;
  p.bases[0] = {{0, -1.0, 0.06}, axis_angle({1, 0, 0}, -kTilt)};
  const Quat turned = axis_angle({1, 0, 0}, kPi - kTilt);
  // at x = 0, where no finger is inside a block; the source's -0.01 puts one 3 mm deep
  p.bases[1] = {{0, -0.20, 0.09}, right_copy ? Quat{0, 0, 1, 0} * turned : conjugate(turned)};
  if (paper_pair) p.sides = kPaperPair;
  p.armed_bases = right_copy ? kArmedCopies : kArmedBases;
  p.facing = true;
  p.flying = true;
  p.things_stand = true;
  p.transition_scale = p.orientation_scale = 0.1;
  p.folded = true;
  p.friction = 1.5;
  return p;
}

struct PairOptions {
  bool paper;
};
constexpr auto kPairRows = row<&PairOptions::paper, false, true>(
    choosing(text_option("pair", "own", "own|paper",
                         "robots if hand and arm are not set: own: the usual; paper: Shadow on iiwa 7 "
                         "pushes, Allegro on xArm 6")));

HandControlConfig config_from(const Options& o) {
  return make_config(left_is_copied(o), kPairRows.read(o).paper);
}

enum : int { kCost, kMoved, kContact, kFall, kNumCosts };

constexpr CostSpec kCosts[kNumCosts] = {
    {"cost", "1 if blocks are moved as cost_mode defines; raw: the displacement it compares, m", 5},
    {"blocks_moved",
     "1 if a block is farther than block_limit from its start; raw: the largest displacement, m", -1},
    {"blocks_contact",
     "1 if a hand touches a block other than the target; raw: number of touching pairs of shapes", -1},
    {"tower_fall", "1 if a block is half its height or more below its start; raw: the deepest fall, m", -1},
};

enum class Mode { kAny, kAll, kSum, kContact };  // of the cost
struct JengaOptions {
  Mode cost_mode;
  double cost_sum, cost_all;                                 // m
  int32_t reward_finger;                                     // 0 right, 1 left hand
  double reward_push, push_limit, success_push, drop_limit;  // 1/m, m
  bool extended_obs;
  DrawnOption block_table, hand_block, hand_table;  // friction
};
constexpr auto kRows = option_rows<JengaOptions>(
    row<&JengaOptions::cost_mode, Mode::kAny, Mode::kAny, Mode::kAll, Mode::kAll, Mode::kSum, Mode::kSum,
        Mode::kContact>(
        legacy(text_option("cost_mode", "default", "default|any|paper|all|literal|sum|contact",
                           "default, any: a block moved; paper, all: all moved; literal, sum: displacements "
                           "add up; contact: touched"))),
    row<&JengaOptions::cost_sum>(
        legacy(number_option("cost_sum", 0.25, 0, 100,
                             "sum of the blocks' displacements above which cost_mode=literal costs 1, m"))),
    row<&JengaOptions::cost_all>(legacy(number_option(
        "cost_all", 1e-4, 0, 1, "displacement of every block above which cost_mode=paper costs 1, m"))),
    row<&JengaOptions::reward_finger, 0, 1>(
        basic(text_option("reward_finger", "right", "right|left",
                          "hand whose middle finger is rewarded for nearing the target: right (can push) or "
                          "left (the paper)"))),
    row<&JengaOptions::reward_push>(basic(number_option(
        "reward_push", 30, 0, 1000, "reward per metre that the target is pushed along +y, 1/m"))),
    row<&JengaOptions::push_limit>(basic(number_option(
        "push_limit", 0.3, 0, 10, "distance beyond which pushing the target earns no more reward, m"))),
    row<&JengaOptions::success_push>(basic(number_option(
        "success_push", 0, 0, 10, "distance that the target must be pushed to succeed, m; 0: its length"))),
    row<&JengaOptions::drop_limit>(
        number_option("drop_limit", 0.01, 0, 10,
                      "the episode ends when every block has moved vertically by more than this, m")),
    row<&JengaOptions::extended_obs>(
        flag_option("extended_obs", false, "append the positions of all blocks to the observation")),
    row<&JengaOptions::block_table>(drawable(
        number_option("friction.block_table", 0.5, 0, 10, "friction coefficient between blocks and table"))),
    row<&JengaOptions::hand_block>(drawable(
        number_option("friction.hand_block", 0.5, 0, 10, "friction coefficient between hands and blocks"))),
    row<&JengaOptions::hand_table>(drawable(
        number_option("friction.hand_table", 0.5, 0, 10, "friction coefficient between hands and table"))));

void add_options(OptionTable& table) {
  table.add(kRows);
  add_tower_options(table);
  table.add(kPairRows);
  add_prop_options(
      make_config(false, same_name(table.choice(kPairRows.of<&PairOptions::paper>().key), "paper")), 250, 256,
      table);
  table.set_default("sleep_time", 0.25);
  table.set_default("reset_noise", 0.001);
  table.set_default("exact_solver", 0.0);  // of a tower's contacts ODE's takes 35 ms a step
}

HandScene make_scene_def(const JengaTower& tower, const Options& o) {
  const JengaOptions options = kRows.read(o);
  HandScene s = make_hand_scene(config_from(o), o, kMaterials);
  add_tower(tower, kTarget, kBlock, kTable, &s);
  for (const int32_t a : {kTarget, kBlock}) {
    for (const int32_t b : {kTarget, kBlock}) set_friction(&s, a, b, tower.friction);
    set_friction(&s, a, kTable, options.block_table);
    set_friction(&s, a, kGround, options.block_table);
  }
  for (const int32_t hand : {kRightHand, kLeftHand}) {
    set_friction(&s, hand, kBlock, options.hand_block);
    set_friction(&s, hand, kTable, options.hand_table);
  }
  return s;
}

struct State {
  Vec3 start[1 + kJengaBlocks];
};

class Jenga final : public PropTask {
 public:
  explicit Jenga(const Options& o) : Jenga(o, jenga_tower_from(o, solver_from(o).contact_layer)) {}

  Verdict judge(World& world, void* state, int32_t) const override {
    const State& s = *static_cast<const State*>(state);
    Verdict v;
    const Pose& target = world.body(0).X;
    const double pushed = target.p.y - s.start[0].y;
    const Vec3 end = target * Vec3{0, -tower_.target_end(), 0};
    v.reward = options_.reward_push * std::min(pushed, options_.push_limit) -
               norm(tip(world, options_.reward_finger, kMiddle, kTipBeyond) - end);
    v.success = pushed >= options_.success_push;
    v.terminated = judge_costs(world, s, &v);
    return v;
  }

 protected:
  void check_own_state(const void* state) const override {
    for (const Vec3& p : static_cast<const State*>(state)->start) check_point("start of a block", p);
  }

  void start(World& world, void* state) const override {
    for (int i = 0; i <= tower_.blocks; ++i) static_cast<State*>(state)->start[i] = world.body(i).X.p;
  }

  float* write_props(const World& world, const void*, float* out) const override {
    const Motion& m = world.body(0);
    put(m.X.p, out);
    put(m.X.q, out + 3);
    put(m.v, out + 7);
    put(m.w, out + 10, 0.2);
    out += 13;
    for (int i = 1; options_.extended_obs && i <= tower_.blocks; ++i, out += 3) put(world.body(i).X.p, out);
    return out;
  }

 private:
  Jenga(const Options& o, const JengaTower& tower)
      : PropTask(config_from(o), o, make_scene_def(tower, o), sizeof(State)),
        tower_(tower),
        options_(kRows.read(o)) {
    if (hands().hand(options_.reward_finger).num_tips <= kMiddle)
      fail(Code::kUnsupported, "jenga: robot %s has no second finger",
           hands().hand(options_.reward_finger).robot->name);
    if (options_.success_push == 0) options_.success_push = 2 * tower.target_end();
    hand_block_ = pairs_between(
        scene(), of_hand, [](const SceneShape& b) { return b.carrier == Carrier::kBody && b.index > 0; });
    FieldTable& table = own_fields();
    add_field(table, "target", "position", "m", 3);
    add_field(table, "target", "rotation", "1", 4);
    add_field(table, "target", "velocity", "m/s", 3);
    add_field(table, "target", "spin", "5 rad/s", 3);
    if (options_.extended_obs && tower.blocks > 0)
      add_field(table, "blocks", "position", "m", 3 * tower.blocks);
  }

  // True when the whole tower has come down.
  bool judge_costs(const World& world, const State& s, Verdict* v) const {
    double longest = 0, shortest = tower_.blocks > 0 ? 1e9 : 0, sum = 0, deepest = 0;
    bool all_dropped = tower_.blocks > 0;
    for (int i = 1; i <= tower_.blocks; ++i) {
      const Vec3 way = world.body(i).X.p - s.start[i];
      const double length = norm(way);
      longest = std::max(longest, length);
      shortest = std::min(shortest, length);
      sum += length;
      deepest = std::max(deepest, -way.z);
      all_dropped = all_dropped && std::fabs(way.z) > options_.drop_limit;
    }
    const int touched = touching(world, hand_block_);
    v->cost[kMoved] = longest > tower_.moved;
    v->cost_raw[kMoved] = longest;
    v->cost[kContact] = touched > 0;
    v->cost_raw[kContact] = touched;
    v->cost[kFall] = deepest >= tower_.half[1].z;
    v->cost_raw[kFall] = deepest;
    switch (options_.cost_mode) {
      case Mode::kAny:
        v->cost[kCost] = v->cost[kMoved];
        v->cost_raw[kCost] = longest;
        break;
      case Mode::kAll:
        v->cost[kCost] = shortest > options_.cost_all;
        v->cost_raw[kCost] = shortest;
        break;
      case Mode::kSum:
        v->cost[kCost] = sum > options_.cost_sum;
        v->cost_raw[kCost] = sum;
        break;
      case Mode::kContact:
        v->cost[kCost] = v->cost[kContact];
        v->cost_raw[kCost] = touched;
        break;
    }
    return all_dropped;
  }

  JengaTower tower_;
  JengaOptions options_;
  Vector<int32_t> hand_block_;
};

constexpr double kFovY = 45 * kPi / 180;
constexpr CameraSpec kCameras[] = {
    {"front", {0.9, -0.6, 0.7}, {0, -0.6, 0.36}, kFovY},
    {"top", {0, -0.6, 1.5}, {0, -0.6, 0.4}, kFovY},
    {"right", {0.55, -1.25, 0.75}, {0, -0.65, 0.38}, kFovY},
    {"left", {0.55, 0.05, 0.75}, {0, -0.55, 0.38}, kFovY},
    {"close", {0.5, -0.85, 0.5}, {0, -0.65, 0.41}, kFovY},
};

// Flying bases drift with their noise, and a block that was touched costs to the end.
constexpr auto kLearner = join_defaults(hand_learner("5", "0.03"),
                                        {{"action_repeat", "8"}, {"horizon", "8"}, {"discount", "0.99"}});

}  // namespace

constinit const TaskInfo kJenga = task_info<Jenga, kCosts, kCameras, kLearner>(
    "jenga", nullptr, "push one block out of a tower; cost: another block is more than 1 cm from its start",
    &filled_options<add_options>);

}  // namespace rdm
