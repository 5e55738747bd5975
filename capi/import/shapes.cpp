#include "shapes.hpp"

#include <cstring>
#include <limits>

#include "base/chars.hpp"

namespace rdm::import {
namespace {

constexpr size_t kMostPoints = 2000000, kMostMeshBytes = size_t{1} << 26;  // of one mesh
constexpr size_t kStlHeader = 84, kStlFacet = 50;                          // bytes

V3 support(int32_t kind, V3 s, V3 d) {
  const double n = norm(d);
  if (n == 0) return {};
  const auto sign = [](double x) { return x < 0 ? -1.0 : 1.0; };
  const V3 u = (1 / n) * d;
  if (kind == RDM_SHAPE_SPHERE) return s.x * u;
  if (kind == RDM_SHAPE_CAPSULE) return s.x * u + V3{0, 0, sign(d.z) * s.y};
  if (kind == RDM_SHAPE_BOX) return {sign(d.x) * s.x, sign(d.y) * s.y, sign(d.z) * s.z};
  if (kind == RDM_SHAPE_CYLINDER) {
    const double r = std::sqrt(d.x * d.x + d.y * d.y);
    return {r > 0 ? s.x * d.x / r : 0, r > 0 ? s.x * d.y / r : 0, sign(d.z) * s.y};
  }
  const V3 e{s.x * d.x, s.y * d.y, s.z * d.z};  // ellipsoid
  const double m = norm(e);
  return m > 0 ? V3{s.x * e.x / m, s.y * e.y / m, s.z * e.z / m} : V3{};
}

// The simplex about the origin, newest first: true when it holds it; else the way to go on.
bool next_simplex(std::vector<V3>& s, V3& way) {
  const auto toward = [](V3 a, V3 b) { return dot(a, b) > 0; };
  const V3 a = s[0], ao = -1 * a;
  if (s.size() == 2) {
    const V3 ab = s[1] - a;
    if (toward(ab, ao)) {
      way = cross(cross(ab, ao), ab);
    } else {
      s = {a};
      way = ao;
    }
    return false;
  }
  if (s.size() == 3) {
    const V3 b = s[1], c = s[2], ab = b - a, ac = c - a, n = cross(ab, ac);
    if (toward(cross(n, ac), ao)) {
      if (toward(ac, ao)) {
        s = {a, c};
        way = cross(cross(ac, ao), ac);
        return false;
      }
      s = {a, b};
      return next_simplex(s, way);
    }
    if (toward(cross(ab, n), ao)) {
      s = {a, b};
      return next_simplex(s, way);
    }
    if (toward(n, ao)) {
      way = n;
    } else {
      s = {a, c, b};
      way = -1 * n;
    }
    return false;
  }
  const V3 b = s[1], c = s[2], d = s[3];
  const auto face = [&](V3 x, V3 y) {
    s = {a, x, y};
    return next_simplex(s, way);
  };
  if (toward(cross(b - a, c - a), ao)) return face(b, c);
  if (toward(cross(c - a, d - a), ao)) return face(c, d);
  if (toward(cross(d - a, b - a), ao)) return face(d, b);
  return true;
}

// Half sizes and middle of the box around the points, along the columns of `axes`.
Primitive box_along(const std::vector<V3>& points, const M3& axes) {
  V3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  const Turn q = turn_of(axes);
  for (const V3& p : points) {
    const V3 r = back(q) * p;
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], r[k]), high[k] = std::max(high[k], r[k]);
  }
  Primitive out{RDM_SHAPE_BOX, 0.5 * (high - low), {q * (0.5 * (low + high)), q}};
  for (int k = 0; k < 3; ++k) out.size[k] = std::max(out.size[k], 1e-4);
  return out;
}

double lines_number(const char*& c, const char* end, size_t line) {
  while (c != end && (*c == ' ' || *c == '\t')) ++c;
  if (c != end && *c == '+') ++c;
  double x = 0;
  const auto [after, error] = from_chars(c, end, x);
  if (error != std::errc() || !(std::abs(x) <= 1e6))
    refuse(RDM_ERROR_FORMAT, "line %zu: a corner needs three numbers", line);
  c = after;
  return x;
}

// The end of the line at `at`: LF, CR or both; where a '\' stands before it the line goes on.
size_t line_end(std::string& bytes, size_t at) {
  for (;;) {
    const size_t stop = std::min(bytes.find_first_of("\r\n", at), bytes.size());
    if (stop == at || stop == bytes.size() || bytes[stop - 1] != '\\') return stop;
    const bool both = bytes[stop] == '\r' && stop + 1 < bytes.size() && bytes[stop + 1] == '\n';
    bytes[stop - 1] = bytes[stop] = ' ';
    if (both) bytes[stop + 1] = ' ';
    at = stop + 1;
  }
}

// Text, a line each: "v x y z" and "f i j k ..." of .obj, "vertex x y z" of .stl in any case.
class LineReader {
 public:
  LineReader(std::string bytes, bool obj) : bytes_(std::move(bytes)), obj_(obj) {
    size_t at = bytes_.compare(0, 3, "\xef\xbb\xbf") == 0 ? 3 : 0;
    while (at < bytes_.size()) {
      const size_t stop = line_end(bytes_, at);
      ++line_;
      read(bytes_.data() + at, bytes_.data() + stop);
      at = stop + (bytes_.compare(stop, 2, "\r\n") == 0 ? 2 : 1);
    }
    if (!obj && mesh.points.size() % 3 != 0)
      refuse(RDM_ERROR_FORMAT, "it ends within a facet: %zu corners are not a multiple of three",
             mesh.points.size());
  }
  Mesh mesh;

 private:
  static void skip(const char*& c, const char* end) {
    while (c != end && (*c == ' ' || *c == '\t')) ++c;
  }
  static bool is(const char* c, const char* end, const char* word) {
    for (; *word; ++word, ++c)
      if (c == end || std::tolower(static_cast<unsigned char>(*c)) != *word) return false;
    return c != end && (*c == ' ' || *c == '\t');
  }
  void read(const char* c, const char* end) {
    skip(c, end);
    if (is(c, end, obj_ ? "v" : "vertex"))
      corner(c + (obj_ ? 1 : 6), end);
    else if (obj_ && is(c, end, "f"))
      face(c + 1, end);
  }
  void corner(const char* c, const char* end) {
    V3 p;
    for (int k = 0; k < 3; ++k) p[k] = lines_number(c, end, line_);
    if (mesh.points.size() == kMostPoints)
      refuse(RDM_ERROR_RANGE, "it has more than %zu corners", kMostPoints);
    mesh.points.push_back(p);
    const auto n = static_cast<uint32_t>(mesh.points.size());
    if (!obj_ && n % 3 == 0) mesh.faces.push_back({n - 3, n - 2, n - 1});
  }
  void face(const char* c, const char* end) {
    uint32_t first = 0, before = 0, count = 0;
    for (;; ++count) {
      skip(c, end);
      long long i = 0;
      const auto [after, error] = from_chars(c, end, i);
      if (error != std::errc()) break;
      const auto points = static_cast<long long>(mesh.points.size());
      i = i < 0 ? points + i : i - 1;
      if (i < 0 || i >= points)
        refuse(RDM_ERROR_FORMAT, "line %zu: a face names a corner that does not exist", line_);
      const auto corner = static_cast<uint32_t>(i);
      if (count == 0) first = corner;
      if (count >= 2) {
        if (mesh.faces.size() == kMostPoints)
          refuse(RDM_ERROR_RANGE, "it has more than %zu faces", kMostPoints);
        mesh.faces.push_back({first, before, corner});
      }
      before = corner;
      c = after;
      while (c != end && *c != ' ' && *c != '\t') ++c;
    }
  }

  std::string bytes_;
  bool obj_;
  size_t line_ = 0;
};

}  // namespace

V3 farthest(const Primitive& s, V3 way) {
  return s.X * support(s.kind, s.size, back(s.X.q) * way);
}

namespace {

// Of the ball about X.p that holds it.
double reach(const Primitive& s) {
  switch (s.kind) {
    case RDM_SHAPE_SPHERE:
      return s.size.x;
    case RDM_SHAPE_CAPSULE:
      return s.size.x + s.size.y;
    case RDM_SHAPE_CYLINDER:
      return std::hypot(s.size.x, s.size.y);
    case RDM_SHAPE_BOX:
      return norm(s.size);
    default:
      return std::max({s.size.x, s.size.y, s.size.z});
  }
}

}  // namespace

bool touch(const Primitive& a, const Primitive& b) {
  const auto corner = [&](V3 way) { return farthest(a, way) - farthest(b, -1 * way); };
  V3 way = b.X.p - a.X.p;
  if (norm(way) < 1e-12) return true;
  if (norm(way) > 1.0000001 * (reach(a) + reach(b))) return false;
  std::vector<V3> s;
  s.reserve(4);
  s.push_back(corner(way));
  way = -1 * s[0];
  for (int k = 0; k < 64; ++k) {
    if (norm(way) < 1e-15) return true;
    const V3 p = corner(way);
    if (dot(p, way) <= 0) return false;
    s.insert(s.begin(), p);
    if (next_simplex(s, way)) return true;
  }
  return true;  // they graze
}

double volume_of(const Primitive& s) {
  const V3& r = s.size;
  switch (s.kind) {
    case RDM_SHAPE_SPHERE:
      return 4.0 / 3 * M_PI * r.x * r.x * r.x;
    case RDM_SHAPE_CAPSULE:
      return M_PI * r.x * r.x * (2 * r.y + 4.0 / 3 * r.x);
    case RDM_SHAPE_CYLINDER:
      return M_PI * r.x * r.x * 2 * r.y;
    case RDM_SHAPE_BOX:
      return 8 * r.x * r.y * r.z;
    default:
      return 4.0 / 3 * M_PI * r.x * r.y * r.z;
  }
}

Mass solid(const Primitive& s) {
  Mass out;
  const V3& r = s.size;
  out.mass = volume_of(s);
  V3 m;  // moments per mass
  if (s.kind == RDM_SHAPE_BOX) {
    m = 1.0 / 3 * V3{r.y * r.y + r.z * r.z, r.x * r.x + r.z * r.z, r.x * r.x + r.y * r.y};
  } else if (s.kind == RDM_SHAPE_CYLINDER) {
    const double across = r.x * r.x / 4 + r.y * r.y / 3;
    m = {across, across, r.x * r.x / 2};
  } else if (s.kind == RDM_SHAPE_CAPSULE) {
    const double ball = 4.0 / 3 * r.x / (2 * r.y + 4.0 / 3 * r.x), rod = 1 - ball;
    const double across =
        rod * (r.x * r.x / 4 + r.y * r.y / 3) + ball * (0.4 * r.x * r.x + r.y * r.y + 0.75 * r.x * r.y);
    m = {across, across, rod * r.x * r.x / 2 + ball * 0.4 * r.x * r.x};
  } else {
    const V3 e = s.kind == RDM_SHAPE_SPHERE ? V3{r.x, r.x, r.x} : r;
    m = 0.2 * V3{e.y * e.y + e.z * e.z, e.x * e.x + e.z * e.z, e.x * e.x + e.y * e.y};
  }
  for (size_t k = 0; k < 3; ++k) out.moment[k][k] = out.mass * m[static_cast<int>(k)];
  return s.X * out;
}

namespace {

// The words of an .stl that is text, whose length is no binary one's.
bool is_text(const std::string& bytes) {
  std::string begin = bytes.substr(0, 4096);
  for (char& c : begin) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return bytes.size() < kStlHeader || begin.find("vertex") != std::string::npos ||
         begin.find("endsolid") != std::string::npos;
}

}  // namespace

Mesh parse_mesh(std::string bytes, bool obj) {
  Mesh out;
  uint32_t facets = 0;
  if (bytes.size() >= kStlHeader)
    std::memcpy(&facets, bytes.data() + kStlHeader - sizeof facets, sizeof facets);
  const size_t expected = kStlHeader + kStlFacet * static_cast<size_t>(facets);
  if (obj || (bytes.size() != expected && is_text(bytes))) {
    out = LineReader(std::move(bytes), obj).mesh;
  } else {
    if (bytes.size() != expected)
      refuse(RDM_ERROR_FORMAT, "its header says %u facets, which are %zu bytes, but it has %zu bytes", facets,
             expected, bytes.size());
    if (facets == 0) refuse(RDM_ERROR_FORMAT, "its header says 0 facets");
    if (3 * static_cast<size_t>(facets) > kMostPoints)
      refuse(RDM_ERROR_RANGE, "it has more than %zu corners", kMostPoints);
    for (uint32_t f = 0; f < facets; ++f) {
      float n[12];  // normal, then three corners
      std::memcpy(n, bytes.data() + kStlHeader + kStlFacet * static_cast<size_t>(f), sizeof n);
      for (int k = 3; k < 12; ++k)
        if (!(std::abs(n[k]) <= 1e6f))
          refuse(RDM_ERROR_FORMAT, "facet %u: a corner is not finite, or beyond 1e6", f + 1);
      for (int k = 3; k < 12; k += 3) out.points.push_back({n[k], n[k + 1], n[k + 2]});
      out.faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    }
  }
  if (out.points.empty()) refuse(RDM_ERROR_FORMAT, "it has no corners");
  return out;
}

Mesh read_mesh(const std::string& path, Budget* budget) {
  std::string ending = path.substr(std::min(path.rfind('.'), path.size()));
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (ending != ".stl" && ending != ".obj")
    refuse(RDM_ERROR_UNSUPPORTED, "%s: only .stl and .obj files are read", clean(path, 160).c_str());
  budget->spend(Cost::kFiles, 1);
  std::string bytes = read_file(path, std::min(kMostMeshBytes, budget->left(Cost::kMeshBytes)));
  budget->spend(Cost::kMeshBytes, bytes.size());
  try {
    return parse_mesh(std::move(bytes), ending == ".obj");
  } catch (const Refusal& r) {
    refuse(r.code, "%s: %s", clean(path, 160).c_str(), r.text.c_str());
  }
}

Primitive around(const std::vector<V3>& points) {
  V3 mean;
  for (const V3& p : points) mean = mean + p;
  mean = (1 / static_cast<double>(points.size())) * mean;
  M3 spread{}, axes{};
  for (const V3& p : points) {
    const V3 r = p - mean;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) spread[static_cast<size_t>(i)][static_cast<size_t>(j)] += r[i] * r[j];
  }
  principal(spread, &axes);
  const Primitive straight = box_along(points, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}),
                  along = box_along(points, axes);
  // A turned box has to be clearly the smaller one: most parts are drawn along their axes.
  Primitive best = volume_of(along) < 0.95 * volume_of(straight) ? along : straight;
  const Primitive box = best;
  const auto take = [&](const Primitive& other) {
    if (volume_of(other) < volume_of(best)) best = other;
  };
  Primitive ball{RDM_SHAPE_SPHERE, {}, {box.X.p, {}}};
  for (const V3& p : points) ball.size.x = std::max(ball.size.x, norm(p - box.X.p));
  take(ball);
  for (int axis = 0; axis < 3; ++axis) {
    V3 along_axis;
    along_axis[axis] = 1;
    Primitive capsule{RDM_SHAPE_CAPSULE, {}, {box.X.p, box.X.q * turn_between({0, 0, 1}, along_axis)}};
    const V3 way = capsule.X.q * V3{0, 0, 1};
    for (const V3& p : points) {
      const V3 r = p - box.X.p;
      capsule.size.x = std::max(capsule.size.x, norm(r - dot(r, way) * way));
    }
    const double radius = std::max(capsule.size.x, 1e-4);
    for (const V3& p : points) {
      const V3 r = p - box.X.p;
      const double t = dot(r, way), d = norm(r - t * way);
      capsule.size.y =
          std::max(capsule.size.y, std::abs(t) - std::sqrt(std::max(radius * radius - d * d, 0.0)));
    }
    capsule.size = {radius, std::max(capsule.size.y, 1e-4), 0};
    take(capsule);
  }
  best.size.x = std::max(best.size.x, 1e-4);
  return best;
}

}  // namespace rdm::import
