"""Patterns in slots as tensors: the data of the vector-based baselines (paper, Section 4.3).

Every panel has a slot, by name. As in NeuralTailor (Korosteleva and Lee 2022) and Sewformer (Liu et
al. 2023), a panel is its edges, a rotation (a quaternion) and a translation; every edge is free or
has a stitch tag, a point in space that the two edges of a stitch share. An edge's row is (dx, dy)
to its end, and the offsets of its two control points from one and two thirds of the chord, along it
and to its left, relative to its length; padding is all 0. The published codes have one control
point; on the sleeve caps drafted here that would cost up to 6 % of IoU.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from jaxtyping import Bool, Float, UInt8
from torch import Tensor

from garmentimage.errors import LearnError, quoted
from garmentimage.learn.data.rows import ImageRows, TensorRows
from garmentimage.learn.weights import NetworkConfig
from garmentimage.metrics import quaternion, universal_translation
from garmentimage.pattern import Cubic, Edge, Loop, Pattern, Quadratic

CHORD_CM, BEND = 25.0, 0.25
"""Units of the chords of edges [cm], and of the offsets of their control points [chord lengths]."""
UNITS = np.array([CHORD_CM] * 2 + [BEND] * 4)
"""Of an edge's row."""
THIRDS = np.array([1 / 3, 0, 2 / 3, 0])
"""Control points of a straight edge: along the chord and to its left, twice."""
PLACE_CM, CENTRE = 50.0, np.array([0.0, 100.0, 0.0])
"""Unit and origin of translations and stitch tags [cm]."""
ROW, TAGS = 6, 3
"""Numbers of an edge's row and of its stitch tag."""
EDGE_SIZE = ROW + TAGS + 1
"""Numbers of an edge: its row, its tag, and whether it is free."""
PLACEMENT_SIZE = 4 + 3
"""Numbers of a placement: rotation and translation of a panel."""


@dataclass(frozen=True)
class SlotVocabulary:
    """The slots of a dataset."""

    names: tuple[str, ...]
    """Panel names, one a slot."""
    edges: int
    """Most edges of a panel."""


def slot_vocabulary(patterns: Sequence[Pattern]) -> SlotVocabulary:
    """Slots for every panel of some garments."""
    panels = [panel for pattern in patterns for panel in pattern.panels]
    names = tuple(dict.fromkeys(sorted(panel.name for panel in panels)))
    return SlotVocabulary(names, max(len(panel.outline.edges) for panel in panels))


@dataclass(frozen=True)
class SlotConfig(NetworkConfig):
    """Slots and size of a baseline."""

    network: str
    """Its name in `SLOT_NETWORKS`."""
    names: Sequence[str]
    """Panel names, one a slot."""
    edges: int
    """Most edges of a panel."""
    width: int
    """Of the network's layers."""
    layers: int
    """Of the encoder and of each decoder."""
    picture: int = 128
    """Pixels a side."""
    resnet: dict[str, Any] | None = None
    """Configuration of the ResNet that encodes images; None for the small encoder."""

    @property
    def vocabulary(self) -> SlotVocabulary:
        """Its slots."""
        return SlotVocabulary(tuple(self.names), self.edges)


@dataclass
class SlotVectors(TensorRows):
    """Some garments in slots."""

    edges: Float[Tensor, "n slot edge 6"]
    """Rows of edges [`UNITS`]."""
    is_present: Bool[Tensor, "n slot edge"]
    """Edges that are not padding."""
    rotations: Float[Tensor, "n slot 4"]
    """Quaternions of panels."""
    translations: Float[Tensor, "n slot 3"]
    """Of panels, from `CENTRE` [`PLACE_CM`]."""
    tags: Float[Tensor, "n slot edge 3"]
    """Stitch tags, from `CENTRE` [`PLACE_CM`]; 0 on free edges."""
    sewn: Bool[Tensor, "n slot edge"]
    """Edges that have a stitch."""


def to_slots(patterns: Sequence[Pattern], vocabulary: SlotVocabulary) -> SlotVectors:
    """Garments as tensors; holes of panels are left out.

    Raises:
        LearnError: a panel has no slot, or too many edges.
    """
    shape = (len(patterns), len(vocabulary.names), vocabulary.edges)
    edges, counts = np.zeros((*shape, ROW)), np.zeros(shape[:2], int)
    rotations, translations = np.zeros((*shape[:2], 4)), np.zeros((*shape[:2], 3))
    tags, sewn = np.zeros((*shape, TAGS)), np.zeros(shape, bool)
    for n, pattern in enumerate(patterns):
        for panel in pattern.panels:
            count = len(panel.outline.edges)
            if panel.name not in vocabulary.names or count > vocabulary.edges:
                raise LearnError(f"panel {quoted(panel.name)} fits in none of the slots")
            at = n, vocabulary.names.index(panel.name)
            counts[at] = count
            edges[at][:count] = [_row(panel.outline, edge) for edge in panel.outline.edges]
            rotations[at] = quaternion(panel)
            translations[at] = universal_translation(panel) - CENTRE
        for slot_edges, tag in _stitch_tags(pattern, vocabulary):
            for slot, edge in slot_edges:
                tags[n, slot, edge], sewn[n, slot, edge] = tag, True
    numbers = (edges / UNITS, rotations, translations / PLACE_CM, tags / PLACE_CM)
    rows, turns, moves, points = (torch.from_numpy(each.astype(np.float32)) for each in numbers)
    is_present = torch.from_numpy(np.arange(vocabulary.edges) < counts[..., None])
    return SlotVectors(rows, is_present, turns, moves, points, torch.from_numpy(sewn))


@dataclass
class ImagedSlots(ImageRows):
    """Images, and their garments in slots."""

    pictures: UInt8[Tensor, "n 3 pixel_row pixel_col"]
    """RGB from 0 to 255, the lowest row of pixels first."""
    patterns: SlotVectors


def _stitch_tags(
    pattern: Pattern, vocabulary: SlotVocabulary
) -> list[tuple[list[tuple[int, int]], Float[np.ndarray, "3"]]]:
    """Slot and edge of both sides of every stitch, and the tag they share, from `CENTRE` [cm]."""
    tags = []
    for stitch in pattern.stitches:
        panels = [pattern.by_name[side.panel] for side in stitch.sides]
        sides = list(zip(panels, (side.edge for side in stitch.sides), strict=True))
        if any(edge >= len(panel.outline.edges) for panel, edge in sides):
            continue  # a stitch of a hole, which has no slot
        middles = [
            panel.to_world(panel.curves[edge].at(np.array([0.5])))[0] for panel, edge in sides
        ]
        edges = [(vocabulary.names.index(panel.name), edge) for panel, edge in sides]
        tags.append((edges, np.mean(middles, axis=0) - CENTRE))
    return tags


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
