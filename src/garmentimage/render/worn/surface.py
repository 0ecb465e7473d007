"""What a picture shows: triangle surfaces with colours, made from bodies and draped garments."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np
from jaxtyping import Float, Float32, Int

from garmentimage.body import Body
from garmentimage.drape import Cloth, DrapedGarment
from garmentimage.drape.mesh import vertex_normals
from garmentimage.errors import RenderError, quoted
from garmentimage.geometry import component_labels
from garmentimage.pattern import Panel
from garmentimage.render.worn.prints import Print
from garmentimage.render.worn.tint import Tint, linear, rgb

LIGHT_BLUE, BROWN = "#a5c8e4", "#9c6b4a"
PAPER_COLOURS: Mapping[str, Tint] = MappingProxyType(
    {"top": LIGHT_BLUE, "bottom": BROWN, "dress": BROWN}
)
"""Colours of the panel groups as in the paper (Section 5.3): light blue tops, the rest brown."""
SKIN: Tint = "#dcb8a0"
CLOTH_LIFT = 0.35
"""Cloth lies 0.2 to 0.4 cm above the skin: by this it is drawn off its place in line of sight, and
by this the drawn body is thinner [cm]. So no skin shows through cloth."""
BODY_SHRINK = 0.2
TOP_SHARE = 0.72
"""A panel that reaches above this share of the body's height covers the chest or the arms."""
LONG_SHARE = 0.36
"""A panel that reaches from there to below this share, mid-thigh, is that of a dress."""
NO_LINES = np.zeros((0, 2), np.int64)


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles of one kind and what they look like."""

    name: str
    points: Float[np.ndarray, "vertex 3"]  # [cm]
    faces: Int[np.ndarray, "face 3"]
    """Vertices of each triangle, counter-clockwise seen from outside."""
    colour: Float[np.ndarray, "face 3"]
    """Colour of each triangle [sRGB, 0 to 1]; where there is a print, the print is tinted by it."""
    ids: Int[np.ndarray, " face"]
    """What the panel picture says: number of the panel + 1, or 0 for a body."""
    normals: Float[np.ndarray, "vertex 3"]  # unit normals that shade the surface smoothly
    flat: Float[np.ndarray, "face 3 2"] | None = None
    """Place of each face's corners on the flat cloth [cm], for prints."""
    cloth_print: Print | None = None
    two_sided: bool = True  # whether the inside shows, too, in a darker shade
    lift: float = 0.0  # how far off its place, away from the inside, it is drawn [cm]
    seams: Int[np.ndarray, "seam 2"] = field(default_factory=lambda: NO_LINES)
    """Vertices of the lines along which it is sewn."""
    hems: Int[np.ndarray, "hem 2"] = field(default_factory=lambda: NO_LINES)
    """Vertices of its free edges."""
    still: bool = False
    """Whether it is the same in many pictures: then what the camera sees of it is kept."""

    def __post_init__(self) -> None:
        if not np.isfinite(self.points).all():
            raise RenderError(f"surface {quoted(self.name)}: has NaN or infinite coordinates")
        # Compiled code looks these up without asking.
        assert len(self.colour) == len(self.ids) == len(self.faces)
        for numbers in (self.faces, self.seams, self.hems):
            assert not numbers.size or 0 <= numbers.min() <= numbers.max() < len(self.points)

    @cached_property
    def light(self) -> Float32[np.ndarray, "face 3"]:
        """Colours in linear light."""
        return linear(self.colour)


@lru_cache(maxsize=8)
def body_surface(body: Body, skin: Tint = SKIN) -> Surface:
    """The skin of a body, drawn a little thinner than it is."""
    normals = vertex_normals(body.vertices, body.faces)
    return Surface(
        name=body.name,
        points=body.vertices - BODY_SHRINK * normals,
        faces=body.faces,
        colour=np.broadcast_to(rgb(skin), (len(body.faces), 3)),
        ids=np.zeros(len(body.faces), np.int64),
        normals=normals,
        two_sided=False,
        still=True,
    )


def surfaces_of(
    garment: DrapedGarment,
    *,
    skin: Tint | None = SKIN,
    colours: Mapping[str, Tint] = PAPER_COLOURS,
    prints: Mapping[str, Print] = MappingProxyType({}),
) -> tuple[Surface, ...]:
    """The surfaces of a draped garment: the body, then the cloth, one surface a panel group.

    Args:
        garment: the garment on its body.
        skin: colour of the body; None leaves it away.
        colours: by the name of a panel, its label, or its group (see `panel_groups`), the first
            that is found; where none is, the paper's colour of the group.
        prints: the same for prints, whose colours replace the cloth's; where none is found the
            cloth is plain.
    """
    cloth = garment.cloth
    normals = vertex_normals(garment.points, cloth.vertex_faces)
    grouped = list(zip(cloth.pattern.panels, panel_groups(garment), strict=True))
    printed = [_chosen(prints, panel, group) for panel, group in grouped]
    chosen = [_chosen({**PAPER_COLOURS, **colours}, panel, group) for panel, group in grouped]
    tints = np.array([rgb("white" if p else c) for p, c in zip(printed, chosen, strict=True)])
    seams, hems = cloth_lines(cloth)
    found = [] if skin is None else [body_surface(garment.body, skin)]
    # One surface for each print: they share points, and so the shading over their seams.
    for number, cloth_print in enumerate(dict.fromkeys(printed)):
        mine = np.array([p is cloth_print for p in printed])[cloth.face_panel]
        first = number == 0
        found.append(
            Surface(
                name="cloth" if first else f"cloth {number + 1}",
                points=garment.points,
                faces=cloth.vertex_faces[mine],
                colour=tints[cloth.face_panel[mine]],
                ids=cloth.face_panel[mine] + 1,
                normals=normals,
                flat=None if cloth_print is None else cloth.flat[cloth.faces[mine]],
                cloth_print=cloth_print,
                lift=CLOTH_LIFT,
                seams=seams if first else NO_LINES,
                hems=hems if first else NO_LINES,
            )
        )
    return tuple(found)


def panel_groups(garment: DrapedGarment) -> tuple[str, ...]:
    """For each panel "top", "bottom" or "dress", by where its cloth hangs.

    Names of panels say too little (half of all patterns have a "front"). A panel that reaches the
    chest is of a top, and of a dress if it also reaches the thighs; what is sewn to a dress at the
    chest or the arms is dress, too. A pocket is of what it is sewn onto.
    """
    cloth, panels = garment.cloth, garment.cloth.pattern.panels
    floor, crown = garment.body.vertices[:, 1].min(), garment.body.vertices[:, 1].max()
    share = (garment.points[cloth.vertex, 1] - floor) / (crown - floor)
    high, low = np.full(len(panels), -np.inf), np.full(len(panels), np.inf)
    np.maximum.at(high, cloth.panel, share)
    np.minimum.at(low, cloth.panel, share)
    top = high > TOP_SHARE
    dress = top & (low < LONG_SHARE)
    number = {panel.name: k for k, panel in enumerate(panels)}
    pairs = [(number[s.a.panel], number[s.b.panel]) for s in cloth.pattern.stitches]
    item = component_labels(len(panels), np.array(pairs, int).reshape(-1, 2))
    dress |= top & np.isin(item, item[dress])
    groups = ["dress" if d else "top" if t else "bottom" for d, t in zip(dress, top, strict=True)]
    for sewn in cloth.pattern.onto:
        groups[number[sewn.panel]] = groups[number[sewn.on]]
    return tuple(groups)


def cloth_lines(cloth: Cloth) -> tuple[Int[np.ndarray, "seam 2"], Int[np.ndarray, "hem 2"]]:
    """Vertices of the lines along sewn edges, and along free edges."""
    seams, hems = [NO_LINES], [NO_LINES]
    for side, corners in cloth.sides.items():
        ends = cloth.vertex[corners]
        lines = np.stack([ends[:-1], ends[1:]], axis=1)
        (seams if side in cloth.pattern.partners else hems).append(lines)
    return np.concatenate(seams), np.concatenate(hems)


def _chosen(table: Mapping[Any, Any], panel: Panel, group: str) -> Any:
    """The entry for a panel, for its label or for its group, in this order; or None."""
    return next((table[key] for key in (panel.name, panel.label, group) if key in table), None)
