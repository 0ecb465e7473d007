import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

from garmentimage.errors import (
    GarmentImageError,
    OutputError,
    PatternError,
    PatternFileError,
    PatternWarning,
    StitchError,
)
from garmentimage.pattern.files.spec import (
    load_pattern,
    pattern_from_spec,
    pattern_to_spec,
    read_pattern,
    read_spec,
    save_pattern,
)
from garmentimage.pattern.model import Circle, Cubic, Notch, Quadratic, Side, rotation_matrix
from tests.garments import garments
from tests.pattern.specs import edges, one_panel, panel, spec, stitch, written

json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=6,
)
unknown_fields = st.dictionaries(
    st.text(max_size=8).map(lambda key: f"x_{key}"), json_values, max_size=3
)


def through_json(pattern):
    return read_spec(json.loads(json.dumps(pattern_to_spec(pattern))))[0]


# Laws.


@given(garments())
def test_json_out_and_in_is_exact(garment):
    assert through_json(garment) == garment


@given(garments())
def test_a_pattern_of_ours_has_no_findings(garment):
    assert read_spec(pattern_to_spec(garment))[1] == ()


@given(garments(holes=False))
def test_a_plain_pattern_is_written_without_our_field(garment):
    assert set(pattern_to_spec(garment)) == {"pattern", "properties"}


@given(unknown_fields, unknown_fields, unknown_fields, unknown_fields, unknown_fields)
def test_unknown_fields_survive_at_every_level(top, body, in_panel, in_edge, in_side):
    data = spec(x_property=[1, 2])
    front = data["pattern"]["panels"]["front"]
    data.update(top)
    data["pattern"].update(body)
    front.update(in_panel)
    front["edges"][2].update(in_edge)
    data["pattern"]["stitches"][1][0].update(in_side)
    again = json.loads(json.dumps(pattern_to_spec(pattern_from_spec(data))))
    for place, fields in (
        (again, top),
        (again["pattern"], body),
        (again["pattern"]["panels"]["front"], in_panel),
        (again["pattern"]["panels"]["front"]["edges"][2], in_edge),
        (again["pattern"]["stitches"][1][0], in_side),
        (again["properties"], {"x_property": [1, 2]}),
    ):
        assert json.dumps({key: place[key] for key in fields}) == json.dumps(fields)


@given(json_values)
def test_any_json_gives_a_pattern_or_a_typed_error(data):
    with pytest.raises(GarmentImageError):
        read_spec(data)


@given(st.sampled_from(["panels", "stitches"]), json_values)
def test_any_damage_gives_a_pattern_or_a_typed_error(key, value):
    data = spec()
    data["pattern"][key] = value
    try:
        read_spec(data)
    except GarmentImageError as error:
        assert "\n" not in str(error)


@given(st.data())
def test_damage_inside_a_panel_gives_a_pattern_or_a_typed_error(data):
    given_spec = spec({"front": panel(e1=[0.5, 0.1]), "back": panel(z=-20)})
    front = given_spec["pattern"]["panels"]["front"]
    place, key = data.draw(
        st.sampled_from(
            [
                (front, "vertices"),
                (front, "translation"),
                (front, "rotation"),
                (front, "label"),
                (front["vertices"], 1),
                (front["edges"], 1),
                (front["edges"][1], "endpoints"),
                (front["edges"][1], "curvature"),
            ]
        )
    )
    place[key] = data.draw(json_values)
    try:
        read_spec(given_spec)
    except GarmentImageError as error:
        assert "front" in str(error) or "back" in str(error)


# Reading, trap by trap.


def test_both_curvature_syntaxes_say_the_same():
    legacy = pattern_from_spec(one_panel(e1=[0.5, 0.1]))
    object_syntax = pattern_from_spec(one_panel(e1={"type": "quadratic", "params": [[0.5, 0.1]]}))
    assert legacy == object_syntax
    assert legacy.panels[0].edges[1].curvature == Quadratic((0.5, 0.1))


def test_control_points_lie_along_and_left_of_the_edge():
    curve = pattern_from_spec(one_panel(e1=[0.25, 0.1])).panels[0].curves[1]
    # Edge 1 runs up from (30, 0) to (30, 40); its left is towards smaller x.
    assert curve.controls == ((26.0, 10.0),)


def test_absolute_control_points_are_made_relative():
    relative = pattern_from_spec(one_panel(e1=[0.25, 0.1]))
    absolute = pattern_from_spec(
        spec({"front": panel(e1=[26.0, 10.0])}, [], curvature_coords="absolute")
    )
    assert absolute == relative


def test_absolute_cubic_control_points_are_made_relative():
    given_curve = {"type": "cubic", "params": [[33.0, 10.0], [33.0, 30.0]]}
    data = spec({"front": panel(e1=given_curve)}, [], curvature_coords="absolute")
    assert pattern_from_spec(data).panels[0].edges[1].curvature == Cubic(
        (0.25, -0.075), (0.75, -0.075)
    )


def test_radius_is_in_file_units_whatever_the_coordinates_say():
    vertices = [[0, 0], [90, 0], [90, 120], [0, 120]]
    arc = {"type": "circle", "params": [75, 0, 1]}
    data = spec({"front": panel(vertices, e1=arc)}, [], units_in_meter=300)
    (front,) = pattern_from_spec(data).panels
    assert front.edges[1].curvature == Circle(25.0, False, True)
    assert front.outline.vertices[2] == (30.0, 40.0)


def test_an_arc_bulges_to_the_side_that_the_file_says():
    for right, x in ((1, 40.0), (0, 20.0)):
        arc = {"type": "circle", "params": [25, 0, right]}
        middle = pattern_from_spec(one_panel(e1=arc)).panels[0].curves[1].at(np.array([0.5]))
        np.testing.assert_allclose(middle, [[x, 20.0]], atol=1e-9)


def test_a_radius_a_hair_too_short_is_a_half_circle_and_told():
    data = one_panel(e1={"type": "circle", "params": [19.9999, 0, 1]})
    pattern, found = read_spec(data)
    assert pattern.panels[0].edges[1].curvature == Circle(20.0, False, True)
    assert [f.place for f in found] == ["panel 'front', edge 1"]
    assert read_spec(pattern_to_spec(pattern)) == (pattern, ())


def test_a_radius_far_too_short_is_refused():
    with pytest.raises(PatternError, match="panel 'front', edge 1: an arc of radius 6 cm"):
        read_spec(one_panel(e1={"type": "circle", "params": [6, 0, 1]}))


def test_vertex_order_is_kept_and_edges_follow_their_ends():
    vertices = [[30, 40], [0, 0], [0, 40], [30, 0]]
    data = spec({"front": panel(vertices, ((1, 3), (3, 0), (0, 2), (2, 1)))}, [])
    (front,) = pattern_from_spec(data).panels
    assert front.outline.vertices == ((30.0, 40.0), (0.0, 0.0), (0.0, 40.0), (30.0, 0.0))
    assert front.outline.area == 1200.0
    assert front.curves[1].start == (30.0, 0.0)


@pytest.mark.parametrize("units", [100, 300, 1, 39.37])
def test_units_become_cm(units):
    size = units / 100
    vertices = [[x * size, y * size] for x, y in ((0, 0), (30, 0), (30, 40), (0, 40))]
    data = spec({"front": panel(vertices)}, [], units_in_meter=units)
    data["pattern"]["panels"]["front"]["translation"] = [0, 100 * size, 20 * size]
    (front,) = pattern_from_spec(data).panels
    np.testing.assert_allclose(front.outline.vertices, [[0, 0], [30, 0], [30, 40], [0, 40]])
    np.testing.assert_allclose(front.translation, (0, 100, 20))


@given(st.floats(1, 1000), st.floats(-1000, 1000))
def test_numbers_of_a_cm_file_come_through_unchanged(size, place):
    data = spec({"front": panel([[0, 0], [size, 0], [size, size], [0, size]])}, [])
    data["pattern"]["panels"]["front"]["translation"] = [place, place / 3, place / 7]
    pattern, _ = read_spec(data)
    again = json.loads(json.dumps(pattern_to_spec(pattern)))["pattern"]["panels"]["front"]
    assert again["vertices"][2] == [size, size]
    assert again["translation"] == [place, place / 3, place / 7]


def test_rotation_turns_about_fixed_x_then_y_then_z():
    turned = rotation_matrix((90.0, 90.0, 0.0))
    # About x first: y goes to z; then about y: z goes to x.
    np.testing.assert_allclose(turned @ [0, 1, 0], [1, 0, 0], atol=1e-12)


def test_a_rotation_matrix_is_read_as_angles():
    data = one_panel()
    data["pattern"]["panels"]["front"]["rotation"] = rotation_matrix((10.0, 20.0, 30.0)).tolist()
    np.testing.assert_allclose(pattern_from_spec(data).panels[0].rotation, (10, 20, 30))


@pytest.mark.parametrize("value", [[1, 0, 0, 0], [[1, 0, 0], [0, 1, 0], [0, 0, -1]], [[2]], "up"])
def test_what_is_no_rotation_is_refused(value):
    data = one_panel()
    data["pattern"]["panels"]["front"]["rotation"] = value
    with pytest.raises(PatternError, match="panel 'front', rotation"):
        read_spec(data)


def test_right_wrong_sews_start_to_start():
    flagged = spec(stitches=[stitch(("front", 1), ("back", 3), "right_wrong")])
    assert pattern_from_spec(flagged).stitches[0].same_direction
    assert not pattern_from_spec(spec()).stitches[0].same_direction
    assert pattern_to_spec(pattern_from_spec(flagged))["pattern"]["stitches"][0][2] == "right_wrong"


def test_normalised_translation_moves_the_mean_of_the_vertices_to_the_origin():
    data = spec({"front": panel()}, [], normalize_panel_translation=True)
    (front,) = pattern_from_spec(data).panels
    assert front.outline.vertices[0] == (-15.0, -20.0)
    assert front.translation == (15.0, 120.0, 20.0)
    again = pattern_to_spec(pattern_from_spec(data))
    assert again["properties"]["normalize_panel_translation"] is False


def test_panel_order_is_kept_and_mended_where_it_lies():
    data = spec()
    data["pattern"]["panel_order"] = ["back", "front"]
    pattern, found = read_spec(data)
    assert found == ()
    assert pattern_to_spec(pattern)["pattern"]["panel_order"] == ["back", "front"]
    data["pattern"]["panel_order"] = ["nobody", "back"]
    pattern, found = read_spec(data)
    assert [f.place for f in found] == ["pattern.panel_order"]
    assert pattern.extra["pattern"]["panel_order"] == ["back", "front"]


def test_labels_are_kept():
    data = one_panel()
    front = data["pattern"]["panels"]["front"]
    front["label"], front["edges"][1]["label"] = "body", "right_armhole"
    (read,) = pattern_from_spec(data).panels
    assert (read.label, read.edges[1].label) == ("body", "right_armhole")
    assert pattern_to_spec(pattern_from_spec(data))["pattern"]["panels"]["front"]["label"] == "body"


# Mending.


def test_shuffled_edges_are_sorted_and_stitches_follow():
    data = spec()
    front = data["pattern"]["panels"]["front"]
    front["edges"] = edges((0, 1), (3, 0), (2, 3), (1, 2))
    data["pattern"]["stitches"] = [
        stitch(("front", 3), ("back", 3)),
        stitch(("front", 1), ("back", 1)),
    ]
    pattern, found = read_spec(data)
    assert pattern == pattern_from_spec(spec())
    assert [f.place for f in found] == ["panel 'front'"]


def test_a_backward_edge_is_turned_round_with_its_curve():
    curved = one_panel(e1={"type": "cubic", "params": [[0.25, 0.5], [0.75, 0.25]]})
    backward = one_panel(e1={"type": "cubic", "params": [[0.25, -0.25], [0.75, -0.5]]})
    backward["pattern"]["panels"]["front"]["edges"][1]["endpoints"] = [2, 1]
    pattern, found = read_spec(backward)
    assert pattern == pattern_from_spec(curved)
    assert [f.place for f in found] == ["panel 'front', edge 1"]


def test_a_loop_whose_first_edge_runs_backwards_is_walked_the_common_way():
    data = one_panel()
    data["pattern"]["panels"]["front"]["edges"][0]["endpoints"] = [1, 0]
    pattern, found = read_spec(data)
    assert pattern == pattern_from_spec(one_panel())
    assert [f.place for f in found] == ["panel 'front', edge 0"]


def test_an_unused_vertex_is_left_out():
    data = one_panel()
    data["pattern"]["panels"]["front"]["vertices"].insert(0, [1e6, 1e6])
    for edge in data["pattern"]["panels"]["front"]["edges"]:
        edge["endpoints"] = [v + 1 for v in edge["endpoints"]]
    pattern, found = read_spec(data)
    assert pattern == pattern_from_spec(one_panel())
    assert "vertex 0" in found[0].message


def test_a_copy_of_a_stitch_is_left_out_and_later_ones_keep_their_numbers_in_messages():
    data = spec()
    first = data["pattern"]["stitches"][0]
    data["pattern"]["stitches"].insert(1, first[::-1])
    pattern, found = read_spec(data)
    assert pattern == pattern_from_spec(spec())
    assert [f.place for f in found] == ["stitches 0 and 1"]
    data["pattern"]["stitches"].append(stitch(("front", 0), ("back", 1)))
    with pytest.raises(StitchError, match="stitches 2 and 3: both sew edge 1 of panel 'back'"):
        read_spec(data)


def test_missing_placement_units_and_stitches_are_assumed_and_told():
    data = one_panel()
    del data["pattern"]["panels"]["front"]["rotation"], data["pattern"]["stitches"]
    del data["properties"]
    pattern, found = read_spec(data)
    assert pattern == pattern_from_spec(one_panel())
    assert {f.place for f in found} == {"top level", "panel 'front'", "pattern"}


def test_loading_tells_findings_as_warnings(tmp_path):
    data = spec()
    del data["properties"]
    path = written(tmp_path / "no_units.json", data)
    with pytest.warns(PatternWarning, match=r"no_units\.json: top level: has no 'properties'"):
        load_pattern(path)


def test_findings_of_one_file_are_counted_not_endless():
    panels = {f"p{k}": {**panel(), "rotation": [0, 0, 0]} for k in range(200)}
    for given_panel in panels.values():
        del given_panel["translation"]
    _, found = read_spec(spec(panels, []))
    assert len(found) == 51
    assert "further findings" in found[-1].message


# What plain files have no place for.


def holed_spec():
    data = spec()
    data["garmentimage"] = {
        "schema": 1,
        "panels": {
            "front": {
                "holes": [
                    {
                        "vertices": [[10, 10], [10, 20], [20, 10]],
                        "edges": edges((0, 1), (1, 2), (2, 0)),
                    }
                ],
                "grain": [0, 1],
                "notches": [{"edge": 1, "at": 0.5}],
                "cloth_layer": 1,
                "x_later": "?",
            }
        },
        "stitches": [{"position": 1, "stitch": stitch(("front", 4), ("front", 6))}],
    }
    return data


def test_holes_grain_notches_and_layers_live_in_our_field():
    pattern, _ = read_spec(holed_spec())
    front = pattern.by_name["front"]
    assert len(front.edges) == 7
    assert front.holes[0].area == -50.0
    assert (front.grain, front.notches, front.cloth_layer) == ((0.0, 1.0), (Notch(1, 0.5),), 1)
    assert pattern.stitches[1].sides == (Side("front", 4), Side("front", 6))
    assert through_json(pattern) == pattern
    again = pattern_to_spec(pattern)
    assert len(again["pattern"]["stitches"]) == 2
    assert again["garmentimage"]["panels"]["front"]["x_later"] == "?"


def test_a_plain_stitch_cannot_name_an_edge_of_a_hole():
    data = holed_spec()
    data["pattern"]["stitches"].append(stitch(("front", 5), ("back", 0)))
    with pytest.raises(StitchError, match="names edge 5 of panel 'front', which has edges 0 to 3"):
        read_spec(data)


def test_a_hole_must_run_against_the_outline_and_lie_inside():
    data = holed_spec()
    hole = data["garmentimage"]["panels"]["front"]["holes"][0]
    hole["edges"] = edges((0, 2), (2, 1), (1, 0))
    with pytest.raises(PatternError, match="hole 0 runs the same way round"):
        read_spec(data)
    hole["vertices"] = [[110, 10], [110, 20], [120, 10]]
    with pytest.raises(PatternError, match="outside the cloth"):
        read_spec(data)


@pytest.mark.parametrize("schema", [0, 3, "1", None, True])
def test_an_unknown_schema_is_refused(schema):
    data = holed_spec()
    data["garmentimage"]["schema"] = schema
    with pytest.raises(PatternFileError, match=r"garmentimage\.schema"):
        read_spec(data)


# Files.


def test_encodings_with_a_byte_order_mark_are_read(tmp_path):
    text = json.dumps(spec())
    for encoding in ("utf-8", "utf-8-sig", "utf-16", "utf-32"):
        path = tmp_path / f"{encoding}.json"
        path.write_bytes(text.encode(encoding))
        assert load_pattern(path) == pattern_from_spec(spec())


def test_constants_that_json_does_not_know_survive_in_unknown_fields(tmp_path):
    path = tmp_path / "odd.json"
    path.write_text(json.dumps({**spec(), "x": [math.nan, math.inf, -math.inf]}))
    pattern = load_pattern(path)
    save_pattern(pattern, tmp_path / "again.json")
    assert load_pattern(tmp_path / "again.json") == pattern


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b" \n", "is empty"),
        (b"<html>", "is not JSON .*line 1, column 1"),
        (b'{"a": "\xff"}', "is not text .*byte 7"),
        (b"{} {}", "Extra data"),
        (b'{"a": 1, "a": 2}', "the name 'a' occurs twice"),
        (b"[" * 200_000, "100 deep"),
        (b'{"a": ' + b"[" * 101 + b"]" * 101 + b"}", "100 deep"),
        (b'{"pattern": ' + b"9" * 5000 + b"}", "pattern: must be an object"),
        (json.dumps(spec())[:-1].encode() + b', "x": ' + b"9" * 5000 + b"}", "thousands of digits"),
    ],
)
def test_a_file_that_is_no_pattern_is_named_with_the_reason(tmp_path, content, message):
    path = tmp_path / "bad.json"
    path.write_bytes(content)
    with pytest.raises(PatternFileError, match=rf"bad\.json: .*{message}"):
        read_pattern(path)


def test_a_path_that_cannot_be_read_is_named(tmp_path):
    for path, message in (
        (tmp_path / "none.json", "no such file"),
        (tmp_path, "is a folder"),
        ("bad\0name", "cannot be read"),
        (tmp_path / ("x" * 5000), "cannot be read"),
    ):
        with pytest.raises(PatternFileError, match=message):
            read_pattern(path)


def test_saving_is_whole_or_not_at_all(tmp_path):
    pattern = pattern_from_spec(spec())
    with pytest.raises(OutputError, match="make it first"):
        save_pattern(pattern, tmp_path / "missing" / "p.json")
    with pytest.raises(OutputError, match="is a folder"):
        save_pattern(pattern, tmp_path)
    save_pattern(pattern, tmp_path / "p.json")
    assert [p.name for p in tmp_path.iterdir()] == ["p.json"]


def test_a_pattern_that_no_file_can_hold_is_not_written(tmp_path):
    pattern = pattern_from_spec(spec())
    twice = type(pattern)((pattern.panels[0], pattern.panels[0]))
    with pytest.raises(PatternError, match="two panels are named 'front'"):
        save_pattern(twice, tmp_path / "p.json")
    assert not list(Path(tmp_path).iterdir())


def test_an_extra_field_that_json_cannot_hold_is_refused(tmp_path):
    pattern = replace(pattern_from_spec(spec()), extra={"top": {"x": object()}})
    with pytest.raises(PatternError, match="extra field"):
        save_pattern(pattern, tmp_path / "p.json")
