// Who plays the episodes of a data set: a mixture that covers both sides of a cost limit.
//
// Forty places in a fixed list, each a source; episode e has place (17 e) mod 40, so that any forty neighbours have the
// whole list, and policies take turns by forties. A source is a policy with what is done to its action a:
//
//   a' = clip(gain a + drift + std n)       drift: drawn once an episode; n: of each decision,
//                                           n' = keep n + sqrt(1 - keep^2) e
//
// or no policy at all. Numbers are drawn from (seed, episode) by integers alone: no machine's mathematics is in them.
#pragma once
#include <cstdint>
#include <vector>

namespace tool {

enum class Base { kPolicy, kZero, kHold, kUniform };

struct Source {
  const char* name;
  int32_t places;  // of forty
  Base base;
  float gain, drift, std, keep, fresh;  // fresh = sqrt(1 - keep^2)
};

inline constexpr uint64_t kPlaces = 40;
// What a task with a policy is played by, and one without.
const std::vector<Source>& mixture_of(bool has_policy);
// The source of an episode, and which of so many policies plays it.
size_t source_of(const std::vector<Source>& mixture, uint64_t episode);
size_t policy_of(uint64_t episode, size_t policies);

// What is drawn for one episode.
class EpisodeNoise {
 public:
  void begin(uint64_t seed, uint64_t episode, const Source& source, size_t width);
  // row [width]: the base's action; label gets what was meant, row what is done.
  void apply(float* row, float* label);

 private:
  uint64_t bits();
  float normal();   // mean 0, deviation 1, within 6
  float uniform();  // -1 .. 1
  uint64_t counter_ = 0;
  Source source_{};
  std::vector<float> drift_, noise_;
};

}  // namespace tool
