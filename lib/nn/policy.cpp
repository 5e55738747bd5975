#include "nn/policy.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "nn/kernels.hpp"
#include "nn/scratch.hpp"

namespace rdm {
namespace {

constexpr const char* kWhat = "policy file";
constexpr int32_t kChunk = 128;  // rows at a time: bounds the scratch
constexpr float kExampleTolerance = 1e-4f;
constexpr double kMaxSum = 1e18;  // of an encoder: a float still holds its square

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}
float clip_unit(float v) {
  return std::clamp(v, -1.0f, 1.0f);
}

[[noreturn]] void bad(const char* why) {
  fail(Code::kFormat, "%s: %s", kWhat, why);
}

void write_floats(Writer& out, const float* v, size_t n) {
  out.bytes(v, n * sizeof(float));
}

// `n` floats in place, which must be the next bytes of the section; all finite.
const unsigned char* view_floats(Reader& in, size_t n) {
  if (n > in.left() / sizeof(float)) bad("a section is shorter than the network");
  const unsigned char* p = in.view(n * sizeof(float));
  for (size_t i = 0; i < n; ++i) {
    float v;
    std::memcpy(&v, p + i * sizeof(float), sizeof v);
    if (!std::isfinite(v)) bad("a number is not finite");
  }
  return p;
}

const float* keep(Arena& arena, const unsigned char* from, size_t n) {
  float* to = arena.make<float>(n);
  if (to) std::memcpy(to, from, n * sizeof(float));
  return to;
}

// What act needs per chunk of rows; nothing of the backward pass.
struct ActScratch {
  MlpScratch mlp;
  PointNetScratch eyes;
  float* obs = nullptr;   // what the network sees: normalised, with features
  float* row = nullptr;   // with features: entries before they stand beside these
  float* head = nullptr;  // the network's outputs, with state_std
  size_t bytes = 0;
};
ActScratch cut_act_scratch(const PolicyView& v, int32_t rows, void* memory) {
  const MlpShape& shape = v.actor;
  ActScratch s;
  ScratchCutter cutter(memory);
  rows = std::clamp(rows, 1, kChunk);
  s.mlp = cut_forward_scratch(cutter, shape, rows);
  s.obs = cutter.make(sz(rows) * sz(shape.in));
  if (v.eyes.points) {
    s.eyes = cut_pointnet_scratch(cutter, v.eyes);
    s.row = cutter.make(sz(rows) * sz(v.entries()));
  }
  s.head = cutter.make(v.state_std ? sz(rows) * sz(shape.out) : 0);
  s.bytes = cutter.used();
  return s;
}

// Actions out of what a network with state_std gave: head [rows][2 action_dim].
void act_head(const PolicyView& v, float* head, int32_t rows, const float* noise, float* action) {
  const size_t dim = sz(v.action_dim());
  for (size_t i = 0; i < sz(rows); ++i, head += 2 * dim) {
    std::copy_n(head, dim, action + i * dim);
    for (size_t j = dim; j < 2 * dim; ++j) head[j] = std::clamp(head[j], v.std_bounds[0], v.std_bounds[1]);
    kernels().add_noise(head + dim, noise ? noise + i * dim : nullptr, 1, v.action_dim(), action + i * dim);
  }
}

void act_view(const PolicyView& v, const float* obs, const PointRows& clouds, int32_t rows,
              const float* noise, float* action, void* scratch) {
  const Kernels& kernel = kernels();
  const ActScratch s = cut_act_scratch(v, rows, scratch);
  const size_t in = sz(v.obs_dim()), out = sz(v.action_dim());
  for (int32_t at = 0; at < rows; at += s.mlp.rows) {
    const int32_t n = std::min(s.mlp.rows, rows - at);
    const float* x = obs + sz(at) * in;
    const float* e = noise ? noise + sz(at) * out : nullptr;
    float* a = action + sz(at) * out;
    float* const entries = s.row ? s.row : s.obs;
    if (v.columns) {
      pick_columns(x, n, v.obs_dim(), v.columns, v.entries(), entries);
      x = entries;
    }
    if (v.clip > 0) {
      kernel.normalize(x, n, v.entries(), v.shift, v.scale, v.clip, entries);
      x = entries;
    }
    if (s.row) {
      for (size_t i = 0; i < sz(n); ++i)
        std::copy_n(x + i * sz(v.entries()), v.entries(), s.obs + i * sz(v.actor.in));
      pointnet_forward(v.eyes, v.eyes_params, clouds.from(v.eyes, sz(at)), n, s.eyes, s.obs + v.entries(),
                       sz(v.actor.in), nullptr);
      x = s.obs;
    }
    mlp_forward(v.actor, v.params, x, n, s.mlp, v.state_std ? s.head : a);
    if (v.state_std)
      act_head(v, s.head, n, e, a);
    else
      kernel.add_noise(v.log_std, e, n, v.actor.out, a);
  }
}

void read_meta(Reader& in, PolicyView& v) {
  in.need_section("META");
  v.clip = in.value<float>();
  v.action_repeat = in.value<int32_t>();
  v.noise_correlation = in.value<float>();
  v.control_dt = in.value<float>();
  v.layout_hash = in.value<uint64_t>();
  const size_t task_bytes = in.left();
  in.text(v.task, sizeof v.task);
  in.expect_end();
  if (std::strlen(v.task) + sizeof(uint32_t) != task_bytes) bad("the task's name holds a zero");
  if (!(v.clip >= 0 && v.clip <= 1e6f)) bad("the normaliser's clip is out of range");
  if (v.action_repeat < 1 || v.action_repeat > 1000000) bad("the action repeat is out of range");
  if (!(v.noise_correlation >= 0 && v.noise_correlation < 1)) bad("the noise correlation is out of range");
  if (!(v.control_dt >= 0 && v.control_dt <= 1e6f)) bad("the control interval is out of range");
}

void read_arch(Reader& in, MlpShape& shape) {
  in.need_section("ARCH");
  shape.in = in.value<int32_t>();
  shape.out = in.value<int32_t>();
  shape.activation = static_cast<Activation>(in.value<int32_t>());
  shape.num_hidden = in.value<int32_t>();
  for (int32_t& h : shape.hidden) h = in.value<int32_t>();
  in.expect_end();
  try {
    check_mlp_shape(shape);
  } catch (const Error& e) {
    bad(e.text);
  }
  for (int32_t l = shape.num_hidden; l < kMaxHidden; ++l)
    if (shape.hidden[l] != 0) bad("a layer that does not exist has a width");
}

void read_head(Reader& in, PolicyView& v) {
  v.state_std = in.find_section("HEAD");
  if (!v.state_std) return;
  v.std_bounds[0] = in.value<float>();
  v.std_bounds[1] = in.value<float>();
  in.expect_end();
  if (v.actor.out % 2 != 0) bad("the network's outputs are not means and deviations");
  if (!(v.std_bounds[0] <= v.std_bounds[1] && v.std_bounds[0] >= -50 && v.std_bounds[1] <= 50))
    bad("the deviation's bounds are out of range");
}

void write_eyes(Writer& out, const PolicyView& v) {
  const PointNetShape& s = v.eyes;
  out.begin_section("EYES");
  out.value(s.points);
  out.value(s.classes);
  out.value(s.mlp.out);
  for (const float x : s.origin) out.value(x);
  out.value(s.range);
  out.value(static_cast<int32_t>(s.mlp.activation));
  out.value(s.mlp.num_hidden);
  for (int32_t l = 0; l < kMaxHidden; ++l) out.value(l < s.mlp.num_hidden ? s.mlp.hidden[l] : int32_t{0});
  out.end_section();
}

void read_eyes(Reader& in, PolicyView& v, bool color) {
  in.need_section("EYES");
  PointNetShape& s = v.eyes;
  s.points = in.value<int32_t>();
  s.classes = in.value<int32_t>();
  s.color = color;
  s.mlp.in = 3 + std::clamp(s.classes, 0, kMaxClasses) + (color ? 3 : 0);
  s.mlp.out = in.value<int32_t>();
  for (float& x : s.origin) x = in.value<float>();
  s.range = in.value<float>();
  s.mlp.activation = static_cast<Activation>(in.value<int32_t>());
  s.mlp.num_hidden = in.value<int32_t>();
  for (int32_t& h : s.mlp.hidden) h = in.value<int32_t>();
  in.expect_end();
  try {
    check_pointnet_shape(s);
  } catch (const Error& e) {
    bad(e.text);
  }
  for (int32_t l = s.mlp.num_hidden; l < kMaxHidden; ++l)
    if (s.mlp.hidden[l] != 0) bad("a layer that does not exist has a width");
  if (v.entries() < 1) bad("the network has no inputs beside the features of points");
}

// Points about the origin, all classes in turn, and many colours.
void make_up_cloud(const PointNetShape& s, Vector<int16_t>& points, Vector<uint8_t>& classes,
                   Vector<uint8_t>& colors) {
  const double step = std::min(1.0, static_cast<double>(s.range));
  for (size_t i = 0; i < points.size(); ++i)
    points[i] = static_cast<int16_t>(step * static_cast<double>((i * 7919 + i / 3) % 2001) - 1000 * step);
  for (size_t i = 0; i < classes.size(); ++i) classes[i] = static_cast<uint8_t>(i % sz(s.classes));
  for (size_t i = 0; i < colors.size(); ++i) colors[i] = static_cast<uint8_t>(i * 97 % 256);
}

// Ranges [begin, end) of entries, ascending and apart from each other.
void write_columns(Writer& out, const PolicyView& v) {
  const int32_t count = v.entries();
  const auto each_range = [&](auto&& f) {
    for (int32_t i = 0, end = 0; i < count; i = end) {
      for (end = i + 1; end < count && v.columns[end] == v.columns[end - 1] + 1;) ++end;
      f(v.columns[i], v.columns[end - 1] + 1);
    }
  };
  int32_t ranges = 0;
  each_range([&](int32_t, int32_t) { ++ranges; });
  out.begin_section("COLS");
  out.value(v.row_dim);
  out.value(ranges);
  each_range([&](int32_t begin, int32_t end) {
    out.value(begin);
    out.value(end);
  });
  out.end_section();
}

void read_columns(Reader& in, PolicyView& v, Vector<int32_t>* columns) {
  in.need_section("COLS");
  v.row_dim = in.value<int32_t>();
  if (v.row_dim <= v.entries() || v.row_dim > kMaxInputs) bad("the observation's size is out of range");
  const auto ranges = in.value<int32_t>();
  if (ranges < 1 || ranges > v.entries()) bad("the ranges of entries are no such ranges");
  for (int32_t k = 0, last = -1; k < ranges; ++k) {
    const auto begin = in.value<int32_t>(), end = in.value<int32_t>();
    if (begin <= last || end <= begin || end > v.row_dim) bad("the ranges of entries are no such ranges");
    for (int32_t i = begin; i < end; ++i) columns->push_back(i);
    last = end;
  }
  in.expect_end();
  if (columns->size() != sz(v.entries()))
    bad("the ranges of entries are not as many as the network's inputs");
  v.columns = columns->data();
}

}  // namespace

void write_policy(Writer& out, const PolicyView& view) {
  const MlpShape& shape = view.actor;
  const PointNetShape& eyes = view.eyes;
  const size_t n_in = sz(view.entries()), n_row = sz(view.obs_dim()), n_out = sz(view.action_dim());
  Vector<float> obs(n_row), action(n_out);
  Vector<int16_t> points(eyes.row_points());
  Vector<uint8_t> classes(eyes.classes && eyes.points ? sz(eyes.points) : 0);
  Vector<uint8_t> colors(eyes.color ? eyes.row_points() : 0);
  PointRows cloud{points.data(), nullptr, classes.data(), colors.data()};
  if (view.example_points) {
    std::copy_n(view.example_points, points.size(), points.begin());
    if (!classes.empty()) std::copy_n(view.example_classes, classes.size(), classes.begin());
    if (!colors.empty()) std::copy_n(view.example_colors, colors.size(), colors.begin());
  } else {
    make_up_cloud(eyes, points, classes, colors);
  }
  if (view.example_obs) std::copy_n(view.example_obs, n_row, obs.begin());
  if (view.example_obs && view.example_action) {
    std::copy_n(view.example_action, n_out, action.begin());
  } else {
    Vector<float> memory(cut_act_scratch(view, 1, nullptr).bytes / sizeof(float) + Arena::kAlign);
    act_view(view, obs.data(), cloud, 1, nullptr, action.data(), align_scratch(memory.data()));
  }
  out.begin_file(kPolicyMagic, eyes.points      ? (eyes.color ? 5 : 4)
                               : view.columns   ? 3
                               : view.state_std ? 2
                                                : 1);
  out.begin_section("META");
  out.value(view.clip);
  out.value(view.action_repeat);
  out.value(view.noise_correlation);
  out.value(view.control_dt);
  out.value(view.layout_hash);
  out.text(view.task);
  out.end_section();
  out.begin_section("ARCH");
  out.value(shape.in);
  out.value(shape.out);
  out.value(static_cast<int32_t>(shape.activation));
  out.value(shape.num_hidden);
  for (int32_t l = 0; l < kMaxHidden; ++l) out.value(l < shape.num_hidden ? shape.hidden[l] : int32_t{0});
  out.end_section();
  if (view.state_std) {
    out.begin_section("HEAD");
    out.value(view.std_bounds[0]);
    out.value(view.std_bounds[1]);
    out.end_section();
  }
  if (eyes.points) write_eyes(out, view);
  if (view.columns) write_columns(out, view);
  out.begin_section("WGTS");
  write_floats(out, view.params, shape.num_params());
  write_floats(out, view.eyes_params, eyes.num_params());
  if (!view.state_std) write_floats(out, view.log_std, n_out);
  out.end_section();
  out.begin_section("NORM");
  if (view.clip > 0) {
    write_floats(out, view.shift, n_in);
    write_floats(out, view.scale, n_in);
  }
  out.end_section();
  out.begin_section("EXMP");
  write_floats(out, obs.data(), n_row);
  write_floats(out, action.data(), n_out);
  out.bytes(points.data(), points.size() * sizeof(int16_t));
  out.bytes(classes.data(), classes.size());
  out.bytes(colors.data(), colors.size());
  out.end_section();
  out.end_file();
}

Policy* Policy::read(const void* bytes, size_t size, const HostHooks& hooks) {
  PolicyView v;
  Reader in(bytes, size, kWhat);
  const uint32_t version = in.begin_file(kPolicyMagic, kPolicyVersion);
  read_meta(in, v);
  read_arch(in, v.actor);
  if (version > 1) read_head(in, v);
  Vector<int32_t> columns;
  if (version > 3) read_eyes(in, v, version > 4);
  if (version == 3 || (version > 3 && in.find_section("COLS"))) read_columns(in, v, &columns);
  const size_t n_row = sz(v.obs_dim());
  const size_t n_in = sz(v.entries()), n_out = sz(v.action_dim()), n_params = v.actor.num_params();
  const size_t n_eyes = v.eyes.num_params(), n_points = v.eyes.row_points();
  const size_t n_classes = v.eyes.classes ? sz(v.eyes.points) : 0, n_colors = v.eyes.color ? n_points : 0;
  const size_t n_std = v.state_std ? 0 : n_out;
  in.need_section("WGTS");
  const unsigned char *params = view_floats(in, n_params), *eyes = view_floats(in, n_eyes);
  const unsigned char* log_std = view_floats(in, n_std);
  in.expect_end();
  in.need_section("NORM");
  const size_t n_norm = v.clip > 0 ? n_in : 0;
  const unsigned char *shift = view_floats(in, n_norm), *scale = view_floats(in, n_norm);
  in.expect_end();
  for (size_t j = 0; j < n_norm; ++j) {
    float v_j;
    std::memcpy(&v_j, scale + j * sizeof v_j, sizeof v_j);
    if (!(v_j > 0)) bad("a scale of the normaliser is not positive");
  }
  in.need_section("EXMP");
  const unsigned char *obs = view_floats(in, n_row), *action = view_floats(in, n_out);
  const unsigned char *points = in.view(n_points * sizeof(int16_t)), *classes = in.view(n_classes);
  const unsigned char* colors = in.view(n_colors);
  in.expect_end();
  for (size_t i = 0; i < n_classes; ++i)
    if (classes[i] >= v.eyes.classes) bad("a point of the example is of a class that there is not");

  const auto carve = [&](Arena& arena) {
    if (!columns.empty()) {
      auto* kept = arena.make<int32_t>(n_in);
      v.columns = kept ? std::copy_n(columns.data(), n_in, kept) - n_in : columns.data();
    }
    v.params = keep(arena, params, n_params);
    v.eyes_params = n_eyes ? keep(arena, eyes, n_eyes) : nullptr;
    auto* example = arena.make<int16_t>(n_points);
    auto* example_classes = arena.make<uint8_t>(n_classes);
    auto* example_colors = arena.make<uint8_t>(n_colors);
    if (example && n_points) std::memcpy(example, points, n_points * sizeof(int16_t));
    if (example_classes && n_classes) std::memcpy(example_classes, classes, n_classes);
    if (example_colors && n_colors) std::memcpy(example_colors, colors, n_colors);
    v.example_points = n_points ? example : nullptr;
    v.example_classes = n_classes ? example_classes : nullptr;
    v.example_colors = n_colors ? example_colors : nullptr;
    v.log_std = n_std ? keep(arena, log_std, n_std) : nullptr;
    v.shift = n_norm ? keep(arena, shift, n_in) : nullptr;
    v.scale = n_norm ? keep(arena, scale, n_in) : nullptr;
    v.example_obs = keep(arena, obs, n_row);
    v.example_action = keep(arena, action, n_out);
    float* check = arena.make<float>(n_out);
    auto* scratch = arena.make<unsigned char>(cut_act_scratch(v, 1, nullptr).bytes);
    if (arena.measuring()) return;
    // What is not a number would lose against any other point, unseen.
    if (n_eyes && mlp_bound(v.eyes.mlp, v.eyes_params, largest_point(v.eyes)) > kMaxSum)
      bad("the encoder's sums may be too large");
    act_view(v, v.example_obs, {v.example_points, nullptr, v.example_classes, v.example_colors}, 1, nullptr,
             check, scratch);
    for (size_t j = 0; j < n_out; ++j)
      if (!(std::abs(check[j] - clip_unit(v.example_action[j])) <= kExampleTolerance))
        bad("the network does not give the example action that is stored beside it");
  };
  Arena measure;
  carve(measure);
  Arena arena(hooks, measure.used());
  carve(arena);
  Policy* p = host_new<Policy>(hooks);
  p->hooks_ = hooks;
  p->arena_ = std::move(arena);
  p->view_ = v;
  return p;
}

FileLimits Policy::file_limits() {
  // the largest network, with as much again of its inputs and outputs for the other sections
  constexpr size_t kNumbers = size_t{kMaxWidth} * (kMaxInputs + 2 * kMaxHidden * kMaxWidth) +
                              8 * size_t{kMaxInputs + kMaxHidden * kMaxWidth} + 2 * size_t{kMaxPoints};
  return {{kPolicyMagic, sizeof kPolicyMagic}, kFileLengthAt, kNumbers * sizeof(float)};
}

void Policy::destroy(Policy* p) {
  if (p) host_delete(p->hooks_, p);
}

size_t Policy::scratch_bytes(int32_t rows) const {
  return cut_act_scratch(view_, rows, nullptr).bytes;
}

void Policy::act(const float* obs, int32_t rows, const float* noise, float* action, void* scratch,
                 const PointRows& clouds) const {
  act_view(view_, obs, clouds, rows, noise, action, scratch);
}

}  // namespace rdm
