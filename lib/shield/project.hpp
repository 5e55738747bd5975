// The action nearest to one that is proposed, of those that keep half spaces.
//
//   x = argmin |x - a|^2   with   n_i . x <= b_i   and   -1 <= x_j <= 1
//
// A row whose normal has a single entry is a bound of that entry. Where there are no others, x is a clip. With one
// other row, and no entry at a bound,
//   x = a - max(0, n . a - b) / (n . n) n
// which is the first step of what solves the rest: the dual active-set method of Goldfarb and Idnani ("A numerically
// stable dual method for solving strictly convex quadratic programs", Mathematical Programming 27, 1983), whose
// Hessian is the identity here. It begins at the clip, with the bounds that hold there active, and adds the row that
// is violated most:
//   z = n - N y                   the part of its normal across the active ones N, y by least squares
//   t = min(over active k with r_k > 0: u_k / r_k,  (n . x - b) / (z . z))
//   x <- x - t z,  u <- u - t r   multipliers; r is y, or of a bound what is left of n in its entry
// and leaves out what has a multiplier of 0 then. Each such step raises the dual value, so that no active set comes
// twice, and there are finitely many. Where z is 0 and no r is above 0, no action keeps all rows.
//
// Least squares need the active rows alone, on the entries that are free: their Gram matrix by Cholesky, twice, so that
// z is as true as by an orthogonal factor (Bjorck's corrected seminormal equations). All sums run in the order of
// the entries: same numbers, same bytes.
#pragma once
#include <cstdint>

namespace rdm {

inline constexpr int32_t kMostGuards = 32;     // half spaces
inline constexpr int32_t kMostEntries = 1024;  // of an action

struct HalfSpace {
  const float* normal;  // [dim], finite and not 0
  float bound;          // finite
};

// Error(kArgument) for what is none, with its name.
void check_half_space(const HalfSpace& row, int32_t dim, const char* name);
// Its single entry; -1: there are several.
int32_t single_entry(const HalfSpace& row, int32_t dim);

// The row that action a, clipped, violates by the longest way; -1: it keeps them all. Bounds are kept exactly, others
// to the rounding of the entries: 2^-24 times the sum of |n_j|.
int32_t most_violated(const HalfSpace* rows, int32_t count, int32_t dim, const float* a);

// x [dim], finite a given; they may be the same. False: no action keeps the rows, and x is as before. No heap.
bool nearest_action(const HalfSpace* rows, int32_t count, int32_t dim, const float* a, float* x);

}  // namespace rdm
