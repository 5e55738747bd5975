// A shield as --shield asks for it, between who acts in a pool and its worlds.
#pragma once
#include <cstdint>
#include <redman/shield.hpp>
#include <string>
#include <vector>

#include "common/report.hpp"
#include "play/shield_word.hpp"

namespace tool {

// Since the shield was made, all worlds.
struct ShieldCounts {
  int64_t decisions = 0;
  int64_t interventions =
      0;  // decisions in which another action ran than was proposed, or none is known to be clean
  int64_t unproven = 0;    // of these, the latter
  int64_t inevitable = 0;  // control steps of these that violated
};
// The keys that every command has, and a line of text.
void put_shield(Json& json, const ShieldCounts& counts);
std::string shield_text(const ShieldCounts& counts);

// Of the config's pool, policy and so on; `under`: lines key=value that the word's options are laid over. Usage where they do
// not go together.
redman::Shield make_shield(const ShieldWord& word, const std::string& under, rdm_shield_config config);

class Shielded {
 public:
  // policy: the first backup, which outlives this; a decision is held for as long as one of its. Null: there are action 0 and
  // the hold action alone, and every step of the pool is a decision. of_run: as `under`, of the run that the policy is of.
  Shielded(const ShieldWord& word, const std::string& of_run, const redman::Pool& pool,
           const redman::Policy* policy, uint64_t seed);

  // Episodes begin anew in the worlds of the mask [num_envs] (null: all): a decision is due there.
  void restart(const uint8_t* mask);
  // The pool's rows of actions are what is proposed; those of worlds in the mask become what is to run. Where no decision is
  // due that is what was decided.
  void act(redman::Pool& pool, const uint8_t* mask);
  // Steps the worlds in the mask.
  void step(redman::Pool& pool, const uint8_t* mask);
  // In the last decision of world env.
  bool stepped_in(const redman::Pool& pool, int32_t env) const;
  ShieldCounts counts() const;

 private:
  redman::Shield shield_;
  int32_t steps_ = 1;           // of the pool, that a decision lasts
  std::vector<int32_t> left_;   // [num_envs] of these; 0: a decision is due
  std::vector<uint8_t> due_;    // [num_envs]
  std::vector<float> decided_;  // [num_envs][action_dim]
  std::vector<int32_t> kinds_;  // [num_envs] of the last decisions, RDM_SHIELD_*
  std::vector<uint8_t> step_;   // [num_envs] worlds to step
  int64_t inevitable_ = 0;
};

}  // namespace tool
