"""Where cloth begins: limbs are inside of their sleeves and trouser legs before anything moves."""

from dataclasses import replace

import numpy as np
import pytest

from garmentimage import draft_pattern, load_pattern
from garmentimage.body.body import POSES, load_body
from garmentimage.body.measurements import presets
from garmentimage.drape.items import items
from garmentimage.drape.mesh import mesh
from garmentimage.drape.openings import BONES, bones, openings, turns
from garmentimage.drape.stand import standing
from garmentimage.drape.start import start_points
from garmentimage.examples import example_path
from garmentimage.pattern.model import Edge, Loop, Panel, Pattern, Side, Stitch

LIMBS = tuple(BONES)[1:]
FEW = 600


def limbs_inside(pattern, body) -> set[str]:
    """Limbs that go alone through an opening at the start."""
    cloth = mesh(standing(pattern, body)[0], vertices=FEW)
    start, lines = start_points(cloth, body), bones(body)
    inside = set()
    for opening in openings(cloth.vertex_faces):
        found = [limb for limb, n in zip(LIMBS, turns(start[opening], lines)) if n]
        inside |= set(found) if len(found) == 1 else set()
    return inside


@pytest.mark.parametrize("pose", POSES)
@pytest.mark.parametrize("name", presets())
def test_arms_begin_inside_the_sleeves_and_legs_inside_the_trousers(name, pose):
    body = load_body(name, pose)
    assert limbs_inside(draft_pattern("tee", name), body) == {"left arm", "right arm"}
    assert limbs_inside(draft_pattern("pants", name), body) == {"left leg", "right leg"}


@pytest.mark.parametrize("pose", POSES)
def test_sleeves_drawn_hanging_are_laid_along_the_arms(pose):
    dress = load_pattern(example_path("dress"))
    assert limbs_inside(dress, load_body("mean-female", pose)) == {"left arm", "right arm"}


@pytest.mark.parametrize("degrees", [-4.0, 12.0])
def test_trousers_drawn_for_other_legs_are_laid_along_the_legs(degrees):
    trousers = draft_pattern("pants")

    def leaning(panel):
        """The panel of one leg, turned outward about its waist."""
        side = 1 if panel.name.startswith("left") else -1
        front = 1 if panel.name.endswith("front") else -1
        x, y, _ = panel.rotation
        return replace(panel, rotation=(x, y, side * front * degrees))

    legs = tuple(leaning(p) if "trouser" in p.name else p for p in trousers.panels)
    turned = replace(trousers, panels=legs)
    assert limbs_inside(turned, load_body()) == {"left leg", "right leg"}


def test_a_skirt_begins_where_its_panels_are():
    skirt, body = draft_pattern("skirt"), load_body()
    placed = standing(skirt, body)[0]
    cloth = mesh(placed, vertices=FEW)
    corners = np.empty((len(cloth.flat), 3))
    for k, panel in enumerate(placed.panels):
        own = cloth.panel == k
        corners[own] = panel.to_world(cloth.flat[own])
    np.testing.assert_array_equal(start_points(cloth, body), cloth.sewn(corners))


def joined(*patterns):
    """Patterns side by side, their panels named apart."""
    panels = [p for pattern in patterns for p in pattern.panels]
    assert len({p.name for p in panels}) == len(panels)
    return Pattern(tuple(panels), tuple(s for pattern in patterns for s in pattern.stitches))


def test_what_hangs_goes_over_what_is_held_unless_it_is_tucked():
    body = load_body()
    both = joined(draft_pattern("tee"), draft_pattern("skirt"))
    cloth = mesh(standing(both, body)[0], vertices=FEW)
    start = start_points(cloth, body)
    over, under = (items(cloth, start, body, tucked=tucked) for tucked in (False, True))
    assert [len(i.held) > 0 for i in over] == [True, False]
    assert [len(i.held) > 0 for i in under] == [False, True]
    band = start[over[0].held]
    assert abs(band[:, 1].mean() - body.landmarks["waist_front"][1]) < 5.0


def wide_skirt(angle: float, out: float = 60.0) -> Pattern:
    """A tee that wears a skirt whose side panels begin far out of the body, as godets do."""
    tee = draft_pattern("tee")
    corners = ((0.0, 0.0), (20.0, 0.0), (20.0, 40.0), (0.0, 40.0))
    square = Loop(corners, tuple(Edge(k, (k + 1) % 4) for k in range(4)))
    extra = [
        Panel(f"godet_{k}", square, rotation=(0.0, 0.0, angle), translation=(out, 40.0, z))
        for k, z in ((0, 12.0), (1, -12.0))
    ]
    stitches = (Stitch(Side("godet_0", 1), Side("godet_1", 1)),)
    return replace(tee, panels=(*tee.panels, *extra), stitches=(*tee.stitches, *stitches))


def test_panels_of_a_wide_skirt_are_no_sleeves():
    body = load_body("mean-female")
    alone, beside = draft_pattern("tee"), wide_skirt(20.0)
    starts = []
    for pattern in (alone, beside):
        cloth = mesh(standing(pattern, body)[0], vertices=FEW)
        corners = start_points(cloth, body)[cloth.vertex]
        names = [p.name for p in cloth.pattern.panels]
        sleeve = [n for n in names if n.startswith("left_sleeve")]
        own = np.isin(cloth.panel, [names.index(n) for n in sleeve])
        starts.append((corners[own].min(axis=0), corners[own].max(axis=0)))
    np.testing.assert_allclose(starts[0], starts[1], atol=1.0)
    assert limbs_inside(beside, body) >= {"left arm", "right arm"}
