#include "record/recorded_rollout.hpp"

#include <cstring>

#include "common/files.hpp"
#include "common/json.hpp"
#include "play/episodes.hpp"
#include "record/npy.hpp"

namespace tool {
namespace {

constexpr uint64_t kMostBytes = uint64_t{1} << 33;  // of an array that is read whole

struct Array {
  ArrayShape shape;
  std::string bytes;
  size_t begin = 0;
};

Array array_at(const ZipReader& zip, const std::string& name, const char* type, size_t dimensions,
               uint64_t most = kMostBytes) {
  if (!zip.has(name + ".npy")) throw Failure("it has no array " + name);
  Array a;
  a.bytes = zip.member(name + ".npy", most);
  try {
    a.shape = parse_npy(a.bytes.data(), a.bytes.size(), &a.begin);
  } catch (const Failure& e) {
    throw Failure(name + ": " + e.what());
  }
  if ((type && a.shape.type != type) || a.shape.shape.size() != dimensions)
    throw Failure(name + ": another type or shape than a rollout's");
  return a;
}

}  // namespace

Recording parse_recording(const ZipReader& zip) {
  Recording r;
  const Array text = array_at(zip, "metadata", nullptr, 0, 4 * kMostJsonBytes + 1024);
  const std::string json_text = text_of_array(text.shape, text.bytes.data() + text.begin);
  const Document json = parse_json(json_text.data(), json_text.size());
  if (text_at(json, "format") != "redman rollout 1") throw Failure("of another format than redman rollout 1");
  r.pool.task = text_at(json, "task");
  r.pool.seed = seed_at(json, "seed");
  r.pool.envs = static_cast<int32_t>(integer_at(json, "envs", 1, 65536));
  for (const std::string& set : texts_at(json, "set")) {
    const size_t at = set.find('=');
    if (at == 0 || at == std::string::npos) throw Failure("set " + set + ": not key=value");
    r.pool.options.emplace_back(set.substr(0, at), set.substr(at + 1));
  }
  r.policy = text_at(json, "policy");
  r.hash = text_at(json, "hash", 16);

  const Array action = array_at(zip, "action", "<f4", 2), begin = array_at(zip, "episode_begin", "<i8", 1),
              state = array_at(zip, "state", "|u1", 2);
  r.action_dim = static_cast<size_t>(action.shape.shape[1]);
  r.action.resize(static_cast<size_t>(action.shape.bytes()) / sizeof(float));
  if (!r.action.empty())
    std::memcpy(r.action.data(), action.bytes.data() + action.begin, r.action.size() * sizeof(float));
  r.begin.resize(static_cast<size_t>(begin.shape.shape[0]));
  if (!r.begin.empty())
    std::memcpy(r.begin.data(), begin.bytes.data() + begin.begin, r.begin.size() * sizeof(uint64_t));
  r.state_bytes = static_cast<size_t>(state.shape.shape[1]);
  r.state = state.bytes.substr(state.begin);
  if (r.begin.size() < 2 || r.begin.size() > size_t{kMostEpisodes} + 1 || r.begin[0] != 0 ||
      r.begin.back() != action.shape.shape[0])
    throw Failure("episode_begin: not the first steps of its episodes");
  for (size_t e = 0; e < r.episodes(); ++e)
    if (r.begin[e] >= r.begin[e + 1])
      throw Failure("episode_begin: episode " + std::to_string(e) + " has no step");
  if (state.shape.shape[0] != r.episodes()) throw Failure("state: not one for each episode");
  return r;
}

Recording read_recording(const std::string& path) {
  const OpenFile file(path);
  try {
    return parse_recording(
        ZipReader(file.size(), [&](uint64_t at, void* to, size_t size) { file.read(at, to, size); }));
  } catch (const Failure& e) {
    throw Failure(path + " is not a recorded rollout: " + e.what());
  }
}

}  // namespace tool
