// Worlds of another program, as it tells them: a scene, then frames. Python's package writes them (redman/_feed.py); `render
// --feed` makes a page of them, and `view --feed` shows them while they come.
//
// A message is u32 size of what follows, u32 size of a JSON text, the text, and float32 numbers, all little-endian.
//   scene   JSON: members below, "record" the file of the page's button, "" without one; "leads": it can lead a point;
//           "shields": it has a shield to switch; numbers: poses [worlds][shapes][7] of all shapes, position (m) and
//           quaternion (x, y, z, w)
//   frame   JSON: "contacts" and "points", how many, and "world", the one that they are of; "take", while it records:
//           episodes, dropped, steps, pushed. Numbers: poses [worlds][moving][7] of the shapes that are not fixed; rows
//           [worlds][6 + 2 costs + actions]: reward, return, step, ended (1 by time, 2 terminated), success, stepped_in,
//           each cost, its sum over the episode, the action; contacts [contacts][6], position (m), force (N); points
//           [points][3] of what its cameras see (m), and the class of each [points]
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "common/json.hpp"
#include "play/playback.hpp"

namespace tool {

struct FeedMessage {
  Document head;
  std::vector<float> numbers;
};

// Bytes as they come, and the messages in them.
class FeedReader {
 public:
  static constexpr size_t kMostBytes = size_t{1} << 26;  // a message
  void add(const char* bytes, size_t size) { in_.append(bytes, size); }
  // False: the rest of it is still to come. Failure when it is none.
  bool next(FeedMessage* out);
  bool empty() const { return at_ == in_.size(); }

 private:
  std::string in_;
  size_t at_ = 0;
};

struct FeedScene {
  // Failure, which names the member, where it is none.
  explicit FeedScene(const FeedMessage& message);

  Playback looks;               // without frames
  std::vector<int32_t> moving;  // shapes that are not fixed
  std::vector<std::string> actions;
  std::vector<uint8_t> mounted;  // of cameras
  std::vector<float> poses;      // [worlds][shapes][7]
  size_t worlds = 1;
  bool leads = false, shields = false;
  std::string record;  // the file that the other program records into; "": it does not
  int32_t obs = 0, max_steps = 0;
};

struct FeedFrame {
  struct Row {
    float reward = 0, episode_return = 0;
    int32_t step = 0;
    uint8_t ended = 0, success = 0, stepped_in = 0;
    std::vector<float> cost, sum, action;
  };
  // Failure where it does not fit the scene.
  FeedFrame(const FeedScene& scene, const FeedMessage& message);

  std::vector<float> poses;     // [worlds][moving][7]
  std::vector<Row> rows;        // [worlds]
  int32_t world = 0;            // of contacts and points
  std::vector<float> contacts;  // [n][6]
  std::vector<float> points;    // [m][3], then a class for each
  struct Take {
    int64_t episodes = 0, dropped = 0, steps = 0;
    bool pushed = false;  // in the episode that runs
  };
  std::optional<Take> take;  // of the recording that runs
};

// The episode that a file of such messages holds, of one world. Failure, which names the file.
Playback read_episode(const std::string& path);

}  // namespace tool
