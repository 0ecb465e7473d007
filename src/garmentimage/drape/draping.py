"""Draping: from a pattern to a garment at rest on a body."""

import time
from dataclasses import replace

import numpy as np

from garmentimage.body import Body, wearer
from garmentimage.drape.components import garment_items, with_elastics
from garmentimage.drape.draped_garment import DrapedGarment
from garmentimage.drape.fabric import Fabric, load_fabric
from garmentimage.drape.fit import AUTO, best_fit
from garmentimage.drape.folded import folded_panels
from garmentimage.drape.layers import (
    LayerRole,
    belt,
    garment_layers,
    held_at_seams,
    interfaced,
    pressed_fold,
    pressed_stand,
    sewn_lines,
    without_falls,
)
from garmentimage.drape.mesh import DEFAULT_VERTICES, check_size, mesh, rest_of
from garmentimage.drape.solver import (
    SolverSettings,
    Watch,
    body_field,
    solve,
)
from garmentimage.drape.start import (
    fold_onto,
    lay_onto,
    lie_over,
    place_on_body,
    pressed_pleats,
    stand_up,
    start_points,
    tuck_in,
)
from garmentimage.drape.support import SupportSite
from garmentimage.drape.verdict import assess_drape
from garmentimage.drape.world_panels import connected_garments
from garmentimage.errors import DrapeError, check_type, quoted
from garmentimage.pattern import Pattern, tube_sides, without_stubs
from garmentimage.pattern.checks import off_centre, unknown_place

ONE_PLANE = 1.0  # panels whose depths differ by less [cm] all lie on one side of the body


def drape_pattern(
    pattern: Pattern,
    body: str | Body = "mean-female",
    *,
    fabric: str | Fabric = "cotton",
    vertices: int = DEFAULT_VERTICES,
    tucked: bool = False,
    made_for: float | None = None,
    settings: SolverSettings | None = None,
    watch: Watch | None = None,
) -> DrapedGarment:
    """Put a garment on a body and let it come to rest; same bits on every run.

    The garment is moved to where the body wears it (`start.placement`), cut into triangles and sewn
    (`mesh`), and simulated (`solver`), one item of clothing over the other (`components`).

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
        watch: called every few frames of each item of clothing, see `solve`.

    Returns:
        The garment on the body. Look at `report.faults`, or call `check_drape`: a failed drape
        is returned, too.

    Raises:
        DrapeError: a pattern that nothing would hold on a body, as its panels are not sewn or all
            lie in one plane, that has no place or is in other units, or
            that cannot be cut into triangles.
        DraftError: there is no body of that name, or `made_for` is out of range.
        TypeError: an argument is of another type.
    """
    check_type(pattern, Pattern, "garmentimage.load_pattern reads one from a file")
    check_type(vertices, int, "give the approximate number of vertices")
    began = time.perf_counter()
    fabric = load_fabric(fabric) if isinstance(fabric, str) else fabric
    check_type(fabric, Fabric, "name one, such as 'cotton'")
    _check_sewn(pattern)
    pattern = without_stubs(pattern)
    check_size(pattern)
    check_placed(pattern)
    _check_surrounding(pattern)
    body = wearer(best_fit([pattern], made_for=made_for).body if body == AUTO else body)
    placed, placements = place_on_body(pattern, body, made_for=made_for)
    cloth = mesh(placed, vertices=vertices)
    holding = {side.panel for p in placements if p.is_supported for side in p.edges}
    folded = folded_panels(placed, frozenset(holding))
    start = start_points(cloth, body, placements, later=folded.below.keys())
    points, motions = start.copy(), []
    before = field = body_field(body)
    items = garment_items(cloth, start, body, placements, tucked=tucked)
    rest = with_elastics(rest_of(cloth), items)
    band = max((float(i.level.mean()) for i in items if len(i.pinned)), default=None)
    layers = garment_layers(cloth, items, folded)
    for layer in layers:
        part = rest.part(layer.vertices, layer.faces)
        part = replace(part, pressed=pressed_pleats(cloth, layer.vertices))
        hold, material, obstacle = belt(layer), fabric, field
        if layer.role is LayerRole.FOLDED:
            points = fold_onto(cloth, points, folded, field, fabric.thickness)
            hold, material = pressed_fold(cloth, layer, folded, points), interfaced(fabric)
        elif layer.role is LayerRole.STANDING:
            points[layer.own] = stand_up(cloth, points, folded)[layer.own]
            part, hold = without_falls(part), pressed_stand(layer, points)
            material = interfaced(fabric)
        elif layer.role is LayerRole.SEWN_ON:
            points[layer.own] = lay_onto(cloth, points, field, fabric.thickness)[layer.own]
            hold = sewn_lines(cloth, layer, points)
        elif layer.role is LayerRole.OVERLAPPING:
            over = np.unique(cloth.face_panel[layer.faces])
            hold = held_at_seams(layer, points)
            lower = cloth.vertex_faces[layer.lies_on]
            obstacle = before.with_cloth(points, lower, thickness=fabric.thickness)
            started = lie_over(cloth, points, over, obstacle, fabric.thickness)
            points[layer.own] = started[layer.own]
        elif tucked and band is not None and layer.item.placement.site is SupportSite.SHOULDERS:
            part = tuck_in(part, start[layer.vertices], body, band)
        motion = solve(
            part,
            points[layer.vertices],
            obstacle,
            material,
            attachment=hold,
            with_friction=np.flatnonzero(np.isin(layer.vertices, layer.item.over_shoulders)),
            settings=settings,
            watch=watch,
        )
        points[layer.own] = motion.points[np.isin(layer.vertices, layer.own)]
        motions.append(motion)
        if layer is not layers[-1]:
            before = field if layer.role is LayerRole.PLAIN else before
            field = field.with_cloth(motion.points, part.faces, thickness=fabric.thickness)
    seconds = time.perf_counter() - began
    report = assess_drape(
        cloth, rest, start, points, body, items, tuple(motions), folded=folded, seconds=seconds
    )
    return DrapedGarment(cloth, points, body, report)


def check_drape(garment: DrapedGarment) -> None:
    """Refuse a failed drape.

    Raises:
        DrapeError: lists all faults.
    """
    if garment.report.faults:
        name, faults = garment.cloth.pattern.name or "the garment", "; ".join(garment.report.faults)
        raise DrapeError(f"the drape of {name} on {garment.body.name} failed: {faults}")


def _check_sewn(pattern: Pattern) -> None:
    """Refuse a pattern with an item that no stitch holds."""
    name = pattern.name or "the pattern"
    if not pattern.stitches:
        remedy = "sew its panels first"
        if len(pattern.panels) == 1 and pattern.panels[0].holes:
            remedy = (
                "cut it through the hole into a front and a back, and sew them at the shoulders"
            )
        raise DrapeError(f"{name} has no stitches, so nothing holds it on a body; {remedy}")
    for part in connected_garments(pattern):
        first = quoted(part.panels[0].name)
        if not part.stitches:
            raise DrapeError(
                f"{name}: panel {first} is sewn to nothing, so nothing holds it on a body "
                '(stitches join edges; what is sewn onto cloth stands in "onto"); sew it to the '
                "garment, or leave it out"
            )


def _check_surrounding(pattern: Pattern) -> None:
    """Refuse clothes whose panels all lie on one side of the body."""
    name = pattern.name or "the pattern"
    for part in connected_garments(pattern):
        first = quoted(part.panels[0].name)
        points = np.concatenate([p.to_world(p.outline.polygon) for p in part.panels])
        if np.ptp(points[:, 2]) >= ONE_PLANE:
            continue
        if all(tube_sides(part, panel) for panel in part.panels):
            continue
        raise DrapeError(
            f"{name}: the panels of the garment of panel {first} all lie in one plane, so the body "
            "cannot be between them; sew one that should go round the body by itself to itself, or "
            "place them round the body: fronts before it (z about 20 cm), "
            "backs behind it (z about -20 cm, turned by 180 degrees about y)"
        )


def check_placed(pattern: Pattern) -> None:
    """Refuse a pattern of which nobody can say where on a body it belongs.

    Raises:
        DrapeError: says what its places or its units look like, and the remedy.
    """
    finding = unknown_place(pattern) or off_centre(pattern)
    if finding:
        name = pattern.name or "the pattern"
        raise DrapeError(f"{name} cannot be put on a body: {finding}")
