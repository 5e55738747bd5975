#!/bin/sh
# standalone.sh COMPILER OBJCOPY NM AR ARCHIVE NAMES EXTRA...: the objects of ARCHIVE and EXTRA become one, which has what they need of the
# C++ runtime and shows nothing but the rdm_ names of the file NAMES. A program in C links it as if it were written in C. The unwinder
# stays outside: it is in libgcc, which the compiler of C links by itself, and belongs to the start-up code of static programs.
set -eu
compiler=$1 objcopy=$2 nm=$3 ar=$4 archive=$5 names=$6
shift 6
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
grep -o 'rdm_[a-z_0-9]*' "$names" | sort -u > "$work/names"
runtime=$("$compiler" -print-file-name=libstdc++.a)
# Groups of sections become plain ones: the linker of a program in C++ would take its own in their place, by name.
# shellcheck disable=SC2046
"$compiler" -fuse-ld=bfd -nostdlib -r -Wl,--gc-sections -Wl,--force-group-allocation $(sed 's/^/-Wl,-u,/' "$work/names") \
  -o "$work/all.o" "$@" -Wl,--whole-archive "$archive" -Wl,--no-whole-archive "$runtime"
# What a process has once (`u`) cannot be hidden: it gets a name that nobody else has.
"$nm" "$work/all.o" | awk '$2 == "u" { print $3, "redman_own_" ++n }' > "$work/once"
"$objcopy" --strip-unneeded --keep-global-symbols="$work/names" --redefine-syms="$work/once" "$work/all.o" "$work/redman.o"
rm "$archive"
"$ar" rcs "$archive" "$work/redman.o"
