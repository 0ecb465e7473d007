"""The verb of the command line that puts garments on a body: drape."""

import argparse
import warnings
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.cli.terminal import (
    Exit,
    LongWait,
    errors_about,
    one_line,
    print_json,
    say,
    warn,
    whole_number,
)
from garmentimage.errors import DraftError, DrapeError, quoted
from garmentimage.system import check_output, shown_path, write_together

if TYPE_CHECKING:
    from garmentimage.body import Body
    from garmentimage.drape import DrapedGarment, DrapeReport
    from garmentimage.pattern import Pattern

BODY, POSE, FABRIC = "mean-female", "t", "cotton"
VIEW, SIZE = "front", 512
IMAGE_SUFFIXES = (".npz", ".npy")
WORN_OPTIONS = ("body", "pose", "fabric", "vertices", "tucked", "made_for")
"""Options that say how a pattern is draped."""


# --- drape ---------------------------------------------------------------------------------------


def drape_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `drape_pattern`."""
    parser.add_argument(
        "files",
        nargs="+",
        type=Path,
        metavar="PATTERN",
        help="a pattern or a GarmentImage; several are worn together",
    )
    parser.add_argument(
        "-o",
        "--out",
        type=Path,
        required=True,
        metavar="OUT.glb",
        help="the garment on the body (.glb, .obj or .ply)",
    )
    parser.add_argument("--image", type=Path, metavar="OUT.png", help="a picture of it, too")
    add_worn_options(parser)
    add_view_options(parser)


def run_drape(options: argparse.Namespace) -> Exit:
    """Drape a garment and write it, and a picture of it."""
    from garmentimage.drape.files import DRAPE_FORMATS, drape_bytes

    inputs = [*options.files, *body_file(options)]
    check_output(options.out, DRAPE_FORMATS, inputs)
    if options.image:
        check_output(options.image, (".png",), [*inputs, options.out])
    worn = worn_from(options)
    results = {options.out: drape_bytes(worn, options.out.suffix)}
    if options.image:
        from garmentimage.render import png_bytes
        from garmentimage.render.worn import photograph

        views = photograph(worn, view=options.view, size=options.size)
        results[options.image] = png_bytes(views.colour)
    write_together(results)
    if options.json:
        print_json({"out": str(options.out), "image": _text(options.image), **worn_facts(worn)})
    else:
        print(f"{shown_path(options.out)}: written, {told(worn)}")
    return Exit.OK


def _text(path: Path | None) -> str | None:
    return None if path is None else str(path)


# --- options that render shares ------------------------------------------------------------------


def add_worn_options(parser: argparse._ActionsContainer) -> None:
    """How a pattern is draped; see `WORN_OPTIONS`."""
    parser.add_argument(
        "--body",
        metavar="BODY",
        help="a shipped body, auto for the one that the garment fits best, or a mesh file of "
        f"yours: .obj, .ply, .stl, .glb ({BODY})",
    )
    parser.add_argument(
        "--pose", metavar="t|a", help=f"arms stretched out, or 45 degrees down ({POSE})"
    )
    parser.add_argument(
        "--fabric", metavar="NAME", help=f"cotton, denim, jersey, silk or wool ({FABRIC})"
    )
    parser.add_argument(
        "--vertices", type=whole_number, metavar="N", help="about how many the cloth has (2000)"
    )
    parser.add_argument("--tucked", action="store_true", help="tops under skirts and trousers")
    parser.add_argument(
        "--made-for",
        type=_length,
        metavar="CM",
        help="stature that the pattern was made for; it is then scaled to the body's",
    )
    parser.add_argument(
        "--keep-bad", action="store_true", help="take a drape that went wrong, too, and say so"
    )


def add_view_options(parser: argparse.ArgumentParser) -> None:
    """From where a picture is taken, and how large it is."""
    parser.add_argument(
        "--view", type=_view, default=VIEW, metavar="VIEW", help="front, back, side or turned"
    )
    parser.add_argument(
        "--size", type=_size, default=SIZE, metavar="PX", help=f"rows and columns ({SIZE})"
    )


def _view(text: str) -> str:
    from garmentimage.render.worn import VIEWS

    if text not in VIEWS:
        known = ", ".join(VIEWS)
        raise argparse.ArgumentTypeError(f"there is no view {quoted(text)}; choose {known}")
    return text


def _size(text: str) -> int:
    from garmentimage.render.worn import SIZE_LIMITS

    low, high = SIZE_LIMITS
    if not (text.isascii() and text.isdigit() and low <= int(text[:9]) <= high):
        raise argparse.ArgumentTypeError(
            f"{quoted(text)} is no whole number of pixels from {low} to {high}"
        )
    return int(text)


def _length(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{quoted(text)} is no length in cm") from None


# --- draping -------------------------------------------------------------------------------------


def worn_from(options: argparse.Namespace) -> "DrapedGarment":
    """The garment in `options.files` on the body; bad ones only with `--keep-bad`.

    Raises:
        GarmentImageError: a file, a body or a fabric that will not do, or a drape that went wrong.
    """
    from garmentimage.drape import drape_pattern, load_fabric, outfit
    from garmentimage.drape.mesh import DEFAULT_VERTICES, explain_vertex_count

    fabric = load_fabric(_or(options.fabric, FABRIC))
    patterns = [_pattern(path) for path in options.files]
    body = _body(_body_name(patterns, options), options.pose)
    pattern, made_for = patterns[0], options.made_for
    if len(patterns) > 1:
        # Scaling is done garment by garment then.
        pattern, made_for = outfit(patterns, body, made_for=made_for), None
    with errors_about(options.files[0]):
        worn = drape_pattern(
            pattern,
            body,
            fabric=fabric,
            vertices=DEFAULT_VERTICES if options.vertices is None else options.vertices,
            tucked=options.tucked,
            made_for=made_for,
            watch=LongWait("draping"),
        )
    for note in worn.report.notes:
        say(f"note: {shown_path(options.files[0])}: {one_line(note)}")
    remark = (
        explain_vertex_count(worn.cloth.vertex_count, options.vertices) if options.vertices else ""
    )
    if remark:
        say(f"warning: {shown_path(options.files[0])}: {remark}")
    accept(worn, options)
    return worn


def accept(worn: "DrapedGarment", options: argparse.Namespace) -> None:
    """Refuse a drape that went wrong, or only say so where it is wanted all the same."""
    from garmentimage.drape import check_drape

    if options.keep_bad:
        for fault in worn.report.faults:
            say(f"warning: {shown_path(options.files[0])}: {one_line(fault)}")
    else:
        with errors_about(options.files[0]):
            check_drape(worn)


def _pattern(path: Path) -> "Pattern":
    """A pattern from its file, or the one in a GarmentImage."""
    if path.suffix.lower() in IMAGE_SUFFIXES:
        from garmentimage.raster import load_channels, load_image
        from garmentimage.raster.decode import decode

        load = load_channels if path.suffix.lower() == ".npy" else load_image
        source = load(path)
        with errors_about(path):
            return decode(source).renamed(path.stem)
    if path.suffix.lower() == ".glb":
        raise DrapeError(
            f"{shown_path(path)}: is a garment already draped; drape its pattern, or photograph it "
            "with `garmentimage render`"
        )
    from garmentimage.pattern.files import read_pattern

    pattern, found = read_pattern(path)
    warn(path, found)
    return pattern


def _body_name(patterns: "list[Pattern]", options: argparse.Namespace) -> str:
    """The body that is asked for; where any is, the one on which the garment fits best."""
    from garmentimage.drape import AUTO, best_fit

    name = _or(options.body, BODY)
    if name != AUTO:
        return name
    with errors_about(options.files[0]):
        best = best_fit(patterns, made_for=options.made_for, pose=_or(options.pose, POSE))
    say(f"body: {best}" + ("" if best.tight == 0 else "; too tight on all, least on this one"))
    return best.body


def _body(name: str, pose: str | None) -> "Body":
    """A shipped body, or one from a mesh file, which stands as it stands."""
    from garmentimage.body import MESH_FORMATS, load_body, load_body_file, stand_straight

    ending = Path(name).suffix.lower().removeprefix(".")
    if ending == "json":
        raise DraftError(
            f"{shown_path(name)}: measurements have no shape to be draped on; name a shipped body "
            f"or a mesh ({', '.join(MESH_FORMATS)})"
        )
    if ending not in MESH_FORMATS:
        return stand_straight(load_body(name, _or(pose, POSE)))
    if pose is not None:
        raise DraftError(f"{shown_path(name)}: stands as it does; --pose is for shipped bodies")
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        body = load_body_file(name)
    for one in found:
        say(f"warning: {shown_path(name)}: {one_line(one.message)}")
    return body


def body_file(options: argparse.Namespace) -> list[Path]:
    """The mesh file of the body, if one is named."""
    from garmentimage.body import MESH_FORMATS

    path = Path(_or(options.body, BODY))
    return [path] if path.suffix.lower().removeprefix(".") in MESH_FORMATS else []


def _or(text: str | None, default: str) -> str:
    return default if text is None else text


# --- reports -------------------------------------------------------------------------------------


def worn_facts(worn: "DrapedGarment") -> dict[str, Any]:
    """A drape for JSON."""
    report = asdict(worn.report)
    return {
        "body": worn.body.name,
        "pose": worn.body.pose,
        "panels": len(worn.cloth.pattern.panels),
        "vertices": worn.cloth.vertex_count,
        "report": report | {"slid": dict(worn.report.slid)},
    }


def told(worn: "DrapedGarment") -> str:
    """A drape in words."""
    report: DrapeReport = worn.report
    rest = "at rest" if report.settled else "still moving"
    slid = " and ".join(f"{far:.1f} cm off the {place}" for place, far in report.slid.items())
    words = [
        f"{worn.cloth.vertex_count} vertices {rest} after {report.frames} frames",
        f"stretched by {report.strain:.0%}",
        f"{report.penetration:.1f} cm under the skin",
        *([slid] if slid else []),
        f"{report.crossings} triangles through other cloth",
        f"{report.seconds:.1f} s",
    ]
    return ", ".join(words)
