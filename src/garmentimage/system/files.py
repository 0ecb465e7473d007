"""Files on disk: writing them whole or not at all, and naming them safely."""

import contextlib
import os
import secrets
import stat
import unicodedata
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path

from garmentimage.errors import OutputError, quoted

FILE_NAME_BYTES = 100
"""Longest file name that `safe_name` makes, in UTF-8; every common file system takes 255."""
RESERVED_NAMES = {"con", "prn", "aux", "nul"} | {
    f"{d}{k}" for d in ("com", "lpt") for k in range(10)
}
"""Names of devices, which Windows refuses for files."""


def shown_path(path: str | os.PathLike[str]) -> str:
    """A path as a message shows it: as the user wrote it unless it would break the line."""
    text = os.fspath(path)
    return text if text and text.isprintable() else quoted(text)


def check_output(
    out: Path, suffixes: Sequence[str], others: Iterable[str | os.PathLike[str]]
) -> None:
    """Refuse an output path before any work is done for it.

    Its name must have one of the suffixes; `others` are inputs and further outputs of the same
    call, which it must not overwrite.

    Raises:
        OutputError: another ending, no such folder, a folder itself, or one of the others.
    """
    if out.suffix.lower() not in suffixes:
        raise OutputError(f"{shown_path(out)}: the name must end in {' or '.join(suffixes)}")
    try:
        _check_target(out, out.absolute())
        for other in map(Path, others):
            both_exist = out.exists() and other.exists()
            if out.samefile(other) if both_exist else out.resolve() == other.resolve():
                raise OutputError(
                    f"{shown_path(out)}: is an input or another output, too; "
                    "choose another name or folder"
                )
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(
            f"{shown_path(out)}: cannot be used ({error.strerror}); choose another name"
        ) from None


def write_atomically(path: str | os.PathLike[str], data: bytes | str) -> None:
    """Write a file whole or not at all: a temporary file beside it, then one rename.

    Text is written as UTF-8. A link is followed, and a device such as /dev/stdout is written to.

    Raises:
        OutputError: the folder is missing, the path is a folder, or the system refuses.
    """
    write_together({path: data})


def write_together(results: Mapping[str | os.PathLike[str], bytes | str]) -> None:
    """Write several files as `write_atomically` does, and none where one cannot be written.

    Devices come first, then a temporary file beside each path, and the renames last of all.
    """
    parts: list[tuple[Path, Path]] = []
    path: str | os.PathLike[str] = ""
    try:
        for path, data in sorted(results.items(), key=lambda item: not is_device(Path(item[0]))):
            raw = data.encode("utf-8") if isinstance(data, str) else data
            target = Path(path).resolve()
            _check_target(path, target)
            if is_device(target):
                target.write_bytes(raw)
            else:
                part = target.with_name(f".{secrets.token_hex(8)}.part")
                parts.append((part, target))
                with part.open("xb") as file:
                    file.write(raw)
                if target.exists():
                    part.chmod(stat.S_IMODE(target.stat().st_mode))
        for part, target in parts:
            part.replace(target)
    except (OSError, ValueError, RuntimeError) as error:  # RuntimeError: links that go in circles
        if isinstance(error, OutputError):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise OutputError(
            f"{shown_path(path)}: cannot be written ({reason}); choose another place"
        ) from None
    finally:
        for part, _ in parts:
            with contextlib.suppress(OSError):
                part.unlink(missing_ok=True)


def is_device(path: Path) -> bool:
    """Whether the path is that of a pipe or a device."""
    return path.exists() and not path.is_file() and not path.is_dir()


def _check_target(path: str | os.PathLike[str], target: Path) -> None:
    if target.is_dir():
        raise OutputError(f"{shown_path(path)}: is a folder; name a file in it")
    if not target.parent.is_dir():
        raise OutputError(
            f"{shown_path(path)}: there is no folder {shown_path(target.parent)}; make it first"
        )


def safe_name(name: str, taken: Collection[str] = ()) -> str:
    """A portable file name (without ending) for any text, distinct from all of `taken`.

    Letters, digits, `-` and `_` stay; the rest becomes `_`. Names that differ only in case or in
    the spelling of accents count as the same, as they do on common disks.

    Example:
        >>> safe_name("../Front panel"), safe_name("Front", ["front"])
        ('Front_panel', 'Front-2')
    """
    text = unicodedata.normalize("NFC", name)
    text = "".join(c if c.isalnum() or c in "-_" else "_" for c in text).strip("_") or "panel"
    text = _cut(text, FILE_NAME_BYTES)
    if text.casefold() in RESERVED_NAMES:
        text += "_"
    used = {_folded(other) for other in taken}
    candidate, count = text, 1
    while _folded(candidate) in used:
        count += 1
        ending = f"-{count}"
        candidate = _cut(text, FILE_NAME_BYTES - len(ending)) + ending
    return candidate


def _cut(text: str, size: int) -> str:
    return text.encode("utf-8")[:size].decode("utf-8", "ignore")


def _folded(text: str) -> str:
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", text).casefold())
