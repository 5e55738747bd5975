#!/bin/sh
# test_tool_shield.sh TOOL: --shield: no cost where there was one, in play and while a policy learns; a run that was broken off
# goes on to the same bytes; off changes no byte; wrong words are wrong usage.
. "$(dirname "$0")/tool.sh"

check() {  # check WHAT COMMAND...
  what=$1
  shift
  "$@" || { echo "$what"; failed=1; }
}
number() { grep -o "\"$1\":\[*[^],}]*" "$2" | head -1 | sed 's/.*[:[]//'; }
less() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a < b) }'; }

# the wall: some of the shipped policy's throws touch it
play="--task hand_over_wall --policy trained --episodes 48 --seed 3 --json"
# shellcheck disable=SC2086
"$tool" eval $play > bare || exit 1
# shellcheck disable=SC2086
"$tool" eval $play --shield off > off || exit 1
check '--shield off is not the default' cmp -s bare off
# shellcheck disable=SC2086
"$tool" eval $play --shield predict > shielded || exit 1
check 'nothing to shield from' less 0 "$(number violating_steps bare)"
check 'a step violates' test "$(number violating_steps shielded)" = 0
check 'a cost came' test "$(number cost_mean shielded)" = 0.0
check 'it never stepped in' less 0 "$(number interventions shielded)"
# the policy holds its actions for two steps: it is looked at when it decides
check 'decisions are not those of the policy' less "$(number decisions shielded)" 1900
check 'no decisions' less 1000 "$(number decisions shielded)"
check 'a shield is told of without one' sh -c '! grep -q interventions bare'

# where no clean way is found what violates is told apart, of every world and every control step
for flags in '' '--set action_repeat=3'; do
  # shellcheck disable=SC2086
  "$tool" eval --task ball_run --policy random --episodes 16 --shield predict:rounds=1,look=1 $flags --json > unproven || exit 1
  check "nothing is inevitable $flags" less 0 "$(number inevitable_steps unproven)"
  check "it is not all that violates $flags" test "$(number inevitable_steps unproven)" = "$(number violating_steps unproven)"
done
check 'what is clean has inevitable steps' test "$(number inevitable_steps shielded)" = 0

# guards alone: what is commanded
"$tool" eval --task hand_over_safe_finger --set cost_mode=command --policy random --episodes 4 --shield project --json > projected || exit 1
check 'a guard was broken' test "$(number violating_steps projected)" = 0
check 'nothing was projected' less 0 "$(number interventions projected)"

# learning: none violates, and a run that was stopped goes on to the same bytes
train="--task hand_over_safe_joint --envs 16 --steps 20000 --seed 2 --set shield_learn=end --shield predict --no-tensorboard --json"
# shellcheck disable=SC2086
"$tool" train $train --out whole > whole.json 2> /dev/null || exit 1
check 'violations in training' test "$(number training_violating_steps whole.json)" = 0
check 'what is inevitable is not counted' test "$(number training_inevitable_steps whole.json)" = 0
check 'nothing was refused' less 0 "$(number training_interventions whole.json)"
check 'nor evaluated under the shield' grep -q '"shielded":{' whole.json
check 'progress.csv has no violations' grep -q 'Metrics/Violations.*Shield/Refused' whole/progress.csv
check 'config.json has no shield' grep -q '"shield": "predict"' whole/config.json
# broken_off RUN FLAGS...: a training that is interrupted after some epochs
broken_off() {
  run=$1
  shift
  "$tool" train "$@" --out "$run" > "$run.json" 2> /dev/null &
  pid=$!
  while kill -0 $pid 2> /dev/null && { [ ! -f "$run/progress.csv" ] || [ "$(wc -l < "$run/progress.csv")" -lt 6 ]; }; do sleep 0.02; done
  kill -INT $pid
  wait $pid
}
# shellcheck disable=SC2086
broken_off part $train
check 'the run was over before it was broken off' less "$(number env_steps part.json)" 20000
"$tool" train --resume part --json > rest.json 2> /dev/null || exit 1
same whole part 'broken off and resumed'
check 'the counts are of the rest alone' test "$(number training_interventions whole.json)" = "$(number training_interventions rest.json)"

# a run evaluates without one unless it is asked for, and then with the run's options
"$tool" eval --policy whole --episodes 20 --json > free.json || exit 1
check 'eval of a run is shielded' sh -c '! grep -q interventions free.json'
"$tool" eval --policy whole --episodes 20 --shield predict --json > under.json || exit 1
check 'eval of a run is not shielded' grep -q '"interventions":' under.json

# a policy with a memory learns under one, goes on when it was broken off, and is the backup of one that plays
remember="--task hand_over_safe_joint --envs 8 --steps 12000 --seed 3 --set memory=gru:8 --set hidden=16 --set last_layer_scale=5 --shield predict --no-tensorboard --json"
# shellcheck disable=SC2086
"$tool" train $remember --out gru > gru.json 2> err || { cat err; exit 1; }
check 'violations in training with a memory' test "$(number training_violating_steps gru.json)" = 0
check 'nothing was refused with a memory' less 0 "$(number training_interventions gru.json)"
# shellcheck disable=SC2086
broken_off stopped $remember
check 'the run with a memory was over before it was broken off' less "$(number env_steps stopped.json)" 12000
"$tool" train --resume stopped --json > rest.json 2> /dev/null || exit 1
same gru stopped 'with a memory broken off and resumed'
"$tool" eval --policy gru --episodes 8 --seed 3 --json > free.json || exit 1
"$tool" eval --policy gru --episodes 8 --seed 3 --shield predict --json > under.json || exit 1
check 'its policy violates nothing' less 0 "$(number violating_steps free.json)"
check 'its policy violates under the shield' test "$(number violating_steps under.json)" = 0
"$tool" render --policy gru --shield predict --seed 5 --strip 2 --size 120x90 --out strip.png > /dev/null || exit 1

refused() {  # refused TEXT ARGUMENTS...
  text=$1
  shift
  "$tool" "$@" > out 2>&1
  check "exit status of $*" test $? -eq 2
  check "$* says: $(cat out)" grep -q -- "$text" out
}
refused 'nearest is predict' eval --task hand_over_wall --shield predicts
refused 'nearest is noise' eval --task hand_over_wall --shield predict:nois=1
refused 'off has no options' eval --task hand_over_wall --shield off:noise=1
refused 'declares no guards' eval --task hand_over_wall --shield project
refused 'outside' eval --task hand_over_wall --shield predict:block=0
refused 'words project and predict' eval --task hand_over_wall --shield predict:predict=false
refused '--resume takes its settings from the folder' train --resume whole --shield off
refused 'cannot be shared among ranks' train --task bandit --ranks 2 --shield predict
refused 'the shield proves nothing' rollout --task hand_over_wall --shield predict --noise 0.1
refused 'reads points' train --task grasp --set encoder=8,8 --set encoder_points=16 --envs 2 --shield predict
check 'a refused run left its folder' test ! -d runs
# what was played under a shield plays again without one, and not under another
"$tool" rollout --task hand_over_wall --policy trained --seed 3 --shield predict --record played.npz > first || exit 1
"$tool" rollout --policy played.npz > second || exit 1
check 'a record of it ends elsewhere' test "$(grep hash first)" = "$(grep hash second)"
refused 'as it was' rollout --policy played.npz --shield predict
# a checkpoint without what the shield knew is no way to go on
"$tool" train --task bandit --envs 2 --steps 200 --set horizon=20 --out without > out 2>&1 || { cat out; exit 1; }
sed -i 's/"threads": 0,/"threads": 0, "shield": "predict",/' without/config.json
"$tool" train --resume without --steps 400 > out 2>&1
check "status of a resume without the shield's state: $(cat out)" test $? -eq 1
check "a resume without the shield's state: $(cat out)" grep -q 'no state of the shield' out
# every option is listed, and its words are completed
"$tool" info shield > listed || exit 1
for key in block look tries noise choose unproven; do check "info shield has no $key" grep -q "^$key " listed; done
check 'the completion has no words' sh -c '"$0" completion bash | grep -q -- "--shield) words=.off project predict."' "$tool"

"$tool" render --task hand_over_wall --policy trained --shield predict --seed 5 --strip 4 --size 120x90 --out strip.png --json > strip || exit 1
check 'no picture' test -s strip.png
check 'a strip without its counts' grep -q '"interventions":' strip
# frames of steps that it changed are marked in the page
if "$tool" render --task hand_over_wall --policy trained --shield predict --seed 2 --html page.html > page 2> err; then
  check 'the page marks no frame' grep -q '"stepped_in":\[[0-9]' page.html
  check 'the page does not say what a red border is' grep -q 'shield predict, a red border where it stepped in, in [1-9]' page.html
else
  check "no page: $(cat err)" grep -q 'no viewer library' err
fi
exit $failed
