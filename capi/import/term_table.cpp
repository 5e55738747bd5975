#include "term_table.hpp"

#include <cctype>
#include <cstring>

namespace rdm::import {
namespace {

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

}  // namespace

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
    if (name == row.name)
      t.bad(RDM_ERROR_FORMAT, line_of(n), "term: %s gives several numbers, but one is needed", row.name);
  t.bad(RDM_ERROR_FORMAT, line_of(n), "term: %s is unknown%s", clean(name).c_str(),
        nearest_hint(name, names).c_str());
}

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

}  // namespace rdm::import
