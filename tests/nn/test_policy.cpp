#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <memory>
#include <thread>

#include "base/error.hpp"
#include "heap_count.hpp"
#include "nn/policy.hpp"
#include "nn_data.hpp"

using namespace rdm;

namespace {

using Bytes = std::vector<unsigned char>;

struct Made {
  // state: the second half of the outputs are log deviations within [-0.1, 0.15].
  explicit Made(const MlpShape& shape, float clip = 5, bool state = false) {
    const auto in = static_cast<size_t>(shape.in), out = static_cast<size_t>(shape.out);
    params.resize(shape.num_params());
    Stream stream(1, 0, Purpose::kInit);
    mlp_init(shape, stream, 1, params.data());
    log_std = random_floats(out, 2, 0.5f);
    shift = random_floats(in, 3);
    scale = random_floats(in, 4);
    for (float& s : scale) s = 0.5f + std::abs(s);
    obs = random_floats(in, 5);
    view.actor = shape;
    view.params = params.data();
    view.state_std = state;
    if (state)
      view.std_bounds[0] = -0.1f, view.std_bounds[1] = 0.15f;
    else
      view.log_std = log_std.data();
    view.clip = clip;
    if (clip > 0) view.shift = shift.data(), view.scale = scale.data(), view.usual = {1.5f, 6};
    view.action_repeat = 2;
    view.noise_correlation = 0.25f;
    view.control_dt = 1.0f / 60;
    view.layout_hash = 0x0123456789abcdefull;
    view.generation = 77;
    std::strcpy(view.task, "egg_catch");
    view.example_obs = obs.data();
    fields = {{"first", 0, 1, "rad"}, {"again", 0, 1, ""}};
    view.fields = fields.data();
    view.num_fields = 2;
  }
  Bytes bytes() const {
    Writer measure(nullptr, 0);
    write_policy(measure, view);
    Bytes b(measure.size());
    Writer out(b.data(), b.size());
    write_policy(out, view);
    EXPECT_TRUE(out.fits());
    return b;
  }
  std::vector<float> params, log_std, shift, scale, obs;
  std::vector<ObsField> fields;
  PolicyView view;
};

using Owned = std::unique_ptr<Policy, void (*)(Policy*)>;
Owned read(const Bytes& b, const HostHooks& hooks = {}) {
  return Owned(Policy::read(b.data(), b.size(), hooks), Policy::destroy);
}

std::vector<float> act(const Policy& p, const float* obs, int32_t rows, const float* noise) {
  std::vector<float> action(static_cast<size_t>(rows * p.view().action_dim()), 9);
  const size_t size = p.scratch_bytes(rows);
  auto* scratch = static_cast<unsigned char*>(std::aligned_alloc(64, (size + 127) / 64 * 64));
  std::memset(scratch, 0xA5, size + 64);
  p.act(obs, rows, noise, action.data(), scratch);
  for (size_t i = size; i < size + 64; ++i) EXPECT_EQ(scratch[i], 0xA5) << "written past the scratch";
  std::free(scratch);
  return action;
}

// The payload of a section, to be changed; seal() then makes its checksum right again.
unsigned char* section(Bytes& b, const char* tag, size_t* size = nullptr) {
  for (size_t p = 24; p < b.size();) {
    uint64_t n;
    std::memcpy(&n, &b[p + 8], 8);
    if (std::memcmp(&b[p], tag, 4) == 0) {
      if (size) *size = n;
      return &b[p + 16];
    }
    p += 16 + n;
  }
  return nullptr;
}
void seal(Bytes& b) {
  for (size_t p = 24; p < b.size();) {
    uint64_t n;
    std::memcpy(&n, &b[p + 8], 8);
    const uint32_t crc = crc32(&b[p + 16], n);
    std::memcpy(&b[p + 4], &crc, 4);
    p += 16 + n;
  }
}

Code code_of(const Bytes& b, const HostHooks& hooks = {}) {
  return guard([&] { read(b, hooks); });
}

template <class T>
void put(unsigned char* at, T v) {
  std::memcpy(at, &v, sizeof v);
}

}  // namespace

TEST(Policy, RoundTripKeepsEverything) {
  const Made made(make_shape(21, {16, 8}, 5, Activation::kElu));
  const Bytes b = made.bytes();
  const Owned p = read(b);
  const PolicyView& v = p->view();
  EXPECT_EQ(v.actor.in, 21);
  EXPECT_EQ(v.actor.out, 5);
  EXPECT_EQ(v.actor.num_hidden, 2);
  EXPECT_EQ(v.actor.hidden[0], 16);
  EXPECT_EQ(v.actor.hidden[1], 8);
  EXPECT_EQ(v.actor.activation, Activation::kElu);
  EXPECT_EQ(std::memcmp(v.params, made.params.data(), made.params.size() * 4), 0);
  EXPECT_EQ(std::memcmp(v.log_std, made.log_std.data(), 20), 0);
  EXPECT_EQ(std::memcmp(v.shift, made.shift.data(), 84), 0);
  EXPECT_EQ(std::memcmp(v.scale, made.scale.data(), 84), 0);
  EXPECT_EQ(v.clip, 5);
  EXPECT_EQ(v.action_repeat, 2);
  EXPECT_EQ(v.noise_correlation, 0.25f);
  EXPECT_EQ(v.control_dt, 1.0f / 60);
  EXPECT_EQ(v.layout_hash, 0x0123456789abcdefull);
  EXPECT_EQ(v.generation, 77u);
  EXPECT_EQ(v.usual.rms, 1.5f);
  EXPECT_EQ(v.usual.largest, 6);
  EXPECT_STREQ(v.task, "egg_catch");
  ASSERT_EQ(v.num_fields, 2);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_STREQ(v.fields[i].name, made.fields[i].name);
    EXPECT_STREQ(v.fields[i].unit, made.fields[i].unit);
    EXPECT_EQ(v.fields[i].offset, made.fields[i].offset);
    EXPECT_EQ(v.fields[i].count, made.fields[i].count);
  }
  EXPECT_EQ(std::memcmp(v.example_obs, made.obs.data(), 84), 0);
  const auto action = act(*p, v.example_obs, 1, nullptr);
  EXPECT_EQ(std::memcmp(v.example_action, action.data(), 20), 0);
  Writer again(nullptr, 0);
  write_policy(again, v);
  Bytes copy(again.size());
  Writer out(copy.data(), copy.size());
  write_policy(out, v);
  EXPECT_EQ(copy, b);
}

TEST(Policy, ActIsTheNormalisedNetPlusNoiseClipped) {
  for (const float clip : {0.0f, 1.5f})
    for_each_isa([&](const char* isa) {
      SCOPED_TRACE(isa);
      const Made made(make_shape(19, {24, 12}, 7), clip);
      const Owned p = read(made.bytes());
      const int32_t rows = 300;
      const auto obs = random_floats(rows * 19, 6, 2), noise = random_floats(rows * 7, 7, 0.7f);
      const auto mean = act(*p, obs.data(), rows, nullptr), action = act(*p, obs.data(), rows, noise.data());
      const std::vector<double> params(made.params.begin(), made.params.end());
      int clipped = 0;
      for (size_t r = 0; r < rows; ++r) {
        std::vector<double> x;
        for (size_t j = 0; j < 19; ++j) {
          auto u = static_cast<double>(obs[r * 19 + j]);
          if (clip > 0)
            u = std::clamp((u - static_cast<double>(made.shift[j])) * static_cast<double>(made.scale[j]),
                           -1.5, 1.5);
          x.push_back(u);
        }
        const auto y = net_in_double(made.view.actor, params, x);
        for (size_t j = 0; j < 7; ++j) {
          const double e = static_cast<double>(noise[r * 7 + j]),
                       s = std::exp(static_cast<double>(made.log_std[j]));
          EXPECT_NEAR(mean[r * 7 + j], std::clamp(y[j], -1.0, 1.0), 3e-6);
          EXPECT_NEAR(action[r * 7 + j], std::clamp(y[j] + s * e, -1.0, 1.0), 3e-6);
          clipped += std::abs(action[r * 7 + j]) == 1;
        }
      }
      EXPECT_GT(clipped, 50);
    });
}

TEST(Policy, DeviationsOfTheStateAreTheNetsWithinBounds) {
  const Made made(make_shape(19, {33, 20}, 14), 5, true);
  const Owned p = read(made.bytes());
  EXPECT_EQ(p->view().action_dim(), 7);
  EXPECT_EQ(p->view().log_std, nullptr);
  const int32_t rows = 150;  // more than a chunk
  const auto obs = random_floats(150 * 19, 6), noise = random_floats(150 * 7, 7);
  const auto mean = act(*p, obs.data(), rows, nullptr), action = act(*p, obs.data(), rows, noise.data());
  const std::vector<double> params(made.params.begin(), made.params.end());
  int low = 0, high = 0, inside = 0;
  for (size_t r = 0; r < 150; ++r) {
    std::vector<double> x;
    for (size_t j = 0; j < 19; ++j)
      x.push_back(
          std::clamp(static_cast<double>((obs[r * 19 + j] - made.shift[j]) * made.scale[j]), -5., 5.));
    const auto y = net_in_double(made.view.actor, params, x);
    for (size_t j = 0; j < 7; ++j) {
      const double l = std::clamp(y[7 + j], -0.1, 0.15), e = static_cast<double>(noise[r * 7 + j]);
      EXPECT_NEAR(mean[r * 7 + j], std::clamp(y[j], -1.0, 1.0), 3e-6);
      EXPECT_NEAR(action[r * 7 + j], std::clamp(y[j] + std::exp(l) * e, -1.0, 1.0), 6e-6);
      low += l == -0.1, high += l == 0.15, inside += l > -0.1 && l < 0.15;
    }
  }
  EXPECT_GT(std::min({low, high, inside}), 10);
}

TEST(Policy, OnlyDeviationsOfTheStateNeedTheNewVersion) {
  const Bytes plain = Made(make_shape(3, {2}, 2)).bytes(),
              state = Made(make_shape(3, {2}, 2), 5, true).bytes();
  EXPECT_EQ(plain[8], 1);
  EXPECT_EQ(state[8], 2);
  const auto with = [&](float low, float high) {
    Bytes forged = state;
    put(section(forged, "HEAD"), low);
    put(section(forged, "HEAD") + 4, high);
    seal(forged);
    return code_of(forged);
  };
  EXPECT_EQ(with(-1, 0), Code::kOk);
  EXPECT_EQ(with(1, 0), Code::kFormat);
  EXPECT_EQ(with(NAN, 0), Code::kFormat);
  EXPECT_EQ(with(-1, 1000), Code::kFormat);
  Bytes older = state;
  older[8] = 1;
  EXPECT_EQ(code_of(older), Code::kFormat);
  EXPECT_EQ(code_of(Made(make_shape(3, {2}, 3), 5, true).bytes()), Code::kFormat);
}

// Of a row of 9 entries the policy sees 1, 2, 3, 5 and 8.
TEST(Policy, APartOfTheRowNeedsTheNewestVersion) {
  constexpr int32_t kColumns[] = {1, 2, 3, 5, 8};
  for (const bool state : {false, true}) {
    Made made(make_shape(5, {4}, 2), 5, state), plain(make_shape(5, {4}, 2), 5, state);
    made.view.columns = kColumns;
    made.view.row_dim = 9;
    const std::vector<float> row = random_floats(9, 11);
    made.view.example_obs = row.data();
    const Bytes b = made.bytes();
    EXPECT_EQ(b[8], 3);
    const Owned p = read(b);
    ASSERT_EQ(p->view().obs_dim(), 9);
    EXPECT_EQ(std::memcmp(p->view().columns, kColumns, sizeof kColumns), 0);
    EXPECT_EQ(std::memcmp(p->view().example_obs, row.data(), 36), 0);
    Writer again(nullptr, 0);
    write_policy(again, p->view());
    EXPECT_EQ(again.size(), b.size());
    // as the policy that gets these entries alone
    const Owned narrow = read(plain.bytes());
    const std::vector<float> rows = random_floats(300 * 9, 12);
    std::vector<float> seen;
    for (size_t r = 0; r < 300; ++r)
      for (const int32_t c : kColumns) seen.push_back(rows[r * 9 + static_cast<size_t>(c)]);
    EXPECT_EQ(act(*p, rows.data(), 300, nullptr), act(*narrow, seen.data(), 300, nullptr));
  }
}

TEST(Policy, RangesOfEntriesThatAreNone) {
  constexpr int32_t kColumns[] = {1, 2, 3, 5, 8};
  Made made(make_shape(5, {4}, 2));
  made.view.columns = kColumns;
  made.view.row_dim = 9;
  made.obs = random_floats(9, 11);
  made.view.example_obs = made.obs.data();
  const Bytes b = made.bytes();
  // entries of a row, ranges, then begin and end of each: [1, 4) [5, 6) [8, 9)
  struct Case {
    int at;
    int32_t value;
  };
  for (const Case& c :
       {Case{0, 8}, {0, 5}, {0, 0}, {0, -1}, {0, 65537}, {1, 0}, {1, -1}, {1, 2}, {1, 4},  {1, 6}, {2, -1},
        {2, 0},     {2, 4}, {3, 1}, {3, 3},  {4, 4},     {4, 6}, {4, 2},  {5, 8}, {7, 10}, {7, 8}}) {
    Bytes bad = b;
    size_t size = 0;
    unsigned char* at = section(bad, "COLS", &size);
    ASSERT_EQ(size, 8u * 4);
    put(at + 4 * c.at, c.value);
    seal(bad);
    EXPECT_EQ(code_of(bad), Code::kFormat) << c.at << ' ' << c.value;
  }
  for (size_t i = 0; i < b.size() * 8; ++i) {
    Bytes flipped = b;
    flipped[i / 8] = static_cast<unsigned char>(flipped[i / 8] ^ (1u << (i % 8)));
    const Code code = code_of(flipped);
    EXPECT_TRUE(code == Code::kFormat || (code == Code::kVersion && i / 32 == 2)) << "bit " << i;
  }
}

TEST(Policy, ARowDoesNotDependOnItsBatch) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    const Made made(make_shape(398, {64, 64}, 40));
    const Owned p = read(made.bytes());
    const auto obs = random_floats(400 * 398, 8);
    const auto whole = act(*p, obs.data(), 400, nullptr);
    for (const size_t r : {0u, 1u, 77u, 127u, 128u, 399u}) {
      const auto one = act(*p, &obs[r * 398], 1, nullptr);
      EXPECT_EQ(std::memcmp(one.data(), &whole[r * 40], 160), 0) << "row " << r;
    }
  });
}

TEST(Policy, ScratchMayBeAlignedForFloatsOnly) {
  const Made made(make_shape(21, {16, 8}, 5));
  const Owned p = read(made.bytes());
  std::vector<float> scratch(p->scratch_bytes(3) / sizeof(float) + 16), action(15);
  const auto obs = random_floats(3 * 21, 8);
  const auto want = act(*p, obs.data(), 3, nullptr);
  for (size_t shift = 0; shift < 16; ++shift) {
    p->act(obs.data(), 3, nullptr, action.data(), &scratch[shift]);
    EXPECT_EQ(action, want);
  }
}

TEST(Policy, ThreadsMayShareOne) {
  const Made made(make_shape(50, {64, 64}, 10));
  const Owned p = read(made.bytes());
  const auto obs = random_floats(200 * 50, 8);
  const auto want = act(*p, obs.data(), 200, nullptr);
  std::vector<float> got[2];
  std::thread other([&] {
    for (int i = 0; i < 50; ++i) got[1] = act(*p, obs.data(), 200, nullptr);
  });
  for (int i = 0; i < 50; ++i) got[0] = act(*p, obs.data(), 200, nullptr);
  other.join();
  EXPECT_EQ(got[0], want);
  EXPECT_EQ(got[1], want);
}

TEST(Policy, ActAllocatesNothing) {
  if (!kHeapIsCounted) GTEST_SKIP() << "a sanitizer owns the heap";
  const Made made(make_shape(398, {64, 64}, 40));
  const Owned p = read(made.bytes());
  const auto obs = random_floats(200 * 398, 8);
  std::vector<float> action(200 * 40);
  const std::unique_ptr<void, void (*)(void*)> scratch(std::aligned_alloc(64, p->scratch_bytes(200)),
                                                       std::free);
  const int64_t before = heap_count();
  p->act(obs.data(), 200, obs.data(), action.data(), scratch.get());
  EXPECT_EQ(heap_count(), before);
}

TEST(Policy, ExamplesAreMadeWhenTheWriterHasNone) {
  Made made(make_shape(6, {4}, 2));
  made.view.example_obs = nullptr;
  const Owned p = read(made.bytes());
  const std::vector<float> zeros(6);
  EXPECT_EQ(std::memcmp(p->view().example_obs, zeros.data(), 24), 0);
  const auto action = act(*p, zeros.data(), 1, nullptr);
  EXPECT_EQ(std::memcmp(p->view().example_action, action.data(), 8), 0);
}

TEST(Policy, AnExampleThatTheNetDoesNotGiveIsAnError) {
  Made made(make_shape(6, {4}, 2));
  std::vector<float> action = act(*read(made.bytes()), made.obs.data(), 1, nullptr);
  made.view.example_action = action.data();
  EXPECT_EQ(code_of(made.bytes()), Code::kOk);
  action[1] += 5e-5f;
  EXPECT_EQ(code_of(made.bytes()), Code::kOk);
  action[1] += 2e-4f;
  EXPECT_EQ(code_of(made.bytes()), Code::kFormat);
}

TEST(Policy, EveryTruncationIsAnError) {
  const Bytes b = Made(make_shape(3, {2}, 1)).bytes();
  for (size_t n = 0; n < b.size(); ++n) {
    const Bytes cut(b.begin(), b.begin() + static_cast<long>(n));
    EXPECT_EQ(code_of(cut), Code::kFormat) << n;
  }
  Bytes longer = b;
  longer.push_back(0);
  EXPECT_EQ(code_of(longer), Code::kFormat);
}

TEST(Policy, EveryFlippedBitIsAnError) {
  const Bytes b = Made(make_shape(3, {2}, 1)).bytes();
  for (size_t i = 0; i < b.size() * 8; ++i) {
    Bytes flipped = b;
    flipped[i / 8] = static_cast<unsigned char>(flipped[i / 8] ^ (1u << (i % 8)));
    const Code code = code_of(flipped);
    EXPECT_TRUE(code == Code::kFormat || (code == Code::kVersion && i / 32 == 2)) << "bit " << i;
  }
}

// Bits flipped under a right checksum may give another policy, but never a crash (run with a sanitizer).
TEST(Policy, ForgedBytesAreAPolicyOrAnError) {
  const Bytes b = Made(make_shape(3, {2}, 2), 5, true).bytes();
  int errors = 0;
  for (const char* tag : {"META", "ARCH", "HEAD", "FLDS", "GENR", "SEEN", "WGTS", "NORM", "EXMP"}) {
    Bytes whole = b;
    size_t size = 0;
    section(whole, tag, &size);
    for (size_t i = 0; i < size * 8; ++i) {
      Bytes forged = b;
      unsigned char* at = section(forged, tag) + i / 8;
      *at = static_cast<unsigned char>(*at ^ (1u << (i % 8)));
      seal(forged);
      const Code code = code_of(forged);
      EXPECT_TRUE(code == Code::kOk || code == Code::kFormat) << tag << " bit " << i;
      errors += code == Code::kFormat;
    }
  }
  EXPECT_GT(errors, 300);
}

TEST(Policy, AbsurdSizesAreRefusedBeforeAnythingIsAllocated) {
  static int64_t allocations = 0;
  HostHooks hooks;
  hooks.alloc = [](void*, size_t bytes, size_t align) -> void* {
    ++allocations;
    return std::aligned_alloc(align, (bytes + align - 1) / align * align);
  };
  hooks.release = [](void*, void* p, size_t, size_t) { std::free(p); };
  const Bytes b = Made(make_shape(3, {2}, 1)).bytes();
  EXPECT_EQ(code_of(b, hooks), Code::kOk);
  EXPECT_GT(allocations, 0);
  allocations = 0;
  for (const int32_t n : {0, -1, 4, 4096, 65536, 1 << 30, INT32_MAX, INT32_MIN})
    for (size_t field = 0; field < 8; ++field) {
      Bytes forged = b;
      unsigned char* at = section(forged, "ARCH") + 4 * field;
      int32_t old;
      std::memcpy(&old, at, 4);
      if (old == n) continue;
      put(at, n);
      seal(forged);
      EXPECT_EQ(code_of(forged, hooks), Code::kFormat) << "field " << field << " = " << n;
    }
  EXPECT_EQ(allocations, 0);
}

TEST(Policy, ValuesOutOfRangeAreErrors) {
  const Bytes b = Made(make_shape(3, {2}, 1)).bytes();
  const auto with = [&](const char* tag, size_t at, auto v) {
    Bytes forged = b;
    put(section(forged, tag) + at, v);
    seal(forged);
    return code_of(forged);
  };
  EXPECT_EQ(with("META", 0, -1.0f), Code::kFormat);
  EXPECT_EQ(with("META", 0, NAN), Code::kFormat);
  EXPECT_EQ(with("META", 4, int32_t{0}), Code::kFormat);
  EXPECT_EQ(with("META", 8, 1.0f), Code::kFormat);
  EXPECT_EQ(with("META", 12, -INFINITY), Code::kFormat);
  EXPECT_EQ(with("META", 24, uint32_t{64}), Code::kFormat);          // length of the task's name
  EXPECT_EQ(with("META", 28, uint32_t{0x00670067}), Code::kFormat);  // a zero inside it
  EXPECT_EQ(with("WGTS", 0, NAN), Code::kFormat);
  EXPECT_EQ(with("NORM", 4, INFINITY), Code::kFormat);
  EXPECT_EQ(with("NORM", 12, 0.0f), Code::kFormat);  // a scale that is not positive
  EXPECT_EQ(with("EXMP", 0, NAN), Code::kFormat);
  for (const float x : {0.0f, -1.0f, 1e-7f, 1e31f, NAN, INFINITY})
    for (const size_t number : {0, 1}) EXPECT_EQ(with("SEEN", 4 + 4 * number, x), Code::kFormat) << x;
  EXPECT_EQ(with("META", 0, 0.0f), Code::kFormat) << "what is usual, and no normaliser";
  for (const int32_t n : {0, -1, 1, 3, 4097, INT32_MAX}) EXPECT_EQ(with("FLDS", 4, n), Code::kFormat) << n;
  for (const size_t field : {0, 1})
    for (const int32_t n : {-1, 4, INT32_MAX}) {
      EXPECT_EQ(with("FLDS", 8 + 8 * field, n), Code::kFormat) << "offset " << n;
      EXPECT_EQ(with("FLDS", 12 + 8 * field, n), Code::kFormat) << "count " << n;
    }
  EXPECT_EQ(with("FLDS", 24, uint8_t{'\n'}), Code::kFormat);  // of a name
  EXPECT_EQ(with("FLDS", 24, uint8_t{0}), Code::kFormat);     // an empty one, and a text too many
  EXPECT_EQ(with("FLDS", 40, uint8_t{'x'}), Code::kFormat);   // the last text has no end
  EXPECT_EQ(with("FLDS", 24, uint8_t{0xff}), Code::kFormat);  // no UTF-8
}

// Sections are found by their names: those of later releases are passed over, and files of before have fewer.
TEST(Policy, SectionsThatAreNotKnownArePassedOver) {
  Made made(make_shape(3, {2}, 1));
  Bytes b = made.bytes();
  const char next[] = {'N', 'E', 'X', 'T', 0, 0, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0, 'N', 'E', 'X', 'T', '!'};
  b.insert(b.begin() + 24, next, next + sizeof next);
  put(&b[16], static_cast<uint64_t>(b.size() - 24));
  seal(b);
  ASSERT_EQ(code_of(b), Code::kOk) << last_error();
  EXPECT_EQ(read(b)->view().num_fields, 2);
  b[24] = 'M';
  EXPECT_EQ(code_of(b), Code::kFormat) << "a tag that is not the one of the payload";
  made.view.num_fields = 0;
  EXPECT_EQ(read(made.bytes())->view().num_fields, 0);
}

TEST(Policy, ForeignAndNewerFilesAreNamed) {
  const Bytes b = Made(make_shape(3, {2}, 1)).bytes();
  const Bytes text = {'h', 'e', 'l', 'l', 'o'};
  EXPECT_EQ(code_of(text), Code::kFormat);
  EXPECT_EQ(code_of(Bytes(4096, 0)), Code::kFormat);
  EXPECT_EQ(code_of({}), Code::kFormat);
  Bytes agent = b;
  std::memcpy(agent.data(), "RDMAGENT", 8);
  EXPECT_EQ(code_of(agent), Code::kFormat);
  Bytes newer = b;
  put(&newer[8], kPolicyVersion + 1);
  EXPECT_EQ(code_of(newer), Code::kVersion);
  Bytes big_endian = b;
  put(&big_endian[12], uint32_t{0x04030201});
  EXPECT_EQ(code_of(big_endian), Code::kFormat);
  EXPECT_NE(std::strstr(last_error(), "byte order"), nullptr);
}

TEST(Policy, ThePageOfFilesSaysWhichVersionsAreRead) {
  std::ifstream page(RDM_TEST_DATA "/../examples/manual/files.md");
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  const size_t row = text.find("| policy, `.rdm` |");
  ASSERT_NE(row, std::string::npos);
  const std::string versions = "| 1 to " + std::to_string(kPolicyVersion) + " |";
  EXPECT_NE(text.substr(row, text.find('\n', row) - row).find(versions), std::string::npos) << versions;
}

// Version 4: the encoder's section, its weights and its example.
TEST(Policy, AnEncoderOutOfRangeIsAnError) {
  Made made(make_shape(3 + 4, {2}, 1), 0);
  PointNetShape& eyes = made.view.eyes;
  eyes.points = 9, eyes.classes = 2, eyes.mlp = make_shape(5, {6}, 4);
  const auto weights = random_floats(eyes.num_params(), 9);
  made.view.eyes_params = weights.data();
  const Bytes b = made.bytes();
  EXPECT_EQ(b[8], 4);
  EXPECT_EQ(code_of(b), Code::kOk);
  const Owned p = read(b);
  EXPECT_EQ(p->view().entries(), 3);
  EXPECT_EQ(p->view().eyes.mlp.hidden[0], 6);
  const auto with = [&](const char* tag, size_t at, auto v) {
    Bytes forged = b;
    put(section(forged, tag) + at, v);
    seal(forged);
    return code_of(forged);
  };
  // points, classes, features, origin [3], range, activation, layers, widths [4]
  for (const int32_t n : {0, -1, 8, 16385, INT32_MAX, INT32_MIN})
    EXPECT_EQ(with("EYES", 0, n), Code::kFormat) << n;
  for (const int32_t n : {-1, 1, 3, 65, INT32_MAX}) EXPECT_EQ(with("EYES", 4, n), Code::kFormat) << n;
  for (const int32_t n : {0, -1, 3, 5, 7, 4097, INT32_MAX}) EXPECT_EQ(with("EYES", 8, n), Code::kFormat) << n;
  EXPECT_EQ(with("EYES", 12, NAN), Code::kFormat);
  EXPECT_EQ(with("EYES", 20, 1e7f), Code::kFormat);
  for (const float x : {0.0f, -1.0f, 1e4f, NAN, INFINITY}) EXPECT_EQ(with("EYES", 24, x), Code::kFormat) << x;
  for (const int32_t n : {-1, 3}) EXPECT_EQ(with("EYES", 28, n), Code::kFormat) << n;
  for (const int32_t n : {-1, 0, 2, 5}) EXPECT_EQ(with("EYES", 32, n), Code::kFormat) << n;
  for (const int32_t n : {0, 5, 7, 1 << 30}) EXPECT_EQ(with("EYES", 36, n), Code::kFormat) << n;
  EXPECT_EQ(with("EYES", 40, 3), Code::kFormat) << "a layer that there is not";
  const size_t actor = 4 * made.view.actor.num_params();
  EXPECT_EQ(with("WGTS", actor, NAN), Code::kFormat);
  EXPECT_EQ(with("WGTS", actor, 1e30f), Code::kFormat) << "sums that may not be numbers";
  EXPECT_NE(std::strstr(last_error(), "too large"), nullptr);
  EXPECT_EQ(with("WGTS", actor + 4 * (eyes.num_params() - 1), 9.0f), Code::kFormat) << "the example says so";
  const size_t cloud = 4 * (3 + 1);  // behind the example's row and action
  EXPECT_EQ(with("EXMP", cloud + 2 * 27, uint8_t{2}), Code::kFormat) << "a class that there is not";
  Bytes older = b;
  put(&older[8], uint32_t{3});
  seal(older);
  EXPECT_EQ(code_of(older), Code::kFormat);
}
