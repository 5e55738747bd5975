// redman.hpp: C++17 over redman.h. Owners that end their handle, views of buffers, exceptions; no behaviour
// of its own. What a call does, needs and returns is written in redman.h.
//
//   redman::Pool pool(redman::pool_config("hand_over_safe_finger", 16));
//   pool.reset();
//   for (;;) { pool.baseline(RDM_BASELINE_RANDOM);  pool.step();  use(pool.obs()[i], pool.reward()[i]); }
//
// Everything throws redman::Error, with the code and the text of the library. Owners can be moved, not
// copied; a moved-from owner may only be destroyed or assigned to.
#ifndef REDMAN_HPP
#define REDMAN_HPP
#include <redman/redman.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace redman {

// A failed call: code() is the rdm_result, what() the library's line of text.
class Error : public std::runtime_error {
 public:
  Error(rdm_result code, const std::string& text) : std::runtime_error(text), code_(code) {}
  rdm_result code() const noexcept { return code_; }

 private:
  rdm_result code_;
};

// Throws Error with this thread's text unless r is RDM_OK.
inline void check(rdm_result r) {
  if (r != RDM_OK) throw Error(r, rdm_last_error());
}

// A borrowed run of values: pointer and count.
template <class T>
class View {
 public:
  View(T* data, size_t size) : data_(data), size_(size) {}
  T* data() const { return data_; }
  size_t size() const { return size_; }
  T* begin() const { return data_; }
  T* end() const { return data_ + size_; }
  T& operator[](size_t i) const { return data_[i]; }

 private:
  T* data_ = nullptr;
  size_t size_ = 0;
};

// A borrowed row-major table: operator[] is a row.
template <class T>
class Rows {
 public:
  Rows(T* data, size_t rows, size_t width) : data_(data), rows_(rows), width_(width) {}
  T* data() const { return data_; }
  size_t width() const { return width_; }
  View<T> operator[](size_t row) const { return {data_ + row * width_, width_}; }

 private:
  T* data_ = nullptr;
  size_t rows_ = 0, width_ = 0;
};

// Owns a handle; made() turns a create call into one.
template <auto kDestroy>
struct Destroy {
  template <class T>
  void operator()(T* handle) const {
    kDestroy(handle);
  }
};
template <class T, void (*kDestroy)(T*)>
using Handle = std::unique_ptr<T, Destroy<kDestroy>>;
template <class T, class... Args>
T* made(rdm_result (*create)(T**, Args...), Args... args) {
  T* handle = nullptr;
  check(create(&handle, args...));
  return handle;
}

using Bytes = std::vector<unsigned char>;

// A text of the library's that is asked for its size first: rdm_pool_settings, rdm_agent_settings.
template <class T>
std::string text_of(rdm_result (*write)(const T*, char*, size_t, size_t*), const T* handle) {
  size_t size = 0;
  check(write(handle, nullptr, 0, &size));
  std::string text(size + 1, '\0');
  check(write(handle, text.data(), text.size(), &size));
  text.resize(size);
  return text;
}

// A struct with struct_size set and everything else 0.
template <class T>
T sized() {
  T value{};
  value.struct_size = sizeof(T);
  return value;
}

// The defaults of rdm_pool_config_init with a task, a number of worlds and options as lines key=value. `task`
// and `settings` are borrowed.
inline rdm_pool_config pool_config(const char* task, int32_t num_envs = 1, const char* settings = nullptr) {
  rdm_pool_config c;
  check(rdm_pool_config_init(&c, sizeof c));
  c.task = task;
  c.num_envs = num_envs;
  c.settings = settings;
  return c;
}

class Pool {
 public:
  explicit Pool(const rdm_pool_config& config)
      : handle_(made(rdm_pool_create, &config)), num_envs_(static_cast<size_t>(config.num_envs)) {
    check(rdm_pool_get_spec(get(), &spec_));
    check(rdm_pool_buffers(get(), &buffers_));
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
    check(rdm_pool_bind(get(), &b));
    check(rdm_pool_buffers(get(), &buffers_));
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
    check(rdm_pool_state_size(get(), env, &size));
    Bytes bytes(size);
    check(rdm_pool_get_state(get(), env, bytes.data(), bytes.size(), &size));
    return bytes;
  }
  void set_state(const Bytes& bytes, int32_t env = -1) {
    check(rdm_pool_set_state(get(), env, bytes.data(), bytes.size()));
  }
  uint64_t hash(int32_t env = -1) const {
    uint64_t h = 0;
    check(rdm_pool_hash(get(), env, &h));
    return h;
  }
  // All options as lines key=value: as pool_config's settings they make the same pool.
  std::string settings() const { return text_of(rdm_pool_settings, static_cast<const rdm_pool*>(get())); }
  std::vector<float> initial_mean() const {
    std::vector<float> mean(static_cast<size_t>(spec_.action_dim));
    check(rdm_pool_initial_mean(get(), mean.data()));
    return mean;
  }
  rdm_pool_stats stats() const {
    auto s = sized<rdm_pool_stats>();
    check(rdm_pool_get_stats(get(), &s));
    return s;
  }
  // [h][w][3] bytes.
  Bytes render(int32_t env, const char* camera, int32_t w, int32_t h) {
    const bool fits = w >= 1 && h >= 1 && w <= 8192 && h <= 8192;  // if not, the call says so
    Bytes rgb(fits ? static_cast<size_t>(w) * static_cast<size_t>(h) * 3 : 0);
    check(rdm_pool_render(get(), env, camera, w, h, rgb.data(), nullptr, nullptr));
    return rgb;
  }

 private:
  Rows<float> table(float* data, int32_t width) const {
    return {data, num_envs_, static_cast<size_t>(width)};
  }
  Handle<rdm_pool, rdm_pool_destroy> handle_;
  rdm_spec spec_ = sized<rdm_spec>();
  rdm_buffers buffers_ = sized<rdm_buffers>();
  size_t num_envs_ = 0;
};

// The defaults of rdm_agent_config_init with the dimensions of a world of the host's own.
inline rdm_agent_config agent_config(int32_t obs_dim, int32_t action_dim, int32_t num_envs) {
  rdm_agent_config c;
  check(rdm_agent_config_init(&c, sizeof c));
  c.obs_dim = obs_dim;
  c.action_dim = action_dim;
  c.num_envs = num_envs;
  return c;
}
// The same as rdm_agent_config_for_pool fills it; arrays are borrowed from the pool.
inline rdm_agent_config agent_config(const Pool& pool) {
  auto c = agent_config(0, 0, 0);
  check(rdm_agent_config_for_pool(&c, pool.get()));
  return c;
}

class Agent {
 public:
  explicit Agent(const rdm_agent_config& config) : handle_(made(rdm_agent_create, &config)) {}
  // Takes over an agent that was made otherwise.
  explicit Agent(rdm_agent* agent) : handle_(agent) {}
  rdm_agent* get() const { return handle_.get(); }
  void act(const float* obs, int32_t mode, float* action) { check(rdm_agent_act(get(), obs, mode, action)); }
  void record(const rdm_transition& t) { check(rdm_agent_record(get(), &t)); }
  rdm_epoch update(const float* last_obs) {
    auto e = sized<rdm_epoch>();
    check(rdm_agent_update(get(), last_obs, &e));
    return e;
  }
  rdm_epoch rollout(Pool& pool) {
    auto e = sized<rdm_epoch>();
    check(rdm_agent_rollout(get(), pool.get(), &e));
    return e;
  }
  void cancel() noexcept { rdm_agent_cancel(get()); }
  std::string settings() const { return text_of(rdm_agent_settings, static_cast<const rdm_agent*>(get())); }
  // The bytes of a policy file.
  Bytes policy() const { return bytes_of(rdm_agent_policy); }
  Bytes save() const { return bytes_of(rdm_agent_save); }
  void load(const Bytes& bytes) { check(rdm_agent_load(get(), bytes.data(), bytes.size())); }

 private:
  Bytes bytes_of(rdm_result (*write)(const rdm_agent*, void*, size_t, size_t*)) const {
    size_t size = 0;
    check(write(get(), nullptr, 0, &size));
    Bytes bytes(size);
    check(write(get(), bytes.data(), bytes.size(), &size));
    return bytes;
  }
  Handle<rdm_agent, rdm_agent_destroy> handle_;
};

// A policy may be shared between threads; each thread needs scratch memory of its own, at any address.
class Policy {
 public:
  explicit Policy(const char* path) : Policy(made(rdm_policy_load_file, path)) {}
  explicit Policy(const Bytes& bytes)
      : Policy(made(rdm_policy_load, static_cast<const void*>(bytes.data()), bytes.size())) {}
  rdm_policy* get() const { return handle_.get(); }
  const rdm_policy_info& info() const { return info_; }
  size_t scratch_bytes(int32_t rows) const { return rdm_policy_scratch(get(), rows); }
  void act(const float* obs, int32_t rows, const float* noise, float* action, void* scratch,
           size_t scratch_bytes) const {
    check(rdm_policy_act(get(), obs, rows, noise, action, scratch, scratch_bytes));
  }
  // The same with scratch from the heap, for who does not count calls.
  void act(const float* obs, int32_t rows, const float* noise, float* action) const {
    Bytes scratch(scratch_bytes(rows));
    act(obs, rows, noise, action, scratch.data(), scratch.size());
  }
  std::vector<rdm_tensor> tensors() const {
    std::vector<rdm_tensor> out;
    rdm_tensor t;
    for (int32_t i = 0; rdm_policy_tensor(get(), i, &t) == RDM_OK; ++i) out.push_back(t);
    return out;
  }
  // [rows][cols] values.
  std::vector<float> read(const rdm_tensor& t) const {
    std::vector<float> out(static_cast<size_t>(t.rows) * static_cast<size_t>(t.cols));
    check(rdm_policy_tensor_read(get(), t.name, out.data(), out.size()));
    return out;
  }
  void check_fits(const rdm_spec& spec) const { check(rdm_policy_check(get(), &spec)); }

 private:
  explicit Policy(rdm_policy* p) : handle_(p) { check(rdm_policy_get_info(p, &info_)); }
  Handle<rdm_policy, rdm_policy_destroy> handle_;
  rdm_policy_info info_ = sized<rdm_policy_info>();
};

}  // namespace redman
#endif
