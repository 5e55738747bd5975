// Part of stepper.inl: points between free bodies, and with what is at rest, in lanes (wide_contacts.inl).
#pragma once

namespace rdm {
namespace {

// The pairs of free bodies with each other and with static shapes into lanes, if there are enough of them.
template <class L>
bool BatchStepper<L>::add_piles(int32_t world, bool again) {
  const WorldState& w = *worlds_[world];
  auto& wide = contacts_.wide;
  if (!wide.points || w.num_contacts < kWideFrom) return false;
  int32_t free = 0;
  for (int32_t i = 0; i < w.num_contacts; ++i) {
    in_pile_[i] =
        is_free(w.contacts[i]) && !scene_->law_of(w.contact_pairs[i]) && !(extremes_ && directly_[i] >= 0);
    free += in_pile_[i];
  }
  if (free < kWideFrom) return false;
  for (int32_t i = 0, end = 0; i < w.num_contacts; i = end) {
    while (end < w.num_contacts && w.contact_pairs[end] == w.contact_pairs[i]) ++end;
    if (in_pile_[i])
      wide.add(i, end - i, attachments_[w.contacts[i].shape_a].body,
               attachments_[w.contacts[i].shape_b].body);
  }
  wide.number_points();
  for (int32_t g = 0; g < wide.num_groups; ++g) add_pile_points(world, again, &wide.groups[g]);
  wide.warm_start(contacts_.sum);
  contacts_.levels = wide.levels([&](const auto& visit) {
    for (int32_t i = 0; i < w.num_contacts; ++i) {
      if (in_pile_[i]) continue;
      const Attachment &a = attachments_[w.contacts[i].shape_a], &b = attachments_[w.contacts[i].shape_b];
      if (a.kind == Attachment::kTree && b.kind == Attachment::kBody) visit(b.body);
      if (b.kind == Attachment::kTree && a.kind == Attachment::kBody) visit(a.body);
    }
  });
  return true;
}

// Rows, wanted velocities and starts of a group's points. Lanes without one get an axis and no mass.
template <class L>
void BatchStepper<L>::add_pile_points(int32_t world, bool again, typename WideContacts<S>::Group* group) {
  using W = typename WideContacts<S>::L;
  using WV = typename W::V;
  const WorldState& w = *worlds_[world];
  auto& wide = contacts_.wide;
  struct Side {
    WV root[9], v[3], w[3];  // C^-1 R^T, velocities without contacts
  };
  Side a{}, b{};
  const auto put = [](WV* v, int lane, double x) { W::set(v, lane, static_cast<S>(x)); };
  const auto put_body = [&](Side* side, WV* sqrt_mass, int lane, int32_t i) {
    if (i < 0) return;
    const FreeBody& body = w.free_bodies[i];
    for (int k = 0; k < 9; ++k) put(&side->root[k], lane, body.inv_sqrt_inertia.m[k]);
    for (int r = 0; r < 3; ++r) {
      put(&side->v[r], lane, body.v[r]);
      put(&side->w[r], lane, body.w[r]);
    }
    put(sqrt_mass, lane, w.body_models[i].sqrt_inv_mass);
  };
  for (int l = 0; l < group->lanes; ++l) {
    put_body(&a, &group->sqrt_mass_a, l, group->body_a[l]);
    put_body(&b, &group->sqrt_mass_b, l, group->body_b[l]);
    put(&group->mu, l, friction(w, w.contact_pairs[group->first[l]]));
  }
  group->linear = group->sqrt_mass_a * group->sqrt_mass_a + group->sqrt_mass_b * group->sqrt_mass_b;
  const auto dot3 = [](const WV* x, const WV* y) { return (x[0] * y[0] + x[1] * y[1]) + x[2] * y[2]; };
  const auto cross3 = [](const WV* x, const WV* y, WV* out) {
    out[0] = x[1] * y[2] - x[2] * y[1];
    out[1] = x[2] * y[0] - x[0] * y[2];
    out[2] = x[0] * y[1] - x[1] * y[0];
  };
  for (int32_t k = 0; k < group->most; ++k) {
    auto& p = wide.points[group->first_point + k];
    WV arm_a[3] = {}, arm_b[3] = {}, last[3] = {}, push_out{}, soft{};
    WV* n = p.axis[0];
    n[0] = n[1] = WV{};
    n[2] = W::all(S(1));
    for (int l = 0; l < group->lanes; ++l) {
      if (k >= group->count[l]) continue;
      const int32_t i = group->first[l] + k;
      const Contact& contact = w.contacts[i];
      const Vec3 to_a = contact.p - w.bodies[group->body_a[l]].X.p;
      const Vec3 to_b =
          group->body_b[l] < 0 ? Vec3{} : contact.p + contact.gap - w.bodies[group->body_b[l]].X.p;
      Vec3 start;
      if (again)
        start = w.contacts[i].force;
      else
        warm_impulse(w, i, &start);
      put(&push_out, l, push_out_speed(w, i));
      put(&soft, l, contact.depth < 0 ? 0 : softness(w, i));
      for (int r = 0; r < 3; ++r) {
        put(&n[r], l, contact.n[r]);
        put(&arm_a[r], l, to_a[r]);
        put(&arm_b[r], l, to_b[r]);
        put(&last[r], l, start[r]);
      }
    }
    // as tangents()
    const auto steep = n[2] * n[2] > S(0.5);
    const WV one = W::all(S(1)), none{};
    const WV inv = one / W::root(n[1] * n[1] + W::select(steep, n[2] * n[2], n[0] * n[0]));
    p.axis[1][0] = W::select(steep, none, -n[1] * inv);
    p.axis[1][1] = W::select(steep, -n[2], n[0]) * inv;
    p.axis[1][2] = W::select(steep, n[1] * inv, none);
    cross3(n, p.axis[1], p.axis[2]);
    for (int f = 0; f < 3; ++f) {
      WV moment_a[3], moment_b[3];
      cross3(arm_a, p.axis[f], moment_a);
      cross3(arm_b, p.axis[f], moment_b);
      WV slip[3];
      for (int r = 0; r < 3; ++r) {
        p.turn_a[f][r] = dot3(&a.root[3 * r], moment_a);
        p.turn_b[f][r] = -dot3(&b.root[3 * r], moment_b);
        slip[r] = a.v[r] - b.v[r];
      }
      p.b[f] = -(dot3(p.axis[f], slip) + dot3(moment_a, a.w) - dot3(moment_b, b.w));
      p.impulse[f] = dot3(last, p.axis[f]);
      if (f > 0) p.impulse[f] = W::select(group->mu > none, p.impulse[f], none);
    }
    p.b[0] += push_out;
    p.impulse[0] = W::select(p.impulse[0] < none, none, p.impulse[0]);
    wide.prepare(*group, &p, soft);
    // a lane that has no such point
    for (int l = 0; l < group->lanes; ++l)
      if (k >= group->count[l]) wide.clear(&p, l);
  }
}

template <class L>
void BatchStepper<L>::read_pile_impulses(int32_t world) {
  WorldState& w = *worlds_[world];
  const auto& wide = contacts_.wide;
  typedef double Doubles __attribute__((vector_size(sizeof(double) * kWide)));
  for (int32_t g = 0; g < wide.num_groups; ++g) {
    const auto& group = wide.groups[g];
    for (int32_t k = 0; k < group.most; ++k) {
      const auto& p = wide.points[group.first_point + k];
      Doubles out[3] = {};
      for (int f = 0; f < 3; ++f) {
        const Doubles impulse = __builtin_convertvector(p.impulse[f], Doubles);
        for (int r = 0; r < 3; ++r) out[r] += __builtin_convertvector(p.axis[f][r], Doubles) * impulse;
      }
      for (int l = 0; l < group.lanes; ++l)
        if (k < group.count[l]) w.contacts[group.first[l] + k].force = {out[0][l], out[1][l], out[2][l]};
    }
  }
}

}  // namespace
}  // namespace rdm
