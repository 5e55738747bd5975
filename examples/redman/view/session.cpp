#include "view/session.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <redman/sense.hpp>

#include "common/files.hpp"
#include "common/names.hpp"
#include "common/text.hpp"
#include "draw/image.hpp"
#include "draw/solid.hpp"
#include "play/shield_word.hpp"
#include "play/trained.hpp"
#include "web/page.hpp"

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

void append(std::vector<float>& out, const rdm_pose& pose) {
  for (const double v : pose.p) out.push_back(static_cast<float>(v));
  for (const double v : pose.q) out.push_back(static_cast<float>(v));
}
void append(std::vector<float>& out, const std::vector<rdm_pose>& poses) {
  for (const rdm_pose& pose : poses) append(out, pose);
}

constexpr int64_t kMostRows = 1200;  // of one frame

Json number(float x) {
  return std::isfinite(x) ? Json(x) : Json();
}
Json numbers(const float* from, size_t count) {
  Json out = Json::array();
  for (size_t i = 0; i < count; ++i) out.push_back(number(from[i]));
  return out;
}

Json shape_json(const redman::Pool& pool, const Body& body, int32_t index) {
  rdm_shape_info shape = RDM_INIT(rdm_shape_info);
  redman::check(rdm_pool_shape_at(pool.get(), index, &shape));
  Json out = {{"name", body.name},
              {"kind", body.kind},
              {"fixed", shape.fixed},
              {"size", body.size},
              {"color", body.color}};
  if (body.corners.empty()) return out;
  const Solid solid = make_hull(body.corners);
  out["mesh"] = {{"position", solid.points}, {"normal", solid.normals}, {"index", solid.triangles}};
  return out;
}

void read_point(const Document& asked, const char* key, double out[3]) {
  const Document& list = list_at(asked, key, 3);
  for (size_t k = 0; k < 3; ++k) out[k] = number_of(list[k], key, -1e6, 1e6);
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
    throw Usage("the episodes before are recorded: going back ends at the start of this one");
  pool_->set_state(history_.at(moment).state);
  at_ = moment;
  plays_ = false;
  grab_.reset();
  ++changes_;
}

void Session::begin_next(const std::vector<uint8_t>& ended) {
  pool_->reset(nullptr, ended.data());
  actor_->restart(ended.data());
  if (ended[watched()]) own_ = pool_->initial_mean();
}

void Session::reset(const uint64_t* seed) {
  leave_past();
  std::vector<uint64_t> seeds;
  for (size_t i = 0; seed && i < pool_->num_envs(); ++i) seeds.push_back(*seed + i);
  pool_->reset(seed ? seeds.data() : nullptr);
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
  double at[3], pull[3];
  point_of(pose, g.local, at);
  for (size_t k = 0; k < 3; ++k) pull[k] = g.to[k] - at[k];
  const double length = std::hypot(pull[0], pull[1], pull[2]), share = g.newton / std::max(g.reach, length);
  float force[3];
  for (size_t k = 0; k < 3; ++k) force[k] = static_cast<float>(share * pull[k]);
  redman::check(rdm_pool_push(pool_->get(), g.world, g.shape, force));
  g.force = share * length;
  if (take_ && g.world == watched_) take_->pushed = true;
}

void Session::lead() {
  const Grab& g = *grab_;
  take_over(true);
  if (!lead_->bring(*pool_, g.world, g.shape, g.local, g.to, own_.data())) {
    const std::string name = looks_.bodies[static_cast<size_t>(g.shape)].name;
    grab_.reset();
    throw Usage(name + ": no joint of the action moves it; pull it instead");
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
  if (take_) throw Usage("it records already");
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
  if (!take_) throw Usage("nothing is recorded");
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

Json Session::command(const Document& asked) {
  const std::string what = text_at(asked, "do", 16);
  const auto on = [&] { return flag_at(asked, "on"); };
  const auto world = [&] {
    return static_cast<int32_t>(integer_at(asked, "world", 0, static_cast<int64_t>(pool_->num_envs()) - 1));
  };
  const auto untaken = [&](const char* why) {
    if (take_) throw Usage(std::string(why) + ": end the recording first");
  };
  if (what == "picture") {
    const std::string camera = text_at(asked, "camera", 64);
    constexpr int32_t kWidth = 320, kHeight = 240;
    const Image image = {kWidth, kHeight,
                         as_usage([&] { return pool_->render(watched_, camera.c_str(), kWidth, kHeight); })};
    const std::string png = png_bytes(image);
    return {{"png", base64(png.data(), png.size())}};
  }
  if (what == "hash") return {{"hash", format("%016llx", static_cast<unsigned long long>(pool_->hash()))}};
  ++changes_;
  if (what == "play") {
    plays_ = on();
  } else if (what == "step") {
    plays_ = false;
    step();
  } else if (what == "seek") {
    seek(integer_at(asked, "at", 0, kMostExact));
    if (take_) take_->recorder->rewind(watched(), history_.at(at_).rows.step[watched()]);
  } else if (what == "reset") {
    const bool seeded = asked.contains("seed");
    const uint64_t seed = seeded ? seed_at(asked, "seed") : 0;
    reset(seeded ? &seed : nullptr);
  } else if (what == "speed") {
    speed_ = number_at(asked, "times", 0.01, 100);
  } else if (what == "stops") {
    stops_ = on();
  } else if (what == "act") {
    untaken("another actor");
    const std::string who = text_at(asked, "who");
    if (std::find(actors_.begin(), actors_.end(), who) == actors_.end())
      throw Usage(who + ": not one of those who can act here");
    set_actor(who, shield_);
    by_hand_ = false;
  } else if (what == "shield") {
    set_actor(who_, on());
  } else if (what == "hand") {
    take_over(on());
  } else if (what == "action") {
    const auto entry =
        static_cast<size_t>(integer_at(asked, "entry", 0, static_cast<int64_t>(own_.size()) - 1));
    const auto value = static_cast<float>(number_at(asked, "value", -1, 1));
    take_over(true);
    own_[entry] = value;
  } else if (what == "watch") {
    untaken("another world");
    watched_ = world();
    own_ = pool_->initial_mean();
  } else if (what == "contacts") {
    contacts_ = on();
  } else if (what == "grab") {
    Grab g;
    g.world = world();
    g.shape = static_cast<int32_t>(integer_at(asked, "shape", 0, pool_->spec().num_shapes - 1));
    if (std::find(moving_.begin(), moving_.end(), g.shape) == moving_.end())
      throw Usage(looks_.bodies[static_cast<size_t>(g.shape)].name + " never moves");
    read_point(asked, "local", g.local);
    read_point(asked, "to", g.to);
    g.newton = number_at(asked, "newton", 0, 1e4);
    g.reach = number_at(asked, "reach", 1e-3, 1e6);
    g.leads = asked.contains("leads") && flag_at(asked, "leads");
    if (g.leads && g.world != watched_)
      throw Usage("world " + std::to_string(g.world) + ": another one is acted in by hand");
    grab_ = g;
  } else if (what == "release") {
    grab_.reset();
  } else if (what == "set") {
    untaken("another option");
    PoolSettings next = settings_.pool;
    apply_sets({text_at(asked, "key", 64) + '=' + text_at(asked, "value", 256)}, next, nullptr);
    open(next, who_, shield_);
  } else if (what == "record") {
    if (!on()) return end_take();
    begin_take();
  } else {
    throw Usage(what + ": not something that can be asked for");
  }
  return Json::object();
}

Json Session::scene() const {
  const rdm_spec& spec = pool_->spec();
  Json shapes = Json::array(), costs = Json::array(), cameras = Json::array(), actions = Json::array(),
       options = Json::array();
  for (size_t i = 0; i < looks_.bodies.size(); ++i)
    shapes.push_back(shape_json(*pool_, looks_.bodies[i], static_cast<int32_t>(i)));
  std::vector<float> poses;  // of all shapes, those that stand too
  for (size_t i = 0; i < pool_->num_envs(); ++i) append(poses, pool_->poses(static_cast<int32_t>(i)));
  for (const CostCurve& c : looks_.costs)
    costs.push_back({{"name", c.name}, {"help", c.help}, {"limit", c.limit}});
  rdm_camera_info c = RDM_INIT(rdm_camera_info);
  for (int32_t i = 0; rdm_pool_camera_at(pool_->get(), i, &c) == RDM_OK; ++i)
    cameras.push_back({{"name", c.name},
                       {"eye", c.eye},
                       {"target", c.target},
                       {"fov_y", c.fov_y},
                       {"mounted", c.mount != 0}});
  std::vector<std::string> names(static_cast<size_t>(spec.action_dim));
  for (int32_t i = 0; i < spec.num_joints; ++i)
    if (const rdm_joint_info j = pool_->joint(i); j.action >= 0 && j.action < spec.action_dim)
      names[static_cast<size_t>(j.action)] = j.name;
  for (size_t i = 0; i < names.size(); ++i)
    actions.push_back(names[i].empty() ? format("action[%zu]", i) : names[i]);
  int32_t index = 0;
  for (const rdm_option_spec& o : task_options(spec.task)) {
    const char* key = nullptr;
    char text[RDM_TEXT_SIZE];
    if (rdm_pool_setting_at(pool_->get(), index++, &key, text) != RDM_OK) continue;
    options.push_back({{"key", o.key},
                       {"help", o.help},
                       {"kind", o.kind},
                       {"level", o.level},
                       {"value", text},
                       {"choices", o.choices ? o.choices : ""},
                       {"low", o.low},
                       {"high", o.high}});
  }
  return {{"say", "scene"},
          {"number", scene_number_},
          {"task", looks_.task},
          {"summary", looks_.summary},
          {"dt", looks_.control_dt},
          {"steps", spec.max_steps},
          {"worlds", pool_->num_envs()},
          {"obs", spec.obs_dim},
          {"shapes", shapes},
          {"moving", moving_},
          {"poses", poses},
          {"costs", costs},
          {"cameras", cameras},
          {"actions", actions},
          {"initial", own_},
          {"options", options},
          {"actors", actors_},
          {"record", settings_.record}};
}

// u32 length of the JSON text (padded with spaces to 4 bytes), the text, then float32, little-endian: poses
// [worlds][moving][7], contacts of the watched world [contacts][6] position and force, points [points][3] of its cloud and what each lies on [points].
std::string Session::frame(int64_t since) const {
  const History::Rows& r = history_.at(at_).rows;
  const size_t n = pool_->num_envs(), costs = looks_.costs.size(), width = own_.size();
  std::vector<float> values;
  for (size_t i = 0; i < n; ++i) {
    const std::vector<rdm_pose> poses = pool_->poses(static_cast<int32_t>(i));
    for (const int32_t shape : moving_) append(values, poses[static_cast<size_t>(shape)]);
  }
  size_t contacts = 0, points = 0;
  if (contacts_) {
    rdm_contact found[128];
    redman::check(rdm_pool_get_contacts(pool_->get(), watched_, found, 128, &contacts));
    contacts = std::min<size_t>(contacts, 128);
    for (size_t i = 0; i < contacts; ++i) {
      values.insert(values.end(), found[i].position, found[i].position + 3);
      values.insert(values.end(), found[i].force, found[i].force + 3);
    }
  }
  if (const rdm_sensors s = redman::sensors(*pool_);
      s.points && at_ == history_.last()) {  // they are no part of a state
    points = static_cast<size_t>(s.num_points);
    const size_t first = points * watched();
    values.insert(values.end(), s.points + 3 * first, s.points + 3 * (first + points));
    for (size_t i = first; i < first + points; ++i) values.push_back(static_cast<float>(s.point_class[i]));
  }
  Json head = {{"at", at_},
               {"first", take_ ? std::max(history_.first(), take_->begin) : history_.first()},
               {"last", history_.last()},
               {"plays", plays_},
               {"speed", speed_},
               {"stops", stops_},
               {"who", who_},
               {"hand", by_hand_},
               {"shield", shield_},
               {"watched", watched_},
               {"contacts", contacts},
               {"points", points},
               {"step", r.step},
               {"reward", numbers(r.reward.data(), n)},
               {"return", numbers(r.episode_return.data(), n)},
               {"ended", r.ended},
               {"success", r.success},
               {"stepped_in", r.stepped_in},
               {"cost", numbers(r.cost.data() + watched() * costs, costs)},
               {"sum", numbers(r.episode_cost.data() + watched() * costs, costs)},
               {"action", by_hand_ ? numbers(own_.data(), width)
                                   : numbers(r.action.data() + watched() * width, width)}};
  // moments that were not shown: return and sums of costs of the watched world
  Json rows = Json::array();
  since = std::max({since, history_.first() - 1, at_ - kMostRows});
  for (int64_t k = since + 1; k <= at_; ++k) {
    const History::Rows& row = history_.at(k).rows;
    rows.push_back(numbers(row.episode_cost.data() + watched() * costs, costs));
    rows.back().insert(rows.back().begin(), number(row.episode_return[watched()]));
  }
  head["rows"] = rows;
  if (grab_) head["force"] = grab_->force;
  if (take_)
    head["take"] = {{"episodes", take_->episodes},
                    {"dropped", take_->dropped},
                    {"pushed", take_->pushed},
                    {"file", take_->file}};
  std::string text = json_text(head);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto size = static_cast<uint32_t>(text.size());
  std::string out(reinterpret_cast<const char*>(&size), sizeof size);
  out += text;
  return out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
}

void Session::finish() {
  if (take_) end_take();
}

Json Session::summary() const {
  return {{"task", looks_.task},
          {"worlds", pool_->num_envs()},
          {"steps", steps_},
          {"moments", history_.last() - history_.first() + 1},
          {"history_bytes", history_.bytes()},
          {"files", files_},
          {"hash", format("%016llx", static_cast<unsigned long long>(pool_->hash()))}};
}

}  // namespace tool
