#include "web/glb.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

#include "common/report.hpp"
#include "draw/solid.hpp"

namespace tool {
namespace {

// Numbers of the specification.
constexpr int kShort = 5122, kUnsignedShort = 5123, kFloat = 5126;
constexpr int kVertices = 34962, kIndices = 34963;

constexpr float kLeastGround = 0.5f;  // m, half the side of a plane's square

// A float as short as six decimals have it.
double rounded(double v) {
  return std::round(v * 1e6) / 1e6;
}
template <class Range>
Json rounded_list(const Range& values) {
  Json out = Json::array();
  for (const auto v : values) out.push_back(rounded(static_cast<double>(v)));
  return out;
}

float linear(uint8_t srgb) {
  const float v = static_cast<float>(srgb) / 255;
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

// Where everything that is no plane goes during the episode.
struct Extent {
  std::array<float, 3> low{}, high{};
};
Extent extent_of(const Playback& p) {
  Extent e;
  bool first = true;
  for (size_t b = 0; b < p.bodies.size(); ++b) {
    if (p.bodies[b].kind == RDM_SHAPE_PLANE) continue;
    for (size_t k = 0; k < p.frames; ++k)
      for (size_t i = 0; i < 3; ++i) {
        const float v = p.pose(k, b)[i];
        e.low[i] = first ? v : std::min(e.low[i], v);
        e.high[i] = first ? v : std::max(e.high[i], v);
        if (i == 2) first = false;
      }
  }
  return e;
}

// v turned back by the quaternion q (x, y, z, w).
std::array<float, 3> turned_back(const float* q, const std::array<float, 3>& v) {
  const float x = -q[0], y = -q[1], z = -q[2], w = q[3];
  const std::array<float, 3> t = {2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]),
                                  2 * (x * v[1] - y * v[0])};
  return {v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2],
          v[2] + w * t[2] + x * t[1] - y * t[0]};
}

// The part of a plane below what the episode shows, with room around it.
Solid make_ground(const Playback& p, size_t body) {
  const Extent e = extent_of(p);
  std::array<float, 3> middle;
  float size = kLeastGround;
  for (size_t i = 0; i < 3; ++i) {
    middle[i] = 0.5f * (e.low[i] + e.high[i]) - p.pose(0, body)[i];
    size = std::max(size, e.high[i] - e.low[i]);
  }
  const auto at = turned_back(p.pose(0, body) + 3, middle);
  return make_square(at[0], at[1], 1.5f * size);
}

Solid make_solid(const Playback& p, size_t body) {
  const Body& b = p.bodies[body];
  const float sphere[3] = {b.size[0], b.size[0], b.size[0]};
  switch (b.kind) {
    case RDM_SHAPE_SPHERE:
      return make_ellipsoid(sphere);
    case RDM_SHAPE_ELLIPSOID:
      return make_ellipsoid(b.size);
    case RDM_SHAPE_CAPSULE:
      return make_cylinder(b.size[0], b.size[1], true);
    case RDM_SHAPE_CYLINDER:
      return make_cylinder(b.size[0], b.size[1], false);
    case RDM_SHAPE_BOX:
      return make_box(b.size);
    case RDM_SHAPE_HULL:
      return make_hull(b.corners);
    default:
      return make_ground(p, body);
  }
}

// A camera's rotation: it looks along -z with y up.
std::array<double, 4> look_at(const rdm_camera_info& c) {
  using Vec = std::array<double, 3>;
  const auto cross = [](const Vec& a, const Vec& b) {
    return Vec{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto normalise = [](Vec& v) {
    const double length = std::hypot(v[0], v[1], v[2]);
    for (double& x : v) x /= length;
    return length > 1e-6;
  };
  Vec back, up;
  for (size_t i = 0; i < 3; ++i) {
    back[i] = static_cast<double>(c.eye[i]) - static_cast<double>(c.target[i]);
    up[i] = static_cast<double>(c.up[i]);
  }
  normalise(back);
  Vec right = cross(up, back);
  if (!normalise(right)) normalise(right = cross({-1, 0, 0}, back));
  up = cross(back, right);
  // columns right, up, back; the branch with the largest divisor
  const double m[3][3] = {{right[0], up[0], back[0]}, {right[1], up[1], back[1]}, {right[2], up[2], back[2]}};
  const double trace = m[0][0] + m[1][1] + m[2][2];
  std::array<double, 4> q{};
  if (trace > 0) {
    const double s = 2 * std::sqrt(1 + trace);
    return {(m[2][1] - m[1][2]) / s, (m[0][2] - m[2][0]) / s, (m[1][0] - m[0][1]) / s, s / 4};
  }
  size_t i = m[1][1] > m[0][0] ? 1 : 0;
  if (m[2][2] > m[i][i]) i = 2;
  const size_t j = (i + 1) % 3, k = (i + 2) % 3;
  const double s = 2 * std::sqrt(1 + m[i][i] - m[j][j] - m[k][k]);
  q[i] = s / 4;
  q[j] = (m[j][i] + m[i][j]) / s;
  q[k] = (m[k][i] + m[i][k]) / s;
  q[3] = (m[k][j] - m[j][k]) / s;
  return q;
}

// The file as it grows: JSON lists and the binary chunk that their accessors read.
class Glb {
 public:
  explicit Glb(const Playback& p) : p_(p) {
    for (const char* list : {"nodes", "cameras", "materials", "meshes", "accessors", "bufferViews"})
      json_[list] = Json::array();
  }

  std::string bytes() {
    begin();
    json_["nodes"].push_back({{"name", "redman"}, {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}});
    for (size_t b = 0; b < p_.bodies.size(); ++b) add_body(b);
    for (const rdm_camera_info& c : p_.cameras) add_camera(c);
    finish();
    std::string text = json_text(json_);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string out = "glTF";
    const auto word = [&](size_t v) {
      for (int i = 0; i < 4; ++i) out += static_cast<char>(v >> 8 * i);
    };
    word(2);
    word(12 + 8 + text.size() + (binary_.empty() ? 0 : 8 + binary_.size()));
    word(text.size());
    out += "JSON" + text;
    if (binary_.empty()) return out;
    word(binary_.size());
    return out + std::string("BIN\0", 4) + binary_;
  }

 private:
  // Values with their type; returns the accessor's number. `bounds` writes each component's least and
  // greatest.
  template <class T>
  size_t accessor(const std::vector<T>& values, int component, const char* type, size_t width, int target,
                  bool bounds) {
    Json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (target) view["target"] = target;
    binary_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    binary_.resize((binary_.size() + 3) / 4 * 4, '\0');
    Json a = {{"bufferView", json_["bufferViews"].size()},
              {"componentType", component},
              {"count", values.size() / width},
              {"type", type}};
    if (component == kShort) a["normalized"] = true;
    for (size_t c = 0; bounds && c < width; ++c) {
      T low = values[c], high = values[c];
      for (size_t i = c; i < values.size(); i += width) {
        low = std::min(low, values[i]);
        high = std::max(high, values[i]);
      }
      a["min"].push_back(low);
      a["max"].push_back(high);
    }
    json_["bufferViews"].push_back(view);
    json_["accessors"].push_back(a);
    return json_["accessors"].size() - 1;
  }

  // Shapes of one kind, size and colour share a mesh.
  size_t mesh(size_t body) {
    const Body& b = p_.bodies[body];
    const auto key = std::tuple(b.kind, std::to_array(b.size), std::to_array(b.color), b.corners,
                                b.kind == RDM_SHAPE_PLANE ? body : 0);
    const auto [found, fresh] = meshes_.try_emplace(key, json_["meshes"].size());
    if (!fresh) return found->second;
    const Solid s = make_solid(p_, body);
    const Json attributes = {{"POSITION", accessor(s.points, kFloat, "VEC3", 3, kVertices, true)},
                             {"NORMAL", accessor(s.normals, kFloat, "VEC3", 3, kVertices, false)}};
    const size_t indices = accessor(s.triangles, kUnsignedShort, "SCALAR", 1, kIndices, false);
    const Json primitive = {
        {"attributes", attributes}, {"indices", indices}, {"material", material(b.color)}};
    json_["meshes"].push_back({{"primitives", Json::array({primitive})}});
    return found->second;
  }

  size_t material(const uint8_t color[3]) {
    const auto [found, fresh] =
        materials_.try_emplace({color[0], color[1], color[2]}, json_["materials"].size());
    const std::array<float, 4> rgba = {linear(color[0]), linear(color[1]), linear(color[2]), 1};
    const Json surface = {
        {"baseColorFactor", rounded_list(rgba)}, {"metallicFactor", 0}, {"roughnessFactor", 0.6}};
    if (fresh) json_["materials"].push_back({{"pbrMetallicRoughness", surface}});
    return found->second;
  }

  void add_child(const Json& node) {
    json_["nodes"][0]["children"].push_back(json_["nodes"].size());
    json_["nodes"].push_back(node);
  }

  void add_body(size_t body) {
    const float* pose = p_.pose(0, body);
    const size_t number = mesh(body);
    if (p_.moves(body)) animate(body, json_["nodes"].size());
    Json node = {{"name", p_.bodies[body].name},
                 {"mesh", number},
                 {"translation", rounded_list(std::vector<float>(pose, pose + 3))},
                 {"rotation", rounded_list(std::vector<float>(pose + 3, pose + 7))}};
    if (p_.bodies[body].kind == RDM_SHAPE_PLANE) node["extras"] = {{"plane", true}};
    add_child(node);
  }

  void animate(size_t body, size_t node) {
    std::vector<float> way;
    std::vector<int16_t> turns;
    float last[4] = {};
    for (size_t k = 0; k < p_.frames; ++k) {
      const float *pose = p_.pose(k, body), *q = pose + 3;
      way.insert(way.end(), pose, pose + 3);
      // q and -q are one rotation: the nearer of them is on the short way
      const float sign = q[0] * last[0] + q[1] * last[1] + q[2] * last[2] + q[3] * last[3] < 0 ? -1.f : 1.f;
      for (size_t i = 0; i < 4; ++i) {
        last[i] = sign * q[i];
        turns.push_back(static_cast<int16_t>(std::lround(std::clamp(last[i], -1.f, 1.f) * 32767)));
      }
    }
    if (times_ == 0) {
      std::vector<float> t(p_.frames);
      for (size_t k = 0; k < t.size(); ++k) t[k] = static_cast<float>(static_cast<double>(k) * p_.control_dt);
      times_ = 1 + accessor(t, kFloat, "SCALAR", 1, 0, true);
    }
    channel(node, "translation", accessor(way, kFloat, "VEC3", 3, 0, false));
    channel(node, "rotation", accessor(turns, kShort, "VEC4", 4, 0, false));
  }

  void channel(size_t node, const char* path, size_t output) {
    channels_.push_back({{"sampler", samplers_.size()}, {"target", {{"node", node}, {"path", path}}}});
    samplers_.push_back({{"input", times_ - 1}, {"interpolation", "LINEAR"}, {"output", output}});
  }

  void add_camera(const rdm_camera_info& c) {
    add_child({{"name", std::string("camera ") + c.name},
               {"camera", json_["cameras"].size()},
               {"translation", rounded_list(std::vector<float>(c.eye, c.eye + 3))},
               {"rotation", rounded_list(look_at(c))}});
    json_["cameras"].push_back(
        {{"name", c.name},
         {"type", "perspective"},
         {"perspective", {{"yfov", rounded(static_cast<double>(c.fov_y))}, {"znear", 0.01}}}});
  }

  void finish() {
    const Json animation = {{"name", p_.task}, {"channels", channels_}, {"samplers", samplers_}};
    const Json buffer = {{"byteLength", binary_.size()}};
    if (!channels_.empty()) json_["animations"] = Json::array({animation});
    if (!binary_.empty()) json_["buffers"] = Json::array({buffer});
    for (const char* list : {"cameras", "materials", "meshes", "accessors", "bufferViews"})
      if (json_[list].empty()) json_.erase(list);  // glTF has no empty lists
  }

  void begin() {
    auto build = redman::sized<rdm_build>();
    redman::check(rdm_build_info(&build));
    json_["asset"] = {{"version", "2.0"}, {"generator", std::string("redman ") + build.version}};
    json_["scene"] = 0;
    const Json scene = {{"name", p_.task}, {"nodes", Json::array({0})}};
    json_["scenes"] = Json::array({scene});
  }

  const Playback& p_;
  Json json_, channels_ = Json::array(), samplers_ = Json::array();
  std::string binary_;
  std::map<std::tuple<int32_t, std::array<float, 3>, std::array<uint8_t, 3>, std::vector<float>, size_t>,
           size_t>
      meshes_;
  std::map<std::array<uint8_t, 3>, size_t> materials_;
  size_t times_ = 0;  // accessor of the frames' times and one more
};

}  // namespace

std::string glb_bytes(const Playback& playback) {
  return Glb(playback).bytes();
}

}  // namespace tool
