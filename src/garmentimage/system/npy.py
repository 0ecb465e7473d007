"""Reading `.npy` and `.npz` from strangers: no pickles, no surprises, sizes checked before use.

numpy's own reader makes room for whatever a header promises before it looks at the data. Here a
header is believed only when the data that follows has exactly the size it tells.
"""

import io
import math
import struct
import tokenize
import zipfile
import zlib

import numpy as np

from garmentimage.errors import ImageError

NPY_MAGIC = b"\x93NUMPY"
ZIP_MAGIC = b"PK"
MAX_ARCHIVE_BYTES = 160 * 2**20  # largest sum of the unpacked arrays of an `.npz` [bytes]
MAX_MEMBERS = 64  # most arrays in an `.npz`
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


def parse_npy(data: bytes) -> np.ndarray:
    """The array in the bytes of a `.npy` file, native byte order, read-only.

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
        raise ImageError(f"not a numpy array ({_first_line(error)})") from None
    shape, fortran_order, dtype = header
    if dtype.kind not in "biuf":
        raise ImageError(f"it holds {dtype.kind!r} values, wanted plain numbers")
    if min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != len(data) - stream.tell():
        raise ImageError(f"the header says shape {shape}, the data has another size")
    flat = np.frombuffer(data, dtype=dtype, offset=stream.tell())
    try:
        array = flat.reshape(shape, order="F" if fortran_order else "C")
    except (ValueError, TypeError) as error:  # a thousand axes, or an empty one beside a huge one.
        raise ImageError(f"not a numpy array ({_first_line(error)})") from None
    return array.astype(dtype.newbyteorder("="), copy=False)


def parse_npz(
    data: bytes, wanted: tuple[str, ...], optional: tuple[str, ...] = ()
) -> dict[str, np.ndarray]:
    """The wanted arrays in the bytes of an `.npz` file, and the optional ones that it has.

    Raises:
        ImageError: a damaged archive, a missing array, or arrays that unpack to too much.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = {info.filename: info for info in archive.infolist()}
            if len(members) > MAX_MEMBERS:
                raise ImageError(f"{len(members)} arrays; a GarmentImage has fewer")
            missing = [name for name in wanted if f"{name}.npy" not in members]
            if missing:
                raise ImageError(f"not a GarmentImage, the array {missing[0]!r} is missing")
            names = (*wanted, *(name for name in optional if f"{name}.npy" in members))
            chosen = {name: members[f"{name}.npy"] for name in names}
            if any(info.compress_type not in PACKINGS for info in chosen.values()):
                raise ImageError("packed in a way that no .npz is; save it again")
            if sum(info.file_size for info in chosen.values()) > MAX_ARCHIVE_BYTES:
                raise ImageError(f"unpacks to more than {MAX_ARCHIVE_BYTES / 2**20:.0f} MiB")
            parts = {name: _unpacked(archive, info) for name, info in chosen.items()}
    except _BAD_ARCHIVE as error:
        if isinstance(error, ImageError):
            raise
        raise ImageError(f"a damaged archive ({_first_line(error)})") from None
    arrays = {}
    for name, part in parts.items():
        try:
            arrays[name] = parse_npy(part)
        except ImageError as error:
            raise ImageError(f"array {name!r}: {error}") from None
    return arrays


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
