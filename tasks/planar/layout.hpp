// Places on the plane, drawn apart from each other.
#pragma once
#include <cstdint>

#include "base/rng.hpp"

namespace rdm {

struct Spot {
  double x, y;  // m
};
double distance(const Spot& a, const Spot& b);
void check_spots(const char* what, const Spot* spots, int32_t count);  // of a saved state: Error(kFormat)

// A thing keeps others away by the sum of the two distances.
struct Keepout {
  Spot at;
  double keepout;  // m
};
// A place in the square |x|, |y| <= extent - keepout that is clear of `others`. After 100 draws the last one
// stands, whatever it touches: false.
bool draw_spot(double extent, const Keepout* others, int32_t count, Stream& stream, Keepout* out);
// All places of a layout, one after the other; drawn anew up to 100 times when one found no place.
void draw_layout(double extent, Stream& stream, Keepout* things, int32_t count);

}  // namespace rdm
