// Agents and policies that see points, through the ABI and redman_points.hpp.
#include <gtest/gtest.h>
#include <redman/plan.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <redman/sense.hpp>
#include <string>
#include <vector>

namespace {

constexpr int32_t kEnvs = 8, kPoints = 32, kObs = 3, kActions = 2;

// Clouds, rows and actions of a host's own.
struct Host {
  explicit Host(int32_t rows = kEnvs)
      : obs(static_cast<size_t>(rows) * kObs),
        metres(static_cast<size_t>(rows) * kPoints * 3),
        action(static_cast<size_t>(rows) * kActions),
        reward(static_cast<size_t>(rows), 1),
        cost(static_cast<size_t>(rows)),
        classes(static_cast<size_t>(rows) * kPoints) {
    draw();
  }
  void draw() {
    for (float& x : obs) x = unit();
    for (float& x : metres) x = 0.2f * unit();
    for (size_t i = 0; i < classes.size(); ++i) classes[i] = metres[3 * i] > 0;
  }
  float unit() {
    seed = seed * 1664525u + 1013904223u;
    return static_cast<float>(seed >> 8) / static_cast<float>(1 << 23) - 1;
  }
  rdm_points seen() const { return redman::points(metres.data(), kPoints, classes.data()); }
  void epoch(redman::Agent& a, int32_t horizon = 4) {
    auto t = redman::sized<rdm_transition>();
    t.reward = reward.data(), t.cost = cost.data();
    for (int32_t i = 0; i < horizon; ++i) {
      redman::act(a, obs.data(), seen(), RDM_ACT_SAMPLE, action.data());
      draw();
      a.record(t);
    }
    a.update(obs.data());
  }
  uint32_t seed = 7;
  std::vector<float> obs, metres, action, reward, cost;
  std::vector<uint8_t> classes;
};

redman::Agent agent_of(const char* settings, int32_t envs = kEnvs) {
  rdm_agent_config c = redman::agent_config(kObs, kActions, envs);
  c.settings = settings;
  return redman::Agent(c);
}
constexpr const char* kEyes = "encoder=8,12\nencoder_points=32\nencoder_classes=2\nhorizon=4\nhidden=16";
constexpr const char* kBlind = "horizon=4\nhidden=16";

std::string error_of(const redman::Agent& a, const rdm_points* seen, Host& h, rdm_result code) {
  EXPECT_EQ(rdm_agent_act_points(a.get(), h.obs.data(), seen, RDM_ACT_SAMPLE, h.action.data()), code);
  return rdm_agent_error(a.get());
}

}  // namespace

TEST(Points, AnAgentLearnsAndItsPolicyActs) {
  redman::Agent a = agent_of(kEyes);
  Host h;
  for (int i = 0; i < 3; ++i) h.epoch(a);
  redman::act(a, h.obs.data(), h.seen(), RDM_ACT_MEAN, h.action.data());
  const auto wanted = h.action;
  const redman::Policy p(a.policy());
  EXPECT_EQ(p.info().obs_dim, kObs);
  EXPECT_EQ(p.info().num_points, kPoints);
  EXPECT_EQ(p.info().num_point_classes, 2);
  EXPECT_EQ(p.info().num_features, 12);
  redman::act(p, h.obs.data(), h.seen(), kEnvs, nullptr, h.action.data());
  EXPECT_EQ(h.action, wanted);
  h.metres[0] += 0.5f;
  redman::act(p, h.obs.data(), h.seen(), kEnvs, nullptr, h.action.data());
  EXPECT_NE(h.action, wanted);

  // an older host has no such members
  auto info = redman::sized<rdm_policy_info>();
  info.struct_size = offsetof(rdm_policy_info, num_points);
  info.num_points = -5;
  EXPECT_EQ(rdm_policy_get_info(p.get(), &info), RDM_OK);
  EXPECT_EQ(info.num_points, -5);
}

TEST(Points, ThePolicyIsShownAsTensors) {
  redman::Agent a = agent_of(
      "encoder=8,12\nencoder_points=32\nencoder_classes=2\nhidden=16\nencoder_origin=0.5,0,-1\nhorizon=4");
  Host h;
  h.epoch(a);
  const redman::Policy p(a.policy());
  uint64_t count = 0;
  std::vector<float> origin, range, activation, points, classes, example;
  int32_t inputs = 0, first = 0, last = 0;
  for (const rdm_tensor& t : p.tensors()) {
    const std::string name = t.name;
    const auto values = p.read(t);
    if (name.rfind("actor.", 0) == 0 || name.rfind("encoder.", 0) == 0) count += values.size();
    if (name == "actor.0.weight") inputs = t.cols;
    if (name == "encoder.0.weight") first = t.cols;
    if (name == "encoder.1.bias") last = t.rows;
    if (name == "encoder.origin") origin = values;
    if (name == "encoder.range") range = values;
    if (name == "encoder.activation") activation = values;
    if (name == "example.points") points = values;
    if (name == "example.point_class") classes = values;
    if (name == "example.action") example = values;
  }
  EXPECT_EQ(inputs, kObs + 12);
  EXPECT_EQ(first, 5);
  EXPECT_EQ(last, 12);
  EXPECT_EQ(origin, (std::vector<float>{0.5f, 0, -1}));
  EXPECT_EQ(range, std::vector<float>{0.25f});
  EXPECT_EQ(activation, std::vector<float>{2}) << "relu";
  EXPECT_EQ(count, p.info().num_params + kActions + 5) << "log_std, origin, range and activation are not";
  ASSERT_EQ(points.size(), size_t{3 * kPoints});
  ASSERT_EQ(classes.size(), size_t{kPoints});
  // the example's points, as metres, give the example's action
  std::vector<uint8_t> kinds(classes.begin(), classes.end());
  std::vector<float> obs, action(kActions);
  for (const rdm_tensor& t : p.tensors())
    if (std::string(t.name) == "example.obs") obs = p.read(t);
  redman::act(p, obs.data(), redman::points(points.data(), kPoints, kinds.data()), 1, nullptr, action.data());
  EXPECT_EQ(action, example);

  // of a part of the row: zeros stand for what is not seen, features come behind
  rdm_agent_config c = redman::agent_config(kObs, kActions, kEnvs);
  rdm_field fields[2] = {};
  fields[0].name = "own", fields[0].count = 1;
  fields[1].name = "object", fields[1].offset = 1, fields[1].count = 2;
  c.fields = fields, c.num_fields = 2;
  c.settings = "encoder=8,12\nencoder_points=32\nactor_obs=own\nhidden=16";
  const redman::Agent part(c);
  const redman::Policy q(part.policy());
  for (const rdm_tensor& t : q.tensors()) {
    if (std::string(t.name) != "actor.0.weight") continue;
    const auto w = q.read(t);
    ASSERT_EQ(t.cols, kObs + 12);
    std::vector<float> own(16 * 13);
    ASSERT_EQ(rdm_agent_get_tensor(part.get(), "actor.0.weight", own.data(), own.size()), RDM_OK);
    for (size_t r = 0; r < 16; ++r) {
      EXPECT_EQ(w[r * 15], own[r * 13]);
      EXPECT_EQ(w[r * 15 + 1], 0);
      EXPECT_EQ(w[r * 15 + 2], 0);
      for (size_t k = 0; k < 12; ++k) EXPECT_EQ(w[r * 15 + 3 + k], own[r * 13 + 1 + k]);
    }
  }
}

// In colour: learned, kept in the file with an example, and no other thing than places and classes.
TEST(Points, ColoursAreSeen) {
  redman::Agent a = agent_of(
      "encoder=8,12\nencoder_points=32\nencoder_classes=2\nencoder_color=true\nhidden=16\nhorizon=4");
  Host h;
  std::vector<uint8_t> colors(h.metres.size());
  for (size_t i = 0; i < colors.size(); ++i) colors[i] = static_cast<uint8_t>(i * 37);
  rdm_points seen = h.seen();
  EXPECT_EQ(error_of(a, &seen, h, RDM_ERROR_ARGUMENT), "point_color is NULL, but the encoder reads colours");
  seen.point_color = colors.data();
  seen.struct_size = offsetof(rdm_points, point_color);  // of an older host: as if it were NULL
  EXPECT_EQ(error_of(a, &seen, h, RDM_ERROR_ARGUMENT), "point_color is NULL, but the encoder reads colours");
  seen.struct_size = sizeof seen;
  auto t = redman::sized<rdm_transition>();
  t.reward = h.reward.data(), t.cost = h.cost.data();
  for (int i = 0; i < 4; ++i) {
    redman::act(a, h.obs.data(), seen, RDM_ACT_SAMPLE, h.action.data());
    a.record(t);
  }
  a.update(h.obs.data());
  redman::act(a, h.obs.data(), seen, RDM_ACT_MEAN, h.action.data());
  const auto wanted = h.action;
  const redman::Policy p(a.policy());
  EXPECT_EQ(p.info().point_color, 1);
  redman::act(p, h.obs.data(), seen, kEnvs, nullptr, h.action.data());
  EXPECT_EQ(h.action, wanted);
  for (uint8_t& c : colors) c = static_cast<uint8_t>(255 - c);
  redman::act(p, h.obs.data(), seen, kEnvs, nullptr, h.action.data());
  EXPECT_NE(h.action, wanted);
  for (const rdm_tensor& tensor : p.tensors()) {
    if (std::string(tensor.name) == "encoder.0.weight") {
      EXPECT_EQ(tensor.cols, 3 + 2 + 3);
    }
    if (std::string(tensor.name) != "example.point_color") continue;
    EXPECT_EQ(tensor.rows, kPoints);
    EXPECT_EQ(tensor.cols, 3);
    const auto values = p.read(tensor);
    EXPECT_GT(*std::max_element(values.begin(), values.end()), 200);
  }
  EXPECT_EQ(redman::Policy(agent_of(kEyes).policy()).info().point_color, 0);
}

TEST(Points, WhatIsWrongIsSaidInOneLine) {
  redman::Agent a = agent_of(kEyes);
  const redman::Agent blind = agent_of(kBlind);
  Host h;
  rdm_points seen = h.seen();
  EXPECT_EQ(rdm_agent_act(a.get(), h.obs.data(), RDM_ACT_SAMPLE, h.action.data()), RDM_ERROR_STATE);
  EXPECT_STREQ(rdm_agent_error(a.get()), "act: the agent's encoder needs points; call rdm_agent_act_points");
  EXPECT_EQ(error_of(blind, &seen, h, RDM_ERROR_STATE),
            "points: the agent has no encoder, so it cannot read them");
  EXPECT_EQ(error_of(a, nullptr, h, RDM_ERROR_ARGUMENT), "points is NULL");
  seen.struct_size = 0;
  EXPECT_EQ(error_of(a, &seen, h, RDM_ERROR_ARGUMENT), "points.struct_size: 0 is less than 24");
  seen = h.seen(), seen.points = nullptr;
  EXPECT_EQ(error_of(a, &seen, h, RDM_ERROR_ARGUMENT), "points.points is NULL");
  seen = h.seen(), seen.num_points = 31;
  EXPECT_EQ(error_of(a, &seen, h, RDM_ERROR_RANGE), "points.num_points: it is 31, but the encoder reads 32");
  seen = h.seen(), seen.point_class = nullptr;
  EXPECT_EQ(error_of(a, &seen, h, RDM_ERROR_ARGUMENT),
            "point_class is NULL, but the encoder reads 2 classes");
  seen = h.seen();
  h.classes[40] = 2;
  EXPECT_EQ(error_of(a, &seen, h, RDM_ERROR_RANGE),
            "point_class: row 1 has class 2, which is outside [0, 2)");
  h.classes[40] = 0;
  h.metres[3 * kPoints * 7 + 5] = INFINITY;
  EXPECT_EQ(error_of(a, &seen, h, RDM_ERROR_ARGUMENT), "points: row 7 is not finite");
  h.draw();
  h.epoch(a);  // nothing was remembered

  const redman::Policy p(a.policy()), q(blind.policy());
  std::vector<unsigned char> scratch(p.scratch_bytes(kEnvs));
  const auto act = [&](const redman::Policy& policy, int32_t rows, size_t size) {
    const rdm_result r = rdm_policy_act_points(policy.get(), h.obs.data(), &seen, rows, nullptr,
                                               h.action.data(), scratch.data(), size);
    return r == RDM_OK ? std::string() : std::string(rdm_last_error());
  };
  EXPECT_EQ(act(p, kEnvs, scratch.size()), "");
  EXPECT_EQ(act(q, kEnvs, scratch.size()), "policy: it does not read points");
  EXPECT_EQ(act(p, 0, scratch.size()), "rows: 0 is less than 1");
  EXPECT_NE(act(p, kEnvs, scratch.size() - 1), "");
  h.metres[4] = NAN;
  EXPECT_EQ(act(p, kEnvs, scratch.size()), "points: row 0 is not finite");
  h.metres[4] = 0, h.classes[0] = 7;
  EXPECT_EQ(act(p, kEnvs, scratch.size()), "point_class: row 0 has class 7, which is outside [0, 2)");
  EXPECT_EQ(
      rdm_policy_act(p.get(), h.obs.data(), 1, nullptr, h.action.data(), scratch.data(), scratch.size()),
      RDM_ERROR_STATE);
  EXPECT_STREQ(rdm_last_error(), "policy: it reads points; call rdm_policy_act_points");
}

TEST(Points, TheEncoderOfALatentIsAmongTheParameters) {
  const rdm_field fields[] = {{"seen", "1", 0, 2}, {"dynamics.drawn", "1", 2, kObs - 2}};
  rdm_agent_config c = redman::agent_config(kObs, kActions, kEnvs);
  c.settings = "encoder=8,12\nencoder_points=32\nlatent=3\nlatent_hidden=5\nhidden=16\nactor_obs=*";
  c.fields = fields, c.num_fields = 2;
  const redman::Agent a(c);
  const redman::Policy p(a.policy());
  size_t count = 0;
  for (const rdm_tensor& t : p.tensors()) {
    const std::string name = t.name;
    const bool of_layer =
        name.find(".weight") != std::string::npos || name.find(".bias") != std::string::npos;
    // the first layers have columns of zeros for entries of the row that they do not read
    const int32_t read = name == "actor.0.weight"    ? 2 + 3 + 12
                         : name == "latent.0.weight" ? kObs - 2
                                                     : t.cols;
    if (of_layer) count += static_cast<size_t>(t.rows) * static_cast<size_t>(read);
  }
  EXPECT_EQ(p.info().num_params, count);
}

// The agent keeps the states of its worlds; of a policy alone the caller does.
TEST(Points, WithAHistoryThePolicyTakesItsState) {
  redman::Agent a = agent_of("encoder=8,12\nencoder_points=32\nencoder_classes=2\nhorizon=4\nhistory=3");
  Host h;
  h.epoch(a);
  const redman::Policy p(a.policy());
  ASSERT_EQ(p.info().state_dim, 2 * kObs);
  std::vector<float> state(static_cast<size_t>(kEnvs * 2 * kObs)), action(h.action.size());
  for (int32_t decision = 0; decision < 6; ++decision) {
    h.draw();
    redman::act(a, h.obs.data(), h.seen(), RDM_ACT_MEAN, h.action.data());
    redman::act(p, h.obs.data(), h.seen(), state.data(), kEnvs, nullptr, action.data());
    for (size_t i = 0; i < action.size(); ++i) EXPECT_EQ(action[i], std::clamp(h.action[i], -1.0f, 1.0f));
  }
  // the newest decision of a state is the row that was seen, as the network sees it
  EXPECT_NE(state[0], 0);
  std::vector<unsigned char> scratch(p.scratch_bytes(kEnvs));
  const rdm_points seen = h.seen();
  const auto act = [&](float* remembered) {
    const rdm_result r = rdm_policy_act_points_state(p.get(), h.obs.data(), &seen, remembered, kEnvs, nullptr,
                                                     action.data(), scratch.data(), scratch.size());
    return r == RDM_OK ? std::string() : std::string(rdm_last_error());
  };
  EXPECT_EQ(act(nullptr), "state is NULL");
  const auto kept = state;
  state[3] = NAN;
  EXPECT_EQ(act(state.data()), "state: row 0 is not finite");
  state = kept;
  EXPECT_EQ(rdm_policy_act_points(p.get(), h.obs.data(), &seen, kEnvs, nullptr, action.data(), scratch.data(),
                                  scratch.size()),
            RDM_ERROR_STATE);
  EXPECT_STREQ(rdm_last_error(),
               "policy: it has a memory, so rdm_policy_act_points cannot run it; call "
               "rdm_policy_act_points_state");
  EXPECT_EQ(rdm_policy_act_state(p.get(), h.obs.data(), state.data(), kEnvs, nullptr, action.data(),
                                 scratch.data(), scratch.size()),
            RDM_ERROR_STATE);
  EXPECT_STREQ(rdm_last_error(), "policy: it reads points; call rdm_policy_act_points_state");
  EXPECT_EQ(state, kept);
}

TEST(Points, MemoryIsToldExactly) {
  for (const char* settings : {kEyes, "encoder=64,128\nencoder_frozen=on\nencoder_points=2048\nhorizon=4"}) {
    rdm_agent_config c = redman::agent_config(kObs, kActions, kEnvs);
    c.settings = settings;
    size_t live = 0, bytes = 0;
    rdm_host host{};
    host.struct_size = sizeof host;
    host.user = &live;
    host.alloc = [](void* user, size_t n, size_t align) -> void* {
      *static_cast<size_t*>(user) += n;
      return std::aligned_alloc(align, (n + align - 1) / align * align);
    };
    host.release = [](void* user, void* p, size_t n, size_t) {
      *static_cast<size_t*>(user) -= n;
      std::free(p);
    };
    c.host = &host;
    ASSERT_EQ(rdm_agent_config_memory(&c, &bytes), RDM_OK);
    EXPECT_EQ(live, 0u);
    {
      const redman::Agent a(c);
      EXPECT_EQ(live, bytes);
    }
    EXPECT_EQ(live, 0u);
  }
}

TEST(Points, PretrainingThroughTheAbi) {
  redman::Agent a = agent_of("encoder=16,16\nencoder_points=32\nhorizon=4\nhidden=16");
  Host h(60);
  auto how = redman::pretrain_config(2);
  EXPECT_EQ(how.epochs, 20);
  how.learning_rate = 5e-3;
  const auto seen = redman::points(h.metres.data(), kPoints);
  const auto report = redman::pretrain(a, seen, h.classes.data(), 60, how);
  EXPECT_EQ(report.train_rows, 54);
  EXPECT_GT(report.accuracy, 0.9);
  EXPECT_LT(report.most_common, 0.7);
  EXPECT_LT(report.validation_loss, 0.4);
  how.epochs = 0;
  EXPECT_EQ(rdm_agent_pretrain(a.get(), &seen, h.classes.data(), 60, &how, nullptr), RDM_ERROR_RANGE);
  EXPECT_STREQ(rdm_agent_error(a.get()), "epochs: 0 is outside [1, 100000]");
  how.epochs = 1;
  EXPECT_EQ(rdm_agent_pretrain(a.get(), &seen, h.classes.data(), 0, &how, nullptr), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_agent_pretrain(a.get(), &seen, nullptr, 60, &how, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_pretrain(a.get(), &seen, h.classes.data(), 60, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  const redman::Agent blind = agent_of(kBlind);
  EXPECT_EQ(rdm_agent_pretrain(blind.get(), &seen, h.classes.data(), 60, &how, nullptr), RDM_ERROR_STATE);
}

// A pool's own clouds: rollout takes them.
TEST(Points, ARolloutSeesWhatThePoolShows) {
  redman::Pool pool(redman::pool_config("hand_over_safe_finger", 2, "modality=points\npoints=64"));
  pool.reset();
  rdm_agent_config c = redman::agent_config(pool);
  const auto with = [&](const char* settings) {
    c.settings = settings;
    return redman::Agent(c);
  };
  const std::string common = "horizon=2\nhidden=8\naction_repeat=1\nminibatches=1\nactor_obs=vision\n";
  redman::Agent a = with((common + "encoder=8,16\nencoder_points=64").c_str());
  const rdm_epoch e = a.rollout(pool);
  EXPECT_EQ(e.epoch, 1);
  EXPECT_GT(e.env_steps, 0);
  const redman::Policy p(a.policy());
  size_t columns = 0;
  EXPECT_EQ(rdm_policy_get_columns(p.get(), nullptr, 0, &columns), RDM_OK);
  EXPECT_EQ(columns, 381u);

  redman::Agent b = with((common + "encoder=8,16\nencoder_points=65").c_str());
  EXPECT_EQ(rdm_agent_rollout(b.get(), pool.get(), nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_agent_error(b.get()), "encoder_points: the agent's encoder reads 65, but the pool has 64");
  // two hands, the object, anything else
  redman::Agent d = with((common + "encoder=8,16\nencoder_points=64\nencoder_classes=4").c_str());
  EXPECT_EQ(rdm_agent_rollout(d.get(), pool.get(), nullptr), RDM_OK) << rdm_agent_error(d.get());
  redman::Agent few = with((common + "encoder=8,16\nencoder_points=64\nencoder_classes=2").c_str());
  EXPECT_EQ(rdm_agent_rollout(few.get(), pool.get(), nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_agent_error(few.get()),
               "encoder_classes: the pool's points have 4 classes, but the agent's encoder reads 2");
  redman::Pool blind(redman::pool_config("hand_over_safe_finger", 2));
  blind.reset();
  EXPECT_EQ(rdm_agent_rollout(a.get(), blind.get(), nullptr), RDM_ERROR_STATE);
  EXPECT_STREQ(rdm_agent_error(a.get()),
               "pool: it has no points for the agent's encoder; set its option modality=points");

  auto plan = redman::sized<rdm_planner_config>();
  ASSERT_EQ(rdm_planner_config_init(&plan, sizeof plan), RDM_OK);
  plan.pool = blind.get(), plan.policy = p.get();
  rdm_planner* planner = nullptr;
  EXPECT_EQ(rdm_planner_create(&planner, &plan), RDM_ERROR_UNSUPPORTED);
}
