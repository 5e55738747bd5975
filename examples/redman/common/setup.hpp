// From flags to pools and agents: options, cost limits, sizes.
#pragma once
#include <redman/redman.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/report.hpp"

// CLI11's header is large: only those who read flags include it.
namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

struct rdm_ranks;

namespace tool {

using Options = std::vector<std::pair<std::string, std::string>>;  // key, value as text

// "key=value" in two. Usage that names the flag when there is no '=' or no key.
std::pair<std::string, std::string> split_pair(const std::string& text, const char* flag);
// Options of one list: what is given twice contradicts itself, and one of the two would go unheard.
class GivenOnce {
 public:
  void add(const std::string& key,
           const std::string& where);  // Usage, which begins with `where`, for a second one

 private:
  std::vector<std::string> keys_;
};
// The list as the ABI takes it; borrows from `options`.
std::vector<rdm_option> raw_options(const Options& options);

// What decides a pool, apart from how it is used.
struct PoolSettings {
  std::string task = "hand_over_safe_finger";
  int32_t envs = 1, threads = 0;
  uint64_t seed = 0;
  Options options;  // of the task
  // Evaluations count what an agent with cost_signal=raw learns: sums of cost_raw where it is above 0.
  bool magnitudes = false;
  bool envs_given = false;  // by a flag
};

struct AgentSettings {
  std::string algo = "ppo_lag";
  Options options;
};
// A policy that sees `points` of each world, in colour or not (a flag's text), at a decision every `repeat`
// control steps: the pool's options for that, under those that the user gave.
void give_eyes(int32_t points, int32_t repeat, const std::string& color, PoolSettings& pool);
// The same for an agent that has option encoder; nothing for others.
void give_eyes(const AgentSettings& agent, PoolSettings& pool);
bool learns_magnitudes(const AgentSettings& agent);
// A pool in which costs are counted: single control steps for magnitudes, since a pool shows cost_raw of a
// step's last one alone. Actors hold actions, so the episodes are the same.
PoolSettings counted(PoolSettings pool);

// Refuses what is above `most`, and what is no number: CLI11's own checks let nan pass.
CLI::Validator finite_to(double most);

// Flags that several subcommands share. The first returns --task.
// --robot, --object and --task (which it returns): names, or files of one's own.
CLI::Option* add_task_flag(CLI::App& command, std::string& task, const char* names, const char* help);
void add_envs_flag(CLI::App& command, PoolSettings& pool);
CLI::Option* add_pool_flags(CLI::App& command, PoolSettings& pool, const char* task_help);
CLI::Option* add_set_flag(CLI::App& command, std::vector<std::string>& sets);
void add_cost_limit_flag(CLI::App& command, std::vector<std::string>& limits);

// Gives each "key=value" to the table that knows the key: the task's, or, when `agent` is not null, the
// algorithm's. Of a key that both know, such as preset, the value decides: the one that has this word. Usage with
// the nearest known key when no table has it, to which `more` of the key is added, and for a key that is given twice.
void apply_sets(const std::vector<std::string>& sets, PoolSettings& pool, AgentSettings* agent,
                std::string (*more)(const std::string& key) = nullptr);

// Usage where texts of --set give an option that is a flag of the command, "--points" of points.
void refuse_flags(const std::vector<std::string>& sets, std::initializer_list<const char*> keys);
// Says which texts of --set do nothing, because the option that they belong to is off, and which robots of --robot no option
// names.
void say_idle(const std::vector<std::string>& sets, const PoolSettings& pool,
              const AgentSettings* agent = nullptr);
// Says so where more worlds were asked for than there are episodes, of which each is played in one.
void say_worlds(const PoolSettings& pool, int32_t episodes);
// Moves the option cost_limit of an algorithm, the limit on column 0 of the task, from texts of --set to those of --cost-limit.
// Usage where both give one.
void take_limit_from_sets(const std::string& task, std::vector<std::string>& sets,
                          std::vector<std::string>& limits);
// Whether a text of --cost-limit is for the task's column 0.
bool limits_first(const std::string& task, const std::string& text);
// Usage where texts of --cost-limit give one column of the task two.
void need_one_limit_each(const std::string& task, const std::vector<std::string>& limits);
// Of a flag that takes 1e6 too; Usage for a fraction and outside of 1 .. 2^53.
int64_t whole_number(double value, const std::string& flag);
// Says so where texts of --cost-limit leave the limit of option `budget` as it is.
void say_budget(const PoolSettings& pool, const std::vector<std::string>& limits);

// Makes the worlds, or the agent for them; Usage when a name or a value is wrong.
redman::Pool make_pool(const PoolSettings& settings, int32_t autoreset);
// ranks: the agent is one of them; null: alone.
redman::Agent make_agent(const AgentSettings& settings, const redman::Pool& pool,
                         const std::vector<double>& limits, uint64_t seed, int32_t threads,
                         const rdm_ranks* ranks = nullptr);
bool has_option(const std::string& algo, const char* wanted);

// [cost_dim] limits: the task's own, with "40" (column 0) or "name=3" of each text laid over. < 0: none.
std::vector<double> cost_limits(const redman::Pool& pool, const std::vector<std::string>& texts);

// The library's text with the tool's flags where that names members of its structs, or its functions: "num_envs: 0 is outside ...".
std::string with_flags(std::string text);
// Calls f; a wrong argument, range or name becomes Usage.
template <class F>
auto as_usage(F&& f) {
  try {
    return f();
  } catch (const redman::Error& e) {
    const rdm_result r = e.code();
    if (r == RDM_ERROR_ARGUMENT || r == RDM_ERROR_RANGE || r == RDM_ERROR_NOT_FOUND ||
        r == RDM_ERROR_UNSUPPORTED)
      throw Usage(e.what());
    throw;
  }
}

}  // namespace tool
