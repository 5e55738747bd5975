// The points of a mesh file.
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace tool {

using Point = std::array<double, 3>;

enum class MeshKind { kObj, kStl };

inline constexpr size_t kMostMeshPoints = 4'000'000;

// Vertices of an .obj file (its `v` lines) or an .stl file (text or binary), in the file's unit: finite
// numbers, at most kMostMeshPoints. Failure when there are none, with the line that cannot be read.
std::vector<Point> parse_mesh(const char* bytes, size_t size, MeshKind kind);
// Of a file whose name ends in .obj or .stl; Usage when it does not.
std::vector<Point> mesh_points(const std::string& path);

}  // namespace tool
