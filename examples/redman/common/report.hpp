// What a command hands back, and how it fails.
#pragma once
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace tool {

using Json = nlohmann::ordered_json;

// An object of these members, which are moved into it: a list of lists in braces copies each several times.
struct JsonMember {
  const char* key;
  mutable Json value;
};
Json object_of(std::initializer_list<JsonMember> members);

// A command's result: main prints the object with --json, else the text.
struct Report {
  Json json;
  std::string text;
};

// On one line with indent -1. Bytes that are no UTF-8 come out as U+FFFD: nothing that a user typed or a file
// held keeps a result from being printed.
inline std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

// Wrong usage: exit status 2.
struct Usage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The work failed: exit status 1. The text says what to do.
struct Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace tool
