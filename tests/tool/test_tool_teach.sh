#!/bin/sh
# test_tool_teach.sh TOOL: `train --from`: a demonstration, a recording and a policy; a run that was killed and resumed is one
# that was not; what cannot be learned from is refused in one line, before there is a folder.
. "$(dirname "$0")/tool.sh"
small='--envs 8 --set max_steps=20 --set hidden=16,16 --set horizon=8 --eval-every 4 --checkpoint-every 2 --steps 8000'
short='--demo-decisions 30 --clone-epochs 2'

refused() { # refused STATUS WORD FLAGS...
  wanted=$1 word=$2
  shift 2
  "$tool" train "$@" --out refused > out 2> err
  status=$?
  [ $status -eq "$wanted" ] || { echo "train $* ended with $status, not $wanted"; failed=1; }
  grep -q -- "$word" err || { echo "train $*: no '$word' in: $(cat err)"; failed=1; }
  [ "$(grep -vc '^teacher\|^cloned' err)" -le 2 ] || { echo "train $*: more than a line: $(cat err)"; failed=1; }
  [ ! -e refused ] || { echo "train $* left a folder"; rm -rf refused; failed=1; }
}

# shellcheck disable=SC2086
"$tool" train $small --from demo $short --dagger 1 --start-share 0.6..0.1 --set imitation=0.1 --set warm_epochs=2 \
  --save-recording shown.npz --out whole --json > json 2> err || { cat err; exit 1; }
grep -q '"clone":{"rows":' json || { echo "no clone in $(cat json)"; failed=1; }
grep -q '^DAgger round 1' err || { echo "no round of DAgger in $(cat err)"; failed=1; }
for word in '"from": "demo"' '"start_share": 0.6' '"dagger": 1' '"warm_epochs": "2"' 'init_std=0.03'; do
  grep -qF -- "$word" whole/config.json || { echo "config.json has no $word"; failed=1; }
done
for rows in 1 3 6 12; do
  rm -rf broken
  # shellcheck disable=SC2086
  "$tool" train $small --threads 2 --from demo $short --dagger 1 --start-share 0.6..0.1 --set imitation=0.1 \
    --set warm_epochs=2 --out broken > /dev/null 2>&1 &
  pid=$!
  while kill -0 $pid 2> /dev/null && { [ ! -f broken/progress.csv ] || [ "$(wc -l < broken/progress.csv)" -lt $rows ]; }; do
    sleep 0.01
  done
  kill -9 $pid 2> /dev/null
  wait $pid 2> /dev/null
  "$tool" train --resume broken > /dev/null 2> err || { echo "resume failed: $(cat err)"; failed=1; }
  curve whole > a
  curve broken > b
  cmp -s a b || { echo "the curve differs, killed at row $rows"; failed=1; }
  cmp -s whole/policy.rdm broken/policy.rdm || { echo "the policy differs, killed at row $rows"; failed=1; }
done

# A recording: of a rollout with noise, or what the teacher showed; and a policy.
"$tool" rollout --policy demo --set max_steps=20 --episodes 6 --envs 3 --noise 0.05 --record noisy.npz > out 2>&1 || { cat out; failed=1; }
for file in noisy.npz shown.npz; do
  # shellcheck disable=SC2086
  "$tool" train $small --from $file --clone-epochs 2 --out "of-$file" > out 2>&1 || { cat out; failed=1; }
  grep -q '^cloned' out || { echo "nothing was cloned of $file"; failed=1; }
done
# shellcheck disable=SC2086
"$tool" train $small --from whole --out begun > out 2>&1 || { cat out; failed=1; }
grep -q '^begins with the policy' out || { echo "no start from a policy: $(cat out)"; failed=1; }
# shellcheck disable=SC2086
"$tool" train $(echo "$small" | sed s/16,16/8/) --from whole --dagger 1 $short --out distilled > out 2>&1 || { cat out; failed=1; }

# What a demonstration says of how it is learned from; flags win.
printf '%s\n' 'task hand_over_safe_finger' 'teach demo-decisions=20' 'teach clone-epochs=2' 'teach dagger=2' 'teach beta=0.25' \
  'learn hidden=8' 'learn warm_epochs=3' 'phase a' 'right.WRJ0 = 1' > told.demo
"$tool" train --envs 8 --set max_steps=20 --set horizon=8 --steps 8000 --from told.demo --dagger 1 --set warm_epochs=2 --out told > out 2>&1 ||
  { cat out; failed=1; }
for word in '"dagger": 1' '"beta": 0.25' '"decisions": 20' '"hidden": "8"' '"warm_epochs": "2"' '"obs_freeze": "1"'; do
  grep -qF -- "$word" told/config.json || { echo "told: config.json has no $word"; failed=1; }
done

# A student that remembers, of a teacher that observes what is drawn; a teacher of other fields is refused with the pair.
drawn='--set action_delay=0..3 --set scale.kp=0.8..1.2'
# shellcheck disable=SC2086
"$tool" train $small $drawn --set show_dynamics=true --out teacher > out 2>&1 || { cat out; failed=1; }
# shellcheck disable=SC2086
"$tool" train $small $short --from teacher --dagger 1 --set 'actor_obs=!dynamics.*' --set history=5 \
  --set 'history_fields=*.joint_position,*.action' --out student > out 2>&1 || { cat out; failed=1; }
grep -q '^DAgger round 1' out || { echo "no round of the student in $(cat out)"; failed=1; }
grep -q '"show_dynamics' student/config.json || grep -q 'show_dynamics=true' student/config.json ||
  { echo "the student's worlds are not the teacher's"; failed=1; }
"$tool" eval --policy student --episodes 4 > out 2>&1 || { cat out; failed=1; }
refused 1 'field [0-9]* is dynamics.scale.kp \[1\] to the policy, nothing to the task' --task hand_over_safe_finger --set action_delay=0..3 \
  --set show_dynamics=false --from teacher/policy.rdm --dagger 1
# shellcheck disable=SC2086
"$tool" train $small $short --from teacher --dagger 1 --set 'actor_obs=!dynamics.*' --set memory=gru:6 --set imitation=0.1 \
  --out gru_student > out 2>&1 || { cat out; failed=1; }
grep -q '^DAgger round 1' out || { echo "no round of the student with a GRU in $(cat out)"; failed=1; }
"$tool" eval --policy gru_student --episodes 4 > out 2>&1 || { cat out; failed=1; }

head -c 5000 shown.npz > cut.npz
refused 1 cut.npz --from cut.npz
refused 1 hidden --from whole --set max_steps=20 --set hidden=8
refused 1 'no such file' --from nobody.rdm
refused 2 'there is nothing to learn' --from zero
refused 2 'these flags need a teacher' --noise 0.1
refused 2 'start-share' --from demo --start-share 2
refused 2 'observations' --task ball_run --from shown.npz
exit $failed
