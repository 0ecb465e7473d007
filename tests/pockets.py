"""Garments with panels sewn onto the cloth of others, for tests."""

from dataclasses import replace

import numpy as np

from garmentimage.pattern import Panel, Pattern, SewnOnto, Side, Stitch
from tests.lapels import polygon


def with_pocket(
    pattern: Pattern,
    on: str,
    centre: tuple[float, float],
    size: tuple[float, float] = (12.0, 14.0),
    name: str = "pocket",
    angle: float = 0.0,
) -> Pattern:
    """The pattern with a patch pocket, a rectangle open at its top.

    Args:
        pattern: any.
        on: the panel that it is sewn onto.
        centre: the middle of the pocket on that panel [cm].
        size: width and height [cm].
        name: of the pocket.
        angle: by which it is turned on that panel [degrees].
    """
    width, height = size
    outline = polygon((0, 0), (width, 0), (width, height), (0, height))
    if pattern.by_name[on].outline.area < 0:
        outline = polygon((0, height), (width, height), (width, 0), (0, 0))
    base = pattern.by_name[on]
    x, y, z = base.to_world(np.array([centre], float))[0].tolist()
    cos, sin = float(np.cos(np.deg2rad(angle))), float(np.sin(np.deg2rad(angle)))
    matrix = np.array([[cos, -sin], [sin, cos]])
    left, low = (np.array(centre) - matrix @ [width / 2, height / 2]).tolist()
    top = 2 if base.outline.area > 0 else 0
    edges = tuple(k for k in range(4) if k != top)
    pocket = Panel(name, outline, (), (x, y, z), base.rotation, cloth_layer=1)
    onto = SewnOnto(name, edges, on, ((cos, -sin), (sin, cos)), (left, low))
    return replace(pattern, panels=(*pattern.panels, pocket), onto=(*pattern.onto, onto))


def with_peplum(
    pattern: Pattern, height: float = -6.0, length: float = 16.0, flare: float = 8.0
) -> Pattern:
    """The pattern with a short skirt sewn across its panels `front` and `back`.

    Args:
        pattern: a top that is drawn upright.
        height: of the seam in the coordinates of those panels [cm].
        length: of the peplum [cm].
        flare: how much wider it is at its hem, on either side [cm].
    """
    panels, onto = list(pattern.panels), list(pattern.onto)
    for face in ("front", "back"):
        base = pattern.by_name[face]
        ring = base.outline.fine_polygon
        ring = np.concatenate([ring, ring[:1]])
        crossing = np.flatnonzero((ring[:-1, 1] > height) != (ring[1:, 1] > height))
        shares = (height - ring[crossing, 1]) / (ring[crossing + 1, 1] - ring[crossing, 1])
        across = ring[crossing, 0] + shares * (ring[crossing + 1, 0] - ring[crossing, 0])
        left, right, hem = float(across.min()), float(across.max()), height - length
        corners = ((left, height), (left - flare, hem), (right + flare, hem), (right, height))
        name = f"peplum_{face}"
        panels.append(
            Panel(name, polygon(*corners), (), base.translation, base.rotation, cloth_layer=1)
        )
        onto.append(SewnOnto(name, (3,), face, ((1.0, 0.0), (0.0, 1.0)), (0.0, 0.0)))
    sides = (
        Stitch(Side("peplum_front", 0), Side("peplum_back", 2)),
        Stitch(Side("peplum_front", 2), Side("peplum_back", 0)),
    )
    stitches = (*pattern.stitches, *sides)
    return replace(pattern, panels=tuple(panels), stitches=stitches, onto=tuple(onto))
