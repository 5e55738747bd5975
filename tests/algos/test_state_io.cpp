#include <limits>

#include "agents.hpp"
#include "algos/core/state_io.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

constexpr char kMagic[8] = {'T', 'E', 'S', 'T', 'T', 'E', 'S', 'T'};

struct State {
  float x[3] = {1, 2, 3};
  double y = 4;
  int32_t n = 5;
  int64_t m = 6;
  Stream stream{7, 8, Purpose::kTest};

  void visit(StateIo& io) {
    io.section("FLOA");
    io.numbers(x, 3, -10, 10);
    io.number(y, 0, 100);
    io.section("INTE");
    io.integer(n, 0, 10);
    io.integer(m, 0, 10);
    io.stream(stream);
  }
};

std::vector<unsigned char> written(State s) {
  std::vector<unsigned char> bytes(1000);
  Writer out(bytes.data(), bytes.size());
  out.begin_file(kMagic, 1);
  StateWriter io(out);
  s.visit(io);
  io.end();
  out.end_file();
  bytes.resize(out.size());
  return bytes;
}

Thrown read(const std::vector<unsigned char>& bytes, State& s, bool apply) {
  return thrown([&] {
    Reader in(bytes.data(), bytes.size(), "test");
    in.begin_file(kMagic, 1);
    StateReader io(in, apply);
    s.visit(io);
    io.end();
  });
}

}  // namespace

TEST(StateIo, RoundTripAndDryRun) {
  State from, to;
  from.x[1] = 9, from.y = 50, from.n = 2, from.m = 3;
  from.stream.next();
  const auto bytes = written(from);
  EXPECT_EQ(read(bytes, to, false).code, Code::kOk);
  EXPECT_EQ(to.x[1], 2);
  EXPECT_EQ(to.n, 5);
  EXPECT_EQ(read(bytes, to, true).code, Code::kOk);
  EXPECT_EQ(to.x[1], 9);
  EXPECT_EQ(to.y, 50);
  EXPECT_EQ(to.n, 2);
  EXPECT_EQ(to.m, 3);
  EXPECT_EQ(to.stream.next(), from.stream.next());
}

TEST(StateIo, NumbersOutOfBoundsAreRefused) {
  State bad[5], to;
  bad[0].x[2] = 11;
  bad[1].x[0] = std::numeric_limits<float>::quiet_NaN();
  bad[2].y = -1;
  bad[3].n = 11;
  bad[4].m = -1;
  for (const State& s : bad) {
    const Thrown t = read(written(s), to, false);
    EXPECT_EQ(t.code, Code::kFormat);
    EXPECT_NE(t.text.find("section"), std::string::npos) << t.text;
  }
}

TEST(StateIo, OtherLayoutsAreRefused) {
  struct Short {
    void visit(StateIo& io) {
      float x[2] = {1, 2};
      io.section("FLOA");
      io.numbers(x, 2, -10, 10);
    }
  } shorter;
  const auto bytes = written(State());
  Reader in(bytes.data(), bytes.size(), "test");
  in.begin_file(kMagic, 1);
  StateReader io(in, false);
  EXPECT_EQ(thrown([&] {
              shorter.visit(io);
              io.end();
            }).code,
            Code::kFormat);
}
