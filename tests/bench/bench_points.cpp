// Speed of a PointNet per instruction set, one thread, CPU time: forward and backward pass of a row of 512
// and of 2,048 points with layers 64 and 128, and what share of the product's operations per second the
// forward pass is. tests/bench/torch_points.py is the same in torch.
//   bench_points [tanh|elu|relu]
#include <cstdio>
#include <cstring>
#include <ctime>
#include <vector>

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
}
