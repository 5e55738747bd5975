#!/usr/bin/env bash
# wheel.sh WHEEL TOOL: the wheel installed by pip, without an index, in a new venv of a Debian root that has Python and numpy and
# no library of ours or that ours needs; README's lines there. TOOL is the built one, for the same hash.
. "$(dirname "$0")/root.sh"
wheel=$1 tool=$2
mkdir -p build
block python README.md > build/hello.py
[ -s build/hello.py ] || die "README.md has no Python lines"
new_root wheel "$wheel" build/hello.py tests/import/gripper.urdf examples/scenes/touch.task -- python3-venv python3-numpy

hash=$("$tool" rollout --task hand_over_safe_finger --policy hold --episodes 1 --seed 7 --out build/steps.csv --json |
  sed 's/.*"hash":"\([^"]*\)".*/\1/')
# in_venv COMMAND: where `redman` and `python` are the venv's.
in_venv() { in_root "cd /tmp; . /venv/bin/activate; $1"; }
check "nothing of it is there before" in_root \
  '! ls /usr/lib/x86_64-linux-gnu | grep -E "libode|libccd|liboctom|libtinyxml2|libqhull|libredman"; ! python3 -c "import redman" 2> /dev/null; ! command -v redman'
check "a venv" in_root 'python3 -m venv --system-site-packages /venv'
check "pip install" in_venv 'pip install --no-index /packages/*.whl'
check "README's Python lines" in_venv 'python /packages/hello.py'
check "the libraries are the wheel's" in_venv 'python -c "
from redman._importer import importer
from redman._library import lib
print(lib._name, importer()._name)" | grep "/venv/.*/redman/libredman.so.* /venv/.*/redman/libredman_import.so"'
check "the same bytes as the tool's hold" in_venv "python -c '
import redman
pool = redman.Pool(\"hand_over_safe_finger\", seed=7, autoreset=\"off\")
pool.reset()
while not (pool.terminated[0] or pool.truncated[0]): pool.step(pool.baseline(\"hold\"))
print(pool.hash(0)); assert pool.hash(0) == \"$hash\", \"$hash\"'"
check "a pool goes through pickle" in_venv 'python -c "
import pickle, redman
pool = redman.Pool(\"ball_run\", num_envs=2, seed=1)
pool.reset()
again = pickle.loads(pickle.dumps(pool))
for each in (pool, again): each.step(each.baseline(\"hold\"))
print(pool.hash(0)); assert pool.hash(0) == again.hash(0)"'
check "a robot of a URDF file" in_venv 'python -c "
import redman
robot = redman.load_robot(\"/packages/gripper.urdf\", skip_meshes=True)
print(robot.name, *robot.joints); assert \"turn\" in robot.joints"'
check "a task of a file" in_venv 'python -c "
import redman
pool = redman.Pool(redman.load_task(\"/packages/touch.task\"), seed=1)
pool.reset(); pool.step(pool.baseline(\"hold\")); print(pool.hash(0))"'
check "a bundled policy, exported" in_venv 'python -c "
import redman
redman.Policy.trained(\"jenga\").export(\"jenga.onnx\")"; ls -l jenga.onnx'
check "the command" in_venv 'test "$(command -v redman)" = /venv/bin/redman; redman --version'
check "the command as a module" in_venv 'python -m redman tasks --json | python -c "
import json, sys
tasks = json.load(sys.stdin)[\"tasks\"]; print(len(tasks)); assert len(tasks) > 1"'
check "the command's bundled policies" in_venv 'redman eval --task bandit --policy trained --episodes 2 --json'
check "the command's status and words" in_venv 'redman tasks nothing > words 2>&1 && exit 1 || status=$?
  cat words; tool=$(echo /venv/lib/python3*/site-packages/redman/bin/redman); $tool tasks nothing > own 2>&1 || test $? -eq $status; cmp words own'
check "the command in a pipe that nobody reads" in_venv '{ redman tasks || echo $? > status; } | true; test "$(cat status)" -eq 141'
check "the command without a tool" in_venv 'tool=$(echo /venv/lib/python3*/site-packages/redman/bin/redman); mv $tool /tmp/away
  for call in redman "python -m redman"; do $call --version > words 2>&1 && exit 1; cat words; grep -q "no command-line tool" words; done
  mv /tmp/away $tool'
check "its licences" in_venv 'ls /venv/lib/python3*/site-packages/redman-*.dist-info/LICENSE*'
check "pip uninstall" in_venv 'pip uninstall -y redman; ! python -c "import redman" 2> /dev/null; ! ls /venv/bin/redman /venv/lib/python3*/site-packages/redman 2> /dev/null'
finish
