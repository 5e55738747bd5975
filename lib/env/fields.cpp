#include "env/fields.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "base/bit_cast.hpp"
#include "base/error.hpp"
#include "base/hash.hpp"

namespace rdm {
namespace {

// The bits of |x|, which stand in the order of |x|: a loop over them has neither branches nor an order.
int32_t magnitude(float x) {
  return bit_cast<int32_t>(x) & 0x7FFFFFFF;
}
constexpr int32_t kInfinity = 0x7F800000;  // and above: not a number

}  // namespace

void add_field(FieldTable& table, const char* prefix, const char* name, const char* unit, int32_t count,
               float low, float high) {
  char full[2 * kNameSize];
  std::snprintf(full, sizeof full, "%s%s%s", prefix ? prefix : "", prefix ? "." : "", name);
  if (std::strlen(full) >= kNameSize) fail(Code::kInternal, "field %s: the name is too long", full);
  if (count < 1) fail(Code::kInternal, "field %s: count %d", full, count);
  table.push_back({Name(full), unit, count, low, high});
}

int32_t field_total(const FieldTable& table) {
  int32_t total = 0;
  for (const FieldSpec& f : table) total += f.count;
  return total;
}

bool clip_row(float* row, int32_t count, float limit) {
  int32_t top = 0;
  for (int32_t i = 0; i < count; ++i) {
    float x = row[i] > limit ? limit : row[i];
    x = x < -limit ? -limit : x;
    row[i] = x;
    top = std::max(top, magnitude(x));
  }
  return top < kInfinity;
}

bool clip_action(const float* row, int32_t count, float* out) {
  int32_t top = 0;
  for (int32_t i = 0; i < count; ++i) {
    const float x = row[i] < -1 ? -1 : row[i];
    out[i] = x > 1 ? 1 : x;
    top = std::max(top, magnitude(row[i]));
  }
  return top < kInfinity;
}

int32_t obs_dim(const Task& task) {
  return field_total(task.fields());
}

FieldSpec bounded_field(const Task& task, int32_t i) {
  FieldSpec f = task.fields()[static_cast<size_t>(i)];
  const float limit = task.obs_limit();
  if (limit == std::numeric_limits<float>::infinity()) return f;
  f.low = f.low > -limit ? f.low : -limit;
  f.high = f.high < limit ? f.high : limit;
  return f;
}

uint64_t layout_hash(const Task& task) {
  uint64_t hash = kHashSeed;
  // terminators are hashed too, so that no two lists of names run together
  const auto text = [&](const char* s) { hash = hash_bytes(s, std::strlen(s) + 1, hash); };
  for (const FieldSpec& f : task.fields()) {
    text(f.name.text);
    hash = hash_bytes(&f.count, sizeof f.count, hash);
  }
  text(task.action_order());
  const int32_t actions = task.action_dim();
  return hash_bytes(&actions, sizeof actions, hash);
}

}  // namespace rdm
