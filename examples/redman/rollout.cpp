// `rollout`: plays episodes and writes what happened, control step by control step.
#include <algorithm>
#include <memory>

#include "commands.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/text.hpp"
#include "play/episodes.hpp"
#include "record/recorded_rollout.hpp"
#include "record/recorder.hpp"
#include "teach/noise.hpp"

namespace tool {
namespace {

struct RolloutFlags {
  std::string policy = "hold", out, record, shield = "off";
  PoolSettings pool;
  std::vector<std::string> sets;
  int32_t episodes = 1;
  bool states = false;  // in the record
  double noise = 0;     // mean deviation of what is added to actions
  bool task_given = false, seed_given = false, episodes_given = false;
};

// Rows of one CSV file, kept per episode so that the file is in order of episodes for any number of worlds.
class StepTable {
 public:
  StepTable(const redman::Pool& pool, size_t episodes) : rows_(episodes), steps_(episodes) {
    header_ = "episode,step,reward";
    for (const rdm_cost_info& c : task_costs(pool.spec().task))
      header_ += std::string(",") + (c.name == std::string("cost") ? "cost" : std::string("cost.") + c.name);
    header_ += ",terminated,truncated,success,status";
    for (int32_t i = 0; i < pool.spec().num_fields; ++i) {
      rdm_field_info field = RDM_INIT(rdm_field_info);
      redman::check(rdm_pool_field_at(pool.get(), i, &field));
      if (std::string(field.name).rfind("object", 0) != 0) continue;
      fields_.push_back(field);
      for (int32_t k = 0; k < field.count; ++k) header_ += format(",%s.%d", field.name, k);
    }
  }
  void add(const redman::Pool& pool, size_t env, size_t episode) {
    std::string& out = rows_[episode];
    out += format("%zu,%d,%.9g", episode, ++steps_[episode], static_cast<double>(pool.reward()[env]));
    for (const float c : pool.cost()[env]) out += format(",%.9g", static_cast<double>(c));
    out += format(",%d,%d,%d,%u", pool.terminated()[env], pool.truncated()[env], pool.success()[env],
                  pool.status()[env]);
    for (const rdm_field_info& f : fields_)
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
  std::vector<rdm_field_info> fields_;  // what the observation says about the object
  std::vector<std::string> rows_;       // [episodes]
  std::vector<int32_t> steps_;          // [episodes]
};

// What a recording was played with, for what no flag says.
void adopt_recording(const Recording& r, RolloutFlags& flags) {
  const auto count = static_cast<int32_t>(r.episodes());
  if (flags.seed_given)
    throw Usage("--seed: a recorded rollout starts from its recorded state, so it takes no seed");
  if (!flags.pool.envs_given) flags.pool.envs = r.pool.envs;
  if (!flags.episodes_given) flags.episodes = count;
  if (flags.episodes > count)
    throw Usage(format("--episodes %d: %s has %d", flags.episodes, flags.policy.c_str(), count));
}

Report run_rollout(RolloutFlags flags) {
  check_outputs({{"--out", flags.out, ".csv"}, {"--record", flags.record, kRecordEndings}},
                {{"--policy", flags.policy}});
  ActorChoice choice = choose_actor(flags.policy, flags.pool.task);
  choice.shield = read_shield_word(flags.shield);
  if (choice.shield.on && flags.noise > 0)
    throw Usage(
        "--shield and --noise exclude each other: the shield proves nothing about actions to which noise is "
        "added");
  if (choice.recording) adopt_recording(*choice.recording, flags);
  adopt_task(choice, flags.task_given, flags.sets, flags.pool);
  apply_sets(flags.sets, flags.pool, nullptr);
  say_worlds(flags.pool, flags.episodes);
  flags.pool.envs = std::min(flags.pool.envs, flags.episodes);
  redman::Pool pool = make_pool(flags.pool, RDM_AUTORESET_OFF);
  Actor actor(choice, pool);
  say_idle(flags.sets, flags.pool);
  const auto episodes = static_cast<size_t>(flags.episodes);
  std::unique_ptr<StepTable> table;
  std::unique_ptr<Recorder> recorder;
  if (!flags.out.empty()) table = std::make_unique<StepTable>(pool, episodes);
  if (!flags.record.empty())
    recorder = std::make_unique<Recorder>(flags.record, pool, episodes, flags.states, flags.noise > 0);
  const size_t width = pool.action().width();
  std::vector<float> meant(pool.num_envs() * width);  // a policy's is held for several steps, noise is not
  const auto after = [&](size_t env, size_t episode) {
    if (flags.noise > 0) std::copy_n(meant.data() + env * width, width, pool.action()[env].begin());
    if (table) table->add(pool, env, episode);
    if (recorder) recorder->after(env, episode);
  };
  ActionNoise noise(pool.num_envs(), width, flags.noise, flags.pool.seed);
  StepObserver before = [&](size_t env, size_t episode) {
    if (recorder) recorder->label(env);
    if (flags.noise > 0) {
      noise.draw(env);
      std::copy_n(pool.action()[env].begin(), width, meant.data() + env * width);
      for (size_t j = 0; j < width; ++j) {
        float& a = pool.action()[env][j];
        a = std::clamp(a + noise.row(env)[j], -1.0f, 1.0f);
      }
    }
    if (recorder) recorder->before(env, episode);
  };
  pool.reset();
  const auto limits = cost_limits(pool, {});
  const Summary s = summarise(play_episodes(pool, actor, episodes, after, before), limits);
  actor.check_ends();
  if (table) replace_file(flags.out, table->text());
  // a recording of a replay says who acted at first, so that it can be replayed in turn
  const RecordNote note{choice.recording ? choice.recording->policy : flags.policy, flags.pool.options,
                        flags.pool.seed};
  const uint64_t steps = recorder ? recorder->finish(note) : 0;

  const std::string hash = format("%016llx", static_cast<unsigned long long>(pool.hash()));
  Json json = {{"task", task_at(pool.spec().task).name}, {"episodes", flags.episodes},
               {"return_mean", s.return_mean},           {"cost_mean", s.cost_mean},
               {"length_mean", s.length_mean},           {"fall_rate", s.fall_rate},
               {"success_rate", s.success_rate},         {"hash", hash}};
  put_trouble(json, s.trouble);
  say_trouble(s.trouble, "rollout");
  std::string text = format("%d episodes: return %.4f, cost %.3f, length %.1f, falls %.0f%%\nstate hash %s\n",
                            flags.episodes, s.return_mean, s.cost_mean.empty() ? 0 : s.cost_mean[0],
                            s.length_mean, 100 * s.fall_rate, hash.c_str());
  if (const Shielded* shield = actor.shielded()) {
    json["violating_steps"] = pool.stats().violations;
    put_shield(json, shield->counts());
    text += shield_text(shield->counts());
  }
  if (table) {
    json["file"] = flags.out;
    text += "wrote " + flags.out + '\n';
  }
  if (recorder) {
    if (table) json["table"] = flags.out;
    json["file"] = flags.record;
    json["steps"] = steps;
    text += format("wrote %s, %llu steps\n", flags.record.c_str(), static_cast<unsigned long long>(steps));
  }
  if (choice.recording) json["recorded_hash"] = choice.recording->hash;
  return {json, text};
}

}  // namespace

void add_rollout(CLI::App& app, Run& run) {
  auto flags = std::make_shared<RolloutFlags>();
  CLI::App* command = app.add_subcommand("rollout", "Play episodes and write what happened in them");
  CLI::Option* task = add_pool_flags(*command, flags->pool,
                                     "task, by name or by its file (.task); default: the policy's task");
  command->add_option(
      "--policy", flags->policy,
      "policy file, run folder, .demo file, recorded .npz file, trained, plan, demo, zero, hold or random");
  CLI::Option* episodes =
      command
          ->add_option("--episodes", flags->episodes, "number of episodes; default: 1, or all of a recording")
          ->check(between(1, kMostEpisodes));
  command->add_option("--out", flags->out,
                      "CSV file to write: rewards, costs and the object's observed fields of each step");
  CLI::Option* record = command->add_option("--record", flags->record,
                                            "file to write every step to: numpy arrays (.npz), which "
                                            "--policy can play again, or named columns (.csv)");
  command->add_flag("--record-states", flags->states, "also record the state of the worlds before each step")
      ->needs(record);
  command
      ->add_option("--noise", flags->noise,
                   "mean standard deviation of the noise on the actions, which differs between worlds; of "
                   "four or more worlds "
                   "every fourth has none. A record also has the actions without it, as label")
      ->check(between(0.0, 10.0));
  add_shield_flag(*command, flags->shield);
  add_set_flag(*command, flags->sets);
  command->callback([&run, flags, task, episodes, command] {
    flags->task_given = task->count() > 0;
    flags->episodes_given = episodes->count() > 0;
    flags->seed_given = command->count("--seed") > 0;
    run = [flags] { return run_rollout(*flags); };
  });
}

}  // namespace tool
