// States of agents, of every algorithm: what loads acts, learns an epoch and gives a policy that loads; what
// does not load changes nothing.
#include "fuzz.hpp"

namespace hard {
namespace {

struct Subject {
  AgentOf agent;
  Bytes fresh, trained;
};

std::vector<Subject>& subjects() {
  static auto* all = [] {
    const std::vector<std::string> algos = all_algos();
    auto* out = new std::vector<Subject>(algos.size());
    for (size_t i = 0; i < algos.size(); ++i) {
      Subject& s = (*out)[i];
      HARD_REQUIRE(s.agent.make(algos[i]) == RDM_OK, "%s", rdm_last_error());
      s.fresh = s.agent.state();
      HARD_REQUIRE(s.agent.epoch() == RDM_OK, "%s", rdm_last_error());
      s.trained = s.agent.state();
    }
    return out;
  }();
  return *all;
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> out;
  for (size_t i = 0; i < subjects().size(); ++i) {
    out.push_back(with_pick(i, subjects()[i].fresh));
    out.push_back(with_pick(i, subjects()[i].trained));
  }
  return out;
}

void whole(unsigned char* data, size_t size) {
  if (size > 1) mend(data + 1, size - 1);
}
size_t fixed_bytes() {
  return 1 + kFileHead;
}

void one(const unsigned char* data, size_t size) {
  if (size == 0) return;
  Subject& s = subjects()[pick(data, size, subjects().size())];
  rdm_agent* a = s.agent.handle;
  const rdm_result r = rdm_agent_read_state(a, data + 1, size - 1);
  if (r != RDM_OK) {
    require_refusal(r);
    static unsigned n = 0;
    if (++n % 16 == 0) HARD_REQUIRE(s.agent.state() == s.trained, "a load that failed changed the agent");
    return;
  }
  const Bytes policy = s.agent.policy();
  rdm_policy* p = nullptr;
  HARD_REQUIRE(rdm_policy_read(&p, policy.data(), policy.size()) == RDM_OK, "a policy does not load: %s",
               rdm_last_error());
  rdm_policy_destroy(p);
  // An epoch takes longer than all the rest: every fourth of what is taken learns one.
  static unsigned taken = 0;
  const rdm_result e = ++taken % 4 == 0 ? s.agent.epoch() : RDM_OK;
  if (e != RDM_OK) require_refusal(e);
  HARD_REQUIRE(rdm_agent_read_state(a, s.trained.data(), s.trained.size()) == RDM_OK, "%s", rdm_last_error());
}

}  // namespace hard
