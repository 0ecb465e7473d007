"""A pattern as a flat drawing: panels, seams in matching colours and numbers, grain, scale.

A seam is a run of stitches that follow each other on both sides; it gets one colour and one number.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from garmentimage.geometry import centroid
from garmentimage.pattern import Pattern, Side, fold_lines, sewn_runs
from garmentimage.render.flat.arrangement import DrawnPanel, arrange, bounds
from garmentimage.render.style import (
    FAINT,
    INK,
    LAYER_TINTS,
    SEAM_COLOURS,
    SEWN_ON,
    printable,
    write,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.path import Path

CURVE_CHORDS = 24  # chords that draw one curved edge
SCALE_BAR_CM = 20.0
LETTERING = 6.0  # size of names and numbers [points]; names shrink to fit their panel ..
MIN_LETTERING = 3.0  # ... down to this size
NUMBER_SPACE = 1.3  # a number's middle keeps this many sizes of the lettering away from a name
_LETTER_WIDTH = 0.62  # mean width of a letter, in sizes of the lettering
GRAIN_SHARE = 0.14
"""Half of a grain arrow, as a share of the panel along the grain; it shrinks to find room ..."""
GRAIN_SIZES = (1.0, 0.7, 0.5, 0.35)  # ... to these shares of it
GRAIN_SPACES = (1.8, 0.4)
"""An arrow keeps this many sizes of the lettering away from the panel's edges: where there is room
so many that it clears the numbers beside them."""
GRAIN_SPOTS = 25  # places for an arrow that are tried along each side of the panel's box
MAX_NUMBERS = 60
"""With more seams than this the numbers would hide the drawing and are left out."""
MAX_NAMES = 40  # with more panels than this the names are left out


def drawn_size(pattern: Pattern) -> tuple[float, float]:
    """Width and height that the panels take in `draw_pattern` [cm]."""
    low, high = bounds(arrange(pattern))
    return float(high[0] - low[0]), float(high[1] - low[1])


def draw_pattern(pattern: Pattern, ax: "Axes", *, room: tuple[float, float] = (0.0, 0.0)) -> None:
    """Draw all panels of a pattern on matplotlib axes, whose frame is set so that 1 unit = 1 cm.

    `room` is the least width and height [cm]: given the largest `drawn_size` of several patterns,
    all are drawn at one scale.
    """
    placed = arrange(pattern)
    low, high = bounds(placed)
    spare = np.maximum(np.array(room) - (high - low), 0.0) / 2
    size = float((high - low + 2 * spare).max())
    pad = 0.03 * size
    ax.set_xlim(low[0] - spare[0] - pad, high[0] + spare[0] + pad)
    ax.set_ylim(low[1] - spare[1] - 3.5 * pad, high[1] + spare[1] + 2.5 * pad)
    ax.set_aspect("equal")
    ax.set_axis_off()
    letter = LETTERING * _cm_per_point(ax)
    seams = seam_numbers(pattern)
    _draw_cloth(placed, ax)
    _draw_edges(placed, seams, ax)
    _draw_sewn_on(pattern, placed, letter, ax)
    _draw_folds(pattern, placed, ax)
    named = len(placed) <= MAX_NAMES
    for p in placed:
        if (ends := _grain_arrow(p, letter, named=named)) is not None:
            look = {"arrowstyle": "<|-|>", "color": FAINT, "lw": 0.7, "mutation_scale": 6}
            ax.annotate("", ends[1], ends[0], arrowprops=look, zorder=3)
        if named:
            _draw_name(p, letter, ax)
        if max(seams.values(), default=0) <= MAX_NUMBERS:
            _draw_numbers(p, seams, letter, ax, named=named)
    if len({p.back for p in placed}) == 2:
        _draw_titles(placed, pad, ax)
    _draw_scale_bar(low, size, ax)


def _cm_per_point(ax: "Axes") -> float:
    """What one point of lettering measures in the drawing [cm]; needs the limits of the axes."""
    box = ax.get_window_extent()
    points = 72 / ax.figure.dpi
    (x0, x1), (y0, y1) = ax.get_xlim(), ax.get_ylim()
    return max((x1 - x0) / (box.width * points), (y1 - y0) / (box.height * points))


def seam_numbers(pattern: Pattern) -> dict[Side, int]:
    """A number from 1 up for every sewn side, the same for both sides of a seam.

    Stitches whose sides follow each other on both panels count as one seam. Numbers go by the
    names of the panels, then from the wearer's right to the left and upwards; they do not depend
    on the order of panels or stitches, so two versions of a pattern are easily compared.
    """
    runs = sewn_runs(pattern)

    def place(k: int) -> tuple[list[str], list[float], int]:
        sides = runs[k].sides + runs[runs[k].partner].sides
        points = [
            pattern.by_name[side.panel].to_world(pattern.curve(side).sample(2)[1:2])[0]
            for side in sides
        ]
        return sorted({side.panel for side in sides}), np.mean(points, axis=0).round(3).tolist(), k

    seams = sorted((k for k, run in enumerate(runs) if k <= run.partner), key=place)
    number = {k: n for n, k in enumerate(seams, start=1)}
    return {side: number[min(k, run.partner)] for k, run in enumerate(runs) for side in run.sides}


def seam_colour(number: int) -> str:
    """Colour of a seam by its number."""
    return SEAM_COLOURS[(number - 1) % len(SEAM_COLOURS)]


def _lines(placed: DrawnPanel) -> list[Float[np.ndarray, "_ 2"]]:
    """Every edge of the panel as a polyline in the picture, numbered as `Panel.edges`."""
    return [
        placed.place(curve.sample(1 if curve.is_straight else CURVE_CHORDS))
        for curve in placed.panel.curves
    ]


def _draw_cloth(placed: tuple[DrawnPanel, ...], ax: "Axes") -> None:
    from matplotlib.collections import PathCollection

    # One collection for all panels: thousands of patches would take a minute.
    paths, tints = [_cloth_path(p) for p in placed], [LAYER_TINTS[int(p.back)] for p in placed]
    ax.add_collection(PathCollection(paths, facecolors=tints, edgecolors="none", zorder=1))


def _cloth_path(placed: DrawnPanel) -> "Path":
    """Outline and holes; holes show the paper because they run against the outline."""
    from matplotlib.path import Path

    outline, *holes = placed.panel.loops
    loops = [outline.polygon] + [
        hole.polygon if hole.area * outline.area < 0 else hole.polygon[::-1] for hole in holes
    ]
    rings = [placed.place(np.concatenate([points, points[:1]])) for points in loops]
    return Path.make_compound_path(*(Path(ring, closed=True) for ring in rings))


def _draw_edges(placed: tuple[DrawnPanel, ...], seams: dict[Side, int], ax: "Axes") -> None:
    from matplotlib.collections import LineCollection

    lines = [line for p in placed for line in _lines(p)]
    numbers = [seams.get(Side(p.panel.name, k)) for p in placed for k in range(len(p.panel.edges))]
    colours = [INK if n is None else seam_colour(n) for n in numbers]
    widths = [0.9 if n is None else 1.7 for n in numbers]
    ax.add_collection(
        LineCollection(lines, colors=colours, linewidths=widths, capstyle="round", zorder=2)
    )


def _draw_sewn_on(
    pattern: Pattern, placed: tuple[DrawnPanel, ...], letter: float, ax: "Axes"
) -> None:
    """Dashed, on the panels beneath, where others are sewn on, with their names."""
    from matplotlib.collections import LineCollection

    drawn = {each.panel.name: each for each in placed}
    for sewn in pattern.onto:
        base, own = drawn[sewn.on], drawn[sewn.panel]
        curves = (pattern.curve(side) for side in sewn.sides)
        lines = [
            sewn.carried(curve.sample(1 if curve.is_straight else CURVE_CHORDS)) for curve in curves
        ]
        own_lines = _lines(own)
        for points, width, dashes in (
            ([base.place(line) for line in lines], 1.1, (0, (3, 2))),
            ([own_lines[k] for k in sewn.edges], 1.8, "solid"),
        ):
            look = {"colors": SEWN_ON, "linewidths": width, "linestyles": dashes}
            ax.add_collection(LineCollection(points, zorder=2.6, **look))
        drawn_lines = np.concatenate([base.place(line) for line in lines])
        x, y = float(drawn_lines[:, 0].mean()), float(drawn_lines[:, 1].min())
        size = 0.8 * letter / _cm_per_point(ax)
        write(ax, x, y - letter / 4, printable(sewn.panel), color=SEWN_ON, fontsize=size, va="top")


def _draw_folds(pattern: Pattern, placed: tuple[DrawnPanel, ...], ax: "Axes") -> None:
    """The folds of pressed pleats: dashed where they are seen, dotted beneath."""
    from matplotlib.collections import LineCollection

    drawn = {each.panel.name: each for each in placed}
    for is_seen, dashes in ((True, (0, (4, 2))), (False, (0, (1, 2)))):
        lines = [
            drawn[pleat.panel].place(np.array([fold.start, fold.end]))
            for pleat in pattern.pleats
            for fold in fold_lines(pattern, pleat)
            if fold.is_seen == is_seen
        ]
        look = {"colors": INK, "linewidths": 0.7, "linestyles": dashes}
        ax.add_collection(LineCollection(lines, zorder=2.5, **look))


def _draw_numbers(
    placed: DrawnPanel, seams: dict[Side, int], letter: float, ax: "Axes", *, named: bool
) -> None:
    """One number a seam, beside the middle of its longest edge; outside where cloth is narrow.

    A number that would touch the panel's name stands outside, too.
    """
    longest: dict[int, tuple[float, int]] = {}
    lines = _lines(placed)
    for k, curve in enumerate(placed.panel.curves):
        number = seams.get(Side(placed.panel.name, k))
        if number is not None and curve.length > longest.get(number, (0.0, 0))[0]:
            longest[number] = (curve.length, k)
    low, high = bounds([placed])
    inset = letter if (high - low).min() > 5 * letter else -letter
    name = _lettering(placed, letter)
    # A dart has one number for two legs: the longer leg wears it.
    for number, (_, k) in sorted(longest.items()):
        x, y = _beside_edge(placed, lines[k], inset)
        if named and name.touches(x, y, NUMBER_SPACE * letter):
            x, y = _beside_edge(placed, lines[k], -abs(inset))
        look = {"color": seam_colour(number), "fontsize": LETTERING, "fontweight": "bold"}
        write(ax, x, y, str(number), zorder=4, **look)


def _beside_edge(
    placed: DrawnPanel, line: Float[np.ndarray, "n 2"], inset: float
) -> Float[np.ndarray, " 2"]:
    """A point `inset` cm inside the panel, beside the middle of one of its edges."""
    k = (len(line) - 1) // 2
    middle, along = (line[k] + line[k + 1]) / 2, line[k + 1] - line[k]
    normal = np.array([-along[1], along[0]]) / max(float(np.hypot(*along)), 1e-12)
    inward = np.sign(placed.panel.outline.area) * np.sign(np.linalg.det(placed.matrix))
    place: np.ndarray = middle + inset * inward * normal
    return place


def _grain_arrow(
    placed: DrawnPanel, letter: float, *, named: bool
) -> Float[np.ndarray, "2 2"] | None:
    """Ends of the longest arrow along the grain that lies on cloth and clear of the panel's name.

    Of arrows as long, the one nearest above the name; None without a grain or where not even a
    short one has room.
    """
    import shapely

    if placed.panel.grain is None:
        return None
    along = placed.matrix @ np.array(placed.panel.grain)
    upwards = along if along[1] >= 0 else -along
    outline, *holes = (placed.place(loop.polygon) for loop in placed.panel.loops)
    cloth = shapely.Polygon(outline, holes).buffer(0)
    name = _lettering(placed, letter)
    turn = np.deg2rad(name.angle)
    half_name = name.length / 2 * np.array([np.cos(turn), np.sin(turn)])
    line = shapely.LineString([name.middle - half_name, name.middle + half_name])
    lettering = line.buffer(letter) if named else shapely.Polygon()
    low, high = bounds([placed])
    axes = [np.linspace(a, b, GRAIN_SPOTS) for a, b in zip(low, high, strict=True)]
    spots = np.stack(np.meshgrid(*axes), axis=2).reshape(-1, 2)
    longest = GRAIN_SHARE * float(np.ptp(outline @ along))
    for space in GRAIN_SPACES:
        room = cloth.buffer(-space * letter).difference(lettering)
        for half in longest * np.array(GRAIN_SIZES):
            above = name.middle + (half + letter) * upwards
            ends = np.stack([spots - half * along, spots + half * along], axis=1)
            free = ends[shapely.contains(room, shapely.linestrings(ends))]
            if len(free):
                nearest: np.ndarray = free[np.argmin(np.hypot(*(free.mean(axis=1) - above).T))]
                return nearest
    return None


def _inner_point(placed: DrawnPanel) -> Float[np.ndarray, " 2"]:
    """The centroid where it lies on cloth, else some point that does."""
    from shapely import Point, Polygon

    panel = placed.panel
    shape = Polygon(panel.outline.polygon, [h.polygon for h in panel.holes])
    centre = centroid(panel.outline.polygon)
    if not shape.is_valid or not shape.contains(Point(*centre)):
        inner = shape.buffer(0).representative_point()
        centre = centre if inner.is_empty else np.array([inner.x, inner.y])
    middle: np.ndarray = placed.place(centre[None])[0]
    return middle


@dataclass(frozen=True)
class _Lettering:
    """Where a panel's name stands in the picture."""

    text: str
    middle: Float[np.ndarray, " 2"]
    angle: float  # counter-clockwise [degrees]
    length: float  # [cm]
    share: float  # size of the letters, in full sizes

    def touches(self, x: float, y: float, space: float) -> bool:
        """Whether a point lies on the line of letters or nearer to it than `space` [cm]."""
        c, s = np.cos(np.deg2rad(self.angle)), np.sin(np.deg2rad(self.angle))
        away = np.array([x, y]) - self.middle
        along, across = abs(c * away[0] + s * away[1]), abs(c * away[1] - s * away[0])
        return bool(along < self.length / 2 + space and across < space)


def _lettering(placed: DrawnPanel, letter: float) -> _Lettering:
    """The name across the panel, or along it where it is too narrow."""
    name = printable(placed.panel.name)
    low, high = bounds([placed])
    needed = _LETTER_WIDTH * letter * max(len(name), 1)
    room, angle = 0.8 * float(high[0] - low[0]), 0.0
    if needed > room:
        length, angle = _long_axis(placed)
        room = 0.8 * length
    share = max(min(1.0, room / needed), MIN_LETTERING / LETTERING)
    return _Lettering(name, _inner_point(placed), angle, needed * share, share)


def _draw_name(placed: DrawnPanel, letter: float, ax: "Axes") -> None:
    name = _lettering(placed, letter)
    (x, y), size, turned = name.middle, LETTERING * name.share, name.angle
    style = {"color": INK, "fontsize": size, "rotation": turned, "rotation_mode": "anchor"}
    write(ax, x, y, name.text, zorder=5, **style)


def _long_axis(placed: DrawnPanel) -> tuple[float, float]:
    """Length [cm] and angle [degrees, -90 to 90] of the longer side of the narrowest box."""
    from shapely import MultiPoint

    box = MultiPoint(placed.polygon).minimum_rotated_rectangle
    if box.geom_type != "Polygon":
        return 0.0, 0.0
    corners = np.array(box.exterior.coords)
    sides = corners[1:3] - corners[:2]
    side = sides[int(np.argmax(np.hypot(*sides.T)))]
    angle = float(np.rad2deg(np.arctan2(side[1], side[0])))
    return float(np.hypot(*side)), (angle + 90) % 180 - 90


def _draw_titles(placed: tuple[DrawnPanel, ...], pad: float, ax: "Axes") -> None:
    """Name the front and the back group above their panels, where the groups stand apart."""
    front, back = (bounds([p for p in placed if p.back == side]) for side in (False, True))
    beside, below = back[0, 0] > front[1, 0], back[1, 1] < front[0, 1]
    if not (beside or below):
        return
    for title, box in (("front", front), ("back", back)):
        top = max(front[1, 1], back[1, 1]) if beside else box[1, 1]
        write(ax, box[:, 0].mean(), top + pad, title, fontsize=7, va="baseline")


def _draw_scale_bar(low: np.ndarray, size: float, ax: "Axes") -> None:
    x, y = float(low[0]), float(low[1]) - 0.07 * size
    tick = 0.012 * size
    end = x + SCALE_BAR_CM
    line = [x, x, x, end, end, end], [y - tick, y + tick, y, y, y + tick, y - tick]
    ax.plot(*line, color=FAINT, linewidth=0.8, solid_capstyle="butt")
    write(ax, end + 0.01 * size, y, f"{SCALE_BAR_CM:.0f} cm", fontsize=6, ha="left")
