#!/usr/bin/env bash
# results/hand_over.md's learning table, measured again: every row is trained from scratch with the defaults, for several
# seeds, and evaluated on 100 fresh episodes. Finished runs are kept, so the script can be stopped and called again.
#   bash examples/learning_table.sh [OUT]      OUT: folder of the runs, default runs/table
# Environment: REDMAN (the tool), SEEDS ("0 1 2"), JOBS (runs at once, one thread each; 2), STEPS and PPO_STEPS
# (control steps of the safe and the plain runs; 7 million for the egg and 3 for the ball, and 2), TASKS, OBJECTS,
# LIMITS (cost limits; the paper's of each task), SAMPLED (1: a row of each algorithm's policy with its noise too).
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
out=${1:-$root/runs/table}
seeds=${SEEDS:-0 1 2} ppo_steps=${PPO_STEPS:-2000000}
tasks=${TASKS:-hand_over_safe_finger hand_over_safe_joint} objects=${OBJECTS:-egg ball}
algos=${ALGOS:-ppo_lag ppo}
mkdir -p "$out"

# Limit of the paper's table for a task.
paper_limit() { case $1 in *finger) echo 40 ;; *) echo 30 ;; esac; }

# Control steps of a safe run with an object: the egg is harder to catch.
safe_steps() { case $1 in egg) echo "${STEPS:-7000000}" ;; *) echo "${STEPS:-3000000}" ;; esac; }

rows() {  # one line per run: KIND NAME TASK OBJECT POLICY-OR-ALGO LIMIT SEED STEPS
  for object in $objects; do for task in $tasks; do
    for policy in zero hold random; do
      echo "baseline $task.$object.$policy $task $object $policy - 0 0"
    done
    for algo in $algos; do
      case $algo in ppo | trpo) n=$ppo_steps ;; *) n=$(safe_steps "$object") ;; esac
      for limit in ${LIMITS:-$(paper_limit "$task")}; do for seed in $seeds; do
        echo "train $task.$object.$algo$limit.$seed $task $object $algo $limit $seed $n"
        [ -z "${SAMPLED:-}" ] || echo "sampled $task.$object.$algo$limit.$seed $task $object $algo-sampled $limit $seed 0"
      done; done
    done
  done; done
}

rows | {
  while read -r kind name task object policy limit seed n; do
    wait_turn
    if [ "$kind" = train ]; then
      trained "$out/$name" --task "$task" --algo "$policy" --cost-limit "$limit" --seed "$seed" --steps "$n" \
        --set object="$object" &
    elif [ "$kind" = baseline ]; then
      kept "$out/$name.json" rollout --task "$task" --policy "$policy" --set object="$object" --episodes 500 \
        --seed 1000000 &
    fi
  done
  wait
}
rows | {
  while read -r kind name _ _ _ _ seed _; do
    [ "$kind" = sampled ] || continue
    wait_turn
    sampled "$out/$name" "$seed" &
  done
  wait
}

echo "| task | object | policy | cost limit | return | cost | control steps per episode | episodes that fall | caught | control steps of training | training time, s |"
echo "|---|---|---|---|---|---|---|---|---|---|---|"
rows | while read -r kind name task object policy limit seed n; do
  f=$out/$name.json
  [ "$kind" != sampled ] || f=$out/$name.sampled.json
  [ -s "$f" ] || continue
  if [ "$kind" = train ]; then r=return c=cost l=length; else r=return_mean c=cost_mean l=length_mean; fi
  echo "$task $object $policy $limit $(value $r "$f") $(value $c "$f") $(value $l "$f") $(value fall_rate "$f")" \
    "$(value success_rate "$f") $([ "$kind" = train ] && value env_steps "$f" || echo 0)" \
    "$([ "$kind" = train ] && value wall_seconds "$f" || echo 0)"
done | awk "$marked$deviation"'{ key = $1 " | " $2 " | " $3 " | " $4
  if (!(key in n)) order[++count] = key
  i = ++n[key]; for (k = 5; k <= 11; ++k) { sum[key, k] += $k }
  each[key] = each[key] (i > 1 ? ", " : "") sprintf("%.1f", $5); costs[key] = costs[key] (i > 1 ? ", " : "") marked($6, $4) }
  END { for (j = 1; j <= count; ++j) { k = order[j]; m = n[k]
    printf "| %s | %.1f", k, sum[k, 5] / m; if (m > 1) printf "%s (%s)", deviation(each[k]), each[k]
    printf " | %s", (m > 1 ? sprintf("%.1f%s (%s)", sum[k, 6] / m, deviation(costs[k]), costs[k]) : costs[k])
    printf " | %.0f | %.0f %% | %.0f %% | %.2g M | %.0f |\n", sum[k, 7] / m, 100 * sum[k, 8] / m, 100 * sum[k, 9] / m,
      sum[k, 10] / m / 1e6, sum[k, 11] / m } }'
echo
echo "$over_note"
