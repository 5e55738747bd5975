#!/bin/sh
# symbols.sh LIBRARY PACKAGE VERSION DUMPS OUT: Debian's symbols file. A symbol is promised from the release on whose dump
# DUMPS/redman-<release>.abi has it first, else from VERSION; those of the experimental node for VERSION's minor release.
set -eu
library=$1 package=$2 version=$3 dumps=$4 out=$5
[ -f "$library" ] || { echo "$library: no such library" >&2; exit 1; }
since() {
  for dump in $(ls "$dumps"/redman-*.abi 2> /dev/null | sort -V); do
    if grep -q "elf-symbol name='$1'" "$dump"; then basename "$dump" .abi | sed 's/^redman-//'; return; fi
  done
  echo "$version"
}
minor=${version#*.}
next=${version%%.*}.$((${minor%%.*} + 1))~
{
  echo "$(basename "$(readlink -f "$library")" ".${version}" | sed "s/\$/.${package##*[a-z]}/") $package #MINVER#"
  echo "| $package (>= $version), $package (<< $next)"
  echo "* Build-Depends-Package: libredman-dev"
  nm -D --with-symbol-versions --defined-only "$library" | awk '{ sub("@@", "@", $3); print $2, $3 }' | LC_ALL=C sort -k 2 |
    while read -r kind symbol; do
      [ "$kind" = A ] && symbol=$symbol@${symbol%@*}
      case $symbol in
        *@*EXPERIMENTAL*) echo " $symbol $version 1" ;;
        *) echo " $symbol $(since "${symbol%@*}")" ;;
      esac
    done
} > "$out"
