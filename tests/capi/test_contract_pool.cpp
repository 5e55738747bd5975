// The C ABI of pools: what bad input gets, and that it loses nothing.
#include <cmath>
#include <limits>

#include "contract.hpp"

namespace {

const float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(ContractPool, NullIsAnArgumentError) {
  rdm_pool_config c = pool_config();
  rdm_pool* p = nullptr;
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  EXPECT_EQ(rdm_pool_config_init(nullptr, sizeof c), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_create(nullptr, &c), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_create(&p, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_config_spec(nullptr, &spec), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_config_spec(&c, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_step(nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_step_masked(nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_reset(nullptr, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_get_buffers(nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_set_buffers(nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_baseline(nullptr, RDM_BASELINE_ZERO), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_get_spec(nullptr, &spec), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_get_stats(nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_get_hash(nullptr, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_write_state(nullptr, 0, nullptr, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_read_state(nullptr, 0, nullptr, 0), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_shape_at(nullptr, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_get_poses(nullptr, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_get_contacts(nullptr, 0, nullptr, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_render(nullptr, 0, "front", 8, 8, nullptr, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_field_at(nullptr, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_setting_at(nullptr, 0, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_STRNE(rdm_last_error(), "");
  EXPECT_STRNE(rdm_pool_error(nullptr), "");
  rdm_pool_destroy(nullptr);
  EXPECT_EQ(p, nullptr);
}

TEST(ContractPool, StructsGrowAtTheEnd) {
  struct Grown {
    rdm_pool_config c;
    uint64_t tail;
  } g;
  std::memset(&g, 0xAB, sizeof g);
  EXPECT_EQ(rdm_pool_config_init(&g.c, sizeof g.c), RDM_OK);
  EXPECT_EQ(g.tail, 0xABABABABABABABABull);  // bytes beyond the given size are the caller's
  EXPECT_EQ(rdm_pool_config_init(&g.c, offsetof(rdm_pool_config, settings) - 1), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_config_init(&g.c, sizeof g), RDM_OK);
  EXPECT_EQ(g.tail, 0u);
  g.c.task = "hand_over_safe_finger";
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  EXPECT_EQ(rdm_pool_config_spec(&g.c, &spec), RDM_OK) << rdm_last_error();
  g.tail = 1;
  EXPECT_EQ(rdm_pool_config_spec(&g.c, &spec), RDM_ERROR_VERSION_MISMATCH);
  g.c.struct_size = 8;
  EXPECT_EQ(rdm_pool_config_spec(&g.c, &spec), RDM_ERROR_ARGUMENT);
  g.c.struct_size = sizeof g.c;
  spec.struct_size = 4;
  EXPECT_EQ(rdm_pool_config_spec(&g.c, &spec), RDM_ERROR_ARGUMENT);
}

TEST(ContractPool, BadConfigsSayWhatIsWrong) {
  rdm_pool* p = nullptr;
  auto expect = [&](rdm_pool_config c, rdm_result code, const char* word) {
    EXPECT_EQ(rdm_pool_create(&p, &c), code) << word;
    EXPECT_NE(std::string(rdm_last_error()).find(word), std::string::npos) << rdm_last_error();
    EXPECT_EQ(std::string(rdm_last_error()).find('\n'), std::string::npos);
    EXPECT_EQ(p, nullptr);
  };
  rdm_pool_config c = pool_config();
  c.task = "hand_over_safe_fingr";
  expect(c, RDM_ERROR_NOT_FOUND, "hand_over_safe_finger");  // the nearest name
  c.task = nullptr;
  expect(c, RDM_ERROR_ARGUMENT, "task");
  c = pool_config(0);
  expect(c, RDM_ERROR_RANGE, "num_envs");
  c = pool_config(1 << 30);
  expect(c, RDM_ERROR_RANGE, "num_envs");
  c = pool_config();
  c.num_threads = -1;
  expect(c, RDM_ERROR_RANGE, "num_threads");
  c = pool_config();
  c.autoreset = 7;
  expect(c, RDM_ERROR_RANGE, "autoreset");
  c = pool_config();
  c.num_options = 1;
  expect(c, RDM_ERROR_ARGUMENT, "options");
  rdm_option o{"objct", "egg", 0};
  c.options = &o;
  expect(c, RDM_ERROR_NOT_FOUND, "object");
  o = {"object", "piano", 0};
  expect(c, RDM_ERROR_NOT_FOUND, "piano");
  o = {"object", nullptr, 3};
  expect(c, RDM_ERROR_ARGUMENT, "object");
  o = {"max_steps", nullptr, 1e9};
  expect(c, RDM_ERROR_RANGE, "max_steps");
  o = {"max_steps", nullptr, std::numeric_limits<double>::quiet_NaN()};
  expect(c, RDM_ERROR_ARGUMENT, "max_steps");
  o = {"max_steps", "many", 0};
  expect(c, RDM_ERROR_ARGUMENT, "many");
  o = {nullptr, nullptr, 0};
  expect(c, RDM_ERROR_ARGUMENT, "key");
}

TEST(ContractPool, NamesIgnoreCaseAndHyphens) {
  rdm_pool_config c = pool_config(1);
  c.task = "Hand-Over-Safe-Finger";
  rdm_pool* p = make_pool(c);
  rdm_pool_destroy(p);
  int32_t index = -1;
  EXPECT_EQ(rdm_task_find("HAND_OVER_safe-joint", &index), RDM_OK);
  EXPECT_GE(index, 0);
}

TEST(ContractPool, WrongOrderIsAStateError) {
  rdm_pool* p = make_pool(pool_config());
  EXPECT_EQ(rdm_pool_step(p), RDM_ERROR_STATE);
  EXPECT_STRNE(rdm_pool_error(p), "");
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  EXPECT_EQ(rdm_pool_step(p), RDM_OK);
  rdm_pool_destroy(p);
}

TEST(ContractPool, OneBadRowOfActionsDoesNotTouchTheOthers) {
  rdm_pool *p = make_pool(pool_config(3)), *clean = make_pool(pool_config(3));
  rdm_buffers b = buffers_of(p);
  const rdm_spec spec = spec_of(p);
  for (rdm_pool* q : {p, clean}) ASSERT_EQ(rdm_pool_reset(q, nullptr, nullptr), RDM_OK);
  for (float bad : {kNan, HUGE_VALF, -HUGE_VALF}) {
    b.action[spec.action_dim + 5] = bad;  // world 1
    ASSERT_EQ(rdm_pool_step(p), RDM_OK);
    ASSERT_EQ(rdm_pool_step(clean), RDM_OK);
    EXPECT_EQ(b.status[0], 0u);
    EXPECT_NE(b.status[1] & RDM_STATUS_BAD_ACTION, 0u);
    EXPECT_EQ(b.truncated[1], 1);
    EXPECT_EQ(b.terminated[1], 0);
    EXPECT_EQ(b.reward[1], 0);
    EXPECT_EQ(b.cost[spec.cost_dim], 0);
    for (int i = 0; i < 3 * spec.obs_dim; ++i) {
      ASSERT_TRUE(std::isfinite(b.obs[i]));
      ASSERT_TRUE(std::isfinite(b.final_obs[i]));
    }
    b.action[spec.action_dim + 5] = 0;
    EXPECT_EQ(hash_of(p, 0), hash_of(clean, 0));
    EXPECT_EQ(hash_of(p, 2), hash_of(clean, 2));
  }
  ASSERT_EQ(rdm_pool_step(p), RDM_OK);
  EXPECT_EQ(b.status[1], 0u);  // the world goes on in a new episode
  rdm_pool_destroy(p);
  rdm_pool_destroy(clean);
}

TEST(ContractPool, CorruptStatesChangeNothing) {
  rdm_pool* p = make_pool(pool_config());
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  ASSERT_EQ(rdm_pool_step(p), RDM_OK);
  size_t n = 0;
  ASSERT_EQ(rdm_pool_write_state(p, -1, nullptr, 0, &n), RDM_OK);
  std::vector<unsigned char> state(n);
  EXPECT_EQ(rdm_pool_write_state(p, -1, nullptr, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_write_state(p, 77, nullptr, 0, &n), RDM_ERROR_RANGE);
  ASSERT_EQ(rdm_pool_write_state(p, -1, state.data(), n - 1, &n), RDM_ERROR_RANGE);
  ASSERT_EQ(rdm_pool_write_state(p, -1, state.data(), state.size(), &n), RDM_OK);
  ASSERT_EQ(rdm_pool_step(p), RDM_OK);
  const uint64_t before = hash_of(p);
  for (size_t cut = 0; cut < n; cut += 97) EXPECT_LT(rdm_pool_read_state(p, -1, state.data(), cut), 0) << cut;
  for (size_t at = 0; at < n; at += 13) {
    auto bad = state;
    bad[at] ^= static_cast<unsigned char>(1u << (at % 8));
    EXPECT_LT(rdm_pool_read_state(p, -1, bad.data(), n), 0) << at;
  }
  std::vector<unsigned char> noise(n, 0x5A);
  EXPECT_LT(rdm_pool_read_state(p, -1, noise.data(), n), 0);
  EXPECT_EQ(hash_of(p), before);
  rdm_option o{"object", "ball", 0};
  rdm_pool_config c = pool_config();
  c.options = &o;
  c.num_options = 1;
  rdm_pool* other = make_pool(c);
  EXPECT_LT(rdm_pool_read_state(other, -1, state.data(), n), 0);  // other options
  EXPECT_EQ(rdm_pool_read_state(p, -1, state.data(), n), RDM_OK) << rdm_last_error();
  rdm_pool_destroy(other);
  rdm_pool_destroy(p);
}

TEST(ContractPool, IndicesAndSizesAreChecked) {
  rdm_pool* p = make_pool(pool_config());
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  rdm_shape_info shape = RDM_INIT(rdm_shape_info);
  rdm_field_info field = RDM_INIT(rdm_field_info);
  uint64_t h;
  std::vector<uint8_t> rgb(64 * 64 * 3);
  EXPECT_EQ(rdm_pool_shape_at(p, -1, &shape), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_shape_at(p, 100000, &shape), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_field_at(p, 100000, &field), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_get_hash(p, 2, &h), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_get_hash(p, -2, &h), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_baseline(p, 3), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_render(p, 0, "frnt", 64, 64, rgb.data(), nullptr, nullptr), RDM_ERROR_NOT_FOUND);
  EXPECT_NE(std::string(rdm_pool_error(p)).find("front"), std::string::npos);
  EXPECT_EQ(rdm_pool_render(p, 0, "front", 0, 64, rgb.data(), nullptr, nullptr), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_render(p, 0, "front", 1 << 20, 64, rgb.data(), nullptr, nullptr), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_render(p, 5, "front", 64, 64, rgb.data(), nullptr, nullptr), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_render(p, 0, "front", 64, 64, rgb.data(), nullptr, nullptr), RDM_OK);
  rdm_buffers odd{};
  odd.struct_size = sizeof odd;
  odd.obs = reinterpret_cast<float*>(rgb.data() + 1);
  EXPECT_EQ(rdm_pool_set_buffers(p, &odd), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_step(p), RDM_OK);
  rdm_pool_destroy(p);
}

TEST(ContractPool, NothingIsPrinted) {
  Silence silence;
  rdm_pool* p = nullptr;
  rdm_pool_config c = pool_config();
  c.task = "nothing";
  rdm_pool_create(&p, &c);
  p = make_pool(pool_config());
  rdm_pool_reset(p, nullptr, nullptr);
  rdm_buffers b = buffers_of(p);
  for (int i = 0; i < 100; ++i) {
    rdm_pool_baseline(p, RDM_BASELINE_RANDOM);
    if (i % 10 == 0) b.action[0] = kNan;
    rdm_pool_step(p);
  }
  rdm_pool_destroy(p);
  EXPECT_EQ(silence.restore(), "");
}

}  // namespace
