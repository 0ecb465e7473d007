"""Rasters of true garments by source, for benchmarks of repair: kept in a folder once made."""

import hashlib
import warnings
from collections.abc import Iterator
from pathlib import Path

from tqdm import tqdm

import garmentimage as gi
from garmentimage.draft.kind import KINDS
from garmentimage.draft.sampling import ANY_BODY, sample
from garmentimage.errors import GarmentImageError

DRAFTS = "drafts"


def true_rasters(
    folder: Path | None, grid: int, count: int, kept: Path
) -> dict[str, gi.GarmentImage]:
    """Images of the first patterns of a folder, in order of the hash of their names.

    Args:
        folder: pattern files; None: drafts of every kind, as many of each, seed 0.
        grid: cells a side.
        count: of patterns; those that do not encode are left out.
        kept: where images are kept, and looked for.

    Returns:
        By name of the file, or of the draft.
    """
    source = folder.name if folder else DRAFTS
    images = {}
    patterns = _drafts(count) if folder is None else _files(folder, count)
    for name, pattern in tqdm(patterns, f"{source}, N = {grid}", disable=None, leave=False):
        file = kept / f"{source}-{grid}" / f"{name}.npz"
        refused = file.with_suffix(".refused")
        if refused.exists():
            continue
        if not file.exists():
            file.parent.mkdir(parents=True, exist_ok=True)
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    given = gi.load_pattern(pattern) if isinstance(pattern, Path) else pattern
                gi.save_image(gi.encode(given, grid), file)
            except GarmentImageError as error:
                refused.write_text(str(error), encoding="utf-8")
                continue
        images[name] = gi.load_image(file)
    return images


def is_validation(name: str) -> bool:
    """Whether a garment is kept from fitting: one in four, by a hash of its name."""
    return _hash(name)[0] < 64


def _hash(name: str) -> bytes:
    return hashlib.sha256(name.encode()).digest()


def _files(folder: Path, count: int) -> list[tuple[str, Path]]:
    files = [file for file in folder.rglob("*.json") if not file.name.endswith("_manifest.json")]
    first = sorted(files, key=lambda file: (_hash(file.name), str(file)))[:count]
    return [("-".join(file.relative_to(folder).with_suffix("").parts), file) for file in first]


def _drafts(count: int) -> Iterator[tuple[str, gi.Pattern]]:
    for kind in KINDS:
        for one in sample(kind, -(-count // len(KINDS)), 0, body=ANY_BODY):
            yield f"{kind}-{one.index}", one.pattern
