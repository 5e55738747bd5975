// The replay memory: what stands behind a row, what is drawn, and what a saved ring is.
#include <algorithm>
#include <map>

#include "agents.hpp"
#include "algos/off_policy/replay.hpp"

namespace rdm::test {
namespace {

struct Memory {
  AgentSetup setup;
  ResolvedAgentConfig resolved;
  Replay replay;
  Arena arena;
  Memory(int32_t envs, int64_t rows)
      : setup("td3_lag", 2, 1, envs, {{"cost_limit", "1", 0}}), resolved(resolve_config(setup.ready())) {
    Arena measure;
    replay.carve(measure, resolved, rows);
    arena = Arena(HostHooks(), measure.used());
    replay.carve(arena, resolved, rows);
    replay.open(resolved);
  }
  // A row that says who it is: decision `number` of env.
  void push(int32_t env, float number, float discount = 0.9f) {
    const float obs[] = {static_cast<float>(env), number}, action = -0.5f, cost = number / 2;
    replay.push(env, {obs, &action, number, &cost, discount});
  }
  void follow(int32_t env, float number) {
    const float obs[] = {static_cast<float>(env), number};
    replay.follow(env, obs);
  }
  void end(int32_t env, float number) {
    const float obs[] = {static_cast<float>(env), number};
    replay.end(env, obs);
  }
  std::vector<int32_t> drawable() const {
    std::vector<int32_t> list;
    for (int32_t i = 0; i < replay.capacity(); ++i)
      if (replay.drawable(i)) list.push_back(i);
    return list;
  }
};

}  // namespace

// Of every row that can be drawn, through wraps, ends, time limits and gaps, the next observation is the one that was.
TEST(Replay, WhatStandsBehindARowIsWhatFollowed) {
  for (const int64_t capacity : {5, 8, 30, 1000}) {
    Memory m(3, capacity);
    Stream stream(1, 0, Purpose::kTest);
    std::map<std::pair<float, float>, float> next;  // of env and number
    float number = 0;
    for (int horizon = 0; horizon < 40; ++horizon) {
      for (int32_t env = 0; env < 3; ++env) {
        for (int t = 0; t < 4; ++t) {
          const double u = stream.uniform();
          const auto e = static_cast<float>(env);
          if (u < 0.2) {  // a time limit: the final observation is none of a decision
            m.push(env, number);
            m.end(env, number + 0.5f);
            next[{e, number}] = number + 0.5f;
          } else if (u < 0.4) {  // the end of the task
            m.push(env, number, 0);
          } else if (u < 0.5) {  // a row that is not learned from
            m.end(env, number);
          } else {
            m.push(env, number);
            next[{e, number}] = number + 1;
          }
          ++number;
        }
        // The host goes on from there, or has reset the world meanwhile.
        const double u = stream.uniform();
        m.follow(env, number);
        if (u < 0.3) ++number;
      }
      for (const int32_t i : m.drawable()) {
        const float *obs = m.replay.obs(i), *after = m.replay.next_obs(i);
        EXPECT_EQ(m.replay.reward(i), obs[1]);
        EXPECT_EQ(m.replay.cost(i)[0], obs[1] / 2);
        if (m.replay.discount(i) == 0) continue;
        EXPECT_EQ(after[0], obs[0]);
        // With an end of the horizon in between the foretold row, which is the same number or one that was skipped.
        EXPECT_EQ(after[1], next.at({obs[0], obs[1]})) << obs[1];
      }
      EXPECT_EQ(m.replay.rows(), static_cast<int64_t>(m.drawable().size()));
    }
    EXPECT_LE(m.replay.rows(), capacity + 3);
    if (capacity >= 30) {
      EXPECT_GT(m.replay.rows(), 10);
    }
  }
}

// Of a ring that has gone round too: episodes of three decisions, every other one ended by time.
TEST(Replay, TellsWhichRowsBeginEpisodes) {
  Memory m(2, 40);
  for (int number = 0; number < 90; ++number) {
    for (int32_t env = 0; env < 2; ++env) {
      const auto decision = static_cast<float>(number);
      const bool last = number % 3 == 2, by_time = number % 6 == 5;
      m.push(env, decision, last && !by_time ? 0 : 0.9f);
      if (by_time)
        m.end(env, decision + 0.5f);
      else
        m.follow(env, decision + 1);
    }
    std::vector<int32_t> list(size_of(m.replay.capacity())), wanted;
    list.resize(size_of(m.replay.first_rows(list.data())));
    // Of a full ring it may be unknown what stood before the oldest row.
    const auto begins = [&](int32_t i) { return static_cast<int>(m.replay.obs(i)[1]) % 3 == 0; };
    EXPECT_TRUE(std::all_of(list.begin(), list.end(), begins)) << number;
    float oldest = number < 12 ? -1.0f : 1e9f;
    for (const int32_t i : m.drawable()) oldest = std::min(oldest, m.replay.obs(i)[1]);
    const auto known = [&](int32_t i) { return m.replay.obs(i)[1] > oldest; };
    for (const int32_t i : m.drawable())
      if (begins(i) && known(i)) wanted.push_back(i);
    list.erase(std::remove_if(list.begin(), list.end(), [&](int32_t i) { return !known(i); }), list.end());
    EXPECT_EQ(list, wanted) << number;
  }
}

TEST(Replay, DrawsAllRowsAlikeAndNoOthers) {
  Memory m(4, 40);
  for (int i = 0; i < 30; ++i)
    for (int32_t env = 0; env < 4; ++env) {
      m.push(env, static_cast<float>(i));
      if (i % 3 == env % 3) m.end(env, static_cast<float>(i));
    }
  for (int32_t env = 0; env < 4; ++env) m.follow(env, 30);
  const auto rows = m.drawable();
  Stream stream(1, 0, Purpose::kMinibatch);
  std::map<int32_t, int> hits;
  const int32_t count = 100000;
  std::vector<int32_t> drawn(size_of(count));
  m.replay.draw(stream, count, drawn.data());
  for (const int32_t i : drawn) ++hits[i];
  EXPECT_EQ(hits.size(), rows.size());
  const double mean = static_cast<double>(count) / static_cast<double>(rows.size());
  for (const int32_t i : rows) EXPECT_NEAR(hits[i], mean, 6 * std::sqrt(mean)) << i;
}

TEST(Replay, ASavedRingGoesOnAsItWas) {
  for (const int pushes : {0, 3, 50}) {
    Memory a(2, 10), b(2, 10);
    for (int i = 0; i < pushes; ++i)
      for (int32_t env = 0; env < 2; ++env) {
        a.push(env, static_cast<float>(i));
        if (i % 4 == env) a.end(env, static_cast<float>(i) + 0.5f);
      }
    for (int32_t env = 0; env < 2; ++env) a.follow(env, static_cast<float>(pushes));
    const auto save = [](Replay& r) {
      return written([&](Writer& w) {
        w.begin_file("RDMTEST", 1);
        StateWriter io(w);
        r.visit(io);
        io.end();
        w.end_file();
      });
    };
    const auto bytes = save(a.replay);
    for (int i = 0; i < 7; ++i) b.push(0, 99);  // what was there before is gone
    for (const bool apply : {false, true}) {
      Reader in(bytes.data(), bytes.size(), "test");
      in.begin_file("RDMTEST", 1);
      StateReader io(in, apply);
      b.replay.visit(io);
      io.end();
    }
    b.replay.after_load();
    EXPECT_EQ(save(b.replay), bytes);
    EXPECT_EQ(b.drawable(), a.drawable());
    for (Memory* m : {&a, &b}) m->push(1, static_cast<float>(pushes));
    EXPECT_EQ(save(b.replay), save(a.replay));
  }
}

TEST(Replay, TakesWhatItSaid) {
  size_t small = 0, large = 0;
  for (const char* rows : {"1000", "101000"}) {
    AgentSetup s("td3", 50, 4, 5, {{"replay_rows", rows, 0}});
    (small ? large : small) = Agent::memory(s.ready());
  }
  // A hundred thousand decisions of 50 numbers, 4 of an action, reward, discount and a flag.
  EXPECT_NEAR(static_cast<double>(large - small), 1e5 * (4 * (50 + 4 + 2) + 1), 1024);
}

}  // namespace rdm::test
