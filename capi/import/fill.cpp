#include "fill.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "import.hpp"

namespace rdm::import {
namespace {

constexpr size_t kMostOfHull = 4096;  // corners: the work grows with their square

double side(const Mesh& m, const std::array<uint32_t, 3>& f, V3 p) {
  const V3 a = m.points[f[0]];
  return dot(unit(cross(m.points[f[1]] - a, m.points[f[2]] - a), {}), p - a);
}

// Four corners that are not in one plane; none: fewer than four.
std::vector<uint32_t> first_corners(const std::vector<V3>& p, double close) {
  std::vector<uint32_t> out{0};
  const auto farthest_by = [&](auto&& measure) {
    uint32_t best = 0;
    for (uint32_t k = 1; k < p.size(); ++k)
      if (measure(p[k]) > measure(p[best])) best = k;
    if (measure(p[best]) > close) out.push_back(best);
  };
  farthest_by([&](V3 x) { return norm(x - p[out[0]]); });
  if (out.size() < 2) return out;
  const V3 line = unit(p[out[1]] - p[out[0]]);
  farthest_by([&](V3 x) { return norm(cross(x - p[out[0]], line)); });
  if (out.size() < 3) return out;
  const V3 normal = unit(cross(p[out[1]] - p[out[0]], p[out[2]] - p[out[0]]));
  farthest_by([&](V3 x) { return std::abs(dot(x - p[out[0]], normal)); });
  return out;
}

// Moments about the origin and volumes of the pyramids from it to the faces.
Mass pyramids(const Mesh& mesh, V3 apex, bool positive) {
  double volume = 0;
  V3 first;
  M3 second{};  // integral of r r^T, r from the apex
  for (const auto& f : mesh.faces) {
    const V3 a = mesh.points[f[0]] - apex, b = mesh.points[f[1]] - apex, c = mesh.points[f[2]] - apex;
    const V3 sum = a + b + c;
    double v = dot(a, cross(b, c)) / 6;
    if (positive) v = std::abs(v);
    volume += v;
    first = first + (v / 4) * sum;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        second[static_cast<size_t>(i)][static_cast<size_t>(j)] +=
            v / 20 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + sum[i] * sum[j]);
  }
  if (!(std::abs(volume) > 1e-18)) return {};
  Mass out{volume, apex + (1 / volume) * first, {}};
  const double trace = second[0][0] + second[1][1] + second[2][2];
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) out.moment[i][j] = (i == j ? trace : 0) - second[i][j];
  return out;  // the moment is about the apex
}

struct Surface {
  double area = 0;
  V3 middle;
};
Surface surface_of(const Mesh& mesh) {
  Surface out;
  for (const auto& f : mesh.faces) {
    const V3 a = mesh.points[f[0]], b = mesh.points[f[1]], c = mesh.points[f[2]];
    const double area = norm(cross(b - a, c - a)) / 2;
    out.area += area;
    out.middle = out.middle + (area / 3) * (a + b + c);
  }
  if (out.area > 0) out.middle = (1 / out.area) * out.middle;
  return out;
}

Mass surface_mass(const Mesh& mesh) {
  const Surface s = surface_of(mesh);
  Mass out{s.area, s.middle, {}};
  for (const auto& f : mesh.faces) {
    const V3 a = mesh.points[f[0]] - s.middle, b = mesh.points[f[1]] - s.middle,
             c = mesh.points[f[2]] - s.middle, sum = a + b + c;
    const double area = norm(cross(b - a, c - a)) / 2;
    for (const V3& r : {a, b, c, sum}) out.moment = out.moment + point_moment(area / 12, r);
  }
  return out;
}

}  // namespace

Mass scaled(double factor, const Mass& in) {
  Mass m = in;
  m.mass *= factor;
  for (auto& row : m.moment)
    for (double& x : row) x *= factor;
  return m;
}

bool is_closed(const Mesh& mesh) {
  std::map<std::tuple<double, double, double>, uint32_t> corners;  // the first of each place
  const auto corner = [&](uint32_t k) {
    const V3& p = mesh.points[k];
    return corners.emplace(std::make_tuple(p.x, p.y, p.z), k).first->second;
  };
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const auto& f : mesh.faces) {
    const uint32_t c[3] = {corner(f[0]), corner(f[1]), corner(f[2])};
    for (size_t k = 0; k < 3; ++k)
      if (c[k] != c[(k + 1) % 3]) ++edges[{c[k], c[(k + 1) % 3]}];
  }
  return !edges.empty() && std::all_of(edges.begin(), edges.end(), [&](const auto& e) {
    const auto back = edges.find({e.first.second, e.first.first});
    return back != edges.end() && back->second == e.second;
  });
}

Mass filled(const Mesh& mesh, Fill how) {
  if (how == Fill::kConvex || mesh.faces.empty()) {
    const Mesh hull = hull_of(mesh.points);
    return hull.faces.empty() ? Mass{} : filled(hull, how == Fill::kShell ? how : Fill::kExact);
  }
  if (how == Fill::kShell) return surface_mass(mesh);
  if (how == Fill::kLegacy) {
    const Mass from_middle = pyramids(mesh, surface_of(mesh).middle, true);
    Mass out = pyramids(mesh, from_middle.com, true);
    out.com = from_middle.com;
    return out;
  }
  const Mass from_middle = pyramids(mesh, surface_of(mesh).middle, false);
  if (from_middle.mass == 0) return {};
  Mass out = pyramids(mesh, from_middle.com, false);
  out.com = from_middle.com;
  return out.mass < 0 ? scaled(-1, out) : out;
}

Mass shell(const Primitive& s) {
  const V3& r = s.size;
  Mass out;
  const auto moments = [&](double x, double y, double z) {
    out.moment = {{{x, 0, 0}, {0, y, 0}, {0, 0, z}}};
  };
  if (s.kind == RDM_SPHERE) {
    out.mass = 4 * M_PI * r.x * r.x;
    const double m = 2.0 / 3 * out.mass * r.x * r.x;
    moments(m, m, m);
  } else if (s.kind == RDM_CYLINDER || s.kind == RDM_CAPSULE) {
    const bool capsule = s.kind == RDM_CAPSULE;
    const double wall = 4 * M_PI * r.x * r.y, ends = (capsule ? 4 : 2) * M_PI * r.x * r.x;
    double across = wall * (r.x * r.x / 2 + r.y * r.y / 3), along = wall * r.x * r.x;
    if (capsule) {
      across += ends * (2.0 / 3 * r.x * r.x + r.y * r.y + r.y * r.x);
      along += ends * 2.0 / 3 * r.x * r.x;
    } else {
      across += ends * (r.x * r.x / 4 + r.y * r.y);
      along += ends * r.x * r.x / 2;
    }
    out.mass = wall + ends;
    moments(across, across, along);
  } else if (s.kind == RDM_BOX) {
    const double yz = 8 * r.y * r.z, zx = 8 * r.z * r.x, xy = 8 * r.x * r.y;  // both sides
    out.mass = yz + zx + xy;
    const auto square = [&](int k) {  // sum of m r_k^2
      const double own = k == 0 ? yz : k == 1 ? zx : xy;
      return r[k] * r[k] * (own + (out.mass - own) / 3);
    };
    moments(square(1) + square(2), square(0) + square(2), square(0) + square(1));
  } else {
    // The space between it and one that is thicker by a micrometre, with Thomsen's area.
    constexpr double p = 1.6075, thick = 1e-6;
    out.mass =
        4 * M_PI *
        std::pow((std::pow(r.x * r.y, p) + std::pow(r.y * r.z, p) + std::pow(r.z * r.x, p)) / 3, 1 / p);
    const V3 more = r + V3{thick, thick, thick};
    const Mass inner = solid(Primitive{RDM_ELLIPSOID, r, {}}),
               outer = solid(Primitive{RDM_ELLIPSOID, more, {}});
    const double density = out.mass / (outer.mass - inner.mass);
    for (size_t k = 0; k < 3; ++k) out.moment[k][k] = density * (outer.moment[k][k] - inner.moment[k][k]);
  }
  return s.X * out;
}

Mesh hull_of(const std::vector<V3>& points) {
  Mesh out;
  out.points = points;
  std::sort(out.points.begin(), out.points.end(),
            [](V3 a, V3 b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
  const auto same = [](V3 a, V3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; };
  out.points.erase(std::unique(out.points.begin(), out.points.end(), same), out.points.end());
  if (out.points.size() > kMostOfHull)
    refuse(RDM_RANGE, "the hull of %zu corners: more than %zu", out.points.size(), kMostOfHull);
  if (out.points.size() < 4) return out;
  double size = 0;
  for (const V3& p : out.points) size = std::max(size, norm(p - out.points[0]));
  const double close = 1e-9 * size;
  const auto first = first_corners(out.points, close);
  if (first.size() < 4) return out;
  const V3 inside =
      0.25 * (out.points[first[0]] + out.points[first[1]] + out.points[first[2]] + out.points[first[3]]);
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
    std::array<uint32_t, 3> f{a, b, c};
    if (side(out, f, inside) > 0) std::swap(f[1], f[2]);
    out.faces.push_back(f);
  };
  for (size_t k = 0; k < 4; ++k) add(first[k], first[(k + 1) % 4], first[(k + 2) % 4]);
  for (uint32_t k = 0; k < out.points.size(); ++k) {
    std::set<std::pair<uint32_t, uint32_t>> edges;  // of the faces that this corner sees
    std::vector<std::array<uint32_t, 3>> kept;
    for (const auto& f : out.faces) {
      if (side(out, f, out.points[k]) <= close) {
        kept.push_back(f);
        continue;
      }
      for (size_t i = 0; i < 3; ++i) edges.insert({f[i], f[(i + 1) % 3]});
    }
    if (edges.empty()) continue;
    out.faces = kept;
    for (const auto& [a, b] : edges)
      if (!edges.count({b, a})) out.faces.push_back({a, b, k});
  }
  return out;
}

}  // namespace rdm::import
