#include "view/lead.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tool {
namespace {

// How long is looked ahead, s, and how much of an entry is tried. More where nothing moves at first: a finger that presses on a
// table has targets far below it.
struct Look {
  double ahead, probe;
};
constexpr Look kLooks[] = {{0.3, 0.1}, {0.6, 1}};
constexpr double kLeast = 1e-3;    // m for a whole entry: what moves the point less does not move it
constexpr double kMostWay = 0.03;  // m, in the time that is looked ahead
constexpr double kDamping = 0.01;  // m for a whole entry
constexpr double kPosture =
    0.1;  // of the way of an entry back to that of the hold action, in a step, as far as the point stays
constexpr double kMostChange = 0.2;  // of an entry of the action, in a step

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

redman::Pool& Lead::copy(const redman::Pool& pool, int32_t world) {
  if (!copy_) {
    PoolSettings one = settings_;
    one.envs = 1;
    one.threads = 0;
    copy_.emplace(make_pool(one, RDM_AUTORESET_OFF));
    copy_->reset();
    copy_->baseline(RDM_BASELINE_HOLD);
    hold_.assign(copy_->action()[0].begin(), copy_->action()[0].end());
  }
  redman::check(rdm_pool_copy(copy_->get(), 0, pool.get(), world));
  return *copy_;
}

Column Lead::where(const Point& point) const {
  Column at;
  point_of(copy_->poses()[static_cast<size_t>(point.shape)], point.local, at.data());
  return at;
}

Column Lead::after(const redman::Pool& pool, const Point& point, double ahead, const float* action) {
  redman::Pool& c = copy(pool, point.world);
  const auto steps = static_cast<int>(std::ceil(ahead / pool.spec().control_dt - 1e-9));
  for (int t = 0; t < steps; ++t) {
    std::copy_n(action, pool.spec().action_dim, c.action()[0].begin());
    c.step();
    if (c.terminated()[0] || c.truncated()[0]) break;  // it would not go on
  }
  return where(point);
}

// Whether some joint moves it: things that lie about are pulled, not led.
bool Lead::is_of_robot(const redman::Pool& pool, const Point& point) {
  redman::Pool& c = copy(pool, point.world);
  std::vector<double> q = c.joint_positions();
  std::vector<rdm_joint_info> joints;
  for (int32_t i = 0; i < pool.spec().num_joints; ++i) joints.push_back(pool.joint(i));
  for (size_t i = 0; i < q.size(); ++i) {
    q[i] = std::clamp(q[i], joints[i].lower, joints[i].upper);
    // coupled joints follow the one that leads them
    if (joints[i].action < 0 && joints[i].kp == 0) q[i] = std::numeric_limits<double>::quiet_NaN();
  }
  c.set_joints(0, q);
  const Column before = where(point);
  for (double& x : q) x += 1e-3;
  c.set_joints(0, q);
  const Column now = where(point);
  return std::hypot(now[0] - before[0], now[1] - before[1], now[2] - before[2]) > 1e-6;
}

bool Lead::bring(const redman::Pool& pool, const Point& point, const double to[3], float* action) {
  if (!is_of_robot(pool, point)) return false;
  std::vector<float> tried(action, action + pool.spec().action_dim);
  for (const Look& look : kLooks) {
    const Column start = after(pool, point, look.ahead, action);
    std::vector<Column> columns;
    std::vector<size_t> moved;
    for (size_t e = 0; e < tried.size(); ++e) {
      const double by = static_cast<double>(action[e]) > 1 - look.probe ? -look.probe : look.probe;
      tried[e] = static_cast<float>(std::max(static_cast<double>(action[e]) + by, -1.0));
      const Column there = after(pool, point, look.ahead, tried.data());
      const double done = static_cast<double>(tried[e] - action[e]);
      tried[e] = action[e];
      Column c;
      for (size_t k = 0; k < 3; ++k) c[k] = (there[k] - start[k]) / done;
      if (std::hypot(c[0], c[1], c[2]) < kLeast) continue;
      columns.push_back(c);
      moved.push_back(e);
    }
    if (columns.empty()) continue;
    // da = J+ (way - J r) + r: r brings the entries back to the hold action without moving the point. Else what changes step by step
    // would turn joints on and on.
    Column way;
    for (size_t k = 0; k < 3; ++k) way[k] = to[k] - start[k];
    const double length = std::hypot(way[0], way[1], way[2]),
                 share = std::min(1.0, kMostWay / std::max(length, 1e-9));
    std::vector<double> back(columns.size());
    for (double& w : way) w *= share;
    for (size_t n = 0; n < columns.size(); ++n) {
      back[n] = kPosture * static_cast<double>(hold_[moved[n]] - action[moved[n]]);
      for (size_t k = 0; k < 3; ++k) way[k] -= columns[n][k] * back[n];
    }
    const Column x = solved(columns, way);
    for (size_t n = 0; n < columns.size(); ++n) {
      const double change = columns[n][0] * x[0] + columns[n][1] * x[1] + columns[n][2] * x[2] + back[n];
      float& a = action[moved[n]];
      a = static_cast<float>(
          std::clamp(static_cast<double>(a) + std::clamp(change, -kMostChange, kMostChange), -1.0, 1.0));
    }
    return true;
  }
  return false;
}

}  // namespace tool
