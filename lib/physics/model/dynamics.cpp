#include "physics/model/dynamics.hpp"

#include <algorithm>
#include <cstring>

#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

// Every factor with its bounds, in the order of a saved record: visit(value, bounds, field, kind, index).
// Factors are doubles alone, so that records hold no padding.
static_assert(sizeof(LinkFactors) == 5 * sizeof(double) && sizeof(BaseFactors) == 2 * sizeof(double) &&
              sizeof(BodyFactors) == 4 * sizeof(double));

template <class Visit>
void visit_link(const LinkFactors& f, int32_t i, Visit&& visit) {
  visit(f.mass, kMassFactor, "mass", "link", i);
  visit(f.kp, kForceFactor, "kp", "link", i);
  visit(f.kd, kForceFactor, "kd", "link", i);
  visit(f.effort, kForceFactor, "effort", "link", i);
  visit(f.friction, kForceFactor, "friction", "link", i);
}

template <class Visit>
void visit_base(const BaseFactors& f, int32_t i, Visit&& visit) {
  visit(f.mass, kMassFactor, "mass", "base", i);
  visit(f.damping, kForceFactor, "damping", "base", i);
}

template <class Visit>
void visit_body(const BodyFactors& f, int32_t i, Visit&& visit) {
  visit(f.mass, kMassFactor, "mass", "body", i);
  visit(f.size, kSizeFactor, "size", "body", i);
  visit(f.linear_damping, kForceFactor, "linear_damping", "body", i);
  visit(f.angular_damping, kForceFactor, "angular_damping", "body", i);
}

bool inside(double x, const double* bounds) {  // false for NaN
  return x >= bounds[0] && x <= bounds[1];
}

int32_t count_friction(const Scene& scene) {
  const int32_t n = scene.def.num_materials;
  return n * (n + 1) / 2;
}

Inertia scaled(Inertia inertia, double mass, double moment) {
  inertia.mass *= mass;
  for (double& m : inertia.moment) m *= moment;
  return inertia;
}

}  // namespace

void Dynamics::carve(const Scene& scene, Arena& arena) {
  num_links = scene.num_links;
  num_bases = static_cast<int32_t>(scene.def.articulations.size());
  num_bodies = scene.num_bodies;
  num_friction = count_friction(scene);
  links = arena.make<LinkFactors>(static_cast<size_t>(num_links));
  bases = arena.make<BaseFactors>(static_cast<size_t>(num_bases));
  bodies = arena.make<BodyFactors>(static_cast<size_t>(num_bodies));
  friction = arena.make<double>(static_cast<size_t>(num_friction));
  if (!arena.measuring()) reset();
}

void Dynamics::reset() {
  gravity = 1;
  std::fill_n(links, num_links, LinkFactors{});
  std::fill_n(bases, num_bases, BaseFactors{});
  std::fill_n(bodies, num_bodies, BodyFactors{});
  std::fill_n(friction, num_friction, 1.0);
}

void Dynamics::copy(const Dynamics& other) {
  gravity = other.gravity;
  std::copy_n(other.links, num_links, links);
  std::copy_n(other.bases, num_bases, bases);
  std::copy_n(other.bodies, num_bodies, bodies);
  std::copy_n(other.friction, num_friction, friction);
}

bool Dynamics::same(const Dynamics& other) const {
  const auto equal = [](const auto* a, const auto* b, int32_t count) {
    return std::memcmp(a, b, sizeof *a * static_cast<size_t>(count)) == 0;
  };
  return gravity == other.gravity && equal(links, other.links, num_links) &&
         equal(bases, other.bases, num_bases) && equal(bodies, other.bodies, num_bodies) &&
         equal(friction, other.friction, num_friction);
}

void Dynamics::check(const Scene& scene) const {
  if (num_links != scene.num_links || num_bases != static_cast<int32_t>(scene.def.articulations.size()) ||
      num_bodies != scene.num_bodies || num_friction != count_friction(scene))
    fail(Code::kArgument, "dynamics: it belongs to another scene");
  const auto need = [](double x, const double* bounds, const char* field, const char* kind, int32_t i) {
    if (!inside(x, bounds))
      fail(Code::kRange, "dynamics: factor %s of %s of %s %d is outside [%s, %s]", Number(x).text, field,
           kind, i, Number(bounds[0]).text, Number(bounds[1]).text);
  };
  need(gravity, kGravityFactor, "gravity", "world", 0);
  for (int32_t i = 0; i < num_links; ++i) visit_link(links[i], i, need);
  for (int32_t i = 0; i < num_bases; ++i) visit_base(bases[i], i, need);
  for (int32_t i = 0; i < num_bodies; ++i) visit_body(bodies[i], i, need);
  for (int32_t i = 0; i < num_friction; ++i) need(friction[i], kForceFactor, "friction", "pair", i);
}

void Dynamics::save(Writer& out) const {
  out.value(gravity);
  out.bytes(links, sizeof *links * static_cast<size_t>(num_links));
  out.bytes(bases, sizeof *bases * static_cast<size_t>(num_bases));
  out.bytes(bodies, sizeof *bodies * static_cast<size_t>(num_bodies));
  out.bytes(friction, sizeof *friction * static_cast<size_t>(num_friction));
}

void Dynamics::load(Reader& in) {
  gravity = in.value<double>();
  in.bytes(links, sizeof *links * static_cast<size_t>(num_links));
  in.bytes(bases, sizeof *bases * static_cast<size_t>(num_bases));
  in.bytes(bodies, sizeof *bodies * static_cast<size_t>(num_bodies));
  in.bytes(friction, sizeof *friction * static_cast<size_t>(num_friction));
}

bool Dynamics::sound(Reader& in, const Scene& scene) {
  bool good = inside(in.value<double>(), kGravityFactor);
  const auto look = [&](double x, const double* bounds, const char*, const char*, int32_t) {
    good &= inside(x, bounds);
  };
  for (int32_t i = 0; i < scene.num_links; ++i) visit_link(in.value<LinkFactors>(), i, look);
  for (size_t i = 0; i < scene.def.articulations.size(); ++i) visit_base(in.value<BaseFactors>(), 0, look);
  for (int32_t i = 0; i < scene.num_bodies; ++i) visit_body(in.value<BodyFactors>(), i, look);
  for (int32_t i = 0; i < count_friction(scene); ++i) good &= inside(in.value<double>(), kForceFactor);
  return good;
}

Inertia Dynamics::link_inertia(const Scene& scene, int32_t link) const {
  return scaled(scene.link(link).inertia, links[link].mass, links[link].mass);
}

Inertia Dynamics::base_inertia(const Scene& scene, int32_t a) const {
  return scaled(scene.def.articulations[static_cast<size_t>(a)].base, bases[a].mass, bases[a].mass);
}

Inertia Dynamics::body_inertia(const Scene& scene, int32_t i) const {
  const BodyFactors& f = bodies[i];
  return scaled(scene.def.bodies[static_cast<size_t>(i)].inertia, f.mass, f.mass * f.size * f.size);
}

}  // namespace rdm
