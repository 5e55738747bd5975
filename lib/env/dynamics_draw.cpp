#include "env/dynamics_draw.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace rdm {
namespace {

struct LevelOptions {
  int32_t level;
};
constexpr auto kRows = row<&LevelOptions::level>(basic(integer_option(
    "level", 0, 0, 3,
    "drawn dynamics: masses, gains, efforts, damping and friction vary by 0, 10, 20 or 30 % at each reset")));
constexpr double kSpread[] = {0, 0.1, 0.2, 0.3};
// The range of the factor that is drawn. The scene is built with the middle of the range that was given, so the
// factor is relative to it; for an option drawn by level it is 1 plus or minus the level's spread.
OptionRange factor_of(const Options& o, const char* key) {
  if (!o.given(key)) {
    const double spread = o.spec_of(key)->levelled && kRows.known_to(o) ? kSpread[kRows.read(o).level] : 0;
    return {1 - spread, 1 + spread};
  }
  const OptionRange range = o.range(key);
  if (!range.drawn()) return {1, 1};  // the scene was made with that number
  const double middle = range.middle();
  if (!(middle > 0)) fail(Code::kRange, "option %s: the middle of its range must be above 0", key);
  return {range.low / middle, range.high / middle};
}

}  // namespace

void add_level_options(OptionTable& table) {
  table.add(kRows);
}

DrawnOption drawn_option(const Options& options, const char* key) {
  return {options.range(key).middle(), factor_of(options, key), options.spec_of(key)};
}

void DynamicsDraws::add(const DrawnOption& option, Drawn what, int32_t first, int32_t count) {
  if (!option.factor.drawn()) return;
  // Rows of one option share its draw: all links of a hand are heavier together.
  const auto at = std::find(specs_.begin(), specs_.end(), option.spec);
  const auto i = static_cast<int32_t>(at - specs_.begin());
  if (at == specs_.end()) {
    specs_.push_back(option.spec);
    options_.push_back(option.factor);
  }
  rows_.push_back({what, first, count, i});
}

void DynamicsDraws::apply(World& world, Stream& stream) const {
  if (rows_.empty()) return;  // without using the stream, so that other draws stay the same
  Dynamics& d = world.edit_dynamics();
  d.reset();                    // factors of the last episode do not pile up
  constexpr size_t kMost = 64;  // factors kept at a time: rows of one option stand near each other
  double factors[kMost];
  for (size_t begin = 0; begin < options_.size(); begin += kMost) {
    const size_t end = std::min(begin + kMost, options_.size());
    // one draw per option, in the order of options and not of rows: a new row does not change the draws of a seed
    for (size_t i = begin; i < end; ++i) factors[i - begin] = options_[i].draw(stream);
    for (const Row& row : rows_) {
      const auto option = static_cast<size_t>(row.option);
      if (option < begin || option >= end) continue;
      const double f = factors[option - begin];
      const auto links = [&](double LinkFactors::*member) {
        for (int32_t i = row.first; i < row.first + row.count; ++i) d.links[i].*member *= f;
      };
      switch (row.what) {
        case Drawn::kLinkMass:
          links(&LinkFactors::mass);
          break;
        case Drawn::kLinkKp:
          links(&LinkFactors::kp);
          break;
        case Drawn::kLinkKd:
          links(&LinkFactors::kd);
          break;
        case Drawn::kLinkEffort:
          links(&LinkFactors::effort);
          break;
        case Drawn::kLinkFriction:
          links(&LinkFactors::friction);
          break;
        case Drawn::kBaseMass:
          for (int32_t i = row.first; i < row.first + row.count; ++i) d.bases[i].mass *= f;
          break;
        case Drawn::kBaseDamping:
          for (int32_t i = row.first; i < row.first + row.count; ++i) d.bases[i].damping *= f;
          break;
        case Drawn::kBodyMass:
          for (int32_t i = row.first; i < row.first + row.count; ++i) d.bodies[i].mass *= f;
          break;
        case Drawn::kBodySize:
          for (int32_t i = row.first; i < row.first + row.count; ++i) d.bodies[i].size *= f;
          break;
        case Drawn::kBodyDamping:
          for (int32_t i = row.first; i < row.first + row.count; ++i) d.bodies[i].angular_damping *= f;
          break;
        case Drawn::kFriction:
          d.friction[Dynamics::friction_index(row.first, row.count)] *= f;
          break;
        case Drawn::kGravity:
          d.gravity *= f;
          break;
      }
    }
  }
  world.set_dynamics(d);
}

void DynamicsDraws::list(Vector<Shown>& out) const {
  const size_t count = options_.size();
  const auto touches = [](const Row& r, Drawn what, int32_t at, int32_t second) {
    if (r.what != what) return false;
    if (what == Drawn::kFriction) return r.first == at && r.count == second;
    return what == Drawn::kGravity || (at >= r.first && at < r.first + r.count);
  };
  // the options other than i that have a factor on a place
  const auto beside = [&](int32_t i, const Shown& s) {
    Vector<int32_t> others;
    for (const Row& r : rows_)
      if (r.option != i && touches(r, s.what, s.at, s.second) &&
          std::find(others.begin(), others.end(), r.option) == others.end())
        others.push_back(r.option);
    return others;
  };
  Vector<Shown> found(count);
  Vector<uint8_t> known(count, 0);
  size_t left = count;
  for (int32_t turn = 0; left > 0; ++turn) {
    const Vector<uint8_t> before = known;
    for (const Row& r : rows_) {
      const auto i = static_cast<size_t>(r.option);
      const bool pairs = r.what == Drawn::kFriction || r.what == Drawn::kGravity;
      for (int32_t k = r.first; !known[i] && k < (pairs ? r.first + 1 : r.first + r.count); ++k) {
        Shown s{specs_[i], options_[i], r.what, k, pairs ? r.count : 0, {}};
        s.others = beside(r.option, s);
        const bool clear = std::all_of(s.others.begin(), s.others.end(),
                                       [&](int32_t o) { return before[static_cast<size_t>(o)] != 0; });
        if (!clear) continue;
        found[i] = s;
        known[i] = 1;
        --left;
      }
    }
    if (known == before)
      for (size_t i = 0; i < count; ++i)
        if (!known[i])
          fail(Code::kUnsupported,
               "option show_dynamics: what %s draws cannot be told from what other options draw on the same "
               "rows; give it a number instead of a range",
               specs_[i]->key);
  }
  for (const Shown& s : found) out.push_back(s);
}

void DynamicsDraws::show(const Dynamics& d, const Vector<Shown>& list, float* out) {
  const auto value = [&](const Shown& s) {
    switch (s.what) {
      case Drawn::kLinkMass:
        return d.links[s.at].mass;
      case Drawn::kLinkKp:
        return d.links[s.at].kp;
      case Drawn::kLinkKd:
        return d.links[s.at].kd;
      case Drawn::kLinkEffort:
        return d.links[s.at].effort;
      case Drawn::kLinkFriction:
        return d.links[s.at].friction;
      case Drawn::kBaseMass:
        return d.bases[s.at].mass;
      case Drawn::kBaseDamping:
        return d.bases[s.at].damping;
      case Drawn::kBodyMass:
        return d.bodies[s.at].mass;
      case Drawn::kBodySize:
        return d.bodies[s.at].size;
      case Drawn::kBodyDamping:
        return d.bodies[s.at].angular_damping;
      case Drawn::kFriction:
        return d.friction[Dynamics::friction_index(s.at, s.second)];
      case Drawn::kGravity:
        return d.gravity;
    }
    return 1.0;
  };
  // Entry by entry, with what others have on its place worked out again: lists are short, and others' others rare.
  const auto factor = [&](const auto& self, const Shown& s) -> double {
    double f = value(s);
    for (const int32_t o : s.others) f /= self(self, list[static_cast<size_t>(o)]);
    return f;
  };
  for (size_t i = 0; i < list.size(); ++i) {
    const OptionRange& r = list[i].factor;
    const double place = 2 * (factor(factor, list[i]) - r.low) / (r.high - r.low) - 1;
    out[i] = static_cast<float>(std::clamp(place, -1.0, 1.0));
  }
}

}  // namespace rdm
