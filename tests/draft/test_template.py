import json
import warnings
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

from garmentimage.draft.templates.parameter import ParameterType
from garmentimage.draft.templates.template import Template
from garmentimage.errors import PatternError, PatternFileError, PatternWarning
from garmentimage.pattern.files.spec import load_pattern, read_pattern, save_pattern
from garmentimage.pattern.model import Quadratic
from tests.corpus import corpus_files, sample

SKIRT = Path(__file__).parent / "templates" / "flared_skirt.json"
AGREEMENT_CM = 0.01
"""How near to published samples ours must lie; measured: 0.0003."""
FILES_COMPARED = 100

seeds = st.integers(0, 2**32 - 1)


@cache
def skirt():
    return Template.read(SKIRT)


def skirt_data():
    return json.loads(SKIRT.read_text(encoding="utf-8"))


def written(folder, data):
    path = folder / "template.json"
    path.write_text(json.dumps(data), encoding="utf-8")
    return path


def drawn(template, seed):
    return template.with_values(template.draw(np.random.default_rng(seed)))


def controls(panel):
    """Control point of each curved edge [cm], by the edge's ends."""
    return {
        (e.start, e.end): c.controls[0]
        for e, c in zip(panel.outline.edges, panel.outline.curves, strict=True)
        if isinstance(e.curvature, Quadratic)
    }


def gap(a, b):
    """Largest distance between what two patterns hold, each panel with its namesake [cm]."""
    assert {p.name for p in a.panels} == {p.name for p in b.panels}
    gaps = []
    for p in a.panels:
        q = b.by_name[p.name]
        ends, others = controls(p), controls(q)
        assert ends.keys() == others.keys()
        gaps += [
            np.subtract(p.outline.vertices, q.outline.vertices),
            [np.subtract(ends[k], others[k]) for k in ends],
            np.subtract(p.translation, q.translation),
            # A rotation of 1 degree moves the end of a 60 cm panel by a centimetre.
            60 * (p.matrix - q.matrix),
        ]
    return max(float(np.abs(g).max(initial=0.0)) for g in map(np.asarray, gaps))


def seams(pattern):
    """Sewn pairs of edges, each edge by its panel and vertices."""

    def ends(side):
        edge = pattern.by_name[side.panel].edges[side.edge]
        return side.panel, edge.start, edge.end

    return {frozenset(map(ends, stitch.sides)) for stitch in pattern.stitches}


def test_a_template_tells_its_parameters_in_their_order():
    found = skirt().parameters
    assert list(found) == ["waist", "length", "flare", "band_width", "front_hem", "back_hem"]
    assert found["length"].type is ParameterType.ADDITIVE_LENGTH
    assert found["length"].ranges == ((-12, 28),)
    assert found["front_hem"].ranges == ((0.6, 1.4), (-2, 4))
    assert [p.default for p in found.values()] == [1, 0, 1, 1, (1, 1), 1]


def test_defaults_change_nothing_but_what_constraints_ask_for():
    plain = skirt().with_values({})
    for name in ("band_front", "band_back"):
        assert plain.by_name[name].outline == skirt().pattern.by_name[name].outline
    before, after = (p.by_name["front"].curves[1].length for p in (skirt().pattern, plain))
    assert 0 < after - before < 2


def test_values_do_what_their_names_say():
    pattern = skirt().with_values({"waist": 1.1, "band_width": 1.5, "front_hem": (1.2, 2.0)})
    band = pattern.by_name["band_front"]
    assert np.ptp(band.outline.vertices, axis=0) == pytest.approx([1.1 * 38, 1.5 * 4])
    assert pattern.by_name["front"].edges[0].curvature.control == pytest.approx((0.6, -0.08))


@given(seeds)
def test_every_draw_sews_equal_side_seams(seed):
    pattern = drawn(skirt(), seed)
    lengths = [
        pattern.by_name[name].curves[edge].length for name in ("front", "back") for edge in (1, 3)
    ]
    assert lengths == pytest.approx([lengths[0]] * 4)


@given(seeds)
def test_drawn_values_lie_in_their_ranges_and_not_at_zero(seed):
    for name, value in skirt().draw(np.random.default_rng(seed)).items():
        numbers = value if isinstance(value, tuple) else (value,)
        for number, (low, high) in zip(numbers, skirt().parameters[name].ranges, strict=True):
            assert low <= number <= high
            assert abs(number) >= 0.01


def test_draws_reach_both_ends_of_every_range():
    rng = np.random.default_rng(1)
    draws = [skirt().draw(rng) for _ in range(200)]
    for name, parameter in skirt().parameters.items():
        values = np.array([draw[name] for draw in draws]).reshape(len(draws), -1)
        low, high = np.transpose(parameter.ranges)
        assert (values.min(axis=0) < low + 0.05 * (high - low)).all()
        assert (values.max(axis=0) > high - 0.05 * (high - low)).all()


def test_a_seed_gives_the_same_values_for_ever():
    values = skirt().draw(np.random.default_rng(7))
    assert values["waist"] == pytest.approx(1.0687834133116334, abs=1e-12)
    assert values["back_hem"] == pytest.approx(-1.9684081726065517, abs=1e-12)


@given(seeds)
def test_a_drawn_pattern_is_its_template_again(tmp_path_factory, seed):
    path = tmp_path_factory.mktemp("drawn") / "skirt.json"
    values = skirt().draw(np.random.default_rng(seed))
    pattern = skirt().with_values(values)
    save_pattern(pattern, path)
    assert load_pattern(path) == pattern
    again = Template.read(path)
    assert gap(again.pattern, skirt().pattern) < 1e-9
    assert gap(again.with_values(values), pattern) < 1e-9


def test_a_drawn_pattern_holds_its_values():
    fields = skirt().with_values({"flare": 1.25}).extra["top"]
    assert fields["parameters"]["flare"]["value"] == 1.25
    assert fields["parameters"]["waist"]["value"] == 1
    runs = [e for i in fields["constraints"]["side_seams"]["influence"] for e in i["edge_list"]]
    assert len(runs) == 4 and all(0.9 < e["value"] < 1.1 and e["value"] != 1 for e in runs)


@pytest.mark.parametrize("units", [300, 1000])
def test_units_of_the_file_do_not_matter(tmp_path, units):
    data, scale = skirt_data(), units / 100
    for panel in data["pattern"]["panels"].values():
        panel["translation"] = [scale * v for v in panel["translation"]]
        panel["vertices"] = [[scale * x, scale * y] for x, y in panel["vertices"]]
    length = data["parameters"]["length"]
    length["range"] = [scale * v for v in length["range"]]
    data["properties"]["units_in_meter"] = units
    other = Template.read(written(tmp_path, data))
    assert other.parameters["length"].ranges[0] == pytest.approx((-12, 28))
    assert gap(drawn(other, 3), drawn(skirt(), 3)) < 1e-9


def test_clockwise_panels_are_seen_from_their_other_side_and_stay_in_place():
    back = skirt().pattern.by_name["back"]
    file = skirt_data()["pattern"]["panels"]["back"]
    assert back.outline.area > 0
    world = np.column_stack([file["vertices"], np.zeros(4)]) + file["translation"]
    assert back.to_world(np.array(back.outline.vertices)) == pytest.approx(world)
    middle = back.to_world(np.array([controls(back)[1, 0]]))[0]
    assert middle == pytest.approx([36 - 0.45 * 72, 102 - 57 - 0.04 * 72, -16])


def test_a_file_whose_loops_are_normalised_keeps_them(tmp_path):
    data = skirt_data()
    data["properties"]["normalized_edge_loops"] = True
    back = Template.read(written(tmp_path, data)).pattern.by_name["back"]
    assert back.outline.area < 0
    assert back.rotation == (0, 0, 0)


@pytest.mark.parametrize(
    ("across", "message"),
    [(-45, "'front', edges 0 and .* cross"), (-60, "'front': is turned inside out")],
)
def test_values_that_spoil_a_panel_are_refused(tmp_path, across, message):
    data = skirt_data()
    data["parameters"]["front_hem"]["range"] = [[0.6, 1.4], [-60, 4]]
    template = Template.read(written(tmp_path, data))
    with pytest.raises(PatternError, match=f"with these values .*{message}"):
        template.with_values({"front_hem": (1, across)})


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"flair": 1.2},
            r"'flair': there is none; did you mean 'flare'",
        ),
        ({"flare": 3}, r"'flare': is 3; give a number from 0\.75 to 1\.6, or 1 to change nothing"),
        ({"flare": float("nan")}, "'flare': must be a finite number"),
        ({"flare": "wide"}, "'flare': must be a number, not text"),
        ({"flare": (1.0, 1.0)}, "'flare': takes 1 number, not 2"),
        ({"front_hem": 1.0}, "'front_hem': takes 2 numbers, not 1"),
        ({"front_hem": (1.0, 9.0)}, r"'front_hem': is 9; give a number from -2 to 4"),
    ],
)
def test_bad_values_get_one_sentence(values, message):
    with pytest.raises(PatternError, match=message) as caught:
        skirt().with_values(values)
    assert "\n" not in str(caught.value)


def test_numbers_of_numpy_are_numbers():
    given = skirt().with_values({"flare": np.float32(1.25), "length": np.int64(4)})
    assert given == skirt().with_values({"flare": 1.25, "length": 4})


def change(path, value):
    """A change of the skirt's file at a path of keys; the value `gone` removes the key."""

    def apply(data):
        *outer, last = path
        for key in outer:
            data = data[key]
        if value is gone:
            del data[last]
        else:
            data[last] = value

    return apply


gone = object()
FLARE = ("parameters", "flare")
FLARE_EDGE = (*FLARE, "influence", 0, "edge_list", 0)
LENGTH_EDGE = ("parameters", "length", "influence", 0, "edge_list", 0)
SEAMS = ("constraints", "side_seams")


@pytest.mark.parametrize(
    ("mutation", "message"),
    [
        (change(("parameters",), gone), "is a pattern without 'parameters'"),
        (change(("parameters",), {}), "is a pattern without 'parameters'"),
        (change(("parameters",), [1]), "parameters: must be an object, not a list"),
        (change(FLARE, 3), "'flare': must be an object, not a number"),
        (change(("parameter_order",), ["flare"]), "parameter_order: must name each of the 6"),
        (change(("parameter_order", 0), 5), "parameter_order: must name each"),
        (change(("parameter_order", 0), "flare"), "parameter_order: .* look at 'waist'"),
        (change((*FLARE, "type"), "width"), "'flare', type: is 'width'; use one of length, add"),
        (change((*FLARE, "type"), []), "'flare', type: is a list; use one of"),
        (change((*FLARE, "type"), gone), "'flare': 'type' is missing"),
        (change((*FLARE, "range"), gone), "'flare': 'range' is missing"),
        (change((*FLARE, "range"), [1]), "'flare', range: must be a list of 2 numbers"),
        (change((*FLARE, "range"), [2, 1]), "'flare', range: runs from 2 down to 1; swap them"),
        (change((*FLARE, "range"), [[0, 1], [0, 1]]), "'flare', range: must be a number"),
        (change(("parameters", "front_hem", "range"), [[0, 1]] * 3), "has 3 ranges; give one or"),
        (change((*FLARE, "value"), 0), "'flare': its value 0 cannot be undone"),
        (change((*FLARE, "value"), None), "'flare', value: must be a number, not null"),
        (change((*FLARE, "value"), [1, 1]), "'flare', value: takes 1 number, not 2"),
        (change((*FLARE, "influence", 0, "panel"), "Front"), "names panel 'Front', which does"),
        (change((*FLARE, "influence", 0, "panel"), ["front"]), "names panel a list"),
        (change((*FLARE_EDGE, "id"), 4), "'front', id: names edge 4; the panel has edges 0 to 3"),
        (change((*FLARE_EDGE, "id"), -1), "names edge -1"),
        (change((*FLARE_EDGE, "id"), []), "id: names no edge"),
        (change((*FLARE_EDGE, "id"), True), "id: must be a whole number"),
        (change(FLARE_EDGE, 0), "edge_list: must be an object, not a number"),
        (change((*FLARE_EDGE, "direction"), "up"), "direction: is 'up'; use one of start, end, b"),
        (change((*FLARE_EDGE, "direction"), gone), "'direction' is missing"),
        (change((*LENGTH_EDGE, "along"), [0, 0]), "along: has no direction"),
        (change((*LENGTH_EDGE, "along"), "up"), "along: must be a list of 2 numbers"),
        (
            change(("parameters", "back_hem", "influence", 0, "edge_list", 0), 1),
            "edge 1 is not a q",
        ),
        (change((*SEAMS, "type"), "area"), "'side_seams', type: is 'area'; use 'length_equality'"),
        (change((*SEAMS, "influence"), []), "'side_seams', influence: names no edges"),
        (
            change((*SEAMS, "influence", 0, "edge_list", 0, "value"), 0),
            "is 0, which cannot be undone",
        ),
        (change((*FLARE, "value"), 1e-9), r"undone, .*\(are these the values"),
        (change(("pattern", "panels", "front", "vertices"), [[0, 0]]), "joins vertex 1, but the"),
    ],
)
def test_bad_templates_get_one_sentence_that_names_the_file(tmp_path, mutation, message):
    data = skirt_data()
    mutation(data)
    path = written(tmp_path, data)
    with pytest.raises(PatternError, match=message) as caught:
        Template.read(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_edges_must_stand_in_the_order_of_their_loop(tmp_path):
    data = skirt_data()
    edges = data["pattern"]["panels"]["front"]["edges"]
    edges[0], edges[1] = edges[1], edges[0]
    with pytest.raises(PatternError, match="'front', edge 0: does not start where the edge before"):
        Template.read(written(tmp_path, data))


@pytest.mark.parametrize(
    ("text", "message"),
    [("", "is empty"), ("{", "is not JSON"), ("9" * 5000, "thousands of digits")],
)
def test_files_that_are_no_json_are_refused(tmp_path, text, message):
    path = tmp_path / "template.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(PatternFileError, match=message):
        Template.read(path)
    with pytest.raises(PatternFileError, match="there is no such file"):
        Template.read(tmp_path / "other.json")


def test_oddities_of_the_pattern_are_told(tmp_path):
    data = skirt_data()
    del data["properties"]["units_in_meter"]
    with pytest.warns(PatternWarning, match="units_in_meter: is missing; cm are assumed"):
        Template.read(written(tmp_path, data))


def published_samples():
    """The samples that the test compares, each with the template that it was drawn from."""
    files = [path for path in corpus_files() if path.parent.parent.name == "gpg"]
    raw = files[0].parents[2] / "raw"
    templates = {p: raw / f"gpg_template_{p.parent.name}.json" for p in files}
    return templates, [p for p in files if templates[p].is_file()]


@pytest.mark.corpus
def test_published_samples_are_drawn_from_their_templates():
    templates, files = published_samples()
    read = cache(Template.read)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PatternWarning)
        for path in sample(files, FILES_COMPARED):
            theirs, _ = read_pattern(path)
            fields = theirs.extra["top"]["parameters"]
            ours = read(templates[path]).with_values({n: f["value"] for n, f in fields.items()})
            assert gap(ours, theirs) < AGREEMENT_CM, path.name
            assert seams(ours) == seams(theirs), path.name


@pytest.mark.corpus
def test_published_samples_are_templates_themselves():
    templates, _ = published_samples()
    first: dict[str, Template] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PatternWarning)
        for path in sample(list(templates), FILES_COMPARED):
            template = Template.read(path)
            kind = first.setdefault(path.parent.name, template)
            assert gap(template.pattern, kind.pattern) < AGREEMENT_CM, path.name
            assert template.parameters == kind.parameters
