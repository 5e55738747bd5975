// redman hull: the option text that makes a mesh's convex hull an object of the tasks. qhull finds it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <redman/redman.hpp>

#include "commands.hpp"
#include "common/text.hpp"
#include "mesh/mesh.hpp"

#ifdef REDMAN_QHULL
#include <libqhull_r/qhull_ra.h>
#endif

namespace tool {
namespace {

constexpr int kMostPoints = 32;    // what option hull takes
constexpr double kFarthest = 1e3;  // m; so too. The squares of its sums stay small in qhull

struct HullFlags {
  std::string file;
  int points = kMostPoints;
  double scale = 1;
};

struct Plane {
  Point n;
  double offset;  // n . p + offset is how far p is outside
};
struct Solid {
  std::vector<Point> corners;
  std::vector<Plane> planes;
  double volume;
};

double beyond(const Plane& plane, const Point& p) {
  return plane.n[0] * p[0] + plane.n[1] * p[1] + plane.n[2] * p[2] + plane.offset;
}

#ifdef REDMAN_QHULL
Solid hull_of(std::vector<Point> points, const std::string& what) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> quiet(std::fopen("/dev/null", "w"), std::fclose);
  if (!quiet) throw Failure("cannot open /dev/null");
  qhT state;
  qhT* qh = &state;
  qh_zero(qh, quiet.get());
  char options[] = "qhull";
  Solid out;
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
  if (failed) throw Failure(what + ": its points are fewer than 4 or in one plane");
  return out;
}
#else
Solid hull_of(const std::vector<Point>&, const std::string&) {
  throw Failure(
      "hull: this tool was built without qhull; install libqhull-dev and configure with -DREDMAN_QHULL=ON");
}
#endif

// Farthest corner of `whole` outside `part`, and how far that is.
std::pair<Point, double> farthest(const Solid& whole, const Solid& part) {
  std::pair<Point, double> out{{}, 0};
  for (const Point& p : whole.corners)
    for (const Plane& plane : part.planes)
      if (beyond(plane, p) > out.second) out = {p, beyond(plane, p)};
  return out;
}

// The corners of `whole` that are extreme along the axes and their diagonals, at most `most` of them.
std::vector<Point> first_corners(const Solid& whole, size_t most) {
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

// "0.031", "-0.0004": to a hundredth of a millimetre.
std::string short_number(double x) {
  std::string text = format("%.5f", x);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

Report run_hull(const HullFlags& flags) {
  std::vector<Point> points = mesh_points(flags.file);
  for (Point& p : points)
    for (double& x : p) {
      x *= flags.scale;
      if (!(std::abs(x) <= kFarthest))
        throw Failure(flags.file +
                      format(": with --scale a vertex is farther than %g m from the origin", kFarthest));
    }
  const Solid whole = hull_of(points, flags.file);
  std::vector<Point> kept = whole.corners;
  if (kept.size() > static_cast<size_t>(flags.points))
    kept = first_corners(whole, static_cast<size_t>(flags.points));
  Solid part = hull_of(kept, flags.file);
  while (kept.size() < static_cast<size_t>(flags.points)) {
    const auto [p, out] = farthest(whole, part);
    if (out < 1e-5) break;
    kept.push_back(p);
    part = hull_of(kept, flags.file);
  }
  const double error = farthest(whole, part).second;

  std::string option;
  for (const Point& p : part.corners)
    option += (option.empty() ? "" : ";") + short_number(p[0]) + ',' + short_number(p[1]) + ',' +
              short_number(p[2]);
  const rdm_option asked[] = {{"object", "hull", 0}, {"hull", option.c_str(), 0}};
  rdm_pool_config config = redman::pool_config("hand_over_safe_finger");
  config.options = asked;
  config.num_options = 2;
  auto spec = redman::sized<rdm_spec>();
  redman::check(rdm_pool_spec(&config, &spec));

  const Json json = {
      {"file", flags.file},        {"points", part.corners},   {"corners", whole.corners.size()},
      {"error_m", error},          {"volume_m3", part.volume}, {"volume_share", part.volume / whole.volume},
      {"option", "hull=" + option}};
  return {json, "hull=" + option + '\n'};
}

}  // namespace

void add_hull(CLI::App& app, Run& run) {
  auto flags = std::make_shared<HullFlags>();
  CLI::App* command =
      app.add_subcommand("hull", "The points of a mesh's convex hull, for --set object=hull --set hull=...");
  command->add_option("file", flags->file, ".obj or .stl")->required();
  command->add_option("--points", flags->points, "at most so many corners, the farthest out first")
      ->check(CLI::Range(4, kMostPoints));
  command->add_option("--scale", flags->scale, "m per unit of the file")->check(CLI::PositiveNumber);
  command->callback([&run, flags] { run = [flags] { return run_hull(*flags); }; });
}

}  // namespace tool
