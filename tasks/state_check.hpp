// What Task::check_state is made of. The bytes of a saved state carry a checksum, which tells damage from
// intention and not sense from nonsense: indices, flags and numbers are looked at before a step reads them.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/vec.hpp"

namespace rdm {

// Beyond every place, speed, clock and sum that an episode reaches; its square is far from overflow.
inline constexpr double kMaxStateNumber = 1e9;

// Error(kFormat) naming `what` unless each of `count` numbers is within +-bound; not-a-number never is.
void check_numbers(const char* what, const double* values, size_t count, double bound = kMaxStateNumber);
void check_numbers(const char* what, const float* values, size_t count, double bound = kMaxStateNumber);
void check_point(const char* what, const Vec3& p);
// Components of a rotation.
void check_rotation(const char* what, const Quat& q);
// Error(kFormat) for a value outside [low, high].
void check_integer(const char* what, int64_t value, int64_t low, int64_t high);

}  // namespace rdm
