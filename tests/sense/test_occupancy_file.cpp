// Map files: through OctoMap's own reader and writer, through Debian's octomap-tools, and broken ones.
#include <octomap/OcTree.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "occupancy_scenes.hpp"

namespace rdm {
namespace {

using Bytes = Vector<unsigned char>;

Bytes bytes_of(const Occupancy& map, MapFormat format) {
  Bytes out;
  map.write(format, out);
  return out;
}

std::string text_of(const Bytes& b) {
  return {b.begin(), b.end()};
}

Bytes to_bytes(const std::string& s) {
  return {s.begin(), s.end()};
}

// States at the points of a lattice in the room, as one digit each.
std::string states(const Occupancy& map) {
  std::string out;
  for (double x = -2.1; x < 2.1; x += 0.11)
    for (double y = -2.1; y < 2.1; y += 0.11)
      for (double z = -2.1; z < 2.1; z += 0.11) {
        const float p = map.at({x, y, z});
        out += p < 0 ? '?' : occupied(p) ? '1' : '0';
      }
  return out;
}
std::string states(const octomap::OcTree& tree) {
  std::string out;
  for (double x = -2.1; x < 2.1; x += 0.11)
    for (double y = -2.1; y < 2.1; y += 0.11)
      for (double z = -2.1; z < 2.1; z += 0.11) {
        const octomap::OcTreeNode* node = tree.search(x, y, z);
        out += !node ? '?' : tree.isNodeOccupied(node) ? '1' : '0';
      }
  return out;
}

TEST(OccupancyFile, OctoMapReadsOurs) {
  const Map map = make_map();
  scan_all(*map);
  std::istringstream bt(text_of(bytes_of(*map, MapFormat::kBinary)));
  octomap::OcTree binary(0.1);
  ASSERT_TRUE(binary.readBinary(bt));
  EXPECT_EQ(binary.getResolution(), 0.05);
  EXPECT_EQ(binary.size(), map->info().nodes);
  EXPECT_EQ(states(binary), states(*map));

  std::istringstream ot(text_of(bytes_of(*map, MapFormat::kFull)));
  const std::unique_ptr<octomap::AbstractOcTree> any(octomap::AbstractOcTree::read(ot));
  const auto* full = dynamic_cast<octomap::OcTree*>(any.get());
  ASSERT_NE(full, nullptr);
  EXPECT_EQ(states(*full), states(*map));
  const octomap::OcTreeNode* node = full->search(1.97, 0.13, 0.27);
  ASSERT_NE(node, nullptr);
  EXPECT_NEAR(node->getOccupancy(), static_cast<double>(map->at({1.97, 0.13, 0.27})), 1e-6);
}

TEST(OccupancyFile, WeReadOctoMaps) {
  octomap::OcTree tree(0.05);
  for (const Vec3& eye : kEyes) {
    octomap::Pointcloud cloud;
    const Points points = scan_room(eye);
    for (size_t i = 0; i < points.size(); i += 3) cloud.push_back(points[i], points[i + 1], points[i + 2]);
    tree.insertPointCloud(cloud,
                          {static_cast<float>(eye.x), static_cast<float>(eye.y), static_cast<float>(eye.z)});
  }
  const std::string want = states(tree);
  const Map map = make_map(0.3);
  std::ostringstream ot, bt;
  ASSERT_TRUE(tree.write(ot));
  map->read(ot.str().data(), ot.str().size());
  EXPECT_EQ(states(*map), want);
  EXPECT_EQ(map->info().resolution, 0.05);
  EXPECT_EQ(map->info().nodes, tree.size());
  ASSERT_TRUE(tree.writeBinary(bt));  // joins voxels
  map->clear();
  map->read(bt.str().data(), bt.str().size());
  EXPECT_EQ(states(*map), want);
  EXPECT_EQ(map->info().nodes, tree.size());
}

TEST(OccupancyFile, OursComeBackAsTheyWere) {
  const Map map = make_map(), other = make_map(0.3);
  scan_all(*map);
  const Bytes full = bytes_of(*map, MapFormat::kFull);
  other->read(full.data(), full.size());
  EXPECT_EQ(bytes_of(*other, MapFormat::kFull), full);
  EXPECT_EQ(other->info().bytes, map->info().bytes);
  const Bytes binary = bytes_of(*map, MapFormat::kBinary);
  EXPECT_LT(binary.size(), full.size() / 3);
  other->read(binary.data(), binary.size());
  EXPECT_EQ(bytes_of(*other, MapFormat::kBinary), binary);
  EXPECT_EQ(states(*other), states(*map));
  // and the map can be worked on
  scan_all(*other);
  EXPECT_GT(other->info().nodes, 0u);
  const Map empty = make_map();
  for (const MapFormat format : {MapFormat::kBinary, MapFormat::kFull}) {
    const Bytes none = bytes_of(*empty, format);
    other->read(none.data(), none.size());
    EXPECT_EQ(other->info().nodes, 0u);
  }
}

TEST(OccupancyFile, TheToolsOfOctoMapTakeThem) {
  if (std::system("command -v bt2vrml > /dev/null && command -v convert_octree > /dev/null") != 0)
    GTEST_SKIP() << "octomap-tools are not installed";
  namespace fs = std::filesystem;
  const fs::path dir = fs::temp_directory_path() /
                       ("redman_map_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
                        std::to_string(reinterpret_cast<uintptr_t>(&dir)));
  fs::create_directories(dir);
  const auto run = [&](const std::string& command) {
    return std::system(("cd '" + dir.string() + "' && " + command + " > out 2>&1").c_str());
  };
  const auto save = [&](const Bytes& b, const char* name) {
    std::ofstream(dir / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(b.data()), static_cast<std::streamsize>(b.size()));
  };
  const auto load = [&](const char* name) {
    std::ifstream in(dir / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const Map map = make_map(), back = make_map();
  scan_all(*map);
  save(bytes_of(*map, MapFormat::kBinary), "a.bt");
  save(bytes_of(*map, MapFormat::kFull), "a.ot");
  EXPECT_EQ(run("bt2vrml a.bt"), 0) << load("out");
  EXPECT_GT(load("a.bt.wrl").size(), 10000u);
  EXPECT_EQ(run("convert_octree a.ot b.bt"), 0) << load("out");
  EXPECT_EQ(run("convert_octree a.bt b.ot"), 0) << load("out");
  for (const char* name : {"b.bt", "b.ot"}) {
    const std::string file = load(name);
    ASSERT_FALSE(file.empty()) << name;
    back->read(file.data(), file.size());
    EXPECT_EQ(states(*back), states(*map)) << name;
  }
  fs::remove_all(dir);
}

Code read_code(Occupancy& map, const Bytes& b) {
  return code_of([&] { map.read(b.data(), b.size()); });
}

TEST(OccupancyFile, BrokenFilesChangeNothing) {
  const Map map = make_map(), source = make_map(0.2);
  scan_all(*map);
  const Points points = scan_room(kEyes[0], 6, 12);
  source->insert(kEyes[0], points.data(), points.size() / 3);
  const Bytes before = bytes_of(*map, MapFormat::kFull);
  for (const MapFormat format : {MapFormat::kBinary, MapFormat::kFull}) {
    const Bytes good = bytes_of(*source, format);
    for (size_t cut = 0; cut < good.size(); cut += 1 + cut / 50)
      EXPECT_EQ(read_code(*map, Bytes(good.begin(), good.begin() + static_cast<ptrdiff_t>(cut))),
                Code::kFormat)
          << cut;
    Bytes longer = good;
    longer.push_back(0);
    EXPECT_EQ(read_code(*map, longer), Code::kFormat);
    EXPECT_EQ(bytes_of(*map, MapFormat::kFull), before);
    // any byte may be wrong: an answer, no crash, and no map beyond its bound
    const Map target = make_map(0.1, 1u << 20);
    for (size_t at = 0; at < good.size(); at += 1 + good.size() / 3000)
      for (const int flip : {1, 255}) {
        Bytes bad = good;
        bad[at] = static_cast<unsigned char>(bad[at] ^ flip);
        const Code code = read_code(*target, bad);
        EXPECT_TRUE(code == Code::kOk || code == Code::kFormat || code == Code::kMemory);
        const OccupancyInfo info = target->info();
        EXPECT_LE(info.bytes, info.bytes_max);
      }
  }
  for (const char* text :
       {"", "hello", "# Octomap OcTree file\n", "# Octomap OcTree file\nid OcTree\nsize 1\nres 0.1\n",
        "# Octomap OcTree file\nid ColorOcTree\nsize 1\nres 0.1\ndata\n0000",
        "# Octomap OcTree file\nid OcTree\nsize x\nres 0.1\ndata\n",
        "# Octomap OcTree file\nid OcTree\nsize 1\nres -1\ndata\n",
        "# Octomap OcTree file\nid OcTree\nsize 1\nres nan\ndata\n",
        "# Octomap OcTree file\nid OcTree\nsize 99999999999999999999\nres 0.1\ndata\n"})
    EXPECT_EQ(read_code(*map, to_bytes(text)), Code::kFormat) << text;
  EXPECT_EQ(bytes_of(*map, MapFormat::kFull), before);
}

TEST(OccupancyFile, DeepAndHugeTreesAreRefused) {
  const Map map = make_map(0.1, 1u << 20);
  // every node says that it has a first child: deeper than a map is
  std::string deep = "# Octomap OcTree file\nid OcTree\nsize 1000\nres 0.1\ndata\n";
  for (int i = 0; i < 1000; ++i) deep += std::string("\0\0\0\0\1", 5);
  EXPECT_EQ(read_code(*map, to_bytes(deep)), Code::kFormat);
  // every node has eight children, down to the last depth: 8^16 voxels, of which the file has the first
  std::string huge = "# Octomap OcTree binary file\nid OcTree\nsize 1000\nres 0.1\ndata\n";
  const std::function<void(int)> fill = [&](int depth) {
    if (huge.size() > 100000) return;
    huge += depth < 15 ? "\377\377" : "\252\252";
    for (int i = 0; depth < 15 && i < 8; ++i) fill(depth + 1);
  };
  fill(0);
  EXPECT_EQ(read_code(*map, to_bytes(huge)), Code::kMemory);
  EXPECT_EQ(map->info().nodes, 0u);
}

}  // namespace
}  // namespace rdm
