// Saving and loading an ArticulatedWorld, and what its worker takes from the heap.
#include <cmath>

#include "base/error.hpp"
#include "physics/articulated/articulated_world.hpp"

namespace rdm {
namespace {

constexpr int32_t kTag = 0x41525431;  // ART1; the scalar type is added

bool sound(const Motion& m) {
  const Quat& q = m.X.q;
  const double unit = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  return finite(m.X.p) && finite(m.v) && finite(m.w) && unit > 0.99 && unit < 1.01;
}

// The next `count` numbers.
template <class S>
bool all_finite(Reader& in, size_t count) {
  bool good = true;
  for (size_t i = 0; i < count; ++i) good &= std::isfinite(in.value<S>());
  return good;
}

// Reads a whole state without taking any of it. Error(kFormat) for one this world could not go on from.
void check_state(Reader in, const Scene& scene) {
  const SolverDef& solver = scene.def.solver;
  if (in.value<int32_t>() != kTag + (solver.double_precision ? 1 : 0))
    fail(Code::kFormat, "world state: it is of another engine");
  if (in.value<int32_t>() != scene.num_links || in.value<int32_t>() != scene.num_bodies)
    fail(Code::kFormat, "world state: it is of another scene");
  in.value<uint32_t>();
  const auto links = static_cast<size_t>(scene.num_links);
  bool good = all_finite<double>(in, 2 * links);  // q, qd
  in.view(2 * links * sizeof(double) + scene.sensors.size() * sizeof(Wrench));
  for (size_t i = 0; i < scene.def.articulations.size() + static_cast<size_t>(scene.num_bodies); ++i)
    good &= sound(in.value<Motion>());
  const size_t keep = keep_bytes(scene, solver.double_precision);
  good &= solver.double_precision ? all_finite<double>(in, keep / sizeof(double))
                                  : all_finite<float>(in, keep / sizeof(float));
  const auto warm = in.value<int32_t>();
  good &= warm >= 0 && warm <= solver.contacts_max;
  in.view(static_cast<size_t>(solver.contacts_max) * sizeof(WarmPoint));
  if (!good) fail(Code::kFormat, "world state: a number is not finite or out of range");
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
  check_state(in, *scene_);
  in.view(3 * sizeof(int32_t));
  status_ = in.value<uint32_t>();
  const auto links = static_cast<size_t>(scene_->num_links), bodies = static_cast<size_t>(scene_->num_bodies),
             bases = scene_->def.articulations.size();
  for (double* row : {q_, qd_, target_, torque_}) in.bytes(row, links * sizeof(double));
  in.bytes(sensors_, scene_->sensors.size() * sizeof(Wrench));
  in.bytes(bases_, bases * sizeof(Motion));
  in.bytes(bodies_, bodies * sizeof(Motion));
  in.bytes(keep_, keep_bytes(*scene_, scene_->def.solver.double_precision));
  num_warm_ = in.value<int32_t>();
  in.bytes(warm_, static_cast<size_t>(scene_->def.solver.contacts_max) * sizeof(WarmPoint));
  for (size_t a = 0; a < bases; ++a) base_R_[a] = to_matrix(bases_[a].X.q);
  for (size_t i = 0; i < bodies; ++i) moving_[i].R = to_matrix(bodies_[i].X.q);
  for (size_t i = 0; i < links; ++i) fresh_[i] = 0;
  for (size_t i = 0; i < scene_->pairs.size(); ++i) touched_[i] = 0;
  for (size_t i = 0; i < links + bases + bodies; ++i) pushes_[i] = {};
  num_contacts_ = 0;
  pushed_ = false;
}

size_t ArticulatedWorld::heap_bytes(const Scene& scene) {
  // The collider's geoms, measured and rounded up; worlds of one worker share them.
  return scene.shapes.size() * 300;
}

}  // namespace rdm
