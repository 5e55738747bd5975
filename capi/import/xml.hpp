// XML as a tree that remembers what was read: the rest is listed as dropped.
#pragma once
#include <map>
#include <memory>

#include "geometry.hpp"
#include "import.hpp"

namespace rdm::import {

struct Attribute {
  std::string name, value;
  mutable bool read = false;
};
struct Element {
  std::string tag, file;  // file: "" or the name of an included one, cleaned
  int line = 0;
  std::vector<Attribute> attributes;
  std::vector<std::unique_ptr<Element>> children;
  mutable bool seen = false;

  const Attribute* find(const char* name) const;   // marks nothing
  const std::string* get(const char* name) const;  // NULL: it has none; marked as read
  const Element* child(const char* tag) const;     // the first; marked as seen
  std::vector<const Element*> all(const char* tag) const;
};

// The whole file; include elements are replaced by what stands in their files below `folder`.
// FORMAT with the line for what is no XML, UNSUPPORTED for a DOCTYPE that declares; `includes` allows
// <include file="">. What it costs is taken from out->budget before memory is.
std::unique_ptr<Element> parse_xml(const std::string& bytes, const Options& options, bool includes,
                                   Draft* out);

// "line 3: joint knee" (of an included file: "line 3 of b.xml: joint knee").
std::string where(const Element& e);
[[noreturn]] [[gnu::format(printf, 3, 4)]] void refuse_at(rdm_result code, const Element& e,
                                                          const char* format, ...);
inline constexpr double kLargest = 1e9;  // of a number, where nothing else is said
// The numbers of a text; refuses what is no number, not finite or beyond `largest`, a power of ten, each with its
// reason.
std::vector<double> numbers(const Element& e, const char* attribute, const std::string& text, size_t least,
                            size_t most, double largest = kLargest);
double number(const Element& e, const char* attribute, const std::string& text);
// The same of a bound, which may be none: what is infinite or beyond 1e9 is infinite.
double bound(const Element& e, const char* attribute, const std::string& text);
// Refuses what xacro would have replaced: ${} and $().
void refuse_xacro(const Element& e, const char* attribute, const std::string& text);
V3 vector3(const Element& e, const char* attribute, const std::string& text);

// Notes of elements that were not seen and attributes that were not read, in the order of the file.
void list_dropped(const Element& root, Draft* out);

}  // namespace rdm::import
