#!/bin/sh
# pages.sh TREE OUT INCLUDE: the manual as installed documentation: OUT/manual, README.md, and the files that these link to, each
# where it is in the tree, but for what contributors need the tree for. INCLUDE is what include/ of the tree is, seen from OUT. A
# link to what is not installed becomes its text.
set -eu
tree=$1 out=$2 include=$3
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$out"
mkdir -p "$out"
out=$(cd "$out" && pwd)
cd "$tree"

pages() { echo README.md; find examples/manual -name '*.md'; }
# What other components install: programs, demonstrations, headers.
others() { find examples/demos include/redman -type f ! -name README.md; ls examples/[0-9]*.c; }
others | sort > "$out/others"
# What the pages link to beside these.
# shellcheck disable=SC2046
awk -f "$here/pages.awk" -v list=1 $(pages) | sort -u | comm -23 - "$out/others" | while read -r path; do
  case $path in
    CONTRIBUTING.md | algos/* | capi/* | cmake/* | tests/* | lib/README.md | tasks/README.md | *.hpp) ;;
    *) if [ -f "$path" ]; then echo "$path"; fi ;;
  esac
done > "$out/linked"
{ pages; cat "$out/linked"; } | sort -u > "$out/installed"
sort -u "$out/others" "$out/installed" > "$out/known"

while read -r path; do
  to=$out/$path
  case $path in examples/manual/*) to=$out/${path#examples/} ;; esac
  mkdir -p "$(dirname "$to")"
  case $path in
    *.md) awk -f "$here/pages.awk" -v known="$out/known" -v include="$include" "$path" > "$to" ;;
    *) cp "$path" "$to" ;;
  esac
done < "$out/installed"
rm "$out/others" "$out/linked" "$out/installed" "$out/known"
