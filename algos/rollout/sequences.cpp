#include "algos/rollout/sequences.hpp"

#include <algorithm>
#include <cstring>

#include "base/shuffle.hpp"

namespace rdm {

MemorySteps gather_sequences(const Rollout& r, const int32_t* order, int32_t n, Workspace& workspace,
                             int32_t stride) {
  SequenceSpace& s = workspace.sequences;
  const auto listed = [&](int32_t i) { return order[i * stride]; };
  const auto number = [&](int32_t row) { return row / r.num_envs / r.path * r.num_envs + row % r.num_envs; };
  s.count = s.steps = 0;
  for (int32_t i = 0; i < n; ++i) {
    const int32_t t = listed(i) / r.num_envs, env = listed(i) % r.num_envs;
    const bool next = i == 0 || number(listed(i)) != number(listed(i - 1));
    if (next) s.env[s.count] = env, s.begin[s.count++] = t / r.path * r.path;
    const int32_t q = s.count - 1;
    s.last[q] = t;
    s.place[i] = q;  // its step is known, the number of sequences is not yet
    s.steps = std::max(s.steps, t - s.begin[q] + 1);
  }
  for (int32_t i = 0; i < n; ++i) s.place[i] += (listed(i) / r.num_envs - s.begin[s.place[i]]) * s.count;
  const auto units = static_cast<size_t>(r.units), dim = r.obs_dim, count = static_cast<size_t>(s.count);
  for (size_t q = 0; q < count; ++q) {
    const size_t path = static_cast<size_t>(s.begin[q] / r.path);
    const size_t kept = path * static_cast<size_t>(r.num_envs) + static_cast<size_t>(s.env[q]);
    std::memcpy(s.h0 + q * units, r.state + kept * units, units * sizeof(float));
  }
  for (int32_t step = 0; step < s.steps; ++step)
    for (size_t q = 0; q < count; ++q) {
      const size_t at = static_cast<size_t>(step) * count + q;
      float* x = workspace.obs + at * dim;
      const int32_t t = s.begin[q] + step;
      if (t > s.last[q]) {
        std::memset(x, 0, dim * sizeof(float));
        s.clear[at] = 0;
        continue;
      }
      const size_t row = r.row(t) + static_cast<size_t>(s.env[q]);
      std::memcpy(x, r.obs + row * dim, dim * sizeof(float));
      s.clear[at] = r.age[row] == 0;
    }
  return {s.steps, s.count, s.h0, s.clear};
}

void take_outputs(const SequenceSpace& s, int32_t n, size_t width, float* out) {
  for (size_t i = 0; i < static_cast<size_t>(n); ++i)
    std::memcpy(out + i * width, s.out + static_cast<size_t>(s.place[i]) * width, width * sizeof(float));
}

void give_gradients(const SequenceSpace& s, int32_t n, size_t width, const float* dout) {
  const size_t steps = static_cast<size_t>(s.steps) * static_cast<size_t>(s.count);
  std::memset(s.dout, 0, steps * width * sizeof(float));
  for (size_t i = 0; i < static_cast<size_t>(n); ++i)
    std::memcpy(s.dout + static_cast<size_t>(s.place[i]) * width, dout + i * width, width * sizeof(float));
}

void restart_sequences(const Rollout& r, int32_t first, int32_t count) {
  int32_t at = first * r.paths();
  for (int32_t path = 0; path < r.paths(); ++path)
    for (int32_t env = first; env < first + count; ++env) r.sequence[at++] = path * r.num_envs + env;
}

int32_t list_sequences(const Rollout& r, int32_t first, int32_t count, int32_t at, Stream* shuffled) {
  int32_t* const sequence = r.sequence + static_cast<size_t>(first) * static_cast<size_t>(r.paths());
  const int32_t sequences = count * r.paths(), begin = at;
  if (shuffled) shuffle(*shuffled, sequence, sequences);
  for (int32_t i = 0; i < sequences; ++i) {
    const int32_t from = sequence[i] / r.num_envs * r.path, env = sequence[i] % r.num_envs;
    for (int32_t t = from; t < std::min(from + r.path, r.horizon); ++t)
      if (const int32_t row = t * r.num_envs + env; r.valid[row]) r.order[at++] = row;
  }
  return at - begin;
}

}  // namespace rdm
