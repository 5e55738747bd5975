#include "mesh/hulls.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>

#include "common/report.hpp"

#ifdef REDMAN_QHULL
#include <libqhull_r/qhull_ra.h>
#endif

namespace tool {

double beyond(const Plane& plane, const Point& p) {
  return plane.n[0] * p[0] + plane.n[1] * p[1] + plane.n[2] * p[2] + plane.offset;
}

#ifdef REDMAN_QHULL
Hull hull_of(std::vector<Point> points, const std::string& what) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> quiet(std::fopen("/dev/null", "w"), std::fclose);
  if (!quiet) throw Failure("cannot open /dev/null");
  qhT state;
  qhT* qh = &state;
  qh_zero(qh, quiet.get());
  char options[] = "qhull";
  Hull out;
  const int failed = qh_new_qhull(qh, 3, static_cast<int>(points.size()), points[0].data(), False, options,
                                  quiet.get(), quiet.get());
  if (!failed) {
    qh_getarea(qh, qh->facet_list);
    out.volume = qh->totvol;
    const facetT* facet;
    const vertexT* vertex;
    FORALLfacets out.planes.push_back(
        {{facet->normal[0], facet->normal[1], facet->normal[2]}, facet->offset});
    FORALLvertices out.corners.push_back({vertex->point[0], vertex->point[1], vertex->point[2]});
  }
  qh_freeqhull(qh, !qh_ALL);
  int long_left = 0, total = 0;
  qh_memfreeshort(qh, &long_left, &total);
  if (failed) throw Failure(what + ": it has fewer than 4 points, or they lie in one plane");
  return out;
}
#else
Hull hull_of(std::vector<Point>, const std::string&) {
  throw Failure(
      "hull: this tool was built without qhull: install libqhull-dev and configure with -DREDMAN_QHULL=ON");
}
#endif

namespace {

// Farthest corner of `whole` outside `part`, and how far that is.
std::pair<Point, double> farthest(const Hull& whole, const Hull& part) {
  std::pair<Point, double> out{{}, 0};
  for (const Point& p : whole.corners)
    for (const Plane& plane : part.planes)
      if (beyond(plane, p) > out.second) out = {p, beyond(plane, p)};
  return out;
}

// The corners of `whole` that are extreme along the axes and their diagonals, at most `most` of them.
std::vector<Point> first_corners(const Hull& whole, size_t most) {
  constexpr double kWays[][3] = {{1, 1, 1},  {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}, {1, 0, 0},
                                 {-1, 0, 0}, {0, 1, 0},   {0, -1, 0},  {0, 0, 1},   {0, 0, -1}};
  std::vector<Point> out;
  for (const auto& way : kWays) {
    const auto reach = [&](const Point& p) { return way[0] * p[0] + way[1] * p[1] + way[2] * p[2]; };
    const Point& p = *std::max_element(whole.corners.begin(), whole.corners.end(),
                                       [&](const Point& a, const Point& b) { return reach(a) < reach(b); });
    if (out.size() < most && std::find(out.begin(), out.end(), p) == out.end()) out.push_back(p);
  }
  return out;
}

}  // namespace

FewHull few_hull(const std::vector<Point>& points, size_t most, const std::string& what) {
  const Hull whole = hull_of(points, what);
  std::vector<Point> kept = whole.corners;
  if (kept.size() > most) kept = first_corners(whole, most);
  Hull part = hull_of(kept, what);
  while (kept.size() < most) {
    const auto [p, out] = farthest(whole, part);
    if (out < 1e-5) break;
    kept.push_back(p);
    part = hull_of(kept, what);
  }
  const double error = farthest(whole, part).second, share = part.volume / whole.volume;
  return {std::move(part), whole.corners.size(), error, share};
}

}  // namespace tool
