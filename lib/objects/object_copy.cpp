#include "objects/object_copy.hpp"

#include <cstdio>
#include <cstring>

#include "base/format.hpp"

namespace rdm {

void write_shape_text(const Object& object, char* out, size_t size) {
  static constexpr const char* kKinds[] = {"sphere", "capsule",   "box", "cylinder",
                                           "plane",  "ellipsoid", "hull"};
  constexpr int kNumKinds = 7;
  if (object.shapes.count != 1) {
    int counts[kNumKinds] = {};
    for (const ObjectShape& s : object.shapes) ++counts[static_cast<int>(s.kind)];
    size_t at = 0;
    *out = 0;
    for (int k = 0; k < kNumKinds && at < size; ++k) {
      if (counts[k] == 0) continue;
      const char* end = counts[k] == 1 ? "" : k == static_cast<int>(ShapeKind::kBox) ? "es" : "s";
      const int n = print_text(out + at, size - at, "%s%d %s%s", at ? ", " : "", counts[k], kKinds[k], end);
      at += n > 0 ? static_cast<size_t>(n) : size;
    }
    return;
  }
  const ObjectShape& s = object.shapes[0];
  const Vec3& d = s.size;
  switch (s.kind) {
    case ShapeKind::kSphere:
      print_text(out, size, "sphere r %.6g", d.x);
      break;
    case ShapeKind::kCapsule:
      print_text(out, size, "capsule r %.6g, straight part %.6g", d.x, 2 * d.y);
      break;
    case ShapeKind::kCylinder:
      print_text(out, size, "cylinder r %.6g, h %.6g", d.x, 2 * d.y);
      break;
    case ShapeKind::kBox:
      print_text(out, size, "box %.6g x %.6g x %.6g", 2 * d.x, 2 * d.y, 2 * d.z);
      break;
    case ShapeKind::kEllipsoid:
      print_text(out, size, "ellipsoid %.6g x %.6g x %.6g (half axes)", d.x, d.y, d.z);
      break;
    case ShapeKind::kHull:
    case ShapeKind::kPlane:
      print_text(out, size, "hull of %d points", s.points.count);
      break;
  }
}

ObjectCopy::ObjectCopy(const Object& object) : object_(object) {
  shapes_.assign(object.shapes.begin(), object.shapes.end());
  for (ObjectShape& s : shapes_) {
    if (s.points.count == 0) continue;
    points_.emplace_back(s.points.begin(), s.points.end());
    s.points = {points_.back().data(), s.points.count};
  }
  object_.shapes = {shapes_.data(), static_cast<int32_t>(shapes_.size())};
  object_.name = keep(object.name);
  object_.alias = keep(object.alias);
  object_.help = keep(object.help ? object.help : "");
  object_.material.name = keep(object.material.name);
  if (object.shape_text) {
    object_.shape_text = keep(object.shape_text);
  } else {
    char text[160];
    write_shape_text(object_, text, sizeof text);
    object_.shape_text = keep(text);
  }
}

const char* ObjectCopy::keep(const char* text) {
  if (!text) return nullptr;
  texts_.emplace_back(text, text + std::strlen(text) + 1);
  return texts_.back().data();
}

}  // namespace rdm
