#include "robot/override.hpp"

#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "base/option.hpp"

namespace rdm {
namespace {

constexpr int kMaxLinks = 128;

double& field_of(JointDef& joint, JointField field) {
  switch (field) {
    case JointField::kKp:
      return joint.kp;
    case JointField::kKd:
      return joint.kd;
    case JointField::kEffort:
      return joint.effort;
    case JointField::kFriction:
      return joint.friction;
    case JointField::kArmature:
      return joint.armature;
  }
  fail(Code::kInternal, "override: unknown joint field %d", static_cast<int>(field));
}

// Link row with the name, which `name_of` reads.
template <class F>
LinkDef& find(ArticulationDef* def, const char* kind, const char* prefix, const char* name, F&& name_of) {
  const char* names[kMaxLinks];
  int32_t count = 0;
  const size_t skip = std::strlen(prefix);
  for (LinkDef& link : def->links) {
    const char* full = name_of(link);
    const char* bare = std::strncmp(full, prefix, skip) == 0 ? full + skip : full;
    if (same_name(full, name) || same_name(bare, name)) return link;
    if (count < kMaxLinks) names[count++] = bare;
  }
  fail(Code::kNotFound, "%s: no %s is called %s%s", def->name.text, kind, name,
       Nearest(name, names, count).text);
}

void need_value(const char* owner, double value) {
  if (!(value >= 0 && std::isfinite(value)))
    fail(Code::kRange, "%s: %g is not a number of 0 or more", owner, value);
}

void scale_inertia(Inertia* inertia, double factor) {
  inertia->mass *= factor;
  for (double& m : inertia->moment) m *= factor;
}

}  // namespace

const char* const kJointFields[kNumJointFields] = {"kp", "kd", "effort", "friction", "armature"};

void override_joint(ArticulationDef* def, const char* prefix, const char* joint, JointField field,
                    double value) {
  need_value(joint, value);
  LinkDef& link = find(def, "joint", prefix, joint, [](LinkDef& l) { return l.joint.name.text; });
  field_of(link.joint, field) = value;
}

void override_mass(ArticulationDef* def, const char* prefix, const char* name, double mass) {
  need_value(name, mass);
  LinkDef& link = find(def, "link", prefix, name, [](LinkDef& l) { return l.name.text; });
  if (mass <= 0 || link.inertia.mass <= 0) fail(Code::kRange, "%s: mass must be above 0", name);
  scale_inertia(&link.inertia, mass / link.inertia.mass);
}

void scale_joints(ArticulationDef* def, JointField field, double factor) {
  need_value("scale", factor);
  for (LinkDef& link : def->links) field_of(link.joint, field) *= factor;
}

void scale_mass(ArticulationDef* def, double factor) {
  need_value("scale", factor);
  if (factor <= 0) fail(Code::kRange, "scale: the mass factor must be above 0");
  scale_inertia(&def->base, factor);
  for (LinkDef& link : def->links) scale_inertia(&link.inertia, factor);
}

void set_material(ArticulationDef* def, int32_t material) {
  for (ArticulationShape& s : def->shapes) s.shape.material = material;
}

}  // namespace rdm
