// Ranks for tests: threads of one process that meet, and worlds of noise of which each has its part.
#pragma once
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "agents.hpp"
#include "algos/core/ranks.hpp"

namespace rdm::test {

// Where the threads of a learner with ranks exchange messages. One that has left makes every exchange fail.
class Meeting {
 public:
  explicit Meeting(int32_t ranks, bool with_swap = false) : places_(size_of(ranks)), swap_(with_swap) {
    for (int32_t r = 0; r < ranks; ++r) places_[size_of(r)] = {this, r};
  }
  RankHooks hooks(int32_t rank) {
    RankHooks h;
    h.rank = rank, h.count = static_cast<int32_t>(places_.size());
    h.user = &places_[size_of(rank)];
    h.gather = [](void* user, const void* mine, size_t bytes, void* all) {
      const Place& p = *static_cast<Place*>(user);
      return p.meeting->gather(p.rank, mine, bytes, all);
    };
    if (swap_)
      h.swap = [](void* user, int32_t partner, const void* mine, size_t bytes, void* theirs) {
        const Place& p = *static_cast<Place*>(user);
        return p.meeting->swap(p.rank, partner, mine, bytes, theirs);
      };
    return h;
  }
  void leave() {
    const std::lock_guard lock(mutex_);
    left_ = true;
    change_.notify_all();
  }
  // After all threads have ended: exchanges go through again.
  void heal() { left_ = false, arrived_ = 0; }
  int32_t swaps() const { return swaps_; }

 private:
  struct Place {
    Meeting* meeting = nullptr;
    int32_t rank = 0;
    const void* mine = nullptr;
  };
  int32_t gather(int32_t rank, const void* mine, size_t bytes, void* all) {
    std::unique_lock lock(mutex_);
    if (left_) return 7;
    places_[size_of(rank)].mine = mine;
    if (!wait_for_all(lock)) return 7;
    for (size_t r = 0; r < places_.size(); ++r)
      std::memcpy(static_cast<unsigned char*>(all) + r * bytes, places_[r].mine, bytes);
    return wait_for_all(lock) ? 0 : 7;
  }
  // All meet, as every rank swaps with one at each step.
  int32_t swap(int32_t rank, int32_t partner, const void* mine, size_t bytes, void* theirs) {
    std::unique_lock lock(mutex_);
    if (left_) return 7;
    places_[size_of(rank)].mine = mine;
    if (!wait_for_all(lock)) return 7;
    std::memcpy(theirs, places_[size_of(partner)].mine, bytes);
    swaps_ += rank == 0;
    return wait_for_all(lock) ? 0 : 7;
  }
  bool wait_for_all(std::unique_lock<std::mutex>& lock) {
    const int64_t round = round_;
    if (++arrived_ == static_cast<int32_t>(places_.size())) {
      arrived_ = 0, ++round_;
      change_.notify_all();
    }
    change_.wait(lock, [&] { return round_ != round || left_; });
    return round_ != round;
  }
  std::vector<Place> places_;
  bool swap_, left_ = false;
  std::mutex mutex_;
  std::condition_variable change_;
  int32_t arrived_ = 0, swaps_ = 0;
  int64_t round_ = 0;
};

// body(rank) on a thread for each rank.
template <class Body>
void each_rank(int32_t ranks, Body&& body) {
  std::vector<std::thread> threads;
  for (int32_t r = 0; r < ranks; ++r) threads.emplace_back([&body, r] { body(r); });
  for (std::thread& t : threads) t.join();
}

// A rank's part of a world of noise that has the environments of all.
class NoisePart {
 public:
  NoisePart(const AgentConfig& part, uint64_t seed = 1)
      : world_(whole(part), seed),
        first_(size_of(part.ranks.rank) * size_of(part.num_envs)),
        obs_dim_(size_of(part.obs_dim)),
        cost_dim_(size_of(part.cost_dim)),
        action_(size_of(part.num_envs) * size_of(part.action_dim)) {}
  void decide(Agent& a) {
    a.act(obs(), true, action_.data());
    world_.draw();
    a.record(transition());
  }
  void epoch(Agent& a, Epoch* out = nullptr) {
    while (a.missing() > 0) decide(a);
    a.update(obs(), out);
  }
  const float* obs() const { return world_.obs() + first_ * obs_dim_; }
  void skip() { world_.draw(); }  // a decision that nobody sees

 private:
  static AgentConfig whole(AgentConfig c) {
    c.num_envs *= c.ranks.count;
    return c;
  }
  Transition transition() const {
    Transition t = world_.transition();
    t.reward += first_, t.cost += first_ * cost_dim_, t.final_obs += first_ * obs_dim_;
    t.terminated += first_, t.truncated += first_, t.success += first_, t.valid += first_;
    return t;
  }
  NoiseWorld world_;
  size_t first_, obs_dim_, cost_dim_;
  std::vector<float> action_;
};

// Sums for one process alone, over so many blocks of environments.
struct AloneRanks {
  explicit AloneRanks(int32_t envs, int32_t blocks = 1) {
    AgentSetup s("ppo", 1, 1, envs);
    const std::string count = std::to_string(blocks);  // the setup keeps the pointer
    s.with("blocks", count.c_str());
    const ResolvedAgentConfig resolved = resolve_config(s.ready());
    Arena measure;
    ranks.carve(measure, resolved, 1);
    arena = Arena(HostHooks{}, measure.used());
    ranks.carve(arena, resolved, 1);
  }
  Arena arena;
  Ranks ranks;
};

}  // namespace rdm::test
