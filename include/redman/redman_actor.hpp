// redman_actor.hpp: C++17 over experimental headers, as redman.hpp is over the stable ones: the owner
// of an actor. May change until version 1.
//
//   redman::Actor actor(redman::actor_config(policy, pool));
//   actor.act(pool);  pool.step();  actor.reset(pool.buffers().terminated, pool.buffers().truncated);
#ifndef REDMAN_ACTOR_HPP
#define REDMAN_ACTOR_HPP
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <redman/redman.hpp>

namespace redman {

// The defaults of rdm_actor_config_init for a policy in a pool's worlds; both are borrowed, the policy as
// long as the actor lives.
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
  // action [num_envs][action_dim] of worlds in the mask (null: all), new ones on obs [num_envs][obs_dim]
  // where they are due; seen: clouds of a policy that sees points.
  void act(const float* obs, float* action, const uint8_t* mask = nullptr, const rdm_points* seen = nullptr) {
    check(rdm_actor_act(get(), obs, seen, mask, action));
  }
  // The pool's own rows.
  void act(Pool& pool, const uint8_t* mask = nullptr, const rdm_points* seen = nullptr) {
    act(pool.obs().data(), pool.action().data(), mask, seen);
  }
  // Episodes begin anew where one of the two [num_envs] is not 0; both null: everywhere.
  void reset(const uint8_t* terminated = nullptr, const uint8_t* truncated = nullptr) {
    check(rdm_actor_reset(get(), terminated, truncated));
  }
  Bytes state() const {
    size_t size = 0;
    check(rdm_actor_write_state(get(), nullptr, 0, &size));
    Bytes bytes(size);
    check(rdm_actor_write_state(get(), bytes.data(), bytes.size(), &size));
    return bytes;
  }
  void set_state(const Bytes& bytes) { check(rdm_actor_read_state(get(), bytes.data(), bytes.size())); }

 private:
  Handle<rdm_actor, rdm_actor_destroy> handle_;
};

}  // namespace redman
#endif
