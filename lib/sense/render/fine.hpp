// Pictures for people: as paint.hpp, with what surfaces are made of, a sky, floors that mirror, glass that is
// seen through, and more samples where edges are.
//
// Light on a surface: the key light's disc (Lambert's cosine; Blinn-Phong's lobe, normalised), the sky's and the
// ground's share by the normal's height, and the surroundings mirrored with Schlick's approximation of Fresnel's
// share. Rays are followed once more where a floor mirrors or glass lets through, and no further.
#pragma once
#include <cstdint>

#include "sense/render/paint.hpp"

namespace rdm {

inline constexpr int kFineLightSide = 4;          // samples per side of a pixel where edges are
inline constexpr double kFineLightSpread = 0.09;  // tangent of the key light's half angle

// As paint_tile, for lights of make_light_rays(kFineLightSide, kFineLightSpread).
void paint_fine_tile(const Painter& painter, const IndexList& seen, int32_t x, int32_t y, uint8_t* rgb);

}  // namespace rdm
