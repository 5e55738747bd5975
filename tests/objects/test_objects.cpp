// The catalogue: what is in it, the bodies that it makes, and objects that come and go.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "base/rng.hpp"
#include "objects/hull_text.hpp"
#include "objects/objects.hpp"
#include "physics/model/inertia.hpp"

namespace rdm {
namespace {

Object named(const char* name) {
  return *ObjectRef(find_object(name));  // of the library's own: tables that stay
}
BodyDef body_of(const char* name, double mass = 0, double scale = 1) {
  return make_object_body(named(name), "object", {{1, 2, 3}, {}}, mass, scale, 2);
}

TEST(Objects, BeginWithTheOnesForThrowing) {
  EXPECT_STREQ(ObjectRef(0)->name, "egg");
  EXPECT_EQ(named("egg").mass, 0.0754);
  EXPECT_EQ(named("ball").shapes[0].size.x, 0.0333);
  EXPECT_EQ(named("Heavy-Ball").mass, 0.25);
  EXPECT_EQ(named("cracker_box").shapes[0].size.y, 0.105);
  EXPECT_EQ(named("soup_can").shapes[0].size.y, 0.0505);
  EXPECT_EQ(named("cube").mass, 0.071);
  EXPECT_EQ(named("ellipsoid_egg").shapes[0].size.z, 0.04);
  EXPECT_STREQ(ObjectRef(14)->name, "hull");
  EXPECT_EQ(guard([] { find_object("bal"); }), Code::kNotFound);
  EXPECT_NE(std::string(last_error()).find("nearest is ball"), std::string::npos);
  EXPECT_EQ(guard([] { find_object(nullptr); }), Code::kArgument);
  EXPECT_EQ(guard([] { ObjectRef ref(num_objects()); }), Code::kRange);
  EXPECT_EQ(guard([] { ObjectRef ref(-1); }), Code::kRange);
}

TEST(Objects, AreFoundByTheirNumbersToo) {
  for (const auto& [name, object] : {std::pair{"003_cracker_box", "cracker_box"},
                                     {"005_tomato_soup_can", "soup_can"},
                                     {"tomato_soup_can", "soup_can"},
                                     {"025_mug", "mug_with_handle"},
                                     {"mug", "mug"},
                                     {"070-a_colored_wood_blocks", "colored_wood_block"},
                                     {"Power-Drill", "power_drill"}})
    EXPECT_STREQ(named(name).name, object) << name;
}

// Masses of the table of the YCB set, kg, by its numbers.
TEST(Objects, WeighWhatTheirTableSays) {
  const struct {
    const char* name;
    double mass;
  } rows[] = {{"001_chips_can", 0.205},
              {"002_master_chef_can", 0.414},
              {"011_banana", 0.066},
              {"016_pear", 0.049},
              {"019_pitcher_base", 0.178},
              {"021_bleach_cleanser", 1.131},
              {"024_bowl", 0.147},
              {"025_mug", 0.118},
              {"029_plate", 0.279},
              {"033_spatula", 0.0515},
              {"035_power_drill", 0.895},
              {"037_scissors", 0.082},
              {"038_padlock", 0.304},
              {"042_adjustable_wrench", 0.252},
              {"048_hammer", 0.665},
              {"052_extra_large_clamp", 0.202},
              {"053_mini_soccer_ball", 0.123},
              {"065-j_cups", 0.038},
              {"076_timer", 0.102},
              {"077_rubiks_cube", 0.094}};
  for (const auto& row : rows) EXPECT_EQ(named(row.name).mass, row.mass) << row.name;
}

// Whole lengths along the axes, m, in any order.
TEST(Objects, MeasureWhatTheirRowsSay) {
  const struct {
    const char* name;
    double least, middle, most;
  } rows[] = {{"banana", 0.036, 0.082, 0.19},
              {"strawberry", 0.0438, 0.0438, 0.055},
              {"pear", 0.0662, 0.0662, 0.1},
              {"pitcher_base", 0.108, 0.152, 0.235},
              {"bleach_cleanser", 0.065, 0.098, 0.25},
              {"windex_bottle", 0.06, 0.105, 0.27},
              {"wine_glass", 0.089, 0.089, 0.137},
              {"bowl", 0.053, 0.159, 0.159},
              {"mug_with_handle", 0.08, 0.082, 0.1065},
              {"plate", 0.024, 0.258, 0.258},
              {"skillet_lid", 0.022, 0.27, 0.27},
              {"fork", 0.014, 0.02, 0.198},
              {"spoon", 0.012, 0.04, 0.195},
              {"knife", 0.006, 0.017, 0.215},
              {"spatula", 0.03, 0.083, 0.35},
              {"scissors", 0.014, 0.087, 0.2},
              {"padlock", 0.024, 0.047, 0.065},
              {"adjustable_wrench", 0.005, 0.055, 0.205},
              {"phillips_screwdriver", 0.031, 0.031, 0.215},
              {"plastic_bolt", 0.015, 0.015, 0.043},
              {"plastic_nut", 0.008, 0.015, 0.015},
              {"medium_clamp", 0.027, 0.09, 0.115},
              {"cup_a", 0.055, 0.055, 0.06},
              {"timer", 0.04, 0.08, 0.085}};
  for (const auto& row : rows) {
    Vec3 low{1, 1, 1}, high{-1, -1, -1};
    for (const ShapeDef& s : body_of(row.name).shapes) {
      // the way each shape reaches along an axis of the body
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 way;
        way[axis] = 1;
        const Vec3 n = rotate(conjugate(s.X_LS.q), way);
        double reach = 0;
        const Vec3& d = s.size;
        switch (s.kind) {
          case ShapeKind::kSphere:
            reach = d.x;
            break;
          case ShapeKind::kCapsule:
            reach = d.x + d.y * std::abs(n.z);
            break;
          case ShapeKind::kCylinder:
            reach = d.x * std::hypot(n.x, n.y) + d.y * std::abs(n.z);
            break;
          case ShapeKind::kBox:
            reach = d.x * std::abs(n.x) + d.y * std::abs(n.y) + d.z * std::abs(n.z);
            break;
          case ShapeKind::kEllipsoid:
            reach = norm({d.x * n.x, d.y * n.y, d.z * n.z});
            break;
          case ShapeKind::kHull:
            for (const Vec3& p : s.points) {
              high[axis] = std::max(high[axis], s.X_LS.p[axis] + dot(n, p));
              low[axis] = std::min(low[axis], s.X_LS.p[axis] + dot(n, p));
            }
            continue;
          case ShapeKind::kPlane:
            FAIL();
        }
        high[axis] = std::max(high[axis], s.X_LS.p[axis] + reach);
        low[axis] = std::min(low[axis], s.X_LS.p[axis] - reach);
      }
    }
    const ObjectBox box = object_box(named(row.name));
    EXPECT_LT(norm(box.low - low), 1e-12) << row.name;
    EXPECT_LT(norm(box.high - high), 1e-12) << row.name;
    double lengths[3] = {high.x - low.x, high.y - low.y, high.z - low.z};
    std::sort(lengths, lengths + 3);
    const double asked[3] = {row.least, row.middle, row.most};
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(lengths[i], asked[i], 0.004) << row.name << " " << i;
  }
}

TEST(Objects, ABoxIsFromTheCentreOfMassAroundWhatCanBeTouched) {
  const Quat up = axis_angle({0, 1, 0}, M_PI / 2);  // along x
  ObjectShape shapes[] = {{ShapeKind::kCylinder, {0.02, 0.1, 0}, {0.3, 0, 0}, up, {}},
                          {ShapeKind::kSphere, {0.5, 0, 0}, {0.3, 0, 0}, {}, {}}};
  shapes[1].collides = false;
  Object o{};
  o.name = "seen", o.mass = 1, o.shapes = {shapes, 1};
  ObjectBox box = object_box(o);
  EXPECT_LT(norm(box.low - Vec3{-0.1, -0.02, -0.02}), 1e-12);
  EXPECT_LT(norm(box.high - Vec3{0.1, 0.02, 0.02}), 1e-12);
  o.shapes = {shapes, 2};
  box = object_box(o);
  EXPECT_LT(norm(box.high - Vec3{0.1, 0.02, 0.02}), 1e-12);
  shapes[1].collides = true;
  box = object_box(o);
  EXPECT_LT(norm(box.high - Vec3{0.5, 0.5, 0.5}), 1e-12);
}

TEST(Objects, AreSoundAndDiffer) {
  std::set<std::string> names;
  for (int32_t i = 0; i < num_objects(); ++i) {
    const ObjectRef object(i);
    EXPECT_NO_THROW(check_object(*object)) << object->name;
    EXPECT_TRUE(names.insert(object->name).second) << object->name;
    if (object->alias) {
      EXPECT_TRUE(names.insert(object->alias).second) << object->alias;
    }
    EXPECT_NE(*object->shape_text, 0) << object->name;
    EXPECT_NE(*object->help, 0) << object->name;
    EXPECT_GT(object->material.friction, 0) << object->name;
    EXPECT_LE(object->material.friction, 1) << object->name;
    // as a scene takes it: the centre of mass is the origin
    const BodyDef body = make_object_body(*object, "object", {});
    const Inertia whole =
        shapes_inertia(body.shapes.data(), static_cast<int32_t>(body.shapes.size()), body.inertia.mass);
    EXPECT_LT(norm(whole.com), 1e-12) << object->name;
    SceneDef def;
    def.bodies.push_back(body);
    EXPECT_NO_THROW(make_scene(std::move(def))) << object->name;
  }
}

TEST(Objects, OneShapeIsSaidInTheTextThatIsMadeOfIt) {
  for (int32_t i = 0; i < num_objects(); ++i) {
    const ObjectRef object(i);
    if (object->shapes.count != 1 || object->shapes[0].kind == ShapeKind::kHull) continue;
    char text[160];
    write_shape_text(*object, text, sizeof text);
    EXPECT_STREQ(object->shape_text, text) << object->name;
  }
  char text[160];
  write_shape_text(named("mug_with_handle"), text, sizeof text);
  EXPECT_STREQ(text, "3 capsules, 9 hulls");
}

bool inside(ShapeKind kind, const Vec3& s, const Vec3& p) {
  switch (kind) {
    case ShapeKind::kSphere:
      return norm(p) <= s.x;
    case ShapeKind::kBox:
      return std::abs(p.x) <= s.x && std::abs(p.y) <= s.y && std::abs(p.z) <= s.z;
    case ShapeKind::kCylinder:
      return std::hypot(p.x, p.y) <= s.x && std::abs(p.z) <= s.y;
    case ShapeKind::kCapsule: {
      const double z = std::max(0.0, std::abs(p.z) - s.y);
      return p.x * p.x + p.y * p.y + z * z <= s.x * s.x;
    }
    case ShapeKind::kEllipsoid:
      return norm({p.x / s.x, p.y / s.y, p.z / s.z}) <= 1;
    case ShapeKind::kHull:
    case ShapeKind::kPlane:
      break;
  }
  return false;
}

// Against sums over points drawn inside each solid.
TEST(Objects, MomentsAreThoseOfTheSolids) {
  const struct {
    ShapeKind kind;
    Vec3 size, half;
  } rows[] = {{ShapeKind::kSphere, {0.03, 0, 0}, {0.03, 0.03, 0.03}},
              {ShapeKind::kBox, {0.02, 0.05, 0.03}, {0.02, 0.05, 0.03}},
              {ShapeKind::kCylinder, {0.03, 0.05, 0}, {0.03, 0.03, 0.05}},
              {ShapeKind::kCapsule, {0.03, 0.02, 0}, {0.03, 0.03, 0.05}},
              {ShapeKind::kEllipsoid, {0.03, 0.04, 0.05}, {0.03, 0.04, 0.05}}};
  for (const auto& row : rows) {
    Stream stream(1, 0, Purpose::kTest);
    Vec3 sum;
    int count = 0;
    while (count < 200000) {
      Vec3 p;
      for (int i = 0; i < 3; ++i) p[i] = row.half[i] * stream.signed_unit();
      if (!inside(row.kind, row.size, p)) continue;
      ++count;
      sum += {p.y * p.y + p.z * p.z, p.x * p.x + p.z * p.z, p.x * p.x + p.y * p.y};
    }
    const Vec3 expected = 0.5 / count * sum;
    const ObjectShape shape{row.kind, row.size, {}, {}, {}};
    Object o{};
    o.name = "solid", o.mass = 0.5, o.shapes = {&shape, 1};
    const Inertia inertia = object_inertia(o);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(inertia.moment[i] / expected[i], 1, 0.01) << static_cast<int>(row.kind);
  }
}

// A box cut into two boxes, turned and moved, weighs as the box.
TEST(Objects, PartsWeighAsTheWhole) {
  const Quat q = normalized(Quat{0.8, 0.3, -0.4, 0.2});
  const Vec3 off{0.3, -0.1, 0.2};
  const ObjectShape whole{ShapeKind::kBox, {0.05, 0.02, 0.03}, off, q, {}};
  const ObjectShape halves[] = {{ShapeKind::kBox, {0.02, 0.02, 0.03}, off + rotate(q, {-0.03, 0, 0}), q, {}},
                                {ShapeKind::kBox, {0.03, 0.02, 0.03}, off + rotate(q, {0.02, 0, 0}), q, {}}};
  Object one{}, two{};
  one.name = two.name = "parts", one.mass = two.mass = 0.7;
  one.shapes = {&whole, 1}, two.shapes = table(halves);
  const Inertia a = object_inertia(one), b = object_inertia(two);
  EXPECT_LT(norm(a.com - off), 1e-15);
  EXPECT_LT(norm(a.com - b.com), 1e-15);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(a.moment[i], b.moment[i], 1e-15) << i;
  const BodyDef body = make_object_body(two, "parts", {});
  EXPECT_LT(norm(body.shapes[0].X_LS.p - rotate(q, {-0.03, 0, 0})), 1e-15);
  EXPECT_EQ(norm(body.inertia.com), 0);
}

TEST(Objects, BodyTakesMassAndKeepsShape) {
  const BodyDef egg = body_of("egg");
  EXPECT_EQ(egg.inertia.mass, 0.0754);
  EXPECT_DOUBLE_EQ(egg.inertia.moment[0], 3.77e-5);
  EXPECT_DOUBLE_EQ(egg.inertia.moment[2], 2.71e-5);
  EXPECT_EQ(egg.shapes[0].kind, ShapeKind::kCapsule);
  EXPECT_EQ(egg.shapes[0].size.x, 0.03);
  EXPECT_EQ(2 * egg.shapes[0].size.y, 0.02);  // straight part
  EXPECT_EQ(egg.shapes[0].material, 2);
  EXPECT_EQ(egg.X_WB.p.z, 3);
  const BodyDef heavy = body_of("egg", 0.1508);
  EXPECT_DOUBLE_EQ(heavy.inertia.mass, 0.1508);
  EXPECT_DOUBLE_EQ(heavy.inertia.moment[0], 2 * 3.77e-5);
  EXPECT_DOUBLE_EQ(body_of("ball").inertia.moment[1], 0.4 * 0.0754 * 0.0333 * 0.0333);
}

TEST(Objects, ScaleIsOfAllThatIsLong) {
  const BodyDef one = body_of("mug_with_handle"), two = body_of("mug_with_handle", 0, 2);
  EXPECT_EQ(one.inertia.mass, two.inertia.mass);
  for (int i = 0; i < 6; ++i) EXPECT_DOUBLE_EQ(4 * one.inertia.moment[i], two.inertia.moment[i]);
  for (size_t i = 0; i < one.shapes.size(); ++i) {
    EXPECT_EQ(norm(2 * one.shapes[i].X_LS.p - two.shapes[i].X_LS.p), 0);
    EXPECT_EQ(norm(2 * one.shapes[i].size - two.shapes[i].size), 0);
    for (size_t k = 0; k < one.shapes[i].points.size(); ++k)
      EXPECT_EQ(norm(2 * one.shapes[i].points[k] - two.shapes[i].points[k]), 0);
  }
  EXPECT_TRUE(one.shapes[0].name == "object");
  EXPECT_TRUE(one.shapes[11].name == "object_11");
}

// A box by its corners, somewhere, is the box at the origin.
TEST(Objects, AHullsBodyIsInItsCentreOfMass) {
  const char* text = "0,0,0; 0.04,0,0; 0,0.06,0; 0.04,0.06,0;0,0,0.1;+0.04,0,1e-1;0,0.06,.1;0.04,0.06,0.1;";
  const BodyDef box = make_hull_body(text, "object", {{1, 2, 3}, {}}, 0, 1, 2);
  EXPECT_NEAR(box.inertia.mass, kHullDensity * 0.04 * 0.06 * 0.1, 1e-12);
  const Inertia solid = box_inertia(box.inertia.mass, {0.02, 0.03, 0.05});
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(box.inertia.moment[i], solid.moment[i], 1e-12);
  ASSERT_EQ(box.shapes[0].points.size(), 8u);
  EXPECT_LT(norm(box.shapes[0].points[7] - Vec3{0.02, 0.03, 0.05}), 1e-12);
  EXPECT_EQ(box.inertia.com.x, 0);
  EXPECT_DOUBLE_EQ(make_hull_body(text, "object", {}, 0.2, 1, 2).inertia.mass, 0.2);
}

TEST(Objects, RefuseWhatIsNoListOfPoints) {
  for (const char* text : {"1", "1,2", "1,2,3,4", "1 2 3", "a,b,c", "0,0,0;;1,0,0"}) {
    EXPECT_EQ(guard([&] { hull_points_from(text); }), Code::kArgument) << text;
  }
  EXPECT_EQ(guard([] { make_hull_body("", "object", {}, 0, 1, 0); }), Code::kRange);
}

TEST(Objects, ComeAndGo) {
  Object o = named("pear");
  o.name = "come_and_go", o.alias = "cag";
  const int32_t index = add_object(o);
  EXPECT_EQ(find_object("Come-And-Go"), index);
  EXPECT_EQ(find_object("cag"), index);
  for (const char* taken : {"come_and_go", "cag", "egg", "025_mug", "banana"}) {
    Object again = named("pear");
    again.name = taken;
    EXPECT_EQ(guard([&] { add_object(again); }), Code::kArgument) << taken;
    again.name = "another", again.alias = taken;
    EXPECT_EQ(guard([&] { add_object(again); }), Code::kArgument) << taken;
  }
  ObjectRef ref(index);
  EXPECT_NE(ref->name, o.name);
  EXPECT_NE(ref->shapes[0].points.rows, o.shapes[0].points.rows);  // its own
  remove_object(index);
  EXPECT_STREQ(ref->name, "come_and_go");  // who holds a reference keeps it
  EXPECT_EQ(ref->shapes[0].points.count, 32);
  EXPECT_EQ(guard([&] { ObjectRef gone(index); }), Code::kNotFound);
  EXPECT_EQ(guard([&] { remove_object(index); }), Code::kNotFound);
  EXPECT_EQ(guard([] { find_object("cag"); }), Code::kNotFound);
  EXPECT_EQ(guard([] { remove_object(0); }), Code::kArgument);
  const int32_t next = add_object(o);  // the name is free again, the number is not
  EXPECT_GT(next, index);
  remove_object(next);
}

TEST(Objects, RefuseWhatNoBodyCouldBeMadeOf) {
  const ObjectShape good{ShapeKind::kBox, {0.1, 0.1, 0.1}, {}, {}, {}};
  const auto refused = [&](Code code, const char* text, auto&& spoil) {
    Object o{};
    ObjectShape shape = good;
    o.name = "spoilt", o.material = {"wood", 0.5}, o.mass = 1, o.shapes = {&shape, 1};
    check_object(o);
    spoil(o, shape);
    EXPECT_EQ(guard([&] { check_object(o); }), code) << text;
    EXPECT_NE(std::string(last_error()).find(text), std::string::npos) << last_error();
  };
  refused(Code::kArgument, "the name is empty", [](Object& o, ObjectShape&) { o.name = nullptr; });
  refused(Code::kArgument, "may contain only letters", [](Object& o, ObjectShape&) { o.name = "a|b"; });
  refused(Code::kRange, "longer than 25",
          [](Object& o, ObjectShape&) { o.alias = "a_name_that_has_no_room_left"; });
  refused(Code::kRange, "mass 0 is outside", [](Object& o, ObjectShape&) { o.mass = 0; });
  refused(Code::kArgument, "mass is not finite", [](Object& o, ObjectShape&) { o.mass = std::nan(""); });
  refused(Code::kRange, "friction -1 is outside", [](Object& o, ObjectShape&) { o.material.friction = -1; });
  refused(Code::kRange, "num_shapes: 0 is outside [1, 64]", [](Object& o, ObjectShape&) { o.shapes = {}; });
  refused(Code::kRange, "shapes[0]: size 0 is outside", [](Object&, ObjectShape& s) { s.size.y = 0; });
  refused(Code::kArgument, "shapes[0]: kind 4", [](Object&, ObjectShape& s) { s.kind = ShapeKind::kPlane; });
  refused(Code::kArgument, "shapes[0]: kind 9",
          [](Object&, ObjectShape& s) { s.kind = static_cast<ShapeKind>(9); });
  refused(Code::kRange, "num_points 0", [](Object&, ObjectShape& s) { s.kind = ShapeKind::kHull; });
  refused(Code::kArgument, "place is not finite", [](Object&, ObjectShape& s) { s.p.z = INFINITY; });
  refused(Code::kArgument, "quaternion has length", [](Object&, ObjectShape& s) { s.q.w = 2; });
  refused(Code::kArgument, "none of its shapes collides",
          [](Object&, ObjectShape& s) { s.collides = false; });
  refused(Code::kArgument, "not positive definite", [](Object& o, ObjectShape&) { o.moment[0] = 1; });
  refused(Code::kArgument, "triangle inequality",
          [](Object& o, ObjectShape&) { o.moment[0] = o.moment[1] = 1, o.moment[2] = 3; });
  const Vec3 flat[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  refused(Code::kArgument, "plane",
          [&](Object&, ObjectShape& s) { s.kind = ShapeKind::kHull, s.points = table(flat); });
}

// Threads that add, look and remove at the same time.
TEST(Objects, ManyThreadsMayAddAndRemove) {
  std::atomic<int> failures{0};
  std::vector<std::thread> threads;
  const Object pear = named("pear");
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([t, &failures, &pear] {
      try {
        for (int k = 0; k < 40; ++k) {
          const std::string name = "thread_" + std::to_string(t) + "_" + std::to_string(k);
          Object o = pear;
          o.name = name.c_str(), o.alias = nullptr;
          const int32_t index = add_object(o);
          const ObjectRef ref(index);
          if (name != ref->name || find_object(name.c_str()) != index) ++failures;
          if (make_object_body(*ref, "object", {}).shapes.size() != 1) ++failures;
          remove_object(index);
        }
      } catch (const Error&) {
        ++failures;
      }
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(failures, 0);
}

}  // namespace
}  // namespace rdm
