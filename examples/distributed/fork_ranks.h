/* Processes of one machine that learn together: fork, and messages through memory that they share. */
#ifndef FORK_RANKS_H
#define FORK_RANKS_H
#include <redman/redman.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fork_ranks fork_ranks; /* one in each process */

/* This process becomes `ranks` of them, and returns in each; hooks: the rank's. It must have no other threads, and its
 * buffers of stdout and stderr should be empty. 0, or -1 with errno where the system refuses: then there is one. */
int fork_ranks_begin(fork_ranks **out, int ranks, rdm_ranks *hooks);
/* At the end of each process; status: its own, 0 is good. In rank 0 the others' ends are waited for: 0 when all were good.
 * In others the status comes back, for exit(). */
int fork_ranks_end(fork_ranks *f, int status);

#ifdef __cplusplus
}
#endif
#endif
