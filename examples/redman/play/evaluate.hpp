// An evaluation as `eval` and the end of `train` make it: so many episodes on the mean action.
#pragma once
#include <optional>

#include "common/report.hpp"
#include "play/episodes.hpp"
#include "play/spread.hpp"

namespace tool {

struct Evaluation {
  std::string task;
  std::vector<double> limits;  // [cost_dim], < 0: none
  std::vector<std::string> costs;
  Summary summary;
  Spread spread;
  int64_t violating_steps = 0;         // in which column 0 or a limited one was above 0
  std::optional<ShieldCounts> shield;  // what it did, where there is one
  bool magnitudes = false;             // what costs are sums of
};

inline constexpr int32_t kEvalEnvs = 16, kEvalEpisodes = 100;

// `limits` are texts of --cost-limit. settings.envs is lowered to the number of episodes.
Evaluation evaluate(const ActorChoice& choice, PoolSettings settings, const std::vector<std::string>& limits,
                    int32_t episodes, bool stochastic);
// Of episodes that `actor` has played in the pool, which was made for them.
void finish_evaluation(Evaluation& e, const redman::Pool& pool, const Actor& actor,
                       const std::vector<Episode>& episodes);
// Its keys, as `eval`, `plan` and `baseline` print them, and its text.
Json evaluation_json(const Evaluation& e, int32_t episodes);
std::string evaluation_text(const Evaluation& e, int32_t episodes);

}  // namespace tool
