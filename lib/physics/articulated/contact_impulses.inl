// Part of stepper.inl: what the solved impulses do to velocities, what stays for the next substep, and the forces that are told.
#pragma once

namespace rdm {
namespace {

// What the contacts of one world come to: v1 of its bodies, and of robots the sums into their lanes.
template <class L>
void BatchStepper<L>::take_impulses(int32_t world) {
  WorldState& w = *worlds_[world];
  for (int32_t g = 0; g < num_groups_; ++g) {
    const Tree& tree = *groups_[g].tree;
    for (int32_t m = 0; m < groups_[g].members; ++m) {
      const int32_t a = tree.members[static_cast<size_t>(m)].articulation;
      if (!touched_[a]) continue;
      const auto [batch, lane] = lane_of(g, m, world);
      const auto* sum = contacts_.sum + member_segment_[a];
      batch->pushed |= 1u << lane;
      for (int32_t c = 0; c < tree.num_coords; ++c) {
        const TreeSlot slot = tree.slots[static_cast<size_t>(c)];
        L::set(&batch->push[c], lane, sum[slot.segment][slot.slot]);
      }
    }
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    if (w.asleep(i)) continue;
    FreeBody& body = w.free_bodies[i];
    const auto& sum = contacts_.sum[body_segment_[i]];
    const double sqrt_inv_mass = w.body_models[i].sqrt_inv_mass;
    const Vec3 linear{static_cast<double>(sum[0]), static_cast<double>(sum[1]), static_cast<double>(sum[2])},
        angular{static_cast<double>(sum[3]), static_cast<double>(sum[4]), static_cast<double>(sum[5])};
    body.v1 = body.v + sqrt_inv_mass * linear;
    body.w1 = body.w + transpose(body.inv_sqrt_inertia) * angular;
  }
}

// v1 += L^-1 D^-1/2 sum for the robots that are touched.
template <class L>
void BatchStepper<L>::apply_impulses(TreeBatch<L>& t) {
  const Tree& tree = *t.tree;
  const Mask lanes = L::mask(t.pushed);
  V* const push = t.push;
  for (int32_t c = 0; c < tree.num_coords; ++c) {
    CoordWork<V>& coord = t.coord[c];
    const int32_t row = tree.row[static_cast<size_t>(c)], depth = tree.depth[static_cast<size_t>(c)];
    const V* factor = t.factor + row;
    const int16_t* path = tree.path.data() + row;
    V x = push[c] * coord.inv_sqrt_d;
    for (int32_t d = 0; d < depth; ++d) x -= factor[d] * push[path[d]];
    push[c] = x;
    coord.v1 = L::select(lanes, V(coord.v1 + x), coord.v1);
  }
}

// Points to come that got no impulse: nobody touches there.
inline void drop_unmet(WorldState* w) {
  int32_t kept = 0;
  for (int32_t i = 0; i < w->num_contacts; ++i) {
    Contact& contact = w->contacts[i];
    if (contact.depth < 0) {
      if (dot(contact.force, contact.force) == 0) continue;
      w->touched[w->contact_pairs[i]] = 1;
      contact.depth = 0;
    }
    if (kept != i) {
      w->contacts[kept] = contact;
      w->contact_pairs[kept] = w->contact_pairs[i];
      w->warm[kept] = w->warm[i];
    }
    ++kept;
  }
  w->num_contacts = w->num_warm = kept;
}

// Contact forces, the impulses that the next substep's solve starts from, and the mean of the forces on the links
// with a sensor, in the pose they act in. A point that is solved moves apart at push_out_speed - softness n: where
// that is the bound and n is larger, it gives way for ever.
template <class L>
void BatchStepper<L>::contact_forces(int32_t world) {
  WorldState& w = *worlds_[world];
  const double inv_h = 1 / scene_->def.solver.h, weight = 1.0 / scene_->def.solver.substeps;
  const double fastest = most_push_out_speed();
  if (w.residual > kUnsolvedSpeed) w.status |= kStatusUnconverged;
  if (scene_->def.solver.speculative_contacts) drop_unmet(&w);
  for (int32_t i = 0; i < w.num_contacts; ++i) {
    Contact& contact = w.contacts[i];
    const ContactLaw* law = scene_->law_of(w.contact_pairs[i]);
    if (!(law && law->soft()) && softness(w, i) * dot(contact.force, contact.n) > fastest &&
        push_out_speed(w, i) == fastest)
      w.status |= kStatusUnconverged;
    for (int r = 0; r < 3; ++r) w.warm[i].impulse[r] = static_cast<float>(contact.force[r]);
    contact.force = inv_h * contact.force;
    for (int side = 0; side < 2; ++side) {
      const Attachment& at = attachments_[side ? contact.shape_b : contact.shape_a];
      if (at.kind == Attachment::kBody) w.free_bodies[at.body].touches = true;
      if (at.sensor < 0) continue;
      const TreeMember& member = groups_[at.group].tree->members[static_cast<size_t>(at.member)];
      const auto [batch, lane] = lane_of(at.group, at.member, world);
      const PersistentLink<V>& link = batch->state[at.link];
      Mat3 R_WJ;
      for (int k = 0; k < 9; ++k) R_WJ.m[k] = static_cast<double>(L::get(link.R[k], lane));
      Vec3 origin = w.bases[member.articulation].X.p;
      for (int r = 0; r < 3; ++r) origin[r] += static_cast<double>(L::get(link.P[r], lane));
      const Mat3 R_LW = member.links[static_cast<size_t>(at.link)].R_LJ * transpose(R_WJ);
      const Vec3 force = (side ? -weight : weight) * contact.force,
                 place = side ? contact.p + contact.gap : contact.p;
      w.sensors[at.sensor].force += R_LW * force;
      w.sensors[at.sensor].torque += R_LW * cross(place - origin, force);
    }
  }
}

}  // namespace
}  // namespace rdm
