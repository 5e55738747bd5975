#!/bin/sh
# run.sh TREE LIBRARY TOOL TEST.py: runs a test of the Python package against a library, by the first python3 that has
# numpy ($PYTHON, the one on PATH, Debian's). Ends with 77, ctest's word for skipped, where there is none.
set -u
tree=$1 test=$4
for python in ${PYTHON:-} python3 /usr/bin/python3; do
  "$python" -c 'import sys, numpy; sys.exit(sys.version_info < (3, 9))' 2> /dev/null || continue
  export REDMAN_LIBRARY="$2" REDMAN_TOOL="$3" PYTHONPATH="$tree/capi/python" PYTHONDONTWRITEBYTECODE=1
  exec "$python" -X dev -W error::ResourceWarning "$test"
done
echo "skipped: no python3 of version 3.9 or later that imports numpy (apt-get install python3-numpy)"
exit 77
