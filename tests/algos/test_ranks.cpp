// Learners of many processes: the bytes of one process, whatever their number; and what happens when one of
// them is cancelled, dies or drifts.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "heap_count.hpp"
#include "point_world.hpp"
#include "ranks.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

constexpr int32_t kEnvs = 16;  // of all ranks

AgentSetup setup_of(const char* algo, const char* std_mode, int32_t envs = kEnvs) {
  AgentSetup s = busy_setup(algo, std_mode, envs);
  s.with("early_stop_kl", "0.5").with("blocks", "4");
  for (const char* trust : {"trpo", "trpo_lag", "cpo", "pcpo"})
    if (std::strcmp(algo, trust) == 0) s.with("fisher_stride", "3");
  return s;
}

AgentSetup part_of(AgentSetup s, Meeting& meeting, int32_t rank, int32_t ranks) {
  s.config.num_envs /= ranks;
  s.config.ranks = meeting.hooks(rank);
  return s;
}

struct Outcome {
  std::vector<unsigned char> state;
  std::vector<Epoch> curve;
};

bool same(const Epoch& a, const Epoch& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// Every rank's outcome of so many epochs; `from`: a state to begin with, whose worlds have played `played`
// epochs.
std::vector<Outcome> learn(const AgentSetup& setup, int32_t ranks, int epochs, bool with_swap = false,
                           const std::vector<unsigned char>& from = {}, int played = 0) {
  Meeting meeting(ranks, with_swap);
  std::vector<Outcome> out(size_of(ranks));
  each_rank(ranks, [&](int32_t rank) {
    AgentSetup s = part_of(setup, meeting, rank, ranks);
    const AgentPtr a = s.make();
    NoisePart world(s.config);
    if (!from.empty()) a->load(from.data(), from.size());
    for (int i = 0; i < played; ++i) {
      // what the worlds did before: nobody looks
      for (int32_t t = 0; t < a->horizon(); ++t) world.skip();
    }
    Outcome& mine = out[size_of(rank)];
    for (int i = 0; i < epochs; ++i) world.epoch(*a, &mine.curve.emplace_back());
    mine.state = saved(*a);
  });
  return out;
}

void expect_same(const Outcome& got, const Outcome& wanted, const char* what) {
  EXPECT_EQ(got.state, wanted.state) << what;
  ASSERT_EQ(got.curve.size(), wanted.curve.size());
  for (size_t i = 0; i < got.curve.size(); ++i) EXPECT_TRUE(same(got.curve[i], wanted.curve[i])) << what << i;
}

class EveryAlgoInRanks : public testing::TestWithParam<std::tuple<int, const char*>> {
 protected:
  AgentSetup setup() const {
    return setup_of(algo_at(std::get<0>(GetParam())).name, std::get<1>(GetParam()));
  }
};

}  // namespace

TEST_P(EveryAlgoInRanks, SameBytesForAnyNumber) {
  const Outcome wanted = learn(setup(), 1, 3).front();
  for (const int32_t ranks : {2, 4})
    for (const bool with_swap : {false, true})
      for (const Outcome& got : learn(setup(), ranks, 3, with_swap))
        expect_same(got, wanted, with_swap ? "swap" : "gather");
}

TEST_P(EveryAlgoInRanks, AnotherNumberGoesOn) {
  const Outcome whole = learn(setup(), 1, 4).front();
  const auto half = learn(setup(), 2, 2).front().state;
  for (const int32_t ranks : {1, 4})
    for (const Outcome& got : learn(setup(), ranks, 2, false, half, 2)) {
      EXPECT_EQ(got.state, whole.state) << ranks;
      EXPECT_TRUE(same(got.curve.back(), whole.curve.back())) << ranks;
    }
}

INSTANTIATE_TEST_SUITE_P(List, EveryAlgoInRanks,
                         testing::Combine(testing::ValuesIn(on_policy_algos()),
                                          testing::Values("free", "state")),
                         [](const auto& info) {
                           return std::string(algo_at(std::get<0>(info.param)).name) + "_" +
                                  std::get<1>(info.param);
                         });

// The cut into blocks is what bytes follow from, and nothing else is: two threads, a trust region's stride,
// blocks that are no power of two.
TEST(Ranks, ThreadsAndOddNumbers) {
  AgentSetup s = setup_of("ppo_lag", "free", 12);
  s.with("blocks", "12");
  const Outcome wanted = learn(s, 1, 2).front();
  for (const int32_t ranks : {3, 6, 12})
    for (const Outcome& got : learn(s, ranks, 2)) expect_same(got, wanted, "odd");
  s.config.num_threads = 2;
  for (const Outcome& got : learn(s, 3, 2)) expect_same(got, wanted, "threads");
  AgentSetup other = setup_of("ppo_lag", "free", 12);
  other.with("blocks", "6");
  EXPECT_NE(learn(other, 1, 2).front().state, wanted.state);
}

TEST(Ranks, SwapsOfThreeLevels) {
  AgentSetup s = setup_of("trpo_lag", "free");
  s.with("blocks", "16");
  const Outcome wanted = learn(s, 1, 2).front();
  for (const Outcome& got : learn(s, 8, 2, true)) expect_same(got, wanted, "eight");
}

TEST(Ranks, LargeNetworksGoInPieces) {
  AgentSetup s = setup_of("cpo", "free");
  s.with("hidden", "400,400").with("passes", "1");
  const Outcome wanted = learn(s, 1, 1).front();
  for (const bool with_swap : {false, true})
    for (const Outcome& got : learn(s, 4, 1, with_swap)) expect_same(got, wanted, "pieces");
}

TEST(Ranks, SwapsTakeThePlaceOfGathersInSums) {
  Meeting meeting(2, true);
  each_rank(2, [&](int32_t rank) {
    AgentSetup s = part_of(setup_of("ppo", "free"), meeting, rank, 2);
    const AgentPtr a = s.make();
    NoisePart(s.config).epoch(*a);
  });
  EXPECT_EQ(meeting.swaps(), 3 * 2 * 2);  // passes, minibatches; there and back of one level
}

// An actor with an encoder, of clouds; and a term that keeps it near a recording.
TEST(Ranks, Eyes) {
  for (const char* algo : {"ppo_lag", "cpo"}) {
    const auto run = [&](int32_t ranks) {
      Meeting meeting(ranks);
      std::vector<std::vector<unsigned char>> out(size_of(ranks));
      each_rank(ranks, [&](int32_t rank) {
        AgentSetup s = part_of(PointWorld::setup(algo, 8).with("blocks", "4"), meeting, rank, ranks);
        const AgentPtr a = s.make();
        const int32_t envs = s.config.num_envs;
        PointWorld world(8);
        std::vector<float> action(size_of(envs) * 2);
        const size_t first = size_of(rank * envs);
        for (int epoch = 0; epoch < 3; ++epoch) {
          while (a->missing() > 0) {
            PointRows clouds = world.clouds();
            clouds.metres += first * kWorldPoints * 3, clouds.classes += first * kWorldPoints;
            a->act(world.obs.data() + first * 5, true, action.data(), clouds);
            std::copy(action.begin(), action.end(), world.action.begin() + static_cast<ptrdiff_t>(2 * first));
            world.score();
            world.draw();
            Transition t;
            t.reward = world.reward.data() + first, t.cost = world.cost.data() + first;
            t.terminated = world.ended.data() + first;
            a->record(t);
          }
          a->update(world.obs.data() + first * 5, nullptr);
        }
        out[size_of(rank)] = saved(*a);
      });
      return out;
    };
    const auto wanted = run(1).front();
    for (const int32_t ranks : {2, 4})
      for (const auto& got : run(ranks)) EXPECT_EQ(got, wanted) << algo;
  }
}

TEST(Ranks, ImitationIsTheSameOnEach) {
  std::vector<float> obs(40 * 6), label(40 * 3);
  Stream stream(3, 0, Purpose::kTest);
  for (float& x : obs) x = static_cast<float>(stream.signed_unit());
  for (float& x : label) x = static_cast<float>(stream.signed_unit());
  const auto run = [&](int32_t ranks) {
    Meeting meeting(ranks);
    std::vector<std::vector<unsigned char>> out(size_of(ranks));
    each_rank(ranks, [&](int32_t rank) {
      AgentSetup s = part_of(setup_of("trpo_lag", "free").with("imitation", "0.3"), meeting, rank, ranks);
      const AgentPtr a = s.make();
      a->set_recording({40, obs.data(), label.data(), nullptr, {}}, 9);
      NoisePart world(s.config);
      for (int i = 0; i < 2; ++i) world.epoch(*a);
      out[size_of(rank)] = saved(*a);
    });
    return out;
  };
  const auto wanted = run(1).front();
  for (const auto& got : run(4)) EXPECT_EQ(got, wanted);
}

// Of one that is gone the others hear in their next exchange; they can be used on, and a state of before is
// theirs again.
TEST(Ranks, OneThatDiesCancelsTheOthers) {
  Meeting meeting(4);
  std::vector<Thrown> heard(4), again(4);
  std::vector<int64_t> steps(4);
  each_rank(4, [&](int32_t rank) {
    AgentSetup s = part_of(setup_of("ppo_lag", "free"), meeting, rank, 4);
    const AgentPtr a = s.make();
    NoisePart world(s.config);
    world.epoch(*a);
    const auto kept = saved(*a);
    if (rank == 2) return meeting.leave();
    heard[size_of(rank)] = thrown([&] { world.epoch(*a); });
    again[size_of(rank)] = thrown([&] { world.epoch(*a); });
    a->load(kept.data(), kept.size());
    EXPECT_EQ(a->missing(), a->horizon());
  });
  for (const size_t rank : {0u, 1u, 3u}) {
    EXPECT_EQ(heard[rank].code, Code::kCancelled);
    EXPECT_NE(heard[rank].text.find("the host's hook returned 7"), std::string::npos) << heard[rank].text;
    EXPECT_EQ(again[rank].code, Code::kCancelled);
  }
}

// Where a hook fails but all are still there, one state on all of them is a new beginning.
TEST(Ranks, AfterAFailedExchangeAStateGoesOn) {
  const AgentSetup setup = setup_of("cpo", "free");
  Meeting meeting(2);
  std::vector<AgentPtr> agents(2);
  std::vector<std::unique_ptr<NoisePart>> worlds(2);
  std::vector<std::vector<unsigned char>> states(2);
  for (int32_t r = 0; r < 2; ++r) {
    AgentSetup s = part_of(setup, meeting, r, 2);
    agents[size_of(r)] = s.make();
    worlds[size_of(r)] = std::make_unique<NoisePart>(s.config);
  }
  const auto each = [&](auto&& body) {
    each_rank(2, [&](int32_t r) { body(*agents[size_of(r)], *worlds[size_of(r)], states[size_of(r)], r); });
  };
  each([](Agent& a, NoisePart& world, auto& state, int32_t) {
    for (int i = 0; i < 2; ++i) world.epoch(a);
    state = saved(a);
  });
  each([&](Agent& a, NoisePart& world, auto&, int32_t rank) {
    NoisePart other = world;
    while (a.missing() > 2) other.decide(a);
    if (rank == 1) return meeting.leave();
    EXPECT_EQ(thrown([&] { other.epoch(a); }).code, Code::kCancelled);
  });
  meeting.heal();
  each([](Agent& a, NoisePart& world, auto& state, int32_t) {
    a.load(state.data(), state.size());
    for (int i = 0; i < 2; ++i) world.epoch(a);
    state = saved(a);
  });
  const Outcome wanted = learn(setup, 1, 4).front();
  for (const auto& state : states) EXPECT_EQ(state, wanted.state);
}

TEST(Ranks, ACancelStopsAllAtOnePlace) {
  Meeting meeting(2);
  std::vector<Thrown> heard(2);
  std::vector<std::vector<unsigned char>> states(2);
  each_rank(2, [&](int32_t rank) {
    AgentSetup s = part_of(setup_of("ppo_lag", "free"), meeting, rank, 2);
    const AgentPtr a = s.make();
    NoisePart world(s.config);
    world.epoch(*a);
    while (a->missing() > 0) world.decide(*a);
    if (rank == 1) a->cancel();
    heard[size_of(rank)] = thrown([&] { a->update(world.obs(), nullptr); });
    world.epoch(*a);
    states[size_of(rank)] = saved(*a);
  });
  for (const Thrown& t : heard) EXPECT_EQ(t.code, Code::kCancelled);
  EXPECT_EQ(states[0], states[1]);
}

TEST(Ranks, ADriftNamesItsRank) {
  for (const int32_t drifter : {0, 2}) {
    Meeting meeting(3);
    std::vector<Thrown> heard(3);
    each_rank(3, [&](int32_t rank) {
      AgentSetup s = setup_of("ppo_lag", "free", 12);
      s.with("blocks", "3");
      s = part_of(s, meeting, rank, 3);
      const AgentPtr a = s.make();
      NoisePart world(s.config);
      world.epoch(*a);
      TensorInfo t;
      a->tensor(1, &t);
      // a last bit of the largest weight, which no update rounds away
      float* const most = std::max_element(t.data, t.data + t.rows * t.cols,
                                           [](float x, float y) { return std::abs(x) < std::abs(y); });
      if (rank == drifter) *most = std::nextafter(*most, 0.0f);
      heard[size_of(rank)] = thrown([&] { world.epoch(*a); });
    });
    for (const Thrown& t : heard) {
      EXPECT_EQ(t.code, Code::kState);
      EXPECT_EQ(t.text.find("ranks: rank " + std::to_string(drifter) + " has other weights"), 0u) << t.text;
    }
  }
}

TEST(Ranks, OneOutOfStepIsTold) {
  Meeting meeting(2);
  std::vector<Thrown> heard(2);
  each_rank(2, [&](int32_t rank) {
    AgentSetup s = part_of(setup_of("ppo_lag", "free"), meeting, rank, 2);
    const AgentPtr a = s.make();
    NoisePart world(s.config);
    world.decide(*a);  // the ranks have met
    if (rank == 1) {
      const RankHooks own = meeting.hooks(1);  // a message that rank 1's agent knows nothing of
      std::vector<unsigned char> mine(16 + 13 * 8), all(2 * mine.size());
      own.gather(own.user, mine.data(), mine.size(), all.data());
      return;
    }
    heard[0] = thrown([&] { world.decide(*a); });
  });
  EXPECT_EQ(heard[0].code, Code::kState);
  EXPECT_EQ(heard[0].text.find("ranks: rank 1 is at exchange 0, but this one (0) is at "), 0u)
      << heard[0].text;
}

TEST(Ranks, BadArguments) {
  Meeting meeting(4);
  const auto why = [&](int32_t rank, int32_t ranks, int32_t envs, const char* blocks, bool hook = true) {
    AgentSetup s = setup_of("ppo", "free", envs);
    s.with("blocks", blocks);
    s.config.ranks = meeting.hooks(0);
    s.config.ranks.rank = rank, s.config.ranks.count = ranks;
    if (!hook) s.config.ranks.gather = nullptr;
    return thrown([&] { s.make(); }).text;
  };
  EXPECT_EQ(why(4, 4, 4, "4"), "rank: 4 is outside [0, 3]");
  EXPECT_EQ(why(-1, 4, 4, "4"), "rank: -1 is outside [0, 3]");
  EXPECT_EQ(why(0, 0, 4, "4"), "ranks: 0 is outside [1, 4096]");
  EXPECT_EQ(why(0, 4, 4, "4", false), "gather is NULL with 4 ranks");
  EXPECT_EQ(why(0, 4, 4, "1"),
            "blocks: 1 is not the number of ranks, 4, times a power of two, as 4 would be");
  EXPECT_EQ(why(0, 4, 6, "12"),
            "blocks: 12 is not the number of ranks, 4, times a power of two, as 4 would be");
  EXPECT_EQ(why(0, 4, 4, "32"), "blocks: 32 does not divide the number of environments, 16");
  EXPECT_EQ(why(0, 4, 4, "8"), "");
}

TEST(Ranks, NoHeapInActRecordUpdate) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is the sanitizer's here";
  Meeting meeting(2);
  std::vector<AgentPtr> agents(2);
  std::vector<std::unique_ptr<NoisePart>> worlds(2);
  for (int32_t r = 0; r < 2; ++r) {
    AgentSetup s = part_of(setup_of("cpo", "state"), meeting, r, 2);
    agents[size_of(r)] = s.make();
    worlds[size_of(r)] = std::make_unique<NoisePart>(s.config);
  }
  int64_t before = 0, after = 0;
  each_rank(2, [&](int32_t rank) {
    Epoch e;
    const auto epoch = [&] { worlds[size_of(rank)]->epoch(*agents[size_of(rank)], &e); };
    epoch();
    if (rank == 0) before = heap_count();
    for (int i = 0; i < 2; ++i) epoch();
    if (rank == 0) after = heap_count();
  });
  EXPECT_EQ(before, after);
}
