// redman/sense.hpp: what worlds see, and agents and policies that read points. C++17, experimental.
//
//   const rdm_points seen = redman::points(redman::sensors(pool));
//   redman::act(agent, pool.obs().data(), seen, RDM_ACT_SAMPLE, pool.action().data());
#ifndef REDMAN_SENSE_HPP
#define REDMAN_SENSE_HPP
#include <redman/sense.h>

#include <redman/agent.hpp>
#include <redman/policy.hpp>

namespace redman {

// What the pool's worlds see; addresses stay until the pool is destroyed.
inline rdm_sensors sensors(const Pool& pool) {
  auto s = sized<rdm_sensors>();
  check(rdm_pool_get_sensors(pool.get(), &s));
  return s;
}
// [num_points][3] of world env; empty when the modality is off.
inline Rows<const float> points(const rdm_sensors& s, size_t env) {
  const auto n = s.points ? static_cast<size_t>(s.num_points) : 0;
  return {s.points ? s.points + 3 * n * env : nullptr, n, 3};
}

// [height][width][3] bytes of what `picture` says; its own pixels are not looked at.
inline Bytes draw(const Pool& pool, rdm_picture picture) {
  const bool fits = picture.width >= 1 && picture.height >= 1 && picture.width <= 8192 &&
                    picture.height <= 8192;  // if not, the call says so
  const auto w = static_cast<size_t>(picture.width), h = static_cast<size_t>(picture.height);
  Bytes rgb(fits ? w * h * 3 : 0);
  picture.rgb = rgb.data();
  picture.depth = nullptr;
  picture.segmentation = nullptr;
  check(rdm_pool_draw(pool.get(), &picture));
  return rgb;
}

// Clouds [rows][count][3], m, world; classes [rows][count] and colors [rows][count][3] or NULL. All
// are borrowed.
inline rdm_points points(const float* metres, int32_t count, const uint8_t* classes = nullptr,
                         const uint8_t* colors = nullptr) {
  auto p = sized<rdm_points>();
  p.num_points = count;
  p.points = metres;
  p.point_class = classes;
  p.point_color = colors;
  return p;
}
// The clouds of a pool's worlds, borrowed from it.
inline rdm_points points(const rdm_sensors& seen) {
  return points(seen.points, seen.num_points, seen.point_class, seen.point_color);
}

inline void act(const Agent& agent, const float* obs, const rdm_points& seen, int32_t mode,
                float* action) {
  check(rdm_agent_act_points(agent.get(), obs, &seen, mode, action));
}
inline void act(const Policy& policy, const float* obs, const rdm_points& seen, int32_t rows,
                const float* noise, float* action, void* scratch, size_t scratch_bytes) {
  check(
      rdm_policy_act_points(policy.get(), obs, &seen, rows, noise, action, scratch, scratch_bytes));
}
// The same with scratch memory from the heap.
inline void act(const Policy& policy, const float* obs, const rdm_points& seen, int32_t rows,
                const float* noise, float* action) {
  Bytes scratch(policy.scratch_bytes(rows));
  act(policy, obs, seen, rows, noise, action, scratch.data(), scratch.size());
}
// Of a policy with a memory: state [rows][state_dim] becomes that after the decision.
inline void act(const Policy& policy, const float* obs, const rdm_points& seen, float* state,
                int32_t rows, const float* noise, float* action) {
  Bytes scratch(policy.scratch_bytes(rows));
  check(rdm_policy_act_points_state(policy.get(), obs, &seen, state, rows, noise, action,
                                    scratch.data(), scratch.size()));
}

// label [rows][seen.num_points], less than num_labels; the rest of `how` as
// rdm_pretrain_config_init has it.
inline rdm_pretrain_config pretrain_config(int32_t num_labels) {
  rdm_pretrain_config how;
  check(rdm_pretrain_config_init(&how, sizeof how));
  how.num_labels = num_labels;
  return how;
}
inline rdm_pretrain_report pretrain(const Agent& agent, const rdm_points& seen,
                                    const uint8_t* label, int32_t rows,
                                    const rdm_pretrain_config& how) {
  auto report = sized<rdm_pretrain_report>();
  check(rdm_agent_pretrain(agent.get(), &seen, label, rows, &how, &report));
  return report;
}

}  // namespace redman
#endif
