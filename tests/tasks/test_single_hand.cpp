#include <cmath>

#include "tasks/catalog.hpp"
#include "tasks/hand/single_hand.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr const char* kTasks[] = {"grasp", "reorient"};

class SingleHandTask : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
};

TEST_F(SingleHandTask, Layout) {
  for (const char* task : kTasks) {
    TestPool p(task, 1);
    EXPECT_EQ(p->obs_dim(), 211);
    EXPECT_EQ(p->task().action_dim(), 20);
    EXPECT_EQ(p->task().max_steps(), 74);
    const struct {
      const char* name;
      int32_t offset;
    } rows[] = {{"right.joint_position", 0},    {"right.joint_velocity", 24},  {"right.joint_force", 48},
                {"object.position", 72},        {"object.velocity", 79},       {"object.spin", 82},
                {"goal.position", 85},          {"object.rotation_error", 92}, {"right.ff_tip_position", 96},
                {"right.th_tip_position", 148}, {"right.ff_tip_force", 161},   {"right.action", 191}};
    for (const auto& row : rows) {
      int32_t at = 0;
      for (const FieldSpec& f : p->task().fields()) {
        if (f.name == row.name) break;
        at += f.count;
      }
      EXPECT_EQ(at, row.offset) << row.name;
    }
  }
}

TEST_F(SingleHandTask, RowsHoldWhatTheWorldHas) {
  for (const char* task : kTasks) {
    TestPool p(task, 1);
    p->reset(nullptr, nullptr);
    for (int t = 0; t < 10; ++t) {
      p->baseline(Baseline::kRandom);
      p->step(nullptr);
    }
    const World& w = p->world(0);
    const float* o = p.obs(0);
    EXPECT_EQ(o[74], static_cast<float>(w.body(0).X.p.z));
    EXPECT_EQ(o[96], static_cast<float>(w.link(5).X.p.x));
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(o[161 + k], std::max(-5.0f, std::min(5.0f, static_cast<float>(10 * w.sensor(0).force[k]))));
    for (int k = 0; k < 20; ++k) EXPECT_EQ(o[191 + k], p.action(0)[k]);
  }
}

TEST_F(SingleHandTask, OnlyTimeEndsAQuietEpisode) {
  for (const char* task : kTasks) {
    TestPool p(task, 1, {{"start.x", nullptr, 0.0}});
    for (int draw = 0; draw < 2; ++draw) p->reset(nullptr, nullptr);  // of the first the egg rolls out
    for (int t = 1; t <= 74; ++t) {
      p->baseline(Baseline::kZero);
      p->step(nullptr);
      EXPECT_FALSE(p.rows().terminated[0]) << task;
      EXPECT_EQ(p.rows().truncated[0], t == 74) << task;
    }
  }
}

TEST_F(SingleHandTask, LeftHandsHaveNoOptions) {
  for (const char* task : kTasks) {
    int32_t count = 0;
    const OptionSpec* specs = task_at(task_find(task)).options(&count, nullptr);
    for (int32_t i = 0; i < count; ++i) {
      EXPECT_STRNE(specs[i].key, "left_model");
      EXPECT_STRNE(specs[i].key, "friction.hand_hand");
    }
  }
}

}  // namespace
}  // namespace rdm::test
