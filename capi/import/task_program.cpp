// Evaluates the terms in the order of the file; task_program.hpp says what each term and each curve is.
#include "task_program.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/elementary.hpp"
#include "geometry.hpp"
#include "import.hpp"

namespace rdm::import {
namespace {

#define TRY(call) \
  if (const rdm_result result = (call)) return result

double length(const double v[3]) {
  return norm(vec(v));
}
void unrotate(const double q[4], const double v[3], double out[3]) {
  put(back(turn(q)) * vec(v), out);
}

double draw(rdm_random* random, const Span& s) {
  return s.low < s.high ? rdm_random_uniform(random, s.low, s.high) : s.low;
}

// Of a place in the world, its velocity included.
rdm_result motion_of(const rdm_world* world, const Place& place, rdm_motion* out) {
  rdm_motion m{};
  m.pose.q[3] = 1;
  switch (place.on) {
    case On::kWorld:
      break;
    case On::kBody:
      TRY(rdm_world_get_body(world, place.index, &m));
      break;
    case On::kLink:
      TRY(rdm_world_get_link(world, place.index, &m));
      break;
    case On::kBase:
      TRY(rdm_world_get_base(world, place.index, &m));
      break;
    case On::kShape:
      TRY(rdm_world_get_shape(world, place.index, &m.pose));
      break;
  }
  double arm[3];
  rotate(m.pose.q, place.p, arm);
  multiply(m.pose.q, place.q, out->pose.q);
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    out->pose.p[k] = m.pose.p[k] + arm[k];
    out->v[k] = m.v[k] + m.w[i] * arm[j] - m.w[j] * arm[i];
    out->w[k] = m.w[k];
  }
  return RDM_OK;
}

struct Scene {  // what all terms of one call look at
  const Program& program;
  const State& state;
  const rdm_world* world;
  rdm_world* open;  // the same where the world may be changed; NULL in observe
  rdm_joints joints{};
};

rdm_result open_scene(Scene* s) {
  s->joints.struct_size = sizeof s->joints;
  return rdm_world_get_joints(s->world, &s->joints);
}

// *raw: the magnitude behind a cost, set only where it is more than the value (of a touch: its force).
rdm_result value_of(const Scene& s, const Term& t, double* value, double* raw) {
  rdm_motion a, b;
  const Joint* joints = s.program.joints + t.first;
  double sum = 0;
  switch (t.what) {
    case What::kConstant:
      sum = 1;
      break;
    case What::kTime:
      sum = static_cast<double>(s.state.steps) * s.joints.control_dt;
      break;
    case What::kDistance: {
      TRY(motion_of(s.world, t.a, &a));
      TRY(motion_of(s.world, t.b, &b));
      double d[3];
      for (int k = 0; k < 3; ++k) d[k] = t.axis[k] * (a.pose.p[k] - b.pose.p[k]);
      sum = length(d);
      break;
    }
    case What::kTouch: {
      int32_t pairs = 0;
      double force = 0;
      TRY(rdm_world_get_touch(s.world, t.index, &pairs, &force));
      *value = pairs > 0;
      *raw = force;
      return RDM_OK;
    }
    case What::kForce:
      TRY(rdm_world_get_touch(s.world, t.index, nullptr, &sum));
      break;
    case What::kJoint: {
      const double q = s.joints.q[joints->index];
      sum = t.from == t.to ? q : (q - t.from) / (t.to - t.from);
      break;
    }
    case What::kMoved: {
      TRY(motion_of(s.world, t.a, &a));
      double d[3];
      for (int k = 0; k < 3; ++k) d[k] = a.pose.p[k] - s.state.start[t.index][k];
      sum = length(d);
      break;
    }
    case What::kLifted:
      TRY(motion_of(s.world, t.a, &a));
      sum = a.pose.p[2] - s.state.start[t.index][2];
      break;
    case What::kHeight:
      TRY(motion_of(s.world, t.a, &a));
      sum = a.pose.p[2];
      break;
    case What::kUpright: {
      TRY(motion_of(s.world, t.a, &a));
      double axis[3];
      rotate(a.pose.q, t.axis, axis);
      sum = dot(vec(axis), vec(t.up));
      break;
    }
    case What::kSpeed:
      TRY(motion_of(s.world, t.a, &a));
      sum = length(a.v);
      break;
    case What::kSpin:
      TRY(motion_of(s.world, t.a, &a));
      sum = length(a.w);
      break;
    case What::kJointWindow:  // rad (m) beyond it, of all
      for (int32_t i = 0; i < t.count; ++i) {
        const double range = t.scaled ? joints[i].upper - joints[i].lower : 1;
        const double base = t.scaled ? joints[i].lower : 0, q = s.joints.q[joints[i].index];
        sum += std::max({0.0, base + range * t.low[0] - q, q - base - range * t.high[0]});
      }
      break;
    case What::kEffort:  // of the largest, against its bound
      for (int32_t i = 0; i < t.count; ++i)
        if (joints[i].effort > 0)
          sum = std::max(sum, std::fabs(s.joints.torque[joints[i].index]) / joints[i].effort);
      break;
    case What::kJointSpeed:
      for (int32_t i = 0; i < t.count; ++i) sum = std::max(sum, std::fabs(s.joints.qd[joints[i].index]));
      break;
    case What::kAction:
    case What::kActionRate:  // mean square
      for (int32_t i = t.first; i < t.first + t.count; ++i) {
        double x = static_cast<double>(s.state.action[i]);
        if (t.what == What::kActionRate) x -= static_cast<double>(s.state.before[i]);
        sum += x * x;
      }
      sum /= t.count;
      break;
    case What::kLeavesBox: {
      TRY(motion_of(s.world, t.a, &a));
      TRY(motion_of(s.world, t.b, &b));
      double d[3], in[3];
      for (int k = 0; k < 3; ++k) d[k] = a.pose.p[k] - b.pose.p[k];
      unrotate(b.pose.q, d, in);
      for (int k = 0; k < 3; ++k) d[k] = std::max({0.0, t.low[k] - in[k], in[k] - t.high[k]});
      sum = length(d);
      break;
    }
    case What::kOverlap:
      if (s.open) TRY(rdm_world_get_overlap(s.open, t.index, &sum));
      break;
    case What::kSensor: {
      double force[3], torque[3];
      TRY(rdm_world_get_sensor(s.world, t.index, force, torque));
      sum = length(force);
      break;
    }
    default:
      return rdm_fail(RDM_ERROR_INTERNAL, "a term has no value");
  }
  *value = *raw = sum;
  return RDM_OK;
}

double curve_of(const Term& t, double v) {
  switch (t.curve) {
    case Curve::kValue:
      return v;
    case Curve::kNear:
      return elementary::exp(-std::fabs(v) / t.width);
    case Curve::kBell:
      return elementary::exp(-(v / t.width) * (v / t.width));
    case Curve::kAbove:
      return v > t.at ? 1 : 0;
    case Curve::kBelow:
      return v < t.at ? 1 : 0;
    case Curve::kOver:
      return std::max(0.0, v - t.at);
    case Curve::kUnder:
      return std::max(0.0, t.at - v);
    case Curve::kSquare:
      return v * v;
  }
  return v;
}

bool holds(const Term& t, double v) {
  return v > t.above && v < t.below;
}

rdm_result place_bodies(const Program& p, rdm_world* world, rdm_random* random) {
  constexpr int kMostTries = 100;
  const auto put = [&](const Draw& d) -> rdm_result {
    rdm_motion m{};
    double rpy[3], turn[4];
    for (int k = 0; k < 3; ++k) m.pose.p[k] = draw(random, d.p[k]);
    for (int k = 0; k < 3; ++k) rpy[k] = draw(random, d.turn[k]);
    for (int k = 0; k < 3; ++k) m.v[k] = draw(random, d.v[k]);
    for (int k = 0; k < 3; ++k) m.w[k] = draw(random, d.w[k]);
    TRY(turn_of(rpy, turn));
    multiply(turn, d.q, m.pose.q);
    return rdm_world_set_body(world, d.body, &m);
  };
  for (int32_t i = 0; i < p.num_draws; ++i) {
    const Draw& d = p.draws[i];
    TRY(put(d));
    // What stands in something else is drawn again; the last try stays.
    for (int k = 1; d.apart && k < kMostTries; ++k) {
      double depth = 0;
      TRY(rdm_world_get_overlap(world, d.body, &depth));
      if (depth <= 0) break;
      TRY(put(d));
    }
  }
  return RDM_OK;
}

rdm_result place_robots(const Program& p, rdm_world* world, State* s, rdm_random* random) {
  double q[kMostTaskJoints];
  for (int32_t r = 0; r < p.num_players; ++r) {
    const Player& player = p.players[r];
    for (int32_t i = 0; i < player.joints; ++i) {
      const int32_t j = player.joint + i;
      const double angle = draw(random, p.start[j]) + draw(random, p.noise[j]);
      q[j] = std::clamp(angle, p.lower[j], p.upper[j]);
    }
    TRY(rdm_world_set_joints(world, player.robot, q + player.joint, nullptr,
                             static_cast<size_t>(player.joints)));
    for (int32_t i = 0; i < player.joints; ++i)
      if (const double rest = p.rest[player.joint + i]; !std::isnan(rest))
        TRY(rdm_world_set_targets(world, player.joint + i, &rest, 1));
    for (int32_t k = player.command; k < player.command + player.commands; ++k)
      s->command[k] = command_at(p.commands[k], q[p.commands[k].joint]);
    if (player.placed) {
      rdm_motion m{};
      double rpy[3], turn[4];
      for (int k = 0; k < 3; ++k) m.pose.p[k] = draw(random, player.p[k]);
      for (int k = 0; k < 3; ++k) rpy[k] = draw(random, player.turn[k]);
      TRY(turn_of(rpy, turn));
      multiply(turn, player.q, m.pose.q);
      TRY(rdm_world_set_base(world, player.robot, &m));
    }
    if (player.compensated) {
      TRY(rdm_world_get_gravity(world, player.robot, q, static_cast<size_t>(player.joints)));
      TRY(rdm_world_set_feedforward(world, player.joint, q, static_cast<size_t>(player.joints)));
    }
  }
  return RDM_OK;
}

rdm_result draw_factors(const Program& p, rdm_world* world, rdm_random* random) {
  double last = 1;
  for (int32_t i = 0; i < p.num_factors; ++i) {
    const Factor& f = p.factors[i];
    if (!f.with_last) last = draw(random, f.factor);
    const rdm_factor factor = {f.what, f.index, f.other, 0, last};
    TRY(rdm_world_set_factors(world, &factor, 1));
  }
  return RDM_OK;
}

}  // namespace

void multiply(const double p[4], const double q[4], double out[4]) {
  put(turn(p) * turn(q), out);
}

void rotate(const double q[4], const double v[3], double out[3]) {
  put(turn(q) * vec(v), out);
}

rdm_result turn_of(const double rpy[3], double q[4]) {
  double out[4] = {0, 0, 0, 1};
  for (int k = 0; k < 3; ++k) {
    const double axis[3] = {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
    double one[4];
    if (rpy[k] == 0) continue;
    TRY(rdm_rotation(axis, rpy[k], one));
    multiply(one, out, out);
  }
  std::copy_n(out, 4, q);
  return RDM_OK;
}

double command_at(const Command& c, double angle) {
  if (c.knots == 0) return std::clamp(2 * (angle - c.lower) / (c.upper - c.lower) - 1, -1.0, 1.0);
  for (int32_t k = 0; k + 1 < c.knots; ++k) {
    const double y0 = c.y[k], y1 = c.y[k + 1];
    if (y0 != y1 && std::min(y0, y1) <= angle && angle <= std::max(y0, y1))
      return c.x[k] + (c.x[k + 1] - c.x[k]) * (angle - y0) / (y1 - y0);
  }
  int32_t nearest = 0;
  for (int32_t k = 1; k < c.knots; ++k)
    if (std::fabs(c.y[k] - angle) < std::fabs(c.y[nearest] - angle)) nearest = k;
  return c.x[nearest];
}

rdm_result program_reset(void*, const void* instance, rdm_world* world, void* state, rdm_random* random) {
  const Program& p = *static_cast<const Program*>(instance);
  State& s = *static_cast<State*>(state);
  TRY(draw_factors(p, world, random));
  TRY(place_robots(p, world, &s, random));
  TRY(place_bodies(p, world, random));
  rdm_motion m;
  for (int32_t i = 0; i < p.num_starts; ++i) {
    TRY(motion_of(world, p.starts[i], &m));
    std::copy_n(m.pose.p, 3, s.start[i]);
  }
  Scene scene{p, s, world, world};
  TRY(open_scene(&scene));
  for (int32_t i = 0; i < p.views + p.rewards + p.costs + p.successes + p.falls; ++i) {
    const Term& t = p.terms[i];
    if (t.last < 0) continue;
    double value = 0, raw = 0;
    TRY(value_of(scene, t, &value, &raw));
    s.last[t.last] = curve_of(t, value);
  }
  return RDM_OK;
}

rdm_result program_control(void*, const void* instance, rdm_world* world, void* state, const float* action) {
  const Program& p = *static_cast<const Program*>(instance);
  State& s = *static_cast<State*>(state);
  std::copy_n(s.action, p.num_actions, s.before);
  std::copy_n(action, p.num_actions, s.action);
  for (int32_t r = 0; r < p.num_players; ++r) {
    const Player& player = p.players[r];
    double* command = s.command + player.command;
    for (int32_t k = 0; player.control != Control::kNone && k < player.commands; ++k) {
      const Command& c = p.commands[player.command + k];
      if (c.action < 0) continue;
      const auto a = static_cast<double>(action[player.action + c.action]);
      command[k] = player.control == Control::kPosition ? player.keep * command[k] + (1 - player.keep) * a
                                                        : std::clamp(command[k] + c.step * a, -1.0, 1.0);
    }
    if (player.control != Control::kNone)
      TRY(rdm_world_set_commands(world, player.robot, command, static_cast<size_t>(player.commands)));
    if (player.compensated) {
      double efforts[kMostTaskJoints];
      TRY(rdm_world_get_gravity(world, player.robot, efforts, static_cast<size_t>(player.joints)));
      TRY(rdm_world_set_feedforward(world, player.joint, efforts, static_cast<size_t>(player.joints)));
    }
    if (player.push_action >= 0) {
      double push[2][3];
      for (int k = 0; k < 6; ++k)
        push[k / 3][k % 3] = player.push[k / 3] * static_cast<double>(action[player.push_action + k]);
      TRY(rdm_world_push_base(world, player.robot, push[0], push[1]));
    }
  }
  return RDM_OK;
}

rdm_result program_judge(void*, const void* instance, rdm_world* world, void* state, int32_t step,
                         rdm_verdict* out) {
  const Program& p = *static_cast<const Program*>(instance);
  State& s = *static_cast<State*>(state);
  s.steps = step;
  Scene scene{p, s, world, world};
  TRY(open_scene(&scene));
  const Term* t = p.terms;
  const auto term = [&](double* value, double* raw) -> rdm_result {
    TRY(value_of(scene, *t, value, raw));
    *value = curve_of(*t, *value);
    if (t->last >= 0) {
      const double now = *value;
      *value = now - s.last[t->last];
      s.last[t->last] = now;
    }
    return RDM_OK;
  };
  double value = 0, raw = 0;
  t += p.views;
  for (int32_t i = 0; i < p.rewards; ++i, ++t) {
    TRY(term(&value, &raw));
    out->reward += t->weight * value;
  }
  for (int32_t i = 0; i < p.costs; ++i, ++t) {
    TRY(term(&value, &raw));
    if (!holds(*t, value)) continue;
    if (t->what != What::kTouch)
      raw = std::isfinite(t->above) ? value - t->above : std::isfinite(t->below) ? t->below - value : value;
    double& cost = out->cost[t->column];
    out->cost_raw[t->column] += raw;
    cost = t->magnitude ? cost + t->weight * raw : std::max(cost, t->weight);
  }
  bool good = p.successes > 0, fallen = false;
  for (int32_t i = 0; i < p.successes; ++i, ++t) {
    TRY(term(&value, &raw));
    good = good && holds(*t, value);
  }
  for (int32_t i = 0; i < p.falls; ++i, ++t) {
    TRY(term(&value, &raw));
    fallen = fallen || holds(*t, value);
  }
  const int32_t held = s.held;
  s.held = good ? std::min(held + 1, p.hold) : 0;
  if (fallen) {
    out->reward -= p.penalty;
    out->terminated = 1;
  } else if (good && s.held == p.hold) {
    out->success = 1;
    if (held < p.hold) out->reward += p.bonus;
    out->terminated = p.ends;
  }
  return RDM_OK;
}

rdm_result program_observe(void*, const void* instance, const rdm_world* world, const void* state,
                           float* obs) {
  const Program& p = *static_cast<const Program*>(instance);
  const State& s = *static_cast<const State*>(state);
  Scene scene{p, s, world, nullptr};
  TRY(open_scene(&scene));
  const rdm_joints& joints = scene.joints;
  for (int32_t i = 0; i < p.views; ++i) {
    const Term& t = p.terms[i];
    const Joint* listed = p.joints + t.first;
    const auto put = [&](double x) { *obs++ = static_cast<float>(t.weight * x); };
    rdm_motion a, b;
    double v[3];
    switch (t.what) {
      case What::kJoints:
        for (int32_t k = 0; k < t.count; ++k) {
          const Joint& j = listed[k];
          const double q = joints.q[j.index];
          put(t.scaled ? 2 * (q - j.lower) / (j.upper - j.lower) - 1 : q);
        }
        break;
      case What::kRates:
        for (int32_t k = 0; k < t.count; ++k) put(joints.qd[listed[k].index]);
        break;
      case What::kTargets:  // off where the joint is
        for (int32_t k = 0; k < t.count; ++k) put(joints.target[listed[k].index] - joints.q[listed[k].index]);
        break;
      case What::kTorques:
        for (int32_t k = 0; k < t.count; ++k)
          put(joints.torque[listed[k].index] / (t.scaled && listed[k].effort > 0 ? listed[k].effort : 1));
        break;
      case What::kPosition:
      case What::kVelocity:
      case What::kTurning: {
        TRY(motion_of(world, t.a, &a));
        TRY(motion_of(world, t.b, &b));
        const double* x = t.what == What::kPosition ? a.pose.p : t.what == What::kVelocity ? a.v : a.w;
        const double* y = t.what == What::kPosition ? b.pose.p : t.what == What::kVelocity ? b.v : b.w;
        double d[3];
        for (int k = 0; k < 3; ++k) d[k] = x[k] - y[k];
        unrotate(b.pose.q, d, v);
        for (const double c : v) put(c);
        break;
      }
      case What::kRotation: {
        TRY(motion_of(world, t.a, &a));
        TRY(motion_of(world, t.b, &b));
        const double back[4] = {-b.pose.q[0], -b.pose.q[1], -b.pose.q[2], b.pose.q[3]};
        double q[4];
        multiply(back, a.pose.q, q);
        const double sign = q[3] < 0 ? -1 : 1;  // one of the two that are the same turn
        for (const double c : q) put(sign * c);
        break;
      }
      case What::kTip: {
        double torque[3];
        TRY(rdm_world_get_sensor(world, t.index, v, torque));
        for (const double c : v) put(c);
        break;
      }
      case What::kActions:
        for (int32_t k = t.first; k < t.first + t.count; ++k) put(static_cast<double>(s.action[k]));
        break;
      case What::kWhere:
        for (const double c : s.start[t.index]) put(c);
        break;
      default: {
        double value = 0, raw = 0;
        TRY(value_of(scene, t, &value, &raw));
        put(curve_of(t, value));
      }
    }
  }
  return RDM_OK;
}

rdm_result program_check_state(void*, const void* instance, const void* state) {
  const Program& p = *static_cast<const Program*>(instance);
  const State& s = *static_cast<const State*>(state);
  if (s.steps < 0 || s.held < 0 || s.held > p.hold)
    return rdm_fail(RDM_ERROR_FORMAT, "a count is out of range");
  constexpr double kMost = 1e12;
  const auto good = [](double x) { return std::fabs(x) <= kMost; };
  bool all = true;
  for (int32_t i = 0; i < kMostTaskActions; ++i)
    all = all && good(static_cast<double>(s.action[i])) && good(static_cast<double>(s.before[i]));
  for (const double x : s.command) all = all && std::fabs(x) <= 1;
  for (const auto& start : s.start)
    for (const double x : start) all = all && good(x);
  for (const double x : s.last) all = all && good(x);
  return all ? RDM_OK : rdm_fail(RDM_ERROR_FORMAT, "a number is not finite, or larger than a world allows");
}

}  // namespace rdm::import
