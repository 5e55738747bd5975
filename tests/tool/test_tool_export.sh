#!/bin/sh
# test_tool_export.sh TOOL: exported files give the policy's actions. The ONNX file runs in onnxruntime-node,
# which npm puts beside the build (77, a skip, where there is no npm or no network); the safetensors file is
# read by Python when it is there.
. "$(dirname "$0")/tool.sh"

modules=$(dirname "$(dirname "$tool")")/npm
module=$modules/node_modules/onnxruntime-node
reason=
if ! command -v node > /dev/null || ! command -v npm > /dev/null; then
  reason="there is no npm"
elif [ ! -d "$module" ]; then
  mkdir -p "$modules"
  ONNXRUNTIME_NODE_INSTALL=skip npm install --ignore-scripts --no-audit --no-fund --no-save --loglevel=error \
    --prefix "$modules" onnxruntime-node@1.30.0 > "$dir/npm" 2>&1 < /dev/null || reason="npm cannot install onnxruntime-node"
fi

# policies of every activation, with a normaliser that has seen data and without one
policy() { # policy NAME FLAGS...
  name=$1
  shift
  "$tool" train --envs 4 --steps 512 --set max_steps=20 --set horizon=8 "$@" --out "$dir/$name" \
    > /dev/null 2> "$dir/err" || { cat "$dir/err"; exit 1; }
  "$tool" export --policy "$dir/$name/policy.rdm" --onnx "$dir/$name.onnx" --safetensors "$dir/$name.safetensors" \
    --probe "$dir/$name.json" --probes 1000 > /dev/null || failed=1
  [ -z "$reason" ] && { node "$here/onnx_compare.cjs" "$modules" "$dir/$name.onnx" "$dir/$name.json" 1e-5 || failed=1; }
}
policy tanh --set hidden=64,64 --set activation=tanh
policy elu --set hidden=128,64,32 --set activation=elu
policy relu --set hidden=32 --set activation=relu
policy bare --set hidden=16,16 --set normalize_obs=false
policy state --set hidden=16,16 --set std_mode=state
policy part --set hidden=16,16 --set 'actor_obs=proprioception,object.*' --set 'critic_obs=!goal.*'
policy squashed --task ball_run --algo sac_lag --set hidden=16,16 --set start_steps=64 --set batch_rows=32
policy bounded --task ball_run --algo td3_lag --set hidden=16,16 --set start_steps=64 --set batch_rows=32
policy gru --set memory=gru:13 --set hidden=16
policy team_gru --algo mappo --set memory=gru:5 --set hidden=16
policy past --set history=4 --set hidden=16 --set 'history_fields=object.*'
drawn='--set scale.kp=0.8..1.2 --set show_dynamics=true --set latent=3 --set latent_hidden=9 --set hidden=16'
# shellcheck disable=SC2086
policy latent $drawn
# shellcheck disable=SC2086
policy student $drawn --set latent_from=history --set history=4 --set 'history_fields=*.joint_position,object.*' --set std_mode=state
cloud='--set encoder_points=32 --set cloud_width=24 --set cloud_height=24'
# shellcheck disable=SC2086
policy eyes --set encoder=16,24 --set actor_obs=vision --set hidden=16,16 $cloud
# shellcheck disable=SC2086
policy kinds --set encoder=8,8,9 --set encoder_classes=4 --set encoder_activation=elu --set encoder_origin=0.1,-0.2,0.9 \
  --set encoder_range=0.4 --set hidden=16 --set std_mode=state $cloud
# shellcheck disable=SC2086
policy tints --set encoder=8,9 --set encoder_classes=5 --set encoder_color=on --set goal_points=8 --set hidden=16 $cloud
# shellcheck disable=SC2086
policy flat --set encoder=12 --set encoder_activation=tanh --set hidden=16 --set normalize_obs=false $cloud
# eyes beside a history, and beside a latent of a teacher and of a student
# shellcheck disable=SC2086
policy eyes_past --set encoder=16,24 --set actor_obs=vision --set history=3 --set 'history_fields=*.joint_position' --set hidden=16 $cloud
# shellcheck disable=SC2086
policy eyes_latent $drawn --set encoder=8,12 --set encoder_classes=4 $cloud
# shellcheck disable=SC2086
policy eyes_student $drawn --set encoder=8,12 --set encoder_color=on --set latent_from=history --set history=3 --set 'history_fields=*.joint_position' $cloud

command -v python3 > /dev/null && python3 - "$dir" << 'EOF' || failed=1
import json, math, struct, sys
for name in "tanh elu relu bare state part eyes kinds tints flat".split():
    data = open(f"{sys.argv[1]}/{name}.safetensors", "rb").read()
    (n,) = struct.unpack("<Q", data[:8])
    head = json.loads(data[8:8 + n])
    meta = head.pop("__metadata__")
    body = data[8 + n:]
    at, t = 0, {}
    for key, v in head.items():
        begin, end = v["data_offsets"]
        assert begin == at and v["dtype"] == "F32" and end - begin == 4 * math.prod(v["shape"]), key
        at, t[key] = end, struct.unpack(f"<{(end - begin) // 4}f", body[begin:end])
    assert at == len(body)
    assert ("normalizer.shift" in t) == (name not in ("bare", "flat")), sorted(t)
    x = t["example.obs"]
    if "normalizer.shift" in t:
        c = t["normalizer.clip"][0]
        x = [min(c, max(-c, (a - b) * s)) for a, b, s in zip(x, t["normalizer.shift"], t["normalizer.scale"])]
    kinds = {"tanh": math.tanh, "elu": lambda z: z if z > 0 else math.expm1(z), "relu": lambda z: max(0.0, z)}
    def run(net, x, f):
        layers = sum(1 for key in t if key.startswith(net) and key.endswith(".weight"))
        for l in range(layers):
            w, b = t[f"{net}.{l}.weight"], t[f"{net}.{l}.bias"]
            x = [b[o] + math.fsum(w[o * len(x) + i] * x[i] for i in range(len(x))) for o in range(len(b))]
            if l + 1 < layers:
                x = [f(z) for z in x]
        return x
    f = kinds[meta["activation"]]
    if "encoder.0.weight" in t:
        points, count = t["example.points"], int(meta["num_points"])
        assert head["example.points"]["shape"] == [count, 3], head["example.points"]
        seen = [[round(1000 * (points[3 * p + k] - t["encoder.origin"][k])) / 1000 / t["encoder.range"][0] for k in range(3)]
                for p in range(count)]
        for p in range(count if "example.point_class" in t else 0):
            seen[p] += [float(c == t["example.point_class"][p]) for c in range(int(meta["num_point_classes"]))]
        for p in range(count if "example.point_color" in t else 0):
            seen[p] += [c / 255 for c in t["example.point_color"][3 * p:3 * p + 3]]
        act = kinds[meta["encoder_activation"]]
        x = list(x) + [act(max(z)) for z in zip(*(run("encoder", row, act) for row in seen))]
    x = run("actor", x, f)
    gap = max(abs(min(1, max(-1, a)) - b) for a, b in zip(x, t["example.action"]))
    assert gap < 1e-5, (name, gap)
    assert meta.get("observation_preset") == ("vision" if name == "eyes" else None), meta
    ranges = [tuple(map(int, r.split(".."))) for r in meta["observation_entries"].split()]
    assert any(a <= 374 <= b for a, b in ranges) == (name != "eyes"), meta  # where the object is
    assert meta["task"] == "hand_over_safe_finger" and len(meta["layout_hash"]) == 16, meta
EOF

"$tool" export --policy hold --onnx "$dir/x.onnx" > /dev/null 2>&1
[ $? -eq 2 ] || { echo "a baseline was exported"; failed=1; }
"$tool" export --policy "$dir/tanh" > /dev/null 2>&1
[ $? -eq 2 ] || { echo "an export of nothing is no usage error"; failed=1; }
[ $failed -eq 0 ] || exit 1
[ -z "$reason" ] || { echo "skipped onnxruntime: $reason"; exit 77; }
