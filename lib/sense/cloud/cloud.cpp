#include "sense/cloud/cloud.hpp"

#include <algorithm>
#include <cstring>

#include "sense/cloud/voxel_walk.hpp"

namespace rdm {
namespace {

// `wanted` of the `count` numbers in `list`, each as likely as the others, to its front.
void draw(int32_t* list, int32_t count, int32_t wanted, Stream& stream) {
  for (int32_t i = 0; i < wanted; ++i)
    std::swap(list[i], list[i + static_cast<int32_t>(stream.below(static_cast<uint32_t>(count - i)))]);
}

void clear(int32_t wanted, Cloud* out) {
  std::fill_n(out->points, 3 * static_cast<ptrdiff_t>(wanted), 0.0f);
  std::fill_n(out->shape, wanted, -1);
  out->count = 0;
}

void copy_point(const Cloud& from, int32_t i, Cloud* to, int32_t at) {
  std::memcpy(to->points + 3 * static_cast<ptrdiff_t>(at), from.points + 3 * static_cast<ptrdiff_t>(i),
              3 * sizeof(float));
  to->shape[at] = from.shape[i];
}

}  // namespace

void append_points(const View& view, const float* depth, const int32_t* segmentation, const Vec3& centre,
                   double range, Cloud* cloud) {
  const auto f = [](double v) { return static_cast<float>(v); };
  const Vec3 corner = view.R_WC * view.ray_C(0.5, 0.5);
  const Vec3 right = view.pixel * view.R_WC.col(0), down = view.pixel * view.R_WC.col(1);
  const float eye[3] = {f(view.eye.x), f(view.eye.y), f(view.eye.z)};
  const float middle[3] = {f(centre.x), f(centre.y), f(centre.z)};
  const float square = f(range * range);
  for (int32_t v = 0; v < view.height; ++v)
    for (int32_t u = 0; u < view.width; ++u, ++depth, ++segmentation) {
      if (*segmentation < 0) continue;
      float* p = cloud->points + 3 * static_cast<ptrdiff_t>(cloud->count);
      float sum = 0;
      for (int k = 0; k < 3; ++k) {
        p[k] = eye[k] + *depth * (f(corner[k]) + static_cast<float>(u) * f(right[k]) +
                                  static_cast<float>(v) * f(down[k]));
        sum += (p[k] - middle[k]) * (p[k] - middle[k]);
      }
      if (!(sum <= square)) continue;
      cloud->shape[cloud->count++] = *segmentation;
    }
}

CloudScratch carve_cloud_scratch(Arena& arena, int32_t max_points, Thinning thinning) {
  const auto count = static_cast<size_t>(max_points);
  CloudScratch s;
  s.all.points = arena.make<float>(3 * count);
  s.all.shape = arena.make<int32_t>(count);
  s.chosen = arena.make<int32_t>(count);
  if (thinning == Thinning::kFurthest) s.furthest = carve_furthest_scratch(arena, max_points);
  if (thinning == Thinning::kVoxel) s.voxels = KeySet(arena, count);
  return s;
}

void thin_cloud(Thinning thinning, int32_t wanted, double voxel, Stream& stream, CloudScratch& s,
                Cloud* out) {
  int32_t count = s.all.count;
  if (thinning == Thinning::kVoxel) {
    const VoxelLattice lattice(voxel);
    int32_t kept = 0;
    s.voxels.shrink(0);
    for (int32_t i = 0; i < count; ++i) {
      const float* p = s.all.points + 3 * static_cast<ptrdiff_t>(i);
      VoxelKey key;
      const size_t before = s.voxels.size();
      if (lattice.key({p[0], p[1], p[2]}, &key)) s.voxels.add(pack(key));
      if (s.voxels.size() > before) s.chosen[kept++] = i;
    }
    count = kept;
  } else {
    for (int32_t i = 0; i < count; ++i) s.chosen[i] = i;
  }
  if (count == 0) return clear(wanted, out);  // nothing was seen, or nothing within the lattice of voxels
  const int32_t some = std::min(wanted, count);
  if (some < count && thinning == Thinning::kFurthest)
    sample_furthest(s.all.points, count, some,
                    static_cast<int32_t>(stream.below(static_cast<uint32_t>(count))), s.furthest, s.chosen);
  else if (some < count)
    draw(s.chosen, count, some, stream);
  for (int32_t i = 0; i < wanted; ++i) copy_point(s.all, s.chosen[i % some], out, i);
  out->count = some;
}

void disturb_cloud(double noise, double dropout, int32_t wanted, Stream& stream, Cloud* cloud) {
  int32_t kept = 0;
  for (int32_t i = 0; i < cloud->count; ++i)
    if (!(dropout > 0 && stream.uniform() < dropout)) copy_point(*cloud, i, cloud, kept++);
  if (kept == 0) return clear(wanted, cloud);
  for (int32_t i = 0; noise > 0 && i < kept; ++i) {
    float off[3];
    stream.normals(off, 3);
    for (int k = 0; k < 3; ++k)
      cloud->points[3 * static_cast<ptrdiff_t>(i) + k] += static_cast<float>(noise) * off[k];
  }
  for (int32_t i = kept; i < wanted; ++i) copy_point(*cloud, i % kept, cloud, i);
  cloud->count = kept;
}

}  // namespace rdm
