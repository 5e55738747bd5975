#include "physics/ode_library/ode_guard.hpp"

#include <ode/ode.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <new>

#include "base/error.hpp"
#include "base/format.hpp"
#include "base/host.hpp"

namespace rdm {
namespace {

std::mutex g_mutex;
int g_worlds = 0;
bool g_initialised = false;
dMessageFunction *g_error = nullptr, *g_debug = nullptr, *g_message = nullptr;  // the host's
dAllocFunction* g_alloc = nullptr;
dReallocFunction* g_realloc = nullptr;
dFreeFunction* g_free = nullptr;
thread_local OdeScope* t_scope = nullptr;  // the innermost one
thread_local bool t_has_data = false;

// A complaint about somebody else's use of ODE.
void pass_on(dMessageFunction* host_handler, LogLevel level, int number, const char* text, va_list args) {
  if (host_handler) {
    host_handler(number, text, args);
    return;
  }
  char line[256];
  print_list(line, sizeof line, text, args);
  log(host(), level, "ode %d: %s", number, line);
}

void throw_or_pass(dMessageFunction* host_handler, int number, const char* text, va_list args) {
  if (!t_scope) {
    pass_on(host_handler, LogLevel::kError, number, text, args);
    return;
  }
  char line[160];
  print_list(line, sizeof line, text, args);
  fail(Code::kPhysics, "ode: %s", line);
}

void on_error(int number, const char* text, va_list args) {
  throw_or_pass(g_error, number, text, args);
}
void on_debug(int number, const char* text, va_list args) {
  throw_or_pass(g_debug, number, text, args);
}
void on_message(int number, const char* text, va_list args) {
  if (!t_scope) pass_on(g_message, LogLevel::kWarning, number, text, args);
}

[[noreturn]] void refuse(size_t bytes) {
  fail(Code::kMemory, "ode: out of memory: %zu bytes could not be allocated", bytes);
}

void give_back(void* block, size_t bytes) {
  if (g_free)
    g_free(block, bytes);
  else
    std::free(block);
}

void* on_alloc(dsizeint bytes) {
  return ode_alloc(bytes, t_scope ? t_scope->purpose() : nullptr);
}
void* on_realloc(void* block, dsizeint old_bytes, dsizeint bytes) {
  if (!block) return on_alloc(bytes);
  void* const moved = g_realloc ? g_realloc(block, old_bytes, bytes) : std::realloc(block, bytes);
  if (!t_scope) return moved;
  if (!moved) refuse(bytes);
  if (t_scope->blocks()) t_scope->blocks()->replace(block, moved, bytes);
  return moved;
}
void on_free(void* block, dsizeint bytes) {
  ode_free(block, bytes);
}

void take_handlers() {
  g_error = dGetErrorHandler();
  g_debug = dGetDebugHandler();
  g_message = dGetMessageHandler();
  g_alloc = dGetAllocHandler();
  g_realloc = dGetReallocHandler();
  g_free = dGetFreeHandler();
  dSetErrorHandler(on_error);
  dSetDebugHandler(on_debug);
  dSetMessageHandler(on_message);
  dSetAllocHandler(on_alloc);
  dSetReallocHandler(on_realloc);
  dSetFreeHandler(on_free);
}

// A host that put in its own handlers meanwhile keeps them.
void put_back_handlers() {
  if (dGetErrorHandler() == on_error) dSetErrorHandler(g_error);
  if (dGetDebugHandler() == on_debug) dSetDebugHandler(g_debug);
  if (dGetMessageHandler() == on_message) dSetMessageHandler(g_message);
  if (dGetAllocHandler() == on_alloc) dSetAllocHandler(g_alloc);
  if (dGetReallocHandler() == on_realloc) dSetReallocHandler(g_realloc);
  if (dGetFreeHandler() == on_free) dSetFreeHandler(g_free);
}

// With our handlers in place.
void initialise() {
  const OdeScope scope;
  if (!dCheckConfiguration("ODE_double_precision"))
    fail(Code::kVersion,
         "ode: the library found at run time has single precision, but double precision is needed");
  if (!dInitODE2(0)) fail(Code::kPhysics, "ode: initialisation failed");
  g_initialised = true;
}

}  // namespace

OdeGuard::OdeGuard() {
  const std::lock_guard lock(g_mutex);
  if (g_worlds == 0) take_handlers();
  try {
    if (!g_initialised) initialise();
  } catch (...) {
    if (g_worlds == 0) put_back_handlers();
    throw;
  }
  ++g_worlds;
}

OdeGuard::~OdeGuard() {
  const std::lock_guard lock(g_mutex);
  if (--g_worlds == 0) put_back_handlers();
}

OdeBlocks::~OdeBlocks() {
  for (const Entry& entry : entries_) give_back(entry.block, entry.bytes);
}

void OdeBlocks::add(void* block, size_t bytes, const void* purpose) {
  entries_.push_back({block, bytes, purpose});
}

// What was taken last is given back first, mostly.
OdeBlocks::Entry* OdeBlocks::find(const void* block) {
  for (size_t i = entries_.size(); i-- > 0;)
    if (entries_[i].block == block) return &entries_[i];
  return nullptr;
}

void OdeBlocks::replace(const void* block, void* by, size_t bytes) {
  if (Entry* const entry = find(block)) *entry = {by, bytes, entry->purpose};
}

void OdeBlocks::remove(const void* block) {
  Entry* const entry = find(block);
  if (!entry) return;
  *entry = entries_.back();
  entries_.pop_back();
}

void OdeBlocks::give_purpose(const void* block, const void* purpose) {
  if (Entry* const entry = find(block)) entry->purpose = purpose;
}

void OdeBlocks::release(const void* purpose) {
  const auto left = std::partition(entries_.begin(), entries_.end(),
                                   [&](const Entry& entry) { return entry.purpose != purpose; });
  for (auto entry = left; entry != entries_.end(); ++entry) give_back(entry->block, entry->bytes);
  entries_.erase(left, entries_.end());
}

OdeScope::OdeScope(OdeBlocks* blocks, const void* purpose) : outer_(t_scope) {
  t_scope = this;
  if (!t_has_data && g_initialised) {
    try {
      t_has_data = dAllocateODEDataForThread(static_cast<unsigned>(dAllocateMaskAll)) != 0;
    } catch (const Error&) {  // it is for shapes that we have none of; the next scope tries again
    }
  }
  blocks_ = blocks || !outer_ ? blocks : outer_->blocks_;
  purpose_ = blocks || !outer_ ? purpose : outer_->purpose_;
}

OdeScope::~OdeScope() {
  t_scope = outer_;
}

void* ode_alloc(size_t bytes, const void* purpose) {
  void* const block = g_alloc ? g_alloc(bytes) : std::malloc(bytes);
  if (!t_scope) return block;
  if (!block) refuse(bytes);
  try {
    if (t_scope->blocks() && purpose) t_scope->blocks()->add(block, bytes, purpose);
  } catch (const std::bad_alloc&) {
    give_back(block, bytes);
    refuse(bytes);
  }
  return block;
}

void ode_free(void* block, size_t bytes) {
  if (t_scope && t_scope->blocks()) t_scope->blocks()->remove(block);
  give_back(block, bytes);
}

OdeBlocks* ode_blocks() {
  return t_scope ? t_scope->blocks() : nullptr;
}

}  // namespace rdm
