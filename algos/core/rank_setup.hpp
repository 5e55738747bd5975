// What ranks of one learner must have been set up with alike: words that all of them exchange before anything
// else, so that a seed, a size or an option that differs on one of them is named and not learned from.
#pragma once
#include "algos/core/resolved_config.hpp"
#include "base/arena.hpp"

namespace rdm {

class RankSetup {
 public:
  void carve(Arena& arena, const ResolvedAgentConfig& resolved);
  // Of the pool that a rollout steps; without one its words are 0.
  void set_pool(uint64_t seed, int32_t autoreset, uint64_t options);

  // The same for any setup.
  static constexpr size_t kBytes = 192 * sizeof(uint64_t);
  const void* mine() const { return mine_; }
  void* all() const { return all_; }
  // Error(kState) for the first word that a rank has otherwise than rank 0, or a rank at another's place.
  void compare() const;

 private:
  static constexpr size_t kMost = kBytes / sizeof(uint64_t);
  struct Word {
    const char *kind, *name;
    bool number;  // shown, not only compared
  };
  void add(const char* kind, const char* name, uint64_t value, bool number);
  const uint64_t* of(int32_t rank) const { return all_ + static_cast<size_t>(rank) * kMost; }

  int32_t count_ = 1;
  size_t words_ = 0, pool_ = 0;
  Word* word_ = nullptr;                       // [kMost]
  uint64_t *mine_ = nullptr, *all_ = nullptr;  // [kMost], [ranks][kMost]
};

}  // namespace rdm
