// Saved states: exact, checked before anything changes.
#include "toy_task.hpp"

namespace rdm::test {
namespace {

PoolConfig mode(Autoreset autoreset, uint64_t seed = 0) {
  register_toy();
  PoolConfig c;
  c.autoreset = autoreset;
  c.seed = seed;
  return c;
}

void run(TestPool& p, int steps) {
  for (int t = 0; t < steps; ++t) {
    p->baseline(Baseline::kRandom);
    p->step(nullptr);
  }
}

TEST(PoolState, ANewPoolGoesOnWithTheSameBytes) {
  TestPool a("toy_push", 3, {}, mode(Autoreset::kSameStep, 5)),
      b("toy_push", 3, {}, mode(Autoreset::kSameStep, 9));
  a->reset(nullptr, nullptr);
  run(a, 17);
  const auto state = a.state();
  b->set_state(-1, state.data(), state.size());
  EXPECT_EQ(std::memcmp(a.rows().obs, b.rows().obs, sizeof(float) * 3 * kToyObs), 0);
  EXPECT_EQ(std::memcmp(b.rows().obs, b.rows().final_obs, sizeof(float) * 3 * kToyObs), 0);
  EXPECT_EQ(b.rows().reward[0], 0);
  EXPECT_EQ(a->hash(-1), b->hash(-1));
  run(a, 23);
  run(b, 23);
  EXPECT_EQ(a->hash(-1), b->hash(-1));
  EXPECT_EQ(a.rows().episode_return[2], b.rows().episode_return[2]);
  EXPECT_EQ(a.rows().episode_step[2], b.rows().episode_step[2]);
}

TEST(PoolState, OneWorldMovesToAnotherPlace) {
  TestPool a("toy_push", 3, {}, mode(Autoreset::kSameStep, 5));
  a->reset(nullptr, nullptr);
  run(a, 4);
  const auto state = a.state(2);
  const uint64_t other = a->hash(1);
  a->set_state(0, state.data(), state.size());
  EXPECT_EQ(a->hash(0), a->hash(2));
  EXPECT_EQ(a->hash(1), other);
}

TEST(PoolState, AnEndedWorldStaysEnded) {
  for (const Autoreset m : {Autoreset::kNextStep, Autoreset::kOff}) {
    TestPool a("toy_push", 1, {}, mode(m)), b("toy_push", 1, {}, mode(m));
    a->reset(nullptr, nullptr);
    for (int t = 0; t < 10; ++t) a->step(nullptr);
    ASSERT_TRUE(a.rows().truncated[0]);
    const auto state = a.state();
    b->set_state(-1, state.data(), state.size());
    EXPECT_TRUE(b.rows().truncated[0]);
    if (m == Autoreset::kOff) {
      EXPECT_EQ(code_of([&] { b->step(nullptr); }), Code::kState);
      continue;
    }
    a->step(nullptr);
    b->step(nullptr);
    EXPECT_FALSE(b.ended(0));
    EXPECT_EQ(a->hash(0), b->hash(0));
  }
}

TEST(PoolState, APoolThatWasNeverResetCanBeSaved) {
  TestPool a("toy_push", 1, {}, mode(Autoreset::kSameStep)), b("toy_push", 1, {}, mode(Autoreset::kSameStep));
  b->reset(nullptr, nullptr);
  const auto state = a.state();
  b->set_state(-1, state.data(), state.size());
  EXPECT_EQ(code_of([&] { b->step(nullptr); }), Code::kState);
}

TEST(PoolState, ForeignAndCorruptBytesChangeNothing) {
  TestPool a("toy_push", 2, {}, mode(Autoreset::kSameStep));
  a->reset(nullptr, nullptr);
  run(a, 3);
  const auto good = a.state();
  run(a, 1);
  const uint64_t before = a->hash(-1);
  const float reward = a.rows().reward[0];
  for (size_t cut = 0; cut < good.size(); cut += 7)
    EXPECT_NE(code_of([&] { a->set_state(-1, good.data(), cut); }), Code::kOk);
  for (size_t at = 0; at < good.size(); at += 3) {
    auto bad = good;
    bad[at] ^= 0x10;
    EXPECT_NE(code_of([&] { a->set_state(-1, bad.data(), bad.size()); }), Code::kOk) << at;
  }
  EXPECT_EQ(code_of([&] { a->set_state(0, good.data(), good.size()); }),
            Code::kFormat);  // two worlds for one
  EXPECT_EQ(code_of([&] { a->set_state(2, good.data(), good.size()); }), Code::kRange);
  TestPool other("toy_push", 2, {{"max_steps", nullptr, 11}}, mode(Autoreset::kSameStep));
  EXPECT_EQ(code_of([&] { other->set_state(-1, good.data(), good.size()); }), Code::kFormat);
  EXPECT_EQ(a->hash(-1), before);
  EXPECT_EQ(a.rows().reward[0], reward);
}

// A record that passes every checksum, but does not make sense, in the second world.
TEST(PoolState, ABadRecordLeavesNoTrace) {
  TestPool a("toy_push", 2, {}, mode(Autoreset::kSameStep));
  a->reset(nullptr, nullptr);
  run(a, 2);
  auto state = a.state();
  Reader in(state.data(), state.size(), "state");
  in.begin_file("RDMSTATE", 2);
  in.need_section("WRLD");
  const size_t size = in.left();
  const auto* payload = in.view(size);
  const auto offset = static_cast<size_t>(payload - state.data());
  // the phase stands behind length, world, task struct, seed and two streams
  uint64_t world = 0;
  std::memcpy(&world, payload, sizeof world);
  const size_t record = size / 2;
  const size_t phase = offset + record + 8 + world + sizeof(ToyTask::State) + 8 + 2 * sizeof(Stream);
  state[phase] = 200;
  const uint32_t crc = crc32(state.data() + offset, size);
  std::memcpy(state.data() + offset - 12, &crc, sizeof crc);
  run(a, 2);
  const uint64_t before = a->hash(-1);
  EXPECT_EQ(code_of([&] { a->set_state(-1, state.data(), state.size()); }), Code::kFormat);
  EXPECT_STREQ(last_error(), "state: a phase is 200, which does not exist");
  EXPECT_EQ(a->hash(-1), before);
}

// The task is asked about its struct while the world runs; an ended world's is zeroed before it is read
// again.
TEST(PoolState, ATasksStructIsItsOwnToJudge) {
  TestPool a("toy_push", 1, {}, mode(Autoreset::kOff));
  a->reset(nullptr, nullptr);
  const auto with_steps = [&](int64_t steps) {
    auto state = a.state();
    Reader in(state.data(), state.size(), "state");
    in.begin_file("RDMSTATE", 2);
    in.need_section("WRLD");
    const size_t size = in.left();
    const auto offset = static_cast<size_t>(in.view(size) - state.data());
    uint64_t world = 0;
    std::memcpy(&world, state.data() + offset, sizeof world);
    std::memcpy(state.data() + offset + 8 + world + offsetof(ToyTask::State, steps), &steps, sizeof steps);
    const uint32_t crc = crc32(state.data() + offset, size);
    std::memcpy(state.data() + offset - 12, &crc, sizeof crc);
    return state;
  };
  run(a, 2);
  const uint64_t before = a->hash(0);
  const auto bad = with_steps(-5);
  EXPECT_EQ(code_of([&] { a->set_state(0, bad.data(), bad.size()); }), Code::kFormat);
  EXPECT_NE(std::strstr(last_error(), "steps -5"), nullptr) << last_error();
  EXPECT_EQ(a->hash(0), before);
  const auto good = with_steps(7);
  EXPECT_EQ(code_of([&] { a->set_state(0, good.data(), good.size()); }), Code::kOk);
  while (!a.ended(0)) run(a, 1);
  const auto ended = with_steps(-5);
  EXPECT_EQ(code_of([&] { a->set_state(0, ended.data(), ended.size()); }), Code::kOk);
  a->reset(nullptr, nullptr);
  run(a, 1);
}

TEST(PoolState, SizeIsWhatGetStateWrites) {
  TestPool a("toy_push", 3, {}, mode(Autoreset::kSameStep));
  EXPECT_EQ(a.state(1).size(), a->state_size(1));
  EXPECT_GT(a->state_size(-1), 2 * a->state_size(1));
}

}  // namespace
}  // namespace rdm::test
