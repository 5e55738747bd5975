// What a stepper does between steps: follows changes from outside, tells link poses. Part of stepper_v*.cpp.
#pragma once
#include "physics/articulated/stepper_lanes.hpp"

namespace rdm {
namespace {

template <class L>
void StepperLanes<L>::refresh(ArticulatedWorld& world, int32_t articulation) {
  ArticulatedWorld* const one[1] = {&world};
  worlds_ = one;
  count_ = 1;
  for (int32_t k = 0; k < num_sets_; ++k) {
    TreeBatch<L>& t = sets_[k];
    assign(t, k, 1);
    bool here = false;
    for (int l = 0; l < L::kCount; ++l) here |= t.used[l] && member_of(t, l).articulation == articulation;
    if (!here) continue;
    gather(t);
    kinematics(t);
    turns(t);
    place_masses(t);
    const int32_t links = t.tree->num_links;
    LinkState<V>* all = t.keep;
    carry(t);
    // other members of the tree keep what they have
    for (int l = 0; l < L::kCount; ++l) t.used[l] = t.used[l] && member_of(t, l).articulation == articulation;
    for (int l = 0; l < L::kCount; ++l) {
      if (!t.used[l]) continue;
      S* to = keep_of(world, articulation);
      constexpr int kBase = sizeof(BaseState<S>) / sizeof(S), kLink = sizeof(LinkState<S>) / sizeof(S);
      const V* base = t.base_keep.linear;
      for (int k2 = 0; k2 < kBase; ++k2) to[k2] = L::get(base[k2], l);
      const V* rows = all[0].R;
      for (int k2 = 0; k2 < kLink * links; ++k2) to[kBase + k2] = L::get(rows[k2], l);
    }
  }
  worlds_ = nullptr;
}

template <class L>
void StepperLanes<L>::read_link(const ArticulatedWorld& world, int32_t link, Motion* m, Mat3* R) const {
  const int32_t a = scene_->link_articulation[static_cast<size_t>(link)];
  const int32_t i = link - scene_->link_offset[static_cast<size_t>(a)];
  constexpr int kBase = sizeof(BaseState<S>) / sizeof(S);
  LinkState<S> keep;
  std::memcpy(&keep, keep_of(world, a) + kBase + i * static_cast<int32_t>(sizeof keep / sizeof(S)),
              sizeof keep);
  Mat3 R_WJ;
  for (int k = 0; k < 9; ++k) R_WJ.m[k] = static_cast<double>(keep.R[k]);
  *R = R_WJ * link_turn_[link];
  const Vec3& base = world.base(a).X.p;
  for (int r = 0; r < 3; ++r) {
    m->X.p[r] = base[r] + static_cast<double>(keep.P[r]);
    m->v[r] = static_cast<double>(keep.v[r]);
    m->w[r] = static_cast<double>(keep.w[r]);
  }
  const Quat q_WJ = {static_cast<double>(keep.q[0]), static_cast<double>(keep.q[1]),
                     static_cast<double>(keep.q[2]), static_cast<double>(keep.q[3])};
  m->X.q = normalized(q_WJ * link_back_[link]);
}

}  // namespace
}  // namespace rdm
