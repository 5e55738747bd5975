// Maps as files: the headers and both bodies that OctoMap's programs know, written and read without them,
// since they print while writing and trust what they read.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/chars.hpp"
#include "base/error.hpp"
#include "sense/map/occupancy_tree.hpp"

namespace rdm {
namespace {

constexpr const char* kBinaryLine = "# Octomap OcTree binary file";
constexpr const char* kFullLine = "# Octomap OcTree file";
constexpr const char* kWhat = "map file";

[[noreturn]] void bad(const char* why) {
  fail(Code::kFormat, "%s: %s", kWhat, why);
}

void put(Vector<unsigned char>& out, const void* bytes, size_t count) {
  const auto* p = static_cast<const unsigned char*>(bytes);
  out.insert(out.end(), p, p + count);
}
void put(Vector<unsigned char>& out, const char* text) {
  put(out, text, std::strlen(text));
}

// Full body: a node's log-odds, which children there are, then these.
void put_full(const MapTree& tree, const MapNode* node, Vector<unsigned char>& out) {
  const float value = node->getLogOdds();
  unsigned char children = 0;
  for (unsigned i = 0; i < 8; ++i)
    if (tree.child(node, i)) children = static_cast<unsigned char>(children | 1u << i);
  put(out, &value, sizeof value);
  put(out, &children, 1);
  for (unsigned i = 0; i < 8; ++i)
    if (const MapNode* next = tree.child(node, i)) put_full(tree, next, out);
}

// Binary body: two bits for each child of a node (1 free, 2 occupied, 3 has children), then those that have.
enum : unsigned { kUnknown = 0, kFree = 1, kOccupied = 2, kInner = 3 };
void put_binary(const MapTree& tree, const MapNode* node, float threshold, Vector<unsigned char>& out) {
  unsigned bits = 0;
  for (unsigned i = 0; i < 8; ++i)
    if (const MapNode* next = tree.child(node, i)) {
      const unsigned state = tree.nodeHasChildren(next)        ? kInner
                             : next->getLogOdds() >= threshold ? kOccupied
                                                               : kFree;
      bits |= state << 2 * i;
    }
  const unsigned char bytes[2] = {static_cast<unsigned char>(bits & 255),
                                  static_cast<unsigned char>(bits >> 8)};
  put(out, bytes, 2);
  for (unsigned i = 0; i < 8; ++i)
    if ((bits >> 2 * i & 3) == kInner) put_binary(tree, tree.child(node, i), threshold, out);
}

class Source {
 public:
  Source(const void* bytes, size_t size) : at_(static_cast<const char*>(bytes)), end_(at_ + size) {}
  // The next line without its end; false at the end of the file.
  bool line(const char** begin, const char** end) {
    if (at_ == end_) return false;
    *begin = at_;
    *end = std::find(at_, end_, '\n');
    at_ = *end == end_ ? end_ : *end + 1;
    if (*end > *begin && (*end)[-1] == '\r') --*end;
    return true;
  }
  template <class T>
  T value() {
    if (static_cast<size_t>(end_ - at_) < sizeof(T)) bad("it ends in the middle of the tree");
    T v;
    std::memcpy(&v, at_, sizeof v);
    at_ += sizeof v;
    return v;
  }
  bool ended() const { return at_ == end_; }

 private:
  const char *at_, *end_;
};

struct Header {
  bool binary = false;
  uint64_t nodes = 0;
  double resolution = 0;
};

bool starts(const char* begin, const char* end, const char* word) {
  const size_t n = std::strlen(word);
  return static_cast<size_t>(end - begin) >= n && std::memcmp(begin, word, n) == 0;
}

template <class T>
T number(const char* begin, const char* end, const char* why) {
  while (begin < end && *begin == ' ') ++begin;
  while (end > begin && end[-1] == ' ') --end;
  T v{};
  const auto [stop, error] = from_chars(begin, end, v);
  if (error != std::errc() || stop != end) bad(why);
  return v;
}

Header read_header(Source& in) {
  Header h;
  const char *begin = nullptr, *end = nullptr;
  if (!in.line(&begin, &end)) bad("it is empty");
  h.binary = starts(begin, end, kBinaryLine);
  if (!h.binary && !starts(begin, end, kFullLine)) bad("it does not begin with '# Octomap OcTree'");
  bool id = false, size = false;
  while (in.line(&begin, &end)) {
    if (starts(begin, end, "#")) continue;
    if (starts(begin, end, "data")) {
      if (!id || !size || h.resolution == 0) bad("id, size or res is missing");
      return h;
    }
    if (starts(begin, end, "id ")) {
      if (end - begin != 9 || !starts(begin, end, "id OcTree"))
        bad("it holds another kind of tree than OcTree");
      id = true;
    } else if (starts(begin, end, "size ")) {
      h.nodes = number<uint64_t>(begin + 5, end, "size is not a number");
      size = true;
    } else if (starts(begin, end, "res ")) {
      h.resolution = number<double>(begin + 4, end, "res is not a number");
      if (!(h.resolution >= 0.001 && h.resolution <= 10)) bad("res is out of range");
    }
  }
  bad("it has no data");
}

// Builds a tree from a file's body; its depth and its memory are bounded whatever the file says.
class Builder {
 public:
  Builder(Source& in, MapTree& tree, size_t bytes_max, float low, float high)
      : in_(in), tree_(tree), bytes_max_(bytes_max), low_(low), high_(high) {}

  void full(MapNode* node, int depth) {
    const auto value = in_.value<float>();
    if (!std::isfinite(value)) bad("a value is not finite");
    node->setLogOdds(value);
    const auto children = in_.value<unsigned char>();
    if (children && depth == kMapDepth) bad("the tree is too deep");
    for (unsigned i = 0; i < 8; ++i)
      if (children >> i & 1) full(make(node, i), depth + 1);
    if (children) node->setLogOdds(node->getMaxChildLogOdds());
  }
  void binary(MapNode* node, int depth) {
    const unsigned low = in_.value<unsigned char>(), bits = low | unsigned{in_.value<unsigned char>()} << 8;
    if (depth == kMapDepth) bad("the tree is too deep");
    for (unsigned i = 0; i < 8; ++i) {
      const unsigned state = bits >> 2 * i & 3;
      if (state != kUnknown) make(node, i)->setLogOdds(state == kOccupied ? high_ : low_);
    }
    for (unsigned i = 0; i < 8; ++i)
      if ((bits >> 2 * i & 3) == kInner) binary(tree_.child(node, i), depth + 1);
    if (bits) node->setLogOdds(node->getMaxChildLogOdds());
  }

 private:
  MapNode* make(MapNode* node, unsigned i) {
    if (tree_.bytes() + kNodeBytes + kListBytes > bytes_max_)
      fail(Code::kMemory, "%s: the map does not fit into %zu bytes", kWhat, bytes_max_);
    return tree_.make_child(node, i);
  }
  Source& in_;
  MapTree& tree_;
  size_t bytes_max_;
  float low_, high_;
};

}  // namespace

void Occupancy::write(MapFormat format, Vector<unsigned char>& out) const {
  const bool binary = format == MapFormat::kBinary;
  char number[40];
  out.clear();
  put(out, binary ? kBinaryLine : kFullLine);
  put(out,
      "\n# (feel free to add / change comments, but leave the first line as it is!)\n#\nid OcTree\nsize ");
  put(out, number, static_cast<size_t>(to_chars(number, number + sizeof number, tree_->size()).ptr - number));
  put(out, "\nres ");
  put(out, number,
      static_cast<size_t>(to_chars(number, number + sizeof number, tree_->getResolution()).ptr - number));
  put(out, "\ndata\n");
  const MapNode* root = tree_->getRoot();
  if (root && binary)
    put_binary(*tree_, root, threshold_log_, out);
  else if (root)
    put_full(*tree_, root, out);
}

FileLimits Occupancy::file_limits() const {
  // a node takes five bytes of a full file and up to two of a binary one; the header may hold comments
  constexpr size_t kHeader = 1u << 16;
  return {"# Octomap OcTree", 0, bytes_max_ / kNodeBytes * 5 + kHeader, Code::kMemory};
}

void Occupancy::read(const void* bytes, size_t size) {
  Source in(bytes, size);
  const Header header = read_header(in);
  MapTree* tree = new MapTree(header.resolution);
  try {
    Builder build(in, *tree, bytes_max_, low_, high_);
    if (header.nodes > 0 && header.binary)
      build.binary(tree->make_root(), 0);
    else if (header.nodes > 0)
      build.full(tree->make_root(), 0);
    if (!in.ended()) bad("it has extra bytes at the end");
    if (tree->size() != header.nodes) bad("its number of nodes differs from its header");
  } catch (...) {
    delete tree;
    throw;
  }
  delete tree_;
  tree_ = tree;
  dropped_ = 0;
}

}  // namespace rdm
