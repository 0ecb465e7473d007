"""Where cloth begins: limbs are inside of their sleeves and trouser legs before anything moves."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import KDTree

from garmentimage import draft_pattern, load_pattern
from garmentimage.body.body import POSES, load_body
from garmentimage.body.body_measurements import presets
from garmentimage.draft.kind import kinds
from garmentimage.drape.components import garment_items
from garmentimage.drape.draping import check_drape, drape_pattern
from garmentimage.drape.mesh.meshing import mesh
from garmentimage.drape.solver.distance_field import body_field
from garmentimage.drape.start.placement import place_on_body
from garmentimage.drape.start.starting import start_points
from garmentimage.drape.verdict.openings import BONES, bones, openings, turns
from garmentimage.errors import GarmentImageError
from garmentimage.examples import example_path
from garmentimage.pattern.files.spec import read_pattern
from garmentimage.pattern.model import Circle, Edge, Loop, Panel, Pattern, Side, Stitch
from tests.compare.garments import split_edges
from tests.corpus import corpus_sample

LIMBS = tuple(BONES)[1:]
FEW = 600
NEAR_CM = 4.5
"""Vertices of two meshes of the same cloth are that near to each other."""


def limbs_inside(pattern, body) -> set[str]:
    """Limbs that go alone through an opening at the start."""
    cloth = mesh(place_on_body(pattern, body)[0], vertices=FEW)
    start, lines = start_points(cloth, body), bones(body)
    inside = set()
    for opening in openings(cloth.vertex_faces):
        found = [limb for limb, n in zip(LIMBS, turns(start[opening], lines), strict=True) if n]
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


@pytest.mark.parametrize("share", [0.2, 0.55])
@pytest.mark.parametrize(
    ("kind", "parts"), [*((kind, {}) for kind in kinds()), ("shirt", {"cuffs": "band"})]
)
def test_a_garment_begins_where_it_does_with_whole_edges_if_all_its_edges_are_divided(
    kind, parts, share
):
    """Sleeves once began askew where the seam of a cuff had two parts."""
    body, pattern = load_body(), draft_pattern(kind, **parts)
    every = [Side(panel.name, k) for panel in pattern.panels for k in range(len(panel.edges))]
    partners = {stitch.b for stitch in pattern.stitches}
    partners |= {side for pleat in pattern.pleats for side in pleat.sides}
    divided = split_edges(pattern, {side: share for side in every if side not in partners})
    before, after = (
        start_points(cloth, body, placements)
        for placed, placements in (place_on_body(p, body) for p in (pattern, divided))
        for cloth in [mesh(placed, vertices=FEW)]
    )
    apart = max(float(KDTree(a).query(b)[0].max()) for a, b in ((before, after), (after, before)))
    assert apart < NEAR_CM


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
    placed = place_on_body(skirt, body)[0]
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
    placed, placements = place_on_body(both, body)
    cloth = mesh(placed, vertices=FEW)
    start = start_points(cloth, body, placements)
    over, under = (
        garment_items(cloth, start, body, placements, tucked=tucked) for tucked in (False, True)
    )
    assert [len(i.pinned) > 0 for i in over] == [True, False]
    assert [len(i.pinned) > 0 for i in under] == [False, True]
    band = start[over[0].pinned]
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
        cloth = mesh(place_on_body(pattern, body)[0], vertices=FEW)
        corners = start_points(cloth, body)[cloth.vertex]
        names = [p.name for p in cloth.pattern.panels]
        sleeve = [n for n in names if n.startswith("left_sleeve")]
        own = np.isin(cloth.panel, [names.index(n) for n in sleeve])
        starts.append((corners[own].min(axis=0), corners[own].max(axis=0)))
    np.testing.assert_allclose(starts[0], starts[1], atol=1.0)
    assert limbs_inside(beside, body) >= {"left arm", "right arm"}


def wide_front() -> Pattern:
    """A tee with the wide half of a jacket's front on its left, which no back belongs to."""
    tee = draft_pattern("tee")
    corners = ((0.0, 0.0), (40.0, 0.0), (40.0, 50.0), (0.0, 50.0))
    square = Loop(corners, tuple(Edge(k, (k + 1) % 4) for k in range(4)))
    front = Panel("wide_front", square, translation=(6.0, 85.0, 16.0))
    stitch = Stitch(Side("wide_front", 0), Side("front", 5))
    return replace(tee, panels=(*tee.panels, front), stitches=(*tee.stitches, stitch))


def test_the_wide_half_of_a_front_is_not_a_sleeve():
    body = load_body("mean-female")
    assert limbs_inside(wide_front(), body) >= {"left arm", "right arm"}
    cloth = mesh(place_on_body(wide_front(), body)[0], vertices=FEW)
    panels = cloth.pattern.panels
    k = next(k for k, p in enumerate(panels) if p.name == "wide_front")
    free = (cloth.panel == k) & (np.bincount(cloth.vertex)[cloth.vertex] == 1)
    places = panels[k].to_world(cloth.flat[free])
    np.testing.assert_allclose(start_points(cloth, body)[cloth.vertex[free]], places)


def collared() -> Pattern:
    """A tee with a stand-up collar of four level strips."""
    tee = draft_pattern("tee")
    strips, stitches = [], []
    for name, edge, z in (
        ("front", 0, 14.0),
        ("front", 10, 14.0),
        ("back", 0, -14.0),
        ("back", 10, -14.0),
    ):
        panel = tee.by_name[name]
        middle = panel.to_world(panel.curves[edge].sample(2))[1, 0]
        long = float(np.sign(middle)) * panel.curves[edge].length
        corners = ((0.0, 0.0), (long, 0.0), (long, 3.0), (0.0, 3.0))
        outline = Loop(corners, tuple(Edge(k, (k + 1) % 4) for k in range(4)))
        strip = Panel(f"collar_{name}_{edge}", outline, translation=(0.0, 147.0, z))
        strips.append(strip)
        stitches.append(Stitch(Side(strip.name, 0), Side(name, edge), edge == 0))
    for a, b in ((0, 1), (2, 3)):
        stitches.append(Stitch(Side(strips[a].name, 3), Side(strips[b].name, 3), True))
    return replace(tee, panels=(*tee.panels, *strips), stitches=(*tee.stitches, *stitches))


def test_a_collar_begins_as_a_ring_round_the_neck():
    body = load_body("mean-female")
    cloth = mesh(place_on_body(collared(), body)[0], vertices=FEW)
    start = start_points(cloth, body)
    uppers = [
        line for side, line in cloth.sides.items() if "collar" in side.panel and side.edge == 2
    ]
    ring = start[cloth.vertex[np.concatenate([line[1:-1] for line in uppers])]]
    out = np.hypot(ring[:, 0], ring[:, 2] - body.landmarks["neck_joint"][2])
    assert np.ptp(out) < 1.0
    assert body_field(body).at(ring).min() > 0
    assert ring[:, 2].min() < body.landmarks["cervical"][2] and ring[:, 2].max() > 5.0


def circle_skirt(half: float) -> Pattern:
    """A skirt of two round halves, each cut out to an angle on either side of straight down."""
    skirt = draft_pattern("skirt")
    bands = tuple(p for p in skirt.panels if "waistband" in p.name)
    radius = bands[0].curves[0].length / (2 * half)
    ends = [(r * np.sin(a), -r * np.cos(a)) for r in (radius, radius + 40) for a in (-half, half)]
    large = bool(half > np.pi / 2)
    edges = (
        Edge(0, 1, Circle(radius, large, True)),
        Edge(1, 3),
        Edge(3, 2, Circle(radius + 40, large, False)),
        Edge(2, 0),
    )
    outline = Loop(tuple((float(x), float(y)) for x, y in ends), edges)
    halves = tuple(
        Panel(f"half_{side}", outline, translation=(0.0, 104.0 + radius, z))
        for side, z in (("front", 14.0), ("back", -14.0))
    )
    stitches = (
        Stitch(Side("half_front", 1), Side("half_back", 1), True),
        Stitch(Side("half_front", 3), Side("half_back", 3), True),
        Stitch(Side("half_front", 0), Side("waistband_front", 0), True),
        Stitch(Side("half_back", 0), Side("waistband_back", 0), False),
    )
    band = tuple(s for s in skirt.stitches if "skirt" not in s.a.panel + s.b.panel)
    return Pattern((*bands, *halves), (*stitches, *band))


@pytest.mark.parametrize("degrees", [100, 135, 170])
def test_circle_skirts_begin_round_the_body_and_are_worn_without_fault(degrees):
    body = load_body("mean-female")
    pattern = circle_skirt(np.deg2rad(degrees))
    cloth = mesh(place_on_body(pattern, body)[0], vertices=FEW)
    start = start_points(cloth, body)
    skirt = np.unique(cloth.vertex[cloth.panel >= 2])
    sides = np.abs(start[skirt, 2]) < 1.0
    assert body_field(body).at(start[skirt]).min() > 0
    assert np.abs(start[skirt][sides, 0]).min() > 10
    check_drape(drape_pattern(pattern, body))


@pytest.mark.parametrize("kind", ["pants", "skirt"])
def test_hems_begin_over_the_feet(kind):
    body = load_body("short-round-female")
    pattern = draft_pattern(kind, "tall-slim-male")
    panels = tuple(
        replace(p, outline=stretched(p.outline, 1.5)) if "band" not in p.name else p
        for p in pattern.panels
    )
    cloth = mesh(place_on_body(replace(pattern, panels=panels), body)[0], vertices=FEW)
    assert start_points(cloth, body)[:, 1].min() > body.landmarks["left_ankle_joint"][1]


def stretched(loop: Loop, factor: float) -> Loop:
    return replace(loop, vertices=tuple((x, y * factor) for x, y in loop.vertices))


@pytest.mark.corpus
def test_most_patterns_by_others_are_worn_without_fault():
    faults = {}
    sample = corpus_sample(60)
    for path in sample:
        try:
            faults[path.stem] = drape_pattern(read_pattern(path)[0], "slim-female").report.faults
        except GarmentImageError as error:
            faults[path.stem] = (str(error),)
    bad = {name: found for name, found in faults.items() if found}
    assert len(bad) <= len(sample) // 8, bad
