// No bytes given to load break an agent: each word of a saved state is replaced by numbers that a program
// never wrote, the section's checksum is mended, and the agent then refuses the state and stays what it was,
// or works on with finite numbers.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "agents.hpp"
#include "algos/algo_registry.hpp"
#include "nn/policy.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

constexpr size_t kFileHeader = 24, kSectionHeader = 16;

template <class T>
T load(const unsigned char* p) {
  T v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

struct Section {
  std::string tag;
  size_t begin, size;  // of the payload
};
std::vector<Section> sections(const std::vector<unsigned char>& file) {
  std::vector<Section> out;
  for (size_t at = kFileHeader; at < file.size();) {
    const auto size = load<uint64_t>(&file[at + 8]);
    out.push_back({std::string(file.begin() + static_cast<ptrdiff_t>(at),
                               file.begin() + static_cast<ptrdiff_t>(at) + 4),
                   at + kSectionHeader, size});
    at += kSectionHeader + size;
  }
  return out;
}

void mend_checksum(std::vector<unsigned char>& file, const Section& s) {
  const uint32_t crc = crc32(file.data() + s.begin, s.size);
  std::memcpy(&file[s.begin - kSectionHeader + 4], &crc, sizeof crc);
}

uint64_t two(float x) {
  const auto half = uint64_t{std::bit_cast<uint32_t>(x)};
  return half << 32 | half;
}
uint64_t two(int32_t x) {
  const auto half = uint64_t{static_cast<uint32_t>(x)};
  return half << 32 | half;
}

// As one double or integer of 64 bits, and as two floats or integers of 32.
std::vector<uint64_t> bad_words() {
  std::vector<uint64_t> words;
  for (const double x : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e308, -1e308, 1e299, 1e60, -1e60, 1e30, -1e30,
                         1e15, 1e-300, -1.0, 0.5, 1.5})
    words.push_back(std::bit_cast<uint64_t>(x));
  for (const int64_t x : {INT64_MAX, INT64_MIN, int64_t{1} << 61, int64_t{INT32_MAX}, int64_t{INT32_MIN},
                          int64_t{-1}, int64_t{16}, int64_t{63}})
    words.push_back(static_cast<uint64_t>(x));
  for (const float x : {std::nanf(""), HUGE_VALF, -HUGE_VALF, 3e38f, -3e38f, 1e20f, -1e20f, 1e-37f})
    words.push_back(two(x));
  for (const int32_t x : {INT32_MAX, INT32_MIN, -1, 1 << 30}) words.push_back(two(x));
  return words;
}

std::vector<double> numbers(const Epoch& e) {
  std::vector<double> out = {
      e.ret,           e.cost_per_step, e.length,     e.fall_rate,   e.success_rate,      e.kl,
      e.entropy,       e.learning_rate, e.action_std, e.loss_policy, e.loss_reward_value, e.loss_cost_value,
      e.clip_fraction, e.value_reward,  e.value_cost};
  out.insert(out.end(), std::begin(e.cost), std::end(e.cost));
  out.insert(out.end(), std::begin(e.multiplier), std::end(e.multiplier));
  return out;
}

// But for what such an agent does not measure, which is NaN in its usual epochs too.
bool finite(const Epoch& e, const Epoch& usual) {
  const std::vector<double> x = numbers(e), same = numbers(usual);
  for (size_t i = 0; i < x.size(); ++i)
    if (!std::isfinite(x[i]) && !(std::isnan(x[i]) && std::isnan(same[i]))) return false;
  return true;
}

bool finite(const float* x, size_t n) {
  for (size_t i = 0; i < n; ++i)
    if (!std::isfinite(x[i])) return false;
  return true;
}

// A small agent of one algorithm whose state has been through epochs, and what happens to it on bad states.
class Victim {
 public:
  explicit Victim(const char* algo, const char* std_mode) : setup_(make_setup(algo, std_mode)) {
    agent_ = setup_.make();
    world_ = std::make_unique<NoiseWorld>(setup_.config);
    for (int i = 0; i < 3; ++i) world_->epoch(*agent_, &usual_);
    good_ = saved(*agent_);
  }
  const std::vector<unsigned char>& good() const { return good_; }

  // "" where the promise was kept, else what was wrong.
  std::string offer(const std::vector<unsigned char>& bytes) {
    const Thrown t = thrown([&] { agent_->load(bytes.data(), bytes.size()); });
    if (t.code == Code::kOk) {
      ++accepted_;
      const std::string wrong = work();
      agent_->load(good_.data(), good_.size());
      return wrong;
    }
    ++refused_;
    if (t.code != Code::kFormat && t.code != Code::kVersion) return "refused with another code: " + t.text;
    if (refused_ % 64 == 0 && saved(*agent_) != good_) return "refused, but something changed: " + t.text;
    return "";
  }
  int64_t accepted() const { return accepted_; }
  int64_t refused() const { return refused_; }

 private:
  static AgentSetup make_setup(const char* algo, const char* std_mode) {
    static const double limits[] = {0.5, 1};
    AgentSetup s(algo, 2, 1, 2);
    s.config.cost_dim = 2;
    s.config.cost_limits = limits;
    s.config.max_steps = 20;
    s.with("hidden", "3").with("horizon", "6").with_known("passes", "1").with_known("minibatches", "1");
    s.with("noise_correlation", "0.3").with_known("lr_schedule", "kl").with("terminal_cost", "on");
    s.with_known("replay_rows", "20").with_known("batch_rows", "4").with_known("start_steps", "0");
    s.with("activation", std::strcmp(std_mode, "state") == 0 ? "elu" : "tanh");
    s.with_known("normalize_reward", "on")
        .with_known("normalize_cost", "on")
        .with_known("std_mode", std_mode);
    s.with("average", "0.5");
    if (algo_row(algo_find(algo)).costs == Costs::kOne) s.with("several_costs", "worst");
    return s;
  }

  // Twice an epoch, the mean action, a policy file and a state that load again.
  std::string work() {
    NoiseWorld world = *world_;
    Agent& a = *agent_;
    const size_t actions = size_of(setup_.config.num_envs) * size_of(setup_.config.action_dim);
    for (int i = 0; i < 2; ++i) {
      Epoch e;
      while (a.missing() > 0) {
        world.decide(a);
        if (!finite(world.action(), actions)) return "a sampled action is not finite";
      }
      a.update(world.obs(), &e);
      if (!finite(e, usual_)) return "an epoch's numbers are not finite";
      if (i == 0 && e.epoch < 1) return "the epoch is " + std::to_string(e.epoch);
      a.act(world.obs(), false, world.action());
      if (!finite(world.action(), actions)) return "a mean action is not finite";
    }
    for (const float x : parameters(a))
      if (!std::isfinite(x)) return "a parameter is not finite";
    const auto policy = policy_file(a);
    const Thrown t =
        thrown([&] { Policy::destroy(Policy::read(policy.data(), policy.size(), HostHooks())); });
    if (t.code != Code::kOk) return "the policy does not load: " + t.text;
    const auto again = saved(a);
    const Thrown u = thrown([&] { a.load(again.data(), again.size()); });
    if (u.code != Code::kOk) return "the state that it saves does not load: " + u.text;
    return "";
  }

  AgentSetup setup_;
  AgentPtr agent_;
  Epoch usual_;
  std::unique_ptr<NoiseWorld> world_;
  std::vector<unsigned char> good_;
  int64_t accepted_ = 0, refused_ = 0;
};

class HostileStates : public testing::TestWithParam<std::tuple<int, const char*>> {
 protected:
  Victim victim() const { return Victim(algo_at(std::get<0>(GetParam())).name, std::get<1>(GetParam())); }
};

}  // namespace

// Algorithms of a family have most of their state in common: the first of each gets every place of it, the others get one
// place in four, each other ones. (hard_words tries all places of all.)
TEST_P(HostileStates, EveryWordOfEverySection) {
  const auto [algo, std_mode] = GetParam();
  Victim v = victim();
  const bool whole = std::strcmp(std_mode, "free") == 0;
  const char* const name = algo_at(algo).name;
  constexpr const char* kFirst[] = {"ppo_lag", "cpo", "macpo", "sac_lag", "td3_pid"};
  const bool first = std::any_of(std::begin(kFirst), std::end(kFirst),
                                 [&](const char* f) { return std::strcmp(f, name) == 0; });
  const size_t thin = first ? 1 : 4;
  const std::vector<uint64_t> words = bad_words();
  int failures = 0;
  for (const Section& s : sections(v.good())) {
    const bool config = s.tag == "CONF", long_list = config || s.tag == "EPIS";
    // What does not differ from the agent whose deviation is free.
    if (!whole && (long_list || s.tag == "COLL" || s.tag == "NOIS")) continue;
    // Numbers stand at odd places behind the texts of the config. Each place gets some of the words, the next
    // place others.
    const size_t stride = config ? 1 : 8, skip = config ? 13 : s.tag == "EPIS" ? 5 : 2;
    for (size_t place = static_cast<size_t>(algo) % thin; (place + 1) * stride <= s.size; place += thin)
      for (size_t i = place % skip; i < words.size(); i += skip) {
        const size_t at = std::min(place * stride, s.size - 8);
        std::vector<unsigned char> bytes = v.good();
        std::memcpy(&bytes[s.begin + at], &words[i], sizeof words[i]);
        mend_checksum(bytes, s);
        const std::string wrong = v.offer(bytes);
        EXPECT_EQ(wrong, "") << s.tag << " + " << at << " word " << std::hex << words[i];
        failures += !wrong.empty();
        ASSERT_LT(failures, 20);
      }
  }
  EXPECT_GT(v.refused(), (whole ? 10000 : 1000) / static_cast<int64_t>(thin));
  EXPECT_GT(v.accepted(), 100 / static_cast<int64_t>(thin));
  RecordProperty("refused", std::to_string(v.refused()));
  RecordProperty("accepted", std::to_string(v.accepted()));
}

// The limited cost that an algorithm of one cost follows is one of those that there are.
TEST(HostileState, TheCostThatIsFollowedExists) {
  for (const auto& [algo, tag] : {std::pair("cpo", "CPO "), {"pcpo", "CPO "}, {"focops", "LAGR"}}) {
    Victim v(algo, "free");
    for (const Section& s : sections(v.good())) {
      if (s.tag != tag) continue;
      for (const int64_t index : {-1, 0, 1, 2, kMaxCosts}) {
        std::vector<unsigned char> bytes = v.good();
        std::memcpy(&bytes[s.begin + s.size - sizeof index], &index, sizeof index);
        mend_checksum(bytes, s);
        const int64_t before = v.accepted();
        EXPECT_EQ(v.offer(bytes), "") << algo;
        EXPECT_EQ(v.accepted() - before, index == 0 || index == 1) << algo << ' ' << index;
      }
    }
    EXPECT_EQ(v.accepted(), 2) << algo;
  }
}

// An agent that was made with a limit keeps one: its critic has a column for it.
TEST(HostileState, TheLimitOfColumnZeroStays) {
  AgentSetup with("ppo_lag", 2, 1, 2), without("ppo", 2, 1, 2);
  with.with("cost_limit", "5");
  without.with("cost_limit", "-1");
  for (AgentSetup* s : {&with, &without}) {
    const AgentPtr a = s->make();
    std::vector<unsigned char> bytes = saved(*a);
    const Section config = sections(bytes)[0];
    const std::string key = "cost_limit", file(bytes.begin(), bytes.end());
    const size_t at = file.find(key) + key.size() + sizeof(uint32_t);
    const auto limit = load<double>(&bytes[at]);
    const double other = limit < 0 ? 5 : -1;
    ASSERT_EQ(limit, s == &with ? 5 : -1);
    std::memcpy(&bytes[at], &other, sizeof other);
    mend_checksum(bytes, config);
    EXPECT_EQ(thrown([&] { a->load(bytes.data(), bytes.size()); }).code, Code::kFormat);
  }
}

// Each algorithm, and those whose deviation may be an output of the network with that too.
std::vector<std::tuple<int, const char*>> victims() {
  std::vector<std::tuple<int, const char*>> all;
  for (int i = 0; i < algo_count(); ++i) {
    all.push_back({i, "free"});
    if (AgentSetup(algo_at(i).name, 1, 1, 1).knows("std_mode")) all.push_back({i, "state"});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(List, HostileStates, testing::ValuesIn(victims()), [](const auto& info) {
  return std::string(algo_at(std::get<0>(info.param)).name) + "_" + std::get<1>(info.param);
});
