// What one import may cost, whatever its files say: all its readers draw on one account, so that no file makes
// another one be read, copied or compared more often than a real robot's.
#pragma once
#include <cstddef>

namespace rdm::import {

enum class Cost {
  kFiles,
  kTextBytes,  // of XML and TOML, included files each time they are included
  kMeshBytes,
  kNodes,       // elements, comments and texts of XML; values of TOML
  kAttributes,  // of XML
  kCorners,     // and faces of meshes, each time a shape is fitted about them
  kSteps        // comparisons of names, rows and shapes in loops within loops
};
inline constexpr size_t kCosts = 7;

// The most of each, with what a text calls it.
struct CostLimit {
  size_t most;
  const char* what;
};
inline constexpr CostLimit kCostLimits[kCosts] = {{4096, "files"},
                                                  {size_t{1} << 24, "bytes of text"},
                                                  {size_t{1} << 29, "bytes of meshes"},
                                                  {250000, "elements, comments and texts"},
                                                  {400000, "attributes"},
                                                  {size_t{1} << 24, "corners and faces of meshes"},
                                                  {10000000, "steps of work"}};

class Budget {
 public:
  void spend(Cost cost, size_t count);  // RANGE when there is no such sum left
  size_t spent(Cost cost) const { return spent_[static_cast<size_t>(cost)]; }
  size_t left(Cost cost) const { return kCostLimits[static_cast<size_t>(cost)].most - spent(cost); }

 private:
  size_t spent_[kCosts] = {};
};

}  // namespace rdm::import
