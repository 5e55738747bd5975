#include "teach/noise.hpp"

#include <cmath>

#include "common/scatter.hpp"

namespace tool {
ActionNoise::ActionNoise(size_t worlds, size_t width, double mean, uint64_t seed)
    : width_(width), counter_(scattered(seed)), noise_(worlds * width) {
  for (size_t i = 0; i < worlds; ++i) {
    const double u = uniform();
    deviation_.push_back(worlds >= 4 && i % 4 == 0 ? 0 : 2 * mean * u);
  }
}

double ActionNoise::uniform() {
  return static_cast<double>(scattered(counter_++) >> 11) * 0x1p-53;
}

// By Box and Muller; the library's own distributions would differ between compilers.
void ActionNoise::draw(size_t world) {
  for (size_t j = 0; j < width_; ++j) {
    const double radius = std::sqrt(-2 * std::log(1 - uniform())),
                 angle = 2 * 3.14159265358979323846 * uniform();
    noise_[world * width_ + j] = static_cast<float>(deviation_[world] * radius * std::cos(angle));
  }
}

}  // namespace tool
