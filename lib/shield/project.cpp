#include "shield/project.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"

namespace rdm {
namespace {

// Of normals of length 1: what counts as kept while it is solved, as across the others, and as above 0.
constexpr double kTight = 1e-9, kAcross = 1e-12, kAbove = 1e-11;
constexpr double kRounding = 0x1p-24;  // of an entry in [-1, 1] as a float, and as much again

double wide(float x) {
  return static_cast<double>(x);
}

double dot(const float* n, const double* x, int32_t dim) {
  double sum = 0;
  for (int32_t j = 0; j < dim; ++j) sum += wide(n[j]) * x[j];
  return sum;
}

double length(const float* n, int32_t dim) {
  double sum = 0;
  for (int32_t j = 0; j < dim; ++j) sum += wide(n[j]) * wide(n[j]);
  return std::sqrt(sum);
}

// The last float x on the right side of c x = b, within [-2, 2].
float bound_of(float c, float b) {
  const float way = c > 0 ? -2.0f : 2.0f;
  auto x = static_cast<float>(std::clamp(wide(b) / wide(c), -2.0, 2.0));
  while (wide(c) * wide(x) > wide(b) && x != way) x = std::nextafter(x, way);
  return x;
}

class Search {
 public:
  Search(const HalfSpace* rows, int32_t count, int32_t dim, const float* a) : dim_(dim) {
    std::fill_n(low_, dim, -1.0);
    std::fill_n(high_, dim, 1.0);
    for (int32_t i = 0; i < count; ++i) {
      const HalfSpace& row = rows[i];
      if (const int32_t j = single_entry(row, dim); j >= 0) {
        const double x = wide(bound_of(row.normal[j], row.bound));
        if (row.normal[j] > 0)
          high_[j] = std::min(high_[j], x);
        else
          low_[j] = std::max(low_[j], x);
        continue;
      }
      scale_[count_] = 1 / length(row.normal, dim);
      rows_[count_++] = row;
    }
    for (int32_t j = 0; j < dim; ++j) {
      x_[j] = wide(a[j]);
      side_[j] = 0;
      push_[j] = 0;
      if (x_[j] > high_[j])
        hold(j, 1);
      else if (x_[j] < low_[j])
        hold(j, -1);
    }
  }

  bool solve() {
    for (int32_t j = 0; j < dim_; ++j)
      if (low_[j] > high_[j]) return false;
    for (int32_t steps = 20 * (dim_ + count_); steps > 0;) {
      const Row p = worst();
      if (violation(p) <= kTight) return true;
      if (!add(p, &steps)) return false;
    }
    return false;
  }

  void read(float* x) const {
    for (int32_t j = 0; j < dim_; ++j) x[j] = static_cast<float>(std::clamp(x_[j], low_[j], high_[j]));
  }

 private:
  // One of rows_, or a bound of an entry, above (1) or below (-1).
  struct Row {
    int32_t index = -1, entry = -1, side = 0;
  };

  void hold(int32_t j, int32_t side) {
    const double x = side > 0 ? high_[j] : low_[j];
    push_[j] += side * (x_[j] - x);
    x_[j] = x;
    side_[j] = static_cast<int8_t>(side);
  }
  double entry_of(int32_t i, int32_t j) const { return scale_[i] * wide(rows_[i].normal[j]); }
  double violation(const Row& r) const {
    if (r.index >= 0)
      return scale_[r.index] * (dot(rows_[r.index].normal, x_, dim_) - wide(rows_[r.index].bound));
    if (r.side == 0) return 0;
    return r.side > 0 ? x_[r.entry] - high_[r.entry] : low_[r.entry] - x_[r.entry];
  }
  bool active(int32_t i) const { return std::find(set_, set_ + held_, i) != set_ + held_; }

  // Of those that are not active, the one that is violated most.
  Row worst() const {
    Row out;
    double most = 0;
    const auto look = [&](const Row& r) {
      const double v = violation(r);
      if (v <= most) return;
      most = v;
      out = r;
    };
    for (int32_t i = 0; i < count_; ++i)
      if (!active(i)) look({i, -1, 0});
    for (int32_t j = 0; j < dim_; ++j)
      if (side_[j] == 0) look({-1, j, x_[j] > high_[j] ? 1 : -1});
    return out;
  }

  // Makes p active, and what stands against it not. False: it cannot be kept beside what is active.
  bool add(const Row& p, int32_t* steps) {
    double u = 0;
    while ((*steps)-- > 0) {
      const double across = look_along(p);
      constexpr double kNever = std::numeric_limits<double>::infinity();
      const double whole = across > kAcross ? violation(p) / across : kNever;
      Row out;
      const double part = first_to_go(&out);
      const double t = std::min(part, whole);
      if (t == kNever) return false;
      for (int32_t k = 0; k < held_; ++k) pull_[k] -= t * y_[k];
      for (int32_t j = 0; j < dim_; ++j)
        if (side_[j] != 0)
          push_[j] -= t * z_[j];
        else if (whole < kNever)
          x_[j] -= t * z_[j];
      u += t;
      if (t == whole) {
        take(p, u);
        return true;
      }
      drop(out);
    }
    return false;
  }

  void take(const Row& p, double u) {
    if (p.index >= 0) {
      set_[held_] = p.index;
      pull_[held_++] = u;
      return;
    }
    hold(p.entry, p.side);
    push_[p.entry] = u;
  }

  void drop(const Row& r) {
    if (r.index < 0) {
      side_[r.entry] = 0;
      push_[r.entry] = 0;
      return;
    }
    const auto at = std::find(set_, set_ + held_, r.index) - set_;
    std::copy(set_ + at + 1, set_ + held_, set_ + at);
    std::copy(pull_ + at + 1, pull_ + held_, pull_ + at);
    --held_;
  }

  // The active row whose multiplier is 0 first, and after how long.
  double first_to_go(Row* out) const {
    double first = std::numeric_limits<double>::infinity();
    const auto look = [&](double u, double r, const Row& row) {
      if (r <= kAbove) return;
      const double t = std::max(u, 0.0) / r;
      if (t >= first) return;
      first = t;
      *out = row;
    };
    for (int32_t k = 0; k < held_; ++k) look(pull_[k], y_[k], {set_[k], -1, 0});
    for (int32_t j = 0; j < dim_; ++j)
      if (side_[j] != 0) look(push_[j], z_[j], {-1, j, side_[j]});
    return first;
  }

  // y_ of the rows, and z_: on free entries z, on others r of their bounds. The length of z, squared.
  double look_along(const Row& p) {
    std::fill_n(y_, held_, 0.0);
    for (int32_t j = 0; j < dim_; ++j)
      z_[j] = p.index >= 0 ? entry_of(p.index, j) : p.entry == j ? static_cast<double>(p.side) : 0;
    if (held_ > 0) {
      factor();
      for (int twice = 0; twice < 2; ++twice) subtract_rows();
    }
    double sum = 0;
    for (int32_t j = 0; j < dim_; ++j)
      if (side_[j] == 0)
        sum += z_[j] * z_[j];
      else
        z_[j] *= side_[j];
    return sum;
  }

  // Cholesky of the active rows' products over the free entries; the lower half of gram_.
  void factor() {
    for (int32_t k = 0; k < held_; ++k)
      for (int32_t l = 0; l <= k; ++l) {
        double sum = 0;
        for (int32_t j = 0; j < dim_; ++j)
          if (side_[j] == 0) sum += entry_of(set_[k], j) * entry_of(set_[l], j);
        for (int32_t m = 0; m < l; ++m) sum -= gram_[k][m] * gram_[l][m];
        gram_[k][l] = k == l ? std::sqrt(std::max(sum, kAcross * kAcross)) : sum / gram_[l][l];
      }
  }

  // What of z_ on the free entries is along the active rows goes into y_.
  void subtract_rows() {
    double s[kMostGuards];
    for (int32_t k = 0; k < held_; ++k) {
      double sum = 0;
      for (int32_t j = 0; j < dim_; ++j)
        if (side_[j] == 0) sum += entry_of(set_[k], j) * z_[j];
      for (int32_t m = 0; m < k; ++m) sum -= gram_[k][m] * s[m];
      s[k] = sum / gram_[k][k];
    }
    for (int32_t k = held_ - 1; k >= 0; --k) {
      for (int32_t m = k + 1; m < held_; ++m) s[k] -= gram_[m][k] * s[m];
      s[k] /= gram_[k][k];
    }
    for (int32_t k = 0; k < held_; ++k) {
      y_[k] += s[k];
      for (int32_t j = 0; j < dim_; ++j) z_[j] -= s[k] * entry_of(set_[k], j);
    }
  }

  const int32_t dim_;
  int32_t count_ = 0, held_ = 0;
  HalfSpace rows_[kMostGuards];
  double scale_[kMostGuards];                      // 1 / length of each normal
  double x_[kMostEntries], z_[kMostEntries];       // [dim]
  double low_[kMostEntries], high_[kMostEntries];  // [dim]
  int8_t side_[kMostEntries];                      // [dim] of an active bound; 0: the entry is free
  double push_[kMostEntries];                      // [dim] multipliers of these
  int32_t set_[kMostGuards];                       // [held] rows that are active
  double pull_[kMostGuards], y_[kMostGuards];      // [held] their multipliers
  double gram_[kMostGuards][kMostGuards];
};

}  // namespace

int32_t single_entry(const HalfSpace& row, int32_t dim) {
  int32_t entry = -1;
  for (int32_t j = 0; j < dim; ++j) {
    if (row.normal[j] == 0) continue;
    if (entry >= 0) return -1;
    entry = j;
  }
  return entry;
}

void check_half_space(const HalfSpace& row, int32_t dim, const char* name) {
  if (!std::isfinite(row.bound)) fail(Code::kArgument, "%s: its bound is not finite", name);
  bool any = false;
  for (int32_t j = 0; j < dim; ++j) {
    if (!std::isfinite(row.normal[j]))
      fail(Code::kArgument, "%s: entry %d of its normal is not finite", name, j);
    any |= row.normal[j] != 0;
  }
  if (!any) fail(Code::kArgument, "%s: its normal is 0", name);
}

int32_t most_violated(const HalfSpace* rows, int32_t count, int32_t dim, const float* a) {
  int32_t worst = -1;
  double most = 0;
  for (int32_t i = 0; i < count; ++i) {
    const float* n = rows[i].normal;
    double sum = 0, squares = 0, sizes = 0;
    int32_t entries = 0;
    for (int32_t j = 0; j < dim; ++j) {
      if (n[j] == 0) continue;
      sum += wide(n[j]) * std::clamp(wide(a[j]), -1.0, 1.0);
      squares += wide(n[j]) * wide(n[j]);
      sizes += std::abs(wide(n[j]));
      ++entries;
    }
    const double excess = sum - wide(rows[i].bound);
    if (excess <= (entries > 1 ? kRounding * sizes : 0)) continue;
    const double way = excess / std::sqrt(squares);
    if (worst >= 0 && way <= most) continue;
    most = way;
    worst = i;
  }
  return worst;
}

bool nearest_action(const HalfSpace* rows, int32_t count, int32_t dim, const float* a, float* x) {
  Search search(rows, count, dim, a);
  if (!search.solve()) return false;
  search.read(x);
  return true;
}

}  // namespace rdm
