// rdm_recording_*: trajectories as data, and what agents and pools take of them.
#include "record/recording.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/file.hpp"
#include "base/hash.hpp"
#include "capi/handles.hpp"
#if RDM_WITH_SIM
#include "env/fields.hpp"
#endif

using namespace rdm;
using namespace rdm::capi;

namespace {

rdm_clone_config default_clone() {
  rdm_clone_config c{};
  c.epochs = 30;
  c.batch_rows = 512;
  c.patience = 5;
  c.learning_rate = 1e-3;
  c.learning_rate_end = 1e-5;
  c.validation = 0.1;
  c.feed_normalizer = 1;
  return c;
}

}  // namespace

rdm_result rdm_clone_config_init(rdm_clone_config* how, size_t size) {
  return call([&] { init_struct(how, size, sizeof(rdm_clone_config), default_clone(), "how"); });
}

#if RDM_WITH_SIM || RDM_WITH_LEARN
struct rdm_recording {
  static constexpr Tag kTag = Tag::kRecording;
  static constexpr bool kOneAtATime = false;
  Tag tag = kTag;
  mutable InUse in_use;
  HostHooks hooks;
  char error[kErrorTextSize] = "";
  Recording* recording = nullptr;
};

namespace {

rdm_recording_config default_config() {
  rdm_recording_config c{};
  c.task = "";
  c.state_stride = 8;
  return c;
}

// `make` gives the recording, under the hooks.
template <class F>
void open_handle(rdm_recording** out, const HostHooks& hooks, F&& make) {
  const HostScope scope(hooks);
  rdm_recording* r = host_new<rdm_recording>(hooks);
  r->hooks = hooks;
  try {
    r->recording = make();
  } catch (...) {
    host_delete(hooks, r);
    throw;
  }
  *out = r;
}

// A call that changes a recording: its memory is its own hooks'.
template <class F>
rdm_result change(rdm_recording* r, F&& f) {
  return call_on(r, [&] {
    const HostScope scope(r->hooks);
    f(*r->recording);
  });
}

}  // namespace

rdm_result rdm_recording_config_init(rdm_recording_config* c, size_t size) {
  return call([&] { init_struct(c, size, kFirstRecordingConfigSize, default_config(), "c"); });
}

rdm_result rdm_recording_create(rdm_recording** out, const rdm_recording_config* c) {
  return call_with(c, [&] {
    need(out, "out");
    const auto in = read_struct(c, kFirstRecordingConfigSize, default_config(), "config");
    check_error(in);
    RecordingSpec spec;
    spec.obs_dim = in.obs_dim;
    spec.action_dim = in.action_dim;
    spec.cost_dim = in.cost_dim;
    spec.layout_hash = in.layout_hash;
    spec.state_bytes = static_cast<size_t>(std::min<uint64_t>(in.state_bytes, SIZE_MAX));
    spec.state_stride = in.state_stride;
    spec.num_points = in.num_points;
    if (in.point_color != 0 && in.point_color != 1)
      fail(Code::kRange, "config.point_color: %d is not 0 or 1", in.point_color);
    if (in.point_color && in.num_points == 0)
      fail(Code::kArgument, "config.point_color: there are no points with num_points 0");
    spec.point_color = in.point_color != 0;
    const char* task = in.task ? in.task : "";
    if (std::strlen(task) >= sizeof spec.task || !is_clean_text(task))
      fail(Code::kRange, "config.task: longer than %zu characters, or not one line of UTF-8",
           sizeof spec.task - 1);
    std::strcpy(spec.task, task);
    const HostHooks hooks = hooks_from(in.host);
    open_handle(out, hooks, [&] { return host_new<Recording>(hooks, spec, in.capacity); });
  });
}

void rdm_recording_destroy(rdm_recording* r) {
  if (!may_end(r)) return;
  host_delete(r->hooks, r->recording);
  retire(r);
  host_delete(r->hooks, r);
}

const char* rdm_recording_error(const rdm_recording* r) {
  return is_handle(r) ? r->error : "recording: NULL, not a recording, or destroyed";
}

rdm_result rdm_recording_get_info(const rdm_recording* r, rdm_recording_info* io) {
  return call_on(r, [&] {
    const Recording& x = *r->recording;
    rdm_recording_info out{};
    out.obs_dim = x.spec().obs_dim;
    out.action_dim = x.spec().action_dim;
    out.cost_dim = x.spec().cost_dim;
    out.rows = x.rows();
    out.episodes = x.episodes();
    out.num_states = x.num_states();
    out.state_bytes = x.spec().state_bytes;
    out.layout_hash = x.spec().layout_hash;
    out.fingerprint = x.fingerprint();
    out.task = x.spec().task;
    out.num_points = x.spec().num_points;
    write_struct(io, out, kFirstRecordingInfoSize, "io");
  });
}

rdm_result rdm_recording_get_rows(const rdm_recording* r, rdm_recording_rows* io) {
  return call_on(r, [&] {
    const RecordingRows v = r->recording->view();
    rdm_recording_rows out{};
    out.rows = v.rows;
    out.obs = v.obs;
    out.action = v.action;
    out.label = v.label;
    out.reward = v.reward;
    out.cost = v.cost;
    out.terminated = v.terminated;
    out.truncated = v.truncated;
    out.success = v.success;
    out.episode = v.episode;
    out.num_states = v.num_states;
    out.state_row = v.state_row;
    out.state = v.state;
    out.points = v.points;
    out.point_class = v.point_class;
    out.point_color = v.point_color;
    write_struct(io, out, kFirstRecordingRowsSize, "io");
  });
}

rdm_result rdm_recording_append(rdm_recording* r, const rdm_recording_rows* rows) {
  return change(r, [&](Recording& x) {
    const auto in = read_struct(rows, kFirstRecordingRowsSize, rdm_recording_rows{}, "rows");
    RecordingRows v;
    v.rows = in.rows;
    v.obs = in.obs;
    v.action = in.action;
    v.label = in.label;
    v.reward = in.reward;
    v.cost = in.cost;
    v.terminated = in.terminated;
    v.truncated = in.truncated;
    v.success = in.success;
    v.episode = in.episode;
    v.num_states = in.num_states;
    v.state_row = in.state_row;
    v.state = in.state;
    v.points = in.points;
    v.point_class = in.point_class;
    v.point_color = in.point_color;
    x.append(v);
  });
}

rdm_result rdm_recording_append_all(rdm_recording* r, const rdm_recording* other) {
  return change(r, [&](Recording& x) {
    need_handle(other);
    const UseIfAny<const rdm_recording> use(other == r ? nullptr : other);
    x.append_all(*other->recording);
  });
}

rdm_result rdm_recording_filter(rdm_recording* r, int32_t need_success, const double* max_cost,
                                int64_t* dropped) {
  return change(r, [&](Recording& x) {
    if (need_success != 0 && need_success != 1)
      fail(Code::kRange, "need_success: %d is not 0 or 1", need_success);
    for (int32_t k = 0; max_cost && k < x.spec().cost_dim; ++k)
      if (std::isnan(max_cost[k])) fail(Code::kArgument, "max_cost[%d] is not a number", k);
    const int64_t count = x.filter(need_success != 0, max_cost);
    if (dropped) *dropped = count;
  });
}

rdm_result rdm_recording_clear(rdm_recording* r) {
  return change(r, [&](Recording& x) { x.clear(); });
}

rdm_result rdm_recording_write_file(const rdm_recording* r, const char* path) {
  return call_on(r, [&] {
    need(path, "path");
    const HostScope scope(r->hooks);
    Vector<unsigned char> file;
    r->recording->write(file);
    write_file(path, file.data(), file.size());
  });
}

rdm_result rdm_recording_read_file(rdm_recording** out, const char* path) {
  return call([&] {
    need(out, "out");
    need(path, "path");
    const HostHooks hooks = host();
    const FileSource file(path);
    char magic[4] = {};
    file.read(0, magic, std::min<size_t>(sizeof magic, static_cast<size_t>(file.size())));
    if (std::memcmp(magic, "PK\x03\x04", sizeof magic) != 0)
      fail(Code::kFormat, "%s: it is not a file of this kind (wrong magic number)", path);
    open_handle(out, hooks, [&] { return Recording::read(file, hooks); });
  });
}

#endif

#if RDM_WITH_SIM
rdm_result rdm_recording_config_for_pool(rdm_recording_config* c, const rdm_pool* p) {
  return call_with(c, p, [&] {
    auto config = read_struct(c, kFirstRecordingConfigSize, default_config(), "config");
    const Pool& pool = *p->pool;
    config.obs_dim = pool.obs_dim();
    config.action_dim = pool.task().action_dim();
    config.cost_dim = pool.cost_dim();
    config.task = task_at(pool.task_index()).name;
    config.layout_hash = layout_hash(pool.task());
    config.state_bytes = pool.state_size(0);
    config.num_points = pool.sense().num_points;
    config.point_color = pool.sensed().point_color != nullptr;
    write_struct(c, config, kFirstRecordingConfigSize, "config");
  });
}

namespace {

void check_match(const RecordingSpec& r, const Pool& p) {
  const auto same = [](int32_t recording, int32_t pool, const char* what) {
    if (recording != pool)
      fail(Code::kArgument, "%s: the recording has %d, but the pool has %d", what, recording, pool);
  };
  same(r.obs_dim, p.obs_dim(), "obs_dim");
  same(r.action_dim, p.task().action_dim(), "action_dim");
  same(r.cost_dim, p.cost_dim(), "cost_dim");
  if (r.num_points) same(r.num_points, p.sense().num_points, "num_points");
  if (r.point_color && !p.sensed().point_color)
    fail(Code::kArgument, "point_color: the recording has colours, but the pool has none");
  if (r.layout_hash && r.layout_hash != layout_hash(p.task()))
    fail(Code::kArgument, "layout_hash: the recording's differs from the pool's");
}

void check_rows(const char* name, const float* x, int32_t env, size_t width) {
  for (size_t j = 0; x && j < width; ++j)
    if (!std::isfinite(x[static_cast<size_t>(env) * width + j]))
      fail(Code::kArgument, "%s: row %d is not finite", name, env);
}

// A world that the next step only resets gets no row, because its action is ignored.
bool resets(const Pool& p, int32_t env) {
  const Buffers& b = p.buffers();
  return p.config().autoreset == Autoreset::kNextStep && (b.terminated[env] || b.truncated[env]);
}

}  // namespace

rdm_result rdm_recording_begin_step(rdm_recording* r, const rdm_pool* p, const float* label,
                                    const uint8_t* mask) {
  return change(r, [&](Recording& x) {
    const Use use(p);
    const Pool& pool = *p->pool;
    check_match(x.spec(), pool);
    const Buffers& b = pool.buffers();
    const int32_t n = pool.config().num_envs;
    const auto obs = static_cast<size_t>(x.spec().obs_dim),
               actions = static_cast<size_t>(x.spec().action_dim);
    const auto taken = [&](int32_t i) { return (!mask || mask[i]) && !resets(pool, i) && pool.running(i); };
    for (int32_t i = 0; i < n; ++i) {
      if ((!mask || mask[i]) && !pool.begun(i)) fail(Code::kState, "pool: world %d was not reset yet", i);
      if (!taken(i)) continue;
      check_rows("action", b.action, i, actions);
      check_rows("label", label, i, actions);
      if (const size_t size = x.spec().state_bytes ? pool.state_size(i) : 0; size != x.spec().state_bytes)
        fail(Code::kArgument, "state_bytes: the recording has %zu, but world %d has %zu",
             x.spec().state_bytes, i, size);
    }
    x.make_room(p, n);
    for (int32_t i = 0; i < n; ++i) {
      if (!taken(i)) continue;
      const auto row = static_cast<size_t>(i);
      const size_t cloud = row * static_cast<size_t>(x.spec().num_points);
      const SenseBuffers& seen = pool.sensed();
      x.begin_row(i, b.obs + row * obs, b.action + row * actions, label ? label + row * actions : nullptr,
                  seen.points + 3 * cloud, seen.point_class + cloud,
                  seen.point_color ? seen.point_color + 3 * cloud : nullptr);
      if (!x.state_due(i)) continue;
      Writer out(x.add_state(i), x.spec().state_bytes);
      pool.get_state(i, out);
    }
  });
}

rdm_result rdm_recording_end_step(rdm_recording* r, const rdm_pool* p, const uint8_t* mask) {
  return change(r, [&](Recording& x) {
    const Use use(p);
    const Pool& pool = *p->pool;
    if (!x.follows(p)) fail(Code::kState, "end_step: begin_step was not called with this pool before");
    const Buffers& b = pool.buffers();
    const auto costs = static_cast<size_t>(x.spec().cost_dim);
    for (int32_t i = 0; i < pool.config().num_envs; ++i)
      if (!mask || mask[i])
        x.end_row(i, b.reward[i], b.cost + static_cast<size_t>(i) * costs, b.terminated[i], b.truncated[i],
                  b.success[i]);
  });
}

rdm_result rdm_pool_set_starts(rdm_pool* p, const rdm_recording* r, double share) {
  return call_on(p, [&] {
    if (!r) return p->pool->set_starts(nullptr, 0, -1, 0, share);
    const Use use(r);
    const Recording& x = *r->recording;
    check_match(x.spec(), *p->pool);
    p->pool->set_starts(x.view().state, x.spec().state_bytes, x.num_states(), x.state_fingerprint(), share);
  });
}
#endif

#if RDM_WITH_LEARN
namespace {

DemoRows demo_rows(const Recording& x, const AgentConfig& a) {
  const RecordingSpec& s = x.spec();
  if (s.obs_dim != a.obs_dim || s.action_dim != a.action_dim)
    fail(Code::kArgument,
         "recording: its rows have %d observations and %d actions, but the agent's have %d and %d", s.obs_dim,
         s.action_dim, a.obs_dim, a.action_dim);
  if (s.layout_hash && a.layout_hash && s.layout_hash != a.layout_hash)
    fail(Code::kArgument, "recording: its layout differs from the agent's");
  if (x.rows() > INT32_MAX / 2)
    fail(Code::kRange, "recording: %lld rows are more than 2^30", static_cast<long long>(x.rows()));
  const RecordingRows v = x.view();
  return {static_cast<int32_t>(v.rows), v.obs, v.label, v.episode, {}};
}

// The recording's clouds in the encoder's units, in `memory`; none for an agent without an encoder.
PointRows demo_clouds(const Recording& x, const PointNetShape& eyes, Vector<int16_t>& memory) {
  PointRows out;
  const RecordingRows v = x.view();
  if (!eyes.points || !v.points) return out;
  if (x.spec().num_points != eyes.points)
    fail(Code::kArgument, "recording: its clouds have %d points, but the agent's encoder reads %d",
         x.spec().num_points, eyes.points);
  int32_t origin[3];
  for (int k = 0; k < 3; ++k)
    origin[k] = static_cast<int32_t>(std::lround(1000 * static_cast<double>(eyes.origin[k])));
  const size_t count = static_cast<size_t>(v.rows) * eyes.row_points();
  memory.resize(count);
  for (size_t i = 0; i < count; ++i)
    memory[i] = static_cast<int16_t>(std::clamp(v.points[i] - origin[i % 3], -32767, 32767));
  out.points = memory.data();
  if (eyes.classes) out.classes = v.point_class;
  if (eyes.color) out.colors = v.point_color;
  need_channels(eyes, out, static_cast<size_t>(v.rows));
  return out;
}

}  // namespace

rdm_result rdm_agent_clone(rdm_agent* a, const rdm_recording* r, const rdm_clone_config* how,
                           rdm_clone_report* io) {
  return call_on(a, [&] {
    const Use use(r);
    const auto in =
        how ? read_struct(how, sizeof(rdm_clone_config), default_clone(), "how") : default_clone();
    if (io) check_out(io, sizeof(rdm_clone_report), "io");
    if (in.feed_normalizer != 0 && in.feed_normalizer != 1)
      fail(Code::kRange, "how.feed_normalizer: %d is not 0 or 1", in.feed_normalizer);
    CloneOptions o;
    o.epochs = in.epochs;
    o.batch_rows = in.batch_rows;
    o.patience = in.patience;
    o.learning_rate = in.learning_rate;
    o.learning_rate_end = in.learning_rate_end;
    o.validation = in.validation;
    o.action_std = in.action_std;
    o.seed = in.seed;
    o.feed_normalizer = in.feed_normalizer != 0;
    o.capacity = in.capacity;
    o.train_loss = in.train_loss;
    o.validation_loss = in.validation_loss;
    const HostScope scope(r->hooks);
    Vector<int16_t> memory;
    DemoRows demo = demo_rows(*r->recording, a->agent->config());
    demo.clouds = demo_clouds(*r->recording, a->agent->eyes(), memory);
    const CloneReport report = a->agent->clone(demo, o);
    if (!io) return;
    rdm_clone_report out{};
    out.epochs = report.epochs;
    out.best_epoch = report.best_epoch;
    out.stopped = report.stopped;
    out.train_rows = report.train_rows;
    out.validation_rows = report.validation_rows;
    out.train_loss = report.train_loss;
    out.validation_loss = report.validation_loss;
    write_struct(io, out, sizeof(rdm_clone_report), "io");
  });
}

rdm_result rdm_agent_learn(rdm_agent* a, const rdm_recording* r, int64_t steps, rdm_learn_report* io) {
  return call_on(a, [&] {
    need_handle(r);
    const Use use(r);
    if (io) check_out(io, sizeof(rdm_learn_report), "io");
    if (steps < 0 || steps > int64_t{1} << 40)
      fail(Code::kRange, "steps: %lld is outside [0, 2^40]", static_cast<long long>(steps));
    const Recording& x = *r->recording;
    const AgentConfig& config = a->agent->config();
    demo_rows(x, config);  // dims, layout, count
    if (x.spec().cost_dim != config.cost_dim)
      fail(Code::kArgument, "recording: its rows have %d costs, but the agent's have %d", x.spec().cost_dim,
           config.cost_dim);
    if (x.rows() < 1) fail(Code::kArgument, "recording: it has no rows");
    const RecordingRows v = x.view();
    const LearnRows rows{v.rows, x.spec().cost_dim, v.obs,       v.action, v.reward,
                         v.cost, v.terminated,      v.truncated, v.episode};
    const LearnReport report = a->agent->learn(rows, steps);
    if (!io) return;
    rdm_learn_report out{};
    out.steps = report.steps;
    out.rows = report.rows;
    out.skipped_gradients = report.skipped;
    out.loss_policy = report.loss_policy;
    out.loss_reward_value = report.loss_reward_value;
    out.loss_cost_value = report.loss_cost_value;
    out.value_reward = report.value_reward;
    out.value_cost = report.value_cost;
    std::copy_n(report.cost, kMaxCosts, out.cost);
    std::copy_n(report.multiplier, kMaxCosts, out.multiplier);
    write_struct(io, out, sizeof(rdm_learn_report), "io");
  });
}

rdm_result rdm_agent_set_recording(rdm_agent* a, const rdm_recording* r) {
  return call_on(a, [&] {
    if (!r) return a->agent->set_recording({}, 0);
    const Use use(r);
    const HostScope scope(r->hooks);
    Vector<int16_t> memory;
    DemoRows demo = demo_rows(*r->recording, a->agent->config());
    demo.clouds = demo_clouds(*r->recording, a->agent->eyes(), memory);
    a->agent->set_recording(demo, r->recording->fingerprint());
  });
}
#endif
