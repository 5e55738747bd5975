// Trajectories as data: rows of what was seen, done and meant. Mirrors rdm_recording_*.
//
// Columns are vectors of their own, so that a file and a learner take them as they are. A row belongs to an
// episode by number; rows stand in the order in which they came, those of worlds that step together in turn.
// Of some rows there is the world's state before them, all states of one length.
//
// A source (a pool) has open rows, one a world: begin_row adds it, end_row adds to it what followed. Memory
// grows in begin_step's make_room alone, which is outside of any step.
#pragma once
#include <cstdint>

#include "base/file.hpp"
#include "base/host.hpp"

namespace rdm {

struct RecordingSpec {
  int32_t obs_dim = 0, action_dim = 0, cost_dim = 0;
  uint64_t layout_hash = 0;  // 0: unknown
  char task[64] = "";
  size_t state_bytes = 0;    // of one state; 0: none are kept
  int32_t state_stride = 8;  // begin_row wants the state of every n-th row of an episode
  int32_t num_points = 0;    // of each row's cloud; 0: none are kept
  bool point_color = false;  // points have one
};

// Meaning, shapes and defaults of null as rdm_recording_rows.
struct RecordingRows {
  int64_t rows = 0;
  const float *obs = nullptr, *action = nullptr, *label = nullptr, *reward = nullptr, *cost = nullptr;
  const uint8_t *terminated = nullptr, *truncated = nullptr, *success = nullptr;
  const int64_t* episode = nullptr;
  int64_t num_states = 0;
  const int64_t* state_row = nullptr;
  const uint8_t* state = nullptr;
  const int16_t* points = nullptr;
  const uint8_t* point_class = nullptr;
  const uint8_t* point_color = nullptr;
};

inline constexpr int32_t kMaxRecordedPoints = 65536;
inline constexpr int64_t kMaxRecordingRows = int64_t{1} << (sizeof(size_t) == 8 ? 40 : 31);

class Recording {
 public:
  // Error(kRange) for a spec that is none; the names are those of rdm_recording_config. Takes the hooks in
  // force.
  Recording(const RecordingSpec& spec, int64_t capacity);

  const RecordingSpec& spec() const { return spec_; }
  int64_t rows() const { return static_cast<int64_t>(reward_.size()); }
  int64_t episodes() const { return episodes_; }
  int64_t num_states() const { return static_cast<int64_t>(state_row_.size()); }
  RecordingRows view() const;
  uint64_t fingerprint() const;        // of obs, label and points
  uint64_t state_fingerprint() const;  // of the states

  // Error(kArgument) for rows that are none; nothing changes.
  void append(const RecordingRows& rows);
  // Error(kArgument) where dims, layout or states differ.
  void append_all(const Recording& other);
  // Returns how many episodes were dropped.
  int64_t filter(bool need_success, const double* max_cost);
  void clear();

  // Room for a row of each of so many worlds of this source; a source that was not the last one begins new
  // episodes.
  void make_room(const void* source, int32_t worlds);
  // The row of a world; action and label are cut to [-1, 1]. points [num_points][3], m, of the world,
  // point_class [num_points] and point_color [num_points][3] where the recording has those. Needs room.
  void begin_row(int32_t world, const float* obs, const float* action, const float* label,
                 const float* points = nullptr, const uint8_t* point_class = nullptr,
                 const uint8_t* point_color = nullptr);
  // Whether the state before the row that begin_row just added belongs to the recording, and where it goes.
  bool state_due(int32_t world) const;
  unsigned char* add_state(int32_t world);
  // Adds to the world's open row, if there is one.
  void end_row(int32_t world, float reward, const float* cost, bool terminated, bool truncated, bool success);
  bool follows(const void* source) const { return source_ == source; }

  void write(Vector<unsigned char>& file) const;
  // Error(kFormat) for bytes that are no recording, kVersion for a newer one.
  static Recording* read(const ByteSource& source, const HostHooks& hooks);

 private:
  struct Open {
    int64_t row = -1, episode = -1;  // -1: none
    int64_t count = 0;               // rows of the episode so far
  };
  size_t obs_dim() const { return static_cast<size_t>(spec_.obs_dim); }
  size_t action_dim() const { return static_cast<size_t>(spec_.action_dim); }
  size_t cost_dim() const { return static_cast<size_t>(spec_.cost_dim); }
  size_t num_points() const { return static_cast<size_t>(spec_.num_points); }
  size_t num_colors() const { return spec_.point_color ? 3 * num_points() : 0; }
  void check(const RecordingRows& rows) const;
  void reserve(size_t rows, size_t states);
  void copy_row(size_t from, size_t to);
  void cut(size_t rows, size_t states);

  RecordingSpec spec_;
  Vector<float> obs_, action_, label_, reward_, cost_;
  Vector<uint8_t> terminated_, truncated_, success_;
  Vector<int64_t> episode_, state_row_;
  Vector<uint8_t> state_;
  Vector<int16_t> points_;
  Vector<uint8_t> point_class_, point_color_;
  int64_t episodes_ = 0;
  const void* source_ = nullptr;
  Vector<Open> open_;  // [worlds of the source]
};

}  // namespace rdm
