#!/bin/sh
# test_tool_task_file.sh TOOL: --task takes a file; a run keeps the texts of its task and robots, and goes on without them.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
cp "$here/../../examples/scenes/press.task" press.task
printf '#\ttabs and carriage returns are kept\r\n' >> press.task

"$tool" tasks press.task > out 2> err
if grep -q "without the reader" err; then
  echo "no importers in this tool"
  exit 77
fi
grep -q '^press_button: ' out || say "tasks press.task: $(cat out err)"
grep -q 'cup_mass' out || say "its own option is not listed: $(cat out)"

run() { # run ARGUMENTS...: must be good
  "$tool" "$@" > out 2> err || say "redman $*: $(cat err)"
}
run rollout --task press.task --policy hold --episodes 3 --envs 2 --threads 1 --set max_steps=20 --json
sed 's/.*"hash":"\{0,1\}\([0-9a-f]*\).*/\1/' out > one
run rollout --task press.task --policy hold --episodes 3 --envs 2 --threads 2 --set max_steps=20 --json
sed 's/.*"hash":"\{0,1\}\([0-9a-f]*\).*/\1/' out > two
grep -q '^[0-9a-f]\{8,\}$' one || say "no hash: $(cat one)"
cmp one two || say "the hash depends on threads"
run rollout --task "$here/../../examples/scenes/touch.task" --policy random --episodes 2 --envs 2 --set max_steps=20 --set modality=points --set points=64 --json

# A run remembers what it was made of: the files may go.
"$tool" robot "$here/../import/hand.urdf" --name own_hand --out own.robot > out 2>&1 || say "$(cat out)"
sed 's/^hand = "allegro"/hand = "own_hand"/; s/^name = "press_button"/name = "own_press"/; s/right\.ff/right.index/
s/^start = .*//; s/^drive = .*//; s/^reach = .*//' press.task > own.task
run train --robot own.robot --task own.task --steps 512 --envs 4 --set horizon=32 --set hidden=8 --set max_steps=20 --out run --no-tensorboard
# A limit without a name is for column 0, whatever that is called, and is drawn as its limit.
run train --robot own.robot --task own.task --steps 512 --envs 4 --set horizon=32 --set hidden=8 --set max_steps=20 --cost-limit 5 --out loose --no-tensorboard
run plot run --out one.svg
grep -q 'class="level"' one.svg || say "no limit is drawn"
run plot run loose --out two.svg
grep -q '>ppo_lag: limit 5<' two.svg || say "limits do not tell lines apart: $(grep -o '>ppo_lag[^<]*' two.svg)"
rm -f own.task own.robot
run eval --policy run --episodes 2 --json
grep -q '"task":"own_press"' out || say "eval: $(cat out)"
run render --policy run --size 64x48 --out own.png
run train --resume run --steps 1024
run report run --html report.html --episodes 2 --strip 0
run rollout --task press.task --policy hold --episodes 1 --set max_steps=5

expect() { # expect TEXT ARGUMENTS...: one line with the text
  text=$1
  shift
  "$tool" "$@" > out 2> err && say "redman $* was not refused"
  grep -qF -- "$text" err || say "redman $*: '$(cat err)', expected '$text'"
  [ "$(wc -l < err)" -eq 1 ] || say "redman $*: more than one line: $(cat err)"
}
run eval --task press.task --policy zero --episodes 1 --set max_steps=5 --cost-limit 5 --json
grep -q '"cost_limits":\[5.0\]' out || say "--cost-limit 5: $(cat out)"
expect 'column touch has two limits, 3 and touch=4' eval --task press.task --cost-limit 3 --cost-limit touch=4
expect 'both are the limit on column 0' train --task press.task --cost-limit touch=3 --set cost_limit=4 --out no
sed 's/press_button/press_twice/; /^\[\[success/,$d' press.task > twice.task
sed -n '/^\[\[cost/,/^$/p' press.task | sed 's/"touch"$/"cost"/; s/term = "cost"/term = "touch"/' >> twice.task
run eval --task twice.task --policy zero --episodes 1 --set max_steps=5 --cost-limit 5 --cost-limit cost=6 --json
grep -q '"cost_limits":\[5.0,6.0\]' out || say "another column called cost: $(cat out)"
# What the task itself sets counts when an option is said to have no effect.
sed 's/press_button/press_with_memory/; s/^horizon = 100/&\nmemory = "gru:4"/' press.task > memory.task
run train --task memory.task --steps 64 --envs 2 --set horizon=16 --set hidden=8 --set memory_chunk=4 --set max_steps=20 --no-tensorboard --out memory
grep -q 'no effect' err && say "the task's own memory is overlooked: $(cat err)"
line=$(grep -n '^mass = "$cup_mass"' press.task | cut -d: -f1)
sed 's/"$cup_mass"/"$cup_mas"/' press.task > bad.task
expect "bad.task: line $line: body cup: mass: option cup_mas: unknown; nearest is cup_mass" train --task bad.task
expect 'missing.task' eval --task missing.task
expect 'task own_press: unknown' eval --task own_press
# Another task of the same name is not taken for it.
sed 's/own_press/press_button/g' run/config.json > config && cp config run/config.json
expect 'its task press_button differs from the one of that name that is loaded' eval --task press.task --policy run
exit $failed
