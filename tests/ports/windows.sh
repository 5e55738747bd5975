#!/bin/sh
# windows.sh ROOT BUILD: the DLL exports the checked-in lists and nothing else and needs nothing but Windows; a program in
# C made against it says that it has the same bytes; the tool lists tasks, trains, evaluates, and replaces its files.
set -u
root=$1 build=$(cd "$2" && pwd)
run="$root/cmake/cross/wine.sh"
work=$build/port
rm -rf "$work" && mkdir -p "$work" && cd "$work" || exit 1
passed=0 failed=0
check() { # check TITLE COMMAND...
  title=$1
  shift
  if "$@" > out 2> err; then passed=$((passed + 1)); else failed=$((failed + 1)); echo "$title: $(tail -n 3 err out)"; fi
}
dll=$build/bin/libredman.dll
names() { x86_64-w64-mingw32-objdump -p "$dll" | sed -n '/\[Ordinal\/Name Pointer\]/,/^$/p' | awk '/ rdm_|\] [a-zA-Z_]/ && !/Pointer/ { print $NF }' | LC_ALL=C sort; }
same_names() { names > have && grep -h '^rdm_' "$root"/capi/redman*.symbols | LC_ALL=C sort > want && diff want have; }
check 'exported names' same_names
needs_windows_alone() { x86_64-w64-mingw32-objdump -p "$dll" | awk '/DLL Name:/ && tolower($3) !~ /^(kernel32|msvcrt|advapi32|ntdll|user32)\.dll$/ { print; bad = 1 } END { exit bad }'; }
check 'what the DLL needs' needs_windows_alone
x86_64-w64-mingw32-gcc-posix -std=c99 -D__USE_MINGW_ANSI_STDIO=1 -I "$root/include" "$root/tests/ports/say_build.c" "$build/libredman.dll.a" -o say.exe
cp "$dll" .
says() { "$run" ./say.exe | tr -d '\r' | grep -q '; same bytes$'; }
check 'a program in C' says
tool=$build/bin/redman.exe
cp "$tool" "$build"/bin/*.dll .
check 'the tool lists tasks' sh -c "'$run' ./redman.exe tasks | grep -q hand_over_safe_finger"
check 'the tool trains' "$run" ./redman.exe train --task point_goal1 --envs 8 --steps 2048 --set horizon=64 --set hidden=16,16 --out run
check 'the tool goes on' "$run" ./redman.exe train --resume run --steps 4096
check 'the tool evaluates' "$run" ./redman.exe eval --policy run/policy.rdm --episodes 2
left() { ! ls -A run | grep -E 'tmp-|\.lock'; }
check 'no temporary file is left' left
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
