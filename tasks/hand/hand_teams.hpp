// How the action of hands is shared out between the agents of a team. Two sets, as agents read them (option groups):
//
//   hands    an agent for each hand
//   fingers  an agent for each finger, for the wrist or arm before them, and for a base that flies
//
// Each sees all that is not the other hand's: its own hand, what it handles, and the goal.
#pragma once
#include "base/host.hpp"
#include "tasks/hand/hand_control.hpp"

namespace rdm {

class HandTeams {
 public:
  explicit HandTeams(const HandControl& hands);
  bool set_at(int32_t i, const char** key, const char** list) const;

 private:
  struct Set {
    const char* key;
    Vector<char> list;
  };
  Vector<Set> sets_;
};

}  // namespace rdm
