// The .task file: TOML, one table for each row of rdm_task_def and of a scene's parts, and lists of terms in
// the place of a task's functions. Read whole when it is registered; `build` makes the scene and the program
// of terms (task_program.hpp) anew for each pool, since numbers may be options of it.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "base/chars.hpp"
#include "base/names.hpp"
#include "task_program.hpp"
#include "toml_text.hpp"

namespace rdm::import {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Options that every task has, of which a file gives its own default.
constexpr const char* kShared[] = {"engine",
                                   "frequency",
                                   "substeps",
                                   "iterations",
                                   "gravity",
                                   "relaxation",
                                   "erp",
                                   "cfm",
                                   "contact_erp",
                                   "contact_cfm",
                                   "contact_layer",
                                   "contact_max_speed",
                                   "contacts_max",
                                   "limit_margin",
                                   "contacts_per_pair",
                                   "limit_stiffness",
                                   "link_armature",
                                   "effort_bounds",
                                   "integrator",
                                   "precision",
                                   "lanes",
                                   "sleep_time",
                                   "sleep_speed",
                                   "sleep_spin",
                                   "speculative_contacts"};

struct TextTask {
  std::string file;
  toml::table root;
  std::deque<std::string> texts;
  std::vector<rdm_field_def> fields;
  std::vector<rdm_cost> costs;
  std::vector<rdm_option_info> options;
  std::vector<rdm_camera> cameras;
  std::vector<rdm_option> defaults;
  struct Row {  // where a row of rdm_task_def stands in the file
    std::string def;
    int line;
    std::string what;
  };
  std::vector<Row> rows;
  void stands(const char* list, size_t row, int line, const std::string& what) {
    rows.push_back({format("def.%s[%zu]", list, row), line, what});
  }
  const char* keep(std::string text) {
    texts.push_back(std::move(text));
    return texts.back().c_str();
  }
};

// ---- terms ----
enum Keys : uint32_t {  // what a term is about
  kA = 1,               // a = place
  kB = 2,               // b = place
  kFrom = 4,            // from = place, else the world
  kShapesAB = 8,        // a, b = names of shapes
  kJointsOf = 16,       // of = robot, or joints = patterns
  kOneJoint = 32,       // joint = name, from, to = numbers
  kActionOf = 64,       // of = robot, else all
  kBox = 128,           // low, high = [3], from = place
  kWindow = 256,        // low, high = numbers, share = flag
  kAxis = 512,          // axis, up = [3]
  kBodyA = 1024,        // a = body
  kTipA = 2048,         // a = robot.finger, or a link with a sensor
  kStart = 4096,        // a's place at the start is kept
  kShare = 8192,        // share = flag
  kPlane = 16384,       // along = [3]
  kMany = 1 << 20       // several numbers
};
struct TermRow {
  const char* name;
  What what;
  uint32_t keys;
  const char* unit;
};
constexpr TermRow kTerms[] = {
    {"constant", What::kConstant, 0, "1"},
    {"time", What::kTime, 0, "s"},
    {"distance", What::kDistance, kA | kB | kPlane, "m"},
    {"touch", What::kTouch, kShapesAB, "1"},
    {"force", What::kForce, kShapesAB, "N"},
    {"joint", What::kJoint, kOneJoint, "rad"},
    {"moved", What::kMoved, kA | kStart, "m"},
    {"lifted", What::kLifted, kA | kStart, "m"},
    {"height", What::kHeight, kA, "m"},
    {"upright", What::kUpright, kA | kAxis, "1"},
    {"speed", What::kSpeed, kA, "m/s"},
    {"spin", What::kSpin, kA, "rad/s"},
    {"joint_window", What::kJointWindow, kJointsOf | kWindow, "rad"},
    {"effort", What::kEffort, kJointsOf, "1"},
    {"joint_speed", What::kJointSpeed, kJointsOf, "rad/s"},
    {"action", What::kAction, kActionOf, "1"},
    {"action_rate", What::kActionRate, kActionOf, "1"},
    {"leaves_box", What::kLeavesBox, kA | kBox, "m"},
    {"overlap", What::kOverlap, kBodyA, "m"},
    {"tip_force", What::kSensor, kTipA, "N"},
    {"joints", What::kJoints, kJointsOf | kShare | kMany, "rad"},
    {"rates", What::kRates, kJointsOf | kMany, "rad/s"},
    {"targets", What::kTargets, kJointsOf | kMany, "rad"},
    {"torques", What::kTorques, kJointsOf | kShare | kMany, "N m"},
    {"position", What::kPosition, kA | kFrom | kMany, "m"},
    {"rotation", What::kRotation, kA | kFrom | kMany, "1"},
    {"velocity", What::kVelocity, kA | kFrom | kMany, "m/s"},
    {"turning", What::kTurning, kA | kFrom | kMany, "rad/s"},
    {"tip_forces", What::kTip, kTipA | kMany, "N"},
    {"actions", What::kActions, kActionOf | kMany, "1"},
    {"start", What::kWhere, kA | kStart | kMany, "m"},
};
constexpr const char* kCurves[] = {"value", "near", "bell", "above", "below", "over", "under", "square"};

const TermRow& term_of(const Table& t, bool many) {
  const toml::node& n = t.need("term");
  const std::string name = t.as_text(n, "term");
  std::vector<std::string> names;
  for (const TermRow& row : kTerms) {
    if (!many && (row.keys & kMany)) continue;
    if (name == row.name) return row;
    names.emplace_back(row.name);
  }
  for (const TermRow& row : kTerms)
    if (name == row.name) t.bad(RDM_ERROR_FORMAT, line_of(n), "term: %s is several numbers", row.name);
  t.bad(RDM_ERROR_FORMAT, line_of(n), "term: %s is not known%s", clean(name).c_str(),
        nearest_hint(name, names).c_str());
}

// "cup.position" where a field has no name of its own.
std::string field_name(const Table& t) {
  const toml::node* given = t.find("name");
  std::string out = given ? t.as_text(*given, "name") : "";
  if (out.empty()) {
    for (const char* key : {"a", "of", "joint", "joints"})
      if (const toml::node* n = t.find(key); n && n->is_string() && out.empty())
        out = n->as_string()->get() + '.';
    out += t.as_text(t.need("term"), "term");
  }
  for (char& c : out)
    if (!std::isalnum(static_cast<unsigned char>(c)) && !std::strchr("_-.", c)) c = '_';
  constexpr size_t kLongest = 31;
  if (out.size() > kLongest)
    t.bad(RDM_ERROR_RANGE, line_of(t.t), "name: %s has more than %zu characters", clean(out).c_str(),
          kLongest);
  return out;
}

// ---- options, as numbers and texts that begin with '$' ----
class SceneOptions : public Lookup {
 public:
  explicit SceneOptions(rdm_scene* scene) : scene_(scene) {}
  double number(const std::string& key) const override {
    double low = 0, high = 0, value = 0;
    if (rdm_scene_get_range(scene_, key.c_str(), &low, &high) == RDM_OK && low != high)
      refuse(RDM_ERROR_RANGE, "option %s is a range, %g..%g: nothing is drawn here", clean(key).c_str(), low,
             high);
    check(rdm_scene_get_number(scene_, key.c_str(), &value));
    return value;
  }
  std::string text(const std::string& key) const override {
    const char* text = nullptr;
    check(rdm_scene_get_text(scene_, key.c_str(), &text));
    return text;
  }
  Span range(const std::string& key) const {
    Span s{};
    if (rdm_scene_get_range(scene_, key.c_str(), &s.low, &s.high) == RDM_OK) return s;
    check(rdm_scene_get_number(scene_, key.c_str(), &s.low));
    s.high = s.low;
    return s;
  }

 private:
  static void check(rdm_result r) {
    if (r != RDM_OK) refuse(r, "%s", rdm_last_error());
  }
  rdm_scene* scene_;
};

void check(const Table& t, int line, rdm_result r) {
  if (r != RDM_OK) t.bad(r, line, "%s", rdm_last_error());
}

// ---- what is there once, when the task is registered ----
class Registration {
 public:
  explicit Registration(TextTask* task) : task_(*task), top_{task->root, "", nullptr} {}

  rdm_task_def def() {
    top_.only({"task", "options", "learn", "material", "friction", "robot", "tree", "body", "static", "draw",
               "camera", "observe", "reward", "cost", "success", "fall", "end"});
    rdm_task_def d;
    rdm_task_def_init(&d, sizeof d);
    if (!top_.find("task")) top_.bad(RDM_ERROR_FORMAT, 1, "no [task]");
    const Table t = top_.section("task");
    t.only({"name", "summary", "max_steps", "obs_limit", "gravity"});
    d.name = task_.keep(t.as_text(t.need("name"), "name"));
    d.summary = task_.keep(t.text("summary", ""));
    d.max_steps = t.integer("max_steps", 100, 1, 100000);
    d.obs_limit = 5;
    t.number("obs_limit", &d.obs_limit);
    fields();
    costs();
    options();
    cameras();
    defaults();
    const auto give = [](const auto& rows, auto* array, int32_t* count) {
      *array = rows.data();
      *count = static_cast<int32_t>(rows.size());
    };
    give(task_.fields, &d.fields, &d.num_fields);
    give(task_.costs, &d.costs, &d.num_costs);
    give(task_.options, &d.options, &d.num_options);
    give(task_.cameras, &d.cameras, &d.num_cameras);
    give(task_.defaults, &d.defaults, &d.num_defaults);
    d.action_dim = 1;  // build says
    d.state_bytes = sizeof(State);
    d.instance_bytes = sizeof(Program);
    d.user = &task_;
    return d;
  }

 private:
  void fields() {
    for (const Table& t : top_.rows("observe")) {
      const TermRow& row = term_of(t, true);
      double scale = 1;
      if (const toml::node* n = t.find("scale"); n && !n->is_string()) scale = t.as_number(*n, "scale");
      std::string unit = t.text("unit", row.unit);
      if (!t.find("unit") && scale != 1) unit = format("%g %s", 1 / scale, row.unit);
      task_.stands("fields", task_.fields.size(), line_of(t.t), t.what);
      task_.fields.push_back({task_.keep(field_name(t)), task_.keep(unit), 1, 0, 0, 0});
    }
    if (task_.fields.empty()) top_.bad(RDM_ERROR_FORMAT, 1, "no [[observe]]");
  }
  void costs() {
    for (const Table& t : top_.rows("cost")) {
      const char* name = task_.keep(t.as_text(t.need("name"), "name"));
      double limit = -1;
      t.number("limit", &limit);
      const auto same = [&](const rdm_cost& c) { return same_name(c.name, name); };
      const auto there = std::find_if(task_.costs.begin(), task_.costs.end(), same);
      if (there == task_.costs.end()) {
        if (task_.costs.size() == RDM_MAX_COSTS)
          t.bad(RDM_ERROR_RANGE, line_of(t.t), "more than %d costs", RDM_MAX_COSTS);
        task_.stands("costs", task_.costs.size(), line_of(t.t), t.what);
        task_.costs.push_back({name, task_.keep(t.text("help", term_of(t, false).name)), limit});
      } else if (t.find("limit") || t.find("help")) {
        t.bad(RDM_ERROR_FORMAT, line_of(t.t), "limit, help: the first row of a cost has them");
      }
    }
    if (task_.costs.empty()) top_.bad(RDM_ERROR_FORMAT, 1, "no [[cost]]");
  }
  void options() {
    const Table all = top_.section("options");
    for (const auto& [key, value] : all.t) {
      const std::string name(key.str());
      rdm_option_info o{};
      o.key = task_.keep(name);
      const toml::table* own = value.as_table();
      const Table t{own ? *own : all.t, "options: " + clean(name), nullptr};
      if (own)
        own_option(t, &o);
      else
        shared_option(t, value, &o);
      task_.stands("options", task_.options.size(), line_of(key.source()), t.what);
      task_.options.push_back(o);
    }
  }
  void own_option(const Table& t, rdm_option_info* o) {
    t.only({"default", "low", "high", "help", "integer", "range", "choices"});
    const toml::node& n = t.need("default");
    o->help = task_.keep(t.text("help", "of the task's file"));
    if (n.is_boolean()) {
      o->kind = RDM_KIND_FLAG;
      o->number = n.as_boolean()->get() ? 1 : 0;
      o->high = 1;
    } else if (n.is_string()) {
      o->kind = RDM_KIND_TEXT;
      o->text = task_.keep(t.as_text(n, "default"));
      if (const toml::node* c = t.find("choices")) {
        const toml::array* words = c->as_array();
        if (!words || words->empty()) t.bad(RDM_ERROR_FORMAT, line_of(*c), "choices is no list of texts");
        std::string joined;
        for (const toml::node& word : *words)
          joined += (joined.empty() ? "" : "|") + t.as_text(word, "choices");
        o->choices = task_.keep(joined);
      }
    } else {
      o->kind = t.flag("integer") ? RDM_KIND_INTEGER : RDM_KIND_NUMBER;
      o->number = t.as_number(n, "default");
      o->low = t.as_number(t.need("low"), "low");
      o->high = t.as_number(t.need("high"), "high");
      if (t.flag("range", o->kind == RDM_KIND_NUMBER)) o->choices = "a..b";
      if (!(o->low <= o->number && o->number <= o->high))
        t.bad(RDM_ERROR_RANGE, line_of(n), "default: %g is outside [%g, %g]", o->number, o->low, o->high);
    }
  }
  void shared_option(const Table& t, const toml::node& value, rdm_option_info* o) {
    std::vector<std::string> names(std::begin(kShared), std::end(kShared));
    const bool known = std::any_of(names.begin(), names.end(),
                                   [&](const std::string& name) { return same_name(name, o->key); });
    if (!known)
      t.bad(RDM_ERROR_NOT_FOUND, line_of(value),
            "it is none that every task has%s; one of your own is { default = , low = , high = , help = }",
            nearest_hint(o->key, names).c_str());
    rdm_task first{};
    first.struct_size = sizeof first;
    check(t, line_of(value), rdm_task_at(0, &first));
    for (int32_t i = 0; i < first.num_options; ++i) {
      rdm_option_info row;
      check(t, line_of(value), rdm_task_option(0, i, &row));
      if (!same_name(row.key, o->key)) continue;
      o->kind = row.kind;
      if (row.kind == RDM_KIND_TEXT)
        o->text = task_.keep(t.as_text(value, o->key));
      else if (const auto* flag = value.as_boolean())
        o->number = flag->get() ? 1 : 0;
      else
        o->number = t.as_number(value, o->key);
    }
  }
  void cameras() {
    for (const Table& t : top_.rows("camera")) {
      t.only({"name", "eye", "target", "fov"});
      rdm_camera c{};
      c.name = task_.keep(t.as_text(t.need("name"), "name"));
      const auto eye = t.list(t.need("eye"), "eye", 3, 3), target = t.list(t.need("target"), "target", 3, 3);
      for (size_t k = 0; k < 3; ++k) {
        c.eye[k] = static_cast<float>(eye[k]);
        c.target[k] = static_cast<float>(target[k]);
      }
      double fov = 0.785398163397448;
      t.number("fov", &fov);
      c.fov_y = static_cast<float>(fov);
      task_.stands("cameras", task_.cameras.size(), line_of(t.t), t.what);
      task_.cameras.push_back(c);
    }
  }
  void defaults() {
    const Table all = top_.section("learn");
    for (const auto& [key, value] : all.t) {
      const std::string name(key.str());
      rdm_option o{task_.keep(name), nullptr, 0};
      if (value.is_string())
        o.text = task_.keep(all.as_text(value, name.c_str()));
      else if (const auto* flag = value.as_boolean())
        o.number = flag->get() ? 1 : 0;
      else
        o.number = all.as_number(value, name.c_str());
      task_.stands("defaults", task_.defaults.size(), line_of(key.source()), "learn: " + clean(name));
      task_.defaults.push_back(o);
    }
  }

  TextTask& task_;
  Table top_;
};

// ---- the scene and the program, at build ----
std::atomic<uint32_t> g_mounted{0};

struct Listed {  // a robot that is in the process's list for a while
  int32_t robot = -1;
  ~Listed() {
    if (robot >= 0) rdm_robot_destroy(robot);
  }
};

struct Part {  // a robot or a tree
  explicit Part(const Table& table) : t(table) {}
  Table t;
  std::unique_ptr<Draft> draft = std::make_unique<Draft>();
  std::string name;
  bool left = false;
  int32_t listed = -1;  // -1: the draft itself
  double p[3] = {}, q[4] = {0, 0, 0, 1};
  std::vector<double> start;  // by flange, of the first joints
};

class Builder {
 public:
  Builder(const TextTask& task, rdm_scene* scene, Program* p)
      : scene_(scene), p_(*p), options_(scene), top_{task.root, "", &options_} {}

  void build() {
    const Table task = top_.section("task");
    if (const toml::node* n = task.find("gravity")) {
      const auto g = task.list(*n, "gravity", 3, 3);
      check(task, line_of(*n), rdm_scene_set_gravity(scene_, g.data()));
    }
    materials();
    for (const Table& t : top_.rows("robot")) add_robot(t);
    for (const Table& t : top_.rows("tree")) add_tree(t);
    for (const Table& t : top_.rows("body")) add_body(t);
    for (const Table& t : top_.rows("static")) add_static(t);
    if (compensated_) check(top_, 1, rdm_scene_set_feedforward(scene_));
    const auto draws = top_.rows("draw");
    if (!draws.empty()) check(draws[0], line_of(draws[0].t), rdm_scene_set_adjustable(scene_));
    if (!joint_names_.empty()) {  // the first look at the whole scene: what is wrong then is no robot's fault
      rdm_joint first;
      if (const rdm_result r = rdm_scene_joint_at(scene_, 0, &first)) refuse(r, "%s", rdm_last_error());
    }
    for (size_t i = 0; i < parts_.size(); ++i) add_player(i);
    if (p_.num_actions == 0) top_.bad(RDM_ERROR_FORMAT, 1, "nothing is moved by actions: a [[robot]] is");
    check(top_, 1, rdm_scene_set_actions(scene_, p_.num_actions, hold_.data(), hold_.data()));
    for (const Table& t : draws) add_factor(t);
    all_terms();
  }

 private:
  // -- numbers --
  Span span(const Table& t, const toml::node& n, const char* key) const {
    if (const auto* x = n.as_string()) {
      const std::string& text = x->get();
      if (text.size() > 1 && text[0] == '$') {
        try {
          return options_.range(text.substr(1));
        } catch (const Refusal& r) {
          t.bad(r.code, line_of(n), "%s: %s", key, r.text.c_str());
        }
      }
      const size_t dots = text.find("..");
      Span s{};
      const auto read = [&](size_t from, size_t to, double* out) {
        const char* end = text.data() + to;
        const auto r = from_chars(text.data() + from, end, *out);
        return r.ec == std::errc() && r.ptr == end && std::isfinite(*out);
      };
      if (dots == std::string::npos || !read(0, dots, &s.low) || !read(dots + 2, text.size(), &s.high) ||
          !(s.low <= s.high))
        t.bad(RDM_ERROR_FORMAT, line_of(n), "%s: %s is no range \"a..b\" with a <= b", key,
              clean(text).c_str());
      return s;
    }
    const double x = t.as_number(n, key);
    return {x, x};
  }
  bool spans(const Table& t, const char* key, Span* out, size_t count) const {
    const toml::node* n = t.find(key);
    if (!n) return false;
    const toml::array* a = n->as_array();
    if (!a || a->size() != count)
      t.bad(RDM_ERROR_FORMAT, line_of(*n), "%s is no list of %zu numbers", key, count);
    for (size_t k = 0; k < count; ++k) out[k] = span(t, *a->get(k), key);
    return true;
  }
  static bool drawn(const Span* s, size_t count) {
    return std::any_of(s, s + count, [](const Span& x) { return x.low != x.high; });
  }
  static void middle(const Span* s, size_t count, double* out) {
    for (size_t k = 0; k < count; ++k) out[k] = s[k].low + 0.5 * (s[k].high - s[k].low);
  }
  // q, or rpy: about x, then y, then z.
  void read_turn(const Table& t, double q[4]) const {
    const toml::node *given = t.find("q"), *rpy = t.find("rpy");
    if (given && rpy) t.bad(RDM_ERROR_FORMAT, line_of(*rpy), "q and rpy are both there");
    if (given) {
      t.numbers("q", q, 4);
      const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
      if (!(n > 1e-9 && n < 1e9)) t.bad(RDM_ERROR_RANGE, line_of(*given), "q is no rotation");
      for (int k = 0; k < 4; ++k) q[k] /= n;
    } else if (rpy) {
      const auto angles = t.list(*rpy, "rpy", 3, 3);
      check(t, line_of(*rpy), turn_of(angles.data(), q));
    }
  }
  // A pose whose numbers may be drawn; p and q are its middle.
  bool read_drawn(const Table& t, Span* ps, Span* turns, double* fixed, double* p, double* q) const {
    for (int k = 0; k < 3; ++k) ps[k] = turns[k] = {0, 0};
    spans(t, "p", ps, 3);
    middle(ps, 3, p);
    fixed[0] = fixed[1] = fixed[2] = 0, fixed[3] = 1;
    std::copy_n(fixed, 4, q);
    if (t.find("rpy") && !t.find("q") && spans(t, "rpy", turns, 3)) {
      double rpy[3];
      middle(turns, 3, rpy);
      check(t, line_of(*t.find("rpy")), turn_of(rpy, q));
    } else {
      read_turn(t, q);
      std::copy_n(q, 4, fixed);
    }
    return drawn(ps, 3) || drawn(turns, 3);
  }

  template <class T>
  T* take(const Table& t, T* rows, int32_t* count, int32_t most, const char* what) const {
    if (*count == most) t.bad(RDM_ERROR_RANGE, line_of(t.t), "more than %d %s", most, what);
    return rows + (*count)++;
  }

  // -- the scene --
  void materials() {
    for (const Table& t : top_.rows("material")) {
      t.only({"name"});
      const toml::node& n = t.need("name");
      check(t, line_of(n), rdm_scene_add_material(scene_, t.as_text(n, "name").c_str()));
    }
    for (const Table& t : top_.rows("friction")) {
      t.only({"between", "mu"});
      const auto pair = texts(t, "between", 2, 2);
      const toml::node& n = t.need("mu");
      double mu = RDM_FRICTION_PASSES;
      if (!n.is_string() || n.as_string()->get() != "passes") mu = t.as_number(n, "mu");
      check(t, line_of(n), rdm_scene_set_friction(scene_, pair[0].c_str(), pair[1].c_str(), mu));
    }
  }
  std::vector<std::string> texts(const Table& t, const char* key, size_t least, size_t most) const {
    const toml::node& n = t.need(key);
    std::vector<std::string> out;
    if (const toml::array* a = n.as_array())
      for (const toml::node& x : *a) out.push_back(t.as_text(x, key));
    else
      out.push_back(t.as_text(n, key));
    if (out.size() < least || out.size() > most)
      t.bad(RDM_ERROR_FORMAT, line_of(n), "%s: %zu names, not %zu to %zu", key, out.size(), least, most);
    return out;
  }

  void add_robot(const Table& t) {
    t.only({"name",     "robot", "hand",   "arm",       "yaw",          "adapter", "left",
            "p",        "q",     "rpy",    "free_base", "base_damping", "gravity", "compensate",
            "material", "start", "noise",  "rest",      "reach",        "control", "drive",
            "step",     "speed", "smooth", "push"});
    Part part(t);
    part.name = t.as_text(t.need("name"), "name");
    part.left = t.flag("left");
    Listed mounted;
    const auto find = [&](const char* key) {
      const toml::node& n = t.need(key);
      int32_t robot = -1;
      check(t, line_of(n), rdm_robot_find(t.as_text(n, key).c_str(), &robot));
      return robot;
    };
    const bool on_arm = t.find("arm") != nullptr && t.text("arm", "") != "none";
    if (t.find("robot")) {
      if (t.find("hand") || t.find("arm"))
        t.bad(RDM_ERROR_FORMAT, line_of(*t.find("robot")), "robot is there, and hand or arm too");
      part.listed = find("robot");
    } else if (t.find("hand") && on_arm) {
      double yaw = 0, adapter = 0;
      t.number("yaw", &yaw);
      t.number("adapter", &adapter);
      const std::string name = format("text-%u", g_mounted.fetch_add(1));
      check(t, line_of(*t.find("hand")),
            rdm_robot_create_mounted(&mounted.robot, name.c_str(), find("arm"), find("hand"), yaw, adapter,
                                     part.left));
      part.left = false;  // it is in the rows
    } else if (t.find("hand")) {
      part.listed = find("hand");
    } else if (on_arm) {
      part.listed = find("arm");
    } else {
      t.bad(RDM_ERROR_FORMAT, line_of(t.t), "no robot, hand or arm");
    }
    try {
      read_built(mounted.robot >= 0 ? mounted.robot : part.listed, part.draft.get());
    } catch (const Refusal& r) {
      t.bad(r.code, line_of(t.t), "%s", r.text.c_str());
    }
    if (mounted.robot >= 0) part.draft->def.name = "mounted";
    add_part(std::move(part), "robot");
    if (t.find("reach")) reach(&parts_.back(), on_arm ? find("arm") : parts_.back().listed);
  }
  void add_tree(const Table& t) {
    Part part(t);
    part.name = t.as_text(t.need("name"), "name");
    read_robot_table(t,
                     {"p", "q", "rpy", "free_base", "base_damping", "gravity", "material", "start", "noise",
                      "rest", "control", "drive", "step", "speed", "smooth", "push"},
                     {}, part.draft.get());
    part.draft->def.name = "tree";  // a robot's name is shorter than a scene's may be
    add_part(std::move(part), "tree");
  }
  void add_part(Part part, const char* kind) {
    const Table& t = part.t;
    if (parts_.size() == kMostPlayers)
      t.bad(RDM_ERROR_RANGE, line_of(t.t), "more than %d robots and trees", kMostPlayers);
    rdm_scene_robot r;
    rdm_scene_robot_init(&r, sizeof r);
    r.robot = part.listed;
    if (part.listed < 0) r.own = &part.draft->def;
    r.name = part.name.c_str();
    const std::string material = t.text("material", "default");
    r.material = material.c_str();
    r.free_base = t.flag("free_base");
    r.left = part.left;
    r.gravity = t.flag("gravity");
    t.number("base_damping", &r.base_damping);
    Span ps[3], turns[3];
    double fixed[4];
    if (read_drawn(t, ps, turns, fixed, part.p, part.q) && !r.free_base)
      t.bad(RDM_ERROR_RANGE, line_of(t.t), "p, rpy: a %s whose base is fixed is not moved at a reset", kind);
    std::copy_n(part.p, 3, r.p);
    std::copy_n(part.q, 4, r.q);
    if (t.flag("compensate")) {
      if (!r.gravity)
        t.bad(RDM_ERROR_FORMAT, line_of(*t.find("compensate")), "compensate goes with gravity = true");
      compensated_ = true;
    }
    check(t, line_of(t.t), rdm_scene_add_robot(scene_, &r, nullptr));
    const Draft& d = *part.draft;
    names_.push_back(part.name);
    if (d.def.palm_link != RDM_LINK_NONE) names_.push_back(part.name + ".palm");
    for (const rdm_robot_finger& f : d.fingers) names_.push_back(part.name + '.' + f.name);
    for (const rdm_robot_link& l : d.links) names_.push_back(part.name + '_' + l.name);
    for (const rdm_robot_shape& s : d.shapes) names_.push_back(part.name + '_' + s.name);
    for (const rdm_robot_link& l : d.links) joint_names_.push_back(part.name + '_' + l.joint);
    parts_.push_back(std::move(part));
  }
  // Joints at which the arm's flange has a pose of the world.
  void reach(Part* part, int32_t arm) {
    const Table t = part->t.section("reach");
    t.only({"p", "q", "rpy"});
    double p[3] = {}, q[4] = {0, 0, 0, 1}, d[3], pose[7];
    t.need("p");
    t.numbers("p", p, 3);
    read_turn(t, q);
    const double back[4] = {-part->q[0], -part->q[1], -part->q[2], part->q[3]};
    for (int k = 0; k < 3; ++k) d[k] = p[k] - part->p[k];
    rotate(back, d, pose);
    multiply(back, q, pose + 3);
    Draft of_arm;
    read_built(arm, &of_arm);
    part->start = of_arm.home;
    int32_t found = 0;
    check(t, line_of(t.t), rdm_robot_reach(arm, pose, part->start.data(), &found));
    if (!found) t.bad(RDM_ERROR_RANGE, line_of(t.t), "the arm does not reach this");
  }

  struct Shapes {
    std::deque<std::string> texts;
    std::deque<std::vector<double>> points;
    std::vector<rdm_shape_def> rows;
  };
  void read_shape(const Table& t, const std::string* name, Shapes* out) const {
    rdm_shape_def s{};
    const auto keep = [&](const std::string& text) {
      out->texts.push_back(text);
      return out->texts.back().c_str();
    };
    if (name) s.name = keep(*name);
    if (t.find("material")) s.material = keep(t.text("material", ""));
    s.kind = shape_kind(t, static_cast<int32_t>(std::size(kShapes)));
    if (s.kind == RDM_SHAPE_HULL) {
      const toml::node& n = t.need("points");
      const toml::array* a = n.as_array();
      if (!a) t.bad(RDM_ERROR_FORMAT, line_of(n), "points is no list of [x, y, z]");
      out->points.emplace_back();
      for (const toml::node& x : *a)
        for (const double c : t.list(x, "points", 3, 3)) out->points.back().push_back(c);
      s.points = out->points.back().data();
      s.num_points = static_cast<int32_t>(out->points.back().size() / 3);
    } else if (s.kind != RDM_SHAPE_PLANE) {
      const auto size = t.list(t.need("size"), "size", 1, 3);
      std::copy(size.begin(), size.end(), s.size);
    }
    s.q[3] = 1;
    read_color(t, s.color);
    s.seen_only = t.flag("seen_only");
    out->rows.push_back(s);
  }
  void place_shape(const Table& t, rdm_shape_def* s) const {
    t.numbers("p", s->p, 3);
    read_turn(t, s->q);
  }
  // Where a body begins, drawn or not; `add` puts it into the scene.
  template <class F>
  void place_body(const Table& t, F&& add) {
    Draw d{};
    double p[3] = {}, q[4] = {};
    bool moves = read_drawn(t, d.p, d.turn, d.q, p, q);
    moves = spans(t, "v", d.v, 3) || moves;
    moves = spans(t, "w", d.w, 3) || moves;
    d.apart = t.flag("apart", true);
    check(t, line_of(t.t), add(p, q, &d.body));
    if (moves)
      *take(t, p_.draws, &p_.num_draws, kMostDraws, "bodies that begin with a range in p, rpy, v or w") = d;
  }
  // One of the catalogue, or the host's: shapes, mass and friction are its own.
  void add_object(const Table& t) {
    t.only({"name", "object", "scale", "p", "q", "rpy", "v", "w", "apart"});
    const std::string name = t.as_text(t.need("name"), "name");
    const toml::node& word = t.need("object");
    int32_t object = -1;
    check(t, line_of(word), rdm_object_find(t.as_text(word, "object").c_str(), &object));
    double scale = 1;
    t.number("scale", &scale);
    place_body(t, [&](const double* p, const double* q, int32_t* index) {
      return rdm_scene_add_object(scene_, object, name.c_str(), p, q, scale, index);
    });
    names_.push_back(name);
  }
  void add_body(const Table& t) {
    if (t.find("object")) return add_object(t);
    t.only({"name", "mass", "moment", "p", "q", "rpy", "v", "w", "apart", "linear_damping", "angular_damping",
            "weightless", "shape", "kind", "size", "points", "material", "color", "seen_only"});
    rdm_body_def b{};
    b.struct_size = sizeof b;
    const std::string name = t.as_text(t.need("name"), "name");
    b.name = name.c_str();
    b.mass = t.as_number(t.need("mass"), "mass");
    t.numbers("moment", b.moment, 6);
    t.number("linear_damping", &b.linear_damping);
    t.number("angular_damping", &b.angular_damping);
    b.weightless = t.flag("weightless");
    Shapes shapes;
    if (t.find("kind")) {
      if (t.find("shape"))
        t.bad(RDM_ERROR_FORMAT, line_of(*t.find("kind")), "kind is there, and [[body.shape]] too");
      read_shape(t, nullptr, &shapes);
      names_.push_back(name);
    } else {
      for (const Table& s : t.rows("shape")) {
        s.only({"name", "kind", "size", "points", "p", "q", "rpy", "material", "color", "seen_only"});
        const std::string own = s.find("name") ? s.as_text(*s.find("name"), "name") : name;
        read_shape(s, &own, &shapes);
        place_shape(s, &shapes.rows.back());
        names_.push_back(own);
      }
      if (shapes.rows.empty()) t.bad(RDM_ERROR_FORMAT, line_of(t.t), "no kind, and no [[body.shape]]");
      names_.push_back(name);
    }
    b.shapes = shapes.rows.data();
    b.num_shapes = static_cast<int32_t>(shapes.rows.size());
    place_body(t, [&](const double* p, const double* q, int32_t* index) {
      std::copy_n(p, 3, b.p);
      std::copy_n(q, 4, b.q);
      return rdm_scene_add_body(scene_, &b, index);
    });
  }
  void add_static(const Table& t) {
    t.only({"name", "kind", "size", "points", "p", "q", "rpy", "material", "color", "seen_only"});
    Shapes shapes;
    const std::string name = t.as_text(t.need("name"), "name");
    read_shape(t, &name, &shapes);
    place_shape(t, &shapes.rows.back());
    check(t, line_of(t.t), rdm_scene_add_static(scene_, shapes.rows.data()));
    names_.push_back(name);
  }

  // -- robots as they are played --
  int32_t row_of(const Part& part, const Table& t, int line, const std::string& name) const {
    std::vector<std::string> names;
    const auto& links = part.draft->links;
    for (size_t i = 0; i < links.size(); ++i) {
      if (name == links[i].joint || name == part.name + '_' + links[i].joint) return static_cast<int32_t>(i);
      names.emplace_back(links[i].joint);
    }
    t.bad(RDM_ERROR_NOT_FOUND, line, "there is no joint %s%s", clean(name).c_str(),
          nearest_hint(name, names).c_str());
  }
  // A list of all joints' numbers, or { joint = number } over what stands there.
  void read_joints(const Part& part, const char* key, Span* out) const {
    const toml::node* n = part.t.find(key);
    if (!n) return;
    if (const toml::table* some = n->as_table()) {
      for (const auto& [joint, value] : *some)
        out[row_of(part, part.t, line_of(joint.source()), std::string(joint.str()))] =
            span(part.t, value, key);
    } else {
      spans(part.t, key, out, part.draft->links.size());
    }
  }
  void add_player(size_t index) {
    const Part& part = parts_[index];
    const Table& t = part.t;
    const Draft& d = *part.draft;
    const auto joints = static_cast<int32_t>(d.links.size());
    Player& player = *take(t, p_.players, &p_.num_players, kMostPlayers, "robots and trees");
    player.robot = static_cast<int32_t>(index);
    player.joint = num_joints_;
    player.joints = joints;
    num_joints_ += joints;
    if (num_joints_ > kMostTaskJoints)
      t.bad(RDM_ERROR_RANGE, line_of(t.t), "more than %d joints in all", kMostTaskJoints);
    // where the joints begin
    Span* start = p_.start + player.joint;
    for (int32_t i = 0; i < joints; ++i) {
      const auto at = static_cast<size_t>(i);
      double q = std::clamp(0.0, d.links[at].lower, d.links[at].upper);
      if (at < d.home.size()) q = d.home[at];
      if (const toml::node* n = t.find("start"); n && n->is_string() && n->as_string()->get() == "folded") {
        if (d.folded.empty()) t.bad(RDM_ERROR_FORMAT, line_of(*n), "start: it has no folded pose");
        q = d.folded[at];
      }
      if (at < part.start.size()) q = part.start[at];
      start[i] = {q, q};
    }
    if (const toml::node* n = t.find("start"); n && n->is_string()) {
      static constexpr const char* kPoses[] = {"home", "folded"};
      t.choice("start", kPoses, 2, 0);
    } else {
      read_joints(part, "start", start);
    }
    Span* noise = p_.noise + player.joint;
    if (const toml::node* n = t.find("noise"); n && !n->is_table() && !n->is_array()) {
      const double x = t.as_number(*n, "noise");
      if (!(x >= 0 && x <= 10)) t.bad(RDM_ERROR_RANGE, line_of(*n), "noise: %g is outside [0, 10]", x);
      std::fill_n(noise, joints, Span{-x, x});
    } else {
      read_joints(part, "noise", noise);
    }
    std::vector<Span> rest(d.links.size(), {kNone, kNone});
    read_joints(part, "rest", rest.data());
    for (int32_t i = 0; i < joints; ++i) {
      const int32_t j = player.joint + i;
      rdm_joint info;
      check(t, line_of(t.t), rdm_scene_joint_at(scene_, j, &info));
      p_.rest[j] = rest[static_cast<size_t>(i)].low;
      const double beyond = 0.1 * (info.upper - info.lower);  // against a stop
      if (!(start[i].low >= info.lower - beyond && start[i].high <= info.upper + beyond))
        t.bad(RDM_ERROR_RANGE, line_of(t.t), "start: %g..%g of %s is outside [%g, %g]", start[i].low,
              start[i].high, info.name, info.lower, info.upper);
      p_.lower[j] = std::min(info.lower, start[i].low);
      p_.upper[j] = std::max(info.upper, start[i].high);
    }
    controls(part, index < num_robots(), &player);
    // a free base
    if (t.flag("free_base")) {
      double p[3], q[4];
      player.placed = read_drawn(t, player.p, player.turn, player.q, p, q);
    }
    player.compensated = t.flag("compensate");
    player.push_action = -1;
    if (const toml::node* n = t.find("push")) {
      if (!t.flag("free_base")) t.bad(RDM_ERROR_FORMAT, line_of(*n), "push goes with free_base = true");
      t.numbers("push", player.push, 2);
      player.push_action = p_.num_actions;
      add_actions(t, 6, 0);
    }
  }
  size_t num_robots() const { return top_.rows("robot").size(); }
  void add_actions(const Table& t, int32_t count, float hold) {
    p_.num_actions += count;
    if (p_.num_actions > kMostTaskActions)
      t.bad(RDM_ERROR_RANGE, line_of(t.t), "more than %d actions in all", kMostTaskActions);
    hold_.insert(hold_.end(), static_cast<size_t>(count), hold);
  }
  void controls(const Part& part, bool robot, Player* player) {
    const Table& t = part.t;
    const Draft& d = *part.draft;
    static constexpr const char* kControls[] = {"none", "position", "delta", "velocity"};
    const int32_t control = t.choice("control", kControls, 4, robot ? 1 : 0);
    player->control = control == 0 ? Control::kNone : control == 1 ? Control::kPosition : Control::kDelta;
    double step = 0.05, speed = 0, frequency = 60;
    t.number("step", &step);
    t.number("speed", &speed);
    t.number("smooth", &player->keep);
    if (!(player->keep >= 0 && player->keep < 1))
      t.bad(RDM_ERROR_RANGE, line_of(*t.find("smooth")), "smooth: %g is outside [0, 1)", player->keep);
    check(t, line_of(t.t), rdm_scene_get_number(scene_, "frequency", &frequency));
    player->command = p_.num_commands;
    player->action = p_.num_actions;
    std::vector<std::string> drive{"*"};
    if (t.find("drive")) drive = texts(t, "drive", 1, kMostTaskJoints);
    for (int32_t i = 0; i < player->joints; ++i) {
      const int32_t j = player->joint + i;
      rdm_joint info;
      check(t, line_of(t.t), rdm_scene_joint_at(scene_, j, &info));
      if (info.action < 0) continue;
      if (player->command + info.action >= kMostTaskActions)
        t.bad(RDM_ERROR_RANGE, line_of(t.t), "more than %d commands in all", kMostTaskActions);
      Command& c = p_.commands[player->command + info.action];
      c.joint = j;
      c.lower = info.lower, c.upper = info.upper;
      const auto at = static_cast<size_t>(i);
      for (const rdm_robot_curve& curve : d.curves)
        if (curve.link == i && curve.driver == i) {
          c.knots = curve.num_knots;
          std::copy_n(curve.command, 4, c.x);
          std::copy_n(curve.angle, 4, c.y);
        }
      const double rate = speed > 0 ? speed : d.links[at].velocity > 0 ? d.links[at].velocity : 1;
      c.step = 2 * (control == 3 ? rate / frequency : step) / (info.upper - info.lower);
      const bool driven = player->control != Control::kNone &&
                          std::any_of(drive.begin(), drive.end(), [&](const std::string& pattern) {
                            return name_matches(pattern.c_str(), d.links[at].joint) ||
                                   name_matches(pattern.c_str(), info.name);
                          });
      c.action = driven ? 0 : -1;
      player->commands = std::max(player->commands, info.action + 1);
    }
    p_.num_commands += player->commands;
    for (int32_t k = 0; k < player->commands; ++k) {
      Command& c = p_.commands[player->command + k];
      if (c.action < 0) continue;
      c.action = player->actions++;
      double q = 0;
      middle(p_.start + c.joint, 1, &q);
      add_actions(t, 1, player->control == Control::kPosition ? static_cast<float>(command_at(c, q)) : 0.0f);
    }
    if (t.find("drive") && player->actions == 0)
      t.bad(RDM_ERROR_NOT_FOUND, line_of(*t.find("drive")),
            "drive: no joint that has a command is named so%s", nearest_hint(drive[0], joint_names_).c_str());
  }

  // -- factors --
  void add_factor(const Table& t) {
    static constexpr const char* kWhat[] = {
        "gravity",   "link_mass",    "link_kp",   "link_kd",   "link_effort",         "link_friction",
        "base_mass", "base_damping", "body_mass", "body_size", "body_linear_damping", "body_angular_damping",
        "friction"};
    t.only({"what", "of", "between", "factor", "each"});
    t.need("what");
    const int32_t what = t.choice("what", kWhat, 13, 0);
    Factor f{};
    f.what = what;
    f.factor = span(t, t.need("factor"), "factor");
    const bool each = t.flag("each");
    bool first = true;
    const auto add = [&](int32_t index, int32_t other) {
      f.index = index, f.other = other;
      f.with_last = !first && !each;
      first = false;
      *take(t, p_.factors, &p_.num_factors, kMostFactors, "factors") = f;
    };
    if (what == RDM_SCALE_GRAVITY) return add(0, 0);
    if (what == RDM_SCALE_FRICTION) {
      const auto pair = texts(t, "between", 2, 2);
      return add(find(t, "between", RDM_SCENE_MATERIAL, pair[0]),
                 find(t, "between", RDM_SCENE_MATERIAL, pair[1]));
    }
    for (const std::string& pattern : texts(t, "of", 1, kMostListed)) {
      if (what == RDM_SCALE_BASE_MASS || what == RDM_SCALE_BASE_DAMPING) {
        add(find(t, "of", RDM_SCENE_ROBOT, pattern), 0);
      } else if (what >= RDM_SCALE_BODY_MASS) {
        add(find(t, "of", RDM_SCENE_BODY, pattern), 0);
      } else {
        int32_t j = 0;
        bool any = false;
        for (const Part& part : parts_)
          for (const rdm_robot_link& l : part.draft->links) {
            const std::string link = part.name + '_' + l.name;
            if (pattern == part.name || name_matches(pattern.c_str(), link.c_str())) add(j, 0), any = true;
            ++j;
          }
        if (!any)
          t.bad(RDM_ERROR_NOT_FOUND, line_of(t.need("of")), "of: there is no link %s%s",
                clean(pattern).c_str(), nearest_hint(pattern, names_).c_str());
      }
    }
  }
  int32_t find(const Table& t, const char* key, int32_t part, const std::string& name) const {
    int32_t index = -1;
    const rdm_result r = rdm_scene_find(scene_, part, name.c_str(), &index);
    if (r != RDM_OK) t.bad(r, line_of(t.need(key)), "%s: %s", key, rdm_last_error());
    return index;
  }

  // -- places --
  Place place(const Table& t, const char* key) const {
    const toml::node& n = t.need(key);
    Place out{On::kWorld, 0, {0, 0, 0}, {0, 0, 0, 1}};
    if (n.is_array()) {
      const auto p = t.list(n, key, 3, 3);
      std::copy(p.begin(), p.end(), out.p);
      return out;
    }
    const toml::table* inner = n.as_table();
    if (!inner) return named_place(t, n, key, t.as_text(n, key));
    const Table in{*inner, t.what + ": " + key, t.lookup};
    in.only({"on", "p", "q", "rpy"});
    out = named_place(in, in.need("on"), "on", in.as_text(in.need("on"), "on"));
    double p[3] = {}, q[4] = {0, 0, 0, 1}, arm[3];
    in.numbers("p", p, 3);
    read_turn(in, q);
    rotate(out.q, p, arm);
    for (int k = 0; k < 3; ++k) out.p[k] += arm[k];
    multiply(out.q, q, out.q);
    return out;
  }
  Place named_place(const Table& t, const toml::node& n, const char* key, const std::string& name) const {
    Place out{On::kWorld, 0, {0, 0, 0}, {0, 0, 0, 1}};
    if (name == "world") return out;
    for (size_t i = 0; i < parts_.size(); ++i) {
      const Part& part = parts_[i];
      if (name.compare(0, part.name.size() + 1, part.name + '.') == 0)
        if (place_on_hand(i, name.substr(part.name.size() + 1), &out)) return out;
    }
    static constexpr struct {
      int32_t part;
      On on;
    } kFound[] = {{RDM_SCENE_BODY, On::kBody},
                  {RDM_SCENE_ROBOT, On::kBase},
                  {RDM_SCENE_LINK, On::kLink},
                  {RDM_SCENE_SHAPE, On::kShape}};
    for (const auto& k : kFound)
      if (rdm_scene_find(scene_, k.part, name.c_str(), &out.index) == RDM_OK) {
        out.on = k.on;
        return out;
      }
    t.bad(RDM_ERROR_NOT_FOUND, line_of(n), "%s: there is no body, robot, link or shape %s%s", key,
          clean(name).c_str(), nearest_hint(name, names_).c_str());
  }
  static void mirrored(const Part& part, const double in[3], double out[3]) {
    std::copy_n(in, 3, out);
    if (part.left) out[part.draft->def.mirror] *= -1;
  }
  bool place_on_hand(size_t index, const std::string& what, Place* out) const {
    const Part& part = parts_[index];
    const rdm_robot_def& d = part.draft->def;
    const auto on = [&](int32_t link) {
      out->on = link == RDM_LINK_ROOT ? On::kBase : On::kLink;
      out->index = link == RDM_LINK_ROOT ? static_cast<int32_t>(index) : first_joint(index) + link;
    };
    if (what == "palm" && d.palm_link != RDM_LINK_NONE) {  // y into it, z as the fingers point
      on(d.palm_link);
      mirrored(part, d.hold_p, out->p);
      double y[3], z[3];
      mirrored(part, d.palm_normal, y);
      mirrored(part, d.palm_fingers, z);
      for (double& c : y) c = -c;
      turn_to(y, z, out->q);
      return true;
    }
    for (const rdm_robot_finger& f : part.draft->fingers)
      if (what == f.name) {
        on(f.tip);
        mirrored(part, f.p_tip, out->p);
        return true;
      }
    return false;
  }
  int32_t first_joint(size_t index) const {
    int32_t first = 0;
    for (size_t i = 0; i < index; ++i) first += static_cast<int32_t>(parts_[i].draft->links.size());
    return first;
  }
  // The turn whose y and z these are, at right angles.
  static void turn_to(const double y[3], const double z[3], double q[4]) {
    double r[3][3];  // columns x, y, z
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      r[k][0] = y[i] * z[j] - y[j] * z[i];
      r[k][1] = y[k];
      r[k][2] = z[k];
    }
    const double trace = r[0][0] + r[1][1] + r[2][2];
    int k = 0;
    for (int i = 1; i < 3; ++i)
      if (r[i][i] > r[k][k]) k = i;
    if (trace > r[k][k]) {
      q[3] = 0.5 * std::sqrt(std::max(0.0, 1 + trace));
      q[0] = (r[2][1] - r[1][2]) / (4 * q[3]);
      q[1] = (r[0][2] - r[2][0]) / (4 * q[3]);
      q[2] = (r[1][0] - r[0][1]) / (4 * q[3]);
    } else {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      q[k] = 0.5 * std::sqrt(std::max(0.0, 1 + r[k][k] - r[i][i] - r[j][j]));
      q[i] = (r[i][k] + r[k][i]) / (4 * q[k]);
      q[j] = (r[j][k] + r[k][j]) / (4 * q[k]);
      q[3] = (r[j][i] - r[i][j]) / (4 * q[k]);
    }
  }

  // -- terms --
  void listed_joints(const Table& t, Term* out) {
    if (t.find("of") && t.find("joints"))
      t.bad(RDM_ERROR_FORMAT, line_of(*t.find("of")), "of and joints are both there");
    const char* key = t.find("joints") ? "joints" : "of";
    out->first = p_.num_joints;
    for (const std::string& pattern : texts(t, key, 1, kMostListed)) {
      int32_t j = 0;
      const int32_t before = p_.num_joints;
      for (const Part& part : parts_)
        for (size_t i = 0; i < part.draft->links.size(); ++i, ++j) {
          const bool named =
              key[0] == 'o' ? pattern == part.name
                            : name_matches(pattern.c_str(), joint_names_[static_cast<size_t>(j)].c_str());
          if (named) list_joint(t, j);
        }
      if (p_.num_joints == before) {
        std::vector<std::string> robots;
        for (const Part& part : parts_) robots.push_back(part.name);
        t.bad(RDM_ERROR_NOT_FOUND, line_of(t.need(key)), "%s: there is no %s %s%s", key,
              key[0] == 'o' ? "robot" : "joint", clean(pattern).c_str(),
              nearest_hint(pattern, key[0] == 'o' ? robots : joint_names_).c_str());
      }
    }
    out->count = p_.num_joints - out->first;
  }
  void list_joint(const Table& t, int32_t j) {
    rdm_joint info;
    check(t, line_of(t.t), rdm_scene_joint_at(scene_, j, &info));
    *take(t, p_.joints, &p_.num_joints, kMostListed, "joints in terms") = {
        info.lower, info.upper, info.effort, 0, j, 0};
  }
  void vector(const Table& t, const char* key, double* out, bool unit) const {
    const toml::node* n = t.find(key);
    t.numbers(key, out, 3);
    if (!n || !unit) return;
    const double length = std::sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    if (!(length > 1e-9 && length < 1e9)) t.bad(RDM_ERROR_RANGE, line_of(*n), "%s has no direction", key);
    for (int k = 0; k < 3; ++k) out[k] /= length;
  }
  // What a term is about; the keys that say so are added to `known`.
  Term subject(const Table& t, const TermRow& row, std::vector<const char*>* known) {
    Term out{};
    out.what = row.what;
    out.last = -1;
    out.a.q[3] = out.b.q[3] = 1;
    const uint32_t keys = row.keys;
    const auto has = [&](uint32_t bit, std::initializer_list<const char*> names) {
      if (!(keys & bit)) return false;
      known->insert(known->end(), names);
      return true;
    };
    if (has(kA, {"a"})) out.a = place(t, "a");
    if (has(kB, {"b"})) out.b = place(t, "b");
    if (has(kFrom, {"from"}) && t.find("from")) out.b = place(t, "from");
    std::fill_n(out.axis, 3, 1.0);
    if (has(kPlane, {"along"})) t.numbers("along", out.axis, 3);
    if (has(kShapesAB, {"a", "b"})) {
      const std::string a = t.as_text(t.need("a"), "a"), b = t.as_text(t.need("b"), "b");
      check(t, line_of(t.need("a")), rdm_scene_add_touch(scene_, a.c_str(), b.c_str(), &out.index));
    }
    if (has(kJointsOf, {"of", "joints"})) listed_joints(t, &out);
    if (has(kOneJoint, {"joint", "from", "to"})) {
      const toml::node& n = t.need("joint");
      const std::string name = t.as_text(n, "joint");
      int32_t j = -1;
      const rdm_result r = rdm_scene_find(scene_, RDM_SCENE_JOINT, name.c_str(), &j);
      if (r != RDM_OK) t.bad(r, line_of(n), "joint: %s", rdm_last_error());
      out.first = p_.num_joints;
      out.count = 1;
      list_joint(t, j);
      if (t.find("from") || t.find("to")) {
        out.to = 1;
        t.number("from", &out.from);
        t.number("to", &out.to);
        if (out.from == out.to) t.bad(RDM_ERROR_RANGE, line_of(n), "from and to are the same");
      }
    }
    if (has(kActionOf, {"of"})) {
      out.count = p_.num_actions;
      if (const toml::node* n = t.find("of")) {
        const int32_t robot = find(t, "of", RDM_SCENE_ROBOT, t.as_text(*n, "of"));
        out.first = p_.players[robot].action;
        out.count = p_.players[robot].actions + (p_.players[robot].push_action >= 0 ? 6 : 0);
        if (out.count == 0) t.bad(RDM_ERROR_RANGE, line_of(*n), "of: no action moves it");
      }
    }
    if (has(kBox, {"low", "high", "from"})) {
      t.need("low"), t.need("high");
      t.numbers("low", out.low, 3);
      t.numbers("high", out.high, 3);
      for (int k = 0; k < 3; ++k)
        if (!(out.low[k] < out.high[k]))
          t.bad(RDM_ERROR_RANGE, line_of(t.need("low")), "low %g is not below high %g", out.low[k],
                out.high[k]);
      if (t.find("from")) out.b = place(t, "from");
    }
    if (has(kWindow, {"low", "high", "share"})) {
      out.low[0] = -kInfinite, out.high[0] = kInfinite;
      t.number("low", out.low);
      t.number("high", out.high);
      if (!(out.low[0] < out.high[0]))
        t.bad(RDM_ERROR_RANGE, line_of(t.t), "low %g is not below high %g", out.low[0], out.high[0]);
      out.scaled = t.flag("share");
    }
    if (has(kShare, {"share"})) out.scaled = t.flag("share");
    if (has(kAxis, {"axis", "up"})) {
      out.axis[0] = out.axis[1] = 0;
      out.up[2] = 1;
      vector(t, "axis", out.axis, true);
      vector(t, "up", out.up, true);
    }
    if (has(kBodyA, {"a"})) out.index = find(t, "a", RDM_SCENE_BODY, t.as_text(t.need("a"), "a"));
    if (has(kTipA, {"a"})) {
      std::string link = t.as_text(t.need("a"), "a");
      for (const Part& part : parts_)
        for (const rdm_robot_finger& f : part.draft->fingers)
          if (link == part.name + '.' + f.name)
            link = part.name + '_' + part.draft->links[static_cast<size_t>(f.tip)].name;
      out.index = find(t, "a", RDM_SCENE_SENSOR, link);
    }
    if (keys & kStart) {
      const auto same = [&](const Place& x) {
        return x.on == out.a.on && x.index == out.a.index && std::equal(x.p, x.p + 3, out.a.p) &&
               std::equal(x.q, x.q + 4, out.a.q);
      };
      const Place* end = p_.starts + p_.num_starts;
      const Place* there = std::find_if(static_cast<const Place*>(p_.starts), end, same);
      out.index = static_cast<int32_t>(there - p_.starts);
      if (there == end) *take(t, p_.starts, &p_.num_starts, kMostStarts, "places whose start counts") = out.a;
    }
    return out;
  }
  void curve(const Table& t, Term* out, std::vector<const char*>* known, bool changes) {
    known->insert(known->end(), {"curve", "width", "at"});
    out->curve = static_cast<Curve>(t.choice("curve", kCurves, 8, 0));
    const bool wide = out->curve == Curve::kNear || out->curve == Curve::kBell;
    if (wide) {
      const toml::node& n = t.need("width");
      out->width = t.as_number(n, "width");
      if (!(out->width > 0 && out->width < 1e9))
        t.bad(RDM_ERROR_RANGE, line_of(n), "width: %g is not above 0", out->width);
    }
    const bool at = out->curve >= Curve::kAbove && out->curve <= Curve::kUnder;
    if (at) out->at = t.as_number(t.need("at"), "at");
    if (!wide && t.find("width"))
      t.bad(RDM_ERROR_FORMAT, line_of(*t.find("width")), "width: curve near or bell has one");
    if (!at && t.find("at"))
      t.bad(RDM_ERROR_FORMAT, line_of(*t.find("at")), "at: curve above, below, over or under has one");
    if (!changes) return;
    known->push_back("change");
    if (t.flag("change")) {
      if (p_.num_last == kMostChanges)
        t.bad(RDM_ERROR_RANGE, line_of(t.t), "more than %d terms of a change", kMostChanges);
      out->last = p_.num_last++;
    }
  }
  // Without either, a cost is what is above 0; a success says which.
  void threshold(const Table& t, Term* out, std::vector<const char*>* known, bool needed) {
    known->insert(known->end(), {"above", "below"});
    out->above = -kInfinite, out->below = kInfinite;
    t.number("above", &out->above);
    t.number("below", &out->below);
    if (t.find("above") || t.find("below")) {
      if (!(out->above < out->below))
        t.bad(RDM_ERROR_RANGE, line_of(t.t), "above %g is not less than below %g", out->above, out->below);
      return;
    }
    if (needed) t.bad(RDM_ERROR_FORMAT, line_of(t.t), "no above, and no below");
    out->above = 0;
  }
  Term* add_term(const Table& t) { return take(t, p_.terms, &num_terms_, kMostTerms, "terms"); }

  void all_terms() {
    for (const Table& t : top_.rows("observe")) {
      const TermRow& row = term_of(t, true);
      std::vector<const char*> known{"term", "name", "scale", "unit"};
      Term term = subject(t, row, &known);
      if (row.what == What::kOverlap) t.bad(RDM_ERROR_FORMAT, line_of(t.t), "overlap is not observed");
      if (!(row.keys & kMany)) curve(t, &term, &known, false);
      t.only(known);
      term.weight = 1;
      t.number("scale", &term.weight);
      const bool three = row.what == What::kPosition || row.what == What::kVelocity ||
                         row.what == What::kTurning || row.what == What::kTip || row.what == What::kWhere;
      term.entries = three ? 3 : row.what == What::kRotation ? 4 : row.keys & kMany ? term.count : 1;
      check(t, line_of(t.t), rdm_scene_set_field(scene_, field_name(t).c_str(), term.entries));
      *add_term(t) = term;
      ++p_.views;
    }
    for (const Table& t : top_.rows("reward")) {
      std::vector<const char*> known{"term", "name", "weight"};
      Term term = subject(t, term_of(t, false), &known);
      curve(t, &term, &known, true);
      t.only(known);
      term.weight = t.as_number(t.need("weight"), "weight");
      *add_term(t) = term;
      ++p_.rewards;
    }
    std::vector<std::string> columns;
    for (const Table& t : top_.rows("cost")) {
      std::vector<const char*> known{"term", "name", "help", "limit", "weight", "magnitude"};
      Term term = subject(t, term_of(t, false), &known);
      curve(t, &term, &known, true);
      threshold(t, &term, &known, false);
      t.only(known);
      term.weight = 1;
      t.number("weight", &term.weight);
      if (!(term.weight > 0 && term.weight <= 1e6))
        t.bad(RDM_ERROR_RANGE, line_of(*t.find("weight")), "weight: %g is not above 0 and up to 1e6",
              term.weight);
      term.magnitude = t.flag("magnitude");
      const std::string name = t.as_text(t.need("name"), "name");
      const auto same = [&](const std::string& other) { return same_name(other, name); };
      const auto there = std::find_if(columns.begin(), columns.end(), same);
      term.column = static_cast<int32_t>(there - columns.begin());
      if (there == columns.end()) columns.push_back(name);
      *add_term(t) = term;
      ++p_.costs;
    }
    for (const char* key : {"success", "fall"})
      for (const Table& t : top_.rows(key)) {
        std::vector<const char*> known{"term", "name"};
        Term term = subject(t, term_of(t, false), &known);
        curve(t, &term, &known, true);
        threshold(t, &term, &known, true);
        t.only(known);
        *add_term(t) = term;
        ++(key[0] == 's' ? p_.successes : p_.falls);
      }
    const Table end = top_.section("end");
    end.only({"success", "hold", "bonus", "penalty"});
    p_.ends = end.flag("success");
    p_.hold = end.integer("hold", 1, 1, 100000);
    end.number("bonus", &p_.bonus);
    end.number("penalty", &p_.penalty);
  }

  rdm_scene* scene_;
  Program& p_;
  SceneOptions options_;
  Table top_;
  std::vector<Part> parts_;
  std::vector<std::string> names_, joint_names_;
  std::vector<float> hold_;
  int32_t num_joints_ = 0, num_terms_ = 0;
  bool compensated_ = false;
};

rdm_result build(void* user, rdm_scene* scene, void* instance) {
  const TextTask& task = *static_cast<const TextTask*>(user);
  const auto named = [&](rdm_result code, const std::string& text) {
    const std::string line = task.file.empty() ? text : task.file + ": " + text;
    return rdm_fail(code, line.c_str());
  };
  try {
    Builder(task, scene, static_cast<Program*>(instance)).build();
    return RDM_OK;
  } catch (const Refusal& r) {
    return named(r.code, r.text);
  } catch (const std::bad_alloc&) {
    return named(RDM_ERROR_MEMORY, "out of memory");
  } catch (...) {
    return named(RDM_ERROR_INTERNAL, "internal error: unexpected exception");
  }
}

void release(void* user) {
  delete static_cast<TextTask*>(user);
}

// The task's own text, without who calls it.
std::string inner_text(const std::string& name) {
  std::string text = rdm_last_error();
  const std::string head = "task " + name + ": build: ";
  if (text.compare(0, head.size(), head) == 0) text.erase(0, head.size());
  return text;
}

// A world with the default options: made, reset, and stepped once.
rdm_result try_world(const char* name) {
  rdm_pool_config c;
  rdm_pool* pool = nullptr;
  rdm_pool_config_init(&c, sizeof c);
  c.task = name;
  c.num_envs = 1;
  rdm_result r = rdm_pool_create(&pool, &c);
  if (r == RDM_OK) r = rdm_pool_reset(pool, nullptr, nullptr);
  if (r == RDM_OK) r = rdm_pool_baseline(pool, RDM_BASELINE_HOLD);
  if (r == RDM_OK) r = rdm_pool_step(pool);
  rdm_pool_destroy(pool);
  return r;
}

// What is wrong with the task, in the file's words and at the file's line.
[[noreturn]] void refuse_def(const TextTask& task, rdm_result r) {
  const std::string text = rdm_last_error();
  for (const TextTask::Row& row : task.rows) {
    if (text.compare(0, row.def.size(), row.def) != 0) continue;
    const size_t rest = text.find_first_not_of(".: ", row.def.size());
    refuse(r, "line %d: %s: %s", row.line, row.what.c_str(), text.c_str() + std::min(rest, text.size()));
  }
  const toml::node* section = task.root.get("task");
  const std::string def = "def.";
  const bool own = text.compare(0, def.size(), def) == 0;
  refuse(r, "line %d: %s", section ? line_of(*section) : 1,
         (own ? "task: " + text.substr(def.size()) : text).c_str());
}

}  // namespace

int32_t read_task(const std::string& bytes, const std::string& file) {
  auto task = std::make_unique<TextTask>();
  task->file = file;
  task->root = parse_toml(bytes);
  rdm_task_def d = Registration(task.get()).def();
  d.build = build;
  d.reset = program_reset;
  d.control = program_control;
  d.judge = program_judge;
  d.observe = program_observe;
  d.check_state = program_check_state;
  d.release = release;
  int32_t index = -1;
  const std::string name = d.name;
  if (const rdm_result r = rdm_task_create(&index, &d)) refuse_def(*task, r);
  (void)task.release();  // the library's, until `release`
  struct Registered {
    int32_t index;
    ~Registered() {
      if (index >= 0) rdm_task_destroy(index);
    }
  } registered{index};  // removed also where there is no memory for the reason
  if (const rdm_result r = try_world(name.c_str())) {
    std::string text = inner_text(name);
    if (!file.empty() && text.compare(0, file.size() + 2, file + ": ") == 0) text.erase(0, file.size() + 2);
    throw Refusal{r, text};
  }
  registered.index = -1;
  return index;
}

}  // namespace rdm::import
