// The processes of `train --ranks`: N, made by fork, or mpi, started by mpirun.
#pragma once
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <memory>
#include <string>

namespace tool {

class Ranks {
 public:
  // This process becomes N of them, and this returns in each. Usage for a wrong word, Failure where the
  // system refuses.
  static std::unique_ptr<Ranks> begin(const std::string& text);
  virtual ~Ranks() = default;

  const rdm_ranks& hooks() const { return hooks_; }
  int32_t count() const { return hooks_.ranks; }
  bool first() const { return hooks_.rank == 0; }
  // Whether one of them says so; all of them ask.
  bool any(bool mine) const;
  // At the end of each process. Of rank 0 it is whether all ended well, of others what exit() takes.
  virtual int end(int status) = 0;

 protected:
  rdm_ranks hooks_{};
};

}  // namespace tool
