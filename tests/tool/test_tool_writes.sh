#!/bin/sh
# test_tool_writes.sh TOOL: what the tool writes replaces regular files alone, through no link that somebody laid,
# and leaves nothing behind; a run goes only when another can begin, and has one trainer at a time.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
start() {  # start FLAGS...: a small run, in place of this shell, so that a signal reaches it
  exec "$tool" train --task ball_run --envs 4 --set max_steps=20 --set horizon=50 --set hidden=16,16 --eval-every 2 \
    --checkpoint-every 2 "$@"
}
train() { (start "$@"); }
train --steps 2000 --out run > out 2> err || { cat err; exit 1; }

# every command that writes a file, with the file as its last argument
writers() {
  echo "plot run --out"
  echo "export --policy run --onnx"
  echo "export --policy run --safetensors"
  echo "export --policy run --probes 10 --probe"
  echo "rollout --task ball_run --set max_steps=3 --out"
  echo "rollout --task ball_run --set max_steps=3 --record"
  echo "export --policy run --c"
  echo "render --task ball_run --size 16x16 --out"
  echo "render --task ball_run --set max_steps=3 --glb"
  echo "report run --episodes 0 --strip 0 --html"
}
mkdir taken
writers | { while read -r command; do
  # FIFOs, folders and devices stay what they are
  mkfifo pipe 2> /dev/null
  [ -c device ] || mknod device c 1 3 2> /dev/null
  for file in pipe taken device; do
    [ -e $file ] || continue
    before=$(stat -c '%F %t' $file)
    # shellcheck disable=SC2086
    timeout 10 "$tool" $command $file > out 2> err
    [ $? -eq 1 ] && grep -q 'not a regular file' err || say "$command $file: $(cat err)"
    [ "$(stat -c '%F %t' $file)" = "$before" ] || say "$command turned $file into $(stat -c %F $file)"
  done
  # a link is followed: the file it leads to gets the content and keeps its permissions
  rm -f link aim
  echo old > aim
  chmod 600 aim
  ln -s aim link
  # shellcheck disable=SC2086
  "$tool" $command link > out 2> err || say "$command link: $(cat err)"
  [ -L link ] && [ "$(cat aim)" != old ] || say "$command: the link was replaced, not what it leads to"
  [ "$(stat -c %a aim)" = 600 ] || say "$command: a file of mode 600 got $(stat -c %a aim)"
  # a link under the temporary name is not
  echo precious > victim
  # shellcheck disable=SC2086
  sh -c 'ln -s victim "file.tmp-$$"; exec "$@"' sh "$tool" $command file > out 2> err || say "$command file: $(cat err)"
  [ "$(cat victim)" = precious ] || say "$command wrote through a link that was laid"
  [ -s file ] && [ ! -L file ] || say "$command made no file"
  rm -f file.tmp-*
  # a full disk: a text, and the old content stays
  echo old > file
  # shellcheck disable=SC2086
  ( ulimit -f 0; exec "$tool" $command file ) > /dev/null 2> err && say "$command: a full disk is not noticed"
  [ "$(cat file)" = old ] || say "$command: the old file is gone with the disk full"
  [ -z "$(find . -maxdepth 1 -name 'file.tmp-*')" ] || say "$command left a temporary file"
done; exit $failed; } || failed=1
# the limit is a text, not a signal
( ulimit -f 1; exec "$tool" rollout --task ball_run --out big.csv ) > out 2> kept
[ $? -eq 1 ] && grep -q 'big.csv: File too large' kept || say "a file size limit: $(cat kept)"
rm -f big.csv

# what a killed writer left goes with the next write; what a living one writes stays
: > "curve.svg.tmp-99999999-0123456789abcdef"
: > "curve.svg.tmp-$$-0123456789abcdef"
"$tool" plot run --out curve.svg > /dev/null 2> err || say "plot: $(cat err)"
[ ! -e curve.svg.tmp-99999999-0123456789abcdef ] || say "the file of a killed writer stays for ever"
[ -e "curve.svg.tmp-$$-0123456789abcdef" ] || say "the file of a living writer was swept"
cp -r run swept
: > swept/checkpoint.rdm.tmp-0123456789abcdef
: > swept/policy.rdm.tmp-99999999-0123456789abcdef
train --resume swept > /dev/null 2>&1 && say "a resume took the flags of a new run"
"$tool" train --resume swept > /dev/null 2> err || say "resume: $(cat err)"
[ -z "$(find swept -name '*.tmp-*')" ] || say "resuming leaves $(find swept -name '*.tmp-*')"

# --overwrite: what cannot begin leaves the old run as it is
sum() { cat run/config.json run/progress.csv run/policy.rdm run/checkpoint.rdm | cksum; }
before=$(sum)
for flags in '--steps 1e15' '--steps 0.5' '--set total_epochs=0' '--set nothing=1' '--task nothing' '--cost-limit nan' \
  '--set learning_rate=-1' '--envs 0' '--threads -1'; do
  # shellcheck disable=SC2086
  train --out run --overwrite $flags > out 2> err && say "$flags was taken"
  [ "$(sum)" = "$before" ] || { say "--overwrite with $flags spoiled the old run"; break; }
done
train --out run --overwrite --set "object=$(printf '\377')" > out 2> err && say "a value that is no UTF-8 was taken"
( ulimit -f 1; start --steps 1000 --out run --overwrite ) > out 2> err && say "a full disk is not noticed"
[ "$(sum)" = "$before" ] || say "--overwrite on a full disk spoiled the old run"
train --steps 1000 --out run --overwrite > out 2> err || say "--overwrite: $(cat err)"
[ "$(sum)" != "$before" ] || say "--overwrite did nothing"

# One trainer in a folder at a time; a kill sets it free.
rows() { { wc -l < "$1/progress.csv"; } 2> /dev/null || echo 0; }
wait_rows() {  # wait_rows DIR COUNT PID
  while kill -0 "$3" 2> /dev/null && [ "$(rows "$1")" -lt "$2" ]; do sleep 0.02; done
}
start --steps 100000000 --out busy > out1 2> err1 &
pid=$!
wait_rows busy 6 $pid
for flags in '--out busy' '--out busy --overwrite'; do
  # shellcheck disable=SC2086
  timeout 60 "$tool" train --task ball_run --steps 400 $flags > out 2> err && say "a second training in one folder: $flags"
  grep -q 'another process is training in busy' err || say "$flags: $(cat err)"
done
timeout 60 "$tool" train --resume busy > out 2> err && say "a second training in one folder: --resume"
grep -q 'another process is training in busy' err || say "--resume: $(cat err)"
kill -0 $pid 2> /dev/null || say "the first training did not outlive the second"
kill -9 $pid
wait $pid 2> /dev/null
"$tool" train --resume busy --steps 1 > out 2> err || say "a kill leaves the folder locked: $(cat err)"
awk -F, 'NR > 1 && $1 != NR - 1 { exit 1 }' busy/progress.csv || say "progress.csv has rows of two trainings"

# The folder goes while a run trains in it: a text; with another one in its place nothing is written there.
start --steps 100000000 --out gone > out1 2> err1 &
pid=$!
wait_rows gone 4 $pid
mv gone moved
mkdir gone
wait $pid
[ $? -eq 1 ] && grep -q 'run folder gone was removed' err1 || say "a removed folder: $(cat err1)"
[ -z "$(ls gone)" ] || say "the run went on in a folder that is not its own"
"$tool" train --resume moved --steps 1 > out 2> err || say "the moved run cannot be continued: $(cat err)"

# The disk fills up while a run trains: a text, the last checkpoint and whole rows stay, and the run can go on.
train --steps 2000 --out full > /dev/null 2> err || say "$(cat err)"
size=$(($(cat full/events.* | wc -c) / 512 + 4))
( ulimit -f $size; "$tool" train --resume full --steps 100000000 ) > out 2> err && say "a full disk is not noticed"
grep -q 'cannot write.*: File too large; the checkpoint of epoch [0-9]* is kept' err || say "a full disk: $(cat err)"
awk -F, 'NR == 1 { n = NF } NF != n { exit 1 }' full/progress.csv || say "a part of a row was left"
[ -z "$(find full -name '*.tmp-*')" ] || say "a full disk leaves $(find full -name '*.tmp-*')"
"$tool" train --resume full --steps 1 > out 2> err || say "the run cannot go on: $(cat err)"

# Folders that nothing can be written to.
"$tool" train --task ball_run --steps 400 --out /proc/none > out 2> err && say "a folder in /proc was made"
[ "$(wc -l < err)" -eq 1 ] || say "/proc: $(cat err)"
powerless() {  # powerless COMMAND...: by one whom permissions bind
  if [ "$(id -u)" -eq 0 ]; then setpriv --reuid=65534 --regid=65534 --clear-groups "$@"; else "$@"; fi
}
cp -r run locked
chmod 755 .
chmod -R a+rX,a-w locked
if powerless "$tool" eval --policy locked --episodes 1 > out 2> err; then
  cp locked/checkpoint.rdm kept.rdm
  powerless "$tool" train --resume locked --steps 3000 > out 2> err && say "a read-only folder is not noticed"
  grep -q 'Permission denied' err || say "a read-only folder: $(cat err)"
  powerless "$tool" train --task ball_run --steps 400 --overwrite --out locked > out 2> err && say "a read-only run was overwritten"
  grep -q 'Permission denied' err || say "a read-only folder: $(cat err)"
  cmp -s kept.rdm locked/checkpoint.rdm || say "a read-only run has another checkpoint"
fi
chmod -R u+w locked
exit $failed
