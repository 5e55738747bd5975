#include "draw/cloud.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include "draw/svg.hpp"

namespace tool {
namespace {

constexpr double kDot = 0.004;  // m, a dot's radius; a pixel at least

void cross_product(const double a[3], const double b[3], double out[3]) {
  for (int i = 0; i < 3; ++i) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

// False for a vector of no length.
bool normalise(double v[3]) {
  const double length = std::hypot(v[0], v[1], v[2]);
  if (length < 1e-6) return false;
  for (int i = 0; i < 3; ++i) v[i] /= length;
  return true;
}

}  // namespace

Projection::Projection(const rdm_camera_info& camera, int32_t width, int32_t height)
    : focus_(height / (2 * std::tan(0.5 * static_cast<double>(camera.fov_y)))),
      middle_{(0.5 + static_cast<double>(camera.cx)) * width,
              (0.5 + static_cast<double>(camera.cy)) * height} {
  double up[3];
  for (int i = 0; i < 3; ++i) {
    eye_[i] = static_cast<double>(camera.eye[i]);
    ahead_[i] = static_cast<double>(camera.target[i]) - eye_[i];
    up[i] = static_cast<double>(camera.up[i]);
  }
  normalise(ahead_);
  const double back[3] = {-1, 0, 0};  // up of a camera that looks along its own
  cross_product(ahead_, up, side_);
  if (!normalise(side_)) {
    cross_product(ahead_, back, side_);
    normalise(side_);
  }
  cross_product(ahead_, side_, down_);
}

bool Projection::see(const float point[3], double at[3]) const {
  double x = 0, y = 0, z = 0;
  for (int i = 0; i < 3; ++i) {
    const double d = static_cast<double>(point[i]) - eye_[i];
    x += d * side_[i], y += d * down_[i], z += d * ahead_[i];
  }
  if (z < 1e-6) return false;
  at[0] = middle_[0] + focus_ * x / z;
  at[1] = middle_[1] + focus_ * y / z;
  at[2] = z;
  return true;
}

void cloud_color(uint8_t kind, unsigned char rgb[3]) {
  const auto hex = std::strtoul(palette_color(kind) + 1, nullptr, 16);
  for (int i = 0; i < 3; ++i) rgb[i] = static_cast<unsigned char>(hex >> (16 - 8 * i));
}

Image draw_cloud(const rdm_camera_info& camera, const float* points, const int32_t* shape,
                 const uint8_t* kind, int32_t count, int32_t width, int32_t height) {
  struct Dot {
    double at[3];
    uint8_t kind;
  };
  const Projection projection(camera, width, height);
  std::vector<Dot> dots;
  for (int32_t p = 0; p < count; ++p) {
    Dot dot;
    if (shape[p] < 0 || !projection.see(points + 3 * p, dot.at)) continue;
    dot.kind = kind ? kind[p] : uint8_t{0};
    dots.push_back(dot);
  }
  std::stable_sort(dots.begin(), dots.end(), [](const Dot& a, const Dot& b) { return a.at[2] > b.at[2]; });
  Image image{width, height, {}};
  image.rgb.assign(static_cast<size_t>(width) * static_cast<size_t>(height) * 3, 255);
  for (const Dot& dot : dots) {
    const double radius = std::max(1.0, projection.focus() * kDot / dot.at[2]);
    const auto low = [&](int axis) { return std::max(0.0, std::floor(dot.at[axis] - radius)); };
    const auto high = [&](int axis, int32_t size) {
      return std::min<double>(size - 1, std::floor(dot.at[axis] + radius));
    };
    unsigned char rgb[3];
    cloud_color(dot.kind, rgb);
    for (double y = low(1); y <= high(1, height); ++y)
      for (double x = low(0); x <= high(0, width); ++x) {
        const bool own = std::floor(dot.at[0]) == x && std::floor(dot.at[1]) == y;  // however small
        if (!own && std::hypot(x + 0.5 - dot.at[0], y + 0.5 - dot.at[1]) > radius) continue;
        const size_t at = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
        std::copy(std::begin(rgb), std::end(rgb), image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * at));
      }
  }
  return image;
}

}  // namespace tool
