// A mesh cut into parts that are nearly convex, by the HACD library where the tool was built with it.
#pragma once
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace tool {

// The points of about `most` parts of its surface, some of which may be flat; their hulls together have every
// vertex. most 1: the mesh itself. Failure, which begins with `what`, where it cannot be cut, or a tool
// without the library.
std::vector<std::vector<Point>> parts_of(const Mesh& mesh, int32_t most, const std::string& what);

}  // namespace tool
