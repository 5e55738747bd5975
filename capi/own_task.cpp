// rdm_task_create and the other calls for tasks of a host: the description becomes a row of the registry, and the
// host's functions become a Task.
#include "capi/own_task.hpp"

#if RDM_WITH_SIM
#include <cmath>
#include <cstdio>

#include "base/bit_cast.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "env/option_table.hpp"
#include "env/options/simulation.hpp"
#include "tasks/catalog.hpp"

using namespace rdm;
using namespace rdm::capi;

static_assert(kMaxTaskCosts == RDM_MAX_COSTS);
static_assert(sizeof(rdm_random) == sizeof(Stream));

namespace {

constexpr size_t kFirstSize = sizeof(rdm_task_def);
constexpr int32_t kMostRows = 512, kMostActions = 1024, kMostSteps = 100000;
constexpr size_t kLongestName = 40;
constexpr size_t kMostRowsAtOnce = 256, kChunkStates = size_t{1} << 22;  // worlds, bytes
constexpr uint64_t kMostState = uint64_t{1} << 20, kMostInstance = uint64_t{1} << 24;

rdm_task_def default_def() {
  rdm_task_def d{};
  d.max_steps = 100;
  return d;
}

// The options that every such task has, beside its own.
const OptionTable& simulation_rows() {
  struct Filled : SizedOptionTable<64> {
    Filled() {
      add_sim_options(*this);
      set_default("contacts_max", 0);  // as many as the scene needs, which is known once it is built
      set_default("speculative_contacts", 1);
    }
  };
  static const Filled table;
  return table;
}

void need_rows(const void* rows, int32_t count, int32_t least, const char* name, int32_t most = kMostRows) {
  if (count < least || count > most)
    fail(Code::kRange, "def.num_%s: %d is outside [%d, %d]", name, count, least, most);
  if (count > 0 && !rows) fail(Code::kArgument, "def.%s is NULL with num_%s %d", name, name, count);
}

void need_name(const char* name, const char* what, size_t longest) {
  if (!name) fail(Code::kArgument, "%s is NULL", what);
  const size_t length = std::strlen(name);
  if (length < 1 || length > longest)
    fail(Code::kRange, "%s: %s must have 1 to %zu characters", what, Quoted(name).text, longest);
  for (const char* at = name; *at; ++at)
    if (!((*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z') || (*at >= '0' && *at <= '9') ||
          std::strchr("_-.", *at)))
      fail(Code::kArgument, "%s: %s may contain only letters, digits, '_', '-' and '.'", what,
           Quoted(name).text);
}

void need_text(const char* text, const char* what) {
  if (!text) fail(Code::kArgument, "%s is NULL", what);
  if (!is_clean_text(text)) fail(Code::kArgument, "%s: it has control characters, or is not UTF-8", what);
}

struct RowName {  // "def.costs[2]" and a member
  RowName(const char* rows, int32_t i, const char* member) {
    print_text(text, sizeof text, "def.%s[%d].%s", rows, i, member);
  }
  char text[64];
};

const char* kind_name(OptionKind kind) {
  constexpr const char* kNames[] = {"RDM_KIND_NUMBER", "RDM_KIND_INTEGER", "RDM_KIND_FLAG", "RDM_KIND_TEXT"};
  return kNames[static_cast<int32_t>(kind)];
}

bool among(const char* word, const char* choices) {
  const size_t length = std::strlen(word);
  for (const char* at = choices;; ++at) {
    const size_t n = std::strcspn(at, "|");
    if (n == length && std::memcmp(at, word, n) == 0) return true;
    at += n;
    if (!*at) return false;
  }
}

// A build may make pools of other tasks. A build that makes a pool of its own task would recurse without end, so
// the depth is bounded.
constexpr int32_t kMostNested = 8;
thread_local int32_t t_nested = 0;  // builds of this thread that have not returned

struct Nested {
  explicit Nested(const char* task) {
    if (t_nested >= kMostNested)
      fail(Code::kState,
           "task %s: build: %d builds are nested: a build made a pool whose build made a pool, and so on",
           task, kMostNested);
    ++t_nested;
  }
  ~Nested() { --t_nested; }
  Nested(const Nested&) = delete;
  Nested& operator=(const Nested&) = delete;
};

// The task of one pool: it calls the host's functions with the pool's instance.
class BuiltTask final : public Task {
 public:
  BuiltTask(const OwnTask& own, const Options& o, void* user)
      : own_(own),
        engine_(engine_from(o)),
        max_steps_(o.integer("max_steps")),
        instance_(static_cast<size_t>(own.def.instance_bytes / sizeof(Block)) + 1) {
    const Nested nested(own.def.name);
    begin_scene(own, o, &scene_);
    scene_.user = user;
    struct Retire {
      rdm_scene* scene;
      ~Retire() { retire(scene); }
    } retired{&scene_};
    // build adds to the scene; what it left out is filled in afterwards, and errors of either name "build"
    own.run("build", [&] {
      const rdm_result r = own.def.build(own.def.user, &scene_, instance_.data());
      return r != RDM_OK ? r : call_inside([&] { complete_scene(&scene_); });
    });
    if (field_total(scene_.fields) > kMostEntries)
      fail(Code::kRange, "task %s: its fields have %d entries, but at most %d are allowed", own.def.name,
           field_total(scene_.fields), kMostEntries);
    scene_.options = nullptr;
    make_chunk();
  }

  const Scene& scene() const override { return scene_.scene; }
  EngineKind engine() const override { return engine_; }
  int32_t max_steps() const override { return max_steps_; }
  int32_t action_dim() const override { return static_cast<int32_t>(scene_.hold.size()); }
  const Vector<FieldSpec>& fields() const override { return scene_.fields; }
  const char* action_order() const override { return own_.def.action_order; }
  size_t state_bytes() const override { return static_cast<size_t>(own_.def.state_bytes); }
  float obs_limit() const override {
    return own_.def.obs_limit > 0 ? static_cast<float>(own_.def.obs_limit)
                                  : std::numeric_limits<float>::infinity();
  }
  void hold_action(float* action) const override {
    std::copy(scene_.hold.begin(), scene_.hold.end(), action);
  }
  void initial_mean(float* action) const override {
    std::copy(scene_.mean.begin(), scene_.mean.end(), action);
  }

  bool takes_rows() const override { return !chunk_.worlds.empty(); }
  void reset_rows(const TaskRows& r) const override;
  void control_rows(const TaskRows& r) const override;
  void judge_rows(const TaskRows& r) const override;
  void observe_rows(const TaskRows& r) const override;

  void check_state(const void* state) const override {
    const rdm_task_def& d = own_.def;
    if (!d.check_state) return;
    try {
      own_.run("check_state", [&] { return d.check_state(d.user, instance_.data(), state); });
    } catch (Error& e) {
      e.code = Code::kFormat;  // whatever code the host returned, the fault is in the bytes of the state
      throw;
    }
  }
  void reset(World& world, void* state, Stream& stream) const override {
    const rdm_task_def& d = own_.def;
    rdm_world w(&world, &scene_, false);
    scene_.draws.apply(world, stream);  // before the host's own draws, whose order it chooses
    auto random = rdm::bit_cast<rdm_random>(stream);
    const auto keep = [&] { stream = rdm::bit_cast<Stream>(random); };
    try {
      own_.run("reset", [&] {
        if (!d.reset_many) return d.reset(d.user, instance_.data(), &w, state, &random);
        Row row(&w, state);
        row.rows.randoms = &random;
        return row.result(d.reset_many(d.user, instance_.data(), &row.rows));
      });
    } catch (...) {
      keep();  // also after a failure, or the next reset would draw the same numbers and fail again
      throw;
    }
    keep();
  }
  void control(World& world, void* state, const float* action) const override {
    const rdm_task_def& d = own_.def;
    rdm_world w(&world, &scene_, false);
    own_.run("control", [&] {
      if (!d.control_many) return d.control(d.user, instance_.data(), &w, state, action);
      Row row(&w, state);
      row.rows.actions = action;
      return row.result(d.control_many(d.user, instance_.data(), &row.rows));
    });
  }
  Verdict judge(World& world, void* state, int32_t step) const override {
    const rdm_task_def& d = own_.def;
    rdm_world w(&world, &scene_, false);
    rdm_verdict out{};
    own_.run("judge", [&] {
      if (!d.judge_many) return d.judge(d.user, instance_.data(), &w, state, step, &out);
      Row row(&w, state);
      row.rows.steps = &step, row.rows.verdicts = &out;
      return row.result(d.judge_many(d.user, instance_.data(), &row.rows));
    });
    return verdict_of(out);
  }
  void observe(const World& world, const void* state, float* obs) const override {
    const rdm_task_def& d = own_.def;
    rdm_world w(const_cast<World*>(&world), &scene_, true);
    own_.run("observe", [&] {
      if (!d.observe_many) return d.observe(d.user, instance_.data(), &w, state, obs);
      Row row(&w, const_cast<void*>(state));
      row.rows.obs = obs;
      return row.result(d.observe_many(d.user, instance_.data(), &row.rows));
    });
  }

 private:
  // One world for a function of many.
  struct Row {
    Row(rdm_world* w, void* state) : world(w) {
      rows.struct_size = sizeof rows;
      rows.count = 1;
      rows.worlds = &world;
      rows.states = state;
      rows.results = &own;
    }
    rdm_result result(rdm_result of_all) const { return of_all != RDM_OK ? of_all : own; }
    rdm_world* world;
    rdm_result own = RDM_OK;
    rdm_task_rows rows{};
  };
  // Many worlds for one, so many at a time.
  struct Chunk {
    Vector<rdm_world> worlds;  // [most]
    Vector<rdm_world*> handles;
    Vector<unsigned char> states;  // [most][state_bytes]
    Vector<rdm_result> results;
    Vector<rdm_random> randoms;
    Vector<rdm_verdict> verdicts;
  };
  Verdict verdict_of(const rdm_verdict& out) const;
  void make_chunk();
  template <class F>
  void each_chunk(const char* function, bool fixed, const TaskRows& r, F&& f) const;

 private:
  struct alignas(std::max_align_t) Block {  // bytes alone: of a max_align_t the padding is not zeroed
    unsigned char bytes[alignof(std::max_align_t)];
  };
  const OwnTask& own_;
  EngineKind engine_;
  int32_t max_steps_;
  rdm_scene scene_;
  Vector<Block> instance_;  // zeroed
  mutable Chunk chunk_;     // of a task with a function of many; a pool is used by one thread at a time
};

Verdict BuiltTask::verdict_of(const rdm_verdict& out) const {
  const rdm_task_def& d = own_.def;
  Verdict v;
  v.reward = out.reward;
  for (int32_t k = 0; k < d.num_costs; ++k) {
    if (out.cost[k] < 0)
      fail(Code::kRange, "task %s: judge: cost %s is %g, but it must be 0 or more", d.name,
           own_.info().costs[k].name, out.cost[k]);
    v.cost[k] = out.cost[k];
    v.cost_raw[k] = out.cost_raw[k];
  }
  v.terminated = out.terminated != 0;
  v.success = out.success != 0;
  return v;
}

void BuiltTask::make_chunk() {
  const rdm_task_def& d = own_.def;
  if (!d.reset_many && !d.control_many && !d.judge_many && !d.observe_many) return;
  const size_t state = static_cast<size_t>(d.state_bytes),
               most = std::clamp<size_t>(kChunkStates / std::max<size_t>(state, 1), 1, kMostRowsAtOnce);
  chunk_.worlds.resize(most);
  for (rdm_world& w : chunk_.worlds) w.scene = &scene_, chunk_.handles.push_back(&w);
  chunk_.states.resize(most * state);
  chunk_.results.resize(most);
  chunk_.randoms.resize(most);
  chunk_.verdicts.resize(most);
}

// f(rows, begin, count) for runs of the rows: it calls the host's function. `fixed`: states and worlds are only
// looked at.
template <class F>
void BuiltTask::each_chunk(const char* function, bool fixed, const TaskRows& r, F&& f) const {
  const auto most = static_cast<int32_t>(chunk_.worlds.size());
  const size_t state = state_bytes();
  for (int32_t begin = 0; begin < r.count; begin += most) {
    const int32_t count = std::min(most, r.count - begin);
    for (int32_t k = 0; k < count; ++k) {
      const auto i = static_cast<size_t>(k);
      chunk_.worlds[i].tag = rdm_world::kTag;
      chunk_.worlds[i].world = r.worlds[begin + k];
      chunk_.worlds[i].fixed = fixed;
      if (state > 0) std::memcpy(chunk_.states.data() + i * state, r.states[begin + k], state);
    }
    std::fill_n(chunk_.results.begin(), count, RDM_OK);
    rdm_task_rows rows{};
    rows.struct_size = sizeof rows;
    rows.count = count;
    rows.worlds = chunk_.handles.data();
    rows.states = state > 0 ? chunk_.states.data() : nullptr;
    rows.results = chunk_.results.data();
    struct Retire {  // handles are good within the call alone
      Chunk* chunk;
      int32_t count;
      ~Retire() {
        for (int32_t k = 0; k < count; ++k) retire(&chunk->worlds[static_cast<size_t>(k)]);
      }
    } retired{&chunk_, count};
    own_.run(function, [&] { return f(&rows, begin, count); });
    for (int32_t k = 0; k < count; ++k) {
      const auto i = static_cast<size_t>(k);
      if (chunk_.results[i] != RDM_OK) {
        try {
          own_.blame(function, chunk_.results[i], false);
        } catch (const Error& e) {
          r.codes[begin + k] = e.code;
          copy_text(r.texts[begin + k], kErrorTextSize, e.text);
        }
      }
      if (state > 0 && !fixed) std::memcpy(r.states[begin + k], chunk_.states.data() + i * state, state);
    }
  }
}

// A function that takes one world alone, for each row; what fails in it is that row's.
template <class F>
void each_row(const TaskRows& r, F&& f) {
  for (int32_t k = 0; k < r.count; ++k) {
    try {
      f(k);
    } catch (const Error& e) {
      r.codes[k] = e.code;
      copy_text(r.texts[k], kErrorTextSize, e.text);
    }
  }
}

void BuiltTask::reset_rows(const TaskRows& r) const {
  const rdm_task_def& d = own_.def;
  if (!d.reset_many) return each_row(r, [&](int32_t k) { reset(*r.worlds[k], r.states[k], *r.streams[k]); });
  for (int32_t k = 0; k < r.count; ++k) scene_.draws.apply(*r.worlds[k], *r.streams[k]);
  each_chunk("reset", false, r, [&](rdm_task_rows* rows, int32_t begin, int32_t count) {
    rows->randoms = chunk_.randoms.data();
    for (int32_t k = 0; k < count; ++k) rows->randoms[k] = rdm::bit_cast<rdm_random>(*r.streams[begin + k]);
    const rdm_result result = d.reset_many(d.user, instance_.data(), rows);
    for (int32_t k = 0; k < count; ++k) *r.streams[begin + k] = rdm::bit_cast<Stream>(rows->randoms[k]);
    return result;
  });
}

void BuiltTask::control_rows(const TaskRows& r) const {
  const rdm_task_def& d = own_.def;
  const ptrdiff_t dim = action_dim();
  if (!d.control_many)
    return each_row(r, [&](int32_t k) { control(*r.worlds[k], r.states[k], r.actions + k * dim); });
  each_chunk("control", false, r, [&](rdm_task_rows* rows, int32_t begin, int32_t) {
    rows->actions = r.actions + begin * dim;
    return d.control_many(d.user, instance_.data(), rows);
  });
}

void BuiltTask::judge_rows(const TaskRows& r) const {
  const rdm_task_def& d = own_.def;
  if (!d.judge_many)
    return each_row(r, [&](int32_t k) { r.verdicts[k] = judge(*r.worlds[k], r.states[k], r.steps[k]); });
  each_chunk("judge", false, r, [&](rdm_task_rows* rows, int32_t begin, int32_t count) {
    rows->steps = r.steps + begin;
    rows->verdicts = chunk_.verdicts.data();
    std::fill_n(rows->verdicts, count, rdm_verdict{});
    const rdm_result result = d.judge_many(d.user, instance_.data(), rows);
    for (int32_t k = 0; result == RDM_OK && k < count; ++k) {
      if (rows->results[k] != RDM_OK) continue;
      // a cost below 0 is that row's fault alone
      try {
        r.verdicts[begin + k] = verdict_of(rows->verdicts[k]);
      } catch (const Error& e) {
        r.codes[begin + k] = e.code;
        copy_text(r.texts[begin + k], kErrorTextSize, e.text);
      }
    }
    return result;
  });
}

void BuiltTask::observe_rows(const TaskRows& r) const {
  const rdm_task_def& d = own_.def;
  const ptrdiff_t dim = field_total(scene_.fields);
  if (!d.observe_many)
    return each_row(r, [&](int32_t k) { observe(*r.worlds[k], r.states[k], r.obs + k * dim); });
  each_chunk("observe", true, r, [&](rdm_task_rows* rows, int32_t begin, int32_t) {
    rows->obs = r.obs + begin * dim;
    return d.observe_many(d.user, instance_.data(), rows);
  });
}

}  // namespace

const char* TextStore::keep(const char* text) {
  if (!text) return nullptr;
  texts_.emplace_back(text, text + std::strlen(text) + 1);
  return texts_.back().data();
}

void rdm::capi::check_action_dim(int64_t count, const char* name) {
  if (count < 1 || count > kMostActions)
    fail(Code::kRange, "%s: %lld is outside [1, %d]", name, static_cast<long long>(count), kMostActions);
}

void rdm::capi::copy_actions(const float* in, int32_t count, const char* name, Vector<float>* out) {
  out->assign(static_cast<size_t>(count), 0.0f);
  for (int32_t i = 0; in && i < count; ++i) {
    if (!(std::fabs(in[i]) <= 1))
      fail(Code::kRange, "%s[%d]: %g is outside [-1, 1]", name, i, static_cast<double>(in[i]));
    (*out)[static_cast<size_t>(i)] = in[i];
  }
}

OwnTask::OwnTask(const rdm_task_def& d, const HostHooks& hooks) : def(d), hooks_(hooks) {
  need_name(d.name, "def.name", kLongestName);
  def.name = texts_.keep(d.name);
  if (d.summary) need_text(d.summary, "def.summary");
  def.summary = texts_.keep(d.summary ? d.summary : "");
  if (d.action_order) need_text(d.action_order, "def.action_order");
  def.action_order = texts_.keep(d.action_order ? d.action_order : "action");
  if (d.max_steps < 1 || d.max_steps > kMostSteps)
    fail(Code::kRange, "def.max_steps: %d is outside [1, %d]", d.max_steps, kMostSteps);
  if (!(d.obs_limit >= 0 && d.obs_limit <= 1e30))
    fail(Code::kRange, "def.obs_limit: %g is outside [0, 1e30]", d.obs_limit);
  if (d.state_bytes > kMostState)
    fail(Code::kRange, "def.state_bytes: %llu is above %llu", static_cast<unsigned long long>(d.state_bytes),
         static_cast<unsigned long long>(kMostState));
  if (d.instance_bytes > kMostInstance)
    fail(Code::kRange, "def.instance_bytes: %llu is above %llu",
         static_cast<unsigned long long>(d.instance_bytes), static_cast<unsigned long long>(kMostInstance));
  const auto required = [](bool given, const char* name) {
    if (!given) fail(Code::kArgument, "def.%s is NULL", name);
  };
  required(d.build, "build");
  required(d.reset || d.reset_many, "reset");
  required(d.control || d.control_many, "control");
  required(d.judge || d.judge_many, "judge");
  required(d.observe || d.observe_many, "observe");
  take_fields();
  take_costs();
  take_options();
  take_cameras();
  take_defaults();
  take_actions();
  info_.name = def.name;
  info_.summary = def.summary;
  info_.costs = costs_.data();
  info_.num_costs = def.num_costs;
  info_.cameras = cameras_.data();
  info_.num_cameras = static_cast<int32_t>(cameras_.size());
  info_.defaults = defaults_.data();
  info_.num_defaults = static_cast<int32_t>(defaults_.size());
  info_.source = this;
}

void OwnTask::take_fields() {
  need_rows(def.fields, def.num_fields, 1, "fields");
  int64_t total = 0;
  for (int32_t i = 0; i < def.num_fields; ++i) {
    const rdm_field_def& f = def.fields[i];
    char row[32];
    print_text(row, sizeof row, "def.fields[%d]", i);
    check_reserved(f, row);
    need_name(f.name, RowName("fields", i, "name").text, kNameSize - 1);
    need_text(f.unit, RowName("fields", i, "unit").text);
    if (f.count < 1 || f.count > kMostEntries)
      fail(Code::kRange, "def.fields[%d].count: %d of %s is outside [1, %d]", i, f.count, f.name,
           kMostEntries);
    total += f.count;
    const bool bounded = f.low != f.high;
    if (bounded && !(f.low < f.high))
      fail(Code::kRange, "def.fields[%d]: low %g of %s is not below high %g", i, static_cast<double>(f.low),
           f.name, static_cast<double>(f.high));
    for (const FieldSpec& other : fields)
      if (other.name == f.name) fail(Code::kArgument, "def.fields[%d].name: %s occurs twice", i, f.name);
    fields.push_back({Name(f.name), texts_.keep(f.unit), f.count, bounded ? f.low : kUnbounded,
                      bounded ? f.high : kUnbounded});
  }
  if (total > kMostEntries)
    fail(Code::kRange, "def.fields: they have %lld entries, but at most %d are allowed",
         static_cast<long long>(total), kMostEntries);
}

void OwnTask::take_costs() {
  need_rows(def.costs, def.num_costs, 1, "costs", kMaxTaskCosts);
  for (int32_t i = 0; i < def.num_costs; ++i) {
    const rdm_cost_def& c = def.costs[i];
    need_name(c.name, RowName("costs", i, "name").text, kNameSize - 1);
    if (c.help) need_text(c.help, RowName("costs", i, "help").text);
    if (!std::isfinite(c.limit)) fail(Code::kArgument, "def.costs[%d].limit of %s is not finite", i, c.name);
    for (const CostSpec& other : costs_)
      if (same_name(other.name, c.name))
        fail(Code::kArgument, "def.costs[%d].name: %s occurs twice", i, c.name);
    costs_.push_back({texts_.keep(c.name), texts_.keep(c.help ? c.help : ""), c.limit});
  }
}

void OwnTask::take_options() {
  need_rows(def.options, def.num_options, 0, "options");
  const OptionTable& shared = simulation_rows();
  Vector<OptionSpec> tail(shared.rows(), shared.rows() + shared.count());
  for (int32_t i = 0; i < def.num_options; ++i) {
    const rdm_option_def& o = def.options[i];
    const RowName key("options", i, "key");
    need_name(o.key, key.text, OptionTable::kKeySize - 1);
    if (o.kind < RDM_KIND_NUMBER || o.kind > RDM_KIND_TEXT)
      fail(Code::kRange, "def.options[%d].kind: %d of %s is outside [0, 3]", i, o.kind, o.key);
    const auto kind = static_cast<OptionKind>(o.kind);
    // for the key of an option that every task has, the host only sets the default; other keys are new options
    OptionSpec* row = nullptr;
    for (OptionSpec& r : tail)
      if (same_name(r.key, o.key)) row = &r;
    if (row && row->kind != kind)
      fail(Code::kArgument, "def.options[%d].kind: %s is an option of every task and of kind %s", i, row->key,
           kind_name(row->kind));
    for (const OptionSpec& other : options_)
      if (same_name(other.key, o.key)) fail(Code::kArgument, "%s: %s occurs twice", key.text, o.key);
    if (same_name(o.key, "max_steps"))
      fail(Code::kArgument, "%s: max_steps is not an option; set def.max_steps", key.text);
    OptionSpec made = basic(number_option("", 0, 0, 0, ""));
    if (row) {
      made = *row;
    } else {
      need_text(o.help, RowName("options", i, "help").text);
      const bool ranged = o.choices && kind != OptionKind::kText;
      if (ranged && (std::strcmp(o.choices, "a..b") != 0 || kind == OptionKind::kFlag))
        fail(Code::kArgument,
             "def.options[%d].choices of %s: for a number or an integer it must be \"a..b\" or NULL", i,
             o.key);
      if (o.choices) need_text(o.choices, RowName("options", i, "choices").text);
      made.key = texts_.keep(o.key);
      made.kind = kind;
      made.low = o.low, made.high = o.high;
      made.choices = ranged ? nullptr : texts_.keep(o.choices);
      made.help = texts_.keep(o.help);
      made.range = ranged;
      if (kind == OptionKind::kFlag) made.low = 0, made.high = 1;
      // integers are read into 32 bits
      const bool wide = made.low < -0x1p31 || made.high > 0x1p31 - 1;
      if (kind == OptionKind::kInteger && wide)
        fail(Code::kRange, "def.options[%d]: low %s or high %s of %s is outside [-2147483648, 2147483647]", i,
             Number(o.low).text, Number(o.high).text, o.key);
      if (kind != OptionKind::kText && !(made.low < made.high))
        fail(Code::kRange, "def.options[%d]: low %s of %s is not below high %s", i, Number(o.low).text, o.key,
             Number(o.high).text);
    }
    if (kind == OptionKind::kText) {
      need_text(o.text, RowName("options", i, "text").text);
      if (std::strlen(o.text) > static_cast<size_t>(made.longest))
        fail(Code::kRange, "def.options[%d].text of %s is longer than %d", i, o.key, made.longest);
      if (made.choices && !among(o.text, made.choices))
        fail(Code::kRange, "def.options[%d].text: %s of %s is not one of %s", i, Quoted(o.text).text, o.key,
             made.choices);
      made.text = texts_.keep(o.text);
    } else {
      made.number = o.number;
      made.text = nullptr;
      if (!(o.number >= made.low && o.number <= made.high) ||
          (kind != OptionKind::kNumber && o.number != std::floor(o.number)))
        fail(Code::kRange, "def.options[%d].number: %s of %s is outside [%s, %s], or not an integer", i,
             Number(o.number).text, o.key, Number(made.low).text, Number(made.high).text);
      if (o.text && made.range) {  // read as a pool will, so that a wrong one is told here
        Options trial;
        trial.add_table(&made, 1);
        trial.set({made.key, o.text, 0}, RowName("options", i, "text").text);
        made.text = texts_.keep(o.text);
      } else if (o.text) {
        fail(Code::kArgument,
             "def.options[%d].text of %s: only a text, or a number that takes a range, has one", i, o.key);
      }
    }
    if (row)
      *row = made;
    else
      options_.push_back(made);
  }
  // order of the table: the host's own, max_steps, those that every task has
  options_.push_back(
      integer_option("max_steps", def.max_steps, 1, kMostSteps, "number of control steps in an episode"));
  options_.insert(options_.end(), tail.begin(), tail.end());
}

void OwnTask::take_cameras() {
  need_rows(def.cameras, def.num_cameras, 0, "cameras");
  for (int32_t i = 0; i < def.num_cameras; ++i) {
    const rdm_camera_def& c = def.cameras[i];
    char row[32];
    print_text(row, sizeof row, "def.cameras[%d]", i);
    check_reserved(c, row);
    need_name(c.name, RowName("cameras", i, "name").text, kNameSize - 1);
    CameraSpec spec{nullptr, {}, {}, static_cast<double>(c.fov_y)};
    Vec3 up;
    for (int k = 0; k < 3; ++k) {
      spec.eye[k] = static_cast<double>(c.eye[k]);
      spec.target[k] = static_cast<double>(c.target[k]);
      up[k] = static_cast<double>(c.up[k]);
    }
    if (!finite(spec.eye) || !finite(spec.target) || !(norm(spec.eye - spec.target) > 0))
      fail(Code::kArgument, "def.cameras[%d]: eye and target of %s are the same, or not finite", i, c.name);
    if (!(c.fov_y >= 0.01f && c.fov_y <= 3))
      fail(Code::kRange, "def.cameras[%d].fov_y: %g of %s is outside [0.01, 3]", i, spec.fov_y, c.name);
    if (!finite(up)) fail(Code::kArgument, "def.cameras[%d].up of %s is not finite", i, c.name);
    if (norm(up) > 0) spec.up = normalized(up);
    spec.cx = static_cast<double>(c.cx), spec.cy = static_cast<double>(c.cy);
    for (const double shift : {spec.cx, spec.cy})
      if (!(std::abs(shift) <= kMaxShift))
        fail(Code::kRange, "def.cameras[%d]: cx or cy of %s is %g, outside [-%g, %g]", i, c.name, shift,
             kMaxShift, kMaxShift);
    spec.mount = c.mount;  // a pool checks it, whose scene is built
    for (const CameraSpec& other : cameras_)
      if (same_name(other.name, c.name))
        fail(Code::kArgument, "def.cameras[%d].name: %s occurs twice", i, c.name);
    spec.name = texts_.keep(c.name);
    cameras_.push_back(spec);
  }
  if (cameras_.empty()) cameras_.push_back({"front", {0.7, -0.7, 0.6}, {}, 45 * kDegree});
}

void OwnTask::take_defaults() {
  need_rows(def.defaults, def.num_defaults, 0, "defaults");
  for (int32_t i = 0; i < def.num_defaults; ++i) {
    const rdm_option& d = def.defaults[i];
    need_text(d.key, RowName("defaults", i, "key").text);
    char number[kOptionTextSize];
    const char* text = d.text;
    if (!text) {  // defaults are kept as texts, from which a number reads back exactly
      if (!std::isfinite(d.number))
        fail(Code::kArgument, "def.defaults[%d].number of %s is not finite", i, d.key);
      print_text(number, sizeof number, "%.17g", d.number);
      text = number;
    }
    need_text(text, RowName("defaults", i, "text").text);
    const char* key = texts_.keep(d.key);
    defaults_.push_back({key, texts_.keep(text)});
  }
}

void OwnTask::take_actions() {
  check_action_dim(def.action_dim, "def.action_dim");
  copy_actions(def.hold, def.action_dim, "def.hold", &hold);
  copy_actions(def.mean, def.action_dim, "def.mean", &mean);
}

const OptionSpec* OwnTask::options(int32_t* count) const {
  *count = static_cast<int32_t>(options_.size());
  return options_.data();
}

Task* OwnTask::make(const Options& options, const HostHooks& hooks, void* user) const {
  const HostScope scope(hooks);
  return host_new<BuiltTask>(hooks, *this, options, user);
}

void OwnTask::destroy(Task* task, const HostHooks& hooks) const {
  host_delete(hooks, static_cast<BuiltTask*>(task));
}

void OwnTask::end() noexcept {
  // copies: `this` is gone before the host's function runs
  const auto release = def.release;
  void* const user = def.user;
  const HostHooks hooks = hooks_;
  char name[kLongestName + 1];
  copy_text(name, sizeof name, def.name);
  host_delete(hooks, this);
  if (!release) return;
  try {
    release(user);
  } catch (...) {
    log(hooks, LogLevel::kError, "task %s: release: an exception came out of it", name);
  }
}

void OwnTask::blame(const char* function, rdm_result r, bool thrown) const {
  if (thrown) fail(Code::kArgument, "task %s: %s threw an exception", def.name, function);
  // a host may return any code that has a meaning here, and nothing else
  if (r > 0 ||
      (r < static_cast<rdm_result>(RDM_ERROR_CANCELLED) && r != static_cast<rdm_result>(RDM_ERROR_INTERNAL)))
    fail(Code::kArgument, "task %s: %s returned %d, which is not an rdm_result", def.name, function, r);
  char text[kErrorTextSize];
  copy_text(text, sizeof text, failure_noted() ? last_error() : code_string(r));
  fail(static_cast<Code>(r), "task %s: %s: %s", def.name, function, text);
}

rdm_result rdm_task_def_init(rdm_task_def* def, size_t size) {
  return call([&] { init_struct(def, size, kFirstSize, default_def(), "def"); });
}

rdm_result rdm_task_create(int32_t* out, const rdm_task_def* def) {
  return call([&] {
    need(out, "out");
    register_builtin_tasks();
    const auto in = read_struct(def, kFirstSize, default_def(), "def");
    const HostHooks hooks = host();
    OwnTask* own = host_new<OwnTask>(hooks, in, hooks);
    try {
      *out = add_task(own);
    } catch (...) {
      host_delete(hooks, own);
      throw;
    }
  });
}

rdm_result rdm_task_destroy(int32_t task) {
  return call([&] {
    remove_task(task);
    forget_task(task);
  });
}
#endif
