"""Garments worn together: several patterns as one."""

from collections.abc import Container, Sequence
from dataclasses import replace

from garmentimage.body import Body, wearer
from garmentimage.drape.draping import check_placed
from garmentimage.drape.fit import AUTO, best_fit
from garmentimage.drape.mesh import check_size
from garmentimage.drape.start import place_on_body
from garmentimage.pattern import Panel, Pattern, Pleat, SewnOnto, Side, Stitch


def outfit(
    patterns: Sequence[Pattern], body: str | Body = "mean-female", *, made_for: float | None = None
) -> Pattern:
    """Several garments as one pattern whose panels stand where the body wears them.

    Each is put on the body by itself, as the files may stand in different worlds. Panels whose
    names are taken get a number. For `body` and `made_for` see `drape_pattern`.

    Raises:
        DraftError: `made_for` is out of range.
        DrapeError: one of them is too large to be draped, or nobody can say where on a body it
            belongs.
    """
    body = wearer(best_fit(patterns, made_for=made_for).body if body == AUTO else body)
    for pattern in patterns:
        check_size(pattern)
    panels: list[Panel] = []
    stitches: list[Stitch] = []
    onto: list[SewnOnto] = []
    pleats: list[Pleat] = []
    for pattern in patterns:
        check_placed(pattern)
        placed, _ = place_on_body(pattern, body, made_for=made_for)
        taken = {panel.name for panel in panels}
        names: dict[str, str] = {}
        for panel in placed.panels:
            names[panel.name] = _free(panel.name, taken)
            taken.add(names[panel.name])
        panels += [replace(panel, name=names[panel.name]) for panel in placed.panels]
        stitches += [
            replace(
                stitch,
                a=Side(names[stitch.a.panel], stitch.a.edge),
                b=Side(names[stitch.b.panel], stitch.b.edge),
            )
            for stitch in placed.stitches
        ]
        onto += [replace(sewn, panel=names[sewn.panel], on=names[sewn.on]) for sewn in placed.onto]
        pleats += [replace(pleat, panel=names[pleat.panel]) for pleat in placed.pleats]
    name = " + ".join(pattern.name for pattern in patterns)
    return Pattern(tuple(panels), tuple(stitches), name, tuple(onto), tuple(pleats))


def _free(name: str, taken: Container[str]) -> str:
    """The name, with the first number that makes it a new one where it is taken.

    Example:
        >>> _free("front", {"front", "front-2"})
        'front-3'
    """
    number, free = 1, name
    while free in taken:
        number += 1
        free = f"{name}-{number}"
    return free
