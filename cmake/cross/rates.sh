# shellcheck shell=bash
# Sourced by the scripts that make rows of the table of machines in cmake/cross/README.md, at the project's root.
mkdir -p build/ports
for native in build/release build/dev; do [ ! -e $native/libredman.so ] || break; done

# speed_beside NAME COMMAND...: the steps a second that the command prints over those of this machine's own library, which
# must be there (native_is_built); build/ports/NAME.rates keeps both.
native_is_built() { [ -e $native/libredman.so ]; }
speed_beside() {
  local name=$1
  shift
  gcc -O1 -Iinclude tests/ports/rate.c $native/libredman.so "-Wl,-rpath,$PWD/$native" -o build/ports/rate || return
  # in turns, since a busy machine changes its pace
  for _ in 1 2 3; do "$@" && build/ports/rate || return; done > "build/ports/$name.rates"
  tr -d '\r' < "build/ports/$name.rates" | awk 'NR % 2 { a += $1; next } { b += $1 } END { printf "%.2f", a / b }'
}
