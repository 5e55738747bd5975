#include "algos/core/resolved_config.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <utility>

#include "algos/core/algo_row.hpp"
#include "algos/core/option_tables.hpp"
#include "base/chars.hpp"
#include "base/elementary.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

constexpr int64_t kMaxSamples = 1 << 28;

void check_range(const char* name, int64_t value, int64_t low, int64_t high) {
  if (value < low || value > high)
    fail(Code::kRange, "%s: %lld is outside [%lld, %lld]", name, static_cast<long long>(value),
         static_cast<long long>(low), static_cast<long long>(high));
}

// Two fields of a row of observations, of which both names and entries differ.
void check_apart(const ObsField& a, const ObsField& b, int32_t i, int32_t j) {
  if (std::strcmp(a.name, b.name) == 0)
    fail(Code::kArgument, "fields[%d]: its name '%s' is also that of fields[%d]", j, Quoted(b.name).text, i);
  if (a.offset < b.offset + b.count && b.offset < a.offset + a.count)
    fail(Code::kArgument, "fields[%d]: entries of '%s' are also those of fields[%d], '%s'", j,
         Quoted(b.name).text, i, Quoted(a.name).text);
}

void check_config(const AgentConfig& c) {
  check_range("obs_dim", c.obs_dim, 1, 16384);
  check_range("action_dim", c.action_dim, 1, kMaxActions);
  check_range("cost_dim", c.cost_dim, 0, kMaxCosts);
  check_range("num_envs", c.num_envs, 1, 65536);
  check_range("num_threads", c.num_threads, 0, 256);
  check_range("max_steps", c.max_steps, 0, INT32_MAX);
  check_range("ranks", c.ranks.count, 1, kMaxRanks);
  check_range("rank", c.ranks.rank, 0, c.ranks.count - 1);
  if (c.ranks.count > 1 && !c.ranks.gather)
    fail(Code::kArgument, "gather is NULL with %d ranks", c.ranks.count);
  check_range("num_defaults", c.num_defaults, 0, INT32_MAX);
  check_range("num_options", c.num_options, 0, INT32_MAX);
  if (c.num_defaults && !c.defaults)
    fail(Code::kArgument, "defaults is NULL with num_defaults %d", c.num_defaults);
  if (c.num_options && !c.options)
    fail(Code::kArgument, "options is NULL with num_options %d", c.num_options);
  if (!c.algo) fail(Code::kArgument, "algo is NULL");
  if (!std::isfinite(c.control_dt) || c.control_dt < 0)
    fail(Code::kRange, "control_dt: %g is not a positive number of seconds",
         static_cast<double>(c.control_dt));
  if (c.task && std::strlen(c.task) >= kOptionTextSize)
    fail(Code::kRange, "task: its name is longer than %d characters", kOptionTextSize - 1);
  for (int32_t i = 0; c.initial_mean && i < c.action_dim; ++i)
    if (!std::isfinite(c.initial_mean[i])) fail(Code::kArgument, "initial_mean[%d] is not finite", i);
  check_range("num_fields", c.num_fields, 0, kMaxFields);
  if (c.num_fields && !c.fields) fail(Code::kArgument, "fields is NULL with num_fields %d", c.num_fields);
  for (int32_t i = 0; i < c.num_fields; ++i) {
    const ObsField& f = c.fields[i];
    if (!f.name) fail(Code::kArgument, "fields[%d].name is NULL", i);
    if (f.offset < 0 || f.count < 1 || f.offset > c.obs_dim - f.count)
      fail(Code::kRange, "fields[%d]: entries %d to %lld are not within obs_dim %d", i, f.offset,
           static_cast<long long>(f.offset) + f.count, c.obs_dim);
    for (int32_t j = 0; j < i; ++j) check_apart(c.fields[j], f, j, i);
  }
  for (int32_t i = 0; c.cost_limits && i < c.cost_dim; ++i)
    if (!std::isfinite(c.cost_limits[i])) fail(Code::kArgument, "cost_limits[%d] is not finite", i);
}

// "64,64" into widths; blanks are skipped.
MlpShape parse_shape(const char* key, const char* widths, Activation activation, int32_t in, int32_t out) {
  MlpShape s;
  s.in = in;
  s.out = out;
  s.activation = activation;
  const char* p = widths;
  while (*p == ' ') ++p;
  while (*p) {
    char* end = nullptr;
    const long width = std::strtol(p, &end, 10);
    while (*end == ' ') ++end;
    if (end == p || (*end && *end != ','))
      fail(Code::kArgument, "%s: '%s' is not a list of widths such as 64,64", key, Quoted(widths).text);
    if (s.num_hidden == kMaxHidden) fail(Code::kRange, "%s: there are more than %d layers", key, kMaxHidden);
    check_range(key, width, 1, kMaxWidth);
    s.hidden[s.num_hidden++] = static_cast<int32_t>(width);
    p = *end ? end + 1 : end;
    if (*end && !*p) fail(Code::kArgument, "%s: '%s' ends in a comma", key, Quoted(widths).text);
  }
  return s;
}

// The values of all options, the task's limit on column 0 among the defaults.
Options read_limited_options(const AgentConfig& c, const AlgoRow& algo) {
  Options o = read_options(c, algo);
  if (c.cost_dim == 0 || o.given("cost_limit")) return o;
  if (read_shared_options(o, algo).shield_learn == ShieldLearn::kCost)  // column 0 counts refusals
    o.set_default("cost_limit", 1.0);
  else if (c.cost_limits)
    o.set_default("cost_limit", c.cost_limits[0] < 0 ? -1.0 : c.cost_limits[0]);
  return o;
}

void resolve_costs(ResolvedAgentConfig& resolved) {
  const AgentConfig& c = resolved.config;
  const SharedOptions& o = resolved.shared;
  resolved.episode_steps = o.episode_steps > 0 ? o.episode_steps : c.max_steps;
  if (o.cost_limit_per_step >= 0)
    resolved.rate_steps = resolved.episode_steps > 0 ? resolved.episode_steps : kRateSteps;
  if (resolved.row->costs == Costs::kNone) return;
  for (int32_t k = 0; k < c.cost_dim; ++k) {
    const double limit = k == 0 ? limit_of_first(resolved) : c.cost_limits ? c.cost_limits[k] : -1;
    if (limit < 0) continue;
    resolved.column[resolved.num_limited] = k;
    resolved.limit[resolved.num_limited++] = limit;
  }
  if (resolved.num_limited == 0)
    fail(Code::kArgument, "cost_limits: %s needs at least one cost column with a limit",
         resolved.row->info.name);
  if (resolved.row->costs == Costs::kOne && resolved.num_limited > 1 &&
      !kOneCostRows.read(resolved.options).worst)
    fail(Code::kUnsupported,
         "cost_limits: %s is defined for one limited cost, %d have limits; several_costs=worst follows the "
         "most "
         "violated one",
         resolved.row->info.name, resolved.num_limited);
  resolved.values_costs = resolved.row->costs != Costs::kInReward && !resolved.off_policy();
  if (resolved.row->adapt) resolved.row->adapt(resolved);
}

// "x,y,z" in m; blanks are skipped.
void parse_origin(const char* text, float (&origin)[3]) {
  const char *p = text, *last = text + std::strlen(text);
  for (int32_t k = 0; k < 3; ++k) {
    while (*p == ' ') ++p;
    auto [end, error] = from_chars(p, last, origin[k]);
    while (*end == ' ') ++end;
    if (error != std::errc() || *end != (k < 2 ? ',' : '\0'))
      fail(Code::kArgument, "encoder_origin: '%s' is not three numbers such as 0,0,1", Quoted(text).text);
    p = end + 1;
  }
}

void resolve_eyes(ResolvedAgentConfig& resolved) {
  const SharedOptions& o = resolved.shared;
  PointNetShape eyes;
  eyes.classes = o.encoder_classes;
  eyes.color = o.encoder_color;
  eyes.mlp = parse_shape("encoder", o.encoder, o.encoder_activation, eyes.channels(), 0);
  if (eyes.mlp.num_hidden == 0) return;
  int32_t& last = eyes.mlp.hidden[--eyes.mlp.num_hidden];
  eyes.mlp.out = last, last = 0;
  eyes.points = o.encoder_points;
  eyes.range = static_cast<float>(o.encoder_range);
  parse_origin(o.encoder_origin, eyes.origin);
  check_pointnet_shape(eyes);
  resolved.eyes = eyes;
  resolved.frozen = o.encoder_frozen || o.latent_student;
}

// Those of `own` that are in `seen`; empty lists are all entries, and so is the result where it is all.
Vector<int32_t> both(const Vector<int32_t>& own, const Vector<int32_t>& seen, const char* key,
                     const char* group) {
  if (own.empty() || seen.empty()) return own.empty() ? seen : own;
  Vector<int32_t> out;
  out.reserve(std::min(own.size(), seen.size()));
  std::set_intersection(own.begin(), own.end(), seen.begin(), seen.end(), std::back_inserter(out));
  if (out.empty())
    fail(Code::kArgument, "groups: %s leaves %s no entry of the observation", key, Quoted(group).text);
  return out;
}

// "gru:64"; blanks are skipped. 0: none.
int32_t parse_units(const char* text) {
  const char* p = text;
  while (*p == ' ') ++p;
  if (!*p) return 0;
  char* end = nullptr;
  const bool known = std::strncmp(p, "gru:", 4) == 0;
  const long units = known ? std::strtol(p + 4, &end, 10) : 0;
  while (known && *end == ' ') ++end;
  if (!known || end == p + 4 || *end)
    fail(Code::kArgument, "memory: '%s' is not a memory; write gru:64 for a GRU of 64 units",
         Quoted(text).text);
  check_range("memory: the number of units", units, 1, kMaxUnits);
  return static_cast<int32_t>(units);
}

// What the actor's networks are in groups, each of which sees its fields as far as actor_obs has them; one group is one
// network.
void resolve_groups(ResolvedAgentConfig& resolved, int32_t units) {
  if (!kGroupRows.known_to(resolved.options)) return;
  const AgentConfig& c = resolved.config;
  const SharedOptions& o = resolved.shared;
  Vector<GroupSpec> specs = parse_groups(c, kGroupRows.read(resolved.options).groups);
  if (specs.empty()) return;
  if (specs.size() > 1 && *o.encoder)
    fail(Code::kUnsupported, "encoder: an actor of several groups has none; groups=all has one network");
  if (resolved.row->own_critics) {
    resolved.critic_specs = specs;
    for (GroupSpec& s : resolved.critic_specs)
      s.columns = both(s.columns, resolved.critic_columns, "critic_obs", s.name);
    if (specs.size() == 1) {
      resolved.critic_columns = std::move(resolved.critic_specs[0].columns);
      resolved.critic_specs = {};
    }
  }
  for (GroupSpec& s : specs) s.columns = both(s.columns, resolved.actor_columns, "actor_obs", s.name);
  if (specs.size() == 1) {
    resolved.actor_columns = std::move(specs[0].columns);
    return;
  }
  resolved.actor_columns = {};
  size_t offset = 0;
  for (const GroupSpec& s : specs) {
    ActorGroup& g = resolved.groups.emplace_back();
    std::memcpy(g.name, s.name, sizeof g.name);
    g.first = s.first, g.count = s.count, g.offset = offset;
    g.columns = s.columns.empty() ? nullptr : s.columns.data();
    g.shape = parse_shape("hidden", o.hidden, o.activation,
                          s.columns.empty() ? c.obs_dim : static_cast<int32_t>(s.columns.size()),
                          o.state_std ? 2 * s.count : s.count);
    check_mlp_shape(g.shape);
    g.gru = with_gru(g.shape, units).gru;
    offset += g.net().num_params();
  }
  resolved.group_specs = std::move(specs);
}

// The columns that a history keeps, which the actor observes; they follow a row where networks see parts of it.
void resolve_history(ResolvedAgentConfig& resolved) {
  const AgentConfig& c = resolved.config;
  const SharedOptions& o = resolved.shared;
  if (o.history == 1) {
    if (*o.history_fields) fail(Code::kArgument, "history_fields: it needs option history above 1");
    return;
  }
  const Vector<int32_t>& actor = resolved.actor_columns;
  Vector<int32_t>& kept = resolved.history_columns;
  kept = *o.history_fields
             ? select_columns("history_fields", o.history_fields, c.fields, c.num_fields, c.obs_dim)
             : actor;
  const auto unseen = [&](int32_t i) { return !std::binary_search(actor.begin(), actor.end(), i); };
  if (!actor.empty() && kept.empty() && actor.size() < resolved.obs_dim())
    fail(Code::kArgument, "history_fields: it names fields that the actor does not observe (actor_obs)");
  for (const int32_t i : kept)
    if (!actor.empty() && unseen(i))
      fail(Code::kArgument, "history_fields: it names entry %d, which the actor does not observe (actor_obs)",
           i);
  const int64_t width = kept.empty() ? c.obs_dim : static_cast<int64_t>(kept.size());
  const int64_t inputs = c.obs_dim + (o.history - 1) * width;
  if (inputs > kMaxInputs)
    fail(Code::kRange, "history: %d decisions of %lld entries are more than %d inputs of a network",
         o.history, static_cast<long long>(width), kMaxInputs);
  resolved.history = o.history;
  resolved.history_width = static_cast<int32_t>(width);
  for (Vector<int32_t>* columns : {&resolved.actor_columns, &resolved.critic_columns})
    if (!columns->empty()) {
      columns->reserve(columns->size() + static_cast<size_t>(inputs - c.obs_dim));
      for (auto i = c.obs_dim; i < static_cast<int32_t>(inputs); ++i) columns->push_back(i);
    }
}

// Which fields become the latent: the actor's network reads the others. A student reads them in
// learning alone.
void resolve_latent_fields(ResolvedAgentConfig& resolved) {
  const AgentConfig& c = resolved.config;
  const SharedOptions& o = resolved.shared;
  if (o.latent == 0) {
    if (o.latent_student) fail(Code::kArgument, "latent_from: it needs option latent above 0");
    return;
  }
  if (!resolved.groups.empty())
    fail(Code::kUnsupported,
         "latent: it cannot be combined with several groups yet; groups=all has one network");
  if (*o.memory)
    fail(Code::kUnsupported,
         "latent: it cannot be combined with option memory yet; a student has option history");
  if (o.latent_student && o.history == 1)
    fail(Code::kArgument, "latent_from: history needs option history above 1");
  if (!o.latent_student && o.history > 1)
    fail(Code::kUnsupported,
         "history: the network of a latent reads none; latent_from=history makes a student, whose encoder "
         "does");
  Vector<int32_t> hidden =
      select_columns("latent_fields", o.latent_fields, c.fields, c.num_fields, c.obs_dim);
  Vector<int32_t> seen = resolved.actor_columns;
  for (int32_t i = 0; seen.size() < resolved.obs_dim() && resolved.actor_columns.empty(); ++i)
    seen.push_back(i);
  Vector<int32_t>& own = resolved.own_columns;
  own.reserve(seen.size());
  std::set_difference(seen.begin(), seen.end(), hidden.begin(), hidden.end(), std::back_inserter(own));
  if (hidden.empty() || own.empty())
    fail(Code::kArgument, "latent_fields: they leave the actor's network no entry of the observation");
  if (own.size() + hidden.size() != seen.size())
    fail(Code::kArgument, "latent_fields: it names fields that the actor does not observe (actor_obs)");
  if (o.latent_student) {
    // its encoder may read more than the network
    const Vector<int32_t> read = *o.history_fields ? select_columns("history_fields", o.history_fields,
                                                                    c.fields, c.num_fields, c.obs_dim)
                                                   : own;
    const auto drawn = [&](int32_t i) { return std::binary_search(hidden.begin(), hidden.end(), i); };
    if (read.empty() || std::any_of(read.begin(), read.end(), drawn))
      fail(Code::kArgument,
           "history_fields: it names fields of the latent, which a student does not observe");
    Vector<int32_t>& both = resolved.actor_columns = {};
    both.reserve(own.size() + read.size());
    std::set_union(own.begin(), own.end(), read.begin(), read.end(), std::back_inserter(both));
    seen = both;
    resolved.teacher_columns = std::move(hidden);
  } else {
    resolved.latent_columns = std::move(hidden);
  }
  resolved.latent.entries = static_cast<int32_t>(seen.size());
}

// The shapes, once it is known what the history is. A student's encoder reads the fields of its history, as they are
// now too.
void resolve_latent(ResolvedAgentConfig& resolved) {
  const AgentConfig& c = resolved.config;
  const SharedOptions& o = resolved.shared;
  if (o.latent == 0) return;
  Vector<int32_t>& read = resolved.latent_columns;
  const auto encoder = [&](const Vector<int32_t>& columns) {
    const MlpShape s = parse_shape("latent_hidden", o.latent_hidden, o.activation,
                                   static_cast<int32_t>(columns.size()), o.latent);
    check_mlp_shape(s);
    return s;
  };
  if (o.latent_student) {
    read = resolved.history_columns;
    for (int32_t i = 0; i < resolved.history_inputs(); ++i) read.push_back(c.obs_dim + i);
    resolved.teacher = encoder(resolved.teacher_columns);
  }
  LatentShape& l = resolved.latent;
  l.mlp = encoder(read);
  l.columns = read.data();
  l.own = resolved.own_columns.data();
  l.num_own = static_cast<int32_t>(resolved.own_columns.size());
}

// Units of a memory, 0: none.
void resolve_memory(ResolvedAgentConfig& resolved, int32_t units) {
  resolved.gru = with_gru(resolved.actor, units).gru;
  if (!resolved.remembers()) return;
  if (units && resolved.history > 1)
    fail(Code::kUnsupported, "memory: it cannot be combined with option history; choose one of the two");
  if (!units && !resolved.groups.empty())
    fail(Code::kUnsupported,
         "history: it cannot be combined with several groups yet; groups=all has one network, and option "
         "memory "
         "works with groups");
  if (units && resolved.sees())
    fail(Code::kUnsupported,
         "memory: it cannot be combined with option encoder yet; option history works with an encoder");
}

void resolve_networks(ResolvedAgentConfig& resolved) {
  const AgentConfig& c = resolved.config;
  const SharedOptions& o = resolved.shared;
  const auto columns = [&](const char* key, const char* words) {
    return select_columns(key, words, c.fields, c.num_fields, c.obs_dim);
  };
  const auto inputs = [&](const Vector<int32_t>& seen) {
    return static_cast<int32_t>(seen.empty() ? resolved.seen_dim() : seen.size());
  };
  resolved.actor_columns = columns("actor_obs", o.actor_obs);
  resolved.critic_columns = columns("critic_obs", o.critic_obs);
  const int32_t units = parse_units(o.memory);
  resolve_groups(resolved, units);
  resolve_latent_fields(resolved);
  resolve_history(resolved);
  resolve_latent(resolved);
  const int32_t actor_in = resolved.latent ? resolved.latent.num_own + resolved.latent.mlp.out
                                           : inputs(resolved.actor_columns),
                critic_in = inputs(resolved.critic_columns);
  resolve_eyes(resolved);
  const auto critic = [&](int32_t outputs) {
    return *o.critic_hidden ? parse_shape("critic_hidden", o.critic_hidden, o.activation, critic_in, outputs)
                            : parse_shape("hidden", o.hidden, o.activation, critic_in, outputs);
  };
  resolved.actor = parse_shape("hidden", o.hidden, o.activation, actor_in + resolved.eyes.features(),
                               o.state_std ? 2 * c.action_dim : c.action_dim);
  resolve_memory(resolved, units);
  const int32_t costs = std::max(resolved.num_limited, 1);
  for (const GroupSpec& s : resolved.critic_specs) {
    const auto add = [&](Vector<ActorGroup>& critics, int32_t outputs) {
      ActorGroup g;
      std::memcpy(g.name, s.name, sizeof g.name);
      g.first = static_cast<int32_t>(critics.size()) * outputs, g.count = outputs;
      g.offset = group_params(critics.data(), static_cast<int32_t>(critics.size()));
      g.columns = s.columns.empty() ? nullptr : s.columns.data();
      g.shape = critic(outputs);
      g.shape.in = s.columns.empty() ? c.obs_dim : static_cast<int32_t>(s.columns.size());
      critics.push_back(g);
    };
    add(resolved.reward_critics, 1);
    add(resolved.cost_critics, costs);
  }
  resolved.reward_critic = critic(resolved.num_critics());
  resolved.cost_critic = critic(resolved.num_critics() * costs);
  check_mlp_shape(resolved.actor);
  check_mlp_shape(resolved.reward_critic);
  check_mlp_shape(resolved.cost_critic);
}

// Blocks of all ranks into this one's.
void resolve_blocks(ResolvedAgentConfig& resolved) {
  const int32_t blocks = resolved.shared.blocks, ranks = resolved.config.ranks.count;
  const int32_t envs = resolved.all_envs(), own = blocks / ranks;
  if (resolved.off_policy() && ranks > 1)
    fail(Code::kUnsupported, "ranks: %s learns from the replay memory of one process; there are %d",
         resolved.row->info.name, ranks);
  if (envs % blocks != 0)
    fail(Code::kArgument, "blocks: %d does not divide the number of environments, %d", blocks, envs);
  if (blocks % ranks != 0 || (ranks > 1 && (own & (own - 1)) != 0))
    fail(Code::kArgument, "blocks: %d is not the number of ranks, %d, times a power of two, as %d would be",
         blocks, ranks, ranks);
  resolved.blocks = own;
}

void resolve_batches(ResolvedAgentConfig& resolved) {
  const SharedOptions& o = resolved.shared;
  const int64_t samples = int64_t{o.horizon} * resolved.config.num_envs;
  const int32_t ranks = resolved.config.ranks.count;
  if (samples * ranks > kMaxSamples)
    fail(Code::kRange, "horizon: %d decisions of %d environments are more than %lld samples", o.horizon,
         resolved.all_envs(), static_cast<long long>(kMaxSamples));
  resolved.samples = static_cast<int32_t>(samples);
  resolve_blocks(resolved);
  const int32_t parts = std::min(o.minibatches, resolved.all_samples());
  const int32_t block_samples = resolved.samples / resolved.blocks;
  const int32_t block_rows = (block_samples + parts - 1) / parts;
  resolved.minibatch_rows = block_rows * resolved.blocks;
  // A quarter of a minibatch keeps four threads busy; larger chunks than 256 rows leave the cache. Not by
  // num_threads or ranks: results must not depend on them.
  const int32_t quarter = (block_rows + 3) / 4;
  resolved.chunk_rows = std::clamp((quarter + 31) / 32 * 32, 64, 256);
  const int32_t chunks = (block_rows + resolved.chunk_rows - 1) / resolved.chunk_rows * resolved.blocks;
  const int32_t acting = (resolved.config.num_envs + resolved.chunk_rows - 1) / resolved.chunk_rows;
  resolved.workers = std::clamp(resolved.config.num_threads, 1, std::max(chunks, acting));
  const double rho = o.noise_correlation;
  resolved.log_share = static_cast<float>(0.5 * elementary::log1p(-rho * rho));
}

void check_pairs(const ResolvedAgentConfig& resolved) {
  const SharedOptions& o = resolved.shared;
  if (o.std_min > o.std_max) fail(Code::kRange, "std_min: it is above std_max");
  if (o.init_std < o.std_min || o.init_std > o.std_max)
    fail(Code::kRange, "init_std: %g is outside [std_min, std_max]", o.init_std);
  if (o.state_std) {
    if (!o.learn_std || o.linear_std)
      fail(Code::kUnsupported, "std_mode: state needs learn_std=true and std_schedule=none");
    if (o.init_std <= o.std_min || o.init_std >= o.std_max)
      fail(Code::kRange, "init_std: it equals std_min or std_max, where std_mode=state has no gradient");
  }
  if (o.lr_min > o.lr_max) fail(Code::kRange, "lr_min: it is above lr_max");
  if (o.latent_student && o.imitation > 0)
    fail(Code::kUnsupported, "imitation: with latent_from=history the policy stays as it is");
  if (o.terminal_cost && resolved.episode_steps <= 0)
    fail(Code::kArgument,
         "terminal_cost: it needs the length of an episode: set config.max_steps or option episode_steps");
}

}  // namespace

void ResolvedAgentConfig::read_shared() {
  shared = read_shared_options(options, *row);
}

double limit_of_first(const ResolvedAgentConfig& resolved) {
  const SharedOptions& o = resolved.shared;
  return resolved.rate_steps > 0 ? o.cost_limit_per_step * resolved.rate_steps : o.cost_limit;
}

ResolvedAgentConfig resolve_config(const AgentConfig& config) {
  check_config(config);
  const AlgoRow& row = algo_row(algo_find(config.algo));
  ResolvedAgentConfig resolved(config, read_limited_options(config, row), row);
  std::snprintf(resolved.task, sizeof resolved.task, "%s", config.task ? config.task : "");
  resolved.config.algo = row.info.name;
  resolve_costs(resolved);
  check_pairs(resolved);
  resolve_networks(resolved);
  resolve_batches(resolved);
  return resolved;
}

}  // namespace rdm
