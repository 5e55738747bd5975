// Which of several simulated trajectories (courses) is the better one, and how a method combines them.
//
// Rule feasible: a trajectory whose costs all stay within their budgets comes before every one that exceeds any.
// Within the budgets they are ranked by return, beyond them by the excess, summed over the limited costs. Rule
// multiplier: by the return minus the multiplier times the sum of the limited costs. A trajectory that diverged
// (lost) comes last.
#pragma once
#include <cstdint>

#include "env/task.hpp"

namespace rdm {

enum class CostRule : int32_t { kFeasible = 0, kMultiplier = 1, kIgnore = 2 };

// The outcome of a simulated trajectory.
struct Course {
  double ret = 0;                   // discounted sum of rewards, with the terminal value
  double cost[kMaxTaskCosts] = {};  // sums, of every column
  bool lost = false;                // it diverged
};

struct CourseRule {
  CostRule rule = CostRule::kFeasible;
  double multiplier = 0;
  int32_t num_costs = 0;
  double budget[kMaxTaskCosts] = {};  // [num_costs] that is left, 0 or more; < 0: the cost has no limit
};

// Rank key of a trajectory: a lower group comes first; within a group the higher score, then the higher return.
enum class CourseGroup : int32_t { kWithin = 0, kBeyond = 1, kLost = 2 };
struct Standing {
  CourseGroup group = CourseGroup::kWithin;
  double score = 0, ret = 0;
};
Standing standing(const Course& course, const CourseRule& rule);
bool better(const Standing& a, const Standing& b);
// Every limited cost stays within its budget.
bool within(const Course& course, const CourseRule& rule);

// order [count]: the best first; of equals the one with the lower number.
void rank_courses(const Standing* standings, int32_t count, int32_t* order);

// Model predictive path integral (Williams et al. 2017): weights [count] of the best group's courses,
//   w_i = exp((score_i - max score) / (temperature s)) / sum
// with s the standard deviation of their scores, so that a temperature means the same for rewards of any
// size. All are equal where s is 0; those of other groups are 0.
void path_integral_weights(const Standing* standings, int32_t count, double temperature, double* weights);

// Cross-entropy (Rubinstein 1999): deviation [width] of the first `elites` of `order` about their mean, of
// noise [samples][width], no less than floor [width].
void elite_deviation(const float* noise, const int32_t* order, int32_t elites, int32_t width,
                     const float* floor, float* deviation);

}  // namespace rdm
