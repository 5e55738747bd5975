// The object that an option describes by its points.
#pragma once
#include "objects/object.hpp"

namespace rdm {

// A hull's points from text "x,y,z;x,y,z;...", m: at most kMaxHullPoints. Error(kArgument).
inline constexpr int32_t kHullTextSize = 1024;
inline constexpr double kHullDensity = 500;  // kg/m3, that of the egg
Vector<Vec3> hull_points_from(const char* text);

// As make_object_body, of a hull with these points; its frame is in their centre of mass. mass <= 0: that of
// kHullDensity.
BodyDef make_hull_body(const char* points, const char* name, const Pose& X_WB, double mass, double scale,
                       int32_t material);

}  // namespace rdm
