"""Wearing: from a pattern to a garment at rest on a body."""

import time

import numpy as np

from garmentimage.body.body import Body
from garmentimage.body.stance import wearer
from garmentimage.drape.fabric import Fabric, load_fabric
from garmentimage.drape.field import DistanceField, body_field
from garmentimage.drape.fit import AUTO, best_fit
from garmentimage.drape.items import Item, items
from garmentimage.drape.judge import judge
from garmentimage.drape.mesh import VERTICES, check_size, mesh
from garmentimage.drape.rest import rest_of
from garmentimage.drape.solver import Attachment, Settings, Watch, solve
from garmentimage.drape.stand import standing
from garmentimage.drape.start import start_points
from garmentimage.drape.tuck import tucked_in
from garmentimage.drape.worn import Worn
from garmentimage.errors import DrapeError, check_type
from garmentimage.pattern.model import Pattern
from garmentimage.pattern.placement_check import unknown_place

BELT_STIFFNESS = 1e5
"""With which a belt keeps each vertex at its height [dyn/cm]."""


def drape(
    pattern: Pattern,
    body: str | Body = "mean-female",
    *,
    fabric: str | Fabric = "cotton",
    vertices: int = VERTICES,
    tucked: bool = False,
    made_for: float | None = None,
    settings: Settings | None = None,
    watch: Watch | None = None,
) -> Worn:
    """Put a garment on a body and let it come to rest; same bits on every run.

    The garment is moved to where the body wears it (`stand`), cut into triangles and sewn (`mesh`),
    and simulated (`solver`), one connected piece of clothing over the other (`items`).

    Args:
        pattern: a garment that passes `check_pattern`.
        body: name of a shipped body, in T-pose and with its legs upright, "auto" for the one on
            which the garment fits best, or a body as it stands.
        fabric: name of a fabric, or one of your own.
        vertices: about how many the cloth has.
        tucked: tops are worn under skirts and trousers, not over them.
        made_for: stature that the pattern was made for [cm]; the garment is then scaled to the
            body's.
        settings: of the simulation.
        watch: is called every few frames of each piece of clothing, see `solve`.

    Returns:
        The garment on the body. Look at `report.faults`, or call `check_worn`: a drape that went
        wrong is returned too.

    Raises:
        DrapeError: a pattern that has no stitches, that has no place or is in other units
            (`placement_findings`), or that cannot be cut into triangles.
        DraftError: there is no body of that name, or `made_for` is no stature.
        TypeError: an argument is of another type.
    """
    check_type(pattern, Pattern, "garmentimage.load_pattern reads one from a file")
    check_type(vertices, int, "say about how many the cloth shall have")
    began = time.perf_counter()
    fabric = load_fabric(fabric) if isinstance(fabric, str) else fabric
    check_type(fabric, Fabric, "name one, such as 'cotton'")
    _check_sewn(pattern)
    check_size(pattern)
    check_placed(pattern)
    body = wearer(best_fit([pattern], made_for=made_for).body if body == AUTO else body)
    placed, _ = standing(pattern, body, made_for=made_for)
    cloth = mesh(placed, vertices=vertices)
    rest = rest_of(cloth)
    start = start_points(cloth, body)
    points, motions = start.copy(), []
    field: DistanceField = body_field(body)
    worn_items = items(cloth, start, body, tucked=tucked)
    band = max((float(start[i.held, 1].mean()) for i in worn_items if len(i.held)), default=None)
    for item in worn_items:
        part = rest.part(item.vertices)
        if tucked and band is not None and not len(item.held):
            part = tucked_in(part, start[item.vertices], body, band)
        motion = solve(
            part,
            start[item.vertices],
            field,
            fabric,
            attachment=_belt(item, start),
            resting=np.searchsorted(item.vertices, item.resting),
            settings=settings,
            watch=watch,
        )
        points[item.vertices] = motion.points
        motions.append(motion)
        if item is not worn_items[-1]:
            field = field.with_cloth(motion.points, part.faces, thickness=fabric.thickness)
    report = judge(
        cloth,
        rest,
        start,
        points,
        body,
        worn_items,
        tuple(motions),
        seconds=time.perf_counter() - began,
    )
    return Worn(cloth, points, body, report)


def check_worn(worn: Worn) -> None:
    """Refuse a drape that went wrong.

    Raises:
        DrapeError: says all faults.
    """
    if worn.report.faults:
        raise DrapeError(
            f"the drape of {worn.cloth.pattern.name or 'the garment'} on {worn.body.name} failed: "
            + "; ".join(worn.report.faults)
        )


def _check_sewn(pattern: Pattern) -> None:
    if not pattern.stitches:
        raise DrapeError(
            f"{pattern.name or 'the pattern'} has no stitches, so nothing holds it on a body; "
            "sew its panels first"
        )


def check_placed(pattern: Pattern) -> None:
    """Refuse a pattern of which nobody can say where on a body it belongs.

    Raises:
        DrapeError: says what its places or its units look like, and the remedy.
    """
    finding = unknown_place(pattern)
    if finding:
        name = pattern.name or "the pattern"
        raise DrapeError(f"{name} cannot be put on a body: {finding}")


def _belt(item: Item, start: np.ndarray) -> Attachment | None:
    """Holds an item up where nothing else does; free to move sideways."""
    if not len(item.held):
        return None
    own = np.searchsorted(item.vertices, item.held)
    stiffness = np.zeros((len(own), 3))
    stiffness[:, 1] = BELT_STIFFNESS
    return Attachment(own, start[item.held], stiffness)
