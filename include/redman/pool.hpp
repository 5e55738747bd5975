// redman/pool.hpp: the owner of worlds, and views of their rows. C++17, stable since 1.0.
#ifndef REDMAN_POOL_HPP
#define REDMAN_POOL_HPP
#include <redman/pool.h>

#include <redman/base.hpp>

namespace redman {

// The defaults of rdm_pool_config_init with a task, a number of worlds and options as lines
// key=value. `task` and `settings` are borrowed.
inline rdm_pool_config pool_config(const char* task, int32_t num_envs = 1,
                                   const char* settings = nullptr) {
  rdm_pool_config c;
  check(rdm_pool_config_init(&c, sizeof c));
  c.task = task;
  c.num_envs = num_envs;
  c.settings = settings;
  return c;
}

class Pool {
 public:
  explicit Pool(const rdm_pool_config& config) : Pool(made(rdm_pool_create, &config), config) {}
  // Made in memory [bytes], at least Pool::memory(config), which must outlive the pool.
  Pool(const rdm_pool_config& config, void* memory, size_t bytes)
      : Pool(made(rdm_pool_create_in, &config, memory, bytes), config) {}
  static size_t memory(const rdm_pool_config& config) {
    size_t ours = 0;
    check(rdm_pool_config_memory(&config, &ours, nullptr));
    return ours;
  }
  rdm_pool* get() const { return handle_.get(); }
  const rdm_spec& spec() const { return spec_; }
  size_t num_envs() const { return num_envs_; }

  const rdm_buffers& buffers() const { return buffers_; }
  Rows<float> obs() const { return table(buffers_.obs, spec_.obs_dim); }
  Rows<float> action() const { return table(buffers_.action, spec_.action_dim); }
  Rows<float> cost() const { return table(buffers_.cost, spec_.cost_dim); }
  Rows<float> cost_raw() const { return table(buffers_.cost_raw, spec_.cost_dim); }
  Rows<float> episode_cost() const { return table(buffers_.episode_cost, spec_.cost_dim); }
  View<float> reward() const { return {buffers_.reward, num_envs_}; }
  View<float> episode_return() const { return {buffers_.episode_return, num_envs_}; }
  View<uint8_t> terminated() const { return {buffers_.terminated, num_envs_}; }
  View<uint8_t> truncated() const { return {buffers_.truncated, num_envs_}; }
  View<uint8_t> success() const { return {buffers_.success, num_envs_}; }
  View<uint32_t> status() const { return {buffers_.status, num_envs_}; }  // RDM_STATUS_*
  View<uint32_t> episode_status() const {
    return {buffers_.episode_status, num_envs_};
  }  // of the episode so far

  void bind(const rdm_buffers& b) {
    check(rdm_pool_set_buffers(get(), &b));
    check(rdm_pool_get_buffers(get(), &buffers_));
  }
  void reset(const uint64_t* seeds = nullptr, const uint8_t* mask = nullptr) {
    check(rdm_pool_reset(get(), seeds, mask));
  }
  void step() { check(rdm_pool_step(get())); }
  void step(const uint8_t* mask) { check(rdm_pool_step_masked(get(), mask)); }
  void baseline(int32_t kind) { check(rdm_pool_baseline(get(), kind)); }
  // env -1: all worlds.
  Bytes state(int32_t env = -1) const {
    size_t size = 0;
    check(rdm_pool_write_state(get(), env, nullptr, 0, &size));
    Bytes bytes(size);
    check(rdm_pool_write_state(get(), env, bytes.data(), bytes.size(), &size));
    return bytes;
  }
  void set_state(const Bytes& bytes, int32_t env = -1) {
    check(rdm_pool_read_state(get(), env, bytes.data(), bytes.size()));
  }
  // The pose of each shape, in the frame of that world.
  std::vector<rdm_pose> poses(int32_t env = 0) const {
    std::vector<rdm_pose> all(static_cast<size_t>(spec_.num_shapes) + 1);
    check(rdm_pool_get_poses(get(), env, all.data()));
    all.pop_back();
    return all;
  }
  uint64_t hash(int32_t env = -1) const {
    uint64_t h = 0;
    check(rdm_pool_get_hash(get(), env, &h));
    return h;
  }
  // All options as lines key=value: as pool_config's settings they make the same pool.
  std::string settings() const {
    return text_of(rdm_pool_get_settings, static_cast<const rdm_pool*>(get()));
  }
  std::vector<float> initial_mean() const {
    std::vector<float> mean(static_cast<size_t>(spec_.action_dim));
    check(rdm_pool_get_initial_mean(get(), mean.data()));
    return mean;
  }
  rdm_pool_stats stats() const {
    auto s = sized<rdm_pool_stats>();
    check(rdm_pool_get_stats(get(), &s));
    return s;
  }
  rdm_joint_info joint(int32_t i) const {
    auto j = sized<rdm_joint_info>();
    check(rdm_pool_joint_at(get(), i, &j));
    return j;
  }
  // [num_joints] rad, rad/s (m, m/s).
  std::vector<double> joint_positions(int32_t env = 0) const {
    std::vector<double> q(static_cast<size_t>(spec_.num_joints));
    check(rdm_pool_get_joints(get(), env, q.data(), nullptr, q.size()));
    return q;
  }
  std::vector<double> joint_velocities(int32_t env = 0) const {
    std::vector<double> qd(static_cast<size_t>(spec_.num_joints));
    check(rdm_pool_get_joints(get(), env, nullptr, qd.data(), qd.size()));
    return qd;
  }
  // An empty vector changes nothing.
  void set_joints(int32_t env, const std::vector<double>& q, const std::vector<double>& qd = {}) {
    const auto joints = static_cast<size_t>(spec_.num_joints);
    size_t count = joints;  // the call refuses any other count
    for (const auto* given : {&qd, &q})
      if (!given->empty() && given->size() != joints) count = given->size();
    check(rdm_pool_set_joints(get(), env, q.empty() ? nullptr : q.data(),
                              qd.empty() ? nullptr : qd.data(), count));
  }
  // hit.shape is -1 where the ray meets nothing.
  rdm_ray_hit raycast(int32_t env, const double (&origin)[3], const double (&direction)[3],
                      double range) const {
    auto hit = sized<rdm_ray_hit>();
    check(rdm_pool_raycast(get(), env, origin, direction, range, &hit));
    return hit;
  }
  // [h][w][3] bytes.
  Bytes render(int32_t env, const char* camera, int32_t w, int32_t h) {
    const bool fits = w >= 1 && h >= 1 && w <= 8192 && h <= 8192;  // if not, the call says so
    Bytes rgb(fits ? static_cast<size_t>(w) * static_cast<size_t>(h) * 3 : 0);
    check(rdm_pool_render(get(), env, camera, w, h, rgb.data(), nullptr, nullptr));
    return rgb;
  }

 private:
  Pool(rdm_pool* handle, const rdm_pool_config& config)
      : handle_(handle), num_envs_(static_cast<size_t>(config.num_envs)) {
    check(rdm_pool_get_spec(get(), &spec_));
    check(rdm_pool_get_buffers(get(), &buffers_));
  }
  Rows<float> table(float* data, int32_t width) const {
    return {data, num_envs_, static_cast<size_t>(width)};
  }
  Handle<rdm_pool, rdm_pool_destroy> handle_;
  rdm_spec spec_ = sized<rdm_spec>();
  rdm_buffers buffers_ = sized<rdm_buffers>();
  size_t num_envs_ = 0;
};

}  // namespace redman
#endif
