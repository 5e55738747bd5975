// What a window looks at: worlds of this program (Session) or of another one (Fed).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "common/json.hpp"
#include "common/report.hpp"
#include "play/playback.hpp"

namespace tool {

class Viewed {
 public:
  virtual ~Viewed() = default;

  // Does what a window asks for: {"do": "step"}. What to tell it: {} or {"hash": ...}; Usage or Failure where it cannot be
  // done, and nothing changed.
  virtual Json command(const Document& asked) = 0;
  // All that stays the same, until scene_number() changes.
  virtual Json scene() const = 0;
  virtual int64_t scene_number() const = 0;  // 0: there is none yet
  // The moment that is shown, as bytes: the length of a JSON text, the text, and its numbers (view/messages.cpp). With rows of
  // the moments after `since`, which a window has already.
  virtual std::string frame(int64_t since) const = 0;
  virtual int64_t at() const = 0;
  virtual int32_t watched_world() const = 0;  // whose numbers are told
  virtual int64_t changes() const = 0;        // goes up when a frame would be another one

  virtual bool plays() const = 0;  // step() is due every step_seconds()
  virtual void pause() = 0;
  virtual double step_seconds() const = 0;
  virtual void step() = 0;
  virtual int64_t steps() const = 0;
  virtual void finish() {}  // of what is recorded what is whole is written
  virtual Json summary() const = 0;

  // Of worlds that come from elsewhere: what came since the last call; false when no more will. And how many windows there are.
  virtual bool listen(size_t /*windows*/) { return true; }
  virtual double patience() const { return 0.5; }  // s until the next listen()
};

inline constexpr int64_t kMostRows = 1200;  // moments of one frame
// The bytes of a frame (view.md, Messages).
std::string frame_bytes(const Json& head, const std::vector<float>& numbers);
Json number_json(float x);  // null where it is not finite
Json numbers_json(const float* from, size_t count);
// {"name": ..., "kind": ..., ...} of a shape, hulls with a mesh.
Json shape_json(const Body& body, bool fixed);

// Where a spring that is held at `to` pulls a point: at most `newton` N, from `reach` m on. The force [3], and its size.
double pull_of(const double at[3], const double to[3], double newton, double reach, float force[3]);

}  // namespace tool
