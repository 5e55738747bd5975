# Reads the public headers, whose first lines say whether they are stable. -v mode=stable|experimental: names of the exported functions of that part;
# mode=layout: a C program that prints size and offsets; mode=docs: functions and fields without comment.
function strip(text) { gsub(/\/\*[^*]*\*+([^\/*][^*]*\*+)*\//, "", text); return text }

# Fields of one declaration, "char *a, *b[3]" -> " a b"
function fields(text,   n, i, part, parts, out) {
  if (match(text, /\(\*[a-z_0-9]+\)/)) return " " substr(text, RSTART + 2, RLENGTH - 3)
  n = split(text, parts, ",")
  out = ""
  for (i = 1; i <= n; ++i) {
    part = parts[i]
    sub(/\[.*/, "", part)
    sub(/[ \t]+$/, "", part)
    if (match(part, /[a-zA-Z_0-9]+$/)) out = out " " substr(part, RSTART, RLENGTH)
  }
  return out
}

function declared(text, has_comment,   name) {  # one whole RDM_API statement
  name = text
  sub(/\(.*/, "", name)
  match(name, /rdm_[a-z_0-9]+$/)
  name = substr(name, RSTART, RLENGTH)
  if (mode == part) print name
  if (mode == "docs" && !has_comment && !covered) print FILENAME ":" FNR ": " name " has no comment"
}

function field_line(text, has_comment,   n, i, list, names) {
  names = fields(text)
  n = split(names, list, " ")
  for (i = 1; i <= n; ++i) {
    if (mode == "layout")
      printf "  printf(\"%%s.%%s %%zu %%zu\\n\", \"%s\", \"%s\", offsetof(%s, %s), sizeof ((%s *)0)->%s);\n", struct, list[i], struct, list[i], struct, list[i]
    if (mode == "docs" && !has_comment && !covered) print FILENAME ":" FNR ": " struct "." list[i] " has no comment"
  }
}

BEGIN {
  if (mode == "layout") {
    print "#include <stdio.h>"
    for (i = 1; i < ARGC; ++i) { name = ARGV[i]; sub(/.*\//, "", name); print "#include <redman/" name ">" }
    print "int main(void) {"
  }
}
{ sub(/\r$/, "") }
FNR == 1 { part = /Experimental/ ? "experimental" : "stable" }
/^#|^$/ { covered = 0; next }
in_comment { if (/\*\//) { in_comment = 0; covered = 1 } ; next }
/^[ \t]*\/\*/ && !/\*\// { in_comment = 1; next }
/^[ \t]*\/\*.*\*\/[ \t]*$/ { covered = 1; next }
{
  comment = /\/\*/
  if (comment && !/\*\//) in_comment = 1
  line = strip($0)
  sub(/\/\*.*/, "", line)
}
# A comment above covers the run of declarations under it; one with a comment of its own ends the run.
statement != "" { statement = statement " " line; commented = commented || comment }
statement == "" && line ~ /^RDM_API/ { statement = line; commented = comment }
statement != "" {
  if (statement ~ /;/) { declared(statement, commented); if (commented) covered = 0; statement = "" }
  next
}
line ~ /^typedef struct rdm_[a-z_]+ \{/ { struct = $3; covered = 0; next }
line ~ /^\} rdm_[a-z_]+;/ {
  if (mode == "layout") printf "  printf(\"%%s %%zu\\n\", \"%s\", sizeof(%s));\n", struct, struct
  struct = ""; covered = 0; next
}
struct != "" && line !~ /;/ && line ~ /[^ \t]/ { begun = begun " " line; next }  # a member that goes on
struct != "" && line ~ /;/ { line = begun " " line; begun = ""; sub(/;.*/, "", line); field_line(line, comment); covered = 0; next }
line ~ /[;}]/ { covered = 0 }
END { if (mode == "layout") print "  return 0;\n}" }
