"""A bundled picture to a pattern and its drape; bundled patterns to images and back; all drawn."""

import io
import sys
from concurrent.futures import ProcessPoolExecutor
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import garmentimage as gi
from garmentimage.cli.app import main as run
from garmentimage.compare import compare_patterns
from garmentimage.examples import example_names, example_path, example_picture
from garmentimage.render.flat.drawing import seam_numbers
from garmentimage.render.showing import show

GRID = 16
WORN = ("dress", "trousers")
PICTURE = 680
"""Rows of the picture of a worn garment [pixel] ..."""
SIDE_SHARE = 0.14
"""... of which this share is cut off at each side: beyond the hands there is nothing."""


def main(folder: Path) -> int:
    """Make the files of every example in `folder`; 1 where a pattern does not come back."""
    folder.mkdir(parents=True, exist_ok=True)
    print("Compiling, the first time only: about a minute ...", flush=True)
    # Draping compiles other code than encoding, so both are done at once.
    with ProcessPoolExecutor(1) as other:
        found = other.submit(predict, folder)
        worn = {name: other.submit(wear, name, folder) for name in WORN}
        printed = io.StringIO()
        with redirect_stdout(printed):
            failed = encode_and_decode(folder)
        print(found.result(), printed.getvalue(), sep="\n")
        for name, pictures in worn.items():
            draw_worn(name, pictures.result(), folder)
    print(
        "\nImages keep no notches and no names of edges: docs/reference/formats.md says what else."
    )
    return int(failed > 0)


def predict(folder: Path) -> str:
    """The pattern of the garment in the bundled picture; what was printed."""
    picture, printed = example_picture(), io.StringIO()
    with redirect_stdout(printed):
        failed = run(["predict", str(picture), "-o", str(folder)])
    if failed:
        raise SystemExit(failed)
    name = folder / picture.stem
    return (
        f"\nFrom the picture {picture.name} to a pattern: {printed.getvalue().strip()}\n"
        f"  {name}.json  the pattern that the network found in the picture\n"
        f"  {name}.glb   that pattern, draped\n"
        f"  {name}.png   picture, pattern, GarmentImage and drape beside each other"
    )


def encode_and_decode(folder: Path) -> int:
    """Encode and decode the bundled patterns and draw each way; how many do not come back."""
    failed = 0
    for name in example_names():
        pattern = gi.load_pattern(example_path(name))
        image = gi.encode(pattern, grid=GRID)
        gi.save_image(image, folder / f"{name}.npz")
        again = gi.decode(gi.load_image(folder / f"{name}.npz"))
        gi.save_pattern(again, folder / f"{name}-decoded.json")
        show(
            pattern,
            image,
            again,
            out=folder / f"{name}.png",
            titles=(f"{name}, sewing pattern", f"GarmentImage, {GRID} x {GRID}", "decoded pattern"),
            steps=("encode", "decode"),
        )
        result = compare_patterns(pattern, again)
        failed += not result.success
        verdict = (
            "the same panels and seams came back, boundaries within "
            f"{10 * result.boundary_gap:.1f} mm"
            if result.success
            else "; ".join(result.reasons)
        )
        print(
            f"\n{name}: {len(pattern.panels)} panels ({len(pattern.stitches)} stitches, "
            f"{len(set(seam_numbers(pattern).values()))} seams) on {int(image.inside.sum())} "
            f"cells; {verdict} "
            f"(mean panel IoU {sum(result.iou.values()) / len(result.iou):.3f})\n"
            f"  {folder / name}.npz           the GarmentImage\n"
            f"  {folder / name}-decoded.json  the pattern in it, as GarmentCode writes it\n"
            f"  {folder / name}.png           the round trip, drawn"
        )
    return failed


@dataclass(frozen=True)
class WornPictures:
    """Photographs of a draped example, and whether it is at rest."""

    front: np.ndarray
    back: np.ndarray
    verdict: str


def wear(name: str, folder: Path) -> WornPictures:
    """Drape a bundled pattern, save it and photograph it."""
    worn = gi.drape_pattern(gi.load_pattern(example_path(name)), "auto")  # the body that it fits
    gi.save_drape(folder / f"{name}.glb", worn)
    cut = int(SIDE_SHARE * PICTURE)
    front, back = (
        gi.photograph(worn, view=view, size=PICTURE).colour[:, cut:-cut]
        for view in ("front", "back")
    )
    report = worn.report
    verdict = "; ".join(report.faults) or (
        f"at rest after {report.frames} frames, 99 % of the cloth stretched by less than "
        f"{report.strain:.0%}"
    )
    return WornPictures(front, back, f"{name} on {worn.body.name}: {verdict}")


def draw_worn(name: str, pictures: WornPictures, folder: Path) -> None:
    """Draw pattern, raster and pictures beside each other, and say how it went."""
    show(
        gi.load_pattern(example_path(name)),
        gi.load_image(folder / f"{name}.npz"),
        pictures.front,
        pictures.back,
        out=folder / f"{name}-worn.png",
        titles=(f"{name}, sewing pattern", f"GarmentImage, {GRID} x {GRID}", "worn", "from behind"),
    )
    print(
        f"\n{pictures.verdict}\n"
        f"  {folder / name}.glb       the garment on its body, for any 3D program\n"
        f"  {folder / name}-worn.png  pattern, GarmentImage and how it is worn"
    )


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
