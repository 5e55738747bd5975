#!/bin/sh
# A C program built against the installed package by pkg-config alone, shared and static.
# Arguments: C compiler, prefix, its library folder, a folder for the programs.
set -eu
cc=$1 prefix=$2 libdir=$3 out=$4
source=$(dirname "$0")/use.c
PKG_CONFIG_PATH=$prefix/$libdir/pkgconfig
export PKG_CONFIG_PATH
# Shared, where no package of another library can be found.
# shellcheck disable=SC2046
"$cc" -std=c99 "$source" -o "$out/use_shared" $(PKG_CONFIG_LIBDIR=$PKG_CONFIG_PATH pkg-config --cflags --libs redman)
LD_LIBRARY_PATH=$prefix/$libdir "$out/use_shared"
# shellcheck disable=SC2046
"$cc" -std=c99 "$source" -o "$out/use_static" $(pkg-config --cflags --libs redman-static)
"$out/use_static"
if ldd "$out/use_static" | grep libredman; then exit 1; fi
if [ "$(uname)" = Linux ]; then  # a plugin exports none of the archive's names
  # shellcheck disable=SC2046
  "$cc" -std=c99 -shared -fPIC "$source" -o "$out/use_static.so" $(pkg-config --cflags --libs redman-static)
  nm -D --defined-only "$out/use_static.so" > "$out/use_static.names"
  grep -q ' main$' "$out/use_static.names"
  if grep rdm_ "$out/use_static.names"; then exit 1; fi
fi
if pkg-config --exists redman_import; then
  # shellcheck disable=SC2046
  "$cc" -std=c99 "$(dirname "$0")/use_import.c" -o "$out/use_import" $(pkg-config --cflags --libs redman_import)
  LD_LIBRARY_PATH=$prefix/$libdir "$out/use_import"
fi
