"""Messages between programs of a farm: the length of a JSON object, the object, the length of bytes, and these."""

from __future__ import annotations

import json
import struct
from typing import IO, Any

Message = tuple[dict[str, Any], bytes]

LONGEST = 128 << 20
"""Bytes of the longest object."""


def send(out: IO[bytes], message: dict[str, Any], data: bytes = b"") -> None:
    """Writes a message."""
    text = json.dumps(message, separators=(",", ":")).encode()
    out.write(struct.pack("<I", len(text)) + text + struct.pack("<Q", len(data)))
    out.write(data)
    out.flush()


def receive(source: IO[bytes]) -> Message | None:
    """Reads a message; None at the end of the source.

    Raises:
        EOFError: in the middle of a message.
        ValueError: for what is no message.
    """
    head = source.read(4)
    if not head:
        return None
    (length,) = struct.unpack("<I", head + _exactly(source, 4 - len(head)))
    if length > LONGEST:
        raise ValueError("this is no message")
    message = json.loads(_exactly(source, length))
    if not isinstance(message, dict):
        raise ValueError("this is no message")
    (size,) = struct.unpack("<Q", _exactly(source, 8))
    return message, _exactly(source, size)


def _exactly(source: IO[bytes], count: int) -> bytes:
    pieces = []
    while count:
        piece = source.read(min(count, 1 << 24))
        if not piece:
            raise EOFError("a message was cut off")
        pieces.append(piece)
        count -= len(piece)
    return b"".join(pieces)
