#include <cmath>
#include <utility>

#include "tasks/catalog.hpp"
#include "tasks/hand/hand_observation.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

TEST(HandObservation, Layout) {
  FieldTable t;
  SceneDef def;
  def.articulations.push_back(make_articulation(kShadowHand, Side::kRight, {}, ""));
  const Scene scene = make_scene(std::move(def));
  add_hand_fields(find_hand(kShadowHand, scene, 0), t, "right");
  EXPECT_EQ(field_total(t), 187);
  const struct {
    int32_t offset;
    const char* name;
  } rows[] = {{0, "right.joint_position"},   {24, "right.joint_velocity"},  {48, "right.joint_force"},
              {72, "right.ff_tip_position"}, {75, "right.ff_tip_rotation"}, {79, "right.ff_tip_velocity"},
              {82, "right.ff_tip_spin"},     {85, "right.mf_tip_position"}, {124, "right.th_tip_position"},
              {137, "right.ff_tip_force"},   {140, "right.ff_tip_torque"},  {161, "right.th_tip_force"},
              {167, "right.action"}};
  for (const auto& row : rows) {
    int32_t at = 0;
    bool found = false;
    for (const FieldSpec& f : t) {
      if (at == row.offset) {
        EXPECT_STREQ(f.name.text, row.name);
        found = true;
      }
      at += f.count;
    }
    EXPECT_TRUE(found) << row.offset;
  }
}

class HandRows : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
};

TEST_F(HandRows, HoldWhatTheWorldHas) {
  TestPool p("hand_over_safe_finger", 1);
  p->reset(nullptr, nullptr);
  for (int t = 0; t < 12; ++t) {
    p->baseline(Baseline::kRandom);
    p->step(nullptr);
  }
  const World& w = p->world(0);
  const auto clip = [](double x) { return static_cast<float>(std::max(-5.0, std::min(5.0, x))); };
  const int tips[] = {5, 9, 13, 18, 23};
  for (int hand = 0; hand < 2; ++hand) {
    const float* o = p.obs(0) + 187 * hand;
    for (int i = 0; i < 24; ++i) {
      const int k = 24 * hand + i;
      const JointDef& j = w.scene().link(k).joint;
      EXPECT_EQ(o[i], clip((2 * w.q()[k] - j.upper - j.lower) / (j.upper - j.lower)));
      EXPECT_EQ(o[24 + i], clip(0.2 * w.qd()[k]));
      EXPECT_EQ(o[48 + i], clip(10 * w.torque()[k]));
    }
    for (int tip = 0; tip < 5; ++tip) {
      const Motion& m = w.link(24 * hand + tips[tip]);
      const float* f = o + 72 + 13 * tip;
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(f[k], clip(m.X.p[k]));
        EXPECT_EQ(f[7 + k], clip(m.v[k]));
        EXPECT_EQ(f[10 + k], clip(m.w[k]));
      }
      EXPECT_EQ(f[3], clip(m.X.q.x));
      EXPECT_EQ(f[6], clip(m.X.q.w));
      const Wrench& s = w.sensor(5 * hand + tip);
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(o[137 + 6 * tip + k], clip(10 * s.force[k]));
        EXPECT_EQ(o[140 + 6 * tip + k], clip(10 * s.torque[k]));
      }
    }
    for (int k = 0; k < 20; ++k) EXPECT_EQ(o[167 + k], p.action(0)[20 * hand + k]);
  }
}

// An object put on a fingertip weighs on its sensor; sensor = none reads zero.
TEST_F(HandRows, FingertipsFeelTheObject) {
  for (const char* sensor : {"contact", "none"}) {
    TestPool p("hand_over_safe_finger", 1,
               {{"sensor", sensor, 0}, {"joint_noise", nullptr, 0}, {"object", "ball", 0}});
    p->reset(nullptr, nullptr);
    p->baseline(Baseline::kHold);
    Motion m;
    m.X.p = p->world(0).link(9).X.p + Vec3{0, -0.013, 0.042};
    p->world(0).set_body(0, m);
    double most = 0;
    for (int t = 0; t < 6; ++t) {
      p->step(nullptr);
      for (int k = 0; k < 30; ++k) most = std::max(most, std::abs(static_cast<double>(p.obs(0)[137 + k])));
    }
    if (*sensor == 'c')
      EXPECT_GT(most, 0.5);
    else
      EXPECT_EQ(most, 0);
  }
}

TEST_F(HandRows, AFreshEpisodeHasNoForcesAndNoAction) {
  TestPool p("hand_over_safe_finger", 1, {{"max_steps", nullptr, 5}});
  p->reset(nullptr, nullptr);
  for (int t = 0; t < 5; ++t) {
    p->baseline(Baseline::kRandom);
    p->step(nullptr);
  }
  ASSERT_TRUE(p.ended(0));
  for (int hand = 0; hand < 2; ++hand) {
    const float* o = p.obs(0) + 187 * hand;
    for (int i = 24; i < 72; ++i) EXPECT_EQ(o[i], 0) << i;
    for (int i = 137; i < 187; ++i) EXPECT_EQ(o[i], 0) << i;
  }
}

}  // namespace
}  // namespace rdm::test
