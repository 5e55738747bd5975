// Agents that remember learn from demonstrations: cloning, and the imitation term beside the losses of first-order and
// trust-region learners.
#include <cmath>

#include "agents.hpp"
#include "heap_count.hpp"
#include "nn/policy.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

// Episodes of 3 to 14 decisions of four worlds, whose rows stand in turn; labels are of rows that are gone.
struct Lesson {
  std::vector<float> obs, label;
  std::vector<int64_t> episode;
  Lesson() {
    Stream s(3, 0, Purpose::kTest);
    int64_t running[4] = {0, 1, 2, 3}, next = 4;
    int32_t left[4] = {3, 7, 14, 5};
    std::vector<float> before(4 * 6);
    for (int32_t t = 0; t < 300; ++t)
      for (size_t w = 0; w < 4; ++w) {
        float x[6];
        for (float& v : x) v = static_cast<float>(s.signed_unit());
        obs.insert(obs.end(), x, x + 6);
        for (size_t j = 0; j < 3; ++j) label.push_back(0.8f * before[w * 6 + j]);
        std::copy_n(x, 6, &before[w * 6]);
        episode.push_back(running[w]);
        if (--left[w] > 0) continue;
        left[w] = 3 + static_cast<int32_t>(s.below(12)), running[w] = next++;
        std::fill_n(&before[w * 6], 6, 0.0f);
      }
  }
  DemoRows rows(bool episodes = true) const {
    return {static_cast<int32_t>(episode.size()),
            obs.data(),
            label.data(),
            episodes ? episode.data() : nullptr,
            {}};
  }
};

struct Kind {
  const char *algo, *memory, *mode;
};
const Kind kKinds[] = {{"ppo", "gru:7", "free"},
                       {"ppo_lag", "gru:6", "state"},
                       {"trpo", "gru:5", "free"},
                       {"cpo", "gru:4", "state"}};

AgentSetup setup_of(const Kind& kind, int32_t threads = 0) {
  AgentSetup s(kind.algo, 6, 3, 40);
  s.config.seed = 4;
  s.config.num_threads = threads;
  s.with("hidden", "8,6").with("horizon", "12").with("passes", "2").with("minibatches", "3");
  s.with("memory", kind.memory).with("memory_chunk", "5").with("std_mode", kind.mode);
  return s.with("imitation", "0.3").with("warm_epochs", "1");
}

}  // namespace

TEST(MemoryLabels, CloningGivesTheSameBytesForAnyThreads) {
  const Lesson lesson;
  for (const Kind& kind : kKinds)
    for (const bool episodes : {true, false}) {
      SCOPED_TRACE(kind.algo);
      std::vector<unsigned char> wanted;
      for (const int32_t threads : {0, 2, 3}) {
        const AgentPtr a = setup_of(kind, threads).make();
        CloneOptions how;
        how.epochs = 3, how.seed = 9, how.batch_rows = 100;
        const CloneReport r = a->clone(lesson.rows(episodes), how);
        EXPECT_EQ(r.train_rows + r.validation_rows, 1200);
        EXPECT_NEAR(r.validation_rows, 120, 15);
        if (threads == 0) wanted = saved(*a);
        EXPECT_EQ(saved(*a), wanted) << threads;
      }
    }
}

// Labels of the decision before need a memory, and a clone finds that; a policy file acts as it learned.
TEST(MemoryLabels, ACloneRemembers) {
  const Lesson lesson;
  CloneOptions how;
  how.epochs = 60, how.batch_rows = 64, how.learning_rate = 1e-2, how.learning_rate_end = 1e-4,
  how.patience = 0;
  double loss[2];
  for (const char* memory : {"", "gru:24"}) {
    AgentSetup s = setup_of({"ppo", memory, "free"});
    const AgentPtr a = s.with("hidden", "16").with("last_layer_scale", "1").make();
    loss[*memory != 0] = a->clone(lesson.rows(), how).validation_loss;
    if (!*memory) continue;
    const auto bytes = policy_file(*a);
    Policy* p = Policy::read(bytes.data(), bytes.size(), HostHooks{});
    std::vector<float> state(4 * size_of(p->view().state_dim())), action(12);
    std::vector<unsigned char> scratch(p->scratch_bytes(4) + 64);
    void* at = scratch.data() + (64 - reinterpret_cast<uintptr_t>(scratch.data()) % 64) % 64;
    double sum = 0;
    for (size_t t = 0; t < 3; ++t) {  // before any episode ends
      p->act(&lesson.obs[t * 24], 4, nullptr, action.data(), at, {}, state.data());
      for (size_t i = 0; i < 12; ++i) {
        const auto gap = static_cast<double>(action[i] - lesson.label[t * 12 + i]);
        sum += gap * gap / 36;
      }
    }
    EXPECT_LT(sum, 0.02);
    Policy::destroy(p);
  }
  EXPECT_GT(loss[0], 0.1);
  EXPECT_LT(loss[1], 0.02);
}

// The imitation term: any threads, slices of any size and a resumed agent give the same bytes, and nothing takes memory.
TEST(MemoryLabels, TheImitationTermLearnsThroughIt) {
  const Lesson lesson;
  for (const Kind& kind : kKinds) {
    SCOPED_TRACE(kind.algo);
    std::vector<unsigned char> wanted, between;
    for (const int32_t threads : {0, 2, 3}) {
      AgentSetup s = setup_of(kind, threads);
      const double limit = 1;
      s.config.cost_limits = &limit;
      s.config.max_steps = 30;
      const AgentPtr a = s.make(), resumed = s.make();
      a->set_recording(lesson.rows(), 7);
      resumed->set_recording(lesson.rows(), 7);
      NoiseWorld world(s.config);
      for (int epoch = 0; epoch < 2; ++epoch) world.epoch(*a);
      if (threads == 0) between = saved(*a);
      resumed->load(between.data(), between.size());
      NoiseWorld same = world;
      const int64_t heap = heap_count();
      world.epoch(*a);
      EXPECT_EQ(heap_count(), heap);
      if (threads == 0) wanted = saved(*a);
      EXPECT_EQ(saved(*a), wanted) << threads;
      while (resumed->missing() > 0) same.decide(*resumed);
      resumed->begin_update(same.obs());
      int32_t slices = 0;
      for (; !resumed->update_on(1, nullptr); ++slices) {
      }
      EXPECT_GT(slices, 10);
      EXPECT_EQ(saved(*resumed), wanted) << threads;
    }
    AgentSetup s = setup_of(kind);
    const double limit = 1;
    s.config.cost_limits = &limit;
    s.config.max_steps = 30;
    const AgentPtr without = s.with("imitation", "0").make();
    NoiseWorld world(s.config);
    for (int epoch = 0; epoch < 3; ++epoch) world.epoch(*without);
    EXPECT_NE(saved(*without), wanted);
  }
}

// With a large weight the term alone teaches what cloning does: labels of the decision before.
TEST(MemoryLabels, TheImitationTermPullsTheMemoryToTheLabels) {
  const Lesson lesson;
  for (const char* algo : {"ppo", "trpo"}) {
    SCOPED_TRACE(algo);
    AgentSetup s = setup_of({algo, "gru:24", "free"});
    s.with("hidden", "16").with("last_layer_scale", "1").with("imitation", "30").with("imitation_decay", "1");
    s.with("learning_rate", "1e-2")
        .with("warm_epochs", "0")
        .with("init_std", "0.5")
        .with("learn_std", "false");
    if (std::string(algo) == "trpo") s.with("trust_kl", "0.1").with("cg_damping", "1e-3");
    const AgentPtr a = s.make();
    a->set_recording(lesson.rows(), 7);
    CloneOptions probe;  // an epoch without a step tells the loss
    probe.epochs = 1, probe.learning_rate = probe.learning_rate_end = 0, probe.feed_normalizer = false;
    const double before = a->clone(lesson.rows(), probe).validation_loss;
    NoiseWorld world(s.config);
    for (int epoch = 0; epoch < 60; ++epoch) world.epoch(*a);
    EXPECT_LT(a->clone(lesson.rows(), probe).validation_loss, 0.6 * before);
  }
}
