#include "mesh/parts.hpp"

#include "common/report.hpp"

#ifdef REDMAN_HACD
#include <hacdHACD.h>

#include <memory>
#endif

namespace tool {

#ifdef REDMAN_HACD
std::vector<std::vector<Point>> parts_of(const Mesh& mesh, int32_t most, const std::string& what) {
  if (most <= 1) return {mesh.points};
  if (mesh.faces.empty()) throw Failure(what + ": it has no faces to be cut by");
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
  cutter.SetConcavity(1e9);  // the number of parts decides
  cutter.SetAddExtraDistPoints(false);
  cutter.SetAddNeighboursDistPoints(false);
  cutter.SetAddFacesPoints(false);
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
      "object: this tool was built without HACD; install libbullet-extras-dev and configure with "
      "-DREDMAN_HACD=ON, or give --parts 1");
}
#endif

}  // namespace tool
