#!/usr/bin/env bash
# wheel.sh WHEEL TOOL: the wheel installed by pip, without an index, in a Debian root that has Python, numpy and pip and no
# library of ours or that ours needs; README's lines there. TOOL is the built one, for the same hash.
. "$(dirname "$0")/root.sh"
wheel=$1 tool=$2
mkdir -p build
block python README.md > build/hello.py
[ -s build/hello.py ] || die "README.md has no Python lines"
new_root wheel "$wheel" build/hello.py -- python3-pip python3-numpy

hash=$("$tool" rollout --task hand_over_safe_finger --policy hold --episodes 1 --seed 7 --out build/steps.csv --json |
  sed 's/.*"hash":"\([^"]*\)".*/\1/')
check "nothing of it is there before" in_root '! ls /usr/lib/x86_64-linux-gnu | grep -E "libode|libccd|liboctom|libredman"; ! python3 -c "import redman" 2> /dev/null'
check "pip install" in_root 'pip install --no-index --break-system-packages --root-user-action=ignore /packages/*.whl'
check "README's Python lines" in_root 'cd /tmp; python3 /packages/hello.py'
check "the library is the wheel's" in_root \
  'cd /tmp; python3 -c "from redman._library import lib; print(lib._name)" | grep /dist-packages/redman/libredman'
check "the same bytes as the tool's hold" in_root "cd /tmp; python3 -c '
import redman
pool = redman.Pool(\"hand_over_safe_finger\", seed=7, autoreset=\"off\")
pool.reset()
while not (pool.terminated[0] or pool.truncated[0]): pool.step(pool.baseline(\"hold\"))
print(pool.hash(0)); assert pool.hash(0) == \"$hash\", \"$hash\"'"
check "its licences" in_root 'ls /usr/local/lib/python3*/dist-packages/redman-*.dist-info/LICENSE*'
check "pip uninstall" in_root 'pip uninstall -y --break-system-packages --root-user-action=ignore redman; ! python3 -c "import redman" 2> /dev/null'
finish
