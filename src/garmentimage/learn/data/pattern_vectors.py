"""Patterns as vectors: the baseline's representation (paper, Section 4.1 and supplement).

A garment is a fixed list of panel kinds, by name, each with up to so many vertices of four numbers:
x and y of the vertex, and where the control point of the edge that leaves it lies, along the edge
and beside it. As in the paper, stitches and places are not in the vectors: a decoded garment takes
them from the nearest topology that was trained on. What the paper leaves open is which vertices are
there; here each has a flag.
"""

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Bool, Float
from torch import Tensor

from garmentimage.dataset import parse_patterns, read_tables
from garmentimage.errors import DecodeError, LearnError, quoted
from garmentimage.pattern import Cubic, Edge, Loop, Panel, Pattern, Quadratic, Side, Stitch, Vector
from garmentimage.system import shown_path

UNIT_CM = 30.0
"""Unit of coordinates."""
STRAIGHTEST = 0.02
"""Edges whose control point is nearer to their middle, in their length, are straight."""
WORDS = "words.json"
"""File of the vocabulary, beside the weights of a network."""
NUMBERS = 4
"""Of a vertex."""

Topology = tuple[tuple[str, int], ...]
"""Panels by name, and how many vertices each has."""


@dataclass(frozen=True)
class Known:
    """What vectors do not tell of a topology: where its panels are, and how they are sewn."""

    places: dict[str, tuple[Vector, Vector]]
    """Translation [cm] and rotation [degrees] of every panel."""
    stitches: tuple[Stitch, ...]


@dataclass(frozen=True)
class Vocabulary:
    """Panel kinds, and topologies that were trained on."""

    panels: tuple[str, ...]
    vertices: int
    topologies: dict[Topology, Known]

    def vectors(self, pattern: Pattern) -> tuple[np.ndarray, np.ndarray]:
        """Numbers [panel, vertex, 4], and which vertices are there.

        Raises:
            LearnError: a panel that is of no known kind, has holes, or has too many vertices.
        """
        numbers = np.zeros((len(self.panels), self.vertices, NUMBERS), np.float32)
        there = np.zeros(numbers.shape[:2], bool)
        for panel in pattern.panels:
            count = len(panel.outline.vertices)
            if panel.name not in self.panels or panel.holes or count > self.vertices:
                raise LearnError(
                    f"panel {quoted(panel.name)} cannot be told in vectors of {self.vertices} "
                    f"vertices of {', '.join(self.panels)}"
                )
            row = self.panels.index(panel.name)
            numbers[row, :count] = _numbers(panel)
            there[row, :count] = True
        return numbers, there

    def pattern(
        self, numbers: Float[np.ndarray, "panel vertex 4"], there: Bool[np.ndarray, "panel vertex"]
    ) -> Pattern:
        """The garment that vectors tell, sewn and placed as the nearest known topology.

        Raises:
            DecodeError: no panel is there.
        """
        counts = np.where(there.all(1), self.vertices, there.argmin(1))
        found = {name: int(n) for name, n in zip(self.panels, counts) if n >= 3}
        if not found:
            raise DecodeError("the vectors hold no panel")
        known = self.topologies[self.nearest(found)]
        panels = []
        for name, count in found.items():
            outline = _outline(numbers[self.panels.index(name), :count])
            translation, rotation = known.places.get(name, ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
            panels.append(Panel(name, outline, translation=translation, rotation=rotation))
        stitches = tuple(
            stitch
            for stitch in known.stitches
            if all(side.edge < found.get(side.panel, 0) for side in stitch.sides)
        )
        return Pattern(tuple(panels), stitches)

    def to_json(self) -> str:
        """All of it as text; see `vocabulary_from_json`."""
        topologies = [
            {
                "vertices": dict(topology),
                "places": {name: [list(v) for v in place] for name, place in known.places.items()},
                "stitches": [
                    [s.a.panel, s.a.edge, s.b.panel, s.b.edge, s.same_direction]
                    for s in known.stitches
                ],
            }
            for topology, known in self.topologies.items()
        ]
        return json.dumps(
            {"panels": self.panels, "vertices": self.vertices, "topologies": topologies}
        )

    def nearest(self, found: dict[str, int]) -> Topology:
        """The known topology that shares most panels, then most numbers of vertices."""

        def apart(topology: Topology) -> tuple[int, int, Topology]:
            other = dict(topology)
            vertices = sum(abs(other[name] - n) for name, n in found.items() if name in other)
            return len(found.keys() ^ other.keys()), vertices, topology

        return min(self.topologies, key=apart)


@dataclass  # not frozen: Fabric casts its fields where precision is mixed
class Vectors:
    """The vectors of some garments."""

    numbers: Float[Tensor, "n panel vertex 4"]
    there: Bool[Tensor, "n panel vertex"]

    def __len__(self) -> int:
        return len(self.numbers)

    def batch(self, numbers: Tensor) -> "Vectors":
        """Some of them."""
        return Vectors(self.numbers[numbers], self.there[numbers])

    def to(self, device: torch.device) -> "Vectors":
        """The same on another device."""
        return Vectors(self.numbers.to(device), self.there.to(device))


def read_patterns(folder: str | Path, split: str) -> list[Pattern]:
    """All patterns of a split.

    Raises:
        DatasetError: there is no such split, or a pattern of it is damaged.
    """
    texts = [
        text
        for table in read_tables(folder, split, ["pattern"])
        for text in table["pattern"].to_pylist()
    ]
    return parse_patterns(texts, folder)


def vocabulary(patterns: Sequence[Pattern]) -> Vocabulary:
    """The panel kinds and topologies of some garments; of each topology its commonest stitches."""
    names = sorted({panel.name for pattern in patterns for panel in pattern.panels})
    most = max(len(panel.outline.vertices) for pattern in patterns for panel in pattern.panels)
    seams: dict[Topology, Counter[tuple[tuple[Side, Side, bool], ...]]] = {}
    places: dict[Topology, dict[str, tuple[Vector, Vector]]] = {}
    for pattern in patterns:
        topology = topology_of(pattern)
        seams.setdefault(topology, Counter())[
            tuple((s.a, s.b, s.same_direction) for s in pattern.stitches)
        ] += 1
        places.setdefault(
            topology, {panel.name: (panel.translation, panel.rotation) for panel in pattern.panels}
        )
    known = {
        topology: Known(
            places[topology], tuple(Stitch(*sides) for sides in counter.most_common(1)[0][0])
        )
        for topology, counter in seams.items()
    }
    return Vocabulary(tuple(names), most, known)


def vocabulary_from_json(text: str) -> Vocabulary:
    """A vocabulary that was written as text.

    Raises:
        ValueError, KeyError, TypeError: it is none.
    """
    told = json.loads(text)
    topologies = {}
    for each in told["topologies"]:
        places = {name: (_three(a), _three(b)) for name, (a, b) in each["places"].items()}
        stitches = tuple(
            Stitch(Side(str(p), int(i)), Side(str(q), int(j)), bool(same))
            for p, i, q, j, same in each["stitches"]
        )
        vertices = tuple(sorted((str(n), int(count)) for n, count in each["vertices"].items()))
        topologies[vertices] = Known(places, stitches)
    return Vocabulary(tuple(map(str, told["panels"])), int(told["vertices"]), topologies)


def read_vocabulary(network: Path) -> Vocabulary:
    """The vocabulary of a trained network, from its folder.

    Raises:
        LearnError: it is not there, or damaged.
    """
    file = network / WORDS
    try:
        return vocabulary_from_json(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        raise LearnError(
            f"{shown_path(file)}: is not there, or damaged; `garmentimage train vector-vae` writes "
            "it with the network"
        ) from None


def _three(values: Sequence[float]) -> Vector:
    x, y, z = map(float, values)
    return x, y, z


def vectors(patterns: Sequence[Pattern], words: Vocabulary) -> Vectors:
    """The vectors of some garments."""
    made = [words.vectors(pattern) for pattern in patterns]
    return Vectors(
        torch.from_numpy(np.stack([numbers for numbers, _ in made])),
        torch.from_numpy(np.stack([there for _, there in made])),
    )


def topology_of(pattern: Pattern) -> Topology:
    """Panels by name, and how many vertices each has."""
    return tuple(sorted((panel.name, len(panel.outline.vertices)) for panel in pattern.panels))


def _numbers(panel: Panel) -> Float[np.ndarray, "vertex 4"]:
    loop = panel.outline
    xy = np.array(loop.vertices) / UNIT_CM
    bends = np.zeros_like(xy)
    for edge in loop.edges:
        bends[edge.start] = _bend(edge)
    return np.concatenate([xy, bends], 1)


def _bend(edge: Edge) -> tuple[float, float]:
    """Where the control point of the nearest quadratic curve lies from the middle of the edge."""
    match edge.curvature:
        case None:
            return 0.0, 0.0
        case Quadratic(control):
            return control[0] - 0.5, control[1]
        case Cubic(one, two):
            return (3 * (one[0] + two[0]) - 1) / 4 - 0.5, 3 * (one[1] + two[1]) / 4
    raise LearnError("vectors hold straight edges and Bézier curves only")


def _outline(numbers: Float[np.ndarray, "vertex 4"]) -> Loop:
    count = len(numbers)
    edges = []
    for k, (along, beside) in enumerate(numbers[:, 2:].astype(float)):
        straight = np.hypot(along, beside) < STRAIGHTEST
        bend = None if straight else Quadratic((float(along) + 0.5, float(beside)))
        edges.append(Edge(k, (k + 1) % count, bend))
    xy = numbers[:, :2].astype(float) * UNIT_CM
    return Loop(tuple((float(x), float(y)) for x, y in xy), tuple(edges))
