// Robots out of files: both formats of one hand agree, what is dropped is listed with its line, what cannot
// be a robot is refused with line and element, and text gives back every robot to the last bit.
#include <redman/import.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "imports.hpp"
#include "written.hpp"

namespace {

const std::string kData = RDM_TEST_DATA "/import/";
Import from_file(const std::string& name, const rdm_import_config* o = nullptr) {
  return from_path(kData + name, o);
}

std::string written(const rdm_robot_def& def) {
  return written_text(
      [&](char* out, size_t n, size_t* size) { return rdm_import_write_robot(&def, out, n, size); });
}
std::string read(const std::string& name) {
  std::ifstream in(kData + name, std::ios::binary);
  EXPECT_TRUE(in) << name;
  std::stringstream out;
  out << in.rdbuf();
  return out.str();
}

struct Robot {  // in the process's list for a while
  int32_t index = -1;
  explicit Robot(rdm_robot_def def, const char* name = nullptr) {
    if (name) def.name = name;
    EXPECT_EQ(rdm_robot_create(&index, &def), RDM_OK) << rdm_last_error();
  }
  ~Robot() {
    if (index >= 0) rdm_robot_destroy(index);
  }
  std::vector<rdm_pose> poses(const std::vector<double>& q) const {
    std::vector<rdm_pose> out(q.size());
    EXPECT_EQ(rdm_robot_get_poses(index, q.data(), out.data(), nullptr, nullptr, nullptr), RDM_OK)
        << rdm_last_error();
    return out;
  }
};

TEST(Import, UrdfBecomesAHand) {
  const Import i = from_file("hand.urdf");
  const rdm_robot_def& d = i.def;
  EXPECT_STREQ(d.name, "plain_hand");
  EXPECT_EQ(d.kind, RDM_ROBOT_HAND);
  ASSERT_EQ(d.num_links, 8);
  EXPECT_EQ(d.num_shapes, 9);
  EXPECT_DOUBLE_EQ(d.root_mass, 0.4);
  const rdm_robot_link& l = d.links[i.link("index_distal")];
  EXPECT_EQ(l.parent, i.link("index_proximal"));
  EXPECT_STREQ(l.joint, "index_curl");
  EXPECT_DOUBLE_EQ(l.upper, 1.4);
  EXPECT_DOUBLE_EQ(l.effort, 0.5);
  EXPECT_DOUBLE_EQ(l.velocity, 6);
  EXPECT_DOUBLE_EQ(d.links[0].friction, 0.01);
  EXPECT_DOUBLE_EQ(l.kp, 0.5 / 0.2);  // its effort 0.2 rad off the target
  ASSERT_EQ(d.num_couplings, 1);
  EXPECT_EQ(d.couplings[0].link, i.link("ring_distal"));
  EXPECT_EQ(d.couplings[0].other, i.link("ring_proximal"));
  EXPECT_DOUBLE_EQ(d.couplings[0].ratio, 0.8);
  EXPECT_EQ(d.shapes[1].kind, RDM_SHAPE_CYLINDER);
  EXPECT_DOUBLE_EQ(d.shapes[1].size[1], 0.015);
  for (const char* text :
       {"line 4: material grey", "line 11: visual", "line 140: gazebo", "line 141: transmission t"})
    EXPECT_TRUE(i.has_note(RDM_NOTE_DROPPED, text)) << text;
  EXPECT_EQ(i.notes(RDM_NOTE_DROPPED).size(), 4u);
  EXPECT_TRUE(i.has_note(RDM_NOTE_CHANGED, "line 139: index_tip is fixed and was merged into index_distal"));
}

TEST(Import, RolesAreGuessedAndListed) {
  const Import i = from_file("hand.urdf");
  const rdm_robot_def& d = i.def;
  ASSERT_EQ(d.num_fingers, 4);
  const char* const names[] = {"index", "middle", "ring", "thumb"};
  for (int32_t f = 0; f < 4; ++f) {
    EXPECT_STREQ(d.fingers[f].name, names[f]);
    EXPECT_EQ(d.fingers[f].first, 2 * f);
    EXPECT_EQ(d.fingers[f].tip, 2 * f + 1);
    EXPECT_EQ(d.fingers[f].lateral,
              f == 3 ? 6 : -1);  // the thumb's first joint turns about the palm's normal
    EXPECT_EQ(d.fingers[f].proximal, f == 3 ? 7 : 2 * f);
    EXPECT_EQ(d.fingers[f].thumb, f == 3);
  }
  EXPECT_NEAR(d.fingers[0].p_tip[2], 0.022, 1e-12);  // the frame index_tip
  EXPECT_NEAR(d.fingers[1].p_tip[2], 0.021, 1e-12);  // the end of its sphere
  EXPECT_EQ(d.palm_link, RDM_LINK_ROOT);
  EXPECT_NEAR(d.palm_normal[1], -1, 1e-9);
  EXPECT_NEAR(d.palm_fingers[2], 1, 1e-9);
  EXPECT_EQ(d.mirror, 0);
  EXPECT_TRUE(i.has_note(RDM_NOTE_GUESSED, "finger thumb, the thumb: from thumb_proximal to thumb_distal"));
  EXPECT_TRUE(i.has_note(RDM_NOTE_GUESSED, "palm: the root"));
  // And said by options.
  rdm_import_config o = import_config();
  o.palm = "palm";
  o.tips = "index_tip,thumb_distal";
  o.mount = "0 0 -0.01 0 0 1.5707963267948966";
  o.name = "two";
  const Import two = from_file("hand.urdf", &o);
  EXPECT_STREQ(two.def.name, "two");
  EXPECT_EQ(two.def.num_fingers, 2);
  for (const char* link : {"middle_distal", "ring_distal"})
    EXPECT_TRUE(two.has_note(RDM_NOTE_DROPPED, std::string("link ") + link +
                                                   ": its chain has none of the tips, so it is no finger"));
  EXPECT_FALSE(two.has_note(RDM_NOTE_DROPPED, "link thumb_distal"));
  EXPECT_FALSE(i.has_note(RDM_NOTE_DROPPED, "so it is no finger"));
}

// An option that would change the robot is taken or refused, never passed over.
TEST(Import, OptionsThatAFormatDoesNotTakeAreRefused) {
  const auto refused = [](const std::string& bytes, const std::string& text, auto&& set) {
    rdm_import_config o = import_config();
    set(o);
    expect_refused(bytes, RDM_ERROR_ARGUMENT, text, &o);
  };
  refused(read("hand.xml"), "config.density: it is for URDF only; a geom of MJCF has its own mass or density",
          [](auto& o) { o.density = 1000; });
  const std::string robot = written(from_file("hand.urdf").def);
  for (const auto& [name, set] : std::initializer_list<std::pair<const char*, void (*)(rdm_import_config&)>>{
           {"density", [](auto& o) { o.density = 1000; }},
           {"slide_range", [](auto& o) { o.slide_range = 1; }},
           {"root", [](auto& o) { o.root = "palm"; }},
           {"palm", [](auto& o) { o.palm = "palm"; }},
           {"tips", [](auto& o) { o.tips = "index_distal"; }},
           {"mount", [](auto& o) { o.mount = "palm"; }},
           {"flange", [](auto& o) { o.flange = "none"; }}})
    refused(robot,
            std::string("config.") + name + ": it is for URDF and MJCF only; a .robot file contains it", set);
}

TEST(Import, MjcfIsTheSameHand) {
  const Import urdf = from_file("hand.urdf"), mjcf = from_file("hand.xml");
  ASSERT_EQ(mjcf.def.num_links, urdf.def.num_links);
  ASSERT_EQ(mjcf.def.num_shapes, urdf.def.num_shapes);
  const Robot a(urdf.def, "hand_of_urdf"), b(mjcf.def, "hand_of_mjcf");
  std::mt19937 random(1);
  for (int k = 0; k < 100; ++k) {
    std::vector<double> q;
    for (int32_t i = 0; i < 8; ++i) {
      EXPECT_STREQ(urdf.def.links[i].joint, mjcf.def.links[i].joint);
      EXPECT_NEAR(urdf.def.links[i].upper, mjcf.def.links[i].upper, 1e-12);
      EXPECT_NEAR(urdf.def.links[i].mass, mjcf.def.links[i].mass, 1e-15);
      for (int m = 0; m < 6; ++m)
        EXPECT_NEAR(urdf.def.links[i].moment[m], mjcf.def.links[i].moment[m], 1e-15);
      q.push_back(std::uniform_real_distribution<>(0, urdf.def.links[i].upper)(random));
    }
    const auto x = a.poses(q), y = b.poses(q);
    for (size_t i = 0; i < x.size(); ++i) {
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(x[i].p[k], y[i].p[k], 1e-12) << i;
      for (int k = 0; k < 4; ++k) EXPECT_NEAR(x[i].q[k], y[i].q[k], 1e-12) << i;
    }
  }
  for (int m = 0; m < 6; ++m) EXPECT_NEAR(urdf.def.root_moment[m], mjcf.def.root_moment[m], 1e-15);
}

TEST(Import, MjcfDrivesAndCouplings) {
  const Import i = from_file("hand.xml");
  const rdm_robot_def& d = i.def;
  const rdm_robot_link &bend = d.links[i.link("index_proximal")], &curl = d.links[i.link("index_distal")];
  EXPECT_DOUBLE_EQ(bend.kp, 2);  // of the outermost class
  EXPECT_DOUBLE_EQ(bend.effort, 0.8);
  EXPECT_DOUBLE_EQ(bend.friction, 0.01);
  EXPECT_DOUBLE_EQ(curl.kp, 1);  // of the class in a class
  EXPECT_DOUBLE_EQ(curl.kd, 0.02);
  EXPECT_DOUBLE_EQ(curl.friction, 0);
  // The actuator's range ends before the joint's.
  ASSERT_EQ(d.num_curves, 2);
  EXPECT_EQ(d.curves[0].link, i.link("index_distal"));
  EXPECT_DOUBLE_EQ(d.curves[0].angle[1], 1.2);
  // An equality, and a tendon that one actuator pulls: length q1 + 0.5 q2 = 1.25 q1 when q2 = 0.5 q1.
  ASSERT_EQ(d.num_couplings, 2);
  EXPECT_EQ(d.couplings[0].link, i.link("ring_distal"));
  EXPECT_DOUBLE_EQ(d.couplings[0].ratio, 0.8);
  EXPECT_EQ(d.couplings[1].link, i.link("middle_distal"));
  EXPECT_DOUBLE_EQ(d.couplings[1].ratio, 0.5);
  const rdm_robot_link &lead = d.links[i.link("middle_proximal")], &follow = d.links[i.link("middle_distal")];
  EXPECT_DOUBLE_EQ(lead.kp, 3 * 1.25);
  EXPECT_DOUBLE_EQ(lead.kd, 0.1 * 1.25 + 0.02);
  EXPECT_DOUBLE_EQ(lead.effort, 1);
  EXPECT_DOUBLE_EQ(follow.effort, 0.5);
  ASSERT_TRUE(d.home);
  EXPECT_DOUBLE_EQ(d.home[0], 0.1);
  EXPECT_DOUBLE_EQ(d.home[6], 0.3);
  // Excluded bodies do not touch.
  for (int32_t p = 0; p < d.num_pairs; ++p) {
    const std::string a = d.links[d.shapes[d.pairs[p].b].link].name;
    if (d.shapes[d.pairs[p].a].link == i.link("index_distal")) {
      EXPECT_NE(a, "thumb_distal");
    }
  }
  for (const char* text :
       {"line 24: freejoint", "line 9: geom: solimp=\"0.9 0.95 0.001\"", "line 4: option", "line 21: light",
        "line 22: geom", "line 22: sensor (in hand_drives.xml)", "line 36: site index_tip"})
    EXPECT_TRUE(i.has_note(RDM_NOTE_DROPPED, text)) << text;
  EXPECT_TRUE(i.has_note(RDM_NOTE_DROPPED, "line 27: geom: only visual"));
}

TEST(Import, GrippersHaveRailsOffsetsAndMeshes) {
  const Import i = from_file("gripper.urdf");
  const rdm_robot_def& d = i.def;
  EXPECT_STREQ(d.name, "rail_gripper");
  ASSERT_EQ(d.num_links, 3);
  const rdm_robot_link& head = d.links[0];
  EXPECT_DOUBLE_EQ(head.lower, -2 * M_PI);
  EXPECT_DOUBLE_EQ(head.axis[2], 1);
  EXPECT_TRUE(i.has_note(RDM_NOTE_CHANGED, "line 9: joint turn has no limits"));
  // The camera is a part of it: two masses of 0.5 kg, 0.1 m apart, the second turned by a quarter.
  EXPECT_DOUBLE_EQ(head.mass, 1);
  EXPECT_NEAR(head.com[1], 0.05, 1e-12);
  EXPECT_NEAR(head.moment[0], 2e-4 + 2 * 0.5 * 0.05 * 0.05, 1e-12);
  EXPECT_NEAR(head.moment[1], 3e-4, 1e-12);
  EXPECT_STREQ(d.links[1].name, "jaw_a");
  EXPECT_TRUE(i.has_note(RDM_NOTE_CHANGED, "line 43: link jaw.a was renamed to jaw_a"));
  EXPECT_EQ(d.links[1].kind, RDM_JOINT_PRISMATIC);
  // jaw_b = jaw_a + 0.01: its 0 is where it stood at 0.01.
  ASSERT_EQ(d.num_couplings, 1);
  EXPECT_DOUBLE_EQ(d.couplings[0].ratio, 1);
  EXPECT_NEAR(d.links[2].lower, 0, 1e-15);
  EXPECT_NEAR(d.links[2].pose.p[0], -0.02, 1e-15);
  const rdm_robot_shape &pad = d.shapes[1], &rod = d.shapes[2];
  EXPECT_EQ(pad.kind, RDM_SHAPE_BOX);
  EXPECT_NEAR(pad.size[0], 0.005, 1e-9);
  EXPECT_NEAR(pad.size[2], 0.03, 1e-9);
  EXPECT_NEAR(pad.pose.p[2], 0.03, 1e-9);
  EXPECT_EQ(rod.kind, RDM_SHAPE_CAPSULE);
  EXPECT_NEAR(rod.size[0], 0.01, 1e-4);
  EXPECT_NEAR(rod.size[1], 0.03, 1e-3);
}

TEST(Import, ArmsHaveFlangesReferencesAndMassesOfShapes) {
  const Import i = from_file("arm.xml");
  const rdm_robot_def& d = i.def;
  EXPECT_EQ(d.kind, RDM_ROBOT_ARM);
  ASSERT_EQ(d.num_links, 3);
  // Two joints on one body: the first carries nothing of its own.
  EXPECT_EQ(d.links[0].mass, 0);
  EXPECT_DOUBLE_EQ(d.links[1].mass, 1.5);
  EXPECT_DOUBLE_EQ(d.links[1].pose.p[2], 0.1);
  EXPECT_NEAR(d.links[1].moment[2], 1.5 * 0.04 * 0.04 / 2, 1e-12);
  EXPECT_NEAR(d.links[1].pose.q[1], std::sin(-0.25), 1e-12);  // ref: the file's pose is its 0.5
  EXPECT_NEAR(d.links[2].mass, 0.5 + 500 * 0.04 * 0.04 * 0.2, 1e-12);
  EXPECT_NEAR(d.links[2].pose.q[2], std::sqrt(0.5), 1e-12);  // xyaxes
  EXPECT_EQ(d.flange_link, 2);
  EXPECT_DOUBLE_EQ(d.flange.p[2], 0.3);
  EXPECT_DOUBLE_EQ(d.flange.q[0], 1);
  EXPECT_DOUBLE_EQ(d.links[0].effort, 50);
  EXPECT_DOUBLE_EQ(d.links[0].armature, 0.1);
  EXPECT_DOUBLE_EQ(d.links[1].kp, 200);
  EXPECT_DOUBLE_EQ(d.links[1].kd, 20);
  EXPECT_TRUE(i.has_note(RDM_NOTE_DROPPED, "line 15: joint elbow: stiffness=\"1\""));
  EXPECT_TRUE(i.has_note(RDM_NOTE_GUESSED, "flange: attachment_site"));
  // An imported hand comes onto it.
  const Import hand = from_file("hand.xml");
  const Robot a(d), h(hand.def);
  int32_t both = -1;
  ASSERT_EQ(rdm_robot_create_mounted(&both, "imported-pair", a.index, h.index, 0, 0, 0), RDM_OK)
      << rdm_last_error();
  rdm_robot_destroy(both);
}

TEST(Import, ChecksTellWhatTouchesAndWhatShakes) {
  Import good = from_file("arm.xml");
  ASSERT_EQ(rdm_import_check(good.handle), RDM_OK) << rdm_import_error();
  EXPECT_TRUE(good.notes(RDM_NOTE_CHECK).empty()) << good.notes(RDM_NOTE_CHECK)[0];
  // Too weak for its inertia, and another that nothing damps.
  std::string text = written(good.def);
  const auto edit = [&](const char* what, const char* by) {
    const size_t at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    text.replace(at, std::strlen(what), by);
  };
  edit("effort = 50.0", "effort = 0.01");
  edit("kp = 200.0\nkd = 20.0", "kp = 2.0\nkd = 0.0");
  const Import weak = from_text(text);
  ASSERT_EQ(rdm_import_check(weak.handle), RDM_OK) << rdm_import_error();
  EXPECT_TRUE(weak.has_note(RDM_NOTE_CHECK, "joint yaw does not reach"));
  EXPECT_TRUE(weak.has_note(RDM_NOTE_CHECK, "joint pitch does not settle in the home pose"));
  const Import hand = from_file("hand.urdf");
  ASSERT_EQ(rdm_import_check(hand.handle), RDM_OK) << rdm_import_error();
  EXPECT_TRUE(
      hand.has_note(RDM_NOTE_CHECK,
                    "while joint thumb_bend alone moves from 0.844 to 1.5, palm_box and thumb_distal touch"));
  // A pair that overlaps at home is left out by the importer; written in, it is told.
  const Import gripper = from_file("gripper.urdf");
  EXPECT_TRUE(gripper.has_note(RDM_NOTE_CHANGED, "jaw_a and jaw_b overlap in the home pose"));
  std::string with = written(gripper.def);
  with.insert(with.find("\n[root]"), "pairs = [[\"jaw_a\", \"jaw_b\"]]\n");
  const Import crossed = from_text(with);
  ASSERT_EQ(rdm_import_check(crossed.handle), RDM_OK) << rdm_import_error();
  EXPECT_TRUE(crossed.has_note(RDM_NOTE_CHECK, "in the home pose jaw_a touches jaw_b"));
}

// ---- text ----
template <class T>
void same_rows(const T* a, const T* b, int32_t count) {
  ASSERT_EQ(a == nullptr, b == nullptr);
  if (a && count > 0) {
    EXPECT_EQ(std::memcmp(a, b, sizeof(T) * static_cast<size_t>(count)), 0);
  }
}
// To the bit; texts by content.
void expect_same(rdm_robot_def a, rdm_robot_def b) {
  ASSERT_EQ(a.num_links, b.num_links);
  ASSERT_EQ(a.num_shapes, b.num_shapes);
  ASSERT_EQ(a.num_fingers, b.num_fingers);
  EXPECT_STREQ(a.name, b.name);
  EXPECT_EQ(a.alias ? std::string(a.alias) : "none", b.alias ? std::string(b.alias) : "none");
  EXPECT_EQ(a.summary ? std::string(a.summary) : "none", b.summary ? std::string(b.summary) : "none");
  for (int32_t i = 0; i < a.num_links; ++i) {
    rdm_robot_link x = a.links[i], y = b.links[i];
    EXPECT_STREQ(x.name, y.name);
    EXPECT_STREQ(x.joint, y.joint);
    x.name = y.name, x.joint = y.joint;
    EXPECT_EQ(std::memcmp(&x, &y, sizeof x), 0) << x.name;
  }
  for (int32_t i = 0; i < a.num_shapes; ++i) {
    rdm_robot_shape x = a.shapes[i], y = b.shapes[i];
    EXPECT_STREQ(x.name, y.name);
    x.name = y.name;
    EXPECT_EQ(std::memcmp(&x, &y, sizeof x), 0) << x.name;
  }
  for (int32_t i = 0; i < a.num_fingers; ++i) {
    rdm_robot_finger x = a.fingers[i], y = b.fingers[i];
    EXPECT_STREQ(x.name, y.name);
    x.name = y.name;
    EXPECT_EQ(std::memcmp(&x, &y, sizeof x), 0) << x.name;
  }
  same_rows(a.pairs, b.pairs, a.num_pairs);
  same_rows(a.couplings, b.couplings, a.num_couplings);
  same_rows(a.curves, b.curves, a.num_curves);
  same_rows(a.commands, b.commands, a.num_commands);
  same_rows(a.home, b.home, a.num_links);
  same_rows(a.folded, b.folded, a.num_links);
  EXPECT_EQ(a.closed == nullptr, b.closed == nullptr);
  if (a.closed && a.commands) same_rows(a.closed, b.closed, a.num_commands);
  // What is left are numbers.
  a.name = b.name, a.alias = b.alias, a.summary = b.summary;
  a.links = b.links, a.shapes = b.shapes, a.pairs = b.pairs, a.couplings = b.couplings, a.curves = b.curves;
  a.commands = b.commands, a.fingers = b.fingers, a.home = b.home, a.folded = b.folded, a.closed = b.closed;
  EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0);
}

TEST(RobotText, EveryRobotReadsBackToTheBit) {
  for (int32_t r = 0; r < rdm_robot_count(); ++r) {
    rdm_robot_def def;
    rdm_robot_def_init(&def, sizeof def);
    if (rdm_robot_get_def(r, &def) != RDM_OK) continue;
    SCOPED_TRACE(def.name);
    rdm_import* made = nullptr;
    ASSERT_EQ(rdm_import_create_robot(&made, r), RDM_OK) << rdm_import_error();
    const Import built(made);
    const std::string text = written(built.def);
    const Import again = from_text(text);
    expect_same(built.def, again.def);
    EXPECT_EQ(written(again.def), text);
  }
  for (const char* file : {"hand.urdf", "hand.xml", "gripper.urdf", "arm.xml"}) {
    SCOPED_TRACE(file);
    const Import one = from_file(file);
    expect_same(one.def, from_text(written(one.def)).def);
  }
}

TEST(RobotText, OddNumbersAndTextsReadBack) {
  const Import arm = from_file("arm.xml");
  std::vector<rdm_robot_link> links(arm.def.links, arm.def.links + arm.def.num_links);
  links[1].com[0] = -0.0;
  links[1].com[1] = 5e-324;
  links[1].com[2] = 0.1 + 0.2;
  links[2].kp = 123456789.0 / 1e4;
  rdm_robot_def def = arm.def;
  def.links = links.data();
  def.summary = "a \"quoted\" \\ text,\ttab, \xc3\xa4";
  def.num_pairs = -1;
  const Import again = from_text(written(def));
  EXPECT_EQ(again.def.num_pairs, -1);
  expect_same(def, again.def);
}

TEST(RobotText, CommentsAndOrderAreFree) {
  const Import i = from_text(
      "name = 'pole'  # a comment\nkind = \"other\"\n[[link]]\nparent = 'root'\njoint = 'j'\nname = "
      "'l'\naxis = [0, 0, 1]\n"
      "range = [-1, 1]\nmass = 1\nmoment = [1e-2, 1e-2, 1e-2, 0, 0, 0]\n# the end\n");
  EXPECT_EQ(i.def.num_links, 1);
  EXPECT_EQ(i.def.links[0].pose.q[3], 1);
  EXPECT_EQ(i.def.links[0].mass, 1);
}

// ---- refusals: each is one change of a good file ----
struct Refusal {
  const char* what;  // "" adds at the end
  const char* by;
  rdm_result code;
  const char* text;
};
void expect_refusals(const std::string& good, const char* folder, const std::vector<Refusal>& rows) {
  rdm_import_config o = import_config();
  char error[512];
  o.folder = folder;
  o.error = error;
  o.error_size = sizeof error;
  for (const Refusal& r : rows) {
    std::string text = good;
    const size_t at = *r.what ? text.find(r.what) : text.size();
    ASSERT_NE(at, std::string::npos) << r.what;
    text.replace(at, std::strlen(r.what), r.by);
    rdm_import* i = nullptr;
    EXPECT_EQ(rdm_import_read(&i, text.data(), text.size(), &o), r.code)
        << r.by << ": " << rdm_import_error();
    EXPECT_EQ(i, nullptr);
    EXPECT_NE(std::string(rdm_import_error()).find(r.text), std::string::npos)
        << "'" << rdm_import_error() << "' is not '" << r.text << "'";
    EXPECT_STREQ(error, rdm_import_error());
    rdm_import_destroy(i);
  }
}

TEST(Refusals, Urdf) {
  expect_refusals(
      read("hand.urdf"), nullptr,
      {{"<mass value=\"0.02\"", "<mass value=\"0\"", RDM_ERROR_RANGE,
        "line 26: mass: link index_proximal: the mass 0 is not above 0"},
       {"<mass value=\"0.02\"", "<mass value=\"-1\"", RDM_ERROR_RANGE,
        "line 26: mass: link index_proximal: the mass -1 is not above 0"},
       {"<mass value=\"0.02\"", "<mass value=\"nan\"", RDM_ERROR_FORMAT,
        "line 26: mass: value: nan is not a number"},
       {"izz=\"1e-6\"", "izz=\"7e-6\"", RDM_ERROR_ARGUMENT,
        "line 26: inertia: link index_proximal: the principal moments of inertia 3e-06, 3e-06, 7e-06 "
        "violate "
        "the triangle inequality"},
       {"ixx=\"3e-6\"", "ixx=\"-3e-6\"", RDM_ERROR_ARGUMENT,
        "line 26: inertia: link index_proximal: the principal moments of inertia -3e-06"},
       {"lower=\"0\" upper=\"1.5\"", "lower=\"1\" upper=\"1\"", RDM_ERROR_RANGE,
        "line 22: limit: joint index_bend: the range [1, 1] is empty"},
       {"<limit lower=\"0\" upper=\"1.5\" effort=\"0.8\" velocity=\"6\"/>", "", RDM_ERROR_FORMAT,
        "line 17: joint index_bend: it has no limit"},
       {"<child link=\"middle_proximal\"/>", "<child link=\"index_proximal\"/>", RDM_ERROR_ARGUMENT,
        "line 46: joint middle_bend: link index_proximal has two parents: this joint and joint index_bend of "
        "line 17"},
       {"<parent link=\"palm\"/>", "<parent link=\"index_distal\"/>", RDM_ERROR_ARGUMENT,
        "it is in a loop of joints"},
       {"<parent link=\"palm\"/>", "<parent link=\"plam\"/>", RDM_ERROR_NOT_FOUND,
        "line 17: joint index_bend: parent plam: there is no link of this name; nearest is palm"},
       {"<box size=\"0.09 0.03 0.1\"/>", "<mesh filename=\"palm.stl\"/>", RDM_ERROR_NOT_FOUND,
        "line 14: mesh: mesh palm.stl: a text that is not from a file has no folder"},
       {"<box size=\"0.09 0.03 0.1\"/>", "<box size=\"0.09 0.03\"/>", RDM_ERROR_FORMAT,
        "line 14: box: size: 0.09 0.03 is not 3 numbers"},
       {"<box size=\"0.09 0.03 0.1\"/>", "<box size=\"0.09 0 0.1\"/>", RDM_ERROR_RANGE,
        "line 14: box: link palm: size 0 is not above 0"},
       {"<box size=\"0.09 0.03 0.1\"/>", "<cone size=\"1\"/>", RDM_ERROR_UNSUPPORTED,
        "line 14: geometry: link palm: its geometry must be a box"},
       {"type=\"revolute\"", "type=\"planar\"", RDM_ERROR_UNSUPPORTED,
        "line 17: joint index_bend: type planar"},
       {"<axis xyz=\"1 0 0\"/>", "<axis xyz=\"0 0 0\"/>", RDM_ERROR_ARGUMENT,
        "line 17: joint index_bend: its axis is 0"},
       {"<mimic joint=\"ring_bend\"", "<mimic joint=\"ring_band\"", RDM_ERROR_NOT_FOUND,
        "line 96: mimic: there is no joint ring_band; nearest is ring_bend"},
       {"<mimic joint=\"ring_bend\"", "<mimic joint=\"ring_curl\"", RDM_ERROR_ARGUMENT,
        "line 96: mimic: joint ring_curl follows itself"},
       {"<link name=\"index_distal\">", "<link name=\"index_proximal\">", RDM_ERROR_ARGUMENT,
        "line 39: link index_proximal: it occurs twice"},
       {"<link name=\"index_tip\"/>", "<link name=\"index_tip\"/><link name=\"lost\"/>", RDM_ERROR_ARGUMENT,
        "line 139: link lost: it has no parent joint, and neither has link palm of line 5"},
       {"<inertial><origin xyz=\"0 0 0.012\"/><mass value=\"0.01\"/><inertia ixx=\"1e-6\" iyy=\"1e-6\" "
        "izz=\"5e-7\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>",
        "", RDM_ERROR_RANGE, "line 39: link index_distal: it moves, but has no mass"},
       {"</robot>", "", RDM_ERROR_FORMAT, "this is not XML"},
       {"<robot name=\"plain_hand\">", "<robot name=\"plain_hand\"><xacro:arg name=\"x\"/>",
        RDM_ERROR_UNSUPPORTED, "line 3: xacro:arg x: xacro is not read"}});
}

TEST(Refusals, Mjcf) {
  const std::string folder = kData;
  expect_refusals(
      read("hand.xml"), folder.c_str(),
      {{"mass=\"0.02\"", "mass=\"0\"", RDM_ERROR_RANGE,
        "line 29: inertial: body index_proximal: the mass 0 is not above 0"},
       {"diaginertia=\"3e-6 3e-6 1e-6\"", "diaginertia=\"3e-6 3e-6 7e-6\"", RDM_ERROR_ARGUMENT,
        "line 29: inertial: body index_proximal: the principal moments of inertia 3e-06, 3e-06, 7e-06 "
        "violate "
        "the triangle inequality"},
       {"name=\"index_bend\" class=\"bend\"", "name=\"index_bend\" class=\"bent\"", RDM_ERROR_NOT_FOUND,
        "line 30: joint index_bend: there is no class bent; nearest is bend"},
       {"name=\"index_bend\" class=\"bend\"", "name=\"index_bend\" range=\"3 1\"", RDM_ERROR_RANGE,
        "line 30: joint index_bend: the range [3, 1] is empty"},
       {"name=\"index_bend\" class=\"bend\"", "name=\"index_bend\" type=\"ball\"", RDM_ERROR_UNSUPPORTED,
        "line 30: joint index_bend: type ball"},
       {"name=\"middle_bend\"", "name=\"index_bend\"", RDM_ERROR_ARGUMENT, "joint index_bend occurs twice"},
       {"<geom size=\"0.008\" fromto", "<geom type=\"mesh\" mesh=\"bone\" fromto", RDM_ERROR_NOT_FOUND,
        "line 31: geom: there is no mesh bone"},
       {"<geom size=\"0.008\" fromto=\"0 0 0.008 0 0 0.032\"/>", "<geom type=\"mesh\" mesh=\"bone\"/>",
        RDM_ERROR_NOT_FOUND, "line 31: geom: there is no mesh bone"},
       {"type=\"box\" size=\"0.045 0.015 0.05\"", "type=\"box\" size=\"0.045 0.015\"", RDM_ERROR_FORMAT,
        "line 26: geom palm_box: size: a box needs 3"},
       {"type=\"box\" size=\"0.045 0.015 0.05\"", "type=\"torus\" size=\"0.045 0.015 0.05\"",
        RDM_ERROR_UNSUPPORTED, "line 26: geom palm_box: type torus"},
       {"<include file=\"hand_drives.xml\"/>", "<include file=\"drives.xml\"/>", RDM_ERROR_NOT_FOUND,
        "line 71: include: "},
       {"<include file=\"hand_drives.xml\"/>",
        "<equality><connect body1=\"palm\" body2=\"thumb_distal\" anchor=\"0 0 0\"/></equality>",
        RDM_ERROR_UNSUPPORTED, "line 71: connect: connect closes a loop of bodies"},
       {"<include file=\"hand_drives.xml\"/>",
        "<equality><joint joint1=\"index_curl\" joint2=\"index_bend\" polycoef=\"0 1 2\"/></equality>",
        RDM_ERROR_UNSUPPORTED, "line 71: joint: polycoef"},
       {"<include file=\"hand_drives.xml\"/>", "<actuator><position joint=\"index_bond\"/></actuator>",
        RDM_ERROR_NOT_FOUND, "line 71: position: there is no joint index_bond; nearest is index_bend"},
       {"<include file=\"hand_drives.xml\"/>",
        "<actuator><position joint=\"index_bend\" ctrlrange=\"4 5\"/></actuator>", RDM_ERROR_RANGE,
        "line 30: joint index_bend: its actuator's range [4, 5]"},
       {"</worldbody>", "<body name=\"ball\"/></worldbody>", RDM_ERROR_ARGUMENT,
        "line 70: body ball: there are 2 bodies in the world: set config.root"},
       {"angle=\"degree\"", "angle=\"turn\"", RDM_ERROR_FORMAT,
        "line 3: compiler: angle: turn is neither degree nor radian"}});
}

TEST(Refusals, RobotText) {
  const std::string good = written(from_file("hand.urdf").def);
  const auto line = [&](const char* what) {
    return "line " + std::to_string(1 + std::count(good.begin(),
                                                   good.begin() + static_cast<long>(good.find(what)), '\n'));
  };
  const std::string
      stiff = line("kp = 4.0") + ": link index_proximal: kpp is not a known key; nearest is kp",
      kind = line("kind = \"hand\"") + ": kind: hant is unknown; nearest is hand",
      parent =
          line("parent = \"index_proximal\"") +
          ": link index_distal: parent: there is no link index_proxima before it; nearest is index_proximal",
      range = line("range = ") + ": link index_proximal: range is not a list of 2 numbers",
      shape = line("  [\"palm_box\", \"index_distal\"]") +
              ": pairs: there is no shape palm_bax; nearest is palm_box";
  expect_refusals(
      good, nullptr,
      {{"kp = 4.0", "kpp = 4.0", RDM_ERROR_FORMAT, stiff.c_str()},
       {"kind = \"hand\"", "kind = \"hant\"", RDM_ERROR_FORMAT, kind.c_str()},
       {"parent = \"index_proximal\"", "parent = \"index_proxima\"", RDM_ERROR_NOT_FOUND, parent.c_str()},
       {"range = [0.0, 1.5]", "range = [0.0]", RDM_ERROR_FORMAT, range.c_str()},
       {"[\"palm_box\", \"index_distal\"]", "[\"palm_bax\", \"index_distal\"]", RDM_ERROR_NOT_FOUND,
        shape.c_str()},
       {"format = 1", "format = 2", RDM_ERROR_VERSION_MISMATCH,
        "line 2: format: this library reads format 1 only"},
       {"range = [0.0, 1.5]", "range = [1.0, 1.0]", RDM_ERROR_RANGE,
        "robot plain_hand: index_bend: the range [1, 1] is empty"},
       {"name = \"plain_hand\"", "name = \"plain hand\"", RDM_ERROR_ARGUMENT, "a name is made of letters"},
       {"mass = 0.4", "mass = ", RDM_ERROR_FORMAT, "line "},
       {"[root]", "[roof]", RDM_ERROR_FORMAT, "roof is not a known key; nearest is root"}});
}

TEST(Refusals, OptionsOfTheCall) {
  const auto refused = [](const char* file, const rdm_import_config& o, rdm_result code, const char* text) {
    rdm_import* i = nullptr;
    EXPECT_EQ(rdm_import_read_file(&i, (kData + file).c_str(), &o), code) << text;
    EXPECT_NE(std::string(rdm_import_error()).find(text), std::string::npos) << rdm_import_error();
    rdm_import_destroy(i);
  };
  rdm_import_config o = import_config();
  o.tips = "index_tip,thum_distal";
  refused("hand.urdf", o, RDM_ERROR_NOT_FOUND,
          "config.tips: there is no link or site thum_distal; nearest is thumb_distal");
  o = import_config(), o.root = "nowhere";
  refused("hand.urdf", o, RDM_ERROR_NOT_FOUND, "config.root: there is no link nowhere");
  refused("hand.xml", o, RDM_ERROR_NOT_FOUND, "config.root: there is no body nowhere");
  o = import_config(), o.mount = "index_distal";
  refused("hand.urdf", o, RDM_ERROR_ARGUMENT, "config.mount: index_distal moves relative to the root");
  o = import_config(), o.format = 7;
  refused("hand.urdf", o, RDM_ERROR_RANGE, "config.format: 7 is outside [0, 3]");
  o = import_config(), o.struct_size = 3;
  refused("hand.urdf", o, RDM_ERROR_ARGUMENT, "config.struct_size: 3");
  o = import_config(), o.format = RDM_IMPORT_MJCF;
  refused("hand.urdf", o, RDM_ERROR_FORMAT, "this is not MJCF: the first element is not mujoco");
  o = import_config();
  refused("none.urdf", o, RDM_ERROR_NOT_FOUND, "none.urdf: cannot open");
  // A part of a tree, meshes that are not there, moments that are mended.
  o = import_config(), o.root = "head";
  EXPECT_EQ(from_file("gripper.urdf", &o).def.num_links, 2);
  std::string text = read("gripper.urdf");
  text.replace(text.find("izz=\"1e-5\""), 10, "izz=\"3e-5\"");
  o = import_config(), o.skip_meshes = 1, o.mend_inertia = 1;
  rdm_import* made = nullptr;
  ASSERT_EQ(rdm_import_read(&made, text.data(), text.size(), &o), RDM_OK) << rdm_import_error();
  const Import mended(made);
  EXPECT_EQ(mended.def.num_shapes, 1);
  EXPECT_TRUE(mended.has_note(
      RDM_NOTE_DROPPED,
      "line 50: mesh package://gripper_description/meshes/pad.obj: a text that is not from a file"));
  EXPECT_TRUE(mended.has_note(RDM_NOTE_CHANGED, "line 46: link jaw.a: principal moments"));
  EXPECT_NEAR(mended.def.links[1].moment[2], 4e-5, 1e-12);
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
TEST(Import, TakesTheNameThatTheConfigHadBefore) {
  rdm_import_options old;
  ASSERT_EQ(rdm_import_options_init(&old, sizeof old), RDM_OK);
  const rdm_import_config now = import_config();
  EXPECT_EQ(std::memcmp(&old, &now, sizeof now), 0);
  old.name = "renamed";
  EXPECT_STREQ(from_file("hand.urdf", &old).def.name, "renamed");
}
#pragma GCC diagnostic pop

TEST(Import, HandlesAndPointersAreChecked) {
  rdm_import* i = nullptr;
  EXPECT_EQ(rdm_import_read_file(nullptr, "x", nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_import_error(), "out is NULL");
  EXPECT_EQ(rdm_import_read_file(&i, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_read(&i, nullptr, 3, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_read(&i, "", 0, nullptr), RDM_ERROR_FORMAT);
  EXPECT_EQ(rdm_import_create_robot(&i, -1), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_import_get_robot_def(nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_check(nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_note_count(nullptr), 0);
  EXPECT_EQ(rdm_import_config_init(nullptr, 0), RDM_ERROR_ARGUMENT);
  rdm_import_destroy(nullptr);
  const Import good = from_file("hand.urdf");
  rdm_import_note note;
  EXPECT_EQ(rdm_import_note_at(good.handle, rdm_import_note_count(good.handle), &note), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_import_note_at(good.handle, 0, nullptr), RDM_ERROR_ARGUMENT);
  size_t size = 0;
  char small[4];
  EXPECT_EQ(rdm_import_write_robot(&good.def, small, sizeof small, &size), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_import_write_robot(&good.def, nullptr, 0, nullptr), RDM_ERROR_ARGUMENT);
  rdm_robot_def nameless = good.def;
  nameless.name = nullptr;
  EXPECT_EQ(rdm_import_write_robot(&nameless, nullptr, 0, &size), RDM_ERROR_ARGUMENT);
  std::vector<rdm_robot_link> links(good.def.links, good.def.links + good.def.num_links);
  rdm_robot_def altered = good.def;
  altered.links = links.data();
  EXPECT_EQ(rdm_import_write_robot(&altered, nullptr, 0, &size), RDM_OK);
  for (const double x : {std::nan(""), HUGE_VAL}) {
    links[0].kp = x;
    EXPECT_EQ(rdm_import_write_robot(&altered, nullptr, 0, &size), RDM_ERROR_ARGUMENT);
    EXPECT_STREQ(rdm_import_error(), "def: kp: a number is not finite");
  }
  altered = good.def;
  altered.summary = "\xff";
  EXPECT_EQ(rdm_import_write_robot(&altered, nullptr, 0, &size), RDM_ERROR_ARGUMENT);
  rdm_robot_def short_def = good.def;
  short_def.struct_size = 8;
  EXPECT_EQ(rdm_import_get_robot_def(good.handle, &short_def), RDM_ERROR_ARGUMENT);
}

// What breaks off anywhere is refused or read, and what is read can be made.
TEST(Import, AnyBeginningOfAFileIsSurvived) {
  for (const std::string& text : {read("hand.urdf"), read("arm.xml"), written(from_file("arm.xml").def)})
    for (size_t n = 0; n < text.size(); n += 7) {
      rdm_import* i = nullptr;
      if (rdm_import_read(&i, text.data(), n, nullptr) == RDM_OK) {
        const Import made(i);
        const Robot robot(made.def, "beginning");
      } else {
        EXPECT_NE(rdm_import_error()[0], 0);
      }
    }
}

}  // namespace
