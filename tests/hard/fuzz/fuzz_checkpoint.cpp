// Checkpoints: an agent, two worlds and a note in one file. What cannot be read changes neither agent nor
// worlds.
#include <fcntl.h>
#include <unistd.h>

#include "fuzz.hpp"

namespace hard {
namespace {

struct Subject {
  AgentOf agent;
  PoolOf pool;
  std::string path;
  Bytes agent_state, pool_state, file;

  Subject() {
    const char* folder = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : ".";
    path = std::string(folder) + "/fuzz_checkpoint-" + std::to_string(getpid()) + ".rdm";
    HARD_REQUIRE(agent.make("cppo_pid") == RDM_OK, "%s", rdm_last_error());
    HARD_REQUIRE(agent.epoch() == RDM_OK, "%s", rdm_last_error());
    HARD_REQUIRE(pool.make({"point_button1", "", 0, 0}, 2) == RDM_OK, "%s", rdm_last_error());
    HARD_REQUIRE(rdm_pool_reset(pool.handle, nullptr, nullptr) == RDM_OK, "%s", rdm_last_error());
    pool.fill_actions(1);
    HARD_REQUIRE(rdm_pool_step(pool.handle) == RDM_OK, "%s", rdm_last_error());
    agent_state = agent.state();
    pool_state = pool.state();
    HARD_REQUIRE(rdm_checkpoint_write(path.c_str(), agent.handle, pool.handle, "a note", 6) == RDM_OK, "%s",
                 rdm_last_error());
    const int fd = open(path.c_str(), O_RDONLY);
    file.resize(1 << 20);
    file.resize(static_cast<size_t>(read(fd, file.data(), file.size())));
    close(fd);
    std::atexit([] { unlink(subject().path.c_str()); });
  }
  static Subject& subject() {
    static auto* s = new Subject;
    return *s;
  }
};

}  // namespace

std::vector<Bytes> seeds() {
  return {Subject::subject().file};
}
void whole(unsigned char* data, size_t size) {
  mend(data, size);
}
size_t fixed_bytes() {
  return kFileHead;
}

void one(const unsigned char* data, size_t size) {
  Subject& s = Subject::subject();
  const int fd = open(s.path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  HARD_REQUIRE(fd >= 0 && write(fd, data, size) == static_cast<ssize_t>(size), "cannot write the input");
  close(fd);
  char note[64];
  size_t length = 0;
  const float cost = s.pool.rows.reward[0];
  const rdm_result r =
      rdm_checkpoint_read(s.path.c_str(), s.agent.handle, s.pool.handle, note, sizeof note, &length);
  if (r != RDM_OK) {
    require_refusal(r);
    static unsigned n = 0;
    if (++n % 16 == 0) {
      HARD_REQUIRE(s.agent.state() == s.agent_state, "a read that failed changed the agent");
      HARD_REQUIRE(s.pool.state() == s.pool_state && s.pool.rows.reward[0] == cost,
                   "a read that failed changed the worlds");
    }
    return;
  }
  // Steps and an epoch take longer than all the rest: every fourth of what is taken does them.
  static unsigned taken = 0;
  const bool goes_on = ++taken % 4 == 0;
  for (uint32_t i = 0; goes_on && i < 3; ++i) {
    s.pool.fill_actions(i);
    const rdm_result step = rdm_pool_step(s.pool.handle);
    if (step != RDM_OK) {
      require_refusal(step);
      break;
    }
    const char* bad = s.pool.broken_row();
    HARD_REQUIRE(!bad, "%s is out of its bounds", bad);
  }
  const rdm_result e = goes_on ? s.agent.epoch() : RDM_OK;
  if (e != RDM_OK) require_refusal(e);
  HARD_REQUIRE(rdm_agent_read_state(s.agent.handle, s.agent_state.data(), s.agent_state.size()) == RDM_OK,
               "%s", rdm_last_error());
  HARD_REQUIRE(rdm_pool_read_state(s.pool.handle, -1, s.pool_state.data(), s.pool_state.size()) == RDM_OK,
               "%s", rdm_last_error());
}

}  // namespace hard
