// JSON that somebody else may have written: sizes, depth, kinds and ranges are checked, and a Failure says
// what is wrong where. Its text names no file: the caller puts that before it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tool {

// Unlike Json it finds its members in logarithmic time, however many a file holds.
using Document = nlohmann::json;

inline constexpr size_t kMostJsonBytes = size_t{1} << 20;
inline constexpr int64_t kMostExact = int64_t{1} << 53;  // doubles hold all integers up to here

// An object. Failure when the text is not one, is longer than kMostJsonBytes or nested deeper than 32.
Document parse_json(const char* text, size_t size);

// Members of an object. Failure when there is none of that name, or of another kind, or outside low .. high.
const Document& object_at(const Document& object, const char* key);
int64_t integer_at(const Document& object, const char* key, int64_t low, int64_t high);
uint64_t seed_at(const Document& object, const char* key);
bool flag_at(const Document& object, const char* key);
double number_at(const Document& object, const char* key, double low, double high);
// Without control characters, and no longer than `most` bytes.
std::string text_at(const Document& object, const char* key, size_t most = 4096);
std::vector<std::string> texts_at(const Document& object, const char* key);
// A list of so many elements.
const Document& list_at(const Document& object, const char* key, size_t count);

// The same of a value itself; `what` names it.
double number_of(const Document& value, const std::string& what, double low, double high);

}  // namespace tool
