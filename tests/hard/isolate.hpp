// Runs many small experiments in child processes, so that one that dies is a count and not the end.
#pragma once
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <functional>
#include <new>

#include "worlds.hpp"

namespace hard {

inline double now() {
  using clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(clock::now().time_since_epoch()).count();
}

enum class Outcome { kGood, kOther, kBad, kEnd };  // kOther: good in another way; kEnd: no such experiment

// Lives in memory that parent and children share.
struct Tally {
  long at = 0;  // the experiment that runs now
  long good = 0, other = 0, bad = 0, crashed = 0, skipped = 0;
  bool ended = false;
  char note[512] = "";  // the first thing that went wrong

  long run() const { return good + other + bad + crashed; }
  long failed() const { return bad + crashed; }
  void remember(const char* format, ...) {
    if (*note) return;
    va_list list;
    va_start(list, format);
    std::vsnprintf(note, sizeof note, format, list);
    va_end(list);
  }
};

inline Tally* running = nullptr;  // of the child that runs

using Experiment = std::function<Outcome(long k, Tally& tally)>;

// Runs make()(k) for k = first, first + stride, ... below `last`, or until one says kEnd or `seconds` have
// gone by (0: no bound). make() is called in each child. One experiment may take `patience` seconds.
inline Tally isolate(long first, long last, long stride, double seconds, unsigned patience,
                     const std::function<Experiment()>& make) {
  void* memory = mmap(nullptr, sizeof(Tally), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  auto* shared = new (memory) Tally;
  shared->at = first;
  const double end = seconds > 0 ? now() + seconds : 1e300;
  while (!shared->ended && shared->at < last) {
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) {
      running = shared;
      on_broken = [](const char* text) { running->remember("%s", text); };
      alarm(patience);
      const Experiment experiment = make();
      for (; shared->at < last; shared->at += stride) {
        if (now() > end) break;
        alarm(patience);
        const Outcome outcome = experiment(shared->at, *shared);
        if (outcome == Outcome::kEnd) break;
        (outcome == Outcome::kGood    ? shared->good
         : outcome == Outcome::kOther ? shared->other
                                      : shared->bad) += 1;
      }
      shared->ended = true;
      alarm(0);
      std::fflush(nullptr);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (shared->ended) break;
    shared->crashed += 1;
    shared->remember("experiment %ld ended the process: %s %d", shared->at,
                     WIFSIGNALED(status) ? "signal" : "exit code",
                     WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
    shared->at += stride;
    if (shared->crashed > 10000) break;
  }
  const Tally out = *shared;
  munmap(memory, sizeof(Tally));
  return out;
}

}  // namespace hard
