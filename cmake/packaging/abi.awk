# From the stable headers and deprecated.h, whose names old binaries have: a C file for abidw to describe (-v mode=functions),
# which defines each stable function and, for each constant, an array as long as 1000 + its value; or what abidiff is to let pass (-v mode=allowed): structs that
# begin with struct_size may grow at their ends.
BEGIN { if (mode == "functions") print "#define RDM_NO_DEPRECATED\n#include <redman/deprecated.h>\n#pragma GCC diagnostic ignored \"-Wunused-parameter\"" }
FNR == 1 { old = FILENAME ~ /deprecated/; ended = 0 }
old && /names that no release had/ { ended = 1 }
ended { next }
old && /^  RDM_[A-Z_0-9]+ RDM_DEPRECATED/ {  # RDM_BOX RDM_DEPRECATED("RDM_SHAPE_BOX") = RDM_SHAPE_BOX,
  value = $NF
  sub(/,/, "", value)
  if (mode == "functions") print "const char " $1 "_plus_1000[1000 + " value "] = \"\";"
  next
}
old && /^(static inline|RDM_API)/ { statement = " "; next }  # what follows is as the function was
old && statement != "" {
  statement = statement " " $0
  if (/[{;]/) {
    sub(/[{;].*/, "{ __builtin_trap(); }", statement)
    if (mode == "functions") print statement
    statement = ""
  }
  next
}
old { next }
/^typedef struct rdm_[a-z_]+ \{/ { struct = $3; next }
struct != "" && /struct_size;/ { sized = sized "|" struct; struct = "" }
/^}/ { struct = "" }
/^enum/ { constants = 1 }
constants {
  line = $0
  sub(/^enum[^{]*\{/, "", line)
  gsub(/\/\*.*/, "", line)
  n = split(line, part, ",")
  for (i = 1; i <= n; ++i)
    if (match(part[i], /RDM_[A-Z_0-9]+/)) {
      name = substr(part[i], RSTART, RLENGTH)
      if (mode == "functions") print "const char " name "_plus_1000[1000 + " name "] = \"\";"
    }
  if (/}/) constants = 0
}
statement == "" && /^RDM_API/ { statement = " " }
statement != "" {
  statement = statement " " $0
  gsub(/\/\*[^*]*\*+([^\/*][^*]*\*+)*\//, "", statement)
  if (statement ~ /;/) {
    sub(/;.*/, " { __builtin_trap(); }", statement)
    if (mode == "functions") print statement
    statement = ""
  }
}
END {
  if (mode == "allowed")
    print "[suppress_type]\n  type_kind = struct\n  name_regexp = ^(" substr(sized, 2) ")$\n  has_data_member_inserted_at = end"
}
