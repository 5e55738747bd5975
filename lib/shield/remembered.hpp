// What a backup with a memory remembers: of the worlds, and of the copies in which ways to go on are tried.
//
// Whose state is it? A state hangs on the observations of the decisions so far, and on nothing else: not on what was
// done, and not on who proposed it. A shield is asked at each decision and sees each of these observations. So it keeps
// the states of its backups itself, and they equal those of an actor that plays by the same policy, to the bit, as
// long as both see each decision. The other way, a state that a caller hands in with each call, was decided against:
// every host would have to have it (an rdm_actor and an agent's rollout keep theirs to themselves), a backup that is not
// the acting policy has a state that nobody else has, and a caller that hands in the wrong one is not noticed. Nothing
// that is proven hangs on a state: a plan is actions that were run in a copy. With a state that is none of the
// world's the backup is a worse one, and no more.
//
// The state before a world's present decision is `before`, that behind it `after`, which has seen what the world shows
// now. Copies begin with `before`, as the backup may be asked in the place of what is proposed; whoever decides in a
// copy, a backup that may yet be asked sees what the copy shows.
#pragma once
#include <algorithm>
#include <iterator>

#include "base/arena.hpp"
#include "base/error.hpp"
#include "env/mean_policy.hpp"

namespace rdm {

class Remembered {
 public:
  // Of so many worlds, copies that try first ways, kept states of these, and branches; dim 0: nothing. What there was
  // is forgotten; on errors it stays.
  void make(const HostHooks& hooks, int32_t dim, int32_t worlds, int32_t ways, int32_t kept,
            int32_t branches) {
    constexpr int64_t kMostNumbers = int64_t{1} << 28;
    if (int64_t{dim} * std::max(kept, branches) > kMostNumbers)
      fail(Code::kRange, "shield: its copies with memories of %d numbers each need too much memory", dim);
    const int32_t rows[] = {worlds, worlds, ways, kept, branches, branches};
    float** const states[] = {&before, &after, &way, &keep, &branch, &asked};
    const auto count = [&](size_t i) { return static_cast<size_t>(rows[i]) * static_cast<size_t>(dim); };
    Arena measure;
    for (size_t i = 0; i < std::size(rows); ++i) measure.make<float>(count(i));
    arena_ = dim > 0 ? Arena(hooks, measure.used()) : Arena();
    dim_ = dim;
    for (size_t i = 0; i < std::size(rows); ++i) *states[i] = arena_.make<float>(count(i));
  }
  explicit operator bool() const { return dim_ > 0; }
  int32_t dim() const { return dim_; }
  size_t size(int32_t rows) const { return static_cast<size_t>(rows) * static_cast<size_t>(dim_); }
  float* row(float* states, int32_t i) const {
    return states + static_cast<size_t>(i) * static_cast<size_t>(dim_);
  }
  void copy(float* to, int32_t i, float* from, int32_t source) const {
    std::copy_n(row(from, source), dim_, row(to, i));
  }
  void clear(float* states, int32_t i) const { std::fill_n(row(states, i), dim_, 0.0f); }
  // A row that was asked about becomes a state, if it is one.
  void take(float* states, int32_t i, int32_t at) const {
    if (sound_state(row(asked, at), dim_)) copy(states, i, asked, at);
  }

  // States, rows of dim(): of the worlds, before and behind their last decisions; of copies on first ways, now and
  // before each decision of a first way; of branches; and those that a policy is asked about together.
  float *before = nullptr, *after = nullptr, *way = nullptr, *keep = nullptr, *branch = nullptr,
        *asked = nullptr;

 private:
  int32_t dim_ = 0;
  Arena arena_;
};

}  // namespace rdm
