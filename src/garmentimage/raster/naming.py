"""Names that a tailor would give to panels, from their place on the body and their seams.

Left is the wearer's left, which is +x: the right-hand side of a picture of the front.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Int

from garmentimage.raster.cells import half_edges
from garmentimage.raster.image import EdgeType, GarmentImage, PanelMark
from garmentimage.raster.outlines import Cluster

CROTCH_CM, WAIST_CM, ARMPIT_CM, SHOULDER_CM = 78.0, 100.0, 128.0, 140.0
"""Heights above the floor that tell kinds of panels apart."""

SHOULDER_WIDTH_CM, ELBOW_CM = 19.0, 45.0
"""A panel wholly beyond the first distance from the body's axis is a sleeve."""

BAND_CM = 14.0
"""A waistband, a collar or a cuff is no wider than this."""

CENTRE_TOL_CM = 1.0
"""A panel that reaches farther than this beyond the body's axis on both sides is central."""

SEWN_SHARE = 0.75
"""A skirt panel is sewn to its neighbour along more of its inner side than this; a leg is not."""


def panel_names(
    image: GarmentImage,
    clusters: Sequence[Cluster],
    marks: Sequence[PanelMark | None],
    whole: Int[np.ndarray, " cluster"],
) -> Mapping[int, str]:
    """A name for each panel, unique: its mark's, else one from its place.

    Args:
        image: gives the body frame.
        clusters: all clusters of the image.
        marks: the mark of each cluster.
        whole: for each cluster the one that it was joined to; only those get names.
    """
    names: dict[int, str] = {}
    taken: set[str] = set()
    roots = [k for k in range(len(clusters)) if whole[k] == k]
    # Marked panels keep their names; the others count from the body's axis outwards.
    distance = {k: abs(_body_box(image, clusters[k]).mean(axis=0)[0]) for k in roots}
    for k in sorted(roots, key=lambda k: (marks[k] is None, round(distance[k], 3), k)):
        mark = marks[k]
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
    kind = _kind(image, cluster, central=central)
    if not central:
        return f"{'left' if left + right > 0 else 'right'}_{kind}_{face}"
    return f"{face}_{kind}" if kind in ("bodice", "dress", "skirt") else f"{kind}_{face}"


def _kind(image: GarmentImage, cluster: Cluster, *, central: bool) -> str:
    (left, bottom), (right, top) = _body_box(image, cluster)
    width, height = np.ptp(cluster.vertices, axis=0)
    near = min(abs(left), abs(right))
    if not central and near > SHOULDER_WIDTH_CM and (bottom + top) / 2 > WAIST_CM:
        return "cuff" if near > ELBOW_CM and width < BAND_CM else "sleeve"
    if bottom > SHOULDER_CM - CENTRE_TOL_CM:
        return "collar" if height < BAND_CM else "hood"
    if height < BAND_CM and width > 2 * height and top > CROTCH_CM and bottom < ARMPIT_CM:
        return "waistband"
    if top > WAIST_CM + BAND_CM:
        return "bodice" if bottom > CROTCH_CM - BAND_CM else "dress"
    return "leg" if not central and _is_leg(image, cluster) else "skirt"


def _is_leg(image: GarmentImage, cluster: Cluster) -> bool:
    """Whether much of the inner side is sewn to the other layer, as an inseam is, or open."""
    half = half_edges(cluster.mesh, image.edge_type[cluster.layer])
    inner_side = 3 if _body_box(image, cluster).sum(axis=0)[0] > 0 else 1
    kinds = half.edge_type[half.side == inner_side]
    return bool((kinds == EdgeType.SIDE_BY_SIDE).mean() <= SEWN_SHARE)
