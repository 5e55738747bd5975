#include "algos/core/groups.hpp"

#include <cstdio>
#include <cstring>

#include "base/chars.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

// The part of `text` up to one of the stops, blanks about it cut off; `text` goes on behind the stop.
Vector<char> take(const char*& text, const char* stops) {
  const char *from = text, *to = text + std::strcspn(text, stops);
  text = *to ? to + 1 : to;
  while (from < to && *from == ' ') ++from;
  while (from < to && to[-1] == ' ') --to;
  Vector<char> out(from, to);
  out.push_back('\0');
  return out;
}

// "3-7" or "3" into the first entry and how many.
void read_entries(const char* name, const char* text, int32_t action_dim, GroupSpec& g) {
  int32_t first = 0, last = 0;
  const char* const end = text + std::strlen(text);
  auto [at, error] = from_chars(text, end, first);
  last = first;
  if (error == std::errc() && at < end && *at == '-') {
    const auto [stop, wrong] = from_chars(at + 1, end, last);
    at = stop, error = wrong;
  }
  if (error != std::errc() || at != end)
    fail(Code::kArgument,
         "groups: '%s' of group %s is not a first and a last entry of the action, such as 0-19",
         Quoted(text).text, Quoted(name).text);
  if (first < 0 || last < first || last >= action_dim)
    fail(Code::kRange, "groups: entries %d to %d of group %s are not within the %d of the action", first,
         last, Quoted(name).text, action_dim);
  g.first = first, g.count = last - first + 1;
}

// The text of a set among the defaults; null: there is none.
const char* find_set(const AgentConfig& c, const char* name) {
  for (int32_t i = 0; i < c.num_defaults; ++i)
    if (c.defaults[i].text && is_group_set(c.defaults[i].key) &&
        (!name || same_name(c.defaults[i].key + std::strlen(kGroupSet), name)))
      return c.defaults[i].text;
  return nullptr;
}

[[noreturn]] void fail_unknown(const AgentConfig& c, const char* name) {
  Vector<const char*> names;
  for (int32_t i = 0; i < c.num_defaults; ++i)
    if (is_group_set(c.defaults[i].key)) names.push_back(c.defaults[i].key + std::strlen(kGroupSet));
  names.push_back("all");
  fail(Code::kNotFound, "groups: the task has no set '%s'%s; a list is NAME:FIELDS:FIRST-LAST;...",
       Quoted(name).text, Nearest(name, names.data(), static_cast<int32_t>(names.size())).text);
}

}  // namespace

bool is_group_set(const char* key) {
  return key && std::strncmp(key, kGroupSet, sizeof kGroupSet - 1) == 0;
}

Vector<GroupSpec> parse_groups(const AgentConfig& c, const char* text) {
  Vector<GroupSpec> out;
  if (same_name(text, "all")) return out;
  if (same_name(text, "auto")) {
    text = find_set(c, nullptr);
    if (!text) return out;
  } else if (!std::strchr(text, ':')) {
    const char* const set = find_set(c, text);
    if (!set) fail_unknown(c, text);
    text = set;
  }
  while (*text) {
    if (out.size() == static_cast<size_t>(kMaxGroups))
      fail(Code::kRange, "groups: there are more than %d", kMaxGroups);
    const char* group = text;
    const Vector<char> whole = take(text, ";");
    group = whole.data();
    const Vector<char> name = take(group, ":"), fields = take(group, ":"), entries = take(group, ":");
    if (name.size() < 2 || name.size() > static_cast<size_t>(kGroupNameSize) || fields.size() < 2 || *group)
      fail(Code::kArgument, "groups: '%s' is not NAME:FIELDS:FIRST-LAST", Quoted(whole.data()).text);
    for (const GroupSpec& g : out)
      if (same_name(g.name, name.data()))
        fail(Code::kArgument, "groups: %s occurs twice", Quoted(name.data()).text);
    GroupSpec& g = out.emplace_back();
    std::memcpy(g.name, name.data(), name.size());
    g.columns = select_columns("groups", fields.data(), c.fields, c.num_fields, c.obs_dim);
    read_entries(g.name, entries.data(), c.action_dim, g);
    const int32_t end = out.size() < 2 ? 0 : out[out.size() - 2].first + out[out.size() - 2].count;
    if (g.first != end)
      fail(Code::kArgument, "groups: %s begins with entry %d of the action, where entry %d comes next",
           Quoted(g.name).text, g.first, end);
  }
  if (out.empty()) fail(Code::kArgument, "groups: the list is empty; all is one group");
  if (const GroupSpec& last = out.back(); last.first + last.count != c.action_dim)
    fail(Code::kArgument, "groups: entry %d of the action, and those behind it, belong to no group",
         last.first + last.count);
  return out;
}

}  // namespace rdm
