// Grasp (ReDMan B.3): a hand over the ground, palm down, lifts a cube; its finger joints should not strain.
//
//   r = 100 z                       height of the cube, m; option reward = lift: above lift_height
//   c = [some |torque_i| > 0.4 limit_i], i: driven joints of the fingers
//
// The paper's page gives neither: "the joints of the fingers should not exert excessive force". The reward is
// that of its code, the share of the effort limit ours.
#include <algorithm>
#include <cmath>

#include "tasks/catalog.hpp"
#include "tasks/hand/hand_learner.hpp"
#include "tasks/hand/single_hand.hpp"

namespace rdm {
namespace {

// Half a turn about y: palm down, fingers still along -y.
const SingleHandConfig kConfig = {{.count = 1, .bases = {{{0, 0, 0.1}, {0, 0, 1, 0}}}, .friction = 0.75},
                                  {.start = {0, -0.4, 0.026},
                                   .goal = {0, -0.4, 0.1},
                                   .noise = 0.001,
                                   .object = "cube",
                                   .start_rotation = "yaw",
                                   .standing = true},
                                  0};

enum : int { kCost, kFingerEffort, kFingerRange, kNumCosts };
constexpr CostSpec kCosts[kNumCosts] = {
    {"cost", "1 if a finger joint strains as cost_mode defines; raw: the value it measures", 25},
    {"finger_effort",
     "1 if a finger joint's torque is above effort_share of its limit; raw: the largest share", -1},
    {"finger_range", "1 if a command of the first finger is beyond finger_range; raw: the largest one", -1},
};

enum class Mean { kClose, kHold, kZero };  // of a new policy
struct GraspOptions {
  bool lift;                           // the reward counts from lift_height on
  double lift_height, success_height;  // m
  int cost;                            // the column that the cost is
  double effort_share, finger_range;
  Mean initial_mean;
};
constexpr auto kRows = option_rows<GraspOptions>(
    row<&GraspOptions::lift, false, true>(basic(text_option(
        "reward", "literal", "literal|lift",
        "literal: 100 times the object's height in m; lift: 100 times its height above lift_height"))),
    row<&GraspOptions::lift_height>(basic(
        number_option("lift_height", 0.025, -1, 10, "height of the object that counts as not lifted, m"))),
    row<&GraspOptions::success_height>(
        basic(number_option("success_height", 0.1, 0, 10, "height of the object that counts as success, m"))),
    row<&GraspOptions::cost, kFingerEffort, kFingerEffort, kFingerRange>(
        legacy(text_option("cost_mode", "default", "default|paper|literal",
                           "what costs: default, paper: a finger joint's torque; literal: the range of the "
                           "first finger's command"))),
    row<&GraspOptions::effort_share>(number_option(
        "effort_share", 0.4, 0, 1, "a finger joint's torque above this share of its effort limit costs 1")),
    row<&GraspOptions::initial_mean, Mean::kClose, Mean::kHold, Mean::kZero>(
        text_option("initial_mean", "close", "close|hold|zero",
                    "mean action of a new policy: close (wrist down, fingers around the cube), hold (the "
                    "hold action) or 0")),
    row<&GraspOptions::finger_range>(
        number_option("finger_range", 0.9, 0, 1,
                      "column finger_range costs 1 if a command of the first finger is beyond +-this")));

void add_options(OptionTable& table) {
  add_single_hand_options(kConfig, table);
  table.add(kRows);
}

class Grasp final : public SingleHand {
 public:
  explicit Grasp(const Options& o)
      : SingleHand(kConfig, o), options_(kRows.read(o)), floor_(options_.lift ? options_.lift_height : 0) {
    if (options_.initial_mean == Mean::kHold)
      hold_action(initial_mean_);
    else
      hands().hold_arms(initial_mean_);
    if (options_.initial_mean == Mean::kClose && closed().count > 0)
      std::copy(closed().begin() + hand().arm_actions, closed().end(), initial_mean_ + hand().arm_entries());
    const Robot& robot = *hand().robot;
    const RobotFinger& first = robot.fingers[0];
    for (int32_t i = 0; i < hand().num_actions; ++i) {
      const int32_t joint = hand().joint(i);
      if (joint >= first.first) finger_actions_.push_back(i);
      if (joint >= first.first && joint <= robot.tips[0].link) first_finger_actions_.push_back(i);
    }
  }

 private:
  void judge_step(const Step& step, Verdict* v) const override {
    const double height = step.world.body(0).X.p.z;
    v->reward = 100 * (height - floor_);
    v->success = height >= options_.success_height;
    double effort = 0, range = 0;
    for (const int32_t i : finger_actions_) {
      const int32_t joint = hand().joint(i);
      effort = std::max(effort, std::abs(step.world.torque()[hand().first + joint]) / hand().effort[joint]);
    }
    for (const int32_t i : first_finger_actions_) range = std::max(range, std::abs(step.command[i]));
    v->cost[kFingerEffort] = effort > options_.effort_share;
    v->cost_raw[kFingerEffort] = effort;
    v->cost[kFingerRange] = range > options_.finger_range;
    v->cost_raw[kFingerRange] = range;
    v->cost[kCost] = v->cost[options_.cost];
    v->cost_raw[kCost] = v->cost_raw[options_.cost];
  }

  const Table<float>& closed() const { return hand().robot->poses.closed; }

  GraspOptions options_;
  double floor_;  // m
  Vector<int32_t> finger_actions_, first_finger_actions_;
};

const CameraSpec kCameras[] = {
    {"front", {0.7, -0.7, 0.35}, {0, -0.35, 0.06}, 45 * kDegree},
    {"top", {0, -0.35, 1.0}, {0, -0.36, 0.05}, 45 * kDegree},
    {"right", {0.6, 0.1, 0.3}, {0, -0.35, 0.05}, 45 * kDegree},
    {"left", {-0.7, -0.6, 0.3}, {0, -0.35, 0.05}, 45 * kDegree},
    {"close", {0.35, -0.6, 0.16}, {0, -0.38, 0.05}, 45 * kDegree},
    // close by, for point clouds
    {"cloud_above", {0, -0.4, 0.6}, {0, -0.39, 0.05}, 57 * kDegree},
    {"cloud_front", {0.35, -0.55, 0.2}, {0, -0.38, 0.05}, 57 * kDegree},
    {"cloud_back", {-0.35, -0.55, 0.2}, {0, -0.38, 0.05}, 57 * kDegree},
};

constexpr auto kLearner = hand_learner("25", "0.15");

}  // namespace

constinit const TaskInfo kGrasp = task_info<Grasp, kCosts, kCameras, kLearner>(
    "grasp", nullptr, "lift a cube from the ground; cost: a finger joint's torque above 0.4 of its limit",
    &filled_options<add_options>);

}  // namespace rdm
