#include "tasks/throw/wall.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>

#include "base/chars.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

constexpr auto kRows = option_rows<Wall>(
    row<&Wall::y>(number_option("wall.y", -0.525, -10, 10, "y of the wall's middle plane, m")),
    row<&Wall::thickness>(number_option("wall.thickness", 0.03, 0.002, 1, "thickness of the wall, m")),
    row<&Wall::width>(
        number_option("wall.width", 1, 0.01, 10, "width of the wall, which is centred at x = 0, m")),
    row<&Wall::low_z>(number_option("wall.low", 0.15, -10, 10, "height of the wall's lower edge, m")),
    row<&Wall::high_z>(number_option("wall.high", 1.15, -10, 10, "height of the wall's upper edge, m")),
    row<&Wall::hole_x>(number_option("wall.hole.x", 0, -10, 10, "x of the hole's centre, m")),
    row<&Wall::hole_z>(number_option("wall.hole.z", 0.65, -10, 10, "z of the hole's centre, m")),
    row<&Wall::hole_width>(number_option("wall.hole.width", 0.2, 0, 10, "width of the hole in the wall, m")),
    row<&Wall::hole_height>(
        number_option("wall.hole.height", 0.2, 0, 10, "height of the hole in the wall, m")));
constexpr const char* kBoxKeys[kMaxWallBoxes] = {"wall.box1", "wall.box2", "wall.box3", "wall.box4",
                                                 "wall.box5", "wall.box6", "wall.box7", "wall.box8"};

void paint(ShapeDef* shape, int number, int32_t material) {
  char name[kNameSize];
  std::snprintf(name, sizeof name, "wall%d", number);
  shape->name = name;
  shape->kind = ShapeKind::kBox;
  shape->material = material;
  shape->color[0] = 176, shape->color[1] = 132, shape->color[2] = 96;
}

}  // namespace

void add_wall_options(OptionTable& table) {
  table.add(kRows);
  for (const char* key : kBoxKeys)
    table.add(text_option(key, "", nullptr,
                          "a box of a custom wall: 'x y z width depth height [rx ry rz]', m and degrees"));
}

Wall wall_from(const Options& o) {
  const Wall w = kRows.read(o);
  if (w.low_z >= w.high_z) fail(Code::kArgument, "wall.low: %g m is not below wall.high", w.low_z);
  if (w.hole_x - 0.5 * w.hole_width < w.low_x() || w.hole_x + 0.5 * w.hole_width > w.high_x())
    fail(Code::kArgument, "wall.hole.width: the hole extends beyond the wall");
  if (w.hole_z - 0.5 * w.hole_height < w.low_z || w.hole_z + 0.5 * w.hole_height > w.high_z)
    fail(Code::kArgument, "wall.hole.height: the hole extends beyond the wall");
  return w;
}

Vector<ShapeDef> wall_panels(const Wall& w, int32_t material) {
  const double left = w.hole_x - 0.5 * w.hole_width, right = w.hole_x + 0.5 * w.hole_width;
  const double bottom = w.hole_z - 0.5 * w.hole_height, top = w.hole_z + 0.5 * w.hole_height;
  const double edges[][4] = {{w.low_x(), w.high_x(), top, w.high_z},
                             {w.low_x(), w.high_x(), w.low_z, bottom},
                             {w.low_x(), left, bottom, top},
                             {right, w.high_x(), bottom, top}};
  Vector<ShapeDef> out;
  constexpr double kThinnest = 1e-4;  // m, of a panel worth having
  for (const auto& [x0, x1, z0, z1] : edges) {
    if (x1 - x0 < kThinnest || z1 - z0 < kThinnest) continue;
    ShapeDef s;
    paint(&s, static_cast<int>(out.size()) + 1, material);
    s.size = {0.5 * (x1 - x0), 0.5 * w.thickness, 0.5 * (z1 - z0)};
    s.X_LS.p = {0.5 * (x0 + x1), w.y, 0.5 * (z0 + z1)};
    out.push_back(s);
  }
  return out;
}

bool parse_box(const char* text, ShapeDef* box) {
  double value[9] = {};
  int count = 0;
  const char *at = text, *const stop = text + std::strlen(text);
  for (; count < 9; ++count) {
    while (at < stop && *at == ' ') ++at;
    const auto [end, error] = from_chars(at, stop, value[count]);
    if (error != std::errc{}) break;
    at = end;
  }
  if (at != stop || (count != 6 && count != 9)) return false;
  for (const double v : value)
    if (!std::isfinite(v)) return false;
  box->X_LS.p = {value[0], value[1], value[2]};
  box->size = {0.5 * value[3], 0.5 * value[4], 0.5 * value[5]};
  box->X_LS.q = from_rpy({kDegree * value[6], kDegree * value[7], kDegree * value[8]});
  return box->size.x > 0 && box->size.y > 0 && box->size.z > 0;
}

Vector<ShapeDef> wall_boxes(const Options& o, int32_t material) {
  Vector<ShapeDef> out;
  for (const char* key : kBoxKeys) {
    const char* text = o.text(key);
    if (!*text) continue;
    ShapeDef s;
    paint(&s, static_cast<int>(out.size()) + 1, material);
    if (!parse_box(text, &s))
      fail(Code::kArgument, "%s: '%s' is not 'x y z width depth height [rx ry rz]'", key, Quoted(text).text);
    out.push_back(s);
  }
  return out;
}

}  // namespace rdm
