#!/usr/bin/env bash
# A table of speeds: every hand on every arm, one in `grasp` and two in Jenga's scene without its tower, and the
# paper's pair there, under random actions, in steps per second of one core's time.
#   bash examples/pairs_table.sh
# Environment: REDMAN (the tool), HANDS, ARMS, SECONDS_EACH (of one measurement; 1).
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
hands=${HANDS:-shadow allegro svh barrett robotiq}
arms=${ARMS:-panda irb4600 jaco iiwa xarm crb15000 ur5e ur10e}
part=$(mktemp)
trap 'rm -f "$part"' EXIT

bench() {  # TASK KEY=VALUE...: rate and kB of a world
  local task=$1 set=()
  shift
  for pair in "$@"; do set+=(--set "$pair"); done
  "$redman" bench step --task "$task" --threads 0 --seconds "${SECONDS_EACH:-1}" --json "${set[@]}" > "$part"
  [ "$(value diverged "$part") $(value overflowed "$part")" = "0 0" ] || echo "$task $*: diverged or overflowed" >&2
  printf "%.0f | %.0f" "$(value steps_per_cpu_second "$part")" \
    "$(awk -v b="$(value bytes_per_env "$part")" 'BEGIN { print b / 1e3 }')"
}

echo "| hand | arm | \`grasp\`, control steps/s | memory per world, kB | two in \`jenga\`, \`tower=off\`, control steps/s | memory per world, kB |"
echo "|---|---|---|---|---|---|"
for hand in $hands; do
  for arm in $arms; do
    one=$(bench grasp "hand=$hand" "arm=$arm")
    two=$(bench jenga tower=off "hand=$hand" "arm=$arm")
    echo "| $hand | $arm | $one | $two |"
  done
done
echo "| the paper's pair | | | | $(bench jenga tower=off pair=paper) |"
