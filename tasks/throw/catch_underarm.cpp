// Catch Over to Underarm (ReDMan 3.4, C): the right hand stands upright and throws an object down to the left
// hand, which lies palm up; both fly. Two tasks that differ in the cost alone. throw_task.hpp has the reward,
// safety_costs.hpp the costs.
#include "tasks/catalog.hpp"
#include "tasks/hand/hand_learner.hpp"
#include "tasks/throw/safe_throw.hpp"

namespace rdm {
namespace {

// The right hand's fingers point up, 0.1 rad towards +y, its palm faces -y; the left base is half a turn
// about x: palm up.
const SafeThrowConfig kConfig = {
    {.hands = {.bases = {{{0, 0, 0.5}, from_rpy({1.67, 3.14, 0})}, {{0, -0.8, 0.5}, {0, 1, 0, 0}}},
               .flying = true,
               .transition_scale = 0.05,
               .orientation_scale = 0.5},
     .place = {{0, 0.05, 1.03}, {0, -0.40, 0.55}},
     .fall_height = 0.3,
     .base_limit = 0.1},
    &flat_hand_mean,
    {.throw_height = 1.3, .throw_low = -60, .throw_high = 60}};

// A catch comes late in an episode and is learned late in a run: longer paths, steps that stay as large.
constexpr auto catch_learner(const char* cost_limit) {
  return join_defaults(join_defaults(throw_learner(cost_limit), kFineDecisions), {{"ppo:horizon", "32"},
                                                                                  {"ppo_lag:horizon", "32"},
                                                                                  {"std_min", "0.1"},
                                                                                  {"kl_target_end", "0"},
                                                                                  {"lr_min", "1e-5"},
                                                                                  {"shield_learn", "end"}});
}
constexpr auto kFingerLearner = catch_learner("40"), kJointLearner = catch_learner("30");

const CameraSpec kCameras[] = {
    {"front", {1.7, -0.4, 0.9}, {0, -0.35, 0.65}, 45 * kDegree},
    {"top", {0, -0.4, 2.2}, {0, -0.4, 0.6}, 45 * kDegree},
    {"right", {0.8, 0.7, 1.1}, {0, -0.2, 0.75}, 45 * kDegree},
    {"left", {0.8, -1.3, 1.0}, {0, -0.4, 0.65}, 45 * kDegree},
    {"close", {0.9, -0.25, 0.95}, {0, -0.2, 0.8}, 45 * kDegree},
    // close by, for point clouds
    {"cloud_above", {0, -0.3, 1.6}, {0, -0.25, 0.7}, 57 * kDegree},
    {"cloud_front", {0.7, -0.2, 0.9}, {0, -0.2, 0.75}, 57 * kDegree},
    {"cloud_back", {-0.7, -0.2, 0.9}, {0, -0.2, 0.75}, 57 * kDegree},
};

}  // namespace

constinit const TaskInfo kCatchUnderarmSafeFinger =
    task_info<SafeThrow, kFingerCosts, kCameras, kFingerLearner, &kConfig, SafetyKind::kFinger>(
        "catch_underarm_safe_finger", "ShadowHandCatchOver2UnderarmSafeFinger",
        "throw an object down to a flying hand; cost: the first finger's joints leave their windows",
        &filled_options<safe_throw_options<kConfig>>);

constinit const TaskInfo kCatchUnderarmSafeJoint =
    task_info<SafeThrow, kJointCosts, kCameras, kJointLearner, &kConfig, SafetyKind::kJoint>(
        "catch_underarm_safe_joint", "ShadowHandCatchOver2UnderarmSafeJoint",
        "throw an object down to a flying hand; cost: the first finger's lateral joint leaves its window",
        &filled_options<safe_throw_options<kConfig>>);

}  // namespace rdm
