// Experiments with many contacts: a stack of boxes, and a tower of blocks from which one is pulled.
#pragma once
#include "quality_bodies.hpp"

namespace rdm::test {

// How a pile of bodies behaves while watched. Depths are those of the poses after each control step.
struct Pile {
  double motion = 0;        // m, largest way of a body from where it was after half a second
  double speed = 0;         // m/s, rms over bodies and control steps
  double depth = 0;         // m, deepest overlap
  double contacts = 0;      // mean of a control step's last substep
  double microseconds = 0;  // of the thread, per substep
  bool overflow = false;    // contacts were left out
};
inline Pile watch(Rig& rig, int ticks) {
  Pile out;
  const int32_t bodies = rig.scene().num_bodies;
  std::vector<Vec3> start;
  for (int32_t i = 0; i < bodies; ++i) start.push_back(rig->body(i).X.p);
  double squares = 0, seconds = 0;
  for (int k = 0; k < ticks; ++k) {
    const double before = thread_seconds();
    rig.tick([] {});
    seconds += thread_seconds() - before;
    out.contacts += static_cast<double>(rig->num_contacts()) / ticks;
    for (int32_t i = 0; i < bodies; ++i) {
      const Motion& m = rig->body(i);
      out.motion = std::max(out.motion, norm(m.X.p - start[static_cast<size_t>(i)]));
      squares += dot(m.v, m.v) / bodies / ticks;
      out.depth = std::max(out.depth, rig->body_overlap(i));
    }
  }
  out.overflow = rig.overflowed();
  out.motion = rig.checked(out.motion);
  out.speed = rig.checked(std::sqrt(squares));
  const double substeps = kTick / rig.scene().def.solver.h * ticks;
  out.microseconds = 1e6 * seconds / substeps;
  return out;
}

// Boxes, 0.1 m and 0.4 kg each, one upon the other, for ten seconds. Not for ODE's exact solver: from the
// third box on its pivoting gives up ("s <= 0") and the stack flies apart; a tower is no better.
inline Pile stack(const Column& column, int boxes) {
  SceneDef def;
  const double half = 0.05;
  for (int i = 0; i < boxes; ++i)
    def.bodies.push_back(make_box(0.4, {half, half, half}, {{0, 0, half * (2 * i + 1)}, {}}));
  def.statics.push_back(make_plane());
  def.solver.contacts_max = 128;
  Rig rig(def, column);
  rig.ticks(30);
  return watch(rig, 600);
}

// A Jenga tower: 20 pine blocks, three to a layer, crossed from layer to layer, friction 0.2. After 250
// control steps the middle block of the third layer is taken away (the tower must stand), and later a side
// block of the same layer (it must fall).
struct Jenga {
  Pile standing;
  double after_middle = 0;  // m, how far the highest block sinks within a second
  double after_side = 0;    // m, within two seconds more
};
inline constexpr int kBlocks = 20;
inline SceneDef jenga_def() {
  SceneDef def;
  const Vec3 half = {0.0375, 0.0125, 0.0075};
  const double pitch = 2 * half.y + 2e-4;
  for (int i = 0; i < kBlocks; ++i) {
    const int layer = i / 3;
    const double y = (i % 3 - 1) * pitch, z = half.z * (2 * layer + 1);
    const bool crossed = layer % 2 != 0;
    const Quat q = crossed ? axis_angle({0, 0, 1}, 0.5 * kPi) : Quat{};
    def.bodies.push_back(make_box(0.020, half, {{crossed ? y : 0, crossed ? 0 : y, z}, q}));
  }
  def.statics.push_back(make_plane());
  def.friction[0][0].mu = 0.2;
  def.solver.contacts_max = 256;
  return def;
}
inline Jenga jenga(const Column& column) {
  Rig rig(jenga_def(), column);
  rig.ticks(30);
  Jenga out;
  out.standing = watch(rig, 250);
  const int32_t top = kBlocks - 1;
  double height = rig->body(top).X.p.z;
  const auto pull = [&](int32_t block, int ticks) {
    rig->set_body(block, {{{0.5 + 0.1 * block, 0, 0.0075}, {}}, {}, {}});
    rig.ticks(ticks);
    const double before = std::exchange(height, rig->body(top).X.p.z);
    return rig.checked(before - height);
  };
  out.after_middle = pull(7, 60);
  out.after_side = pull(6, 120);
  return out;
}

}  // namespace rdm::test
