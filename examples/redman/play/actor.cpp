#include "play/actor.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <redman/sense.hpp>

#include "common/files.hpp"
#include "common/names.hpp"
#include "common/scatter.hpp"
#include "common/setting.hpp"
#include "common/text.hpp"
#include "play/plan_word.hpp"
#include "play/trained.hpp"
#include "record/recorded_rollout.hpp"
#include "run/folder.hpp"

namespace tool {
namespace {

constexpr const char* kBaselines[] = {"zero", "hold", "random"};  // by RDM_BASELINE_*

redman::Policy load(const std::string& file) {
  const std::vector<std::string> words = {"trained", "plan", "demo", "zero", "hold", "random"};
  if (const std::string hint = nearest_hint(file, words);
      !hint.empty() && why_no_file(file).rfind("no such", 0) == 0)
    throw Failure("policy " + file + ": there is no such file or word" + hint);
  if (const std::string problem = why_no_file(file); !problem.empty())
    throw Failure(
        "policy " + file + ": " + problem +
        "; give a policy file, a run folder, a .demo or .npz file, trained, plan, demo, zero, hold or "
        "random");
  try {
    return redman::Policy(file.c_str());
  } catch (const redman::Error& e) {
    throw Failure("policy " + file + ": " + e.what());
  }
}

// The agent of a run as its last checkpoint has it.
redman::Agent trained_agent(const std::string& folder, const redman::Pool& pool) {
  const RunSettings run = run_settings(folder);
  const std::string task = task_at(pool.spec().task).name, file = folder + "/checkpoint.rdm";
  if (!same_name(run.pool.task, task))
    throw Failure("critic " + folder + " was trained in task " + run.pool.task + ", not " + task);
  const redman::Pool own = make_pool(run.pool, RDM_AUTORESET_SAME_STEP);
  redman::Agent agent =
      make_agent(run.agent, own, cost_limits(own, run.limits), run.pool.seed, run.pool.threads);
  size_t note = 0;
  if (rdm_checkpoint_read(file.c_str(), agent.get(), nullptr, nullptr, 0, &note) != RDM_OK)
    throw Failure("critic " + folder + ": cannot read " + file + ": " + rdm_last_error());
  return agent;
}

bool has_ending(const std::string& word, const std::string& ending) {
  return word.size() > ending.size() && word.substr(word.size() - ending.size()) == ending;
}

}  // namespace

ActorChoice choose_actor(const std::string& word, const std::string& task) {
  ActorChoice choice;
  std::string own = task;
  if (read_trained_word(word, &own)) {
    if (own.empty()) throw Usage("--policy trained: it is not known of which task; give trained:TASK");
    choice = choose_actor(trained_policy(own));
    choice.alone = false;  // it learned with the task's defaults
    return choice;
  }
  PlanWord plan;
  if (read_plan_word(word, &plan)) {
    if (!plan.policy.empty()) choice = choose_actor(plan.policy, task);
    if (!plan.policy.empty() && (choice.file.empty() || choice.recording || choice.plan))
      throw Failure("policy " + plan.policy +
                    ": a planner's proposals come from a policy file or a run folder");
    choice.plan = true;
    choice.plan_settings = plan.settings;
    choice.critic = plan.critic;
    return choice;
  }
  for (int32_t i = 0; i < 3; ++i)
    if (same_name(word, kBaselines[i])) choice.baseline = i;
  if (choice.baseline >= 0) return choice;
  const bool script = has_ending(word, ".demo");
  choice.demo = script || same_name(word, "demo");
  if (script) {
    const std::string text = read_file(word, kMostDemoBytes);
    choice.script = parse_demo(text.data(), text.size(), word);
    choice.task = choice.script->task;
    choice.options = choice.script->options;
  }
  if (choice.demo) return choice;
  if (has_ending(word, ".npz")) {
    auto recording = std::make_shared<Recording>(read_recording(word));
    choice.file = word;
    choice.task = recording->pool.task;
    choice.options = recording->pool.options;
    choice.recording = std::move(recording);
    return choice;
  }
  choice.file = is_folder(word) ? word + "/policy.rdm" : word;
  const redman::Policy policy = load(choice.file);  // lends info its texts
  const rdm_policy_info& info = policy.info();
  choice.task = info.task;
  choice.points = info.num_points;
  choice.color = info.point_color != 0;
  choice.repeat = info.action_repeat;
  const std::string folder = run_folder_of(choice.file);
  choice.alone = folder.empty();
  if (choice.alone) return choice;
  const RunSettings run = run_settings(folder);
  if (same_name(run.pool.task, choice.task)) {
    choice.options = run.pool.options;
    choice.limits = run.limits;
    if (run.rated_limit >= 0) choice.limits.push_back(number_text(run.rated_limit));
    if (run.functions)
      std::fprintf(
          stderr,
          "redman: the reward or the costs of %s are functions in Python: here the task's own count\n",
          printable(folder).c_str());
    choice.magnitudes = learns_magnitudes(run.agent);
    choice.run_shield = run.shield.settings;
  }
  return choice;
}

void adopt_task(const ActorChoice& choice, bool task_given, const std::vector<std::string>& sets,
                PoolSettings& pool) {
  if (choice.recording) {
    if (task_given && !same_name(pool.task, choice.task))
      throw Failure(choice.file + " was recorded in task " + choice.task + ", not in " + pool.task);
    pool.seed = choice.recording->pool.seed;
  }
  if (choice.alone)
    std::fprintf(stderr,
                 "policy %s: no config.json of its run stands beside it: options and limits are the task's "
                 "defaults, but for --set and --cost-limit\n",
                 printable(choice.file).c_str());
  if (!task_given && !choice.task.empty()) pool.task = choice.task;
  if (choice.demo && !choice.script) {
    Options given = pool.options;
    for (const std::string& set : sets) given.push_back(split_pair(set, "--set"));
    const Options own = builtin_demo(pool.task, given).options;
    pool.options.insert(pool.options.begin(), own.begin(), own.end());
  }
  if (choice.points > 0) give_eyes(choice.points, choice.repeat, choice.color ? "true" : "false", pool);
  if (!same_name(pool.task, choice.task)) return;
  pool.options.insert(pool.options.begin(), choice.options.begin(), choice.options.end());
  pool.magnitudes = choice.magnitudes;
}

Actor::Actor(const ActorChoice& choice, redman::Pool& pool, bool stochastic, uint64_t seed)
    : baseline_(choice.baseline) {
  if (choice.demo)
    demo_.emplace(choice.script
                      ? *choice.script
                      : builtin_demo(task_at(pool.spec().task).name, read_settings(pool.settings())),
                  pool);
  if (choice.plan) {
    make_planners(choice, pool, seed);
  } else if (choice.recording) {
    recording_ = choice.recording;
    file_ = choice.file;
    const size_t n = pool.num_envs(), width = pool.action().width();
    if (recording_->action_dim != width)
      throw Failure(file_ + " does not fit: it has " + std::to_string(recording_->action_dim) +
                    " actions, but the task has " + std::to_string(width));
    played_.assign(n, 0);
    for (size_t i = 0; i < n; ++i) episode_.push_back(i);
    // what it played drew from the worlds' streams, which are part of their states
    if (same_name(recording_->policy, kBaselines[RDM_BASELINE_RANDOM])) baseline_ = RDM_BASELINE_RANDOM;
  } else if (!choice.file.empty()) {
    policy_ = load(choice.file);
    try {
      policy_->check_fits(pool.spec());
    } catch (const redman::Error& e) {
      throw Failure("policy " + choice.file + " does not fit task " + task_at(pool.spec().task).name + ": " +
                    e.what());
    }
  }
  prepare(pool, stochastic, seed);
  add_shield(choice, pool, seed);
}

Actor::Actor(redman::Policy policy, const redman::Pool& pool) : policy_(std::move(policy)) {
  prepare(pool, false, 0);
}

void Actor::make_planners(const ActorChoice& choice, const redman::Pool& pool, uint64_t seed) {
  if (!choice.file.empty()) proposer_ = load(choice.file);
  if (!choice.critic.empty()) critic_ = trained_agent(choice.critic, pool);
  const std::vector<double> limits = cost_limits(pool, choice.limits);
  for (size_t i = 0; i < pool.num_envs(); ++i) {
    auto config = redman::planner_config(pool, choice.plan_settings.c_str());
    config.seed = scattered(seed + i);
    config.cost_limits = limits.data();
    config.policy = proposer_ ? proposer_->get() : nullptr;
    config.agent = critic_ ? critic_->get() : nullptr;
    planners_.push_back(as_usage([&] { return redman::Planner(config); }));
  }
}

// A policy that plays is a backup too, and one that proposes to planners where it decides as often as they do.
void Actor::add_shield(const ActorChoice& choice, const redman::Pool& pool, uint64_t seed) {
  if (!choice.shield.on) return;
  if (recording_) throw Usage("--shield: a recording is played as it was; give off, or another policy");
  const redman::Policy* backup = policy_ ? &*policy_ : nullptr;
  if (proposer_ && proposer_->info().action_repeat == pool.spec().action_repeat) backup = &*proposer_;
  shielded_.emplace(choice.shield, choice.run_shield, pool, backup, seed);
}

void Actor::plan(redman::Pool& pool, const uint8_t* mask) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  for (size_t i = 0; i < planners_.size(); ++i) {
    if (mask && !mask[i]) continue;
    planning_.steps += planners_[i].act(pool, static_cast<int32_t>(i), pool.action()[i].data()).steps;
    ++planning_.calls;
  }
  planning_.seconds += std::chrono::duration<double>(Clock::now() - begin).count();
}

// The player of the policy, whose step is that of the pool.
void Actor::prepare(const redman::Pool& pool, bool stochastic, uint64_t seed) {
  if (!policy_) return;
  if (const int32_t points = policy_->info().num_points; points > 0) {
    const rdm_sensors seen = redman::sensors(pool);
    if (!seen.points || seen.num_points != points)
      throw Failure(
          format("the policy reads clouds of %d points: set modality=points and points=%d", points, points));
    if (policy_->info().point_color && !seen.point_color)
      throw Failure("the policy reads the colours of points: set point_color=true");
    seen_ = redman::points(seen);
  }
  auto config = redman::actor_config(*policy_, pool);
  config.stochastic = stochastic;
  config.seed = seed;
  player_.emplace(as_usage([&] { return redman::Actor(config); }));
}

void Actor::restart(const uint8_t* mask) {
  if (demo_) demo_->restart(mask);
  for (size_t i = 0; i < planners_.size(); ++i)
    if (!mask || mask[i]) planners_[i].reset();
  for (size_t i = 0; i < played_.size(); ++i) {
    if ((mask && !mask[i]) || played_[i] == 0) continue;
    if (played_[i] != recording_->length(episode_[i])) throw Failure(went_elsewhere(i));
    episode_[i] += played_.size();
    played_[i] = 0;
  }
  if (player_) player_->reset(mask);
  if (shielded_) shielded_->restart(mask);
}

std::string Actor::went_elsewhere(size_t env) const {
  return file_ + ": episode " + std::to_string(episode_[env]) + " has " +
         std::to_string(recording_->length(episode_[env])) +
         " steps, and did not end there: recorded by another version, or with other options";
}

void Actor::check_ends() const {
  for (size_t i = 0; i < played_.size(); ++i)
    if (played_[i] && played_[i] != recording_->length(episode_[i])) throw Failure(went_elsewhere(i));
}

void Actor::replay(redman::Pool& pool, const uint8_t* mask) {
  if (baseline_ >= 0) pool.baseline(baseline_);
  const Recording& r = *recording_;
  for (size_t i = 0; i < pool.num_envs(); ++i) {
    if (mask && !mask[i]) continue;
    const size_t e = episode_[i];
    if (e >= r.episodes())
      throw Failure(file_ + " has " + std::to_string(r.episodes()) + " episodes, and cannot give more");
    if (played_[i] == 0) {
      const char* state = r.state.data() + e * r.state_bytes;
      try {
        pool.set_state(redman::Bytes(state, state + r.state_bytes), static_cast<int32_t>(i));
      } catch (const redman::Error& error) {
        throw Failure(file_ + " does not fit: " + error.what());
      }
    }
    if (played_[i] == r.length(e)) throw Failure(went_elsewhere(i));
    std::copy_n(r.action.data() + (r.begin[e] + played_[i]++) * r.action_dim, r.action_dim,
                pool.action()[i].begin());
  }
}

void Actor::act(redman::Pool& pool, const uint8_t* mask, const std::function<void()>& change) {
  propose(pool, mask);
  if (change) change();
  if (shielded_) shielded_->act(pool, mask);
}

void Actor::step(redman::Pool& pool, const uint8_t* mask) {
  if (shielded_)
    shielded_->step(pool, mask);
  else if (mask)
    pool.step(mask);
  else
    pool.step();
}

void Actor::propose(redman::Pool& pool, const uint8_t* mask) {
  if (demo_) return demo_->act(pool, mask);
  if (recording_) return replay(pool, mask);
  if (!planners_.empty()) return plan(pool, mask);
  if (player_) return player_->act(pool, mask, seen_.points ? &seen_ : nullptr);
  pool.baseline(baseline_);
}

}  // namespace tool
