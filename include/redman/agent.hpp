// redman/agent.hpp: the owner of a learner. C++17, stable since 1.0.
#ifndef REDMAN_AGENT_HPP
#define REDMAN_AGENT_HPP
#include <redman/agent.h>

#include <redman/pool.hpp>

namespace redman {

// The defaults of rdm_agent_config_init, with the dimensions of an environment of your own.
inline rdm_agent_config agent_config(int32_t obs_dim, int32_t action_dim, int32_t num_envs) {
  rdm_agent_config c;
  check(rdm_agent_config_init(&c, sizeof c));
  c.obs_dim = obs_dim;
  c.action_dim = action_dim;
  c.num_envs = num_envs;
  return c;
}
// The same, filled by rdm_agent_config_for_pool; arrays are borrowed from the pool.
inline rdm_agent_config agent_config(const Pool& pool) {
  auto c = agent_config(0, 0, 0);
  check(rdm_agent_config_for_pool(&c, pool.get()));
  return c;
}

class Agent {
 public:
  explicit Agent(const rdm_agent_config& config) : handle_(made(rdm_agent_create, &config)) {}
  // Takes ownership of an agent that was made by the C functions.
  explicit Agent(rdm_agent* agent) : handle_(agent) {}
  rdm_agent* get() const { return handle_.get(); }
  void act(const float* obs, int32_t mode, float* action) {
    check(rdm_agent_act(get(), obs, mode, action));
  }
  void record(const rdm_transition& t) { check(rdm_agent_record(get(), &t)); }
  void put(const float* obs, const float* action, const rdm_transition& t) {
    check(rdm_agent_put(get(), obs, action, &t));
  }
  rdm_epoch update(const float* last_obs) {
    auto e = sized<rdm_epoch>();
    check(rdm_agent_update(get(), last_obs, &e));
    return e;
  }
  // The same in slices: begin, then slices until one is the last; epoch, if given, is filled then.
  void update_begin(const float* last_obs) { check(rdm_agent_update_begin(get(), last_obs)); }
  bool update_slice(int32_t units, rdm_epoch* epoch = nullptr) {
    int32_t done = 0;
    check(rdm_agent_update_slice(get(), units, &done, epoch));
    return done != 0;
  }
  rdm_epoch rollout(Pool& pool) {
    auto e = sized<rdm_epoch>();
    check(rdm_agent_rollout(get(), pool.get(), &e));
    return e;
  }
  void cancel() noexcept { rdm_agent_cancel(get()); }
  void discard() { check(rdm_agent_discard(get())); }
  std::string settings() const {
    return text_of(rdm_agent_get_settings, static_cast<const rdm_agent*>(get()));
  }
  // The bytes of a policy file.
  Bytes policy() const {
    return bytes_of(rdm_agent_write_policy, static_cast<const rdm_agent*>(get()));
  }
  Bytes save() const {
    return bytes_of(rdm_agent_write_state, static_cast<const rdm_agent*>(get()));
  }
  void load(const Bytes& bytes) { check(rdm_agent_read_state(get(), bytes.data(), bytes.size())); }

 private:
  Handle<rdm_agent, rdm_agent_destroy> handle_;
};

}  // namespace redman
#endif
