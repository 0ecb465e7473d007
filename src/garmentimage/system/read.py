"""Reading files that others made: never more than a limit, and named in every error."""

import io
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from garmentimage.errors import GarmentImageError
from garmentimage.system.files import is_device, shown_path

CHUNK = 2**20  # read at a time [bytes]


def read_limited(
    path: str | os.PathLike[str],
    limit: int,
    error: type[GarmentImageError],
    *,
    kind: str,
    too_large: str,
    must_be_ordinary: bool = False,
) -> bytes:
    """The bytes of a file; no more than `limit` of them are ever held in memory.

    Args:
        path: the file. It may be a pipe, as `/dev/stdin` is.
        limit: largest size [bytes].
        error: what is raised; the message does not name the file, see `errors_about`.
        kind: what such a file is, as "pattern file", for the message about a folder.
        too_large: what to say about a larger file, as "export a coarser body".
        must_be_ordinary: refuse pipes and devices, on which reading may never end.
    """
    try:
        if must_be_ordinary and is_device(Path(path)):
            raise error("is not an ordinary file; copy its content to one")
        with Path(path).open("rb") as file:
            raw = _read(file, limit + 1)
    except FileNotFoundError:
        raise error("there is no such file; check its name") from None
    except IsADirectoryError:
        raise error(f"is a folder; name a {kind} in it") from None
    except GarmentImageError:
        raise
    except (OSError, ValueError) as reason:
        text = getattr(reason, "strerror", None) or str(reason)
        raise error(f"cannot be read ({text})") from None
    if len(raw) > limit:
        raise error(f"is larger than {limit // 1_000_000} MB; {too_large}")
    return raw


def _read(file: BinaryIO, size: int) -> bytes:
    """At most `size` bytes; asked for all of them at once, Python makes room for them first."""
    chunks = io.BytesIO()
    while size > chunks.tell() and (chunk := file.read(min(CHUNK, size - chunks.tell()))):
        chunks.write(chunk)
    return chunks.getvalue()


@contextmanager
def errors_about(path: str | os.PathLike[str]) -> Iterator[None]:
    """Let the message of every `GarmentImageError` raised inside begin with the path, once."""
    try:
        yield
    except GarmentImageError as error:
        name = shown_path(path)
        if not str(error).startswith(name):
            # Not an error made anew: its class may take other arguments and have further fields.
            error.args = (f"{name}: {error}",)
        raise
