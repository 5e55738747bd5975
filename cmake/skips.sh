# shellcheck shell=bash
# Sourced by check.sh: which of the tests that ctest skipped have no excuse in tests/skips.txt.

# lacks WHAT BUILD: whether this machine lacks it, in the words of tests/skips.txt. With base_cpu set the build sees nothing of the
# processor beyond the base.
lacks() {
  case $1 in
    python:*) ! python3 -c "import ${1#*:}" 2> /dev/null ;;
    cpu:*) [ -n "${base_cpu:-}" ] || ! grep -qw "${1#*:}" /proc/cpuinfo ;;
    BUILD/*) [ ! -e "$2/${1#BUILD/}" ] ;;
    */*) [ ! -e "$1" ] ;;
    *) ! command -v "$1" > /dev/null ;;
  esac
}

# excuse NAME BUILD: what the test of that name lacks, or nothing.
excuse() {
  local pattern needs need
  while read -r pattern needs; do
    # shellcheck disable=SC2053
    [[ $1 == $pattern ]] || continue
    for need in $needs; do
      if lacks "$need" "$2"; then
        echo "$need"
        return
      fi
    done
  done < <(grep -v '^#' tests/skips.txt)
}

# skips BUILD LOG: says of each test that ctest skipped, with this output, why it may be; returns how many may not.
skips() {
  local build=$1 said=$2 name why sanitized bad=0
  sanitized=$(sed -n 's/^REDMAN_SANITIZE:[A-Z]*=//p' "$build/CMakeCache.txt")
  while read -r name; do
    why=$(excuse "$name" "$build")
    if [ -n "$why" ]; then
      echo "skipped: $name, as there is no $why" >&2
    elif [ -z "$sanitized" ] || [[ $name != *.* ]]; then  # beside a sanitizer cases that count the heap leave themselves out
      echo "$name was skipped, and all that it needs is here (tests/skips.txt)" >&2
      bad=$((bad + 1))
    fi
  done < <({ sed -n 's/^\t *[0-9]* - \([^ ]*\) (Skipped)$/\1/p' "$said"
    sed -n 's/^\[  SKIPPED \] \([A-Za-z0-9_\/]*\.[A-Za-z0-9_\/]*\)$/\1/p' "$build/Testing/Temporary/LastTest.log"; } | sort -u)
  return $bad
}
