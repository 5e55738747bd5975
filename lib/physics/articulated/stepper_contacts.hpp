// Contacts of the worlds in a stepper's lanes: finding them, solving them with the trees, giving out forces.
// Part of stepper_v*.cpp.
#pragma once
#include "physics/articulated/stepper_lanes.hpp"

namespace rdm {
namespace {

// Two unit vectors at right angles to n and each other.
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

template <class L>
void StepperLanes<L>::place_shape(int32_t world, int32_t shape, Vec3* p, Mat3* R) const {
  const Place& place = places_[shape];
  const ArticulatedWorld& w = *worlds_[world];
  if (place.kind == Place::kBody) {
    const Pose& X_BS = scene_->shapes[static_cast<size_t>(shape)].def.X_LS;
    const Mat3& R_WB = w.moving_body(place.body).R;
    *p = w.body(place.body).X.p + R_WB * X_BS.p;
    *R = R_WB * to_matrix(X_BS.q);
    return;
  }
  const auto [set, lane] = lane_of(place.group, place.member, world);
  const TreeMember& member = set->tree->members[static_cast<size_t>(place.member)];
  const int32_t k = shape - member.first_shape;
  const V* rows = place.link < 0 ? set->base_R : set->keep[place.link].R;
  Mat3 R_WJ;
  for (int i = 0; i < 9; ++i) R_WJ.m[i] = static_cast<double>(L::get(rows[i], lane));
  *R = R_WJ * member.shapes[static_cast<size_t>(k)].R_JS;
  *p = w.base(member.articulation).X.p;
  for (int r = 0; r < 3; ++r) (*p)[r] += static_cast<double>(L::get(set->center[k][r], lane));
}

template <class L>
void StepperLanes<L>::find_contacts(int32_t world) {
  ArticulatedWorld& w = *worlds_[world];
  w.predict_bodies();
  Bound* bounds = shared_->collider.bounds();
  for (int32_t g = 0; g < num_groups_; ++g) {
    const Tree& tree = *groups_[g].tree;
    for (int32_t m = 0; m < groups_[g].members; ++m) {
      const auto [set, lane] = lane_of(g, m, world);
      const TreeMember& member = tree.members[static_cast<size_t>(m)];
      const Vec3& base = w.base(member.articulation).X.p;
      const float origin[3] = {static_cast<float>(base.x), static_cast<float>(base.y),
                               static_cast<float>(base.z)};
      for (size_t k = 0; k < tree.shape_links.size(); ++k) {
        if (tree.shape_links[k] < 0 && !tree.free_base) continue;
        Bound& bound = bounds[static_cast<size_t>(member.first_shape) + k];
        for (int r = 0; r < 3; ++r)
          bound.center[r] = origin[r] + static_cast<float>(L::get(set->center[k][r], lane));
        if (!tree.shape_slender[k]) continue;
        for (int r = 0; r < 3; ++r) bound.axis[r] = static_cast<float>(L::get(set->axis[k][r], lane));
      }
    }
  }
  WorldPoses poses(this, world);
  w.collide(poses);
}

template <class L>
typename L::Mask StepperLanes<L>::lanes_of(const TreeBatch<L>& t, uint32_t worlds) const {
  uint32_t bits = 0;
  for (int l = 0; l < L::kCount; ++l)
    if (t.used[l]) bits |= (worlds >> t.world[l] & 1) << l;
  return L::mask(bits);
}

template <class L>
uint32_t StepperLanes<L>::worlds_of(const TreeBatch<L>& t, Mask lanes) const {
  const uint32_t bits = L::bits(lanes);
  uint32_t worlds = 0;
  for (int l = 0; bits != 0 && l < L::kCount; ++l)
    if (t.used[l] && (bits >> l & 1)) worlds |= 1u << t.world[l];
  return worlds;
}

// Contacts and sets in turn, until they agree or the rounds are over: then the damped choice.
template <class L>
void StepperLanes<L>::solve_contacts() {
  uint32_t open = 0;
  for (int32_t w = 0; w < count_; ++w) {
    ArticulatedWorld& world = *worlds_[w];
    for (int32_t i = 0; i < scene_->num_bodies; ++i) {
      world.moving_body(i).v1 = world.moving_body(i).v;
      world.moving_body(i).w1 = world.moving_body(i).w;
    }
    if (world.num_contacts() > 0) open |= 1u << w;
  }
  for (int round = 0; open != 0; ++round) {
    for (int32_t k = 0; k < num_sets_; ++k)
      for (int32_t c = 0; c < sets_[k].tree->num_coords; ++c)
        sets_[k].coord[c].root = L::root(sets_[k].coord[c].inverse);
    for (int32_t w = 0; w < count_; ++w)
      if (open >> w & 1) solve_world(w);
    if (round > kContactRounds) return;
    uint32_t changed = 0;
    for (int32_t k = 0; k < num_sets_; ++k) {
      TreeBatch<L>& t = sets_[k];
      const Mask lanes = revise_sets(t, lanes_of(t, open), round >= 2 && round < kContactRounds);
      changed |= worlds_of(t, lanes);
      if (round == kContactRounds) damp_sets(t, lanes);
    }
    if (changed == 0) return;
    for (int32_t k = 0; k < num_sets_; ++k) solve_sets(sets_[k], lanes_of(sets_[k], changed));
    open = changed;
  }
}

template <class L>
void StepperLanes<L>::add_side(typename ContactRows<S>::Point* point, const Place& place, int32_t world,
                               S sign, const Vec3& p, const Vec3* axes) {
  const ArticulatedWorld& w = *worlds_[world];
  const int count = point->axes;
  if (place.kind == Place::kBody) {
    const ArticulatedWorld::Body& body = w.moving_body(place.body);
    const double root = shared_->bodies[static_cast<size_t>(place.body)].root_inverse_mass;
    const Vec3 arm = p - w.body(place.body).X.p;
    auto* rows = rows_.segment_rows(point, place.first_segment);
    for (int f = 0; f < count; ++f) {
      const Vec3 moment = cross(arm, axes[f]), turned = body.whitener * moment;
      for (int r = 0; r < 3; ++r) {
        rows[f][r] += sign * static_cast<S>(axes[f][r] * root);
        rows[f][3 + r] += sign * static_cast<S>(turned[r]);
      }
      point->b[f] -= sign * static_cast<S>(dot(axes[f], body.v) + dot(moment, body.w));
    }
    return;
  }
  if (place.kind == Place::kRest) return;
  const auto [set, lane] = lane_of(place.group, place.member, world);
  const Tree& tree = *set->tree;
  const int32_t articulation = tree.members[static_cast<size_t>(place.member)].articulation;
  touched_[articulation] = 1;
  const Vec3& base = w.base(articulation).X.p;
  typedef S Four __attribute__((vector_size(sizeof(S) * 4)));  // one number per axis
  Four axis[3], velocity{};
  S x[3];
  for (int r = 0; r < 3; ++r) {
    x[r] = static_cast<S>(p[r] - base[r]);
    axis[r] = Four{static_cast<S>(axes[0][r]), static_cast<S>(axes[1][r]), static_cast<S>(axes[2][r]), 0};
  }
  // change_ has a row of Four per coordinate of the path
  Four* z = reinterpret_cast<Four*>(change_);
  const int32_t first = tree.row[static_cast<size_t>(place.coord)],
                depth = tree.depth[static_cast<size_t>(place.coord)];
  const int16_t* path = tree.path.data() + first;
  for (int32_t d = 0; d <= depth; ++d) {
    const CoordWork<V>& c = set->coord[path[d]];
    S a[3], s[3];
    for (int r = 0; r < 3; ++r) {
      a[r] = L::get(c.a[r], lane);
      s[r] = L::get(c.s[r], lane);
    }
    // velocity of the point at unit rate
    const S v[3] = {s[0] + (a[1] * x[2] - a[2] * x[1]), s[1] + (a[2] * x[0] - a[0] * x[2]),
                    s[2] + (a[0] * x[1] - a[1] * x[0])};
    z[d] = (axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2]) * sign;
    velocity += z[d] * L::get(c.v1, lane);
  }
  for (int f = 0; f < count; ++f) point->b[f] -= velocity[f];
  int32_t segment = -1;
  typename ContactRows<S>::Row* rows = nullptr;
  for (int32_t d = depth; d >= 0; --d) {
    const int c = path[d];
    const V* factor = set->factor + tree.row[static_cast<size_t>(c)];
    for (int32_t e = 0; e < d; ++e) z[e] -= z[d] * L::get(factor[e], lane);
    const Four white = z[d] * L::get(set->coord[c].root, lane);
    const TreeSlot slot = tree.slots[static_cast<size_t>(c)];
    if (slot.segment != segment) {
      segment = slot.segment;
      rows = rows_.segment_rows(point, place.first_segment + segment);
    }
    for (int f = 0; f < count; ++f) rows[f][slot.slot] += white[f];
  }
}

template <class L>
void StepperLanes<L>::solve_world(int32_t world) {
  ArticulatedWorld& w = *worlds_[world];
  const SolverDef& solver = scene_->def.solver;
  const double fastest = solver.contact_max_speed > 0 ? solver.contact_max_speed : kArticulatedContactSpeed;
  const S softness = static_cast<S>(solver.contact_cfm / solver.h);
  const int32_t count = w.num_contacts();
  rows_.begin();
  for (size_t a = 0; a < scene_->def.articulations.size(); ++a) touched_[a] = 0;
  for (int32_t i = 0; i < count; ++i) {
    const Contact& contact = w.contacts()[i];
    const double mu = scene_->pairs[static_cast<size_t>(w.contact_pairs()[i])].mu;
    auto& point = rows_.add(static_cast<S>(mu), softness);
    Vec3 axes[3] = {contact.n, {}, {}};
    tangents(contact.n, &axes[1], &axes[2]);
    const double deep = std::max(contact.depth - solver.contact_layer, 0.0) * solver.contact_erp / solver.h;
    point.b[0] = static_cast<S>(std::min(deep, fastest));
    add_side(&point, places_[contact.shape_a], world, S(1), contact.p, axes);
    add_side(&point, places_[contact.shape_b], world, S(-1), contact.p, axes);
    rows_.finish(&point);
    Vec3 before;
    if (!w.warm_impulse(i, &before)) continue;
    S start[3];
    for (int f = 0; f < 3; ++f) start[f] = static_cast<S>(dot(before, axes[f]));
    start[0] = start[0] < 0 ? S(0) : start[0];
    rows_.warm(&point, start);
  }
  rows_.solve(solver.iterations);
  for (int32_t i = 0; i < count; ++i) {
    const Vec3& n = w.contacts()[i].n;
    Vec3 t, u;
    tangents(n, &t, &u);
    const auto& impulse = rows_.points[i].impulse;
    w.impulse(i) = static_cast<double>(impulse[0]) * n + static_cast<double>(impulse[1]) * t +
                   static_cast<double>(impulse[2]) * u;
  }
  apply(world);
}

// Impulses to rates.
template <class L>
void StepperLanes<L>::apply(int32_t world) {
  ArticulatedWorld& w = *worlds_[world];
  for (int32_t g = 0; g < num_groups_; ++g) {
    const Tree& tree = *groups_[g].tree;
    for (int32_t m = 0; m < groups_[g].members; ++m) {
      const int32_t a = tree.members[static_cast<size_t>(m)].articulation;
      if (!touched_[a]) continue;
      const auto [set, lane] = lane_of(g, m, world);
      const auto* sum = rows_.sum + member_segment_[a];
      for (int32_t c = 0; c < tree.num_coords; ++c) {
        const TreeSlot slot = tree.slots[static_cast<size_t>(c)];
        const int32_t row = tree.row[static_cast<size_t>(c)], depth = tree.depth[static_cast<size_t>(c)];
        S x = sum[slot.segment][slot.slot] * L::get(set->coord[c].root, lane);
        for (int32_t d = 0; d < depth; ++d)
          x -= L::get(set->factor[row + d], lane) * change_[tree.path[static_cast<size_t>(row + d)]];
        change_[c] = x;
        L::set(&set->coord[c].v1, lane, L::get(set->coord[c].v1, lane) + x);
      }
    }
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    ArticulatedWorld::Body& body = w.moving_body(i);
    const auto& sum = rows_.sum[body_segment_[i]];
    const double root = shared_->bodies[static_cast<size_t>(i)].root_inverse_mass;
    const Vec3 push{static_cast<double>(sum[0]), static_cast<double>(sum[1]), static_cast<double>(sum[2])},
        twist{static_cast<double>(sum[3]), static_cast<double>(sum[4]), static_cast<double>(sum[5])};
    body.v1 = body.v + root * push;
    body.w1 = body.w + transpose(body.whitener) * twist;
  }
}

// Contact forces, and their mean on the links with a sensor, in the pose they act in.
template <class L>
void StepperLanes<L>::add_forces(int32_t world) {
  ArticulatedWorld& w = *worlds_[world];
  const double inverse_h = 1 / scene_->def.solver.h, weight = 1.0 / scene_->def.solver.substeps;
  for (int32_t i = 0; i < w.num_contacts(); ++i) {
    Contact& contact = w.contacts_out()[i];
    contact.force = inverse_h * w.impulse(i);
    for (int side = 0; side < 2; ++side) {
      const Place& place = places_[side ? contact.shape_b : contact.shape_a];
      if (place.kind != Place::kTree || place.link < 0) continue;
      const TreeMember& member = groups_[place.group].tree->members[static_cast<size_t>(place.member)];
      const int32_t link = member.first_link + place.link, sensor = w.sensor_of_link(link);
      if (sensor < 0) continue;
      const auto [set, lane] = lane_of(place.group, place.member, world);
      const LinkState<V>& keep = set->keep[place.link];
      Mat3 R_WJ;
      for (int k = 0; k < 9; ++k) R_WJ.m[k] = static_cast<double>(L::get(keep.R[k], lane));
      Vec3 origin = w.base(member.articulation).X.p;
      for (int r = 0; r < 3; ++r) origin[r] += static_cast<double>(L::get(keep.P[r], lane));
      const Mat3 R_LW = member.bones[static_cast<size_t>(place.link)].R_LJ * transpose(R_WJ);
      const Vec3 force = (side ? -weight : weight) * contact.force;
      w.sensor_out(sensor).force += R_LW * force;
      w.sensor_out(sensor).torque += R_LW * cross(contact.p - origin, force);
    }
  }
}

}  // namespace
}  // namespace rdm
