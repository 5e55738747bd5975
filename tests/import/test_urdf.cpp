// URDF: what changes mass, pose, axis, range or coupling is read or refused by name; what gives links without
// inertial a mass; where meshes are looked for; names of any script.
#include <redman/import.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "imports.hpp"

namespace {

const std::string kInertial =
    "<inertial><mass value='0.5'/><inertia ixx='1e-3' iyy='1e-3' izz='1e-3' ixy='0' ixz='0' "
    "iyz='0'/></inertial>";
const std::string kBox = "<collision><geometry><box size='0.2 0.2 0.1'/></geometry></collision>";
const std::string kOrigin = "<origin xyz='0 0 0.1'/>";
const std::string kLimit = "<limit lower='-1' upper='1' effort='5' velocity='1'/>";

// A base and an arm on a hinge; the parts of a case in the place of these.
struct File {
  std::string before, base = kInertial, arm = kInertial, type = "revolute",
                      joint = kOrigin + "<axis xyz='1 0 0'/>" + kLimit, after;
  std::string text() const {
    return before + "<robot name='two'><link name='base'>" + base + "</link><link name='arm'>" + arm +
           "</link><joint name='j' type='" + type + "'><parent link='base'/><child link='arm'/>" + joint +
           "</joint>" + after + "</robot>";
  }
};
std::string with_joint(const std::string& joint) {
  File f;
  f.joint = joint;
  return f.text();
}
std::string with_arm(const std::string& arm) {
  File f;
  f.arm = arm;
  return f.text();
}
std::string with_more(const std::string& after) {
  File f;
  f.after = after;
  return f.text();
}

struct Folder {  // of a test, with files in it
  std::filesystem::path path;
  Folder() : path(std::filesystem::temp_directory_path() / ("redman_urdf_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string add(const std::string& name, const std::string& text) const {
    const auto file = path / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return file.string();
  }
};
// A tetrahedron with three edges of `side` along the axes.
std::string tetrahedron(double side, bool closed = true) {
  const std::string s = std::to_string(side);
  return "v 0 0 0\nv " + s + " 0 0\nv 0 " + s + " 0\nv 0 0 " + s + "\nf 1 3 2\nf 1 2 4\nf 1 4 3\n" +
         (closed ? "f 2 3 4\n" : "");
}

// ---- what is not known ----
TEST(Urdf, SlipsOfThePenAreRefusedWithTheNearestWord) {
  expect_refused(with_joint("<origin xyz='0 0 1' rrpy='0 1 0'/>" + kLimit), RDM_ERROR_UNSUPPORTED,
                 "origin: rrpy is not a known attribute here, and it could change the robot; nearest is rpy");
  expect_refused(with_joint("<axis xzy='0 0 1'/>" + kLimit), RDM_ERROR_UNSUPPORTED, "nearest is xyz");
  expect_refused(with_joint("<axis rpy='0 1 0' xyz='0 0 1'/>" + kLimit), RDM_ERROR_UNSUPPORTED, "axis: rpy");
  expect_refused(
      with_joint("<orgin xyz='0 0 1'/>" + kLimit), RDM_ERROR_UNSUPPORTED,
      "orgin: this is not a known element in joint, and it could change the robot; nearest is origin");
  expect_refused(with_joint(kLimit + "<mimik joint='k'/>"), RDM_ERROR_UNSUPPORTED, "nearest is mimic");
  expect_refused(with_joint("<limit lower='-1' uper='1'/>"), RDM_ERROR_UNSUPPORTED, "nearest is upper");
  expect_refused(with_arm("<inertail/>"), RDM_ERROR_UNSUPPORTED, "nearest is inertial");
  expect_refused(with_more("<lnk name='x'/>"), RDM_ERROR_UNSUPPORTED, "nearest is link");
  expect_refused(with_joint(kLimit + "<mimic joint='k' multipler='2'/>"), RDM_ERROR_UNSUPPORTED,
                 "nearest is multiplier");
}

TEST(Urdf, ElementsInTheWrongPlaceAreRefused) {
  expect_refused(with_more(kInertial), RDM_ERROR_FORMAT, "inertial: it must be in link, not in robot");
  expect_refused(
      with_arm("<collision><geometry><origin xyz='0 0 1'/><box size='1 1 1'/></geometry></collision>"),
      RDM_ERROR_FORMAT, "origin: it must be in collision, not in geometry");
  expect_refused(with_arm(kInertial + "<origin xyz='0 0 1'/>"), RDM_ERROR_FORMAT, "not in link");
  EXPECT_TRUE(from_text(with_arm(kInertial + "<origin xyz='0 0 0' rpy='0 0 0'/>"))
                  .has_note(RDM_NOTE_DROPPED, "origin"));
}

TEST(Urdf, SecondOnesAreRefusedUnlessTheySayTheSame) {
  expect_refused(with_joint(kOrigin + "<origin xyz='0 0 0.2'/>" + kLimit), RDM_ERROR_FORMAT,
                 "origin: there is already one in line 1");
  expect_refused(with_joint("<child link='base'/>" + kLimit), RDM_ERROR_FORMAT,
                 "child: there is already one");
  expect_refused(with_joint("<dynamics damping='1'/><dynamics damping='2'/>" + kLimit), RDM_ERROR_FORMAT,
                 "dynamics: there is already one");
}

// As in fingers of TriFinger Pro, whose tips have that of the simulation and that of the drawing.
TEST(Urdf, OfTwoInertialsTheFirstCounts) {
  std::string other = kInertial;
  other.replace(other.find("0.5"), 3, "0.6");
  const Import i = from_text(with_arm(kInertial + other)), twins = from_text(with_arm(kInertial + kInertial));
  EXPECT_EQ(i.def.links[0].mass, 0.5);
  EXPECT_TRUE(i.has_note(RDM_NOTE_CHANGED,
                         "link arm: its second inertial was ignored, as in ROS; the one of line 1 counts"));
  EXPECT_EQ(from_text(with_arm(other + kInertial)).def.links[0].mass, 0.6);
  EXPECT_EQ(twins.def.links[0].mass, 0.5);
  EXPECT_TRUE(twins.has_note(RDM_NOTE_CHANGED, "second inertial was ignored"));
  // What is passed over is looked at all the same.
  other.replace(other.find("<mass"), 5, "<mas");
  expect_refused(with_arm(kInertial + other), RDM_ERROR_UNSUPPORTED, "nearest is mass");
}

TEST(Urdf, ADampingThatHoldsAJointStillIsTheLargest) {
  const auto with_damping = [](const char* text) {
    return with_joint(kOrigin + kLimit + "<dynamics damping='" + text + "'/>");
  };
  const Import i = from_text(with_damping("1e11"));
  EXPECT_EQ(i.def.links[0].kd, 1e6);
  EXPECT_TRUE(
      i.has_note(RDM_NOTE_CHANGED, "damping 1e+11 was reduced to 1e+06, the largest that is allowed"));
  EXPECT_TRUE(from_text(with_damping("1e6")).notes(RDM_NOTE_CHANGED).empty());
  expect_refused(with_damping("-1"), RDM_ERROR_RANGE, "damping -1 or friction 0 is below 0");
  expect_refused(with_damping("1e31"), RDM_ERROR_RANGE, "damping: 1e31 is outside [-1e30, 1e30]");
}

TEST(Urdf, WhatClosesLoopsOrBendsIsRefused) {
  expect_refused(with_more("<loop_joint name='l'/>"), RDM_ERROR_UNSUPPORTED,
                 "loop_joint l: it closes a loop");
  expect_refused(with_more("<drake:joint name='l' type='ball'/>"), RDM_ERROR_UNSUPPORTED, "drake:joint l");
  expect_refused(with_joint(kLimit + "<drake:mimic joint='k'/>"), RDM_ERROR_UNSUPPORTED, "write it as mimic");
  expect_refused(with_arm(kInertial + "<fem/>"), RDM_ERROR_UNSUPPORTED, "deformable bodies");
}

TEST(Urdf, WordsOfOtherProgramsAreDroppedAndListed) {
  const Import i = from_text(with_more(
      "<gazebo reference='arm'><mu1>1</mu1></gazebo><transmission name='t'/><drake:collision_filter_group "
      "name='g'/><mujoco><compiler meshdir='meshes' balanceinertia='true'/></mujoco>"));
  for (const char* text : {"gazebo", "transmission t", "drake:collision_filter_group g", "mujoco"})
    EXPECT_TRUE(i.has_note(RDM_NOTE_DROPPED, text)) << text;
  expect_refused(with_more("<mujoco><compiler settotalmass='14'/></mujoco>"), RDM_ERROR_UNSUPPORTED,
                 "settotalmass=\"14\" would change masses");
  EXPECT_EQ(from_text(with_more("<mujoco><compiler settotalmass='-1'/></mujoco>")).def.links[0].mass, 0.5);
}

// ---- numbers ----
TEST(Urdf, NoNumberAndTooLargeANumberAreTwoReasons) {
  expect_refused(with_joint("<origin xyz='0 0 1e16'/>" + kLimit), RDM_ERROR_RANGE,
                 "xyz: 0 0 1e16 is outside [-1e9, 1e9]");
  expect_refused(with_joint("<origin xyz='0 0 inf'/>" + kLimit), RDM_ERROR_RANGE, "xyz: 0 0 inf is outside");
  expect_refused(with_joint("<origin xyz='0 0 1,5.5.5'/>" + kLimit), RDM_ERROR_FORMAT, "is not a number");
  expect_refused(with_joint("<origin xyz='0 0 1e999'/>" + kLimit), RDM_ERROR_RANGE, "is outside");
  EXPECT_EQ(from_text(with_joint("<origin xyz='0 0 1e-999'/>" + kLimit)).def.links[0].pose.p[2], 0);
}

TEST(Urdf, ABoundThatIsNoneIsNone) {
  for (const char* far : {"1e16", "inf", "1.1e9", "3.4028234663852886e+38", "1.7976931348623157e+308"}) {
    const Import i = from_text(with_joint("<limit lower='-" + std::string(far) + "' upper='0.5' effort='" +
                                          far + "' velocity='" + far + "'/>"));
    EXPECT_DOUBLE_EQ(i.def.links[0].lower, -2 * M_PI);
    EXPECT_DOUBLE_EQ(i.def.links[0].upper, 0.5);
    EXPECT_EQ(i.def.links[0].velocity, 0);
    EXPECT_TRUE(i.has_note(RDM_NOTE_CHANGED, "joint j: lower -" + std::string(far) +
                                                 " means no limit, and was replaced by -6.28319"));
    EXPECT_TRUE(i.has_note(RDM_NOTE_CHANGED, "effort"));
    EXPECT_TRUE(i.has_note(RDM_NOTE_GUESSED, "joint j: effort"));
  }
  expect_refused(with_joint("<limit lower='nan' upper='0.5' effort='1' velocity='1'/>"), RDM_ERROR_FORMAT,
                 "lower: nan is not a number");
  File slide;
  slide.type = "prismatic", slide.joint = "<limit lower='-inf' upper='inf' effort='1' velocity='1'/>";
  rdm_import_config o = import_config();
  o.slide_range = 3;
  EXPECT_EQ(from_text(slide.text(), &o).def.links[0].lower, -3);
  EXPECT_DOUBLE_EQ(from_text(slide.text()).def.links[0].upper, 2 * M_PI);
}

TEST(Urdf, ShapesOfNoSizeAreDropped) {
  for (const char* shape : {"<sphere radius='0'/>", "<box size='0 0 0'/>"}) {
    const Import i = from_text(
        with_arm(kInertial + "<collision><geometry>" + std::string(shape) + "</geometry></collision>"));
    EXPECT_EQ(i.def.num_shapes, 0);
    EXPECT_TRUE(i.has_note(RDM_NOTE_DROPPED, "link arm: a ")) << shape;
  }
  expect_refused(with_arm(kInertial + "<collision><geometry><box size='0 1 1'/></geometry></collision>"),
                 RDM_ERROR_RANGE, "size 0 is not above 0");
}

TEST(Urdf, FilesThatAreNoXmlSaySo) {
  const Folder folder;
  rdm_import* i = nullptr;
  EXPECT_EQ(rdm_import_read_file(&i, folder.add("a.urdf", "hand = 1\n").c_str(), nullptr), RDM_ERROR_FORMAT);
  EXPECT_NE(std::string(rdm_import_error()).find("line 1: this is not XML"), std::string::npos)
      << rdm_import_error();
}

TEST(Urdf, NegativeNumbersAreSaidOrRefused) {
  const Import i = from_text(with_joint("<limit lower='-1' upper='1' effort='-1' velocity='-1'/>"));
  EXPECT_EQ(i.def.links[0].velocity, 0);
  EXPECT_TRUE(i.has_note(RDM_NOTE_CHANGED, "joint j: velocity -1 is not a bound, and was ignored"));
  EXPECT_TRUE(i.has_note(RDM_NOTE_GUESSED, "joint j: effort"));
  EXPECT_TRUE(from_text(with_joint("<limit lower='-1' upper='1' effort='0' velocity='1'/>"))
                  .has_note(RDM_NOTE_CHANGED, "joint j: effort 0 means none"));
  expect_refused(with_joint(kLimit + "<dynamics damping='-1'/>"), RDM_ERROR_RANGE,
                 "damping -1 or friction 0 is below 0");
  expect_refused(with_joint("<origin xyz='0 0 1' xyz='0 0 2'/>" + kLimit), RDM_ERROR_FORMAT,
                 "an attribute that is not name=\"value\", or occurs twice");
}

TEST(Urdf, TurnsByQuaternionAndMirroredMomentsAreRead) {
  const Import i = from_text(with_joint("<origin xyz='0 0 1' quat_xyzw='0 0 2 0'/>" + kLimit));
  EXPECT_NEAR(std::abs(i.def.links[0].pose.q[2]), 1, 1e-12);
  expect_refused(with_joint("<origin rpy='0 0 0' quat_xyzw='0 0 1 0'/>" + kLimit), RDM_ERROR_FORMAT,
                 "it has both rpy and quat_xyzw");
  const auto moments = [](const char* iyx) {
    return with_arm(
        "<inertial><mass value='1'/><inertia ixx='1e-3' iyy='1e-3' izz='1e-3' ixy='1e-4' ixz='0' "
        "iyz='0' iyx='" +
        std::string(iyx) + "'/></inertial>");
  };
  EXPECT_DOUBLE_EQ(from_text(moments("1e-4")).def.links[0].moment[3], 1e-4);
  expect_refused(moments("2e-4"), RDM_ERROR_FORMAT, "link arm: iyx is not ixy");
}

// ---- masses ----
TEST(Urdf, ADensityWeighsLinksWithoutInertial) {
  expect_refused(with_arm(kBox), RDM_ERROR_RANGE, "link arm: it moves, but has no mass; set config.density");
  rdm_import_config o = import_config();
  o.density = 500;
  const Import i = from_text(with_arm("<collision><origin xyz='0 0 0.3'/><geometry><box size='0.2 0.2 0.1'/>"
                                      "</geometry></collision>"),
                             &o);
  EXPECT_DOUBLE_EQ(i.def.links[0].mass, 2);
  EXPECT_DOUBLE_EQ(i.def.links[0].com[2], 0.3);
  EXPECT_NEAR(i.def.links[0].moment[0], 2 * (0.04 + 0.01) / 12, 1e-12);
  EXPECT_DOUBLE_EQ(i.def.root_mass, 0.5);  // it says its mass
  EXPECT_TRUE(i.has_note(RDM_NOTE_GUESSED, "link arm: mass 2 kg, from its shapes at 500 kg/m3"));
  expect_refused(with_arm(""), RDM_ERROR_RANGE, "link arm: it moves, but has no mass",
                 &o);  // nothing to weigh
  // Isaac Gym's: a density of the link itself.
  EXPECT_DOUBLE_EQ(
      from_text(with_arm("<inertial><density value='250'/></inertial>" + kBox)).def.links[0].mass, 1);
  for (const double wrong : {-1.0, 1e6, double(NAN)}) {
    o.density = wrong;
    expect_refused(with_arm(kBox), RDM_ERROR_RANGE, "config.density", &o);
  }
}

TEST(Urdf, ADensityFillsMeshes) {
  const Folder folder;
  folder.add("closed.obj", tetrahedron(0.3));
  folder.add("open.obj", tetrahedron(0.3, false));
  const auto mass = [&](const std::string& mesh) {
    rdm_import_config o = import_config();
    o.density = 1000;
    return from_path(folder.add("a.urdf", with_arm("<collision><geometry><mesh filename='" + mesh +
                                                   "'/></geometry></collision>")),
                     &o)
        .def.links[0]
        .mass;
  };
  EXPECT_NEAR(mass("closed.obj"), 1000 * 0.027 / 6, 1e-9);
  EXPECT_NEAR(mass("open.obj"), 1000 * 0.027 / 6, 1e-9);                       // its hull
  EXPECT_NEAR(mass("closed.obj' scale='-1 2 1"), 2 * 1000 * 0.027 / 6, 1e-9);  // mirrored, longer
}

// Round parts with fine chamfers, as programs for drawing write them: many corners in one plane up to
// rounding, and slivers between them.
TEST(Urdf, HullsOfChamferedPartsAreRight) {
  const Folder folder;
  const int n = 64;
  for (const double size : {1.0, 0.1, 1e-3}) {
    std::string text;
    for (const auto& [r, z] : {std::pair{1.0, 0.0}, {1.0, 1.0}, {0.99999, 1.00001}, {0.9999, 1.0001}})
      for (int k = 0; k < n; ++k) {
        char line[96];
        std::snprintf(line, sizeof line, "v %.8g %.8g %.8g\n", size * r * std::cos(2 * M_PI * k / n),
                      size * r * std::sin(2 * M_PI * k / n), size * z);
        text += line;
      }
    folder.add("rod.obj", text + "f 1 2 3\n");  // open
    rdm_import_config o = import_config();
    o.density = 1000;
    const Import i = from_path(
        folder.add("a.urdf",
                   with_arm("<collision><geometry><mesh filename='rod.obj'/></geometry></collision>")),
        &o);
    const double mass = 1000 * n / 2.0 * std::sin(2 * M_PI / n) * size * size * size;
    EXPECT_NEAR(i.def.links[0].mass, mass, 1e-3 * mass);
    EXPECT_NEAR(i.def.links[0].com[2], size / 2, 1e-3 * size);
    EXPECT_NEAR(i.def.links[0].moment[2], mass * size * size / 2, 5e-3 * mass * size * size);
  }
}

// Hulls of many round meshes are work that a file of some kB could ask for.
TEST(Urdf, HullsDrawOnTheBudget) {
  const Folder folder;
  std::string mesh, text = "<robot name='many'><link name='l0'>" + kInertial + "</link>";
  for (int k = 0; k < 4000; ++k) {  // a spiral on a sphere
    const double z = (k + 0.5) / 2000 - 1, r = std::sqrt(1 - z * z);
    mesh += "v " + std::to_string(r * std::cos(2.4 * k)) + ' ' + std::to_string(r * std::sin(2.4 * k)) + ' ' +
            std::to_string(z) + '\n';
  }
  folder.add("ball.obj", mesh + "f 1 2 3\n");
  for (int k = 1; k <= 60; ++k) {
    const std::string n = std::to_string(k), before = std::to_string(k - 1);
    text += "<link name='l" + n +
            "'><collision><geometry><mesh filename='ball.obj'/></geometry></collision></link>" +
            "<joint name='j" + n + "' type='revolute'><parent link='l" + before + "'/><child link='l" + n +
            "'/>" + kLimit + "</joint>";
  }
  rdm_import_config o = import_config();
  o.density = 1000;
  rdm_import* i = nullptr;
  EXPECT_EQ(rdm_import_read_file(&i, folder.add("many.urdf", text + "</robot>").c_str(), &o),
            RDM_ERROR_RANGE);
  EXPECT_NE(std::string(rdm_import_error()).find("steps of work in one import"), std::string::npos)
      << rdm_import_error();
  rdm_import_destroy(i);
}

TEST(Urdf, FixedLinksMayHaveMomentsAlone) {
  const std::string moments =
      "<inertial><mass value='0'/><inertia ixx='0.1' iyy='0.1' izz='0.1'/></inertial>";
  File f;
  f.after = "<link name='flange'>" + moments +
            "</link><joint name='k' type='fixed'><parent link='arm'/><child link='flange'/></joint>";
  const Import i = from_text(f.text());
  EXPECT_DOUBLE_EQ(i.def.links[0].mass, 0.5);
  EXPECT_NEAR(i.def.links[0].moment[0], 0.101, 1e-12);
  EXPECT_TRUE(i.has_note(RDM_NOTE_CHANGED,
                         "link flange has no mass; its moments of inertia were added to its parent's"));
  expect_refused(with_arm(moments), RDM_ERROR_RANGE, "link arm: the mass 0 is not above 0");
}

TEST(Urdf, TheRootMayBeAPoint) {
  File f;
  f.base = "<inertial><mass value='3'/><inertia ixx='0' iyy='0' izz='0'/></inertial>";
  const Import i = from_text(f.text());
  EXPECT_EQ(i.def.root_mass, 3);
  EXPECT_NEAR(i.def.root_moment[0], 3 * 0.4 * 1e-4, 1e-12);
  EXPECT_TRUE(i.has_note(RDM_NOTE_GUESSED,
                         "the root: it got the moments of inertia of a ball with a radius of 0.01 m"));
  f.base = "<inertial><mass value='0'/><inertia ixx='1' iyy='1' izz='1'/></inertial>";
  EXPECT_TRUE(from_text(f.text()).has_note(RDM_NOTE_DROPPED,
                                           "the root's moments of inertia were dropped, as it has no mass"));
}

// ---- text ----
TEST(Urdf, XacroIsNamedWhereverItStands) {
  const char* words = "xacro is not read; expand the file with the xacro tool first";
  expect_refused(with_arm(kInertial + "<xacro:insert_block name='x'/>"), RDM_ERROR_UNSUPPORTED, words);
  expect_refused(with_joint("<origin xyz='0 0 ${height}'/>" + kLimit), RDM_ERROR_UNSUPPORTED, words);
  expect_refused(with_joint("<origin xyz='$(optenv XYZ 0 0 0)'/>" + kLimit), RDM_ERROR_UNSUPPORTED, words);
  expect_refused(
      with_arm(kInertial +
               "<collision><geometry><mesh filename='$(find hand)/a.stl'/></geometry></collision>"),
      RDM_ERROR_UNSUPPORTED, words);
  EXPECT_EQ(from_text("<robot xmlns:xacro='http://ros.org/wiki/xacro'" + with_arm(kInertial).substr(6))
                .def.num_links,
            1);
}

TEST(Urdf, DoctypesAndXmlErrorsSayWhatIsWrong) {
  File f;
  f.before = "<!DOCTYPE robot [<!ENTITY h '0.3'>]>\n";
  expect_refused(f.text(), RDM_ERROR_UNSUPPORTED, "line 1: DOCTYPE: entities");
  f.before = "<?xml version='1.0'?>\n<!-- hand -->\n<!DOCTYPE robot SYSTEM 'robot.dtd'>";
  expect_refused(f.text(), RDM_ERROR_UNSUPPORTED, "line 3: DOCTYPE");
  f.before = "<!DOCTYPE robot>";
  EXPECT_EQ(from_text(f.text()).def.num_links, 1);
  f.before = "<!-- licence -->\n<?xml version='1.0'?>";
  EXPECT_EQ(from_text(f.text()).def.num_links, 1);
  expect_refused(with_more("<?xml version='1.0'?>"), RDM_ERROR_FORMAT,
                 "this is not XML: the declaration <?xml ...?> must come first in the file");
  expect_refused("<robot name='x'><link name='a'></robot>", RDM_ERROR_FORMAT,
                 "this is not XML: an element that is closed by the end of another one");
  expect_refused("<!-- a -->\n -->\n<mujoco><worldbody/></mujoco>", RDM_ERROR_FORMAT,
                 "line 3: mujoco: there is no body");  // no .robot file
  expect_refused("<robot name=x>", RDM_ERROR_FORMAT,
                 "this is not XML: an attribute that is not name=\"value\"");
}

// ---- meshes ----
TEST(Urdf, MeshesAreFoundByTheirWholeNameBeforeAPartOfIt) {
  const Folder folder;
  folder.add("ws/hand/meshes/a.obj", tetrahedron(0.3));
  folder.add("ws/hand/robots/meshes/a.obj", tetrahedron(0.1));  // nearer, but of no package
  const auto read = [&](const std::string& mesh) {
    return from_path(folder.add(
        "ws/hand/robots/a.urdf",
        with_arm(kInertial + "<collision><geometry><mesh filename='" + mesh + "'/></geometry></collision>")));
  };
  const Import whole = read("package://hand/meshes/a.obj");
  ASSERT_EQ(whole.def.num_shapes, 1);
  EXPECT_NEAR(whole.def.shapes[0].size[0], 0.15, 0.15);
  EXPECT_FALSE(whole.has_note(RDM_NOTE_CHANGED, "no folder hand"));
  const Import part = read("package://other/meshes/a.obj");
  EXPECT_LT(part.def.shapes[0].size[0], whole.def.shapes[0].size[0]);
  EXPECT_TRUE(part.has_note(RDM_NOTE_CHANGED,
                            "mesh package://other/meshes/a.obj: there is no folder other with it; "));
  const Import windows = read("..\\meshes\\a.obj");
  EXPECT_EQ(windows.def.shapes[0].size[0], whole.def.shapes[0].size[0]);
  EXPECT_TRUE(windows.has_note(RDM_NOTE_CHANGED, "\\ was read as /"));
}

TEST(Urdf, MeshesOfOtherSystemsAreReadAndBrokenOnesSayWhy) {
  const Folder folder;
  const auto shape = [&](const std::string& name, const std::string& bytes) {
    folder.add(name, bytes);
    return folder.add("a.urdf", with_arm(kInertial + "<collision><geometry><mesh filename='" + name +
                                         "'/></geometry></collision>"));
  };
  const auto refused = [&](const std::string& name, const std::string& bytes, const std::string& words) {
    rdm_import* i = nullptr;
    EXPECT_EQ(rdm_import_read_file(&i, shape(name, bytes).c_str(), nullptr), RDM_ERROR_FORMAT) << words;
    EXPECT_NE(std::string(rdm_import_error()).find(words), std::string::npos) << rdm_import_error();
    rdm_import_destroy(i);
  };
  const auto facets = [](uint8_t said, size_t there) {
    return std::string(80, 'x') + std::string{static_cast<char>(said), 0, 0, 0} +
           std::string(50 * there, '\0');
  };
  refused("a.stl", facets(2, 1), "its header says 2 facets, which are 184 bytes, but it has 134 bytes");
  refused("a.stl", facets(1, 1) + "behind",
          "its header says 1 facets, which are 134 bytes, but it has 140 bytes");
  refused("a.stl", facets(0, 0), "its header says 0 facets");
  refused("a.stl", "solid a\nendsolid a\n", "it has no corners");
  const std::string text =
      "SOLID a\rFACET NORMAL 0 0 1\rOUTER LOOP\rVERTEX 0 0 0\rVERTEX 0.2 0 0\rVERTEX 0 0.2 0\rENDLOOP\r"
      "ENDFACET\rENDSOLID a\r";
  EXPECT_EQ(from_path(shape("a.stl", text)).def.num_shapes, 1);
  EXPECT_EQ(from_path(shape("a.obj", "\xef\xbb\xbf" + tetrahedron(0.3))).def.num_shapes, 1);
  refused("a.stl", "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n",
          "a pointer of Git LFS");
  refused("a.obj", "v 0 0 0\r\nv 1 0\r\n", "line 2: a corner needs three numbers");
}

// ---- names ----
TEST(Urdf, NamesOfAnyScriptKeepReadableIds) {
  const std::vector<std::pair<const char*, const char*>> names{{"рука_левая", "ruka_levaya"},
                                                               {"Щит", "Shchit"},
                                                               {"てくび", "tekubi"},
                                                               {"ハンド", "hando"},
                                                               {"손가락", "songarak"},
                                                               {"χέρι", "cheri"},
                                                               {"Daumen_übersetzt", "Daumen_ubersetzt"},
                                                               {"手", "u624b"},
                                                               {"główna", "glowna"},
                                                               {"l finger/1", "l_finger_1"}};
  for (const auto& [name, id] : names) {
    std::string text = File().text();
    for (size_t at = 0; (at = text.find("'arm'", at)) != std::string::npos;)
      text.replace(at, 5, "'" + std::string(name) + "'");
    const Import i = from_text(text);
    EXPECT_STREQ(i.def.links[0].name, id);
    EXPECT_TRUE(i.has_note(RDM_NOTE_CHANGED, std::string("link ") + name + " was renamed to " + id));
  }
}

// ---- options ----
TEST(Urdf, OptionsOfOlderCallersAreTaken) {
  rdm_import_config o = import_config();
  o.struct_size = offsetof(rdm_import_config, density);
  o.density = -1;  // beyond what the caller knows
  EXPECT_EQ(from_text(File().text(), &o).def.num_links, 1);
}

}  // namespace
