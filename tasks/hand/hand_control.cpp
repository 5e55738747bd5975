#include "tasks/hand/hand_control.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "env/options/simulation.hpp"
#include "physics/gravity_torques.hpp"
#include "robot/kinematics.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr int32_t kContactsEach = 4;      // that a shape of another robot may add
constexpr double kSourceStep = 1.0 / 60;  // s, of the source's scales

constexpr auto kRows = option_rows<HandOptions>(
    row<&HandOptions::action_average>(number_option(
        "action_average", 1, 0.01, 1,
        "weight of the newest action in the moving average that drives follow; 1: no averaging")),
    row<&HandOptions::sensor, true, false>(
        text_option("sensor", "contact", "contact|none",
                    "forces of fingertips in the observation: contact forces, or 0")),
    row<&HandOptions::control, HandDrive::kPosition, HandDrive::kVelocity, HandDrive::kTorque,
        HandDrive::kPalm>(basic(
        text_option("control", "position", "position|velocity|torque|ik",
                    "a joint's action entry: its target, its target's velocity or a share of its effort; "
                    "ik: arms by their palms"))),
    row<&HandOptions::ik_speed>(number_option(
        "ik_speed", 0.5, 0.001, 10, "speed of a palm by an action entry of 1 with control=ik, m/s")),
    row<&HandOptions::ik_spin>(number_option(
        "ik_spin", 2, 0.001, 100, "angular speed of a palm by an action entry of 1 with control=ik, rad/s")),
    row<&HandOptions::arm_range>(number_option(
        "arm_range", 0.3, 0, 10,
        "angle from the start that an entry of 1 gives to an arm's joint, rad; 0: its whole range")),
    row<&HandOptions::arm_noise>(number_option(
        "arm_noise", 0, 0, 1, "half width of the uniform noise on an arm's joint angles at a reset, rad")),
    row<&HandOptions::arm_gravity, ArmGravity::kCompensated, ArmGravity::kFree, ArmGravity::kOff>(
        text_option("arm_gravity", "compensated", "compensated|free|off",
                    "weight of arms: compensated (held by the drives), free (not held), off (no gravity, as "
                    "in the paper)")),
    row<&HandOptions::friction_object>(levelled(basic(
        number_option("friction.hand_object", 1, 0, 10, "friction coefficient between hands and object")))),
    row<&HandOptions::friction_self>(drawable(number_option(
        "friction.hand_self", 0, 0, 10, "friction coefficient between parts of the same hand"))),
    row<&HandOptions::friction_ground>(drawable(
        number_option("friction.hand_ground", 1, 0, 10, "friction coefficient between hand and ground"))));

struct PairOptions {
  bool hand_contact;
  DrawnOption friction;
};
constexpr auto kPairRows = option_rows<PairOptions>(
    row<&PairOptions::hand_contact>(
        flag_option("hand_contact", true, "the two hands collide with each other")),
    row<&PairOptions::friction>(drawable(
        number_option("friction.hand_hand", 0, 0, 10, "friction coefficient between the two hands"))));

constexpr auto kFlyingRows = option_rows<FlyingOptions>(
    row<&FlyingOptions::paper_order, true, false>(
        legacy(text_option("action_order", "paper", "paper|legacy",
                           "order of a hand's action entries: joints, force, torque (paper), or force, "
                           "torque, joints (legacy)"))),
    row<&FlyingOptions::base_damping>(drawable(
        number_option("base_damping", 100, 0, 1e4, "damping of the motion of a flying hand's links, 1/s"))),
    row<&FlyingOptions::signed_angles, false, true>(
        legacy(text_option("base_angles", "positive", "positive|signed",
                           "angles of a base as observed: positive: in [0, 2 pi), cut at 5 as all entries; "
                           "signed: in [-pi, pi]"))),
    row<&FlyingOptions::base_speed>(
        number_option("base_speed", 2, 0.01, 100, "largest speed of a flying hand's base, m/s")),
    row<&FlyingOptions::base_spin>(
        number_option("base_spin", 10, 0.1, 1000, "largest angular speed of a flying hand's base, rad/s")),
    row<&FlyingOptions::base_reach>(
        number_option("base_reach", 0, 0, 10, "largest distance of a base from its start, m; 0: no bound")),
    row<&FlyingOptions::transition_scale>(number_option(
        "transition_scale", 0, 0, 10, "force by a base's action entry of 1, in units of 1667 N")),
    row<&FlyingOptions::orientation_scale>(number_option(
        "orientation_scale", 0, 0, 10, "torque by a base's action entry of 1, in units of 16.7 N m")));

Vec3 bounded(const Vec3& v, double most) {
  const double length = norm(v);
  return length > most ? (most / length) * v : v;
}

}  // namespace

void add_hand_control_options(const HandControlConfig& config, OptionTable& table, int32_t contacts_max) {
  table.add(kRows.with<&HandOptions::friction_object>(config.friction));
  if (config.count > 1) {
    table.add(kPairRows);
    add_left_hand_options(table);
  }
  if (config.flying) {
    table.add(kFlyingRows.with<&FlyingOptions::transition_scale>(config.transition_scale)
                  .with<&FlyingOptions::orientation_scale>(config.orientation_scale));
  }
  add_level_options(table);
  add_sim_options(table);
  add_hand_options(table);
  const int32_t shapes = add_hand_choice_options(config, table);
  table.set_default("contacts_max", contacts_max + kContactsEach * shapes);
}

void set_friction(SceneDef* scene, int32_t a, int32_t b, double mu) {
  scene->friction[a][b].mu = scene->friction[b][a].mu = mu;
}

void set_friction(HandScene* scene, int32_t a, int32_t b, const DrawnOption& mu) {
  set_friction(scene, a, b, mu.middle);
  scene->draws.add(mu, Drawn::kFriction, a, b);
}

namespace {

// What option control and the weight of an arm ask of the drives of hand i.
void set_drives(const HandOptions& o, const ChosenHand& hand, ArticulationDef* def, SceneDef* scene) {
  const Robot& robot = hand.robot();
  if (o.control == HandDrive::kTorque) {  // drives only damp
    scene->feedforward = true;
    for (int32_t k = 0; k < robot.num_actuated(); ++k)
      def->links[static_cast<size_t>(robot.actuated(k))].joint.kp = 0;
  }
  if (!hand.armed || o.arm_gravity == ArmGravity::kOff) return;
  def->gravity = true;
  scene->feedforward = scene->feedforward || o.arm_gravity == ArmGravity::kCompensated;
  // the hand, and the link that its root is one body with
  for (int32_t i = 0; i < robot.links.count; ++i)
    def->links[static_cast<size_t>(i)].weightless = i >= robot.arm_links || i == robot.flange;
}

}  // namespace

HandScene make_hand_scene(const HandControlConfig& config, const Options& o, int32_t num_materials) {
  const HandOptions options = kRows.read(o);
  HandScene s;
  s.gravity = gravity_from(o);
  s.draws.add(drawn_gravity(o), Drawn::kGravity);
  s.solver = solver_from(o);
  int32_t links = 0;
  for (int32_t i = 0; i < config.count; ++i) {
    s.hands[i] = choose_hand(config, o, i);
    ArticulationDef hand = make_hand(s.hands[i], o, i, links, i == 0 ? kRightHand : kLeftHand, &s.draws);
    links += s.hands[i].robot().links.count;
    set_drives(options, s.hands[i], &hand, &s);
    if (config.flying && !s.hands[i].armed) {
      hand.free_base = true;
      const DrawnOption damping = kFlyingRows.read(o).base_damping;
      hand.base_damping = damping.middle;
      s.draws.add(damping, Drawn::kBaseDamping, i);
    }
    s.articulations.push_back(hand);
  }
  ShapeDef ground;
  ground.name = "ground";
  ground.kind = ShapeKind::kPlane;
  ground.material = kGround;
  ground.color[0] = 150, ground.color[1] = 158, ground.color[2] = 165;
  s.statics.push_back(ground);
  s.num_materials = num_materials;
  for (const int32_t hand : {kRightHand, kLeftHand}) {
    set_friction(&s, hand, hand, options.friction_self);
    set_friction(&s, hand, kObject, options.friction_object);
    set_friction(&s, hand, kGround, options.friction_ground);
  }
  if (config.count > 1) {
    const PairOptions pair = kPairRows.read(o);
    s.articulations_touch = pair.hand_contact;
    set_friction(&s, kRightHand, kLeftHand, pair.friction);
  }
  return s;
}

HandControl::HandControl(const HandControlConfig& config, const Options& o, const Scene& scene,
                         const HandScene& made)
    : count_(config.count), options_(kRows.read(o)), draws_(&made.draws) {
  const ChosenHand* hands = made.hands;
  if (config.flying) {
    base_ = kFlyingRows.read(o);
    force_ = kSourceStep * 1e5 * base_.transition_scale;
    torque_ = kSourceStep * 1e3 * base_.orientation_scale;
  }
  // in the order, so that a policy is refused where the same entries mean something else
  const char* const by = options_.control == HandDrive::kVelocity ? " by velocity"
                         : options_.control == HandDrive::kTorque ? " by torque"
                                                                  : "";
  size_t at = 0;
  bool any_led = false;
  for (int32_t i = 0; i < count_; ++i) {
    const Robot& robot = hands[i].robot();
    Hand& h = hands_[i] = find_hand(robot, scene, i);
    bases_[i] = hands[i].X_WB.p;
    flying_[i] = config.flying && !hands[i].armed;
    compensated_[i] = hands[i].armed && options_.arm_gravity == ArmGravity::kCompensated;
    const Table<double>& start = config.folded && robot.poses.folded.count ? robot.poses.folded : robot.home;
    std::copy_n(start.rows, start.count, start_[i].q);
    std::copy_n(h.lower, h.num_joints, start_[i].low);
    std::copy_n(h.upper, h.num_joints, start_[i].high);
    if (const double range = options_.arm_range; range > 0)
      for (int32_t k = 0; k < h.arm_actions; ++k) {
        const double middle = start_[i].q[h.joint(k)];
        h.act_lower[k] = std::max(h.act_lower[k], middle - range);
        h.act_upper[k] = std::min(h.act_upper[k], middle + range);
      }
    h.led = options_.control == HandDrive::kPalm && h.arm_actions > 0;
    q_WR_[i] = (hands[i].X_WB * robot.X_BR).q;
    first_entry_[i + 1] = first_entry_[i] + h.num_entries() + (flying_[i] ? kBaseActions : 0);
    first_command_[i + 1] = first_command_[i] + h.num_actions;
    const char* format = !flying_[i]         ? "%s%s %sjoints%s"
                         : base_.paper_order ? "%s%s %sjoints%s, force, torque"
                                             : "%s%s %sforce, torque, joints%s";
    at += static_cast<size_t>(std::snprintf(order_ + at, sizeof order_ - at, format, i > 0 ? ", " : "",
                                            kSideNames[i],
                                            h.led            ? "palm velocity, palm angular velocity, "
                                            : hands[i].armed ? "arm, "
                                                             : "",
                                            by));
    any_led = any_led || h.led;
    if (!hands[i].own || hands[i].armed)  // alike in numbers, but another robot
      at += static_cast<size_t>(std::snprintf(order_ + at, sizeof order_ - at, " of %s", robot.name));
  }
  if (options_.control == HandDrive::kPalm && !any_led)
    fail(Code::kUnsupported, "option control=ik moves hands by their arms: no hand is on one; set arm=NAME");
}

void HandControl::begin_at(int32_t i, int32_t joint, double q, double low, double high) {
  start_[i].q[joint] = q;
  start_[i].low[joint] = low;
  start_[i].high[joint] = high;
}

size_t HandControl::state_bytes() const {
  return static_cast<size_t>(first_command_[count_]) * sizeof(double) +
         static_cast<size_t>(action_dim()) * sizeof(float);
}

HandControlState HandControl::state(void* bytes) const {
  auto* command = static_cast<double*>(bytes);
  return {command, reinterpret_cast<float*>(command + first_command_[count_])};
}

const float* HandControl::action(const void* bytes) const {
  return reinterpret_cast<const float*>(static_cast<const double*>(bytes) + first_command_[count_]);
}

void HandControl::check_state(const void* bytes) const {
  constexpr double kOne = 1 + 1e-3;  // joints are kept as floats, and a range may be narrow
  const auto commands = static_cast<size_t>(first_command_[count_]);
  check_numbers("command", static_cast<const double*>(bytes), commands, kOne);
  check_numbers("action", action(bytes), static_cast<size_t>(action_dim()), 1);
}

void HandControl::reset(double noise, bool literal, World& world, const HandControlState& state,
                        Stream& stream) const {
  draws_->apply(world, stream);
  JointNoise draw{noise, literal, options_.arm_noise};
  for (int32_t i = 0; i < count_; ++i) {
    draw.start[i] = start_[i].q;
    draw.low[i] = start_[i].low;
    draw.high[i] = start_[i].high;
  }
  draw_joints(draw, hands_, count_, world, stream);
  for (int32_t i = 0; i < count_; ++i)
    for (int32_t k = 0; k < hands_[i].num_actions; ++k) {
      const Hand& h = hands_[i];
      state.command[first_command_[i] + k] = h.command(k, world.q()[h.actuated[k]]);
    }
}

// The arm's commands after the entries of its palm: the commanded palm goes on from where it was commanded to.
void HandControl::lead_arm(const World& world, int32_t i, const float* a, double* command) const {
  const Hand& h = hands_[i];
  const double dt = world.scene().control_dt();
  const auto in_root = [&](const float* entry, double most) {
    return rotate(conjugate(q_WR_[i]),
                  (most * dt) * Vec3{static_cast<double>(entry[0]), static_cast<double>(entry[1]),
                                     static_cast<double>(entry[2])});
  };
  double q[kMaxHandJoints];
  int32_t joints[kMaxHandJoints];
  std::copy_n(world.q() + h.first, h.num_joints, q);
  for (int32_t k = 0; k < h.num_actions; ++k) {
    joints[k] = h.joint(k);
    q[joints[k]] = h.angle(k, command[k]);
  }
  const PalmJoints arm = {joints, h.act_lower, h.act_upper, h.rate, h.arm_actions};
  move_palm(*h.robot, arm, in_root(a, options_.ik_speed), in_root(a + 3, options_.ik_spin), q);
  for (int32_t k = 0; k < h.arm_actions; ++k) command[k] = std::clamp(h.command(k, q[joints[k]]), -1.0, 1.0);
}

// The commands of hand i after its action entries.
void HandControl::move_commands(const World& world, int32_t i, const float* a, double* command) const {
  const Hand& h = hands_[i];
  if (options_.control == HandDrive::kPosition || options_.control == HandDrive::kPalm) {
    for (int32_t k = h.led ? h.arm_actions : 0; k < h.num_actions; ++k)
      command[k] = options_.action_average * static_cast<double>(a[h.entry(k)]) +
                   (1 - options_.action_average) * command[k];
    if (h.led) lead_arm(world, i, a, command);
    return;
  }
  const double dt = world.scene().control_dt();
  for (int32_t k = 0; k < h.num_actions; ++k) {
    if (options_.control == HandDrive::kTorque) {
      command[k] = std::clamp(h.command(k, world.q()[h.actuated[k]]), -1.0, 1.0);
      continue;
    }
    // a command of 2 is the whole range; a joint without a bound goes over it in a second
    const double range = h.act_upper[k] - h.act_lower[k];
    const double step = h.robot->links[h.joint(k)].velocity > 0 ? 2 * h.rate[k] / range : 2 * dt;
    command[k] =
        std::clamp(command[k] + options_.action_average * step * static_cast<double>(a[k]), -1.0, 1.0);
  }
}

void HandControl::feed_forward(World& world, int32_t i, const float* a) const {
  const Hand& h = hands_[i];
  double torque[kMaxHandJoints] = {};
  if (compensated_[i]) gravity_torques(world, h.articulation, torque);
  if (options_.control == HandDrive::kTorque)
    for (int32_t k = 0; k < h.num_actions; ++k)
      if (const double effort = h.effort[h.joint(k)]; std::isfinite(effort))
        torque[h.joint(k)] += effort * static_cast<double>(a[k]);
  std::copy_n(torque, h.num_joints, world.feedforward() + h.first);
}

void HandControl::control(World& world, const HandControlState& state, const float* action) const {
  std::copy_n(action, action_dim(), state.action);
  for (int32_t i = 0; i < count_; ++i) {
    double* command = state.command + first_command_[i];
    move_commands(world, i, action + joint_entries(i), command);
    command_hand(hands_[i], command, world);
    if (world.feedforward()) feed_forward(world, i, action + joint_entries(i));
  }
  if (flying()) push_bases(world, action);
}

// Nothing but a blow makes a base as fast as its bound: force against damping ends far below.
void HandControl::slow_base(World& world, int32_t articulation) const {
  Motion m = world.base(articulation);
  if (norm(m.v) <= base_.base_speed && norm(m.w) <= base_.base_spin) return;
  m.v = bounded(m.v, base_.base_speed);
  m.w = bounded(m.w, base_.base_spin);
  world.set_base(articulation, m);
}

void HandControl::push_bases(World& world, const float* action) const {
  for (int32_t i = 0; i < count_; ++i) {
    if (!flying_[i]) continue;
    const int32_t articulation = hands_[i].articulation;
    slow_base(world, articulation);
    const float* a = action + base_entries(i);
    Vec3 force, torque;
    for (int k = 0; k < 3; ++k) {
      force[k] = force_ * static_cast<double>(a[k]);
      torque[k] = torque_ * static_cast<double>(a[3 + k]);
    }
    const Vec3 out = world.base(articulation).X.p - bases_[i];
    if (base_.base_reach > 0 && dot(out, out) >= base_.base_reach * base_.base_reach) {
      const double outward = dot(force, out);
      if (outward > 0) force -= (outward / dot(out, out)) * out;
    }
    world.push_base(articulation, force, torque);
  }
}

double HandControl::base_displacement(const World& world) const {
  double most = 0;
  for (int32_t i = 0; i < count_; ++i)
    if (flying_[i]) most = std::max(most, norm(world.base(hands_[i].articulation).X.p - bases_[i]));
  return most;
}

HandView HandControl::view(const World& world, const float* action, int32_t i) const {
  return {world,
          hands_[i],
          action + first_entry_[i],
          options_.sensor,
          flying_[i] ? &world.base(hands_[i].articulation) : nullptr,
          base_.signed_angles};
}

void HandControl::add_fields(FieldTable& table) const {
  for (int32_t i = 0; i < count_; ++i) add_hand_fields(hands_[i], table, kSideNames[i], flying_[i]);
}

float* HandControl::write(const World& world, const float* action, float* out) const {
  for (int32_t i = 0; i < count_; ++i) out = write_hand(view(world, action, i), out);
  return out;
}

void HandControl::hold(float* action) const {
  std::fill_n(action, action_dim(), 0.0f);
  if (options_.control == HandDrive::kVelocity || options_.control == HandDrive::kTorque) return;
  for (int32_t i = 0; i < count_; ++i)
    for (int32_t k = hands_[i].led ? hands_[i].arm_actions : 0; k < hands_[i].num_actions; ++k) {
      const Hand& h = hands_[i];
      const double q = std::clamp(start_[i].q[h.joint(k)], h.act_lower[k], h.act_upper[k]);
      action[entry(i, k)] = static_cast<float>(h.command(k, q));
    }
}

void HandControl::hold_arms(float* action) const {
  hold(action);
  for (int32_t i = 0; i < count_; ++i)
    std::fill_n(action + joint_entries(i) + hands_[i].arm_entries(),
                hands_[i].num_entries() - hands_[i].arm_entries(), 0.0f);
}

}  // namespace rdm
