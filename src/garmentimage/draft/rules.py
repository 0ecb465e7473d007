"""What a garment needs so that it can be worn, as rules with a reason."""

from collections.abc import Sequence
from itertools import islice

import numpy as np

from garmentimage.draft.curves import chain_polygons
from garmentimage.draft.panel import Outline, PanelDraft
from garmentimage.errors import DraftError
from garmentimage.geometry import Point, signed_area

HEAD_STRETCH = 1.3
"""How far a neckline stretches to let the head through; ribbed and bias edges do so easily."""
MIN_STRAP_WIDTH = 2.5
"""Shortest shoulder seam that still holds a garment up [cm]."""
WAIST_EASE = 2.0
"""How much wider than the waist skirts and trousers are [cm]."""
ARM_EASE = 2.0
"""Least that a sleeve is wider than the arm [cm]."""
TURN_UP_ROOM = 2.0
"""Least that a sleeve shows between its armhole and a cuff that is turned up [cm]."""
THIGH_EASE = 1.0
"""Least that a trouser leg is wider than the thigh [cm]."""
BUST_CLEARANCE = 2.0
"""A dart ends at least so far from the bust point, or the cloth forms a point [cm]."""
HOLE_MARGIN = 2.5
"""Least cloth between a cut-out and the edges of its panel [cm]."""
POCKET_MARGIN = 1.5
"""Least cloth between a patch pocket and the edges of its panel [cm]."""


def check_neck(opening: float, head_girth: float) -> None:
    """Refuse a closed neckline that the head does not pass."""
    if opening * HEAD_STRETCH < head_girth:
        raise DraftError(
            f"the neckline is {opening:.1f} cm round and stretches to "
            f"{opening * HEAD_STRETCH:.1f} cm, but the head is {head_girth:.1f} cm; make "
            "neck_width or neck_depth larger"
        )


def check_strap(shoulder_seam: float) -> None:
    """Refuse a shoulder seam that is too short to hold the garment."""
    if shoulder_seam < MIN_STRAP_WIDTH:
        raise DraftError(
            f"the shoulder seam is {shoulder_seam:.1f} cm long, at least {MIN_STRAP_WIDTH} cm "
            "hold a garment; make neck_width smaller or shoulder_reach larger"
        )


def check_sleeve(width: float, arm_girth: float) -> None:
    """Refuse a sleeve that the arm does not pass."""
    if width < arm_girth + ARM_EASE:
        raise DraftError(
            f"the sleeve is {width:.1f} cm round, the arm with {ARM_EASE} cm of ease "
            f"{arm_girth + ARM_EASE:.1f} cm; make cap_height smaller or armhole_ease larger"
        )


def check_turn_up(depth: float, length: float) -> None:
    """Refuse a turned-up cuff that reaches into the armhole; `length` is of the underarm seam."""
    if depth + TURN_UP_ROOM > length:
        raise DraftError(
            f"the cuff is turned up by {depth:.1f} cm, but the sleeve is {length:.1f} cm long at "
            f"the underarm, of which {TURN_UP_ROOM} cm stay free; make cuff_depth smaller or "
            "sleeve_length larger"
        )


def check_thigh(width: float, thigh_girth: float) -> None:
    """Refuse a trouser leg that the thigh does not pass."""
    if width < thigh_girth + THIGH_EASE:
        raise DraftError(
            f"the leg is {width:.1f} cm round, the thigh with {THIGH_EASE} cm of ease "
            f"{thigh_girth + THIGH_EASE:.1f} cm; make hip_ease larger"
        )


def check_pocket(pocket: Outline, base: PanelDraft, offset: Point) -> None:
    """Refuse a pocket that does not lie on its panel."""
    from garmentimage.geometry import contains

    (polygon,) = chain_polygons([[named.curve for named in base.outline]])
    for named in pocket:
        x, y = named.curve.start
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            place = x + offset[0] + POCKET_MARGIN * dx, y + offset[1] + POCKET_MARGIN * dy
            if not contains(polygon, np.array(place)):
                raise DraftError(
                    f"the pocket does not lie on {base.name} with {POCKET_MARGIN:g} cm of cloth "
                    "beside it; make it smaller or change pocket_place"
                )


def check_outlines(panels: Sequence[PanelDraft]) -> None:
    """Refuse a panel that cannot be cut: its loops touch, or it runs clockwise."""
    from garmentimage.geometry import touching_sides

    chains = [
        chain
        for panel in panels
        for chain in ([n.curve for n in panel.outline], *(hole.curves for hole in panel.holes))
    ]
    polygons = iter(chain_polygons(chains))
    for panel in panels:
        outline, *holes = islice(polygons, 1 + len(panel.holes))
        if signed_area(outline) <= 0 or len(touching_sides([outline, *holes])) > 0:
            raise DraftError(
                f"these parameters do not go together: the outline of {panel.name} crosses "
                "itself; bring them nearer to their defaults"
            )
