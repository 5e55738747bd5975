// What the rows of a recording need of each other where an actor remembers.
//
//   history  of each row that of the decision before it in its episode
//   GRU      episodes cut into paths of memory_chunk decisions, as a horizon is (rollout/sequences.hpp): gradients flow
//            back to the begin of a path, and what the actor's memory is there is kept. An episode begins with zeros
//
// Rows of an episode stand in the order of time, those of several worlds perhaps in turn.
#pragma once
#include "base/host.hpp"

namespace rdm {

struct ResolvedAgentConfig;
struct DemoRows;

class DemoMemory {
 public:
  // Takes memory from the hooks in force.
  void open(const ResolvedAgentConfig& resolved, const DemoRows& demo);
  // Lets the rows point here.
  void attach(DemoRows& demo);

  int32_t paths() const { return static_cast<int32_t>(path_.size()); }
  int32_t rows(int32_t path) const { return path_[static_cast<size_t>(path)].rows; }
  // Of its decision `step`.
  int32_t row(int32_t path, int32_t step) const {
    return row_[static_cast<size_t>(path_[static_cast<size_t>(path)].first + step)];
  }
  float* state(int32_t path) { return state_.data() + static_cast<size_t>(path) * units_; }
  // Paths of an episode follow each other: those of episode e begin with first_path(e).
  int32_t episodes() const { return static_cast<int32_t>(episode_.size()) - 1; }
  int32_t first_path(int32_t episode) const { return episode_[static_cast<size_t>(episode)]; }

 private:
  struct Path {
    int32_t first, rows;  // of row_
  };
  void cut(const DemoRows& demo, int32_t length);

  Vector<int32_t> before_;   // [rows] -1: none
  Vector<int32_t> row_;      // [rows] episode by episode
  Vector<Path> path_;        // in the same order
  Vector<int32_t> episode_;  // [episodes + 1] the first path of each
  Vector<float> state_;      // [paths][units] before the first decision
  size_t units_ = 0;
};

}  // namespace rdm
