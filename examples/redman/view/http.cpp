#include "view/http.hpp"

#include <algorithm>
#include <cctype>

namespace tool {
namespace {

bool is_word(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) ||
           (c != 0 && std::string("!#$%&'*+-.^_`|~").find(static_cast<char>(c)) != std::string::npos);
  });
}

bool is_printable(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return c >= 0x20 && c < 0x7f; });
}

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

bool read_first_line(const std::string& line, Request* out) {
  const size_t first = line.find(' '), second = line.find(' ', first + 1);
  if (first == std::string::npos || second == std::string::npos) return false;
  out->method = line.substr(0, first);
  out->target = line.substr(first + 1, second - first - 1);
  return is_word(out->method) && !out->target.empty() && out->target[0] == '/' && is_printable(line) &&
         line.substr(second + 1) == "HTTP/1.1";
}

bool read_field(const std::string& line, Request* out) {
  const size_t colon = line.find(':');
  if (colon == std::string::npos) return false;
  std::string name = line.substr(0, colon);
  const std::string value = trimmed(line.substr(colon + 1));
  if (!is_word(name) || !std::all_of(value.begin(), value.end(),
                                     [](unsigned char c) { return c == '\t' || (c >= 0x20 && c != 0x7f); }))
    return false;
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const auto& field : out->fields)
    if (field.first == name) return false;
  out->fields.emplace_back(name, value);
  return true;
}

}  // namespace

const std::string& Request::field(const std::string& name) const {
  static const std::string none;
  for (const auto& field : fields)
    if (field.first == name) return field.second;
  return none;
}

Reading read_request(const std::string& bytes, Request* out, size_t* used) {
  const size_t end = bytes.substr(0, kMostHead).find("\r\n\r\n");
  if (end == std::string::npos) return bytes.size() >= kMostHead ? Reading::kBad : Reading::kMore;
  *out = {};
  *used = end + 4;
  bool first = true;
  for (size_t at = 0; at <= end;) {
    const size_t stop = std::min(bytes.find("\r\n", at), end);
    const std::string line = bytes.substr(at, stop - at);
    if (first ? !read_first_line(line, out) : !read_field(line, out)) return Reading::kBad;
    if (out->fields.size() > 64) return Reading::kBad;
    first = false;
    at = stop + 2;
  }
  const std::string& length = out->field("content-length");
  const bool body = !out->field("transfer-encoding").empty() || (!length.empty() && length != "0");
  return body ? Reading::kBad : Reading::kWhole;
}

std::string http_answer(int status, const std::string& type, const std::string& body,
                        const std::string& policy) {
  const char* text = status == 200   ? "OK"
                     : status == 400 ? "Bad Request"
                     : status == 403 ? "Forbidden"
                                     : "Not Found";
  std::string out = "HTTP/1.1 " + std::to_string(status) + ' ' + text +
                    "\r\nConnection: close\r\nContent-Length: " + std::to_string(body.size()) + "\r\n";
  if (!body.empty()) out += "Content-Type: " + type + "\r\n";
  out +=
      "Cache-Control: no-store\r\nReferrer-Policy: no-referrer\r\nX-Content-Type-Options: "
      "nosniff\r\nX-Frame-Options: DENY\r\n";
  out += "Cross-Origin-Resource-Policy: same-origin\r\nCross-Origin-Opener-Policy: same-origin\r\n";
  return out + "Content-Security-Policy: " + policy + "\r\n\r\n" + body;
}

}  // namespace tool
