// Learner settings of walkers.
#pragma once
#include "tasks/planar/planar_learner.hpp"

namespace rdm {

inline constexpr auto kWalkLearner = join_defaults(kSafetyLearner, {{"horizon", "256"},
                                                                    {"learning_rate", "3e-4"},
                                                                    {"minibatches", "32"},
                                                                    {"discount", "0.99"},
                                                                    {"multiplier_init", "0.3"},
                                                                    {"multiplier_lr", "0.1"}});
inline constexpr auto kLeggedLearner =
    join_defaults(kWalkLearner, {{"init_std", "0.6"}, {"std_min", "0.05"}});

}  // namespace rdm
