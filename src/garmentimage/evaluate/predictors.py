"""Predictors of patterns from pictures: cascades, other networks, and baselines without one."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float32, UInt8

from garmentimage.compare import pattern_faults
from garmentimage.errors import DecodeError, LearnError
from garmentimage.networks import decoded_garment
from garmentimage.pattern import Pattern
from garmentimage.predict import PREDICTOR_FILE, PatternPredictor, certainty
from garmentimage.raster.repair import RepairLevel
from garmentimage.system import shown_path

if TYPE_CHECKING:
    from garmentimage.learn.data import ImageSplit

PredictorKind = Literal["cascade", "slots", "nearest", "random", "flags", "types", "vectors"]
TEACHER_STAGES: tuple[PredictorKind, ...] = ("flags", "types", "vectors")
"""Cascades with ground truth up to flags, edge types, or all: the error of each stage."""
SEED = 30
THUMBNAIL = 32
"""Pixels a side at which pictures are compared."""


@dataclass(frozen=True)
class Predictor:
    """A predictor, by its network and settings."""

    name: str
    """Networks of one name differ only in their seed, and are averaged."""
    kind: PredictorKind
    folder: str = ""
    """Of the network, if it is one."""
    level: RepairLevel = "full"
    """Of repair, if images are predicted."""

    @property
    def label(self) -> str:
        """What tables call it."""
        return self.name if self.level == "full" else f"{self.name}, {self.level}"

    @property
    def key(self) -> str:
        """A unique name, for its records."""
        parts = [self.name, self.level if self.level != "full" else "", Path(self.folder).name]
        if self.folder and Path(self.folder).name == "model":
            parts[-1] = Path(self.folder).parent.name
        return " ".join(part for part in parts if part)


@dataclass(frozen=True)
class PredictedPattern:
    """A predicted pattern."""

    pattern: Pattern | None
    fault: str
    """Why it cannot be cut and sewn; empty if it can."""
    repairs: dict[str, int]
    """Number of repairs by rule."""
    confidence: float | None = None


@runtime_checkable
class PredictFunction(Protocol):
    """Guesses patterns of the garments of an album."""

    def __call__(self, album: "ImageSplit", number: int) -> PredictedPattern:
        """The pattern of one of its pictures."""


@cache
def load_predictor(predictor: Predictor, data: str, held_out: str = "") -> PredictFunction:
    """Load a predictor, once in each process.

    Args:
        predictor: the predictor.
        data: folder of the dataset, for the nearest training picture.
        held_out: a type to leave out of it.
    """
    folder = Path(predictor.folder)
    if predictor.kind == "cascade":
        return _Cascade(PatternPredictor(folder), predictor.level)
    if predictor.kind == "slots":
        return _Slots(folder)
    if predictor.kind == "nearest":
        return _Nearest(data, held_out)
    if predictor.kind == "random":
        return _random
    return _TeacherForced(folder, predictor.kind, predictor.level)


def predictor_kind(folder: Path) -> PredictorKind:
    """The kind of predictor in a folder."""
    if (folder / PREDICTOR_FILE).is_file():
        return "cascade"
    if _slot_network(folder):
        return "slots"
    raise LearnError(
        f"{shown_path(folder)}: holds no network from pictures to patterns; give the folder "
        "`model` of a run"
    )


# --- Networks ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Cascade:
    """Three U-Nets, in onnxruntime."""

    network: PatternPredictor
    level: RepairLevel

    def __call__(self, album: "ImageSplit", number: int) -> PredictedPattern:
        upright = album.garments.pictures[number].numpy()[:, ::-1].transpose(1, 2, 0)
        channels = self.network.channels(upright[None])[0]
        return _from_channels(channels, self.level)


class _TeacherForced:
    """A cascade whose first stages are replaced by ground truth (teacher forcing)."""

    def __init__(self, folder: Path, given: PredictorKind, level: RepairLevel) -> None:
        import torch

        from garmentimage.learn import load_weights
        from garmentimage.learn.models import Cascade, Stage

        torch.set_num_threads(1)
        self.model, self.given, self.level = load_weights(Cascade, folder), Stage(given), level

    def __call__(self, album: "ImageSplit", number: int) -> PredictedPattern:
        import torch

        garment = album.garments.batch(torch.tensor([number]))
        with torch.no_grad():
            channels = self.model.predict(garment.images(), garment.rasters, self.given)
        return _from_channels(channels[0].numpy(), self.level)


class _Slots:
    """A baseline that gives panels and stitches."""

    def __init__(self, folder: Path) -> None:
        import torch

        from garmentimage.learn import load_weights
        from garmentimage.learn.models import SLOT_NETWORKS

        torch.set_num_threads(1)
        self.model: Any = load_weights(SLOT_NETWORKS[_slot_network(folder)].network, folder)

    def __call__(self, album: "ImageSplit", number: int) -> PredictedPattern:
        import torch

        from garmentimage.learn.data import pattern_from

        seen = album.garments.batch(torch.tensor([number])).images()
        with torch.no_grad():
            found = self.model.predict(seen)
        try:
            pattern = pattern_from(found, 0, self.model.config.vocabulary)
        except DecodeError as error:
            return PredictedPattern(None, str(error), {})
        return _validated(pattern)


def _slot_network(folder: Path) -> str:
    """Which baseline a folder holds; empty if none."""
    from garmentimage.learn.models import SLOT_NETWORKS

    try:
        config = json.loads((folder / "config.json").read_text(encoding="utf-8"))
        return config["network"] if config["network"] in SLOT_NETWORKS else ""
    except (OSError, ValueError, KeyError, TypeError):
        return ""


def _from_channels(
    channels: Float32[np.ndarray, "34 row col"], level: RepairLevel
) -> PredictedPattern:
    step = decoded_garment(np.zeros(0, np.float32), channels, level)
    repairs = dict(step.repairs.counts) if step.repairs else {}
    fault = step.faults[0] if step.faults else ""
    return PredictedPattern(step.pattern, fault, repairs, certainty(channels))


def _validated(pattern: Pattern) -> PredictedPattern:
    faults = pattern_faults(pattern)
    return PredictedPattern(pattern, faults[0] if faults else "", {})


# --- Baselines -----------------------------------------------------------------------------------


class _Nearest:
    """The garment of the nearest picture in the training split."""

    def __init__(self, data: str, held_out: str) -> None:
        from garmentimage.dataset import read_rows
        from garmentimage.learn.data import PICTURE_COLUMN, read_pixels

        self.data = data
        self.patterns: list[str] = []
        thumbs = []
        for name, pattern, picture in read_rows(data, "train", "type", "pattern", PICTURE_COLUMN):
            if name != held_out:
                self.patterns.append(pattern)
                thumbs.append(_reduced_picture(read_pixels(picture["bytes"])))
        self.thumbs = np.stack(thumbs)

    def __call__(self, album: "ImageSplit", number: int) -> PredictedPattern:
        from garmentimage.dataset import parse_patterns

        apart = np.abs(self.thumbs - _reduced_picture(album.garments.pictures[number].numpy())).sum(
            1
        )
        (pattern,) = parse_patterns([self.patterns[int(apart.argmin())]], self.data)
        return _validated(pattern)


def _reduced_picture(picture: UInt8[np.ndarray, "3 row col"]) -> Float32[np.ndarray, " number"]:
    """A reduced picture as a vector."""
    size = picture.shape[1] // THUMBNAIL
    blocks = picture.reshape(3, THUMBNAIL, size, THUMBNAIL, size).astype(np.float32)
    reduced: Float32[np.ndarray, " number"] = blocks.mean((2, 4)).ravel()
    return reduced


def _random(album: "ImageSplit", number: int) -> PredictedPattern:
    """A random other garment of the same type: the value of knowing only the type."""
    from garmentimage.dataset import parse_patterns

    others = [k for k, t in enumerate(album.types) if t == album.types[number] and k != number]
    if not others:
        return PredictedPattern(None, "there is no other garment of its type", {})
    chosen = others[int(np.random.default_rng([SEED, number]).integers(len(others)))]
    (pattern,) = parse_patterns([album.patterns[chosen]], "the dataset")
    return _validated(pattern)


def predictors_from_names(names: Sequence[str]) -> list[Predictor]:
    """Predictors from `NAME=FOLDER` or folders alone; cascades first.

    Raises:
        LearnError: a folder holds none.
    """
    found = []
    for each in names:
        name, _, folder = each.rpartition("=")
        place = Path(folder)
        if (place / "model").is_dir():
            place = place / "model"
        label = name or (place.parent.name if place.name == "model" else place.name)
        found.append(Predictor(label, predictor_kind(place), str(place)))
    return sorted(found, key=lambda predictor: predictor.kind != "cascade")
