"""The verbs of the command line that explore a latent space: interpolate, transfer and others."""

import argparse
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.errors import LearnError
from garmentimage.files import safe_name, shown_path, write_together
from garmentimage.terminal import (
    Exit,
    errors_about,
    one_line,
    print_json,
    say,
    warn,
    whole_number,
)

if TYPE_CHECKING:
    from garmentimage.explore.space import LatentSpace, Step
    from garmentimage.explore.strip import Shown
    from garmentimage.pattern.model import Pattern
    from garmentimage.raster.image import GarmentImage

IMAGE_SUFFIXES = (".npz", ".npy")


def interpolate_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `interpolate`."""
    _files(parser, {"first": "A", "last": "B"})
    parser.add_argument(
        "--steps", type=whole_number, default=9, metavar="N", help="with both ends (9)"
    )
    _common(parser)


def run_interpolate(options: argparse.Namespace) -> Exit:
    """Garments on the way from one to another."""
    from garmentimage.explore.walk import interpolate

    space = _space(options)
    a, b = (_source(space, path) for path in (options.first, options.last))
    steps = interpolate(space, a, b, options.steps)
    titles = [f"{k}/{len(steps) - 1}" for k in range(len(steps))]
    return _write(options, "step", zip(titles, steps), len(steps), film=True)


def transfer_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `transfer`."""
    _files(parser, {"before": "A", "after": "B", "garment": "C"})
    parser.add_argument(
        "--settle",
        type=whole_number,
        default=2,
        metavar="N",
        help="times that the edited garment is decoded and encoded again (2)",
    )
    parser.add_argument(
        "--strength",
        type=float,
        metavar="X",
        help="times that B - A is added; 1 to 2 without, the least that changes the topology",
    )
    _common(parser)


def run_transfer(options: argparse.Namespace) -> Exit:
    """What a garment becomes by the edit that makes one of another."""
    from garmentimage.explore.walk import STRENGTHS, transfer

    space = _space(options)
    paths = (options.before, options.after, options.garment)
    a, b, c = (_source(space, path) for path in paths)
    steps = [space.step(space.encode(each)) for each in (a, b, c)]
    strengths = STRENGTHS if options.strength is None else (options.strength,)
    edited = transfer(space, a, b, c, settle=options.settle, strengths=strengths)
    steps.append(edited.step)
    titles = ["A", "B", "C", edited.title]
    return _write(options, "garment", zip(titles, steps), len(steps))


def generate_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `generate`."""
    parser.add_argument("--count", type=whole_number, default=6, metavar="N", help="how many (6)")
    parser.add_argument("--seed", type=whole_number, default=0, metavar="N")
    parser.add_argument(
        "--type", metavar="TYPE", help="of one type, such as 'top + skirt'; any without"
    )
    _common(parser)


def run_generate(options: argparse.Namespace) -> Exit:
    """New garments."""
    from garmentimage.explore.walk import generate

    space = _space(options)
    made = generate(space, options.count, options.seed, type_name=options.type)
    titled = ((f"seed {options.seed}, {k}", step) for k, step in enumerate(made))
    return _write(options, "garment", titled, options.count)


def nearest_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `nearest`."""
    _files(parser, {"garment": "PATTERN"})
    parser.add_argument("--count", type=whole_number, default=5, metavar="N", help="how many (5)")
    _common(parser)


def run_nearest(options: argparse.Namespace) -> Exit:
    """The nearest garments that the network was trained on."""
    from garmentimage.explore.walk import nearest
    from garmentimage.pattern.spec import pattern_text
    from garmentimage.render.show import compose, picture_bytes

    space = _space(options)
    source = _source(space, options.garment)
    found = nearest(space, source, options.count)
    results: dict[str | PathLike[str], bytes | str] = {
        options.out / f"{row_id}.json": pattern_text(pattern) for row_id, _, pattern in found
    }
    titles = [options.garment.stem, *(f"{row_id}, {apart:.2f} away" for row_id, apart, _ in found)]
    figure = compose([source, *(pattern for *_, pattern in found)], titles=titles)
    results[options.out / "nearest.png"] = picture_bytes(figure, "png")
    _put(options, results)
    if options.json:
        print_json({"out": str(options.out), "garments": {i: apart for i, apart, _ in found}})
    else:
        for row_id, apart, _ in found:
            print(f"{shown_path(options.out / row_id)}.json: {apart:.2f} away")
    return Exit.OK


# --- what they share -----------------------------------------------------------------------------


def _files(parser: argparse.ArgumentParser, names: dict[str, str]) -> None:
    for name, metavar in names.items():
        parser.add_argument(name, type=Path, metavar=metavar, help="a pattern or a GarmentImage")


def _common(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "-o", "--out", type=Path, required=True, metavar="FOLDER", help="where results go"
    )
    parser.add_argument(
        "--space", default="vae-variety", metavar="NAME", help="a latent space or its folder"
    )


def _space(options: argparse.Namespace) -> "LatentSpace":
    from garmentimage.explore.space import LatentSpace

    if options.out.exists() and not options.out.is_dir():
        raise LearnError(f"{shown_path(options.out)}: is a file; name a folder for the results")
    return LatentSpace.load(options.space)


def _source(space: "LatentSpace", path: Path) -> "Pattern | GarmentImage":
    """A pattern or an image, and a warning where the network has not seen the like."""
    from garmentimage.explore.space import LIKE_IOU

    source: Pattern | GarmentImage
    if path.suffix.lower() in IMAGE_SUFFIXES:
        from garmentimage.raster.files import load_image

        source = load_image(path)
    else:
        from garmentimage.pattern.spec import read_pattern

        source, found = read_pattern(path)
        warn(path, found)
    with errors_about(path):
        likeness = space.likeness(space.image(source))
    if likeness < LIKE_IOU:
        say(
            f"warning: {shown_path(path)}: is unlike the garments that {space.folder.name} was "
            f"trained on (it comes back with {likeness:.0%} of its cells); expect little, and see "
            "`garmentimage nearest`"
        )
    return source


def _write(
    options: argparse.Namespace,
    word: str,
    titled: Iterable[tuple[str, "Step"]],
    count: int,
    *,
    film: bool = False,
) -> Exit:
    """Every step as pattern, raster and drape, a strip of all, and a film."""
    from garmentimage.drape.export import worn_bytes
    from garmentimage.explore import strip as pictures
    from garmentimage.pattern.spec import pattern_text
    from garmentimage.raster.files import image_bytes
    from garmentimage.render.png import png_bytes

    columns = list(_shown(titled, count))
    results: dict[str | PathLike[str], bytes | str] = {}
    for number, column in enumerate(columns):
        path = options.out / safe_name(f"{word}-{number}")
        if column.step.image is not None:
            results[path.with_suffix(".npz")] = image_bytes(column.step.image)
        if column.step.pattern is not None:
            results[path.with_suffix(".json")] = pattern_text(column.step.pattern)
        if column.worn is not None:
            results[path.with_suffix(".glb")] = worn_bytes(column.worn, ".glb")
    results[options.out / "strip.png"] = png_bytes(pictures.strip(columns))
    if film:
        results[options.out / "film.gif"] = pictures.film(columns)
    _put(options, results)
    _tell(options, word, columns)
    return Exit.OK


def _shown(titled: Iterable[tuple[str, "Step"]], count: int) -> "Iterator[Shown]":
    from tqdm import tqdm

    from garmentimage.explore.strip import shown

    for title, step in tqdm(titled, total=count, unit="garment", disable=None, file=sys.stderr):
        yield shown(title, step)


def _put(options: argparse.Namespace, results: Mapping[str | PathLike[str], bytes | str]) -> None:
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LearnError(
            f"{shown_path(options.out)}: cannot be made ({error.strerror}); choose another folder"
        ) from None
    write_together(results)


def _tell(options: argparse.Namespace, word: str, columns: "Sequence[Shown]") -> None:
    told: list[dict[str, Any]] = [
        {
            "name": safe_name(f"{word}-{number}"),
            "title": column.title,
            "panels": len(column.step.pattern.panels) if column.step.pattern else 0,
            "repairs": dict(column.step.repairs.counts) if column.step.repairs else {},
            "faults": [one_line(fault) for fault in column.faults],
        }
        for number, column in enumerate(columns)
    ]
    if options.json:
        print_json({"out": str(options.out), "garments": told})
        return
    for each in told:
        said = f"{shown_path(options.out / each['name'])}: {each['panels']} panels"
        faults = "; ".join(each["faults"])
        print(f"{said}, NOT a garment that can be worn: {faults}" if faults else said)
    print(f"{shown_path(options.out / 'strip.png')}: all of them beside each other")
