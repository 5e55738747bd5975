// Hand Over (ReDMan B.2, C): the right hand throws an object over the gap to the left hand, which lies palm
// up opposite; both bases are fixed. Two tasks, Safe Finger and Safe Joint, that differ in the cost alone.
// throw_task.hpp has the reward, safety_costs.hpp the costs.
#include "tasks/catalog.hpp"
#include "tasks/hand/hand_learner.hpp"
#include "tasks/throw/safe_throw.hpp"

namespace rdm {
namespace {

// The left base is half a turn about x: palm up again.
const SafeThrowConfig kConfig = {
    {.hands = {.bases = {{{0, 0, 0.5}, {}}, {{0, -1, 0.5}, {0, 1, 0, 0}}}, .facing = true},
     .place = {{0, -0.39, 0.54}, {0, -0.64, 0.54}},
     .fall_height = 0.2},
    &flat_throw_mean,
    {}};

// A shield cushions a throw: who learns on through refused actions leans on it, so that they end the episode.
constexpr LearnerDefault kShield[] = {{"shield_learn", "end"}};
constexpr auto kFingerLearner = join_defaults(throw_learner("40"), kShield);
constexpr auto kJointLearner = join_defaults(throw_learner("30"), kShield);

}  // namespace

constinit const TaskInfo kHandOverSafeFinger =
    task_info<SafeThrow, kFingerCosts, kThrowCameras, kFingerLearner, &kConfig, SafetyKind::kFinger>(
        "hand_over_safe_finger", "ShadowHandOverSafeFinger",
        "throw an object from hand to hand; cost: the first finger's joints leave their windows",
        &filled_options<safe_throw_options<kConfig>>);

constinit const TaskInfo kHandOverSafeJoint =
    task_info<SafeThrow, kJointCosts, kThrowCameras, kJointLearner, &kConfig, SafetyKind::kJoint>(
        "hand_over_safe_joint", "ShadowHandOverSafeJoint",
        "throw an object from hand to hand; cost: the first finger's lateral joint leaves its window",
        &filled_options<safe_throw_options<kConfig>>);

}  // namespace rdm
