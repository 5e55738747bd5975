// A recording as an archive of numpy arrays, and back.
#include <algorithm>
#include <cstdio>
#include <cstring>

#include "base/error.hpp"
#include "base/text.hpp"
#include "record/npz.hpp"
#include "record/recording.hpp"

namespace rdm {
namespace {

constexpr const char* kWhat = "recording";
constexpr const char* kFormat = "redman recording 1";

NpyArray array_of(const char* type, const void* data, uint64_t rows, uint64_t width = 0) {
  NpyArray a;
  std::snprintf(a.type, sizeof a.type, "%s", type);
  a.dims = width ? 2 : 1;
  a.shape[0] = rows, a.shape[1] = width;
  a.data = static_cast<const unsigned char*>(data);
  return a;
}

NpyArray one_value(const char* type, const void* data) {
  NpyArray a = array_of(type, data, 1);
  a.dims = 0;
  return a;
}

void add_text(NpzWriter& out, const char* name, const char* text) {
  char type[12];
  std::snprintf(type, sizeof type, "|S%u",
                static_cast<unsigned>(std::clamp<size_t>(std::strlen(text), 1, 99)) & 127u);
  out.add(name, one_value(type, text));
}

// What a file has for a column; missing ones stay empty.
class Columns {
 public:
  explicit Columns(NpzReader& in) : in_(in) {}

  template <class T>
  const T* take(const char* name, const char* type, int32_t dims, uint64_t rows, uint64_t width,
                Vector<T>& keep) const {
    check(in_.header(name), name, type, dims, rows, width);
    const NpyArray a = in_.array(name);
    keep.resize(static_cast<size_t>(a.bytes()) / sizeof(T));
    if (!keep.empty()) std::memcpy(keep.data(), a.data, keep.size() * sizeof(T));
    return keep.data();
  }

  // Before anything is read: the shape alone.
  void check(const char* name, const char* type, int32_t dims, uint64_t rows, uint64_t width) const {
    check(in_.header(name), name, type, dims, rows, width);
  }

 private:
  static void check(const NpyArray& a, const char* name, const char* type, int32_t dims, uint64_t rows,
                    uint64_t width) {
    if (!a.is(type, dims) || a.shape[0] != rows || (dims > 1 && a.shape[1] != width))
      fail(Code::kFormat, "%s: array %s has an unexpected type or shape", kWhat, name);
  }
  NpzReader& in_;
};

void read_text(NpzReader& in, const char* name, char* out, size_t capacity) {
  const NpyArray head = in.header(name);
  if (head.dims != 0 || std::strncmp(head.type, "|S", 2) != 0 || head.item_bytes() >= capacity)
    fail(Code::kFormat, "%s: array %s is not a text of at most %zu bytes", kWhat, name, capacity - 1);
  const NpyArray a = in.array(name);
  std::memcpy(out, a.data, a.item_bytes());
  out[a.item_bytes()] = '\0';
  if (!is_clean_text(out)) fail(Code::kFormat, "%s: array %s holds control characters", kWhat, name);
}

int32_t width_of(const NpzReader& in, const char* name, uint64_t least, uint64_t most) {
  const NpyArray a = in.header(name);
  if (!a.is("<f4", 2) || a.shape[1] < least || a.shape[1] > most)
    fail(Code::kFormat, "%s: array %s has an unexpected type or shape", kWhat, name);
  return static_cast<int32_t>(a.shape[1]);
}

// States of a recording; of a rollout one before each step, or one before each episode.
struct States {
  Vector<uint8_t> bytes;
  Vector<int64_t> row;
  size_t width = 0;
};
void read_states(NpzReader& in, uint64_t rows, States* out) {
  const bool own = in.has("state_row"), every = !own && in.has("states");
  const char* name = every ? "states" : "state";
  if (!in.has(name)) return;
  const NpyArray a = in.header(name);
  if (!a.is("|u1", 2) || a.shape[0] > rows || a.shape[1] > (1u << 30))
    fail(Code::kFormat, "%s: array %s has an unexpected type or shape", kWhat, name);
  out->width = static_cast<size_t>(a.shape[1]);
  const Columns columns(in);
  if (own)
    columns.take("state_row", "<i8", 1, a.shape[0], 0, out->row);
  else if (every)
    for (uint64_t i = 0; i < rows; ++i) out->row.push_back(static_cast<int64_t>(i));
  else
    columns.take("episode_begin", "<i8", 1, a.shape[0] + 1, 0, out->row), out->row.pop_back();
  if (out->row.size() != a.shape[0]) fail(Code::kFormat, "%s: it does not have a row for each state", kWhat);
  columns.take(name, "|u1", 2, a.shape[0], a.shape[1], out->bytes);
}

void read_episodes(NpzReader& in, uint64_t rows, Vector<int64_t>& out) {
  const Columns columns(in);
  if (!in.header("episode").is("<i4", 1)) {
    columns.take("episode", "<i8", 1, rows, 0, out);
    return;
  }
  Vector<int32_t> narrow;
  columns.take("episode", "<i4", 1, rows, 0, narrow);
  out.assign(narrow.begin(), narrow.end());
}

}  // namespace

void Recording::write(Vector<unsigned char>& file) const {
  const auto n = static_cast<uint64_t>(rows()), states = uint64_t{state_row_.size()};
  file.clear();
  file.reserve(static_cast<size_t>(
      (obs_.size() + action_.size() + label_.size() + cost_.size() + reward_.size()) * sizeof(float) +
      state_.size() + (n + states) * sizeof(int64_t) + 3 * n + 8192));
  NpzWriter out(file);
  const auto width = [](int32_t w) { return static_cast<uint64_t>(w); };
  add_text(out, "format", kFormat);
  add_text(out, "task", spec_.task);
  out.add("layout_hash", one_value("<u8", &spec_.layout_hash));
  out.add("obs", array_of("<f4", obs_.data(), n, width(spec_.obs_dim)));
  out.add("action", array_of("<f4", action_.data(), n, width(spec_.action_dim)));
  out.add("label", array_of("<f4", label_.data(), n, width(spec_.action_dim)));
  out.add("reward", array_of("<f4", reward_.data(), n));
  NpyArray cost = array_of("<f4", cost_.data(), n, width(spec_.cost_dim));
  cost.dims = 2;  // without costs too
  out.add("cost", cost);
  out.add("terminated", array_of("|b1", terminated_.data(), n));
  out.add("truncated", array_of("|b1", truncated_.data(), n));
  out.add("success", array_of("|b1", success_.data(), n));
  out.add("episode", array_of("<i8", episode_.data(), n));
  if (spec_.state_bytes > 0) {
    out.add("state_row", array_of("<i8", state_row_.data(), states));
    out.add("state", array_of("|u1", state_.data(), states, spec_.state_bytes));
  }
  if (spec_.num_points > 0) {
    NpyArray points = array_of("<i2", points_.data(), n, width(spec_.num_points));
    points.dims = 3, points.shape[2] = 3;
    out.add("points", points);
    out.add("point_class", array_of("|u1", point_class_.data(), n, width(spec_.num_points)));
  }
  if (spec_.point_color) {
    NpyArray color = array_of("|u1", point_color_.data(), n, width(spec_.num_points));
    color.dims = 3, color.shape[2] = 3;
    out.add("point_color", color);
  }
  out.finish();
}

Recording* Recording::read(const ByteSource& source, const HostHooks& hooks) {
  NpzReader in(source, kWhat);
  char format[64];
  if (in.has("format")) {
    read_text(in, "format", format, sizeof format);
    if (std::strncmp(format, kFormat, std::strlen(kFormat) - 1) != 0)
      fail(Code::kFormat, "%s: its format is '%s', which this library does not read", kWhat,
           Quoted(format).text);
    if (std::strcmp(format, kFormat) != 0)
      fail(Code::kVersion, "%s: its format, '%s', is newer than this library", kWhat, Quoted(format).text);
  }
  RecordingSpec spec;
  if (in.has("task")) read_text(in, "task", spec.task, sizeof spec.task);
  if (in.has("layout_hash")) {
    if (!in.header("layout_hash").is("<u8", 0))
      fail(Code::kFormat, "%s: array layout_hash has an unexpected type or shape", kWhat);
    const NpyArray a = in.array("layout_hash");
    std::memcpy(&spec.layout_hash, a.data, sizeof spec.layout_hash);
  }
  spec.obs_dim = width_of(in, "obs", 1, 16384);
  spec.action_dim = width_of(in, "action", 1, 1024);
  spec.cost_dim = width_of(in, "cost", 0, 16);
  const uint64_t n = in.header("obs").shape[0];
  if (n > static_cast<uint64_t>(kMaxRecordingRows)) fail(Code::kFormat, "%s: it has too many rows", kWhat);
  if (in.has("points")) {
    const NpyArray a = in.header("points");
    if (!a.is("<i2", 3) || a.shape[0] != n || a.shape[1] < 1 || a.shape[1] > kMaxRecordedPoints ||
        a.shape[2] != 3)
      fail(Code::kFormat, "%s: array points has an unexpected type or shape", kWhat);
    spec.num_points = static_cast<int32_t>(a.shape[1]);
    spec.point_color = in.has("point_color");
  }

  const Columns columns(in);
  Vector<int16_t> points;
  Vector<uint8_t> point_class, point_color;
  Vector<float> obs, action, label, reward, cost;
  Vector<uint8_t> terminated, truncated, success;
  Vector<int64_t> episode;
  RecordingRows v;
  const auto width = [](int32_t w) { return static_cast<uint64_t>(w); };
  v.rows = static_cast<int64_t>(n);
  // all shapes, then the short columns: what does not fit is found before the long ones take memory
  columns.check("obs", "<f4", 2, n, width(spec.obs_dim));
  columns.check("action", "<f4", 2, n, width(spec.action_dim));
  columns.check("reward", "<f4", 1, n, 0);
  columns.check("cost", "<f4", 2, n, width(spec.cost_dim));
  v.terminated = columns.take("terminated", "|b1", 1, n, 0, terminated);
  v.truncated = columns.take("truncated", "|b1", 1, n, 0, truncated);
  v.success = columns.take("success", "|b1", 1, n, 0, success);
  read_episodes(in, n, episode);
  v.episode = episode.data();
  States states;
  read_states(in, n, &states);
  spec.state_bytes = states.width;
  v.obs = columns.take("obs", "<f4", 2, n, width(spec.obs_dim), obs);
  v.action = columns.take("action", "<f4", 2, n, width(spec.action_dim), action);
  if (in.has("label")) v.label = columns.take("label", "<f4", 2, n, width(spec.action_dim), label);
  v.reward = columns.take("reward", "<f4", 1, n, 0, reward);
  v.cost = columns.take("cost", "<f4", 2, n, width(spec.cost_dim), cost);
  if (spec.num_points) {
    v.points = columns.take("points", "<i2", 3, n, width(spec.num_points), points);
    if (in.has("point_class"))
      v.point_class = columns.take("point_class", "|u1", 2, n, width(spec.num_points), point_class);
    if (spec.point_color)
      v.point_color = columns.take("point_color", "|u1", 3, n, width(spec.num_points), point_color);
  }
  v.num_states = static_cast<int64_t>(states.row.size());
  v.state_row = states.row.data();
  v.state = states.bytes.data();
  Recording* r = host_new<Recording>(hooks, spec, 0);
  try {
    r->append(v);
  } catch (const Error& e) {
    host_delete(hooks, r);
    if (e.code != Code::kArgument && e.code != Code::kRange) throw;
    fail(Code::kFormat, "%s: %s", kWhat, e.text);
  } catch (...) {
    host_delete(hooks, r);
    throw;
  }
  return r;
}

}  // namespace rdm
