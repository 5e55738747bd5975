// Saving and loading an OdeWorld, and what one takes from the heap.
#include "base/error.hpp"
#include "physics/ode/ode_convert.hpp"
#include "physics/ode/ode_world.hpp"

namespace rdm {

// ODE renormalises a quaternion that is set and derives the matrix from it; both are kept as they are, or
// the last bit would change.
void OdeWorld::save_body(Writer& out, dBodyID body) const {
  out.value(from_ode(dBodyGetPosition(body)));
  out.value(quat_from_ode(dBodyGetQuaternion(body)));
  out.value(mat_from_ode(dBodyGetRotation(body)));
  out.value(from_ode(dBodyGetLinearVel(body)));
  out.value(from_ode(dBodyGetAngularVel(body)));
}

void OdeWorld::load_body(Reader& in, dBodyID body) {
  const auto p = in.value<Vec3>();
  const auto q = in.value<Quat>();
  const auto r = in.value<Mat3>();
  const auto v = in.value<Vec3>(), w = in.value<Vec3>();
  double unit = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  for (const double m : r.m) unit += 0 * m;  // a value that is not finite spoils it
  if (!finite(p) || !finite(v) || !finite(w) || !(unit > 0.99 && unit < 1.01))
    fail(Code::kFormat, "world state: the motion of a body is not finite");
  write_pose(body, p, q, r);
  write_velocity(body, v, w);
}

void OdeWorld::save(Writer& out) const {
  out.value(scene_->num_links);
  out.value(scene_->num_bodies);
  out.value(status_);
  const auto bytes = static_cast<size_t>(scene_->num_links) * sizeof(double);
  for (const double* row : {q_, qd_, target_, torque_}) out.bytes(row, bytes);
  out.bytes(sensors_, scene_->sensors.size() * sizeof(Wrench));
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a)
    if (tree_.base(a)) save_body(out, tree_.base(a));
  for (int32_t i = 0; i < scene_->num_bodies; ++i) save_body(out, body_ids_[i]);
}

void OdeWorld::load(Reader& in) {
  const OdeScope scope;
  if (in.value<int32_t>() != scene_->num_links || in.value<int32_t>() != scene_->num_bodies)
    fail(Code::kFormat, "world state: it is of another scene");
  status_ = in.value<uint32_t>();
  const auto bytes = static_cast<size_t>(scene_->num_links) * sizeof(double);
  for (double* row : {q_, qd_, target_, torque_}) in.bytes(row, bytes);
  for (int32_t i = 0; i < scene_->num_links; ++i)
    if (!std::isfinite(q_[i]) || !std::isfinite(qd_[i])) {
      q_[i] = qd_[i] = 0;
      fail(Code::kFormat, "world state: joint %d is not finite", i);
    }
  in.bytes(sensors_, scene_->sensors.size() * sizeof(Wrench));
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a) {
    if (tree_.base(a)) {
      load_body(in, tree_.base(a));
      tree_.read_base(a, state());
    }
    rebuild(a);
    tree_.write(a, state());
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    load_body(in, body_ids_[i]);
    read_body(i);
  }
  num_contacts_ = 0;
  for (size_t i = 0; i < scene_->pairs.size(); ++i) touched_[i] = 0;
  for (int32_t i = 0; i < num_forces_; ++i) {
    forces_[i].push = {};
    forces_[i].pushed = false;
  }
}

size_t OdeWorld::heap_bytes(const Scene& scene) {
  const auto links = static_cast<size_t>(scene.num_links), bodies = static_cast<size_t>(scene.num_bodies);
  const auto contacts = static_cast<size_t>(scene.def.solver.contacts_max);
  // Measured with the packaged library and rounded up: ODE's objects and, for all contacts in one island,
  // the solver's rows.
  return 32000 + links * 2200 + bodies * 1200 + scene.shapes.size() * 300 + contacts * 1600;
}

}  // namespace rdm
