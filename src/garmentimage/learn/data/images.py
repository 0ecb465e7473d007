"""Garments with their images: the data of the networks that take images."""

from collections.abc import Collection
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Bool, Float, Int8, Int16, UInt8
from torch import Tensor

from garmentimage.dataset import read_tables, shard_files, shard_metadata
from garmentimage.errors import DatasetError, quoted
from garmentimage.learn.data.rasters import Rasters, column_rasters
from garmentimage.learn.data.rows import ImageRows, join_rows
from garmentimage.system import did_you_mean

PICTURE_COLUMN, PANELS_COLUMN = "picture_front", "panels"
BODY_LABEL = 1
"""Label of the body in a map of panels; 0 is the background, larger labels are panels."""
WAIST_HEIGHT, WAIST_REACH = 0.61, 0.06
"""Height of the waist in the images of the recipes, as a share of the image's height from below,
and how far from there a waist seam may lie."""
MIN_SEAM_COLUMNS, MAX_SEAM_OFFSET = 4, 3
"""A waist seam is seen in so many columns of pixels, and within so many rows of its median row."""


@dataclass
class ImagedGarments(ImageRows):
    """Images and rasters of some garments."""

    pictures: UInt8[Tensor, "n 3 pixel_row pixel_col"]
    """Front views, RGB from 0 to 255, the lowest row of pixels first as in rasters."""
    cloth: Bool[Tensor, "n pixel_row pixel_col"]
    """Pixels that show the garment."""
    waist: Int16[Tensor, "n pixel_col"]
    """The lowest row of pixels above the waist seam; without a seam, above the waist."""
    inside: Int8[Tensor, "n 2 row col"]
    types: Int8[Tensor, "n 4 row col"]
    vectors: Float[Tensor, "n 16 row col"]
    """The fields of their `Rasters`."""

    @property
    def rasters(self) -> Rasters:
        """Their rasters alone."""
        return Rasters(self.inside, self.types, self.vectors, self.inside[:, :0])

    def mirrored(self, which: Bool[Tensor, " n"]) -> "ImagedGarments":
        """The same, with left and right exchanged for the garments that `which` selects."""
        other = self.rasters.mirrored()
        chosen = which[:, None, None, None]
        return ImagedGarments(
            torch.where(chosen, self.pictures.flip(-1), self.pictures),
            torch.where(chosen[:, 0], self.cloth.flip(-1), self.cloth),
            torch.where(chosen[:, 0, 0], self.waist.flip(-1), self.waist),
            torch.where(chosen, other.inside, self.inside),
            torch.where(chosen, other.types, self.types),
            torch.where(chosen, other.vectors, self.vectors),
        )


@dataclass(frozen=True)
class ImageSplit:
    """The garments of a dataset split, with ids, types and patterns."""

    garments: ImagedGarments
    ids: tuple[str, ...]
    types: tuple[str, ...]
    patterns: tuple[str, ...]
    """As JSON."""


def load_split(folder: str | Path, split: str, *, without: Collection[str] = ()) -> ImageSplit:
    """Load the garments of a split.

    Args:
        folder: of the dataset.
        split: its name, such as `train`.
        without: garment types that are left out.

    Raises:
        DatasetError: there is no such split or type, the split has no front views, or its garments
            have more than two layers.
    """
    import pyarrow as pa
    import pyarrow.compute as pc

    known = shard_metadata(shard_files(folder, split)[0]).types
    for name in without:
        if name not in known:
            raise DatasetError(
                f"the dataset has no type {quoted(name)}; {did_you_mean(name, known)}"
            )
    left_out = pa.array(list(without), pa.string())
    parts: list[ImagedGarments] = []
    columns: dict[str, list[str]] = {"id": [], "type": [], "pattern": []}
    for table in read_tables(folder, split, [*columns, "raster", PICTURE_COLUMN, PANELS_COLUMN]):
        table = table.filter(pc.invert(pc.is_in(table["type"], left_out)))
        if not len(table):
            continue
        pictures, maps = (
            [read(each["bytes"]) for each in table[name].to_pylist()]
            for name, read in ((PICTURE_COLUMN, read_pixels), (PANELS_COLUMN, read_panel_map))
        )
        arrays = pictures, [each > BODY_LABEL for each in maps], [waist_rows(each) for each in maps]
        tensors = [torch.from_numpy(np.stack(each)) for each in arrays]
        rasters = column_rasters(table["raster"], folder)
        cloth = [rasters.inside, rasters.types, rasters.vectors]
        parts.append(ImagedGarments(*tensors, *cloth))
        for name, values in columns.items():
            values += table[name].to_pylist()
    garments = join_rows(parts, folder, split)
    return ImageSplit(garments, *(tuple(values) for values in columns.values()))


def read_pixels(data: bytes) -> UInt8[np.ndarray, "3 pixel_row pixel_col"]:
    """An encoded image of the dataset as RGB, the lowest row first."""
    from PIL import Image

    colours = np.array(Image.open(BytesIO(data)).convert("RGB"))
    return np.ascontiguousarray(colours[::-1].transpose(2, 0, 1))


def read_panel_map(data: bytes) -> UInt8[np.ndarray, "pixel_row pixel_col"]:
    """The panel label of every pixel (see `BODY_LABEL`), the lowest row first."""
    from PIL import Image

    return np.ascontiguousarray(np.array(Image.open(BytesIO(data)))[::-1])


def waist_rows(panels: UInt8[np.ndarray, "pixel_row pixel_col"]) -> Int16[np.ndarray, " pixel_col"]:
    """The lowest row above the waist seam, for each column of pixels.

    The seam is seen where one panel lies above another within `WAIST_REACH` of the waist. Columns
    without one get the median row of the others, and all columns that of the waist where fewer
    than `MIN_SEAM_COLUMNS` show a seam.
    """
    rows = len(panels)
    waist, reach = round(WAIST_HEIGHT * rows), round(WAIST_REACH * rows)
    band = panels[waist - reach - 1 : waist + reach + 1]
    is_seam = (band[1:] != band[:-1]) & (band[1:] > BODY_LABEL) & (band[:-1] > BODY_LABEL)
    apart = np.where(is_seam, np.abs(np.arange(-reach, reach + 1))[:, None], rows)
    rows_found, has_seam = apart.argmin(0) + waist - reach, is_seam.any(0)
    if has_seam.sum() < MIN_SEAM_COLUMNS:
        return np.full(panels.shape[1], waist, np.int16)
    middle = int(np.median(rows_found[has_seam]))
    has_seam &= np.abs(rows_found - middle) <= MAX_SEAM_OFFSET
    return np.where(has_seam, rows_found, middle).astype(np.int16)
