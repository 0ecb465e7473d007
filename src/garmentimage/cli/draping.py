"""Garments on a body, for the verbs `drape` and `render`: options, draping, facts."""

import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Group, Parameter

from garmentimage.cli.options import DEFAULT_BODY, Whole, read_or_decode
from garmentimage.cli.terminal import LongWait, one_line, print_line
from garmentimage.errors import DraftError, DrapeError
from garmentimage.system import errors_about, shown_path

if TYPE_CHECKING:
    from garmentimage.body import Body
    from garmentimage.drape import DrapedGarment
    from garmentimage.pattern import Pattern


@Parameter(name="*", group=Group("Draping", "How patterns are draped.", sort_key=2))
@dataclass(frozen=True)
class DrapeOptions:
    """How patterns are draped."""

    body: Annotated[str, Parameter(metavar="BODY")] = DEFAULT_BODY
    """A shipped body, auto for the one that the garment fits best, or a mesh file."""
    pose: Literal["t", "a"] = "t"
    """Arms stretched out, or 45 degrees down."""
    fabric: Literal["cotton", "denim", "jersey", "silk", "wool"] = "cotton"
    """What the cloth is made of."""
    vertices: Whole = 2000
    """About how many vertices the cloth has."""
    tucked: bool = False
    """Wear tops under skirts and trousers."""
    made_for: Annotated[float | None, Parameter(metavar="CM")] = None
    """Stature that the pattern was made for; it is then scaled to the body's."""


DRAPING = DrapeOptions()
"""The defaults."""


def drape_files(files: Sequence[Path], options: DrapeOptions, *, keep_bad: bool) -> "DrapedGarment":
    """The garments of some files on a body."""
    from garmentimage.drape import drape_pattern, load_fabric, outfit
    from garmentimage.drape.mesh import explain_vertex_count

    fabric = load_fabric(options.fabric)
    patterns = [_pattern(path) for path in files]
    body = _body(patterns, files[0], options)
    pattern, made_for = patterns[0], options.made_for
    if len(patterns) > 1:
        # Each garment is scaled by itself then.
        pattern, made_for = outfit(patterns, body, made_for=made_for), None
    with errors_about(files[0]):
        worn = drape_pattern(
            pattern,
            body,
            fabric=fabric,
            vertices=options.vertices,
            tucked=options.tucked,
            made_for=made_for,
            watch=LongWait("draping"),
        )
    for note in worn.report.notes:
        print_line(f"note: {shown_path(files[0])}: {one_line(note)}")
    wanted, made = options.vertices, worn.cloth.vertex_count
    if wanted != DrapeOptions.vertices and (remark := explain_vertex_count(made, wanted)):
        print_line(f"warning: {shown_path(files[0])}: {remark}")
    accept(worn, files[0], keep_bad=keep_bad)
    return worn


def _pattern(path: Path) -> "Pattern":
    if path.suffix.lower() == ".glb":
        raise DrapeError(
            f"{shown_path(path)}: is a garment already draped; drape its pattern, or photograph it "
            "with `garmentimage render`"
        )
    return read_or_decode(path)


def accept(worn: "DrapedGarment", file: Path, *, keep_bad: bool) -> None:
    """Refuse a drape that failed its checks, or only warn of it if it is to be kept."""
    from garmentimage.drape import check_drape

    if keep_bad:
        for fault in worn.report.faults:
            print_line(f"warning: {shown_path(file)}: {one_line(fault)}")
    else:
        with errors_about(file):
            check_drape(worn)


# --- Bodies --------------------------------------------------------------------------------------


def body_file(options: DrapeOptions) -> list[Path]:
    """The mesh file of the body, if one is named."""
    from garmentimage.body import MESH_FORMATS

    path = Path(options.body)
    return [path] if path.suffix.lower().removeprefix(".") in MESH_FORMATS else []


def _body(patterns: "Sequence[Pattern]", file: Path, options: DrapeOptions) -> "Body":
    """The shipped body, the one that the garment fits best, or the one of a mesh file."""
    from garmentimage.body import MESH_FORMATS, load_body, load_body_file, stand_straight

    name = _best_body(patterns, file, options)
    ending = Path(name).suffix.lower().removeprefix(".")
    if ending == "json":
        raise DraftError(
            f"{shown_path(name)}: measurements have no shape to be draped on; name a shipped body "
            f"or a mesh ({', '.join(MESH_FORMATS)})"
        )
    if ending not in MESH_FORMATS:
        return stand_straight(load_body(name, options.pose))
    if options.pose != DrapeOptions.pose:
        raise DraftError(f"{shown_path(name)}: keeps its own pose; --pose is for shipped bodies")
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        body = load_body_file(name)
    for one in found:
        print_line(f"warning: {shown_path(name)}: {one_line(one.message)}")
    return body


def _best_body(patterns: "Sequence[Pattern]", file: Path, options: DrapeOptions) -> str:
    """The body that is named; for auto, the one on which the garment fits best."""
    from garmentimage.drape import AUTO, best_fit

    if options.body != AUTO:
        return options.body
    with errors_about(file):
        best = best_fit(list(patterns), made_for=options.made_for, pose=options.pose)
    remark = "" if best.tight == 0 else "; too tight on all, least on this one"
    print_line(f"body: {best}{remark}")
    return best.body


# --- Reports -------------------------------------------------------------------------------------


def worn_facts(worn: "DrapedGarment") -> dict[str, Any]:
    """A drape for JSON."""
    return {
        "body": worn.body.name,
        "pose": worn.body.pose,
        "panels": len(worn.cloth.pattern.panels),
        "vertices": worn.cloth.vertex_count,
        "report": asdict(worn.report) | {"slid": dict(worn.report.slid)},
    }
