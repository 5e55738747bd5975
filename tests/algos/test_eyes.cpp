// Agents whose actor sees points: what holds for each algorithm, and what is their own.
#include <cmath>
#include <cstring>
#include <numeric>

#include "algos/agent/agent.hpp"
#include "algos/trust_region/trust_region.hpp"
#include "heap_count.hpp"
#include "nn/policy.hpp"
#include "point_world.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

AgentSetup small(const char* algo, int32_t threads = 0) {
  AgentSetup s = PointWorld::setup(algo, 40);
  s.config.num_threads = threads;
  s.config.seed = 11;
  return s;
}

std::vector<unsigned char> state_after(AgentSetup s, int epochs) {
  const AgentPtr a = s.make();
  PointWorld world(s.config.num_envs);
  for (int i = 0; i < epochs; ++i) world.epoch(*a);
  return saved(*a);
}

class Eyes : public testing::TestWithParam<int> {
 protected:
  const char* algo() const { return algo_at(GetParam()).name; }
};

std::vector<float> encoder_of(Agent& a) {
  std::vector<float> all;
  TensorInfo t;
  for (int32_t i = 0; a.tensor(i, &t); ++i)
    if (std::strncmp(t.name, "encoder.", 8) == 0)
      all.insert(all.end(), t.data, t.data + size_of(t.rows) * size_of(t.cols));
  return all;
}

}  // namespace

// The object is uniform in [-1, 1]^2: who does not see it has -2/3 at best.
TEST_P(Eyes, LearnsWhatABlindPolicyCannot) {
  AgentSetup s = PointWorld::setup(algo(), 128);
  s.config.seed = 3;
  const AgentPtr a = s.make();
  PointWorld world(128, 5);
  EXPECT_LT(world.judge(*a, 10), -0.4) << "nothing is known at first";
  for (int i = 0; i < 150; ++i) world.epoch(*a);
  EXPECT_GT(world.judge(*a, 20), -0.25);
}

TEST_P(Eyes, SameBytesForAnyThreads) {
  const auto wanted = state_after(small(algo()), 3);
  for (const int32_t threads : {1, 2, 4})
    EXPECT_EQ(state_after(small(algo(), threads), 3), wanted) << threads;
}

TEST_P(Eyes, ResumeEqualsUnbroken) {
  for (const char* frozen : {"off", "on"}) {
    SCOPED_TRACE(frozen);
    AgentSetup s = small(algo());
    s.with("encoder_frozen", frozen).with("average", "0.6");
    const AgentPtr whole = s.make();
    PointWorld world(40);
    for (int i = 0; i < 2; ++i) world.epoch(*whole);
    const auto bytes = saved(*whole);
    AgentSetup other = small(algo(), 2);
    other.with("encoder_frozen", frozen).with("average", "0.6");
    other.config.seed = 999;
    const AgentPtr resumed = other.make();
    resumed->load(bytes.data(), bytes.size());
    PointWorld copy = world;
    for (int i = 0; i < 2; ++i) world.epoch(*whole), copy.epoch(*resumed);
    EXPECT_EQ(saved(*whole), saved(*resumed));
  }
}

TEST_P(Eyes, NoHeapInActRecordUpdate) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is the sanitizer's here";
  for (const int32_t threads : {0, 2}) {
    AgentSetup s = small(algo(), threads);
    s.with("encoder_classes", "2");
    const AgentPtr a = s.make();
    PointWorld world(40);
    Epoch e;
    const int64_t before = heap_count();
    for (int i = 0; i < 2; ++i) world.epoch(*a, &e);
    world.judge(*a, 1);
    EXPECT_EQ(heap_count(), before) << threads;
  }
}

// All but the encoder moves.
TEST_P(Eyes, AFrozenEncoderStaysAsItIs) {
  AgentSetup s = small(algo());
  s.with("encoder_frozen", "on");
  const AgentPtr a = s.make();
  PointWorld world(40);
  const auto before = encoder_of(*a), all = parameters(*a);
  for (int i = 0; i < 2; ++i) world.epoch(*a);
  EXPECT_EQ(encoder_of(*a), before);
  EXPECT_NE(parameters(*a), all);

  const AgentPtr free = small(algo()).make();
  const auto first = encoder_of(*free);
  ASSERT_EQ(first, before);
  for (int i = 0; i < 2; ++i) world.epoch(*free);
  const auto after = encoder_of(*free);
  size_t moved = 0;
  for (size_t i = 0; i < after.size(); ++i) moved += after[i] != first[i];
  EXPECT_GT(moved, after.size() / 2);
}

INSTANTIATE_TEST_SUITE_P(List, Eyes, testing::ValuesIn(on_policy_algos()),
                         [](const auto& info) { return std::string(algo_at(info.param).name); });

TEST(Eyes, ABlindPolicyCannot) {
  AgentSetup s = PointWorld::setup("ppo", 128);
  s.with("encoder", "");
  const AgentPtr a = s.make();
  PointWorld world(128, 5);
  for (int i = 0; i < 150; ++i) world.epoch(*a);
  EXPECT_LT(world.judge(*a, 20), -0.6);
}

TEST(Eyes, AHiddenObjectIsNowhereInTheAction) {
  AgentSetup s = small("ppo_lag");
  const AgentPtr a = s.make();
  PointWorld world(40);
  world.epoch(*a);
  world.judge(*a, 1);
  const auto action = world.action;
  auto obs = world.obs;
  for (size_t i = 0; i < 40; ++i) obs[i * 5 + 3] = 1e3f, obs[i * 5 + 4] = -7;
  a->act(obs.data(), false, world.action.data(), world.clouds());
  EXPECT_EQ(world.action, action);
  obs = world.obs;
  for (size_t i = 0; i < 40; ++i) obs[i * 5] += 1;
  a->act(obs.data(), false, world.action.data(), world.clouds());
  EXPECT_NE(world.action, action) << "its own joints it sees";
  world.draw();
  a->act(world.obs.data(), false, world.action.data(), world.clouds());
  EXPECT_NE(world.action, action);
}

TEST(Eyes, AnyOrderAndRepeatsOfPointsGiveTheSameAction) {
  for (const char* classes : {"0", "2"}) {
    AgentSetup s = small("ppo_lag");
    s.with("encoder_classes", classes);
    const AgentPtr a = s.make();
    PointWorld world(40);
    world.epoch(*a);
    // the second half repeats the first
    for (size_t i = 0; i < 40 * kWorldPoints; ++i)
      if (i % kWorldPoints >= kWorldPoints / 2) {
        std::copy_n(&world.points[3 * (i - kWorldPoints / 2)], 3, &world.points[3 * i]);
        world.point_class[i] = world.point_class[i - kWorldPoints / 2];
      }
    a->act(world.obs.data(), false, world.action.data(), world.clouds());
    const auto action = world.action;
    // turned about, and other points repeated
    for (size_t i = 0; i < 40; ++i)
      for (size_t p = 0; p < kWorldPoints; ++p) {
        const size_t from = i * kWorldPoints + (p * 5 + 3) % (kWorldPoints / 2), to = i * kWorldPoints + p;
        if (p < kWorldPoints / 2) continue;
        std::copy_n(&world.points[3 * from], 3, &world.points[3 * to]);
        world.point_class[to] = world.point_class[from];
      }
    for (size_t i = 0; i < 40; ++i)
      for (size_t p = 0; p < kWorldPoints / 2; ++p) {
        const size_t x = i * kWorldPoints + p, y = i * kWorldPoints + kWorldPoints - 1 - p;
        std::swap_ranges(&world.points[3 * x], &world.points[3 * x + 3], &world.points[3 * y]);
        std::swap(world.point_class[x], world.point_class[y]);
      }
    a->act(world.obs.data(), false, world.action.data(), world.clouds());
    EXPECT_EQ(world.action, action);
  }
}

// The gradient of a regression's loss, every parameter of the actor's block, by differences: trunk and
// encoder.
TEST(Eyes, GradientsAgreeWithDifferences) {
  for (const char* activation : {"tanh", "elu", "relu"})
    for (const char* std_mode : {"free", "state"}) {
      SCOPED_TRACE(std::string(activation) + " " + std_mode);
      AgentSetup s = PointWorld::setup("ppo", 8, "6,8");
      s.with("encoder_activation", activation).with("activation", "elu").with("std_mode", std_mode);
      s.with("last_layer_scale", "1").with("hidden", "7").with("encoder_classes", "2");
      ResolvedAgentConfig resolved = resolve_config(s.ready());
      const auto carve = [&](Arena& arena, Networks& n, ActorScratch& scratch) {
        n = carve_networks(arena, resolved);
        scratch = carve_actor_scratch(arena, resolved, 8);
      };
      Networks nets;
      ActorScratch scratch;
      Arena measure;
      carve(measure, nets, scratch);
      Arena arena(HostHooks{}, measure.used());
      carve(arena, nets, scratch);
      init_networks(nets, resolved);
      PointWorld world(8);
      const size_t out = size_of(nets.shape[Networks::kActor].out);
      std::vector<float> y(8 * out), dy(8 * out), grad(nets.size), v(nets.size), jv(8 * out);
      Stream stream(4, 0, Purpose::kTest);
      for (float& x : dy) x = static_cast<float>(stream.signed_unit());
      for (float& x : v) x = static_cast<float>(stream.signed_unit());
      const auto loss = [&] {
        nets.forward_actor(world.obs.data(), world.clouds(), 8, scratch, y.data());
        double sum = 0;
        for (size_t i = 0; i < y.size(); ++i) sum += static_cast<double>(y[i]) * static_cast<double>(dy[i]);
        return sum;
      };
      loss();
      const size_t begin = nets.std_size, end = nets.block[Networks::kActor].size;
      nets.backward_actor(world.obs.data(), world.clouds(), 8, scratch, dy.data(), grad.data());
      nets.tangent_actor(v.data() + begin, world.obs.data(), world.clouds(), 8, scratch, jv.data());
      double left = 0, right = 0, top = 0;
      for (size_t i = 0; i < jv.size(); ++i) left += static_cast<double>(jv[i]) * static_cast<double>(dy[i]);
      for (size_t i = begin; i < end; ++i) {
        right += static_cast<double>(grad[i]) * static_cast<double>(v[i]);
        top = std::max(top, std::abs(static_cast<double>(grad[i])));
      }
      EXPECT_NEAR(left, right, 1e-4 * std::abs(right) + 1e-4);
      const float h = 2e-3f;
      size_t far = 0;
      for (size_t i = begin; i < end; ++i) {
        const float kept = nets.params[i];
        nets.params[i] = kept + h;
        const double up = loss();
        nets.params[i] = kept - h;
        const double slope = (up - loss()) / (2 * static_cast<double>(h));
        nets.params[i] = kept;
        // a step may go over an edge of max or relu
        far += std::abs(slope - static_cast<double>(grad[i])) > 5e-3 * top;
      }
      EXPECT_LE(far, (end - begin) / 50);
    }
}

TEST(Eyes, ThePolicyFileActsAsTheAgent) {
  for (const char* classes : {"0", "2"})
    for (const char* list : {"vision", "*"})
      for (const char* std_mode : {"free", "state"}) {
        AgentSetup s = small("ppo_lag");
        s.with("encoder_classes", classes).with("actor_obs", list).with("std_mode", std_mode);
        s.with("encoder_origin", "0.1, 0, -0.25").with("encoder_range", "0.5");
        const AgentPtr a = s.make();
        PointWorld world(40);
        for (int i = 0; i < 2; ++i) world.epoch(*a);
        world.judge(*a, 1);
        const auto wanted = world.action;
        const auto file = policy_file(*a);
        Policy* p = Policy::read(file.data(), file.size(), HostHooks{});
        const PolicyView& v = p->view();
        EXPECT_EQ(v.eyes.points, kWorldPoints);
        EXPECT_EQ(v.eyes.classes, classes[0] - '0');
        EXPECT_EQ(v.eyes.features(), 16);
        EXPECT_EQ(v.obs_dim(), 5);
        EXPECT_EQ(v.entries(), list[0] == '*' ? 5 : 3);
        Vector<float> scratch(p->scratch_bytes(40) / sizeof(float) + 16);
        void* at =
            scratch.data() + (64 - reinterpret_cast<uintptr_t>(scratch.data()) % 64) % 64 / sizeof(float);
        p->act(world.obs.data(), 40, nullptr, world.action.data(), at, world.clouds());
        EXPECT_EQ(world.action, wanted);

        // written again it is the same file, and another agent takes it
        const auto again = written([&](Writer& w) { write_policy(w, v); });
        EXPECT_EQ(again, file);
        AgentSetup t = s;
        t.config.seed = 77;
        const AgentPtr b = t.make();
        b->load_policy(v, 1000);
        b->act(world.obs.data(), false, world.action.data(), world.clouds());
        for (size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(world.action[i], wanted[i], 1e-6f);
        Policy::destroy(p);
        for (size_t cut = 0; cut < file.size(); cut += 97)
          EXPECT_EQ(thrown([&] { Policy::destroy(Policy::read(file.data(), cut, HostHooks{})); }).code,
                    Code::kFormat);
      }
}

TEST(Eyes, WhatDiffersFromThePolicyIsNamed) {
  AgentSetup s = small("ppo_lag");
  const AgentPtr a = s.make();
  const auto file = policy_file(*a);
  Policy* p = Policy::read(file.data(), file.size(), HostHooks{});
  const auto refused = [&](const char* key, const char* value) {
    AgentSetup t = small("ppo_lag");
    t.with(key, value);
    const AgentPtr b = t.make();
    return thrown([&] { b->load_policy(p->view(), 1000); }).text;
  };
  EXPECT_EQ(refused("encoder", ""), "policy: encoder_points differs from the agent's");
  EXPECT_EQ(refused("encoder_points", "25"), "policy: encoder_points differs from the agent's");
  EXPECT_EQ(refused("encoder", "16,17"), "policy: encoder differs from the agent's");
  EXPECT_EQ(refused("encoder_classes", "3"), "policy: encoder differs from the agent's");
  EXPECT_EQ(refused("encoder_activation", "elu"), "policy: encoder differs from the agent's");
  EXPECT_EQ(refused("encoder_range", "0.5"),
            "policy: encoder_origin, or encoder_range, differs from the agent's");
  EXPECT_EQ(refused("actor_obs", "*"), "policy: actor_obs differs from the agent's");
  EXPECT_EQ(refused("encoder_frozen", "on"), "");
  Policy::destroy(p);
}

TEST(Eyes, ErrorsNameTheArgument) {
  AgentSetup s = small("ppo_lag");
  s.with("encoder_classes", "2");
  const AgentPtr a = s.make();
  PointWorld world(40);
  const auto act = [&](Agent& agent, const PointRows& clouds) {
    return thrown([&] { agent.act(world.obs.data(), true, world.action.data(), clouds); });
  };
  EXPECT_EQ(act(*a, {}).text, "act: the agent's encoder needs points; call rdm_agent_act_points");
  PointRows plain = world.clouds();
  plain.classes = nullptr;
  EXPECT_EQ(act(*a, plain).text, "point_class is NULL, but the encoder reads 2 classes");
  world.point_class[3 * kWorldPoints] = 2;
  EXPECT_EQ(act(*a, world.clouds()).text, "point_class: row 3 has class 2, which is outside [0, 2)");
  world.point_class[3 * kWorldPoints] = 1;
  world.points[5 * kWorldPoints * 3 + 7] = NAN;
  EXPECT_EQ(act(*a, world.clouds()).text, "points: row 5 is not finite");
  world.draw();
  AgentSetup blind = small("ppo_lag");
  blind.with("encoder", "");
  const AgentPtr b = blind.make();
  EXPECT_EQ(act(*b, world.clouds()).text, "points: the agent has no encoder, so it cannot read them");
  world.epoch(*a);  // nothing was lost
  world.epoch(*b);

  const auto made = [&](const char* key, const char* value) {
    AgentSetup t = small("ppo_lag");
    t.with(key, value);
    return thrown([&] { t.make(); }).text;
  };
  EXPECT_EQ(made("encoder", "64,x"), "encoder: '64,x' is not a list of widths such as 64,64");
  EXPECT_EQ(made("encoder_origin", "1,2"), "encoder_origin: '1,2' is not three numbers such as 0,0,1");
  EXPECT_EQ(made("encoder_origin", "1,2,3,4"),
            "encoder_origin: '1,2,3,4' is not three numbers such as 0,0,1");
  EXPECT_EQ(made("encoder_origin", "0,0,nan"), "point origin: nan m is outside [-1e6, 1e6]");
  EXPECT_NE(made("encoder_classes", "65"), "");
  EXPECT_NE(made("encoder_points", "0"), "");
}

// A teacher's labels are learned from points alone.
TEST(Eyes, AStudentClonesWhatItSees) {
  for (const char* frozen : {"off", "on"}) {
    AgentSetup s = PointWorld::setup("ppo_lag", 64);
    s.with("encoder_frozen", frozen).with("encoder", "32,64");
    const AgentPtr a = s.make();
    PointWorld world(1000, 9);
    std::vector<int16_t> points(world.points.size());
    std::vector<float> label(2000);
    for (size_t i = 0; i < 1000; ++i)
      label[2 * i] = world.obs[5 * i + 3], label[2 * i + 1] = world.obs[5 * i + 4];
    quantize_points(a->eyes(), world.points.data(), world.points.size() / 3, points.data());
    DemoRows demo{1000, world.obs.data(), label.data(), nullptr, {}};
    CloneOptions how;
    how.epochs = 60, how.batch_rows = 100, how.learning_rate = 3e-3, how.patience = 0;
    EXPECT_EQ(thrown([&] { a->clone(demo, how); }).text,
              "recording: it has no points, which the agent's encoder needs");
    demo.clouds.points = points.data();
    const auto before = encoder_of(*a);
    const CloneReport report = a->clone(demo, how);
    EXPECT_LT(report.validation_loss, frozen[1] == 'f' ? 0.03 : 0.1);
    EXPECT_EQ(encoder_of(*a) == before, frozen[1] == 'n');
    PointWorld other(64, 21);
    EXPECT_GT(other.judge(*a, 10), frozen[1] == 'f' ? -0.1 : -0.3);

    // and it is held near them while it learns
    AgentSetup t = PointWorld::setup("ppo_lag", 64);
    t.with("encoder_frozen", frozen).with("imitation", "0.1");
    const AgentPtr b = t.make();
    b->set_recording(demo, 5);
    other.epoch(*b);
  }
}

namespace {
std::vector<unsigned char> pretrained(int32_t threads, PretrainReport* report,
                                      const char* encoder = "16,16") {
  AgentSetup s = PointWorld::setup("ppo_lag", 40, encoder);
  s.config.num_threads = threads;
  const AgentPtr a = s.make();
  PointWorld world(200, 4);
  PretrainOptions how;
  how.num_labels = 2, how.epochs = 15, how.learning_rate = 5e-3;
  *report = a->pretrain(world.clouds(), world.point_class.data(), 200, how);
  return saved(*a);
}
}  // namespace

// Half of the points are the object's, a fifth of a metre above the others.
TEST(Eyes, PretrainingTellsPointsApart) {
  PretrainReport report, other;
  const auto state = pretrained(0, &report);
  EXPECT_EQ(report.train_rows, 180);
  EXPECT_EQ(report.validation_rows, 20);
  EXPECT_EQ(report.most_common, 0.5);
  EXPECT_GT(report.accuracy, 0.98);
  EXPECT_LT(report.validation_loss, 0.1);
  for (const int32_t threads : {1, 2, 4}) EXPECT_EQ(pretrained(threads, &other), state) << threads;
  pretrained(0, &report, "24");
  EXPECT_GT(report.accuracy, 0.98) << "without hidden layers";
}

TEST(Eyes, PretrainingChangesTheEncoderAlone) {
  AgentSetup s = small("ppo_lag");
  const AgentPtr a = s.make();
  PointWorld world(40);
  const auto before = parameters(*a), eyes = encoder_of(*a);
  PretrainOptions how;
  how.num_labels = 2, how.epochs = 2;
  a->cancel();
  EXPECT_EQ(thrown([&] { a->pretrain(world.clouds(), world.point_class.data(), 40, how); }).code,
            Code::kCancelled);
  EXPECT_EQ(parameters(*a), before);
  a->pretrain(world.clouds(), world.point_class.data(), 40, how);
  const auto after = parameters(*a);
  ASSERT_EQ(after.size(), before.size());
  EXPECT_NE(encoder_of(*a), eyes);
  // tensors of the encoder are the last
  EXPECT_TRUE(std::equal(before.begin(), before.end() - static_cast<long>(eyes.size()), after.begin()));
  how.num_labels = 1;
  const auto text = [&] {
    return thrown([&] { a->pretrain(world.clouds(), world.point_class.data(), 40, how); }).text;
  };
  EXPECT_EQ(text(), "num_labels: 1 is outside [2, 64]");
  how.num_labels = 2, world.point_class[30] = 2;
  EXPECT_EQ(text(), "label: row 1 has 2, which is outside [0, 2)");
  world.draw();
  world.decide(*a);
  EXPECT_EQ(text(), "pretrain is allowed between epochs only, and this horizon has begun");
}

// Products that keep the points that won are J' W J v + damping v by the whole network.
TEST(Eyes, FisherProductsAreThoseOfTheWholeNetwork) {
  AgentSetup s = PointWorld::setup("trpo", 100);
  s.with("horizon", "2")
      .with("fisher_stride", "2")
      .with("encoder_classes", "2")
      .with("last_layer_scale", "1");
  const ResolvedAgentConfig resolved = resolve_config(s.ready());
  struct {
    Networks nets;
    BatchWorkers workers;
    Rollout rollout;
    Fisher fisher;
    void carve(Arena& arena, const ResolvedAgentConfig& r) {
      nets = carve_networks(arena, r);
      workers.carve(arena, r, nets.size);
      rollout = carve_rollout(arena, r);
      fisher.carve(arena, r);
    }
  } b;
  Arena measure;
  b.carve(measure, resolved);
  Arena arena(HostHooks{}, measure.used());
  b.carve(arena, resolved);
  b.workers.open(HostHooks{}, 0);
  init_networks(b.nets, resolved);
  PointWorld world(200);
  std::copy(world.obs.begin(), world.obs.end(), b.rollout.obs);
  std::copy(world.point_class.begin(), world.point_class.end(), b.rollout.point_class);
  quantize_points(b.nets.eyes, world.points.data(), world.points.size() / 3, b.rollout.points);
  std::vector<int32_t> order(200);
  for (int32_t i = 0; i < 200; ++i) order[size_of(i)] = (i * 7 + 3) % 200;
  b.fisher.open(resolved, b.rollout, b.nets, b.workers);
  b.fisher.read_live(kTrustRows.read(resolved.options));
  b.fisher.set_rows({order.data(), 200});
  const size_t size = b.nets.block[Networks::kActor].size, skip = b.nets.std_size;
  std::vector<float> v(size), product(size), part(b.nets.size);
  std::vector<double> wanted(size);
  Stream stream(8, 0, Purpose::kTest);
  for (float& x : v) x = static_cast<float>(stream.signed_unit());
  b.fisher.multiply(v.data(), product.data());

  // by the whole network, chunk after chunk
  const Workspace& w = b.workers[0];
  ASSERT_LT(w.rows, 100) << "several chunks";
  const auto weight = static_cast<float>(1 / (0.3 * 0.3 * 100));
  for (int32_t first = 0; first < 100; first += w.rows) {
    const int32_t n = std::min(w.rows, 100 - first), *rows = order.data() + 2 * first;
    const PointRows clouds = b.rollout.clouds(rows, 2);
    gather_obs(b.rollout, rows, 2, n, w.obs);
    b.nets.forward_actor(w.obs, clouds, n, w.actor, w.out);
    b.nets.tangent_actor(v.data() + skip, w.obs, clouds, n, w.actor, w.dout);
    for (size_t i = 0; i < 2 * size_of(n); ++i) w.dout[i] *= weight;
    b.nets.backward_actor(w.obs, clouds, n, w.actor, w.dout, part.data());
    for (size_t i = skip; i < size; ++i) wanted[i] += static_cast<double>(part[i]);
  }
  double top = 0, gap = 0;
  for (size_t i = skip; i < size; ++i) {
    const double exact = wanted[i] + 0.1 * static_cast<double>(v[i]);
    top = std::max(top, std::abs(exact));
    gap = std::max(gap, std::abs(exact - static_cast<double>(product[i])));
  }
  EXPECT_LT(gap, 1e-5 * top);
}

// What would lose against any other point unseen, for it is no number, does not load.
TEST(Eyes, AStateWithAnEncoderThatOverflowsIsRefused) {
  AgentSetup s = small("ppo_lag"), t = small("ppo_lag");
  t.config.seed = 5;
  const AgentPtr a = s.make(), b = t.make();
  const auto good = saved(*a);
  TensorInfo found{};
  for (int32_t i = 0; a->tensor(i, &found) && std::strcmp(found.name, "encoder.0.weight") != 0; ++i) {
  }
  ASSERT_STREQ(found.name, "encoder.0.weight");
  found.data[0] = 1e17f;
  const auto bad = saved(*a);
  const Thrown refused = thrown([&] { b->load(bad.data(), bad.size()); });
  EXPECT_EQ(refused.code, Code::kFormat);
  EXPECT_NE(refused.text.find("too large"), std::string::npos) << refused.text;
  b->load(good.data(), good.size());
  EXPECT_EQ(saved(*b), good);

  // another encoder's state is another agent's
  AgentSetup other = small("ppo_lag");
  other.with("encoder_range", "0.5");
  const AgentPtr c = other.make();
  EXPECT_NE(thrown([&] { c->load(good.data(), good.size()); }).text.find("encoder_range"), std::string::npos);
}

// Cross-entropy of points by differences: head, features, and hidden layers both of winners and of each
// point.
TEST(Eyes, ThePretrainingGradientAgreesWithDifferences) {
  for (const char* activation : {"tanh", "elu"})
    for (const char* encoder : {"6,7", "5,6,7", "9"}) {
      SCOPED_TRACE(std::string(activation) + " " + encoder);
      AgentSetup s = PointWorld::setup("ppo", 8, encoder);
      s.with("encoder_activation", activation).with("encoder_classes", "2");
      const ResolvedAgentConfig resolved = resolve_config(s.ready());
      const PointNetShape& eyes = resolved.eyes;
      BatchWorkers workers;
      Arena measure;
      workers.carve(measure, resolved, 1);
      Arena arena(HostHooks{}, measure.used());
      workers.carve(arena, resolved, 1);
      workers.open(HostHooks{}, 0);
      PointWorld world(7);
      std::vector<int16_t> points(world.points.size());
      quantize_points(eyes, world.points.data(), world.points.size() / 3, points.data());
      std::vector<uint8_t> label(world.point_class.size());
      Stream stream(6, 0, Purpose::kTest);
      for (auto& l : label) l = static_cast<uint8_t>(stream.below(3));
      PointRows clouds;
      clouds.points = points.data(), clouds.classes = world.point_class.data();
      const int32_t order[] = {6, 0, 3, 4, 1};
      std::vector<float> params(segmentation_params(eyes, 3)), grad(params.size());
      for (float& p : params) p = 0.5f * static_cast<float>(stream.signed_unit());
      const auto loss = [&](float* g) {
        return segmentation_loss(eyes, clouds, label.data(), 3, order, 5, workers, params.data(), g);
      };
      loss(grad.data());
      double top = 0;
      for (const float g : grad) top = std::max(top, std::abs(static_cast<double>(g)));
      const float h = 4e-3f;
      size_t far = 0, far_eyes = 0;
      for (size_t i = 0; i < params.size(); i += i < eyes.num_params() ? 1 : 7) {
        const float kept = params[i];
        params[i] = kept + h;
        const double up = loss(nullptr);
        params[i] = kept - h;
        const double slope = (up - loss(nullptr)) / (2 * static_cast<double>(h));
        params[i] = kept;
        const bool bad = std::abs(slope - static_cast<double>(grad[i])) > 5e-3 * top;
        far += bad, far_eyes += bad && i < eyes.num_params();
      }
      EXPECT_LE(far, far_eyes) << "the head has no edges";
      EXPECT_LE(far_eyes, eyes.num_params() / 30) << "a step may go over an edge of the max";
    }
}
