// Recorded rollouts: what is read has as many actions and states as its episodes say.
#include <unistd.h>

#include "../fuzz.hpp"
#include "../zip.hpp"
#include "common/files.hpp"
#include "common/report.hpp"
#include "record/recorded_rollout.hpp"
#include "record/recorder.hpp"

namespace hard {

std::vector<Bytes> seeds() {
  std::vector<Bytes> out;
  for (const bool states : {false, true}) {
    const std::string path = "fuzz_tool_record-" + std::to_string(getpid()) + ".npz";
    auto config = redman::pool_config("bandit");
    config.autoreset = RDM_AUTORESET_OFF;
    redman::Pool pool(config);
    tool::Recorder recorder(path, pool, 1, states);
    pool.reset();
    recorder.before(0, 0);
    pool.step();
    recorder.after(0, 0);
    recorder.finish({"hold", {{"max_steps", "1"}}, 7});
    out.push_back(bytes_of(tool::read_file(path)));
    unlink(path.c_str());
  }
  return out;
}
void whole(unsigned char* data, size_t size) {
  mend_zip(data, size);
}
size_t fixed_bytes() {
  return 0;
}

void one(const unsigned char* data, size_t size) {
  try {
    const tool::Recording r =
        tool::parse_recording(tool::ZipReader(size, [&](uint64_t at, void* to, size_t count) {
          HARD_REQUIRE(at <= size && count <= size - at, "a read past the end");
          std::memcpy(to, data + at, count);
        }));
    HARD_REQUIRE(r.episodes() >= 1 && r.state.size() == r.episodes() * r.state_bytes, "states are missing");
    HARD_REQUIRE(r.action.size() == r.begin.back() * r.action_dim, "actions are missing");
  } catch (const tool::Failure& e) {
    HARD_REQUIRE(*e.what(), "no text");
  }
}

}  // namespace hard
