#!/bin/sh
# test_tool_slips.sh TOOL: what a command line says twice, what has no effect and what cannot be written is refused before the
# work, or said.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
# told TEXT COMMAND...: the tool ends with 0, and stderr has the text.
told() { text=$1; shift; wrong 0 "$text" "$@"; }
# silent TEXT COMMAND...: it ends with 0, and stderr does not have the text.
silent() {
  text=$1
  shift
  "$tool" "$@" > out 2> err || say "$*: $(cat err)"
  grep -q -- "$text" err && say "$*: stderr has '$text'"
}
one='--task ball_run --episodes 1 --set max_steps=3'
small='--task ball_run --envs 2 --steps 20 --set max_steps=10 --set horizon=10 --set hidden=8 --set minibatches=1 --no-tensorboard'

# One option, once.
wrong 2 'option Max-Steps is given twice' eval $one --set Max-Steps=4
wrong 2 'option hidden is given twice' train $small --set hidden=9 --out no
wrong 2 'option rounds is given twice' eval $one --policy hold --shield predict:rounds=2,rounds=3
wrong 2 'option samples is given twice' plan $one --samples 2 --plan samples=3
wrong 2 'option samples is given twice' eval $one --policy plan:samples=2,samples=3
wrong 2 'option passes is given twice' bench update --set passes=2 --set passes=3
wrong 2 'it is given 2 times' plan $one --samples 2 --samples 3

wrong 2 'both are the limit on column 0; give one; nothing was started' sweep --tasks ball_run --cost-limit 3 --set cost_limit=4 --out no
wrong 2 'option hidden is given twice.*; nothing was started' sweep --tasks ball_run --set hidden=8 --vary hidden=4,8 --out no
wrong 2 'column cost has two limits' plan $one --cost-limit 3 --cost-limit cost=4

# What is here a flag.
wrong 2 'give --modality' bench observe --set modality=voxels
wrong 2 'give --horizon' bench policy --set horizon=4
wrong 2 'it is the flag --seed' train $small --set seed=3 --out no

# Names of other libraries, members of the library's structs, and CLI11's sentences.
wrong 2 'here it is called discount' train $small --set gamma=0.9 --out no
wrong 2 'here it is called learning_rate' train $small --set lr=0.1 --out no
wrong 2 '^redman: --envs: 0 is outside \[1, 65536\]' train --task ball_run --envs 0 --out no
wrong 2 '^redman: --threads: -1 is outside' eval $one --threads -1
wrong 2 '^redman: --obs: 0 is outside' bench update --obs 0
wrong 2 '^redman: --episodes: 0 is outside 1 .. 1000000;' eval --episodes 0
wrong 2 '^redman: --validation: 1 is outside 0 .. 0.9;' train --validation 1
wrong 2 '^redman: --rows: 0 is outside 1 .. 1000000000;' data make ball_run --rows 0
wrong 2 '^redman: --steps: it needs a value;' train --steps
wrong 2 '^redman: extra: the command takes no such argument' train extra
wrong 2 '^redman: argument folders is missing' plot
wrong 2 '^redman: --int8 is for --c, which is missing' export --policy x --int8

# Steps of an episode.
wrong 2 '--step 9: the episode ends at step 3' render --task ball_run --set max_steps=3 --step 9 --out a.png
wrong 2 '--from 9: the episode ends at step 3' render --task ball_run --set max_steps=3 --strip 2 --from 9 --out a.png
wrong 2 '--from 9: the episode ends at step 3' render --task ball_run --set max_steps=3 --glb a.glb --from 9
wrong 2 'it is before --from 2' render --task ball_run --strip 2 --from 2 --to 1 --out a.png
wrong 2 'give --step for one picture' render --task ball_run --to 1 --out a.png
told '--to 9: the episode ends at step 3' render --task ball_run --set max_steps=3 --size 8x8 --strip 2 --to 9 --out strip.png

# Names of files, and files that cannot be written: before the work, and nothing is left.
wrong 2 'does not end in .png' render --task ball_run --out a.txt
wrong 2 'does not end in .glb' render --task ball_run --glb a.html
wrong 2 'does not end in .csv' rollout $one --out a.png
wrong 2 'does not end in .npz or .csv' rollout $one --record a.txt
wrong 2 'does not end in .npz or .csv' plan $one --record a.txt
wrong 2 'does not end in .svg' plot none --out a.png
wrong 2 'does not end in .html' report none --html a.png
wrong 2 'does not end in .rdm' learn --from none.npz --out a.npz
wrong 2 'does not end in .npz' train $small --from demo --save-recording a.csv --out no
wrong 2 'does not end in .png' objects --sheet a.csv
wrong 2 'does not end in .robot' robot shadow_hand --out a.urdf
wrong 2 'does not end in .object' object egg --out a.stl
wrong 1 'cannot write none/a.rdm: .*there is no folder none' learn --from none.npz --out none/a.rdm
wrong 1 'cannot write none/a.npz' data make ball_run --out none/a.npz
wrong 1 'cannot write none/a.mcap' data convert none.npz none/a.mcap
wrong 1 'cannot write none/a.npz' train $small --from demo --save-recording none/a.npz --out no
wrong 1 'cannot write none/a.svg' plot none --out none/a.svg
wrong 1 'cannot write none/a.png' objects --sheet none/a.png
wrong 1 'cannot write none/a.object' object none.stl --out none/a.object
[ "$(ls)" = "err
out
strip.png" ] || say "files are left behind: $(ls)"
touch taken
wrong 1 'taken' sweep --tasks ball_run --out taken/sweep
wrong 1 'taken' train --task grasp --from demo --out taken/run
grep -q 'teacher:' err && say "the folder is tried after the teacher has played"

# Beside --from: what does nothing is refused, what it sets is said.
wrong 2 'td3 cannot begin with a teacher; .* --algo ppo_lag' train --task grasp --algo td3 --from demo --out no
told "--from demo sets task hand_over_safe_finger; .* init_std=0.03 .*--set and flags override these" \
  train --from demo --envs 2 --steps 20 --set max_steps=10 --set horizon=10 --set hidden=8 --set minibatches=1 --set std_min=0.02 \
  --demo-decisions 4 --clone-epochs 1 --dagger 0 --save-recording shown.npz --out shown
grep '^--from' err | grep -q 'std_min' && say "it sets what --set gives: $(cat err)"
hand='--envs 2 --steps 20 --set max_steps=10 --set horizon=10 --set hidden=8 --set minibatches=1'
for flags in '--dagger 1' '--beta 0.4' '--demo-decisions 4' '--noise 0.1' '--save-recording again.npz'; do
  wrong 2 "^redman: ${flags%% *} has no effect with --from shown.npz" train $hand --from shown.npz $flags --out no
done
for flags in '--beta 0.4' '--demo-decisions 4' '--noise 0.1' '--save-recording again.npz' '--clone-rate 2e-3' '--validation 0.2' --success-only; do
  wrong 2 "^redman: ${flags%% *} has no effect with --from shown" train $hand --from shown $flags --out no
done
wrong 2 '--pretrain-epochs has no effect: there are no clouds' train $hand --pretrain-epochs 2 --out no
wrong 2 'there is no policy to begin with; give --dagger' train $small --from plan --out no
silent 'no effect' train $hand --from shown --beta 0.5 --noise 0.05 --out defaults  # that are written out
[ ! -e no ] || say "a refused call left a folder"

# Options that are off, and flags without what they are for.
told 'cameras=front: it has no effect while modality is state' eval $one --set cameras=front
silent 'no effect' eval $one --set modality=depth --set cameras=front
told 'budget_discount=0.9: it has no effect while budget is none' eval $one --set budget_discount=0.9
told 'memory_chunk=4: it has no effect while memory is empty' train $small --set memory_chunk=4 --out idle
silent 'no effect' eval --policy idle --episodes 1
wrong 2 'knots 9 is above the horizon, 4' plan $one --horizon 4 --plan knots=9
wrong 2 'hold does not' eval $one --policy hold --stochastic
wrong 2 '--probes is for --probe, which is missing' export --policy idle --probes 3 --c a.c
wrong 2 '--side is for --sheet, which is missing' objects --side 32

wrong 2 '--overwrite is for --out, which is missing' train $small --overwrite
wrong 2 'it is not one of auto, urdf, mjcf, robot' robot x.urdf --format obj
told '--policy demo: task ball_run has none' baseline --task ball_run --policy demo

# What the library calls by its structs and functions is said by flags.
wrong 2 '^redman: --threads: 300 is outside' rollout --threads 300
wrong 1 'redman train --from gives one' bench update --set imitation=1 --samples 64 --seconds 0.1
wrong 2 'set option episode_steps' bench update --set terminal_cost=1

# Robots: their own joints can be set, and one that nothing uses is said.
"$tool" eval --task grasp --set hand=barrett --set joint.bh_j11_joint.kp=20 --policy zero --episodes 1 > /dev/null || say 'a joint of another hand'
"$tool" eval --task grasp --set arm=ur5e --set link.wrist_3_link.mass=2 --policy zero --episodes 1 > out || say 'a link of an arm'
grep -q 'of grasp: return' out || say 'the task is not named'
wrong 2 'nearest is joint.bh_j11_joint.kp' eval --task grasp --set hand=barrett --set joint.bh_j11_jint.kp=20 --policy zero
if "$tool" robot barrett_bh282 --name other --out other.robot > /dev/null 2>&1; then
  told 'nothing uses robot other; give --set hand=other' eval --task grasp --robot other.robot --policy zero --episodes 1
  told 'nothing uses robot other' tasks grasp --robot other.robot
  silent 'nothing uses' tasks grasp --robot other.robot --set hand=other
  silent 'nothing uses' eval --task grasp --robot other.robot --set hand=other --policy zero --episodes 1
fi

# A policy away from its run.
cp idle/policy.rdm alone.rdm
for command in 'eval --episodes 1' 'rollout' 'render --size 8x8 --out b.png'; do
  told 'alone.rdm: no config.json of its run' $command --policy alone.rdm
done
silent 'no config.json' eval --policy idle --episodes 1

# The first signal is answered.
"$tool" train --task ball_run --envs 8 --steps 100000000 --set horizon=500 --out long > out 2> err &
pid=$!
for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do grep -q 'training in' err && break; sleep 0.5; done
sleep 1
kill -INT $pid
wait $pid || say "after SIGINT the exit status is $?"
grep -q 'stopping after this epoch; a second signal stops at once' err || say "SIGINT is not answered: $(cat err)"
exit $failed
