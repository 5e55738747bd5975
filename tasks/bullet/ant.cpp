#include "tasks/bullet/ant.hpp"

#include <cmath>

#include "env/fields.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr AntRange kRange{40 * kDegree, 30 * kDegree, 100 * kDegree, 250};
constexpr double kMu = 0.8, kLowest = 0.26;             // of plane and ant, multiplied; m
constexpr double kStartBend = 0.5 * kPi, kNoise = 0.1;  // rad, of ankles
constexpr double kRateScale = 0.1, kEnd = 0.99;

// In [-1, 1] over the joint's range.
double relative(const World& world, int32_t joint) {
  const JointDef& j = world.scene().link(joint).joint;
  return (2 * world.q()[joint] - j.lower - j.upper) / (j.upper - j.lower);
}

}  // namespace

void Ant::add(PlanarScene& scene, const AgentDrive& drive) {
  make_walkable(scene, kBulletDt / drive.substeps, drive.substeps, kMu, kMu);
  add_ant(kRange, scene);
}

void Ant::check(const State& s) {
  check_numbers("action", s.action, kAntJoints, 1);
  check_integer("feet", s.feet, 0, (1 << kAntLegs) - 1);
}

void Ant::start(const AgentStart& at, Stream& stream, World& world, State* s) {
  double q[kAntJoints], qd[kAntJoints] = {};
  for (int32_t i = 0; i < kAntJoints; ++i)
    q[i] = (i % 2 == 0 ? 0 : kStartBend * ankle_side(i / 2)) + kNoise * stream.signed_unit();
  *s = {};
  set_ant(world, {{at.x, at.y, kAntHeight}, axis_angle({0, 0, 1}, at.yaw)}, {}, {}, q, qd);
}

void Ant::act(const float* action, const AgentDrive&, World& world, State* s) {
  for (int32_t i = 0; i < kAntJoints; ++i) s->action[i] = action[i];
  drive_ant(world, action, kRange.gear);
}

void Ant::settle(const World& world, State* s) {
  const Scene& scene = world.scene();
  s->feet = 0;
  const auto count = static_cast<int32_t>(scene.pairs.size());
  for (int32_t k = 0; k < count; ++k) {
    if (!world.pair_touched(k)) continue;
    const ShapePair& pair = scene.pairs[static_cast<size_t>(k)];
    for (const int32_t shape : {pair.a, pair.b}) {
      const SceneShape& part = scene.shapes[static_cast<size_t>(shape)];
      if (part.articulation == 0 && part.carrier == Carrier::kLink && part.index % 2 == 1)
        s->feet |= 1u << (part.index / 2);
    }
  }
}

AgentPlace Ant::look(const World& world, const State&) {
  const Motion& m = world.base(0);
  return {m.X.p.x, m.X.p.y, m.X.p.z, m.v.x, m.v.y, std::sqrt(m.v.x * m.v.x + m.v.y * m.v.y)};
}

elementary::SinCos Ant::heading(const World& world, const State&) {
  return flat_heading(world.base(0).X.q);
}

double Ant::effort(const World& world, const State& s) {
  double power = 0, square = 0;
  int ends = 0;
  for (int32_t i = 0; i < kAntJoints; ++i) {
    const double a = static_cast<double>(s.action[i]);
    power += std::fabs(a * kRateScale * world.qd()[i]);
    square += a * a;
    ends += std::fabs(relative(world, i)) > kEnd;
  }
  return -2 * power / kAntJoints - 0.1 * square / kAntJoints - 0.1 * ends + (alive(world, s) ? 1 : -1);
}

bool Ant::alive(const World& world, const State&) {
  return world.base(0).X.p.z > kLowest;
}

void Ant::write(const World& world, const State& s, float* out) {
  const Motion& m = world.base(0);
  put(m.X.p, out, 0.1);
  put(m.v, out + 3, 0.3);
  put(m.X.q, out + 6);
  put(m.w, out + 10, 0.15);
  out += 13;
  for (int32_t i = 0; i < kAntJoints; ++i) {
    *out++ = static_cast<float>(0.5 * relative(world, i));
    *out++ = static_cast<float>(0.5 * kRateScale * world.qd()[i]);
  }
  for (int32_t i = 0; i < kAntLegs; ++i) *out++ = static_cast<float>(s.feet >> i & 1);
}

}  // namespace rdm
