// Helpers of the tests of the articulated engine: states as bytes, worlds that share their working memory.
#pragma once
#include <vector>

#include "base/hash.hpp"
#include "base/rng.hpp"
#include "two_hands.hpp"

namespace rdm::test {

inline std::vector<unsigned char> saved(const World& world) {
  Writer count(nullptr, 0);
  world.save(count);
  std::vector<unsigned char> bytes(count.size());
  Writer out(bytes.data(), bytes.size());
  world.save(out);
  return bytes;
}
inline void load(World& world, const std::vector<unsigned char>& bytes) {
  Reader in(bytes.data(), bytes.size(), "state");
  world.load(in);
}
inline uint64_t state_hash(const World& world) {
  const std::vector<unsigned char> bytes = saved(world);
  return hash_bytes(bytes.data(), bytes.size());
}

// Targets anywhere in the joints' ranges.
inline void random_targets(World& world, Stream& random) {
  for (int32_t i = 0; i < world.scene().num_links; ++i) {
    const JointDef& joint = world.scene().link(i).joint;
    world.target()[i] = random.uniform(joint.lower, joint.upper);
  }
}

// Worlds of one arena, the first of them the partner of all others.
class Partners {
 public:
  Partners(SceneDef def, int32_t count) : scene_(make_scene(std::move(def))) {
    Arena measure;
    for (int32_t i = 0; i < count; ++i) World::measure(EngineKind::kArticulated, scene_, measure, i > 0);
    arena_ = Arena(HostHooks{}, measure.used());
    for (int32_t i = 0; i < count; ++i)
      worlds_.push_back(
          World::create(EngineKind::kArticulated, scene_, arena_, HostHooks{}, i ? worlds_[0] : nullptr));
  }
  ~Partners() {
    for (World* world : worlds_) World::destroy(world, HostHooks{});
  }
  Partners(const Partners&) = delete;
  Partners& operator=(const Partners&) = delete;
  World& operator[](int32_t i) { return *worlds_[static_cast<size_t>(i)]; }
  World* const* data() const { return worlds_.data(); }
  int32_t size() const { return static_cast<int32_t>(worlds_.size()); }
  const Arena& arena() const { return arena_; }

 private:
  Scene scene_;
  Arena arena_;
  std::vector<World*> worlds_;
};

}  // namespace rdm::test
