#include "nn/policy.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "nn/kernels.hpp"
#include "nn/scratch.hpp"

namespace rdm {
namespace {

constexpr const char* kWhat = "policy file";
constexpr int32_t kChunk = 128;  // rows at a time: bounds the scratch
constexpr int32_t kExampleDecisions =
    3;  // of a policy with a memory, on the same row: of the last is the action
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

// What act needs per chunk of rows; nothing of the backward pass.
struct ActScratch {
  MlpScratch mlp;
  RecurrentScratch memory;
  PointNetScratch eyes;
  MlpScratch latent;
  float* obs = nullptr;  // what the network sees: normalised, with features
  float* row = nullptr;  // with features, a history or a latent: entries before they stand beside these
  float *stacked = nullptr, *shown = nullptr,
        *z = nullptr;                      // with a latent: its history too; what mu sees and gives
  float* head = nullptr;                   // the network's outputs, with state_std
  float *seen = nullptr, *part = nullptr;  // of one group: what it sees and gives
  float* state = nullptr;                  // of one group
  size_t bytes = 0;
};
ActScratch cut_act_scratch(const PolicyView& v, int32_t rows, void* memory) {
  const MlpShape& shape = v.actor;
  ActScratch s;
  ScratchCutter cutter(memory);
  rows = std::clamp(rows, 1, kChunk);
  // Groups act one after the other in the scratch of a network that is as large as any.
  MlpShape largest = shape;
  if (v.num_groups) largest.in = largest.out = 1;
  for (int32_t g = 0; g < v.num_groups; ++g) {
    largest.in = std::max(largest.in, v.group[g].shape.in);
    largest.out = std::max(largest.out, v.group[g].shape.out);
  }
  s.mlp = cut_forward_scratch(cutter, largest, rows);
  if constexpr (kStatesAndPoints) s.memory = cut_recurrent_scratch(cutter, v.net(), rows);
  s.obs = cutter.make(sz(rows) * sz(shape.in));
  if (v.has_eyes()) s.eyes = cut_pointnet_scratch(cutter, v.eyes);
  if (v.has_eyes() || v.history > 1 || v.latent) s.row = cutter.make(sz(rows) * sz(v.entries()));
  if (v.latent) {
    s.latent = cut_forward_scratch(cutter, v.latent.mlp, rows);
    s.stacked = cutter.make(sz(rows) * sz(v.entries() + v.history_inputs()));
    s.shown = cutter.make(sz(rows) * sz(v.latent.mlp.in));
    s.z = cutter.make(sz(rows) * sz(v.latent.mlp.out));
  }
  s.head = cutter.make(v.state_std ? sz(rows) * sz(shape.out) : 0);
  if (v.num_groups) {
    s.seen = cutter.make(sz(rows) * sz(largest.in));
    s.part = cutter.make(sz(rows) * sz(largest.out));
    s.state = cutter.make(sz(rows) * sz(v.gru.units));
  }
  s.bytes = cutter.used();
  return s;
}

// Where actions and their means are written; one of the two may be null.
struct ActOut {
  float *action = nullptr, *mean = nullptr;
  float limit = 1;  // on magnitudes of actions
  ActOut from(size_t numbers) const {
    return {action ? action + numbers : nullptr, mean ? mean + numbers : nullptr, limit};
  }
};

// Actions out of the network's outputs y [rows], which with state_std have log deviations behind each row's means.
void act_outputs(const PolicyView& v, float* y, int32_t rows, const float* noise, const ActOut& out) {
  const size_t dim = sz(v.action_dim()), width = sz(v.actor.out);
  for (size_t i = 0; i < sz(rows); ++i, y += width) {
    float* const log_std = y + dim;
    // a network that overflows has no action: clipped, infinity would be a full deflection
    for (size_t j = 0; j < dim; ++j)
      if (std::isinf(y[j])) y[j] = std::numeric_limits<float>::quiet_NaN();
    for (size_t j = 0; v.state_std && j < dim; ++j)
      log_std[j] = std::clamp(log_std[j], v.std_bounds[0], v.std_bounds[1]);
    for (float* to : {out.mean, out.action})
      if (to && to + i * dim != y) std::copy_n(y, dim, to + i * dim);
    if (out.mean) squash(v.squash, out.mean + i * dim, dim);
    if (!out.action) continue;
    float* const action = out.action + i * dim;
    const bool of_sample = v.squash == Squash::kSample;
    if (!of_sample) squash(v.squash, action, dim);
    kernels().add_noise(v.state_std ? log_std : v.log_std, noise ? noise + i * dim : nullptr, 1,
                        v.action_dim(), of_sample ? std::numeric_limits<float>::infinity() : out.limit,
                        action);
    if (of_sample) squash(v.squash, action, dim);
  }
}

// Puts the history of rows behind their entries x in seen [rows][step], and then x into the history.
void remember(const PolicyView& v, const float* x, int32_t rows, float* state, float* seen, int32_t step) {
  const size_t width = sz(v.history_inputs());
  for (size_t i = 0; i < sz(rows); ++i, state += width, x += v.entries(), seen += step) {
    std::copy_n(state, width, seen + v.entries());
    push_history(state, v.history - 1, v.history_width, x, v.history_entries);
  }
}

// What pi sees, its z too, of rows with their history.
void see_latent(const PolicyView& v, int32_t rows, const ActScratch& s) {
  const LatentShape& l = v.latent;
  const int32_t width = v.entries() + v.history_inputs();
  pick_columns(s.stacked, rows, width, l.columns, l.mlp.in, s.shown);
  mlp_forward(l.mlp, v.latent_params, s.shown, rows, s.latent, s.z);
  put_latent(l, s.stacked, width, s.z, rows, s.obs, sz(v.actor.in));
}

// Group i of a policy: its entries of y, and of the states [rows][state_dim()].
void act_group(const PolicyView& v, int32_t i, const float* x, int32_t rows, const ActScratch& s,
               float* state, float* y) {
  const ActorGroup& g = v.group[i];
  const float* const params = v.params + g.offset;
  if (g.columns) {
    pick_columns(x, rows, v.obs_dim(), g.columns, g.shape.in, s.seen);
    x = s.seen;
  }
  if (v.has_gru()) {
    const size_t units = sz(g.gru.units), all = sz(v.state_dim()), at = sz(i) * units;
    take_states(state, all, at, units, rows, s.state);
    recurrent_forward(g.net(), params, x, 1, rows, s.state, nullptr, s.mlp, s.memory, s.part);
    give_states(s.memory.h, all, at, units, rows, state);
  } else {
    mlp_forward(g.shape, params, x, rows, s.mlp, s.part);
  }
  spread_outputs(g, s.part, rows, sz(v.actor.out), y);
}

void act_view(const PolicyView& v, const float* obs, const PointRows& clouds, int32_t rows,
              const float* noise, const ActOut& out, void* scratch, float* state) {
  const Kernels& kernel = kernels();
  const ActScratch s = cut_act_scratch(v, rows, scratch);
  const size_t in = sz(v.obs_dim()), dim = sz(v.action_dim());
  for (int32_t at = 0; at < rows; at += s.mlp.rows) {
    const int32_t n = std::min(s.mlp.rows, rows - at);
    const float* x = obs + sz(at) * in;
    const ActOut to = out.from(sz(at) * dim);
    float* const y = v.state_std ? s.head : to.mean ? to.mean : to.action;
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
      float* const seen = v.latent ? s.stacked : s.obs;
      const int32_t step = v.latent ? v.entries() + v.history_inputs() : v.actor.in;
      for (size_t i = 0; i < sz(n); ++i)
        std::copy_n(x + i * sz(v.entries()), v.entries(), seen + i * sz(step));
      if (kStatesAndPoints && v.history > 1)
        remember(v, x, n, state + sz(at) * sz(v.state_dim()), seen, step);
      if (v.latent) see_latent(v, n, s);
      if (v.has_eyes())
        pointnet_forward(v.eyes, v.eyes_params, clouds.from(v.eyes, sz(at)), n, s.eyes,
                         s.obs + v.actor.in - v.eyes.features(), sz(v.actor.in), nullptr);
      x = s.obs;
    }
    for (int32_t i = 0; i < v.num_groups; ++i)
      act_group(v, i, x, n, s, state ? state + sz(at) * sz(v.state_dim()) : nullptr, y);
    if (v.num_groups) {
      act_outputs(v, y, n, noise ? noise + sz(at) * dim : nullptr, to);
      continue;
    }
    if (v.has_gru()) {
      float* const h = state + sz(at) * sz(v.gru.units);
      recurrent_forward(v.net(), v.params, x, 1, n, h, nullptr, s.mlp, s.memory, y);
      std::copy_n(s.memory.h, sz(n) * sz(v.gru.units), h);
    } else {
      mlp_forward(v.actor, v.params, x, n, s.mlp, y);
    }
    act_outputs(v, y, n, noise ? noise + sz(at) * dim : nullptr, to);
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

void read_squash(Reader& in, PolicyView& v) {
  in.need_section("SQSH");
  const auto squash = in.value<int32_t>();
  in.expect_end();
  if (squash < 1 || squash > static_cast<int32_t>(Squash::kMean))
    bad("how its actions are squashed is unknown");
  v.squash = static_cast<Squash>(squash);
}

void write_memory(Writer& out, const PolicyView& v) {
  out.begin_section("MEMO");
  out.value(v.gru.units);
  out.value(v.history);
  out.value(v.history_width);
  for (int32_t i = 0; i < v.history_width; ++i) out.value(v.history_entries ? v.history_entries[i] : i);
  out.end_section();
}

// Of a policy with more than eyes: whether points have colours is a number of their section.
constexpr uint32_t kEyesAndMore = 11;
bool sees_and_more(const PolicyView& v) {
  return v.eyes.points && (v.latent || v.state_dim() > 0);
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
  if (sees_and_more(v)) out.value(int32_t{s.color});
  out.end_section();
}

void read_eyes(Reader& in, PolicyView& v, uint32_t version) {
  in.need_section("EYES");
  PointNetShape& s = v.eyes;
  s.points = in.value<int32_t>();
  s.classes = in.value<int32_t>();
  s.mlp.out = in.value<int32_t>();
  for (float& x : s.origin) x = in.value<float>();
  s.range = in.value<float>();
  s.mlp.activation = static_cast<Activation>(in.value<int32_t>());
  s.mlp.num_hidden = in.value<int32_t>();
  for (int32_t& h : s.mlp.hidden) h = in.value<int32_t>();
  const int32_t color = version == kEyesAndMore ? in.value<int32_t>() : version == 5;
  in.expect_end();
  if (color != 0 && color != 1) bad("whether it reads colours is unknown");
  s.color = color == 1;
  s.mlp.in = 3 + std::clamp(s.classes, 0, kMaxClasses) + (s.color ? 3 : 0);
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

// How many ranges [begin, end) of entries, ascending and apart from each other, then the ranges.
void write_ranges(Writer& out, const int32_t* columns, int32_t count) {
  const auto each_range = [&](auto&& f) {
    for (int32_t i = 0, end = 0; i < count; i = end) {
      for (end = i + 1; end < count && columns[end] == columns[end - 1] + 1;) ++end;
      f(columns[i], columns[end - 1] + 1);
    }
  };
  int32_t ranges = 0;
  each_range([&](int32_t, int32_t) { ++ranges; });
  out.value(ranges);
  each_range([&](int32_t begin, int32_t end) {
    out.value(begin);
    out.value(end);
  });
}

// Entries of a row that it sees, then mu: its layers, whose activation is pi's, and the ranges that mu and pi read.
void write_latent(Writer& out, const PolicyView& v) {
  const LatentShape& l = v.latent;
  out.begin_section("LATN");
  out.value(l.entries);
  out.value(l.mlp.out);
  out.value(l.mlp.num_hidden);
  for (int32_t k = 0; k < kMaxHidden; ++k) out.value(k < l.mlp.num_hidden ? l.mlp.hidden[k] : int32_t{0});
  write_ranges(out, l.columns, l.mlp.in);
  write_ranges(out, l.own, l.num_own);
  out.end_section();
}

void write_columns(Writer& out, const PolicyView& v) {
  out.begin_section("COLS");
  out.value(v.row_dim);
  write_ranges(out, v.columns, v.entries());
  out.end_section();
}

// Of each group its name, first and number of actions, and what it sees; 0 ranges: all.
void write_groups(Writer& out, const PolicyView& v) {
  out.begin_section("GRPS");
  out.value(v.num_groups);
  for (int32_t i = 0; i < v.num_groups; ++i) {
    const ActorGroup& g = v.group[i];
    out.text(g.name);
    out.value(g.first);
    out.value(g.count);
    if (g.columns)
      write_ranges(out, g.columns, g.shape.in);
    else
      out.value(int32_t{0});
  }
  out.end_section();
}

void read_generation(Reader& in, PolicyView& v) {
  if (!in.find_later_section("GENR")) return;
  v.generation = in.value<uint64_t>();
  in.expect_end();
}

void write_usual(Writer& out, const PolicyView& v) {
  out.begin_later_section("SEEN");
  out.value(v.usual.rms);
  out.value(v.usual.largest);
  out.end_section();
}

void read_usual(Reader& in, PolicyView& v) {
  if (!in.find_later_section("SEEN")) return;
  if (v.clip == 0) bad("it has statistics of usual rows, but no normaliser");
  for (float* x : {&v.usual.rms, &v.usual.largest}) {
    *x = in.value<float>();
    if (!(*x >= 1e-6f && *x <= 1e30f)) bad("its statistics of usual rows are out of range");
  }
  in.expect_end();
}

void write_fields(Writer& out, const PolicyView& v) {
  out.begin_later_section("FLDS");
  out.value(v.num_fields);
  for (int32_t i = 0; i < v.num_fields; ++i) {
    out.value(v.fields[i].offset);
    out.value(v.fields[i].count);
  }
  for (int32_t i = 0; i < v.num_fields; ++i)
    for (const char* text : {v.fields[i].name, v.fields[i].unit}) out.bytes(text, std::strlen(text) + 1);
  out.end_section();
}

// The parts of a policy file, as pointers into its bytes. All are checked except the example's action, which needs
// the network (try_example).
struct PolicyParts {
  PolicyParts() = default;
  PolicyParts(const PolicyParts&) = delete;  // v.group points to its own
  PolicyView v;                              // its numbers; pointers come with keep_parts
  const unsigned char* ranges = nullptr;     // of entries, where it sees a part of the row
  int32_t num_ranges = 0;
  ActorGroup group[kMaxGroups];  // v.group points here until they are kept
  const unsigned char* group_ranges[kMaxGroups] = {};
  int32_t group_num_ranges[kMaxGroups] = {};
  // Of each field offset and count, then names and units with their terminators.
  const unsigned char *field_entries = nullptr, *field_texts = nullptr;
  size_t field_bytes = 0;  // of the texts
  const unsigned char* history_entries = nullptr;
  const unsigned char *latent_ranges = nullptr, *own_ranges = nullptr;  // of a latent
  int32_t num_latent_ranges = 0, num_own_ranges = 0;
  const unsigned char* latent = nullptr;
  const unsigned char *params = nullptr, *eyes = nullptr, *log_std = nullptr, *shift = nullptr,
                      *scale = nullptr;
  const unsigned char *obs = nullptr, *action = nullptr, *points = nullptr, *classes = nullptr,
                      *colors = nullptr;
};

// Two numbers of a list of pairs: a range of entries, or a field's offset and count.
struct Pair {
  int32_t first, second;
};
Pair pair_of(const unsigned char* list, int32_t k) {
  Pair r;
  std::memcpy(&r, list + sz(k) * sizeof r, sizeof r);
  return r;
}

void read_fields(Reader& in, PolicyParts& parts) {
  PolicyView& v = parts.v;
  if (!in.find_later_section("FLDS")) return;
  v.num_fields = in.value<int32_t>();
  if (v.num_fields < 1 || v.num_fields > kMaxFields) bad("the number of fields is out of range");
  parts.field_entries = in.view(sz(v.num_fields) * sizeof(Pair));
  parts.field_bytes = in.left();
  parts.field_texts = in.view(parts.field_bytes);
  for (int32_t i = 0; i < v.num_fields; ++i) {
    const auto [offset, count] = pair_of(parts.field_entries, i);
    if (offset < 0 || count < 1 || count > v.row_dim || offset > v.row_dim - count)
      bad("a field is not within the observation");
  }
  const auto *at = reinterpret_cast<const char*>(parts.field_texts), *end = at + parts.field_bytes;
  for (int32_t i = 0; i < 2 * v.num_fields; ++i) {
    const auto* stop =
        at < end ? static_cast<const char*>(std::memchr(at, 0, static_cast<size_t>(end - at))) : nullptr;
    if (!stop || !is_clean_text(at) || (i % 2 == 0 && stop == at))
      bad("the name or unit of a field is not a text");
    at = stop + 1;
  }
  if (at != end) bad("it has more texts than fields");
}

// Ranges of the entries of a row, at most so many, none only where that is allowed: the next bytes of the section.
const unsigned char* view_ranges(Reader& in, int32_t most, int32_t row_dim, int32_t* count,
                                 bool or_none = false) {
  *count = in.value<int32_t>();
  if (*count < (or_none ? 0 : 1) || *count > most) bad("its ranges of entries are not valid");
  const unsigned char* const ranges = in.view(sz(*count) * sizeof(Pair));
  for (int32_t k = 0, last = -1; k < *count; ++k) {
    const auto [begin, end] = pair_of(ranges, k);
    if (begin <= last || end <= begin || end > row_dim) bad("its ranges of entries are not valid");
    last = end;
  }
  return ranges;
}
int32_t count_ranges(const unsigned char* ranges, int32_t count) {
  int32_t sum = 0;
  for (int32_t k = 0; k < count; ++k) {
    const auto [begin, end] = pair_of(ranges, k);
    sum += end - begin;
  }
  return sum;
}

void read_columns(Reader& in, PolicyParts& parts) {
  in.need_section("COLS");
  PolicyView& v = parts.v;
  const int32_t entries = v.entries();
  v.row_dim = in.value<int32_t>();
  if (v.row_dim <= entries || v.row_dim > kMaxInputs) bad("the observation's size is out of range");
  parts.ranges = view_ranges(in, entries, v.row_dim, &parts.num_ranges);
  in.expect_end();
  if (count_ranges(parts.ranges, parts.num_ranges) != entries)
    bad("its ranges of entries do not add up to the network's inputs");
}

void read_groups(Reader& in, PolicyParts& parts) {
  in.need_section("GRPS");
  PolicyView& v = parts.v;
  v.num_groups = in.value<int32_t>();
  if (v.num_groups < 2 || v.num_groups > kMaxGroups) bad("the number of groups is out of range");
  v.group = parts.group;
  int32_t actions = 0;
  size_t offset = 0;
  for (int32_t i = 0; i < v.num_groups; ++i) {
    ActorGroup& g = parts.group[i];
    in.text(g.name, sizeof g.name);
    if (!*g.name || !is_clean_text(g.name)) bad("the name of a group is not a text");
    g.first = in.value<int32_t>();
    g.count = in.value<int32_t>();
    if (g.first != actions || g.count < 1 || g.count > v.action_dim() - actions)
      bad("its groups do not share the action out");
    actions += g.count;
    g.shape = v.actor;
    g.shape.out = v.state_std ? 2 * g.count : g.count;
    const size_t left = in.left();
    if (left < sizeof(int32_t)) bad("a section is shorter than its groups");
    parts.group_ranges[i] = view_ranges(in, v.row_dim, v.row_dim, &parts.group_num_ranges[i], true);
    if (parts.group_num_ranges[i] > 0)
      g.shape.in = count_ranges(parts.group_ranges[i], parts.group_num_ranges[i]);
    g.gru = with_gru(g.shape, v.gru.units).gru;
    g.offset = offset;
    offset += g.net().num_params();
  }
  in.expect_end();
  if (actions != v.action_dim()) bad("its groups do not share the action out");
}

void read_memory(Reader& in, PolicyParts& parts) {
  PolicyView& v = parts.v;
  in.need_section("MEMO");
  const auto units = in.value<int32_t>();
  v.history = in.value<int32_t>();
  v.history_width = in.value<int32_t>();
  if (units > 0 && v.latent) bad("it has a latent and a memory of units");
  if (units > 0 && v.eyes.points) bad("it reads points and has a memory of units");
  if (units < 0 || units > kMaxUnits) bad("the number of units of its memory is out of range");
  if (v.history < 1 || v.history > kMaxHistory) bad("the length of its history is out of range");
  if ((v.history == 1) != (v.history_width == 0) || v.history_width < 0 ||
      int64_t{v.history - 1} * v.history_width >= (v.latent ? kMaxInputs : v.actor.in - v.eyes.features()) ||
      v.history_width > v.entries())
    bad("the entries of its history are out of range");
  if (units == 0 && v.history == 1) bad("its memory is empty");
  v.gru = with_gru(v.actor, units).gru;
  parts.history_entries = in.view(sz(v.history_width) * sizeof(int32_t));
  in.expect_end();
  for (int32_t i = 0, last = -1; i < v.history_width; ++i) {
    int32_t entry;
    std::memcpy(&entry, parts.history_entries + sz(i) * sizeof entry, sizeof entry);
    if (entry <= last || entry >= v.entries()) bad("the entries of its history are not valid");
    last = entry;
  }
}

// Before the memory, whose entries it counts.
void read_latent(Reader& in, PolicyParts& parts) {
  PolicyView& v = parts.v;
  LatentShape& l = v.latent;
  in.need_section("LATN");
  l.entries = in.value<int32_t>();
  l.mlp.out = in.value<int32_t>();
  l.mlp.activation = v.actor.activation;
  l.mlp.num_hidden = in.value<int32_t>();
  for (int32_t& h : l.mlp.hidden) h = in.value<int32_t>();
  if (l.entries < 1 || l.entries > kMaxInputs) bad("the observation's size is out of range");
  if (l.mlp.out < 1 || l.mlp.out > kMaxLatent) bad("the size of its latent is out of range");
  parts.latent_ranges = view_ranges(in, kMaxInputs, kMaxInputs, &parts.num_latent_ranges);
  parts.own_ranges = view_ranges(in, kMaxInputs, kMaxInputs, &parts.num_own_ranges);
  in.expect_end();
  l.mlp.in = count_ranges(parts.latent_ranges, parts.num_latent_ranges);
  l.num_own = count_ranges(parts.own_ranges, parts.num_own_ranges);
  try {
    check_mlp_shape(l.mlp);
  } catch (const Error& e) {
    bad(e.text);
  }
  for (int32_t k = l.mlp.num_hidden; k < kMaxHidden; ++k)
    if (l.mlp.hidden[k] != 0) bad("a layer that does not exist has a width");
  if (l.num_own + l.mlp.out + v.eyes.features() != v.actor.in)
    bad("the network's inputs are not its entries and its latent");
}

// Once the history is known, which both may read.
void check_latent(const PolicyParts& parts) {
  const PolicyView& v = parts.v;
  const auto last = [](const unsigned char* ranges, int32_t count) {
    return pair_of(ranges, count - 1).second;
  };
  const int32_t width = v.entries() + v.history_inputs();
  if (last(parts.latent_ranges, parts.num_latent_ranges) > width ||
      last(parts.own_ranges, parts.num_own_ranges) > v.entries())
    bad("its latent reads entries that are not there");
}

void read_parts(const void* bytes, size_t size, PolicyParts& parts) {
  PolicyView& v = parts.v;
  Reader in(bytes, size, kWhat);
  const uint32_t version = in.begin_file(kPolicyMagic, kPolicyVersion);
  in.need_whole_tags("METAARCHHEADEYESLATNMEMOSQSHCOLSGRPSWGTSNORMEXMP");
  read_meta(in, v);
  read_arch(in, v.actor);
  if (version > 1) read_head(in, v);
  const bool more = version == kEyesAndMore;
  if (!kStatesAndPoints && (in.find_section("EYES") || in.find_section("MEMO")))
    fail(Code::kUnsupported,
         "%s: its policy has a memory or reads points, which a library of policies alone does not run",
         kWhat);
  if (kStatesAndPoints && (version == 4 || version == 5 || more)) read_eyes(in, v, version);
  if (version == 10 || (more && in.find_section("LATN"))) read_latent(in, parts);
  if (kStatesAndPoints && (version == 7 || version == 9 || (version >= 10 && in.find_section("MEMO"))))
    read_memory(in, parts);
  if (v.latent) check_latent(parts);
  if (more && !sees_and_more(v)) bad("it has neither a history nor a latent beside its points");
  if (version == 8) read_squash(in, v);
  v.row_dim = v.entries();
  if (version == 3 || (version > 3 && in.find_section("COLS"))) read_columns(in, parts);
  if (version == 6 || version == 9) {
    if (parts.ranges) bad("it has entries of the whole and of groups");
    if (v.history > 1) bad("it has a history and groups");
    read_groups(in, parts);
  }
  read_fields(in, parts);
  read_generation(in, v);
  read_usual(in, v);
  in.need_section("WGTS");
  parts.params = view_floats(in, v.num_params());
  parts.eyes = view_floats(in, v.eyes.num_params());
  parts.latent = view_floats(in, v.latent.num_params());
  parts.log_std = view_floats(in, v.state_std ? 0 : sz(v.action_dim()));
  in.expect_end();
  in.need_section("NORM");
  const size_t n_norm = v.clip > 0 ? sz(v.entries()) : 0;
  parts.shift = view_floats(in, n_norm);
  parts.scale = view_floats(in, n_norm);
  in.expect_end();
  for (size_t j = 0; j < n_norm; ++j) {
    float scale;
    std::memcpy(&scale, parts.scale + j * sizeof scale, sizeof scale);
    if (!(scale > 0)) bad("a scale of the normaliser is not positive");
  }
  in.need_section("EXMP");
  parts.obs = view_floats(in, sz(v.row_dim));
  parts.action = view_floats(in, sz(v.action_dim()));
  parts.points = in.view(v.eyes.row_points() * sizeof(int16_t));
  parts.classes = in.view(v.eyes.classes ? sz(v.eyes.points) : 0);
  parts.colors = in.view(v.eyes.color ? v.eyes.row_points() : 0);
  in.expect_end();
  for (int32_t i = 0; v.eyes.classes && i < v.eyes.points; ++i)
    if (parts.classes[i] >= v.eyes.classes) bad("a point of its example has a class that does not exist");
}

template <class T>
const T* keep(Arena& arena, const unsigned char* from, size_t n) {
  T* to = arena.make<T>(n);
  if (to && n) std::memcpy(to, from, n * sizeof(T));
  return n ? to : nullptr;
}

// The entries of so many ranges, `entries` in all; null without ranges.
const int32_t* keep_columns(Arena& arena, const unsigned char* ranges, int32_t count, int32_t entries) {
  if (!ranges || count == 0) return nullptr;
  auto* const columns = arena.make<int32_t>(sz(entries));
  int32_t* at = columns;
  for (int32_t k = 0; at && k < count; ++k) {
    const auto [begin, end] = pair_of(ranges, k);
    for (int32_t i = begin; i < end; ++i) *at++ = i;
  }
  return columns;
}

const ActorGroup* keep_groups(Arena& arena, const PolicyParts& parts) {
  auto* const groups = arena.make<ActorGroup>(sz(parts.v.num_groups));
  for (int32_t i = 0; i < parts.v.num_groups; ++i) {
    const int32_t* columns =
        keep_columns(arena, parts.group_ranges[i], parts.group_num_ranges[i], parts.group[i].shape.in);
    if (!groups) continue;
    groups[i] = parts.group[i];
    groups[i].columns = columns;
  }
  return parts.v.num_groups ? groups : nullptr;
}

const ObsField* keep_fields(Arena& arena, const PolicyParts& parts) {
  auto* const fields = arena.make<ObsField>(sz(parts.v.num_fields));
  const auto* text = keep<char>(arena, parts.field_texts, parts.field_bytes);
  for (int32_t i = 0; text && i < parts.v.num_fields; ++i) {
    const auto [offset, count] = pair_of(parts.field_entries, i);
    const char* const unit = text + std::strlen(text) + 1;
    fields[i] = {text, offset, count, unit};
    text = unit + std::strlen(unit) + 1;
  }
  return fields;
}

// The view of a copy in the arena, which then has the scratch of one row, and room for its action, at its end.
struct Kept {
  PolicyView v;
  float* action = nullptr;
  float* state = nullptr;
  unsigned char* scratch = nullptr;
};
Kept keep_parts(Arena& arena, const PolicyParts& parts) {
  Kept kept;
  PolicyView& v = kept.v = parts.v;
  const size_t n_out = sz(v.action_dim()), n_norm = v.clip > 0 ? sz(v.entries()) : 0;
  v.columns = keep_columns(arena, parts.ranges, parts.num_ranges, v.entries());
  v.fields = keep_fields(arena, parts);
  v.params = keep<float>(arena, parts.params, v.num_params());
  v.history_entries = keep<int32_t>(arena, parts.history_entries, sz(v.history_width));
  v.eyes_params = keep<float>(arena, parts.eyes, v.eyes.num_params());
  v.latent_params = keep<float>(arena, parts.latent, v.latent.num_params());
  v.latent.columns = keep_columns(arena, parts.latent_ranges, parts.num_latent_ranges, v.latent.mlp.in);
  v.latent.own = keep_columns(arena, parts.own_ranges, parts.num_own_ranges, v.latent.num_own);
  v.example_points = keep<int16_t>(arena, parts.points, v.eyes.row_points());
  v.example_classes = keep<uint8_t>(arena, parts.classes, v.eyes.classes ? sz(v.eyes.points) : 0);
  v.example_colors = keep<uint8_t>(arena, parts.colors, v.eyes.color ? v.eyes.row_points() : 0);
  v.log_std = keep<float>(arena, parts.log_std, v.state_std ? 0 : n_out);
  v.shift = keep<float>(arena, parts.shift, n_norm);
  v.scale = keep<float>(arena, parts.scale, n_norm);
  v.example_obs = keep<float>(arena, parts.obs, sz(v.row_dim));
  v.example_action = keep<float>(arena, parts.action, n_out);
  kept.action = arena.make<float>(n_out);
  kept.state = arena.make<float>(sz(v.state_dim()));
  kept.scratch = arena.make<unsigned char>(cut_act_scratch(parts.v, 1, nullptr).bytes);
  v.group = keep_groups(arena, parts);
  return kept;
}

// The mean action for the example; state [state_dim].
void act_example(const PolicyView& v, const float* obs, const PointRows& cloud, float* action, void* scratch,
                 float* state) {
  std::fill_n(state, v.state_dim(), 0.0f);
  for (int32_t i = v.state_dim() ? kExampleDecisions : 1; i > 0; --i)
    act_view(v, obs, cloud, 1, nullptr, {action}, scratch, state);
}

// A NaN of one point would be hidden by the maximum over points, so the encoder's sums are bounded instead.
bool sums_stay_finite(const PointNetShape& eyes, const float* params) {
  return !kStatesAndPoints || !eyes.points || mlp_bound(eyes.mlp, params, largest_point(eyes)) <= kMaxSum;
}

// The check that needs the finished network: it must reproduce the example action of the file.
void try_example(const Kept& kept) {
  const PolicyView& v = kept.v;
  if (!sums_stay_finite(v.eyes, v.eyes_params)) bad("the encoder's sums may be too large");
  act_example(v, v.example_obs, {v.example_points, nullptr, v.example_classes, v.example_colors}, kept.action,
              kept.scratch, kept.state);
  for (size_t j = 0; j < sz(v.action_dim()); ++j)
    if (!(std::abs(kept.action[j] - clip_unit(v.example_action[j])) <= kExampleTolerance))
      bad("the network does not reproduce the example action that is stored with it");
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
    Vector<float> state(sz(view.state_dim()));
    act_example(view, obs.data(), cloud, action.data(), align_scratch(memory.data()), state.data());
  }
  const bool remembers = view.state_dim() > 0;
  out.begin_file(kPolicyMagic, sees_and_more(view)            ? kEyesAndMore
                               : view.latent                  ? 10
                               : view.squash != Squash::kNone ? 8
                               : remembers && view.num_groups ? 9
                               : remembers                    ? 7
                               : view.num_groups              ? 6
                               : eyes.points                  ? (eyes.color ? 5 : 4)
                               : view.columns                 ? 3
                               : view.state_std               ? 2
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
  if (view.squash != Squash::kNone) {
    out.begin_section("SQSH");
    out.value(static_cast<int32_t>(view.squash));
    out.end_section();
  }
  if (eyes.points) write_eyes(out, view);
  if (view.latent) write_latent(out, view);
  if (remembers) write_memory(out, view);
  if (view.columns) write_columns(out, view);
  if (view.num_groups) write_groups(out, view);
  if (view.num_fields > 0) write_fields(out, view);
  if (view.generation) {
    out.begin_later_section("GENR");
    out.value(view.generation);
    out.end_section();
  }
  if (view.usual.rms > 0) write_usual(out, view);
  out.begin_section("WGTS");
  write_floats(out, view.params, view.num_params());
  write_floats(out, view.eyes_params, eyes.num_params());
  write_floats(out, view.latent_params, view.latent.num_params());
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

void write_group(Writer& out, const PolicyView& view, int32_t i) {
  const ActorGroup& g = view.group[i];
  PolicyView one = view;
  one.group = nullptr, one.num_groups = 0;
  one.actor = g.shape, one.gru = g.gru;
  one.columns = g.columns;
  one.params = view.params + g.offset;
  if (!view.state_std) one.log_std = view.log_std + g.first;
  one.usual = {};
  one.example_action = nullptr;
  Vector<float> shift, scale;
  if (g.columns && view.clip > 0) {
    shift.resize(sz(g.shape.in)), scale.resize(sz(g.shape.in));
    pick_columns(view.shift, 1, view.obs_dim(), g.columns, g.shape.in, shift.data());
    pick_columns(view.scale, 1, view.obs_dim(), g.columns, g.shape.in, scale.data());
    one.shift = shift.data(), one.scale = scale.data();
  }
  write_policy(out, one);
}

size_t Policy::memory(const void* bytes, size_t size) {
  PolicyParts parts;
  read_parts(bytes, size, parts);
  Arena measure;
  keep_parts(measure, parts);
  return Arena::padded(sizeof(Policy)) + measure.used();
}

Policy* Policy::read(const void* bytes, size_t size, const HostHooks& hooks) {
  PolicyParts parts;
  read_parts(bytes, size, parts);
  Arena measure;
  keep_parts(measure, parts);
  Arena arena(hooks, measure.used());
  const Kept kept = keep_parts(arena, parts);
  try_example(kept);
  Policy* p = host_new<Policy>(hooks);
  p->hooks_ = hooks;
  p->arena_ = std::move(arena);
  p->view_ = kept.v;
  p->scratch_ = kept.scratch;
  p->state_ = kept.state;
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

void Policy::update(const PolicyView& from) {
  PolicyView& v = view_;
  const size_t n_out = sz(v.action_dim()), n_row = sz(v.obs_dim());
  struct Part {
    const float *from, *to;
    size_t count;
  };
  const size_t n_norm = v.clip > 0 ? sz(v.entries()) : 0;
  const Part parts[] = {{from.params, v.params, v.num_params()},
                        {from.eyes_params, v.eyes_params, v.eyes.num_params()},
                        {from.latent_params, v.latent_params, v.latent.num_params()},
                        {from.log_std, v.log_std, v.state_std ? 0 : n_out},
                        {from.shift, v.shift, n_norm},
                        {from.scale, v.scale, n_norm},
                        {from.example_obs, v.example_obs, n_row}};
  for (const Part& p : parts)
    for (size_t i = 0; i < p.count; ++i)
      if (!std::isfinite(p.from[i]))
        fail(Code::kArgument, "policy: a number of the new network is not finite");
  if (!sums_stay_finite(v.eyes, from.eyes_params))
    fail(Code::kArgument, "policy: the sums of the new encoder may be too large");
  for (const Part& p : parts) std::copy_n(p.from, p.count, const_cast<float*>(p.to));  // the arena's
  std::copy_n(from.std_bounds, 2, v.std_bounds);
  v.noise_correlation = from.noise_correlation;
  v.control_dt = from.control_dt;
  v.layout_hash = from.layout_hash;
  v.generation = from.generation;
  v.usual = from.usual;
  std::memcpy(v.task, from.task, sizeof v.task);
  act_example(v, v.example_obs, {v.example_points, nullptr, v.example_classes, v.example_colors},
              const_cast<float*>(v.example_action), scratch_, state_);
}

void Policy::novelty(const float* obs, int32_t rows, float* novelty) const {
  const PolicyView& v = view_;
  for (int32_t i = 0; i < rows; ++i, obs += v.obs_dim())
    novelty[i] = scaled(novelty_of({obs, v.shift, v.scale, v.columns}, v.entries()), v.usual);
}

size_t Policy::scratch_bytes(int32_t rows) const {
  return cut_act_scratch(view_, rows, nullptr).bytes;
}

void Policy::act(const float* obs, int32_t rows, const float* noise, float* action, void* scratch,
                 const PointRows& clouds, float* state) const {
  act_view(view_, obs, clouds, rows, noise, {action}, scratch, state);
}

void Policy::sample(const float* obs, int32_t rows, const float* noise, float* action, float* mean,
                    void* scratch, float* state) const {
  act_view(view_, obs, {}, rows, noise, {action, mean, std::numeric_limits<float>::infinity()}, scratch,
           state);
}

void push_history(float* state, int32_t depth, int32_t width, const float* seen, const int32_t* listed) {
  std::memmove(state + width, state, sz(depth - 1) * sz(width) * sizeof *state);
  for (size_t i = 0; i < sz(width); ++i) state[i] = seen[listed ? sz(listed[i]) : i];
}

}  // namespace rdm
