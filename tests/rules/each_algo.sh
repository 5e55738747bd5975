#!/bin/sh
# each_algo.sh LIST COMMAND...: runs the command once for every algorithm that the program LIST prints, with the
# algorithm's name as its last argument.
set -u
list=$1
shift
names=$("$list") && [ -n "$names" ] || { echo "there are no algorithms"; exit 1; }
status=0
for name in $names; do
  "$@" "$name" > /dev/null || { echo "$name failed: $*"; status=1; }
done
exit $status
