#include "data/mcap.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "common/files.hpp"
#include "common/json.hpp"
#include "common/text.hpp"
#include "record/zip.hpp"

namespace tool {
namespace {

constexpr char kMcapMagic[] = "\x89MCAP0\r\n";
constexpr size_t kMcapMagicBytes = 8, kChunkBytes = size_t{1} << 20;
constexpr uint64_t kMostMcapRecord = uint64_t{1} << 31;
constexpr uint16_t kStepChannel = 1, kEndChannel = 2;
constexpr const char* kTopics[] = {"/redman/step", "/redman/end"};

enum Opcode : uint8_t {
  kHeader = 1,
  kFooter,
  kSchema,
  kChannel,
  kMessage,
  kChunk,
  kMessageIndex,
  kChunkIndex,
  kAttachment,
  kAttachmentIndex,
  kStatistics,
  kMetadata,
  kMetadataIndex,
  kSummaryOffset,
  kDataEnd
};

uint32_t crc_of(const std::string& bytes, uint32_t before = 0) {
  return checksum_of(before, bytes.data(), bytes.size());
}

// The fields of a record.
class Fields {
 public:
  template <class T>
  Fields& add(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);  // little-endian, as the machine is
    return *this;
  }
  Fields& text(const std::string& value) {
    add(static_cast<uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  Fields& raw(const std::string& value) {
    bytes_ += value;
    return *this;
  }
  std::string record(Opcode opcode) const {
    Fields head;
    head.add(static_cast<uint8_t>(opcode)).add(uint64_t{bytes_.size()});
    return head.bytes_ + bytes_;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string float_text(float value) {
  if (value == 0) return std::signbit(value) ? "-0.0" : "0";
  return format("%.9g", static_cast<double>(value));
}

std::string list_text(const float* values, size_t count) {
  std::string out = "[";
  for (size_t i = 0; i < count; ++i) out += (i ? "," : "") + float_text(values[i]);
  return out + ']';
}

// So that viewers know the members.
std::string schema_text(const std::vector<std::string>& lists, const std::vector<std::string>& numbers,
                        const std::vector<std::string>& flags) {
  Json properties = Json::object();
  for (const std::string& name : lists)
    properties[name] = {{"type", "array"}, {"items", {{"type", "number"}}}};
  for (const std::string& name : numbers) properties[name] = {{"type", "number"}};
  for (const std::string& name : flags) properties[name] = {{"type", "boolean"}};
  return json_text({{"type", "object"}, {"properties", properties}});
}

class McapWriter {
 public:
  explicit McapWriter(PreparedFile& file) : file_(file) {}

  void begin(const DataSet& set) {
    file_.write(kMcapMagic, kMcapMagicBytes);
    put(Fields().text("").text("redman").record(kHeader));
    const std::string metadata = json_text(set.metadata);
    Fields pairs;
    pairs.text("format").text(kDataFormat);
    pairs.text("task").text(set.task);
    pairs.text("layout_hash").text(format("%016llx", static_cast<unsigned long long>(set.layout_hash)));
    pairs.text("obs_dim").text(std::to_string(set.obs_dim));
    pairs.text("action_dim").text(std::to_string(set.action_dim));
    pairs.text("cost_dim").text(std::to_string(set.cost_dim));
    pairs.text("labels").text(set.labels ? "1" : "0");
    pairs.text("sources").text(set.sources ? "1" : "0");
    pairs.text("metadata").text(metadata);
    metadata_at_ = file_.size();
    put(Fields().text("redman").text(pairs.bytes()).record(kMetadata));
    metadata_bytes_ = file_.size() - metadata_at_;
    schemas_ += Fields()
                    .add(uint16_t{1})
                    .text("redman.Step")
                    .text("jsonschema")
                    .text(schema_text({"obs", "action", "label", "cost"}, {"episode", "row", "reward"},
                                      {"terminated", "truncated", "success"}))
                    .record(kSchema);
    schemas_ += Fields()
                    .add(uint16_t{2})
                    .text("redman.End")
                    .text("jsonschema")
                    .text(schema_text({"final_obs"}, {"episode", "rows", "source", "return"}, {}))
                    .record(kSchema);
    for (const uint16_t id : {kStepChannel, kEndChannel})
      channels_ += Fields().add(id).add(id).text(kTopics[id - 1]).text("json").text("").record(kChannel);
  }

  void message(uint16_t channel, uint64_t time, const std::string& json) {
    if (chunk_.empty()) chunk_ = schemas_ + channels_, first_ = time;
    index_[channel].emplace_back(time, chunk_.size());
    chunk_ += Fields()
                  .add(channel)
                  .add(static_cast<uint32_t>(counts_[channel]++))
                  .add(time)
                  .add(time)
                  .raw(json)
                  .record(kMessage);
    last_ = time;
    if (chunk_.size() >= kChunkBytes) flush();
  }

  void finish() {
    flush();
    put(Fields().add(uint32_t{0}).record(kDataEnd));  // 0: no checksum of all; each chunk has one
    const uint64_t summary = file_.size();
    std::string offsets, all;
    const auto group = [&](Opcode opcode, const std::string& records) {
      if (!records.empty())
        offsets += Fields()
                       .add(static_cast<uint8_t>(opcode))
                       .add(summary + all.size())
                       .add(uint64_t{records.size()})
                       .record(kSummaryOffset);
      all += records;
    };
    group(kSchema, schemas_);
    group(kChannel, channels_);
    Fields numbers;
    for (const auto& [id, count] : counts_) numbers.add(id).add(count);
    uint64_t messages = 0;
    for (const auto& [id, count] : counts_) messages += count;
    group(kStatistics, Fields()
                           .add(messages)
                           .add(uint16_t{2})
                           .add(uint32_t{2})
                           .add(uint32_t{0})
                           .add(uint32_t{1})
                           .add(chunks_)
                           .add(uint64_t{0})
                           .add(last_)
                           .text(numbers.bytes())
                           .record(kStatistics));
    group(kChunkIndex, chunk_indexes_);
    group(kMetadataIndex,
          Fields().add(metadata_at_).add(metadata_bytes_).text("redman").record(kMetadataIndex));
    const uint64_t offsets_at = summary + all.size();
    all += offsets;
    Fields tail;
    tail.add(summary).add(offsets_at);
    Fields head;
    head.add(static_cast<uint8_t>(kFooter)).add(uint64_t{20});
    const std::string footer = head.bytes() + tail.bytes();
    put(all);
    put(footer + Fields().add(crc_of(footer, crc_of(all))).bytes());
    file_.write(kMcapMagic, kMcapMagicBytes);
  }

 private:
  void put(const std::string& bytes) { file_.write(bytes.data(), bytes.size()); }
  void flush() {
    if (chunk_.empty()) return;
    const uint64_t at = file_.size();
    put(Fields()
            .add(first_)
            .add(last_)
            .add(uint64_t{chunk_.size()})
            .add(crc_of(chunk_))
            .text("")
            .add(uint64_t{chunk_.size()})
            .raw(chunk_)
            .record(kChunk));
    const uint64_t end = file_.size();
    Fields places;
    for (const auto& [id, entries] : index_) {
      places.add(id).add(file_.size());
      Fields list;
      for (const auto& [time, offset] : entries) list.add(time).add(offset);
      put(Fields().add(id).text(list.bytes()).record(kMessageIndex));
    }
    chunk_indexes_ += Fields()
                          .add(first_)
                          .add(last_)
                          .add(at)
                          .add(end - at)
                          .text(places.bytes())
                          .add(file_.size() - end)
                          .text("")
                          .add(uint64_t{chunk_.size()})
                          .add(uint64_t{chunk_.size()})
                          .record(kChunkIndex);
    ++chunks_;
    chunk_.clear();
    index_.clear();
  }

  PreparedFile& file_;
  std::string schemas_, channels_, chunk_, chunk_indexes_;
  std::map<uint16_t, uint64_t> counts_;
  std::map<uint16_t, std::vector<std::pair<uint64_t, uint64_t>>> index_;  // of the chunk: time, offset
  uint64_t first_ = 0, last_ = 0, metadata_at_ = 0, metadata_bytes_ = 0;
  uint32_t chunks_ = 0;
};

// Fields of a record, each checked against its end.
class FieldReader {
 public:
  FieldReader(const char* begin, size_t size) : at_(begin), end_(begin + size) {}
  template <class T>
  T take() {
    need(sizeof(T));
    T value;
    std::memcpy(&value, at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::string text() {
    const auto size = take<uint32_t>();
    need(size);
    std::string out(at_, size);
    at_ += size;
    return out;
  }
  const char* at() const { return at_; }
  size_t left() const { return static_cast<size_t>(end_ - at_); }
  void skip(size_t size) {
    need(size);
    at_ += size;
  }

 private:
  void need(uint64_t size) const {
    if (left() < size) throw Failure("a record is cut off");
  }
  const char *at_, *end_;
};

std::map<std::string, std::string> pairs_of(const std::string& bytes) {
  std::map<std::string, std::string> out;
  for (FieldReader in(bytes.data(), bytes.size()); in.left() > 0;) {
    std::string key = in.text();
    out[key] = in.text();
  }
  return out;
}

class McapReader {
 public:
  DataSet read(const OpenFile& file) {
    uint64_t at = magic(file, 0);
    for (bool over = false; !over;) {
      char head[9];
      if (file.size() - at < sizeof head) throw Failure("it is cut off");
      file.read(at, head, sizeof head);
      uint64_t size;
      std::memcpy(&size, head + 1, sizeof size);
      at += sizeof head;
      if (size > file.size() - at || size > kMostMcapRecord) throw Failure("it is cut off");
      const auto opcode = static_cast<uint8_t>(head[0]);
      over = opcode == kDataEnd;
      if (opcode == kChannel || opcode == kMessage || opcode == kChunk || opcode == kMetadata) {
        std::string bytes(static_cast<size_t>(size), '\0');
        file.read(at, bytes.data(), bytes.size());
        record(opcode, bytes.data(), bytes.size());
      }
      at += size;
    }
    if (!found_)
      throw Failure("it has no metadata of redman, so it was not written by `redman data convert`");
    for (const DataEpisode& e : set_.episodes)
      if (e.rows() == 0) throw Failure("an episode has no rows");
    return std::move(set_);
  }

 private:
  static uint64_t magic(const OpenFile& file, uint64_t at) {
    char bytes[kMcapMagicBytes] = {};
    if (file.size() >= kMcapMagicBytes) file.read(at, bytes, sizeof bytes);
    if (std::memcmp(bytes, kMcapMagic, sizeof bytes) != 0) throw Failure("it does not begin as an MCAP file");
    return at + kMcapMagicBytes;
  }
  void record(uint8_t opcode, const char* bytes, size_t size) {
    FieldReader in(bytes, size);
    if (opcode == kChannel) {
      const auto id = in.take<uint16_t>();
      in.take<uint16_t>();
      topics_[id] = in.text();
    } else if (opcode == kMetadata) {
      if (in.text() != "redman") return;
      describe(pairs_of(in.text()));
    } else if (opcode == kMessage) {
      const auto id = in.take<uint16_t>();
      in.skip(4 + 8 + 8);
      const std::string& topic = topics_[id];
      if (topic != kTopics[0] && topic != kTopics[1]) return;
      if (!found_) throw Failure("its metadata does not precede its messages");
      const Document json = parse_json(in.at(), in.left());
      topic == kTopics[0] ? step(json) : end(json);
    } else {
      in.skip(8 + 8);
      const auto whole = in.take<uint64_t>();
      const auto checksum = in.take<uint32_t>();
      if (const std::string packed = in.text(); !packed.empty())
        throw Failure("its chunks are compressed (" + printable(packed) +
                      "); `mcap compress --compression none` undoes that");
      const auto count = in.take<uint64_t>();
      if (count != whole || count != in.left()) throw Failure("a chunk is cut off");
      if (checksum != 0 && crc_of(std::string(in.at(), in.left())) != checksum)
        throw Failure("a chunk is damaged");
      while (in.left() > 0) {
        const auto inner = in.take<uint8_t>();
        const auto length = in.take<uint64_t>();
        if (length > in.left()) throw Failure("a record is cut off");
        if (inner == kChannel || inner == kMessage) record(inner, in.at(), static_cast<size_t>(length));
        in.skip(static_cast<size_t>(length));
      }
    }
  }
  void describe(std::map<std::string, std::string> pairs) {
    if (pairs["format"] != kDataFormat)
      throw Failure("its format is '" + printable(pairs["format"]) + "', not '" + kDataFormat + "'");
    const auto count = [&](const char* key, size_t most) {
      const std::string& text = pairs[key];
      size_t value = 0;
      for (const char c : text)
        value = c >= '0' && c <= '9' && value < 100000 ? 10 * value + static_cast<size_t>(c - '0') : 1000000;
      if (text.empty() || value > most)
        throw Failure(std::string(key) + ": it is not a number up to " + std::to_string(most));
      return value;
    };
    set_.task = pairs["task"];
    set_.layout_hash = std::strtoull(pairs["layout_hash"].c_str(), nullptr, 16);
    set_.obs_dim = count("obs_dim", 16384);
    set_.action_dim = count("action_dim", 1024);
    set_.cost_dim = count("cost_dim", 16);
    set_.labels = pairs["labels"] == "1";
    set_.sources = pairs["sources"] == "1";
    const std::string& text = pairs["metadata"];
    parse_json(text.data(), text.size());
    set_.metadata = Json::parse(text);
    found_ = true;
  }
  static void floats(const Document& json, const char* key, size_t count, std::vector<float>& out) {
    for (const auto& v : list_at(json, key, count)) {
      if (!v.is_number()) throw Failure(std::string(key) + ": it is not a list of numbers");
      out.push_back(static_cast<float>(v.get<double>()));
    }
  }
  DataEpisode& episode_of(const Document& json) {
    const auto number = static_cast<size_t>(integer_at(json, "episode", 0, 1 << 30));
    if (number > set_.episodes.size()) throw Failure("its episodes are not in order");
    if (number == set_.episodes.size()) set_.episodes.emplace_back();
    return set_.episodes[number];
  }
  void step(const Document& json) {
    DataEpisode& e = episode_of(json);
    floats(json, "obs", set_.obs_dim, e.obs);
    floats(json, "action", set_.action_dim, e.action);
    if (set_.labels) floats(json, "label", set_.action_dim, e.label);
    floats(json, "cost", set_.cost_dim, e.cost);
    e.reward.push_back(static_cast<float>(number_at(json, "reward", -3e38, 3e38)));
    e.terminated.push_back(flag_at(json, "terminated"));
    e.truncated.push_back(flag_at(json, "truncated"));
    e.success.push_back(flag_at(json, "success"));
  }
  void end(const Document& json) {
    DataEpisode& e = episode_of(json);
    if (json.contains("final_obs")) floats(json, "final_obs", set_.obs_dim, e.final_obs);
    if (set_.sources) e.source = static_cast<uint8_t>(integer_at(json, "source", 0, 255));
  }

  DataSet set_;
  std::map<uint16_t, std::string> topics_;
  bool found_ = false;
};

}  // namespace

void write_mcap(const DataSet& set, const std::string& path) {
  if (const std::string fault = fault_of(set); !fault.empty()) throw Failure(path + ": " + fault);
  check_replaceable(path);
  PreparedFile file(path);
  McapWriter out(file);
  out.begin(set);
  double dt = 1.0 / 60;
  if (set.metadata.contains("control_dt") && set.metadata["control_dt"].is_number())
    dt = set.metadata["control_dt"].get<double>();
  if (set.metadata.contains("action_repeat") && set.metadata["action_repeat"].is_number())
    dt *= set.metadata["action_repeat"].get<double>();
  const auto step_ns = static_cast<uint64_t>(std::clamp(std::round(dt * 1e9), 1.0, 1e12));
  uint64_t time = 0;
  for (size_t i = 0; i < set.episodes.size(); ++i) {
    const DataEpisode& e = set.episodes[i];
    for (size_t t = 0; t < e.rows(); ++t, time += step_ns) {
      std::string json = format("{\"episode\":%zu,\"row\":%zu,\"reward\":", i, t) + float_text(e.reward[t]);
      json += ",\"cost\":" + list_text(e.cost.data() + t * set.cost_dim, set.cost_dim);
      json += ",\"action\":" + list_text(e.action.data() + t * set.action_dim, set.action_dim);
      if (set.labels) json += ",\"label\":" + list_text(e.label.data() + t * set.action_dim, set.action_dim);
      json += ",\"obs\":" + list_text(e.obs.data() + t * set.obs_dim, set.obs_dim);
      const auto flag = [](uint8_t f) { return f ? "true" : "false"; };
      json += format(",\"terminated\":%s,\"truncated\":%s,\"success\":%s}", flag(e.terminated[t]),
                     flag(e.truncated[t]), flag(e.success[t]));
      out.message(kStepChannel, time, json);
    }
    std::string json = format("{\"episode\":%zu,\"rows\":%zu,\"source\":%d,\"return\":%.9g", i, e.rows(),
                              e.source, e.sum_of_rewards());
    if (!e.final_obs.empty()) json += ",\"final_obs\":" + list_text(e.final_obs.data(), set.obs_dim);
    out.message(kEndChannel, time, json + '}');
  }
  out.finish();
  file.commit();
}

DataSet read_mcap(const std::string& path) {
  if (const std::string problem = why_no_file(path); !problem.empty()) throw Failure(path + ": " + problem);
  const OpenFile file(path);
  try {
    return McapReader().read(file);
  } catch (const Failure& e) {
    throw Failure(path + ": " + e.what());
  } catch (const nlohmann::json::exception&) {
    throw Failure(path + ": metadata: it is not JSON");
  }
}

}  // namespace tool
