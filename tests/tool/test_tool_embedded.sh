#!/bin/sh
# test_tool_embedded.sh TOOL [FOLDER]: policies of hand_over as C source on bare Cortex-M processors under qemu: the
# self-test passes, and fails with a number changed; and a table of what they take, of the policies NAME.rdm in the
# folder instead. eyes: 64,64 beside a cloud of 64 points through an encoder of 16,32; gru: 64,64 and a
# GRU of 64, with recall's 2 observations. Instructions are qemu's count (valgrind's on x86-64), not cycles.
models=${2:-}
[ -z "$models" ] || models=$(realpath "$models")
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
for program in arm-none-eabi-gcc qemu-system-arm; do
  command -v $program > /dev/null || { echo "skipped: there is no $program"; exit 77; }
done
echo '#include <string.h>' | arm-none-eabi-gcc -E - > /dev/null 2>&1 || { echo "skipped: there is no newlib for arm-none-eabi"; exit 77; }

# section OBJECT NAME: bytes of the sections that begin so
section() { size -A "$1" | awk -v name="$2" 'index($1, name) == 1 { sum += $2 } END { print sum + 0 }'; }
row() { printf '| %-15s | %-10s | %-7s | %6s | %7s | %6s | %12s |\n' "$@"; }

m4='-mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard'
m7='-mcpu=cortex-m7 -mfpu=fpv5-sp-d16 -mfloat-abi=hard'
# board FILE NAME MACHINE FLAGS...: compiles for it and runs, output to the file `ran`
board() {
  file=$1 name=$2 machine=$3
  shift 3
  arm-none-eabi-gcc -std=gnu99 -Os "$@" -mthumb -w -DREDMAN_POLICY_TEST "-DPOLICY=\"$dir/$file\"" -DNAME="$name" \
    $eyes -nostartfiles -T "$here/embedded/board.ld" "$here/embedded/board.c" -o board.elf -lc -lgcc || return 99
  timeout 120 qemu-system-arm -M "$machine" -icount shift=0 -display none -monitor none -serial none \
    -semihosting-config enable=on,target=native -kernel board.elf < /dev/null > ran 2>&1
}
measure() {  # measure NAME WEIGHTS MACHINE TITLE FLAGS...
  name=$1 weights=$2 machine=$3 title=$4
  shift 4
  arm-none-eabi-gcc -std=c99 -Os "$@" -mthumb -Wall -Wextra -Wpedantic -Wconversion -Werror -c "$name.c" -o object.o ||
    { say "$name: $title: warnings"; return; }
  board "$name.c" "$name" "$machine" "$@"
  got=$?
  [ $got -eq 0 ] || { say "$name on $title: the self-test answers $got: $(cat ran)"; return; }
  row "$title" "${name%%_*}" "$weights" "$(section object.o .text)" "$(section object.o .rodata)" \
    "$(awk '{ print $2 }' ran)" "$(awk '{ print $1 }' ran)"
  awk '!($1 > 1000 && $2 > 100) { exit 1 }' ran || say "$name on $title: $(cat ran)"
  awk '{ if (on) { sub(/^  -?/, "&1"); on = 0 } if (/_weight_0\[/ && /^static const/) on = 1; print }' "$name.c" > changed.c
  board changed.c "$name" "$machine" "$@"
  got=$?
  [ $got -eq 2 ] || say "$name on $title with a number changed: the self-test answers $got"
}
host() {  # host NAME WEIGHTS
  gcc -std=c99 -Os -c "$1.c" -o object.o || { say "$1: gcc fails"; return; }
  act=_act arguments='o, a' cloud=
  case $eyes in
    -DEYES) act=_act_points arguments="o, p, $1_num_points, a" cloud=", p[3 * $1_num_points]" ;;
    -DMEMORY) arguments='o, s, a' cloud=", s[$1_state_size]" ;;
  esac
  printf '#define REDMAN_POLICY_HEADER\n#include "%s.c"\nint main(void) { static float o[%s_obs_dim], a[%s_action_dim]%s; int i;
    for (i = 0; i < 10; ++i) %s(%s); return a[0] > 2; }\n' "$1" "$1" "$1" "$cloud" "$1$act" "$arguments" > calls.c
  gcc -std=c99 -Os calls.c object.o -o calls
  count=-
  command -v valgrind > /dev/null && count=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null \
    "--toggle-collect=$1$act" ./calls 2>&1 | awk '/Collected/ { printf "%d", $NF / 10 }')
  row x86-64 "${1%%_*}" "$2" "$(section object.o .text)" "$(section object.o .rodata)" - "$count"
}

eyes=
row target hidden weights .text .rodata stack instructions
echo '|---|---|---|---|---|---|---|'
for width in 64 128 eyes gru; do
  model=$models/$width.rdm
  eyes='' hidden="--set hidden=$width,$width --set max_steps=20"
  if [ $width = eyes ]; then
    eyes=-DEYES
    hidden='--set max_steps=20 --set hidden=64,64 --set encoder=16,32 --set encoder_points=64 --set cloud_width=24 --set cloud_height=24'
  fi
  if [ $width = gru ]; then
    eyes=-DMEMORY
    hidden='--task recall --algo ppo --set hidden=64,64 --set memory=gru:64'
  fi
  if [ -z "$models" ]; then
    # shellcheck disable=SC2086
    "$tool" train --envs 4 --steps 512 --set horizon=8 $hidden --out run-$width > out 2> err ||
      { cat err; exit 1; }
    model=run-$width/policy.rdm
  fi
  for weights in float int8; do
    name=h${width}_$weights
    [ $width = eyes ] && name=eyes_$weights
    [ $width = gru ] && name=gru_$weights
    flag=
    [ $weights = int8 ] && flag=--int8
    "$tool" export --policy "$model" --c "$name.c" --name "$name" $flag > out || say "$name: no export"
    [ "$(uname -m)" = x86_64 ] && host "$name" $weights
    # shellcheck disable=SC2086
    measure "$name" $weights mps2-an386 'Cortex-M4F' $m4
    # shellcheck disable=SC2086
    [ $width = gru ] && measure "$name" $weights mps2-an500 'Cortex-M7' $m7
    measure "$name" $weights mps2-an385 'Cortex-M3' -mcpu=cortex-m3
    measure "$name" $weights mps2-an385 'Cortex-M0' -mcpu=cortex-m0
  done
done
exit $failed
