// rdm_agent_*: config to agent and back.
#include <algorithm>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "base/file.hpp"
#include "base/text.hpp"
#include "capi/handles.hpp"

using namespace rdm;
using namespace rdm::capi;

rdm_result rdm_agent_config_init(rdm_agent_config* c, size_t size) {
  return call([&] {
    rdm_agent_config d{};
    d.cost_dim = 1;
    d.algo = "ppo_lag";
    d.task = "";
    init_struct(c, size, kFirstAgentConfigSize, d, "c");
  });
}

namespace {
rdm_pretrain_config default_pretrain() {
  rdm_pretrain_config d{};
  d.epochs = 20;
  d.batch_rows = 16;
  d.learning_rate = 1e-3;
  d.validation = 0.1;
  return d;
}
}  // namespace

rdm_result rdm_pretrain_config_init(rdm_pretrain_config* how, size_t size) {
  return call([&] { init_struct(how, size, sizeof(rdm_pretrain_config), default_pretrain(), "how"); });
}

#if RDM_WITH_LEARN
namespace {

constexpr int32_t kMaxPretrainRows = 1 << 20;

constexpr int32_t kMaxValueRows = 1 << 24;  // of rdm_agent_get_values

// A public config as the library takes it, with the option lists that it points to.
struct Config {
  AgentConfig agent;
  Vector<OptionInput> defaults, options;
  Vector<ObsField> fields;
};

// Of a task's defaults, as "actor_obs", "ppo_lag:actor_obs" or a set of groups.
bool names_fields(const OptionInput& option) {
  const std::string_view key = option.key ? option.key : "";
  return key.ends_with("actor_obs") || key.ends_with("critic_obs") || is_group_set(option.key);
}

void read_agent_config(const rdm_agent_config* c, Config* out) {
  const auto in = read_struct(c, kFirstAgentConfigSize, rdm_agent_config{}, "config");
  check_error(in);
  AgentConfig& a = out->agent;
  need(in.algo, "config.algo");
  a.hooks = hooks_from(in.host);
  a.obs_dim = in.obs_dim;
  a.action_dim = in.action_dim;
  a.cost_dim = in.cost_dim;
  a.num_envs = in.num_envs;
  a.num_threads = in.num_threads;
  a.algo = in.algo;
  a.task = in.task ? in.task : "";
  a.seed = in.seed;
  a.layout_hash = in.layout_hash;
  a.control_dt = in.control_dt;
  a.max_steps = in.max_steps;
  a.initial_mean = in.initial_mean;
  a.cost_limits = in.cost_limits;
  out->defaults = read_options(in.defaults, in.num_defaults, "defaults");
  out->options = read_options(in.options, in.num_options, "options");
  // A host that was compiled before configs had `fields` cannot name the parts of a row: its agents observe all.
  if (c->struct_size <= offsetof(rdm_agent_config, fields))
    out->defaults.erase(std::remove_if(out->defaults.begin(), out->defaults.end(), names_fields),
                        out->defaults.end());
  a.defaults = out->defaults.data();
  a.num_defaults = static_cast<int32_t>(out->defaults.size());
  a.options = out->options.data();
  a.num_options = in.num_options;
  a.settings = in.settings;
  if (in.num_fields < 0 || in.num_fields > kMaxFields)
    fail(Code::kRange, "config.num_fields: %d is outside [0, %d]", in.num_fields, kMaxFields);
  if (in.num_fields > 0) need(in.fields, "config.fields");
  for (int32_t i = 0; i < in.num_fields; ++i)
    out->fields.push_back({in.fields[i].name, in.fields[i].offset, in.fields[i].count,
                           in.fields[i].unit ? in.fields[i].unit : ""});
  a.fields = out->fields.data();
  a.num_fields = in.num_fields;
}

RankHooks read_ranks(const rdm_ranks* ranks) {
  const auto in = read_struct(ranks, sizeof(rdm_ranks), rdm_ranks{}, "ranks");
  return {in.rank, in.ranks, in.user, in.gather, in.swap, RDM_VERSION};
}

DecisionBuffers carve_decision(Arena& arena, const AgentConfig& c) {
  const auto n = static_cast<size_t>(c.num_envs);
  DecisionBuffers d;
  d.reward = arena.make<float>(n);
  d.cost = arena.make<float>(n * static_cast<size_t>(c.cost_dim));
  d.steps = arena.make<int32_t>(n);
  d.limit = arena.make<float>(n);
  d.mask = arena.make<uint8_t>(n);
  d.valid = arena.make<uint8_t>(n);
  d.terminated = arena.make<uint8_t>(n);
  d.truncated = arena.make<uint8_t>(n);
  d.success = arena.make<uint8_t>(n);
  d.status = arena.make<uint32_t>(n);
  return d;
}

}  // namespace

rdm_result rdm_agent_config_memory(const rdm_agent_config* c, size_t* bytes) {
  return call_with(c, [&] {
    need(bytes, "bytes");
    Config config;
    read_agent_config(c, &config);
    const size_t inner = Agent::memory(config.agent);  // validates the dimensions first
    Arena measure;
    carve_decision(measure, config.agent);
    *bytes = inner + measure.used() + sizeof(rdm_agent);
  });
}

rdm_result rdm_agent_group_at(const rdm_agent_config* c, const char* groups, int32_t i, rdm_group* io,
                              char* name, int32_t* columns, size_t capacity) {
  return call_with(c, [&] {
    check_out(io, sizeof(rdm_group), "io");
    need(name, "name");
    need_room(columns, capacity, "columns");
    Config config;
    read_agent_config(c, &config);
    const HostScope scope(config.agent.hooks);
    const Vector<GroupSpec> all = parse_groups(config.agent, groups ? groups : "auto");
    const int32_t dim = config.agent.obs_dim, count = std::max(static_cast<int32_t>(all.size()), 1);
    need_index(i, count, "i");
    GroupSpec one;
    std::strcpy(one.name, "all");
    one.count = config.agent.action_dim;
    const GroupSpec& g = all.empty() ? one : all[static_cast<size_t>(i)];
    rdm_group out{};
    out.first = g.first, out.count = g.count;
    out.num_columns = g.columns.empty() ? dim : static_cast<int32_t>(g.columns.size());
    std::strcpy(name, g.name);
    write_struct(io, out, sizeof(rdm_group), "io");
    for (size_t k = 0; k < std::min(capacity, static_cast<size_t>(out.num_columns)); ++k)
      columns[k] = g.columns.empty() ? static_cast<int32_t>(k) : g.columns[k];
  });
}

namespace {

rdm_result create_agent(rdm_agent** out, const rdm_agent_config* c, const rdm_ranks* ranks) {
  return call_with(c, [&] {
    need(out, "out");
    Config config;
    read_agent_config(c, &config);
    if (ranks) config.agent.ranks = read_ranks(ranks);
    const HostHooks hooks = config.agent.hooks;
    const HostScope scope(hooks);
    rdm_agent* a = host_new<rdm_agent>(hooks);
    a->hooks = hooks;
    try {
      a->agent = Agent::create(config.agent);
      Arena measure;
      carve_decision(measure, config.agent);
      a->arena = Arena(hooks, measure.used());
      a->decision = carve_decision(a->arena, config.agent);
    } catch (...) {
      rdm_agent_destroy(a);
      throw;
    }
    *out = a;
  });
}

}  // namespace

rdm_result rdm_agent_create(rdm_agent** out, const rdm_agent_config* c) {
  return create_agent(out, c, nullptr);
}

rdm_result rdm_agent_create_ranked(rdm_agent** out, const rdm_agent_config* c, const rdm_ranks* ranks) {
  const rdm_result r = call_with(c, [&] { need(ranks, "ranks"); });
  return r == RDM_OK ? create_agent(out, c, ranks) : r;
}

void rdm_agent_destroy(rdm_agent* a) {
  if (!may_end(a)) return;
  Agent::destroy(a->agent);
  retire(a);
  host_delete(a->hooks, a);
}

const char* rdm_agent_error(const rdm_agent* a) {
  return is_handle(a) ? a->error : "agent: NULL, not an agent, or destroyed";
}

namespace {

void need_mode(int32_t mode) {
  if (mode != RDM_ACT_SAMPLE && mode != RDM_ACT_MEAN)
    fail(Code::kRange, "mode: %d is not RDM_ACT_SAMPLE or RDM_ACT_MEAN", mode);
}

// Whether actions are sampled.
bool read_act(const float* obs, int32_t mode, const float* action) {
  need(obs, "obs");
  need(action, "action");
  need_mode(mode);
  return mode == RDM_ACT_SAMPLE;
}

}  // namespace

rdm_result rdm_agent_act(rdm_agent* a, const float* obs, int32_t mode, float* action) {
  return call_on(a, [&] {
    const bool sample = read_act(obs, mode, action);
    a->agent->act(obs, sample, action);
  });
}

rdm_result rdm_agent_act_points(rdm_agent* a, const float* obs, const rdm_points* points, int32_t mode,
                                float* action) {
  return call_on(a, [&] {
    const bool sample = read_act(obs, mode, action);
    if (!a->agent->eyes().points)
      fail(Code::kState, "points: the agent has no encoder, so it cannot read them");
    a->agent->act(obs, sample, action, read_points(points, a->agent->eyes()));
  });
}

rdm_result rdm_agent_forget(rdm_agent* a, int32_t mode, const uint8_t* mask) {
  return call_on(a, [&] {
    need_mode(mode);
    a->agent->forget(mode == RDM_ACT_MEAN, mask);
  });
}

rdm_result rdm_agent_pretrain(rdm_agent* a, const rdm_points* points, const uint8_t* label, int32_t rows,
                              const rdm_pretrain_config* how, rdm_pretrain_report* io) {
  return call_on(a, [&] {
    need(label, "label");
    const auto in = read_struct(how, sizeof(rdm_pretrain_config), default_pretrain(), "how");
    if (io) check_out(io, sizeof(rdm_pretrain_report), "io");
    if (rows < 1 || rows > kMaxPretrainRows)
      fail(Code::kRange, "rows: %d is outside [1, %d]", rows, kMaxPretrainRows);
    if (!a->agent->eyes().points)
      fail(Code::kState, "pretrain: the agent has no encoder; set option encoder");
    PretrainOptions o;
    o.num_labels = in.num_labels;
    o.epochs = in.epochs;
    o.batch_rows = in.batch_rows;
    o.learning_rate = in.learning_rate;
    o.validation = in.validation;
    o.seed = in.seed;
    const PretrainReport r = a->agent->pretrain(read_points(points, a->agent->eyes()), label, rows, o);
    if (!io) return;
    rdm_pretrain_report out{};
    out.train_rows = r.train_rows;
    out.validation_rows = r.validation_rows;
    out.train_loss = r.train_loss;
    out.validation_loss = r.validation_loss;
    out.accuracy = r.accuracy;
    out.most_common = r.most_common;
    write_struct(io, out, sizeof(rdm_pretrain_report), "io");
  });
}

namespace {

Transition read_transition(const Agent& agent, const rdm_transition* t) {
  const auto in = read_struct(t, kFirstTransitionSize, rdm_transition{}, "transition");
  need(in.reward, "transition.reward");
  if (agent.config().cost_dim > 0) need(in.cost, "transition.cost");
  Transition x;
  x.reward = in.reward;
  x.cost = in.cost;
  x.terminated = in.terminated;
  x.truncated = in.truncated;
  x.valid = in.valid;
  x.success = in.success;
  x.final_obs = in.final_obs;
  x.steps = in.steps;
  x.status = in.status;
  x.generation = in.generation;
  x.limit = in.limit;
  return x;
}

}  // namespace

rdm_result rdm_agent_record(rdm_agent* a, const rdm_transition* t) {
  return call_on(a, [&] { a->agent->record(read_transition(*a->agent, t)); });
}

rdm_result rdm_agent_put(rdm_agent* a, const float* obs, const float* action, const rdm_transition* t) {
  return call_on(a, [&] {
    need(obs, "obs");
    need(action, "action");
    a->agent->put(obs, action, read_transition(*a->agent, t));
  });
}

rdm_result rdm_agent_get_values(const rdm_agent* a, const float* obs, int32_t rows, float* value,
                                float* cost) {
  return call_on(a, [&] {
    need(obs, "obs");
    need(value, "value");
    if (rows < 1 || rows > kMaxValueRows)
      fail(Code::kRange, "rows: %d is outside [1, %d]", rows, kMaxValueRows);
    const Agent& agent = *a->agent;
    if (agent.history_dim() > 0)
      fail(Code::kUnsupported,
           "agent: its critics read its memory of the decisions before (option history), which this call "
           "does not take; give the agent to a planner, which keeps that memory");
    const auto n = static_cast<size_t>(rows);
    check_rows("obs", obs, nullptr, rows, static_cast<size_t>(agent.config().obs_dim));
    const HostScope scope(a->hooks);
    Vector<float> limited(n * static_cast<size_t>(agent.num_limited()));
    agent.values(obs, nullptr, rows, value, limited.data());
    if (!cost) return;
    std::fill_n(cost, n * RDM_MAX_COSTS, 0.0f);
    const auto count = static_cast<size_t>(agent.num_limited());
    for (size_t i = 0; i < n; ++i)
      for (size_t k = 0; k < count; ++k)
        cost[i * RDM_MAX_COSTS + static_cast<size_t>(agent.limited_column(static_cast<int32_t>(k)))] =
            limited[i * count + k];
  });
}

namespace rdm::capi {
// All of rdm_epoch: without padding, so a member that Epoch lacks makes it larger.
#define RDM_BYTES(type, member) +sizeof(rdm_epoch::member)  // NOLINT(bugprone-macro-parentheses)
static_assert(sizeof(rdm_epoch) == RDM_EPOCH_MEMBERS(RDM_BYTES) + sizeof(rdm_epoch::struct_size) +
                                       sizeof(rdm_epoch::reserved) + sizeof(rdm_epoch::reserved2) +
                                       sizeof(rdm_epoch::reserved3),
              "RDM_EPOCH_MEMBERS lacks a member");
#undef RDM_BYTES

void write_epoch(rdm_epoch* io, const Epoch& e) {
  rdm_epoch out{};
#define RDM_GIVE(type, member)                               \
  static_assert(std::is_same_v<type, decltype(out.member)>); \
  std::memcpy(&out.member, &e.member, sizeof out.member);
  RDM_EPOCH_MEMBERS(RDM_GIVE)
#undef RDM_GIVE
  write_struct(io, out, kFirstEpochSize, "io");
}
}  // namespace rdm::capi

rdm_result rdm_agent_update(rdm_agent* a, const float* last_obs, rdm_epoch* io) {
  return call_on(a, [&] {
    need(last_obs, "last_obs");
    if (io) check_out(io, kFirstEpochSize, "io");
    Epoch e;
    a->agent->update(last_obs, &e);
    if (io) write_epoch(io, e);
  });
}

rdm_result rdm_agent_update_begin(rdm_agent* a, const float* last_obs) {
  return call_on(a, [&] {
    need(last_obs, "last_obs");
    a->agent->begin_update(last_obs);
  });
}

rdm_result rdm_agent_update_slice(rdm_agent* a, int32_t units, int32_t* done, rdm_epoch* io) {
  return call_on(a, [&] {
    need(done, "done");
    if (units < 1) fail(Code::kRange, "units: %d is less than 1", units);
    if (io) check_out(io, kFirstEpochSize, "io");
    Epoch e;
    *done = a->agent->update_on(units, &e);
    if (*done && io) write_epoch(io, e);
  });
}

void rdm_agent_cancel(rdm_agent* a) {
  if (is_handle(a)) a->agent->cancel();
}

rdm_result rdm_agent_discard(rdm_agent* a) {
  return call_on(a, [&] { a->agent->discard(); });
}

rdm_result rdm_agent_set_option(rdm_agent* a, const rdm_option* option) {
  return call_on(a, [&] {
    need(option, "option");
    need(option->key, "option.key");
    a->agent->set_option({option->key, option->text, option->number});
  });
}

rdm_result rdm_agent_setting_at(const rdm_agent* a, int32_t i, const char** key, char* text) {
  return call_on(a, [&] { give_option(a->agent->options(), i, key, text, "rdm_agent_get_settings"); });
}

rdm_result rdm_agent_get_settings(const rdm_agent* a, char* text, size_t capacity, size_t* size) {
  return call_on(a, [&] { give_settings(a->agent->options(), text, capacity, size); });
}

rdm_result rdm_agent_tensor_at(const rdm_agent* a, int32_t i, rdm_tensor* out) {
  return call_on(a, [&] {
    need(out, "out");
    TensorInfo t;
    if (i < 0 || !a->agent->tensor(i, &t)) fail(Code::kRange, "i: %d is past the end of the tensors", i);
    *out = {t.name, t.rows, t.cols};
  });
}

namespace {
TensorInfo find_tensor(Agent& agent, const char* name, size_t count) {
  need(name, "name");
  agent.need_no_update("tensor");
  Vector<const char*> names;
  TensorInfo t;
  for (int32_t i = 0; agent.tensor(i, &t); ++i) {
    if (std::strcmp(t.name, name) == 0) {
      const size_t size = static_cast<size_t>(t.rows) * static_cast<size_t>(t.cols);
      if (count != size) fail(Code::kRange, "count: tensor %s has %zu values, not %zu", name, size, count);
      return t;
    }
    names.push_back(t.name);
  }
  fail(Code::kNotFound, "tensor %s: unknown%s", Quoted(name).text,
       Nearest(name, names.data(), static_cast<int32_t>(names.size())).text);
}
}  // namespace

rdm_result rdm_agent_get_tensor(const rdm_agent* a, const char* name, float* out, size_t count) {
  return call_on(a, [&] {
    need(out, "out");
    const TensorInfo t = find_tensor(*a->agent, name, count);
    std::copy(t.data, t.data + count, out);
  });
}

rdm_result rdm_agent_set_tensor(rdm_agent* a, const char* name, const float* values, size_t count) {
  return call_on(a, [&] {
    need(values, "values");
    const TensorInfo t = find_tensor(*a->agent, name, count);
    for (size_t i = 0; i < count; ++i)
      if (!std::isfinite(values[i])) fail(Code::kArgument, "values: entry %zu is not finite", i);
    std::copy(values, values + count, t.data);
    a->agent->tensors_changed();
  });
}

rdm_result rdm_agent_write_policy(const rdm_agent* a, void* bytes, size_t capacity, size_t* size) {
  return call_on(a, [&] { emit(bytes, capacity, size, [&](Writer& w) { a->agent->write_policy_file(w); }); });
}

rdm_result rdm_agent_write_policy_file(const rdm_agent* a, const char* path) {
  return call_on(a, [&] {
    need(path, "path");
    Writer count(nullptr, 0);
    a->agent->write_policy_file(count);
    Vector<unsigned char> file(count.size());
    Writer out(file.data(), file.size());
    a->agent->write_policy_file(out);
    write_file(path, file.data(), file.size());
  });
}

rdm_result rdm_policy_update_from(rdm_policy* p, const rdm_agent* a) {
  return call_on(a, [&] {
    need_handle(p);
    p->changes.change("policy", [&] { a->agent->update_policy(*p->policy); });
  });
}

rdm_result rdm_agent_write_state(const rdm_agent* a, void* bytes, size_t capacity, size_t* size) {
  return call_on(a, [&] { emit(bytes, capacity, size, [&](Writer& w) { a->agent->save(w); }); });
}

rdm_result rdm_agent_read_state(rdm_agent* a, const void* bytes, size_t size) {
  return call_on(a, [&] {
    need(bytes, "bytes");
    a->agent->load(bytes, size);
  });
}
#endif
