#include "tasks/hand/free_start.hpp"

#include <algorithm>

#include "physics/collision/convex.hpp"
#include "robot/kinematics.hpp"
#include "robot/mounted.hpp"

namespace rdm {
namespace {

constexpr double kRoom = 0.04;                    // m, more is no better
constexpr double kTouch = 0.002;                  // m, of parts of one robot: nearer counts as touching
constexpr double kDeep = 0.002;                   // m, from which a hand stands in a thing and not at it
constexpr double kStep = 0.005, kFarthest = 0.3;  // m, of a hand's way back
constexpr size_t kMostPlaces = 24;                // of each arm, for pairs

Convex solid_of(const Scene& scene, const SceneShape& shape, const Pose& X_WS, double more) {
  Convex c{shape.def.kind, shape.def.size, X_WS.p, to_matrix(X_WS.q), scene.hull_of(shape)};
  if (c.hull || more == 0) return c;
  c.size.x += more;
  if (c.kind == ShapeKind::kCylinder || c.kind == ShapeKind::kBox || c.kind == ShapeKind::kEllipsoid)
    c.size.y += more;
  if (c.kind == ShapeKind::kBox || c.kind == ShapeKind::kEllipsoid) c.size.z += more;
  return c;
}

// The shapes of a scene at its start, and how far they are from each other.
class Room {
 public:
  Room(const HandControlConfig& config, const HandScene& made)
      : scene_(make_scene(static_cast<const SceneDef&>(made))),
        poses_(scene_.shapes.size()),
        things_stand_(config.things_stand),
        count_(config.count) {
    for (size_t i = 0; i < scene_.shapes.size(); ++i) {
      const SceneShape& s = scene_.shapes[i];
      if (s.carrier == Carrier::kStatic) poses_[i] = s.def.X_LS;
      if (s.carrier == Carrier::kBody)
        poses_[i] = scene_.def.bodies[static_cast<size_t>(s.index)].X_WB * s.def.X_LS;
    }
    for (int32_t i = 0; i < config.count; ++i) {
      const ChosenHand& hand = made.hands[i];
      hands_[i] = &hand;
      const Robot& robot = hand.robot();
      const Table<double>& start =
          config.folded && robot.poses.folded.count ? robot.poses.folded : robot.home;
      for (int32_t k = 0; k < robot.links.count; ++k) q_[i][k] = start_angle(robot, start, k);
      follow(robot, q_[i]);
      place(i, hand.X_WB, nullptr);
    }
    for (size_t a = static_cast<size_t>(config.count); a < scene_.def.articulations.size(); ++a)
      put(static_cast<int32_t>(a), scene_.def.articulations[a].X_WB, nullptr);
    for (const ShapePair& pair : scene_.pairs) sort({pair.a, pair.b});
    add_base_pairs();
  }

  // Puts robot i there; q [arm_links] of its arm, null: as before.
  void place(int32_t i, const Pose& X_WB, const double* q) {
    if (q) std::copy_n(q, hands_[i]->robot().arm_links, q_[i]);
    put(i, X_WB, q_[i]);
  }
  // Of the hand alone, without its arm, to anything else; less than 0: that deep.
  double hand_gap(int32_t i, double most) const { return gap(of_hand_[i], most); }
  // Of the arm to anything but the other arm.
  double arm_gap(int32_t i) const { return gap(of_itself_[i], kTouch) < kTouch ? 0 : gap(of_arm_[i], kRoom); }
  double gap_between_arms() const { return gap(of_both_, kRoom); }

 private:
  bool of_arm(const SceneShape& s, int32_t shape) const {
    if (hand_of(s) < 0) return false;
    const ChosenHand& hand = *hands_[s.articulation];
    return hand.armed &&
           shape - scene_.first_shape[static_cast<size_t>(s.articulation)] < hand.arm->shapes.count;
  }
  bool on_flange(const SceneShape& s) const {
    const auto a = static_cast<size_t>(s.articulation);
    const int32_t flange = hands_[a]->robot().flange;
    return s.carrier == Carrier::kLink ? s.index - scene_.link_offset[a] == flange : flange == kRootLink;
  }

  struct Pair {
    int32_t a, b;  // shapes; b may be a plane
  };

  // Joints that others lead, as a reset sets them.
  static void follow(const Robot& robot, double* q) {
    for (const RobotCurve& c : robot.curves) {
      const RobotCurve* own = robot.curve(c.driver);
      const RobotLink& l = robot.links[c.driver];
      q[c.link] = c.at(own ? own->inverse(q[c.driver]) : to_action(l.lower, l.upper, q[c.driver]));
    }
    for (const RobotCoupling& c : robot.couplings)
      q[c.link] = std::clamp(c.ratio * q[c.other], robot.links[c.link].lower, robot.links[c.link].upper);
  }

  // An articulation whose joints are at q, null: 0.
  void put(int32_t articulation, const Pose& X_WB, const double* q) {
    const auto a = static_cast<size_t>(articulation);
    const int32_t first = scene_.link_offset[a];
    links_.resize(scene_.def.articulations[a].links.size());
    for (size_t k = 0; k < links_.size(); ++k) {
      const LinkDef& l = scene_.def.articulations[a].links[k];
      const double angle = q ? q[k] : 0;
      const Pose motion = l.joint.kind == JointKind::kPrismatic ? Pose{angle * l.joint.axis, {}}
                                                                : Pose{{}, axis_angle(l.joint.axis, angle)};
      links_[k] = (l.parent < 0 ? X_WB : links_[static_cast<size_t>(l.parent)]) * l.X_PL * motion;
    }
    for (size_t s = 0; s < scene_.shapes.size(); ++s) {
      const SceneShape& shape = scene_.shapes[s];
      if (shape.articulation != articulation) continue;
      const Pose& X_WL =
          shape.carrier == Carrier::kLink ? links_[static_cast<size_t>(shape.index - first)] : X_WB;
      poses_[s] = X_WL * shape.def.X_LS;
    }
  }

  // Whose hand a shape belongs to, -1: none's, a thing's.
  int32_t hand_of(const SceneShape& s) const { return s.articulation < count_ ? s.articulation : -1; }
  const SceneShape& shape(int32_t i) const { return scene_.shapes[static_cast<size_t>(i)]; }

  void sort(const Pair& pair) {
    const SceneShape &a = shape(pair.a), &b = shape(pair.b);
    const bool arm_a = of_arm(a, pair.a), arm_b = of_arm(b, pair.b);
    if (a.articulation >= 0 && a.articulation == b.articulation) {
      if (hand_of(a) < 0) return;
      // what the flange carries is one piece at the start
      const bool one_piece = (!arm_a || on_flange(a)) && (!arm_b || on_flange(b));
      if (!one_piece) of_itself_[a.articulation].push_back(pair);
    } else if (arm_a && arm_b) {
      of_both_.push_back(pair);
    } else if (arm_a || arm_b) {
      if (!stands_on(a, b)) of_arm_[arm_a ? a.articulation : b.articulation].push_back(pair);
    } else if (things_stand_ || (a.carrier != Carrier::kBody && b.carrier != Carrier::kBody)) {
      for (const SceneShape* s : {&a, &b})
        if (const int32_t hand = hand_of(*s); hand >= 0) of_hand_[hand].push_back(pair);
    }
  }
  // A base, and its first link, which turns above it, on the ground.
  bool stands_on(const SceneShape& a, const SceneShape& b) const {
    return b.def.kind == ShapeKind::kPlane &&
           (a.carrier != Carrier::kLink ||
            a.index == scene_.link_offset[static_cast<size_t>(a.articulation)]);
  }
  // Bases touch nothing that is at rest, but should not stand in it either.
  void add_base_pairs() {
    const auto count = static_cast<int32_t>(scene_.shapes.size());
    for (int32_t a = 0; a < count; ++a) {
      if (shape(a).carrier != Carrier::kBase || !of_arm(shape(a), a)) continue;
      for (int32_t b = 0; b < count; ++b) {
        const bool thing = shape(b).carrier == Carrier::kStatic;
        const bool base = b > a && shape(b).carrier == Carrier::kBase && of_arm(shape(b), b) &&
                          shape(b).articulation != shape(a).articulation;
        if (thing || base) sort({a, b});
      }
    }
  }

  double gap(const Vector<Pair>& pairs, double most) const {
    double least = most;
    for (const Pair& pair : pairs) least = std::min(least, gap(pair, most));
    return least;
  }

  // Shapes that are grown overlap by what their gap is less than `more`.
  double gap(const Pair& pair, double more) const {
    const SceneShape &a = shape(pair.a), &b = shape(pair.b);
    const Pose &X_a = poses_[static_cast<size_t>(pair.a)], &X_b = poses_[static_cast<size_t>(pair.b)];
    if (b.def.kind == ShapeKind::kPlane) {
      const Vec3 n = rotate(X_b.q, {0, 0, 1});
      return std::min(more, dot(n, farthest(solid_of(scene_, a, X_a, 0), -n) - X_b.p));
    }
    const Vec3 d = X_a.p - X_b.p;
    const double reach = a.radius + b.radius + more;
    if (dot(d, d) >= reach * reach) return more;
    const bool grow_a = !scene_.hull_of(a);
    Overlap o;
    if (!find_overlap(solid_of(scene_, a, X_a, grow_a ? more : 0),
                      solid_of(scene_, b, X_b, grow_a ? 0 : more), &o))
      return more;
    return more - o.depth;
  }

  const Scene scene_;
  Vector<Pose> poses_;  // of shapes, in the world
  Vector<Pose> links_;  // of the articulation that is being put somewhere
  const bool things_stand_;
  const int32_t count_;  // of hands, the first articulations
  const ChosenHand* hands_[kMaxHands] = {};
  double q_[kMaxHands][kMaxRobotLinks] = {};
  // Pairs of shapes: of a hand and anything else; of its arm and anything but itself and the other arm; of
  // arm and hand themselves; of the two arms.
  Vector<Pair> of_hand_[kMaxHands], of_arm_[kMaxHands], of_itself_[kMaxHands], of_both_;
};

// The pose of a hand's palm, by which "back" is told.
Quat palm_turn(const ChosenHand& hand) {
  double q[kMaxRobotLinks];
  const Robot& robot = hand.robot();
  for (int32_t k = 0; k < robot.links.count; ++k) q[k] = start_angle(robot, robot.home, k);
  if (hand.armed || hand.side == Side::kRight) return (hand.X_WB * robot.X_BR * palm_frame(robot, q)).q;
  const RobotCopy left = make_mirrored(robot);
  return (hand.X_WB * robot.X_BR * palm_frame(left.robot(), q)).q;
}

// The least way against the fingers, up or away from the palm's front on which hand i comes free; 0 where it
// is free already, or nowhere.
Vec3 way_back(int32_t i, const ChosenHand& hand, Room* room) {
  if (room->hand_gap(i, 0) > -kDeep) return {};
  const Quat turn = palm_turn(hand);
  const Vec3 ways[] = {-rotate(turn, {0, 0, 1}), {0, 0, 1}, rotate(turn, {0, 1, 0})};
  Vec3 found;
  const auto look = [&](const Vec3& way) {
    room->place(i, {hand.X_WB.p + way, hand.X_WB.q}, nullptr);
    if (room->hand_gap(i, kTouch) < kTouch) return false;
    found = way;
    return true;
  };
  for (int k = 1; k * kStep <= kFarthest; ++k)
    for (const Vec3& way : ways)
      if (look(k * kStep * way)) return found;
  room->place(i, hand.X_WB, nullptr);
  return {};
}

struct Placed {
  const ArmPlace* place;
  double value;
};

// Those that are free, the best first; room is left with the arm at the last one it looked at.
Vector<Placed> free_places(const Vector<ArmPlace>& places, int32_t i, Room* room) {
  Vector<Placed> out;
  for (const ArmPlace& place : places) {
    room->place(i, place.X_WB, place.q);
    if (const double gap = room->arm_gap(i); gap > 0) out.push_back({&place, place.score * gap / kRoom});
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Placed& a, const Placed& b) { return a.value > b.value; });
  if (out.size() > kMostPlaces) out.resize(kMostPlaces);
  return out;
}

Vector<ArmPlace> places_of(const ChosenHand& hand, bool wide) {
  if (hand.given) return arm_poses(*hand.arm, hand.X_WF, hand.X_WB);
  return arm_places(*hand.arm, hand.X_WF, hand.from, wide);
}

// True when all arms that may be moved have found a free place.
bool place_arms(const int32_t* arms, int32_t count, bool wide, HandScene* s, Room* room) {
  Vector<ArmPlace> places[kMaxHands];
  Vector<Placed> free[kMaxHands];
  for (int32_t n = 0; n < count; ++n) {
    places[n] = places_of(s->hands[arms[n]], wide);
    free[n] = free_places(places[n], arms[n], room);
    if (free[n].empty()) return false;
  }
  const ArmPlace* best[kMaxHands] = {};
  double most = 0;
  if (count == 1) {
    for (const Placed& a : free[0]) {
      if (a.value <= most) break;
      room->place(arms[0], a.place->X_WB, a.place->q);
      const double gap = room->gap_between_arms();
      if (a.value * gap / kRoom > most) best[0] = a.place, most = a.value * gap / kRoom;
    }
  } else {
    for (const Placed& a : free[0]) {
      if (a.value + free[1][0].value <= most) break;
      room->place(arms[0], a.place->X_WB, a.place->q);
      for (const Placed& b : free[1]) {
        const double value = a.value + b.value;
        if (value <= most) break;
        room->place(arms[1], b.place->X_WB, b.place->q);
        const double gap = room->gap_between_arms();
        if (value * gap / kRoom > most) best[0] = a.place, best[1] = b.place, most = value * gap / kRoom;
      }
    }
  }
  if (most == 0) return false;
  for (int32_t n = 0; n < count; ++n) set_arm(best[n]->X_WB, best[n]->q, &s->hands[arms[n]]);
  return true;
}

}  // namespace

void free_start(const HandControlConfig& config, HandScene* s) {
  bool any = false;
  for (int32_t i = 0; i < config.count; ++i)
    any = any || (s->hands[i].armed && s->hands[i].chosen) || !s->hands[i].own;
  if (!any) return;
  Room room(config, *s);
  int32_t arms[kMaxHands], count = 0;
  Vec3 back[kMaxHands];
  bool free = true;
  for (int32_t i = 0; i < config.count; ++i) {
    ChosenHand& hand = s->hands[i];
    if (!hand.own && !hand.given && (!hand.armed || hand.chosen)) {
      back[i] = way_back(i, hand, &room);
      hand.X_WB.p += back[i];
      hand.X_WF.p += back[i];
      free = free && (!hand.armed || dot(back[i], back[i]) == 0);
    }
    if (!hand.armed || !hand.chosen) continue;
    arms[count++] = i;
  }
  for (int32_t n = 0; n < count; ++n) free = free && room.arm_gap(arms[n]) >= kRoom;
  free = free && (count == 0 || room.gap_between_arms() >= kRoom);
  for (const bool wide : {false, true})
    if (!free) free = place_arms(arms, count, wide, s, &room);
  for (int32_t n = 0; n < count && !free; ++n)
    if (ChosenHand& hand = s->hands[arms[n]]; hand.X_WB.p.z < 0) hand.X_WB.p -= back[arms[n]];
  for (int32_t i = 0; i < config.count; ++i) s->articulations[static_cast<size_t>(i)].X_WB = s->hands[i].X_WB;
}

}  // namespace rdm
