#include "agents.hpp"
#include "algos/core/fingerprint.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

constexpr char kMagic[8] = {'T', 'E', 'S', 'T', 'T', 'E', 'S', 'T'};
const double kLimits[] = {10, 20};

AgentSetup base() {
  AgentSetup s("ppo_lag", 4, 2, 8);
  s.config.cost_dim = 2;
  s.config.cost_limits = kLimits;
  return s;
}

Thrown exchange(AgentSetup& from, ResolvedAgentConfig& to, bool apply = false) {
  std::vector<unsigned char> bytes(10000);
  Writer out(bytes.data(), bytes.size());
  out.begin_file(kMagic, 1);
  write_fingerprint(out, resolve_config(from.ready()));
  out.end_file();
  return thrown([&] {
    Reader in(bytes.data(), out.size(), "test");
    in.begin_file(kMagic, 1);
    read_fingerprint(in, to, apply);
  });
}

void expect_refused(AgentSetup from, const char* word) {
  AgentSetup here = base();
  ResolvedAgentConfig resolved = resolve_config(here.ready());
  const Thrown t = exchange(from, resolved);
  EXPECT_EQ(t.code, Code::kFormat) << word;
  EXPECT_NE(t.text.find(word), std::string::npos) << t.text;
}

}  // namespace

TEST(Fingerprint, SameConfigPasses) {
  AgentSetup a = base(), b = base();
  b.config.seed = 77;
  b.config.num_threads = 4;
  ResolvedAgentConfig resolved = resolve_config(b.ready());
  EXPECT_EQ(exchange(a, resolved).code, Code::kOk);
}

TEST(Fingerprint, TheFieldThatDiffersIsNamed) {
  AgentSetup s = base();
  s.config.obs_dim = 5;
  expect_refused(s, "obs_dim");
  s = base();
  s.config.num_envs = 9;
  expect_refused(s, "num_envs");
  s = base();
  s.config.algo = "ppo";
  expect_refused(s, "ppo");
  const double other[] = {10, 21}, fewer[] = {10, -1};
  s = base();
  s.config.cost_limits = other;
  expect_refused(s, "column 1");
  s = base();
  s.config.cost_limits = fewer;
  expect_refused(s, "limited costs");
  s = base();
  expect_refused(s.with("hidden", "32"), "option hidden is '32' in it, but '64,64' in this agent");
  s = base();
  expect_refused(s.with("passes", "3"), "option passes is 3 in it, but 10 in this agent");
}

TEST(Fingerprint, LiveOptionsAreTakenOver) {
  AgentSetup a = base(), b = base();
  a.with("learning_rate", "0.005").with("cost_limit", "33");
  ResolvedAgentConfig resolved = resolve_config(b.ready());
  EXPECT_EQ(exchange(a, resolved).code, Code::kOk);
  EXPECT_EQ(resolved.options.number("learning_rate"), 3e-4);
  EXPECT_EQ(exchange(a, resolved, true).code, Code::kOk);
  EXPECT_EQ(resolved.options.number("learning_rate"), 0.005);
  EXPECT_EQ(resolved.options.number("cost_limit"), 33);
}
