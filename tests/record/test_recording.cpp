// Recordings and their files: rows, episodes, states; what a file must be to be read.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include "base/error.hpp"
#include "record/recording.hpp"

using namespace rdm;

namespace {

RecordingSpec small() {
  RecordingSpec s;
  s.obs_dim = 3, s.action_dim = 2, s.cost_dim = 1;
  s.layout_hash = 77;
  s.state_bytes = 5;
  s.state_stride = 2;
  std::strcpy(s.task, "toy");
  return s;
}

struct Rows {
  std::vector<float> obs, action, label, reward, cost;
  std::vector<uint8_t> terminated, truncated, success, state;
  std::vector<int64_t> episode, state_row;
  RecordingRows view() const {
    RecordingRows v;
    v.rows = static_cast<int64_t>(reward.size());
    v.obs = obs.data(), v.action = action.data(), v.label = label.data(), v.reward = reward.data();
    v.cost = cost.data(), v.terminated = terminated.data(), v.truncated = truncated.data();
    v.success = success.data(), v.episode = episode.data();
    v.num_states = static_cast<int64_t>(state_row.size());
    v.state_row = state_row.data(), v.state = state.data();
    return v;
  }
};

// Two episodes in turn: 0 succeeds with a cost of 3, 1 fails with a cost of 0.
Rows two_episodes() {
  Rows r;
  for (int i = 0; i < 6; ++i) {
    const bool second = i % 2;
    for (int j = 0; j < 3; ++j) r.obs.push_back(static_cast<float>(10 * i + j));
    for (int j = 0; j < 2; ++j) r.action.push_back(0.1f * static_cast<float>(i + j)), r.label.push_back(0.5f);
    r.reward.push_back(static_cast<float>(i));
    r.cost.push_back(second ? 0.0f : 1.0f);
    r.terminated.push_back(i >= 4 && second);
    r.truncated.push_back(i >= 4 && !second);
    r.success.push_back(i == 2);
    r.episode.push_back(second);
  }
  for (const int64_t row : {1, 4}) {
    r.state_row.push_back(row);
    for (int k = 0; k < 5; ++k) r.state.push_back(static_cast<uint8_t>(10 * row + k));
  }
  return r;
}

Code code_of(void (*f)(Rows&)) {
  Rows rows = two_episodes();
  f(rows);
  Recording r(small(), 0);
  try {
    r.append(rows.view());
  } catch (const Error& e) {
    EXPECT_EQ(r.rows(), 0);
    EXPECT_EQ(r.episodes(), 0);
    return e.code;
  }
  return Code::kOk;
}

Vector<unsigned char> file_of(const Recording& r) {
  Vector<unsigned char> bytes;
  r.write(bytes);
  return bytes;
}

struct End {
  void operator()(Recording* r) const { host_delete(HostHooks(), r); }
};
using Owned = std::unique_ptr<Recording, End>;

}  // namespace

TEST(Recording, AppendsAndNumbersEpisodesOn) {
  Recording r(small(), 100);
  const Rows rows = two_episodes();
  r.append(rows.view());
  r.append(rows.view());
  EXPECT_EQ(r.rows(), 12);
  EXPECT_EQ(r.episodes(), 4);
  EXPECT_EQ(r.num_states(), 4);
  const RecordingRows v = r.view();
  EXPECT_EQ(v.episode[6], 2);
  EXPECT_EQ(v.state_row[2], 7);
  EXPECT_EQ(v.obs[6 * 3 + 1], 1.0f);
  EXPECT_EQ(v.state[3 * 5 + 4], 44);
}

TEST(Recording, WithoutEpisodesEachEndBeginsOne) {
  Recording r(small(), 0);
  Rows rows = two_episodes();
  RecordingRows v = rows.view();
  v.episode = nullptr, v.label = nullptr, v.num_states = 0;
  r.append(v);
  EXPECT_EQ(r.view().episode[4], 0);
  EXPECT_EQ(r.view().episode[5], 1);
  EXPECT_EQ(r.view().label[3], r.view().action[3]);
}

TEST(Recording, RefusesWhatIsNoRow) {
  EXPECT_EQ(code_of([](Rows&) {}), Code::kOk);
  EXPECT_EQ(code_of([](Rows& r) { r.obs[4] = std::nanf(""); }), Code::kArgument);
  EXPECT_EQ(code_of([](Rows& r) { r.label[4] = std::numeric_limits<float>::infinity(); }), Code::kArgument);
  EXPECT_EQ(code_of([](Rows& r) { r.reward[5] = std::nanf(""); }), Code::kArgument);
  EXPECT_EQ(code_of([](Rows& r) { r.cost[0] = std::nanf(""); }), Code::kArgument);
  EXPECT_EQ(code_of([](Rows& r) { r.success[1] = 2; }), Code::kArgument);
  EXPECT_EQ(code_of([](Rows& r) { r.episode[1] = -1; }), Code::kArgument);
  EXPECT_EQ(code_of([](Rows& r) { r.episode[1] = 6; }), Code::kArgument);
  EXPECT_EQ(code_of([](Rows& r) { r.episode = {1, 0, 1, 0, 1, 0}; }), Code::kArgument);  // 1 before 0
  EXPECT_EQ(code_of([](Rows& r) { r.episode = {0, 2, 0, 2, 0, 2}; }), Code::kArgument);  // there is no 1
  EXPECT_EQ(code_of([](Rows& r) { r.truncated[2] = 1; }), Code::kArgument);  // it goes on after its end
  EXPECT_EQ(code_of([](Rows& r) { r.state_row[1] = 1; }), Code::kArgument);
  EXPECT_EQ(code_of([](Rows& r) { r.state_row[1] = 6; }), Code::kArgument);
}

TEST(Recording, FilterDropsWholeEpisodes) {
  Recording r(small(), 0);
  r.append(two_episodes().view());
  EXPECT_EQ(r.filter(true, nullptr), 1);
  EXPECT_EQ(r.rows(), 3);
  EXPECT_EQ(r.episodes(), 1);
  EXPECT_EQ(r.view().obs[3], 20.0f);
  ASSERT_EQ(r.num_states(), 1);
  EXPECT_EQ(r.view().state_row[0], 2);  // row 4 was the episode's third
  EXPECT_EQ(r.view().state[0], 40);

  Recording by_cost(small(), 0);
  by_cost.append(two_episodes().view());
  const double most = 2.5, any = -1;
  EXPECT_EQ(by_cost.filter(false, &any), 0);
  EXPECT_EQ(by_cost.filter(false, &most), 1);
  EXPECT_EQ(by_cost.view().obs[0], 10.0f);
  EXPECT_EQ(by_cost.view().episode[0], 0);
  EXPECT_EQ(by_cost.view().state[0], 10);
  by_cost.clear();
  EXPECT_EQ(by_cost.rows() + by_cost.episodes() + by_cost.num_states(), 0);
}

TEST(Recording, OpenRowsSumWhatFollows) {
  Recording r(small(), 0);
  const float obs[3] = {1, 2, 3}, action[2] = {3, -0.5f}, cost = 0.25f;
  const int source = 0, other = 0;
  for (int i = 0; i < 3; ++i) {
    r.make_room(&source, 2);
    r.begin_row(1, obs, action, nullptr);
    EXPECT_EQ(r.state_due(1), i % 2 == 0);
    if (r.state_due(1)) std::memset(r.add_state(1), i, 5);
    r.end_row(1, 1, &cost, false, false, false);
    r.end_row(1, 2, &cost, i == 2, false, i == 1);
    r.end_row(0, 9, &cost, true, false, false);  // has no row
  }
  r.end_row(1, 9, &cost, true, false, false);  // ended
  RecordingRows v = r.view();
  EXPECT_EQ(r.rows(), 3);
  EXPECT_EQ(v.action[0], 1.0f);
  EXPECT_EQ(v.reward[2], 3.0f);
  EXPECT_EQ(v.cost[1], 0.5f);
  EXPECT_EQ(v.success[1], 1);
  EXPECT_EQ(v.terminated[2], 1);
  EXPECT_EQ(r.num_states(), 2);
  r.make_room(&source, 2);
  r.begin_row(1, obs, action, nullptr);
  EXPECT_EQ(r.view().episode[3], 1);
  r.make_room(&other, 2);
  r.begin_row(1, obs, action, nullptr);
  EXPECT_EQ(r.view().episode[4], 2);
  EXPECT_EQ(r.episodes(), 3);
}

Recording* read_bytes(const unsigned char* data, size_t size) {
  return Recording::read(MemorySource(data, size), HostHooks());
}

TEST(Recording, FileComesBackToTheByte) {
  Recording r(small(), 0);
  r.append(two_episodes().view());
  const auto bytes = file_of(r);
  const Owned back(read_bytes(bytes.data(), bytes.size()));
  EXPECT_EQ(file_of(*back), bytes);
  EXPECT_EQ(back->fingerprint(), r.fingerprint());
  EXPECT_EQ(back->state_fingerprint(), r.state_fingerprint());
  EXPECT_STREQ(back->spec().task, "toy");
  EXPECT_EQ(back->spec().layout_hash, 77u);
  EXPECT_EQ(back->episodes(), 2);
  Recording more(small(), 0);
  more.append_all(*back);
  EXPECT_EQ(more.fingerprint(), r.fingerprint());
}

TEST(Recording, AnEmptyOneIsAFileToo) {
  const Recording r(small(), 0);
  const auto bytes = file_of(r);
  const Owned back(read_bytes(bytes.data(), bytes.size()));
  EXPECT_EQ(back->rows(), 0);
  EXPECT_EQ(back->spec().obs_dim, 3);
}

// Every byte that matters is held by a checksum or checked; those of the directory's dates and the like are
// not.
TEST(Recording, CorruptFilesAreRefusedOrTheSame) {
  Recording r(small(), 0);
  r.append(two_episodes().view());
  const auto bytes = file_of(r);
  int refused = 0;
  for (size_t i = 0; i < bytes.size(); ++i) {
    auto bad = bytes;
    bad[i] = static_cast<unsigned char>(bad[i] ^ 0x41u);
    try {
      const Owned back(read_bytes(bad.data(), bad.size()));
      EXPECT_EQ(back->fingerprint(), r.fingerprint()) << i;
    } catch (const Error& e) {
      EXPECT_TRUE(e.code == Code::kFormat || e.code == Code::kVersion) << i << ": " << e.text;
      EXPECT_EQ(std::strchr(e.text, '\n'), nullptr);
      ++refused;
    }
  }
  EXPECT_GT(refused, static_cast<int>(bytes.size() / 2));
  for (size_t n = 0; n < bytes.size(); n += 7) EXPECT_THROW(Owned(read_bytes(bytes.data(), n)), Error) << n;
}

TEST(Recording, SpecsAreHeldToTheirBounds) {
  for (const auto change : std::vector<void (*)(RecordingSpec&)>{
           [](RecordingSpec& s) { s.obs_dim = 0; }, [](RecordingSpec& s) { s.action_dim = 1025; },
           [](RecordingSpec& s) { s.cost_dim = -1; }, [](RecordingSpec& s) { s.state_stride = 0; },
           [](RecordingSpec& s) { s.state_bytes = size_t{1} << 40; }}) {
    RecordingSpec s = small();
    change(s);
    EXPECT_THROW(Recording(s, 0), Error);
  }
}
