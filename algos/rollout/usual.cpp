#include "algos/rollout/usual.hpp"

#include <algorithm>
#include <numeric>

#include "base/bit_cast.hpp"

namespace rdm {
namespace {

// A float's exponent and the first four bits behind it are the bin; from 2^-10 to 2^22.
constexpr int32_t kBins = 512, kShift = 19, kFirst = (127 - 10) << 4;
constexpr size_t kCounts = 2 * kBins;
constexpr double kRows = 1000, kMostRows = 1e15;

int32_t bin_of(float x) {
  return std::clamp((bit_cast<int32_t>(x) >> kShift) - kFirst, 0, kBins - 1);
}
float end_of(int32_t bin) {
  return bit_cast<float>((bin + 1 + kFirst) << kShift);
}

float exceeded_by_few(const double* counts, double rows) {
  double above = 0;
  int32_t bin = kBins - 1;
  while (bin > 0 && (above += counts[bin]) <= rows / kRows) --bin;
  return end_of(bin);
}

double rows_in(const double* counts) {
  return std::accumulate(counts, counts + kBins, 0.0);
}

}  // namespace

void UsualRows::carve(Arena& arena, size_t envs) {
  seen_ = arena.make<Novelty>(envs);
  for (double** counts : {&counts_, &before_}) *counts = arena.make<double>(kCounts);
}

void UsualRows::count(const Novelty& novelty) {
  ++counts_[bin_of(novelty.rms)];
  ++counts_[kBins + bin_of(novelty.largest)];
}

void UsualRows::drop() {
  std::fill_n(counts_, kCounts, 0.0);
}

void UsualRows::close(Ranks& ranks) {
  ranks.fold(counts_, kCounts, [](double* a, const double* b) {
    for (size_t i = 0; i < kCounts; ++i) a[i] += b[i];
  });
  settle();
}

void UsualRows::close_alone() {
  set({});
  settle();
}

void UsualRows::settle() {
  for (size_t i = 0; i < kCounts; ++i) before_[i] += counts_[i];
  drop();
  const double rows = rows_in(before_);
  if (rows < kRows) return;
  known_ = {exceeded_by_few(before_, rows), exceeded_by_few(before_ + kBins, rows)};
  std::fill_n(before_, kCounts, 0.0);
}

void UsualRows::set(const Novelty& known) {
  known_ = known;
  if (before_) std::fill_n(before_, kCounts, 0.0);
}

// Of a state where there is something to say: those of before have no such section.
void UsualRows::visit(StateIo& io) {
  int64_t known = known_.rms > 0, counted = before_ && rows_in(before_) > 0;
  if (!io.later_section("USUA", known || counted)) return;
  io.require(before_, "rows of an agent without normalize_obs");
  const double least = static_cast<double>(end_of(0)), most = static_cast<double>(end_of(kBins - 1));
  if (io.integer(known, 0, 1))
    for (float* x : {&known_.rms, &known_.largest}) io.numbers(x, 1, least, most);
  if (io.integer(counted, 0, 1)) io.numbers(before_, kCounts, 0, kMostRows);
}

}  // namespace rdm
