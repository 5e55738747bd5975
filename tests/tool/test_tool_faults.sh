#!/bin/sh
# test_tool_faults.sh TOOL: files and arguments that nobody in his right mind would give get a text in UTF-8 of one
# line and exit status 1 or 2: nothing aborts, hangs, divides by 0 or counts as done.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
byte=$(printf '\377')
escape=$(printf '\033')

# refused WHAT TEXT ARGUMENTS...: within ten seconds, with and without --json, exit status 1 or 2 and the text
refused() {
  what=$1 text=$2
  shift 2
  for json in '' --json; do
    # shellcheck disable=SC2086
    timeout 10 "$tool" "$@" $json > out 2> err
    got=$?
    [ $got -eq 1 ] || [ $got -eq 2 ] || { say "$what $json: exit status $got: $(cat err)"; continue; }
    grep -q -- "$text" err || say "$what $json: stderr has no '$text': $(cat err)"
    [ "$(wc -l < err)" -eq 1 ] || say "$what $json: stderr has $(wc -l < err) lines"
    iconv -f UTF-8 -t UTF-8 err > same 2> /dev/null && cmp -s err same || say "$what $json: stderr is no UTF-8"
    tr -d '\000-\011\013-\037\177' < err | cmp -s - err || say "$what $json: control characters on stderr"
    [ -z "$json" ] || { [ "$(wc -l < out)" -eq 1 ] && grep -q '^{"error":.*}$' out; } || say "$what: stdout is $(cat out)"
    iconv -f UTF-8 -t UTF-8 out > same 2> /dev/null && cmp -s out same || say "$what $json: stdout is no UTF-8"
  done
}

# Names that are no UTF-8, that are cut inside a character, that steer terminals.
long=$(awk 'BEGIN { for (i = 0; i < 40; ++i) printf "\303\251" }')
for name in "$byte" "x$long" "a$byte$long" "${escape}[31mred" "$(printf '\302\233')31m"; do
  for command in tasks algos; do refused "$command with a strange name" unknown $command "$name"; done
  for flag in --task --policy; do refused "eval with a strange $flag" . eval $flag "$name"; done
  refused 'a strange algorithm' unknown train --algo "$name" --out r
  refused 'a strange option' . train --set "$name=1" --out r
  refused 'a strange value' . train --set "object=$name" --out r
  refused 'a strange camera list' . train --task grasp --set "cameras=$name" --out r
  refused 'a strange limit' . train --cost-limit "$name" --out r
  refused 'a strange subcommand' . "$name"
  refused 'a strange flag' . eval "--$name"
  refused 'a strange camera' . render --camera "$name"
  refused 'a strange size' . render --size "$name"
  refused 'a strange folder' . plot "$name"
  refused 'a strange mesh' . hull "$name.obj"
  refused 'a strange film' . render --video "$name" --size 32x24
done
[ ! -e r ] || say "a refused training left a folder"

# A result goes out whatever the path is called.
"$tool" rollout --task ball_run --set max_steps=3 --out "a$byte.csv" --json > out 2> err || say "a path that is no UTF-8: $(cat err)"
[ -s "a$byte.csv" ] && grep -q '^{.*}$' out || say "a path that is no UTF-8: no file or no result"
if [ -c /dev/full ]; then
  "$tool" info > /dev/full 2> err && say "a result that could not be written counts as done"
  grep -q 'cannot write' err || say "no text about a full stdout: $(cat err)"
fi

# Numbers.
for steps in 1e19 1e30 0.5 2.5 nan inf -1 0; do
  refused "--steps $steps" steps train --task ball_run --steps $steps --out r
done
refused '--steps beyond any schedule' epochs train --task ball_run --steps 1e15 --out r
[ ! -e r ] || say "a refused number of steps left a folder"
for limit in nan inf -inf 1e999 cost=nan; do
  for command in 'eval --task ball_run' 'train --task ball_run --out r'; do
    # shellcheck disable=SC2086
    refused "--cost-limit $limit" 'cost-limit' $command --cost-limit $limit
  done
done
for seconds in nan inf 1e300; do
  for bench in step observe update act; do refused "bench $bench --seconds $seconds" seconds bench $bench --seconds $seconds; done
done
refused '--episodes' episodes eval --task ball_run --episodes 2147483647
refused '--size' . render --size 99999999999x9999999999
refused '--size' . render --size 2147483647x2147483647
refused '--probes' . export --policy hold --probes 2147483647 --onnx x

# Meshes: coordinates that qhull would overflow on.
awk 'BEGIN { srand(1); for (i = 0; i < 8; ++i) print "v", rand(), rand(), rand() }' > points.obj
for scale in 1e155 1e308 1e5; do refused "hull --scale $scale" farther hull points.obj --scale $scale; done
for scale in nan inf; do refused "hull --scale $scale" scale hull points.obj --scale $scale; done
printf 'v 1e200 0 0\nv 0 1e200 0\nv 0 0 1e200\nv 0 0 0\n' > huge.obj
refused "a huge mesh" farther hull huge.obj
mkfifo fifo.obj
refused 'a FIFO as a mesh' 'regular' hull fifo.obj

# A demonstration that would clamp to a bound below another.
printf 'task catch_underarm_safe_joint\nphase a\nright.* follows 0.1 by object.position[2] gain 1 limit -1\n' > bad.demo
refused 'a negative bound' 'line 3' rollout --policy bad.demo

# Run folders with a damaged config.json or progress.csv.
"$tool" train --task ball_run --envs 2 --steps 400 --set max_steps=20 --set horizon=50 --eval-every 1 --out run \
  > /dev/null 2> err || { cat err; exit 1; }
damaged() {  # damaged FILE SED-COMMAND: a copy of the run in damaged/
  rm -rf damaged
  cp -r run damaged
  sed "$2" "run/$1" > "damaged/$1"
  cmp -s "run/$1" "damaged/$1" && say "'$2' changes nothing in $1"
}
for member in eval_every checkpoint_every vector_env_nums total_steps; do
  for value in 0 -1 1e300 99999999999999999999 '"a"' null true; do
    damaged config.json "s/\"$member\": [0-9]*/\"$member\": $value/"
    refused "$member $value" "$member" train --resume damaged
  done
done
damaged config.json "s/\"task\": \"ball_run\"/\"task\": \"b$byte\"/"
refused 'a task that is no UTF-8' . train --resume damaged
refused 'a task that is no UTF-8' . plot damaged
damaged config.json 's/"task": "ball_run"/"task": "b\\u001b[31m"/'
refused 'a task that steers terminals' . plot damaged
damaged progress.csv 's/Metrics.EpCost/Metrics\/EpRet/'
refused 'a column twice' "Metrics/EpRet" plot damaged
damaged progress.csv '2,$s/[^,]*/1e308/4'
"$tool" plot damaged --out big.svg > /dev/null 2> err || say "a huge number in a curve: $(cat err)"

# A tree with a FIFO where a config.json might be, and a file without an end.
mkdir -p tree/a
mkfifo tree/a/config.json
refused 'a FIFO named config.json' 'holds no run' plot tree
mkdir sparse
truncate -s 3G sparse/config.json sparse/big.demo sparse/big.obj
refused 'a huge config.json' 'longer' plot sparse
refused 'a huge demonstration' 'longer' rollout --policy sparse/big.demo
refused 'a huge mesh' 'longer' hull sparse/big.obj
exit $failed
