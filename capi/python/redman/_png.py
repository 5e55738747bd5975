"""PNG from arrays, by zlib alone."""
from __future__ import annotations

import struct
import zlib

from typing import Sequence

import numpy as np

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


def row(pictures: Sequence[Array]) -> bytes:
    """A PNG of pictures of one height side by side, with a thin white line between them."""
    line = np.full((pictures[0].shape[0], 2, 3), 255, np.uint8)
    return encode(np.concatenate([part for picture in pictures for part in (line, picture)][1:], axis=1))
