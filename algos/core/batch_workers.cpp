#include "algos/core/batch_workers.hpp"

#include <cmath>

namespace rdm {
namespace {

// Scratch for `wide` also serves `narrow`.
bool covers(const MlpShape& wide, const MlpShape& narrow) {
  if (wide.num_hidden != narrow.num_hidden || wide.out < narrow.out || wide.in < narrow.in) return false;
  for (int32_t l = 0; l < wide.num_hidden; ++l)
    if (wide.hidden[l] < narrow.hidden[l]) return false;
  return true;
}

// Of a chunk: whole ones, and two that it cuts.
int32_t most_sequences(const ResolvedAgentConfig& resolved) {
  return resolved.gru.units ? resolved.chunk_rows / resolved.memory_chunk() + 2 : 0;
}

SequenceSpace carve_sequences(Arena& arena, const ResolvedAgentConfig& resolved) {
  SequenceSpace s;
  s.most = most_sequences(resolved);
  const auto n = static_cast<size_t>(s.most), steps = n * static_cast<size_t>(resolved.memory_chunk());
  for (int32_t** list : {&s.env, &s.begin, &s.last}) *list = arena.make<int32_t>(n);
  s.place = arena.make<int32_t>(n ? static_cast<size_t>(resolved.chunk_rows) : 0);
  s.clear = arena.make<uint8_t>(steps);
  s.h0 = arena.make<float>(n * static_cast<size_t>(resolved.state_units()));
  s.out = arena.make<float>(steps * static_cast<size_t>(resolved.actor.out));
  s.dout = arena.make<float>(steps * static_cast<size_t>(resolved.actor.out));
  return s;
}

// How many of the next rows of a list of `left` ones, at most `limit`, make a chunk of whole sequences, or of a part
// of one that is too long; every stride-th entry is a row.
int32_t whole_sequences(const Batch& batch, const int32_t* order, int32_t stride, int32_t left, int32_t limit,
                        int32_t most) {
  const auto sequence = [&](int32_t i) {
    const int32_t row = order[i * stride];
    return row / batch.envs / batch.path * batch.envs + row % batch.envs;
  };
  int32_t boundary = 0, count = 1;
  for (int32_t i = 1; i < left; ++i) {
    const bool next = sequence(i) != sequence(i - 1);
    if (next && (i == limit || count == most)) return i;
    if (i == limit) return boundary > 0 ? boundary : limit;
    if (next) boundary = i, ++count;
  }
  return left;
}

Workspace carve_workspace(Arena& arena, const ResolvedAgentConfig& resolved, size_t num_params) {
  Workspace workspace;
  workspace.rows = resolved.chunk_rows;
  const auto rows = static_cast<size_t>(workspace.rows);
  const auto widest = static_cast<size_t>(
      std::max({resolved.actor.out, resolved.cost_critic.out, resolved.reward_critic.out}));
  workspace.sequences = carve_sequences(arena, resolved);
  const int32_t steps = workspace.sequences.most * resolved.memory_chunk();
  const int32_t acting = std::max(workspace.rows, steps);
  workspace.actor = carve_actor_scratch(arena, resolved, acting);
  if (!resolved.cost_critics.empty()) {
    workspace.critic = carve_group_scratch(arena, resolved.cost_critics, workspace.rows);
  } else {
    static_cast<MlpScratch&>(workspace.critic) =
        resolved.groups.empty() && covers(resolved.actor, resolved.cost_critic)
            ? workspace.actor
            : carve_mlp_scratch(arena, resolved.cost_critic, workspace.rows);
    const size_t picked = resolved.critic_columns.size();
    workspace.critic.picked = picked ? arena.make<float>(rows * picked) : nullptr;
  }
  workspace.obs = arena.make<float>(static_cast<size_t>(acting) * resolved.seen_dim());
  workspace.out = arena.make<float>(rows * widest);
  workspace.dout = arena.make<float>(rows * widest);
  workspace.grad = arena.make<float>(num_params);
  return workspace;
}

}  // namespace

bool Surrogate::finite() const {
  double sum = gain + kl;
  for (const double c : cost) sum += c;
  return std::isfinite(sum);
}

void BatchWorkers::reduce(int32_t group, int32_t n, float* total, size_t begin, size_t end) {
  const int32_t from = group == 0 ? 1 : 0;
  if (from >= n) return;
  ranges(begin, end, [&](size_t low, size_t high) {
    for (int32_t l = from; l < n; ++l) {
      const float* part = workspaces_[l].grad;
      for (size_t i = low; i < high; ++i) total[i] += part[i];
    }
  });
}

Surrogate& Surrogate::operator+=(const Surrogate& b) {
  gain += b.gain, kl += b.kl;
  for (size_t k = 0; k < kMaxCosts; ++k) cost[k] += b.cost[k];
  return *this;
}

// Nodes of the tree that wait for a neighbour stand one behind the other: the first in total.
int32_t BatchWorkers::add_group(int32_t n, int32_t blocks, float* total, size_t low, size_t high,
                                int32_t depth) const {
  const auto node = [&](int32_t d) {
    return d == 0 ? total : nodes_ + static_cast<size_t>(d - 1) * num_params_;
  };
  const auto add = [&](float* to, const float* part) {
    for (size_t i = low; i < high; ++i) to[i] += part[i];
  };
  for (int32_t l = 0; l < n; ++l) {
    const Chunk& chunk = workspaces_[l].chunk;
    const float* part = workspaces_[l].grad;
    if (!chunk.begins)
      add(node(depth - 1), part);
    else if (chunk.block > 0)
      std::copy(part + low, part + high, node(depth) + low);
    depth += chunk.begins;
    if (!chunk.ends) continue;
    const bool last = chunk.block == blocks - 1;
    for (int32_t done = chunk.block + 1; depth > 1 && (last || done % 2 == 0); done /= 2, --depth)
      add(node(depth - 2), node(depth - 1));
  }
  return depth;
}

void BatchWorkers::reduce(Sweep& sweep, float* total, size_t begin, size_t end) {
  const int32_t n = sweep.chunks, blocks = sweep.batch.blocks;
  ranges(begin, end, [&](size_t low, size_t high) { add_group(n, blocks, total, low, high, sweep.depth); });
  sweep.depth = add_group(n, blocks, total, 0, 0, sweep.depth);
}

void BatchWorkers::cut(Sweep& s, int32_t chunk_rows) {
  for (s.chunks = 0; s.chunks < count_ && !s.over(); ++s.chunks) {
    const Segment segment = s.batch.segment(s.block);
    const int32_t rows = (segment.rows + s.stride - 1) / s.stride;
    const int32_t* first = s.batch.order + segment.first + s.done * s.stride;
    int32_t here = std::min(chunk_rows, rows - s.done);
    if (s.batch.path && here > 0)
      here = whole_sequences(s.batch, first, s.stride, rows - s.done, here, most_sequences_);
    const bool ends = s.done + here == rows;
    workspaces_[s.chunks].chunk = {s.block, first, here, s.done == 0, ends};
    s.done = ends ? 0 : s.done + here;
    s.block += ends;
  }
}

void BatchWorkers::carve(Arena& arena, const ResolvedAgentConfig& resolved, size_t num_params) {
  ranks_.carve(arena, resolved, num_params);
  num_params_ = num_params;
  size_t levels = 0;
  while ((1 << levels) < resolved.blocks) ++levels;
  nodes_ = arena.make<float>(levels * num_params);
  count_ = resolved.workers;
  most_sequences_ = most_sequences(resolved);
  workspaces_ = arena.make<Workspace>(static_cast<size_t>(count_));
  for (int32_t i = 0; i < count_; ++i) {
    const Workspace workspace = carve_workspace(arena, resolved, num_params);
    if (workspaces_) workspaces_[i] = workspace;
  }
}

}  // namespace rdm
