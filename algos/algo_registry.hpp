// The list of algorithms: how each is described, made and ended.
#pragma once
#include "algos/agent/agent.hpp"
#include "algos/core/algo_row.hpp"
#include "algos/core/resolved_config.hpp"

namespace rdm {

// One per algorithm file.
extern const AlgoRow kPpo, kTrpo, kPpoLag, kTrpoLag, kCppoPid, kCpo, kPcpo, kFocops, kP3o, kIpo, kPdo, kRcpo,
    kCup, kCrpo;
extern const AlgoRow kMappo, kMappoLag, kHappo, kMacpo, kIppo, kIppoLag;
extern const AlgoRow kTd3, kTd3Lag, kTd3Pid, kSac, kSacLag, kSacPid;
extern const AlgoRow kTd3BcLag, kCpq, kBcqLag, kCOptiDice;

// The row of an algorithm whose class is T.
template <class T, class Rows>
constexpr AlgoRow make_algo_row(const char* name, const char* summary, const Rows& options, Costs costs,
                                void (*adapt)(ResolvedAgentConfig&) = nullptr, const AlgoRow* alone = nullptr,
                                bool own_critics = false) {
  AlgoRow row{};
  row.own_critics = own_critics;
  row.adapt = adapt;
  row.alone = alone;
  row.info = {name, summary, options.data(), static_cast<int32_t>(options.size())};
  row.costs = costs;
  row.measure = [](ResolvedAgentConfig&& resolved) -> size_t {
    T agent(std::move(resolved));
    Arena arena;
    agent.carve(arena);
    return sizeof(T) + arena.used();
  };
  row.make = [](const HostHooks& hooks, ResolvedAgentConfig&& resolved) -> Agent* {
    T* agent = host_new<T>(hooks, std::move(resolved));
    return agent;
  };
  row.end = [](Agent* agent) {
    const HostHooks hooks = agent->config().hooks;
    host_delete(hooks, static_cast<T*>(agent));
  };
  return row;
}

}  // namespace rdm
