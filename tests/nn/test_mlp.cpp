#include <gtest/gtest.h>

#include <cstring>

#include "base/error.hpp"
#include "heap_count.hpp"
#include "nn/gaussian.hpp"
#include "nn/mlp.hpp"
#include "nn_data.hpp"

using namespace rdm;

namespace {

// The tiny golden net: 2 -> 2 tanh -> 2.
const std::vector<float> kParams = {.5f, -.3f, .2f, .4f, .1f, -.1f, .7f, -.6f, .3f, .9f, .05f, -.05f};
const std::vector<float> kLogStd = {-.2f, .1f};
const std::vector<float> kObs = {1, -.5f, .2f, .8f};

void expect_relative(const std::vector<float>& got, const std::vector<double>& want, double tolerance) {
  ASSERT_EQ(got.size(), want.size());
  for (size_t i = 0; i < got.size(); ++i)
    EXPECT_NEAR(static_cast<double>(got[i]), want[i], tolerance * std::abs(want[i])) << "entry " << i;
}

// Largest difference, relative to the largest value.
double distance(const std::vector<float>& a, const std::vector<double>& b) {
  double top = 0, gap = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    top = std::max(top, std::abs(b[i]));
    gap = std::max(gap, std::abs(static_cast<double>(a[i]) - b[i]));
  }
  return gap / top;
}

// Gradient of mean(rho A) at theta, log_std first.
std::vector<float> surrogate_gradient(const std::vector<float>& advantage) {
  const MlpShape shape = make_shape(2, {2}, 2);
  OwnedScratch s(shape, 2);
  const std::vector<float> action = {.5f, -.2f, -.3f, .6f};
  std::vector<float> mean(4), dmean(4), grad(2 + shape.num_params());
  mlp_forward(shape, kParams.data(), kObs.data(), 2, s.scratch, mean.data());
  for (size_t i = 0; i < 2; ++i)
    gaussian_log_prob_grad(&mean[2 * i], kLogStd.data(), &action[2 * i], 2, advantage[i] / 2, &dmean[2 * i],
                           grad.data());
  mlp_backward(shape, kParams.data(), kObs.data(), 2, s.scratch, dmean.data(), grad.data() + 2);
  return grad;
}

}  // namespace

TEST(Mlp, GoldenMeans) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    const MlpShape shape = make_shape(2, {2}, 2);
    OwnedScratch s(shape, 2);
    std::vector<float> mean(4);
    mlp_forward(shape, kParams.data(), kObs.data(), 2, s.scratch, mean.data());
    expect_relative(mean, {0.5544050634, 0.0508434906, -0.1305623958, 0.1668723753}, 1e-6);
  });
}

TEST(Mlp, GoldenSurrogateGradients) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    expect_relative(surrogate_gradient({1, -.5f}),
                    {-0.2584994026, -0.2626401028, -0.0318034923, 0.0317513315, -0.0894114637, -0.0543775718,
                     -0.0177149720, -0.1774855114, -0.0283016040, 0.0201143145, -0.0616770528, -0.0123096751,
                     0.0226113920, -0.1913403666},
                    1e-5);
    expect_relative(surrogate_gradient({.2f, .7f}),
                    {-0.4345683017, -0.3910906157, -0.0119961066, -0.0161913662, 0.0173473263, 0.1300429619,
                     -0.0317200351, 0.1406509931, -0.0016181372, -0.0216885721, -0.0180062250, 0.0336088596,
                     -0.0965862027, 0.1035778892},
                    1e-5);
  });
}

// Tangent, weight by 1 / (sigma^2 N), backward: the Fisher product of the mean's parameters.
TEST(Mlp, GoldenFisherProduct) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    const MlpShape shape = make_shape(2, {2}, 2);
    OwnedScratch s(shape, 2);
    const std::vector<float> v = {.1f, .4f, -.5f, .2f, .3f, -.1f, .6f, -.4f, .2f, .1f, -.3f, .5f};
    std::vector<float> y(4), dy(4), product(v.size());
    mlp_forward(shape, kParams.data(), kObs.data(), 2, s.scratch, y.data());
    mlp_tangent(shape, kParams.data(), v.data(), kObs.data(), 2, s.scratch, dy.data());
    for (size_t i = 0; i < 4; ++i) dy[i] *= std::exp(-2 * kLogStd[i % 2]) / 2;
    mlp_backward(shape, kParams.data(), kObs.data(), 2, s.scratch, dy.data(), product.data());
    expect_relative(product,
                    {0.2165132186, -0.0130627099, -0.2213710926, 0.3035867227, 0.3011300181, -0.0499033803,
                     0.2925668526, -0.0377647527, -0.0034839289, 0.0691267474, 0.495534172, 0.2884270974},
                    1e-5);
  });
}

TEST(Mlp, ForwardBackwardAndTangentAgreeWithDoubleDifferences) {
  struct Case {
    int32_t in;
    std::vector<int32_t> hidden;
    int32_t out, rows;
  };
  const Case cases[] = {{7, {5}, 3, 9},      {3, {}, 4, 5},           {19, {33, 18}, 1, 13},
                        {70, {40, 6}, 2, 8}, {9, {4, 8, 5, 7}, 6, 3}, {21, {64}, 17, 1}};
  for (const Activation activation : {Activation::kTanh, Activation::kElu, Activation::kRelu})
    for (const Case& c : cases) {
      const MlpShape shape = make_shape(c.in, c.hidden, c.out, activation);
      const size_t n = shape.num_params(), rows = static_cast<size_t>(c.rows),
                   out = static_cast<size_t>(c.out), in = static_cast<size_t>(c.in);
      std::vector<float> params(n);
      Stream stream(7, 0, Purpose::kTest);
      mlp_init(shape, stream, 1, params.data());
      const auto x = random_floats(rows * in, 1), dy = random_floats(rows * out, 2), v = random_floats(n, 3);

      const auto all_rows = [&](const std::vector<double>& p) {
        std::vector<double> all;
        for (size_t r = 0; r < rows; ++r) {
          const auto one = net_in_double(
              shape, p, {x.begin() + static_cast<long>(r * in), x.begin() + static_cast<long>((r + 1) * in)});
          all.insert(all.end(), one.begin(), one.end());
        }
        return all;
      };
      const auto loss = [&](const std::vector<double>& p) {
        double sum = 0;
        const auto z = all_rows(p);
        for (size_t i = 0; i < z.size(); ++i) sum += z[i] * static_cast<double>(dy[i]);
        return sum;
      };
      const double h = 1e-6;
      const std::vector<double> p(params.begin(), params.end());
      std::vector<double> slopes(n), along = p, against = p;
      for (size_t i = 0; i < n; ++i) {
        auto q = p;
        q[i] = p[i] + h;
        const double up = loss(q);
        q[i] = p[i] - h;
        slopes[i] = (up - loss(q)) / (2 * h);
        along[i] += h * static_cast<double>(v[i]), against[i] -= h * static_cast<double>(v[i]);
      }
      const auto value = all_rows(p), behind = all_rows(against);
      auto tangent = all_rows(along);
      for (size_t i = 0; i < tangent.size(); ++i) tangent[i] = (tangent[i] - behind[i]) / (2 * h);

      for_each_isa([&](const char* isa) {
        SCOPED_TRACE(std::string(isa) + " activation " + std::to_string(static_cast<int>(activation)) +
                     " inputs " + std::to_string(c.in));
        std::vector<float> y(rows * out), dy_tangent(rows * out), grad(n, 99);
        OwnedScratch s(shape, c.rows);
        mlp_forward(shape, params.data(), x.data(), c.rows, s.scratch, y.data());
        mlp_tangent(shape, params.data(), v.data(), x.data(), c.rows, s.scratch, dy_tangent.data());
        mlp_backward(shape, params.data(), x.data(), c.rows, s.scratch, dy.data(), grad.data());
        EXPECT_LT(distance(y, value), 2e-6);
        EXPECT_LT(distance(grad, slopes), 5e-6);
        EXPECT_LT(distance(dy_tangent, tangent), 5e-6);
      });
    }
}

// u'(F v) = v'(F u): tangent and backward are each other's transpose.
TEST(Mlp, TangentAndBackwardAreTransposed) {
  const MlpShape shape = make_shape(398, {64, 64}, 40);
  const int32_t rows = 300;
  std::vector<float> params(shape.num_params()), y(rows * 40), jv(rows * 40), jtu(shape.num_params());
  Stream stream(7, 0, Purpose::kTest);
  mlp_init(shape, stream, 1, params.data());
  const auto x = random_floats(rows * 398, 1), u = random_floats(rows * 40, 2),
             v = random_floats(params.size(), 3);
  OwnedScratch s(shape, rows);
  mlp_forward(shape, params.data(), x.data(), rows, s.scratch, y.data());
  mlp_tangent(shape, params.data(), v.data(), x.data(), rows, s.scratch, jv.data());
  mlp_backward(shape, params.data(), x.data(), rows, s.scratch, u.data(), jtu.data());
  double left = 0, right = 0, size = 0;
  for (size_t i = 0; i < jv.size(); ++i) {
    left += static_cast<double>(jv[i]) * static_cast<double>(u[i]);
    size += std::abs(static_cast<double>(jv[i]) * static_cast<double>(u[i]));
  }
  for (size_t i = 0; i < v.size(); ++i) right += static_cast<double>(jtu[i]) * static_cast<double>(v[i]);
  EXPECT_NEAR(left, right, 1e-6 * size);
}

TEST(Mlp, ARowDoesNotDependOnItsBatch) {
  struct Net {
    MlpShape shape;
  };
  const Net nets[] = {{make_shape(398, {64, 64}, 40)},
                      {make_shape(398, {64, 64}, 1)},
                      {make_shape(613, {256, 256}, 20, Activation::kElu)},
                      {make_shape(17, {31, 530}, 3, Activation::kRelu)}};
  for_each_isa([&](const char* isa) {
    for (const Net& net : nets) {
      SCOPED_TRACE(std::string(isa) + " outputs " + std::to_string(net.shape.out));
      const int32_t rows = 1024;
      const size_t in = static_cast<size_t>(net.shape.in), out = static_cast<size_t>(net.shape.out);
      std::vector<float> params(net.shape.num_params()), whole(rows * out), part(rows * out);
      Stream stream(3, 0, Purpose::kTest);
      mlp_init(net.shape, stream, 1, params.data());
      const auto x = random_floats(rows * in, 4);
      OwnedScratch s(net.shape, rows);
      mlp_forward(net.shape, params.data(), x.data(), rows, s.scratch, whole.data());
      for (const int32_t batch : {1, 2, 3, 5, 6, 7, 13, 64, 100}) {
        OwnedScratch small(net.shape, batch);
        for (int32_t r = 0; r + batch <= 200; r += batch)
          mlp_forward(net.shape, params.data(), x.data() + static_cast<size_t>(r) * in, batch, small.scratch,
                      part.data() + static_cast<size_t>(r) * out);
        const auto done = static_cast<size_t>(200 / batch * batch) * out;
        EXPECT_EQ(std::memcmp(whole.data(), part.data(), done * sizeof(float)), 0) << "batch " << batch;
      }
    }
  });
}

TEST(Mlp, EachInstructionSetIsDeterministicAndAllAgree) {
  const MlpShape shape = make_shape(398, {256, 256}, 40);
  const int32_t rows = 500;
  std::vector<float> params(shape.num_params());
  Stream stream(3, 0, Purpose::kTest);
  mlp_init(shape, stream, 1, params.data());
  const auto x = random_floats(rows * 398, 4), dy = random_floats(rows * 40, 5);
  std::vector<double> first_y, first_grad;
  for_each_isa([&](const char* isa) {
    SCOPED_TRACE(isa);
    std::vector<float> y[2], grad[2];
    for (int i = 0; i < 2; ++i) {
      OwnedScratch s(shape, rows);
      y[i].resize(rows * 40);
      grad[i].resize(params.size());
      mlp_forward(shape, params.data(), x.data(), rows, s.scratch, y[i].data());
      mlp_backward(shape, params.data(), x.data(), rows, s.scratch, dy.data(), grad[i].data());
    }
    EXPECT_EQ(std::memcmp(y[0].data(), y[1].data(), y[0].size() * sizeof(float)), 0);
    EXPECT_EQ(std::memcmp(grad[0].data(), grad[1].data(), grad[0].size() * sizeof(float)), 0);
    if (first_y.empty()) {
      first_y.assign(y[0].begin(), y[0].end());
      first_grad.assign(grad[0].begin(), grad[0].end());
    }
    EXPECT_LT(distance(y[0], first_y), 1e-5);
    EXPECT_LT(distance(grad[0], first_grad), 1e-5);
  });
}

TEST(Mlp, NothingIsAllocated) {
  if (!kHeapIsCounted) GTEST_SKIP() << "a sanitizer owns the heap";
  const MlpShape shape = make_shape(398, {64, 64}, 40);
  std::vector<float> params(shape.num_params(), 0.01f), grad(params.size()), y(100 * 40), x(100 * 398, 0.5f);
  OwnedScratch s(shape, 100);
  const int64_t before = heap_count();
  mlp_forward(shape, params.data(), x.data(), 100, s.scratch, y.data());
  mlp_tangent(shape, params.data(), params.data(), x.data(), 100, s.scratch, y.data());
  mlp_backward(shape, params.data(), x.data(), 100, s.scratch, y.data(), grad.data());
  EXPECT_EQ(heap_count(), before);
  const OwnedScratch counted(shape, 1);
  EXPECT_GT(heap_count(), before) << "the counter counts";
}

TEST(Mlp, NoRowsGiveNoGradient) {
  const MlpShape shape = make_shape(5, {4}, 2);
  std::vector<float> params(shape.num_params(), 0.1f), grad(shape.num_params(), 9);
  OwnedScratch s(shape, 1);
  mlp_forward(shape, params.data(), params.data(), 0, s.scratch, nullptr);
  mlp_backward(shape, params.data(), params.data(), 0, s.scratch, params.data(), grad.data());
  EXPECT_EQ(grad, std::vector<float>(shape.num_params(), 0));
}

TEST(Mlp, NotANumberIsNotHidden) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const Activation activation : {Activation::kTanh, Activation::kElu, Activation::kRelu}) {
      const MlpShape shape = make_shape(4, {8}, 2, activation);
      std::vector<float> params(shape.num_params(), 0.1f), x = {1, NAN, 1, 1}, y(2);
      OwnedScratch s(shape, 1);
      mlp_forward(shape, params.data(), x.data(), 1, s.scratch, y.data());
      EXPECT_TRUE(std::isnan(y[0]) && std::isnan(y[1]));
    }
  });
}

TEST(Mlp, InitIsUniformWithinTheFanIn) {
  const MlpShape shape = make_shape(100, {400}, 50);
  std::vector<float> p(shape.num_params());
  Stream stream(1, 0, Purpose::kInit);
  mlp_init(shape, stream, 0.01f, p.data());
  double sum = 0, squares = 0, top = 0;
  const size_t n = shape.weight_offset(1);
  for (size_t i = 0; i < n; ++i) {
    const auto w = static_cast<double>(p[i]);
    sum += w, squares += w * w, top = std::max(top, std::abs(w));
  }
  EXPECT_LE(top, 0.1);
  EXPECT_GT(top, 0.0999);
  EXPECT_NEAR(sum / static_cast<double>(n), 0, 1.5e-3);  // 5 standard errors
  EXPECT_NEAR(squares / static_cast<double>(n), 0.01 / 3, 8e-5);
  for (size_t i = n; i < p.size(); ++i) EXPECT_LE(std::abs(p[i]), 0.01 * 0.05);
}

TEST(Mlp, ShapesOutsideTheBoundsAreErrors) {
  EXPECT_NO_THROW(check_mlp_shape(make_shape(398, {64, 64}, 40)));
  EXPECT_NO_THROW(check_mlp_shape(make_shape(1, {}, 1)));
  MlpShape bad[] = {make_shape(0, {}, 1),
                    make_shape(kMaxInputs + 1, {}, 1),
                    make_shape(1, {}, 0),
                    make_shape(1, {}, kMaxWidth + 1),
                    make_shape(1, {0}, 1),
                    make_shape(1, {kMaxWidth + 1}, 1),
                    make_shape(1, {}, 1, static_cast<Activation>(3))};
  for (const MlpShape& s : bad) EXPECT_THROW(check_mlp_shape(s), Error);
  MlpShape many = make_shape(1, {1, 1, 1, 1}, 1);
  many.num_hidden = 5;
  EXPECT_THROW(check_mlp_shape(many), Error);
}
