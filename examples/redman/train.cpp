// `train`: a run from flags or from its folder, and how good its policy is in the end.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "commands.hpp"
#include "common/files.hpp"
#include "common/json.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/text.hpp"
#include "play/evaluate.hpp"
#include "run/ranks.hpp"
#include "run/trainer.hpp"

namespace tool {
namespace {

constexpr int32_t kMostBlocks = 64;  // that --ranks sets

struct TrainFlags {
  RunSettings run;
  double steps = 1e6;
  std::vector<std::string> sets, teach_given;                         // the latter: names of settings
  std::string out, resume, start_share = "0", ranks, shield = "off";  // ranks "": none
  bool task_given = false;
  bool steps_given = false, threads_given = false, others_given = false, overwrite = false;
};

// "0.7" or "0.7..0".
void parse_shares(const std::string& text, TeachSettings& teach) {
  const size_t dots = text.find("..");
  const auto share = [&](const std::string& part) {
    double v = 0;
    if (!read_number(part, &v) || !(v >= 0 && v <= 1))
      throw Usage("--start-share " + text + ": it is not a share of 0 to 1, or a range such as 0.7..0");
    return v;
  };
  teach.start_share = share(text.substr(0, dots));
  teach.start_share_end = dots == std::string::npos ? teach.start_share : share(text.substr(dots + 2));
}

// The same for any number of ranks, so that the run is. Fewer worlds than these a block leave lanes of the
// engine and rows of the networks empty; fewer blocks than those leave nothing for ranks to share.
constexpr int32_t kBlockWorlds = 16, kLeastBlocks = 4;

void give_blocks(RunSettings& run) {
  for (const auto& [key, value] : run.agent.options)
    if (same_name(key, "blocks")) return;
  int32_t blocks = 1;
  while (blocks < kMostBlocks && run.pool.envs % (2 * blocks) == 0 &&
         (blocks < kLeastBlocks || run.pool.envs >= 2 * blocks * kBlockWorlds))
    blocks *= 2;
  run.agent.options.emplace_back("blocks", std::to_string(blocks));
}

// What --from sets, and no flag: of the worlds, of how it is taught, and of the algorithm.
void say_taken(const TrainFlags& flags, const TeachSettings& asked, const Options& of_worlds,
               const Options& of_algo) {
  const RunSettings& run = flags.run;
  std::string text = flags.task_given ? "" : " task " + run.pool.task + ';';
  const auto add = [&](const char* what, const Options& options) {
    std::string list;
    for (auto at = options.begin(); at != options.end(); ++at) {
      const auto same = [&](const auto& other) { return same_name(other.first, at->first); };
      const bool set = std::any_of(flags.sets.begin(), flags.sets.end(), [&](const std::string& s) {
        return same_name(s.substr(0, s.find('=')), at->first);
      });
      if (!set && std::none_of(at + 1, options.end(), same)) list += ' ' + at->first + '=' + at->second;
    }
    if (!list.empty()) text += std::string(what) + list + ';';
  };
  Options lesson;
  for (const TeachField& f : kTeachFields) {
    const double before = f.whole ? asked.*f.whole : asked.*f.real,
                 after = f.whole ? run.teach.*f.whole : run.teach.*f.real;
    if (before != after) lesson.emplace_back(f.name, number_text(after));
  }
  add(" options of the task:", of_worlds);
  add(" flags:", lesson);
  add(" options of the algorithm:", of_algo);
  std::fprintf(stderr, "--from %s sets%s --set and flags override these\n", printable(run.teach.from).c_str(),
               printable(text).c_str());
}

Trainer begin_run(TrainFlags flags, const Ranks* ranks) {
  RunSettings& run = flags.run;
  const bool first = !ranks || ranks->first();
  check_outputs({{"--save-recording", run.save_recording, ".npz"}}, {{"--from", run.teach.from}});
  if (run.teach.asked()) {
    parse_shares(flags.start_share, run.teach);
    adopt_teacher(run.teach, flags.task_given, flags.sets, run.pool);
  }
  take_limit_from_sets(run.pool.task, flags.sets, run.limits);
  const Options of_teacher = run.pool.options;
  const TeachSettings asked = run.teach;
  Options of_lesson;
  apply_sets(flags.sets, run.pool, &run.agent);
  if (first) say_budget(run.pool, run.limits);
  run.steps = whole_number(flags.steps, "--steps");
  run.shield = read_shield_word(flags.shield);
  if (run.teach.asked()) {
    if (has_option(run.agent.algo, "replay_rows"))
      throw Usage("--from: " + run.agent.algo +
                  " cannot begin with a teacher; only algorithms without a replay memory can, such as "
                  "--algo ppo_lag. `redman learn` lets it learn from a recording");
    const size_t given = run.agent.options.size();
    for (const Options& options :
         {adopt_lesson(flags.teach_given, run.pool, run.teach), taught_options(run.teach, run.agent.options)})
      run.agent.options.insert(run.agent.options.begin(), options.begin(), options.end());
    need_effect(flags.teach_given, run.pool, run.teach);
    of_lesson.assign(run.agent.options.begin(), run.agent.options.end() - static_cast<std::ptrdiff_t>(given));
  } else if (!std::all_of(flags.teach_given.begin(), flags.teach_given.end(),
                          [](const std::string& name) { return name.rfind("pretrain", 0) == 0; })) {
    throw Usage("these flags need a teacher: give --from");
  }
  if (!run.teach.asked()) need_effect(flags.teach_given, run.pool, run.teach);
  give_eyes(run.agent, run.pool);
  if (ranks && !has_option(run.agent.algo, "blocks"))
    throw Usage("--ranks: " + run.agent.algo +
                " learns in one process; only algorithms without a replay memory learn in several");
  if (ranks) give_blocks(run);
  run.own = own_files(task_at(find_task(run.pool.task)).name);
  if (first && flags.out.empty())
    RunFolder::check_place(RunFolder::default_path(run));
  else if (first)
    RunFolder::check_new(flags.out, flags.overwrite);
  Trainer trainer(run, ranks);  // a wrong value throws here or below, before there is a folder
  if (first) {
    if (run.teach.asked()) say_taken(flags, asked, of_teacher, of_lesson);
    say_idle(flags.sets, run.pool, &run.agent);
    for (const std::string& set : flags.sets)
      if (const std::string key = split_pair(set, "--set").first;
          !run.shield.on && (same_name(key, "shield_learn") || same_name(key, "shield_penalty")))
        std::fprintf(stderr, "--set %s: it has no effect without --shield\n", printable(set).c_str());
  }
  if (!first) {
    trainer.follow("");
    return trainer;
  }
  trainer.prepare();
  trainer.begin(flags.out.empty() ? RunFolder::create_default(run)
                                  : RunFolder::create(flags.out, flags.overwrite));
  return trainer;
}

// Says that a run which goes on here may not come to the bytes that it would have had.
void say_other_build(const std::string& folder, const RunSettings& run) {
  auto b = redman::sized<rdm_build>();
  redman::check(rdm_build_info(&b));
  std::string was, is;
  const auto compare = [&](const char* what, const std::string& before, const char* now) {
    if (before.empty() || before == now) return;
    was += (was.empty() ? "" : ", ") + (what + before);
    is += (is.empty() ? "" : ", ") + (what + std::string(now));
  };
  compare("version ", run.version, b.version);
  compare("kernels ", run.kernels, b.kernels);
  if (!was.empty())
    std::fprintf(stderr, "%s: it was trained with %s, here is %s: results differ from an unbroken run's\n",
                 printable(folder).c_str(), printable(was).c_str(), is.c_str());
}

Trainer go_on(const TrainFlags& flags, const Ranks* ranks) {
  if (flags.others_given)
    throw Usage(
        "--resume takes its settings from the folder; only --steps, --threads and --ranks may change. To "
        "start a new run with other settings from its policy, give --from FOLDER instead");
  std::optional<RunFolder> folder;
  if (!ranks || ranks->first()) folder.emplace(RunFolder::go_on(flags.resume));
  RunSettings run = run_settings(flags.resume);
  if (run.functions)
    throw Failure(
        flags.resume +
        ": its reward or its costs are functions in Python: continue it with redman.train(resume=...) there");
  if (folder) say_other_build(flags.resume, run);
  if (flags.steps_given) run.steps = whole_number(flags.steps, "--steps");
  if (flags.threads_given) run.pool.threads = flags.run.pool.threads;
  Trainer trainer(run, ranks);
  if (folder)
    trainer.resume(std::move(*folder));
  else
    trainer.follow(flags.resume + "/checkpoint.rdm");
  return trainer;
}

Trainer begin_or_resume(const TrainFlags& flags, const Ranks* ranks) {
  return flags.resume.empty() ? begin_run(flags, ranks) : go_on(flags, ranks);
}

// A rank that is not the first: it learns, and ends here.
[[noreturn]] void follow_first(const TrainFlags& flags, Ranks& ranks) {
  int status = 0;
  try {
    begin_or_resume(flags, &ranks).run();
  } catch (const Usage&) {
    status = 2;  // the first rank says it
  } catch (const std::exception& e) {
    std::fprintf(stderr, "redman: rank %d: %s\n", ranks.hooks().rank, printable(e.what()).c_str());
    status = 1;
  }
  std::exit(ranks.end(status));
}

Report train_alone(const TrainFlags& flags, const Ranks* ranks);

// A run ends with an epoch: what is made of another number of steps is said.
void say_steps(const Trainer& trainer) {
  const int64_t asked = trainer.settings().steps, epoch = trainer.steps_per_epoch();
  const int64_t left = std::max<int64_t>(0, asked - trainer.env_steps()), epochs = (left + epoch - 1) / epoch;
  if (left % epoch == 0) return;
  std::fprintf(
      stderr,
      "--steps %lld: a run ends after a whole epoch of up to %lld steps, so it takes up to %lld steps\n",
      static_cast<long long>(asked), static_cast<long long>(epoch),
      static_cast<long long>(trainer.env_steps() + epochs * epoch));
}

Report run_train(const TrainFlags& flags) {
  if (flags.ranks.empty()) return train_alone(flags, nullptr);
  const auto ranks = Ranks::begin(flags.ranks);
  if (!ranks->first()) follow_first(flags, *ranks);
  const auto learned = [&] {
    try {
      return train_alone(flags, ranks.get());
    } catch (...) {
      ranks->end(1);
      throw;
    }
  };
  Report report = learned();
  if (ranks->end(0) != 0) throw Failure("--ranks: a rank ended with an error");
  return report;
}

Json whole_or_null(double x) {
  return std::isnan(x) ? Json() : Json(static_cast<int64_t>(x));
}

double first_cost(const Summary& s) {
  return s.cost_mean.empty() ? 0 : s.cost_mean[0];
}

// What violated, and what the shield did, in training and afterwards; `shielded`: the same evaluation under it.
void put_shields(Json& json, const Trainer& trainer, const Evaluation& bare, const Evaluation& shielded) {
  json["violating_steps"] = bare.violating_steps;
  json["training_violating_steps"] = whole_or_null(trainer.total("Metrics/Violations"));
  if (!shielded.shield) return;
  json["training_interventions"] = whole_or_null(trainer.total("Shield/Refused"));
  json["training_unproven"] = whole_or_null(trainer.total("Shield/Unproven"));
  json["training_inevitable_steps"] = whole_or_null(trainer.total("Shield/Inevitable"));
  put_shield(json, *shielded.shield);
  const Summary& s = shielded.summary;
  json["shielded"] = {{"return", s.return_mean},
                      {"cost", first_cost(s)},
                      {"success_rate", s.success_rate},
                      {"violating_steps", shielded.violating_steps}};
  put_shield(json["shielded"], *shielded.shield);
}

std::string shields_text(const Json& json, const Evaluation& shielded) {
  const Summary& s = shielded.summary;
  return format("under the shield: return %.3f, cost %.3f, success %.0f%%\n", s.return_mean, first_cost(s),
                100 * s.success_rate) +
         shield_text(*shielded.shield) + "in training: " + json["training_violating_steps"].dump() +
         " violating steps, of which " + json["training_inevitable_steps"].dump() + " were inevitable; " +
         json["training_interventions"].dump() + " interventions, in " + json["training_unproven"].dump() +
         " nothing was known to be clean\n";
}

// Of one process, or the first of several.
Report train_alone(const TrainFlags& flags, const Ranks* ranks) {
  Trainer trainer = begin_or_resume(flags, ranks);
  std::fprintf(stderr, "training in %s\n", printable(trainer.folder().path()).c_str());
  say_steps(trainer);
  trainer.run();

  const RunSettings& run = trainer.settings();
  PoolSettings settings = run.pool;
  settings.seed += Trainer::kEvalSeed;
  settings.envs = kEvalEnvs;
  settings.magnitudes = learns_magnitudes(run.agent);
  ActorChoice choice = choose_actor(trainer.folder().policy());
  const Evaluation e = evaluate(choice, settings, choice.limits, kEvalEpisodes, false);
  choice.shield = run.shield;
  const Evaluation shielded =
      run.shield.on ? evaluate(choice, settings, choice.limits, kEvalEpisodes, false) : Evaluation{};
  const Summary& s = e.summary;
  say_trouble(trainer.trouble(), "training");
  say_trouble(s.trouble, "evaluation");
  const bool safe = feasible(s, e.limits);
  const double cost = first_cost(s), limit = e.limits.empty() ? -1 : e.limits[0];
  Json json = {{"run", trainer.folder().path()},
               {"policy", trainer.folder().policy()},
               {"env_steps", trainer.env_steps()},
               {"wall_seconds", trainer.seconds()},
               {"steps_per_second", trainer.steps_per_second()},
               {"return", s.return_mean},
               {"cost", cost},
               {"cost_stderr", s.cost_stderr},
               {"success_rate", s.success_rate},
               {"cost_limit", limit < 0 ? Json() : Json(limit)},
               {"cost_signal", e.magnitudes ? "raw" : "flag"},
               {"feasible", safe},
               {"fall_rate", s.fall_rate},
               {"length", s.length_mean},
               {"interrupted", trainer.interrupted()}};
  json["return_stderr"] = s.return_stderr;
  json["violation_rate"] = s.violation_rate;
  put_spread(json, e.spread);
  put_trouble(json, s.trouble);
  put_trouble(json, trainer.trouble(), "training_");
  put_shields(json, trainer, e, shielded);
  if (trainer.taught().cloned) {
    const rdm_clone_report& c = trainer.taught().report;
    json["clone"] = {{"rows", c.train_rows},
                     {"epochs", c.epochs},
                     {"loss", c.train_loss},
                     {"validation_loss", c.validation_loss}};
  }
  if (trainer.taught().pretrained) {
    const rdm_pretrain_report& c = trainer.taught().pretraining;
    json["pretrain"] = {{"clouds", c.train_rows},
                        {"loss", c.validation_loss},
                        {"accuracy", c.accuracy},
                        {"most_common", c.most_common}};
  }
  std::string text = format("run      %s\npolicy   %s\n", trainer.folder().path().c_str(),
                            trainer.folder().policy().c_str());
  text += format("steps    %lld in %.1f s, %.0f steps/s\n", static_cast<long long>(trainer.env_steps()),
                 trainer.seconds(), trainer.steps_per_second());
  text += format(
      "policy over %d episodes: return %s, cost %s%s (limit %s), %s; success %.0f%%, falls %.0f%%, length "
      "%.0f\n",
      kEvalEpisodes, measured(s.return_mean, s.return_stderr).c_str(),
      measured(cost, s.cost_stderr.empty() ? 0 : s.cost_stderr[0]).c_str(),
      e.magnitudes ? " in magnitudes" : "", limit < 0 ? "none" : number_text(limit).c_str(),
      safe ? "feasible" : "not feasible", 100 * s.success_rate, 100 * s.fall_rate, s.length_mean);
  if (shielded.shield) text += shields_text(json, shielded);
  return {json, text};
}

}  // namespace

namespace {

std::vector<CLI::Option*> add_teach_flags(CLI::App& command, RunSettings& run, std::string& start_share) {
  TeachSettings& t = run.teach;
  command.add_option("--from", t.from,
                     "what to learn from first: demo, or a .demo or .npz file, is cloned; trained, a policy "
                     "file or a run folder is the start. It sets options of worlds and algorithm, which "
                     "are printed; --set overrides them");
  std::vector<CLI::Option*> out;
  for (const TeachField& f : kTeachFields) {
    const std::string flag = std::string("--") + f.name;
    CLI::Option* o =
        f.whole ? command.add_option(flag, t.*f.whole, f.help) : command.add_option(flag, t.*f.real, f.help);
    out.push_back(o->check(between(f.least, f.most)));
  }
  out.push_back(
      command.add_flag("--success-only", t.success_only, "leave out the teacher's episodes without success"));
  out.push_back(command.add_option(
      "--start-share", start_share,
      "share of episodes that start from a recorded state: 0.7, or 0.7..0 to fall over the run"));
  out.push_back(command.add_option("--save-recording", run.save_recording,
                                   "file (.npz) to which the teacher's rows are written"));
  return out;
}

// Titles of the flags that few runs need, in the help.
constexpr char kRunGroup[] = "Run folder and processes";
constexpr char kImitationGroup[] = "Imitation before learning";

}  // namespace

void add_train(CLI::App& app, Run& run) {
  auto flags = std::make_shared<TrainFlags>();
  RunSettings& r = flags->run;
  r.pool.envs = 64;
  CLI::App* command =
      app.add_subcommand("train", "Train a policy and write it into a run folder, or continue a run");
  std::vector<CLI::Option*> others = {
      add_task_flag(*command, r.pool.task, "--task,--env-id", "task, by name or by its file (.task)"),
      command->add_option("--algo", r.agent.algo, "algorithm")};
  CLI::Option* steps = command->add_option("--steps,--total-steps", flags->steps,
                                           "number of control steps, summed over all worlds");
  others.push_back(
      command->add_option("--out", flags->out, "run folder; default runs/<algo>-{<task>}/seed-<n>-<time>"));
  add_set_flag(*command, flags->sets);
  add_cost_limit_flag(*command, r.limits);
  others.push_back(
      command->add_option("--envs,--num-envs", r.pool.envs, "number of worlds that are simulated together"));
  CLI::Option* threads =
      command->add_option("--threads", r.pool.threads, "number of threads; 0: the calling thread alone");
  others.push_back(
      command->add_option("--seed", r.pool.seed, "seed of the worlds, the initial weights and the noise"));
  others.push_back(add_shield_flag(*command, flags->shield));
  command->add_option("--resume", flags->resume,
                      "run folder to continue from its last checkpoint. Ctrl-C ends a run after its epoch, "
                      "with a checkpoint; a second Ctrl-C ends it at once");
  others.push_back(command->add_option("--eval-every", r.eval_every, "number of epochs between evaluations")
                       ->check(at_least(1))
                       ->group(kRunGroup));
  others.push_back(
      command->add_option("--checkpoint-every", r.checkpoint_every, "number of epochs between checkpoints")
          ->check(at_least(1))
          ->group(kRunGroup));
  command
      ->add_option(
          "--ranks", flags->ranks,
          "processes that learn as one: N on this machine, or mpi under mpirun; sets the option blocks")
      ->group(kRunGroup);
  others.push_back(command->get_option("--cost-limit"));
  others.push_back(command->get_option("--set"));
  others.push_back(command
                       ->add_flag(
                           "--no-tensorboard", [&r](int64_t) { r.events = false; },
                           "do not write the learning curve for TensorBoard")
                       ->group(kRunGroup));
  others.push_back(
      command->add_flag("--overwrite", flags->overwrite, "start again in a folder that already holds a run")
          ->needs("--out")
          ->group(kRunGroup));
  const std::vector<CLI::Option*> taught = add_teach_flags(*command, r, flags->start_share);
  others.push_back(command->get_option("--from"));
  others.insert(others.end(), taught.begin(), taught.end());
  for (CLI::Option* o : taught) o->group(kImitationGroup);
  command->get_option("--from")->group(kImitationGroup);
  command->callback([&run, flags, threads, steps, others, taught] {
    flags->task_given = others.front()->count() > 0;
    for (const CLI::Option* o : taught)
      if (o->count() > 0) flags->teach_given.push_back(o->get_name().substr(2));
    flags->threads_given = threads->count() > 0;
    flags->steps_given = steps->count() > 0;
    for (const CLI::Option* o : others) flags->others_given |= o->count() > 0;
    run = [flags] { return run_train(*flags); };
  });
}

}  // namespace tool
