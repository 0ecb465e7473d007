"""The verb of the command line that makes patterns of pictures: predict."""

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.cli.latent import check_folder, make_folder
from garmentimage.cli.terminal import Exit, error_facts, list_facts, one_line, print_json
from garmentimage.errors import LearnError
from garmentimage.system import check_output, safe_name, shown_path, write_together

if TYPE_CHECKING:
    from garmentimage.networks import StripFrame
    from garmentimage.predict import Prediction

SUFFIXES = (".json", ".npz", ".glb", ".png")


def predict_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `predict`."""
    parser.add_argument(
        "images",
        nargs="+",
        type=Path,
        metavar="IMAGE",
        help="someone from the front; PNG, JPEG, WebP, TIFF, BMP or GIF",
    )
    parser.add_argument(
        "-o", "--out", type=Path, required=True, metavar="FOLDER", help="where results go"
    )
    parser.add_argument(
        "--network",
        metavar="NAME",
        help="a network that comes with the package, or a folder (image-wide)",
    )


def run_predict(options: argparse.Namespace) -> Exit:
    """The pattern of the garment in each picture; one that will not do does not stop the others."""
    from tqdm import tqdm

    from garmentimage.networks import draped_frame
    from garmentimage.predict import DEFAULT_NETWORK, PatternPredictor

    check_folder(options.out)
    names = _names(options.images)
    _check_results(options.out, names)
    network = PatternPredictor.load(DEFAULT_NETWORK if options.network is None else options.network)
    told: list[dict[str, Any]] = []
    failed: list[dict[str, Any]] = []
    with tqdm(names.items(), unit="picture", disable=None, file=sys.stderr) as bar:
        for name, path in bar:
            try:
                prediction = network.predict(path)
            except LearnError as error:
                failed.append({"image": str(path), **error_facts(error)})
                bar.write(f"error: {one_line(error)}", file=sys.stderr)
                continue
            worn = draped_frame(path.name, prediction.garment)
            _put(options.out, name, prediction, worn)
            told.append({"image": str(path)} | _facts(name, prediction, worn))
            if not options.json:
                bar.write(_sentence(options.out, told[-1]), file=sys.stdout)
    if options.json:
        print_json({"out": str(options.out), "garments": told, "errors": failed})
    return Exit.USER_ERROR if failed else Exit.OK


def _names(images: Sequence[Path]) -> dict[str, Path]:
    """Names of results: the picture's own, numbered where two pictures have the same."""
    names: dict[str, Path] = {}
    for path in images:
        names[safe_name(path.stem, names)] = path
    return names


def _check_results(out: Path, names: Mapping[str, Path]) -> None:
    """Refuse to write over a picture that is asked about.

    Raises:
        OutputError: says which.
    """
    for name in names:
        for suffix in SUFFIXES:
            if (out / (name + suffix)).exists():
                check_output(out / (name + suffix), SUFFIXES, names.values())


def _put(out: Path, name: str, prediction: "Prediction", worn: "StripFrame") -> None:
    """Write what is found, and take away what an earlier run found under the same name."""
    from garmentimage.drape.files import drape_bytes
    from garmentimage.pattern.files import pattern_text
    from garmentimage.predict import draw_report
    from garmentimage.raster import image_bytes
    from garmentimage.render import png_bytes

    step = prediction.garment
    assert step.image is not None  # it is made of one
    found: dict[str, bytes | str | None] = {
        ".npz": image_bytes(step.image),
        ".png": png_bytes(draw_report(prediction, worn)),
        ".json": None if step.pattern is None else pattern_text(step.pattern),
        ".glb": None if worn.worn is None else drape_bytes(worn.worn, ".glb"),
    }
    make_folder(out)
    write_together({out / (name + k): data for k, data in found.items() if data is not None})
    for suffix, data in found.items():
        if data is None:
            (out / (name + suffix)).unlink(missing_ok=True)


def _facts(name: str, prediction: "Prediction", worn: "StripFrame") -> dict[str, Any]:
    step = prediction.garment
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
