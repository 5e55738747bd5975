// ODE's process-wide state, kept safe: initialisation, per-thread data, its handlers for errors and memory.
//
// ODE ends the process after an error handler returns, and uses what its memory handler gives it without a
// look. So both of ours throw while this thread is in an OdeScope: Error(kPhysics) for a complaint,
// Error(kMemory) for memory that was refused. Elsewhere a host's own handlers go on working: ours pass on.
//
// What ODE's constructors had made when one throws they take back themselves. Its solver does not: jobs and
// working memory are lost to it. There the scope writes down each block in an OdeBlocks, which frees what is
// left. Everywhere else nobody does: an ODE with atomic operations hands the pose of a geom that went to the
// next geom of any thread, so that blocks change their owner.
#pragma once
#include <cstddef>
#include <vector>

namespace rdm {

// Held by every world. The first one initialises ODE (which then stays initialised: a host may use it
// too) and takes the handlers; the last one puts the host's back.
// Error(kVersion) when the ODE found at run time is not the double-precision build, Error(kMemory).
class OdeGuard {
 public:
  OdeGuard();
  ~OdeGuard();
  OdeGuard(const OdeGuard&) = delete;
  OdeGuard& operator=(const OdeGuard&) = delete;
};

// Blocks that ODE has taken and not yet given back, by what they were taken for. Used by one thread at a
// time; goes after all that uses them and before the last OdeGuard.
class OdeBlocks {
 public:
  OdeBlocks() = default;
  ~OdeBlocks();
  OdeBlocks(const OdeBlocks&) = delete;
  OdeBlocks& operator=(const OdeBlocks&) = delete;

  void add(void* block, size_t bytes, const void* purpose);
  void replace(const void* block, void* by, size_t bytes);
  void remove(const void* block);
  void give_purpose(const void* block, const void* purpose);
  // Frees all blocks of one purpose, which no object may use any more.
  void release(const void* purpose);

 private:
  struct Entry {
    void* block;
    size_t bytes;
    const void* purpose;
  };
  Entry* find(const void* block);
  std::vector<Entry> entries_;
};

// Around every stretch of ODE calls: ODE has this thread's data, its complaints and refused memory are thrown
// as Error, mere messages are dropped. With `blocks`, what ODE gives back is struck off there, and what it
// takes is written down if there is a purpose; without, as in the scope around this one.
class OdeScope {
 public:
  explicit OdeScope(OdeBlocks* blocks = nullptr, const void* purpose = nullptr);
  ~OdeScope();
  OdeScope(const OdeScope&) = delete;
  OdeScope& operator=(const OdeScope&) = delete;

  OdeBlocks* blocks() const { return blocks_; }
  const void* purpose() const { return purpose_; }

 private:
  OdeScope* outer_;
  OdeBlocks* blocks_ = nullptr;
  const void* purpose_ = nullptr;
};

// What ODE's memory handlers do: the host's, or the C library's. For memory that ODE asks for by other ways.
void* ode_alloc(size_t bytes, const void* purpose);
void ode_free(void* block, size_t bytes);
OdeBlocks* ode_blocks();  // of the scope, may be null

}  // namespace rdm
