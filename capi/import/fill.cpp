#include "fill.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "import.hpp"

namespace rdm::import {
namespace {

constexpr size_t kFacesPerStep = 16;  // that are looked at, of the budget's steps

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

// Volume, centre and moments about the apex of the pyramids from it to the faces.
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

// A hull that grows corner by corner. Corners in one plane are what makes this fail, so they are shifted a
// little, the same way each time; the faces' numbers are those of the corners as they were.
class Hull {
 public:
  Hull(const std::vector<V3>& corners, double scale, double shift, Budget* account) : budget_(account) {
    uint64_t state = 1;
    const auto random = [&] {  // in [-1, 1)
      state = state * 6364136223846793005u + 1442695040888963407u;
      return static_cast<double>(state >> 11) * 0x1p-52 - 1;
    };
    for (const V3& p : corners)
      points_.push_back(scale * (p - corners[0]) + shift * V3{random(), random(), random()});
  }
  // False: a corner's shadow has no simple edge.
  bool grow(const std::array<uint32_t, 4>& first) {
    const V3 inside = 0.25 * (points_[first[0]] + points_[first[1]] + points_[first[2]] + points_[first[3]]);
    for (size_t k = 0; k < 4; ++k) {
      Face f{first[k], first[(k + 1) % 4], first[(k + 2) % 4]};
      if (sees(inside, f)) std::swap(f[1], f[2]);
      if (!add(f)) return false;
    }
    for (uint32_t k = 0; k < points_.size(); ++k)
      if (std::find(first.begin(), first.end(), k) == first.end() && !take(k)) return false;
    return true;
  }
  std::vector<std::array<uint32_t, 3>> faces() const {
    std::vector<Face> out;
    for (const Face& f : faces_)
      if (f[0] != f[1]) out.push_back(f);
    return out;
  }

 private:
  using Face = std::array<uint32_t, 3>;  // 0, 0, 0: it is gone
  Budget* budget_;
  std::vector<V3> points_;
  std::vector<Face> faces_;
  std::vector<size_t> free_;
  std::map<std::pair<uint32_t, uint32_t>, size_t> left_;  // face to the left of an edge

  bool sees(V3 p, const Face& f) const {
    const V3 a = points_[f[0]];
    return dot(cross(points_[f[1]] - a, points_[f[2]] - a), p - a) > 0;
  }
  bool add(const Face& f) {
    const size_t at = free_.empty() ? faces_.size() : free_.back();
    if (free_.empty())
      faces_.push_back(f);
    else
      faces_[at] = f, free_.pop_back();
    for (size_t k = 0; k < 3; ++k)
      if (!left_.emplace(std::make_pair(f[k], f[(k + 1) % 3]), at).second) return false;
    return true;
  }
  // Cuts away what the corner sees, and closes the hole with a cone of its edge.
  bool take(uint32_t corner) {
    const V3 p = points_[corner];
    budget_->spend(Cost::kSteps, 1 + faces_.size() / kFacesPerStep);
    size_t start = 0;
    while (start < faces_.size() && (faces_[start][0] == faces_[start][1] || !sees(p, faces_[start])))
      ++start;
    if (start == faces_.size()) return true;  // inside
    std::vector<size_t> seen{start};
    std::set<size_t> in{start};
    std::vector<std::pair<uint32_t, uint32_t>> edge;
    for (size_t i = 0; i < seen.size(); ++i) {
      const Face f = faces_[seen[i]];
      for (size_t k = 0; k < 3; ++k) {
        const auto beyond = left_.find({f[(k + 1) % 3], f[k]});
        if (beyond == left_.end()) return false;
        if (in.count(beyond->second)) continue;
        if (!sees(p, faces_[beyond->second]))
          edge.emplace_back(f[k], f[(k + 1) % 3]);
        else if (in.insert(beyond->second).second)
          seen.push_back(beyond->second);
      }
    }
    for (const size_t i : seen) {
      for (size_t k = 0; k < 3; ++k) left_.erase({faces_[i][k], faces_[i][(k + 1) % 3]});
      faces_[i] = {};
      free_.push_back(i);
    }
    return std::all_of(edge.begin(), edge.end(), [&](const auto& e) {
      return add({e.first, e.second, corner});
    });
  }
};

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

Mass filled(const Mesh& mesh, Fill how, Budget* budget) {
  if (how == Fill::kConvex || mesh.faces.empty()) {
    const Mesh hull = hull_of(mesh.points, budget);
    return hull.faces.empty() ? Mass{} : filled(hull, how == Fill::kShell ? how : Fill::kExact, budget);
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
  if (s.kind == RDM_SHAPE_SPHERE) {
    out.mass = 4 * M_PI * r.x * r.x;
    const double m = 2.0 / 3 * out.mass * r.x * r.x;
    moments(m, m, m);
  } else if (s.kind == RDM_SHAPE_CYLINDER || s.kind == RDM_SHAPE_CAPSULE) {
    const bool capsule = s.kind == RDM_SHAPE_CAPSULE;
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
  } else if (s.kind == RDM_SHAPE_BOX) {
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
    const Mass inner = solid(Primitive{RDM_SHAPE_ELLIPSOID, r, {}}),
               outer = solid(Primitive{RDM_SHAPE_ELLIPSOID, more, {}});
    const double density = out.mass / (outer.mass - inner.mass);
    for (size_t k = 0; k < 3; ++k) out.moment[k][k] = density * (outer.moment[k][k] - inner.moment[k][k]);
  }
  return s.X * out;
}

std::vector<V3> corners_of(const std::vector<V3>& points) {
  std::vector<V3> out = points;
  std::sort(out.begin(), out.end(),
            [](V3 a, V3 b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
  const auto same = [](V3 a, V3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; };
  out.erase(std::unique(out.begin(), out.end(), same), out.end());
  return out;
}

Mesh hull_of(const std::vector<V3>& points, Budget* budget) {
  Mesh out;
  out.points = corners_of(points);
  if (out.points.size() > kMostOfHull)
    refuse(RDM_ERROR_RANGE, "the hull has %zu corners, which is more than %zu", out.points.size(),
           kMostOfHull);
  if (out.points.size() < 4) return out;
  double size = 0;
  for (const V3& p : out.points) size = std::max(size, norm(p - out.points[0]));
  const auto first = first_corners(out.points, 1e-9 * size);
  if (first.size() < 4) return out;
  for (double shift = 1e-9; shift < 1e-5; shift *= 10) {
    Hull hull(out.points, 1 / size, shift, budget);
    if (!hull.grow({first[0], first[1], first[2], first[3]})) continue;
    out.faces = hull.faces();
    return out;
  }
  return out;
}

}  // namespace rdm::import
