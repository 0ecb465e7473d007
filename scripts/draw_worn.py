"""Draw garments of every kind on bodies, front and back, for the README.

python scripts/draw_worn.py [OUT.png]
"""

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

import garmentimage as gi
from garmentimage.body.stance import wearer
from garmentimage.drape.outfits import outfit
from garmentimage.render.png import contact_sheet
from garmentimage.render.worn.background import gradient
from garmentimage.render.worn.prints import Print, checks, dots, stripes
from garmentimage.render.worn.tint import Tint

OUT = Path(__file__).parents[1] / "docs" / "worn.png"
SIZE = 400
"""Rows of one picture [pixel]."""
VERTICES = 2000
"""Of a garment."""
CUT = 0.15
"""Share of a picture that is cut off at each side: nothing is there."""
BACKDROP = gradient("#f4f1ec", "#dcd7cf")


@dataclass(frozen=True)
class Outfit:
    """What one wearer wears: drafted kinds with what differs from their defaults."""

    label: str
    body: str
    kinds: Mapping[str, Mapping[str, float | str]]
    colours: Mapping[str, Tint]
    skin: Tint
    prints: Mapping[str, Print] = field(default_factory=dict)


OUTFITS = (
    Outfit(
        "tee, trousers",
        "mean-male",
        {"tee": {}, "pants": {"leg_flare": 0.0}},
        {"bottom": "#39424f"},
        "#a06d4b",
        {"top": stripes("#f3efe6", "#2c4a6e", period=5.0, along=False)},
    ),
    Outfit(
        "one-panel dress",
        "mean-female",
        {"one-panel-dress": {"flare": 0.3, "body_length": 55.0}},
        {},
        "#e8c4a6",
        {"dress": dots("#8d2f3c", "#f6ece0", period=5.0)},
    ),
    Outfit(
        "top with skirt",
        "tall-slim-female",
        {"top-skirt": {"skirt_flare": 0.5, "skirt_length": 0.7, "neckline": "v"}},
        {"top": "#31584a", "dress": "#31584a", "bottom": "#31584a"},
        "#5a3825",
    ),
    Outfit(
        "hoodie, trousers",
        "tall-slim-male",
        {"hoodie": {}, "pants": {}},
        {"top": "#c9a24b", "bottom": "#4b4a52"},
        "#f3d8c4",
    ),
    Outfit(
        "tank, skirt",
        "short-round-female",
        {"tank": {}, "skirt": {"skirt_flare": 0.4, "skirt_length": 0.7}},
        {"top": "#e9e4da"},
        "#7d5138",
        {"bottom": checks("#51617a", "#dfe3e6", period=7.0)},
    ),
    Outfit(
        "jumpsuit",
        "mean-female",
        {"one-panel-jumpsuit": {"leg_flare": 0.15}},
        {"dress": "#3f5f86"},
        "#c08d68",
    ),
)


def pictures(one: Outfit) -> list[UInt8[np.ndarray, "row col 3"]]:
    """An outfit from the front and from behind."""
    body = wearer(one.body)
    garments = [gi.draft_pattern(kind, one.body, **given) for kind, given in one.kinds.items()]
    worn = gi.drape_pattern(outfit(garments, body), body, vertices=VERTICES * len(garments))
    gi.check_drape(worn)
    look = gi.Look(
        skin=one.skin, colours=one.colours, prints=one.prints, background=BACKDROP, elevation=0.05
    )
    cut = int(CUT * SIZE)
    return [
        gi.photograph(worn, look, view=view, size=SIZE).colour[:, cut:-cut]
        for view in ("turned", "back")
    ]


def main(out: Path) -> None:
    """Draw all outfits: a row of fronts, and below it their backs."""
    made = [pictures(one) for one in OUTFITS]
    fronts, backs = zip(*made, strict=True)
    labels = [one.label for one in OUTFITS] + [""] * len(OUTFITS)
    gi.save_png(out, contact_sheet([*fronts, *backs], labels, columns=len(OUTFITS)))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else OUT)
