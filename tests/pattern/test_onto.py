"""Panels sewn onto the cloth of others: files, checks, and what carries them along."""

import json
from dataclasses import replace

import numpy as np
import pytest

from garmentimage import PatternError, PatternFileError, StitchError, draft_pattern
from garmentimage.pattern import SewnOnto, turned_round, without_stubs
from garmentimage.pattern.checks import check_pattern
from garmentimage.pattern.files import load_pattern, save_pattern
from garmentimage.pattern.files.spec_reader import read_spec
from garmentimage.pattern.files.spec_writer import pattern_to_spec
from tests.pockets import with_pocket


@pytest.fixture(scope="module")
def tee():
    return draft_pattern("tee")


@pytest.fixture(scope="module")
def shirt(tee):
    return with_pocket(tee, "front", (9.0, 6.0), angle=10.0)


def test_files_keep_what_is_sewn_on_and_are_of_schema_2(shirt, tmp_path):
    path = tmp_path / "shirt.json"
    save_pattern(shirt, path)
    assert json.loads(path.read_text())["garmentimage"]["schema"] == 2
    assert load_pattern(path).onto == shirt.onto


def test_files_without_it_stay_of_schema_1(tee):
    raised = replace(tee, panels=tuple(replace(p, cloth_layer=1) for p in tee.panels))
    assert pattern_to_spec(raised)["garmentimage"]["schema"] == 1


def test_units_and_moved_panels_are_converted(shirt):
    """In metres, and with every panel about the mean of its vertices, as one reader has them."""
    data = pattern_to_spec(shirt)
    data["properties"] |= {"units_in_meter": 1, "normalize_panel_translation": True}
    for panel in data["pattern"]["panels"].values():
        panel["vertices"] = (np.array(panel["vertices"]) / 100).tolist()
        panel["translation"] = (np.array(panel["translation"]) / 100).tolist()
    sewn = data["garmentimage"]["onto"][0]
    sewn["offset"] = (np.array(sewn["offset"]) / 100).tolist()
    found, _ = read_spec(data)
    corners = {}
    for pattern in (shirt, found):
        base = pattern.by_name["front"].outline.vertices
        own = pattern.by_name["pocket"].outline.vertices
        corners[pattern.name] = pattern.onto[0].carried(np.array(own)) - np.mean(base, axis=0)
    np.testing.assert_allclose(corners[shirt.name], corners[found.name], atol=1e-9)


def test_edges_keep_their_meaning_when_a_panel_is_turned_round(shirt):
    turned = turned_round(shirt, ["pocket"])
    lengths = [
        sorted(round(p.curve(side).length, 6) for side in p.onto[0].sides) for p in (shirt, turned)
    ]
    ends = [
        sorted(tuple(np.round(p.curve(side).sample(2)[1], 6)) for side in p.onto[0].sides)
        for p in (shirt, turned)
    ]
    assert lengths[0] == lengths[1] and ends[0] == ends[1]
    assert turned.onto[0].edges != shirt.onto[0].edges


def test_stubs_are_dissolved_beside_it(shirt):
    assert without_stubs(shirt) == shirt


@pytest.mark.parametrize(
    "change, sentence",
    [
        ({"on": "nowhere"}, "there is no panel 'nowhere'"),
        ({"panel": "nowhere"}, "there is no panel 'nowhere'"),
        ({"on": "pocket"}, "can be sewn onto one other panel"),
        ({"edges": ()}, "name edges of its outline, 0 to 3"),
        ({"edges": (0, 9)}, "name edges of its outline, 0 to 3"),
        ({"edges": (1, 0)}, "once each and in order"),
        ({"matrix": ((2.0, 0.0), (0.0, 1.0))}, "not a rigid motion"),
        ({"offset": (float("nan"), 0.0)}, "not a rigid motion"),
    ],
)
def test_what_cannot_be_sewn_on_is_refused_by_name(shirt, change, sentence):
    broken = replace(shirt, onto=(replace(shirt.onto[0], **change),))
    with pytest.raises(StitchError, match=sentence):
        check_pattern(broken)


def test_an_edge_cannot_be_stitched_and_sewn_on(shirt):
    side = shirt.stitches[0].a
    both = SewnOnto(side.panel, (side.edge,), "pocket", ((1.0, 0.0), (0.0, 1.0)), (0.0, 0.0))
    with pytest.raises(StitchError, match=f"edge {side.edge} is also stitched"):
        check_pattern(replace(shirt, onto=(both,)))


def test_a_pocket_beside_the_cloth_is_found(tee):
    beside = with_pocket(tee, "front", (26.0, 6.0))
    assert any("partly beyond its cloth" in str(f) for f in check_pattern(beside))
    assert not any("beyond" in str(f) for f in check_pattern(with_pocket(tee, "front", (8.0, 6.0))))


def test_a_pocket_is_not_a_loose_panel(shirt):
    assert not any("sewn to no other panel" in str(finding) for finding in check_pattern(shirt))


@pytest.mark.parametrize(
    "onto, error",
    [
        ("pocket", PatternFileError),
        ([{"panel": "pocket"}], PatternFileError),
        ([7], PatternFileError),
        ([{"panel": "pocket", "on": "front", "edges": [0], "matrix": [[1, 0]], "offset": [0, 0]}],
         PatternError),
        ([{"panel": "pocket", "on": "front", "edges": [99], "matrix": [[1, 0], [0, 1]],
           "offset": [0, 0]}], StitchError),
        ([{"panel": "lost", "on": "front", "edges": [0], "matrix": [[1, 0], [0, 1]],
           "offset": [0, 0]}], StitchError),
    ],
)  # fmt: skip
def test_malformed_fields_are_errors(shirt, onto, error):
    data = pattern_to_spec(shirt)
    data["garmentimage"]["onto"] = onto
    with pytest.raises(error):
        read_spec(data)
