// Worlds that are looked at: their moments, who acts, what a person does to them, recordings.
#include "view/session.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "common/names.hpp"
#include "common/setting.hpp"
#include "common/text.hpp"
#include "play/shield_word.hpp"
#include "play/trained.hpp"

namespace tool {
namespace {

template <class T>
std::vector<T> copied(const redman::View<T>& view) {
  return {view.begin(), view.end()};
}
template <class T>
std::vector<T> copied(const redman::Rows<T>& rows, size_t count) {
  return {rows.data(), rows.data() + count * rows.width()};
}

// Option limit_range of a pool; -1, -1 without.
std::array<double, 2> limit_range_of(const redman::Pool& pool) {
  const std::string text = option_of(read_settings(pool.settings()), "limit_range");
  if (text.empty()) return {-1, -1};
  const size_t dots = text.find("..");
  const double low = std::strtod(text.c_str(), nullptr);
  return {low, dots == std::string::npos ? low : std::strtod(text.c_str() + dots + 2, nullptr)};
}

}  // namespace

Session::Session(ViewSettings settings) : settings_(std::move(settings)), history_(settings_.history_bytes) {
  open(settings_.pool, settings_.policies.front(), read_shield_word(settings_.shield).on);
}

Session::~Session() = default;

ActorChoice Session::choose(const std::string& who) const {
  ActorChoice choice = choose_actor(who, settings_.pool.task);
  choice.limits.insert(choice.limits.end(), settings_.limits.begin(), settings_.limits.end());
  return choice;
}

void Session::set_actor(const std::string& who, bool shield) {
  ActorChoice choice = choose(who);
  choice.shield = read_shield_word(!shield                     ? "off"
                                   : settings_.shield == "off" ? "predict"
                                                               : settings_.shield);
  Actor actor(choice, *pool_);
  actor_.reset();  // it borrows from the choice's recording
  actor_.emplace(std::move(actor));
  choice_ = std::move(choice);
  who_ = who;
  shield_ = shield;
  actor_->restart();
  ++changes_;
}

// All or nothing.
void Session::open(const PoolSettings& wanted, const std::string& who, bool shield) {
  redman::Pool pool = make_pool(wanted, RDM_AUTORESET_OFF);
  pool.reset();
  std::optional<redman::Pool> before(std::move(pool));
  std::swap(pool_, before);
  std::optional<Actor> actor;
  std::swap(actor_, actor);
  try {
    set_actor(who, shield);
  } catch (...) {
    std::swap(pool_, before);
    std::swap(actor_, actor);
    throw;
  }
  actor.reset();
  settings_.pool = wanted;
  limits_ = cost_limits(*pool_, choice_->limits);
  looks_ = begin_playback(*pool_, limits_);
  moving_.clear();
  for (int32_t i = 0; i < pool_->spec().num_shapes; ++i) {
    rdm_shape_info shape = RDM_INIT(rdm_shape_info);
    redman::check(rdm_pool_shape_at(pool_->get(), i, &shape));
    if (!shape.fixed) moving_.push_back(i);
  }
  actors_ = settings_.policies;
  const std::string task = task_at(pool_->spec().task).name;
  std::vector<std::string> words = {"zero", "hold", "random"};
  if (has_builtin_demo(task)) words.emplace_back("demo");
  if (has_trained_policy(task)) words.emplace_back("trained");
  for (const std::string& word : words)
    if (std::find(actors_.begin(), actors_.end(), word) == actors_.end()) actors_.push_back(word);
  watched_ = std::min(watched_, static_cast<int32_t>(pool_->num_envs()) - 1);
  own_ = pool_->initial_mean();
  by_hand_ = false;
  grab_.reset();
  limit_range_ = limit_range_of(*pool_);
  limit_.reset();
  lead_.emplace(wanted);
  history_.clear();
  ++scene_number_;
  remember();
}

void Session::remember() {
  const redman::Pool& p = *pool_;
  const size_t n = p.num_envs();
  History::Rows rows;
  rows.reward = copied(p.reward());
  rows.episode_return = copied(p.episode_return());
  rows.cost = copied(p.cost(), n);
  rows.episode_cost = copied(p.episode_cost(), n);
  rows.action = copied(p.action(), n);
  rows.step.assign(p.buffers().episode_step, p.buffers().episode_step + n);
  rows.success = copied(p.success());
  for (size_t i = 0; i < n; ++i) {
    rows.ended.push_back(p.terminated()[i] ? 2 : p.truncated()[i] ? 1 : 0);
    rows.stepped_in.push_back(rows.step[i] > 0 && actor_->shielded() &&
                              actor_->shielded()->stepped_in(p, static_cast<int32_t>(i)));
  }
  history_.add({p.state(), std::move(rows)});
  at_ = history_.last();
  ++changes_;
}

// From here on it is the past that is shown which goes on; who acts decides anew.
void Session::leave_past() {
  if (at_ == history_.last()) return;
  history_.drop_after(at_);
  actor_->restart();
}

void Session::seek(int64_t moment) {
  moment = std::clamp(moment, history_.first(), history_.last());
  if (take_ && moment < take_->begin)
    throw Usage("earlier episodes are already recorded, so it cannot go back beyond the start of this one");
  pool_->set_state(history_.at(moment).state);
  at_ = moment;
  plays_ = false;
  grab_.reset();
  ++changes_;
}

void Session::keep_limit() {
  if (limit_) as_usage([&] { redman::check(rdm_pool_set_limit(pool_->get(), -1, *limit_)); });
}

void Session::begin_next(const std::vector<uint8_t>& ended) {
  pool_->reset(nullptr, ended.data());
  keep_limit();
  actor_->restart(ended.data());
  if (ended[watched()]) own_ = pool_->initial_mean();
}

void Session::reset(const uint64_t* seed) {
  leave_past();
  std::vector<uint64_t> seeds;
  for (size_t i = 0; seed && i < pool_->num_envs(); ++i) seeds.push_back(*seed + i);
  pool_->reset(seed ? seeds.data() : nullptr);
  keep_limit();
  actor_->restart();
  own_ = pool_->initial_mean();
  grab_.reset();
  if (take_) take_->recorder->rewind(watched(), 0);
  remember();
  if (take_) take_->begin = at_, take_->pushed = false;
}

// From where the action is.
void Session::take_over(bool on) {
  const History::Rows& r = history_.at(at_).rows;
  if (on && !by_hand_ && r.step[watched()] > 0)
    std::copy_n(r.action.begin() + static_cast<ptrdiff_t>(watched() * own_.size()), own_.size(),
                own_.begin());
  by_hand_ = on;
}

void Session::push() {
  if (!grab_ || grab_->leads) return;
  Grab& g = *grab_;
  const rdm_pose pose = pool_->poses(g.world)[static_cast<size_t>(g.shape)];
  double at[3];
  float force[3];
  point_of(pose, g.local, at);
  g.force = pull_of(at, g.to, g.newton, g.reach, force);
  redman::check(rdm_pool_push(pool_->get(), g.world, g.shape, force));
  if (take_ && g.world == watched_) take_->pushed = true;
}

void Session::lead() {
  const Grab& g = *grab_;
  take_over(true);
  if (!lead_->bring(*pool_, {g.world, g.shape, g.local}, g.to, own_.data())) {
    const std::string name = looks_.bodies[static_cast<size_t>(g.shape)].name;
    grab_.reset();
    throw Usage(name + ": no entry of the action moves it; pull it instead");
  }
}

void Session::step() {
  leave_past();
  const std::vector<uint8_t>& before = history_.at(at_).rows.ended;
  std::vector<uint8_t> ended(before.size());
  std::transform(before.begin(), before.end(), ended.begin(), [](uint8_t e) { return e != 0; });
  if (std::find(ended.begin(), ended.end(), 1) != ended.end()) {
    begin_next(ended);
    if (take_ && ended[watched()]) {
      remember();
      take_->begin = at_;
      take_->pushed = false;
    }
  }
  if (grab_ && grab_->leads) lead();
  actor_->act(*pool_, nullptr, [&] {
    if (by_hand_) std::copy(own_.begin(), own_.end(), pool_->action()[watched()].begin());
  });
  push();
  if (take_) take_->recorder->before(watched(), take_->episodes), take_->by_hand |= by_hand_;
  pool_->step();
  ++steps_;
  if (take_) note_step();
  remember();
  if (stops_ && history_.at(at_).rows.ended[watched()]) plays_ = false;
}

// An episode in which something was pushed is no demonstration: what was done is not in its actions.
void Session::note_step() {
  Take& t = *take_;
  const bool over = pool_->terminated()[watched()] || pool_->truncated()[watched()];
  if (over && t.pushed) {
    t.recorder->rewind(watched(), 0);
    ++t.dropped;
    return;
  }
  t.recorder->after(watched(), t.episodes);
  if (over) ++t.episodes;
}

void Session::begin_take() {
  if (take_) throw Usage("a recording is already running");
  Take take;
  const std::filesystem::path path = settings_.record;
  take.file = takes_ == 0 ? settings_.record
                          : (path.parent_path() /
                             (path.stem().string() + format("-%d", takes_ + 1) + path.extension().string()))
                                .string();
  take.recorder = std::make_unique<Recorder>(take.file, *pool_, 0, false);
  ++takes_;
  take_ = std::move(take);
  reset(nullptr);
}

Json Session::end_take() {
  if (!take_) throw Usage("no recording is running");
  Take take = std::move(*take_);
  take_.reset();
  ++changes_;
  Json out = {{"episodes", take.episodes}, {"dropped", take.dropped}};
  if (take.episodes == 0) return out;
  // who drew actions by chance draws them again when it is played, whatever is done
  const std::string who = take.by_hand && !same_name(who_, "random") ? "by hand" : who_;
  const uint64_t steps = take.recorder->finish({who, settings_.pool.options, settings_.pool.seed});
  out["file"] = take.file;
  files_.push_back(take.file);
  out["steps"] = steps;
  return out;
}

void Session::finish() {
  if (take_) end_take();
}

}  // namespace tool
