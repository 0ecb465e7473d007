"""Pockets: panels of the outer sheet whose edges are sewn onto the cloth beneath them."""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

from garmentimage.pattern import SewnOnto
from garmentimage.raster.decode.boundary import NONE, Cluster, rigid
from garmentimage.raster.decode.fit_edges import FittedPanels
from garmentimage.raster.image import GarmentImage

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
