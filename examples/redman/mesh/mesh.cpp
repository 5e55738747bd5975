#include "mesh/mesh.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <utility>

#include "common/files.hpp"
#include "common/report.hpp"
#include "common/text.hpp"

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

constexpr const char* kSpace = " \t\v\f";

// Calls f(line, number) for each line: a byte order mark before the first is none of it, CR, LF or both end one, and
// a '\' before that end goes on in the next.
template <class F>
void each_line(const char* bytes, size_t size, F&& f) {
  std::string line;
  size_t number = 1, first = 1;
  for (size_t at = size >= 3 && std::memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0; at < size; ++number) {
    size_t end = at;
    while (end < size && bytes[end] != '\n' && bytes[end] != '\r') ++end;
    line.append(bytes + at, end - at);
    at = end + (end + 1 < size && bytes[end] == '\r' && bytes[end + 1] == '\n' ? 2 : 1);
    if (at < size && !line.empty() && line.back() == '\\') {
      line.back() = ' ';
      continue;
    }
    f(line.c_str(), first);
    line.clear();
    first = number + 1;
  }
}

// Behind the line's first word where that is `key`, in any case where `any_case`; null where it is another.
const char* behind_word(const char* line, const char* key, bool any_case) {
  line += std::strspn(line, kSpace);
  for (; *key; ++key, ++line)
    if (*line != *key && !(any_case && std::tolower(static_cast<unsigned char>(*line)) == *key))
      return nullptr;
  return *line && std::strchr(kSpace, *line) ? line : nullptr;
}

// "v x y z" of an .obj file, "vertex x y z" of an .stl file.
std::vector<Point> text_points(const char* bytes, size_t size, MeshKind kind) {
  std::vector<Point> out;
  each_line(bytes, size, [&](const char* line, size_t number) {
    const bool obj = kind == MeshKind::kObj;
    const char* c = behind_word(line, obj ? "v" : "vertex", !obj);
    if (!c) return;
    Point p;
    for (double& x : p) {
      char* after = nullptr;
      x = std::strtod(c, &after);
      if (after == c) throw Failure("line " + std::to_string(number) + ": a vertex needs three numbers");
      c = after;
    }
    add(out, p, "line ", number);
  });
  return out;
}

uint32_t facets_said(const char* bytes) {
  uint32_t facets = 0;
  std::memcpy(&facets, bytes + kStlHeader - sizeof facets, sizeof facets);
  return facets;
}

// Its header may begin with "solid" as a text does, and bytes may follow: but no text has a zero byte.
bool is_binary_stl(const char* bytes, size_t size) {
  return std::memchr(bytes, 0, std::min(size, kStlHeader)) != nullptr ||
         (size >= kStlHeader && size == kStlHeader + kStlFacet * static_cast<size_t>(facets_said(bytes)));
}

// Facets of a binary .stl file.
uint32_t facets_of(const char* bytes, size_t size) {
  if (size < kStlHeader) throw Failure(std::to_string(size) + " bytes are too few for a binary .stl file");
  const uint32_t facets = facets_said(bytes);
  if (facets == 0) throw Failure("its header says 0 facets");
  const size_t needed = kStlHeader + kStlFacet * static_cast<size_t>(facets);
  if (needed > size)
    throw Failure("it is truncated: its header says " + std::to_string(facets) + " facets, " +
                  std::to_string(needed) + " bytes; it has " + std::to_string(size));
  return facets;
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
  const bool binary = kind == MeshKind::kStl && is_binary_stl(bytes, size);
  std::vector<Point> out =
      binary ? binary_points(bytes, facets_of(bytes, size)) : text_points(bytes, size, kind);
  if (out.empty()) throw Failure("it has no vertices");
  return out;
}

size_t bytes_behind(const char* bytes, size_t size, MeshKind kind) {
  if (kind != MeshKind::kStl || !is_binary_stl(bytes, size)) return 0;
  return size - kStlHeader - kStlFacet * static_cast<size_t>(facets_of(bytes, size));
}

namespace {

// Faces of an .obj: each `f` line's corners, counted from 1, or from the end where they are negative.
void obj_faces(const char* bytes, size_t size, Mesh* out) {
  int64_t before = 0;  // vertices so far
  each_line(bytes, size, [&](const char* line, size_t number) {
    if (behind_word(line, "v", false)) ++before;
    const char* c = behind_word(line, "f", false);
    if (!c) return;
    std::vector<uint32_t> corners;
    for (c += std::strspn(c, kSpace); *c; c += std::strspn(c, kSpace)) {
      char* after = nullptr;
      int64_t i = std::strtoll(c, &after, 10);
      if (after == c) break;
      if (i < 0) i += before + 1;
      if (i < 1 || i > static_cast<int64_t>(out->points.size()))
        throw Failure("line " + std::to_string(number) + ": a face names a vertex that is not there");
      corners.push_back(static_cast<uint32_t>(i - 1));
      c = after + std::strcspn(after, kSpace);
    }
    if (corners.size() < 3) throw Failure("line " + std::to_string(number) + ": a face needs three vertices");
    for (size_t k = 2; k < corners.size(); ++k)
      out->faces.push_back({corners[0], corners[k - 1], corners[k]});
  });
}

MeshKind kind_of(const std::string& path) {
  const auto ends = [&](const char* with) {
    const size_t n = std::strlen(with);
    return path.size() >= n && path.compare(path.size() - n, n, with) == 0;
  };
  const bool obj = ends(".obj") || ends(".OBJ");
  if (!obj && !ends(".stl") && !ends(".STL")) throw Usage(path + ": it is neither .obj nor .stl");
  return obj ? MeshKind::kObj : MeshKind::kStl;
}

template <class F>
auto parsed(const std::string& path, F&& parse) {
  const MeshKind kind = kind_of(path);
  const std::string bytes = read_file(path);
  try {
    auto mesh = parse(bytes.data(), bytes.size(), kind);
    if (const size_t rest = bytes_behind(bytes.data(), bytes.size(), kind))
      std::fprintf(stderr, "%s: the %zu bytes after its last facet are ignored\n", printable(path).c_str(),
                   rest);
    return mesh;
  } catch (const Failure& e) {
    throw Failure(path + ": " + e.what());
  }
}

}  // namespace

Mesh parse_faces(const char* bytes, size_t size, MeshKind kind) {
  const std::vector<Point> corners = parse_mesh(bytes, size, kind);
  Mesh out;
  std::map<Point, uint32_t> known;
  std::vector<uint32_t> place;
  for (const Point& p : corners) {
    const auto [at, added] = known.emplace(p, static_cast<uint32_t>(out.points.size()));
    if (added) out.points.push_back(p);
    place.push_back(at->second);
  }
  if (kind == MeshKind::kObj) {
    Mesh numbered;
    numbered.points = corners;
    obj_faces(bytes, size, &numbered);
    out.faces = std::move(numbered.faces);
    for (auto& face : out.faces)
      for (uint32_t& i : face) i = place[i];
  } else {
    if (corners.size() % 3 != 0) throw Failure("it does not have three vertices for each facet");
    for (size_t i = 0; i < corners.size(); i += 3)
      out.faces.push_back({place[i], place[i + 1], place[i + 2]});
  }
  // facets without a surface
  const auto flat = [](const auto& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; };
  out.faces.erase(std::remove_if(out.faces.begin(), out.faces.end(), flat), out.faces.end());
  return out;
}

std::vector<Point> mesh_points(const std::string& path) {
  return parsed(path, parse_mesh);
}

Mesh mesh_of(const std::string& path) {
  return parsed(path, parse_faces);
}

// Tetrahedra from the origin to each face: V = a . (b x c) / 6, and over each (Tonon 2004)
//   int x dV = V/4 (a + b + c),   int x x' dV = V/20 (a a' + b b' + c c' + s s'),  s = a + b + c.
MeshMass mass_of(const Mesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> edges;  // once each way
  for (const auto& f : mesh.faces)
    for (size_t k = 0; k < 3; ++k)
      if (++edges[{f[k], f[(k + 1) % 3]}] > 1) return {};
  for (const auto& [edge, count] : edges)
    if (edges.find({edge.second, edge.first}) == edges.end()) return {};
  MeshMass out;
  Point first{};
  double second[6] = {};  // int x x', as moments are ordered
  constexpr size_t kRow[6] = {0, 1, 2, 0, 0, 1}, kColumn[6] = {0, 1, 2, 1, 2, 2};
  for (const auto& f : mesh.faces) {
    const Point &a = mesh.points[f[0]], &b = mesh.points[f[1]], &c = mesh.points[f[2]];
    const double v = (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                      a[2] * (b[0] * c[1] - b[1] * c[0])) /
                     6;
    out.volume += v;
    const Point s = {a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]};
    for (size_t k = 0; k < 3; ++k) first[k] += v / 4 * s[k];
    for (size_t k = 0; k < 6; ++k) {
      const size_t i = kRow[k], j = kColumn[k];
      second[k] += v / 20 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j]);
    }
  }
  if (!(std::abs(out.volume) > 0)) return {};
  for (size_t k = 0; k < 3; ++k) out.centre[k] = first[k] / out.volume;
  for (size_t k = 0; k < 6; ++k) second[k] -= out.volume * out.centre[kRow[k]] * out.centre[kColumn[k]];
  const double sign = out.volume < 0 ? -1 : 1;  // faces that look inwards
  out.volume *= sign;
  for (double& x : second) x *= sign;
  out.moment = {second[1] + second[2],
                second[0] + second[2],
                second[0] + second[1],
                -second[3],
                -second[4],
                -second[5]};
  return out;
}

}  // namespace tool
