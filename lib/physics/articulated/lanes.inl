// Part of stepper.inl: worlds into lanes and back.
#pragma once

namespace rdm {
namespace {

// Masks of lanes from sets of worlds, a bit each, and back.
template <class L>
typename L::Mask BatchStepper<L>::lanes_of(const TreeBatch<L>& t, uint32_t worlds) const {
  uint32_t bits = 0;
  for (int l = 0; l < L::kCount; ++l)
    if (t.used[l]) bits |= (worlds >> t.world[l] & 1) << l;
  return L::mask(bits);
}

template <class L>
uint32_t BatchStepper<L>::worlds_of(const TreeBatch<L>& t, Mask lanes) const {
  const uint32_t bits = L::bits(lanes);
  uint32_t worlds = 0;
  for (int l = 0; bits != 0 && l < L::kCount; ++l)
    if (t.used[l] && (bits >> l & 1)) worlds |= 1u << t.world[l];
  return worlds;
}

// Which world and member each lane has when `count` worlds are in.
template <class L>
void BatchStepper<L>::assign(TreeBatch<L>& t, int32_t batch, int32_t count) {
  int32_t g = 0;
  while (batch >= groups_[g].first_batch + groups_[g].num_batches) ++g;
  const Group& group = groups_[g];
  for (int l = 0; l < L::kCount; ++l) {
    const int32_t flat = (batch - group.first_batch) * L::kCount + l;
    t.member[l] = flat % group.members;
    t.world[l] = flat / group.members;
    t.used[l] = t.world[l] < count;
    if (!t.used[l]) t.world[l] = 0;
  }
}

// All that a step reads of its worlds, lane by lane, rounded to S. Lanes without a world read another's and
// are never written back: they cost nothing and take the same path as that one.
template <class L>
void BatchStepper<L>::gather(TreeBatch<L>& t) {
  const Tree& tree = *t.tree;
  const int32_t offset = tree.coord(0);
  const S* from[L::kCount];
  const double *q[L::kCount], *qd[L::kCount], *target[L::kCount];
  for (int l = 0; l < L::kCount; ++l) {
    const WorldState& world = *worlds_[t.world[l]];
    const TreeMember& member = member_of(t, l);
    from[l] = persistent_of(world, member.articulation);
    gather_base(t, l);
    if (tree.free_base) {
      const Motion& base = world.bases[member.articulation];
      for (int k = 0; k < 3; ++k) {
        L::set(&t.coord[k].qd, l, static_cast<S>(base.v[k]));
        L::set(&t.coord[3 + k].qd, l, static_cast<S>(base.w[k]));
      }
    }
    q[l] = world.q + member.first_link;
    qd[l] = world.qd + member.first_link;
    target[l] = world.target + member.first_link;
    for (int32_t i = 0; t.feedforward && i < tree.num_links; ++i)
      L::set(&t.feedforward[i], l, static_cast<S>(world.feedforward[member.first_link + i]));
  }
  L::gather_doubles(q, tree.num_links, [&](int i) { return &t.work[i].q; });
  L::gather_doubles(qd, tree.num_links, [&](int i) { return &t.coord[offset + i].qd; });
  L::gather_doubles(target, tree.num_links, [&](int i) { return &t.work[i].target; });
  L::gather(from, kBase, words(&t.base_state));
  for (const S*& f : from) f += kBase;
  L::gather(from, kLink * tree.num_links, words(t.state));
  for (int32_t i = 0; i < tree.num_links; ++i) t.work[i].torque = V{};
  if (scene_->def.adjustable) gather_constants(t);
  gather_pushes(t);
}

// What worlds have of their own in place of the scene's constants.
template <class L>
void BatchStepper<L>::gather_constants(TreeBatch<L>& t) {
  constexpr int kOfBase = static_cast<int>(kBaseConstants), kOfLink = static_cast<int>(kLinkConstants);
  const S* from[L::kCount];
  for (int l = 0; l < L::kCount; ++l)
    from[l] = static_cast<const S*>(worlds_[t.world[l]]->constants) +
              first_constant(*scene_, member_of(t, l).articulation);
  L::gather(from, kOfBase, words(static_cast<BaseConstants<V>*>(&t)));
  for (const S*& f : from) f += kOfBase;
  for (int32_t i = 0; i < t.tree->num_links; ++i) {
    L::gather(from, kOfLink, words(static_cast<LinkConstants<V>*>(&t.model[i])));
    for (const S*& f : from) f += kOfLink;
  }
}

template <class L>
void BatchStepper<L>::gather_pushes(TreeBatch<L>& t) {
  t.any_push = false;
  for (int l = 0; l < L::kCount; ++l) t.any_push |= worlds_[t.world[l]]->pushed;
  if (!t.any_push) return;
  const auto put = [](V* v, int lane, const Wrench& w) {
    for (int r = 0; r < 3; ++r) {
      L::set(&v[r], lane, static_cast<S>(w.force[r]));
      L::set(&v[3 + r], lane, static_cast<S>(w.torque[r]));
    }
  };
  for (int l = 0; l < L::kCount; ++l) {
    const WorldState& world = *worlds_[t.world[l]];
    const TreeMember& member = member_of(t, l);
    for (int32_t i = 0; i < t.tree->num_links; ++i)
      put(t.work[i].push, l, world.pushes[member.first_link + i]);
    put(t.base.push, l, world.base_pushes(*scene_)[member.articulation]);
  }
}

template <class L>
void BatchStepper<L>::gather_base(TreeBatch<L>& t, int lane) {
  const WorldState& world = *worlds_[t.world[lane]];
  const int32_t a = member_of(t, lane).articulation;
  const Mat3& R = world.base_R[a];
  for (int k = 0; k < 9; ++k) L::set(&t.base_R[k], lane, static_cast<S>(R.m[k]));
  const Quat& q_WB = world.bases[a].X.q;
  const double q[4] = {q_WB.w, q_WB.x, q_WB.y, q_WB.z};
  for (int k = 0; k < 4; ++k) L::set(&t.base_q[k], lane, static_cast<S>(q[k]));
}

template <class L>
void BatchStepper<L>::scatter(TreeBatch<L>& t) {
  const Tree& tree = *t.tree;
  const int32_t offset = tree.coord(0);
  S* to[L::kCount] = {};
  double *q[L::kCount] = {}, *qd[L::kCount] = {}, *torque[L::kCount] = {};
  int lanes = 0;
  for (int l = 0; l < L::kCount && t.used[l]; ++l, ++lanes) {
    WorldState& world = *worlds_[t.world[l]];
    const TreeMember& member = member_of(t, l);
    to[l] = persistent_of(world, member.articulation);
    q[l] = world.q + member.first_link;
    qd[l] = world.qd + member.first_link;
    torque[l] = world.torque + member.first_link;
  }
  L::scatter_doubles([&](int i) { return &t.work[i].q; }, tree.num_links, lanes, q);
  L::scatter_doubles([&](int i) { return &t.coord[offset + i].qd; }, tree.num_links, lanes, qd);
  L::scatter_doubles([&](int i) { return &t.work[i].torque; }, tree.num_links, lanes, torque);
  L::scatter(words(&t.base_state), kBase, lanes, to);
  for (int l = 0; l < lanes; ++l) to[l] += kBase;
  L::scatter(words(t.state), kLink * tree.num_links, lanes, to);
}

}  // namespace
}  // namespace rdm
