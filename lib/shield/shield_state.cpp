// A shield's state as bytes: plans, streams, counts and the host's guards, with what says whose they are; behind them, in
// a section that the first states did not have, which decisions were seen last and what backups remember of them.
#include <cmath>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "shield/shield.hpp"

namespace rdm {
namespace {

constexpr char kStateMagic[8] = {'R', 'D', 'M', 'S', 'H', 'L', 'D', '1'};
constexpr uint32_t kStateVersion = 1;

}  // namespace

uint64_t Shield::fingerprint() const {
  const Vector<char> lines = options_.lines();
  uint64_t hash = hash_bytes(lines.data(), lines.size() - 1);
  hash = hash_bytes(budget_, static_cast<size_t>(costs_) * sizeof *budget_, hash);
  const int32_t sizes[] = {n_, dim_, stride_, length_, num_policies_};
  hash = hash_bytes(sizes, sizeof sizes, hash);
  for (int32_t p = 0; p < num_policies_; ++p)
    if (const int32_t dim = memory_[p].dim()) hash = hash_bytes(&dim, sizeof dim, hash);
  hash = guards_.hash(hash);
  return hash_bytes(&layout_, sizeof layout_, hash);
}

void Shield::write_state(Writer& out) const {
  const HostScope scope(hooks_);
  out.begin_file(kStateMagic, kStateVersion);
  out.begin_section("HEAD");
  out.value(fingerprint());
  out.end_section();
  out.begin_section("GARD");
  guards_.write(out);
  out.end_section();
  out.begin_section("PLAN");
  out.value(counts_);
  for (int32_t i = 0; i < n_; ++i) {
    Plan p = plans_[i];
    p.course = 0;  // of this process's pool
    p.adopt = 0;
    out.value(p);
    out.value(rows_[i]);
    out.value(noise_[i]);
    out.value(drawn_[i]);
    out.bytes(own_ + row_of(i), row_of(1) * sizeof *own_);
    out.bytes(refused_ + row_of(i), row_of(1) * sizeof *refused_);
    out.bytes(plan_ + plan_of(i), row_of(p.length) * sizeof *plan_);
  }
  out.end_section();
  out.begin_later_section("SEEN");
  for (int32_t i = 0; i < n_; ++i) {
    out.value(seen_[i].episode);
    out.value(seen_[i].step);
  }
  for (int32_t p = 0; p < num_policies_; ++p)
    for (const float* states : {memory_[p].before, memory_[p].after})
      out.bytes(states, memory_[p].size(n_) * sizeof *states);
  out.end_section();
  out.end_file();
}

void Shield::read_state(const void* bytes, size_t size) {
  const HostScope scope(hooks_);
  Reader in(bytes, size, "shield state");
  in.begin_file(kStateMagic, kStateVersion);
  in.need_whole_tags("HEADGARDPLAN");
  in.need_section("HEAD");
  if (in.value<uint64_t>() != fingerprint())
    fail(Code::kFormat,
         "shield state: it belongs to a shield with another task, other sizes or other options");
  in.expect_end();
  in.need_section("GARD");
  Reader guards = in;
  bool good = guards_.check(in);
  in.expect_end();
  in.need_section("PLAN");
  Reader look = in;
  const auto count = look.value<ShieldCounts>();
  for (const int64_t x : {count.decisions, count.inquiries, count.failed, count.changed, count.planned,
                          count.unproven, count.copied, count.projected})
    good &= x >= 0;
  const auto numbers = [&](int32_t rows) {
    for (size_t j = 0; j < row_of(rows); ++j) good &= std::isfinite(look.value<float>());
  };
  for (int32_t i = 0; i < n_; ++i) {
    const auto p = look.value<Plan>();
    good &= p.length >= 0 && p.length <= length_ && p.begin >= 0 && p.block >= 0 && p.block <= length_ &&
            p.refused >= -1 && p.refused < std::max(p.length, 1) && p.backup >= -1 && p.backup <= num_own_ &&
            p.column >= -1 && p.column < costs_ && p.dirty <= 1 && p.kept <= 1 && p.adopt == 0 &&
            p.course == 0;
    const auto r = look.value<ShieldRow>();
    good &= r.kind >= ShieldKind::kOwn && r.kind <= ShieldKind::kProjected && r.column >= -1 &&
            r.column < costs_ && r.backup >= -1 && r.backup <= num_own_;
    look.value<Stream>();
    look.value<Stream>();
    if (!good) break;
    numbers(2 + p.length);
  }
  Reader memory = in;
  const bool has_seen = memory.find_later_section("SEEN");
  Reader numbers_in = memory;
  for (int32_t i = 0; has_seen && i < n_; ++i) {
    numbers_in.value<uint64_t>();
    good &= numbers_in.value<int32_t>() >= -1;
  }
  for (int32_t p = 0; has_seen && p < num_policies_; ++p)
    for (size_t j = 0; j < 2 * memory_[p].size(n_); ++j) good &= std::isfinite(numbers_in.value<float>());
  if (has_seen) numbers_in.expect_end();
  if (!good) fail(Code::kFormat, "shield state: a number is out of range");
  look.expect_end();
  guards_.read(guards);
  counts_ = in.value<ShieldCounts>();
  for (int32_t i = 0; i < n_; ++i) {
    plans_[i] = in.value<Plan>();
    plans_[i].adopt = 1;
    rows_[i] = in.value<ShieldRow>();
    noise_[i] = in.value<Stream>();
    drawn_[i] = in.value<Stream>();
    in.bytes(own_ + row_of(i), row_of(1) * sizeof *own_);
    in.bytes(refused_ + row_of(i), row_of(1) * sizeof *refused_);
    in.bytes(plan_ + plan_of(i), row_of(plans_[i].length) * sizeof *plan_);
    seen_[i] = {};
    if (!has_seen) continue;
    seen_[i].episode = memory.value<uint64_t>();
    seen_[i].step = memory.value<int32_t>();
  }
  for (int32_t p = 0; has_seen && p < num_policies_; ++p)
    for (float* states : {memory_[p].before, memory_[p].after})
      memory.bytes(states, memory_[p].size(n_) * sizeof *states);
}

}  // namespace rdm
