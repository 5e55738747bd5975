// One world played from the seed, and pictures of it: the same episode each time.
#pragma once
#include "draw/image.hpp"
#include "play/actor.hpp"
#include "play/trouble.hpp"

namespace tool {

class Scene {
 public:
  // Usage with the nearest name when the pool has no such camera. With `cloud` pictures are twice as high:
  // below is the cloud that the last decision was made on, by the same camera; Usage when there is none, or
  // the camera rides on a robot.
  Scene(const PoolSettings& settings, const ActorChoice& choice, std::string camera, int32_t width,
        int32_t height, bool cloud = false);
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
  std::string camera_;
  std::optional<rdm_camera_info> cloud_;  // that looks at clouds, where they are wanted
  int32_t width_, height_, step_ = 0, frames_ = 0;
  double seconds_ = 0;
  bool intervened_ = false;  // since the last picture
};

// `moments` pictures at even distances from step `first` to step `last`, side by side.
Image draw_strip(Scene& scene, int32_t moments, int32_t first, int32_t last);
// The step at which the episode ends, or `to` if that is sooner (-1: never).
int32_t last_step(Scene scene, int32_t to);

}  // namespace tool
