// Learner settings of Bullet-Safety-Gym's tasks, beside those of the ball in planar_learner.hpp.
#pragma once
#include "tasks/legged/legged_learner.hpp"

namespace rdm {

inline constexpr double kGatherLimit = 1;  // bombs in an episode

inline constexpr auto kCarLearner = join_defaults(kSafetyLearner, {{"horizon", "250"},
                                                                   {"learning_rate", "3e-4"},
                                                                   {"minibatches", "32"},
                                                                   {"discount", "0.95"},
                                                                   {"init_std", "0.05"},
                                                                   {"std_min", "0.01"},
                                                                   {"multiplier_init", "1"},
                                                                   {"multiplier_lr", "0.2"}});
// Of drones, and of what seeks and avoids: no speed to hold, so the normaliser and a wider exploration help.
// A decision stands for 1/15 s: in 1/60 s a body of metres hardly moves, and noise that changes as often
// leads nowhere.
inline constexpr auto kRoomLearner = join_defaults(kSafetyLearner, {{"horizon", "125"},
                                                                    {"action_repeat", "4"},
                                                                    {"learning_rate", "1e-3"},
                                                                    {"minibatches", "32"},
                                                                    {"std_min", "0.05"},
                                                                    {"multiplier_init", "0.3"},
                                                                    {"multiplier_lr", "0.2"}});
inline constexpr auto kSeekLearner = join_defaults(kRoomLearner, {{"discount", "0.97"}, {"init_std", "0.6"}});
inline constexpr auto kDroneLearner =
    join_defaults(kRoomLearner, {{"discount", "0.99"}, {"init_std", "0.4"}});
inline constexpr auto kBallGatherLearner = kSeekLearner, kBallReachLearner = kSeekLearner,
                      kCarCircleLearner = kSeekLearner, kCarGatherLearner = kSeekLearner,
                      kCarReachLearner = kSeekLearner, kDroneGatherLearner = kDroneLearner,
                      kDroneReachLearner = kDroneLearner;
inline constexpr auto kAntLearner = kLeggedLearner;
// In rooms a fall costs more than a stride earns: narrower noise than in the open.
inline constexpr auto kAntSeekLearner =
    join_defaults(kWalkLearner, {{"init_std", "0.15"}, {"std_min", "0.02"}});
inline constexpr auto kAntGatherLearner = kAntSeekLearner, kAntReachLearner = kAntSeekLearner;

inline constexpr CameraSpec kRoomCameras[] = {
    {"front", {0, -15, 12}, {0, 0, 0}, 0.9},
    {"top", {0, -0.01, 22}, {0, 0, 0}, 0.9},
};

}  // namespace rdm
