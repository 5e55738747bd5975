#include "tasks/hand_over.hpp"

#include <algorithm>
#include <iterator>

#include "env/sim_options.hpp"
#include "tasks/hand_block.hpp"
#include "tasks/hands.hpp"
#include "tasks/safety_costs.hpp"
#include "tasks/throw_game.hpp"

namespace rdm {
namespace {

constexpr int kActions = 2 * kHandActions;
constexpr float kObsLimit = 5;
constexpr ThrowPlace kPlace = {{0, -0.39, 0.54}, {0, -0.64, 0.54}, 0.2};
const Pose kRightBase = {{0, 0, 0.5}, {}};
const Pose kLeftBase = {{0, -1, 0.5}, {0, 1, 0, 0}};  // half a turn about x: palm up again

struct State {
  ThrowState game;
  SafetyState safety;
  double command[kActions];  // in [-1, 1], after averaging
  float action[kActions];    // as given
};

constexpr OptionSpec kRows[] = {
    number_option("action_average", 1, 0.01, 1, "weight of the new action in the moving average of targets"),
    text_option("sensor", "contact", "contact|none", "fingertip force entries: contact forces, or zero"),
    text_option(
        "initial_mean", "auto", "auto|flat|window|hold|zero",
        "start of a new policy: right hand flat, the same with the first finger inside its cost window, "
        "the hold action, or 0; auto: window for the finger cost, else flat"),
    flag_option("hand_contact", true, "the hands may touch each other"),
    number_option("friction.hand_object", 1, 0, 10, "friction coefficient of hands and object"),
    number_option("friction.hand_hand", 0, 0, 10, "friction coefficient of one hand and the other"),
    number_option("friction.hand_self", 0, 0, 10, "friction coefficient inside one hand"),
    number_option("friction.object_ground", 1, 0, 10, "friction coefficient of object and ground"),
};

const OptionSpec* options_table(int32_t* count) {
  struct Table : OptionTable {
    Table() {
      add_throw_options(kPlace, *this);
      add_safety_options(*this);
      add(kRows);
      add_sim_options(*this);
      add_hand_options(*this);
    }
  };
  static const Table table;
  *count = table.count();
  return table.rows();
}

SceneDef make_scene_def(const Options& o) {
  SceneDef s;
  s.gravity = gravity_from(o);
  s.solver = solver_from(o);
  s.articulations.push_back(make_hand(o, Side::kRight, kRightBase, kRightHand));
  s.articulations.push_back(make_hand(o, Side::kLeft, kLeftBase, kLeftHand));
  s.bodies.push_back(throw_body_from(o));
  ShapeDef ground;
  ground.name = "ground";
  ground.kind = ShapeKind::kPlane;
  ground.material = kGround;
  ground.color[0] = 150, ground.color[1] = 158, ground.color[2] = 165;
  s.statics.push_back(ground);
  s.hand_hand_contact = o.flag("hand_contact");
  s.num_materials = kNumMaterials;
  const auto rub = [&](int32_t a, int32_t b, const char* key) {
    s.friction[a][b].mu = s.friction[b][a].mu = o.number(key);
  };
  rub(kRightHand, kObject, "friction.hand_object");
  rub(kLeftHand, kObject, "friction.hand_object");
  rub(kRightHand, kLeftHand, "friction.hand_hand");
  rub(kRightHand, kRightHand, "friction.hand_self");
  rub(kLeftHand, kLeftHand, "friction.hand_self");
  rub(kObject, kGround, "friction.object_ground");
  return s;
}

class HandOver final : public Task {
 public:
  HandOver(const Options& o, SafetyKind kind)
      : engine_(engine_from(o)),
        max_steps_(o.integer("max_steps")),
        average_(o.number("action_average")),
        sensor_(same_name(o.text("sensor"), "contact")),
        scene_(make_scene(make_scene_def(o))),
        hands_{find_hand(scene_, 0), find_hand(scene_, 1)},
        game_(throw_game_from(o)),
        costs_(safety_costs_from(o, kind, scene_, hands_[0])) {
    add_hand_fields(fields_, "right");
    add_hand_fields(fields_, "left");
    add_throw_fields(fields_);
    hold(initial_mean_);
    const char* mean = o.text("initial_mean");
    if (same_name(mean, "zero"))
      std::fill(std::begin(initial_mean_), std::end(initial_mean_), 0.0f);
    else if (!same_name(mean, "hold"))
      flat_mean(same_name(mean, "window") || (same_name(mean, "auto") && kind == SafetyKind::kFinger));
  }

  const Scene& scene() const override { return scene_; }
  EngineKind engine() const override { return engine_; }
  int32_t max_steps() const override { return max_steps_; }
  int32_t action_dim() const override { return kActions; }
  const Vector<FieldSpec>& fields() const override { return fields_; }
  const char* action_order() const override { return "right joints, left joints"; }
  size_t state_bytes() const override { return sizeof(State); }

  void reset(World& world, void* state, Stream& stream) const override {
    State& s = *static_cast<State*>(state);
    draw_joints({game_.joint_noise, game_.joint_noise_literal}, hands_, 2, world, stream);
    for (int i = 0; i < kActions; ++i) s.command[i] = to_command(i, world.q());
    reset_throw(game_, world, &s.game, stream);
  }

  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    for (int i = 0; i < kActions; ++i) {
      s.action[i] = action[i];
      s.command[i] = average_ * static_cast<double>(action[i]) + (1 - average_) * s.command[i];
    }
    command_hand(hands_[0], s.command, world);
    command_hand(hands_[1], s.command + kHandActions, world);
  }

  Verdict judge(World& world, void* state, int32_t) const override {
    State& s = *static_cast<State*>(state);
    Verdict v;
    const ThrowMeasure m = measure_throw(game_, world, s.game);
    v.reward = throw_reward(m, game_.alpha, game_.reward_scale);
    v.success = count_success(game_, m.distance, &s.game);
    v.terminated = world.body(0).X.p.z <= game_.fall_height;
    judge_safety(costs_, hands_, world, s.command, &s.safety, &v);
    return v;
  }

  void observe(const World& world, const void* state, float* obs) const override {
    const State& s = *static_cast<const State*>(state);
    obs = write_hand({world, hands_[0], s.action, sensor_}, obs);
    obs = write_hand({world, hands_[1], s.action + kHandActions, sensor_}, obs);
    write_throw(game_, world, s.game, obs);
  }
  float obs_limit() const override { return kObsLimit; }

  void hold_action(float* action) const override { hold(action); }

  void initial_mean(float* action) const override {
    std::copy(std::begin(initial_mean_), std::end(initial_mean_), action);
  }

 private:
  // The command that asks the joint of action entry i to be where it is in q [num_links].
  double to_command(int i, const double* q) const {
    const Hand& hand = hands_[i / kHandActions];
    const int32_t k = i % kHandActions, joint = hand.joint(k);
    return to_action(hand.lower[joint], hand.upper[joint], q[hand.actuated[k]]);
  }

  void hold(float* action) const {
    constexpr double kStraight[2 * kHandJoints] = {};
    for (int i = 0; i < kActions; ++i) action[i] = static_cast<float>(to_command(i, kStraight));
  }

  // The right hand flat and both wrists raised; thumb and left hand at the middle of their ranges. With
  // `window` the first finger bends into its cost window.
  void flat_mean(bool window) {
    constexpr float kWristSide = 0.55f, kWristFlex = 0.18f, kBent = -0.4f;
    constexpr int kThumb = 15, kLateral[] = {2, 5, 8, 12};
    std::fill(std::begin(initial_mean_), std::end(initial_mean_), 0.0f);
    for (int i = 2; i < kThumb; ++i) initial_mean_[i] = -1;
    for (const int i : kLateral) initial_mean_[i] = 0;
    if (window) initial_mean_[3] = initial_mean_[4] = kBent;
    initial_mean_[0] = initial_mean_[kHandActions] = kWristSide;
    initial_mean_[1] = initial_mean_[kHandActions + 1] = kWristFlex;
  }

  EngineKind engine_;
  int32_t max_steps_;
  double average_;
  bool sensor_;
  Scene scene_;
  Hand hands_[2];
  ThrowGame game_;
  SafetyCosts costs_;
  FieldTable fields_;
  float initial_mean_[kActions];
};

template <SafetyKind kind>
Task* make(const Options& options, const HostHooks& hooks) {
  const HostScope scope(hooks);
  return host_new<HandOver>(hooks, options, kind);
}

void destroy(Task* task, const HostHooks& hooks) {
  host_delete(hooks, static_cast<HandOver*>(task));
}

constexpr ThrowLearner kFingerLearner = throw_learner("40"), kJointLearner = throw_learner("30");

}  // namespace

const TaskInfo kHandOverSafeFinger = {
    "hand_over_safe_finger",
    "ShadowHandOverSafeFinger",
    "throw an object from hand to hand; cost: the first finger's joints leave their windows",
    &options_table,
    kFingerCosts.data(),
    kNumSafetyCosts,
    kThrowCameras,
    kNumThrowCameras,
    kFingerLearner.data(),
    static_cast<int32_t>(kFingerLearner.size()),
    &make<SafetyKind::kFinger>,
    &destroy,
};

const TaskInfo kHandOverSafeJoint = {
    "hand_over_safe_joint",
    "ShadowHandOverSafeJoint",
    "throw an object from hand to hand; cost: the first finger's lateral joint leaves its window",
    &options_table,
    kJointCosts.data(),
    kNumSafetyCosts,
    kThrowCameras,
    kNumThrowCameras,
    kJointLearner.data(),
    static_cast<int32_t>(kJointLearner.size()),
    &make<SafetyKind::kJoint>,
    &destroy,
};

}  // namespace rdm
