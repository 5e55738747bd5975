// Files of recordings: what loads keeps its own promises, is written again to the same rows, and can be
// learned from.
#include <sys/mman.h>
#include <unistd.h>

#include "fuzz.hpp"
#include "zip.hpp"

namespace hard {
namespace {

// A file in memory that the library opens by its path.
class MemoryFile {
 public:
  MemoryFile() : file_(memfd_create("recording", 0)), path_("/proc/self/fd/" + std::to_string(file_)) {
    HARD_REQUIRE(file_ >= 0, "no file in memory");
  }
  ~MemoryFile() { close(file_); }
  const char* path() const { return path_.c_str(); }
  void fill(const unsigned char* data, size_t size) const {
    HARD_REQUIRE(ftruncate(file_, 0) == 0 && pwrite(file_, data, size, 0) == static_cast<ssize_t>(size),
                 "a file in memory");
  }

 private:
  int file_;
  std::string path_;
};

Bytes read_all(const std::string& path) {
  Bytes out;
  FILE* f = std::fopen(path.c_str(), "rb");
  HARD_REQUIRE(f, "%s", path.c_str());
  for (int c = std::fgetc(f); c != EOF; c = std::fgetc(f)) out.push_back(static_cast<unsigned char>(c));
  std::fclose(f);
  return out;
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> out;
  for (const bool states : {false, true}) {
    rdm_recording_config c;
    HARD_REQUIRE(rdm_recording_config_init(&c, sizeof c) == RDM_OK, "%s", rdm_last_error());
    c.obs_dim = 3;
    c.action_dim = 2;
    c.cost_dim = 1;
    c.task = states ? "own" : "";
    c.state_bytes = states ? 5 : 0;
    rdm_recording* r = nullptr;
    HARD_REQUIRE(rdm_recording_create(&r, &c) == RDM_OK, "%s", rdm_last_error());
    const float obs[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, action[8] = {1, 0, -1, 0.5f, 0, 0, 1, 1};
    const uint8_t end[4] = {0, 1, 0, 0}, state[10] = {};
    const int64_t at[2] = {0, 2};
    rdm_recording_rows rows{};
    rows.struct_size = sizeof rows;
    rows.rows = 4;
    rows.obs = obs;
    rows.action = action;
    rows.terminated = end;
    rows.num_states = states ? 2 : 0;
    rows.state_row = at;
    rows.state = state;
    HARD_REQUIRE(rdm_recording_append(r, &rows) == RDM_OK, "%s", rdm_last_error());
    const std::string path = "fuzz_recording-" + std::to_string(getpid()) + ".npz";
    HARD_REQUIRE(rdm_recording_write_file(r, path.c_str()) == RDM_OK, "%s", rdm_last_error());
    out.push_back(read_all(path));
    unlink(path.c_str());
    rdm_recording_destroy(r);
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
  static const MemoryFile file;
  file.fill(data, size);
  rdm_recording* r = nullptr;
  const rdm_result loaded = rdm_recording_read_file(&r, file.path());
  if (loaded != RDM_OK) return require_refusal(loaded);
  rdm_recording_info info{};
  info.struct_size = sizeof info;
  HARD_REQUIRE(rdm_recording_get_info(r, &info) == RDM_OK, "%s", rdm_last_error());
  HARD_REQUIRE(good_text(info.task) && info.rows >= 0 && info.episodes <= info.rows, "%lld rows",
               static_cast<long long>(info.rows));
  rdm_recording_rows rows{};
  rows.struct_size = sizeof rows;
  HARD_REQUIRE(rdm_recording_get_rows(r, &rows) == RDM_OK, "%s", rdm_last_error());
  for (int64_t i = 0; i < info.rows * info.action_dim; ++i)
    HARD_REQUIRE(rows.label[i] >= -1 && rows.label[i] <= 1, "a label is %g",
                 static_cast<double>(rows.label[i]));
  for (int64_t i = 0; i < rows.num_states; ++i)
    HARD_REQUIRE(rows.state_row[i] >= 0 && rows.state_row[i] < info.rows, "a state of no row");

  rdm_agent_config config;
  HARD_REQUIRE(rdm_agent_config_init(&config, sizeof config) == RDM_OK, "%s", rdm_last_error());
  if (info.obs_dim <= 64 && info.action_dim <= 16) {
    config.obs_dim = info.obs_dim;
    config.action_dim = info.action_dim;
    config.cost_dim = 0;
    config.num_envs = 1;
    config.algo = "ppo";
    config.settings = "hidden=4";
    rdm_agent* agent = nullptr;
    HARD_REQUIRE(rdm_agent_create(&agent, &config) == RDM_OK, "%s", rdm_last_error());
    rdm_clone_config how;
    HARD_REQUIRE(rdm_clone_config_init(&how, sizeof how) == RDM_OK, "%s", rdm_last_error());
    how.epochs = 1;
    const rdm_result cloned = rdm_agent_clone(agent, r, &how, nullptr);
    if (cloned != RDM_OK) require_refusal(cloned);
    rdm_agent_destroy(agent);
  }
  const double most[RDM_MAX_COSTS] = {};
  const rdm_result dropped = rdm_recording_filter(r, 0, most, nullptr);
  if (dropped != RDM_OK) require_refusal(dropped);
  rdm_recording_destroy(r);
}

}  // namespace hard
