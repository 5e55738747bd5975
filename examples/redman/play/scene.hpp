// Worlds played from the seed, and pictures of them: the same episode each time, that of the first world.
#pragma once
#include "draw/image.hpp"
#include "play/actor.hpp"
#include "play/trouble.hpp"

namespace tool {

struct SceneView {
  std::string camera;
  int32_t width = 0, height = 0;
  bool cloud = false;  // below the picture, the cloud of the last decision
  bool plain = false;  // as observations look
};

class Scene {
 public:
  // Usage with the nearest name when the pool has no such camera. With a cloud pictures are twice as high; Usage
  // when there is none, or the camera rides on a robot. Several worlds stand side by side in one picture.
  Scene(const PoolSettings& settings, const ActorChoice& choice, SceneView view);
  const redman::Pool& pool() const { return pool_; }
  int32_t step() const { return step_; }
  // False, and nothing happens, when the episode is over.
  bool advance();
  void advance_to(int32_t step);
  // By the camera; with a red border where the shield stepped in since the picture before, of the first one in the
  // step that led to it.
  Image picture();
  int32_t frames() const { return frames_; }
  double seconds() const { return seconds_; }  // spent in pictures
  Trouble trouble() const { return trouble_of(pool_); }
  const Shielded* shielded() const { return actor_.shielded(); }  // null: no shield
  // The step that led here is of a decision in which the shield stepped in.
  bool stepped_in() const { return step_ > 0 && shielded() && shielded()->stepped_in(pool_, 0); }

 private:
  redman::Pool pool_;
  Actor actor_;
  SceneView view_;
  std::optional<rdm_camera_info> cloud_;  // that looks at clouds, where they are wanted
  int32_t step_ = 0, frames_ = 0;
  double seconds_ = 0;
  bool intervened_ = false;  // since the last picture
};

// `moments` pictures at even distances from step `first` to step `last`, side by side.
Image draw_strip(Scene& scene, int32_t moments, int32_t first, int32_t last);
// The step at which the episode ends, or `to` if that is sooner (-1: never).
int32_t last_step(Scene scene, int32_t to);

}  // namespace tool
