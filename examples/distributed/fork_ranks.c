/* Each rank has two slots in the shared memory, which take turns: whoever is through one exchange may begin
 * the next while others still read. A barrier counts who has come; those that wait look every few
 * milliseconds whether all of them still live. */
#define _GNU_SOURCE
#define RDM_EXPERIMENTAL
#include "fork_ranks.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { SLOT = 1 << 20, SPINS = 200, FUTEX_WAIT_CALL = 0, FUTEX_WAKE_CALL = 1 };

typedef struct {
  atomic_uint arrived, round, gone; /* gone: a rank has left */
  pid_t parent;
} shared_head;

struct fork_ranks {
  shared_head* head;
  unsigned char* slots; /* [2][ranks][SLOT] */
  size_t bytes;
  int rank, ranks, turn;
  pid_t* child; /* [ranks], of rank 0; 0: it has ended */
  int failed;   /* one of them did not end well */
};

static void futex(atomic_uint* word, int call, unsigned value, const struct timespec* limit) {
  syscall(SYS_futex, word, call, value, limit, NULL, 0);
}

static void leave(shared_head* h) {
  atomic_store(&h->gone, 1u);
  atomic_fetch_add(&h->round, 0u);
  futex(&h->round, FUTEX_WAKE_CALL, 1u << 30, NULL);
}

/* Notices who has ended: rank 0 its children, they it. */
static void look_around(fork_ranks* f) {
  if (f->rank > 0) {
    if (getppid() != f->head->parent) leave(f->head);
    return;
  }
  for (int r = 1; r < f->ranks; ++r) {
    int status = 0;
    if (!f->child[r] || waitpid(f->child[r], &status, WNOHANG) != f->child[r]) continue;
    f->child[r] = 0;
    f->failed |= !WIFEXITED(status) || WEXITSTATUS(status) != 0;
    leave(f->head);
  }
}

static int meet(fork_ranks* f) {
  shared_head* h = f->head;
  const struct timespec limit = {0, 20 * 1000 * 1000};
  const unsigned round = atomic_load(&h->round);
  if (atomic_load(&h->gone)) return 1;
  if (atomic_fetch_add(&h->arrived, 1u) + 1 == (unsigned)f->ranks) {
    atomic_store(&h->arrived, 0u);
    atomic_fetch_add(&h->round, 1u);
    futex(&h->round, FUTEX_WAKE_CALL, 1u << 30, NULL);
    return 0;
  }
  for (int i = 0; i < SPINS; ++i)
    if (atomic_load(&h->round) != round) return 0;
  while (atomic_load(&h->round) == round) {
    if (atomic_load(&h->gone)) return 1;
    futex(&h->round, FUTEX_WAIT_CALL, round, &limit);
    if (atomic_load(&h->round) == round) look_around(f);
  }
  return 0;
}

static int32_t gather(void* user, const void* mine, size_t bytes, void* all) {
  fork_ranks* f = user;
  for (size_t at = 0; at < bytes; at += SLOT) {
    const size_t n = bytes - at < SLOT ? bytes - at : SLOT;
    unsigned char* slots = f->slots + (size_t)f->turn * (size_t)f->ranks * SLOT;
    memcpy(slots + (size_t)f->rank * SLOT, (const unsigned char*)mine + at, n);
    if (meet(f)) return 1;
    for (int r = 0; r < f->ranks; ++r)
      memcpy((unsigned char*)all + (size_t)r * bytes + at, slots + (size_t)r * SLOT, n);
    f->turn = !f->turn;
  }
  return 0;
}

static void let_go(fork_ranks* f) {
  if (f->head) munmap(f->head, f->bytes);
  free(f->child);
  free(f);
}

int fork_ranks_begin(fork_ranks** out, int ranks, rdm_ranks* hooks) {
  const size_t head = 4096;
  fork_ranks* f = calloc(1, sizeof *f);
  if (!f) return -1;
  f->ranks = ranks;
  f->bytes = head + 2 * (size_t)ranks * SLOT;
  f->child = calloc((size_t)ranks, sizeof *f->child);
  void* memory = mmap(NULL, f->bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (!f->child || memory == MAP_FAILED) {
    let_go(f);
    return -1;
  }
  f->head = memory;
  f->slots = (unsigned char*)memory + head;
  f->head->parent = getpid();
  for (int r = 1; r < ranks; ++r) {
    const pid_t pid = fork();
    if (pid == 0) {
      f->rank = r;
      break;
    }
    if (pid < 0) { /* those that are there hear of it in their first exchange */
      const int error = errno;
      fork_ranks_end(f, 1);
      errno = error;
      return -1;
    }
    f->child[r] = pid;
  }
  memset(hooks, 0, sizeof *hooks);
  hooks->struct_size = sizeof *hooks;
  hooks->rank = f->rank;
  hooks->ranks = ranks;
  hooks->user = f;
  hooks->gather = gather;
  *out = f;
  return 0;
}

int fork_ranks_end(fork_ranks* f, int status) {
  if (status) leave(f->head);
  for (int r = 1; f->rank == 0 && r < f->ranks; ++r) {
    int theirs = 0;
    if (!f->child[r]) continue;
    if (waitpid(f->child[r], &theirs, 0) != f->child[r] || !WIFEXITED(theirs) || WEXITSTATUS(theirs))
      f->failed = 1;
  }
  if (f->rank == 0 && f->failed && !status) status = 1;
  let_go(f);
  return status;
}
