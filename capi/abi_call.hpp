// What all of the shim shares: the barrier between C++ and C, and structs that grow.
#pragma once
#include <algorithm>
#include <cstring>

#include "base/error.hpp"
#include "base/fpmode.hpp"
#include "base/host.hpp"
#include "base/option.hpp"
#include "redman/redman.h"

namespace rdm::capi {

// Runs f under the library's floating-point mode; a failure goes to this thread's text and, if given, to
// the handle's.
template <class F>
rdm_result call(char* handle_text, F&& f) noexcept {
  const FpMode mode;
  const Code code = guard(f);
  if (code != Code::kOk && handle_text) std::strcpy(handle_text, last_error());
  return static_cast<rdm_result>(code);
}

inline void need(const void* p, const char* name) {
  if (!p) fail(Code::kArgument, "%s is NULL", name);
}
inline void need_index(int64_t i, int64_t count, const char* name) {
  if (i < 0 || i >= count)
    fail(Code::kRange, "%s: %lld is outside [0, %lld)", name, static_cast<long long>(i),
         static_cast<long long>(count));
}

// No struct of any version is larger: a size above it was never set.
inline constexpr size_t kMaxStructSize = 4096;

inline void check_size(size_t size, size_t first_size, const char* name, const char* member) {
  if (size < first_size) fail(Code::kArgument, "%s%s: %zu is less than %zu", name, member, size, first_size);
  if (size > kMaxStructSize)
    fail(Code::kArgument, "%s%s: %zu is more than %zu: was it set?", name, member, size, kMaxStructSize);
}

// The caller's struct as this version knows it: fields beyond an older caller's size keep `defaults`, a
// newer caller's tail must be zero.
template <class T>
T read_struct(const T* in, size_t first_size, const T& defaults, const char* name) {
  need(in, name);
  const size_t size = in->struct_size;
  check_size(size, first_size, name, ".struct_size");
  const auto* bytes = reinterpret_cast<const unsigned char*>(in);
  for (size_t i = sizeof(T); i < size; ++i)
    if (bytes[i]) fail(Code::kVersion, "%s: a field that this version does not know is set", name);
  T out = defaults;
  std::memcpy(&out, in, std::min(size, sizeof(T)));
  out.struct_size = sizeof(T);
  return out;
}

template <class T>
void check_out(const T* io, size_t first_size, const char* name) {
  need(io, name);
  check_size(io->struct_size, first_size, name, ".struct_size");
}

// Writes as much of `value` as the caller's struct holds; struct_size stays the caller's.
template <class T>
void write_struct(T* io, T value, size_t first_size, const char* name) {
  check_out(io, first_size, name);
  value.struct_size = io->struct_size;
  std::memcpy(io, &value, std::min<size_t>(io->struct_size, sizeof(T)));
}

// Defaults into the first `size` bytes of the caller's struct; beyond them nothing is touched.
template <class T>
void init_struct(T* out, size_t size, size_t first_size, T value, const char* name) {
  need(out, name);
  check_size(size, first_size, "size", "");
  value.struct_size = static_cast<uint32_t>(size);
  std::memcpy(out, &value, std::min(size, sizeof(T)));
  if (size > sizeof(T)) std::memset(reinterpret_cast<unsigned char*>(out) + sizeof(T), 0, size - sizeof(T));
}

// Hooks of a handle: the config's, else the process's.
HostHooks hooks_from(const rdm_host* host);

rdm_option_info describe(const OptionSpec& spec);

// Public options as the library takes them; the strings stay the caller's. Error(kArgument) for a NULL list
// with a count, Error(kRange) for a count outside [0, 4096].
Vector<OptionInput> read_options(const rdm_option* options, int32_t count, const char* name);

[[noreturn]] inline void left_out(const char* half) {
  fail(Code::kUnsupported, "this build was made without the %s half", half);
}

}  // namespace rdm::capi
