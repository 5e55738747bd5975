// What another program sends to `redman render --feed` and `view --feed`: messages in any portions, a scene, and its frames.
#include "../fuzz.hpp"
#include "common/report.hpp"
#include "play/feed.hpp"

namespace hard {
namespace {

std::string message(const std::string& text, const std::vector<float>& numbers) {
  const auto number = [](size_t n) {
    const auto size = static_cast<uint32_t>(n);
    return std::string(reinterpret_cast<const char*>(&size), sizeof size);
  };
  const size_t bytes = numbers.size() * sizeof(float);
  return number(4 + text.size() + bytes) + number(text.size()) + text +
         std::string(reinterpret_cast<const char*>(numbers.data()), bytes);
}

const char* const kScene =
    "{\"say\":\"scene\",\"task\":\"t\",\"summary\":\"\",\"actor\":\"a\",\"seed\":0,\"dt\":0.1,\"first\":0,"
    "\"steps\":9,"
    "\"obs\":1,\"worlds\":1,\"shapes\":[{\"name\":\"s\",\"kind\":0,\"fixed\":false,\"size\":[1,0,0],"
    "\"color\":[1,2,3]}],"
    "\"cameras\":[{\"name\":\"c\",\"eye\":[1,0,0],\"target\":[0,0,0],\"up\":[0,0,1],\"fov_y\":1,\"mounted\":"
    "false}],"
    "\"costs\":[{\"name\":\"k\",\"help\":\"\",\"limit\":-1}],\"actions\":[\"x\"],\"record\":\"\"}";

std::string read(const std::string& bytes, size_t portion) {
  std::string seen;
  try {
    tool::FeedReader reader;
    std::optional<tool::FeedScene> scene;
    for (size_t at = 0; at < bytes.size(); at += portion) {
      reader.add(bytes.data() + at, std::min(portion, bytes.size() - at));
      for (tool::FeedMessage m; reader.next(&m);) {
        seen += 'm';
        if (!scene) {
          scene.emplace(m);
          HARD_REQUIRE(scene->poses.size() == scene->worlds * scene->looks.bodies.size() * 7,
                       "poses of shapes");
        } else {
          const tool::FeedFrame frame(*scene, m);
          HARD_REQUIRE(frame.rows.size() == scene->worlds, "a row for each world");
          seen += 'f';
        }
      }
    }
  } catch (const tool::Failure& e) {
    seen += e.what();
  }
  return seen;
}

}  // namespace

std::vector<Bytes> seeds() {
  const std::vector<float> pose = {0, 0, 0, 0, 0, 0, 1};
  std::vector<float> frame = pose;
  frame.insert(frame.end(), {1, 1, 1, 0, 0, 0, 0, 0, 0.5f});
  const std::string scene = message(kScene, pose),
                    next = message("{\"say\":\"frame\",\"world\":0,\"points\":0,\"contacts\":0}", frame);
  frame.insert(frame.end(), 6, 1.0f);
  return {bytes_of(scene), bytes_of(scene + next + next),
          bytes_of(scene + message("{\"say\":\"frame\",\"world\":0,\"points\":0,\"contacts\":1}", frame))};
}
void whole(unsigned char*, size_t) {}
size_t fixed_bytes() {
  return 0;
}

void one(const unsigned char* data, size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  HARD_REQUIRE(read(bytes, 1 + size) == read(bytes, 7), "portions make a difference");
}

}  // namespace hard
