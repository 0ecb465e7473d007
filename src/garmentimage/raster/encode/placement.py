"""Placement: every panel gets a layer and a pose in the picture plane.

Words of this file:

- **Body cm**: x to the right of a picture of the front, 0 on the body's axis; y up, 0 on the
  floor; z towards the viewer of the front.
- A **frontal** panel faces front or back; an **edge-on** panel is seen from its side.
- A panel **wraps** when it goes round the side of the body or over the head, so that one part
  lies in front and one behind: it is split in two **parts** (see `split`).
- The **layout pose** is a panel moved rigidly into the picture plane, arms stretched to the sides.
"""

from collections.abc import Mapping, Set
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from garmentimage.errors import EncodeError
from garmentimage.geometry import signed_area
from garmentimage.pattern import FRONTAL, Pattern, Point, floor_shift, fold_seams
from garmentimage.raster.encode.creases import cut_creases
from garmentimage.raster.encode.joints import find_joints
from garmentimage.raster.encode.pockets import cut_beneath
from garmentimage.raster.encode.split import SEEN_FROM_SIDE, PanelPart, SplitPattern, split_wrapping
from garmentimage.raster.encode.tubes import split_tubes

FRONT, BACK = 0, 1
MAX_SHEETS = 2
"""Sheets of cloth that can lie on each other, each with a front and a back layer."""

EDGE_ON = 0.35
"""Panels with |R22| below this are laid flat to the side instead of projected."""
LAYER_DEPTH = 5.0
"""Frontal panels closer together in depth than this [cm] do not separate front from back."""
DEPTH_DEAD_ZONE = 1.0
"""Panels nearer to the middle plane than this [cm] take their layer from their outer face."""
PLAIN_ANGLE = 30.0
"""Panels turned by less than this [degrees] from upright or lying are taken to be so."""
UPRIGHT_PULL = 15.0
"""Length [cm] of an upright seam that would keep a part of a split panel upright."""
AXIS_CLEARANCE = 1.0
"""Distance that the parts of a side panel keep from the body's axis [cm]."""
GENERIC_SLOPE = 0.381966
"""Direction along which places are put in order; a slope that no pattern has, so ties are rare."""
QUARTER_TURN = np.array([[0, -1], [1, 0]])


@dataclass(frozen=True)
class PlacedPanel:
    """A panel, or a part of one, in its layout pose."""

    name: str
    """Unique; parts of a split panel have a suffix."""
    source: str
    """Name of the pattern's panel."""
    layer: int
    """0 front, 1 back; 2 and 3 of the sheet that lies on them."""
    curves: tuple[Float[np.ndarray, "_ 2"], ...]
    """Per edge a dense polyline in body cm, directed and chained as in the panel."""
    loops: tuple[tuple[int, ...], ...]
    """Edge numbers per loop, outer loop first."""
    matrix: Float[np.ndarray, "2 2"]
    """Orthogonal: layout point = matrix @ panel point + offset."""
    offset: Float[np.ndarray, " 2"]
    sign: int
    """+1 when the outer loop runs counter-clockwise in the layout, else -1."""
    is_part: bool
    """Part of a split panel."""
    origin: tuple[int | None, ...] = ()
    """Per edge the number of the edge of the pattern's panel that it is, or is a part of; None
    where the panel was cut."""
    pleats: tuple[tuple[int, ...], ...] = ()
    """For each pressed pleat its edges in the order of the loop, its creases among them."""

    @property
    def faces_out(self) -> bool:
        """The panel's right side faces away from the body."""
        return self.sign == (1 if self.layer % 2 == FRONT else -1)

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
    is_cut: bool = False
    """Where a panel was cut in two: the cloth goes on, round the body."""
    is_crease: bool = False
    """Along a fold that is seen: the cloth goes on."""


@dataclass(frozen=True)
class Beneath:
    """What lies beneath a side of a panel that is sewn onto another's cloth."""

    side: tuple[int, int]
    """A side of what was cut out beneath it."""
    crossed: bool
    """The start of one lies on the end of the other."""
    is_sewn: bool
    """Whether this side is sewn on; the opening of a pocket is not."""


@dataclass(frozen=True)
class Placed:
    """All panels in their layout pose, with their seams."""

    panels: tuple[PlacedPanel, ...]
    seams: tuple[PlacedSeam, ...]
    joined: Mapping[str, tuple[Point, ...]] = field(default_factory=dict)
    """Of the pattern's panels, vertices of dense outlines that decoding restores, in the
    panel's own frame [cm]."""
    turned: Set[str] = frozenset()
    """Names of the pattern's panels that were laid open, their wrong side out."""
    whole: Mapping[int, int] = field(default_factory=dict)
    """For each part that lies hidden beneath others the panel that it is a part of."""
    beneath: Mapping[tuple[int, int], "Beneath"] = field(default_factory=dict)
    """For each side of a pocket, and each that is sewn onto cloth, the side beneath it."""
    middles: Mapping[str, Float[np.ndarray, " 2"]] = field(default_factory=dict)
    """Where something is sewn onto cloth, centres of area by panel, in its own frame [cm]."""

    @property
    def layer_count(self) -> int:
        """Layers, two for each sheet of cloth."""
        return 2 * (1 + max(panel.layer for panel in self.panels) // 2)


def place(pattern: Pattern, turned: Set[str] = frozenset()) -> Placed:
    """Give every panel its layer and its layout pose, edges joined, wrapping panels split.

    The result does not depend on the order or the names of panels and stitches, nor on which
    edge of a panel comes first, and a mirrored garment gives the mirrored result.

    Args:
        pattern: the garment, all its seams plain.
        turned: names of the panels that were laid open for that.

    Raises:
        EncodeError: a seam that cannot lie flat (one panel inside out), a wrapping panel that
            cannot be split, or more cloth layers than there are sheets.
    """
    sheets = _sheets(pattern, turned)
    joints = find_joints(pattern)
    split = SplitPattern.of(pattern, joints, floor_shift(pattern))
    middle = middle_depth(split)
    for part in split.parts:
        part.layer = _layer(split, part, middle)
    split_tubes(split)
    split_wrapping(split, middle)
    matrices = _matrices(split)
    poses = {id(p): (m, _offset(split, p, m)) for p, m in zip(split.parts, matrices, strict=True)}
    for part in split.parts:
        part.layer += 2 * sheets[part.source]
    middles = {part.source: split.own_centre(part) for part in split.parts if not part.is_part}
    sewn_on = cut_beneath(split, pattern.onto)
    for each in sewn_on:
        matrix, offset = poses[id(each.base)]
        poses[id(each.hidden)] = matrix, offset
        poses[id(each.part)] = matrix @ each.matrix, matrix @ each.offset + offset
    cut_creases(split, pattern)
    # By layer and place, so that file order cannot matter.
    parts = sorted(split.parts, key=lambda p: (p.layer, _lean(split, p), p.name))
    where = {edge: (i, k) for i, p in enumerate(parts) for k, edge in enumerate(p.edges)}
    panels = tuple(_placed(split, p, *poses[id(p)]) for p in parts)
    sewn = [
        PlacedSeam(where[e], where[f], crossed, e in split.cuts, e in split.creases)
        for e, (f, crossed) in split.sewn.items()
    ]
    seams = tuple(sorted((s for s in sewn if s.a < s.b), key=lambda s: (s.a, s.b)))
    for seam in seams:
        _check_flat(panels, seam)
    joined: dict[str, tuple[Point, ...]] = {}
    for side in joints.kept:
        joined[side.panel] = (*joined.get(side.panel, ()), pattern.curve(side).start)
    number = {id(part): i for i, part in enumerate(parts)}
    return Placed(
        panels,
        seams,
        joined,
        turned,
        whole=_roots({number[id(each.hidden)]: number[id(each.base)] for each in sewn_on}),
        beneath={
            where[edge]: Beneath(where[hidden], crossed, is_sewn)
            for each in sewn_on
            for edge, hidden, crossed, is_sewn in each.sides
        },
        middles=middles if sewn_on else {},
    )


def _roots(base_of: Mapping[int, int]) -> dict[int, int]:
    """For each hidden part the panel that it is a part of in the end."""
    roots = {}
    for part, base in base_of.items():
        while base in base_of:
            base = base_of[base]
        roots[part] = base
    return roots


def _sheets(pattern: Pattern, turned: Set[str]) -> dict[str, int]:
    """On which sheet each panel lies: 0, or 1 where it has an outer cloth layer.

    A turned panel lies on the sheet of what it is sewn to, a pocket on the one over its base.
    """
    base_of = {sewn.panel: sewn.on for sewn in pattern.onto}
    plain = [p for p in pattern.panels if p.name not in turned and p.name not in base_of]
    layers = sorted({panel.cloth_layer for panel in plain})
    if len(layers) > MAX_SHEETS:
        third = next(panel for panel in plain if panel.cloth_layer == layers[MAX_SHEETS])
        raise EncodeError(
            f"its panels lie on {len(layers)} cloth layers, and an image has room for "
            f"{MAX_SHEETS}; leave out panel {third.name[:80]!r} of cloth layer {third.cloth_layer}",
            remedy="pattern",
        )
    sheets = {panel.name: layers.index(panel.cloth_layer) for panel in plain}
    folds = fold_seams(pattern, turned)
    for name in sorted(turned):
        beneath = folds[name][1].panel if name in folds else name
        sheets[name] = sheets.get(beneath, 0)
    for name, base in base_of.items():
        sheets[name] = sheets.get(base, MAX_SHEETS) + 1
        if sheets[name] >= MAX_SHEETS:
            raise EncodeError(
                f"panel {name[:80]!r} is sewn onto panel {base[:80]!r}, which lies on other cloth "
                "itself; an image has room for two cloth layers: leave it out",
                remedy="pattern",
            )
    return sheets


def middle_depth(split: SplitPattern) -> float:
    """Depth of the plane between front and back: midway between their mean frontal panels."""
    depths = np.array([split.centre(p)[2] for p in split.parts if abs(p.rotation[2, 2]) > FRONTAL])
    if not len(depths) or np.ptp(depths) <= LAYER_DEPTH:
        return 0.0
    halfway = (depths.max() + depths.min()) / 2
    return float(depths[depths > halfway].mean() + depths[depths <= halfway].mean()) / 2


def _layer(split: SplitPattern, part: PanelPart, middle: float) -> int:
    depth = split.centre(part)[2] - middle
    if abs(depth) < DEPTH_DEAD_ZONE and abs(part.rotation[2, 2]) > FRONTAL:
        depth = _outward(split, part)[2]
    return FRONT if depth >= 0 else BACK


class _SeamSide(NamedTuple):
    """A seam, seen from one of the two panels or parts that it joins."""

    part: int
    partner: int
    chord: Float[np.ndarray, " 2"]
    """From one end of the seam to the other on `part`, in its own frame [cm]."""
    partner_chord: Float[np.ndarray, " 2"]
    """The same on `partner`, pointing to the same end."""
    length: float
    """Of `chord` [cm]."""


Matrix = Float[np.ndarray, "2 2"]
"""Orthogonal: takes directions in a panel's own frame to the layout."""


def _matrices(split: SplitPattern) -> list[Matrix]:
    """For every panel or part the matrix that takes its own frame to the layout.

    A panel that hangs askew (a sleeve, and its cuff) is turned to the upright or the lying
    position nearest to it. Where it is unclear which of the two is meant, its seams with panels
    of known position decide, those with the longest seams first.
    """
    choices = [
        [_laid_flat(split, p)]
        if _is_half(p) or abs(p.rotation[2, 2]) < EDGE_ON
        else _upright(p.rotation)[: 1 if p.is_part else None]
        for p in split.parts
    ]
    matrices = {i: poses[0] for i, poses in enumerate(choices) if len(poses) == 1}
    askew = {i: poses for i, poses in enumerate(choices) if len(poses) > 1}
    sides = _seam_sides(split)
    while askew:
        known = {i: [s for s in sides if s.part == i and s.partner in matrices] for i in askew}
        lean = {i: _lean(split, split.parts[i]) for i in askew}
        i = max(askew, key=lambda i: (sum(s.length for s in known[i]), -lean[i]))
        matrices[i] = max(askew.pop(i), key=lambda m: _agreement(m, known[i], matrices))
    whole = {i: m for i, m in matrices.items() if not split.parts[i].is_part}
    for i in matrices.keys() - whole.keys():
        known_sides = [s for s in sides if s.part == i and s.partner in whole]
        matrices[i] = _leaning(matrices[i], known_sides, whole)
    return [matrices[i] for i in range(len(split.parts))]


def _seam_sides(split: SplitPattern) -> list[_SeamSide]:
    """Every seam, once from each side."""
    owner = {e: i for i, p in enumerate(split.parts) for e in p.edges}
    sides = []
    for edge, (other, crossed) in split.sewn.items():
        mine = split.curves[edge][-1] - split.curves[edge][0]
        theirs = split.curves[other][-1] - split.curves[other][0]
        length = float(np.hypot(*mine))
        theirs = -theirs if crossed else theirs
        sides.append(_SeamSide(owner[edge], owner[other], mine, theirs, length))
    return sides


def _agreement(matrix: Matrix, sides: list[_SeamSide], matrices: dict[int, Matrix]) -> float:
    """How well seams of a panel point in the direction of those they are sewn to [cm].

    The sum of length x cosine over the seams.
    """
    agreement = 0.0
    for _, partner, mine, theirs, size in sides:
        along = matrix @ mine @ (matrices[partner] @ theirs)
        agreement += along * size / (np.hypot(*mine) * np.hypot(*theirs) + 1e-9)
    return agreement


def _leaning(matrix: Matrix, sides: list[_SeamSide], matrices: dict[int, Matrix]) -> Matrix:
    """The pose of a part, turned so that its seams lean as those that they are sewn to.

    Least squares over the directions, with `UPRIGHT_PULL` towards the upright: the rotation that
    maximises UPRIGHT_PULL cos(a) + sum of length x cos(a - angle of the seam to its partner).
    """
    along, across = UPRIGHT_PULL, 0.0
    for _, partner, mine, theirs, length in sides:
        (x, y), (u, v) = matrix @ mine, matrices[partner] @ theirs
        scale = length / (np.hypot(x, y) * np.hypot(u, v) + 1e-9)
        along += scale * (x * u + y * v)
        across += scale * (x * v - y * u)
    size = np.hypot(along, across)
    return np.asarray(np.array([[along, -across], [across, along]]) @ matrix / size)


def _lean(split: SplitPattern, part: PanelPart) -> float:
    x, y, z = split.centre(part)
    return float(y + GENERIC_SLOPE * x + GENERIC_SLOPE**2 * z)


def _offset(split: SplitPattern, part: PanelPart, matrix: Matrix) -> Float[np.ndarray, " 2"]:
    """Where the origin of the panel's own frame lies in the layout."""
    polygon = split.polygon(part)
    world = split.centre(part)
    offset: Float[np.ndarray, " 2"] = world[:2] - matrix @ split.own_centre(part)
    if _is_half(part) and _faces_sideways(part.rotation):
        side = np.sign(_outward(split, part)[0])
        nearest = (side * (polygon @ matrix[0] + offset[0])).min()
        offset = offset + np.array([side * max(AXIS_CLEARANCE - nearest, 0.0), 0.0])
    return offset


def _outward(split: SplitPattern, part: PanelPart) -> Float[np.ndarray, " 3"]:
    """Unit normal of the panel's outer face: seen from there its outline runs counter-clockwise."""
    return np.asarray(part.rotation[:, 2] * np.sign(signed_area(split.polygon(part))))


def _upright(rotation: Float[np.ndarray, "3 3"]) -> list[Matrix]:
    """The picture-plane poses a panel may be intended for, upright or lying, nearest first.

    Paper, Section 3.2, has panels aligned by hand; this makes an A-pose sleeve a T-pose
    sleeve. There is no choice for a panel turned by less than `PLAIN_ANGLE` from such a pose.
    """
    near = _nearest_orthogonal(rotation[:2, :2])
    mirror = np.diag([1.0 if np.linalg.det(near) > 0 else -1.0, 1.0])
    turn = near @ mirror
    angle = np.rad2deg(np.arctan2(turn[1, 0], turn[0, 0]))
    below = np.floor(angle / 90)
    beyond = angle / 90 - below
    quarters = [below, below + 1] if beyond < 0.5 else [below + 1, below]
    if beyond * 90 < PLAIN_ANGLE or beyond * 90 > 90 - PLAIN_ANGLE:
        quarters = quarters[:1]
    return [np.linalg.matrix_power(QUARTER_TURN, int(q) % 4) @ mirror for q in quarters]


def _laid_flat(split: SplitPattern, part: PanelPart) -> Matrix:
    """An edge-on panel laid flat: what is deep in the body goes outward, away from its axis."""
    rotation, outward = part.rotation, _outward(split, part)
    deep = -1.0 if part.layer == FRONT else 1.0
    if _faces_sideways(rotation):
        rows = [np.sign(outward[0]) * deep * rotation[2, :2], rotation[1, :2]]
    else:
        rows = [rotation[0, :2], np.sign(outward[1]) * deep * rotation[2, :2]]
    return _nearest_orthogonal(np.stack(rows))


def _is_half(part: PanelPart) -> bool:
    """Whether a panel is half of one seen from its side; parts of a tube face front and back."""
    return part.is_part and bool(abs(part.rotation[2, 2]) < SEEN_FROM_SIDE)


def _faces_sideways(rotation: Float[np.ndarray, "3 3"]) -> bool:
    return bool(abs(rotation[0, 2]) >= abs(rotation[1, 2]))


def _nearest_orthogonal(matrix: Matrix) -> Matrix:
    """Polar factor: the orthogonal matrix nearest to a 2 x 2 matrix."""
    u, _, v = np.linalg.svd(matrix)
    return np.asarray(u @ v)


def _placed(
    split: SplitPattern, part: PanelPart, matrix: Matrix, offset: Float[np.ndarray, " 2"]
) -> PlacedPanel:
    numbers = iter(range(len(part.edges)))
    number = {edge: k for k, edge in enumerate(part.edges)}
    panel = PlacedPanel(
        name=part.name,
        source=part.source,
        layer=part.layer,
        curves=tuple(split.curves[e] @ matrix.T + offset for e in part.edges),
        loops=tuple(tuple(next(numbers) for _ in loop) for loop in part.loops),
        matrix=matrix,
        offset=offset,
        sign=1,
        is_part=part.is_part,
        origin=tuple(split.origin.get(e) for e in part.edges),
        pleats=tuple(tuple(number[e] for e in run) for run in split.pleats if run[0] in number),
    )
    return panel if signed_area(panel.outline) > 0 else replace(panel, sign=-1)


def _check_flat(panels: tuple[PlacedPanel, ...], seam: PlacedSeam) -> None:
    """Both sides must have their right side out, as cloth that lies flat has."""
    a, b = panels[seam.a[0]], panels[seam.b[0]]
    if (a.faces_out == b.faces_out) != seam.crossed:
        raise EncodeError(
            f"panels {a.source[:80]!r} and {b.source[:80]!r} are sewn right side to wrong side, as "
            "for a collar or lapel that needs a second cloth layer; leave that panel out, or turn "
            "it over if it is inside out",
            remedy="pattern",
        )
