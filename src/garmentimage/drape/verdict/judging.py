"""Assessment of a drape: its quality, and what makes it a failure."""

import numpy as np
from jaxtyping import Float

from garmentimage.body import Body
from garmentimage.drape.cloth import Cloth
from garmentimage.drape.components import GarmentItem
from garmentimage.drape.draped_garment import DrapeReport
from garmentimage.drape.fit import tight_places
from garmentimage.drape.folded import FoldedPanels
from garmentimage.drape.girths import shoulder, waist_height
from garmentimage.drape.mesh import Rest, peak_strain, strain
from garmentimage.drape.solver import Motion, body_field
from garmentimage.drape.start import EASE, ELASTIC, TIGHT, Placement, on_hips
from garmentimage.drape.support import SupportSite
from garmentimage.drape.verdict.folds import fold_faults, overlap_faults
from garmentimage.drape.verdict.intersections import crossing_count
from garmentimage.drape.verdict.openings import BONES, bones, is_beyond, openings, turns
from garmentimage.drape.verdict.skin import deepest

MAX_PENETRATION = 0.5  # cloth may lie this far under the skin [cm]
MAX_STRAIN = 0.25  # all but a hundredth of the cloth, by area, may stretch by this share
MAX_SLID = 3.0
"""A garment may lie this far from where it is worn [cm]; what sits on the hips, further."""
HIGH_WAIST = 8.0
"""A top edge at the waist may lie this far above it [cm], as those of waistbands do."""
SPACING = 4.0
"""Cloth lies on the shoulders where a vertex is within this distance of their line [cm]: seams
are moved to the back or to the front of them, and vertices lie 3 cm apart."""
RESTING = 25
"""So many percent of the cloth over the shoulders should rest on them; a hood's does not all."""


def assess_drape(  # noqa: PLR0913 - all parts of a drape are judged at once
    cloth: Cloth,
    rest: Rest,
    start: Float[np.ndarray, "vertex 3"],
    points: Float[np.ndarray, "vertex 3"],
    body: Body,
    items: tuple[GarmentItem, ...],
    motions: tuple[Motion, ...],
    *,
    folded: FoldedPanels,
    seconds: float,
) -> DrapeReport:
    """Measure a drape and list its faults.

    Vertices began at `start` and are now at `points` [cm]; each layer has its motion. `folded` are
    the panels that should be folded over. `seconds` is the time it took so far.
    """
    settled = all(m.settled for m in motions)
    frames = max(m.frames for m in motions)
    speed = max(float(m.speeds[-1]) for m in motions)
    above = body_field(body).at(points)
    penetration = deepest(points, rest.faces, body)
    stretch = peak_strain(rest, points)
    slid: dict[str, float] = {}
    faults = []
    if not settled:
        faults.append(f"it still moved after {frames} frames ({speed:.1f} cm/s)")
    if penetration > MAX_PENETRATION:
        faults.append(f"cloth lies {penetration:.1f} cm under the skin (at most {MAX_PENETRATION})")
    if stretch > MAX_STRAIN:
        tight = tight_places(cloth, strain(rest, points), points, body)
        faults.append(
            f"it is too tight: stretched by {stretch:.1%} (at most {MAX_STRAIN:.0%}), {tight}"
        )
    for item in items:
        place, off = item.placement.site.value, _off(item, points, start, above, body)
        slid[place] = max(slid.get(place, 0.0), off)
        if _has_slid(item, points, body, off):
            faults.append(f"it slid {off:.1f} cm from the {place}{_too_wide(item.placement)}")
    return DrapeReport(
        settled=settled,
        frames=frames,
        speed=speed,
        penetration=penetration,
        strain=stretch,
        slid=slid,
        crossings=crossing_count(points, rest.faces),
        held=sum(len(i.pinned) for i in items) / len(points),
        items=len(items),
        faults=(
            *faults,
            *_limb_faults(rest.faces, start, points, body),
            *fold_faults(cloth, points, folded, body),
            *overlap_faults(cloth, points, folded),
        ),
        notes=_notes(items, body),
        seconds=seconds,
    )


def _has_slid(item: GarmentItem, points: np.ndarray, body: Body, off: float) -> bool:
    """Whether an item that lies so far off is not where the body wears it."""
    placement = item.placement
    if placement.site is not SupportSite.WAIST or not placement.is_supported:
        return off > MAX_SLID
    # Worn on the hips, as its top edge is too long for the waist; it must not sink further.
    sank = placement.level - float(points[item.top, 1].mean()) if len(item.top) else 0.0
    return off > on_hips(body) or sank > MAX_SLID


def _off(
    item: GarmentItem, points: np.ndarray, start: np.ndarray, above: np.ndarray, body: Body
) -> float:
    """How far an item lies from where the body wears it [cm].

    At the waist: how far its top edge lies below the waist, or above where a waistband reaches. At
    the chest: how far its top edge lies from its height over the bust. On the shoulders: how far
    the cloth that should lie on them is from their skin, or from the line along them.
    """
    if item.placement.site is SupportSite.SHOULDERS:
        where = item.seams
        if not len(where):
            highest = points[item.vertices, 1].max()
            return max(0.0, float(body.landmarks["left_neck_point"][1] - highest))
        rests = item.over_shoulders if len(item.over_shoulders) else where
        off = max(float(np.percentile(above[rests], RESTING)), _from_shoulders(points[where], body))
    else:
        where = item.top if len(item.top) else item.vertices
        height = max(float(points[where, 1].mean()), 0.0)
        if item.placement.site is SupportSite.WAIST:
            over = height - waist_height(body)
            off = max(-over, over - HIGH_WAIST, 0.0)
        else:
            off = abs(height - item.placement.level)
    return max(off, _aside(start[where, 0], points[where, 0]))


def _from_shoulders(points: Float[np.ndarray, "n 3"], body: Body) -> float:
    """How far cloth lies from the shoulders [cm]: the nearest of it, on the worse of its sides."""
    neck, end = body.landmarks["left_neck_point"], shoulder(body)
    worst = 0.0
    for side in (1, -1):
        own = points[side * points[:, 0] > 0] * [side, 1, 1]
        if len(own):
            line = neck + np.linspace(0, 1, 9)[:, None] * (end - neck)
            worst = max(worst, float(np.linalg.norm(own[:, None] - line, axis=2).min()))
    return max(0.0, worst - SPACING)


def _aside(before: Float[np.ndarray, " n"], after: Float[np.ndarray, " n"]) -> float:
    """How far cloth moved to one side [cm]; 0 where it lies on one side only, as one strap does."""
    left, right = before > 0, before < 0
    if not left.any() or not right.any():
        return 0.0
    moved = after - before
    return abs(float(moved[left].mean() + moved[right].mean())) / 2


def _too_wide(placement: Placement) -> str:
    """Why it slid, and what to do, where that is known."""
    if placement.site is SupportSite.SHOULDERS or placement.length <= placement.girth:
        return f" (at most {MAX_SLID:g})"
    at_waist = placement.site is SupportSite.WAIST
    what = "its top edge" if at_waist else "under its top edge it"
    elastic = f", label its edges {ELASTIC!r} for an elastic" if at_waist else ""
    return (
        f": {what} is {placement.length:.0f} cm round, the body's {placement.site.value} "
        f"{placement.girth:.0f}; take it in, sew it to a shorter band{elastic}, or choose a larger "
        "body"
    )


def _notes(items: tuple[GarmentItem, ...], body: Body) -> tuple[str, ...]:
    """How the garment was put on, where that is not obvious."""
    notes = []
    for item in items:
        placement, place = item.placement, item.placement.site.value
        name = f"the garment of panel {min(placement.panels)[:40]!r}"
        if not placement.is_certain:
            notes.append(
                f"{name} was taken for one worn at the {place} only because {placement.reason}; "
                "if that is wrong, name the panels at its top, such as skirt_front or bodice_front"
            )
        below = waist_height(body) - placement.level
        if 0 < placement.drawn_length < placement.length - EASE - TIGHT:
            notes.append(
                f"the top edge of {name}, {placement.length:.0f} cm long, is drawn together to "
                f"{placement.drawn_length:.0f} cm, as by an elastic"
            )
        elif placement.site is SupportSite.WAIST and placement.is_supported and below > MAX_SLID:
            why = (
                f"its top edge is {placement.length:.0f} cm round, the body's waist "
                f"{placement.girth:.0f}"
                if placement.length > placement.girth + EASE
                else "its crotch would be over the body's"
            )
            notes.append(f"{name} sits on the hips, {below:.0f} cm below the waist: {why}")
    return tuple(notes)


def _limb_faults(faces: np.ndarray, start: np.ndarray, points: np.ndarray, body: Body) -> list[str]:
    """Limbs that cloth went through, and clothing with no limb in it.

    A bone that leaves through one opening only, as the head does, has no turns left when those of
    all openings are added up; else it goes through cloth. Where none did at the start (flat panels
    may begin beside a limb), the turns of each opening must be the same, too: both legs in one
    trouser leg go through no cloth. A hood may begin over the face and come to lie round it, so
    that its opening may pass the head.
    """
    lines = bones(body)
    if lines is None:
        return []
    limbs = tuple(BONES)[1:]
    found = openings(faces)
    before = np.array([turns(start[o], lines) for o in found]).reshape(-1, len(limbs))
    after = np.array([turns(points[o], lines) for o in found]).reshape(-1, len(limbs))
    if not after.any():
        return [
            "the body is not in the garment: nothing closes round it; place its panels in front of "
            "the body and behind it, and sew them together on both sides"
        ]
    beyond = np.array([[is_beyond(points[o], lines[limb]) for limb in limbs] for o in found])
    after = np.where(beyond, before, after)
    began_through, through = before.sum(axis=0) != 0, after.sum(axis=0) != 0
    if through.all() and np.ptp(after.sum(axis=0)) == 0:
        hooded = start[:, 1].max() > lines["head"][-1, 1]
        return [] if hooded else ["the head went through the cloth"]
    left_opening = ~began_through & (after != before).any(axis=0)
    return sorted(
        f"the {limb} went through the cloth"
        for limb, bad in zip(limbs, through | left_opening, strict=True)
        if bad
    )
