#!/bin/sh
# test_tool_record.sh TOOL: recorded rollouts. numpy opens them (77, a skip of that part, where no python3 has numpy);
# --policy plays them again to the same state hash; files that are not whole get one line.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
python=
for candidate in /usr/bin/python3 python3; do
  $candidate -c 'import numpy' 2> /dev/null && { python=$candidate; break; }
done
value() { sed "s/.*\"$1\":\"*\\([^\",}]*\\).*/\\1/" "$2"; }

"$tool" train --task ball_run --envs 4 --steps 400 --set max_steps=20 --set horizon=20 --out run > out 2> err || say "$(cat err)"
# replay NAME FLAGS...: records, plays again: the same hash, and a recording of that is the same file
replay() {
  name=$1
  shift
  "$tool" rollout "$@" --record "$name.npz" --json > "$name.out" 2> err || { say "$name: $(cat err)"; return; }
  states=
  case "$*" in *--record-states*) states=--record-states ;; esac
  # shellcheck disable=SC2086
  "$tool" rollout --policy "$name.npz" --threads 2 --record again.npz $states --json > again.out 2> err || { say "$name: $(cat err)"; return; }
  for key in hash return_mean length_mean steps; do
    [ "$(value $key "$name.out")" = "$(value $key again.out)" ] || say "$name: $key is $(value $key again.out), not $(value $key "$name.out")"
  done
  [ "$(value recorded_hash again.out)" = "$(value hash "$name.out")" ] || say "$name: $(cat again.out)"
  cmp "$name.npz" again.npz || say "$name: a recording of the replay differs"
}
hand='--task hand_over_safe_finger --set max_steps=12'
# shellcheck disable=SC2086
{
  replay random $hand --policy random --envs 3 --episodes 7 --seed 5
  replay hold $hand --policy hold --envs 2 --episodes 4 --seed 5 --record-states
  replay demo --task grasp --policy demo --envs 2 --episodes 3
}
replay trained --policy run --envs 4 --episodes 9 --seed 18446744073709551615
replay falls --task hand_over_safe_finger --policy hold --envs 3 --episodes 12
awk -F'"length_mean":' '{ exit !($2 + 0 < 75) }' falls.out || say "no episode fell: all have one length"
hull='0.03,0,0;-0.03,0,0;0,0.03,0;0,-0.03,0;0,0,0.04;0,0,-0.04;0.01,0.01,0.03'
replay hull --task hand_over_safe_finger --policy random --set object=hull --set "hull=$hull" --set max_steps=5 --episodes 2
grep -q "\"file\":\"random.npz\",\"steps\":84" random.out || say "$(cat random.out)"
# any number of worlds plays each episode as it was
"$tool" rollout --task ball_run --policy hold --set max_steps=5 --json > still.out && "$tool" rollout --task ball_run --policy hold --set max_steps=5 --noise 0.3 --json > moved.out
! cmp -s still.out moved.out || say "--noise adds nothing to one world"
"$tool" rollout --policy random.npz --envs 1 --json > one.out || say "one world does not replay three"
[ "$(value return_mean one.out)" = "$(value return_mean random.out)" ] || say "one world: $(cat one.out)"
"$tool" rollout --policy random.npz --episodes 2 --json > two.out || say "two of seven episodes"
"$tool" eval --policy trained.npz --episodes 9 --json > eval.out || say "eval does not take a recording"
[ "$(value return_mean eval.out)" = "$(value return_mean trained.out)" ] || say "eval: $(cat eval.out)"
"$tool" render --policy hold.npz --step 3 --size 32x32 --out now.png > out 2> err || say "render: $(cat err)"
# shellcheck disable=SC2086
"$tool" rollout $hand --policy random --envs 3 --episodes 7 --seed 5 --threads 3 --record threads.npz > out && cmp random.npz threads.npz ||
  say "threads change the file"

# named columns
# shellcheck disable=SC2086
"$tool" rollout $hand --policy random --envs 3 --episodes 7 --seed 5 --record random.csv --out old.csv --json > csv.out || say "no .csv"
[ "$(value steps csv.out)" = 84 ] && [ "$(value table csv.out)" = old.csv ] || say "$(cat csv.out)"
awk -F, 'NR == 1 { n = NF } NF != n { wrong = 1 } END { exit wrong || NR != 85 }' random.csv || say "random.csv has other rows than steps"
for column in 'time (s)' episode 'right.joint_velocity\[23\] (5 rad/s)' 'action\[39\]' cost.cost terminated; do
  head -n1 random.csv | tr , '\n' | grep -qx "$column" || say "random.csv has no column $column"
done
# the same rewards in the same order as --out has
cut -d, -f3 old.csv > rewards
column=$(head -n1 random.csv | tr , '\n' | grep -nx reward | cut -d: -f1)
cut -d, -f"$column" random.csv | cmp -s - rewards || say "random.csv has other rewards than old.csv"

# what is no recording, or of something else: one line, status 1, nothing written
refused() {  # refused WHAT WORDS FLAGS...
  what=$1 words=$2
  shift 2
  "$tool" rollout "$@" > out 2> err
  status=$?
  { [ $status -eq 1 ] || [ $status -eq 2 ]; } && [ "$(wc -l < err)" -eq 1 ] && grep -q "$words" err || say "$what: $status $(cat err)"
}
size=$(stat -c %s hold.npz)
for n in 0 1 21 22 100 4096 $((size / 2)) $((size - 1)) $((size - 22)); do
  head -c "$n" hold.npz > cut.npz
  refused "$n bytes of a recording" 'cut.npz is not a recorded rollout' --policy cut.npz
done
echo 'time,episode' > text.npz
refused "a text" 'text.npz is not a recorded rollout' --policy text.npz
refused "no file" 'cannot read none.npz' --policy none.npz
refused "another task" 'was recorded in task hand_over_safe_finger, not in grasp' --policy hold.npz --task grasp
refused "other options" 'hold.npz does not fit' --policy hold.npz --set object=ball
refused "too many episodes" 'has 4' --policy hold.npz --episodes 5
refused "a seed" 'takes no seed' --policy hold.npz --seed 5
refused "states as text" 'cannot hold states' --policy zero --record states.csv --record-states
refused "no folder" 'cannot write none/x.npz' --policy zero --record none/x.npz
"$tool" export --policy hold.npz --c x.c > out 2> err
[ $? -eq 2 ] && grep -q 'it is not a network.*redman train --from' err || say "a recording was exported: $(cat err)"
"$tool" eval --policy hold.npz --episodes 9 > out 2> err
[ $? -eq 1 ] && grep -q 'hold.npz has 4 episodes' err || say "eval of too many episodes: $(cat err)"
echo old > full.npz
# shellcheck disable=SC2086
( ulimit -f 8; exec "$tool" rollout $hand --episodes 20 --record full.npz ) > out 2> err && say "a full disk is not noticed"
[ "$(cat full.npz)" = old ] && grep -q 'full.npz: File too large' err || say "a full disk: $(cat err)"
[ -z "$(find . -name '*.tmp-*')" ] || say "left over: $(find . -name '*.tmp-*')"

[ $failed -eq 0 ] || exit 1
[ -n "$python" ] || { echo "skipped the part of numpy: no python3 has it"; exit 77; }
$python "$here/record/check.py" || exit 1
# arrays that numpy has packed play as well
$python -c 'import numpy as np; np.savez_compressed("packed.npz", **np.load("random.npz"))' || say "numpy cannot save it again"
"$tool" rollout --policy packed.npz --json > packed.out 2> err || say "packed: $(cat err)"
[ "$(value hash packed.out)" = "$(value hash random.out)" ] || say "packed: $(cat packed.out)"
# arrays that are missing or of another kind
spoil() {  # spoil WORDS PYTHON
  $python -c "import numpy as np; a = dict(np.load('hold.npz')); $2; np.savez('spoilt.npz', **a)" || say "python: $2"
  refused "$2" "$1" --policy spoilt.npz
}
spoil 'no array action' 'del a["action"]'
spoil 'no array metadata' 'del a["metadata"]'
spoil 'does not have the type or shape' 'a["action"] = a["action"].astype("f8")'
spoil 'does not have the type or shape' 'a["action"] = a["action"][0]'
spoil 'Fortran order' 'a["action"] = np.asfortranarray(a["action"])'
spoil 'first steps of its episodes' 'a["episode_begin"] = a["episode_begin"] + 1'
spoil 'has no step' 'a["episode_begin"][1] = 0'
spoil 'does not have one state for each episode' 'a["state"] = a["state"][1:]'
spoil 'does not fit' 'a["state"] = a["state"] ^ 255'
spoil 'has 39 actions, but the task has 40' 'a["action"] = a["action"][:, 1:].copy()'
spoil 'its format is not redman rollout 1' 'a["metadata"] = np.array("{\"format\": \"x\"}")'
spoil 'not a recorded rollout' 'a["metadata"] = np.array("{\"format\": ")'
spoil 'does not fit' 'a["metadata"] = np.array(str(a["metadata"]).replace("max_steps=12", "max_steps=13"))'
spoil 'did not end there' 'a["action"] = np.vstack([a["action"]] * 2); a["episode_begin"][-1] = len(a["action"])'
# an action that is no number ends an episode, as it does in the library
$python -c "import numpy as np; a = dict(np.load('hold.npz')); a['action'][5, 3] = np.nan; np.savez('nan.npz', **a)"
refused 'a NaN' 'did not end there' --policy nan.npz
exit $failed
