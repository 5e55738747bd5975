// The server of `redman view`: requests and messages of somebody who may mean harm, and whom it answers.
#if !defined(_WIN32)
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "view/http.hpp"
#include "view/server.hpp"

namespace tool {
namespace {

// Numbers that are the same everywhere.
class Chance {
 public:
  explicit Chance(uint64_t seed) : x_(seed * 2654435761u + 1) {}
  uint64_t below(uint64_t n) {
    x_ = x_ * 6364136223846793005u + 1442695040888963407u;
    return (x_ >> 33) % n;
  }

 private:
  uint64_t x_;
};

std::string changed(std::string text, Chance& chance) {
  for (uint64_t k = chance.below(4); k > 0 && !text.empty(); --k) {
    const size_t at = chance.below(text.size());
    switch (chance.below(3)) {
      case 0:
        text[at] = static_cast<char>(chance.below(256));
        break;
      case 1:
        text.erase(at, chance.below(9));
        break;
      default:
        text.insert(at, text.substr(chance.below(text.size()), chance.below(20)));
    }
  }
  return text;
}

const std::string kGood = "GET /a/ HTTP/1.1\r\nHost: 127.0.0.1:80\r\nOrigin:  http://127.0.0.1:80 \r\n\r\n";

Reading read(const std::string& bytes, Request* out = nullptr) {
  Request request;
  size_t used = 0;
  return read_request(bytes, out ? out : &request, &used);
}

TEST(ViewHttp, ReadsARequest) {
  Request request;
  size_t used = 0;
  ASSERT_EQ(read_request(kGood + "rest", &request, &used), Reading::kWhole);
  EXPECT_EQ(used, kGood.size());
  EXPECT_EQ(request.method, "GET");
  EXPECT_EQ(request.target, "/a/");
  EXPECT_EQ(request.field("host"), "127.0.0.1:80");
  EXPECT_EQ(request.field("origin"), "http://127.0.0.1:80");
  EXPECT_EQ(request.field("cookie"), "");
  for (size_t k = 0; k < kGood.size(); ++k) EXPECT_EQ(read(kGood.substr(0, k)), Reading::kMore) << k;
}

TEST(ViewHttp, RefusesWhatIsNone) {
  for (const char* bad :
       {"GET / HTTP/1.0\r\n\r\n", "GET /\r\n\r\n", "GET  / HTTP/1.1\r\n\r\n", "GET a HTTP/1.1\r\n\r\n",
        "\r\n\r\n", "G\x01T / HTTP/1.1\r\n\r\n", "GET / HTTP/1.1 \r\n\r\n", "GET / HTTP/1.1\r\nHost\r\n\r\n",
        "GET / HTTP/1.1\r\nHost : a\r\n\r\n", "GET / HTTP/1.1\r\n a: b\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: a\r\nhost: b\r\n\r\n", "GET / HTTP/1.1\r\na: b\x01\r\n\r\n",
        "GET / HTTP/1.1\r\na: b\nc: d\r\n\r\n", "POST / HTTP/1.1\r\nContent-Length: 5\r\n\r\n",
        "POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n"})
    EXPECT_EQ(read(bad), Reading::kBad) << bad;
  std::string many = "GET / HTTP/1.1\r\n";
  for (int k = 0; k < 65; ++k) many += 'a' + std::to_string(k) + ": b\r\n";
  EXPECT_EQ(read(many + "\r\n"), Reading::kBad);
  EXPECT_EQ(read("GET / HTTP/1.1\r\na: " + std::string(kMostHead, 'x')), Reading::kBad);
  EXPECT_EQ(read(std::string(kMostHead - 1, 'x')), Reading::kMore);
}

TEST(ViewHttp, DecidesBySizeAloneWhatChanceSends) {
  for (uint64_t seed = 0; seed < 20000; ++seed) {
    Chance chance(seed);
    const std::string text = changed(kGood, chance);
    const size_t end = text.find("\r\n\r\n");
    const Reading whole = read(text);
    EXPECT_EQ(whole == Reading::kMore, end == std::string::npos) << text;
    if (whole != Reading::kWhole) continue;
    Request request;
    read(text, &request);
    for (const auto& [name, value] : request.fields)
      EXPECT_EQ((name + value).find_first_of("\r\n"), std::string::npos) << text;
  }
}

std::string masked(int first, const std::string& payload, uint64_t said, uint32_t key = 0x01020304) {
  std::string out(1, static_cast<char>(first));
  const int wide = said < 126 ? 0 : said < 65536 ? 2 : 8;
  out += static_cast<char>(0x80 | (wide == 0 ? said : wide == 2 ? 126 : 127));
  for (int k = wide - 1; k >= 0; --k) out += static_cast<char>(said >> (8 * k) & 255);
  for (int k = 3; k >= 0; --k) out += static_cast<char>(key >> (8 * k) & 255);
  for (size_t i = 0; i < payload.size(); ++i)
    out += static_cast<char>(payload[i] ^ out[out.size() - i - 4 + i % 4]);
  return out;
}
std::string masked(int first, const std::string& payload) {
  return masked(first, payload, payload.size());
}

// What came, and whether it ended badly, by portions of so many bytes.
std::string heard(const std::string& bytes, size_t portion) {
  WebsocketReader reader;
  std::string out;
  for (size_t at = 0; at < bytes.size(); at += portion) {
    reader.add(bytes.data() + at, std::min(portion, bytes.size() - at));
    for (WebsocketReader::Message m; reader.next(&m);) out += std::to_string(m.kind) + '<' + m.payload + '>';
  }
  return out + (reader.broken() ? "broken" : "");
}

TEST(ViewWebsocket, AnswersTheKeyOfTheStandard) {
  EXPECT_EQ(websocket_accept("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");  // RFC 6455, 1.3
  EXPECT_TRUE(is_websocket_key("dGhlIHNhbXBsZSBub25jZQ=="));
  for (const char* bad :
       {"", "dGhlIHNhbXBsZSBub25jZQ", "dGhlIHNhbXBsZSBub25jZQ===", "dGhlIHNhbXBsZ\n5ub25jZQ=="})
    EXPECT_FALSE(is_websocket_key(bad)) << bad;
}

TEST(ViewWebsocket, ReadsMessagesInAnyPortions) {
  const std::string large(70000, 'x'), text(kMostMessage, 'y');
  const std::string bytes = masked(0x81, "{}") + masked(0x01, "a") + masked(0x89, "p") + masked(0x80, "b") +
                            masked(0x81, text) + masked(0x88, "");
  const std::string all = "1<{}>9<p>1<ab>1<" + text + ">8<>";
  for (const size_t portion : {size_t{1}, size_t{3}, size_t{1000}, bytes.size()})
    EXPECT_EQ(heard(bytes, portion), all) << portion;
  EXPECT_EQ(websocket_frame(kFrameText, "ab"), std::string("\x81\x02"
                                                           "ab"));
  EXPECT_EQ(websocket_frame(kFrameBytes, large).substr(0, 10),
            std::string("\x82\x7f\0\0\0\0\0\x01\x11\x70", 10));
}

TEST(ViewWebsocket, EndsWithWhatKeepsNoRule) {
  std::string bare = "\x81\x01";
  bare += 'a';
  for (const std::string& bad :
       {bare, masked(0xc1, "a"), masked(0x83, "a"), masked(0x80, "a"), masked(0x01, "a") + masked(0x81, "b"),
        masked(0x09, "a"), masked(0x89, std::string(126, 'a')), masked(0x81, "\xff"),
        masked(0x81, "", kMostMessage + 1), masked(0x81, "", UINT64_MAX),
        masked(0x01, std::string(kMostMessage, 'a')) + masked(0x80, "b")})
    EXPECT_EQ(heard(bad + masked(0x81, "c"), 7), "broken");
}

TEST(ViewWebsocket, HearsTheSameOfWhatChanceSends) {
  const std::string good = masked(0x81, "{\"do\":\"step\"}") + masked(0x01, "abc") +
                           masked(0x80, std::string(200, 'd')) + masked(0x89, "e");
  for (uint64_t seed = 0; seed < 20000; ++seed) {
    Chance chance(seed);
    const std::string bytes = changed(good, chance);
    EXPECT_EQ(heard(bytes, 1 + chance.below(9)), heard(bytes, bytes.size())) << seed;
  }
}

// A client that is asked for nothing but bytes.
class Client {
 public:
  explicit Client(const ViewServer& server) {
    const std::string address = server.address();
    port_ = static_cast<uint16_t>(std::stoi(address.substr(17)));
    token_ = address.substr(address.find('/', 17));
    socket_ = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(port_);
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<sockaddr*>(&at), sizeof at), 0);
    const timeval wait{0, 20000};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait);
  }
  ~Client() { close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  std::string host() const { return "127.0.0.1:" + std::to_string(port_); }
  const std::string& token() const { return token_; }  // "/TOKEN/"
  void say(const std::string& bytes) {
    EXPECT_EQ(send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  // What comes while the server works for a while, to the end of the connection.
  std::string hear(ViewServer& server, std::vector<ViewServer::Event>* events = nullptr, int rounds = 12) {
    std::string out;
    char part[65536];
    for (int k = 0; k < rounds; ++k) {
      for (auto& e : server.wait(0.005))
        if (events) events->push_back(e);
      const ssize_t n = recv(socket_, part, sizeof part, 0);
      if (n == 0) return out + "<end>";
      if (n > 0) out.append(part, static_cast<size_t>(n)), k = 0;
    }
    return out;
  }

 private:
  int socket_ = -1;
  uint16_t port_ = 0;
  std::string token_;
};

constexpr char kPage[] = "the page that nobody else sees";
std::string lines(std::initializer_list<std::string> all) {
  std::string out;
  for (const std::string& line : all) out += line + "\r\n";
  return out + "\r\n";
}

TEST(ViewServer, GivesThePageToItsAddressAlone) {
  ViewServer server(0, kPage);
  EXPECT_EQ(server.address().size(), std::string("http://127.0.0.1:12345/").size() + 33) << server.address();
  const auto asked = [&](const std::function<std::string(const Client&)>& request) {
    Client client(server);
    client.say(request(client));
    return client.hear(server);
  };
  const std::string good = asked([](const Client& c) {
    return lines({"GET " + c.token() + " HTTP/1.1", "Host: " + c.host()});
  });
  EXPECT_NE(good.find("HTTP/1.1 200 OK\r\n"), std::string::npos);
  EXPECT_NE(good.find("Content-Security-Policy: default-src 'none'"), std::string::npos);
  EXPECT_NE(good.find(std::string("\r\n\r\n") + kPage + "<end>"), std::string::npos);
  const auto refused = [&](const char* what, const std::function<std::string(const Client&)>& request) {
    const std::string answer = asked(request);
    EXPECT_EQ(answer.find("HTTP/1.1 403 Forbidden\r\n"), 0u) << what << ": " << answer;
    EXPECT_NE(answer.find("\r\nContent-Length: 0\r\n"), std::string::npos) << what;
    EXPECT_NE(answer.find("\r\n\r\n<end>"), std::string::npos) << what;
  };
  refused("no token", [](const Client& c) { return lines({"GET / HTTP/1.1", "Host: " + c.host()}); });
  refused("another token", [](const Client& c) {
    std::string token = c.token();
    token[5] = token[5] == 'a' ? 'b' : 'a';
    return lines({"GET " + token + " HTTP/1.1", "Host: " + c.host()});
  });
  refused("a part of it", [](const Client& c) {
    return lines({"GET " + c.token().substr(0, 20) + "/ HTTP/1.1", "Host: " + c.host()});
  });
  refused("no host", [](const Client& c) { return lines({"GET " + c.token() + " HTTP/1.1"}); });
  refused("another host", [](const Client& c) {
    return lines({"GET " + c.token() + " HTTP/1.1", "Host: evil.example:" + c.host().substr(10)});
  });
  refused("another port", [](const Client& c) {
    return lines({"GET " + c.token() + " HTTP/1.1", "Host: 127.0.0.1:1"});
  });
  for (const std::string origin : {"http://evil.example", "null", "http://127.0.0.1:1", "https://127.0.0.1"})
    refused("another origin", [&](const Client& c) {
      return lines({"GET " + c.token() + " HTTP/1.1", "Host: " + c.host(), "Origin: " + origin});
    });
}

std::string upgrade(const Client& c, const std::string& origin,
                    const std::string& key = "dGhlIHNhbXBsZSBub25jZQ==") {
  std::string fields = "GET " + c.token() + "live HTTP/1.1\r\nHost: " + c.host() +
                       "\r\nUpgrade: websocket\r\nConnection: keep-alive, Upgrade\r\n";
  fields += "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: " + key + "\r\n";
  return fields + (origin.empty() ? "" : "Origin: " + origin + "\r\n") + "\r\n";
}

TEST(ViewServer, OpensAWindowForItsOwnPageAlone) {
  ViewServer server(0, kPage);
  {
    Client client(server);
    std::vector<ViewServer::Event> events;
    client.say(upgrade(client, "http://" + client.host()) + masked(0x81, "at once"));
    const std::string answer = client.hear(server, &events);
    EXPECT_EQ(answer.find("HTTP/1.1 101 Switching Protocols\r\n"), 0u) << answer;
    EXPECT_NE(answer.find("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n"), std::string::npos);
    ASSERT_EQ(events.size(), 2u);
    EXPECT_EQ(events[0].kind, ViewServer::Event::kOpened);
    EXPECT_EQ(events[1].text, "at once");
    EXPECT_EQ(server.windows(), 1u);
    server.send_text(events[0].window, "hello");
    EXPECT_EQ(client.hear(server), "\x81\x05hello");
    client.say(masked(0x89, "p"));
    EXPECT_EQ(client.hear(server), "\x8a\x01p");
    client.say(
        "\x81\x01"
        "a");  // not masked
    events.clear();
    EXPECT_EQ(client.hear(server, &events), "<end>");
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0].kind, ViewServer::Event::kClosed);
  }
  for (const std::string origin : {"", "http://evil.example", "null", "file://"}) {
    Client client(server);
    client.say(upgrade(client, origin));
    EXPECT_EQ(client.hear(server).find("HTTP/1.1 403 Forbidden\r\n"), 0u) << origin;
  }
  Client client(server);
  client.say(upgrade(client, "http://" + client.host(), "short"));
  EXPECT_EQ(client.hear(server).find("HTTP/1.1 400 Bad Request\r\n"), 0u);
  EXPECT_EQ(server.windows(), 0u);
}

TEST(ViewServer, HoldsNoMoreThanItsBounds) {
  ViewServer server(0, kPage);
  Client large(server);
  large.say("GET / HTTP/1.1\r\na: " + std::string(kMostHead + 100, 'x'));
  EXPECT_EQ(large.hear(server).find("HTTP/1.1 400"), 0u);
  std::vector<std::unique_ptr<Client>> idle;
  for (size_t k = 0; k < ViewServer::kMostConnections; ++k) {
    idle.push_back(std::make_unique<Client>(server));
    server.wait(0.01);
  }
  Client late(server);
  EXPECT_EQ(late.hear(server), "<end>");
  idle.clear();
  server.wait(0.01);
  server.wait(0.01);
  Client next(server);
  next.say(lines({"GET " + next.token() + " HTTP/1.1", "Host: " + next.host()}));
  EXPECT_EQ(next.hear(server).find("HTTP/1.1 200 OK"), 0u);
}

TEST(ViewServer, LivesOnWhateverChanceSends) {
  ViewServer server(0, kPage);
  for (uint64_t seed = 0; seed < 150; ++seed) {
    Chance chance(seed);
    Client client(server);
    client.say(changed(upgrade(client, "http://" + client.host()), chance) +
               changed(masked(0x81, "{\"do\":\"step\"}"), chance));
    client.hear(server, nullptr, 1);
  }
  Client client(server);
  client.say(lines({"GET " + client.token() + " HTTP/1.1", "Host: " + client.host()}));
  EXPECT_EQ(client.hear(server).find("HTTP/1.1 200 OK"), 0u);
}

}  // namespace
}  // namespace tool
#endif
