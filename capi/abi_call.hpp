// What all of the shim shares: the barrier between C++ and C, handles, and structs that grow.
#pragma once
#include <algorithm>
#include <cstring>

#include "base/arena.hpp"
#include "base/bytes.hpp"
#include "base/error.hpp"
#include "base/fpmode.hpp"
#include "base/host.hpp"
#include "base/option.hpp"
#include "base/text.hpp"
#include "redman/redman.h"

namespace rdm::capi {

// No struct of any version is larger: a size above it was never set.
inline constexpr size_t kMaxStructSize = 4096;

// Runs f under the library's floating-point mode; a failure goes to this thread's text. Calls on a handle:
// in_use.hpp.
template <class F>
rdm_result call(F&& f) noexcept {
  const FpMode mode;
  return static_cast<rdm_result>(guard(f));
}

// A failure's text goes to config.error too, where there is one.
template <class Config>
rdm_result tell(const Config* c, rdm_result r) {
  if (r == RDM_OK || !c) return r;
  constexpr size_t end = offsetof(Config, error_size) + sizeof c->error_size;
  if (c->struct_size < end || c->struct_size > kMaxStructSize || !c->error || c->error_size < 1) return r;
  copy_text(c->error, static_cast<size_t>(c->error_size), last_error());
  return r;
}
template <class Config, class F>
rdm_result call_with(const Config* c, F&& f) noexcept {
  return tell(c, call(f));
}
template <class Config>
void check_error(const Config& c) {
  if (c.error && c.error_size < 1)
    fail(Code::kRange, "config.error_size: %d is less than 1, but error is not NULL", c.error_size);
}

// For functions that a host calls within its own ones: the library's floating-point mode is set already, and
// whoever called the host wants to know whether the thread's text is of a failure in there.
void note_failure(bool failed);
bool failure_noted();
template <class F>
rdm_result call_inside(F&& f) noexcept {
  const Code code = guard(f);
  if (code != Code::kOk) note_failure(true);
  return static_cast<rdm_result>(code);
}

// The first word of what a handle points to: its kind, or 0 when it was destroyed.
enum class Tag : uint32_t {
  kNone = 0,
  kPool = 0x6c6f6f70,
  kAgent = 0x6e656761,
  kPolicy = 0x796c6f70,
  kActor = 0x6f746361,
  kMap = 0x2070616d,
  kRecording = 0x64636572,
  kPlanner = 0x6e616c70,
  kScene = 0x6e656373,
  kWorld = 0x6c726f77,
  kShield = 0x646c6873
};
const char* name_of(Tag tag);  // "pool"; NULL for what is no tag

inline void need(const void* p, const char* name) {
  if (!p) fail(Code::kArgument, "%s is NULL", name);
}
// Of (out, capacity, count): one that memory cannot have was a negative number.
template <class T>
void need_room(const T* out, size_t capacity, const char* name) {
  if (capacity > SIZE_MAX / 2 / sizeof(T))
    fail(Code::kRange, "capacity: %zu is more than the memory can hold", capacity);
  if (capacity > 0) need(out, name);
}
template <class Handle>
bool is_handle(const Handle* h) {
  return h && h->tag == Handle::kTag;
}
template <class Handle>
void need_handle(const Handle* h) {
  const char* name = name_of(Handle::kTag);
  need(h, name);
  if (h->tag == Handle::kTag) return;
  if (const char* other = name_of(h->tag))
    fail(Code::kArgument, "%s: it is a handle of another kind, %s", name, other);
  fail(Code::kArgument, "%s: it is not a handle of this kind, or it was destroyed", name);
}
// Before the memory goes: whoever comes with the handle once more is told.
template <class Handle>
void retire(Handle* h) {
  *const_cast<volatile Tag*>(&h->tag) = Tag::kNone;
}
inline void need_index(int64_t i, int64_t count, const char* name) {
  if (i < 0 || i >= count)
    fail(Code::kRange, "%s: %lld is outside [0, %lld)", name, static_cast<long long>(i),
         static_cast<long long>(count));
}

inline void check_size(size_t size, size_t first_size, const char* name, const char* member) {
  if (size < first_size) fail(Code::kArgument, "%s%s: %zu is less than %zu", name, member, size, first_size);
  if (size > kMaxStructSize)
    fail(Code::kArgument, "%s%s: %zu is more than %zu; was it set at all?", name, member, size,
         kMaxStructSize);
}

// A reserved member may mean something in a later version: whoever sets it must not be misread by this one.
template <class T>
void check_reserved(const T& s, const char* name) {
  const auto zero = [name](const auto& member, const char* which) {
    unsigned char bytes[sizeof member];
    std::memcpy(bytes, &member, sizeof member);
    if (std::any_of(bytes, bytes + sizeof member, [](unsigned char b) { return b != 0; }))
      fail(Code::kArgument, "%s.%s: it must be 0", name, which);
  };
  if constexpr (requires { s.reserved; }) zero(s.reserved, "reserved");
  if constexpr (requires { s.reserved2; }) zero(s.reserved2, "reserved2");
  if constexpr (requires { s.reserved3; }) zero(s.reserved3, "reserved3");
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
  check_reserved(out, name);
  return out;
}

template <class T>
void check_out(const T* io, size_t first_size, const char* name) {
  need(io, name);
  check_size(io->struct_size, first_size, name, ".struct_size");
}

// Writes as much of `value` as the caller's struct holds; struct_size stays the caller's, and what a newer
// caller's has beyond is zeroed.
template <class T>
void write_struct(T* io, T value, size_t first_size, const char* name) {
  check_out(io, first_size, name);
  value.struct_size = io->struct_size;
  const size_t size = io->struct_size;
  std::memcpy(io, &value, std::min(size, sizeof(T)));
  if (size > sizeof(T)) std::memset(reinterpret_cast<unsigned char*>(io) + sizeof(T), 0, size - sizeof(T));
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

// What rdm_policy_scratch and its like ask for beyond the `bytes` that are used, for any address to do.
inline constexpr size_t kScratchSlack = Arena::kAlign - 1;
inline void* aligned_scratch(void* scratch, size_t size, size_t bytes) {
  if (size < bytes + kScratchSlack)
    fail(Code::kRange, "scratch_bytes: %zu are too few, %zu are needed", size, bytes + kScratchSlack);
  const auto at = reinterpret_cast<uintptr_t>(scratch);
  return static_cast<unsigned char*>(scratch) + (Arena::kAlign - at % Arena::kAlign) % Arena::kAlign;
}

// Sizes of structs that have grown, as they were at first.
inline constexpr size_t kFirstBuildSize = offsetof(rdm_build, differs);
inline constexpr size_t kFirstTaskSize = offsetof(rdm_task, action_order);
inline constexpr size_t kFirstSpecSize = offsetof(rdm_spec, action_repeat);
inline constexpr size_t kFirstEpochSize = offsetof(rdm_epoch, cost_signal);
inline constexpr size_t kFirstTransitionSize = offsetof(rdm_transition, status);
inline constexpr size_t kFirstAgentConfigSize = offsetof(rdm_agent_config, settings);
#ifdef RDM_EXPERIMENTAL
inline constexpr size_t kFirstRecordingConfigSize = offsetof(rdm_recording_config, num_points);
inline constexpr size_t kFirstRecordingInfoSize = offsetof(rdm_recording_info, num_points);
inline constexpr size_t kFirstRecordingRowsSize = offsetof(rdm_recording_rows, points);
inline constexpr size_t kFirstPointsSize = offsetof(rdm_points, point_color);
inline constexpr size_t kFirstSensorsSize = offsetof(rdm_sensors, point_class);
#endif

// Hooks of a handle: the config's, else the process's.
HostHooks hooks_from(const rdm_host* host);

rdm_option_spec describe(const OptionSpec& spec);

// Text of any length for (text, capacity, size): NULL asks for the size alone, which is without the
// terminator.
void give_settings(const Options& options, char* text, size_t capacity, size_t* size);
// Writes a byte stream of unknown length: `write` runs once to count and once into the caller's memory.
template <class F>
void emit(void* bytes, size_t capacity, size_t* size, F&& write) {
  need(size, "size");
  Writer count(nullptr, 0);
  write(count);
  if (bytes) {
    if (capacity < count.size())
      fail(Code::kRange, "capacity: %zu bytes are too few, %zu are needed", capacity, count.size());
    Writer out(bytes, capacity);
    write(out);
  }
  *size = count.size();
}
// Option i for (key, text [RDM_TEXT_SIZE]).
void give_option(const Options& options, int32_t i, const char** key, char* text, const char* settings_call);

// Public options as the library takes them; the strings stay the caller's. Error(kArgument) for a NULL list
// with a count, Error(kRange) for a count outside [0, 4096].
Vector<OptionInput> read_options(const rdm_option* options, int32_t count, const char* name);

[[noreturn]] inline void left_out(const char* half) {
  fail(Code::kUnsupported, "this build was made without the %s half", half);
}

}  // namespace rdm::capi
