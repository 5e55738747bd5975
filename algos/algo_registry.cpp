#include "algos/algo_registry.hpp"

#include <iterator>

#include "algos/core/option_tables.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

const AlgoRow* const kRows[] = {
    &kPpo, &kTrpo,   &kPpoLag, &kTrpoLag, &kCppoPid, &kCpo,      &kPcpo,     &kFocops, &kP3o,    &kIpo,
    &kPdo, &kRcpo,   &kCup,    &kCrpo,    &kMappo,   &kMappoLag, &kHappo,    &kMacpo,  &kIppo,   &kIppoLag,
    &kTd3, &kTd3Lag, &kTd3Pid, &kSac,     &kSacLag,  &kSacPid,   &kTd3BcLag, &kCpq,    &kBcqLag, &kCOptiDice,
};

}  // namespace

int32_t algo_count() {
  return static_cast<int32_t>(std::size(kRows));
}

const AlgoRow& algo_row(int32_t index) {
  if (index < 0 || index >= algo_count())
    fail(Code::kRange, "algorithm index: %d is outside [0, %d]", index, algo_count() - 1);
  return *kRows[index];
}

const AlgoInfo& algo_at(int32_t index) {
  return algo_row(index).info;
}

int32_t algo_find(const char* name) {
  if (!name) fail(Code::kArgument, "algo is NULL");
  const char* names[std::size(kRows)];
  for (int32_t i = 0; i < algo_count(); ++i) {
    names[i] = kRows[i]->info.name;
    if (same_name(names[i], name)) return i;
  }
  fail(Code::kNotFound, "algo %s: unknown%s", Quoted(name).text, Nearest(name, names, algo_count()).text);
}

}  // namespace rdm
