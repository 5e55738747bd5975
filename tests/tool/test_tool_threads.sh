#!/bin/sh
# test_tool_threads.sh TOOL: the same seed gives the same bytes for any number of threads: rollouts with their
# state hash, and whole training runs.
. "$(dirname "$0")/tool.sh"
for threads in 0 1 2 4; do
  "$tool" rollout --policy random --episodes 6 --envs 4 --seed 5 --threads $threads --out $threads.csv --json \
    2> /dev/null | sed 's/"file":[^}]*//' > $threads.json
  "$tool" train --envs 6 --steps 2500 --threads $threads --set hidden=32,32 --eval-every 2 --out run-$threads \
    > /dev/null 2> err || { cat err; exit 1; }
  cut -d, -f1-30 run-$threads/progress.csv > $threads.curve
  cp run-$threads/policy.rdm $threads.policy
  for kind in csv json curve policy; do
    [ -s $threads.$kind ] || { echo "$threads threads: no $kind"; failed=1; }
    cmp -s 0.$kind $threads.$kind || { echo "$threads threads: another $kind than without threads"; failed=1; }
  done
done
"$tool" rollout --policy random --episodes 6 --envs 4 --seed 6 --json 2> /dev/null | grep -o '"hash":"[^"]*"' > other
grep -q "$(cat other)" 0.json && { echo "another seed gave the same hash"; failed=1; }
exit $failed
