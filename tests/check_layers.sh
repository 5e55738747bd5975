#!/bin/sh
# Every #include line against the one-way stack. Arguments: the project's root and the table of rows
# ("name folder rows it sees...", one per line).
set -u
root=$1 table=$2
cd "$root" || exit 1
posix='unistd\.h|fcntl\.h|pthread\.h|sched\.h|immintrin\.h|cpuid\.h|sys/[a-z]+\.h'
tool='CLI/CLI\.hpp|nlohmann/json\.hpp|png\.h'

# includes FILES...: "file target" for each include line, target with its quotes or brackets
includes() {
  awk '/^[ \t]*#[ \t]*include[ \t]*["<]/ {
         line = $0; sub(/^[ \t]*#[ \t]*include[ \t]*/, "", line)
         if (match(line, /^"[^"]*"/) || match(line, /^<[^>]*>/))
           print FILENAME, substr(line, RSTART, RLENGTH) }' "$@" /dev/null
}

{
  while read -r name folder sees; do
    files=$(find "$folder" -maxdepth 1 \( -name '*.cpp' -o -name '*.hpp' \) 2>/dev/null)
    [ -n "$files" ] || continue
    rows=$(echo "$name $sees" | tr ' ' '|')
    case $name in
      physics) third='(ode|ccd|Eigen|unsupported/Eigen)/.*' ;;
      nn | algos) third='(Eigen|unsupported/Eigen)/.*' ;;
      capi) third='none' rows="$rows|redman" ;;
      *) third='none' ;;
    esac
    # shellcheck disable=SC2086
    includes $files | while read -r file target; do
      allowed="^(\"($rows)/[a-z0-9_]+\.hp?p?\"|<[a-z0-9_]+>|<($posix|$third)>)\$"
      case $file in lib/sense/occupancy*) allowed="$allowed|^<octomap/.*>\$" ;; esac
      echo "$target" | grep -qE "$allowed" || echo "$file: $name may not include $target"
    done
  done < "$table"

  public=$(find include -name '*.h' -o -name '*.hpp')
  # shellcheck disable=SC2086
  [ -z "$public" ] || includes $public | grep -vE ' (<[a-z0-9_]+(\.h)?>|<redman/redman\.h>)$' |
    sed 's/$/: a public header sees the standard library and redman.h alone/'

  programs=$(find examples bindings \( -name '*.c' -o -name '*.h' -o -name '*.cpp' -o -name '*.hpp' \) 2>/dev/null)
  # shellcheck disable=SC2086
  [ -z "$programs" ] || includes $programs | while read -r file target; do
    case $target in
      \"*) path=$(echo "$target" | tr -d '"')
           [ -f "$(dirname "$file")/$path" ] || [ -f "examples/$path" ] || echo "$file: no file of the examples: $target" ;;
      *) echo "$target" | grep -qE "^<([a-z0-9_]+(\.h)?|redman/redman\.hp?p?|$posix|$tool)>\$" ||
           echo "$file: an example may not include $target" ;;
    esac
  done
} > "${TMPDIR:-/tmp}/layers.$$"
bad=$(cat "${TMPDIR:-/tmp}/layers.$$")
rm -f "${TMPDIR:-/tmp}/layers.$$"
[ -z "$bad" ] || { echo "$bad"; exit 1; }
