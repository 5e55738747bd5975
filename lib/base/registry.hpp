// Things of a kind by number and by name: the library's own, which stand first, and deep copies of those that a host adds.
//
// Any number of threads may look while others add and remove. Numbers: numbered.hpp. A Kind says what they are:
//   using Thing = ...; using Copy = ...;        // Copy(thing) owns what it shows
//   static constexpr const char* kNoun;         // in texts
//   static constexpr int kRounds;               // of names: what is called so in an earlier one goes before
//   static int32_t num_own();
//   static const Thing& own(int32_t index);
//   static const Thing& shown(const Copy& copy);
//   static bool called(const Thing& thing, const char* name, int round);
//   static void check(const Thing& thing);      // Error for what cannot be added
#pragma once
#include <mutex>
#include <utility>

#include "base/error.hpp"
#include "base/host.hpp"
#include "base/names.hpp"
#include "base/numbered.hpp"
#include "base/option.hpp"
#include "base/text.hpp"

namespace rdm {

template <class Kind>
class Registry {
 public:
  using Thing = typename Kind::Thing;
  using Copy = typename Kind::Copy;

  static Registry& get() {
    static auto* const list = new Registry;  // never ended: a pool may outlive all statics
    return *list;
  }

  // One behind the last number that is listed.
  int32_t count() {
    const std::lock_guard<std::mutex> hold(lock_);
    return added_.count();
  }

  // Error(kNotFound) with the nearest.
  int32_t find(const char* name) {
    if (!name) fail(Code::kArgument, "%s: its name is NULL", Kind::kNoun);
    const std::lock_guard<std::mutex> hold(lock_);
    const int32_t i = number_of(name);
    if (i >= 0) return i;
    Vector<const char*> names;
    any_listed([&](const Thing& t, int32_t) {
      names.push_back(t.name);
      if (t.alias) names.push_back(t.alias);
      return false;
    });
    fail(Code::kNotFound, "%s %s: unknown%s", Kind::kNoun, Quoted(name).text,
         Nearest(name, names.data(), static_cast<int32_t>(names.size())).text);
  }

  // Error(kArgument) for a name that is taken, and what Kind::check throws.
  int32_t add(const Thing& thing) {
    Kind::check(thing);
    const HostHooks hooks = host();
    Copy* copy = host_new<Copy>(hooks, thing);
    try {
      const std::lock_guard<std::mutex> hold(lock_);
      for (const char* name : {thing.name, thing.alias})
        if (name && number_of(name) >= 0)
          fail(Code::kArgument, "%s %s: the name is already used", Kind::kNoun, Quoted(name).text);
      return added_.add({copy, hooks});
    } catch (...) {
      host_delete(hooks, copy);
      throw;
    }
  }

  // Whoever holds a reference keeps it. Error(kArgument) for one of the library's own.
  void remove(int32_t index) {
    {
      const std::lock_guard<std::mutex> hold(lock_);
      added_.need(index);
      if (index < Kind::num_own())
        fail(Code::kArgument, "%s %s belongs to the library", Kind::kNoun, Kind::own(index).name);
      added_.listed(index).listed = false;
    }
    release(index);
  }

  // A reference more, but to the library's own, which are not counted: *counted says whether it was.
  const Thing& take(int32_t index, bool* counted) {
    const std::lock_guard<std::mutex> hold(lock_);
    added_.need(index);
    *counted = index >= Kind::num_own();
    if (!*counted) return Kind::own(index);
    auto& row = added_.listed(index);
    ++row.users;
    return Kind::shown(*row.what.copy);
  }
  void release(int32_t index) {
    Added last;
    {
      const std::lock_guard<std::mutex> hold(lock_);
      if (!added_.release(index, &last)) return;
    }
    host_delete(last.hooks, last.copy);
  }

 private:
  struct Added {
    Copy* copy = nullptr;
    HostHooks hooks;
  };

  Registry() : added_(Kind::kNoun, Kind::num_own()) {}

  // Calls f(thing, number) for all that are listed, until it returns true.
  template <class F>
  bool any_listed(F&& f) {
    for (int32_t i = 0; i < Kind::num_own(); ++i)
      if (f(Kind::own(i), i)) return true;
    for (const auto& row : added_)
      if (row.listed && f(Kind::shown(*row.what.copy), row.number)) return true;
    return false;
  }
  // Under the lock; -1: none.
  int32_t number_of(const char* name) {
    int32_t found = -1;
    for (int round = 0; round < Kind::kRounds && found < 0; ++round)
      any_listed(
          [&](const Thing& t, int32_t i) { return Kind::called(t, name, round) && (found = i, true); });
    return found;
  }

  std::mutex lock_;
  Numbered<Added> added_;  // numbered behind our own
};

// While it lives, the thing stays.
template <class Kind>
class Ref {
 public:
  using Thing = typename Kind::Thing;
  Ref() = default;
  // Error(kRange); Error(kNotFound): it was destroyed
  explicit Ref(int32_t index) {
    bool counted = false;
    thing_ = &Registry<Kind>::get().take(index, &counted);
    if (counted) index_ = index;
  }
  Ref(const Ref&) = delete;
  Ref& operator=(const Ref&) = delete;
  Ref(Ref&& other) noexcept
      : index_(std::exchange(other.index_, -1)), thing_(std::exchange(other.thing_, nullptr)) {}
  Ref& operator=(Ref&& other) noexcept {
    std::swap(index_, other.index_);
    std::swap(thing_, other.thing_);
    return *this;
  }
  ~Ref() {
    if (index_ >= 0) Registry<Kind>::get().release(index_);
  }
  const Thing& operator*() const { return *thing_; }
  const Thing* operator->() const { return thing_; }

 private:
  int32_t index_ = -1;  // of an added one
  const Thing* thing_ = nullptr;
};

}  // namespace rdm
