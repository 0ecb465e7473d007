"""Do the panels stand around a body, in centimetres? Findings with codes where they do not.

What is recognised, each by what no garment of the public datasets has (2,803 files of three
generators; `tests/pattern/test_placement_check.py`):

- **unplaced**: no panel has a place of its own, as in a 2-D drawing.
- **flat-layout**: all panels lie in one plane, side by side as on paper.
- **z-up**: the panels stand upright along z; the world of this format has y up.
- **radians**: the rotations are radians; those of this format are degrees.
- **too-small**, **too-large**: no person's garment, so its unit is not the declared one.
- **perhaps-inches**, **perhaps-not-inches**: a doubt only; it may be a garment for a child or a
  very wide one.
- **off-centre**: the garment lies beside its wearer, and no symmetry says where its middle is.
- **inside-out**: a panel whose outline runs clockwise seen from outside the body.
"""

from dataclasses import replace
from math import pi

import numpy as np
from jaxtyping import Float

from garmentimage.geometry import centroid
from garmentimage.pattern.checks.symmetry import off_centre
from garmentimage.pattern.finding import Finding, some
from garmentimage.pattern.model import Panel, Pattern
from garmentimage.pattern.tubes import tube_sides

UNKNOWN_PLACE = ("unplaced", "flat-layout", "z-up", "radians", "too-small", "too-large")
"""Codes of findings with which nobody can say where on a body the garment belongs."""

FLAT_SHARE = 0.01
"""Panels whose planes are nearer than this share of the largest panel are in one plane."""
SAME_PLACE_SHARE = 0.002
"""Panels whose origins are nearer than this share of the largest panel have no own place."""
PARALLEL = 0.999  # least cosine between the normals of panels in one plane
UPRIGHT_SHARE = 0.4
"""Share of the cloth that must stand along z for the world to be z-up; real garments: to 0.22."""
OPPOSITE = -0.5  # cosine of the normals of a front and a back, seen from above
MIN_TURN = 1.0  # a garment in radians has a panel that is turned by more than this [radians]
QUARTER_TURN_TOL = 2e-3  # rounding of a quarter turn that is written as 1.57 or 3.14 [radians]
INWARD_SHARE = 0.01
"""A panel faces inwards where its centre lies this share of its size behind the garment's."""

SMALL_PANEL, LARGE_PANEL = 10.0, 2_000.0
"""Size of the largest panel of a garment in other units [cm]; real ones: 11 to 1,455."""
LARGE_CLOTH = 400.0
"""Root of the area of all cloth of a garment in other units [cm]; real ones: 20 to 281."""
NARROW_GARMENT = 30.0
"""Width round the body below which a garment is perhaps in inches [cm]; real ones: from 35."""
WIDE_CLOTH = 300.0
"""Root of the area of all cloth above which a garment is perhaps not in inches [cm]."""
USUAL_CLOTH = 95.0
"""Root of the area of all cloth of a usual garment [cm]; the median of the public datasets."""
WRONG_UNITS = (
    (0.01, "metres read as cm"),
    (0.1, "decimetres read as cm"),
    (10.0, "mm read as cm"),
    (100.0, "cm read as metres"),
)
"""By how much a garment is too large where its unit is mistaken, and how."""
PLACE_THEM = (
    "place them around the body: front panels at +z, back panels at -z and turned by 180 degrees "
    "about y"
)


def placement_findings(pattern: Pattern) -> tuple[Finding, ...]:
    """What is odd about where the panels stand and how large they are.

    Args:
        pattern: one that passes `check_structure`.

    Returns:
        Findings with codes; see the module. Placements are judged by two panels or more.
    """
    found = _size_findings(pattern)
    if len(pattern.panels) > 1:
        flat = _flat_finding(pattern)
        found += [flat] if flat else _standing_findings(pattern)
    return tuple(found)


def unknown_place(pattern: Pattern) -> Finding | None:
    """The first finding with which nobody can say where on a body the garment belongs, if any."""
    return next((f for f in placement_findings(pattern) if f.code in UNKNOWN_PLACE), None)


def facing_inwards(pattern: Pattern) -> list[str]:
    """Names of the panels whose counter-clockwise side faces the body, by where they stand."""
    if len(pattern.panels) < 2 or _in_one_plane(pattern):
        return []
    if _in_radians(pattern) or _stands_along_z(pattern):
        return []
    # About the garment's own middle as well as the body's axis: the origin may be elsewhere, and
    # layers may hang in front of the body only.
    outward = np.maximum(_outwardness(pattern), _outwardness(pattern, np.zeros(3)))
    return [p.name for p, side in zip(pattern.panels, outward, strict=True) if side < 0]


# --- units ---------------------------------------------------------------------------------------


def _size_findings(pattern: Pattern) -> list[Finding]:
    largest = _largest_panel(pattern)
    cloth = float(np.sqrt(sum(abs(p.outline.area) for p in pattern.panels)))
    if largest < SMALL_PANEL:
        return [_unit_finding(largest, cloth, "too-small")]
    if largest > LARGE_PANEL or cloth > LARGE_CLOTH:
        return [_unit_finding(largest, cloth, "too-large")]
    if cloth > WIDE_CLOTH:
        message = (
            f"has {cloth**2 / 1e4:.1f} m² of cloth, more than garments have; if its numbers are "
            "cm that were declared inches, set properties.units_in_meter to 100"
        )
        return [Finding("whole garment", message, "perhaps-not-inches")]
    # The longer way across: a garment may be turned about the upright.
    outlines = np.concatenate([_world_outline(p) for p in pattern.panels])
    width = float(np.ptp(outlines[:, [0, 2]], axis=0).max())
    if len(pattern.panels) > 1 and width < NARROW_GARMENT and not _in_one_plane(pattern):
        message = (
            f"is {width:.0f} cm wide, too narrow for a grown person; if its numbers are inches, "
            "set properties.units_in_meter to 39.3701"
        )
        return [Finding("whole garment", message, "perhaps-inches")]
    return []


def _unit_finding(largest: float, cloth: float, code: str) -> Finding:
    """Says which mistake makes garments as large as this."""
    fitting = [w for w in WRONG_UNITS if (w[0] > 1) == (code == "too-large")]
    _, mistake = min(fitting, key=lambda w: abs(np.log(cloth / USUAL_CLOTH / w[0])))
    message = (
        f"its largest panel is {largest:.3g} cm in size, as of {mistake}; "
        "check properties.units_in_meter (100 for cm, 1 for metres, 1000 for mm)"
    )
    return Finding("whole garment", message, code)


# --- placement -----------------------------------------------------------------------------------


def _flat_finding(pattern: Pattern) -> Finding | None:
    """Panels that lie as on paper."""
    if not _in_one_plane(pattern):
        return None
    if all(tube_sides(pattern, panel) for panel in pattern.panels):
        return None  # each goes round the body by itself
    turned = any(p.rotation != pattern.panels[0].rotation for p in pattern.panels)
    if turned and abs(pattern.panels[0].matrix[1, 2]) > PARALLEL and _seams_meet(pattern):
        return None  # a circle round the waist or the neck, laid out level
    origins = np.array([p.translation for p in pattern.panels])
    apart = float(np.linalg.norm(origins - origins[0], axis=1).max())
    if apart <= SAME_PLACE_SHARE * _largest_panel(pattern):
        return Finding("placement", f"all panels are at the same place; {PLACE_THEM}", "unplaced")
    if _seams_meet(pattern):
        return None  # one side of a garment, its parts where they are worn
    message = f"all panels lie in one plane, side by side as on paper; {PLACE_THEM}"
    return Finding("placement", message, "flat-layout")


def _in_one_plane(pattern: Pattern) -> bool:
    normals = np.array([p.matrix[:, 2] for p in pattern.panels])
    heights = np.array([p.translation for p in pattern.panels]) @ normals[0]
    flat = np.ptp(heights) <= FLAT_SHARE * _largest_panel(pattern)
    return bool(flat and np.abs(normals @ normals[0]).min() >= PARALLEL)


def _seams_meet(pattern: Pattern) -> bool:
    """Whether the sides of every seam lie near each other already."""
    tolerance = FLAT_SHARE * _largest_panel(pattern)
    middle = np.array([0.5])
    middles = [[pattern.in_world(s, middle)[0] for s in x.sides] for x in pattern.stitches]
    return bool(middles) and all(np.linalg.norm(a - b) <= tolerance for a, b in middles)


def _standing_findings(pattern: Pattern) -> list[Finding]:
    if _in_radians(pattern):
        message = (
            "the rotations look like radians (3.1416 for a back); this format has degrees: "
            "multiply them by 57.29578"
        )
        return [Finding("placement", message, "radians")]
    if _stands_along_z(pattern):
        message = (
            "the panels stand upright along z; the world of this format has y up and the front at "
            "+z: turn (x, y, z) into (x, z, -y) and the rotations likewise"
        )
        return [Finding("placement", message, "z-up")]
    aside = off_centre(pattern)
    found = [aside] if aside else []
    inward = facing_inwards(pattern)
    if inward:
        message = (
            "its edges run clockwise seen from outside the body, so its wrong side faces out and "
            "its seams twist; reverse the loop unless this is meant"
        )
        found.append(Finding(f"panel {some(inward)}", message, "inside-out"))
    return found


def _in_radians(pattern: Pattern) -> bool:
    """Whether all angles fit into a full turn of radians, and are quarter turns or sensible so."""
    angles = np.abs([p.rotation for p in pattern.panels])
    if not MIN_TURN <= angles.max() <= 2 * pi + QUARTER_TURN_TOL:
        return False
    quarters = angles[angles >= MIN_TURN] / (pi / 2)
    if np.abs(quarters - np.round(quarters)).min() < QUARTER_TURN_TOL:
        return True
    turned = tuple(
        replace(p, rotation=(float(x), float(y), float(z)))
        for p, (x, y, z) in zip(
            pattern.panels, np.rad2deg([p.rotation for p in pattern.panels]), strict=True
        )
    )
    as_degrees = (_outwardness(pattern) > 0).sum()
    return bool((_outwardness(replace(pattern, panels=turned)) > 0).sum() > as_degrees)


def _stands_along_z(pattern: Pattern) -> bool:
    """Whether most cloth has its upward direction along z, a front and a back facing each other."""
    areas = np.array([p.outline.area for p in pattern.panels])
    matrices = np.array([p.matrix for p in pattern.panels])
    upright = matrices[:, 2, 1] ** 2
    if np.abs(areas) @ upright <= UPRIGHT_SHARE * np.abs(areas).sum():
        return False
    facing = (matrices[:, :2, 2] * np.sign(areas)[:, None])[upright > UPRIGHT_SHARE]
    facing /= np.linalg.norm(facing, axis=1, keepdims=True)
    return bool((facing @ facing.T).min() < OPPOSITE)


def _outwardness(
    pattern: Pattern, middle: Float[np.ndarray, " 3"] | None = None
) -> Float[np.ndarray, " panels"]:
    """1 where the counter-clockwise side of a panel faces away from the middle, -1 where it faces
    inwards, 0 where this cannot be said; the middle is the garment's own where none is given.
    """
    outlines = [_world_outline(p) for p in pattern.panels]
    if middle is None:
        everything = np.concatenate(outlines)
        middle = (everything.min(axis=0) + everything.max(axis=0)) / 2
    found = []
    for panel, outline in zip(pattern.panels, outlines, strict=True):
        centre = panel.to_world(centroid(panel.outline.polygon)[None])[0]
        normal = panel.matrix[:, 2] * np.sign(panel.outline.area)
        outward = float((normal * (centre - middle))[[0, 2]].sum())
        size = float(np.ptp(outline, axis=0).max())
        found.append(0.0 if abs(outward) <= INWARD_SHARE * size else float(np.sign(outward)))
    return np.array(found)


def _world_outline(panel: Panel) -> Float[np.ndarray, "n 3"]:
    return panel.to_world(panel.outline.polygon)


def _largest_panel(pattern: Pattern) -> float:
    return max(float(np.ptp(p.outline.polygon, axis=0).max()) for p in pattern.panels)
