#include "tasks/planar/layout.hpp"

#include <algorithm>
#include <cmath>

#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr int kSpotDraws = 100, kLayoutDraws = 100;

bool clear_of(const Keepout& a, const Keepout* others, int32_t count) {
  for (int32_t i = 0; i < count; ++i)
    if (distance(a.at, others[i].at) < a.keepout + others[i].keepout) return false;
  return true;
}

}  // namespace

double distance(const Spot& a, const Spot& b) {
  const double dx = a.x - b.x, dy = a.y - b.y;
  return std::sqrt(dx * dx + dy * dy);
}

void check_spots(const char* what, const Spot* spots, int32_t count) {
  for (int32_t i = 0; i < count; ++i) {
    const double values[] = {spots[i].x, spots[i].y};
    check_numbers(what, values, 2);
  }
}

bool draw_spot(double extent, const Keepout* others, int32_t count, Stream& stream, Keepout* out) {
  const double half = std::max(0.0, extent - out->keepout);
  for (int draw = 0; draw < kSpotDraws; ++draw) {
    out->at.x = half * stream.signed_unit();
    out->at.y = half * stream.signed_unit();
    if (clear_of(*out, others, count)) return true;
  }
  return false;
}

void draw_layout(double extent, Stream& stream, Keepout* things, int32_t count) {
  for (int draw = 0; draw < kLayoutDraws; ++draw) {
    bool good = true;
    for (int32_t i = 0; i < count && good; ++i) good = draw_spot(extent, things, i, stream, &things[i]);
    if (good) return;
  }
  // too full for a layout without overlaps
  for (int32_t i = 0; i < count; ++i) draw_spot(extent, things, i, stream, &things[i]);
}

}  // namespace rdm
