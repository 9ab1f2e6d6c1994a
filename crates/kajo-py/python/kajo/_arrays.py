"""Files that a scene names and that are arrays: meshes, and pictures for textures, heights and surroundings."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

Table = tuple[bytes, list[tuple[memoryview, int]]]
"""Rows: what each begins with, and columns, each the bytes of an array and the bytes of its rows."""


class ArrayFile:
    """A file that is made of arrays. These are read where they lie, and are kept for as long as the file is.

    Args:
        ending: of its name, which tells its format.
        tables: what is in it, one after the other: the bytes that each row begins with, and its arrays, one row a row.
    """

    def __init__(self, ending: str, tables: Sequence[tuple[bytes, Sequence[npt.NDArray[Any]]]]) -> None:
        self.ending = ending
        self._tables = [(before, list(arrays)) for before, arrays in tables]

    def _parts(self) -> list[Table]:
        """The tables as the native module takes them."""
        return [
            (before, [(array.data.cast("B"), array.itemsize * _row_items(array)) for array in arrays])
            for before, arrays in self._tables
            if all(array.size for array in arrays)
        ]

    def tobytes(self) -> bytes:
        """The bytes of the file."""
        import numpy as np

        out = []
        for before, arrays in self._tables:
            if not arrays:
                out.append(before)
                continue
            rows = len(arrays[0])
            columns = [np.frombuffer(before * rows, np.uint8).reshape(rows, len(before))] if before else []
            columns += [
                np.frombuffer(array.data.cast("B"), np.uint8).reshape(rows, -1)
                for array in arrays
                if array.size
            ]
            out.append(np.hstack(columns).tobytes() if columns else b"")
        return b"".join(out)

    def __repr__(self) -> str:
        size = sum(array.nbytes for _, arrays in self._tables for array in arrays)
        return f"<kajo.ArrayFile {self.ending}: {size} bytes>"


def _row_items(array: npt.NDArray[Any]) -> int:
    return array.size // len(array) if len(array) else 1


def _floats(what: str, value: npt.ArrayLike, width: int, rows: int | None = None) -> npt.NDArray[np.float32]:
    """An array of rows of numbers in single precision, the same one where it is that already."""
    import numpy as np

    array = np.asarray(value)
    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8:
        raise TypeError(f"{what}: an array of floats is wanted, and this one is of {array.dtype}")
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"{what}: the shape is to be (n, {width}), and it is {array.shape}")
    if rows is not None and len(array) != rows:
        raise ValueError(f"{what}: there are {len(array)} rows for {rows} vertices")
    result: npt.NDArray[np.float32] = np.ascontiguousarray(array, dtype=np.float32)
    return result


def mesh_file(
    vertices: npt.ArrayLike,
    faces: npt.ArrayLike,
    *,
    normals: npt.ArrayLike | None = None,
    uvs: npt.ArrayLike | None = None,
    colors: npt.ArrayLike | None = None,
) -> ArrayFile:
    """A mesh of triangles, for the field `file` of `TriangleMesh`.

    Contiguous arrays of float32 and of uint32 or int32 are read where they lie; others are converted first.

    Args:
        vertices: (n, 3), floats.
        faces: (m, 3), whole numbers: which vertices a triangle has, anticlockwise seen from outside.
        normals: (n, 3), floats.
        uvs: (n, 2), floats: coordinates on textures.
        colors: (n, 3), or (n, 4) with alpha: linear floats, or 8-bit values for a screen.

    Raises:
        TypeError: for arrays of other types.
        ValueError: for arrays of other shapes, and for faces of vertices that are not there.
    """
    import numpy as np

    points = _floats("vertices", vertices, 3)
    columns: list[npt.NDArray[Any]] = [points]
    properties = ["float x", "float y", "float z"]
    if normals is not None:
        columns.append(_floats("normals", normals, 3, len(points)))
        properties += ["float nx", "float ny", "float nz"]
    if uvs is not None:
        columns.append(_floats("uvs", uvs, 2, len(points)))
        properties += ["float u", "float v"]
    if colors is not None:
        column = np.asarray(colors)
        width = column.shape[1] if column.ndim == 2 and column.shape[1] in (3, 4) else 3
        if column.dtype == np.uint8:
            if column.shape != (len(points), width):
                raise ValueError(
                    f"colors: the shape is to be ({len(points)}, 3) or ({len(points)}, 4), and it is {column.shape}"
                )
            columns.append(np.ascontiguousarray(column))
        else:
            columns.append(_floats("colors", column, width, len(points)))
        kind = "uchar" if column.dtype == np.uint8 else "float"
        properties += [f"{kind} {name}" for name in ("red", "green", "blue", "alpha")[:width]]

    indices = np.asarray(faces)
    if indices.dtype.kind not in "iu":
        raise TypeError(f"faces: an array of whole numbers is wanted, and this one is of {indices.dtype}")
    if indices.ndim != 2 or indices.shape[1] != 3:
        raise ValueError(f"faces: the shape is to be (m, 3), and it is {indices.shape}")
    if indices.size and not 0 <= int(indices.min()) <= int(indices.max()) < len(points):
        wrong = int(np.argmax(((indices < 0) | (indices >= len(points))).any(axis=1)))
        raise ValueError(f"faces: row {wrong} is {indices[wrong].tolist()}, and there are {len(points)} vertices")
    narrow = indices.dtype in (np.uint32, np.int32) and indices.flags.c_contiguous and indices.dtype.isnative
    corners = indices if narrow else np.ascontiguousarray(indices, dtype=np.uint32)

    header = ["ply", f"format binary_{_order()}_endian 1.0", f"element vertex {len(points)}"]
    header += [f"property {name}" for name in properties]
    header += [f"element face {len(corners)}", "property list uchar uint vertex_indices", "end_header", ""]
    return ArrayFile("ply", [("\n".join(header).encode(), []), (b"", columns), (b"\x03", [corners])])


def picture_file(pixels: npt.ArrayLike) -> ArrayFile:
    """A picture, for textures, `HeightField` and the environment of `Background`.

    Args:
        pixels: (height, width) or (height, width, channels), row 0 on top. Of uint8 or uint16 with 1 to 4 channels:
            grey, grey and alpha, RGB or RGBA, values for a screen. Of floats with 1 or 3: linear amounts.

    Raises:
        TypeError: for arrays of other types.
        ValueError: for arrays of other shapes.
    """
    import numpy as np

    array = np.asarray(pixels)
    if array.ndim == 2:
        array = array[:, :, np.newaxis]
    if array.ndim != 3 or 0 in array.shape or array.shape[2] > 4:
        raise ValueError(
            f"pixels: the shape is to be (height, width) or (height, width, 1 to 4), and it is {np.shape(pixels)}"
        )
    height, width, channels = array.shape
    if array.dtype in (np.uint8, np.uint16):
        depth = array.dtype.itemsize * 8
        rows = np.ascontiguousarray(array.astype(array.dtype.newbyteorder(">"))).reshape(height, -1).view(np.uint8)
        filtered = np.hstack([np.zeros((height, 1), np.uint8), rows])
        return ArrayFile("png", [(_png(width, height, depth, channels, filtered.tobytes()), [])])
    if array.dtype.kind != "f" or array.dtype.itemsize > 8:
        raise TypeError(f"pixels: an array of uint8, uint16 or floats is wanted, and this one is of {array.dtype}")
    if channels not in (1, 3):
        raise ValueError(f"pixels: a picture of floats has 1 or 3 channels, and this one has {channels}")
    # PFM begins with the bottom row.
    floats = np.ascontiguousarray(array[::-1], dtype=np.float32)
    scale = "-1.0" if _order() == "little" else "1.0"
    header = f"{'PF' if channels == 3 else 'Pf'}\n{width} {height}\n{scale}\n"
    return ArrayFile("pfm", [(header.encode(), []), (b"", [floats.reshape(height, -1)])])


def _order() -> str:
    import sys

    return sys.byteorder


def _png(width: int, height: int, depth: int, channels: int, rows: bytes) -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    kind = (0, 4, 2, 6)[channels - 1]
    head = struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0)
    data = zlib.compress(rows, 1)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", data) + chunk(b"IEND", b"")
