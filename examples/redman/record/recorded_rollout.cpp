#include "record/recorded_rollout.hpp"

#include <algorithm>
#include <cstring>

#include "common/files.hpp"
#include "common/json.hpp"
#include "play/episodes.hpp"
#include "record/npy.hpp"

namespace tool {
namespace {

// All arrays together take at most this, or this many times what the file takes: a rollout's numbers do not
// pack tighter, while zeros would by 1,000.
constexpr uint64_t kMostUnpacked = uint64_t{1} << 26, kMostPacked = 24;
constexpr size_t kMostHead = 1024;  // of an array file

struct Array {
  ArrayShape shape;
  std::string bytes;
  size_t begin = 0;
};

// Its shape, before the numbers are unpacked; `bytes` holds the head alone.
Array head_of(const ZipReader& zip, const std::string& name, const char* type, size_t dimensions) {
  if (!zip.has(name + ".npy")) throw Failure("it has no array " + name);
  Array a;
  a.bytes = zip.head(name + ".npy", kMostHead);
  try {
    a.shape = parse_npy_head(a.bytes.data(), a.bytes.size(), &a.begin);
  } catch (const Failure& e) {
    throw Failure(name + ": " + e.what());
  }
  if ((type && a.shape.type != type) || a.shape.shape.size() != dimensions)
    throw Failure(name + ": it does not have the type or shape of a rollout's array");
  if (a.shape.bytes() != zip.size(name + ".npy") - a.begin)
    throw Failure(name + ": it does not have the length that its header says");
  return a;
}

void read_numbers(const ZipReader& zip, const std::string& name, Array* a) {
  a->bytes = zip.member(name + ".npy", zip.size(name + ".npy"));
}

}  // namespace

Recording parse_recording(const ZipReader& zip) {
  Recording r;
  Array text = head_of(zip, "metadata", nullptr, 0);
  if (text.shape.bytes() > 4 * kMostJsonBytes) throw Failure("metadata: it is too long");
  read_numbers(zip, "metadata", &text);
  const std::string json_text = text_of_array(text.shape, text.bytes.data() + text.begin);
  const Document json = parse_json(json_text.data(), json_text.size());
  if (text_at(json, "format") != "redman rollout 1") throw Failure("its format is not redman rollout 1");
  r.pool.task = text_at(json, "task");
  r.pool.seed = seed_at(json, "seed");
  r.pool.envs = static_cast<int32_t>(integer_at(json, "envs", 1, 65536));
  for (const std::string& set : texts_at(json, "set")) {
    const size_t at = set.find('=');
    if (at == 0 || at == std::string::npos) throw Failure("set " + set + ": it is not key=value");
    r.pool.options.emplace_back(set.substr(0, at), set.substr(at + 1));
  }
  r.policy = text_at(json, "policy");
  r.hash = text_at(json, "hash", 16);

  Array action = head_of(zip, "action", "<f4", 2), begin = head_of(zip, "episode_begin", "<i8", 1),
        state = head_of(zip, "state", "|u1", 2);
  const uint64_t episodes = begin.shape.shape[0] - 1;  // of 0: more than there may be
  if (episodes < 1 || episodes > kMostEpisodes)
    throw Failure("episode_begin: its rows are not the first steps of its episodes");
  if (state.shape.shape[0] != episodes) throw Failure("state: it does not have one state for each episode");
  const uint64_t most = std::max(kMostUnpacked, kMostPacked * zip.size());
  if (action.shape.bytes() > most || state.shape.bytes() > most - action.shape.bytes())
    throw Failure("action, state: " + std::to_string(action.shape.bytes()) + " and " +
                  std::to_string(state.shape.bytes()) + " bytes out of a file of " +
                  std::to_string(zip.size()));
  read_numbers(zip, "episode_begin", &begin);
  r.begin.resize(static_cast<size_t>(begin.shape.shape[0]));
  std::memcpy(r.begin.data(), begin.bytes.data() + begin.begin, r.begin.size() * sizeof(uint64_t));
  if (r.begin[0] != 0 || r.begin.back() != action.shape.shape[0])
    throw Failure("episode_begin: its rows are not the first steps of its episodes");
  for (size_t e = 0; e < r.episodes(); ++e)
    if (r.begin[e] >= r.begin[e + 1])
      throw Failure("episode_begin: episode " + std::to_string(e) + " has no step");
  read_numbers(zip, "action", &action);
  r.action_dim = static_cast<size_t>(action.shape.shape[1]);
  r.action.resize(static_cast<size_t>(action.shape.bytes()) / sizeof(float));
  std::memcpy(r.action.data(), action.bytes.data() + action.begin, r.action.size() * sizeof(float));
  action.bytes = {};
  read_numbers(zip, "state", &state);
  r.state_bytes = static_cast<size_t>(state.shape.shape[1]);
  r.state = state.bytes.substr(state.begin);
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
