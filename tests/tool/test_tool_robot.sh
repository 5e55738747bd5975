#!/bin/sh
# test_tool_robot.sh TOOL: robots are listed, read, written and read back; what cannot be one is refused with its line;
# --robot loads a file before the worlds are made.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
files=$here/../import

"$tool" robots --json > row || say "robots: $(cat row)"
grep -q '"name":"shadow_hand","alias":[^,]*,"kind":"hand","joints":24,"driven":20,"mass":5.0' row || say "robots: $(cat row)"
"$tool" robots --markdown | grep -q '^| `shadow_hand` |' || say "robots --markdown"

"$tool" robot "$files/hand.urdf" --json > row 2> err
if grep -q "without the readers" row err; then
  echo "no importers in this tool"
  exit 77
fi
grep -q '"name":"plain_hand","kind":"hand","links":8,"joints":8,"driven":7,"shapes":9,' row || say "hand.urdf: $(cat row err)"
grep -q '"dropped":\["line 4: material grey","line 11: visual","line 140: gazebo","line 141: transmission t"\]' row || say "dropped: $(cat row)"
"$tool" robot "$files/hand.xml" --check > text 2>&1 || say "hand.xml: $(cat text)"
grep -q '^  line 22: sensor (in hand_drives.xml)$' text || say "hand.xml: $(cat text)"
grep -q '^check:$' text || say "no check: $(cat text)"

# Text gives back what was read, from files and from the library's own.
for from in "$files/hand.xml" "$files/gripper.urdf" "$files/arm.xml" shadow_hand; do
  "$tool" robot "$from" --out one.robot > out 2>&1 || say "$from: $(cat out)"
  "$tool" robot one.robot --out two.robot > out 2>&1 || say "$from again: $(cat out)"
  cmp one.robot two.robot || say "$from reads back otherwise"
done
# Roles by flags.
"$tool" robot "$files/hand.urdf" --palm palm --tips index_tip,thumb_distal --name pinch --json |
  grep -q '"name":"pinch".*"fingers":\["index","thumb"\]' || say "--tips"

refused() { # refused TEXT ARGUMENTS...
  want=$1
  shift
  "$tool" "$@" --json > row 2> err && say "$* was not refused"
  grep -qF -- "$want" err || say "$*: $(cat err)"
  grep -q '^{"error":' row || say "$* prints $(cat row)"
}
sed 's/<mass value="0.02"/<mass value="0"/' "$files/hand.urdf" > bad.urdf
refused 'bad.urdf: line 26: mass: link index_proximal: the mass 0 is not above 0' robot bad.urdf
refused 'shadow_hnd: there is no such file, and no robot of that name; nearest is shadow_hand' robot shadow_hnd
sed 's/\.obj/.dae/' "$files/gripper.urdf" > far.urdf
refused 'far.urdf: line 50: mesh: mesh package://gripper_description/meshes/pad.dae: it was not found' robot far.urdf
"$tool" robot far.urdf --skip-meshes > out 2>&1 || say "--skip-meshes: $(cat out)"
refused '--density: it is for URDF only' robot "$files/hand.xml" --density 1000
# Flags do with a robot of the list what they do with its file.
refused '--density: it is for URDF and MJCF only' robot shadow_hand --density 1000
"$tool" robot shadow_hand --name other --out other.robot > out 2>&1 || say "shadow_hand --name: $(cat out)"
grep -q 'alias shadow was dropped: the robot is now called other$' out || say "shadow_hand --name: $(cat out)"
"$tool" robots --robot other.robot | grep -q '^other ' || say "shadow_hand under another name"

# What the library calls by members of a struct is said by the flag, notes included.
printf '%s' '<robot name="two"><link name="a"/><link name="b"/></robot>' > two.urdf
refused 'set --root to one of them' robot two.urdf
refused '--palm: there is no link or site plam' robot "$files/hand.urdf" --palm plam
"$tool" robot "$files/hand.urdf" --root index_proximal > out 2>&1 || say "--root: $(cat out)"
grep -q 'is not below --root' out || say "what is not below --root is not said: $(cat out)"

# A name that is taken: what the text says to do works.
sed 's/"plain_hand"/"shadow_hand"/' "$files/hand.urdf" > twin.urdf
for twin in one.robot twin.urdf; do
  refused "robot shadow_hand: the name is already used: give it another by redman robot $twin --name NAME --out NAME.robot" robots --robot $twin
  "$tool" robot $twin --name renamed --out renamed.robot > out 2>&1 || say "$twin --name: $(cat out)"
  "$tool" robots --robot renamed.robot | grep -q '^renamed ' || say "$twin under another name"
done

# Loaded before the task is made.
"$tool" robot "$files/hand.urdf" --name own_hand --out own.robot > out 2>&1 || say "$(cat out)"
"$tool" robots --robot own.robot | grep -q '^own_hand *hand *8 ' || say "robots --robot: $("$tool" robots --robot own.robot 2>&1)"
"$tool" rollout --task grasp --policy hold --episodes 1 --robot own.robot --set hand=own_hand > out 2>&1 || say "rollout --robot: $(cat out)"
exit $failed
