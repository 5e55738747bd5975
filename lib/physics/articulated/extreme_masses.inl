// Part of stepper.inl: islands of free bodies of very unlike masses, over which sweeps alone hardly carry an impulse: they are
// found, and their points solved directly (direct_contacts.inl).
#pragma once

namespace rdm {
namespace {

// Which points are solved at once: those of free bodies that hang together by contacts and differ much in mass.
template <class L>
void BatchStepper<L>::find_extremes(int32_t world) {
  extremes_ = false;
  if (!island_) return;
  const WorldState& w = *worlds_[world];
  const auto body_of = [&](int32_t shape) {
    const Attachment& at = attachments_[shape];
    return at.kind == Attachment::kBody ? at.body : -1;
  };
  const auto root = [&](int32_t i) {
    while (island_[i].root != i) i = island_[i].root = island_[island_[i].root].root;
    return i;
  };
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    const double inverse = w.body_models[i].inv_mass;
    island_[i] = {i, 0, inverse, inverse};
  }
  for (int32_t i = 0; i < w.num_contacts; ++i) {
    const int32_t a = body_of(w.contacts[i].shape_a), b = body_of(w.contacts[i].shape_b);
    if (a < 0 || b < 0) continue;
    const int32_t x = root(a), y = root(b);
    if (x == y) continue;
    Island &to = island_[std::min(x, y)], &from = island_[std::max(x, y)];
    from.root = std::min(x, y);
    to.least = std::min(to.least, from.least);
    to.most = std::max(to.most, from.most);
    extremes_ |= to.most > kExtremeRatio * to.least;
  }
  if (!extremes_) return;
  for (int32_t i = 0; i < w.num_contacts; ++i) {
    const int32_t a = body_of(w.contacts[i].shape_a), b = body_of(w.contacts[i].shape_b);
    const bool own_law = scene_->law_of(w.contact_pairs[i]) != nullptr;
    directly_[i] = own_law || (a < 0 && b < 0) ? -1 : root(std::max(a, b));
    if (directly_[i] < 0) continue;
    // what a robot holds is left to the sweeps: its points hang together through the whole robot
    const bool held = attachments_[w.contacts[i].shape_a].kind == Attachment::kTree ||
                      attachments_[w.contacts[i].shape_b].kind == Attachment::kTree;
    island_[directly_[i]].points += held ? kMostDirect + 1 : 1;
  }
  for (int32_t i = 0; i < w.num_contacts; ++i) {
    if (directly_[i] < 0) continue;
    const Island& island = island_[directly_[i]];
    if (island.points > kMostDirect || island.most <= kExtremeRatio * island.least) directly_[i] = -1;
  }
}

// True if that is all there is to solve of the points outside of lanes: then no sweep touches them.
template <class L>
bool BatchStepper<L>::solve_extremes(int32_t world) {
  bool all = true;
  const WorldState& w = *worlds_[world];
  const SolverDef& solver = scene_->def.solver;
  for (int32_t island = 0; island < scene_->num_bodies; ++island) {
    direct_.begin();
    for (int32_t i = 0, k = 0; i < w.num_contacts; ++i) {
      if (contacts_.wide.count > 0 && in_pile_[i]) continue;
      if (scene_->law_of(w.contact_pairs[i])) {
        all = false;
        continue;
      }
      auto* point = contacts_.points + k++;
      all &= directly_[i] >= 0;
      if (directly_[i] == island)
        direct_.add(point, kYieldShare * layer(w, i) * solver.contact_erp / solver.h);
    }
    if (direct_.count > 0) all &= direct_.solve(&contacts_);
  }
  return all;
}

}  // namespace
}  // namespace rdm
