// What a command hands back, and how it fails.
#pragma once
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace tool {

using Json = nlohmann::ordered_json;

// A command's result: main prints the object with --json, else the text.
struct Report {
  Json json;
  std::string text;
};

// Wrong usage: exit status 2.
struct Usage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The work failed: exit status 1. The text says what to do.
struct Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace tool
