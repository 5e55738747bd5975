// rdm_object_*: the catalogue of objects, and those that a host describes.
#include "capi/handles.hpp"
#include "capi/pose.hpp"

#if RDM_WITH_SIM
#include "base/lasting.hpp"
#include "objects/objects.hpp"

using namespace rdm;
using namespace rdm::capi;

static_assert(RDM_MAX_SHAPES == kMaxObjectShapes);

namespace {

constexpr size_t kFirstObjectSize = sizeof(rdm_object_def);
constexpr uint8_t kGrey = 200;

rdm_object_def default_def() {
  rdm_object_def d{};
  d.friction = 0.5;
  return d;
}

// `points` takes a hull's.
ObjectShape shape_of(const rdm_shape_def& in, int32_t i, Vector<Vec3>* points) {
  ObjectShape s{};
  s.kind = static_cast<ShapeKind>(in.kind);
  s.size = {in.size[0], in.size[1], in.size[2]};
  const Pose X = from_abi(in.pose);
  s.p = X.p;
  s.q = X.q;
  const bool grey = !(in.color[0] || in.color[1] || in.color[2] || in.color[3]);
  for (int k = 0; k < 3; ++k) s.color[k] = grey ? kGrey : in.color[k];
  s.collides = in.seen_only == 0;
  if (in.kind != RDM_SHAPE_HULL) return s;
  s.size = {};
  if (in.num_points < 4 || in.num_points > kMaxHullPoints)
    fail(Code::kRange, "def.shapes[%d].num_points: %d is outside [4, %d]", i, in.num_points, kMaxHullPoints);
  if (!in.points) fail(Code::kArgument, "def.shapes[%d].points is NULL", i);
  for (int32_t k = 0; k < in.num_points; ++k)
    points->push_back({in.points[3 * k], in.points[3 * k + 1], in.points[3 * k + 2]});
  s.points = {points->data(), in.num_points};
  return s;
}

// The object that a caller describes, for the time of `then`.
template <class F>
void with_object(const rdm_object_def* def, F&& then) {
  const auto in = read_struct(def, kFirstObjectSize, default_def(), "def");
  if (in.num_shapes < 1 || in.num_shapes > RDM_MAX_SHAPES)
    fail(Code::kRange, "def.num_shapes: %d is outside [1, %d]", in.num_shapes, RDM_MAX_SHAPES);
  need(in.shapes, "def.shapes");
  Vector<Vector<Vec3>> points(static_cast<size_t>(in.num_shapes));
  Vector<ObjectShape> shapes;
  for (int32_t i = 0; i < in.num_shapes; ++i)
    shapes.push_back(shape_of(in.shapes[i], i, &points[static_cast<size_t>(i)]));
  Object o{};
  o.name = in.name;
  o.alias = in.alias;
  o.help = in.summary;
  o.material = {in.material ? in.material : "object", in.friction};
  o.mass = in.mass;
  o.shapes = {shapes.data(), in.num_shapes};
  std::copy_n(in.moment, 6, o.moment);
  then(o);
}

}  // namespace

int32_t rdm_object_count(void) {
  return num_objects();
}

rdm_result rdm_object_info_at(int32_t index, rdm_object_info* io) {
  return call([&] {
    check_out(io, sizeof(rdm_object_info), "io");
    const ObjectRef ref(index);
    rdm_object_info o{};
    o.kind = ref->shapes.count == 1 ? static_cast<int32_t>(ref->shapes[0].kind) : -1;
    o.num_shapes = ref->shapes.count;
    o.own = index >= Objects::num_own();
    o.name = lasting(ref->name);
    o.alias = lasting(ref->alias);
    o.summary = lasting(ref->help);
    o.shape = lasting(ref->shape_text);
    o.mass = ref->mass;
    o.friction = ref->material.friction;
    const ObjectBox box = object_box(*ref);
    put(box.low, o.low);
    put(box.high, o.high);
    write_struct(io, o, sizeof(rdm_object_info), "io");
  });
}

rdm_result rdm_object_def_init(rdm_object_def* def, size_t size) {
  return call([&] { init_struct(def, size, kFirstObjectSize, default_def(), "def"); });
}

rdm_result rdm_object_find(const char* name, int32_t* index) {
  return call([&] {
    need(name, "name");
    need(index, "index");
    *index = find_object(name);
  });
}

rdm_result rdm_object_get_def(int32_t object, rdm_object_def* io) {
  return call([&] {
    check_out(io, kFirstObjectSize, "io");
    const ObjectRef ref(object);
    rdm_object_def d = default_def();
    d.num_shapes = ref->shapes.count;
    d.name = lasting(ref->name);
    d.alias = lasting(ref->alias);
    d.summary = lasting(ref->help);
    d.material = lasting(ref->material.name);
    d.friction = ref->material.friction;
    d.mass = ref->mass;
    std::copy_n(object_inertia(*ref).moment, 6, d.moment);
    write_struct(io, d, kFirstObjectSize, "io");
  });
}

rdm_result rdm_object_shape_at(int32_t object, int32_t i, rdm_shape_def* out) {
  return call([&] {
    need(out, "out");
    const ObjectRef ref(object);
    need_index(i, ref->shapes.count, "i");
    const ObjectShape& s = ref->shapes[i];
    rdm_shape_def o{};
    o.kind = static_cast<int32_t>(s.kind);
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    o.points = s.points.count ? &s.points[0].x : nullptr;
    o.num_points = s.points.count;
    put(s.size, o.size);
    o.pose = to_abi({s.p - object_inertia(*ref).com, normalized(s.q)});
    std::copy_n(s.color, 3, o.color);
    o.color[3] = 255;
    o.seen_only = !s.collides;
    *out = o;
  });
}

rdm_result rdm_object_check(const rdm_object_def* def) {
  return call([&] { with_object(def, check_object); });
}

rdm_result rdm_object_create(int32_t* out, const rdm_object_def* def) {
  return call([&] {
    need(out, "out");
    with_object(def, [&](const Object& o) { *out = add_object(o); });
  });
}

rdm_result rdm_object_destroy(int32_t object) {
  return call([&] { remove_object(object); });
}
#endif
