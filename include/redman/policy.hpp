// redman/policy.hpp: the owner of a frozen network. C++17, stable since 1.0.
#ifndef REDMAN_POLICY_HPP
#define REDMAN_POLICY_HPP
#include <redman/policy.h>

#include <redman/base.hpp>

namespace redman {

// A policy may be shared between threads; each thread needs scratch memory of its own, at any
// address.
class Policy {
 public:
  explicit Policy(const char* path) : Policy(made(rdm_policy_read_file, path)) {}
  explicit Policy(const Bytes& bytes)
      : Policy(made(rdm_policy_read, static_cast<const void*>(bytes.data()), bytes.size())) {}
  rdm_policy* get() const { return handle_.get(); }
  const rdm_policy_info& info() const { return info_; }
  size_t scratch_bytes(int32_t rows) const { return rdm_policy_scratch(get(), rows); }
  void act(const float* obs, int32_t rows, const float* noise, float* action, void* scratch,
           size_t scratch_bytes) const {
    check(rdm_policy_act(get(), obs, rows, noise, action, scratch, scratch_bytes));
  }
  // The same with scratch memory from the heap.
  void act(const float* obs, int32_t rows, const float* noise, float* action) const {
    Bytes scratch(scratch_bytes(rows));
    act(obs, rows, noise, action, scratch.data(), scratch.size());
  }
  // How far observations are from those of training, to novelty [rows].
  void novelty(const float* obs, int32_t rows, float* novelty) const {
    check(rdm_policy_novelty(get(), obs, rows, novelty));
  }
  std::vector<rdm_tensor> tensors() const {
    std::vector<rdm_tensor> out;
    rdm_tensor t;
    for (int32_t i = 0;; ++i) {
      const rdm_result r = rdm_policy_tensor_at(get(), i, &t);
      if (r == RDM_ERROR_RANGE) return out;
      check(r);
      out.push_back(t);
    }
  }
  // [rows][cols] values.
  std::vector<float> read(const rdm_tensor& t) const {
    std::vector<float> out(static_cast<size_t>(t.rows) * static_cast<size_t>(t.cols));
    check(rdm_policy_get_tensor(get(), t.name, out.data(), out.size()));
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
