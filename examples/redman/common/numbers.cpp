#include "common/numbers.hpp"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "common/text.hpp"

namespace tool {
namespace {

template <class T>
bool read_all_of(const std::string& text, T* out) {
  const char *begin = text.data(), *end = begin + text.size();
  if (begin < end && *begin == '+' && begin + 1 < end && begin[1] != '-') ++begin;
  const auto [stop, error] = std::from_chars(begin, end, *out);
  return error == std::errc() && stop == end && begin < end;
}

// What keeps `text` from being an integer.
std::string why_not_whole(const std::string& text, bool is_signed) {
  int64_t number = 0;
  uint64_t natural = 0;
  double real = 0;
  if (is_signed ? read_whole(text, &number) : read_whole(text, &natural)) return "";
  if (!is_signed && text[0] == '-' && read_whole(text, &number)) return text + " is negative";
  if (!read_number(text, &real)) return "'" + text + "' is not a whole number";
  return real == std::floor(real) && text.find_first_not_of("+-0123456789") == std::string::npos
             ? text + " is out of range"
             : text + " is not a whole number, written in digits";
}

}  // namespace

bool read_whole(const std::string& text, int64_t* out) {
  return read_all_of(text, out);
}
bool read_whole(const std::string& text, uint64_t* out) {
  return read_all_of(text, out);
}
bool read_number(const std::string& text, double* out) {
  if (text.empty() || text.find_first_not_of("+-.eE0123456789") != std::string::npos) return false;
  char* end = nullptr;  // the tool's locale is C (main.cpp)
  *out = std::strtod(text.c_str(), &end);
  return *end == '\0' && std::isfinite(*out);
}

void check_numbers(CLI::App& command) {
  for (CLI::Option* o : command.get_options()) {
    const std::string type = o->get_type_name();
    const bool natural = type.starts_with("UINT"), whole = natural || type.starts_with("INT");
    if (!whole && !type.starts_with("FLOAT")) continue;
    o->transform(CLI::Validator(
        [whole, natural](std::string& text) {
          double real = 0;
          if (whole) return why_not_whole(text, !natural);
          return read_number(text, &real) ? std::string() : "'" + text + "' is not a number";
        },
        ""));
  }
  for (CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; })) check_numbers(*sub);
}

CLI::Validator between(double low, double high) {
  const auto digits =
      [](double x) {  // 1000000, where number_text has 1e+06: what whole numbers are written in
        return x == std::floor(x) ? format("%.0f", x) : number_text(x);
      };
  const std::string range = digits(low) + " .. " + digits(high);
  return CLI::Validator(
      [low, high, range](const std::string& text) {
        double value = 0;
        return read_number(text, &value) && value >= low && value <= high ? std::string()
                                                                          : text + " is outside " + range;
      },
      range);
}

CLI::Validator at_least(double least) {
  return CLI::Validator(
      [least](const std::string& text) {
        double value = 0;
        return read_number(text, &value) && value >= least ? std::string()
                                                           : text + " is less than " + number_text(least);
      },
      "");
}

CLI::Validator above_zero() {
  return CLI::Validator(
      [](const std::string& text) {
        double value = 0;
        return read_number(text, &value) && value > 0 ? std::string() : text + " is not above 0";
      },
      "");
}

}  // namespace tool
