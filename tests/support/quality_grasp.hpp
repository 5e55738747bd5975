// Experiments with a ball in the right hand: at rest in a cup, thrown by the wrist, squeezed hard.
#pragma once
#include "quality_hands.hpp"

namespace rdm::test {

inline constexpr Vec3 kOverPalm = {0, -0.36, 0.56};  // m, from where the ball falls into the closing hand
inline constexpr double kLost = 0.45;                // m: a ball below has left the hand

inline void drop_ball(Rig& rig, const Vec3& offset) {
  rig->set_body(0, {{kOverPalm + offset, {}}, {}, {}});
}

// A ball falls into the hand that closes to a cup, and stays.
struct Rest {
  double sag = 0;     // of the wrist under the ball after 2 s, rad
  double jitter = 0;  // rms speed of the ball over the third second, m/s
  double drift = 0;   // way of the ball over the next 5 s, m
};
inline Rest rest(const Column& column, double ball_mass) {
  Rig rig(hands_def(column, true, ball_mass), column);
  target_all(rig, kCup);
  drop_ball(rig, {0, 0.01, 0});
  rig.ticks(120);
  Rest out;
  out.sag = rig.checked(rig->q()[kWristLink] - rig->target()[kWristLink]);
  double sum = 0;
  const int watched = 60;
  for (int k = 0; k < watched; ++k) {
    rig.tick([] {});
    sum += dot(rig->body(0).v, rig->body(0).v) / watched;
  }
  out.jitter = rig.checked(std::sqrt(sum));
  const Vec3 before = rig->body(0).X.p;
  rig.ticks(300);
  out.drift = rig.checked(norm(rig->body(0).X.p - before));
  return out;
}

// The wrist swings up (every second time down) with the ball in the cup; 16 starts.
struct Throw {
  static constexpr int kStarts = 16;
  double speed[kStarts];  // largest speed of the ball in the first 14 control steps of the swing, m/s
  double apex[kStarts];   // highest place of the ball, m
  double wrist_rate = 0;  // rad/s, largest
};
inline Throw throw_ball(const Column& column) {
  Throw out;
  for (int start = 0; start < Throw::kStarts; ++start) {
    Rig rig(hands_def(column, true), column);
    Stream random(5, static_cast<uint32_t>(start), Purpose::kTest);
    const double x = 0.005 * random.signed_unit(), y = 0.01 + 0.005 * random.signed_unit();
    target_all(rig, kCup);
    drop_ball(rig, {x, y, 0});
    rig.ticks(45);
    const JointDef& wrist = rig.scene().link(kWristLink).joint;
    const bool up = start % 2 == 0;
    rig->target()[kWristLink] = up ? wrist.lower : wrist.upper;
    rig.ticks(15);
    rig->target()[kWristLink] = up ? wrist.upper : wrist.lower;
    double speed = 0, apex = 0;
    for (int k = 0; k < 40; ++k) {
      rig.tick([] {});
      if (k < 14) speed = std::max(speed, norm(rig->body(0).v));
      apex = std::max(apex, rig->body(0).X.p.z);
      out.wrist_rate = std::max(out.wrist_rate, std::fabs(rig->qd()[kWristLink]));
    }
    out.speed[start] = rig.checked(speed);
    out.apex[start] = rig.checked(apex);
  }
  return out;
}

// The fingers close on the ball much further than it lets them, with a new random share ten times a second.
struct Squeeze {
  std::vector<double> depth;  // of the ball's deepest overlap after each control step, m
  int held = 0, starts = 0;
  double ball_speed = 0, joint_rate = 0;  // largest, m/s and rad/s
  double contacts = 0;                    // mean
};
inline void squeeze_targets(Rig& rig, Stream& random) {
  for (int32_t hand = 0; hand < num_hands(rig); ++hand) {
    double share[kHandLinks];
    for (int i = 0; i < kHandLinks; ++i) {
      share[i] = kCup[i];
      // Flexing joints: proximal and middle of the four fingers, thumb to the palm.
      for (const int first : {3, 7, 11, 16})
        if (i == first || i == first + 1) share[i] = 0.85;
      if (i == 20) share[i] = 0.6;
      if (i == 23) share[i] = 0.2;
      if (i > kWristLink) share[i] += 0.075 * random.signed_unit();
      share[i] = std::clamp(share[i], 0.0, 1.0);
    }
    target_share(*rig, hand, share);
  }
}
inline Squeeze squeeze(const Column& column, int starts) {
  Squeeze out;
  out.starts = starts;
  int64_t contacts = 0, watched = 0;
  for (int start = 0; start < starts; ++start) {
    Rig rig(hands_def(column, true), column);
    Stream random(6, static_cast<uint32_t>(start), Purpose::kTest);
    const double x = 0.01 * random.signed_unit(), y = 0.01 + 0.01 * random.signed_unit();
    target_all(rig, kCup);
    drop_ball(rig, {x, y, 0});
    rig.ticks(60);
    for (int k = 0; k < 300; ++k) {
      if (k % 6 == 0) squeeze_targets(rig, random);
      rig.tick([] {});
      contacts += rig->num_contacts();
      ++watched;
      for (int32_t i = 0; i < kHandLinks; ++i)
        out.joint_rate = std::max(out.joint_rate, std::fabs(rig->qd()[i]));
      if (rig->body(0).X.p.z < kLost) continue;
      out.depth.push_back(rig.checked(rig->body_overlap(0)));
      out.ball_speed = std::max(out.ball_speed, norm(rig->body(0).v));
    }
    out.held += !rig.diverged() && rig->body(0).X.p.z > kLost;
  }
  out.contacts = static_cast<double>(contacts) / static_cast<double>(watched);
  return out;
}

}  // namespace rdm::test
