#include "algos/core/networks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "base/elementary.hpp"

namespace rdm {
namespace {
constexpr const char* kNames[] = {"actor", "reward_critic", "cost_critic"};

// Bound on what a network of a loaded state may give: far beyond any that learns, and a float still holds its
// square.
constexpr double kMaxOutput = 1e18;

// Bound on the magnitude of every sum within a network whose inputs are within +-bound: layer by layer the
// largest sum of a row's magnitudes. at: where its parameters begin.
double largest_output(const MlpShape& s, const StateView<float>& params, size_t at, double bound) {
  double most = bound;
  for (int32_t l = 0; l < s.num_layers(); ++l) {
    const auto rows = static_cast<size_t>(s.layer_out(l)), cols = static_cast<size_t>(s.layer_in(l));
    double widest = 0;
    for (size_t i = 0; i < rows; ++i) {
      double sum = 0;
      for (size_t j = 0; j < cols; ++j)
        sum += std::abs(static_cast<double>(params[at + s.weight_offset(l) + i * cols + j]));
      widest =
          std::max(widest, bound * sum + std::abs(static_cast<double>(params[at + s.bias_offset(l) + i])));
    }
    most = std::max(most, widest);
    bound = s.activation == Activation::kTanh ? 1 : std::max(1.0, widest);
  }
  return most;
}

// Moments that some gradients can have left: with m = sum (1 - a) a^k g_k and v = sum (1 - b) b^k g_k^2 it is
// |m| <= sqrt(v) (1 - a) / sqrt((1 - b) (1 - a^2 / b)) = 7.27 sqrt(v) (Cauchy and Schwarz), but for squares
// below the smallest float. So no step is longer than that many learning rates.
bool moments_agree(const StateView<float>& m, const StateView<float>& v, size_t size) {
  for (size_t i = 0; i < size; ++i)
    if (std::abs(static_cast<double>(m[i])) > 8 * std::sqrt(static_cast<double>(v[i])) + 1e-15) return false;
  return true;
}
}  // namespace

Networks carve_networks(Arena& arena, const ResolvedAgentConfig& resolved) {
  Networks n;
  n.shape[Networks::kActor] = resolved.actor;
  n.shape[Networks::kReward] = resolved.reward_critic;
  n.shape[Networks::kCost] = resolved.cost_critic;
  const auto list = [](const Vector<int32_t>& columns) { return columns.empty() ? nullptr : columns.data(); };
  n.columns[Networks::kActor] = list(resolved.actor_columns);
  n.columns[Networks::kReward] = n.columns[Networks::kCost] = list(resolved.critic_columns);
  n.obs_dim = resolved.config.obs_dim;
  n.count = resolved.num_limited > 0 ? 3 : 2;
  n.action_dim = resolved.config.action_dim;
  n.std_size = resolved.state_std() ? 0 : (resolved.action_dim() + 15) / 16 * 16;
  n.std_low = static_cast<float>(elementary::log(resolved.options.number("std_min")));
  n.std_high = static_cast<float>(elementary::log(resolved.options.number("std_max")));
  n.log_share = resolved.log_share;
  n.input_bound = resolved.options.flag("normalize_obs") ? resolved.options.number("obs_clip") : 1e3;
  for (int32_t i = 0; i < n.count; ++i) {
    n.block[i].offset = n.size;
    n.block[i].size = n.shape[i].num_params() + (i == Networks::kActor ? n.std_size : 0);
    n.size += (n.block[i].size + 15) / 16 * 16;
  }
  n.params = arena.make<float>(n.size);
  n.average_share = resolved.options.number("average");
  if (n.average_share > 0) {
    n.average = arena.make<float>(n.block[Networks::kActor].size);
    n.averaged = arena.make<int64_t>(1);
  }
  for (int32_t i = 0; i < n.count; ++i) n.block[i].adam = carve_adam(arena, n.block[i].size);
  return n;
}

void init_networks(const Networks& n, const ResolvedAgentConfig& resolved) {
  const Options& o = resolved.options;
  for (int32_t i = 0; i < n.count; ++i) {
    Stream stream(resolved.config.seed, static_cast<uint32_t>(i), Purpose::kInit);
    const double last = i == Networks::kActor ? o.number("last_layer_scale") : 1;
    mlp_init(n.shape[i], stream, static_cast<float>(last), n.net(i));
  }
  const MlpShape& actor = n.shape[Networks::kActor];
  float* bias = n.net(Networks::kActor) + actor.bias_offset(actor.num_hidden);
  float* log_std = n.state_std() ? bias + n.action_dim : n.log_std();
  for (int32_t j = 0; j < n.action_dim; ++j) {
    bias[j] = resolved.config.initial_mean ? resolved.config.initial_mean[j] : 0;
    log_std[j] = static_cast<float>(elementary::log(o.number("init_std")));
  }
}

void average_actor(const Networks& n) {
  if (!n.average) return;
  const auto count = static_cast<double>(++*n.averaged);
  const auto share = static_cast<float>(std::max(1 - n.average_share, 1 / count));
  const size_t size = n.block[Networks::kActor].size;
  for (size_t j = 0; j < size; ++j) n.average[j] += share * (n.params[j] - n.average[j]);
}

void restart_average(const Networks& n) {
  if (!n.average) return;
  *n.averaged = 0;
  std::copy_n(n.params, n.block[Networks::kActor].size, n.average);
}

void clamp_log_std(const Networks& n) {
  if (n.state_std()) return;
  for (float* x : {n.log_std(), n.average})
    for (int32_t j = 0; x && j < n.action_dim; ++j) x[j] = std::clamp(x[j], n.std_low, n.std_high);
}

void Networks::bound_std(int32_t rows, float* y) const {
  const auto out = static_cast<size_t>(shape[kActor].out);
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i)
    for (size_t j = out / 2; j < out; ++j) {
      float& l = y[i * out + j];
      l = std::clamp(l, std_low, std_high) + log_share;
    }
}

void Networks::gate_std(const float* y, int32_t rows, float* dy) const {
  const float low = std_low + log_share, high = std_high + log_share;
  const auto out = static_cast<size_t>(shape[kActor].out);
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i)
    for (size_t j = out / 2; j < out; ++j)
      if (!(y[i * out + j] > low && y[i * out + j] < high)) dy[i * out + j] = 0;
}

void schedule_std(const Networks& n, const Options& o, int32_t done) {
  if (std::strcmp(o.text("std_schedule"), "linear") != 0) return;
  const double left = std::max(0.0, 1 - static_cast<double>(done) / o.integer("total_epochs"));
  const double std = o.number("std_min") + (o.number("init_std") - o.number("std_min")) * left;
  for (int32_t j = 0; j < n.action_dim; ++j) n.log_std()[j] = static_cast<float>(elementary::log(std));
}

int32_t Networks::num_tensors() const {
  int32_t tensors = state_std() ? 0 : 1;
  for (int32_t i = 0; i < count; ++i) tensors += 2 * shape[i].num_layers();
  return tensors;
}

void Networks::visit(StateIo& io) {
  io.section("NETS");
  const StateView<float> p = io.numbers(params, size, -kMaxOutput, kMaxOutput);
  for (int32_t i = 0; p && i < count; ++i)
    io.require(largest_output(shape[i], p, net_offset(i), input_bound) <= kMaxOutput,
               "a network whose outputs may be too large");
  if (average) {
    io.section("MEAN");
    io.counter(*averaged);
    const StateView<float> a = io.numbers(average, block[kActor].size, -kMaxOutput, kMaxOutput);
    if (a)
      io.require(largest_output(shape[kActor], a, std_size, input_bound) <= kMaxOutput,
                 "an average whose outputs may be too large");
  }
  io.section("ADAM");
  for (int32_t i = 0; i < count; ++i) {
    Adam& a = block[i].adam;
    io.counter(a.t);
    const StateView<float> m = io.numbers(a.m, a.size, -1e20, 1e20), v = io.numbers(a.v, a.size, 0, 1e38);
    if (m) io.require(moments_agree(m, v, a.size), "moments that no gradients have");
  }
}

bool find_tensor(const Networks& n, int32_t index, char* name, TensorInfo* out) {
  if (index < 0) return false;
  const auto set = [&](int32_t rows, int32_t cols, float* data) {
    *out = {name, rows, cols, data};
    return true;
  };
  if (!n.state_std() && index-- == 0) {
    std::snprintf(name, kTensorNameSize, "actor.log_std");
    return set(n.action_dim, 1, n.log_std());
  }
  for (int32_t i = 0; i < n.count; ++i) {
    const MlpShape& s = n.shape[i];
    const int32_t tensors = 2 * s.num_layers();
    if (index >= tensors) {
      index -= tensors;
      continue;
    }
    const int32_t l = index / 2;
    const bool weight = index % 2 == 0;
    std::snprintf(name, kTensorNameSize, "%s.%d.%s", kNames[i], l, weight ? "weight" : "bias");
    float* at = n.net(i) + (weight ? s.weight_offset(l) : s.bias_offset(l));
    return set(s.layer_out(l), weight ? s.layer_in(l) : 1, at);
  }
  return false;
}

}  // namespace rdm
