#include "run/trainer.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "common/clock.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/posix.hpp"
#include "common/setting.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

std::atomic<int> g_signals{0};
std::atomic<rdm_agent*> g_agent{nullptr};
std::atomic<bool> g_says{false};  // whether a signal is answered: by one of several ranks

// The first signal ends the run after this epoch, whose end can be continued bit for bit; the second at once.
extern "C" void on_signal(int number) {
  std::signal(number, on_signal);  // some systems take the handler away
  if (g_signals.fetch_add(1) > 0) return rdm_agent_cancel(g_agent.load());
  constexpr char kText[] = "\nstopping after this epoch; a second signal stops at once\n";
  const int kept = errno;  // of the call that is interrupted
  if (g_says && write(STDERR_FILENO, kText, sizeof kText - 1) < 0) errno = kept;
  errno = kept;
}

class SignalScope {
 public:
  SignalScope(rdm_agent* agent, bool says) {
    g_agent = agent;
    g_says = says;
    g_signals = 0;
    old_int_ = std::signal(SIGINT, on_signal);
    old_term_ = std::signal(SIGTERM, on_signal);
  }
  ~SignalScope() {
    std::signal(SIGINT, old_int_);
    std::signal(SIGTERM, old_term_);
    g_agent = nullptr;
  }
  SignalScope(const SignalScope&) = delete;
  SignalScope& operator=(const SignalScope&) = delete;

 private:
  using Handler = void (*)(int);
  Handler old_int_, old_term_;
};

PoolSettings eval_settings(const RunSettings& run) {
  PoolSettings s = run.pool;
  s.envs = static_cast<int32_t>(kSelectionEpisodes);
  s.magnitudes = learns_magnitudes(run.agent);
  return counted(s);
}

PoolSettings part_of(const PoolSettings& whole, const Ranks* ranks) {
  PoolSettings s = whole;
  if (ranks && s.envs % ranks->count() != 0)
    throw Usage(format("--ranks: %d does not divide the number of worlds, %d", ranks->count(), s.envs));
  if (ranks) s.envs /= ranks->count();
  return s;
}

std::vector<CostColumn> cost_columns(int32_t task, const std::vector<double>& limits) {
  std::vector<CostColumn> columns;
  for (const rdm_cost_info& c : task_costs(task)) columns.push_back({c.name, limits[columns.size()] >= 0});
  return columns;
}

// An algorithm that handles costs refuses to work without a limit.
bool handles_costs(const std::string& algo, const redman::Pool& pool) {
  auto config = redman::agent_config(pool);
  const std::vector<double> none(static_cast<size_t>(config.cost_dim), -1);
  config.algo = algo.c_str();
  config.cost_limits = none.data();
  size_t bytes = 0;
  return rdm_agent_config_memory(&config, &bytes) != RDM_OK;
}

}  // namespace

Trainer::Trainer(RunSettings settings, const Ranks* ranks)
    : ranks_(ranks),
      settings_(std::move(settings)),
      pool_(make_pool(part_of(settings_.pool, ranks), RDM_AUTORESET_SAME_STEP)),
      eval_pool_(make_pool(eval_settings(settings_), RDM_AUTORESET_OFF)),
      limits_(cost_limits(pool_, settings_.limits)),
      agent_(make_agent(settings_.agent, pool_, limits_, settings_.pool.seed, settings_.pool.threads,
                        ranks ? &ranks->hooks() : nullptr)),
      score_limits_(limits_),
      last_{std::nan(""), std::nan("")} {
  take_rate();
  if (!handles_costs(settings_.agent.algo, pool_)) score_limits_.assign(limits_.size(), -1);
  if (ranks) redman::check(rdm_pool_set_rank(pool_.get(), ranks->hooks().rank, ranks->count()));
  if (settings_.shield.on) add_shield();
}

// With option cost_limit_per_step the limit of an episode is that of its control steps: a policy is kept and reported by it.
void Trainer::take_rate() {
  const char* const key = "cost_limit_per_step";
  if (limits_.empty() || !has_option(settings_.agent.algo, key)) return;
  const double rate = std::strtod(agent_setting(agent_, settings_.agent.algo, key).c_str(), nullptr);
  if (rate < 0) return;
  for (const std::string& text : settings_.limits)
    if (limits_first(settings_.pool.task, text))
      throw Usage("--cost-limit " + text + " and --set " + key + '=' + number_text(rate) +
                  ": both are limits on column 0; give one");
  limits_[0] = score_limits_[0] = rate * pool_.spec().max_steps;
}

// Its first backup is the agent itself. What no plan avoids happens, and is counted.
void Trainer::add_shield() {
  const std::string flag = "--shield " + settings_.shield.word + ": ";
  if (ranks_) throw Usage(flag + "a shield cannot be shared among ranks; train without --ranks");
  if (settings_.shield.predicts && redman::Policy(agent_.policy()).info().num_points > 0)
    throw Usage(flag + "the agent's encoder reads points, which copies of worlds do not have");
  auto config = redman::shield_config(pool_);
  config.seed = settings_.pool.seed;
  config.steps = static_cast<int32_t>(option("action_repeat")) / pool_.spec().action_repeat;
  shield_ = make_shield(settings_.shield, "unproven=least\n", config);
  redman::set_shield(agent_, &*shield_);
}

std::string Trainer::config() const {
  return config_text(settings_, pool_, agent_, limits_, steps_per_epoch(), shield_ ? &*shield_ : nullptr);
}

void Trainer::prepare() {
  learn_from_teacher();
  pool_.reset();
  plan_schedule();
}

// The same each time, so that a run that goes on has what it needs of it.
void Trainer::learn_from_teacher() {
  taught_ = teach(settings_.teach, settings_.pool, agent_, static_cast<int32_t>(option("action_repeat")),
                  first() ? settings_.save_recording : std::string());
  const rdm_recording* recording = taught_.recording.get();
  if (!recording && (wants_imitation() || wants_starts()))
    throw Usage(
        "--start-share and imitation need a recording: give --from demo, --from FILE.npz, or --dagger");
  if (!recording) return;
  if (wants_imitation()) redman::check(rdm_agent_set_recording(agent_.get(), recording));
  if (wants_starts())
    as_usage(
        [&] { redman::check(rdm_pool_set_starts(pool_.get(), recording, settings_.teach.start_share)); });
  taught_.recording = {};  // copies were taken
}

bool Trainer::wants_starts() const {
  return settings_.teach.start_share > 0 || settings_.teach.start_share_end > 0;
}

bool Trainer::wants_imitation() const {
  if (!has_option(settings_.agent.algo, "imitation")) return false;
  return std::strtod(agent_setting(agent_, settings_.agent.algo, "imitation").c_str(), nullptr) > 0;
}

// The share of starts goes from its first value to its last in step with the run.
void Trainer::draw_starts() {
  const TeachSettings& t = settings_.teach;
  if (!wants_starts()) return;
  const double done = std::min(1.0, static_cast<double>(env_steps_) / static_cast<double>(settings_.steps));
  redman::check(
      rdm_pool_set_starts(pool_.get(), nullptr, t.start_share + done * (t.start_share_end - t.start_share)));
}

void Trainer::begin(RunFolder folder) {
  folder_.emplace(std::move(folder));
  const auto policy = agent_.policy();
  folder_->start(config(), curve_header(cost_columns(pool_.spec().task, limits_)),
                 {policy.begin(), policy.end()}, settings_.events);
}

void Trainer::resume(RunFolder folder) {
  if (!file_exists(folder.checkpoint())) {
    prepare();
    return begin(std::move(folder));
  }
  folder_.emplace(std::move(folder));
  if (wants_imitation() || wants_starts()) learn_from_teacher();
  restore(folder_->checkpoint());
  plan_schedule();
  folder_->cut_progress(progress_bytes_, settings_.events);
  folder_->write_config(config());
}

void Trainer::follow(const std::string& checkpoint) {
  const bool begun = !checkpoint.empty() && file_exists(checkpoint);
  if (!begun) return prepare();
  if (wants_imitation() || wants_starts()) learn_from_teacher();
  restore(checkpoint);
  plan_schedule();
}

int64_t Trainer::option(const char* key) const {
  return std::strtoll(agent_setting(agent_, settings_.agent.algo, key).c_str(), nullptr, 10);
}

int64_t Trainer::steps_per_epoch() const {
  return settings_.pool.envs * option("horizon") * option("action_repeat");
}

// A rate that falls to 0 does so over this run, unless the caller named a length.
void Trainer::plan_schedule() {
  for (const auto& [key, value] : settings_.agent.options)
    if (same_name(key, "total_epochs")) return;
  if (!has_option(settings_.agent.algo, "total_epochs")) return;
  const double epochs =
      std::ceil(static_cast<double>(settings_.steps) / static_cast<double>(steps_per_epoch()));
  const rdm_option option = {"total_epochs", nullptr, std::max(1.0, epochs)};
  as_usage([&] { redman::check(rdm_agent_set_option(agent_.get(), &option)); });
}

void Trainer::save() {
  if (!first()) {  // its part of what the first one writes
    redman::check(rdm_checkpoint_write("", agent_.get(), pool_.get(), nullptr, 0));
    saved_epoch_ = epoch_;
    return;
  }
  folder_->check();
  Note note;
  note.epoch = epoch_;
  note.env_steps = env_steps_;
  note.progress_bytes = progress_bytes_;
  note.seconds = earlier_seconds_ + seconds_;
  note.best = best_;
  note.best_policy = best_policy_;
  if (shield_) note.shield = shield_->state();
  if (!std::isnan(last_.ret)) note.last = last_;
  const std::string bytes = note_bytes(note);
  redman::check(rdm_checkpoint_write(folder_->checkpoint().c_str(), agent_.get(), pool_.get(), bytes.data(),
                                     bytes.size()));
  saved_epoch_ = epoch_;
}

void Trainer::restore(const std::string& path) {
  std::string bytes;
  const auto read = [&](rdm_pool* pool) {
    size_t size = 0;
    if (rdm_checkpoint_read(path.c_str(), agent_.get(), pool, bytes.data(), bytes.size(), &size) != RDM_OK)
      throw Failure("cannot resume from " + path + ": " + rdm_last_error());
    return size;
  };
  const auto no_note = [&](const std::runtime_error& e) {
    return Failure("cannot resume from " + path + ": its note was not written by this tool: " + e.what());
  };
  bytes.resize(read(nullptr));  // the first time asks for the length of the note
  bytes.resize(std::min(read(nullptr), bytes.size()));
  Note note;
  try {
    note = parse_note(bytes.data(), bytes.size());
  } catch (const std::runtime_error& e) {
    throw no_note(e);
  }
  if (note.changed)  // worlds of other options than the folder says
    throw Failure("cannot resume from " + path +
                  ": a callback in Python changed options of the task: continue it with "
                  "redman.train(resume=...) there");
  read(pool_.get());
  try {
    if (note.best) redman::Policy(note.best_policy).check_fits(pool_.spec());
    if (shield_ && note.shield.empty()) throw std::runtime_error("it has no state of the shield");
    if (shield_) shield_->set_state(note.shield);
  } catch (const std::runtime_error& e) {
    throw no_note(e);
  }
  epoch_ = saved_epoch_ = note.epoch;
  env_steps_ = note.env_steps;
  progress_bytes_ = note.progress_bytes;
  earlier_seconds_ = note.seconds;
  if (note.clock_lost && first())
    std::fputs("the training time in the checkpoint is out of range: Time/Total starts from 0 again\n",
               stderr);
  if (note.last) last_ = *note.last;
  best_ = note.best;
  best_policy_ = std::move(note.best_policy);
}

// Round 0 of the episodes that policies are chosen by is played by all, the others by those that look good.
std::vector<Episode> Trainer::play(Actor& actor, size_t round) {
  std::vector<uint64_t> seeds(kSelectionEpisodes);
  for (size_t i = 0; i < seeds.size(); ++i)
    seeds[i] = selection_seed(settings_.pool.seed, round * kSelectionEpisodes + i);
  eval_pool_.reset(seeds.data());
  return play_episodes(eval_pool_, actor, kSelectionEpisodes, {}, {}, learns_magnitudes(settings_.agent));
}

bool Trainer::compete(const redman::Bytes& policy, LastEvaluation* last) {
  Actor actor(redman::Policy(policy), eval_pool_);
  const Summary look = summarise(play(actor, 0), limits_);
  if (last) *last = {look.return_mean, look.cost_mean.empty() ? 0 : look.cost_mean[0]};
  if (look.trouble.lost()) return false;
  if (best_ && !score_of(look, score_limits_).better_than(*best_)) return false;
  std::vector<Episode> episodes;
  for (size_t round = 1; round <= kConfirmations; ++round)
    for (Episode& e : play(actor, round)) episodes.push_back(std::move(e));
  const Summary confirmed = summarise(episodes, limits_);
  const Score score = score_of(confirmed, score_limits_);
  if (confirmed.trouble.lost() || (best_ && !score.better_than(*best_))) return false;
  best_ = score;
  best_policy_ = policy;
  return true;
}

void Trainer::train_epoch(Meter& meter) {
  auto clock = Clock::now();
  const auto begin = clock;
  draw_starts();
  const rdm_epoch e = agent_.rollout(pool_);
  EpochTimes times;
  times.epoch = since(clock);
  const int64_t steps = e.env_steps - env_steps_;
  env_steps_ = e.env_steps;
  epoch_ = e.epoch;
  own_steps_ += steps;
  own_seconds_ += times.epoch;
  if (first() && epoch_ % settings_.eval_every == 0) {
    clock = Clock::now();
    if (compete(agent_.policy(), &last_)) folder_->write_policy({best_policy_.begin(), best_policy_.end()});
    scored_epoch_ = epoch_;
    times.evaluation = since(clock);
  }
  seconds_ += since(begin);
  times.total = earlier_seconds_ + seconds_;
  if (first())
    progress_bytes_ = folder_->append_progress(
        curve_row(folder_->header(), cost_columns(pool_.spec().task, limits_), e, steps, last_, times));
  if (epoch_ % settings_.checkpoint_every == 0) save();
  if (first()) meter.show(e);
}

bool Trainer::stopped() const {
  return ranks_ ? ranks_->any(g_signals != 0) : g_signals != 0;
}

void Trainer::train_to_the_end(Meter& meter) {
  try {
    while (env_steps_ < settings_.steps && !stopped()) train_epoch(meter);
    if (saved_epoch_ != epoch_) save();
  } catch (const redman::Error& e) {
    if (e.code() != RDM_ERROR_CANCELLED || g_signals == 0) throw;
  }
}

void Trainer::run() {
  const SignalScope signals(agent_.get(), first());
  Meter meter(env_steps_, settings_.steps);
  try {
    train_to_the_end(meter);
  } catch (const std::runtime_error& e) {
    if (!first()) throw;
    folder_->check();  // where the folder is gone, that is what went wrong
    if (saved_epoch_ < 1) throw;
    if (!file_exists(folder_->checkpoint()))
      throw Failure(std::string(e.what()) + "; " + folder_->checkpoint() +
                    " was removed, so there is nothing to resume from");
    throw Failure(
        std::string(e.what()) +
        format("; the checkpoint of epoch %d is kept: continue with train --resume ", saved_epoch_) +
        folder_->path());
  }
  if (!first()) return;
  interrupted_ = env_steps_ < settings_.steps;
  if (interrupted_)
    meter.say(saved_epoch_ > 0
                  ? format("stopped; the checkpoint is at epoch %d: continue with train --resume %s",
                           saved_epoch_, folder_->path().c_str())
                  : "stopped within the first epoch: there is no checkpoint yet");
  finish();
}

// The last policy competes for policy.rdm too, but leaves no trace in the checkpoint: a run that is continued
// later must not depend on where it was stopped.
void Trainer::finish() {
  if (epoch_ == 0) return;
  const redman::Bytes last = agent_.policy();
  if (scored_epoch_ != epoch_) compete(last, nullptr);
  if (!best_)
    std::fputs("redman: every evaluated policy had episodes that diverged: the last policy is kept\n",
               stderr);
  const redman::Bytes& kept = best_ ? best_policy_ : last;
  folder_->write_policy({kept.begin(), kept.end()});
}

double Trainer::total(const char* column) const {
  const std::string text = read_file(folder_->progress());
  const Columns columns = parse_progress(text.data(), text.size());
  const auto found = columns.find(column);
  if (found == columns.end()) return std::nan("");
  double sum = 0;
  for (const double x : found->second) sum += x;
  return sum;
}

double Trainer::steps_per_second() const {
  return own_seconds_ > 0 ? static_cast<double>(own_steps_) / own_seconds_ : 0;
}

}  // namespace tool
