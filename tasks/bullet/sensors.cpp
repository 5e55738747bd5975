#include "tasks/bullet/sensors.hpp"

#include <algorithm>
#include <cmath>

namespace rdm {

SectorSensor::SectorSensor(const Spot& from, double range, int32_t count, float* out)
    : from_(from), range_(range), count_(count), bins_(out) {
  std::fill_n(bins_, count_, 0.0f);
}

void SectorSensor::add(const Spot& thing) {
  const double near = 1 - distance(from_, thing) / range_;
  if (!(near > 0)) return;
  const double angle = elementary::atan2(from_.x - thing.x, from_.y - thing.y) + kPi;
  const auto sector = static_cast<int32_t>(angle / (2 * kPi / count_));
  float& bin = bins_[sector % count_];  // a full turn is none
  bin = std::max(bin, static_cast<float>(near));
}

RaySensor::RaySensor(const Spot& from, const elementary::SinCos& heading, double range, float* out)
    : from_(from), range_(range), out_(out) {
  std::fill_n(out_, kRays, 0.0f);
  const elementary::SinCos turn = elementary::sincos(2 * kPi / kRays);
  double c = heading.cos, s = heading.sin;
  for (int32_t i = 0; i < kRays; ++i) {
    dx_[i] = c, dy_[i] = s;
    const double next = turn.cos * c - turn.sin * s;
    s = turn.sin * c + turn.cos * s;
    c = next;
  }
}

void RaySensor::hit(int32_t ray, double way) {
  out_[ray] = std::max(out_[ray], static_cast<float>(1 - std::max(0.0, way) / range_));
}

void RaySensor::add_room(const Room& room) {
  for (int32_t k = 0; k < room.walls; ++k) {
    const double gap = room.distance - (room.nx[k] * from_.x + room.ny[k] * from_.y);
    if (!(gap < range_)) continue;
    for (int32_t i = 0; i < kRays; ++i) {
      const double towards = room.nx[k] * dx_[i] + room.ny[k] * dy_[i];
      if (towards * range_ > gap && towards > 0) hit(i, gap / towards);
    }
  }
}

void RaySensor::add_disc(const Spot& middle, double radius) {
  const double x = middle.x - from_.x, y = middle.y - from_.y;
  const double square = x * x + y * y, most = range_ + radius;
  if (!(square < most * most)) return;
  for (int32_t i = 0; i < kRays; ++i) {
    const double along = dx_[i] * x + dy_[i] * y, half2 = radius * radius - (square - along * along);
    if (half2 < 0) continue;
    const double half = std::sqrt(half2);
    if (along + half >= 0 && along - half < range_) hit(i, along - half);
  }
}

void RaySensor::add_square(const Spot& middle, double half) {
  const double x = middle.x - from_.x, y = middle.y - from_.y;
  if (!(std::max(std::fabs(x), std::fabs(y)) < range_ + half)) return;
  for (int32_t i = 0; i < kRays; ++i) {
    double in = -HUGE_VAL, out = HUGE_VAL;
    const auto slab = [&](double d, double to) {
      if (d == 0) {
        if (std::fabs(to) > half) in = HUGE_VAL;
        return;
      }
      const double a = (to - half) / d, b = (to + half) / d;
      in = std::max(in, std::min(a, b));
      out = std::min(out, std::max(a, b));
    };
    slab(dx_[i], x);
    slab(dy_[i], y);
    if (in <= out && out >= 0 && in < range_) hit(i, in);
  }
}

}  // namespace rdm
