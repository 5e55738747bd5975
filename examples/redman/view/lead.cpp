#include "view/lead.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tool {
namespace {

constexpr double kProbe = 1e-4;      // rad (m), by which a joint is moved
constexpr double kMostWay = 0.03;    // m, of a step
constexpr double kDamping = 0.02;    // m/rad
constexpr double kMostChange = 0.1;  // of an entry of the action, in a step

using Column = std::array<double, 3>;

// x of (A A^T + d^2) x = e, for columns A; by Cramer's rule.
Column solved(const std::vector<Column>& columns, const Column& e) {
  double m[3][3] = {};
  for (const Column& c : columns)
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 3; ++j) m[i][j] += c[i] * c[j];
  for (size_t i = 0; i < 3; ++i) m[i][i] += kDamping * kDamping;
  const auto determinant = [&] {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  };
  const double whole = determinant();
  Column x{};
  for (size_t k = 0; k < 3; ++k) {
    double kept[3];
    for (size_t i = 0; i < 3; ++i) kept[i] = m[i][k], m[i][k] = e[i];
    x[k] = determinant() / whole;
    for (size_t i = 0; i < 3; ++i) m[i][k] = kept[i];
  }
  return x;
}

}  // namespace

void point_of(const rdm_pose& pose, const double v[3], double out[3]) {
  const double* q = pose.q;
  const double t[3] = {2 * (q[1] * v[2] - q[2] * v[1]), 2 * (q[2] * v[0] - q[0] * v[2]),
                       2 * (q[0] * v[1] - q[1] * v[0])};
  out[0] = pose.p[0] + v[0] + q[3] * t[0] + q[1] * t[2] - q[2] * t[1];
  out[1] = pose.p[1] + v[1] + q[3] * t[1] + q[2] * t[0] - q[0] * t[2];
  out[2] = pose.p[2] + v[2] + q[3] * t[2] + q[0] * t[1] - q[1] * t[0];
}

bool Lead::bring(const redman::Pool& pool, int32_t world, int32_t shape, const double local[3],
                 const double to[3], float* action) {
  if (!copy_) {
    PoolSettings one = settings_;
    one.envs = 1;
    one.threads = 0;
    copy_.emplace(make_pool(one, RDM_AUTORESET_OFF));
    copy_->reset();
  }
  redman::check(rdm_pool_copy(copy_->get(), 0, pool.get(), world));
  const auto where = [&] {
    Column at;
    point_of(copy_->poses()[static_cast<size_t>(shape)], local, at.data());
    return at;
  };
  Column way;
  const Column start = where();
  for (size_t k = 0; k < 3; ++k) way[k] = to[k] - start[k];
  const double length = std::hypot(way[0], way[1], way[2]),
               share = std::min(1.0, kMostWay / std::max(length, 1e-9));
  for (double& w : way) w *= share;

  // coupled joints follow the one that leads them
  std::vector<double> q = copy_->joint_positions();
  std::vector<rdm_joint_info> joints;
  for (int32_t i = 0; i < pool.spec().num_joints; ++i) joints.push_back(pool.joint(i));
  for (size_t i = 0; i < q.size(); ++i) {
    q[i] = std::clamp(q[i], joints[i].lower, joints[i].upper);
    if (joints[i].action < 0 && joints[i].kp == 0) q[i] = std::numeric_limits<double>::quiet_NaN();
  }
  copy_->set_joints(0, q);
  const Column base = where();
  std::vector<Column> columns;
  std::vector<size_t> moved;
  for (size_t i = 0; i < q.size(); ++i) {
    if (joints[i].action < 0 || joints[i].action >= pool.spec().action_dim) continue;
    const double before = q[i], by = before + kProbe > joints[i].upper ? -kProbe : kProbe;
    q[i] += by;
    copy_->set_joints(0, q);
    const Column there = where();
    q[i] = before;
    Column c;
    for (size_t k = 0; k < 3; ++k) c[k] = (there[k] - base[k]) / by;
    if (std::hypot(c[0], c[1], c[2]) < 1e-6) continue;
    columns.push_back(c);
    moved.push_back(i);
  }
  if (columns.empty()) return false;
  const Column x = solved(columns, way);
  for (size_t n = 0; n < columns.size(); ++n) {
    const rdm_joint_info& j = joints[moved[n]];
    const double turn = columns[n][0] * x[0] + columns[n][1] * x[1] + columns[n][2] * x[2];
    const double change = std::clamp(2 * turn / std::max(j.upper - j.lower, 1e-6), -kMostChange, kMostChange);
    float& a = action[j.action];
    a = static_cast<float>(std::clamp(static_cast<double>(a) + change, -1.0, 1.0));
  }
  return true;
}

}  // namespace tool
