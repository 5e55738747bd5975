// A saved state of one world, open for tampering: where its parts stand, and checksums that are right again.
#pragma once
#include <redman/redman.h>

#include <cstring>
#include <vector>

#include "base/bytes.hpp"

class StateBytes {
 public:
  // Of world `env` of a pool.
  StateBytes(const rdm_pool* p, int32_t env) {
    size_t size = 0;
    rdm_pool_write_state(p, env, nullptr, 0, &size);
    bytes_.resize(size);
    rdm_pool_write_state(p, env, bytes_.data(), size, &size);
    rdm_spec spec{};
    spec.struct_size = sizeof spec;
    rdm_pool_get_spec(p, &spec);
    rdm::Reader in(bytes_.data(), size, "state");
    in.begin_file("RDMSTATE", 2);
    in.need_section("WRLD");
    size_ = in.left();
    begin_ = static_cast<size_t>(in.view(size_) - bytes_.data());
    uint64_t world_size = 0;
    std::memcpy(&world_size, bytes_.data() + begin_, sizeof world_size);
    world_ = begin_ + sizeof world_size;
    task_ = world_ + world_size;
    obs_ = begin_ + size_ - sizeof(float) * static_cast<size_t>(spec.obs_dim);
    sums_ = obs_ - sizeof(double) * static_cast<size_t>(1 + spec.cost_dim);
    phase_ = sums_ - 10;     // phase and step as int32, two flags
    episode_ = phase_ - 56;  // seed, two streams of 24 bytes
  }

  size_t world() const { return world_; }      // the engine's record
  size_t task() const { return task_; }        // the task's struct, up to episode()
  size_t episode() const { return episode_; }  // seed and streams
  size_t phase() const { return phase_; }
  size_t step() const { return phase_ + 4; }
  size_t terminated() const { return phase_ + 8; }
  size_t truncated() const { return phase_ + 9; }
  size_t sums() const { return sums_; }  // of the reward, then of each cost; double
  size_t obs() const { return obs_; }

  // A copy with other bytes at one place.
  template <class T>
  std::vector<unsigned char> with(size_t at, const T& value) const {
    auto out = bytes_;
    std::memcpy(out.data() + at, &value, sizeof value);
    const uint32_t crc = rdm::crc32(out.data() + begin_, size_);
    std::memcpy(out.data() + begin_ - 12, &crc, sizeof crc);
    return out;
  }
  const std::vector<unsigned char>& bytes() const { return bytes_; }

 private:
  std::vector<unsigned char> bytes_;
  size_t begin_ = 0, size_ = 0, world_ = 0, task_ = 0, episode_ = 0, phase_ = 0, sums_ = 0, obs_ = 0;
};
