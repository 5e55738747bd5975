#!/bin/sh
# test_tool_ranks.sh TOOL: `train --ranks N` ends in the same bytes for 1, 2 and 4 processes (Time/* columns apart),
# also when it goes on with another number; one that is killed ends the run, whose checkpoint another number takes up.
. "$(dirname "$0")/tool.sh"
flags='--task two_state --envs 16 --set hidden=16,16 --set horizon=8 --eval-every 4 --checkpoint-every 3 --no-tensorboard'

for algo in ppo_lag cpo; do
  for ranks in 1 2 4; do
    # shellcheck disable=SC2086
    "$tool" train $flags --algo $algo --steps 4000 --ranks $ranks --out $algo-$ranks > /dev/null 2> err || { cat err; exit 1; }
    same $algo-1 $algo-$ranks "$ranks ranks"
  done
done
[ "$(wc -l < ppo_lag-1/progress.csv)" -gt 20 ] || { echo "the run is too short to be broken"; failed=1; }
# Without ranks there is one block of worlds, unless it is asked for.
# shellcheck disable=SC2086
"$tool" train $flags --set blocks=4 --steps 4000 --out alone > /dev/null 2>&1
same ppo_lag-1 alone 'one process'

# With threads, and from demonstrations.
# shellcheck disable=SC2086
"$tool" train $flags --steps 4000 --ranks 2 --threads 2 --out threads > /dev/null 2>&1
same ppo_lag-1 threads 'threads'

# Half of it by two, the rest by four, then by one.
# shellcheck disable=SC2086
"$tool" train $flags --set total_epochs=32 --steps 4000 --ranks 1 --out whole > /dev/null 2>&1
# shellcheck disable=SC2086
"$tool" train $flags --set total_epochs=32 --steps 1500 --ranks 2 --out parts > /dev/null 2>&1
"$tool" train --resume parts --steps 3000 --ranks 4 > /dev/null 2> err || { echo "resume failed: $(cat err)"; failed=1; }
"$tool" train --resume parts --steps 4000 > /dev/null 2> err || { echo "resume failed: $(cat err)"; failed=1; }
curve whole > a
curve parts > b
cmp -s a b || { echo "a run by 2, 4 and 1 ranks differs"; failed=1; }

# One of four is killed: the run ends with an error, says how to go on, and leaves nobody behind.
killed() { # which: first or another
  rm -rf broken
  # shellcheck disable=SC2086
  "$tool" train $flags --set total_epochs=4000 --steps 400000 --ranks 4 --out broken > /dev/null 2> err &
  pid=$!
  while kill -0 $pid 2> /dev/null && { [ ! -f broken/progress.csv ] || [ "$(wc -l < broken/progress.csv)" -lt 9 ]; }; do
    sleep 0.01
  done
  others=$(ps -o pid= --ppid $pid)
  [ "$(echo "$others" | wc -w)" -eq 3 ] || { echo "there are not three others: $others"; failed=1; }
  # shellcheck disable=SC2086
  if [ "$1" = first ]; then kill -9 $pid; else kill -9 ${others##* }; fi
  wait $pid 2> /dev/null
  status=$?
  [ $status -ne 0 ] || { echo "with the $1 killed the exit status is 0"; failed=1; }
  for i in 1 2 3 4 5 6 7 8 9 10; do
    left=0
    for other in $others; do
      [ -d "/proc/$other" ] && ! grep -q '^State:.*Z' "/proc/$other/status" 2> /dev/null && left=1
    done
    [ $left -eq 0 ] && break
    sleep 0.2
  done
  [ $left -eq 0 ] || { echo "processes are left behind"; failed=1; }
}
killed another
grep -q 'continue with train --resume broken' err || { echo "no word of how to go on: $(cat err)"; failed=1; }
killed first
rows=$(wc -l < broken/progress.csv)
steps=$(((rows + 40) * 128))
"$tool" train --resume broken --steps $steps --ranks 2 > /dev/null 2> err || { echo "resume failed: $(cat err)"; failed=1; }
# shellcheck disable=SC2086
"$tool" train $flags --set total_epochs=4000 --steps 400000 --ranks 4 --out unbroken > /dev/null 2> err &
pid=$!
while kill -0 $pid 2> /dev/null && { [ ! -f unbroken/progress.csv ] || [ "$(wc -l < unbroken/progress.csv)" -le $((rows + 20)) ]; }; do
  sleep 0.01
done
kill -INT $pid
wait $pid || { echo "after SIGINT to the first the exit status is $?"; failed=1; }
curve broken | head -n $((rows + 10)) > a
curve unbroken | head -n $((rows + 10)) > b
cmp -s a b || { echo "a run whose rank died differs from an unbroken one"; failed=1; }

refused() {
  text=$1
  shift
  "$tool" train --task two_state "$@" --out refused > /dev/null 2> err && { echo "not refused: $*"; failed=1; }
  grep -q -- "$text" err || { echo "no '$text' for $*: $(cat err)"; failed=1; }
}
refused 'neither a number from 1 to 256 nor mpi' --ranks none
refused 'neither a number from 1 to 256 nor mpi' --ranks 0
refused '3 does not divide the number of worlds, 16' --ranks 3 --envs 16
refused 'sac learns in one process' --ranks 2 --algo sac
refused 'is not the number of ranks, 4, times a power of two' --ranks 4 --envs 6000 --set blocks=6
exit $failed
