#include "text_terms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/names.hpp"

namespace rdm::import {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr const char* kCurves[] = {"value", "near", "bell", "above", "below", "over", "under", "square"};

}  // namespace

void TermText::listed_joints(const Table& t, Term* out) {
  if (t.find("of") && t.find("joints"))
    t.bad(RDM_ERROR_FORMAT, line_of(*t.find("of")), "it has both of and joints; give one of them");
  const char* key = t.find("joints") ? "joints" : "of";
  // The term keeps a run of the program's list of joints: [first, first + count), in the patterns' order.
  out->first = p_.num_joints;
  for (const std::string& pattern : texts(t, key, 1, kMostListed)) {
    int32_t j = 0;  // of the scene: robots' joints follow one another in the order of the parts
    const int32_t before = p_.num_joints;
    for (const Part& part : parts_)
      for (size_t i = 0; i < part.draft->links.size(); ++i, ++j) {
        const bool named = key[0] == 'o'
                               ? pattern == part.name
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

void TermText::list_joint(const Table& t, int32_t j) {
  rdm_joint_info info = RDM_INIT(rdm_joint_info);
  check(t, line_of(t.t), rdm_scene_joint_at(scene_, j, &info));
  *take(t, p_.joints, &p_.num_joints, kMostListed, "joints in terms") = {info.lower, info.upper, info.effort,
                                                                         0,          j,          0};
}

void TermText::vector(const Table& t, const char* key, double* out, bool unit) const {
  const toml::node* n = t.find(key);
  t.numbers(key, out, 3);
  if (!n || !unit) return;
  const double length = std::sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
  if (!(length > 1e-9 && length < 1e9)) t.bad(RDM_ERROR_RANGE, line_of(*n), "%s has no direction", key);
  for (int k = 0; k < 3; ++k) out[k] /= length;
}

Term TermText::subject(const Table& t, const TermRow& row, std::vector<const char*>* known) {
  // row.keys says what a term of this kind reads. Each block below reads the keys of one bit, and adds them
  // to those that the table may have.
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
  std::fill_n(out.axis, 3, 1.0);  // of a distance: factors on its three components
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
    if (t.find("from") || t.find("to")) {  // counts the way from one value to the other as 0 to 1
      out.to = 1;
      t.number("from", &out.from);
      t.number("to", &out.to);
      if (out.from == out.to) t.bad(RDM_ERROR_RANGE, line_of(n), "from and to are equal");
    }
  }
  if (has(kActionOf, {"of"})) {
    out.count = p_.num_actions;
    if (const toml::node* n = t.find("of")) {
      const int32_t robot = find(t, "of", RDM_SCENE_ROBOT, t.as_text(*n, "of"));
      out.first = p_.players[robot].action;
      // the entries of its joints, and force and torque on a base that floats
      out.count = p_.players[robot].actions + (p_.players[robot].push_action >= 0 ? 6 : 0);
      if (out.count == 0) t.bad(RDM_ERROR_RANGE, line_of(*n), "of: no action moves this robot");
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
    // "robot.finger" stands for the link at the finger's tip
    std::string link = t.as_text(t.need("a"), "a");
    for (const Part& part : parts_)
      for (const rdm_robot_finger& f : part.draft->fingers)
        if (link == part.name + '.' + f.name)
          link = part.name + '_' + part.draft->links[static_cast<size_t>(f.tip)].name;
    out.index = find(t, "a", RDM_SCENE_SENSOR, link);
  }
  if (keys & kStart) {  // measured from where the place was at the reset: equal places share one memory
    const auto same = [&](const Place& x) {
      return x.on == out.a.on && x.index == out.a.index && std::equal(x.p, x.p + 3, out.a.p) &&
             std::equal(x.q, x.q + 4, out.a.q);
    };
    const Place* end = p_.starts + p_.num_starts;
    const Place* there = std::find_if(static_cast<const Place*>(p_.starts), end, same);
    out.index = static_cast<int32_t>(there - p_.starts);
    if (there == end) *take(t, p_.starts, &p_.num_starts, kMostStarts, "places whose start is used") = out.a;
  }
  return out;
}

void TermText::curve(const Table& t, Term* out, std::vector<const char*>* known, bool changes) {
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
    t.bad(RDM_ERROR_FORMAT, line_of(*t.find("width")), "width: only the curves near and bell have one");
  if (!at && t.find("at"))
    t.bad(RDM_ERROR_FORMAT, line_of(*t.find("at")),
          "at: only the curves above, below, over and under have one");
  if (!changes) return;
  known->push_back("change");
  if (t.flag("change")) {
    if (p_.num_last == kMostChanges)
      t.bad(RDM_ERROR_RANGE, line_of(t.t), "there are more than %d terms that are a change", kMostChanges);
    out->last = p_.num_last++;
  }
}

void TermText::threshold(const Table& t, Term* out, std::vector<const char*>* known, bool needed) {
  known->insert(known->end(), {"above", "below"});
  out->above = -kInfinite, out->below = kInfinite;
  t.number("above", &out->above);
  t.number("below", &out->below);
  if (t.find("above") || t.find("below")) {  // holds while above < value < below
    if (!(out->above < out->below))
      t.bad(RDM_ERROR_RANGE, line_of(t.t), "above %g is not less than below %g", out->above, out->below);
    return;
  }
  if (needed) t.bad(RDM_ERROR_FORMAT, line_of(t.t), "it needs above or below");
  out->above = 0;  // a cost without thresholds counts what is above 0
}

void TermText::read_terms() {
  for (const Table& t : top_.rows("observe")) {
    const TermRow& row = term_of(t, true);
    std::vector<const char*> known{"term", "name", "scale", "unit"};
    Term term = subject(t, row, &known);
    if (row.what == What::kOverlap) t.bad(RDM_ERROR_FORMAT, line_of(t.t), "overlap cannot be observed");
    if (!(row.keys & kMany)) curve(t, &term, &known, false);
    t.only(known);
    term.weight = 1;
    t.number("scale", &term.weight);
    const bool three = row.what == What::kPosition || row.what == What::kVelocity ||
                       row.what == What::kTurning || row.what == What::kTip || row.what == What::kWhere;
    term.entries = three ? 3 : row.what == What::kRotation ? 4 : row.keys & kMany ? term.count : 1;
    check(t, line_of(t.t),
          rdm_scene_set_field(scene_, field_name(t).c_str(), static_cast<size_t>(term.entries)));
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
    // rows of one name add up in one column
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

}  // namespace rdm::import
