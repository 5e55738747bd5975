// What agents keep of how far rows usually are: counts, states, ranks, clones, and who keeps nothing.
#include <cmath>

#include "agents.hpp"
#include "algos/rollout/usual.hpp"
#include "heap_count.hpp"
#include "nn/policy.hpp"
#include "ranks.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

using File = std::vector<unsigned char>;

struct Counts {
  Arena arena;
  AloneRanks alone{4};
  UsualRows rows;
  Counts() {
    Arena measure;
    rows.carve(measure, 4);
    arena = Arena(HostHooks(), measure.used());
    rows.carve(arena, 4);
  }
};

struct PolicyEnd {
  void operator()(Policy* p) const { Policy::destroy(p); }
};
std::unique_ptr<Policy, PolicyEnd> policy_of(const File& file) {
  return std::unique_ptr<Policy, PolicyEnd>(Policy::read(file.data(), file.size(), HostHooks()));
}
Novelty usual_of(Agent& a) {
  return policy_of(policy_file(a))->view().usual;
}
bool same(const Novelty& a, const Novelty& b) {
  return a.rms == b.rms && a.largest == b.largest;
}

// 40 worlds: of `horizon` decisions about 9 in 10 rows are valid.
AgentSetup setup_of(const char* horizon) {
  AgentSetup s = busy_setup("ppo_lag", "free", 40);
  return s.with("average", "0").with("horizon", horizon);
}

// Where the section of that tag begins, its head included, and its bytes; 0, 0: nowhere.
struct Span {
  size_t begin = 0, size = 0;
};
Span find(const File& state, const char* tag) {
  for (size_t at = kFileLengthAt + 8; at < state.size();) {
    uint64_t length = 0;
    std::memcpy(&length, &state[at + 8], sizeof length);
    const auto size = static_cast<size_t>(16 + length);
    if (std::memcmp(&state[at], tag, 4) == 0) return {at, size};
    at += size;
  }
  return {};
}
File with_length(File file) {
  const uint64_t body = file.size() - kFileLengthAt - 8;
  std::memcpy(&file[kFileLengthAt], &body, sizeof body);
  return file;
}
File without_usual(File state) {
  const Span s = find(state, "USUA");
  const auto first = state.begin() + static_cast<std::ptrdiff_t>(s.begin);
  if (s.size > 0) state.erase(first, first + static_cast<std::ptrdiff_t>(s.size));
  return with_length(std::move(state));
}

}  // namespace

TEST(Usual, IsWhatOneRowInAThousandExceeds) {
  Counts c;
  const auto count = [&](int rows) {
    for (int i = 1; i <= rows; ++i)
      c.rows.count({2 * static_cast<float>(i) / static_cast<float>(rows), 3000.0f / static_cast<float>(i)});
    c.rows.close(c.alone.ranks);
  };
  count(20000);
  // 20 rows are above, in steps of a sixteenth of an octave
  const double rms = 2 * 0.999, largest = 3000.0 / 21;
  EXPECT_GE(c.rows.known().rms, rms);
  EXPECT_LE(c.rows.known().rms, rms * 17 / 16);
  EXPECT_GE(c.rows.known().largest, largest);
  EXPECT_LE(c.rows.known().largest, largest * 17 / 16);
}

TEST(Usual, EpochsAreCountedTogetherUntilTheyAreAThousandRows) {
  Counts c;
  const auto count = [&](int rows, float size) {
    for (int i = 0; i < rows; ++i) c.rows.count({size, size});
    c.rows.close(c.alone.ranks);
    return c.rows.known().rms;
  };
  EXPECT_EQ(count(999, 1), 0) << "too few";
  const float first = count(1, 1);
  EXPECT_GE(first, 1);
  EXPECT_EQ(count(999, 4), first) << "what is known stays meanwhile";
  for (int i = 0; i < 5; ++i) c.rows.count({100, 100});
  c.rows.drop();
  EXPECT_GE(count(1, 4), 4) << "counted anew";
  EXPECT_LE(c.rows.known().rms, 4.25f) << "but for what was dropped";
}

TEST(Usual, AnySizeHasAPlace) {
  Counts c;
  for (const float x : {0.0f, 1e-30f, 1e30f, std::numeric_limits<float>::infinity()})
    for (int i = 0; i < 500; ++i) c.rows.count({x, x});
  c.rows.close(c.alone.ranks);
  EXPECT_TRUE(std::isfinite(c.rows.known().rms));
  EXPECT_GT(c.rows.known().rms, 1e6f);
}

TEST(Usual, RowsOfTrainingAreWithinIt) {
  AgentSetup s = setup_of("30");
  const AgentPtr a = s.make();
  EXPECT_EQ(usual_of(*a).rms, 0);
  NoiseWorld world(s.config);
  for (int i = 0; i < 3; ++i) world.epoch(*a);
  const auto p = policy_of(policy_file(*a));
  float novelty[40];
  int above = 0;
  for (int i = 0; i < 100; ++i, world.draw()) {
    p->novelty(world.obs(), 40, novelty);
    for (const float n : novelty) {
      above += n > 1;
      EXPECT_LT(n, 1.2f);
    }
  }
  EXPECT_LE(above, 8) << "of 4000";
  std::vector<float> far(world.obs(), world.obs() + 6);
  far[3] = 20;  // beside uniform ones in [-1, 1]
  p->novelty(far.data(), 1, novelty);
  EXPECT_GT(novelty[0], 5);
}

TEST(Usual, OnlyEntriesThatAPolicySeesCount) {
  const ObsField fields[] = {{"place", 0, 2, "m"}, {"speed", 2, 4, "m/s"}};
  AgentSetup s = setup_of("30");
  s.config.fields = fields;
  s.config.num_fields = 2;
  const AgentPtr a = s.with("actor_obs", "speed").make();
  NoiseWorld world(s.config);
  world.epoch(*a), world.epoch(*a);
  const auto p = policy_of(policy_file(*a));
  std::vector<float> row(world.obs(), world.obs() + 6);
  float novelty[2];
  p->novelty(row.data(), 1, &novelty[0]);
  row[1] = 1e6f;
  p->novelty(row.data(), 1, &novelty[1]);
  EXPECT_EQ(novelty[0], novelty[1]);
  row[5] = 1e6f;
  p->novelty(row.data(), 1, &novelty[1]);
  EXPECT_GT(novelty[1], 1e5f);
}

TEST(Usual, DroppedAndInvalidRowsDoNotCount) {
  AgentSetup s = setup_of("20");
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  while (a->missing() > 1) world.decide(*a);
  a->discard();
  world.epoch(*a);
  EXPECT_EQ(usual_of(*a).rms, 0) << "an epoch has 800 rows";
  world.epoch(*a);
  EXPECT_GT(usual_of(*a).rms, 0);

  AgentSetup longer = setup_of("30");
  const AgentPtr b = longer.make();
  const std::vector<uint8_t> none(40);
  while (b->missing() > 0) {
    b->act(world.obs(), true, world.action());
    world.draw();
    Transition t = world.transition();
    t.valid = none.data();
    b->record(t);
  }
  b->update(world.obs(), nullptr);
  EXPECT_EQ(usual_of(*b).rms, 0);
}

// By threads, in slices, by put.
TEST(Usual, IsTheSameHoweverItWasLearned) {
  AgentSetup s = setup_of("30");
  const AgentPtr one = s.make(), fed = s.make();
  s.config.num_threads = 3;
  const AgentPtr other = s.make();
  NoiseWorld world(s.config), again(s.config);
  for (int i = 0; i < 2; ++i) {
    while (one->missing() > 0) {
      const std::vector<float> obs(world.obs(), world.obs() + 240);
      one->act(obs.data(), true, world.action());
      world.draw();
      one->record(world.transition());
      fed->put(obs.data(), world.action(), world.transition());
      again.decide(*other);
    }
    one->update(world.obs(), nullptr), fed->update(world.obs(), nullptr);
    other->begin_update(again.obs());
    while (!other->update_on(3, nullptr)) {
    }
  }
  EXPECT_GT(usual_of(*one).rms, 0);
  EXPECT_EQ(policy_file(*other), policy_file(*one));
  EXPECT_EQ(saved(*other), saved(*one));
  EXPECT_TRUE(same(usual_of(*fed), usual_of(*one)));
}

TEST(Usual, OfRanks) {
  const auto setup = [] { return setup_of("70").with("blocks", "4"); };
  AgentSetup alone = setup();
  alone.config.num_envs = 16;
  const AgentPtr whole = alone.make();
  NoiseWorld world(alone.config);
  world.epoch(*whole), world.epoch(*whole);
  ASSERT_GT(usual_of(*whole).rms, 0);
  for (const int32_t ranks : {2, 4}) {
    Meeting meeting(ranks);
    std::vector<File> files(size_of(ranks)), states(files);
    each_rank(ranks, [&](int32_t rank) {
      AgentSetup s = setup();
      s.config.num_envs = 16 / ranks;
      s.config.ranks = meeting.hooks(rank);
      const AgentPtr a = s.make();
      NoisePart part(s.config);
      part.epoch(*a), part.epoch(*a);
      files[size_of(rank)] = policy_file(*a);
      states[size_of(rank)] = saved(*a);
    });
    for (const File& f : files) EXPECT_EQ(f, policy_file(*whole));
    for (const File& f : states) EXPECT_EQ(f, saved(*whole));
  }
}

TEST(Usual, IsPartOfTheState) {
  for (const char* horizon : {"30", "20"}) {  // known after an epoch, and rows that are too few
    SCOPED_TRACE(horizon);
    AgentSetup s = setup_of(horizon);
    const AgentPtr a = s.make(), b = s.make();
    NoiseWorld world(s.config);
    const File fresh = saved(*a);
    EXPECT_EQ(without_usual(fresh), fresh) << "nothing to say yet";
    world.epoch(*a);
    const File state = saved(*a), old = without_usual(state);
    ASSERT_LT(old.size(), state.size());
    b->load(old.data(), old.size());
    EXPECT_EQ(usual_of(*b).rms, 0) << "of a release that did not know it";
    EXPECT_EQ(saved(*b), old);
    b->load(state.data(), state.size());
    EXPECT_EQ(saved(*b), state);
    // what is damaged is refused, and changes nothing
    const Span section = find(state, "USUA");
    for (size_t i = section.begin; i < section.begin + std::min<size_t>(section.size, 200); ++i) {
      File bad = state;
      bad[i] ^= 1;
      EXPECT_EQ(thrown([&] { b->load(bad.data(), bad.size()); }).code, Code::kFormat) << i;
    }
    EXPECT_EQ(saved(*b), state);
    NoiseWorld again = world;
    world.epoch(*a), again.epoch(*b);
    EXPECT_GT(usual_of(*a).rms, 0);
    EXPECT_EQ(policy_file(*b), policy_file(*a)) << "as if it had not been saved";
    EXPECT_EQ(saved(*b), saved(*a));
  }
}

TEST(Usual, ForgedStatesAreRefusedOrGiveAPolicyThatLoads) {
  AgentSetup s = setup_of("20");
  const AgentPtr a = s.make(), b = s.make();
  NoiseWorld world(s.config);
  for (int epoch = 0; epoch < 3; ++epoch) world.epoch(*a);  // known, and counted on
  const File state = saved(*a);
  const Span section = find(state, "USUA");
  int good = 0;
  for (const size_t at : {0, 8, 12, 16, 24, 32, 40})  // flags and numbers, behind the tag
    for (const uint64_t word :
         {uint64_t{0}, uint64_t{1}, uint64_t{2}, ~uint64_t{0}, uint64_t{0x7ff8000000000000},
          uint64_t{0x3f8000003f800000}, uint64_t{0x0000000100000001}}) {
      File bad = state;
      std::memcpy(&bad[section.begin + 20 + at], &word, sizeof word);
      const uint32_t crc = crc32(&bad[section.begin + 16], section.size - 16);
      std::memcpy(&bad[section.begin + 4], &crc, sizeof crc);
      const Thrown t = thrown([&] { b->load(bad.data(), bad.size()); });
      if (t.code == Code::kOk)
        ++good, policy_of(policy_file(*b));
      else
        EXPECT_EQ(t.code, Code::kFormat) << at << " " << word;
    }
  EXPECT_GT(good, 3);
  EXPECT_LT(good, 40);
  // of an agent that keeps none
  AgentSetup raw = setup_of("20");
  const AgentPtr plain = raw.with("normalize_obs", "off").make();
  File other = saved(*plain);
  const auto first = state.begin() + static_cast<std::ptrdiff_t>(section.begin);
  other.insert(other.end(), first, first + static_cast<std::ptrdiff_t>(section.size));
  other = with_length(std::move(other));
  EXPECT_EQ(thrown([&] { plain->load(other.data(), other.size()); }).text,
            "agent state: section USUA holds rows of an agent without normalize_obs");
}

TEST(Usual, NobodyKeepsItWithoutANormaliser) {
  AgentSetup s = setup_of("30");
  const AgentPtr a = s.with("normalize_obs", "off").make();
  NoiseWorld world(s.config);
  world.epoch(*a);
  EXPECT_EQ(usual_of(*a).rms, 0);
  const File state = saved(*a);
  EXPECT_EQ(without_usual(state), state);
}

TEST(Usual, OfACloneIsThatOfItsRecording) {
  AgentSetup s = setup_of("30");
  const AgentPtr a = s.make();
  constexpr int32_t kRows = 1500;
  std::vector<float> obs(kRows * 6), label(kRows * 3);
  Stream stream(4, 0, Purpose::kTest);
  for (float& x : obs) x = 3 + static_cast<float>(stream.signed_unit());
  for (float& x : label) x = static_cast<float>(stream.signed_unit());
  const auto clone = [&](int32_t rows) {
    const DemoRows demo{rows, obs.data(), label.data(), nullptr, {}};
    CloneOptions how;
    how.epochs = 1;
    a->clone(demo, how);
  };
  clone(kRows);
  const auto p = policy_of(policy_file(*a));
  std::vector<float> novelty(kRows);
  p->novelty(obs.data(), kRows, novelty.data());
  int above = 0;
  for (const float n : novelty) above += n > 1;
  EXPECT_LE(above, 3);
  const std::vector<float> zeros(6);
  p->novelty(zeros.data(), 1, novelty.data());
  EXPECT_GT(novelty[0], 2) << "the recording is about 3";
  clone(999);
  EXPECT_EQ(usual_of(*a).rms, 0) << "the statistics are others now";
}

TEST(Usual, ComesWithAPolicyThatIsTakenOver) {
  AgentSetup s = setup_of("30");
  const AgentPtr a = s.make(), b = s.make();
  NoiseWorld world(s.config);
  world.epoch(*a), world.epoch(*b);
  world.epoch(*a);
  const auto p = policy_of(policy_file(*a));
  b->load_policy(p->view(), 1000);
  EXPECT_TRUE(same(usual_of(*b), p->view().usual));
  PolicyView old = p->view();
  old.usual = {};
  b->load_policy(old, 1000);
  EXPECT_EQ(usual_of(*b).rms, 0);
}

TEST(Usual, CountsWithoutTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is the sanitizer's here";
  AgentSetup s = setup_of("30");
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  world.epoch(*a);
  const int64_t before = heap_count();
  world.epoch(*a);
  EXPECT_EQ(heap_count(), before);
}
