"""Mutations of pattern files: what strangers' tools, hands and networks do to a specification.

Each takes a specification (as `pattern_to_spec` gives it) and random numbers, changes the
specification in place and returns the result that is expected.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from garmentimage.pattern.model import euler_angles, rotation_matrix

Spec = dict[str, Any]


@dataclass(frozen=True)
class Expected:
    """The expected result of a mutated file, and how it was mutated."""

    what: str
    """With its numbers, to make it again by hand."""
    same: bool = False
    """The garment is the same as before: its panels, its seams and where it is worn."""
    near: float | None = 5.0
    """How far the cloth may lie from where that of the whole pattern lies [cm]; None: anywhere."""
    worn: bool = True
    """Whether it may be worn at all; else its drape must be an error."""


def _panels(spec: Spec) -> dict[str, Any]:
    return spec["pattern"]["panels"]


def _pick(spec: Spec, rng: np.random.Generator) -> tuple[str, dict[str, Any], int]:
    """A panel and one of its edges."""
    names = list(_panels(spec))
    name = names[int(rng.integers(len(names)))]
    panel = _panels(spec)[name]
    return name, panel, int(rng.integers(len(panel["edges"])))


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _sides(spec: Spec) -> list[dict[str, Any]]:
    return [side for stitch in spec["pattern"].get("stitches", []) for side in stitch[:2]]


def _renumber(spec: Spec, name: str, new: Callable[[int], int]) -> None:
    for side in _sides(spec):
        if side["panel"] == name:
            side["edge"] = new(side["edge"])


def nothing(spec: Spec, rng: np.random.Generator) -> Expected:
    return Expected("as it was", same=True)


def vertex_moved(spec: Spec, rng: np.random.Generator) -> Expected:
    name, panel, edge = _pick(spec, rng)
    far, angle = _log_uniform(rng, 0.01, 10.0), rng.uniform(0, 2 * np.pi)
    vertex = panel["edges"][edge]["endpoints"][0]
    panel["vertices"][vertex] = [
        panel["vertices"][vertex][0] + far * float(np.cos(angle)),
        panel["vertices"][vertex][1] + far * float(np.sin(angle)),
    ]
    return Expected(f"vertex {vertex} of {name} moved by {far:.3g} cm", near=5.0 + far)


def corner_doubled(spec: Spec, rng: np.random.Generator) -> Expected:
    """An edge of almost no length is put into a corner, as loops closed by a vertex have it."""
    name, panel, edge = _pick(spec, rng)
    far = _log_uniform(rng, 1e-5, 0.03)
    start, end = panel["edges"][edge]["endpoints"]
    a, b = np.array(panel["vertices"][start]), np.array(panel["vertices"][end])
    new = len(panel["vertices"])
    panel["vertices"].append((a + far * (b - a) / max(np.linalg.norm(b - a), 1e-9)).tolist())
    panel["edges"][edge]["endpoints"] = [new, end]
    panel["edges"].insert(edge, {"endpoints": [start, new]})
    _renumber(spec, name, lambda k: k + (k >= edge))
    return Expected(f"edge of {far:.3g} cm before edge {edge} of {name}", same=True)


def edge_collapsed(spec: Spec, rng: np.random.Generator) -> Expected:
    name, panel, edge = _pick(spec, rng)
    far = _log_uniform(rng, 1e-5, 0.03)
    start, end = panel["edges"][edge]["endpoints"]
    a, b = np.array(panel["vertices"][start]), np.array(panel["vertices"][end])
    panel["vertices"][end] = (a + far * (b - a) / max(np.linalg.norm(b - a), 1e-9)).tolist()
    return Expected(f"edge {edge} of {name} made {far:.3g} cm long", near=None)


def edge_split(spec: Spec, rng: np.random.Generator) -> Expected:
    """A straight edge is cut in two, and with it the one that it is sewn to."""
    name, _, edge = _pick(spec, rng)
    stitch = next(
        (s for s in spec["pattern"].get("stitches", [])
         if any((side["panel"], side["edge"]) == (name, edge) for side in s[:2])),
        None,
    )  # fmt: skip
    sides = [(name, edge)] if stitch is None else [(s["panel"], s["edge"]) for s in stitch[:2]]
    if any("curvature" in _panels(spec)[p]["edges"][e] for p, e in sides) or (
        len(sides) == 2 and (sides[0][0] == sides[1][0] or len(stitch or ()) > 2)
    ):
        return nothing(spec, rng)
    at = float(rng.uniform(0.05, 0.95))
    for number, (of, k) in enumerate(sides):
        share = at if number == 0 else 1 - at
        cut = _panels(spec)[of]
        start, end = cut["edges"][k]["endpoints"]
        a, b = np.array(cut["vertices"][start]), np.array(cut["vertices"][end])
        new = len(cut["vertices"])
        cut["vertices"].append((a + share * (b - a)).tolist())
        cut["edges"][k]["endpoints"] = [start, new]
        cut["edges"].insert(k + 1, {**cut["edges"][k], "endpoints": [new, end]})
        _renumber(spec, of, lambda number, k=k: number + (number > k))
    if stitch is not None:
        (a_name, a_edge), (b_name, b_edge) = sides
        stitch[0]["edge"], stitch[1]["edge"] = a_edge, b_edge + 1
        spec["pattern"]["stitches"].append(
            [{"panel": a_name, "edge": a_edge + 1}, {"panel": b_name, "edge": b_edge}]
        )
    return Expected(f"edge {edge} of {name} cut at {at:.2f} of its length", same=True)


def panel_clockwise(spec: Spec, rng: np.random.Generator) -> Expected:
    """The loop of a panel runs the other way round, as older files have it."""
    name, panel, _ = _pick(spec, rng)
    for edge in panel["edges"]:
        edge["endpoints"].reverse()
        curvature = edge.get("curvature")
        if isinstance(curvature, list):
            edge["curvature"] = [1 - curvature[0], -curvature[1]]
        elif curvature and curvature["type"] == "circle":
            radius, large, right = curvature["params"]
            curvature["params"] = [radius, large, 1 - right]
        elif curvature:
            curvature["params"] = [[1 - x, -y] for x, y in reversed(curvature["params"])]
    panel["edges"].reverse()
    count = len(panel["edges"])
    _renumber(spec, name, lambda k: count - 1 - k)
    return Expected(f"{name} runs clockwise", same=True)


def panel_inside_out(spec: Spec, rng: np.random.Generator) -> Expected:
    name, panel, _ = _pick(spec, rng)
    turn = rotation_matrix((0.0, 180.0, 0.0)) @ rotation_matrix(tuple(panel["rotation"]))
    panel["rotation"] = list(euler_angles(turn))
    return Expected(f"{name} turned inside out", near=None)


def panel_turned(spec: Spec, rng: np.random.Generator) -> Expected:
    name, panel, _ = _pick(spec, rng)
    axis, angle = int(rng.integers(3)), float(rng.uniform(-90, 90))
    by = tuple(angle if k == axis else 0.0 for k in range(3))
    turn = rotation_matrix(by) @ rotation_matrix(tuple(panel["rotation"]))
    panel["rotation"] = list(euler_angles(turn))
    return Expected(f"{name} turned by {angle:.0f} degrees about {'xyz'[axis]}", near=10.0)


def stitch_doubled(spec: Spec, rng: np.random.Generator) -> Expected:
    stitches = spec["pattern"].get("stitches", [])
    if not stitches:
        return nothing(spec, rng)
    chosen = int(rng.integers(len(stitches)))
    a, b, *flag = stitches[chosen]
    stitches.append([dict(b), dict(a), *flag])
    return Expected(f"stitch {chosen} given twice", same=True)


def stitch_dropped(spec: Spec, rng: np.random.Generator) -> Expected:
    stitches = spec["pattern"].get("stitches", [])
    if not stitches:
        return nothing(spec, rng)
    chosen = int(rng.integers(len(stitches)))
    del stitches[chosen]
    return Expected(f"stitch {chosen} dropped", near=None)


def stitches_exchanged(spec: Spec, rng: np.random.Generator) -> Expected:
    stitches = spec["pattern"].get("stitches", [])
    if len(stitches) < 2:
        return nothing(spec, rng)
    a, b = (int(k) for k in rng.choice(len(stitches), 2, replace=False))
    stitches[a][1], stitches[b][1] = stitches[b][1], stitches[a][1]
    return Expected(f"second sides of stitches {a} and {b} exchanged", near=None)


def _scale(spec: Spec, factor: float) -> None:
    for panel in _panels(spec).values():
        panel["vertices"] = [[x * factor, y * factor] for x, y in panel["vertices"]]
        panel["translation"] = [t * factor for t in panel["translation"]]
        for edge in panel["edges"]:
            curvature = edge.get("curvature")
            if isinstance(curvature, dict) and curvature["type"] == "circle":
                curvature["params"][0] *= factor


def units_declared(spec: Spec, rng: np.random.Generator) -> Expected:
    factor = float(rng.choice([0.01, 10.0, 1 / 2.54]))
    _scale(spec, factor)
    spec["properties"]["units_in_meter"] = 100 * factor
    return Expected(f"{100 * factor:.5g} units in a metre, declared", same=True)


def units_undeclared(spec: Spec, rng: np.random.Generator) -> Expected:
    factor = float(rng.choice([0.01, 10.0, 100.0, 2.54, 1 / 2.54]))
    _scale(spec, factor)
    far_off = factor in (0.01, 10.0, 100.0)
    return Expected(f"{factor:.3g} times as large", near=None, worn=not far_off)


def origin_moved(spec: Spec, rng: np.random.Generator) -> Expected:
    axis = int(rng.choice(3, p=[0.15, 0.7, 0.15]))
    far = float(rng.uniform(-150, 150)) if axis == 1 else float(rng.uniform(-50, 50))
    for panel in _panels(spec).values():
        panel["translation"][axis] += far
    return Expected(f"origin moved by {far:.0f} cm along {'xyz'[axis]}", same=True)


def world_z_up(spec: Spec, rng: np.random.Generator) -> Expected:
    turn = rotation_matrix((90.0, 0.0, 0.0))
    for panel in _panels(spec).values():
        panel["translation"] = (turn @ np.array(panel["translation"])).tolist()
        whole = turn @ rotation_matrix(tuple(panel["rotation"]))
        panel["rotation"] = list(euler_angles(whole))
    return Expected("world with z up")


def laid_flat(spec: Spec, rng: np.random.Generator) -> Expected:
    x = 0.0
    for panel in _panels(spec).values():
        points = np.array(panel["vertices"])
        panel["rotation"] = [0, 0, 0]
        panel["translation"] = [x - float(points[:, 0].min()), 0.0, 0.0]
        x += float(np.ptp(points[:, 0])) + 5.0
    return Expected("laid out as on paper", worn=len(_panels(spec)) < 2)


def edges_shuffled(spec: Spec, rng: np.random.Generator) -> Expected:
    name, panel, _ = _pick(spec, rng)
    order = [int(k) for k in rng.permutation(len(panel["edges"]))]
    panel["edges"] = [panel["edges"][k] for k in order]
    _renumber(spec, name, order.index)
    return Expected(f"edges of {name} in another order", same=True)


def vertices_shuffled(spec: Spec, rng: np.random.Generator) -> Expected:
    name, panel, _ = _pick(spec, rng)
    order = [int(k) for k in rng.permutation(len(panel["vertices"]))]
    panel["vertices"] = [panel["vertices"][k] for k in order]
    for edge in panel["edges"]:
        edge["endpoints"] = [order.index(v) for v in edge["endpoints"]]
    return Expected(f"vertices of {name} in another order", same=True)


def rounded(spec: Spec, rng: np.random.Generator) -> Expected:
    digits = int(rng.integers(0, 3))
    for panel in _panels(spec).values():
        panel["vertices"] = [[round(x, digits), round(y, digits)] for x, y in panel["vertices"]]
    return Expected(f"vertices rounded to {digits} decimals")


MUTATIONS: dict[str, Callable[[Spec, np.random.Generator], Expected]] = {
    mutation.__name__.replace("_", "-"): mutation
    for mutation in (
        nothing, vertex_moved, corner_doubled, edge_collapsed, edge_split, panel_clockwise,
        panel_inside_out, panel_turned, stitch_doubled, stitch_dropped, stitches_exchanged,
        units_declared, units_undeclared, origin_moved, world_z_up, laid_flat, edges_shuffled,
        vertices_shuffled, rounded,
    )
}  # fmt: skip
