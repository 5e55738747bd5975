// Shapes of bodies, and the masses of bodies that say none.
#include <algorithm>
#include <cmath>

#include "mjcf.hpp"

namespace rdm::import {
namespace {

constexpr double kLeastVolume = 1e-15;  // m^3: below it a mesh encloses nothing

Mass with_mass(double mass, Mass m) {
  const double factor = mass / m.mass;
  m.mass = mass;
  for (auto& row : m.moment)
    for (double& x : row) x *= factor;
  return m;
}

const char* called(int32_t kind) {
  return kind == RDM_SHAPE_BOX ? "a box" : kind == RDM_SHAPE_CAPSULE ? "a capsule" : "a sphere";
}

}  // namespace

void MjcfReader::add_geom(const Element& e, const Pose& frame, const std::string& c, BodyIn* body,
                          Mass* from_geoms) {
  check_attributes(e, "geom");
  const std::string *type = value(e, "type", c), *mesh_name = value(e, "mesh", c);
  const std::string kind = type ? *type : "sphere";
  const double contype = number_of(e, "contype", c, 1), conaffinity = number_of(e, "conaffinity", c, 1);
  const bool visual = contype == 0 && conaffinity == 0;
  const auto name = [&] {
    const Attribute* n = e.find("name");
    return n ? ' ' + clean(n->value) : std::string();
  };
  // Without an own mass of the body: its geoms of these groups, by their mass or density.
  const std::string* mass = value(e, "mass", c);
  const double group = number_of(e, "group", c, 0), density = number_of(e, "density", c, 1000);
  const double given = mass ? number(e, "mass", *mass) : -1;
  const bool counts = from_geoms && group >= compiler.first_group && group <= compiler.last_group &&
                      (mass ? given != 0 : density != 0);
  if (mass ? given < 0 : density < 0) refuse_at(RDM_ERROR_RANGE, e, "its mass or density is below 0");
  if (visual) {
    for (const Attribute& a : e.attributes) a.read = true;
    out->note(RDM_NOTE_DROPPED, e.line, "geom%s: only visual (contype and conaffinity are 0)%s%s",
              name().c_str(), mesh_name ? (" mesh " + clean(*mesh_name)).c_str() : "", in_file(e).c_str());
    if (!counts) return;
  }
  if (kind == "plane" || kind == "hfield" || kind == "sdf") {
    if (kind != "plane" && counts)
      refuse_at(RDM_ERROR_UNSUPPORTED, e,
                "the mass of body %s would come from a geom of type %s; give the body an inertial",
                clean(body->name).c_str(), kind.c_str());
    out->note(RDM_NOTE_DROPPED, e.line, "geom%s: type %s%s", name().c_str(), clean(kind).c_str(),
              in_file(e).c_str());
    return;
  }
  const std::string* hollow = value(e, "shellinertia", c);
  const bool is_shell = hollow && flag(e, "shellinertia", *hollow);
  Primitive p;
  p.X = frame * pose_at(e, c);
  Mass one;  // at density 1
  if (kind == "mesh" || mesh_name) {
    if (!mesh_name) refuse_at(RDM_ERROR_FORMAT, e, "its type is mesh, but it has no attribute mesh");
    const MeshIn* mesh = mesh_in(e, *mesh_name);
    if (!mesh) {  // a note says why
      if (counts || kind != "mesh")
        refuse_at(RDM_ERROR_NOT_FOUND, e, "the %s of body %s would come from mesh %s, which cannot be read",
                  counts ? "mass" : "shape", clean(body->name).c_str(), clean(*mesh_name).c_str());
      return;
    }
    const Mass& mass_of_mesh = is_shell && kind == "mesh" ? mesh->surface : mesh->mass;
    if ((counts || kind != "mesh") && !(mass_of_mesh.mass > kLeastVolume))
      refuse_at(RDM_ERROR_RANGE, e, "mesh %s does not enclose a volume, so it gives no mass or size",
                clean(*mesh_name).c_str());
    if (kind == "mesh") {
      one = p.X * mass_of_mesh;
      p = {mesh->hull.kind, mesh->hull.size, p.X * mesh->hull.X};
    } else {
      const Primitive f = fitted(e, kind, c, *mesh);
      p = {f.kind, f.size, p.X * f.X};
      one = is_shell ? shell(p) : solid(p);
    }
    if (!visual)
      out->note(RDM_NOTE_CHANGED, e.line, "mesh %s is %s%s", clean(*mesh_name).c_str(),
                kind == "mesh" ? called(p.kind) : ("a " + kind).c_str(), in_file(e).c_str());
  } else {
    p = primitive(e, kind, c, p.X, frame);
    one = is_shell ? shell(p) : solid(p);
  }
  if (counts && one.mass > 0) *from_geoms = *from_geoms + with_mass(mass ? given : one.mass * density, one);
  if (visual) return;
  ShapeIn s;
  if (const Attribute* n = e.find("name")) s.name = n->value;
  s.element = &e;
  s.shape = p;
  s.contype = static_cast<int>(contype);
  s.conaffinity = static_cast<int>(conaffinity);
  if (const auto* t = value(e, "rgba", c)) {
    const auto n = numbers(e, "rgba", *t, 4, 4);
    for (size_t k = 0; k < 3; ++k)
      s.color[k] = static_cast<uint8_t>(std::lround(255 * std::clamp(n[k], 0.0, 1.0)));
  }
  body->shapes.push_back(s);
}

// ---- meshes ----
const MeshIn* MjcfReader::mesh_in(const Element& geom, const std::string& name) {
  const auto asset = assets.find(name);
  if (asset == assets.end())
    refuse_at(RDM_ERROR_NOT_FOUND, geom, "there is no mesh %s%s", clean(name).c_str(),
              nearest_key(name, assets).c_str());
  return mesh_of(*asset->second, geom);
}

const MeshIn* MjcfReader::mesh_of(const Element& asset, const Element& geom) {
  const auto known = read_meshes.find(&asset);
  if (known != read_meshes.end()) return &known->second;
  check_attributes(asset, "mesh");
  check_children(asset, "mesh");
  Mesh mesh;
  if (const std::string* file = asset.get("file")) {
    std::string path = *file;
    if (compiler.strip) path = path.substr(path.rfind('/') == std::string::npos ? 0 : path.rfind('/') + 1);
    const Mesh* found = meshes.find(geom, path);
    if (!found) return nullptr;
    mesh = *found;
  } else if (const auto* t = asset.get("vertex")) {
    const auto n = numbers(asset, "vertex", *t, 12, 300000);
    if (n.size() % 3)
      refuse_at(RDM_ERROR_FORMAT, asset, "vertex: %zu numbers are not a multiple of 3", n.size());
    for (size_t k = 0; k < n.size(); k += 3) mesh.points.push_back({n[k], n[k + 1], n[k + 2]});
    if (const auto* faces = asset.get("face")) {
      const auto f = numbers(asset, "face", *faces, 3, 600000);
      if (f.size() % 3)
        refuse_at(RDM_ERROR_FORMAT, asset, "face: %zu numbers are not a multiple of 3", f.size());
      for (size_t k = 0; k < f.size(); ++k) {
        if (!(f[k] >= 0 && f[k] < static_cast<double>(mesh.points.size())))
          refuse_at(RDM_ERROR_RANGE, asset, "face: there is no vertex %g", f[k]);
        if (k % 3 == 0) mesh.faces.push_back({});
        mesh.faces.back()[k % 3] = static_cast<uint32_t>(f[k]);
      }
    }
  } else {
    refuse_at(RDM_ERROR_FORMAT, asset, "it has neither a file nor vertices");
  }
  // The reference pose is taken off, then what is left is scaled.
  Pose ref;
  if (const auto* t = asset.get("refpos")) ref.p = vector3(asset, "refpos", *t);
  if (const auto* t = asset.get("refquat")) {
    const auto n = numbers(asset, "refquat", *t, 4, 4);
    if (n[0] == 0 && n[1] == 0 && n[2] == 0 && n[3] == 0)
      refuse_at(RDM_ERROR_ARGUMENT, asset, "refquat: its length is 0");
    ref.q = normalized(Turn{n[0], n[1], n[2], n[3]});
  }
  V3 scale{1, 1, 1};
  if (const auto* t = value(asset, "scale", "")) scale = vector3(asset, "scale", *t);
  for (V3& v : mesh.points) {
    v = back(ref) * v;
    v = {scale.x * v.x, scale.y * v.y, scale.z * v.z};
  }
  const std::string* how = value(asset, "inertia", "");
  const std::string said = how ? *how : compiler.exact ? "exact" : "legacy";
  if (said != "legacy" && said != "exact" && said != "convex" && said != "shell")
    refuse_at(RDM_ERROR_FORMAT, asset, "inertia: %s is not one of legacy, exact, convex, shell",
              clean(said).c_str());
  MeshIn in;
  in.hull = around(mesh.points);
  try {
    in.mass = filled(mesh,
                     said == "exact"    ? Fill::kExact
                     : said == "convex" ? Fill::kConvex
                     : said == "shell"  ? Fill::kShell
                                        : Fill::kLegacy,
                     &out->budget);
    in.surface = mesh.faces.empty() ? in.mass : filled(mesh, Fill::kShell, &out->budget);
  } catch (const Refusal& r) {
    refuse_at(r.code, asset, "%s", r.text.c_str());
  }
  if (in.mass.mass > 0) {
    M3 axes, sorted;
    const auto p = principal(in.mass.moment, &axes);
    std::array<size_t, 3> row{0, 1, 2};
    std::sort(row.begin(), row.end(), [&](size_t a, size_t b) { return p[a] > p[b]; });
    for (size_t i = 0; i < 3; ++i)
      for (size_t k = 0; k < 2; ++k) sorted[i][k] = axes[i][row[k]];
    const V3 x{sorted[0][0], sorted[1][0], sorted[2][0]}, y{sorted[0][1], sorted[1][1], sorted[2][1]},
        z = cross(x, y);
    for (size_t i = 0; i < 3; ++i) sorted[i][2] = z[static_cast<int>(i)];
    in.X = {in.mass.com, turn_of(sorted)};
    const double sum = p[0] + p[1] + p[2];
    for (int k = 0; k < 3; ++k)
      in.box[k] =
          0.5 * std::sqrt(std::max(6 * (sum - 2 * p[row[static_cast<size_t>(k)]]) / in.mass.mass, 0.0));
    in.low = {1e300, 1e300, 1e300}, in.high = {-1e300, -1e300, -1e300};
    for (const V3& v : mesh.points) {
      const V3 r = back(in.X) * v;
      for (int k = 0; k < 3; ++k)
        in.low[k] = std::min(in.low[k], r[k]), in.high[k] = std::max(in.high[k], r[k]);
    }
  }
  return &(read_meshes[&asset] = in);
}

// The primitive that stands for a mesh: of its moments, or of its bounds (fitaabb).
Primitive MjcfReader::fitted(const Element& e, const std::string& kind, const std::string& c,
                             const MeshIn& mesh) const {
  const double scale = number_of(e, "fitscale", c, 1);
  Primitive p;
  p.X = mesh.X;
  V3 half = mesh.box;
  if (compiler.fit_box) {
    half = 0.5 * (mesh.high - mesh.low);
    p.X.p = mesh.X * (0.5 * (mesh.low + mesh.high));
  }
  const double across = compiler.fit_box ? std::max(half.x, half.y) : (half.x + half.y) / 2;
  if (kind == "sphere") {
    p.kind = RDM_SHAPE_SPHERE;
    p.size.x = compiler.fit_box ? std::max(across, half.z) : (half.x + half.y + half.z) / 3;
  } else if (kind == "capsule") {
    p.kind = RDM_SHAPE_CAPSULE;
    p.size = {across, half.z - (compiler.fit_box ? across : across / 2), 0};
  } else if (kind == "cylinder") {
    p.kind = RDM_SHAPE_CYLINDER;
    p.size = {across, half.z, 0};
  } else if (kind == "box" || kind == "ellipsoid") {
    p.kind = kind == "box" ? RDM_SHAPE_BOX : RDM_SHAPE_ELLIPSOID;
    p.size = half;
  } else {
    refuse_at(RDM_ERROR_UNSUPPORTED, e,
              "type %s is not supported: it must be sphere, capsule, cylinder, box, ellipsoid or mesh",
              clean(kind).c_str());
  }
  p.size = scale * p.size;
  if (kind == "capsule" && p.size.y <= 0)
    p.kind = RDM_SHAPE_SPHERE, p.size.y = 0;  // no room between its ends
  for (int k = 0; k < (p.kind == RDM_SHAPE_SPHERE ? 1 : kind == "box" || kind == "ellipsoid" ? 3 : 2); ++k)
    if (!(p.size[k] > 0)) refuse_at(RDM_ERROR_RANGE, e, "the size that fits its mesh is %g", p.size[k]);
  return p;
}

Primitive MjcfReader::primitive(const Element& e, const std::string& kind, const std::string& c,
                                const Pose& X, const Pose& frame) const {
  const bool box = kind == "box", ellipsoid = kind == "ellipsoid", cylinder = kind == "cylinder",
             capsule = kind == "capsule";
  if (!box && !ellipsoid && !cylinder && !capsule && kind != "sphere")
    refuse_at(RDM_ERROR_UNSUPPORTED, e,
              "type %s is not supported: it must be sphere, capsule, cylinder, box, ellipsoid or mesh",
              clean(kind).c_str());
  const std::string* text = value(e, "size", c);
  auto n = text ? numbers(e, "size", *text, 1, 3) : std::vector<double>();
  Pose at = X;
  const std::string* ends = value(e, "fromto", c);
  double half = 0;
  if (ends && kind != "sphere") {
    const auto f = numbers(e, "fromto", *ends, 6, 6);
    const V3 a{f[0], f[1], f[2]}, b{f[3], f[4], f[5]};
    half = norm(b - a) / 2;
    // The compiler's own way: z from the second end to the first.
    at = frame * Pose{0.5 * (a + b), turn_between({0, 0, 1}, unit(a - b))};
  }
  const size_t needed = kind == "sphere" ? 1 : box || ellipsoid ? 3 : 2;
  if (ends && needed > 1) {
    if (n.empty()) refuse_at(RDM_ERROR_FORMAT, e, "it has no size");
    if (needed == 2)
      n = {n[0], half};
    else
      n = {n[0], n[0], half};  // as wide as thick, whatever else `size` says
  }
  if (n.size() < needed) refuse_at(RDM_ERROR_FORMAT, e, "size: a %s needs %zu", kind.c_str(), needed);
  for (size_t k = 0; k < needed; ++k)
    if (!(n[k] > 0)) refuse_at(RDM_ERROR_RANGE, e, "size: %g is not above 0", n[k]);
  n.resize(3, 0);
  const int32_t k = box         ? RDM_SHAPE_BOX
                    : ellipsoid ? RDM_SHAPE_ELLIPSOID
                    : cylinder  ? RDM_SHAPE_CYLINDER
                    : capsule   ? RDM_SHAPE_CAPSULE
                                : RDM_SHAPE_SPHERE;
  return {k, {n[0], needed > 1 ? n[1] : 0, needed > 2 ? n[2] : 0}, at};
}

}  // namespace rdm::import
