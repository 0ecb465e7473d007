"""Seams: runs of stitches, and the stubs that belong to none."""

from dataclasses import replace

import pytest

from garmentimage.draft.kind import draft_pattern
from garmentimage.pattern.checks.sewable import check_pattern
from garmentimage.pattern.model import Side
from garmentimage.pattern.seam_runs import STUB_CM, sewn_runs, stubs
from tests.strangers import doubled, recut, traced


def test_an_ordinary_garment_has_no_stub():
    assert not stubs(draft_pattern("tee"))


@pytest.mark.parametrize("edge", range(4))
def test_a_stub_is_neither_run_nor_gap(edge):
    skirt = draft_pattern("skirt")
    name = skirt.panels[0].name
    changed = doubled(skirt, Side(name, edge), STUB_CM / 2)
    assert stubs(changed) == {Side(name, edge)}
    before, after = sewn_runs(skirt), sewn_runs(changed)
    assert [(r.panel, r.gap_after, r.closed) for r in before] == [
        (r.panel, r.gap_after, r.closed) for r in after
    ]
    assert all(Side(name, edge) not in run.sides for run in after)


def test_an_edge_of_two_millimetres_and_more_is_meant():
    skirt = draft_pattern("skirt")
    assert not stubs(doubled(skirt, Side(skirt.panels[0].name, 0), 1.01 * STUB_CM))


def test_short_edges_that_make_a_long_seam_are_no_stubs():
    assert not stubs(traced(draft_pattern("tee"), STUB_CM / 2))


def test_a_short_edge_that_is_sewn_to_a_long_one_is_no_stub():
    skirt = draft_pattern("skirt")
    stitch = skirt.stitches[0]

    def cut(side, curve):
        if side not in stitch.sides:
            return [(curve, True)]
        size = STUB_CM / 2 if side == stitch.a else 3.0
        at = size / curve.length
        if side == stitch.b and not stitch.same_direction:
            at = 1 - at
        return [(part, True) for part in curve.split(curve.parameter(at))]

    assert not stubs(recut(skirt, cut))


def test_a_panel_of_short_edges_alone_keeps_them():
    skirt = draft_pattern("skirt")
    panel = skirt.panels[0]
    loop = panel.outline
    small = tuple((x * 1e-3, y * 1e-3) for x, y in loop.vertices)
    speck = replace(panel, name="speck", outline=replace(loop, vertices=small))
    assert not stubs(replace(skirt, panels=(*skirt.panels, speck)))


def test_check_names_a_stub():
    skirt = draft_pattern("skirt")
    name = skirt.panels[0].name
    (finding,) = check_pattern(doubled(skirt, Side(name, 1), 0.001))
    assert "edge 1 is shorter than" in str(finding) and name in str(finding)
