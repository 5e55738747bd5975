#!/bin/sh
# test_tool_plugin.sh TOOL: a library with a task of its own is loaded by --plugin, for every command; what is no such
# library gets one line.
. "$(dirname "$0")/tool.sh"
cc=${CC:-cc}
command -v "$cc" > /dev/null || { echo "no C compiler here"; exit 77; }
root=$here/../..

# make NAME CODE: a library NAME.so of this C code.
make() {
  printf '#define RDM_EXPERIMENTAL\n#include <redman/redman.h>\n%s\n' "$2" > "$1.c"
  "$cc" -std=c99 -shared -fPIC "-I$root/include" "$1.c" -o "$1.so" || exit 1
}
"$cc" -std=c99 -shared -fPIC "-I$root/include" "$root/examples/07_own_task.c" -lm -o press.so || exit 1
make none 'int other(void) { return 0; }'
make refuses 'rdm_result redman_plugin(void) { return rdm_fail(RDM_ERROR_RANGE, "the moon is full"); }'

if ! "$tool" --plugin ./press.so tasks > out 2> err; then
  grep -q 'undefined symbol' err && { echo "the tool carries the library in itself: $(cat err)"; exit 77; }
fi
grep -q '^ *press ' out || { echo "tasks does not list press: $(cat out err)"; failed=1; }
"$tool" tasks > out && grep -q '^ *press ' out && { echo "press is there without its plugin"; failed=1; }

run() { # run ARGUMENTS...: must be good
  "$tool" "$@" > out 2> err || { echo "redman $*: $(cat err)"; failed=1; }
}
run tasks press --plugin=press.so
grep -q 'cup' out || { echo "tasks press shows no field cup: $(cat out)"; failed=1; }
run rollout --task press --policy hold --episodes 3 --envs 2 --threads 1 --plugin press.so --json
sed 's/.*"hash":"\{0,1\}\([0-9a-fx]*\).*/\1/' out > one
run rollout --task press --policy hold --episodes 3 --envs 2 --threads 2 --plugin press.so --json
sed 's/.*"hash":"\{0,1\}\([0-9a-fx]*\).*/\1/' out > two
grep -q '^[0-9a-fx]\{8,\}$' one || { echo "no hash: $(cat one)"; failed=1; }
cmp one two || { echo "the hash depends on threads"; failed=1; }
run train --task press --steps 1024 --envs 4 --set horizon=64 --set hidden=8 --out run --plugin press.so
run eval --policy run --episodes 2 --plugin press.so
"$tool" eval --policy run --episodes 2 > out 2> err && { echo "a run's plugin was loaded unasked"; failed=1; }
grep -q 'task press comes from a plugin: give --plugin ./press.so' err || { echo "no hint: $(cat err)"; failed=1; }
run render --task press --policy hold --size 64x48 --out press.png --plugin press.so
run rollout --task press --policy hold --record press.npz --plugin press.so

expect() { # expect TEXT ARGUMENTS...: exit status 2, and one line with the text
  text=$1
  shift
  "$tool" "$@" > out 2> err
  got=$?
  if [ $got -ne 2 ] || ! grep -q -- "$text" err || [ "$(wc -l < err)" -ne 1 ]; then
    echo "redman $*: exit status $got, '$(cat err)', expected '$text'"
    failed=1
  fi
}
expect 'the name is already used' tasks --plugin press.so --plugin ./press.so
expect 'missing.so' tasks --plugin missing.so
expect 'no function redman_plugin' --plugin none.so tasks
expect 'the moon is full' --plugin refuses.so tasks
expect 'a file is missing' tasks --plugin
expect 'task press: unknown' train --task press
exit $failed
