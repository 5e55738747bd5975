// The constant model of robots in generalised coordinates: what the articulated engine knows of them.
//
// Frames: W world, B base, L link (as the scene has it), P the parent link's joint frame (or the base), J the
// link's *joint frame*: L turned about its own origin so that the joint's axis is z, so that every joint's
// rotation is one sine and cosine in the first two columns of R_WJ. All constants of a link are in J.
//
// Coordinates: the base's six (velocity of its origin, angular velocity; only when free), then one per link,
// a parent before its children: Featherstone's regular numbering (Rigid Body Dynamics Algorithms, 2008,
// section 4.1). With it the mass matrix has an entry (i, j) only where one of the two is an ancestor of the
// other (his section 6.4, branch-induced sparsity); a row here holds a coordinate's ancestors alone, root
// first, itself last, and all rows stand in one array. Six coordinates of a base are a chain: each is the
// parent of the next.
//
// A coupling adds an entry for its two joints. Where neither is behind the other, the one with the higher number
// has the other's row before its own: rows are then those of the elimination tree (Davis, Direct Methods for
// Sparse Linear Systems, 2006, section 4.1), a superset of the ancestors, and `moving` says which are.
//
// Robots that are alike (links, joints, shapes; not the numbers) are members of one tree, and members are
// what the lanes of a batch hold.
#pragma once
#include "physics/model/scene.hpp"

namespace rdm {

// What all members of a tree have in common, per link.
struct TreeLink {
  int32_t parent = -1;          // link of the tree, -1: the base
  int32_t coupled_to = -1;      // link whose angle a coupled joint follows
  int32_t coupling_entry = -1;  // of the two joints in the mass matrix
  bool prismatic = false;
  bool aligned = false;    // J is not turned against the parent's J at q = 0
  bool isotropic = false;  // the moments are the same about every axis
  bool massless = false;   // neither mass nor moments
  bool sensor = false;
  bool weightless = false;
};

// What differs from member to member, per link.
struct MemberLink {
  Mat3 R_PJ;        // at q = 0; the parent's joint frame, or the base
  Vec3 p_PJ;        // m
  Mat3 R_LJ;        // constant rotation to the link frame
  Quat q_PJ, q_LJ;  // the same two rotations; their signs make link quaternions continuous in the coordinates
  Inertia inertia;  // in joint axes
  JointDef joint;
  double limit_stiffness;  // N m/rad (N/m) of the joint's ends
  double limit_weight;     // 1/(kg m2) (1/kg) of soft limits, else 1 (model/inverse_weights.hpp)
  double limit_time;       // s, their damping over their stiffness
};

struct TreeShape {
  Mat3 R_JS;  // in the link's joint frame, or the base's
  Vec3 p_JS;
};

// One articulation of a tree.
struct TreeMember {
  int32_t articulation;
  int32_t first_link, first_shape;  // in the scene's rows
  Inertia base;                     // of a free base
  Vec3 gravity;                     // m/s2; 0 where the robot does not feel it
  double base_damping;              // 1/s
  Vector<MemberLink> links;         // [num_links]
  Vector<TreeShape> shapes;
};

// A coordinate's place in the vector `sum` that contacts act on (contact_solver.inl): slot of a
// segment. Segments are runs of a path without a branch, at most kSegment long: one vector register or two.
inline constexpr int kSegment = 8;
struct TreeSlot {
  int16_t segment, slot;
};

// A coordinate that another is an ancestor of, and where its row begins.
struct TreeBelow {
  int32_t coord, row;
};

// Articulations with the same links, joints and shapes in the same places: lanes of one computation.
struct Tree {
  bool free_base = false;
  bool looks_ahead = false;  // look_ahead.inl
  int32_t num_links = 0, num_coords = 0;
  Vector<TreeLink> links;
  Vector<int32_t> coupled;  // those of them that are coupled to another
  Vector<TreeMember> members;
  // Shape i of a member is shape first_shape + i of the scene.
  Vector<int32_t> shape_links;    // -1: the base
  Vector<uint8_t> shape_slender;  // capsules: their bounds have an axis

  Vector<int32_t> row;          // [num_coords]: where a coordinate's row begins in `path` and in the matrix
  Vector<int32_t> depth;        // [num_coords]: coordinates before it in its row
  Vector<int16_t> path;         // all rows: those coordinates' indices and its own
  Vector<uint8_t> moving;       // as `path`: 1: it moves the row's link; 0: there for a coupling's sake
  Vector<int32_t> first_below;  // [num_coords + 1]: where a coordinate's descendants begin in `below`
  Vector<TreeBelow> below;      // of each coordinate the last first
  Vector<TreeSlot> slots;
  int32_t num_segments = 0;
  int32_t path_segments = 0;  // most segments on one path

  int32_t coord(int32_t link) const { return link + (free_base ? 6 : 0); }
};

// A link's inertia in axes rotated by R_LJ; an isotropic one keeps its very numbers.
Inertia in_joint_axes(const Inertia& inertia, const Mat3& R_LJ);

// Every articulation of the scene, in order of first appearance. Error(kUnsupported): more than kMaxCoords.
Vector<Tree> make_trees(const Scene& scene);

}  // namespace rdm
