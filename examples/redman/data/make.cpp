#include "data/make.hpp"

#include <algorithm>
#include <map>
#include <memory>

#include "common/names.hpp"
#include "common/text.hpp"
#include "data/mixture.hpp"
#include "data/summary.hpp"
#include "play/actor.hpp"
#include "play/trained.hpp"

namespace tool {
namespace {

constexpr int32_t kDataWorlds =
    64;  // episode e is played by world e mod 64: their number is part of the bytes

class Mixture {
 public:
  Mixture(const MakeSettings& settings, redman::Pool& pool, std::vector<std::unique_ptr<Actor>> actors)
      : pool_(pool),
        actors_(std::move(actors)),
        mixture_(mixture_of(!actors_.empty())),
        seed_(settings.pool.seed),
        width_(pool.action().width()),
        worlds_(pool.num_envs()) {
    for (size_t i = 0; i < worlds_.size(); ++i) begin(i, i);
  }

  // Fills the actions of all worlds.
  void act() {
    if (std::any_of(worlds_.begin(), worlds_.end(), [&](const World& w) { return base(w) == Base::kHold; }))
      pool_.baseline(RDM_BASELINE_HOLD);
    for (size_t a = 0; a < actors_.size(); ++a) {
      bool any = false;
      mask_.assign(worlds_.size(), 0);
      for (size_t i = 0; i < worlds_.size(); ++i)
        if (base(worlds_[i]) == Base::kPolicy && worlds_[i].policy == a) mask_[i] = 1, any = true;
      if (any) actors_[a]->act(pool_, mask_.data());
    }
    for (size_t i = 0; i < worlds_.size(); ++i) {
      World& w = worlds_[i];
      float* const row = pool_.action()[i].begin();
      if (base(w) == Base::kZero) std::fill_n(row, width_, 0.0f);
      DataEpisode& e = w.played;
      e.obs.insert(e.obs.end(), pool_.obs()[i].begin(), pool_.obs()[i].end());
      e.label.resize(e.label.size() + width_);
      w.noise.apply(row, e.label.data() + e.label.size() - width_);
      e.action.insert(e.action.end(), row, row + width_);
    }
  }

  // After the step: notes what came of it, and begins episodes where others ended.
  void note(std::map<uint64_t, DataEpisode>& done) {
    mask_.assign(worlds_.size(), 0);
    bool any = false;
    for (size_t i = 0; i < worlds_.size(); ++i) {
      World& w = worlds_[i];
      DataEpisode& e = w.played;
      e.reward.push_back(pool_.reward()[i]);
      e.cost.insert(e.cost.end(), pool_.cost()[i].begin(), pool_.cost()[i].end());
      e.terminated.push_back(pool_.terminated()[i]);
      e.truncated.push_back(pool_.truncated()[i] && !pool_.terminated()[i]);
      e.success.push_back(pool_.success()[i]);
      w.trouble = w.trouble || (pool_.status()[i] & RDM_STATUS_DIVERGED) != 0;
      if (!e.ended()) continue;
      e.final_obs.assign(pool_.obs()[i].begin(), pool_.obs()[i].end());
      e.source = static_cast<uint8_t>(w.source);
      if (w.trouble) e = DataEpisode();  // physics that failed is no data
      done.emplace(w.episode, std::move(e));
      mask_[i] = 1, any = true;
      begin(i, w.episode + worlds_.size());
    }
    if (!any) return;
    pool_.reset(nullptr, mask_.data());
    for (const auto& actor : actors_) actor->restart(mask_.data());
  }

  const std::vector<Source>& sources() const { return mixture_; }

 private:
  struct World {
    uint64_t episode = 0;
    size_t source = 0, policy = 0;
    bool trouble = false;
    EpisodeNoise noise;
    DataEpisode played;
  };
  Base base(const World& w) const { return mixture_[w.source].base; }
  void begin(size_t i, uint64_t episode) {
    World& w = worlds_[i];
    w.episode = episode;
    w.source = source_of(mixture_, episode);
    w.policy = policy_of(episode, actors_.size());
    w.trouble = false;
    w.noise.begin(seed_, episode, mixture_[w.source], width_);
    w.played = DataEpisode();
  }

  redman::Pool& pool_;
  std::vector<std::unique_ptr<Actor>> actors_;
  const std::vector<Source>& mixture_;
  uint64_t seed_;
  size_t width_;
  std::vector<World> worlds_;
  std::vector<uint8_t> mask_;
};

Json note_of(const MakeSettings& settings, const redman::Pool& pool, const std::vector<std::string>& policies,
             const std::vector<Source>& sources) {
  const rdm_spec& spec = pool.spec();
  Json fields = Json::array(), costs = Json::array(), set = Json::array(), names = Json::array();
  for (int32_t i = 0; i < spec.num_fields; ++i) {
    rdm_field_info f = RDM_INIT(rdm_field_info);
    redman::check(rdm_pool_field_at(pool.get(), i, &f));
    fields.push_back({{"name", f.name}, {"unit", f.unit}, {"offset", f.offset}, {"count", f.count}});
  }
  const std::vector<double> limits = cost_limits(pool, {});
  for (const rdm_cost_info& c : task_costs(spec.task)) {
    const double limit = limits[costs.size()];
    costs.push_back({{"name", c.name}, {"limit", limit < 0 ? Json() : Json(limit)}});
  }
  for (const auto& [key, value] : settings.pool.options) set.push_back(key + "=" + value);
  for (const Source& s : sources) names.push_back(s.name);
  Json limits_of = Json::array();
  for (const double d : settings.limits) limits_of.push_back(d);
  if (limits_of.empty() && !limits.empty() && limits[0] >= 0)
    for (const double share : {0.5, 1.0, 2.0}) limits_of.push_back(share * limits[0]);
  return {{"format", kDataFormat},
          {"task", task_at(spec.task).name},
          {"published", settings.published ? Json(settings.published) : Json()},
          {"set", set},
          {"seed", settings.pool.seed},
          {"policies", policies},
          {"mixture", 1},
          {"sources", names},
          {"control_dt", static_cast<double>(spec.control_dt)},
          {"action_repeat", spec.action_repeat},
          {"max_steps", spec.max_steps},
          {"limits", limits_of},
          {"fields", fields},
          {"costs", costs}};
}

}  // namespace

DataSet make_set(const MakeSettings& given) {
  MakeSettings settings = given;
  const std::string task = task_at(find_task(settings.pool.task)).name;
  std::vector<std::string> words = settings.policies;
  if (words.empty() && has_trained_policy(task)) words.emplace_back("trained");
  std::vector<ActorChoice> choices;
  for (const std::string& word : words) {
    choices.push_back(choose_actor(word, task));
    const ActorChoice& c = choices.back();
    if (c.baseline >= 0 || c.recording || c.plan)
      throw Usage(
          "--policy " + printable(word) +
          ": give trained, a policy file, a run folder, demo or a .demo file; hold, zero and uniform actions "
          "are in every mixture");
  }
  // what the first policy's run says of the task lies under the flags
  if (!choices.empty()) adopt_task(choices[0], true, settings.sets, settings.pool);
  apply_sets(settings.sets, settings.pool, nullptr);
  const auto says = [&](const char* key) {
    return std::any_of(settings.pool.options.begin(), settings.pool.options.end(),
                       [&](const auto& option) { return same_name(option.first, key); });
  };
  // a row is a decision: the first policy's, else as many control steps as the task recommends
  const int32_t repeat = choices.empty() || choices[0].file.empty() ? 0 : choices[0].repeat;
  if (!says("action_repeat"))
    settings.pool.options.insert(settings.pool.options.begin(), {"action_repeat", std::to_string(repeat)});
  settings.pool.envs = kDataWorlds;
  redman::Pool pool = make_pool(settings.pool, RDM_AUTORESET_OFF);
  std::vector<std::unique_ptr<Actor>> actors;
  for (const ActorChoice& c : choices) actors.push_back(std::make_unique<Actor>(c, pool));
  pool.reset();
  for (const auto& actor : actors) actor->restart();

  Mixture mixture(settings, pool, std::move(actors));
  std::map<uint64_t, DataEpisode> done;  // those behind one that still runs
  DataSet set;
  uint64_t next = 0, rows = 0;
  while (rows < settings.rows) {
    mixture.act();
    pool.step();
    mixture.note(done);
    for (auto at = done.begin(); rows < settings.rows && at != done.end() && at->first == next; ++next) {
      rows += at->second.rows();
      if (at->second.rows() > 0) set.episodes.push_back(std::move(at->second));
      at = done.erase(at);
    }
  }
  const rdm_spec& spec = pool.spec();
  set.task = task;
  set.layout_hash = spec.layout_hash;
  set.obs_dim = static_cast<size_t>(spec.obs_dim);
  set.action_dim = static_cast<size_t>(spec.action_dim);
  set.cost_dim = static_cast<size_t>(spec.cost_dim);
  set.labels = set.sources = true;
  set.metadata = note_of(settings, pool, words, mixture.sources());
  const ReturnRange range = return_range(set);
  set.metadata["rows"] = rows;
  set.metadata["episodes"] = set.episodes.size();
  set.metadata["return_min"] = range.least;
  set.metadata["return_max"] = range.most;
  return set;
}

}  // namespace tool
