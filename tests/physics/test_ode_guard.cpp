#include <gtest/gtest.h>
#include <ode/ode.h>

#include <cstdarg>
#include <cstdlib>
#include <thread>

#include "base/error.hpp"
#include "heap_count.hpp"
#include "physics/ode_library/ode_guard.hpp"

namespace rdm {
namespace {

int g_messages = 0;
void host_message(int, const char*, va_list) {
  ++g_messages;
}

TEST(OdeGuard, MisuseInsideIsThrown) {
  const OdeGuard guard;
  const OdeScope scope;
  EXPECT_THROW(dDebug(1, "misuse %d", 7), Error);
  EXPECT_THROW(dError(2, "failure"), Error);
  try {
    dDebug(1, "misuse %d", 7);
  } catch (const Error& failure) {
    EXPECT_EQ(failure.code, Code::kPhysics);
    EXPECT_STREQ(failure.text, "ode: misuse 7");
  }
  // A real one: ODE checks its arguments.
  const dWorldID world = dWorldCreate();
  EXPECT_THROW(dWorldQuickStep(world, -1), Error);
  dWorldDestroy(world);
}

TEST(OdeGuard, MessagesInsideAreDroppedOutsideTheyGoToTheHost) {
  dSetMessageHandler(host_message);
  g_messages = 0;
  {
    const OdeGuard guard;
    {
      const OdeScope scope;
      dMessage(3, "inside");
    }
    EXPECT_EQ(g_messages, 0);
    dMessage(3, "outside");
    EXPECT_EQ(g_messages, 1);
    std::thread([] { dMessage(3, "another thread"); }).join();
    EXPECT_EQ(g_messages, 2);
  }
  EXPECT_EQ(dGetMessageHandler(), host_message);
  dSetMessageHandler(nullptr);
}

TEST(OdeGuard, HandlersGoBackWithTheLastGuard) {
  dMessageFunction* const before = dGetErrorHandler();
  {
    const OdeGuard one;
    { const OdeGuard two; }
    EXPECT_NE(dGetErrorHandler(), before);
    EXPECT_NE(dGetDebugHandler(), nullptr);
  }
  EXPECT_EQ(dGetErrorHandler(), before);
}

TEST(OdeGuard, AHostThatReplacedTheHandlersKeepsThem) {
  {
    const OdeGuard guard;
    dSetErrorHandler(host_message);
  }
  EXPECT_EQ(dGetErrorHandler(), host_message);
  dSetErrorHandler(nullptr);
}

// A host's memory, and how much of it is out.
int g_blocks = 0;
bool g_refuses = false;
void* host_alloc(dsizeint bytes) {
  if (g_refuses) return nullptr;
  ++g_blocks;
  return std::malloc(bytes);
}
void* host_realloc(void* block, dsizeint, dsizeint bytes) {
  return g_refuses ? nullptr : std::realloc(block, bytes);
}
void host_free(void* block, dsizeint) {
  --g_blocks;
  std::free(block);
}

TEST(OdeGuard, MemoryIsTheHostsAndARefusalIsThrownInsideOnly) {
  dSetAllocHandler(host_alloc);
  dSetReallocHandler(host_realloc);
  dSetFreeHandler(host_free);
  {
    const OdeGuard guard;
    {
      const OdeScope scope;
      void* block = dAlloc(8);
      EXPECT_EQ(g_blocks, 1);
      block = dRealloc(block, 8, 16);
      g_refuses = true;
      EXPECT_THROW(dAlloc(8), Error);
      EXPECT_THROW(dRealloc(block, 16, 32), Error);
      EXPECT_THROW(dWorldCreate(), Error);
      EXPECT_THROW(dCreateSphere(nullptr, 1), Error);
      dFree(block, 16);
      EXPECT_EQ(g_blocks, 0);
    }
    EXPECT_EQ(dAlloc(8), nullptr);
    std::thread([] { EXPECT_EQ(dAlloc(8), nullptr); }).join();
    g_refuses = false;
  }
  EXPECT_EQ(dGetAllocHandler(), host_alloc);
  EXPECT_EQ(dGetReallocHandler(), host_realloc);
  EXPECT_EQ(dGetFreeHandler(), host_free);
  dSetAllocHandler(nullptr);
  dSetReallocHandler(nullptr);
  dSetFreeHandler(nullptr);
}

TEST(OdeGuard, BlocksThatAreLeftAreFreedByPurpose) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is not ours under sanitizers";
  const OdeGuard guard;
  const char one = 0, two = 0;
  const int64_t before = heap_blocks();
  {
    OdeBlocks blocks;
    {
      const OdeScope scope(&blocks, &one);
      void* const returned = dAlloc(8);
      dAlloc(8);  // lost
      dFree(returned, 8);
      const OdeScope inner;  // the same
      dAlloc(8);
    }
    const OdeScope scope(&blocks, &two);
    void* const kept = dRealloc(dAlloc(8), 8, 4096);
    dAlloc(8);                                 // lost, to the end
    EXPECT_EQ(heap_blocks(), before + 4 + 1);  // and their list
    blocks.release(&one);
    EXPECT_EQ(heap_blocks(), before + 2 + 1);
    dFree(kept, 4096);
    EXPECT_EQ(heap_blocks(), before + 1 + 1);
  }
  EXPECT_EQ(heap_blocks(), before);
}

TEST(OdeGuard, ScopesNest) {
  const OdeGuard guard;
  const OdeScope outer;
  { const OdeScope inner; }
  EXPECT_THROW(dError(2, "still inside"), Error);
}

}  // namespace
}  // namespace rdm
