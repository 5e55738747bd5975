// The nearest action that keeps half spaces: against the best of all active sets, the optimality conditions, and values
// by hand; degenerate and empty sets; no heap.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/rng.hpp"
#include "heap_count.hpp"
#include "shield/project.hpp"

namespace rdm {
namespace {

constexpr double kNear = 1e-6;

struct Set {
  int32_t dim = 0;
  std::vector<float> normals, bounds;

  int32_t count() const { return static_cast<int32_t>(bounds.size()); }
  void add(std::vector<float> normal, float bound) {
    normals.insert(normals.end(), normal.begin(), normal.end());
    bounds.push_back(bound);
  }
  std::vector<HalfSpace> rows() const {
    std::vector<HalfSpace> out;
    for (int32_t i = 0; i < count(); ++i)
      out.push_back({normals.data() + i * dim, bounds[static_cast<size_t>(i)]});
    return out;
  }
  // All rows with normals of length 1, then the box: N x <= b.
  Eigen::MatrixXd all() const {
    Eigen::MatrixXd n(count() + 2 * dim, dim + 1);
    n.setZero();
    for (int32_t i = 0; i < count(); ++i) {
      for (int32_t j = 0; j < dim; ++j)
        n(i, j) = static_cast<double>(normals[static_cast<size_t>(i * dim + j)]);
      n(i, dim) = static_cast<double>(bounds[static_cast<size_t>(i)]);
      n.row(i) /= n.row(i).head(dim).norm();
    }
    for (int32_t j = 0; j < dim; ++j) {
      n(count() + 2 * j, j) = 1;
      n(count() + 2 * j + 1, j) = -1;
      n(count() + 2 * j, dim) = n(count() + 2 * j + 1, dim) = 1;
    }
    return n;
  }
};

std::optional<std::vector<float>> nearest(const Set& set, const std::vector<float>& a) {
  std::vector<float> x(a.size());
  const auto rows = set.rows();
  if (!nearest_action(rows.data(), set.count(), set.dim, a.data(), x.data())) return {};
  return x;
}

Eigen::VectorXd wide(const std::vector<float>& x) {
  return Eigen::Map<const Eigen::VectorXf>(x.data(), static_cast<Eigen::Index>(x.size())).cast<double>();
}

std::vector<float> normals_of(Stream& s, int32_t count, float scale = 1) {
  std::vector<float> out(static_cast<size_t>(count));
  s.normals(out.data(), count);
  for (float& v : out) v *= scale;
  return out;
}

// Some of the normals have a single entry, or few; the origin keeps most sets.
Set random_set(Stream& s, int32_t dim, int32_t count) {
  Set set;
  set.dim = dim;
  for (int32_t i = 0; i < count; ++i) {
    auto n = normals_of(s, dim, static_cast<float>(std::exp(4 * s.signed_unit())));
    const double kind = s.uniform();
    if (kind < 0.5)
      for (int32_t j = 0; j < dim; ++j)
        if (kind < 0.25 ? j != i % dim : s.uniform() < 0.6) n[static_cast<size_t>(j)] = 0;
    double length = 0;
    for (const float v : n) length += static_cast<double>(v) * static_cast<double>(v);
    if (length == 0) n[0] = 1, length = 1;
    set.add(n, static_cast<float>(std::sqrt(length) * (0.6 * s.uniform() - 0.05)));
  }
  return set;
}

// The nearest of the points that any set of active rows alone would give; none: no point keeps all.
std::optional<double> distance_by_all_sets(const Set& set, const std::vector<float>& a) {
  const Eigen::MatrixXd all = set.all();
  const auto rows = static_cast<int32_t>(all.rows());
  const Eigen::MatrixXd n = all.leftCols(set.dim);
  const Eigen::VectorXd b = all.col(set.dim), from = wide(a);
  std::optional<double> best;
  for (uint32_t chosen = 0; chosen < 1u << rows; ++chosen) {
    std::vector<int32_t> active;
    for (int32_t i = 0; i < rows; ++i)
      if (chosen >> i & 1u) active.push_back(i);
    if (static_cast<int32_t>(active.size()) > set.dim) continue;
    Eigen::VectorXd x = from;
    if (!active.empty()) {
      const Eigen::MatrixXd m = n(active, Eigen::all);
      const Eigen::MatrixXd gram = m * m.transpose();
      if (gram.determinant() < 1e-9) continue;
      x = from - m.transpose() * gram.ldlt().solve(m * from - b(active));
    }
    if ((n * x - b).maxCoeff() > 1e-7) continue;
    const double way = (from - x).norm();
    if (!best || way < *best) best = way;
  }
  return best;
}

// Feasible, a - x a sum of normals of rows that x is at, with multipliers of 0 or more.
void expect_optimal(const Set& set, const std::vector<float>& a, const std::vector<float>& x) {
  const Eigen::MatrixXd all = set.all();
  const Eigen::MatrixXd n = all.leftCols(set.dim);
  const Eigen::VectorXd slack = all.col(set.dim) - n * wide(x), gap = wide(a) - wide(x);
  EXPECT_GE(slack.minCoeff(), -kNear);
  std::vector<int32_t> active;
  for (int32_t i = 0; i < slack.size(); ++i)
    if (slack(i) < kNear) active.push_back(i);
  // multipliers by coordinate descent
  Eigen::VectorXd u = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(active.size())), rest = gap;
  for (int sweep = 0; sweep < 20000 && rest.norm() > 0.1 * kNear; ++sweep)
    for (size_t k = 0; k < active.size(); ++k) {
      const auto row = n.row(active[k]);
      const double step = std::max(row.dot(rest), -u(static_cast<Eigen::Index>(k)));
      u(static_cast<Eigen::Index>(k)) += step;
      rest -= step * row.transpose();
    }
  EXPECT_LT(rest.norm(), kNear * std::max(1.0, gap.norm())) << active.size() << " rows are active";
}

TEST(Projection, ClipsExactlyWhereRowsHaveSingleEntries) {
  Set set;
  set.dim = 3;
  set.add({0, 3, 0}, 1);
  set.add({0, 0, -1}, 0.25f);
  set.add({0, 1, 0}, 0.5f);
  const auto x = *nearest(set, {-4, 0.9f, -0.75f});
  EXPECT_EQ(x[0], -1);
  EXPECT_LE(3.0 * static_cast<double>(x[1]), 1.0);
  EXPECT_GT(3.0 * static_cast<double>(std::nextafter(x[1], 1.0f)), 1.0);
  EXPECT_EQ(x[2], -0.25f);
  EXPECT_EQ(*nearest(set, x), x);
}

TEST(Projection, GoesStraightToASingleHalfSpace) {
  Stream s(1, 0, Purpose::kShield);
  for (int i = 0; i < 1000; ++i) {
    Set set;
    set.dim = 5;
    set.add(normals_of(s, 5), 0.1f);
    const auto a = normals_of(s, 5, 0.2f);
    const Eigen::VectorXd n = wide(set.normals), from = wide(a);
    const Eigen::VectorXd to =
        from - std::max(0.0, n.dot(from) - static_cast<double>(0.1f)) / n.squaredNorm() * n;
    if (to.cwiseAbs().maxCoeff() > 1) continue;
    EXPECT_LT((wide(*nearest(set, a)) - to).norm(), 1e-6);
  }
}

TEST(Projection, IsTheBestOfAllActiveSets) {
  Stream s(2, 0, Purpose::kShield);
  int32_t empty = 0;
  for (int32_t i = 0; i < 3000; ++i) {
    const int32_t dim = 1 + i % 3;
    const Set set = random_set(s, dim, 1 + i % 4);
    const auto a = normals_of(s, dim);
    const auto best = distance_by_all_sets(set, a);
    const auto x = nearest(set, a);
    ASSERT_EQ(x.has_value(), best.has_value()) << i;
    empty += !x;
    if (!x) continue;
    EXPECT_NEAR((wide(*x) - wide(a)).norm(), *best, kNear) << i;
    expect_optimal(set, a, *x);
  }
  EXPECT_GT(empty, 10);
  EXPECT_LT(empty, 1500);
}

TEST(Projection, KeepsTheOptimalityConditions) {
  Stream s(3, 0, Purpose::kShield);
  int32_t several = 0;
  for (int32_t i = 0; i < 2000; ++i) {
    const int32_t dim = 2 + i % 63, count = 1 + i % kMostGuards;
    const Set set = random_set(s, dim, count);
    const auto a = normals_of(s, dim, 1.5f);
    const auto x = nearest(set, a);
    if (!x) continue;
    several += count > 8;
    expect_optimal(set, a, *x);
    const auto rows = set.rows();
    EXPECT_EQ(most_violated(rows.data(), count, dim, x->data()), -1) << i;
    const auto again = *nearest(set, *x);
    EXPECT_LT((wide(again) - wide(*x)).norm(), 1e-6);
    EXPECT_EQ(*nearest(set, a), *x);
  }
  EXPECT_GT(several, 200);
}

TEST(Projection, TakesRowsThatSayTheSame) {
  Stream s(4, 0, Purpose::kShield);
  for (int32_t i = 0; i < 1000; ++i) {
    const int32_t dim = 2 + i % 7;
    Set one = random_set(s, dim, 2), more = one;
    for (int32_t k = 0; k < 2; ++k) {
      std::vector<float> n(one.normals.begin() + k * dim, one.normals.begin() + (k + 1) * dim);
      const float b = one.bounds[static_cast<size_t>(k)];
      more.add(n, b);  // twice
      for (float& v : n) v *= 4;
      more.add(n, 4 * b);      // longer
      more.add(n, 4 * b + 1);  // behind it
    }
    const auto a = normals_of(s, dim, 2);
    const auto x = nearest(one, a), y = nearest(more, a);
    ASSERT_EQ(x.has_value(), y.has_value());
    if (!x) continue;
    EXPECT_LT((wide(*x) - wide(*y)).norm(), kNear);
    expect_optimal(more, a, *y);
  }
}

// Two rows that face each other leave a plane; two that all but do, a wedge.
TEST(Projection, TakesThinSets) {
  Stream s(5, 0, Purpose::kShield);
  for (int32_t i = 0; i < 1000; ++i) {
    const int32_t dim = 2 + i % 5;
    Set set;
    set.dim = dim;
    auto n = normals_of(s, dim);
    const float b = static_cast<float>(0.2 * s.signed_unit());
    set.add(n, b);
    for (float& v : n) v = -v;
    if (i % 2) n[0] += 1e-4f;
    set.add(n, i % 2 ? -b + 1e-3f : -b);
    const auto a = normals_of(s, dim);
    const auto x = nearest(set, a);
    if (i % 2 && !x) continue;
    ASSERT_TRUE(x) << i;
    const auto rows = set.rows();
    EXPECT_EQ(most_violated(rows.data(), 2, dim, x->data()), -1);
    if (i % 2 == 0) expect_optimal(set, a, *x);
  }
  // the corner of the box alone
  Set corner;
  corner.dim = 3;
  corner.add({-1, -1, -1}, -3);
  EXPECT_EQ(*nearest(corner, {0.1f, -2, 7}), (std::vector<float>{1, 1, 1}));
}

// Rows that are all but parallel: what can be kept is kept from wherever one comes.
TEST(Projection, FindsFromEverywhereWhatIsThere) {
  Stream s(7, 0, Purpose::kShield);
  int32_t kept = 0;
  for (int32_t i = 0; i < 2000; ++i) {
    const int32_t dim = 2 + i % 12, count = 2 + i % 9;
    const auto apart = static_cast<float>(std::exp(-16 * s.uniform()));
    const auto base = normals_of(s, dim);
    Set set;
    set.dim = dim;
    for (int32_t k = 0; k < count; ++k) {
      auto n = normals_of(s, dim, apart);
      const float side = s.uniform() < 0.5 ? -1.0f : 1.0f;
      for (int32_t j = 0; j < dim; ++j) n[static_cast<size_t>(j)] += side * base[static_cast<size_t>(j)];
      set.add(n, static_cast<float>(0.3 * s.uniform()));
    }
    const auto rows = set.rows();
    for (int32_t k = 0; k < 10; ++k) {
      const auto x = nearest(set, normals_of(s, dim, k == 0 ? 0.0f : 2.0f));
      ASSERT_TRUE(x) << i << ", " << k;  // the origin keeps them
      kept += most_violated(rows.data(), count, dim, x->data()) < 0;
    }
  }
  EXPECT_EQ(kept, 20000);
}

TEST(Projection, SaysThatNothingKeepsTheRows) {
  Set set;
  set.dim = 2;
  std::vector<float> x{0.25f, 0.5f};
  const auto none = [&] {
    const auto rows = set.rows();
    const auto before = x;
    EXPECT_FALSE(nearest_action(rows.data(), set.count(), 2, x.data(), x.data()));
    EXPECT_EQ(x, before);
    set.normals.clear();
    set.bounds.clear();
  };
  set.add({1, 0}, -1.5f);  // outside the box
  none();
  set.add({1, 0}, 0.1f), set.add({-1, 0}, -0.2f);
  none();
  set.add({1, 1}, -2.1f);
  none();
  set.add({1, 2}, 0.1f), set.add({-1, -2}, -0.11f);
  none();
  set.add({1, 1}, -0.5f), set.add({-1, 0.5f}, -0.4f), set.add({0.2f, -1}, -0.5f);
  none();
}

TEST(Projection, NamesWhatIsNoHalfSpace) {
  const auto text = [](const float* n, float b) -> std::string {
    try {
      check_half_space({n, b}, 2, "guard 7");
    } catch (const Error& e) {
      EXPECT_EQ(e.code, Code::kArgument);
      return e.text;
    }
    return "";
  };
  const float zero[] = {0, 0}, good[] = {0, 1}, bad[] = {1, std::numeric_limits<float>::infinity()};
  EXPECT_EQ(text(zero, 1), "guard 7: its normal is 0");
  EXPECT_EQ(text(bad, 1), "guard 7: entry 1 of its normal is not finite");
  EXPECT_EQ(text(good, std::numeric_limits<float>::quiet_NaN()), "guard 7: its bound is not finite");
  EXPECT_EQ(text(good, 1), "");
  EXPECT_EQ(single_entry({good, 1}, 2), 1);
  EXPECT_EQ(single_entry({bad, 1}, 2), -1);
}

TEST(Projection, TakesNothingFromTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the sanitizer counts";
  Stream s(6, 0, Purpose::kShield);
  const Set set = random_set(s, 64, kMostGuards);
  const auto rows = set.rows();
  const auto a = normals_of(s, 64);
  auto x = a;
  const int64_t before = heap_count();
  nearest_action(rows.data(), set.count(), 64, a.data(), x.data());
  EXPECT_EQ(heap_count(), before);
}

}  // namespace
}  // namespace rdm
