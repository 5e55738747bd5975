#include "shield/guards.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/error.hpp"
#include "base/hash.hpp"

namespace rdm {

Guards::Guards(int32_t worlds, int32_t dim)
    : worlds_(worlds), dim_(dim), origin_(width(), 0.0f), found_(width()) {
  if (dim > kMostEntries)
    fail(Code::kUnsupported, "shield: an action has %d entries, but at most %d are allowed", dim,
         kMostEntries);
  rows_.reserve(kMostGuards);
}

HalfSpace Guards::half_space(const Row& row, int32_t env) const {
  const auto i = static_cast<size_t>(row.bound.size() > 1 ? env : 0);
  return {row.normal.data() + i * width(), row.bound[i]};
}

int32_t Guards::half_spaces(int32_t env, HalfSpace* out) const {
  for (const Row& row : rows_) *out++ = half_space(row, env);
  return count();
}

// From the origin, as it stands for what rounding might not find from elsewhere.
bool Guards::keepable(const HalfSpace* rows, int32_t count) const {
  return nearest_action(rows, count, dim_, origin_.data(), found_.data());
}

void Guards::add(int32_t column, const float* normal, float bound) {
  check_half_space({normal, bound}, dim_, "guard");
  if (count() == kMostGuards)
    fail(Code::kRange, "guard: there are already %d guards, the most that are allowed", kMostGuards);
  HalfSpace rows[kMostGuards];
  for (int32_t env = 0; env < (column < 0 ? worlds_ : 1); ++env) {
    const int32_t n = half_spaces(env, rows);
    rows[n] = {normal, bound};
    if (!keepable(rows, n + 1))
      fail(Code::kArgument, "guard: no action of world %d keeps this guard and the %d before it", env, n);
  }
  Row row{column, {}, {}};
  const size_t copies = column < 0 ? static_cast<size_t>(worlds_) : 1;
  row.bound.assign(copies, bound);
  row.normal.resize(copies * width());
  for (size_t i = 0; i < copies; ++i) std::copy_n(normal, dim_, row.normal.data() + i * width());
  rows_.push_back(std::move(row));
  declared_ += column >= 0;
}

bool Guards::set(int32_t env, int32_t i, const float* normal, float bound) {
  const int32_t own = count() - declared_;
  if (env < 0 || env >= worlds_) fail(Code::kRange, "env: %d is outside [0, %d)", env, worlds_);
  if (i < 0 || i >= own) fail(Code::kRange, "i: %d is outside [0, %d)", i, own);
  check_half_space({normal, bound}, dim_, "guard");
  HalfSpace rows[kMostGuards];
  half_spaces(env, rows);
  HalfSpace& now = rows[declared_ + i];
  if (now.bound == bound && std::memcmp(now.normal, normal, width() * sizeof *normal) == 0) return false;
  now = {normal, bound};
  if (!keepable(rows, count()))
    fail(Code::kArgument, "guard: no action of world %d keeps this guard and the other %d", env, count() - 1);
  Row& row = rows_[static_cast<size_t>(declared_ + i)];
  row.bound[static_cast<size_t>(env)] = bound;
  std::copy_n(normal, dim_, row.normal.data() + static_cast<size_t>(env) * width());
  return true;
}

int32_t Guards::broken(int32_t env, const float* action) const {
  HalfSpace rows[kMostGuards];
  return most_violated(rows, half_spaces(env, rows), dim_, action);
}

int32_t Guards::project(int32_t env, const float* action, float* out) const {
  HalfSpace rows[kMostGuards];
  const int32_t n = half_spaces(env, rows), row = most_violated(rows, n, dim_, action);
  if (row < 0) {
    if (out != action) std::copy_n(action, dim_, out);
  } else if (!nearest_action(rows, n, dim_, action, out)) {
    nearest_action(rows, n, dim_, origin_.data(), out);
  }
  return row;
}

uint64_t Guards::hash(uint64_t hash) const {
  const int32_t sizes[] = {count(), declared_};
  hash = hash_bytes(sizes, sizeof sizes, hash);
  for (int32_t i = 0; i < declared_; ++i) {
    const Row& row = rows_[static_cast<size_t>(i)];
    hash = hash_bytes(row.normal.data(), width() * sizeof(float), hash);
    hash = hash_bytes(row.bound.data(), sizeof(float), hash);
  }
  return hash;
}

void Guards::write(Writer& out) const {
  for (int32_t i = declared_; i < count(); ++i) {
    const Row& row = rows_[static_cast<size_t>(i)];
    out.bytes(row.normal.data(), row.normal.size() * sizeof(float));
    out.bytes(row.bound.data(), row.bound.size() * sizeof(float));
  }
}

bool Guards::check(Reader& in) const {
  Guards other = *this;
  other.read(in);
  HalfSpace rows[kMostGuards];
  for (int32_t env = 0; env < worlds_; ++env) {
    const int32_t n = other.half_spaces(env, rows);
    try {
      for (int32_t i = declared_; i < n; ++i) check_half_space(rows[i], dim_, "guard");
    } catch (const Error&) {
      return false;
    }
    if (n > declared_ && !keepable(rows, n)) return false;
  }
  return true;
}

void Guards::read(Reader& in) {
  for (int32_t i = declared_; i < count(); ++i) {
    Row& row = rows_[static_cast<size_t>(i)];
    in.bytes(row.normal.data(), row.normal.size() * sizeof(float));
    in.bytes(row.bound.data(), row.bound.size() * sizeof(float));
  }
}

}  // namespace rdm
