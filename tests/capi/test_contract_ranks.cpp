// Learners of many processes through the C ABI: pools that know their part, checkpoints of all, refusals.
#include <array>
#include <cstdio>

#include "contract.hpp"
#include "ranks.hpp"
#include "written.hpp"

using rdm::test::each_rank;
using rdm::test::Meeting;

namespace {

rdm_ranks ranks_of(Meeting& meeting, int32_t rank) {
  const rdm::RankHooks h = meeting.hooks(rank);
  rdm_ranks r{};
  r.struct_size = sizeof r;
  r.rank = h.rank, r.ranks = h.count;
  r.user = h.user, r.gather = h.gather;
  return r;
}

// What a rank is made with; `worlds` of all ranks.
struct RankMade {
  const char *task = "two_state", *algo = "ppo_lag", *settings = "", *pool_settings = "";
  uint64_t pool_seed = 0, seed = 0;
  int32_t worlds = 16, horizon = 8, autoreset = RDM_AUTORESET_SAME_STEP, threads = 0;
};

// A rank's pool and agent.
struct Part {
  rdm_pool* pool = nullptr;
  rdm_agent* agent = nullptr;

  Part(const RankMade& made, const rdm_ranks& ranks) {
    rdm_pool_config pc = pool_config(made.worlds / ranks.ranks);
    pc.task = made.task;
    pc.seed = made.pool_seed;
    pc.autoreset = made.autoreset;
    pc.settings = made.pool_settings;
    pc.num_threads = made.threads;
    pool = make_pool(pc);
    EXPECT_EQ(rdm_pool_set_rank(pool, ranks.rank, ranks.ranks), RDM_OK) << rdm_last_error();
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
    rdm_agent_config c;
    EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
    EXPECT_EQ(rdm_agent_config_for_pool(&c, pool), RDM_OK);
    const rdm_option small[] = {{"hidden", "8", 0},
                                {"critic_hidden", "8", 0},
                                {"horizon", nullptr, static_cast<double>(made.horizon)},
                                {"passes", nullptr, 2},
                                {"blocks", nullptr, 8}};
    c.options = small;
    c.num_options = 5;
    c.algo = made.algo;
    c.seed = made.seed;
    c.settings = made.settings;
    c.num_threads = made.threads;
    EXPECT_EQ(rdm_agent_create_ranked(&agent, &c, &ranks), RDM_OK) << rdm_last_error();
  }
  ~Part() {
    rdm_agent_destroy(agent);
    rdm_pool_destroy(pool);
  }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
  void epochs(int count) {
    for (int i = 0; i < count; ++i)
      ASSERT_EQ(rdm_agent_rollout(agent, pool, nullptr), RDM_OK) << rdm_agent_error(agent);
  }
};

using Bytes = std::vector<unsigned char>;

Bytes file_bytes(const std::string& path) {
  Bytes out;
  if (FILE* f = std::fopen(path.c_str(), "rb")) {
    for (int c; (c = std::fgetc(f)) != EOF;) out.push_back(static_cast<unsigned char>(c));
    std::fclose(f);
  }
  return out;
}

std::string path_of(const char* name) {
  return testing::TempDir() + "redman_ranks_" + name + ".rdm";
}

// The checkpoint of so many epochs by some ranks, perhaps from another one on.
Bytes checkpoint(const char* task, const char* algo, int32_t ranks, int epochs, const std::string& from,
                 const char* name) {
  const std::string path = path_of(name);
  Meeting meeting(ranks);
  each_rank(ranks, [&](int32_t rank) {
    const rdm_ranks r = ranks_of(meeting, rank);
    RankMade made;
    made.task = task, made.algo = algo;
    Part part(made, r);
    size_t size = 0;
    if (!from.empty()) {
      ASSERT_EQ(rdm_checkpoint_read(from.c_str(), part.agent, part.pool, nullptr, 0, &size), RDM_OK)
          << rdm_last_error();
    }
    part.epochs(epochs);
    ASSERT_EQ(rdm_checkpoint_write(path.c_str(), part.agent, part.pool, "note", rank == 0 ? 4 : 0), RDM_OK)
        << rdm_agent_error(part.agent);
  });
  return file_bytes(path);
}

}  // namespace

TEST(ContractRanks, CheckpointsAreTheSameForAnyNumber) {
  for (const auto& [task, algo] : {std::pair{"bandit", "focops"}, std::pair{"two_state", "ppo_lag"},
                                   std::pair{"two_state", "cpo"}, std::pair{"grasp", "ppo_lag"}}) {
    const int more = 2;
    const Bytes wanted = checkpoint(task, algo, 1, 2 + more, "", "whole");
    ASSERT_GT(wanted.size(), 1000u);
    for (const int32_t ranks : {2, 4})
      EXPECT_EQ(checkpoint(task, algo, ranks, 2 + more, "", "all"), wanted) << task;
    checkpoint(task, algo, 2, 2, "", "half");
    for (const int32_t ranks : {1, 4})
      EXPECT_EQ(checkpoint(task, algo, ranks, more, path_of("half"), "rest"), wanted) << task << ranks;
  }
}

TEST(ContractRanks, WorldsHaveTheirPlaceAmongAll) {
  rdm_pool_config whole = pool_config(6), part = pool_config(2);
  rdm_pool *all = make_pool(whole), *mine = make_pool(part);
  ASSERT_EQ(rdm_pool_set_rank(mine, 1, 3), RDM_OK) << rdm_last_error();
  for (rdm_pool* p : {all, mine}) ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  EXPECT_EQ(hash_of(mine, 0), hash_of(all, 2));
  EXPECT_EQ(hash_of(mine, 1), hash_of(all, 3));
  ASSERT_EQ(rdm_pool_step(all), RDM_OK);
  const Bytes bytes = written_bytes(
      [&](void* out, size_t n, size_t* size) { return rdm_pool_write_state(all, -1, out, n, size); });
  ASSERT_EQ(rdm_pool_read_state(mine, -1, bytes.data(), bytes.size()), RDM_OK) << rdm_last_error();
  EXPECT_EQ(hash_of(mine, 0), hash_of(all, 2));
  EXPECT_EQ(hash_of(mine, 1), hash_of(all, 3));
  EXPECT_EQ(rdm_pool_set_rank(mine, 1, 3), RDM_ERROR_STATE);
  EXPECT_STREQ(rdm_pool_error(mine),
               "set_rank is allowed before the first reset only, and world 0 has begun");
  EXPECT_EQ(rdm_pool_set_rank(nullptr, 0, 1), RDM_ERROR_ARGUMENT);
  rdm_pool* fresh = make_pool(part);
  EXPECT_EQ(rdm_pool_set_rank(fresh, 3, 3), RDM_ERROR_RANGE);
  EXPECT_STREQ(rdm_pool_error(fresh), "rank: 3 is outside [0, 2]");
  EXPECT_EQ(rdm_pool_set_rank(fresh, 0, 0), RDM_ERROR_RANGE);
  for (rdm_pool* p : {all, mine, fresh}) rdm_pool_destroy(p);
}

TEST(ContractRanks, Refusals) {
  Meeting meeting(2);
  const rdm_ranks good = ranks_of(meeting, 0);
  const auto why = [](rdm_ranks r, rdm_result code, const char* settings = "blocks=4") {
    rdm_agent_config c = agent_config();
    c.settings = settings;
    rdm_agent* a = nullptr;
    EXPECT_EQ(rdm_agent_create_ranked(&a, &c, &r), code);
    EXPECT_EQ(a, nullptr);
    return std::string(rdm_last_error());
  };
  rdm_ranks r = good;
  r.struct_size = 4;
  why(r, RDM_ERROR_ARGUMENT);
  r = good, r.rank = 2;
  EXPECT_EQ(why(r, RDM_ERROR_RANGE), "rank: 2 is outside [0, 1]");
  r = good, r.gather = nullptr;
  EXPECT_EQ(why(r, RDM_ERROR_ARGUMENT), "gather is NULL with 2 ranks");
  EXPECT_EQ(why(good, RDM_ERROR_ARGUMENT, ""),
            "blocks: 1 is not the number of ranks, 2, times a power of two, as 2 would be");
  EXPECT_EQ(why(good, RDM_ERROR_ARGUMENT, "blocks=16"),
            "blocks: 16 does not divide the number of environments, 8");
  rdm_agent_config c = agent_config();
  rdm_agent* a = nullptr;
  EXPECT_EQ(rdm_agent_create_ranked(&a, &c, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_create_ranked(nullptr, &c, &good), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_create_ranked(&a, nullptr, &good), RDM_ERROR_ARGUMENT);
}

TEST(ContractRanks, AgentAndPoolAreOfOneRank) {
  Meeting meeting(2);
  Part part(RankMade{}, ranks_of(meeting, 1));
  rdm_pool_config pc = pool_config(8);
  pc.task = "two_state";
  rdm_pool* other = make_pool(pc);
  ASSERT_EQ(rdm_pool_reset(other, nullptr, nullptr), RDM_OK);
  EXPECT_EQ(rdm_agent_rollout(part.agent, other, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_agent_error(part.agent), "rank: the agent has 1, but the pool has 0");
  rdm_pool_destroy(other);
}

// A rank that goes away: the others' calls are cancelled, and a checkpoint of before goes on with those that
// are left.
TEST(ContractRanks, OneThatDiesAndTheRestGoesOn) {
  const std::string path = path_of("before");
  Meeting meeting(4);
  std::array<rdm_result, 4> heard{};
  each_rank(4, [&](int32_t rank) {
    Part part(RankMade{}, ranks_of(meeting, rank));
    part.epochs(2);
    ASSERT_EQ(rdm_checkpoint_write(path.c_str(), part.agent, part.pool, nullptr, 0), RDM_OK);
    if (rank == 3) return meeting.leave();
    heard[static_cast<size_t>(rank)] = rdm_agent_rollout(part.agent, part.pool, nullptr);
    EXPECT_EQ(rdm_checkpoint_write(path_of("never").c_str(), part.agent, part.pool, nullptr, 0),
              RDM_ERROR_CANCELLED);
  });
  for (size_t rank = 0; rank < 3; ++rank) EXPECT_EQ(heard[rank], RDM_ERROR_CANCELLED);
  EXPECT_EQ(checkpoint("two_state", "ppo_lag", 2, 2, path, "after"),
            checkpoint("two_state", "ppo_lag", 1, 4, "", "unbroken"));
}

namespace {

// The text that both ranks have after their first rollouts; the second one says that it is rank `claimed`.
std::string meet(const RankMade& second, int32_t claimed = 1) {
  Meeting meeting(2);
  std::string texts[2];
  each_rank(2, [&](int32_t rank) {
    RankMade made = rank == 0 ? RankMade{} : second;
    made.threads = rank;  // may differ
    rdm_ranks r = ranks_of(meeting, rank);
    if (rank == 1) r.rank = claimed;
    const Part part(made, r);
    const rdm_result result = rdm_agent_rollout(part.agent, part.pool, nullptr);
    EXPECT_TRUE(result == RDM_OK || result == RDM_ERROR_STATE) << rdm_agent_error(part.agent);
    if (result != RDM_OK) texts[rank] = rdm_agent_error(part.agent);
  });
  EXPECT_EQ(texts[0], texts[1]) << "both are told the same";
  return texts[0];
}

}  // namespace

TEST(ContractRanks, SetUpDifferentlyTheyStopAtOnce) {
  const auto with = [](auto&& change) {
    RankMade s;
    change(s);
    return s;
  };
  const std::pair<RankMade, const char*> rows[] = {
      {with([](RankMade&) {}), ""},
      {with([](RankMade& s) { s.pool_seed = 5; }), "ranks: pool seed differs: rank 1 has 5, rank 0 has 0"},
      {with([](RankMade& s) { s.worlds = 32; }), "ranks: num_envs differs: rank 1 has 16, rank 0 has 8"},
      {with([](RankMade& s) { s.horizon = 16; }), "ranks: horizon differs: rank 1 has 16, rank 0 has 8"},
      {with([](RankMade& s) { s.seed = 7; }), "ranks: seed differs: rank 1 has 7, rank 0 has 0"},
      {with([](RankMade& s) { s.algo = "focops"; }), "ranks: algo of rank 1 differs from that of rank 0"},
      {with([](RankMade& s) { s.settings = "learning_rate=1e-4"; }),
       "ranks: option learning_rate of rank 1 differs from that of rank 0"},
      {with([](RankMade& s) { s.settings = "hidden=16"; }),
       "ranks: option hidden of rank 1 differs from that of rank 0"},
      {with([](RankMade& s) { s.autoreset = RDM_AUTORESET_NEXT_STEP; }),
       "ranks: pool autoreset differs: rank 1 has 1, rank 0 has 0"},
      {with([](RankMade& s) { s.pool_settings = "noise.*=0.1"; }),
       "ranks: pool options of rank 1 differs from that of rank 0"}};
  for (const auto& [second, text] : rows) EXPECT_EQ(meet(second), text);
  EXPECT_EQ(meet(RankMade{}, 0), "ranks: the message received for rank 1 says that it comes from rank 0");
}
