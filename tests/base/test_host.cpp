#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "base/host.hpp"

namespace rdm {
namespace {

// A host that counts its bytes and checks that each block comes back as it went out.
struct Ledger {
  size_t bytes = 0;
  int calls = 0;
  HostHooks hooks() {
    HostHooks h;
    h.user = this;
    h.alloc = [](void* user, size_t bytes, size_t align) -> void* {
      auto* ledger = static_cast<Ledger*>(user);
      ledger->bytes += bytes;
      ++ledger->calls;
      return std::aligned_alloc(align, (bytes + align - 1) / align * align);
    };
    h.release = [](void* user, void* p, size_t bytes, size_t) {
      static_cast<Ledger*>(user)->bytes -= bytes;
      std::free(p);
    };
    return h;
  }
};

TEST(Host, DefaultAllocationIsAligned) {
  const HostHooks none;
  for (const size_t align : {size_t{1}, size_t{8}, size_t{64}, size_t{4096}}) {
    void* p = host_alloc(none, 100, align);
    EXPECT_EQ(reinterpret_cast<uintptr_t>(p) % align, 0u);
    host_release(none, p, 100, align);
  }
  void* empty = host_alloc(none, 0, 8);
  EXPECT_NE(empty, nullptr);
  host_release(none, empty, 0, 8);
  host_release(none, nullptr, 10, 8);
}

TEST(Host, RefusedMemoryIsAnError) {
  HostHooks refusing;
  refusing.alloc = [](void*, size_t, size_t) -> void* { return nullptr; };
  refusing.release = [](void*, void*, size_t, size_t) {};
  EXPECT_EQ(guard([&] { host_alloc(refusing, 12, 8); }), Code::kMemory);
  EXPECT_STREQ(last_error(), "out of memory: 12 bytes could not be allocated");
  EXPECT_EQ(guard([&] { host_new<int>(refusing, 1); }), Code::kMemory);
}

TEST(Host, ObjectsLiveInHostMemory) {
  Ledger ledger;
  const HostHooks hooks = ledger.hooks();
  struct alignas(64) Wide {
    explicit Wide(int v) : value(v) {}
    int value;
  };
  auto* w = host_new<Wide>(hooks, 5);
  EXPECT_EQ(w->value, 5);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(w) % 64, 0u);
  EXPECT_EQ(ledger.bytes, sizeof(Wide));
  host_delete(hooks, w);
  host_delete<Wide>(hooks, nullptr);
  EXPECT_EQ(ledger.bytes, 0u);
}

TEST(Host, HooksMayLiveInsideTheObject) {
  Ledger ledger;
  struct Handle {
    explicit Handle(const HostHooks& h) : hooks(h) {}
    ~Handle() { hooks = HostHooks{}; }
    HostHooks hooks;
  };
  auto* handle = host_new<Handle>(ledger.hooks(), ledger.hooks());
  host_delete(handle->hooks, handle);
  EXPECT_EQ(ledger.bytes, 0u);
}

TEST(Host, ThrowingConstructorGivesTheMemoryBack) {
  Ledger ledger;
  struct Bad {
    explicit Bad(int) { throw std::runtime_error("no"); }
  };
  EXPECT_THROW(host_new<Bad>(ledger.hooks(), 1), std::runtime_error);
  EXPECT_EQ(ledger.calls, 1);
  EXPECT_EQ(ledger.bytes, 0u);
}

TEST(Host, ScopesNestAndBelongToOneThread) {
  int a = 0, b = 0;
  HostHooks ha, hb;
  ha.user = &a;
  hb.user = &b;
  EXPECT_EQ(host().user, nullptr);
  {
    const HostScope outer(ha);
    EXPECT_EQ(host().user, &a);
    {
      const HostScope inner(hb);
      EXPECT_EQ(host().user, &b);
      std::thread([] { EXPECT_EQ(host().user, nullptr); }).join();
    }
    EXPECT_EQ(host().user, &a);
  }
  EXPECT_EQ(host().user, nullptr);
  set_host(ha);
  EXPECT_EQ(host().user, &a);
  {
    const HostScope inner(hb);
    EXPECT_EQ(host().user, &b);
  }
  set_host(HostHooks{});
}

// A plug-in may call rdm_init or rdm_shutdown while another thread makes a handle.
TEST(Host, HooksAreReadWholeWhileTheyChange) {
  HostHooks set;
  set.user = &set;
  set.alloc = [](void*, size_t, size_t) -> void* { return nullptr; };
  set.release = [](void*, void*, size_t, size_t) {};
  set.log = [](void*, int32_t, const char*) {};
  set.parallel = [](void*, int32_t, ParallelBody, void*) {};
  std::atomic<bool> stop{false};
  std::vector<std::thread> writers;
  for (int k = 0; k < 2; ++k)
    writers.emplace_back([&] {
      while (!stop) {
        set_host(set);
        set_host(HostHooks{});
      }
    });
  int torn = 0, seen = 0;
  const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
  while (std::chrono::steady_clock::now() < until) {
    const HostHooks h = host();
    const int parts = (h.user != nullptr) + (h.alloc != nullptr) + (h.release != nullptr) +
                      (h.log != nullptr) + (h.parallel != nullptr);
    torn += parts != 0 && parts != 5;
    seen += parts == 5;
  }
  stop = true;
  for (auto& t : writers) t.join();
  set_host(HostHooks{});
  EXPECT_EQ(torn, 0);
  EXPECT_GT(seen, 0);
}

TEST(Host, VectorsGrowAndDieInTheHooksTheyWereMadeUnder) {
  Ledger one, two;
  Vector<double> kept;
  {
    const HostScope scope(one.hooks());
    Vector<double> v;
    const HostScope inner(two.hooks());
    for (int i = 0; i < 1000; ++i) v.push_back(i);
    EXPECT_GT(one.calls, 5);
    EXPECT_EQ(two.calls, 0);
    kept = v;  // stays in its own memory: the default's
    EXPECT_EQ(two.calls, 0);
    Vector<double> moved;
    moved = std::move(v);  // other memory, so the elements move one by one
    EXPECT_GE(two.bytes, 1000 * sizeof(double));
    EXPECT_EQ(moved[999], 999);
  }
  EXPECT_EQ(one.bytes, 0u);
  EXPECT_EQ(two.bytes, 0u);
  EXPECT_EQ(kept[999], 999);
}

TEST(Host, LogIsSilentByDefaultAndFormatsOneLine) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  log(HostHooks{}, LogLevel::kError, "nobody hears %d", 1);
  EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");

  struct Heard {
    int32_t level = -1;
    std::string line;
  } heard;
  HostHooks hooks;
  hooks.user = &heard;
  hooks.log = [](void* user, int32_t level, const char* line) {
    static_cast<Heard*>(user)->level = level;
    static_cast<Heard*>(user)->line = line;
  };
  log(hooks, LogLevel::kWarning, "world %d diverged", 3);
  EXPECT_EQ(heard.level, 1);
  EXPECT_EQ(heard.line, "world 3 diverged");
  log(hooks, LogLevel::kInfo, "%s", std::string(5000, 'x').c_str());
  EXPECT_EQ(heard.line.size(), 511u);
}

}  // namespace
}  // namespace rdm
