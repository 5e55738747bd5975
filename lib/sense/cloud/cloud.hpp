// Point clouds out of depth pictures, thinned to a fixed number of points.
//
// A pixel (u, v) of depth z is the point eye + z R_WC ((u - w/2) pixel, (v - h/2) pixel, 1) of the world: a
// pinhole with square pixels (camera.hpp). Thinning keeps the furthest points (furthest.hpp), random ones, or
// one of each voxel, the first that was seen.
#pragma once
#include <cstdint>

#include "base/rng.hpp"
#include "sense/cloud/furthest.hpp"
#include "sense/cloud/key_set.hpp"
#include "sense/render/camera.hpp"

namespace rdm {

enum class Thinning : int32_t { kFurthest = 0, kRandom = 1, kVoxel = 2 };

// A row of points and the numbers of the shapes they lie on.
struct Cloud {
  float* points = nullptr;   // [count][3], world, m
  int32_t* shape = nullptr;  // [count]
  int32_t count = 0;
};

// Appends the points that a depth picture shows no further than `range` m from `centre`; pixels that hit
// nothing give none.
void append_points(const View& view, const float* depth, const int32_t* segmentation, const Vec3& centre,
                   double range, Cloud* cloud);

struct CloudScratch {
  Cloud all;                  // of max_points
  int32_t* chosen = nullptr;  // [max_points]
  FurthestScratch furthest;
  KeySet voxels;
};
CloudScratch carve_cloud_scratch(Arena& arena, int32_t max_points, Thinning thinning);

// `wanted` points of scratch.all into `out`, whose arrays hold so many: the furthest from each other with a
// first one drawn from the stream, or drawn at random, or drawn from one point of each voxel of side
// `voxel` m. Where there are fewer they are repeated in turn; where there is none, all are 0 with shape -1.
// out.count is how many differ.
void thin_cloud(Thinning thinning, int32_t wanted, double voxel, Stream& stream, CloudScratch& scratch,
                Cloud* out);

// What a depth camera does to a thinned cloud of `wanted` points, of which the first cloud->count differ:
// each of these is lost with probability `dropout`, normal noise of deviation `noise` m moves each coordinate
// of the others, and they are repeated in turn again.
void disturb_cloud(double noise, double dropout, int32_t wanted, Stream& stream, Cloud* cloud);

}  // namespace rdm
