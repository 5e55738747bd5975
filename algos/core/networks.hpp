// The parameters that an agent learns: log standard deviation, actor, reward critic, cost critic, one vector.
//
// An actor with eyes (option encoder) sees its entries of the row and, behind them, the features of a cloud:
// the encoder's parameters stand behind the actor's network, in the same block, and learn with it, or with
// encoder_frozen stay as they are. Critics see rows alone.
//
// An actor in groups (option groups) is a network for each, one behind the other in the same block; the log deviations
// before them are in the order of the actions. A gradient or a step may be of one group alone: `focus`.
//
// With option memory a GRU stands before the actor's last layer, or that of each group: its state comes from whoever
// runs it, those of groups one behind the other. With option history the rows are stacked ones (rollout/memory.hpp).
//
// With option latent the actor's network reads its own entries and a latent, which an encoder makes of others, then the
// features of its eyes, if it has any; the encoder's parameters stand behind the eyes'. Those of a student have the
// teacher's encoder behind them, which makes what it learns; then nothing but the student's encoder learns.
//
// Critics of an algorithm whose groups have their own stand likewise in the block of their kind.
//
// With std_mode=state there is no such deviation: the actor's network gives, behind each row's means, its log
// deviations.
#pragma once
#include "algos/core/resolved_config.hpp"
#include "algos/core/state_io.hpp"
#include "nn/adam.hpp"
#include "nn/squash.hpp"

namespace rdm {

// A block of the common vector with its own optimiser and gradient norm.
struct Block {
  size_t offset = 0, size = 0;
  Adam adam;
};

// Scratch of an actor: what its eyes need too. picked: the rows that its network sees, with features.
struct ActorScratch : MlpScratch {
  PointNetScratch eyes;
  RecurrentScratch memory;                   // of an actor with a GRU; of groups h alone, the states of all
  int32_t* winner = nullptr;                 // [rows][features]
  float* dfeatures = nullptr;                // [rows][features]
  MlpScratch* group = nullptr;               // [groups], of an actor in groups
  float* part = nullptr;                     // [rows][widest output of a group]
  RecurrentScratch* group_memory = nullptr;  // [groups], where they have GRUs
  float* part_state = nullptr;               // [rows][units] of one
  MlpScratch latent, teacher;                // of the encoders of a latent, what they read picked
  float *z = nullptr, *dz = nullptr,
        *taught = nullptr;  // [rows][latent] given, its derivative, the teacher's
  float* behind = nullptr;  // [rows][latent + features] derivatives of both, of an actor that has both
};
// Steps of rows that an actor with a GRU runs over; zeros as h0 and no clears begin and keep its memory.
struct MemorySteps {
  int32_t steps = 1, rows = 0;
  const float* h0 = nullptr;       // [rows][units of all groups]
  const uint8_t* clear = nullptr;  // [steps][rows]
};
ActorScratch carve_actor_scratch(Arena& arena, const ResolvedAgentConfig& resolved, int32_t rows);
// Of networks in groups.
ActorScratch carve_group_scratch(Arena& arena, const Vector<ActorGroup>& groups, int32_t rows,
                                 bool tangents = false);

// Order: actor (log_std padded to 16 with zeros, then the network, then its eyes), reward critic, cost
// critic.
struct Networks {
  enum Index { kActor, kReward, kCost };
  MlpShape shape[3];
  const int32_t* columns[3] = {};     // [shape.in] entries of a row that the network sees; null: all
  int32_t obs_dim = 0;                // of a row, a stacked one
  int32_t history_inputs = 0;         // of it, at its end
  GruShape gru;                       // of the actor, of groups that of each has as many units; units 0: none
  const ActorGroup* group = nullptr;  // [num_groups] of the actor; none: it is one network
  int32_t num_groups = 0;
  int64_t* group_steps = nullptr;  // [num_groups] of Adam
  // Critics of groups [num_critics] of each kind, by Index; null: one serves all.
  const ActorGroup* critic[3] = {};
  int32_t num_critics = 1;
  int64_t* critic_steps[3] = {};             // [num_critics] of Adam
  int32_t focus = -1;                        // the group that learns now, -1: all
  size_t actor_params = 0;                   // of the actor's networks, its eyes apart
  PointNetShape eyes;                        // of the actor; points 0: none
  bool frozen = false;                       // eyes do not learn
  LatentShape latent;                        // of the actor, columns of the stacked row
  MlpShape teacher;                          // of a student, out 0: it is none
  const int32_t* teacher_columns = nullptr;  // [teacher.in]
  Block block[3];
  int32_t count = 0;    // 2 without cost critic
  size_t size = 0;      // of params
  size_t std_size = 0;  // padded; 0 with std_mode=state
  int32_t action_dim = 0;
  float std_low = 0, std_high = 0;  // bounds on the log deviations that the network gives
  float log_share = 0;              // of the innovation in them
  Squash squash = Squash::kNone;    // of the actor's outputs
  double input_bound = 0;           // on the magnitude of inputs
  float* params = nullptr;
  // Option average: the actor's block as the mean over past epochs, of which the last ones count most; null:
  // none. It is what acts without noise and goes into policy files; it takes no part in learning.
  float* average = nullptr;
  double average_share = 0;     // of the average that the next epoch leaves, at most
  int64_t* averaged = nullptr;  // epochs in it; null: as average

  float* before = nullptr;  // the actor's block as keep_actor found it
  bool updating = false;    // that is the policy of before an update that runs

  bool state_std() const { return std_size == 0; }
  float* log_std() const { return params; }
  size_t net_offset(int32_t i) const { return block[i].offset + (i == kActor ? std_size : 0); }
  float* net(int32_t i) const { return params + net_offset(i); }
  // The actor that others get to see: log deviations, then the network. While an update runs it is the one from
  // before; the average only moves when one ends.
  const float* kept_log_std() const { return average ? average : updating ? before : params; }
  const float* kept_actor() const { return kept_log_std() + std_size; }
  // Of the encoder's parameters behind those of the actor's network.
  size_t eyes_offset() const { return actor_params; }
  size_t latent_offset() const { return eyes_offset() + eyes.num_params(); }
  size_t teacher_offset() const { return latent_offset() + latent.num_params(); }
  bool adapts() const { return teacher.out > 0; }
  RecurrentShape actor() const { return {shape[kActor], gru}; }
  bool learns(int32_t g) const { return focus < 0 || g == focus; }
  // The groups that learn now: [first_group(), last_group()); of an actor of one network one.
  int32_t first_group() const { return std::max(focus, 0); }
  int32_t last_group() const { return focus < 0 ? std::max(num_groups, 1) : focus + 1; }
  // The action's entries that learn now.
  int32_t first_action() const { return focus < 0 ? 0 : group[focus].first; }
  int32_t last_action() const { return focus < 0 ? action_dim : group[focus].first + group[focus].count; }
  float* eyes_net() const { return net(kActor) + eyes_offset(); }
  // What the actor sees before its features: entries of the row, the latent.
  int32_t actor_entries() const { return shape[kActor].in - eyes.features(); }
  int32_t row_entries() const {  // without its history
    return latent ? latent.entries : actor_entries() - history_inputs;
  }
  // y = network i of the rows x [rows][obs_dim], and the gradient of its block, grad laid out as params; x
  // and scratch as in the forward pass before. The actor's log deviations are those of the innovation, within
  // their bounds.
  void forward(int32_t i, const float* x, int32_t rows, const ActorScratch& scratch, float* y) const {
    if (critic[i]) return forward_critics(i, x, rows, scratch, y);
    forward_with(net(i), i, x, rows, scratch, y);
  }
  // The same of an actor that may have eyes, for these clouds of the rows; and of the actor that others get
  // to see.
  void forward_actor(const float* x, const PointRows& clouds, int32_t rows, const ActorScratch& scratch,
                     float* y) const {
    forward_actor_with(net(kActor), x, clouds, rows, scratch, y);
  }
  void forward_kept(const float* x, const PointRows& clouds, int32_t rows, const ActorScratch& scratch,
                    float* y) const {
    forward_actor_with(kept_actor(), x, clouds, rows, scratch, y);
  }
  // The same of an actor with GRUs: x [steps][rows][obs_dim], y [steps][rows][out]; its states [steps][rows][units of
  // all groups] are in scratch.memory.h.
  void forward_memory(const float* x, const MemorySteps& m, const ActorScratch& scratch, float* y) const {
    forward_memory_with(net(kActor), x, m, scratch, y);
  }
  void forward_kept_memory(const float* x, const MemorySteps& m, const ActorScratch& scratch,
                           float* y) const {
    forward_memory_with(kept_actor(), x, m, scratch, y);
  }
  void backward_memory(const float* x, const MemorySteps& m, const ActorScratch& scratch, const float* dy,
                       float* grad) const;
  void tangent_memory(const float* direction, const float* x, const MemorySteps& m,
                      const ActorScratch& scratch, float* dy) const;
  void backward_actor(const float* x, const PointRows& clouds, int32_t rows, const ActorScratch& scratch,
                      const float* dy, float* grad) const;
  void tangent_actor(const float* direction, const float* x, const PointRows& clouds, int32_t rows,
                     const ActorScratch& scratch, float* dy) const;
  // Of a student, after its forward pass over the rows x: the sum of (z - mu)^2 over them and over z, mu being the
  // teacher's latent, and in grad scale times its gradient, 0 for all but the student's encoder.
  double regress_latent(const float* x, int32_t rows, float scale, const ActorScratch& scratch,
                        float* grad) const;
  // Features of the rows in the scratch of the last forward pass, feature_step() apart.
  const float* features(const ActorScratch& scratch) const { return scratch.picked + actor_entries(); }
  size_t feature_step() const { return static_cast<size_t>(shape[kActor].in); }
  void backward(int32_t i, const float* x, int32_t rows, const ActorScratch& scratch, const float* dy,
                float* grad) const {
    if (critic[i]) return backward_critics(i, x, rows, scratch, dy, grad);
    mlp_backward(shape[i], net(i), seen(i, x, scratch), rows, scratch, dy, grad + net_offset(i));
  }
  // dy along a direction of the network's parameters, likewise.
  void tangent(int32_t i, const float* direction, const float* x, int32_t rows, const MlpScratch& scratch,
               float* dy) const {
    mlp_tangent(shape[i], net(i), direction, seen(i, x, scratch), rows, scratch, dy);
  }
  // dy of the actor's outputs y: nothing where a deviation is at its bound.
  void gate_std(const float* y, int32_t rows, float* dy) const;
  int32_t num_tensors() const;
  void visit(StateIo& io);

 private:
  void forward_with(const float* weights, int32_t i, const float* x, int32_t rows, const MlpScratch& scratch,
                    float* y) const {
    if (columns[i]) pick_columns(x, rows, obs_dim, columns[i], shape[i].in, scratch.picked);
    mlp_forward(shape[i], weights, seen(i, x, scratch), rows, scratch, y);
    if (i == kActor && state_std()) bound_std(rows, y);
  }
  void forward_actor_with(const float* weights, const float* x, const PointRows& clouds, int32_t rows,
                          const ActorScratch& scratch, float* y) const;
  void see_latent(const float* weights, const float* x, int32_t rows, const ActorScratch& scratch) const;
  void see_clouds(const float* weights, const PointRows& clouds, int32_t rows,
                  const ActorScratch& scratch) const;
  // The actor's inputs from first_encoded() on come from its encoders. encoded() is where their derivatives [rows][in -
  // first_encoded()] stand: those of the latent before those of features. Each encoder has its own in an array of its
  // own, which split_encoded fills from there; join_encoded goes the other way.
  int32_t first_encoded() const { return latent ? latent.num_own : actor_entries(); }
  float* encoded(const ActorScratch& scratch) const;
  void split_encoded(int32_t rows, const ActorScratch& scratch) const;
  void join_encoded(int32_t rows, const ActorScratch& scratch) const;
  void forward_critics(int32_t i, const float* x, int32_t rows, const ActorScratch& scratch, float* y) const;
  void backward_critics(int32_t i, const float* x, int32_t rows, const ActorScratch& scratch, const float* dy,
                        float* grad) const;
  void forward_groups(const float* weights, const float* x, int32_t rows, const ActorScratch& scratch,
                      float* y) const;
  void forward_memory_with(const float* weights, const float* x, const MemorySteps& m,
                           const ActorScratch& scratch, float* y) const;
  void forward_group_memory(const float* weights, int32_t i, const float* x, const MemorySteps& m,
                            const ActorScratch& scratch, float* y) const;
  const float* seen(int32_t i, const float* x, const MlpScratch& scratch) const {
    return columns[i] ? scratch.picked : x;
  }
  void bound_std(int32_t rows, float* y) const;
};
Networks carve_networks(Arena& arena, const ResolvedAgentConfig& resolved);
// Weights from the streams (seed, network, init); the actor's last bias is the initial mean.
void init_networks(const Networks& n, const ResolvedAgentConfig& resolved);
void clamp_log_std(const Networks& n);
// One more epoch in the average: a plain mean until it has 1 / (1 - average_share) of them.
void average_actor(const Networks& n);
// It begins again with the actor as it is.
void restart_average(const Networks& n);
// The same where no epoch is in it yet.
void begin_average(const Networks& n);
// Adam's counts of the actor begin again.
void restart_steps(Networks& n);
// The actor as it is, and back to it: around an update, and around a line search.
void keep_actor(const Networks& n);
void restore_actor(const Networks& n);
// With std_schedule=linear the deviation for the epoch that follows `done` finished ones.
void schedule_std(const Networks& n, const SharedOptions& options, int32_t done);

// Moments of Adam that some gradients can have left.
bool moments_agree(const StateView<float>& m, const StateView<float>& v, size_t size);

inline constexpr int32_t kTensorNameSize = 72;
// Tensor `index` in the order above, names "actor.log_std", "actor.0.weight", "cost_critic.2.bias"; of an
// actor in groups "actor.NAME.0.weight".
bool find_tensor(const Networks& n, int32_t index, char* name, TensorInfo* out);

}  // namespace rdm
