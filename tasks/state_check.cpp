#include "tasks/state_check.hpp"

#include <cmath>

#include "base/error.hpp"

namespace rdm {
namespace {

template <class T>
void check(const char* what, const T* values, size_t count, double bound) {
  for (size_t i = 0; i < count; ++i) {
    const auto value = static_cast<double>(values[i]);
    if (!(std::fabs(value) <= bound))
      fail(Code::kFormat, "state: %s: %g is not within +-%g", what, value, bound);
  }
}

}  // namespace

void check_numbers(const char* what, const double* values, size_t count, double bound) {
  check(what, values, count, bound);
}

void check_numbers(const char* what, const float* values, size_t count, double bound) {
  check(what, values, count, bound);
}

void check_point(const char* what, const Vec3& p) {
  const double values[] = {p.x, p.y, p.z};
  check(what, values, 3, kMaxStateNumber);
}

void check_rotation(const char* what, const Quat& q) {
  constexpr double kOne = 1 + 1e-6;  // rounding included
  const double values[] = {q.w, q.x, q.y, q.z};
  check(what, values, 4, kOne);
}

void check_integer(const char* what, int64_t value, int64_t low, int64_t high) {
  if (value < low || value > high)
    fail(Code::kFormat, "state: %s: %lld is outside [%lld, %lld]", what, static_cast<long long>(value),
         static_cast<long long>(low), static_cast<long long>(high));
}

}  // namespace rdm
