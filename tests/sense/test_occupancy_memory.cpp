// Memory that is refused inside OctoMap: an error each time, nothing lost, and a map that goes on as if the
// call had not been, but for the voxels of the scan that had been taken before.
#include <sys/resource.h>

#include "occupancy_scenes.hpp"
#include "refuse_new.hpp"

namespace rdm {
namespace {

std::vector<unsigned char> file_of(const Occupancy& map) {
  Vector<unsigned char> out;
  map.write(MapFormat::kFull, out);
  return {out.begin(), out.end()};
}

// Calls f with operator new number 0, 1, 2 ... refused until it is no more; returns how many were.
template <class F>
int refuse_each(F&& f, int stride = 1) {
  for (int at = 0;; at += stride) {
    bool happened;
    Code code;
    {
      const RefuseNew refuse(at, at % 2 == 0);
      code = guard(f);
      happened = refuse.happened();
    }
    EXPECT_EQ(code, happened ? Code::kMemory : Code::kOk) << at;
    if (!happened) return at;
    if (code != Code::kMemory) return -1;
  }
}

TEST(OccupancyMemory, CreateAndReadLeaveNothing) {
  const Map source = make_map(0.2);
  scan_all(*source);
  const auto bytes = file_of(*source);
  const int64_t live = new_live;
  EXPECT_GT(refuse_each([] { make_map(); }), 0);
  EXPECT_EQ(new_live, live);
  {
    const Map map = make_map(0.2);
    const float point[] = {1, 1, 1};
    map->insert({0, 0, 0}, point, 1);
    const auto before = file_of(*map);
    const int64_t made = new_live;
    int calls = 0;
    EXPECT_GT(refuse_each(
                  [&] {
                    EXPECT_EQ(file_of(*map), before) << calls;
                    EXPECT_EQ(new_live, made) << calls++;
                    map->read(bytes.data(), bytes.size());
                  },
                  97),
              1000);
    EXPECT_EQ(file_of(*map), bytes);
  }
  EXPECT_EQ(new_live, live);
}

// A single point, so that every call that fails has changed nothing: new ways down the tree, then a joined
// voxel that is split.
TEST(OccupancyMemory, AVoxelThatFindsNoneChangesNothing) {
  const int64_t live = new_live;
  {
    const Map map = make_map(0.1);
    const auto check = [&](const Vec3& from, const Vec3& to, int least) {
      const float point[] = {static_cast<float>(to.x), static_cast<float>(to.y), static_cast<float>(to.z)};
      const auto before = file_of(*map);
      const OccupancyInfo info = map->info();
      const int64_t nodes = new_live;
      int at = 0;
      EXPECT_GE(refuse_each([&] {
                  ASSERT_EQ(file_of(*map), before) << at;
                  ASSERT_EQ(map->info().nodes, info.nodes) << at;
                  ASSERT_EQ(map->info().bytes, info.bytes) << at;
                  ASSERT_EQ(new_live, nodes) << at++;
                  map->insert(from, point, 1);
                }),
                least);
      EXPECT_NE(file_of(*map), before);
    };
    // a ray across one voxel, for nearer points than its side are left out
    const auto across = [](const Vec3& middle, double part) {
      return Vec3{middle.x + part, middle.y + part, middle.z + part};
    };
    const auto check_one = [&](const Vec3& v, int least) {
      check(across(v, -0.045), across(v, 0.045), least);
    };
    check_one({0.05, 0.05, 0.05}, 33);   // the root and 16 levels, each a node and a list
    check_one({0.15, 0.05, 0.05}, 1);    // a sister: one node
    check_one({-0.05, 0.05, 0.05}, 30);  // another branch
    // eight equal voxels join, and are split again when one of them changes
    for (int k = 0; k < 20; ++k)
      for (int v = 0; v < 8; ++v) {
        const float p[] = {1.65f + 0.1f * static_cast<float>(v & 1),
                           1.65f + 0.1f * static_cast<float>(v >> 1 & 1),
                           1.65f + 0.1f * static_cast<float>(v >> 2)};
        const Vec3 end = across({p[0], p[1], p[2]}, 0.045);
        const float last[] = {static_cast<float>(end.x), static_cast<float>(end.y),
                              static_cast<float>(end.z)};
        map->insert(across({p[0], p[1], p[2]}, -0.045), last, 1);
      }
    const float beyond[] = {1.895f, 1.695f, 1.695f};
    for (int k = 0; k < 20; ++k) map->insert(across({1.85, 1.65, 1.65}, -0.045), beyond, 1);
    check({1.74, 1.65, 1.65}, {1.85, 1.65, 1.65}, 9);
  }
  EXPECT_EQ(new_live, live);
}

TEST(OccupancyMemory, AScanIsMadeGoodByTheNext) {
  const int64_t live = new_live;
  {
    const Map map = make_map(0.2), whole = make_map(0.2);
    const Points points = scan_room(kEyes[0], 12, 24);
    EXPECT_GT(refuse_each([&] { map->insert(kEyes[0], points.data(), points.size() / 3); }, 61), 500);
    for (int k = 0; k < 40; ++k) {  // until every voxel is at its bound in both
      map->insert(kEyes[0], points.data(), points.size() / 3);
      whole->insert(kEyes[0], points.data(), points.size() / 3);
    }
    EXPECT_EQ(file_of(*map), file_of(*whole));
    EXPECT_EQ(map->info().bytes, whole->info().bytes);
  }
  EXPECT_EQ(new_live, live);
}

}  // namespace
}  // namespace rdm
