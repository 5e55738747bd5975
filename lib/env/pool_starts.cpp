// Episodes that begin at the states of a recording.
//
// The reset comes first, with all that it draws, so that other episodes are what they are without; then the
// world, the task's struct, the disturbances' memory and the observation become those of the record. Streams
// stay the world's own, and its sums begin at 0; the step is the record's, so the episode has what is left.
#include <cstring>

#include "base/bytes.hpp"
#include "env/pool_internal.hpp"

namespace rdm {

void Pool::set_starts(const unsigned char* states, size_t state_bytes, int64_t count, uint64_t mark,
                      double share) {
  const FpMode mode;
  Impl& m = *impl_;
  const HostScope scope(m.config.hooks);
  if (!(share >= 0 && share <= 1)) fail(Code::kRange, "share: %g is outside [0, 1]", share);
  if (share > 0 && (count < 0 ? m.starts.count : count) == 0)
    fail(Code::kArgument, "share: it is %g, but there are no recorded states to start from", share);
  if (count < 0) {
    m.starts.share = share;
    return;
  }
  Starts next;
  next.count = count, next.mark = mark, next.share = share;
  int64_t i = 0;
  try {
    for (; i < count; ++i) {
      Reader in(states + static_cast<size_t>(i) * state_bytes, state_bytes, "state");
      m.open_state(in, 1);
      const size_t size = in.left();
      const unsigned char* record = in.view(size);
      Reader world(record, size, "state");
      if (m.check_world(world) != Phase::kRunning)
        fail(Code::kFormat, "state: it does not belong to a running episode");
      world.expect_end();
      if (i == 0) next.record_bytes = size, next.records.reserve(static_cast<size_t>(count) * size);
      next.records.insert(next.records.end(), record, record + size);
    }
  } catch (const Error& e) {
    fail(e.code, "state %lld of the recording: %s", static_cast<long long>(i), e.text);
  }
  m.starts = std::move(next);
}

bool Pool::Impl::begin_at_start(int32_t env) {
  Slot& s = slots[env];
  if (!(s.start.uniform() < starts.share)) return false;
  const size_t at = s.start.below(static_cast<uint32_t>(starts.count));
  Reader in(starts.records.data() + at * starts.record_bytes, starts.record_bytes, "state");
  const Episode own = s.episode;
  read_world(env, in, true);
  const int32_t step = s.episode.step;
  s.episode = own;
  s.episode.step = step;
  return true;
}

}  // namespace rdm
