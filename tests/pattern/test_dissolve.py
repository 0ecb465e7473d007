"""Stubs dissolved: what lies beside them meets, and the garment is what it was without them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from garmentimage.compare.comparison import compare_patterns
from garmentimage.draft.kind import draft_pattern
from garmentimage.drape.draping import drape_pattern
from garmentimage.pattern.dissolve import without_stubs
from garmentimage.pattern.model import Notch, Side
from garmentimage.pattern.seam_runs import STUB_CM, stubs
from tests.garments import garments
from tests.strangers import doubled


def test_a_garment_without_stubs_is_given_back():
    tee = draft_pattern("tee")
    assert without_stubs(tee) is tee


@given(garments(), st.data())
def test_without_its_stubs_a_garment_is_what_it_was(garment, data):
    corner = data.draw(st.sampled_from(list(garment.sides())))
    changed = doubled(garment, corner, data.draw(st.floats(1e-5, 0.9 * STUB_CM)))
    back = without_stubs(changed)
    assert not stubs(back)
    assert [len(p.edges) for p in back.panels] == [len(p.edges) for p in garment.panels]
    assert back.stitches == garment.stitches
    assert compare_patterns(garment, back).success


def test_notches_stay_on_their_edges():
    skirt = draft_pattern("skirt")
    name = skirt.panels[0].name
    changed = doubled(skirt, Side(name, 1), STUB_CM / 2)
    panel = replace(changed.panels[0], notches=(Notch(1, 0.5), Notch(2, 0.25)))
    back = without_stubs(replace(changed, panels=(panel, *changed.panels[1:])))
    assert back.panels[0].notches == (Notch(1, 0.25),)


@pytest.mark.parametrize("kind", ["skirt", "tee", "pants"])
def test_a_doubled_corner_does_not_change_how_a_garment_hangs(kind):
    garment = draft_pattern(kind)
    plain = drape_pattern(garment)
    for corner in list(garment.sides())[::5]:
        worn = drape_pattern(doubled(garment, corner, 1e-3))
        assert worn.report.faults == plain.report.faults == ()
        assert np.linalg.norm(worn.points.mean(axis=0) - plain.points.mean(axis=0)) < 0.5
