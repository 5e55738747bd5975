// Worlds of another program that somebody looks at: it sends them as play/feed.hpp says, and is told what windows do.
#pragma once
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "play/feed.hpp"
#include "view/viewed.hpp"

namespace tool {

class Fed : public Viewed {
 public:
  // Reads messages from the file descriptor in a thread of its own. What windows do goes to `say` as lines of JSON, each
  // complete: {"windows": 1, "plays": true, "speed": 1, "steps": 0, "watched": 0, "contacts": false, "push": null,
  // "lead": null, "action": null, "shield": false}. steps: how many single steps were asked for so far; push: [world, shape,
  // x, y, z] N; lead: [world, shape, a point of the shape, where it is to be] m; action: of the watched world; while a point is
  // led, the other program finds it.
  using Say = void (*)(const std::string& line);
  Fed(int descriptor, Say say, size_t history_bytes, bool plays);
  ~Fed() override;

  Json command(const Document& asked) override;
  Json scene() const override;
  int64_t scene_number() const override { return scene_number_; }
  std::string frame(int64_t since) const override;
  int64_t at() const override { return at_; }
  int32_t watched_world() const override { return watched_; }
  int64_t changes() const override { return changes_; }
  bool plays() const override { return false; }
  void pause() override {}
  double step_seconds() const override { return 1; }
  void step() override {}
  int64_t steps() const override { return steps_; }
  Json summary() const override;
  bool listen(size_t windows) override;
  double patience() const override { return windows_ > 0 ? 0.004 : 0.05; }

 private:
  struct Grab {
    int32_t world = 0, shape = 0;
    double local[3] = {}, to[3] = {};  // m, in the shape's frame, and in the world's
    double newton = 0, reach = 1;
    bool leads = false;
    double force = 0;  // N, at the last frame
  };
  struct Inbox {  // that the reading thread fills; it may outlive this object while it waits for bytes
    std::mutex mutex;
    std::deque<FeedMessage> messages;
    std::string trouble;
    bool ended = false;
  };
  static void read(int descriptor, std::shared_ptr<Inbox> inbox);
  void take(FeedMessage&& message);
  const FeedFrame& now() const { return frames_[static_cast<size_t>(at_ - first_)]; }
  int64_t last() const { return first_ + static_cast<int64_t>(frames_.size()) - 1; }
  void tell();
  Json push() const;
  bool leads() const { return grab_ && grab_->leads; }

  Say say_;
  std::string said_;
  size_t most_;
  std::shared_ptr<Inbox> inbox_;
  std::optional<FeedScene> scene_;
  std::deque<FeedFrame> frames_;
  int64_t first_ = 0, at_ = 0, changes_ = 0, scene_number_ = 0, steps_ = 0, asked_ = 0;
  size_t windows_ = 0;
  bool plays_ = true, contacts_ = false, by_hand_ = false, records_ = false, shield_ = false;
  double speed_ = 1;
  int32_t watched_ = 0;
  std::vector<float> own_;
  std::optional<Grab> grab_;
};

}  // namespace tool
