#include "mesh/parts.hpp"

#include "common/report.hpp"

#ifdef REDMAN_HACD
#include <hacdHACD.h>

#include <algorithm>
#include <map>
#include <utility>
#endif

namespace tool {

#ifdef REDMAN_HACD
namespace {

constexpr size_t kFewFaces = 1000, kMostFaces = 20000;

// Each triangle as four: what is cut is cut along edges.
Mesh finer(const Mesh& mesh) {
  Mesh out;
  out.points = mesh.points;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
  const auto middle = [&](uint32_t a, uint32_t b) {
    const auto [at, added] = middles.emplace(std::minmax(a, b), static_cast<uint32_t>(out.points.size()));
    if (added) {
      const Point &p = mesh.points[a], &q = mesh.points[b];
      out.points.push_back({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2});
    }
    return at->second;
  };
  for (const auto& f : mesh.faces) {
    const uint32_t a = middle(f[0], f[1]), b = middle(f[1], f[2]), c = middle(f[2], f[0]);
    out.faces.insert(out.faces.end(), {{f[0], a, c}, {a, f[1], b}, {c, b, f[2]}, {a, b, c}});
  }
  return out;
}

}  // namespace

std::vector<std::vector<Point>> parts_of(const Mesh& whole, int32_t most, const std::string& what) {
  if (most <= 1) return {whole.points};
  if (whole.faces.empty()) throw Failure(what + ": it has no faces, so it cannot be cut into parts");
  if (whole.faces.size() > kMostFaces)
    throw Failure(what + ": more than " + std::to_string(kMostFaces) +
                  " faces, which are too many to cut into parts: make it coarser, or give --parts 1");
  Mesh mesh = whole;
  while (mesh.faces.size() < kFewFaces) mesh = finer(mesh);
  std::vector<HACD::Vec3<HACD::Real>> points;
  for (const Point& p : mesh.points) points.emplace_back(p[0], p[1], p[2]);
  std::vector<HACD::Vec3<long>> faces;
  for (const auto& f : mesh.faces)
    faces.emplace_back(static_cast<long>(f[0]), static_cast<long>(f[1]), static_cast<long>(f[2]));
  HACD::HACD cutter;
  cutter.SetPoints(points.data());
  cutter.SetNPoints(points.size());
  cutter.SetTriangles(faces.data());
  cutter.SetNTriangles(faces.size());
  cutter.SetCompacityWeight(0.0001);
  cutter.SetVolumeWeight(0);
  cutter.SetNClusters(static_cast<size_t>(most));
  cutter.SetNVerticesPerCH(100);
  cutter.SetConcavity(1e9);            // the number of parts decides
  cutter.SetAddExtraDistPoints(true);  // the far side counts for how hollow a part is
  cutter.SetAddNeighboursDistPoints(true);
  cutter.SetAddFacesPoints(true);
  if (!cutter.Compute(false, false)) throw Failure(what + ": it cannot be cut into parts");
  std::vector<std::vector<Point>> out(cutter.GetNClusters());
  const long* part = cutter.GetPartition();
  for (size_t f = 0; f < faces.size(); ++f)
    for (const uint32_t i : mesh.faces[f]) out[static_cast<size_t>(part[f])].push_back(mesh.points[i]);
  return out;
}
#else
std::vector<std::vector<Point>> parts_of(const Mesh& mesh, int32_t most, const std::string&) {
  if (most <= 1) return {mesh.points};
  throw Failure(
      "object: this tool was built without HACD: install libbullet-extras-dev and configure with "
      "-DREDMAN_HACD=ON, or give --parts 1");
}
#endif

}  // namespace tool
