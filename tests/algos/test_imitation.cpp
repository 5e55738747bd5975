// Cloning, the imitation term, epochs of the critics alone, and the start from a policy.
#include <cmath>
#include <cstring>
#include <functional>

#include "agents.hpp"
#include "algos/imitation/imitation.hpp"
#include "heap_count.hpp"
#include "nn/policy.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

constexpr int32_t kObs = 5, kActions = 2, kRows = 1200;

// A linear teacher: labels = A obs, observations of very different scales.
struct Lesson {
  std::vector<float> obs, label;
  std::vector<int64_t> episode;
  explicit Lesson(int32_t rows = kRows, uint64_t seed = 3) {
    Stream s(seed, 0, Purpose::kTest);
    for (int32_t i = 0; i < rows; ++i) {
      float x[kObs];
      for (float& v : x) v = static_cast<float>(s.signed_unit());
      label.push_back(0.4f * x[0] - 0.3f * x[1] + 0.2f * x[4]);
      label.push_back(-0.2f * x[2] + 0.5f * x[3]);
      for (int j = 0; j < kObs; ++j) obs.push_back(3 + (j == 1 ? 100.0f : 1.0f) * x[j]);
      episode.push_back(i / 40);
    }
  }
  DemoRows rows() const {
    return {static_cast<int32_t>(episode.size()), obs.data(), label.data(), episode.data()};
  }
};

AgentSetup setup(const char* algo = "ppo_lag", int32_t threads = 0) {
  AgentSetup s(algo, kObs, kActions, 40);
  s.config.num_threads = threads;
  s.config.seed = 5;
  s.with("hidden", "32").with("horizon", "8").with("passes", "2").with("minibatches", "2");
  return s;
}

std::vector<float> tensor(Agent& a, const char* prefix) {
  std::vector<float> all;
  TensorInfo t;
  for (int32_t i = 0; a.tensor(i, &t); ++i)
    if (std::strncmp(t.name, prefix, std::strlen(prefix)) == 0)
      all.insert(all.end(), t.data, t.data + size_of(t.rows) * size_of(t.cols));
  return all;
}

std::vector<float> means(Agent& a, const Lesson& lesson) {
  std::vector<float> out(40 * kActions);
  a.act(lesson.obs.data(), false, out.data());
  return out;
}

Code code_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.code;
  }
  return Code::kOk;
}

}  // namespace

TEST(Clone, ReproducesALinearTeacher) {
  const Lesson lesson, fresh(40, 8);
  const AgentPtr a = setup().make();
  CloneOptions how;
  how.epochs = 60, how.batch_rows = 64, how.patience = 0, how.action_std = 0.05;
  double train[60], held[60];
  how.capacity = 60, how.train_loss = train, how.validation_loss = held;
  const CloneReport r = a->clone(lesson.rows(), how);
  EXPECT_EQ(r.epochs, 60);
  EXPECT_EQ(r.train_rows + r.validation_rows, kRows);
  EXPECT_EQ(r.validation_rows % 40, 0);
  EXPECT_NEAR(r.validation_rows, kRows / 10, 40);
  EXPECT_LT(r.validation_loss, 1e-3);
  EXPECT_LT(r.validation_loss, held[0] / 20);
  EXPECT_EQ(r.validation_loss, held[r.best_epoch - 1]);
  EXPECT_EQ(r.train_loss, train[r.best_epoch - 1]);
  const auto y = means(*a, fresh);
  for (size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(y[i], fresh.label[i], 0.12) << i;
  for (const float l : tensor(*a, "actor.log_std")) EXPECT_NEAR(l, std::log(0.05), 1e-5);
}

TEST(Clone, SameBytesForAnyThreads) {
  const Lesson lesson;
  std::vector<unsigned char> wanted;
  for (const int32_t threads : {1, 3, 4}) {
    const AgentPtr a = setup("ppo_lag", threads).make();
    CloneOptions how;
    how.epochs = 3, how.seed = 9;
    a->clone(lesson.rows(), how);
    if (wanted.empty()) wanted = saved(*a);
    EXPECT_EQ(saved(*a), wanted) << threads;
    how.seed = 10;
    a->clone(lesson.rows(), how);
    EXPECT_NE(saved(*a), wanted);
  }
}

TEST(Clone, TheCriticsStay) {
  const Lesson lesson;
  const AgentPtr a = setup().make();
  const auto reward = tensor(*a, "reward_critic"), cost = tensor(*a, "cost_critic"),
             actor = tensor(*a, "actor");
  a->clone(lesson.rows(), {});
  EXPECT_EQ(tensor(*a, "reward_critic"), reward);
  EXPECT_EQ(tensor(*a, "cost_critic"), cost);
  EXPECT_NE(tensor(*a, "actor"), actor);
}

// Labels that are noise: what is learned of them does not carry over, and the best epoch is kept.
TEST(Clone, StopsEarlyAndKeepsTheBest) {
  Lesson lesson(200);
  Stream s(1, 0, Purpose::kTest);
  for (float& v : lesson.label) v = static_cast<float>(s.signed_unit());
  const AgentPtr a = setup().make(), best = setup().make();
  CloneOptions how;
  how.epochs = 400, how.batch_rows = 16, how.learning_rate = how.learning_rate_end = 1e-2, how.patience = 6;
  how.validation = 0.3;
  const CloneReport r = a->clone(lesson.rows(), how);
  EXPECT_TRUE(r.stopped);
  EXPECT_EQ(r.epochs, r.best_epoch + 6);
  how.epochs = r.best_epoch;
  const CloneReport again = best->clone(lesson.rows(), how);
  EXPECT_EQ(again.best_epoch, r.best_epoch);
  EXPECT_EQ(saved(*a), saved(*best));
}

TEST(Clone, ALossThatWasNotMeasuredIsNaN) {
  const Lesson lesson;
  double held[] = {1, 1};
  CloneOptions how;
  how.epochs = how.capacity = 2, how.validation = 0, how.validation_loss = held;
  const CloneReport r = setup().make()->clone(lesson.rows(), how);
  EXPECT_EQ(r.validation_rows, 0);
  EXPECT_EQ(r.best_epoch, 2);
  EXPECT_GT(r.train_loss, 0);
  for (const double v : {r.validation_loss, held[0], held[1]}) EXPECT_TRUE(std::isnan(v));
}

TEST(Clone, RefusalsChangeNothing) {
  const Lesson lesson;
  const AgentPtr a = setup().make();
  const auto before = saved(*a);
  const auto with = [&](const std::function<void(CloneOptions&)>& change) {
    CloneOptions how;
    change(how);
    return code_of([&] { a->clone(lesson.rows(), how); });
  };
  EXPECT_EQ(with([](CloneOptions& o) { o.epochs = 0; }), Code::kRange);
  EXPECT_EQ(with([](CloneOptions& o) { o.batch_rows = 0; }), Code::kRange);
  EXPECT_EQ(with([](CloneOptions& o) { o.validation = 0.95; }), Code::kRange);
  EXPECT_EQ(with([](CloneOptions& o) { o.learning_rate = std::nan(""); }), Code::kRange);
  EXPECT_EQ(with([](CloneOptions& o) { o.action_std = 1e-9; }), Code::kRange);
  EXPECT_EQ(code_of([&] { a->clone({}, {}); }), Code::kArgument);
  a->cancel();
  EXPECT_EQ(with([](CloneOptions&) {}), Code::kCancelled);
  EXPECT_EQ(saved(*a), before);
  const AgentPtr state = setup().with("std_mode", "state").make();
  CloneOptions how;
  how.action_std = 0.1;
  EXPECT_EQ(code_of([&] { state->clone(lesson.rows(), how); }), Code::kUnsupported);
  how.action_std = 0;
  EXPECT_EQ(code_of([&] { state->clone(lesson.rows(), how); }), Code::kOk);
  NoiseWorld world(a->config());
  world.decide(*a);
  EXPECT_EQ(with([](CloneOptions&) {}), Code::kState);
}

TEST(WarmEpochs, LeaveTheActorsBytes) {
  for (const int32_t i : on_policy_algos()) {
    AgentSetup s = setup(algo_at(i).name);
    s.with("warm_epochs", "2").with("lr_schedule", "kl").with("learning_rate", "1e-4");
    const AgentPtr a = s.make();
    NoiseWorld world(s.config);
    const auto actor = tensor(*a, "actor"), critic = tensor(*a, "reward_critic");
    Epoch e;
    for (int k = 0; k < 2; ++k) {
      world.epoch(*a, &e);
      EXPECT_EQ(tensor(*a, "actor"), actor) << algo_at(i).name;
      EXPECT_NE(tensor(*a, "reward_critic"), critic);
      EXPECT_EQ(e.learning_rate, 0);
      EXPECT_EQ(e.passes, 2);
      EXPECT_EQ(e.kl, 0);
    }
    world.epoch(*a, &e);
    EXPECT_NE(tensor(*a, "actor"), actor) << algo_at(i).name;
    EXPECT_EQ(e.learning_rate, 1e-4);
  }
}

// The gradient against differences of the term, in double steps of every thirteenth parameter.
TEST(Imitation, GradientIsThatOfTheTerm) {
  for (const char* mode : {"free", "state"}) {
    AgentSetup s = setup();
    s.with("std_mode", mode).with("init_std", "0.3");
    const Lesson lesson(64);
    AgentConfig config = s.ready();
    ResolvedAgentConfig resolved = resolve_config(config);
    Arena measure;
    carve_networks(measure, resolved);
    BatchWorkers workers;
    Networks nets = carve_networks(measure, resolved);
    workers.carve(measure, resolved, nets.size);
    Collector collector;
    collector.carve(measure, resolved);
    Arena arena(HostHooks(), measure.used());
    nets = carve_networks(arena, resolved);
    workers.carve(arena, resolved, nets.size);
    workers.open(HostHooks(), 0);
    collector.carve(arena, resolved);
    collector.open(resolved, nets, workers);
    init_networks(nets, resolved);
    normalizer_merge(collector.normalizer(), lesson.obs.data(), 64, nullptr, 0);
    Regression regression;
    regression.open(resolved, collector, nets, workers);
    std::vector<int32_t> order;
    for (int32_t i = 0; i < 64; ++i) order.push_back(63 - i);
    std::vector<float> grad(nets.size, 1.0f), fresh(nets.size);
    const double weight = 0.5;
    const DemoRows rows = lesson.rows();
    Fit added{&rows, order.data(), 64, 64, true, weight, grad.data(), true};
    while (!regression.advance(added)) {
    }
    const double loss = regression.gradient(rows, order.data(), 64, true, weight, fresh.data());
    EXPECT_EQ(added.loss(), loss);
    EXPECT_DOUBLE_EQ(loss, regression.loss(lesson.rows(), order.data(), 64, true));
    const size_t first = nets.std_size, last = first + nets.shape[Networks::kActor].num_params();
    for (size_t i = first; i < last; ++i) EXPECT_NEAR(grad[i], 1 + fresh[i], 1e-5);
    for (size_t i = last; i < nets.size; ++i) EXPECT_EQ(grad[i], 1.0f);
    const bool state = nets.state_std();
    for (size_t i = first; i < last; i += state ? 1 : 13) {
      // with std_mode=state sigma is held: outputs of deviations get no gradient, and those before them one
      // that differences do not show
      if (state) continue;
      const float was = nets.params[i], h = 1e-2f;
      nets.params[i] = was + h;
      const double up = regression.loss(lesson.rows(), order.data(), 64, true);
      nets.params[i] = was - h;
      const double down = regression.loss(lesson.rows(), order.data(), 64, true);
      nets.params[i] = was;
      EXPECT_NEAR(fresh[i], weight * (up - down) / (2 * static_cast<double>(h)), 2e-3) << mode << " " << i;
    }
    if (!state) continue;
    const MlpShape& shape = nets.shape[Networks::kActor];
    const size_t bias = first + shape.bias_offset(shape.num_hidden);
    for (size_t j = 0; j < kActions; ++j) {
      EXPECT_NE(fresh[bias + j], 0);
      EXPECT_EQ(fresh[bias + kActions + j], 0);
    }
  }
}

TEST(Imitation, HoldsEveryAlgorithmNearTheRecording) {
  const Lesson lesson;
  for (const int32_t i : on_policy_algos()) {
    double error[2];
    for (const bool held : {false, true}) {
      AgentSetup s = setup(algo_at(i).name);
      s.with("learning_rate", "3e-3").with("init_std", "0.3").with("imitation", held ? "20" : "0");
      s.with("early_stop_kl", "0").with("imitation_decay", "1");
      const AgentPtr a = s.make();
      a->set_recording(lesson.rows(), 1);
      NoiseWorld world(s.config);
      for (int k = 0; k < 6; ++k) world.epoch(*a);
      const auto y = means(*a, lesson);
      error[held] = 0;
      for (size_t j = 0; j < y.size(); ++j) error[held] += std::abs(y[j] - lesson.label[j]);
    }
    EXPECT_LT(error[1], 0.97 * error[0]) << algo_at(i).name;
  }
}

TEST(Imitation, FadesAndResumes) {
  const Lesson lesson, other(kRows, 4);
  AgentSetup s = setup();
  s.with("imitation", "1").with("imitation_decay", "0.5").with("warm_epochs", "1");
  const AgentPtr whole = s.make();
  NoiseWorld world(s.config);
  EXPECT_EQ(code_of([&] { world.decide(*whole); }), Code::kState);  // the option without a recording
  whole->set_recording(lesson.rows(), 42);
  for (int k = 0; k < 3; ++k) world.epoch(*whole);
  const auto bytes = saved(*whole);
  const AgentPtr resumed = setup("ppo_lag", 2)
                               .with("imitation", "1")
                               .with("imitation_decay", "0.5")
                               .with("warm_epochs", "1")
                               .make();
  EXPECT_EQ(code_of([&] { resumed->load(bytes.data(), bytes.size()); }), Code::kFormat);
  resumed->set_recording(other.rows(), 43);
  EXPECT_EQ(code_of([&] { resumed->load(bytes.data(), bytes.size()); }), Code::kFormat);
  resumed->set_recording(lesson.rows(), 42);
  resumed->load(bytes.data(), bytes.size());
  NoiseWorld copy = world;
  for (int k = 0; k < 3; ++k) world.epoch(*whole), copy.epoch(*resumed);
  EXPECT_EQ(saved(*whole), saved(*resumed));
}

TEST(Imitation, NoHeapInUpdate) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is the sanitizer's here";
  const Lesson lesson;
  AgentSetup s = setup("trpo_lag", 2);
  s.with("imitation", "1");
  const AgentPtr a = s.make();
  a->set_recording(lesson.rows(), 1);
  NoiseWorld world(s.config);
  const int64_t before = heap_count();
  for (int k = 0; k < 2; ++k) world.epoch(*a);
  EXPECT_EQ(heap_count(), before);
}

namespace {
struct PolicyEnd {
  void operator()(Policy* p) const { Policy::destroy(p); }
};
std::unique_ptr<Policy, PolicyEnd> policy_of(Agent& a) {
  const auto bytes = written([&](Writer& w) { a.write_policy_file(w); });
  return std::unique_ptr<Policy, PolicyEnd>(Policy::read(bytes.data(), bytes.size(), HostHooks()));
}
}  // namespace

TEST(LoadPolicy, ActsAsThePolicy) {
  for (const char* mode : {"free", "state"}) {
    const Lesson lesson;
    const AgentPtr teacher = setup().with("std_mode", mode).make();
    teacher->clone(lesson.rows(), {});
    const auto policy = policy_of(*teacher);
    AgentSetup s = setup("trpo").with("std_mode", mode);
    s.config.seed = 77;
    const AgentPtr a = s.make();
    a->load_policy(policy->view(), 1000);
    EXPECT_EQ(means(*a, lesson), means(*teacher, lesson));
    EXPECT_EQ(tensor(*a, "actor"), tensor(*teacher, "actor"));
    const auto bytes = saved(*a);
    const AgentPtr copy = s.make();
    copy->load(bytes.data(), bytes.size());
    EXPECT_EQ(means(*copy, lesson), means(*teacher, lesson));
    NoiseWorld world(s.config);
    world.epoch(*a);
  }
}

TEST(LoadPolicy, SaysWhatDiffers) {
  const AgentPtr teacher = setup().make();
  const auto policy = policy_of(*teacher);
  const auto refused = [&](AgentSetup s, const char* word) {
    const AgentPtr a = s.make();
    const auto before = saved(*a);
    const Thrown e = thrown([&] { a->load_policy(policy->view(), 1000); });
    EXPECT_EQ(e.code, Code::kArgument);
    EXPECT_NE(e.text.find(word), std::string::npos) << e.text;
    EXPECT_EQ(saved(*a), before);
  };
  refused(setup().with("hidden", "16"), "hidden");
  refused(setup().with("activation", "elu"), "activation");
  refused(setup().with("std_mode", "state"), "std_mode");
  refused(setup().with("normalize_obs", "off"), "normalize_obs");
  refused(AgentSetup("ppo", kObs + 1, kActions, 4), "obs_dim");
  const AgentPtr a = setup().make();
  EXPECT_EQ(thrown([&] { a->load_policy(policy->view(), 1); }).code, Code::kRange);
}
