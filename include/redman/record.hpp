// redman/record.hpp: the owner of a recording, and what is learned from one. C++17, experimental.
//
//   redman::Recording r(pool);
//   r.begin_step(pool, label.data());  pool.step();  r.end_step(pool);
//   rdm_clone_report report = redman::clone(agent, r);
#ifndef REDMAN_RECORD_HPP
#define REDMAN_RECORD_HPP
#include <redman/record.h>

#include <redman/agent.hpp>

namespace redman {

// The defaults of rdm_recording_config_init, for rows of a pool; its pointers are borrowed from the
// pool.
inline rdm_recording_config recording_config(const Pool& pool) {
  rdm_recording_config c;
  check(rdm_recording_config_init(&c, sizeof c));
  check(rdm_recording_config_for_pool(&c, pool.get()));
  return c;
}

class Recording {
 public:
  Recording() = default;  // empty: get() is null
  explicit Recording(const rdm_recording_config& config)
      : handle_(made(rdm_recording_create, &config)) {}
  // Takes memory for `capacity` rows at once.
  explicit Recording(const Pool& pool, int64_t capacity = 0) {
    rdm_recording_config c = recording_config(pool);
    c.capacity = capacity;
    handle_ = Owner(made(rdm_recording_create, static_cast<const rdm_recording_config*>(&c)));
  }
  explicit Recording(const char* path) : handle_(made(rdm_recording_read_file, path)) {}

  rdm_recording* get() const { return handle_.get(); }
  explicit operator bool() const { return get() != nullptr; }
  rdm_recording_info info() const {
    auto io = sized<rdm_recording_info>();
    check(rdm_recording_get_info(get(), &io));
    return io;
  }
  // Borrowed, until the next call that changes the recording.
  rdm_recording_rows rows() const {
    auto io = sized<rdm_recording_rows>();
    check(rdm_recording_get_rows(get(), &io));
    return io;
  }
  // label [num_envs][action_dim], null: the actions; mask [num_envs], null: all.
  void begin_step(const Pool& pool, const float* label = nullptr, const uint8_t* mask = nullptr) {
    check(rdm_recording_begin_step(get(), pool.get(), label, mask));
  }
  void end_step(const Pool& pool, const uint8_t* mask = nullptr) {
    check(rdm_recording_end_step(get(), pool.get(), mask));
  }
  void append(const rdm_recording_rows& rows) { check(rdm_recording_append(get(), &rows)); }
  void append(const Recording& other) { check(rdm_recording_append_all(get(), other.get())); }
  // Drops episodes without success, or above max_cost [cost_dim] (null: any); returns how many.
  int64_t filter(bool need_success, const double* max_cost = nullptr) {
    int64_t dropped = 0;
    check(rdm_recording_filter(get(), need_success, max_cost, &dropped));
    return dropped;
  }
  void clear() { check(rdm_recording_clear(get())); }
  void save(const char* path) const { check(rdm_recording_write_file(get(), path)); }

 private:
  using Owner = Handle<rdm_recording, rdm_recording_destroy>;
  Owner handle_;
};

inline rdm_clone_config clone_config() {
  rdm_clone_config c;
  check(rdm_clone_config_init(&c, sizeof c));
  return c;
}
inline rdm_clone_report clone(Agent& agent, const Recording& recording,
                              const rdm_clone_config& how = clone_config()) {
  auto report = sized<rdm_clone_report>();
  check(rdm_agent_clone(agent.get(), recording.get(), &how, &report));
  return report;
}
inline rdm_learn_report learn(Agent& agent, const Recording& recording, int64_t steps) {
  auto report = sized<rdm_learn_report>();
  check(rdm_agent_learn(agent.get(), recording.get(), steps, &report));
  return report;
}

}  // namespace redman
#endif
