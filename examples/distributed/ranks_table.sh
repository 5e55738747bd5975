#!/bin/sh
# The tables of README.md: bash examples/distributed/ranks_table.sh [build folder] [worlds of the first] [epochs] [rounds]
# Ranks beside threads on this machine, round by round in turn and the best of each, since other programs come and go;
# then what networks would cost (simulate.c), of which processor time is counted alone.
set -eu
bin=${1:-build/release}/bin worlds=${2:-256} epochs=${3:-4} rounds=${4:-5}
task=hand_over_safe_finger

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cores=$(nproc)
for round in $(seq "$rounds"); do
  for way in '1 0' '2 0' '4 0' '1 2' '1 4'; do
    # shellcheck disable=SC2086
    set -- $way
    "$bin/distributed_fork" "$1" "$worlds" "$epochs" $task ppo_lag "$2" 16 | tail -1 >> "$work/$1-$2"
  done
done
echo "## $cores cores, $worlds worlds of $task, ppo_lag, $epochs epochs, best of $rounds"
awk -v cores="$cores" '
  { way = $2 " " $4; rate = $(NF - 1); if (rate > best[way]) best[way] = rate; hash[$8] = 1; if (!(way in seen)) order[++n] = way; seen[way] = 1 }
  END {
    print "| ranks | threads | steps/s | over one | efficiency |\n|---|---|---|---|---|"
    for (i = 1; i <= n; ++i) {
      split(order[i], w, " ")
      units = w[1] > 1 ? w[1] : w[2] > 1 ? w[2] : 1
      used = units < cores ? units : cores
      printf "| %d | %d | %d | %.2f | %.2f |\n", w[1], w[2], best[order[i]], best[order[i]] / best["1 0"], best[order[i]] / best["1 0"] / used
    }
    kinds = 0
    for (h in hash) ++kinds
    print "policies: " kinds " (1: all the same)"
  }' "$work/1-0" "$work/2-0" "$work/4-0" "$work/1-2" "$work/1-4"

for each in "64 8" "256 5" "1024 3" "4096 2"; do
  # shellcheck disable=SC2086
  "$bin/distributed_simulate" $each $task ppo_lag 256
done
