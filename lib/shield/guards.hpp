// The half spaces that actions are held to: those that a task declares, and a host's own, each world's its own.
#pragma once
#include "base/bytes.hpp"
#include "base/host.hpp"
#include "shield/project.hpp"

namespace rdm {

class Guards {
 public:
  Guards() = default;
  Guards(int32_t worlds, int32_t dim);

  // One more, of all worlds: of a cost column that a task declares it for, or (-1) of a host's own.
  // Error(kArgument) for no half space, and where no action keeps it beside the others; Error(kRange): there are
  // kMostGuards.
  void add(int32_t column, const float* normal, float bound);
  // Own one i of a world. The errors of add; Error(kRange) for one that is not there. False: it was so before. No
  // heap use.
  bool set(int32_t env, int32_t i, const float* normal, float bound);

  int32_t count() const { return static_cast<int32_t>(rows_.size()); }
  int32_t column(int32_t row) const { return rows_[static_cast<size_t>(row)].column; }
  // The row that an action of a world violates most, -1: none.
  int32_t broken(int32_t env, const float* action) const;
  // The nearest action that breaks none, to `out`, which may be `action`; one that breaks none stays as it is. The
  // row that was broken most, -1: none. No heap use.
  int32_t project(int32_t env, const float* action, float* out) const;

  uint64_t hash(uint64_t hash) const;  // of what a host does not change
  // The host's own.
  void write(Writer& out) const;
  bool check(Reader& in) const;  // whether they can be read
  void read(Reader& in);

 private:
  struct Row {
    int32_t column;
    Vector<float> normal, bound;  // [dim], [1] of all worlds; of a host's own [worlds][dim], [worlds]
  };
  size_t width() const { return static_cast<size_t>(dim_); }
  HalfSpace half_space(const Row& row, int32_t env) const;
  int32_t half_spaces(int32_t env, HalfSpace* out) const;
  bool keepable(const HalfSpace* rows, int32_t count) const;

  int32_t worlds_ = 0, dim_ = 0;
  Vector<Row> rows_;  // the task's, then the host's
  int32_t declared_ = 0;
  Vector<float> origin_;         // [dim] zeros
  mutable Vector<float> found_;  // [dim]
};

}  // namespace rdm
