"""Figures of exploration: the same ways through both networks' spaces, one over the other."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import UInt8

from garmentimage.evaluate.codecs import Codec
from garmentimage.evaluate.edits import Triplet
from garmentimage.explore.space import Step
from garmentimage.explore.strip import shown, strip
from garmentimage.explore.walk import edit
from garmentimage.pattern.model import Pattern


def way_picture(
    codecs: Mapping[str, Codec], a: Pattern, b: Pattern, steps: int
) -> UInt8[np.ndarray, "row col 3"]:
    """The way from one garment to another through each space."""
    rows = []
    for name, codec in codecs.items():
        start, end = codec.latents([a, b])
        shares = np.linspace(0, 1, steps)
        titles = [f"{name}: 0/{steps - 1}", *(f"{k}/{steps - 1}" for k in range(1, steps))]
        latents = [start + share * (end - start) for share in shares]
        rows.append(strip([shown(t, codec.step(z)) for t, z in zip(titles, latents)]))
    return np.concatenate(rows)


def edit_picture(codecs: Mapping[str, Codec], triplet: Triplet) -> UInt8[np.ndarray, "row col 3"]:
    """A, B, C, C + (B - A), and what it should be, through each space."""
    rows = []
    for name, codec in codecs.items():
        a, b, c = codec.latents([triplet.a, triplet.b, triplet.c])
        edited = edit(codec, a, b, c)
        columns = [
            shown(title, codec.step(z)) for title, z in {f"{name}: A": a, "B": b, "C": c}.items()
        ]
        columns.append(shown(edited.title, edited.step))
        rows.append(strip([*columns, shown("wanted", Step(a, None, None, triplet.truth, ()))]))
    return np.concatenate(rows)
