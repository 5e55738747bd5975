// A handle in use: one call at a time changes it, or any number read it. A host's callbacks and hooks run
// within a call, and what they call on the same handle is refused like another thread's call.
#pragma once
#include <atomic>
#include <type_traits>

#include "capi/abi_call.hpp"

namespace rdm::capi {

class InUse {
 public:
  bool enter(bool alone) {
    int32_t now = 0;
    if (alone) return users_.compare_exchange_strong(now, kAlone, std::memory_order_acquire);
    while (now >= 0)
      if (users_.compare_exchange_weak(now, now + 1, std::memory_order_acquire)) return true;
    return false;
  }
  void leave(bool alone) {
    if (alone)
      users_.store(0, std::memory_order_release);
    else
      users_.fetch_sub(1, std::memory_order_release);
  }
  // A failure's text into the handle's, one of those who read at a time.
  void tell(char* text) {
    while (telling_.exchange(true, std::memory_order_acquire)) {
    }
    std::strcpy(text, last_error());
    telling_.store(false, std::memory_order_release);
  }

 private:
  static constexpr int32_t kAlone = -1;
  std::atomic<int32_t> users_ = 0;  // how many read, kAlone: one changes
  std::atomic<bool> telling_ = false;
};

// Calls with a const handle read it alone, but those of handles whose const calls use scratch of theirs.
template <class Handle>
inline constexpr bool kChanges = !std::is_const_v<Handle> || std::remove_const_t<Handle>::kOneAtATime;

// While it lives, its call is in the handle. Error(kState) where another one is.
template <class Handle>
class Use {
 public:
  explicit Use(Handle* h) : handle_(h) { enter(h); }
  ~Use() { handle_->in_use.leave(kChanges<Handle>); }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;

  static void enter(Handle* h) {
    need_handle(h);
    if (h->in_use.enter(kChanges<Handle>)) return;
    note_failure(true);  // whoever called back says why
    fail(Code::kState,
         "%s is in use by a call that has not returned yet: one of another thread, or the one whose callback "
         "this is",
         name_of(Handle::kTag));
  }

 private:
  Handle* handle_;
};

// The same of a handle that may be NULL, or the one that the call is in already: then of none.
template <class Handle>
class UseIfAny {
 public:
  explicit UseIfAny(Handle* h) : handle_(h) {
    if (h) Use<Handle>::enter(h);
  }
  ~UseIfAny() {
    if (handle_) handle_->in_use.leave(kChanges<Handle>);
  }
  UseIfAny(const UseIfAny&) = delete;
  UseIfAny& operator=(const UseIfAny&) = delete;

 private:
  Handle* handle_;
};

// Of a handle that seldom changes and that any number read in short calls: these count nothing, they look before and
// after. Error(kState) for who reads or changes it while another one changes it.
class Changes {
 public:
  uint32_t begin_reading(const char* name) const {
    const uint32_t now = count_.load();
    check(now % 2 == 0, name);
    return now;
  }
  void end_reading(uint32_t begun, const char* name) const { check(count_.load() == begun, name); }
  template <class F>
  void change(const char* name, F&& f) {
    uint32_t now = count_.load();
    check(now % 2 == 0 && count_.compare_exchange_strong(now, now + 1), name);
    try {
      f();
    } catch (...) {
      count_.store(now + 2);
      throw;
    }
    count_.store(now + 2);
  }

 private:
  static void check(bool good, const char* name) {
    if (!good) fail(Code::kState, "%s is being changed by another call", name);
  }
  std::atomic<uint32_t> count_ = 0;  // odd within a change
};

// A call on a handle: f runs while nobody else is in it. A failure's text becomes the handle's too, where it
// keeps those of such calls; that of a call that was refused does not, as the handle is another's then.
template <class Handle, class F>
rdm_result call_on(Handle* h, F&& f) noexcept {
  const FpMode mode;
  Code inner = Code::kOk;
  const Code outer = guard([&] {
    const Use<Handle> use(h);
    inner = guard(f);
    if constexpr (std::is_same_v<decltype(&h->error[0]), char*>)
      if (inner != Code::kOk) h->in_use.tell(h->error);
  });
  return static_cast<rdm_result>(outer != Code::kOk ? outer : inner);
}

// The same for a call that takes a config, too.
template <class Config, class Handle, class F>
rdm_result call_with(const Config* c, Handle* h, F&& f) noexcept {
  return tell(c, call_on(h, f));
}

// Whether a destroy function may end the handle; one that a call is in stays as it is, and the host's log
// says so.
template <class Handle>
bool may_end(Handle* h) {
  if (!is_handle(h)) return false;
  if (h->in_use.enter(true)) return true;
  const char* name = name_of(Handle::kTag);
  log(h->hooks, LogLevel::kError,
      "rdm_%s_destroy: nothing was freed, as a call on the %s has not returned yet", name, name);
  return false;
}

}  // namespace rdm::capi
