#include "physics/ode/ode_guard.hpp"

#include <ode/ode.h>

#include <cstdarg>
#include <cstdio>
#include <mutex>

#include "base/error.hpp"
#include "base/host.hpp"

namespace rdm {
namespace {

std::mutex g_mutex;
int g_worlds = 0;
bool g_initialised = false;
dMessageFunction *g_error = nullptr, *g_debug = nullptr, *g_message = nullptr;  // the host's
thread_local int t_depth = 0;
thread_local bool t_has_data = false;

// A complaint about somebody else's use of ODE.
void pass_on(dMessageFunction* host_handler, LogLevel level, int number, const char* text, va_list args) {
  if (host_handler) {
    host_handler(number, text, args);
    return;
  }
  char line[256];
  std::vsnprintf(line, sizeof line, text, args);
  log(host(), level, "ode %d: %s", number, line);
}

void throw_or_pass(dMessageFunction* host_handler, int number, const char* text, va_list args) {
  if (t_depth == 0) {
    pass_on(host_handler, LogLevel::kError, number, text, args);
    return;
  }
  OdeFailure failure;
  std::vsnprintf(failure.text, sizeof failure.text, text, args);
  throw failure;
}

void on_error(int number, const char* text, va_list args) {
  throw_or_pass(g_error, number, text, args);
}
void on_debug(int number, const char* text, va_list args) {
  throw_or_pass(g_debug, number, text, args);
}
void on_message(int number, const char* text, va_list args) {
  if (t_depth == 0) pass_on(g_message, LogLevel::kWarning, number, text, args);
}

}  // namespace

OdeGuard::OdeGuard() {
  const std::lock_guard lock(g_mutex);
  if (!g_initialised) {
    if (!dCheckConfiguration("ODE_double_precision"))
      fail(Code::kVersion, "ode: the library found at run time is single precision, double is needed");
    if (!dInitODE2(0)) fail(Code::kPhysics, "ode: initialisation failed");
    g_initialised = true;
  }
  if (g_worlds++ == 0) {
    g_error = dGetErrorHandler();
    g_debug = dGetDebugHandler();
    g_message = dGetMessageHandler();
    dSetErrorHandler(on_error);
    dSetDebugHandler(on_debug);
    dSetMessageHandler(on_message);
  }
}

OdeGuard::~OdeGuard() {
  const std::lock_guard lock(g_mutex);
  if (--g_worlds > 0) return;
  // A host that put in its own handlers meanwhile keeps them.
  if (dGetErrorHandler() == on_error) dSetErrorHandler(g_error);
  if (dGetDebugHandler() == on_debug) dSetDebugHandler(g_debug);
  if (dGetMessageHandler() == on_message) dSetMessageHandler(g_message);
}

OdeScope::OdeScope() {
  ++t_depth;
  if (!t_has_data) t_has_data = dAllocateODEDataForThread(dAllocateMaskAll) != 0;
}

OdeScope::~OdeScope() {
  --t_depth;
}

}  // namespace rdm
