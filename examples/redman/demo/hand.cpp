#include "demo/hand.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "common/names.hpp"
#include "common/setting.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr int32_t kFirstRobot = 0;  // of tasks that have no option for it

void times(const double a[4], const double b[4], double out[4]) {
  const double w = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
  const double x = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
  const double y = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0];
  const double z = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3];
  out[0] = x, out[1] = y, out[2] = z, out[3] = w;
}

Place operator*(const Place& a, const Place& b) {
  Place out;
  const double v[4] = {b.p[0], b.p[1], b.p[2], 0}, back[4] = {-a.q[0], -a.q[1], -a.q[2], a.q[3]};
  double half[4], turned[4];
  times(a.q, v, half);
  times(half, back, turned);
  for (int k = 0; k < 3; ++k) out.p[k] = a.p[k] + turned[k];
  times(a.q, b.q, out.q);
  return out;
}

Place inverse(const Place& a) {
  Place turn;
  for (int k = 0; k < 3; ++k) turn.q[k] = -a.q[k];
  turn.q[3] = a.q[3];
  Place back;
  for (int k = 0; k < 3; ++k) back.p[k] = -a.p[k];
  return turn * back;
}

Place place_from(const rdm_pose& pose) {
  Place out;
  for (int k = 0; k < 3; ++k) out.p[k] = pose.p[k];
  double square = 0;
  for (int k = 0; k < 4; ++k) {
    out.q[k] = pose.q[k];
    square += out.q[k] * out.q[k];
  }
  for (double& q : out.q) q /= std::sqrt(square);
  return out;
}

bool observes(const redman::Pool& pool, const std::string& name) {
  for (int32_t i = 0; i < pool.spec().num_fields; ++i) {
    rdm_field_info f = RDM_INIT(rdm_field_info);
    redman::check(rdm_pool_field_at(pool.get(), i, &f));
    if (name == f.name) return true;
  }
  return false;
}

rdm_robot robot_at(int32_t index) {
  rdm_robot robot{};
  robot.struct_size = sizeof robot;
  redman::check(rdm_robot_at(index, &robot));
  return robot;
}

rdm_robot_def def_at(int32_t index) {
  rdm_robot_def def;
  redman::check(rdm_robot_def_init(&def, sizeof def));
  redman::check(rdm_robot_get_def(index, &def));
  return def;
}

int32_t find_robot(const std::string& name) {
  int32_t index = -1;
  redman::check(rdm_robot_find(name.c_str(), &index));
  return index;
}

// Where the base of the arm stands, by the first shape of it that the pool shows; false: it shows none.
bool find_base(const redman::Pool& pool, int32_t robot, const std::string& prefix, Place* out) {
  const rdm_robot_def def = def_at(robot);
  const int32_t count = pool.spec().num_shapes;
  const std::vector<rdm_pose> poses = pool.poses();
  for (int32_t i = 0; i < def.num_shapes; ++i) {
    rdm_robot_shape own;
    redman::check(rdm_robot_shape_at(robot, i, &own));
    if (own.link != RDM_LINK_ROOT) continue;
    for (int32_t k = 0; k < count; ++k) {
      rdm_shape_info shape = RDM_INIT(rdm_shape_info);
      redman::check(rdm_pool_shape_at(pool.get(), k, &shape));
      if (prefix + own.name != shape.name) continue;
      *out = place_from(poses[static_cast<size_t>(k)]) * inverse(place_from(own.pose));
      return true;
    }
  }
  return false;
}

}  // namespace

void turn_of(const double rpy[3], double q[4]) {
  double out[4] = {0, 0, 0, 1};
  for (int k = 0; k < 3; ++k) {
    double step[4] = {0, 0, 0, std::cos(0.5 * rpy[k])}, next[4];
    step[k] = std::sin(0.5 * rpy[k]);
    times(step, out, next);
    std::copy_n(next, 4, out);
  }
  std::copy_n(out, 4, q);
}

Place between(const Place& a, const Place& b, double share) {
  Place out;
  double cosine = 0;
  for (int k = 0; k < 4; ++k) cosine += a.q[k] * b.q[k];
  const double sign = cosine < 0 ? -1 : 1, angle = std::acos(std::min(1.0, std::abs(cosine)));
  const bool close = angle < 1e-6;
  const double from = close ? 1 - share : std::sin((1 - share) * angle) / std::sin(angle);
  const double to = sign * (close ? share : std::sin(share * angle) / std::sin(angle));
  for (int k = 0; k < 3; ++k) out.p[k] = a.p[k] + share * (b.p[k] - a.p[k]);
  for (int k = 0; k < 4; ++k) out.q[k] = from * a.q[k] + to * b.q[k];
  return out;
}

DemoHand::DemoHand(const redman::Pool& pool, const Options& settings, int32_t side, size_t first)
    : first_(first) {
  const std::string own = side == 0 ? "right." : "left.";
  const auto option = [&](const std::string& key) {
    const std::string value = option_of(settings, own + key);
    return value.empty() ? option_of(settings, key) : value;
  };
  const std::string hand = option("hand"), arm = option("arm");
  robot_ = hand.empty() ? kFirstRobot : find_robot(hand);
  if (arm.empty() || same_name(arm, "none")) {
    hindrance_ = "no arm carries it";
  } else {
    static std::atomic<int> made{0};
    const bool left = side == 1 && !same_name(option_of(settings, "left_model"), "right_copy");
    const std::string name = format("demo-%d", made++);
    redman::check(rdm_robot_create_mounted(&mounted_, name.c_str(), find_robot(arm), robot_,
                                           std::atof(option("mount_yaw").c_str()) * kDegree,
                                           std::atof(option("adapter").c_str()), left));
    robot_ = mounted_;
    arm_joints_ = robot_at(find_robot(arm)).num_joints;
    if (!find_base(pool, robot_, side == 0 ? "right_" : "left_", &base_))
      hindrance_ = "its arm's base has no shape";
    if (std::atof(option("arm_range").c_str()) != 0) hindrance_ = "set arm_range=0";
    if (!same_name(option("control"), "position")) hindrance_ = "set control=position";
    if (std::atof(option("action_average").c_str()) != 1) hindrance_ = "set action_average=1";
  }
  const rdm_robot robot = robot_at(robot_);
  const rdm_robot_def def = def_at(robot_);
  joint_.resize(static_cast<size_t>(robot.num_actuated));
  entries_.resize(joint_.size());
  for (int32_t i = 0; i < robot.num_joints; ++i) {
    rdm_joint_info j = RDM_INIT(rdm_joint_info);
    redman::check(rdm_robot_joint_at(robot_, i, &j));
    rows_.push_back(j);
    if (j.action < 0) continue;
    const auto k = static_cast<size_t>(j.action);
    joint_[k] = i;
    entries_[k] = {{own + j.name}, j.lower, j.upper};
  }
  for (int32_t i = 0; i < def.num_couplings; ++i) {
    couplings_.emplace_back();
    redman::check(rdm_robot_coupling_at(robot_, i, &couplings_.back()));
  }
  for (int32_t i = 0; i < def.num_fingers; ++i) {
    rdm_robot_finger f;
    redman::check(rdm_robot_finger_at(robot_, i, &f));
    fingers_.push_back(f.name);
    const std::pair<const char*, int32_t> roles[] = {
        {"lateral", f.lateral}, {"proximal", f.proximal}, {"middle", f.middle}};
    for (const auto& [role, row] : roles) {
      if (row < 0 || rows_[static_cast<size_t>(row)].action < 0) continue;
      auto& names = entries_[static_cast<size_t>(rows_[static_cast<size_t>(row)].action)].names;
      names.push_back(own + f.name + "." + role);
      if (i == 0) names.push_back(own + "first." + role);
      if (f.thumb) names.push_back(own + "thumb." + role);
    }
  }
  if (observes(pool, own + "base_position"))
    for (const char* name : {"x", "y", "z", "rx", "ry", "rz"}) entries_.push_back({{own + name}, 0, 0});
}

DemoHand::~DemoHand() {
  if (mounted_ >= 0) rdm_robot_destroy(mounted_);
}

DemoHand::DemoHand(DemoHand&& o) noexcept
    : entries_(std::move(o.entries_)),
      fingers_(std::move(o.fingers_)),
      hindrance_(std::move(o.hindrance_)),
      first_(o.first_),
      robot_(o.robot_),
      mounted_(std::exchange(o.mounted_, -1)),
      arm_joints_(o.arm_joints_),
      joint_(std::move(o.joint_)),
      rows_(std::move(o.rows_)),
      couplings_(std::move(o.couplings_)),
      base_(o.base_) {}

int32_t DemoHand::point(const std::string& name) const {
  if (same_name(name, "palm")) return -1;
  for (size_t i = 0; i < fingers_.size(); ++i)
    if (same_name(name, fingers_[i] + "_tip")) return static_cast<int32_t>(i);
  return -2;
}

void DemoHand::angles(const float* action, double* q) const {
  std::fill_n(q, rows_.size(), 0.0);
  for (size_t k = 0; k < joint_.size(); ++k) {
    const Entry& e = entries_[k];
    q[joint_[k]] = e.lower + 0.5 * (static_cast<double>(action[first_ + k]) + 1) * (e.upper - e.lower);
  }
  for (const rdm_robot_coupling& c : couplings_) q[c.link] = c.ratio * q[c.other];
}

Place DemoHand::place(const float* action, int32_t finger) const {
  std::vector<double> q(rows_.size()), tips(3 * fingers_.size());
  std::vector<rdm_pose> links(rows_.size());
  angles(action, q.data());
  rdm_pose palm;
  redman::check(rdm_robot_get_poses(robot_, q.data(), links.data(), nullptr, tips.data(), &palm));
  Place out = place_from(palm);
  if (finger >= 0) std::copy_n(&tips[3 * static_cast<size_t>(finger)], 3, out.p);
  return base_ * out;
}

bool DemoHand::reach(const Place& to, int32_t finger, float* action) const {
  std::vector<double> q(rows_.size()), tips(3 * fingers_.size());
  std::vector<rdm_pose> links(rows_.size());
  angles(action, q.data());
  rdm_pose flange, palm;
  redman::check(rdm_robot_get_poses(robot_, q.data(), links.data(), &flange, tips.data(), &palm));
  Place point = place_from(palm);
  if (finger >= 0) std::copy_n(&tips[3 * static_cast<size_t>(finger)], 3, point.p);
  const Place goal = inverse(base_) * to * inverse(point) * place_from(flange);
  rdm_pose pose;
  std::copy_n(goal.p, 3, pose.p);
  std::copy_n(goal.q, 4, pose.q);
  int32_t found = 0;
  redman::check(rdm_robot_reach(robot_, &pose, q.data(), &found));
  if (!found) return false;
  for (size_t k = 0; k < joint_.size(); ++k) {
    const Entry& e = entries_[k];
    if (joint_[k] >= arm_joints_) continue;
    const double a = (2 * q[static_cast<size_t>(joint_[k])] - e.upper - e.lower) / (e.upper - e.lower);
    action[first_ + k] = static_cast<float>(std::clamp(a, -1.0, 1.0));
  }
  return true;
}

}  // namespace tool
