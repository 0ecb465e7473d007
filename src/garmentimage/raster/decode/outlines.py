"""Outlines that do not cross themselves: panels are unfolded with more effort until they are so."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol, TypeVar, runtime_checkable

import numpy as np
from jaxtyping import Float

from garmentimage.errors import DecodeError
from garmentimage.geometry import contains, signed_area, touching_sides
from garmentimage.pattern.checks import MAX_PANEL_SIZE, MIN_EDGE_LENGTH
from garmentimage.raster.decode.boundary import Boundary, Cluster, close_slits, trace_boundary
from garmentimage.raster.decode.unfold import unfold_panel
from garmentimage.raster.image import GarmentImage

MIN_PANEL_CM2 = 1e-3  # area of the smallest panel


class Effort(NamedTuple):
    """What is done so that the polyline round a panel does not cross itself."""

    sews_slits: bool  # overlapping slits are sewn up
    pull: float  # how far edge vectors are pulled towards those of the undeformed grid


EFFORTS = (Effort(False, 0.0), Effort(True, 0.0), Effort(True, 0.5), Effort(True, 1.0))
"""What is tried in turn for a panel whose very polyline crosses itself."""

Polygons = Sequence[Float[np.ndarray, "_ 2"]]


@runtime_checkable
class Outlined(Protocol):
    """Panels, and the polygons round each and round its holes."""

    @property
    def outlines(self) -> Mapping[int, Polygons]:
        """Polygons by the number of the panel."""


Panels = TypeVar("Panels", bound=Outlined)


def until_simple(
    build: Callable[[], Panels], relax: Callable[[Panels, list[int], int], None]
) -> Panels:
    """Build panels again and again until every one has a simple outline.

    Args:
        build: makes them as things stand.
        relax: changes how those with the given numbers are built; also gets the number of the
            round, from 1. It raises an error when there is nothing left to try.
    """
    turn = 0
    while True:
        turn += 1
        panels = build()
        faulty = [k for k, polygons in panels.outlines.items() if not is_outline(polygons)]
        if not faulty:
            return panels
        relax(panels, faulty, turn)


def is_outline(polygons: Polygons) -> bool:
    """Whether loops bound a panel: an outline and holes in it, none crossing, touching or tiny."""
    if not polygons or any(len(p) < 3 for p in polygons):
        return False
    areas = [signed_area(p) for p in polygons]
    first = int(np.argmax(np.abs(areas)))
    outline = polygons[first]
    steps = np.concatenate([np.diff(p, axis=0, append=p[:1]) for p in polygons])
    if (
        abs(areas[first]) < MIN_PANEL_CM2
        or np.ptp(outline, axis=0).max() > MAX_PANEL_SIZE
        or np.abs(steps).max(axis=1).min() < 2 * MIN_EDGE_LENGTH
        or len(touching_sides(polygons))
    ):
        return False
    holes = [k for k in range(len(polygons)) if k != first]
    return all(
        areas[k] * areas[first] < 0
        and contains(outline, polygons[k][0])
        and not any(j != k and contains(polygons[j], polygons[k][0]) for j in holes)
        for k in holes
    )


class UnfoldedPanels(NamedTuple):
    """Clusters after deforming, and their half-edges."""

    clusters: list[Cluster]
    boundary: Boundary

    @property
    def outlines(self) -> Mapping[int, Polygons]:
        """The polylines round each cluster."""
        found: dict[int, list[np.ndarray]] = {k: [] for k in range(len(self.clusters))}
        for loop in self.boundary.loops:
            found[int(self.boundary.cluster[loop[0]])].append(self.boundary.tail[loop])
        return found


def unfold_simply(image: GarmentImage, clusters: Sequence[Cluster]) -> UnfoldedPanels:
    """Unfold clusters again whose outlines cross themselves, until none does.

    Raises:
        DecodeError: an outline crosses itself whatever is tried.
    """
    clusters = list(clusters)
    effort = [0] * len(clusters)

    def build() -> UnfoldedPanels:
        boundary = trace_boundary(image, clusters)
        sewn_up = {k for k, e in enumerate(effort) if EFFORTS[e].sews_slits}
        return UnfoldedPanels(clusters, close_slits(boundary, clusters, sewn_up))

    def relax(_: UnfoldedPanels, faulty: list[int], __: int) -> None:
        for k in faulty:
            effort[k] += 1
            if effort[k] == len(EFFORTS):
                raise _crossing(image, clusters[k])
            layer, mesh = clusters[k].layer, clusters[k].mesh
            vertices = unfold_panel(image, layer, mesh, EFFORTS[effort[k]].pull)
            clusters[k] = replace(clusters[k], vertices=vertices)

    return until_simple(build, relax)


def _crossing(image: GarmentImage, cluster: Cluster) -> DecodeError:
    row, col = cluster.mesh.cells[0]
    return DecodeError(
        f"the panel at row {row}, column {col} of layer {image.layer_names[cluster.layer]!r} "
        "crosses itself: the deformation or the edge types there make no outline; where a network "
        "made them, take another of its outputs"
    )
