#include <gtest/gtest.h>

#include <cstring>

#include "base/hash.hpp"
#include "nn/kernels.hpp"
#include "nn_data.hpp"

using namespace rdm;

namespace {

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}

// Error in units in the last place of the exact value's float.
double ulps(float got, double want) {
  const float w = static_cast<float>(std::abs(want));
  const double unit = static_cast<double>(std::nextafter(w, INFINITY)) - static_cast<double>(w);
  return std::abs(static_cast<double>(got) - want) / unit;
}

std::vector<float> grid(double low, double high) {
  std::vector<float> x;
  for (int i = 0; i <= 400000; ++i) x.push_back(static_cast<float>(low + (high - low) * i / 400000));
  for (double s = 1e-30; s < std::min(-low, high); s *= 1.001) {
    x.push_back(static_cast<float>(s));
    x.push_back(static_cast<float>(-s));
  }
  return x;
}

struct Layout {
  bool a_columns, b_columns;
};

void check_product(int32_t m, int32_t n, int32_t k, Layout layout, bool add, bool finish) {
  SCOPED_TRACE(std::to_string(m) + " x " + std::to_string(n) + " x " + std::to_string(k));
  const auto a = random_floats(sz(m) * sz(k), 1), b = random_floats(sz(k) * sz(n), 2),
             bias = random_floats(sz(n), 3), h = random_floats(sz(m) * sz(n), 4, 0.5f);
  const size_t size = sz(m) * sz(n), room = gemm_pack_floats(n, k);
  std::vector<float> c = random_floats(size + 16, 5), packed(room + 16, 7);
  const auto before = c;
  GemmArgs g;
  g.m = m, g.n = n, g.k = k;
  g.a = a.data(), g.a_row = layout.a_columns ? 1 : sz(k), g.a_col = layout.a_columns ? sz(m) : 1;
  g.b = b.data(), g.b_row = layout.b_columns ? 1 : sz(n), g.b_col = layout.b_columns ? sz(k) : 1;
  g.c = c.data(), g.add = add, g.packed = packed.data();
  if (finish) g.bias = bias.data(), g.slope_of = h.data();
  kernels().gemm(g);
  double worst = 0;
  for (size_t i = 0; i < sz(m); ++i)
    for (size_t j = 0; j < sz(n); ++j) {
      double sum = add ? static_cast<double>(before[i * sz(n) + j]) : 0;
      for (size_t p = 0; p < sz(k); ++p)
        sum += static_cast<double>(a[i * g.a_row + p * g.a_col]) *
               static_cast<double>(b[p * g.b_row + j * g.b_col]);
      const auto t = static_cast<double>(h[i * sz(n) + j]);
      if (finish) sum = (sum + static_cast<double>(bias[j])) * (1 - t * t);
      worst = std::max(worst, std::abs(static_cast<double>(c[i * sz(n) + j]) - sum));
    }
  EXPECT_LT(worst, 1e-6 * k + 1e-5);
  EXPECT_EQ(std::memcmp(c.data() + size, before.data() + size, 16 * sizeof(float)), 0) << "written past C";
  for (size_t i = room; i < packed.size(); ++i) EXPECT_EQ(packed[i], 7) << "written past the packed panels";
}

// A hash over what the table in force makes of a fixed input.
uint64_t bytes_of_all() {
  const int32_t m = 37, n = 53, k = 211, actions = 20;
  const auto a = random_floats(sz(m) * sz(k), 1), b = random_floats(sz(k) * sz(n), 2),
             bias = random_floats(sz(n), 3), log_std = random_floats(sz(actions), 4);
  uint64_t h = kHashSeed;
  const auto join = [&h](const auto& v) { h = hash_bytes(v.data(), v.size() * sizeof v[0], h); };
  const Kernels& t = kernels();
  std::vector<float> c(sz(m) * sz(n)), packed(gemm_pack_floats(n, k)), y(a.size());
  GemmArgs g;
  g.m = m, g.n = n, g.k = k, g.a = a.data(), g.a_row = sz(k), g.a_col = 1, g.b = b.data(), g.b_row = sz(n);
  g.b_col = 1, g.c = c.data(), g.bias = bias.data(), g.activate = true, g.packed = packed.data();
  t.gemm(g);
  join(c);
  for (const auto map : {t.map_tanh, t.map_elu, t.map_exp}) {
    map(a.data(), a.size(), y.data());
    join(y);
  }
  std::vector<float> p = bias, first(sz(n), 0.1f), second(sz(n), 0.2f);
  t.adam({sz(n), p.data(), first.data(), second.data(), b.data(), 0.5f, 0.01f, 3});
  join(p);
  std::vector<float> sums = {static_cast<float>(t.sum_squares(a.data(), a.size()))};
  for (size_t i = 0; i < sz(m); ++i) {
    const float *x = a.data() + i * sz(actions), *z = b.data() + i * sz(actions);
    sums.push_back(t.log_prob(x, log_std.data(), z, actions));
    sums.push_back(t.kl(x, log_std.data(), z, bias.data(), actions));
  }
  join(sums);
  return h;
}

}  // namespace

TEST(Kernels, ProductsOfEverySizeAndLayout) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const Layout layout : {Layout{false, false}, Layout{false, true}, Layout{true, false}}) {
      SCOPED_TRACE(std::to_string(layout.a_columns) + std::to_string(layout.b_columns));
      for (const int32_t m : {1, 2, 3, 4, 5, 6, 7, 11, 12})
        for (int32_t n = 1; n <= 70; n += n < 20 ? 1 : 5)
          for (const int32_t k : {1, 3, 8, 19}) check_product(m, n, k, layout, m % 2 == 0, k % 2 == 1);
      check_product(5, 530, 300, layout, true, true);
      check_product(1, 1025, 513, layout, false, true);
      check_product(13, 3, 700, layout, true, false);
      check_product(64, 398, 1024, layout, false, false);
    }
  });
}

TEST(Kernels, TanhIsRightToAFewUnits) {
  const auto x = grid(-12, 12);
  for_each_isa([&](const char* isa) {
    SCOPED_TRACE(isa);
    std::vector<float> y(x.size());
    kernels().map_tanh(x.data(), x.size(), y.data());
    double worst = 0;
    for (size_t i = 0; i < x.size(); ++i) {
      worst = std::max(worst, ulps(y[i], std::tanh(static_cast<double>(x[i]))));
      ASSERT_LE(std::abs(y[i]), 1);
    }
    EXPECT_LT(worst, 7);
    const float edges[] = {INFINITY, -INFINITY, 0, 1e30f, NAN};
    kernels().map_tanh(edges, 5, y.data());
    EXPECT_NEAR(y[0], 1, 5e-7);
    EXPECT_NEAR(y[1], -1, 5e-7);
    EXPECT_EQ(y[2], 0);
    EXPECT_NEAR(y[3], 1, 5e-7);
    EXPECT_TRUE(std::isnan(y[4]));
  });
}

TEST(Kernels, EluIsRightToAFewUnits) {
  const auto x = grid(-30, 5);
  for_each_isa([&](const char* isa) {
    SCOPED_TRACE(isa);
    std::vector<float> y(x.size());
    kernels().map_elu(x.data(), x.size(), y.data());
    double worst = 0;
    for (size_t i = 0; i < x.size(); ++i) {
      const auto z = static_cast<double>(x[i]);
      worst = std::max(worst, ulps(y[i], z > 0 ? z : std::expm1(z)));
      ASSERT_GE(y[i], -1);
    }
    EXPECT_LT(worst, 7);
  });
}

TEST(Kernels, ExpIsRightToAFewUnits) {
  const auto x = grid(-87, 87);
  for_each_isa([&](const char* isa) {
    SCOPED_TRACE(isa);
    std::vector<float> y(x.size());
    kernels().map_exp(x.data(), x.size(), y.data());
    double worst = 0;
    for (size_t i = 0; i < x.size(); ++i)
      worst = std::max(worst, ulps(y[i], std::exp(static_cast<double>(x[i]))));
    EXPECT_LT(worst, 3);
    const float edges[] = {0, -200, 200, NAN};
    kernels().map_exp(edges, 4, y.data());
    EXPECT_EQ(y[0], 1);
    EXPECT_LT(y[1], 2e-38f);
    EXPECT_GT(y[2], 5e37f);
    EXPECT_TRUE(std::isnan(y[3]));
  });
}

TEST(Kernels, SumsOfColumnsAndSquares) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const int32_t n : {1, 3, 4, 15, 16, 33, 64, 130}) {
      const int32_t rows = 37;
      const auto x = random_floats(sz(rows) * sz(n), 1);
      std::vector<float> sum(sz(n) + 1, 7);
      kernels().column_sums(x.data(), rows, n, sum.data());
      double squares = 0;
      for (size_t j = 0; j < sz(n); ++j) {
        double want = 0;
        for (size_t r = 0; r < sz(rows); ++r) {
          const auto v = static_cast<double>(x[r * sz(n) + j]);
          want += v, squares += v * v;
        }
        EXPECT_NEAR(sum[j], want, 1e-5);
      }
      EXPECT_EQ(sum[sz(n)], 7);
      EXPECT_NEAR(kernels().sum_squares(x.data(), x.size()), squares, 1e-13 * squares);
    }
  });
}

// Each set has its own number, the same on every processor, compiler and mathematics library.
TEST(Kernels, AnInstructionSetAlwaysGivesTheSameBytes) {
  for_each_isa([](const char* isa) {
    const uint64_t want = isa == std::string(kBaseIsa) ? 0x725b861ff5f662c0u
                          : isa == std::string(kV3Isa) ? 0xcd37037b1a06d979u
                                                       : 0xd39b51a1098e38bcu;
    EXPECT_EQ(bytes_of_all(), want) << isa;
  });
}

TEST(Kernels, TheInstructionSetCanBeLoweredAndNamesAreChecked) {
  const std::string best = kernel_isa();
  EXPECT_FALSE(set_kernel_isa("x86-64-v5"));
  EXPECT_FALSE(set_kernel_isa(""));
  EXPECT_EQ(kernel_isa(), best);
  EXPECT_TRUE(set_kernel_isa(kBaseIsa));
  EXPECT_STREQ(kernel_isa(), kBaseIsa);
  EXPECT_TRUE(set_kernel_isa(best.c_str()));
  EXPECT_EQ(kernel_isa(), best);
}

// What a PointNet needs, beside plain loops in double, for widths that leave lanes over.
TEST(Kernels, LargestOfRowsAndItsPlace) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const int32_t n : {1, 3, 4, 7, 8, 16, 19, 33, 64, 70, 128, 131})
      for (const int32_t rows : {1, 2, 9}) {
        auto z = random_floats(sz(n) * sz(rows), 6);
        if (rows == 9) std::copy_n(z.begin(), n, z.begin() + 4 * n);  // the fifth row is as the first
        std::vector<float> best(sz(n) + 8, -0.5f), at(sz(n) + 8, -1);
        kernels().max_rows(z.data(), rows, n, 100, best.data(), at.data());
        for (size_t j = 0; j < best.size(); ++j) {
          float wanted = -0.5f, place = -1;
          for (size_t r = 0; j < sz(n) && r < sz(rows); ++r)
            if (z[r * sz(n) + j] > wanted) wanted = z[r * sz(n) + j], place = static_cast<float>(100 + r);
          EXPECT_EQ(best[j], wanted);
          EXPECT_EQ(at[j], place);
        }
      }
  });
}

TEST(Kernels, SlotsAreSpreadAndGathered) {
  std::vector<float> v3;
  for_each_isa([&](const char* isa) {
    SCOPED_TRACE(isa);
    for (const int32_t k : {1, 3, 5, 8, 16, 21, 64}) {
      const int32_t n = 10, slots = 4;
      auto dz = random_floats(sz(n), 1);
      dz[3] = 0;
      const auto h = random_floats(sz(slots) * sz(k), 2), w = random_floats(sz(n) * sz(k), 3);
      const int32_t slot[] = {2, 0, 2, -1, 3, 3, 1, 0, 2, 1};  // none where dz is 0
      const int32_t all[] = {2, 0, 2, 0, 3, 3, 1, 0, 2, 1};
      std::vector<float> dw(sz(n) * sz(k) + 8, 0.5f), dh(sz(slots) * sz(k) + 8, 0.25f), y(sz(n), 0.125f);
      kernels().spread_slots(dz.data(), slot, n, k, h.data(), w.data(), dw.data(), dh.data());
      kernels().dot_slots(all, n, k, h.data(), w.data(), y.data());
      std::vector<double> want_dw(dw.size(), 0.5), want_dh(dh.size(), 0.25), want_y(sz(n), 0.125);
      for (size_t j = 0; j < sz(n); ++j)
        for (size_t i = 0; i < sz(k); ++i) {
          const double d = static_cast<double>(dz[j]), from = static_cast<double>(h[sz(all[j]) * sz(k) + i]);
          want_dw[j * sz(k) + i] += d * from;
          want_dh[sz(all[j]) * sz(k) + i] += d * static_cast<double>(w[j * sz(k) + i]);
          want_y[j] += from * static_cast<double>(w[j * sz(k) + i]);
        }
      for (size_t i = 0; i < dw.size(); ++i) EXPECT_NEAR(static_cast<double>(dw[i]), want_dw[i], 1e-6);
      for (size_t i = 0; i < dh.size(); ++i) EXPECT_NEAR(static_cast<double>(dh[i]), want_dh[i], 2e-6);
      for (size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(static_cast<double>(y[i]), want_y[i], 1e-5);
      auto again = std::vector<float>(dw.size(), 0.5f);
      kernels().spread_slots(dz.data(), slot, n, k, h.data(), w.data(), again.data(), nullptr);
      EXPECT_EQ(again, dw) << "without the other half";
      if (k != 21 || std::strcmp(isa, kBaseIsa) == 0) continue;
      if (v3.empty()) v3 = dw;
      EXPECT_EQ(dw, v3) << "v3 and v4 agree";
    }
  });
}

TEST(Kernels, ActivationsAndSlopesInPlace) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const Activation a : {Activation::kTanh, Activation::kElu, Activation::kRelu})
      for (const size_t n : {1, 5, 16, 37}) {
        const auto z = random_floats(n, 7, 2);
        auto h = z, d = random_floats(n, 8);
        const auto before = d;
        kernels().activate(a, h.data(), n);
        kernels().slope(a, h.data(), n, d.data());
        for (size_t i = 0; i < n; ++i) {
          const auto x = static_cast<double>(z[i]), t = std::tanh(x);
          const double value = a == Activation::kTanh  ? t
                               : a == Activation::kElu ? (x < 0 ? std::expm1(x) : x)
                                                       : std::max(0.0, x);
          const double slope = a == Activation::kTanh  ? 1 - t * t
                               : a == Activation::kElu ? (x < 0 ? std::exp(x) : 1)
                                                       : x > 0;
          EXPECT_NEAR(static_cast<double>(h[i]), value, 1e-6);
          EXPECT_NEAR(static_cast<double>(d[i]), static_cast<double>(before[i]) * slope, 5e-6);
        }
      }
  });
}
