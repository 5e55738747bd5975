// MJCF: what changes mass, pose, axis, range or coupling is read or refused by name.
#include <redman/import.h>

#include <cmath>
#include <string>
#include <vector>

#include "imports.hpp"

namespace {

// A base that stands still, and what the case puts into the file.
std::string file(const std::string& base, const std::string& before = "", const std::string& after = "") {
  return "<mujoco model='m'>" + before + "<worldbody><body name='base'>" +
         "<geom type='box' size='.05 .05 .05' mass='1'/>" + base + "</body></worldbody>" + after +
         "</mujoco>";
}
std::string arm(const std::string& inside, const std::string& joint = "") {
  return "<body name='arm'><joint name='j' " + (joint.empty() ? "axis='0 1 0' range='-90 90'" : joint) +
         "/>" + inside + "</body>";
}
const std::string kRod = "<geom type='capsule' size='.01 .1' mass='.1'/>";

// Links in a row, each with a hinge j0, j1, ... about x from 0 to 1 rad.
std::string chain(int count, const std::string& after) {
  std::string inside;
  for (int k = count; k-- > 0;)
    inside = "<body name='b" + std::to_string(k) + "' pos='0 0 .1'><joint name='j" + std::to_string(k) +
             "' axis='1 0 0' range='0 1'/><geom type='capsule' size='.01 .02' pos='0 0 .04' mass='.1'/>" +
             inside + "</body>";
  return file(inside, "<compiler angle='radian'/>", after);
}
struct Coupled {
  std::string follower, leader;
  double ratio, slack;
};
void expect_couplings(const Import& i, const std::vector<Coupled>& all) {
  ASSERT_EQ(i.def.num_couplings, static_cast<int32_t>(all.size()));
  for (size_t k = 0; k < all.size(); ++k) {
    const rdm_robot_coupling& c = i.def.couplings[k];
    EXPECT_EQ(i.def.links[c.link].joint, all[k].follower);
    EXPECT_EQ(i.def.links[c.other].joint, all[k].leader);
    EXPECT_NEAR(c.ratio, all[k].ratio, 1e-9);
    EXPECT_NEAR(c.slack, all[k].slack, 1e-9);
  }
}

// ---- poses ----
TEST(Mjcf, FramesTurnAndShiftWhatStandsInThem) {
  const Import i = from_text(file(
      "<body name='arm' pos='0 0 .1'><frame pos='0 0 .2' euler='0 90 0'>"
      "<frame pos='0 .1 0'><joint name='j' axis='0 0 1' pos='0 0 .5' range='-90 90'/>" +
      kRod + "<body name='tip' pos='.3 0 0'><geom size='.02' mass='.2'/></body></frame></frame></body>"));
  const rdm_robot_link& l = i.def.links[0];
  EXPECT_NEAR(l.axis[0], 1, 1e-12);  // z of the frame is x of the body
  EXPECT_NEAR(l.pose.p[0], 0.5, 1e-12);
  EXPECT_NEAR(l.pose.p[1], 0.1, 1e-12);
  EXPECT_NEAR(l.pose.p[2], 0.1 + 0.2, 1e-12);
  // The rod and the ball 0.3 m down the frame's x, which is the body's -z.
  EXPECT_NEAR(l.mass, 0.3, 1e-12);
  EXPECT_NEAR(l.com[0], -0.5, 1e-12);
  EXPECT_NEAR(l.com[2], -0.2, 1e-12);
}

TEST(Mjcf, FramesOfTheWorldHoldTheRoot) {
  const Import i = from_text(
      "<mujoco><worldbody><frame pos='1 0 0' euler='0 0 90'><body name='cart' pos='0 1 0'>"
      "<joint name='j' type='slide' axis='1 0 0' range='-1 1'/><geom size='.1'/></body></frame>"
      "</worldbody></mujoco>");
  EXPECT_NEAR(i.def.links[0].pose.p[0], 0, 1e-12);
  EXPECT_NEAR(i.def.links[0].pose.q[2], std::sqrt(0.5), 1e-12);
}

TEST(Mjcf, HalfATurnOfZaxisIsAboutX) {
  const Import i =
      from_text(file("<body name='arm' zaxis='0 0 -2'><joint name='j' range='-90 90'/>" + kRod + "</body>"));
  EXPECT_NEAR(std::abs(i.def.links[0].pose.q[0]), 1, 1e-12);
}

TEST(Mjcf, AnElementsOwnTurnGoesBeforeThatOfItsClass) {
  const Import i = from_text(file(arm("<geom type='box' size='.01 .02 .03' euler='0 0 90' mass='1'/>"),
                                  "<default><geom quat='0 1 0 0'/></default>"));
  EXPECT_NEAR(i.def.links[0].moment[0], (0.01 * 0.01 + 0.03 * 0.03) / 3, 1e-12);  // x and y change places
}

// ---- ranges ----
TEST(Mjcf, RangesHoldWhereTheySaySo) {
  struct Row {
    const char* joint;
    double lower, upper;
    const char* compiler;
  };
  for (const Row& r :
       {Row{"range='-90 90'", -M_PI / 2, M_PI / 2, ""}, Row{"range='0 0'", -2 * M_PI, 2 * M_PI, ""},
        Row{"range='-90 90' limited='false'", -2 * M_PI, 2 * M_PI, ""},
        Row{"range='-90 90' limited='true'", -M_PI / 2, M_PI / 2, "<compiler autolimits='false'/>"},
        Row{"type='slide' range='-.2 .3'", -0.2, 0.3, ""},
        Row{"type='slide' axis='1 0 0'", -2 * M_PI, 2 * M_PI, ""}}) {
    SCOPED_TRACE(r.joint);
    const Import i = from_text(file(arm(kRod, r.joint), r.compiler));
    EXPECT_DOUBLE_EQ(i.def.links[0].lower, r.lower);
    EXPECT_DOUBLE_EQ(i.def.links[0].upper, r.upper);
    EXPECT_EQ(i.has_note(RDM_NOTE_CHANGED, "without limits"), r.upper > 6);
  }
  expect_refused(file(arm(kRod, "range='-90 90'"), "<compiler autolimits='false'/>"), RDM_ERROR_FORMAT,
                 "joint j: it has a range but no limited, and autolimits is false");
  expect_refused(file(arm(kRod, "range='0 0' limited='true'")), RDM_ERROR_RANGE,
                 "joint j: the range [0, 0] is empty");
}

// ---- masses ----
// As in Fetch's base, which slides nowhere by it.
TEST(Mjcf, ADampingThatHoldsAJointStillIsTheLargest) {
  const Import i = from_text(file(arm(kRod, "type='slide' range='-1 1' damping='1e11'")));
  EXPECT_TRUE(i.has_note(RDM_NOTE_CHANGED,
                         "joint j: damping 1e+11 was reduced to 1e+06, the largest that is allowed"));
  EXPECT_EQ(i.def.links[0].kd, 1e6);
}

TEST(Mjcf, GeomsHaveMassByGroupMassAndDensity) {
  const double volume = 8 * 0.01 * 0.02 * 0.03;
  struct Row {
    const char *geom, *compiler;
    double mass;
  };
  for (const Row& r :
       {Row{"", "", 1000 * volume}, Row{"density='500'", "", 500 * volume},
        Row{"mass='.3' density='500'", "", 0.3}, Row{"group='2'", "<compiler inertiagrouprange='3 3'/>", 0},
        Row{"mass='0'", "", 0}, Row{"density='0'", "", 0},
        Row{"contype='0' conaffinity='0'", "", 1000 * volume},
        Row{"contype='0' conaffinity='0'", "<compiler discardvisual='true'/>", 1000 * volume},
        Row{"class='light'", "<default><default class='light'><geom density='100'/></default></default>",
            100 * volume}}) {
    SCOPED_TRACE(std::string(r.geom) + r.compiler);
    const Import i =
        from_text(file(arm("<geom size='.05' mass='2' group='3'/><geom type='box' size='.01 .02 .03' " +
                           std::string(r.geom) + "/>"),
                       r.compiler));
    EXPECT_NEAR(i.def.links[0].mass, 2 + r.mass, 1e-12);
  }
}

TEST(Mjcf, TheTotalMassOfAllBodiesIsSet) {
  const std::string text =
      file(arm("<geom size='.05' mass='.4'/>") + "<body name='other'><geom size='.1' mass='.6'/></body>",
           "<compiler settotalmass='20'/>");
  const Import i = from_text(text);
  EXPECT_NEAR(i.def.links[0].mass, 4, 1e-12);
  EXPECT_NEAR(i.def.root_mass, 16, 1e-12);
  EXPECT_NEAR(i.def.links[0].moment[0], 0.4 * 4 * 0.05 * 0.05, 1e-12);
  EXPECT_TRUE(
      i.has_note(RDM_NOTE_CHANGED, "all masses were scaled by 10 to a total of 20 kg (settotalmass)"));
  // Also of the bodies that options.root leaves out.
  rdm_import_config o = import_config();
  o.root = "arm";
  EXPECT_NEAR(from_text(text, &o).def.links[0].mass, 4, 1e-12);
}

TEST(Mjcf, BoundsOfMassesAreOfPrincipalMoments) {
  // Moments 1, 2, 2.5 (e-3) turned about z by 45 degrees.
  const std::string body =
      arm("<inertial pos='0 0 .1' mass='.01' fullinertia='1.5e-3 1.5e-3 2.5e-3 -.5e-3 0 0'/>");
  const Import bound = from_text(file(body, "<compiler boundmass='.05' boundinertia='2e-3'/>"));
  EXPECT_DOUBLE_EQ(bound.def.links[0].mass, 0.05);
  EXPECT_NEAR(bound.def.links[0].moment[0], 2e-3, 1e-15);
  EXPECT_NEAR(bound.def.links[0].moment[2], 2.5e-3, 1e-15);
  EXPECT_NEAR(bound.def.links[0].moment[3], 0, 1e-15);
  const std::string wrong = arm("<inertial pos='0 0 .1' mass='1' diaginertia='1e-3 1e-3 4e-3'/>");
  expect_refused(file(wrong), RDM_ERROR_ARGUMENT, "violate the triangle inequality");
  EXPECT_NEAR(from_text(file(wrong, "<compiler balanceinertia='true'/>")).def.links[0].moment[2], 2e-3,
              1e-15);
  // A body without any mass gets the least, where its own frame stands in what carries it.
  const Import least = from_text(file("<body name='arm' pos='.1 0 0'><joint name='j' range='-90 90'/></body>",
                                      "<compiler boundmass='.1' boundinertia='1e-3'/>"));
  EXPECT_DOUBLE_EQ(least.def.links[0].mass, 0.1);
  EXPECT_DOUBLE_EQ(least.def.links[0].com[0], 0.1);
}

TEST(Mjcf, InertiaComesFromGeomsWhereTheCompilerSaysSo) {
  const std::string both =
      arm("<inertial pos='0 0 .2' mass='3' diaginertia='.1 .1 .1'/><geom size='.1' mass='.5'/>");
  EXPECT_DOUBLE_EQ(from_text(file(both)).def.links[0].mass, 3);
  EXPECT_DOUBLE_EQ(from_text(file(both, "<compiler inertiafromgeom='true'/>")).def.links[0].mass, 0.5);
  EXPECT_DOUBLE_EQ(from_text(file(both, "<compiler inertiafromgeom='false'/>")).def.links[0].mass, 3);
  expect_refused(file(arm(kRod), "<compiler inertiafromgeom='false'/>"), RDM_ERROR_RANGE,
                 "body arm: it moves but has no inertial, and inertiafromgeom is false");
}

TEST(Mjcf, FixedBodiesMayHaveNoMass) {
  const std::string mount =
      "<body name='mount'><inertial pos='0 0 .05' mass='0' diaginertia='0 0 0'/>" + arm(kRod) + "</body>";
  const Import i = from_text(file(mount));
  EXPECT_DOUBLE_EQ(i.def.root_mass, 1);
  EXPECT_TRUE(i.has_note(RDM_NOTE_CHANGED, "body mount has no mass"));
  // Moments without mass are those of what carries them.
  const Import with = from_text(
      file(arm(kRod + "<body name='tool'><inertial pos='0 0 .05' mass='0' diaginertia='.1 .1 .1'/></body>")));
  const Import without = from_text(file(arm(kRod)));
  EXPECT_NEAR(with.def.links[0].moment[0], without.def.links[0].moment[0] + 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(with.def.links[0].mass, 0.1);
  expect_refused(file(arm("<inertial pos='0 0 0' mass='0' diaginertia='1 1 1'/>")), RDM_ERROR_RANGE,
                 "body arm: the mass 0 is not above 0");
  expect_refused(file(arm("<inertial pos='0 0 0' mass='0' diaginertia='0 0 0'/>")), RDM_ERROR_RANGE,
                 "it moves, but has no mass");
}

TEST(Mjcf, ShellsHaveTheMassOfTheirSurface) {
  struct Row {
    const char* size;
    double area, x, z;  // moments per mass
  };
  const auto made = [&](const std::string& size) {
    return from_text(file(arm("<geom " + size + " shellinertia='true' density='10'/>")));
  };
  const double r = 0.1, h = 0.2;
  for (const Row& row :
       {Row{"size='.1'", 4 * M_PI * r * r, 2.0 / 3 * r * r, 2.0 / 3 * r * r},
        // A cube: faces across and along each axis.
        Row{"type='box' size='.1 .1 .1'", 24 * r * r, 10.0 / 9 * r * r, 10.0 / 9 * r * r},
        // An ellipsoid that is a ball.
        Row{"type='ellipsoid' size='.1 .1 .1'", 4 * M_PI * r * r, 2.0 / 3 * r * r, 2.0 / 3 * r * r}}) {
    SCOPED_TRACE(row.size);
    const Import i = made(row.size);
    EXPECT_NEAR(i.def.links[0].mass, 10 * row.area, 1e-9);
    EXPECT_NEAR(i.def.links[0].moment[0], 10 * row.area * row.x, 2e-5 * row.area);
    EXPECT_NEAR(i.def.links[0].moment[2], 10 * row.area * row.z, 2e-5 * row.area);
  }
  // A tube and its ends, by summing rings.
  for (const bool capsule : {false, true}) {
    double area = 0, xx = 0, zz = 0;
    const auto ring = [&](double radius, double z, double dA) {
      area += dA;
      xx += dA * (radius * radius / 2 + z * z);
      zz += dA * radius * radius;
    };
    constexpr int kRings = 20000;
    for (int k = 0; k < kRings; ++k) {
      const double t = (k + 0.5) / kRings;
      ring(r, h * (2 * t - 1), 2 * M_PI * r * 2 * h / kRings);
      if (capsule)
        for (const double side : {-1.0, 1.0})
          ring(r * std::cos(t * M_PI / 2), side * (h + r * std::sin(t * M_PI / 2)),
               2 * M_PI * r * std::cos(t * M_PI / 2) * r * M_PI / 2 / kRings);
      else
        for (const double side : {-1.0, 1.0}) ring(r * t, side * h, 2 * M_PI * r * t * r / kRings);
    }
    const Import i = made(std::string("type='") + (capsule ? "capsule" : "cylinder") + "' size='.1 .2'");
    EXPECT_NEAR(i.def.links[0].mass, 10 * area, 1e-6);
    EXPECT_NEAR(i.def.links[0].moment[0], 10 * xx, 1e-7);
    EXPECT_NEAR(i.def.links[0].moment[2], 10 * zz, 1e-7);
  }
}

// ---- meshes ----
// A box of half sides 1, 2, 3 about the middle 4 0 0; its corners alone, or its faces too.
const std::string kCorners = "vertex='3 -2 -3 5 -2 -3 3 2 -3 5 2 -3 3 -2 3 5 -2 3 3 2 3 5 2 3'";
const std::string kFaces = " face='0 2 3 0 3 1 4 5 7 4 7 6 0 1 5 0 5 4 2 6 7 2 7 3 0 4 6 0 6 2 1 3 7 1 7 5'";

TEST(Mjcf, MeshesAreFilledAsTheySay) {
  for (const std::string& how :
       {std::string(), kFaces, kFaces + " inertia='exact'", kFaces + " inertia='convex'"}) {
    SCOPED_TRACE(how);
    const Import i = from_text(file(arm("<geom type='mesh' mesh='m' density='2'/>"),
                                    "<asset><mesh name='m' " + kCorners + how + "/></asset>"));
    EXPECT_NEAR(i.def.links[0].mass, 2 * 48, 1e-9);
    EXPECT_NEAR(i.def.links[0].com[0], 4, 1e-12);
    EXPECT_NEAR(i.def.links[0].moment[0], 96 * (4 + 9) / 3.0, 1e-9);
    EXPECT_NEAR(i.def.links[0].moment[2], 96 * (1 + 4) / 3.0, 1e-9);
  }
  const Import shell =
      from_text(file(arm("<geom type='mesh' mesh='m' density='2'/>"),
                     "<asset><mesh name='m' " + kCorners + kFaces + " inertia='shell'/></asset>"));
  EXPECT_NEAR(shell.def.links[0].mass, 2 * (2 * 4 * 6 + 2 * 2 * 6 + 2 * 2 * 4), 1e-9);
}

// An L of three cubes of side 1: the middle of its surface does not see all of it.
TEST(Mjcf, HollowsOfMeshesCountAsMujocoCountsThem) {
  const std::string corners =
      "vertex='0 0 0 2 0 0 2 1 0 1 1 0 1 2 0 0 2 0 0 0 1 2 0 1 2 1 1 1 1 1 1 2 1 0 2 1'";
  const std::string faces =
      " face='0 2 1 0 3 2 0 4 3 0 5 4 6 7 8 6 8 9 6 9 10 6 10 11 0 1 7 0 7 6 1 2 8 1 8 7 2 3 9 2 9 8 3 4 10 "
      "3 10 9 "
      "4 5 11 4 11 10 5 0 6 5 6 11'";
  const auto mass = [&](const std::string& how, const std::string& compiler = "") {
    return from_text(file(arm("<geom type='mesh' mesh='m' density='1'/>"),
                          compiler + "<asset><mesh name='m' " + corners + faces + how + "/></asset>"))
        .def.links[0]
        .mass;
  };
  EXPECT_NEAR(mass(" inertia='exact'"), 3, 1e-9);
  EXPECT_NEAR(mass("", "<compiler exactmeshinertia='true'/>"), 3, 1e-9);
  EXPECT_NEAR(mass(" inertia='convex'"), 3.5, 1e-9);
  EXPECT_NEAR(mass(""), 3, 0.2);  // the default
  EXPECT_GE(mass(""), 3 - 1e-9);
}

TEST(Mjcf, TheReferencePoseOfAMeshIsTakenOffBeforeItIsScaled) {
  const Import i = from_text(file(
      arm("<geom type='mesh' mesh='m' density='1'/>"),
      "<asset><mesh name='m' " + kCorners + " refpos='4 0 0' refquat='1 0 0 1' scale='2 1 1'/></asset>"));
  EXPECT_NEAR(i.def.links[0].com[0], 0, 1e-12);
  EXPECT_NEAR(i.def.links[0].mass, 96, 1e-9);
  EXPECT_NEAR(i.def.links[0].moment[2], 96 * (16 + 1) / 3.0, 1e-9);  // half sides 4, 1, 3
}

TEST(Mjcf, PrimitivesAreFittedToMeshes) {
  const auto shape = [&](const std::string& geom, const std::string& compiler = "") {
    const Import i = from_text(file(arm("<geom " + geom + " mesh='m' density='1'/>"),
                                    compiler + "<asset><mesh name='m' " + kCorners + kFaces + "/></asset>"));
    rdm_robot_shape s = i.def.shapes[1];
    s.name = nullptr;
    EXPECT_NEAR(s.pose.p[0], 4, 1e-9);
    return std::make_pair(s, i.def.links[0].mass);
  };
  const auto [box, box_mass] = shape("type='box'");
  EXPECT_EQ(box.kind, RDM_SHAPE_BOX);
  EXPECT_NEAR(box.size[0], 1, 1e-9);
  EXPECT_NEAR(box.size[2], 3, 1e-9);
  EXPECT_NEAR(box_mass, 48, 1e-9);
  const auto [ball, ball_mass] = shape("");  // no type is a ball
  EXPECT_EQ(ball.kind, RDM_SHAPE_SPHERE);
  EXPECT_NEAR(ball.size[0], 2, 1e-9);
  EXPECT_NEAR(ball_mass, 4.0 / 3 * M_PI * 8, 1e-9);
  const auto [rod, rod_mass] = shape("type='capsule' fitscale='.5'");
  EXPECT_NEAR(rod.size[0], 0.75, 1e-9);
  EXPECT_NEAR(rod.size[1], (3 - 0.75) / 2, 1e-9);
  const auto [tube, tube_mass] = shape("type='cylinder'", "<compiler fitaabb='true'/>");
  EXPECT_NEAR(tube.size[0], 2, 1e-9);
  EXPECT_NEAR(tube.size[1], 3, 1e-9);
  EXPECT_NEAR(tube_mass, M_PI * 4 * 6, 1e-9);
}

TEST(Mjcf, MassesOfMeshesThatAreNotThereAreRefused) {
  rdm_import_config o = import_config();
  o.skip_meshes = 1;
  const std::string asset = "<asset><mesh name='m' file='m.obj'/></asset>";
  const std::string geom = "<geom type='mesh' mesh='m'/>";
  expect_refused(file(arm(geom), asset), RDM_ERROR_NOT_FOUND,
                 "the mass of body arm would come from mesh m, which cannot be read", &o);
  const Import i =
      from_text(file(arm("<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>" + geom), asset), &o);
  EXPECT_DOUBLE_EQ(i.def.links[0].mass, 1);
  expect_refused(file(arm(geom), "<asset><mesh name='m' builtin='cone' params='8 .5'/></asset>"),
                 RDM_ERROR_UNSUPPORTED,
                 "mesh m: builtin=\"cone\": shapes that MuJoCo generates are not read");
  expect_refused(file(arm("<geom type='mesh' mesh='m'/>"),
                      "<asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 1 1 0'/></asset>"),
                 RDM_ERROR_RANGE, "mesh m does not enclose a volume");
}

TEST(Mjcf, BoxesBetweenTwoEndsAreAsWideAsThick) {
  const Import i = from_text(file(arm("<geom type='box' size='.01 .05' fromto='0 0 0 0 0 .2' mass='.1'/>")));
  EXPECT_DOUBLE_EQ(i.def.shapes[1].size[1], 0.01);
  EXPECT_DOUBLE_EQ(i.def.shapes[1].size[2], 0.1);
}

// ---- couplings ----
TEST(Mjcf, OnlyNarrowLimitsOfTendonsCouple) {
  const auto tendon = [](const std::string& range, const std::string& c0, const std::string& c1) {
    return "<tendon><fixed name='t' range='" + range + "'><joint joint='j0' coef='" + c0 +
           "'/><joint joint='j1' coef='" + c1 + "'/></fixed></tendon>";
  };
  expect_couplings(from_text(chain(2, tendon("-.001 .001", ".00705", "-.00805"))),
                   {{"j0", "j1", 0.00805 / 0.00705, 0.001 / 0.00705}});
  for (const std::string& free : {tendon("-.007 .03", ".00705", ".00805"), tendon("-.001 .001", "1", "1"),
                                  tendon("-.3 .3", "1", "-1"), tendon("0 0", "1", "-1")}) {
    const Import i = from_text(chain(2, free));
    EXPECT_EQ(i.def.num_couplings, 0) << free;
  }
  EXPECT_TRUE(from_text(chain(2, tendon("-.3 .3", "1", "-1")))
                  .has_note(RDM_NOTE_DROPPED, "tendon t: its range [-0.3, 0.3] is dropped"));
  // The coupler and two soft limits on the same joints, as shared hands have them.
  const std::string one = tendon("-.001 .001", ".00705", "-.00805");
  std::string three = one;
  for (const char* soft : {"up", "down"})
    three += "<tendon><fixed name='" + std::string(soft) +
             "' range='-.007 .03'><joint joint='j0' coef='.00705'/><joint joint='j1' "
             "coef='.00805'/></fixed></tendon>";
  expect_couplings(from_text(chain(2, three)), {{"j0", "j1", 0.00805 / 0.00705, 0.001 / 0.00705}});
  // Defaults of tendons are theirs too.
  const Import by_class = from_text(chain(
      2,
      "<default><tendon range='-.01 .01'/></default><tendon><fixed name='t'><joint joint='j0' coef='1'/>"
      "<joint joint='j1' coef='-1'/></fixed></tendon>"));
  expect_couplings(by_class, {{"j0", "j1", 1, 0.01}});
}

TEST(Mjcf, GroupsOfCouplingsHaveOneLeader) {
  const std::string equal =
      "<equality><joint joint1='j0' joint2='j1'/><joint joint1='j1' joint2='j2' polycoef='0 .5'/>"
      "</equality>";
  expect_couplings(from_text(chain(3, equal)), {{"j0", "j2", 0.5, 0}, {"j1", "j2", 0.5, 0}});
  // An actuator on the tendon of all three moves the one that leads: q = (1, 1, 2) l, length 4 l.
  const std::string all =
      "<tendon><fixed name='t'><joint joint='j0' coef='1'/><joint joint='j1' coef='1'/>"
      "<joint joint='j2' coef='1'/></fixed></tendon>";
  const Import i = from_text(chain(
      3,
      equal + all +
          "<actuator><position name='a' tendon='t' kp='9' ctrlrange='0 2' forcerange='-3 3'/></actuator>"));
  expect_couplings(i, {{"j0", "j2", 0.5, 0}, {"j1", "j2", 0.5, 0}});
  double stiffness = 0;
  for (int32_t k = 0; k < 3; ++k) {
    const double ratio = k == 2 ? 1 : 0.5;
    stiffness += i.def.links[k].kp * ratio * ratio;
    EXPECT_DOUBLE_EQ(i.def.links[k].effort, 3);
  }
  EXPECT_NEAR(stiffness, 9 * 2 * 2, 1e-9);  // along the leader, whose angle makes twice the length
  EXPECT_EQ(i.def.num_curves, 0);           // its command spans the leader's whole range
  // A follower with an actuator leads its group.
  const std::string drive = "<actuator><position joint='j0' kp='1'/></actuator>";
  expect_couplings(from_text(chain(3, equal + drive)), {{"j1", "j0", 1, 0}, {"j2", "j0", 2, 0}});
  // Two that follow the third, said from its side.
  expect_couplings(from_text(chain(3,
                                   "<equality><joint joint1='j0' joint2='j1'/><joint joint1='j0' joint2='j2' "
                                   "polycoef='.1 2'/></equality>")),
                   {{"j0", "j1", 1, 0}, {"j2", "j1", 0.5, 0}});
  expect_refused(
      chain(2,
            "<equality><joint joint1='j0' joint2='j1'/><joint joint1='j0' joint2='j1' polycoef='0 2'/>"
            "</equality>"),
      RDM_ERROR_ARGUMENT, "joint j0 follows two other joints");
}

TEST(Mjcf, EqualitiesOfTendonsCouple) {
  const std::string tendon =
      "<tendon><fixed name='t'><joint joint='j0' coef='2'/><joint joint='j1' coef='-1'/></fixed>"
      "<spatial name='s'/></tendon>";
  expect_couplings(from_text(chain(2, tendon + "<equality><tendon tendon1='t'/></equality>")),
                   {{"j0", "j1", 0.5, 0}});
  EXPECT_EQ(from_text(chain(2, tendon + "<equality><tendon tendon1='t' active='false'/></equality>"))
                .def.num_couplings,
            0);
  expect_refused(chain(2, tendon + "<equality><tendon tendon1='t' tendon2='s'/></equality>"),
                 RDM_ERROR_UNSUPPORTED, "only a fixed tendon of two joints");
}

// ---- drives ----
TEST(Mjcf, ActuatorsAreReadWithTheirLimits) {
  struct Row {
    const char* actuator;
    double kp, kd, effort, low, high;
  };
  for (const Row& r : {
           Row{"<position joint='j0' kp='4' kv='.5' gear='2' ctrlrange='0 1' forcerange='-3 2'/>", 16, 2, 6,
               0, 0.5},
           Row{"<position joint='j0' kp='4' kv='1' ctrlrange='.2 .5' ctrllimited='false'/>", 4, 1, -1, 0, 1},
           Row{"<position joint='j0' kp='4' kv='1' forcerange='-3 3' forcelimited='false'/>", 4, 1, -1, 0, 1},
           Row{"<position joint='j0' kp='4' kv='1' inheritrange='.5'/>", 4, 1, -1, 0.25, 0.75},
           Row{"<position jointinparent='j0' kp='4' kv='1'/>", 4, 1, -1, 0, 1},
           Row{"<general joint='j0' biastype='affine' gainprm='8' biasprm='1 -4 -1' ctrlrange='0 .25'/>", 4,
               1, -1, 0.25, 0.75},
           Row{"<intvelocity joint='j0' kp='4' kv='1' ctrlrange='-9 9' actrange='.1 .9'/>", 4, 1, -1, 0.1,
               0.9},
           Row{"<velocity joint='j0' kv='7'/><position joint='j0' kp='4' kv='1'/>", 4, 1, -1, 0, 1},
       }) {
    SCOPED_TRACE(r.actuator);
    const Import i = from_text(chain(1, "<actuator>" + std::string(r.actuator) + "</actuator>"));
    const rdm_robot_link& l = i.def.links[0];
    EXPECT_DOUBLE_EQ(l.kp, r.kp);
    EXPECT_DOUBLE_EQ(l.kd, r.kd);
    if (r.effort > 0) {
      EXPECT_DOUBLE_EQ(l.effort, r.effort);
    } else {
      EXPECT_TRUE(i.has_note(RDM_NOTE_GUESSED, "joint j0: effort"));
    }
    if (r.low == 0 && r.high == 1) {
      EXPECT_EQ(i.def.num_curves, 0);
      continue;
    }
    ASSERT_EQ(i.def.num_curves, 1);
    EXPECT_DOUBLE_EQ(i.def.curves[0].angle[0], r.low);
    EXPECT_DOUBLE_EQ(i.def.curves[0].angle[1], r.high);
  }
  // All actuators share one default, and joints bound what any of them gives.
  const Import shared = from_text(file(arm(kRod, "axis='0 1 0' range='-90 90' actuatorfrcrange='-1 1'"),
                                       "<default><general forcerange='-5 5'/><motor gear='2'/></default>",
                                       "<actuator><position joint='j' kp='3'/></actuator>"));
  EXPECT_DOUBLE_EQ(shared.def.links[0].kp, 12);
  EXPECT_DOUBLE_EQ(shared.def.links[0].effort, 1);
}

TEST(Mjcf, DampingRatiosAreOfTheInertiaThatIsFelt) {
  const Import i = from_text(file(arm("<inertial pos='0 0 0' mass='1' diaginertia='.02 .03 .04'/>",
                                      "axis='0 1 0' range='-90 90' armature='.01'"),
                                  "", "<actuator><position joint='j' kp='100' dampratio='1'/></actuator>"));
  EXPECT_NEAR(i.def.links[0].kd, 2 * std::sqrt(100 * 0.04), 1e-12);
}

// ---- refusals by name ----
TEST(Mjcf, WhatCouldChangeTheRobotIsRefusedByName) {
  const std::string body = arm(kRod);
  struct Row {
    std::string text;
    const char* words;
  };
  const std::vector<Row> rows{
      {file(arm(kRod, "axis='0 1 0' rang='-1 1'")),
       "joint j: rang is not a known attribute here, and it could "
       "change the robot; nearest is range"},
      {file(body, "<compiler setotalmass='3'/>"),
       "setotalmass is not a known attribute here, and it could change "
       "the robot; nearest is settotalmass"},
      {file(body, "<compiler coordinate='global'/>"), "coordinate: only local is supported"},
      {file(body, "<option><flag limit='disable'/></option>"),
       "flag: limit=\"disable\": the ranges or couplings of the file"},
      {file(body, "<default><geom densty='3'/></default>"), "geom: densty is not a known attribute"},
      {file(body + "<bdy name='x'/>"),
       "bdy x: this is not a known element in body, and it could change the robot; nearest "
       "is body"},
      {file(body, "", "<actuators/>"),
       "actuators: this is not a known element in mujoco, and it could change the robot; "
       "nearest is actuator"},
      {file(body + "<replicate count='2'/>"), "replicate: it would create bodies"},
      {file(body + "<attach model='x' prefix=''/>"), "attach: it would create bodies"},
      {file(body + "<composite type='cable'/>"), "composite: it would create bodies"},
      {file(body + "<flexcomp name='x'/>"), "flexcomp x: it would create bodies"},
      {file(body, "", "<deformable><flex name='x' body='arm' element='0'/></deformable>"),
       "flex x: deformable bodies"},
      {file(body, "", "<equality><weld body1='arm' body2='base'/></equality>"),
       "weld: weld closes a loop of bodies"},
      {file(body, "", "<equality><joint joint1='j'/></equality>"),
       "it holds a joint at one position; remove the joint instead"},
      {file("<body mocap='true'>" + body + "</body>"), "mocap: a body that the host moves is not read"},
      {file(body, "", "<actuator><position joint='j' armature='.1'/></actuator>"),
       "armature=\".1\": it is not read from"},
      {file(arm(kRod, "range='-1 1' damping='1 .2'")),
       "damping: only the first number of a polynomial is read"},
      {file(arm("<frame><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/></frame>")),
       "frame: an inertial must be in a "
       "body, not in a frame"},
      {"<mujocoinclude><worldbody/></mujocoinclude>", "a part that other files include"},
  };
  for (const Row& r : rows) {
    rdm_import* i = nullptr;
    EXPECT_NE(rdm_import_read(&i, r.text.data(), r.text.size(), nullptr), RDM_OK) << r.words;
    EXPECT_NE(std::string(rdm_import_error()).find(r.words), std::string::npos)
        << "'" << rdm_import_error() << "' is not '" << r.words << "'";
    rdm_import_destroy(i);
  }
}

TEST(Mjcf, WhatCannotChangeItIsListed) {
  const Import i = from_text(
      file(arm(kRod, "axis='0 1 0' range='-90 90' stiffness='3' springref='.1' margin='.01' user='1 2'") +
               "<light/><camera name='eye'/>",
           "<option timestep='.001'><flag gravity='disable'/></option><visual/><statistic/><size/><custom/>",
           "<sensor/><tendon><spatial name='s'/></tendon><actuator><muscle name='m' joint='j'/></actuator>"));
  for (const char* text : {"joint j: stiffness=\"3\", springref=\".1\", margin=\".01\", user=\"1 2\"",
                           "light", "camera eye", "option", "visual", "sensor", "spatial s", "muscle m"})
    EXPECT_TRUE(i.has_note(RDM_NOTE_DROPPED, text)) << text;
}

// The parser stops there, as MuJoCo's does, and says nothing.
TEST(Mjcf, WhatStandsBehindTheRootIsListed) {
  const std::string whole = file(arm(kRod, "axis='0 1 0' range='-90 90'"));
  EXPECT_FALSE(from_text(whole + "<!-- the end -->\n").has_note(RDM_NOTE_DROPPED, "behind"));
  for (const char* more :
       {"\n</mujoco>", "\n<mujoco><worldbody><body name='c'/></worldbody></mujoco>", "\n<x/>"})
    EXPECT_TRUE(from_text(whole + more).has_note(RDM_NOTE_DROPPED, "text after the end of <mujoco>")) << more;
}

// A target that a host moves, of nothing that touches, is no robot and no reason to ask which is.
TEST(Mjcf, TargetsOfTheHostAreDropped) {
  const std::string target =
      "<body name='goal' mocap='true'><geom size='.1' contype='0' conaffinity='0'/></body>";
  std::string text = file(arm(kRod));
  text.insert(text.find("</worldbody>"), target);
  EXPECT_EQ(from_text(text).def.num_links, 1);
  rdm_import_config o = import_config();
  o.root = "world";
  const Import i = from_text(text, &o);
  EXPECT_EQ(i.def.num_shapes, 2);
  EXPECT_TRUE(i.has_note(RDM_NOTE_DROPPED, "body goal: the host moves it (mocap)"));
  o.root = "goal";
  expect_refused(text, RDM_ERROR_UNSUPPORTED, "body goal: mocap", &o);
}

// What ties bodies of which none moves changes nothing; what a host pulls is no robot.
TEST(Mjcf, TiesToTargetsOfTheHost) {
  const auto text = [](const std::string& tie) {
    std::string out = file(arm(kRod), "", "<equality>" + tie + "</equality>");
    out.insert(out.find("</worldbody>"),
               "<body name='goal' mocap='true'><geom size='.1' contype='0' conaffinity='0'/></body>");
    return out;
  };
  const Import i = from_text(text("<weld body1='goal' body2='base'/>"));
  EXPECT_TRUE(i.has_note(RDM_NOTE_DROPPED, "weld : neither of its bodies moves"));
  EXPECT_EQ(from_text(text("<weld body1='base'/>")).def.num_links, 1);
  expect_refused(text("<weld body1='goal' body2='arm'/>"), RDM_ERROR_UNSUPPORTED,
                 "weld ties a body to goal, which the host moves (mocap), and is not read; remove the weld");
  expect_refused(text("<connect body1='base' body2='arm' anchor='0 0 0'/>"), RDM_ERROR_UNSUPPORTED,
                 "connect closes a loop of bodies");
}

TEST(Mjcf, LimitsOfTendonsOfOneJointAreTheJoints) {
  const auto text = [](const std::string& tendon) {
    return chain(1, "<tendon><fixed name='t' limited='true' " + tendon + "</fixed></tendon>");
  };
  const Import i = from_text(text("range='-.8 -.2'><joint joint='j0' coef='-2'/>"));
  EXPECT_NEAR(i.def.links[0].lower, 0.1, 1e-12);
  EXPECT_NEAR(i.def.links[0].upper, 0.4, 1e-12);
  EXPECT_TRUE(i.has_note(RDM_NOTE_CHANGED, "tendon t: it limits joint j0 to 0.1 to 0.4"));
  EXPECT_DOUBLE_EQ(from_text(text("range='-9 9'><joint joint='j0' coef='2'/>")).def.links[0].upper, 1);
  expect_refused(text("range='4 5'><joint joint='j0' coef='2'/>"), RDM_ERROR_RANGE,
                 "its range leaves joint j0");
  std::string spatial = chain(1,
                              "<tendon><spatial limited='true' range='0 1'><site site='a'/><site "
                              "site='b'/></spatial></tendon>");
  expect_refused(spatial, RDM_ERROR_UNSUPPORTED, "spatial: the range 0 1 of its length would couple joints");
  spatial.replace(spatial.find("'true'"), 6, "'false'");
  EXPECT_EQ(from_text(spatial).def.num_links, 1);
}

// inertiafromgeom="true" takes the geoms' mass; where none of the groups has any, the inertial's.
TEST(Mjcf, AnInertialStaysWhereNoGeomSaysMore) {
  const auto mass = [](const std::string& geom) {
    return from_text(file(arm("<inertial pos='0 0 0' mass='2' diaginertia='1 1 1'/>" + geom),
                          "<compiler inertiafromgeom='true' inertiagrouprange='0 2'/>"))
        .def.links[0]
        .mass;
  };
  EXPECT_EQ(mass("<geom size='.1' mass='3'/>"), 3);
  EXPECT_EQ(mass("<geom size='.1' mass='3' group='3'/>"), 2);
  EXPECT_EQ(mass("<geom size='.1' mass='0'/>"), 2);
  EXPECT_EQ(mass(""), 2);
}

TEST(Mjcf, InertialsOfAMassAloneArePoints) {
  const std::string point = "<inertial pos='0 0 .1' mass='2'/>";
  const Import i = from_text(file(arm(kRod + "<body name='tool'>" + point + "</body>")));
  EXPECT_NEAR(i.def.links[0].mass, 2.1, 1e-12);
  expect_refused(file(arm(point)), RDM_ERROR_ARGUMENT, "it moves, but its moments of inertia are 0");
}

TEST(Mjcf, WhatStandsTwiceIsRefused) {
  const std::string inertial = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";
  expect_refused(file(arm(inertial + inertial)), RDM_ERROR_FORMAT,
                 "inertial: there is already one in line 1");
  expect_refused(file(arm(kRod, "axis='0 1 0' axis='1 0 0' range='0 1'")), RDM_ERROR_FORMAT,
                 "an attribute that is not name=\"value\", or occurs twice");
}

// The surface alone of a mesh: an octahedron of edge sqrt(2) has 4 sqrt(3) of it, its points at 1 from the middle.
TEST(Mjcf, ShellsOfMeshesWeighTheirSurface) {
  const Import i =
      from_text(file(arm("<geom type='mesh' mesh='octahedron' density='2' shellinertia='true'/>"),
                     "<asset><mesh name='octahedron' vertex='1 0 0  -1 0 0  0 1 0  0 -1 0  0 0 1  0 0 -1' "
                     "face='0 2 4  2 1 4  1 "
                     "3 4  3 0 4  2 0 5  1 2 5  3 1 5  0 3 5'/></asset>"));
  const double mass = 2 * 4 * std::sqrt(3.0);
  EXPECT_NEAR(i.def.links[0].mass, mass, 1e-9);
  // Over a triangle of unit axes the mean of x^2 is 1/6.
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(i.def.links[0].moment[k], mass / 3, 1e-9);
}

}  // namespace
