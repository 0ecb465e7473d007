"""Where panels lie in a picture: as worn, front and back, or packed in rows where they are many.

As worn, each panel is drawn about where it hangs on the body, the back seen through the body (as
in a GarmentImage), and panels that would lie on one another are pushed apart.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from garmentimage.geometry import centroid
from garmentimage.pattern import Panel, Pattern
from garmentimage.pattern.files import lay_out

MARGIN_CM = 7.0  # least space between two panels
GROUP_GAP_CM = 24.0  # space between the front and the back
PICTURE_RATIO = 1.15  # width over height that front and back should have together
WORN_LIMIT = 80
"""With more panels than this, they are packed in rows: pushing apart takes quadratic time."""
MAX_ROUNDS = 400
MIN_FACING = 0.3
"""Least share of the outward normal along z by which a panel counts as front or back."""


@dataclass(frozen=True)
class DrawnPanel:
    """A panel and the rigid motion, mirrored or not, that takes it into the picture."""

    panel: Panel
    matrix: Float[np.ndarray, "2 2"]
    offset: Float[np.ndarray, " 2"]
    back: bool

    def place(self, points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
        """Panel points in the picture [cm]."""
        placed: np.ndarray = points @ self.matrix.T + self.offset
        return placed

    @property
    def polygon(self) -> Float[np.ndarray, "n 2"]:
        """The outline in the picture [cm]."""
        return self.place(self.panel.outline.polygon)


def arrange(pattern: Pattern) -> tuple[DrawnPanel, ...]:
    """Panels in the order of the pattern, placed so that their boxes do not overlap."""
    sides = list(zip(pattern.panels, _backs(pattern), strict=True))
    if len(pattern.panels) > WORN_LIMIT:
        return tuple(_shelved([DrawnPanel(p, np.eye(2), np.zeros(2), back) for p, back in sides]))
    placed = [_hung(panel, back) for panel, back in sides]
    front = _pushed_apart([p for p in placed if not p.back])
    back = _pushed_apart([p for p in placed if p.back])
    if front and back:
        back = _joined(front, back)
    order = {p.panel.name: p for p in (*front, *back)}
    return tuple(order[panel.name] for panel in pattern.panels)


def bounds(placed: tuple[DrawnPanel, ...] | list[DrawnPanel]) -> Float[np.ndarray, "2 2"]:
    """Lower left and upper right corner of all panels [cm]."""
    points = np.concatenate([p.polygon for p in placed])
    return np.array([points.min(axis=0), points.max(axis=0)])


def _backs(pattern: Pattern) -> list[bool]:
    """For each panel: does it hang behind the body? By its outward normal, else by its depth."""
    depth = [float(_world_centre(p)[2]) for p in pattern.panels]
    middle = (min(depth) + max(depth)) / 2
    backs = []
    for panel, z in zip(pattern.panels, depth, strict=True):
        normal = panel.matrix[2, 2] * np.sign(panel.outline.area)
        backs.append(bool(normal < 0 if abs(normal) > MIN_FACING else z < middle))
    return backs


def _world_centre(panel: Panel) -> Float[np.ndarray, " 3"]:
    middle: np.ndarray = panel.to_world(centroid(panel.outline.polygon)[None])[0]
    return middle


def _hung(panel: Panel, back: bool) -> DrawnPanel:
    """The panel at its place on the body, turned flat about its centroid.

    The polar factor of the panel's axes as seen from the front is the nearest rigid motion; for
    panels seen edge-on its handedness is set by the layer: seen from outside they run
    counter-clockwise, so seen from the front those of the back run clockwise.
    """
    u, _, vt = np.linalg.svd(panel.matrix[:2, :2])
    handed = np.sign(panel.outline.area) * (-1.0 if back else 1.0)
    flip = handed * np.sign(np.linalg.det(u @ vt))
    matrix = u @ np.diag([1.0, flip]) @ vt
    centre = centroid(panel.outline.polygon)
    return DrawnPanel(panel, matrix, _world_centre(panel)[:2] - matrix @ centre, back)


def _pushed_apart(placed: list[DrawnPanel]) -> list[DrawnPanel]:
    """Boxes that overlap move away from each other, each pair along the easier axis."""
    if len(placed) < 2:
        return placed
    boxes = np.array([bounds([p]) for p in placed])
    half = (boxes[:, 1] - boxes[:, 0] + MARGIN_CM) / 2
    start = boxes.mean(axis=1)
    centre = start.copy()
    for _ in range(MAX_ROUNDS):
        gap = centre[:, None] - centre[None]
        need = half[:, None] + half[None] - np.abs(gap)
        hit = (need > 1e-6).all(axis=2)
        np.fill_diagonal(hit, False)
        if not hit.any():
            break
        share = need / (half[:, None] + half[None])
        along_x = share[..., 0] < share[..., 1]
        # Panels on one spot: the later one in the list counts as right of, or above, the other.
        order = np.sign(np.arange(len(placed))[:, None] - np.arange(len(placed))[None])
        sign = np.where(gap == 0, order[..., None], np.sign(gap))
        push = np.where(hit[..., None], sign * need * 0.25, 0.0)
        push[..., 0] *= along_x
        push[..., 1] *= ~along_x
        centre += push.sum(axis=1)
    else:
        return _shelved(placed)
    return [_moved(p, shift) for p, shift in zip(placed, centre - start, strict=True)]


def _shelved(placed: list[DrawnPanel]) -> list[DrawnPanel]:
    """Panels on shelves, the tallest first."""
    boxes = np.array([bounds([p]) for p in placed])
    spots, _, _ = lay_out([(float(w), float(h)) for w, h in boxes[:, 1] - boxes[:, 0]])
    wanted = np.array([(spot.x, spot.y) for spot in spots])
    return [_moved(p, shift) for p, shift in zip(placed, wanted - boxes[:, 0], strict=True)]


def _joined(front: list[DrawnPanel], back: list[DrawnPanel]) -> list[DrawnPanel]:
    """The back group, moved right of the front group or below it: what makes a squarer picture."""
    f, b = bounds(front), bounds(back)
    (fw, fh), (bw, bh) = f[1] - f[0], b[1] - b[0]
    beside = (fw + GROUP_GAP_CM + bw) / max(fh, bh)
    stacked = max(fw, bw) / (fh + GROUP_GAP_CM + bh)
    if abs(np.log(beside / PICTURE_RATIO)) <= abs(np.log(stacked / PICTURE_RATIO)):
        shift = np.array([f[1, 0] + GROUP_GAP_CM - b[0, 0], 0.0])
    else:
        shift = np.array([f[:, 0].mean() - b[:, 0].mean(), f[0, 1] - GROUP_GAP_CM - b[1, 1]])
    return [_moved(p, shift) for p in back]


def _moved(placed: DrawnPanel, shift: np.ndarray) -> DrawnPanel:
    return replace(placed, offset=placed.offset + shift)
