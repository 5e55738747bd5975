#!/usr/bin/env bash
# results/hand_tasks.md's table of tasks: what PPO-Lag and PPO learn on each of the paper's ten with the defaults, beside the
# floors (zero, hold, random) and the demonstration, 100 fresh episodes each. Finished runs are kept and stopped ones
# go on, so the script can be stopped and called again.
#   bash examples/task_table.sh [OUT]      OUT: folder of the runs, default runs/tasks
# It leaves OUT/curves.svg.
# Environment: REDMAN (the tool), TASKS, ALGOS ("ppo_lag ppo"), SEEDS ("0 1"), JOBS (runs at once, one thread each;
# 2), STEPS (control steps; else 1.5 to 12 million by task), SAMPLED (1: a row of each algorithm's policy with its
# noise too, below that of its mean action).
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
out=${1:-$root/runs/tasks}
tasks=${TASKS:-$paper_tasks}
algos=${ALGOS:-ppo_lag ppo} seeds=${SEEDS:-0 1}
mkdir -p "$out"

steps() {
  case $1 in
    jenga) echo 1500000 ;;
    catch_underarm*) echo 6000000 ;;
    hand_over_wall) echo 12000000 ;;
    pick_bottles | clean_house) echo 2000000 ;;
    *) echo 3000000 ;;
  esac
}

for task in $tasks; do
  wait_turn
  kept "$out/$task.floor.json" baseline --task "$task" --seed 1000000 &
  for algo in $algos; do for seed in $seeds; do
    wait_turn
    name=$task.$algo.$seed
    trained "$out/$name" --task "$task" --algo "$algo" --seed "$seed" --steps "${STEPS:-$(steps "$task")}" ||
      echo "$name failed: see $out/$name.log" >&2 &
  done; done
done
wait
if [ -n "${SAMPLED:-}" ]; then
  for task in $tasks; do for algo in $algos; do for seed in $seeds; do
    wait_turn
    sampled "$out/$task.$algo.$seed" "$seed" &
  done; done; done
  wait
fi

# One line per policy of a task's floor rows: POLICY RETURN COST
floor() {
  tr '{' '\n' < "$out/$1.floor.json" | sed -n 's/.*"policy":"\([a-z]*\)".*"return_mean":\([-+.0-9e]*\).*"cost_mean":\[\([-+.0-9e]*\).*/\1 \2 \3/p'
}

echo "| task (cost limit) | zero | hold | random | demonstration | algorithm | return, mean +- sd (each seed) | cost | control steps per episode | episodes that fall | success rate | control steps of training | training time, s |"
echo "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
# numbers FILE KIND: return, cost, length, falls, success, steps, seconds and limit of a run, or of its policy sampled
numbers() {
  [ -s "$1" ] || return 0
  case $2 in
    mean) keys='return cost length fall_rate success_rate env_steps wall_seconds cost_limit' ;;
    *) keys='return_mean cost_mean length_mean fall_rate success_rate - - cost_limits' ;;
  esac
  for key in $keys; do [ "$key" = - ] && printf '0 ' || printf '%s ' "$(value "$key" "$1")"; done
  echo
}

for task in $tasks; do
  floors=$(for policy in zero hold random demo; do
    floor "$task" | awk -v p="$policy" '$1 == p { printf ($2 < 1e3 ? "%.3g" : "%.0f") " @ %.3g | ", $2, $3 }'; done)
  head="\`$task\`"
  for algo in $algos; do for kind in mean ${SAMPLED:+sampled}; do
    name="\`$algo\`" ending=json
    [ "$kind" = mean ] || { name="$name, sampled" ending=sampled.json; }
    for seed in $seeds; do numbers "$out/$task.$algo.$seed.$ending" "$kind"; done |
      awk -v head="$head" -v floors="$floors" -v name="$name" "$marked$deviation"'
      function number(x) { return sprintf(x < 1e3 ? "%.3g" : "%.0f", x) }
      { for (k = 1; k <= 7; ++k) sum[k] += $k
        limit = $8
        each = each (NR > 1 ? ", " : "") number($1); costs = costs (NR > 1 ? ", " : "") marked($2, $8) }
      END { if (NR == 0) exit
        if (head != "") head = head " (" (limit ~ /^[0-9]/ ? limit + 0 : "-") ")"
        printf "| %s | %s%s | %s%s (%s) | %.3g%s (%s) | %.0f | %.0f %% | %.0f %% |", head, floors, name,
          number(sum[1] / NR), deviation(each), each, sum[2] / NR, deviation(costs), costs, sum[3] / NR, 100 * sum[4] / NR, 100 * sum[5] / NR
        if (sum[6] > 0) printf " %.2g M | %.0f |\n", sum[6] / NR / 1e6, sum[7] / NR; else print " | |" }'
    floors=" | | | | " head=""
  done; done
done
echo
echo "$over_note"
"$redman" plot "$out" --out "$out/curves.svg" > /dev/null
