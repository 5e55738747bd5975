// The light of the pictures: one key light with a disc's shadow, sky and ground light, a soft floor.
//
// All colours are linear light, red green blue in x y z, until to_srgb.
#pragma once
#include <cstdint>

#include "sense/render/intersect.hpp"
#include "sense/render/lanes3.hpp"

namespace rdm {

// Four surface points, in E (primitive.hpp).
struct Surface {
  Lanes3 p;  // m from the eye
  Lanes3 d;  // ray that met it, any length
  Lanes3 n;  // unit normal
  Lanes3 albedo;
  Float4 lit;   // share of the key light that arrives, 0 to 1
  Float4 open;  // share of the sky that is not hidden by things close by, 0 to 1
};

inline constexpr double kLightSpread = 0.045;  // tangent of the disc's half angle
// Unit direction to the key light, in world axes. (u, v) is a point of the light's disc, in the unit circle.
Vec3 light_direction(double u, double v, double spread = kLightSpread);

// Colour of the points under the key light from direction `key`.
Lanes3 shade(const Surface& s, const Lanes3& key);

// What is seen where nothing is hit: a gradient over the height of the ray.
Lanes3 background(const Lanes3& d);

// Share of the background in the colour of a floor, 0 to 1, at distance r from an eye that is `height` above
// it, m: floors fade towards the horizon, the sooner the lower the eye.
Float4 haze(Float4 r, float height);

// Colour of a plane at (x, y) of its frame, m: squares of 0.1 m in `color` and a darker tone, averaged over
// the box (wx, wy) that a sample stands for.
Lanes3 checker(const float color[3], Float4 x, Float4 y, Float4 wx, Float4 wy);

// Ambient occlusion that primitive s causes at p with normal n, 0 to 1; exactly 0 from kOcclusionReach
// times s.thick on, measured from the spine.
Float4 occlusion(const Primitive& s, const Lanes3& p, const Lanes3& n);
inline constexpr float kOcclusionReach = 5;

float from_srgb(uint8_t value);
// Tone curve and sRGB, 0 to 255; negative and non-finite values give 0.
uint8_t to_srgb(float value);
// sRGB alone, of at least 0.
uint8_t encode_srgb(float v);

}  // namespace rdm
