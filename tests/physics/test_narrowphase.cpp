#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "articulated.hpp"
#include "hulls.hpp"
#include "physics/collision/convex.hpp"
#include "physics/collision/narrowphase.hpp"
#include "physics/ode_library/ode_convert.hpp"
#include "physics/ode_library/ode_guard.hpp"

namespace rdm {
namespace {

void add_body(SceneDef* def, ShapeKind kind, const Vec3& size, const Vec3& second) {
  BodyDef body;
  body.inertia = sphere_inertia(0.1, 0.05);
  ShapeDef shape;
  shape.kind = kind;
  shape.size = size;
  body.shapes.push_back(shape);
  if (norm(second) > 0) {
    shape.X_LS = {second, axis_angle({1, 0, 0}, 0.7)};
    body.shapes.push_back(shape);
  }
  def->bodies.push_back(body);
}

// Two free hands, a body of every kind, one of them of two shapes; a plane, a table and a plank that leans.
SceneDef everything(int32_t contacts_max) {
  test::TwoHands config;
  config.hand_hand = true;
  config.solver.contacts_max = contacts_max;
  SceneDef def = test::two_hands_def(config);
  for (ArticulationDef& a : def.articulations) a.free_base = true;
  add_body(&def, ShapeKind::kBox, {0.04, 0.03, 0.02}, {});
  add_body(&def, ShapeKind::kCylinder, {0.03, 0.05, 0}, {});
  add_body(&def, ShapeKind::kCapsule, {0.02, 0.05, 0}, {0.03, 0, 0});
  add_body(&def, ShapeKind::kEllipsoid, {0.03, 0.05, 0.02}, {0, 0.03, 0});
  add_body(&def, ShapeKind::kHull, {}, {});
  const Hull& block = kept_hull({0.04, 0.03, 0.03}, 0.5);
  def.bodies.back().shapes[0].points.assign(block.points, block.points + block.num_points);
  ShapeDef table;
  table.kind = ShapeKind::kBox;
  table.size = {0.3, 0.3, 0.05};
  table.X_LS.p = {0, -0.4, 0.35};
  def.statics.push_back(table);
  table.size = {0.02, 0.25, 0.1};
  table.X_LS = {{0.1, -0.4, 0.55}, axis_angle({0.6, 0, 0.8}, 0.7)};
  def.statics.push_back(table);
  return def;
}

// So many bodies that their boxes are sorted along an axis (crowd.hpp).
SceneDef many_bodies() {
  SceneDef def = everything(4096);
  for (int i = 0; i < 150; ++i)
    add_body(&def, i % 3 ? ShapeKind::kBox : ShapeKind::kCapsule, {0.02 + 0.001 * (i % 7), 0.03, 0.02},
             i % 5 ? Vec3{} : Vec3{0.03, 0.01, 0});
  return def;
}

// The collider of a scene beside a geom of our own for each shape, all where a world's shapes are.
class Rig final : public Collider::Poses {
 public:
  explicit Rig(const SceneDef& def) : sim_(def, EngineKind::kArticulated), scene_(sim_.scene()) {
    Arena measure;
    collider_.carve(scene_, measure);
    arena_ = Arena(HostHooks{}, measure.used());
    collider_.carve(scene_, arena_);
    collider_.make(scene_);
    for (const SceneShape& s : scene_.shapes)
      geoms_.push_back(make_geom(s.def, scene_.hull_of(s), s.def.X_LS));
    poses_.resize(geoms_.size());
    contacts_.resize(static_cast<size_t>(scene_.def.solver.contacts_max));
    pairs_.resize(contacts_.size());
  }
  ~Rig() override {
    for (const Geom& geom : geoms_) dGeomDestroy(geom.id);
  }

  // Hands around the origin of the ball, bodies within `spread` of it.
  void scatter(Stream& random, double spread) {
    const Vec3 middle{0, -0.4, 0.5};
    const auto place = [&](double reach) {
      const Vec3 p = middle + reach * Vec3{random.signed_unit(), random.signed_unit(), random.signed_unit()};
      return Pose{p, normalized(Quat{random.signed_unit(), random.signed_unit(), random.signed_unit(), 0.1})};
    };
    const double still[24] = {};
    for (int32_t hand = 0; hand < 2; ++hand) {
      double q[24];
      for (int32_t i = 0; i < 24; ++i) {
        const JointDef& joint = scene_.link(i).joint;
        q[i] = random.uniform(joint.lower, joint.upper);
      }
      sim_->set_joints(hand, q, still);
      Pose X = place(0.5 * spread);
      X.p -= rotate(X.q, {0, 0, 0.35});  // the palm comes near the middle
      sim_->set_base(hand, {X, {}, {}});
    }
    for (int32_t i = 0; i < scene_.num_bodies; ++i) sim_->set_body(i, {place(spread), {}, {}});
    put();
  }
  void place(int32_t shape, Vec3* p, Mat3* R) override {
    EXPECT_EQ(asked_[static_cast<size_t>(shape)]++, 0) << "asked twice";
    *p = poses_[static_cast<size_t>(shape)].p;
    *R = to_matrix(poses_[static_cast<size_t>(shape)].q);
  }

  Collider::Found collide(const PairList* listed = nullptr) {
    asked_.assign(geoms_.size(), 0);
    touched_.assign(scene_.pairs.size(), 0);
    return collider_.collide(scene_, *this, listed, nullptr, contacts_.data(), pairs_.data(),
                             touched_.data());
  }
  double overlap(int32_t body) {
    asked_.assign(geoms_.size(), 0);
    return collider_.overlap(scene_, *this, body);
  }
  // Every pair asked, none passed over.
  int touch(size_t pair, int most, dContactGeom* out) const {
    const ShapePair& p = scene_.pairs[pair];
    return collide_geoms(geoms_[static_cast<size_t>(p.a)], geoms_[static_cast<size_t>(p.b)], most, out);
  }

  World& world() { return *sim_; }
  const Scene& scene() const { return scene_; }
  const Contact& contact(int32_t i) const { return contacts_[static_cast<size_t>(i)]; }
  size_t pair(int32_t i) const { return static_cast<size_t>(pairs_[static_cast<size_t>(i)]); }
  bool touched(size_t pair) const { return touched_[pair] != 0; }

 private:
  void put() {
    for (size_t i = 0; i < geoms_.size(); ++i) {
      const SceneShape& s = scene_.shapes[i];
      if (!scene_.moves(s)) continue;
      poses_[i] = sim_->shape_pose(static_cast<int32_t>(i));
      const Mat3 R = to_matrix(poses_[i].q);
      dMatrix3 r;
      to_ode(R, r);
      dGeomSetRotation(geoms_[i].id, r);
      dGeomSetPosition(geoms_[i].id, poses_[i].p.x, poses_[i].p.y, poses_[i].p.z);
      Bound& bound = collider_.bounds()[i];
      const Vec3 axis = R * capsule_around(s).axis;
      for (int k = 0; k < 3; ++k) {
        bound.center[k] = static_cast<float>(poses_[i].p[k]);
        bound.axis[k] = static_cast<float>(axis[k]);
      }
    }
  }

  OdeGuard guard_;
  OdeScope scope_;
  test::Simulation sim_;
  const Scene& scene_;
  Arena arena_;
  Collider collider_;
  std::vector<Geom> geoms_;
  std::vector<Pose> poses_;
  std::vector<uint8_t> asked_;
  std::vector<Contact> contacts_;
  std::vector<int32_t> pairs_;
  std::vector<uint8_t> touched_;
};

struct Seen {
  int64_t points = 0, robots = 0, planes = 0;
};

// Of so many poses, every other one within `near` m and the rest within `far`.
Seen expect_what_every_pair_finds(Rig* rig, uint64_t seed, int poses, double near, double far) {
  Stream random(seed, 0, Purpose::kTest);
  const int most = rig->scene().def.solver.contacts_per_pair;
  Seen seen;
  for (int k = 0; k < poses; ++k) {
    rig->scatter(random, k % 2 ? near : far);
    const Collider::Found found = rig->collide();
    EXPECT_FALSE(found.overflow);
    int32_t at = 0;
    for (size_t pair = 0; pair < rig->scene().pairs.size(); ++pair) {
      dContactGeom out[kMaxPairPoints];
      const int n = rig->touch(pair, most, out);
      EXPECT_EQ(rig->touched(pair), n > 0) << "pair " << pair << " of pose " << k;
      for (int i = 0; i < n && at < found.count; ++i, ++at) {
        const Contact& contact = rig->contact(at);
        EXPECT_EQ(rig->pair(at), pair);
        EXPECT_EQ(contact.shape_a, rig->scene().pairs[pair].a);
        EXPECT_EQ(contact.shape_b, rig->scene().pairs[pair].b);
        EXPECT_EQ(norm(contact.p - from_ode(out[i].pos)), 0);
        EXPECT_EQ(norm(contact.n - from_ode(out[i].normal)), 0);
        EXPECT_EQ(contact.depth, out[i].depth);
      }
      const auto& shapes = rig->scene().shapes;
      const SceneShape& b = shapes[static_cast<size_t>(rig->scene().pairs[pair].b)];
      seen.robots += n > 0 && b.articulation >= 0;
      seen.planes += n > 0 && b.def.kind == ShapeKind::kPlane;
      seen.points += n;
    }
    EXPECT_EQ(at, found.count) << k;
  }
  return seen;
}

TEST(Collider, FindsWhatAskingEveryPairFinds) {
  Rig rig(everything(4096));
  const Seen seen = expect_what_every_pair_finds(&rig, 1, 300, 0.1, 0.3);
  EXPECT_GT(seen.points, 2500);
  EXPECT_GT(seen.robots, 1000);
  EXPECT_GT(seen.planes, 20);
}

TEST(Collider, FindsWhatAskingEveryPairOfManyBodiesFinds) {
  Rig rig(many_bodies());
  const Seen seen = expect_what_every_pair_finds(&rig, 2, 6, 0.4, 0.8);
  EXPECT_GT(seen.points, 1000);
}

// As when bodies sleep: the pairs of every second body with others and with what is at rest are not listed.
void expect_what_is_listed(const SceneDef& def, int poses, double spread) {
  Rig rig(def);
  const Scene& scene = rig.scene();
  const auto rests = [&](int32_t shape) {
    const SceneShape& s = scene.shapes[static_cast<size_t>(shape)];
    return s.carrier == Carrier::kStatic || (s.carrier == Carrier::kBody && s.index % 2 == 0);
  };
  std::vector<int32_t> list;
  std::vector<uint8_t> left_out(scene.pairs.size());
  for (const PairRun& run : scene.runs)
    for (int32_t k = run.first; run.shape < 0 && k < run.first + run.count; ++k) {
      const ShapePair& pair = scene.pairs[static_cast<size_t>(k)];
      left_out[static_cast<size_t>(k)] = rests(pair.a) && rests(pair.b);
      if (!left_out[static_cast<size_t>(k)]) list.push_back(k);
    }
  const PairList listed = {list.data(), static_cast<int32_t>(list.size())};
  Stream random(3, 0, Purpose::kTest);
  int out = 0, in = 0;
  for (int k = 0; k < poses; ++k) {
    rig.scatter(random, spread);
    const int32_t all = rig.collide().count;
    std::vector<size_t> want;
    for (int32_t i = 0; i < all; ++i)
      if (!left_out[rig.pair(i)]) want.push_back(rig.pair(i));
    const int32_t found = rig.collide(&listed).count;
    std::vector<size_t> pairs;
    for (int32_t i = 0; i < found; ++i) pairs.push_back(rig.pair(i));
    EXPECT_EQ(pairs, want) << k;
    in += found;
    out += all - found;
  }
  EXPECT_GT(in, 500);
  EXPECT_GT(out, 50);
}

TEST(Collider, APairThatIsNotListedIsLeftOutAndNoOther) {
  expect_what_is_listed(everything(4096), 100, 0.2);
}

TEST(Collider, APairOfManyBodiesThatIsNotListedIsLeftOutAndNoOther) {
  expect_what_is_listed(many_bodies(), 6, 0.6);
}

// No point of a shape is outside of the capsule around it.
TEST(Collider, ACapsuleHoldsItsShape) {
  Stream random(4, 0, Purpose::kTest);
  const ShapeKind kinds[] = {ShapeKind::kSphere, ShapeKind::kCapsule, ShapeKind::kBox, ShapeKind::kCylinder,
                             ShapeKind::kEllipsoid};
  int slender = 0;
  for (int k = 0; k < 400; ++k) {
    ShapeDef def;
    def.kind = kinds[k % 5];
    def.size = {random.uniform(0.01, 1), random.uniform(0.01, 1), random.uniform(0.01, 1)};
    const Vec3& s = def.size;
    SceneShape shape = {def, k % 3 == 0 ? Carrier::kLink : Carrier::kBody, 0, -1, 0};
    shape.radius = def.kind == ShapeKind::kBox         ? norm(s)
                   : def.kind == ShapeKind::kCylinder  ? std::hypot(s.x, s.y)
                   : def.kind == ShapeKind::kCapsule   ? s.x + s.y
                   : def.kind == ShapeKind::kEllipsoid ? std::max({s.x, s.y, s.z})
                                                       : s.x;
    const Capsule around = capsule_around(shape);
    slender += norm(around.axis) > 0 && def.kind != ShapeKind::kCapsule;
    EXPECT_LE(around.radius, shape.radius + 1e-12);
    for (int i = 0; i < 30; ++i) {
      const Convex solid = {def.kind, def.size, {}, {}};
      const Vec3 p = farthest(solid, {random.signed_unit(), random.signed_unit(), random.signed_unit()});
      const double square = dot(around.axis, around.axis);
      const double t = square > 0 ? std::clamp(dot(p, around.axis) / square, -1.0, 1.0) : 0;
      EXPECT_LE(norm(p - t * around.axis), around.radius + 1e-12) << k;
    }
  }
  EXPECT_GT(slender, 50);
}

TEST(Collider, TheFirstPointsStayWhenThereAreTooMany) {
  constexpr int32_t kCap = 7;
  Rig all(everything(4096)), few(everything(kCap));
  Stream a(2, 0, Purpose::kTest), b = a;
  int over = 0;
  for (int k = 0; k < 50; ++k) {
    all.scatter(a, 0.2);
    few.scatter(b, 0.2);
    const Collider::Found want = all.collide(), found = few.collide();
    ASSERT_EQ(found.overflow, want.count > kCap);
    ASSERT_EQ(found.count, std::min(want.count, kCap));
    over += found.overflow;
    for (int32_t i = 0; i < found.count; ++i) {
      EXPECT_EQ(few.pair(i), all.pair(i));
      EXPECT_EQ(norm(few.contact(i).p - all.contact(i).p), 0);
    }
    for (size_t pair = 0; pair < all.scene().pairs.size(); ++pair)
      ASSERT_EQ(few.touched(pair), all.touched(pair));
  }
  EXPECT_GT(over, 10);
}

TEST(Collider, OverlapIsTheDeepestOfABodysPairs) {
  Rig rig(everything(36));
  Stream random(3, 0, Purpose::kTest);
  int deep = 0, clear = 0;
  for (int k = 0; k < 100; ++k) {
    rig.scatter(random, 0.2);
    for (int32_t body = 0; body < rig.scene().num_bodies; ++body) {
      double deepest = 0;
      for (size_t pair = 0; pair < rig.scene().pairs.size(); ++pair) {
        const auto carries = [&](int32_t shape) {
          const SceneShape& s = rig.scene().shapes[static_cast<size_t>(shape)];
          return s.carrier == Carrier::kBody && s.index == body;
        };
        if (!carries(rig.scene().pairs[pair].a) && !carries(rig.scene().pairs[pair].b)) continue;
        dContactGeom out[kMaxPairPoints];
        const int n = rig.touch(pair, kMaxPairPoints, out);
        for (int i = 0; i < n; ++i) deepest = std::max(deepest, static_cast<double>(out[i].depth));
      }
      const double found = rig.overlap(body);
      EXPECT_EQ(found, deepest) << k;
      EXPECT_EQ(rig.world().body_overlap(body), deepest) << k;
      (deepest > 0 ? deep : clear) += 1;
    }
  }
  EXPECT_GT(deep, 50);
  EXPECT_GT(clear, 50);
}

TEST(Collider, ShapesThatDoNotCollideAreNotAsked) {
  SceneDef def = everything(4096);
  for (BodyDef& body : def.bodies) body.shapes[0].collides = false;
  Rig rig(def);
  Stream random(4, 0, Purpose::kTest);
  for (int k = 0; k < 20; ++k) {
    rig.scatter(random, 0.05);
    const Collider::Found found = rig.collide();
    for (int32_t i = 0; i < found.count; ++i)
      for (const int32_t shape : {rig.contact(i).shape_a, rig.contact(i).shape_b})
        EXPECT_TRUE(rig.scene().shapes[static_cast<size_t>(shape)].def.collides);
  }
}

}  // namespace
}  // namespace rdm
