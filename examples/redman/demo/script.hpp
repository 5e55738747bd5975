// The text of a demonstration: waypoints of actions with times, phases that end on what is observed, and
// followers that steer an action entry by an observation. The format is described in
// examples/demos/README.md.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "common/setup.hpp"

namespace tool {

// A script as it is written.
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
  // Brings the palm, or a fingertip, of a hand on an arm to a place.
  struct Motion {
    bool left = false;
    std::string point;        // "palm", "ff_tip"
    double p[3] = {};         // m, world
    bool turned = false;      // else the palm keeps its turn
    double turn[3] = {};      // degrees about the world's axes x, y, z in this order: of the palm's frame
    double at = 0, over = 0;  // s, as a command's
    int line = 0;
  };
  struct Phase {
    std::string name;
    double seconds = -1;            // at most so long; < 0: to the episode's end
    std::vector<Condition> until;   // all of them end it
    std::vector<Command> commands;  // later ones win
    std::vector<Motion> motions;    // after those
  };
  std::string file;  // for messages
  std::string task;
  Options options;  // of the task
  Options when;     // among them: with which the tool takes this script and not another of the task
  Options teach;    // how it is learned from: settings of `train --from` (teach/settings.hpp),
  Options learn;    // and options of the algorithm
  std::vector<Phase> phases;
};
// The files of examples/demos, TASK.demo or TASK_WORD.demo, put into the program when it is built; the last
// row is null.
struct CarriedDemo {
  const char *name, *text;
};
extern const CarriedDemo kCarriedDemos[];

inline constexpr size_t kMostDemoBytes = size_t{1} << 18;

// `file` is for messages. Numbers are finite and at most 1e6, times and limits not negative.
DemoScript parse_demo(const char* text, size_t size, const std::string& file);
// The script that the tool carries for a task with these options: of those whose `when` holds, the one that
// asks for most. Failure when there is none.
DemoScript builtin_demo(const std::string& task, const Options& options);
bool has_builtin_demo(const std::string& task);

}  // namespace tool
