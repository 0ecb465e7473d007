"""The verb of the command line that makes patterns of pictures: predict."""

import argparse
import sys
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.explore_commands import make_folder
from garmentimage.files import safe_name, shown_path, write_together
from garmentimage.terminal import Exit, list_facts, one_line, print_json

if TYPE_CHECKING:
    import numpy as np

    from garmentimage.explore.strip import Shown
    from garmentimage.predict.network import Prediction


def predict_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `predict`."""
    parser.add_argument(
        "images", nargs="+", type=Path, metavar="IMAGE", help="someone from the front, PNG or JPEG"
    )
    parser.add_argument(
        "-o", "--out", type=Path, required=True, metavar="FOLDER", help="where results go"
    )
    parser.add_argument("--network", metavar="NAME", help="a network or its folder (image-wide)")


def run_predict(options: argparse.Namespace) -> Exit:
    """The pattern of the garment in each picture."""
    from tqdm import tqdm

    from garmentimage.explore.strip import shown
    from garmentimage.predict.network import DEFAULT, PatternPredictor

    make_folder(options.out)
    network = PatternPredictor.load(options.network or DEFAULT)
    told: list[dict[str, Any]] = []
    for path in tqdm(options.images, unit="picture", disable=None, file=sys.stderr):
        prediction = network.predict(path)
        worn = shown(path.name, prediction.step)
        name = _free_name(path, [each["name"] for each in told])
        _put(options.out / name, prediction, worn)
        told.append(_facts(name, prediction, worn))
        if not options.json:
            print(_sentence(options.out, told[-1]))
    if options.json:
        print_json({"out": str(options.out), "garments": told})
    return Exit.OK


def _free_name(path: Path, taken: list[str]) -> str:
    """The picture's own name, numbered where two pictures have the same."""
    name, number = safe_name(path.stem), 2
    while name in taken:
        name, number = safe_name(f"{path.stem}-{number}"), number + 1
    return name


def _put(path: Path, prediction: "Prediction", worn: "Shown") -> None:
    from garmentimage.drape.export import worn_bytes
    from garmentimage.pattern.spec import pattern_text
    from garmentimage.raster.files import image_bytes
    from garmentimage.render.png import png_bytes

    step = prediction.step
    assert step.image is not None  # it is made of one
    results: dict[str | PathLike[str], bytes | str] = {
        f"{path}.npz": image_bytes(step.image),
        f"{path}.png": png_bytes(_picture(prediction, worn)),
    }
    if step.pattern is not None:
        results[f"{path}.json"] = pattern_text(step.pattern)
    if worn.worn is not None:
        results[f"{path}.glb"] = worn_bytes(worn.worn, ".glb")
    write_together(results)


def _picture(prediction: "Prediction", worn: "Shown") -> "np.ndarray":
    """What the network saw and where it doubts, beside pattern, raster and drape."""
    from garmentimage.explore.strip import beside, strip

    return beside(prediction.photo.pixels, strip([worn]), prediction.doubts)


def _facts(name: str, prediction: "Prediction", worn: "Shown") -> dict[str, Any]:
    step = prediction.step
    return {
        "name": name,
        "panels": len(step.pattern.panels) if step.pattern else 0,
        "confidence": round(prediction.confidence, 3),
        "sure": prediction.is_sure,
        "notes": list(prediction.photo.notes),
        "repairs": dict(step.repairs.counts) if step.repairs else {},
        "faults": [one_line(fault) for fault in worn.faults],
    }


def _sentence(out: Path, told: dict[str, Any]) -> str:
    sure = "" if told["sure"] else "LOW "
    parts = [f"{told['panels']} panels, {sure}confidence {told['confidence']:.2f}"]
    repairs = {rule: count for rule, count in told["repairs"].items() if count}
    parts += [f"repaired: {list_facts(repairs)}"] if repairs else []
    parts += [f"the picture {note}" for note in told["notes"]]
    if told["faults"]:
        parts.append(f"NOT a garment that can be worn: {'; '.join(told['faults'])}")
    return f"{shown_path(out / told['name'])}: {'; '.join(parts)}"
