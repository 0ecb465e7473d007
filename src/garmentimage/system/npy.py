"""Reading `.npy` and `.npz` from strangers: no pickles, no surprises, sizes checked before use.

numpy's own reader makes room for whatever a header promises before it looks at the data. Here a
header is believed only when the data that follows has exactly the size it tells.
"""

import io
import math
import os
import struct
import tokenize
import zipfile
import zlib
from pathlib import Path

import numpy as np

from garmentimage.errors import ImageError
from garmentimage.system.files import shown_path

NPY_MAGIC = b"\x93NUMPY"
ZIP_MAGIC = b"PK"
FILE_LIMIT = 160 * 2**20
"""Largest file that is read [bytes]: 16 layers of 256 x 256 cells in float64 fit."""
ARCHIVE_LIMIT = 160 * 2**20
"""Largest sum of the unpacked arrays of an `.npz` [bytes]."""
MEMBER_LIMIT = 64
"""Most arrays in an `.npz`."""
PACKINGS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""What numpy writes; zipfile unpacks the others without any bound on memory."""

_BAD_HEADER = (ValueError, TypeError, SyntaxError, tokenize.TokenError, struct.error)
_BAD_ARCHIVE = (
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    OSError,
    ValueError,
    RuntimeError,  # an encrypted member; also NotImplementedError: a packing that is not known
    struct.error,
)


def read_file(path: Path) -> bytes:
    """The bytes of a file of sensible size.

    Raises:
        ImageError: not a readable file, or larger than `FILE_LIMIT`.
    """
    try:
        if not path.is_file():
            reason = "is no ordinary file" if os.path.lexists(path) else "there is no such file"
            raise ImageError(f"{shown_path(path)}: {'is a folder' if path.is_dir() else reason}")
        size = path.stat().st_size
        if size > FILE_LIMIT:
            raise ImageError(
                f"{shown_path(path)}: {size / 2**20:.0f} MiB; a GarmentImage is far smaller"
            )
        return path.read_bytes()
    except (OSError, ValueError) as error:
        if isinstance(error, ImageError):
            raise
        reason = getattr(error, "strerror", None) or _first_line(error)
        raise ImageError(f"{shown_path(path)}: cannot be read ({reason})") from None


def parse_npy(data: bytes, where: str) -> np.ndarray:
    """The array in the bytes of a `.npy` file, native byte order, read-only.

    Args:
        data: the whole file.
        where: what to call it in messages.

    Raises:
        ImageError: not a `.npy` file, Python objects inside, or data that does not fit the header.
    """
    stream = io.BytesIO(data)
    try:
        version = np.lib.format.read_magic(stream)
        if version == (1, 0):
            header = np.lib.format.read_array_header_1_0(stream)
        else:
            header = np.lib.format.read_array_header_2_0(stream)
    except (*_BAD_HEADER, RecursionError, MemoryError) as error:
        raise ImageError(f"{where}: not a numpy array ({_first_line(error)})") from None
    shape, fortran_order, dtype = header
    if dtype.kind not in "biuf":
        raise ImageError(f"{where}: holds {dtype.kind!r} values, wanted plain numbers")
    if min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != len(data) - stream.tell():
        raise ImageError(f"{where}: the header tells of shape {shape}, the data has another size")
    flat = np.frombuffer(data, dtype=dtype, offset=stream.tell())
    try:
        array = flat.reshape(shape, order="F" if fortran_order else "C")
    except (ValueError, TypeError) as error:  # A thousand axes, or an empty one beside a huge one.
        raise ImageError(f"{where}: not a numpy array ({_first_line(error)})") from None
    return array.astype(dtype.newbyteorder("="), copy=False)


def parse_npz(data: bytes, where: str, wanted: tuple[str, ...]) -> dict[str, np.ndarray]:
    """The wanted arrays in the bytes of an `.npz` file.

    Raises:
        ImageError: a damaged archive, a missing array, or arrays that unpack to too much.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = {info.filename: info for info in archive.infolist()}
            if len(members) > MEMBER_LIMIT:
                raise ImageError(f"{where}: {len(members)} arrays; a GarmentImage has fewer")
            missing = [name for name in wanted if f"{name}.npy" not in members]
            if missing:
                raise ImageError(
                    f"{where}: not a GarmentImage, the array {missing[0]!r} is missing"
                )
            chosen = {name: members[f"{name}.npy"] for name in wanted}
            if any(info.compress_type not in PACKINGS for info in chosen.values()):
                raise ImageError(f"{where}: packed in a way that no .npz is; save it again")
            if sum(info.file_size for info in chosen.values()) > ARCHIVE_LIMIT:
                raise ImageError(f"{where}: unpacks to more than {ARCHIVE_LIMIT / 2**20:.0f} MiB")
            parts = {name: _unpacked(archive, info) for name, info in chosen.items()}
    except _BAD_ARCHIVE as error:
        if isinstance(error, ImageError):
            raise
        raise ImageError(f"{where}: a damaged archive ({_first_line(error)})") from None
    return {name: parse_npy(part, f"{where}, {name}") for name, part in parts.items()}


def _unpacked(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> bytes:
    """A member up to the size that it declares.

    Asked for all of it, zipfile would unpack as much as the data holds before it cuts it off.
    """
    with archive.open(info) as member:
        return member.read(info.file_size + 1)


def npz_bytes(arrays: dict[str, np.ndarray]) -> bytes:
    """The bytes of an `.npz` file; the same arrays give the same bytes."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays.items():
            # A `ZipInfo` of its own dates every member 1980: no clock in the file.
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), npy_bytes(array), zipfile.ZIP_DEFLATED)
    return stream.getvalue()


def npy_bytes(array: np.ndarray) -> bytes:
    """The bytes of a `.npy` file."""
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.ascontiguousarray(array), allow_pickle=False)
    return stream.getvalue()


def _first_line(error: BaseException) -> str:
    text = str(error) or type(error).__name__
    return text.splitlines()[0][:120]
