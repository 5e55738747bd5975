#include <gtest/gtest.h>

#include "base/rng.hpp"
#include "base/vec.hpp"

namespace rdm {
namespace {

Quat random_turn(Stream& s) {
  return normalized(Quat{s.signed_unit(), s.signed_unit(), s.signed_unit(), s.signed_unit()});
}
Vec3 random_vector(Stream& s) {
  return {s.signed_unit(), s.signed_unit(), s.signed_unit()};
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-14) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

// A constant expression may not reach one member from another one's address, so this would not compile with
// an index past a member: undefined, and optimisers have made wrong contacts of it.
constexpr bool each_member_by_its_index() {
  Vec3 v{1, 2, 3};
  for (int i = 0; i < 3; ++i) v[i] *= 2;
  const Vec3& w = v;
  return v.x == 2 && v.y == 4 && v.z == 6 && w[0] == 2 && w[1] == 4 && w[2] == 6;
}
static_assert(each_member_by_its_index());

TEST(Vec3, Algebra) {
  const Vec3 a{1, 2, 3}, b{-2, 0.5, 4};
  expect_near(cross(a, b), {6.5, -10, 4.5}, 0);
  EXPECT_EQ(dot(a, b), 11.0);
  EXPECT_EQ(norm(Vec3{2, 3, 6}), 7.0);
  Vec3 c = a;
  c += b;
  c -= {0, 0, 7};
  expect_near(c, {-1, 2.5, 0}, 0);
  EXPECT_EQ(a[0] + 10 * a[1] + 100 * a[2], 321);
  expect_near(normalized(Vec3{0, -3, 0}), {0, -1, 0}, 0);
  EXPECT_TRUE(finite(a));
  EXPECT_FALSE(finite(Vec3{0, 0 * std::log(0.0), 0}));
}

TEST(Quat, QuarterTurnsGoTheRightHandedWay) {
  expect_near(rotate(axis_angle({0, 0, 1}, kPi / 2), {1, 0, 0}), {0, 1, 0});
  expect_near(rotate(axis_angle({1, 0, 0}, kPi / 2), {0, 1, 0}), {0, 0, 1});
  expect_near(rotate(axis_angle({0, 1, 0}, kPi / 2), {0, 0, 1}), {1, 0, 0});
  expect_near(rotate(axis_angle({1, 0, 0}, -kPi / 2), {0, 1, 0}), {0, 0, -1});
}

TEST(Quat, ProductAppliesTheRightOneFirst) {
  Stream s(1, 0, Purpose::kTest);
  for (int i = 0; i < 100; ++i) {
    const Quat a = random_turn(s), b = random_turn(s);
    const Vec3 v = random_vector(s);
    expect_near(rotate(a * b, v), rotate(a, rotate(b, v)));
    expect_near(rotate(conjugate(a), rotate(a, v)), v);
  }
}

TEST(Quat, RollPitchYawAreFixedAxes) {
  const Vec3 rpy{0.3, -0.7, 1.9}, v{0.2, -0.4, 0.9};
  const Vec3 step1 = rotate(axis_angle({1, 0, 0}, rpy.x), v);
  const Vec3 step2 = rotate(axis_angle({0, 1, 0}, rpy.y), step1);
  expect_near(rotate(from_rpy(rpy), v), rotate(axis_angle({0, 0, 1}, rpy.z), step2));
  // A published pose: roll pi/2 then yaw pi/2 takes y to z, z to -y then to x, x to y.
  const Quat q = from_rpy({kPi / 2, 0, kPi / 2});
  expect_near(rotate(q, {0, 1, 0}), {0, 0, 1});
  expect_near(rotate(q, {0, 0, 1}), {1, 0, 0});
  expect_near(rotate(q, {1, 0, 0}), {0, 1, 0});
}

TEST(Mat3, IsTheQuaternionsRotation) {
  Stream s(2, 0, Purpose::kTest);
  for (int i = 0; i < 100; ++i) {
    const Quat q = random_turn(s);
    const Mat3 r = to_matrix(q);
    const Vec3 v = random_vector(s);
    expect_near(r * v, rotate(q, v));
    expect_near(r.col(1), rotate(q, {0, 1, 0}));
    const Mat3 one = transpose(r) * r;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) EXPECT_NEAR(one(a, b), a == b ? 1 : 0, 1e-14);
    expect_near(cross(r.col(0), r.col(1)), r.col(2));
  }
}

TEST(Mat3, ProductRowsTimesColumns) {
  const Mat3 a{{1, 2, 3, 4, 5, 6, 7, 8, 10}}, b{{2, 0, 1, -1, 3, 0, 0.5, 1, 1}};
  const double want[9] = {1.5, 9, 4, 6, 21, 10, 11, 34, 17};
  const Mat3 c = a * b;
  for (int i = 0; i < 9; ++i) EXPECT_EQ(c.m[i], want[i]) << i;
}

TEST(Pose, ComposesAndInverts) {
  Stream s(3, 0, Purpose::kTest);
  for (int i = 0; i < 100; ++i) {
    const Pose X_WA{random_vector(s), random_turn(s)}, X_AB{random_vector(s), random_turn(s)};
    const Vec3 p_B = random_vector(s);
    expect_near((X_WA * X_AB) * p_B, X_WA * (X_AB * p_B));
    expect_near(inverse(X_WA) * (X_WA * p_B), p_B);
    expect_near((inverse(X_WA) * X_WA).p, {0, 0, 0});
  }
}

}  // namespace
}  // namespace rdm
