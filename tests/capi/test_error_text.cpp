// Whatever bytes a host hands over as a name, a path or an option: the text of the failure is one line of
// UTF-8 without control characters, for every task and every algorithm.
#include <redman/map.h>

#include <filesystem>

#include "contract.hpp"

namespace {

// A decoder of its own, by the definition: code points from their bits, in their shortest form.
::testing::AssertionResult printable(const char* text) {
  for (const char* p = text; *p;) {
    const auto lead = static_cast<unsigned char>(*p++);
    const int more = lead < 0x80 ? 0 : lead >> 5 == 6 ? 1 : lead >> 4 == 14 ? 2 : lead >> 3 == 30 ? 3 : -1;
    if (more < 0) return ::testing::AssertionFailure() << "byte " << int(lead) << " in: " << text;
    uint32_t c = more == 0 ? lead : lead & (0x3Fu >> more);
    for (int i = 0; i < more; ++i, ++p) {
      if ((static_cast<unsigned char>(*p) & 0xC0) != 0x80)
        return ::testing::AssertionFailure() << "a cut character in: " << text;
      c = c << 6 | (static_cast<unsigned char>(*p) & 0x3F);
    }
    const uint32_t least[] = {0, 0x80, 0x800, 0x10000};
    if (c < least[more] || c > 0x10FFFF || (c >= 0xD800 && c < 0xE000))
      return ::testing::AssertionFailure() << "U+" << c << " in: " << text;
    if (c < 0x20 || (c >= 0x7F && c < 0xA0))
      return ::testing::AssertionFailure() << "control " << c << " in: " << text;
  }
  return ::testing::AssertionSuccess();
}

std::vector<std::string> bad_names() {
  std::vector<std::string> names;
  for (const char* one : {"\u00e9", "\u20ac", "\U0001F916", "\xff", "\xc3", "\x1b[31m", "\n", "\u009b"})
    for (size_t shift = 0; shift < 4; ++shift)
      for (const int times : {1, 40, 300}) {
        std::string name(shift, 'x');
        for (int i = 0; i < times; ++i) name += one;
        names.push_back(name);
      }
  return names;
}

class ErrorText : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Names, ErrorText, testing::ValuesIn(bad_names()),
                         [](const auto& info) { return std::to_string(info.index); });

TEST_P(ErrorText, OfNames) {
  const char* name = GetParam().c_str();
  int32_t index = -1;
  EXPECT_EQ(rdm_task_find(name, &index), RDM_ERROR_NOT_FOUND);
  EXPECT_TRUE(printable(rdm_last_error()));
  EXPECT_EQ(rdm_algo_find(name, &index), RDM_ERROR_NOT_FOUND);
  EXPECT_TRUE(printable(rdm_last_error()));

  rdm_pool_config c = pool_config(1);
  c.task = "bandit";
  rdm_pool* p = make_pool(c);
  uint8_t pixels[3 * 8 * 8];
  EXPECT_NE(rdm_pool_render(p, 0, name, 8, 8, pixels, nullptr, nullptr), RDM_OK);
  EXPECT_TRUE(printable(rdm_last_error()));
  EXPECT_TRUE(printable(rdm_pool_error(p)));
  rdm_pool_destroy(p);

  rdm_agent* a = make_agent(agent_config());
  float number = 0;
  EXPECT_EQ(rdm_agent_get_tensor(a, name, &number, 1), RDM_ERROR_NOT_FOUND);
  EXPECT_TRUE(printable(rdm_last_error()));
  EXPECT_EQ(rdm_agent_set_tensor(a, name, &number, 1), RDM_ERROR_NOT_FOUND);
  EXPECT_TRUE(printable(rdm_last_error()));
  EXPECT_TRUE(printable(rdm_agent_error(a)));
  const auto bytes = policy_bytes(a);
  rdm_policy* policy = nullptr;
  ASSERT_EQ(rdm_policy_read(&policy, bytes.data(), bytes.size()), RDM_OK);
  EXPECT_EQ(rdm_policy_get_tensor(policy, name, &number, 1), RDM_ERROR_NOT_FOUND);
  EXPECT_TRUE(printable(rdm_last_error()));
  rdm_policy_destroy(policy);

  const std::string path = (std::filesystem::temp_directory_path() / "no_such_folder").string() + "/" + name;
  EXPECT_NE(rdm_agent_write_policy_file(a, path.c_str()), RDM_OK);
  EXPECT_TRUE(printable(rdm_last_error()));
  EXPECT_NE(rdm_policy_read_file(&policy, path.c_str()), RDM_OK);
  EXPECT_TRUE(printable(rdm_last_error()));
  EXPECT_NE(rdm_checkpoint_read(path.c_str(), a, nullptr, nullptr, 0, nullptr), RDM_OK);
  EXPECT_TRUE(printable(rdm_last_error()));
  rdm_agent_destroy(a);

  rdm_map_config m;
  ASSERT_EQ(rdm_map_config_init(&m, sizeof m), RDM_OK);
  rdm_map* map = nullptr;
  ASSERT_EQ(rdm_map_create(&map, &m), RDM_OK) << rdm_last_error();
  for (const char* ending : {"", ".bt"}) {
    EXPECT_NE(rdm_map_write_file(map, (path + ending).c_str()), RDM_OK);
    EXPECT_TRUE(printable(rdm_last_error()));
    EXPECT_NE(rdm_map_read_file(map, (path + ending).c_str()), RDM_OK);
    EXPECT_TRUE(printable(rdm_last_error()));
  }
  rdm_map_destroy(map);
}

// Keys, then the texts of every option of every task; whatever a task accepts, it also prints whole.
TEST(ErrorTextAll, TasksAndTheirOptions) {
  const std::vector<std::string> names = {"\xff", "x\x1b[31m", std::string(40, '\xc3')};
  for (int32_t t = 0; t < rdm_task_count(); ++t) {
    rdm_task task{};
    task.struct_size = sizeof task;
    ASSERT_EQ(rdm_task_at(t, &task), RDM_OK);
    rdm_pool_config c = pool_config(1);
    c.task = task.name;
    for (const std::string& name : names) {
      std::vector<rdm_option> options{{name.c_str(), nullptr, 0}};
      for (int32_t i = 0; i < task.num_options; ++i) {
        rdm_option_spec info = RDM_INIT(rdm_option_spec);
        ASSERT_EQ(rdm_task_option_at(t, i, &info), RDM_OK);
        options.push_back({info.key, name.c_str(), 0});
      }
      for (const rdm_option& o : options) {
        c.options = &o;
        c.num_options = 1;
        rdm_pool* p = nullptr;
        if (rdm_pool_create(&p, &c) != RDM_OK) {
          EXPECT_TRUE(printable(rdm_last_error())) << task.name << " " << o.key;
        }
        rdm_pool_destroy(p);
      }
    }
  }
}

TEST(ErrorTextAll, AlgorithmsAndTheirOptions) {
  const std::vector<std::string> names = {"\xff", "x\x1b[31m", std::string(40, '\xc3')};
  for (int32_t g = 0; g < rdm_algo_count(); ++g) {
    rdm_algo algo{};
    algo.struct_size = sizeof algo;
    ASSERT_EQ(rdm_algo_at(g, &algo), RDM_OK);
    rdm_agent_config c = agent_config();
    c.algo = algo.name;
    for (const std::string& name : names) {
      std::vector<rdm_option> options{{name.c_str(), nullptr, 0}};
      for (int32_t i = 0; i < algo.num_options; ++i) {
        rdm_option_spec info = RDM_INIT(rdm_option_spec);
        ASSERT_EQ(rdm_algo_option_at(g, i, &info), RDM_OK);
        options.push_back({info.key, name.c_str(), 0});
      }
      for (const rdm_option& o : options) {
        c.options = &o;
        c.num_options = 1;
        rdm_agent* a = nullptr;
        EXPECT_NE(rdm_agent_create(&a, &c), RDM_OK) << algo.name << " " << o.key;
        EXPECT_TRUE(printable(rdm_last_error())) << algo.name << " " << o.key;
        rdm_agent_destroy(a);
      }
    }
  }
}

}  // namespace
