// rdm_policy_*: the frozen network.

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "capi/handles.hpp"

#if RDM_WITH_POLICY
using namespace rdm;
using namespace rdm::capi;

namespace {
void make(rdm_policy** out, const void* bytes, size_t size, const HostHooks& hooks) {
  rdm_policy* p = host_new<rdm_policy>(hooks);
  p->hooks = hooks;
  try {
    p->policy = Policy::read(bytes, size, hooks);
  } catch (...) {
    host_delete(hooks, p);
    throw;
  }
  *out = p;
}

// Memory hooks that hand out blocks of a caller's memory one after the other; release does nothing. `user` is needed
// only while blocks are handed out.
struct Given {
  unsigned char* at;
  size_t left;
};
void* cut_given(void* user, size_t bytes, size_t align) {
  auto* given = static_cast<Given*>(user);
  const size_t gap = (align - reinterpret_cast<uintptr_t>(given->at) % align) % align;
  if (bytes > given->left || gap > given->left - bytes) return nullptr;
  unsigned char* block = given->at + gap;
  given->at = block + bytes, given->left -= gap + bytes;
  return block;
}
void keep_given(void*, void*, size_t, size_t) {}

// Of the handle, then what Policy::read takes, at any address.
size_t memory_of(const void* bytes, size_t size) {
  return Arena::padded(sizeof(rdm_policy)) + Policy::memory(bytes, size) + Arena::kAlign - 1;
}

const char* activation_name(Activation a) {
  switch (a) {
    case Activation::kTanh:
      return "tanh";
    case Activation::kElu:
      return "elu";
    case Activation::kRelu:
      return "relu";
  }
  return "";
}

struct PolicyTensor {
  const char* name;  // static
  const float* data;
  int32_t rows, cols;
  // for a policy that observes only a part of the row: `data` has the observed columns (rows, if cols is 1), then
  // those that do not belong to the row, such as features of points
  bool part = false;
  float unseen = 0;    // the value of all other columns
  int32_t layer = -1;  // of groups: of which it has all, weights or else biases
  bool weights = false;
  const int16_t* millimetres = nullptr;    // in the place of data: points of the example
  const unsigned char* numbers = nullptr;  // in the place of data: their classes, colours
  bool history = false;                    // in the place of data: the entries of a row that a history keeps
  const int32_t* reads =
      nullptr;       // [seen] with a latent, of a first layer: the entries, with the history, that `data` has
  int32_t seen = 0;  // columns of; those behind them are z
  int32_t of_gru = -1;  // of the GRUs of groups: which of their tensors, as memory_tensor_at counts them
};

// A layer of all groups as one layer of one network, whose other weights are 0: so whoever reads tensors needs no
// groups. Outputs of the last one are in the order of the action, log deviations behind all means.
void copy_groups(const PolicyView& v, const PolicyTensor& t, float* out) {
  const auto cols = static_cast<size_t>(t.cols);
  std::fill_n(out, static_cast<size_t>(t.rows) * cols, 0.0f);
  const bool last = t.layer == v.actor.num_hidden;
  size_t row = 0, col = 0;  // where the group's own begin
  for (int32_t i = 0; i < v.num_groups; ++i) {
    const ActorGroup& g = v.group[i];
    const bool remembers = last && v.has_gru();
    const MlpShape layer = remembers ? g.net().head() : g.shape;
    const int32_t l = remembers ? 0 : t.layer;
    const auto rows = static_cast<size_t>(layer.layer_out(l)), in = static_cast<size_t>(layer.layer_in(l));
    const auto count = static_cast<size_t>(g.count);
    const float* from = v.params + g.offset + (remembers ? g.net().head_offset() : 0) +
                        (t.weights ? layer.weight_offset(l) : layer.bias_offset(l));
    for (size_t r = 0; r < rows; ++r) {
      const size_t at = !last       ? row + r
                        : r < count ? static_cast<size_t>(g.first) + r
                                    : static_cast<size_t>(v.action_dim() + g.first) + r - count;
      if (!t.weights) {
        out[at] = from[r];
        continue;
      }
      for (size_t k = 0; k < in; ++k) {
        const bool of_row = t.layer == 0 && !remembers;
        const size_t to = !of_row ? col + k : g.columns ? static_cast<size_t>(g.columns[k]) : k;
        out[at * cols + to] = from[r * in + k];
      }
    }
    row += rows, col += in;
  }
}

// The GRUs of all groups as one GRU, likewise: of each gate the units of all groups, one group behind the other.
void copy_group_memories(const PolicyView& v, const PolicyTensor& t, float* out) {
  const auto units = static_cast<size_t>(v.gru.units), all = static_cast<size_t>(v.state_dim()),
             cols = static_cast<size_t>(t.cols);
  const bool of_row = v.actor.num_hidden == 0;
  std::fill_n(out, static_cast<size_t>(t.rows) * cols, 0.0f);
  for (size_t i = 0; i < static_cast<size_t>(v.num_groups); ++i) {
    const ActorGroup& g = v.group[i];
    const auto in = static_cast<size_t>(g.gru.in);
    const float* const own = v.params + g.offset + g.net().gru_offset();
    for (size_t gate = 0; gate < 3; ++gate)
      for (size_t r = 0; r < units; ++r) {
        const size_t from = gate * units + r, to = gate * all + i * units + r;
        float* const row = out + to * cols;
        if (t.of_gru == 1) *row = own[g.gru.input_bias_offset() + from];
        if (t.of_gru == 2) std::copy_n(own + g.gru.state_offset() + from * units, units, row + i * units);
        if (t.of_gru == 3) *row = own[g.gru.state_bias_offset() + from];
        for (size_t k = 0; t.of_gru == 0 && k < in; ++k)
          row[!of_row ? i * in + k : g.columns ? static_cast<size_t>(g.columns[k]) : k] = own[from * in + k];
      }
  }
}

// The first layer of a network of a latent, with a column for each entry of the row, then those of the history, or of z
// and the features of points.
void copy_first_layer(const PolicyView& v, const PolicyTensor& t, float* out) {
  const auto rows = static_cast<size_t>(t.rows), cols = static_cast<size_t>(t.cols),
             seen = static_cast<size_t>(t.seen), dim = static_cast<size_t>(v.obs_dim());
  const size_t behind =
      v.latent.own == t.reads ? static_cast<size_t>(v.latent.mlp.out + v.eyes.features()) : 0;
  std::fill_n(out, rows * cols, 0.0f);
  for (size_t r = 0; r < rows; ++r) {
    const float* from = t.data + r * (seen + behind);
    for (size_t i = 0; i < seen; ++i) {
      const int32_t entry = t.reads[i];
      const int32_t at = entry >= v.entries() ? v.obs_dim() + entry - v.entries()
                         : v.columns          ? v.columns[entry]
                                              : entry;
      out[r * cols + static_cast<size_t>(at)] = from[i];
    }
    std::copy_n(from + seen, behind, out + r * cols + dim);
  }
}

// All that the tensor is, [rows][cols].
void copy_tensor(const PolicyView& v, const PolicyTensor& t, float* out) {
  const size_t size = static_cast<size_t>(t.rows) * static_cast<size_t>(t.cols);
  for (size_t i = 0; t.millimetres && i < size; ++i)
    out[i] = static_cast<float>(static_cast<double>(v.eyes.origin[i % 3]) + 0.001 * t.millimetres[i]);
  for (size_t i = 0; t.numbers && i < size; ++i) out[i] = t.numbers[i];
  for (size_t i = 0; t.history && i < size; ++i) {
    const size_t entry = v.history_entries ? static_cast<size_t>(v.history_entries[i]) : i;
    out[i] = static_cast<float>(v.columns ? v.columns[entry] : static_cast<int32_t>(entry));
  }
  if (t.millimetres || t.numbers || t.history) return;
  if (t.layer >= 0) return copy_groups(v, t, out);
  if (kStatesAndPoints && t.of_gru >= 0) return copy_group_memories(v, t, out);
  if (t.reads) return copy_first_layer(v, t, out);
  if (!t.part) {
    std::copy(t.data, t.data + size, out);
    return;
  }
  std::fill_n(out, size, t.unseen);
  const auto entries = static_cast<size_t>(v.entries()), dim = static_cast<size_t>(v.obs_dim());
  const size_t row = t.cols > 1 ? static_cast<size_t>(t.cols) : dim, features = row - dim;
  for (size_t r = 0; r < size / row; ++r) {
    const float* from = t.data + r * (entries + features);
    for (size_t i = 0; i < entries; ++i) out[r * row + static_cast<size_t>(v.columns[i])] = from[i];
    std::copy_n(from + entries, features, out + r * row + dim);
  }
}

// The tensors of a policy that reads points.
bool eyes_tensor_at(const PolicyView& v, int32_t i, PolicyTensor* out) {
  static constexpr const char* kWeights[] = {"encoder.0.weight", "encoder.1.weight", "encoder.2.weight",
                                             "encoder.3.weight"};
  static constexpr const char* kBiases[] = {"encoder.0.bias", "encoder.1.bias", "encoder.2.bias",
                                            "encoder.3.bias"};
  const PointNetShape& eyes = v.eyes;
  const MlpShape& s = eyes.mlp;
  if (!v.has_eyes()) return false;
  if (i < 2 * s.num_layers()) {
    const int32_t l = i / 2;
    const bool weight = i % 2 == 0;
    *out = {weight ? kWeights[l] : kBiases[l],
            v.eyes_params + (weight ? s.weight_offset(l) : s.bias_offset(l)), s.layer_out(l),
            weight ? s.layer_in(l) : 1};
    return true;
  }
  PolicyTensor points = {"example.points", nullptr, eyes.points, 3};
  points.millimetres = v.example_points;
  PolicyTensor classes = {"example.point_class", nullptr, eyes.points, 1};
  classes.numbers = v.example_classes;
  PolicyTensor colors = {"example.point_color", nullptr, eyes.points, 3};
  colors.numbers = v.example_colors;
  static constexpr float kActivations[] = {0, 1, 2};  // by Activation
  const PolicyTensor rest[] = {{"encoder.origin", eyes.origin, 3, 1},
                               {"encoder.range", &eyes.range, 1, 1},
                               {"encoder.activation", &kActivations[static_cast<size_t>(s.activation)], 1, 1},
                               points,
                               eyes.classes ? classes : colors,
                               colors};
  const int32_t at = i - 2 * s.num_layers();
  if (at >= 4 + (eyes.classes ? 1 : 0) + (eyes.color ? 1 : 0)) return false;
  *out = rest[at];
  return true;
}

// The tensors of a latent's encoder.
bool latent_tensor_at(const PolicyView& v, int32_t i, PolicyTensor* out) {
  static constexpr const char* kWeights[] = {"latent.0.weight", "latent.1.weight", "latent.2.weight",
                                             "latent.3.weight", "latent.4.weight"};
  static constexpr const char* kBiases[] = {"latent.0.bias", "latent.1.bias", "latent.2.bias",
                                            "latent.3.bias", "latent.4.bias"};
  static_assert(std::size(kWeights) == kMaxHidden + 1 && std::size(kBiases) == kMaxHidden + 1);
  const MlpShape& s = v.latent.mlp;
  const int32_t l = i / 2;
  if (i % 2) {
    *out = {kBiases[l], v.latent_params + s.bias_offset(l), s.layer_out(l), 1};
    return true;
  }
  *out = {kWeights[l], v.latent_params + s.weight_offset(l), s.layer_out(l),
          l == 0 ? v.obs_dim() + v.history_inputs() : s.layer_in(l)};
  if (l == 0) out->reads = v.latent.columns, out->seen = s.in;
  return true;
}

// The tensors of a policy with a memory.
int32_t memory_tensors(const PolicyView& v) {
  return kStatesAndPoints && v.history > 1 ? 1 : v.has_gru() ? 4 : 0;
}
bool memory_tensor_at(const PolicyView& v, int32_t i, PolicyTensor* out) {
  const GruShape& g = v.gru;
  if (i >= memory_tensors(v)) return false;
  if (v.history > 1) {
    *out = {"history.columns", nullptr, v.history_width, 1};
    out->history = true;
    return true;
  }
  const float* const at = v.params + v.net().gru_offset();
  const bool part = v.actor.num_hidden == 0 && v.columns;  // it reads the row itself
  const PolicyTensor all[] = {{"memory.input.weight", at, 3 * g.units, part ? v.obs_dim() : g.in, part},
                              {"memory.input.bias", at + g.input_bias_offset(), 3 * g.units, 1},
                              {"memory.state.weight", at + g.state_offset(), 3 * g.units, g.units},
                              {"memory.state.bias", at + g.state_bias_offset(), 3 * g.units, 1}};
  *out = all[i];
  if (v.num_groups == 0) return true;
  const int32_t units = v.state_dim(), in = v.actor.num_hidden ? v.num_groups * g.in : v.obs_dim();
  const int32_t cols[] = {in, 1, units, 1};
  out->data = nullptr, out->part = false, out->of_gru = i;
  out->rows = 3 * units, out->cols = cols[i];
  return true;
}

// The i-th block of numbers of a policy file; false past the end.
bool tensor_at(const PolicyView& v, int32_t i, PolicyTensor* out) {
  static constexpr const char* kWeights[] = {"actor.0.weight", "actor.1.weight", "actor.2.weight",
                                             "actor.3.weight", "actor.4.weight"};
  static constexpr const char* kBiases[] = {"actor.0.bias", "actor.1.bias", "actor.2.bias", "actor.3.bias",
                                            "actor.4.bias"};
  static_assert(std::size(kWeights) == kMaxHidden + 1 && std::size(kBiases) == kMaxHidden + 1);
  const MlpShape& s = v.actor;
  if (i < 0) return false;
  if (i < 2 * s.num_layers()) {
    const int32_t l = i / 2;
    const bool part = l == 0 && v.columns;
    if (v.num_groups) {
      const auto all = [&](int32_t of_one) { return v.num_groups * of_one; };
      const int32_t rows = l == s.num_hidden ? s.out : all(s.layer_out(l)),
                    cols = l == s.num_hidden && v.has_gru() ? v.state_dim()
                           : l == 0                         ? s.in
                                                            : all(s.layer_in(l));
      *out = {i % 2 ? kBiases[l] : kWeights[l], nullptr, rows, i % 2 ? 1 : cols};
      out->layer = l, out->weights = i % 2 == 0;
      return true;
    }
    if (v.has_gru() && l == s.num_hidden) {
      const MlpShape head = v.net().head();
      const float* const at = v.params + v.net().head_offset();
      if (i % 2)
        *out = {kBiases[l], at + head.bias_offset(0), head.out, 1};
      else
        *out = {kWeights[l], at, head.out, head.in};
    } else if (i % 2 == 0 && l == 0 && v.latent) {
      *out = {kWeights[l], v.params, s.layer_out(l), v.obs_dim() + v.latent.mlp.out + v.eyes.features()};
      out->reads = v.latent.own, out->seen = v.latent.num_own;
    } else if (i % 2)
      *out = {kBiases[l], v.params + s.bias_offset(l), s.layer_out(l), 1};
    else
      *out = {kWeights[l], v.params + s.weight_offset(l), s.layer_out(l),
              part ? v.obs_dim() + v.eyes.features() + v.history_inputs() : s.layer_in(l), part};
    return true;
  }
  const PolicyTensor std_bounds = {"actor.log_std_bounds", v.std_bounds, 2, 1};
  const PolicyTensor always[] = {
      v.state_std ? std_bounds : PolicyTensor{"actor.log_std", v.log_std, s.out, 1},
      {"example.obs", v.example_obs, v.obs_dim(), 1},
      {"example.action", v.example_action, v.action_dim(), 1}};
  const bool part = v.columns != nullptr;
  const PolicyTensor normalizer[] = {{"normalizer.shift", v.shift, v.obs_dim(), 1, part},
                                     {"normalizer.scale", v.scale, v.obs_dim(), 1, part, 1},
                                     {"normalizer.clip", &v.clip, 1, 1}};
  const auto rest = static_cast<size_t>(i - 2 * s.num_layers());
  const size_t known = std::size(always) + (v.clip > 0 ? std::size(normalizer) : 0);
  static constexpr float kSquash[] = {0, 1, 2};
  if (v.squash != Squash::kNone && rest == known)
    *out = {"action.squash", &kSquash[static_cast<int32_t>(v.squash)], 1, 1};
  else if (rest < std::size(always))
    *out = always[rest];
  else if (rest < known)
    *out = normalizer[rest - std::size(always)];
  else if (v.squash != Squash::kNone)
    return false;
  else {
    auto at = static_cast<int32_t>(rest - known);
    const int32_t latent = v.latent ? 2 * v.latent.mlp.num_layers() : 0;
    if (at < latent) return latent_tensor_at(v, at, out);
    at -= latent;
    if (memory_tensor_at(v, at, out)) return true;
    return eyes_tensor_at(v, at - memory_tensors(v), out);
  }
  return true;
}

void need_finite(const float* x, int32_t rows, int32_t width, const char* name) {
  const auto dim = static_cast<size_t>(width);
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i) need_finite_row(x + i * dim, dim, name, i);
}
}  // namespace

rdm_result rdm_policy_read(rdm_policy** out, const void* bytes, size_t size) {
  return call([&] {
    need(out, "out");
    need(bytes, "bytes");
    make(out, bytes, size, host());
  });
}

rdm_result rdm_policy_read_memory(const void* bytes, size_t size, size_t* memory) {
  return call([&] {
    need(bytes, "bytes");
    need(memory, "memory");
    *memory = memory_of(bytes, size);
  });
}

rdm_result rdm_policy_read_in(rdm_policy** out, const void* bytes, size_t size, void* memory,
                              size_t capacity) {
  return call([&] {
    need(out, "out");
    need(bytes, "bytes");
    need(memory, "memory");
    const size_t needed = memory_of(bytes, size);
    if (capacity < needed)
      fail(Code::kRange, "capacity: %zu bytes are too few, %zu are needed", capacity, needed);
    Given given{static_cast<unsigned char*>(memory), capacity};
    HostHooks hooks;
    hooks.user = &given, hooks.alloc = cut_given, hooks.release = keep_given;
    make(out, bytes, size, hooks);
  });
}

rdm_result rdm_policy_read_file(rdm_policy** out, const char* path) {
  return call([&] {
    need(out, "out");
    need(path, "path");
    const auto bytes = read_file(path, Policy::file_limits());
    make(out, bytes.data(), bytes.size(), host());
  });
}

void rdm_policy_destroy(rdm_policy* p) {
  if (!is_handle(p)) return;
  Policy::destroy(p->policy);
  retire(p);
  host_delete(p->hooks, p);
}

rdm_result rdm_policy_get_info(const rdm_policy* p, rdm_policy_info* io) {
  return call([&] {
    need_handle(p);
    const PolicyView& v = p->policy->view();
    rdm_policy_info info{};
    info.obs_dim = v.obs_dim();
    info.action_dim = v.action_dim();
    info.action_repeat = v.action_repeat;
    info.control_dt = v.control_dt;
    info.noise_correlation = v.noise_correlation;
    info.layout_hash = v.layout_hash;
    info.num_params = v.num_params() + v.eyes.num_params() + v.latent.num_params();
    info.task = v.task;
    info.activation = activation_name(v.actor.activation);
    info.num_points = v.eyes.points;
    info.num_point_classes = v.eyes.classes;
    info.num_features = v.eyes.features();
    info.point_color = v.eyes.color;
    info.num_fields = v.num_fields;
    info.novelty = v.usual.rms > 0;
    info.generation = v.generation;
    info.state_dim = v.state_dim();
    write_struct(io, info, offsetof(rdm_policy_info, activation), "io");
  });
}

size_t rdm_policy_scratch(const rdm_policy* p, int32_t rows) {
  return is_handle(p) && rows > 0 ? p->policy->scratch_bytes(rows) + kScratchSlack : 0;
}

namespace {
void need_rows(int32_t rows) {
  if (rows < 1) fail(Code::kRange, "rows: %d is less than 1", rows);
}
// Acts with a policy that does not read points.
void need_blind(const Policy& policy) {
  if (policy.view().has_eyes())
    fail(Code::kState, "policy: it reads points; call %s",
         policy.view().state_dim() ? "rdm_policy_act_points_state" : "rdm_policy_act_points");
}

void need_no_state(const Policy& policy, const char* call) {
  if (policy.view().state_dim())
    fail(Code::kState, "policy: it has a memory, so %s cannot run it; call %s", call,
         policy.view().eyes.points ? "rdm_policy_act_points_state" : "rdm_policy_act_state");
}

// Clouds of rows, as policies that read them need them.
PointRows need_clouds(const Policy& policy, const rdm_points* points, int32_t rows) {
  const PointNetShape& eyes = policy.view().eyes;
  if (!eyes.points) fail(Code::kState, "policy: it does not read points");
  const PointRows clouds = read_points(points, eyes);
  need_finite(clouds.metres, rows, 3 * eyes.points, "points");
  need_channels(eyes, clouds, static_cast<size_t>(rows));
  return clouds;
}

// run(scratch) writes the rows that are not NULL, action and mean, which are looked at then.
template <class Run>
void act(const rdm_policy* p, const float* obs, int32_t rows, const float* noise, const float* action,
         const float* mean, void* scratch, size_t scratch_bytes, Run&& run) {
  const uint32_t begun = p->changes.begin_reading("policy");
  need(scratch, "scratch");
  scratch = aligned_scratch(scratch, scratch_bytes, p->policy->scratch_bytes(rows));
  const PolicyView& v = p->policy->view();
  need_finite(obs, rows, v.obs_dim(), "obs");
  if (noise) need_finite(noise, rows, v.action_dim(), "noise");
  run(scratch);
  p->changes.end_reading(begun, "policy");
  for (const float* x : {action, mean})
    if (x) need_finite(x, rows, v.action_dim(), "action: the network overflows on these observations");
}
// With what it remembers, if it has a memory.
void act_on(const rdm_policy* p, const float* obs, const PointRows& clouds, float* state, int32_t rows,
            const float* noise, float* action, void* scratch, size_t scratch_bytes) {
  const int32_t dim = p->policy->view().state_dim();
  if (dim) need(state, "state");
  act(p, obs, rows, noise, action, nullptr, scratch, scratch_bytes, [&](void* memory) {
    if (dim) need_finite(state, rows, dim, "state");
    p->policy->act(obs, rows, noise, action, memory, clouds, state);
  });
}
}  // namespace

rdm_result rdm_policy_act(const rdm_policy* p, const float* obs, int32_t rows, const float* noise,
                          float* action, void* scratch, size_t scratch_bytes) {
  return call([&] {
    need_handle(p);
    need(obs, "obs");
    need_rows(rows);
    need_blind(*p->policy);
    need_no_state(*p->policy, "rdm_policy_act");
    need(action, "action");
    act(p, obs, rows, noise, action, nullptr, scratch, scratch_bytes,
        [&](void* memory) { p->policy->act(obs, rows, noise, action, memory); });
  });
}

rdm_result rdm_policy_act_state(const rdm_policy* p, const float* obs, float* state, int32_t rows,
                                const float* noise, float* action, void* scratch, size_t scratch_bytes) {
  return call([&] {
    need_handle(p);
    need(obs, "obs");
    need_rows(rows);
    need_blind(*p->policy);
    need(action, "action");
    act_on(p, obs, {}, state, rows, noise, action, scratch, scratch_bytes);
  });
}

rdm_result rdm_policy_sample(const rdm_policy* p, const float* obs, int32_t rows, const float* noise,
                             float* action, float* mean, void* scratch, size_t scratch_bytes) {
  return call([&] {
    need_handle(p);
    need(obs, "obs");
    need_rows(rows);
    need_blind(*p->policy);
    need_no_state(*p->policy, "rdm_policy_sample");
    if (!action && !mean)
      fail(Code::kArgument, "action and mean are both NULL, so there is nothing to write");
    act(p, obs, rows, noise, action, mean, scratch, scratch_bytes,
        [&](void* memory) { p->policy->sample(obs, rows, noise, action, mean, memory); });
  });
}

rdm_result rdm_policy_novelty(const rdm_policy* p, const float* obs, int32_t rows, float* novelty) {
  return call([&] {
    need_handle(p);
    need(obs, "obs");
    need_rows(rows);
    need(novelty, "novelty");
    const uint32_t begun = p->changes.begin_reading("policy");
    const PolicyView& v = p->policy->view();
    if (!(v.usual.rms > 0))
      fail(Code::kUnsupported,
           "novelty: the policy file has no statistics of usual rows; an agent with normalize_obs writes "
           "them after it has learned from 1000 rows");
    need_finite(obs, rows, v.obs_dim(), "obs");
    p->policy->novelty(obs, rows, novelty);
    p->changes.end_reading(begun, "policy");
  });
}

rdm_result rdm_policy_act_points(const rdm_policy* p, const float* obs, const rdm_points* points,
                                 int32_t rows, const float* noise, float* action, void* scratch,
                                 size_t scratch_bytes) {
  return call([&] {
    need_handle(p);
    need(obs, "obs");
    need_rows(rows);
    const PointRows clouds = need_clouds(*p->policy, points, rows);
    need_no_state(*p->policy, "rdm_policy_act_points");
    need(action, "action");
    act_on(p, obs, clouds, nullptr, rows, noise, action, scratch, scratch_bytes);
  });
}

rdm_result rdm_policy_act_points_state(const rdm_policy* p, const float* obs, const rdm_points* points,
                                       float* state, int32_t rows, const float* noise, float* action,
                                       void* scratch, size_t scratch_bytes) {
  return call([&] {
    need_handle(p);
    need(obs, "obs");
    need_rows(rows);
    const PointRows clouds = need_clouds(*p->policy, points, rows);
    need(action, "action");
    act_on(p, obs, clouds, state, rows, noise, action, scratch, scratch_bytes);
  });
}

rdm_result rdm_policy_tensor_at(const rdm_policy* p, int32_t i, rdm_tensor* out) {
  return call([&] {
    need_handle(p);
    need(out, "out");
    PolicyTensor t;
    if (!tensor_at(p->policy->view(), i, &t)) fail(Code::kRange, "i: %d is past the end of the tensors", i);
    *out = {t.name, t.rows, t.cols};
  });
}

rdm_result rdm_policy_get_tensor(const rdm_policy* p, const char* name, float* out, size_t count) {
  return call([&] {
    need_handle(p);
    need(name, "name");
    need(out, "out");
    Vector<const char*> names;
    PolicyTensor t;
    for (int32_t i = 0; tensor_at(p->policy->view(), i, &t); ++i) {
      if (std::strcmp(t.name, name) == 0) {
        const size_t size = static_cast<size_t>(t.rows) * static_cast<size_t>(t.cols);
        if (count != size) fail(Code::kRange, "count: tensor %s has %zu values, not %zu", name, size, count);
        copy_tensor(p->policy->view(), t, out);
        return;
      }
      names.push_back(t.name);
    }
    fail(Code::kNotFound, "tensor %s: unknown%s", Quoted(name).text,
         Nearest(name, names.data(), static_cast<int32_t>(names.size())).text);
  });
}

rdm_result rdm_policy_field_at(const rdm_policy* p, int32_t i, rdm_field_info* io) {
  return call([&] {
    need_handle(p);
    const PolicyView& v = p->policy->view();
    check_out(io, sizeof(rdm_field_info), "io");
    need_index(i, v.num_fields, "i");
    const ObsField& f = v.fields[i];
    write_struct(io, {0, f.offset, f.count, 0, f.name, f.unit, NAN, NAN}, sizeof(rdm_field_info), "io");
  });
}

rdm_result rdm_policy_get_columns(const rdm_policy* p, int32_t* columns, size_t capacity, size_t* count) {
  return call([&] {
    need_handle(p);
    need(count, "count");
    need_room(columns, capacity, "columns");
    const PolicyView& v = p->policy->view();
    *count = static_cast<size_t>(v.entries());
    for (size_t i = 0; i < std::min(capacity, *count); ++i)
      columns[i] = v.columns ? v.columns[i] : static_cast<int32_t>(i);
  });
}

PointRows rdm::capi::read_points(const rdm_points* points, const PointNetShape& eyes) {
  const auto in = read_struct(points, kFirstPointsSize, rdm_points{}, "points");
  need(in.points, "points.points");
  if (in.num_points != eyes.points)
    fail(Code::kRange, "points.num_points: it is %d, but the encoder reads %d", in.num_points, eyes.points);
  PointRows clouds;
  clouds.metres = in.points;
  clouds.classes = eyes.classes ? in.point_class : nullptr;
  clouds.colors = eyes.color ? in.point_color : nullptr;
  return clouds;
}

namespace {
// Which field is the first that differs, for the end of a text; "" where none does, or one side says none.
struct FieldDifference {
  FieldDifference(const PolicyView& v, const rdm_field* fields, int32_t count) {
    if (v.num_fields == 0 || count == 0) return;
    for (int32_t i = 0; i < std::max(v.num_fields, count); ++i) {
      const ObsField* mine = i < v.num_fields ? &v.fields[i] : nullptr;
      const rdm_field* theirs = i < count ? &fields[i] : nullptr;
      if (mine && theirs && std::strcmp(mine->name, theirs->name) == 0 && mine->offset == theirs->offset &&
          mine->count == theirs->count)
        continue;
      char has[96] = "nothing";
      if (theirs) print_text(has, sizeof has, "%s [%d]", theirs->name, theirs->count);
      if (mine)
        print_text(text, sizeof text, "; field %d is %s [%d] to the policy, %s to the task", i, mine->name,
                   mine->count, has);
      else
        print_text(text, sizeof text, "; field %d is nothing to the policy, %s to the task", i, has);
      return;
    }
  }
  char text[256] = "";
};

FieldDifference difference_of(const PolicyView& v, [[maybe_unused]] const rdm_spec& s) {
#if RDM_WITH_SIM
  const KnownLayout known(s.layout_hash);
  return {v, known.fields(), known.count()};
#else
  return {v, nullptr, 0};
#endif
}
}  // namespace

void rdm::capi::check_policy(const PolicyView& v, const rdm_spec& s) {
  const char *origin = v.task[0] ? "; the policy learned in task " : "", *task = v.task;
  if (v.obs_dim() != s.obs_dim)
    fail(Code::kVersion, "obs_dim: the policy has %d, but the task has %d%s%s%s", v.obs_dim(), s.obs_dim,
         difference_of(v, s).text, origin, task);
  if (v.action_dim() != s.action_dim)
    fail(Code::kVersion, "action_dim: the policy has %d, but the task has %d%s%s", v.action_dim(),
         s.action_dim, origin, task);
  if (v.layout_hash && s.layout_hash && v.layout_hash != s.layout_hash)
    fail(Code::kVersion,
         "layout_hash: the policy was trained with another layout of observations or actions than the task "
         "has%s%s%s",
         difference_of(v, s).text, origin, task);
  if (v.control_dt > 0 && s.control_dt > 0 && std::abs(v.control_dt - s.control_dt) > 1e-6f)
    fail(Code::kVersion, "control_dt: the policy has %g s, but the task has %g s%s%s",
         static_cast<double>(v.control_dt), static_cast<double>(s.control_dt), origin, task);
}

rdm_result rdm_policy_check(const rdm_policy* p, const rdm_spec* spec) {
  return call([&] {
    need_handle(p);
    check_policy(p->policy->view(), read_struct(spec, kFirstSpecSize, rdm_spec{}, "spec"));
  });
}

#if RDM_WITH_LEARN
rdm_result rdm_agent_set_policy(rdm_agent* a, const rdm_policy* p, double samples) {
  return call_on(a, [&] {
    need_handle(p);
    a->agent->load_policy(p->policy->view(), samples);
  });
}
#endif
#endif
