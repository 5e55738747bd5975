#include "base/error.hpp"

#include <cstdarg>
#include <cstdio>
#include <cstring>

namespace rdm {
namespace {
thread_local char t_text[kErrorTextSize] = "";
}

void fail(Code code, const char* format, ...) {
  Error e;
  e.code = code;
  va_list args;
  va_start(args, format);
  std::vsnprintf(e.text, sizeof e.text, format, args);
  va_end(args);
  for (char* c = e.text; *c; ++c)
    if (*c == '\n' || *c == '\r') *c = ' ';
  throw e;
}

const char* last_error() {
  return t_text;
}

void set_last_error(const char* text) {
  std::strncpy(t_text, text, sizeof t_text - 1);
  t_text[sizeof t_text - 1] = '\0';
}

const char* code_string(int32_t code) {
  switch (static_cast<Code>(code)) {
    case Code::kOk:
      return "ok";
    case Code::kArgument:
      return "bad argument";
    case Code::kRange:
      return "value out of range";
    case Code::kState:
      return "call not allowed in this state";
    case Code::kMemory:
      return "out of memory";
    case Code::kIo:
      return "input or output failed";
    case Code::kFormat:
      return "not a valid file of this kind";
    case Code::kVersion:
      return "version mismatch";
    case Code::kUnsupported:
      return "not supported";
    case Code::kPhysics:
      return "physics engine failure";
    case Code::kNotFound:
      return "not found";
    case Code::kCancelled:
      return "cancelled";
    case Code::kInternal:
      return "internal error";
  }
  return code > 0 ? "success (unknown positive code)" : "unknown error";
}

}  // namespace rdm
