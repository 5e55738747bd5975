// The terms that a .task file may have: name, what a term is about, unit.
#pragma once
#include "task_program.hpp"
#include "toml_text.hpp"

namespace rdm::import {

enum Keys : uint32_t {  // what a term is about
  kA = 1,               // a = place
  kB = 2,               // b = place
  kFrom = 4,            // from = place, else the world
  kShapesAB = 8,        // a, b = names of shapes
  kJointsOf = 16,       // of = robot, or joints = patterns
  kOneJoint = 32,       // joint = name, from, to = numbers
  kActionOf = 64,       // of = robot, else all
  kBox = 128,           // low, high = [3], from = place
  kWindow = 256,        // low, high = numbers, share = flag
  kAxis = 512,          // axis, up = [3]
  kBodyA = 1024,        // a = body
  kTipA = 2048,         // a = robot.finger, or a link with a sensor
  kStart = 4096,        // a's place at the start is kept
  kShare = 8192,        // share = flag
  kPlane = 16384,       // along = [3]
  kMany = 1 << 20       // several numbers
};
struct TermRow {
  const char* name;
  What what;
  uint32_t keys;
  const char* unit;
};
// The row of t's term; FORMAT with the nearest for a word that is none, and unless `many` for one of several numbers.
const TermRow& term_of(const Table& t, bool many);
// "cup.position" where a field has no name of its own.
std::string field_name(const Table& t);

}  // namespace rdm::import
