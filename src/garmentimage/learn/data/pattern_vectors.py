"""Patterns as vectors: the representation of the baseline (paper, Section 4.1 and supplement).

A garment is a fixed list of panel kinds, by name, each with up to so many vertices of four numbers:
x and y of the vertex, and the control point of the edge that leaves it, along the edge and to its
left, relative to its middle and length. As in the paper, stitches and placements are not encoded: a
decoded garment takes them from the nearest topology of the training set. The paper leaves open
which vertices exist; here each has a presence flag.
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
from garmentimage.learn.data.rows import TensorRows
from garmentimage.pattern import Cubic, Edge, Loop, Panel, Pattern, Quadratic, Side, Stitch, Vector
from garmentimage.system import shown_path

UNIT_CM = 30.0
"""Unit of coordinates [cm]."""
STRAIGHT_TOLERANCE = 0.02
"""Edges whose control point is nearer to their middle are straight [edge lengths]."""
VOCABULARY_FILE = "words.json"
"""File of the vocabulary, in the folder of a network."""
VERTEX_SIZE = 4
"""Numbers of a vertex."""

Topology = tuple[tuple[str, int], ...]
"""Panels by name, and the number of vertices of each."""


@dataclass(frozen=True)
class KnownTopology:
    """Placements and stitches of a topology, which vectors do not encode."""

    places: dict[str, tuple[Vector, Vector]]
    """Translation [cm] and rotation [degrees] of every panel."""
    stitches: tuple[Stitch, ...]


@dataclass(frozen=True)
class Vocabulary:
    """Panel kinds and topologies of a training set."""

    panels: tuple[str, ...]
    """Names, one a row of the vectors."""
    vertices: int
    """Most vertices of a panel."""
    topologies: dict[Topology, KnownTopology]

    def vectors(self, pattern: Pattern) -> tuple[np.ndarray, np.ndarray]:
        """Numbers [panel, vertex, 4] of a garment, and which vertices are present [panel, vertex].

        Raises:
            LearnError: a panel of another kind, with holes, or with too many vertices.
        """
        numbers = np.zeros((len(self.panels), self.vertices, VERTEX_SIZE), np.float32)
        is_present = np.zeros(numbers.shape[:2], bool)
        for panel in pattern.panels:
            count = len(panel.outline.vertices)
            if panel.name not in self.panels or panel.holes or count > self.vertices:
                raise LearnError(
                    f"panel {quoted(panel.name)} cannot be encoded as vectors of {self.vertices} "
                    f"vertices of {', '.join(self.panels)}"
                )
            row = self.panels.index(panel.name)
            numbers[row, :count] = _numbers(panel)
            is_present[row, :count] = True
        return numbers, is_present

    def pattern(
        self,
        numbers: Float[np.ndarray, "panel vertex 4"],
        is_present: Bool[np.ndarray, "panel vertex"],
    ) -> Pattern:
        """The pattern of vectors, sewn and placed as the nearest topology of the training set.

        Raises:
            DecodeError: no panel has three vertices.
        """
        counts = np.where(is_present.all(1), self.vertices, is_present.argmin(1))
        found = {name: int(n) for name, n in zip(self.panels, counts, strict=True) if n >= 3}
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
        """As JSON; `vocabulary_from_json` reads it."""
        topologies = [
            {
                "vertices": dict(topology),
                "places": known.places,
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
        """The topology with the fewest other panels, then with the nearest numbers of vertices."""

        def distance(topology: Topology) -> tuple[int, int, Topology]:
            other = dict(topology)
            vertices = sum(abs(other[name] - n) for name, n in found.items() if name in other)
            return len(found.keys() ^ other.keys()), vertices, topology

        return min(self.topologies, key=distance)


@dataclass
class PatternVectors(TensorRows):
    """The vectors of some garments."""

    numbers: Float[Tensor, "n panel vertex 4"]
    is_present: Bool[Tensor, "n panel vertex"]


def read_patterns(folder: str | Path, split: str) -> list[Pattern]:
    """Load the patterns of a split.

    Raises:
        DatasetError: there is no such split, or one of its patterns is damaged.
    """
    tables = read_tables(folder, split, ["pattern"])
    return parse_patterns([text for each in tables for text in each["pattern"].to_pylist()], folder)


def build_vocabulary(patterns: Sequence[Pattern]) -> Vocabulary:
    """Panel kinds and topologies of some garments; of each topology its most frequent stitches."""
    panels = [panel for pattern in patterns for panel in pattern.panels]
    alike: dict[Topology, list[Pattern]] = {}
    for pattern in patterns:
        alike.setdefault(vertex_counts(pattern), []).append(pattern)
    topologies = {}
    for topology, group in alike.items():
        places = {panel.name: (panel.translation, panel.rotation) for panel in group[0].panels}
        seams = Counter(
            tuple((s.a, s.b, s.same_direction) for s in each.stitches) for each in group
        )
        stitches = tuple(Stitch(*sides) for sides in seams.most_common(1)[0][0])
        topologies[topology] = KnownTopology(places, stitches)
    return Vocabulary(
        tuple(sorted({panel.name for panel in panels})),
        max(len(panel.outline.vertices) for panel in panels),
        topologies,
    )


def vocabulary_from_json(text: str) -> Vocabulary:
    """Read a vocabulary from JSON.

    Raises:
        ValueError, KeyError, TypeError: the text holds no vocabulary.
    """
    content = json.loads(text)
    topologies = {}
    for each in content["topologies"]:
        places = {name: (_three(a), _three(b)) for name, (a, b) in each["places"].items()}
        stitches = tuple(
            Stitch(Side(str(p), int(i)), Side(str(q), int(j)), bool(same))
            for p, i, q, j, same in each["stitches"]
        )
        vertices = tuple(sorted((str(n), int(count)) for n, count in each["vertices"].items()))
        topologies[vertices] = KnownTopology(places, stitches)
    return Vocabulary(tuple(map(str, content["panels"])), int(content["vertices"]), topologies)


def read_vocabulary(network: Path) -> Vocabulary:
    """The vocabulary of a trained network, from its folder.

    Raises:
        LearnError: its file is missing or damaged.
    """
    file = network / VOCABULARY_FILE
    try:
        return vocabulary_from_json(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        raise LearnError(
            f"{shown_path(file)}: is missing or damaged; `garmentimage train vector-vae` writes "
            "it with the network"
        ) from None


def _three(values: Sequence[float]) -> Vector:
    x, y, z = map(float, values)
    return x, y, z


def to_vectors(patterns: Sequence[Pattern], vocabulary: Vocabulary) -> PatternVectors:
    """The vectors of some garments."""
    columns = zip(*map(vocabulary.vectors, patterns), strict=True)
    return PatternVectors(*(torch.from_numpy(np.stack(column)) for column in columns))


def vertex_counts(pattern: Pattern) -> Topology:
    """Panels by name, and the number of vertices of each."""
    return tuple(sorted((panel.name, len(panel.outline.vertices)) for panel in pattern.panels))


def _numbers(panel: Panel) -> Float[np.ndarray, "vertex 4"]:
    loop = panel.outline
    xy = np.array(loop.vertices) / UNIT_CM
    bends = np.zeros_like(xy)
    for edge in loop.edges:
        bends[edge.start] = _bend(edge)
    return np.concatenate([xy, bends], 1)


def _bend(edge: Edge) -> tuple[float, float]:
    """Control point of the nearest quadratic curve, from the middle of the edge [edge lengths]."""
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
        straight = np.hypot(along, beside) < STRAIGHT_TOLERANCE
        bend = None if straight else Quadratic((float(along) + 0.5, float(beside)))
        edges.append(Edge(k, (k + 1) % count, bend))
    xy = numbers[:, :2].astype(float) * UNIT_CM
    return Loop(tuple((float(x), float(y)) for x, y in xy), tuple(edges))
