// Memory that the C library refuses, to us and to ODE alike: a code, nothing lost, and everybody else goes
// on.
#include "contract.hpp"
#include "heap_count.hpp"

namespace {

struct Case {
  const char* engine;
  int32_t threads;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.engine << ", " << c.threads << " threads";
}

class ContractRefusal : public testing::TestWithParam<Case> {
 protected:
  rdm_pool_config config() {
    rdm_pool_config c = pool_config(3);
    c.task = "grasp";
    c.num_threads = GetParam().threads;
    c.options = &engine_;
    c.num_options = 1;
    return c;
  }
  rdm_option engine_{"engine", GetParam().engine, 0};
};

TEST_P(ContractRefusal, APoolIsMadeOrRefusedWhole) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is not ours under sanitizers";
  const rdm_pool_config c = config();
  rdm_pool* other = make_pool(c);
  rdm_pool* twin = make_pool(c);
  ASSERT_EQ(rdm_pool_reset(other, nullptr, nullptr), RDM_OK);
  ASSERT_EQ(rdm_pool_reset(twin, nullptr, nullptr), RDM_OK);
  rdm_pool_destroy(make_pool(c));  // ODE keeps a pose of the last geom for the next one
  bool made = false;
  for (int64_t k = 0; !made; ++k) {
    const int64_t before = heap_blocks();
    rdm_pool* p = nullptr;
    refuse_heap(k);
    const rdm_result r = rdm_pool_create(&p, &c);
    made = !allow_heap();
    ASSERT_EQ(r, made ? RDM_OK : RDM_ERROR_MEMORY) << k << ' ' << rdm_last_error();
    ASSERT_EQ(p != nullptr, made);
    rdm_pool_destroy(p);
    ASSERT_EQ(heap_blocks(), before) << k;
    ASSERT_LT(k, 20000);
    if (k % 50 == 0) {
      ASSERT_EQ(rdm_pool_step(other), RDM_OK);
      ASSERT_EQ(rdm_pool_step(twin), RDM_OK);
    }
  }
  EXPECT_EQ(hash_of(other), hash_of(twin));
  rdm_pool_destroy(other);
  rdm_pool_destroy(twin);
}

INSTANTIATE_TEST_SUITE_P(Engines, ContractRefusal,
                         testing::Values(Case{"articulated", 1}, Case{"articulated", 2}, Case{"ode", 1},
                                         Case{"ode", 2}));

}  // namespace
