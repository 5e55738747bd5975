// A demonstration at work: phases end on time or on what is observed, entries go to values or follow
// observations, palms go to places.
#pragma once
#include <string>
#include <vector>

#include "demo/hand.hpp"
#include "demo/script.hpp"

namespace tool {

// A script at work in the worlds of one pool.
class Demo {
 public:
  // Failure when the script names an entry, a field or a point that the pool has not, or a place for a hand
  // that no arm carries.
  Demo(const DemoScript& script, redman::Pool& pool);
  void restart(const uint8_t* mask);
  // Fills the action rows of the worlds in the mask. Failure for a place that an arm does not reach.
  void act(redman::Pool& pool, const uint8_t* mask);

 private:
  struct Command {
    std::vector<int32_t> entries;
    std::vector<float> values;  // per entry
    bool follows;
    double at, over, gain, limit, offset;
    int32_t measured, aim;  // observation entries, aim -1: none
    size_t memory;          // first of its places in World::from
    bool turns = false;     // measures an angle: the error is the shorter way round
  };
  struct Condition {
    int32_t entry;
    bool below;
    float value;
  };
  struct Motion {
    size_t hand;
    int32_t finger;  // -1: the palm
    Place to;
    bool turned;
    double at, over;
    size_t memory;  // its place in World::starts
    int line;
  };
  struct Phase {
    double seconds;
    std::vector<Condition> until;
    std::vector<Command> commands;
    std::vector<Motion> motions;
  };
  struct World {
    size_t phase = 0;
    int32_t step = 0;              // control steps into the phase
    std::vector<float> value;      // [action_dim] held
    std::vector<float> from;       // where linear changes began
    std::vector<Place> starts;     // where motions began
    std::vector<uint8_t> started;  // flags
  };
  bool over(const Phase& phase, const World& world, const float* obs) const;
  void run(World& world, const float* obs, float* action) const;
  void move(World& world, double t, const Motion& motion) const;

  std::string file_;  // for messages
  double dt_;
  std::vector<DemoHand> hands_;
  std::vector<Phase> phases_;
  std::vector<float> hold_;  // [action_dim]
  size_t memory_ = 0, motions_ = 0;
  std::vector<World> worlds_;
};

}  // namespace tool
