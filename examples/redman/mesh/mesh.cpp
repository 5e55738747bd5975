#include "mesh/mesh.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "common/files.hpp"
#include "common/report.hpp"

namespace tool {
namespace {

constexpr size_t kStlHeader = 84, kStlFacet = 50;  // bytes

// `part` and `number` say where it stands.
void add(std::vector<Point>& points, const Point& p, const char* part, size_t number) {
  for (const double x : p)
    if (!std::isfinite(x)) throw Failure(part + std::to_string(number) + ": a vertex is not finite");
  if (points.size() == kMostMeshPoints)
    throw Failure("more than " + std::to_string(kMostMeshPoints) + " vertices");
  points.push_back(p);
}

// The numbers behind each line's first word `key`.
std::vector<Point> text_points(const char* bytes, size_t size, const char* key) {
  constexpr const char* kSpace = " \t\r\v\f";
  std::vector<Point> out;
  std::string line;
  size_t number = 0;
  for (size_t at = 0; at < size;) {
    const void* found = std::memchr(bytes + at, '\n', size - at);
    const size_t end = found ? static_cast<size_t>(static_cast<const char*>(found) - bytes) : size;
    line.assign(bytes + at, end - at);
    at = end + 1;
    ++number;
    const char* c = line.c_str() + std::strspn(line.c_str(), kSpace);
    const size_t word = std::strcspn(c, kSpace);
    if (word != std::strlen(key) || std::strncmp(c, key, word) != 0) continue;
    c += word;
    Point p;
    for (double& x : p) {
      char* after = nullptr;
      x = std::strtod(c, &after);
      if (after == c) throw Failure("line " + std::to_string(number) + ": a vertex needs three numbers");
      c = after;
    }
    add(out, p, "line ", number);
  }
  return out;
}

// A header may begin with "solid" too: the length decides.
bool is_binary_stl(const char* bytes, size_t size, uint32_t* facets) {
  if (size < kStlHeader) return false;
  std::memcpy(facets, bytes + kStlHeader - sizeof *facets, sizeof *facets);
  return size == kStlHeader + kStlFacet * static_cast<size_t>(*facets);
}

std::vector<Point> binary_points(const char* bytes, uint32_t facets) {
  std::vector<Point> out;
  for (size_t f = 0; f < facets; ++f) {
    float numbers[12];  // normal, then three corners
    std::memcpy(numbers, bytes + kStlHeader + kStlFacet * f, sizeof numbers);
    for (int k = 3; k < 12; k += 3) add(out, {numbers[k], numbers[k + 1], numbers[k + 2]}, "facet ", f + 1);
  }
  return out;
}

}  // namespace

std::vector<Point> parse_mesh(const char* bytes, size_t size, MeshKind kind) {
  uint32_t facets = 0;
  std::vector<Point> out = kind == MeshKind::kObj                ? text_points(bytes, size, "v")
                           : is_binary_stl(bytes, size, &facets) ? binary_points(bytes, facets)
                                                                 : text_points(bytes, size, "vertex");
  if (out.empty()) throw Failure("no vertices in it");
  return out;
}

std::vector<Point> mesh_points(const std::string& path) {
  const auto ends = [&](const char* with) {
    const size_t n = std::strlen(with);
    return path.size() >= n && path.compare(path.size() - n, n, with) == 0;
  };
  const bool obj = ends(".obj") || ends(".OBJ");
  if (!obj && !ends(".stl") && !ends(".STL")) throw Usage(path + ": neither .obj nor .stl");
  const std::string bytes = read_file(path);
  try {
    return parse_mesh(bytes.data(), bytes.size(), obj ? MeshKind::kObj : MeshKind::kStl);
  } catch (const Failure& e) {
    throw Failure(path + ": " + e.what());
  }
}

}  // namespace tool
