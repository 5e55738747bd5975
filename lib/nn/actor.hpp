// A policy that plays: it decides every `action_repeat` control steps, and each action is held between.
//
// One step of the worlds is `repeat` control steps, so a decision lasts hold = action_repeat / repeat steps.
// A decision that is sampled takes its noise from one stream, in the order of the worlds that are due: z of
// each entry is AR(1) from one decision to the next, z' = rho z + sqrt(1 - rho^2) n, and n at an episode's
// first. What a policy with a memory remembers of a world begins anew with its episode. Serialised form (base/bytes.hpp): magic "RDMACTOR".
#pragma once
#include "nn/policy.hpp"

namespace rdm {

struct ActorConfig {
  const Policy* policy = nullptr;  // outlives the actor
  int32_t num_envs = 0;
  int32_t repeat = 1;       // control steps of a step
  bool stochastic = false;  // samples, instead of the mean
  uint64_t seed = 0;        // of the noise
  // [action_dim] what the environment adds to every action, taken from those that are given; null: nothing
  const float* center = nullptr;
  HostHooks hooks;
};

class Actor {
 public:
  // Error(kRange) for sizes, Error(kArgument) for a center outside [-1, 1] or a repeat that does not divide
  // the policy's.
  static size_t memory(const ActorConfig& config);
  static Actor* create(const ActorConfig& config);
  static void destroy(Actor* actor);

  // Where mask [num_envs] is not 0 (null: everywhere): action [num_envs][action_dim] of obs
  // [num_envs][obs_dim], a new one where a decision is due. On failure no decision is counted.
  void act(const float* obs, const PointRows& clouds, const uint8_t* mask, float* action);
  // Episodes begin where one of the two [num_envs] is not 0; both null: everywhere.
  void reset(const uint8_t* first, const uint8_t* second);

  void write_state(Writer& out) const;
  void read_state(const void* bytes, size_t size);  // Error(kFormat): nothing changes

  const Policy& policy() const { return *policy_; }
  int32_t hold() const { return hold_; }

 private:
  void carve(Arena& arena);
  void gather(const float* obs, const PointRows& clouds);
  void draw_noise();
  void decide();
  uint64_t fingerprint() const;

  HostHooks hooks_;
  Arena arena_;
  const Policy* policy_ = nullptr;
  int32_t num_envs_ = 0, hold_ = 1;
  bool stochastic_ = false;
  uint64_t stream_ = 0, drawn_ = 0;  // where the noise is, and where it will be after this decision
  int32_t* left_ = nullptr;          // [num_envs] steps that the action is still held
  uint8_t* fresh_ = nullptr;         // [num_envs] no decision yet in this episode
  float* held_ = nullptr;            // [num_envs][action_dim] action as it is given
  float* memory_ = nullptr;          // [num_envs][action_dim] noise of the last decision
  float* center_ = nullptr;          // [action_dim]
  float* state_ = nullptr;  // [num_envs][state_dim] what the policy remembers; zeros where it is fresh
  // of the worlds that decide now, one after the other
  int32_t* due_ = nullptr;
  int32_t num_due_ = 0;
  float *obs_ = nullptr, *action_ = nullptr, *noise_ = nullptr, *points_ = nullptr, *due_state_ = nullptr;
  uint8_t *classes_ = nullptr, *colors_ = nullptr;
  unsigned char* scratch_ = nullptr;
};

// Error(kArgument) unless the row's entries are finite; `row` is the number that the text names.
void need_finite_row(const float* row, size_t width, const char* name, size_t number);

}  // namespace rdm
