#include <gtest/gtest.h>
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

namespace {

TEST(Library, HeaderAndLibraryAreCompared) {
  EXPECT_EQ(rdm_version(), static_cast<uint32_t>(RDM_VERSION));
  EXPECT_EQ(rdm_check_abi(RDM_ABI, RDM_VERSION), RDM_OK);
  EXPECT_EQ(rdm_check_abi(RDM_ABI, 0), RDM_OK);  // an older header
  EXPECT_EQ(rdm_check_abi(RDM_ABI, RDM_VERSION + 1), RDM_ERROR_VERSION_MISMATCH);
  EXPECT_EQ(rdm_check_abi(RDM_ABI + 1, RDM_VERSION), RDM_ERROR_VERSION_MISMATCH);
  EXPECT_NE(std::string(rdm_last_error()).find("abi"), std::string::npos);
  EXPECT_EQ(rdm_check_experimental(RDM_VERSION), RDM_OK);
  EXPECT_EQ(rdm_check_experimental(RDM_VERSION / 1000 * 1000 + 999), RDM_OK);  // another patch
  EXPECT_EQ(rdm_check_experimental(RDM_VERSION + 1000), RDM_ERROR_VERSION_MISMATCH);
  EXPECT_EQ(rdm_check_experimental(RDM_VERSION - 1000), RDM_ERROR_VERSION_MISMATCH);
}

TEST(Library, NearestNamesAreThoseOfItsOwnTexts) {
  char text[4 * RDM_TEXT_SIZE];
  ASSERT_EQ(rdm_nearest_names("Gama", "lambda\ngamma\nclip", text, sizeof text), RDM_OK);
  EXPECT_STREQ(text, "; nearest is gamma");
  ASSERT_EQ(rdm_nearest_names("lag", "ppo_lag\ntrpo_lag\n\nppo\n", text, sizeof text), RDM_OK);
  EXPECT_STREQ(text, "; nearest are ppo_lag and trpo_lag");
  for (const char* none : {"", "\n\n", "zebra"}) {
    ASSERT_EQ(rdm_nearest_names("gamma", none, text, sizeof text), RDM_OK);
    EXPECT_STREQ(text, "");
  }
  ASSERT_EQ(rdm_nearest_names("gama", "gamma", text, 8), RDM_OK);
  EXPECT_STREQ(text, "; neare");
  const std::string most(400, 'x');
  ASSERT_EQ(
      rdm_nearest_names(most.c_str(), (most + "a\n" + most + "b\n" + most + "c").c_str(), text, sizeof text),
      RDM_OK);
  EXPECT_LT(std::strlen(text), sizeof text - 1);
  EXPECT_EQ(rdm_nearest_names(nullptr, "a", text, sizeof text), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_nearest_names("a", nullptr, text, sizeof text), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_nearest_names("a", "a", nullptr, sizeof text), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_nearest_names("a", "a", text, 0), RDM_ERROR_ARGUMENT);
}

TEST(Library, ResultsHaveStrings) {
  for (const rdm_result r : std::initializer_list<rdm_result>{
           RDM_OK, RDM_ERROR_ARGUMENT, RDM_ERROR_RANGE, RDM_ERROR_STATE, RDM_ERROR_MEMORY, RDM_ERROR_IO,
           RDM_ERROR_FORMAT, RDM_ERROR_VERSION_MISMATCH, RDM_ERROR_UNSUPPORTED, RDM_ERROR_PHYSICS,
           RDM_ERROR_NOT_FOUND, RDM_ERROR_CANCELLED, RDM_ERROR_INTERNAL, 1, 1000, -1000})
    EXPECT_GT(std::strlen(rdm_result_string(r)), 0u) << r;
  EXPECT_STRNE(rdm_result_string(RDM_ERROR_IO), rdm_result_string(RDM_ERROR_FORMAT));
}

TEST(Library, BuildInfoFillsNoMoreThanItsCallerHas) {
  struct Newer {  // a caller whose header has one more field
    rdm_build build;
    uint64_t more;
  } newer;
  std::memset(&newer, 0x55, sizeof newer);
  newer.build.struct_size = sizeof newer;
  ASSERT_EQ(rdm_build_info(&newer.build), RDM_OK);
  EXPECT_EQ(newer.build.struct_size, sizeof newer);
  EXPECT_EQ(newer.more, 0u);  // what this library does not know is not what stood there
  const std::string want = std::to_string(RDM_VERSION_MAJOR) + "." + std::to_string(RDM_VERSION_MINOR) + "." +
                           std::to_string(RDM_VERSION_PATCH);
  EXPECT_EQ(newer.build.version, want);
  EXPECT_EQ(rdm_build_info(nullptr), RDM_ERROR_ARGUMENT);
  newer.build.struct_size = 8;
  EXPECT_EQ(rdm_build_info(&newer.build), RDM_ERROR_ARGUMENT);
}

TEST(Library, BuildInfoServesACallerOfTheFirstVersion) {
  rdm_build build;
  std::memset(&build, 0x55, sizeof build);
  build.struct_size = offsetof(rdm_build, differs);
  ASSERT_EQ(rdm_build_info(&build), RDM_OK);
  EXPECT_GT(std::strlen(build.kernels), 0u);
  unsigned char beyond[sizeof build.differs];
  std::memcpy(beyond, &build.differs, sizeof beyond);
  for (const unsigned char byte : beyond) EXPECT_EQ(byte, 0x55);
  build.struct_size = sizeof build;
  ASSERT_EQ(rdm_build_info(&build), RDM_OK);
  for (const char* known : {"", "ODE", "libccd", "ODE, libccd"})
    if (build.differs == std::string(known)) return;
  ADD_FAILURE() << build.differs;
}

TEST(Library, HooksAreCountedAndPutBack) {
  static int calls = 0;
  rdm_host host = {};
  host.struct_size = sizeof host;
  host.alloc = [](void*, size_t bytes, size_t align) -> void* {
    ++calls;
    return std::aligned_alloc(align, (bytes + align - 1) / align * align);
  };
  EXPECT_EQ(rdm_init(&host), RDM_ERROR_ARGUMENT);  // alloc without release
  host.release = [](void*, void* p, size_t, size_t) { std::free(p); };
  const auto make_policyless_agent = [] {
    rdm_agent_config config;
    rdm_agent_config_init(&config, sizeof config);
    config.obs_dim = 2;
    config.action_dim = config.num_envs = 1;
    rdm_agent* agent = nullptr;
    EXPECT_EQ(rdm_agent_create(&agent, &config), RDM_OK) << rdm_last_error();
    return agent;
  };

  ASSERT_EQ(rdm_init(&host), RDM_OK);
  ASSERT_EQ(rdm_init(nullptr), RDM_OK);         // a second user of the library
  EXPECT_EQ(rdm_init(&host), RDM_ERROR_STATE);  // who may not change the hooks under the first
  rdm_agent* hooked = make_policyless_agent();
  EXPECT_GT(calls, 0);
  rdm_shutdown();
  const int before = calls;
  rdm_agent* still = make_policyless_agent();
  EXPECT_GT(calls, before);
  rdm_shutdown();
  const int after = calls;
  rdm_agent* plain = make_policyless_agent();
  EXPECT_EQ(calls, after);
  rdm_agent_destroy(hooked);  // with the hooks it was made with
  rdm_agent_destroy(still);
  rdm_agent_destroy(plain);
  rdm_shutdown();  // one too many is harmless
}

TEST(Library, ARefusedInitSaysWhatWentBefore) {
  rdm_host host{};
  host.struct_size = sizeof host;
  ASSERT_EQ(rdm_init(nullptr), RDM_OK);
  EXPECT_EQ(rdm_init(&host), RDM_ERROR_STATE);
  EXPECT_STREQ(rdm_last_error(), "rdm_init: it was called before, without hooks; call rdm_shutdown first");
  rdm_shutdown();
  ASSERT_EQ(rdm_init(&host), RDM_OK);
  EXPECT_EQ(rdm_init(&host), RDM_ERROR_STATE);
  EXPECT_STREQ(rdm_last_error(), "rdm_init: it was called before, with hooks; call rdm_shutdown first");
  rdm_shutdown();
}

// Hosts with two plug-ins: each counts its own init and shutdown, on threads of its own.
TEST(Library, InitBesideThreadsThatMakeHandles) {
  rdm_host host{};
  host.struct_size = sizeof host;
  host.alloc = [](void*, size_t bytes, size_t align) -> void* {
    return std::aligned_alloc(align, (bytes + align - 1) / align * align);
  };
  host.release = [](void*, void* p, size_t, size_t) { std::free(p); };
  std::vector<std::thread> threads;
  for (int k = 0; k < 2; ++k) {
    threads.emplace_back([&] {
      for (int i = 0; i < 20000; ++i) {
        rdm_init(&host);
        rdm_shutdown();
      }
    });
    threads.emplace_back([] {
      rdm_agent_config config;
      rdm_agent_config_init(&config, sizeof config);
      const rdm_option options[] = {{"hidden", "4", 0}, {"horizon", nullptr, 4}, {"minibatches", nullptr, 1}};
      config.obs_dim = config.action_dim = config.num_envs = 1;
      config.options = options;
      config.num_options = 3;
      for (int i = 0; i < 1000; ++i) {
        rdm_agent* agent = nullptr;
        EXPECT_EQ(rdm_agent_create(&agent, &config), RDM_OK) << rdm_last_error();
        rdm_agent_destroy(agent);
      }
    });
  }
  for (auto& t : threads) t.join();
}

TEST(Library, ErrorTextBelongsToTheThread) {
  ASSERT_EQ(rdm_check_abi(RDM_ABI + 1, 0), RDM_ERROR_VERSION_MISMATCH);
  const std::string mine = rdm_last_error();
  std::thread([] {
    EXPECT_STREQ(rdm_last_error(), "");
    EXPECT_EQ(rdm_task_find(nullptr, nullptr), RDM_ERROR_ARGUMENT);
  }).join();
  EXPECT_EQ(rdm_last_error(), mine);
}

}  // namespace
