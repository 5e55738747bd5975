#include "plan/ranking.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"

namespace rdm {

bool within(const Course& course, const CourseRule& rule) {
  for (int32_t k = 0; k < rule.num_costs; ++k)
    if (rule.budget[k] >= 0 && course.cost[k] > rule.budget[k]) return false;
  return true;
}

Standing standing(const Course& course, const CourseRule& rule) {
  Standing s{CourseGroup::kWithin, course.ret, course.ret};
  double excess = 0, sum = 0;
  for (int32_t k = 0; k < rule.num_costs; ++k) {
    if (rule.budget[k] < 0) continue;  // no limit on this column
    excess += std::max(course.cost[k] - rule.budget[k], 0.0);
    sum += course.cost[k];
  }
  // The multiplier prices all cost, not the excess alone: it is a learner's, whose objective is this sum.
  if (rule.rule == CostRule::kMultiplier) s.score -= rule.multiplier * sum;
  // Beyond a budget the return no longer counts, but as a tie: what is least beyond is best.
  if (rule.rule == CostRule::kFeasible && !within(course, rule)) {
    s.group = CourseGroup::kBeyond;
    s.score = -excess;
  }
  // NaN would break the order of a sort: such courses are lost, and equal.
  if (course.lost || !std::isfinite(s.score) || !std::isfinite(s.ret))
    s = {CourseGroup::kLost, 0, course.lost && std::isfinite(course.ret) ? course.ret : 0};
  return s;
}

// By group, then score, then return.
bool better(const Standing& a, const Standing& b) {
  if (a.group != b.group) return a.group < b.group;
  if (a.score != b.score) return a.score > b.score;
  return a.ret > b.ret;
}

void rank_courses(const Standing* standings, int32_t count, int32_t* order) {
  for (int32_t i = 0; i < count; ++i) order[i] = i;
  std::sort(order, order + count, [&](int32_t a, int32_t b) {
    if (better(standings[a], standings[b])) return true;
    return !better(standings[b], standings[a]) && a < b;  // equal ones by number: one order on every machine
  });
}

void path_integral_weights(const Standing* standings, int32_t count, double temperature, double* weights) {
  // Only the best group has weight: a course beyond its budget must not pull at one within.
  CourseGroup best = CourseGroup::kLost;
  for (int32_t i = 0; i < count; ++i) best = std::min(best, standings[i].group);
  double most = 0, sum = 0;
  int32_t members = 0;
  for (int32_t i = 0; i < count; ++i) {
    if (standings[i].group != best) continue;
    most = members ? std::max(most, standings[i].score) : standings[i].score;
    sum += standings[i].score;
    ++members;
  }
  double squares = 0;
  const double mean = sum / members;
  for (int32_t i = 0; i < count; ++i)
    if (standings[i].group == best) squares += (standings[i].score - mean) * (standings[i].score - mean);
  // In units of the scores' deviation, so that a temperature means the same for every reward.
  const double scale = temperature * std::sqrt(squares / members);
  double total = 0;
  for (int32_t i = 0; i < count; ++i) {
    weights[i] = 0;
    if (standings[i].group != best) continue;
    weights[i] = scale > 0 ? elementary::exp((standings[i].score - most) / scale) : 1;
    total += weights[i];
  }
  for (int32_t i = 0; i < count; ++i) weights[i] /= total;
}

void elite_deviation(const float* noise, const int32_t* order, int32_t elites, int32_t width,
                     const float* floor, float* deviation) {
  const auto entry = [&](int32_t e, int32_t j) {
    return static_cast<double>(
        noise[static_cast<size_t>(order[e]) * static_cast<size_t>(width) + static_cast<size_t>(j)]);
  };
  for (int32_t j = 0; j < width; ++j) {
    double mean = 0, squares = 0;
    for (int32_t e = 0; e < elites; ++e) mean += entry(e, j);
    mean /= elites;
    for (int32_t e = 0; e < elites; ++e) squares += (entry(e, j) - mean) * (entry(e, j) - mean);
    // the floor keeps the next round from standing still
    deviation[j] = std::max(static_cast<float>(std::sqrt(squares / elites)), floor[j]);
  }
}

}  // namespace rdm
