"""Figures: interpolations and edits in latent spaces, and predictions from pictures."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import UInt8

from garmentimage.dataset import parse_patterns
from garmentimage.evaluate.codecs import Codec
from garmentimage.evaluate.edit_triplets import Triplet
from garmentimage.evaluate.predictors import Predictor, load_predictor
from garmentimage.latent import edit
from garmentimage.networks import DecodedGarment, draped_frame, side_by_side, strip
from garmentimage.pattern import Pattern

if TYPE_CHECKING:
    from garmentimage.evaluate.text import EditMethod
    from garmentimage.learn.data import ImageSplit

FIGURE_PROMPTS = ("long", "short sleeves", "dress", "pants")
"""Each is applied to the first garment of which it is not true, to another one if possible."""


def interpolation_picture(
    codecs: Mapping[str, Codec], a: Pattern, b: Pattern, steps: int
) -> UInt8[np.ndarray, "row col 3"]:
    """Interpolations between two garments, a row for each codec."""
    rows = []
    for name, codec in codecs.items():
        start, end = codec.latents([a, b])
        shares = np.linspace(0, 1, steps)
        titles = [f"{name}: 0/{steps - 1}", *(f"{k}/{steps - 1}" for k in range(1, steps))]
        latents = [start + share * (end - start) for share in shares]
        rows.append(
            strip([draped_frame(t, codec.decode(z)) for t, z in zip(titles, latents, strict=True)])
        )
    return np.concatenate(rows)


def edit_picture(codecs: Mapping[str, Codec], triplet: Triplet) -> UInt8[np.ndarray, "row col 3"]:
    """A, B, C, C + (B - A), and the true result, a row for each codec."""
    rows = []
    for name, codec in codecs.items():
        a, b, c = codec.latents([triplet.a, triplet.b, triplet.c])
        edited = edit(codec, a, b, c)
        columns = [
            draped_frame(title, codec.decode(z))
            for title, z in {f"{name}: A": a, "B": b, "C": c}.items()
        ]
        columns.append(draped_frame(edited.title, edited.garment))
        rows.append(
            strip(
                [*columns, draped_frame("wanted", DecodedGarment(a, None, None, triplet.truth, ()))]
            )
        )
    return np.concatenate(rows)


def predictions_picture(
    predictors: Sequence[Predictor],
    data: str,
    held_out: str,
    album: "ImageSplit",
    numbers: Sequence[int],
) -> UInt8[np.ndarray, "row col 3"]:
    """For some garments the picture, the true pattern and each prediction."""
    truths = parse_patterns([album.patterns[number] for number in numbers], data)
    rows = []
    for number, truth in zip(numbers, truths, strict=True):
        columns = [draped_frame(f"truth: {album.types[number]}", _step(truth, ""))]
        for predictor in predictors:
            guess = load_predictor(predictor, data, held_out)(album, number)
            columns.append(draped_frame(predictor.name, _step(guess.pattern, guess.fault)))
        upright = album.garments.pictures[number].numpy()[:, ::-1].transpose(1, 2, 0)
        rows.append(side_by_side(np.ascontiguousarray(upright), strip(columns)))
    return np.concatenate(rows)


def text_edits_picture(
    editors: "Sequence[EditMethod]", split: str
) -> UInt8[np.ndarray, "row col 3"]:
    """The figure of the paper: four garments and prompts, and the result of each method."""
    from garmentimage.evaluate.text import applicable_prompts, apply_edit, held_out_garments

    known = held_out_garments(editors[0].data, split)
    asked = applicable_prompts(known)
    rows: list[np.ndarray] = []
    used: set[int] = set()
    for prompt in FIGURE_PROMPTS:
        numbers = [k for k, other in asked if other.text == prompt]
        if not numbers:
            continue
        number = next((k for k in numbers if k not in used), numbers[0])
        used.add(number)
        start = known[number]
        columns = [draped_frame("as given", _step(start, ""))]
        columns += [
            draped_frame(f"{prompt}: {editor.kind}", _step(*apply_edit(editor, start, prompt)))
            for editor in editors
            if editor.kind in ("raster", "vectors")
        ]
        rows.append(strip(columns))
    return np.concatenate(rows)


def _step(pattern: Pattern | None, fault: str) -> DecodedGarment:
    return DecodedGarment(np.zeros(0, np.float32), None, None, pattern, (fault,) if fault else ())
