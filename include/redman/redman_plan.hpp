// redman_plan.hpp: C++17 over experimental headers, as redman.hpp is over the stable ones: the owner of
// a planner. May change until version 1.
//
//   redman::Planner planner(redman::planner_config(pool, "method=cem\nhorizon=20"));
//   planner.act(pool, 0, pool.action()[0].data());
#ifndef REDMAN_PLAN_HPP
#define REDMAN_PLAN_HPP
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <redman/redman.hpp>

namespace redman {

// The defaults of rdm_planner_config_init for a pool's worlds, with options as lines key=value; both are
// borrowed.
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
  void reset() { check(rdm_planner_reset(get())); }
  // [horizon][action_dim]
  std::vector<float> plan() const {
    std::vector<float> out(count());
    check(rdm_planner_get_plan(get(), out.data()));
    return out;
  }
  void set_plan(const float* plan) { check(rdm_planner_set_plan(get(), plan)); }
  std::string settings() const {
    return text_of(rdm_planner_settings, static_cast<const rdm_planner*>(get()));
  }
  Bytes state() const {
    size_t size = 0;
    check(rdm_planner_write_state(get(), nullptr, 0, &size));
    Bytes bytes(size);
    check(rdm_planner_write_state(get(), bytes.data(), bytes.size(), &size));
    return bytes;
  }
  void set_state(const Bytes& bytes) { check(rdm_planner_read_state(get(), bytes.data(), bytes.size())); }

 private:
  size_t count() const { return static_cast<size_t>(spec_.horizon) * static_cast<size_t>(spec_.action_dim); }
  Handle<rdm_planner, rdm_planner_destroy> handle_;
  rdm_planner_spec spec_ = sized<rdm_planner_spec>();
};

}  // namespace redman
#endif
