// The local grid against the shapes that were seen: what it calls occupied is near a surface, what it calls
// free is outside of everything.
#include <gtest/gtest.h>

#include "sense/cloud/depth_grid.hpp"
#include "sense_shapes.hpp"

namespace rdm {
namespace {

constexpr int32_t kSide = 20;
constexpr double kCell = 0.04;

struct Seen {
  explicit Seen(std::vector<Camera> cameras) {
    ball.kind = ShapeKind::kSphere;
    ball.size = {0.25, 0, 0};
    ball.X_WS.p = {0.05, 0.02, 0.03};
    Arena measure;
    carve_raycast_scratch(measure, 1);
    Arena arena({}, measure.used());
    const RaycastScratch scratch = carve_raycast_scratch(arena, 1);
    depth.resize(cameras.size(), std::vector<float>(200 * 200));
    std::vector<DepthPicture> pictures;
    for (size_t i = 0; i < cameras.size(); ++i) {
      render(&ball, 1, cameras[i], {200, 200, nullptr, depth[i].data(), nullptr}, {}, scratch);
      pictures.push_back({make_view(cameras[i], 200, 200), depth[i].data()});
    }
    grid.resize(kSide * kSide * kSide);
    grid_from_depth(pictures.data(), static_cast<int32_t>(pictures.size()), {0, 0, 0}, kSide, kCell,
                    grid.data());
  }
  template <class F>
  void each(F&& f) const {
    const int8_t* at = grid.data();
    for (int x = 0; x < kSide; ++x)
      for (int y = 0; y < kSide; ++y)
        for (int z = 0; z < kSide; ++z) {
          const Vec3 p = kCell * Vec3{x + 0.5 - 0.5 * kSide, y + 0.5 - 0.5 * kSide, z + 0.5 - 0.5 * kSide};
          f(p, norm(p - ball.X_WS.p) - 0.25, *at++);
        }
  }
  RenderShape ball;
  std::vector<std::vector<float>> depth;
  std::vector<int8_t> grid;
};

const Camera kFromX{"x", {2, 0, 0}, {0, 0, 0}, 0.7}, kBehind{"behind", {-2, 0, 0}, {0, 0, 0}, 0.7};

TEST(DepthGrid, SurfacesFreeSpaceAndWhatIsHidden) {
  const Seen one({kFromX});
  int hidden = 0, occupied = 0;
  one.each([&](const Vec3& p, double distance, int8_t state) {
    if (state == 1) {
      EXPECT_LT(std::abs(distance), 2 * kCell);
      ++occupied;
    }
    EXPECT_TRUE(state != 0 || distance > -0.5 * kCell);
    EXPECT_TRUE(distance >= -kCell || state != 0);
    hidden += state == -1;
    // behind the ball, in its shadow
    EXPECT_TRUE(!(p.x < -0.3 && std::abs(p.y) < 0.1 && std::abs(p.z) < 0.1) || state == -1);
  });
  EXPECT_GT(occupied, 50);
  const Seen two({kFromX, kBehind});
  int hidden_by_two = 0;
  two.each([&](const Vec3& p, double, int8_t state) {
    hidden_by_two += state == -1;
    EXPECT_TRUE(!(p.x < -0.3 && std::abs(p.y) < 0.1 && std::abs(p.z) < 0.1) || state == 0);
  });
  EXPECT_LT(hidden_by_two, hidden);
  EXPECT_GT(hidden_by_two, 100);  // the inside of the ball
}

TEST(DepthGrid, WithoutPicturesNothingIsSeen) {
  int8_t out[8];
  grid_from_depth(nullptr, 0, {0, 0, 0}, 2, 0.1, out);
  for (const int8_t v : out) EXPECT_EQ(v, -1);
  // nor where the camera does not look
  const std::vector<float> empty(100, 0.0f);
  const DepthPicture away{make_view({"away", {2, 0, 0}, {4, 0, 0}, 0.7}, 10, 10), empty.data()};
  grid_from_depth(&away, 1, {0, 0, 0}, 2, 0.1, out);
  for (const int8_t v : out) EXPECT_EQ(v, -1);
}

}  // namespace
}  // namespace rdm
