// Numbers over the episodes of a policy and over the runs of an algorithm, as a referee asks for them. They
// are those of redman.stats in Python, whose head has the sources, draw by draw.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/report.hpp"

namespace tool {

using Sample = std::vector<double>;
using Strata = std::vector<Sample>;  // of each task, what its runs came to

// NaN of no values, or of some that are not finite.
double mean_of(const Sample& values);
double quantile_of(Sample values, double at);  // a straight line between two values
// Interquartile mean: without the floor(n / 4) lowest and as many highest.
double iqm_of(Sample values);
double iqm_of(const Strata& strata);  // of all values together
// Conditional value at risk: the mean of the largest share; a value on its edge counts with the part of it
// that is within.
inline constexpr double kTailShare = 0.1;
double cvar_of(Sample values, double share = kTailShare);
// Of the sample (n - 1), and of its mean. NaN of less than two values.
double deviation_of(const Sample& values);
double standard_error_of(const Sample& values);

inline constexpr double kLevel = 0.95;
struct Interval {
  double low, high;
  bool has(double x) const { return low <= x && x <= high; }
  bool known() const { return low <= high; }
};
inline constexpr size_t kFewRuns = 5;                 // intervals of fewer are too narrow
std::string interval_text(const Interval& interval);  // "1.2 .. 3.4", "-" where it is not known
Json interval_json(const Interval& interval);

// Rows that were drawn with replacement from each stratum, as many as it has.
using Draw = std::vector<const uint32_t*>;
// Writes its numbers of a draw.
using Statistic = std::function<void(const Draw& rows, double* out)>;
// The percentile bootstrap: of each number of `statistic` the quantiles (1 - level) / 2 and (1 + level) / 2
// over 10,000 draws, which are the same in every call.
std::vector<Interval> bootstrap(const std::vector<size_t>& sizes, size_t numbers, const Statistic& statistic,
                                double level = kLevel);

// Below: runs are drawn within their tasks. NaN where a task has less than two of them, or one
// that is not finite.

// Of the interquartile mean, and of that of a less that of b, whose tasks are the same, in one order.
Interval iqm_interval(const Strata& runs, double level = kLevel);
Interval difference_interval(const Strata& a, const Strata& b, double level = kLevel);
// The probability that a run of a comes to more than one of b on the same task, a draw counting one half.
struct Improvement {
  double probability;
  Interval interval;
};
Improvement improvement_of(const Strata& a, const Strata& b, double level = kLevel);

// A letter for each group of rows of which no two are told apart: the interval of their difference holds 0,
// each pair for itself. A row has the letters of all its groups, "a" first where the rows come best first; ""
// where a row, by too few runs, is in none, or where there are more than kMostGrouped.
// Piepho: An Algorithm for a Letter-Based Representation of All-Pairwise Comparisons, J. Comp. Graph. Stat. 13,
// 2004.
inline constexpr size_t kMostGrouped = 100;
std::vector<std::string> group_letters(const std::vector<Strata>& rows, double level = kLevel);
// The same where the interval of the difference of rows i < j, which is asked for once each, is known already.
std::vector<std::string> group_letters(const std::vector<Strata>& rows,
                                       const std::function<Interval(size_t, size_t)>& difference);
// The same of any relation; apart(i, j) for i < j.
std::vector<std::string> group_letters(size_t count, const std::function<bool(size_t, size_t)>& apart);

}  // namespace tool
