// A handle of another kind, or one that was destroyed, is an error and no crash.
#include <array>
#include <functional>

#include "contract.hpp"

namespace {

// Memory that is released but never given to anybody else, so that reading it once more is defined.
struct KeepingHost {
  std::vector<void*> kept;
  rdm_host hooks{sizeof(rdm_host), 0, this, alloc, release, nullptr, nullptr};
  static void* alloc(void* user, size_t bytes, size_t align) {
    void* p = nullptr;
    if (posix_memalign(&p, align, bytes) != 0) return nullptr;
    static_cast<KeepingHost*>(user)->kept.push_back(p);
    return p;
  }
  static void release(void*, void*, size_t, size_t) {}
  ~KeepingHost() {
    for (void* p : kept) std::free(p);
  }
};

struct Handles {
  KeepingHost host;
  rdm_pool* pool = nullptr;
  rdm_agent* agent = nullptr;
  rdm_policy* policy = nullptr;
  rdm_map* map = nullptr;
  rdm_planner* planner = nullptr;
  rdm_actor* actor = nullptr;

  Handles() {
    rdm_pool_config p = pool_config(1);
    p.task = "bandit";
    p.host = &host.hooks;
    pool = make_pool(p);
    rdm_agent_config a = agent_config();
    a.host = &host.hooks;
    agent = make_agent(a);
    const auto file = policy_bytes(agent);
    EXPECT_EQ(rdm_init(&host.hooks), RDM_OK);
    EXPECT_EQ(rdm_policy_read(&policy, file.data(), file.size()), RDM_OK);
    rdm_shutdown();
    rdm_map_config m;
    EXPECT_EQ(rdm_map_config_init(&m, sizeof m), RDM_OK);
    m.host = &host.hooks;
    EXPECT_EQ(rdm_map_create(&map, &m), RDM_OK);
    rdm_planner_config n;
    EXPECT_EQ(rdm_planner_config_init(&n, sizeof n), RDM_OK);
    n.pool = pool;
    n.settings = "samples=2\nhorizon=2";
    n.host = &host.hooks;
    EXPECT_EQ(rdm_planner_create(&planner, &n), RDM_OK);
    rdm_actor_config o;
    EXPECT_EQ(rdm_actor_config_init(&o, sizeof o), RDM_OK);
    o.policy = policy;
    o.num_envs = 1;
    o.host = &host.hooks;
    EXPECT_EQ(rdm_actor_create(&actor, &o), RDM_OK);
  }
  ~Handles() {
    rdm_pool_destroy(pool);
    rdm_agent_destroy(agent);
    rdm_actor_destroy(actor);
    rdm_policy_destroy(policy);
    rdm_map_destroy(map);
    rdm_planner_destroy(planner);
  }
};

// Every call of a kind with `h` in the place of its handle; other arguments are good ones.
using Call = std::function<rdm_result(void* h, Handles& good)>;
char g_bytes[1 << 16];
size_t g_size;
float g_floats[4096];
double g_three[3] = {0, 0, 1};
rdm_pose g_poses[256];
int32_t g_number;
uint64_t g_hash;
const char* g_key;
template <class T>
T* sized() {
  static T value;
  value = T{};
  value.struct_size = sizeof value;
  return &value;
}
template <class T>
T* plain() {
  static T value;
  return &value;
}

#define POOL static_cast<rdm_pool*>(h)
#define AGENT static_cast<rdm_agent*>(h)
#define POLICY static_cast<rdm_policy*>(h)
#define MAP static_cast<rdm_map*>(h)
#define ACTOR static_cast<rdm_actor*>(h)
#define PLANNER static_cast<rdm_planner*>(h)
#define CALL(expression)                     \
  [](void* h, Handles& good) -> rdm_result { \
    (void)h, (void)good;                     \
    return expression;                       \
  }

const std::vector<Call> kPoolCalls = {
    CALL(rdm_pool_get_spec(POOL, sized<rdm_spec>())),
    CALL(rdm_pool_field_at(POOL, 0, sized<rdm_field_info>())),
    CALL(rdm_pool_get_initial_mean(POOL, g_floats)),
    CALL(rdm_pool_setting_at(POOL, 0, &g_key, g_bytes)),
    CALL(rdm_pool_get_settings(POOL, nullptr, 0, &g_size)),
    CALL(rdm_pool_get_buffers(POOL, sized<rdm_buffers>())),
    CALL(rdm_pool_set_buffers(POOL, sized<rdm_buffers>())),
    CALL(rdm_pool_reset(POOL, nullptr, nullptr)),
    CALL(rdm_pool_step(POOL)),
    CALL(rdm_pool_step_masked(POOL, reinterpret_cast<const uint8_t*>(g_bytes))),
    CALL(rdm_pool_baseline(POOL, 0)),
    CALL(rdm_pool_write_state(POOL, 0, nullptr, 0, &g_size)),
    CALL(rdm_pool_write_state(POOL, 0, g_bytes, sizeof g_bytes, &g_size)),
    CALL(rdm_pool_read_state(POOL, 0, g_bytes, 8)),
    CALL(rdm_pool_get_hash(POOL, 0, &g_hash)),
    CALL(rdm_pool_shape_at(POOL, 0, sized<rdm_shape_info>())),
    CALL(rdm_pool_get_poses(POOL, 0, g_poses)),
    CALL(rdm_pool_get_contacts(POOL, 0, nullptr, 0, &g_size)),
    CALL(rdm_pool_render(POOL, 0, "front", 8, 8, nullptr, g_floats, nullptr)),
    CALL(rdm_pool_get_stats(POOL, sized<rdm_pool_stats>())),
    CALL(rdm_pool_push(POOL, 0, 0, g_floats)),
    CALL(rdm_pool_joint_at(POOL, 0, sized<rdm_joint_info>())),
    CALL(rdm_pool_get_joints(POOL, 0, nullptr, nullptr, 0)),
    CALL(rdm_pool_set_joints(POOL, 0, nullptr, nullptr, 0)),
    CALL(rdm_pool_raycast(POOL, 0, g_three, g_three, 1, sized<rdm_ray_hit>())),
    CALL(rdm_pool_copy(POOL, 0, good.pool, 0)),
    CALL(rdm_pool_copy(good.pool, 0, POOL, 0)),
    CALL(rdm_planner_act(good.planner, POOL, 0, g_floats, nullptr)),
    CALL(rdm_pool_get_sensors(POOL, sized<rdm_sensors>())),
    CALL(rdm_pool_sensor_camera_at(POOL, 0, 0, sized<rdm_camera_info>())),
    CALL(rdm_pool_get_hull(POOL, 0, nullptr, 0, &g_size)),
    CALL(rdm_agent_config_for_pool(sized<rdm_agent_config>(), POOL)),
    CALL(rdm_agent_rollout(good.agent, POOL, nullptr)),
    CALL(rdm_map_scan(good.map, POOL, 0, "front", 8, 8, nullptr, 0, nullptr)),
    CALL(rdm_checkpoint_write("/no/such/folder/file", good.agent, POOL, nullptr, 0)),
};
const std::vector<Call> kAgentCalls = {
    CALL(rdm_agent_act(AGENT, g_floats, RDM_ACT_MEAN, g_floats + 100)),
    CALL(rdm_agent_record(AGENT, sized<rdm_transition>())),
    CALL(rdm_agent_update(AGENT, g_floats, nullptr)),
    CALL(rdm_agent_rollout(AGENT, good.pool, nullptr)),
    CALL(rdm_agent_set_option(AGENT, plain<rdm_option>())),
    CALL(rdm_agent_setting_at(AGENT, 0, &g_key, g_bytes)),
    CALL(rdm_agent_get_settings(AGENT, nullptr, 0, &g_size)),
    CALL(rdm_agent_get_values(AGENT, g_floats, 1, g_floats + 100, nullptr)),
    CALL(rdm_agent_tensor_at(AGENT, 0, plain<rdm_tensor>())),
    CALL(rdm_agent_get_tensor(AGENT, "actor.0.weight", g_floats, 24)),
    CALL(rdm_agent_set_tensor(AGENT, "actor.0.weight", g_floats, 24)),
    CALL(rdm_policy_update_from(good.policy, AGENT)),
    CALL(rdm_agent_write_policy(AGENT, nullptr, 0, &g_size)),
    CALL(rdm_agent_write_policy_file(AGENT, "/no/such/folder/file")),
    CALL(rdm_agent_write_state(AGENT, nullptr, 0, &g_size)),
    CALL(rdm_agent_read_state(AGENT, g_bytes, 8)),
    CALL(rdm_checkpoint_write("/no/such/folder/file", AGENT, nullptr, nullptr, 0)),
    CALL(rdm_checkpoint_read("/no/such/folder/file", AGENT, nullptr, nullptr, 0, &g_size)),
};
const std::vector<Call> kPolicyCalls = {
    CALL(rdm_policy_get_info(POLICY, sized<rdm_policy_info>())),
    CALL(rdm_policy_act(POLICY, g_floats, 1, nullptr, g_floats + 100, g_bytes, sizeof g_bytes)),
    CALL(rdm_policy_sample(POLICY, g_floats, 1, nullptr, g_floats + 100, nullptr, g_bytes, sizeof g_bytes)),
    CALL(rdm_policy_update_from(POLICY, good.agent)),
    CALL(rdm_policy_field_at(POLICY, 0, sized<rdm_field_info>())),
    CALL(rdm_policy_tensor_at(POLICY, 0, plain<rdm_tensor>())),
    CALL(rdm_policy_get_tensor(POLICY, "actor.0.weight", g_floats, 24)),
    CALL(rdm_policy_check(POLICY, sized<rdm_spec>())),
};
const std::vector<Call> kMapCalls = {
    CALL(rdm_map_get_info(MAP, sized<rdm_map_info>())),
    CALL(rdm_map_clear(MAP)),
    CALL(rdm_map_insert(MAP, g_floats, g_floats, 1, nullptr)),
    CALL(rdm_map_scan(MAP, good.pool, 0, "front", 8, 8, nullptr, 0, nullptr)),
    CALL(rdm_map_get_probabilities(MAP, g_floats, 1, g_floats + 100)),
    CALL(rdm_map_get_voxels(MAP, g_floats, g_floats, nullptr, 0, &g_size)),
    CALL(rdm_map_meets(MAP, g_poses, g_floats, &g_number)),
    CALL(rdm_map_raycast(MAP, g_floats, g_floats, 1, 0, g_floats + 100, &g_number)),
    CALL(rdm_map_get_distances(MAP, g_floats, 1, 1, g_floats + 100)),
    CALL(rdm_map_get_grid(MAP, g_poses, plain<std::array<int32_t, 3>>()->data(), 1,
                          reinterpret_cast<int8_t*>(g_bytes))),
    CALL(rdm_map_write(MAP, 0, nullptr, 0, &g_size)),
    CALL(rdm_map_write_file(MAP, "/no/such/folder/file.bt")),
    CALL(rdm_map_read(MAP, g_bytes, 8)),
    CALL(rdm_map_read_file(MAP, "/no/such/folder/file.bt")),
};

const std::vector<Call> kPlannerCalls = {
    CALL(rdm_planner_get_spec(PLANNER, sized<rdm_planner_spec>())),
    CALL(rdm_planner_get_settings(PLANNER, nullptr, 0, &g_size)),
    CALL(rdm_planner_act(PLANNER, good.pool, 0, g_floats, nullptr)),
    CALL(rdm_planner_reset(PLANNER)),
    CALL(rdm_planner_get_plan(PLANNER, g_floats)),
    CALL(rdm_planner_set_plan(PLANNER, g_floats)),
    CALL(rdm_planner_write_state(PLANNER, nullptr, 0, &g_size)),
    CALL(rdm_planner_read_state(PLANNER, g_bytes, 8)),
};

const std::vector<Call> kActorCalls = {
    CALL(rdm_actor_act(ACTOR, g_floats, nullptr, nullptr, g_floats)),
    CALL(rdm_actor_reset(ACTOR, nullptr, nullptr)),
    CALL(rdm_actor_write_state(ACTOR, nullptr, 0, &g_size)),
    CALL(rdm_actor_read_state(ACTOR, g_bytes, 8)),
};

void expect_refused(const std::vector<Call>& calls, void* h, Handles& good, const char* text) {
  for (size_t i = 0; i < calls.size(); ++i) {
    EXPECT_EQ(calls[i](h, good), RDM_ERROR_ARGUMENT) << "call " << i;
    EXPECT_NE(std::strstr(rdm_last_error(), text), nullptr) << "call " << i << ": " << rdm_last_error();
  }
}

TEST(Handles, OfAnotherKindAreNamed) {
  Handles good;
  EXPECT_EQ(rdm_pool_step(reinterpret_cast<rdm_pool*>(good.agent)), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_agent_error(good.agent), "");  // whose own text stays what it was
  expect_refused(kPoolCalls, good.agent, good, "pool: it is a handle of another kind, agent");
  expect_refused(kAgentCalls, good.pool, good, "agent: it is a handle of another kind, pool");
  expect_refused(kPolicyCalls, good.map, good, "policy: it is a handle of another kind, map");
  expect_refused(kMapCalls, good.policy, good, "map: it is a handle of another kind, policy");
  expect_refused(kPlannerCalls, good.pool, good, "planner: it is a handle of another kind, pool");
  expect_refused(kActorCalls, good.policy, good, "actor: it is a handle of another kind, policy");
}

TEST(Handles, ThatWereDestroyedAreRefused) {
  Handles good, ended;
  rdm_pool_destroy(ended.pool);
  rdm_agent_destroy(ended.agent);
  rdm_actor_destroy(ended.actor);
  rdm_policy_destroy(ended.policy);
  rdm_map_destroy(ended.map);
  rdm_planner_destroy(ended.planner);
  expect_refused(kPoolCalls, ended.pool, good, "destroyed");
  expect_refused(kAgentCalls, ended.agent, good, "destroyed");
  expect_refused(kPolicyCalls, ended.policy, good, "destroyed");
  expect_refused(kMapCalls, ended.map, good, "destroyed");
  expect_refused(kPlannerCalls, ended.planner, good, "destroyed");
  expect_refused(kActorCalls, ended.actor, good, "destroyed");
  EXPECT_NE(std::strstr(rdm_pool_error(ended.pool), "destroyed"), nullptr);
  EXPECT_NE(std::strstr(rdm_agent_error(ended.agent), "destroyed"), nullptr);
  EXPECT_NE(std::strstr(rdm_map_error(ended.map), "destroyed"), nullptr);
  EXPECT_NE(std::strstr(rdm_planner_error(ended.planner), "destroyed"), nullptr);
  EXPECT_NE(std::strstr(rdm_actor_error(ended.actor), "destroyed"), nullptr);
  EXPECT_EQ(rdm_policy_scratch(ended.policy, 1), 0u);
  rdm_agent_cancel(ended.agent);
}  // and are destroyed a second time here

TEST(Handles, OfAnotherKindAreNotDestroyed) {
  Handles good;
  rdm_pool_destroy(reinterpret_cast<rdm_pool*>(good.agent));
  rdm_agent_destroy(reinterpret_cast<rdm_agent*>(good.pool));
  rdm_policy_destroy(reinterpret_cast<rdm_policy*>(good.map));
  rdm_map_destroy(reinterpret_cast<rdm_map*>(good.policy));
  rdm_planner_destroy(reinterpret_cast<rdm_planner*>(good.pool));
  rdm_actor_destroy(reinterpret_cast<rdm_actor*>(good.policy));
  EXPECT_EQ(rdm_pool_reset(good.pool, nullptr, nullptr), RDM_OK);
  EXPECT_EQ(feed_epoch(good.agent), RDM_OK);
  EXPECT_EQ(rdm_map_clear(good.map), RDM_OK);
  EXPECT_EQ(rdm_planner_reset(good.planner), RDM_OK);
  EXPECT_EQ(rdm_actor_reset(good.actor, nullptr, nullptr), RDM_OK);
  auto* info = sized<rdm_policy_info>();
  EXPECT_EQ(rdm_policy_get_info(good.policy, info), RDM_OK);
  EXPECT_EQ(info->obs_dim, 3);
}

}  // namespace
