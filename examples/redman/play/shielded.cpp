#include "play/shielded.hpp"

#include <algorithm>

#include "common/setup.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

rdm_shield_config config_of(const ShieldWord& word, const redman::Pool& pool, const redman::Policy* policy,
                            uint64_t seed) {
  auto config = redman::shield_config(pool, word.predicts ? policy : nullptr);
  config.seed = seed;
  if (policy) config.steps = policy->info().action_repeat / pool.spec().action_repeat;
  return config;
}

}  // namespace

ShieldCounts Shielded::counts() const {
  const rdm_shield_stats s = shield_.stats();
  return {s.decisions, s.changed + s.planned + s.projected + s.unproven, s.unproven, inevitable_};
}

void put_shield(Json& json, const ShieldCounts& c) {
  json["decisions"] = c.decisions;
  json["interventions"] = c.interventions;
  json["unproven"] = c.unproven;
  json["inevitable_steps"] = c.inevitable;
}

std::string shield_text(const ShieldCounts& c) {
  return format(
      "shield: it intervened in %lld of %lld decisions; in %lld of them no clean way was found, which made "
      "%lld violating steps inevitable\n",
      static_cast<long long>(c.interventions), static_cast<long long>(c.decisions),
      static_cast<long long>(c.unproven), static_cast<long long>(c.inevitable));
}

redman::Shield make_shield(const ShieldWord& word, const std::string& under, rdm_shield_config config) {
  const std::string settings = under + word.settings;
  config.settings = settings.c_str();
  if (rdm_guard guard = RDM_INIT(rdm_guard);
      !word.predicts && rdm_pool_guard_at(config.pool, 0, &guard, nullptr) != RDM_OK)
    throw Usage(
        "--shield " + word.word +
        ": the task declares no guards, because its costs do not depend on the action alone; give predict");
  try {
    return as_usage([&] { return redman::Shield(config); });
  } catch (const Usage& e) {
    throw Usage("--shield " + word.word + ": " + e.what());
  }
}

// Nobody learns: of clean ways the best, and what must go on goes on.
Shielded::Shielded(const ShieldWord& word, const std::string& of_run, const redman::Pool& pool,
                   const redman::Policy* policy, uint64_t seed)
    : shield_(
          make_shield(word, "choose=best\nunproven=least\n" + of_run, config_of(word, pool, policy, seed))),
      left_(pool.num_envs()),
      due_(pool.num_envs()),
      decided_(pool.num_envs() * pool.action().width()),
      kinds_(pool.num_envs()),
      step_(pool.num_envs()) {
  if (policy) steps_ = policy->info().action_repeat / pool.spec().action_repeat;
}

void Shielded::restart(const uint8_t* mask) {
  for (size_t i = 0; i < left_.size(); ++i)
    if (!mask || mask[i]) left_[i] = 0;
}

void Shielded::act(redman::Pool& pool, const uint8_t* mask) {
  const size_t width = pool.action().width();
  bool any = false;
  for (size_t i = 0; i < left_.size(); ++i) {
    due_[i] = (!mask || mask[i]) && left_[i] == 0;
    any |= due_[i] != 0;
  }
  if (any) shield_.act(pool, pool.action().data(), decided_.data(), due_.data());
  for (size_t i = 0; i < left_.size(); ++i) {
    if (mask && !mask[i]) continue;
    std::copy_n(decided_.data() + i * width, width, pool.action()[i].begin());
    left_[i] = (due_[i] ? steps_ : left_[i]) - 1;
  }
}

// Worlds of unproven decisions first and alone, for a pool counts the violations of all worlds in one number.
void Shielded::step(redman::Pool& pool, const uint8_t* mask) {
  shield_.kinds(kinds_.data());
  for (const bool unproven : {true, false}) {
    for (size_t i = 0; i < step_.size(); ++i)
      step_[i] = (!mask || mask[i]) && (kinds_[i] == RDM_SHIELD_UNPROVEN) == unproven;
    if (std::find(step_.begin(), step_.end(), 1) == step_.end()) continue;
    const int64_t before = unproven ? pool.stats().violations : 0;
    pool.step(step_.data());
    if (unproven) inevitable_ += pool.stats().violations - before;
  }
}

bool Shielded::stepped_in(const redman::Pool& pool, int32_t env) const {
  return shield_.row(pool, env).kind != RDM_SHIELD_OWN;
}

}  // namespace tool
