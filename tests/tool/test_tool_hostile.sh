#!/bin/sh
# test_tool_hostile.sh TOOL: what is no regular file, or far longer than it may be, or unpacks to far more than it is,
# is refused by each command that reads files: within 5 s and 200 MB of memory, with one line.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
python=
for name in ${PYTHON:-} python3 /usr/bin/python3; do "$name" -c 'import zipfile' 2> /dev/null && python=$name && break; done

# Sanitizers reserve more address space than that, and are slower.
space=2000000 seconds=5
(ulimit -v $space 2> /dev/null; "$tool" --version) > /dev/null 2>&1 || space=unlimited seconds=60
# refused WHAT TEXT ARGUMENTS...
refused() {
  what=$1 text=$2
  shift 2
  (ulimit -v $space 2> /dev/null; timeout $seconds "$tool" "$@") > out 2> err
  got=$?
  [ $got -eq 1 ] || [ $got -eq 2 ] || say "$what: exit status $got: $(cat err)"
  grep -q -- "$text" err || say "$what: no '$text': $(cat err)"
  [ "$(wc -l < err)" -eq 1 ] || say "$what: $(wc -l < err) lines"
}
# everywhere NAME TEXT: what has this name in the place of each kind of file
everywhere() {
  refused "robot $1" "$2" robot "$1.urdf"
  echo "<mujoco><include file=\"$1.xml\"/></mujoco>" > include.xml
  refused "include $1" "$2" robot include.xml
  echo "<mujoco><asset><mesh name=\"m\" file=\"$1.stl\"/></asset><worldbody><body><body><joint range=\"-1 1\"/><geom type=\"mesh\" mesh=\"m\"/></body></body></worldbody></mujoco>" > mesh.xml
  refused "mesh $1" "$2" robot mesh.xml
  refused "object $1" "$2" object "$1.object"
  refused "task $1" "$2" eval --task "$1.task" --policy hold
  refused "policy $1" "$3" eval --policy "$1.rdm"
  refused "recording $1" "$3" train --task bandit --from "$1.npz" --out fresh
  refused "rollout $1" "$4" rollout --policy "$1.npz"
  refused "demo $1" "$2" rollout --policy "$1.demo"
}

for end in urdf xml stl object task rdm npz demo so; do
  mkfifo "pipe.$end"
  mkdir "folder.$end"
  ln -s /dev/zero "zero.$end"
done
for kind in pipe zero; do everywhere $kind 'not a regular file' 'not a regular file' 'not a regular file'; done
for command in 'robot folder.urdf' 'train --task bandit --from folder.npz --out fresh'; do
  # shellcheck disable=SC2086
  refused "$command" 'not a regular file' $command
done
refused 'plugin' 'not a regular file' tasks --plugin pipe.so
truncate -s 100G huge
for end in urdf xml stl object task rdm npz demo; do ln -s huge "huge.$end"; done
everywhere huge '[0-9] bytes' 'wrong magic' 'not a complete archive'
mkdir run
for name in config.json policy.rdm progress.csv; do ln -s ../huge "run/$name"; done
refused 'eval of a huge run' . eval --policy run
refused 'plot of a huge run' 'longer than' plot run

# Archives that say more than they are.
printf 'PK\003\004' > sparse.npz
truncate -s 3G sparse.npz
refused 'sparse.npz of train' 'not a complete archive' train --task bandit --from sparse.npz --out fresh
refused 'sparse.npz of rollout' 'not a complete archive' rollout --policy sparse.npz
if [ -n "$python" ]; then
  "$python" - << 'PYTHON' || exit 1
import json, struct, zipfile
def head(kind, shape):
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}".encode()
    size = (10 + len(text) + 64) // 64 * 64 - 10
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", size) + text.ljust(size - 1) + b"\n"
said = json.dumps({"format": "redman rollout 1", "task": "lqr_line", "seed": 0, "envs": 1, "set": [], "policy": "zero",
                   "hash": "0" * 16})
def rollout(name, action, blocks, begin=(0, 20)):
    with zipfile.ZipFile(name, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as z:
        z.writestr("metadata.npy", head(f"<U{len(said)}", "()") + said.encode("utf-32-le"))
        z.writestr("episode_begin.npy", head("<i8", f"({len(begin)},)") + struct.pack(f"<{len(begin)}q", *begin))
        z.writestr("state.npy", head("|u1", "(1, 8)") + bytes(8))
        with z.open("action.npy", "w", force_zip64=True) as file:
            file.write(head("<f4", action))
            for _ in range(blocks):
                file.write(bytes(1 << 24))
rollout("zeros.npz", f"({1 << 26}, 1)", 16)  # 256 MB of zeros, which fit
rollout("lies.npz", f"({1 << 40}, 1)", 1)  # an array that is not as long as it says
rollout("wide.npz", "(20, 1099511627776)", 1)
PYTHON
  refused 'zeros.npz' 'out of a file of' rollout --policy zeros.npz
  refused 'lies.npz' 'does not have the length that its header says' rollout --policy lies.npz
  refused 'wide.npz' 'does not have the length that its header says' rollout --policy wide.npz
  refused 'zeros.npz of train' . train --task bandit --from zeros.npz --out fresh
fi

# Strips of pictures that would be gigabytes.
refused 'a strip' 'a strip of 4294967296 pixels' render --size 8192x8192 --strip 64
refused 'a strip with clouds' 'a strip of' render --size 2048x2048 --strip 3 --cloud
exit $failed
