// PPO with a price: the reward's advantage minus each limited cost's times a weight that stays. It keeps no limit by
// itself, and is what a multiplier is compared with.
#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/first_order/ppo.hpp"
#include "algos/lagrange/cost_weighted.hpp"

namespace rdm {
namespace {

struct PriceOptions {
  double price;
};
constexpr auto kPriceRows = option_rows<PriceOptions>(row<&PriceOptions::price>(
    basic(number_option("cost_price", 1, 0, 1e6, "weight of each limited cost's advantage", true))));

class Price {
 public:
  explicit Price(const ResolvedAgentConfig& resolved) { read_live(resolved.options); }
  void step(const JudgedCosts&, int32_t) {}
  double weight(int32_t) const { return options_.price; }
  Mix mix() const { return Mix::kSum; }  // (A_r - sum w A_c) / (1 + sum w)
  bool split() const { return false; }
  void read_live(const Options& options) { options_ = kPriceRows.read(options); }
  void visit(StateIo&) {}

 private:
  PriceOptions options_{};
};

struct PricedOptions : PpoOptions, PriceOptions {};
constexpr auto kPricedRows = option_rows<PricedOptions>(kPpoRows, kPriceRows);

}  // namespace

constinit const AlgoRow kPriced = make_algo_row<CostWeighted<Ppo, Price>>(
    "priced", "PPO on the reward's advantage minus each cost's times a fixed weight", kPricedRows,
    Costs::kAny);

}  // namespace rdm
