// What a picture is made of: a primitive with a pose, a colour, and the number by which it is segmented.
#pragma once
#include <cstdint>

#include "base/vec.hpp"
#include "physics/model/scene.hpp"

namespace rdm {

struct RenderShape {
  ShapeKind kind = ShapeKind::kSphere;
  Vec3 size;                           // as ShapeDef::size, m
  Pose X_WS;                           // q of unit length; not drawn where it is not finite or beyond 1e6 m
  uint8_t color[3] = {200, 200, 200};  // sRGB; planes are a checkerboard of it and a darker tone
  int32_t id = 0;                      // what the segmentation image holds where this shape is seen
  const Hull* hull = nullptr;          // of kind kHull
  double round = 0;  // of the edges of boxes and hulls, m; a box's at most its smallest half size
  Finish finish = Finish::kPaint;  // of fine pictures
};

}  // namespace rdm
