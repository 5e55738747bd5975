// rdm_scene_*: what a task's `build` makes a scene of, by name.
#include <cmath>
#include <cstdio>

#include "base/names.hpp"
#include "base/text.hpp"
#include "capi/joint.hpp"
#include "capi/own_task.hpp"
#include "capi/pose.hpp"

#if RDM_WITH_SIM
#include "env/options/simulation.hpp"
#include "objects/objects.hpp"
#include "physics/model/inertia.hpp"
#include "physics/model/validate.hpp"

using namespace rdm;
using namespace rdm::capi;

namespace {

constexpr size_t kFirstBodySize = sizeof(rdm_body_def), kFirstRobotSize = sizeof(rdm_scene_robot),
                 kFirstLawSize = sizeof(rdm_contact_law);
constexpr int32_t kMostShapes = 256, kMostThings = 1024;
constexpr double kCentred = 1e-6;   // m
constexpr double kNoFriction = -1;  // of a material that no object brought

void need_whole(const rdm_scene* scene) {
  need_handle(scene);
  if (scene->failure.code != Code::kOk) throw scene->failure;
}

void need_open(const rdm_scene* scene) {
  need_whole(scene);
  if (scene->complete)
    fail(Code::kState,
         "scene: it is complete; nothing can be added or set after the first find, touch or joint");
}

void need_name(const char* name, const char* what) {
  if (!name) fail(Code::kArgument, "%s is NULL", what);
  if (!*name || std::strlen(name) >= kNameSize)
    fail(Code::kRange, "%s: %s must have 1 to %d characters", what, Quoted(name).text, kNameSize - 1);
  if (!is_clean_text(name)) fail(Code::kArgument, "%s: it has control characters, or is not UTF-8", what);
}

template <class Rows, class NameOf>
int32_t find_name(const Rows& rows, NameOf&& name_of, const char* name) {
  int32_t i = 0;
  for (const auto& row : rows) {
    if (std::strcmp(name_of(row), name) == 0) return i;
    ++i;
  }
  return -1;
}

[[noreturn]] void fail_unknown(const char* what, const char* name, const Vector<const char*>& names) {
  fail(Code::kNotFound, "%s %s: unknown%s", what, Quoted(name).text,
       Nearest(name, names.data(), static_cast<int32_t>(names.size())).text);
}

const OptionSpec& find_option(const Options& options, const char* key) {
  Vector<const char*> names;
  for (int32_t i = 0; i < options.count(); ++i) {
    if (same_name(options.spec(i).key, key)) return options.spec(i);
    names.push_back(options.spec(i).key);
  }
  fail_unknown("option", key, names);
}

int32_t find_material(const rdm_scene& scene, const char* name) {
  if (!name) return 0;
  const auto text = [](const Name& n) { return n.text; };
  const int32_t i = find_name(scene.materials, text, name);
  if (i >= 0) return i;
  Vector<const char*> names;
  for (const Name& n : scene.materials) names.push_back(n.text);
  fail_unknown("material", name, names);
}

// Of bodies and robots.
void need_new_name(const rdm_scene& scene, const char* name) {
  const bool taken = find_name(
                         scene.robots, [](const PlacedRobot& r) { return r.name.text; }, name) >= 0 ||
                     find_name(
                         scene.def.bodies, [](const BodyDef& b) { return b.name.text; }, name) >= 0;
  if (taken) fail(Code::kArgument, "scene: the name %s is already used", Quoted(name).text);
}

ShapeDef read_shape(const rdm_scene& scene, const rdm_shape_def& in, const char* owner) {
  const char* name = in.name ? in.name : owner;
  need_name(name, "shape.name");
  ShapeDef s;
  s.name = name;
  s.material = find_material(scene, in.material);
  s.kind = static_cast<ShapeKind>(in.kind);
  s.X_LS = from_abi(in.pose);
  s.collides = in.seen_only == 0;
  if (in.color[0] || in.color[1] || in.color[2] || in.color[3]) std::copy_n(in.color, 3, s.color);
  if (in.kind != RDM_SHAPE_HULL) {
    s.size = vec(in.size);
    return s;
  }
  if (in.num_points < 4 || in.num_points > kMaxHullPoints)
    fail(Code::kRange, "shape %s: num_points: %d is outside [4, %d]", name, in.num_points, kMaxHullPoints);
  if (!in.points) fail(Code::kArgument, "shape %s: points is NULL", name);
  for (int32_t i = 0; i < in.num_points; ++i) s.points.push_back(vec(in.points + 3 * i));
  return s;
}

// Of all shapes, solid and of one density; where two overlap, both count.
Inertia inertia_of(const BodyDef& body, double mass) {
  Inertia sum = shapes_inertia(body.shapes.data(), static_cast<int32_t>(body.shapes.size()), mass);
  if (norm(sum.com) > kCentred)
    fail(
        Code::kArgument,
        "body %s: its shapes' centre of mass is at (%.6g, %.6g, %.6g), not at the origin: move them, or give "
        "moments",
        body.name.text, sum.com.x, sum.com.y, sum.com.z);
  sum.com = {};
  return sum;
}

void add_material(rdm_scene* scene, const char* name, double friction) {
  if (scene->materials.size() == kMaxMaterials)
    fail(Code::kRange, "material %s: there are more than %d materials", Quoted(name).text, kMaxMaterials);
  scene->frictions.reserve(scene->frictions.size() + 1);  // both grow, or none
  scene->materials.push_back(name);
  scene->frictions.push_back(friction);
}

// The scene's material of that name, or a new one with its friction on all that are there.
int32_t material_of(rdm_scene* scene, const ObjectMaterial& own) {
  const int32_t known = find_name(
      scene->materials, [](const Name& n) { return n.text; }, own.name);
  if (known >= 0) return known;
  const auto added = static_cast<int32_t>(scene->materials.size());
  add_material(scene, own.name, own.friction);
  for (int32_t i = 0; i <= added; ++i) {
    const double other = scene->frictions[static_cast<size_t>(i)];
    Friction f;
    f.mu = other < 0 ? own.friction : std::min(own.friction, other);
    scene->def.friction[i][added] = scene->def.friction[added][i] = f;
  }
  return added;
}

void place_robot(rdm_scene* scene, PlacedRobot* placed, int32_t articulation) {
  const Robot& robot = placed->robot();
  const Scene& s = scene->scene;
  const int32_t first = s.link_offset[static_cast<size_t>(articulation)];
  for (int32_t i = 0; i < robot.num_actuated(); ++i) {
    const int32_t link = robot.actuated(i);
    const JointDef& joint = s.link(first + link).joint;
    const double velocity = robot.links[link].velocity;
    placed->commands.push_back(
        {first + link, joint.lower, joint.upper,
         velocity > 0 ? velocity * s.control_dt() : std::numeric_limits<double>::infinity(),
         robot.curve(link)});
  }
  for (const RobotCurve& c : robot.curves)
    if (c.driver != c.link) placed->followers.push_back({first + c.link, robot.action_of(c.driver), &c});
}

void need_unique_shapes(const Scene& scene) {
  for (size_t i = 0; i < scene.shapes.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      if (scene.shapes[k].def.name == scene.shapes[i].def.name.text)
        fail(Code::kArgument, "shape %s occurs twice", scene.shapes[i].def.name.text);
}

// The name of the body or robot that carries a shape, "" of what stands still.
const char* owner_of(const rdm_scene& scene, const SceneShape& shape) {
  if (shape.articulation >= 0) return scene.robots[static_cast<size_t>(shape.articulation)].name.text;
  if (shape.carrier == Carrier::kBody)
    return scene.scene.def.bodies[static_cast<size_t>(shape.index)].name.text;
  return "";
}

void mark(const rdm_scene& scene, const char* pattern, const char* what, uint8_t bit,
          Vector<uint8_t>* sides) {
  if (!pattern) fail(Code::kArgument, "%s is NULL", what);
  bool found = false;
  const auto& shapes = scene.scene.shapes;
  for (size_t i = 0; i < shapes.size(); ++i)
    if (name_matches(pattern, shapes[i].def.name.text) || name_matches(pattern, owner_of(scene, shapes[i]))) {
      (*sides)[i] |= bit;
      found = true;
    }
  if (found) return;
  Vector<const char*> names;
  for (const SceneShape& s : shapes) names.push_back(s.def.name.text);
  for (const PlacedRobot& r : scene.robots) names.push_back(r.name.text);
  for (const BodyDef& b : scene.scene.def.bodies) names.push_back(b.name.text);
  fail_unknown(what, pattern, names);
}

Vector<const char*> names_of(const rdm_scene& scene, int32_t part) {
  Vector<const char*> names;
  const Scene& s = scene.scene;
  switch (part) {
    case RDM_SCENE_ROBOT:
      for (const PlacedRobot& r : scene.robots) names.push_back(r.name.text);
      break;
    case RDM_SCENE_BODY:
      for (const BodyDef& b : s.def.bodies) names.push_back(b.name.text);
      break;
    case RDM_SCENE_LINK:
      for (int32_t i = 0; i < s.num_links; ++i) names.push_back(s.link(i).name.text);
      break;
    case RDM_SCENE_JOINT:
      for (int32_t i = 0; i < s.num_links; ++i) names.push_back(s.link(i).joint.name.text);
      break;
    case RDM_SCENE_SHAPE:
      for (const SceneShape& shape : s.shapes) names.push_back(shape.def.name.text);
      break;
    case RDM_SCENE_SENSOR:
      for (const int32_t link : s.sensors) names.push_back(s.link(link).name.text);
      break;
    case RDM_SCENE_MATERIAL:
      for (const Name& n : scene.materials) names.push_back(n.text);
      break;
    default:
      fail(Code::kRange, "part: %d is outside [0, 6]", part);
  }
  return names;
}

}  // namespace

void rdm::capi::begin_scene(const OwnTask& own, const Options& options, rdm_scene* scene) {
  scene->options = &options;
  scene->def.gravity = gravity_from(options);
  scene->def.solver = solver_from(options);
  scene->draws.add(drawn_gravity(options), Drawn::kGravity);
  scene->def.adjustable = !scene->draws.empty();
  scene->materials.push_back("default");
  scene->frictions.push_back(kNoFriction);
  scene->fields = own.fields;
  scene->hold = own.hold;
  scene->mean = own.mean;
}

namespace {
void make_complete(rdm_scene* scene) {
  scene->def.num_materials = static_cast<int32_t>(scene->materials.size());
  scene->scene = make_scene(std::move(scene->def));
  scene->def = {};
  need_unique_shapes(scene->scene);
  int32_t articulation = 0;
  for (PlacedRobot& robot : scene->robots) place_robot(scene, &robot, articulation++);
}
}  // namespace

void rdm::capi::complete_scene(rdm_scene* scene) {
  need_whole(scene);
  if (scene->complete) return;
  scene->complete = true;
  const Code code = guard([&] { make_complete(scene); });
  if (code == Code::kOk) return;
  scene->failure.code = code;
  copy_text(scene->failure.text, sizeof scene->failure.text, last_error());
  throw scene->failure;
}

rdm_result rdm_scene_get_number(rdm_scene* scene, const char* key, double* value) {
  return call_inside([&] {
    need_handle(scene);
    need(key, "key");
    need(value, "value");
    const Options& o = *scene->options;
    switch (find_option(o, key).kind) {
      case OptionKind::kNumber:
        *value = o.number(key);
        return;
      case OptionKind::kInteger:
        *value = o.integer(key);
        return;
      case OptionKind::kFlag:
        *value = o.flag(key);
        return;
      case OptionKind::kText:
        fail(Code::kArgument, "option %s is a text; call rdm_scene_get_text", key);
    }
  });
}

rdm_result rdm_scene_get_text(rdm_scene* scene, const char* key, const char** text) {
  return call_inside([&] {
    need_handle(scene);
    need(key, "key");
    need(text, "text");
    if (find_option(*scene->options, key).kind != OptionKind::kText)
      fail(Code::kArgument, "option %s is not a text; call rdm_scene_get_number", key);
    *text = scene->options->text(key);
  });
}

rdm_result rdm_scene_get_range(rdm_scene* scene, const char* key, double* low, double* high) {
  return call_inside([&] {
    need_handle(scene);
    need(key, "key");
    need(low, "low");
    need(high, "high");
    const OptionSpec& spec = find_option(*scene->options, key);
    if (spec.kind != OptionKind::kNumber && spec.kind != OptionKind::kInteger)
      fail(Code::kArgument, "option %s is neither number nor integer", key);
    const OptionRange range = scene->options->range(key);
    *low = range.low;
    *high = range.high;
  });
}

rdm_result rdm_scene_set_feedforward(rdm_scene* scene) {
  return call_inside([&] {
    need_open(scene);
    scene->def.feedforward = true;
  });
}

rdm_result rdm_scene_set_adjustable(rdm_scene* scene) {
  return call_inside([&] {
    need_open(scene);
    scene->def.adjustable = true;
  });
}

rdm_result rdm_scene_add_material(rdm_scene* scene, const char* name) {
  return call_inside([&] {
    need_open(scene);
    need_name(name, "material");
    if (find_name(
            scene->materials, [](const Name& n) { return n.text; }, name) >= 0)
      fail(Code::kArgument, "material %s occurs twice", Quoted(name).text);
    add_material(scene, name, kNoFriction);
  });
}

rdm_result rdm_scene_set_friction(rdm_scene* scene, const char* a, const char* b, double mu) {
  return call_inside([&] {
    need_open(scene);
    need(a, "a");
    need(b, "b");
    const int32_t i = find_material(*scene, a), k = find_material(*scene, b);
    const bool passes = mu == static_cast<double>(RDM_FRICTION_PASSES);
    if (!passes && !(mu >= 0 && mu <= 1000))
      fail(Code::kRange, "mu: %g is neither RDM_FRICTION_PASSES nor within [0, 1000]", mu);
    Friction f;
    f.passes = passes;
    if (!passes) f.mu = mu;
    scene->def.friction[i][k] = scene->def.friction[k][i] = f;
  });
}

rdm_result rdm_contact_law_init(rdm_contact_law* law, size_t size) {
  return call_inside([&] {
    rdm_contact_law d{};
    const ContactLaw usual;
    d.damping_ratio = usual.damping_ratio;
    d.impedance_min = usual.impedance_min;
    d.impedance_max = usual.impedance_max;
    d.impedance_width = usual.impedance_width;
    init_struct(law, size, kFirstLawSize, d, "law");
  });
}

rdm_result rdm_scene_set_contact_law(rdm_scene* scene, const char* a, const char* b,
                                     const rdm_contact_law* law) {
  return call_inside([&] {
    need_open(scene);
    need(a, "a");
    need(b, "b");
    const auto in = read_struct(law, kFirstLawSize, rdm_contact_law{}, "law");
    const int32_t i = find_material(*scene, a), k = find_material(*scene, b);
    ContactLaw l;
    l.restitution = in.restitution;
    l.torsional = in.torsional;
    l.rolling = in.rolling;
    l.time_constant = in.time_constant;
    l.damping_ratio = in.damping_ratio;
    l.impedance_min = in.impedance_min;
    l.impedance_max = in.impedance_max;
    l.impedance_width = in.impedance_width;
    l.pyramid = in.pyramid != 0;
    check_law(l);
    scene->def.laws[i][k] = scene->def.laws[k][i] = l;
  });
}

rdm_result rdm_scene_set_gravity(rdm_scene* scene, const double gravity[3]) {
  return call_inside([&] {
    need_open(scene);
    need(gravity, "gravity");
    const Vec3 g = vec(gravity);
    if (!(norm(g) <= 1000)) fail(Code::kRange, "gravity: it is not finite, or above 1000 m/s2");
    scene->def.gravity = g;
    scene->draws = {};
  });
}

rdm_result rdm_scene_robot_init(rdm_scene_robot* robot, size_t size) {
  return call_inside([&] {
    rdm_scene_robot d{};
    d.robot = -1;
    d.pose.q[3] = 1;
    d.filled = 1;
    init_struct(robot, size, kFirstRobotSize, d, "robot");
  });
}

rdm_result rdm_scene_add_robot(rdm_scene* scene, const rdm_scene_robot* robot, int32_t* index) {
  return call_inside([&] {
    need_open(scene);
    const auto in = read_struct(robot, kFirstRobotSize, rdm_scene_robot{}, "robot");
    need_name(in.name, "robot.name");
    need_new_name(*scene, in.name);
    if (scene->robots.size() == kMostThings)
      fail(Code::kRange, "robot %s: the scene has more than %d robots", in.name, kMostThings);
    PlacedRobot placed;
    placed.name = in.name;
    if (in.own) {
      const RobotCopy described = robot_from(in.own);
      check_robot(described.robot());
      placed.own = RobotCopy(described.robot());
      placed.of_scene = true;
    } else {
      if (in.robot < 0 || (in.robot == 0 && in.filled == 0))
        fail(Code::kArgument,
             "robot.robot of %s is not set: fill the struct by rdm_scene_robot_init, then set the number "
             "that rdm_robot_find gives",
             in.name);
      placed.listed = RobotRef(in.robot);
    }
    const Robot& r = placed.robot();
    const auto need_short = [&](const char* name) {
      if (name && std::strlen(in.name) + 1 + std::strlen(name) >= kNameSize)
        fail(Code::kRange, "robot %s: its name and %s together are longer than %d characters", in.name, name,
             kNameSize - 2);
    };
    for (const RobotLink& l : r.links) need_short(l.name), need_short(l.joint);
    for (const RobotShape& s : r.shapes) need_short(s.name);
    char prefix[kNameSize + 1];
    std::snprintf(prefix, sizeof prefix, "%s_", in.name);
    ArticulationDef def =
        make_articulation(r, in.left ? Side::kLeft : Side::kRight, from_abi(in.pose), prefix);
    def.name = in.name;
    def.free_base = in.free_base != 0;
    def.base_damping = in.base_damping;
    def.gravity = in.gravity != 0;
    const int32_t material = find_material(*scene, in.material);
    for (ArticulationShape& s : def.shapes) s.shape.material = material;
    scene->robots.reserve(scene->robots.size() + 1);  // both grow, or none
    scene->def.articulations.push_back(std::move(def));
    scene->robots.push_back(std::move(placed));
    if (index) *index = static_cast<int32_t>(scene->robots.size()) - 1;
  });
}

rdm_result rdm_scene_add_body(rdm_scene* scene, const rdm_body_def* body, int32_t* index) {
  return call_inside([&] {
    need_open(scene);
    const auto in = read_struct(body, kFirstBodySize, rdm_body_def{}, "body");
    need_name(in.name, "body.name");
    need_new_name(*scene, in.name);
    if (scene->def.bodies.size() == kMostThings)
      fail(Code::kRange, "body %s: the scene has more than %d bodies", in.name, kMostThings);
    if (in.num_shapes < 1 || in.num_shapes > kMostShapes)
      fail(Code::kRange, "body %s: num_shapes: %d is outside [1, %d]", in.name, in.num_shapes, kMostShapes);
    if (!in.shapes) fail(Code::kArgument, "body %s: shapes is NULL", in.name);
    if (!(in.mass > 0 && in.mass <= 1e6))
      fail(Code::kRange, "body %s: mass %g is not above 0 and up to 1e6", in.name, in.mass);
    BodyDef b;
    b.name = in.name;
    b.X_WB = from_abi(in.pose);
    b.linear_damping = in.linear_damping;
    b.angular_damping = in.angular_damping;
    b.gravity = in.weightless == 0;
    for (int32_t i = 0; i < in.num_shapes; ++i) b.shapes.push_back(read_shape(*scene, in.shapes[i], in.name));
    const bool given = std::any_of(in.moment, in.moment + 6, [](double m) { return m != 0; });
    if (given) {
      b.inertia.mass = in.mass;
      std::copy_n(in.moment, 6, b.inertia.moment);
    } else {
      b.inertia = inertia_of(b, in.mass);
    }
    validate_body(b, static_cast<int32_t>(scene->materials.size()));
    scene->def.bodies.push_back(std::move(b));
    if (index) *index = static_cast<int32_t>(scene->def.bodies.size()) - 1;
  });
}

rdm_result rdm_scene_add_object(rdm_scene* scene, int32_t object, const char* name, const rdm_pose* pose,
                                double scale, int32_t* index) {
  return call_inside([&] {
    need_open(scene);
    const ObjectRef ref(object);
    need_name(name, "name");
    need_new_name(*scene, name);
    need(pose, "pose");
    if (!(scale >= 0.05 && scale <= 20)) fail(Code::kRange, "scale: %g is outside [0.05, 20]", scale);
    if (scene->def.bodies.size() == kMostThings)
      fail(Code::kRange, "body %s: the scene has more than %d bodies", name, kMostThings);
    BodyDef body = make_object_body(*ref, name, from_abi(*pose), 0, scale, 0);
    scene->def.bodies.reserve(scene->def.bodies.size() + 1);
    const int32_t material = material_of(scene, ref->material);  // nothing fails behind it
    for (ShapeDef& s : body.shapes) s.material = material;
    scene->def.bodies.push_back(std::move(body));
    if (index) *index = static_cast<int32_t>(scene->def.bodies.size()) - 1;
  });
}

rdm_result rdm_scene_add_static(rdm_scene* scene, const rdm_shape_def* shape) {
  return call_inside([&] {
    need_open(scene);
    need(shape, "shape");
    ShapeDef s = read_shape(*scene, *shape, nullptr);
    if (scene->def.statics.size() == kMostThings)
      fail(Code::kRange, "shape %s: the scene has more than %d fixed shapes", s.name.text, kMostThings);
    validate_static(s, static_cast<int32_t>(scene->materials.size()));
    scene->def.statics.push_back(std::move(s));
  });
}

rdm_result rdm_scene_set_field(rdm_scene* scene, const char* field, size_t count) {
  return call_inside([&] {
    need_whole(scene);
    need(field, "field");
    if (count < 1 || count > kMostEntries)
      fail(Code::kRange, "count: %zu of field %s is outside [1, %d]", count, Quoted(field).text,
           kMostEntries);
    Vector<const char*> names;
    for (FieldSpec& f : scene->fields) {
      if (f.name == field) {
        f.count = static_cast<int32_t>(count);
        return;
      }
      names.push_back(f.name.text);
    }
    fail_unknown("field", field, names);
  });
}

rdm_result rdm_scene_set_actions(rdm_scene* scene, size_t count, const float* hold, const float* mean) {
  return call_inside([&] {
    need_whole(scene);
    check_action_dim(static_cast<int64_t>(count), "count");
    const auto n = static_cast<int32_t>(count);
    Vector<float> h, m;
    copy_actions(hold, n, "hold", &h);
    copy_actions(mean, n, "mean", &m);
    scene->hold = std::move(h);
    scene->mean = std::move(m);
  });
}

void* rdm_scene_user(const rdm_scene* scene) {
  return is_handle(scene) ? scene->user : nullptr;
}

rdm_result rdm_scene_find(rdm_scene* scene, int32_t part, const char* name, int32_t* index) {
  return call_inside([&] {
    need_handle(scene);
    need(name, "name");
    need(index, "index");
    complete_scene(scene);
    const Vector<const char*> names = names_of(*scene, part);
    const int32_t i = find_name(
        names, [](const char* n) { return n; }, name);
    constexpr const char* kParts[] = {"robot", "body", "link", "joint", "shape", "sensor", "material"};
    if (i < 0) fail_unknown(kParts[part], name, names);
    *index = i;
  });
}

rdm_result rdm_scene_joint_at(rdm_scene* scene, int32_t i, rdm_joint_info* io) {
  return call_inside([&] {
    need_handle(scene);
    complete_scene(scene);
    const Scene& s = scene->scene;
    need_index(i, s.num_links, "i");
    const JointDef& j = s.link(i).joint;
    rdm_joint_info o = joint_info(j, j.coupled_to >= 0);
    o.name = j.name.text;
    o.parent = s.frames[static_cast<size_t>(i)].parent;
    o.action = -1;
    const auto a = static_cast<size_t>(s.link_articulation[static_cast<size_t>(i)]);
    const auto& commands = scene->robots[a].commands;
    for (size_t k = 0; k < commands.size(); ++k)
      if (commands[k].joint == i) o.action = static_cast<int32_t>(k);
    write_struct(io, o, sizeof(rdm_joint_info), "io");
  });
}

rdm_result rdm_scene_add_touch(rdm_scene* scene, const char* a, const char* b, int32_t* group) {
  return call_inside([&] {
    need_handle(scene);
    need(group, "group");
    complete_scene(scene);
    const Scene& s = scene->scene;
    TouchGroup g;
    g.sides.assign(s.shapes.size(), 0);
    mark(*scene, a, "a", 1, &g.sides);
    mark(*scene, b, "b", 2, &g.sides);
    for (size_t k = 0; k < s.pairs.size(); ++k) {
      const uint8_t x = g.sides[static_cast<size_t>(s.pairs[k].a)],
                    y = g.sides[static_cast<size_t>(s.pairs[k].b)];
      if (((x & 1) && (y & 2)) || ((x & 2) && (y & 1))) g.pairs.push_back(static_cast<int32_t>(k));
    }
    scene->groups.push_back(std::move(g));
    *group = static_cast<int32_t>(scene->groups.size()) - 1;
  });
}
#endif
