// ODE's process-wide state, kept safe: initialisation, per-thread data, error handlers.
//
// ODE ends the process after an error handler returns, so ours throws OdeFailure while this thread is in
// an OdeScope; elsewhere a host's own handlers go on working.
#pragma once

namespace rdm {

struct OdeFailure {
  char text[160];
};

// Held by every world. The first one initialises ODE (which then stays initialised: a host may use it
// too) and takes the handlers; the last one puts the host's back.
// Error(kVersion) when the ODE found at run time is not the double-precision build.
class OdeGuard {
 public:
  OdeGuard();
  ~OdeGuard();
  OdeGuard(const OdeGuard&) = delete;
  OdeGuard& operator=(const OdeGuard&) = delete;
};

// Around every stretch of ODE calls: ODE has this thread's data, and its complaints are thrown as
// OdeFailure or, when they are mere messages, dropped.
class OdeScope {
 public:
  OdeScope();
  ~OdeScope();
  OdeScope(const OdeScope&) = delete;
  OdeScope& operator=(const OdeScope&) = delete;
};

}  // namespace rdm
