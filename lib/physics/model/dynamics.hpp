// What one world may have otherwise than its scene: factors on the scene's constants, each 1 at first.
//
// For worlds whose masses, gains and friction differ (domain randomisation, a thing that was swapped for a
// heavier one). A record is carved once and then only written, so that a reset can draw it without memory.
//   link   mass (moments with it), kp, kd, effort, dry friction of its joint
//   base   of a free base: mass (moments with it); damping of the whole articulation
//   body   mass m, size s (of its shapes about its centre of mass: moments go with m s^2), damping
//   pair   of materials: mu
//   world  gravity
// A world with factors steps as one of a scene with the products does, which they are: rounded once, in
// double. But the ends of its joints stay as stiff as the scene's own masses ask for (articulated/tree.cpp).
#pragma once
#include "base/arena.hpp"
#include "base/bytes.hpp"
#include "physics/model/scene.hpp"

namespace rdm {

// Bounds of factors. Those of gains, efforts, friction and damping may be 0.
inline constexpr double kMassFactor[2] = {1e-3, 1e3}, kSizeFactor[2] = {0.05, 20}, kForceFactor[2] = {0, 1e3},
                        kGravityFactor[2] = {-10, 10};

struct LinkFactors {
  double mass = 1, kp = 1, kd = 1, effort = 1, friction = 1;
};
struct BaseFactors {
  double mass = 1, damping = 1;
};
struct BodyFactors {
  double mass = 1, size = 1, linear_damping = 1, angular_damping = 1;
};

struct Dynamics {
  double gravity = 1;
  LinkFactors* links = nullptr;   // [num_links]
  BaseFactors* bases = nullptr;   // [num_bases], one per articulation
  BodyFactors* bodies = nullptr;  // [num_bodies]
  double* friction = nullptr;     // [num_friction], at friction_index(a, b)
  int32_t num_links = 0, num_bases = 0, num_bodies = 0, num_friction = 0;

  // All factors 1.
  void carve(const Scene& scene, Arena& arena);
  void reset();
  // Takes what another record of the same scene has.
  void copy(const Dynamics& other);
  bool same(const Dynamics& other) const;  // likewise
  // Of two materials, in either order.
  static int32_t friction_index(int32_t a, int32_t b) {
    return a > b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a;
  }

  // Error(kArgument) for a record of another scene, Error(kRange) for a factor that is not finite or outside
  // its bounds; the text names it.
  void check(const Scene& scene) const;
  void save(Writer& out) const;
  void load(Reader& in);
  // Reads a saved record; false where a factor is not finite or outside its bounds.
  static bool sound(Reader& in, const Scene& scene);

  // The scene's constants with the factors on them.
  Inertia link_inertia(const Scene& scene, int32_t link) const;
  Inertia base_inertia(const Scene& scene, int32_t articulation) const;
  Inertia body_inertia(const Scene& scene, int32_t body) const;
  double mu(const Scene& scene, const ShapePair& pair) const {
    const auto material = [&](int32_t shape) {
      return scene.shapes[static_cast<size_t>(shape)].def.material;
    };
    return pair.mu * friction[friction_index(material(pair.a), material(pair.b))];
  }
};

}  // namespace rdm
