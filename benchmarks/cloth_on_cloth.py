"""Garments with cloth on cloth: do they come back, and what is moved on them, moved?

    python benchmarks/cloth_on_cloth.py [-o RESULT.json] [--picture SHEET.png]

Thirty designs with lapels, collars, cuffs turned up, pockets, peplums and pleats are encoded with
the smallest grid that holds them. Each must come back the same, with marks and from the channels
alone. Then a pocket is moved by 3 cm across the panel beneath it and every pleat is pressed 3 cm
farther, and the change must come back: to 0.5 cm for pockets, to 1 cm for pleats.
"""

import argparse
import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from provenance import provenance
from tqdm import tqdm

import garmentimage as gi
from garmentimage.compare import compare_patterns
from garmentimage.geometry import centroid
from garmentimage.pattern.model import Pattern, SewnOnto

MOVED_CM = 3.0
POCKET_TOL_CM, PLEAT_TOL_CM = 0.5, 1.0
DESIGNS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("blazer", {}),
    ("blazer", {"lapel_shape": "shawl", "lapel_width": 8.0}),
    ("coat", {"lapel_shape": "shawl", "flare": 0.15}),
    ("coat", {"pockets": "none", "lapel_width": 6.0}),
    ("vest", {"collar": "none", "pocket_place": 1.0}),
    ("vest", {"lapel_width": 8.0, "body_length": 28.0}),
    ("blouse", {"pockets": "left", "cuffs": "band"}),
    ("blouse", {"collar_height": 4.0, "pocket_width": 9.0}),
    ("button-shirt", {}),
    ("button-shirt", {"cuffs": "turned-up", "sleeve_length": 0.5}),
    ("button-shirt", {"collar": "stand", "cuffs": "turned-up"}),
    ("polo-shirt", {}),
    ("polo-shirt", {"cuffs": "turned-up", "pockets": "both"}),
    ("turtleneck", {"cuffs": "turned-up"}),
    ("cargo-pants", {}),
    ("cargo-pants", {"leg_length": 0.6, "pocket_height": 18.0}),
    ("cargo-pants", {"pockets": "left", "leg_flare": 10.0}),
    ("pocket-skirt", {}),
    ("pocket-skirt", {"pocket_width": 16.0, "pocket_height": 18.0, "skirt_length": 0.7}),
    ("peplum-top", {}),
    ("peplum-top", {"peplum_flare": 0.9, "peplum_length": 20.0}),
    ("peplum-top", {"sleeves": "none", "peplum_flare": 0.0}),
    ("pleated-skirt", {"pleats": "knife"}),
    ("pleated-skirt", {"pleats": "box"}),
    ("pleated-skirt", {"pleats": "inverted"}),
    ("pleated-skirt", {"pleats": "knife", "pleats_a_side": 2, "pleat_depth": 3.0}),
    ("pleated-skirt", {"pleats": "box", "pleats_a_side": 2, "skirt_length": 0.8}),
    ("pleated-skirt", {"pleats": "inverted", "pleats_a_side": 2, "pleat_pressed": 0.5}),
    ("pleated-skirt", {"pleats": "knife", "waistband": "none", "pleat_pressed": 0.15}),
    ("pleated-skirt", {"pleats": "inverted", "waistband_depth": 8.0, "skirt_length": 0.4}),
)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-o", "--out", type=Path)
    parser.add_argument("--picture", type=Path, help="a sheet of all garments as they are worn")
    options = parser.parse_args()
    rows, worn = [], []
    for kind, parameters in tqdm(DESIGNS, disable=None, leave=False):
        pattern = gi.draft_pattern(kind, **parameters)
        rows.append({"kind": kind, "parameters": parameters, **judged(pattern)})
        if options.picture:
            worn.append(gi.photograph(gi.drape_pattern(pattern), view="turned", size=256).colour)
    result = {**provenance([]), "designs": len(rows), **totals(rows), "garments": rows}
    if options.out:
        options.out.write_text(json.dumps(result, indent=1) + "\n")
    if options.picture:
        lines = [np.concatenate(worn[k : k + 6], axis=1) for k in range(0, len(worn), 6)]
        gi.save_png(options.picture, np.concatenate(lines))
    print(
        json.dumps({name: value for name, value in result.items() if name != "garments"}, indent=1)
    )
    return 0


def judged(pattern: Pattern) -> dict[str, Any]:
    """What comes back of a garment, and of the same garment with things moved."""
    image = gi.encode(pattern)
    bare = gi.decode(image.to_channels())
    found: dict[str, Any] = {
        "grid": image.grid,
        "same": compare_patterns(pattern, gi.decode(image)).success,
        "same_from_channels": compare_patterns(pattern, bare, any_pose=True).success,
    }
    pockets = [sewn for sewn in pattern.onto if not _is_stitched(pattern, sewn)]
    if pockets:
        (x, y) = (MOVED_CM if pockets[0].offset[0] < 0 else -MOVED_CM), 0.0
        moved = replace(
            pattern,
            onto=tuple(
                replace(sewn, offset=(sewn.offset[0] + x, sewn.offset[1] + y))
                if sewn == pockets[0]
                else sewn
                for sewn in pattern.onto
            ),
        )
        before, after = (gi.decode(gi.encode(each)) for each in (pattern, moved))
        shift = _place(after, pockets[0].panel) - _place(before, pockets[0].panel)
        found["pocket_moved_cm"] = round(float(np.hypot(*shift)), 2)
    if pattern.pleats:
        farther = tuple(replace(p, pressed=p.pressed + MOVED_CM) for p in pattern.pleats)
        again = gi.decode(gi.encode(replace(pattern, pleats=farther)).to_channels())
        wanted = farther[0].pressed
        found["pressed_off_cm"] = round(max(abs(p.pressed - wanted) for p in again.pleats), 2)
        found["folds"] = sorted(p.fold for p in again.pleats) == sorted(p.fold for p in farther)
    return found


def _is_stitched(pattern: Pattern, sewn: SewnOnto) -> bool:
    """Whether what is sewn on is also stitched to others, as a peplum is."""
    return any(side.panel == sewn.panel for stitch in pattern.stitches for side in stitch.sides)


def _place(pattern: Pattern, name: str) -> np.ndarray:
    """The middle of a pocket on the panel beneath [cm]."""
    sewn = next(each for each in pattern.onto if each.panel == name)
    return sewn.carried(centroid(pattern.by_name[name].outline.fine_polygon)[None])[0]


def totals(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """How many garments come back as they should."""
    pockets = [abs(row["pocket_moved_cm"] - MOVED_CM) for row in rows if "pocket_moved_cm" in row]
    pleats = [row for row in rows if "folds" in row]
    return {
        "same": sum(row["same"] for row in rows),
        "same_from_channels": sum(row["same_from_channels"] for row in rows),
        "largest_grid": max(row["grid"] for row in rows),
        "pockets_moved": f"{sum(off <= POCKET_TOL_CM for off in pockets)} of {len(pockets)}",
        "pleats_pressed_farther": "{} of {}".format(
            sum(row["folds"] and row["pressed_off_cm"] <= PLEAT_TOL_CM for row in pleats),
            len(pleats),
        ),
    }


if __name__ == "__main__":
    sys.exit(main())
