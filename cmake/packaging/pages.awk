# pages.awk -v list=1 PAGE...: the paths in the tree that pages link to, a line each.
# pages.awk -v known=FILE -v include=FOLDER PAGE: the page for a tree in which examples/manual is manual and include is FOLDER;
# a link to a path that is not among the lines of FILE becomes its text.

# Without "." and "..", from the root of the tree.
function resolved(path, part, n, i, depth, out) {
  n = split(path, part, "/")
  depth = 0
  for (i = 1; i <= n; ++i) {
    if (part[i] == "" || part[i] == ".") continue
    if (part[i] == "..") { if (depth > 0) --depth; continue }
    kept[++depth] = part[i]
  }
  out = ""
  for (i = 1; i <= depth; ++i) out = out (i > 1 ? "/" : "") kept[i]
  return out
}
function folder(path) { return path ~ /\// ? substr(path, 1, match(path, /\/[^\/]*$/) - 1) : "" }
# Where a path of the tree is in the documentation.
function place(path) {
  if (path ~ /^examples\/manual\//) return substr(path, 10)
  if (path ~ /^include\//) return include substr(path, 8)
  return path
}
# The way from the page to a place.
function way(to, up, i, n, part) {
  n = split(folder(place(page)), part, "/")
  up = ""
  for (i = 1; i <= n && index(to, part[i] "/") == 1; ++i) to = substr(to, length(part[i]) + 2)
  for (; i <= n; ++i) up = up "../"
  return up to
}

BEGIN {
  if (known != "") while ((getline line < known) > 0) there[line] = 1
}
# Text with its links led anew; a link may go on in the next line.
function led(rest, out, link, text, target, part, path, cut) {
  out = ""
  while (match(rest, /!?\[[^][]*\]\([^() ]+\)/)) {
    out = out substr(rest, 1, RSTART - 1)
    link = substr(rest, RSTART, RLENGTH)
    rest = substr(rest, RSTART + RLENGTH)
    cut = index(link, "](")
    text = substr(link, 1, cut - 1)
    target = substr(link, cut + 2, length(link) - cut - 2)
    if (target ~ /^[a-z]+:/ || target ~ /^#/) { out = out link; continue }
    part = index(target, "#") ? substr(target, index(target, "#")) : ""
    path = resolved(folder(page) "/" substr(target, 1, length(target) - length(part)))
    if (list) print path
    else if (path in there) out = out text "](" way(place(path)) part ")"
    else { sub(/^!?\[/, "", text); out = out text }
  }
  return out rest
}
function flush() {
  if (prose != "") prose = led(prose)
  if (!list) printf "%s", prose
  prose = ""
}
FNR == 1 { flush(); code = 0; page = FILENAME }
/^```/ { flush(); code = !code; if (!code) { if (!list) print; next } }
code { if (!list) print; next }
{ prose = prose $0 "\n" }
END { flush() }
