"""The verb that puts garments on a body: drape."""

import warnings
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from garmentimage.cli.options import (
    DRAPING,
    VIEW,
    DrapeOptions,
    Files,
    Json,
    KeepBad,
    Out,
    Results,
    ViewOptions,
    read_or_decode,
)
from garmentimage.cli.terminal import (
    LongWait,
    errors_about,
    one_line,
    print_json,
    print_line,
)
from garmentimage.errors import DraftError, DrapeError
from garmentimage.system import check_output, shown_path, write_together

if TYPE_CHECKING:
    from garmentimage.body import Body
    from garmentimage.drape import DrapedGarment, DrapeReport
    from garmentimage.pattern import Pattern


def drape(
    *patterns: Files,
    out: Out,
    image: Annotated[Path | None, Parameter(metavar="OUT.png")] = None,
    view: ViewOptions = VIEW,
    draping: DrapeOptions = DRAPING,
    keep_bad: KeepBad = False,
    json: Json = False,
) -> None:
    """Put garments on a body.

    Args:
        patterns: Patterns or GarmentImages; several are worn together.
        out: The garment on the body (.glb, .obj or .ply).
        image: A picture of it, too (.png).
    """
    from garmentimage.drape.files import DRAPE_FORMATS, drape_bytes

    inputs = [*patterns, *body_file(draping)]
    check_output(out, DRAPE_FORMATS, inputs)
    if image:
        check_output(image, (".png",), [*inputs, out])
    worn = drape_files(patterns, draping, keep_bad=keep_bad)
    results: Results = {out: drape_bytes(worn, out.suffix)}
    if image:
        from garmentimage.render import png_bytes
        from garmentimage.render.worn import photograph

        views = photograph(worn, view=view.view, size=view.size)
        results[image] = png_bytes(views.colour)
    write_together(results)
    if json:
        print_json({"out": str(out), "image": str(image) if image else None, **worn_facts(worn)})
    else:
        print(f"{shown_path(out)}: written, {_summary(worn)}")


def drape_files(files: Sequence[Path], options: DrapeOptions, *, keep_bad: bool) -> "DrapedGarment":
    """The garments of some files on a body.

    Raises:
        GarmentImageError: a file, a body or a fabric is invalid, or the drape failed its checks
            and is not to be kept.
    """
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
    asked = options.vertices
    remark = (
        explain_vertex_count(worn.cloth.vertex_count, asked)
        if asked != DrapeOptions.vertices
        else ""
    )
    if remark:
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


def _summary(worn: "DrapedGarment") -> str:
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
