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
check 'no decisions' less 1000 "$(number decisions shielded)"
check 'a shield is told of without one' sh -c '! grep -q interventions bare'

# guards alone: what is commanded
"$tool" eval --task hand_over_safe_finger --set cost_mode=command --policy random --episodes 4 --shield project --json > projected || exit 1
check 'a guard was broken' test "$(number violating_steps projected)" = 0
check 'nothing was projected' less 0 "$(number interventions projected)"

# learning: none violates, and a run that was stopped goes on to the same bytes
train="--task hand_over_safe_joint --envs 16 --steps 20000 --seed 2 --set shield_learn=end --shield predict --no-tensorboard --json"
# shellcheck disable=SC2086
"$tool" train $train --out whole > whole.json 2> /dev/null || exit 1
check 'violations in training' test "$(number training_violating_steps whole.json)" = 0
check 'nothing was refused' less 0 "$(number training_interventions whole.json)"
check 'nor evaluated under the shield' grep -q '"shielded":{' whole.json
check 'progress.csv has no violations' grep -q 'Metrics/Violations.*Shield/Refused' whole/progress.csv
check 'config.json has no shield' grep -q '"shield": "predict"' whole/config.json
# shellcheck disable=SC2086
"$tool" train $train --out part > part.json 2> /dev/null &
while [ "$(wc -l 2> /dev/null < part/progress.csv || echo 0)" -lt 6 ]; do sleep 0.02; done
kill -INT $!
wait $!
"$tool" train --resume part --json > rest.json 2> /dev/null || exit 1
check 'resumed it is another run' cmp -s whole/policy.rdm part/policy.rdm
check 'the counts are of the rest alone' test "$(number training_interventions whole.json)" = "$(number training_interventions rest.json)"

refused() {  # refused TEXT ARGUMENTS...
  text=$1
  shift
  "$tool" "$@" > out 2>&1
  check "exit status of $*" test $? -eq 2
  check "$* says: $(cat out)" grep -q "$text" out
}
refused 'nearest is predict' eval --task hand_over_wall --shield predicts
refused 'nearest is noise' eval --task hand_over_wall --shield predict:nois=1
refused 'off has no options' eval --task hand_over_wall --shield off:noise=1
refused 'declares no guards' eval --task hand_over_wall --shield project
refused 'outside' eval --task hand_over_wall --shield predict:block=0

"$tool" render --task hand_over_wall --policy trained --shield predict --seed 5 --strip 4 --size 120x90 --out strip.png --json > strip || exit 1
check 'no picture' test -s strip.png
check 'a strip without its counts' grep -q '"interventions":' strip
exit $failed
