#!/usr/bin/env bash
# Wall time to success of each of the paper's tasks, on all cores of this machine, one run after the other: trained from
# scratch with the task's defaults, or from its demonstration where reward alone leads nowhere.
#   bash examples/success_time.sh [OUT]   OUT: folder of the runs, default runs/success
# It prints a Markdown table: seconds of learning until half of an epoch's episodes succeed, noise and all; of the whole
# command (demonstration, clone, evaluations, 100 fresh episodes at the end); what its policy does in those. Finished runs
# are kept, so the script can be stopped and called again. Reorient takes its own: examples/reorient_table.sh.
# Environment: REDMAN (the tool), TASKS (those of the list that are wanted), SEED (0). Other work on the machine shows.
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
out=${1:-$root/runs/success} seed=${SEED:-0}
mkdir -p "$out"

# flags TASK: how it is learned here
flags() {
  case $1 in
    hand_over_wall) echo "--algo trpo_lag --steps 36000000" ;;
    hand_over_*) echo "--steps 3000000" ;;
    catch_*) echo "--steps 6000000" ;;
    grasp) echo "--steps 1500000" ;;
    jenga) echo "--from demo --steps 1000000" ;;
    pick_bottles) echo "--from demo --steps 4000000" ;;
    clean_house) echo "--from demo --steps 800000" ;;
  esac
}

echo "| task (cost limit) | \`redman train --task TASK ...\` | until half succeed, s | whole command, s | return @ cost | success rate |"
echo "|---|---|---|---|---|---|"
for task in $paper_tasks; do
  case " ${TASKS:-$task} " in *" $task "*) ;; *) continue ;; esac
  how=$(flags "$task")
  [ -n "$how" ] || continue
  started=$SECONDS run=$out/$task.$seed
  # shellcheck disable=SC2086
  [ -s "$run.json" ] || { trained "$run" --task "$task" $how --seed "$seed" --threads "$(nproc)" --no-tensorboard &&
    echo $((SECONDS - started)) > "$run.seconds"; } || { echo "$task failed: see $run.log" >&2; continue; }
  printf '| `%s` (%g) | `%s` | %s | %s | %.4g @ %.3g | %.0f %% |\n' "$task" "$(value cost_limit "$run.json")" "$how" \
    "$(reached "$run/progress.csv")" "$(cat "$run.seconds")" "$(value return "$run.json")" "$(value cost "$run.json")" \
    "$(awk -v s="$(value success_rate "$run.json")" 'BEGIN { print 100 * s }')"
done
