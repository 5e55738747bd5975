// Cameras that ride on hands.
#include <gtest/gtest.h>

#include <cmath>

#include "env/options/sense.hpp"
#include "prop_tasks.hpp"
#include "sense/mounted_camera.hpp"

namespace rdm::test {
namespace {

// In the frame of the link or base that carries it the eye stands still while the hand goes elsewhere; it
// looks at what the fingers hold from the palm's side.
TEST(PalmCameras, RideOnTheirHands) {
  register_builtin_tasks();
  struct Case {
    const char* task;
    std::vector<OptionInput> options;
    int32_t hands;
  };
  const Case cases[] = {{"hand_over_safe_finger", {}, 2},
                        {"catch_underarm_safe_finger", {}, 2},
                        {"grasp", {{"hand", "allegro", 0}, {"arm", "ur5e", 0}}, 1},
                        {"jenga", {}, 2}};
  for (const Case& c : cases) {
    TestPool p(c.task, 1, c.options);
    p->reset(nullptr, nullptr);
    const auto& cameras = p->task().mounted_cameras();
    ASSERT_EQ(cameras.size(), static_cast<size_t>(c.hands)) << c.task;
    for (const CameraSpec& spec : cameras) {
      const Camera local = camera_of(task_at(p->task_index()), p->task(), spec.name);
      ASSERT_NE(local.mount, 0);
      const auto frame = [&] {
        return local.mount > 0 ? p->world(0).link(local.mount - 1).X : p->world(0).base(-local.mount - 1).X;
      };
      const Camera before = placed(local, p->world(0));
      EXPECT_EQ(before.mount, 0);
      EXPECT_NEAR(norm(before.eye - frame() * local.eye), 0, 1e-12);
      EXPECT_NEAR(norm(before.target - frame() * local.target), 0, 1e-12);
      EXPECT_NEAR(norm(before.up), 1, 1e-12);
      const Pose X = frame();
      for (int t = 0; t < 20; ++t) {
        for (int32_t j = 0; j < p->task().action_dim(); ++j) p.action(0)[j] = j % 2 ? 0.4f : -0.4f;
        p->step(nullptr);
        if (p.ended(0)) break;
      }
      const Camera after = placed(local, p->world(0));
      EXPECT_NEAR(norm(after.eye - frame() * local.eye), 0, 1e-12);
      if (norm(frame().p - X.p) > 1e-3) {
        EXPECT_GT(norm(after.eye - before.eye), 1e-4) << c.task << spec.name;
      }
    }
  }
}

// Both palms see their own hand.
TEST(PalmCameras, SeeTheirFingers) {
  register_builtin_tasks();
  for (const char* side : {"right", "left"}) {
    const std::string camera = std::string(side) + "_palm";
    TestPool p("hand_over_safe_finger", 1,
               {{"modality", "points", 0},
                {"cloud_cameras", camera.c_str(), 0},
                {"points", nullptr, 300},
                {"cloud_range", nullptr, 0.3}});
    p->reset(nullptr, nullptr);
    ASSERT_GT(p->sensed().point_count[0], 200);
    int own = 0;
    for (int i = 0; i < 300; ++i) {
      const auto shape = static_cast<size_t>(p->sensed().point_shape[i]);
      own += std::string(p->task().scene().shapes[shape].def.name.text).rfind(side, 0) == 0;
    }
    EXPECT_GT(own, 100) << side;
  }
}

}  // namespace
}  // namespace rdm::test
