// redman/shield.hpp: owner of a shield. C++17, experimental.
//
//   redman::Shield shield(redman::shield_config(pool, &policy));
//   policy.act(pool.obs().data(), n, nullptr, pool.action().data());
//   shield.act(pool);  pool.step();
#ifndef REDMAN_SHIELD_HPP
#define REDMAN_SHIELD_HPP
#include <redman/shield.h>

#include <redman/agent.hpp>
#include <redman/policy.hpp>
#include <redman/pool.hpp>

namespace redman {

// The defaults of rdm_shield_config_init for a pool's worlds, with a first backup and options as
// lines key=value; all are borrowed, the policy as long as the shield lives.
inline rdm_shield_config shield_config(const Pool& pool, const Policy* policy = nullptr,
                                       const char* settings = nullptr) {
  rdm_shield_config c;
  check(rdm_shield_config_init(&c, sizeof c));
  c.pool = pool.get();
  c.policy = policy ? policy->get() : nullptr;
  c.settings = settings;
  return c;
}

// A half space that a pool's task declares: normal . action <= bound keeps a cost column at 0.
struct Guard {
  rdm_guard info;
  std::vector<float> normal;  // [action_dim]
};
inline std::vector<Guard> guards(const Pool& pool) {
  std::vector<Guard> out;
  Guard g{sized<rdm_guard>(), std::vector<float>(static_cast<size_t>(pool.spec().action_dim))};
  for (int32_t i = 0;; ++i) {
    const rdm_result r = rdm_pool_guard_at(pool.get(), i, &g.info, g.normal.data());
    if (r == RDM_ERROR_RANGE) return out;
    check(r);
    out.push_back(g);
  }
}

// The action nearest to `action`, of `dim` entries, that keeps normals [bounds.size()][dim].
inline std::vector<float> project(const std::vector<float>& normals,
                                  const std::vector<float>& bounds, const float* action,
                                  size_t dim) {
  std::vector<float> out(dim);
  check(rdm_project(normals.data(), bounds.data(), bounds.size(), dim, action, out.data()));
  return out;
}

class Shield {
 public:
  explicit Shield(const rdm_shield_config& config) : handle_(made(rdm_shield_create, &config)) {}
  rdm_shield* get() const { return handle_.get(); }
  void add(const Policy& policy) { check(rdm_shield_add_policy(get(), policy.get())); }  // borrowed
  // normal [action_dim] . action <= bound, for all worlds; then for guard i of one world.
  void add_guard(const float* normal, float bound) {
    check(rdm_shield_add_guard(get(), normal, bound));
  }
  void set_guard(int32_t env, int32_t i, const float* normal, float bound) {
    check(rdm_shield_set_guard(get(), env, i, normal, bound));
  }
  // Writes action [num_envs][action_dim] of the worlds in the mask (null: all), given `proposed`.
  void act(const Pool& pool, const float* proposed, float* action, const uint8_t* mask = nullptr) {
    check(rdm_shield_act(get(), pool.get(), mask, proposed, action));
  }
  // The same for the pool's own actions.
  void act(Pool& pool, const uint8_t* mask = nullptr) {
    act(pool, pool.action().data(), pool.action().data(), mask);
  }
  rdm_shield_row row(const Pool& pool, int32_t env) const {
    auto row = sized<rdm_shield_row>();
    check(rdm_shield_get_row(get(), pool.get(), env, &row));
    return row;
  }
  // The rdm_shield_kind of each world's last decision, [num_envs].
  void kinds(int32_t* kind) const { check(rdm_shield_get_kinds(get(), kind)); }
  void set_plan(const Pool& pool, int32_t env, const float* plan, size_t decisions) {
    check(rdm_shield_set_plan(get(), pool.get(), env, plan, decisions));
  }
  // [decisions][action_dim], empty where there is none.
  std::vector<float> plan(const Pool& pool, int32_t env) const {
    size_t count = 0;
    check(rdm_shield_get_plan(get(), pool.get(), env, nullptr, 0, &count));
    std::vector<float> out(count);
    check(rdm_shield_get_plan(get(), pool.get(), env, out.data(), out.size(), &count));
    return out;
  }
  rdm_shield_stats stats() const {
    auto stats = sized<rdm_shield_stats>();
    check(rdm_shield_get_stats(get(), &stats));
    return stats;
  }
  void reset(const uint8_t* mask = nullptr) { check(rdm_shield_reset(get(), mask)); }
  std::string settings() const {
    return text_of(rdm_shield_get_settings, static_cast<const rdm_shield*>(get()));
  }
  Bytes state() const {
    return bytes_of(rdm_shield_write_state, static_cast<const rdm_shield*>(get()));
  }
  void set_state(const Bytes& bytes) {
    check(rdm_shield_read_state(get(), bytes.data(), bytes.size()));
  }

 private:
  Handle<rdm_shield, rdm_shield_destroy> handle_;
};

// The shield, which is borrowed, checks the agent's rollouts; null: no shield any more.
inline void set_shield(Agent& agent, Shield* shield) {
  check(rdm_agent_set_shield(agent.get(), shield ? shield->get() : nullptr));
}

}  // namespace redman
#endif
