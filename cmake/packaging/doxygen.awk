# The header as Doxygen wants to read it; its comments stay plain for everybody else. A comment above a declaration is
# its text, and that of the ones that follow without a comment of their own, up to an empty line; one behind it too;
# "---- title ----" opens a section.
function open_section(title, rest,   name) {
  name = tolower(title)
  gsub(/[^a-z0-9]+/, "_", name)
  if (section) print "/** @} */"
  section = 1
  print "/** @defgroup " name " " title
  print " * " rest " */"
  print "/** @{ */"
}
function escaped(text) {
  gsub(/\\/, "\\\\\\\\", text)
  gsub(/</, "\\<", text)
  return text
}
# One whole comment above something: kept for those that follow, with examples marked as code.
function document(text,   n, i, line, code, out, empty) {
  sub(/^[ \t]*\/\*+ */, "", text)
  sub(/ *\*\/ *$/, "", text)
  n = split(text, lines, "\n")
  out = !first ? "" : FILENAME ~ /redman\.h$/ ? "@mainpage\n" : "@file\n"
  for (i = 1; i <= n; ++i) {
    line = lines[i]
    sub(/^[ \t]*\*? ?/, "", line)
    if (i > 1 && empty && line ~ /^  +[^- ]/ && !code) { out = out "@code\n"; code = 1 }
    if (code && line == "") { out = out "@endcode\n"; code = 0 }
    out = out (code ? line : escaped(line)) "\n"
    empty = line == ""
  }
  if (code) out = out "@endcode\n"
  kept = "/** " out "*/"
  used = ""
}
# Before a declaration without a comment of its own, or the first one under a comment; the run ends with its kind.
function above(kind) {
  if (used && kind != used) kept = ""
  if (kept != "") print kept
  used = kind
}
function title_page() {  # the first comment is about the file; that of redman.h is the manual
  if (!first) return
  print kept
  if (kept ~ /@mainpage/) print "/** @file\n * All of the C interface. */"
  kept = ""
  first = 0
}
BEGIN { first = 1 }
{ sub(/\r$/, "") }
comment != "" {
  comment = comment "\n" $0
  if (/\*\//) { document(comment); comment = ""; title_page() }
  next
}
/^\/\* (----|====) / {
  title = $0
  sub(/^\/\* [-=]+ /, "", title)
  sub(/ [-=]*( \*\/)?$/, "", title)
  rest = ""
  if (title ~ /: /) { rest = title; sub(/^[^:]*: /, "", rest); sub(/:.*/, "", title) }
  open_section(title, rest)
  kept = ""
  in_title = !/\*\//
  next
}
in_title { in_title = !/\*\//; next }
/^[ \t]*\/\*/ && !/\*\// { comment = $0; next }
/^[ \t]*\/\*.*\*\/[ \t]*$/ { document($0); title_page(); next }
/^$/ { kept = ""; print; next }
/^#ifdef __cplusplus|^#if.*RDM_EXPERIMENTAL/ { kept = ""; if (section && depth == 0) { print "/** @} */"; section = 0 } print; next }
in_brace {  # the rest of what stands behind a brace: about all of the struct or enum
  line = $0
  sub(/^[ \t]*\*? ?/, "", line)
  sub(/ *\*\/ *$/, "", line)
  brace_text = brace_text " " line
  if (!/\*\//) next
  print "/** " escaped(brace_text) " */"
  print brace
  kept = ""
  depth = 1
  in_brace = 0
  next
}
/\{ *\/\*/ && !/\*\// {
  match($0, /\/\*/)
  brace = substr($0, 1, RSTART - 1)
  brace_text = substr($0, RSTART + 3)
  in_brace = 1
  next
}
in_behind { in_behind = !/\*\//; print escaped($0); next }
/[;,] *\/\*/ && !/\*\// {  # one that goes on in the next lines; only its own words are escaped
  in_behind = 1
  kept = ""
  match($0, /\/\*/)
  if (statement && substr($0, 1, RSTART - 1) ~ /;/) statement = 0
  print substr($0, 1, RSTART - 1) "/**<" escaped(substr($0, RSTART + 2))
  next
}
{
  behind = ""
  if (match($0, /\/\*.*\*\//)) {
    behind = substr($0, RSTART, RLENGTH)
    $0 = substr($0, 1, RSTART - 1) substr($0, RSTART + RLENGTH)
    sub(/^\/\*+ */, "", behind)
    sub(/ *\*\/$/, "", behind)
    behind = escaped(behind)
  }
  starts = /^(RDM_API|typedef|enum|#define)/ || (depth > 0 && !/^}/)
  if (statement) starts = 0
  if (/^enum.*};/ && behind != "") { print "/** " behind " */"; print; kept = ""; next }
  if (starts && /\{ *$/) {  # what stands behind the brace of a struct or enum is about all of it
    if (behind != "") print "/** " behind " */"; else above("struct")
    kept = ""
    print
    depth = 1
    next
  }
  if (starts) {
    if (behind == "" || !used) above(depth ? "field" : $1)
    if (behind != "") kept = ""
  }
  if (/^}/) { depth = 0; kept = "" }
  if (/^RDM_API/ || (depth && /\(\*/)) statement = 1
  if (statement && /;/) statement = 0
  # `double low, high;` is two fields.
  if (depth == 1 && !statement && behind != "" && match($0, /^ *[a-z_0-9]+ [a-z_0-9]+, [a-z_0-9]+;/)) {
    type = $1
    list = $0
    sub(/^ *[a-z_0-9]+ /, "", list)
    sub(/;.*/, "", list)
    n = split(list, names, ", ")
    for (i = 1; i <= n; ++i) print "  " type " " names[i] "; /**< " behind " */"
    next
  }
  print $0 (behind != "" ? " /**< " behind " */" : "")
}
