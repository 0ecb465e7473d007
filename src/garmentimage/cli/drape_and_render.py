"""The verbs of garments on a body: drape, render."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Group, Parameter

from garmentimage.cli.draping import (
    DRAPING,
    DrapeOptions,
    accept,
    body_file,
    drape_files,
    worn_facts,
)
from garmentimage.cli.options import Files, Json, Out, Results, Several, Whole, within
from garmentimage.cli.terminal import print_json
from garmentimage.errors import RenderError, quoted
from garmentimage.system import check_output, did_you_mean, shown_path, write_together

if TYPE_CHECKING:
    from garmentimage.drape import DrapedGarment, DrapeReport
    from garmentimage.render.worn import Look, Print, Tint

PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg", ".webp", ".bmp", ".tif", ".tiff")
"""Endings that tell a picture from a colour or the name of a print."""
GARMENT_GROUPS = ("top", "bottom", "dress")
PRINTS: Mapping[str, float] = MappingProxyType({"stripes": 4.0, "checks": 5.0, "dots": 4.0})
"""Bundled prints, and after what they repeat by default [cm]."""
PALE_INK, DARK_INK = "#fbfaf6", "#2f3a4a"
"""What a print adds to the colour of its cloth, the second one on cloth ..."""
PALE_CLOTH = 0.9
"""... whose mean of red, green and blue is from here to 1."""
PICTURE_WIDTH = 20.0
"""Width of a picture printed on cloth, by default [cm]."""

Tints = Annotated[Several, Parameter(metavar="[PART=]COLOUR")]
MapFile = Annotated[Path | None, Parameter(metavar="OUT.png")]


KeepBad = Annotated[
    bool, Parameter(help="Accept a drape that failed its checks, too, with a warning.")
]


@Parameter(name="*")
@dataclass(frozen=True)
class ViewOptions:
    """From where a picture is taken, and how large it is."""

    view: Literal["front", "back", "side", "turned"] = "front"
    """Where the camera stands."""
    size: Annotated[Whole, Parameter(metavar="PX", validator=within(16, 2048, "pixels"))] = 512
    """Rows and columns of the picture."""


@Parameter(
    name="*",
    group=Group("Look", "PART is a panel, a label, top, bottom or dress.", sort_key=0),
)
@dataclass(frozen=True)
class LookOptions:
    """Colours, prints and surroundings."""

    colour: Tints = ()
    """Colours of the cloth: a name such as navy, or #rrggbb."""
    print: Annotated[Several, Parameter(metavar="[PART=]PRINT")] = ()
    """Prints: stripes, checks, dots or a picture file, over the colour of the cloth."""
    repeat: Annotated[float | None, Parameter(metavar="CM", validator=within(0.1, 1000, "cm"))] = (
        None
    )
    """Distance after which a print repeats."""
    skin: Annotated[str | None, Parameter(metavar="COLOUR")] = None
    """Colour of the body."""
    background: Annotated[str | None, Parameter(metavar="COLOUR|FILE")] = None
    """A colour, or a picture file."""
    seams: bool = False
    """Draw seams and hems as lines."""
    look: Annotated[Whole | None, Parameter(metavar="SEED", validator=within(0))] = None
    """Seed of random light, colours, prints, skin, background and camera; other options win."""


@Parameter(name="*", group=Group("Maps of the same view", sort_key=1))
@dataclass(frozen=True)
class MapOptions:
    """Files for maps of the same view."""

    depth: MapFile = None
    """Distance from the camera, 16 bits, in tenths of a millimetre."""
    normal: MapFile = None
    """Directions of the surfaces as colours."""
    panels: MapFile = None
    """0 where nothing is, 1 for the body, number of the panel + 2."""
    silhouette: MapFile = None
    """Where cloth is visible."""

    def chosen(self) -> dict[str, Path]:
        """Files by the name of their map."""
        named = {each.name: getattr(self, each.name) for each in fields(self)}
        return {name: path for name, path in named.items() if path is not None}


VIEW, LOOK, MAPS = ViewOptions(), LookOptions(), MapOptions()


# --- drape ---------------------------------------------------------------------------------------


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


# --- render --------------------------------------------------------------------------------------


def render(
    *files: Files,
    out: Out,
    view: ViewOptions = VIEW,
    look: LookOptions = LOOK,
    maps: MapOptions = MAPS,
    draping: DrapeOptions = DRAPING,
    keep_bad: KeepBad = False,
    json: Json = False,
) -> None:
    """Photograph garments on a body.

    Args:
        files: A garment that `drape` wrote (.glb), or patterns, which are draped first.
        out: The picture (.png).
    """
    from garmentimage.render import png_bytes
    from garmentimage.render.worn import body_camera, map_bytes, photograph

    colours, prints = _colours(look), _prints(look)
    pictures = [name for _, name in prints] + [look.background or ""]
    taken = [*files, *body_file(draping), *map(Path, filter(_is_picture, pictures))]
    for path in (out, *maps.chosen().values()):
        check_output(path, (".png",), taken)
        taken.append(path)
    worn = _worn(files, draping, keep_bad=keep_bad)
    style = _look(look, worn, colours, prints)
    views = photograph(worn, style, view=view.view, size=view.size, seams=look.seams)
    results: Results = {out: png_bytes(views.colour)}
    results |= {path: map_bytes(views, name) for name, path in maps.chosen().items()}
    write_together(results)
    if json:
        camera = style.camera(body_camera(worn.body, view.view))
        print_json(
            {
                "out": str(out),
                "maps": {name: str(path) for name, path in maps.chosen().items()},
                "view": view.view,
                "size": view.size,
                "camera": {**asdict(camera), "stand": camera.stand},
                "panel_names": [panel.name for panel in worn.cloth.pattern.panels],
                **worn_facts(worn),
            }
        )
    else:
        names = ", ".join(shown_path(path) for path in results)
        seen = f"the {view.view} of {worn.cloth.pattern.name or 'the garment'}"
        print(f"{names}: written, {seen} on {worn.body.name}, {view.size} pixels")


def _worn(files: Sequence[Path], draping: DrapeOptions, *, keep_bad: bool) -> "DrapedGarment":
    """The garment of a `.glb`, or one draped from patterns."""
    for path in files:
        suffix = path.suffix.lower()
        if suffix in (".obj", ".ply"):
            raise RenderError(
                f"{shown_path(path)}: does not hold all of a worn garment; write a .glb with "
                "`garmentimage drape`"
            )
        if suffix == ".glb":
            return _read_worn(path, files, draping, keep_bad=keep_bad)
    return drape_files(files, draping, keep_bad=keep_bad)


def _read_worn(
    path: Path, files: Sequence[Path], draping: DrapeOptions, *, keep_bad: bool
) -> "DrapedGarment":
    from garmentimage.drape.files import load_drape

    if len(files) > 1:
        raise RenderError(
            f"{shown_path(path)}: is draped already; to wear garments together, drape their "
            "patterns together"
        )
    for each in fields(draping):
        if getattr(draping, each.name) != each.default:
            raise RenderError(
                f"{shown_path(path)}: is draped already; --{each.name.replace('_', '-')} is for "
                "patterns"
            )
    worn = load_drape(path)
    accept(worn, path, keep_bad=keep_bad)
    return worn


# --- Look ----------------------------------------------------------------------------------------


def _colours(options: LookOptions) -> list[tuple[str, str]]:
    """Colours by part, `""` for all cloth; all colours of the options are checked."""
    from garmentimage.render.worn import rgb

    colours = [_split(word) for word in options.colour]
    surroundings = [options.skin, options.background]
    for colour in [colour for _, colour in colours] + [x for x in surroundings if x]:
        if not (colour == options.background and _is_picture(colour)):
            rgb(colour)
    return colours


def _prints(options: LookOptions) -> list[tuple[str, str]]:
    """Prints by part, `""` for all cloth."""
    prints = [_split(word) for word in options.print]
    for _, name in prints:
        if name not in PRINTS and not _is_picture(name):
            raise RenderError(
                f"there is no print {quoted(name)}; choose {', '.join(PRINTS)} or a picture file"
            )
    if options.repeat is not None and not prints:
        raise RenderError("--repeat is for a print; choose one with --print")
    return prints


def _split(word: str) -> tuple[str, str]:
    part, _, value = word.rpartition("=")
    return part, value


def _look(
    options: LookOptions,
    worn: "DrapedGarment",
    colours: Sequence[tuple[str, str]],
    prints: Sequence[tuple[str, str]],
) -> "Look":
    """A plain or a random look, as the options change it."""
    from garmentimage.render.worn import Look, plain, scenery

    look = Look()
    if options.look is not None:
        import numpy as np

        look = Look.random(np.random.default_rng(options.look))
    groups = _part_groups(worn)
    if colours:
        # A print would hide the colour that is wanted.
        chosen = {**look.colours, **dict(_by_part(colours, groups))}
        look = replace(look, colours=chosen, prints={})
    if prints:
        printed = {
            part: _print(name, look.colours.get(part) or look.colours[groups[part]], options.repeat)
            for part, name in _by_part(prints, groups)
        }
        look = replace(look, prints=printed)
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

    found = {group: group for group in GARMENT_GROUPS}
    for panel, group in zip(worn.cloth.pattern.panels, panel_groups(worn), strict=True):
        found |= {name: group for name in (panel.name, panel.label) if name}
    return found


def _by_part(
    pairs: Iterable[tuple[str, str]], groups: Mapping[str, str]
) -> Iterator[tuple[str, str]]:
    """Each part with its value; without a part, all groups of cloth with it."""
    for part, value in pairs:
        if not part:
            yield from ((group, value) for group in GARMENT_GROUPS)
        elif part in groups:
            yield part, value
        else:
            raise RenderError(
                f"the garment has no part {quoted(part)}; {did_you_mean(part, groups)}"
            )


def _print(name: str, tint: "Tint", repeat: float | None) -> "Print":
    """A bundled print on the colour of the cloth, or a picture."""
    from garmentimage.render.worn import checks, dots, picture_print, rgb, stripes

    if _is_picture(name):
        return picture_print(name, width=PICTURE_WIDTH if repeat is None else repeat)
    ink = PALE_INK if rgb(tint).mean() < PALE_CLOTH else DARK_INK
    period = PRINTS[name] if repeat is None else repeat
    if name == "stripes":
        return stripes(tint, ink, period=period)
    return (checks if name == "checks" else dots)(tint, ink, period=period)


def _is_picture(text: str) -> bool:
    return text.lower().endswith(PICTURE_SUFFIXES)
