#include "env/options/disturb.hpp"

#include <algorithm>
#include <cstring>

#include "base/error.hpp"
#include "base/hash.hpp"

namespace rdm {
namespace {

// What fields may have, and the rest.
struct AllRows : FieldDisturbance, DisturbOptions {};
constexpr auto kDisturbRows = option_rows<AllRows>(
    row<&FieldDisturbance::noise>(
        open_option(drawable(basic(number_option("noise.FIELD", 0, 0, 1000,
                                                 "standard deviation of the field's noise, in its unit; "
                                                 "FIELD may contain '*', and the last match counts"))))),
    row<&FieldDisturbance::bias>(
        open_option(drawable(number_option("bias.FIELD", 0, 0, 1000,
                                           "bound of a constant error of each entry, drawn uniformly from "
                                           "+-this at a reset, in the field's unit")))),
    row<&FieldDisturbance::delay>(open_option(drawable(basic(integer_option(
        "delay.FIELD", 0, 0, kMaxDelay,
        "control steps by which the field is delayed; until then it has its value at the reset"))))),
    row<&FieldDisturbance::dropout>(open_option(drawable(
        number_option("dropout.FIELD", 0, 0, 1,
                      "probability in each control step that the field keeps the value it showed last")))),
    row<&DisturbOptions::action_delay>(drawable(basic(integer_option(
        "action_delay", 0, 0, kMaxDelay,
        "control steps by which actions are delayed; until the first arrives, the hold action is applied")))),
    row<&DisturbOptions::end_on_cost>(basic(flag_option(
        "end_on_cost", false, "a cost above 0 in column 0, or in a column with a limit, ends the episode"))));

template <auto kMember>
bool is_row_of(const OptionSpec& spec) {
  return &spec == &kDisturbRows.of<kMember>();
}
OptionRange FieldDisturbance::*member_of(const OptionSpec& spec) {
  if (is_row_of<&FieldDisturbance::noise>(spec)) return &FieldDisturbance::noise;
  if (is_row_of<&FieldDisturbance::bias>(spec)) return &FieldDisturbance::bias;
  if (is_row_of<&FieldDisturbance::delay>(spec)) return &FieldDisturbance::delay;
  return is_row_of<&FieldDisturbance::dropout>(spec) ? &FieldDisturbance::dropout : nullptr;
}

[[noreturn]] void unknown(const char* owner, const char* key, const char* name, const Task& task) {
  Vector<const char*> names;
  for (const FieldSpec& f : task.fields()) names.push_back(f.name.text);
  fail(Code::kNotFound, "%s option %s: no field of the observation has this name%s", owner, key,
       Nearest(name, names.data(), static_cast<int32_t>(names.size())).text);
}

}  // namespace

const OptionSpec* disturb_options(int32_t* count) {
  *count = static_cast<int32_t>(kDisturbRows.size());
  return kDisturbRows.specs;
}

Disturbance disturbance_from(const Options& options, const Task& task, const char* owner) {
  Disturbance d;
  static_cast<DisturbOptions&>(d) = kDisturbRows.read(options);
  Vector<FieldDisturbance> all;
  for (int32_t i = 0, offset = 0; i < static_cast<int32_t>(task.fields().size()); ++i) {
    const FieldSpec f = bounded_field(task, i);
    FieldDisturbance x;
    x.offset = offset, x.count = f.count, x.low = f.low, x.high = f.high;
    all.push_back(x);
    offset += f.count;
  }
  for (int32_t i = 0; i < options.count(); ++i) {
    const char* name = options.open_name(i);
    const auto member = name ? member_of(options.spec(i)) : nullptr;
    if (!member) continue;
    bool found = false;
    for (size_t k = 0; k < all.size(); ++k) {
      if (!name_matches(name, task.fields()[k].name.text)) continue;
      all[k].*member = options.range(i);
      found = true;
    }
    if (!found) unknown(owner, options.key(i), name, task);
  }
  const auto still = [](const FieldDisturbance& f) {
    return f.noise.high <= 0 && f.bias.high <= 0 && f.delay.high <= 0 && f.dropout.high <= 0;
  };
  all.erase(std::remove_if(all.begin(), all.end(), still), all.end());
  if (!all.empty()) d.fields.assign(all.begin(), all.end());
  return d;
}

uint64_t hash_disturbance(const Options& options, uint64_t hash) {
  for (int32_t i = 0; i < options.count(); ++i) {
    const OptionSpec& spec = options.spec(i);
    if (&spec < kDisturbRows.specs || &spec >= kDisturbRows.specs + kDisturbRows.size()) continue;
    const OptionRange value = options.range(i);
    if (!options.open_name(i) && value.low == spec.number && !value.drawn()) continue;
    hash = hash_bytes(options.key(i), std::strlen(options.key(i)) + 1, hash);
    hash = hash_bytes(&value.low, sizeof value.low, hash);
    hash = hash_bytes(&value.high, sizeof value.high, hash);
  }
  return hash;
}

}  // namespace rdm
