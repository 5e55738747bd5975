// A pool of worlds that others are copied into, to try out what would come of actions.
#pragma once
#include "env/pool.hpp"

namespace rdm {

// Of the task and options of `of`, so that Pool::copy takes its worlds; without autoreset, and without pictures
// or points: what is tried out is judged by rewards and costs. num_threads 0: as many as `of` has.
Pool* make_copies(const Pool& of, int32_t num_envs, int32_t num_threads, const HostHooks& hooks);

}  // namespace rdm
