#include "view/fed.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "common/posix.hpp"
#include "common/report.hpp"
#include "common/text.hpp"
#include "view/lead.hpp"

namespace tool {
namespace {

constexpr size_t kMostWaiting = 64;  // messages that are read ahead

size_t memory_of(const FeedFrame& f) {
  size_t floats = f.poses.size() + f.contacts.size() + f.points.size();
  for (const FeedFrame::Row& r : f.rows) floats += 16 + r.cost.size() + r.sum.size() + r.action.size();
  return sizeof f + sizeof(float) * floats;
}

}  // namespace

Fed::Fed(int descriptor, Say say, size_t history_bytes, bool plays)
    : say_(say), most_(history_bytes), inbox_(std::make_shared<Inbox>()), plays_(plays) {
  std::thread(read, descriptor, inbox_).detach();  // a read cannot be called back
}

Fed::~Fed() {
  const std::lock_guard lock(inbox_->mutex);
  inbox_->ended = true;
}

void Fed::read(int descriptor, std::shared_ptr<Inbox> inbox) {
  FeedReader reader;
  std::string trouble;
  try {
    std::vector<char> part(size_t{1} << 16);
    for (;;) {
      const auto n = ::read(descriptor, part.data(), part.size());
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) break;
      reader.add(part.data(), static_cast<size_t>(n));
      FeedMessage message;
      while (reader.next(&message)) {
        for (;;) {
          {
            const std::lock_guard lock(inbox->mutex);
            if (inbox->ended) return;
            if (inbox->messages.size() < kMostWaiting) {
              inbox->messages.push_back(std::move(message));
              break;
            }
          }
          std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
      }
    }
  } catch (const std::exception& e) {
    trouble = e.what();
  }
  const std::lock_guard lock(inbox->mutex);
  inbox->trouble = trouble;
  inbox->ended = true;
}

bool Fed::listen(size_t windows) {
  windows_ = windows;
  std::deque<FeedMessage> messages;
  bool ended = false;
  std::string trouble;
  {
    const std::lock_guard lock(inbox_->mutex);
    messages.swap(inbox_->messages);
    ended = inbox_->ended;
    trouble = inbox_->trouble;
  }
  for (FeedMessage& message : messages) take(std::move(message));
  if (!trouble.empty()) throw Failure("--feed: " + trouble);
  tell();
  return !ended;
}

void Fed::take(FeedMessage&& message) {
  if (text_at(message.head, "say", 16) == "scene") {
    scene_.emplace(message);
    watched_ = std::min(watched_, static_cast<int32_t>(scene_->worlds) - 1);
    first_ = last() + 1;
    frames_.clear();
    grab_.reset();
    by_hand_ = records_ = false;
    shield_ = shield_ && scene_->shields;
    own_.assign(scene_->actions.size(), 0);
    return;
  }
  if (!scene_) throw Failure("--feed: a frame came before its scene");
  FeedFrame frame(*scene_, message);
  if (frames_.empty()) ++scene_number_;
  const bool newest = frames_.empty() || at_ == last();
  if (leads()) own_ = frame.rows[static_cast<size_t>(watched_)].action;
  frames_.push_back(std::move(frame));
  steps_ += frames_.size() > 1;
  // the number of frames that fit is that of this one's size
  for (const size_t most = std::max<size_t>(2, most_ / memory_of(frames_.back())); frames_.size() > most;
       ++first_)
    frames_.pop_front();
  if (newest || at_ < first_) at_ = newest ? last() : first_;
  ++changes_;
}

// What a window holds is pulled from where the last frame has it.
Json Fed::push() const {
  if (!grab_ || leads() || frames_.empty()) return {};
  const Grab& g = *grab_;
  const auto found = std::find(scene_->moving.begin(), scene_->moving.end(), g.shape);
  const float* row = &frames_.back().poses[7 * (static_cast<size_t>(g.world) * scene_->moving.size() +
                                                static_cast<size_t>(found - scene_->moving.begin()))];
  rdm_pose pose = {};
  std::copy_n(row, 3, pose.p);
  std::copy_n(row + 3, 4, pose.q);
  double at[3];
  float force[3];
  point_of(pose, g.local, at);
  pull_of(at, g.to, g.newton, g.reach, force);
  return {g.world, g.shape, force[0], force[1], force[2]};
}

void Fed::tell() {
  Json lead;
  if (leads()) {
    lead = {grab_->world, grab_->shape};
    for (const double* point : {grab_->local, grab_->to})
      for (size_t k = 0; k < 3; ++k) lead.push_back(point[k]);
  }
  const Json line = {{"windows", windows_},
                     {"plays", plays_},
                     {"speed", speed_},
                     {"steps", asked_},
                     {"watched", watched_},
                     {"contacts", contacts_},
                     {"record", records_},
                     {"push", push()},
                     {"lead", lead},
                     {"shield", shield_},
                     {"action", by_hand_ && !leads() ? numbers_json(own_.data(), own_.size()) : Json()}};
  std::string text = json_text(line);
  if (text == said_) return;
  say_(text);
  said_ = std::move(text);
}

Json Fed::command(const Document& asked) {
  const std::string what = text_at(asked, "do", 16);
  if (frames_.empty() && what != "play" && what != "speed" && what != "contacts")
    throw Usage(what + ": the program has shown nothing yet");
  const auto on = [&] { return flag_at(asked, "on"); };
  const auto world = [&] {
    return static_cast<int32_t>(integer_at(asked, "world", 0, static_cast<int64_t>(scene_->worlds) - 1));
  };
  ++changes_;
  if (what == "play") {
    plays_ = on();
    if (plays_ && !frames_.empty()) at_ = last();
  } else if (what == "step") {
    plays_ = false;
    at_ = last();
    ++asked_;
  } else if (what == "seek") {
    at_ = std::clamp(integer_at(asked, "at", 0, kMostExact), first_, last());
    plays_ = false;
    grab_.reset();
  } else if (what == "speed") {
    speed_ = number_at(asked, "times", 0.01, 100);
  } else if (what == "contacts") {
    contacts_ = on();
  } else if (what == "watch") {
    watched_ = world();
    by_hand_ = false;
    if (leads()) grab_.reset();
  } else if (what == "hand" || what == "action") {
    const std::vector<float>& action = frames_.back().rows[static_cast<size_t>(watched_)].action;
    if (!by_hand_) own_ = action;
    by_hand_ = what == "action" || on();
    if (what == "action")
      own_[static_cast<size_t>(integer_at(asked, "entry", 0, static_cast<int64_t>(own_.size()) - 1))] =
          static_cast<float>(number_at(asked, "value", -1, 1));
  } else if (what == "grab") {
    Grab g;
    g.world = world();
    g.shape = static_cast<int32_t>(
        integer_at(asked, "shape", 0, static_cast<int64_t>(scene_->looks.bodies.size()) - 1));
    if (std::find(scene_->moving.begin(), scene_->moving.end(), g.shape) == scene_->moving.end())
      throw Usage(scene_->looks.bodies[static_cast<size_t>(g.shape)].name + " never moves");
    for (const char* key : {"local", "to"}) {
      const Document& list = list_at(asked, key, 3);
      for (size_t k = 0; k < 3; ++k) (*key == 'l' ? g.local : g.to)[k] = number_of(list[k], key, -1e6, 1e6);
    }
    g.newton = number_at(asked, "newton", 0, 1e4);
    g.reach = number_at(asked, "reach", 1e-3, 1e6);
    g.leads = asked.contains("leads") && flag_at(asked, "leads");
    if (g.leads && !scene_->leads)
      throw Usage("lead: these worlds run in another program, which does not lead; pull instead");
    if (g.leads && g.world != watched_)
      throw Usage("world " + std::to_string(g.world) + ": only the chosen world can be led by hand");
    if (g.leads && !leads()) own_ = frames_.back().rows[static_cast<size_t>(watched_)].action;
    by_hand_ = by_hand_ || g.leads;
    grab_ = g;
  } else if (what == "release") {
    grab_.reset();
  } else if (what == "shield") {
    if (!scene_->shields)
      throw Usage(
          "shield: these worlds run in another program, which gave none: redman.view(pool, shield=...)");
    shield_ = on();
  } else if (what == "record") {
    if (scene_->record.empty())
      throw Usage("record: these worlds run in another program, which gave no file");
    records_ = on();
    tell();
    const std::optional<FeedFrame::Take>& take = frames_.back().take;
    if (records_ || !take) return Json::object();
    Json out = {{"episodes", take->episodes}, {"dropped", take->dropped}};
    if (take->episodes > 0) out["file"] = scene_->record, out["steps"] = take->steps;
    return out;
  } else {
    throw Usage(what + ": these worlds run in another program, which does not do that");
  }
  tell();
  return Json::object();
}

Json Fed::scene() const {
  const Playback& looks = scene_->looks;
  Json shapes = Json::array(), costs = Json::array(), cameras = Json::array();
  for (size_t i = 0; i < looks.bodies.size(); ++i)
    shapes.push_back(shape_json(looks.bodies[i], std::find(scene_->moving.begin(), scene_->moving.end(),
                                                           static_cast<int32_t>(i)) == scene_->moving.end()));
  for (const CostCurve& c : looks.costs)
    costs.push_back({{"name", c.name}, {"help", c.help}, {"limit", c.limit}});
  for (size_t i = 0; i < looks.cameras.size(); ++i) {
    const rdm_camera_info& c = looks.cameras[i];
    cameras.push_back({{"name", c.name},
                       {"eye", c.eye},
                       {"target", c.target},
                       {"fov_y", c.fov_y},
                       {"mounted", scene_->mounted[i] != 0}});
  }
  return {{"say", "scene"},
          {"number", scene_number_},
          {"fed", true},
          {"leads", scene_->leads},
          {"shields", scene_->shields},
          {"task", looks.task},
          {"summary", looks.summary},
          {"dt", looks.control_dt},
          {"steps", scene_->max_steps},
          {"worlds", scene_->worlds},
          {"obs", scene_->obs},
          {"shapes", shapes},
          {"moving", scene_->moving},
          {"poses", scene_->poses},
          {"costs", costs},
          {"cameras", cameras},
          {"actions", scene_->actions},
          {"initial", std::vector<float>(scene_->actions.size(), 0)},
          {"options", Json::array()},
          {"actors", {looks.actor}},
          {"record", scene_->record}};
}

std::string Fed::frame(int64_t since) const {
  const FeedFrame& f = now();
  const FeedFrame::Row& own = f.rows[static_cast<size_t>(watched_)];
  Json step = Json::array(), reward = Json::array(), sums = Json::array(), ended = Json::array(),
       success = Json::array(), stepped_in = Json::array(), rows = Json::array();
  for (const FeedFrame::Row& r : f.rows) {
    step.push_back(r.step);
    reward.push_back(number_json(r.reward));
    sums.push_back(number_json(r.episode_return));
    ended.push_back(r.ended);
    success.push_back(r.success);
    stepped_in.push_back(r.stepped_in);
  }
  since = std::max({since, first_ - 1, at_ - kMostRows});
  for (int64_t k = since + 1; k <= at_; ++k) {
    const FeedFrame::Row& r = frames_[static_cast<size_t>(k - first_)].rows[static_cast<size_t>(watched_)];
    rows.push_back(numbers_json(r.sum.data(), r.sum.size()));
    rows.back().insert(rows.back().begin(), number_json(r.episode_return));
  }
  Json take;
  if (records_ && frames_.back().take) {
    const FeedFrame::Take& t = *frames_.back().take;
    take = {{"episodes", t.episodes}, {"dropped", t.dropped}, {"pushed", t.pushed}, {"file", scene_->record}};
  }
  std::vector<float> numbers = f.poses;
  const bool own_world = f.world == watched_;  // else what it touches and sees comes with the next frame
  const size_t contacts = contacts_ && own_world ? f.contacts.size() / 6 : 0;
  const size_t points = own_world ? f.points.size() / 4 : 0;
  if (contacts) numbers.insert(numbers.end(), f.contacts.begin(), f.contacts.end());
  if (points) numbers.insert(numbers.end(), f.points.begin(), f.points.end());
  return frame_bytes({{"at", at_},
                      {"first", first_},
                      {"last", last()},
                      {"plays", plays_},
                      {"speed", speed_},
                      {"stops", false},
                      {"who", scene_->looks.actor},
                      {"hand", by_hand_},
                      {"shield", shield_},
                      {"watched", watched_},
                      {"contacts", contacts},
                      {"points", points},
                      {"step", step},
                      {"reward", reward},
                      {"return", sums},
                      {"ended", ended},
                      {"success", success},
                      {"stepped_in", stepped_in},
                      {"cost", numbers_json(own.cost.data(), own.cost.size())},
                      {"sum", numbers_json(own.sum.data(), own.sum.size())},
                      {"action", by_hand_ ? numbers_json(own_.data(), own_.size())
                                          : numbers_json(own.action.data(), own.action.size())},
                      {"rows", rows},
                      {"take", take}},
                     numbers);
}

Json Fed::summary() const {
  return {{"task", scene_ ? scene_->looks.task : ""},
          {"worlds", scene_ ? scene_->worlds : 0},
          {"steps", steps_},
          {"moments", frames_.size()},
          {"files", Json::array()}};
}

}  // namespace tool
