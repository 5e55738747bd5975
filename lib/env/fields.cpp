#include "env/fields.hpp"

#include <cstdio>
#include <cstring>

#include "base/error.hpp"
#include "base/hash.hpp"

namespace rdm {

void add_field(FieldTable& table, const char* prefix, const char* name, const char* unit, int32_t count) {
  char full[2 * kNameSize];
  std::snprintf(full, sizeof full, "%s%s%s", prefix ? prefix : "", prefix ? "." : "", name);
  if (std::strlen(full) >= kNameSize) fail(Code::kInternal, "field %s: the name is too long", full);
  if (count < 1) fail(Code::kInternal, "field %s: count %d", full, count);
  table.push_back({Name(full), unit, count});
}

int32_t field_total(const FieldTable& table) {
  int32_t total = 0;
  for (const FieldSpec& f : table) total += f.count;
  return total;
}

float* FieldWriter::next(int32_t count) {
  if (field_ == table_.size()) fail(Code::kInternal, "observation: more fields are written than declared");
  const FieldSpec& f = table_[field_++];
  if (f.count != count)
    fail(Code::kInternal, "observation field %s: declared %d, written %d", f.name.text, f.count, count);
  float* const here = at_;
  at_ += count;
  return here;
}

void FieldWriter::finish() const {
  if (field_ != table_.size())
    fail(Code::kInternal, "observation field %s is not written", table_[field_].name.text);
}

void clip_row(float* row, int32_t count, float limit) {
  for (int32_t i = 0; i < count; ++i) {
    const float x = row[i] > limit ? limit : row[i];
    row[i] = x < -limit ? -limit : x;
  }
}

int32_t obs_dim(const Task& task) {
  return field_total(task.fields());
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
