import numpy as np
import pytest
from hypothesis import given, strategies as st

from garmentimage.compare.comparison import compare_patterns
from garmentimage.compare.stitch_graphs import (
    match_graphs,
    same_stitch_graph,
    seam_agreement,
    stitch_graph,
)
from garmentimage.pattern.model import Pattern, Side, Stitch
from tests.compare.garments import (
    GARMENTS,
    collar,
    darted_skirt,
    patched_cloth,
    renamed_panels,
    reordered,
    sewn,
    shifted_loops,
    six_gores,
    sleeve_with_cuff,
    split_edges,
    swapped_partners,
    transformed_panel,
    turned_stitch,
    without_stitch,
)

garments = st.sampled_from(GARMENTS).map(lambda draw: draw())


def differences(a, b):
    names = {p.name: p.name for p in a.panels}
    return same_stitch_graph(stitch_graph(a), stitch_graph(b), names)


@st.composite
def garments_and_cuts(draw):
    garment = draw(garments)
    sides = draw(st.lists(st.sampled_from(list(garment.sides())), unique=True, max_size=6))
    cuts = {}
    for side in sides:
        if garment.partners.get(side) not in cuts:
            cuts[side] = draw(st.floats(0.1, 0.9))
    return garment, cuts


@given(garments_and_cuts())
def test_a_garment_with_its_edges_cut_up_hangs_together_the_same(drawn):
    garment, cuts = drawn
    cut_up = split_edges(garment, cuts)
    assert differences(garment, cut_up) == []
    assert differences(cut_up, garment) == []


@given(garments, st.integers(0, 2**32 - 1), st.integers(0, 5))
def test_order_and_start_of_loops_say_nothing(garment, seed, shift):
    written_anew = shifted_loops(reordered(garment, np.random.default_rng(seed)), shift)
    assert differences(garment, written_anew) == []


@given(garments, st.data())
def test_a_dropped_stitch_is_noticed(garment, data):
    number = data.draw(st.integers(0, len(garment.stitches) - 1))
    assert differences(garment, without_stitch(garment, number))


@given(garments, st.data())
def test_a_turned_stitch_is_noticed(garment, data):
    number = data.draw(st.integers(0, len(garment.stitches) - 1))
    assert differences(garment, turned_stitch(garment, number))


def test_swapped_seams_are_noticed():
    assert differences(darted_skirt(), swapped_partners(darted_skirt(), 0, 2))
    assert differences(sleeve_with_cuff(), swapped_partners(sleeve_with_cuff(), 2, 3))


def test_a_dart_closed_otherwise_is_noticed():
    skirt = darted_skirt()
    other = Pattern(
        skirt.panels,
        sewn(
            (("front", 0), ("back", 3)),
            (("front", 8), ("back", 1)),
            (("front", 3), ("front", 4)),
            (("front", 5), ("front", 6)),
        ),
    )
    assert differences(skirt, other)


def test_darts_are_told_from_seams_of_a_panel_with_itself():
    graph = stitch_graph(darted_skirt())
    assert sum(graph.is_dart(a) for a, _ in graph.seams) == 2
    graph = stitch_graph(sleeve_with_cuff())
    assert not any(graph.is_dart(a) for a, _ in graph.seams)


def test_a_dart_with_cut_legs_is_one_dart():
    cut = split_edges(darted_skirt(), {Side("front", 2): 0.3})
    assert len(cut.stitches) == 5
    graph = stitch_graph(cut)
    legs = [graph.sides[k] for k in range(len(graph.sides)) if graph.is_dart(k)]
    assert sorted(len(leg.edges) for leg in legs) == [1, 1, 2, 2]


def test_a_patch_is_sewn_in_by_one_closed_seam():
    graph = stitch_graph(patched_cloth())
    assert len(graph.seams) == 1
    assert all(side.closed for side in graph.sides)
    assert {side.length for side in graph.sides} == {80.0}


def test_an_eye_dart_in_a_hole_is_one_seam():
    cloth = patched_cloth().panels[0]
    eye = Pattern((cloth,), sewn((("cloth", 4), ("cloth", 7)), (("cloth", 5), ("cloth", 6))))
    graph = stitch_graph(eye)
    assert [side.edges for side in graph.sides] == [(4, 5), (6, 7)]
    assert graph.is_dart(0)


def test_stitches_start_to_start_merge_into_one_seam():
    cut = split_edges(collar(), {Side("body", 3): 0.25})
    graph = stitch_graph(cut)
    assert [len(side.edges) for side in graph.sides] == [2, 2]


def test_a_gap_between_two_seams_counts_and_its_edges_do_not():
    skirt = darted_skirt()
    closed = Pattern(skirt.panels, (*skirt.stitches, Stitch(Side("front", 4), Side("back", 2))))
    assert differences(skirt, closed)
    assert differences(skirt, split_edges(skirt, {Side("front", 4): 0.5})) == []


def test_seams_must_agree_in_length():
    skirt = darted_skirt()
    shorter = transformed_panel(skirt, "back", [[1, 0], [0, 0.95]])
    reasons = differences(skirt, shorter)
    assert reasons and all("sewn over" in reason for reason in reasons)
    assert differences(skirt, transformed_panel(skirt, "back", [[1, 0], [0, 0.985]])) == []


def test_two_darts_in_the_other_order_are_noticed():
    reasons = differences(darted_skirt(), darted_skirt(depths=(14, 10)))
    assert len(reasons) == 4 and all("sewn over" in reason for reason in reasons)


def test_a_panel_turned_inside_out_is_noticed():
    mirror = [[-1, 0], [0, 1]]
    reasons = differences(darted_skirt(), transformed_panel(darted_skirt(), "back", mirror))
    assert reasons == ["panel 'back' is inside out"]


def test_a_panel_sewn_in_upside_down_is_noticed():
    upside_down = swapped_partners(darted_skirt(), 0, 1)
    assert differences(darted_skirt(), upside_down) == ["seams lie at other places of their panels"]


def test_panels_without_counterpart_are_named():
    skirt = darted_skirt()
    assert same_stitch_graph(stitch_graph(skirt), stitch_graph(skirt), {"front": "front"}) == [
        "panel 'back' has no counterpart",
        "panel 'back' is extra",
    ]


@pytest.mark.slow
@given(st.permutations(range(6)))
def test_equal_gores_may_be_any_of_each_other(order):
    garment = six_gores()
    others = {f"gore_{k}": f"piece_{order[k]}" for k in range(6)}
    again = renamed_panels(garment, others.get)
    every = sorted(others.values())
    match = match_graphs(
        stitch_graph(garment), stitch_graph(again), {p.name: every for p in garment.panels}
    )
    assert match is not None
    assert same_stitch_graph(stitch_graph(garment), stitch_graph(again), match.panels) == []
    assert compare_patterns(garment, again).success


def test_loose_panels_find_the_candidate_that_is_left():
    panels = six_gores().panels[:3]
    loose = stitch_graph(Pattern(panels))
    candidates = {
        "gore_0": ["gore_1", "gore_0"],
        "gore_1": ["gore_1"],
        "gore_2": ["gore_0", "gore_2"],
    }
    match = match_graphs(loose, loose, candidates)
    assert match is not None
    assert match.panels == {"gore_0": "gore_0", "gore_1": "gore_1", "gore_2": "gore_2"}
    assert match_graphs(loose, loose, {name: ["gore_1"] for name in candidates}) is None


def test_seam_agreement_is_the_share_of_seams_found():
    skirt = darted_skirt()
    names = {p.name: p.name for p in skirt.panels}
    graph = stitch_graph(skirt)
    assert seam_agreement(graph, graph, names) == 1.0
    assert seam_agreement(graph, stitch_graph(without_stitch(skirt, 2)), names) == 0.75
    assert seam_agreement(graph, stitch_graph(Pattern(skirt.panels)), names) == 0.0


@pytest.mark.parametrize("draw", GARMENTS)
def test_many_separate_copies_are_matched_in_bounded_time(draw):
    one = draw()
    copies = [renamed_panels(one, lambda n, k=k: f"{n}_{k}") for k in range(8)]
    many = Pattern(
        tuple(p for c in copies for p in c.panels), tuple(s for c in copies for s in c.stitches)
    )
    backwards = Pattern(many.panels[::-1], many.stitches[::-1])
    assert compare_patterns(many, backwards).success
