#!/bin/sh
# test_tool_eyes.sh TOOL: a policy that sees points is trained by reward, by a teacher and after pretraining, the same for any
# threads, plays by its file alone, and is measured.
. "$(dirname "$0")/tool.sh"
small='--envs 8 --set max_steps=20 --set hidden=16,16 --set horizon=4 --eval-every 4 --checkpoint-every 2 --steps 3000 --no-tensorboard'
eyes='--set encoder=8,16 --set encoder_points=64 --set actor_obs=vision --set cloud_width=32 --set cloud_height=32'

# shellcheck disable=SC2086
"$tool" train $small $eyes --out whole > out 2>&1 || { cat out; exit 1; }
for word in '"modality": "points"' '"points": "64"' '"sense_every": "4"' '"encoder": "8,16"'; do
  grep -qF -- "$word" whole/config.json || { echo "config.json has no $word"; failed=1; }
done
# shellcheck disable=SC2086
"$tool" train $small $eyes --threads 2 --out two > out 2>&1 || { cat out; failed=1; }
cmp -s whole/policy.rdm two/policy.rdm || { echo "two threads make another policy"; failed=1; }

# Without its folder a file says itself what it sees.
cp whole/policy.rdm alone.rdm
"$tool" eval --policy alone.rdm --set max_steps=20 --episodes 4 --json > row 2> err || { cat err; failed=1; }
"$tool" rollout --policy whole --episodes 2 --json > row 2> err || { cat err; failed=1; }
"$tool" render --policy whole --strip 2 --size 64x48 --out strip.png > out 2>&1 || { cat out; failed=1; }
cp strip.png plain.png
"$tool" render --policy whole --strip 2 --size 64x48 --cloud --out strip.png --json > row || { cat row; failed=1; }
grep -q '"width":128,"height":96' row || { echo "a strip with clouds: $(cat row)"; failed=1; }
cmp -s strip.png plain.png && { echo 'no cloud was drawn'; failed=1; }
"$tool" render --policy zero --cloud > out 2> err
{ [ $? -eq 2 ] && grep -q 'modality=points' err; } || { echo "clouds of worlds without: $(cat err)"; failed=1; }

# What it sees can be made worse, and the thing another one; a cloud of another size is not its own.
"$tool" eval --policy alone.rdm --set max_steps=20 --episodes 4 --json > base 2> err || failed=1
for set in point_noise=0.05 point_dropout=0.9 camera_noise=0.2 object=ball cloud_cameras=front; do
  "$tool" eval --policy alone.rdm --set max_steps=20 --set $set --episodes 4 --json > row 2> err || { echo "$set: $(cat err)"; failed=1; }
  cmp -s base row && { echo "$set changes nothing"; failed=1; }
done
"$tool" eval --policy alone.rdm --set points=32 --episodes 1 > out 2> err && { echo 'a smaller cloud was taken'; failed=1; }
grep -q 'points=64' err || { echo "a smaller cloud: $(cat err)"; failed=1; }
"$tool" eval --policy alone.rdm --set modality=state --episodes 1 > out 2> err && { echo 'a blind pool was taken'; failed=1; }
grep -q 'modality=points' err || { echo "blind: $(cat err)"; failed=1; }

# A policy that reads the state teaches one that sees; the encoder first learns to tell points apart.
# shellcheck disable=SC2086
"$tool" train $small --out state > out 2>&1 || { cat out; failed=1; }
# shellcheck disable=SC2086
"$tool" train $small $eyes --from state --dagger 1 --demo-decisions 8 --clone-epochs 2 --pretrain 40 --pretrain-epochs 2 \
  --save-recording shown.npz --out taught --json > json 2> err || { cat err; failed=1; }
grep -q '"clone":{"rows":' json && grep -q '"pretrain":{"clouds":36' json || { echo "taught: $(cat json)"; failed=1; }
# shellcheck disable=SC2086
"$tool" train $small $eyes --from shown.npz --clone-epochs 2 --out cloned > out 2>&1 || { cat out; failed=1; }
# shellcheck disable=SC2086
"$tool" train $small --pretrain 10 --out blind > out 2> err && { echo 'a blind agent was pretrained'; failed=1; }
grep -q 'encoder' err || { echo "pretrain: $(cat err)"; failed=1; }

# Its weights go out by name (what the files do: test_tool_export.sh, test_tool_export_c.sh).
"$tool" export --policy alone.rdm --safetensors eyes.safetensors > out 2>&1 && grep -q 'encoder.0.weight' eyes.safetensors ||
  { echo "no weights: $(cat out)"; failed=1; }

"$tool" bench policy --modality points --points 64 --envs 4 --seconds 0.2 --set cloud_width=24 --set cloud_height=24 --json > row ||
  failed=1
for key in cloud_ms encoder_ms update_ms samples_per_second frames_per_second; do
  grep -q "\"$key\":[0-9-]" row || { echo "bench policy has no $key: $(cat row)"; failed=1; }
done
exit $failed
