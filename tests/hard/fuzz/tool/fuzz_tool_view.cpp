// What comes to the server of `redman view`: a request, messages in any portions, and what they ask of worlds.
#include "../fuzz.hpp"
#include "view/http.hpp"
#include "view/session.hpp"
#include "view/websocket.hpp"

namespace hard {
namespace {

std::string message(const std::string& text) {
  return std::string("\x81") + static_cast<char>(0x80 | text.size()) + std::string(4, '\0') + text;
}

std::vector<std::string> heard(const std::string& bytes, size_t portion, bool* broken) {
  tool::WebsocketReader reader;
  std::vector<std::string> out;
  for (size_t at = 0; at < bytes.size(); at += portion) {
    reader.add(bytes.data() + at, std::min(portion, bytes.size() - at));
    for (tool::WebsocketReader::Message m; reader.next(&m);)
      out.push_back(std::to_string(m.kind) + m.payload);
  }
  *broken = reader.broken();
  return out;
}

}  // namespace

std::vector<Bytes> seeds() {
  return {bytes_of("GET /0123/ HTTP/1.1\r\nHost: 127.0.0.1:80\r\nOrigin: http://127.0.0.1:80\r\n\r\n"),
          bytes_of(message("{\"do\":\"step\"}") + message("{\"do\":\"seek\",\"at\":0,\"id\":1}")),
          bytes_of(message("{\"do\":\"grab\",\"world\":0,\"shape\":1,\"local\":[0,0,0],\"to\":[0,0,1],"
                           "\"newton\":1,\"reach\":1}") +
                   message("{\"do\":\"action\",\"entry\":0,\"value\":0.5}")),
          bytes_of(message("{\"do\":\"set\",\"key\":\"max_steps\",\"value\":\"9\"}") +
                   message("{\"do\":\"reset\",\"seed\":4}"))};
}
void whole(unsigned char*, size_t) {}
size_t fixed_bytes() {
  return 0;
}

void one(const unsigned char* data, size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  tool::Request request;
  size_t used = 0;
  if (tool::read_request(bytes, &request, &used) == tool::Reading::kWhole)
    HARD_REQUIRE(used <= size && used <= tool::kMostHead + 4, "more was read than there is");
  bool broken = false, again = false;
  const std::vector<std::string> messages = heard(bytes, 1, &broken);
  HARD_REQUIRE(messages == heard(bytes, 1 + size, &again) && broken == again, "portions make a difference");

  static tool::Session* session = [] {
    tool::ViewSettings s;
    s.pool.task = "ball_run";
    s.pool.envs = 2;
    s.policies = {"hold"};
    s.record = "/nowhere/to/write.npz";
    s.history_bytes = 100000;
    return new tool::Session(s);
  }();
  for (const std::string& m : messages) {
    try {
      const tool::Document asked = tool::parse_json(m.data() + 1, m.size() - 1);
      session->command(asked);
      HARD_REQUIRE(!session->frame(-1).empty(), "no frame");
    } catch (const std::runtime_error& e) {
      HARD_REQUIRE(*e.what(), "no text");
    }
  }
}

}  // namespace hard
