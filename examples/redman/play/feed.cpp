#include "play/feed.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/files.hpp"
#include "common/report.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

constexpr size_t kRowHead = 6;  // numbers of a row before its costs
constexpr int64_t kMostParts = 1 << 16, kMostWorlds = 64;

uint32_t size_at(const std::string& bytes, size_t at) {
  uint32_t size = 0;
  std::memcpy(&size, bytes.data() + at, sizeof size);
  return size;
}

const Document& members_of(const Document& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() > static_cast<size_t>(kMostParts))
    throw Failure(std::string(key) + ": it is not a list of up to " + std::to_string(kMostParts));
  return *found;
}

template <class T>
void numbers_at(const Document& object, const char* key, T* out, size_t count) {
  const Document& list = list_at(object, key, count);
  for (size_t k = 0; k < count; ++k) out[k] = static_cast<T>(number_of(list[k], key, -1e9, 1e9));
}

Body body_of(const Document& shape) {
  Body body;
  body.name = text_at(shape, "name", RDM_TEXT_SIZE);
  body.kind = static_cast<int32_t>(integer_at(shape, "kind", RDM_SHAPE_SPHERE, RDM_SHAPE_HULL));
  numbers_at(shape, "size", body.size, 3);
  int32_t color[3];
  numbers_at(shape, "color", color, 3);
  for (size_t k = 0; k < 3; ++k) body.color[k] = static_cast<uint8_t>(std::clamp(color[k], 0, 255));
  if (body.kind != RDM_SHAPE_HULL) return body;
  const size_t count = members_of(shape, "corners").size();
  if (count % 3 != 0 || count < 12) throw Failure("corners: fewer than 4 points of 3 numbers");
  body.corners.resize(count);
  numbers_at(shape, "corners", body.corners.data(), count);
  return body;
}

rdm_camera_info read_camera(const Document& camera, std::deque<std::string>& names) {
  rdm_camera_info out = RDM_INIT(rdm_camera_info);
  names.push_back(text_at(camera, "name", RDM_TEXT_SIZE));
  out.name = names.back().c_str();
  numbers_at(camera, "eye", out.eye, 3);
  numbers_at(camera, "target", out.target, 3);
  numbers_at(camera, "up", out.up, 3);
  out.fov_y = static_cast<float>(number_at(camera, "fov_y", 0, 4));
  return out;
}

}  // namespace

bool FeedReader::next(FeedMessage* out) {
  const size_t left = in_.size() - at_;
  if (left >= 4) {
    const size_t size = size_at(in_, at_);
    if (size < 4 || size > kMostBytes)
      throw Failure(format("a message of %zu bytes, not 4 to %zu", size, kMostBytes));
    if (left >= 4 + size) {
      const size_t text = size_at(in_, at_ + 4);
      if (text > size - 4 || (size - 4 - text) % sizeof(float) != 0)
        throw Failure(format("a message of %zu bytes with a text of %zu", size, text));
      out->head = parse_json(in_.data() + at_ + 8, text);
      out->numbers.resize((size - 4 - text) / sizeof(float));
      if (!out->numbers.empty())
        std::memcpy(out->numbers.data(), in_.data() + at_ + 8 + text, out->numbers.size() * sizeof(float));
      at_ += 4 + size;
      return true;
    }
  }
  in_.erase(0, at_);
  at_ = 0;
  return false;
}

FeedScene::FeedScene(const FeedMessage& message) {
  const Document& head = message.head;
  looks.task = text_at(head, "task");
  looks.summary = text_at(head, "summary");
  looks.actor = text_at(head, "actor");
  looks.seed = seed_at(head, "seed");
  looks.control_dt = number_at(head, "dt", 1e-6, 1e6);
  looks.first_step = static_cast<int32_t>(integer_at(head, "first", 0, INT32_MAX));
  max_steps = static_cast<int32_t>(integer_at(head, "steps", 1, INT32_MAX));
  obs = static_cast<int32_t>(integer_at(head, "obs", 0, INT32_MAX));
  worlds = static_cast<size_t>(integer_at(head, "worlds", 1, kMostWorlds));
  for (const Document& shape : members_of(head, "shapes")) {
    if (!flag_at(shape, "fixed")) moving.push_back(static_cast<int32_t>(looks.bodies.size()));
    looks.bodies.push_back(body_of(shape));
  }
  looks.names = std::make_shared<std::deque<std::string>>();
  for (const Document& camera : members_of(head, "cameras")) {
    looks.cameras.push_back(read_camera(camera, *looks.names));
    mounted.push_back(flag_at(camera, "mounted"));
  }
  for (const Document& cost : members_of(head, "costs"))
    looks.costs.push_back(
        {text_at(cost, "name", RDM_TEXT_SIZE), text_at(cost, "help"), number_at(cost, "limit", -1, 1e30)});
  actions = texts_at(head, "actions");
  record = text_at(head, "record");
  leads = head.contains("leads") && flag_at(head, "leads");
  shields = head.contains("shields") && flag_at(head, "shields");
  if (message.numbers.size() != worlds * looks.bodies.size() * 7)
    throw Failure("poses: they are not as many as the shapes of all worlds");
  poses = message.numbers;
}

FeedFrame::FeedFrame(const FeedScene& scene, const FeedMessage& message) {
  const auto count = static_cast<size_t>(integer_at(message.head, "contacts", 0, kMostParts)),
             seen = static_cast<size_t>(integer_at(message.head, "points", 0, kMostParts));
  world = static_cast<int32_t>(integer_at(message.head, "world", 0, static_cast<int64_t>(scene.worlds) - 1));
  const size_t costs = scene.looks.costs.size(), width = kRowHead + 2 * costs + scene.actions.size(),
               posed = scene.worlds * scene.moving.size() * 7;
  if (message.numbers.size() != posed + scene.worlds * width + 6 * count + 4 * seen)
    throw Failure(format("a frame of %zu numbers does not fit its scene", message.numbers.size()));
  const float* at = message.numbers.data();
  poses.assign(at, at + posed);
  at += posed;
  for (size_t i = 0; i < scene.worlds; ++i, at += width) {
    Row row;
    row.reward = at[0];
    row.episode_return = at[1];
    if (!(at[2] >= 0 && at[2] < 16777216)) throw Failure("step: it is not a whole number below 2^24");
    row.step = static_cast<int32_t>(at[2]);
    row.ended = at[3] == 2 ? 2 : at[3] == 1 ? 1 : 0;
    row.success = at[4] > 0;
    row.stepped_in = at[5] > 0;
    row.cost.assign(at + kRowHead, at + kRowHead + costs);
    row.sum.assign(at + kRowHead + costs, at + kRowHead + 2 * costs);
    row.action.assign(at + kRowHead + 2 * costs, at + width);
    rows.push_back(std::move(row));
  }
  contacts.assign(at, at + 6 * count);
  points.assign(at + 6 * count, at + 6 * count + 4 * seen);
  if (const auto said = message.head.find("take"); said != message.head.end())
    take = {integer_at(*said, "episodes", 0, kMostExact), integer_at(*said, "dropped", 0, kMostExact),
            integer_at(*said, "steps", 0, kMostExact), flag_at(*said, "pushed")};
}

namespace {

void add_frame(Playback& p, const FeedScene& scene, const FeedFrame& frame) {
  std::vector<float> poses = scene.poses;  // of what stands
  for (size_t k = 0; k < scene.moving.size(); ++k)
    std::copy_n(frame.poses.begin() + static_cast<ptrdiff_t>(7 * k), 7,
                poses.begin() + static_cast<ptrdiff_t>(7 * static_cast<size_t>(scene.moving[k])));
  p.poses.insert(p.poses.end(), poses.begin(), poses.end());
  const FeedFrame::Row& row = frame.rows[0];
  p.reward.push_back(row.reward);
  p.episode_return.push_back(row.episode_return);
  p.cost.insert(p.cost.end(), row.cost.begin(), row.cost.end());
  p.episode_cost.insert(p.episode_cost.end(), row.sum.begin(), row.sum.end());
  p.success.push_back(row.success);
  if (!p.shield.empty()) p.stepped_in.push_back(row.stepped_in);
  for (size_t i = 0; i < frame.contacts.size(); i += 6) {
    rdm_contact c = {};
    std::copy_n(&frame.contacts[i], 3, c.position);
    std::copy_n(&frame.contacts[i + 3], 3, c.force);
    p.contacts.push_back(c);
  }
  p.contacts_end.push_back(p.contacts.size());
  p.terminated = row.ended == 2;
  ++p.frames;
}

}  // namespace

Playback read_episode(const std::string& path) {
  constexpr size_t kMostFile = size_t{1} << 30;
  const std::string bytes = read_file(path, kMostFile);
  try {
    FeedReader reader;
    reader.add(bytes.data(), bytes.size());
    FeedMessage message;
    if (!reader.next(&message)) throw Failure("it has no scene");
    const FeedScene scene(message);
    if (scene.worlds != 1) throw Failure("worlds: a page shows one");
    Playback out = scene.looks;
    if (message.head.contains("shield")) out.shield = text_at(message.head, "shield");
    while (reader.next(&message)) add_frame(out, scene, FeedFrame(scene, message));
    if (!reader.empty()) throw Failure("its last frame is cut short");
    if (out.frames == 0) throw Failure("it has no frame");
    return out;
  } catch (const Failure& e) {
    throw Failure(path + ": " + e.what());
  }
}

}  // namespace tool
