#!/usr/bin/env bash
# Draws the pictures of the manual: of each task moments of an episode of the bundled policy, seed 0; strips of demonstrations and of
# bundled policies, the README's among them; learning curves of algorithms. Those of a team and of learners from a replay memory are of
# short runs, which this script trains where they are not there (3 seeds each, some minutes of a core); the others of the runs of
# examples/paper_tables.sh (PARTS="fig7 command") and examples/leaderboard.sh, where they are there.
#   bash examples/manual/pictures.sh [NAME...]     default: all
# Environment: REDMAN (the tool), OUT (examples/pictures), RUNS (runs/paper), LEADERBOARD (runs/leaderboard), CURVES (runs/curves)
set -eu
shopt -s nullglob
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
redman=${REDMAN:-$root/build/release/bin/redman} out=${OUT:-$root/examples/pictures} runs=${RUNS:-$root/runs/paper}
leaderboard=${LEADERBOARD:-$root/runs/leaderboard} curves=${CURVES:-$root/runs/curves}
mkdir -p "$out/tasks" "$out/algorithms"
wanted=" $* "
wanted() { [ "$wanted" = "  " ] || case $wanted in *" $1 "*) ;; *) return 1 ;; esac }

# curve ALGO RUNS...
curve() {
  local algo=$1
  shift
  [ $# = 0 ] || "$redman" plot "$@" --out "$out/algorithms/$algo.svg" > /dev/null
}
# short TASK ALGO STEPS OPTIONS...: three runs of it in $curves.
short() {
  local task=$1 algo=$2 steps=$3 seed run
  shift 3
  for seed in 0 1 2; do
    run=$curves/$task.$algo.$seed
    [ -s "$run/done" ] && continue
    "$redman" train --task "$task" --algo "$algo" --seed "$seed" --steps "$steps" --threads 1 --no-tensorboard --overwrite "$@" --out "$run" > /dev/null
    echo "$steps" > "$run/done"
  done
}
for algo in $("$redman" algos | awk 'NR > 1 { print $1 }'); do
  wanted "$algo" || continue
  case $algo in
    mappo | mappo_lag | happo | macpo | ippo | ippo_lag)
      short matrix_game "$algo" 100000
      short hand_over_safe_finger "$algo" 1000000
      curve "$algo" "$curves"/{matrix_game,hand_over_safe_finger}."$algo".?
      ;;
    td3 | td3_lag | td3_pid | sac | sac_lag | sac_pid)
      short lqr_line "$algo" 50000 --set hidden=32,32 --set horizon=8
      curve "$algo" "$curves/lqr_line.$algo".?
      ;;
    pdo | rcpo | cup | crpo) curve "$algo" "$leaderboard"/{ball_run/ball_run,car_run/car_run}/{"$algo",ppo_lag}/seed-???/ ;;
    ppo | trpo) curve "$algo" "$runs"/{grasp,jenga}."$algo".? ;;
    *) # with PPO, which is without limits
      drawn=("$runs/grasp.$algo".?)
      [ ${#drawn[@]} = 0 ] || curve "$algo" "${drawn[@]}" "$runs/grasp.ppo".? "$runs/hand_over_safe_finger.$algo.command".?
      ;;
  esac
done

# task, camera, moments, size, first and last control step
while read -r task camera moments size from to; do
  wanted "$task" || continue
  "$redman" render --task "$task" --policy trained --camera "$camera" --strip "$moments" --from "$from" --to "$to" --size "$size" \
    --out "$out/tasks/$task.png" > /dev/null
done <<'T'
hand_over_safe_finger close 4 164x123 0 36
hand_over_safe_joint close 4 164x123 0 36
catch_underarm_safe_finger close 4 168x126 0 60
catch_underarm_safe_joint close 4 168x126 0 60
grasp close 4 168x126 0 24
reorient close 4 168x126 0 73
hand_over_wall close 4 168x126 0 45
jenga left 3 168x126 0 150
pick_bottles close 3 168x126 0 78
clean_house front 4 160x120 0 480
bandit front 4 180x135 0 1
two_state front 4 180x135 0 4
lqr_line front 4 180x135 0 6
matrix_game front 4 180x135 0 4
recall front 4 180x135 0 20
ball_run front 4 180x135 0 240
ball_circle front 4 180x135 0 240
car_run front 4 180x135 0 480
swimmer_velocity front 4 180x135 0 900
point_goal1 front 4 180x135 0 900
point_goal2 front 4 180x135 0 900
point_button1 front 4 180x135 0 120
point_button2 front 4 172x129 0 900
car_goal1 front 4 180x135 0 900
car_goal2 front 4 180x135 0 900
car_button1 front 4 180x135 0 900
car_button2 front 4 172x129 0 900
car_circle front 3 212x159 0 480
drone_run front 4 180x135 0 480
drone_circle front 3 212x159 0 480
ball_gather front 4 180x135 0 240
car_gather front 3 212x159 0 480
drone_gather front 3 212x159 0 480
ball_reach front 4 180x135 0 240
car_reach front 3 212x159 0 480
drone_reach front 3 212x159 0 480
hopper_velocity front 4 180x135 0 450
walker2d_velocity front 4 180x135 0 250
ant_velocity front 4 180x135 0 42
ant_run front 4 180x135 0 240
ant_circle front 3 212x159 0 900
ant_gather front 3 212x159 0 900
ant_reach front 3 212x159 0 900
T

# name, policy, task, camera, moments, size, first and last control step, options
while read -r name policy task camera moments size from to sets; do
  wanted "$name" || continue
  # shellcheck disable=SC2086
  "$redman" render --task "$task" --policy "$policy" --camera "$camera" --strip "$moments" --from "$from" --to "$to" --size "$size" $sets \
    --out "$out/$name.png" > /dev/null
done <<'T'
hand_over trained hand_over_safe_finger close 4 480x360 8 32
catch_underarm demo catch_underarm_safe_finger close 4 360x300 8 60 --seed 4
grasp demo grasp close 4 360x300 0 73
reorient demo reorient close 4 360x300 0 73
hand_over_wall demo hand_over_wall close 4 360x300 8 56 --seed 4
jenga demo jenga left 4 360x300 56 200
jenga_paper demo jenga left 4 360x300 20 170 --set pair=paper
pick_bottles demo pick_bottles close 4 360x300 48 192
clean_house demo clean_house front 4 360x300 0 480
catch_underarm_learned trained catch_underarm_safe_finger close 6 320x240 0 40
grasp_learned trained grasp close 6 320x240 0 36
reorient_learned trained reorient close 6 320x240 0 73
hand_over_wall_learned trained hand_over_wall close 6 320x240 0 48 --seed 1
hand_over_wall_bare trained hand_over_wall close 6 240x180 2 48 --seed 14
hand_over_wall_shielded trained hand_over_wall close 6 240x180 2 48 --seed 14 --shield predict
pick_bottles_learned trained pick_bottles close 4 360x300 0 78
clean_house_learned trained clean_house front 6 320x240 0 480
T

! wanted objects || "$redman" objects --sheet "$out/objects.png" --side 80 --columns 14 > /dev/null
