// Counter-based random streams (Philox 4x32-10): one per (seed, world, purpose).
//
// A draw depends on nothing but the stream's name and its counter, so worlds may run on any thread in any
// order, and 24 bytes save a stream.
#pragma once
#include <cmath>
#include <cstdint>

#include "base/elementary.hpp"

namespace rdm {

// What a stream is for; the values are part of the saved state and frozen.
enum class Purpose : uint32_t {
  kReset = 1,         // start poses and goals of a world
  kPolicyNoise = 2,   // exploration of a world's actions
  kMinibatch = 3,     // shuffling
  kInit = 4,          // network weights
  kRandomPolicy = 5,  // uniform actions of the `random` baseline
  kSense = 6,         // sampling of point clouds
  kTest = 7,
  kWorldNoise = 8,   // what a world draws within an episode
  kDisturbance = 9,  // noise, delays and drop-out of what an agent sees and does
  kStart = 10,       // whether and where in a recording an episode begins
  kImitation = 11,   // rows of a recording beside a minibatch
  kClone = 12,       // what is held back for validation, and shuffling
  kCamera = 13,      // where an episode's cameras stand
  kShield = 14,      // noise of what a shield tries in the place of an action
  kShieldDraw = 15,  // what a shield's copies draw where it does not know its worlds
  kTurns = 16,       // the order in which the groups of a team learn
};

class Stream {
 public:
  Stream() = default;
  Stream(uint64_t seed, uint32_t world, Purpose purpose)
      : seed_(seed), world_(world), purpose_(static_cast<uint32_t>(purpose)) {}

  uint64_t next() {
    uint32_t out[4];
    block(counter_++, out);
    return (static_cast<uint64_t>(out[1]) << 32) | out[0];
  }
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }  // [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double signed_unit() { return 2 * uniform() - 1; }  // [-1, 1)
  // `count` times signed_unit(), the same numbers, several at a time.
  void signed_units(float* out, int count);
  // Unbiased to 2^-32 for n < 2^32.
  uint32_t below(uint32_t n) { return static_cast<uint32_t>(((next() >> 32) * n) >> 32); }
  // `count` standard normals; one block of the cipher gives two (Box-Muller).
  void normals(float* out, int count) {
    for (int i = 0; i < count; i += 2) {
      uint32_t u[4];
      block(counter_++, u);
      const double a = (static_cast<double>(u[0]) + 0.5) * 0x1p-32;
      const double b = static_cast<double>(u[1]) * (6.283185307179586 * 0x1p-32);
      const double r = std::sqrt(-2 * elementary::log(a));
      const elementary::SinCos turn = elementary::sincos(b);
      out[i] = static_cast<float>(r * turn.cos);
      if (i + 1 < count) out[i + 1] = static_cast<float>(r * turn.sin);
    }
  }
  uint64_t counter() const { return counter_; }
  uint32_t world() const { return world_; }

 private:
  static constexpr uint32_t kM0 = 0xD2511F53u, kM1 = 0xCD9E8D57u, kW0 = 0x9E3779B9u, kW1 = 0xBB67AE85u;
  static constexpr int kRounds = 10;
  // Eight of signed_units, with the keys of all rounds; for processors with AVX2.
  void chunk(uint64_t counter, const uint32_t* keys, float* out) const;
  void block(uint64_t counter, uint32_t out[4]) const {
    uint32_t c0 = static_cast<uint32_t>(counter), c1 = static_cast<uint32_t>(counter >> 32);
    uint32_t c2 = world_, c3 = purpose_;
    uint32_t k0 = static_cast<uint32_t>(seed_), k1 = static_cast<uint32_t>(seed_ >> 32);
    for (int i = 0; i < kRounds; ++i) {
      const uint64_t p0 = uint64_t{kM0} * c0, p1 = uint64_t{kM1} * c2;
      const uint32_t n0 = static_cast<uint32_t>(p1 >> 32) ^ c1 ^ k0;
      const uint32_t n2 = static_cast<uint32_t>(p0 >> 32) ^ c3 ^ k1;
      c1 = static_cast<uint32_t>(p1);
      c3 = static_cast<uint32_t>(p0);
      c0 = n0;
      c2 = n2;
      k0 += kW0;
      k1 += kW1;
    }
    out[0] = c0, out[1] = c1, out[2] = c2, out[3] = c3;
  }
  uint64_t seed_ = 0, counter_ = 0;
  uint32_t world_ = 0, purpose_ = 0;
};

}  // namespace rdm
