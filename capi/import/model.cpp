#include "model.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <set>

#include "latin.hpp"

namespace rdm::import {
namespace {

constexpr size_t kMostRows = 4096;     // of shapes, of pairs: so too
constexpr size_t kLongestName = 25;    // what rdm_robot_create takes
constexpr double kReachAngle = 0.2;    // rad off the target where kp gives the whole effort
constexpr double kReachSlide = 0.02;   // m
constexpr double kMostGain = 1e6;      // what rdm_robot_create takes
constexpr double kPointRadius = 0.01;  // of a root whose mass is in one point; it stands, nothing feels them
constexpr double kGravity = 9.81;

// Letters (of other scripts: as latin() has them), digits, '_', '-', '+'; not empty, not too long.
std::string fitting_name(const std::string& name, const char* otherwise) {
  std::string out;
  for (const char c : latin(name))
    out += std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_-+", c) ? c : '_';
  if (out.empty()) out = otherwise;
  if (out.size() > kLongestName) out = out.substr(out.size() - kLongestName);  // endings tell more
  return out;
}

// Makes names unique: a name that is used already gets the next number of its stem. The number is remembered by
// stem, so many equal names cost no quadratic search.
class Namer {
 public:
  Namer(Draft* out, const char* what) : out_(out), what_(what) {}
  const char* give(const std::string& name, const char* otherwise, int line) {
    const char* given = quiet(name, otherwise);
    if (given != name && !name.empty())
      out_->note(RDM_NOTE_CHANGED, line, "%s %s was renamed to %s", what_, clean(name).c_str(), given);
    return given;
  }
  const char* quiet(const std::string& name, const char* otherwise) {
    const std::string stem = fitting_name(name, otherwise);
    std::string out = stem;
    if (!taken_.insert(folded(out)).second) {
      int& next = next_.emplace(folded(stem), 2).first->second;
      do {
        const std::string tail = '_' + std::to_string(next++);
        out = stem.substr(0, kLongestName - tail.size()) + tail;
      } while (!taken_.insert(folded(out)).second);
    }
    return out_->keep(out);
  }

 private:
  static std::string folded(std::string name) {  // as names are compared
    for (char& c : name) c = c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return name;
  }
  Draft* out_;
  const char* what_;
  std::set<std::string> taken_;
  std::map<std::string, int> next_;  // of a stem
};

struct Builder {
  const Model& in;
  const Options& options;
  Draft* out;
  Places places;
  std::vector<Place> of_body;
  std::vector<Mass> masses;  // by row; of the root apart
  Mass root;
  std::vector<const JointIn*> joints;     // by row
  std::vector<const BodyIn*> bodies;      // by row
  std::vector<const ShapeIn*> shapes;     // by row of shapes
  std::map<std::string, int32_t> row_of;  // joint name
  std::map<std::string, double> moved;    // joint: by how much its 0 is moved

  double moved_of(const std::string& joint) const {
    const auto found = moved.find(joint);
    return found == moved.end() ? 0 : found->second;
  }

  int32_t row(const std::string& joint, const Element& e) const {
    const auto found = row_of.find(joint);
    if (found != row_of.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [name, r] : row_of) names.push_back(name);
    refuse_at(RDM_ERROR_NOT_FOUND, e, "there is no joint %s%s", clean(joint).c_str(),
              nearest_hint(joint, names).c_str());
  }

  // Couplings with chains resolved: a joint that follows a follower gets the ratio and offset to the last leader.
  std::vector<CouplingIn> resolved() {
    std::map<std::string, const CouplingIn*> by;
    for (const CouplingIn& c : in.couplings) {
      if (!by.emplace(c.follower, &c).second)
        refuse_at(RDM_ERROR_ARGUMENT, *c.element, "joint %s follows two other joints",
                  clean(c.follower).c_str());
    }
    std::vector<CouplingIn> all;
    for (const CouplingIn& first : in.couplings) {
      CouplingIn c = first;
      for (size_t steps = 0; by.count(c.leader); ++steps) {
        if (steps > by.size() || c.leader == c.follower)
          refuse_at(RDM_ERROR_ARGUMENT, *c.element, "joint %s follows itself", clean(c.follower).c_str());
        const CouplingIn& next = *by[c.leader];
        c.offset += c.ratio * next.offset;
        c.slack += std::abs(c.ratio) * next.slack;
        c.ratio *= next.ratio;
        c.leader = next.leader;
      }
      if (c.leader == c.follower)
        refuse_at(RDM_ERROR_ARGUMENT, *c.element, "joint %s follows itself", clean(c.follower).c_str());
      all.push_back(c);
    }
    return all;
  }

  // First of all, because later steps compare all joints with all others.
  void count_joints() const {
    size_t count = 0;
    for (const BodyIn& b : in.bodies)
      for (const JointIn& j : b.joints)
        if (++count > RDM_MAX_LINKS)
          refuse_at(RDM_ERROR_RANGE, *j.element, "there are more than %d joints that move", RDM_MAX_LINKS);
    if (in.couplings.size() > kMostRows)
      refuse_at(RDM_ERROR_RANGE, *in.couplings[kMostRows].element, "there are more than %zu couplings",
                kMostRows);
  }

  void add_links() {
    Namer links{out, "link"}, names{out, "joint"};
    for (size_t b = 0; b < in.bodies.size(); ++b) {
      const BodyIn& body = in.bodies[b];
      Place at;
      if (b > 0) {
        const Place& parent = of_body[static_cast<size_t>(body.parent)];
        at = {parent.row, parent.X * body.X};
      }
      for (size_t k = 0; k < body.joints.size(); ++k) {
        const JointIn& j = body.joints[k];
        const double zero = moved_of(j.name);
        const double ahead = zero - j.turned;
        rdm_robot_link l{};
        Pose X = at.X * Pose{j.at, {}};
        X = X * (j.slides ? Pose{ahead * j.axis, {}} : Pose{{}, axis_angle(j.axis, ahead)});
        put(X.p, l.pose.p);
        put(X.q, l.pose.q);
        put(j.axis, l.axis);
        l.parent = at.row;
        l.kind = j.slides ? RDM_JOINT_PRISMATIC : RDM_JOINT_REVOLUTE;
        l.lower = j.lower - zero;
        l.upper = j.upper - zero;
        if (!(l.lower < l.upper))
          refuse_at(RDM_ERROR_RANGE, *j.element, "the range [%g, %g] is empty", j.lower, j.upper);
        l.velocity = j.velocity;
        l.friction = j.friction;
        if (j.slides && j.armature > 0)
          out->note(RDM_NOTE_DROPPED, j.element->line,
                    "joint %s: the armature of a sliding joint was dropped", clean(j.name).c_str());
        l.armature = j.slides ? 0 : j.armature;
        const bool last = k + 1 == body.joints.size();
        const int line = body.element->line;
        l.name = links.give(last ? body.name : body.name + '_' + j.name, "link", line);
        l.joint = names.give(j.name.empty() ? body.name + "_joint" : j.name, "joint", j.element->line);
        const auto row = static_cast<int32_t>(out->links.size());
        if (!j.name.empty() && !row_of.emplace(j.name, row).second)
          refuse_at(RDM_ERROR_ARGUMENT, *j.element, "joint %s occurs twice", clean(j.name).c_str());
        out->links.push_back(l);
        masses.push_back({});
        joints.push_back(&j);
        bodies.push_back(&body);
        at = {row, {-1 * j.at, {}}};
      }
      of_body.push_back(at);
      (at.row < 0 ? root : masses[static_cast<size_t>(at.row)]) =
          (at.row < 0 ? root : masses[static_cast<size_t>(at.row)]) + at.X * body.mass;
      places.emplace(body.name, at);
      if (b > 0 && body.joints.empty() && !body.name.empty())
        out->note(RDM_NOTE_CHANGED, body.element->line, "%s is fixed and was merged into %s",
                  clean(body.name).c_str(),
                  at.row < 0 ? "the root" : out->links[static_cast<size_t>(at.row)].name);
      if (at.row >= 0 && !body.joints.empty())
        places.emplace(out->links[static_cast<size_t>(at.row)].name, at);
    }
    if (out->links.empty()) refuse_at(RDM_ERROR_ARGUMENT, *in.bodies[0].element, "no joint moves");
    for (const FrameIn& f : in.frames) {
      const Place& body = of_body[static_cast<size_t>(f.body)];
      places.emplace(f.name, Place{body.row, body.X * f.X});
    }
  }

  void add_masses() {
    for (size_t r = 0; r < masses.size(); ++r) {
      rdm_robot_link& l = out->links[r];
      const Mass& m = masses[r];
      l.mass = m.mass;
      put(m.com, l.com);
      give_moment(m.moment, l.moment);
      if (m.mass > 0) {
        const auto p = principal(m.moment, nullptr);
        if (!(*std::min_element(p.begin(), p.end()) > 0))
          refuse_at(RDM_ERROR_ARGUMENT, *bodies[r]->element, "it moves, but its moments of inertia are 0");
        continue;
      }
      const bool carries =
          std::any_of(out->links.begin(), out->links.end(),
                      [&](const rdm_robot_link& other) { return other.parent == static_cast<int32_t>(r); });
      if (!carries)
        refuse_at(RDM_ERROR_RANGE, *bodies[r]->element, "it moves, but has no mass%s", in.massless_hint);
    }
    if (!(root.mass > 0) && root.moment != M3{}) {  // it stands: nothing feels them
      out->note(RDM_NOTE_DROPPED, in.bodies[0].element->line,
                "the root's moments of inertia were dropped, as it has no mass");
      root.moment = {};
    }
    if (root.mass > 0) {
      const auto p = principal(root.moment, nullptr);
      if (!(*std::max_element(p.begin(), p.end()) > 0)) {
        root.moment = solid(Primitive{RDM_SHAPE_SPHERE, {kPointRadius, 0, 0}, {}}).moment;
        const double factor = root.mass / volume_of({RDM_SHAPE_SPHERE, {kPointRadius, 0, 0}, {}});
        for (auto& row : root.moment)
          for (double& x : row) x *= factor;
        out->note(RDM_NOTE_GUESSED, in.bodies[0].element->line,
                  "the root: it got the moments of inertia of a ball with a radius of %g m", kPointRadius);
      }
    }
    out->def.root_mass = root.mass;
    put(root.com, out->def.root_com);
    give_moment(root.moment, out->def.root_moment);
  }
  static void give_moment(const M3& m, double* out) {
    out[0] = m[0][0], out[1] = m[1][1], out[2] = m[2][2], out[3] = m[0][1], out[4] = m[0][2],
    out[5] = m[1][2];
  }

  void add_shapes() {
    Namer names{out, "shape"};
    for (size_t b = 0; b < in.bodies.size(); ++b) {
      int32_t count = 0;
      for (const ShapeIn& s : in.bodies[b].shapes) {
        if (out->shapes.size() == kMostRows)
          refuse_at(RDM_ERROR_RANGE, *s.element, "there are more than %zu shapes", kMostRows);
        rdm_robot_shape o{};
        const Place& at = of_body[b];
        const Pose X = at.X * s.shape.X;
        std::string name = s.name;
        if (name.empty()) {  // no note: the file has no name for it
          const std::string body = at.row < 0 && b == 0 ? "root" : in.bodies[b].name;
          name = count == 0 ? body : body + '_' + std::to_string(count + 1);
          o.name = names.quiet(name, "shape");
        } else {
          o.name = names.give(name, "shape", s.element->line);
        }
        ++count;
        o.link = at.row;
        o.kind = s.shape.kind;
        put(s.shape.size, o.size);
        put(X.p, o.pose.p);
        put(X.q, o.pose.q);
        std::copy(s.color.begin(), s.color.end(), o.color);
        o.color[3] = 255;
        out->shapes.push_back(o);
        shapes.push_back(&s);
        shape_body.push_back(b);
      }
    }
  }
  std::vector<size_t> shape_body;

  void add_couplings(const std::vector<CouplingIn>& all) {
    for (const CouplingIn& c : all) {
      rdm_robot_coupling o{};
      o.link = row(c.follower, *c.element);
      o.other = row(c.leader, *c.element);
      o.ratio = c.ratio;
      o.slack = c.slack;
      if (c.offset != 0)
        out->note(RDM_NOTE_CHANGED, c.element->line, "joint %s: its zero was moved by %g",
                  clean(c.follower).c_str(), c.offset);
      out->couplings.push_back(o);
    }
  }

  bool follows(int32_t link) const {
    return std::any_of(out->couplings.begin(), out->couplings.end(),
                       [&](const rdm_robot_coupling& c) { return c.link == link; });
  }

  void add_drives() {
    const auto q = home_of(*out);
    const auto felt = felt_inertia(*out, q);
    const auto poses = link_poses(*out, q);
    std::vector<double> drawn;  // joints as the file draws its bodies
    for (const JointIn* j : joints) drawn.push_back(j->turned - moved_of(j->name));
    const auto felt_as_drawn = felt_inertia(*out, drawn);
    for (size_t r = 0; r < joints.size(); ++r) {
      const JointIn& j = *joints[r];
      rdm_robot_link& l = out->links[r];
      l.effort = j.effort;
      if (!(l.effort > 0))  // the joint that it follows moves it, so its effort counts
        for (const rdm_robot_coupling& c : out->couplings)
          if (c.link == static_cast<int32_t>(r) && joints[static_cast<size_t>(c.other)]->effort > 0) {
            l.effort = joints[static_cast<size_t>(c.other)]->effort;
            out->note(RDM_NOTE_GUESSED, j.element->line,
                      "joint %s: effort %.4g, that of the joint that it follows", l.joint, l.effort);
          }
      if (!(l.effort > 0)) {  // twice the weight of what it carries at arm's length
        double load = 0;
        for (size_t k = 0; k < out->links.size(); ++k)
          if (is_below(*out, static_cast<int32_t>(k), static_cast<int32_t>(r)))
            load += out->links[k].mass * kGravity *
                    (j.slides ? 1 : norm(poses[k] * vec(out->links[k].com) - poses[r].p));
        l.effort = std::max(2 * load, 0.1);
        out->note(RDM_NOTE_GUESSED, j.element->line,
                  "joint %s: effort %.4g, twice what holds the weight it carries", l.joint, l.effort);
      }
      const double reach = j.slides ? kReachSlide : kReachAngle;
      l.kp = j.kp >= 0 ? j.kp : std::min(l.effort / reach, kMostGain);
      const double damping = std::min(j.damping, std::max(kMostGain - std::max(j.kd, 0.0), 0.0));
      if (damping < j.damping)
        out->note(RDM_NOTE_CHANGED, j.element->line,
                  "joint %s: damping %g was reduced to %g, the largest that is allowed", l.joint, j.damping,
                  damping);
      l.kd = std::max(j.kd, 0.0) + damping;
      if (j.damping_ratio > 0) l.kd += j.damping_ratio * 2 * std::sqrt(l.kp * felt_as_drawn[r]);
      if (j.kp < 0 || l.kd == 0) l.kd = std::max(l.kd, 2 * std::sqrt(l.kp * felt[r]));
      if (j.kp < 0)
        out->note(RDM_NOTE_GUESSED, j.element->line, "joint %s: kp %.4g, kd %.4g from its effort and inertia",
                  l.joint, l.kp, l.kd);
      add_curve(j, static_cast<int32_t>(r));
    }
  }

  // An actuator with a narrower range than its joint: a curve maps commands of -1 to 1 onto that range.
  void add_curve(const JointIn& j, int32_t row) {
    const rdm_robot_link& l = out->links[static_cast<size_t>(row)];
    if (!j.has_command || follows(row)) return;
    const double low = std::max(j.command_low, l.lower), high = std::min(j.command_high, l.upper);
    if (!(low < high))
      refuse_at(RDM_ERROR_RANGE, *j.element,
                "its actuator's range [%g, %g] is not within the joint's [%g, %g]", j.command_low,
                j.command_high, l.lower, l.upper);
    if (low - l.lower < 1e-6 && l.upper - high < 1e-6) return;
    rdm_robot_curve c{};
    c.link = c.driver = row;
    c.num_knots = 2;
    c.command[0] = -1, c.command[1] = 1;
    c.angle[0] = low, c.angle[1] = high;
    out->curves.push_back(c);
  }

  void add_pairs() {
    const auto poses = link_poses(*out, home_of(*out));
    const auto parent = [&](int32_t link) {
      return link >= 0 ? out->links[static_cast<size_t>(link)].parent : RDM_LINK_NONE;
    };
    std::set<std::pair<std::string, std::string>> excluded;
    for (const auto& [x, y] : in.excluded) excluded.emplace(std::min(x, y), std::max(x, y));
    const auto is_excluded = [&](size_t a, size_t b) {
      if (excluded.empty()) return false;
      const std::string &x = in.bodies[shape_body[a]].name, &y = in.bodies[shape_body[b]].name;
      return excluded.count({std::min(x, y), std::max(x, y)}) > 0;
    };
    std::vector<Primitive> at_home;
    for (const rdm_robot_shape& s : out->shapes) {
      at_home.push_back(primitive_of(s));
      at_home.back().X = pose_of(poses, s.link) * at_home.back().X;
    }
    std::map<std::pair<int32_t, int32_t>, int> overlapping;  // links: shapes
    for (size_t b = 0; b < out->shapes.size(); ++b)
      for (size_t a = 0; a < b; ++a) {
        const int32_t la = out->shapes[a].link, lb = out->shapes[b].link;
        if (la == lb || parent(la) == lb || parent(lb) == la || is_excluded(a, b)) continue;
        if (!(shapes[a]->contype & shapes[b]->conaffinity) && !(shapes[b]->contype & shapes[a]->conaffinity))
          continue;
        const Primitive &x = at_home[a], &y = at_home[b];
        if (touch(x, y))
          ++overlapping[{std::min(la, lb), std::max(la, lb)}];
        else if (out->pairs.size() < kMostRows)
          out->pairs.push_back({static_cast<int32_t>(a), static_cast<int32_t>(b)});
        else
          ++left_out;
      }
    const auto name = [&](int32_t link) {
      return link < 0 ? "root" : out->links[static_cast<size_t>(link)].name;
    };
    for (const auto& [pair, count] : overlapping)
      out->note(RDM_NOTE_CHANGED, 0, "%s and %s overlap in the home pose: %d pair%s of shapes cannot collide",
                name(pair.first), name(pair.second), count, count == 1 ? "" : "s");
    if (left_out)
      out->note(RDM_NOTE_CHANGED, 0, "%zu pairs of shapes beyond the limit of %zu cannot collide", left_out,
                kMostRows);
  }
  size_t left_out = 0;

  void add_home() {
    if (in.home.empty()) return;
    for (const rdm_robot_link& l : out->links) out->home.push_back(std::clamp(0.0, l.lower, l.upper));
    for (const auto& [joint, q] : in.home) {
      const auto found = row_of.find(joint);
      if (found == row_of.end()) continue;
      const auto r = static_cast<size_t>(found->second);
      out->home[r] = std::clamp(q - moved_of(joint), out->links[r].lower, out->links[r].upper);
    }
  }
};

}  // namespace

void check_mass(const Element& e, const std::string& what, bool mend, Mass* m, Draft* out) {
  if (!(m->mass > 0)) refuse_at(RDM_ERROR_RANGE, e, "%s: the mass %g is not above 0", what.c_str(), m->mass);
  M3 axes{};
  const auto p = principal(m->moment, &axes);
  const double least = *std::min_element(p.begin(), p.end()), sum = p[0] + p[1] + p[2],
               most = *std::max_element(p.begin(), p.end());
  if (most == 0 && least == 0) return;  // a point
  const double lacks = std::max({0.0, 2 * most - sum, 1e-3 * most - least});
  const bool positive = least > 0, triangle = sum - most >= most * (1 - 1e-6);
  if (positive && triangle) return;
  if (!mend)
    refuse_at(RDM_ERROR_ARGUMENT, e, "%s: the principal moments of inertia %g, %g, %g %s", what.c_str(), p[0],
              p[1], p[2], positive ? "violate the triangle inequality" : "are not all above 0");
  if (!(most > 0)) refuse_at(RDM_ERROR_ARGUMENT, e, "%s: no moment of inertia is above 0", what.c_str());
  for (size_t k = 0; k < 3; ++k) m->moment[k][k] += lacks;
  out->note(RDM_NOTE_CHANGED, e.line,
            "%s: principal moments %g, %g, %g violate the triangle inequality: %g was added to each",
            what.c_str(), p[0], p[1], p[2], lacks);
}

Primitive primitive_of(const rdm_robot_shape& s) {
  return {s.kind, vec(s.size), {vec(s.pose.p), normalized(turn(s.pose.q))}};
}

std::vector<Pose> link_poses(const Draft& d, const std::vector<double>& q) {
  std::vector<Pose> out;
  for (size_t i = 0; i < d.links.size(); ++i) {
    const rdm_robot_link& l = d.links[i];
    const V3 axis = vec(l.axis);
    const Pose moved =
        l.kind == RDM_JOINT_PRISMATIC ? Pose{q[i] * axis, {}} : Pose{{}, axis_angle(axis, q[i])};
    out.push_back(pose_of(out, l.parent) * Pose{vec(l.pose.p), normalized(turn(l.pose.q))} * moved);
  }
  return out;
}

std::vector<double> home_of(const Draft& d) {
  if (!d.home.empty()) return d.home;
  std::vector<double> q;
  for (const rdm_robot_link& l : d.links) q.push_back(std::clamp(0.0, l.lower, l.upper));
  return q;
}

bool is_below(const Draft& d, int32_t row, int32_t ancestor) {
  while (row > ancestor) row = d.links[static_cast<size_t>(row)].parent;
  return row == ancestor;
}

std::vector<double> felt_inertia(const Draft& d, const std::vector<double>& q) {
  const auto poses = link_poses(d, q);
  std::vector<double> out;
  for (size_t r = 0; r < d.links.size(); ++r) {
    const V3 axis = poses[r].q * vec(d.links[r].axis);
    double sum = d.links[r].armature;
    for (size_t k = r; k < d.links.size(); ++k) {
      if (!is_below(d, static_cast<int32_t>(k), static_cast<int32_t>(r))) continue;
      const rdm_robot_link& l = d.links[k];
      if (d.links[r].kind == RDM_JOINT_PRISMATIC) {
        sum += l.mass;
        continue;
      }
      const double* m = l.moment;
      const M3 local{{{m[0], m[3], m[4]}, {m[3], m[1], m[5]}, {m[4], m[5], m[2]}}};
      const M3 all = turned(poses[k].q, local) + point_moment(l.mass, poses[k] * vec(l.com) - poses[r].p);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          sum += axis[i] * all[static_cast<size_t>(i)][static_cast<size_t>(j)] * axis[j];
    }
    out.push_back(sum);
  }
  return out;
}

void build(const Model& model, const Options& options, Draft* out) {
  Builder b{model, options, out, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}};
  b.count_joints();
  const auto couplings = b.resolved();
  for (const CouplingIn& c : couplings)
    if (c.offset != 0) b.moved[c.follower] = c.offset;
  // An offset of the leader's own zero is none: leaders follow nobody.
  b.add_links();
  b.add_masses();
  b.add_shapes();
  b.add_couplings(couplings);
  b.add_home();
  b.add_drives();
  b.add_pairs();
  const std::string name = fitting_name(options.name.empty() ? model.name : options.name, "robot");
  if (!options.name.empty() && name != options.name)
    refuse(RDM_ERROR_ARGUMENT,
           "config.name: %s: a name may have at most %zu letters, digits, '_', '-' and '+'",
           clean(options.name).c_str(), kLongestName);
  if (options.name.empty() && name != model.name)
    out->note(RDM_NOTE_CHANGED, model.bodies[0].element->line, "the robot %s was renamed to %s",
              clean(model.name).c_str(), name.c_str());
  out->def.name = out->keep(name);
  give_roles(b.places, options, out);
  out->bind();
}

}  // namespace rdm::import
