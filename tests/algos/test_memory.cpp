// Agents that remember: what acts is what is learned from, in every state of worlds; nothing leaks over an end.
#include <cmath>

#include "algos/first_order/ppo.hpp"
#include "algos/first_order/ratio_loss.hpp"
#include "algos/imitation/regression.hpp"
#include "algos/rollout/sequences.hpp"
#include "algos/trust_region/trust_region.hpp"
#include "heap_count.hpp"
#include "learner_bench.hpp"
#include "nn/policy.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

using Pairs = std::vector<std::pair<const char*, const char*>>;
const ObsField kFields[] = {{"a", 0, 2, ""}, {"b", 2, 3, ""}, {"c", 5, 1, ""}};

struct Kind {
  const char* name;
  Pairs options;
};
const std::vector<Kind> kKinds = {
    {"history", {{"history", "4"}}},
    {"long history", {{"history", "20"}}},  // longer than the horizon
    {"fields", {{"history", "3"}, {"history_fields", "b"}, {"actor_obs", "!a"}}},
    {"fields of all", {{"history", "3"}, {"history_fields", "a,c"}, {"critic_obs", "b"}}},
    {"gru", {{"memory", "gru:7"}, {"memory_chunk", "5"}}},
    {"gru of a part",
     {{"memory", "gru:6"}, {"memory_chunk", "4"}, {"actor_obs", "a,b"}, {"std_mode", "state"}}},
    {"whole gru", {{"memory", "gru:5"}, {"memory_chunk", "64"}, {"hidden", ""}}},
    {"student",
     {{"history", "4"},
      {"latent", "3"},
      {"latent_fields", "b"},
      {"latent_from", "history"},
      {"history_fields", "a"}}}};

AgentSetup setup_of(const Kind& kind, const char* algo = "ppo", int32_t envs = 9) {
  AgentSetup s(algo, 6, 3, envs);
  s.config.fields = kFields;
  s.config.num_fields = 3;
  s.config.seed = 4;
  s.with("hidden", "8,6").with("horizon", "12").with("passes", "2").with("minibatches", "3");
  for (const auto& [key, value] : kind.options) s.with(key, value);
  return s;
}

// Mean actions of a policy file in worlds of its own.
struct Frozen {
  explicit Frozen(Agent& a) {
    const auto bytes = policy_file(a);
    policy = Policy::read(bytes.data(), bytes.size(), HostHooks{});
    dim = size_of(policy->view().state_dim());
    state.assign(size_of(a.config().num_envs) * dim, 0);
    scratch.resize(policy->scratch_bytes(a.config().num_envs) + 64);
  }
  ~Frozen() { Policy::destroy(policy); }
  std::vector<float> act(const float* obs, int32_t envs) {
    std::vector<float> action(size_of(envs) * 3);
    void* at = align_up(scratch.data());
    policy->act(obs, envs, nullptr, action.data(), at, {}, state.data());
    return action;
  }
  static void* align_up(unsigned char* p) { return p + (64 - reinterpret_cast<uintptr_t>(p) % 64) % 64; }
  void forget(size_t env) { std::fill_n(state.begin() + static_cast<long>(env * dim), dim, 0.0f); }
  Policy* policy = nullptr;
  size_t dim = 0;
  std::vector<float> state;
  std::vector<unsigned char> scratch;
};

using Mask = std::vector<uint8_t>;
Mask over(const Mask& terminated, const Mask& truncated) {
  Mask out(terminated.size());
  for (size_t e = 0; e < out.size(); ++e) out[e] = terminated[e] || truncated[e];
  return out;
}

std::vector<float> random_row(Stream& s, size_t n) {
  std::vector<float> x(n);
  for (float& v : x) v = static_cast<float>(s.signed_unit());
  return x;
}

AgentSetup small_gru(const char* algo, const char* chunk) {
  AgentSetup s(algo, 3, 2, 16);
  s.with("hidden", "5").with("horizon", "10").with("minibatches", "1").with("last_layer_scale", "1");
  s.with("memory", "gru:4").with("memory_chunk", chunk);
  return s;
}

// Kept states, ends and rows that are not valid, at random.
void fill_sequences(Bench& b) {
  Rollout& r = b.rollout;
  Stream stream(2, 0, Purpose::kTest);
  for (size_t i = 0; i < size_of(r.paths()) * 16 * 4; ++i)
    r.state[i] = static_cast<float>(stream.signed_unit());
  for (size_t i = 0; i < size_of(b.resolved.samples); ++i) {
    r.age[i] = stream.uniform() < 0.2 ? 0 : 1 + static_cast<int32_t>(i / 16);
    r.valid[i] = stream.uniform() < 0.85;
  }
}

// What the actor of a small bench gives for every row, in double, [samples][2]; 3 entries in, 5 hidden, a GRU of 4.
std::vector<double> in_double(const Bench& b, const std::vector<double>& p) {
  const Rollout& r = b.rollout;
  const auto samples = size_of(b.resolved.samples);
  const RecurrentShape net = b.nets.actor();
  const double* w = p.data() + b.nets.net_offset(Networks::kActor);
  const auto dense = [](const double* weight, const double* bias, const std::vector<double>& x, size_t out) {
    std::vector<double> y(bias, bias + out);
    for (size_t o = 0; o < out; ++o)
      for (size_t i = 0; i < x.size(); ++i) y[o] += weight[o * x.size() + i] * x[i];
    return y;
  };
  std::vector<double> all(samples * 2);
  for (int32_t env = 0; env < 16; ++env) {
    std::vector<double> h(4);
    for (int32_t t = 0; t < 10; ++t) {
      const auto row = size_of(t * 16 + env);
      const float* kept = r.state + size_of(t / r.path * 16 + env) * 4;
      if (t % r.path == 0) h.assign(kept, kept + 4);
      if (r.age[row] == 0) h.assign(4, 0);
      std::vector<double> x = dense(w, w + net.mlp.bias_offset(0), {b.obs(row), b.obs(row) + 3}, 5);
      for (double& v : x) v = std::tanh(v);
      const double* g = w + net.gru_offset();
      const auto in = dense(g, g + net.gru.input_bias_offset(), x, 12);
      const auto st = dense(g + net.gru.state_offset(), g + net.gru.state_bias_offset(), h, 12);
      for (size_t j = 0; j < 4; ++j) {
        const double re = 1 / (1 + std::exp(-in[j] - st[j])), z = 1 / (1 + std::exp(-in[4 + j] - st[4 + j]));
        h[j] = z * h[j] + (1 - z) * std::tanh(in[8 + j] + re * st[8 + j]);
      }
      const double* last = w + net.head_offset();
      const auto y = dense(last, last + 8, h, 2);
      std::copy(y.begin(), y.end(), all.begin() + static_cast<long>(row * 2));
    }
  }
  return all;
}

}  // namespace

// One pass over one minibatch measures the KL before its step: 0 to the last bit of it where the learner finds what
// acted again, over ends, rows that only reset, the begin of the horizon and chunks of any length.
TEST(Memory, TheLearnerSeesWhatActed) {
  for (const Kind& kind : kKinds) {
    SCOPED_TRACE(kind.name);
    AgentSetup s = setup_of(kind);
    auto a = s.with("passes", "1").with("minibatches", "1").make();
    NoiseWorld world(s.config);
    for (int epoch = 0; epoch < 4; ++epoch) {
      Epoch e;
      world.epoch(*a, &e);
      EXPECT_LT(std::abs(e.kl), 1e-12) << epoch;
      EXPECT_TRUE(std::isfinite(e.loss_policy));
    }
  }
}

TEST(Memory, AnyNumberOfThreadsGivesTheSameBytes) {
  for (const char* algo : {"ppo", "trpo"})
    for (const Kind& kind : kKinds) {
      SCOPED_TRACE(std::string(algo) + ", " + kind.name);
      std::vector<unsigned char> wanted;
      for (const int32_t threads : {0, 2, 3}) {
        AgentSetup s = setup_of(kind, algo, 60);
        s.config.num_threads = threads;
        auto a = s.make();
        NoiseWorld world(s.config);
        for (int epoch = 0; epoch < 2; ++epoch) world.epoch(*a);
        if (threads == 0) wanted = saved(*a);
        EXPECT_EQ(saved(*a), wanted) << threads;
      }
    }
}

TEST(Memory, AResumedAgentLearnsTheSameBytes) {
  for (const Kind& kind : kKinds) {
    SCOPED_TRACE(kind.name);
    AgentSetup s = setup_of(kind);
    auto unbroken = s.make(), resumed = s.make();
    NoiseWorld world(s.config);
    for (int epoch = 0; epoch < 2; ++epoch) world.epoch(*unbroken);
    const auto bytes = saved(*unbroken);
    resumed->load(bytes.data(), bytes.size());
    EXPECT_EQ(saved(*resumed), bytes);
    NoiseWorld same = world;
    for (int epoch = 0; epoch < 2; ++epoch) world.epoch(*unbroken), same.epoch(*resumed);
    EXPECT_EQ(saved(*resumed), saved(*unbroken));
  }
}

// With hardly any noise a sample is the mean; a policy file whose states are cleared as the episodes end gives it too:
// the memory is that of the present episode, in all three autoreset modes.
TEST(Memory, EndsClearItAndAPolicyFileActsAlike) {
  enum Mode { kSame, kNext, kOff };
  for (const Kind& kind : kKinds)
    for (const Mode mode : {kSame, kNext, kOff}) {
      SCOPED_TRACE(std::string(kind.name) + ", mode " + std::to_string(mode));
      AgentSetup s = setup_of(kind, "ppo", 5);
      s.with("init_std", "2e-6").with("std_min", "1e-6").with("normalize_obs", "false");
      auto a = s.make();
      Frozen frozen(*a);
      Stream stream(3, 0, Purpose::kTest);
      const size_t n = 5;
      std::vector<float> action(n * 3), reward(n), cost(n), final_obs(n * 6);
      std::vector<uint8_t> terminated(n), truncated(n), valid(n, 1), resets(n, 0);
      float largest = 0;
      while (a->missing() > 0) {
        const auto obs = random_row(stream, n * 6);
        const auto wanted = frozen.act(obs.data(), 5);
        a->act(obs.data(), true, action.data());
        for (size_t i = 0; i < action.size(); ++i) {
          EXPECT_NEAR(action[i], wanted[i], 2e-5f) << i;
          largest = std::max(largest, std::abs(wanted[i]));
        }
        for (size_t e = 0; e < n; ++e) {
          const double u = stream.uniform();
          // with autoreset at the next step the row behind an end is invalid and resets
          valid[e] = !resets[e];
          terminated[e] = !resets[e] && u < 0.15;
          truncated[e] = !resets[e] && u > 0.85;
          const bool ends = terminated[e] || truncated[e];
          if (ends || resets[e]) frozen.forget(e);
          resets[e] = mode == kNext && ends;
        }
        Transition t;
        t.reward = reward.data(), t.cost = cost.data(), t.final_obs = final_obs.data();
        t.terminated = terminated.data(), t.truncated = truncated.data(), t.valid = valid.data();
        if (mode == kOff)
          t.terminated = t.truncated = t.valid = nullptr;  // a host that resets by itself, and says so
        a->record(t);
        const Mask ended = over(terminated, truncated);
        if (mode == kOff) a->forget(false, ended.data());
      }
      EXPECT_GT(largest, 0);
    }
}

// A decision that is dropped before its record leaves no trace, and none counts twice.
TEST(Memory, ADroppedDecisionLeavesNoTrace) {
  for (const Kind& kind : kKinds) {
    SCOPED_TRACE(kind.name);
    AgentSetup s = setup_of(kind);
    s.with("normalize_obs", "false").with("init_std", "2e-6").with("std_min", "1e-6");
    auto a = s.make(), b = s.make();
    Stream stream(3, 0, Purpose::kTest);
    const auto first = random_row(stream, 54), second = random_row(stream, 54),
               other = random_row(stream, 54);
    std::vector<float> one(27), two(27), zeros(9);
    Transition t;
    t.reward = t.cost = zeros.data();
    a->act(other.data(), true, one.data());
    a->discard();
    for (Agent* agent : {a.get(), b.get()}) {
      agent->act(first.data(), true, one.data());
      agent->record(t);
    }
    a->act(second.data(), true, one.data());
    b->act(second.data(), true, two.data());
    for (size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(one[i], two[i], 2e-5f);
  }
}

// Acting by the mean has a memory of its own: it is the policy file's, and disturbs nothing.
TEST(Memory, ActingByTheMeanDoesNotDisturbCollecting) {
  for (const Kind& kind : kKinds) {
    SCOPED_TRACE(kind.name);
    AgentSetup s = setup_of(kind);
    auto a = s.make(), quiet = s.make();
    NoiseWorld world(s.config), same = world;
    world.epoch(*a), same.epoch(*quiet);
    Frozen frozen(*a);
    a->forget(true, nullptr);
    Stream stream(8, 0, Purpose::kTest);
    std::vector<float> action(27);
    for (int step = 0; step < 30; ++step) {
      const auto obs = random_row(stream, 54);
      a->act(obs.data(), false, action.data());
      const auto wanted = frozen.act(obs.data(), 9);
      for (size_t i = 0; i < action.size(); ++i)
        ASSERT_EQ(std::clamp(action[i], -1.0f, 1.0f), wanted[i]) << step;
      if (step % 7 == 3) {
        const uint8_t mask[9] = {0, 1, 0, 0, 1, 0, 0, 0, 1};
        a->forget(true, mask);
        for (size_t e = 0; e < 9; ++e)
          if (mask[e]) frozen.forget(e);
      }
    }
    a->forget(true, nullptr);
    quiet->forget(true, nullptr);
    world.epoch(*a), same.epoch(*quiet);
    EXPECT_EQ(saved(*a), saved(*quiet));
  }
}

// What follows a truncation is valued with the history that a next decision would have: the last decision of a
// horizon, cut there, teaches what one teaches that goes on.
TEST(Memory, FinalObservationsAreValuedWithTheirHistory) {
  for (const Kind& kind : kKinds) {
    SCOPED_TRACE(kind.name);
    AgentSetup s = setup_of(kind);
    auto cut = s.make(), on = s.make();
    Stream stream(5, 0, Purpose::kTest);
    std::vector<float> action(27);
    const std::vector<uint8_t> yes(9, 1), no(9, 0);
    for (int t = 0; t < 12; ++t) {
      const auto obs = random_row(stream, 54), reward = random_row(stream, 9);
      const std::vector<float> cost(9, 0);
      const auto next = random_row(stream, 54);
      const bool last = t == 11;
      for (Agent* a : {cut.get(), on.get()}) {
        Transition tr;
        tr.reward = reward.data(), tr.cost = cost.data(), tr.final_obs = next.data();
        tr.truncated = last && a == cut.get() ? yes.data() : no.data();
        a->act(obs.data(), true, action.data());
        a->record(tr);
      }
      if (!last) continue;
      const auto elsewhere = random_row(stream, 54);
      cut->update(elsewhere.data(), nullptr);
      on->update(next.data(), nullptr);
    }
    const auto p = parameters(*cut), q = parameters(*on);
    // targets add discount V in another place, so the last digit may differ
    for (size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(p[i], q[i], 2e-6f) << i;
  }
}

// The learner's gradient through sequences is the difference of the loss in double: lists in any order, with rows that
// are not in them, cut within sequences, and memories that were cleared.
TEST(Memory, GradientsThroughSequencesAreThoseOfDifferences) {
  for (const char* chunk : {"4", "10", "7"}) {
    SCOPED_TRACE(chunk);
    Bench b(small_gru("ppo", chunk));
    fill_sequences(b);
    Rollout& r = b.rollout;
    Stream stream(3, 0, Purpose::kTest);
    const auto samples = size_of(b.resolved.samples);
    const auto outputs = [&](const std::vector<double>& p) { return in_double(b, p); };
    const auto log_prob = [&](const std::vector<double>& p, const std::vector<double>& y, size_t row) {
      double sum = -std::log(2 * 3.14159265358979323846);
      for (size_t j = 0; j < 2; ++j) {
        const double u = (static_cast<double>(r.action[row * 2 + j]) - y[row * 2 + j]) * std::exp(-p[j]);
        sum -= 0.5 * u * u + p[j];
      }
      return sum;
    };
    const std::vector<double> now = b.params();
    const auto acted = outputs(now);
    for (size_t i = 0; i < samples; ++i) {
      for (size_t j = 0; j < 2; ++j) r.mean[i * 2 + j] = static_cast<float>(acted[i * 2 + j]);
      r.log_prob[i] = static_cast<float>(log_prob(now, acted, i) + 0.1 * stream.signed_unit());
    }
    restart_sequences(r, 0, 16);
    Stream shuffled(1, 0, Purpose::kMinibatch);
    const int32_t all = list_sequences(r, 0, 16, 0, &shuffled);
    ASSERT_LT(all, 160);
    for (const int32_t from : {0, 13}) {
      const int32_t rows = all - 2 * from;  // cut at both ends
      Batch batch(r.order + from, rows);
      batch.envs = 16, batch.path = r.path;
      const auto loss_of = [&](const std::vector<double>& p) {
        const auto y = outputs(p);
        double sum = 0;
        for (int32_t i = 0; i < rows; ++i) {
          const auto row = size_of(r.order[from + i]);
          sum -= std::exp(log_prob(p, y, row) - static_cast<double>(r.log_prob[row])) *
                 static_cast<double>(r.gain[row] + r.linear[row]);
        }
        return sum / rows;
      };
      GainLoss gain;
      b.learner.gradient(&gain, false, batch);
      std::vector<double> p = now;
      const size_t end = b.nets.block[Networks::kActor].size;
      double largest = 0;
      for (size_t j = 0; j < end; ++j) {
        const double kept = p[j], h = 1e-5;
        p[j] = kept + h;
        const double up = loss_of(p);
        p[j] = kept - h;
        const double down = loss_of(p);
        p[j] = kept;
        largest = std::max(largest, std::abs(up - down) / (2 * h));
        ASSERT_NEAR(static_cast<double>(b.learner.gradient()[j]), (up - down) / (2 * h), 3e-6) << j;
      }
      EXPECT_GT(largest, 0.02);
      EXPECT_NEAR(b.learner.measure(batch).gain, -loss_of(now), 1e-5);
    }
  }
}

// The Fisher matrix through sequences is J' diag(1 / s^2) J / N of their outputs' differences in double, over every
// row or every third, whatever states were kept and wherever memories were cleared.
TEST(Memory, FisherProductsThroughSequencesAreThoseOfDifferences) {
  for (const char* chunk : {"4", "10"})
    for (const char* every : {"1", "3"}) {
      SCOPED_TRACE(std::string(chunk) + ", stride " + every);
      const int32_t stride = std::atoi(every);
      AgentSetup s = small_gru("trpo", chunk);
      s.with("init_std", "0.7").with("cg_damping", "0").with("fisher_stride", every);
      Bench b(std::move(s));
      fill_sequences(b);
      const Rollout& r = b.rollout;
      restart_sequences(r, 0, 16);
      const int32_t all = list_sequences(r, 0, 16, 0, nullptr);
      Arena measure;
      Fisher fisher;
      fisher.carve(measure, b.resolved);
      Arena arena(HostHooks(), measure.used());
      fisher.carve(arena, b.resolved);
      fisher.open(b.resolved, r, b.nets, b.workers);
      fisher.read_live(kTrustRows.read(b.resolved.options));
      Batch batch(r.order, all);
      batch.envs = 16, batch.path = r.path;
      fisher.set_rows(batch);
      const size_t size = b.nets.block[Networks::kActor].size, skip = b.nets.std_size;
      std::vector<float> v(size), got(size);
      Stream stream(8, 0, Purpose::kTest);
      for (size_t j = skip; j < size; ++j) v[j] = static_cast<float>(stream.signed_unit());
      fisher.multiply(v.data(), got.data());
      std::vector<std::vector<double>> slopes(size - skip);  // of all outputs by each parameter
      std::vector<double> moved(size_of(b.resolved.samples) * 2);
      for (size_t j = skip; j < size; ++j) {
        std::vector<double> p = b.params();
        const double h = 1e-5, at = p[j];
        p[j] = at + h;
        slopes[j - skip] = in_double(b, p);
        p[j] = at - h;
        const auto below = in_double(b, p);
        for (size_t i = 0; i < moved.size(); ++i) {
          slopes[j - skip][i] = (slopes[j - skip][i] - below[i]) / (2 * h);
          moved[i] += slopes[j - skip][i] * static_cast<double>(v[j]);
        }
      }
      double largest = 0;
      for (size_t j = skip; j < size; ++j) {
        double want = 0;
        int32_t rows = 0;
        for (int32_t i = 0; i < all; i += stride, ++rows)
          for (size_t k = 0; k < 2; ++k) {
            const size_t at = size_of(r.order[i]) * 2 + k;
            want += slopes[j - skip][at] * moved[at] / (0.7 * 0.7);
          }
        want /= rows;
        largest = std::max(largest, std::abs(want));
        ASSERT_NEAR(static_cast<double>(got[j]), want, 2e-5) << j;
      }
      EXPECT_GT(largest, 0.5);
    }
}

// Cloning's gradient through the paths of episodes is the difference of the loss in double, with what the actor
// remembers before each path held; and that is what it remembers of the whole episode. Rows of 16 worlds stand in turn,
// and their episodes have 1 to 10 decisions.
TEST(Memory, GradientsByLabelsAreThoseOfDifferences) {
  for (const char* chunk : {"4", "10", "3"})
    for (const bool precise : {false, true}) {
      SCOPED_TRACE(std::string(chunk) + (precise ? ", by precision" : ""));
      Bench b(small_gru("ppo", chunk).with("normalize_obs", "false").with("init_std", "0.7"));
      Rollout& r = b.rollout;
      std::fill_n(r.age, b.resolved.samples, Rollout::kWholeMemory);
      std::vector<float> obs, label;
      std::vector<int64_t> episode;
      std::vector<size_t> at;  // in the rollout
      Stream stream(6, 0, Purpose::kTest);
      for (int32_t t = 0; t < 10; ++t)
        for (int32_t env = 0; env < 16; ++env) {
          if (t > 0 && t >= (env * 7) % 11) continue;
          at.push_back(size_of(t * 16 + env));
          obs.insert(obs.end(), b.obs(at.back()), b.obs(at.back()) + 3);
          for (int j = 0; j < 2; ++j) label.push_back(static_cast<float>(stream.signed_unit()));
          episode.push_back((env * 5) % 16);
        }
      DemoRows demo{static_cast<int32_t>(at.size()), obs.data(), label.data(), episode.data(), {}};
      DemoMemory memory;
      memory.open(b.resolved, demo);
      memory.attach(demo);
      Arena measure;
      Collector collector;
      collector.carve(measure, b.resolved);
      Arena arena(HostHooks(), measure.used());
      collector.carve(arena, b.resolved);
      collector.open(b.resolved, b.nets, b.workers);
      Regression regression;
      regression.open(b.resolved, collector, b.nets, b.workers);
      regression.remember(demo);
      // the rollout's states as the recording's
      std::fill_n(r.state, size_of(r.paths()) * 16 * 4, 0.0f);
      const std::vector<double> now = b.params();
      const int32_t path = r.path;
      for (int32_t i = 0; i < memory.paths(); ++i) {
        const size_t row = at[size_of(memory.row(i, 0))];
        std::copy_n(memory.state(i), 4, r.state + (row / 16 / size_of(path) * 16 + row % 16) * 4);
      }
      const auto cut = in_double(b, now);
      std::vector<float> states(r.state, r.state + size_of(r.paths()) * 16 * 4);
      std::fill_n(r.state, states.size(), 0.0f);
      r.path = 10;
      const auto whole = in_double(b, now);
      r.path = path;
      std::copy(states.begin(), states.end(), r.state);
      for (const size_t row : at) ASSERT_NEAR(cut[2 * row], whole[2 * row], 1e-6);

      std::vector<int32_t> order;  // all but two paths, backwards
      for (int32_t i = memory.paths(); i-- > 2;) order.push_back(i);
      const auto loss_of = [&](const std::vector<double>& p) {
        const auto y = in_double(b, p);
        double sum = 0;
        int32_t rows = 0;
        for (const int32_t i : order)
          for (int32_t t = 0; t < memory.rows(i); ++t, ++rows)
            for (size_t j = 0; j < 2; ++j) {
              const auto row = size_of(memory.row(i, t));
              const double e = y[2 * at[row] + j] - static_cast<double>(label[2 * row + j]);
              sum += e * e / 2 * (precise ? std::exp(-2 * now[j]) : 1);
            }
        return sum / rows;
      };
      std::vector<float> grad(b.nets.size);
      const auto items = static_cast<int32_t>(order.size());
      const double loss = regression.gradient(demo, order.data(), items, precise, 1, grad.data());
      EXPECT_NEAR(loss, loss_of(now), 1e-6);
      EXPECT_EQ(loss, regression.loss(demo, order.data(), items, precise));
      std::vector<double> p = now;
      double largest = 0;
      for (size_t j = b.nets.std_size; j < b.nets.block[Networks::kActor].size; ++j) {
        const double kept = p[j], h = 1e-5;
        p[j] = kept + h;
        const double up = loss_of(p);
        p[j] = kept - h;
        const double down = loss_of(p);
        p[j] = kept;
        largest = std::max(largest, std::abs(up - down) / (2 * h));
        ASSERT_NEAR(static_cast<double>(grad[j]), (up - down) / (2 * h), 1e-5) << j;
      }
      EXPECT_GT(largest, 0.02);
    }
}

TEST(Memory, EveryAlgorithmLearnsThroughIt) {
  int learned = 0;
  for (const int32_t i : on_policy_algos()) {
    const char* algo = algo_at(i).name;
    SCOPED_TRACE(algo);
    for (const Kind* kind : {&kKinds[0], &kKinds[4], &kKinds[5]}) {
      AgentSetup s = setup_of(*kind, algo);
      const double limit = 1;
      s.config.cost_limits = &limit;
      s.config.max_steps = 30;
      auto a = s.make();
      NoiseWorld world(s.config);
      const auto before = parameters(*a);
      for (int epoch = 0; epoch < 2; ++epoch) world.epoch(*a);
      const auto after = parameters(*a);
      EXPECT_NE(before, after);
      for (const float v : after) ASSERT_TRUE(std::isfinite(v));
      ++learned;
    }
  }
  EXPECT_EQ(learned, 3 * static_cast<int>(on_policy_algos().size()));
}

TEST(Memory, ActRecordAndUpdateTakeNoMemory) {
  for (const Kind& kind : kKinds) {
    SCOPED_TRACE(kind.name);
    AgentSetup s = setup_of(kind);
    auto a = s.make();
    NoiseWorld world(s.config);
    std::vector<float> action(27);
    world.epoch(*a);
    const int64_t before = heap_count();
    world.epoch(*a);
    a->act(world.obs(), false, action.data());
    a->forget(true, nullptr);
    EXPECT_EQ(heap_count(), before);
  }
}

TEST(Memory, RefusalsSayWhatIsWrong) {
  const auto refusal = [](const Pairs& options, const char* word) {
    AgentSetup s = setup_of({"", options});
    const Thrown t = thrown([&] { s.make(); });
    EXPECT_NE(t.code, Code::kOk) << word;
    EXPECT_NE(t.text.find(word), std::string::npos) << t.text;
  };
  refusal({{"memory", "lstm:4"}}, "gru:64");
  refusal({{"memory", "gru:"}}, "gru:64");
  refusal({{"memory", "gru:0"}}, "[1, 1024]");
  refusal({{"memory", "gru:4"}, {"history", "2"}}, "option history");
  refusal({{"memory", "gru:4"}, {"encoder", "8"}}, "encoder");
  refusal({{"history_fields", "a"}}, "history above 1");
  refusal({{"history", "2"}, {"history_fields", "a"}, {"actor_obs", "b"}}, "actor_obs");
  refusal({{"history", "2"}, {"history_fields", "*"}, {"actor_obs", "b"}}, "actor_obs");
  refusal({{"history", "2"}, {"history_fields", "d"}}, "history_fields");
  for (const Kind* kind : {&kKinds[0], &kKinds[4]}) {
    auto a = setup_of(*kind).make();
    const std::vector<float> obs(54), label(27);
    const DemoRows demo{9, obs.data(), label.data(), nullptr, {}};
    a->clone(demo, {});
    a->set_recording(demo, 1);
    std::vector<float> action(27);
    a->act(obs.data(), true, action.data());
    EXPECT_EQ(thrown([&] { a->forget(false, nullptr); }).code, Code::kState);
    a->forget(true, nullptr);
  }
}

// Labels that tell of the decision before: a clone with a history finds them, one without cannot, and what it learned
// acts so in an episode, whose first decision has nothing before it. Rows of four worlds stand in turn.
TEST(Memory, AHistoryIsClonedFromLabels) {
  constexpr int32_t kEnvs = 4, kSteps = 600, kLength = 12, kRows = kEnvs * kSteps;
  std::vector<float> obs, label(size_of(kRows) * 3);
  std::vector<int64_t> episode;
  Stream stream(6, 0, Purpose::kTest);
  obs = random_row(stream, size_of(kRows) * 6);
  for (int32_t t = 0; t < kSteps; ++t)
    for (int32_t e = 0; e < kEnvs; ++e) {
      const auto row = size_of(t * kEnvs + e);
      episode.push_back(t / kLength * kEnvs + e);
      for (size_t j = 0; j < 3 && t % kLength > 0; ++j)
        label[row * 3 + j] = 0.8f * obs[(row - kEnvs) * 6 + j];  // of the decision before
    }
  const DemoRows demo{kRows, obs.data(), label.data(), episode.data(), {}};
  CloneOptions how;
  how.epochs = 60;
  how.learning_rate = 1e-2;
  how.learning_rate_end = 1e-4;
  how.validation = 0.2;
  double loss[2];
  for (const int32_t kind : {0, 1}) {
    AgentSetup s = setup_of({"", kind ? Pairs{{"history", "2"}} : Pairs{}}, "ppo", kEnvs);
    s.with("hidden", "32").with("last_layer_scale", "1");
    auto a = s.make();
    const CloneReport report = a->clone(demo, how);
    loss[kind] = report.validation_loss;
    if (kind == 0) continue;
    Frozen frozen(*a);
    double most = 0;
    for (int32_t t = 0; t < 2 * kLength; ++t) {
      if (t % kLength == 0)
        for (size_t e = 0; e < size_of(kEnvs); ++e) frozen.forget(e);
      const auto action = frozen.act(obs.data() + size_of(t * kEnvs) * 6, kEnvs);
      for (size_t i = 0; i < action.size(); ++i)
        most = std::max(most, std::abs(static_cast<double>(action[i] - label[size_of(t * kEnvs) * 3 + i])));
    }
    EXPECT_LT(most, 0.25);
  }
  EXPECT_GT(loss[0], 0.1);
  EXPECT_LT(loss[1], 0.02);
}

// Files of a memory are not those of another one.
TEST(Memory, WarmStartsNeedTheSameMemory) {
  for (const Kind& from : kKinds)
    for (const Kind& to : kKinds) {
      if (&to == &kKinds.back()) continue;  // begins with its teacher alone (test_latent)
      auto a = setup_of(from).make(), b = setup_of(to).make();
      const auto bytes = policy_file(*a);
      Policy* p = Policy::read(bytes.data(), bytes.size(), HostHooks{});
      const Thrown t = thrown([&] { b->load_policy(p->view(), 100); });
      EXPECT_EQ(t.code == Code::kOk, &from == &to) << from.name << " to " << to.name << ": " << t.text;
      if (&from == &to) b->update_policy(*p);
      Policy::destroy(p);
    }
}

namespace {

// What the actor gives for every row of a horizon, behind the passes; with a rate of 0 it is what acted.
class Outputs final : public Ppo {
 public:
  explicit Outputs(ResolvedAgentConfig&& resolved) : Ppo(std::move(resolved)) {}
  float gap() const {  // from the means that acted; -1: of no row
    const Batch& listed = whole_batch();
    const size_t dim = resolved().action_dim();
    float most = -1;
    for (int32_t i = 0; i < listed.rows; ++i) {
      const auto at = static_cast<size_t>(listed.order[i]);
      for (size_t j = 0; j < dim; ++j)
        most = std::max(most, std::abs(all_[at * width() + j] - rollout().mean[at * dim + j]));
    }
    return most;
  }

 protected:
  int32_t second_passes() const override { return 1; }
  Job begin_second() override {
    all_.assign(static_cast<size_t>(resolved().samples) * width(), 0);
    return learner().begin_outputs(whole_batch(), all_.data());
  }

 private:
  size_t width() const {
    return static_cast<size_t>(resolved().actor.out);
  }  // deviations too, with std_mode=state
  std::vector<float> all_;
};

}  // namespace

// The policy that CUP projects towards is that of an actor that remembers, too.
TEST(Memory, OutputsOfTheListedRowsAreThoseThatActed) {
  for (const Kind& kind : kKinds) {
    if (&kind == &kKinds.back()) continue;  // a student has no such passes
    SCOPED_TRACE(kind.name);
    AgentSetup s = setup_of(kind, "ppo");
    s.with("learning_rate", "0");
    const AgentConfig& config = s.ready();
    Outputs agent(resolve_config(config));
    agent.open(config);
    NoiseWorld world(s.config);
    world.epoch(agent);
    EXPECT_GE(agent.gap(), 0);
    EXPECT_LE(agent.gap(), 1e-5f);
  }
}
