// The first line and the fields of an HTTP/1.1 request, from somebody who may mean harm.
#pragma once
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace tool {

inline constexpr size_t kMostHead = 8192;  // bytes of a request before its empty line

struct Request {
  std::string method, target;
  std::vector<std::pair<std::string, std::string>> fields;  // names in lower case

  // "" where there is none.
  const std::string& field(const std::string& name) const;
};

enum class Reading { kMore, kBad, kWhole };

// Reads a request without a body from the first bytes of a connection; *used is its length. Bad: a line that is none, a
// control character, a body, a name of a field twice, more than kMostHead bytes. Its time grows with the size alone.
Reading read_request(const std::string& bytes, Request* out, size_t* used);

// An answer that ends its connection. Nothing of it is kept, framed, or told to another page.
std::string http_answer(int status, const std::string& type, const std::string& body,
                        const std::string& policy = "default-src 'none'");

}  // namespace tool
