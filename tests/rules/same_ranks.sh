#!/bin/sh
# same_ranks.sh FORK [MPIEXEC MPI]: examples/distributed writes the same policy for 1, 2 and 4 processes; with the
# other two arguments those of MPI too.
fork=$1 mpiexec=${2:-} mpi=${3:-}
policy() {
  "$@" 16 3 two_state cpo 0 8 | sed -n 's/.*policy \([0-9a-f]*\) .*/\1/p'
}
one=$(policy "$fork" 1)
[ -n "$one" ] || { echo "one process printed no policy"; exit 1; }
failed=0
for ranks in 2 4; do
  got=$(policy "$fork" $ranks)
  [ "$got" = "$one" ] || { echo "$ranks processes: policy '$got', of one '$one'"; failed=1; }
  [ -n "$mpiexec" ] || continue
  OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
  export OMPI_ALLOW_RUN_AS_ROOT OMPI_ALLOW_RUN_AS_ROOT_CONFIRM OMPI_MCA_rmaps_base_oversubscribe
  got=$(policy "$mpiexec" -n $ranks "$mpi" 0)
  [ "$got" = "$one" ] || { echo "$ranks processes of MPI: policy '$got', of one '$one'"; failed=1; }
done
exit $failed
