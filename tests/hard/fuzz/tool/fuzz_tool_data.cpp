// Data sets, as .npz and as MCAP: what is read fits together, can be summed up, and has a hash.
#include <unistd.h>

#include <fstream>

#include "../fuzz.hpp"
#include "../zip.hpp"
#include "common/files.hpp"
#include "data/mcap.hpp"
#include "data/set.hpp"
#include "data/summary.hpp"

namespace hard {
namespace {

enum Form { kNpz, kMcap, kForms };

std::string path_of(Form form) {
  return "fuzz_tool_data-" + std::to_string(getpid()) + (form == kNpz ? ".npz" : ".mcap");
}

tool::DataSet small_set(bool labels, bool sources) {
  tool::DataSet set;
  set.task = "bandit";
  set.obs_dim = 2, set.action_dim = 1, set.cost_dim = 2;
  set.labels = labels, set.sources = sources;
  set.metadata = {{"format", tool::kDataFormat},
                  {"limits", {1, 2}},
                  {"sources", {"a", "b"}},
                  {"costs", {{{"name", "c"}, {"limit", 1}}}}};
  for (const size_t rows : {3u, 1u}) {
    tool::DataEpisode e;
    e.obs.assign(2 * rows, 0.5f);
    e.action.assign(rows, -0.25f);
    if (labels) e.label = e.action;
    e.reward.assign(rows, 1);
    e.cost.assign(2 * rows, 0.125f);
    e.terminated.assign(rows, 0);
    e.truncated.assign(rows, 0);
    e.success.assign(rows, 0);
    (rows == 1 ? e.terminated : e.truncated).back() = 1;
    e.final_obs.assign(2, 1);
    e.source = static_cast<uint8_t>(sources ? rows % 2 : 0);
    set.episodes.push_back(e);
  }
  return set;
}

// Records of an opcode, a length and fields behind eight bytes; a chunk's checksum of 0 is none.
void mend_mcap(unsigned char* data, size_t size) {
  for (size_t at = 8; at + 9 <= size;) {
    uint64_t length = 0;
    std::memcpy(&length, data + at + 1, sizeof length);
    if (data[at] == 6 && at + 9 + 28 <= size) std::memset(data + at + 9 + 24, 0, 4);
    at += 9;
    if (length > size - at) return;
    at += static_cast<size_t>(length);
  }
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> out;
  for (const bool more : {false, true})
    for (const Form form : {kNpz, kMcap}) {
      const std::string path = path_of(form);
      const tool::DataSet set = small_set(more, more);
      form == kNpz ? tool::write_set(set, path) : tool::write_mcap(set, path);
      out.push_back(with_pick(form, bytes_of(tool::read_file(path))));
      unlink(path.c_str());
    }
  return out;
}
void whole(unsigned char* data, size_t size) {
  if (size < 1) return;
  pick(data, size, kForms) == kNpz ? mend_zip(data + 1, size - 1) : mend_mcap(data + 1, size - 1);
}
size_t fixed_bytes() {
  return 1;
}

void one(const unsigned char* data, size_t size) {
  if (size < 1) return;
  const Form form = pick(data, size, kForms) == kNpz ? kNpz : kMcap;
  const std::string path = path_of(form);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  try {
    const tool::DataSet set = form == kNpz ? tool::read_set(path) : tool::read_mcap(path);
    const std::string fault = tool::fault_of(set);
    HARD_REQUIRE(fault.empty(), "%s", fault.c_str());
    const tool::Json summary = tool::summary_json(set);
    HARD_REQUIRE(summary["rows"].get<uint64_t>() == set.rows(), "rows are counted");
    HARD_REQUIRE(!tool::summary_text(summary).empty(), "no words");
    HARD_REQUIRE(tool::hash_text(set).size() == 16, "a hash");
  } catch (const tool::Failure& e) {
    HARD_REQUIRE(*e.what(), "no text");
  }
  unlink(path.c_str());
}

}  // namespace hard
