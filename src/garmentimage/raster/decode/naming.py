"""Names that a tailor would give to panels, from their place on the body and their seams.

Left is the wearer's left, which is +x: the right-hand side of a picture of the front.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Int

from garmentimage.raster.cells import half_edges
from garmentimage.raster.decode.boundary import Cluster
from garmentimage.raster.image import LEFT, EdgeType, GarmentImage

CROTCH_CM, SHOULDER_CM = 78.0, 138.0  # heights above the floor that distinguish kinds of panels

ARM_CM = (22.0, 105.0)
"""A panel whose middle lies farther out and higher than this hangs on an arm: panels of the trunk
have theirs within 20 cm of the axis, wide skirts theirs lower."""

FOREARM_CM = 30.0  # a narrow panel on an arm that begins beyond this distance is a cuff

HEAD_CM = 133.0  # a panel whose middle lies higher is a hood or a collar

TRUNK_CM = 95.0
"""A panel whose middle lies higher, or which reaches nearly to the shoulders, covers the trunk."""

REACH_TOL_CM = 8.0  # as much lower than the shoulder a panel may end and still reach it

BAND_CM = 14.0  # a waistband, a collar or a cuff is at most this wide

MAX_BODICE_CM = 80.0  # longer panels from the shoulder down are those of a dress, or of a jumpsuit

CENTRE_TOL_CM = 1.0
"""A panel that reaches farther than this beyond the body's axis on both sides is central."""

_LEFT_SIDE, _RIGHT_SIDE = 3, 1  # sides of a cell, as `half_edges` numbers them


def panel_names(
    image: GarmentImage, clusters: Sequence[Cluster], whole: Int[np.ndarray, " cluster"]
) -> Mapping[int, str]:
    """A name for each panel, unique: its mark's, else one from its place.

    `whole` is for each cluster the one that it was joined to; only those get names.
    """
    names: dict[int, str] = {}
    taken: set[str] = set()
    roots = [k for k in range(len(clusters)) if whole[k] == k]
    # Marked panels keep their names; the others count from the body's axis outwards.
    distance = {
        k: round(abs(_body_box(image, clusters[k]).mean(axis=0)[0]), 3)
        for k in roots
        if clusters[k].mark is None
    }
    for k in sorted(roots, key=lambda k: (k in distance, distance.get(k, 0.0), k)):
        mark = clusters[k].mark
        if mark is None:
            name = _name(image, clusters[k])
        else:
            name = mark.split_of if mark.split_of and (whole == k).sum() > 1 else mark.name
        unique, number = name, 2
        while unique in taken:
            unique, number = f"{name}_{number}", number + 1
        taken.add(unique)
        names[k] = unique
    return names


def _body_box(image: GarmentImage, cluster: Cluster) -> np.ndarray:
    """Lowest and highest x and y of the cluster's place on the body [cm]."""
    lattice = cluster.mesh.lattice
    return image.frame.to_body(np.stack([lattice.min(axis=0), lattice.max(axis=0)]))


def _name(image: GarmentImage, cluster: Cluster) -> str:
    left, right = _body_box(image, cluster)[:, 0]
    face = "front" if cluster.outward > 0 else "back"
    central = bool(left < -CENTRE_TOL_CM and right > CENTRE_TOL_CM)
    kind = _kind_sewn_on(image, cluster) or _kind(image, cluster, central=central)
    if central:
        return f"{kind}_{face}"
    return f"{'left' if left + right > 0 else 'right'}_{kind}_{face}"


def _kind_sewn_on(image: GarmentImage, cluster: Cluster) -> str:
    """What is sewn onto cloth: a pocket, or a peplum where it is also sewn to others."""
    types = set(half_edges(cluster.mesh, image.edge_type[cluster.layer]).edge_type.tolist())
    if EdgeType.ONTO not in types:
        return ""
    return "pocket" if types <= {EdgeType.ONTO, EdgeType.NON_STITCH} else "peplum"


def _kind(image: GarmentImage, cluster: Cluster, *, central: bool) -> str:
    (left, _), (right, top) = _body_box(image, cluster)
    width, height = np.ptp(cluster.vertices, axis=0)
    # Cells (row, column), so x is the second; a cell's middle lies half a cell up and right.
    middle_x, middle_y = image.frame.to_body(cluster.mesh.cells[:, ::-1] + 0.5).mean(axis=0)
    if not central and abs(middle_x) > ARM_CM[0] and middle_y > ARM_CM[1]:
        return "cuff" if min(abs(left), abs(right)) > FOREARM_CM and width < BAND_CM else "sleeve"
    if middle_y > HEAD_CM:
        return "collar" if height < BAND_CM else "hood"
    if height < BAND_CM and width > 2 * height and top > CROTCH_CM:
        return "waistband"
    legs = _has_legs(image, cluster) if central else _is_leg(image, cluster)
    if middle_y > TRUNK_CM or top > SHOULDER_CM - REACH_TOL_CM:
        if height < MAX_BODICE_CM:
            return "bodice"
        return "jumpsuit" if legs else "dress"
    if legs:
        return "trousers" if central else "leg"
    return "skirt"


def _has_legs(image: GarmentImage, cluster: Cluster) -> bool:
    """Whether an inseam, sewn to the other layer, divides every row of cells below the crotch."""
    rows, cols = cluster.mesh.cells.T
    low = [r for r in np.unique(rows) if image.frame.rows[r + 1] <= CROTCH_CM]
    left = image.edge_type[cluster.layer, LEFT]
    # The outermost left edge of a row is that of a side seam.
    return bool(low) and all(
        (left[r, cols[rows == r][1:]] == EdgeType.FRONT_TO_BACK).any() for r in low
    )


def _is_leg(image: GarmentImage, cluster: Cluster) -> bool:
    """Whether the inner side is sewn to the other layer at the hem, as an inseam is."""
    half = half_edges(cluster.mesh, image.edge_type[cluster.layer])
    inner = _LEFT_SIDE if _body_box(image, cluster).sum(axis=0)[0] > 0 else _RIGHT_SIDE
    rows = cluster.mesh.cells[half.cell, 0]
    lowest = (half.side == inner) & (rows == rows.min())
    return bool((half.edge_type[lowest] == EdgeType.FRONT_TO_BACK).any())
