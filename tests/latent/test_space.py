"""Latent spaces of the package: what goes in comes back, and what lies between can be sewn."""

import json
import shutil
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

from garmentimage.compare import match_panels, pattern_faults, stitch_graph
from garmentimage.compare.topology import topology_hash
from garmentimage.draft.kind import draft_pattern
from garmentimage.draft.sampling import sample
from garmentimage.errors import DatasetError, LearnError
from garmentimage.examples import example_path
from garmentimage.latent.operations import generate, interpolate, nearest, transfer
from garmentimage.latent.space import LatentSpace, space_names
from garmentimage.pattern.files.spec import load_pattern
from garmentimage.raster.encode.encoder import encode
from garmentimage.raster.image import mirrored_channels


@pytest.fixture(scope="module")
def space():
    return LatentSpace.load()


def word(pattern) -> str:
    return topology_hash(stitch_graph(pattern))


@pytest.mark.parametrize("kind", ["one-panel-dress", "top-pants", "top-skirt"])
def test_new_garments_come_back_from_their_latent_vectors(space, kind):
    for each in sample(kind, 8, seed=991, fixed={"sleeves": "none"}):
        if any(panel.holes for panel in each.pattern.panels):
            continue
        step = space.decode(space.encode(each.pattern))
        assert not step.faults and step.pattern is not None
        assert word(step.pattern) == word(each.pattern)
        assert min(pair.iou for pair in match_panels(each.pattern, step.pattern).pairs) > 0.8


def test_the_way_between_two_garments_begins_and_ends_with_them(space):
    a, b = draft_pattern("one-panel-dress"), draft_pattern("top-pants")
    way = interpolate(space, a, b, 5)
    assert len(way) == 5
    assert np.allclose(way[0].z, space.encode(a), atol=1e-5)
    assert np.allclose(way[-1].z, space.encode(b), atol=1e-5)
    assert word(way[0].pattern) == word(a) and word(way[-1].pattern) == word(b)
    assert all(step.pattern is not None and not pattern_faults(step.pattern) for step in way)
    for steps in (1, 201):
        with pytest.raises(LearnError, match=f"{steps} steps; give 2 to 200"):
            interpolate(space, a, b, steps)


def test_an_edit_of_nothing_changes_nothing(space):
    a, b = draft_pattern("top-skirt"), draft_pattern("one-panel-dress")
    plain = {"reprojections": 0, "strengths": [1.0]}
    assert np.allclose(transfer(space, a, a, b, **plain).garment.z, space.encode(b), atol=1e-5)
    assert np.allclose(transfer(space, a, b, a, **plain).garment.z, space.encode(b), atol=1e-5)
    same = transfer(space, a, a, b)
    assert word(same.garment.pattern) == word(b) and same.strength == 1
    with pytest.raises(LearnError, match=r"strengths \[0\]; give some above 0"):
        transfer(space, a, a, b, strengths=[0])
    with pytest.raises(LearnError, match="21 reprojections; give 0 to 20"):
        transfer(space, a, a, b, reprojections=21)


def test_settling_brings_a_point_nearer_to_where_it_stays(space):
    z = space.encode(draft_pattern("top-skirt")) + np.float32(0.3)
    ways = [z, *(space.reproject(z, times) for times in (1, 2, 3))]
    apart = [float(np.linalg.norm(b - a)) for a, b in pairwise(ways)]
    assert apart[1] < apart[0] and apart[2] < apart[0]
    assert np.array_equal(space.reproject(ways[1], 2), ways[3])


def test_generated_garments_depend_on_seed_and_number_alone(space):
    many = list(generate(space, 4, seed=3))
    assert np.array_equal(many[2].z, list(generate(space, 3, seed=3))[2].z)
    assert not np.array_equal(many[0].z, next(generate(space, 1, seed=4)).z)
    assert all(not step.faults for step in many)
    with pytest.raises(LearnError, match=r"knows no type 'top \+ skrit'; did you mean"):
        next(generate(space, 1, type_name="top + skrit"))
    with pytest.raises(LearnError, match="0 garments"):
        next(generate(space, 0))


def test_a_training_garment_is_nearest_to_itself(space):
    row_id, apart, pattern = nearest(space, draft_pattern("top-skirt"), 1)[0]
    again, nothing, _ = nearest(space, pattern, 1)[0]
    assert again == row_id and nothing < 0.05 < apart
    with pytest.raises(LearnError, match="0 garments; give 1 to"):
        nearest(space, pattern, 0)


def test_garments_unlike_those_trained_on_are_told(space):
    assert not space.out_of_distribution(space.locate(draft_pattern("one-panel-dress")))
    assert "other seams" in space.out_of_distribution(
        space.locate(load_pattern(example_path("dress")))
    )
    assert space.out_of_distribution(space.locate(draft_pattern("hoodie")))


def test_images_that_the_network_does_not_take_are_refused(space):
    with pytest.raises(LearnError, match="an image of 2 layers of 32 x 32 cells"):
        space.encode(encode(draft_pattern("tank"), 32))
    image = encode(draft_pattern("tank"), 16)
    with pytest.raises(LearnError, match="without a cell of cloth"):
        space.encode(replace(image, inside=np.zeros_like(image.inside)))
    with pytest.raises(LearnError, match="an edge vector of more than 1000 cm"):
        space.encode(replace(image, deformation=image.deformation * 1e6))


@pytest.mark.wrong_types
def test_what_is_no_garment_or_no_latent_vector_is_told(space):
    garment = draft_pattern("tank")
    for wrong in ("dress.json", None, np.zeros(3)):
        with pytest.raises(TypeError, match="wanted a Pattern or a GarmentImage"):
            interpolate(space, wrong, garment)
    with pytest.raises(TypeError, match="wanted a LatentSpace"):
        interpolate("vae-variety", garment, garment)
    for wrong in (np.zeros(31, np.float32), np.zeros((2, 32), np.float32), np.full(32, np.nan)):
        with pytest.raises(LearnError, match="a latent vector of shape"):
            space.decode(wrong)
    assert transfer(space, garment, garment, garment, strengths=np.array([1.0])).strength == 1


def test_spaces_that_are_not_there_are_told():
    with pytest.raises(LearnError, match="there is no latent space 'vae-varity'; did you mean"):
        LatentSpace.load("vae-varity")
    assert "vae-variety" in space_names()


@pytest.mark.parametrize(
    ("name", "damage", "sentence"),
    [
        ("config.json", b"{", "is damaged"),
        ("config.json", b"[" * 100_000, "is damaged"),
        ("config.json", b'{"grid": -1, "latent": 32}', "is damaged"),
        ("encoder.onnx", b"no network", "is damaged, or none of ours"),
        ("decoder.onnx", b"", "is damaged, or none of ours"),
        ("garments.npz", b"PK", "is damaged, or none of ours"),
    ],
)
def test_damaged_spaces_are_told_by_file(space, tmp_path, name, damage, sentence):
    folder = tmp_path / "space"
    shutil.copytree(space.folder, folder)
    (folder / name).write_bytes(damage)
    with pytest.raises(LearnError, match=f"{name}: {sentence}"):
        broken = LatentSpace(folder)
        broken.decode(broken.encode(draft_pattern("tank")))
        assert broken.garments
    (folder / name).unlink()
    with pytest.raises(LearnError):
        broken = LatentSpace(folder)
        broken.decode(broken.encode(draft_pattern("tank")))
        assert broken.garments


@pytest.mark.parametrize(
    "change",
    [
        {"latents": np.full((4, 32), np.nan)},
        {"types": np.array(["a", "b"])},
        {"ids": np.arange(4)},
        {"ids": np.zeros(0, str), "types": np.zeros(0, str), "latents": np.zeros((0, 32))},
    ],
)
def test_known_garments_that_cannot_be_are_told(space, tmp_path, change):
    folder = tmp_path / "space"
    shutil.copytree(space.folder, folder)
    known = {"ids": np.array(list("abcd")), "types": np.array(list("xxyy"))}
    np.savez(folder / "garments.npz", **{"latents": np.zeros((4, 32)), **known} | change)
    with pytest.raises(LearnError, match=r"garments.npz: is damaged"):
        assert LatentSpace(folder).garments


def test_networks_that_do_not_go_together_are_told(space, tmp_path):
    folder = tmp_path / "space"
    shutil.copytree(space.folder, folder)
    config = json.loads((folder / "config.json").read_text())
    (folder / "config.json").write_text(json.dumps(config | {"grid": 32}))
    with pytest.raises(LearnError, match=r"encoder.onnx: is damaged"):
        LatentSpace(folder).encode(draft_pattern("tank"))
    (folder / "config.json").write_text(json.dumps(config))
    shutil.copy(folder / "decoder.onnx", folder / "encoder.onnx")
    with pytest.raises(LearnError, match=r"encoder.onnx: is damaged"):
        LatentSpace(folder).encode(draft_pattern("tank"))
    for wrong in ({"seed": -1}, {"seed": None}, {"recipe": 3}):
        (folder / "config.json").write_text(json.dumps(config | wrong))
        with pytest.raises(LearnError, match=r"config.json: is damaged"):
            LatentSpace(folder)


def test_a_network_for_other_channels_is_refused(space, tmp_path):
    folder = tmp_path / "space"
    shutil.copytree(space.folder, folder)
    config = json.loads((folder / "config.json").read_text())
    (folder / "config.json").write_text(json.dumps(config | {"channels_contract": "other-9"}))
    with pytest.raises(LearnError, match="was made for channels 'other-9', and this version has"):
        LatentSpace(folder)


def test_rows_are_named_by_ids():
    from garmentimage.dataset.recipe import load_recipe
    from garmentimage.dataset.row import RowTask, draft_garment, task_from_id

    chosen = load_recipe("vae-variety")
    task = RowTask(chosen, 5, 16, 2, 31)
    assert task_from_id(chosen, task.row_id, 5) == task
    assert draft_garment(task).index == 31
    for wrong in ("vae-variety-99-0000001", "d2-00-0000001", "vae-variety-02-31", ""):
        with pytest.raises(DatasetError, match="has no row"):
            task_from_id(chosen, wrong, 5)


@given(noise=arrays(np.float32, 32, elements=st.floats(-1, 1, width=32)))
def test_what_comes_of_an_even_garment_is_even_where_the_space_is_fit_for_it(noise):
    space = LatentSpace.load("text-edit")
    dress = space.image(draft_pattern("one-panel-dress"))
    fit = space.symmetrised_for(dress)
    channels = fit.decode(space.encode(dress) + noise).image.to_channels()[None]
    inside, mirrored = channels[:, [0, 17]], mirrored_channels(channels)[:, [0, 17]]
    assert np.array_equal(inside, mirrored)


def test_a_space_fit_for_an_uneven_garment_is_the_same():
    space = LatentSpace.load("text-edit")
    dress = space.image(draft_pattern("one-panel-dress", hem_slant=8.0))
    z = space.encode(dress)[None]
    assert np.array_equal(space.symmetrised_for(dress).decode_channels(z), space.decode_channels(z))
