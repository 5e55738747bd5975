// What agents of Gather and Reach see of things around them, 1 touching, 0 out of range.
#pragma once
#include <cstdint>

#include "base/elementary.hpp"
#include "tasks/bullet/room.hpp"
#include "tasks/planar/layout.hpp"

namespace rdm {

// `count` sectors of equal width about `from`, in world axes: the first begins at +y, the others follow
// towards +x. In each, 1 - distance / range of its nearest thing.
class SectorSensor {
 public:
  SectorSensor(const Spot& from, double range, int32_t count, float* out);
  void add(const Spot& thing);

 private:
  Spot from_;
  double range_;
  int32_t count_;
  float* bins_;
};

// `kRays` rays from `from`, the first along the heading and on to the left: 1 - way / range to the first hit.
class RaySensor {
 public:
  static constexpr int32_t kRays = 24;
  RaySensor(const Spot& from, const elementary::SinCos& heading, double range, float* out);
  void add_room(const Room& room);
  void add_disc(const Spot& middle, double radius);
  void add_square(const Spot& middle, double half);  // sides along the axes

 private:
  void hit(int32_t ray, double way);
  Spot from_;
  double range_;
  float* out_;
  double dx_[kRays], dy_[kRays];
};

}  // namespace rdm
