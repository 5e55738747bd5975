// Speed of a PointNet per instruction set, one thread, CPU time: forward and backward pass of a row of 512
// and of 2,048 points with layers 64 and 128. Then an agent's (ppo_lag, 381 entries, 40 actions, 1,024
// decisions, 5 passes, layers 64,64): acting, and samples times passes per second of its update, end to end
// and with a frozen encoder. tests/bench/torch_points.py is the same in torch.
//   bench_points [tanh|elu|relu]
#include <cstdio>
#include <cstring>
#include <ctime>
#include <vector>

#include "agents.hpp"
#include "base/fpmode.hpp"
#include "nn/pointnet.hpp"
#include "nn_data.hpp"

namespace {

using namespace rdm;
constexpr int32_t kRows = 64;

double seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Best of some, s.
template <class F>
double best_of(F&& f) {
  double best = 1e9;
  for (int i = 0; i < 7; ++i) {
    const double before = seconds();
    f();
    best = std::min(best, seconds() - before);
  }
  return best;
}

void run(const char* isa, int32_t points, Activation activation) {
  PointNetShape shape;
  shape.points = points;
  shape.mlp = make_shape(3, {64}, 128, activation);
  Arena measure;
  carve_pointnet_scratch(measure, shape);
  Arena arena(HostHooks{}, measure.used());
  const PointNetScratch scratch = carve_pointnet_scratch(arena, shape);
  std::vector<float> params(shape.num_params()), y(kRows * 128), dy = random_floats(y.size(), 2),
                                                                 grad(params.size());
  std::vector<int32_t> winner(y.size());
  Stream stream(1, 0, Purpose::kInit);
  mlp_init(shape.mlp, stream, 1, params.data());
  const auto metres = random_floats(kRows * shape.row_points(), 1, 0.25f);
  std::vector<int16_t> cloud(metres.size());
  quantize_points(shape, metres.data(), metres.size() / 3, cloud.data());
  PointRows clouds;
  clouds.points = cloud.data();
  const double forward = best_of(
      [&] { pointnet_forward(shape, params.data(), clouds, kRows, scratch, y.data(), 128, winner.data()); });
  const double backward = best_of([&] {
    pointnet_backward(shape, params.data(), clouds, kRows, scratch, y.data(), 128, winner.data(), dy.data(),
                      grad.data());
  });
  const double flops = 2.0 * kRows * points * (3 * 64 + 64 * 128);
  std::printf("%-10s %4d points  forward %.4f ms a row, %.1f GFlop/s  backward %.4f ms, %.1f %% of it\n", isa,
              points, 1e3 * forward / kRows, 1e-9 * flops / forward, 1e3 * backward / kRows,
              100 * backward / forward);
}

void run_agent(int32_t points, const char* frozen) {
  const std::string count = std::to_string(points);
  test::AgentSetup s("ppo_lag", 381, 40, 128);
  s.with("encoder", "64,128").with("encoder_points", count.c_str()).with("encoder_frozen", frozen);
  s.with("horizon", "8").with("passes", "5").with("minibatches", "4");
  const test::AgentPtr a = s.make();
  test::NoiseWorld world(s.config);
  const auto metres = random_floats(128 * a->eyes().row_points(), 1, 0.25f);
  PointRows clouds;
  clouds.metres = metres.data();
  double act = 1e9, update = 1e9;
  for (int i = 0; i < 3; ++i) {
    double acting = 0;
    while (a->missing() > 0) {
      const double before = seconds();
      a->act(world.obs(), true, world.action(), clouds);
      acting += seconds() - before;
      world.draw();
      Transition t = world.transition();
      t.valid = nullptr;
      a->record(t);
    }
    const double before = seconds();
    a->update(world.obs(), nullptr);
    update = std::min(update, seconds() - before), act = std::min(act, acting);
  }
  std::printf(
      "agent, %4d points, encoder_frozen=%-3s  act %.4f ms a row  update %.0f samples times passes/s\n",
      points, frozen, 1e3 * act / 1024, 5 * 1024 / update);
}

}  // namespace

int main(int argc, char** argv) {
  const FpMode mode;
  const char* name = argc > 1 ? argv[1] : "relu";
  const Activation activation = std::strcmp(name, "tanh") == 0  ? Activation::kTanh
                                : std::strcmp(name, "elu") == 0 ? Activation::kElu
                                                                : Activation::kRelu;
  for_each_isa([&](const char* isa) {
    for (const int32_t points : {512, 2048}) run(isa, points, activation);
  });
  for (const int32_t points : {512, 2048})
    for (const char* frozen : {"off", "on"}) run_agent(points, frozen);
}
