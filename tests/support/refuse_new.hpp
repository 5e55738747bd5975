// Refuses memory to operator new of the test program and counts the blocks that live, by standing in its
// place. Include it in one source of a test.
#pragma once
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>

inline std::atomic<int64_t> new_live{0};   // blocks
inline std::atomic<int64_t> new_left{-1};  // calls until the first refused one; below 0: none is refused
inline std::atomic<bool> new_once{true};   // refuses one call; otherwise all that follow too

// While it lives, operator new number `at` (from 0) from now on throws, and with `once` false all after it.
struct RefuseNew {
  explicit RefuseNew(int64_t at, bool once = true) {
    new_once = once;
    new_left = at + 1;
  }
  ~RefuseNew() { new_left = -1; }
  // Whether there were so many calls.
  bool happened() const { return new_left.load() <= 0; }
};

inline void* take_new(size_t size, size_t align) {
  if (new_left.load() > 0 && --new_left == 0) throw std::bad_alloc();
  if (new_left.load() == 0 && !new_once) throw std::bad_alloc();
  void* p = align > __STDCPP_DEFAULT_NEW_ALIGNMENT__
                ? std::aligned_alloc(align, (size + align - 1) / align * align)
                : std::malloc(size ? size : 1);
  if (!p) throw std::bad_alloc();
  ++new_live;
  return p;
}
inline void give_back(void* p) noexcept {
  if (p) --new_live;
  std::free(p);
}

void* operator new(size_t size) {
  return take_new(size, 1);
}
void* operator new(size_t size, std::align_val_t align) {
  return take_new(size, static_cast<size_t>(align));
}
void operator delete(void* p) noexcept {
  give_back(p);
}
void operator delete(void* p, size_t) noexcept {
  give_back(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  give_back(p);
}
void operator delete(void* p, size_t, std::align_val_t) noexcept {
  give_back(p);
}
// Arrays too: a sanitizer's own would not come here.
void* operator new[](size_t size) {
  return take_new(size, 1);
}
void* operator new[](size_t size, std::align_val_t align) {
  return take_new(size, static_cast<size_t>(align));
}
void operator delete[](void* p) noexcept {
  give_back(p);
}
void operator delete[](void* p, size_t) noexcept {
  give_back(p);
}
void operator delete[](void* p, std::align_val_t) noexcept {
  give_back(p);
}
void operator delete[](void* p, size_t, std::align_val_t) noexcept {
  give_back(p);
}
