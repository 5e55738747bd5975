#!/bin/sh
# test_tool_words.sh TOOL CC: a mistyped word is answered with the nearest that there are, a number that cannot be taken as it
# stands is refused, and each failure is one line, and with --json one object that says it.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }

# refused STATUS TEXT ARGUMENTS...: with and without --json.
refused() {
  status=$1 text=$2
  shift 2
  "$tool" "$@" > out 2> err
  got=$?
  [ $got -eq "$status" ] || say "redman $*: exit status $got, not $status: $(cat err)"
  grep -qE -- "$text" err || say "redman $*: stderr has no '$text': $(cat err)"
  [ "$(wc -l < err)" -eq 1 ] || say "redman $*: stderr has $(wc -l < err) lines"
  "$tool" "$@" --json > out 2> err
  [ "$(wc -l < out)" -eq 1 ] && grep -q '^{"error":".*"status":[12]}$' out || say "redman $* --json: $(cat out)"
}

# Names. Several where several are as near.
hands='nearest are hand_over_safe_finger, hand_over_safe_joint and hand_over_wall'
for command in 'train --task' 'eval --task' 'rollout --task' 'render --task' 'plan --task' 'bench step --task' tasks 'baseline --task'; do
  # shellcheck disable=SC2086
  refused 2 "$hands" $command hand_ovr
done
refused 2 'nearest is pick_bottles' train --task bottles
refused 2 'nearest are ppo_lag, trpo_lag, mappo_lag and 5 more' train --algo lag
refused 2 'nearest is trpo' algos trop
refused 2 'nearest is shadow_hand' rollout --task grasp --set hand=shadow_hnd
refused 2 'nearest is kuka_iiwa7' rollout --task grasp --set arm=kuka_iiwa
refused 2 'nearest is (egg|object)' rollout --task hand_over_wall --set object=eg
refused 1 'nearest is ur10e' robot ur10
refused 1 'nearest is egg' object eggg
refused 2 'nearest is front' render --camera frnt
refused 2 'nearest is articulated|not one of articulated\|ode' rollout --task grasp --set engine=articulatd
refused 1 'nearest is hold' rollout --policy hodl
refused 1 'nearest is trained' eval --task grasp --policy traind
refused 2 'nearest is samples' plan --task ball_run --set smaples=3
refused 2 'nearest is samples' rollout --task ball_run --policy plan:smaples=3
refused 2 'nearest is bash' completion bahs
refused 2 'nearest is hold' baseline --policy hodl
# Subcommands and flags, at each depth.
refused 2 'subcommand trian: unknown; nearest is train' trian
refused 2 'subcommand bench stp: unknown; nearest is step; see redman bench --help' bench stp
refused 2 'subcommand trian: unknown; nearest is train' trian --help
refused 2 'subcommand trian: unknown; nearest is train' help trian
refused 2 'subcommand bench stp: unknown; nearest is step' help bench stp
refused 2 '--task: unknown; see redman info --help' info --task grasp
refused 2 '--stpes: unknown; nearest is --steps; see redman train --help' train --stpes 3
refused 2 '--evns: unknown; nearest is --envs' bench step --evns=3
refused 2 '--verson: unknown; nearest is --version' --verson
refused 2 '--sed: unknown; nearest (is --seed|are --set and --seed|are --seed and --set)' rollout --sed 3
# Files and folders: the name beside it.
mkdir -p runs/first
: > runs/first/policy.rdm
: > press.task
refused 1 'policy runs/first/polcy.rdm: no such file; nearest is policy.rdm in runs/first' eval --policy runs/first/polcy.rdm
refused 1 'there is no folder runs/frist' eval --policy runs/frist/policy.rdm
refused 1 'presss.task: No such file or directory; nearest is press.task' rollout --task presss.task
refused 1 'does not exist; nearest is first in runs' train --resume runs/frst
refused 1 'does not exist; nearest is runs' plot rnus
refused 1 'does not exist; nearest is first in runs' report runs/fisrt
refused 1 'not a regular file' rollout --task ball_run --policy plan:policy=/dev/zero
refused 2 'no such file; nearest is press.task' tasks --plugin ./pres.task

# Numbers.
for flag in --seed --envs --threads --episodes; do
  for value in 1.5 1e3 1e30 99999999999999999999999 0x10 '' ' 5' 5x nan inf -; do
    refused 2 "$flag: .*(whole number|out of range)" rollout --task ball_run $flag "$value"
  done
done
refused 2 '--seed: -1 is negative' rollout --task ball_run --seed=-1
refused 2 '--seed: 18446744073709551616 is out of range' rollout --task ball_run --seed 18446744073709551616
refused 2 '--envs 99999999999: out of range' rollout --task ball_run --envs 99999999999
refused 2 'num_threads|--threads' rollout --task ball_run --threads=-1
refused 2 '0 is outside 1' rollout --task ball_run --episodes 0
for value in 0 -5 1.5 1e30 1e400 nan inf 0x10 1e3x ''; do
  refused 2 '--steps' train --task ball_run --steps="$value"
done
for value in 0 0.5 -1; do refused 2 '--eval-every: ' train --task ball_run --eval-every=$value; done
for value in 64 64x 0x5 -1x5 1.5x2 16X16 +16x-16 ' 16x16' '16x16 ' 9999x1 99999999999999999999x1; do
  refused 2 '--size' render --task ball_run --size="$value"
done
for value in 10,5 0x10 ten; do refused 2 '--cost-limit' train --task ball_run --cost-limit "$value"; done
grep -q 'e+30[0-9]\|[0-9]\{60\}' err && say "a bound is printed with $(cat err)"
"$tool" rollout --task ball_run --set max_steps=2 --seed 18446744073709551615 > out 2> err || say "the largest seed: $(cat err)"
"$tool" rollout --task ball_run --set max_steps=2 --envs 70000 --episodes 3 > out 2> err
grep -qx -- '--envs 70000: only as many worlds are used as there are episodes, 3' err || say "70,000 worlds: $(cat err)"
# What is made of steps that are no whole epochs is said, and of others nothing.
"$tool" train --task ball_run --envs 2 --set horizon=50 --set max_steps=10 --steps 130 --out odd > out 2> err
grep -q -- '--steps 130: a run ends after a whole epoch of up to 100 steps, so it takes up to 200 steps' err || say "130 steps: $(cat err)"
"$tool" train --task ball_run --envs 2 --set horizon=50 --set max_steps=10 --steps 200 --out even > out 2> err
grep -q -- '--steps' err && say "200 steps: $(cat err)"

# Plugins that fail: their own text, or none, but never another's.
if command -v "${CXX:-c++}" > /dev/null; then
  build() {
    printf '#include <stdexcept>\n#include <clocale>\nextern "C" int rdm_task_find(const char*, int*);\nextern "C" __attribute__((visibility("default"))) int redman_plugin(void) { %s }\n' "$1" > p.cpp
    "${CXX:-c++}" -shared -fPIC p.cpp -o "$2" -Wl,-z,lazy 2> err || say "a plugin does not compile: $(cat err)"
  }
  build 'throw 5;' five.so
  refused 2 'five.so: redman_plugin threw something that is not a std::exception' tasks --plugin five.so
  build 'throw std::runtime_error("the sensor is off");' what.so
  refused 2 'what.so: redman_plugin threw an exception: the sensor is off' tasks --plugin what.so
  build 'return -1;' silent.so
  refused 2 'silent.so: redman_plugin: bad argument: it gave no error text' tasks --plugin silent.so
fi

# A decimal comma of the user's environment, or of a plugin's making, is in no number.
mkdir -p locale
if localedef -i de_DE -f UTF-8 locale/de_DE.UTF-8 2> /dev/null || [ -d locale/de_DE.UTF-8 ]; then
  export LOCPATH=$dir/locale
  set --
  if command -v "${CXX:-c++}" > /dev/null; then
    build 'return std::setlocale(LC_ALL, "de_DE.UTF-8") ? 0 : -1;' comma.so
    set -- --plugin comma.so
  fi
  for command in 'rollout --task ball_run --policy random --set max_steps=4 --out s.csv' 'tasks grasp' 'algos ppo --json' \
    'eval --task ball_run --policy random --episodes 3 --set max_steps=4' 'plot even --out s.svg' 'robot ur10e --out s.robot' \
    'rollout --task grasp --set object_mass=0.5..0.25' 'object egg --json' 'render --task ball_run --to 3 --glb s.glb --size 16x16'; do
    rm -f s.*
    # shellcheck disable=SC2086
    "$tool" $command > plain 2> plain.err
    cat s.* >> plain 2> /dev/null
    rm -f s.*
    # shellcheck disable=SC2086
    LC_ALL=de_DE.UTF-8 "$tool" "$@" $command > comma 2> comma.err
    cat s.* >> comma 2> /dev/null
    for part in '' .err; do
      sed 's/at [0-9.]* per second//' plain$part > a
      sed 's/at [0-9.]* per second//' comma$part > b
      cmp -s a b || say "redman $command differs under de_DE: $(diff a b | head -n 4)"
    done
  done
else
  echo "no locale with a decimal comma can be made here: that part was left out"
fi
exit $failed
