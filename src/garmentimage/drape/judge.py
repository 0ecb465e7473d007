"""Judging a drape: what a buyer would ask, and what makes it a failure."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from garmentimage.body.body import Body
from garmentimage.drape.cloth import Cloth
from garmentimage.drape.crossings import crossing_count
from garmentimage.drape.field import body_field
from garmentimage.drape.fit import tight_places
from garmentimage.drape.items import Item
from garmentimage.drape.openings import BONES, bones, is_beyond, openings, turns
from garmentimage.drape.rest import Rest, most_strain, strain
from garmentimage.drape.skin import deepest
from garmentimage.drape.solver import Motion
from garmentimage.drape.worn import DrapeReport

DEEPEST = 0.5
"""Cloth may lie this far under the skin [cm]."""
MOST_STRAIN = 0.25
"""All but a hundredth of the cloth, by area, may stretch by this share."""
MOST_SLID = 3.0
"""A garment may lie this far from where it is worn [cm]."""
RESTING = 25
"""So many percent of the cloth over the shoulders should rest on them; a hood's does not all."""


def judge(
    cloth: Cloth,
    rest: Rest,
    start: Float[np.ndarray, "vertex 3"],
    points: Float[np.ndarray, "vertex 3"],
    body: Body,
    items: tuple[Item, ...],
    motions: tuple[Motion, ...],
    *,
    seconds: float,
) -> DrapeReport:
    """What came of a drape.

    Args:
        cloth: the sewn garment ...
        rest: ... and what it is without strain.
        start: where its vertices began [cm].
        points: where they are now [cm].
        body: who wears it.
        items: its connected pieces ...
        motions: ... and how each of them moved.
        seconds: what it took so far.
    """
    settled = all(m.settled for m in motions)
    frames = max(m.frames for m in motions)
    speed = max(float(m.speeds[-1]) for m in motions)
    above = body_field(body).at(points)
    penetration = deepest(points, rest.faces, body)
    stretch = most_strain(rest, points)
    tight = tight_places(cloth, strain(rest, points), points, body) if stretch > MOST_STRAIN else ""
    slid = _slid(start, points, above, items)
    return DrapeReport(
        settled=settled,
        frames=frames,
        speed=speed,
        penetration=penetration,
        strain=stretch,
        slid=slid,
        crossings=crossing_count(points, rest.faces),
        held=sum(len(i.held) for i in items) / len(points),
        items=len(items),
        faults=(
            *_motion_faults(settled, frames, speed, penetration, stretch, slid, tight),
            *_limb_faults(rest.faces, start, points, body),
        ),
        seconds=seconds,
    )


def _slid(
    start: np.ndarray,
    points: np.ndarray,
    above: np.ndarray,
    items: tuple[Item, ...],
) -> Mapping[str, float]:
    """How far each item lies from where it is worn, the worst of each kind [cm].

    At the waist, what is held: its height, and its way to the side. On the shoulders, the cloth
    that began over them: its distance from the skin where it rests, and its way to the side.
    """
    slid: dict[str, float] = {}
    for item in items:
        if len(item.held):
            name, where = "waist", item.held
            off = abs(float((points - start)[where, 1].mean()))
        else:
            name, where = "shoulders", item.resting
            if not len(where):
                continue
            off = float(np.percentile(above[where], RESTING))
        slid[name] = max(slid.get(name, 0.0), off, _aside(start[where, 0], points[where, 0]))
    return slid


def _aside(before: Float[np.ndarray, " n"], after: Float[np.ndarray, " n"]) -> float:
    """How far cloth moved to one side [cm]; 0 where it lies on one side only, as one strap does."""
    left, right = before > 0, before < 0
    if not left.any() or not right.any():
        return 0.0
    moved = after - before
    return abs(float(moved[left].mean() + moved[right].mean())) / 2


def _motion_faults(
    settled: bool,
    frames: int,
    speed: float,
    penetration: float,
    stretch: float,
    slid: Mapping[str, float],
    tight: str,
) -> list[str]:
    faults = []
    if not settled:
        faults.append(f"it still moved after {frames} frames ({speed:.1f} cm/s)")
    if penetration > DEEPEST:
        faults.append(f"cloth lies {penetration:.1f} cm under the skin (at most {DEEPEST})")
    if stretch > MOST_STRAIN:
        faults.append(
            f"it is too tight: stretched by {stretch:.1%} (at most {MOST_STRAIN:.0%}), {tight}"
        )
    faults += [
        f"it slid {far:.1f} cm from the {place} (at most {MOST_SLID:g})"
        for place, far in slid.items()
        if far > MOST_SLID
    ]
    return faults


def _limb_faults(faces: np.ndarray, start: np.ndarray, points: np.ndarray, body: Body) -> list[str]:
    """Limbs that cloth went through, and clothing with no limb in it.

    A bone that leaves through one opening only, as the head does, has no turns left when those of
    all openings are added up; else it goes through cloth. Where none did at the start (flat panels
    may begin beside a limb), the turns of each opening must have stayed, too: both legs in one
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
        return ["the body is not in the garment"]
    beyond = np.array([[is_beyond(points[o], lines[limb]) for limb in limbs] for o in found])
    after = np.where(beyond, before, after)
    began_through, through = before.sum(axis=0) != 0, after.sum(axis=0) != 0
    if through.all() and np.ptp(after.sum(axis=0)) == 0:
        hooded = start[:, 1].max() > lines["head"][-1, 1]
        return [] if hooded else ["the head went through the cloth"]
    left_opening = ~began_through & (after != before).any(axis=0)
    return sorted(
        f"the {limb} went through the cloth"
        for limb, bad in zip(limbs, through | left_opening)
        if bad
    )
