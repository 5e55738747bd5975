#include "xml.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstring>

#include "base/chars.hpp"
#include "base/format.hpp"

namespace rdm::import {
namespace {

constexpr int kMostIncludes = 16;              // deep
constexpr size_t kMostAttributes = 256;        // of an element: the parser compares each with all before it
constexpr size_t kMostText = 256, kEach = 64;  // bytes of a text of numbers, and of each of them

const char* reason_of(tinyxml2::XMLError e) {
  switch (e) {
    case tinyxml2::XML_ERROR_PARSING_DECLARATION:
      return "the declaration <?xml ...?> must come first in the file, even before comments";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute that is not name=\"value\", or occurs twice";
    case tinyxml2::XML_ERROR_PARSING:
      return "the file ends within an element, or a tag is not closed";
    case tinyxml2::XML_ERROR_PARSING_TEXT:
      return "a text that does not end";
    case tinyxml2::XML_ERROR_PARSING_CDATA:
      return "a CDATA section that does not end";
    case tinyxml2::XML_ERROR_PARSING_COMMENT:
      return "a comment that does not end";
    case tinyxml2::XML_ERROR_PARSING_UNKNOWN:
      return "a <! that does not end";
    case tinyxml2::XML_ERROR_PARSING_ELEMENT:
      return "an element that does not end";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element that is closed by the end of another one, or not at all";
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "it is empty";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      return "elements are nested too deeply";
    default:
      return tinyxml2::XMLDocument::ErrorIDToName(e);
  }
}

// A DOCTYPE alone says nothing; entities and what other files declare would change values unseen.
void refuse_doctype(const std::string& bytes, const std::string& file) {
  for (size_t at = 0; (at = bytes.find('<', at)) != std::string::npos; ++at) {
    if (bytes.compare(at, 4, "<!--") == 0) {
      at = bytes.find("-->", at);
      if (at == std::string::npos) return;
      continue;
    }
    if (bytes.compare(at, 2, "<?") == 0) continue;       // a declaration may stand before it
    if (bytes.compare(at, 9, "<!DOCTYPE") != 0) return;  // the root element: none may come behind it
    const std::string text = bytes.substr(at, bytes.find('>', at) - at);
    const auto line = 1 + std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    for (const char* word : {"[", "SYSTEM", "PUBLIC"})
      if (text.find(word) != std::string::npos)
        refuse(RDM_ERROR_UNSUPPORTED,
               "line %ld%s: DOCTYPE: entities and files of declarations are not read; write the values "
               "themselves",
               static_cast<long>(line), file.empty() ? "" : (" of " + clean(file)).c_str());
    return;
  }
}

// A declaration behind comments says nothing that is used: it is read as if it stood first.
void blank_late_declaration(std::string* bytes) {
  const size_t at = bytes->find("<?xml ");
  if (at == std::string::npos || at == 0) return;
  // An element of our own behind it is the first one only if comments alone are before.
  if (first_element(bytes->substr(0, at) + "<x/>") == "x") {
    const size_t end = bytes->find("?>", at);
    if (end == std::string::npos) return;
    for (size_t k = at; k < end + 2; ++k)
      if ((*bytes)[k] != '\n') (*bytes)[k] = ' ';  // lines keep their numbers
  }
}

int line_at(const std::string& bytes, size_t at) {
  return 1 + static_cast<int>(std::count(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(at), '\n'));
}

// What a text would cost the parser, counted as the parser reads it before the parser has it: one pass over the
// bytes.
class Scan {
 public:
  Scan(const std::string& bytes, const std::string& of) : bytes_(bytes), of_(of) {
    while (at_ < bytes_.size()) markup();
  }
  size_t nodes = 0, attributes = 0;
  size_t behind = std::string::npos;  // where the first markup stands that is behind the root element

 private:
  bool skip(const char* begin, const char* end) {
    if (bytes_.compare(at_, std::strlen(begin), begin) != 0) return false;
    const size_t found = bytes_.find(end, at_ + std::strlen(begin));
    at_ = found == std::string::npos ? bytes_.size() : found + std::strlen(end);
    return true;
  }
  void markup() {
    const size_t text = bytes_.find_first_not_of(" \t\r\n", at_);
    at_ = std::min(bytes_.find('<', at_), bytes_.size());
    if (text < at_) ++nodes;  // of text that is not white space
    if (at_ == bytes_.size()) return;
    const size_t begin = at_;
    if (skip("</", ">")) {
      end(begin);
      return;
    }
    ++nodes;
    if (skip("<?", "?>") || skip("<!--", "-->") || skip("<![CDATA[", "]]>") || skip("<!", ">")) return;
    element();
    if (ended_) behind = std::min(behind, begin);
    ++depth_;
    if (bytes_[at_ - 1] == '>' && bytes_[at_ - 2] == '/') end(begin);
  }
  void end(size_t begin) {
    if (ended_) behind = std::min(behind, begin);
    ended_ |= --depth_ <= 0;  // below 0 where an end has no beginning, which the parser refuses
  }
  void element() {
    const size_t begin = at_;
    size_t own = 0;
    char quote = 0;
    for (++at_; at_ < bytes_.size(); ++at_) {
      const char c = bytes_[at_];
      if (quote)  // a '>' within a value ends no element
        quote = c == quote ? 0 : quote;
      else if (c == '"' || c == '\'')
        quote = c;
      else if (c == '=')
        ++own;
      else if (c == '>')
        break;
    }
    at_ = std::min(at_ + 1, bytes_.size());
    if (own > kMostAttributes)
      refuse(RDM_ERROR_RANGE, "line %d%s: an element has more than %zu attributes", line_at(bytes_, begin),
             of_.c_str(), kMostAttributes);
    attributes += own;
  }

  const std::string& bytes_;
  const std::string& of_;
  size_t at_ = 0;
  int64_t depth_ = 0;
  bool ended_ = false;  // the root element
};

struct Parser {
  const Options& options;
  bool includes;
  Draft* out;

  std::unique_ptr<Element> copy(const tinyxml2::XMLElement& x, const std::string& file, int depth) {
    auto e = std::make_unique<Element>();
    e->tag = x.Name();
    e->file = file;
    e->line = x.GetLineNum();
    for (const auto* a = x.FirstAttribute(); a; a = a->Next())
      e->attributes.push_back({a->Name(), a->Value(), false});
    // its elements would be dropped as unknown ones, and with them half of the robot
    if (e->tag.rfind("xacro:", 0) == 0)
      refuse_at(RDM_ERROR_UNSUPPORTED, *e, "xacro is not read; expand the file with the xacro tool first");
    for (const auto* c = x.FirstChildElement(); c; c = c->NextSiblingElement()) {
      if (includes && std::strcmp(c->Name(), "include") == 0)
        include(*c, file, depth, e.get());
      else
        e->children.push_back(copy(*c, file, depth));
    }
    return e;
  }

  void include(const tinyxml2::XMLElement& x, const std::string& file, int depth, Element* into) {
    const char* name = x.Attribute("file");
    const std::string at =
        format("line %d%s%s: include", x.GetLineNum(), file.empty() ? "" : " of ", file.c_str());
    if (!name || !*name) refuse(RDM_ERROR_FORMAT, "%s: it has no attribute file", at.c_str());
    if (!options.has_folder)
      refuse(RDM_ERROR_NOT_FOUND, "%s: %s: a text that is not from a file has no folder to search",
             at.c_str(), clean(name).c_str());
    if (depth >= kMostIncludes)
      refuse(RDM_ERROR_RANGE, "%s: files are included more than %d deep", at.c_str(), kMostIncludes);
    std::string bytes;
    try {
      out->budget.spend(Cost::kFiles, 1);
      bytes = read_file(name[0] == '/' ? std::string(name) : options.folder + name,
                        out->budget.left(Cost::kTextBytes));
    } catch (const Refusal& r) {
      refuse(r.code, "%s: %s", at.c_str(), r.text.c_str());
    }
    // MJCF: children of the included root stand where the include stood
    auto root = parse(bytes, clean(name), depth + 1);
    for (auto& child : root->children) into->children.push_back(std::move(child));
  }

  std::unique_ptr<Element> parse(std::string bytes, const std::string& file, int depth) {
    const std::string of = file.empty() ? "" : " of " + file;
    out->budget.spend(Cost::kTextBytes, bytes.size());
    blank_late_declaration(&bytes);
    refuse_doctype(bytes, file);
    const Scan scan(bytes, of);  // counted before the parser takes memory for them
    out->budget.spend(Cost::kNodes, scan.nodes);
    out->budget.spend(Cost::kAttributes, scan.attributes);
    tinyxml2::XMLDocument document;
    const auto result = document.Parse(bytes.data(), bytes.size());
    if (result != tinyxml2::XML_SUCCESS)
      refuse(RDM_ERROR_FORMAT, "line %d%s: this is not XML: %s", document.ErrorLineNum(), of.c_str(),
             reason_of(result));
    const auto* root = document.RootElement();
    if (!root) refuse(RDM_ERROR_FORMAT, "line 1%s: there is no element", of.c_str());
    if (scan.behind != std::string::npos)
      out->note(RDM_NOTE_DROPPED, line_at(bytes, scan.behind), "text after the end of <%s>%s%s%s",
                clean(root->Name()).c_str(), file.empty() ? "" : " (in ", file.c_str(),
                file.empty() ? "" : ")");
    return copy(*root, file, depth);
  }
};

// What nobody has asked for: an element as a whole, else its attributes.
void list(const Element& e, bool root, Draft* out) {
  if (out->notes.size() > kMostNotes) return;  // a file may have a million
  const auto in = e.file.empty() ? std::string() : " (in " + e.file + ")";
  if (!root && !e.seen) {
    const Attribute* name = e.find("name");
    if (!name) name = e.find("joint");
    if (!name) name = e.find("class");
    out->note(RDM_NOTE_DROPPED, e.line, "%s%s%s%s", clean(e.tag).c_str(), name ? " " : "",
              name ? clean(name->value).c_str() : "", in.c_str());
    return;
  }
  std::string unread;
  for (const Attribute& a : e.attributes)
    if (!a.read && a.name != "name" && a.name.rfind("xmlns", 0) != 0)
      unread += (unread.empty() ? "" : ", ") + clean(a.name) + "=\"" + clean(a.value, 40) + '"';
  const Attribute* name = e.find("name");
  if (!unread.empty())
    out->note(RDM_NOTE_DROPPED, e.line, "%s%s%s: %s%s", clean(e.tag).c_str(), name ? " " : "",
              name ? clean(name->value).c_str() : "", unread.c_str(), in.c_str());
  for (const auto& child : e.children) list(*child, false, out);
}

}  // namespace

const Attribute* Element::find(const char* name) const {
  for (const Attribute& a : attributes)
    if (a.name == name) return &a;
  return nullptr;
}

const std::string* Element::get(const char* name) const {
  const Attribute* a = find(name);
  if (!a) return nullptr;
  a->read = true;
  return &a->value;
}

std::vector<const Element*> Element::all(const char* name) const {
  std::vector<const Element*> out;
  for (const auto& c : children)
    if (c->tag == name) c->seen = true, out.push_back(c.get());
  return out;
}

const Element* Element::child(const char* name) const {
  for (const auto& c : children)
    if (c->tag == name) {
      c->seen = true;
      return c.get();
    }
  return nullptr;
}

std::unique_ptr<Element> parse_xml(const std::string& bytes, const Options& options, bool includes,
                                   Draft* out) {
  Parser parser{options, includes, out};
  return parser.parse(bytes, "", 0);
}

std::string first_element(const std::string& bytes) {
  size_t at = 0;
  const auto skip = [&](const char* begin, const char* end) {
    if (bytes.compare(at, std::strlen(begin), begin) != 0) return false;
    const size_t found = bytes.find(end, at + std::strlen(begin));
    at = found == std::string::npos ? bytes.size() : found + std::strlen(end);
    return true;
  };
  if (bytes.compare(0, 3, "\xef\xbb\xbf") == 0) at = 3;
  for (;;) {
    at = bytes.find_first_not_of(" \t\r\n", at);
    if (at == std::string::npos || bytes[at] != '<') return "";
    if (skip("<?", "?>") || skip("<!--", "-->")) continue;
    // a subset in brackets has '>' of its own
    const size_t subset = bytes.find_first_of("[>", at);  // of a DOCTYPE
    if (skip("<!", subset != std::string::npos && bytes[subset] == '[' ? "]>" : ">")) continue;
    const size_t end = bytes.find_first_of(" \t\r\n/>", at + 1);
    return bytes.substr(at + 1, end == std::string::npos ? end : end - at - 1);
  }
}

std::string where(const Element& e) {
  std::string out = format("line %d", e.line);
  if (!e.file.empty()) out += " of " + e.file;
  out += ": " + clean(e.tag);
  if (const Attribute* name = e.find("name")) out += ' ' + clean(name->value);
  return out;
}

void refuse_at(rdm_result code, const Element& e, const char* pattern, ...) {
  char text[512];
  va_list list;
  va_start(list, pattern);
  print_list(text, sizeof text, pattern, list);
  va_end(list);
  refuse(code, "%s: %s", where(e).c_str(), text);
}

namespace {

bool is_space(char x) {
  return x == ' ' || x == '\t' || x == '\n' || x == '\r' || x == ',';
}
// The next number of a text, which may be infinite; NaN: there is none.
double next_number(const char** at, const char* end) {
  const char* c = *at;
  if (*c == '+' && c + 1 != end && c[1] != '-') ++c;  // from_chars takes no '+', XML's numbers may have one
  double value = 0;
  const auto [after, error] = from_chars(c, end, value);
  if (after != end && !is_space(*after)) return NAN;
  if (error == std::errc::result_out_of_range) {
    // too small is 0, as other readers have it; too large is infinite, and the caller says of what
    const std::string text(c, after);
    const bool small = text.find("e-") != std::string::npos || text.find("E-") != std::string::npos;
    value = small ? 0 : *c == '-' ? -INFINITY : INFINITY;
  } else if (error != std::errc()) {
    return NAN;
  }
  *at = after;
  return value;
}

}  // namespace

void refuse_xacro(const Element& e, const char* attribute, const std::string& text) {
  if (text.find("${") != std::string::npos || text.find("$(") != std::string::npos)
    refuse_at(RDM_ERROR_UNSUPPORTED, e,
              "%s: %s: xacro is not read; expand the file with the xacro tool first", attribute,
              clean(text).c_str());
}

std::vector<double> numbers(const Element& e, const char* attribute, const std::string& text, size_t least,
                            size_t most, double largest) {
  std::vector<double> out;
  if (text.size() > kMostText + kEach * most)
    refuse_at(RDM_ERROR_RANGE, e, "%s: a text of %zu bytes is too long for %zu number%s", attribute,
              text.size(), most, most == 1 ? "" : "s");
  const char *c = text.data(), *end = c + text.size();
  while (true) {
    while (c != end && is_space(*c)) ++c;
    if (c == end) break;
    const double value = next_number(&c, end);
    if (std::isnan(value)) {
      refuse_xacro(e, attribute, text);
      refuse_at(RDM_ERROR_FORMAT, e, "%s: %s is not a number", attribute, clean(text).c_str());
    }
    if (!(std::abs(value) <= largest)) {
      const int power = static_cast<int>(std::lround(std::log10(largest)));
      refuse_at(RDM_ERROR_RANGE, e, "%s: %s is outside [-1e%d, 1e%d]", attribute, clean(text).c_str(), power,
                power);
    }
    out.push_back(value);
    if (out.size() > most) break;  // one too many is enough to refuse
  }
  if (out.size() < least || out.size() > most) {
    const std::string range = least == most ? format("%zu", least) : format("%zu to %zu", least, most);
    refuse_at(RDM_ERROR_FORMAT, e, "%s: %s is not %s number%s", attribute, clean(text).c_str(), range.c_str(),
              most == 1 ? "" : "s");
  }
  return out;
}

double bound(const Element& e, const char* attribute, const std::string& text) {
  const char *c = text.data(), *end = c + text.size();
  while (c != end && is_space(*c)) ++c;
  const double value = c == end ? NAN : next_number(&c, end);
  while (c != end && is_space(*c)) ++c;
  if (std::isnan(value) || c != end) return number(e, attribute, text);  // which says why
  return std::abs(value) <= kLargest ? value : std::copysign(INFINITY, value);
}

double number(const Element& e, const char* attribute, const std::string& text) {
  return numbers(e, attribute, text, 1, 1)[0];
}

V3 vector3(const Element& e, const char* attribute, const std::string& text) {
  const auto n = numbers(e, attribute, text, 3, 3);
  return {n[0], n[1], n[2]};
}

void list_dropped(const Element& root, Draft* out) {
  list(root, true, out);
}

}  // namespace rdm::import
