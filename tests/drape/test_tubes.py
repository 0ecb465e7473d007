"""Panels sewn to themselves all round are worn round the body."""

from dataclasses import replace

import numpy as np
import pytest

from garmentimage.draft import draft_pattern
from garmentimage.drape import drape_pattern
from garmentimage.errors import DrapeError
from garmentimage.pattern import Pattern, Side
from tests.tubes import tube, under_a_top, with_band, with_whole_sleeves

FEW = 1200  # vertices


@pytest.mark.parametrize("behind", [False, True])
def test_a_tube_is_worn_with_its_seam_on_the_other_side(behind):
    worn = drape_pattern(with_band(tube(behind=behind)), vertices=FEW)
    assert worn.report.faults == ()
    cloth = worn.cloth
    depth = worn.points[cloth.vertex[cloth.panel == 0], 2]
    seam = worn.points[cloth.vertex[cloth.sides[Side("skirt", 1)]], 2]
    assert np.ptp(depth) > 15
    middle = (depth.min() + depth.max()) / 2
    assert (seam > middle).all() if behind else (seam < middle).all()


def test_a_tube_hangs_from_the_top_that_it_is_sewn_to():
    worn = drape_pattern(under_a_top(), vertices=FEW)
    assert worn.report.faults == () and worn.report.items == 1


@pytest.mark.parametrize("kind", ["tee", "jacket"])
def test_a_sleeve_of_one_panel_is_worn_round_the_arm(kind):
    worn = drape_pattern(with_whole_sleeves(draft_pattern(kind)), vertices=FEW)
    assert worn.report.faults == ()
    cloth = worn.cloth
    number = [panel.name for panel in cloth.pattern.panels].index("left_sleeve")
    (under,) = (
        s.a for s in cloth.pattern.stitches if {x.panel for x in s.sides} == {"left_sleeve"}
    )
    seam = worn.points[cloth.vertex[cloth.sides[under]], 1]
    assert seam.mean() < worn.points[cloth.vertex[cloth.panel == number], 1].mean()


def test_a_skirt_that_nothing_closes_round_the_body_is_refused():
    skirt = with_band(tube())
    panels = [
        replace(p, translation=(0.0, 45.0 + 55.0 * k, 20.0)) for k, p in enumerate(skirt.panels)
    ]
    open_skirt = Pattern(tuple(panels), skirt.stitches[1:2])
    with pytest.raises(DrapeError, match=r"'skirt' all lie in one plane.*sew .* to itself"):
        drape_pattern(open_skirt, vertices=FEW)
