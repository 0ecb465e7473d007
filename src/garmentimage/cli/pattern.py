"""The verbs of patterns and their images: check, show, encode, decode, roundtrip."""

import json as json_module
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from garmentimage.cli.options import (
    IMAGE_SUFFIXES,
    Files,
    Grid,
    Json,
    Order,
    Out,
    Whole,
    is_image,
    read_pattern_file,
    read_soft_image,
    read_source,
    within,
)
from garmentimage.cli.terminal import (
    Exit,
    Progress,
    error_facts,
    list_facts,
    one_line,
    pattern_facts,
    print_findings,
    print_json,
    print_line,
    print_written,
)
from garmentimage.errors import GarmentImageError, PatternError, PatternFileError
from garmentimage.system import check_output, errors_about, shown_path, write_atomically

if TYPE_CHECKING:
    from garmentimage.metrics import FileReport
    from garmentimage.pattern import Finding, Pattern
    from garmentimage.raster import GarmentImage

MAX_FAILURES_SHOWN = 20


# --- check, show ---------------------------------------------------------------------------------


def check(*files: Files, json: Json = False) -> Exit:
    """Report what patterns and images hold, and what is odd about them.

    Args:
        files: Patterns (.json) and images (.npz, .npy).
    """
    code, rows = Exit.OK, []
    for path in files:
        try:
            facts, findings = _facts(path)
        except GarmentImageError as error:
            code = Exit.USER_ERROR
            rows.append({"file": str(path), "ok": False, **error_facts(error)})
            print_line(f"error: {one_line(error)}")
            continue
        codes = [each.code for each in findings if each.code]
        warnings = [str(each) for each in findings]
        rows.append({"file": str(path), "ok": True, **facts, "warnings": warnings, "codes": codes})
        print_findings(path, findings)
        if not json:
            print(f"{shown_path(path)}: ok, {list_facts(facts)}")
    if json:
        print_json({"files": rows})
    return code


def _facts(path: Path) -> tuple[dict[str, Any], "Sequence[Finding]"]:
    """What a good file holds, and the findings about it."""
    if is_image(path):
        from garmentimage.raster import load_image

        return _image_facts(load_image(path)), ()
    from garmentimage.pattern.files import read_pattern

    pattern, findings = read_pattern(path)
    return pattern_facts(pattern), findings


def show(
    *files: Files,
    out: Out,
    round_trip: bool = False,
    grid: Grid = "auto",
    order: Order = None,
    json: Json = False,
) -> None:
    """Draw patterns and GarmentImages beside each other.

    Args:
        files: Patterns and images.
        out: The picture (.png or .svg).
        round_trip: Encode one pattern, decode it, and draw all three.
    """
    from garmentimage.render import SUFFIXES, show as draw

    check_output(out, SUFFIXES, files)
    sources = [read_source(path, order) for path in files]
    if round_trip:
        _show_round_trip(files[0], sources, out, grid)
    else:
        draw(*sources, out=out)
    print_written(out, {"sources": len(sources)}, as_json=json)


def _show_round_trip(
    file: Path, sources: "list[Pattern | GarmentImage]", out: Path, grid: int | Literal["auto"]
) -> None:
    from garmentimage.pattern import Pattern
    from garmentimage.raster.decode import decode as decode_image
    from garmentimage.raster.encode import encode as encode_pattern
    from garmentimage.render import show as draw

    pattern = sources[0]
    if len(sources) != 1 or not isinstance(pattern, Pattern):
        raise PatternFileError("--round-trip draws one pattern file; give just that")
    with errors_about(file):
        image = encode_pattern(pattern, grid=grid)
        again = decode_image(image)
    draw(
        pattern,
        image,
        again,
        out=out,
        titles=(
            f"{pattern.name}, sewing pattern",
            f"GarmentImage, {image.grid} x {image.grid}",
            "decoded pattern",
        ),
        steps=("encode", "decode"),
    )


# --- encode, decode ------------------------------------------------------------------------------


def encode(
    pattern: Path,
    /,
    *,
    out: Out,
    grid: Grid = "auto",
    verify: Annotated[bool, Parameter(negative="--no-verify")] = True,
    json: Json = False,
) -> None:
    """Turn a pattern into a GarmentImage.

    Args:
        pattern: A pattern (.json).
        out: The image; .npz, or .npy in the layout of the GarmentImage authors.
        verify: Decode the image, too, and refuse one that does not bring the pattern back.
    """
    from garmentimage.raster import save_image
    from garmentimage.raster.encode import encode as encode_pattern

    check_output(out, IMAGE_SUFFIXES, [pattern])
    source = read_pattern_file(pattern)
    with errors_about(pattern):
        image = encode_pattern(source, grid=grid, verify=verify)
    save_image(image, out)
    print_written(out, _image_facts(image), as_json=json)


def decode(
    image: Path,
    /,
    *,
    out: Out,
    repair: Literal["full", "paper", "none"] = "full",
    kind: Literal["shares", "logits", "channels"] | None = None,
    order: Order = None,
    json: Json = False,
) -> None:
    """Turn a GarmentImage into a pattern.

    Args:
        image: An image (.npz or .npy).
        out: The pattern (.json).
        repair: What is mended before decoding.
        kind: What the numbers of a .npy are: probabilities, logits, or channels with a threshold
            at 0.5; without it, detected from all of them.
    """
    from garmentimage.pattern.files import save_pattern
    from garmentimage.raster.decode import decode as decode_image
    from garmentimage.raster.repair import repair as repair_image

    check_output(out, (".json",), [image])
    source = read_soft_image(image, order)
    with errors_about(image):
        sound, report = repair_image(source, repair, kind=kind)
        pattern = decode_image(sound, repair=repair)
    save_pattern(pattern, out)
    repaired = {rule: int(count) for rule, count in report.counts.items() if count}
    if report.is_guess:
        print_line(
            f"{shown_path(image)}: its numbers are read as {report.kind}; give --kind if they are "
            "not"
        )
    if repaired:
        print_line(f"repaired: {shown_path(image)}: {list_facts(repaired)}")
    facts = pattern_facts(pattern)
    print_written(out, facts, as_json=json, repaired=repaired, kind=report.kind)


# --- roundtrip -----------------------------------------------------------------------------------


def roundtrip(
    *paths: Files,
    report: Annotated[Path | None, Parameter(metavar="OUT.json")] = None,
    workers: Annotated[Whole | None, Parameter(validator=within(0, 999))] = None,
    grid: Grid = 16,
    json: Json = False,
) -> Exit:
    """Encode and decode patterns, and judge whether they come back the same.

    Columns of the table:
      kind      name of the folder
      success   files that came back as the same garment: as many panels, each with an
                IoU of 0.9 or more, and the same seams, as long within 2 % or 0.5 cm
      no marks  the same from the channels alone: names and places of panels removed
      wraps     files with panels that wrap round the body, from front to back
      IoU       shared over joint area of a panel and its original, 1 is equal;
                mean and least of all panels
      gap cm    largest distance of a boundary from the original one
      seams     share of seams that came back between the same panels and as long
      ms        median time; the first file of each process, which compiles, left out
      errors    files that ended with an error, by class; Lost: stopped after 60 s
                (never with --workers 0), or its process died

    Images keep no notches, no names of edges and no fields beside panels and stitches; these are
    not judged.

    Args:
        paths: Pattern files, and folders of them.
        report: File with the result of every pattern.
        workers: Processes, 0 for none but this one; without it, one for each core.
    """
    from garmentimage.metrics import report_to_json, roundtrip_many, summarise, summary_table

    files = _pattern_files(paths)
    if report is not None:
        check_output(report, (".json",), files)
    with Progress("file", len(files)) as progress:
        reports = roundtrip_many(
            files, grid, workers=workers, progress=lambda _: progress.advance()
        )
    data = report_to_json(reports, grid)
    if report is not None:
        write_atomically(report, json_module.dumps(data, indent=1) + "\n")
    if json:
        print_json(data)
    else:
        print(summary_table(summarise(reports)))
    failed = [each for each in reports if not each.with_marks.success]
    for each in failed[:MAX_FAILURES_SHOWN]:
        print_line(f"{each.file}: {one_line(_reason(each))}")
    if len(failed) > MAX_FAILURES_SHOWN:
        print_line(f"and {len(failed) - MAX_FAILURES_SHOWN} more; --report writes them all")
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
            patterns = [file for file in inside if not _holds_no_pattern(file)]
            if not patterns:
                raise PatternFileError(f"{shown_path(path)}: no .json file in it holds a pattern")
            found.update(dict.fromkeys(patterns))
            if others := len(inside) - len(patterns):
                holds = "file holds" if others == 1 else "files hold"
                print_line(f"{shown_path(path)}: {others} {holds} no pattern, skipped")
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
        return False  # a damaged pattern perhaps: its round trip reports what is wrong
    return not (isinstance(data, dict) and "pattern" in data)


# --- Reports -------------------------------------------------------------------------------------


def _image_facts(image: "GarmentImage") -> dict[str, Any]:
    return {"grid": image.grid, "layers": image.layers, "cells": int(image.inside.sum())}
