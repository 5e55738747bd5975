// redman hull: the option text that makes a mesh's convex hull an object of the tasks. qhull finds it.
#include <cmath>
#include <memory>
#include <redman/redman.hpp>

#include "commands.hpp"
#include "common/numbers.hpp"
#include "common/text.hpp"
#include "mesh/hulls.hpp"

namespace tool {
namespace {

constexpr int kMostPoints = 32;         // what option hull takes
constexpr double kFarthestPoint = 1e3;  // m; so too. The squares of its sums stay small in qhull

struct HullFlags {
  std::string file;
  int points = kMostPoints;
  double scale = 1;
};

// "0.031", "-0.0004": to a hundredth of a millimetre.
std::string decimal_text(double x) {
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
      if (!(std::abs(x) <= kFarthestPoint))
        throw Failure(flags.file +
                      format(": with --scale a vertex is farther than %g m from the origin", kFarthestPoint));
    }
  const FewHull few = few_hull(points, static_cast<size_t>(flags.points), flags.file);
  const Hull& part = few.hull;

  std::string option;
  for (const Point& p : part.corners)
    option += (option.empty() ? "" : ";") + decimal_text(p[0]) + ',' + decimal_text(p[1]) + ',' +
              decimal_text(p[2]);
  const rdm_option asked[] = {{"object", "hull", 0}, {"hull", option.c_str(), 0}};
  rdm_pool_config config = redman::pool_config("hand_over_safe_finger");
  config.options = asked;
  config.num_options = 2;
  auto spec = redman::sized<rdm_spec>();
  redman::check(rdm_pool_config_spec(&config, &spec));

  const Json json = {{"file", flags.file},        {"points", part.corners},   {"corners", few.corners},
                     {"error_m", few.error},      {"volume_m3", part.volume}, {"volume_share", few.share},
                     {"option", "hull=" + option}};
  return {json, "hull=" + option + '\n'};
}

}  // namespace

void add_hull(CLI::App& app, Run& run) {
  auto flags = std::make_shared<HullFlags>();
  CLI::App* command =
      app.add_subcommand("hull", "Compute the convex hull of a mesh for --set object=hull --set hull=...");
  command->add_option("file", flags->file, "mesh file to read (.obj or .stl)")->required();
  command->add_option("--points", flags->points, "largest number of corners; the outermost are kept")
      ->check(between(4, kMostPoints));
  command->add_option("--scale", flags->scale, "length of one unit of the file, m")->check(above_zero());
  command->callback([&run, flags] { run = [flags] { return run_hull(*flags); }; });
}

}  // namespace tool
