// Every word of a good state, set to what no state holds: not a number, infinite, huge, negative, an index
// far outside. The checksums are mended, so that the contents themselves are judged: a state is refused and
// changes nothing, or the world goes on and what it writes is finite. Every task on every engine, and the
// states of agents of every algorithm.
//
//   hard_words [--seconds S] [--only TEXT]     S: about so long in all; words are then sampled
// Build it with the address and undefined-behaviour sanitizers (presets asan, fuzz) to see what does not
// crash.
#include <memory>

#include "isolate.hpp"
#include "worlds.hpp"

using namespace hard;

namespace {

struct Value {
  const char* name;
  int width;
  unsigned char bytes[8];
};

template <class T>
Value value_of(const char* name, T v) {
  Value out{name, sizeof(T), {}};
  std::memcpy(out.bytes, &v, sizeof v);
  return out;
}

const std::vector<Value>& values() {
  static const std::vector<Value> all = {
      value_of("NaN", std::nan("")),
      value_of("inf", HUGE_VAL),
      value_of("-1.0", -1.0),
      value_of("1e300", 1e300),
      value_of("-1e9", -1e9),
      value_of("1e-320", 1e-320),
      value_of("int64 -1", int64_t{-1}),
      value_of("int64 2^29", int64_t{0x20000000}),
      value_of("float NaN", std::nanf("")),
      value_of("float inf", HUGE_VALF),
      value_of("float 1e38", 1e38f),
      value_of("int32 -1", int32_t{-1}),
      value_of("int32 2^29", int32_t{0x20000000}),
      value_of("int32 7", int32_t{7}),
      value_of("int32 max", INT32_MAX),
  };
  return all;
}

// The good bytes and every place in them.
struct Places {
  Bytes good;
  std::vector<Span> spans;
  std::vector<long> begins;  // number of the first word of each span
  long words = 0;

  explicit Places(Bytes bytes) : good(std::move(bytes)) {
    payloads(good.data(), 0, good.size(), spans);
    for (const Span& s : spans) {
      begins.push_back(words);
      words += static_cast<long>((s.end - s.begin) / 4);
    }
  }
  long experiments() const { return words * static_cast<long>(values().size()); }
  // The state with one word changed. False where an eight-byte value would not fit.
  bool change(long k, Bytes& out, std::string& what) const {
    const Value& v = values()[static_cast<size_t>(k % static_cast<long>(values().size()))];
    const long word = k / static_cast<long>(values().size());
    size_t i = spans.size() - 1;
    while (begins[i] > word) --i;
    const size_t at = spans[i].begin + 4 * static_cast<size_t>(word - begins[i]);
    if (at + static_cast<size_t>(v.width) > spans[i].end) return false;
    out = good;
    std::memcpy(out.data() + at, v.bytes, static_cast<size_t>(v.width));
    mend(out.data(), out.size());
    what = std::string(v.name) + " at byte " + std::to_string(at);
    return true;
  }
};

Experiment world_experiment(const World& w) {
  auto pool = std::make_shared<PoolOf>();
  HARD_REQUIRE(pool->make(w, 1) == RDM_OK, "%s", rdm_last_error());
  HARD_REQUIRE(rdm_pool_reset(pool->handle, nullptr, nullptr) == RDM_OK, "%s", rdm_last_error());
  for (uint32_t i = 0; i < 5; ++i) {
    pool->fill_actions(i);
    HARD_REQUIRE(rdm_pool_step(pool->handle) == RDM_OK, "%s", rdm_last_error());
  }
  const auto places = std::make_shared<Places>(pool->state());
  const uint32_t steps = w.engine.empty() ? 3 : 2;
  return [=](long k, Tally& tally) {
    if (k >= places->experiments()) return Outcome::kEnd;
    Bytes bytes;
    std::string what;
    if (!places->change(k, bytes, what)) return Outcome::kOther;
    const rdm_result r = rdm_pool_read_state(pool->handle, -1, bytes.data(), bytes.size());
    if (r != RDM_OK) {
      require_refusal(r);
      if (pool->state() == places->good) return Outcome::kGood;
      tally.remember("%s: refused, and the world is another", what.c_str());
    } else {
      const char* bad = pool->broken_row();
      for (uint32_t i = 0; i < steps && !bad; ++i) {
        pool->fill_actions(i);
        if (rdm_pool_step(pool->handle) != RDM_OK) break;
        bad = pool->broken_row();
      }
      HARD_REQUIRE(rdm_pool_read_state(pool->handle, -1, places->good.data(), places->good.size()) == RDM_OK,
                   "%s", rdm_last_error());
      if (!bad) return Outcome::kOther;
      tally.remember("%s: taken, and %s is out of its bounds", what.c_str(), bad);
    }
    return Outcome::kBad;
  };
}

Experiment agent_experiment(const std::string& algo) {
  auto agent = std::make_shared<AgentOf>();
  HARD_REQUIRE(agent->make(algo) == RDM_OK, "%s", rdm_last_error());
  for (int i = 0; i < 2; ++i) HARD_REQUIRE(agent->epoch() == RDM_OK, "%s", rdm_last_error());
  const auto places = std::make_shared<Places>(agent->state());
  return [=](long k, Tally& tally) {
    if (k >= places->experiments()) return Outcome::kEnd;
    Bytes bytes;
    std::string what;
    if (!places->change(k, bytes, what)) return Outcome::kOther;
    const rdm_result r = rdm_agent_read_state(agent->handle, bytes.data(), bytes.size());
    if (r != RDM_OK) {
      require_refusal(r);
      if (agent->state() == places->good) return Outcome::kGood;
      tally.remember("%s: refused, and the agent is another", what.c_str());
    } else {
      const Bytes policy = agent->policy();
      rdm_policy* p = nullptr;
      const bool loads = rdm_policy_read(&p, policy.data(), policy.size()) == RDM_OK;
      rdm_policy_destroy(p);
      const rdm_result e = agent->epoch();
      if (e != RDM_OK) require_refusal(e);
      HARD_REQUIRE(rdm_agent_read_state(agent->handle, places->good.data(), places->good.size()) == RDM_OK,
                   "%s", rdm_last_error());
      if (loads) return Outcome::kOther;
      tally.remember("%s: taken, and the policy does not load", what.c_str());
    }
    return Outcome::kBad;
  };
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = std::atof(argument(argc, argv, "--seconds", "0").c_str());
  const std::string only = argument(argc, argv, "--only", "");
  struct Job {
    std::string name;
    std::function<Experiment()> make;
  };
  std::vector<Job> jobs;
  for (const World& w : all_worlds()) jobs.push_back({w.name(), [w] { return world_experiment(w); }});
  for (const std::string& a : all_algos())
    jobs.push_back({"agent " + a, [a] { return agent_experiment(a); }});
  std::erase_if(jobs, [&](const Job& j) { return j.name.find(only) == std::string::npos; });
  const double begin = now();
  long passed = 0, failed = 0;
  std::printf("%-44s %8s %8s %8s %8s %8s\n", "changed words", "inputs", "refused", "taken", "wrong", "died");
  for (size_t i = 0; i < jobs.size(); ++i) {
    const double share =
        seconds > 0 ? std::max(0.1, (begin + seconds - now()) / static_cast<double>(jobs.size() - i)) : 0;
    Tally t;
    const auto add = [&](const Tally& more) {
      t.good += more.good;
      t.other += more.other;
      t.bad += more.bad;
      t.crashed += more.crashed;
      if (*more.note) t.remember("%s", more.note);
    };
    if (share > 0) {
      // a coarse sample, strides that meet every value, says how many inputs there are and how many fit
      const double start = now();
      const Tally probe = isolate(0, 1L << 40, 1009, share / 4, 60, jobs[i].make);
      add(probe);
      const double took = std::max(now() - start, 1e-3), left = std::max(share - took, share / 4);
      auto stride = static_cast<long>(1009 * took / left);
      stride = std::max(stride, 1L);
      while (stride % 2 == 0 || stride % 3 == 0 || stride % 5 == 0) ++stride;
      add(isolate(1, 1L << 40, stride, left, 60, jobs[i].make));
    } else {
      add(isolate(0, 1L << 40, 1, 0, 60, jobs[i].make));
    }
    passed += t.good + t.other;
    failed += t.failed();
    std::printf("%-44s %8ld %8ld %8ld %8ld %8ld%s%s\n", jobs[i].name.c_str(), t.run(), t.good, t.other, t.bad,
                t.crashed, *t.note ? "  " : "", t.note);
    std::fflush(stdout);
  }
  std::printf("%ld passed, %ld failed\n", passed, failed);
  return failed != 0;
}
