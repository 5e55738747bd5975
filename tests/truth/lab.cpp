#include "lab.hpp"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <deque>

#include "table.hpp"

namespace truth {

V3 operator+(const V3& a, const V3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
V3 operator-(const V3& a, const V3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
V3 operator*(double s, const V3& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
double dot(const V3& a, const V3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
V3 cross(const V3& a, const V3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double norm(const V3& a) {
  return std::sqrt(dot(a, a));
}
V3 rotate(const V4& q, const V3& a) {
  const V3 u = {q[0], q[1], q[2]}, t = 2 * cross(u, a);
  return a + q[3] * t + cross(u, t);
}
V3 unrotate(const V4& q, const V3& a) {
  return rotate({-q[0], -q[1], -q[2], q[3]}, a);
}
V4 turn(const V3& axis, double angle) {
  V4 q;
  const V3 unit = (1 / norm(axis)) * axis;
  check(rdm_rotation(unit.data(), angle, q.data()));
  return q;
}
V3 vec(const double* a) {
  return {a[0], a[1], a[2]};
}
V3 vec(const float* a) {
  return {static_cast<double>(a[0]), static_cast<double>(a[1]), static_cast<double>(a[2])};
}

Shape sphere(double r) {
  Shape s;
  s.kind = RDM_SHAPE_SPHERE, s.size = {r, 0, 0};
  return s;
}
Shape box(double x, double y, double z) {
  Shape s;
  s.kind = RDM_SHAPE_BOX, s.size = {x, y, z};
  return s;
}
Shape capsule(double r, double half, const V4& q) {
  Shape s;
  s.kind = RDM_SHAPE_CAPSULE, s.size = {r, half, 0}, s.q = q;
  return s;
}
Shape cylinder(double r, double half, const V4& q) {
  Shape s = capsule(r, half, q);
  s.kind = RDM_SHAPE_CYLINDER;
  return s;
}
Shape hull(std::vector<V3> points) {
  Shape s;
  s.kind = RDM_SHAPE_HULL, s.points = std::move(points);
  return s;
}
Shape block(double x, double y, double z) {
  std::vector<V3> points;
  for (const double a : {-x, x})
    for (const double b : {-y, y})
      for (const double c : {-z, z}) points.push_back({a, b, c});
  return hull(points);
}
Shape plane() {
  Shape s;
  s.kind = RDM_SHAPE_PLANE, s.name = "ground";
  return s;
}

void check(rdm_result r) {
  if (r != RDM_OK) throw Failure(rdm_last_error());
}

namespace {

template <size_t N>
void copy(const std::array<double, N>& from, double* to) {
  std::copy(from.begin(), from.end(), to);
}

rdm_motion motion(const V3& p, const V4& q, const V3& v, const V3& w) {
  rdm_motion m;
  copy(p, m.pose.p), copy(q, m.pose.q), copy(v, m.v), copy(w, m.w);
  return m;
}

rdm_shape_def shape_def(const Shape& s) {
  rdm_shape_def d{};
  d.kind = s.kind, d.material = "m";
  if (!s.name.empty()) d.name = s.name.c_str();
  copy(s.size, d.size), copy(s.p, d.pose.p), copy(s.q, d.pose.q);
  d.num_points = static_cast<int32_t>(s.points.size());
  if (d.num_points > 0) d.points = s.points.front().data();
  return d;
}

}  // namespace

// What the library calls; no exception leaves it.
struct Lab::Calls {
  template <class F>
  static rdm_result run(void* user, F f) {
    Lab& lab = *static_cast<Lab*>(user);
    try {
      f(lab);
      return RDM_OK;
    } catch (const std::exception& e) {
      lab.error_ = e.what();
      return rdm_fail(RDM_ERROR_ARGUMENT, lab.error_.c_str());
    }
  }
  static rdm_result build(void* user, rdm_scene* scene, void*) {
    return run(user, [scene](Lab& lab) { lab.build(scene); });
  }
  static rdm_result reset(void* user, const void*, rdm_world* world, void*, rdm_random*) {
    return run(user, [world](Lab& lab) { lab.set(world), lab.look(world); });
  }
  static rdm_result control(void* user, const void*, rdm_world* world, void*, const float*) {
    return run(user, [world](Lab& lab) {
      if (lab.scene.control) lab.scene.control(lab, world);
    });
  }
  static rdm_result judge(void* user, const void*, rdm_world* world, void*, int32_t, rdm_verdict*) {
    return run(user, [world](Lab& lab) { lab.look(world); });
  }
  static rdm_result observe(void*, const void*, const rdm_world*, const void*, float* obs) {
    obs[0] = 0;
    return RDM_OK;
  }
};

Lab::Lab(Scene s) : scene(std::move(s)) {
  static std::atomic<int> count{0};
  name_ = text("lab%d", ++count);
  const rdm_field_def field{"none", "1", 1, 0, 0, 0};
  const rdm_cost_def cost{"cost", "none", -1};
  rdm_task_def d;
  check(rdm_task_def_init(&d, sizeof d));
  d.name = name_.c_str(), d.max_steps = 100000, d.action_dim = 1, d.user = this;
  d.fields = &field, d.num_fields = 1, d.costs = &cost, d.num_costs = 1;
  d.build = Calls::build, d.reset = Calls::reset, d.control = Calls::control;
  d.judge = Calls::judge, d.observe = Calls::observe;
  check(rdm_task_create(&task_, &d));
  try {
    rdm_pool_config c;
    check(rdm_pool_config_init(&c, sizeof c));
    c.task = name_.c_str(), c.autoreset = RDM_AUTORESET_OFF, c.settings = scene.settings.c_str();
    check(rdm_pool_create(&pool_, &c));
    rdm_buffers b{};
    b.struct_size = sizeof b;
    check(rdm_pool_get_buffers(pool_, &b));
    b.action[0] = 0;
    status_row_ = b.status;
    reset();
  } catch (...) {
    rdm_pool_destroy(pool_);
    rdm_task_destroy(task_);
    throw;
  }
}

Lab::~Lab() {
  rdm_pool_destroy(pool_);
  rdm_task_destroy(task_);
}

rdm_result Lab::build(rdm_scene* out) {
  check(rdm_scene_add_material(out, "m"));
  check(rdm_scene_set_friction(out, "m", "m", scene.friction));
  check(rdm_scene_set_gravity(out, scene.gravity.data()));
  if (scene.materials) scene.materials(out);
  if (scene.feedforward) check(rdm_scene_set_feedforward(out));
  joints_ = 0;
  int count = 0;
  for (const Robot& r : scene.robots) {
    const std::string name = text("r%d", count++);
    rdm_scene_robot s;
    check(rdm_scene_robot_init(&s, sizeof s));
    s.name = name.c_str(), s.material = "m";
    s.free_base = r.free_base, s.gravity = r.gravity, s.base_damping = r.base_damping;
    copy(r.p, s.pose.p), copy(r.q, s.pose.q);
    rdm_robot_def d;
    check(rdm_robot_def_init(&d, sizeof d));
    std::vector<rdm_robot_link> links;
    std::deque<std::string> names;
    std::vector<rdm_robot_shape> shapes;
    std::vector<rdm_robot_coupling> couplings;
    if (!r.known.empty()) {
      check(rdm_robot_find(r.known.c_str(), &s.robot));
      check(rdm_robot_get_def(s.robot, &d));
      joints_ += static_cast<size_t>(d.num_links);
    } else {
      for (const Link& l : r.links) {
        rdm_robot_link x{};
        x.name = names.emplace_back(text("a%zu", links.size())).c_str();
        x.joint = names.emplace_back(text("j%zu", links.size())).c_str();
        x.parent = l.parent, x.kind = l.kind, x.lower = l.lower, x.upper = l.upper;
        x.kp = l.kp, x.kd = l.kd, x.effort = l.effort, x.armature = l.armature, x.friction = l.friction;
        x.mass = l.mass;
        x.pose.q[3] = 1;
        copy(l.p, x.pose.p), copy(l.axis, x.axis), copy(l.com, x.com), copy(l.moment, x.moment);
        links.push_back(x);
      }
      for (const auto& [link, shape] : r.shapes) {
        rdm_robot_shape x{};
        x.name = names.emplace_back(text("s%zu", shapes.size())).c_str();
        x.link = link, x.kind = shape.kind;
        copy(shape.size, x.size), copy(shape.p, x.pose.p), copy(shape.q, x.pose.q);
        shapes.push_back(x);
      }
      for (const Coupling& c : r.couplings) couplings.push_back({c.link, c.other, c.ratio, 0});
      d.name = "own", d.links = links.data(), d.num_links = static_cast<int32_t>(links.size());
      d.shapes = shapes.data(), d.num_shapes = static_cast<int32_t>(shapes.size());
      d.couplings = couplings.data(), d.num_couplings = static_cast<int32_t>(couplings.size());
      d.num_commands = -1, d.num_pairs = 0;
      d.root_mass = r.root_mass;
      copy(r.root_com, d.root_com), copy(r.root_moment, d.root_moment);
      s.own = &d;
      joints_ += links.size();
    }
    check(rdm_scene_add_robot(out, &s, nullptr));
  }
  count = 0;
  for (const Body& b : scene.bodies) {
    const std::string name = text("b%d", count++);
    std::vector<rdm_shape_def> shapes;
    for (const Shape& s : b.shapes) shapes.push_back(shape_def(s));
    rdm_body_def d{};
    d.struct_size = sizeof d, d.name = name.c_str(), d.mass = b.mass;
    d.shapes = shapes.data(), d.num_shapes = static_cast<int32_t>(shapes.size());
    copy(b.p, d.pose.p), copy(b.q, d.pose.q), copy(b.moment, d.moment);
    check(rdm_scene_add_body(out, &d, nullptr));
  }
  count = 0;
  for (Shape s : scene.statics) {
    if (s.name.empty()) s.name = text("t%d", count++);
    const rdm_shape_def d = shape_def(s);
    check(rdm_scene_add_static(out, &d));
  }
  return RDM_OK;
}

void Lab::set(rdm_world* world) {
  for (size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& b = scene.bodies[i];
    const rdm_motion m = motion(b.p, b.q, b.v, b.w);
    check(rdm_world_set_body(world, static_cast<int32_t>(i), &m));
  }
  for (size_t i = 0; i < scene.robots.size(); ++i) {
    const Robot& r = scene.robots[i];
    const int32_t n = static_cast<int32_t>(r.q0.size()), k = static_cast<int32_t>(i);
    if (r.free_base) {
      const rdm_motion m = motion(r.p, r.q, r.v, r.w);
      check(rdm_world_set_base(world, k, &m));
    }
    if (n > 0) check(rdm_world_set_joints(world, k, r.q0.data(), r.qd0.empty() ? nullptr : r.qd0.data(), n));
  }
}

void Lab::look(const rdm_world* world) {
  bodies.resize(scene.bodies.size());
  links.resize(joints_);
  bases.resize(scene.robots.size());
  for (size_t i = 0; i < bodies.size(); ++i)
    check(rdm_world_get_body(world, static_cast<int32_t>(i), &bodies[i]));
  for (size_t i = 0; i < links.size(); ++i)
    check(rdm_world_get_link(world, static_cast<int32_t>(i), &links[i]));
  for (size_t i = 0; i < bases.size(); ++i)
    check(rdm_world_get_base(world, static_cast<int32_t>(i), &bases[i]));
  rdm_joints j{};
  j.struct_size = sizeof j;
  check(rdm_world_get_joints(world, &j));
  control_dt = j.control_dt;
  q.assign(j.q, j.q + joints_);
  qd.assign(j.qd, j.qd + joints_);
  torque.assign(j.torque, j.torque + joints_);
  size_t count = 0;
  check(rdm_world_get_contacts(world, nullptr, 0, &count));
  contacts.resize(count);
  check(rdm_world_get_contacts(world, contacts.data(), count, &count));
}

void Lab::reset() {
  status = 0, steps_ = 0;
  error_.clear();
  check(rdm_pool_reset(pool_, nullptr, nullptr));
}

void Lab::step(int n) {
  for (int i = 0; i < n; ++i) {
    check(rdm_pool_step(pool_));
    status |= status_row_[0];
    ++steps_;
    if (!error_.empty()) throw Failure(error_);
    if ((status & RDM_STATUS_DIVERGED) != 0) {
      char text[64];
      std::snprintf(text, sizeof text, "diverged after %.2f s", time());
      throw Failure(text);
    }
  }
}

V3 Lab::p(size_t body) const {
  return vec(bodies[body].pose.p);
}
V3 Lab::v(size_t body) const {
  return vec(bodies[body].v);
}
V3 Lab::w(size_t body) const {
  return vec(bodies[body].w);
}
V4 Lab::turned(size_t body) const {
  const double* q4 = bodies[body].pose.q;
  return {q4[0], q4[1], q4[2], q4[3]};
}

V3 Lab::force_on(int32_t shape) const {
  V3 sum{};
  for (const rdm_contact& c : contacts) {
    if (c.shape_a == shape) sum = sum + vec(c.force);
    if (c.shape_b == shape) sum = sum - vec(c.force);
  }
  return sum;
}

double Lab::deepest() const {
  double d = 0;
  for (const rdm_contact& c : contacts) d = std::max(d, static_cast<double>(c.depth));
  return d;
}

}  // namespace truth
