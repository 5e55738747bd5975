// Occupancy maps beside plain OctoMap on the same scans, as JSON: scans/s and points/s of insertion,
// queries/s, the time of a ray and of a distance, and how far the map is from the scene that was scanned.
//   bench_map [resolution] [scans] [option=value ...]
// The scans are depths of the hand-over scene from its cameras while the hands move. Times are of the
// processor, the two programs in turn, the best of some rounds.
#include <octomap/OcTree.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "env/pool.hpp"
#include "sense/cloud/cloud.hpp"
#include "sense/map/occupancy.hpp"
#include "sense/scene_shapes.hpp"
#include "tasks/catalog.hpp"

namespace {

using namespace rdm;

double seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Scan {
  Vec3 eye;
  std::vector<float> points;
};

// Depths of the scene from three cameras, while random actions move the hands.
std::vector<Scan> make_scans(Pool& pool, int count) {
  const SenseConfig& c = pool.sense();
  const Scene& scene = pool.task().scene();
  Arena measure;
  carve_raycast_scratch(measure, static_cast<int32_t>(scene.shapes.size()));
  Arena arena({}, measure.used());
  const RaycastScratch scratch = carve_raycast_scratch(arena, static_cast<int32_t>(scene.shapes.size()));
  std::vector<RenderShape> shapes(scene.shapes.size());
  const int32_t w = c.cloud_width, h = c.cloud_height;
  std::vector<float> depth(static_cast<size_t>(w * h));
  std::vector<int32_t> ids(depth.size());
  std::vector<Scan> scans;
  pool.reset(nullptr, nullptr);
  for (int i = 0; i < count; ++i) {
    const Camera& camera = c.cloud_cameras[i % c.num_cloud_cameras];
    const int32_t all = gather_shapes(pool.world(0), shapes.data());
    render(shapes.data(), all, camera, {w, h, nullptr, depth.data(), ids.data()}, {}, scratch);
    Scan scan;
    scan.eye = camera.eye;
    scan.points.resize(3 * depth.size());
    std::vector<int32_t> on(depth.size());
    Cloud cloud{scan.points.data(), on.data(), 0};
    append_points(make_view(camera, w, h), depth.data(), ids.data(), camera.target, 3, &cloud);
    scan.points.resize(3 * static_cast<size_t>(cloud.count));
    scans.push_back(std::move(scan));
    pool.baseline(Baseline::kRandom);
    pool.step(nullptr);
  }
  return scans;
}

octomap::point3d to_octomap(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

struct Timed {
  double ours = 1e30, plain = 1e30;
};
template <class A, class B>
Timed in_turn(int rounds, A&& ours, B&& plain) {
  Timed t;
  for (int i = 0; i < rounds; ++i) {
    double begin = seconds();
    ours();
    t.ours = std::min(t.ours, seconds() - begin);
    begin = seconds();
    plain();
    t.plain = std::min(t.plain, seconds() - begin);
  }
  return t;
}

double depth_in(const RenderShape& s, const Vec3& p) {  // signed distance from the shape, m
  const Vec3 q = inverse(s.X_WS) * p;
  switch (s.kind) {
    case ShapeKind::kSphere:
      return norm(q) - s.size.x;
    case ShapeKind::kCapsule:
      return norm(q - Vec3{0, 0, std::clamp(q.z, -s.size.y, s.size.y)}) - s.size.x;
    case ShapeKind::kBox: {
      const Vec3 d{std::abs(q.x) - s.size.x, std::abs(q.y) - s.size.y, std::abs(q.z) - s.size.z};
      return norm({std::max(d.x, 0.0), std::max(d.y, 0.0), std::max(d.z, 0.0)}) +
             std::min(0.0, std::max({d.x, d.y, d.z}));
    }
    case ShapeKind::kCylinder: {
      const double a = std::hypot(q.x, q.y) - s.size.x, b = std::abs(q.z) - s.size.y;
      return norm({std::max(a, 0.0), std::max(b, 0.0), 0}) + std::min(0.0, std::max(a, b));
    }
    default:
      return q.z;
  }
}

struct Error2 {
  double mean = 0, largest = 0, missed = 0, false_free = 0;
};

// Of a map of the scene at rest: distance of occupied voxels' centres from the nearest surface, the share of
// scanned surface points whose voxel is not occupied, and of free voxels that lie wholly within a shape.
Error2 map_error(Pool& pool, double resolution) {
  OccupancyConfig config;
  config.resolution = resolution;
  Occupancy* map = Occupancy::create(config, {});
  Pool* still = &pool;
  still->reset(nullptr, nullptr);
  std::vector<RenderShape> shapes(pool.task().scene().shapes.size());
  const int32_t all = gather_shapes(pool.world(0), shapes.data());
  Error2 e;
  const std::vector<Scan> scans = [&] {
    std::vector<Scan> out;
    Arena measure;
    carve_raycast_scratch(measure, all);
    Arena arena({}, measure.used());
    const RaycastScratch scratch = carve_raycast_scratch(arena, all);
    const SenseConfig& c = pool.sense();
    const int32_t side = 256;
    std::vector<float> depth(side * side);
    std::vector<int32_t> ids(depth.size()), on(depth.size());
    for (int32_t k = 0; k < c.num_cloud_cameras; ++k) {
      const Camera& camera = c.cloud_cameras[k];
      render(shapes.data(), all, camera, {side, side, nullptr, depth.data(), ids.data()}, {}, scratch);
      Scan scan;
      scan.eye = camera.eye;
      scan.points.resize(3 * depth.size());
      Cloud cloud{scan.points.data(), on.data(), 0};
      append_points(make_view(camera, side, side), depth.data(), ids.data(), camera.target, 3, &cloud);
      scan.points.resize(3 * static_cast<size_t>(cloud.count));
      out.push_back(std::move(scan));
    }
    return out;
  }();
  for (const Scan& s : scans) map->insert(s.eye, s.points.data(), s.points.size() / 3);
  const auto surface = [&](const Vec3& p) {
    double best = 1e9;
    for (int32_t i = 0; i < all; ++i) best = std::min(best, depth_in(shapes[static_cast<size_t>(i)], p));
    return best;
  };
  double count = 0;
  map->box({-1, -1.5, -0.1}, {1, 0.5, 1.5}, [&](const OccupiedVoxel& v) {
    const double gap = std::abs(surface(v.centre));
    e.mean += gap;
    e.largest = std::max(e.largest, gap);
    ++count;
  });
  e.mean /= count;
  double points = 0, free = 0, wrong = 0;
  for (const Scan& s : scans)
    for (size_t i = 0; i < s.points.size(); i += 3, ++points)
      e.missed += map->at({s.points[i], s.points[i + 1], s.points[i + 2]}) < 0.5f;
  e.missed /= points;
  for (double x = -0.3; x < 0.3; x += 0.011)
    for (double y = -1; y < 0; y += 0.011)
      for (double z = 0.3; z < 0.7; z += 0.011) {
        const float p = map->at({x, y, z});
        if (p < 0 || p >= 0.5f) continue;
        ++free;
        wrong += surface({x, y, z}) < -resolution;
      }
  e.false_free = wrong / free;
  Occupancy::destroy(map);
  return e;
}

int run(int argc, char** argv) {
  const double resolution = argc > 1 ? std::atof(argv[1]) : 0.02;
  const int count = argc > 2 ? std::atoi(argv[2]) : 60;
  register_builtin_tasks();
  std::vector<OptionInput> options = {{"modality", "points", 0}};
  std::vector<std::string> texts(argv + std::min(argc, 3), argv + argc);
  for (std::string& t : texts) {
    const size_t at = t.find('=');
    if (at == std::string::npos) return std::fprintf(stderr, "%s: it is not key=value\n", t.c_str()), 2;
    t[at] = '\0';
    options.push_back({t.c_str(), t.c_str() + at + 1, 0});
  }
  PoolConfig config;
  config.task = "hand_over_safe_finger";
  config.options = options.data();
  config.num_options = static_cast<int32_t>(options.size());
  Pool* pool = Pool::create(config);
  const std::vector<Scan> scans = make_scans(*pool, count);
  size_t points = 0;
  std::vector<octomap::Pointcloud> clouds(scans.size());
  for (size_t k = 0; k < scans.size(); ++k) {
    const auto& p = scans[k].points;
    points += p.size() / 3;
    for (size_t i = 0; i < p.size(); i += 3) clouds[k].push_back(p[i], p[i + 1], p[i + 2]);
  }
  OccupancyConfig map_config;
  map_config.resolution = resolution;
  Occupancy* map = Occupancy::create(map_config, {});
  octomap::OcTree tree(resolution);
  const Timed insert = in_turn(
      5,
      [&] {
        map->clear();
        for (const Scan& s : scans) map->insert(s.eye, s.points.data(), s.points.size() / 3);
      },
      [&] {
        tree.clear();
        for (size_t k = 0; k < scans.size(); ++k) tree.insertPointCloud(clouds[k], to_octomap(scans[k].eye));
      });

  Stream stream(1, 0, Purpose::kTest);
  std::vector<float> asked;
  for (int i = 0; i < 200000; ++i) {
    float v[3];
    stream.signed_units(v, 3);
    asked.insert(asked.end(), {0.5f * v[0], 0.7f * v[1] - 0.5f, 0.4f * v[2] + 0.5f});
  }
  std::vector<float> answer(asked.size() / 3), other(answer.size());
  const Timed query = in_turn(
      7, [&] { map->query(asked.data(), answer.size(), answer.data()); },
      [&] {
        for (size_t i = 0; i < other.size(); ++i) {
          const octomap::OcTreeNode* node = tree.search(asked[3 * i], asked[3 * i + 1], asked[3 * i + 2]);
          other[i] = node ? static_cast<float>(node->getOccupancy()) : -1;
        }
      });
  size_t same = 0;
  for (size_t i = 0; i < other.size(); ++i) same += std::abs(answer[i] - other[i]) < 1e-5f;
  constexpr int kRays = 20000;
  int hits = 0, plain_hits = 0;
  const Timed cast = in_turn(
      5,
      [&] {
        hits = 0;
        for (int i = 0; i < kRays; ++i) {
          const float* v = &asked[static_cast<size_t>(3 * i)];
          Vec3 hit;
          hits += map->cast({0, -0.5, 0.95}, Vec3{v[0], v[1], v[2]} - Vec3{0, -0.5, 0.95}, 1, true, &hit);
        }
      },
      [&] {
        plain_hits = 0;
        for (int i = 0; i < kRays; ++i) {
          const float* v = &asked[static_cast<size_t>(3 * i)];
          octomap::point3d hit;
          plain_hits += tree.castRay({0, -0.5f, 0.95f}, octomap::point3d(v[0], v[1] + 0.5f, v[2] - 0.95f),
                                     hit, true, 1);
        }
      });
  double sum = 0;
  const double begin = seconds();
  for (int i = 0; i < kRays; ++i) {
    const float* v = &asked[static_cast<size_t>(3 * i)];
    sum += map->distance({v[0], v[1], v[2]}, 1);
  }
  const double distance = (seconds() - begin) / kRays;
  const Error2 e = map_error(*pool, resolution);
  const double n = static_cast<double>(scans.size()), q = static_cast<double>(answer.size());
  std::printf(
      "{\"resolution\":%g,\"scans\":%zu,\"points\":%zu,\"nodes\":%zu,\"plain_nodes\":%zu,\"bytes\":%zu,"
      "\"scans_per_second\":%.1f,\"plain_scans_per_second\":%.1f,\"insert_ratio\":%.3f,"
      "\"points_per_second\":%.0f,"
      "\"queries_per_second\":%.0f,\"plain_queries_per_second\":%.0f,\"query_ratio\":%.3f,\"same_answers\":%."
      "6f,"
      "\"rays_per_second\":%.0f,\"plain_rays_per_second\":%.0f,\"ray_ratio\":%.3f,\"hits\":%d,\"plain_hits\":"
      "%d,"
      "\"distance_us\":%.3f,\"mean_distance_m\":%.4f,"
      "\"error_mean_m\":%.5f,\"error_max_m\":%.5f,\"surface_missed\":%.5f,\"free_inside\":%.6f}\n",
      resolution, scans.size(), points, map->info().nodes, tree.size(), map->info().bytes, n / insert.ours,
      n / insert.plain, insert.plain / insert.ours, static_cast<double>(points) / insert.ours, q / query.ours,
      q / query.plain, query.plain / query.ours, static_cast<double>(same) / q, kRays / cast.ours,
      kRays / cast.plain, cast.plain / cast.ours, hits, plain_hits, 1e6 * distance, sum / kRays, e.mean,
      e.largest, e.missed, e.false_free);
  Occupancy::destroy(map);
  Pool::destroy(pool);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const rdm::Error& e) {
    std::fprintf(stderr, "bench_map: %s\n", e.text);
    return 1;
  }
}
