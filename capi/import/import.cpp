#include "import.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

#include "base/format.hpp"
#include "base/names.hpp"

namespace rdm::import {
namespace {

std::string vformat(const char* pattern, va_list list) {
  va_list again;
  va_copy(again, list);
  const int size = print_list(nullptr, 0, pattern, list);
  std::string out(static_cast<size_t>(std::max(size, 0)) + 1, '\0');
  print_list(out.data(), out.size(), pattern, again);
  va_end(again);
  out.pop_back();
  return out;
}

constexpr const char* kPointer = "version https://git-lfs.github.com/spec/";  // such a file begins so

// Bytes of the character at `c`, 0: none of UTF-8, or a control character.
size_t character(const unsigned char* c, size_t left) {
  if (c[0] < 0x80) return c[0] >= 0x20 && c[0] != 0x7f ? 1 : 0;
  const size_t n = c[0] >= 0xf0 ? 4 : c[0] >= 0xe0 ? 3 : 2;
  if (c[0] < 0xc2 || c[0] > 0xf4 || n > left) return 0;
  for (size_t k = 1; k < n; ++k)
    if ((c[k] & 0xc0) != 0x80) return 0;
  if ((c[0] == 0xe0 && c[1] < 0xa0) || (c[0] == 0xed && c[1] > 0x9f) || (c[0] == 0xf0 && c[1] < 0x90) ||
      (c[0] == 0xf4 && c[1] > 0x8f) || (c[0] == 0xc2 && c[1] < 0xa0))
    return 0;
  return n;
}

template <class T, class F>
void get_rows(int32_t robot, int32_t count, std::vector<T>* rows, F&& at) {
  rows->resize(static_cast<size_t>(count));
  for (int32_t i = 0; i < count; ++i)
    if (const rdm_result r = at(robot, i, rows->data() + i)) refuse(r, "%s", rdm_last_error());
}

}  // namespace

std::string format(const char* pattern, ...) {
  va_list list;
  va_start(list, pattern);
  std::string out = vformat(pattern, list);
  va_end(list);
  return out;
}

void refuse(rdm_result code, const char* pattern, ...) {
  va_list list;
  va_start(list, pattern);
  std::string text = vformat(pattern, list);
  va_end(list);
  throw Refusal{code, std::move(text)};
}

std::string clean(const std::string& text, size_t most) {
  std::string out;
  for (size_t at = 0; at < text.size();) {
    const auto* c = reinterpret_cast<const unsigned char*>(text.data()) + at;
    const size_t n = character(c, text.size() - at);
    std::string next = text.substr(at, std::max<size_t>(n, 1));
    if (n == 0) next = *c < 0x20 || *c == 0x7f ? std::string(" ") : format("\\x%02x", *c);
    if (out.size() + next.size() > most) return out + "...";
    out += next;
    at += std::max<size_t>(n, 1);
  }
  return out;
}

bool same_name(const std::string& a, const std::string& b) {
  return rdm::same_name(a.c_str(), b.c_str());
}

std::string nearest_hint(const std::string& word, const std::vector<std::string>& names) {
  std::vector<const char*> all;
  for (const std::string& name : names) all.push_back(name.c_str());
  return clean(Nearest(word.c_str(), all.data(), static_cast<int32_t>(all.size())).text,
               sizeof(Nearest::text));
}

bool file_exists(const std::string& path) {
  struct stat s;
  return ::stat(path.c_str(), &s) == 0 && S_ISREG(s.st_mode);
}

std::string folder_of(const std::string& path) {
  const size_t slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash + 1);
}

std::string read_file(const std::string& path) {
  const std::string name = clean(path, 160);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"), std::fclose);
  if (!file)
    refuse(errno == ENOENT ? RDM_NOT_FOUND : RDM_IO, "%s: cannot be opened: %s", name.c_str(),
           std::strerror(errno));
  struct stat s;
  if (::fstat(::fileno(file.get()), &s) != 0 || !S_ISREG(s.st_mode))
    refuse(RDM_IO, "%s: no regular file", name.c_str());
  std::string out;
  char part[1 << 16];
  while (const size_t n = std::fread(part, 1, sizeof part, file.get())) {
    if (out.size() + n > kMostBytes) refuse(RDM_RANGE, "%s: more than %zu bytes", name.c_str(), kMostBytes);
    out.append(part, n);
  }
  if (std::ferror(file.get())) refuse(RDM_IO, "%s: cannot be read", name.c_str());
  if (out.compare(0, std::strlen(kPointer), kPointer) == 0)
    refuse(RDM_FORMAT, "%s: a pointer of Git LFS, not the file itself: git lfs pull brings it", name.c_str());
  return out;
}

Draft::Draft() {
  rdm_robot_def_init(&def, sizeof def);
}

const char* Draft::keep(std::string text) {
  texts.push_back(std::move(text));
  return texts.back().c_str();
}

void Draft::bind() {
  const auto give = [](const auto& rows, auto* array, int32_t* count) {
    *array = rows.empty() ? nullptr : rows.data();
    if (count) *count = static_cast<int32_t>(rows.size());
  };
  give(links, &def.links, &def.num_links);
  give(shapes, &def.shapes, &def.num_shapes);
  give(pairs, &def.pairs, &def.num_pairs);
  if (all_pairs) def.pairs = nullptr, def.num_pairs = -1;
  give(couplings, &def.couplings, &def.num_couplings);
  give(curves, &def.curves, &def.num_curves);
  give(commands, &def.commands, &def.num_commands);
  if (passive) def.commands = nullptr, def.num_commands = -1;
  give(fingers, &def.fingers, &def.num_fingers);
  give(home, &def.home, nullptr);
  give(folded, &def.folded, nullptr);
  give(closed, &def.closed, nullptr);
}

void Draft::note(int32_t kind, int32_t line, const char* pattern, ...) {
  if (notes.size() == kMostNotes) {
    notes.push_back({kind, 0, "more was found than is listed here"});
    return;
  }
  if (notes.size() > kMostNotes) return;
  va_list list;
  va_start(list, pattern);
  notes.push_back({kind, line, clean(vformat(pattern, list), 400)});
  va_end(list);
}

void read_built(int32_t robot, Draft* d) {
  if (const rdm_result r = rdm_robot_get(robot, &d->def)) refuse(r, "%s", rdm_last_error());
  rdm_robot_def& def = d->def;
  get_rows(robot, def.num_links, &d->links, rdm_robot_link_at);
  get_rows(robot, def.num_shapes, &d->shapes, rdm_robot_shape_at);
  get_rows(robot, def.num_pairs, &d->pairs, rdm_robot_pair_at);
  get_rows(robot, def.num_couplings, &d->couplings, rdm_robot_coupling_at);
  get_rows(robot, def.num_curves, &d->curves, rdm_robot_curve_at);
  get_rows(robot, def.num_fingers, &d->fingers, rdm_robot_finger_at);
  d->passive = def.num_commands < 0;
  d->commands.resize(static_cast<size_t>(std::max(def.num_commands, 0)));
  d->closed.resize(d->commands.size());
  d->home.resize(d->links.size());
  d->folded.resize(d->links.size());
  if (const rdm_result r =
          rdm_robot_poses_of(robot, d->commands.data(), d->home.data(), d->folded.data(), d->closed.data()))
    refuse(r, "%s", rdm_last_error());
  // 0 where it has none
  const auto none = [](const auto& v) {
    return std::all_of(v.begin(), v.end(), [](auto x) { return x == 0; });
  };
  if (none(d->folded) && none(d->closed)) d->folded.clear(), d->closed.clear();
  // Texts belong to the robot, which may go before the handle does.
  const auto keep = [&](const char*& text) {
    if (text) text = d->keep(text);
  };
  keep(def.name), keep(def.alias), keep(def.summary);
  for (rdm_robot_link& l : d->links) keep(l.name), keep(l.joint);
  for (rdm_robot_shape& s : d->shapes) keep(s.name);
  for (rdm_robot_finger& f : d->fingers) keep(f.name);
  d->bind();
}

}  // namespace rdm::import
