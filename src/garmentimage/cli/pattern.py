"""The verbs of the command line: a few lines over each library call.

Each imports what it needs when it runs, so that the command starts quickly. A new verb is a row
of `COMMANDS`, at the end.
"""

import argparse
import json
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.cli.dataset import build_arguments, dataset_arguments, run_build, run_dataset
from garmentimage.cli.draft import (
    bodies_arguments,
    draft_arguments,
    gallery_arguments,
    kinds_arguments,
    run_bodies,
    run_draft,
    run_gallery,
    run_kinds,
    run_sample,
    sample_arguments,
)
from garmentimage.cli.drape import IMAGE_SUFFIXES, drape_arguments, run_drape
from garmentimage.cli.evaluate import evaluate_arguments, run_evaluate
from garmentimage.cli.latent import (
    generate_arguments,
    interpolate_arguments,
    nearest_arguments,
    run_generate,
    run_interpolate,
    run_nearest,
    run_transfer,
    transfer_arguments,
)
from garmentimage.cli.predict import predict_arguments, run_predict
from garmentimage.cli.render import render_arguments, run_render
from garmentimage.cli.terminal import (
    Exit,
    add_order,
    error_facts,
    errors_about,
    list_facts,
    one_line,
    print_json,
    print_written,
    say,
    warn,
)
from garmentimage.cli.text_edit import edit_arguments, run_edit
from garmentimage.cli.train import run_train, train_arguments
from garmentimage.errors import GarmentImageError, PatternError, PatternFileError
from garmentimage.system import check_output, shown_path, write_atomically

if TYPE_CHECKING:
    from garmentimage.metrics import FileReport
    from garmentimage.pattern import Finding, Pattern
    from garmentimage.raster import GarmentImage

FAILURES_SHOWN = 20
ROUNDTRIP_COLUMNS = """\
columns of the table:
  kind      name of the folder
  success   files that came back as the same garment: as many panels, each with an
            IoU of 0.9 or more, and the same seams, as long within 2 % or 0.5 cm
  no marks  the same from the channels alone: names and places of panels forgotten
  cut       files with panels that were cut to lie on front and back; without marks
            they stay cut, so these cannot count in the column before
  IoU       shared over joint area of a panel and its original, 1 is equal;
            mean and least of all panels
  gap cm    largest distance of a boundary from the original one
  seams     share of seams that came back between the same panels and as long
  ms        median time; the first file of each process, which compiles, left out
  errors    files that ended with an error, by class; Lost: one that took longer
            than 60 s and was given up (with --workers 0, none is), or whose
            process died

Images keep no notches, no names of edges and no fields beside panels and
stitches; these are not judged.
"""


@dataclass(frozen=True)
class Command:
    """One verb of the command line."""

    name: str
    summary: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace], Exit]
    takes_rest: bool = False
    """Options that the parser does not know are left to `run`."""


# --- check ---------------------------------------------------------------------------------------


def _check_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE")


def _check(options: argparse.Namespace) -> Exit:
    code, rows = Exit.OK, []
    for path in options.files:
        try:
            row, found = _facts(path)
        except GarmentImageError as error:
            code = Exit.USER_ERROR
            rows.append({"file": str(path), "ok": False, **error_facts(error)})
            say(f"error: {one_line(error)}")
            continue
        codes = [f.code for f in found if f.code]
        warnings = [str(f) for f in found]
        rows.append({"file": str(path), "ok": True, **row, "warnings": warnings, "codes": codes})
        warn(path, found)
        if not options.json:
            print(f"{shown_path(path)}: ok, {list_facts(row)}")
    if options.json:
        print_json({"files": rows})
    return code


def _facts(path: Path) -> tuple[dict[str, Any], "Sequence[Finding]"]:
    """What a good file holds, and the findings about it."""
    if _is_image(path):
        from garmentimage.raster import load_image

        return _image_facts(load_image(path)), ()
    pattern, found = _read_pattern(path)
    return _pattern_facts(pattern), found


# --- encode --------------------------------------------------------------------------------------


def _encode_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", type=Path, metavar="FILE", help="a pattern (JSON)")
    _add_out(parser, "OUT.npz", "the image; .npy writes the layout of the GarmentImage authors")
    _add_grid(parser)
    parser.add_argument(
        "--no-verify",
        dest="verify",
        action="store_false",
        help="do not decode the image to see whether it brings the pattern back",
    )


def _encode(options: argparse.Namespace) -> Exit:
    from garmentimage.raster import save_image
    from garmentimage.raster.encode import encode

    check_output(options.out, IMAGE_SUFFIXES, [options.file])
    pattern, found = _read_pattern(options.file)
    warn(options.file, found)
    with errors_about(options.file):
        image = encode(pattern, grid=options.grid, verify=options.verify)
    save_image(image, options.out)
    print_written(options, _image_facts(image))
    return Exit.OK


# --- decode --------------------------------------------------------------------------------------


def _decode_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", type=Path, metavar="FILE", help="an image (.npz or .npy)")
    _add_out(parser, "OUT.json", "the pattern")
    parser.add_argument(
        "--repair",
        choices=("full", "paper", "none"),
        default="full",
        help="what to mend before decoding (default: full)",
    )
    parser.add_argument(
        "--kind",
        choices=("shares", "logits", "channels"),
        help="what the numbers of a .npy are: probabilities, logits, or channels to be decided at "
        ".5 (default: judged by all of them)",
    )
    add_order(parser)


def _decode(options: argparse.Namespace) -> Exit:
    from garmentimage.pattern.files import save_pattern
    from garmentimage.raster.decode import decode
    from garmentimage.raster.repair import repair

    check_output(options.out, (".json",), [options.file])
    source = _read_image(options.file, options.order)
    with errors_about(options.file):
        image, report = repair(source, options.repair, kind=options.kind)
        pattern = decode(image, repair=options.repair)
    save_pattern(pattern, options.out)
    mended = {rule: int(count) for rule, count in report.counts.items() if count}
    if report.is_guess:
        name = shown_path(options.file)
        say(f"{name}: its numbers are read as {report.kind}; give --kind if they are not")
    if mended:
        say(f"repaired: {shown_path(options.file)}: {list_facts(mended)}")
    print_written(options, _pattern_facts(pattern), repaired=mended, kind=report.kind)
    return Exit.OK


# --- show ----------------------------------------------------------------------------------------


def _show_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="patterns and images")
    _add_out(parser, "OUT.png", "the picture (.png or .svg)")
    parser.add_argument(
        "--round-trip",
        action="store_true",
        help="encode one pattern, decode it, and draw all three beside each other",
    )
    _add_grid(parser)
    add_order(parser)


def _show(options: argparse.Namespace) -> Exit:
    from garmentimage.render import SUFFIXES, show

    check_output(options.out, SUFFIXES, options.files)
    sources: list[Pattern | GarmentImage] = []
    for path in options.files:
        if _is_image(path):
            from garmentimage.raster import load_image

            sources.append(load_image(path, order=options.order))
        else:
            pattern, found = _read_pattern(path)
            warn(path, found)
            sources.append(pattern)
    if options.round_trip:
        _show_round_trip(options, sources)
    else:
        show(*sources, out=options.out)
    print_written(options, {"sources": len(sources)})
    return Exit.OK


def _show_round_trip(options: argparse.Namespace, sources: "list[Pattern | GarmentImage]") -> None:
    from garmentimage.pattern import Pattern
    from garmentimage.raster.decode import decode
    from garmentimage.raster.encode import encode
    from garmentimage.render import show

    if len(sources) != 1 or not isinstance(sources[0], Pattern):
        raise PatternFileError("--round-trip draws the way of one pattern file; give just that")
    with errors_about(options.files[0]):
        image = encode(sources[0], grid=options.grid)
        again = decode(image)
    show(
        sources[0],
        image,
        again,
        out=options.out,
        titles=(
            f"{sources[0].name}, sewing pattern",
            f"GarmentImage, {image.grid} x {image.grid}",
            "decoded pattern",
        ),
        steps=("encode", "decode"),
    )


# --- roundtrip -----------------------------------------------------------------------------------


def _roundtrip_arguments(parser: argparse.ArgumentParser) -> None:
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.epilog = ROUNDTRIP_COLUMNS
    parser.add_argument(
        "paths", nargs="+", type=Path, metavar="FILE_OR_FOLDER", help="patterns; folders hold more"
    )
    parser.add_argument("--report", type=Path, metavar="OUT.json", help="every file's result")
    parser.add_argument(
        "--workers", type=_workers, help="processes (default: one for each core; 0: in this one)"
    )
    _add_grid(parser)


def _roundtrip(options: argparse.Namespace) -> Exit:
    from tqdm import tqdm

    from garmentimage.metrics import report_to_json, roundtrip_many, summarise, summary_table

    files = _pattern_files(options.paths)
    if options.report is not None:
        check_output(options.report, (".json",), files)
    # disable=None: a progress bar on a terminal only.
    with tqdm(total=len(files), unit="file", disable=None, file=sys.stderr) as bar:
        reports = roundtrip_many(
            files, options.grid, workers=options.workers, progress=lambda _: bar.update()
        )
    data = report_to_json(reports, options.grid)
    if options.report is not None:
        write_atomically(options.report, json.dumps(data, indent=1) + "\n")
    if options.json:
        print_json(data)
    else:
        print(summary_table(summarise(reports)))
    failed = [r for r in reports if not r.with_marks.success]
    for report in failed[:FAILURES_SHOWN]:
        say(f"{report.file}: {one_line(_reason(report))}")
    if len(failed) > FAILURES_SHOWN:
        say(f"and {len(failed) - FAILURES_SHOWN} more; --report writes them all")
    return Exit.NOT_THE_SAME if failed else Exit.OK


def _reason(report: "FileReport") -> str:
    trip = report.with_marks
    if trip.result is None:
        return f"{trip.stage}: {trip.error}: {trip.message}"
    return "; ".join(trip.result.reasons)


def _pattern_files(paths: Iterable[Path]) -> list[Path]:
    """The files named, and all patterns in the folders named, each once."""
    found: dict[Path, None] = {}
    for path in paths:
        try:
            is_folder, is_file = path.is_dir(), path.is_file()
        except OSError as error:
            raise PatternFileError(
                f"{shown_path(path)}: cannot be read ({error.strerror})"
            ) from None
        if is_folder:
            inside = sorted(path.rglob("*.json"))
            patterns = [f for f in inside if not _holds_no_pattern(f)]
            if not patterns:
                raise PatternFileError(f"{shown_path(path)}: no .json file in it holds a pattern")
            found.update(dict.fromkeys(patterns))
            if others := len(inside) - len(patterns):
                holds = "file holds" if others == 1 else "files hold"
                say(f"{shown_path(path)}: {others} {holds} no pattern, skipped")
        elif is_file:
            found[path] = None
        else:
            raise PatternFileError(f"{shown_path(path)}: there is no such file or folder")
    return list(found)


def _holds_no_pattern(path: Path) -> bool:
    """Whether a file is sound JSON of another kind, as reports and lists of designs are."""
    from garmentimage.pattern.files import LongInteger, parse, read_bytes

    try:
        data = parse(read_bytes(path))
    except (PatternError, LongInteger):
        return False  # a damaged pattern perhaps: its round trip tells what is wrong
    return not (isinstance(data, dict) and "pattern" in data)


# --- options -------------------------------------------------------------------------------------


def _add_out(parser: argparse.ArgumentParser, metavar: str, text: str) -> None:
    parser.add_argument("-o", "--out", type=Path, required=True, metavar=metavar, help=text)


def _add_grid(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--grid", type=_grid, default=16, metavar="N", help="cells along each side (default: 16)"
    )


def _grid(text: str) -> int:
    from garmentimage.raster.encode import GRIDS

    low, high = GRIDS
    if not (text.isascii() and text.isdigit() and low <= int(text[:9]) <= high) or int(text) % 2:
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is no even number from {low} to {high}")
    return int(text)


def _workers(text: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) < 4):
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is no number of processes")
    return int(text)


# --- files ---------------------------------------------------------------------------------------


def _is_image(path: Path) -> bool:
    return path.suffix.lower() in IMAGE_SUFFIXES


def _read_pattern(path: Path) -> "tuple[Pattern, tuple[Finding, ...]]":
    from garmentimage.pattern.files import read_pattern

    return read_pattern(path)


def _read_image(path: Path, order: str | None) -> Any:
    """An `.npz` as an image; a `.npy` as channels, so that soft values reach the repair."""
    from garmentimage.raster import load_channels, load_image

    return load_channels(path, order=order) if path.suffix.lower() == ".npy" else load_image(path)


def _pattern_facts(pattern: "Pattern") -> dict[str, Any]:
    return {"panels": len(pattern.panels), "stitches": len(pattern.stitches)}


def _image_facts(image: "GarmentImage") -> dict[str, Any]:
    return {"grid": image.grid, "layers": image.layers, "cells": int(image.inside.sum())}


COMMANDS = (
    Command(
        "check", "say what patterns and images hold, and what is odd", _check_arguments, _check
    ),
    Command("encode", "turn a pattern into a GarmentImage", _encode_arguments, _encode),
    Command("decode", "turn a GarmentImage into a pattern", _decode_arguments, _decode),
    Command("show", "draw patterns and GarmentImages beside each other", _show_arguments, _show),
    Command(
        "roundtrip",
        "encode and decode patterns, and judge what comes back",
        _roundtrip_arguments,
        _roundtrip,
    ),
    Command("kinds", "list what can be drafted, with parameters", kinds_arguments, run_kinds),
    Command("bodies", "list bodies with their measurements", bodies_arguments, run_bodies),
    Command("draft", "draft a garment", draft_arguments, run_draft, takes_rest=True),
    Command("sample", "draw garments at random, from a seed", sample_arguments, run_sample),
    Command(
        "gallery", "draw the kinds at low, middle and high values", gallery_arguments, run_gallery
    ),
    Command("drape", "put garments on a body", drape_arguments, run_drape),
    Command("render", "photograph a garment on a body", render_arguments, run_render),
    Command("build", "make a dataset, or go on with one", build_arguments, run_build),
    Command("dataset", "describe a dataset and draw rows of it", dataset_arguments, run_dataset),
    Command("train", "train a network on a dataset, or go on with it", train_arguments, run_train),
    Command(
        "interpolate", "garments on the way from A to B", interpolate_arguments, run_interpolate
    ),
    Command("transfer", "what C becomes by the edit from A to B", transfer_arguments, run_transfer),
    Command("generate", "draw new garments from a seed", generate_arguments, run_generate),
    Command("nearest", "find the nearest training garments", nearest_arguments, run_nearest),
    Command("edit", "what a text makes of a garment: 'long sleeves'", edit_arguments, run_edit),
    Command("predict", "the pattern of a garment in a picture", predict_arguments, run_predict),
    Command("evaluate", "measure networks on held-out garments", evaluate_arguments, run_evaluate),
)
