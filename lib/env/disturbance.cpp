#include "env/disturbance.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"

namespace rdm {
namespace {

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}
int32_t ring_size(const OptionRange& delay) {
  return static_cast<int32_t>(delay.high) + 1;
}

// The numbers of one field, null where it has no such disturbance.
struct FieldNumbers {
  float *noise = nullptr, *bias = nullptr;     // deviation; [count] offsets
  float *delay = nullptr, *ring = nullptr;     // steps; [ring_size][count] what the last steps were
  float *dropout = nullptr, *shown = nullptr;  // probability; [count]
};

// Takes them from `at`, which moves behind them.
template <class At>
FieldNumbers cut(const FieldDisturbance& f, At&& take) {
  FieldNumbers n;
  if (f.noise.high > 0) n.noise = take(1);
  if (f.bias.high > 0) n.bias = take(f.count);
  if (f.delay.high > 0) n.delay = take(1), n.ring = take(ring_size(f.delay) * f.count);
  if (f.dropout.high > 0) n.dropout = take(1), n.shown = take(f.count);
  return n;
}

struct Cursor {
  float* at;
  float* operator()(int32_t count) {
    float* const begin = at;
    at += count;
    return begin;
  }
};

void add_noise(Stream& stream, float deviation, float* x, int32_t count) {
  constexpr int32_t kChunk = 64;
  float n[kChunk];
  for (int32_t first = 0; first < count; first += kChunk) {
    const int32_t some = std::min(kChunk, count - first);
    stream.normals(n, some);
    for (int32_t i = 0; i < some; ++i) x[first + i] += deviation * n[i];
  }
}

// A ring of rows of `count`: keeps x as that of `step`, gives that of `delay` steps before.
void pass_ring(float* ring, int32_t size, int32_t count, int32_t now, int32_t then, float* x) {
  const size_t bytes = sz(count) * sizeof *x;
  std::memcpy(ring + sz(now % size) * sz(count), x, bytes);
  std::memcpy(x, ring + sz(then % size) * sz(count), bytes);
}

void require(bool good) {
  if (!good) fail(Code::kFormat, "state: a disturbance is outside of what its options allow");
}
bool within(const OptionRange& range, float x) {
  return x >= static_cast<float>(range.low) && x <= static_cast<float>(range.high);
}
bool steps_within(const OptionRange& range, float x) {
  return within(range, x) && x == std::floor(x);
}
bool finite(const float* x, int32_t count) {
  return std::all_of(x, x + count, [](float v) { return std::isfinite(v); });
}

}  // namespace

void WorldDisturbance::carve(Arena& arena, const Disturbance& plan, const Task& task) {
  count_ = 0;
  const auto count = [&](int32_t n) -> float* {
    count_ += n;
    return nullptr;
  };
  for (const FieldDisturbance& f : plan.fields) cut(f, count);
  if (plan.delays_actions()) count(1 + ring_size(plan.action_delay) * task.action_dim());
  if (count_ > 0) numbers_ = arena.make<float>(sz(count_));
}

void WorldDisturbance::begin(const Disturbance& plan, const Task& task) {
  std::fill_n(numbers_, count_, 0.0f);
  Cursor at{numbers_};
  for (const FieldDisturbance& f : plan.fields) {
    const FieldNumbers n = cut(f, at);
    if (n.noise) *n.noise = static_cast<float>(f.noise.draw(stream_));
    if (n.bias) {
      const double half = f.bias.draw(stream_);
      for (int32_t i = 0; i < f.count; ++i) n.bias[i] = static_cast<float>(half * stream_.signed_unit());
    }
    if (n.delay) *n.delay = static_cast<float>(f.delay.draw_integer(stream_));
    if (n.dropout) *n.dropout = static_cast<float>(f.dropout.draw(stream_));
  }
  if (!plan.delays_actions()) return;
  *at(1) = static_cast<float>(plan.action_delay.draw_integer(stream_));
  const int32_t dim = task.action_dim();
  for (int32_t k = 0; k < ring_size(plan.action_delay); ++k) task.hold_action(at(dim));
}

void WorldDisturbance::show(const Disturbance& plan, int32_t step, float* row) {
  Cursor at{numbers_};
  for (const FieldDisturbance& f : plan.fields) {
    const FieldNumbers n = cut(f, at);
    float* x = row + f.offset;
    if (n.delay) {
      const int32_t then = std::max(step - static_cast<int32_t>(*n.delay), 0);
      pass_ring(n.ring, ring_size(f.delay), f.count, step, then, x);
    }
    if (n.bias)
      for (int32_t i = 0; i < f.count; ++i) x[i] += n.bias[i];
    if (n.noise) add_noise(stream_, *n.noise, x, f.count);
    for (int32_t i = 0; i < f.count; ++i) {  // a bound that is NaN holds nothing
      if (x[i] < f.low) x[i] = f.low;
      if (x[i] > f.high) x[i] = f.high;
    }
    if (!n.dropout) continue;
    const bool stays = step > 0 && stream_.uniform() < static_cast<double>(*n.dropout);
    std::memcpy(stays ? x : n.shown, stays ? n.shown : x, sz(f.count) * sizeof *x);
  }
  if (plan.delay_entry < 0) return;
  const OptionRange& range = plan.action_delay;
  const auto delay = static_cast<double>(*at(1));
  row[plan.delay_entry] = static_cast<float>(2 * (delay - range.low) / (range.high - range.low) - 1);
}

void WorldDisturbance::delay_action(const Disturbance& plan, int32_t step, int32_t action_dim,
                                    float* action) {
  const int32_t size = ring_size(plan.action_delay);
  float* ring = numbers_ + count_ - size * action_dim;
  // before the first action was given the ring holds what came before all
  const int32_t then = step + size - static_cast<int32_t>(ring[-1]);
  pass_ring(ring, size, action_dim, step, then, action);
}

void WorldDisturbance::write(Writer& out) const {
  out.value(stream_);
  out.bytes(numbers_, sz(count_) * sizeof *numbers_);
}

void WorldDisturbance::read(Reader& in, bool keep_stream) {
  const auto stream = in.value<Stream>();
  if (!keep_stream) stream_ = stream;
  in.bytes(numbers_, sz(count_) * sizeof *numbers_);
}

void WorldDisturbance::copy(const WorldDisturbance& other) {
  stream_ = other.stream_;
  std::copy_n(other.numbers_, count_, numbers_);
}

void WorldDisturbance::check(const Disturbance& plan) const {
  require(finite(numbers_, count_));
  Cursor at{numbers_};
  for (const FieldDisturbance& f : plan.fields) {
    const FieldNumbers n = cut(f, at);
    require(!n.noise || within(f.noise, *n.noise));
    require(!n.delay || steps_within(f.delay, *n.delay));
    require(!n.dropout || within(f.dropout, *n.dropout));
    const auto half = static_cast<float>(f.bias.high);
    require(!n.bias || std::all_of(n.bias, n.bias + f.count, [&](float b) { return std::abs(b) <= half; }));
    const auto out = [&](float x) { return x < f.low || x > f.high; };
    require(!n.shown || std::none_of(n.shown, n.shown + f.count, out));
  }
  if (!plan.delays_actions()) return;
  require(steps_within(plan.action_delay, *at(1)));
  require(std::all_of(at.at, numbers_ + count_, [](float a) { return std::abs(a) <= 1; }));
}

}  // namespace rdm
