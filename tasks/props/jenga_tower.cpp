#include "tasks/props/jenga_tower.hpp"

#include <algorithm>
#include <cstdio>

#include "physics/model/inertia.hpp"

namespace rdm {
namespace {

constexpr double kTableTop = 0.2357, kTableY = -0.6;  // m
constexpr Vec3 kTableHalf = {0.15, 0.189, 0.01};

struct TowerOptions {
  bool real, off;                            // preset, tower
  double block_mass, friction, block_limit;  // kg, 1, m
};
constexpr auto kRows = option_rows<TowerOptions>(
    row<&TowerOptions::real, false, true>(basic(text_option(
        "preset", "redman", "redman|real",
        "tower: redman: pairs of blocks of 0.26 x 0.04 x 0.04 m; real: threes of 0.075 x 0.025 x 0.015 m"))),
    row<&TowerOptions::off, false, true>(basic(text_option(
        "tower", "on", "on|off", "off: there is no tower; the target block lies on the table alone"))),
    row<&TowerOptions::block_mass>(basic(number_option(
        "block_mass", 0, 0, 10, "mass of a block, the target included, kg; 0: the preset's value"))),
    row<&TowerOptions::friction>(number_option(
        "friction.block_block", -1, -1, 10,
        "friction coefficient between two blocks; -1: the preset's, 0.05 (redman) or 0.4 (real)")),
    row<&TowerOptions::block_limit>(number_option("block_limit", 0, 0, 1,
                                                  "displacement above which a block counts as moved, m; 0: "
                                                  "the preset's, 0.01 (redman) or 0.005 (real)")));

// A block of row `row`, whose rows are `height` apart and sink by `sink` each: what a contact may be deep.
double row_height(int row, double height, double sink) {
  return kTableTop + height * (row + 0.5) - sink * (row + 1);
}

// Four levels of two blocks along y under two along x; the target lies between the lower two of level 3.
void build_redman(double sink, JengaTower* t) {
  constexpr double kHalf = 0.02, kLong = 0.13, kOut = 0.07, kTargetLong = 0.08;
  constexpr int kTargetRow = 4;
  t->half[0] = {kHalf, kTargetLong, kHalf};
  t->place[0] = {0, kTableY, row_height(kTargetRow, 2 * kHalf, sink)};
  t->mass[0] = 0.128;
  for (int i = 0; i < kJengaBlocks; ++i) {
    const int row = i / 2;
    const bool along_x = row % 2 != 0;
    const double out = i % 2 == 0 ? -kOut : kOut;
    t->half[1 + i] = {along_x ? kLong : kHalf, along_x ? kHalf : kLong, kHalf};
    t->place[1 + i] = {along_x ? 0 : out, kTableY + (along_x ? out : 0), row_height(row, 2 * kHalf, sink)};
    t->mass[1 + i] = 0.208;
  }
  t->friction = 0.05;
  t->moved = 0.01;
}

// Rows of three and a top row of two; the target is the middle one of the third.
void build_real(double layer, JengaTower* t) {
  constexpr Vec3 kHalf = {0.0125, 0.0375, 0.0075};  // along y
  const double sink = std::min(layer, kLayerShare * kHalf.z);
  constexpr double kPitch = 2 * kHalf.x + 2e-4;  // side faces do not touch
  constexpr int kTarget = 7;
  int next = 1;
  for (int i = 0; i < 1 + kJengaBlocks; ++i) {
    const int row = i / 3, body = i == kTarget ? 0 : next++;
    const bool along_x = row % 2 != 0, top = i >= 15;
    const double out = top ? (i == 15 ? -kPitch : kPitch) : (i % 3 - 1) * kPitch;
    t->half[body] = along_x ? Vec3{kHalf.y, kHalf.x, kHalf.z} : kHalf;
    t->place[body] = {along_x ? 0 : out, kTableY + (along_x ? out : 0), row_height(row, 2 * kHalf.z, sink)};
    t->mass[body] = 0.020;
  }
  t->friction = 0.4;
  t->moved = 0.005;
}

}  // namespace

void add_tower_options(OptionTable& table) {
  table.add(kRows);
}

JengaTower jenga_tower_from(const Options& options, double contact_layer) {
  const TowerOptions o = kRows.read(options);
  JengaTower t;
  t.table = {0, kTableY, kTableTop - kTableHalf.z};
  t.table_half = kTableHalf;
  (o.real ? build_real : build_redman)(contact_layer, &t);
  if (o.off) {
    t.blocks = 0;
    t.place[0].z = row_height(0, 2 * t.half[0].z, contact_layer);
  }
  if (o.block_mass > 0) {
    const double scale = o.block_mass / t.mass[1];
    for (double& m : t.mass) m *= scale;
  }
  if (o.friction >= 0) t.friction = o.friction;
  if (o.block_limit > 0) t.moved = o.block_limit;
  return t;
}

void add_tower(const JengaTower& tower, int32_t target, int32_t block, int32_t table, SceneDef* scene) {
  for (int i = 0; i < 1 + tower.blocks; ++i) {
    BodyDef body;
    char name[kNameSize] = "target";
    if (i > 0) std::snprintf(name, sizeof name, "block_%d", i);
    body.name = name;
    body.X_WB.p = tower.place[i];
    body.inertia = box_inertia(tower.mass[i], tower.half[i]);
    ShapeDef shape;
    shape.name = name;
    shape.kind = ShapeKind::kBox;
    shape.size = tower.half[i];
    shape.material = i == 0 ? target : block;
    shape.finish = Finish::kWood;
    const bool across = tower.half[i].x > tower.half[i].y;
    constexpr uint8_t kColors[3][3] = {{200, 70, 50}, {222, 188, 135}, {205, 165, 110}};
    std::copy_n(kColors[i == 0 ? 0 : across ? 2 : 1], 3, shape.color);
    body.shapes.push_back(shape);
    scene->bodies.push_back(body);
  }
  ShapeDef top;
  top.name = "table";
  top.kind = ShapeKind::kBox;
  top.size = tower.table_half;
  top.X_LS.p = tower.table;
  top.material = table;
  top.color[0] = 120, top.color[1] = 125, top.color[2] = 135;
  scene->statics.push_back(top);
}

}  // namespace rdm
