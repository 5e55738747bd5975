// Archives of arrays: what is written is read, whatever else is a Failure.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>

#include "common/report.hpp"
#include "record/npy.hpp"
#include "record/recorded_rollout.hpp"
#include "record/recorder.hpp"

namespace {

using namespace tool;

ZipReader reader_of(const std::string& bytes) {
  return ZipReader(bytes.size(), [&bytes](uint64_t at, void* to, size_t size) {
    ASSERT_LE(at, bytes.size());
    ASSERT_LE(size, bytes.size() - at) << "a read past the end";
    std::memcpy(to, bytes.data() + at, size);
  });
}

// A file's name that goes with the test.
struct Named {
  std::string path = "record-" + std::to_string(getpid()) + ".npz";
  ~Named() { unlink(path.c_str()); }
};

// Three episodes of bandit by two worlds, as a file's bytes; the actions are 0.25 e.
std::string recorded(bool states) {
  const Named file;
  auto config = redman::pool_config("bandit", 2);
  config.autoreset = RDM_AUTORESET_OFF;
  redman::Pool pool(config);
  Recorder recorder(file.path, pool, 3, states);
  pool.reset();
  for (size_t e = 0; e < 3; ++e) {
    const size_t env = e % 2;
    const uint8_t mask[2] = {env == 0, env == 1};
    if (e == 2) pool.reset(nullptr, mask);
    pool.action()[env][0] = 0.25f * static_cast<float>(e);
    recorder.before(env, e);
    pool.step(mask);
    recorder.after(env, e);
  }
  EXPECT_EQ(recorder.finish({"hold", {}, 7}), 3u);
  return read_file(file.path);
}

template <class T>
std::vector<T> values(const ZipReader& zip, const std::string& name, const char* type,
                      const std::vector<uint64_t>& shape) {
  const std::string bytes = zip.member(name + ".npy", 1 << 20);
  size_t begin = 0;
  const ArrayShape array = parse_npy(bytes.data(), bytes.size(), &begin);
  EXPECT_EQ(array.type, type) << name;
  EXPECT_EQ(array.shape, shape) << name;
  EXPECT_EQ(begin % 64, 0u);
  std::vector<T> out((bytes.size() - begin) / sizeof(T));
  std::memcpy(out.data(), bytes.data() + begin, out.size() * sizeof(T));
  return out;
}

TEST(Record, HoldsWhatWasPlayed) {
  const std::string bytes = recorded(true);
  const ZipReader zip = reader_of(bytes);
  EXPECT_EQ(values<float>(zip, "action", "<f4", {3, 1}), (std::vector<float>{0, 0.25f, 0.5f}));
  EXPECT_EQ(values<int32_t>(zip, "env", "<i4", {3}), (std::vector<int32_t>{0, 1, 0}));
  EXPECT_EQ(values<int32_t>(zip, "episode", "<i4", {3}), (std::vector<int32_t>{0, 1, 2}));
  EXPECT_EQ(values<int64_t>(zip, "episode_begin", "<i8", {4}), (std::vector<int64_t>{0, 1, 2, 3}));
  EXPECT_EQ(values<uint64_t>(zip, "seed", "<u8", {}), (std::vector<uint64_t>{7}));
  const auto reward = values<float>(zip, "reward", "<f4", {3}),
             sum = values<float>(zip, "episode_return", "<f4", {3}),
             cost = values<float>(zip, "cost", "<f4", {3, 1});
  EXPECT_EQ(reward, sum);
  for (size_t e = 0; e < 3; ++e) EXPECT_GE(cost[e], 0);
  EXPECT_NE(reward[0], reward[2]);  // -(a - 2)^2
  const size_t width = zip.member("state.npy", 1 << 20).size();
  EXPECT_EQ(zip.member("states.npy", 1 << 20).size(), width);
  EXPECT_EQ(zip.member("states.npy", 1 << 20), zip.member("state.npy", 1 << 20));  // episodes of one step
  EXPECT_FALSE(reader_of(recorded(false)).has("states.npy"));
}

TEST(Record, IsReadAgain) {
  const std::string bytes = recorded(false);
  const Recording r = parse_recording(reader_of(bytes));
  EXPECT_EQ(r.pool.task, "bandit");
  EXPECT_EQ(r.pool.seed, 7u);
  EXPECT_EQ(r.pool.envs, 2);
  EXPECT_EQ(r.policy, "hold");
  EXPECT_EQ(r.action, (std::vector<float>{0, 0.25f, 0.5f}));
  ASSERT_EQ(r.episodes(), 3u);
  EXPECT_EQ(r.length(2), 1u);
  EXPECT_EQ(r.state.size(), 3 * r.state_bytes);
  EXPECT_EQ(r.hash.size(), 16u);
}

// Prefixes, and every byte replaced by another: a recording or a Failure.
TEST(Record, RefusesSpoiltBytes) {
  const std::string good = recorded(false);
  size_t refused = 0, tried = 0;
  const auto attempt = [&](const std::string& bytes) {
    ++tried;
    try {
      parse_recording(reader_of(bytes));
    } catch (const Failure& e) {
      EXPECT_NE(std::string(e.what()), "");
      ++refused;
    }
  };
  for (size_t n = 0; n < good.size(); n += 7) attempt(good.substr(0, n));
  EXPECT_EQ(refused, tried);
  for (size_t n = 0; n < good.size(); ++n) {
    std::string bad = good;
    bad[n] = static_cast<char>(bad[n] ^ 0x5a);
    attempt(bad);
  }
  EXPECT_LT(refused, tried);
}

TEST(Npy, TextGoesThereAndBack) {
  for (const std::string text : {"", "a",
                                 "Gr\xc3\xb6\xc3\x9f"
                                 "e",
                                 "\xe2\x82\xac \xf0\x9f\x98\x80"}) {
    const ArrayShape array = text_shape(text);
    const std::string bytes = text_bytes(text);
    EXPECT_EQ(array.bytes(), bytes.size());
    EXPECT_EQ(text_of_array(array, bytes.data()), text);
  }
  const uint32_t surrogate = 0xd800;
  EXPECT_THROW(text_of_array({"<U1", {}}, reinterpret_cast<const char*>(&surrogate)), Failure);
}

TEST(Npy, ReadsNumpysHeadersAlone) {
  const auto parse = [](const std::string& literal, size_t numbers) {
    std::string bytes("\x93NUMPY\x01", 8);
    bytes += static_cast<char>(literal.size());
    bytes += '\0';
    bytes += literal + std::string(numbers, '\0');
    size_t begin = 0;
    return parse_npy(bytes.data(), bytes.size(), &begin).shape;
  };
  EXPECT_EQ(parse("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }  \n", 24),
            (std::vector<uint64_t>{2, 3}));
  EXPECT_EQ(parse("{'shape':(5,),'descr':'|u1','fortran_order':False}", 5), (std::vector<uint64_t>{5}));
  EXPECT_EQ(parse("{'descr': '<i8', 'fortran_order': False, 'shape': ()}", 8), (std::vector<uint64_t>{}));
  for (const char* bad :
       {"", "{", "{'descr': '<f4'}", "{'descr': '<f4', 'fortran_order': True, 'shape': (1,), }",
        "{'descr': '>f4', 'fortran_order': False, 'shape': (1,), }",
        "{'descr': '|O', 'fortran_order': False, 'shape': (1,), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (4294967296, 4294967296, 4294967296), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999999,), }"})
    EXPECT_THROW(parse(bad, 4), Failure) << bad;
}

}  // namespace
