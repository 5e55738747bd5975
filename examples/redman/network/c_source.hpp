// A policy as one C99 file that needs nothing: no heap, no library. What the file holds, it says at its head.
#pragma once
#include "network/network.hpp"

namespace tool {

struct ObsField {
  std::string name, unit;
  int32_t offset = 0, count = 0;  // entries
  bool seen = true;               // by the policy
};

// What actions are held to, within [-1, 1]; both empty: nothing.
struct ActionBounds {
  std::vector<float> low, high;  // [action_dim]
};

struct CSource {
  std::string text;
  double largest_error = 0, rms_error = 0;  // of int8 weights: actions, against the policy's own
};

// `name` begins every symbol. `fields` say what the observation is made of; may be empty.
CSource c_source(const redman::Policy& policy, const Network& network, const std::string& name,
                 const std::vector<ObsField>& fields, const ActionBounds& bounds, bool int8);
// Clips rows of actions.
void hold_to(const ActionBounds& bounds, std::vector<float>& actions);

// "hand_over_act" and its like can be made of it. Usage if not.
void check_c_name(const std::string& name);
// The nearest such name to a task's.
std::string c_name_of(const std::string& task);

}  // namespace tool
