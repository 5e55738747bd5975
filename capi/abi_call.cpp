#include "capi/abi_call.hpp"

namespace rdm::capi {

HostHooks hooks_from(const rdm_host* host) {
  if (!host) return rdm::host();
  const rdm_host in = read_struct(host, sizeof(rdm_host), rdm_host{}, "host");
  if (!in.alloc != !in.release) fail(Code::kArgument, "host: alloc and release come together or not at all");
  HostHooks out;
  out.user = in.user;
  out.alloc = in.alloc;
  out.release = in.release;
  out.log = in.log;
  out.parallel = in.parallel;
  return out;
}

rdm_option_info describe(const OptionSpec& s) {
  return {s.key,
          s.help,
          s.kind == OptionKind::kText ? s.text : nullptr,
          s.choices,
          s.number,
          s.low,
          s.high,
          static_cast<int32_t>(s.kind),
          s.live ? 1 : 0};
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
