#!/bin/sh
# test_tool_mcap.sh TOOL: a set becomes an MCAP file and comes back to the byte; @mcap/core, which npm puts beside the build,
# reads it by its index (77, a skip, where there is no npm or no network); damage and foreign files are refused.
. "$(dirname "$0")/tool.sh"
modules=$(dirname "$(dirname "$tool")")/npm
reason=
if ! command -v node > /dev/null || ! command -v npm > /dev/null; then
  reason="there is no npm"
elif [ ! -d "$modules/node_modules/@mcap/nodejs" ]; then
  mkdir -p "$modules"
  npm install --ignore-scripts --no-audit --no-fund --no-save --loglevel=error --prefix "$modules" \
    @mcap/core@2.2.2 @mcap/nodejs@1.0.2 > npm.log 2>&1 < /dev/null || reason="npm cannot install @mcap/core"
fi

for set in 'two_state 300' 'ball_run 1000' 'hand_over_safe_finger 1500'; do
  # shellcheck disable=SC2086
  set -- $set
  "$tool" data make "$1" --rows "$2" --out "$1.npz" > /dev/null || failed=1
  "$tool" data convert "$1.npz" "$1.mcap" > said || failed=1
  "$tool" data convert "$1.mcap" back.npz > /dev/null || failed=1
  cmp "$1.npz" back.npz || { echo "$1: what came back is not what was given"; failed=1; }
  "$tool" data convert back.npz again.mcap > /dev/null || failed=1
  cmp "$1.mcap" again.mcap || { echo "$1: the same set gives another file"; failed=1; }
done

cat > read.cjs <<'EOS'
const at = process.argv[3] + '/node_modules/@mcap/';
const { McapIndexedReader } = require(at + 'core');
const { FileHandleReadable } = require(at + 'nodejs');
(async () => {
  const handle = await require('fs/promises').open(process.argv[2], 'r');
  const reader = await McapIndexedReader.Initialize({ readable: new FileHandleReadable(handle) });
  const count = {};
  let before = -1n, sum = 0;
  for await (const m of reader.readMessages()) {
    const channel = reader.channelsById.get(m.channelId), json = JSON.parse(Buffer.from(m.data).toString());
    const schema = JSON.parse(Buffer.from(reader.schemasById.get(channel.schemaId).data).toString());
    for (const key of Object.keys(json)) if (!(key in schema.properties)) throw new Error('no ' + key + ' in the schema');
    if (m.logTime < before) throw new Error('time runs back');
    before = m.logTime;
    count[channel.topic] = (count[channel.topic] || 0) + 1;
    if (channel.topic === '/redman/step') sum += json.cost[0];
  }
  let metadata = '';
  for await (const m of reader.readMetadata()) metadata += m.name + ' ' + m.metadata.get('format');
  await handle.close();
  if (Number(reader.statistics.messageCount) !== count['/redman/step'] + count['/redman/end']) throw new Error('the statistics miscount');
  console.log(count['/redman/step'], count['/redman/end'], sum.toFixed(3), metadata);
})().catch((e) => { console.error(e); process.exit(1); });
EOS
if [ -z "$reason" ]; then
  for task in two_state hand_over_safe_finger; do
    node read.cjs $task.mcap "$modules" > theirs || { echo "@mcap/core does not read $task.mcap"; failed=1; }
    "$tool" data info $task.npz --json > info || failed=1
    rows=$(sed 's/.*"rows":\([0-9]*\).*/\1/' info) episodes=$(sed 's/.*"episodes":\([0-9]*\),"term.*/\1/' info)
    grep -q "^$rows $episodes .* redman redman data 1$" theirs || { echo "$task: @mcap/core reads $(cat theirs), not $rows rows of $episodes episodes"; failed=1; }
  done
fi

# Episodes without an end are listed and left out.
python3 -c '
import numpy as np
a = dict(np.load("two_state.npz"))
a["terminated"][a["episode_begin"][-1] - 1] = False
np.savez("cut.npz", **a)' 2> /dev/null && {
  "$tool" data convert cut.npz cut.mcap | grep -q 'no end: 1 episodes' || { echo 'an unfinished episode is not listed'; failed=1; }
  "$tool" data convert cut.npz cut.mcap --keep-unfinished | grep -q 'no end' && { echo 'it is left out though it was asked for'; failed=1; }
}

refused() {
  says=$1
  shift
  "$tool" data convert "$@" > out 2> err && { echo "data convert $*: it is not refused"; failed=1; }
  grep -q "$says" err || { echo "data convert $*: the error does not say '$says':"; cat err; failed=1; }
  [ ! -e bad.npz ] || { echo "data convert $*: a file was left"; failed=1; }
}
head -c 20000 ball_run.mcap > bad.mcap
refused 'cut off' bad.mcap bad.npz
sed 's/"row":7,/"row":8,/' ball_run.mcap > bad.mcap
refused 'damaged' bad.mcap bad.npz
printf '\211MCAP0\r\n\017\004\000\000\000\000\000\000\000\000\000\000\000' > bad.mcap
refused 'no metadata of redman' bad.mcap bad.npz
cp two_state.npz bad.mcap
refused 'does not begin as an MCAP file' bad.mcap bad.npz
refused 'in Python' two_state.npz bad.hdf5
refused 'does not end in' two_state.npz bad.csv
[ -z "$reason" ] || { echo "skipped @mcap/core: $reason"; [ $failed -ne 0 ] || exit 77; }
exit $failed
