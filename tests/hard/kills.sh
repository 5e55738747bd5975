#!/usr/bin/env bash
# kills.sh TOOL [KILLS]: SIGKILL at random moments of `redman train`, over five algorithms; each run is resumed,
# perhaps killed again, and ends in the same bytes as one that nobody disturbed. Then what a disk can do: no room
# left, a folder that may not be written, one that goes away, two trainings in one: a clear text, and the last good
# checkpoint stays. The last line is "N passed, M failed".
set -u
tool=$(realpath "$1")
kills=${2:-100}
dir=$(mktemp -d)
mounted=''
trap '[ -n "$mounted" ] && umount "$mounted"; chmod -R u+w "$dir"; rm -rf "$dir"' EXIT
cd "$dir" || exit 1
passed=0 failed=0
good() { passed=$((passed + 1)); }
bad() {
  failed=$((failed + 1))
  echo "FAILED: $*"
}

# The columns before the first Time/ column.
curve() {
  awk -F, 'NR == 1 { for (i = NF; i > 0; --i) if ($i ~ /^Time\//) last = i - 1 }
           { for (i = 1; i <= last; ++i) printf "%s%s", $i, i < last ? "," : "\n" }' "$1/progress.csv"
}
same() { [ "$(curve "$1")" = "$(curve "$2")" ] && cmp -s "$1/policy.rdm" "$2/policy.rdm"; }

algos=(ppo_lag trpo_lag cppo_pid cpo p3o)
tasks=(two_state point_goal1)
steps=16000
# flags ALGO TASK FOLDER: sets `train` to the tool's arguments. The tool is started as a command of its own, not inside a
# function: a kill then reaches it and not a shell around it.
flags() {
  train=(train --task "${tasks[$2]}" --algo "$1" --envs 8 --steps $steps --seed 1 --set max_steps=40 --set hidden=16,16
    --set horizon=16 --eval-every 3 --checkpoint-every 2 --out "$3")
}

# How long an undisturbed run takes decides when to kill.
declare -A took
for a in "${algos[@]}"; do
  for k in 0 1; do
    start=$(date +%s%N)
    flags "$a" $k "whole-$a-$k"
    "$tool" "${train[@]}" > /dev/null 2> err || bad "$a does not train: $(tail -n1 err)"
    took[$a-$k]=$((($(date +%s%N) - start) / 1000))
  done
done

n=0 resumed=0
RANDOM=1
while [ "$n" -lt "$kills" ]; do
  a=${algos[$((RANDOM % 5))]} k=$((RANDOM % 2))
  run=run-$n
  rm -rf "$run"
  first=1
  # up to three kills of one run
  for _ in 1 2 3; do
    [ "$n" -lt "$kills" ] || break
    if [ ! -f "$run/config.json" ]; then
      rm -rf "$run"
      flags "$a" $k "$run"
      "$tool" "${train[@]}" > /dev/null 2>&1 &
    else
      "$tool" train --resume "$run" > /dev/null 2>&1 &
    fi
    pid=$!
    delay=$(((RANDOM * 32768 + RANDOM) % (took[$a-$k] * (first ? 11 : 6) / 10 + 1)))
    sleep "$(printf '%d.%06d' $((delay / 1000000)) $((delay % 1000000)))"
    kill -9 $pid 2> /dev/null
    wait $pid 2> /dev/null
    n=$((n + 1)) first=''
  done
  if [ ! -f "$run/config.json" ]; then
    # killed before there was a run: nothing but an empty or missing folder
    rm -rf "$run"
    flags "$a" $k "$run"
    "$tool" "${train[@]}" > /dev/null 2> err || { bad "$a: cannot begin again: $(tail -n1 err)"; continue; }
  else
    "$tool" train --resume "$run" > /dev/null 2> err || { bad "$a: cannot resume: $(tail -n1 err)"; continue; }
  fi
  resumed=$((resumed + 1))
  left=$(find "$run" -name '*tmp*' | wc -l)
  if ! same "whole-$a-$k" "$run"; then
    bad "$a on ${tasks[$k]}: another end after kills"
  elif [ "$left" -gt 0 ]; then
    bad "$a: $left temporary files are left: $(find "$run" -name '*tmp*' | head -n1)"
  else
    good
  fi
  rm -rf "$run"
done
echo "$n kills, $resumed runs to the end"

# A text on stderr, an exit status of failure, and no signal.
refused() {
  local what=$1 status=$2
  if [ "$status" -eq 0 ] || [ "$status" -gt 128 ]; then
    bad "$what: exit status $status"
  elif ! grep -q '[a-z]' err || grep -q 'terminate called' err; then
    bad "$what: no clear text: $(head -n1 err)"
  else
    echo "$what: $(tail -n1 err)"
    good
  fi
}
# What is in the folder still serves: the last good checkpoint goes on to the same end.
serves() {
  if ! "$tool" train --resume "$1" > /dev/null 2> err; then
    bad "$2: the run cannot go on: $(tail -n1 err)"
  elif ! same whole-ppo_lag-0 "$1"; then
    bad "$2: the run ends otherwise"
  else
    good
  fi
}
# wait_rows FOLDER ROWS PID
wait_rows() {
  while kill -0 "$3" 2> /dev/null && { [ ! -f "$1/progress.csv" ] || [ "$(wc -l < "$1/progress.csv")" -lt "$2" ]; }; do
    sleep 0.005
  done
}

# No room left: a file system of its own for root, else a limit on the size of files.
if [ "$(id -u)" -eq 0 ] && mkdir disk && mount -t tmpfs -o size=600k tmpfs disk 2> /dev/null; then
  mounted=$dir/disk
  flags ppo_lag 0 disk/run
  "$tool" "${train[@]}" > /dev/null 2>&1 &
  pid=$!
  wait_rows disk/run 4 $pid
  head -c 600k /dev/zero > disk/fill 2> /dev/null
  wait $pid 2> err.none
  status=$?
  rm -f disk/fill
  if [ $status -gt 128 ]; then bad "full disk: signal"; else good; fi
  serves disk/run "full disk"
  head -c 600k /dev/zero > disk/fill 2> /dev/null
  flags ppo_lag 0 disk/new
  "$tool" "${train[@]}" > /dev/null 2> err
  refused "no room for a run" $?
  umount disk && mounted=''
fi
size=$(($(stat -c %s whole-ppo_lag-0/checkpoint.rdm) / 2048 + 1))
(
  ulimit -f $size
  flags ppo_lag 0 short
  "$tool" "${train[@]}" > /dev/null 2> err
)
refused "files may have $size kB" $?

# A folder that may not be written. Root writes anyway, so a user who may not is asked for.
mkdir closed
chmod 555 closed
if [ "$(id -u)" -ne 0 ]; then
  flags ppo_lag 0 closed/run
  "$tool" "${train[@]}" > /dev/null 2> err
  refused "a folder that may not be written" $?
elif command -v setpriv > /dev/null; then
  chmod 755 "$dir"
  cp "$tool" redman
  setpriv --reuid=65534 --regid=65534 --clear-groups env LD_LIBRARY_PATH="$(dirname "$tool")/.." \
    ./redman train --task two_state --envs 8 --steps 1000 --out closed/run > /dev/null 2> err
  refused "a folder that may not be written" $?
fi
flags ppo_lag 0 /proc/run
"$tool" "${train[@]}" > /dev/null 2> err
refused "a place where nothing can be made" $?

# The folder goes away while the run writes to it.
flags ppo_lag 0 gone
"$tool" "${train[@]}" > /dev/null 2> err &
pid=$!
wait_rows gone 3 $pid
mv gone elsewhere && rm -rf elsewhere
wait $pid
refused "the folder was removed" $?

# Two trainings in one folder.
flags ppo_lag 0 two
"$tool" "${train[@]}" > /dev/null 2> err.first &
pid=$!
wait_rows two 2 $pid
"$tool" train --resume two > /dev/null 2> err
status=$?
if kill -0 $pid 2> /dev/null; then refused "a second training in the same folder" $status; fi
wait $pid
if same whole-ppo_lag-0 two; then good; else bad "two trainings in one folder: another end"; fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
