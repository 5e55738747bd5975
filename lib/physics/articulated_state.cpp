// Saving and loading an ArticulatedWorld, and what its worker takes from the heap.
#include <cmath>

#include "base/error.hpp"
#include "physics/articulated_world.hpp"

namespace rdm {
namespace {

constexpr int32_t kTag = 0x41525431;  // ART1; the scalar type is added

bool sound(const Motion& m) {
  const Quat& q = m.X.q;
  const double unit = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  return finite(m.X.p) && finite(m.v) && finite(m.w) && unit > 0.99 && unit < 1.01;
}

template <class S>
bool all_finite(const void* bytes, size_t size) {
  const auto* numbers = static_cast<const S*>(bytes);
  for (size_t i = 0; i < size / sizeof(S); ++i)
    if (!std::isfinite(numbers[i])) return false;
  return true;
}

}  // namespace

void ArticulatedWorld::save(Writer& out) const {
  const bool wide = scene_->def.solver.double_precision;
  out.value(kTag + (wide ? 1 : 0));
  out.value(scene_->num_links);
  out.value(scene_->num_bodies);
  out.value(status_);
  const auto bytes = static_cast<size_t>(scene_->num_links) * sizeof(double);
  for (const double* row : {q_, qd_, target_, torque_}) out.bytes(row, bytes);
  out.bytes(sensors_, scene_->sensors.size() * sizeof(Wrench));
  out.bytes(bases_, scene_->def.articulations.size() * sizeof(Motion));
  out.bytes(bodies_, static_cast<size_t>(scene_->num_bodies) * sizeof(Motion));
  out.bytes(keep_, keep_bytes(*scene_, wide));
  // as many points as there can be, so that the size never changes
  out.value(num_warm_);
  const WarmPoint none{};
  for (int32_t i = 0; i < scene_->def.solver.contacts_max; ++i) out.value(i < num_warm_ ? warm_[i] : none);
}

void ArticulatedWorld::load(Reader& in) {
  const bool wide = scene_->def.solver.double_precision;
  if (in.value<int32_t>() != kTag + (wide ? 1 : 0))
    fail(Code::kFormat, "world state: it is of another engine");
  if (in.value<int32_t>() != scene_->num_links || in.value<int32_t>() != scene_->num_bodies)
    fail(Code::kFormat, "world state: it is of another scene");
  status_ = in.value<uint32_t>();
  const auto bytes = static_cast<size_t>(scene_->num_links) * sizeof(double);
  for (double* row : {q_, qd_, target_, torque_}) in.bytes(row, bytes);
  in.bytes(sensors_, scene_->sensors.size() * sizeof(Wrench));
  in.bytes(bases_, scene_->def.articulations.size() * sizeof(Motion));
  in.bytes(bodies_, static_cast<size_t>(scene_->num_bodies) * sizeof(Motion));
  in.bytes(keep_, keep_bytes(*scene_, wide));
  num_warm_ = in.value<int32_t>();
  in.bytes(warm_, static_cast<size_t>(scene_->def.solver.contacts_max) * sizeof(WarmPoint));
  num_contacts_ = 0;
  pushed_ = false;
  for (size_t i = 0; i < scene_->pairs.size(); ++i) touched_[i] = 0;
  for (int32_t i = 0; i < scene_->num_links; ++i) fresh_[i] = 0;
  bool good = num_warm_ >= 0 && num_warm_ <= scene_->def.solver.contacts_max;
  if (!good) num_warm_ = 0;
  for (int32_t i = 0; i < scene_->num_links; ++i)
    good = good && std::isfinite(q_[i]) && std::isfinite(qd_[i]);
  for (size_t a = 0; a < scene_->def.articulations.size(); ++a) {
    good = good && sound(bases_[a]);
    base_R_[a] = to_matrix(bases_[a].X.q);
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    good = good && sound(bodies_[i]);
    moving_[i].R = to_matrix(bodies_[i].X.q);
  }
  const size_t keep = keep_bytes(*scene_, wide);
  good = good && (wide ? all_finite<double>(keep_, keep) : all_finite<float>(keep_, keep));
  if (!good) fail(Code::kFormat, "world state: a number is not finite");
}

size_t ArticulatedWorld::heap_bytes(const Scene& scene) {
  // The collider's geoms, measured and rounded up; worlds of one worker share them.
  return scene.shapes.size() * 300;
}

}  // namespace rdm
