// Part of stepper.inl: the points of a world's contacts as rows of the contact solver, and how soft, how deep and how fast each
// may be.
#pragma once

namespace rdm {
namespace {

// Two unit vectors t, u at right angles to n and each other.
inline void tangents(const Vec3& n, Vec3* t, Vec3* u) {
  if (n.z * n.z > 0.5) {
    const double k = 1 / std::sqrt(n.y * n.y + n.z * n.z);
    *t = {0, -n.z * k, n.y * k};
  } else {
    const double k = 1 / std::sqrt(n.x * n.x + n.y * n.y);
    *t = {-n.y * k, n.x * k, 0};
  }
  *u = cross(n, *t);
}

// One side's part of a point's rows, and its velocity without contacts, which is taken from the wanted one.
// `sign` is +1 on a, -1 on b; p the point, axes the normal and the tangents, in double.
// A body:  J = (n, (p - c) x n), times sqrt(1/m) and C^-1 R^T: half of the solve with its mass matrix.
// A robot: J has an entry n . (s_c + a_c x p) per coordinate c on the path from the touched link to the root.
//          z = D^-1/2 L^-T J^T stays on that path: from the link inward, each entry is taken off those
//          before it.
template <class L>
void BatchStepper<L>::add_contact_rows(typename ContactSolver<S>::Point* point, const Attachment& at,
                                       int32_t world, S sign, const Vec3& p, const Vec3* axes) {
  const WorldState& w = *worlds_[world];
  const int count = point->axes;
  if (at.kind == Attachment::kBody) {
    const FreeBody& body = w.free_bodies[at.body];
    const double sqrt_inv_mass = w.body_models[at.body].sqrt_inv_mass;
    const Vec3 arm = p - w.bodies[at.body].X.p;
    auto* rows = contacts_.segment_rows(point, at.first_segment);
    for (int f = 0; f < count; ++f) {
      const Vec3 moment = cross(arm, axes[f]), angular = body.inv_sqrt_inertia * moment;
      for (int r = 0; r < 3; ++r) {
        rows[f][r] += sign * static_cast<S>(axes[f][r] * sqrt_inv_mass);
        rows[f][3 + r] += sign * static_cast<S>(angular[r]);
      }
      point->b[f] -= sign * static_cast<S>(dot(axes[f], body.v) + dot(moment, body.w));
    }
    return;
  }
  if (at.kind == Attachment::kStatic) return;
  const auto [batch, lane] = lane_of(at.group, at.member, world);
  const Tree& tree = *batch->tree;
  const int32_t articulation = tree.members[static_cast<size_t>(at.member)].articulation;
  touched_[articulation] = 1;
  const Vec3& base = w.bases[articulation].X.p;
  using Axes4 = typename ContactSolver<S>::Axes;
  Axes4 axis[3], velocity{};
  S x[3];
  for (int r = 0; r < 3; ++r) {
    x[r] = static_cast<S>(p[r] - base[r]);
    axis[r] =
        sign * Axes4{static_cast<S>(axes[0][r]), static_cast<S>(axes[1][r]), static_cast<S>(axes[2][r]), 0};
  }
  // z[d]: the three rows' entries of the path's coordinate d
  Axes4* z = reinterpret_cast<Axes4*>(path_);
  const int32_t first = tree.row[static_cast<size_t>(at.coord)],
                depth = tree.depth[static_cast<size_t>(at.coord)];
  const int16_t* path = tree.path.data() + first;
  const uint8_t* moving = tree.moving.data() + first;
  for (int32_t d = 0; d <= depth; ++d) {
    factor_rows_[d] = batch->factor + tree.row[static_cast<size_t>(path[d])];
    if (!moving[d]) {
      z[d] = Axes4{};
      continue;
    }
    const CoordWork<V>& c = batch->coord[path[d]];
    S a[3], s[3];
    for (int r = 0; r < 3; ++r) {
      a[r] = L::get(c.a[r], lane);
      s[r] = L::get(c.s[r], lane);
    }
    // velocity of the point at unit rate
    const S v[3] = {s[0] + (a[1] * x[2] - a[2] * x[1]), s[1] + (a[2] * x[0] - a[0] * x[2]),
                    s[2] + (a[0] * x[1] - a[1] * x[0])};
    z[d] = axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
    velocity += z[d] * L::get(c.v1, lane);
  }
  for (int f = 0; f < count; ++f) point->b[f] -= velocity[f];
  // L^-T: from each entry what those behind it take, the last first; four entries at a time stay in registers
  int32_t top = depth;
  for (; top >= 3; top -= 4) {
    Axes4* const four = z + top - 3;
    Axes4 y[4] = {four[0], four[1], four[2], four[3]};
    const auto take = [&, lane = lane](const Axes4& from, int32_t d, int entries) {
      const V* factor = factor_rows_[d] + top - 3;
      for (int i = 0; i < entries; ++i) y[i] -= from * L::get(factor[i], lane);
    };
    for (int32_t d = depth; d > top; --d) take(z[d], d, 4);
    take(y[3], top, 3);
    take(y[2], top - 1, 2);
    take(y[1], top - 2, 1);
    for (int i = 0; i < 4; ++i) four[i] = y[i];
  }
  for (; top >= 0; --top)
    for (int32_t d = depth; d > top; --d) z[top] -= z[d] * L::get(factor_rows_[d][top], lane);
  // D^-1/2, into the segments that the path runs through
  for (int32_t d = depth; d >= 0;) {
    const int32_t segment = tree.slots[static_cast<size_t>(path[d])].segment;
    S part[3][kSegment] = {};
    for (; d >= 0; --d) {
      const TreeSlot slot = tree.slots[static_cast<size_t>(path[d])];
      if (slot.segment != segment) break;
      const Axes4 half_solved = z[d] * L::get(batch->coord[path[d]].inv_sqrt_d, lane);
      for (int f = 0; f < 3; ++f) part[f][slot.slot] = half_solved[f];
    }
    auto* rows = contacts_.segment_rows(point, at.first_segment + segment);
    for (int f = 0; f < count; ++f) {
      typename ContactSolver<S>::Row row;
      std::memcpy(&row, part[f], sizeof row);
      rows[f] += row;
    }
  }
}

template <class L>
double BatchStepper<L>::most_push_out_speed() const {
  const SolverDef& solver = scene_->def.solver;
  return solver.contact_max_speed > 0 ? solver.contact_max_speed : kArticulatedContactSpeed;
}

// erp / h of the depth below the layer, within a bound: a deep overlap, as after a blow, must not turn into a
// shot. Above the layer as much the other way: what rests lies equally deep wherever it started, and no point of
// a face leaves and comes back. What is yet to come may come as near as it is.
template <class L>
double BatchStepper<L>::push_out_speed(const WorldState& w, int32_t index) const {
  const SolverDef& solver = scene_->def.solver;
  const double depth = w.contacts[index].depth;
  if (depth < 0) return depth / solver.h;
  return std::min((depth - layer(w, index)) * solver.contact_erp / solver.h, most_push_out_speed());
}

// The pair's; of shapes that a world has in sizes of its own by those.
template <class L>
double BatchStepper<L>::layer(const WorldState& w, int32_t index) const {
  const ShapePair& pair = scene_->pairs[static_cast<size_t>(w.contact_pairs[index])];
  if (!w.sized) return pair.layer;
  const auto width = [&](int32_t shape) {
    const int32_t k = shape - scene_->first_body_shape;
    const bool own = k >= 0 && k < scene_->num_body_shapes;
    return (own ? w.sized[k].size_factor : 1.0) * half_widths_[shape];
  };
  return layer_of(scene_->def.solver, std::min(width(pair.a), width(pair.b)));
}

// cfm / h; less where the point's last impulse would give way by more than kMostYield.
template <class L>
double BatchStepper<L>::softness(const WorldState& w, int32_t index) const {
  const SolverDef& solver = scene_->def.solver;
  const double soft = solver.contact_cfm / solver.h;
  Vec3 last;
  if (!warm_impulse(w, index, &last)) return soft;
  const double n = dot(last, w.contacts[index].n);
  return soft * n > kMostYield ? kMostYield / n : soft;
}

template <class L>
double BatchStepper<L>::friction(const WorldState& w, int32_t index) const {
  const ShapePair& pair = scene_->pairs[static_cast<size_t>(index)];
  return w.dynamics ? w.dynamics->mu(*scene_, pair) : pair.mu;
}

// The impulses of one world's contacts for the present factors, and the velocities v1 that they give.
// `again`: not for the first time in this substep.
template <class L>
void BatchStepper<L>::solve_contacts_of(int32_t world, bool again) {
  WorldState& w = *worlds_[world];
  const SolverDef& solver = scene_->def.solver;
  const int32_t count = w.num_contacts;
  contacts_.begin();
  for (size_t a = 0; a < scene_->def.articulations.size(); ++a) touched_[a] = 0;
  find_extremes(world);
  const bool piles = add_piles(world, again);
  for (int32_t i = 0; i < count; ++i) {
    const Contact& contact = w.contacts[i];
    if (piles && in_pile_[i]) continue;
    if (const ContactLaw* law = scene_->law_of(w.contact_pairs[i])) {
      add_law_point(world, i, *law, piles && again);
      continue;
    }
    contacts_.stacked += attachments_[contact.shape_a].kind == Attachment::kBody &&
                         attachments_[contact.shape_b].kind == Attachment::kBody;
    auto& point =
        contacts_.add(static_cast<S>(friction(w, w.contact_pairs[i])), static_cast<S>(softness(w, i)));
    Vec3 axes[3] = {contact.n, {}, {}};
    tangents(contact.n, &axes[1], &axes[2]);
    point.b[0] = static_cast<S>(push_out_speed(w, i));
    if (contact.depth < 0) point.softness = S(0);
    add_contact_rows(&point, attachments_[contact.shape_a], world, S(1), contact.p, axes);
    add_contact_rows(&point, attachments_[contact.shape_b], world, S(-1), contact.p + contact.gap, axes);
    contacts_.prepare(&point);
    Vec3 last;
    if (piles && again)
      last = w.contacts[i].force;
    else if (!warm_impulse(w, i, &last))
      continue;
    S start[3];
    for (int f = 0; f < 3; ++f) start[f] = static_cast<S>(dot(last, axes[f]));
    start[0] = start[0] < 0 ? S(0) : start[0];
    contacts_.warm_start(&point, start);
  }
  const bool solved = extremes_ && solve_extremes(world);
  if (!solved || contacts_.wide.count > 0) contacts_.solve(solver.iterations, solved);
  w.residual = static_cast<double>(contacts_.residual());
  for (int32_t i = 0, k = 0, of_law = 0; i < count; ++i) {
    if (piles && in_pile_[i]) continue;
    const Vec3& n = w.contacts[i].n;
    Vec3 t, u;
    tangents(n, &t, &u);
    if (scene_->law_of(w.contact_pairs[i])) {
      const auto& point = contacts_.laws.points[of_law++];
      const auto& impulse = point.impulse;
      for (int r = 0; r < 3; ++r) t[r] = static_cast<double>(point.tangent[r]);
      u = cross(n, t);
      w.contacts[i].force = static_cast<double>(impulse[0]) * n + static_cast<double>(impulse[1]) * t +
                            static_cast<double>(impulse[2]) * u;
      continue;
    }
    const auto& impulse = contacts_.points[k++].impulse;
    w.contacts[i].force = static_cast<double>(impulse[0]) * n + static_cast<double>(impulse[1]) * t +
                          static_cast<double>(impulse[2]) * u;
  }
  if (piles) read_pile_impulses(world);
  take_impulses(world);
}

}  // namespace
}  // namespace rdm
