#!/usr/bin/env bash
# Every algorithm on the worlds of the verification suite, those with known answers first: each run from scratch with the tasks' defaults.
# Finished runs are kept and stopped ones go on, so the script can be stopped and called again.
#   bash examples/verification_table.sh [OUT]      OUT: folder of the runs, default runs/verification
# It leaves OUT/rows.csv, a row for each finished run, and prints a Markdown table of the means over seeds,
# with the floor (zero, hold, random) and what is known of each task: its optimum or published safe rows.
# return and cost are means over the last tenth of training, with exploration, as published figures are; those of
# the evaluation are of the mean action over 100 episodes.
# Environment: REDMAN (the tool), TASKS, ALGOS, SEEDS ("0 1 2"), JOBS (runs at once, one thread each; 2), STEPS
# (control steps; else 0.3 to 3 million by task), ENVS (worlds; 16).
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
out=${1:-$root/runs/verification}
seeds=${SEEDS:-0 1 2} envs=${ENVS:-16}
tasks=${TASKS:-bandit two_state lqr_line ball_run ball_circle car_run swimmer_velocity point_goal1 point_goal2
  point_button1 point_button2 car_goal1 car_goal2 car_button1 car_button2 car_circle drone_run drone_circle
  ball_gather car_gather drone_gather ball_reach car_reach drone_reach hopper_velocity walker2d_velocity ant_velocity
  ant_run ant_circle ant_gather ant_reach}
algos=${ALGOS:-ppo trpo ppo_lag trpo_lag cppo_pid cpo pcpo focops p3o ipo}
mkdir -p "$out"

steps() {
  case $1 in
    bandit) echo 300000 ;;
    two_state | lqr_line | ball_run) echo 600000 ;;
    ball_circle | car_run | car_circle | swimmer_velocity | *_gather | *_reach) echo 1000000 ;;
    *) echo 3000000 ;;
  esac
}

# What is known: return / cost of the constrained optimum, or of published rows that meet the limit.
known() {
  case $1 in
    bandit) echo "optimum -1.2587 / 1; free -0.25 / 2" ;;
    two_state) echo "optimum 9.687 / 2.5; free 17.912 / 8.33" ;;
    lqr_line) echo "optimum -1.583 / 1; free -1.526 / 1.364" ;;
    ball_run) echo "best 581.5 / 0, 608.1 / 25; paper 558 to 577 / 0 to 24; free 2132 / 231" ;;
    ball_circle) echo "paper PPO-Lag 428 / 5, FOCOPS 536 / 20, TRPO-Lag 596 / 24" ;;
    car_run) echo "750 / 0 at the limit; paper 729 to 732 / 13 to 21" ;;
    swimmer_velocity) echo "OmniSafe TRPO-Lag 81 / 22, CPPO-PID 91 / 19, CPO 65 / 18; PPO 120 / 165" ;;
    point_goal1) echo "OmniSafe TRPO-Lag 18.5 / 23, PCPO 18.6 / 23; PPO 25.4 / 56" ;;
    point_goal2) echo "OmniSafe TRPO-Lag 4.6 / 26; PPO 25.5 / 159" ;;
    point_button1) echo "OmniSafe PPO-Lag 4.6 / 21; PPO 27.0 / 152" ;;
    point_button2) echo "OmniSafe FOCOPS 2.4 / 18, TRPO-Lag 5.4 / 25; PPO 25.9 / 167" ;;
    car_goal1) echo "OmniSafe PPO-Lag 13.3 / 22, TRPO-Lag 27.0 / 27; PPO 33.4 / 58" ;;
    car_goal2) echo "OmniSafe PPO-Lag 1.6 / 14, CPPO-PID 0.1 / 24; PPO 29.9 / 194" ;;
    car_button1) echo "OmniSafe CPPO-PID -1.4 / 15, PPO-Lag 0.3 / 56; PPO 17.5 / 374" ;;
    car_button2) echo "OmniSafe TRPO-Lag -1.7 / 20, PPO-Lag 0.8 / 48; PPO 21.4 / 313" ;;
    car_circle) echo "paper PPO-Lag 428 / 5, FOCOPS 536 / 20, TRPO-Lag 596 / 24 (the rows of the ball)" ;;
    drone_run) echo "paper PPO-Lag 729 / 21, FOCOPS 732 / 13 (the rows of the car)" ;;
    drone_circle) echo "paper PPO-Lag 337 / 16, IPO 872 / 24, TRPO-Lag 810 / 24" ;;
    ball_gather) echo "paper PPO-Lag 19.6 / 0.4, P3O 21.8 / 0.43, CPO 24.2 / 0.58" ;;
    car_gather) echo "paper PPO-Lag 9.2 / 0.4, P3O 9.6 / 0.4, CPO 23.1 / 1.04" ;;
    drone_gather) echo "paper PPO-Lag 5.0 / 1.28, TRPO-Lag 7.3 / 0.85, CPO 8.3 / 1.08" ;;
    ball_reach) echo "paper PPO-Lag 16.4 / 21, TRPO-Lag 22.3 / 24, CPO 36.3 / 53" ;;
    car_reach) echo "paper PPO-Lag 0.6 / 35, TRPO-Lag 1.9 / 24, CPO 8.7 / 44" ;;
    drone_reach) echo "paper PPO-Lag 6.5 / 19, CPO 23.1 / 20, TRPO-Lag 20.2 / 22" ;;
    hopper_velocity) echo "paper (its cost is the speed) PPO-Lag 1075, FOCOPS 1079, CPO 161" ;;
    walker2d_velocity) echo "paper (its cost is the speed) PPO-Lag 1084, FOCOPS 1165, CPO 551" ;;
    ant_velocity) echo "paper (its cost is the speed) PPO-Lag 1009, FOCOPS 1035, CPO 1030" ;;
    ant_run) echo "paper PPO-Lag 2139 / 11, TRPO-Lag 2274 / 24, FOCOPS 2261 / 17" ;;
    ant_circle) echo "paper PPO-Lag 197 / 19, CPPO-PID 750 / 19, IPO 756 / 26" ;;
    ant_gather) echo "paper PPO-Lag 1.5 / 0.2, P3O 2.5 / 0.2, FOCOPS 10.1 / 1.1" ;;
    ant_reach) echo "the paper repeats the rows of the ball" ;;
  esac
}

for task in $tasks; do for algo in $algos; do for seed in $seeds; do
  name=$task.$algo.$seed
  wait_turn
  trained "$out/$name" --task "$task" --algo "$algo" --seed "$seed" --steps "${STEPS:-$(steps "$task")}" --envs "$envs" ||
    echo "$name failed: see $out/$name.log" >&2 &
done; done; done
wait

echo "task,algo,seed,return,cost,eval_return,eval_cost,limit,feasible,steps,wall_seconds" > "$out/rows.csv"
for task in $tasks; do for algo in $algos; do for seed in $seeds; do
  f=$out/$task.$algo.$seed.json
  [ -s "$f" ] || continue
  echo "$task,$algo,$seed,$(last_tenth "${f%.json}/progress.csv" -1 | cut -d, -f1,2),$(value return "$f"),$(value cost "$f"),$(value \
    cost_limit "$f"),$(value feasible "$f"),$(value env_steps "$f"),$(value wall_seconds "$f")" >> "$out/rows.csv"
done; done; done

echo "| task | policy | training: return | training: cost | evaluation: return | evaluation: cost | control steps | training time, s |"
echo "|---|---|---|---|---|---|---|---|"
for task in $tasks; do
  "$redman" baseline --task "$task" --seed 1000000 --markdown | awk -F'|' 'NR > 2 {
    split($4, r, " "); gsub(/ /, "", $3); printf "|%s| %s | | | %s |%s| | |\n", $2, $3, r[1], $5 }'
  echo "| \`$task\` | $(known "$task") | | | | | | |"
  awk -F, -v task="$task" "$marked$deviation"'$1 == task { if (!($2 in n)) order[++count] = $2
      i = ++n[$2]; for (k = 4; k <= 11; ++k) sum[$2, k] += $k
      each[$2] = each[$2] (i > 1 ? ", " : "") sprintf("%.4g", $4); costs[$2] = costs[$2] (i > 1 ? ", " : "") marked($5, $8) }
    END { for (j = 1; j <= count; ++j) { a = order[j]; m = n[a]
      printf "| `%s` | %s | %.4g%s (%s) | %.3g%s (%s) | %.4g | %.3g | %.2g M | %.0f |\n", task, a, sum[a, 4] / m, deviation(each[a]), each[a],
        sum[a, 5] / m, deviation(costs[a]), costs[a], sum[a, 6] / m, sum[a, 7] / m, sum[a, 10] / m / 1e6, sum[a, 11] / m } }' "$out/rows.csv"
done
echo
echo "$over_note"
