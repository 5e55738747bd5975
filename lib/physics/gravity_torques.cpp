#include "physics/gravity_torques.hpp"

#include <algorithm>
#include <cstring>

#include "base/error.hpp"

// Of all that is behind joint i: mass m and first moment h = sum m c about the base's origin O. Gravity pulls
// it with the wrench (m g, h x g) about O; the joint, with axis a through p, has to give against it
//   revolute   tau = -a . ((h - m p) x g)          prismatic   tau = -m a . g
namespace rdm {
namespace {

struct Behind {
  double mass, h[3];
};

void add(Behind* to, double mass, const Vec3& h) {
  to->mass += mass;
  for (int r = 0; r < 3; ++r) to->h[r] += h[r];
}

}  // namespace

void gravity_torques(const World& world, int32_t articulation, double* out) {
  const Scene& scene = world.scene();
  const auto a = static_cast<size_t>(articulation);
  const ArticulationDef& def = scene.def.articulations[a];
  const auto count = static_cast<int32_t>(def.links.size());
  const int32_t first = scene.link_offset[a];
  const Dynamics* dynamics = world.dynamics();
  if (count > kMaxCoords)
    fail(Code::kUnsupported, "gravity_torques: there are %d links, but at most %d are allowed", count,
         kMaxCoords);
  std::fill_n(out, count, 0.0);
  if (!def.gravity) return;
  Behind behind[kMaxCoords];
  std::memset(behind, 0, sizeof *behind * static_cast<size_t>(count));
  const Vec3 g = dynamics ? dynamics->gravity * scene.def.gravity : scene.def.gravity;
  const Vec3 origin = world.base(articulation).X.p;
  for (int32_t i = count - 1; i >= 0; --i) {
    const LinkDef& link = def.links[static_cast<size_t>(i)];
    const double factor = dynamics ? dynamics->links[first + i].mass : 1;
    const double own = link.weightless ? 0 : factor * link.inertia.mass;
    Behind& b = behind[i];
    if (own == 0 && b.mass == 0) continue;  // its pose is not needed
    const Pose& X_WL = world.link(first + i).X;
    const Vec3 p = X_WL.p - origin, axis = rotate(X_WL.q, link.joint.axis);
    add(&b, own, own * (p + rotate(X_WL.q, link.inertia.com)));
    const Vec3 h{b.h[0], b.h[1], b.h[2]};
    out[i] = link.joint.kind == JointKind::kPrismatic ? -b.mass * dot(axis, g)
                                                      : -dot(axis, cross(h - b.mass * p, g));
    if (link.parent >= 0) add(&behind[link.parent], b.mass, h);
  }
}

}  // namespace rdm
