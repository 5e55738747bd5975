#!/bin/sh
# test_tool_events.sh TOOL: the event file that train writes beside progress.csv says the same, in records that a reader
# of another make (a few lines of Python) takes; a run that was killed and goes on has no row twice.
. "$(dirname "$0")/tool.sh"
command -v python3 > /dev/null || { echo "skipped: there is no python3"; exit 77; }
cat > read.py << 'END'
import csv, glob, math, struct, sys

def crc32c(data):
    crc = 0xffffffff
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82f63b78 if crc & 1 else 0)
    return crc ^ 0xffffffff

def masked(data):
    crc = crc32c(data)
    return ((crc >> 15 | crc << 17) + 0xa282ead8) & 0xffffffff

def fields(data):
    at = 0
    def varint():
        nonlocal at
        value = shift = 0
        while True:
            byte = data[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value
    while at < len(data):
        key = varint()
        if key & 7 == 0:
            yield key >> 3, varint()
            continue
        size = {1: 8, 5: 4}.get(key & 7) or varint()
        yield key >> 3, data[at:at + size]
        at += size

def events(path):
    data, at = open(path, 'rb').read(), 0
    while at < len(data):
        length, check = struct.unpack_from('<QI', data, at)
        assert masked(data[at:at + 8]) == check, 'the length of a record does not match its sum'
        body = data[at + 12:at + 12 + length]
        assert masked(body) == struct.unpack_from('<I', data, at + 12 + length)[0], 'a record does not match its sum'
        at += 16 + length
        event = dict(wall=None, step=0, version=None, values={})
        for number, value in fields(body):
            if number == 1: event['wall'] = struct.unpack('<d', value)[0]
            if number == 2: event['step'] = value
            if number == 3: event['version'] = value.decode()
            if number == 5:
                for _, scalar in fields(value):
                    parts = dict(fields(scalar))
                    event['values'][parts[1].decode()] = struct.unpack('<f', parts[2])[0]
        yield event

folder = sys.argv[1]
files = glob.glob(folder + '/events.out.tfevents.*')
assert len(files) == 1, files
begun = int(files[0].split('tfevents.')[1].split('.')[0])
head, *rows = events(files[0])
assert head['version'] == 'brain.Event:2' and head['wall'] == begun
table = list(csv.DictReader(open(folder + '/progress.csv')))
assert len(table) == len(rows) > 0, (len(table), len(rows))
for row, event in zip(table, rows):
    assert event['step'] == int(row['TotalEnvSteps'])
    assert abs(event['wall'] - begun - float(row['Time/Total'])) < 1e-3
    for name in ('TotalEnvSteps', 'Train/TotalSteps'):
        del row[name]
    want = {k: float(v) for k, v in row.items() if not math.isnan(float(v))}
    assert set(event['values']) == set(want), set(event['values']) ^ set(want)
    for name, value in want.items():
        assert abs(event['values'][name] - value) <= 1e-6 * abs(value) + 1e-30, (name, value, event['values'][name])
END
reads_same() {  # reads_same FOLDER WHAT
  python3 read.py "$1" > out 2>&1 || { echo "$2: $(tail -n 1 out)"; failed=1; }
}
flags='--task ball_run --envs 4 --set max_steps=20 --set horizon=25 --set hidden=16,16 --checkpoint-every 4'
# shellcheck disable=SC2086
"$tool" train $flags --steps 4000 --out run > out 2> err || { cat err; exit 1; }
reads_same run 'a run'
name=$(ls run | grep tfevents)

for rows in 3 6 11; do  # killed between checkpoints
  rm -rf broken
  # shellcheck disable=SC2086
  "$tool" train $flags --steps 4000 --out broken > /dev/null 2>&1 &
  pid=$!
  while kill -0 $pid 2> /dev/null && { [ ! -f broken/progress.csv ] || [ "$(wc -l < broken/progress.csv)" -lt $rows ]; }; do
    sleep 0.01
  done
  kill -9 $pid 2> /dev/null
  wait $pid 2> /dev/null
  before=$(ls broken | grep tfevents)
  "$tool" train --resume broken > /dev/null 2> err || { echo "resume failed: $(cat err)"; failed=1; }
  [ "$(ls broken | grep tfevents)" = "$before" ] || { echo "a resumed run writes $(ls broken)"; failed=1; }
  reads_same broken "a run that was killed at row $rows and went on"
done
# a file that was spoiled or lost is written again
printf 'x' >> "run/$name"
"$tool" train --resume run --steps 4400 > out 2> err || { cat err; failed=1; }
reads_same run 'a spoiled file'
rm "run/$name"
"$tool" train --resume run --steps 4800 > out 2> err || { cat err; failed=1; }
reads_same run 'a lost file'
# shellcheck disable=SC2086
"$tool" train $flags --steps 1000 --out run --overwrite > out 2> err || { cat err; failed=1; }
reads_same run 'a run in the place of another'
# shellcheck disable=SC2086
"$tool" train $flags --steps 1000 --out without --no-tensorboard > out 2> err || { cat err; failed=1; }
"$tool" train --resume without --steps 2000 > out 2> err || { cat err; failed=1; }
ls without | grep tfevents && { echo "--no-tensorboard writes events"; failed=1; }
exit $failed
