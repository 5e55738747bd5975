#include "run/ranks.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "../../distributed/fork_ranks.h"
#include "common/numbers.hpp"
#include "common/report.hpp"
#include "common/text.hpp"
#if REDMAN_MPI
#include "../../distributed/mpi_ranks.h"
#endif

namespace tool {
namespace {

constexpr long kMostForked = 256;

#if defined(__linux__)
class Forked final : public Ranks {
 public:
  explicit Forked(int ranks) {
    std::fflush(nullptr);
    if (fork_ranks_begin(&processes_, ranks, &hooks_) != 0)
      throw Failure(std::string("--ranks: the system reports: ") + std::strerror(errno));
  }
  int end(int status) override { return fork_ranks_end(processes_, status); }

 private:
  fork_ranks* processes_ = nullptr;
};
#endif

#if REDMAN_MPI
class Mpi final : public Ranks {
 public:
  Mpi() {
    if (const int error = mpi_ranks_begin(&hooks_))
      throw Failure("--ranks mpi: MPI reports error " + std::to_string(error));
  }
  int end(int status) override {
    mpi_ranks_end(status);
    return status;
  }
};
#endif

}  // namespace

std::unique_ptr<Ranks> Ranks::begin(const std::string& text) {
  if (text == "mpi") {
#if REDMAN_MPI
    return std::make_unique<Mpi>();
#else
    throw Usage("--ranks mpi: this tool was built without MPI (cmake -DREDMAN_MPI=ON)");
#endif
  }
  int64_t ranks = 0;
  if (!read_whole(text, &ranks) || ranks < 1 || ranks > kMostForked)
    throw Usage("--ranks " + printable(text) + ": it is neither a number from 1 to 256 nor mpi");
#if defined(__linux__)
  return std::make_unique<Forked>(static_cast<int>(ranks));
#else
  throw Usage("--ranks N works on Linux only; use --ranks mpi elsewhere");
#endif
}

bool Ranks::any(bool mine) const {
  if (count() == 1) return mine;
  const char own = mine;
  std::vector<char> all(static_cast<size_t>(count()));
  if (hooks_.gather(hooks_.user, &own, sizeof own, all.data()) != 0) throw Failure("another rank has ended");
  return std::any_of(all.begin(), all.end(), [](char c) { return c != 0; });
}

}  // namespace tool
