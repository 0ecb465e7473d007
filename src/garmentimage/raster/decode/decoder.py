"""From a GarmentImage back to the sewing pattern (paper, Section 3.3).

Geometry and stitches come from the channels alone. Marks, where the image has them, only give
panels their names, frames and places back, and join the parts of split panels again. The steps:

    repair         what is inconsistent                                 raster.repair
    label_panels   connected cells are a panel                          raster.cells
    unfold_simply  the cells deformed to their edge vectors (Eq. 2)     unfold, outlines, boundary
    panel_frames   each panel turned into its own frame                 assemble
    fit_edges      parts joined, boundaries cut into edges and curves   fit_edges, edges, curve_fit
    divided        vertices of traced outlines put back                 divisions
    assemble       names, places, stitches, turned panels folded over   assemble, naming
"""

import numpy as np

from garmentimage.errors import DecodeError
from garmentimage.pattern import Pattern
from garmentimage.raster.cells import cell_mesh, label_panels
from garmentimage.raster.channel_kind import ChannelKind
from garmentimage.raster.decode.assemble import assemble, marks_of_clusters, panel_frames
from garmentimage.raster.decode.boundary import Cluster
from garmentimage.raster.decode.fit_edges import fit_edges
from garmentimage.raster.decode.outlines import unfold_simply
from garmentimage.raster.decode.unfold import unfold_panel
from garmentimage.raster.image import GarmentImage
from garmentimage.raster.repair import RepairLevel, remove_dangling_cuts, repair as repair_image

MAX_PANELS = 1000
"""An image in more parts than this is noise; garments have up to 50 panels."""
NOISE_PANELS, NOISE_CELLS = 40, 3.0
"""So is one in more parts than the first whose parts have fewer cells in the mean: panels of
garments have 5 or more at N = 16 (212 garments of all sources)."""


def decode(
    image: GarmentImage | np.ndarray,
    *,
    repair: RepairLevel = "full",
    kind: ChannelKind | None = None,
) -> Pattern:
    """The sewing pattern that an image shows.

    Deterministic, for any garment. A panel's boundary is refitted to lines and smooth curves; one
    edge of it has one partner. Where curves would cross, the polyline stays; a panel whose very
    polyline crosses itself has overlapping slits sewn up, then is pulled towards the undeformed
    grid; with full repair, cuts that end inside a panel are left out at last.

    Args:
        image: a GarmentImage, or channels [17 L or 26 L, N, N] as a network gives them.
        repair: how much of an inconsistent image is repaired first, see `repair`.
        kind: what the numbers of channels are, see `repair`; default: judged by all of them.

    Raises:
        ImageError: a wrong shape, values that are not finite, or no such level or kind.
        DecodeError: the image is empty or mere noise, or a panel crosses itself whatever is tried.
    """
    image, _ = repair_image(image, level=repair, kind=kind)
    if not image.inside.any():
        raise DecodeError("the image is empty: no cell is inside a panel")
    try:
        return _decoded(image)
    except DecodeError as error:
        failure = error
    repaired, count = remove_dangling_cuts(image) if repair == "full" else (image, 0)
    if not count:
        raise failure
    return _decoded(repaired)


def _decoded(image: GarmentImage) -> Pattern:
    """The pattern of an image as it stands."""
    labels, panel_count = label_panels(image.inside, image.edge_type)
    cells = image.inside.sum() / max(panel_count, 1)
    if panel_count > MAX_PANELS or (panel_count > NOISE_PANELS and cells < NOISE_CELLS):
        raise DecodeError(
            f"the image is in {panel_count} parts of {cells:.1f} cells each, as noise is and no "
            "garment; check the order of its channels and what its numbers are (kind)"
        )
    marks = marks_of_clusters(image, labels, panel_count)
    layer_of = np.empty(panel_count, np.int64)
    layer_of[labels[labels >= 0]] = np.nonzero(labels >= 0)[0]
    clusters = []
    for k, (layer, mark) in enumerate(zip(layer_of.tolist(), marks, strict=True)):
        mask = labels[layer] == k
        mesh = cell_mesh(mask, image.edge_type[layer])
        turned_cells = int(image.turned[layer][mask].sum())
        vertices = unfold_panel(image, layer, mesh)
        clusters.append(Cluster(layer, mesh, vertices, mark, turned_cells))
    clusters, boundary = unfold_simply(image, clusters)
    frames = panel_frames(boundary, clusters)
    fitted = fit_edges(frames.boundary, clusters).divided(image, clusters)
    return assemble(image, clusters, frames, fitted)
