#!/usr/bin/env bash
# results/speed.md's table of speeds: each of the paper's ten tasks under random actions, 64 worlds.
#   bash examples/speed_table.sh
# Environment: REDMAN (the tool), TASKS, SECONDS_EACH (of one measurement; 3). Other work on the machine shows.
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
tasks=${TASKS:-$paper_tasks}
part=$(mktemp)
trap 'rm -f "$part"' EXIT

bench() {  # TASK THREADS ENGINE
  "$redman" bench step --task "$1" --threads "$2" --set engine="$3" --seconds "${SECONDS_EACH:-3}" --json > "$part"
}

echo "| task | control steps/s, one core | two cores | \`engine=ode\`, one core | memory per world, kB | allocations per step | contact points, mean | largest number | worlds that diverged |"
echo "|---|---|---|---|---|---|---|---|---|"
for task in $tasks; do
  bench "$task" 0 ode
  ode=$(value steps_per_second "$part")
  bench "$task" 2 articulated
  two=$(value steps_per_second "$part")
  bench "$task" 0 articulated
  printf "| \`%s\` | %.0f | %.0f | %.0f | %.0f | %g | %.1f | %d | %d |\n" "$task" \
    "$(value steps_per_second "$part")" "$two" "$ode" "$(awk -v b="$(value bytes_per_env "$part")" 'BEGIN { print b / 1e3 }')" \
    "$(value allocations_per_step "$part")" "$(value contacts_mean "$part")" "$(value contacts_max "$part")" \
    "$(value diverged "$part")"
done
