#include "algos/core/columns.hpp"

#include <algorithm>
#include <cstring>
#include <span>

#include "base/error.hpp"
#include "base/option.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

constexpr const char* kState[] = {"*"};
constexpr const char* kTouch[] = {"*joint_position", "*joint_velocity", "*joint_force",   "*_tip_*",
                                  "*base_position",  "*base_angles",    "*base_rotation", "*base_velocity",
                                  "*base_spin",      "*action",         "accelerometer",  "gyro",
                                  "magnetometer",    "velocimeter",     "budget.*"};
constexpr const char* kGoal[] = {"goal.*"};
constexpr const char* kForces[] = {"*_tip_force", "*_tip_torque"};

// Fields of `add` and `too` but for those of `less`.
struct Preset {
  const char* name;
  std::span<const char*const> add, less, too;
};
constexpr Preset kPresets[] = {{"state", kState, {}, {}},
                               {"vision", kTouch, {}, kGoal},
                               {"touch", kTouch, {}, {}},
                               {"proprioception", kTouch, kForces, {}}};

bool among(std::span<const char* const> patterns, const char* name) {
  return std::any_of(patterns.begin(), patterns.end(), [&](const char* p) { return name_matches(p, name); });
}

// The words of a list between commas, blanks about them cut off.
template <class F>
void each_word(const char* list, F&& f) {
  Vector<char> word;
  for (const char* at = list;; ++at) {
    const char* end = at + std::strcspn(at, ",");
    const char *from = at, *to = end;
    while (from < to && *from == ' ') ++from;
    while (from < to && to[-1] == ' ') --to;
    word.assign(from, to);
    word.push_back('\0');
    f(word.data());
    if (!*end) return;
    at = end;
  }
}

class Selection {
 public:
  Selection(const char* key, const ObsField* fields, int32_t num_fields, int32_t obs_dim)
      : key_(key), fields_(fields, static_cast<size_t>(num_fields)), seen_(static_cast<size_t>(obs_dim)) {}

  void set_all(uint8_t seen) { std::fill(seen_.begin(), seen_.end(), seen); }

  void apply(const char* word, uint8_t seen) {
    if (std::strcmp(word, "*") == 0) return set_all(seen);
    if (set_where(seen, [&](const char* name) { return name_matches(word, name); })) return;
    for (const Preset& p : kPresets) {
      if (!same_name(p.name, word)) continue;
      if (p.add.data() == kState) return set_all(seen);
      need_fields(word);
      const auto meant = [&](const char* name) {
        return (among(p.add, name) || among(p.too, name)) && !among(p.less, name);
      };
      if (set_where(seen, meant)) return;
      fail(Code::kNotFound, "%s: the observation has no field %s", key_, p.name);
    }
    need_fields(word);
    Vector<const char*> names;
    for (const ObsField& f : fields_) names.push_back(f.name);
    for (const Preset& p : kPresets) names.push_back(p.name);
    fail(Code::kNotFound, "%s: '%s' names no field of the observation%s", key_, Quoted(word).text,
         Nearest(word, names.data(), static_cast<int32_t>(names.size())).text);
  }

  Vector<int32_t> columns() const {
    const auto count = static_cast<size_t>(std::count(seen_.begin(), seen_.end(), uint8_t{1}));
    if (count == 0) fail(Code::kArgument, "%s: no entry of the observation is left", key_);
    Vector<int32_t> out;
    if (count == seen_.size()) return out;
    out.reserve(count);
    for (size_t i = 0; i < seen_.size(); ++i)
      if (seen_[i]) out.push_back(static_cast<int32_t>(i));
    return out;
  }

 private:
  template <class Wanted>
  bool set_where(uint8_t seen, Wanted&& wanted) {
    bool any = false;
    for (const ObsField& f : fields_) {
      if (!wanted(f.name)) continue;
      std::fill_n(seen_.begin() + f.offset, f.count, seen);
      any = true;
    }
    return any;
  }
  void need_fields(const char* word) const {
    if (fields_.empty())
      fail(Code::kArgument, "%s: '%s' needs the names of fields, but config.fields is empty", key_,
           Quoted(word).text);
  }

  const char* key_;
  std::span<const ObsField> fields_;
  Vector<uint8_t> seen_;
};

}  // namespace

Vector<int32_t> select_columns(const char* key, const char* list, const ObsField* fields, int32_t num_fields,
                               int32_t obs_dim) {
  if (std::strcmp(list, "*") == 0) return {};  // as most do: no memory
  Selection selection(key, fields, num_fields, obs_dim);
  bool first = true;
  each_word(list, [&](const char* word) {
    const bool takes_away = *word == '!';
    if (first) selection.set_all(takes_away);
    first = false;
    selection.apply(takes_away ? word + 1 : word, !takes_away);
  });
  return selection.columns();
}

const ObsField* keep_fields(Arena& arena, const ObsField* fields, int32_t num_fields) {
  auto* const kept = arena.make<ObsField>(static_cast<size_t>(num_fields));
  const auto keep = [&](const char* text) {
    const size_t size = std::strlen(text) * (is_clean_text(text) ? 1 : 4) + 1;
    char* const to = arena.make<char>(size);
    if (to) clean_text(to, size, text);
    return to;
  };
  for (int32_t i = 0; i < num_fields; ++i) {
    const ObsField& f = fields[i];
    const ObsField copy = {keep(f.name), f.offset, f.count, keep(f.unit)};
    if (kept) kept[i] = copy;
  }
  return kept;
}

}  // namespace rdm
