// Where a world was when a decision was last looked at, for those who remember its decisions.
//
// It tells episodes apart by what a pool's saved states keep (Pool::episode_mark), so it is good in every autoreset
// mode and goes on after a restore. Pool::course would not do: it is of a process, and set_joints changes it, after
// which the episode goes on.
#pragma once
#include "env/pool.hpp"

namespace rdm {

struct Moment {
  uint64_t episode = 0;  // its mark
  int32_t step = -1;     // control step; -1: there was none
};

enum class Passed : uint8_t { kNothing, kSteps, kEpisode };  // the same decision, later ones, another episode

inline Passed passed_since(const Moment& m, const Pool& pool, int32_t env) {
  const int32_t step = pool.episode_step(env);
  if (m.step < 0 || step < m.step || pool.episode_mark(env) != m.episode) return Passed::kEpisode;
  return step > m.step ? Passed::kSteps : Passed::kNothing;
}

inline Moment moment_of(const Pool& pool, int32_t env) {
  return {pool.episode_mark(env), pool.episode_step(env)};
}

}  // namespace rdm
