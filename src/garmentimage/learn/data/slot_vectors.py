"""Patterns in slots as tensors: what the vector-based baselines of Section 4.3 learn.

Every panel has a slot, by name. As in NeuralTailor and Sewformer, a panel is its edges, a rotation
(a quaternion) and a translation; every edge is free, or has a tag, a point in space that the two
edges of a stitch share. A row of an edge is (dx, dy) to its end, and how far its two control points
are from a third and two thirds of the way, along it and to its left, per length: all 0 for padding.
Those codes have one control point; sleeve caps drafted here would lose up to 6 % of IoU by that.
"""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import torch
from jaxtyping import Bool, Float, UInt8
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.errors import DecodeError, LearnError, quoted
from garmentimage.learn.data.images import Album
from garmentimage.metrics import (
    MIN_EDGES,
    PADDING_ATOL,
    quaternion,
    tag_stitches,
    universal_translation,
)
from garmentimage.pattern import Cubic, Edge, Loop, Panel, Pattern, Quadratic, Side, Stitch, Vector

CHORD_CM, BEND = 25.0, 0.25
"""Units of the ends of edges, and of their control points."""
UNITS = np.array([CHORD_CM] * 2 + [BEND] * 4)
THIRDS = np.array([1 / 3, 0, 2 / 3, 0])
STRAIGHTEST = 0.02
"""Edges whose control points are all nearer to the chord, in its length, are straight."""
PLACE_CM, CENTRE = 50.0, np.array([0.0, 100.0, 0.0])
"""Unit of translations and tags, and from where they are measured [cm]."""
ROW, TAGS = 6, 3
NUMBERS_AN_EDGE = ROW + TAGS + 1
"""Its row, its tag, and whether it is free."""
NUMBERS_A_PLACE = 4 + 3
"""Rotation and translation of a panel."""
ASKED = 10
"""Slots whose edges are asked for in training, for a garment on the average."""


@dataclass(frozen=True)
class SlotWords:
    """The slots of some garments."""

    names: tuple[str, ...]
    edges: int
    """Most edges of a panel."""


def slot_words(patterns: Sequence[Pattern]) -> SlotWords:
    """Slots for every panel of some garments."""
    panels = [panel for pattern in patterns for panel in pattern.panels]
    names = tuple(dict.fromkeys(sorted(panel.name for panel in panels)))
    return SlotWords(names, max(len(panel.outline.edges) for panel in panels))


@dataclass(frozen=True)
class SlotConfig:
    """Slots and size of a baseline."""

    network: str
    """Which of `SLOT_NETWORKS` it is of."""
    names: tuple[str, ...]
    """Of the slots."""
    edges: int
    """Most edges of a panel."""
    width: int
    layers: int
    picture: int = 128
    """Pixels a side."""
    resnet: dict[str, Any] | None = None
    """Configuration of the ResNet that looks at pictures; None for the small encoder."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", tuple(self.names))  # JSON has lists

    @property
    def words(self) -> SlotWords:
        """Its slots."""
        return SlotWords(self.names, self.edges)


@dataclass  # not frozen: Fabric casts its fields where precision is mixed
class SlotVectors:
    """Some garments in slots."""

    edges: Float[Tensor, "n slot edge 6"]
    """In `UNITS`."""
    there: Bool[Tensor, "n slot edge"]
    rotations: Float[Tensor, "n slot 4"]
    translations: Float[Tensor, "n slot 3"]
    """In `PLACE_CM` from `CENTRE`, tags as well."""
    tags: Float[Tensor, "n slot edge 3"]
    sewn: Bool[Tensor, "n slot edge"]

    def __len__(self) -> int:
        return len(self.edges)

    def batch(self, numbers: Tensor) -> "SlotVectors":
        """Some of them."""
        return SlotVectors(*(field[numbers] for field in vars(self).values()))

    def to(self, device: torch.device) -> "SlotVectors":
        """The same on another device."""
        return SlotVectors(*(field.to(device) for field in vars(self).values()))


def slot_vectors(patterns: Sequence[Pattern], words: SlotWords) -> SlotVectors:
    """Garments as tensors; slots have no place for holes.

    Raises:
        LearnError: one has a panel that is in no slot, or has too many edges.
    """
    shape = (len(patterns), len(words.names), words.edges)
    edges, counts = np.zeros((*shape, ROW)), np.zeros(shape[:2], int)
    rotations, translations = np.zeros((*shape[:2], 4)), np.zeros((*shape[:2], 3))
    tags, sewn = np.zeros((*shape, TAGS)), np.zeros(shape, bool)
    for n, pattern in enumerate(patterns):
        for panel in pattern.panels:
            count = len(panel.outline.edges)
            if panel.name not in words.names or count > words.edges:
                raise LearnError(f"panel {quoted(panel.name)} fits in none of the slots")
            at = n, words.names.index(panel.name)
            counts[at] = count
            edges[at][:count] = [_row(panel.outline, edge) for edge in panel.outline.edges]
            rotations[at] = quaternion(panel)
            translations[at] = universal_translation(panel) - CENTRE
        for stitch in pattern.stitches:
            if any(
                side.edge >= len(pattern.by_name[side.panel].outline.edges) for side in stitch.sides
            ):
                continue  # of a hole
            middle = np.mean([_middle(pattern, side) for side in stitch.sides], axis=0)
            for side in stitch.sides:
                place = n, words.names.index(side.panel), side.edge
                tags[place], sewn[place] = middle - CENTRE, True
    numbers = (edges / UNITS, rotations, translations / PLACE_CM, tags / PLACE_CM)
    rows, turns, moves, marks = (torch.from_numpy(each.astype(np.float32)) for each in numbers)
    there = torch.from_numpy(np.arange(words.edges) < counts[..., None])
    return SlotVectors(rows, there, turns, moves, marks, torch.from_numpy(sewn))


@dataclass  # not frozen either
class PicturedSlots:
    """Pictures, and garments in slots."""

    pictures: UInt8[Tensor, "n 3 pixel_row pixel_col"]
    patterns: SlotVectors

    def __len__(self) -> int:
        return len(self.pictures)

    def batch(self, numbers: Tensor) -> "PicturedSlots":
        """Some of them."""
        return PicturedSlots(self.pictures[numbers], self.patterns.batch(numbers))

    def to(self, device: torch.device) -> "PicturedSlots":
        """The same on another device."""
        return PicturedSlots(self.pictures.to(device), self.patterns.to(device))

    def seen(self) -> Float[Tensor, "n 3 pixel_row pixel_col"]:
        """Colours from 0 to 1."""
        return self.pictures.float() / 255


def pictured_slots(album: Album, patterns: Sequence[Pattern], words: SlotWords) -> PicturedSlots:
    """An album's pictures with its patterns in slots."""
    return PicturedSlots(album.garments.pictures, slot_vectors(patterns, words))


@dataclass
class SlotOutputs:
    """What a network says of some garments; as `SlotVectors`, `free` as logits."""

    edges: Float[Tensor, "n slot edge 6"]
    rotations: Float[Tensor, "n slot 4"]
    translations: Float[Tensor, "n slot 3"]
    tags: Float[Tensor, "n slot edge 3"]
    free: Float[Tensor, "n slot edge"]

    def weighted(self, weights: Float[Tensor, "n slot"]) -> "SlotOutputs":
        """The same with the edges of each slot multiplied by a weight."""
        return replace(self, edges=self.edges * weights[..., None, None])


class Usual(nn.Module):
    """What a network says before it has learnt anything: the mean of the garments to learn from.

    A network whose numbers are added to it need not find the mean first, which takes a transformer
    most of a small budget.
    """

    def __init__(self, config: SlotConfig) -> None:
        super().__init__()
        slots = len(config.names)
        self.places = nn.Parameter(torch.zeros(slots, NUMBERS_A_PLACE))
        self.edges = nn.Parameter(torch.zeros(slots, config.edges, NUMBERS_AN_EDGE))

    @torch.no_grad()
    def set_to_mean(self, known: SlotVectors) -> None:
        """Start from the mean of these."""
        self.places.copy_(torch.cat([known.rotations, known.translations], 2).mean(0))
        free = torch.logit(1 - known.sewn.float().mean(0), 0.01)[..., None]
        self.edges.copy_(torch.cat([known.edges.mean(0), known.tags.mean(0), free], 2))

    def forward(
        self, places: Float[Tensor, "n slot 7"], edges: Float[Tensor, "n slot edge 10"]
    ) -> SlotOutputs:
        """The numbers of panels and edges, added to what is usual, by what they mean."""
        turns, moves = (self.places + places).split([4, 3], 2)
        rows, tags, free = (self.edges + edges).split([ROW, TAGS, 1], 3)
        return SlotOutputs(rows, turns, moves, tags, free[..., 0])


def quiet(layer: nn.Linear) -> nn.Linear:
    """A last layer that says nothing yet."""
    nn.init.zeros_(layer.weight)
    nn.init.zeros_(layer.bias)
    return layer


def asked(panels: Bool[Tensor, "n slot"]) -> Float[Tensor, "n slot"]:
    """Which slots to ask for edges in training, as weights for what is found there.

    Of many slots most have no panel, and nothing but zeros to learn. So some of these, drawn anew
    each time, are asked for all. Their edges should be 0; with their weight their squares are, in
    the mean, those of all.

    Args:
        panels: the slots that have a panel.

    Returns:
        1 for these, 0 for those not asked.
    """
    others = (~panels).sum()
    share = ((ASKED * len(panels) - panels.sum()) / others.clamp(min=1)).clamp(1 / ASKED, 1)
    drawn = torch.rand(panels.shape, device=panels.device) < share
    return torch.where(panels, 1.0, drawn * share.rsqrt())


def in_slots(
    values: Float[Tensor, "asked edge k"], which: Bool[Tensor, "n slot"]
) -> Float[Tensor, "n slot edge k"]:
    """Values of the slots that were asked for, in their places among zeros."""
    return values.new_zeros(*which.shape, *values.shape[1:]).masked_scatter(
        which[..., None, None], values
    )


def slot_losses(found: SlotOutputs, truth: SlotVectors) -> dict[str, Tensor]:
    """Losses of both baselines: shapes, loops that close, places, and stitches; all by squares."""
    panels, sewn = truth.there[..., 0], truth.sewn
    missed = found.edges[..., :2].sum(2)[panels]
    parts = {
        "shapes": functional.mse_loss(found.edges, truth.edges),
        "loops": (missed**2).mean(),
        "rotations": functional.mse_loss(found.rotations[panels], truth.rotations[panels]),
        "translations": functional.mse_loss(found.translations[panels], truth.translations[panels]),
        "tags": functional.mse_loss(found.tags[sewn], truth.tags[sewn]),
        "free": functional.binary_cross_entropy_with_logits(
            found.free[truth.there], 1 - sewn[truth.there].float()
        ),
    }
    weights = {"shapes": 10.0, "loops": 0.1, "free": 0.5}
    whole = torch.stack([weights.get(name, 1.0) * part for name, part in parts.items()]).sum()
    return {**parts, "loss": whole}


def asked_losses(
    predict: Callable[[Tensor, Tensor], SlotOutputs], batch: PicturedSlots
) -> dict[str, Tensor]:
    """Losses of what a network says of pictures and the slots it is asked for, see `asked`."""
    weights = asked(batch.patterns.there[..., 0])
    found = predict(batch.seen(), weights > 0)
    return slot_losses(found.weighted(weights), batch.patterns)


def pattern_from(found: SlotOutputs, number: int, words: SlotWords) -> Pattern:
    """What a network says of one garment; the last edge of a panel closes its loop.

    As in the codes, rows near to padding are none, and a panel has three edges or is none.

    Raises:
        DecodeError: no panel is there.
    """
    rows = found.edges[number].float().numpy()
    there = np.any(np.abs(rows) > PADDING_ATOL, axis=2)
    counts = np.where(there.all(1), there.shape[1], there.argmin(1))
    counts = np.where(counts >= MIN_EDGES, counts, 0)
    if not counts.any():
        raise DecodeError("the slots hold no panel")
    turns = found.rotations[number].float().numpy()
    places = found.translations[number].float().numpy() * PLACE_CM + CENTRE
    panels = [
        _panel(words.names[k], rows[k, : counts[k]] * UNITS, turns[k], places[k])
        for k in np.flatnonzero(counts)
    ]
    tags, free = found.tags[number].float().numpy(), found.free[number].float().sigmoid().numpy()
    kept = np.arange(words.edges) < counts[:, None]
    pairs = sorted(sorted(pair) for pair in tag_stitches(tags, free, kept))
    stitches = tuple(
        Stitch(Side(words.names[j], m), Side(words.names[k], n)) for (j, m), (k, n) in pairs
    )
    return Pattern(tuple(panels), stitches)


def _row(loop: Loop, edge: Edge) -> Float[np.ndarray, "6"]:
    (x0, y0), (x1, y1) = loop.vertices[edge.start], loop.vertices[edge.end]
    match edge.curvature:
        case None:
            controls = THIRDS
        case Quadratic((along, left)):
            controls = np.array([along, left, 0.5 + along, left]) * 2 / 3
        case Cubic(one, two):
            controls = np.array([*one, *two])
        case _:
            raise LearnError("slots hold straight edges and Bézier curves only")
    return np.array([x1 - x0, y1 - y0, *(controls - THIRDS)])


def _panel(
    name: str, rows: Float[np.ndarray, "edge 6"], turn: np.ndarray, place: np.ndarray
) -> Panel:
    from scipy.spatial.transform import Rotation

    ends = np.cumsum(rows[:, :2], axis=0)
    vertices = np.concatenate([np.zeros((1, 2)), ends[:-1]])
    edges = []
    for n, bends in enumerate(rows[:, 2:].astype(float)):
        along, left, along2, left2 = (bends + THIRDS).tolist()
        straight = np.abs(bends).max() < STRAIGHTEST
        curve = None if straight else Cubic((along, left), (along2, left2))
        edges.append(Edge(n, (n + 1) % len(rows), curve))
    angles = np.zeros(3)
    if float(np.linalg.norm(turn)) > 1e-6:
        with warnings.catch_warnings():  # turned by 90 degrees, two of the angles are one
            warnings.simplefilter("ignore", UserWarning)
            angles = Rotation.from_quat(turn).as_euler("xyz", degrees=True)
    outline = Loop(tuple((float(x), float(y)) for x, y in vertices), tuple(edges))
    panel = Panel(name, outline, rotation=_vector(angles))
    return replace(panel, translation=_vector(place - universal_translation(panel)))


def _vector(values: np.ndarray) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z


def _middle(pattern: Pattern, side: Side) -> np.ndarray:
    panel = pattern.by_name[side.panel]
    return panel.to_world(panel.curves[side.edge].at(np.array([0.5])))[0]
