#!/bin/sh
# policy_headers.sh INCLUDE OUT: the headers of a library of policies alone, of those in the folder INCLUDE: what it has, without the
# lines that include others.
set -eu
mkdir -p "$2/redman"
for header in base.h base.hpp policy.h policy.hpp redman.h redman.hpp deprecated.h; do
  awk '!/^#include <redman\// || /<redman\/(base|policy|redman|deprecated)\.h/' "$1/redman/$header" > "$2/redman/$header"
done
