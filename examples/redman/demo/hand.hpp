// A hand of a pool as demonstrations know it: its action entries by name, and on an arm the joint angles that
// bring its palm or a fingertip to a place.
#pragma once
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <redman/redman.hpp>
#include <string>
#include <vector>

#include "common/setup.hpp"

namespace tool {

// Position, m, and unit quaternion (x, y, z, w), world.
struct Place {
  double p[3] = {}, q[4] = {0, 0, 0, 1};
};
// R = Rz Ry Rx about fixed axes, rad.
void turn_of(const double rpy[3], double q[4]);
// From a (share 0) to b (share 1), the shorter way round.
Place between(const Place& a, const Place& b, double share);

class DemoHand {
 public:
  struct Entry {
    std::vector<std::string> names;  // "right.FFJ2", "right.ff.middle", "right.first.middle"
    double lower = 0, upper = 0;     // rad; 0, 0 for a base's entries
  };

  // Side 0 is right. `first`: of the pool's action row.
  DemoHand(const redman::Pool& pool, const Options& settings, int32_t side, size_t first);
  ~DemoHand();
  DemoHand(DemoHand&& other) noexcept;
  DemoHand(const DemoHand&) = delete;
  DemoHand& operator=(const DemoHand&) = delete;

  const std::vector<Entry>& entries() const { return entries_; }
  // A finger's row, -1: the palm; -2: no such point.
  int32_t point(const std::string& name) const;
  // Why its arm cannot be told where to go: it has none, or options are in the way; "" where it can.
  const std::string& hindrance() const { return hindrance_; }

  // Where the palm is, and with a finger its tip, when the joints are where `action` [action_dim] sends them.
  Place place(const float* action, int32_t finger) const;
  // Sets the arm's entries so that the point comes to `to`, the palm turned so; false: out of reach.
  bool reach(const Place& to, int32_t finger, float* action) const;

 private:
  void angles(const float* action, double* q) const;

  std::vector<Entry> entries_;
  std::vector<std::string> fingers_;
  std::string hindrance_;
  size_t first_;
  int32_t robot_ = -1, mounted_ = -1;  // the latter one is its own
  int32_t arm_joints_ = 0;
  std::vector<int32_t> joint_;  // [entries that are joints] row of each
  std::vector<rdm_joint_info> rows_;
  std::vector<rdm_robot_coupling> couplings_;
  Place base_;  // of the root
};

}  // namespace tool
