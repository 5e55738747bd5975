#include "common/json.hpp"

#include <cmath>

#include "common/report.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

constexpr int kMostDepth = 32;

const Document& member(const Document& object, const char* key) {
  if (!object.is_object()) throw Failure(std::string(key) + ": it is not within an object");
  const auto found = object.find(key);
  if (found == object.end()) throw Failure(std::string(key) + ": it is missing");
  return *found;
}

std::string text_of(const Document& value, const std::string& what, size_t most) {
  if (!value.is_string()) throw Failure(what + ": it is not a string");
  const auto& text = value.get_ref<const std::string&>();
  if (text.size() > most) throw Failure(what + ": it is longer than " + std::to_string(most) + " bytes");
  if (printable(text) != text) throw Failure(what + ": it contains control characters");
  return text;
}

}  // namespace

Json object_of(std::initializer_list<JsonMember> members) {
  Json out = Json::object();
  auto& object = out.get_ref<Json::object_t&>();
  object.reserve(members.size());
  for (const JsonMember& m : members) object.emplace(m.key, std::move(m.value));
  return out;
}

Document parse_json(const char* text, size_t size) {
  if (size > kMostJsonBytes) throw Failure("it is longer than " + std::to_string(kMostJsonBytes) + " bytes");
  const auto shallow = [](int depth, Document::parse_event_t, const Document&) {
    if (depth > kMostDepth) throw Failure("it is nested deeper than " + std::to_string(kMostDepth));
    return true;
  };
  Document out;
  try {
    out = Document::parse(text, text + size, shallow);
  } catch (const Document::exception& e) {
    throw Failure(e.what());
  }
  if (!out.is_object()) throw Failure("it is not an object");
  return out;
}

const Document& object_at(const Document& object, const char* key) {
  const Document& value = member(object, key);
  if (!value.is_object()) throw Failure(std::string(key) + ": it is not an object");
  return value;
}

int64_t integer_at(const Document& object, const char* key, int64_t low, int64_t high) {
  const Document& value = member(object, key);
  if (!value.is_number_integer()) throw Failure(std::string(key) + ": it is not an integer");
  // an unsigned number that is too large for an int64_t would come out negative
  const bool huge = value.is_number_unsigned() && value.get<uint64_t>() > static_cast<uint64_t>(INT64_MAX);
  const int64_t number = huge ? 0 : value.get<int64_t>();
  if (huge || number < low || number > high)
    throw Failure(std::string(key) + ": it is outside " + std::to_string(low) + " .. " +
                  std::to_string(high));
  return number;
}

uint64_t seed_at(const Document& object, const char* key) {
  const Document& value = member(object, key);
  if (!value.is_number_unsigned()) throw Failure(std::string(key) + ": it is not an integer of 0 or more");
  return value.get<uint64_t>();
}

bool flag_at(const Document& object, const char* key) {
  const Document& value = member(object, key);
  if (!value.is_boolean()) throw Failure(std::string(key) + ": it is not true or false");
  return value.get<bool>();
}

double number_of(const Document& value, const std::string& what, double low, double high) {
  if (!value.is_number()) throw Failure(what + ": it is not a number");
  const auto number = value.get<double>();
  if (!(number >= low && number <= high))
    throw Failure(what + ": it is outside " + number_text(low) + " .. " + number_text(high));
  return number;
}

double number_at(const Document& object, const char* key, double low, double high) {
  return number_of(member(object, key), key, low, high);
}

std::string text_at(const Document& object, const char* key, size_t most) {
  return text_of(member(object, key), key, most);
}

std::vector<std::string> texts_at(const Document& object, const char* key) {
  const Document& list = member(object, key);
  if (!list.is_array()) throw Failure(std::string(key) + ": it is not a list");
  std::vector<std::string> out;
  for (const Document& text : list) out.push_back(text_of(text, key, 4096));
  return out;
}

const Document& list_at(const Document& object, const char* key, size_t count) {
  const Document& list = member(object, key);
  if (!list.is_array() || list.size() != count)
    throw Failure(std::string(key) + ": it is not a list of " + std::to_string(count));
  return list;
}

}  // namespace tool
