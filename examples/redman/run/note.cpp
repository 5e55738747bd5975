#include "run/note.hpp"

#include <algorithm>
#include <cfloat>
#include <cstring>

#include "common/json.hpp"
#include "common/report.hpp"

namespace tool {
namespace {

constexpr double kMostSeconds = 1e12;

// JSON has no infinite numbers: they are written as null, and read as what is worse than any.
double finite_or(const Document& value, const char* what, double otherwise) {
  return value.is_null() ? otherwise : number_of(value, what, -DBL_MAX, DBL_MAX);
}

}  // namespace

std::string note_bytes(const Note& note) {
  Json json = {{"epoch", note.epoch},
               {"env_steps", note.env_steps},
               {"progress_bytes", note.progress_bytes},
               {"seconds", note.seconds}};
  if (note.last) json["last"] = {note.last->ret, note.last->cost};
  if (note.best) json["best"] = {note.best->feasible, note.best->ret, note.best->excess};
  if (!note.shield.empty()) json["shield_bytes"] = note.shield.size();
  std::string bytes = json_text(json) + '\n';
  bytes.append(note.shield.begin(), note.shield.end());
  bytes.append(note.best_policy.begin(), note.best_policy.end());
  return bytes;
}

Note parse_note(const char* bytes, size_t size) {
  const void* line = size ? std::memchr(bytes, '\n', size) : nullptr;
  const size_t end = line ? static_cast<size_t>(static_cast<const char*>(line) - bytes) : size;
  const Document json = parse_json(bytes, end);
  Note note;
  note.epoch = static_cast<int32_t>(integer_at(json, "epoch", 0, INT32_MAX));
  note.env_steps = integer_at(json, "env_steps", 0, kMostExact);
  note.progress_bytes = static_cast<size_t>(integer_at(json, "progress_bytes", 0, kMostExact));
  note.changed = json.contains("changed");
  // for curves alone: a clock that jumped is no reason to lose the run
  if (!json.contains("seconds")) throw Failure("seconds: missing");
  const double seconds = finite_or(json["seconds"], "seconds", -1);
  note.clock_lost = !(seconds >= 0 && seconds <= kMostSeconds);
  note.seconds = note.clock_lost ? 0 : seconds;
  if (json.contains("last")) {
    const Document& last = list_at(json, "last", 2);
    note.last = {finite_or(last[0], "last", -DBL_MAX), finite_or(last[1], "last", DBL_MAX)};
  }
  const char* rest = bytes + std::min(end + 1, size);
  const auto left = bytes + size - rest;
  if (json.contains("shield_bytes")) {
    const char* begin = rest;
    rest += integer_at(json, "shield_bytes", 1, left);
    note.shield.assign(begin, rest);
  }
  if (!json.contains("best")) return note;
  const Document& best = list_at(json, "best", 3);
  if (!best[0].is_boolean()) throw Failure("best: it does not begin with true or false");
  note.best = {best[0].get<bool>(), finite_or(best[1], "best", -DBL_MAX),
               finite_or(best[2], "best", DBL_MAX)};
  if (rest == bytes + size) throw Failure("best: it has no policy");
  note.best_policy.assign(rest, bytes + size);
  return note;
}

}  // namespace tool
