// What a window does to worlds: nothing, where nobody touches them, and what it says where somebody does.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <redman/record.hpp>

#include "common/files.hpp"
#include "record/recorded_rollout.hpp"
#include "view/session.hpp"

namespace tool {
namespace {

ViewSettings settings_of(const std::string& task, int32_t envs = 1) {
  ViewSettings s;
  s.pool.task = task;
  s.pool.envs = envs;
  s.pool.seed = 5;
  s.policies = {"hold"};
  return s;
}

Json done(Session& session, Document asked) {
  return session.command(asked);
}
std::string hash_of(Session& session) {
  return done(session, {{"do", "hash"}})["hash"];
}
Document head_of(const std::string& frame) {
  uint32_t size = 0;
  std::memcpy(&size, frame.data(), sizeof size);
  return Document::parse(frame.substr(sizeof size, size));
}
int shape_named(const Session& session, const std::string& name) {
  const Json scene = session.scene();
  for (size_t i = 0; i < scene["shapes"].size(); ++i)
    if (scene["shapes"][i]["name"] == name) return static_cast<int>(i);
  ADD_FAILURE() << name;
  return 0;
}

// The hashes of the same pool after each step, without a session; ended worlds begin anew.
std::vector<std::string> hashes_without(const ViewSettings& s, int steps) {
  redman::Pool pool = make_pool(s.pool, RDM_AUTORESET_OFF);
  Actor actor(choose_actor(s.policies[0], s.pool.task), pool);
  pool.reset();
  actor.restart();
  std::vector<std::string> out;
  char text[17];
  const auto note = [&] {
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(pool.hash()));
    out.emplace_back(text);
  };
  note();
  for (int k = 0; k < steps; ++k) {
    std::vector<uint8_t> over(pool.num_envs());
    for (size_t i = 0; i < over.size(); ++i) over[i] = pool.terminated()[i] || pool.truncated()[i];
    if (std::count(over.begin(), over.end(), 1)) pool.reset(nullptr, over.data()), actor.restart(over.data());
    actor.act(pool);
    pool.step();
    note();
  }
  return out;
}

TEST(ViewSession, ChangesNoByteOfWorldsThatNobodyTouches) {
  for (const char* policy : {"hold", "random", "demo"}) {
    ViewSettings s = settings_of("hand_over_safe_finger", 3);
    s.policies = {policy};
    const auto without = hashes_without(s, 160);
    Session session(s);
    done(session, {{"do", "contacts"}, {"on", true}});
    for (size_t k = 0; k < without.size(); ++k) {
      if (k > 0) session.step();
      ASSERT_EQ(hash_of(session), without[k]) << policy << ", step " << k;
      session.frame(-1);
      if (k % 16 == 0) session.scene(), done(session, {{"do", "picture"}, {"camera", "front"}});
      if (k % 40 == 39) {  // back and here again
        done(session, {{"do", "seek"}, {"at", k - 20}});
        EXPECT_EQ(hash_of(session), without[k - 20]);
        done(session, {{"do", "seek"}, {"at", k}});
      }
    }
  }
}

TEST(ViewSession, GoesOnFromThePastAsItWentTheFirstTime) {
  ViewSettings s = settings_of("hand_over_safe_finger");
  const auto without = hashes_without(s, 60);
  Session session(s);
  for (int k = 0; k < 60; ++k) session.step();
  done(session, {{"do", "seek"}, {"at", 20}});
  EXPECT_EQ(head_of(session.frame(0))["last"], 60);
  for (int k = 21; k <= 40; ++k) {
    done(session, {{"do", "step"}});
    EXPECT_EQ(hash_of(session), without[static_cast<size_t>(k)]) << k;
  }
  EXPECT_EQ(head_of(session.frame(0))["last"], 40);
}

TEST(ViewSession, KeepsAsManyMomentsAsFit) {
  ViewSettings s = settings_of("hand_over_safe_finger", 2);
  s.history_bytes = 400000;
  Session session(s);
  for (int k = 0; k < 100; ++k) session.step();
  const Json told = session.summary();
  EXPECT_LE(told["history_bytes"], 400000);
  EXPECT_GT(told["moments"], 2);
  const Document head = head_of(session.frame(-1));
  EXPECT_EQ(head["last"], 100);
  EXPECT_EQ(head["rows"].size(), told["moments"]);
  done(session, {{"do", "seek"}, {"at", 0}});
  EXPECT_EQ(head_of(session.frame(-1))["at"], head["first"]);
  s.history_bytes = 0;
  Session none(s);
  none.step();
  EXPECT_EQ(none.summary()["moments"], 1);
}

TEST(ViewSession, PullsWhatIsDragged) {
  Session left(settings_of("hand_over_safe_finger")), pulled(settings_of("hand_over_safe_finger"));
  const int object = shape_named(pulled, "object");
  const auto height = [&](const Session& session) {
    return session.scene()["poses"][7 * object + 2].get<double>();
  };
  done(pulled, {{"do", "grab"},
                {"world", 0},
                {"shape", object},
                {"local", {0, 0, 0}},
                {"to", {0, 0, 5}},
                {"newton", 20},
                {"reach", 0.2}});
  for (int k = 0; k < 10; ++k) left.step(), pulled.step();
  EXPECT_GT(height(pulled), height(left) + 0.05);
  EXPECT_NEAR(head_of(pulled.frame(0))["force"], 20, 1e-6);
  done(pulled, {{"do", "release"}});
  pulled.step();
  EXPECT_FALSE(head_of(pulled.frame(0)).contains("force"));
}

TEST(ViewSession, LeadsAFingerByTheAction) {
  Session session(settings_of("hand_over_safe_finger"));
  const int tip = shape_named(session, "right_ff_distal");
  const auto place = [&](const Json& scene) {
    std::vector<double> out;
    for (int k = 0; k < 3; ++k) out.push_back(scene["poses"][7 * tip + k]);
    return out;
  };
  for (int k = 0; k < 5; ++k) session.step();
  const auto start = place(session.scene());
  const std::vector<double> to = {start[0], start[1], start[2] + 0.03};
  done(session, {{"do", "grab"},
                 {"world", 0},
                 {"shape", tip},
                 {"local", {0, 0, 0}},
                 {"to", to},
                 {"newton", 0},
                 {"reach", 1},
                 {"leads", true}});
  for (int k = 0; k < 40; ++k) session.step();
  EXPECT_TRUE(head_of(session.frame(0))["hand"]);
  const auto end = place(session.scene());
  EXPECT_LT(std::hypot(end[0] - to[0], end[1] - to[1], end[2] - to[2]), 0.01);
  const int object = shape_named(session, "object");
  done(session, {{"do", "grab"},
                 {"world", 0},
                 {"shape", object},
                 {"local", {0, 0, 0}},
                 {"to", {0, 0, 0}},
                 {"newton", 0},
                 {"reach", 1},
                 {"leads", true}});
  EXPECT_THROW(session.step(), Usage);
  session.step();  // it was let go
}

TEST(ViewSession, RecordsWhatAPersonDoes) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "redman_view_session";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  ViewSettings s = settings_of("hand_over_safe_finger");
  s.record = (folder / "by_hand.npz").string();
  Session session(s);
  session.step();
  done(session, {{"do", "record"}, {"on", true}});
  EXPECT_EQ(head_of(session.frame(0))["step"][0], 0);  // from the start of an episode
  const auto play = [&] {
    for (int k = 0; k < 400; ++k) {
      session.step();
      if (k % 10 == 3) done(session, {{"do", "action"}, {"entry", k % 40}, {"value", 0.01 * (k % 70) - 0.3}});
      if (head_of(session.frame(0))["ended"][0] != 0) return k + 1;
    }
    return -1;
  };
  const int first = play();
  for (int k = 0; k < 12; ++k) session.step();
  const int64_t before = head_of(session.frame(0))["at"];
  done(session, {{"do", "seek"}, {"at", before - 8}});  // these eight steps are not meant
  EXPECT_THROW(done(session, {{"do", "seek"}, {"at", before - 30}}), Usage);
  EXPECT_THROW(done(session, {{"do", "set"}, {"key", "object"}, {"value", "egg"}}), Usage);
  const int second = play();
  // one in which something is pulled is not kept
  session.step();
  done(session, {{"do", "grab"},
                 {"world", 0},
                 {"shape", shape_named(session, "object")},
                 {"local", {0, 0, 0}},
                 {"to", {0, 0, 1}},
                 {"newton", 1},
                 {"reach", 1}});
  session.step();
  done(session, {{"do", "release"}});
  play();
  session.step();  // and neither is one that has not ended
  const Json told = done(session, {{"do", "record"}, {"on", false}});
  EXPECT_EQ(told["episodes"], 2);
  EXPECT_EQ(told["dropped"], 1);
  ASSERT_EQ(told["file"], s.record);
  const Recording played = read_recording(s.record);
  ASSERT_EQ(played.episodes(), 2u);
  EXPECT_EQ(played.length(0), static_cast<size_t>(first));
  EXPECT_EQ(played.length(1), static_cast<size_t>(4 + second));
  EXPECT_EQ(played.policy, "by hand");
  const redman::Recording taught(s.record.c_str());  // as train --from reads it
  EXPECT_EQ(taught.info().rows, first + 4 + second);
  // it plays again to its end
  ActorChoice choice = choose_actor(s.record);
  PoolSettings again = s.pool;
  again.seed = played.pool.seed;
  redman::Pool pool = make_pool(again, RDM_AUTORESET_OFF);
  Actor actor(choice, pool);
  pool.reset();
  actor.restart();
  for (int k = 0; k < first; ++k) actor.act(pool), pool.step();
  EXPECT_TRUE(pool.terminated()[0] || pool.truncated()[0]);
  EXPECT_NO_THROW(actor.check_ends());
  // with the end of the command too
  done(session, {{"do", "record"}, {"on", true}});
  EXPECT_THROW(done(session, {{"do", "act"}, {"who", "zero"}}), Usage);
  play();
  session.finish();
  EXPECT_EQ(session.summary()["files"].size(), 2u);
  EXPECT_EQ(read_recording((folder / "by_hand-2.npz").string()).episodes(), 1u);
  // nothing to keep, nothing written; the next file has another name
  done(session, {{"do", "record"}, {"on", true}});
  session.step();
  EXPECT_FALSE(done(session, {{"do", "record"}, {"on", false}}).contains("file"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 2);
  std::filesystem::remove_all(folder);
}

TEST(ViewSession, ChangesActorsAndOptionsOrNothing) {
  Session session(settings_of("hand_over_safe_finger", 2));
  session.step();
  const int64_t scene = session.scene_number();
  const std::string before = hash_of(session);
  EXPECT_THROW(done(session, {{"do", "act"}, {"who", "/etc/passwd"}}), Usage);
  EXPECT_THROW(done(session, {{"do", "set"}, {"key", "object"}, {"value", "elephant"}}), Usage);
  EXPECT_THROW(done(session, {{"do", "set"}, {"key", "nonsense"}, {"value", "1"}}), Usage);
  EXPECT_THROW(done(session, {{"do", "watch"}, {"world", 2}}), Failure);
  EXPECT_EQ(hash_of(session), before);
  EXPECT_EQ(session.scene_number(), scene);
  done(session, {{"do", "act"}, {"who", "demo"}});
  session.step();
  EXPECT_EQ(head_of(session.frame(0))["who"], "demo");
  done(session, {{"do", "set"}, {"key", "object"}, {"value", "tennis_ball"}});
  EXPECT_EQ(session.scene_number(), scene + 1);
  EXPECT_EQ(head_of(session.frame(0))["step"][1], 0);
  done(session, {{"do", "watch"}, {"world", 1}});
  done(session, {{"do", "action"}, {"entry", 3}, {"value", 0.5}});
  session.step();
  EXPECT_EQ(head_of(session.frame(0))["action"][3], 0.5);
  done(session, {{"do", "shield"}, {"on", true}});
  session.step();
  EXPECT_TRUE(head_of(session.frame(0))["shield"]);
}

TEST(ViewSession, SetsTheLimitOfThisEpisodeAndTheNext) {
  ViewSettings s = settings_of("ball_run", 2);
  s.pool.options.emplace_back("limit_range", "5..40");
  s.pool.options.emplace_back("max_steps", "3");
  Session session(s);
  EXPECT_EQ(session.scene()["limit_range"], (Json{5.0, 40.0}));
  session.step();
  done(session, {{"do", "limit"}, {"value", 10}});
  EXPECT_EQ(head_of(session.frame(0))["limit"], 10);
  EXPECT_THROW(done(session, {{"do", "limit"}, {"value", 41}}), Failure);
  for (int k = 0; k < 2; ++k) session.step();
  EXPECT_THROW(done(session, {{"do", "limit"}, {"value", 20}}), Usage);  // it is over
  session.step();
  EXPECT_EQ(head_of(session.frame(0))["limit"], 10);
  Session plain(settings_of("ball_run", 1));
  EXPECT_TRUE(plain.scene()["limit_range"].is_null());
  EXPECT_FALSE(head_of(plain.frame(0)).contains("limit"));
  EXPECT_THROW(done(plain, {{"do", "limit"}, {"value", 10}}), Usage);
}

TEST(ViewSession, LivesOnWhateverIsAskedFor) {
  Session session(settings_of("ball_run", 2));
  const std::vector<Document> values = {
      nullptr,     true, -1, 0, 1, 2, 1e300, "", "x", "front", {1, 2, 3}, {1, "2", 3}, Document::object(),
      {1e30, 0, 0}};
  const std::vector<std::string> keys = {"on",    "at",    "seed",  "times", "who", "entry",
                                         "value", "world", "shape", "local", "to",  "newton",
                                         "reach", "leads", "key",   "camera"};
  uint64_t x = 1;
  const auto below = [&](size_t n) {
    x = x * 6364136223846793005u + 1442695040888963407u;
    return static_cast<size_t>((x >> 33) % n);
  };
  for (const char* what :
       {"play", "step", "seek", "reset", "speed", "stops", "act", "shield", "hand", "action", "watch",
        "contacts", "grab", "release", "set", "limit", "picture", "hash", "nonsense"})
    for (int n = 0; n < 60; ++n) {
      Document asked = {{"do", what}};
      for (size_t k = below(6); k > 0; --k) asked[keys[below(keys.size())]] = values[below(values.size())];
      try {
        session.command(asked);
        session.frame(-1);
        if (n % 8 == 0) session.step();
      } catch (const std::runtime_error&) {  // said, and nothing else
      }
    }
  session.frame(-1);
}

}  // namespace
}  // namespace tool
