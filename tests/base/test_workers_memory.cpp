// Threads whose start fails: nothing of them stays.
#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "base/error.hpp"
#include "base/workers.hpp"
#include "refuse_new.hpp"

namespace rdm {
namespace {

int64_t threads_alive() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
}

// std::thread takes its state from operator new; each of three is refused in turn.
TEST(WorkersMemory, ARefusedThreadLeavesNothingBehind) {
  struct Host {
    int64_t bytes = 0;
  } used;
  HostHooks hooks;
  hooks.user = &used;
  hooks.alloc = [](void* user, size_t bytes, size_t align) -> void* {
    static_cast<Host*>(user)->bytes += static_cast<int64_t>(bytes);
    return std::aligned_alloc(align, (bytes + align - 1) / align * align);
  };
  hooks.release = [](void* user, void* p, size_t bytes, size_t) {
    static_cast<Host*>(user)->bytes -= static_cast<int64_t>(bytes);
    std::free(p);
  };
  const HostScope scope(hooks);
  Workers(hooks, 2);  // a sanitizer starts a thread of its own with the first
  const int64_t threads = threads_alive();
  int refused = 0;
  for (int64_t at = 0; at < 3; ++at)
    for (const bool once : {true, false}) {
      const int64_t live = new_live;
      Code code;
      {
        const RefuseNew refuse(at, once);
        code = guard([&] { Workers(hooks, 4); });
        refused += refuse.happened();
      }
      EXPECT_EQ(code, Code::kMemory) << at << ": " << last_error();
      EXPECT_EQ(used.bytes, 0) << at;
      EXPECT_EQ(new_live, live) << at;
      EXPECT_EQ(threads_alive(), threads) << at;
    }
  EXPECT_EQ(refused, 6);
  EXPECT_EQ(guard([&] { Workers(hooks, 4); }), Code::kOk);
}

}  // namespace
}  // namespace rdm
