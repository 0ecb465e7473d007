"""Placement: every panel gets a layer and a pose in the picture plane.

Words of this file:

- **Body cm**: x to the right of a picture of the front, 0 on the body's axis; y up, 0 on the
  floor; z towards the viewer of the front.
- A **frontal** panel faces front or back; an **edge-on** panel is seen from its side.
- A panel **wraps** when it goes round the side of the body or over the head, so that one part
  lies in front and one behind: it is split in two **halves** (see `split`).
- The **layout pose** is a panel moved rigidly into the picture plane, arms stretched to the sides.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from garmentimage.errors import EncodeError
from garmentimage.geometry.polygons import centroid, signed_area
from garmentimage.pattern.model import Pattern
from garmentimage.raster.split import Cloth, Piece, split_wrapping

FRONT, BACK = 0, 1

PELVIS_HEIGHT = 110.0
"""Height above the floor of the origin of patterns that sit round the pelvis [cm]."""

HANGING_HEIGHT = 93.0
"""No garment hangs lower than this from its highest point [cm above the floor]."""

FRONTAL = 0.7
"""Panels with |R22| above this tell where front and back are."""

EDGE_ON = 0.35
"""Panels with |R22| below this are unrolled to the side instead of projected."""

LAYER_DEPTH = 5.0
"""Frontal panels closer together in depth than this [cm] do not tell front from back."""

DEPTH_DEAD_ZONE = 1.0
"""Panels nearer to the middle plane than this [cm] take their layer from their outer face."""

UPRIGHT_ANGLE = 62.0
"""Panels turned by more than this [degrees] in the picture plane lie across, others upright."""

AXIS_CLEARANCE = 1.0
"""Distance that the halves of a side panel keep from the body's axis [cm]."""


@dataclass(frozen=True)
class PlacedPanel:
    """A panel, or a half of one, in its layout pose."""

    name: str
    """Unique; halves have a suffix."""
    source: str
    """Name of the pattern's panel."""
    layer: int
    """0 front, 1 back."""
    curves: tuple[np.ndarray, ...]
    """Per edge a dense polyline [n, 2] in body cm, directed and chained as in the panel."""
    loops: tuple[tuple[int, ...], ...]
    """Edge numbers per loop, outer loop first."""
    matrix: Float[np.ndarray, "2 2"]
    """Orthogonal: layout point = matrix @ panel point + offset."""
    offset: Float[np.ndarray, " 2"]
    sign: int
    """+1 when the outer loop runs counter-clockwise in the layout, else -1."""
    half: bool
    """Part of a split panel."""

    @property
    def outline(self) -> Float[np.ndarray, "n 2"]:
        """The outer loop as a polygon, not closed."""
        return np.concatenate([self.curves[k][:-1] for k in self.loops[0]])


@dataclass(frozen=True)
class PlacedSeam:
    """Two sides sewn together; a side is (panel index, edge number)."""

    a: tuple[int, int]
    b: tuple[int, int]
    crossed: bool
    """The start of `a` meets the end of `b`."""
    cut: bool
    """Made by splitting a wrapping panel; no seam in the pattern."""


@dataclass(frozen=True)
class Placed:
    """All panels in their layout pose, with their seams."""

    panels: tuple[PlacedPanel, ...]
    seams: tuple[PlacedSeam, ...]


def place(pattern: Pattern) -> Placed:
    """Give every panel its layer and its layout pose, wrapping panels split.

    The result does not depend on the order or the names of panels and stitches, nor on which
    edge of a panel comes first, and a mirrored garment gives the mirrored result.

    Raises:
        EncodeError: a seam that cannot lie flat (one panel inside out, or on a second cloth
            layer), or a wrapping panel that cannot be split.
    """
    cloth = Cloth.of(pattern, floor_shift(pattern))
    middle = middle_depth(cloth)
    for piece in cloth.pieces:
        piece.layer = _layer(cloth, piece, middle)
    split_wrapping(cloth, middle)
    poses = {id(p): _pose(cloth, p) for p in cloth.pieces}
    pieces = sorted(cloth.pieces, key=lambda p: _place_key(cloth, p))
    where = {
        edge: (i, k) for i, p in enumerate(pieces) for k, edge in enumerate(_flat(p.loops))
    }
    panels = tuple(_placed(cloth, p, *poses[id(p)]) for p in pieces)
    seams = sorted(
        (
            PlacedSeam(*sorted((where[e], where[o])), crossed, e in cloth.cuts)
            for e, (o, crossed) in cloth.sewn.items()
            if where[e] < where[o]
        ),
        key=lambda s: (s.a, s.b),
    )
    for seam in seams:
        _check_flat(panels, seam)
    return Placed(panels, tuple(seams))


def floor_shift(pattern: Pattern) -> float:
    """How far the pattern must be lifted to stand on the floor [cm].

    Two world conventions occur: feet on the floor at y = 0 (GarmentCode), and the origin near
    the pelvis (Korosteleva and Lee, 2021). A garment hangs from the waist (about 100 cm) or
    higher, so its highest point tells: of thousands of real files the first kind tops at 104 cm
    or more, the second at 83 cm or less, and below 35 cm without a hood.
    """
    top = max(float(p.to_world(p.outline.polygon)[:, 1].max()) for p in pattern.panels)
    return 0.0 if top > HANGING_HEIGHT else PELVIS_HEIGHT


def middle_depth(cloth: Cloth) -> float:
    """Depth of the plane between front and back: midway between their mean frontal panels."""
    depths = np.array(
        [cloth.centre(p)[2] for p in cloth.pieces if abs(p.rotation[2, 2]) > FRONTAL]
    )
    if not len(depths) or np.ptp(depths) <= LAYER_DEPTH:
        return 0.0
    halfway = (depths.max() + depths.min()) / 2
    return float(depths[depths > halfway].mean() + depths[depths <= halfway].mean()) / 2


def _layer(cloth: Cloth, piece: Piece, middle: float) -> int:
    depth = cloth.centre(piece)[2] - middle
    if abs(depth) < DEPTH_DEAD_ZONE and abs(piece.rotation[2, 2]) > FRONTAL:
        depth = piece.rotation[2, 2] * signed_area(cloth.polygon(piece))
    return FRONT if depth >= 0 else BACK


def _pose(cloth: Cloth, piece: Piece) -> tuple[np.ndarray, np.ndarray]:
    """Matrix and offset that take the panel's own frame to the layout."""
    rotation = piece.rotation
    own, world = centroid(cloth.polygon(piece)), cloth.centre(piece)
    edge_on = piece.half or abs(rotation[2, 2]) < EDGE_ON
    matrix = _unrolled(rotation, piece.layer, world) if edge_on else _upright(rotation)
    offset = world[:2] - matrix @ own
    if piece.half and _faces_sideways(rotation):
        side = 1.0 if world[0] >= 0 else -1.0
        nearest = (side * (cloth.polygon(piece) @ matrix[0] + offset[0])).min()
        offset = offset + np.array([side * max(AXIS_CLEARANCE - nearest, 0.0), 0.0])
    return matrix, offset


def _upright(rotation: np.ndarray) -> np.ndarray:
    """The nearest picture-plane pose, turned to the nearest upright or lying position.

    Paper, Section 3.2, asks for panels aligned by hand; the snap makes an A-pose sleeve a T-pose
    sleeve. Real panels are turned by 46 degrees or less, or by 88 or more.
    """
    near = _nearest_orthogonal(rotation[:2, :2])
    mirror = np.diag([1.0 if np.linalg.det(near) > 0 else -1.0, 1.0])
    turn = near @ mirror
    angle = np.rad2deg(np.arctan2(turn[1, 0], turn[0, 0]))
    if abs(angle) <= UPRIGHT_ANGLE:
        snapped = np.eye(2)
    elif abs(angle) >= 180 - UPRIGHT_ANGLE:
        snapped = -np.eye(2)
    else:
        snapped = np.sign(angle) * np.array([[0.0, -1.0], [1.0, 0.0]])
    return snapped @ mirror


def _unrolled(rotation: np.ndarray, layer: int, world: np.ndarray) -> np.ndarray:
    """An edge-on panel laid flat: what is deep in the body goes outward, away from its axis."""
    outward = -1.0 if layer == FRONT else 1.0
    if _faces_sideways(rotation):
        side = 1.0 if world[0] >= 0 else -1.0
        rows = [side * outward * rotation[2, :2], rotation[1, :2]]
    else:
        up = 1.0 if world[1] >= 0 else -1.0
        rows = [rotation[0, :2], outward * up * rotation[2, :2]]
    return _nearest_orthogonal(np.stack(rows))


def _faces_sideways(rotation: np.ndarray) -> bool:
    return bool(abs(rotation[0, 2]) >= abs(rotation[1, 2]))


def _nearest_orthogonal(matrix: np.ndarray) -> np.ndarray:
    """Polar factor: the orthogonal matrix nearest to a 2 x 2 matrix."""
    u, _, v = np.linalg.svd(matrix)
    return u @ v


def _placed(cloth: Cloth, piece: Piece, matrix: np.ndarray, offset: np.ndarray) -> PlacedPanel:
    numbers = iter(range(sum(map(len, piece.loops))))
    panel = PlacedPanel(
        name=piece.name,
        source=piece.source,
        layer=piece.layer,
        curves=tuple(cloth.curves[e] @ matrix.T + offset for e in _flat(piece.loops)),
        loops=tuple(tuple(next(numbers) for _ in loop) for loop in piece.loops),
        matrix=matrix,
        offset=offset,
        sign=1,
        half=piece.half,
    )
    return panel if signed_area(panel.outline) > 0 else replace(panel, sign=-1)


def _flat(loops: list[list[int]]) -> list[int]:
    return [edge for loop in loops for edge in loop]


def _place_key(cloth: Cloth, piece: Piece) -> tuple[int, float, str]:
    """Where a panel stands in every list: by layer and place, so that file order cannot matter."""
    x, y, z = cloth.centre(piece)
    return piece.layer, float(y + GENERIC_SLOPE * x + GENERIC_SLOPE**2 * z), piece.name


GENERIC_SLOPE = 0.381966
"""Direction along which places are put in order; a slope that no pattern has, so ties are rare."""


def _check_flat(panels: tuple[PlacedPanel, ...], seam: PlacedSeam) -> None:
    """Both sides must have their right side out, as cloth that lies flat has."""
    a, b = panels[seam.a[0]], panels[seam.b[0]]
    same_face = a.sign * (-1) ** a.layer == b.sign * (-1) ** b.layer
    if same_face == seam.crossed:
        return
    raise EncodeError(
        f"panels {a.source!r} and {b.source!r}: edge {seam.a[1]} of the first and edge "
        f"{seam.b[1]} of the second are sewn right side to wrong side, as for a collar or "
        "lapel that needs a second cloth layer; leave that panel out, or turn it over if it "
        "is inside out"
    )
