#include "physics/articulated/world_state.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "physics/limits.hpp"
#include "physics/model/inertia.hpp"

namespace rdm {
namespace {

constexpr float kWarmReach = 0.02f;  // m between two substeps' points that count as one

// C^-1 for C C^T = a, C a lower triangle (Cholesky), by forward substitution.
Mat3 inverse_cholesky(const Mat3& a) {
  Mat3 c;
  c(0, 0) = std::sqrt(a(0, 0));
  c(1, 0) = a(1, 0) / c(0, 0);
  c(2, 0) = a(2, 0) / c(0, 0);
  c(1, 1) = std::sqrt(a(1, 1) - c(1, 0) * c(1, 0));
  c(2, 1) = (a(2, 1) - c(2, 0) * c(1, 0)) / c(1, 1);
  c(2, 2) = std::sqrt(a(2, 2) - c(2, 0) * c(2, 0) - c(2, 1) * c(2, 1));
  Mat3 b;
  for (int i = 0; i < 3; ++i) b(i, i) = 1 / c(i, i);
  b(1, 0) = -c(1, 0) * b(0, 0) * b(1, 1);
  b(2, 1) = -c(2, 1) * b(1, 1) * b(2, 2);
  b(2, 0) = -(c(2, 0) * b(0, 0) + c(2, 1) * b(1, 0)) * b(2, 2);
  return b;
}

BodyModel make_body_model(const BodyDef& def, const Scene& scene) {
  const double h = scene.def.solver.h;
  BodyModel m;
  m.inv_mass = 1 / def.inertia.mass;
  m.sqrt_inv_mass = std::sqrt(m.inv_mass);
  m.moment = moment_matrix(def.inertia);
  m.inv_sqrt_moment = inverse_cholesky(m.moment);
  m.inv_moment = transpose(m.inv_sqrt_moment) * m.inv_sqrt_moment;
  m.linear = 1 / (1 + h * def.linear_damping);
  m.angular = 1 / (1 + h * def.angular_damping);
  if (def.gravity) m.gravity = scene.def.gravity;
  return m;
}

// Of the shapes on free bodies; the capsule axis too, for all that have one.
void set_body_bounds(const Scene& scene, const WorldState& s, Bound* bounds) {
  for (size_t i = scene.shapes.size(); i-- > 0;) {
    const SceneShape& shape = scene.shapes[i];
    if (shape.carrier == Carrier::kStatic) continue;
    if (shape.carrier != Carrier::kBody) break;  // bodies stand after all articulations
    const Mat3& R_WB = s.free_bodies[shape.index].R;
    const Pose& X_BS = shape.def.X_LS;
    set_bound(shape, s.bodies[shape.index].X.p + R_WB * X_BS.p, R_WB * to_matrix(X_BS.q), &bounds[i]);
  }
}

}  // namespace

ArticulatedModel make_articulated_model(const Scene& scene) {
  ArticulatedModel model;
  model.scene = &scene;
  model.trees = make_trees(scene);
  for (const BodyDef& body : scene.def.bodies) model.bodies.push_back(make_body_model(body, scene));
  return model;
}

void begin_step(const ArticulatedModel& model, WorldState* s) {
  const Scene& scene = *model.scene;
  s->status = 0;
  s->num_contacts = 0;
  s->diverged = false;
  for (int32_t i = 0; i < scene.num_links; ++i) {
    if (std::isfinite(s->target[i])) continue;
    s->target[i] = s->q[i];
    s->status |= kStatusDiverged;
  }
  for (size_t i = 0; i < scene.sensors.size(); ++i) s->sensors[i] = {};
  std::memset(s->touched, 0, scene.pairs.size());
  std::copy_n(s->bodies, scene.num_bodies, s->start_bodies);
  std::copy_n(s->bases, scene.def.articulations.size(), s->start_bases);
}

void predict_bodies(const ArticulatedModel& model, WorldState* s) {
  const double h = model.scene->def.solver.h;
  const Wrench* pushes = s->body_pushes(*model.scene);
  for (int32_t i = 0; i < model.scene->num_bodies; ++i) {
    const BodyModel& constants = model.bodies[static_cast<size_t>(i)];
    const Motion& m = s->bodies[i];
    FreeBody& body = s->free_bodies[i];
    const Mat3 R_BW = transpose(body.R);
    body.inv_sqrt_inertia = constants.inv_sqrt_moment * R_BW;
    Vec3 a = constants.gravity, dw{};
    if (s->pushed) {
      a += constants.inv_mass * pushes[i].force;
      dw = body.R * (constants.inv_moment * (R_BW * pushes[i].torque));
    }
    body.v = constants.linear * (m.v + h * a);
    body.w = constants.angular * (m.w + h * dw);
  }
}

void set_bound(const SceneShape& shape, const Vec3& p, const Mat3& R, Bound* bound) {
  const Vec3 axis = R * capsule_around(shape).axis;
  for (int k = 0; k < 3; ++k) {
    bound->center[k] = static_cast<float>(p[k]);
    bound->axis[k] = static_cast<float>(axis[k]);
  }
}

void find_contacts(const ArticulatedModel& model, Collider* collider, Collider::Poses& poses, WorldState* s) {
  Bound* bounds = collider->bounds();
  set_body_bounds(*model.scene, *s, bounds);
  const Collider::Found found =
      collider->collide(*model.scene, poses, s->contacts, s->contact_pairs, s->touched);
  s->num_contacts = found.count;
  if (found.failed) s->diverged = true;
  if (found.overflow) s->status |= kStatusContactOverflow;
  for (int32_t i = 0; i < s->num_contacts; ++i) {
    const float* center = bounds[s->contacts[i].shape_a].center;
    s->next_warm[i].pair = s->contact_pairs[i];
    for (int k = 0; k < 3; ++k)
      s->next_warm[i].p[k] = static_cast<float>(s->contacts[i].p[k] - static_cast<double>(center[k]));
  }
}

// The nearest of the last substep's points of the same pair, measured from shape a's centre: points slide
// with it.
bool warm_impulse(const WorldState& s, int32_t contact, Vec3* impulse) {
  const WarmPoint& here = s.next_warm[contact];
  float nearest = kWarmReach * kWarmReach;
  const WarmPoint* found = nullptr;
  for (int32_t i = 0; i < s.num_warm; ++i) {
    if (s.warm[i].pair != here.pair) continue;
    float square = 0;
    for (int k = 0; k < 3; ++k) square += (s.warm[i].p[k] - here.p[k]) * (s.warm[i].p[k] - here.p[k]);
    if (!(square < nearest)) continue;
    nearest = square;
    found = &s.warm[i];
  }
  if (!found) return false;
  *impulse = {static_cast<double>(found->impulse[0]), static_cast<double>(found->impulse[1]),
              static_cast<double>(found->impulse[2])};
  return true;
}

void store_impulses(WorldState* s) {
  for (int32_t i = 0; i < s->num_contacts; ++i)
    for (int k = 0; k < 3; ++k) s->next_warm[i].impulse[k] = static_cast<float>(s->impulses[i][k]);
  std::swap(s->warm, s->next_warm);
  s->num_warm = s->num_contacts;
}

void integrate_bodies(const ArticulatedModel& model, WorldState* s) {
  const double h = model.scene->def.solver.h;
  for (int32_t i = 0; i < model.scene->num_bodies; ++i) {
    const BodyModel& constants = model.bodies[static_cast<size_t>(i)];
    FreeBody& body = s->free_bodies[i];
    Motion& m = s->bodies[i];
    m.v = body.v1;
    m.w = body.w1;
    if (!bounded(m.v) || !bounded(m.w) || !bounded(m.X.p)) {
      s->diverged = true;
      m = s->start_bodies[i];
      m.v = m.w = {};
      continue;
    }
    const double spin = norm(m.w);
    if (spin > kMaxBodySpin) m.w = (kMaxBodySpin / spin) * m.w;
    const Vec3 momentum = body.R * (constants.moment * (transpose(body.R) * m.w));
    m.X = moved(m.X, m.v, m.w, h);
    body.R = to_matrix(m.X.q);
    m.w = body.R * (constants.inv_moment * (transpose(body.R) * momentum));
  }
}

}  // namespace rdm
