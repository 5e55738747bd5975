// A demonstration at work: phases end on time or on what is observed, entries go to values or follow
// observations.
#pragma once
#include <string>
#include <vector>

#include "demo/script.hpp"

namespace tool {

// A script at work in the worlds of one pool.
class Demo {
 public:
  // Failure when the script names an entry or a field that the pool has not.
  Demo(const DemoScript& script, redman::Pool& pool);
  void restart(const uint8_t* mask);
  // Fills the action rows of the worlds in the mask.
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
  struct Phase {
    double seconds;
    std::vector<Condition> until;
    std::vector<Command> commands;
  };
  struct World {
    size_t phase = 0;
    int32_t step = 0;          // control steps into the phase
    std::vector<float> value;  // [action_dim] held
    std::vector<float> from;   // where linear changes began
  };
  bool over(const Phase& phase, const World& world, const float* obs) const;
  void run(World& world, const float* obs, float* action) const;

  double dt_;
  std::vector<Phase> phases_;
  std::vector<float> hold_;  // [action_dim]
  size_t memory_ = 0;
  std::vector<World> worlds_;
};

}  // namespace tool
