#!/bin/sh
# headers.sh INCLUDE [stable|experimental]: the public headers of libredman in the folder INCLUDE, one a line, in the order in which
# redman.h includes them; without deprecated.h, whose names are no interface any more.
set -u
sed -n "s|^#include <\(redman/[a-z]*\.h\)>.*|$1/\1|p" "$1/redman/redman.h" | while read -r header; do
  case $header in */deprecated.h) continue ;; esac
  case ${2:-} in
    stable) sed -n '1{/Stable since/p;q;}' "$header" | grep -q . || continue ;;
    experimental) sed -n '1{/Experimental/p;q;}' "$header" | grep -q . || continue ;;
  esac
  echo "$header"
done
