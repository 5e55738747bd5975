// What surfaces are made of, and what surrounds them, in pictures for people. Linear light as in shade.hpp.
#pragma once
#include "sense/render/lanes3.hpp"
#include "sense/render/shade.hpp"

namespace rdm {

// How a finish takes light.
struct Look {
  float mirror;   // share of light mirrored head on
  float blur;     // of what is mirrored: 0 a mirror, 1 a wall
  int gloss;      // lobe of the key light: cos^(2^gloss)
  float wrap;     // how far light creeps around: 0 hard, 0.5 skin
  float metal;    // 1: mirrors its own colour and scatters nothing
  float through;  // share of light that passes, of glass
};
const Look& look_of(Finish finish);

// Colour of what lies in direction r (unit) all around, softened by `blur`: sky, ground and the key light's panel.
Lanes3 surroundings(const Lanes3& r, const Lanes3& key, float blur);

// Sky in direction d, any length: what is seen where nothing is hit.
Lanes3 sky(const Lanes3& d, const Lanes3& key);

// As shade, of points of one finish.
Lanes3 shade_fine(const Surface& s, const Look& look, const Lanes3& key);

// Schlick's share of mirrored light at a cosine.
Float4 fresnel(float head_on, Float4 cosine);

// Colour of a floor at (x, y) of its frame, m: as checker, softer, with fine joints.
Lanes3 tiles(const float color[3], Float4 x, Float4 y, Float4 wx, Float4 wy);

// Share of `color` that is left of wood at p of its shape's frame; `axis` is where the grain runs.
Float4 grain(const Lanes3& p, int axis, int32_t id);

// sRGB of linear light, through a curve that keeps colours full and lets highlights roll off.
uint8_t to_fine_srgb(float value);

}  // namespace rdm
