// Dynamics that each world draws for itself at a reset (domain randomisation; Tobin et al. 2017, Peng et al.
// 2018).
//
// A task builds its scene from the middles of the ranges that its options name; a draw is a factor on what
// was built from one option, uniform in [low / middle, high / middle]. All that one option set takes the same
// factor.
#pragma once
#include "base/option_rows.hpp"
#include "base/rng.hpp"
#include "env/option_table.hpp"
#include "physics/world.hpp"

namespace rdm {

// What of the scene a factor is for, and which rows of it.
enum class Drawn : int32_t {
  kLinkMass,  // flat links
  kLinkKp,    // and so on
  kLinkKd,
  kLinkEffort,
  kLinkFriction,
  kBaseMass,  // articulations
  kBaseDamping,
  kBodyMass,  // bodies
  kBodySize,
  kBodyDamping,  // angular
  kFriction,     // first and count are the two materials
  kGravity       // no rows
};

// The options that level draws unless they are given.
void add_level_options(OptionTable& table);

// What worlds may draw of an option: its middle, with which the scene is made, and the range of factors on it,
// of a range that was given, else of the option's level.
struct DrawnOption {
  double middle = 0;
  OptionRange factor;
  const OptionSpec* spec = nullptr;
};
// Error(kRange) for a range whose middle is 0.
DrawnOption drawn_option(const Options& options, const char* key);
template <>
struct OptionValue<DrawnOption> {
  static constexpr bool fits(const OptionSpec& s) { return s.range; }
  static DrawnOption read(const Options& o, const char* key) { return drawn_option(o, key); }
};

class DynamicsDraws {
 public:
  // Nothing is added when the factor is 1.
  void add(const DrawnOption& option, Drawn what, int32_t first = 0, int32_t count = 1);
  bool empty() const { return rows_.empty(); }
  // A factor for each option, in the order in which they were first added, from `stream`; then the world's
  // dynamics.
  void apply(World& world, Stream& stream) const;

  // How one option's factor is read back from a world: its value at one place, over the factors of other options on it.
  struct Shown {
    const OptionSpec* spec;
    OptionRange factor;
    Drawn what;
    int32_t at, second;      // the row; of friction the two materials
    Vector<int32_t> others;  // entries of the list, before this one where it is worked out
  };
  // Appends one for each option, in the order of their draws. Error(kUnsupported) where factors cannot be told apart.
  void list(Vector<Shown>& out) const;
  // Where in its range each factor of a world lies, out [list.size()] in [-1, 1].
  static void show(const Dynamics& d, const Vector<Shown>& list, float* out);

 private:
  struct Row {
    Drawn what;
    int32_t first, count, option;
  };
  Vector<Row> rows_;
  Vector<OptionRange> options_;  // of factors
  Vector<const OptionSpec*> specs_;
};

}  // namespace rdm
