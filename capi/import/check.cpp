// A robot alone: what touches at home and on the way, and whether its drives come to rest.
//
// The mass matrix from the links' Jacobians, M(q) = sum m Jv' Jv + Jw' I Jw; a step of 1/240 s is implicit in
// the drives: (M + dt kd + dt^2 kp) dv = dt (kp (target - q - dt v) - kd v), efforts bounded after it. No
// gravity, no contacts, no velocity products: what shakes here has gains that its inertia cannot bear.
#include <algorithm>
#include <cmath>

#include "model.hpp"

namespace rdm::import {
namespace {

constexpr double kStep = 1.0 / 240;
constexpr int kSteps = 480;  // 2 s
constexpr int kSweep = 16;   // places along a joint's range

using Rows = std::vector<std::vector<double>>;

Rows mass_matrix(const Draft& d, const std::vector<double>& q) {
  const auto poses = link_poses(d, q);
  const size_t n = d.links.size();
  Rows m(n, std::vector<double>(n, 0));
  for (size_t k = 0; k < n; ++k) {
    const rdm_robot_link& l = d.links[k];
    std::vector<size_t> chain;
    for (auto r = static_cast<int32_t>(k); r >= 0; r = d.links[static_cast<size_t>(r)].parent)
      chain.push_back(static_cast<size_t>(r));
    const double* i = l.moment;
    const M3 moment = turned(poses[k].q, {{{i[0], i[3], i[4]}, {i[3], i[1], i[5]}, {i[4], i[5], i[2]}}});
    const V3 com = poses[k] * vec(l.com);
    std::vector<V3> jv, jw;
    for (const size_t r : chain) {
      const V3 axis = poses[r].q * vec(d.links[r].axis);
      const bool slides = d.links[r].kind == RDM_JOINT_PRISMATIC;
      jv.push_back(slides ? axis : cross(axis, com - poses[r].p));
      jw.push_back(slides ? V3{} : axis);
    }
    for (size_t a = 0; a < chain.size(); ++a)
      for (size_t b = 0; b < chain.size(); ++b) {
        V3 t;
        for (int x = 0; x < 3; ++x)
          for (int y = 0; y < 3; ++y)
            t[x] += moment[static_cast<size_t>(x)][static_cast<size_t>(y)] * jw[b][y];
        m[chain[a]][chain[b]] += l.mass * dot(jv[a], jv[b]) + dot(jw[a], t);
      }
  }
  for (size_t k = 0; k < n; ++k) m[k][k] += d.links[k].armature;
  return m;
}

// Of a symmetric positive matrix, by Cholesky; false where it is none.
bool solve(Rows a, std::vector<double>* b) {
  const size_t n = a.size();
  for (size_t j = 0; j < n; ++j) {
    for (size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
    if (!(a[j][j] > 0)) return false;
    a[j][j] = std::sqrt(a[j][j]);
    for (size_t i = j + 1; i < n; ++i) {
      for (size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
    }
  }
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = 0; k < i; ++k) (*b)[i] -= a[i][k] * (*b)[k];
    (*b)[i] /= a[i][i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; ++k) (*b)[i] -= a[k][i] * (*b)[k];
    (*b)[i] /= a[i][i];
  }
  return true;
}

struct Checker {
  Draft& d;
  std::vector<double> home = home_of(d);

  const char* link(int32_t row) const {
    return row < 0 ? "the root" : d.links[static_cast<size_t>(row)].name;
  }
  // Followers go where their leaders say.
  void follow(std::vector<double>* q) const {
    for (const rdm_robot_coupling& c : d.couplings) {
      const auto k = static_cast<size_t>(c.link);
      (*q)[k] = std::clamp(c.ratio * (*q)[static_cast<size_t>(c.other)], d.links[k].lower, d.links[k].upper);
    }
  }

  // The pairs that may touch, or all of them but neighbours.
  std::vector<rdm_robot_pair> pairs() const {
    if (!d.all_pairs) return d.pairs;
    std::vector<rdm_robot_pair> all;
    const auto parent = [&](int32_t row) {
      return row < 0 ? RDM_LINK_NONE : d.links[static_cast<size_t>(row)].parent;
    };
    for (int32_t b = 0; b < static_cast<int32_t>(d.shapes.size()); ++b)
      for (int32_t a = 0; a < b; ++a) {
        const int32_t la = d.shapes[static_cast<size_t>(a)].link, lb = d.shapes[static_cast<size_t>(b)].link;
        if (la != lb && parent(la) != lb && parent(lb) != la) all.push_back({a, b});
      }
    return all;
  }
  // Which of the pairs touch at q, of those that have a link on one side of joint `row` alone; row < 0: of
  // all.
  std::vector<size_t> touching(const std::vector<rdm_robot_pair>& all, const std::vector<double>& q,
                               int32_t row) const {
    const auto poses = link_poses(d, q);
    std::vector<Primitive> at;
    for (const rdm_robot_shape& s : d.shapes) {
      at.push_back(primitive_of(s));
      at.back().X = pose_of(poses, s.link) * at.back().X;
    }
    std::vector<size_t> out;
    for (size_t i = 0; i < all.size(); ++i) {
      const auto a = static_cast<size_t>(all[i].a), b = static_cast<size_t>(all[i].b);
      if (row >= 0 && is_below(d, d.shapes[a].link, row) == is_below(d, d.shapes[b].link, row)) continue;
      if (touch(at[a], at[b])) out.push_back(i);
    }
    return out;
  }

  void shapes() {
    const auto all = pairs();
    const auto at_home = touching(all, home, -1);
    for (const size_t i : at_home)
      d.note(RDM_NOTE_CHECK, 0, "in the home pose %s touches %s",
             d.shapes[static_cast<size_t>(all[i].a)].name, d.shapes[static_cast<size_t>(all[i].b)].name);
    for (size_t r = 0; r < d.links.size(); ++r) {
      if (std::any_of(d.couplings.begin(), d.couplings.end(),
                      [&](const rdm_robot_coupling& c) { return c.link == static_cast<int32_t>(r); }))
        continue;
      double low = 0, high = 0;
      std::string what;
      int count = 0;
      for (int k = 0; k <= kSweep; ++k) {
        auto q = home;
        q[r] = d.links[r].lower + (d.links[r].upper - d.links[r].lower) * k / kSweep;
        follow(&q);
        for (const size_t i : touching(all, q, static_cast<int32_t>(r))) {
          if (std::find(at_home.begin(), at_home.end(), i) != at_home.end()) continue;
          low = count ? std::min(low, q[r]) : q[r], high = count ? std::max(high, q[r]) : q[r];
          if (count++ == 0)
            what = format("%s and %s", d.shapes[static_cast<size_t>(all[i].a)].name,
                          d.shapes[static_cast<size_t>(all[i].b)].name);
        }
      }
      if (count)
        d.note(RDM_NOTE_CHECK, 0, "while joint %s alone moves from %.3g to %.3g, %s touch", d.links[r].joint,
               low, high, what.c_str());
    }
  }

  // Steps to the targets; the largest speed in the last half second, by joint. Empty: its inertia is
  // singular.
  std::vector<double> step(std::vector<double>* q, const std::vector<double>& target) const {
    const size_t n = d.links.size();
    std::vector<double> v(n, 0), rest(n, 0);
    for (int s = 0; s < kSteps; ++s) {
      Rows m = mass_matrix(d, *q);
      const Rows bare = m;
      std::vector<double> b(n);
      for (size_t k = 0; k < n; ++k) {
        const rdm_robot_link& l = d.links[k];
        b[k] = kStep * (l.kp * (target[k] - (*q)[k] - kStep * v[k]) - l.kd * v[k]);
        m[k][k] += kStep * l.kd + kStep * kStep * l.kp;
      }
      auto dv = b;
      if (!solve(m, &dv)) return {};
      // Drives beyond their effort give that, and push no stiffer.
      m = bare;
      auto f = b;
      for (size_t k = 0; k < n; ++k) {
        const rdm_robot_link& l = d.links[k];
        const double effort = l.kp * (target[k] - (*q)[k] - kStep * (v[k] + dv[k])) - l.kd * (v[k] + dv[k]);
        if (std::abs(effort) > l.effort)
          f[k] = kStep * std::clamp(effort, -l.effort, l.effort);
        else
          m[k][k] += kStep * l.kd + kStep * kStep * l.kp;
      }
      if (!solve(m, &f)) return {};
      for (size_t k = 0; k < n; ++k) {
        v[k] += f[k];
        (*q)[k] += kStep * v[k];
        const double inside = std::clamp((*q)[k], d.links[k].lower, d.links[k].upper);
        if (inside != (*q)[k]) (*q)[k] = inside, v[k] = 0;
        if (s >= kSteps - 120) rest[k] = std::max(rest[k], std::abs(v[k]));
        if (!std::isfinite(v[k])) return {};
      }
    }
    return rest;
  }

  void drives() {
    const size_t n = d.links.size();
    auto q = home;
    // A little beside home, each joint by another amount.
    for (size_t k = 0; k < n; ++k) {
      const double range = d.links[k].upper - d.links[k].lower;
      q[k] = std::clamp(home[k] + range * (0.02 + 0.002 * static_cast<double>(k % 5)), d.links[k].lower,
                        d.links[k].upper);
    }
    const auto rest = step(&q, home);
    if (rest.empty()) {
      d.note(RDM_NOTE_CHECK, 0, "its inertia matrix is singular: a joint moves no mass");
      return;
    }
    for (size_t k = 0; k < n; ++k)
      if (rest[k] > 0.05)
        d.note(RDM_NOTE_CHECK, 0,
               "joint %s does not settle in the home pose: its velocity is %.3g per second after 1.5 s",
               d.links[k].joint, rest[k]);
    for (size_t k = 0; k < n; ++k) {
      const rdm_robot_link& l = d.links[k];
      if (std::any_of(d.couplings.begin(), d.couplings.end(),
                      [&](const rdm_robot_coupling& c) { return c.link == static_cast<int32_t>(k); }))
        continue;
      for (const double end : {l.lower, l.upper}) {
        auto target = home;
        target[k] = end;
        follow(&target);
        q = home;
        const auto speeds = step(&q, target);
        const double away = speeds.empty() ? 1 : std::abs(q[k] - end);
        if (away > 0.05 * (l.upper - l.lower))
          d.note(RDM_NOTE_CHECK, 0, "joint %s does not reach %.3g in 2 s: it is at %.3g", l.joint, end, q[k]);
        else if (speeds[k] > 0.05)
          d.note(RDM_NOTE_CHECK, 0,
                 "joint %s does not settle at %.3g: its velocity is %.3g per second after 1.5 s", l.joint,
                 end, speeds[k]);
      }
    }
  }
};

}  // namespace

void check_robot(Draft* draft) {
  Checker checker{*draft};
  checker.shapes();
  checker.drives();
}

}  // namespace rdm::import
