#!/bin/sh
# test_tool_data.sh TOOL [--write]: `data make` gives the recorded hashes (tests/golden/data.txt), for any number of threads the
# same bytes, whole episodes on both sides of the limit; `data info` reads them, and what numpy saved again, to the same hash.
# --write: writes the rows of this machine's kernels (redman info) into the golden file. Bundled policies act in some of the sets, and
# their actions differ in the last bits between kernels. Builds with -DREDMAN_KERNELS=2 and 3 write the other rows.
. "$(dirname "$0")/tool.sh"
golden=$here/../golden/data.txt

# one NAME FILE: the value of "NAME" in a line of JSON.
one() { sed -n "s/.*\"$1\":\"*\([^,\"}]*\).*/\1/p" "$2"; }

rows() {
  for set in 'bandit 300' 'two_state 300' 'ball_run 1000' 'car_circle 1000' 'point_goal1 1000' 'hand_over_safe_finger 1000' \
             'jenga 200' 'hand_over_wall 400' 'OfflineDroneCircle-v0 900' 'recall 400'; do
    # shellcheck disable=SC2086
    set -- $set
    "$tool" data make "$1" --rows "$2" --seed 3 --out "$1.npz" --json > "$1.json" 2> err || { echo "$1:"; cat err; } >&2
    echo "$1 $2 $(one hash "$1.json")"
  done
}
rows > now
grep -q ' $' now && { echo 'a set was not made'; failed=1; }
"$tool" info --json > info.json
kernels=$(one kernels info.json)
[ "$kernels" != base ] || kernels=x86-64-v2 # of other processors: the same bytes
sed "s/^/$kernels /" now > mine
if [ "${2:-}" = --write ]; then
  grep -v -e '^#' -e "^$kernels " "$golden" > others
  { echo '# kernels, redman data make TASK --rows N --seed 3: hash of the arrays (test_tool_data.sh)'; sort -s -k 1,1 mine others; } > "$golden.new"
  mv "$golden.new" "$golden"
  exit 0
fi
grep "^$kernels " "$golden" | diff - mine || { echo 'the hashes of data sets moved; bash cmake/regenerate.sh writes them'; failed=1; }

# The same bytes for any number of threads; others for another seed.
for threads in 1 2 3; do
  "$tool" data make hand_over_safe_finger --rows 1000 --seed 3 --threads $threads --out threads.npz > /dev/null || failed=1
  cmp -s hand_over_safe_finger.npz threads.npz || { echo "$threads threads: other bytes"; failed=1; }
done
"$tool" data make ball_run --rows 1000 --seed 4 --out other.npz --json > other.json || failed=1
[ "$(one hash other.json)" != "$(one hash ball_run.json)" ] || { echo 'another seed gives the same set'; failed=1; }

# Both sides of the limit, and whole episodes.
for task in ball_run car_circle point_goal1 hand_over_safe_finger; do
  "$tool" data make $task --rows 6000 --out wide.npz --json > wide.json || failed=1
  for share in none to_twice,above_twice; do
    sum=0
    for name in $(echo "$share" | tr , ' '); do sum=$(awk "BEGIN { print $sum + $(one "$name" wide.json) }"); done
    awk "BEGIN { exit !($sum > 0.04) }" || { echo "$task: a share of $sum has cost: $share"; failed=1; }
  done
  grep -q '"unfinished":\[\]' wide.json || { echo "$task: it has unfinished episodes"; failed=1; }
  [ "$(one rows wide.json)" -ge 6000 ] || { echo "$task: fewer rows than asked for"; failed=1; }
done

# The published lengths, by both names.
"$tool" data make ball_run --preset dsrl --rows 500 --out a.npz --json > a.json || failed=1
"$tool" data make OfflineBallRun-v0 --rows 500 --json > b.json || failed=1
cmp -s a.npz OfflineBallRun-v0.npz || { echo 'the published name gives another set than its preset'; failed=1; }
grep -q '"length":\[100.0,100.0,100.0,100.0,100.0\]' a.json || { echo 'OfflineBallRun-v0 has not 100 rows an episode'; cat a.json; failed=1; }
"$tool" data make --list | grep -q 'OfflineCarCircle-v0  *car_circle  *300' || { echo 'the list of published sets has no car_circle of 300'; failed=1; }

# What is read has the hash that was made, also when numpy saved it again, packed, or without what only we write.
for task in two_state ball_run hand_over_safe_finger; do
  "$tool" data info $task.npz --json > info.json || failed=1
  [ "$(one hash info.json)" = "$(one hash $task.json)" ] || { echo "$task: info has another hash"; failed=1; }
done
if python3 -c 'import numpy' 2> /dev/null; then
  python3 -c '
import numpy as np
a = dict(np.load("two_state.npz"))
np.savez_compressed("again.npz", **a)
assert a["obs"].dtype == np.float32 and a["final_obs"].shape == (len(a["source"]), a["obs"].shape[1])
ends = a["terminated"] | a["truncated"]
assert ends.sum() == len(a["source"]) and ends[a["episode_begin"][1:] - 1].all()
assert not (a["terminated"] & a["truncated"]).any()
cut = {k: v[:-1] if len(v.shape) and len(v) == len(a["obs"]) else v for k, v in a.items()}
del cut["final_obs"], cut["source"], cut["episode_begin"]
np.savez("cut.npz", **cut)
none = {k: v[:2] for k, v in cut.items() if len(v.shape) and len(v) == len(cut["obs"])}
np.savez("none.npz", **none)
bad = {k: v.copy() for k, v in a.items()}
bad["obs"][5, 0] = np.nan
np.savez("nan.npz", **bad)' || failed=1
  "$tool" data info again.npz --json > info.json || failed=1
  [ "$(one hash info.json)" = "$(one hash two_state.json)" ] || { echo 'numpy saved it again: another hash'; failed=1; }
  "$tool" data info cut.npz > info || failed=1
  "$tool" data info nan.npz > /dev/null 2> err && { echo 'NaN is taken'; failed=1; }
  grep -q 'obs: row 5 is not finite' err || { echo 'NaN is not named'; cat err; failed=1; }
  # of no whole episode nothing is known, which is not 0
  "$tool" data info none.npz > info.none && "$tool" data info none.npz --json > none.json || failed=1
  grep -q '^return  *-  *-  *-  *-  *-$' info.none && grep -q '"success_rate":null' none.json ||
    { echo 'numbers of no whole episode'; cat info.none none.json; failed=1; }
  grep -q '1 unfinished' info || { echo 'an episode without an end is not said to be unfinished'; cat info; failed=1; }
fi

# Scores by a set: its least return is 0 and its largest 1, and costs are shares of its limits.
"$tool" eval --task ball_run --policy trained --episodes 4 --data a.npz --set max_steps=100 --json > score.json || failed=1
awk -v r="$(one return_mean score.json)" -v least="$(one return_min score.json)" -v most="$(one return_max score.json)" \
    -v score="$(sed 's/.*"score":{"return":\([^,]*\),.*/\1/' score.json)" \
    'BEGIN { want = (r - least) / (most - least); d = want - score; exit !(most > least && d < 1e-6 && d > -1e-6) }' ||
  { echo 'the normalised return is not (R - least) / (most - least)'; cat score.json; failed=1; }
[ "$(grep -o '"limit":[0-9.]*' score.json | sort -u | tr '\n' ' ')" = '"limit":10.0 "limit":20.0 "limit":40.0 ' ] ||
  { echo 'the scores are not at the three published limits'; failed=1; }

# Recordings of other commands are read too; what is none is refused.
"$tool" rollout --task two_state --episodes 3 --record rollout.npz > /dev/null || failed=1
"$tool" data info rollout.npz | grep -q 'in 3 episodes' || { echo 'a recorded rollout is not read'; failed=1; }
head -c 3000 ball_run.npz > short.npz
wrong 1 'not a complete archive' data info short.npz
wrong 1 'nearest is ball_run.npz' data info bal_run.npz
wrong 2 'nearest is ball_run' data make bal_run
wrong 2 'nearest is OfflineBallRun-v0' data make OfflineBalRun-v0
wrong 2 'no set of task jenga' data make jenga --preset dsrl
wrong 2 'leave out ball_run' data make ball_run --list
"$tool" data make "$here/../../examples/scenes/press.task" --rows 50 --out press.npz | grep -q '^press_button: ' || { echo 'no set of a task file'; failed=1; }
# A set of another task, or of other lengths, is no measure.
wrong 2 'a set of task ball_run, not of car_run' eval --task car_run --policy trained --episodes 1 --data ball_run.npz
wrong 2 'give --set max_steps=' eval --task ball_run --policy trained --episodes 1 --set max_steps=7 --data ball_run.npz
wrong 2 'end in .npz' data make ball_run --out set.hdf5
wrong 2 'are in every mixture' data make ball_run --policy random
wrong 2 'rows' data make ball_run --rows 0
exit $failed
