// A pool that somebody looks at: who acts in it, what was, and what the person does.
//
// What nobody touches goes as it goes without a window: the same states at the same steps as `redman rollout` has.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/json.hpp"
#include "play/actor.hpp"
#include "play/playback.hpp"
#include "record/recorder.hpp"
#include "view/history.hpp"
#include "view/lead.hpp"
#include "view/viewed.hpp"

namespace tool {

struct ViewSettings {
  PoolSettings pool;
  std::vector<std::string> policies;  // words of --policy, the first begins
  std::string shield = "off", record = "demonstration.npz";
  std::vector<std::string> limits;  // of --cost-limit
  size_t history_bytes = size_t{64} << 20;
};

class Session : public Viewed {
 public:
  explicit Session(ViewSettings settings);
  ~Session() override;

  Json command(const Document& asked) override;
  Json scene() const override;
  int64_t scene_number() const override { return scene_number_; }
  std::string frame(int64_t since) const override;
  int64_t at() const override { return at_; }
  int32_t watched_world() const override { return watched_; }
  int64_t changes() const override { return changes_; }

  bool plays() const override { return plays_; }
  void pause() override { plays_ = false; }
  double step_seconds() const override { return static_cast<double>(pool_->spec().control_dt) / speed_; }
  void step() override;  // one of the pool, from the moment that is shown; what came after that is dropped
  int64_t steps() const override { return steps_; }
  void finish() override;
  Json summary() const override;

 private:
  // The mouse holds a point of a shape, and a spring pulls it.
  struct Grab {
    int32_t world = 0, shape = 0;
    double local[3] = {}, to[3] = {};  // m, in the shape's frame, and in the world's
    double newton = 0, reach = 1;      // the most that it pulls, from so many m on
    double force = 0;                  // N, at the last step
    bool leads = false;                // the action brings it there, no spring
  };
  struct Take {  // a demonstration that is being recorded
    std::unique_ptr<Recorder> recorder;
    std::string file;
    size_t episodes = 0;
    int64_t begin = 0;    // moment of the episode's first state
    bool pushed = false;  // in this episode
    bool by_hand = false;
    int32_t dropped = 0;
  };
  void open(const PoolSettings& settings, const std::string& who, bool shield);
  void set_actor(const std::string& who, bool shield);
  void remember();
  void reset(const uint64_t* seed);
  void keep_limit();
  void seek(int64_t moment);
  void leave_past();
  void take_over(bool on);
  void lead();
  void push();
  void begin_next(const std::vector<uint8_t>& ended);
  void begin_take();
  Json end_take();
  void note_step();
  ActorChoice choose(const std::string& who) const;
  size_t watched() const { return static_cast<size_t>(watched_); }

  ViewSettings settings_;
  std::optional<redman::Pool> pool_;
  std::optional<Actor> actor_;
  std::optional<ActorChoice> choice_;
  std::string who_;
  bool shield_ = false;
  std::vector<double> limits_;
  std::array<double, 2> limit_range_ = {-1,
                                        -1};  // between which a person sets the limit; below 0: there is none
  std::optional<double> limit_;               // that a person set, for the next episodes too
  std::vector<std::string> actors_;
  Playback looks_;               // what the shapes look like
  std::vector<int32_t> moving_;  // shapes
  History history_;
  int64_t at_ = 0, changes_ = 0, scene_number_ = 0, steps_ = 0;
  bool plays_ = false, stops_ = false, contacts_ = false;
  double speed_ = 1;
  int32_t watched_ = 0;
  std::vector<float> own_;  // the person's action, of the watched world
  bool by_hand_ = false;
  std::optional<Grab> grab_;
  std::optional<Lead> lead_;
  std::optional<Take> take_;
  int32_t takes_ = 0;
  std::vector<std::string> files_;  // that were written
};

}  // namespace tool
