// Tasks as text: each term where its value is known, each refusal with line and key, files that ship keep
// what a task promises, and a task as text is the one written in C.
#include <gtest/gtest.h>
#include <redman/import.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "env/options/simulation_rows.hpp"
#include "written.hpp"

extern "C" rdm_result redman_plugin(void);  // of examples/07_own_task.c

namespace {

const std::string kScenes = RDM_TEST_DATA "/../examples/scenes/";

struct Task {
  int32_t index = -1;
  explicit Task(const std::string& text) {
    EXPECT_EQ(rdm_import_read_task(&index, text.data(), text.size(), "t.task"), RDM_OK) << rdm_import_error();
  }
  ~Task() {
    if (index < 0) return;
    EXPECT_EQ(rdm_task_destroy(index), RDM_OK);
  }
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;
};

struct Pool {
  rdm_pool* pool = nullptr;
  rdm_buffers b{};
  rdm_spec spec{};
  int32_t envs;
  explicit Pool(const char* task, int32_t count = 1, const char* settings = nullptr, int32_t threads = 0)
      : envs(count) {
    rdm_pool_config c;
    rdm_pool_config_init(&c, sizeof c);
    c.task = task;
    c.num_envs = count;
    c.num_threads = threads;
    c.seed = 7;
    c.settings = settings;
    EXPECT_EQ(rdm_pool_create(&pool, &c), RDM_OK) << rdm_last_error();
    b.struct_size = sizeof b;
    spec.struct_size = sizeof spec;
    EXPECT_EQ(rdm_pool_get_buffers(pool, &b), RDM_OK);
    EXPECT_EQ(rdm_pool_get_spec(pool, &spec), RDM_OK);
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK) << rdm_last_error();
  }
  ~Pool() { rdm_pool_destroy(pool); }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;
  void step(float action = 0) {
    std::fill_n(b.action, envs * spec.action_dim, action);
    ASSERT_EQ(rdm_pool_step(pool), RDM_OK) << rdm_last_error();
  }
  void random_step() {
    ASSERT_EQ(rdm_pool_baseline(pool, RDM_BASELINE_RANDOM), RDM_OK);
    ASSERT_EQ(rdm_pool_step(pool), RDM_OK) << rdm_last_error();
  }
  std::vector<double> field(const std::string& name) const {
    rdm_field_info f = RDM_INIT(rdm_field_info);
    for (int32_t i = 0; rdm_pool_field_at(pool, i, &f) == RDM_OK; ++i)
      if (name == f.name) return {b.obs + f.offset, b.obs + f.offset + f.count};
    ADD_FAILURE() << "no field " << name;
    return {};
  }
  double number(const std::string& name) const { return field(name).at(0); }
  double reward() const { return static_cast<double>(b.reward[0]); }
  uint64_t hash() const {
    uint64_t h = 0;
    EXPECT_EQ(rdm_pool_get_hash(pool, -1, &h), RDM_OK);
    return h;
  }
};

// A slider, which one action moves along x, a ball at rest on a table beside, and a weightless box that
// flies.
const char kHead[] =
    "[task]\n"                                      // 1
    "name = \"text_test\"\n"                        // 2
    "max_steps = 200\n"                             // 3
    "obs_limit = 0\n"                               // 4
    "[options]\n"                                   // 5
    "frequency = 50\n"                              // 6
    "far = { default = 0.5, low = 0, high = 2 }\n"  // 7
    "[[tree]]\n"                                    // 8
    "name = \"cart\"\n"                             // 9
    "p = [0, 0, 0.5]\n"                             // 10
    "control = \"position\"\n"                      // 11
    "[[tree.link]]\n"                               // 12
    "name = \"box\"\n"                              // 13
    "joint = \"slide\"\n"                           // 14
    "parent = \"root\"\n"                           // 15
    "kind = \"prismatic\"\n"                        // 16
    "axis = [1, 0, 0]\n"                            // 17
    "range = [-0.2, 0.2]\n"                         // 18
    "kp = 400\n"                                    // 19
    "kd = 40\n"                                     // 20
    "effort = 100\n"                                // 21
    "mass = 1\n"                                    // 22
    "moment = [0.01, 0.01, 0.01, 0, 0, 0]\n"        // 23
    "[[tree.shape]]\n"                              // 24
    "name = \"side\"\n"                             // 25
    "link = \"box\"\n"                              // 26
    "kind = \"box\"\n"                              // 27
    "size = [0.05, 0.05, 0.05]\n"                   // 28
    "[[body]]\n"                                    // 29
    "name = \"ball\"\n"                             // 30
    "kind = \"sphere\"\n"                           // 31
    "size = [0.04]\n"                               // 32
    "mass = 0.5\n"                                  // 33
    "p = [\"$far\", 0.3, 0.04]\n"                   // 34
    "[[body]]\n"                                    // 35
    "name = \"plane\"\n"                            // 36
    "kind = \"box\"\n"                              // 37
    "size = [0.1, 0.02, 0.01]\n"                    // 38
    "mass = 0.2\n"                                  // 39
    "weightless = true\n"                           // 40
    "p = [0, 0, 2]\n"                               // 41
    "rpy = [0, 0, 1.5707963267948966]\n"            // 42
    "v = [0.5, 0, 0.25]\n"                          // 43
    "[[static]]\n"                                  // 44
    "name = \"table\"\n"                            // 45
    "kind = \"plane\"\n";                           // 46
const char kTail[] =
    "[[observe]]\n"        // 47
    "term = \"joints\"\n"  // 48
    "of = \"cart\"\n"      // 49
    "[[cost]]\n"           // 50
    "name = \"touch\"\n"   // 51
    "term = \"touch\"\n"   // 52
    "a = \"cart\"\n"       // 53
    "b = \"ball\"\n"       // 54
    "limit = 5\n";         // 55

std::string with(const std::string& rows) {
  return kHead + rows + kTail;
}
std::string watch(const std::string& row) {
  return with("[[observe]]\nname = \"x\"\n" + row);
}
std::string quoted(const char* term, const std::string& rest) {
  return "term = \"" + std::string(term) + "\"\n" + rest;
}

// What a term says after `steps` steps with the cart's action.
double value_of(const std::string& row, int steps = 0, float action = 0, const char* settings = nullptr) {
  const Task task(watch(row));
  Pool pool("text_test", 1, settings);
  for (int i = 0; i < steps; ++i) pool.step(action);
  return pool.number("x");
}

TEST(TaskText, TermsOfPlaces) {
  EXPECT_NEAR(value_of(quoted("distance", "a = \"ball\"\nb = [0.5, 0, 0]\n")), std::hypot(0.3, 0.04), 1e-6);
  EXPECT_NEAR(value_of(quoted("distance", "a = \"ball\"\nb = [0.5, 0, 0]\nalong = [1, 1, 0]\n")), 0.3, 1e-6);
  EXPECT_NEAR(value_of(quoted("distance", "a = \"ball\"\nb = \"cart\"\n"), 0, 0, "far=1"),
              std::sqrt(1 + 0.09 + 0.46 * 0.46), 1e-6);
  EXPECT_NEAR(value_of(quoted("distance", "a = { on = \"plane\", p = [0.1, 0, 0] }\nb = [0, 0.1, 2]\n")), 0,
              1e-6);
  EXPECT_NEAR(value_of(quoted("distance", "a = \"cart_box\"\nb = \"cart_side\"\n")), 0, 1e-6);
  EXPECT_NEAR(value_of(quoted("height", "a = \"plane\"\n")), 2, 1e-6);
  EXPECT_NEAR(value_of(quoted("height", "a = \"plane\"\n"), 10), 2 + 0.25 * 0.2, 1e-5);
  EXPECT_NEAR(value_of(quoted("moved", "a = \"plane\"\n"), 10), std::hypot(0.5, 0.25) * 0.2, 1e-5);
  EXPECT_NEAR(value_of(quoted("moved", "a = \"ball\"\n"), 10), 0, 1e-3);
  EXPECT_NEAR(value_of(quoted("lifted", "a = \"plane\"\n"), 10), 0.25 * 0.2, 1e-5);
  EXPECT_NEAR(value_of(quoted("speed", "a = \"plane\"\n"), 3), std::hypot(0.5, 0.25), 1e-5);
  EXPECT_NEAR(value_of(quoted("spin", "a = \"plane\"\n"), 3), 0, 1e-6);
  EXPECT_NEAR(value_of(quoted("upright", "a = \"plane\"\n")), 1, 1e-6);
  EXPECT_NEAR(value_of(quoted("upright", "a = \"plane\"\naxis = [1, 0, 0]\nup = [0, 2, 0]\n")), 1, 1e-6);
  EXPECT_NEAR(value_of(quoted("leaves_box", "a = \"plane\"\nlow = [-1, -1, 0]\nhigh = [1, 1, 1.5]\n")), 0.5,
              1e-6);
  EXPECT_NEAR(value_of(quoted("leaves_box", "a = \"plane\"\nlow = [-1, -1, 0]\nhigh = [1, 1, 3]\n")), 0,
              1e-6);
  EXPECT_NEAR(value_of("term = \"time\"\n", 5), 0.1, 1e-6);
  EXPECT_NEAR(value_of("term = \"constant\"\nscale = 3\n"), 3, 1e-6);
}

TEST(TaskText, TermsOfJointsAndActions) {
  const std::string joint = "joint = \"cart_slide\"\n";
  EXPECT_NEAR(value_of(quoted("joint", joint)), 0, 1e-6);
  EXPECT_NEAR(value_of(quoted("joint", joint), 50, 0.5f), 0.1, 1e-3);
  EXPECT_NEAR(value_of(quoted("joint", joint + "from = 0.2\nto = 0\n"), 50, 0.5f), 0.5, 1e-2);
  EXPECT_NEAR(value_of(quoted("joint_window", "of = \"cart\"\nhigh = 0.04\n"), 50, 0.5f), 0.06, 1e-3);
  EXPECT_NEAR(value_of(quoted("joint_window", "joints = \"*slide\"\nlow = 0.25\nhigh = 0.5\nshare = true\n"),
                       50, 0.5f),
              0.25 * 0.4, 1e-3);
  EXPECT_NEAR(value_of(quoted("joint_speed", "of = \"cart\"\n"), 50, 0.5f), 0, 1e-3);
  EXPECT_GT(value_of(quoted("joint_speed", "of = \"cart\"\n"), 2, 1), 0.1);
  EXPECT_NEAR(value_of(quoted("effort", "of = \"cart\"\n"), 50, 0.5f), 0, 1e-3);
  EXPECT_GT(value_of(quoted("effort", "of = \"cart\"\n"), 1, 1), 0.2);
  EXPECT_NEAR(value_of("term = \"action\"\n", 3, 0.5f), 0.25, 1e-6);
  EXPECT_NEAR(value_of("term = \"action_rate\"\n", 1, 0.5f), 0.25, 1e-6);
  EXPECT_NEAR(value_of("term = \"action_rate\"\nof = \"cart\"\n", 2, 0.5f), 0, 1e-6);
}

TEST(TaskText, TermsOfContacts) {
  const std::string pair = "a = \"ball\"\nb = \"table\"\n";
  EXPECT_NEAR(value_of(quoted("touch", pair), 20), 1, 1e-6);
  EXPECT_NEAR(value_of(quoted("touch", "a = \"cart*\"\nb = \"table\"\n"), 20), 0, 1e-6);
  EXPECT_NEAR(value_of(quoted("force", pair), 50), 0.5 * 9.81, 0.1);
  const Task task(with("[[reward]]\nterm = \"overlap\"\na = \"ball\"\nweight = 1\n"));
  Pool pool("text_test");
  pool.step();
  EXPECT_NEAR(pool.reward(), 0, 2e-3);
}

TEST(TaskText, Curves) {
  const auto curve = [](const std::string& rest) {
    return value_of("term = \"constant\"\ncurve = " + rest + "\n");
  };
  EXPECT_NEAR(curve("\"near\"\nwidth = 0.5"), std::exp(-2), 1e-7);
  EXPECT_NEAR(curve("\"bell\"\nwidth = 0.5"), std::exp(-4), 1e-7);
  EXPECT_NEAR(curve("\"near\"\nwidth = 0.01"), std::exp(-100), 1e-40);
  EXPECT_EQ(curve("\"above\"\nat = 0.5"), 1);
  EXPECT_EQ(curve("\"above\"\nat = 1"), 0);
  EXPECT_EQ(curve("\"below\"\nat = 2"), 1);
  EXPECT_EQ(curve("\"over\"\nat = 0.25"), 0.75);
  EXPECT_EQ(curve("\"under\"\nat = 0.25"), 0);
  EXPECT_EQ(curve("\"under\"\nat = 1.25"), 0.25);
  EXPECT_NEAR(value_of("term = \"time\"\ncurve = \"square\"\n", 5), 0.01, 1e-7);
}

TEST(TaskText, ObservationsOfSeveralNumbers) {
  const auto field = [](const std::string& row, int steps = 0, float action = 0) {
    const Task task(watch(row));
    Pool pool("text_test");
    for (int i = 0; i < steps; ++i) pool.step(action);
    return pool.field("x");
  };
  const auto near = [](const std::vector<double>& x, const std::vector<double>& y, double tolerance = 1e-5) {
    ASSERT_EQ(x.size(), y.size());
    for (size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], y[i], tolerance) << i;
  };
  near(field("term = \"position\"\na = \"ball\"\n"), {0.5, 0.3, 0.04});
  near(field("term = \"position\"\na = \"ball\"\nfrom = \"plane\"\n"), {0.3, -0.5, -1.96});
  near(field("term = \"position\"\na = \"ball\"\nscale = 10\n"), {5, 3, 0.4});
  near(field("term = \"rotation\"\na = \"plane\"\n"), {0, 0, std::sqrt(0.5), std::sqrt(0.5)});
  near(field("term = \"rotation\"\na = \"plane\"\nfrom = \"plane\"\n"), {0, 0, 0, 1});
  near(field("term = \"velocity\"\na = \"plane\"\n", 2), {0.5, 0, 0.25});
  near(field("term = \"velocity\"\na = \"ball\"\nfrom = \"plane\"\n", 2), {0, 0.5, -0.25}, 1e-2);
  near(field("term = \"turning\"\na = \"plane\"\n", 2), {0, 0, 0});
  near(field("term = \"start\"\na = \"plane\"\n", 9), {0, 0, 2});
  near(field("term = \"actions\"\n", 2, 0.25f), {0.25});
  near(field("term = \"joints\"\nof = \"cart\"\nshare = true\n", 50, 0.5f), {0.5}, 1e-2);
  near(field("term = \"rates\"\njoints = \"cart_slide\"\n", 50, 0.5f), {0}, 1e-3);
  near(field("term = \"targets\"\nof = \"cart\"\n", 1, 0), {0}, 1e-3);
  near(field("term = \"torques\"\nof = \"cart\"\n", 50, 0.5f), {0}, 0.1);
}

TEST(TaskText, RewardsCostsAndEnds) {
  const Task task(
      with("[[reward]]\nterm = \"constant\"\nweight = 2\n"
           "[[reward]]\nterm = \"time\"\nchange = true\nweight = 100\n"
           "[[cost]]\nname = \"slow\"\nterm = \"time\"\nabove = 0.05\nlimit = 3\n"
           "[[cost]]\nname = \"sum\"\nterm = \"time\"\nmagnitude = true\nweight = 2\n"
           "[[cost]]\nname = \"sum\"\nterm = \"constant\"\nmagnitude = true\n"
           "[[success]]\nterm = \"time\"\nabove = 0.07\n"
           "[end]\nsuccess = true\nhold = 2\nbonus = 7\n"));
  Pool pool("text_test");
  ASSERT_EQ(pool.spec.cost_dim, 3);
  for (int step = 1; step <= 5; ++step) {
    pool.step();
    const double time = 0.02 * step;
    EXPECT_NEAR(pool.reward(), 2 + 2 + (step == 5 ? 7 : 0), 1e-5) << step;
    EXPECT_EQ(pool.b.cost[0], step >= 3 ? 1 : 0) << step;
    EXPECT_NEAR(pool.b.cost_raw[0], step >= 3 ? time - 0.05 : 0, 1e-6);
    EXPECT_NEAR(pool.b.cost[1], 2 * time + 1, 1e-6);
    EXPECT_EQ(pool.b.cost[2], 0);  // the cart touches no ball
    EXPECT_EQ(pool.b.terminated[0], step == 5) << step;
    EXPECT_EQ(pool.b.success[0], step == 5) << step;
  }
}

TEST(TaskText, FallEnds) {
  const Task task(with("[[fall]]\nterm = \"height\"\na = \"plane\"\nabove = 2.014\n[end]\npenalty = 3\n"));
  Pool pool("text_test");
  pool.step();
  pool.step();
  EXPECT_EQ(pool.b.terminated[0], 0);
  pool.step();
  EXPECT_EQ(pool.b.terminated[0], 1);
  EXPECT_EQ(pool.b.success[0], 0);
  EXPECT_NEAR(pool.reward(), -3, 1e-6);
}

// A mug of the catalogue rests on the table; twice as large its middle is twice as high.
TEST(TaskText, BodiesAreObjectsOfTheCatalogue) {
  const auto settled = [](const char* scale) {
    const Task task(with(std::string("[[body]]\nname = \"cup\"\nobject = \"025_mug\"\np = [1, 1, 0.1]\n") +
                         scale +
                         "[[observe]]\nname = \"x\"\nterm = \"height\"\na = \"cup\"\n"
                         "[[observe]]\nname = \"f\"\nterm = \"force\"\na = \"cup\"\nb = \"table\"\n"));
    Pool pool("text_test");
    for (int i = 0; i < 100; ++i) pool.step();
    rdm_object_def mug{};
    mug.struct_size = sizeof mug;
    int32_t index = -1;
    EXPECT_EQ(rdm_object_find("mug", &index), RDM_OK);
    EXPECT_EQ(rdm_object_get_def(index, &mug), RDM_OK);
    EXPECT_NEAR(pool.number("f"), mug.mass * 9.81, 0.02 * mug.mass * 9.81);
    return pool.number("x");
  };
  const double height = settled("");
  EXPECT_GT(height, 0.02);
  EXPECT_LT(height, 0.06);
  EXPECT_NEAR(settled("scale = 2\n"), 2 * height, 0.002);
}

TEST(TaskText, CamerasRollAndShift) {
  const Task task(
      with("[[camera]]\nname = \"plain\"\neye = [1, 0, 1]\ntarget = [0, 0, 0]\n"
           "[[camera]]\nname = \"odd\"\neye = [1, 0, 1]\ntarget = [0, 0, 0]\nfov = 0.5\n"
           "up = [0, 2, 0]\ncx = 0.25\ncy = -0.5\n"));
  int32_t index = -1;
  ASSERT_EQ(rdm_task_find("text_test", &index), RDM_OK);
  rdm_camera_info plain = RDM_INIT(rdm_camera_info), odd = plain;
  ASSERT_EQ(rdm_task_camera_at(index, 0, &plain), RDM_OK);
  ASSERT_EQ(rdm_task_camera_at(index, 1, &odd), RDM_OK);
  EXPECT_EQ(plain.up[2], 1);
  EXPECT_EQ(plain.cx, 0);
  EXPECT_EQ(odd.up[1], 1);
  EXPECT_EQ(odd.up[2], 0);
  EXPECT_EQ(odd.cx, 0.25f);
  EXPECT_EQ(odd.cy, -0.5f);
  EXPECT_EQ(odd.fov_y, 0.5f);
}

TEST(TaskText, ResetsDraw) {
  std::string text = watch("term = \"position\"\na = \"ball\"\n");
  text.replace(text.find("\"$far\""), 6, "\"-0.25..0.25\"");
  text +=
      "[[draw]]\nwhat = \"body_mass\"\nof = \"ball\"\nfactor = \"2..3\"\n"
      "[[observe]]\nname = \"weight\"\nterm = \"force\"\na = \"ball\"\nb = \"table\"\n";
  const Task task(text);
  Pool pool("text_test", 32);
  double low = 1, high = -1;
  for (int32_t e = 0; e < 32; ++e) {
    const double x = static_cast<double>(pool.b.obs[e * pool.spec.obs_dim]);
    low = std::min(low, x), high = std::max(high, x);
  }
  EXPECT_LT(low, -0.15);
  EXPECT_GE(low, -0.25);
  EXPECT_GT(high, 0.15);
  EXPECT_LE(high, 0.25);
  for (int i = 0; i < 40; ++i) pool.step();
  const double weight = pool.number("weight");
  EXPECT_GT(weight, 0.5 * 9.81 * 1.95);
  EXPECT_LT(weight, 0.5 * 9.81 * 3.05);
  // An option that is a range draws too.
  const Task other([] {
    std::string t = watch("term = \"position\"\na = \"ball\"\n");
    return t.replace(t.find("text_test"), 9, "text_two");
  }());
  Pool two("text_two", 8, "far=0.5..1");
  EXPECT_NE(two.b.obs[0], two.b.obs[two.spec.obs_dim]);
}

TEST(TaskText, TakesEachOptionOfTimeAndSolver) {
  for (const rdm::OptionSpec& row : rdm::kSimulationRows.specs) {
    SCOPED_TRACE(row.key);
    std::string line = std::string(row.key) + " = ";
    if (row.kind == rdm::OptionKind::kText)
      line += std::string("\"") + row.text + '"';
    else if (row.kind == rdm::OptionKind::kFlag)
      line += row.number != 0 ? "true" : "false";
    else
      line += std::to_string(row.number);
    std::string text = with("");
    text.replace(text.find("frequency = 50"), 14, line);
    const Task task(text);
  }
}

struct Wrong {
  const char *from, *to, *text;  // of the file, and of the refusal
};
TEST(TaskText, RefusalsNameLineAndKey) {
  const std::string good = with("");
  for (const Wrong& w : std::vector<Wrong>{
           {"[task]", "[tsk]", "t.task: line 1: tsk is not a known key; nearest is task"},
           {"max_steps = 200", "max_steps = 0",
            "t.task: line 3: task: max_steps: 0 is not a whole number in [1, 100000]"},
           {"frequency = 50", "frequncy = 50",
            "line 6: options: frequncy: no task has an option of this name; nearest is frequency"},
           {"default = 0.5", "default = 5", "line 7: options: far: default: 5 is outside [0, 2]"},
           {"p = [0, 0, 0.5]", "p = [\"0..1\", 0, 0.5]",
            "line 8: tree cart: p, rpy: a tree with a fixed base cannot be moved at a reset, so no range is "
            "allowed"},
           {"\"position\"", "\"postion\"",
            "line 11: tree cart: control: postion is unknown; nearest is position"},
           {"kp = 400", "kpp = 400", "line 19: tree cart: link box: kpp is not a known key; nearest is kp"},
           {"mass = 1\n", "mass = \"$mas\"\n", "line 22: tree cart: link box: mass: option mas: unknown"},
           {"kind = \"sphere\"", "kind = \"ball\"", "line 31: body ball: kind: ball is unknown"},
           {"mass = 0.5", "mass = -1", "line 29: body ball: body ball: mass -1 is not above 0"},
           {"size = [0.04]", "size = [0.04, 0.1]", "line 32: body ball: size: this kind has 1 number"},
           {"size = [0.04]", "size = [0.04]\npoints = [[0, 0, 0]]",
            "line 33: body ball: points: only a hull has points"},
           {"kind = \"sphere\"\nsize = [0.04]\nmass = 0.5", "object = \"mugg\"",
            "line 31: body ball: object mugg: unknown; nearest is mug"},
           {"kind = \"sphere\"", "object = \"mug\"", "line 33: body ball: mass is not a known key"},
           {"\"$far\"", "\"$fer\"", "line 34: body ball: p: option fer: unknown; nearest is far"},
           {"\"$far\"", "\"1..0\"", "line 34: body ball: p: 1..0 is not a range \"a..b\" with a <= b"},
           {"\"$far\"", "\"1..2x\"", "line 34: body ball: p: 1..2x is not a range"},
           {"name = \"plane\"", "name = \"ball\"", "the name ball is already used"},
           {"rpy = [0, 0, 1.5707963267948966]", "rpy = [0, 0, 1]\nq = [0, 0, 0, 1]",
            "line 42: body plane: it has both q and rpy; give one of them"},
           {"term = \"joints\"", "term = \"jonts\"",
            "line 48: observe jonts: term: jonts is unknown; nearest is joints"},
           {"of = \"cart\"", "of = \"crt\"",
            "line 49: observe joints: of: there is no robot crt; nearest is cart"},
           {"of = \"cart\"", "of = \"cart\"\nat = 1", "line 50: observe joints: at is not a known key"},
           {"name = \"touch\"", "name = 3", "line 51: cost touch: name is not a string"},
           {"term = \"touch\"", "term = \"joints\"",
            "line 52: cost touch: term: joints gives several numbers, but one is needed"},
           {"b = \"ball\"", "b = \"bll\"", "line 53: cost touch: b bll: unknown; nearest is ball"},
           {"limit = 5", "limit = \"x\"", "line 55: cost touch: limit is not a number"},
           {"[[cost]]\n", "", "cannot redefine existing"},
           {"control = \"position\"\n", "", "nothing is moved by actions"},
           {"[[observe]]", "[[observe]", "t.task: line 47: "},
           // what the library refuses, at the row that it is of
           {"name = \"touch\"", "name = \"a b\"",
            "t.task: line 50: cost a b: name: a b may contain only letters"},
           {"limit = 5", "limit = inf", "line 50: cost touch: limit of touch is not finite"},
           {"far = {", "\"f r\" = {", "line 7: options: f r: key: f r may contain only letters"},
           {"low = 0, high = 2", "low = 0.5, high = 0.5",
            "line 7: options: far: low 0.5 of far is not below high 0.5"},
           {"name = \"text_test\"", "name = \"text test\"",
            "line 1: task: name: text test may contain only letters"},
           {"kind = \"plane\"", "kind = \"hull\"\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]",
            "line 44: static table: table: the points lie in one plane, or too close to each other"},
           {"kind = \"plane\"", "kind = \"box\"\nsize = [1, 1, 0]",
            "line 44: static table: table: half size 0"},
           {"mass = 0.2", "moment = [1, 1, 1, 0, 0, 0]\nmass = 0.2\nmaterial = \"none\"",
            "line 35: body plane: material none: unknown"},
       }) {
    std::string text = good;
    const size_t at = text.find(w.from);
    ASSERT_NE(at, std::string::npos) << w.from;
    text.replace(at, std::strlen(w.from), w.to);
    int32_t task = -7;
    EXPECT_NE(rdm_import_read_task(&task, text.data(), text.size(), "t.task"), RDM_OK) << w.to;
    EXPECT_NE(std::string(rdm_import_error()).find(w.text), std::string::npos)
        << rdm_import_error() << "\n  wanted " << w.text;
    EXPECT_EQ(task, -7);
    int32_t found = -1;
    EXPECT_EQ(rdm_task_find("text_test", &found), RDM_ERROR_NOT_FOUND) << "left behind";
  }
  int32_t task = -1;
  EXPECT_EQ(rdm_import_read_task_file(&task, "/nowhere/x.task"), RDM_ERROR_NOT_FOUND);
  EXPECT_EQ(rdm_import_read_task_file(nullptr, "x"), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_read_task(&task, nullptr, 4, nullptr), RDM_ERROR_ARGUMENT);
  const Task one(good);
  EXPECT_EQ(rdm_import_read_task(&task, good.data(), good.size(), nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_import_error(), "line 1: task text_test: the name is already used");
}

// As a bin of many objects is written: those that are placed are not counted, and the text says what is.
TEST(TaskText, BodiesWithARangeAreBounded) {
  const auto bodies = [](int count, const char* y) {
    std::string text;
    for (int k = 0; k < count; ++k) {
      const std::string at = std::to_string(k);
      text += "[[body]]\nname = \"b" + at + "\"\nkind = \"sphere\"\nsize = [0.01]\nmass = 0.1\np = [" + at +
              ", " + y + ", 1]\n";
    }
    return text;
  };
  const std::string good = with("");
  const auto refusal = [&](const std::string& more) -> std::string {
    int32_t task = -1;
    const std::string text = good + more;
    if (rdm_import_read_task(&task, text.data(), text.size(), "t.task") != RDM_OK) return rdm_import_error();
    EXPECT_EQ(rdm_task_destroy(task), RDM_OK);
    return "";
  };
  EXPECT_EQ(refusal(bodies(100, "0")), "");
  EXPECT_NE(refusal(bodies(65, "\"0..1\""))
                .find("body b63: there are more than 64 bodies with a range in p, rpy, v or w"),
            std::string::npos);
}

TEST(TaskText, TermRefusals) {
  for (const auto& [row, text] : std::map<std::string, std::string>{
           {"term = \"distance\"\na = \"ball\"\n", "b is missing"},
           {"term = \"distance\"\na = \"bal\"\nb = \"cart\"\n",
            "a: there is no body, robot, link or shape bal; nearest is ball"},
           {"term = \"constant\"\ncurve = \"near\"\n", "width is missing"},
           {"term = \"constant\"\ncurve = \"near\"\nwidth = 0\n", "width: 0 is not above 0"},
           {"term = \"constant\"\nwidth = 1\n", "width: only the curves near and bell have one"},
           {"term = \"constant\"\ncurve = \"above\"\n", "at is missing"},
           {"term = \"overlap\"\na = \"ball\"\n", "overlap cannot be observed"},
           {"term = \"joint\"\njoint = \"cart_slid\"\n", "nearest is cart_slide"},
           {"term = \"joint\"\njoint = \"cart_slide\"\nfrom = 1\n", "from and to are equal"},
           {"term = \"leaves_box\"\na = \"ball\"\nlow = [0, 0, 0]\nhigh = [1, 0, 1]\n",
            "low 0 is not below high 0"},
           {"term = \"joint_window\"\nof = \"cart\"\nlow = 1\nhigh = 0\n", "low 1 is not below high 0"},
           {"term = \"tip_force\"\na = \"cart_box\"\n", "sensor cart_box: unknown"},
           {"term = \"upright\"\na = \"ball\"\naxis = [0, 0, 0]\n", "axis has no direction"}}) {
    const std::string file = watch(row);
    int32_t task = -1;
    EXPECT_NE(rdm_import_read_task(&task, file.data(), file.size(), nullptr), RDM_OK) << row;
    EXPECT_NE(std::string(rdm_import_error()).find(text), std::string::npos) << rdm_import_error();
  }
}

// What examples/07_own_task.c says in C.
const char kPress[] =
    "[task]\nname = \"press_text\"\nmax_steps = 60\n"
    "[[robot]]\nname = \"hand\"\nrobot = \"shadow_hand\"\np = [0, 0, 0.1]\nq = [0, 1, 0, 0]\n"
    "[[tree]]\nname = \"button\"\np = [-0.033, -0.43, 0.03]\n"
    "[[tree.link]]\nname = \"cap\"\njoint = \"spring\"\nparent = \"root\"\nkind = \"prismatic\"\naxis = [0, "
    "0, "
    "1]\nrange = [-0.01, 0]\nkp = 100\nkd = 2\neffort = 2\nmass = 0.02\nmoment = [1e-5, 1e-5, 1e-5, 0, 0, "
    "0]\n"
    "[[tree.shape]]\nname = \"top\"\nlink = \"cap\"\nkind = \"cylinder\"\nsize = [0.012, 0.006]\n"
    "[[body]]\nname = \"cup\"\nkind = \"cylinder\"\nsize = [0.02, 0.025]\np = [0.01, -0.43, 0.025]\nmass = "
    "0.1\n"
    "[[static]]\nname = \"ground\"\nkind = \"plane\"\n"
    "[[observe]]\nterm = \"joints\"\njoints = [\"hand*\", \"button*\"]\n"
    "[[observe]]\nterm = \"rates\"\njoints = [\"hand*\", \"button*\"]\nname = \"rates\"\nscale = 0.1\n"
    "[[observe]]\nterm = \"position\"\na = \"cup\"\n"
    "[[reward]]\nterm = \"joint\"\njoint = \"button_spring\"\nfrom = 0\nto = -0.01\nweight = 1\n"
    "[[reward]]\nterm = \"distance\"\na = \"hand_ff_distal\"\nb = \"button_cap\"\nalong = [0, 1, 0]\nweight "
    "= -5\n"
    "[[reward]]\nterm = \"distance\"\na = \"hand_ff_distal\"\nb = \"button_cap\"\nalong = [0, 0, 1]\nweight "
    "= -5\n"
    "[[cost]]\nname = \"touch\"\nterm = \"touch\"\na = \"hand\"\nb = \"cup\"\nlimit = 5\n"
    "[[success]]\nterm = \"joint\"\njoint = \"button_spring\"\nfrom = 0\nto = -0.01\nabove = 0.8\n";

TEST(TaskText, IsTheTaskThatTheSeventhExampleWritesInC) {
  std::string text = kPress, start = "start = [";
  for (int i = 0; i < 24; ++i) start += i ? ", \"0..0.1\"" : "\"0..0.1\"";
  const std::string hand = "robot = \"shadow_hand\"\n";
  text.insert(text.find(hand), start + "]\n");
  const Task task(text);
  ASSERT_EQ(redman_plugin(), RDM_OK) << rdm_last_error();
  Pool told("press_text", 3), written("press", 3);
  ASSERT_EQ(told.spec.action_dim, written.spec.action_dim);
  ASSERT_EQ(told.spec.obs_dim, written.spec.obs_dim);
  const auto same_rows = [&] {
    for (int32_t i = 0; i < 3 * told.spec.obs_dim; ++i) ASSERT_EQ(told.b.obs[i], written.b.obs[i]) << i;
  };
  same_rows();
  for (int step = 0; step < 40; ++step) {
    told.random_step();
    std::copy_n(told.b.action, 3 * told.spec.action_dim, written.b.action);
    ASSERT_EQ(rdm_pool_step(written.pool), RDM_OK) << rdm_last_error();
    same_rows();
    for (int32_t e = 0; e < 3; ++e) {
      EXPECT_NEAR(told.b.reward[e], written.b.reward[e], 1e-6) << step;
      EXPECT_EQ(told.b.cost[e], written.b.cost[e]);
      EXPECT_EQ(told.b.cost_raw[e], written.b.cost_raw[e]);
    }
  }
  EXPECT_EQ(rdm_task_check("press_text", nullptr, nullptr, nullptr, nullptr, 0), RDM_OK) << rdm_last_error();
  int32_t press = -1;
  ASSERT_EQ(rdm_task_find("press", &press), RDM_OK);
  EXPECT_EQ(rdm_task_destroy(press), RDM_OK);
}

TEST(TaskText, FilesThatShipKeepWhatATaskPromises) {
  int32_t task = -1;
  ASSERT_EQ(rdm_import_read_task_file(&task, (kScenes + "press.task").c_str()), RDM_OK) << rdm_import_error();
  EXPECT_EQ(rdm_task_check("press_button", nullptr, nullptr, nullptr, nullptr, 0), RDM_OK)
      << rdm_last_error();
  uint64_t hashes[3];
  for (int32_t threads = 0; threads < 3; ++threads) {
    Pool pool("press_button", 6, nullptr, threads);
    for (int i = 0; i < 15; ++i) pool.random_step();
    hashes[threads] = pool.hash();
    if (threads == 2) {  // saved, gone on, and put back
      const auto bytes = written_bytes([&](void* out, size_t n, size_t* size) {
        return rdm_pool_write_state(pool.pool, -1, out, n, size);
      });
      for (int i = 0; i < 10; ++i) pool.step(0.5f);
      const uint64_t later = pool.hash();
      ASSERT_EQ(rdm_pool_read_state(pool.pool, -1, bytes.data(), bytes.size()), RDM_OK) << rdm_last_error();
      EXPECT_EQ(pool.hash(), hashes[2]);
      for (int i = 0; i < 10; ++i) pool.step(0.5f);
      EXPECT_EQ(pool.hash(), later);
    }
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
  EXPECT_EQ(rdm_task_destroy(task), RDM_OK);
}

TEST(TaskText, HandsOnArmsLeftOnesAndOptions) {
  const std::string text =
      "[task]\nname = \"text_arms\"\n[options]\nhand = { default = \"allegro\", choices = [\"allegro\", "
      "\"shadow_hand\", \"svh\"] }\n"
      "[[robot]]\nname = \"right\"\narm = \"ur5e\"\nhand = \"$hand\"\ngravity = true\ncompensate = "
      "true\ncontrol = "
      "\"velocity\"\n"
      "[[robot]]\nname = \"left\"\nrobot = \"shadow_hand\"\nleft = true\np = [2, 0, 1]\nfree_base = "
      "true\npush = "
      "[10, 1]\n"
      "[[observe]]\nname = \"to_thumb\"\nterm = \"distance\"\na = \"left.ff\"\nb = \"left.th\"\n"
      "[[observe]]\nname = \"to_wrist\"\nterm = \"distance\"\na = \"left.ff\"\nb = \"left_wrist\"\n"
      "[[observe]]\nname = \"palm\"\nterm = \"position\"\na = \"right.palm\"\n"
      "[[observe]]\nname = \"forces\"\nterm = \"tip_forces\"\na = \"left.ff\"\n"
      "[[cost]]\nname = \"speed\"\nterm = \"joint_speed\"\nof = \"right\"\nabove = 2\n";
  const Task task(text);
  // A mirror image keeps what lies between two tips, and that between a tip and a joint's frame.
  int32_t hand = -1;
  ASSERT_EQ(rdm_robot_find("shadow_hand", &hand), RDM_OK);
  double home[RDM_MAX_LINKS], tips[3 * 8];
  rdm_pose links[RDM_MAX_LINKS];
  ASSERT_EQ(rdm_robot_get_postures(hand, nullptr, home, nullptr, nullptr), RDM_OK);
  ASSERT_EQ(rdm_robot_get_poses(hand, home, links, nullptr, tips, nullptr), RDM_OK);
  const auto between = [](const double* a, const double* b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  };
  Pool pool("text_arms");
  EXPECT_EQ(pool.spec.action_dim, 6 + 16 + 20 + 6);
  EXPECT_NEAR(pool.number("to_thumb"), between(tips, tips + 12), 1e-5);
  EXPECT_NEAR(pool.number("to_wrist"), between(tips, links[0].p), 1e-5);
  const auto before = pool.field("palm");
  for (int i = 0; i < 60; ++i) pool.step();
  const auto after = pool.field("palm");
  for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(after[k], before[k], 2e-3) << "the arm sags";
  Pool other("text_arms", 1, "hand=shadow_hand");
  EXPECT_EQ(other.spec.action_dim, 6 + 20 + 20 + 6);
  EXPECT_EQ(rdm_task_check("text_arms", nullptr, nullptr, nullptr, nullptr, 0), RDM_OK) << rdm_last_error();
}

}  // namespace
