#include <gtest/gtest.h>

#include "physics/model/inertia.hpp"
#include "robot/robot.hpp"

namespace rdm {
namespace {

// Moments by summing small cubes of the solid that `inside` describes.
template <class F>
Inertia summed(double mass, double reach, F&& inside) {
  const int n = 80;
  const double cell = 2 * reach / n;
  Inertia out;
  double count = 0, xx = 0, yy = 0, zz = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const Vec3 p{(i + 0.5) * cell - reach, (j + 0.5) * cell - reach, (k + 0.5) * cell - reach};
        if (!inside(p)) continue;
        ++count;
        xx += p.y * p.y + p.z * p.z, yy += p.x * p.x + p.z * p.z, zz += p.x * p.x + p.y * p.y;
      }
  out.mass = mass;
  out.moment[0] = mass * xx / count, out.moment[1] = mass * yy / count, out.moment[2] = mass * zz / count;
  return out;
}

void expect_near(const Inertia& a, const Inertia& b, double share) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a.moment[i], b.moment[i], share * b.moment[i]) << i;
}

TEST(Inertia, SolidsAgreeWithSums) {
  expect_near(sphere_inertia(2, 0.3), summed(2, 0.3, [](Vec3 p) { return dot(p, p) < 0.09; }), 0.01);
  expect_near(box_inertia(2, {0.1, 0.2, 0.3}),
              summed(2, 0.3, [](Vec3 p) { return std::fabs(p.x) < 0.1 && std::fabs(p.y) < 0.2; }), 0.02);
  expect_near(cylinder_inertia(2, 0.1, 0.3),
              summed(2, 0.3, [](Vec3 p) { return p.x * p.x + p.y * p.y < 0.01; }), 0.02);
  expect_near(capsule_inertia(2, 0.1, 0.2),
              summed(2, 0.3,
                     [](Vec3 p) {
                       const double z = std::fabs(p.z) - 0.2;
                       return p.x * p.x + p.y * p.y + (z > 0 ? z * z : 0) < 0.01;
                     }),
              0.02);
}

TEST(Inertia, OfAnEllipsoidIsItsClosedForm) {
  const Inertia egg = ellipsoid_inertia(0.0754, {0.03, 0.03, 0.04});
  EXPECT_NEAR(egg.moment[0], 3.77e-5, 1e-9);  // what the task's egg has
  EXPECT_NEAR(egg.moment[2], 2.71e-5, 1e-7);
  const Inertia ball = ellipsoid_inertia(2, {0.3, 0.3, 0.3}), same = sphere_inertia(2, 0.3);
  for (int i = 0; i < 6; ++i) EXPECT_DOUBLE_EQ(ball.moment[i], same.moment[i]);
  expect_near(ellipsoid_inertia(2, {0.3, 0.2, 0.1}),
              summed(2, 0.3,
                     [](Vec3 p) {
                       return norm({p.x / 0.3, p.y / 0.2, p.z / 0.1}) < 1;
                     }),
              0.02);
}

TEST(Inertia, TwoBallsAsOne) {
  Inertia a = sphere_inertia(1, 0.1), b = sphere_inertia(3, 0.1);
  a.com = {1, 0, 0};
  b.com = {-1, 0, 0};
  const Inertia both = combined(a, b);
  EXPECT_DOUBLE_EQ(both.mass, 4);
  EXPECT_DOUBLE_EQ(both.com.x, -0.5);
  EXPECT_NEAR(both.moment[0], 0.4 * 4 * 0.01, 1e-15);
  EXPECT_NEAR(both.moment[1], 0.4 * 4 * 0.01 + 1 * 2.25 + 3 * 0.25, 1e-12);
}

TEST(Inertia, TurnsWithItsFrame) {
  Inertia box = box_inertia(1, {0.1, 0.2, 0.3});
  box.com = {0, 0, 1};
  const Inertia turned = transformed(box, {{5, 0, 0}, axis_angle({1, 0, 0}, std::acos(0.0))});
  EXPECT_NEAR(norm(turned.com - Vec3{5, -1, 0}), 0, 1e-12);
  EXPECT_NEAR(turned.moment[1], box.moment[2], 1e-12);
  EXPECT_NEAR(turned.moment[2], box.moment[1], 1e-12);
  EXPECT_NEAR(turned.moment[5], 0, 1e-12);
}

TEST(Inertia, RootOfTheShadowHandIsMountAndForearm) {
  Inertia mount = {0.1, {}, {1e-3, 1e-3, 1e-3, 0, 0, 0}};
  Inertia forearm = {4, {0.001, 0.008, 0.29}, {0.01, 0.01, 0.0075, 0, 0, 0}};
  const Inertia both = combined(mount, forearm);
  EXPECT_NEAR(norm(both.com - kShadowHand.root.com), 0, 1e-15);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(both.moment[i], kShadowHand.root.moment[i], 1e-15) << i;
}

TEST(Inertia, PositiveDefinite) {
  EXPECT_TRUE(positive_definite({}));
  EXPECT_FALSE(positive_definite({{1, 2, 0, 2, 1, 0, 0, 0, 1}}));
  EXPECT_FALSE(positive_definite({{1, 0, 0, 0, 1, 0, 0, 0, 0}}));
}

}  // namespace
}  // namespace rdm
