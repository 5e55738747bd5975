// Work of an update that can be left between two of its units and gone on with later: a sweep over rows, whose
// chunks and whose order of additions do not depend on where it is left. An update is a sequence of them with
// short work in between (agent_update.cpp).
#pragma once

namespace rdm {

class Job {
 public:
  Job() = default;
  // Goes on by a call of F of `self`, which says whether it is done.
  template <auto F, class T>
  static Job of(T* self) {
    Job j;
    j.self_ = self;
    j.advance_ = [](void* s, bool whole) { return (static_cast<T*>(s)->*F)(whole); };
    return j;
  }
  explicit operator bool() const { return self_ != nullptr; }
  // One unit: a network forth and back over the chunks in flight; with `whole` all networks over them. True
  // when that was the last one.
  bool advance(bool whole) { return advance_(self_, whole); }
  void finish() {
    while (self_ && !advance(true)) {
    }
  }

 private:
  void* self_ = nullptr;
  bool (*advance_)(void* self, bool whole) = nullptr;
};

}  // namespace rdm
