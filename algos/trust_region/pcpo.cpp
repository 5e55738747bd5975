// PCPO (Yang et al. 2020): the trust region's reward step, then a projection onto the cost limit.
#include <cstring>

#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/trust_region/cpo.hpp"
#include "algos/trust_region/pcpo_projection.hpp"

namespace rdm {
namespace {

class Pcpo final : public Cpo {
 public:
  explicit Pcpo(ResolvedAgentConfig&& resolved) : Cpo(std::move(resolved)) {}

 protected:
  bool solve(double c) override {
    const TrustRegion& t = region();
    const bool kl = std::strcmp(options().text("projection"), "kl") == 0;
    const PcpoStep y = project_pcpo({t.q(), t.r(), c, t.delta(), kl ? t.s() : t.bb()});
    nu_ = y.multiplier;
    region().set_step(y.along_x, kl ? -y.multiplier : 0, kl ? 0 : -y.multiplier);
    return false;
  }
};

constexpr std::array kProjectionOptions = {
    basic(text_option("projection", "kl", "kl|l2",
                      "metric in which the step is projected onto the cost limit")),
};
constexpr auto kPcpoTable =
    with_defaults(with_defaults(join_options(kSharedOptions, kTrustOptions, kViolationOptions,
                                             kOneCostOptions, kWindowOptions, kProjectionOptions),
                                kTrustDefaults),
                  {OtherDefault{"line_search_steps", 100}});

}  // namespace

constinit const AlgoRow kPcpo = make_algo_row<Pcpo>(
    "pcpo", "Projection-based constrained policy optimisation (Yang et al. 2020)", kPcpoTable, Costs::kOne);

}  // namespace rdm
