"""PNG from arrays, by zlib alone."""
from __future__ import annotations

import struct
import zlib

from ._rows import Array


def _chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def encode(rgb: Array) -> bytes:
    """The bytes of a PNG file for rgb [height][width][3] bytes."""
    height, width, _ = rgb.shape
    raw = b"".join(b"\0" + rgb[y].tobytes() for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", header) + _chunk(b"IDAT", zlib.compress(raw, 6)) +
            _chunk(b"IEND", b""))
