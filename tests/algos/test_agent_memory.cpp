// Memory that a host refuses, at every place where an agent of any algorithm asks for some: the code is
// RDM_ERROR_MEMORY, nothing leaks, and the handle works on as if it had not been asked.
#include <functional>

#include "contract.hpp"

namespace {

rdm_agent_config config_of(int32_t algo, CountingHost* host) {
  rdm_agent_config c = agent_config(algo);
  c.host = host ? &host->hooks : nullptr;
  return c;
}

class AgentMemory : public testing::TestWithParam<int32_t> {};

// Refuses the call's first allocation, then its second ..., until it needs no more; returns how many it had.
size_t refuse_each(CountingHost& host, const std::function<rdm_result()>& call) {
  for (size_t k = 0;; ++k) {
    const size_t live = host.live, calls = host.calls;
    host.refuse_at = host.calls + k;
    const rdm_result r = call();
    host.refuse_at = SIZE_MAX;
    EXPECT_EQ(host.live, live) << k;
    if (host.calls <= calls + k) {
      EXPECT_EQ(r, RDM_OK) << rdm_last_error();
      return k;
    }
    EXPECT_EQ(r, RDM_ERROR_MEMORY) << k << ' ' << rdm_last_error();
    if (k > 1000 || testing::Test::HasFailure()) return k;
  }
}

// Everything that may be done with a whole agent. Returns the allocations that were refused.
size_t refuse_calls(CountingHost& host, rdm_agent* a) {
  const std::vector<unsigned char> state = saved(a), policy = policy_bytes(a);
  std::vector<unsigned char> bytes(state.size() + policy.size());
  const std::string path = testing::TempDir() + "agent_memory.rdm";
  float bias[8];
  size_t n = 0, refused = 0;
  const std::function<rdm_result()> calls[] = {
      [&] { return rdm_agent_write_state(a, bytes.data(), bytes.size(), &n); },
      [&] { return rdm_agent_read_state(a, state.data(), state.size()); },
      [&] { return rdm_agent_write_policy(a, nullptr, 0, &n); },
      [&] { return rdm_agent_write_policy(a, bytes.data(), bytes.size(), &n); },
      [&] { return rdm_agent_write_policy_file(a, path.c_str()); },
      [&] { return rdm_agent_get_tensor(a, "actor.0.bias", bias, 8); },
      [&] { return rdm_agent_set_tensor(a, "actor.0.bias", bias, 8); },
      [&] {
        const rdm_option rate{"learning_rate", nullptr, 3e-4};
        return rdm_agent_set_option(a, &rate);
      },
      [&] {
        const rdm_result r = rdm_agent_read_state(a, state.data(), state.size());
        return r ? r : feed_epoch(a);
      },
  };
  for (const auto& call : calls) {
    EXPECT_EQ(rdm_agent_read_state(a, state.data(), state.size()), RDM_OK);
    refused += refuse_each(host, call);
  }
  std::remove(path.c_str());
  EXPECT_EQ(rdm_agent_read_state(a, state.data(), state.size()), RDM_OK);
  EXPECT_EQ(saved(a), state);
  EXPECT_EQ(policy_bytes(a), policy);
  EXPECT_EQ(feed_epoch(a), RDM_OK);
  return refused;
}

}  // namespace

TEST_P(AgentMemory, OfCreate) {
  for (const int32_t threads : {0, 2}) {
    CountingHost host;
    rdm_agent_config c = config_of(GetParam(), &host);
    c.num_threads = threads;
    const size_t sites = refuse_each(host, [&] {
      rdm_agent* a = nullptr;
      const rdm_result r = rdm_agent_create(&a, &c);
      EXPECT_EQ(a == nullptr, r != RDM_OK);
      rdm_agent_destroy(a);
      return r;
    });
    EXPECT_GE(sites, 4u);
    EXPECT_EQ(host.live, 0u);
    EXPECT_GE(refuse_each(host,
                          [&] {
                            size_t bytes;
                            return rdm_agent_config_memory(&c, &bytes);
                          }),
              1u);
  }
}

TEST_P(AgentMemory, OfTheHandle) {
  CountingHost host;
  const rdm_agent_config c = config_of(GetParam(), &host);
  rdm_agent* a = make_agent(c);
  ASSERT_EQ(feed_epoch(a), RDM_OK);
  EXPECT_GT(refuse_calls(host, a), 2u);
  rdm_agent_destroy(a);
  EXPECT_EQ(host.live, 0u);
}

TEST_P(AgentMemory, OfTheProcess) {
  CountingHost host;
  ASSERT_EQ(rdm_init(&host.hooks), RDM_OK) << rdm_last_error();
  const rdm_agent_config c = config_of(GetParam(), nullptr);
  rdm_agent* a = make_agent(c);
  ASSERT_EQ(feed_epoch(a), RDM_OK);
  EXPECT_GT(refuse_calls(host, a), 2u);
  rdm_agent_destroy(a);
  EXPECT_EQ(host.live, 0u);
  rdm_shutdown();
}

INSTANTIATE_TEST_SUITE_P(List, AgentMemory, testing::Range(0, rdm_algo_count()),
                         [](const auto& info) { return config_of(info.param, nullptr).algo; });
