"""The verbs of the command line that explore a latent space: interpolate, transfer and others."""

import argparse
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.cli.terminal import (
    Exit,
    add_order,
    errors_about,
    list_facts,
    one_line,
    print_json,
    say,
    warn,
    whole_number,
)
from garmentimage.errors import LearnError
from garmentimage.system import shown_path, write_together

if TYPE_CHECKING:
    from garmentimage.latent import LatentSpace
    from garmentimage.networks import DecodedGarment, StripFrame
    from garmentimage.pattern import Pattern
    from garmentimage.raster import GarmentImage

IMAGE_SUFFIXES = (".npz", ".npy")


@dataclass(frozen=True)
class Column:
    """A garment of a strip."""

    name: str
    """Of its files; empty where it has none."""
    title: str
    step: "DecodedGarment"


def interpolate_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `interpolate`."""
    _files(parser, {"first": "A", "last": "B"})
    parser.add_argument(
        "--steps", type=whole_number, default=9, metavar="N", help="with both ends (9)"
    )
    _common(parser)


def run_interpolate(options: argparse.Namespace) -> Exit:
    """Garments on the way from one to another."""
    from garmentimage.latent import interpolate

    space = _space(options)
    a, b = (read_given(space, path, options.order) for path in (options.first, options.last))
    steps = interpolate(space, _image(a), _image(b), options.steps)
    columns = [Column(f"step-{k}", f"{k}/{len(steps) - 1}", step) for k, step in enumerate(steps)]
    ends = Column("", "A, as given", a), Column("", "B, as given", b)
    return _write(options, [ends[0], *columns, ends[1]], len(steps) + 2, film=True)


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
    from garmentimage.latent import STRENGTHS, transfer

    space = _space(options)
    paths = (options.before, options.after, options.garment)
    a, b, c = (read_given(space, path, options.order) for path in paths)
    strengths = STRENGTHS if options.strength is None else (options.strength,)
    images = (_image(each) for each in (a, b, c))
    edited = transfer(space, *images, reprojections=options.settle, strengths=strengths)
    given = [Column("", f"{name}, as given", each) for name, each in zip("ABC", (a, b, c))]
    return _write(options, [*given, Column("edited", edited.title, edited.garment)], 4)


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
    from garmentimage.latent import generate

    space = _space(options)
    made = generate(space, options.count, options.seed, type_name=options.type)
    columns = (
        Column(f"garment-{k}", f"seed {options.seed}, {k}", step) for k, step in enumerate(made)
    )
    return _write(options, columns, options.count)


def nearest_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `nearest`."""
    _files(parser, {"garment": "PATTERN"})
    parser.add_argument("--count", type=whole_number, default=5, metavar="N", help="how many (5)")
    _common(parser)


def run_nearest(options: argparse.Namespace) -> Exit:
    """The nearest garments that the network was trained on."""
    from garmentimage.latent import nearest
    from garmentimage.pattern.files import pattern_text
    from garmentimage.render import compose, picture_bytes

    space = _space(options)
    source = read_given(space, options.garment, options.order)
    found = nearest(space, _image(source), options.count)
    results: dict[str | PathLike[str], bytes | str] = {
        options.out / f"{row_id}.json": pattern_text(pattern) for row_id, _, pattern in found
    }
    start = f"{space.config['recipe']}-"
    told = [f"{row_id.removeprefix(start)}, {apart:.2f} away" for row_id, apart, _ in found]
    assert source.pattern is not None  # `read_given` has one
    figure = compose(
        [source.pattern, *(pattern for *_, pattern in found)], titles=[options.garment.stem, *told]
    )
    results[options.out / "nearest.png"] = picture_bytes(figure, "png")
    _put(options, results)
    if options.json:
        print_json({"out": str(options.out), "garments": {i: apart for i, apart, _ in found}})
    else:
        for row_id, apart, _ in found:
            print(f"{shown_path(options.out / row_id)}.json: {apart:.2f} away")
        print(f"{shown_path(options.out / 'nearest.png')}: the garment and all of them")
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
    add_order(parser)


def _space(options: argparse.Namespace) -> "LatentSpace":
    from garmentimage.latent import LatentSpace

    check_folder(options.out)
    return LatentSpace.load(options.space)


def check_folder(out: Path) -> None:
    """Refuse what cannot be a folder of results, before any work is done.

    Raises:
        LearnError: it is a file, or cannot be looked at.
    """
    try:
        is_file = out.exists() and not out.is_dir()
    except OSError as error:
        raise LearnError(
            f"{shown_path(out)}: cannot be used ({error.strerror}); choose another folder"
        ) from None
    if is_file:
        raise LearnError(f"{shown_path(out)}: is a file; name a folder for the results")


def make_folder(out: Path) -> None:
    """The folder of results, made where it is not there.

    Raises:
        LearnError: it cannot be.
    """
    check_folder(out)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LearnError(
            f"{shown_path(out)}: cannot be made ({error.strerror}); choose another folder"
        ) from None


def read_given(space: "LatentSpace", path: Path, order: str | None = None) -> "DecodedGarment":
    """A garment of the user's, and a warning where the network has not seen the like."""
    source: Pattern | GarmentImage
    if path.suffix.lower() in IMAGE_SUFFIXES:
        from garmentimage.raster import load_image

        source = load_image(path, order=order)
    else:
        from garmentimage.pattern.files import read_pattern

        source, found = read_pattern(path)
        warn(path, found)
    with errors_about(path):
        given = space.locate(source)
    unlike = space.out_of_distribution(given)
    if unlike:
        say(
            f"warning: {shown_path(path)}: is unlike the garments that {space.folder.name} was "
            f"trained on ({unlike}); expect little, and see `garmentimage nearest`"
        )
    return given


def _image(given: "DecodedGarment") -> "GarmentImage":
    assert given.image is not None  # `LatentSpace.given` has one
    return given.image


def _write(
    options: argparse.Namespace, columns: Iterable[Column], count: int, *, film: bool = False
) -> Exit:
    """Every garment as pattern, raster and drape, a strip of all, and a film.

    Columns without a name are in the strip only, as they are the user's own.
    """
    from garmentimage.drape.files import drape_bytes
    from garmentimage.networks import animation as animation, strip
    from garmentimage.pattern.files import pattern_text
    from garmentimage.raster import image_bytes
    from garmentimage.render import png_bytes

    drawn = list(_shown(columns, count))
    made = {name: column for name, column in drawn if name}
    results: dict[str | PathLike[str], bytes | str] = {}
    for name, column in made.items():
        path = options.out / name
        if column.garment.image is not None:
            results[path.with_suffix(".npz")] = image_bytes(column.garment.image)
        if column.garment.pattern is not None:
            results[path.with_suffix(".json")] = pattern_text(column.garment.pattern)
        if column.worn is not None:
            results[path.with_suffix(".glb")] = drape_bytes(column.worn, ".glb")
    results[options.out / "strip.png"] = png_bytes(strip([each for _, each in drawn]))
    if film:
        results[options.out / "film.gif"] = animation(list(made.values()))
    _put(options, results)
    _remove_older(options.out, next(iter(made)), results)
    _tell(options, made, film=film)
    return Exit.OK


def _shown(columns: Iterable[Column], count: int) -> "Iterator[tuple[str, StripFrame]]":
    from tqdm import tqdm

    from garmentimage.networks import draped_frame

    for each in tqdm(columns, total=count, unit="garment", disable=None, file=sys.stderr):
        yield each.name, draped_frame(each.title, each.step)


def _remove_older(
    folder: Path, name: str, results: Mapping[str | PathLike[str], bytes | str]
) -> None:
    """Take away what an earlier run of the same command left and this one did not write."""
    word = re.escape(name.rstrip("0123456789"))
    ours = re.compile(rf"{word}\d*\.(json|npz|glb)", re.ASCII)
    for file in folder.iterdir():
        if ours.fullmatch(file.name) and file not in results and file.is_file():
            file.unlink()


def _put(options: argparse.Namespace, results: Mapping[str | PathLike[str], bytes | str]) -> None:
    make_folder(options.out)
    write_together(results)


def _tell(options: argparse.Namespace, made: "Mapping[str, StripFrame]", *, film: bool) -> None:
    told: list[dict[str, Any]] = [
        {
            "name": name,
            "title": column.title,
            "panels": len(column.garment.pattern.panels) if column.garment.pattern else 0,
            "repairs": dict(column.garment.repairs.counts) if column.garment.repairs else {},
            "faults": [one_line(fault) for fault in column.faults],
        }
        for name, column in made.items()
    ]
    if options.json:
        print_json({"out": str(options.out), "garments": told})
        return
    for each in told:
        said = f"{shown_path(options.out / each['name'])}: {each['title']}, {each['panels']} panels"
        repairs = {rule: count for rule, count in each["repairs"].items() if count}
        if repairs:
            said += f"; repaired: {list_facts(repairs)}"
        faults = "; ".join(each["faults"])
        print(f"{said}; NOT a garment that can be worn: {faults}" if faults else said)
    print(f"{shown_path(options.out / 'strip.png')}: all of them beside each other")
    if film:
        print(f"{shown_path(options.out / 'film.gif')}: the way there and back")
