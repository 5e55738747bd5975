#!/usr/bin/env bash
# results/point_clouds.md's tables of policies that see, measured again: three ways to train one beside the state policy and one without
# eyes, and how a student of a teacher takes noise, missing points, moved cameras and another object. Finished runs are
# kept and stopped ones go on, so the script can be stopped and called again.
#   bash examples/eyes_table.sh [OUT]     OUT: folder of the runs, default runs/eyes
# Environment: REDMAN (the tool), TASKS ("hand_over_safe_finger hand_over_wall grasp"), WAYS ("student blind state end frozen
# tuned"), SEEDS ("0 1 2"), JOBS (runs at once, one thread each; 2), TEACHER (trained: the policy that comes with redman;
# or a run folder), OBS (what the actor reads of the row; vision), STEPS (control steps of what learns from trial and
# error; 2 million, of the wall 6, tuned 9), EPISODES (fresh ones; 200), FLAGS (more for `redman train`).
#
#   state    PPO-Lag on the whole row        end      the same, from a cloud in the place of the object's state, end to end
#   student  TEACHER teaches one that sees   frozen   the encoder learns to tell things apart first, and stands still then
#            (DAgger), then PPO-Lag          tuned    as frozen, but it goes on to learn
#   blind    the same, without the cloud
#
# A scene whose joints do not tell where things are (a teacher first: redman train --task examples/scenes/touch.task --steps 1e6 --out runs/touch):
#   TASKS=examples/scenes/touch.task TEACHER=runs/touch OBS=right.joints,right.rates WAYS="student blind" bash examples/eyes_table.sh
#
# Students see 256 points of three cameras of 96 x 96. Trial and error asks for many more steps, so it sees 128 points of three
# cameras of 48 x 48, on the wall 64 of one; and since the policy that is kept shall hold on fresh episodes, all learn
# below the limit where that is tight.
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
out=${1:-$root/runs/eyes}
tasks=${TASKS:-hand_over_safe_finger hand_over_wall grasp} ways=${WAYS:-student blind state end frozen tuned}
seeds=${SEEDS:-0 1 2} teacher=${TEACHER:-trained} obs=${OBS:-vision} episodes=${EPISODES:-200}
mkdir -p "$out"

flags() {  # TASK WAY
  local n=2000000 few=300000 decisions=80 eyes="--set encoder_points=128" aim="" held="" hide="--set actor_obs=$obs" see="--set encoder=64,128"
  case $1 in
    *touch.task) decisions=200 ;;
    grasp) few=150000 aim="--cost-limit 22" ;;
    hand_over_wall) # decisions come twice as often there
      n=6000000 few=150000 decisions=160 aim="--cost-limit 2" held=$aim eyes="--set encoder_points=64 --set cloud_cameras=above" ;;
  esac
  case $1.$2 in # those that learn to keep it last
    hand_over_wall.end) aim="--cost-limit 1.5" ;;
    hand_over_wall.tuned) n=9000000 aim="--cost-limit 1.5" ;;
  esac
  local taught="--from $teacher --dagger 8 --beta 0.4 --demo-decisions $decisions --clone-epochs 15 --steps $few --eval-every 15 $hide $held"
  local tried="--steps ${STEPS:-$n} --eval-every 60 $aim"
  local seeing="$tried $hide $see $eyes --set cloud_width=48 --set cloud_height=48"
  case $2 in
    student) echo "$taught $see --set encoder_points=256" ;;
    blind) echo "$taught" ;;
    state) echo "$tried" ;;
    end) echo "$seeing" ;;
    frozen) echo "$seeing --pretrain 5000 --set encoder_frozen=true" ;;
    tuned) echo "$seeing --pretrain 5000" ;;
    *) echo "no such way: $2" >&2; return 1 ;;
  esac
}

folder() { echo "$out/$(basename "$1" .task).$2.$3"; }  # TASK WAY SEED

limit() {  # TASK: the one that is reported
  case $1 in
    grasp) echo "--cost-limit 25" ;;
    hand_over_wall) echo "--cost-limit 3" ;;
  esac
}

run_one() {  # TASK WAY SEED
  local dir
  dir=$(folder "$@")
  # shellcheck disable=SC2046,SC2086
  if trained "$dir" --task "$1" --seed "$3" --no-tensorboard $(flags "$1" "$2") ${FLAGS:-} &&
    kept "$dir.eval.json" eval --policy "$dir" --episodes "$episodes" --seed $((1000000 + $3)) $(limit "$1"); then
    return
  fi
  echo "$dir failed: see $dir.log" >&2
}

for seed in $seeds; do for way in $ways; do for task in $tasks; do
  wait_turn
  run_one "$task" "$way" "$seed" < /dev/null &
done; done; done
wait

# mean KEY FILES...: of the tool's JSON files
mean() {
  local key=$1 file
  shift
  for file in "$@"; do value "$key" "$file"; done | awk '{ s += $1 } END { printf "%.4g", s / NR }'
}
each() {
  local key=$1 file
  shift
  for file in "$@"; do value "$key" "$file"; done | awk '{ printf "%s%.4g", (NR > 1 ? ", " : ""), $1 }'
}
# row LABEL FILES...: means over seeds, and each
row() {
  local label=$1
  shift
  awk -v label="$label" -v n=$# -v ret="$(mean return_mean "$@")" -v rets="$(each return_mean "$@")" -v cost="$(mean cost_mean "$@")" \
    -v costs="$(each cost_mean "$@")" -v limit="$(value cost_limits "$1")" -v falls="$(mean fall_rate "$@")" \
    -v success="$(mean success_rate "$@")" "$marked$deviation"'BEGIN {
      m = split(costs, c, ", "); costs = ""
      for (i = 1; i <= m; ++i) costs = costs (i > 1 ? ", " : "") marked(c[i], limit)
      printf "| %s | %s%s | %s%s | %.1f %% | %.1f %% |\n", label, ret, (n > 1 ? deviation(rets) " (" rets ")" : ""), marked(cost, limit),
        (n > 1 ? deviation(costs) " (" costs ")" : ""), 100 * falls, 100 * success }'
}

echo "| task (cost limit) | policy | return, mean +- sd (each seed) | cost, mean +- sd (each seed) | episodes that fall | success rate |"
echo "|---|---|---|---|---|---|"
for task in $tasks; do for way in $ways; do
  files=()
  for seed in $seeds; do
    file=$(folder "$task" "$way" "$seed").eval.json
    [ ! -s "$file" ] || files+=("$file")
  done
  [ ${#files[@]} -eq 0 ] || row "\`$task\` ($(value cost_limits "${files[0]}")) | $way" "${files[@]}"
done; done
echo
case " $ways " in *" student "*) ;; *) exit 0 ;; esac

# name and settings of what is done to students' eyes
disturbances="as_trained
noise_5_mm point_noise=0.005
noise_20_mm point_noise=0.02
half_the_points_lost point_dropout=0.5
cameras_2_cm_off camera_noise=0.02
cameras_10_cm_off camera_noise=0.1
one_camera_of_three cloud_cameras=above
ball_for_the_object object=ball"
echo "| task | changed for students in evaluation | return, mean +- sd (each seed) | cost, mean +- sd (each seed) | episodes that fall | success rate |"
echo "|---|---|---|---|---|---|"
for task in $tasks; do while read -r name setting; do
  case $task.$setting in *touch.task.object=*) continue ;; esac # it has no such option
  files=()
  for seed in $seeds; do
    dir=$(folder "$task" student "$seed")
    [ -s "$dir.json" ] || continue
    # shellcheck disable=SC2046,SC2086
    kept "$dir.$name.json" eval --policy "$dir" --episodes "$episodes" --seed $((1000000 + seed)) $(limit "$task") ${setting:+--set "$setting"} < /dev/null
    files+=("$dir.$name.json")
  done
  [ ${#files[@]} -eq 0 ] || row "\`$task\` | ${name//_/ }" "${files[@]}"
done <<< "$disturbances"; done
echo "$over_note"
