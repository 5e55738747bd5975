#define RDM_EXPERIMENTAL
#include "mpi_ranks.h"

#include <mpi.h>
#include <string.h>

/* Messages of a learner are half a MiB at most, or a row's statistics: an int holds their sizes. */
static int32_t gather(void* user, const void* mine, size_t bytes, void* all) {
  (void)user;
  return MPI_Allgather(mine, (int)bytes, MPI_BYTE, all, (int)bytes, MPI_BYTE, MPI_COMM_WORLD);
}

static int32_t swap(void* user, int32_t partner, const void* mine, size_t bytes, void* theirs) {
  (void)user;
  return MPI_Sendrecv(mine, (int)bytes, MPI_BYTE, partner, 0, theirs, (int)bytes, MPI_BYTE, partner, 0,
                      MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

int mpi_ranks_begin(rdm_ranks* hooks) {
  int error, rank, ranks;
  if ((error = MPI_Init(NULL, NULL))) return error;
  if ((error = MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN))) return error;
  if ((error = MPI_Comm_rank(MPI_COMM_WORLD, &rank)) || (error = MPI_Comm_size(MPI_COMM_WORLD, &ranks)))
    return error;
  memset(hooks, 0, sizeof *hooks);
  hooks->struct_size = sizeof *hooks;
  hooks->rank = rank;
  hooks->ranks = ranks;
  hooks->gather = gather;
  hooks->swap = swap;
  return 0;
}

void mpi_ranks_end(int status) {
  if (status) MPI_Abort(MPI_COMM_WORLD, status);
  MPI_Finalize();
}
