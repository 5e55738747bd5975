// Experiments on bare hands: loads, fast motions, joint limits, free swing, and two flung hands that collide.
#pragma once
#include "quality.hpp"

namespace rdm::test {

// Links, and joints, of a Shadow Hand.
inline constexpr int32_t kWristLink = 1, kProximalLink = 3, kMiddleLink = 4, kDistalLink = 5, kHandLinks = 24;
inline constexpr int32_t kWatched[4] = {kWristLink, kProximalLink, kMiddleLink, kDistalLink};

// Two hands and perhaps a ball; the reference does without the left hand, which has no part in what is
// measured and would take half of its time.
inline SceneDef hands_def(const Column& column, bool ball, double ball_mass = 0.05) {
  TwoHands config;
  config.ball = ball;
  config.ball_mass = ball_mass;
  SceneDef def = two_hands_def(config);
  if (column.reference) def.articulations.pop_back();
  return def;
}
inline void without_contacts(SceneDef* def) {
  for (ArticulationDef& a : def->articulations) a.self_pairs.clear();
}
inline int32_t num_hands(const Rig& rig) {
  return static_cast<int32_t>(rig.scene().def.articulations.size());
}
inline void target_all(Rig& rig, const double* share) {
  for (int32_t hand = 0; hand < num_hands(rig); ++hand) target_share(*rig, hand, share);
}
// How far the worst joint of the right hand, from link `first` to `last`, is beyond its range, rad.
inline double violation(Rig& rig, int32_t first, int32_t last) {
  double worst = 0;
  for (int32_t i = first; i <= last; ++i) {
    const JointDef& joint = rig.scene().link(i).joint;
    worst = std::max({worst, joint.lower - rig->q()[i], rig->q()[i] - joint.upper});
  }
  return worst;
}

// Deflections under 0.3 N down on the first fingertip and 1 N down on the palm of a cupped hand that starts
// in balance, rad. Couplings have no slack, so that each joint has one place to be.
struct Sag {
  double joint[4];  // kWatched
};
inline Sag sag(const Column& column, bool coupled = true) {
  SceneDef def = hands_def(column, false);
  without_contacts(&def);
  if (!coupled) uncouple(&def);
  for (ArticulationDef& a : def.articulations)
    for (LinkDef& link : a.links) link.joint.slack = 0;
  Rig rig(def, column);
  target_all(rig, kCup);
  double q[kHandLinks];
  const double still[kHandLinks] = {};
  for (int32_t i = 0; i < kHandLinks; ++i) {
    const JointDef& joint = rig.scene().link(i).joint;
    q[i] = joint.coupled_to < 0 ? rig->target()[i]
                                : std::clamp(joint.ratio * q[joint.coupled_to], joint.lower, joint.upper);
  }
  for (int32_t hand = 0; hand < num_hands(rig); ++hand) rig->set_joints(hand, q, still);
  for (int k = 0; k < 90; ++k)
    rig.tick([&] {
      rig->push_link(kDistalLink, {0, 0, -0.3}, rig->link(kDistalLink).X * Vec3{0, 0, 0.024});
      rig->push_link(kWristLink, {0, 0, -1}, rig->link(kWristLink).X * Vec3{0.006, 0, 0.066});
    });
  Sag out;
  for (int i = 0; i < 4; ++i) out.joint[i] = rig.checked(rig->q()[kWatched[i]] - q[kWatched[i]]);
  return out;
}

// Wrist thrown from one end of its range to the other while all fingers close.
struct Flick {
  static constexpr int kTicks = 30;
  double angle[kTicks][4];                 // kWatched, rad
  double wrist_rate = 0, finger_rate = 0;  // peaks at the ends of control steps, wrist and proximal, rad/s
};
inline Flick flick(const Column& column, bool coupled = true) {
  SceneDef def = hands_def(column, false);
  without_contacts(&def);
  if (!coupled) uncouple(&def);
  Rig rig(def, column);
  double q[kHandLinks] = {};
  const double still[kHandLinks] = {};
  q[kWristLink] = rig.scene().link(kWristLink).joint.lower;
  rig->set_joints(0, q, still);
  for (int32_t i = kWristLink; i < kHandLinks; ++i) rig->target()[i] = rig.scene().link(i).joint.upper;
  Flick out;
  for (auto& angle : out.angle) {
    rig.tick([] {});
    for (int i = 0; i < 4; ++i) angle[i] = rig.checked(rig->q()[kWatched[i]]);
    out.wrist_rate = std::max(out.wrist_rate, std::fabs(rig->qd()[kWristLink]));
    out.finger_rate = std::max(out.finger_rate, std::fabs(rig->qd()[kProximalLink]));
  }
  return out;
}

// A straight finger is bent back by 2 N at its tip; and a ball of 0.2 kg falls on straight fingers at 1 m/s.
struct Limits {
  double worst = 0;   // rad beyond a limit of the finger, while pushed
  double steady = 0;  // the same, after a second
  double wrist = 0;   // rad, wrist angle in the end: what the finger hands on
  double impact = 0;  // rad beyond any limit after the ball's fall
};
inline Limits limits(const Column& column) {
  Limits out;
  SceneDef def = hands_def(column, false);
  without_contacts(&def);
  Rig bent(def, column);
  for (int k = 0; k < 60; ++k) {
    bent.tick([&] {
      const Pose& X = bent->link(kDistalLink).X;
      bent->push_link(kDistalLink, rotate(X.q, {0, 2, 0}), X * Vec3{0, 0, 0.024});
    });
    out.steady = violation(bent, kProximalLink - 1, kDistalLink);
    out.worst = std::max(out.worst, out.steady);
  }
  out.wrist = bent.checked(bent->q()[kWristLink]);
  Rig hit(hands_def(column, true, 0.2), column);
  hit->set_body(0, {{{0, -0.44, 0.60}, {}}, {0, 0, -1}, {}});
  for (int k = 0; k < 40; ++k) {
    hit.tick([] {});
    out.impact = std::max(out.impact, violation(hit, 0, kHandLinks - 1));
  }
  out.impact = hit.checked(out.impact);
  return out;
}

// Both hands fall from mid range with rates of up to 2 rad/s: no drives, limits, friction, or contacts.
struct Swing {
  static constexpr int kMarks = 3;
  double gain[kMarks];               // energy won since the start, J, after 0.25, 0.5, and 1 s
  double kinetic = 0;                // J, after 1 s
  double angle[kMarks][kHandLinks];  // of the right hand, rad
};
inline Swing swing(const Column& column) {
  TwoHands config;
  config.ball = false;
  SceneDef def = two_hands_def(config);
  without_contacts(&def);
  for (ArticulationDef& a : def.articulations) {
    a.gravity = true;
    for (LinkDef& link : a.links) {
      JointDef& joint = link.joint;
      joint.kp = joint.kd = joint.effort = joint.friction = 0;
      joint.coupled_to = -1;
    }
  }
  SceneDef free = def;
  for (ArticulationDef& a : free.articulations)
    for (LinkDef& link : a.links) link.joint.lower = -1e4, link.joint.upper = 1e4;
  Rig rig(free, column);
  Stream random(5, 0, Purpose::kTest);
  for (int32_t hand = 0; hand < 2; ++hand) {
    double q[kHandLinks], qd[kHandLinks];
    for (int i = 0; i < kHandLinks; ++i) {
      const JointDef& joint =
          def.articulations[static_cast<size_t>(hand)].links[static_cast<size_t>(i)].joint;
      q[i] = 0.5 * (joint.lower + joint.upper);
      qd[i] = 2 * random.signed_unit();
    }
    rig->set_joints(hand, q, qd);
  }
  Swing out;
  const auto energy = [&] {
    out.kinetic = 0;
    double sum = 0;
    for (int32_t hand = 0; hand < 2; ++hand) {
      const Momentum m = momentum(*rig, hand);
      out.kinetic += m.kinetic;
      sum += m.kinetic + m.mass * kGravity * m.height;
    }
    return sum;
  };
  const double start = energy();
  const int marks[Swing::kMarks] = {15, 30, 60};
  int tick = 0;
  for (int k = 0; k < Swing::kMarks; ++k) {
    for (; tick < marks[k]; ++tick) rig.tick([] {});
    out.gain[k] = rig.checked(energy() - start);
    std::copy(rig->q(), rig->q() + kHandLinks, out.angle[k]);
  }
  return out;
}

// Two hands on free bases, fingers ahead, no gravity: flung at each other, they collide and part.
struct Crash {
  double linear = 0;   // change of the momentum of both, share of the sum of their amounts before
  double angular = 0;  // the same of the angular momentum about their mass centre
  double kinetic = 0;  // kinetic energy after, share of that before: at most 1
  int touching = 0;    // control steps with contacts between the hands
};
inline Crash crash(const Column& column) {
  TwoHands config;
  config.ball = false;
  config.hand_hand = true;
  SceneDef def = two_hands_def(config);
  def.statics.clear();
  def.gravity = {};
  def.solver.contacts_max = 96;
  for (ArticulationDef& a : def.articulations) a.free_base = true;
  def.articulations[1].X_WB.p.y -= 0.05;
  Rig rig(def, column);
  rig->set_base(0, {def.articulations[0].X_WB, {0.05, -1, 0}, {0.3, 0.5, -0.2}});
  rig->set_base(1, {def.articulations[1].X_WB, {0, 0.8, 0}, {0.2, -0.6, 0.3}});
  const Momentum before[2] = {momentum(*rig, 0), momentum(*rig, 1)};
  const double mass = before[0].mass + before[1].mass;
  Vec3 center;  // of mass, at the start
  for (int32_t hand = 0; hand < 2; ++hand) {
    const auto& links = def.articulations[static_cast<size_t>(hand)].links;
    const Inertia& base = def.articulations[static_cast<size_t>(hand)].base;
    center += base.mass / mass * (rig->base(hand).X * base.com);
    for (int32_t i = 0; i < kHandLinks; ++i) {
      const Inertia& inertia = links[static_cast<size_t>(i)].inertia;
      center += inertia.mass / mass * (rig->link(hand * kHandLinks + i).X * inertia.com);
    }
  }
  const auto about_center = [&](const Momentum& m) { return m.angular - cross(center, m.linear); };
  Crash out;
  for (int k = 0; k < 60; ++k) {
    rig.tick([] {});
    bool touching = false;
    for (int32_t i = 0; i < rig->num_contacts(); ++i) {
      const Contact& c = rig->contacts()[i];
      const auto& shapes = rig.scene().shapes;
      touching |= shapes[static_cast<size_t>(c.shape_a)].articulation !=
                  shapes[static_cast<size_t>(c.shape_b)].articulation;
    }
    out.touching += touching;
  }
  const Momentum after[2] = {momentum(*rig, 0), momentum(*rig, 1)};
  const Vec3 p = after[0].linear + after[1].linear - before[0].linear - before[1].linear;
  const Vec3 l =
      about_center(after[0]) + about_center(after[1]) - about_center(before[0]) - about_center(before[1]);
  out.linear = rig.checked(norm(p) / (norm(before[0].linear) + norm(before[1].linear)));
  out.angular = rig.checked(norm(l) / (norm(about_center(before[0])) + norm(about_center(before[1]))));
  out.kinetic = rig.checked((after[0].kinetic + after[1].kinetic) / (before[0].kinetic + before[1].kinetic));
  return out;
}

}  // namespace rdm::test
