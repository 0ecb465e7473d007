"""Output of the baselines: garments in slots, and their patterns."""

import warnings
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from torch import Tensor

from garmentimage.errors import DecodeError
from garmentimage.learn.data.slot_vectors import CENTRE, PLACE_CM, THIRDS, UNITS, SlotVocabulary
from garmentimage.metrics import (
    MIN_EDGES,
    PADDING_ATOL,
    tag_stitches,
    universal_translation,
)
from garmentimage.pattern import Cubic, Edge, Loop, Panel, Pattern, Side, Stitch, Vector

STRAIGHT_TOLERANCE = 0.02
"""Edges whose control points all lie nearer to those of a straight edge are straight [lengths]."""
MIN_TURN = 1e-6
"""Shorter quaternions stand for no rotation."""


@dataclass
class SlotOutputs:
    """What a network predicts of some garments; units as in `SlotVectors`."""

    edges: Float[Tensor, "n slot edge 6"]
    rotations: Float[Tensor, "n slot 4"]
    translations: Float[Tensor, "n slot 3"]
    tags: Float[Tensor, "n slot edge 3"]
    free: Float[Tensor, "n slot edge"]
    """Logits of whether edges have no stitch."""

    def weighted(self, weights: Float[Tensor, "n slot"]) -> "SlotOutputs":
        """The same, the edges of each slot multiplied by its weight."""
        return replace(self, edges=self.edges * weights[..., None, None])


def pattern_from(found: SlotOutputs, number: int, vocabulary: SlotVocabulary) -> Pattern:
    """The pattern of one predicted garment; the last edge of a panel closes its loop.

    As in the published codes, rows near 0 are padding, and a panel has three edges or more.

    Args:
        found: output of a network.
        number: of the garment in the batch.
        vocabulary: the slots.

    Raises:
        DecodeError: all slots are empty.
    """
    rows = found.edges[number].float().numpy()
    is_edge = np.any(np.abs(rows) > PADDING_ATOL, axis=2)
    counts = np.where(is_edge.all(1), is_edge.shape[1], is_edge.argmin(1))
    counts = np.where(counts >= MIN_EDGES, counts, 0)
    if not counts.any():
        raise DecodeError("the slots hold no panel")
    rotations = found.rotations[number].float().numpy()
    places = found.translations[number].float().numpy() * PLACE_CM + CENTRE
    panels = [
        _panel(vocabulary.names[k], rows[k, : counts[k]] * UNITS, rotations[k], places[k])
        for k in np.flatnonzero(counts)
    ]
    tags, free = found.tags[number].float().numpy(), found.free[number].float().sigmoid().numpy()
    kept = np.arange(vocabulary.edges) < counts[:, None]
    pairs = sorted(sorted(pair) for pair in tag_stitches(tags, free, kept))
    names = vocabulary.names
    stitches = tuple(Stitch(Side(names[j], m), Side(names[k], n)) for (j, m), (k, n) in pairs)
    return Pattern(tuple(panels), stitches)


def _panel(
    name: str, rows: Float[np.ndarray, "edge 6"], rotation: np.ndarray, place: np.ndarray
) -> Panel:
    from scipy.spatial.transform import Rotation

    ends = np.cumsum(rows[:, :2], axis=0)
    vertices = np.concatenate([np.zeros((1, 2)), ends[:-1]])
    edges = []
    for n, bends in enumerate(rows[:, 2:].astype(float)):
        along, left, along2, left2 = (bends + THIRDS).tolist()
        straight = np.abs(bends).max() < STRAIGHT_TOLERANCE
        curve = None if straight else Cubic((along, left), (along2, left2))
        edges.append(Edge(n, (n + 1) % len(rows), curve))
    angles = np.zeros(3)
    if float(np.linalg.norm(rotation)) > MIN_TURN:
        with warnings.catch_warnings():  # gimbal lock: at 90 degrees two angles are one
            warnings.simplefilter("ignore", UserWarning)
            angles = Rotation.from_quat(rotation).as_euler("xyz", degrees=True)
    outline = Loop(tuple((float(x), float(y)) for x, y in vertices), tuple(edges))
    panel = Panel(name, outline, rotation=_vector(angles))
    return replace(panel, translation=_vector(place - universal_translation(panel)))


def _vector(values: np.ndarray) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z
