// Result codes, the exception that carries one, the thread's error text, and the barrier at the ABI.
//
// Inside the library a failure is thrown as Error; `guard` turns it into a code and a one-line text, so
// that nothing ever crosses the C ABI but an int32.
#pragma once
#include <cstdint>
#include <new>

namespace rdm {

// Same values as rdm_result in redman/base.h; frozen.
enum class Code : int32_t {
  kOk = 0,
  kArgument = -1,
  kRange = -2,
  kState = -3,
  kMemory = -4,
  kIo = -5,
  kFormat = -6,
  kVersion = -7,
  kUnsupported = -8,
  kPhysics = -9,
  kNotFound = -10,
  kCancelled = -11,
  kInternal = -99,
};

inline constexpr int kErrorTextSize = 256;

struct Error {
  Code code;
  char text[kErrorTextSize];
};

// Throws an Error with a printf-formatted text, made one line of valid UTF-8 (base/text.hpp).
[[noreturn]] [[gnu::format(printf, 2, 3)]] void fail(Code code, const char* format, ...);

// This thread's last failure; never NULL. set_last_error cuts at a character, at most kErrorTextSize - 1
// bytes.
const char* last_error();
void set_last_error(const char* text);

const char* code_string(int32_t code);

// Runs f; on any exception stores its text in this thread's last error and returns its code.
template <class F>
Code guard(F&& f) noexcept {
  try {
    f();
    return Code::kOk;
  } catch (const Error& e) {
    set_last_error(e.text);
    return e.code;
  } catch (const std::bad_alloc&) {
    set_last_error("out of memory");
    return Code::kMemory;
  } catch (...) {
    set_last_error("internal error: unexpected exception");
    return Code::kInternal;
  }
}

}  // namespace rdm
