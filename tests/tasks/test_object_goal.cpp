#include <algorithm>
#include <cmath>

#include "tasks/catalog.hpp"
#include "tasks/hand/object_goal.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

TEST(ObjectGoal, RotationAngle) {
  EXPECT_EQ(rotation_angle({1, 0, 0, 0}), 0);
  EXPECT_NEAR(rotation_angle(axis_angle({0, 1, 0}, 1.2)), 1.2, 1e-12);
  const Quat far = axis_angle({0, 0, 1}, 1.2);
  EXPECT_NEAR(rotation_angle({-far.w, -far.x, -far.y, -far.z}), 1.2, 1e-12);
  EXPECT_EQ(rotation_angle({0, 1.0000001, 0, 0}), kPi);  // rounding must not give NaN
}

// Rx(pi u1) Ry(pi u2): the mean angle between two draws is 2.23 rad.
TEST(ObjectGoal, DrawnRotations) {
  Stream stream(3, 0, Purpose::kTest);
  double sum = 0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const Quat a = draw_rotation(stream), b = draw_rotation(stream);
    EXPECT_NEAR(to_matrix(a)(0, 1), 0, 1e-12);  // a turn about y keeps the second axis, one about x its x
    sum += rotation_angle(a * conjugate(b));
  }
  EXPECT_NEAR(sum / kDraws, 2.23, 0.02);
}

class ObjectReset : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
};

TEST_F(ObjectReset, StartsNearThePlaceAndClear) {
  TestPool p("hand_over_safe_finger", 300);
  p->reset(nullptr, nullptr);
  double low[3] = {9, 9, 9}, high[3] = {-9, -9, -9};
  int raised = 0;
  for (int i = 0; i < 300; ++i) {
    const Motion& m = p->world(i).body(0);
    EXPECT_EQ(p->world(i).body_overlap(0), 0);
    EXPECT_EQ(norm(m.v) + norm(m.w), 0);
    raised += m.X.p.z > 0.55;
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], m.X.p[k]);
      high[k] = std::max(high[k], m.X.p[k]);
    }
  }
  const double start[] = {0, -0.39, 0.54};
  for (int k = 0; k < 3; ++k) {
    EXPECT_GE(low[k], start[k] - 0.01);
    EXPECT_LT(low[k], start[k] - 0.008);
    EXPECT_GT(high[k], start[k] + 0.008);
  }
  EXPECT_LE(high[0], 0.01);
  EXPECT_EQ(raised, 0);
  p->step(nullptr);
  for (int i = 0; i < 300; ++i) EXPECT_LT(norm(p->world(i).body(0).v), 1.0);
}

TEST_F(ObjectReset, BigObjectsAreRaisedUntilClear) {
  for (const char* object : {"cracker_box", "mustard_bottle", "soup_can"}) {
    TestPool p("hand_over_safe_finger", 40, {{"object", object, 0}});
    p->reset(nullptr, nullptr);
    for (int i = 0; i < 40; ++i) EXPECT_EQ(p->world(i).body_overlap(0), 0) << object;
    p->step(nullptr);
    for (int i = 0; i < 40; ++i) EXPECT_LT(norm(p->world(i).body(0).v), 1.0) << object;
  }
}

TEST_F(ObjectReset, FixedMeansFixed) {
  TestPool p("hand_over_safe_finger", 2,
             {{"start_noise", nullptr, 0},
              {"start_rotation", "fixed", 0},
              {"goal_rotation", "fixed", 0},
              {"start.y", nullptr, -0.35},
              {"start.z", nullptr, 0.6},
              {"goal.z", nullptr, 0.5}});
  p->reset(nullptr, nullptr);
  for (int i = 0; i < 2; ++i) {
    const float* o = p.obs(i) + 374;
    const float expected[] = {0, -0.35f, 0.6f,   0,    0, 0, 1, 0, 0, 0, 0, 0,
                              0, 0,      -0.64f, 0.5f, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int k = 0; k < 24; ++k) EXPECT_EQ(o[k], expected[k]) << k;
  }
}

// Rotation error = object times conjugate goal, scalar last, no sign change unless asked for.
TEST_F(ObjectReset, RotationErrorInTheObservation) {
  for (const char* canonical : {"false", "true"}) {
    TestPool p("hand_over_safe_finger", 50, {{"canonical_rotation", canonical, 0}});
    p->reset(nullptr, nullptr);
    int negative = 0;
    for (int i = 0; i < 50; ++i) {
      const float* o = p.obs(i) + 374;
      const auto quat = [](const float* q) { return Quat{q[3], q[0], q[1], q[2]}; };
      Quat e = quat(o + 3) * conjugate(quat(o + 16));
      if (*canonical == 't' && e.w < 0) e = {-e.w, -e.x, -e.y, -e.z};
      EXPECT_NEAR(o[20], e.x, 1e-6);
      EXPECT_NEAR(o[21], e.y, 1e-6);
      EXPECT_NEAR(o[22], e.z, 1e-6);
      EXPECT_NEAR(o[23], e.w, 1e-6);
      negative += o[23] < 0;
    }
    EXPECT_EQ(negative > 0, *canonical == 'f');
  }
}

// About the vertical alone: the third axis stays upright.
TEST_F(ObjectReset, YawTurnsAboutTheVertical) {
  TestPool p("hand_over_safe_finger", 50, {{"start_rotation", "yaw", 0}});
  p->reset(nullptr, nullptr);
  double low = 9, high = -9;
  for (int i = 0; i < 50; ++i) {
    const Quat q = p->world(i).body(0).X.q;
    EXPECT_NEAR(rotate(q, {0, 0, 1}).z, 1, 1e-12);
    const Vec3 x = rotate(q, {1, 0, 0});
    const double yaw = std::atan2(x.y, x.x);
    low = std::min(low, yaw);
    high = std::max(high, yaw);
  }
  EXPECT_LT(low, -2);
  EXPECT_GT(high, 2);
}

// The lowest and highest coefficient between the object and what it touches.
std::pair<double, double> frictions(const std::vector<OptionInput>& options) {
  TestPool p("grasp", 1, options);
  const Scene& scene = p->task().scene();
  double low = 1e9, high = -1;
  for (const ShapePair& pair : scene.pairs)
    for (const int32_t i : {pair.a, pair.b})
      if (scene.shapes[static_cast<size_t>(i)].carrier == Carrier::kBody)
        low = std::min(low, pair.mu), high = std::max(high, pair.mu);
  return {low, high};
}

TEST_F(ObjectReset, SurfacesHaveTheFrictionOfTheTaskOrTheirOwn) {
  EXPECT_EQ(frictions({{"object", "banana", 0}}), std::pair(0.75, 1.0));
  EXPECT_EQ(frictions({{"object", "banana", 0}, {"own_friction", "true", 0}}), std::pair(0.4, 0.4));
  EXPECT_EQ(frictions({{"object", "racquetball", 0}, {"own_friction", "true", 0}}), std::pair(0.9, 0.9));
}

TEST_F(ObjectReset, EveryShapeOfTheObjectIsTouched) {
  TestPool p("hand_over_safe_finger", 1, {{"object", "025_mug", 0}, {"object_scale", nullptr, 1.5}});
  const Scene& scene = p->task().scene();
  EXPECT_EQ(scene.num_body_shapes, 12);
  std::vector<int> pairs(scene.shapes.size());
  for (const ShapePair& pair : scene.pairs)
    ++pairs[static_cast<size_t>(pair.a)], ++pairs[static_cast<size_t>(pair.b)];
  for (int32_t i = 0; i < 12; ++i)
    EXPECT_EQ(pairs[static_cast<size_t>(scene.first_body_shape + i)],
              pairs[static_cast<size_t>(scene.first_body_shape)]);
  EXPECT_EQ(scene.def.bodies[0].inertia.mass, 0.118);
}

}  // namespace
}  // namespace rdm::test
