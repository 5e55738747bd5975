// Part of stepper.inl: points of pairs whose materials have a contact law (model/contact_law.hpp), with rows for turning about
// the normal and rolling too.
#pragma once

namespace rdm {
namespace {

// One side's part of the rows of a point with a law, as add_contact_rows; axes 3 to 5 are of turning. Adds
// the velocities of the substep's start to `before`.
template <class L>
void BatchStepper<L>::add_law_rows(LawPoint* point, const Attachment& at, int32_t world, S sign,
                                   const Vec3& p, const Vec3* axes, double* before) {
  constexpr int kAxes = LawContacts<S>::kAxes;
  const WorldState& w = *worlds_[world];
  const int count = point->axes;
  const double side = static_cast<double>(sign);
  if (at.kind == Attachment::kBody) {
    const FreeBody& body = w.free_bodies[at.body];
    const Motion& m = w.bodies[at.body];
    const double sqrt_inv_mass = w.body_models[at.body].sqrt_inv_mass;
    const Vec3 arm = p - m.X.p;
    auto* rows = contacts_.laws.segment_rows(point, at.first_segment);
    for (int f = 0; f < count; ++f) {
      const Vec3 linear = f < 3 ? axes[f] : Vec3{}, moment = f < 3 ? cross(arm, axes[f]) : axes[f - 3];
      const Vec3 angular = body.inv_sqrt_inertia * moment;
      for (int r = 0; r < 3; ++r) {
        rows[f][r] += sign * static_cast<S>(linear[r] * sqrt_inv_mass);
        rows[f][3 + r] += sign * static_cast<S>(angular[r]);
      }
      point->b[f] -= sign * static_cast<S>(dot(linear, body.v) + dot(moment, body.w));
      before[f] += side * (dot(linear, m.v) + dot(moment, m.w));
    }
    return;
  }
  if (at.kind == Attachment::kStatic) return;
  const auto [batch, lane] = lane_of(at.group, at.member, world);
  const Tree& tree = *batch->tree;
  const int32_t articulation = tree.members[static_cast<size_t>(at.member)].articulation;
  touched_[articulation] = 1;
  const Vec3& base = w.bases[articulation].X.p;
  S x[3];
  for (int r = 0; r < 3; ++r) x[r] = static_cast<S>(p[r] - base[r]);
  S(*z)[kAxes] = reinterpret_cast<S(*)[kAxes]>(path_);
  const int32_t first = tree.row[static_cast<size_t>(at.coord)],
                depth = tree.depth[static_cast<size_t>(at.coord)];
  const int16_t* path = tree.path.data() + first;
  const uint8_t* moving = tree.moving.data() + first;
  for (int32_t d = 0; d <= depth; ++d) {
    factor_rows_[d] = batch->factor + tree.row[static_cast<size_t>(path[d])];
    if (!moving[d]) {
      for (int f = 0; f < kAxes; ++f) z[d][f] = 0;
      continue;
    }
    const CoordWork<V>& c = batch->coord[path[d]];
    S a[3], s[3];
    for (int r = 0; r < 3; ++r) {
      a[r] = L::get(c.a[r], lane);
      s[r] = L::get(c.s[r], lane);
    }
    const S v[3] = {s[0] + (a[1] * x[2] - a[2] * x[1]), s[1] + (a[2] * x[0] - a[0] * x[2]),
                    s[2] + (a[0] * x[1] - a[1] * x[0])};
    const S rate = L::get(c.v1, lane), last = L::get(c.qd, lane);
    for (int f = 0; f < count; ++f) {
      const S* of = f < 3 ? v : a;
      const Vec3& axis = axes[f % 3];
      z[d][f] = sign * (static_cast<S>(axis.x) * of[0] + static_cast<S>(axis.y) * of[1] +
                        static_cast<S>(axis.z) * of[2]);
      point->b[f] -= z[d][f] * rate;
      before[f] += static_cast<double>(z[d][f] * last);
    }
  }
  for (int32_t top = depth; top >= 0; --top)
    for (int32_t d = depth; d > top; --d)
      for (int f = 0; f < count; ++f) z[top][f] -= z[d][f] * L::get(factor_rows_[d][top], lane);
  for (int32_t d = depth; d >= 0; --d) {
    const TreeSlot slot = tree.slots[static_cast<size_t>(path[d])];
    auto* rows = contacts_.laws.segment_rows(point, at.first_segment + slot.segment);
    const S scale = L::get(batch->coord[path[d]].inv_sqrt_d, lane);
    for (int f = 0; f < count; ++f) rows[f][slot.slot] += z[d][f] * scale;
  }
}

// The speed at which a point is to part that closed at -before (m/s, along the normal, at the substep's
// start), 0: it does not meet in this substep, or was too slow to bounce. A free body that falls onto what is
// at rest is as deep in it as it came since they met: it leaves with the energy that it would have had there.
// What moves it through the substep, `change`, comes on top.
template <class L>
double BatchStepper<L>::bounce(const ContactLaw& law, const Contact& contact, double before,
                               double change) const {
  if (!(before < -kBounceSpeed) || law.restitution == 0) return 0;
  if (contact.depth < 0 && (before + change) * scene_->def.solver.h > contact.depth) return 0;
  const Attachment &a = attachments_[contact.shape_a], &b = attachments_[contact.shape_b];
  double fallen = 0;  // m2/s2: twice gravity times the way since they met
  if (a.kind == Attachment::kBody && b.kind == Attachment::kStatic)
    fallen = -2 * contact.depth * dot(model_->bodies[static_cast<size_t>(a.body)].gravity, contact.n);
  const double square = before * before, e = law.restitution;
  if (contact.depth >= 0) fallen = std::clamp(fallen, 0.0, square);
  const double left = std::max(e * e * (square - fallen) + fallen, 0.0);
  return std::max(std::sqrt(left) + std::min(change, 0.0), 0.0);
}

// MuJoCo's edges of friction of a capsule on a plane: along and across its axis.
template <class L>
void BatchStepper<L>::align(int32_t world, const Contact& contact, Vec3* t, Vec3* u) const {
  if (scene_->shapes[static_cast<size_t>(contact.shape_a)].def.kind != ShapeKind::kCapsule) return;
  Vec3 p;
  Mat3 R;
  shape_pose(world, contact.shape_a, &p, &R);
  const Vec3 axis{R(0, 2), R(1, 2), R(2, 2)}, along = axis - dot(axis, contact.n) * contact.n;
  const double length = norm(along);
  if (length < 1e-6) return;
  *t = (1 / length) * along;
  *u = cross(contact.n, *t);
}

template <class L>
void BatchStepper<L>::add_law_point(int32_t world, int32_t index, const ContactLaw& law, bool again) {
  WorldState& w = *worlds_[world];
  const Contact& contact = w.contacts[index];
  const double mu = friction(w, w.contact_pairs[index]);
  const double friction_of[] = {0, mu, mu, law.torsional, law.rolling, law.rolling};
  LawPoint& point = contacts_.laws.add(law.rolling > 0 ? 6 : law.torsional > 0 ? 4 : mu > 0 ? 3 : 1);
  // the collider's point is the deepest of the shape's
  const bool middle = law.soft() && scene_->shapes[static_cast<size_t>(contact.shape_b)].radius < 0;
  Vec3 axes[3] = {contact.n, {}, {}};
  tangents(contact.n, &axes[1], &axes[2]);
  if (middle && law.pyramid) align(world, contact, &axes[1], &axes[2]);
  for (int r = 0; r < 3; ++r) point.tangent[r] = static_cast<S>(axes[1][r]);
  double before[LawContacts<S>::kAxes] = {};
  const Vec3 p = middle ? contact.p + (0.5 * (contact.depth + law.margin)) * contact.n : contact.p;
  add_law_rows(&point, attachments_[contact.shape_a], world, S(1), p, axes, before);
  add_law_rows(&point, attachments_[contact.shape_b], world, S(-1), p + contact.gap, axes, before);
  contacts_.laws.prepare(&point);
  for (int f = 0; f < point.axes; ++f) point.friction[f] = static_cast<S>(friction_of[f]);
  if (law.soft() && contact.depth < 0) {  // yet to come: it gives way once they meet
    point.b[0] = S(-1e9);
  } else if (law.soft()) {
    const SoftRow row = soft_row(law, contact.depth, scene_->def.solver.h);
    const double weight = model_->inverse_weights[static_cast<size_t>(contact.shape_a)] +
                          model_->inverse_weights[static_cast<size_t>(contact.shape_b)];
    point.pyramid = law.pyramid && point.axes > 1 && mu > 0;
    for (int f = 0; f < point.axes; ++f) {
      point.b[f] += static_cast<S>(row.keep * before[f] + (f == 0 ? row.push : 0));
      const double ratio = f > 2 && friction_of[f] > 0 ? mu / friction_of[f] : 1;
      point.softness[f] = static_cast<S>(row.weight * weight * ratio * ratio);
    }
    if (point.pyramid) point.softness[0] = static_cast<S>(2 * mu * mu * (1 + mu * mu) * row.weight * weight);
  } else {
    const double change = -static_cast<double>(point.b[0]) - before[0];
    const double leaving = bounce(law, contact, before[0], change), push_out = push_out_speed(w, index);
    // softness would swallow some of a bounce
    if (leaving <= push_out && contact.depth >= 0) point.softness[0] = static_cast<S>(softness(w, index));
    point.b[0] += static_cast<S>(leaving > 0 ? std::max(push_out, leaving) : push_out);
  }
  Vec3 last;
  if (again)
    last = w.contacts[index].force;
  else if (!warm_impulse(w, index, &last))
    return;
  S start[3];
  for (int f = 0; f < 3; ++f) start[f] = static_cast<S>(dot(last, axes[f]));
  start[0] = start[0] < 0 ? S(0) : start[0];
  contacts_.laws.warm_start(&point, start, contacts_.sum);
}

}  // namespace
}  // namespace rdm
