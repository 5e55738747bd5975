#include "teach/teacher.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <redman/memory.hpp>
#include <redman/sense.hpp>

#include "common/names.hpp"
#include "common/text.hpp"
#include "teach/noise.hpp"

namespace tool {
namespace {

constexpr uint64_t kTeachSeed = 3000000;  // the teacher's worlds draw from seed + this + the round
constexpr uint64_t kPretrainSeed = 5000000;
constexpr double kPolicySamples = 100000;  // that a policy's statistics of observations count for

bool is_file(const std::string& word) {
  return word.size() > 4 && same_name(word.substr(word.size() - 4), ".npz");
}

redman::Recording open_recording(const std::string& path) {
  try {
    return redman::Recording(path.c_str());
  } catch (const redman::Error& e) {
    throw Failure(path + ": " + e.what());
  }
}

// What episodes of a round came to.
struct RoundMeans {
  double ret = 0, cost = 0;
  int32_t episodes = 0, successes = 0;
};

// The teacher, and in the rounds of DAgger the student, in worlds that only they see.
class Lesson {
 public:
  Lesson(const TeachSettings& settings, const PoolSettings& pool, const ActorChoice& teacher, int32_t repeat,
         uint64_t seed)
      : settings_(settings),
        pool_(make_pool(pool, RDM_AUTORESET_SAME_STEP)),
        teacher_(teacher, pool_),
        noise_(pool_.num_envs(), pool_.action().width(), settings.noise, seed),
        steps_(std::max(1, repeat / pool_.spec().action_repeat)),
        live_(pool_.num_envs()),
        over_(pool_.num_envs()),
        won_(pool_.num_envs(), 0),
        meant_(pool_.num_envs() * pool_.action().width(), 0) {
    redman::check(rdm_pool_reset(pool_.get(), nullptr, nullptr));
    teacher_.restart();
  }
  redman::Pool& pool() { return pool_; }

  // A decision of each world: the teacher's with noise, with probability beta, else the student's mean.
  void decide(redman::Recording& recording, const redman::Policy* student, double beta, RoundMeans* means) {
    const size_t n = pool_.num_envs(), width = pool_.action().width();
    std::vector<float> label(n * width), held(n * width);
    std::fill(live_.begin(), live_.end(), 1);
    for (int32_t k = 0; k < steps_; ++k) {
      // its clock goes on, whoever acts; and it may hold what it meant before
      std::copy_n(meant_.data(), n * width, pool_.action().data());
      teacher_.act(pool_, live_.data());
      std::copy_n(pool_.action().data(), n * width, meant_.data());
      if (k == 0) {
        label = meant_;
        choose(label, student, beta, held);
      }
      std::copy_n(held.data(), n * width, pool_.action().data());
      if (k == 0) recording.begin_step(pool_, label.data());
      pool_.step(live_.data());
      recording.end_step(pool_, live_.data());
      for (size_t i = 0; i < n; ++i) count(i, means);
    }
    for (size_t i = 0; i < n; ++i) {
      over_[i] = !live_[i];
      const size_t dim = state_.size() / n;
      if (over_[i]) std::fill_n(state_.begin() + static_cast<long>(i * dim), dim, 0.0f);
    }
    teacher_.restart(over_.data());
  }

 private:
  void choose(const std::vector<float>& label, const redman::Policy* student, double beta,
              std::vector<float>& held) {
    const size_t n = pool_.num_envs(), width = pool_.action().width();
    const auto rows = static_cast<int32_t>(n);
    if (student && student->info().num_points > 0)
      redman::act(*student, pool_.obs().data(), redman::points(redman::sensors(pool_)), state_of(*student),
                  rows, nullptr, held.data());
    else if (student)
      redman::act(*student, pool_.obs().data(), state_of(*student), rows, nullptr, held.data());
    for (size_t i = 0; i < n; ++i) {
      noise_.draw(i);
      const bool taught = !student || noise_.uniform() < beta;
      for (size_t j = 0; taught && j < width; ++j) held[i * width + j] = label[i * width + j];
      for (size_t j = 0; j < width; ++j) {
        float& a = held[i * width + j];
        a = std::clamp(a + noise_.row(i)[j], -1.0f, 1.0f);
      }
    }
  }
  // What the student remembers of each world, whoever acts in it; null: nothing.
  float* state_of(const redman::Policy& student) {
    if (state_.empty()) state_ = redman::start(student, static_cast<int32_t>(pool_.num_envs()));
    return state_.empty() ? nullptr : state_.data();
  }
  void count(size_t i, RoundMeans* means) {
    if (!live_[i]) return;
    won_[i] |= pool_.success()[i];
    if (!pool_.terminated()[i] && !pool_.truncated()[i]) return;
    live_[i] = 0;
    means->ret += static_cast<double>(pool_.episode_return()[i]);
    if (pool_.episode_cost().width() > 0) means->cost += static_cast<double>(pool_.episode_cost()[i][0]);
    means->successes += won_[i];
    ++means->episodes;
    won_[i] = 0;
  }

  const TeachSettings& settings_;
  redman::Pool pool_;
  Actor teacher_;
  ActionNoise noise_;
  int32_t steps_;
  std::vector<uint8_t> live_, over_, won_;
  std::vector<float> meant_;  // [num_envs][action_dim] the teacher's last actions
  std::vector<float> state_;  // [num_envs][state_dim] of the student
};

rdm_clone_report clone(const TeachSettings& s, redman::Agent& agent, const redman::Recording& recording,
                       uint64_t seed) {
  rdm_clone_config how = redman::clone_config();
  how.epochs = s.clone_epochs;
  how.patience = s.clone_patience;
  how.learning_rate = s.clone_rate;
  how.learning_rate_end = s.clone_rate / 100;
  how.validation = s.validation;
  how.seed = seed;
  const rdm_clone_report report = as_usage([&] { return redman::clone(agent, recording, how); });
  std::fprintf(
      stderr, "cloned %lld rows in %d epochs: loss %.5f, %s\n", static_cast<long long>(report.train_rows),
      report.epochs, report.train_loss,
      report.validation_rows ? format("held back %.5f", report.validation_loss).c_str() : "none held back");
  return report;
}

rdm_pretrain_report pretrain(const TeachSettings& s, const PoolSettings& settings, const redman::Agent& agent,
                             int32_t repeat) {
  PoolSettings own = settings;
  own.seed += kPretrainSeed;
  const bool taught = s.asked() && !is_file(s.from);
  Lesson lesson(s, own, choose_actor(taught ? s.from : "random", settings.task), repeat, own.seed);
  const rdm_sensors seen = redman::sensors(lesson.pool());
  if (!seen.points) throw Usage("--pretrain: the agent does not read points; give --set encoder=64,128");
  redman::Recording shown(lesson.pool(), s.pretrain + settings.envs);
  RoundMeans means;
  while (shown.info().rows < s.pretrain) lesson.decide(shown, nullptr, 1, &means);
  const rdm_recording_rows rows = shown.rows();
  std::vector<float> metres(static_cast<size_t>(s.pretrain) * static_cast<size_t>(seen.num_points) * 3);
  for (size_t i = 0; i < metres.size(); ++i) metres[i] = 0.001f * static_cast<float>(rows.points[i]);
  auto how = redman::pretrain_config(seen.num_classes);
  how.epochs = s.pretrain_epochs;
  how.seed = settings.seed;
  const rdm_pretrain_report report = as_usage([&] {
    return redman::pretrain(
        agent, redman::points(metres.data(), seen.num_points, rows.point_class, rows.point_color),
        rows.point_class, s.pretrain, how);
  });
  std::fprintf(stderr,
               "encoder tells %.1f%% of points right after %d clouds (the commonest kind has %.1f%%)\n",
               100 * report.accuracy, report.train_rows, 100 * report.most_common);
  return report;
}

// Rows of episodes without success go.
void drop_failures(redman::Recording& recording) {
  recording.filter(true);
  if (recording.info().rows == 0) throw Failure("--success-only: no episode of the teacher succeeded");
}

void load_policy(const std::string& file, const redman::Pool& pool, redman::Agent& agent) {
  const redman::Policy policy(file.c_str());
  policy.check_fits(pool.spec());
  if (rdm_agent_set_policy(agent.get(), policy.get(), kPolicySamples) != RDM_OK)
    throw Failure("--from " + file + ": " + rdm_agent_error(agent.get()));
}

}  // namespace

Options taught_options(const TeachSettings& s, const Options& given) {
  if (!s.asked()) return {};
  const bool student = std::any_of(given.begin(), given.end(), [](const auto& option) {
    return same_name(option.first, "latent_from") && option.second == "history";
  });
  if (student) return {{"std_min", "0.01"}, {"learning_rate", "1e-3"}, {"lr_schedule", "linear"}};
  return {{"std_min", "0.01"},       {"init_std", "0.03"},
          {"learning_rate", "1e-9"}, {"critic_learning_rate", "1e-3"},
          {"lr_schedule", "kl"},     {"kl_target", "0.02"},
          {"lr_min", "1e-9"},        {"warm_epochs", "10"},
          {"obs_freeze", "1"}};
}

Options adopt_lesson(const std::vector<std::string>& given, const PoolSettings& pool,
                     TeachSettings& settings) {
  if (!settings.asked() || is_file(settings.from)) return {};
  const ActorChoice choice = choose_actor(settings.from, pool.task);
  if (!choice.demo) return {};
  const DemoScript script = choice.script ? *choice.script : builtin_demo(pool.task, pool.options);
  for (const auto& [name, value] : script.teach) {
    if (std::find(given.begin(), given.end(), name) != given.end()) continue;
    const TeachField& field = *find_teach_field(name);
    const double v = std::strtod(value.c_str(), nullptr);
    if (field.whole)
      settings.*field.whole = static_cast<int32_t>(v);
    else
      settings.*field.real = v;
  }
  return script.learn;
}

void need_effect(const std::vector<std::string>& given, const PoolSettings& pool, const TeachSettings& s) {
  const bool recorded = is_file(s.from), shown = s.asked() && !recorded;
  const ActorChoice choice = shown ? choose_actor(s.from, pool.task) : ActorChoice();
  if (choice.baseline >= 0) throw Usage("--from " + s.from + ": there is nothing to learn from this");
  const bool start = shown && s.dagger == 0 && !choice.demo;
  if (start && choice.plan)
    throw Usage("--from " + s.from +
                ": there is no policy to begin with; give --dagger ROUNDS to learn from plans");
  const auto why = [&](const std::string& name) -> std::string {
    const bool of_teacher = name == "demo-decisions" || name == "noise" || name == "save-recording";
    const bool of_clone = name.rfind("clone-", 0) == 0 || name == "validation" || name == "success-only";
    if (name == "noise" && s.pretrain > 0) return "";
    if (name == "pretrain-epochs" && s.pretrain == 0)
      return "there are no clouds to learn from; give --pretrain";
    if (name == "dagger" && recorded && s.dagger > 0)
      return "a recording cannot label other states; give demo, or a policy";
    if (name == "beta" && s.dagger == 0) return "it is for rounds of --dagger, and there are none";
    if (of_teacher && recorded) return "its rows are recorded already, and no teacher acts";
    if ((of_teacher || of_clone) && start)
      return "training begins with this policy, and nothing is cloned; with --dagger ROUNDS it is the "
             "teacher";
    return "";
  };
  // a program may write out every default, as redman.train in Python does
  const auto is_default = [&](const std::string& name) {
    const TeachField* f = find_teach_field(name);
    const TeachSettings plain;
    return f && (f->whole ? s.*f->whole == plain.*f->whole : s.*f->real == plain.*f->real);
  };
  for (const std::string& name : given)
    if (const std::string text = is_default(name) ? "" : why(name); !text.empty())
      throw Usage("--" + name + " has no effect" + (s.asked() ? " with --from " + s.from : "") + ": " + text);
}

void adopt_teacher(const TeachSettings& s, bool task_given, const std::vector<std::string>& sets,
                   PoolSettings& pool) {
  if (is_file(s.from)) {
    const redman::Recording recording = open_recording(s.from);
    const rdm_recording_info info = recording.info();
    if (!task_given && *info.task) pool.task = info.task;
    return;
  }
  adopt_task(choose_actor(s.from, pool.task), task_given, sets, pool);
}

Taught teach(const TeachSettings& s, const PoolSettings& settings, redman::Agent& agent, int32_t repeat,
             const std::string& save) {
  Taught out;
  if (s.pretrain > 0) {
    out.pretraining = pretrain(s, settings, agent, repeat);
    out.pretrained = true;
  }
  if (!s.asked()) return out;
  if (is_file(s.from)) {
    out.recording = open_recording(s.from);
    if (s.success_only) drop_failures(out.recording);
    out.report = clone(s, agent, out.recording, settings.seed);
    out.cloned = true;
    return out;
  }
  const ActorChoice teacher = choose_actor(s.from, settings.task);
  if (!teacher.demo && s.dagger == 0) {
    load_policy(teacher.file, make_pool(settings, RDM_AUTORESET_OFF), agent);
    std::fprintf(stderr, "begins with the policy %s\n", printable(s.from).c_str());
    return out;
  }
  for (int32_t round = 0; round <= s.dagger; ++round) {
    const uint64_t seed = settings.seed + kTeachSeed + static_cast<uint64_t>(round);
    PoolSettings own = settings;
    own.seed = seed;
    Lesson lesson(s, own, teacher, repeat, seed);
    const int64_t rows = int64_t{settings.envs} * s.decisions;
    redman::Recording fresh(lesson.pool(), rows);
    const redman::Bytes bytes = round > 0 ? agent.policy() : redman::Bytes();
    const std::unique_ptr<redman::Policy> student =
        round > 0 ? std::make_unique<redman::Policy>(bytes) : nullptr;
    RoundMeans means;
    for (int32_t d = 0; d < s.decisions; ++d)
      lesson.decide(fresh, student.get(), std::pow(s.beta, round), &means);
    const double n = std::max(1, means.episodes);
    std::fprintf(stderr, "%s: %d episodes, return %.1f, cost %.2f, success %.0f%%\n",
                 round ? format("DAgger round %d", round).c_str() : "teacher", means.episodes, means.ret / n,
                 means.cost / n, 100 * means.successes / n);
    if (s.success_only) drop_failures(fresh);
    if (round == 0)
      out.recording = std::move(fresh);
    else
      out.recording.append(fresh);
    out.report = clone(s, agent, out.recording, settings.seed + static_cast<uint64_t>(round));
  }
  out.cloned = true;
  if (!save.empty() && rdm_recording_write_file(out.recording.get(), save.c_str()) != RDM_OK)
    throw Failure("--save-recording: " + std::string(rdm_last_error()));
  return out;
}

}  // namespace tool
