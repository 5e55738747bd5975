// Mesh files of the tool (.obj, .stl as text and binary): what is read is finite and not more than the file
// can hold.
#include "../fuzz.hpp"
#include "common/report.hpp"
#include "mesh/mesh.hpp"

namespace hard {

std::vector<Bytes> seeds() {
  Bytes binary(84 + 2 * 50);
  const uint32_t count = 2;
  std::memcpy(binary.data() + 80, &count, sizeof count);
  for (size_t i = 0; i < 24; ++i) {
    const float v = static_cast<float>(i % 5);
    std::memcpy(binary.data() + 84 + (i / 12) * 50 + (i % 12) * 4, &v, sizeof v);
  }
  return {
      with_pick(0, bytes_of("# a cube's corner\nv 0 0 0\nv 1 0 0\nv 0 1e-1 0 1.0\nvn 0 0 1\nf 1 2 3\n")),
      with_pick(1, bytes_of("solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n"
                            "   vertex 0 1 0\n  endloop\n endfacet\nendsolid a\n")),
      with_pick(1, binary)};
}
void whole(unsigned char*, size_t) {}
size_t fixed_bytes() {
  return 1;
}

void one(const unsigned char* data, size_t size) {
  if (size == 0) return;
  const char* text = reinterpret_cast<const char*>(data + 1);
  try {
    const tool::MeshKind kind = pick(data, size, 2) == 0 ? tool::MeshKind::kObj : tool::MeshKind::kStl;
    const auto points = tool::parse_mesh(text, size - 1, kind);
    HARD_REQUIRE(!points.empty() && points.size() <= size, "%zu points of %zu bytes", points.size(), size);
    for (const tool::Point& p : points)
      HARD_REQUIRE(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]),
                   "a point is not finite");
    const tool::Mesh mesh = tool::parse_faces(text, size - 1, kind);
    for (const auto& face : mesh.faces)
      for (const uint32_t i : face) HARD_REQUIRE(i < mesh.points.size(), "a face without a point");
    HARD_REQUIRE(!(tool::mass_of(mesh).volume < 0), "a volume below 0");
  } catch (const tool::Failure& e) {
    HARD_REQUIRE(*e.what(), "no text");
  }
}

}  // namespace hard
