"""Which girths of a garment a body has room in, and which shipped body a garment fits."""

from dataclasses import replace

import numpy as np
import pytest

import garmentimage as gi
from garmentimage.body.body import load_body
from garmentimage.body.body_measurements import measurements, presets
from garmentimage.body.stance import stand_straight
from garmentimage.draft.sampling import sample
from garmentimage.drape import fit
from garmentimage.drape.fit import AUTO, ORDER, best_fit, girths, tapes
from garmentimage.drape.mesh.meshing import mesh
from garmentimage.drape.start.placement import place_on_body
from garmentimage.drape.support import SupportSite
from garmentimage.pattern.model import Edge, Loop, Panel, Pattern, Side, Stitch


def test_every_shipped_body_is_tried():
    assert sorted(ORDER) == sorted(presets())


@pytest.mark.parametrize("name", ORDER)
def test_tapes_agree_with_the_measurements(name):
    found, known = tapes(stand_straight(load_body(name))), measurements(name)
    assert found["waist"].girth == pytest.approx(known.waist_girth, abs=1)
    assert found["chest"].girth == pytest.approx(known.bust_girth, abs=5)
    assert found["upper arm"].girth == pytest.approx(known.upper_arm_girth, abs=0.5)
    assert found["knee"].girth == pytest.approx(known.knee_girth, abs=1.5)


@pytest.mark.parametrize("width", [60.0, 75.0])
def test_the_girth_of_a_tube_is_that_of_its_panels(width):
    cloth = mesh(tube(width))
    corners = np.empty((len(cloth.flat), 3))
    for k, panel in enumerate(cloth.pattern.panels):
        corners[cloth.panel == k] = panel.to_world(cloth.flat[cloth.panel == k])
    found = {g.place: g for g in girths(cloth, cloth.sewn(corners), load_body())}
    assert found["hip"].cloth == pytest.approx(2 * width, rel=1e-3)
    assert found["hip"].missing < 0
    assert "upper arm" not in found


def test_a_garment_of_which_no_width_is_known_at_the_chest_fits_by_its_girths(monkeypatch):
    """Once, dividing by its girth of 0 ended the drape of a tee with one panel inside out."""

    def nowhere(pattern, body, **options):
        placed, placements = place_on_body(pattern, body, **options)
        held = {"site": SupportSite.CHEST, "length": 0.0, "girth": 0.0}
        return placed, tuple(replace(each, **held) for each in placements)

    monkeypatch.setattr(fit, "place_on_body", nowhere)
    assert best_fit([tube(75.0)]).body in ORDER


def tube(width):
    """A skirt of two rectangles, its waist at 104 cm."""
    corners = ((-width / 2, 0.0), (width / 2, 0.0), (width / 2, 50.0), (-width / 2, 50.0))
    panels = tuple(
        Panel(
            name,
            Loop(corners, tuple(Edge(k, (k + 1) % 4) for k in range(4))),
            translation=(0.0, 54.0, z),
            rotation=turn,
        )
        for name, z, turn in (("front", 20.0, (0.0, 0.0, 0.0)), ("back", -20.0, (0.0, 180.0, 0.0)))
    )
    sides = (Stitch(Side("front", 1), Side("back", 3)), Stitch(Side("front", 3), Side("back", 1)))
    return Pattern(panels, sides, "tube")


@pytest.mark.parametrize("name", ["mean-female", "slim-female", "short-round-female"])
def test_trousers_go_to_the_body_they_were_drafted_for(name):
    pattern = next(iter(sample("pants", 1, 0, body=name))).pattern
    assert best_fit([pattern]).body == name


def test_a_jacket_that_is_open_in_front_fits_the_first_body():
    assert best_fit([next(iter(sample("jacket", 1, 0))).pattern]).body == ORDER[0]


def test_auto_picks_the_slim_body_for_a_narrow_waist():
    pattern = next(iter(sample("pants", 1, 0, body="slim-female"))).pattern
    assert gi.drape_pattern(pattern, AUTO).body.name == "slim-female"


def test_too_tight_names_the_girth_and_a_body_that_would_do():
    pattern = next(iter(sample("pants", 1, 1, body="slim-female"))).pattern
    worn = gi.drape_pattern(pattern, "short-round-male")
    fault = next(f for f in worn.report.faults if "too tight" in f)
    assert "waist" in fault and "cm of cloth on 98.9" in fault
    assert "take the body slim-female, on which it fits" in fault
    assert not gi.drape_pattern(pattern, "slim-female").report.faults
