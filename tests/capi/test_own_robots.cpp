// Robots through the ABI: every one of the library can be described, made again, mounted and moved.
#define RDM_EXPERIMENTAL
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace {

// All that describes a robot, as rdm_robot_create takes it.
struct Described {
  std::vector<rdm_robot_link> links;
  std::vector<rdm_robot_shape> shapes;
  std::vector<rdm_robot_pair> pairs;
  std::vector<rdm_robot_coupling> couplings;
  std::vector<rdm_robot_curve> curves;
  std::vector<rdm_robot_finger> fingers;
  std::vector<int32_t> commands;
  std::vector<double> home, folded;
  std::vector<float> closed;
  rdm_robot_def def;

  explicit Described(int32_t robot) {
    rdm_robot_def_init(&def, sizeof def);
    EXPECT_EQ(rdm_robot_get_def(robot, &def), RDM_OK) << rdm_last_error();
    const auto rows = [robot](auto* out, int32_t count, auto* at) {
      out->resize(static_cast<size_t>(count));
      for (int32_t i = 0; i < count; ++i)
        EXPECT_EQ(at(robot, i, out->data() + i), RDM_OK) << rdm_last_error();
    };
    rows(&links, def.num_links, rdm_robot_link_at);
    rows(&shapes, def.num_shapes, rdm_robot_shape_at);
    rows(&pairs, def.num_pairs, rdm_robot_pair_at);
    rows(&couplings, def.num_couplings, rdm_robot_coupling_at);
    rows(&curves, def.num_curves, rdm_robot_curve_at);
    rows(&fingers, def.num_fingers, rdm_robot_finger_at);
    commands.resize(static_cast<size_t>(std::max(def.num_commands, 0)));
    closed.resize(commands.size());
    home.resize(links.size());
    folded.resize(links.size());
    EXPECT_EQ(rdm_robot_get_postures(robot, commands.data(), home.data(), folded.data(), closed.data()),
              RDM_OK);
    bind();
  }
  void bind() {
    def.links = links.data();
    def.num_links = static_cast<int32_t>(links.size());
    def.shapes = shapes.data();
    def.pairs = pairs.data();
    def.couplings = couplings.data();
    def.curves = curves.data();
    def.fingers = fingers.data();
    def.commands = commands.data();
    def.home = home.data();
  }
};

struct Robots {  // removes what it made
  std::vector<int32_t> made;
  ~Robots() {
    for (const int32_t robot : made) rdm_robot_destroy(robot);
  }
  int32_t create(const rdm_robot_def& def) {
    int32_t robot = -1;
    EXPECT_EQ(rdm_robot_create(&robot, &def), RDM_OK) << rdm_last_error();
    if (robot >= 0) made.push_back(robot);
    return robot;
  }
};

// 7 doubles of each link.
std::vector<double> poses_of(int32_t robot, const std::vector<double>& q) {
  std::vector<rdm_pose> links(q.size());
  EXPECT_EQ(rdm_robot_get_poses(robot, q.data(), links.data(), nullptr, nullptr, nullptr), RDM_OK);
  std::vector<double> out;
  for (const rdm_pose& X : links) {
    out.insert(out.end(), X.p, X.p + 3);
    out.insert(out.end(), X.q, X.q + 4);
  }
  return out;
}

TEST(Robots, EveryOneCanBeMadeAgain) {
  Robots robots;
  const int32_t count = rdm_robot_count();
  for (int32_t r = 0; r < count; ++r) {
    Described own(r);
    const std::string name = std::string(own.def.name) + "_2";
    own.def.name = name.c_str();
    own.def.alias = nullptr;
    const int32_t copy = robots.create(own.def);
    ASSERT_GE(copy, count);
    int32_t found = -1;
    EXPECT_EQ(rdm_robot_find(name.c_str(), &found), RDM_OK);
    EXPECT_EQ(found, copy);
    Described again(copy);
    EXPECT_EQ(again.home, own.home);
    EXPECT_EQ(again.commands, own.commands);
    EXPECT_EQ(poses_of(copy, own.home), poses_of(r, own.home)) << name;
    ASSERT_EQ(again.links.size(), own.links.size());
    for (size_t i = 0; i < own.links.size(); ++i) {
      EXPECT_STREQ(again.links[i].joint, own.links[i].joint);
      EXPECT_EQ(std::memcmp(again.links[i].pose.q, own.links[i].pose.q, sizeof own.links[i].pose.q), 0);
      EXPECT_EQ(again.links[i].kp, own.links[i].kp);
    }
  }
}

TEST(Robots, NamesAreTakenOnceAndNumbersNeverTwice) {
  Described own(0);
  own.def.name = "twice";
  own.def.alias = "deux";
  int32_t first = -1, second = -1, found = -1;
  ASSERT_EQ(rdm_robot_create(&first, &own.def), RDM_OK) << rdm_last_error();
  EXPECT_EQ(rdm_robot_create(&second, &own.def), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::strstr(rdm_last_error(), "twice"), nullptr);
  EXPECT_EQ(rdm_robot_find("DEUX", &found), RDM_OK);
  EXPECT_EQ(found, first);
  EXPECT_EQ(rdm_robot_destroy(first), RDM_OK);
  EXPECT_EQ(rdm_robot_destroy(first), RDM_ERROR_NOT_FOUND);
  EXPECT_EQ(rdm_robot_find("twice", &found), RDM_ERROR_NOT_FOUND);
  rdm_robot_def io;
  rdm_robot_def_init(&io, sizeof io);
  EXPECT_EQ(rdm_robot_get_def(first, &io), RDM_ERROR_NOT_FOUND);
  ASSERT_EQ(rdm_robot_create(&second, &own.def), RDM_OK) << rdm_last_error();
  EXPECT_GT(second, first);
  EXPECT_EQ(rdm_robot_destroy(second), RDM_OK);
  EXPECT_EQ(rdm_robot_destroy(0), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_robot_destroy(-1), RDM_ERROR_RANGE);
}

// One joint with a flange: a pendulum that a hand can be put on.
rdm_robot_link hinge() {
  rdm_robot_link l{};
  l.name = "rod";
  l.joint = "hinge";
  l.parent = RDM_LINK_ROOT;
  l.pose.p[2] = 0.5;
  l.pose.q[3] = 1;
  l.axis[0] = 1;
  l.lower = -1;
  l.upper = 2;
  l.kp = 10;
  l.kd = 1;
  l.effort = 50;
  l.mass = 2;
  l.com[2] = 0.2;
  l.moment[0] = l.moment[1] = 0.1;
  l.moment[2] = 0.01;
  return l;
}
rdm_robot_def pendulum(const rdm_robot_link* link) {
  rdm_robot_def d;
  rdm_robot_def_init(&d, sizeof d);
  d.name = "pendulum";
  d.kind = RDM_ROBOT_ARM;
  d.links = link;
  d.num_links = 1;
  d.flange_link = 0;
  d.flange.p[2] = 0.4;
  return d;
}

TEST(Robots, AHandOnAnArmIsARobot) {
  Robots robots;
  const rdm_robot_link link = hinge();
  const int32_t arm = robots.create(pendulum(&link));
  int32_t both = -1;
  ASSERT_EQ(rdm_robot_create_mounted(&both, "both", arm, 0, 0.3, 0.02, 0), RDM_OK) << rdm_last_error();
  robots.made.push_back(both);
  Described own(both), hand(0);
  EXPECT_EQ(own.links.size(), 1 + hand.links.size());
  EXPECT_EQ(own.commands.size(), 1 + hand.commands.size());
  EXPECT_EQ(own.fingers.size(), hand.fingers.size());
  // the hand's root in the rod
  EXPECT_NEAR(own.links[0].mass, 2 + hand.def.root_mass, 1e-12);
  // the tip of a finger: the arm's flange, the plate, the turn, and the hand's own place
  std::vector<double> q(own.links.size(), 0.0), tips(3 * own.fingers.size()), hand_tips(tips.size());
  std::vector<rdm_pose> links(own.links.size());
  ASSERT_EQ(rdm_robot_get_poses(both, q.data(), links.data(), nullptr, tips.data(), nullptr), RDM_OK);
  ASSERT_EQ(rdm_robot_get_poses(0, q.data(), links.data(), nullptr, hand_tips.data(), nullptr), RDM_OK);
  for (size_t i = 0; i < own.fingers.size(); ++i) {
    const double x = hand_tips[3 * i] - hand.def.mount.p[0], y = hand_tips[3 * i + 1] - hand.def.mount.p[1],
                 z = hand_tips[3 * i + 2] - hand.def.mount.p[2];
    EXPECT_NEAR(tips[3 * i], std::cos(0.3) * x - std::sin(0.3) * y, 1e-12);
    EXPECT_NEAR(tips[3 * i + 1], std::sin(0.3) * x + std::cos(0.3) * y, 1e-12);
    EXPECT_NEAR(tips[3 * i + 2], 0.5 + 0.4 + 0.02 + z, 1e-12);
  }
  EXPECT_EQ(rdm_robot_create_mounted(&both, "again", 0, 0, 0, 0, 0), RDM_ERROR_UNSUPPORTED);
  EXPECT_EQ(rdm_robot_create_mounted(&both, "again", arm, arm, 0, 0, 0), RDM_ERROR_UNSUPPORTED);
  EXPECT_EQ(rdm_robot_create_mounted(&both, "again", arm, 0, 0, -1, 0), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_robot_create_mounted(&both, "again", arm, 0, NAN, 0, 0), RDM_ERROR_ARGUMENT);
}

// In the place of a rotation all 0 is none, and what comes back is a unit quaternion.
TEST(Robots, ARotationMayBeLeftOut) {
  Robots robots;
  rdm_robot_link link = hinge();
  std::fill_n(link.pose.q, 4, 0.0);
  rdm_robot_def def = pendulum(&link);
  def.mount.q[3] = 0;
  const int32_t arm = robots.create(def);
  rdm_robot_link back;
  ASSERT_EQ(rdm_robot_link_at(arm, 0, &back), RDM_OK);
  EXPECT_EQ(back.pose.q[3], 1);
  rdm_robot_def whole;
  rdm_robot_def_init(&whole, sizeof whole);
  ASSERT_EQ(rdm_robot_get_def(arm, &whole), RDM_OK);
  EXPECT_EQ(whole.mount.q[3], 1);
}

TEST(Robots, AFlangeIsReachedOrNot) {
  Robots robots;
  const rdm_robot_link link = hinge();
  const int32_t arm = robots.create(pendulum(&link));
  rdm_pose goal, rod;
  double q = 0.8;
  ASSERT_EQ(rdm_robot_get_poses(arm, &q, &rod, &goal, nullptr, nullptr), RDM_OK);
  int32_t found = -1;
  q = 0.1;
  ASSERT_EQ(rdm_robot_reach(arm, &goal, &q, &found), RDM_OK);
  EXPECT_EQ(found, 1);
  EXPECT_NEAR(q, 0.8, 1e-5);
  goal.p[0] += 0.2;  // beside the plane it swings in
  ASSERT_EQ(rdm_robot_reach(arm, &goal, &q, &found), RDM_OK);
  EXPECT_EQ(found, 0);
  q = NAN;
  EXPECT_EQ(rdm_robot_reach(arm, &goal, &q, &found), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_robot_reach(0, &goal, &q, &found), RDM_ERROR_UNSUPPORTED);
  q = 0.1;
  goal.q[0] = 2;
  EXPECT_EQ(rdm_robot_reach(arm, &goal, &q, &found), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_robot_reach(arm, nullptr, &q, &found), RDM_ERROR_ARGUMENT);
}

// What is wrong is named.
TEST(Robots, BadOnesAreRefusedByName) {
  const auto refused = [](rdm_result code, const char* word, auto&& change) {
    rdm_robot_link link = hinge();
    rdm_robot_def d = pendulum(&link);
    change(d, link);
    int32_t robot = -1;
    EXPECT_EQ(rdm_robot_create(&robot, &d), code) << word;
    EXPECT_NE(std::strstr(rdm_last_error(), word), nullptr) << rdm_last_error();
    EXPECT_EQ(robot, -1);
  };
  using D = rdm_robot_def;
  using L = rdm_robot_link;
  refused(RDM_ERROR_ARGUMENT, "name is empty", [](D& d, L&) { d.name = ""; });
  refused(RDM_ERROR_ARGUMENT, "name is empty", [](D&, L& l) { l.joint = nullptr; });
  refused(RDM_ERROR_RANGE, "longer than 25", [](D& d, L&) { d.name = "abcdefghijklmnopqrstuvwxyz"; });
  refused(RDM_ERROR_ARGUMENT, "links is NULL", [](D& d, L&) { d.links = nullptr; });
  refused(RDM_ERROR_RANGE, "num_links", [](D& d, L&) { d.num_links = 65; });
  refused(RDM_ERROR_RANGE, "the number of links, 0,", [](D& d, L&) { d.num_links = 0; });
  refused(RDM_ERROR_RANGE, "parent 0", [](D&, L& l) { l.parent = 0; });
  refused(RDM_ERROR_ARGUMENT, "triangle", [](D&, L& l) { l.moment[2] = 0.3; });
  refused(RDM_ERROR_ARGUMENT, "positive definite", [](D&, L& l) { l.moment[0] = -0.1; });
  refused(RDM_ERROR_RANGE, "mass", [](D&, L& l) { l.mass = -1; });
  refused(RDM_ERROR_ARGUMENT, "rod: mass is not finite",
          [](D&, L& l) { l.mass = std::numeric_limits<double>::infinity(); });
  refused(RDM_ERROR_RANGE, "hinge: the range [2, 2] is empty", [](D&, L& l) { l.lower = 2; });
  refused(RDM_ERROR_ARGUMENT, "axis has length 0", [](D&, L& l) { l.axis[0] = 0; });
  refused(RDM_ERROR_ARGUMENT, "quaternion", [](D&, L& l) { l.pose.q[3] = 2; });
  refused(RDM_ERROR_RANGE, "kind", [](D& d, L&) { d.kind = 3; });
  refused(RDM_ERROR_RANGE, "flange", [](D& d, L&) { d.flange_link = 1; });
  refused(RDM_ERROR_ARGUMENT, "a hand must have a palm", [](D& d, L&) { d.kind = RDM_ROBOT_HAND; });
  refused(RDM_ERROR_RANGE, "mirror", [](D& d, L&) { d.mirror = 3; });
}

TEST(Robots, PairsAreAllButNeighbours) {
  Robots robots;
  rdm_robot_link links[3] = {hinge(), hinge(), hinge()};
  links[1].name = "rod2", links[1].joint = "hinge2", links[1].parent = 0;
  links[2].name = "rod3", links[2].joint = "hinge3", links[2].parent = 1;
  rdm_robot_shape shapes[4] = {};
  const char* names[4] = {"a", "b", "c", "d"};
  for (int i = 0; i < 4; ++i) {
    shapes[i].name = names[i];
    shapes[i].kind = RDM_SHAPE_SPHERE;
    shapes[i].size[0] = 0.01;
    shapes[i].pose.q[3] = 1;
    shapes[i].link = i - 1;
  }
  rdm_robot_def d = pendulum(links);
  d.num_links = 3;
  d.shapes = shapes;
  d.num_shapes = 4;
  d.num_pairs = -1;
  const int32_t robot = robots.create(d);
  rdm_robot_pair pair[3];
  for (int i = 0; i < 3; ++i) ASSERT_EQ(rdm_robot_pair_at(robot, i, &pair[i]), RDM_OK);
  const int32_t expected[3][2] = {{0, 2}, {0, 3}, {1, 3}};  // root and rod2 ...
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(pair[i].a, expected[i][0]) << i;
    EXPECT_EQ(pair[i].b, expected[i][1]) << i;
  }
  EXPECT_EQ(rdm_robot_pair_at(robot, 3, pair), RDM_ERROR_RANGE);
}

TEST(Robots, MayTakeNoCommands) {
  Robots own;
  int32_t door = -1;
  ASSERT_EQ(rdm_robot_find("door", &door), RDM_OK);
  Described d(door);
  EXPECT_EQ(d.def.num_commands, -1);
  EXPECT_EQ(d.def.kind, RDM_ROBOT_OTHER);
  d.def.name = "my_door";
  const int32_t made = own.create(d.def);
  rdm_robot robot{};
  robot.struct_size = sizeof robot;
  ASSERT_EQ(rdm_robot_at(made, &robot), RDM_OK);
  EXPECT_EQ(robot.num_actuated, 0);
  EXPECT_EQ(robot.num_joints, 2);
  rdm_joint_info joint = RDM_INIT(rdm_joint_info);
  ASSERT_EQ(rdm_robot_joint_at(made, 1, &joint), RDM_OK);
  EXPECT_EQ(joint.action, -1);
  EXPECT_GT(joint.kp, 0);  // its spring
  int32_t robot_index = -1;
  d.def.name = "another_door";
  d.def.num_commands = -2;
  EXPECT_EQ(rdm_robot_create(&robot_index, &d.def), RDM_ERROR_RANGE);
  EXPECT_NE(std::strstr(rdm_last_error(), "num_commands: -2"), nullptr);
  d.def.num_commands = -1;
  d.def.kind = RDM_ROBOT_ARM;
  EXPECT_EQ(rdm_robot_create(&robot_index, &d.def), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::strstr(rdm_last_error(), "must take commands"), nullptr) << rdm_last_error();
}

}  // namespace
