#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "golden_poses.inl"
#include "robot/kinematics.hpp"
#include "robot/mounted.hpp"
#include "robot/robots.hpp"
#include "robot_rows.hpp"

namespace rdm {
namespace {

constexpr double kExact = 1e-6;  // m, and of a quaternion's components

struct GoldenFrame {
  std::string part;  // "flange", "mount", "palm", "tip", "flange_link"
  int32_t tip = 0;
  Pose X_L;
};
struct GoldenRobot {
  std::vector<std::string> joints;
  std::vector<GoldenFrame> frames;
  struct At {
    std::string pose;
    std::vector<double> q;  // as `joints`
    std::vector<Pose> X;    // as `frames`
  };
  std::vector<At> poses;
  const At& at(const std::string& pose) const {
    for (const At& a : poses)
      if (a.pose == pose) return a;
    ADD_FAILURE() << "no pose " << pose;
    return poses.front();
  }
};
struct GoldenPair {
  std::string arm, hand;
  std::vector<Pose> X;  // as the hand's frames
};
struct Golden {
  std::map<std::string, GoldenRobot> robots;
  std::vector<GoldenPair> pairs;
};

Pose read_pose(std::istream& in) {
  Pose X;
  in >> X.p.x >> X.p.y >> X.p.z >> X.q.w >> X.q.x >> X.q.y >> X.q.z;
  return X;
}

const Golden& golden() {
  static const Golden made = [] {
    Golden out;
    GoldenRobot* robot = nullptr;
    std::istringstream lines(kGoldenPoses);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream in(line);
      std::string word, name;
      in >> word;
      if (word == "robot") {
        in >> name;
        robot = &out.robots[name];
      } else if (word == "joints") {
        while (in >> name) robot->joints.push_back(name);
      } else if (word == "frame") {
        GoldenFrame frame;
        in >> frame.part;
        if (frame.part == "tip") in >> frame.tip;
        in >> name;  // ":"
        frame.X_L = read_pose(in);
        robot->frames.push_back(frame);
      } else if (word == "q") {
        GoldenRobot::At at;
        in >> at.pose >> name;
        for (double q = 0; in >> q;) at.q.push_back(q);
        robot->poses.push_back(at);
      } else if (word == "mounted") {
        out.pairs.emplace_back();
        in >> out.pairs.back().arm >> out.pairs.back().hand;
      } else if (word == "at") {
        (out.pairs.empty() ? robot->poses.back().X : out.pairs.back().X).push_back(read_pose(in));
      }
    }
    return out;
  }();
  return made;
}

const Robot& own(const std::string& name) {
  return *RobotRef(find_robot(name.c_str()));  // the library's own stay
}

// Angles as the rows of the robot have them.
std::vector<double> angles(const Robot& robot, const GoldenRobot& g, const GoldenRobot::At& at) {
  EXPECT_EQ(at.q.size(), g.joints.size());
  EXPECT_EQ(g.joints.size(), static_cast<size_t>(robot.links.count)) << robot.name;
  std::vector<double> q(static_cast<size_t>(robot.links.count));
  for (size_t i = 0; i < g.joints.size(); ++i)
    q[static_cast<size_t>(joint_row(robot, g.joints[i]))] = at.q[i];
  return q;
}

// Where the tables say that a part is; the turn of palms and tips, which tables do not hold, is the golden
// one.
Pose part_pose(const Robot& robot, const double* q, const GoldenFrame& frame, const Pose& X_RM) {
  if (frame.part == "flange") return flange_pose(robot, q);
  if (frame.part == "flange_link") return link_pose(robot, q, robot.flange) * frame.X_L;
  if (frame.part == "mount") return X_RM;
  if (frame.part == "palm") {
    return link_pose(robot, q, robot.palm) * Pose{robot.p_palm, frame.X_L.q};
  }
  const RobotTip& tip = robot.tips[frame.tip];
  return link_pose(robot, q, tip.link) * Pose{tip.p_L, frame.X_L.q};
}

void expect_near(const Pose& a, const Pose& b, const std::string& what) {
  EXPECT_LT(norm(a.p - b.p), kExact) << what;
  const double sign = a.q.w * b.q.w + a.q.x * b.q.x + a.q.y * b.q.y + a.q.z * b.q.z < 0 ? -1 : 1;
  for (const double d :
       {a.q.w - sign * b.q.w, a.q.x - sign * b.q.x, a.q.y - sign * b.q.y, a.q.z - sign * b.q.z})
    EXPECT_LT(std::abs(d), kExact) << what;
}

TEST(RobotPoses, AgreeWithTheIndependentModel) {
  ASSERT_FALSE(golden().robots.empty());
  for (const auto& [name, g] : golden().robots) {
    const Robot& robot = own(name);
    EXPECT_STREQ(robot.name, name.c_str());
    EXPECT_FALSE(g.poses.empty() || g.frames.empty()) << name;
    for (const GoldenRobot::At& at : g.poses) {
      const std::vector<double> q = angles(robot, g, at);
      ASSERT_EQ(at.X.size(), g.frames.size());
      for (size_t f = 0; f < g.frames.size(); ++f)
        expect_near(part_pose(robot, q.data(), g.frames[f], robot.X_RM), at.X[f],
                    name + " " + at.pose + " " + g.frames[f].part + std::to_string(g.frames[f].tip));
      if (at.pose != "home") continue;
      for (int32_t i = 0; i < robot.links.count; ++i)
        EXPECT_NEAR(robot.home.count ? robot.home[i] : 0, q[static_cast<size_t>(i)], kExact) << name;
    }
  }
}

TEST(RobotPoses, PalmsFaceTheWayTheModelSays) {
  for (const auto& [name, g] : golden().robots)
    for (const GoldenFrame& frame : g.frames)
      if (frame.part == "palm") {
        EXPECT_LT(norm(rotate(frame.X_L.q, {0, 0, 1}) - own(name).n_palm), kExact) << name;
        EXPECT_LT(norm(frame.X_L.p - own(name).p_palm), kExact) << name;
      }
}

TEST(RobotPoses, PairsAgreeWithTheIndependentModel) {
  size_t arms = 0, hands = 0;
  for (const auto& [name, g] : golden().robots) ++(own(name).kind == RobotKind::kArm ? arms : hands);
  EXPECT_EQ(golden().pairs.size(), arms * hands);
  for (const GoldenPair& pair : golden().pairs) {
    const Robot &arm = own(pair.arm), &hand = own(pair.hand);
    const GoldenRobot &ga = golden().robots.at(pair.arm), &gh = golden().robots.at(pair.hand);
    const RobotCopy copy = make_mounted(arm, hand, {});
    const Robot& both = copy.robot();
    check_robot(both);
    std::vector<double> q = angles(arm, ga, ga.at("home"));
    const std::vector<double> q_hand = angles(hand, gh, gh.at("mid"));
    q.insert(q.end(), q_hand.begin(), q_hand.end());
    ASSERT_EQ(q.size(), static_cast<size_t>(both.links.count));
    ASSERT_EQ(pair.X.size(), gh.frames.size());
    for (size_t f = 0; f < gh.frames.size(); ++f) {
      GoldenFrame frame = gh.frames[f];
      // of a palm that is the hand's root the turn is now in the arm's last link
      if (frame.part == "palm" && hand.palm == kRootLink)
        frame.X_L.q = arm.X_LF.q * mounted_root(hand, {}).q * frame.X_L.q;
      expect_near(part_pose(both, q.data(), frame, flange_pose(both, q.data())), pair.X[f],
                  std::string(both.name) + " " + frame.part + std::to_string(frame.tip));
    }
    // the adapter lifts the hand along z of the flange, the yaw turns it about z
    const RobotCopy other = make_mounted(arm, hand, {0.5, 0.02});
    const Pose turn = {{0, 0, 0.02}, axis_angle({0, 0, 1}, 0.5)};
    const Pose X_F = flange_pose(both, q.data());
    expect_near(palm_frame(other.robot(), q.data()), X_F * turn * inverse(X_F) * palm_frame(both, q.data()),
                both.name);
  }
}

// The draws of a robot's joints, within their limits; what is coupled follows.
class Draws {
 public:
  explicit Draws(const Robot& robot, uint64_t seed) : robot_(robot), stream_(seed) {}
  const double* next(double share = 1) {
    for (int32_t i = 0; i < robot_.links.count; ++i) {
      const RobotLink& l = robot_.links[i];
      const double middle = 0.5 * (l.lower + l.upper);
      q_[i] = middle + share * (l.upper - l.lower) * (next_unit() - 0.5);
    }
    for (const RobotCoupling& c : robot_.couplings)
      q_[c.link] = std::clamp(c.ratio * q_[c.other], robot_.links[c.link].lower, robot_.links[c.link].upper);
    return q_;
  }

 private:
  double next_unit() {  // splitmix64
    uint64_t z = (stream_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  const Robot& robot_;
  uint64_t stream_;
  double q_[kMaxRobotLinks] = {};
};

TEST(RobotPoses, LeftHandsAreMirrorImages) {
  int sided = 0;
  for (const auto& [name, g] : golden().robots) {
    const Robot& right = own(name);
    if (right.mirror < 0) {
      EXPECT_THROW(make_mirrored(right), Error) << name;
      continue;
    }
    ++sided;
    const RobotCopy left_copy = make_mirrored(right);
    const Robot& left = left_copy.robot();
    const RobotCopy again_copy = make_mirrored(left);
    const Robot& again = again_copy.robot();
    check_robot(left);
    const int32_t axis = right.mirror;
    const auto image = [axis](const Pose& X) {
      return Pose{mirrored_point(X.p, axis), mirrored_turn(X.q, axis)};
    };
    Draws draws(right, 7);
    for (int k = 0; k < 20; ++k) {
      const double* q = draws.next();
      for (int32_t i = 0; i < right.links.count; ++i) {
        expect_near(link_pose(left, q, i), image(link_pose(right, q, i)), right.links[i].name);
        expect_near(link_pose(again, q, i), link_pose(right, q, i), right.links[i].name);
      }
      for (int32_t t = 0; t < right.tips.count; ++t) {
        const RobotTip &r = right.tips[t], &l = left.tips[t];
        EXPECT_LT(norm(link_pose(left, q, l.link) * l.p_L -
                       mirrored_point(link_pose(right, q, r.link) * r.p_L, axis)),
                  kExact);
      }
      const Pose palm_r = palm_frame(right, q), palm_l = palm_frame(left, q);
      EXPECT_LT(norm(palm_l.p - mirrored_point(palm_r.p, axis)), kExact) << name;
      for (const Vec3& v : {Vec3{0, 1, 0}, Vec3{0, 0, 1}})  // back of the palm, fingers
        EXPECT_LT(norm(rotate(palm_l.q, v) - mirrored_point(rotate(palm_r.q, v), axis)), kExact) << name;
    }
    expect_near(again.X_RM, right.X_RM, name);
    // hands with a side keep where the palm faces and where the fingers point
    EXPECT_LT(norm(rotate(left.X_RM.q, {0, 0, 1}) - rotate(right.X_RM.q, {0, 0, 1})), kExact) << name;
    for (int32_t i = 0; i < right.links.count; ++i) {
      EXPECT_EQ(left.links[i].lower, right.links[i].lower);
      EXPECT_EQ(left.links[i].mass, right.links[i].mass);
    }
  }
  EXPECT_EQ(sided, 5);
}

// Two ways to a left hand: the articulation's, and the table's.
TEST(RobotPoses, LeftArticulationsAreThoseOfLeftTables) {
  for (const auto& [name, g] : golden().robots) {
    const Robot& robot = own(name);
    if (robot.mirror < 0 || norm(robot.X_BR.p) > 0 || robot.X_BR.q.w != 1) continue;
    const RobotCopy copy = make_mirrored(robot);
    const ArticulationDef a = make_articulation(robot, Side::kLeft, {}, ""),
                          b = make_articulation(copy.robot(), Side::kRight, {}, "");
    ASSERT_EQ(a.links.size(), b.links.size());
    EXPECT_LT(norm(a.base.com - b.base.com), 1e-12) << name;
    for (size_t i = 0; i < a.links.size(); ++i) {
      expect_near(a.links[i].X_PL, b.links[i].X_PL, a.links[i].name.text);
      EXPECT_LT(norm(a.links[i].joint.axis - b.links[i].joint.axis), 1e-12) << a.links[i].name.text;
      for (int k = 0; k < 6; ++k)
        EXPECT_NEAR(a.links[i].inertia.moment[k], b.links[i].inertia.moment[k], 1e-15)
            << a.links[i].name.text;
    }
    for (size_t i = 0; i < a.shapes.size(); ++i)
      expect_near(a.shapes[i].shape.X_LS, b.shapes[i].shape.X_LS, a.shapes[i].shape.name.text);
  }
}

TEST(RobotPoses, ThumbsOfBothSidesAreOnOppositeSides) {
  for (const char* name : {"shadow_hand", "allegro_hand", "schunk_svh"}) {
    const Robot& right = own(name);
    const RobotCopy copy = make_mirrored(right);
    double q[kMaxRobotLinks] = {};
    const auto side = [&](const Robot& hand) {
      const RobotTip& thumb = hand.tips[hand.tips.count - 1];
      return (inverse(palm_frame(hand, q)) * (link_pose(hand, q, thumb.link) * thumb.p_L)).x;
    };
    EXPECT_GT(side(right) * side(right), 1e-4) << name;
    EXPECT_LT(side(right) * side(copy.robot()), 0) << name;
    EXPECT_NEAR(side(right), -side(copy.robot()), kExact) << name;
    // all right thumbs on the same side
    EXPECT_EQ(side(right) > 0, side(kShadowHand) > 0) << name;
  }
}

// From 0.4 rad off in every joint back to a pose that was drawn: the share that is reached.
TEST(RobotPoses, ArmsReachWhereTheyCanBe) {
  for (const auto& [name, g] : golden().robots) {
    const Robot& arm = own(name);
    if (arm.kind != RobotKind::kArm) continue;
    Draws draws(arm, 11);
    int reached = 0;
    constexpr int kTries = 500;
    for (int k = 0; k < kTries; ++k) {
      const double* drawn = draws.next();
      const Pose X_RF = flange_pose(arm, drawn);
      double q[kMaxRobotLinks];
      for (int32_t i = 0; i < arm.links.count; ++i)  // a little way off
        q[i] = std::clamp(drawn[i] + (k % 2 ? 0.4 : -0.4), arm.links[i].lower, arm.links[i].upper);
      if (!solve_reach(arm, X_RF, q)) continue;
      ++reached;
      const Pose end = flange_pose(arm, q);
      EXPECT_LT(norm(end.p - X_RF.p), 2e-6) << name;
      for (int32_t i = 0; i < arm.links.count; ++i) {
        EXPECT_GE(q[i], arm.links[i].lower) << name;
        EXPECT_LE(q[i], arm.links[i].upper) << name;
      }
    }
    RecordProperty(name, reached);
    std::printf("%-14s reaches %d of %d\n", name.c_str(), reached, kTries);
    EXPECT_GE(reached, 0.9 * kTries) << name;
  }
}

// From afar one start in two or three ends at a limit; from the start pose and a dozen others nearly all are
// reached.
TEST(RobotPoses, ArmsReachFromAfarWithAFewStarts) {
  for (const auto& [name, g] : golden().robots) {
    const Robot& arm = own(name);
    if (arm.kind != RobotKind::kArm) continue;
    Draws goals(arm, 13), starts(arm, 17);
    int first = 0, reached = 0;
    constexpr int kTries = 200, kStarts = 13;
    for (int k = 0; k < kTries; ++k) {
      const Pose X_RF = flange_pose(arm, goals.next());
      bool there = false;
      for (int start = 0; start < kStarts && !there; ++start) {
        double q[kMaxRobotLinks] = {};
        const double* from = start == 0 ? arm.home.rows : starts.next();
        if (from) std::copy_n(from, arm.links.count, q);
        there = solve_reach(arm, X_RF, q);
        first += there && start == 0;
      }
      reached += there;
    }
    std::printf("%-14s reaches %d of %d from its start pose, %d with %d starts\n", name.c_str(), first,
                kTries, reached, kStarts);
    EXPECT_GE(first, 0.45 * kTries) << name;
    EXPECT_GE(reached, 0.95 * kTries) << name;
  }
}

TEST(RobotPoses, ArmsFindAPlaceForTheirBase) {
  // hands that look ahead, aside, down, and slanted
  const Quat ahead = axis_angle({0, 1, 0}, kPi / 2);
  const Pose flanges[] = {
      {{0, 0, 0.6}, ahead},
      {{0.3, -0.4, 0.4}, axis_angle({1, 0, 0}, kPi / 2)},
      {{0, 0, 0.5}, axis_angle({1, 0, 0}, kPi)},
      {{-0.2, 0.1, 0.5}, axis_angle({0, 0, 1}, 0.7) * axis_angle({0, 1, 0}, 2.2)},
  };
  for (const auto& [name, g] : golden().robots) {
    const Robot& arm = own(name);
    if (arm.kind != RobotKind::kArm) continue;
    for (const Pose& X_WF : flanges) {
      Pose X_WB;
      double q[kMaxRobotLinks];
      ASSERT_TRUE(place_arm(arm, X_WF, -rotate(X_WF.q, {0, 0, 1}), &X_WB, q)) << name;
      EXPECT_GE(X_WB.p.z, 0) << name;
      EXPECT_GT(rotate(X_WB.q, {0, 0, 1}).z, 1 - 1e-9) << name;  // upright
      const Pose end = X_WB * flange_pose(arm, q);
      EXPECT_LT(norm(end.p - X_WF.p), 2e-6) << name;
      EXPECT_LT(norm(rotate(end.q, {0, 0, 1}) - rotate(X_WF.q, {0, 0, 1})), 2e-6) << name;
      for (int32_t i = 0; i < arm.links.count; ++i) {
        EXPECT_GT(q[i], arm.links[i].lower) << name;
        EXPECT_LT(q[i], arm.links[i].upper) << name;
      }
    }
    // all that it may choose from, the best first; and poses for a base that stands already
    const Pose& X_WF = flanges[1];
    for (const bool wide : {false, true}) {
      const Vector<ArmPlace> places = arm_places(arm, X_WF, {0, -1, 0}, wide);
      ASSERT_FALSE(places.empty()) << name;
      for (size_t i = 0; i < places.size(); ++i) {
        EXPECT_LT(norm((places[i].X_WB * flange_pose(arm, places[i].q)).p - X_WF.p), 2e-6) << name;
        EXPECT_LE(places[i].score, places[i > 0 ? i - 1 : 0].score) << name;
      }
      for (const ArmPlace& pose : arm_poses(arm, X_WF, places[0].X_WB)) {
        EXPECT_LT(norm((pose.X_WB * flange_pose(arm, pose.q)).p - X_WF.p), 2e-6) << name;
        EXPECT_EQ(norm(pose.X_WB.p - places[0].X_WB.p), 0) << name;
      }
      EXPECT_FALSE(arm_poses(arm, X_WF, places[0].X_WB).empty()) << name;
    }
    EXPECT_TRUE(arm_poses(arm, X_WF, {{9, 9, 0}, {}}).empty()) << name;
    Pose X_WB;
    double q[kMaxRobotLinks];
    EXPECT_FALSE(place_arm(arm, {{0, 0, -50}, ahead}, {}, &X_WB, q)) << name;  // a base under the ground
  }
}

}  // namespace
}  // namespace rdm
