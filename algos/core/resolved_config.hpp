// Everything that is decided before an agent takes memory: checked config, option values, network shapes.
#pragma once
#include <algorithm>
#include <utility>

#include "algos/core/agent_types.hpp"
#include "algos/core/algo_row.hpp"
#include "algos/core/groups.hpp"
#include "algos/core/shared_options.hpp"
#include "nn/gru.hpp"
#include "nn/latent.hpp"
#include "nn/pointnet.hpp"

namespace rdm {

struct ResolvedAgentConfig {
  ResolvedAgentConfig(const AgentConfig& c, Options&& o, const AlgoRow& r)
      : config(c), options(std::move(o)), row(&r) {
    read_shared();
  }
  void read_shared();  // after a change of the options

  AgentConfig config;  // scalars and names stay valid, arrays only until the agent is made
  char task[kOptionTextSize] = "";
  Options options;
  SharedOptions shared;
  const AlgoRow* row;

  MlpShape actor, reward_critic, cost_critic;  // cost_critic.out = num_limited
  // What the actor sees of points: features that stand behind its entries of the row. points 0: nothing.
  PointNetShape eyes;
  bool frozen = false;  // they do not learn
  // With option history networks see stacked rows: behind a row the columns history_columns (empty: all) of the
  // decisions before it, newest first, history_width numbers each, history - 1 times.
  int32_t history = 1, history_width = 0;
  Vector<int32_t> history_columns;
  // Option latent: what the actor reads in place of latent_fields, and of a student (latent_from=history) what makes the
  // latent that its encoder learns to give, of teacher_columns. Columns are of the stacked row.
  LatentShape latent;
  MlpShape teacher;  // out 0: it is no student
  Vector<int32_t> own_columns, latent_columns, teacher_columns;
  GruShape gru;  // of the actor, before its last layer; units 0: none; of each group so many
  // Entries of the stacked row that these see, ascending; empty: all.
  Vector<int32_t> actor_columns, critic_columns;
  // The actor's groups, where it has several (option groups), and what each sees; none: it is one network. The shape
  // `actor` then is of all of them: every entry of the row, all actions.
  Vector<ActorGroup> groups;
  Vector<GroupSpec> group_specs;
  // Of an algorithm whose groups have critics of their own: those of the reward and of the costs, in the groups' order,
  // and what each sees. The shapes of the critics then are of all of them.
  Vector<ActorGroup> reward_critics, cost_critics;
  Vector<GroupSpec> critic_specs;
  int32_t num_limited = 0;         // limited cost columns; 0 for algorithms without costs
  bool values_costs = false;       // they have a critic of rows
  int32_t column[kMaxCosts] = {};  // [num_limited] column of each
  double limit[kMaxCosts] = {};    // [num_limited] on the sum over an episode, or over rate_steps
  int32_t episode_steps = 0;       // control steps after which an episode is counted as ended; 0: never
  int32_t rate_steps = 0;          // > 0: column 0 is limited per control step, as a sum over so many

  int32_t samples = 0;         // num_envs * horizon
  int32_t blocks = 1;          // this rank's
  int32_t minibatch_rows = 0;  // this rank's of the largest minibatch
  int32_t chunk_rows = 0;      // of a batch, by one thread at a time; the order of sums follows from it
  int32_t workers = 1;         // chunks in flight
  float log_share = 0;         // ln of the innovation's share of the standard deviation

  bool off_policy() const { return row->off_policy; }
  int32_t num_groups() const { return static_cast<int32_t>(groups.size()); }
  // Critics of a kind, each of which values every row.
  int32_t num_critics() const { return std::max(1, static_cast<int32_t>(reward_critics.size())); }
  // Of the actor's networks, its eyes apart.
  size_t actor_params() const {
    return groups.empty() ? RecurrentShape{actor, gru}.num_params()
                          : group_params(groups.data(), num_groups());
  }
  // It learns in a trust region, by Fisher products.
  bool trusts() const { return options.knows("trust_kl"); }
  bool sees() const { return eyes.points > 0; }
  // It is a student: all that learns is the encoder of its history.
  bool adapts() const { return teacher.out > 0; }
  // The actor's network gives log deviations behind its means.
  bool state_std() const { return actor.out != config.action_dim; }
  size_t obs_dim() const { return static_cast<size_t>(config.obs_dim); }
  // Of a stacked row, and of what is remembered of a world.
  int32_t history_inputs() const { return (history - 1) * history_width; }
  size_t seen_dim() const { return obs_dim() + static_cast<size_t>(history_inputs()); }
  int32_t state_units() const { return gru.units * std::max(1, num_groups()); }  // of all groups
  size_t state_dim() const { return static_cast<size_t>(state_units() + history_inputs()); }
  bool remembers() const { return state_dim() > 0; }
  int32_t memory_chunk() const { return std::min(shared.memory_chunk, shared.horizon); }
  size_t action_dim() const { return static_cast<size_t>(config.action_dim); }
  size_t num_envs() const { return static_cast<size_t>(config.num_envs); }
  // Of all ranks.
  int32_t all_envs() const { return config.num_envs * config.ranks.count; }
  int32_t all_samples() const { return samples * config.ranks.count; }
};

// Control steps that a limit per step is judged over where no length is known: an episode of Safety Gym.
inline constexpr int32_t kRateSteps = 1000;
// The limit on column 0 by its options, in the units of limit[]; < 0: none.
double limit_of_first(const ResolvedAgentConfig& resolved);

// Error(kRange, kArgument, kNotFound) with the name of the field or option.
ResolvedAgentConfig resolve_config(const AgentConfig& config);

}  // namespace rdm
