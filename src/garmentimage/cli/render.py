"""The verb of the command line that photographs garments on a body: render."""

import argparse
import difflib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from garmentimage.cli.drape import (
    WORN_OPTIONS,
    accept,
    add_view_options,
    add_worn_options,
    body_file,
    worn_facts,
    worn_from,
)
from garmentimage.cli.terminal import Exit, print_json, whole_number
from garmentimage.errors import RenderError, quoted
from garmentimage.system import check_output, shown_path, write_together

if TYPE_CHECKING:
    from garmentimage.drape import DrapedGarment
    from garmentimage.render.worn import Look, Print, Tint

WORN_SUFFIX = ".glb"
PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg", ".webp", ".bmp", ".tif", ".tiff")
"""Endings by which a picture is told from a colour or from a print of ours."""
MAP_NAMES = ("depth", "normal", "panels", "silhouette")
GROUPS = ("top", "bottom", "dress")
PRINTS: Mapping[str, float] = MappingProxyType({"stripes": 4.0, "checks": 5.0, "dots": 4.0})
"""Prints of ours, and after what they repeat where it is not told [cm]."""
PALE_INK, DARK_INK = "#fbfaf6", "#2f3a4a"
"""What a print adds to the colour of its cloth, the second one on cloth ..."""
PALE_CLOTH = 0.9
"""... whose mean of red, green and blue is from here to 1."""
REPEATS = (0.1, 1000.0)
"""After what a print may repeat [cm]."""
PICTURE_WIDTH = 20.0
"""Width of a picture printed on cloth [cm], where none is told."""


def render_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `render`."""
    parser.add_argument(
        "files",
        nargs="+",
        type=Path,
        metavar="FILE",
        help="a garment that `drape` wrote (.glb), or patterns to be draped",
    )
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="OUT.png")
    add_view_options(parser)
    look = parser.add_argument_group("look", "PART is a panel, a label, top, bottom or dress")
    look.add_argument(
        "--colour",
        nargs="+",
        action="extend",
        default=[],
        type=_part_tint,
        metavar="[PART=]TINT",
        help="colours of the cloth: a name such as navy, or #rrggbb",
    )
    look.add_argument(
        "--print",
        nargs="+",
        action="extend",
        default=[],
        type=_part_print,
        metavar="[PART=]PRINT",
        help="stripes, checks, dots or a picture file; with the colour of the cloth",
    )
    look.add_argument("--repeat", type=_repeat, metavar="CM", help="after which a print repeats")
    look.add_argument("--skin", type=_tint, metavar="TINT", help="colour of the body")
    look.add_argument(
        "--background", type=_backdrop, metavar="TINT|FILE", help="a colour or a picture file"
    )
    look.add_argument("--seams", action="store_true", help="draw seams and hems as lines")
    look.add_argument(
        "--look",
        type=_seed,
        metavar="SEED",
        help="light, colours, prints, skin, background and camera at random; what is told stays",
    )
    maps = parser.add_argument_group("maps of the same view")
    for name, words in zip(
        MAP_NAMES,
        (
            "distance from the camera, 16 bits, in tenths of a millimetre",
            "directions of the surfaces as colours",
            "0 nothing, 1 body, number of the panel + 2",
            "where cloth is seen",
        ),
    ):
        maps.add_argument(f"--{name}", type=Path, metavar="OUT.png", help=words)
    worn = parser.add_argument_group("draping, of patterns only")
    add_worn_options(worn)


def run_render(options: argparse.Namespace) -> Exit:
    """Photograph a garment and write the picture, and maps of the same view."""
    from garmentimage.render import png_bytes
    from garmentimage.render.worn import body_camera, map_bytes, photograph

    maps = {name: getattr(options, name) for name in MAP_NAMES if getattr(options, name)}
    pictures = [kind for _, kind in options.print] + [options.background or ""]
    taken = [*options.files, *body_file(options), *map(Path, filter(_is_picture, pictures))]
    for path in (options.out, *maps.values()):
        check_output(path, (".png",), taken)
        taken.append(path)
    if options.repeat is not None and not options.print:
        raise RenderError("--repeat is for a print; choose one with --print")
    worn = _worn(options)
    look = _look(options, worn)
    views = photograph(worn, look, view=options.view, size=options.size, seams=options.seams)
    results = {options.out: png_bytes(views.colour)}
    results |= {path: map_bytes(views, name) for name, path in maps.items()}
    write_together(results)
    if options.json:
        camera = look.camera(body_camera(worn.body, options.view))
        print_json(
            {
                "out": str(options.out),
                "maps": {k: str(path) for k, path in maps.items()},
                "view": options.view,
                "size": options.size,
                "camera": {**asdict(camera), "stand": camera.stand},
                "panel_names": [panel.name for panel in worn.cloth.pattern.panels],
                **worn_facts(worn),
            }
        )
    else:
        words = ", ".join(shown_path(path) for path in results)
        seen = f"the {options.view} of {worn.cloth.pattern.name or 'the garment'}"
        print(f"{words}: written, {seen} on {worn.body.name}, {options.size} pixels")
    return Exit.OK


def _worn(options: argparse.Namespace) -> "DrapedGarment":
    """The garment of a `.glb`, or one draped from patterns."""
    for path in options.files:
        suffix = path.suffix.lower()
        if suffix in (".obj", ".ply"):
            raise RenderError(
                f"{shown_path(path)}: does not hold all of a worn garment; write a .glb with "
                "`garmentimage drape`"
            )
        if suffix == WORN_SUFFIX:
            return _read_worn(path, options)
    return worn_from(options)


def _read_worn(path: Path, options: argparse.Namespace) -> "DrapedGarment":
    from garmentimage.drape.files import load_drape

    if len(options.files) > 1:
        raise RenderError(
            f"{shown_path(path)}: is draped already; to wear garments together, drape their "
            "patterns together"
        )
    given = [name for name in WORN_OPTIONS if _is_given(getattr(options, name))]
    if given:
        raise RenderError(
            f"{shown_path(path)}: is draped already; --{given[0].replace('_', '-')} is for patterns"
        )
    worn = load_drape(path)
    accept(worn, options)
    return worn


def _is_given(value: object) -> bool:
    return value is not None and value is not False


# --- look ----------------------------------------------------------------------------------------


def _look(options: argparse.Namespace, worn: "DrapedGarment") -> "Look":
    """A plain or a random look, as the options change it.

    Raises:
        RenderError: a part that the garment has not, or a picture file that will not do.
    """
    from dataclasses import replace

    from garmentimage.render.worn import Look, plain, scenery

    look = Look()
    if options.look is not None:
        import numpy as np

        look = Look.random(np.random.default_rng(options.look))
    groups = _part_groups(worn)
    if options.colour:
        # A print would hide the colour that was asked for.
        colours = {**look.colours, **dict(_by_part(options.colour, groups))}
        look = replace(look, colours=colours, prints={})
    if options.print:
        prints = {
            part: _print(kind, look.colours.get(part) or look.colours[groups[part]], options.repeat)
            for part, kind in _by_part(options.print, groups)
        }
        look = replace(look, prints=prints)
    if options.skin:
        look = replace(look, skin=options.skin)
    if options.background:
        is_file = _is_picture(options.background)
        backdrop = scenery(options.background) if is_file else plain(options.background)
        look = replace(look, background=backdrop)
    return look


def _part_groups(worn: "DrapedGarment") -> Mapping[str, str]:
    """The group of everything that PART may name: groups, panels and their labels."""
    from garmentimage.render.worn import panel_groups

    found = {group: group for group in GROUPS}
    for panel, group in zip(worn.cloth.pattern.panels, panel_groups(worn)):
        found |= {name: group for name in (panel.name, panel.label) if name}
    return found


def _by_part(
    pairs: Iterable[tuple[str | None, str]], groups: Mapping[str, str]
) -> Iterator[tuple[str, str]]:
    """Each part with what was told for it; without a part, for all cloth."""
    for part, value in pairs:
        if part is None:
            yield from ((group, value) for group in GROUPS)
        elif part in groups:
            yield part, value
        else:
            near = difflib.get_close_matches(part, groups, n=1)
            hint = f"did you mean {near[0]}" if near else f"its panels are {', '.join(groups)}"
            raise RenderError(f"the garment has no part {quoted(part)}; {hint}")


def _print(kind: str, tint: "Tint", repeat: float | None) -> "Print":
    """A print of ours on the colour of the cloth, or a picture."""
    from garmentimage.render.worn import checks, dots, picture_print, rgb, stripes

    if _is_picture(kind):
        return picture_print(kind, width=PICTURE_WIDTH if repeat is None else repeat)
    ink = PALE_INK if rgb(tint).mean() < PALE_CLOTH else DARK_INK
    period = PRINTS[kind] if repeat is None else repeat
    match kind:
        case "stripes":
            return stripes(tint, ink, period=period)
        case "checks":
            return checks(tint, ink, period=period)
    return dots(tint, ink, period=period)


def _is_picture(text: str) -> bool:
    return text.lower().endswith(PICTURE_SUFFIXES)


# --- options -------------------------------------------------------------------------------------


def _part_tint(text: str) -> tuple[str | None, str]:
    part, _, tint = text.rpartition("=")
    return part or None, _tint(tint)


def _part_print(text: str) -> tuple[str | None, str]:
    part, _, kind = text.rpartition("=")
    if kind not in PRINTS and not _is_picture(kind):
        raise argparse.ArgumentTypeError(
            f"there is no print {quoted(kind)}; choose {', '.join(PRINTS)} or a picture file"
        )
    return part or None, kind


def _backdrop(text: str) -> str:
    return text if _is_picture(text) else _tint(text)


def _repeat(text: str) -> float:
    low, high = REPEATS
    try:
        length = float(text)
    except ValueError:
        length = 0.0
    if not low <= length <= high:
        raise argparse.ArgumentTypeError(
            f"a print cannot repeat after {quoted(text)}; give {low:g} to {high:g} cm"
        )
    return length


def _seed(text: str) -> int:
    seed = whole_number(text)
    if seed < 0:
        raise argparse.ArgumentTypeError(f"the seed is {seed}; choose 0 or more")
    return seed


def _tint(text: str) -> str:
    from garmentimage.render.worn import rgb

    try:
        rgb(text)
    except RenderError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    return text
