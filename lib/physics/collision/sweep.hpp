// Contacts to come: of two convex solids that are apart and of which one is on its way to the other.
//
// Conservative advancement of the relative translation (Mirtich 1996) by GJK distances: it gives when they
// meet, and what would touch there. A solver then lets them come as near as that and no nearer: a row with
// b = depth / h, depth < 0. What passes by makes no contact.
#pragma once
#include "physics/collision/convex.hpp"
#include "physics/collision/manifold.hpp"

namespace rdm {

inline constexpr double kBarely = 2e-4;  // m, the deepest overlap from which a sweep starts

struct ComingPoint {
  Vec3 p;        // on a, where it is now
  Vec3 gap;      // from there to the point of b that it meets, as b is now
  Vec3 n;        // unit, from b into a
  double depth;  // -way along n until they touch, <= 0
};

// `way`: how far a moves against b in a substep. At most kManifoldPoints; 0: they do not meet, or overlap by
// less than `shallow` at the substep's end, where the overlap's own contacts are enough.
int coming_contacts(const Convex& a, const Convex& b, const Vec3& way, double shallow, ComingPoint* out);
int coming_on_plane(const Convex& a, const Vec3& n, double offset, const Vec3& way, double shallow,
                    ComingPoint* out);

}  // namespace rdm
