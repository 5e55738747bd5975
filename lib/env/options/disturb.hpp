// What stands between a world and its agent, as options that every task has: noise, bias, delay and drop-out
// of observation fields, delay of actions; and whether a cost ends the episode.
#pragma once
#include <cstdint>

#include "base/option_rows.hpp"
#include "env/task.hpp"

namespace rdm {

inline constexpr int32_t kMaxDelay = 16;  // control steps

// One field of a row that is not shown as it is. Ranges are drawn from at each reset.
struct FieldDisturbance {
  int32_t offset = 0, count = 0;
  float low = 0, high = 0;  // what its entries are cut at; kUnbounded: nothing
  OptionRange noise;        // standard deviation, in the unit of the field
  OptionRange bias;         // half the width of what an entry's constant offset is drawn from
  OptionRange delay;        // control steps
  OptionRange dropout;      // probability in a step that the field stays as it was shown last
};

struct DisturbOptions {
  OptionRange action_delay;  // control steps
  bool end_on_cost = false;
};
struct Disturbance : DisturbOptions {
  Vector<FieldDisturbance> fields;  // in the order of the row, those alone that any option names
  int32_t delay_entry = -1;         // of a row, that shows the drawn action_delay; -1: none does

  // A row is not shown as it is.
  bool alters_rows() const { return !fields.empty() || delay_entry >= 0; }
  bool delays_actions() const { return action_delay.high > 0; }
  // A world has numbers of its own for it.
  bool any() const { return !fields.empty() || delays_actions(); }
};

// The rows, static.
const OptionSpec* disturb_options(int32_t* count);

// Error(kNotFound) for a name or pattern that no field of the task has.
Disturbance disturbance_from(const Options& options, const Task& task, const char* owner);

// Joins the rows that were given another value than their default; all at their defaults: the hash as it was.
uint64_t hash_disturbance(const Options& options, uint64_t hash);

}  // namespace rdm
