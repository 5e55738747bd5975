#include <gtest/gtest.h>

#include <vector>

#include "nn/novelty.hpp"

using namespace rdm;

namespace {

// Of z as they are.
Novelty of(const std::vector<float>& z) {
  const std::vector<float> shift(z.size()), scale(z.size(), 1.0f);
  return novelty_of({z.data(), shift.data(), scale.data()}, static_cast<int32_t>(z.size()));
}

}  // namespace

TEST(Novelty, IsRootMeanSquareAndLargest) {
  for (const size_t count : {1, 7, 8, 9, 16, 398}) {
    std::vector<float> z(count);
    for (size_t j = 0; j < count; ++j) z[j] = static_cast<float>(j % 5) - 2.5f;
    z[count - 1] = -7;
    double sum = 0;
    for (const float x : z) sum += static_cast<double>(x) * static_cast<double>(x);
    const Novelty n = of(z);
    EXPECT_NEAR(n.rms, std::sqrt(sum / static_cast<double>(count)), 1e-5) << count;
    EXPECT_EQ(n.largest, 7) << count;
  }
}

TEST(Novelty, IsOfTheEntriesThatAreSeen) {
  std::vector<float> row(40), shift(40), scale(40), seen_shift, seen_scale, z;
  std::vector<int32_t> columns;
  for (size_t j = 0; j < 40; ++j) {
    row[j] = static_cast<float>(j) * 0.25f, shift[j] = static_cast<float>(j % 7) * 0.5f;
    scale[j] = j % 2 ? 2 : 0.5f;
    if (j % 3 == 0) continue;
    columns.push_back(static_cast<int32_t>(j));
    seen_shift.push_back(shift[j]), seen_scale.push_back(scale[j]);
    z.push_back((row[j] - shift[j]) * scale[j]);
  }
  const auto count = static_cast<int32_t>(columns.size());
  const Novelty wanted = of(z);
  const Novelty whole = novelty_of({row.data(), shift.data(), scale.data(), columns.data(), true}, count);
  const Novelty compact =
      novelty_of({row.data(), seen_shift.data(), seen_scale.data(), columns.data()}, count);
  for (const Novelty& n : {whole, compact}) {
    EXPECT_EQ(n.rms, wanted.rms);
    EXPECT_EQ(n.largest, wanted.largest);
  }
}

TEST(Novelty, IsScaledByWhatIsUsual) {
  EXPECT_EQ(scaled({1, 6}, {2, 4}), 1.5f);
  EXPECT_EQ(scaled({3, 1}, {2, 4}), 1.5f);
  EXPECT_EQ(scaled(of({1e30f, 1}), {1, 1}), std::numeric_limits<float>::max())
      << "what overflows is the most";
}
