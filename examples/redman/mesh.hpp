// The points of a mesh file.
#pragma once
#include <array>
#include <string>
#include <vector>

namespace tool {

using Point = std::array<double, 3>;

// Vertices of an .obj file (its `v` lines) or an .stl file (text or binary), in the file's unit. Failure when
// the file cannot be read or holds none.
std::vector<Point> mesh_points(const std::string& path);

}  // namespace tool
