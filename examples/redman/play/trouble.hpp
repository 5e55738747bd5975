// What went wrong in worlds while episodes were played: counted, and said wherever a result is.
#pragma once
#include <cstdint>
#include <redman/redman.hpp>
#include <string>

#include "common/report.hpp"

namespace tool {

// Episodes that went wrong for good, and steps of a pool that went wrong without an end.
struct Trouble {
  int64_t diverged = 0, bad_actions = 0, task_failed = 0;
  int64_t contacts_left_out = 0, unconverged = 0, slowed = 0;

  void add(uint32_t status);  // of a step, or the reset, of one episode
  void add(const Trouble& other);
  bool any() const { return lost() || contacts_left_out > 0 || unconverged > 0 || slowed > 0; }
  // Episodes that were cut off: what they came to is no measurement.
  bool lost() const { return diverged > 0 || bad_actions > 0 || task_failed > 0; }
};

// Its keys, the same in every command; behind `prefix`.
void put_trouble(Json& json, const Trouble& t, const std::string& prefix = "");
// "2 episodes diverged; ..."; "" where nothing went wrong.
std::string trouble_text(const Trouble& t);
// A line on stderr where something did.
void say_trouble(const Trouble& t, const std::string& where);
// Since the pool was made; a reset that diverged counts beside the step after it.
Trouble trouble_of(const redman::Pool& pool);

}  // namespace tool
