"""Lapels, collars and overlapping fronts that lie inside of the garment, or wrong side out."""

import numpy as np
from jaxtyping import Float

from garmentimage.body import Body
from garmentimage.drape.cloth import Cloth
from garmentimage.drape.folded import FoldedPanels, on_panels, overlapping_panels
from garmentimage.drape.solver import body_field, cloth_field

DEPTH = 0.2  # cloth lies inside that is so far beneath what it is folded onto [cm]
MAX_INSIDE = 0.05  # share of a panel that may lie inside
MIN_RIGHT_SIDE_OUT = 0.5  # share of a panel that must show its right side
NEAR = 2.0  # cloth lies on cloth that is nearer than this [cm]
LEAST_NEAR = 0.02  # share of a panel that is taken to lie on others, at least


def fold_faults(
    cloth: Cloth, points: Float[np.ndarray, "vertex 3"], folded: FoldedPanels, body: Body
) -> list[str]:
    """Turned panels that lie inside or wrong side out, a sentence each; shares are of their area.

    A panel lies inside where it is beneath any that turned panels are folded onto. The side that
    shows is the one away from the body.
    """
    if not folded.turned:
        return []
    corners = points[cloth.vertex_faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area, middle = np.linalg.norm(across, axis=1), corners.mean(axis=1)
    base = on_panels(cloth, folded.bases)
    depth = -cloth_field(points, cloth.vertex_faces[base]).at(middle)
    _, outward = body_field(body).at_with_slope(middle)
    faults = []
    for k, panel in enumerate(cloth.pattern.panels):
        own = cloth.face_panel == k
        if panel.name not in folded.turned:
            continue
        inside, right_side_out = (
            float(area[own & which].sum() / area[own].sum())
            for which in (depth > DEPTH, (across * outward).sum(axis=1) > 0)
        )
        if inside > MAX_INSIDE:
            faults.append(
                f"{inside:.0%} of panel {panel.name[:40]!r} lies under the cloth that it should "
                f"be folded onto (at most {MAX_INSIDE:.0%})"
            )
        elif right_side_out < MIN_RIGHT_SIDE_OUT:
            faults.append(f"panel {panel.name[:40]!r} is not folded over: its wrong side is out")
    return faults


def overlap_faults(
    cloth: Cloth, points: Float[np.ndarray, "vertex 3"], folded: FoldedPanels
) -> list[str]:
    """Overlapping panels that lie beneath cloth of a lower layer, a sentence each.

    Shares are of the area that comes near the cloth beneath: fronts may have fallen open.
    """
    faults = []
    for name, lower in overlapping_panels(cloth.pattern, folded).items():
        own, beneath = on_panels(cloth, {name}), on_panels(cloth, lower)
        corners = points[cloth.vertex_faces[own]]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(across, axis=1)
        height = cloth_field(points, cloth.vertex_faces[beneath]).at(corners.mean(axis=1))
        near = max(area[np.abs(height) < NEAR].sum(), LEAST_NEAR * area.sum())
        inside = float(area[height < -DEPTH].sum() / near)
        if inside > MAX_INSIDE:
            layer = cloth.pattern.by_name[name].cloth_layer
            faults.append(
                f"where panel {name[:40]!r} of cloth layer {layer} overlaps others, {inside:.0%} "
                f"of it lies beneath them (at most {MAX_INSIDE:.0%})"
            )
    return faults
