// What worlds draw at their resets as fields of the observation: each option's factor where it lies in its range, told
// apart from others on the same rows; delays of actions; kept with a state; nothing without the option.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

class DynamicsShown : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
};

// Offset of a field of one entry; -1: there is none.
int32_t offset_of(TestPool& p, const char* name) {
  int32_t at = 0;
  for (const FieldSpec& f : p->task().fields()) {
    if (std::string(f.name.text) == name) return f.count == 1 ? at : -2;
    at += f.count;
  }
  return -1;
}

// Where x lies between a and b.
double place(double x, double a, double b) {
  return 2 * (x - a) / (b - a) - 1;
}

TEST_F(DynamicsShown, EachFactorIsWhereItLiesInItsRange) {
  TestPool plain("hand_over_safe_finger", 2);
  TestPool p("hand_over_safe_finger", 16,
             {{"show_dynamics", "true", 0},
              {"action_delay", "0..4", 0},
              {"object_mass", "0.03..0.3", 0},
              {"scale.kp", "0.6..1.5", 0},
              {"joint.WRJ1.kp", "1..2", 0},
              {"friction.hand_object", "0.5..1", 0}});
  EXPECT_EQ(p->obs_dim(), plain->obs_dim() + 5);
  const int32_t mass = offset_of(p, "dynamics.object_mass"), kp = offset_of(p, "dynamics.scale.kp"),
                joint = offset_of(p, "dynamics.joint.WRJ1.kp"),
                friction = offset_of(p, "dynamics.friction.hand_object"),
                delay = offset_of(p, "dynamics.action_delay");
  for (const int32_t at : {mass, kp, joint, friction, delay}) ASSERT_GE(at, plain->obs_dim());
  p->reset(nullptr, nullptr);
  const Scene& scene = p->task().scene();
  std::vector<int> delays(5);
  double least = 1, most = -1;
  for (int episode = 0; episode < 4; ++episode) {
    for (int32_t e = 0; e < 16; ++e) {
      const Dynamics* d = p->world(e).dynamics();
      const float* obs = p.obs(e);
      // masses: of the scene 0.165 kg, so the body says the mass itself
      EXPECT_NEAR(obs[mass], place(d->body_inertia(scene, 0).mass, 0.03, 0.3), 1e-5);
      int32_t wrist = -1, other = -1;  // two links of one hand, one with a range of its own
      for (int32_t i = 1; i < d->num_links; ++i)
        if (d->links[i].kp != d->links[0].kp && wrist < 0)
          wrist = i;
        else
          other = i;
      // either link 0 is the wrist or another one is: the factor that most links have is the scale's
      int32_t with = 0;
      for (int32_t i = 0; i < d->num_links; ++i) with += d->links[i].kp == d->links[0].kp;
      const double scale = with > d->num_links / 2 ? d->links[0].kp : d->links[other].kp;
      EXPECT_NEAR(obs[kp], place(scale, 0.6 / 1.05, 1.5 / 1.05), 1e-5);
      double own = 1;
      for (int32_t i = 0; i < d->num_links; ++i)
        if (std::abs(d->links[i].kp - scale) > 1e-9) own = d->links[i].kp / scale;
      EXPECT_NEAR(obs[joint], place(own, 1 / 1.5, 2 / 1.5), 1e-4);
      EXPECT_GE(obs[friction], -1);
      EXPECT_LE(obs[friction], 1);
      least = std::min(least, static_cast<double>(obs[kp])),
      most = std::max(most, static_cast<double>(obs[kp]));
      const double steps = 2 * (static_cast<double>(obs[delay]) + 1);
      ASSERT_NEAR(steps, std::round(steps), 1e-6);
      ++delays[static_cast<size_t>(std::lround(steps))];
    }
    p->reset(nullptr, nullptr);
  }
  EXPECT_LT(least, -0.5);
  EXPECT_GT(most, 0.5);
  for (const int n : delays) EXPECT_GT(n, 0);
}

TEST_F(DynamicsShown, TheyStayThroughAnEpisodeAndComeBackWithAState) {
  TestPool p("grasp", 3, {{"show_dynamics", "true", 0}, {"level", nullptr, 2}, {"action_delay", "1..3", 0}});
  p->reset(nullptr, nullptr);
  const auto rows = [&] {
    std::vector<float> all;
    for (int32_t e = 0; e < 3; ++e)
      for (int32_t k = 0, at = 0; k < static_cast<int32_t>(p->task().fields().size()); ++k) {
        const FieldSpec& f = p->task().fields()[static_cast<size_t>(k)];
        if (std::strncmp(f.name.text, "dynamics.", 9) == 0) all.push_back(p.obs(e)[at]);
        at += f.count;
      }
    return all;
  };
  const std::vector<float> first = rows();
  EXPECT_GT(first.size(), 3u * 8);
  const std::vector<unsigned char> state = p.state();
  for (int t = 0; t < 10; ++t) {
    p->baseline(Baseline::kRandom);
    p->step(nullptr);
    ASSERT_EQ(rows(), first);
  }
  p->reset(nullptr, nullptr);
  EXPECT_NE(rows(), first);
  p->set_state(-1, state.data(), state.size());
  EXPECT_EQ(rows(), first);
}

TEST_F(DynamicsShown, NothingIsThereWithoutTheOptionAndNothingDrawnIsSaid) {
  TestPool plain("grasp", 2, {{"scale.kp", "0.7..1.3", 0}}),
      off("grasp", 2, {{"scale.kp", "0.7..1.3", 0}, {"show_dynamics", "false", 0}}),
      shown("grasp", 2, {{"scale.kp", "0.7..1.3", 0}, {"show_dynamics", "true", 0}});
  for (TestPool* p : {&plain, &off, &shown}) (*p)->reset(nullptr, nullptr);
  for (int t = 0; t < 5; ++t)
    for (TestPool* p : {&plain, &off, &shown}) (*p)->baseline(Baseline::kRandom), (*p)->step(nullptr);
  EXPECT_EQ(plain->options_hash(), off->options_hash());
  EXPECT_NE(plain->options_hash(), shown->options_hash());
  EXPECT_EQ(plain->hash(-1), off->hash(-1));
  EXPECT_EQ(shown->obs_dim(), plain->obs_dim() + 1);
  for (int32_t k = 0; k < plain->obs_dim(); ++k) EXPECT_EQ(plain.obs(1)[k], shown.obs(1)[k]);
  try {
    TestPool("grasp", 1, {{"show_dynamics", "true", 0}});
    ADD_FAILURE() << "nothing is drawn";
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Code::kArgument);
    EXPECT_NE(std::string(e.text).find("action_delay=0..4"), std::string::npos) << e.text;
  }
  TestPool small("two_state", 4, {{"show_dynamics", "true", 0}, {"action_delay", "0..2", 0}});
  EXPECT_EQ(small->obs_dim(), 3);
}

// A budget around it shows both, and a team's sets stay.
TEST_F(DynamicsShown, GoesWithABudgetAndTeams) {
  TestPool p("hand_over_safe_finger", 2,
             {{"show_dynamics", "true", 0}, {"action_delay", "0..4", 0}, {"budget", "show", 0}});
  const auto& fields = p->task().fields();
  ASSERT_GE(fields.size(), 2u);
  EXPECT_STREQ(fields[fields.size() - 2].name.text, "dynamics.action_delay");
  EXPECT_STREQ(fields[fields.size() - 1].name.text, "budget.left");
  const char *key = nullptr, *list = nullptr;
  ASSERT_TRUE(p->task().group_set_at(0, &key, &list));
  EXPECT_STREQ(key, "groups.hands");
}

}  // namespace
}  // namespace rdm::test
