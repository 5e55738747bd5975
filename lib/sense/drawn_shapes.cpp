#include "sense/drawn_shapes.hpp"

#include <algorithm>
#include <cmath>

#include "sense/scene_shapes.hpp"

namespace rdm {

namespace {

constexpr int32_t kFewestFingers = 3;
constexpr double kEdge = 0.003;                          // m, radius of the edges of things
constexpr double kThingShare = 0.3, kRobotShare = 0.55;  // of the smallest half size, at most
constexpr double kSkinShare = 0.9;
constexpr double kBoneShare = 1.15;  // of the finger's radius
constexpr uint8_t kTipTone[3] = {232, 186, 160};

struct Finger {
  int32_t palm = -1;         // a box
  int32_t first = -1;        // capsule next to the palm
  int32_t before_last = -1;  // capsule, -1: the finger has one
  int32_t last = -1;         // capsule of the tip
  int32_t tip_link = -1;     // flat
};

// The scene's shapes of one articulation, link by link.
class Tree {
 public:
  Tree(const Scene& scene, int32_t articulation) : scene_(scene), articulation_(articulation) {}

  int32_t first_link() const { return scene_.link_offset[static_cast<size_t>(articulation_)]; }
  int32_t end_link() const { return first_link() + static_cast<int32_t>(def().links.size()); }
  // Flat, -1: the base.
  int32_t parent(int32_t link) const {
    const int32_t local = scene_.link(link).parent;
    return local < 0 ? -1 : first_link() + local;
  }
  bool has_children(int32_t link) const {
    for (int32_t i = link + 1; i < end_link(); ++i)
      if (parent(i) == link) return true;
    return false;
  }
  // Largest shape of that kind on a link or the base, -1: none.
  int32_t largest(int32_t link, ShapeKind kind) const {
    int32_t best = -1;
    for (size_t i = 0; i < scene_.shapes.size(); ++i) {
      const SceneShape& s = scene_.shapes[i];
      if (s.articulation != articulation_ || s.def.kind != kind) continue;
      if ((s.carrier == Carrier::kLink ? s.index : -1) != link) continue;
      if (best < 0 || s.radius > scene_.shapes[static_cast<size_t>(best)].radius)
        best = static_cast<int32_t>(i);
    }
    return best;
  }
  bool finger_at(int32_t tip, Finger* out) const {
    if (has_children(tip)) return false;
    *out = {};
    out->tip_link = tip;
    for (int32_t link = tip;; link = parent(link)) {
      out->palm = largest(link, ShapeKind::kBox);
      if (out->palm >= 0 || link < 0) break;
      const int32_t capsule = largest(link, ShapeKind::kCapsule);
      if (capsule < 0) continue;
      if (out->last < 0)
        out->last = capsule;
      else if (out->before_last < 0)
        out->before_last = capsule;
      out->first = capsule;
    }
    return out->palm >= 0 && out->before_last >= 0;
  }

 private:
  const ArticulationDef& def() const { return scene_.def.articulations[static_cast<size_t>(articulation_)]; }
  const Scene& scene_;
  int32_t articulation_;
};

int longest_axis(const Vec3& v) {
  return v.x > v.y ? (v.x > v.z ? 0 : 2) : (v.y > v.z ? 1 : 2);
}

// End of a capsule that is nearer to p.
Vec3 near_end(const RenderShape& capsule, const Vec3& p) {
  const Vec3 a = capsule.X_WS * Vec3{0, 0, capsule.size.y}, b = capsule.X_WS * Vec3{0, 0, -capsule.size.y};
  return norm(a - p) < norm(b - p) ? a : b;
}

// Turns z to the unit vector d.
Quat along(const Vec3& d) {
  if (d.z < -0.999999) return {0, 1, 0, 0};
  return normalized(Quat{1 + d.z, -d.y, d.x, 0});
}

uint8_t toward(uint8_t from, double to, double share) {
  return static_cast<uint8_t>(std::lround(from + share * (to - from)));
}

bool is_light(const RenderShape& s) {
  return s.color[0] + s.color[1] + s.color[2] > 360;
}

// From the root of finger `f` into the palm; `points` is which way along the palm's longest side its fingers are.
RenderShape bone_of(const Finger& f, double points, const RenderShape* shapes) {
  const RenderShape& palm = shapes[f.palm];
  const RenderShape& first = shapes[f.first];
  const Vec3 root = inverse(palm.X_WS) * near_end(first, palm.X_WS.p);
  const int k = longest_axis(palm.size);
  Vec3 end = 0.35 * root;
  for (int i = 0; i < 3; ++i) {
    const double inside = std::max(0.0, palm.size[i] - first.size.x);
    end[i] = std::clamp(end[i], -inside, inside);
  }
  end[k] = (points < 0 ? 0.75 : -0.75) * palm.size[k];
  RenderShape bone = palm;
  bone.kind = ShapeKind::kCapsule;
  bone.size = {kBoneShare * first.size.x, std::max(1e-4, 0.5 * norm(root - end)), 0};
  bone.X_WS = palm.X_WS * Pose{0.5 * (root + end), along(normalized(root - end))};
  return bone;
}

// False where the tip's joint does not say which side its back is, or the tip is dark, as pads of rubber are.
bool nail_of(const Scene& scene, const Finger& f, const RenderShape* shapes, RenderShape* nail) {
  const RenderShape& tip = shapes[f.last];
  const LinkDef& link = scene.link(f.tip_link);
  const Pose& X_LS = scene.shapes[static_cast<size_t>(f.last)].def.X_LS;
  const JointDef& joint = link.joint;
  if (joint.kind != JointKind::kRevolute || scene.shapes[static_cast<size_t>(f.last)].index != f.tip_link)
    return false;
  const double bends = joint.upper + joint.lower;
  if (!(std::abs(bends) > 0.3 * (joint.upper - joint.lower)) || !is_light(tip)) return false;
  const Vec3 z = rotate(X_LS.q, {0, 0, 1});
  const Vec3 ahead = dot(z, X_LS.p) < 0 ? -z : z;
  const Vec3 back_L = (bends > 0 ? -1.0 : 1.0) * cross(joint.axis, ahead);
  if (norm(back_L) < 0.5) return false;
  const Vec3 y = normalized(rotate(conjugate(X_LS.q), back_L)), forward = rotate(conjugate(X_LS.q), ahead);
  const Vec3 x = cross(y, forward);
  const double r = tip.size.x;
  *nail = tip;
  nail->kind = ShapeKind::kEllipsoid;
  nail->size = {0.66 * r, 0.30 * r, 0.85 * r};
  nail->X_WS = tip.X_WS * Pose{0.80 * r * y + (tip.size.y - 0.05 * r) * forward,
                               to_quat({{x.x, y.x, forward.x, x.y, y.y, forward.y, x.z, y.z, forward.z}})};
  nail->finish = Finish::kPlastic;
  for (uint8_t& c : nail->color) c = toward(c, 255, 0.55);
  return true;
}

bool same_color(const RenderShape& a, const RenderShape& b) {
  return std::equal(a.color, a.color + 3, b.color);
}

// Skin, tips in another tone, bones and nails, if it is a hand. Returns how many shapes there are then.
int32_t dress_hand(const Scene& scene, int32_t articulation, RenderShape* out, int32_t count) {
  const Tree tree(scene, articulation);
  Finger f;
  int32_t fingers = 0;
  for (int32_t link = tree.first_link(); link < tree.end_link(); ++link) fingers += tree.finger_at(link, &f);
  if (fingers < kFewestFingers) return count;
  for (int32_t tip = tree.first_link(); tip < tree.end_link(); ++tip) {
    if (!tree.finger_at(tip, &f)) continue;
    RenderShape &palm = out[f.palm], &last = out[f.last];
    for (int32_t link = tip; link >= 0; link = tree.parent(link)) {
      const int32_t i = tree.largest(link, ShapeKind::kCapsule);
      if (i >= 0) out[i].finish = Finish::kSkin;
      if (tree.largest(link, ShapeKind::kBox) == f.palm) break;
    }
    // What sits on the palm's link is palm too.
    const SceneShape& on = scene.shapes[static_cast<size_t>(f.palm)];
    for (size_t i = 0; i < scene.shapes.size(); ++i) {
      const SceneShape& s = scene.shapes[i];
      if (s.articulation != articulation || s.carrier != on.carrier || s.index != on.index) continue;
      out[i].finish = Finish::kSkin;
      if (s.def.kind == ShapeKind::kBox)
        out[i].round = kSkinShare * std::min({out[i].size.x, out[i].size.y, out[i].size.z});
    }
    double points = 0;
    Finger other;
    for (int32_t link = tree.first_link(); link < tree.end_link(); ++link)
      if (tree.finger_at(link, &other) && other.palm == f.palm)
        points += (inverse(palm.X_WS) * near_end(out[other.first], palm.X_WS.p))[longest_axis(palm.size)];
    out[count++] = bone_of(f, points, out);
    if (same_color(last, out[f.before_last]) && is_light(last))
      for (int k = 0; k < 3; ++k) last.color[k] = toward(last.color[k], kTipTone[k], 0.5);
    if (nail_of(scene, f, out, &out[count])) ++count;
  }
  return count;
}

}  // namespace

int32_t most_drawn_shapes(const Scene& scene) {
  auto most = static_cast<int32_t>(scene.shapes.size());
  const auto articulations = static_cast<int32_t>(scene.def.articulations.size());
  for (int32_t a = 0; a < articulations; ++a) {
    const Tree tree(scene, a);
    Finger f;
    for (int32_t link = tree.first_link(); link < tree.end_link(); ++link)
      if (tree.finger_at(link, &f)) most += 2;
  }
  return most;
}

int32_t gather_drawn(const World& world, RenderShape* out) {
  const Scene& scene = world.scene();
  int32_t count = gather_shapes(world, out);
  for (int32_t i = 0; i < count; ++i) {
    const SceneShape& s = scene.shapes[static_cast<size_t>(i)];
    RenderShape& drawn = out[i];
    drawn.finish = s.def.finish;
    const double half = std::min({drawn.size.x, drawn.size.y, drawn.size.z});
    if (drawn.kind == ShapeKind::kBox)
      drawn.round = s.articulation >= 0 ? kRobotShare * half : std::min(kEdge, kThingShare * half);
    else if (drawn.kind == ShapeKind::kHull)
      drawn.round = std::min(kEdge, kThingShare * half);
  }
  const auto articulations = static_cast<int32_t>(scene.def.articulations.size());
  for (int32_t a = 0; a < articulations; ++a) count = dress_hand(scene, a, out, count);
  return count;
}

}  // namespace rdm
