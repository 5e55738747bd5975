#include "play/playback.hpp"

#include <algorithm>

// rdm_pool_get_hull; the header gives its experimental part to a file that has seen the rest before, too
#define RDM_EXPERIMENTAL
#include <redman/redman.h>

#include "common/names.hpp"

namespace tool {
namespace {

Body body_at(const redman::Pool& pool, int32_t index) {
  rdm_shape_info shape = RDM_INIT(rdm_shape_info);
  redman::check(rdm_pool_shape_at(pool.get(), index, &shape));
  Body body;
  body.name = shape.name;
  body.kind = shape.kind;
  for (int k = 0; k < 3; ++k) body.size[k] = static_cast<float>(shape.size[k]);
  std::copy_n(shape.color, 3, body.color);
  if (shape.kind != RDM_SHAPE_HULL) return body;
  size_t count = 0;
  redman::check(rdm_pool_get_hull(pool.get(), index, nullptr, 0, &count));
  body.corners.resize(3 * count);
  redman::check(rdm_pool_get_hull(pool.get(), index, body.corners.data(), count, &count));
  return body;
}

template <class T>
void append_row(std::vector<T>& all, const redman::View<T>& row) {
  all.insert(all.end(), row.begin(), row.end());
}

}  // namespace

bool Playback::moves(size_t body) const {
  for (size_t k = 1; k < frames; ++k)
    if (!std::equal(pose(k, body), pose(k, body) + 7, pose(0, body))) return true;
  return false;
}

Playback begin_playback(const redman::Pool& pool, const std::vector<double>& limits) {
  const rdm_spec& spec = pool.spec();
  Playback out;
  out.task = task_at(spec.task).name;
  out.summary = task_at(spec.task).summary;
  out.control_dt = static_cast<double>(spec.control_dt);
  out.first_step = pool.buffers().episode_step[0];
  for (int32_t i = 0; i < spec.num_shapes; ++i) out.bodies.push_back(body_at(pool, i));
  for (int32_t i = 0; i < task_at(spec.task).num_cameras; ++i) {
    out.cameras.push_back(RDM_INIT(rdm_camera_info));
    redman::check(rdm_task_camera_at(spec.task, i, &out.cameras.back()));
  }
  for (const rdm_cost_info& c : task_costs(spec.task))
    out.costs.push_back({c.name, c.help, limits[out.costs.size()]});
  return out;
}

void add_frame(Playback& p, const redman::Pool& pool) {
  for (const rdm_pose& pose : pool.poses()) {
    for (const double v : pose.p) p.poses.push_back(static_cast<float>(v));
    for (const double v : pose.q) p.poses.push_back(static_cast<float>(v));
  }
  p.reward.push_back(pool.reward()[0]);
  p.episode_return.push_back(pool.episode_return()[0]);
  append_row(p.cost, pool.cost()[0]);
  append_row(p.episode_cost, pool.episode_cost()[0]);
  p.success.push_back(pool.success()[0]);
  size_t count = 0;
  redman::check(rdm_pool_get_contacts(pool.get(), 0, nullptr, 0, &count));
  const size_t before = p.contacts.size();
  p.contacts.resize(before + count);
  redman::check(rdm_pool_get_contacts(pool.get(), 0, p.contacts.data() + before, count, &count));
  p.contacts_end.push_back(p.contacts.size());
  p.terminated = pool.terminated()[0] != 0;
  ++p.frames;
}

}  // namespace tool
