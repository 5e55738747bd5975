// Speed of lib/nn per instruction set, one thread, CPU time: samples per second of a PPO update (actor and
// two critics, 398 observations, 40 actions, 8192 samples, 5 passes, Adam with clipping), and the time of
// act.
//   bench_nn [hidden width] [minibatch] [instruction set]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <numeric>
#include <vector>

#include "base/fpmode.hpp"
#include "nn/adam.hpp"
#include "nn/gaussian.hpp"
#include "nn/normalizer.hpp"
#include "nn/policy.hpp"
#include "nn_data.hpp"

namespace {

using namespace rdm;
constexpr int32_t kObs = 398, kActions = 40, kBatch = 8192, kPasses = 5;

double seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}

struct Net {
  Net(const MlpShape& s, int32_t rows, size_t extra) : shape(s), scratch(s, rows) {
    const size_t n = s.num_params() + extra;
    Arena measure;
    carve_adam(measure, n);
    arena = Arena(HostHooks{}, measure.used());
    adam = carve_adam(arena, n);
    params.assign(n, -0.5f);
    grad.resize(n);
    Stream stream(1, 0, Purpose::kInit);
    mlp_init(s, stream, 1, params.data());
  }
  void forward(const float* x, int32_t rows, float* y) {
    mlp_forward(shape, params.data(), x, rows, scratch.scratch, y);
  }
  void learn(const float* x, int32_t rows, const float* dy, double rate) {
    mlp_backward(shape, params.data(), x, rows, scratch.scratch, dy, grad.data());
    adam_step(adam, params.data(), grad.data(), rate, 1);
  }
  MlpShape shape;
  OwnedScratch scratch;
  Arena arena;
  Adam adam;
  std::vector<float> params, grad;
};

struct Learner {
  Learner(int32_t width, int32_t minibatch)
      : rows(minibatch),
        actor(make_shape(kObs, {width, width}, kActions), rows, sz(kActions)),
        critics{{make_shape(kObs, {width, width}, 1), rows, 0},
                {make_shape(kObs, {width, width}, 1), rows, 0}},
        order(sz(kBatch)) {
    std::iota(order.begin(), order.end(), 0u);
  }

  const float* log_std() const { return actor.params.data() + actor.shape.num_params(); }

  void update() {
    for (int32_t pass = 0; pass < kPasses; ++pass) {
      for (uint32_t i = kBatch - 1; i > 0; --i) std::swap(order[i], order[stream.below(i + 1)]);
      for (int32_t at = 0; at + rows <= kBatch; at += rows) minibatch(&order[sz(at)]);
    }
  }

  void minibatch(const uint32_t* index) {
    for (size_t r = 0; r < sz(rows); ++r) {
      std::memcpy(&x[r * kObs], &obs[index[r] * sz(kObs)], kObs * sizeof(float));
      std::memcpy(&a[r * kActions], &action[index[r] * sz(kActions)], kActions * sizeof(float));
    }
    actor.forward(x.data(), rows, y.data());
    float* dlog_std = actor.grad.data() + actor.shape.num_params();
    std::fill_n(dlog_std, kActions, 0.0f);
    for (size_t r = 0; r < sz(rows); ++r) {
      const size_t at = r * kActions;
      const float ratio = std::exp(gaussian_log_prob(&y[at], log_std(), &a[at], kActions) + 40);
      const float gain = advantage[index[r]];
      const bool open = gain >= 0 ? ratio <= 1.2f : ratio >= 0.8f;
      gaussian_log_prob_grad(&y[at], log_std(), &a[at], kActions,
                             open ? -ratio * gain / static_cast<float>(rows) : 0.0f, &dy[at], dlog_std);
    }
    actor.learn(x.data(), rows, dy.data(), 3e-4);
    for (Net& critic : critics) {
      critic.forward(x.data(), rows, y.data());
      for (size_t r = 0; r < sz(rows); ++r)
        dy[r] = 2 * (y[r] - advantage[index[r]]) / static_cast<float>(rows);
      critic.learn(x.data(), rows, dy.data(), 1e-3);
    }
  }

  int32_t rows;
  Net actor, critics[2];
  std::vector<uint32_t> order;
  Stream stream{1, 0, Purpose::kMinibatch};
  std::vector<float> obs = random_floats(sz(kBatch) * kObs, 1),
                     action = random_floats(sz(kBatch) * kActions, 2), advantage = random_floats(kBatch, 3),
                     x = std::vector<float>(sz(rows) * kObs), a = std::vector<float>(sz(rows) * kActions),
                     y = a, dy = a;
};

// The least time of one call.
template <class Body>
double least(int calls, Body body) {
  double best = 1e9;
  for (int repeat = 0; repeat < 15; ++repeat) {
    const double begin = seconds();
    for (int i = 0; i < calls; ++i) body();
    best = std::min(best, (seconds() - begin) / calls);
  }
  return best;
}

void bench_act(const Learner& learner) {
  const std::vector<float> shift(kObs, 0.1f), scale(kObs, 0.9f);
  PolicyView view;
  view.actor = learner.actor.shape;
  view.params = learner.actor.params.data();
  view.log_std = learner.log_std();
  view.shift = shift.data();
  view.scale = scale.data();
  view.clip = 5;
  Writer measure(nullptr, 0);
  write_policy(measure, view);
  std::vector<unsigned char> bytes(measure.size());
  Writer out(bytes.data(), bytes.size());
  write_policy(out, view);
  const std::unique_ptr<Policy, void (*)(Policy*)> policy(
      Policy::read(bytes.data(), bytes.size(), HostHooks{}), Policy::destroy);
  std::vector<float> action(1024 * kActions), scratch(policy->scratch_bytes(1024) / sizeof(float));
  for (const int32_t rows : {1, 64, 1024}) {
    const double t = least(std::max(5, 2000 / rows), [&] {
      policy->act(learner.obs.data(), rows, learner.action.data(), action.data(), scratch.data());
    });
    std::printf("  act %4d rows: %8.2f us, %8.0f rows/s\n", rows, 1e6 * t, rows / t);
  }
}

void bench_normalizer(const std::vector<float>& obs) {
  Arena measure;
  carve_normalizer(measure, kObs);
  Arena arena(HostHooks{}, measure.used());
  Normalizer n = carve_normalizer(arena, kObs);
  std::vector<float> out(64 * kObs);
  const double merge = least(100, [&] { normalizer_merge(n, obs.data(), 64, nullptr, 0); });
  const double apply = least(100, [&] { normalizer_apply(n, obs.data(), 64, out.data()); });
  std::printf("  normaliser, 64 rows: merge %.2f us, apply %.2f us\n", 1e6 * merge, 1e6 * apply);
}

}  // namespace

int main(int argc, char** argv) {
  const FpMode mode;
  const int32_t width = argc > 1 ? std::atoi(argv[1]) : 64, minibatch = argc > 2 ? std::atoi(argv[2]) : 1024;
  for_each_isa([&](const char* isa) {
    if (argc > 3 && std::strcmp(argv[3], isa) != 0) return;
    Learner learner(width, minibatch);
    learner.update();
    const double samples = kPasses * static_cast<double>(kBatch / minibatch * minibatch);
    std::vector<double> rate;
    for (int repeat = 0; repeat < 5; ++repeat) {
      const double begin = seconds();
      learner.update();
      rate.push_back(samples / (seconds() - begin));
    }
    std::sort(rate.begin(), rate.end());
    std::printf("%s: update %d,%d minibatch %d: %.0f samples/s (%.0f to %.0f)\n", isa, width, width,
                minibatch, rate[2], rate.front(), rate.back());
    bench_act(learner);
    bench_normalizer(learner.obs);
  });
}
