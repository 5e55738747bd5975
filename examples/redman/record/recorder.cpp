#include "record/recorder.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstring>

#include "common/names.hpp"
#include "common/setting.hpp"
#include "common/text.hpp"
#include "record/npy.hpp"
#include "record/zip.hpp"

namespace tool {
namespace {

constexpr size_t kPart = size_t{1} << 20;  // bytes that are copied at a time

bool ends_as(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && same_name(text.substr(text.size() - end.size()), end);
}

template <class T>
constexpr const char* kType = "|u1";
template <>
constexpr const char* kType<float> = "<f4";
template <>
constexpr const char* kType<int32_t> = "<i4";
template <>
constexpr const char* kType<uint32_t> = "<u4";
template <>
constexpr const char* kType<bool> = "|b1";

// Collects small parts for a member of an archive.
class Parts {
 public:
  explicit Parts(ZipWriter& zip) : zip_(zip) {}
  void add(const void* bytes, size_t size) {
    waiting_.append(static_cast<const char*>(bytes), size);
    if (waiting_.size() >= kPart) flush();
  }
  void flush() {
    zip_.write(waiting_.data(), waiting_.size());
    waiting_.clear();
  }

 private:
  ZipWriter& zip_;
  std::string waiting_;
};

void write_array(ZipWriter& zip, const std::string& name, const ArrayShape& array, const std::string& bytes) {
  const std::string header = npy_header(array);
  zip.begin(name + ".npy", header.size() + bytes.size());
  zip.write(header.data(), header.size());
  zip.write(bytes.data(), bytes.size());
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

// A cell of the header: quoted where a comma or a quote stands in it.
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() || unit == "1" ? name : name + " (" + unit + ")";
}

}  // namespace

template <class T>
void Recorder::add(const char* name, const char* help, const T* rows, std::vector<uint64_t> shape,
                   bool before, bool of_episode) {
  uint64_t count = 1;
  for (const uint64_t n : shape) count *= n;
  columns_.push_back({name, kType<T>, help, std::move(shape), rows, count * sizeof(T), before, of_episode});
}

Recorder::Recorder(const std::string& path, const redman::Pool& pool, size_t episodes, bool states,
                   bool labels)
    : pool_(pool),
      table_(ends_as(path, ".csv")),
      states_(states),
      file_(path),
      scratch_(path),
      episodes_(episodes) {
  check_replaceable(path);
  if (table_ && states) throw Usage("--record-states: a .csv file cannot hold states; give an .npz file");
  const size_t n = pool.num_envs();
  const rdm_buffers& b = pool.buffers();
  const auto obs = static_cast<uint64_t>(pool.spec().obs_dim),
             action = static_cast<uint64_t>(pool.spec().action_dim),
             costs = static_cast<uint64_t>(pool.spec().cost_dim);
  env_.resize(n);
  episode_.resize(n);
  step_.assign(n, 0);
  for (size_t i = 0; i < n; ++i) env_[i] = static_cast<int32_t>(i);
  const auto flag = [](const uint8_t* p) { return reinterpret_cast<const bool*>(p); };
  add("episode", "number of the episode", episode_.data(), {}, true);
  add("step", "control steps of the episode before this one", step_.data(), {}, true);
  add("env", "world that played it", env_.data(), {}, true);
  add("obs", "observation before the action", b.obs, {obs}, true);
  add("action", "as it was given, in [-1, 1]", b.action, {action}, true);
  label_.resize(labels ? n * static_cast<size_t>(action) : 0);
  if (labels) add("label", "the action before noise", label_.data(), {action}, true);
  add("reward", "of the step", b.reward, {}, false);
  add("cost", "of the step, by column", b.cost, {costs}, false);
  add("cost_raw", "the measured value behind each cost", b.cost_raw, {costs}, false);
  add("terminated", "the task ended", flag(b.terminated), {}, false);
  add("truncated", "cut by the time limit or a bad status", flag(b.truncated), {}, false);
  add("success", "the task's success held in the step", flag(b.success), {}, false);
  add("status", "bits: 1 contacts left out, 2 diverged, 4 bad action", b.status, {}, false);
  if (!table_) {
    state_bytes_ = pool.state(0).size();
    start_.resize(n * state_bytes_);
    state_.resize(states ? n * state_bytes_ : 0);
    if (states) add("states", "of the world before the step", state_.data(), {state_bytes_}, true);
    add("state", "of the world before the episode's first step", start_.data(), {state_bytes_}, false, true);
    add("final_obs", "observation after the last step", b.obs, {obs}, false, true);
    add("episode_return", "sum of rewards", b.episode_return, {}, false, true);
    add("episode_cost", "sum of each cost", b.episode_cost, {costs}, false, true);
  }
  waiting_.assign(n, std::vector<std::string>(columns_.size()));
}

void Recorder::take(size_t env, bool before, bool of_episode) {
  for (size_t c = 0; c < columns_.size(); ++c) {
    const Column& column = columns_[c];
    if (column.before != before || column.of_episode != of_episode) continue;
    waiting_[env][c].append(static_cast<const char*>(column.rows) + env * column.bytes, column.bytes);
  }
}

void Recorder::label(size_t env) {
  if (!label_.empty())
    std::copy(pool_.action()[env].begin(), pool_.action()[env].end(),
              label_.data() + env * pool_.action().width());
}

void Recorder::before(size_t env, size_t episode) {
  episode_[env] = static_cast<int32_t>(episode);
  if (!table_ && (states_ || step_[env] == 0)) {
    const redman::Bytes state = pool_.state(static_cast<int32_t>(env));
    if (states_) std::copy(state.begin(), state.end(), state_.data() + env * state_bytes_);
    if (step_[env] == 0) std::copy(state.begin(), state.end(), start_.data() + env * state_bytes_);
  }
  take(env, true, false);
}

void Recorder::after(size_t env, size_t episode) {
  take(env, false, false);
  ++step_[env];
  if (!pool_.terminated()[env] && !pool_.truncated()[env]) return;
  take(env, false, true);
  episodes_.resize(std::max(episodes_.size(), episode + 1));
  episodes_[episode] = {scratch_.size(), static_cast<uint64_t>(step_[env]), 0};
  std::string all;
  for (std::string& column : waiting_[env]) {
    all += column;
    column.clear();
  }
  scratch_.write(all);
  step_[env] = 0;
}

void Recorder::rewind(size_t env, int32_t steps) {
  for (size_t c = 0; c < columns_.size(); ++c)
    if (!columns_[c].of_episode) waiting_[env][c].resize(static_cast<size_t>(steps) * columns_[c].bytes);
  step_[env] = steps;
}

template <class Use>
void Recorder::read_column(const Span& span, size_t column, Use use) const {
  uint64_t at = span.offset;
  const auto bytes = [&](size_t c) { return columns_[c].bytes * (columns_[c].of_episode ? 1 : span.steps); };
  for (size_t c = 0; c < column; ++c) at += bytes(c);
  std::string part;
  for (uint64_t left = bytes(column); left > 0; left -= part.size(), at += part.size()) {
    part.resize(static_cast<size_t>(std::min<uint64_t>(left, kPart)));
    scratch_.read(at, part.data(), part.size());
    use(part);
  }
}

std::string Recorder::metadata(const RecordNote& note, uint64_t steps) const {
  const rdm_spec& spec = pool_.spec();
  Json fields = Json::array(), costs = Json::array(), options = Json::object(), set = Json::array(),
       arrays = Json::object();
  for (int32_t i = 0; i < spec.num_fields; ++i) {
    rdm_field_info f = RDM_INIT(rdm_field_info);
    redman::check(rdm_pool_field_at(pool_.get(), i, &f));
    fields.push_back({{"name", f.name}, {"unit", f.unit}, {"offset", f.offset}, {"count", f.count}});
  }
  const std::vector<double> limits = cost_limits(pool_, {});
  for (const rdm_cost_info& c : task_costs(spec.task)) {
    const double limit = limits[costs.size()];
    costs.push_back({{"name", c.name}, {"help", c.help}, {"limit", limit < 0 ? Json() : Json(limit)}});
  }
  for (const auto& [key, value] : pool_settings(pool_)) options[key] = value;
  for (const auto& [key, value] : note.options) set.push_back(key + "=" + value);
  for (const Column& c : columns_) arrays[c.name] = c.help;
  arrays["task"] = "name, UTF-8";
  arrays["layout_hash"] = "of the fields of obs and the order of action";
  arrays["episode_begin"] = "row of each episode's first step, and the number of steps";
  const Json json = {{"format", "redman rollout 1"},
                     {"task", task_at(spec.task).name},
                     {"set", set},
                     {"policy", note.policy},
                     {"seed", note.seed},
                     {"envs", pool_.num_envs()},
                     {"episodes", episodes_.size()},
                     {"steps", steps},
                     {"control_dt", static_cast<double>(spec.control_dt)},
                     {"max_steps", spec.max_steps},
                     {"hash", format("%016" PRIx64, pool_.hash())},
                     {"layout_hash", format("%016" PRIx64, spec.layout_hash)},
                     {"fields", fields},
                     {"costs", costs},
                     {"options", options},
                     {"arrays", arrays},
                     {"build", build_json()}};
  return json_text(json);
}

void Recorder::write_arrays(const RecordNote& note, uint64_t steps) {
  ZipWriter zip(file_);
  const std::string text = metadata(note, steps);
  write_array(zip, "metadata", text_shape(text), text_bytes(text));
  // what rdm_recording_read_file wants to know
  const std::string task = task_at(pool_.spec().task).name;
  write_array(zip, "task", {"|S" + std::to_string(task.size()), {}}, task);
  write_array(zip, "layout_hash", {"<u8", {}}, bytes_of(std::vector<uint64_t>{pool_.spec().layout_hash}));
  write_array(zip, "seed", {"<u8", {}}, bytes_of(std::vector<uint64_t>{note.seed}));
  std::vector<int64_t> begin;
  for (const Span& e : episodes_) begin.push_back(static_cast<int64_t>(e.first));
  begin.push_back(static_cast<int64_t>(steps));
  write_array(zip, "episode_begin", {"<i8", {begin.size()}}, bytes_of(begin));
  for (size_t c = 0; c < columns_.size(); ++c) {
    const Column& column = columns_[c];
    ArrayShape array{column.type, {column.of_episode ? episodes_.size() : steps}};
    array.shape.insert(array.shape.end(), column.shape.begin(), column.shape.end());
    const std::string header = npy_header(array);
    zip.begin(column.name + ".npy", header.size() + array.bytes());
    Parts parts(zip);
    parts.add(header.data(), header.size());
    for (const Span& e : episodes_)
      read_column(e, c, [&](const std::string& part) { parts.add(part.data(), part.size()); });
    parts.flush();
  }
  zip.finish();
}

// A row a step: the time since the file's first one, then the columns, entry by entry.
void Recorder::write_table() {
  std::string out = "time (s)";
  for (const Column& c : columns_) {
    if (c.name == "obs") {
      for (int32_t i = 0; i < pool_.spec().num_fields; ++i) {
        rdm_field_info f = RDM_INIT(rdm_field_info);
        redman::check(rdm_pool_field_at(pool_.get(), i, &f));
        for (int32_t k = 0; k < f.count; ++k)
          out += ',' + csv_cell(with_unit(f.name + (f.count > 1 ? format("[%d]", k) : ""), f.unit));
      }
    } else if (c.name == "cost" || c.name == "cost_raw") {
      for (const rdm_cost_info& cost : task_costs(pool_.spec().task))
        out += ',' + csv_cell(c.name + '.' + cost.name);
    } else if (c.name == "action" || c.name == "label") {
      for (uint64_t k = 0; k < c.shape[0]; ++k) out += ',' + c.name + format("[%" PRIu64 "]", k);
    } else {
      out += ',' + c.name;
    }
  }
  out += '\n';
  const auto dt = static_cast<double>(pool_.spec().control_dt);
  std::vector<std::string> bytes(columns_.size());
  for (const Span& e : episodes_) {
    for (size_t c = 0; c < columns_.size(); ++c) {
      bytes[c].clear();
      read_column(e, c, [&](const std::string& part) { bytes[c] += part; });
    }
    for (uint64_t i = 0; i < e.steps; ++i) {
      out += format("%.9g", static_cast<double>(e.first + i) * dt);
      for (size_t c = 0; c < columns_.size(); ++c) {
        const char* row = bytes[c].data() + i * columns_[c].bytes;
        const size_t item = ArrayShape{columns_[c].type, {}}.item_bytes();
        for (size_t k = 0; k < columns_[c].bytes; k += item) {
          int32_t whole = 0;
          float number = 0;
          if (item == 1) whole = row[k];
          if (item == 4) std::memcpy(&whole, row + k, 4), std::memcpy(&number, row + k, 4);
          out +=
              columns_[c].type == "<f4" ? format(",%.9g", static_cast<double>(number)) : format(",%d", whole);
        }
      }
      out += '\n';
      if (out.size() < kPart) continue;
      file_.write(out.data(), out.size());
      out.clear();
    }
  }
  file_.write(out.data(), out.size());
}

uint64_t Recorder::finish(const RecordNote& note) {
  uint64_t steps = 0;
  for (Span& e : episodes_) {
    e.first = steps;
    steps += e.steps;
  }
  if (table_)
    write_table();
  else
    write_arrays(note, steps);
  file_.commit();
  return steps;
}

}  // namespace tool
