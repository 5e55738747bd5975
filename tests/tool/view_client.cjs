// view_client.cjs ADDRESS [SECONDS]: a window without a page, which confirms each frame at once. Plays to the end of an episode, or
// for so many seconds, and prints what came as JSON: the hash of the worlds at the end, frames, seconds of playing.
'use strict';
const crypto = require('crypto'), http = require('http');
const [address, seconds] = process.argv.slice(2);
const url = new URL(address);
const frame = text => {
  const payload = Buffer.from(text), key = crypto.randomBytes(4), wide = payload.length < 126 ? 0 : 2;
  const head = Buffer.from([0x81, 0x80 | (wide ? 126 : payload.length), ...(wide ? [payload.length >> 8, payload.length & 255] : []), ...key]);
  return Buffer.concat([head, payload.map((b, i) => b ^ key[i % 4])]);
};
const request = http.request({ host: url.hostname, port: url.port, path: url.pathname + 'live', headers: {
  Connection: 'Upgrade', Upgrade: 'websocket', Origin: url.origin, 'Sec-WebSocket-Version': 13, 'Sec-WebSocket-Key': crypto.randomBytes(16).toString('base64') } });
request.on('response', r => { throw new Error('status ' + r.statusCode); });
request.on('upgrade', (_, socket, first) => {
  let waiting = first, frames = 0, began = 0, bytes = 0, last = 0, longest = 0;
  const tell = what => socket.write(frame(JSON.stringify(what)));
  const hear = (kind, payload) => {
    if (kind === 1) {
      const said = JSON.parse(payload.toString());
      if (said.id !== 1) return;
      console.log(JSON.stringify({ hash: said.hash, frames, seconds: (last - began) / 1000, longest_ms: longest, bytes }));
      process.exit();
    }
    if (kind !== 2) return;
    const head = JSON.parse(payload.subarray(4, 4 + payload.readUInt32LE(0)).toString()), now = performance.now();
    tell({ do: 'shown' });
    if (head.plays || frames) {
      if (!frames) began = now;
      else longest = Math.max(longest, now - last);
      last = now;
      ++frames;
      bytes = payload.length;
    }
    if (seconds ? now - began > 1000 * seconds && frames : frames && !head.plays) tell({ do: 'hash', id: 1 });
  };
  socket.on('data', data => {
    waiting = Buffer.concat([waiting, data]);
    while (waiting.length >= 2) {
      const short = waiting[1] & 127, wide = short < 126 ? 0 : short === 126 ? 2 : 8;
      if (waiting.length < 2 + wide) return;
      const size = wide === 0 ? short : wide === 2 ? waiting.readUInt16BE(2) : Number(waiting.readBigUInt64BE(2));
      if (waiting.length < 2 + wide + size) return;
      hear(waiting[0] & 15, waiting.subarray(2 + wide, 2 + wide + size));
      waiting = waiting.subarray(2 + wide + size);
    }
  });
  tell({ do: 'stops', on: !seconds });
  tell({ do: 'play', on: true });
});
request.end();
