"""No degenerate pattern makes compiled code read or write outside its arrays.

`make check-kernels` runs this file with numba's bounds check; without it, a fault may be a crash
of the whole process or nothing at all.
"""

from dataclasses import replace

import numpy as np
import pytest

from garmentimage import decode, encode
from garmentimage.draft.kind import draft_pattern
from garmentimage.drape.draping import drape_pattern
from garmentimage.drape.mesh.meshing import mesh
from garmentimage.drape.solver.solver import SolverSettings
from garmentimage.errors import GarmentImageError
from garmentimage.geometry.curves import Line
from garmentimage.pattern.checks.sewable import check_pattern
from garmentimage.pattern.model import Panel, Pattern, Side, Stitch, loop_from_curves
from garmentimage.raster.frame import BodyFrame
from tests.strangers import doubled, moved, recut, traced

CASES = 4
"""Patterns of each kind."""
FEW_FRAMES = SolverSettings(max_frames=3, gather_frames=1, min_frames=1)
GARMENTS = {kind: draft_pattern(kind) for kind in ("tee", "skirt", "pants")}


def some(rng) -> Pattern:
    return GARMENTS[str(rng.choice(list(GARMENTS)))]


def side_of(pattern, rng) -> Side:
    sides = list(pattern.sides())
    return sides[rng.integers(len(sides))]


def tiny_edges(rng):
    pattern = some(rng)
    for _ in range(rng.integers(1, 5)):
        pattern = doubled(pattern, side_of(pattern, rng), 10 ** rng.uniform(-6, -1))
    return pattern


def tiny_seams(rng):
    """An edge and its partner cut near an end: the short parts are sewn too, or to a long one."""
    pattern = some(rng)
    stitch = pattern.stitches[rng.integers(len(pattern.stitches))]
    tiny, other = 10 ** rng.uniform(-6, -1, 2)
    size = {stitch.a: tiny, stitch.b: rng.choice([tiny, other, 5.0])}

    def cut(side, curve):
        if side not in stitch.sides:
            return [(curve, True)]
        share = min(size[side] / curve.length, 0.5)
        at = share if side == stitch.a or stitch.same_direction else 1 - share
        return [(part, True) for part in curve.split(curve.parameter(at))]

    return recut(pattern, cut)


def near_corners(rng):
    """Two corners of a panel that nearly coincide."""
    pattern = some(rng)
    chosen, size = int(rng.integers(100)), 10 ** rng.uniform(-6, -1)

    def change(points):
        k = chosen % len(points)
        step = points[k] - points[k - 1]
        points[k] = points[k - 1] + size * step / np.hypot(*step)
        return points

    return moved(pattern, change)


def two_panels(points, ratio=1.0):
    """Front and back of one outline, sewn along two edges; the back wider by a factor."""

    def panel(name, outline, z, turn):
        corners = [tuple(map(float, p)) for p in outline]
        lines = [Line(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
        return Panel(name, loop_from_curves(lines), (), (0.0, 100.0, z), (0.0, turn, 0.0))

    points = np.array(points, float)
    front, back = panel("front", points, 20.0, 0.0), panel("back", points * ratio, -20.0, 180.0)
    last = len(points) - 1
    return Pattern(
        (front, back),
        (
            Stitch(Side("front", 1), Side("back", last)),
            Stitch(Side("front", last), Side("back", 1)),
        ),
    )


def rectangle(width, height):
    w = width / 2
    return [(-w, -height), (w, -height), (w, 0.0), (-w, 0.0)]


def needles(rng):
    return two_panels(rectangle(10 ** rng.uniform(-3, 0), rng.uniform(20, 80)))


def specks(rng):
    return two_panels(rectangle(*10 ** rng.uniform(-2, 0, 2)))


def giants(rng):
    return two_panels(rectangle(*rng.uniform(300, 1000, 2)))


def gathers(rng):
    return two_panels(rectangle(*rng.uniform(10, 60, 2)), ratio=10 ** rng.uniform(-2.5, 2.5))


def many_edges(rng):
    """Outlines of short edges that zigzag, so that they cannot be joined."""
    size = rng.uniform(0.01, 0.3)
    pattern = traced(some(rng), rng.uniform(1.0, 6.0))
    return moved(pattern, lambda points: points + rng.uniform(-size, size, points.shape))


def in_line(rng):
    """Edges cut into parts that lie in one line."""
    return recut(
        some(rng),
        lambda side, curve: [(part, True) for part in curve.split(0.5)],
    )


def heaped(rng):
    """All panels at one place, or two of them."""
    pattern = some(rng)
    first = pattern.panels[0]
    whole = rng.random() < 0.5
    panels = [
        replace(p, translation=first.translation, rotation=first.rotation) if whole or k == 1 else p
        for k, p in enumerate(pattern.panels)
    ]
    return replace(pattern, panels=tuple(panels))


KINDS = (
    tiny_edges, tiny_seams, near_corners, needles, specks, giants, gathers, many_edges, in_line,
    heaped,
)  # fmt: skip


def refused(work):
    """The result, or None where the package says why there is none."""
    try:
        return work()
    except GarmentImageError as error:
        assert str(error)
        return None


@pytest.mark.parametrize("number", range(CASES))
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_a_degenerate_pattern_is_taken_or_refused_with_a_sentence(kind, number):
    pattern = kind(np.random.default_rng([number, KINDS.index(kind)]))
    if refused(lambda: check_pattern(pattern)) is None:
        return
    image = refused(lambda: encode(pattern, frame=BodyFrame.standard(16)))
    if image is not None:
        decode(image)
        decode(image.without_marks())
    refused(lambda: mesh(pattern, vertices=300))
    refused(lambda: drape_pattern(pattern, vertices=300, settings=FEW_FRAMES))


@pytest.mark.parametrize("number", range(CASES))
@pytest.mark.parametrize("repair", ["none", "paper", "full"])
def test_noise_is_decoded_or_refused_with_a_sentence(repair, number):
    rng = np.random.default_rng(number)
    channels = encode(GARMENTS["tee"]).to_channels()
    noise = rng.normal(0, rng.choice([0.3, 1.0, 30.0]), channels.shape)
    refused(lambda: decode(channels * rng.integers(2) + noise, repair=repair))
