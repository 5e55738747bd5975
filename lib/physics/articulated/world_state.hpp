// What a step of the articulated engine works on: the constant model of a scene and one world's data (as
// MuJoCo parts mjModel and mjData), and the parts of a substep that are arithmetic in double on one world,
// whatever the lanes: free bodies, contact points, the impulses that the next solve starts from.
//
// A free body has mass m, inertia I about its centre of mass, and no coordinates but pose and velocity:
//   predict    v = keep v + gain h (g + f/m), w alike with R I^-1 R^T torque            without contacts
//   contacts   v1, w1: what the solver makes of them, with the masses m / gain
//   integrate  with a contact point p += h v1, q <- exp(h w1) q; without one p += h (gain v + fall h (g + f/m)),
//              q <- exp(h w_m) q with the rate w_m of the middle; then w <- R' I^-1 R'^T L, L = R I R^T w1 of
//              the old pose: a body that spins freely keeps its angular momentum L, not its angular velocity.
// keep, gain and fall are those of damping over a substep (model/flow.hpp): a flight is exact at any substep.
// R rotates the body's axes into world axes.
#pragma once
#include <cmath>
#include <cstdint>

#include "physics/articulated/tree.hpp"
#include "physics/collision/narrowphase.hpp"
#include "physics/model/flow.hpp"
#include "physics/world.hpp"

namespace rdm {

// Constants of a free body.
struct BodyModel {
  double inv_mass, sqrt_inv_mass;  // 1/m; root of gain / m
  Mat3 moment;                     // I, body axes, kg m2
  Mat3 inv_moment;                 // I^-1
  Mat3 inv_sqrt_moment;            // C^-1, where I / gain = C C^T (Cholesky)
  Flow linear, angular;            // of damping
  Vec3 gravity;                    // m/s2
};

// A pair of a run without an articulation: which body each shape is on.
struct ListedPair {
  static constexpr int32_t kStatic = -1, kArticulation = -2;
  int32_t pair, a, b;
};

// Made once for all worlds of a worker and only read afterwards.
struct ArticulatedModel {
  const Scene* scene = nullptr;
  Vector<Tree> trees;
  Vector<BodyModel> bodies;  // [num_bodies]
  // where bodies fall asleep (sleep.hpp)
  int32_t sleep_substeps = 0;  // so long they are quiet before; 0: never
  Vector<ListedPair> listed_pairs;
  bool all_listed = false;         // those are all pairs
  Vector<double> inverse_weights;  // [shapes] 1/kg (model/inverse_weights.hpp); empty: no contact is soft
};
ArticulatedModel make_articulated_model(const Scene& scene);

// The constants of a link and of an articulation that a world may have of its own (model/dynamics.hpp), as V:
// one number per lane, or a plain number as an adjustable world stores it. In joint axes. Masses and moments of a
// robot whose base is damped are over the damping's gain (model/flow.hpp): that is what all forces meet.
template <class V>
struct LinkConstants {
  V mass, moment[6], kp, kd, effort, friction, armature;
};
template <class V>
struct BaseConstants {
  V gravity[3], linear_damping, angular_damping;  // times the damping's gain; what it keeps, 1 without
  V base_mass, base_moment[6];                    // of a free base, over the gain
};
inline constexpr size_t kLinkConstants = sizeof(LinkConstants<float>) / sizeof(float),
                        kBaseConstants = sizeof(BaseConstants<float>) / sizeof(float);
static_assert(kLinkConstants == 12 && kBaseConstants == 12, "three registers of four");

// Where those of an articulation begin in WorldState::constants, in numbers; past the last, how many there
// are.
inline size_t first_constant(const Scene& scene, int32_t articulation) {
  const auto a = static_cast<size_t>(articulation);
  const int32_t link = a < scene.link_offset.size() ? scene.link_offset[a] : scene.num_links;
  return kBaseConstants * a + kLinkConstants * static_cast<size_t>(link);
}

// Of one articulation: the scene's (no dynamics), or those with a world's factors on them.
BaseConstants<double> base_constants(const ArticulatedModel& model, const TreeMember& member,
                                     const Dynamics* dynamics);
LinkConstants<double> link_constants(const ArticulatedModel& model, const TreeMember& member, int32_t link,
                                     const Dynamics* dynamics);
// Of a free body.
BodyModel body_model(const Scene& scene, int32_t body, const Dynamics* dynamics);

// State of a link and of a base that lasts from step to step beside the joint coordinates, as V: one number
// per lane, or a plain number as a world stores it. Velocities are in world axes, relative places from the
// base's origin. `saturated` and `limited` are the active set of the drives and joint limits: -1 at the lower
// end, 0 not in it, 1 at the upper end.
template <class V>
struct PersistentLink {
  V R[9], P[3], w[3], v[3];  // R_WJ, origin, angular velocity, velocity of the origin
  V linear[3], angular[3];   // velocity of the centre of mass, angular momentum about it, as last solved
  V saturated, limited;
  V q[4];  // q_WJ, w first; of the end of the control step
};
template <class V>
struct PersistentBase {
  V linear[3], angular[3];
};
inline constexpr size_t kLinkWords = sizeof(PersistentLink<float>) / sizeof(float),
                        kBaseWords = sizeof(PersistentBase<float>) / sizeof(float);
static_assert(kLinkWords == 30 && kBaseWords == 6, "saved states hold these");
static_assert(sizeof(PersistentLink<double>) == kLinkWords * sizeof(double) &&
              sizeof(PersistentBase<double>) == kBaseWords * sizeof(double));

// A free body within a substep.
struct FreeBody {
  Mat3 R, inv_sqrt_inertia;  // R_WB; C^-1 R^T: the factor Z of contact_solver.inl for torques
  Vec3 v, w;                 // predicted, without contacts
  Vec3 v1, w1;               // with them
  Vec3 way;                  // mean velocity of the substep, without contacts
  bool touches;              // has a contact point in this substep
};

// A contact's impulse on shape a, from which the next substep's solve starts.
struct WarmPoint {
  int32_t pair;      // index of Scene::pairs
  float p[3];        // from the bound's centre of shape a, world axes, m
  float impulse[3];  // world, N s
};

// Where two things touch that both sleep; its pair and impulse stand beside it.
struct KeptPoint {
  Vec3 p, n;     // as Contact's
  double depth;  // m
};

// Whether a body sleeps (sleep.hpp).
struct BodySleep {
  int32_t island;  // the lowest body of those it sleeps with; kAwake
  int32_t quiet;   // substeps in a row, up to those after which it may sleep
};
inline constexpr int32_t kAwake = -1;

// One world's data. The arrays belong to the world.
struct WorldState {
  // what lasts
  double *q, *qd;    // [num_links] rad, rad/s (m, m/s)
  Motion* bases;     // [articulations]
  Mat3* base_R;      // [articulations] R_WB
  Motion* bodies;    // [num_bodies]
  void* persistent;  // [articulations]: PersistentBase, then PersistentLink per link; float or double
  WarmPoint* warm;  // [contacts_max], num_warm: of the last substep; from find_contacts on those of this one,
                    // with the impulses that its solve starts from
  int32_t num_warm;
  BodySleep* sleep;  // [num_bodies]; null, and all of sleep below: no body ever falls asleep

  // what it has of its own; null where all is the scene's
  const Dynamics* dynamics;
  void* constants;          // [articulations]: BaseConstants, then LinkConstants per link; float or double
  const SizedShape* sized;  // [num_body_shapes]
  const BodyModel* body_models;  // [num_bodies], the scene's or its own

  // what is done to it
  double* target;       // [num_links]
  double* feedforward;  // [num_links]; null: none
  Wrench* pushes;       // [num_links + articulations + num_bodies] at the centre of mass, world axes
  bool pushed;          // any of them

  // of the substep
  FreeBody* free_bodies;   // [num_bodies]
  Contact* contacts;       // [contacts_max], in the order of the scene's pairs; until contact_forces their
                           // force is the impulse on shape a, N s
  int32_t* contact_pairs;  // [contacts_max] index of Scene::pairs
  int32_t num_contacts;

  // of sleep
  KeptPoint* kept;       // [contacts_max] num_kept points among the sleeping, in the order of their pairs
  int32_t* kept_pairs;   // [contacts_max]
  WarmPoint* kept_warm;  // [contacts_max]
  int32_t num_kept, num_asleep;
  // [listed pairs] num_searched with a side awake, and from the end on num_resting others, each in order
  int32_t* listed;
  int32_t num_searched, num_resting;
  bool lists_fresh;       // lists and kept points are of the present sleepers
  bool only_kept;         // contacts are the kept points, in their places
  Bound* body_bounds;     // [num_body_shapes]
  int32_t* parent;        // [num_bodies] working memory of islands
  uint8_t* island_marks;  // [num_bodies]

  // what comes out of the step
  double* torque;    // [num_links] mean over the substeps
  Motion* links;     // [num_links] where `fresh` is 1; the others are read when somebody asks
  uint8_t* fresh;    // [num_links]
  Wrench* sensors;   // [sensors] mean over the substeps, link axes, about the link's origin
  uint8_t* touched;  // [pairs]
  uint32_t status;
  double residual;  // m/s, of the last solve of the substep: ContactSolver::residual
  bool diverged;    // the step's numbers are not to be used: the world goes back to the poses below
  Motion *start_bodies, *start_bases;  // [num_bodies], [articulations] as the step began

  bool asleep(int32_t body) const { return sleep && sleep[body].island != kAwake; }
  const Wrench* base_pushes(const Scene& scene) const { return pushes + scene.num_links; }
  const Wrench* body_pushes(const Scene& scene) const {
    return base_pushes(scene) + scene.def.articulations.size();
  }
};

// Outputs to zero, the start's poses stored. A target that is not finite marks the world and holds the joint.
void begin_step(const ArticulatedModel& model, WorldState* s);
void predict_bodies(const ArticulatedModel& model, WorldState* s);
// Impulse on shape a that the last substep gave at a point like this one; false: none.
inline bool warm_impulse(const WorldState& s, int32_t contact, Vec3* impulse) {
  const float* found = s.warm[contact].impulse;
  if (std::isnan(found[0])) return false;
  *impulse = {static_cast<double>(found[0]), static_cast<double>(found[1]), static_cast<double>(found[2])};
  return true;
}
void integrate_bodies(const ArticulatedModel& model, WorldState* s);  // by v1, w1

void set_bound(const SceneShape& shape, const Vec3& p, const Mat3& R, Bound* bound);
// A bound that set_bound has set, and its radii, for a shape of another size.
void size_bound(const SceneShape& shape, double factor, Bound* bound);

}  // namespace rdm
