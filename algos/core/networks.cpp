#include "algos/core/networks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/elementary.hpp"

namespace rdm {
namespace {
constexpr const char* kNames[] = {"actor", "reward_critic", "cost_critic"};
constexpr const char* kGruNames[] = {"input.weight", "input.bias", "state.weight", "state.bias"};
constexpr int32_t kGruTensors = 4;
constexpr uint32_t kEyesStream = 3;    // of initial weights, behind those of the three networks
constexpr uint32_t kGroupsStream = 4;  // of the second group's, and on; the first has the actor's
constexpr uint32_t kCriticsStream = kGroupsStream + kMaxGroups;  // likewise of critics, of each kind

constexpr uint32_t kLatentStream = kCriticsStream + 2 * kMaxGroups;  // of a latent's encoder
constexpr uint32_t kStudentStream = kLatentStream + 1;               // of the one that is a student's

// Bound on what a network of a loaded state may give: far beyond any that learns, and a float still holds its
// square.
constexpr double kMaxOutput = 1e18;

// Numbers of a list from one on.
struct From {
  const StateView<float>& list;
  size_t at;
  float operator[](size_t i) const { return list[at + i]; }
};

}  // namespace

// With m = sum (1 - a) a^k g_k and v = sum (1 - b) b^k g_k^2 it is
// |m| <= sqrt(v) (1 - a) / sqrt((1 - b) (1 - a^2 / b)) = 7.27 sqrt(v) (Cauchy and Schwarz), but for squares
// below the smallest float. So no step is longer than that many learning rates.
bool moments_agree(const StateView<float>& m, const StateView<float>& v, size_t size) {
  for (size_t i = 0; i < size; ++i)
    if (std::abs(static_cast<double>(m[i])) > 8 * std::sqrt(static_cast<double>(v[i])) + 1e-15) return false;
  return true;
}

Networks carve_networks(Arena& arena, const ResolvedAgentConfig& resolved) {
  Networks n;
  n.shape[Networks::kActor] = resolved.actor;
  n.shape[Networks::kReward] = resolved.reward_critic;
  n.shape[Networks::kCost] = resolved.cost_critic;
  const auto list = [](const Vector<int32_t>& columns) { return columns.empty() ? nullptr : columns.data(); };
  n.columns[Networks::kActor] = list(resolved.actor_columns);
  n.columns[Networks::kReward] = n.columns[Networks::kCost] = list(resolved.critic_columns);
  n.obs_dim = static_cast<int32_t>(resolved.seen_dim());
  n.history_inputs = resolved.history_inputs();
  n.gru = resolved.gru;
  n.num_groups = resolved.num_groups();
  n.group = n.num_groups ? resolved.groups.data() : nullptr;
  n.group_steps = arena.make<int64_t>(static_cast<size_t>(n.num_groups));
  n.num_critics = resolved.num_critics();
  if (!resolved.reward_critics.empty()) {
    n.critic[Networks::kReward] = resolved.reward_critics.data();
    n.critic[Networks::kCost] = resolved.cost_critics.data();
    for (int32_t i = Networks::kReward; i <= Networks::kCost; ++i)
      n.critic_steps[i] = arena.make<int64_t>(static_cast<size_t>(n.num_critics));
  }
  n.actor_params = resolved.actor_params();
  n.eyes = resolved.eyes;
  n.frozen = resolved.frozen;
  n.latent = resolved.latent;
  n.teacher = resolved.teacher;
  n.teacher_columns = list(resolved.teacher_columns);
  n.count = resolved.off_policy() ? 1 : resolved.values_costs ? 3 : 2;
  n.action_dim = resolved.config.action_dim;
  n.std_size = resolved.state_std() ? 0 : (resolved.action_dim() + 15) / 16 * 16;
  n.std_low = static_cast<float>(elementary::log(resolved.shared.std_min));
  n.std_high = static_cast<float>(elementary::log(resolved.shared.std_max));
  n.log_share = resolved.log_share;
  n.squash = resolved.row->squash;
  n.input_bound = resolved.shared.normalize_obs ? resolved.shared.obs_clip : 1e3;
  for (int32_t i = 0; i < n.count; ++i) {
    n.block[i].offset = n.size;
    n.block[i].size = n.critic[i] ? group_params(n.critic[i], n.num_critics) : n.shape[i].num_params();
    if (i == Networks::kActor)
      n.block[i].size = n.std_size + n.teacher_offset() + (n.adapts() ? n.teacher.num_params() : 0);
    n.size += (n.block[i].size + 15) / 16 * 16;
  }
  n.params = arena.make<float>(n.size);
  n.before = arena.make<float>(n.block[Networks::kActor].size);
  n.average_share = resolved.shared.average;
  if (n.average_share > 0) {
    n.average = arena.make<float>(n.block[Networks::kActor].size);
    n.averaged = arena.make<int64_t>(1);
  }
  for (int32_t i = 0; i < n.count; ++i) n.block[i].adam = carve_adam(arena, n.block[i].size);
  return n;
}

ActorScratch carve_group_scratch(Arena& arena, const Vector<ActorGroup>& groups, int32_t rows,
                                 bool tangents) {
  ActorScratch s;
  const auto n = static_cast<size_t>(rows);
  s.rows = rows;
  s.group = arena.make<MlpScratch>(groups.size());
  int32_t widest = 0;
  for (size_t g = 0; g < groups.size(); ++g) {
    const ActorGroup& group = groups[g];
    MlpScratch own = carve_mlp_scratch(arena, group.shape, rows);
    own.picked = arena.make<float>(group.columns ? n * static_cast<size_t>(group.shape.in) : 0);
    if (s.group) s.group[g] = own;
    widest = std::max(widest, group.shape.out);
  }
  s.part = arena.make<float>(n * static_cast<size_t>(widest));
  const auto units = static_cast<size_t>(groups[0].gru.units);
  if (units == 0) return s;
  s.group_memory = arena.make<RecurrentScratch>(groups.size());
  for (size_t g = 0; g < groups.size(); ++g) {
    const RecurrentScratch own = carve_recurrent_scratch(arena, groups[g].net(), rows, tangents);
    if (s.group_memory) s.group_memory[g] = own;
  }
  s.part_state = arena.make<float>(n * units);
  s.memory.h = arena.make<float>(n * units * groups.size());
  return s;
}

ActorScratch carve_actor_scratch(Arena& arena, const ResolvedAgentConfig& resolved, int32_t rows) {
  if (resolved.num_groups() > 0) return carve_group_scratch(arena, resolved.groups, rows, resolved.trusts());
  ActorScratch s;
  const auto n = static_cast<size_t>(rows);
  static_cast<MlpScratch&>(s) = carve_mlp_scratch(arena, resolved.actor, rows);
  if (!resolved.actor_columns.empty() || resolved.sees())
    s.picked = arena.make<float>(n * static_cast<size_t>(resolved.actor.in));
  const auto encoder = [&](const MlpShape& shape) {
    MlpScratch own = carve_mlp_scratch(arena, shape, rows);
    own.picked = arena.make<float>(n * static_cast<size_t>(shape.in));
    return own;
  };
  if (const auto numbers = static_cast<size_t>(resolved.latent.mlp.out)) {
    s.picked = arena.make<float>(n * static_cast<size_t>(resolved.actor.in));
    s.latent = encoder(resolved.latent.mlp);
    s.z = arena.make<float>(n * numbers);
    s.dz = arena.make<float>(n * numbers);
    if (resolved.adapts()) s.teacher = encoder(resolved.teacher), s.taught = arena.make<float>(n * numbers);
    if (resolved.sees())
      s.behind = arena.make<float>(n * (numbers + static_cast<size_t>(resolved.eyes.features())));
  }
  if (resolved.gru.units)
    s.memory = carve_recurrent_scratch(arena, {resolved.actor, resolved.gru}, rows, resolved.trusts());
  if (!resolved.sees()) return s;
  const auto features = static_cast<size_t>(resolved.eyes.features());
  s.eyes = carve_pointnet_scratch(arena, resolved.eyes);
  s.winner = arena.make<int32_t>(n * features);
  s.dfeatures = arena.make<float>(n * features);
  return s;
}

void Networks::forward_actor_with(const float* weights, const float* x, const PointRows& clouds, int32_t rows,
                                  const ActorScratch& scratch, float* y) const {
  if (num_groups) return forward_groups(weights, x, rows, scratch, y);
  if (!latent && !eyes.points) return forward_with(weights, kActor, x, rows, scratch, y);
  const size_t in = feature_step(), own = static_cast<size_t>(actor_entries());
  for (size_t i = 0; !latent && i < static_cast<size_t>(rows); ++i) {
    const float* row = x + i * static_cast<size_t>(obs_dim);
    float* to = scratch.picked + i * in;
    if (columns[kActor])
      pick_columns(row, 1, obs_dim, columns[kActor], actor_entries(), to);
    else
      std::copy_n(row, own, to);
  }
  if (latent) see_latent(weights, x, rows, scratch);
  if (eyes.points) see_clouds(weights, clouds, rows, scratch);
  mlp_forward(shape[kActor], weights, scratch.picked, rows, scratch, y);
  if (state_std()) bound_std(rows, y);
}

void Networks::see_latent(const float* weights, const float* x, int32_t rows,
                          const ActorScratch& scratch) const {
  pick_columns(x, rows, obs_dim, latent.columns, latent.mlp.in, scratch.latent.picked);
  mlp_forward(latent.mlp, weights + latent_offset(), scratch.latent.picked, rows, scratch.latent, scratch.z);
  put_latent(latent, x, obs_dim, scratch.z, rows, scratch.picked, feature_step());
}

// Features behind what the actor sees beside them, which come with the clouds or are computed.
void Networks::see_clouds(const float* weights, const PointRows& clouds, int32_t rows,
                          const ActorScratch& scratch) const {
  const size_t in = feature_step(), own = static_cast<size_t>(actor_entries()), width = in - own;
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i) {
    if (clouds.features)
      std::copy_n(clouds.features + clouds.row(i) * width, width, scratch.picked + i * in + own);
    if (clouds.winner) std::copy_n(clouds.winner + clouds.row(i) * width, width, scratch.winner + i * width);
  }
  if (!clouds.features)
    pointnet_forward(eyes, weights + eyes_offset(), clouds, rows, scratch.eyes, scratch.picked + own, in,
                     scratch.winner);
}

float* Networks::encoded(const ActorScratch& scratch) const {
  return latent && eyes.points ? scratch.behind : latent ? scratch.dz : scratch.dfeatures;
}

void Networks::split_encoded(int32_t rows, const ActorScratch& scratch) const {
  if (!latent || !eyes.points) return;
  const auto numbers = static_cast<size_t>(latent.mlp.out), width = static_cast<size_t>(eyes.features());
  const float* from = scratch.behind;
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i, from += numbers + width) {
    std::copy_n(from, numbers, scratch.dz + i * numbers);
    std::copy_n(from + numbers, width, scratch.dfeatures + i * width);
  }
}

// Eyes that stand still have no derivatives.
void Networks::join_encoded(int32_t rows, const ActorScratch& scratch) const {
  if (!latent || !eyes.points) return;
  const auto numbers = static_cast<size_t>(latent.mlp.out), width = static_cast<size_t>(eyes.features());
  float* to = scratch.behind;
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i, to += numbers + width) {
    std::copy_n(scratch.dz + i * numbers, numbers, to);
    if (frozen)
      std::fill_n(to + numbers, width, 0.0f);
    else
      std::copy_n(scratch.dfeatures + i * width, width, to + numbers);
  }
}

double Networks::regress_latent(const float* x, int32_t rows, float scale, const ActorScratch& scratch,
                                float* grad) const {
  float* const to = grad + block[kActor].offset;
  std::fill_n(to, std_size + latent_offset(), 0.0f);
  pick_columns(x, rows, obs_dim, teacher_columns, teacher.in, scratch.teacher.picked);
  mlp_forward(teacher, net(kActor) + teacher_offset(), scratch.teacher.picked, rows, scratch.teacher,
              scratch.taught);
  const size_t count = static_cast<size_t>(rows) * static_cast<size_t>(latent.mlp.out);
  double sum = 0;
  for (size_t i = 0; i < count; ++i) {
    const float gap = scratch.z[i] - scratch.taught[i];
    sum += static_cast<double>(gap) * static_cast<double>(gap);
    scratch.dz[i] = 2 * scale * gap;
  }
  mlp_backward(latent.mlp, net(kActor) + latent_offset(), scratch.latent.picked, rows, scratch.latent,
               scratch.dz, to + std_size + latent_offset());
  std::fill_n(to + std_size + teacher_offset(), teacher.num_params(), 0.0f);
  return sum;
}

// Of all groups, whichever learns: what the others give stays what it is.
void Networks::forward_groups(const float* weights, const float* x, int32_t rows, const ActorScratch& scratch,
                              float* y) const {
  const auto width = static_cast<size_t>(shape[kActor].out);
  for (int32_t i = 0; i < num_groups; ++i) {
    const ActorGroup& g = group[i];
    const MlpScratch& own = scratch.group[i];
    if (g.columns) pick_columns(x, rows, obs_dim, g.columns, g.shape.in, own.picked);
    mlp_forward(g.shape, weights + g.offset, g.columns ? own.picked : x, rows, own, scratch.part);
    spread_outputs(g, scratch.part, rows, width, y);
  }
  if (state_std()) bound_std(rows, y);
}

void Networks::forward_critics(int32_t i, const float* x, int32_t rows, const ActorScratch& scratch,
                               float* y) const {
  for (int32_t k = 0; k < num_critics; ++k) {
    const ActorGroup& g = critic[i][k];
    const MlpScratch& own = scratch.group[k];
    if (g.columns) pick_columns(x, rows, obs_dim, g.columns, g.shape.in, own.picked);
    mlp_forward(g.shape, net(i) + g.offset, g.columns ? own.picked : x, rows, own, scratch.part);
    spread_outputs(g, scratch.part, rows, static_cast<size_t>(shape[i].out), y);
  }
}

void Networks::backward_critics(int32_t i, const float* x, int32_t rows, const ActorScratch& scratch,
                                const float* dy, float* grad) const {
  for (int32_t k = 0; k < num_critics; ++k) {
    const ActorGroup& g = critic[i][k];
    const MlpScratch& own = scratch.group[k];
    gather_outputs(g, dy, rows, static_cast<size_t>(shape[i].out), scratch.part);
    mlp_backward(g.shape, net(i) + g.offset, g.columns ? own.picked : x, rows, own, scratch.part,
                 grad + net_offset(i) + g.offset);
  }
}

void Networks::forward_memory_with(const float* weights, const float* x, const MemorySteps& m,
                                   const ActorScratch& scratch, float* y) const {
  const int32_t rows = m.steps * m.rows;
  if (num_groups) {
    for (int32_t i = 0; i < num_groups; ++i) forward_group_memory(weights, i, x, m, scratch, y);
    if (state_std()) bound_std(rows, y);
    return;
  }
  if (columns[kActor]) pick_columns(x, rows, obs_dim, columns[kActor], shape[kActor].in, scratch.picked);
  recurrent_forward(actor(), weights, seen(kActor, x, scratch), m.steps, m.rows, m.h0, m.clear, scratch,
                    scratch.memory, y);
  if (state_std()) bound_std(rows, y);
}

void Networks::forward_group_memory(const float* weights, int32_t i, const float* x, const MemorySteps& m,
                                    const ActorScratch& scratch, float* y) const {
  const ActorGroup& g = group[i];
  const MlpScratch& own = scratch.group[i];
  const RecurrentScratch& memory = scratch.group_memory[i];
  const int32_t rows = m.steps * m.rows;
  const auto units = static_cast<size_t>(g.gru.units), all = units * static_cast<size_t>(num_groups),
             at = units * static_cast<size_t>(i);
  if (g.columns) pick_columns(x, rows, obs_dim, g.columns, g.shape.in, own.picked);
  take_states(m.h0, all, at, units, m.rows, scratch.part_state);
  recurrent_forward(g.net(), weights + g.offset, g.columns ? own.picked : x, m.steps, m.rows,
                    scratch.part_state, m.clear, own, memory, scratch.part);
  give_states(memory.h, all, at, units, rows, scratch.memory.h);
  spread_outputs(g, scratch.part, rows, static_cast<size_t>(shape[kActor].out), y);
}

void Networks::backward_memory(const float* x, const MemorySteps& m, const ActorScratch& scratch,
                               const float* dy, float* grad) const {
  float* const to = grad + net_offset(kActor);
  if (!num_groups)
    return recurrent_backward(actor(), net(kActor), seen(kActor, x, scratch), m.steps, m.rows, m.clear,
                              scratch, scratch.memory, dy, to);
  for (int32_t i = 0; i < num_groups; ++i) {
    const ActorGroup& g = group[i];
    const MlpScratch& own = scratch.group[i];
    if (!learns(i)) {
      std::fill_n(to + g.offset, g.net().num_params(), 0.0f);
      continue;
    }
    gather_outputs(g, dy, m.steps * m.rows, static_cast<size_t>(shape[kActor].out), scratch.part);
    recurrent_backward(g.net(), net(kActor) + g.offset, g.columns ? own.picked : x, m.steps, m.rows, m.clear,
                       own, scratch.group_memory[i], scratch.part, to + g.offset);
  }
}

void Networks::tangent_memory(const float* direction, const float* x, const MemorySteps& m,
                              const ActorScratch& scratch, float* dy) const {
  if (!num_groups)
    return recurrent_tangent(actor(), net(kActor), direction, seen(kActor, x, scratch), m.steps, m.rows,
                             m.clear, scratch, scratch.memory, dy);
  const int32_t rows = m.steps * m.rows;
  for (int32_t i = 0; i < num_groups; ++i) {
    const ActorGroup& g = group[i];
    const MlpScratch& own = scratch.group[i];
    if (learns(i))
      recurrent_tangent(g.net(), net(kActor) + g.offset, direction + g.offset, g.columns ? own.picked : x,
                        m.steps, m.rows, m.clear, own, scratch.group_memory[i], scratch.part);
    else
      std::fill_n(scratch.part, static_cast<size_t>(rows) * static_cast<size_t>(g.shape.out), 0.0f);
    spread_outputs(g, scratch.part, rows, static_cast<size_t>(shape[kActor].out), dy);
  }
}

void Networks::backward_actor(const float* x, const PointRows& clouds, int32_t rows,
                              const ActorScratch& scratch, const float* dy, float* grad) const {
  for (int32_t i = 0; i < num_groups; ++i) {
    const ActorGroup& g = group[i];
    const MlpScratch& own = scratch.group[i];
    float* const to = grad + net_offset(kActor) + g.offset;
    if (!learns(i)) {
      std::fill_n(to, g.net().num_params(), 0.0f);
      continue;
    }
    gather_outputs(g, dy, rows, static_cast<size_t>(shape[kActor].out), scratch.part);
    mlp_backward(g.shape, net(kActor) + g.offset, g.columns ? own.picked : x, rows, own, scratch.part, to);
  }
  if (num_groups) return;
  if (!latent && !eyes.points) return backward(kActor, x, rows, scratch, dy, grad);
  // Of a student nothing but its encoder learns.
  float* const to = grad + net_offset(kActor);
  if (adapts()) std::fill_n(to, latent_offset(), 0.0f);
  mlp_backward(shape[kActor], net(kActor), scratch.picked, rows, scratch, dy, adapts() ? nullptr : to,
               first_encoded(), !latent && frozen ? nullptr : encoded(scratch));
  split_encoded(rows, scratch);
  if (frozen)
    std::fill_n(to + eyes_offset(), eyes.num_params(), 0.0f);
  else if (eyes.points)
    pointnet_backward(eyes, eyes_net(), clouds, rows, scratch.eyes, features(scratch), feature_step(),
                      scratch.winner, scratch.dfeatures, to + eyes_offset());
  if (latent)
    mlp_backward(latent.mlp, net(kActor) + latent_offset(), scratch.latent.picked, rows, scratch.latent,
                 scratch.dz, to + latent_offset());
  if (adapts()) std::fill_n(to + teacher_offset(), teacher.num_params(), 0.0f);
}

void Networks::tangent_actor(const float* direction, const float* x, const PointRows& clouds, int32_t rows,
                             const ActorScratch& scratch, float* dy) const {
  for (int32_t i = 0; i < num_groups; ++i) {
    const ActorGroup& g = group[i];
    const MlpScratch& own = scratch.group[i];
    if (learns(i))
      mlp_tangent(g.shape, net(kActor) + g.offset, direction + g.offset, g.columns ? own.picked : x, rows,
                  own, scratch.part);
    else
      std::fill_n(scratch.part, static_cast<size_t>(rows) * static_cast<size_t>(g.shape.out), 0.0f);
    spread_outputs(g, scratch.part, rows, static_cast<size_t>(shape[kActor].out), dy);
  }
  if (num_groups) return;
  if (!latent && !eyes.points) return tangent(kActor, direction, x, rows, scratch, dy);
  if (latent)
    mlp_tangent(latent.mlp, net(kActor) + latent_offset(), direction + latent_offset(), scratch.latent.picked,
                rows, scratch.latent, scratch.dz);
  if (eyes.points && !frozen)
    pointnet_tangent(eyes, eyes_net(), direction + eyes_offset(), clouds, rows, scratch.eyes,
                     features(scratch), feature_step(), scratch.winner, scratch.dfeatures);
  join_encoded(rows, scratch);
  mlp_tangent(shape[kActor], net(kActor), direction, scratch.picked, rows, scratch, dy, first_encoded(),
              !latent && frozen ? nullptr : encoded(scratch));
}

void init_networks(const Networks& n, const ResolvedAgentConfig& resolved) {
  for (int32_t i = 0; i < n.count; ++i) {
    Stream stream(resolved.config.seed, static_cast<uint32_t>(i), Purpose::kInit);
    const double last = i == Networks::kActor ? resolved.shared.last_layer_scale : 1;
    for (int32_t k = 0; n.critic[i] && k < n.num_critics; ++k) {
      const auto number =
          static_cast<uint32_t>(k == 0 ? i : static_cast<int32_t>(kCriticsStream) + (i - 1) * kMaxGroups + k);
      Stream own(resolved.config.seed, number, Purpose::kInit);
      mlp_init(n.critic[i][k].shape, own, 1, n.net(i) + n.critic[i][k].offset);
    }
    if (!n.critic[i] && (i > 0 || !n.num_groups))
      recurrent_init({n.shape[i], i == Networks::kActor ? n.gru : GruShape()}, stream,
                     static_cast<float>(last), resolved.memory_chunk(), n.net(i));
  }
  const auto last_scale = static_cast<float>(resolved.shared.last_layer_scale);
  for (int32_t g = 0; g < n.num_groups; ++g) {
    const uint32_t number = g == 0 ? 0 : kGroupsStream + static_cast<uint32_t>(g) - 1;
    Stream stream(resolved.config.seed, number, Purpose::kInit);
    recurrent_init(n.group[g].net(), stream, last_scale, resolved.memory_chunk(),
                   n.net(Networks::kActor) + n.group[g].offset);
  }
  if (n.eyes.points) {
    Stream stream(resolved.config.seed, kEyesStream, Purpose::kInit);
    mlp_init(n.eyes.mlp, stream, 1, n.eyes_net());
  }
  if (n.latent) {
    Stream stream(resolved.config.seed, kLatentStream, Purpose::kInit);
    float* const actor = n.net(Networks::kActor);
    mlp_init(n.adapts() ? n.teacher : n.latent.mlp, stream, 1,
             actor + (n.adapts() ? n.teacher_offset() : n.latent_offset()));
    Stream own(resolved.config.seed, kStudentStream, Purpose::kInit);
    if (n.adapts()) mlp_init(n.latent.mlp, own, 1, actor + n.latent_offset());
  }
  // Of a network whose last layer's biases are these.
  const auto first_actions = [&](float* bias, int32_t first, int32_t count) {
    float* log_std = n.state_std() ? bias + count : n.log_std() + first;
    for (int32_t j = 0; j < count; ++j) {
      bias[j] = resolved.config.initial_mean ? resolved.config.initial_mean[first + j] : 0;
      if (n.squash != Squash::kNone) bias[j] = static_cast<float>(unsquash(static_cast<double>(bias[j])));
      log_std[j] = static_cast<float>(elementary::log(resolved.shared.init_std));
    }
  };
  const auto last_bias = [](const RecurrentShape& s) {
    return s.gru.units ? s.head_offset() + s.head().bias_offset(0) : s.mlp.bias_offset(s.mlp.num_hidden);
  };
  float* const actor = n.net(Networks::kActor);
  if (!n.num_groups) first_actions(actor + last_bias(n.actor()), 0, n.action_dim);
  for (int32_t i = 0; i < n.num_groups; ++i) {
    const ActorGroup& g = n.group[i];
    first_actions(actor + g.offset + last_bias(g.net()), g.first, g.count);
  }
}

void average_actor(const Networks& n) {
  if (!n.average) return;
  const auto count = static_cast<double>(++*n.averaged);
  const auto share = static_cast<float>(std::max(1 - n.average_share, 1 / count));
  const size_t size = n.block[Networks::kActor].size;
  for (size_t j = 0; j < size; ++j) n.average[j] += share * (n.params[j] - n.average[j]);
}

void restart_average(const Networks& n) {
  if (!n.average) return;
  *n.averaged = 0;
  std::copy_n(n.params, n.block[Networks::kActor].size, n.average);
}

void begin_average(const Networks& n) {
  if (n.average && *n.averaged == 0) restart_average(n);
}

void restart_steps(Networks& n) {
  n.block[Networks::kActor].adam.t = 0;
  std::fill_n(n.group_steps, n.num_groups, int64_t{0});
}

void keep_actor(const Networks& n) {
  std::copy_n(n.params, n.block[Networks::kActor].size, n.before);
}

void restore_actor(const Networks& n) {
  std::copy_n(n.before, n.block[Networks::kActor].size, n.params);
}

void clamp_log_std(const Networks& n) {
  if (n.state_std()) return;
  for (float* x : {n.log_std(), n.average})
    for (int32_t j = 0; x && j < n.action_dim; ++j) x[j] = std::clamp(x[j], n.std_low, n.std_high);
}

void Networks::bound_std(int32_t rows, float* y) const {
  const auto out = static_cast<size_t>(shape[kActor].out);
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i)
    for (size_t j = out / 2; j < out; ++j) {
      float& l = y[i * out + j];
      l = std::clamp(l, std_low, std_high) + log_share;
    }
}

void Networks::gate_std(const float* y, int32_t rows, float* dy) const {
  const float low = std_low + log_share, high = std_high + log_share;
  const auto out = static_cast<size_t>(shape[kActor].out);
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i)
    for (size_t j = out / 2; j < out; ++j)
      if (!(y[i * out + j] > low && y[i * out + j] < high)) dy[i * out + j] = 0;
}

void schedule_std(const Networks& n, const SharedOptions& o, int32_t done) {
  if (!o.linear_std) return;
  const double left = std::max(0.0, 1 - static_cast<double>(done) / o.total_epochs);
  const double std = o.std_min + (o.init_std - o.std_min) * left;
  for (int32_t j = 0; j < n.action_dim; ++j) n.log_std()[j] = static_cast<float>(elementary::log(std));
}

int32_t Networks::num_tensors() const {
  int32_t tensors = state_std() ? 0 : 1;
  for (int32_t g = 0; g < num_groups; ++g) tensors += 2 * group[g].shape.num_layers();
  for (int32_t i = num_groups ? 1 : 0; i < count; ++i)
    tensors += 2 * shape[i].num_layers() * (i ? num_critics : 1);
  return tensors + (gru.units ? kGruTensors * std::max(num_groups, 1) : 0) +
         (eyes.points ? 2 * eyes.mlp.num_layers() : 0) + (latent ? 2 * latent.mlp.num_layers() : 0) +
         (adapts() ? 2 * teacher.num_layers() : 0);
}

void Networks::visit(StateIo& io) {
  // Bound on what the actor's network sees, its features too.
  const auto input_of = [&](const StateView<float>& p, size_t at) {
    double most = input_bound;
    if (latent) most = std::max(most, mlp_bound(latent.mlp, From{p, at + latent_offset()}, input_bound));
    if (eyes.points)
      most = std::max(most, mlp_bound(eyes.mlp, From{p, at + eyes_offset()}, largest_point(eyes)));
    return most;
  };
  io.section("NETS");
  const StateView<float> p = io.numbers(params, size, -kMaxOutput, kMaxOutput);
  // Bound on what the actor gives, whose networks begin at `at`.
  const auto actor_bound = [&](const StateView<float>& list, size_t at) {
    double most = adapts() ? mlp_bound(teacher, From{list, at + teacher_offset()}, input_bound) : 0;
    if (!num_groups) return std::max(most, recurrent_bound(actor(), From{list, at}, input_of(list, at)));
    for (int32_t g = 0; g < num_groups; ++g)
      most = std::max(most, recurrent_bound(group[g].net(), From{list, at + group[g].offset}, input_bound));
    return most;
  };
  const auto critic_bound = [&](int32_t i) {
    if (!critic[i]) return mlp_bound(shape[i], From{p, net_offset(i)}, input_bound);
    double most = 0;
    for (int32_t k = 0; k < num_critics; ++k)
      most = std::max(
          most, mlp_bound(critic[i][k].shape, From{p, net_offset(i) + critic[i][k].offset}, input_bound));
    return most;
  };
  for (int32_t i = 0; p && i < count; ++i)
    io.require((i == kActor ? actor_bound(p, std_size) : critic_bound(i)) <= kMaxOutput,
               "a network whose outputs may be too large");
  if (average) {
    io.section("MEAN");
    io.counter(*averaged);
    const StateView<float> a = io.numbers(average, block[kActor].size, -kMaxOutput, kMaxOutput);
    if (a) io.require(actor_bound(a, std_size) <= kMaxOutput, "an average whose outputs may be too large");
  }
  io.section("ADAM");
  for (int32_t i = 0; i < count; ++i) {
    Adam& a = block[i].adam;
    io.counter(a.t);
    const StateView<float> m = io.numbers(a.m, a.size, -1e20, 1e20), v = io.numbers(a.v, a.size, 0, 1e38);
    if (m) io.require(moments_agree(m, v, a.size), "moments that no gradients can give");
  }
  if (num_groups) io.section("GRPS");
  for (int32_t g = 0; g < num_groups; ++g) io.counter(group_steps[g]);
  for (int32_t i = kReward; i < count; ++i)
    for (int32_t k = 0; critic[i] && k < num_critics; ++k) io.counter(critic_steps[i][k]);
}

bool find_tensor(const Networks& n, int32_t index, char* name, TensorInfo* out) {
  if (index < 0) return false;
  const auto set = [&](int32_t rows, int32_t cols, float* data) {
    *out = {name, rows, cols, data};
    return true;
  };
  const auto layer = [&](const char* net, const RecurrentShape& shape, float* params) {
    const MlpShape& s = shape.mlp;
    const int32_t l = index / 2;
    const bool weight = index % 2 == 0;
    std::snprintf(name, kTensorNameSize, "%s.%d.%s", net, l, weight ? "weight" : "bias");
    if (shape.gru.units && l == s.num_hidden) {
      const MlpShape head = shape.head();
      return set(head.out, weight ? head.in : 1,
                 params + shape.head_offset() + (weight ? 0 : head.bias_offset(0)));
    }
    return set(s.layer_out(l), weight ? s.layer_in(l) : 1,
               params + (weight ? s.weight_offset(l) : s.bias_offset(l)));
  };
  if (!n.state_std() && index-- == 0) {
    std::snprintf(name, kTensorNameSize, "actor.log_std");
    return set(n.action_dim, 1, n.log_std());
  }
  const auto in_groups = [&](int32_t i, const ActorGroup* groups, int32_t count) {
    for (int32_t g = 0; g < count; ++g) {
      const MlpShape& s = groups[g].shape;
      const int32_t tensors = 2 * s.num_layers();
      if (index < tensors) {
        char net[kGroupNameSize + 16];
        std::snprintf(net, sizeof net, "%s.%s", kNames[i], groups[g].name);
        return layer(net, groups[g].net(), n.net(i) + groups[g].offset);
      }
      index -= tensors;
    }
    return false;
  };
  if (in_groups(Networks::kActor, n.group, n.num_groups)) return true;
  for (int32_t i = n.num_groups ? 1 : 0; i < n.count; ++i) {
    if (n.critic[i]) {
      if (in_groups(i, n.critic[i], n.num_critics)) return true;
      continue;
    }
    const MlpShape& s = n.shape[i];
    const int32_t tensors = 2 * s.num_layers();
    if (index >= tensors) {
      index -= tensors;
      continue;
    }
    return layer(kNames[i], {s, i == Networks::kActor ? n.gru : GruShape()}, n.net(i));
  }
  const auto gru = [&](const RecurrentShape& shape, const char* dot, const char* owner, float* params) {
    const GruShape& g = shape.gru;
    const size_t offset[] = {0, g.input_bias_offset(), g.state_offset(), g.state_bias_offset()};
    const int32_t cols[] = {g.in, 1, g.units, 1};
    std::snprintf(name, kTensorNameSize, "memory%s%s.%s", dot, owner, kGruNames[index]);
    return set(3 * g.units, cols[index], params + shape.gru_offset() + offset[index]);
  };
  float* const actor = n.net(Networks::kActor);
  for (int32_t g = 0; n.gru.units && g < n.num_groups; ++g, index -= kGruTensors)
    if (index < kGruTensors) return gru(n.group[g].net(), ".", n.group[g].name, actor + n.group[g].offset);
  if (n.gru.units && !n.num_groups && index < kGruTensors) return gru(n.actor(), "", "", actor);
  if (n.eyes.points && index < 2 * n.eyes.mlp.num_layers())
    return layer("encoder", {n.eyes.mlp, GruShape()}, n.eyes_net());
  if (const int32_t tensors = n.latent ? 2 * n.latent.mlp.num_layers() : 0; tensors > 0) {
    if (index < tensors) return layer("latent", {n.latent.mlp, GruShape()}, actor + n.latent_offset());
    index -= tensors;
  }
  if (n.adapts() && index < 2 * n.teacher.num_layers())
    return layer("teacher", {n.teacher, GruShape()}, actor + n.teacher_offset());
  return false;
}

}  // namespace rdm
