// Noise on a teacher's actions: deviations differ from world to world, so that some stay on the path and
// others come far off it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tool {

// The same numbers for the same seed, on any machine.
class ActionNoise {
 public:
  // The deviation of a world is uniform up to twice the mean; of four or more worlds every fourth has none.
  ActionNoise(size_t worlds, size_t width, double mean, uint64_t seed);
  // New noise for a world's decision.
  void draw(size_t world);
  const float* row(size_t world) const { return noise_.data() + world * width_; }
  double uniform();  // [0, 1)

 private:
  size_t width_;
  uint64_t counter_;
  std::vector<double> deviation_;  // [worlds]
  std::vector<float> noise_;       // [worlds][width]
};

}  // namespace tool
