#include "data/set.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include "common/files.hpp"
#include "common/json.hpp"
#include "common/text.hpp"
#include "record/npy.hpp"
#include "record/zip.hpp"

namespace tool {
namespace {

constexpr size_t kArrayHead = 1024;  // bytes that hold the head of an array file
constexpr size_t kWritten = size_t{1} << 20;

template <class T>
constexpr const char* kArrayType = "|b1";
template <>
constexpr const char* kArrayType<float> = "<f4";

// One array of the set: its rows lie in the episodes.
template <class T>
struct ColumnOf {
  const char* name;
  std::vector<T> DataEpisode::*rows;
  std::optional<size_t> width;  // none: one number a row, in an array of one dimension
  size_t numbers() const { return width.value_or(1); }
  ArrayShape shape(uint64_t count) const {
    ArrayShape array{kArrayType<T>, {count}};
    if (width) array.shape.push_back(*width);
    return array;
  }
};

// Calls f with each column of rows that the set has, in the order of the file.
template <class Set, class F>
void each_column(const Set& set, F&& f) {
  f(ColumnOf<float>{"obs", &DataEpisode::obs, set.obs_dim});
  f(ColumnOf<float>{"action", &DataEpisode::action, set.action_dim});
  if (set.labels) f(ColumnOf<float>{"label", &DataEpisode::label, set.action_dim});
  f(ColumnOf<float>{"reward", &DataEpisode::reward, {}});
  f(ColumnOf<float>{"cost", &DataEpisode::cost, set.cost_dim});
  f(ColumnOf<uint8_t>{"terminated", &DataEpisode::terminated, {}});
  f(ColumnOf<uint8_t>{"truncated", &DataEpisode::truncated, {}});
  f(ColumnOf<uint8_t>{"success", &DataEpisode::success, {}});
}

struct Fnv {
  uint64_t value = 14695981039346656037u;
  void add(const void* bytes, size_t size) {
    for (const auto* p = static_cast<const unsigned char*>(bytes); size; --size)
      value = (value ^ *p++) * 1099511628211u;
  }
};

class ArrayOut {
 public:
  explicit ArrayOut(ZipWriter& zip) : zip_(zip) {}
  ~ArrayOut() = default;
  void begin(const std::string& name, const ArrayShape& array) {
    const std::string header = npy_header(array);
    zip_.begin(name + ".npy", header.size() + array.bytes());
    waiting_ = header;
  }
  void add(const void* bytes, size_t size) {
    waiting_.append(static_cast<const char*>(bytes), size);
    if (waiting_.size() >= kWritten) flush();
  }
  void flush() {
    zip_.write(waiting_.data(), waiting_.size());
    waiting_.clear();
  }
  void whole(const std::string& name, const ArrayShape& array, const std::string& bytes) {
    begin(name, array);
    add(bytes.data(), bytes.size());
    flush();
  }

 private:
  ZipWriter& zip_;
  std::string waiting_;
};

template <class T>
std::string raw_bytes(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

// A member's numbers, its type and shape having been compared.
class ArrayIn {
 public:
  explicit ArrayIn(const ZipReader& zip) : zip_(zip) {}
  bool has(const std::string& name) const { return zip_.has(name + ".npy"); }
  ArrayShape shape(const std::string& name) const {
    if (!has(name)) throw Failure("it has no array " + name);
    const std::string head = zip_.head(name + ".npy", kArrayHead);
    size_t begin = 0;
    try {
      ArrayShape s = parse_npy_head(head.data(), head.size(), &begin);
      if (s.bytes() != zip_.size(name + ".npy") - begin)
        throw Failure("it does not have the length that its header says");
      return s;
    } catch (const Failure& e) {
      throw Failure(name + ": " + e.what());
    }
  }
  // The bytes of its numbers; `begin` is where they are.
  std::string bytes(const std::string& name, size_t* begin) const {
    std::string all = zip_.member(name + ".npy", zip_.size(name + ".npy"));
    parse_npy(all.data(), all.size(), begin);
    return all;
  }
  std::string text(const std::string& name) const {
    const ArrayShape s = shape(name);
    size_t begin = 0;
    const std::string all = bytes(name, &begin);
    if (s.type.rfind("|S", 0) == 0) return std::string(all.c_str() + begin).substr(0, s.item_bytes());
    return text_of_array(s, all.data() + begin);
  }

 private:
  const ZipReader& zip_;
};

size_t width_of_array(const ArrayIn& in, const char* name, size_t most) {
  const ArrayShape s = in.shape(name);
  if (s.type != "<f4" || s.shape.size() != 2 || s.shape[1] > most)
    throw Failure(std::string(name) + ": it is not float32 numbers of two dimensions");
  return static_cast<size_t>(s.shape[1]);
}

// The episode of each row, counted from 0 in the order in which they begin.
std::vector<size_t> episodes_of_rows(const ArrayIn& in, uint64_t rows, size_t* count) {
  const ArrayShape s = in.shape("episode");
  const bool narrow = s.type == "<i4";
  if ((!narrow && s.type != "<i8") || s.shape.size() != 1 || s.shape[0] != rows)
    throw Failure("episode: it is not a whole number for each row");
  size_t begin = 0;
  const std::string all = in.bytes("episode", &begin);
  std::vector<size_t> out(static_cast<size_t>(rows));
  std::map<int64_t, size_t> known;
  int64_t before = 0;
  size_t at = 0;
  for (size_t i = 0; i < out.size(); ++i) {
    int64_t number = 0;
    if (narrow) {
      int32_t short_number = 0;
      std::memcpy(&short_number, all.data() + begin + 4 * i, 4);
      number = short_number;
    } else {
      std::memcpy(&number, all.data() + begin + 8 * i, 8);
    }
    if (i == 0 || number != before) at = known.emplace(number, known.size()).first->second;
    before = number;
    out[i] = at;
  }
  *count = known.size();
  return out;
}

template <class T>
void read_rows(const ArrayIn& in, const ColumnOf<T>& column, const std::vector<size_t>& episode,
               DataSet& set) {
  const size_t width = column.numbers(), size = width * sizeof(T);
  const ArrayShape s = in.shape(column.name), wanted = column.shape(episode.size());
  const bool fits = s.type == wanted.type || (sizeof(T) == 1 && s.type == "|u1");
  if (!fits || s.shape != wanted.shape)
    throw Failure(std::string(column.name) + ": it does not have the type or shape of a recording's array");
  size_t begin = 0;
  const std::string all = in.bytes(column.name, &begin);
  for (size_t i = 0; i < episode.size(); ++i) {
    std::vector<T>& rows = set.episodes[episode[i]].*column.rows;
    const size_t old = rows.size();
    rows.resize(old + width);
    if (width) std::memcpy(rows.data() + old, all.data() + begin + i * size, size);
    if constexpr (std::is_same_v<T, float>)
      if (!std::all_of(rows.begin() + static_cast<std::ptrdiff_t>(old), rows.end(),
                       [](float x) { return std::isfinite(x); }))
        throw Failure(format("%s: row %zu is not finite", column.name, i));
  }
}

DataSet parse_set(const ZipReader& zip) {
  const ArrayIn in(zip);
  DataSet set;
  if (in.has("task")) set.task = in.text("task");
  if (in.has("layout_hash")) {
    if (in.shape("layout_hash").type != "<u8") throw Failure("layout_hash: it is not a whole number");
    size_t begin = 0;
    const std::string all = in.bytes("layout_hash", &begin);
    std::memcpy(&set.layout_hash, all.data() + begin, sizeof set.layout_hash);
  }
  if (in.has("metadata")) {
    const std::string text = in.text("metadata");
    parse_json(text.data(), text.size());  // size, depth
    set.metadata = Json::parse(text);
  }
  set.obs_dim = width_of_array(in, "obs", 16384);
  set.action_dim = width_of_array(in, "action", 1024);
  set.cost_dim = width_of_array(in, "cost", 16);
  set.labels = in.has("label");
  const uint64_t rows = in.shape("obs").shape[0];
  size_t count = 0;
  const std::vector<size_t> episode = episodes_of_rows(in, rows, &count);
  set.episodes.resize(count);
  each_column(set, [&](const auto& column) { read_rows(in, column, episode, set); });
  if (in.has("final_obs")) {
    const ArrayShape s = in.shape("final_obs");
    if (s.type != "<f4" || s.shape.size() != 2 || s.shape[0] != count || s.shape[1] != set.obs_dim)
      throw Failure("final_obs: it does not have a row for each episode");
    size_t begin = 0;
    const std::string all = in.bytes("final_obs", &begin);
    for (size_t e = 0; e < count; ++e) {
      DataEpisode& episode_of = set.episodes[e];
      if (!episode_of.ended()) continue;
      episode_of.final_obs.resize(set.obs_dim);
      std::memcpy(episode_of.final_obs.data(), all.data() + begin + e * set.obs_dim * sizeof(float),
                  set.obs_dim * sizeof(float));
    }
  }
  if (in.has("source")) {
    const ArrayShape s = in.shape("source");
    if (s.type != "|u1" || s.shape.size() != 1 || s.shape[0] != count)
      throw Failure("source: it is not a number for each episode");
    size_t begin = 0;
    const std::string all = in.bytes("source", &begin);
    for (size_t e = 0; e < count; ++e) set.episodes[e].source = static_cast<uint8_t>(all[begin + e]);
    set.sources = true;
  }
  return set;
}

}  // namespace

double DataEpisode::sum_of_rewards() const {
  double sum = 0;
  for (const float r : reward) sum += static_cast<double>(r);
  return sum;
}

double DataEpisode::sum_of_costs(size_t column, size_t cost_dim) const {
  double sum = 0;
  for (size_t i = column; i < cost.size(); i += cost_dim) sum += static_cast<double>(cost[i]);
  return sum;
}

uint64_t DataSet::rows() const {
  uint64_t sum = 0;
  for (const DataEpisode& e : episodes) sum += e.rows();
  return sum;
}

bool DataSet::finals() const {
  return std::all_of(episodes.begin(), episodes.end(),
                     [](const DataEpisode& e) { return !e.ended() || !e.final_obs.empty(); });
}

std::string fault_of(const DataSet& set) {
  for (size_t i = 0; i < set.episodes.size(); ++i) {
    const DataEpisode& e = set.episodes[i];
    std::string fault;
    each_column(set, [&](const auto& column) {
      if ((e.*column.rows).size() != e.rows() * column.numbers()) fault = column.name;
    });
    if (!fault.empty())
      return format("episode %zu: %s does not fit its %zu rows", i, fault.c_str(), e.rows());
    if (e.rows() == 0) return format("episode %zu has no rows", i);
  }
  return "";
}

uint64_t hash_of(const DataSet& set) {
  Fnv fnv;
  const auto add = [&](const char* name, uint32_t checksum) {
    fnv.add(name, std::strlen(name));
    fnv.add(&checksum, sizeof checksum);  // little-endian, as the machine is
  };
  each_column(set, [&](const auto& column) {
    uint32_t checksum = 0;
    for (const DataEpisode& e : set.episodes) {
      const auto& rows = e.*column.rows;
      if (!rows.empty()) checksum = checksum_of(checksum, rows.data(), rows.size() * sizeof rows[0]);
    }
    add(column.name, checksum);
  });
  uint32_t checksum = 0;
  for (const DataEpisode& e : set.episodes) {
    const auto count = static_cast<uint32_t>(e.rows());
    checksum = checksum_of(checksum, &count, sizeof count);
  }
  add("length", checksum);
  return fnv.value;
}

std::string hash_text(const DataSet& set) {
  return format("%016llx", static_cast<unsigned long long>(hash_of(set)));
}

DataSet read_set(const std::string& path) {
  if (const std::string problem = why_no_file(path); !problem.empty()) throw Failure(path + ": " + problem);
  const OpenFile file(path);
  try {
    return parse_set(
        ZipReader(file.size(), [&](uint64_t at, void* to, size_t size) { file.read(at, to, size); }));
  } catch (const Failure& e) {
    throw Failure(path + " is not a data set or a recording (.npz): " + e.what());
  } catch (const nlohmann::json::exception&) {
    throw Failure(path + ": metadata: it is not JSON");
  }
}

void write_set(const DataSet& set, const std::string& path) {
  if (const std::string fault = fault_of(set); !fault.empty()) throw Failure(path + ": " + fault);
  check_replaceable(path);
  PreparedFile file(path);
  ZipWriter zip(file);
  ArrayOut out(zip);
  const std::string text = json_text(set.metadata);
  out.whole("metadata", text_shape(text), text_bytes(text));
  const std::string task = set.task.empty() ? std::string(1, '\0') : set.task;
  out.whole("task", {"|S" + std::to_string(task.size()), {}}, task);
  out.whole("layout_hash", {"<u8", {}}, raw_bytes(std::vector<uint64_t>{set.layout_hash}));
  const uint64_t rows = set.rows(), count = set.episodes.size();
  std::vector<int64_t> begin(1), episode;
  for (size_t e = 0; e < set.episodes.size(); ++e) {
    begin.push_back(begin.back() + static_cast<int64_t>(set.episodes[e].rows()));
    episode.insert(episode.end(), set.episodes[e].rows(), static_cast<int64_t>(e));
  }
  out.whole("episode_begin", {"<i8", {begin.size()}}, raw_bytes(begin));
  out.whole("episode", {"<i8", {rows}}, raw_bytes(episode));
  each_column(set, [&](const auto& column) {
    using T = typename std::decay_t<decltype(DataEpisode().*column.rows)>::value_type;
    out.begin(column.name, column.shape(rows));
    for (const DataEpisode& e : set.episodes)
      out.add((e.*column.rows).data(), (e.*column.rows).size() * sizeof(T));
    out.flush();
  });
  if (set.finals()) {
    const std::vector<float> none(set.obs_dim, 0.0f);
    out.begin("final_obs", {"<f4", {count, set.obs_dim}});
    for (const DataEpisode& e : set.episodes)
      out.add((e.final_obs.empty() ? none : e.final_obs).data(), set.obs_dim * sizeof(float));
    out.flush();
  }
  if (set.sources) {
    std::string numbers;
    for (const DataEpisode& e : set.episodes) numbers += static_cast<char>(e.source);
    out.whole("source", {"|u1", {count}}, numbers);
  }
  zip.finish();
  file.commit();
}

}  // namespace tool
