"""Garments with their pictures: what networks that look at pictures learn from."""

from collections.abc import Collection
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Bool, Float32, Int16, UInt8
from torch import Tensor

from garmentimage.dataset import raster_arrays, read_tables, shard_files, shard_metadata
from garmentimage.errors import DatasetError, quoted
from garmentimage.learn.data.rasters import Rasters, from_channels
from garmentimage.system import did_you_mean, shown_path

PICTURE, PANELS = "picture_front", "panels"
BODY = 1
"""In a map of panels; what is more is cloth."""
WAIST, REACH = 0.61, 0.06
"""Where the waist is in pictures of the recipes, as a share of their height from below, and how far
from there a seam at the waist may show."""
LEAST_SEEN, STEEPEST = 4, 3
"""Columns of pixels in which a seam shows, at the least, and how far from its middle row."""


@dataclass  # not frozen: Fabric casts its fields where precision is mixed
class Pictured:
    """Pictures and rasters of some garments."""

    pictures: UInt8[Tensor, "n 3 pixel_row pixel_col"]
    """Seen from the front, the lowest row of pixels first, as rasters are."""
    cloth: Bool[Tensor, "n pixel_row pixel_col"]
    """Where the garment is in the picture."""
    waist: Int16[Tensor, "n pixel_col"]
    """The lowest row of pixels above the waist seam; where there is none, above the waist."""
    inside: Tensor
    types: Tensor
    vectors: Tensor
    """Of their rasters, see `Rasters`."""

    def __len__(self) -> int:
        return len(self.pictures)

    @property
    def rasters(self) -> Rasters:
        """Without their pictures."""
        return Rasters(self.inside, self.types, self.vectors)

    def batch(self, numbers: Tensor) -> "Pictured":
        """Some of them."""
        return Pictured(
            self.pictures[numbers],
            self.cloth[numbers],
            self.waist[numbers],
            self.inside[numbers],
            self.types[numbers],
            self.vectors[numbers],
        )

    def to(self, device: torch.device) -> "Pictured":
        """The same on another device."""
        return Pictured(
            self.pictures.to(device),
            self.cloth.to(device),
            self.waist.to(device),
            self.inside.to(device),
            self.types.to(device),
            self.vectors.to(device),
        )

    def mirrored(self, which: Bool[Tensor, " n"]) -> "Pictured":
        """The same, but those of them with left and right exchanged."""
        other = self.rasters.mirrored()
        there = which[:, None, None, None]
        return Pictured(
            torch.where(there, self.pictures.flip(-1), self.pictures),
            torch.where(there[:, 0], self.cloth.flip(-1), self.cloth),
            torch.where(there[:, 0, 0], self.waist.flip(-1), self.waist),
            torch.where(there, other.inside, self.inside),
            torch.where(there, other.types, self.types),
            torch.where(there, other.vectors, self.vectors),
        )

    def seen(self) -> Float32[Tensor, "n 3 pixel_row pixel_col"]:
        """Colours from 0 to 1."""
        return self.pictures.float() / 255


@dataclass(frozen=True)
class Album:
    """Garments of a split with the ids and types of their rows, and their patterns."""

    garments: Pictured
    ids: tuple[str, ...]
    types: tuple[str, ...]
    patterns: tuple[str, ...]
    """As JSON."""


def read_album(folder: str | Path, split: str, *, without: Collection[str] = ()) -> Album:
    """All garments of a split but those of some types.

    Raises:
        DatasetError: there is no such split, it has no pictures from the front, or its garments
            have more than two layers.
    """
    pictures: list[np.ndarray] = []
    cloth: list[np.ndarray] = []
    waists: list[np.ndarray] = []
    images: list[np.ndarray] = []
    told: dict[str, list[str]] = {"id": [], "type": [], "pattern": []}
    known = shard_metadata(shard_files(folder, split)[0]).types
    for name in without:
        if name not in known:
            raise DatasetError(
                f"the dataset has no type {quoted(name)}; {did_you_mean(name, known)}"
            )
    for table in read_tables(folder, split, [*told, "raster", PICTURE, PANELS]):
        kinds = table["type"].to_pylist()
        kept = [k for k, name in enumerate(kinds) if name not in without]
        here = raster_arrays(table["raster"])
        if any(len(here[k]) != 2 for k in kept):
            raise DatasetError(f"{shown_path(folder)}: has garments of more than one cloth layer")
        images += [here[k] for k in kept]
        shown = table[PICTURE].to_pylist()
        pictures += [pixels(shown[k]["bytes"]) for k in kept]
        panels = table[PANELS].to_pylist()
        maps = [panel_map(panels[k]["bytes"]) for k in kept]
        cloth += [each > BODY for each in maps]
        waists += [waist_rows(each) for each in maps]
        for name, values in told.items():
            column = table[name].to_pylist()
            values += [column[k] for k in kept]
    if not images:
        raise DatasetError(f"{shown_path(folder)}: its split {quoted(split)} has no rows")
    found = from_channels(np.stack(images))
    garments = Pictured(
        torch.from_numpy(np.stack(pictures)),
        torch.from_numpy(np.stack(cloth)),
        torch.from_numpy(np.stack(waists)),
        found.inside,
        found.types,
        found.vectors,
    )
    return Album(garments, *(tuple(values) for values in told.values()))


def pixels(data: bytes) -> UInt8[np.ndarray, "3 pixel_row pixel_col"]:
    """A picture of the dataset, the lowest row first."""
    from PIL import Image

    colours = np.array(Image.open(BytesIO(data)).convert("RGB"))
    return np.ascontiguousarray(colours[::-1].transpose(2, 0, 1))


def panel_map(data: bytes) -> UInt8[np.ndarray, "pixel_row pixel_col"]:
    """Which panel is seen where, of a row of the dataset, the lowest row first."""
    from PIL import Image

    return np.ascontiguousarray(np.array(Image.open(BytesIO(data)))[::-1])


def waist_rows(panels: UInt8[np.ndarray, "pixel_row pixel_col"]) -> Int16[np.ndarray, " pixel_col"]:
    """The lowest row above the waist seam, in each column of pixels.

    A seam shows where one panel lies above another near the waist. Columns in which it does not
    have the row that is the middle of the others; without any, that of the waist.
    """
    rows = len(panels)
    waist, reach = round(WAIST * rows), round(REACH * rows)
    near = panels[waist - reach - 1 : waist + reach + 1]
    is_seam = (near[1:] != near[:-1]) & (near[1:] > BODY) & (near[:-1] > BODY)
    apart = np.where(is_seam, np.abs(np.arange(-reach, reach + 1))[:, None], rows)
    found, there = apart.argmin(0) + waist - reach, is_seam.any(0)
    if there.sum() < LEAST_SEEN:
        return np.full(panels.shape[1], waist, np.int16)
    middle = int(np.median(found[there]))
    there &= np.abs(found - middle) <= STEEPEST
    return np.where(there, found, middle).astype(np.int16)
