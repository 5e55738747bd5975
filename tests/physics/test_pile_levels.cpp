// How high piles are, from which follows how often they are swept.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "base/rng.hpp"
#include "physics/articulated/wide_contacts.inl"

namespace rdm {
namespace {

constexpr int32_t kBodies = 70;  // more than the bits of a word

struct Pair {
  int32_t a, b;  // b -1: at rest
};

class Piles {
 public:
  Piles() {
    Arena measure;
    wide_.carve(measure, 512, kBodies);
    arena_ = Arena(HostHooks{}, measure.used());
    wide_.carve(arena_, 512, kBodies);
  }
  int32_t levels(const std::vector<Pair>& pairs, const std::vector<int32_t>& held) {
    wide_.begin();
    int32_t point = 0;
    for (const Pair& p : pairs) wide_.add(point++, 1, p.a, p.b);
    return wide_.levels([&](const auto& visit) {
      for (const int32_t body : held) visit(body);
    });
  }

 private:
  Arena arena_;
  WideContacts<float> wide_;
};

// By searches in width from all of a set of bodies at once.
int32_t levels_by_search(const std::vector<Pair>& pairs, const std::vector<int32_t>& held) {
  std::vector<int32_t> level(kBodies, 0);  // 0: none yet
  std::vector<bool> used(kBodies, false);
  const auto search = [&](std::vector<int32_t> front) {
    for (const int32_t body : front) level[static_cast<size_t>(body)] = 1;
    while (!front.empty()) {
      std::vector<int32_t> next;
      for (const int32_t body : front)
        for (const Pair& p : pairs) {
          if (p.b < 0 || (p.a != body && p.b != body)) continue;
          const int32_t other = p.a == body ? p.b : p.a;
          int32_t& of = level[static_cast<size_t>(other)];
          if (of != 0) continue;
          of = level[static_cast<size_t>(body)] + 1;
          next.push_back(other);
        }
      front = next;
    }
  };
  const auto reached = [&](int32_t body) { return level[static_cast<size_t>(body)] != 0; };
  std::vector<int32_t> front;
  for (const Pair& p : pairs) {
    used[static_cast<size_t>(p.a)] = true;
    if (p.b >= 0)
      used[static_cast<size_t>(p.b)] = true;
    else
      front.push_back(p.a);
  }
  search(front);
  front.clear();
  for (const int32_t body : held)
    if (!reached(body)) front.push_back(body);
  search(front);
  int32_t most = 0;
  for (int32_t i = 0; i < kBodies; ++i)
    if (used[static_cast<size_t>(i)]) most = std::max(most, level[static_cast<size_t>(i)]);
  return most;
}

TEST(PileLevels, AStackHasOnePerBody) {
  Piles piles;
  std::vector<Pair> stack = {{0, -1}};
  for (int32_t i = 1; i < 12; ++i) stack.push_back({i - 1, i});
  EXPECT_EQ(piles.levels(stack, {}), 12);
  std::reverse(stack.begin(), stack.end());
  EXPECT_EQ(piles.levels(stack, {}), 12);
  EXPECT_EQ(piles.levels(stack, {11}), 12);  // what holds it from above changes nothing
}

TEST(PileLevels, WhatRestsOnNothingIsCountedFromWhereItIsHeld) {
  Piles piles;
  std::vector<Pair> row;
  for (int32_t i = 1; i < 9; ++i) row.push_back({i - 1, i});
  EXPECT_EQ(piles.levels(row, {0}), 9);
  EXPECT_EQ(piles.levels(row, {0, 8}), 5);
  EXPECT_EQ(piles.levels(row, {4}), 5);
  EXPECT_EQ(piles.levels(row, {}), 9);  // flying: from its first
}

TEST(PileLevels, AreThoseOfASearchInWidth) {
  Piles piles;
  Stream random(1, 0, Purpose::kTest);
  const auto any = [&](int32_t below) {
    return std::min(below - 1, static_cast<int32_t>(random.uniform() * below));
  };
  int high = 0;
  for (int k = 0; k < 500; ++k) {
    std::vector<Pair> pairs;
    std::vector<int32_t> held;
    const int32_t bodies = 2 + any(kBodies - 1), contacts = 1 + any(2 * bodies);
    pairs.push_back({any(bodies), -1});
    for (int32_t i = 0; i < contacts; ++i) {
      const int32_t a = any(bodies), b = std::min(bodies - 1, a + 1 + any(3));
      if (a != b) pairs.push_back({a, b});
    }
    // of bodies that nothing carries, all are held
    for (int32_t i = 0; i < bodies; ++i) held.push_back(i);
    const int32_t want = levels_by_search(pairs, held);
    EXPECT_EQ(piles.levels(pairs, held), want) << k;
    high += want > 6;
  }
  EXPECT_GT(high, 20);
}

}  // namespace
}  // namespace rdm
