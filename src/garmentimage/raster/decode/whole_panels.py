"""Where panels lie that are not one cluster by itself: wrapped round the body, or sewn onto others.

Marks say where a panel belongs that wraps round the body. Without them its frame lies midway
between those of its parts, and it stands edge-on, at the side of the body or over it, as encoding
lays such panels flat (see `raster.encode.placement`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from garmentimage.pattern import SewnOnto
from garmentimage.raster.decode.boundary import NONE, Boundary, Cluster, rigid
from garmentimage.raster.decode.fit_edges import FittedPanels
from garmentimage.raster.image import GarmentImage


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


Frame = tuple[Float[np.ndarray, "2 2"], Float[np.ndarray, " 2"]]
"""Matrix and shift of a panel: raster frame = matrix @ panel frame + shift [cm]."""


def sewn_onto(
    image: GarmentImage,
    clusters: Sequence[Cluster],
    fitted: FittedPanels,
    frames: Mapping[int, Frame],
    names: Mapping[int, str],
) -> tuple[SewnOnto, ...]:
    """The panels that are sewn onto others, and where.

    Beneath each grid edge of type `ONTO` lies a line of the mesh of the panel beneath. The rigid
    motion that brings the pocket's own corners nearest to those is its place on that panel.

    Args:
        image: as decoded.
        clusters: all.
        fitted: their edges.
        frames: by cluster; panels that wrap round the body have none, and carry no pockets.
        names: by cluster.
    """
    if not fitted.boundary.is_onto.any():
        return ()
    shape = (image.layers, image.grid, image.grid)
    owner, number = np.full(shape, NONE), np.full(shape, NONE)
    for k, cluster in enumerate(clusters):
        rows, cols = cluster.mesh.cells.T
        owner[cluster.layer, rows, cols] = k
        number[cluster.layer, rows, cols] = np.arange(len(rows))
    found = []
    for k, own in sorted(fitted.members.items()):
        outline = fitted.seams.loops[own[0]]
        edges = [n for n, edge in enumerate(outline) if fitted.boundary.is_onto[edge.halves].all()]
        if not edges or k not in frames:
            continue
        halves = np.concatenate([outline[n].halves for n in edges])
        layer, row, col, side = fitted.boundary.place[halves].T
        beneath = owner[layer - 2, row, col]
        on_cloth = beneath[(layer >= 2) & (beneath != NONE)]
        if not len(on_cloth) or (base := int(np.bincount(on_cloth).argmax())) not in frames:
            continue
        lies = (layer >= 2) & (beneath == base)
        layer, row, col, side = (each[lies] for each in (layer, row, col, side))
        ends = np.stack([side, (side + 1) % 4], axis=1)
        places = []
        for cluster, level in ((clusters[k], layer), (clusters[base], layer - 2)):
            cells = number[level, row, col]
            corners = cluster.mesh.corner_ids[cells[:, None], ends]
            places.append(cluster.vertices[corners.ravel()])
        rotation, shift = rigid(*places)
        (own_matrix, own_shift), (base_matrix, base_shift) = frames[k], frames[base]
        matrix = base_matrix.T @ rotation @ own_matrix
        offset = base_matrix.T @ (rotation @ own_shift + shift - base_shift)
        (a, b), (c, d) = matrix.tolist()
        x, y = offset.tolist()
        found.append(SewnOnto(names[k], tuple(edges), names[base], ((a, b), (c, d)), (x, y)))
    return tuple(found)
