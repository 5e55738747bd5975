// Tasks that a host describes: the description, copied and checked; the scene that its `build` fills; the
// world as its functions see it.
#pragma once
#include "capi/handles.hpp"

#if RDM_WITH_SIM
#include "env/dynamics_draw.hpp"
#include "env/fields.hpp"
#include "robot/robots.hpp"

namespace rdm::capi {

// Texts that stay where they are while the list grows.
class TextStore {
 public:
  const char* keep(const char* text);  // null stays null

 private:
  Vector<Vector<char>> texts_;
};

// A robot in a scene, and what its commands are there.
struct PlacedRobot {
  struct Command {
    int32_t joint;  // of the scene
    double lower, upper;
    double rate;              // how far its target moves in a control step, rad (m)
    const RobotCurve* curve;  // null: -1 is lower, 1 is upper
  };
  struct Follower {  // driven by another joint's command
    int32_t joint, command;
    const RobotCurve* curve;
  };
  Name name;
  RobotRef listed;
  RobotCopy own;
  bool of_scene = false;  // own, not listed
  Vector<Command> commands;
  Vector<Follower> followers;

  const Robot& robot() const { return of_scene ? own.robot() : *listed; }
};

// Pairs of shapes whose contacts are asked for together.
struct TouchGroup {
  Vector<int32_t> pairs;  // indices of Scene::pairs
  Vector<uint8_t> sides;  // per shape, bits: 1 of the first name, 2 of the second
};

// What describes a task, as TaskInfo has it, and the host's functions.
class OwnTask final : public TaskSource {
 public:
  // Error(kArgument), Error(kRange) with the row.
  OwnTask(const rdm_task_def& def, const HostHooks& hooks);
  const TaskInfo& info() const override { return info_; }
  const OptionSpec* options(int32_t* count) const override;
  Task* make(const Options& options, const HostHooks& hooks, void* user) const override;
  void destroy(Task* task, const HostHooks& hooks) const override;
  void end() noexcept override;

  // Calls one of the host's functions; what it does not return well is thrown as an Error that names it.
  template <class F>
  void run(const char* function, F&& f) const {
    note_failure(false);
    rdm_result r = RDM_OK;
    bool thrown = false;
    try {
      r = f();
    } catch (...) {
      thrown = true;
    }
    if (thrown || r != RDM_OK) blame(function, r, thrown);
  }

  // Throws what a function returned that is not RDM_OK.
  [[noreturn]] void blame(const char* function, rdm_result r, bool thrown) const;

  rdm_task_def def;  // of its arrays, those that are copied below are not to be used
  FieldTable fields;
  Vector<float> hold, mean;  // [action_dim]

 private:
  void take_fields();
  void take_costs();
  void take_options();
  void take_cameras();
  void take_defaults();
  void take_actions();

  HostHooks hooks_;
  TextStore texts_;
  Vector<CostSpec> costs_;
  Vector<OptionSpec> options_;
  Vector<CameraSpec> cameras_;
  Vector<LearnerDefault> defaults_;
  TaskInfo info_{};
};

// Arrays [count] of actions, null: zeros. Error(kRange) for an entry outside [-1, 1].
void copy_actions(const float* in, int32_t count, const char* name, Vector<float>* out);
// Error(kRange) for a count outside [1, 1024].
void check_action_dim(int64_t count, const char* name);
inline constexpr int32_t kMostEntries = 16384;  // of an observation

}  // namespace rdm::capi

// While `build` runs, and afterwards what the task keeps of it.
struct rdm_scene {
  static constexpr rdm::capi::Tag kTag = rdm::capi::Tag::kScene;
  rdm::capi::Tag tag = kTag;
  const rdm::Options* options = nullptr;
  void* user = nullptr;  // the pool's
  rdm::SceneDef def;     // gone into `scene` when that is made
  rdm::Vector<rdm::Name> materials;
  rdm::Vector<double> frictions;  // of materials that objects brought; -1 of others, as long as materials
  rdm::Vector<rdm::capi::PlacedRobot> robots;
  bool complete = false;
  rdm::Error failure = {};  // of completing it: what is asked of it afterwards gets the same
  rdm::Scene scene;
  rdm::Vector<rdm::capi::TouchGroup> groups;
  rdm::FieldTable fields;
  rdm::Vector<float> hold, mean;  // [action_dim]
  rdm::DynamicsDraws draws;       // of the options that every task has
};

namespace rdm::capi {
void begin_scene(const OwnTask& own, const Options& options, rdm_scene* scene);
// Makes `scene`; from here on nothing can be added. Where it cannot be made, it never can.
void complete_scene(rdm_scene* scene);
}  // namespace rdm::capi

struct rdm_world {
  static constexpr rdm::capi::Tag kTag = rdm::capi::Tag::kWorld;
  rdm::capi::Tag tag = kTag;
  bool fixed = false;  // only looked at
  rdm::World* world = nullptr;
  const rdm_scene* scene = nullptr;

  rdm_world() = default;  // to be filled
  rdm_world(rdm::World* w, const rdm_scene* s, bool looked_at) : fixed(looked_at), world(w), scene(s) {}
  ~rdm_world() { rdm::capi::retire(this); }
  rdm_world(rdm_world&&) = default;
  rdm_world(const rdm_world&) = delete;
  rdm_world& operator=(const rdm_world&) = delete;
};
#endif
