#!/usr/bin/env bash
# The paper's experiments, measured again: Table 1 and Fig. 6 (eight algorithms, PPO, and PPO under a shield on the four throws with
# costs of the robot's state), Fig. 7 (six tasks with costs of the environment's state), rows with a second cost, PPO under a shield
# on all ten tasks, and what the paper claims of its algorithms. Finished runs are kept and stopped ones go on, so the script can be
# stopped and called again, also where only RESULTS is left of earlier calls (a run with a row there is done; AGAIN=1 runs it
# anew): seed after seed, so that the tables are whole, if thin, as early as can be.
#   bash examples/paper_tables.sh [OUT] [RESULTS]   OUT: folder of the runs, default runs/paper
#                                                   RESULTS: what is kept of them, default examples/results
# Environment: REDMAN (the tool), PARTS ("table1 fig7 second shield": what is trained; `command`: Table 1 with costs of commanded targets,
# and a row that projects actions), SEEDS ("0 1 2"), JOBS (runs at once, one thread each; 2), STEPS (control steps; else 10 million of a
# throw and under a shield, and by task in Fig. 7), LONG (algorithms that have the paper's 100 million steps with the first seed; ""),
# LONG_TASKS (the four throws), TASKS, ALGOS (those of a part that are wanted).
#
# RESULTS/runs.csv has a row for each run: its command, seed, steps, wall time; the mean action and the policy with its
# noise over 100 fresh episodes each, learned under a shield: the mean action under it and, as bare_, without; the last tenth of training; control steps that violated in training, and of these, under a shield, those that no plan avoids (inevitable); the hash of its
# policy. RESULTS/*.md are the tables, feasible first (made by examples/paper_report.sh out of runs.csv), RESULTS/*.svg the
# curves. The runs themselves, with all that `redman plot`, `eval` and `render` read, stay in OUT; OUT/redman-runs.tar.gz has them
# in one file, whose bytes are those of the runs alone.
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
out=${1:-$root/runs/paper} results=${2:-$root/examples/results}
parts=${PARTS:-table1 fig7 second shield} seeds=${SEEDS:-0 1 2}
throws="hand_over_safe_finger hand_over_safe_joint catch_underarm_safe_finger catch_underarm_safe_joint"
props="grasp reorient hand_over_wall jenga pick_bottles clean_house"
eight="cpo trpo_lag ppo_lag p3o pcpo focops cppo_pid ipo"
mkdir -p "$out" "$results"

# steps TASK ALGO PART
steps() {
  [ "${3:-}" != shield ] || { echo 10000000; return; }
  case $1.$2 in
    jenga.*) echo 1500000 ;;
    hand_over_wall.trpo_lag) echo 36000000 ;;
    hand_over_wall.*) echo 12000000 ;;
    pick_bottles.* | clean_house.*) echo 2000000 ;;
    grasp.* | reorient.*) echo 3000000 ;;
    *) echo 10000000 ;;
  esac
}

# algos PART TASK: Table 1 has eight and PPO, bare and shielded; Fig. 7 PPO and PPO-Lag, TRPO-Lag where it does better, and every
# algorithm on grasp and jenga. ALGO+SHIELD learns under that shield.
algos() {
  case $1.$2 in
    table1.*) echo "$eight ppo ppo+predict" ;;
    command.*) echo "$eight ppo+project" ;;
    shield.*) echo "ppo+predict" ;;
    fig7.grasp | fig7.jenga) echo "ppo ppo_lag focops cppo_pid p3o trpo trpo_lag cpo pcpo ipo" ;;
    fig7.hand_over_wall) echo "ppo ppo_lag trpo_lag" ;;
    fig7.*) echo "ppo ppo_lag" ;;
    second.*) echo "ppo_lag cpo p3o" ;;
  esac
}

# second TASK ALGO: the flags of its rows with a second cost. CPO is defined for one: it follows the more violated.
second() {
  case $1 in
    hand_over_*) echo "--cost-limit effort=1" ;;
    catch_*) echo "--cost-limit throw_height=1" ;;
    jenga) echo "--cost-limit blocks_contact=60" ;;
  esac
  [ "$2" != cpo ] || echo "--set several_costs=worst"
}

# onward TASK: the flags of a run that goes on from its task's bundled policy: what that policy reads and was trained with.
onward() {
  echo "--from trained"
  case $1 in
    reorient)
      local rows='right.joint_position,right.joint_velocity,object.*,right.action'
      echo "--set actor_obs=$rows --set critic_obs=$rows --set turn_reward=20 --set reward_factor=0.02 --set action_repeat=3"
      echo "--set horizon=24 --set passes=4 --set minibatches=8"
      ;;
  esac
}

wanted() { case " ${2:-$1} " in *" $1 "*) ;; *) return 1 ;; esac }

# One line for each run: NAME PART TASK ALGO SEED STEPS FLAGS...
rows() {
  local first=${seeds%% *} seed part task algo tasks
  for seed in $seeds; do for part in $parts; do
    case $part in table1 | command) tasks=$throws ;; fig7 | shield) tasks=$props ;; *) tasks="hand_over_safe_finger catch_underarm_safe_finger jenga" ;; esac
    for task in $tasks; do
      wanted "$task" "${TASKS:-}" || continue
      for algo in $(algos "$part" "$task"); do
        wanted "$algo" "${ALGOS:-}" || continue
        case $part in
          second) echo "$task.$algo.second.$seed second $task $algo $seed ${STEPS:-$(steps "$task" "$algo")} $(second "$task" "$algo" | xargs)" ;;
          command | shield) echo "$task.$algo.$part.$seed $part $task $algo $seed ${STEPS:-$(steps "$task" "$algo" "$part")}" ;;
          *) echo "$task.$algo.$seed $part $task $algo $seed ${STEPS:-$(steps "$task" "$algo")}" ;;
        esac
      done
    done
  done; done
  for task in ${LONG_TASKS:-$throws}; do for algo in ${LONG:-}; do
    echo "$task.$algo.long.$first long $task $algo $first 100000000"
  done; done
}

# reported NAME STEPS: it has a row among the results, of as many steps, and nothing of the run itself is here.
reported() {
  [ -z "${AGAIN:-}" ] && [ ! -e "$out/$1" ] && [ -s "$results/runs.csv" ] &&
    awk -F, -v name="$1" -v n="$2" 'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
      $1 == name && $at["env_steps"] >= n { found = 1 } END { exit !found }' "$results/runs.csv"
}

run_one() {  # a row
  local name=$1 part=$2 task=$3 algo=$4 seed=$5 n=$6 more
  shift 6
  # the paper's Table 1 fits costs of commanded targets alone: tasks/costs.md
  case $part in command) set -- "$@" --set cost_mode=command ;; shield) read -r -a more <<< "$(onward "$task" | xargs)" && set -- "$@" "${more[@]}" ;; esac
  case $algo in *+predict) set -- "$@" --shield predict ;; *+project) set -- "$@" --shield project ;; esac
  if trained "$out/$name" --task "$task" --algo "${algo%%+*}" --seed "$seed" --steps "$n" --no-tensorboard "$@" &&
    sampled "$out/$name" "$seed" &&
    { [ "$part" != second ] || kept "$out/$name.mean.json" eval --policy "$out/$name" --episodes 100 --seed $((1000000 + seed)); }; then
    return
  fi
  echo "$name failed: see $out/$name.log" >&2
}

rows | {
  while read -r -a row; do
    ! reported "${row[0]}" "${row[5]}" || continue
    wait_turn
    run_one "${row[@]}" < /dev/null &
  done
  wait
}

# ---- what is kept

# wall_seconds CSV: of a run and of what it went on from.
wall_seconds() {
  awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next } { t = $at["Time/Total"] } END { printf "%.1f", t }' "$1"
}

# of_second FILE: limit and mean cost of the second column that has a limit, of an evaluation; "," without one.
of_second() {
  [ -s "$1" ] || { echo ,; return; }
  { sed -n 's/.*"cost_limits":\[\([^]]*\)\].*/\1/p' "$1"; sed -n 's/.*"cost_mean":\[\([^]]*\)\].*/\1/p' "$1"; } |
    awk -F, 'NR == 1 { for (i = 2; i <= NF; ++i) if ($i >= 0) k = i; limit = $k } NR == 2 { print k ? limit "," $k : "," }'
}

# bare FILE: return, cost and success rate without the shield, under which the others are; "" where there was none.
bare() {
  local key
  for key in return cost success_rate; do
    case $(cat "$1") in *'"shielded"'*) grep -o "\"$key\":[-+.0-9a-z]*" "$1" | head -n 1 | sed 's/.*://' ;; *) echo ;; esac
  done | paste -sd,
}

header="name,part,task,algorithm,seed,limit,return,cost,cost_stderr,falls,success,length,sampled_return,sampled_cost,sampled_over,train_return,train_cost,train_over,train_swing,env_steps,wall_seconds,seconds_to_half,second_limit,second_cost,flags,violations,policy_sha256,return_stderr,over,cost_cvar,sampled_return_stderr,sampled_cost_stderr,bare_return,bare_cost,bare_success,inevitable"
rows | while read -r name part task algo seed n flags; do
  f=$out/$name.json s=$out/$name.sampled.json
  if [ ! -s "$f" ] || [ ! -s "$s" ]; then continue; fi
  limit=$(value cost_limit "$f")
  case $limit in [0-9]*) ;; *) limit=-1 ;; esac
  tail=$(last_tenth "$out/$name/progress.csv" "$limit")
  echo "$name,$part,$task,$algo,$seed,$limit,$(value return "$f"),$(value cost "$f"),$(value cost_stderr "$f"),$(value fall_rate "$f"),$(value success_rate "$f"),$(value length "$f"),$(value return_mean "$s"),$(value cost_mean "$s"),$(value violation_rate "$s"),$tail,$(value env_steps "$f"),$(wall_seconds "$out/$name/progress.csv"),$(reached "$out/$name/progress.csv"),$(of_second "$out/$name.mean.json"),$flags,$(value training_violating_steps "$f"),$(sha256sum < "$out/$name/policy.rdm" | cut -d" " -f1),$(value return_stderr "$f"),$(value violation_rate "$f"),$(value cost_cvar "$f"),$(value return_stderr "$s"),$(value cost_stderr "$s"),$(bare "$f"),$(value training_inevitable_steps "$f")"
done > "$results/runs.csv.new"
# runs of other calls stay; columns that are younger than their rows are empty
{
  echo "$header"
  {
    cat "$results/runs.csv.new"
    if [ -s "$results/runs.csv" ]; then
      awk -F, -v header="$header" 'FILENAME == ARGV[1] { seen[$1] = 1; next }
        FNR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; n = split(header, name, ","); next }
        !($1 in seen) { for (i = 1; i <= n; ++i) printf "%s%s", (name[i] in at) ? $at[name[i]] : "", i < n ? "," : "\n" }' "$results/runs.csv.new" "$results/runs.csv"
    fi
  } | sort
} > "$results/runs.csv.part"
rm "$results/runs.csv.new"
mv "$results/runs.csv.part" "$results/runs.csv"

# drawn PART PICTURE: the curves of the runs of a part that are here.
drawn() {
  local list
  list=$(awk -F, -v p="$1" '$2 == p { print $1 }' "$results/runs.csv" | while read -r name; do [ ! -s "$out/$name.json" ] || echo "$out/$name"; done)
  # shellcheck disable=SC2086
  [ -z "$list" ] || "$redman" plot $list --out "$results/$2" > /dev/null
}
drawn table1 fig6.svg
drawn fig7 fig7.svg
drawn shield shield.svg
bash "$root/examples/paper_report.sh" "$results"
(cd "$out" && find . -name config.json -o -name progress.csv -o -name policy.rdm | sort |
  tar --create --files-from - --owner=0 --group=0 --numeric-owner --mtime=@0 --mode=0644 | gzip -n) > "$out/redman-runs.tar.gz"
