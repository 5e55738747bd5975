#include "mesh.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>

#include "files.hpp"
#include "report.hpp"

namespace tool {
namespace {

constexpr size_t kStlHeader = 84, kStlFacet = 50;  // bytes

// The numbers behind each line's first word `key`.
std::vector<Point> text_points(const std::string& bytes, const std::string& key) {
  std::vector<Point> out;
  std::istringstream in(bytes);
  for (std::string row; std::getline(in, row);) {
    std::istringstream words(row);
    std::string word;
    Point p;
    if (words >> word && word == key && words >> p[0] >> p[1] >> p[2]) out.push_back(p);
  }
  return out;
}

// A header may begin with "solid" too: the length decides.
bool is_binary_stl(const std::string& bytes, uint32_t* facets) {
  if (bytes.size() < kStlHeader) return false;
  std::memcpy(facets, bytes.data() + kStlHeader - sizeof *facets, sizeof *facets);
  return bytes.size() == kStlHeader + kStlFacet * static_cast<size_t>(*facets);
}

std::vector<Point> binary_points(const std::string& bytes, uint32_t facets) {
  std::vector<Point> out;
  for (size_t f = 0; f < facets; ++f) {
    float numbers[12];  // normal, then three corners
    std::memcpy(numbers, bytes.data() + kStlHeader + kStlFacet * f, sizeof numbers);
    for (int k = 3; k < 12; k += 3) out.push_back({numbers[k], numbers[k + 1], numbers[k + 2]});
  }
  return out;
}

}  // namespace

std::vector<Point> mesh_points(const std::string& path) {
  const std::string bytes = read_file(path);
  const auto ends = [&](const char* with) {
    const size_t n = std::strlen(with);
    return path.size() >= n && path.compare(path.size() - n, n, with) == 0;
  };
  uint32_t facets = 0;
  std::vector<Point> out;
  if (ends(".obj") || ends(".OBJ"))
    out = text_points(bytes, "v");
  else if (ends(".stl") || ends(".STL"))
    out = is_binary_stl(bytes, &facets) ? binary_points(bytes, facets) : text_points(bytes, "vertex");
  else
    throw Usage(path + ": neither .obj nor .stl");
  if (out.empty()) throw Failure(path + ": no vertices in it");
  for (const Point& p : out)
    for (const double x : p)
      if (!std::isfinite(x)) throw Failure(path + ": a vertex is not finite");
  return out;
}

}  // namespace tool
