#!/bin/sh
# Numbers have a decimal point whatever locale a host has set: the library formats them by base/format.hpp (print_text,
# print_list), never by printf, and reads them by base/chars.hpp. Argument: the project's root.
set -u
cd "$1" || exit 1
found=$(find lib tasks algos capi \( -name '*.cpp' -o -name '*.hpp' -o -name '*.inl' \) ! -path lib/base/format.hpp -exec awk '
  FNR == 1 { call = "" }
  { line = $0; sub(/\/\/.*/, "", line) }
  call == "" && match(line, /(^|[^a-z_])v?s?n?printf\(/) && line !~ /gnu::format/ { call = substr(line, RSTART); at = FNR; line = "" }
  call != "" {
    call = call line
    if (call !~ /;/) next
    if (call ~ /vs?n?printf\(/ || call ~ /%[-+ #0-9.*]*[aAeEfFgG]/) print FILENAME ":" at ": " substr(call, 1, 80)
    call = ""
  }
  line ~ /(^|[^a-z_])(sto(d|f|ld)|strto(d|f|ld)|atof|[fs]?scanf) *\(/ || line ~ /std::o?stringstream/ {
    print FILENAME ":" FNR ": " line }' {} +)
[ -z "$found" ] || { echo "$found"; exit 1; }
