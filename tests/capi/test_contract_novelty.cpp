// Frozen policies through the C ABI: how far rows are from those of training.
#include <cmath>
#include <limits>
#include <memory>

#include "contract.hpp"
#include "heap_count.hpp"
#include "policies.hpp"

namespace {

using Bytes = std::vector<unsigned char>;

int32_t tells(const rdm_policy* p) {
  auto info = RDM_INIT(rdm_policy_info);
  EXPECT_EQ(rdm_policy_get_info(p, &info), RDM_OK);
  return info.novelty;
}

std::vector<float> novelty(const rdm_policy* p, const float* obs, int32_t rows) {
  std::vector<float> out(static_cast<size_t>(rows), -1.0f);
  EXPECT_EQ(rdm_policy_novelty(p, obs, rows, out.data()), RDM_OK) << rdm_last_error();
  return out;
}

// Three epochs of 1,120 decisions of two hands, and all rows of the last one.
struct Hands {
  rdm_pool* pool = make_pool(pool_config(16));
  rdm_agent* agent = nullptr;
  size_t dim = static_cast<size_t>(spec_of(pool).obs_dim);
  std::vector<float> rows;

  explicit Hands(const char* settings = "hidden=16\nhorizon=70\npasses=1\nminibatches=2\naverage=0") {
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
    rdm_agent_config c;
    EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
    EXPECT_EQ(rdm_agent_config_for_pool(&c, pool), RDM_OK);
    c.settings = settings;
    agent = make_agent(c);
  }
  ~Hands() {
    rdm_agent_destroy(agent);
    rdm_pool_destroy(pool);
  }
  void learn() {
    for (int i = 0; i < 2; ++i)
      ASSERT_EQ(rdm_agent_rollout(agent, pool, nullptr), RDM_OK) << rdm_last_error();
    const rdm_buffers b = buffers_of(pool);
    auto t = RDM_INIT(rdm_transition);
    t.reward = b.reward;
    t.cost = b.cost;
    t.terminated = b.terminated;
    t.truncated = b.truncated;
    t.final_obs = b.final_obs;
    for (int i = 0; i < 70; ++i) {
      rows.insert(rows.end(), b.obs, b.obs + 16 * dim);
      ASSERT_EQ(rdm_agent_act(agent, b.obs, RDM_ACT_SAMPLE, b.action), RDM_OK);
      ASSERT_EQ(rdm_pool_step(pool), RDM_OK);
      ASSERT_EQ(rdm_agent_record(agent, &t), RDM_OK) << rdm_last_error();
    }
    ASSERT_EQ(rdm_agent_update(agent, b.obs, nullptr), RDM_OK);
  }
};

// The file as 0.1.0 would have written it, and where its later section of a tag is (0: it has none).
Bytes without(const Bytes& file, const char* tag, size_t* at = nullptr) {
  Bytes out(file.begin(), file.begin() + 24);
  for (size_t p = 24; p < file.size();) {
    uint64_t n;
    std::memcpy(&n, &file[p + 8], 8);
    const auto end = p + 16 + static_cast<size_t>(n);
    if (std::memcmp(&file[p], tag, 4) != 0)
      out.insert(out.end(), file.begin() + static_cast<ptrdiff_t>(p),
                 file.begin() + static_cast<ptrdiff_t>(end));
    else if (at)
      *at = p;
    p = end;
  }
  const uint64_t length = out.size() - 24;
  std::memcpy(&out[16], &length, 8);
  return out;
}

}  // namespace

TEST(ContractNovelty, OfTrainingAndFarFromIt) {
  Hands hands;
  hands.learn();
  const Policy p = read_policy(policy_bytes(hands.agent));
  ASSERT_EQ(tells(p.get()), 1);
  const auto count = static_cast<int32_t>(hands.rows.size() / hands.dim);
  const auto seen = novelty(p.get(), hands.rows.data(), count);
  int above = 0;
  float most = 0;
  for (const float n : seen) above += n > 1, most = std::max(most, n);
  EXPECT_LE(above, 6) << "of 1,120";
  EXPECT_LT(most, 2);
  std::vector<float> far(hands.dim, 1e6f);
  EXPECT_GT(novelty(p.get(), far.data(), 1)[0], 1e4f);
  // one entry alone, where the policy sees it
  std::vector<int32_t> columns(hands.dim);
  size_t entries = 0;
  ASSERT_EQ(rdm_policy_get_columns(p.get(), columns.data(), hands.dim, &entries), RDM_OK);
  ASSERT_LT(entries, hands.dim);
  const std::vector<uint8_t> sees = [&] {
    std::vector<uint8_t> out(hands.dim);
    for (size_t i = 0; i < entries; ++i) out[static_cast<size_t>(columns[i])] = 1;
    return out;
  }();
  for (size_t j = 0; j < hands.dim; ++j) {
    std::vector<float> row(hands.rows.begin(), hands.rows.begin() + static_cast<ptrdiff_t>(hands.dim));
    row[j] = -1e6f;
    const float n = novelty(p.get(), row.data(), 1)[0];
    EXPECT_TRUE(sees[j] ? n > 100 : n == seen[0]) << j << ": " << n;
  }
  far.assign(hands.dim, std::numeric_limits<float>::max());
  EXPECT_TRUE(std::isfinite(novelty(p.get(), far.data(), 1)[0]));
  // a row's number does not depend on those beside it
  for (int32_t i : {0, 7, count - 1})
    EXPECT_EQ(novelty(p.get(), hands.rows.data() + static_cast<size_t>(i) * hands.dim, 1)[0],
              seen[static_cast<size_t>(i)]);
}

TEST(ContractNovelty, WhatIsRefused) {
  Hands hands;
  const Policy fresh = read_policy(policy_bytes(hands.agent));
  hands.learn();
  const Bytes file = policy_bytes(hands.agent), old = without(file, "SEEN");
  EXPECT_LT(old.size(), file.size());
  std::vector<float> obs = hands.rows;
  float out[2] = {-1, -1};
  for (const Policy& p :
       {read_policy(old), read_policy(policy_bytes(Hands("hidden=16\nnormalize_obs=off").agent))}) {
    EXPECT_EQ(tells(p.get()), 0);
    EXPECT_EQ(rdm_policy_novelty(p.get(), obs.data(), 1, out), RDM_ERROR_UNSUPPORTED);
  }
  EXPECT_EQ(tells(fresh.get()), 0);
  EXPECT_EQ(rdm_policy_novelty(fresh.get(), obs.data(), 1, out), RDM_ERROR_UNSUPPORTED);
  EXPECT_STREQ(rdm_last_error(),
               "novelty: the policy file has no statistics of usual rows; an agent with normalize_obs writes "
               "them after it has learned from 1000 rows");
  const Policy p = read_policy(file);
  obs[hands.dim + 3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(rdm_policy_novelty(p.get(), obs.data(), 2, out), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_novelty(p.get(), obs.data(), 0, out), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_policy_novelty(p.get(), nullptr, 1, out), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_novelty(p.get(), obs.data(), 1, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_novelty(nullptr, obs.data(), 1, out), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(out[0], -1);
}

TEST(ContractNovelty, GoesWithThePolicyWhereverItGoes) {
  Hands hands;
  const Bytes before = policy_bytes(hands.agent);
  hands.learn();
  const Bytes file = policy_bytes(hands.agent);
  const auto wanted = novelty(read_policy(file).get(), hands.rows.data(), 100);
  // into a caller's memory, of which it takes no more, and into a policy that told nothing
  size_t needed = 0, with = 0;
  ASSERT_EQ(rdm_policy_read_memory(before.data(), before.size(), &needed), RDM_OK);
  ASSERT_EQ(rdm_policy_read_memory(file.data(), file.size(), &with), RDM_OK);
  EXPECT_EQ(with, needed);
  Bytes memory(needed);
  rdm_policy* inside = nullptr;
  ASSERT_EQ(rdm_policy_read_in(&inside, file.data(), file.size(), memory.data(), needed), RDM_OK);
  std::vector<float> out(100);
  const int64_t calls = heap_count();
  EXPECT_EQ(rdm_policy_novelty(inside, hands.rows.data(), 100, out.data()), RDM_OK);
  EXPECT_EQ(heap_count(), calls);
  EXPECT_EQ(out, wanted);
  rdm_policy_destroy(inside);
  const Policy p = read_policy(before);
  ASSERT_EQ(rdm_policy_update_from(p.get(), hands.agent), RDM_OK) << rdm_last_error();
  EXPECT_EQ(novelty(p.get(), hands.rows.data(), 100), wanted);
  // and it acts as a file without
  std::vector<float> action[2] = {std::vector<float>(40), std::vector<float>(40)};
  const Bytes old = without(file, "SEEN");
  for (const int i : {0, 1}) {
    const Policy q = read_policy(i ? old : file);
    Bytes scratch(rdm_policy_scratch(q.get(), 1));
    ASSERT_EQ(rdm_policy_act(q.get(), hands.rows.data(), 1, nullptr, action[i].data(), scratch.data(),
                             scratch.size()),
              RDM_OK);
  }
  EXPECT_EQ(action[0], action[1]);
}

TEST(ContractNovelty, DamagedNumbersAreRefused) {
  Hands hands;
  hands.learn();
  const Bytes file = policy_bytes(hands.agent);
  size_t at = 0;
  without(file, "SEEN", &at);
  ASSERT_GT(at, 0u);
  rdm_policy* p = nullptr;
  for (size_t i = at; i < at + 16 + 4 + 8; ++i)
    for (int bit = 0; bit < 8; ++bit) {
      Bytes bad = file;
      bad[i] = static_cast<unsigned char>(bad[i] ^ (1 << bit));
      EXPECT_EQ(rdm_policy_read(&p, bad.data(), bad.size()), RDM_ERROR_FORMAT) << i << " " << bit;
    }
}
