// The entry of the action that a task names for a joint moves this joint more than any other.
#include <cmath>
#include <cstdlib>
#include <vector>

#include "small_world.hpp"

namespace rdm::test {
namespace {

// Joint positions after one control step of the hold action, with `change` added to entry k; k < 0: to none.
std::vector<double> joints_after(const char* task, int32_t k, float change) {
  SmallWorld w(task);
  w.pool()->baseline(Baseline::kHold);
  if (k >= 0) w.pool().action(0)[k] += change;
  w.pool()->step(nullptr);
  const Task& t = w.pool()->task();
  const double* q = w.pool()->world(0).q();
  return {q, q + t.scene().num_links};
}

TEST(JointActions, AnEntryMovesItsJointMost) {
  register_builtin_tasks();
  int tried = 0;
  for (int32_t i = 0; i < task_count(); ++i) {
    const char* name = task_at(i).name;
    SmallWorld w(name);
    const Task& task = w.pool()->task();
    if (task.engine() != EngineKind::kArticulated) continue;
    w.pool()->baseline(Baseline::kHold);
    const std::vector<float> hold(w.pool().action(0), w.pool().action(0) + task.action_dim());
    const std::vector<double> still = joints_after(name, -1, 0);
    const int32_t joints = task.scene().num_links;
    for (int32_t k = 0; k < task.action_dim(); ++k) {
      bool named = false;  // forces and torques on a flying hand are of no joint
      for (int32_t j = 0; j < joints; ++j) named |= task.action_of(j) == k;
      if (!named) continue;
      const std::vector<double> moved =
          joints_after(name, k, hold[static_cast<size_t>(k)] > 0 ? -0.3f : 0.3f);
      int32_t most = -1;
      double far = 0;
      for (int32_t j = 0; j < joints; ++j) {
        const double d = std::fabs(moved[static_cast<size_t>(j)] - still[static_cast<size_t>(j)]);
        if (d > far) far = d, most = j;
      }
      ASSERT_GE(most, 0) << name << " entry " << k << " moves nothing";
      EXPECT_EQ(task.action_of(most), k) << name << ": joint " << most << " moves by " << far;
      ++tried;
    }
  }
  EXPECT_GT(tried, 400);  // of ten tasks with hands and five with ants
}

}  // namespace
}  // namespace rdm::test
