#!/bin/sh
# Every #include line against the one-way stack. Arguments: the project's root and the table of rows
# ("name folder rows it sees...", one per line).
set -u
root=$1 table=$2
cd "$root" || exit 1
posix='windows\.h|malloc\.h|unistd\.h|fcntl\.h|dirent\.h|pthread\.h|sched\.h|[eix]mmintrin\.h|wasm_simd128\.h|cpuid\.h|sys/[a-z]+\.h'
tool='CLI/CLI\.hpp|nlohmann/json\.hpp|png\.h|libqhull_r/qhull_ra\.h|hacdHACD\.h'

# includes FILES...: "file target" for each include line, target with its quotes or brackets.
includes() {
  awk '/^[ \t]*#[ \t]*include[ \t]*["<]/ {
         line = $0; sub(/^[ \t]*#[ \t]*include[ \t]*/, "", line)
         if (match(line, /^"[^"]*"/) || match(line, /^<[^>]*>/))
           print FILENAME, substr(line, RSTART, RLENGTH) }' "$@" /dev/null
}
# sources FOLDER: its C and C++ files, at any depth.
sources() {
  find "$1" \( -name '*.c' -o -name '*.h' -o -name '*.cpp' -o -name '*.hpp' -o -name '*.inl' \) 2> /dev/null
}

bad=$(
  while read -r name folder sees; do
    third=none rows=$(echo "$name" "$sees" | tr ' ' '|')
    case $name in
      physics) third='(ode|ccd)/.*' ;;
      capi) rows="$rows|redman" ;;
    esac
    # shellcheck disable=SC2046
    includes $(sources "$folder" | grep -v '^capi/import/') |
      grep -vE " (\"($rows)/([a-z0-9_]+/)*[a-z0-9_]+\.(hpp|inl|h)\"|<[a-z0-9_]+>|<($posix|$third)>)\$" |
      grep -vE '^(lib/sense/map/occupancy[a-z_]*\.[ch]pp <octomap/.*>|lib/base/eigen\.hpp <Eigen/[A-Za-z]+>)$' | sed "s/ /: $name may not include /"
  done < "$table"

  # The importers stand on the public header, on lib/base's texts, names and files, and on each other.
  # shellcheck disable=SC2046
  includes $(sources capi/import) | grep -vE " (<[a-z0-9_]+>|\"base/(chars|error|file|format|names|text)\.hpp\"|<($posix|redman/redman_import\.h|tinyxml2\.h|toml\+\+/toml\.h)>)\$" |
    while read -r file target; do
      [ -f "capi/import/$(echo "$target" | tr -d '"')" ] || echo "$file: an importer may not include $target"
    done

  # What some standard libraries lack is asked of lib/base.
  # shellcheck disable=SC2046
  grep -nE 'std::(from_chars|to_chars|bit_cast)\b' $(sources lib; sources tasks; sources algos; sources capi) /dev/null |
    grep -vE '^lib/base/(chars|decimal|bit_cast)\.hpp:' | sed -E 's/:([0-9]+):.*/:\1: is in base\/chars.hpp or base\/bit_cast.hpp/'

  # shellcheck disable=SC2046
  includes $(sources include) | grep -vE ' (<[a-z0-9_]+(\.h)?>|<redman/redman[a-z_]*\.h>)$' |
    grep -vE '\.hpp <redman/redman[a-z_]*\.hpp>$' |
    sed 's/ /: a public header may not include /'

  # shellcheck disable=SC2046
  includes $(sources examples; sources bindings) |
    grep -vE " <([a-z0-9_]+(\.h)?|redman/redman[a-z_]*\.hp?p?|$posix|$tool)>\$" | while read -r file target; do
    path=$(echo "$target" | tr -d '"')
    [ -f "$(dirname "$file")/$path" ] || [ -f "examples/redman/$path" ] || echo "$file: an example may not include $target"
  done
)
[ -z "$bad" ] || { echo "$bad"; exit 1; }
