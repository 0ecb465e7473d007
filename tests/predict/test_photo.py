"""Photographs: read whatever their format, refused in a sentence, brought into place."""

import os

import numpy as np
import pytest
from PIL import Image

from garmentimage.errors import LearnError
from garmentimage.predict.photo import Box, Photo, as_photo, find_wearer, frame_photo, read_photo

BOX = Box(0.1, 0.9, 0.3, 0.7)


def figure(rows=200, cols=200, top=20, bottom=180, left=60, right=140, colour=(150, 40, 30)):
    """Someone of one colour on white."""
    pixels = np.full((rows, cols, 3), 255, np.uint8)
    pixels[top:bottom, left:right] = colour
    return pixels


def saved(folder, image, name="photo.png", **how):
    image.save(folder / name, **how)
    return folder / name


def test_a_picture_comes_as_it_is(tmp_path):
    pixels = figure()
    photo = read_photo(saved(tmp_path, Image.fromarray(pixels)))
    assert np.array_equal(photo.pixels, pixels) and photo.notes == ()


def test_clear_pixels_are_white(tmp_path):
    clear = np.zeros((64, 64, 4), np.uint8)
    clear[20:40, 20:40] = (200, 10, 10, 255)
    photo = read_photo(saved(tmp_path, Image.fromarray(clear)))
    assert (photo.pixels[0, 0] == 255).all() and tuple(photo.pixels[30, 30]) == (200, 10, 10)


def test_other_depths_and_colours_are_converted_and_told(tmp_path):
    levels = np.linspace(0, 65535, 64 * 64).reshape(64, 64).astype(np.uint16)
    photo = read_photo(saved(tmp_path, Image.fromarray(levels), "deep.png"))
    assert photo.pixels.min() == 0 and photo.pixels.max() == 255
    assert "more than 8 bits" in photo.notes[0]
    grey = Image.fromarray(figure()[..., 0].astype(np.uint16) * 257)
    photo = read_photo(saved(tmp_path, grey, "deep-grey.png"))
    assert np.array_equal(photo.pixels[..., 0], figure()[..., 0])
    ink = Image.new("CMYK", (64, 64), (0, 255, 255, 0))
    photo = read_photo(saved(tmp_path, ink, "ink.jpg"))
    red, green, blue = photo.pixels[32, 32].tolist()
    assert red > 150 > green and red > 150 > blue and "CMYK" in photo.notes[0]


def test_a_turned_photograph_stands_upright(tmp_path):
    image = Image.fromarray(figure(rows=120, cols=240, top=10, bottom=30, left=10, right=30))
    mark = Image.Exif()
    mark[0x0112] = 6  # turned by a quarter
    photo = read_photo(saved(tmp_path, image, "turned.png", exif=mark))
    assert photo.pixels.shape == (240, 120, 3) and photo.pixels[20, 100, 1] < 100


def test_what_is_no_picture_is_told_in_a_sentence(tmp_path):
    text = tmp_path / "text.png"
    text.write_text("no picture")
    with pytest.raises(LearnError, match=r"text\.png: is not a picture that can be read"):
        read_photo(text)
    whole = saved(tmp_path, Image.fromarray(figure()), "whole.png").read_bytes()
    (tmp_path / "half.png").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(LearnError, match=r"half\.png: is damaged or cut short"):
        read_photo(tmp_path / "half.png")
    with pytest.raises(LearnError, match=r"dot\.png: has 1 x 1 pixels; give 32 a side"):
        read_photo(saved(tmp_path, Image.new("RGB", (1, 1)), "dot.png"))
    frames = [Image.new("RGB", (64, 64), colour) for colour in ("red", "blue")]
    moving = saved(
        tmp_path, frames[0], "moving.gif", save_all=True, append_images=frames[1:], duration=100
    )
    with pytest.raises(LearnError, match=r"moving\.gif: is animated, 2 pictures"):
        read_photo(moving)
    bomb = saved(tmp_path, Image.new("1", (20_000, 20_000)), "bomb.png")
    with pytest.raises(LearnError, match=r"bomb\.png: has too many pixels"):
        read_photo(bomb)
    with pytest.raises(LearnError, match=r"nowhere\.png: cannot be read \(No such file"):
        read_photo(tmp_path / "nowhere.png")
    with pytest.raises(LearnError, match=r"cannot be read \(Is a directory\)"):
        read_photo(tmp_path)


def test_a_wearer_in_place_stays_there():
    there = frame_photo(Photo(figure(), ()), BOX, 100)
    mask, note = find_wearer(there.pixels)
    assert mask[10:90, 30:70].all() and mask.sum() == 80 * 40 and not note


@pytest.mark.parametrize("colour", [(255, 255, 255), (90, 120, 90)])
@pytest.mark.parametrize(("dx", "dy", "grown"), [(0, 0, 2), (-40, 15, 1), (30, -10, 3)])
def test_a_wearer_elsewhere_is_brought_into_place_on_white(colour, dx, dy, grown):
    pixels = np.full((240 * grown, 300 * grown, 3), colour, np.uint8)
    top, left = (40 + dy) * grown, (100 + dx) * grown
    pixels[top : top + 160 * grown, left : left + 80 * grown] = (150, 40, 30)
    photo = frame_photo(Photo(pixels, ()), BOX, 100)
    mask, _ = find_wearer(photo.pixels)
    at = np.argwhere(mask)
    assert np.abs(at.min(0) - (10, 30)).max() <= 1 and np.abs(at.max(0) - (89, 69)).max() <= 1
    assert (photo.pixels[0] == 255).all() and photo.notes == ()


def test_a_restless_background_is_told():
    noise = np.random.default_rng(0).integers(0, 256, (100, 150, 3)).astype(np.uint8)
    photo = frame_photo(Photo(noise, ()), BOX, 64)
    assert photo.pixels.shape == (64, 64, 3) and "no plain background" in photo.notes[0]


def test_an_empty_picture_is_told_and_so_is_a_speck():
    page = np.full((100, 100, 3), 200, np.uint8)
    assert find_wearer(page) == (None, "shows nothing in front of its background")
    page[50, 50] = 0
    assert find_wearer(page) == (None, "shows nothing in front of its background")


@pytest.mark.parametrize("blur", [0, 1])
def test_a_thin_frame_round_a_photograph_is_cut_off(blur):
    pixels = figure()
    for side in (slice(0, 3), slice(-3, None)):
        pixels[side], pixels[:, side] = 20, 20
    if blur:
        for at in (3, -4):
            pixels[at, 3:-3], pixels[3:-3, at] = 130, 130
    mask, note = find_wearer(frame_photo(Photo(pixels, ()), BOX, 100).pixels)
    at = np.argwhere(mask)
    assert np.abs(at.min(0) - (10, 30)).max() <= 2 and np.abs(at.max(0) - (89, 69)).max() <= 2
    assert not note


def test_of_two_figures_the_larger_is_taken_and_that_is_told():
    two = np.hstack([figure(), figure(top=40)])
    mask, note = find_wearer(two)
    assert mask[:, :200].any() and not mask[:, 200:].any() and "more than one figure" in note


@pytest.mark.wrong_types
def test_pixels_and_images_will_do_and_other_values_are_refused():
    pixels = figure()
    for picture in (pixels, Image.fromarray(pixels), Photo(pixels, ())):
        assert np.array_equal(as_photo(picture).pixels, pixels)
    for wrong in (pixels / 255.0, pixels[..., 0], pixels.transpose(2, 0, 1), Photo([], ())):
        with pytest.raises(TypeError, match="wanted"):
            as_photo(wrong)
    for wrong in (None, b"photo.png", 3):
        with pytest.raises(TypeError, match="wanted a path, pixels or an image"):
            as_photo(wrong)
    with pytest.raises(LearnError, match="the picture: has 4 x 4 pixels"):
        as_photo(pixels[:4, :4])


def test_a_large_photograph_is_made_smaller():
    large = as_photo(figure().repeat(15, 0).repeat(15, 1))
    assert large.pixels.shape == (2048, 2048, 3)
    mask, _ = find_wearer(large.pixels)
    assert mask.mean() == pytest.approx(160 * 80 / 200**2, rel=0.01)


def test_a_picture_of_a_phone_with_a_second_one_in_it_is_read(tmp_path):
    first, second = Image.fromarray(figure()), Image.new("RGB", (200, 200))
    photo = read_photo(
        saved(tmp_path, first, "phone.jpg", format="MPO", save_all=True, append_images=[second])
    )
    assert np.abs(photo.pixels.astype(int) - figure()).mean() < 3


def test_a_strip_is_too_thin_to_show_someone(tmp_path):
    with pytest.raises(LearnError, match=r"strip\.png: has 32 x 1000 pixels, too thin"):
        read_photo(saved(tmp_path, Image.new("RGB", (32, 1000)), "strip.png"))


def test_a_file_that_never_ends_is_refused(tmp_path):
    os.mkfifo(tmp_path / "pipe.png")
    with pytest.raises(LearnError, match=r"pipe\.png: is not an ordinary file"):
        read_photo(tmp_path / "pipe.png")


@pytest.mark.parametrize(
    "sides",
    [(0.1, 0.1, 0.0, 1.0), (0.9, 0.1, 0.0, 1.0), (0.0, float("nan"), 0.0, 1.0), (0.0, 1.5, 0, 1)],
)
def test_a_box_that_is_none_is_refused(sides):
    with pytest.raises(ValueError, match="a box from"):
        Box(*sides)
