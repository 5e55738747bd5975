// What a page and a session say to each other (messages of the page in view.js).
#include <algorithm>
#include <cmath>
#include <map>
#include <redman/sense.hpp>

#include "common/names.hpp"
#include "common/setting.hpp"
#include "common/text.hpp"
#include "draw/image.hpp"
#include "draw/solid.hpp"
#include "view/session.hpp"
#include "web/page.hpp"

namespace tool {
namespace {
void append(std::vector<float>& out, const rdm_pose& pose) {
  for (const double v : pose.p) out.push_back(static_cast<float>(v));
  for (const double v : pose.q) out.push_back(static_cast<float>(v));
}
void append(std::vector<float>& out, const std::vector<rdm_pose>& poses) {
  for (const rdm_pose& pose : poses) append(out, pose);
}

void read_point(const Document& asked, const char* key, double out[3]) {
  const Document& list = list_at(asked, key, 3);
  for (size_t k = 0; k < 3; ++k) out[k] = number_of(list[k], key, -1e6, 1e6);
}

}  // namespace

Json number_json(float x) {
  return std::isfinite(x) ? Json(x) : Json();
}

Json numbers_json(const float* from, size_t count) {
  Json out = Json::array();
  for (size_t i = 0; i < count; ++i) out.push_back(number_json(from[i]));
  return out;
}

Json shape_json(const Body& body, bool fixed) {
  Json out = {
      {"name", body.name}, {"kind", body.kind}, {"fixed", fixed}, {"size", body.size}, {"color", body.color}};
  if (body.corners.empty()) return out;
  const Solid solid = make_hull(body.corners);
  out["mesh"] = {{"position", solid.points}, {"normal", solid.normals}, {"index", solid.triangles}};
  return out;
}

double pull_of(const double at[3], const double to[3], double newton, double reach, float force[3]) {
  double pull[3];
  for (size_t k = 0; k < 3; ++k) pull[k] = to[k] - at[k];
  const double length = std::hypot(pull[0], pull[1], pull[2]), share = newton / std::max(reach, length);
  for (size_t k = 0; k < 3; ++k) force[k] = static_cast<float>(share * pull[k]);
  return share * length;
}

// u32 length of the JSON text (padded with spaces to 4 bytes), the text, then float32, little-endian.
std::string frame_bytes(const Json& head, const std::vector<float>& numbers) {
  std::string text = json_text(head);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto size = static_cast<uint32_t>(text.size());
  std::string out(reinterpret_cast<const char*>(&size), sizeof size);
  out += text;
  return out.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float));
}

Json Session::command(const Document& asked) {
  const std::string what = text_at(asked, "do", 16);
  const auto on = [&] { return flag_at(asked, "on"); };
  const auto world = [&] {
    return static_cast<int32_t>(integer_at(asked, "world", 0, static_cast<int64_t>(pool_->num_envs()) - 1));
  };
  const auto untaken = [&](const char* why) {
    if (take_) throw Usage(std::string(why) + ": not while recording; end the recording first");
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
      throw Usage(
          who +
          ": this page cannot act with it; it offers only those given by --policy, zero, hold and random");
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
      throw Usage("world " + std::to_string(g.world) + ": only the chosen world can be led by hand");
    grab_ = g;
  } else if (what == "release") {
    grab_.reset();
  } else if (what == "set") {
    untaken("another option");
    PoolSettings next = settings_.pool;
    apply_sets({text_at(asked, "key", 64) + '=' + text_at(asked, "value", 256)}, next, nullptr);
    open(next, who_, shield_);
  } else if (what == "limit") {
    if (limit_range_[0] < 0)
      throw Usage("limit: these worlds do not observe one; begin with --set limit_range=5..40, for example");
    const double limit = number_at(asked, "value", limit_range_[0], limit_range_[1]);
    for (const uint8_t over : history_.at(at_).rows.ended)
      if (over) throw Usage("limit: an episode is over; step once more, or reset");
    limit_ = limit;
    keep_limit();
  } else if (what == "record") {
    if (!on()) return end_take();
    begin_take();
  } else {
    throw Usage(what + ": unknown command of the page");
  }
  return Json::object();
}

Json Session::scene() const {
  const rdm_spec& spec = pool_->spec();
  Json shapes = Json::array(), costs = Json::array(), cameras = Json::array(), actions = Json::array(),
       options = Json::array();
  for (size_t i = 0; i < looks_.bodies.size(); ++i)
    shapes.push_back(shape_json(looks_.bodies[i], std::find(moving_.begin(), moving_.end(),
                                                            static_cast<int32_t>(i)) == moving_.end()));
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
  std::map<std::string, std::string> values;
  for (const auto& [key, value] : pool_settings(*pool_)) values[key] = value;
  for (const rdm_option_spec& o : task_options(spec.task)) {
    const auto value = values.find(o.key);
    if (value == values.end()) continue;  // of a joint that this pool's robots lack
    options.push_back({{"key", o.key},
                       {"help", o.help},
                       {"kind", o.kind},
                       {"level", o.level},
                       {"value", value->second},
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
          {"limit_range", limit_range_[0] < 0 ? Json() : Json(limit_range_)},
          {"actors", actors_},
          {"record", settings_.record}};
}

// Its numbers: poses
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
               {"reward", numbers_json(r.reward.data(), n)},
               {"return", numbers_json(r.episode_return.data(), n)},
               {"ended", r.ended},
               {"success", r.success},
               {"stepped_in", r.stepped_in},
               {"cost", numbers_json(r.cost.data() + watched() * costs, costs)},
               {"sum", numbers_json(r.episode_cost.data() + watched() * costs, costs)},
               {"action", by_hand_ ? numbers_json(own_.data(), width)
                                   : numbers_json(r.action.data() + watched() * width, width)}};
  if (limit_range_[0] >= 0)  // the last entry of a row is the share of the largest one
    head["limit"] = limit_range_[1] * static_cast<double>(pool_->obs()[watched()][pool_->obs().width() - 1]);
  // moments that were not shown: return and sums of costs of the watched world
  Json rows = Json::array();
  since = std::max({since, history_.first() - 1, at_ - kMostRows});
  for (int64_t k = since + 1; k <= at_; ++k) {
    const History::Rows& row = history_.at(k).rows;
    rows.push_back(numbers_json(row.episode_cost.data() + watched() * costs, costs));
    rows.back().insert(rows.back().begin(), number_json(row.episode_return[watched()]));
  }
  head["rows"] = rows;
  if (grab_) head["force"] = grab_->force;
  if (take_)
    head["take"] = {{"episodes", take_->episodes},
                    {"dropped", take_->dropped},
                    {"pushed", take_->pushed},
                    {"file", take_->file}};
  return frame_bytes(head, values);
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
