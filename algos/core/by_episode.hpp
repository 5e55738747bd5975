// The order of a recording's rows by episode, and by time within one: worlds that stepped together stand in turn in it.
#pragma once
#include <cstdint>

namespace rdm {

// Compares rows by their numbers; episode_of(row) is the number of a row's episode.
template <class EpisodeOf>
auto by_episode(EpisodeOf episode_of) {
  return [episode_of](int32_t a, int32_t b) {
    const int64_t one = episode_of(a), other = episode_of(b);
    return one != other ? one < other : a < b;
  };
}

}  // namespace rdm
