#include "mjcf_table.hpp"

#include <map>
#include <sstream>

namespace rdm::import {
namespace {

#define ORIENTATION "quat axisangle euler xyaxes zaxis"

constexpr const char* kMadeOfMany = "it would create bodies, and is not read";
constexpr const char* kLoop = "closes a loop of bodies, but a robot must be a tree";

template <class Row>
using Words = std::map<std::string, std::map<std::string, const Row*>>;  // by element and word

template <class Row>
Words<Row> words_of(const std::vector<Row>& rows, const char* Row::*element, const char* Row::*words) {
  Words<Row> out;
  for (const Row& row : rows) {
    std::istringstream in(row.*words);
    for (std::string word; in >> word;) out[row.*element][word] = &row;
  }
  return out;
}
// Harmless wherever it stands: a name that some element has to drop, and none to read.
bool harmless(const std::string& attribute) {
  bool dropped = false;
  for (const AttributeRow& row : attribute_rows()) {
    std::istringstream in(row.attributes);
    for (std::string word; in >> word;) {
      if (word != attribute) continue;
      if (row.use != Use::kDropped) return false;
      dropped = true;
    }
  }
  return dropped;
}

}  // namespace

const std::vector<AttributeRow>& attribute_rows() {
  static const std::vector<AttributeRow> rows{
      {"compiler", Use::kRead,
       "angle eulerseq coordinate autolimits meshdir assetdir strippath inertiafromgeom inertiagrouprange "
       "settotalmass boundmass boundinertia balanceinertia exactmeshinertia fitaabb",
       nullptr, nullptr},
      {"compiler", Use::kDropped,
       "texturedir discardvisual usethread fusestatic saveinertial alignfree conflict convexhull", nullptr,
       nullptr},
      {"flag", Use::kRead, "frictionloss damper", nullptr, nullptr},
      {"flag", Use::kDropped,
       "contact spring gravity clampctrl warmstart filterparent actuation refsafe sensor midphase eulerdamp "
       "autoreset nativeccd island multiccd override energy fwdinv invdiscrete sleep diagexact passive",
       nullptr, nullptr},
      {"flag", Use::kRefused, "constraint limit equality", "enable",
       "the ranges or couplings of the file would have no effect"},
      {"body", Use::kRead, "name childclass pos mocap " ORIENTATION, nullptr, nullptr},
      {"body", Use::kDropped, "gravcomp sleep simple user", nullptr, nullptr},
      {"frame", Use::kRead, "childclass pos " ORIENTATION, nullptr, nullptr},
      {"frame", Use::kDropped, "name", nullptr, nullptr},
      {"inertial", Use::kRead, "pos mass diaginertia fullinertia " ORIENTATION, nullptr, nullptr},
      {"joint", Use::kRead,
       "name class type pos axis limited range ref armature damping frictionloss actuatorfrclimited "
       "actuatorfrcrange",
       nullptr, nullptr},
      {"joint", Use::kDropped,
       "group stiffness springref springdamper margin actuatorgravcomp solreflimit solimplimit "
       "solreffriction "
       "solimpfriction user",
       nullptr, nullptr},
      {"freejoint", Use::kDropped, "name group align", nullptr, nullptr},
      {"geom", Use::kRead,
       "name class type contype conaffinity group size fromto pos mesh fitscale mass density shellinertia "
       "rgba " ORIENTATION,
       nullptr, nullptr},
      {"geom", Use::kDropped,
       "condim priority material friction solmix solref solimp margin gap surfacevel adhesion hfield "
       "fluidshape fluidcoef user",
       nullptr, nullptr},
      {"mesh", Use::kRead, "name class file vertex face refpos refquat scale inertia", nullptr, nullptr},
      {"mesh", Use::kDropped,
       "content_type normal texcoord smoothnormal maxhullvert material params octree_maxdepth", nullptr,
       nullptr},
      {"mesh", Use::kRefused, "builtin", "none", "shapes that MuJoCo generates are not read"},
      {"fixed", Use::kRead, "name class limited range actuatorfrclimited actuatorfrcrange", nullptr, nullptr},
      {"fixed", Use::kDropped,
       "group solreflimit solimplimit solreffriction solimpfriction frictionloss springlength margin "
       "stiffness damping width material rgba user",
       nullptr, nullptr},
      {"fixed", Use::kRefused, "armature", "0", "the inertia of a tendon is not read"},
      {"fixed/joint", Use::kRead, "joint coef", nullptr, nullptr},
      {"equality/joint", Use::kRead, "name class active joint1 joint2 polycoef", nullptr, nullptr},
      {"equality/joint", Use::kDropped, "solref solimp", nullptr, nullptr},
      {"equality/tendon", Use::kRead, "name class active tendon1 tendon2 polycoef", nullptr, nullptr},
      {"equality/tendon", Use::kDropped, "solref solimp", nullptr, nullptr},
      {"actuator", Use::kRead,
       "name class joint jointinparent tendon gear ctrllimited ctrlrange forcelimited forcerange actrange kp "
       "kv dampratio inheritrange gaintype gainprm biastype biasprm dyntype",
       nullptr, nullptr},
      {"actuator", Use::kDropped,
       "group nsample interp delay user lengthrange actlimited actdim dynprm actearly timeconst site refsite "
       "slidersite cranksite cranklength body input velrange ffrange",
       nullptr, nullptr},
      {"actuator", Use::kRefused, "armature damping", "0",
       "it is not read from an actuator; set it on the joint"},
      {"exclude", Use::kRead, "name body1 body2", nullptr, nullptr},
  };
  return rows;
}

const std::vector<ElementRow>& element_rows() {
  static const std::vector<ElementRow> rows{
      {"mujoco", Use::kRead,
       "compiler option default asset worldbody contact tendon equality actuator keyframe", nullptr},
      {"mujoco", Use::kDropped, "size statistic visual extension deformable sensor custom", nullptr},
      {"default", Use::kRead,
       "default joint geom mesh tendon equality site general motor position velocity intvelocity damper "
       "cylinder "
       "muscle adhesion orientation pid dcmotor",
       nullptr},
      {"default", Use::kDropped, "material camera light pair", nullptr},
      {"asset", Use::kRead, "mesh", nullptr},
      {"asset", Use::kDropped, "hfield skin texture material model", nullptr},
      {"mesh", Use::kRefused, "plugin", "shapes that a plugin makes are not read"},
      {"body", Use::kRead, "body frame inertial joint freejoint geom site", nullptr},
      {"body", Use::kDropped, "camera light plugin", nullptr},
      {"body", Use::kRefused, "replicate attach composite flexcomp", kMadeOfMany},
      {"deformable", Use::kDropped, "skin", nullptr},
      {"deformable", Use::kRefused, "flex", "deformable bodies are not read"},
      {"contact", Use::kRead, "exclude", nullptr},
      {"contact", Use::kDropped, "pair", nullptr},
      {"tendon", Use::kRead, "fixed", nullptr},
      {"tendon", Use::kDropped, "spatial", nullptr},
      {"equality", Use::kRead, "joint tendon", nullptr},
      {"equality", Use::kRefused, "connect weld distance", kLoop},
      {"equality", Use::kRefused, "flex flexvert flexstrain", "deformable bodies are not read"},
      {"actuator", Use::kRead, "general motor position velocity intvelocity", nullptr},
      {"actuator", Use::kDropped, "damper cylinder muscle adhesion orientation pid dcmotor plugin", nullptr},
  };
  return rows;
}

void check_attributes(const Element& e, const std::string& kind) {
  static const auto table = words_of(attribute_rows(), &AttributeRow::element, &AttributeRow::attributes);
  const auto& known = table.at(kind);
  for (const Attribute& a : e.attributes) {
    if (a.name.rfind("xmlns", 0) == 0) continue;
    const auto found = known.find(a.name);
    if (found == known.end() && harmless(a.name)) continue;
    if (found == known.end())
      refuse_at(RDM_ERROR_UNSUPPORTED, e, "%s is not a known attribute here, and it could change the robot%s",
                clean(a.name).c_str(), nearest_key(a.name, known).c_str());
    const AttributeRow& row = *found->second;
    if (row.use == Use::kRefused && !(row.harmless && a.value == row.harmless))
      refuse_at(RDM_ERROR_UNSUPPORTED, e, "%s=\"%s\": %s", clean(a.name).c_str(), clean(a.value).c_str(),
                row.why);
  }
}

const ElementRow& row_of(const Element& e, const std::string& parent) {
  static const auto table = words_of(element_rows(), &ElementRow::parent, &ElementRow::children);
  const auto& known = table.at(parent);
  const auto found = known.find(e.tag);
  if (found == known.end() && parent == "mujoco")
    for (const auto& [other, children] : table)
      if (children.count(e.tag))
        refuse_at(RDM_ERROR_FORMAT, e, "it is outside of %s: this file is a part that other files include",
                  other == "body" ? "worldbody" : other.c_str());
  if (found == known.end())
    refuse_at(RDM_ERROR_UNSUPPORTED, e, "this is not a known element in %s, and it could change the robot%s",
              parent.c_str(), nearest_key(e.tag, known).c_str());
  return *found->second;
}

void check_children(const Element& e, const std::string& kind) {
  for (const auto& child : e.children) {
    const ElementRow& row = row_of(*child, kind);
    if (row.use == Use::kRefused) refuse_at(RDM_ERROR_UNSUPPORTED, *child, "%s", row.why);
  }
}

}  // namespace rdm::import
