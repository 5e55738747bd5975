#include <gtest/gtest.h>
#include <ode/ode.h>

#include <cstdarg>
#include <thread>

#include "base/error.hpp"
#include "physics/ode/ode_guard.hpp"

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

TEST(OdeGuard, ScopesNest) {
  const OdeGuard guard;
  const OdeScope outer;
  { const OdeScope inner; }
  EXPECT_THROW(dError(2, "still inside"), Error);
}

}  // namespace
}  // namespace rdm
