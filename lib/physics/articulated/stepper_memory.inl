// Part of stepper.inl: memory, and what stays the same in every step: constants of the trees, what carries each shape.
#pragma once

namespace rdm {
namespace {

// Two bodies differ by kExtremeRatio, as they are or by a world's factors on their masses.
template <class L>
bool BatchStepper<L>::may_be_extreme() const {
  constexpr double kFactors = 4;
  double least = HUGE_VAL, most = 0;
  for (const BodyDef& body : scene_->def.bodies) {
    least = std::min(least, body.inertia.mass);
    most = std::max(most, body.inertia.mass);
  }
  return most * (scene_->def.adjustable ? kFactors : 1) > kExtremeRatio * least;
}

// Segments of the contact solver: those of every member of every tree, then one per body.
template <class L>
void BatchStepper<L>::carve(Arena& arena, bool borrows) {
  num_groups_ = static_cast<int32_t>(model_->trees.size());
  groups_ = arena.make<Group>(static_cast<size_t>(num_groups_));
  int32_t most_members = 1, most_coords = 0, segments = scene_->num_bodies, path = 1;
  num_batches_ = 0;
  for (const Tree& tree : model_->trees)
    most_members = std::max(most_members, static_cast<int32_t>(tree.members.size()));
  group_size_ = std::max(1, L::kCount / most_members);
  for (int32_t g = 0; g < num_groups_; ++g) {
    const Tree& tree = model_->trees[static_cast<size_t>(g)];
    const auto members = static_cast<int32_t>(tree.members.size());
    Group group = {&tree,   members, num_batches_, (group_size_ * members + L::kCount - 1) / L::kCount,
                   nullptr, 0};
    if (kWritesFelt) group.felt = arena.make<int32_t>(static_cast<size_t>(tree.num_links));
    if (groups_) groups_[g] = group;
    num_batches_ += group.num_batches;
    most_coords = std::max(most_coords, tree.num_coords);
    segments += members * tree.num_segments;
    path = std::max(path, tree.path_segments);
  }
  batches_ = arena.make<TreeBatch<L>>(static_cast<size_t>(num_batches_));
  int32_t batch = 0;
  for (const Tree& tree : model_->trees) {
    const auto members = static_cast<int32_t>(tree.members.size());
    for (int32_t k = 0; k < (group_size_ * members + L::kCount - 1) / L::kCount; ++k, ++batch) {
      const auto links = static_cast<size_t>(tree.num_links), shapes = tree.shape_links.size();
      TreeBatch<L> t{};
      t.tree = &tree;
      t.model = arena.make<LinkModel<L>>(links);
      t.state = arena.make<PersistentLink<V>>(links);
      if (tree.looks_ahead) {
        t.trial = arena.make<PersistentLink<V>>(links);
        t.present = arena.make<V>(static_cast<size_t>(tree.num_coords) + links);
      }
      t.work = arena.make<LinkWork<V>>(links);
      t.coord = arena.make<CoordWork<V>>(static_cast<size_t>(tree.num_coords));
      t.mass_matrix = arena.make<V>(tree.path.size());
      t.reduced = arena.make<V>(tree.path.size());
      t.factor = arena.make<V>(tree.path.size());
      t.dv = arena.make<V>(static_cast<size_t>(tree.num_coords));
      t.push = arena.make<V>(static_cast<size_t>(tree.num_coords));
      if (scene_->def.feedforward) t.feedforward = arena.make<V>(links);
      t.shape_p = arena.make<V[3]>(shapes);
      t.shape_a = arena.make<V[3]>(shapes);
      t.center = arena.make<V[3]>(shapes);
      t.axis = arena.make<V[3]>(shapes);
      if (scene_->def.solver.speculative_contacts) t.shape_way = arena.make<V>(shapes);
      if (batches_) batches_[batch] = t;
    }
  }
  in_lanes_ = kSearchesWide && num_groups_ > 0 && !scene_->def.solver.speculative_contacts;
  if (in_lanes_) robot_pairs_.carve(*scene_, arena, group_size_);
  attachments_ = arena.make<Attachment>(scene_->shapes.size());
  half_widths_ = arena.make<double>(scene_->shapes.size());
  body_segment_ = arena.make<int32_t>(static_cast<size_t>(scene_->num_bodies));
  member_segment_ = arena.make<int32_t>(scene_->def.articulations.size());
  first_word_ = arena.make<int32_t>(scene_->def.articulations.size());
  touched_ = arena.make<uint8_t>(scene_->def.articulations.size());
  in_pile_ = arena.make<uint8_t>(static_cast<size_t>(scene_->def.solver.contacts_max));
  if (may_be_extreme()) {
    island_ = arena.make<Island>(static_cast<size_t>(scene_->num_bodies));
    directly_ = arena.make<int32_t>(static_cast<size_t>(scene_->def.solver.contacts_max));
    if (!borrows) direct_.carve(arena, segments);
  }
  path_ = arena.make<S>((scene_->laws.empty() ? 4u : 6u) * static_cast<size_t>(most_coords));
  factor_rows_ = arena.make<const V*>(static_cast<size_t>(most_coords));
  R_JL_ = arena.make<Mat3>(static_cast<size_t>(scene_->num_links));
  q_JL_ = arena.make<Quat>(static_cast<size_t>(scene_->num_links));
  if (borrows) return;
  this->own_points = arena.make<WarmPoint>(static_cast<size_t>(scene_->def.solver.contacts_max));
  contacts_.carve(arena, scene_->def.solver.contacts_max, segments, path, scene_->num_bodies);
  if (!scene_->laws.empty()) contacts_.laws.carve(arena, scene_->def.solver.contacts_max, path);
}

// The constants of each lane's member. They stay: a lane holds the same member in every step.
template <class L>
void BatchStepper<L>::fill_constants(TreeBatch<L>& t, int32_t batch) {
  const SolverDef& solver = scene_->def.solver;
  const Tree& tree = *t.tree;
  t.h = static_cast<S>(solver.h);
  t.inv_h = static_cast<S>(1 / solver.h);
  t.spring_only = solver.spring_only_effort;
  t.limit_law = solver.limit_law.soft() ? &solver.limit_law : nullptr;
  assign(t, batch, group_size_);
  if (tree.free_base)
    for (int k = 0; k < 3; ++k) {
      t.coord[k].s[k] = L::all(1);
      t.coord[3 + k].a[k] = L::all(1);
    }
  const auto put = [](V* v, int lane, double x) { L::set(v, lane, static_cast<S>(x)); };
  for (int l = 0; l < L::kCount; ++l) {
    const TreeMember& m = member_of(t, l);
    const auto put_words = [&](V* to, const auto& record) {
      double from[sizeof record / sizeof(double)];
      std::memcpy(from, &record, sizeof record);
      for (size_t k = 0; k < std::size(from); ++k) put(to + k, l, from[k]);
    };
    put_words(words(static_cast<BaseConstants<V>*>(&t)), base_constants(*model_, m, nullptr));
    for (int r = 0; r < 3; ++r) put(&t.base_com[r], l, m.base.com[r]);
    for (int32_t i = 0; i < tree.num_links; ++i) {
      const MemberLink& link = m.links[static_cast<size_t>(i)];
      const JointDef& joint = link.joint;
      LinkModel<L>& b = t.model[i];
      for (int k = 0; k < 9; ++k) put(&b.R_PJ[k], l, link.R_PJ.m[k]);
      const double q_PJ[4] = {link.q_PJ.w, link.q_PJ.x, link.q_PJ.y, link.q_PJ.z};
      for (int k = 0; k < 4; ++k) put(&b.q_PJ[k], l, q_PJ[k]);
      for (int r = 0; r < 3; ++r) put(&b.p_PJ[r], l, link.p_PJ[r]);
      for (int r = 0; r < 3; ++r) put(&b.com[r], l, link.inertia.com[r]);
      put_words(words(static_cast<LinkConstants<V>*>(&b)), link_constants(*model_, m, i, nullptr));
      put(&b.lower, l, joint.lower);
      put(&b.upper, l, joint.upper);
      put(&b.ratio, l, joint.ratio);
      put(&b.slack, l, joint.slack);
      put(&b.limit_stiffness, l, link.limit_stiffness);
      put(&b.limit_weight, l, link.limit_weight);
      put(&b.limit_time, l, link.limit_time);
    }
    for (size_t k = 0; k < m.shapes.size(); ++k) {
      const ShapeDef& def = scene_->shapes[static_cast<size_t>(m.first_shape) + k].def;
      for (int r = 0; r < 3; ++r) {
        put(&t.shape_p[k][r], l, m.shapes[k].p_JS[r]);
        put(&t.shape_a[k][r], l, tree.shape_slender[k] ? def.size.y * m.shapes[k].R_JS(r, 2) : 0);
      }
    }
  }
}

// Which body, or which link's coordinate, moves each shape, where its rows go, and which sensor feels it.
template <class L>
void BatchStepper<L>::list_attachments() {
  int32_t segment = 0, word = 0;
  for (size_t a = 0; a < scene_->def.articulations.size(); ++a) {
    first_word_[a] = word;
    word += kBase + kLink * static_cast<int32_t>(scene_->def.articulations[a].links.size());
  }
  const Attachment none = {Attachment::kStatic, 0, 0, -1, -1, -1, -1, 0};
  for (size_t i = 0; i < scene_->shapes.size(); ++i) {
    attachments_[i] = none;
    half_widths_[i] = half_width(*scene_, scene_->shapes[i]);
  }
  const auto sensor_of = [&](int32_t link) {
    for (size_t i = 0; i < scene_->sensors.size(); ++i)
      if (scene_->sensors[i] == link) return static_cast<int32_t>(i);
    return -1;
  };
  for (int32_t g = 0; g < num_groups_; ++g) {
    const Tree& tree = *groups_[g].tree;
    for (int32_t m = 0; m < groups_[g].members; ++m, segment += tree.num_segments) {
      const TreeMember& member = tree.members[static_cast<size_t>(m)];
      member_segment_[member.articulation] = segment;
      for (int32_t i = 0; i < tree.num_links; ++i) {
        R_JL_[member.first_link + i] = transpose(member.links[static_cast<size_t>(i)].R_LJ);
        q_JL_[member.first_link + i] = conjugate(member.links[static_cast<size_t>(i)].q_LJ);
      }
      for (size_t k = 0; k < tree.shape_links.size(); ++k) {
        const int32_t link = tree.shape_links[k],
                      coord = link < 0 ? (tree.free_base ? 5 : -1) : tree.coord(link);
        if (coord < 0) continue;  // on a fixed base
        Attachment& at = attachments_[static_cast<size_t>(member.first_shape) + k];
        at.kind = Attachment::kTree;
        at.group = g;
        at.member = m;
        at.coord = coord;
        at.link = link;
        at.sensor = link < 0 ? -1 : sensor_of(member.first_link + link);
        at.first_segment = segment;
      }
    }
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) body_segment_[i] = segment++;
  for (size_t i = 0; i < scene_->shapes.size(); ++i) {
    const SceneShape& s = scene_->shapes[i];
    if (s.carrier != Carrier::kBody) continue;
    attachments_[i].kind = Attachment::kBody;
    attachments_[i].body = s.index;
    attachments_[i].first_segment = body_segment_[s.index];
  }
}

}  // namespace
}  // namespace rdm
