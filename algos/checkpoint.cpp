// Saving and loading of PolicyGradient, and its policy file.
#include <cmath>
#include <cstring>

#include "algos/options.hpp"
#include "algos/policy_gradient.hpp"
#include "algos/registry.hpp"
#include "base/error.hpp"
#include "nn/policy.hpp"

namespace rdm {
namespace {

constexpr char kMagic[8] = {'R', 'D', 'M', 'A', 'G', 'E', 'N', 'T'};
constexpr uint32_t kVersion = 1;
constexpr const char* kWhat = "agent state";

double option_number(const Options& o, int32_t i) {
  const OptionSpec& s = o.spec(i);
  switch (s.kind) {
    case OptionKind::kNumber:
      return o.number(s.key);
    case OptionKind::kInteger:
      return o.integer(s.key);
    case OptionKind::kFlag:
      return o.flag(s.key);
    case OptionKind::kText:
      break;
  }
  return 0;
}

// The fields of a config that two agents must share to exchange states.
struct NamedNumber {
  const char* name;
  int32_t value;
};

}  // namespace

void PolicyGradient::write_config(Writer& out) const {
  const AgentConfig& c = plan_.config;
  const Options& o = plan_.options;
  out.begin_section("CONF");
  out.text(c.algo);
  for (const int32_t v : {c.obs_dim, c.action_dim, c.cost_dim, c.num_envs, c.max_steps, plan_.num_limited})
    out.value(v);
  for (int32_t i = 0; i < kMaxCosts; ++i) out.value(plan_.column[i]);
  for (int32_t i = 0; i < kMaxCosts; ++i) out.value(plan_.limit[i]);
  out.value(o.count());
  for (int32_t i = 0; i < o.count(); ++i) {
    out.text(o.spec(i).key);
    out.text(o.spec(i).kind == OptionKind::kText ? o.text(o.spec(i).key) : "");
    out.value(option_number(o, i));
  }
  out.end_section();
}

// Error(kFormat) that names the first field that differs. Live options are taken over when `apply`.
void PolicyGradient::read_config(Reader& in, bool apply) {
  const AgentConfig& c = plan_.config;
  Options& o = plan_.options;
  in.need_section("CONF");
  char text[kOptionTextSize], key[kOptionTextSize];
  in.text(text, sizeof text);
  if (std::strcmp(text, c.algo) != 0)
    fail(Code::kFormat, "%s: of algorithm %s, this agent is %s", kWhat, text, c.algo);
  const NamedNumber fields[] = {{"obs_dim", c.obs_dim},     {"action_dim", c.action_dim},
                                {"cost_dim", c.cost_dim},   {"num_envs", c.num_envs},
                                {"max_steps", c.max_steps}, {"limited cost columns", plan_.num_limited}};
  for (const NamedNumber& f : fields)
    if (const auto v = in.value<int32_t>(); v != f.value)
      fail(Code::kFormat, "%s: %s is %d there, %d in this agent", kWhat, f.name, v, f.value);
  for (int32_t i = 0; i < kMaxCosts; ++i)
    if (in.value<int32_t>() != plan_.column[i])
      fail(Code::kFormat, "%s: other cost columns are limited", kWhat);
  for (int32_t i = 0; i < kMaxCosts; ++i) {
    const auto limit = in.value<double>();
    const bool live = i == 0 && plan_.num_limited > 0 && plan_.column[0] == 0;
    if (!live && limit != plan_.limit[i])
      fail(Code::kFormat, "%s: the limit of cost column %d is %g there, %g here", kWhat, plan_.column[i],
           limit, plan_.limit[i]);
  }
  if (in.value<int32_t>() != o.count()) fail(Code::kFormat, "%s: another number of options", kWhat);
  for (int32_t i = 0; i < o.count(); ++i) {
    const OptionSpec& s = o.spec(i);
    in.text(key, sizeof key);
    in.text(text, sizeof text);
    const auto number = in.value<double>();
    if (std::strcmp(key, s.key) != 0)
      fail(Code::kFormat, "%s: option %s where %s belongs", kWhat, key, s.key);
    if (s.live) {
      if (!(number >= s.low && number <= s.high))
        fail(Code::kFormat, "%s: option %s is %g", kWhat, s.key, number);
      if (apply) o.set({s.key, nullptr, number}, "agent");
    } else if (s.kind == OptionKind::kText ? std::strcmp(text, o.text(s.key)) != 0
                                           : number != option_number(o, i)) {
      char here[kOptionTextSize];
      o.print(i, here);
      if (s.kind == OptionKind::kText)
        fail(Code::kFormat, "%s: option %s is '%s' there, '%s' in this agent", kWhat, s.key, text, here);
      fail(Code::kFormat, "%s: option %s is %.9g there, %s in this agent", kWhat, s.key, number, here);
    }
  }
  in.expect_end();
}

void PolicyGradient::visit_state(StateIo& io) {
  constexpr int64_t kMost = int64_t{1} << 62;
  io.section("COUN");
  io.integer(epoch_, 0, INT32_MAX);
  io.integer(env_steps_, 0, kMost);
  io.integer(skipped_, 0, kMost);
  io.stream(shuffle_);
  nets_.visit(io);
  io.section("NORM");
  const auto dim = static_cast<size_t>(normalizer_.dim);
  io.number(normalizer_.count, 0, 1e300);
  io.numbers(normalizer_.mean, dim, -1e300, 1e300);
  io.numbers(normalizer_.m2, dim, 0, 1e300);
  noise_.visit(io);
  episodes_.visit(io);
  schedule_.visit(io);
}

void PolicyGradient::save(Writer& out) const {
  if (rollout_.filled > 0 || pending_)
    fail(Code::kState, "save: only between epochs; this horizon has begun");
  out.begin_file(kMagic, kVersion);
  write_config(out);
  StateWriter io(out);
  // The listing is shared with load; a StateWriter only reads.
  const_cast<PolicyGradient*>(this)->visit_state(io);
  io.end();
  out.end_file();
}

void PolicyGradient::load(const void* bytes, size_t size) {
  if (!bytes) fail(Code::kArgument, "agent state: NULL");
  for (const bool apply : {false, true}) {
    Reader in(bytes, size, kWhat);
    in.begin_file(kMagic, kVersion);
    read_config(in, apply);
    if (apply) read_live();
    StateReader io(in, apply);
    visit_state(io);
    io.end();
  }
  normalizer_refresh(normalizer_);
  clamp_log_std(nets_, plan_.options);
  drop_horizon();
}

void PolicyGradient::write_policy_file(Writer& out) {
  const HostScope scope(plan_.config.hooks);
  PolicyView v;
  v.actor = nets_.shape[Networks::kActor];
  v.params = nets_.net(Networks::kActor);
  v.log_std = nets_.log_std();
  v.shift = normalizer_.shift;
  v.scale = normalizer_.scale;
  v.clip = normalize_ ? normalizer_.clip : 0;
  v.action_repeat = plan_.action_repeat;
  v.noise_correlation = noise_.correlation();
  v.control_dt = plan_.config.control_dt;
  v.layout_hash = plan_.config.layout_hash;
  std::memcpy(v.task, plan_.task, sizeof v.task);
  v.example_obs = normalizer_.shift;
  write_policy(out, v);
}

}  // namespace rdm
