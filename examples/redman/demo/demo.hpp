// Scripted demonstrations: waypoints of actions with times, phases that end on what is observed, and
// followers that steer an action entry by an observation. The format is described in
// examples/demos/README.md.
#pragma once
#include <string>
#include <vector>

#include "setup.hpp"

namespace tool {

// A script as it is written. Failure names the line that cannot be read.
struct DemoScript {
  struct Command {
    std::string entry;     // "right.FFJ2", may hold one '*'
    bool follows = false;  // steers by `measured`, else goes to `value`
    double value = 0;      // action, or degrees; a follower's offset or fixed aim
    bool degrees = false;
    double at = 0, over = 0;    // s into the phase, s of a linear change
    std::string measured, aim;  // fields "name[i]"; aim "": `value` alone
    double gain = 0, limit = 1;
    int line = 0;
  };
  struct Condition {
    std::string field;  // "name[i]"
    bool below = false;
    double value = 0;
    int line = 0;
  };
  struct Phase {
    std::string name;
    double seconds = -1;            // at most so long; < 0: to the episode's end
    std::vector<Condition> until;   // all of them end it
    std::vector<Command> commands;  // later ones win
  };
  std::string file;  // for messages
  std::string task;
  Options options;  // of the task
  std::vector<Phase> phases;
};
// The files of examples/demos, put into the program when it is built; the last row is null.
struct CarriedDemo {
  const char *task, *text;
};
extern const CarriedDemo kCarriedDemos[];

DemoScript parse_demo(const std::string& text, const std::string& file);
// The script that the tool carries for a task; Failure when there is none.
DemoScript builtin_demo(const std::string& task);
bool has_builtin_demo(const std::string& task);

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
