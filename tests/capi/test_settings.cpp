// Options as one text, in and out; the text of a failure in the config itself.
#include <sstream>

#include "contract.hpp"
#include "written.hpp"

namespace {

std::string settings_of(const rdm_pool* p) {
  size_t size = 0;
  EXPECT_EQ(rdm_pool_get_settings(p, nullptr, 0, &size), RDM_OK);
  std::string text(size + 1, '#');
  EXPECT_EQ(rdm_pool_get_settings(p, text.data(), size, &size),
            RDM_ERROR_RANGE);  // no room for the terminator
  EXPECT_EQ(text[0], '#');
  EXPECT_EQ(rdm_pool_get_settings(p, text.data(), text.size(), &size), RDM_OK);
  EXPECT_EQ(text[size], '\0');
  text.resize(size);
  return text;
}

std::string settings_of(const rdm_agent* a) {
  return written_text(
      [&](char* out, size_t n, size_t* size) { return rdm_agent_get_settings(a, out, n, size); });
}

std::string value_of(const std::string& settings, const std::string& key) {
  std::istringstream lines(settings);
  for (std::string line; std::getline(lines, line);)
    if (line.rfind(key + "=", 0) == 0) return line.substr(key.size() + 1);
  return "no such key";
}

uint64_t hash_after_steps(rdm_pool* p, int steps = 10) {
  EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  for (int i = 0; i < steps; ++i) {
    EXPECT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
    EXPECT_EQ(rdm_pool_step(p), RDM_OK) << rdm_last_error();
  }
  return hash_of(p);
}

// The pool of `settings` and the one of what it answers for its settings have the same course.
void expect_same_again(const char* task, const char* settings) {
  SCOPED_TRACE(task);
  rdm_pool_config c = pool_config(2);
  c.task = task;
  c.settings = settings;
  rdm_pool* p = make_pool(c);
  ASSERT_NE(p, nullptr);
  const std::string whole = settings_of(p);
  c.settings = whole.c_str();
  rdm_pool* again = make_pool(c);
  ASSERT_NE(again, nullptr);
  EXPECT_EQ(settings_of(again), whole);
  EXPECT_EQ(hash_after_steps(again), hash_after_steps(p));
  const auto state = written_bytes(
      [&](void* out, size_t n, size_t* size) { return rdm_pool_write_state(p, -1, out, n, size); });
  EXPECT_EQ(rdm_pool_read_state(again, -1, state.data(), state.size()), RDM_OK) << rdm_last_error();
  rdm_pool_destroy(again);
  rdm_pool_destroy(p);
}

TEST(Settings, OfEveryTaskReadBack) {
  for (const std::string& task : task_names()) expect_same_again(task.c_str(), nullptr);
}

// One key stands for links of two robots there, and the link that carries a hand weighs more than its own row says.
constexpr const char* kRobots[][2] = {{"grasp", "arm=ur5e"},
                                      {"grasp", "arm=iiwa"},
                                      {"hand_over_wall", "arm=ur5e"},
                                      {"hand_over_wall", "left.hand=allegro"},
                                      {"hand_over_safe_finger", "right.hand=allegro"},
                                      {"jenga", "pair=paper"},
                                      {"jenga", "pair=paper\njoint.FFJ3.kp=1.5\nlink.ff_proximal.mass=0.03"}};

TEST(Settings, OfOtherRobotsReadBack) {
  for (const auto& [task, settings] : kRobots) expect_same_again(task, settings);
}

// A value that happens to be the default moves other links too when it is given, so it is another pool.
TEST(Settings, TellWhetherALinkWasGiven) {
  rdm_pool_config c = pool_config(1);
  c.task = "grasp", c.settings = "arm=ur5e";
  rdm_pool* p = make_pool(c);
  ASSERT_NE(p, nullptr);
  EXPECT_EQ(value_of(settings_of(p), "link.wrist_3_link.mass"), "no such key");
  c.settings = "arm=ur5e\nlink.wrist_3_link.mass=0.365";
  rdm_pool* lighter = make_pool(c);
  ASSERT_NE(lighter, nullptr);
  EXPECT_EQ(value_of(settings_of(lighter), "link.wrist_3_link.mass"), "0.365");
  EXPECT_NE(hash_after_steps(lighter), hash_after_steps(p));
  EXPECT_EQ(rdm_pool_copy(lighter, 0, p, 0), RDM_ERROR_ARGUMENT);
  rdm_pool_destroy(lighter);
  rdm_pool_destroy(p);
}

// What a level draws it draws again.
TEST(Settings, OfALevelReadBack) {
  for (const char* task : {"hand_over_wall", "grasp", "jenga", "reorient"})
    for (const char* settings : {"level=2", "level=3\nscale.kp=1.1\nscale.mass=0.5..1.5"})
      expect_same_again(task, settings);
}

constexpr const char* kHull =
    "object=hull\n"
    "hull=0.0312345678,0,0;-0.0312345678,0,0;0,0.0287654321,0;0,-0.0287654321,0;0,0,0.0423456789;"
    "0,0,-0.0423456789\n"
    "object_mass = 0.0512345678901234\r\n";

TEST(Settings, LongTextsAndExactNumbersReadBack) {
  expect_same_again("hand_over_safe_finger", kHull);
  expect_same_again("hand_over_safe_finger",
                    "joint.FFJ2.kp=1.2345678901234\nscale.mass=1.1\ngravity=9.8066500000001");
  rdm_pool_config c = pool_config(1);
  c.settings = kHull;
  rdm_pool* p = make_pool(c);
  ASSERT_NE(p, nullptr);
  const std::string whole = settings_of(p);
  EXPECT_EQ(value_of(whole, "object_mass"), "0.0512345678901234");
  EXPECT_EQ(value_of(whole, "hull").size(), std::strlen(std::strstr(kHull, "hull=0")) - 5 - 1 -
                                                std::strlen("object_mass = 0.0512345678901234\r\n"));
  // one by one: exact too, and a text that is longer is refused, not cut
  rdm_task task{};
  task.struct_size = sizeof task;
  int32_t index = 0;
  ASSERT_EQ(rdm_task_find("hand_over_safe_finger", &index), RDM_OK);
  ASSERT_EQ(rdm_task_at(index, &task), RDM_OK);
  int long_ones = 0;
  for (int32_t i = 0; i < task.num_options; ++i) {
    const char* key = nullptr;
    char text[RDM_TEXT_SIZE] = "untouched";
    const rdm_result r = rdm_pool_setting_at(p, i, &key, text);
    if (r == RDM_OK && std::strstr(key, ".FIELD")) continue;  // no key, but the pattern of some
    if (r == RDM_OK) {
      const bool of_robot = std::strncmp(key, "joint.", 6) == 0 || std::strncmp(key, "link.", 5) == 0;
      EXPECT_EQ(value_of(whole, key), of_robot ? "no such key" : text) << key;  // none was given
      continue;
    }
    ++long_ones;
    EXPECT_EQ(r, RDM_ERROR_RANGE);
    EXPECT_STREQ(text, "untouched");
    EXPECT_NE(std::strstr(rdm_pool_error(p), "rdm_pool_get_settings"), nullptr) << rdm_pool_error(p);
  }
  EXPECT_EQ(long_ones, 1);
  rdm_pool_destroy(p);
}

TEST(Settings, AreLaidOverOptions) {
  rdm_pool_config c = pool_config(1);
  const rdm_option options[] = {{"gravity", nullptr, 5}, {"substeps", "3", 0}};
  c.options = options;
  c.num_options = 2;
  c.settings = "\n gravity = 2.5 \n";
  rdm_pool* p = make_pool(c);
  ASSERT_NE(p, nullptr);
  EXPECT_EQ(value_of(settings_of(p), "gravity"), "2.5");
  EXPECT_EQ(value_of(settings_of(p), "substeps"), "3");
  rdm_pool_destroy(p);
}

TEST(Settings, OfEveryAlgorithmReadBack) {
  for (int32_t i = 0; i < rdm_algo_count(); ++i) {
    rdm_agent_config c = agent_config(i);
    SCOPED_TRACE(c.algo);
    c.settings = "discount=0.9712345678901234\nlearning_rate=1.5e-3";
    rdm_agent* a = make_agent(c);
    ASSERT_NE(a, nullptr);
    const std::string whole = settings_of(a);
    EXPECT_EQ(value_of(whole, "discount"), "0.9712345678901234");
    c.options = nullptr;
    c.num_options = 0;
    c.settings = whole.c_str();
    rdm_agent* again = make_agent(c);
    ASSERT_NE(again, nullptr);
    EXPECT_EQ(settings_of(again), whole);
    EXPECT_EQ(feed_epoch(a), RDM_OK);
    EXPECT_EQ(feed_epoch(again), RDM_OK);
    EXPECT_EQ(saved(again), saved(a));
    rdm_agent_destroy(again);
    rdm_agent_destroy(a);
  }
}

// ---- config.error

TEST(ConfigError, GetsTheTextOfEveryFailingCallThatTakesThePoolConfig) {
  char text[128] = "";
  rdm_pool_config c = pool_config(1);
  c.error = text;
  c.error_size = sizeof text;
  c.settings = "gravity=9\nfriction_of_all=1";
  const auto failed = [&](rdm_result r) {
    EXPECT_EQ(r, RDM_ERROR_NOT_FOUND);
    EXPECT_STREQ(text, rdm_last_error());
    EXPECT_NE(std::strstr(text, "option friction_of_all: unknown"), nullptr) << text;
    std::strcpy(text, "untouched");
  };
  rdm_pool* p = nullptr;
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  failed(rdm_pool_create(&p, &c));
  failed(rdm_pool_config_spec(&c, &spec));
  failed(rdm_pool_config_memory(&c, nullptr, nullptr));
  c.settings = nullptr;
  EXPECT_EQ(rdm_pool_config_spec(&c, &spec), RDM_OK);
  EXPECT_STREQ(text, "untouched");
  EXPECT_EQ(rdm_pool_create(nullptr, &c), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(text, "out is NULL");
}

TEST(ConfigError, IsCutBetweenCharacters) {
  char text[40];
  std::memset(text, 'x', sizeof text);
  rdm_pool_config c = pool_config(1);
  c.error = text;
  c.task = "\u00e9\u00e9\u00e9\u00e9";
  for (int32_t size = 1; size <= 16; ++size) {
    c.error_size = size;
    rdm_pool* p = nullptr;
    EXPECT_EQ(rdm_pool_create(&p, &c), RDM_ERROR_NOT_FOUND);
    const std::string whole = rdm_last_error(), got = text;
    EXPECT_LT(got.size(), static_cast<size_t>(size));
    EXPECT_GE(got.size() + 2, static_cast<size_t>(size));
    EXPECT_EQ(whole.substr(0, got.size()), got);
    EXPECT_EQ(text[size], 'x');
  }
  for (const int32_t size : {0, -1}) {
    c.error_size = size;
    rdm_pool* p = nullptr;
    EXPECT_EQ(rdm_pool_create(&p, &c), RDM_ERROR_RANGE);
  }
}

TEST(ConfigError, OfAgentsAndMaps) {
  char text[128] = "";
  rdm_agent_config a = agent_config();
  a.error = text;
  a.error_size = sizeof text;
  a.num_envs = 0;
  rdm_agent* agent = nullptr;
  EXPECT_EQ(rdm_agent_create(&agent, &a), RDM_ERROR_RANGE);
  EXPECT_STREQ(text, rdm_last_error());
  size_t bytes = 0;
  text[0] = '\0';
  EXPECT_EQ(rdm_agent_config_memory(&a, &bytes), RDM_ERROR_RANGE);
  EXPECT_STREQ(text, rdm_last_error());
  EXPECT_EQ(rdm_agent_config_for_pool(&a, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(text, "pool is NULL");

  rdm_map_config m;
  ASSERT_EQ(rdm_map_config_init(&m, sizeof m), RDM_OK);
  m.error = text;
  m.error_size = sizeof text;
  m.resolution = -1;
  rdm_map* map = nullptr;
  EXPECT_EQ(rdm_map_create(&map, &m), RDM_ERROR_RANGE);
  EXPECT_STREQ(text, rdm_last_error());
}

// A host of the first version has no such members: nothing is read or written there.
TEST(ConfigError, OlderStructsHaveNone) {
  char text[16] = "untouched";
  rdm_pool_config c = pool_config(1);
  c.struct_size = offsetof(rdm_pool_config, settings);
  c.settings = "nonsense";
  c.error = text;
  c.error_size = sizeof text;
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  rdm_pool_destroy(p);
  c.task = "nonsense";
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_ERROR_NOT_FOUND);
  EXPECT_STREQ(text, "untouched");
}

}  // namespace
