"""What lies on cloth: panels that are sewn onto others, and pleats that are pressed."""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

from garmentimage.geometry import connected_components
from garmentimage.pattern import Crease, Pattern, Pleat, SewnOnto, pleat_of
from garmentimage.raster.decode.boundary import NONE, Cluster, rigid
from garmentimage.raster.decode.fit_edges import FittedPanels
from garmentimage.raster.image import BOTTOM, LEFT, EdgeType, GarmentImage

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


def pressed_pleats(
    image: GarmentImage,
    clusters: Sequence[Cluster],
    fitted: FittedPanels,
    frames: Mapping[int, Frame],
    pattern: Pattern,
) -> tuple[Pleat, ...]:
    """The pleats whose creases an image shows.

    A crease is a chain of grid edges inside a panel. It starts on one of two edges that follow each
    other and are sewn to each other; where on that edge says of which kind the pleat is.

    Args:
        image: as decoded.
        clusters: all.
        fitted: their edges.
        frames: by cluster; panels that wrap round the body have none, and no pleats.
        pattern: without pleats, its panels in the order of `fitted.members`.
    """
    if not (image.edge_type == EdgeType.CREASE).any():
        return ()
    found = []
    for panel, (k, own) in zip(pattern.panels, sorted(fitted.members.items()), strict=True):
        chains = _crease_chains(image, clusters[k]) if k in frames else []
        if not chains:
            continue
        count = len(fitted.seams.loops[own[0]])
        sewn = {frozenset(stitch) for stitch in fitted.seams.stitches}
        for n in range(count):
            pair = n, (n + 1) % count
            if frozenset((own[0], edge) for edge in pair) not in sewn or count < 3:
                continue
            starts = _starts_on(clusters[k], fitted, own[0], pair)
            creases = []
            for first, last in chains:
                if first in starts:
                    matrix, shift = frames[k]
                    x, y = ((clusters[k].vertices[last] - shift) @ matrix).tolist()
                    creases.append(Crease(*starts[first], (x, y)))
            pleat = pleat_of(pattern, panel.name, pair, creases)
            if pleat is not None and pleat.pressed > 0:
                found.append(pleat)
    return tuple(found)


def _crease_chains(image: GarmentImage, cluster: Cluster) -> list[tuple[int, int]]:
    """First and last vertex of each chain of creases in a cluster, in both directions."""
    cells = np.full((image.grid + 1, image.grid + 1), NONE)
    rows, cols = cluster.mesh.cells.T
    cells[rows, cols] = np.arange(len(rows))
    steps: list[tuple[int, int]] = []
    for side, (corner, before) in {BOTTOM: (1, (-1, 0)), LEFT: (3, (0, -1))}.items():
        is_crease = image.edge_type[cluster.layer, side, rows, cols] == EdgeType.CREASE
        own = np.flatnonzero(is_crease & (cells[rows + before[0], cols + before[1]] != NONE))
        steps += map(tuple, cluster.mesh.corner_ids[own][:, [0, corner]].tolist())
    chains = []
    for chain in connected_components(cluster.mesh.vertex_count, steps):
        ends = [v for v in chain if sum(v in step for step in steps) == 1]
        if len(ends) == 2:
            chains += [(ends[0], ends[1]), (ends[1], ends[0])]
    return chains


def _starts_on(
    cluster: Cluster, fitted: FittedPanels, loop: int, pair: tuple[int, int]
) -> dict[int, tuple[int, float]]:
    """For vertices inside two edges which of the two, and how far from its outer end, as a share.

    The first edge starts at its outer end, the second ends there.
    """
    where = {tuple(cell): number for number, cell in enumerate(cluster.mesh.cells.tolist())}
    found = {}
    for number, edge in enumerate(pair):
        halves = fitted.seams.loops[loop][edge].halves
        tail, head = fitted.boundary.tail[halves], fitted.boundary.head[halves]
        reached = np.cumsum(np.hypot(*(head - tail).T))
        for half, length in zip(halves[1:], reached[:-1].tolist(), strict=True):
            _, row, col, side = fitted.boundary.place[half].tolist()
            # Seen through the body, the half-edge runs the other way round its cell.
            corner = side if cluster.outward > 0 else (side + 1) % 4
            share = length / float(reached[-1])
            vertex = int(cluster.mesh.corner_ids[where[row, col], corner])
            found[vertex] = number, share if number == 0 else 1 - share
    return found
