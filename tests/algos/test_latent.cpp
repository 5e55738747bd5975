// Latents: what an encoder makes of fields for the actor, and students whose encoder of their history learns to make it.
#include <algorithm>
#include <cmath>
#include <functional>

#include "agents.hpp"
#include "algos/core/networks.hpp"
#include "heap_count.hpp"
#include "hostile_policy.hpp"
#include "nn/policy.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

const ObsField kFields[] = {{"a", 0, 2, ""}, {"dynamics.b", 2, 3, ""}, {"c", 5, 1, ""}};

AgentSetup setup_of(bool student, const char* algo = "ppo", int32_t envs = 9) {
  AgentSetup s(algo, 6, 3, envs);
  s.config.fields = kFields;
  s.config.num_fields = 3;
  s.config.seed = 4;
  s.with("hidden", "8,6").with("horizon", "12").with("passes", "2").with("minibatches", "3");
  s.with("latent", "4").with("latent_hidden", "7");
  if (student) s.with("latent_from", "history").with("history", "3").with("history_fields", "a");
  return s;
}

// Networks alone, with the scratch of an actor.
struct Nets {
  explicit Nets(AgentSetup s) : setup(std::move(s)), resolved(resolve_config(setup.ready())) {
    Arena measure;
    carve(measure);
    arena = Arena(host(), measure.used());
    carve(arena);
    init_networks(nets, resolved);
  }
  void carve(Arena& a) {
    nets = carve_networks(a, resolved);
    scratch = carve_actor_scratch(a, resolved, kRows);
  }
  static constexpr int32_t kRows = 5;
  AgentSetup setup;
  ResolvedAgentConfig resolved;
  Arena arena;
  Networks nets;
  ActorScratch scratch;
};

using Row = std::vector<double>;
Row layers(const MlpShape& s, const double* p, Row x) {
  for (int32_t l = 0; l < s.num_layers(); ++l) {
    const double *w = p + s.weight_offset(l), *b = p + s.bias_offset(l);
    Row y(b, b + s.layer_out(l));
    for (size_t o = 0; o < y.size(); ++o) {
      for (size_t i = 0; i < x.size(); ++i) y[o] += w[o * x.size() + i] * x[i];
      if (l < s.num_hidden) y[o] = std::tanh(y[o]);
    }
    x = y;
  }
  return x;
}

// What the actor gives, its latent and its teacher's, in double.
struct InDouble {
  Row action, z, taught;
};
InDouble in_double(const Nets& n, const Row& p, const float* x) {
  const double* actor = p.data() + n.nets.net_offset(Networks::kActor);
  const auto of = [&](std::initializer_list<int> columns) {
    Row out;
    for (const int c : columns) out.push_back(static_cast<double>(x[c]));
    return out;
  };
  InDouble out;
  const bool student = n.nets.adapts();
  // a student reads field a, now and in two decisions before
  out.z = layers(n.nets.latent.mlp, actor + n.nets.latent_offset(),
                 student ? of({0, 1, 6, 7, 8, 9}) : of({2, 3, 4}));
  if (student) out.taught = layers(n.nets.teacher, actor + n.nets.teacher_offset(), of({2, 3, 4}));
  Row seen = of({0, 1, 5});
  seen.insert(seen.end(), out.z.begin(), out.z.end());
  out.action = layers(n.nets.shape[Networks::kActor], actor, seen);
  return out;
}

std::vector<float> random_floats(size_t n, uint64_t seed) {
  Stream s(seed, 0, Purpose::kTest);
  std::vector<float> x(n);
  for (float& v : x) v = static_cast<float>(s.signed_unit());
  return x;
}

// The differences of total(params) by each of the actor's.
std::vector<double> differences(const Nets& n, const std::function<double(const Row&)>& total) {
  Row p(n.nets.params, n.nets.params + n.nets.size);
  std::vector<double> out(n.nets.block[Networks::kActor].size);
  for (size_t j = 0; j < out.size(); ++j) {
    const double kept = p[j], h = 1e-6 * (1 + std::abs(kept));
    p[j] = kept + h;
    const double up = total(p);
    p[j] = kept - h;
    out[j] = (up - total(p)) / (2 * h);
    p[j] = kept;
  }
  return out;
}

std::vector<std::string> tensor_names(Agent& a) {
  std::vector<std::string> names;
  TensorInfo t;
  for (int32_t i = 0; a.tensor(i, &t); ++i) names.push_back(t.name);
  return names;
}
std::vector<float> tensor_of(Agent& a, const char* name) {
  TensorInfo t;
  for (int32_t i = 0; a.tensor(i, &t); ++i)
    if (std::strcmp(t.name, name) == 0) return {t.data, t.data + t.rows * t.cols};
  ADD_FAILURE() << name;
  return {};
}

// A teacher that has seen some rows, and a student that begins with it.
struct Pair {
  explicit Pair(const char* algo = "ppo") : teacher(setup_of(false, algo).make()) {
    NoiseWorld world(setup_of(false).config);
    for (int epoch = 0; epoch < 2; ++epoch) world.epoch(*teacher);
    file = policy_file(*teacher);
  }
  void begin(Agent& student) const {
    const std::unique_ptr<Policy, void (*)(Policy*)> p(Policy::read(file.data(), file.size(), HostHooks{}),
                                                       &Policy::destroy);
    student.load_policy(p->view(), 1000);  // may refuse it
  }
  AgentPtr teacher;
  std::vector<unsigned char> file;
};

}  // namespace

TEST(Latent, OutputsAndGradientsAreThoseOfTheEquationsInDouble) {
  for (const bool student : {false, true}) {
    SCOPED_TRACE(student);
    Nets n(setup_of(student).with("last_layer_scale", "1"));
    const size_t width = n.resolved.seen_dim(), rows = Nets::kRows;
    const auto x = random_floats(rows * width, 1), dy = random_floats(rows * 3, 2);
    std::vector<float> y(rows * 3), grad(n.nets.size, 9.0f);
    n.nets.forward_actor(x.data(), {}, Nets::kRows, n.scratch, y.data());
    const Row p(n.nets.params, n.nets.params + n.nets.size);
    for (size_t i = 0; i < rows; ++i) {
      const Row wanted = in_double(n, p, x.data() + i * width).action;
      for (size_t j = 0; j < 3; ++j) EXPECT_NEAR(static_cast<double>(y[i * 3 + j]), wanted[j], 1e-5);
    }
    n.nets.backward_actor(x.data(), {}, Nets::kRows, n.scratch, dy.data(), grad.data());
    const auto wanted = differences(n, [&](const Row& q) {
      double sum = 0;
      for (size_t i = 0; i < rows; ++i) {
        const Row a = in_double(n, q, x.data() + i * width).action;
        for (size_t j = 0; j < 3; ++j) sum += static_cast<double>(dy[i * 3 + j]) * a[j];
      }
      return sum;
    });
    const size_t first = n.nets.net_offset(Networks::kActor), latent = first + n.nets.latent_offset();
    double largest = 0;
    for (size_t j = first; j < wanted.size(); ++j) {
      // of a student the network behind the latent stands still
      const double gap = student && j < latent ? 0 : wanted[j];
      EXPECT_NEAR(static_cast<double>(grad[j]), gap, 1e-5) << j;
      if (j >= latent) largest = std::max(largest, std::abs(gap));
    }
    EXPECT_GT(largest, 0.01);
  }
}

TEST(Latent, TangentsAreDifferencesInDouble) {
  Nets n(setup_of(false).with("last_layer_scale", "1"));
  const size_t width = n.resolved.seen_dim(), rows = Nets::kRows;
  const auto x = random_floats(rows * width, 1), to = random_floats(n.nets.block[0].size, 3);
  std::vector<float> y(rows * 3), dy(rows * 3);
  n.nets.forward_actor(x.data(), {}, Nets::kRows, n.scratch, y.data());
  n.nets.tangent_actor(to.data() + n.nets.std_size, x.data(), {}, Nets::kRows, n.scratch, dy.data());
  constexpr double kStep = 1e-6;
  Row up(n.nets.params, n.nets.params + n.nets.size), down = up;
  for (size_t j = 0; j < to.size(); ++j)
    up[j] += kStep * static_cast<double>(to[j]), down[j] -= kStep * static_cast<double>(to[j]);
  for (size_t i = 0; i < rows; ++i) {
    const Row a = in_double(n, up, x.data() + i * width).action,
              b = in_double(n, down, x.data() + i * width).action;
    for (size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(static_cast<double>(dy[i * 3 + j]), (a[j] - b[j]) / (2 * kStep), 2e-5);
  }
}

TEST(Latent, AStudentFollowsTheGradientOfItsLatentsError) {
  Nets n(setup_of(true));
  const size_t width = n.resolved.seen_dim(), rows = Nets::kRows;
  const auto x = random_floats(rows * width, 1);
  std::vector<float> y(rows * 3), grad(n.nets.size, 9.0f);
  n.nets.forward_actor(x.data(), {}, Nets::kRows, n.scratch, y.data());
  const double sum = n.nets.regress_latent(x.data(), Nets::kRows, 0.2f, n.scratch, grad.data());
  const auto error = [&](const Row& q) {
    double all = 0;
    for (size_t i = 0; i < rows; ++i) {
      const InDouble d = in_double(n, q, x.data() + i * width);
      for (size_t j = 0; j < d.z.size(); ++j) all += (d.z[j] - d.taught[j]) * (d.z[j] - d.taught[j]);
    }
    return 0.2 * all;
  };
  const Row p(n.nets.params, n.nets.params + n.nets.size);
  EXPECT_NEAR(0.2 * sum, error(p), 1e-5);
  const auto wanted = differences(n, error);
  const size_t first = n.nets.net_offset(Networks::kActor), latent = first + n.nets.latent_offset(),
               teacher = first + n.nets.teacher_offset();
  double largest = 0;
  for (size_t j = 0; j < wanted.size(); ++j) {
    const bool learns = j >= latent && j < teacher;
    EXPECT_NEAR(static_cast<double>(grad[j]), learns ? wanted[j] : 0, 1e-5) << j;
    if (learns) largest = std::max(largest, std::abs(wanted[j]));
  }
  EXPECT_GT(largest, 0.01);
}

// Whatever the algorithm: its multipliers, trust region and second passes take no part.
TEST(Latent, AStudentLearnsItsEncoderAndNothingElse) {
  for (const char* algo : {"ppo", "trpo", "ppo_lag", "cup", "cpo"}) {
    SCOPED_TRACE(algo);
    static const double limit[] = {1};
    const auto costs = [&](AgentSetup s) {
      s.config.cost_dim = 1, s.config.max_steps = 30, s.config.cost_limits = limit;
      return s;
    };
    const Pair pair;
    AgentSetup s = costs(setup_of(true, algo)).with("learning_rate", "1e-2").with("warm_epochs", "3");
    auto a = s.make();
    pair.begin(*a);
    const auto encoder = tensor_of(*a, "latent.0.weight");
    std::vector<std::vector<float>> kept;
    for (const std::string& name : tensor_names(*a))
      if (name.rfind("latent.", 0) != 0) kept.push_back(tensor_of(*a, name.c_str()));
    NoiseWorld world(s.config);
    double first = 0, last = 0;
    for (int epoch = 0; epoch < 60; ++epoch) {
      Epoch e;
      world.epoch(*a, &e);
      (epoch == 0 ? first : last) = e.loss_policy;
    }
    EXPECT_LT(last, 0.8 * first);  // of noise there is a mean to learn
    EXPECT_NE(tensor_of(*a, "latent.0.weight"), encoder);
    size_t k = 0;
    for (const std::string& name : tensor_names(*a))
      if (name.rfind("latent.", 0) != 0) {
        EXPECT_EQ(tensor_of(*a, name.c_str()), kept[k++]) << name;
      }
    EXPECT_EQ(k, kept.size());
  }
}

// What the student's file gives is what its teacher's network gives of the student's latent, with the statistics that
// the teacher had: nothing of them moves.
TEST(Latent, AStudentHasItsTeachersNetworkAndStatistics) {
  const Pair pair;
  AgentSetup s = setup_of(true);
  auto a = s.make();
  pair.begin(*a);
  const auto teacher_names = tensor_names(*pair.teacher);
  for (const std::string& name : teacher_names) {
    const std::string mark = name.substr(0, name.find('.'));
    if (mark != "actor" && mark != "latent") continue;
    const std::string own = mark == "latent" ? "teacher" + name.substr(6) : name;
    EXPECT_EQ(tensor_of(*a, own.c_str()), tensor_of(*pair.teacher, name.c_str())) << name;
  }
  NoiseWorld world(s.config);
  for (int epoch = 0; epoch < 2; ++epoch) world.epoch(*a);
  const auto file = policy_file(*a);
  Policy *student = Policy::read(file.data(), file.size(), HostHooks{}),
         *teacher = Policy::read(pair.file.data(), pair.file.size(), HostHooks{});
  const PolicyView &v = student->view(), &t = teacher->view();
  EXPECT_EQ(v.entries(), 3);
  EXPECT_EQ(t.entries(), 6);
  EXPECT_EQ(v.state_dim(), 4);
  const int32_t own[] = {0, 1, 5};
  for (int32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(v.columns[i], own[i]);
    EXPECT_EQ(v.shift[i], t.shift[own[i]]);
    EXPECT_EQ(v.scale[i], t.scale[own[i]]);
  }
  Policy::destroy(student);
  Policy::destroy(teacher);
}

TEST(Latent, FilesAndAgentsActAlikeAndAreReadAgainToTheByte) {
  for (const int32_t kind : {0, 1, 2}) {
    SCOPED_TRACE(kind);
    AgentSetup s = setup_of(kind > 0);
    if (kind == 2)
      s.with("actor_obs", "a,dynamics.*").with("history_fields", "c");  // which the network does not read
    auto a = s.make();
    NoiseWorld world(s.config);
    world.epoch(*a);
    const auto bytes = policy_file(*a);
    Policy* p = Policy::read(bytes.data(), bytes.size(), HostHooks{});
    EXPECT_EQ(static_cast<bool>(p->view().latent), true);
    EXPECT_EQ(written([&](Writer& w) { write_policy(w, p->view()); }), bytes);
    std::vector<unsigned char> scratch(p->scratch_bytes(9) + 64);
    auto* at = scratch.data() + (64 - reinterpret_cast<uintptr_t>(scratch.data()) % 64) % 64;
    std::vector<float> state(9 * size_of(p->view().state_dim())), action(27), wanted(27);
    for (uint64_t step = 0; step < 20; ++step) {
      const auto obs = random_floats(54, 10 + step);
      a->act(obs.data(), false, wanted.data());
      const int64_t taken = heap_count();
      p->act(obs.data(), 9, nullptr, action.data(), at, {}, state.data());
      EXPECT_EQ(heap_count(), taken);
      for (size_t i = 0; i < action.size(); ++i) EXPECT_EQ(action[i], std::clamp(wanted[i], -1.0f, 1.0f));
    }
    for (int epoch = 0; epoch < 2; ++epoch) world.epoch(*a);
    a->update_policy(*p);
    EXPECT_EQ(written([&](Writer& w) { write_policy(w, p->view()); }), policy_file(*a));
    // any byte that is changed is noticed, and any length that is cut
    for (size_t cut = 0; cut < bytes.size(); cut += 7)
      EXPECT_THROW(Policy::destroy(Policy::read(bytes.data(), cut, HostHooks{})), Error);
    Policy::destroy(p);
  }
}

// Each number of the section with its checksum mended: refused, or a policy that stays within its memory.
TEST(Latent, NoNumberOfAFileLeadsOutOfIt) {
  for (const bool student : {false, true}) {
    auto a = setup_of(student).make();
    const auto good = policy_file(*a);
    const auto [refused, taken] = try_numbers(good, "LATN");
    EXPECT_GT(refused, taken);
    EXPECT_GT(taken, 0);  // those that write what is there
  }
}

TEST(Latent, AnyNumberOfThreadsAndAnyResumeGivesTheSameBytes) {
  for (const bool student : {false, true})
    for (const char* algo : {"ppo", "trpo"}) {
      SCOPED_TRACE(std::string(algo) + (student ? ", a student" : ""));
      std::vector<unsigned char> wanted;
      for (const int32_t threads : {0, 2, 3}) {
        AgentSetup s = setup_of(student, algo, 60);
        s.config.num_threads = threads;
        auto a = s.make(), b = s.make();
        NoiseWorld world(s.config);
        for (int epoch = 0; epoch < 3; ++epoch) {
          if (epoch == 1) {
            const auto bytes = saved(*a);
            b->load(bytes.data(), bytes.size());
            std::swap(a, b);
          }
          world.epoch(*a);
        }
        if (threads == 0) wanted = saved(*a);
        EXPECT_EQ(saved(*a), wanted) << threads;
      }
    }
}

TEST(Latent, SlicesGiveTheBytesOfTheWhole) {
  for (const bool student : {false, true}) {
    SCOPED_TRACE(student);
    AgentSetup s = setup_of(student);
    auto whole = s.make(), sliced = s.make();
    NoiseWorld world(s.config), same = world;
    for (int epoch = 0; epoch < 2; ++epoch) {
      world.epoch(*whole);
      while (sliced->missing() > 0) same.decide(*sliced);
      sliced->begin_update(same.obs());
      while (!sliced->update_on(3, nullptr)) {
      }
    }
    EXPECT_EQ(saved(*sliced), saved(*whole));
  }
}

TEST(Latent, WhatDoesNotFitIsRefusedByName) {
  const auto refused = [](AgentSetup s, const char* word) {
    try {
      s.make();
      ADD_FAILURE() << word;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.text).find(word), std::string::npos) << e.text;
    }
  };
  const auto plain = [] { return setup_of(false); };
  refused(plain().with("latent_fields", "dynamics.mass"), "latent_fields: 'dynamics.mass'");
  refused(plain().with("latent_fields", "*"), "latent_fields: they leave");
  refused(plain().with("actor_obs", "!dynamics.*"),
          "latent_fields: it names fields that the actor does not observe");
  refused(plain().with("latent_from", "history"), "latent_from: history needs option history");
  refused(plain().with("history", "3"), "latent_from=history makes a student");
  refused(plain().with("memory", "gru:4"), "latent: it cannot be combined with option memory");
  refused(setup_of(true).with("latent", "0"), "latent_from: it needs option latent");
  refused(setup_of(true).with("history_fields", "a,dynamics.b"),
          "history_fields: it names fields of the latent");
  refused(setup_of(true).with("imitation", "1"), "imitation: with latent_from=history");
  refused(setup_of(false, "mappo").with("groups", "x:a:0-1;y:c:2-2"),
          "latent: it cannot be combined with several groups");
  const Pair pair;
  const auto unfit = [&](AgentSetup s, const char* word) {
    auto a = s.make();
    try {
      pair.begin(*a);
      ADD_FAILURE() << word;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.text).find(word), std::string::npos) << e.text;
    }
  };
  unfit(setup_of(true).with("latent", "3"), "latent differs");
  unfit(setup_of(true).with("latent_hidden", "9"), "latent_hidden");
  unfit(setup_of(true).with("latent_fields", "c"), "latent_fields");
  unfit(setup_of(true).with("hidden", "8"), "hidden");
  Pair of_student;
  auto student = setup_of(true).make();
  of_student.file = policy_file(*student);
  auto other = setup_of(true).make();
  try {
    of_student.begin(*other);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.text).find("a student's"), std::string::npos) << e.text;
  }
}
