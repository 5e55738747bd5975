#!/bin/sh
# site.sh ROOT BUILD VERSION LIBRARY: the site in BUILD/site/html: every page of the tree with a side bar and a search, Python's reference
# beside it and Doxygen's of the C headers in its folder c. A warning, as of a link that leads nowhere, is an error. No page asks another
# host for anything.
set -eu
root=$1 site=$2/site stage=$2/site/stage
python=/usr/bin/python3  # that Debian's packages are for
[ -x $python ] || python=python3
"$python" -c 'import sphinx, myst_parser, furo' 2> /dev/null || {
  echo "the site needs Sphinx, MyST and Furo: python3-sphinx python3-myst-parser furo"
  exit 77
}
rm -rf "$stage" "$site/html" "$site/trees"
mkdir -p "$stage"
for entry in "$root"/*; do
  case $(basename "$entry") in build* | runs) ;; *) ln -s "$entry" "$stage" ;; esac
done
cat > "$stage/c-reference.md" << 'M'
# C reference
Every function, struct and constant of the public headers: <a href="c/index.html">the headers as pages</a>, with a search of their own. The
[numbered examples](examples/README.md) are the shortest way in, [embedding](examples/manual/embedding.md) tells what all functions have in common.
M
cat > "$stage/python-reference.md" << 'M'
# Python reference
The [Python page of the manual](examples/manual/python.md) says how to use the package. Here is every public name.

```{eval-rst}
.. automodule:: redman
   :imported-members:
```
M
for module in gym safety stats; do  # the others import libraries that need not be there
  printf '\n## redman.%s\n```{eval-rst}\n.. automodule:: redman.%s\n   :exclude-members: Defaults\n```\n' $module $module >> "$stage/python-reference.md"
done
RDM_STAGE=$stage RDM_VERSION=$3 REDMAN_LIBRARY=$4 PYTHONPATH=$root/capi/python \
  "$python" -m sphinx -q -W --keep-going -j auto -b html -c "$root/cmake/packaging/site" -d "$site/trees" "$stage" "$site/html"
# Debian's furo takes normalize.css from the root of a web server; site.css has what is needed of it
sed -i '/^@import url(\/javascript\//d' "$site/html/_static/styles/furo.css"
[ ! -d "$2/reference/html" ] || cp -r "$2/reference/html" "$site/html/c"
cat > "$site/html/index.html" << 'H'
<!DOCTYPE html>
<html lang="en"><meta charset="utf-8"><meta http-equiv="refresh" content="0; url=README.html"><title>redman</title>
<p>The site begins at <a href="README.html">README.html</a>.
H
# no request to another host, and none to the root of the host: scripts, styles, fonts and pictures are all of the site
if grep -rlE '(src|href)="((https?:)?//[^"]*\.(js|css|woff2?|png|svg|ico)"|/)|@import +url\(.?(https?:|/)|fonts\.googleapis' "$site/html" --include='*.html' --include='*.css'; then
  echo "these pages ask another host for something" >&2
  exit 1
fi
has() { grep -q "$2" "$site/html/$1" || { echo "$1 has no $2" >&2; exit 1; }; }
has index.html url=README.html
has _static/language_data.js WEIGHTS            # of scorer.js
has examples/manual/algorithms/ppo_lag.html highlight-none
has python-reference.html highlight-python
if grep -roE '_downloads/[^"]*\.h"' "$site/html" --include='*.html' | grep -v /deprecated.h; then
  echo "these links download a header that has a page" >&2
  exit 1
fi
if [ -d "$site/html/c" ]; then
  for page in $(grep -rhoE 'href="[./]*/?c/[a-z_0-9]+\.html' "$site/html" --include='*.html' | sed 's|.*c/||' | sort -u); do
    [ -f "$site/html/c/$page" ] || { echo "a link leads to c/$page, which is not there" >&2; exit 1; }
  done
fi
echo "$(find "$site/html" -name '*.html' -not -path '*/c/*' | wc -l) pages, and those of the C headers: $site/html/index.html"
