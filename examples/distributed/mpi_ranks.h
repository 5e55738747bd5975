/* Processes that mpirun or srun has started learn together. */
#ifndef MPI_RANKS_H
#define MPI_RANKS_H
#include <redman/redman.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Before anything else of the process; hooks: its own. 0, or MPI's error. */
int mpi_ranks_begin(rdm_ranks *hooks);
/* status other than 0 ends all processes: one that is gone would be waited for. */
void mpi_ranks_end(int status);

#ifdef __cplusplus
}
#endif
#endif
