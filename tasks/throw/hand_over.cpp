#include "tasks/throw/hand_over.hpp"

#include "tasks/hand/hand_learner.hpp"
#include "tasks/throw/safe_throw.hpp"

namespace rdm {
namespace {

// The left base is half a turn about x: palm up again.
const SafeThrowConfig kPlan = {{.rig = {.bases = {{{0, 0, 0.5}, {}}, {{0, -1, 0.5}, {0, 1, 0, 0}}}},
                                .place = {{0, -0.39, 0.54}, {0, -0.64, 0.54}},
                                .fall_height = 0.2},
                               &flat_throw_mean,
                               {}};

constexpr auto kFingerLearner = throw_learner("40"), kJointLearner = throw_learner("30");

}  // namespace

constinit const TaskInfo kHandOverSafeFinger =
    task_info<PlannedThrow<kPlan, SafetyKind::kFinger>, kFingerCosts, kThrowCameras, kFingerLearner>(
        "hand_over_safe_finger", "ShadowHandOverSafeFinger",
        "throw an object from hand to hand; cost: the first finger's joints leave their windows",
        &filled_options<add_planned_options<kPlan>>);

constinit const TaskInfo kHandOverSafeJoint =
    task_info<PlannedThrow<kPlan, SafetyKind::kJoint>, kJointCosts, kThrowCameras, kJointLearner>(
        "hand_over_safe_joint", "ShadowHandOverSafeJoint",
        "throw an object from hand to hand; cost: the first finger's lateral joint leaves its window",
        &filled_options<add_planned_options<kPlan>>);

}  // namespace rdm
