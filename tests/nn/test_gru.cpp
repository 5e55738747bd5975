#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include "heap_count.hpp"
#include "nn/gru.hpp"
#include "nn_data.hpp"

using namespace rdm;

namespace {

struct Owned {
  Owned(const RecurrentShape& shape, int32_t rows) {
    const auto make = [&](Arena& a) {
      layers = carve_mlp_scratch(a, shape.mlp, rows);
      scratch = carve_recurrent_scratch(a, shape, rows, true);
    };
    Arena measure;
    make(measure);
    arena = Arena(HostHooks{}, measure.used());
    make(arena);
  }
  Arena arena;
  MlpScratch layers;
  RecurrentScratch scratch;
};

// What a forward pass is of, and its parts in float.
struct Case {
  RecurrentShape shape;
  int32_t steps, rows;
  std::vector<float> params, x, h0;
  std::vector<uint8_t> clear;
};

Case make_case(std::vector<int32_t> hidden, int32_t units, int32_t steps, int32_t rows, bool clears) {
  Case c{with_gru(make_shape(5, hidden, 3), units), steps, rows, {}, {}, {}, {}};
  c.params = random_floats(c.shape.num_params(), 1, 0.4f);
  c.x = random_floats(static_cast<size_t>(steps * rows * 5), 2);
  c.h0 = random_floats(static_cast<size_t>(rows * units), 3, 0.5f);
  c.clear.assign(static_cast<size_t>(steps * rows), 0);
  for (size_t i = 0; clears && i < c.clear.size(); ++i) c.clear[i] = i % 7 == 3;
  return c;
}

double sigmoid(double v) {
  return 1 / (1 + std::exp(-v));
}

// y [steps][rows][out] in double.
std::vector<double> in_double(const Case& c, const std::vector<double>& params) {
  const RecurrentShape& s = c.shape;
  const auto units = static_cast<size_t>(s.gru.units), in = static_cast<size_t>(s.gru.in);
  const auto rows = static_cast<size_t>(c.rows), dim = static_cast<size_t>(s.mlp.in);
  std::vector<double> y;
  std::vector<std::vector<double>> h(rows);
  for (size_t r = 0; r < rows; ++r)
    h[r].assign(c.h0.begin() + static_cast<long>(r * units),
                c.h0.begin() + static_cast<long>((r + 1) * units));
  const double* w = params.data() + s.gru_offset();
  const double *b = w + s.gru.input_bias_offset(), *u = w + s.gru.state_offset(),
               *cb = w + s.gru.state_bias_offset();
  for (size_t t = 0; t < static_cast<size_t>(c.steps); ++t)
    for (size_t r = 0; r < rows; ++r) {
      if (c.clear[t * rows + r]) h[r].assign(units, 0);
      const float* row = c.x.data() + (t * rows + r) * dim;
      std::vector<double> x(row, row + dim);
      if (s.mlp.num_hidden > 0) {
        MlpShape front = s.mlp;
        front.out = front.hidden[--front.num_hidden];
        x = net_in_double(front, params, x);
        for (double& v : x) v = std::tanh(v);
      }
      std::vector<double> next(units);
      const auto gate = [&](size_t k, const double* weights, const double* bias, const std::vector<double>& v,
                            size_t n) {
        double sum = bias[k];
        for (size_t i = 0; i < n; ++i) sum += weights[k * n + i] * v[i];
        return sum;
      };
      for (size_t j = 0; j < units; ++j) {
        const double re = sigmoid(gate(j, w, b, x, in) + gate(j, u, cb, h[r], units));
        const double z = sigmoid(gate(units + j, w, b, x, in) + gate(units + j, u, cb, h[r], units));
        const double n =
            std::tanh(gate(2 * units + j, w, b, x, in) + re * gate(2 * units + j, u, cb, h[r], units));
        next[j] = (1 - z) * n + z * h[r][j];
      }
      h[r] = next;
      const std::vector<double> head(params.begin() + static_cast<long>(s.head_offset()), params.end());
      for (const double v : net_in_double(s.head(), head, h[r])) y.push_back(v);
    }
  return y;
}

// A loss of all outputs: sum of weight y.
std::vector<float> loss_weights(const Case& c) {
  return random_floats(static_cast<size_t>(c.steps * c.rows * 3), 4);
}
double loss_in_double(const Case& c, const std::vector<double>& params) {
  const std::vector<double> y = in_double(c, params);
  const std::vector<float> weight = loss_weights(c);
  double sum = 0;
  for (size_t i = 0; i < y.size(); ++i) sum += static_cast<double>(weight[i]) * y[i];
  return sum;
}

std::vector<float> forward(const Case& c, Owned& own) {
  std::vector<float> y(static_cast<size_t>(c.steps * c.rows * 3));
  recurrent_forward(c.shape, c.params.data(), c.x.data(), c.steps, c.rows, c.h0.data(), c.clear.data(),
                    own.layers, own.scratch, y.data());
  return y;
}
std::vector<float> gradient(const Case& c, Owned& own) {
  forward(c, own);
  const std::vector<float> dy = loss_weights(c);
  std::vector<float> grad(c.shape.num_params(), 7);
  recurrent_backward(c.shape, c.params.data(), c.x.data(), c.steps, c.rows, c.clear.data(), own.layers,
                     own.scratch, dy.data(), grad.data());
  return grad;
}

std::vector<Case> cases() {
  return {make_case({8}, 6, 9, 4, true),       make_case({}, 5, 6, 1, false),
          make_case({7, 4}, 16, 20, 3, false), make_case({16}, 24, 16, 7, true),
          make_case({3}, 1, 5, 9, true),       make_case({6}, 180, 4, 8, true)};
}

}  // namespace

TEST(Gru, OutputsAreTheEquations) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const Case& c : cases()) {
      Owned own(c.shape, c.steps * c.rows);
      const std::vector<float> y = forward(c, own);
      const std::vector<double> want = in_double(c, {c.params.begin(), c.params.end()});
      for (size_t i = 0; i < y.size(); ++i)
        ASSERT_NEAR(static_cast<double>(y[i]), want[i], 4e-6 * (1 + std::abs(want[i]))) << i;
    }
  });
}

TEST(Gru, GradientsAreThoseOfDifferencesInDouble) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const Case& c : cases()) {
      Owned own(c.shape, c.steps * c.rows);
      const std::vector<float> grad = gradient(c, own);
      std::vector<double> params(c.params.begin(), c.params.end());
      constexpr double kStep = 1e-5;
      const size_t stride = params.size() > 200 ? params.size() / 50 : 1;  // of the larger ones some entries
      for (size_t i = 0; i < params.size(); i += stride) {
        const double at = params[i];
        params[i] = at + kStep;
        const double above = loss_in_double(c, params);
        params[i] = at - kStep;
        const double below = loss_in_double(c, params);
        params[i] = at;
        const double want = (above - below) / (2 * kStep);
        ASSERT_NEAR(static_cast<double>(grad[i]), want, 2e-5 * (1 + std::abs(want))) << i;
      }
    }
  });
}

// The derivative of all outputs along a direction is their difference in double, and the passes before and behind it
// are as without it.
TEST(Gru, TangentsAreDifferencesInDouble) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const Case& c : cases()) {
      Owned own(c.shape, c.steps * c.rows);
      const std::vector<float> y = forward(c, own), v = random_floats(c.params.size(), 9, 0.3f);
      std::vector<float> dy(y.size());
      recurrent_tangent(c.shape, c.params.data(), v.data(), c.x.data(), c.steps, c.rows, c.clear.data(),
                        own.layers, own.scratch, dy.data());
      std::vector<double> above(c.params.begin(), c.params.end()), below = above;
      constexpr double kStep = 1e-5;
      for (size_t i = 0; i < v.size(); ++i) {
        above[i] += kStep * static_cast<double>(v[i]);
        below[i] -= kStep * static_cast<double>(v[i]);
      }
      above = in_double(c, above), below = in_double(c, below);
      for (size_t i = 0; i < y.size(); ++i) {
        const double want = (above[i] - below[i]) / (2 * kStep);
        ASSERT_NEAR(static_cast<double>(dy[i]), want, 2e-5 * (1 + std::abs(want))) << i;
      }
      const std::vector<float> weight = loss_weights(c);
      std::vector<float> behind(c.params.size());
      recurrent_backward(c.shape, c.params.data(), c.x.data(), c.steps, c.rows, c.clear.data(), own.layers,
                         own.scratch, weight.data(), behind.data());
      EXPECT_EQ(behind, gradient(c, own));
    }
  });
}

// A row alone and step by step gives the bytes of the batch: what acted is what is learned from.
TEST(Gru, ARowAloneGivesTheBytesOfTheBatch) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const Case& c : cases()) {
      Owned own(c.shape, c.steps * c.rows);
      const std::vector<float> y = forward(c, own);
      const auto units = static_cast<size_t>(c.shape.gru.units), rows = static_cast<size_t>(c.rows);
      for (size_t r = 0; r < rows; ++r) {
        Owned alone(c.shape, 1);
        std::vector<float> h(c.h0.begin() + static_cast<long>(r * units),
                             c.h0.begin() + static_cast<long>((r + 1) * units)),
            out(3);
        for (size_t t = 0; t < static_cast<size_t>(c.steps); ++t) {
          const size_t at = t * rows + r;
          recurrent_forward(c.shape, c.params.data(), c.x.data() + 5 * at, 1, 1, h.data(), &c.clear[at],
                            alone.layers, alone.scratch, out.data());
          h.assign(alone.scratch.h, alone.scratch.h + units);
          ASSERT_EQ(std::memcmp(out.data(), y.data() + 3 * at, sizeof(float) * 3), 0) << at;
        }
      }
    }
  });
}

// Nothing flows back over a cleared memory: parts between clears have the gradients that they have alone.
TEST(Gru, AClearedStateCutsTheGradient) {
  Case c = make_case({8}, 6, 10, 4, false), first = c, second = c;
  for (size_t r = 0; r < 4; ++r) c.clear[5 * 4 + r] = 1;
  first.steps = second.steps = 5;
  second.x.erase(second.x.begin(), second.x.begin() + 5 * 4 * 5);
  second.h0.assign(second.h0.size(), 0);
  Owned own(c.shape, 40);
  const std::vector<float> whole = gradient(c, own);
  const std::vector<float> dy = loss_weights(c);
  std::vector<float> sum(whole.size(), 0), part(whole.size());
  for (const Case* half : {&first, &second}) {
    forward(*half, own);
    recurrent_backward(c.shape, c.params.data(), half->x.data(), 5, 4, nullptr, own.layers, own.scratch,
                       dy.data() + (half == &second ? 60 : 0), part.data());
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += part[i];
  }
  for (size_t i = 0; i < sum.size(); ++i)
    EXPECT_NEAR(sum[i], whole[i], 1e-5f * (1 + std::abs(whole[i]))) << i;
}

// Units at rest keep their state for 2 to `span` steps, so that of the input of `span` steps ago something is left.
TEST(Gru, AtFirstStatesLastForTheSpan) {
  constexpr int32_t kUnits = 200, kSpan = 20;
  const RecurrentShape shape = with_gru(make_shape(5, {}, 3), kUnits);
  std::vector<float> params(shape.gru.num_params());
  Stream stream(1, 0, Purpose::kTest);
  gru_init(shape.gru, stream, kSpan, params.data());
  const float* keep = params.data() + shape.gru.input_bias_offset() + kUnits;
  double mean = 0;
  for (int32_t i = 0; i < kUnits; ++i) {
    const double steps = 1 / (1 - sigmoid(static_cast<double>(keep[i])));
    EXPECT_GE(steps, 2 - 1e-5);
    EXPECT_LE(steps, kSpan);
    mean += steps / kUnits;
  }
  EXPECT_NEAR(mean, 0.5 * (2 + kSpan), 1);  // 2.8 standard errors of a uniform mean
  gru_init(shape.gru, stream, 1, params.data());
  for (int32_t i = 0; i < kUnits; ++i) EXPECT_EQ(keep[i], 0);
}

TEST(Gru, PassesTakeNoMemory) {
  const Case c = make_case({8}, 6, 9, 4, true);
  Owned own(c.shape, 36);
  std::vector<float> y(108), grad(c.shape.num_params());
  const std::vector<float> dy = loss_weights(c);
  const int64_t before = heap_count();
  recurrent_forward(c.shape, c.params.data(), c.x.data(), 9, 4, c.h0.data(), c.clear.data(), own.layers,
                    own.scratch, y.data());
  recurrent_backward(c.shape, c.params.data(), c.x.data(), 9, 4, c.clear.data(), own.layers, own.scratch,
                     dy.data(), grad.data());
  EXPECT_EQ(heap_count(), before);
}

// tests/nn/gru_torch.txt: what torch.nn.GRU gives and its gradients (tests/nn/gru_torch.py writes it).
TEST(Gru, IsTorchsToTheFifthDigit) {
  std::ifstream file(RDM_TEST_DATA "/nn/gru_torch.txt");
  ASSERT_TRUE(file);
  int32_t in = 0, units = 0, steps = 0, rows = 0;
  std::string comment;
  while (file.peek() == '#') std::getline(file, comment);
  file >> in >> units >> steps >> rows;
  const auto read = [&](int32_t count) {
    std::vector<float> v(static_cast<size_t>(count));
    for (float& x : v) file >> x;
    return v;
  };
  const GruShape shape{in, units};
  const auto size = static_cast<int32_t>(shape.num_params());
  const std::vector<float> params = read(size), x = read(steps * rows * in), h0 = read(rows * units),
                           dh = read(steps * rows * units), h = read(steps * rows * units), grad = read(size),
                           dx = read(steps * rows * in);
  ASSERT_TRUE(file);
  for_each_isa([&](const char* isa) {
    SCOPED_TRACE(isa);
    Arena measure;
    carve_gru_scratch(measure, shape, steps * rows);
    Arena arena(HostHooks{}, measure.used());
    const GruScratch scratch = carve_gru_scratch(arena, shape, steps * rows);
    std::vector<float> ours(h.size()), our_grad(grad.size()), our_dx(dx.size());
    gru_forward(shape, params.data(), x.data(), steps, rows, h0.data(), nullptr, scratch, ours.data());
    gru_backward(shape, params.data(), x.data(), steps, rows, nullptr, scratch, dh.data(), our_grad.data(),
                 our_dx.data());
    for (size_t i = 0; i < h.size(); ++i) ASSERT_NEAR(ours[i], h[i], 1e-5f) << i;
    for (size_t i = 0; i < grad.size(); ++i)
      ASSERT_NEAR(our_grad[i], grad[i], 1e-5f * (1 + std::abs(grad[i]))) << i;
    for (size_t i = 0; i < dx.size(); ++i) ASSERT_NEAR(our_dx[i], dx[i], 1e-5f * (1 + std::abs(dx[i]))) << i;
  });
}
