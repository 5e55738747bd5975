#!/bin/sh
# test_tool_owned.sh TOOL: what redman did not write stays as it was, whatever its name: in run folders, beside files
# that are replaced, and under the names that commands choose for themselves.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
train() {
  "$tool" train --task ball_run --envs 4 --set max_steps=20 --set horizon=50 --set hidden=16,16 --steps 400 "$@" > out 2> err
}
train --out run || { cat err; exit 1; }
state() { (cd "$1" && find . -type f | LC_ALL=C sort | xargs cksum); }

# A folder that holds another program's file under a name of a run's is refused with its name, begun or overwritten.
other() {  # other NAME: what others write under it
  case $1 in
    config.json) echo '{"task": "x", "algo": "PPOLag", "seed": 0, "train_cfgs": {}, "algo_cfgs": {}}' ;;
    progress.csv) echo 'Metrics/EpRet,Metrics/EpCost,TotalEnvSteps' ;;
    *) echo 'weights of something else' ;;
  esac
}
for name in config.json progress.csv policy.rdm checkpoint.rdm; do
  for kind in text empty link; do
    rm -rf exp && mkdir exp
    case $kind in
      text) other $name > exp/$name ;;
      empty) : > exp/$name ;;
      link) other $name > aim && ln -s ../aim exp/$name ;;
    esac
    before=$(state exp; cksum aim 2> /dev/null)
    for flags in '' --overwrite; do
      # shellcheck disable=SC2086
      train --out exp $flags && say "a folder with a foreign $name ($kind) was taken, flags '$flags'"
      grep -q "exp/$name was not written by redman" err || say "$name ($kind): $(cat err)"
      [ "$(state exp; cksum aim 2> /dev/null)" = "$before" ] || say "$name ($kind) was touched, flags '$flags'"
    done
  done
  # in a run of redman's own, too: to go on would replace it
  rm -rf mixed && cp -r run mixed && other $name > mixed/$name
  before=$(state mixed)
  "$tool" train --resume mixed --steps 800 > out 2> err && say "a run with a foreign $name went on"
  grep -q "mixed/$name" err || say "resume with a foreign $name: $(cat err)"
  train --out mixed --overwrite && say "a run with a foreign $name was overwritten"
  [ "$(state mixed)" = "$before" ] || say "a run with a foreign $name was touched"
  rm -rf exp && mkdir -p exp/$name
  train --out exp --overwrite && say "a folder named $name was taken"
  grep -q "exp/$name is not a regular file" err || say "a folder named $name: $(cat err)"
done

# A run's own file without the others: nothing is lost unless it is said.
for name in policy.rdm progress.csv checkpoint.rdm; do
  rm -rf lone && mkdir lone && cp run/$name lone
  train --out lone && say "a lone $name of redman's was replaced"
  grep -q "lone holds $name of another run: replace it with --overwrite" err || say "a lone $name: $(cat err)"
  cmp -s run/$name lone/$name || say "a lone $name was touched"
  train --out lone --overwrite || say "a lone $name with --overwrite: $(cat err)"
done

# Event files and temporary files of others stay; redman's own go.
foreign='events.out.tfevents.1690000000.host.1.0 events.out.tfevents.1690000001.redman events.out.tfevents.redman
  events.out.tfevents.1690000002.redman.v2 config.json.tmp-backup policy.rdm.tmp-1 checkpoint.rdm.tmp-1-2 notes.txt
  policy.rdm.tmp-12-0123456789ABCDEF events.out.tfevents.1690000003.host.1.0.tmp-1-0123456789abcdef'
litter='policy.rdm.tmp-99999999-0123456789abcdef checkpoint.rdm.tmp-0123456789abcdef'
for flags in '--out exp' '--out exp --no-tensorboard' '--out exp --overwrite' '--resume exp --steps 600'; do
  rm -rf exp
  case $flags in
    *overwrite* | *resume*) cp -r run exp ;;
    *) mkdir exp ;;
  esac
  own=$(cd exp && ls -d events.out.tfevents.* 2> /dev/null)
  for name in $foreign; do echo "of another program" > "exp/$name"; done
  for name in $litter; do : > "exp/$name"; done
  # shellcheck disable=SC2086
  if [ "${flags#--resume}" != "$flags" ]; then "$tool" train $flags > out 2> err; else train $flags; fi || say "$flags: $(cat err)"
  for name in $foreign; do
    [ "$(cat "exp/$name" 2> /dev/null)" = "of another program" ] || say "train $flags touched $name"
  done
  for name in $litter; do [ ! -e "exp/$name" ] || say "train $flags left $name of a killed writer"; done
  case $flags in
    *overwrite*) [ "$(find exp -name 'events.out.tfevents.*.redman' | wc -l)" -eq 2 ] || say "$flags left $own" ;;
    *resume*) [ -s "exp/$own" ] || say "$flags lost $own" ;;
  esac
done
: > "curve.svg.tmp-12"
: > "curve.svg.tmp-99999999-short"
"$tool" plot run --out curve.svg > /dev/null 2> err || say "plot: $(cat err)"
[ -e curve.svg.tmp-12 ] && [ -e curve.svg.tmp-99999999-short ] || say "plot removed what it did not write"

# No other command writes over the files of a run, by their names or through a link.
ln -s run/policy.rdm shortcut
before=$(state run)
while read -r command; do
  for file in run/policy.rdm run/checkpoint.rdm run/config.json run/progress.csv shortcut; do
    # shellcheck disable=SC2086
    "$tool" $command $file > out 2> err && say "$command $file was done"
    grep -q 'file of a training run' err || say "$command $file: $(cat err)"
    [ "$(state run)" = "$before" ] || { say "$command $file spoiled the run"; break 2; }
  done
done << 'COMMANDS'
plot run --out
report run --episodes 0 --strip 0 --html
export --policy run --onnx
export --policy run --safetensors
export --policy run --c
export --policy run --probes 2 --probe
rollout --task ball_run --set max_steps=3 --out
rollout --task ball_run --set max_steps=3 --record
render --task ball_run --size 16x16 --out
render --task ball_run --set max_steps=3 --glb
robot ur10e --out
object egg --out
train --task ball_run --out other --steps 400 --from demo --save-recording
COMMANDS

# Names that a command chooses for itself.
for command in 'plot run' 'report run --episodes 0 --strip 0' 'render --task ball_run --size 16x16'; do
  name=$(echo "$command" | sed 's/^plot.*/plot.svg/; s/^report.*/report.html/; s/^render.*/render.png/')
  echo "mine" > "$name"
  # shellcheck disable=SC2086
  "$tool" $command > out 2> err && say "$command replaced $name of another program"
  grep -q "$name exists already and was not written by redman" err || say "$command: $(cat err)"
  [ "$(cat "$name")" = mine ] || say "$command touched $name"
  rm "$name"
  for time in first second; do
    # shellcheck disable=SC2086
    "$tool" $command > out 2> err || say "$command, $time: $(cat err)"
  done
done

# Trainings that begin in one second without --out each get a folder of their own.
rm -rf runs
for i in 1 2 3 4; do
  "$tool" train --task ball_run --envs 2 --steps 100 --set max_steps=10 --set horizon=50 > "out$i" 2> "err$i" &
done
wait
[ "$(find runs -name checkpoint.rdm | wc -l)" -eq 4 ] || say "four trainings at once: $(cat err1 err2 err3 err4)"

# A dangling link in the way of a run folder is named.
ln -s nowhere dangling
train --out dangling && say "a dangling link was taken for a folder"
grep -q 'dangling is a link to nowhere, which does not exist' err || say "a dangling link: $(cat err)"
train --out dangling/deep/run && say "a dangling link was taken for a folder"
grep -q 'dangling is a link to nowhere, which does not exist' err || say "below a dangling link: $(cat err)"
"$tool" train --resume run --algo cpo > out 2> err && say "a resume with another algorithm was taken"
grep -q -- '--from FOLDER' err || say "resume with other settings does not name --from: $(cat err)"
exit $failed
