#!/bin/sh
# install.sh CMAKE BUILD PREFIX: installs and moves what was installed to PREFIX, where the tests of consumers use it; looks at
# a staged install (DESTDIR), at one component, and for paths of the build in what was installed.
set -eu
cmake=$1 build=$2 prefix=$3
rm -rf "$prefix" "$prefix.first" "$prefix.stage"
status=0
wrong() { echo "$*"; status=1; }

"$cmake" --install "$build" --prefix "$prefix.first" > /dev/null
mv "$prefix.first" "$prefix"
for file in $(find "$prefix" -type f); do
  for path in "$prefix" "$(realpath "$build")"; do
    if grep -qIF -- "$path" "$file"; then wrong "$file names $path"; fi
  done
done
[ -n "$(find "$prefix" -name 'redman.1')" ] || [ ! -e "$build/manual/man1" ] || wrong "no manual page was installed"

pages=$(find "$prefix" -name manual -type d)
[ -n "$pages" ] || wrong "no manual was installed"
# Its links lead to what is there.
for page in $(find "$pages/.." -name '*.md' -type f); do
  for target in $(sed '/^```/,/^```/d' "$page" | grep -o '](\([^() ]*\))' | sed 's/^](//; s/)$//; s/#.*//' | grep -v '^[a-z]*:'); do
    case $target in  # a build without the importers has no header of theirs
      */redman/import.h) [ -n "$(find "$prefix" -name 'libredman_import*')" ] || continue ;;
    esac
    [ -e "$(dirname "$page")/$target" ] || wrong "$page: a link to $target"
  done
done

DESTDIR=$prefix.stage "$cmake" --install "$build" --prefix /opt/redman > /dev/null
[ "$(ls "$prefix.stage")" = opt ] || wrong "DESTDIR holds $(ls "$prefix.stage")"
(cd "$prefix.stage/opt/redman" && find . ! -type d | sort) > "$prefix.staged"
(cd "$prefix" && find . ! -type d | sort) | diff - "$prefix.staged" || wrong "a staged install has other files than a plain one"

rm -rf "$prefix.stage"
"$cmake" --install "$build" --prefix "$prefix.stage" --component runtime > /dev/null
others=$(find "$prefix.stage" ! -type d ! -name 'libredman.so.*')
[ -z "$others" ] || wrong "component runtime has $others"
rm -rf "$prefix.stage" "$prefix.staged"
exit $status
