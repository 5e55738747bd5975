#!/usr/bin/env bash
# results/planning.md's table of planning, measured again: each method on each task, with the same seed. Finished rows are kept, so
# the script can be stopped and called again.
#   bash examples/plan_table.sh [OUT]       OUT: folder of the results, default runs/plans
# Environment: REDMAN (the tool), TASKS, METHODS ("predictive cem mppi"), SIZES (samples x steps x knots: "64x32x5"),
# EPISODES (5), SEED (0), PLAN (other options of the planner, "noise=0.3 elites=16"), CRITIC (run folder: its critic values
# where a plan ends). The time of an action is processor time of one core, and holds beside other work.
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
out=${1:-$root/runs/plans}
tasks=${TASKS:-hand_over_safe_finger hand_over_safe_joint catch_underarm_safe_finger catch_underarm_safe_joint hand_over_wall
  pick_bottles}
mkdir -p "$out"

# planned NAME FLAG...: the figures of a row, and the processor time that it took.
planned() {
  local file=$out/$1.json TIMEFORMAT=%U
  shift
  [ -s "$file" ] || { time kept "$file" plan "$@"; } 2> "${file%.json}.seconds"
}

print_row() {
  local file=$out/$1.json seconds
  [ -s "$file" ] || return 0
  seconds=$(tail -n 1 "$out/$1.seconds")
  awk -v task="$2" -v method="$3" -v size="$4" -v episodes="$(value episodes "$file")" -v ret="$(value return_mean "$file")" \
    -v cost="$(value cost_mean "$file")" -v limit="$(value cost_limits "$file")" -v falls="$(value fall_rate "$file")" \
    -v success="$(value success_rate "$file")" -v length_mean="$(value length_mean "$file")" -v seconds="$seconds" "$marked"'BEGIN {
      printf "| `%s` (%s) | %s | %s | %d | %.3g | %s | %.0f %% | %.0f %% | %.0f |\n", task, limit, method, size, episodes,
        ret, marked(cost, limit), 100 * falls, 100 * success, 1000 * seconds / (episodes * length_mean) }'
}

echo "| task (cost limit) | method | samples x steps x knots | episodes | return | cost | episodes that fall | success rate | time per action, ms |"
echo "|---|---|---|---|---|---|---|---|---|"
for task in $tasks; do
  for size in ${SIZES:-64x32x5}; do
    IFS=x read -r samples steps knots <<< "$size"
    for method in ${METHODS:-predictive cem mppi}; do
      name=$task.$method.$size${PLAN:+.${PLAN// /,}}${CRITIC:+.critic}
      flags="--task $task --method $method --samples $samples --horizon $steps --plan knots=$knots --episodes ${EPISODES:-5}"
      for option in ${PLAN:-}; do flags+=" --plan $option"; done
      # shellcheck disable=SC2086
      planned "$name" $flags ${CRITIC:+--critic "$CRITIC"} --seed "${SEED:-0}" --threads 1
      print_row "$name" "$task" "$method${PLAN:+, $PLAN}${CRITIC:+, critic}" "$size"
    done
  done
done
echo "$over_note"
