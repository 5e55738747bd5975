#include "tasks/hand_over.hpp"

#include "tasks/safe_throw.hpp"

namespace rdm {
namespace {

// The left base is half a turn about x: palm up again.
const SafeThrowPlan kPlan = {{.rig = {.bases = {{{0, 0, 0.5}, {}}, {{0, -1, 0.5}, {0, 1, 0, 0}}}},
                              .place = {{0, -0.39, 0.54}, {0, -0.64, 0.54}},
                              .fall_height = 0.2},
                             &flat_throw_mean,
                             {}};

constexpr ThrowLearner kFingerLearner = throw_learner("40"), kJointLearner = throw_learner("30");

}  // namespace

const TaskInfo kHandOverSafeFinger = {
    "hand_over_safe_finger",
    "ShadowHandOverSafeFinger",
    "throw an object from hand to hand; cost: the first finger's joints leave their windows",
    &safe_throw_options<kPlan>,
    kFingerCosts.data(),
    kNumSafetyCosts,
    kThrowCameras,
    kNumThrowCameras,
    kFingerLearner.data(),
    static_cast<int32_t>(kFingerLearner.size()),
    &make_safe_throw<kPlan, SafetyKind::kFinger>,
    &destroy_safe_throw,
};

const TaskInfo kHandOverSafeJoint = {
    "hand_over_safe_joint",
    "ShadowHandOverSafeJoint",
    "throw an object from hand to hand; cost: the first finger's lateral joint leaves its window",
    &safe_throw_options<kPlan>,
    kJointCosts.data(),
    kNumSafetyCosts,
    kThrowCameras,
    kNumThrowCameras,
    kJointLearner.data(),
    static_cast<int32_t>(kJointLearner.size()),
    &make_safe_throw<kPlan, SafetyKind::kJoint>,
    &destroy_safe_throw,
};

}  // namespace rdm
