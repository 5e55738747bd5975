#include "algos/off_policy/td3.hpp"

#include <algorithm>

#include "algos/algo_registry.hpp"
#include "algos/lagrange/cppo_pid.hpp"
#include "algos/lagrange/lagrange.hpp"

namespace rdm {
SharedOptions Td3::shared(const Options& options) {
  constexpr auto kShared =
      kReplaySharedRows.without<&SharedOptions::init_std, &SharedOptions::std_min, &SharedOptions::std_max>();
  SharedOptions o = with_replay(kShared.read(options));
  o.init_std = kTd3OwnRows.read(options).explore_std;
  o.std_min = 1e-6, o.std_max = 1e3;
  return o;
}

void Td3::carve(Arena& arena) {
  OffPolicy::carve(arena);
  slow_ = arena.make<float>(actor_shape().num_params());
}

void Td3::opened() {
  OffPolicy::opened();
  std::copy_n(nets().net(Networks::kActor), actor_shape().num_params(), slow_);
}

void Td3::read_live() {
  OffPolicy::read_live();
  own_ = kTd3OwnRows.read(options());
}

void Td3::actor_replaced() {
  OffPolicy::actor_replaced();
  std::copy_n(nets().net(Networks::kActor), actor_shape().num_params(), slow_);
}

void Td3::next_actions(const float* seen, int32_t rows, float* action, float* bonus) {
  const auto std = static_cast<float>(own_.target_std), clip = static_cast<float>(own_.target_clip);
  const size_t count = static_cast<size_t>(rows) * resolved().action_dim();
  mlp_forward(actor_shape(), slow_, seen, rows, actor_scratch(), action);
  squash(Squash::kMean, action, count);
  noise().normals(dhead(), static_cast<int>(count));
  for (size_t j = 0; j < count; ++j)
    action[j] = std::clamp(action[j] + std::clamp(std * dhead()[j], -clip, clip), -1.0f, 1.0f);
  std::fill_n(bonus, rows, 0.0f);
}

void Td3::own_actions(const float* seen, int32_t rows, float* action) {
  mlp_forward(actor_shape(), nets().net(Networks::kActor), seen, rows, actor_scratch(), action);
  squash(Squash::kMean, action, static_cast<size_t>(rows) * resolved().action_dim());
  std::copy_n(action, static_cast<size_t>(rows) * resolved().action_dim(), head());
}

double Td3::learn_actions(const float* seen, int32_t rows, float* slope, float, float* grad) {
  const size_t count = static_cast<size_t>(rows) * resolved().action_dim();
  for (size_t j = 0; j < count; ++j) slope[j] *= 1 - head()[j] * head()[j];
  mlp_backward(actor_shape(), nets().net(Networks::kActor), seen, rows, actor_scratch(), slope, grad);
  return 0;
}

void Td3::end_actor_step() {
  const auto share = static_cast<float>(off_options().tau);
  const float* const p = nets().net(Networks::kActor);
  const size_t size = actor_shape().num_params();
  for (size_t i = 0; i < size; ++i) slow_[i] += share * (p[i] - slow_[i]);
}

void Td3::visit_state(StateIo& io) {
  OffPolicy::visit_state(io);
  io.section("TD3A");
  const StateView<float> p = io.numbers(slow_, actor_shape().num_params(), -kMaxQOutput, kMaxQOutput);
  if (p)
    io.require(mlp_bound(actor_shape(), StateNumbers{p}, nets().input_bound) <= kMaxQOutput,
               "an actor whose outputs may be too large");
}

namespace {

struct Td3LagOptions : Td3Options, LagrangeOptions, WindowOptions {};
constexpr auto kTd3LagRows = option_rows<Td3LagOptions>(kTd3Rows, kLagrangeRows, kReplayWindowRows);
struct Td3PidOptions : Td3Options, PidRuleOptions, WindowOptions {};
constexpr auto kTd3PidRows = option_rows<Td3PidOptions>(kTd3Rows, kPidRows, kReplayWindowRows);

}  // namespace

constinit const AlgoRow kTd3 = replay_row<Td3>(
    "td3",
    "Twin delayed policy gradient from a replay memory (Fujimoto et al. 2018); costs are only recorded",
    kTd3Rows, Costs::kNone);
constinit const AlgoRow kTd3Lag = replay_row<Weighed<Td3, Lagrange>>(
    "td3_lag", "TD3 with pessimistic cost critics and a multiplier for each limit, by dual ascent",
    kTd3LagRows, Costs::kAny);
constinit const AlgoRow kTd3Pid = replay_row<Weighed<Td3, PidRule>>(
    "td3_pid", "TD3 with pessimistic cost critics and a PID-controlled multiplier for each limit",
    kTd3PidRows, Costs::kAny);

}  // namespace rdm
