#include "web/page.hpp"

#include <algorithm>
#include <cstring>

#include "common/report.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

const char* asset(const std::string& name) {
  for (const WebAsset* a = kWebAssets; a->name; ++a)
    if (name == a->name) return a->text;
  return nullptr;
}

}  // namespace

std::string filled_page(const std::string& name, const std::map<std::string, std::string>& parts) {
  const char* page = asset(name);
  if (!page) throw Failure("this build has no page " + name);
  std::string out;
  for (const char* at = page;;) {
    const char* begin = std::strstr(at, "{{");
    const char* end = begin ? std::strstr(begin, "}}") : nullptr;
    if (!end) return out + at;
    out.append(at, begin);
    const std::string part(begin + 2, end);
    const auto given = parts.find(part);
    const char* carried = given == parts.end() ? asset(part) : nullptr;
    if (given == parts.end() && !carried)
      throw Failure("this build has no " + part + " for the page " + name);
    out += carried ? carried : given->second;
    at = end + 2;
  }
}

std::string script_json(const std::string& json) {
  std::string out;
  for (const char c : json)
    if (c == '<')
      out += "\\u003c";  // no "</script>" inside
    else
      out += c;
  return out;
}

std::string base64(const void* bytes, size_t size) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* data = static_cast<const unsigned char*>(bytes);
  std::string out;
  out.reserve((size + 2) / 3 * 4);
  for (size_t i = 0; i < size; i += 3) {
    const size_t n = std::min<size_t>(size - i, 3);
    uint32_t v = 0;
    for (size_t k = 0; k < 3; ++k) v = v << 8 | (k < n ? data[i + k] : 0u);
    for (size_t k = 0; k < 4; ++k) out += k <= n ? kDigits[v >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

void check_viewer() {
  if (!asset("three"))
    throw Failure(
        "--html: this build has no viewer library: install the package libjs-three (or set REDMAN_VIEWER to "
        "a three.min.js), configure and build again; --glb works without it");
}

}  // namespace tool
