#include "sense/world_grid.hpp"

#include <algorithm>
#include <cmath>

namespace rdm {

namespace {

constexpr double kFar = 1.5;            // of the camera's distance from its target: beyond are surroundings
constexpr double kGap = 1.1;            // of what a world takes
constexpr double kSlope = 0.5;          // least height of a unit vector to the eye
constexpr double kForeshortened = 0.7;  // of a depth, as it is seen
constexpr double kFull = 1.03;          // of a side of the picture that the worlds may take
constexpr double kStep = 1.03, kFarthest = 1000;

// The box that a world takes about the camera's target: half sizes along two level directions and up, m.
struct Extent {
  double side = 0, depth = 0, up = 0;
};
Extent extent_of(const World& world, const Camera& camera, const Vec3& side, const Vec3& depth) {
  const double far = kFar * norm(camera.eye - camera.target), least = 0.1 * far;
  Extent out{least, least, least};
  const auto& shapes = world.scene().shapes;
  for (size_t i = 0; i < shapes.size(); ++i) {
    if (shapes[i].radius < 0) continue;
    const Vec3 p = world.shape_pose(static_cast<int32_t>(i)).p - camera.target;
    const double r = shapes[i].radius;
    if (norm(p) + r > far) continue;
    out.side = std::max(out.side, std::abs(dot(p, side)) + r);
    out.depth = std::max(out.depth, std::abs(dot(p, depth)) + r);
    out.up = std::max(out.up, std::abs(p.z) + r);
  }
  return out;
}

// What of the picture some points take, pixels.
struct Frame {
  double x0 = HUGE_VAL, x1 = -HUGE_VAL, y0 = HUGE_VAL, y1 = -HUGE_VAL;
  bool ahead = true;

  void add(const View& view, const Vec3& p) {
    const Vec3 p_C = transpose(view.R_WC) * (p - view.eye);
    ahead = ahead && p_C.z > 0;
    const double x = view.cx + p_C.x / (p_C.z * view.pixel), y = view.cy + p_C.y / (p_C.z * view.pixel);
    x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
  }
  bool fits(int32_t width, int32_t height) const {
    return ahead && x1 - x0 <= kFull * width && y1 - y0 <= kFull * height;
  }
};

}  // namespace

WorldGrid make_world_grid(const World& world, const Camera& camera, int32_t count, int32_t width,
                          int32_t height) {
  WorldGrid grid;
  grid.camera = camera;
  if (count < 2) return grid;
  const View view = make_view(camera, width, height);
  Vec3 side = view.R_WC.col(0);
  side.z = 0;
  side = norm(side) > 1e-6 ? normalized(side) : Vec3{1, 0, 0};
  const Vec3 depth = cross(Vec3{0, 0, 1}, side);
  const Extent half = extent_of(world, camera, side, depth);
  const double as_wide = static_cast<double>(width) / height * kForeshortened * half.depth / half.side;
  grid.columns = std::clamp(static_cast<int32_t>(std::lround(std::sqrt(count * as_wide))), 1, count);
  grid.column = 2 * kGap * half.side * side;
  grid.row = 2 * kGap * half.depth * depth;
  const int32_t rows = (count + grid.columns - 1) / grid.columns;

  Vec3 back = normalized(camera.eye - camera.target);
  if (back.z < kSlope) {
    Vec3 level = {back.x, back.y, 0};
    level = norm(level) > 1e-6 ? normalized(level) : -depth;
    back = std::sqrt(1 - kSlope * kSlope) * level + Vec3{0, 0, kSlope};
  }
  grid.camera.cx = grid.camera.cy = 0;
  grid.camera.up = {0, 0, 1};
  grid.camera.target = camera.target + 0.5 * (static_cast<double>(rows - 1) * grid.row +
                                              static_cast<double>(grid.columns - 1) * grid.column);
  const Vec3 corner[] = {half.side * side, half.depth * depth, {0, 0, half.up}};
  Frame frame;
  for (double distance = norm(camera.eye - camera.target); distance < kFarthest; distance *= kStep) {
    grid.camera.eye = grid.camera.target + distance * back;
    const View wide = make_view(grid.camera, width, height);
    frame = {};
    for (int32_t i = 0; i < count; ++i)
      for (int k = 0; k < 8; ++k)
        frame.add(wide, camera.target + grid.place(i) + (k & 1 ? 1.0 : -1.0) * corner[0] +
                            (k & 2 ? 1.0 : -1.0) * corner[1] + (k & 4 ? 1.0 : -1.0) * corner[2]);
    if (frame.fits(width, height)) break;
  }
  // Perspective leaves more room above than below: the picture is moved over them.
  if (frame.fits(width, height)) {
    grid.camera.cx = 0.5 - 0.5 * (frame.x0 + frame.x1) / width;
    grid.camera.cy = 0.5 - 0.5 * (frame.y0 + frame.y1) / height;
  }
  return grid;
}

}  // namespace rdm
