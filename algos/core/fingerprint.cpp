#include "algos/core/fingerprint.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "algos/core/option_tables.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

constexpr const char* kWhat = "agent state";

// Options that came after the first files, by the release that they came with. A file has a group, behind all
// before it, only where an option of it or of a later one is not at its default: so files of before load, and an
// agent that uses none writes what it always did.
constexpr const char* kLater[][4] = {{"cost_limit_per_step", "episode_steps"},
                                     {"history", "history_fields", "memory", "memory_chunk"},
                                     {"latent", "latent_fields", "latent_hidden", "latent_from"}};
constexpr int32_t kGroups = static_cast<int32_t>(std::size(kLater));

// The group of an option, from 1 on; 0: of the first files.
int32_t group_of(const OptionSpec& spec) {
  for (int32_t g = 0; g < kGroups; ++g)
    for (const char* key : kLater[g])
      if (key && same_name(key, spec.key)) return g + 1;
  return 0;
}

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

const char* option_text(const Options& o, int32_t i) {
  return o.spec(i).kind == OptionKind::kText ? o.text(o.spec(i).key) : "";
}

int32_t first_count(const Options& o) {
  int32_t count = 0;
  for (int32_t i = 0; i < o.count(); ++i) count += group_of(o.spec(i)) == 0;
  return count;
}

// The last group of which an option is not at its default.
int32_t last_group(const Options& o) {
  int32_t last = 0;
  for (int32_t i = 0; i < o.count(); ++i) {
    const OptionSpec& spec = o.spec(i);
    const bool differs = spec.kind == OptionKind::kText ? std::strcmp(o.text(spec.key), spec.text) != 0
                                                        : option_number(o, i) != spec.number;
    if (differs) last = std::max(last, group_of(spec));
  }
  return last;
}

struct Field {
  const char* name;
  int32_t value;
};
constexpr int kFields = 6;
void list_fields(const ResolvedAgentConfig& resolved, Field* out) {
  const AgentConfig& c = resolved.config;
  const Field fields[kFields] = {
      {"obs_dim", c.obs_dim},     {"action_dim", c.action_dim},
      {"cost_dim", c.cost_dim},   {"num_envs", resolved.all_envs()},
      {"max_steps", c.max_steps}, {"number of limited costs", resolved.num_limited}};
  for (int i = 0; i < kFields; ++i) out[i] = fields[i];
}

void read_option(Reader& in, Options& o, int32_t i, bool apply) {
  const OptionSpec& s = o.spec(i);
  char key[kOptionTextSize], text[kLongestObs + 1];
  in.text(key, sizeof key);
  in.text(text, sizeof text);
  const auto number = in.value<double>();
  if (std::strcmp(key, s.key) != 0)
    fail(Code::kFormat, "%s: it has option %s where option %s is expected", kWhat, key, s.key);
  if (s.live) {
    const bool good = number >= s.low && number <= s.high &&
                      (s.kind == OptionKind::kNumber || number == std::floor(number));
    if (!good) fail(Code::kFormat, "%s: option %s is %g, which is not possible", kWhat, s.key, number);
    // Without a limit there is no multiplier and no column of the critic for it.
    if (same_name(s.key, "cost_limit") && (number < 0) != (o.number(s.key) < 0))
      fail(Code::kFormat, "%s: column 0 was %s a limit in it", kWhat, number < 0 ? "without" : "with");
    if (same_name(s.key, "cost_limit_per_step") && (number < 0) != (o.number(s.key) < 0))
      fail(Code::kFormat, "%s: option cost_limit_per_step is %g in it, which is not possible", kWhat, number);
    if (apply) o.set({s.key, nullptr, number}, "agent");
    return;
  }
  if (std::strcmp(text, option_text(o, i)) == 0 && number == option_number(o, i)) return;
  char here[kOptionTextSize];
  o.print(i, here);
  if (s.kind == OptionKind::kText)
    fail(Code::kFormat, "%s: option %s is '%s' in it, but '%s' in this agent", kWhat, s.key,
         Quoted(text).text, Quoted(here).text);
  fail(Code::kFormat, "%s: option %s is %.9g in it, but %s in this agent", kWhat, s.key, number, here);
}

}  // namespace

void write_fingerprint(Writer& out, const ResolvedAgentConfig& resolved) {
  const Options& o = resolved.options;
  out.begin_section("CONF");
  out.text(resolved.config.algo);
  Field fields[kFields];
  list_fields(resolved, fields);
  for (const Field& f : fields) out.value(f.value);
  for (int32_t i = 0; i < resolved.num_limited; ++i) out.value(resolved.column[i]);
  for (int32_t i = 0; i < resolved.num_limited; ++i) out.value(resolved.limit[i]);
  out.value(first_count(o));
  for (int32_t group = 0; group <= last_group(o); ++group)
    for (int32_t i = 0; i < o.count(); ++i) {
      if (group_of(o.spec(i)) != group) continue;
      out.text(o.spec(i).key);
      out.text(option_text(o, i));
      out.value(option_number(o, i));
    }
  out.end_section();
}

void read_fingerprint(Reader& in, ResolvedAgentConfig& resolved, bool apply) {
  in.need_section("CONF");
  char algo[kOptionTextSize];
  in.text(algo, sizeof algo);
  if (std::strcmp(algo, resolved.config.algo) != 0)
    fail(Code::kFormat, "%s: it belongs to algorithm %s, but this agent is %s", kWhat, algo,
         resolved.config.algo);
  Field fields[kFields];
  list_fields(resolved, fields);
  for (const Field& f : fields)
    if (const auto there = in.value<int32_t>(); there != f.value)
      fail(Code::kFormat, "%s: %s is %d in it, but %d in this agent", kWhat, f.name, there, f.value);
  for (int32_t i = 0; i < resolved.num_limited; ++i)
    if (const auto there = in.value<int32_t>(); there != resolved.column[i])
      fail(Code::kFormat, "%s: cost column %d is limited in it, but %d in this agent", kWhat, there,
           resolved.column[i]);
  for (int32_t i = 0; i < resolved.num_limited; ++i) {
    const auto there = in.value<double>();
    const bool live = resolved.column[i] == 0;  // option cost_limit
    if (!live && there != resolved.limit[i])
      fail(Code::kFormat, "%s: the limit of cost column %d is %g in it, but %g in this agent", kWhat,
           resolved.column[i], there, resolved.limit[i]);
  }
  Options& o = resolved.options;
  if (const auto there = in.value<int32_t>(); there != first_count(o))
    fail(Code::kFormat, "%s: it has %d options, this agent %d", kWhat, there, first_count(o));
  const int32_t wanted = last_group(o);
  for (int32_t group = 0; group <= kGroups; ++group) {
    if (group > 0 && in.left() == 0) {
      if (group > wanted) break;
      const auto differs = [&](int32_t i) { return group_of(o.spec(i)) == wanted; };
      int32_t i = 0;
      while (!differs(i)) ++i;
      fail(Code::kFormat, "%s: it lacks option %s and others of this agent", kWhat, o.spec(i).key);
    }
    for (int32_t i = 0; i < o.count(); ++i)
      if (group_of(o.spec(i)) == group) read_option(in, o, i, apply);
  }
  in.expect_end();
}

}  // namespace rdm
