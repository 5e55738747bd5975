// How right an engine of lib/physics is: the columns of the quality table, and the rig that steps a scene as
// one of them says. The experiments, one function each, are in quality_hands.hpp, quality_grasp.hpp,
// quality_bodies.hpp and quality_towers.hpp.
#pragma once
#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <ostream>
#include <utility>
#include <vector>

#include "base/fpmode.hpp"
#include "base/rng.hpp"
#include "physics/model/inertia.hpp"
#include "two_hands.hpp"

namespace rdm::test {

inline constexpr double kTick = 1.0 / 60;  // s, the control step of every experiment
inline constexpr double kGravity = 9.81;   // m/s2, along -z

struct Column {
  const char* name;
  EngineKind engine = EngineKind::kOde;
  SolverDef solver;
  int32_t steps = 1;       // World::step calls per control step
  bool reference = false;  // moves by the mechanics of the scene alone, see Rig
};
inline void PrintTo(const Column& column, std::ostream* out) {  // for googletest
  *out << column.name;
}

// Engine ode's couplings are one-way, engine articulated's act back: beside each other hands go without.
inline void uncouple(SceneDef* def) {
  for (ArticulationDef& a : def->articulations)
    for (LinkDef& link : a.links) link.joint.coupled_to = -1;
}

// Engine ode with the exact solver in small steps. The clamp beyond the joint limits is set out of reach: it
// stands in for the limit spring where steps are too long for it.
inline Column reference_column() {
  Column c{"reference", EngineKind::kOde, {}, 80, true};
  c.solver.exact = true;
  c.solver.h = 1.0 / 4800;
  c.solver.substeps = 1;
  c.solver.link_armature = 0;
  c.solver.limit_margin = 0.1;
  return c;
}
inline Column exact_column() {
  Column c{"exact_120", EngineKind::kOde, {}, 1, false};
  c.solver.exact = true;
  c.solver.link_armature = 0;
  return c;
}
inline Column quickstep_column() {
  return {"quickstep", EngineKind::kOde, {}, 1, false};
}
inline Column articulated_column() {
  return {"articulated", EngineKind::kArticulated, {}, 1, false};
}
inline Column double_column() {
  Column c{"articulated_double", EngineKind::kArticulated, {}, 1, false};
  c.solver.double_precision = true;
  return c;
}
inline std::vector<Column> all_columns() {
  return {reference_column(), exact_column(), quickstep_column(), articulated_column(), double_column()};
}

inline double thread_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

inline double square(double x) {
  return x * x;
}
// The value below which `share` of all lie; NaN of none.
inline double quantile(std::vector<double> v, double share) {
  if (v.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(v.begin(), v.end());
  return v[std::min(v.size() - 1, static_cast<size_t>(share * static_cast<double>(v.size())))];
}

// What a robot carries. `angular` is about the world's origin; `height` of its mass centre.
struct Momentum {
  double mass = 0, kinetic = 0, height = 0;
  Vec3 linear, angular;
};
inline void add_momentum(const Inertia& inertia, const Motion& m, Momentum* sum) {
  if (inertia.mass <= 0) return;
  const Mat3 R = to_matrix(m.X.q);
  const Vec3 arm = R * inertia.com, c = m.X.p + arm, v = m.v + cross(m.w, arm);
  const Vec3 spin = R * (moment_matrix(inertia) * (transpose(R) * m.w));
  sum->height = (sum->mass * sum->height + inertia.mass * c.z) / (sum->mass + inertia.mass);
  sum->mass += inertia.mass;
  sum->kinetic += 0.5 * (inertia.mass * dot(v, v) + dot(spin, m.w));
  sum->linear += inertia.mass * v;
  sum->angular += cross(c, inertia.mass * v) + spin;
}
inline Momentum momentum(const World& world, int32_t articulation) {
  const auto a = static_cast<size_t>(articulation);
  const ArticulationDef& def = world.scene().def.articulations[a];
  Momentum sum;
  if (def.free_base) add_momentum(def.base, world.base(articulation), &sum);
  const int32_t first = world.scene().link_offset[a];
  for (int32_t i = 0; i < static_cast<int32_t>(def.links.size()); ++i)
    add_momentum(world.scene().link(first + i).inertia, world.link(first + i), &sum);
  return sum;
}

// A scene in one column's hands.
//
// Engine ode differs from the mechanics of the scene in two ways besides its solver: light links between two
// crossed axes are lumped into the next one, and small links get an armature. The reference has neither.
class Rig {
 public:
  Rig(SceneDef def, const Column& column)
      : column_(column), sim_(prepared(std::move(def), column), column.engine) {}
  World* operator->() { return &*sim_; }
  World& operator*() { return *sim_; }
  const Scene& scene() const { return sim_.scene(); }

  // One control step. `before` runs before each World::step, for pushes last no longer than that.
  template <class F>
  void tick(F&& before) {
    for (int32_t i = 0; i < column_.steps; ++i) {
      before();
      sim_->step();
      status_ |= sim_->status();
    }
  }
  void ticks(int count) {
    for (int i = 0; i < count; ++i) tick([] {});
  }
  bool diverged() const { return (status_ & kStatusDiverged) != 0; }
  bool overflowed() const { return (status_ & kStatusContactOverflow) != 0; }
  // x, or NaN from the moment on that the engine has given up.
  double checked(double x) const { return diverged() ? std::numeric_limits<double>::quiet_NaN() : x; }

 private:
  // The scene's own cap of contacts stays.
  static SceneDef prepared(SceneDef def, const Column& column) {
    const int32_t contacts_max = def.solver.contacts_max;
    def.solver = column.solver;
    def.solver.contacts_max = contacts_max;
    if (!column.reference) return def;
    for (ArticulationDef& a : def.articulations)
      for (size_t i = 0; i < a.links.size(); ++i) {
        ArticulationShape speck;  // a link with a shape of its own is never lumped
        speck.link = static_cast<int32_t>(i);
        speck.shape.size = {1e-4, 0, 0};
        speck.shape.collides = false;
        a.shapes.push_back(speck);
      }
    return def;
  }

  FpMode mode_;
  Column column_;
  Simulation sim_;
  uint32_t status_ = 0;  // of all steps so far
};

}  // namespace rdm::test
