#!/bin/sh
# wine.sh PROGRAM ARGUMENT...: runs a program of Windows, in a home of wine's own below build/cross, without a window.
WINEPREFIX=${WINEPREFIX:-$(cd "$(dirname "$0")/../../build/cross" && pwd)/wine}
export WINEPREFIX WINEDEBUG="${WINEDEBUG:--all}" DISPLAY="" WINEDLLOVERRIDES="mscoree,mshtml=;winemenubuilder.exe=d"
for wine in wine64 /usr/lib/wine/wine64 wine; do
  command -v "$wine" > /dev/null && exec "$wine" "$@"
done
echo "wine.sh: no wine here" >&2
exit 127
