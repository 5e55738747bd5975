#!/bin/sh
# test_tool_demo.sh TOOL: the demonstrations that the tool carries play, follow what is observed, and a bad script
# is named by its line.
. "$(dirname "$0")/tool.sh"
demos=$here/../../examples/demos

for file in "$demos"/*.demo; do
  task=$(sed -n 's/^task //p' "$file")
  case $(basename "$file" .demo) in
    "$task" | "$task"_*) ;;
    *) echo "$file: is not of task $task"; failed=1 ;;
  esac
  # shellcheck disable=SC2046
  set -- $(sed -n 's/^when /--set /p' "$file")
  one=$("$tool" rollout --policy "$file" --episodes 3 --envs 3 --json) || failed=1
  two=$("$tool" rollout --task "$task" "$@" --policy demo --episodes 3 --envs 3 --threads 2 --json) || failed=1
  [ "$one" = "$two" ] || { echo "$task: the file and the carried script differ: $one $two"; failed=1; }
done

# bad TEXT LINES...: a script of these lines fails with the text.
bad() {
  text=$1
  shift
  printf '%s\n' "$@" > bad.demo
  "$tool" rollout --policy bad.demo > out 2> err
  got=$?
  [ $got -eq 1 ] && grep -q -- "$text" err && [ "$(wc -l < err)" -eq 1 ] ||
    { echo "script '$*': exit status $got, stderr: $(cat err)"; failed=1; }
}

# The paper's pair pulls the block out and the tower stands, from its own start and from others.
for seed in 1 2; do
  for noise in 0 0.002; do
    "$tool" rollout --task jenga --set pair=paper --set reset_noise=$noise --policy demo --seed $seed --json > out || failed=1
    grep -q '"cost_mean":\[0.0,' out && grep -q '"success_rate":1.0' out ||
      { echo "the paper's pair, seed $seed, noise $noise: $(cat out)"; failed=1; }
  done
done

# A hand throws as well from an arm, which holds its pose.
"$tool" rollout --task hand_over_safe_finger --set arm=ur5e --policy demo --episodes 20 --envs 10 --json > out || failed=1
sed -n 's/.*"success_rate":\([0-9.]*\).*/\1/p' out | awk '{ found = $1 > 0.6 } END { exit !found }' ||
  { echo "hand over from arms: $(cat out)"; failed=1; }

# Roles name the joints of any hand.
cat > roles.demo <<'SCRIPT'
task grasp
set hand=allegro
set arm=ur5e
set arm_range=0
phase close
  right.first.proximal = 40deg over 0.2
  right.*.middle = 30deg
  right.thumb.lateral = 60deg
SCRIPT
"$tool" rollout --policy roles.demo > out 2> err || { echo "roles: $(cat err)"; failed=1; }
sed 's/first.proximal/first.elbow/' roles.demo > elbow.demo
"$tool" rollout --policy elbow.demo > out 2> err && { echo 'an elbow of a finger was taken'; failed=1; }
grep -q 'no action right.first.elbow' err || { echo "elbow: $(cat err)"; failed=1; }

t='task grasp'
bad "no line 'task NAME'" 'phase a'
bad 'no phase' "$t"
bad 'line 2: .* before the first phase' "$t" 'for 1'
bad 'line 2: .vigour. is not a setting' "$t" 'teach vigour=1' 'phase a'
bad 'line 2: beta=2 is not a number of 0 .. 1' "$t" 'teach beta=2' 'phase a'
bad 'line 2: dagger=1.5 is not a whole number' "$t" 'teach dagger=1.5' 'phase a'
bad 'line 2: .learn. is not key=value\|line 2: .hidden. is not key=value' "$t" 'learn hidden' 'phase a'
bad 'line 3: the task has no action left.WRJ0' "$t" 'phase a' 'left.WRJ0 = 1'
bad "line 3: 'much' is not an action" "$t" 'phase a' 'right.WRJ0 = much'
bad 'line 3: the observation has no object.smell' "$t" 'phase a' 'until object.smell[0] < 1'
bad 'line 3: the observation has no object.position' "$t" 'phase a' 'until object.position[3] < 1'
bad 'line 3: the observation has no inf' "$t" 'phase a' 'right.WRJ0 follows inf by object.position[2] gain 1'
bad 'line 3: the observation has no object.position.1e9.' "$t" 'phase a' 'until object.position[1e9] < 1'
bad 'line 3: the observation has no object.position' "$t" 'phase a' 'until object.position[99999999999999999999] < 1'
bad "line 3: '-1' is negative" "$t" 'phase a' 'right.WRJ0 follows 0.1 by object.position[2] gain 1 limit -1'
bad "line 3: 'later' is one word too many" "$t" 'phase a' 'right.WRJ0 = 1 later'
bad "line 3: expected 'by'" "$t" 'phase a' 'right.WRJ0 follows 1'
bad 'line 2: .*' "$t" 'phase'
arm='set arm=ur5e'
bad 'line 3: .* right hand cannot be moved to a place: no arm' "$t" 'phase a' 'right.palm = 0 0 0'
bad 'line 4: .* right hand cannot be moved to a place: set arm_range=0' "$t" "$arm" 'phase a' 'right.palm = 0 0 0'
bad 'line 5: the arm does not reach that far' "$t" "$arm" 'set arm_range=0' 'phase a' 'right.palm = 0 0 9'
bad 'line 5: the right hand has no xf_tip' "$t" "$arm" 'set arm_range=0' 'phase a' 'right.xf_tip = 0 0 1'
bad 'line 3: the task has no hand on the left' "$t" 'phase a' 'left.palm = 0 0 1'
bad "line 3: 'up' is not a place" "$t" 'phase a' 'right.palm = 0 0 up'
bad "line 3: '-1' is negative" "$t" 'phase a' 'right.palm = 0 0 1 over -1'

# A hand goes where it is told: followers steer its base, degrees its joints, conditions end phases.
cat > fly.demo <<'SCRIPT'
task catch_underarm_safe_joint
set base_limit=10
set fall_height=-10
set base_angles=signed
phase up
  until right.base_position[2] > 0.55
  right.z follows 0.6 by right.base_position[2] gain 20
  right.MFJ2 = 45deg
phase hold
  right.z follows object.goal + 0 by right.base_position[2] gain 0
  right.MFJ2 = -1 over 0.2
SCRIPT
sed 's/object.goal/goal.position[2]/' fly.demo > good.demo
"$tool" rollout --policy fly.demo > out 2> err && { echo "an unknown field was taken"; failed=1; }
"$tool" rollout --policy good.demo --episodes 1 --out fly.csv > out 2> err || { cat err; failed=1; }
[ "$(wc -l < fly.csv)" -eq 76 ] || { echo "the flight ended early"; failed=1; }

"$tool" eval --task bandit --policy demo > out 2> err
[ $? -eq 1 ] && grep -q 'no demonstration of bandit' err || { echo "bandit: $(cat err)"; failed=1; }
exit $failed
