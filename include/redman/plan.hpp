// redman/plan.hpp: owners of actors and planners. C++17, experimental.
//
//   redman::Actor actor(redman::actor_config(policy, pool));
//   actor.act(pool);  pool.step();
//   actor.reset(pool.buffers().terminated, pool.buffers().truncated);
//
//   redman::Planner planner(redman::planner_config(pool, "method=cem\nhorizon=20"));
//   planner.act(pool, 0, pool.action()[0].data());
#ifndef REDMAN_PLAN_HPP
#define REDMAN_PLAN_HPP
#include <redman/plan.h>

#include <redman/policy.hpp>
#include <redman/pool.hpp>

namespace redman {

// The defaults of rdm_actor_config_init for a policy in a pool's worlds; both are borrowed, the
// policy as long as the actor lives.
inline rdm_actor_config actor_config(const Policy& policy, const Pool& pool) {
  rdm_actor_config c;
  check(rdm_actor_config_init(&c, sizeof c));
  c.policy = policy.get();
  c.spec = &pool.spec();
  c.num_envs = static_cast<int32_t>(pool.num_envs());
  return c;
}

class Actor {
 public:
  explicit Actor(const rdm_actor_config& config) : handle_(made(rdm_actor_create, &config)) {}
  rdm_actor* get() const { return handle_.get(); }
  // Writes action [num_envs][action_dim] of the worlds in the mask (null: all): new decisions on
  // obs [num_envs][obs_dim] where they are due; seen: clouds for a policy that reads points.
  void act(const float* obs, float* action, const uint8_t* mask = nullptr,
           const rdm_points* seen = nullptr) {
    check(rdm_actor_act(get(), obs, seen, mask, action));
  }
  // The same for the pool's own rows.
  void act(Pool& pool, const uint8_t* mask = nullptr, const rdm_points* seen = nullptr) {
    act(pool.obs().data(), pool.action().data(), mask, seen);
  }
  // Begins new episodes where one of the two [num_envs] is not 0; both null: everywhere.
  void reset(const uint8_t* terminated = nullptr, const uint8_t* truncated = nullptr) {
    check(rdm_actor_reset(get(), terminated, truncated));
  }
  Bytes state() const {
    return bytes_of(rdm_actor_write_state, static_cast<const rdm_actor*>(get()));
  }
  void set_state(const Bytes& bytes) {
    check(rdm_actor_read_state(get(), bytes.data(), bytes.size()));
  }

 private:
  Handle<rdm_actor, rdm_actor_destroy> handle_;
};

// The defaults of rdm_planner_config_init for a pool's worlds, with options as lines key=value;
// both are borrowed.
inline rdm_planner_config planner_config(const Pool& pool, const char* settings = nullptr) {
  rdm_planner_config c;
  check(rdm_planner_config_init(&c, sizeof c));
  c.pool = pool.get();
  c.settings = settings;
  return c;
}

class Planner {
 public:
  explicit Planner(const rdm_planner_config& config) : handle_(made(rdm_planner_create, &config)) {
    check(rdm_planner_get_spec(get(), &spec_));
  }
  rdm_planner* get() const { return handle_.get(); }
  const rdm_planner_spec& spec() const { return spec_; }
  rdm_plan_info act(const Pool& pool, int32_t env, float* action) {
    auto info = sized<rdm_plan_info>();
    check(rdm_planner_act(get(), pool.get(), env, action, &info));
    return info;
  }
  void cancel() noexcept { rdm_planner_cancel(get()); }  // from any thread or signal handler
  void reset() { check(rdm_planner_reset(get())); }
  // [horizon][action_dim]
  std::vector<float> plan() const {
    std::vector<float> out(count());
    check(rdm_planner_get_plan(get(), out.data()));
    return out;
  }
  void set_plan(const float* plan) { check(rdm_planner_set_plan(get(), plan)); }
  std::string settings() const {
    return text_of(rdm_planner_get_settings, static_cast<const rdm_planner*>(get()));
  }
  Bytes state() const {
    return bytes_of(rdm_planner_write_state, static_cast<const rdm_planner*>(get()));
  }
  void set_state(const Bytes& bytes) {
    check(rdm_planner_read_state(get(), bytes.data(), bytes.size()));
  }

 private:
  size_t count() const {
    return static_cast<size_t>(spec_.horizon) * static_cast<size_t>(spec_.action_dim);
  }
  Handle<rdm_planner, rdm_planner_destroy> handle_;
  rdm_planner_spec spec_ = sized<rdm_planner_spec>();
};

}  // namespace redman
#endif
