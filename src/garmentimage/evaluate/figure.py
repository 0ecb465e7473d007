"""Figures: interpolations and edits in latent spaces, and predictions from pictures."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import UInt8

from garmentimage.dataset import parse_patterns
from garmentimage.evaluate.amounts import ImageAmounts, LatentAmounts
from garmentimage.evaluate.codecs import Codec
from garmentimage.evaluate.edit_triplets import Triplet
from garmentimage.evaluate.image import SPLIT_NAMES, has_unseen, load_garments, measuring_order
from garmentimage.evaluate.latent import (
    INTERPOLATION_STEPS,
    Candidate,
    draw_pairs,
    draw_triplets,
    load_codec,
)
from garmentimage.evaluate.predictors import TEACHER_STAGES, Predictor, load_predictor
from garmentimage.latent import edit
from garmentimage.networks import DecodedGarment, draped_frame, side_by_side, strip
from garmentimage.pattern import Pattern
from garmentimage.render import png_bytes
from garmentimage.system import write_atomically

if TYPE_CHECKING:
    from garmentimage.evaluate.text import EditMethod
    from garmentimage.learn.data import ImageSplit

MAX_SHOWN = 3
"""Garments of each split in the figures of predictions."""
FIGURE_PROMPTS = ("long", "short sleeves", "dress", "pants")
"""Each is applied to the first garment of which it is not true, to another one if possible."""


# --- Latent spaces --------------------------------------------------------------------------------


def draw_latent_figures(
    folder: Path, networks: Sequence[Candidate], recipe: str, amounts: LatentAmounts
) -> None:
    """Draw the first pair across types, and the first triplet of each edit, by each network."""
    codecs = {
        each.name.removesuffix(", full"): load_codec(each)
        for each in networks
        if each.level in ("full", None)
    }
    a, b, _ = draw_pairs(networks[0].data, amounts.pairs)[min(1, amounts.pairs - 1)]
    _write(folder / "interpolation.png", _interpolation(codecs, a, b))
    drawn = set()
    for triplet in draw_triplets(recipe, amounts.triplets):
        name = triplet.edit.name
        if name not in drawn:
            drawn.add(name)
            file = f"edit-{name.replace(' + ', ' ').replace(' ', '-')}.png"
            _write(folder / file, _edit(codecs, triplet))


def _interpolation(
    codecs: Mapping[str, Codec], a: Pattern, b: Pattern
) -> UInt8[np.ndarray, "row col 3"]:
    """Interpolations between two garments, a row for each codec."""
    rows, last = [], INTERPOLATION_STEPS - 1
    for name, codec in codecs.items():
        start, end = codec.latents([a, b])
        rows.append(
            strip(
                [
                    draped_frame(f"{k}/{last}" if k else f"{name}: 0/{last}", codec.decode(z))
                    for k, z in enumerate(
                        start + np.linspace(0, 1, last + 1)[:, None] * (end - start)
                    )
                ]
            )
        )
    return np.concatenate(rows)


def _edit(codecs: Mapping[str, Codec], triplet: Triplet) -> UInt8[np.ndarray, "row col 3"]:
    """A, B, C, C + (B - A), and the true result, a row for each codec."""
    rows = []
    for name, codec in codecs.items():
        a, b, c = codec.latents([triplet.a, triplet.b, triplet.c])
        edited = edit(codec, a, b, c)
        given = {f"{name}: A": a, "B": b, "C": c}
        columns = [draped_frame(title, codec.decode(z)) for title, z in given.items()]
        columns.append(draped_frame(edited.title, edited.garment))
        rows.append(strip([*columns, draped_frame("wanted", _step(triplet.truth, ""))]))
    return np.concatenate(rows)


# --- Predictions ----------------------------------------------------------------------------------


def draw_prediction_figures(
    folder: Path,
    predictors: Sequence[Predictor],
    data: str,
    held_out: str,
    amounts: ImageAmounts,
) -> None:
    """Draw some of the measured garments, of each split and all types, predicted by one cascade."""
    chosen: dict[str, Predictor] = {}
    for each in predictors:
        if each.level == "full" and each.kind not in (*TEACHER_STAGES, "random"):
            chosen.setdefault(each.kind if each.kind == "cascade" else each.name, each)
    for split, name in SPLIT_NAMES.items():
        if split == "unseen" and not has_unseen(data, held_out):
            continue
        garments, _ = load_garments(data, split, held_out)
        # Types in turn: of each the first, then of each the second, and so on.
        counts: Counter[str] = Counter()
        turns = []
        for number in measuring_order(garments)[: amounts.of(split)]:
            turns.append((counts[garments.types[number]], number))
            counts[garments.types[number]] += 1
        turns.sort(key=lambda turn: turn[0])
        numbers = [number for _, number in turns[:MAX_SHOWN]]
        if numbers:
            picture = _predictions(list(chosen.values()), data, held_out, garments, numbers)
            _write(folder / f"{name}.png", picture)


def _predictions(
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


# --- Edits by text --------------------------------------------------------------------------------


def draw_text_edits(folder: Path, editors: "Sequence[EditMethod]", split: str) -> None:
    """Draw the figure of the paper: four garments and prompts, and the result of each method."""
    from garmentimage.evaluate.text import applicable_prompts, apply_edit, held_out_garments

    known = held_out_garments(editors[0].data, split)
    applicable = applicable_prompts(known)
    rows: list[np.ndarray] = []
    used: set[int] = set()
    for prompt in FIGURE_PROMPTS:
        numbers = [k for k, other in applicable if other.text == prompt]
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
    _write(folder / "edits.png", np.concatenate(rows))


def _step(pattern: Pattern | None, fault: str) -> DecodedGarment:
    return DecodedGarment(np.zeros(0, np.float32), None, None, pattern, (fault,) if fault else ())


def _write(file: Path, picture: UInt8[np.ndarray, "row col 3"]) -> None:
    write_atomically(file, png_bytes(picture))
