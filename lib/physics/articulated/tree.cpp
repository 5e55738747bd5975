#include "physics/articulated/tree.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "physics/model/drive.hpp"
#include "physics/model/inertia.hpp"
#include "physics/model/inverse_weights.hpp"

namespace rdm {
namespace {

// The smallest rotation from z to the unit vector `axis`.
Mat3 rotation_from_z(const Vec3& a) {
  if (a.z < -0.999999) return {{1, 0, 0, 0, -1, 0, 0, 0, -1}};
  const double k = 1 / (1 + a.z);
  return {{1 - a.x * a.x * k, -a.x * a.y * k, a.x, -a.x * a.y * k, 1 - a.y * a.y * k, a.y, -a.x, -a.y, a.z}};
}

bool is_identity(const Mat3& r) {
  constexpr Mat3 kOne;
  return std::equal(std::begin(r.m), std::end(r.m), std::begin(kOne.m));
}

bool is_isotropic(const Inertia& inertia) {
  const double* m = inertia.moment;
  return m[0] == m[1] && m[0] == m[2] && m[3] == 0 && m[4] == 0 && m[5] == 0;
}

bool is_massless(const Inertia& inertia) {
  return inertia.mass == 0 &&
         std::all_of(inertia.moment, inertia.moment + 6, [](double m) { return m == 0; });
}

// The solver's stiffness gives way to heavier links: k is at least kStiff I / T^2, with I the most that the joint
// may carry in any pose, its motor's own with it (kg m2, kg), so that an end of damping k T, which acts from
// q + T qd = edge on, is overdamped: what runs into it stops at the edge, not beyond, at any substep.
constexpr double kStiff = 20;
// Where torques are fed forward, a motor may lean on its stop for good: the end then holds it this far inside
// the margin, past which it would be stopped without a reaction, and push a free base along.
// Up to kStiffest I / h^2, for efforts that stand for no bound at all.
constexpr double kLeaning = 0.5, kStiffest = 1e4;
// T, an end's damping over its stiffness, is kLimitTime (drive.hpp): in seconds, whatever the substep; but no less
// than implicit Euler's own h.

void set_limits(const Scene& scene, const ArticulationDef& def, TreeMember* member) {
  const SolverDef& solver = scene.def.solver;
  const auto count = def.links.size();
  Vector<double> carried(count);
  for (size_t k = 0; k < count; ++k) {
    const Inertia& inertia = def.links[k].inertia;
    carried[k] += def.links[k].joint.armature;
    const double moment = inertia.moment[0] + inertia.moment[1] + inertia.moment[2];
    double reach = norm(inertia.com);
    for (auto i = static_cast<int32_t>(k); i >= 0;) {
      const LinkDef& link = def.links[static_cast<size_t>(i)];
      const bool slides = link.joint.kind == JointKind::kPrismatic;
      carried[static_cast<size_t>(i)] += slides ? inertia.mass : inertia.mass * reach * reach + moment;
      reach += norm(link.X_PL.p);
      if (slides) reach += std::max(std::fabs(link.joint.lower), std::fabs(link.joint.upper));
      i = link.parent;
    }
  }
  for (size_t i = 0; i < count; ++i) {
    double k = solver.limit_stiffness;
    // as stiff as steps of kLimitTime allow, in shorter ones too: where a joint stops does not depend on them
    const double step = std::max(solver.h, kLimitTime), stiff = carried[i] / (step * step);
    if (k > 0) k = std::max(k, kStiff * stiff);
    if (k > 0 && scene.def.feedforward && def.free_base && solver.limit_margin > 0)
      k = std::max(k,
                   std::min(def.links[i].joint.effort / (kLeaning * solver.limit_margin), kStiffest * stiff));
    member->links[i].limit_stiffness = k;
    member->links[i].limit_weight = 1;
    member->links[i].limit_time = step;
  }
}

TreeMember make_member(const Scene& scene, int32_t articulation) {
  const ArticulationDef& def = scene.def.articulations[static_cast<size_t>(articulation)];
  TreeMember member;
  member.articulation = articulation;
  member.first_link = scene.link_offset[static_cast<size_t>(articulation)];
  member.first_shape = scene.first_shape[static_cast<size_t>(articulation)];
  member.base = def.base;
  if (def.gravity) member.gravity = scene.def.gravity;
  member.base_damping = def.free_base ? def.base_damping : 0;
  for (const LinkDef& link : def.links) {
    MemberLink out;
    out.R_LJ = rotation_from_z(link.joint.axis);
    const Mat3 R_JP =
        link.parent < 0 ? Mat3{} : transpose(member.links[static_cast<size_t>(link.parent)].R_LJ);
    out.R_PJ = R_JP * to_matrix(link.X_PL.q) * out.R_LJ;
    out.p_PJ = R_JP * link.X_PL.p;
    // Parallel axes: products of a rotation and its transpose, off by a rounding.
    out.q_LJ = to_quat(out.R_LJ);
    const Quat q_JP =
        link.parent < 0 ? Quat{} : conjugate(member.links[static_cast<size_t>(link.parent)].q_LJ);
    out.q_PJ = q_JP * link.X_PL.q * out.q_LJ;
    if (std::fabs(out.R_PJ.m[0] + out.R_PJ.m[4] + out.R_PJ.m[8] - 3) < 1e-14) {
      out.R_PJ = Mat3{};
      out.q_PJ = {out.q_PJ.w > 0 ? 1.0 : -1.0, 0, 0, 0};
    }
    out.inertia = in_joint_axes(link.inertia, out.R_LJ);
    out.joint = link.joint;
    member.links.push_back(out);
  }
  set_limits(scene, def, &member);
  for (const ArticulationShape& s : def.shapes) {
    const Mat3 R_JL = s.link < 0 ? Mat3{} : transpose(member.links[static_cast<size_t>(s.link)].R_LJ);
    member.shapes.push_back({R_JL * to_matrix(s.shape.X_LS.q), R_JL * s.shape.X_LS.p});
  }
  return member;
}

// Free bases alone: of a fixed one, rates at the substep's end are nearer to the exact ones as they are. And not
// where damping takes most of the energy anyway.
constexpr double kStrongDamping = 0.1;  // of a velocity in a substep
bool should_look_ahead(const Scene& scene, const ArticulationDef& def) {
  const SolverDef& solver = scene.def.solver;
  switch (solver.integrator) {
    case Integrator::kEuler:
      return false;
    case Integrator::kTrapezoid:
      return true;
    case Integrator::kAuto:
      break;
  }
  return def.free_base && solver.h * def.base_damping < kStrongDamping;
}

bool same_shape_of_tree(const Scene& scene, const Tree& tree, int32_t articulation) {
  const ArticulationDef& def = scene.def.articulations[static_cast<size_t>(articulation)];
  if (def.free_base != tree.free_base || should_look_ahead(scene, def) != tree.looks_ahead ||
      static_cast<int32_t>(def.links.size()) != tree.num_links ||
      def.shapes.size() != tree.shape_links.size())
    return false;
  for (size_t i = 0; i < def.shapes.size(); ++i)
    if (def.shapes[i].link != tree.shape_links[i] ||
        (def.shapes[i].shape.kind == ShapeKind::kCapsule) != (tree.shape_slender[i] != 0))
      return false;
  for (size_t i = 0; i < def.links.size(); ++i) {
    const LinkDef& link = def.links[i];
    const TreeLink& other = tree.links[i];
    if (link.parent != other.parent || (link.joint.kind == JointKind::kPrismatic) != other.prismatic ||
        link.joint.coupled_to != other.coupled_to || link.sensor != other.sensor ||
        link.weightless != other.weightless)
      return false;
  }
  return true;
}

void add_coord(Tree* tree, int32_t parent) {
  const auto at = static_cast<int32_t>(tree->depth.size());
  tree->row.push_back(static_cast<int32_t>(tree->path.size()));
  const int32_t depth = parent < 0 ? 0 : tree->depth[static_cast<size_t>(parent)] + 1;
  tree->depth.push_back(depth);
  for (int32_t d = 0; d < depth; ++d)
    tree->path.push_back(tree->path[static_cast<size_t>(tree->row[static_cast<size_t>(parent)] + d)]);
  tree->path.push_back(static_cast<int16_t>(at));
}

// The coordinate before which a coordinate's row ends: its parent, or what couplings put in between. By
// symbolic elimination, the last coordinate first: what a row has entries with, its parent has too.
Vector<int32_t> row_parents(const Tree& tree, const Vector<int32_t>& parents) {
  const auto count = parents.size();
  Vector<uint8_t> entries(count * count);
  const auto entry = [&](size_t row, int32_t column) -> uint8_t& {
    return entries[row * count + static_cast<size_t>(column)];
  };
  for (size_t c = 0; c < count; ++c)
    for (int32_t p = parents[c]; p >= 0; p = parents[static_cast<size_t>(p)]) entry(c, p) = 1;
  for (int32_t i = 0; i < tree.num_links; ++i) {
    const int32_t other = tree.links[static_cast<size_t>(i)].coupled_to;
    if (other < 0) continue;
    const auto [low, high] = std::minmax({tree.coord(i), tree.coord(other)});
    entry(static_cast<size_t>(high), low) = 1;
  }
  Vector<int32_t> out(count, -1);
  for (size_t c = count; c-- > 0;) {
    for (auto p = static_cast<int32_t>(c); p-- > 0 && out[c] < 0;)
      if (entry(c, p)) out[c] = p;
    if (out[c] < 0) continue;
    for (int32_t p = 0; p < out[c]; ++p) entry(static_cast<size_t>(out[c]), p) |= entry(c, p);
  }
  return out;
}

// Which coordinates of a row move its link, and where the entries of couplings are.
void mark_rows(const Vector<int32_t>& parents, Tree* tree) {
  const auto place = [&](int32_t c, int32_t other) {
    const int32_t row = tree->row[static_cast<size_t>(c)], depth = tree->depth[static_cast<size_t>(c)];
    const auto begin = tree->path.begin() + row;
    return static_cast<int32_t>(std::find(begin, begin + depth, static_cast<int16_t>(other)) -
                                tree->path.begin());
  };
  tree->moving.resize(tree->path.size());
  for (int32_t c = 0; c < tree->num_coords; ++c) {
    tree->moving[static_cast<size_t>(tree->row[static_cast<size_t>(c)] +
                                     tree->depth[static_cast<size_t>(c)])] = 1;
    for (int32_t p = parents[static_cast<size_t>(c)]; p >= 0; p = parents[static_cast<size_t>(p)])
      tree->moving[static_cast<size_t>(place(c, p))] = 1;
  }
  for (int32_t i = 0; i < tree->num_links; ++i) {
    TreeLink& link = tree->links[static_cast<size_t>(i)];
    if (link.coupled_to < 0) continue;
    const auto [low, high] = std::minmax({tree->coord(i), tree->coord(link.coupled_to)});
    link.coupling_entry = place(high, low);
    tree->coupled.push_back(i);
  }
}

void list_slots(Tree* tree) {
  const auto count = static_cast<size_t>(tree->num_coords);
  Vector<int32_t> children(count), segments(count);  // segments: on the path so far
  const auto parent = [&](size_t c) -> int32_t {
    const int32_t depth = tree->depth[c];
    return depth == 0 ? -1 : tree->path[static_cast<size_t>(tree->row[c] + depth - 1)];
  };
  for (size_t c = 0; c < count; ++c)
    if (parent(c) >= 0) ++children[static_cast<size_t>(parent(c))];
  for (size_t c = 0; c < count; ++c) {
    const int32_t p = parent(c);
    const TreeSlot* above = p < 0 ? nullptr : &tree->slots[static_cast<size_t>(p)];
    const bool continues = above && children[static_cast<size_t>(p)] == 1 && above->slot + 1 < kSegment;
    segments[c] = (p < 0 ? 0 : segments[static_cast<size_t>(p)]) + (continues ? 0 : 1);
    if (continues)
      tree->slots.push_back({above->segment, static_cast<int16_t>(above->slot + 1)});
    else
      tree->slots.push_back({static_cast<int16_t>(tree->num_segments++), 0});
    tree->path_segments = std::max(tree->path_segments, segments[c]);
  }
}

void list_below(Tree* tree) {
  for (int32_t c = 0; c < tree->num_coords; ++c) {
    tree->first_below.push_back(static_cast<int32_t>(tree->below.size()));
    const auto depth = tree->depth[static_cast<size_t>(c)];
    for (int32_t k = tree->num_coords - 1; k > c; --k) {
      const int32_t row = tree->row[static_cast<size_t>(k)];
      if (tree->depth[static_cast<size_t>(k)] > depth && tree->path[static_cast<size_t>(row + depth)] == c)
        tree->below.push_back({k, row});
    }
  }
  tree->first_below.push_back(static_cast<int32_t>(tree->below.size()));
}

Tree make_tree(const Scene& scene, int32_t articulation) {
  const ArticulationDef& def = scene.def.articulations[static_cast<size_t>(articulation)];
  Tree tree;
  tree.free_base = def.free_base;
  tree.looks_ahead = should_look_ahead(scene, def);
  tree.num_links = static_cast<int32_t>(def.links.size());
  tree.num_coords = tree.coord(tree.num_links);
  if (tree.num_coords > kMaxCoords)
    fail(Code::kUnsupported, "%s: it has %d coordinates, but the engine takes at most %d", def.name.text,
         tree.num_coords, kMaxCoords);
  Vector<int32_t> parents;  // of each coordinate
  if (def.free_base)
    for (int32_t k = 0; k < 6; ++k) parents.push_back(k - 1);
  const int32_t base_coord = def.free_base ? 5 : -1;
  for (const LinkDef& link : def.links) {
    TreeLink t;
    t.parent = link.parent;
    t.coupled_to = link.joint.coupled_to;
    t.prismatic = link.joint.kind == JointKind::kPrismatic;
    t.sensor = link.sensor;
    t.weightless = link.weightless;
    tree.links.push_back(t);
    parents.push_back(link.parent < 0 ? base_coord : tree.coord(link.parent));
  }
  for (const int32_t parent : row_parents(tree, parents)) add_coord(&tree, parent);
  mark_rows(parents, &tree);
  for (const ArticulationShape& s : def.shapes) {
    tree.shape_links.push_back(s.link);
    tree.shape_slender.push_back(s.shape.kind == ShapeKind::kCapsule);
  }
  list_slots(&tree);
  list_below(&tree);
  return tree;
}

// Without any inertia a joint's row has nothing to divide by.
void check_masses(const Scene& scene, const Tree& tree) {
  Vector<uint8_t> has_inertia(tree.links.size());
  for (const TreeMember& member : tree.members) {
    for (size_t i = tree.links.size(); i-- > 0;) {
      const MemberLink& link = member.links[i];
      if (!is_massless(link.inertia) || link.joint.armature > 0) has_inertia[i] = 1;
      if (!has_inertia[i])
        fail(Code::kRange, "%s: the link needs a mass, an armature, or a child link with mass",
             scene.link(member.first_link + static_cast<int32_t>(i)).name.text);
      if (tree.links[i].parent >= 0) has_inertia[static_cast<size_t>(tree.links[i].parent)] = 1;
    }
  }
}

// Shortcuts hold for all members or for none: a lane's bits must not depend on its neighbours.
void find_shortcuts(Tree* tree) {
  for (size_t i = 0; i < tree->links.size(); ++i) {
    TreeLink& link = tree->links[i];
    const auto everywhere = [&](auto is) {
      return std::all_of(tree->members.begin(), tree->members.end(),
                         [&](const TreeMember& m) { return is(m.links[i]); });
    };
    link.aligned = everywhere([](const MemberLink& b) { return is_identity(b.R_PJ) && b.q_PJ.w > 0; });
    link.isotropic = everywhere([](const MemberLink& b) { return is_isotropic(b.inertia); });
    link.massless = everywhere([](const MemberLink& b) { return is_massless(b.inertia); });
  }
}

}  // namespace

Inertia in_joint_axes(const Inertia& inertia, const Mat3& R_LJ) {
  Inertia out = inertia;
  const Mat3 R_JL = transpose(R_LJ);
  out.com = R_JL * inertia.com;
  if (!is_isotropic(inertia)) set_moment(&out, R_JL * moment_matrix(inertia) * R_LJ);
  return out;
}

Vector<Tree> make_trees(const Scene& scene) {
  Vector<Tree> trees;
  for (int32_t a = 0; a < static_cast<int32_t>(scene.def.articulations.size()); ++a) {
    auto tree = std::find_if(trees.begin(), trees.end(),
                             [&](const Tree& t) { return same_shape_of_tree(scene, t, a); });
    if (tree == trees.end()) tree = trees.insert(tree, make_tree(scene, a));
    tree->members.push_back(make_member(scene, a));
  }
  for (Tree& tree : trees) {
    check_masses(scene, tree);
    find_shortcuts(&tree);
  }
  if (!scene.def.solver.limit_law.soft()) return trees;
  const InverseWeights weights = inverse_weights(scene);
  for (Tree& tree : trees)
    for (TreeMember& member : tree.members)
      for (int32_t i = 0; i < tree.num_links; ++i)
        member.links[static_cast<size_t>(i)].limit_weight =
            weights.joints[static_cast<size_t>(member.first_link + i)];
  return trees;
}

}  // namespace rdm
