from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, reject, settings, strategies as st

from garmentimage.cli.app import main
from garmentimage.draft.kind import KINDS
from garmentimage.draft.sampling import ANY_BODY, sample
from garmentimage.errors import EncodeError, ImageError
from garmentimage.raster.channel_kind import CHANNEL_KINDS
from garmentimage.raster.channels import CHANNELS_PER_LAYER, join_channels, split_channels
from garmentimage.raster.encode.encoder import encode
from garmentimage.raster.image import EdgeType, GarmentImage
from garmentimage.raster.repair.repairer import LEVELS, repair
from garmentimage.raster.repair.walls import RARE_COST
from tests.garments import garments
from tests.raster.boards import board, with_types

SHIRT = "........ .aaaaaa. .aaaaaa. bbaaaacc bbaaaacc .dddddd. .eeeeee. ........"
DRESS = board(SHIRT, SHIRT, sewn_around=True)
NON_BOUNDARY, NON_STITCH, FRONT_TO_BACK, SIDE_BY_SIDE, WRAP, *_ = EdgeType


def darted():
    """A dress with a slit of two grid edges from the armpit into the front."""
    slit = {(0, 1, 5, 3): SIDE_BY_SIDE, (0, 1, 6, 3): SIDE_BY_SIDE}
    image = with_types(DRESS, slit)
    deformation = image.deformation.copy()
    deformation[0, 1, 0, 5:7, 2], deformation[0, 3, 0, 5:7, 3] = -1.0, 1.0
    return replace(image, deformation=deformation)


def soft(image, certainty):
    """Channels of a network that is right everywhere, but not sure."""
    block = image.to_channels().reshape(image.layers, CHANNELS_PER_LAYER, image.grid, image.grid)
    block = block.copy()
    block[:, 0] = 0.5 + (block[:, 0] - 0.5) * certainty
    block[:, 1:9] = 0.25 + (block[:, 1:9] - 0.25) * certainty
    return block.reshape(-1, image.grid, image.grid)


def logits(image, size):
    """The same as logits."""
    block = image.to_channels().reshape(image.layers, CHANNELS_PER_LAYER, image.grid, image.grid)
    block = block.copy()
    block[:, :9] = (block[:, :9] - 0.5) * size
    return block.reshape(-1, image.grid, image.grid)


@pytest.mark.parametrize("image", [DRESS, darted()], ids=["dress", "darted"])
@pytest.mark.parametrize("level", LEVELS)
def test_correct_image_is_never_changed(image, level):
    for given_image in (image, image.to_channels(), logits(image, 30.0)):
        mended, report = repair(given_image, level)
        assert mended.same_channels(image)
        assert not report.changed


@pytest.mark.parametrize("channels", [soft(darted(), 0.75), logits(darted(), 4.0)])
def test_image_that_a_network_is_merely_fairly_sure_of_is_read_as_it_is(channels):
    assert repair(channels)[0].same_channels(darted())


@given(st.integers(0, 2**32 - 1))
def test_any_single_wrong_flag_is_mended(seed):
    rng = np.random.default_rng(seed)
    layer, row, col = rng.integers(2), rng.integers(8), rng.integers(8)
    inside, deformation = DRESS.inside.copy(), DRESS.deformation.copy()
    inside[layer, row, col] ^= True
    deformation[layer, :, :, row, col] = 0
    mended, report = repair(replace(DRESS, inside=inside, deformation=deformation))
    assert mended.same_channels(DRESS)
    assert report.counts["inconsistent flags"] == 1


@st.composite
def noises(draw):
    """Channels that mean nothing, of any size and spread."""
    grid, layers = draw(st.integers(4, 12)), draw(st.integers(1, 3))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    return rng.normal(size=(CHANNELS_PER_LAYER * layers, grid, grid)) * rng.choice([0.1, 1, 10])


@given(noises())
def test_full_repair_leaves_nothing_inconsistent(noise):
    assert inconsistencies(repair(noise, "full")[0]) == 0


@given(noises())
def test_no_repair_is_the_likeliest_value_of_everything(noise):
    image, report = repair(noise, "none")
    layers = noise.reshape(-1, CHANNELS_PER_LAYER, *noise.shape[1:])
    assert np.array_equal(image.inside, layers[:, 0] > (0 if report.kind == "logits" else 0.5))
    for h, four in enumerate((layers[:, 1:5], layers[:, 5:9])):
        assert np.array_equal(image.edge_type[:, h], four.argmax(axis=1))
    assert not report.changed


@given(noises())
def test_the_papers_repair_only_sews_gaps(noise):
    image, mended = repair(noise, "none")[0], repair(noise, "paper")[0]
    assert np.array_equal(mended.inside, image.inside)
    assert np.array_equal(mended.deformation, image.deformation)
    changed = mended.edge_type != image.edge_type
    found = set(zip(image.edge_type[changed], mended.edge_type[changed], strict=True))
    assert found <= {(NON_STITCH, FRONT_TO_BACK), (NON_BOUNDARY, SIDE_BY_SIDE)}


@given(st.integers(0, 2**32 - 1))
def test_repairing_twice_changes_nothing_more(seed):
    rng = np.random.default_rng(seed)
    mended, _ = repair(rng.normal(size=(2 * CHANNELS_PER_LAYER, 8, 8)))
    again, _ = repair(mended)
    assert inconsistencies(again) == 0
    assert np.array_equal(again.inside, mended.inside)


def inconsistencies(image):
    """Grid edges whose type and cells do not agree."""
    padded = np.pad(image.inside, ((0, 1 if image.layers % 2 else 0), (1, 0), (1, 0)))
    here = padded[:, 1:, 1:]
    wrong = 0
    for h, other in enumerate((padded[:, :-1, 1:], padded[:, 1:, :-1])):
        kinds = image.edge_type[:, h]
        a, b = other[: image.layers], here[: image.layers]
        wrong += (kinds[a != b] == NON_BOUNDARY).sum() + (kinds[~a & ~b] != NON_BOUNDARY).sum()
        wrong += (kinds[a != b] == SIDE_BY_SIDE).sum()
        for layer in range(0, image.layers, 2):
            sewn = kinds[layer] == FRONT_TO_BACK
            back = kinds[layer + 1] == FRONT_TO_BACK if layer + 1 < image.layers else ~sewn & False
            wrong += (sewn != back).sum()
            both = (other[layer] & other[layer + 1]) | (here[layer] & here[layer + 1])
            wrong += (sewn & ~both).sum()
    return int(wrong)


def test_gap_in_a_front_to_back_seam_is_sewn_where_the_other_layer_agrees():
    place = (0, 1, 5, 1)
    assert DRESS.edge_type[place] == FRONT_TO_BACK
    torn = with_types(DRESS, {place: NON_STITCH})
    for level in ("paper", "full"):
        assert repair(torn, level)[0].same_channels(DRESS)


def test_opening_in_a_front_to_back_seam_stays_where_both_layers_have_it():
    vent = with_types(DRESS, {(0, 1, 5, 1): NON_STITCH, (1, 1, 5, 1): NON_STITCH})
    for level in ("paper", "full"):
        assert repair(vent, level)[0] is vent


def test_gap_in_a_side_by_side_seam_is_closed():
    torn = with_types(DRESS, {(0, 0, 2, 4): NON_BOUNDARY})
    for level in ("paper", "full"):
        assert repair(torn, level)[0].same_channels(DRESS)


def test_cloth_between_the_tips_of_two_darts_stays_whole():
    image = darted()
    second = with_types(image, {(0, 1, 3, 3): SIDE_BY_SIDE})
    deformation = second.deformation.copy()
    deformation[0, 1, 0, 3, 2], deformation[0, 3, 0, 3, 3] = -1.0, 1.0
    both = replace(second, deformation=deformation)
    for level in ("paper", "full"):
        assert repair(both, level)[0].same_channels(both)


def uncertain(image, walls, probability):
    """Channels that are sure but for some grid edges: side by side with this probability."""
    channels = image.to_channels().copy()
    for layer, h, row, col in walls:
        first = CHANNELS_PER_LAYER * layer + 1 + 4 * h
        channels[first : first + 4, row, col] = 0
        channels[first + SIDE_BY_SIDE, row, col] = probability
        channels[first, row, col] = 1 - probability
    return channels


def test_seam_that_is_unsure_in_places_is_kept_whole():
    walls = [(0, 0, 2, 3), (0, 0, 2, 5)]
    mended, report = repair(uncertain(DRESS, walls, 0.35))
    assert mended.same_channels(DRESS)
    assert report.changed


def test_slit_that_is_hardly_likelier_than_none_goes():
    walls = [(0, 1, 5, 3), (0, 1, 6, 3)]
    assert repair(uncertain(DRESS, walls, 0.6))[0].same_channels(DRESS)


def test_slit_that_is_likely_stays_a_dart():
    walls = [(0, 1, 5, 3), (0, 1, 6, 3)]
    mended, _ = repair(uncertain(DRESS, walls, 0.95))
    assert all(mended.edge_type[w] == SIDE_BY_SIDE for w in walls)


BAND = [(0, 0, 2, col) for col in range(1, 7)]
BELOW = [(0, 0, 3, col) for col in range(1, 7)]


def test_sure_band_between_two_panels_stays_a_waistband():
    assert repair(uncertain(DRESS, BAND + BELOW, 0.9))[0].same_channels(DRESS)


def test_band_between_two_unsure_seams_becomes_one_seam():
    channels = uncertain(DRESS, BAND, 0.55)
    for layer, h, row, col in BELOW:
        first = CHANNELS_PER_LAYER * layer + 1 + 4 * h
        channels[first : first + 4, row, col] = [0.35, 0, 0, 0.65]
    mended, _ = repair(channels)
    seams = [sum(mended.edge_type[w] == SIDE_BY_SIDE for w in walls) for walls in (BAND, BELOW)]
    assert sorted(seams) == [0, 6]


def test_cell_that_a_doubtful_wall_cuts_off_is_no_panel_of_its_own():
    """A network that wavers between two places of one seam draws both."""
    mended, report = repair(uncertain(DRESS, [(0, 1, 2, 2)], 0.8))
    assert mended.same_channels(DRESS)
    assert report.counts["thin regions merged"] == 1


def test_cell_that_a_sure_wall_cuts_off_is_a_panel_of_its_own():
    mended, _ = repair(uncertain(DRESS, [(0, 1, 2, 2)], 0.9))
    assert mended.edge_type[0, 1, 2, 2] == SIDE_BY_SIDE


def test_cell_that_became_inside_gets_the_vectors_of_its_neighbours():
    inside, deformation = DRESS.inside.copy(), DRESS.deformation * np.float32(1.5)
    whole = replace(DRESS, inside=inside.copy(), deformation=deformation.copy())
    inside[0, 5, 4] = False
    deformation[0, :, :, 5, 4] = 0
    mended, report = repair(replace(DRESS, inside=inside, deformation=deformation))
    assert mended.same_channels(whole)
    assert report.counts["deformations filled in"] == 1


def test_unknown_level_and_bad_arrays_are_refused():
    # An ImageError, or the type checker's own error where it runs.
    with pytest.raises(Exception, match="everything"):
        repair(DRESS, "everything")
    with pytest.raises(ImageError, match="not finite"):
        repair(np.full((34, 16, 16), np.nan))
    with pytest.raises(ImageError, match="33 channels"):
        repair(np.zeros((33, 16, 16)))


def shares(image, share, noise=0.0, seed=0):
    """What is true has a share, the rest is spread evenly, with noise on the logits."""
    rng = np.random.default_rng(seed)
    flags, types, vectors, turned = split_channels(image.to_channels().astype(float))

    def softened(flag):
        logits = (2 * flag - 1) * np.log(share / (1 - share))
        return 1 / (1 + np.exp(-logits - rng.normal(0, noise, flag.shape)))

    flags = softened(flags)
    types = np.where(types > 0.5, share, (1 - share) / (types.shape[2] - 1))
    types *= np.exp(rng.normal(0, noise, types.shape))
    types /= types.sum(axis=2, keepdims=True)
    return join_channels(flags, types, vectors, None if turned is None else softened(turned))


CERTAINTIES = st.floats(0.99, 0.9999)


@settings(deadline=None, max_examples=20)
@given(garments(), CERTAINTIES, st.sampled_from(LEVELS))
def test_a_garment_that_a_network_is_sure_of_keeps_every_panel_and_seam(pattern, share, level):
    try:
        image = encode(pattern, 16).without_marks()
    except EncodeError:
        reject()
    expected, _ = repair(image, level)
    assert repair(shares(image, share), level)[0].same_channels(expected)


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_drafts_that_a_network_is_sure_of_keep_every_panel(kind):
    for one in sample(kind, 3, 5, body=ANY_BODY):
        image = encode(one.pattern).without_marks()
        mended, _ = repair(shares(image, 0.99, noise=0.3, seed=one.index), kind="shares")
        assert mended.same_channels(image)


@given(st.integers(2, 5), st.integers(2, 5), st.floats(0.6, 0.95), st.floats(1.0, 5.0))
def test_surer_evidence_never_removes_more(row, col, share, factor):
    """A dress with a dart and one more wall: once all of it is believed, it stays so."""
    image = with_types(darted(), {(0, 0, row, col): SIDE_BY_SIDE})
    odds = 3 * share / (1 - share)
    less, more = (
        repair(shares(image, odds**scale / (odds**scale + 3)), kind="shares")[0]
        for scale in (1.0, factor)
    )
    expected, _ = repair(image)
    assert more.same_channels(expected) or not less.same_channels(expected)
    assert more.same_channels(expected) or np.log(odds) * factor < RARE_COST


@pytest.mark.parametrize("place", [0, 1, 8, 17, 20])
def test_one_outlier_does_not_change_what_the_numbers_are(place):
    channels = shares(DRESS, 0.999)
    channels[place, 0, 0] = -0.3
    mended, report = repair(channels)
    assert mended.same_channels(DRESS)
    assert (report.kind, report.is_guess) == ("shares", True)


@pytest.mark.parametrize(
    ("channels", "kind", "is_guess"),
    [
        (DRESS.to_channels(), "channels", False),
        (shares(DRESS, 0.8), "shares", True),
        (logits(DRESS, 3.0), "logits", True),
        (logits(DRESS, 0.5), "logits", True),
    ],
)
def test_what_the_numbers_are_is_guessed_from_all_of_them(channels, kind, is_guess):
    report = repair(channels)[1]
    assert (report.kind, report.is_guess) == (kind, is_guess)
    assert not repair(channels, kind=kind)[1].is_guess


@given(st.integers(0, 2**32 - 1), st.floats(0.02, 0.15))
def test_outputs_of_squared_errors_are_channels(seed, noise):
    rng = np.random.default_rng(seed)
    channels = DRESS.to_channels().astype(float)
    flags_and_types = np.arange(len(channels)) % CHANNELS_PER_LAYER < 9
    channels[flags_and_types] += rng.normal(0, noise, channels[flags_and_types].shape).clip(
        -0.4, 0.4
    )
    types = channels.reshape(2, CHANNELS_PER_LAYER, 8, 8)[:, 1:9].reshape(2, 2, 4, 8, 8)
    assume((types.argmax(axis=2) == DRESS.edge_type).all())
    for kind in (None, "channels"):
        assert repair(channels, kind=kind)[0].same_channels(DRESS)


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([0.05, 0.3, 1.0, 10.0]),
    st.sampled_from([None, *CHANNEL_KINDS]),
)
def test_from_channels_and_repair_see_the_same_image(seed, size, kind):
    channels = np.random.default_rng(seed).normal(0.3, size, (2 * CHANNELS_PER_LAYER, 6, 6))
    seen, _ = repair(channels, "none", kind=kind)
    assert seen.same_channels(GarmentImage.from_channels(channels, kind=kind))


def test_four_shares_of_zero_are_no_seam():
    channels = DRESS.to_channels().copy()
    channels[1:9, 0, 0] = 0
    for kind in (None, *CHANNEL_KINDS):
        assert repair(channels, "none", kind=kind)[0].same_channels(DRESS)


def test_unknown_kind_is_refused():
    with pytest.raises(Exception, match="odds"):
        repair(DRESS.to_channels(), kind="odds")


def test_lone_cell_goes_unless_a_network_is_sure_of_it():
    inside, deformation = DRESS.inside.copy(), DRESS.deformation.copy()
    inside[0, 7, 7], deformation[0, [0, 2], 0, 7, 7], deformation[0, [1, 3], 1, 7, 7] = True, 10, 10
    alone = with_types(
        replace(DRESS, inside=inside, deformation=deformation),
        {(0, 0, 7, 7): NON_STITCH, (0, 1, 7, 7): NON_STITCH},
    )
    for share, expected in ((0.7, DRESS), (0.99, alone)):
        is_doubted = alone.to_channels() != DRESS.to_channels()
        channels = np.where(is_doubted, shares(alone, share), DRESS.to_channels())
        assert repair(channels, kind="shares")[0].same_channels(expected)


def test_the_command_says_what_it_took_the_numbers_for(tmp_path, capsys):
    file, out = str(tmp_path / "soft.npy"), str(tmp_path / "out.json")
    np.save(file, shares(DRESS, 0.99))
    assert main(["decode", file, "-o", out]) == 0
    assert "read as shares; give --kind" in capsys.readouterr().err
    assert main(["decode", file, "-o", out, "--kind", "shares"]) == 0
    assert "--kind" not in capsys.readouterr().err
