"""A TensorBoard event file: the rows of progress.csv as scalars under the names of its columns. The bytes are those that
`redman train` writes for the same rows.

A record is its length, a masked CRC-32C of that, an Event of TensorBoard's event.proto, a masked CRC-32C of that.
"""
from __future__ import annotations

import struct
from typing import Iterable, Mapping

_MOST = 3e38  # of a number that a float holds
_STEPS = ("TotalEnvSteps", "Train/TotalSteps")


def file_name(unix_seconds: int) -> str:
    return f"events.out.tfevents.{unix_seconds}.redman"


def head(unix_seconds: int) -> bytes:
    """The beginning of the file."""
    return _record(_double(1, float(unix_seconds)) + _text(3, b"brain.Event:2"))


def row(cells: Mapping[str, str], unix_seconds: int) -> bytes:
    """A row of progress.csv, with its cells as written there."""
    values = {name: float(text) for name, text in cells.items()}
    scalars = b"".join(_text(1, _text(1, name.encode()) + _key(2, 5) + struct.pack("<f", value))
                       for name, value in sorted(values.items()) if name not in _STEPS and abs(value) <= _MOST)
    total = values["Time/Total"]
    return _record(_double(1, unix_seconds + (0.0 if total != total else total)) +
                   _key(2, 0) + _varint(int(values["TotalEnvSteps"])) + _text(5, scalars))


def _key(field: int, kind: int) -> bytes:
    return _varint(field << 3 | kind)


def _double(field: int, value: float) -> bytes:
    return _key(field, 1) + struct.pack("<d", value)


def _text(field: int, data: bytes) -> bytes:
    return _key(field, 2) + _varint(len(data)) + data


def _varint(value: int) -> bytes:
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    out.append(value)
    return bytes(out)


def _table() -> Iterable[int]:
    for i in range(256):
        for _ in range(8):
            i = i >> 1 ^ (0x82f63b78 if i & 1 else 0)
        yield i


_CRC = tuple(_table())


def crc32c(data: bytes) -> int:
    """CRC-32C, Castagnoli."""
    crc = 0xffffffff
    for byte in data:
        crc = crc >> 8 ^ _CRC[(crc ^ byte) & 255]
    return crc ^ 0xffffffff


def _masked(data: bytes) -> bytes:
    crc = crc32c(data)
    return struct.pack("<I", ((crc >> 15 | crc << 17) + 0xa282ead8) & 0xffffffff)


def _record(event: bytes) -> bytes:
    length = struct.pack("<Q", len(event))
    return length + _masked(length) + event + _masked(event)
