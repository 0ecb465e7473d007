"""Encode and decode the bundled patterns, draw each way, and say what was made and where."""

import sys
from pathlib import Path
from time import perf_counter

import garmentimage as gi
from garmentimage.examples import example_names, example_path
from garmentimage.metrics import judge
from garmentimage.render.flat import seam_numbers
from garmentimage.render.show import show

GRID = 16


def main(folder: Path) -> int:
    """Make the files of every example in `folder`; 1 where a pattern does not come back."""
    folder.mkdir(parents=True, exist_ok=True)
    print("Compiling, the first time only: about a minute of one core ...", flush=True)
    start = perf_counter()
    gi.decode(gi.encode(gi.load_pattern(example_path(example_names()[0])), grid=GRID))
    print(f"Ready after {perf_counter() - start:.0f} s.")
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
        result = judge(pattern, again)
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
            f"  {folder / name}.png           the way there and back, drawn"
        )
    print("\nImages keep no notches and no names of edges: docs/formats.md says what else.")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
