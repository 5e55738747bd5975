#include "capi/abi_call.hpp"

namespace rdm::capi {

HostHooks hooks_from(const rdm_host* host) {
  if (!host) return rdm::host();
  const rdm_host in = read_struct(host, sizeof(rdm_host), rdm_host{}, "host");
  if (!in.alloc != !in.release) fail(Code::kArgument, "host: set both alloc and release, or neither");
  HostHooks out;
  out.user = in.user;
  out.alloc = in.alloc;
  out.release = in.release;
  out.log = in.log;
  out.parallel = in.parallel;
  return out;
}

namespace {
thread_local bool t_failed = false;
}
void note_failure(bool failed) {
  t_failed = failed;
}
bool failure_noted() {
  return t_failed;
}

const char* name_of(Tag tag) {
  switch (tag) {
    case Tag::kPool:
      return "pool";
    case Tag::kAgent:
      return "agent";
    case Tag::kPolicy:
      return "policy";
    case Tag::kActor:
      return "actor";
    case Tag::kPlanner:
      return "planner";
    case Tag::kShield:
      return "shield";
    case Tag::kMap:
      return "map";
    case Tag::kRecording:
      return "recording";
    case Tag::kScene:
      return "scene";
    case Tag::kWorld:
      return "world";
    case Tag::kNone:
      break;
  }
  return nullptr;
}

rdm_option_spec describe(const OptionSpec& s) {
  rdm_option_spec o{};
  o.kind = static_cast<int32_t>(s.kind);
  o.live = s.live ? 1 : 0;
  o.level = static_cast<int32_t>(s.level);
  o.key = s.key;
  o.help = s.help;
  o.text = s.text;
  o.choices = s.range ? "a..b" : s.choices;
  o.number = s.number;
  o.low = s.low;
  o.high = s.high;
  return o;
}

void give_settings(const Options& options, char* text, size_t capacity, size_t* size) {
  need(size, "size");
  const size_t length = options.print_lines(nullptr, 0);
  if (text && capacity <= length)
    fail(Code::kRange, "capacity: %zu bytes are too few, %zu are needed", capacity, length + 1);
  if (text) options.print_lines(text, capacity);
  *size = length;
}

void give_option(const Options& options, int32_t i, const char** key, char* text, const char* settings_call) {
  need(key, "key");
  need(text, "text");
  need_index(i, options.count(), "i");
  char value[RDM_TEXT_SIZE];
  *key = options.key(i);
  if (!options.print(i, value))
    fail(Code::kRange, "option %s: its text is longer than %d bytes; %s gives all of it", options.key(i),
         RDM_TEXT_SIZE - 1, settings_call);
  std::strcpy(text, value);
}

Vector<OptionInput> read_options(const rdm_option* options, int32_t count, const char* name) {
  if (count < 0) fail(Code::kRange, "num_%s: %d is negative", name, count);
  if (count > 4096) fail(Code::kRange, "num_%s: %d is above 4096", name, count);
  if (count > 0 && !options) fail(Code::kArgument, "%s is NULL, but num_%s is %d", name, name, count);
  Vector<OptionInput> out;
  for (int32_t i = 0; i < count; ++i) out.push_back({options[i].key, options[i].text, options[i].number});
  return out;
}

}  // namespace rdm::capi
