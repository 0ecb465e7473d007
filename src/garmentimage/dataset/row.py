"""Rows of a dataset: a garment with its raster, pictures and metadata.

A row depends only on the recipe, the seed and its number.
"""

import json
import re
import zlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from garmentimage.body import wearer
from garmentimage.dataset.recipe import GarmentType, Recipe
from garmentimage.dataset.vocabulary import captions
from garmentimage.draft import Sample, sample
from garmentimage.drape import DrapedGarment, drape_pattern
from garmentimage.errors import DatasetError, GarmentImageError, quoted
from garmentimage.pattern.files import pattern_to_spec
from garmentimage.raster.encode import encode
from garmentimage.render import png_bytes
from garmentimage.render.worn import Look, map_bytes, photograph

SCHEMA = 3
"""Version of the columns and metadata of a shard. Rasters of version 2 have channel contract 1."""
NONDETERMINISTIC = ("seconds",)
"""Fields of a drape report that differ between runs."""
_LOOK, _BODY, _FABRIC = range(3)
"""Independent random streams of a row."""


@dataclass(frozen=True)
class RowTask:
    """Which row to make."""

    recipe: Recipe
    seed: int
    grid: int
    type_number: int
    index: int
    """Number of the row among those of its type."""

    @property
    def type(self) -> GarmentType:
        """The type of garment."""
        return self.recipe.types[self.type_number]

    @property
    def split(self) -> str:
        """The split of the row."""
        return self.recipe.split(self.type, self.index)

    @property
    def row_id(self) -> str:
        """A unique name within the recipe."""
        return f"{self.recipe.name}-{self.type_number:02d}-{self.index:07d}"

    def random(self, stream: int) -> np.random.Generator:
        """Random numbers of this row, by stream."""
        return np.random.default_rng([*self._key, self.index, stream])

    @property
    def garment_seed(self) -> int:
        """Seed of the garments of this type, so that types of one kind have different garments."""
        state = np.random.SeedSequence(self._key).generate_state(2, np.uint32)
        return int(state[0]) << 31 | int(state[1]) >> 1

    @property
    def _key(self) -> list[int]:
        return [self.seed, zlib.crc32(self.recipe.name.encode()), self.type_number]


@dataclass(frozen=True)
class FailedRow:
    """A row that could not be made."""

    row_id: str
    stage: str
    """`draft`, `encode` or `drape`."""
    reason: str


def make_row(task: RowTask) -> dict[str, Any] | FailedRow:
    """One row, or the reason why it could not be made.

    Returns:
        `id`, `recipe`, `version`, `type`, `kind`, `seed`, `index`, `split`, `body`, `fabric`,
        `parameters` and `pattern` (JSON), `captions`, `raster` (float32, layer x 26 x N x N), and,
        where the recipe has pictures: `pictures` (PNG bytes by view), `panels` (the mask of the
        first view as PNG bytes) and `report` (JSON).
    """
    recipe, stage = task.recipe, "draft"
    body = _body(task)
    fabric = _chosen(task, _FABRIC, recipe.fabrics)
    try:
        garment = draft_garment(task)
        stage = "encode"
        image = encode(garment.pattern, task.grid)
        row = _metadata(task, garment, body, fabric)
        channels = image.to_channels(2)
        row["raster"] = channels.reshape(image.layers, -1, task.grid, task.grid)
        stage = "drape"
        if recipe.views:
            worn = drape_pattern(garment.pattern, wearer(body), fabric=fabric)
            if worn.report.faults:
                return FailedRow(task.row_id, stage, "; ".join(worn.report.faults))
            row |= _pictures(task, worn)
    except GarmentImageError as error:
        return FailedRow(task.row_id, stage, str(error))
    return row


def draft_garment(task: RowTask) -> Sample:
    """The garment of a row.

    Raises:
        DraftError: it cannot be drafted.
    """
    kind, fixed = task.type.kind, task.type.fixed
    drawn = sample(kind, 1, task.garment_seed, body=_body(task), fixed=fixed, first=task.index)
    return next(drawn)


def task_from_id(recipe: Recipe, row_id: str, seed: int, grid: int = 16) -> RowTask:
    """The task of a row, from its id.

    Raises:
        DatasetError: the recipe has no such row.
    """
    found = re.fullmatch(re.escape(recipe.name) + r"-(\d{2})-(\d{7,})", row_id, re.ASCII)
    if found is None or int(found[1]) >= len(recipe.types):
        raise DatasetError(f"recipe {recipe.name} has no row {quoted(row_id)}")
    return RowTask(recipe, seed, grid, int(found[1]), int(found[2]))


def _body(task: RowTask) -> str:
    return _chosen(task, _BODY, task.recipe.wearers(task.split))


def _chosen(task: RowTask, stream: int, names: tuple[str, ...]) -> str:
    return names[int(task.random(stream).random() * len(names))]


def _metadata(task: RowTask, garment: Sample, body: str, fabric: str) -> dict[str, Any]:
    parameters = garment.record()["parameters"]
    return {
        "id": task.row_id,
        "recipe": task.recipe.name,
        "version": task.recipe.version,
        "type": task.type.name,
        "kind": task.type.kind,
        "seed": task.seed,
        "index": task.index,
        "split": task.split,
        "body": body,
        "fabric": fabric,
        "parameters": _json_text(parameters),
        "pattern": _json_text(pattern_to_spec(garment.pattern)),
        "captions": list(captions(task.type.kind, parameters)),
    }


def _pictures(task: RowTask, worn: DrapedGarment) -> dict[str, Any]:
    recipe, pictures, panels = task.recipe, {}, b""
    random = task.random(_LOOK)
    plain = Look(colours={**Look().colours, **recipe.colours})
    look = Look.random(random) if recipe.look == "random" else plain
    for view in recipe.views:
        views = photograph(worn, look, view=view, size=recipe.picture)
        pictures[view] = png_bytes(views.colour)
        panels = panels or map_bytes(views, "panels")
    report = {
        key: value for key, value in asdict(worn.report).items() if key not in NONDETERMINISTIC
    }
    return {"pictures": pictures, "panels": panels, "report": _json_text(report)}


def _json_text(data: Mapping[str, Any]) -> str:
    return json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
