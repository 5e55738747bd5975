// The tool's readers of files that somebody else may have written: what is wrong is a Failure with a text,
// whatever the bytes are, and what is right comes out as it stands.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "common/json.hpp"
#include "common/report.hpp"
#include "common/text.hpp"
#include "demo/script.hpp"
#include "mesh/mesh.hpp"
#include "run/config.hpp"
#include "run/note.hpp"
#include "run/progress.hpp"

namespace {

using namespace tool;

// The text of the Failure, "" when there is none. Any other exception is a fault.
template <class F>
std::string failure(F&& f) {
  try {
    f();
  } catch (const Failure& e) {
    return e.what();
  }
  return "";
}

std::string replaced(std::string text, const std::string& old, const std::string& with) {
  const size_t at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), with);
}

// Every prefix of good bytes, and every byte of them replaced by some others: read, or a Failure.
template <class Parse>
void spoil(const std::string& good, Parse parse) {
  EXPECT_EQ(failure([&] { parse(good); }), "");
  for (size_t n = 0; n < good.size(); ++n) {
    failure([&] { parse(good.substr(0, n)); });
    for (const char c : {'\0', '\xff', '"', '9', '-', '\n', 'e'}) {
      std::string bad = good;
      bad[n] = c;
      failure([&] { parse(bad); });
    }
  }
}

const std::string kConfig =
    R"({"task": "grasp", "algo": "ppo", "seed": 3, "set": ["max_steps=5"], "set_algo": [],
  "set_cost_limit": ["25"], "cost_limits": {"cost": 25.0},
  "train_cfgs": {"total_steps": 100, "vector_env_nums": 4, "threads": 0, "eval_every": 2, "checkpoint_every": 3}})";

RunSettings config(const std::string& text) {
  return parse_config(text.data(), text.size());
}

TEST(Config, ReadsItsMembers) {
  const RunSettings s = config(kConfig);
  EXPECT_EQ(s.pool.task, "grasp");
  EXPECT_EQ(s.agent.algo, "ppo");
  EXPECT_EQ(s.pool.seed, 3u);
  EXPECT_EQ(s.pool.envs, 4);
  EXPECT_EQ(s.steps, 100);
  EXPECT_EQ(s.eval_every, 2);
  EXPECT_EQ(s.checkpoint_every, 3);
  ASSERT_EQ(s.pool.options.size(), 1u);
  EXPECT_EQ(s.pool.options[0].second, "5");
  EXPECT_EQ(parse_label(kConfig.data(), kConfig.size()).task, "grasp");
}

TEST(Config, KnowsWhatPythonAloneCanContinue) {
  const RunSettings plain = config(kConfig);
  EXPECT_FALSE(plain.functions);
  EXPECT_EQ(plain.task_class, "");
  std::string text = replaced(kConfig, "\"task\": \"grasp\"",
                              R"("task": "grasp", "own_costs": {"fast": null, "drop": "a:b"})");
  text = replaced(text, R"("set_cost_limit": ["25"], "cost_limits": {"cost": 25.0})",
                  R"("set_cost_limit": ["fast=7"], "cost_limits": {"fast": 7.0})");
  const RunSettings own = config(text);
  EXPECT_TRUE(own.functions);
  EXPECT_TRUE(own.limits.empty()) << "the task has no cost of that name";
  EXPECT_EQ(config(replaced(kConfig, "\"task\"", R"("own_reward": null, "task")")).limits.size(), 1u);
  EXPECT_TRUE(config(replaced(kConfig, "\"task\"", R"("own_reward": null, "task")")).functions);
  EXPECT_EQ(config(replaced(kConfig, "\"task\"", R"("task_class": "press:Press", "task")")).task_class,
            "press:Press");
  EXPECT_NE(failure([&] { config(replaced(kConfig, "\"task\"", R"("task_class": 3, "task")")); }), "");
}

TEST(Config, KeepsTheTextsOfFiles) {
  const std::string files =
      R"("task_file": "[task]\tname\r\n", "robot_files": {"a": "x = 1\n"}, "plugins": ["./p.so"], )";
  const RunSettings s = config(replaced(kConfig, "\"algo\"", files + "\"algo\""));
  EXPECT_EQ(s.own.task, "[task]\tname\r\n");
  ASSERT_EQ(s.own.robots.size(), 1u);
  EXPECT_EQ(s.own.robots.at("a"), "x = 1\n");
  ASSERT_EQ(s.own.plugins.size(), 1u);
  for (const char* bad :
       {"\"task_file\": 3, ", "\"robot_files\": {\"a\": []}, ", "\"robot_files\": [], ", "\"plugins\": 1, "})
    EXPECT_NE(failure([&] { config(replaced(kConfig, "\"algo\"", bad + std::string("\"algo\""))); }), "")
        << bad;
}

TEST(Config, RefusesNumbersThatNothingCanBeDoneWith) {
  for (const char* bad : {"0", "-1", "2147483648", "1e300", "2.5", "true", "null", "\"2\"", "[]",
                          "99999999999999999999", "18446744073709551615"}) {
    for (const char* key : {"eval_every\": 2", "checkpoint_every\": 3", "vector_env_nums\": 4"}) {
      const std::string name(key, static_cast<size_t>(std::strchr(key, 34) - key));
      EXPECT_NE(failure([&] { config(replaced(kConfig, key, name + "\": " + bad)); }), "") << key << bad;
    }
  }
  for (const char* bad : {"0", "-5", "1e19", "9223372036854775807", "9007199254740993"})
    EXPECT_NE(failure([&] { config(replaced(kConfig, "steps\": 100", std::string("steps\": ") + bad)); }),
              "");
  for (const char* bad : {"-1", "1.5", "\"0\""})
    EXPECT_NE(failure([&] { config(replaced(kConfig, "seed\": 3", std::string("seed\": ") + bad)); }), "");
}

TEST(Config, ReadsTheShieldAsTheFlagSaysIt) {
  const auto shield = [](const std::string& word) {
    return config(replaced(kConfig, "\"threads\"", "\"shield\": " + word + ", \"threads\"")).shield;
  };
  EXPECT_FALSE(config(kConfig).shield.on);
  EXPECT_TRUE(shield("\"predict:block=3\"").on);
  EXPECT_EQ(shield("\"predict:block=3,noise=1\"").settings, "predict=true\nblock=3\nnoise=1\n");
  EXPECT_EQ(shield("\"Project\"").settings, "predict=false\n");
  for (const char* bad : {"\"predicts\"", "\"predict:blok=3\"", "\"predict:block\"", "\"predict:\"",
                          "\"off:block=3\"", "\"\"", "true", "[]", "\"project:predict=true\""})
    EXPECT_NE(failure([&] { shield(bad); }), "") << bad;
}

TEST(Config, RefusesOtherKindsAndTexts) {
  EXPECT_NE(failure([&] { config(replaced(kConfig, "\"max_steps=5\"", "\"max_steps\"")); }), "");
  EXPECT_NE(failure([&] { config(replaced(kConfig, "\"max_steps=5\"", "7")); }), "");
  EXPECT_NE(failure([&] { config(replaced(kConfig, "[\"25\"]", "{\"a\": \"b\"}")); }), "");
  EXPECT_NE(failure([&] { config(replaced(kConfig, "\"grasp\"", "\"gr\\u001basp\"")); }), "");
  EXPECT_NE(failure([&] { config(replaced(kConfig, "\"grasp\"", "\"gr\\u0000asp\"")); }), "");
  EXPECT_NE(failure([&] { config(replaced(kConfig, "\"grasp\"", "\"" + std::string(5000, 'x') + "\"")); }),
            "");
  for (const char* text : {"", "[]", "3", "null", "{}", "\"a\""})
    EXPECT_NE(failure([&] { config(text); }), "") << text;
  const std::string deep = "{\"a\":" + std::string(100000, '[');
  EXPECT_NE(failure([&] { config(deep); }), "");
  EXPECT_NE(failure([&] { config(std::string(kMostJsonBytes + 1, ' ')); }), "");
  spoil(kConfig, [](const std::string& text) { config(text); });
  spoil(kConfig, [](const std::string& text) { parse_label(text.data(), text.size()); });
}

const std::string kNote = R"({"epoch":5,"env_steps":640,"progress_bytes":99,"seconds":1.5,"last":[1.0,2.0],)"
                          R"("best":[true,1.0,0.0]})";

Note note(const std::string& head, const std::string& policy = "\nPOLICY") {
  const std::string bytes = head + policy;
  return parse_note(bytes.data(), bytes.size());
}

TEST(CheckpointNote, ComesBackAsWritten) {
  const Note n = note(kNote);
  EXPECT_EQ(n.epoch, 5);
  EXPECT_EQ(n.env_steps, 640);
  EXPECT_EQ(n.best->ret, 1);
  EXPECT_EQ(n.best_policy.size(), 6u);
  const std::string again = note_bytes(n);
  EXPECT_EQ(again, kNote + "\nPOLICY");
}

TEST(CheckpointNote, KnowsThatPythonChangedTheWorlds) {
  EXPECT_FALSE(note(kNote).changed);
  EXPECT_TRUE(note(replaced(kNote, "{", R"({"changed":{"options":{"max_steps":"5"},"epoch":2},)")).changed);
}

TEST(CheckpointNote, HasTheShieldsStateBeforeThePolicy) {
  const std::string head = replaced(kNote, "}", R"(,"shield_bytes":5})");
  const Note n = note(head, "\nPLANSPOLICY");
  EXPECT_EQ(std::string(n.shield.begin(), n.shield.end()), "PLANS");
  EXPECT_EQ(std::string(n.best_policy.begin(), n.best_policy.end()), "POLICY");
  EXPECT_EQ(note_bytes(n), head + "\nPLANSPOLICY");
  EXPECT_NE(failure([&] { note(head, "\nPLANS"); }), "") << "no policy is left";
  EXPECT_NE(failure([&] { note(head, "\nPLAN"); }), "");
  EXPECT_NE(failure([&] { note(head, ""); }), "");
  for (const char* size : {"0", "-1", "12", "9223372036854775807", "\"5\""})
    EXPECT_NE(failure([&] { note(replaced(head, ":5}", std::string(":") + size + "}"), "\nPLANSPOLICY"); }),
              "")
        << size;
  spoil(head + "\nPLANSPOLICY", [](const std::string& text) { parse_note(text.data(), text.size()); });
}

TEST(CheckpointNote, RefusesWhatItsReaderCouldNotUse) {
  EXPECT_NE(failure([&] { note(replaced(kNote, "[true,1.0,0.0]", "[true,1]")); }), "");
  EXPECT_NE(failure([&] { note(replaced(kNote, "[true,1.0,0.0]", "{}")); }), "");
  EXPECT_NE(failure([&] { note(replaced(kNote, "[true,1.0,0.0]", "[1,1,1]")); }), "");
  EXPECT_NE(failure([&] { note(replaced(kNote, "[1.0,2.0]", "[1]")); }), "");
  EXPECT_NE(failure([&] { note(replaced(kNote, "640", "-9223372036854775808")); }), "");
  EXPECT_NE(failure([&] { note(replaced(kNote, "640", "9223372036854775807")); }), "");
  EXPECT_NE(failure([&] { note(replaced(kNote, "99", "-1")); }), "");
  EXPECT_NE(failure([&] { note(replaced(kNote, ":5", ":2147483648")); }), "");
  EXPECT_NE(failure([&] { note(replaced(kNote, "1.5", "\"1.5\"")); }), "");
  EXPECT_NE(failure([&] { note(kNote, ""); }), "") << "a best one without its policy";
  EXPECT_NE(failure([&] { note(kNote, "\n"); }), "") << "a best one without its policy";
  EXPECT_NE(failure([&] { parse_note(nullptr, 0); }), "");
  spoil(kNote + "\nPOLICY", [](const std::string& text) { parse_note(text.data(), text.size()); });
}

TEST(CheckpointNote, OfAClockThatJumpedCostsTheTimeAlone) {
  for (const char* seconds : {"-1", "1e13", "-1e300", "null"}) {
    const Note n = note(replaced(kNote, "1.5", seconds));
    EXPECT_TRUE(n.clock_lost) << seconds;
    EXPECT_EQ(n.seconds, 0) << seconds;
    EXPECT_EQ(n.epoch, 5);
  }
  EXPECT_FALSE(note(kNote).clock_lost);
}

Columns progress(const std::string& text) {
  return parse_progress(text.data(), text.size());
}

TEST(Progress, ColumnsHaveOneLength) {
  const Columns c = progress("a,b\n1,2\n3,nan\n4,1e300\n5,x\n6\n7,8,9\n1,");
  ASSERT_EQ(c.size(), 2u);
  EXPECT_EQ(c.at("a").size(), 5u);  // the last row ends in an empty cell
  EXPECT_EQ(c.at("b").size(), 5u);
  EXPECT_EQ(c.at("b")[0], 2);
  for (size_t i = 1; i < 5; ++i) EXPECT_TRUE(std::isnan(c.at("b")[i])) << i;
}

TEST(Progress, ANameStandsOnce) {
  EXPECT_NE(failure([&] { progress("TotalEnvSteps,Metrics/EpRet,Metrics/EpRet\n1,2,3\n4,5,6\n"); }), "");
  EXPECT_NE(failure([&] { progress(",\n"); }), "");
  EXPECT_TRUE(progress("").empty());
  std::string wide = "c0";
  for (int i = 1; i < 2000; ++i) wide += ",c" + std::to_string(i);
  EXPECT_NE(failure([&] { progress(wide); }), "");
  EXPECT_TRUE(progress("a,b\n" + std::string(1 << 20, ',') + "\n").at("a").empty());
  spoil("TotalEnvSteps,b,c\n1,2,3\n4,5,6\n", [](const std::string& text) { progress(text); });
}

DemoScript demo(const std::string& text) {
  return parse_demo(text.data(), text.size(), "text");
}

TEST(Demo, RefusesNumbersThatNoHandCanFollow) {
  const std::string head = "task grasp\nphase a\n";
  const std::string follow = "right.x follows 0.1 by object.position[2] gain 1 limit 1 at 0.1\n";
  EXPECT_EQ(failure([&] { demo(head + follow); }), "");
  for (const auto& [old, bad] :
       {std::pair("limit 1", "limit -1"), std::pair("limit 1", "limit nan"), std::pair("at 0.1", "at -1"),
        std::pair("0.1 by", "1e300 by"), std::pair("0.1 by", "-nan by"), std::pair("gain 1", "gain 1e9"),
        std::pair("gain 1", "gain inf")})
    EXPECT_NE(failure([&] { demo(head + replaced(follow, old, bad)); }).find("line 3"), std::string::npos)
        << bad;
  EXPECT_NE(failure([&] { demo(head + "for -1\n"); }).find("line 3"), std::string::npos);
  EXPECT_NE(failure([&] { demo(head + "right.x = 1 over -1\n"); }).find("line 3"), std::string::npos);
  EXPECT_NE(failure([&] { demo("task grasp\nset x\n"); }).find("line 2"), std::string::npos);
  EXPECT_NE(failure([&] { demo(head + std::string(kMostDemoBytes, '#')); }), "");
  spoil(head + follow + "until object.position[2] < 0.5\nright.*J1 = 30deg over 0.5\n",
        [](const std::string& text) { demo(text); });
}

TEST(Demo, ReadsWhereAPalmShallBe) {
  const std::string head = "task jenga\nwhen pair=paper\nphase a\n";
  const std::string line = "left.ff_tip = 0.1 -2 3e-1 turned 90 0 -180 at 0.5 over 2\n";
  const DemoScript script = demo(head + "right.palm = 0 0 1\n" + line);
  ASSERT_EQ(script.phases[0].motions.size(), 2u);
  EXPECT_TRUE(script.phases[0].commands.empty());
  const DemoScript::Motion &palm = script.phases[0].motions[0], &tip = script.phases[0].motions[1];
  EXPECT_EQ(palm.point, "palm");
  EXPECT_FALSE(palm.left || palm.turned);
  EXPECT_EQ(tip.point, "ff_tip");
  EXPECT_TRUE(tip.left && tip.turned);
  EXPECT_EQ(tip.p[1], -2);
  EXPECT_EQ(tip.turn[2], -180);
  EXPECT_EQ(tip.at, 0.5);
  EXPECT_EQ(tip.over, 2);
  EXPECT_EQ(script.when, script.options);
  for (const auto& [old, bad] :
       {std::pair("0.1 -2", "0.1 nan"), std::pair("0.1 -2 3e-1", "0.1 -2"), std::pair("at 0.5", "at -1"),
        std::pair("over 2", "over"), std::pair("turned 90", "turned"), std::pair("over 2", "under 2")})
    EXPECT_NE(failure([&] { demo(head + replaced(line, old, bad)); }).find("line 4"), std::string::npos)
        << bad;
}

TEST(Demo, OptionsChooseTheScript) {
  EXPECT_EQ(builtin_demo("jenga", {}).file, "jenga.demo");
  EXPECT_EQ(builtin_demo("jenga", {{"pair", "own"}}).file, "jenga.demo");
  EXPECT_EQ(builtin_demo("jenga", {{"pair", "own"}, {"pair", "paper"}}).file, "jenga_paper.demo");
  EXPECT_EQ(builtin_demo("grasp", {{"hand", "allegro_hand"}}).file, "grasp_allegro.demo");
  EXPECT_TRUE(has_builtin_demo("jenga"));
  EXPECT_FALSE(has_builtin_demo("bandit"));
}

std::vector<Point> mesh(const std::string& bytes, MeshKind kind) {
  return parse_mesh(bytes.data(), bytes.size(), kind);
}

TEST(Mesh, ReadsVerticesOrSaysWhereNone) {
  EXPECT_EQ(mesh("v 1 2 3\r\n\tv 4 5 6 # w\nvn 7 8 9\nf 1 2 3\nv 0 0 0", MeshKind::kObj).size(), 3u);
  EXPECT_NE(failure([&] { mesh("v 1 2 3\nv 1 2\n", MeshKind::kObj); }).find("line 2"), std::string::npos);
  EXPECT_NE(failure([&] { mesh("v 1 2 3\nv 1 nan 2\n", MeshKind::kObj); }).find("line 2"), std::string::npos);
  EXPECT_NE(failure([&] { mesh("v 1 2 1e999\n", MeshKind::kObj); }), "");
  EXPECT_NE(failure([&] { mesh("", MeshKind::kObj); }), "");
  std::string binary(84 + 50, '\0');
  binary[80] = 1;
  EXPECT_EQ(mesh(binary, MeshKind::kStl).size(), 3u);
  std::string many = binary;
  std::memset(many.data() + 80, '\xff', 4);
  EXPECT_NE(
      failure([&] { mesh(many, MeshKind::kStl); }).find("truncated: its header says 4294967295 facets, "),
      std::string::npos);
  many = binary;
  many[80] = 0;
  EXPECT_EQ(failure([&] { mesh(many, MeshKind::kStl); }), "its header says 0 facets");
  EXPECT_EQ(failure([&] { mesh(std::string(20, '\0'), MeshKind::kStl); }),
            "20 bytes are too few for a binary .stl file");
  const std::string longer = binary + "made by a program";
  EXPECT_EQ(mesh(longer, MeshKind::kStl).size(), 3u);
  EXPECT_EQ(bytes_behind(longer.data(), longer.size(), MeshKind::kStl), 17u);
  EXPECT_EQ(bytes_behind(binary.data(), binary.size(), MeshKind::kStl), 0u);
  std::memset(binary.data() + 84 + 12, '\xff', 4);
  EXPECT_NE(failure([&] { mesh(binary, MeshKind::kStl); }).find("facet 1"), std::string::npos);
  spoil("v 1 2 3\nv 4 5 6\n", [](const std::string& text) { mesh(text, MeshKind::kObj); });
  spoil("solid a\nvertex 1 2 3\n", [](const std::string& text) { mesh(text, MeshKind::kStl); });
}

TEST(Mesh, LinesEndAndBeginAsProgramsWriteThem) {
  const std::vector<Point> want = {{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(mesh("\xef\xbb\xbfv 1 2 3\nv 4 5 6\n", MeshKind::kObj), want);
  EXPECT_EQ(mesh("v 1 2 3\rv 4 5 6\r", MeshKind::kObj), want);
  EXPECT_EQ(mesh("v 1 \\\n2 3\nv 4 5 \\\r\n6", MeshKind::kObj), want);
  EXPECT_EQ(mesh("SOLID A\n  FACET NORMAL 0 0 1\n VERTEX 1 2 3\n Vertex 4 5 6\n", MeshKind::kStl), want);
  EXPECT_EQ(mesh("solid a\r vertex 1 2 3\r vertex 4 5 6\r", MeshKind::kStl), want);
  EXPECT_NE(failure([&] { mesh("# a\nv 1 \\\n 2 3\nv 1 2\n", MeshKind::kObj); }).find("line 4"),
            std::string::npos);
  EXPECT_EQ(failure([&] { mesh("V 1 2 3\n", MeshKind::kObj); }), "it has no vertices");
}

Mesh faces(const std::string& bytes, MeshKind kind) {
  return parse_faces(bytes.data(), bytes.size(), kind);
}

TEST(Mesh, FacesNameVerticesThatAreThere) {
  // a square of four corners, counted from the end; a corner that stands twice is one
  const Mesh square =
      faces("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nf -4/1 -3/2/3 -2//1 -5\nf 5 2 3\n", MeshKind::kObj);
  EXPECT_EQ(square.points.size(), 4u);
  ASSERT_EQ(square.faces.size(), 3u);
  EXPECT_EQ(square.faces[0], (std::array<uint32_t, 3>{1, 2, 3}));
  EXPECT_EQ(square.faces[1], (std::array<uint32_t, 3>{1, 3, 0}));
  EXPECT_EQ(square.faces[2], (std::array<uint32_t, 3>{0, 1, 2}));
  EXPECT_NE(failure([] { faces("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 4\n", MeshKind::kObj); }).find("line 4"),
            std::string::npos);
  EXPECT_NE(failure([] { faces("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 0\n", MeshKind::kObj); }).find("line 4"),
            std::string::npos);
  EXPECT_NE(failure([] { faces("v 0 0 0\nv 1 0 0\nf 1 2\n", MeshKind::kObj); }).find("line 3"),
            std::string::npos);
  EXPECT_NE(failure([] {
              faces("vertex 0 0 0\nvertex 1 0 0\n", MeshKind::kStl);
            }).find("three vertices for each facet"),
            std::string::npos);
  EXPECT_TRUE(
      faces("vertex 0 0 0\nvertex 1 0 0\nvertex 0 0 0\n", MeshKind::kStl).faces.empty());  // no surface
}

// A tetrahedron of edge 1 along the axes, away from the origin: V = 1/6, moments as Tonon gives them.
TEST(Mesh, ClosedOnesWeighAsTheirSolid) {
  std::string text;
  const double p[4][3] = {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}};
  for (const auto& v : p)
    text += "v " + std::to_string(v[0]) + ' ' + std::to_string(v[1]) + ' ' + std::to_string(v[2]) + '\n';
  const std::string closed = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
                    inside_out = "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
  for (const std::string& f : {closed, inside_out}) {
    const MeshMass m = mass_of(faces(text + f, MeshKind::kObj));
    EXPECT_NEAR(m.volume, 1.0 / 6, 1e-12);
    EXPECT_NEAR(m.centre[0], 5.25, 1e-12);
    EXPECT_NEAR(m.centre[2], 0.25, 1e-12);
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(m.moment[k], 1.0 / 80, 1e-12);
    for (size_t k = 3; k < 6; ++k) EXPECT_NEAR(m.moment[k], 1.0 / 480, 1e-12);
  }
  for (const char* open :
       {"f 1 3 2\nf 1 2 4\nf 1 4 3\n", "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 4 3\n", "", "f 1 2 3\nf 1 3 2\n"})
    EXPECT_EQ(mass_of(faces(text + open, MeshKind::kObj)).volume, 0) << open;
}

TEST(Text, NothingButTextReachesTheTerminal) {
  EXPECT_EQ(printable("a\tb\n\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80"),
            "a\tb\n\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80");
  EXPECT_EQ(printable("a\x1b[31m\x7f\r"), "a?[31m??");
  EXPECT_EQ(printable("\xc2\x9b"), "?");  // the C1 control that begins a sequence too
  for (const char* bad :
       {"\xff", "\xc3", "\xe2\x82", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\x80"}) {
    EXPECT_FALSE(is_utf8(bad));
    EXPECT_TRUE(is_utf8(printable(bad)));
  }
  EXPECT_NO_THROW(json_text({{"text", "\xff"}}));
}

}  // namespace
