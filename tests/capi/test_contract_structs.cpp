// Sizes of structs: every function that takes one refuses a size that no version of it has, and touches no
// byte behind it.
#include <functional>

#include "contract.hpp"

namespace {

// A caller's struct with more room behind it than any size that is tried.
template <class T>
struct Roomy {
  static constexpr size_t kBytes = 16384;
  alignas(64) unsigned char bytes[kBytes] = {};
  T* get() { return reinterpret_cast<T*>(bytes); }
  explicit Roomy(const T& value = T{}) { std::memcpy(bytes, &value, sizeof value); }
};

class Structs : public testing::Test {
 protected:
  void SetUp() override {
    pool_ = make_pool(pool_config());
    ASSERT_EQ(rdm_pool_reset(pool_, nullptr, nullptr), RDM_OK);
    agent_ = make_agent(agent_config());
    const auto bytes = policy_bytes(agent_);
    ASSERT_EQ(rdm_policy_read(&policy_, bytes.data(), bytes.size()), RDM_OK);
    rdm_map_config c;
    ASSERT_EQ(rdm_map_config_init(&c, sizeof c), RDM_OK);
    ASSERT_EQ(rdm_map_create(&map_, &c), RDM_OK);
  }
  void TearDown() override {
    rdm_map_destroy(map_);
    rdm_policy_destroy(policy_);
    rdm_agent_destroy(agent_);
    rdm_pool_destroy(pool_);
  }

  // `call` takes the struct. One byte less than the first version's, and what nobody sets, are refused; the
  // largest size that may ever be is not.
  template <class T>
  static void sizes(const char* name, const T& value, const std::function<rdm_result(T*)>& call) {
    SCOPED_TRACE(name);
    for (const uint32_t size : {4097u, 16384u, 0x7fffffffu, 0xffffffffu, 0u, 4u}) {
      Roomy<T> in(value);
      in.get()->struct_size = size;
      EXPECT_EQ(call(in.get()), RDM_ERROR_ARGUMENT) << size;
      EXPECT_NE(std::string(rdm_last_error()).find("struct_size"), std::string::npos) << rdm_last_error();
    }
    Roomy<T> in(value);
    in.get()->struct_size = 4096;
    EXPECT_NE(call(in.get()), RDM_ERROR_ARGUMENT) << rdm_last_error();
  }
  // Such a struct that goes in has reserved members that must be 0, so that a later version may use them.
  template <class T>
  static void goes_in(const char* name, const T& value, const std::function<rdm_result(T*)>& call) {
    sizes<T>(name, value, call);
    SCOPED_TRACE(name);
    const auto refused = [&](auto member, const char* which) {
      T in = value;
      in.struct_size = sizeof in;
      member(in) = 7;
      EXPECT_EQ(call(&in), RDM_ERROR_ARGUMENT) << which;
      EXPECT_NE(std::string(rdm_last_error()).find(std::string(which) + ": it must be 0"), std::string::npos)
          << rdm_last_error();
    };
    if constexpr (requires(T t) { t.reserved; })
      refused(
          [](T & t) -> auto& { return t.reserved; }, "reserved");
    if constexpr (requires(T t) { t.reserved2; })
      refused(
          [](T & t) -> auto& { return t.reserved2; }, "reserved2");
    if constexpr (requires(T t) { t.reserved3; })
      refused(
          [](T & t) -> auto& { return t.reserved3; }, "reserved3");
  }

  rdm_pool* pool_ = nullptr;
  rdm_agent* agent_ = nullptr;
  rdm_policy* policy_ = nullptr;
  rdm_map* map_ = nullptr;
};

TEST_F(Structs, ThatGoInHaveASizeThatCanBe) {
  const auto end_pool = [](rdm_result r, rdm_pool* p) { return rdm_pool_destroy(p), r; };
  const auto end_agent = [](rdm_result r, rdm_agent* a) { return rdm_agent_destroy(a), r; };
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  size_t n = 0;
  goes_in<rdm_pool_config>("rdm_pool_create", pool_config(), [&](rdm_pool_config* c) {
    rdm_pool* p = nullptr;
    const rdm_result r = rdm_pool_create(&p, c);
    return end_pool(r, p);
  });
  std::vector<unsigned char> memory(1 << 20);
  goes_in<rdm_pool_config>("rdm_pool_create_in", pool_config(), [&](rdm_pool_config* c) {
    rdm_pool* p = nullptr;
    const rdm_result r = rdm_pool_create_in(&p, c, memory.data(), memory.size());
    return end_pool(r, p);
  });
  goes_in<rdm_pool_config>("rdm_pool_config_spec", pool_config(),
                           [&](auto* c) { return rdm_pool_config_spec(c, &spec); });
  goes_in<rdm_pool_config>("rdm_pool_config_memory", pool_config(),
                           [&](auto* c) { return rdm_pool_config_memory(c, &n, nullptr); });
  goes_in<rdm_agent_config>("rdm_agent_create", agent_config(), [&](rdm_agent_config* c) {
    rdm_agent* a = nullptr;
    const rdm_result r = rdm_agent_create(&a, c);
    return end_agent(r, a);
  });
  goes_in<rdm_agent_config>("rdm_agent_config_memory", agent_config(),
                            [&](auto* c) { return rdm_agent_config_memory(c, &n); });
  goes_in<rdm_agent_config>("rdm_agent_config_for_pool", agent_config(),
                            [&](auto* c) { return rdm_agent_config_for_pool(c, pool_); });
  goes_in<rdm_host>("rdm_init", rdm_host{}, [](rdm_host* h) {
    const rdm_result r = rdm_init(h);
    if (!r) rdm_shutdown();
    return r;
  });
  goes_in<rdm_host>("config.host", rdm_host{}, [&](rdm_host* h) {
    rdm_pool_config c = pool_config();
    c.host = h;
    return rdm_pool_config_spec(&c, &spec);
  });
  goes_in<rdm_buffers>("rdm_pool_set_buffers", rdm_buffers{},
                       [&](auto* b) { return rdm_pool_set_buffers(pool_, b); });
  const float reward[4] = {}, cost[4] = {}, obs[12] = {};
  float action[8];
  rdm_transition t{};
  t.reward = reward;
  t.cost = cost;
  goes_in<rdm_transition>("rdm_agent_record", t, [&](auto* in) {
    rdm_agent_act(agent_, obs, RDM_ACT_SAMPLE, action);  // STATE while one waits for its record
    return rdm_agent_record(agent_, in);
  });
  goes_in<rdm_spec>("rdm_policy_check", spec, [&](auto* s) { return rdm_policy_check(policy_, s); });
  rdm_map_config mc{};
  ASSERT_EQ(rdm_map_config_init(&mc, sizeof mc), RDM_OK);
  goes_in<rdm_map_config>("rdm_map_create", mc, [&](rdm_map_config* c) {
    rdm_map* m = nullptr;
    const rdm_result r = rdm_map_create(&m, c);
    rdm_map_destroy(m);
    return r;
  });
  rdm_planner_config pc{};
  ASSERT_EQ(rdm_planner_config_init(&pc, sizeof pc), RDM_OK);
  pc.pool = pool_;
  pc.settings = "samples=2\nhorizon=2";
  goes_in<rdm_planner_config>("rdm_planner_create", pc, [&](rdm_planner_config* c) {
    rdm_planner* planner = nullptr;
    const rdm_result r = rdm_planner_create(&planner, c);
    rdm_planner_destroy(planner);
    return r;
  });
}

TEST_F(Structs, ThatComeOutHaveASizeThatCanBe) {
  sizes<rdm_build>("rdm_build_info", {}, [](auto* io) { return rdm_build_info(io); });
  sizes<rdm_task>("rdm_task_at", {}, [](auto* io) { return rdm_task_at(0, io); });
  sizes<rdm_algo>("rdm_algo_at", {}, [](auto* io) { return rdm_algo_at(0, io); });
  sizes<rdm_robot>("rdm_robot_at", {}, [](auto* io) { return rdm_robot_at(0, io); });
  sizes<rdm_spec>("rdm_pool_config_spec", {}, [](auto* io) {
    const rdm_pool_config c = pool_config();
    return rdm_pool_config_spec(&c, io);
  });
  sizes<rdm_spec>("rdm_pool_get_spec", {}, [&](auto* io) { return rdm_pool_get_spec(pool_, io); });
  sizes<rdm_buffers>("rdm_pool_get_buffers", {}, [&](auto* io) { return rdm_pool_get_buffers(pool_, io); });
  sizes<rdm_joint_info>("rdm_robot_joint_at", {}, [](auto* io) { return rdm_robot_joint_at(0, 0, io); });
  sizes<rdm_joint_info>("rdm_pool_joint_at", {}, [&](auto* io) { return rdm_pool_joint_at(pool_, 0, io); });
  const double origin[] = {0, 0, 9}, down[] = {0, 0, -1};
  sizes<rdm_ray_hit>("rdm_pool_raycast", {},
                     [&](auto* io) { return rdm_pool_raycast(pool_, 0, origin, down, 100, io); });
  sizes<rdm_pool_stats>("rdm_pool_get_stats", {}, [&](auto* io) { return rdm_pool_get_stats(pool_, io); });
  sizes<rdm_sensors>("rdm_pool_get_sensors", {}, [&](auto* io) { return rdm_pool_get_sensors(pool_, io); });
  sizes<rdm_map_info>("rdm_map_get_info", {}, [&](auto* io) { return rdm_map_get_info(map_, io); });
  sizes<rdm_policy_info>("rdm_policy_get_info", {},
                         [&](auto* io) { return rdm_policy_get_info(policy_, io); });
  const float obs[12] = {};
  sizes<rdm_epoch>("rdm_agent_update", {}, [&](auto* io) { return rdm_agent_update(agent_, obs, io); });
  sizes<rdm_epoch>("rdm_agent_rollout", {}, [&](auto* io) {
    const rdm_result r = rdm_agent_rollout(agent_, pool_, io);  // the dimensions differ: refused later
    return r == RDM_ERROR_ARGUMENT && !std::strstr(rdm_last_error(), "struct_size") ? RDM_OK : r;
  });
}

TEST_F(Structs, InitFunctionsFillNoMoreThanAStructCanHave) {
  alignas(64) static unsigned char bytes[65536];
  const auto tried = [&](const char* name, auto&& init, size_t first) {
    SCOPED_TRACE(name);
    for (const size_t size : {size_t{0}, first - 1, size_t{4097}, size_t{65536}, SIZE_MAX}) {
      std::memset(bytes, 0x5a, sizeof bytes);
      EXPECT_EQ(init(bytes, size), RDM_ERROR_ARGUMENT) << size;
      for (const unsigned char b : bytes) ASSERT_EQ(b, 0x5a);
    }
    EXPECT_EQ(init(bytes, 4096), RDM_OK);
    EXPECT_EQ(bytes[4095], 0);
    EXPECT_EQ(bytes[4096], 0x5a);
  };
  tried(
      "rdm_pool_config_init",
      [](void* c, size_t n) { return rdm_pool_config_init(static_cast<rdm_pool_config*>(c), n); },
      offsetof(rdm_pool_config, settings));
  tried(
      "rdm_agent_config_init",
      [](void* c, size_t n) { return rdm_agent_config_init(static_cast<rdm_agent_config*>(c), n); },
      offsetof(rdm_agent_config, settings));
  tried(
      "rdm_map_config_init",
      [](void* c, size_t n) { return rdm_map_config_init(static_cast<rdm_map_config*>(c), n); },
      offsetof(rdm_map_config, error));
  tried(
      "rdm_planner_config_init",
      [](void* c, size_t n) { return rdm_planner_config_init(static_cast<rdm_planner_config*>(c), n); },
      offsetof(rdm_planner_config, stop));
}

// What a newer caller's struct has and this library does not know is 0, not what stood there.
TEST_F(Structs, TailsOfNewerCallersAreZeroed) {
  const auto zeroed = [](const char* name, auto value, auto&& call) {
    SCOPED_TRACE(name);
    Roomy<decltype(value)> out;
    std::memset(out.bytes, 0x5a, sizeof out.bytes);
    out.get()->struct_size = sizeof value + 24;
    ASSERT_EQ(call(out.get()), RDM_OK) << rdm_last_error();
    EXPECT_EQ(out.get()->struct_size, sizeof value + 24);
    for (size_t i = sizeof value; i < sizeof value + 24; ++i) EXPECT_EQ(out.bytes[i], 0) << i;
    EXPECT_EQ(out.bytes[sizeof value + 24], 0x5a);
  };
  zeroed("rdm_build", rdm_build{}, [](auto* io) { return rdm_build_info(io); });
  zeroed("rdm_task", rdm_task{}, [](auto* io) { return rdm_task_at(0, io); });
  zeroed("rdm_spec", rdm_spec{}, [&](auto* io) { return rdm_pool_get_spec(pool_, io); });
  zeroed("rdm_buffers", rdm_buffers{}, [&](auto* io) { return rdm_pool_get_buffers(pool_, io); });
  zeroed("rdm_pool_stats", rdm_pool_stats{}, [&](auto* io) { return rdm_pool_get_stats(pool_, io); });
  zeroed("rdm_policy_info", rdm_policy_info{}, [&](auto* io) { return rdm_policy_get_info(policy_, io); });
  zeroed("rdm_map_info", rdm_map_info{}, [&](auto* io) { return rdm_map_get_info(map_, io); });
  zeroed("rdm_sensors", rdm_sensors{}, [&](auto* io) { return rdm_pool_get_sensors(pool_, io); });
}

}  // namespace
