// `rollout`: plays episodes and writes what happened, a row per control step.
#include <memory>

#include "commands.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/text.hpp"
#include "play/episodes.hpp"

namespace tool {
namespace {

struct RolloutFlags {
  std::string policy = "hold", out;
  PoolSettings pool;
  std::vector<std::string> sets;
  int32_t episodes = 1;
  bool task_given = false;
};

// Rows of one CSV file, kept per episode so that the file is in order of episodes for any number of worlds.
class StepTable {
 public:
  StepTable(const redman::Pool& pool, size_t episodes) : rows_(episodes), steps_(episodes) {
    header_ = "episode,step,reward";
    for (const rdm_cost& c : task_costs(pool.spec().task))
      header_ += std::string(",") + (c.name == std::string("cost") ? "cost" : std::string("cost.") + c.name);
    header_ += ",terminated,truncated,success";
    for (int32_t i = 0; i < pool.spec().num_fields; ++i) {
      rdm_field field;
      redman::check(rdm_pool_field(pool.get(), i, &field));
      if (std::string(field.name).rfind("object", 0) != 0) continue;
      fields_.push_back(field);
      for (int32_t k = 0; k < field.count; ++k) header_ += format(",%s.%d", field.name, k);
    }
  }
  void add(const redman::Pool& pool, size_t env, size_t episode) {
    std::string& out = rows_[episode];
    out += format("%zu,%d,%.9g", episode, ++steps_[episode], static_cast<double>(pool.reward()[env]));
    for (const float c : pool.cost()[env]) out += format(",%.9g", static_cast<double>(c));
    out += format(",%d,%d,%d", pool.terminated()[env], pool.truncated()[env], pool.success()[env]);
    for (const rdm_field& f : fields_)
      for (int32_t k = 0; k < f.count; ++k)
        out += format(",%.9g", static_cast<double>(pool.obs()[env][static_cast<size_t>(f.offset + k)]));
    out += '\n';
  }
  std::string text() const {
    std::string out = header_ + '\n';
    for (const std::string& rows : rows_) out += rows;
    return out;
  }

 private:
  std::string header_;
  std::vector<rdm_field> fields_;  // what the observation says about the object
  std::vector<std::string> rows_;  // [episodes]
  std::vector<int32_t> steps_;     // [episodes]
};

Report run_rollout(RolloutFlags flags) {
  const ActorChoice choice = choose_actor(flags.policy);
  adopt_task(choice, flags.task_given, flags.pool);
  apply_sets(flags.sets, flags.pool, nullptr);
  flags.pool.envs = std::min(flags.pool.envs, flags.episodes);
  redman::Pool pool = make_pool(flags.pool, RDM_AUTORESET_OFF);
  Actor actor(choice, pool);
  std::unique_ptr<StepTable> table;
  if (!flags.out.empty()) table = std::make_unique<StepTable>(pool, static_cast<size_t>(flags.episodes));
  StepObserver observer;
  if (table) observer = [&](size_t env, size_t episode) { table->add(pool, env, episode); };
  pool.reset();
  const auto limits = cost_limits(pool, {});
  const Summary s =
      summarise(play_episodes(pool, actor, static_cast<size_t>(flags.episodes), observer), limits);
  if (table) replace_file(flags.out, table->text());

  const std::string hash = format("%016llx", static_cast<unsigned long long>(pool.hash()));
  Json json = {{"task", task_at(pool.spec().task).name}, {"episodes", flags.episodes},
               {"return_mean", s.return_mean},           {"cost_mean", s.cost_mean},
               {"length_mean", s.length_mean},           {"fall_rate", s.fall_rate},
               {"success_rate", s.success_rate},         {"hash", hash}};
  std::string text = format("%d episodes: return %.4f, cost %.3f, length %.1f, falls %.0f%%\nstate hash %s\n",
                            flags.episodes, s.return_mean, s.cost_mean.empty() ? 0 : s.cost_mean[0],
                            s.length_mean, 100 * s.fall_rate, hash.c_str());
  if (table) {
    json["file"] = flags.out;
    text += "wrote " + flags.out + '\n';
  }
  return {json, text};
}

}  // namespace

void add_rollout(CLI::App& app, Run& run) {
  auto flags = std::make_shared<RolloutFlags>();
  CLI::App* command = app.add_subcommand("rollout", "Play episodes and write a CSV row per control step");
  CLI::Option* task = add_pool_flags(*command, flags->pool, "task; default: the policy's");
  command->add_option("--policy", flags->policy,
                      "policy file, run folder, .demo file, demo, zero, hold or random");
  command->add_option("--episodes", flags->episodes, "episodes")->check(CLI::Range(1, kMostEpisodes));
  command->add_option("--out", flags->out, "CSV file; default: none");
  add_set_flag(*command, flags->sets);
  command->callback([&run, flags, task] {
    flags->task_given = task->count() > 0;
    run = [flags] { return run_rollout(*flags); };
  });
}

}  // namespace tool
