"""Panels that are more than one cluster of cells: joined where they wrap round the body.

Marks say where such a panel belongs. Without them its frame lies midway between those of its parts,
and it stands edge-on, at the side of the body or over it, as encoding lays such panels flat (see
`raster.encode.placement`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from garmentimage.raster.decode.boundary import NONE, Boundary, Cluster, rigid


@dataclass(frozen=True)
class WrappedPlace:
    """Where a panel that was joined from parts stands."""

    turn: Float[np.ndarray, "2 2"]
    """Takes the frame in which it was joined to the one that lies midway."""
    rotation: Float[np.ndarray, "3 3"]
    """Of the panel, in the frame that lies midway."""
    middle: Float[np.ndarray, " 2"]
    """Mean place of its parts in the raster's frame [cm]."""
    cut: Float[np.ndarray, " 2"]
    """The middle of the line between front and back, in the frame that lies midway [cm]."""


def wrapped_place(
    clusters: Sequence[Cluster],
    before: Boundary,
    after: Boundary,
    members: Sequence[int],
    matrix: Float[np.ndarray, "2 2"],
) -> WrappedPlace:
    """The place of a panel that was joined along wraps.

    Args:
        clusters: all.
        before: half-edges in the frames of the clusters.
        after: the same half-edges once joined.
        members: its clusters; the first, in whose frame they were joined, lies in front.
        matrix: raster frame = matrix @ frame of the first.
    """
    weights = np.array([float(len(clusters[k].mesh.cells)) for k in members])
    weights /= weights.sum()
    angle = -sum(w * _turned_by(before, after, k) for w, k in zip(weights, members, strict=True))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    first = before.cluster == members[0]
    gone = first & before.wraps & (after.following == NONE)
    cut = np.concatenate([before.tail[gone], before.head[gone]])
    outward = np.sign(matrix @ (cut.mean(axis=0) - before.tail[first].mean(axis=0)))
    width, height = np.ptp(cut @ matrix.T, axis=0)
    (x, y), none = np.eye(2), np.zeros(2)
    # What the front part has farther inward from the cut stands farther forward.
    upright = [none, y, -outward[0] * x] if height >= width else [x, none, -outward[1] * y]
    axes = np.stack(upright)
    return WrappedPlace(
        turn=turn,
        rotation=np.column_stack([axes, np.cross(axes[:, 0], axes[:, 1])]),
        middle=weights @ np.array([clusters[k].vertices.mean(axis=0) for k in members]),
        cut=turn @ cut.mean(axis=0),
    )


def _turned_by(before: Boundary, after: Boundary, cluster: int) -> float:
    """Angle by which a cluster was turned when it was joined [rad]."""
    own = (before.cluster == cluster) & (after.following != NONE)
    rotation, _ = rigid(before.tail[own], after.tail[own])
    return float(np.arctan2(rotation[1, 0], rotation[0, 0]))
