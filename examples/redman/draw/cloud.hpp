// Points as a camera sees them: a dot for each, coloured by what it lies on.
#pragma once
#include <redman/redman.h>

#include "draw/image.hpp"

namespace tool {

// Where a camera of the world sees points, as the library's own pictures have it: pixel (0, 0) the upper left
// one, its centre at (0.5, 0.5).
class Projection {
 public:
  // `camera` must stand in the world (mount 0).
  Projection(const rdm_camera_info& camera, int32_t width, int32_t height);
  // Pixels to at[0], at[1], and the depth along the optical axis, m, to at[2]. False behind the eye.
  bool see(const float point[3], double at[3]) const;
  // Pixels that a length of 1 m takes at a depth of 1 m.
  double focus() const { return focus_; }

 private:
  double eye_[3], side_[3], down_[3], ahead_[3];
  double focus_, middle_[2];
};

// points [count][3] m, world; shape [count], -1: nothing was seen there, no dot; kind [count] chooses the
// colour, or NULL. Nearer dots hide others. On white.
Image draw_cloud(const rdm_camera_info& camera, const float* points, const int32_t* shape,
                 const uint8_t* kind, int32_t count, int32_t width, int32_t height);
// Of dots of a kind, RGB.
void cloud_color(uint8_t kind, unsigned char rgb[3]);

}  // namespace tool
