// The points of a mesh file, its faces, and what a solid of its form weighs.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tool {

using Point = std::array<double, 3>;

enum class MeshKind { kObj, kStl };

inline constexpr size_t kMostMeshPoints = 4'000'000;

// Vertices of an .obj file (its `v` lines) or an .stl file (text or binary), in the file's unit: finite
// numbers, at most kMostMeshPoints. Failure when there are none, with the line that cannot be read.
std::vector<Point> parse_mesh(const char* bytes, size_t size, MeshKind kind);
// What stands behind the last facet of a binary .stl file, which parse_mesh leaves out.
size_t bytes_behind(const char* bytes, size_t size, MeshKind kind);
// Of a file whose name ends in .obj or .stl; Usage when it does not.
std::vector<Point> mesh_points(const std::string& path);

struct Mesh {
  std::vector<Point> points;  // each once
  std::vector<std::array<uint32_t, 3>> faces;
};
// The same with its faces; what has more than three corners is cut into triangles from its first.
Mesh parse_faces(const char* bytes, size_t size, MeshKind kind);
Mesh mesh_of(const std::string& path);

// Of density 1, in the unit of the file: volume, centre, moments xx yy zz xy xz yz about the centre. The
// volume is 0 for a mesh that is not closed: an edge that is not in two faces, once each way.
struct MeshMass {
  double volume = 0;
  Point centre{};
  std::array<double, 6> moment{};
};
MeshMass mass_of(const Mesh& mesh);

}  // namespace tool
