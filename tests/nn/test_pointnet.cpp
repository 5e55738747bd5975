#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "base/error.hpp"
#include "heap_count.hpp"
#include "nn/pointnet.hpp"
#include "nn_data.hpp"
#include "oracle_pointnet.hpp"

using namespace rdm;

namespace {

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}

struct Case {
  std::vector<int32_t> widths;  // the last: features
  int32_t points, classes, rows;
  bool color = false;
  Activation activation = Activation::kTanh;
};

// An encoder with weights, clouds and workspace.
struct Eyes {
  explicit Eyes(const Case& c, uint64_t seed = 5) : rows(c.rows) {
    shape.points = c.points, shape.classes = c.classes, shape.color = c.color;
    const std::vector<int32_t> hidden(c.widths.begin(), c.widths.end() - 1);
    shape.mlp = make_shape(shape.channels(), hidden, c.widths.back(), c.activation);
    shape.origin[0] = 0.1f, shape.origin[2] = -0.5f;
    check_pointnet_shape(shape);
    params.resize(shape.num_params());
    Stream stream(seed, 0, Purpose::kTest);
    mlp_init(shape.mlp, stream, 1, params.data());
    metres = random_floats(sz(c.rows) * shape.row_points(), seed + 1, 0.25f);
    points.resize(metres.size());
    quantize_points(shape, metres.data(), metres.size() / 3, points.data());
    for (size_t i = 0; i < metres.size() / 3; ++i)
      classes.push_back(static_cast<uint8_t>(stream.below(static_cast<uint32_t>(std::max(1, c.classes)))));
    for (size_t i = 0; i < metres.size(); ++i) colors.push_back(static_cast<uint8_t>(stream.below(256)));
    Arena measure;
    carve_pointnet_scratch(measure, shape);
    arena = Arena(HostHooks{}, measure.used());
    scratch = carve_pointnet_scratch(arena, shape);
    y.resize(sz(rows) * features()), winner.resize(y.size());
  }
  size_t features() const { return sz(shape.features()); }
  PointRows clouds() const {
    PointRows r;
    r.points = points.data();
    r.classes = shape.classes ? classes.data() : nullptr;
    r.colors = shape.color ? colors.data() : nullptr;
    return r;
  }
  void forward() {
    pointnet_forward(shape, params.data(), clouds(), rows, scratch, y.data(), features(), winner.data());
  }
  std::vector<float> backward(const std::vector<float>& dy) {
    std::vector<float> grad(params.size(), 99);
    pointnet_backward(shape, params.data(), clouds(), rows, scratch, y.data(), features(), winner.data(),
                      dy.data(), grad.data());
    return grad;
  }
  std::vector<float> tangent(const std::vector<float>& v) {
    std::vector<float> dy(y.size(), 99);
    pointnet_tangent(shape, params.data(), v.data(), clouds(), rows, scratch, y.data(), features(),
                     winner.data(), dy.data());
    return dy;
  }
  // Features of all rows in double, by brute force over the points.
  std::vector<double> in_double(const std::vector<double>& p, std::vector<int32_t>* won = nullptr) const {
    std::vector<double> out;
    for (size_t r = 0; r < sz(rows); ++r) {
      std::vector<double> best(features(), -INFINITY);
      std::vector<int32_t> at(features());
      for (size_t i = 0; i < sz(shape.points); ++i) {
        std::vector<double> x(sz(shape.mlp.in));
        const float step = 0.001f / shape.range;
        for (size_t k = 0; k < 3; ++k)
          x[k] = static_cast<double>(step * static_cast<float>(points[(r * sz(shape.points) + i) * 3 + k]));
        if (shape.classes) x[3 + sz(classes[r * sz(shape.points) + i])] = 1;
        for (size_t k = 0; shape.color && k < 3; ++k)
          x[3 + sz(shape.classes) + k] = colors[(r * sz(shape.points) + i) * 3 + k] / 255.0;
        const auto z = net_in_double(shape.mlp, p, x);
        for (size_t j = 0; j < z.size(); ++j)
          if (z[j] > best[j]) best[j] = z[j], at[j] = static_cast<int32_t>(i);
      }
      for (const double z : best)
        out.push_back(shape.mlp.activation == Activation::kTanh  ? std::tanh(z)
                      : shape.mlp.activation == Activation::kElu ? (z < 0 ? std::expm1(z) : z)
                                                                 : std::max(0.0, z));
      if (won) won->insert(won->end(), at.begin(), at.end());
    }
    return out;
  }

  PointNetShape shape;
  int32_t rows;
  std::vector<float> params, metres;
  std::vector<int16_t> points;
  std::vector<uint8_t> classes, colors;
  Arena arena;
  PointNetScratch scratch;
  std::vector<float> y;
  std::vector<int32_t> winner;
};

const Case kCases[] = {{{8, 12}, 30, 0, 5},          {{7, 5, 9}, 100, 3, 4}, {{6}, 97, 0, 3},
                       {{64, 128}, 100, 0, 2},       {{5, 3}, 1, 0, 6},      {{33, 70}, 289, 2, 2},
                       {{4, 5, 6, 7, 8}, 13, 0, 70}, {{16, 1}, 50, 0, 2},    {{9, 6}, 40, 2, 3, true},
                       {{5, 7}, 33, 0, 4, true}};

double distance(const std::vector<float>& a, const std::vector<double>& b) {
  double top = 1e-9, gap = 0;  // of features that are all 0 the difference itself
  for (size_t i = 0; i < a.size(); ++i) {
    top = std::max(top, std::abs(b[i]));
    gap = std::max(gap, std::abs(static_cast<double>(a[i]) - b[i]));
  }
  return gap / top;
}

template <class Body>
void for_each_case(Body&& body) {
  for (const Activation a : {Activation::kTanh, Activation::kElu, Activation::kRelu})
    for (Case c : kCases) {
      c.activation = a;
      SCOPED_TRACE("features " + std::to_string(c.widths.back()) + " points " + std::to_string(c.points) +
                   " activation " + std::to_string(static_cast<int>(a)));
      body(c);
    }
}

}  // namespace

TEST(PointNet, ForwardBackwardAndTangentAgreeWithDoubleDifferences) {
  for_each_case([](const Case& c) {
    Eyes e(c);
    const size_t n = e.params.size();
    const auto dy = random_floats(e.y.size(), 2), v = random_floats(n, 3);
    const std::vector<double> p(e.params.begin(), e.params.end());
    std::vector<int32_t> won;
    const auto value = e.in_double(p, &won);
    const auto loss = [&](const std::vector<double>& q) {
      const auto z = e.in_double(q);
      double sum = 0;
      for (size_t i = 0; i < z.size(); ++i) sum += z[i] * static_cast<double>(dy[i]);
      return sum;
    };
    const double h = 1e-7;
    // Of large networks every 397th parameter.
    const size_t step = n > 2000 ? 397 : 1;
    std::vector<double> slopes, along = p, against = p;
    for (size_t i = 0; i < n; i += step) {
      auto q = p;
      q[i] = p[i] + h;
      const double up = loss(q);
      q[i] = p[i] - h;
      slopes.push_back((up - loss(q)) / (2 * h));
    }
    for (size_t i = 0; i < n; ++i) {
      along[i] += h * static_cast<double>(v[i]), against[i] -= h * static_cast<double>(v[i]);
    }
    auto tangent = e.in_double(along);
    const auto behind = e.in_double(against);
    for (size_t i = 0; i < tangent.size(); ++i) tangent[i] = (tangent[i] - behind[i]) / (2 * h);
    for_each_isa([&](const char* isa) {
      SCOPED_TRACE(isa);
      e.forward();
      EXPECT_LT(distance(e.y, value), 2e-6);
      EXPECT_EQ(e.winner, won);
      const auto grad = e.backward(dy);
      std::vector<float> some;
      for (size_t i = 0; i < n; i += step) some.push_back(grad[i]);
      EXPECT_LT(distance(some, slopes), 2e-5);
      EXPECT_LT(distance(e.tangent(v), tangent), 2e-5);
    });
  });
}

// u'(J v) = v'(J'u)
TEST(PointNet, TangentAndBackwardAreTransposed) {
  for_each_case([](const Case& c) {
    Eyes e(c);
    e.forward();
    const auto u = random_floats(e.y.size(), 8), v = random_floats(e.params.size(), 9);
    const auto jv = e.tangent(v), jtu = e.backward(u);
    double left = 0, right = 0, size = 1e-3;
    for (size_t i = 0; i < u.size(); ++i) {
      left += static_cast<double>(jv[i]) * static_cast<double>(u[i]);
      size += std::abs(static_cast<double>(jv[i]) * static_cast<double>(u[i]));
    }
    for (size_t i = 0; i < v.size(); ++i) right += static_cast<double>(jtu[i]) * static_cast<double>(v[i]);
    EXPECT_NEAR(left, right, 1e-5 * size);
  });
}

TEST(PointNet, AnyOrderAndRepeatsOfPointsGiveTheSameBytes) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for_each_case([](const Case& c) {
      Eyes e(c);
      e.forward();
      const auto y = e.y;
      const auto winner = e.winner;
      const auto dy = random_floats(y.size(), 4);
      const auto grad = e.backward(dy);
      const size_t points = sz(c.points);
      std::vector<size_t> order(points);
      std::iota(order.begin(), order.end(), size_t{0});
      Stream stream(3, 0, Purpose::kTest);
      for (size_t i = points - 1; i > 0; --i)
        std::swap(order[i], order[stream.below(static_cast<uint32_t>(i) + 1)]);
      const auto old = e.points;
      const auto old_classes = e.classes, old_colors = e.colors;
      for (size_t r = 0; r < sz(c.rows); ++r)
        for (size_t i = 0; i < points; ++i) {
          std::copy_n(&old[3 * (r * points + order[i])], 3, &e.points[3 * (r * points + i)]);
          e.classes[r * points + i] = old_classes[r * points + order[i]];
          std::copy_n(&old_colors[3 * (r * points + order[i])], 3, &e.colors[3 * (r * points + i)]);
        }
      e.forward();
      EXPECT_EQ(e.y, y);
      // Where relu has left nothing of several points, the first of them wins.
      for (size_t i = 0; i < winner.size() && c.activation != Activation::kRelu; ++i)
        EXPECT_EQ(static_cast<int32_t>(order[sz(e.winner[i])]), winner[i]) << "another point";
      EXPECT_EQ(e.backward(dy), grad);

      Case twice = c;
      twice.points = 2 * c.points + 1;
      Eyes t(twice);
      ASSERT_EQ(t.params, e.params);
      for (size_t r = 0; r < sz(c.rows); ++r)
        for (size_t i = 0; i < sz(twice.points); ++i) {
          std::copy_n(&old[3 * (r * points + i % points)], 3, &t.points[3 * (r * sz(twice.points) + i)]);
          t.classes[r * sz(twice.points) + i] = old_classes[r * points + i % points];
          std::copy_n(&old_colors[3 * (r * points + i % points)], 3,
                      &t.colors[3 * (r * sz(twice.points) + i)]);
        }
      t.forward();
      EXPECT_EQ(t.y, y);
      EXPECT_EQ(t.winner, winner) << "of equal points the first";
      EXPECT_EQ(t.backward(dy), grad);
    });
  });
}

TEST(PointNet, MetresAndMillimetresAreTheSameBytes) {
  Eyes e({{16, 24}, 130, 2, 7});
  e.forward();
  const auto y = e.y;
  PointRows clouds = e.clouds();
  clouds.points = nullptr, clouds.metres = e.metres.data();
  pointnet_forward(e.shape, e.params.data(), clouds, e.rows, e.scratch, e.y.data(), e.features(), nullptr);
  EXPECT_EQ(e.y, y);
  const float edge[] = {0.1f + 40, -1e30f, -0.5f + 0.0014f};
  int16_t q[3];
  quantize_points(e.shape, edge, 1, q);
  EXPECT_EQ(q[0], 32767);
  EXPECT_EQ(q[1], -32767);
  EXPECT_EQ(q[2], 1);
}

// A row's features and winners depend on nothing but its cloud; listed rows are the rows that they name.
TEST(PointNet, ListedRowsAreTheRowsThatTheyName) {
  Eyes e({{16, 24}, 130, 2, 9});
  e.forward();
  const int32_t order[] = {8, 99, 2, 99, 5};
  PointRows clouds = e.clouds();
  clouds.order = order, clouds.stride = 2;
  const size_t step = 31;
  std::vector<float> y(3 * step, -7);
  pointnet_forward(e.shape, e.params.data(), clouds, 3, e.scratch, y.data(), step, nullptr);
  const size_t rows[] = {8, 2, 5};
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(0, std::memcmp(&y[i * step], &e.y[rows[i] * 24], 24 * sizeof(float)));
    EXPECT_EQ(y[i * step + 24], -7) << "written past the features";
  }
}

TEST(PointNet, EachInstructionSetIsDeterministicAndAllAgree) {
  Eyes e({{64, 128}, 512, 0, 20, false, Activation::kRelu});
  const auto dy = random_floats(e.y.size(), 5);
  std::vector<double> first_y, first_grad;
  std::vector<float> v3_y, v3_grad;
  for_each_isa([&](const char* isa) {
    SCOPED_TRACE(isa);
    e.forward();
    const auto y = e.y;
    const auto grad = e.backward(dy);
    e.forward();
    EXPECT_EQ(e.y, y);
    EXPECT_EQ(e.backward(dy), grad);
    if (first_y.empty()) {
      first_y.assign(y.begin(), y.end());
      first_grad.assign(grad.begin(), grad.end());
    }
    EXPECT_LT(distance(y, first_y), 1e-5);
    EXPECT_LT(distance(grad, first_grad), 1e-3);  // a near tie may go to the other point
    if (std::strcmp(isa, kBaseIsa) == 0) return;
    if (!v3_y.empty()) {
      EXPECT_EQ(y, v3_y);
      EXPECT_EQ(grad, v3_grad);
    }
    v3_y = y, v3_grad = grad;
  });
}

TEST(PointNet, NothingIsAllocated) {
  if (!kHeapIsCounted) GTEST_SKIP() << "a sanitizer owns the heap";
  Eyes e({{16, 24}, 130, 2, 9});
  std::vector<float> dy(e.y.size(), 1), grad(e.params.size());
  const int64_t before = heap_count();
  e.forward();
  pointnet_backward(e.shape, e.params.data(), e.clouds(), e.rows, e.scratch, e.y.data(), e.features(),
                    e.winner.data(), dy.data(), grad.data());
  pointnet_tangent(e.shape, e.params.data(), grad.data(), e.clouds(), e.rows, e.scratch, e.y.data(),
                   e.features(), e.winner.data(), dy.data());
  EXPECT_EQ(heap_count(), before);
}

TEST(PointNet, ShapesOutsideTheBoundsAreErrors) {
  const auto thrown = [](auto&& change) {
    PointNetShape s;
    s.points = 10, s.classes = 2, s.mlp = make_shape(5, {4}, 6);
    EXPECT_NO_THROW(check_pointnet_shape(s));
    change(s);
    try {
      check_pointnet_shape(s);
    } catch (const Error& e) {
      return std::string(e.text);
    }
    return std::string();
  };
  EXPECT_EQ(thrown([](auto& s) { s.points = 0; }), "points: 0 is outside [1, 16384]");
  EXPECT_EQ(thrown([](auto& s) { s.points = kMaxPoints + 1; }), "points: 16385 is outside [1, 16384]");
  EXPECT_EQ(thrown([](auto& s) { s.classes = 65; }), "point classes: 65 is outside [0, 64]");
  EXPECT_EQ(thrown([](auto& s) { s.classes = 1; }), "encoder: it has 5 inputs, not 3 and 1 classes");
  EXPECT_EQ(thrown([](auto& s) { s.color = true; }),
            "encoder: it has 5 inputs, not 3 and 2 classes and 3 of a colour");
  EXPECT_EQ(thrown([](auto& s) { s.range = 0; }), "point range: 0 m is outside [0.001, 1000]");
  EXPECT_EQ(thrown([](auto& s) { s.origin[1] = NAN; }), "point origin: nan m is outside [-1e6, 1e6]");
  EXPECT_NE(thrown([](auto& s) { s.mlp.hidden[0] = 0; }), "");
}

// Features and gradient against torch's autograd: tests/oracle/pointnet.py makes the tables.
TEST(PointNet, AgreesWithTorch) {
  const auto wave = [](size_t i, size_t k) {
    const auto n = static_cast<long>((i * (2 * k + 3) * 37 + k * 101 + i * i * 11) % 129);
    return static_cast<float>(n - 64) / 64;
  };
  const auto check = [&](Activation activation, const auto& features, const auto& gradient) {
    Eyes e({{6, 7, 5}, 11, 2, 4, false, activation});
    float* at = e.params.data();
    for (int32_t l = 0; l < 3; ++l)
      for (const bool bias : {false, true}) {
        const size_t n = sz(e.shape.mlp.layer_out(l)) * (bias ? 1 : sz(e.shape.mlp.layer_in(l)));
        for (size_t i = 0; i < n; ++i) *at++ = wave(i, sz(2 * l) + bias);
      }
    for (size_t i = 0; i < e.points.size(); ++i)
      e.points[i] = static_cast<int16_t>(static_cast<long>((i * 7919 + i * i * 13) % 601) - 300);
    for (size_t i = 0; i < e.classes.size(); ++i) e.classes[i] = (i * 5 + i / 3) % 2;
    std::vector<float> dy(e.y.size());
    for (size_t i = 0; i < dy.size(); ++i) dy[i] = wave(i, 9);
    for_each_isa([&](const char* isa) {
      SCOPED_TRACE(isa);
      e.forward();
      EXPECT_LT(distance(e.y, {std::begin(features), std::end(features)}), 2e-6);
      EXPECT_LT(distance(e.backward(dy), {std::begin(gradient), std::end(gradient)}), 1e-5);
    });
  };
  check(Activation::kTanh, kPointFeaturesTanh, kPointGradientTanh);
  check(Activation::kElu, kPointFeaturesElu, kPointGradientElu);
  check(Activation::kRelu, kPointFeaturesRelu, kPointGradientRelu);
}
