#!/bin/sh
# The tables of README.md: bash examples/distributed/ranks_table.sh [build folder] [worlds of the first] [epochs] [rounds]
# Ranks beside threads on this machine, round by round in turn and the best of each, since other programs come and go:
# by the clock, and for ranks by the processor's time of one over that of the busiest of several; then what networks would
# cost (simulate.c), of which processor time is counted alone.
set -eu
bin=${1:-build/release}/bin worlds=${2:-256} epochs=${3:-4} rounds=${4:-5}
task=hand_over_safe_finger

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for round in $(seq "$rounds"); do
  for way in '1 0' '2 0' '4 0' '1 2' '1 4'; do
    # shellcheck disable=SC2086
    set -- $way
    "$bin/distributed_fork" "$1" "$worlds" "$epochs" $task ppo_lag "$2" 16 | tail -1 >> "$work/$1-$2"
  done
done
echo "## $(nproc) cores, $worlds worlds of $task, ppo_lag, $epochs epochs, best of $rounds"
awk '
  { way = $2 " " $4; if ($9 > best[way]) best[way] = $9; if (!(way in busy) || $11 < busy[way]) busy[way] = $11; policy[$8] = 1 }
  END {
    print "| ranks | threads | control steps/s | speed-up | processor time of the busiest rank, s | efficiency of ranks |\n|---|---|---|---|---|---|"
    n = split("1 0,2 0,4 0,1 2,1 4", ways, ",")
    for (i = 1; i <= n; ++i) {
      split(ways[i], w, " ")
      share = w[2] ? "" : sprintf("%.2f", busy["1 0"] / busy[ways[i]] / w[1])
      printf "| %d | %d | %d | %.2f | %.3f | %s |\n", w[1], w[2], best[ways[i]], best[ways[i]] / best["1 0"], busy[ways[i]], share
    }
    for (p in policy) ++kinds
    print "policies: " kinds " (1: all the same)"
  }' "$work"/*

for each in "64 8" "256 5" "1024 3" "4096 2"; do
  # shellcheck disable=SC2086
  "$bin/distributed_simulate" $each $task ppo_lag 256
done
