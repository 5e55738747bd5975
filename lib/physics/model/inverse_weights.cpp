#include "physics/model/inverse_weights.hpp"

#include <cmath>

#include "physics/model/inertia.hpp"

// Of one articulation: the Jacobians of all centres of mass at q = 0 column by column, the dense mass matrix
// M = sum m J_v^T J_v + J_w^T I J_w + armature, M = C C^T (Cholesky), and |C^-1 J^T|^2 by directions.
namespace rdm {
namespace {

struct Column {
  Vec3 origin, axis;
  bool slides;
  Vec3 velocity(const Vec3& p) const { return slides ? axis : cross(axis, p - origin); }
  Vec3 spin() const { return slides ? Vec3{} : axis; }
};

class Chain {
 public:
  Chain(const Scene& scene, size_t a) : def_(scene.def.articulations[a]) {
    first_ = scene.link_offset[a];
    offset_ = def_.free_base ? 6 : 0;
    n_ = offset_ + static_cast<int32_t>(def_.links.size());
    matrix_.resize(static_cast<size_t>(n_) * static_cast<size_t>(n_));
    for (int32_t k = 0; k < offset_; ++k) {
      Vec3 axis;
      axis[k % 3] = 1;
      columns_.push_back({def_.X_WB.p, axis, k < 3});
    }
    for (size_t i = 0; i < def_.links.size(); ++i) {
      const LinkDef& link = def_.links[i];
      const Pose& parent = link.parent < 0 ? def_.X_WB : poses_[static_cast<size_t>(link.parent)];
      poses_.push_back(parent * link.X_PL);
      columns_.push_back(
          {poses_[i].p, rotate(poses_[i].q, link.joint.axis), link.joint.kind == JointKind::kPrismatic});
    }
    add_masses();
    factor();
  }
  // Coordinates of a link's path to the root, -1: the base.
  template <class Visit>
  void path(int32_t link, const Visit& visit) const {
    for (int32_t i = link; i >= 0; i = def_.links[static_cast<size_t>(i)].parent) visit(offset_ + i);
    for (int32_t k = offset_ - 1; k >= 0; --k) visit(k);
  }
  double weight(int32_t link) const {
    const Inertia& inertia = link < 0 ? def_.base : def_.links[static_cast<size_t>(link)].inertia;
    const Pose& X = link < 0 ? def_.X_WB : poses_[static_cast<size_t>(link)];
    const Vec3 com = X * inertia.com;
    double sum = 0;
    for (int r = 0; r < 3; ++r) {
      Vector<double> row(static_cast<size_t>(n_));
      path(link, [&](int32_t c) {
        row[static_cast<size_t>(c)] = columns_[static_cast<size_t>(c)].velocity(com)[r];
      });
      sum += square_solved(&row);
    }
    return sum / 3;
  }
  double joint(int32_t link) const {
    Vector<double> row(static_cast<size_t>(n_));
    row[static_cast<size_t>(offset_ + link)] = 1;
    return square_solved(&row);
  }
  int32_t first() const { return first_; }
  int32_t links() const { return n_ - offset_; }

 private:
  double& at(int32_t i, int32_t k) {
    return matrix_[static_cast<size_t>(i) * static_cast<size_t>(n_) + static_cast<size_t>(k)];
  }
  double at(int32_t i, int32_t k) const {
    return matrix_[static_cast<size_t>(i) * static_cast<size_t>(n_) + static_cast<size_t>(k)];
  }
  void add_mass(int32_t link, const Inertia& inertia, const Pose& X) {
    if (inertia.mass <= 0) return;
    const Mat3 R = to_matrix(X.q);
    const Mat3 moment = R * (moment_matrix(inertia) * transpose(R));
    const Vec3 com = X * inertia.com;
    path(link, [&](int32_t i) {
      const Column& x = columns_[static_cast<size_t>(i)];
      const Vec3 v = inertia.mass * x.velocity(com), spin = moment * x.spin();
      path(link, [&](int32_t k) {
        const Column& y = columns_[static_cast<size_t>(k)];
        at(i, k) += dot(v, y.velocity(com)) + dot(spin, y.spin());
      });
    });
  }
  void add_masses() {
    if (def_.free_base) add_mass(-1, def_.base, def_.X_WB);
    for (int32_t i = 0; i < links(); ++i) {
      const LinkDef& link = def_.links[static_cast<size_t>(i)];
      add_mass(i, link.inertia, poses_[static_cast<size_t>(i)]);
      at(offset_ + i, offset_ + i) += link.joint.armature;
    }
  }
  void factor() {
    for (int32_t i = 0; i < n_; ++i)
      for (int32_t k = 0; k <= i; ++k) {
        double x = at(i, k);
        for (int32_t c = 0; c < k; ++c) x -= at(i, c) * at(k, c);
        // what moves nothing is not moved
        at(i, k) = k == i ? (x > 0 ? std::sqrt(x) : HUGE_VAL) : x / at(k, k);
      }
  }
  double square_solved(Vector<double>* row) const {
    double sum = 0;
    for (int32_t i = 0; i < n_; ++i) {
      double x = (*row)[static_cast<size_t>(i)];
      for (int32_t k = 0; k < i; ++k) x -= at(i, k) * (*row)[static_cast<size_t>(k)];
      x /= at(i, i);
      (*row)[static_cast<size_t>(i)] = x;
      sum += x * x;
    }
    return sum;
  }

  const ArticulationDef& def_;
  int32_t first_ = 0, offset_ = 0, n_ = 0;
  Vector<Pose> poses_;  // of links
  Vector<Column> columns_;
  Vector<double> matrix_;
};

}  // namespace

InverseWeights inverse_weights(const Scene& scene) {
  InverseWeights w;
  w.links.resize(static_cast<size_t>(scene.num_links));
  w.joints.resize(static_cast<size_t>(scene.num_links));
  for (size_t a = 0; a < scene.def.articulations.size(); ++a) {
    const Chain chain(scene, a);
    w.bases.push_back(scene.def.articulations[a].free_base ? chain.weight(-1) : 0);
    for (int32_t i = 0; i < chain.links(); ++i) {
      w.links[static_cast<size_t>(chain.first() + i)] = chain.weight(i);
      w.joints[static_cast<size_t>(chain.first() + i)] = chain.joint(i);
    }
  }
  return w;
}

double InverseWeights::of(const Scene& scene, const SceneShape& shape) const {
  switch (shape.carrier) {
    case Carrier::kLink:
      return links[static_cast<size_t>(shape.index)];
    case Carrier::kBase:
      return bases[static_cast<size_t>(shape.articulation)];
    case Carrier::kBody:
      return 1 / scene.def.bodies[static_cast<size_t>(shape.index)].inertia.mass;
    case Carrier::kStatic:
      break;
  }
  return 0;
}

}  // namespace rdm
