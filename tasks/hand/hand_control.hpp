// The hands of a task as one: their part of options and scene, how actions become drive targets and wrenches
// on flying bases, how they are reset, and their entries of the observation.
//
// An action entry a in [-1, 1] of joint i joins a moving average, c_i += average (a - c_i), which is the
// command; the drive's target is lower + (c_i + 1)/2 (upper - lower), reached no faster than the robot's
// table says. Option control has two other meanings: velocity, where a moves the command at up to the joint's
// velocity, and torque, where it is a share of the joint's effort and drives only damp. An arm's joints come
// before the hand's; their range is arm_range about the start. With control ik six entries stand instead of
// them, which move the palm's frame in world axes: its velocity, ik_speed a, and angular velocity, ik_spin a;
// the arm's commands follow by damped least squares (robot/kinematics.hpp) from where they are, so that
// nothing drifts while the entries are 0. The six base entries of a flying hand are a
// force and a torque in world axes, a * scale; a base flies through a medium: its speed ends at force /
// (base_damping m).
#pragma once
#include "base/rng.hpp"
#include "env/dynamics_draw.hpp"
#include "env/option_table.hpp"
#include "tasks/hand/hand_observation.hpp"
#include "tasks/hand/hands.hpp"

namespace rdm {

inline constexpr int kMaxHandActions = kMaxHands * (kMaxHandJoints + kBaseActions);

// What an action entry of a joint is: its target, the target's velocity, or a share of its effort; kPalm: the
// target, but arms are moved by their palms.
enum class HandDrive { kPosition, kVelocity, kTorque, kPalm };
// Of arms; hands feel none.
enum class ArmGravity { kCompensated, kFree, kOff };

// Options of all hands, and of those that fly.
struct HandOptions {
  double action_average;
  bool sensor;  // fingertips feel contact forces
  HandDrive control;
  double arm_range, arm_noise;  // rad
  double ik_speed, ik_spin;     // m/s, rad/s of a palm by an entry of 1
  ArmGravity arm_gravity;
  DrawnOption friction_object, friction_self, friction_ground;
};
struct FlyingOptions {
  bool paper_order = true;  // of a hand's entries: joints, force, torque
  DrawnOption base_damping;
  bool signed_angles = false;
  double base_speed, base_spin, base_reach;    // m/s, rad/s, m
  double transition_scale, orientation_scale;  // as of HandControlConfig
};

// What one task sets.
struct HandControlConfig {
  const Robot* robot = &kShadowHand;  // unless option hand says otherwise
  int32_t count = 2;                  // right, left
  Pose bases[kMaxHands];              // of the mounts, at the start
  bool flying = false;                // bases are free and have six action entries each
  // Of the mounts where arms carry the hands; null: as `bases`. A flying hand may begin where no arm reaches.
  const Pose* armed_bases = nullptr;   // [count]
  const HandDefault* sides = nullptr;  // [count] null: none
  bool facing = false;                 // fingertips towards each other: hands with longer fingers stand back
  // Force of an action entry of 1, in 1e5/60 N, and torque, in 1e3/60 N m: the paper's code applies 1e5 and
  // 1e3 times these, times its step of 1/60 s.
  double transition_scale = 0, orientation_scale = 0;
  bool things_stand = false;  // bodies begin where the scene has them: hands keep out of them
  bool folded = false;        // the thumb across the palm at the start, else all joints at 0
  double friction = 1;        // hand and object, option friction.hand_object
};

// contacts_max: the default with the task's own robots; others may need more.
void add_hand_control_options(const HandControlConfig& config, OptionTable& table, int32_t contacts_max = 36);
// A scene, and the robots that its first articulations are.
struct HandScene : SceneDef {
  ChosenHand hands[kMaxHands];
  DynamicsDraws draws;
};
// The hands and the ground, with gravity, solver, `num_materials` materials and their frictions.
HandScene make_hand_scene(const HandControlConfig& config, const Options& options,
                          int32_t num_materials = kOwnMaterial);
// One entry of the friction table and its mirror image.
void set_friction(SceneDef* scene, int32_t a, int32_t b, double mu);
// By an option, whose range is drawn.
void set_friction(HandScene* scene, int32_t a, int32_t b, const DrawnOption& mu);

// One world's part: places in its task's state.
struct HandControlState {
  double* command;  // of the joints of all hands, hand by hand, in [-1, 1], after averaging
  float* action;    // [action_dim] as given
};

class HandControl {
 public:
  // `made`, of which `scene` is made, must outlive it.
  HandControl(const HandControlConfig& config, const Options& options, const Scene& scene,
              const HandScene& made);

  int32_t count() const { return count_; }
  const Hand& hand(int32_t i) const { return hands_[i]; }
  bool flying(int32_t i) const { return flying_[i]; }
  bool flying() const { return flying_[0] || flying_[1]; }
  int32_t action_dim() const { return first_entry_[count_]; }
  // Of the action row that are hand i's.
  int32_t entries(int32_t i) const { return first_entry_[i + 1] - first_entry_[i]; }
  // A joint's command is its action entry in each step, to the bit: nothing is averaged or integrated.
  bool commands_are_actions() const {
    return options_.control == HandDrive::kPosition && options_.action_average == 1;
  }
  const char* action_order() const { return order_; }
  // Where in the action row hand i's joint entries begin, and its base entries (force, then torque).
  int32_t joint_entries(int32_t i) const {
    return first_entry_[i] + (flying_[i] && !base_.paper_order ? kBaseActions : 0);
  }
  int32_t base_entries(int32_t i) const {
    return first_entry_[i] + (base_.paper_order ? hands_[i].num_entries() : 0);
  }
  // Entry of the action row for a command of hand i; -1: none, or the command is -1.
  int32_t entry(int32_t i, int32_t command) const {
    const int32_t at = command < 0 ? -1 : hands_[i].entry(command);
    return at < 0 ? -1 : joint_entries(i) + at;
  }
  // Entry of the action row for a joint of the scene; -1: none.
  int32_t action_of(int32_t joint) const {
    for (int32_t i = 0; i < count_; ++i)
      for (int32_t k = 0; k < hands_[i].num_actions; ++k)
        if (hands_[i].actuated[k] == joint) return entry(i, k);
    return -1;
  }
  // Where hand i's joint is at the start, rad.
  double start(int32_t i, int32_t joint) const { return start_[i].q[joint]; }
  // Hand i's joint, one with an action entry, begins at q and is drawn within [low, high], rad.
  void begin_at(int32_t i, int32_t joint, double q, double low, double high);
  // Where among the commands hand i's begin.
  int32_t first_command(int32_t i) const { return first_command_[i]; }

  // Its state as bytes at the end of a task's own.
  size_t state_bytes() const;
  HandControlState state(void* bytes) const;
  const float* action(const void* bytes) const;
  void check_state(const void* bytes) const;  // of a saved state: Error(kFormat)

  void redraw(World& world, Stream& stream) const { draws_->apply(world, stream); }
  const DynamicsDraws* draws() const { return draws_; }
  void reset(double noise, bool literal, World& world, const HandControlState& state, Stream& stream) const;
  void control(World& world, const HandControlState& state, const float* action) const;
  // How far the base that went furthest is from its start, m; 0 for fixed ones.
  double base_displacement(const World& world) const;

  HandView view(const World& world, const float* action, int32_t i) const;
  void add_fields(FieldTable& table) const;
  float* write(const World& world, const float* action, float* out) const;
  // The start pose, bases at rest. [action_dim]
  void hold(float* action) const;
  // The same with the hands' joints in the middle of their ranges: arms alone hold.
  void hold_arms(float* action) const;

 private:
  void push_bases(World& world, const float* action) const;
  void slow_base(World& world, int32_t articulation) const;
  void feed_forward(World& world, int32_t i, const float* action) const;
  void move_commands(const World& world, int32_t i, const float* action, double* command) const;
  void lead_arm(const World& world, int32_t i, const float* action, double* command) const;

  int32_t count_;
  HandOptions options_;
  FlyingOptions base_ = {};  // where hands fly
  int32_t first_entry_[kMaxHands + 1] = {}, first_command_[kMaxHands + 1] = {};
  char order_[256];
  bool flying_[kMaxHands] = {};
  bool compensated_[kMaxHands] = {};  // gravity, by feed-forward
  const DynamicsDraws* draws_;
  double force_ = 0, torque_ = 0;  // N, N m for an entry of 1
  struct Start {
    double q[kMaxHandJoints] = {}, low[kMaxHandJoints] = {}, high[kMaxHandJoints] = {};
  };
  Start start_[kMaxHands];  // [num_joints] rad; between which angles a reset draws it
  Hand hands_[kMaxHands];
  Vec3 bases_[kMaxHands];
  Quat q_WR_[kMaxHands];  // of the robots' roots
};

}  // namespace rdm
