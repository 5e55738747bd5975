// Where links are after a step: from their persistent words, which are of joint frames and relative to the robot's
// base, to motions of link frames in the world, in double. Part of stepper.inl.
//
// Links with a sensor are written at a step's end, four lanes at a time: they are the fingertips that nearly every
// observation shows. All others are read one by one when somebody asks. The operations and their order are the same:
//   p_WL = p_WB + P      q_WL = q_WJ q_JL, normalised      v, w as they are
#pragma once

namespace rdm {
namespace {

template <class L>
PersistentLink<typename L::Scalar> BatchStepper<L>::link_words(const WorldState& world, int32_t link) const {
  const int32_t a = scene_->link_articulation[static_cast<size_t>(link)];
  const int32_t i = link - scene_->link_offset[static_cast<size_t>(a)];
  PersistentLink<S> words;
  std::memcpy(&words, persistent_of(world, a) + kBase + kLink * i, sizeof words);
  return words;
}

template <class L>
void BatchStepper<L>::read_link(const WorldState& world, int32_t link, Motion* m) const {
  const PersistentLink<S> from = link_words(world, link);
  const Vec3& base = world.bases[scene_->link_articulation[static_cast<size_t>(link)]].X.p;
  for (int r = 0; r < 3; ++r) {
    m->X.p[r] = base[r] + static_cast<double>(from.P[r]);
    m->v[r] = static_cast<double>(from.v[r]);
    m->w[r] = static_cast<double>(from.w[r]);
  }
  const Quat q_WJ = {static_cast<double>(from.q[0]), static_cast<double>(from.q[1]),
                     static_cast<double>(from.q[2]), static_cast<double>(from.q[3])};
  m->X.q = normalized(q_WJ * q_JL_[link]);
}

template <class L>
Mat3 BatchStepper<L>::link_rotation(const WorldState& world, int32_t link) const {
  const PersistentLink<S> from = link_words(world, link);
  Mat3 R_WJ;
  for (int k = 0; k < 9; ++k) R_WJ.m[k] = static_cast<double>(from.R[k]);
  return R_WJ * R_JL_[link];
}

template <class L>
void BatchStepper<L>::list_felt_links() {
  if (!kWritesFelt) return;
  for (int32_t g = 0; g < num_groups_; ++g) {
    Group& group = groups_[g];
    for (int32_t i = 0; i < group.tree->num_links; ++i)
      for (const TreeMember& member : group.tree->members)
        if (std::find(scene_->sensors.begin(), scene_->sensors.end(), member.first_link + i) !=
            scene_->sensors.end()) {
          group.felt[group.num_felt++] = i;
          break;
        }
  }
}

// After scatter.
template <class L>
void BatchStepper<L>::write_felt_links(int32_t batch) {
  if constexpr (kWritesFelt) {
    static_assert(sizeof(Motion) == 13 * sizeof(double), "p, q, v, w one after the other");
    const TreeBatch<L>& t = batches_[batch];
    int32_t g = 0;
    while (batch >= groups_[g].first_batch + groups_[g].num_batches) ++g;
    const Group& group = groups_[g];
    for (int four = 0; group.num_felt > 0 && four < L::kCount && t.used[four]; four += 4) {
      const auto wide = [four](const V& v) {
        return __builtin_convertvector(load4(reinterpret_cast<const float*>(&v) + four), Double4);
      };
      int32_t first_link[4];
      double origin[3][4];
      for (int l = 0; l < 4; ++l) {
        const TreeMember& member = member_of(t, four + l);
        const Vec3& p = worlds_[t.world[four + l]]->bases[member.articulation].X.p;
        first_link[l] = member.first_link;
        for (int r = 0; r < 3; ++r) origin[r][l] = p[r];
      }
      Double4 base[3];
      std::memcpy(base, origin, sizeof base);
      for (int32_t k = 0; k < group.num_felt; ++k) {
        const int32_t i = group.felt[k];
        const PersistentLink<V>& from = t.state[i];
        double wxyz[4][4];
        for (int l = 0; l < 4; ++l) {
          const Quat& q = q_JL_[first_link[l] + i];
          wxyz[0][l] = q.w;
          wxyz[1][l] = q.x;
          wxyz[2][l] = q.y;
          wxyz[3][l] = q.z;
        }
        Double4 q_JL[4], q_WJ[4], row[13];
        std::memcpy(q_JL, wxyz, sizeof q_JL);
        for (int r = 0; r < 4; ++r) q_WJ[r] = wide(from.q[r]);
        for (int r = 0; r < 3; ++r) {
          row[r] = base[r] + wide(from.P[r]);
          row[7 + r] = wide(from.v[r]);
          row[10 + r] = wide(from.w[r]);
        }
        Double4* const q = row + 3;
        multiply_quaternions(q_WJ, q_JL, q);
        const Double4 scale =
            1.0 / Simd<double, 4>::root(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        for (int r = 0; r < 4; ++r) q[r] = scale * q[r];
        Double4 part[3][4];
        for (int c = 0; c < 3; ++c) {
          for (int r = 0; r < 4; ++r) part[c][r] = row[4 * c + r];
          transpose(part[c]);
        }
        for (int l = 0; l < 4 && t.used[four + l]; ++l) {
          const WorldState& world = *worlds_[t.world[four + l]];
          auto* const to = reinterpret_cast<double*>(&world.links[first_link[l] + i]);
          for (int c = 0; c < 3; ++c) std::memcpy(to + 4 * c, &part[c][l], sizeof(Double4));
          to[12] = row[12][l];
          world.fresh[first_link[l] + i] = 1;
        }
      }
    }
  }
}

}  // namespace
}  // namespace rdm
