"""Whether pleats are sewn, and pressed on cloth that is there."""

from math import isfinite

from garmentimage.errors import StitchError, quoted
from garmentimage.pattern.finding import Finding
from garmentimage.pattern.model import Pattern
from garmentimage.pattern.pleats import FOLDED_AT, is_on_cloth

MIN_DEPTH_CM = 0.2  # shortest edge of a pleat


def check_pleats(pattern: Pattern) -> None:
    """Check that pleats name two edges that follow each other and are sewn to each other.

    Raises:
        StitchError: one does not; names the panel.
    """
    seen: set[tuple[str, int]] = set()
    for pleat in pattern.pleats:
        place = f"pleat of panel {quoted(pleat.panel)}, edges {list(pleat.edges)}"
        if pleat.panel not in pattern.by_name:
            raise StitchError(f"{place}: there is no such panel")
        count = len(pattern.by_name[pleat.panel].outline.edges)
        first, second = pleat.edges
        if not 0 <= first < count or second != (first + 1) % count:
            raise StitchError(
                f"{place}: name two edges of the outline, 0 to {count - 1}, the second after the "
                "first"
            )
        a, b = pleat.sides
        if pattern.partners.get(a) != b:
            raise StitchError(f"{place}: its two edges are not sewn to each other; add the stitch")
        if (pleat.panel, first) in seen:
            raise StitchError(f"{place}: is given twice; remove one")
        seen.add((pleat.panel, first))
        if pleat.fold not in FOLDED_AT:
            raise StitchError(
                f"{place}: its fold is {quoted(str(pleat.fold))}; there are {', '.join(FOLDED_AT)}"
            )
        if not (isfinite(pleat.pressed) and pleat.pressed > 0):
            raise StitchError(
                f"{place}: is pressed for {pleat.pressed:.6g} cm; give a length, or leave the "
                "pleat out and keep its stitch"
            )


def pressed_findings(pattern: Pattern) -> list[Finding]:
    """Pleats that are pressed beyond the cloth of their panel, or too shallow to be one."""
    found = []
    for pleat in pattern.pleats:
        place = f"pleat of panel {quoted(pleat.panel)}"
        if min(pattern.curve(side).length for side in pleat.sides) < MIN_DEPTH_CM:
            found.append(Finding(place, f"is less than {MIN_DEPTH_CM} cm deep"))
        elif not is_on_cloth(pattern, pleat):
            message = f"is pressed for {pleat.pressed:.1f} cm, beyond its cloth; press it for less"
            found.append(Finding(place, message))
    return found
