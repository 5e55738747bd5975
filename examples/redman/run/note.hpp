// The note in a checkpoint: what the trainer knows beside the states of the agent and the worlds. One line of
// JSON, then the bytes of the shield's state and of the best policy.
#pragma once
#include <cstddef>
#include <optional>
#include <redman/redman.hpp>
#include <string>

#include "run/progress.hpp"
#include "run/score.hpp"

namespace tool {

struct Note {
  int32_t epoch = 0;
  int64_t env_steps = 0;
  size_t progress_bytes = 0;
  double seconds = 0;  // Time/Total
  std::optional<LastEvaluation> last;
  std::optional<Score> best;
  redman::Bytes best_policy;  // empty without `best`
  redman::Bytes shield;       // its state, empty without one
  bool changed = false;       // parsed: a callback in Python changed options of the task
  bool clock_lost = false;    // parsed: `seconds` was out of range, and is 0
};

std::string note_bytes(const Note& note);
// Failure when a member is missing, of the wrong kind or out of range, but for `seconds`. Whether the policy
// is one is for redman::Policy to say.
Note parse_note(const char* bytes, size_t size);

}  // namespace tool
