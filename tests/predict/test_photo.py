"""Photographs: read whatever their format, refused in a sentence, brought into place."""

import numpy as np
import pytest
from PIL import Image

from garmentimage.errors import LearnError
from garmentimage.predict.photo import Box, Photo, framed, read_photo, wearer_mask

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
    with pytest.raises(LearnError, match=r"text\.png: is no picture that can be read"):
        read_photo(text)
    whole = saved(tmp_path, Image.fromarray(figure()), "whole.png").read_bytes()
    (tmp_path / "half.png").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(LearnError, match=r"half\.png: is no picture that can be read"):
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
    there = framed(Photo(figure(), ()), BOX, 100)
    assert wearer_mask(there.pixels)[10:90, 30:70].all()
    assert wearer_mask(there.pixels).sum() == 80 * 40


@pytest.mark.parametrize("colour", [(255, 255, 255), (90, 120, 90)])
@pytest.mark.parametrize(("dx", "dy", "grown"), [(0, 0, 2), (-40, 15, 1), (30, -10, 3)])
def test_a_wearer_elsewhere_is_brought_into_place_on_white(colour, dx, dy, grown):
    pixels = np.full((240 * grown, 300 * grown, 3), colour, np.uint8)
    top, left = (40 + dy) * grown, (100 + dx) * grown
    pixels[top : top + 160 * grown, left : left + 80 * grown] = (150, 40, 30)
    photo = framed(Photo(pixels, ()), BOX, 100)
    mask = wearer_mask(photo.pixels)
    at = np.argwhere(mask)
    assert np.abs(at.min(0) - (10, 30)).max() <= 1 and np.abs(at.max(0) - (89, 69)).max() <= 1
    assert (photo.pixels[0] == 255).all() and photo.notes == ()


def test_a_restless_background_is_told():
    noise = np.random.default_rng(0).integers(0, 256, (100, 150, 3)).astype(np.uint8)
    photo = framed(Photo(noise, ()), BOX, 64)
    assert photo.pixels.shape == (64, 64, 3) and "no plain background" in photo.notes[0]
    assert wearer_mask(np.full((40, 40, 3), 200, np.uint8)) is None
