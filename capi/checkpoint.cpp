// Checkpoints: agent, pool and a note of the host's in one file.

#include "base/file.hpp"
#include "capi/handles.hpp"

#if RDM_WITH_LEARN
using namespace rdm;
using namespace rdm::capi;

namespace {

constexpr char kCheckpointMagic[8] = {'R', 'D', 'M', 'C', 'H', 'E', 'C', 'K'};
constexpr uint32_t kCheckpointVersion = 1;
constexpr size_t kMaxNote = 1u << 29;  // bytes

template <class F>
void section(Writer& w, const char tag[4], F&& body) {
  w.begin_section(tag);
  body(w);
  w.end_section();
}

// The pool's part; a build without the simulation half has none to save.
#if RDM_WITH_SIM
template <class Pool>
class PoolUse {
 public:
  explicit PoolUse(Pool* p) : use_(p) {}

 private:
  UseIfAny<Pool> use_;
};
void save_pool(const rdm_pool* p, Writer& out) {
  p->pool->get_state(-1, out);
}
void load_pool(rdm_pool* p, const void* bytes, size_t size) {
  p->pool->set_state(-1, bytes, size);
}
#else
struct PoolUse {
  explicit PoolUse(const rdm_pool*) {}
};
void save_pool(const rdm_pool*, Writer&) {
  left_out("simulation");
}
void load_pool(rdm_pool*, const void*, size_t) {
  left_out("simulation");
}
#endif

// Of the pools of all ranks, whose agents all call; none of one process alone.
#if RDM_WITH_SIM
Vector<unsigned char> join_pools(Agent& agent, const rdm_pool* p) {
  Ranks& ranks = agent.ranks();
  if (!p || ranks.alone()) return {};
  Writer count(nullptr, 0);
  save_pool(p, count);
  const auto n = static_cast<size_t>(ranks.count());
  Vector<uint64_t> sizes(n);
  const uint64_t size = count.size();
  ranks.gather(&size, sizeof size, sizes.data());
  const size_t most = static_cast<size_t>(*std::max_element(sizes.begin(), sizes.end()));
  Vector<unsigned char> own(most), all(n * most);
  Writer out(own.data(), own.size());
  save_pool(p, out);
  ranks.gather(own.data(), most, all.data());
  Vector<Pool::StateBytes> parts(n);
  for (size_t r = 0; r < n; ++r) parts[r] = {all.data() + r * most, static_cast<size_t>(sizes[r])};
  Writer joined(nullptr, 0);
  Pool::join_states(parts.data(), ranks.count(), joined);
  Vector<unsigned char> state(joined.size());
  Writer to(state.data(), state.size());
  Pool::join_states(parts.data(), ranks.count(), to);
  return state;
}
#else
Vector<unsigned char> join_pools(Agent&, const rdm_pool*) {
  return {};
}
#endif

// What a file may have that is this agent's and this pool's, or those of another configuration like it.
FileLimits file_limits(const rdm_agent* a, const rdm_pool* p) {
  Writer count(nullptr, 0);
  const bool counted = guard([&] { a->agent->save(count); }) == Code::kOk;  // not inside a horizon
  if (p) save_pool(p, count);
  const auto ranks = static_cast<size_t>(a->agent->ranks().count());
  const size_t states = ranks * count.size() + (counted ? 0 : size_t{1} << 28);
  return {{kCheckpointMagic, sizeof kCheckpointMagic}, kFileLengthAt, 2 * (kMaxNote + states)};
}

void write_checkpoint(Writer& w, const Agent& agent, const rdm_pool* pool, const Vector<unsigned char>& pools,
                      const void* note, size_t note_size) {
  w.begin_file(kCheckpointMagic, kCheckpointVersion);
  section(w, "AGNT", [&](Writer& s) { agent.save(s); });
  if (!pools.empty())
    section(w, "POOL", [&](Writer& s) { s.bytes(pools.data(), pools.size()); });
  else if (pool)
    section(w, "POOL", [&](Writer& s) { save_pool(pool, s); });
  section(w, "NOTE", [&](Writer& s) { s.bytes(note, note_size); });
  w.end_file();
}

}  // namespace

rdm_result rdm_checkpoint_write(const char* path, const rdm_agent* a, const rdm_pool* p, const void* note,
                                size_t note_size) {
  return call_on(a, [&] {
    need(path, "path");
    const PoolUse use(p);
    if (note_size) need(note, "note");
    if (note_size > kMaxNote) fail(Code::kRange, "note_size: %zu is above %zu", note_size, kMaxNote);
    const auto pools = join_pools(*a->agent, p);
    Writer count(nullptr, 0);
    write_checkpoint(count, *a->agent, p, pools, note, note_size);
    Vector<unsigned char> file(count.size());
    Writer out(file.data(), file.size());
    write_checkpoint(out, *a->agent, p, pools, note, note_size);
    if (a->agent->ranks().rank() == 0) write_file(path, file.data(), file.size());
  });
}

rdm_result rdm_checkpoint_read(const char* path, rdm_agent* a, rdm_pool* p, void* note, size_t capacity,
                               size_t* note_size) {
  return call_on(a, [&] {
    need(path, "path");
    const PoolUse use(p);
    need(note_size, "note_size");
    if (capacity) need(note, "note");
    const auto file = read_file(path, file_limits(a, p));
    Reader in(file.data(), file.size(), "checkpoint");
    in.begin_file(kCheckpointMagic, kCheckpointVersion);
    in.need_section("NOTE");
    const size_t size = in.left();
    const void* note_bytes = in.view(size);
    in.need_section("AGNT");
    const size_t agent_size = in.left();
    const void* agent_bytes = in.view(agent_size);
    a->agent->check_state(agent_bytes, agent_size);
    if (p) {  // changes nothing when it fails; what comes after it cannot fail any more
      in.need_section("POOL");
      const size_t pool_size = in.left();
      load_pool(p, in.view(pool_size), pool_size);
    }
    a->agent->load(agent_bytes, agent_size);
    *note_size = size;
    if (const size_t n = std::min(capacity, size)) std::memcpy(note, note_bytes, n);
  });
}
#endif
