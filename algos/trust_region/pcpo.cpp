// PCPO (Yang et al. 2020): the trust region's reward step, then a projection onto the cost limit.
#include "algos/algo_registry.hpp"
#include "algos/trust_region/cpo.hpp"
#include "algos/trust_region/pcpo_projection.hpp"

namespace rdm {
namespace {

struct MetricOptions {
  bool kl;
};
constexpr auto kMetricRows = option_rows<MetricOptions>(row<&MetricOptions::kl, true, false>(basic(
    text_option("projection", "kl", "kl|l2",
                "metric in which the step is projected onto the cost limit: kl (Fisher matrix) or l2"))));

class Pcpo final : public Cpo {
 public:
  explicit Pcpo(ResolvedAgentConfig&& resolved) : Cpo(std::move(resolved)) {}

 protected:
  bool solve(double c) override {
    const TrustRegion& t = region();
    const bool kl = kMetricRows.read(options()).kl;
    const PcpoStep y = project_pcpo({t.q(), t.r(), c, t.delta(), kl ? t.s() : t.bb()});
    nu_ = y.multiplier;
    region().set_step(y.along_x, kl ? -y.multiplier : 0, kl ? 0 : -y.multiplier);
    return false;
  }
};

struct PcpoOptions : CpoOptions, MetricOptions {};
constexpr auto kPcpoRows =
    option_rows<PcpoOptions>(kCpoRows, kMetricRows).with<&TrustOptions::line_search_steps>(100);

}  // namespace

constinit const AlgoRow kPcpo = make_algo_row<Pcpo>(
    "pcpo", "Projection-based constrained policy optimisation (Yang et al. 2020)", kPcpoRows, Costs::kOne);

}  // namespace rdm
