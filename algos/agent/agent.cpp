#include "algos/agent/agent.hpp"

#include <cstring>

#include "algos/core/algo_row.hpp"
#include "algos/core/fingerprint.hpp"
#include "algos/core/option_tables.hpp"
#include "base/elementary.hpp"
#include "base/error.hpp"
#include "base/fpmode.hpp"
#include "nn/policy.hpp"

namespace rdm {
namespace {

constexpr char kMagic[8] = {'R', 'D', 'M', 'A', 'G', 'E', 'N', 'T'};
constexpr uint32_t kVersion = 1;
constexpr int32_t kMaxEpochs = 1 << 30;  // of a state that loads; as many more do not overflow

bool same_network(const PointNetShape& a, const PointNetShape& b) {
  return a.classes == b.classes && a.color == b.color && a.mlp.num_hidden == b.mlp.num_hidden &&
         a.mlp.out == b.mlp.out && a.mlp.activation == b.mlp.activation &&
         std::equal(a.mlp.hidden, a.mlp.hidden + a.mlp.num_hidden, b.mlp.hidden);
}

bool same_group(const ActorGroup& a, const ActorGroup& b) {
  return std::strcmp(a.name, b.name) == 0 && a.first == b.first && a.count == b.count &&
         a.shape.in == b.shape.in && (a.columns != nullptr) == (b.columns != nullptr) &&
         (!a.columns || std::equal(a.columns, a.columns + a.shape.in, b.columns));
}

}  // namespace

size_t Agent::memory(const AgentConfig& config) {
  ResolvedAgentConfig resolved = resolve_config(config);
  const AlgoRow& row = *resolved.row;
  size_t held =
      resolved.options.held_bytes() +
      (resolved.actor_columns.capacity() + resolved.critic_columns.capacity() +
       resolved.history_columns.capacity() + resolved.own_columns.capacity() +
       resolved.latent_columns.capacity() + resolved.teacher_columns.capacity()) *
          sizeof(int32_t) +
      (resolved.groups.capacity() + resolved.reward_critics.capacity() + resolved.cost_critics.capacity()) *
          sizeof(ActorGroup);
  for (const Vector<GroupSpec>* specs : {&resolved.group_specs, &resolved.critic_specs}) {
    held += specs->capacity() * sizeof(GroupSpec);
    for (const GroupSpec& g : *specs) held += g.columns.capacity() * sizeof(int32_t);
  }
  return row.measure(std::move(resolved)) + held + Workers::memory(config.hooks, config.num_threads);
}

Agent* Agent::create(const AgentConfig& config) {
  const HostScope scope(config.hooks);
  ResolvedAgentConfig resolved = resolve_config(config);
  const AlgoRow& row = *resolved.row;
  Agent* agent = row.make(config.hooks, std::move(resolved));
  try {
    agent->open(config);
  } catch (...) {
    row.end(agent);
    throw;
  }
  return agent;
}

void Agent::destroy(Agent* a) {
  if (a) a->resolved().row->end(a);
}

void Agent::carve(Arena& arena) {
  nets_ = carve_networks(arena, resolved_);
  workers_.carve(arena, resolved_, nets_.size);
  collector_.carve(arena, resolved_);
  learner_.carve(arena, resolved_, nets_.size);
  seen_statistics_ =
      arena.make<float>(resolved_.actor_columns.empty() ? 0 : 2 * static_cast<size_t>(nets_.row_entries()));
  history_entries_ = nullptr;
  if (!resolved_.history_columns.empty())
    history_entries_ = arena.make<int32_t>(resolved_.history_columns.size());
  const LatentShape& latent = resolved_.latent;
  latent_entries_ = arena.make<int32_t>(latent ? static_cast<size_t>(latent.mlp.in) : 0);
  own_entries_ = arena.make<int32_t>(static_cast<size_t>(latent.num_own));
  fields_ = keep_fields(arena, resolved_.config.fields, resolved_.config.num_fields);
  shuffle_ = arena.make<Stream>(static_cast<size_t>(resolved_.blocks));
  spread_ = arena.make<double>(resolved_.state_std() ? 2 * static_cast<size_t>(resolved_.blocks) : 0);
  const auto tensors = static_cast<size_t>(nets_.num_tensors() + num_own_tensors());
  char* names = arena.make<char>(tensors * kTensorNameSize);
  names_ = reinterpret_cast<char(*)[kTensorNameSize]>(names);
}

void Agent::open(const AgentConfig& config) {
  Arena measure;
  carve(measure);
  arena_ = Arena(config.hooks, measure.used());
  carve(arena_);
  workers_.open(config.hooks, config.num_threads);
  workers_.ranks().open(cancel_);
  collector_.open(resolved_, nets_, workers_);
  learner_.open(resolved_, rollout(), nets_, workers_);
  regression_.open(resolved_, collector_, nets_, workers_);
  imitation_.open(resolved_, regression_);
  learner_.imitate(&imitation_);
  schedule_.open(resolved_.shared);
  for (int32_t b = 0; b < resolved_.blocks; ++b)
    shuffle_[b] =
        Stream(config.seed, static_cast<uint32_t>(workers_.ranks().first_block() + b), Purpose::kMinibatch);
  find_history_entries();
  find_latent_entries();
  init_networks(nets_, resolved_);
  restart_average(nets_);
  opened();
  read_live();
  TensorInfo t;
  const int32_t tensors = nets_.num_tensors();
  for (int32_t i = 0; i < tensors; ++i) find_tensor(nets_, i, names_[i], &t);
  for (int32_t i = 0; i < num_own_tensors(); ++i) own_tensor(i, names_[tensors + i], &t);
  AgentConfig& c = resolved_.config;
  c.task = resolved_.task;
  c.defaults = c.options = nullptr;
  c.settings = nullptr;
  c.initial_mean = nullptr;
  c.cost_limits = nullptr;
  c.fields = nullptr;
}

// Where the columns of a history stand among those that the actor observes.
void Agent::find_history_entries() {
  const int32_t* columns = nets_.columns[Networks::kActor];
  const Vector<int32_t>& kept = resolved_.history_columns;
  for (size_t i = 0; i < kept.size(); ++i) {
    const int32_t* at = columns ? std::lower_bound(columns, columns + nets_.row_entries(), kept[i]) : nullptr;
    history_entries_[i] = columns ? static_cast<int32_t>(at - columns) : kept[i];
  }
}

// Likewise of a latent; the history stands behind the row.
void Agent::find_latent_entries() {
  const LatentShape& l = resolved_.latent;
  if (!l) return;
  const int32_t* columns = nets_.columns[Networks::kActor];
  const int32_t count = l.entries + resolved_.history_inputs();
  const auto find = [&](const int32_t* from, int32_t n, int32_t* to) {
    for (int32_t i = 0; i < n; ++i)
      to[i] = columns ? static_cast<int32_t>(std::lower_bound(columns, columns + count, from[i]) - columns)
                      : from[i];
  };
  find(l.columns, l.mlp.in, latent_entries_);
  find(l.own, l.num_own, own_entries_);
}

void Agent::read_live() {
  resolved_.read_shared();
  schedule_.read_live();
  if (resolved_.num_limited > 0 && resolved_.column[0] == 0) resolved_.limit[0] = limit_of_first(resolved_);
}

void Agent::set_option(const OptionInput& option) {
  if (!option.key) fail(Code::kArgument, "agent option: its key is NULL");
  need_no_update("set_option");
  Options& o = resolved_.options;
  if (const OptionSpec* spec = o.spec_of(option.key); spec && !spec->live)
    fail(Code::kState, "agent option %s is fixed at creation and cannot be changed", spec->key);
  if (same_name("cost_limit", option.key) && resolved_.rate_steps > 0)
    fail(Code::kState, "agent option cost_limit cannot be set: cost_limit_per_step limits column 0 instead");
  for (const char* key : {"cost_limit", "cost_limit_per_step"}) {
    if (!same_name(key, option.key)) continue;
    const double limit = o.number(key);
    o.set(option, "agent");
    if ((limit < 0) == (o.number(key) < 0)) return read_live();
    o.set({key, nullptr, limit}, "agent");
    fail(Code::kState, "agent option %s: the agent was created %s%s on column 0, which cannot be changed",
         key, limit < 0 ? "without" : "with", same_name(key, "cost_limit") ? " a limit" : " it");
  }
  o.set(option, "agent");
  read_live();
}

void Agent::act(const float* obs, bool sample, float* action, const PointRows& clouds) {
  const FpMode mode;
  if (sample) begin_decision("act");
  collector_.act(obs, sample, action, clouds);
}

void Agent::forget(bool by_mean, const uint8_t* mask) {
  need_no_update("forget");
  collector_.forget(by_mean, mask);
}

void Agent::need_on_policy(const char* call) const {
  if (resolved_.off_policy())
    fail(Code::kUnsupported, "%s: %s learns from a replay memory, and does not support this call", call,
         resolved_.row->info.name);
}

void Agent::begin_decision(const char* call) {
  need_no_update(call);
  if (collector_.idle()) check_cancel(), sampler_ = 0;
  collector_.set_uniform(explores_blindly());
  for (int32_t i = 0; resolved_.row->costs == Costs::kInReward && i < resolved_.num_limited; ++i)
    collector_.set_charge(i, cost_weight(i) * resolved_.shared.reward_factor);
  if (imitation_.wanted() && !imitation_.has_rows())
    fail(Code::kState, "%s: option imitation needs a recording; call rdm_agent_set_recording first", call);
}

void Agent::need_generation(const char* call, const Transition& t) {
  if (t.generation == 0) return;
  if (nets_.average)
    fail(Code::kUnsupported,
         "%s: generation: with option average a policy file holds the running mean, not the network that "
         "samples",
         call);
  if (sampler_ == 0) sampler_ = generation();
  if (t.generation != sampler_)
    fail(Code::kState, "%s: generation: the rows were sampled by %llu, but the policy is %llu", call,
         static_cast<unsigned long long>(t.generation), static_cast<unsigned long long>(sampler_));
}

void Agent::values(const float* obs, const float* state, int32_t rows, float* value, float* cost) const {
  const SharedOptions& o = resolved_.shared;
  need_no_update("values");
  need_on_policy("values");
  if (o.normalize_reward || o.normalize_cost)
    fail(Code::kUnsupported, "agent: with option %s the values of its critics have no fixed unit",
         o.normalize_reward ? "normalize_reward" : "normalize_cost");
  if (num_limited() > 0 && !resolved_.values_costs)
    fail(Code::kUnsupported, "agent: %s has no critic of costs, and its critic of the reward has them in it",
         resolved_.row->info.name);
  collector_.value_rows(obs, state, rows, value, cost);
  const auto factor = static_cast<float>(o.reward_factor);
  for (int32_t i = 0; i < rows; ++i) value[i] /= factor;
}

void Agent::record(const Transition& t) {
  const FpMode mode;
  need_no_update("record");
  need_generation("record", t);
  collector_.record(t);
}

void Agent::put(const float* obs, const float* action, const Transition& t) {
  const FpMode mode;
  begin_decision("put");
  need_generation("put", t);
  collector_.put(obs, action, t);
}

void Agent::discard() {
  drop_horizon();
  cancel_.take();
}

void Agent::need_idle(const char* call) const {
  need_no_update(call);
  if (!collector_.idle())
    fail(Code::kState, "%s is allowed between epochs only, and this horizon has begun", call);
}

void Agent::need_clouds(const DemoRows& demo) const {
  if (!resolved_.sees() || demo.rows < 1) return;
  if (!demo.clouds.points)
    fail(Code::kArgument, "recording: it has no points, which the agent's encoder needs");
  if (resolved_.eyes.classes && !demo.clouds.classes)
    fail(Code::kArgument, "recording: its points have no classes, but the encoder reads %d",
         resolved_.eyes.classes);
  if (resolved_.eyes.color && !demo.clouds.colors)
    fail(Code::kArgument, "recording: its points have no colours, which the encoder reads");
}

CloneReport Agent::clone(const DemoRows& demo, const CloneOptions& how) {
  const FpMode mode;
  const HostScope scope(resolved_.config.hooks);
  need_idle("clone");
  need_on_policy("clone");
  if (resolved_.adapts())
    fail(Code::kUnsupported, "clone: with latent_from=history the policy stays as it is");
  need_clouds(demo);
  check_cancel();
  DemoRows rows = demo;
  DemoMemory memory;
  memory.open(resolved_, demo);
  memory.attach(rows);
  const CloneReport report =
      clone_actor(resolved_, rows, how, regression_, nets_, collector_.normalizer(), cancel_);
  restart_average(nets_);
  collector_.measure_usual(demo.obs, demo.rows);
  return report;
}

LearnReport Agent::learn(const LearnRows&, int64_t) {
  fail(Code::kUnsupported,
       "learn: %s learns from its own decisions alone; td3_bc_lag learns from recorded rows, and "
       "rdm_agent_clone copies their actions",
       resolved_.row->info.name);
}

void Agent::take_statistics(const LearnRows& rows) {
  if (!collector_.normalizes()) return;
  Normalizer& n = collector_.normalizer();
  normalizer_reset(n);
  constexpr int64_t kPart = 1 << 16;
  for (int64_t i = 0; i < rows.rows; i += kPart)
    normalizer_merge(n, rows.obs + static_cast<size_t>(i) * static_cast<size_t>(n.dim),
                     static_cast<int32_t>(std::min(kPart, rows.rows - i)), nullptr, 0);
  normalizer_refresh(n);
  collector_.measure_usual(rows.obs, static_cast<int32_t>(rows.rows));
}

void Agent::end_learning() {
  begin_average(nets_);
  sampler_ = 0;
}

PretrainReport Agent::pretrain(const PointRows& clouds, const uint8_t* label, int32_t rows,
                               const PretrainOptions& how) {
  const FpMode mode;
  const HostScope scope(resolved_.config.hooks);
  need_idle("pretrain");
  const PointNetShape& eyes = resolved_.eyes;
  if (!eyes.points) fail(Code::kState, "pretrain: the agent has no encoder; set option encoder");
  check_rows("points", clouds.metres, nullptr, rows, eyes.row_points());
  need_channels(eyes, clouds, static_cast<size_t>(rows));
  check_cancel();
  const size_t count = static_cast<size_t>(rows) * static_cast<size_t>(eyes.points);
  Vector<int16_t> points(3 * count);
  quantize_points(eyes, clouds.metres, count, points.data());
  PointRows kept;
  kept.points = points.data(), kept.classes = clouds.classes, kept.colors = clouds.colors;
  const PretrainReport report = pretrain_eyes(resolved_, kept, label, rows, how, nets_, workers_, cancel_);
  restart_average(nets_);
  return report;
}

void Agent::set_recording(const DemoRows& demo, uint64_t mark) {
  need_idle("set_recording");
  if (demo.rows > 0) need_on_policy("set_recording");
  need_clouds(demo);
  imitation_.set(demo, mark, resolved_.config.hooks);
}

void Agent::need_same_shape(const PolicyView& p, bool own) const {
  const AgentConfig& c = resolved_.config;
  const MlpShape& actor = nets_.shape[Networks::kActor];
  const auto differ = [](const char* what) {
    fail(Code::kArgument, "policy: %s differs from the agent's", what);
  };
  if (p.obs_dim() != c.obs_dim) differ("obs_dim");
  if (p.action_dim() != c.action_dim) differ("action_dim");
  if (p.layout_hash && c.layout_hash && p.layout_hash != c.layout_hash) differ("layout_hash");
  if (p.state_std != nets_.state_std()) differ("std_mode");
  if (p.squash != nets_.squash) differ("how actions are squashed");
  if (p.actor.num_hidden != actor.num_hidden ||
      !std::equal(actor.hidden, actor.hidden + actor.num_hidden, p.actor.hidden))
    differ("hidden");
  if (p.actor.activation != actor.activation) differ("activation");
  const int32_t* columns = nets_.columns[Networks::kActor];
  const PointNetShape &eyes = nets_.eyes, &theirs = p.eyes;
  if (theirs.points != eyes.points) differ("encoder_points");
  if (!same_network(theirs, eyes)) differ("encoder");
  if (!std::equal(eyes.origin, eyes.origin + 3, theirs.origin) || eyes.range != theirs.range)
    differ("encoder_origin, or encoder_range,");
  if (p.num_groups != nets_.num_groups) differ("the number of groups");
  for (int32_t i = 0; i < p.num_groups; ++i)
    if (!same_group(p.group[i], nets_.group[i])) differ("groups");
  if (p.gru.units != nets_.gru.units) differ("memory");
  if ((p.clip > 0) != collector_.normalizes() || (p.clip > 0 && p.clip != collector_.normalizer().clip))
    differ("normalize_obs, or obs_clip,");
  if (p.latent || nets_.latent) need_same_latent(p, own);
  if (nets_.adapts() && !own) return;
  const int32_t history = resolved_.history_width;
  const auto listed = [](const int32_t* entry, int32_t i) { return entry ? entry[i] : i; };
  if (p.history != resolved_.history) differ("history");
  if (p.history_width != history) differ("history_fields");
  for (int32_t i = 0; i < history; ++i)
    if (listed(p.history_entries, i) != listed(history_entries_, i)) differ("history_fields");
  const int32_t entries = nets_.row_entries();
  if (p.actor.in != actor.in || p.entries() != entries || (p.columns != nullptr) != (columns != nullptr) ||
      (columns && !std::equal(columns, columns + entries, p.columns)))
    differ("actor_obs");
}

// A student begins with its teacher: the network, what made the latent, and the statistics.
void Agent::need_same_latent(const PolicyView& p, bool own) const {
  const auto differ = [](const char* what) {
    fail(Code::kArgument, "policy: %s differs from the agent's", what);
  };
  const LatentShape& l = nets_.latent;
  const bool of_teacher = nets_.adapts() && !own;
  if (p.latent.mlp.out != l.mlp.out) differ("latent");
  if (of_teacher && p.history > 1)
    fail(Code::kArgument, "policy: it is a student's; give the teacher that it had");
  const MlpShape& encoder = of_teacher ? nets_.teacher : l.mlp;
  if (p.latent.mlp.num_hidden != encoder.num_hidden ||
      !std::equal(encoder.hidden, encoder.hidden + encoder.num_hidden, p.latent.mlp.hidden))
    differ("latent_hidden");
  // in columns of the stacked row
  const auto same = [&](const int32_t* entries, int32_t count, const int32_t* wanted, int32_t wanted_count) {
    for (int32_t i = 0; count == wanted_count && i < count; ++i) {
      const int32_t entry = entries[i], behind = entry - p.entries();
      const int32_t at = behind >= 0 ? p.obs_dim() + behind : p.columns ? p.columns[entry] : entry;
      if (at != wanted[i]) return false;
    }
    return count == wanted_count;
  };
  if (!same(p.latent.columns, p.latent.mlp.in, of_teacher ? nets_.teacher_columns : l.columns, encoder.in))
    differ(nets_.adapts() && own ? "history" : "latent_fields");
  if (!same(p.latent.own, p.latent.num_own, l.own, l.num_own)) differ("actor_obs");
}

void Agent::load_policy(const PolicyView& p, double samples) {
  const FpMode mode;
  need_idle("load_policy");
  if (!(samples >= 2 && samples <= 1e12)) fail(Code::kRange, "samples: %g is outside [2, 1e12]", samples);
  need_same_shape(p, false);
  // A student's teacher has statistics of what the student does not observe.
  const int32_t* columns = nets_.adapts() ? p.columns : nets_.columns[Networks::kActor];
  const PointNetShape& eyes = nets_.eyes;
  const int32_t entries = p.entries();
  Normalizer& n = collector_.normalizer();
  std::copy_n(p.params, p.num_params(), nets_.net(Networks::kActor));
  if (eyes.points) std::copy_n(p.eyes_params, eyes.num_params(), nets_.eyes_net());
  std::copy_n(
      p.latent_params, p.latent.num_params(),
      nets_.net(Networks::kActor) + (nets_.adapts() ? nets_.teacher_offset() : nets_.latent_offset()));
  if (!nets_.state_std()) std::copy_n(p.log_std, nets_.action_dim, nets_.log_std());
  clamp_log_std(nets_);
  restart_average(nets_);
  actor_replaced();
  Adam& adam = nets_.block[Networks::kActor].adam;
  std::fill_n(adam.m, adam.size, 0.0f);
  std::fill_n(adam.v, adam.size, 0.0f);
  restart_steps(nets_);
  if (!collector_.normalizes()) return;
  collector_.usual().set(p.usual);
  n.count = samples;
  std::fill_n(n.mean, n.dim, 0.0);
  std::fill_n(n.m2, n.dim, samples - 1);  // of entries that the policy does not see: as they are
  for (int32_t i = 0; i < entries; ++i) {
    const int32_t at = columns ? columns[i] : i;
    const double std = 1 / static_cast<double>(p.scale[i]);  // in double: refresh finds the same float
    n.mean[at] = static_cast<double>(p.shift[i]);
    n.m2[at] = std * std * (samples - 1);
  }
  normalizer_refresh(n);
}

bool Agent::tensor(int32_t index, TensorInfo* out) {
  char name[kTensorNameSize];
  const int32_t own = index - nets_.num_tensors();
  if (own < 0 ? !find_tensor(nets_, index, name, out) : !own_tensor(own, name, out)) return false;
  out->name = names_[index];
  return true;
}

void Agent::visit_state(StateIo& io) {
  io.section("COUN");
  io.integer(epoch_, 0, kMaxEpochs);
  io.share(shuffle_, static_cast<size_t>(resolved_.blocks));
  nets_.visit(io);
  collector_.visit(io);
  learner_.visit(io);
  schedule_.visit(io);
  imitation_.visit(io);
}

void Agent::save(Writer& out) const {
  need_idle("save");
  // The listing is shared with load; a StateWriter only reads.
  auto* const self = const_cast<Agent*>(this);
  Ranks& ranks = self->workers_.ranks();
  const HostScope scope(resolved_.config.hooks);
  if (ranks.alone() || !out.counts()) self->collector_.settle();
  out.begin_file(kMagic, kVersion);
  write_fingerprint(out, resolved_);
  StateWriter io(out, &ranks);
  self->visit_state(io);
  io.end();
  out.end_file();
}

void Agent::read_state(const void* bytes, size_t size, bool apply) {
  Reader in(bytes, size, "agent state");
  in.begin_file(kMagic, kVersion);
  read_fingerprint(in, resolved_, apply);
  if (apply) read_live(), collector_.usual().set({});
  StateReader io(in, apply, workers_.ranks().rank(), workers_.ranks().count());
  visit_state(io);
  io.end_listing();
}

void Agent::check_state(const void* bytes, size_t size) {
  if (!bytes) fail(Code::kArgument, "agent state is NULL");
  read_state(bytes, size, false);
}

void Agent::load(const void* bytes, size_t size) {
  check_state(bytes, size);
  read_state(bytes, size, true);
  collector_.after_load();
  after_load();
  workers_.ranks().restart();
  clamp_log_std(nets_);
  end_run();
  drop_horizon();
}

uint64_t Agent::generation_of(const float* actor) const {
  const uint64_t network = crc32(actor, nets_.block[Networks::kActor].size * sizeof *actor);
  const uint64_t generation = network << 32 | static_cast<uint32_t>(epoch_);
  return generation ? generation : uint64_t{1} << 32;
}

PolicyView Agent::policy_view() {
  const Normalizer& n = collector_.normalizer();
  PolicyView v;
  v.actor = nets_.shape[Networks::kActor];
  v.gru = nets_.gru;
  v.history = resolved_.history;
  v.history_width = resolved_.history_width;
  v.history_entries = history_entries_;
  v.columns = nets_.columns[Networks::kActor];
  v.row_dim = resolved_.config.obs_dim;
  v.group = nets_.group, v.num_groups = nets_.num_groups;
  v.squash = nets_.squash;
  v.params = nets_.kept_actor();
  v.eyes = nets_.eyes;
  v.eyes_params = v.params + nets_.eyes_offset();
  v.latent = nets_.latent;
  v.latent.columns = latent_entries_, v.latent.own = own_entries_;
  v.latent_params = v.params + nets_.latent_offset();
  if (nets_.state_std())
    v.state_std = true, v.std_bounds[0] = nets_.std_low, v.std_bounds[1] = nets_.std_high;
  else
    v.log_std = nets_.kept_log_std();
  v.shift = n.shift;
  v.scale = n.scale;
  if (v.columns) {
    float *const shift = seen_statistics_, *const scale = shift + v.entries();
    pick_columns(n.shift, 1, n.dim, v.columns, v.entries(), shift);
    pick_columns(n.scale, 1, n.dim, v.columns, v.entries(), scale);
    v.shift = shift, v.scale = scale;
  }
  if (collector_.normalizes()) v.clip = n.clip, v.usual = collector_.usual().known();
  v.action_repeat = action_repeat();
  v.noise_correlation = static_cast<float>(resolved_.shared.noise_correlation);
  v.control_dt = resolved_.config.control_dt;
  v.layout_hash = resolved_.config.layout_hash;
  v.generation = generation_of(nets_.kept_log_std());
  std::memcpy(v.task, resolved_.task, sizeof v.task);
  v.fields = fields_;
  v.num_fields = resolved_.config.num_fields;
  v.example_obs = n.shift;
  return v;
}

void Agent::write_policy_file(Writer& out) {
  const HostScope scope(resolved_.config.hooks);
  write_policy(out, policy_view());
}

void Agent::update_policy(Policy& policy) {
  const FpMode mode;
  need_same_shape(policy.view(), true);
  const PolicyView now = policy_view();
  if (policy.view().action_repeat != now.action_repeat)
    fail(Code::kArgument, "policy: action_repeat differs from the agent's");
  policy.update(now);
}

}  // namespace rdm
