// States of worlds, of every task on every engine: what is taken steps on, and what the step writes is
// finite; what is not taken changes nothing. RDM_FUZZ_WORLDS=closed_form... picks worlds whose name holds the
// text.
#include "fuzz.hpp"

namespace hard {
namespace {

struct Subject {
  World world;
  PoolOf pool;
  Bytes state;
  void ready() {
    if (pool.handle) return;
    HARD_REQUIRE(pool.make(world, 1) == RDM_OK, "%s", rdm_last_error());
    HARD_REQUIRE(rdm_pool_reset(pool.handle, nullptr, nullptr) == RDM_OK, "%s", rdm_last_error());
    for (uint32_t i = 0; i < 3; ++i) {
      pool.fill_actions(i);
      HARD_REQUIRE(rdm_pool_step(pool.handle) == RDM_OK, "%s", rdm_last_error());
    }
    state = pool.state();
  }
};

std::vector<Subject>& subjects() {
  static auto* all = [] {
    const char* only = std::getenv("RDM_FUZZ_WORLDS");
    std::vector<World> worlds;
    for (const World& w : all_worlds())
      if (!only ||
          (std::strcmp(only, "small") == 0 ? w.engine.empty() : w.name().find(only) != std::string::npos))
        worlds.push_back(w);
    HARD_REQUIRE(!worlds.empty(), "no world is called so");
    auto* out = new std::vector<Subject>(worlds.size());
    for (size_t i = 0; i < worlds.size(); ++i) (*out)[i].world = worlds[i];
    return out;
  }();
  return *all;
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> out;
  for (size_t i = 0; i < subjects().size(); ++i) {
    subjects()[i].ready();
    out.push_back(with_pick(i, subjects()[i].state));
  }
  return out;
}
void whole(unsigned char* data, size_t size) {
  if (size > 1) mend(data + 1, size - 1);
}
size_t fixed_bytes() {
  return 1 + kFileHead;
}

void one(const unsigned char* data, size_t size) {
  if (size == 0) return;
  Subject& s = subjects()[pick(data, size, subjects().size())];
  s.ready();
  const rdm_result r = rdm_pool_read_state(s.pool.handle, -1, data + 1, size - 1);
  if (r != RDM_OK) {
    require_refusal(r);
    static unsigned n = 0;
    if (++n % 16 == 0)
      HARD_REQUIRE(s.pool.state() == s.state, "%s: a state that was refused changed the world",
                   s.world.name().c_str());
    return;
  }
  const char* bad = s.pool.broken_row();
  HARD_REQUIRE(!bad, "%s: %s is out of its bounds after set_state", s.world.name().c_str(), bad);
  for (uint32_t i = 0; i < (s.world.engine.empty() ? 3u : 1u); ++i) {
    s.pool.fill_actions(i);
    const rdm_result step = rdm_pool_step(s.pool.handle);
    if (step != RDM_OK) {
      require_refusal(step);
      break;
    }
    bad = s.pool.broken_row();
    HARD_REQUIRE(!bad, "%s: %s is out of its bounds", s.world.name().c_str(), bad);
  }
  HARD_REQUIRE(rdm_pool_read_state(s.pool.handle, -1, s.state.data(), s.state.size()) == RDM_OK, "%s",
               rdm_last_error());
}

}  // namespace hard
