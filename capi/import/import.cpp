#include "import.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/names.hpp"
#include "base/text.hpp"

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
  std::string in = text.substr(0, most), out(most + 1, '\0');
  std::replace(in.begin(), in.end(), '\0', ' ');  // which would end the text
  const bool whole = clean_text(out.data(), out.size(), in.c_str()) && in.size() == text.size();
  out.resize(std::strlen(out.c_str()));
  return whole ? out : out + "...";
}

bool same_name(const std::string& a, const std::string& b) {
  return rdm::same_name(a.c_str(), b.c_str());
}

std::string nearest_hint(const std::string& word, const std::vector<std::string>& names) {
  std::vector<const char*> all;
  all.reserve(names.size());
  for (const std::string& name : names) all.push_back(name.c_str());
  return clean(Nearest(word.c_str(), all.data(), static_cast<int32_t>(all.size())).text,
               sizeof(Nearest::text));
}

void Budget::spend(Cost cost, size_t count) {
  size_t& spent = spent_[static_cast<size_t>(cost)];
  const CostLimit& limit = kCostLimits[static_cast<size_t>(cost)];
  if (count > limit.most - spent)
    refuse(RDM_ERROR_RANGE, "there are more than %zu %s in one import", limit.most, limit.what);
  spent += count;
}

bool file_exists(const std::string& path) {
  struct stat s;
  return ::stat(path.c_str(), &s) == 0 && S_ISREG(s.st_mode);
}

std::string folder_of(const std::string& path) {
  const size_t slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash + 1);
}

std::string read_file(const std::string& path, size_t longest) {
  try {
    const auto bytes = rdm::read_file(path.c_str(), {"", 0, longest, Code::kRange});
    std::string out(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (out.compare(0, std::strlen(kPointer), kPointer) == 0)
      refuse(RDM_ERROR_FORMAT, "%s: this is a pointer of Git LFS, not the file itself; run git lfs pull",
             clean(path, 160).c_str());
    return out;
  } catch (const Error& e) {
    throw Refusal{static_cast<rdm_result>(e.code), e.text};
  }
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
    notes.push_back({kind, 0, "there are more notes than are listed here"});
    return;
  }
  if (notes.size() > kMostNotes) return;
  va_list list;
  va_start(list, pattern);
  notes.push_back({kind, line, clean(vformat(pattern, list), 400)});
  va_end(list);
}

void read_built(int32_t robot, Draft* d) {
  if (const rdm_result r = rdm_robot_get_def(robot, &d->def)) refuse(r, "%s", rdm_last_error());
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
  if (const rdm_result r = rdm_robot_get_postures(robot, d->commands.data(), d->home.data(), d->folded.data(),
                                                  d->closed.data()))
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
