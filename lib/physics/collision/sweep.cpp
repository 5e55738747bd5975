#include "physics/collision/sweep.hpp"

#include <algorithm>
#include <cmath>

#include "physics/collision/thinning.hpp"

// Distance. The cores of a and b (of round things their axis or centre, with a radius r about it) are as far
// apart as the origin is from the Minkowski difference a - b; Gilbert, Johnson and Keerthi (1988) walk there
// over simplexes of support points w = h_a(-x) - h_b(x), x the nearest point so far. Each x gives a bound too:
//   gap along x/|x|  >=  x . w / |x| - r_a - r_b,
// and the best bound is what the advance trusts; where it exceeds -way . x/|x| the two never meet.
//
// Advance. With closing = -way . n, t += gap / closing until the gap is kTouch: along n they cannot meet
// earlier. If rounding takes them into each other all the same, t goes back half of the last step.
//
// Points. Those of the shown faces as in manifold.cpp, 3., but for all corners that the way reaches, each with
// its own gap; of round sides and edges those of the overlap a little farther on. They stand on a and b as
// both are now, so that lever arms are right. Depth counts to kTouch beyond the surface: what comes to rest then
// overlaps, and its next contact is one of the ordinary kind.
namespace rdm {
namespace {

constexpr int kMostSteps = 32, kMostAdvances = 16;
constexpr double kTouch = 1e-4;                     // m, near enough
constexpr double kRelative = 1e-6;                  // of a distance
constexpr double kProgress = 1e-12;                 // of its square, in a step
constexpr double kNothing = 1e-20;                  // m2
constexpr double kOnwards = -0.1;                   // cosine: an overlap that pushes a out the way it goes
constexpr double kAlike = 0.9;                      // cosine of two normals of one contact
constexpr double kFlat = 0.985, kPreferred = 1e-3;  // as manifold.cpp

// Of a solid as a core and a radius around it.
double radius_of(const Convex& s) {
  return s.kind == ShapeKind::kSphere || s.kind == ShapeKind::kCapsule ? s.size.x : 0;
}
Vec3 support(const Convex& s, const Vec3& d) {
  if (s.kind == ShapeKind::kSphere) return s.p;
  if (s.kind != ShapeKind::kCapsule) return farthest(s, d);
  const Vec3 u = s.R.col(2);
  return s.p + std::copysign(s.size.y, dot(u, d)) * u;
}

struct Vertex {
  Vec3 w, a, b;
  double weight;
};

// The part of a simplex nearest to the origin, with weights; the vertices that have none are dropped.
int nearest_on_edge(Vertex* v) {
  const Vec3 e = v[1].w - v[0].w;
  const double t = -dot(v[0].w, e), length = dot(e, e);
  if (t <= 0 || length == 0) return v[0].weight = 1, 1;
  if (t >= length) return v[0] = v[1], v[0].weight = 1, 1;
  v[1].weight = t / length;
  v[0].weight = 1 - v[1].weight;
  return 2;
}
Vec3 sum_of(const Vertex* v, int n) {
  Vec3 x;
  for (int i = 0; i < n; ++i) x += v[i].weight * v[i].w;
  return x;
}
int nearest_on_triangle(Vertex* v) {
  const Vec3 &a = v[0].w, &b = v[1].w, &c = v[2].w;
  const Vec3 n = cross(b - a, c - a);
  const double nn = dot(n, n);
  const double u = dot(n, cross(b, c)), s = dot(n, cross(c, a)), t = dot(n, cross(a, b));
  if (nn > 0 && u >= 0 && s >= 0 && t >= 0) {
    v[0].weight = u / nn;
    v[1].weight = s / nn;
    v[2].weight = 1 - v[0].weight - v[1].weight;
    return 3;
  }
  Vertex best[2];
  int count = 0;
  double least = HUGE_VAL;
  constexpr int kEdges[3][2] = {{0, 1}, {1, 2}, {2, 0}};
  for (const auto& e : kEdges) {
    Vertex edge[2] = {v[e[0]], v[e[1]]};
    const int k = nearest_on_edge(edge);
    const Vec3 x = sum_of(edge, k);
    if (dot(x, x) >= least) continue;
    least = dot(x, x);
    count = k;
    std::copy_n(edge, k, best);
  }
  std::copy_n(best, count, v);
  return count;
}
// 4: the origin is inside.
int nearest_on_tetrahedron(Vertex* v) {
  Vertex best[3];
  int count = 4;
  double least = HUGE_VAL;
  bool inside = true;
  constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
  for (const auto& f : kFaces) {
    const Vec3 &a = v[f[0]].w, &b = v[f[1]].w, &c = v[f[2]].w;
    const Vec3 n = cross(b - a, c - a);
    const double at = -dot(n, a), opposite = dot(n, v[f[3]].w - a);
    // on the inner side; of a flat simplex no face has one
    const double flat = 1e-10 * dot(n, n) * dot(v[f[3]].w - a, v[f[3]].w - a);
    if (at * opposite > 0 && opposite * opposite > flat) continue;
    inside = false;
    Vertex face[3] = {v[f[0]], v[f[1]], v[f[2]]};
    const int k = nearest_on_triangle(face);
    const Vec3 x = sum_of(face, k);
    if (dot(x, x) >= least) continue;
    least = dot(x, x);
    count = k;
    std::copy_n(face, k, best);
  }
  if (inside) return 4;
  std::copy_n(best, count, v);
  return count;
}

struct Distance {
  bool misses;  // along some direction they stay apart while a moves by `way`
  bool known;   // the cores are apart: the rest is set
  double gap;   // m, they are at least so far apart along n
  Vec3 n;       // unit, from b into a
  Vec3 a, b;    // nearest points of the surfaces, or nearly so
};

Distance distance(const Convex& a, const Convex& b, const Vec3& way) {
  Distance out = {false, false, -HUGE_VAL, {}, {}, {}};
  const double radius_a = radius_of(a), radius_b = radius_of(b), radii = radius_a + radius_b;
  Vertex v[4];
  int count = 0;
  Vec3 x = a.p - b.p;
  if (dot(x, x) == 0) x = {0, 0, 1};
  double square = HUGE_VAL;
  for (int k = 0; k < kMostSteps; ++k) {
    Vertex& next = v[count];
    next.a = support(a, -x);
    next.b = support(b, x);
    next.w = next.a - next.b;
    next.weight = 1;
    const double length = norm(x), apart = dot(x, next.w) / length - radii;
    if (apart > std::max(0.0, -dot(way, x) / length)) {
      out.misses = true;
      return out;
    }
    if (count > 0 && apart > out.gap) {
      out.gap = apart;
      out.n = (1 / length) * x;
    }
    if (count > 0 && square - dot(x, next.w) <= kRelative * square) break;
    ++count;
    if (count == 2)
      count = nearest_on_edge(v);
    else if (count == 3)
      count = nearest_on_triangle(v);
    else if (count == 4)
      count = nearest_on_tetrahedron(v);
    if (count == 4) return out;
    x = sum_of(v, count);
    const double now = dot(x, x);
    if (now < kNothing) return out;
    if (now >= square * (1 - kProgress) && k > 0) break;
    square = now;
  }
  if (out.gap < 0) {  // too near to tell
    out.gap = 0;
    out.n = (1 / norm(x)) * x;
  }
  out.known = true;
  for (int i = 0; i < count; ++i) {
    out.a += v[i].weight * v[i].a;
    out.b += v[i].weight * v[i].b;
  }
  out.a -= radius_a * out.n;
  out.b += radius_b * out.n;
  return out;
}

int clip(const Vec3* in, int count, const Vec3& outward, const Vec3& corner, Vec3* out) {
  int kept = 0;
  const auto beyond = [&](const Vec3& p) { return dot(outward, p - corner); };
  if (count == 1) {
    if (beyond(in[0]) <= 0) out[kept++] = in[0];
    return kept;
  }
  const int edges = count > 2 ? count : 1;
  if (edges == 1 && beyond(in[0]) <= 0) out[kept++] = in[0];
  for (int i = 0; i < edges; ++i) {
    const Vec3 &p = in[i], &q = in[(i + 1) % count];
    const double bp = beyond(p), bq = beyond(q);
    if ((bp > 0) != (bq > 0) && kept < 2 * Feature::kMost) out[kept++] = p + (bp / (bp - bq)) * (q - p);
    if (bq <= 0 && kept < 2 * Feature::kMost) out[kept++] = q;
  }
  return kept;
}

}  // namespace

int coming_contacts(const Convex& a, const Convex& b, const Vec3& way, double shallow, ComingPoint* out) {
  Convex there = a;  // at t
  double t = 0, apart_at = 0, meet_at = 1;
  bool met = false;
  Distance d{}, last{};
  for (int k = 0; k < kMostAdvances; ++k) {
    there.p = a.p + t * way;
    d = distance(there, b, (1 - t) * way);
    if (d.misses) return 0;
    if (!d.known) {  // inside: back, halfway to where they were apart
      met = true;
      meet_at = t;
      if (!(t > 0)) {
        const Vec3 back = (2 * kBarely / norm(way)) * way;
        there.p = a.p - back;
        d = distance(there, b, way + back);
        if (d.misses || !d.known) return 0;
        last = d;
        break;
      }
      t = 0.5 * (apart_at + t);
      continue;
    }
    last = d;
    apart_at = t;
    const double closing = -dot(way, d.n);
    if (!(closing > 0)) return 0;
    if (d.gap <= kTouch) break;
    t += (d.gap - 0.5 * kTouch) / closing;
    if (met) t = std::min(t, 0.5 * (apart_at + meet_at));
    if (t > 1) return 0;
  }
  if (!last.known) return 0;
  d = last;
  t = apart_at;
  there.p = a.p + t * way;
  const Vec3 shift = t * way;
  const double closing = -dot(way, d.n);
  if ((1 - t) * closing < shallow) return 0;
  // shallow by another way out, as at an edge on a seam; half way as well: they might be through
  bool deep = false;
  for (const double s : {1.0, 0.5 * (1 + t)}) {
    Convex end = a;
    end.p = a.p + s * way;
    Overlap overlap;
    deep =
        deep || !find_overlap(end, b, &overlap) || overlap.depth >= shallow || dot(overlap.n, d.n) < kOnwards;
  }
  if (!deep) return 0;
  const Feature of_a = shown(there, -d.n), of_b = shown(b, d.n);
  const double fits_a = of_a.count > 2 ? -dot(of_a.n, d.n) : 0,
               fits_b = of_b.count > 2 ? dot(of_b.n, d.n) : 0;
  int count = 0;
  struct Cut {
    Vec3 p, face_p, n;
    double gap, depth;
  } cuts[2 * Feature::kMost];
  if (std::max(fits_a, fits_b) > kFlat) {
    const bool on_a = fits_a > fits_b + kPreferred;
    const Feature &face = on_a ? of_a : of_b, &other = on_a ? of_b : of_a;
    Vec3 buffers[2][2 * Feature::kMost];
    int n = other.count, now = 0;
    std::copy_n(other.points, n, buffers[0]);
    for (int i = 0; i < face.count && n > 0; ++i) {
      const Vec3 &p = face.points[i], &q = face.points[(i + 1) % face.count];
      Vec3 outward = cross(q - p, face.n);
      if (dot(outward, face.points[(i + 2) % face.count] - p) > 0) outward = -outward;
      n = clip(buffers[now], n, outward, p, buffers[1 - now]);
      now = 1 - now;
    }
    const double reach = (1 - t) * closing;
    for (int i = 0; i < n; ++i) {
      const Vec3& p = buffers[now][i];
      const double gap = std::max(0.0, dot(face.n, p - face.points[0]));
      if (gap > reach) continue;
      cuts[count++] = {p, p - gap * face.n, (on_a ? -1.0 : 1.0) * face.n, gap, -gap};
    }
    count = keep_spread<2 * Feature::kMost>(cuts, count, kManifoldPoints, [](const Cut& c) { return c.p; });
    for (int i = 0; i < count; ++i) {
      const Cut& c = cuts[i];
      const Vec3 pa = on_a ? c.face_p : c.p, pb = on_a ? c.p : c.face_p;
      const double along = -dot(shift, c.n);
      out[i] = {pa - shift, pb - pa + shift, c.n, -std::max(0.0, along + c.gap + kTouch)};
    }
  }
  if (count > 0) return count;
  // no face: what touches once they are a little into each other
  Convex inside = there;
  inside.p -= (d.gap + 2 * kTouch) * d.n;
  ManifoldPoint points[kManifoldPoints];
  const int found = manifold_between(inside, b, points);
  for (int i = 0; i < found; ++i) {
    const ManifoldPoint& point = points[i];
    if (dot(point.n, d.n) > kAlike)
      out[count++] = {point.p - shift, shift, point.n, std::min(0.0, dot(shift, point.n) - d.gap - kTouch)};
  }
  if (count > 0) return count;
  out[0] = {d.a - shift, d.b - d.a + shift, d.n, std::min(0.0, -t * closing - d.gap - kTouch)};
  return 1;
}

int coming_on_plane(const Convex& a, const Vec3& n, double offset, const Vec3& way, double shallow,
                    ComingPoint* out) {
  const double closing = -dot(way, n);
  if (!(closing > 0)) return 0;
  struct Low {
    Vec3 p;
    double depth;
  } points[kMaxHullPoints];
  int count = 0;
  bool deep = false;
  const auto add = [&](const Vec3& p) {
    const double gap = dot(n, p) - offset;
    if (gap > closing) return;
    points[count++] = {p, -gap};
    deep |= closing - gap > shallow;
  };
  if (a.hull) {
    for (int32_t i = 0; i < a.hull->num_points; ++i) add(a.p + a.R * a.hull->points[i]);
  } else {
    const Feature f = shown(a, -n);
    for (int i = 0; i < f.count; ++i) add(f.points[i]);
  }
  if (!deep) return 0;
  count = keep_spread<kMaxHullPoints>(points, count, kManifoldPoints, [](const Low& c) { return c.p; });
  for (int i = 0; i < count; ++i)
    out[i] = {points[i].p, points[i].depth * n, n, std::min(0.0, points[i].depth)};
  return count;
}

}  // namespace rdm
