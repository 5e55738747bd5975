#include "nn/actor.hpp"

#include <algorithm>
#include <cmath>

#include "base/bit_cast.hpp"
#include "base/elementary.hpp"
#include "base/error.hpp"
#include "base/hash.hpp"

namespace rdm {
namespace {

constexpr char kMagic[8] = {'R', 'D', 'M', 'A', 'C', 'T', 'O', 'R'};
constexpr uint32_t kVersion = 1;
constexpr int32_t kMostWorlds = 65536;

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}

// SplitMix64's finalizer, of a counter.
uint64_t mixed(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

double uniform(uint64_t& stream) {
  return (static_cast<double>(mixed(stream++) >> 11) + 0.5) * 0x1p-53;
}

// Standard normal by Box and Muller: sqrt(-2 ln u) cos(2 pi v).
float normal(uint64_t& stream) {
  const double radius = std::sqrt(-2 * elementary::log(uniform(stream)));
  const double angle = 2 * 3.14159265358979323846 * uniform(stream);
  return static_cast<float>(radius * elementary::cos(angle));
}

void check(const ActorConfig& c) {
  if (c.num_envs < 1 || c.num_envs > kMostWorlds)
    fail(Code::kRange, "num_envs: %d is outside [1, %d]", c.num_envs, kMostWorlds);
  const int32_t decision = c.policy->view().action_repeat;
  if (c.repeat < 1) fail(Code::kRange, "action_repeat: %d is less than 1", c.repeat);
  if (decision % c.repeat)
    fail(Code::kArgument,
         "action_repeat: the policy decides every %d control steps, which is not a multiple of a step of %d "
         "of them",
         decision, c.repeat);
  for (int32_t k = 0; c.center && k < c.policy->view().action_dim(); ++k)
    if (!(std::abs(c.center[k]) <= 1))
      fail(Code::kRange, "center: entry %d is %g, which is outside [-1, 1]", k,
           static_cast<double>(c.center[k]));
}

}  // namespace

void need_finite_row(const float* row, size_t width, const char* name, size_t number) {
  uint32_t largest = 0;  // of the magnitudes, which order as their bits do
  for (size_t k = 0; k < width; ++k) largest = std::max(largest, bit_cast<uint32_t>(row[k]) & 0x7fffffffu);
  if (largest >= 0x7f800000u) fail(Code::kArgument, "%s: row %zu is not finite", name, number);
}

void Actor::carve(Arena& arena) {
  const PolicyView& v = policy_->view();
  const size_t n = sz(num_envs_), width = sz(v.action_dim()), cloud = v.eyes.points ? sz(v.eyes.points) : 0;
  left_ = arena.make<int32_t>(n);
  fresh_ = arena.make<uint8_t>(n);
  held_ = arena.make<float>(n * width);
  memory_ = arena.make<float>(stochastic_ ? n * width : 0);
  center_ = arena.make<float>(width);
  state_ = arena.make<float>(n * sz(v.state_dim()));
  due_ = arena.make<int32_t>(n);
  due_state_ = arena.make<float>(n * sz(v.state_dim()));
  obs_ = arena.make<float>(n * sz(v.obs_dim()));
  action_ = arena.make<float>(n * width);
  noise_ = arena.make<float>(stochastic_ ? n * width : 0);
  points_ = arena.make<float>(n * 3 * cloud);
  classes_ = arena.make<uint8_t>(v.eyes.classes ? n * cloud : 0);
  colors_ = arena.make<uint8_t>(v.eyes.color ? n * 3 * cloud : 0);
  scratch_ = arena.make<unsigned char>(policy_->scratch_bytes(num_envs_));
}

size_t Actor::memory(const ActorConfig& config) {
  check(config);
  Actor sizes;
  sizes.policy_ = config.policy;
  sizes.num_envs_ = config.num_envs;
  sizes.stochastic_ = config.stochastic;
  Arena measure;
  sizes.carve(measure);
  return measure.used() + sizeof(Actor);
}

Actor* Actor::create(const ActorConfig& config) {
  const size_t bytes = memory(config) - sizeof(Actor);
  Arena arena(config.hooks, bytes);
  Actor* a = host_new<Actor>(config.hooks);
  a->hooks_ = config.hooks;
  a->policy_ = config.policy;
  a->num_envs_ = config.num_envs;
  a->hold_ = config.policy->view().action_repeat / config.repeat;
  a->stochastic_ = config.stochastic;
  a->stream_ = mixed(config.seed);
  a->carve(arena);
  a->arena_ = std::move(arena);
  if (config.center) std::copy_n(config.center, config.policy->view().action_dim(), a->center_);
  a->reset(nullptr, nullptr);
  return a;
}

void Actor::destroy(Actor* a) {
  if (a) host_delete(a->hooks_, a);
}

void Actor::reset(const uint8_t* first, const uint8_t* second) {
  const bool all = !first && !second;
  const size_t memory = sz(policy_->view().state_dim());
  for (size_t i = 0; i < sz(num_envs_); ++i) {
    if (!all && !(first && first[i]) && !(second && second[i])) continue;
    left_[i] = 0;
    fresh_[i] = 1;
    std::fill_n(state_ + i * memory, memory, 0.0f);
  }
}

// Rows of the worlds that are due, one after the other.
void Actor::gather(const float* obs, const PointRows& clouds) {
  const PolicyView& v = policy_->view();
  const size_t dim = sz(v.obs_dim()), cloud = sz(v.eyes.points), memory = sz(v.state_dim());
  for (size_t k = 0; k < sz(num_due_); ++k) {
    const size_t i = sz(due_[k]);
    need_finite_row(obs + i * dim, dim, "obs", i);
    std::copy_n(obs + i * dim, dim, obs_ + k * dim);
    std::copy_n(state_ + i * memory, memory, due_state_ + k * memory);
    if (!v.eyes.points) continue;
    need_finite_row(clouds.metres + 3 * cloud * i, 3 * cloud, "points", i);
    std::copy_n(clouds.metres + 3 * cloud * i, 3 * cloud, points_ + 3 * cloud * k);
    if (v.eyes.classes) std::copy_n(clouds.classes + cloud * i, cloud, classes_ + cloud * k);
    if (v.eyes.color) std::copy_n(clouds.colors + 3 * cloud * i, 3 * cloud, colors_ + 3 * cloud * k);
  }
}

void Actor::draw_noise() {
  const size_t width = sz(policy_->view().action_dim());
  const float rho = policy_->view().noise_correlation, part = std::sqrt(1 - rho * rho);
  drawn_ = stream_;
  for (size_t k = 0; k < sz(num_due_); ++k) {
    const size_t i = sz(due_[k]);
    for (size_t j = 0; j < width; ++j)
      noise_[k * width + j] =
          fresh_[i] ? normal(drawn_) : rho * memory_[i * width + j] + part * normal(drawn_);
  }
}

// All that can fail comes before what is kept changes.
void Actor::decide() {
  const PolicyView& v = policy_->view();
  const size_t width = sz(v.action_dim()), memory = sz(v.state_dim());
  PointRows clouds;
  if (v.eyes.points) {
    clouds.metres = points_;
    clouds.classes = v.eyes.classes ? classes_ : nullptr;
    clouds.colors = v.eyes.color ? colors_ : nullptr;
    need_channels(v.eyes, clouds, sz(num_due_));
  }
  if (stochastic_) draw_noise();
  policy_->act(obs_, num_due_, stochastic_ ? noise_ : nullptr, action_, scratch_, clouds, due_state_);
  for (size_t k = 0; k < sz(num_due_); ++k)
    need_finite_row(action_ + k * width, width, "action: the network overflows on these observations",
                    sz(due_[k]));
  if (stochastic_) stream_ = drawn_;
  for (size_t k = 0; k < sz(num_due_); ++k) {
    const size_t i = sz(due_[k]);
    for (size_t j = 0; j < width; ++j) held_[i * width + j] = action_[k * width + j] - center_[j];
    if (stochastic_) std::copy_n(noise_ + k * width, width, memory_ + i * width);
    std::copy_n(due_state_ + k * memory, memory, state_ + i * memory);
    left_[i] = hold_;
    fresh_[i] = 0;
  }
}

void Actor::act(const float* obs, const PointRows& clouds, const uint8_t* mask, float* action) {
  const PolicyView& v = policy_->view();
  const size_t width = sz(v.action_dim());
  num_due_ = 0;
  for (int32_t i = 0; i < num_envs_; ++i)
    if ((!mask || mask[i]) && left_[i] == 0) due_[num_due_++] = i;
  if (num_due_ > 0) {
    gather(obs, clouds);
    decide();
  }
  for (size_t i = 0; i < sz(num_envs_); ++i) {
    if (mask && !mask[i]) continue;
    std::copy_n(held_ + i * width, width, action + i * width);
    --left_[i];
  }
}

// Of what the state belongs to.
uint64_t Actor::fingerprint() const {
  const PolicyView& v = policy_->view();
  const int32_t sizes[] = {num_envs_, v.obs_dim(), v.action_dim(), v.action_repeat, hold_, stochastic_};
  const uint64_t plain = hash_bytes(&v.layout_hash, sizeof v.layout_hash, hash_bytes(sizes, sizeof sizes));
  const int32_t memory[] = {v.gru.units, v.history, v.history_width};
  return v.state_dim() ? hash_bytes(memory, sizeof memory, plain) : plain;
}

void Actor::write_state(Writer& out) const {
  const size_t n = sz(num_envs_), rows = n * sz(policy_->view().action_dim());
  out.begin_file(kMagic, kVersion);
  out.begin_section("HEAD");
  out.value(fingerprint());
  out.end_section();
  out.begin_section("HELD");
  out.value(stream_);
  out.bytes(left_, n * sizeof *left_);
  out.bytes(fresh_, n);
  out.bytes(held_, rows * sizeof *held_);
  if (stochastic_) out.bytes(memory_, rows * sizeof *memory_);
  out.bytes(state_, n * sz(policy_->view().state_dim()) * sizeof *state_);
  out.end_section();
  out.end_file();
}

void Actor::read_state(const void* bytes, size_t size) {
  const size_t n = sz(num_envs_), rows = n * sz(policy_->view().action_dim());
  const size_t remembered = n * sz(policy_->view().state_dim());
  Reader in(bytes, size, "actor state");
  in.begin_file(kMagic, kVersion);
  in.need_section("HEAD");
  if (in.value<uint64_t>() != fingerprint())
    fail(Code::kFormat, "actor state: it belongs to an actor with another policy, number of worlds or step");
  in.expect_end();
  in.need_section("HELD");
  const auto stream = in.value<uint64_t>();
  Reader look = in;
  bool good = true;
  for (size_t i = 0; i < n; ++i) {
    const auto left = look.value<int32_t>();
    good &= left >= 0 && left <= hold_;
  }
  for (size_t i = 0; i < n; ++i) good &= look.value<uint8_t>() <= 1;
  for (size_t i = 0; i < rows; ++i) good &= std::abs(look.value<float>()) <= 2;  // about a center
  for (size_t i = 0; stochastic_ && i < rows; ++i) good &= std::isfinite(look.value<float>());
  for (size_t i = 0; i < remembered; ++i) good &= std::isfinite(look.value<float>());
  look.expect_end();
  if (!good) fail(Code::kFormat, "actor state: a number is out of range");
  stream_ = stream;
  in.bytes(left_, n * sizeof *left_);
  in.bytes(fresh_, n);
  in.bytes(held_, rows * sizeof *held_);
  if (stochastic_) in.bytes(memory_, rows * sizeof *memory_);
  in.bytes(state_, remembered * sizeof *state_);
}

}  // namespace rdm
