// Actors that see points and have a history, or a latent: a teacher's, a student's.
#include <cmath>
#include <cstring>

#include "algos/agent/agent.hpp"
#include "algos/core/networks.hpp"
#include "heap_count.hpp"
#include "hostile_policy.hpp"
#include "nn/policy.hpp"
#include "point_world.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

enum Kind { kHistory, kTeacher, kStudent };
constexpr Kind kKinds[] = {kHistory, kTeacher, kStudent};

AgentSetup setup_of(Kind kind, int32_t envs = 9, const char* algo = "ppo") {
  AgentSetup s = PointWorld::setup(algo, envs, "6,8");
  s.config.max_steps = 30;
  s.config.seed = 4;
  s.with("encoder_classes", "2").with("hidden", "7").with("horizon", "12");
  if (kind == kHistory) return s.with("history", "3");
  s.with("actor_obs", "*")
      .with("latent", "3")
      .with("latent_hidden", "5")
      .with("latent_fields", "object_position");
  if (kind == kStudent) s.with("latent_from", "history").with("history", "3");
  return s;
}

// The world with episodes of several decisions.
struct LongWorld : PointWorld {
  explicit LongWorld(int32_t envs) : PointWorld(envs), ends(8, 0, Purpose::kTest) {}
  void epoch(Agent& a, Epoch* out = nullptr) {
    while (a.missing() > 0) {
      for (auto& e : ended) e = ends.uniform() < 0.2;
      decide(a);
    }
    a.update(obs.data(), out);
  }
  Stream ends;
};

constexpr int32_t kRows = 8;

// Networks alone, with the scratch of an actor and rows, stacked ones, that they see.
struct Nets {
  explicit Nets(AgentSetup s) : setup(std::move(s)), resolved(resolve_config(setup.ready())), world(kRows) {
    Arena measure;
    carve(measure);
    arena = Arena(host(), measure.used());
    carve(arena);
    init_networks(nets, resolved);
    Stream stream(4, 0, Purpose::kTest);
    x.resize(kRows * resolved.seen_dim());
    for (float& v : x) v = static_cast<float>(stream.signed_unit());
    y.resize(kRows * size_of(nets.shape[Networks::kActor].out));
    dy = y;
    for (float& v : dy) v = static_cast<float>(stream.signed_unit());
  }
  void carve(Arena& a) {
    nets = carve_networks(a, resolved);
    scratch = carve_actor_scratch(a, resolved, kRows);
  }
  void forward() { nets.forward_actor(x.data(), world.clouds(), kRows, scratch, y.data()); }
  // The sum of outputs times dy.
  double loss() {
    forward();
    double sum = 0;
    for (size_t i = 0; i < y.size(); ++i) sum += static_cast<double>(y[i]) * static_cast<double>(dy[i]);
    return sum;
  }
  // How many of the parameters [begin, end) have a gradient beside the differences of total(); a step may go over an
  // edge of the maximum over points.
  template <class Total>
  size_t far(size_t begin, size_t end, const std::vector<float>& grad, Total&& total) {
    double top = 0;
    for (size_t i = begin; i < end; ++i) top = std::max(top, std::abs(static_cast<double>(grad[i])));
    EXPECT_GT(top, 0.01);
    size_t count = 0;
    constexpr float kStep = 1e-3f;
    for (size_t i = begin; i < end; ++i) {
      const float kept = nets.params[i];
      nets.params[i] = kept + kStep;
      const double up = total();
      nets.params[i] = kept - kStep;
      const double slope = (up - total()) / (2 * static_cast<double>(kStep));
      nets.params[i] = kept;
      count += std::abs(slope - static_cast<double>(grad[i])) > 5e-3 * top;
    }
    return count;
  }
  AgentSetup setup;
  ResolvedAgentConfig resolved;
  PointWorld world;
  Arena arena;
  Networks nets;
  ActorScratch scratch;
  std::vector<float> x, y, dy;
};

AgentSetup smooth(AgentSetup s) {
  return s.with("encoder_activation", "tanh").with("activation", "tanh").with("last_layer_scale", "1");
}

std::vector<unsigned char> teacher_file() {
  AgentSetup s = setup_of(kTeacher);
  const AgentPtr a = s.make();
  LongWorld world(s.config.num_envs);
  for (int i = 0; i < 2; ++i) world.epoch(*a);
  return policy_file(*a);
}

void begin(Agent& student, const std::vector<unsigned char>& file) {
  const std::unique_ptr<Policy, void (*)(Policy*)> p(Policy::read(file.data(), file.size(), HostHooks{}),
                                                     &Policy::destroy);
  student.load_policy(p->view(), 1000);
}

}  // namespace

TEST(EyesMemory, GradientsAndTangentsAgreeWithDifferences) {
  for (const Kind kind : {kHistory, kTeacher})
    for (const char* frozen : {"off", "on"}) {
      SCOPED_TRACE(std::string(kind == kHistory ? "history, " : "latent, ") + frozen);
      Nets n(smooth(setup_of(kind)).with("encoder_frozen", frozen));
      const size_t first = n.nets.std_size, end = n.nets.block[Networks::kActor].size,
                   eyes = n.nets.net_offset(Networks::kActor) + n.nets.eyes_offset(),
                   behind = eyes + n.nets.eyes.num_params();
      std::vector<float> grad(n.nets.size, 9.0f), v(n.nets.size), jv(n.y.size());
      Stream stream(6, 0, Purpose::kTest);
      for (float& d : v) d = static_cast<float>(stream.signed_unit());
      n.loss();
      n.nets.backward_actor(n.x.data(), n.world.clouds(), kRows, n.scratch, n.dy.data(), grad.data());
      n.nets.tangent_actor(v.data() + first, n.x.data(), n.world.clouds(), kRows, n.scratch, jv.data());
      // one is the transposed of the other
      double left = 0, right = 0;
      for (size_t i = 0; i < jv.size(); ++i)
        left += static_cast<double>(jv[i]) * static_cast<double>(n.dy[i]);
      for (size_t i = first; i < end; ++i) right += static_cast<double>(grad[i]) * static_cast<double>(v[i]);
      EXPECT_NEAR(left, right, 1e-4 * std::abs(right) + 1e-4);
      const auto total = [&] { return n.loss(); };
      EXPECT_EQ(n.far(first, eyes, grad, total), 0u);
      if (kind == kTeacher) {
        EXPECT_EQ(n.far(behind, end, grad, total), 0u);
      }
      if (*frozen == 'o' && frozen[1] == 'n') {
        for (size_t i = eyes; i < behind; ++i) EXPECT_EQ(grad[i], 0);
      } else {
        EXPECT_LE(n.far(eyes, behind, grad, total), (behind - eyes) / 50);
      }
    }
}

// What the clouds show takes no part in the error of a student's latent.
TEST(EyesMemory, AStudentFollowsTheGradientOfItsLatentsError) {
  Nets n(smooth(setup_of(kStudent)));
  std::vector<float> grad(n.nets.size, 9.0f), unused = grad;
  n.forward();
  n.nets.regress_latent(n.x.data(), kRows, 0.2f, n.scratch, grad.data());
  const size_t latent = n.nets.net_offset(Networks::kActor) + n.nets.latent_offset(),
               teacher = n.nets.net_offset(Networks::kActor) + n.nets.teacher_offset();
  EXPECT_EQ(n.far(latent, teacher, grad,
                  [&] {
                    n.forward();
                    return 0.2 * n.nets.regress_latent(n.x.data(), kRows, 0.2f, n.scratch, unused.data());
                  }),
            0u);
  for (size_t i = n.nets.block[Networks::kActor].offset; i < latent; ++i) EXPECT_EQ(grad[i], 0) << i;
}

TEST(EyesMemory, TheWholeActorReadsPointsAndHistory) {
  for (const Kind kind : kKinds) {
    SCOPED_TRACE(kind);
    Nets n(smooth(setup_of(kind)));
    n.forward();
    const auto wanted = n.y;
    const auto moved = [&](float& number) {
      const float kept = number;
      number += 0.25f;
      n.forward();
      number = kept;
      return n.y != wanted;
    };
    EXPECT_TRUE(moved(n.world.points[0]) || moved(n.world.points[3]) || moved(n.world.points[6]));
    EXPECT_TRUE(moved(n.x[0]));                  // a joint
    EXPECT_EQ(moved(n.x[3]), kind == kTeacher);  // the object's place
    if (kind != kTeacher) {
      EXPECT_TRUE(moved(n.x[n.resolved.seen_dim() - 1]));  // the oldest decision
    }
  }
}

TEST(EyesMemory, ThePolicyFileActsAsTheAgent) {
  for (const Kind kind : kKinds)
    for (const char* color : {"off", "on"}) {
      SCOPED_TRACE(std::to_string(kind) + " " + color);
      AgentSetup s = setup_of(kind);
      s.with("encoder_color", color);
      const AgentPtr a = s.make();
      LongWorld world(9);
      std::vector<uint8_t> colors(9 * kWorldPoints * 3, 77);
      const auto clouds = [&] {
        PointRows r = world.clouds();
        r.colors = *color == 'o' && color[1] == 'n' ? colors.data() : nullptr;
        return r;
      };
      if (color[1] == 'f') world.epoch(*a);  // the world has no colours
      const auto file = policy_file(*a);
      EXPECT_EQ(file[8], 11);
      Policy* p = Policy::read(file.data(), file.size(), HostHooks{});
      const PolicyView& v = p->view();
      EXPECT_EQ(v.eyes.points, kWorldPoints);
      EXPECT_EQ(v.eyes.color, color[1] == 'n');
      EXPECT_EQ(static_cast<bool>(v.latent), kind != kHistory);
      EXPECT_EQ(v.state_dim(), kind == kTeacher ? 0 : 6);
      EXPECT_EQ(v.entries(), kind == kTeacher ? 5 : 3);
      std::vector<unsigned char> scratch(p->scratch_bytes(9) + 64);
      auto* at = scratch.data() + (64 - reinterpret_cast<uintptr_t>(scratch.data()) % 64) % 64;
      std::vector<float> state(9 * size_of(v.state_dim())), action(18), wanted(18);
      for (int step = 0; step < 20; ++step) {
        world.draw();
        a->act(world.obs.data(), false, wanted.data(), clouds());
        const int64_t taken = heap_count();
        p->act(world.obs.data(), 9, nullptr, action.data(), at, clouds(), state.data());
        EXPECT_EQ(heap_count(), taken);
        for (size_t i = 0; i < action.size(); ++i) EXPECT_EQ(action[i], std::clamp(wanted[i], -1.0f, 1.0f));
      }
      EXPECT_EQ(written([&](Writer& w) { write_policy(w, v); }), file);
      if (kind != kStudent) {
        AgentSetup t = s;
        t.config.seed = 77;
        const AgentPtr b = t.make();
        b->load_policy(v, 1000);
        b->act(world.obs.data(), false, action.data(), clouds());
        a->forget(true, nullptr);
        a->act(world.obs.data(), false, wanted.data(), clouds());
        for (size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(action[i], wanted[i], 1e-6f);
      }
      for (size_t cut = 0; cut < file.size(); cut += 97)
        EXPECT_EQ(thrown([&] { Policy::destroy(Policy::read(file.data(), cut, HostHooks{})); }).code,
                  Code::kFormat);
      Policy::destroy(p);
    }
}

// Each number of the sections with its checksum mended: refused, or a policy that stays within its memory.
TEST(EyesMemory, NoNumberOfAFileLeadsOutOfIt) {
  for (const Kind kind : kKinds) {
    const AgentPtr a = setup_of(kind).make();
    const auto good = policy_file(*a);
    for (const char* tag : {"EYES", "LATN", "MEMO"}) {
      const auto [refused, taken] = try_numbers(good, tag);
      if (refused + taken == 0) continue;  // it has no such section
      EXPECT_GT(refused, taken) << tag;
    }
  }
}

TEST(EyesMemory, AnyNumberOfThreadsAndAnyResumeGivesTheSameBytes) {
  for (const Kind kind : kKinds)
    for (const char* algo : {"ppo", "trpo"}) {
      SCOPED_TRACE(std::string(algo) + " " + std::to_string(kind));
      std::vector<unsigned char> wanted;
      for (const int32_t threads : {0, 2, 3}) {
        AgentSetup s = setup_of(kind, 60, algo);
        s.config.num_threads = threads;
        AgentPtr a = s.make(), b = s.make();
        LongWorld world(60);
        for (int epoch = 0; epoch < 3; ++epoch) {
          if (epoch == 1) {
            const auto bytes = saved(*a);
            b->load(bytes.data(), bytes.size());
            std::swap(a, b);
          }
          const int64_t before = heap_count();
          Epoch e;
          world.epoch(*a, &e);
          if (kHeapIsCounted) {
            EXPECT_EQ(heap_count(), before);
          }
        }
        if (threads == 0) wanted = saved(*a);
        EXPECT_EQ(saved(*a), wanted) << threads;
      }
    }
}

TEST(EyesMemory, AStudentHasItsTeachersEyesAndLearnsItsEncoderAlone) {
  const auto file = teacher_file();
  AgentSetup s = setup_of(kStudent);
  s.with("learning_rate", "1e-2");
  const AgentPtr a = s.make();
  begin(*a, file);
  Policy* teacher = Policy::read(file.data(), file.size(), HostHooks{});
  const auto kept = [&] {
    std::vector<float> all;
    TensorInfo t;
    for (int32_t i = 0; a->tensor(i, &t); ++i)
      if (std::strncmp(t.name, "latent.", 7) != 0 && std::strstr(t.name, "critic") == nullptr)
        all.insert(all.end(), t.data, t.data + size_of(t.rows) * size_of(t.cols));
    return all;
  };
  const auto before = kept();
  LongWorld world(s.config.num_envs);
  double first = 0, last = 0;
  for (int epoch = 0; epoch < 60; ++epoch) {
    Epoch e;
    world.epoch(*a, &e);
    (epoch == 0 ? first : last) = e.loss_policy;
  }
  EXPECT_LT(last, 0.9 * first);  // of noise there is a mean to learn
  EXPECT_EQ(kept(), before);
  const auto own = policy_file(*a);
  Policy* student = Policy::read(own.data(), own.size(), HostHooks{});
  const PolicyView &v = student->view(), &t = teacher->view();
  for (size_t i = 0; i < v.eyes.num_params(); ++i) EXPECT_EQ(v.eyes_params[i], t.eyes_params[i]);
  for (size_t i = 0; i < v.num_params(); ++i) EXPECT_EQ(v.params[i], t.params[i]);
  Policy::destroy(student);
  Policy::destroy(teacher);
}

// The object's place is a part of the latent and of the clouds: with either, and so with both, it is found.
TEST(EyesMemory, LearnsWhatABlindPolicyCannot) {
  for (const Kind kind : {kHistory, kTeacher}) {
    SCOPED_TRACE(kind);
    AgentSetup s = PointWorld::setup("ppo", 128);
    s.config.seed = 3;
    if (kind == kHistory)
      s.with("history", "2");
    else
      s.with("latent", "2").with("actor_obs", "*").with("latent_fields", "object_position");
    const AgentPtr a = s.make();
    PointWorld world(128, 5);
    EXPECT_LT(world.judge(*a, 10), -0.4) << "nothing is known at first";
    for (int i = 0; i < 150; ++i) world.epoch(*a);
    a->forget(true, nullptr);
    EXPECT_GT(world.judge(*a, 20), -0.25);
  }
}

TEST(EyesMemory, WhatDoesNotFitIsRefusedByName) {
  EXPECT_EQ(thrown([] { PointWorld::setup("ppo", 4).with("memory", "gru:4").make(); }).text,
            "memory: it cannot be combined with option encoder yet; option history works with an encoder");
  const auto file = teacher_file();
  const AgentPtr other = setup_of(kStudent).with("encoder", "6,9").make();
  EXPECT_EQ(thrown([&] { begin(*other, file); }).text, "policy: encoder differs from the agent's");
}
