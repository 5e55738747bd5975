// Which pairs of bodies have boxes that meet, where there are many of them: sweep and prune (Baraff, Dynamic
// Simulation of Non-Penetrating Rigid Bodies, 1992, section 2.3). Boxes stand in the order of their lower ends
// along the axis on which they are spread the most, so that each is tried against those that begin before it
// ends, not against all. The answer is a bit for each pair, whatever the order.
#pragma once
#include "base/arena.hpp"
#include "physics/model/scene.hpp"

namespace rdm {

struct Bound;
// Half sides of the box around a shape, m; the fourth is for the vector's sake.
struct Extent {
  float half[4];
};

class Crowd {
 public:
  void carve(const Scene& scene, Arena& arena);
  void make(const Scene& scene);
  // False: so few pairs are to be tried, of all that it has, that this takes less one by one.
  bool pays(int32_t pairs) const { return num_shapes_ > 0 && pairs > kSearchPairs * num_shapes_; }
  // [pairs / 64] bit k: the boxes of pair k meet. Of pairs without a robot's shape and without a plane; the
  // bits of others are 0.
  const uint64_t* search(const Bound* bounds, const Extent* extents);

 private:
  static constexpr int32_t kSearchPairs = 64;  // what a search costs a shape, in pairs that are tried alone
  struct Begin {
    float low;  // m
    int32_t shape;
  };
  // Boxes in the order of their lower ends, by coordinate: along the sweep, and across.
  struct Sorted {
    float *low, *center[2], *half[2];  // m
    int32_t* shape;
  };
  // Pairs in a row of one shape with shapes in a row.
  struct Partners {
    int32_t first_pair, first_shape, count;
  };
  static bool counts(const Scene& scene, const ShapePair& pair);
  template <class Use>
  static void each_run(const Scene& scene, const Use& use);
  int32_t pair_of(int32_t a, int32_t b) const;
  int widest_axis(const Bound* bounds) const;
  void meet(int32_t a, int32_t b);

  int32_t* shapes_ = nullptr;        // [num_shapes_] those of such pairs
  Begin* begins_ = nullptr;          // [num_shapes_]
  Sorted sorted_{};                  // [num_shapes_], to a multiple of four
  Partners* partners_ = nullptr;     // of all shapes, in the order of their pairs
  int32_t* partners_end_ = nullptr;  // [shapes + 1] where those of each shape begin
  uint64_t* meet_ = nullptr;         // [words_]
  size_t words_ = 0;
  int32_t num_shapes_ = 0;
};

}  // namespace rdm
