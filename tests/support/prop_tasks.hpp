// What the tests of the tasks with loose things share.
#pragma once
#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {

inline constexpr const char* kEngines[] = {"articulated", "ode"};

using OptionList = std::vector<OptionInput>;
inline OptionList with_engine(const char* engine, OptionList more = {}) {
  more.push_back({"engine", engine, 0});
  return more;
}

inline int32_t offset_of(const Task& task, const char* field) {
  int32_t at = 0;
  for (const FieldSpec& f : task.fields()) {
    if (f.name == field) return at;
    at += f.count;
  }
  return -1;
}

inline void run(TestPool& p, Baseline baseline, int steps) {
  for (int t = 0; t < steps; ++t) {
    p->baseline(baseline);
    p->step(nullptr);
  }
}

// The farthest that a body is from where it was, m.
inline std::vector<Vec3> places(const World& world) {
  std::vector<Vec3> out;
  for (int32_t i = 0; i < world.scene().num_bodies; ++i) out.push_back(world.body(i).X.p);
  return out;
}
inline double moved(const World& world, const std::vector<Vec3>& from, int32_t first = 0) {
  double most = 0;
  for (int32_t i = first; i < world.scene().num_bodies; ++i)
    most = std::max(most, norm(world.body(i).X.p - from[static_cast<size_t>(i)]));
  return most;
}

// Fields of two flying hands stand first, where ReDMan's table B3 has them.
inline void expect_hand_fields(const Task& task) {
  EXPECT_EQ(task.action_dim(), 52);
  EXPECT_EQ(offset_of(task, "right.joint_position"), 0);
  EXPECT_EQ(offset_of(task, "right.base_position"), 167);
  EXPECT_EQ(offset_of(task, "right.base_angles"), 170);
  EXPECT_EQ(offset_of(task, "right.action"), 173);
  EXPECT_EQ(offset_of(task, "left.joint_position"), 199);
  EXPECT_EQ(offset_of(task, "left.action"), 372);
}

}  // namespace rdm::test
