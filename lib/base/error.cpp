#include "base/error.hpp"

#include <cstdarg>
#include <cstdio>

#include "base/format.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {
thread_local char t_text[kErrorTextSize] = "";
}

void fail(Code code, const char* format, ...) {
  Error e;
  e.code = code;
  char raw[kErrorTextSize + 4];  // a character that is cut here does not fit into the text either
  va_list args;
  va_start(args, format);
  print_list(raw, sizeof raw, format, args);
  va_end(args);
  clean_text(e.text, sizeof e.text, raw);
  throw e;
}

const char* last_error() {
  return t_text;
}

void set_last_error(const char* text) {
  clean_text(t_text, sizeof t_text, text);
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
