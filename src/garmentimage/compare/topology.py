"""The topology of a garment as a string: equal strings mean garments that are sewn alike."""

import hashlib
from collections import Counter, defaultdict

from garmentimage.compare.stitch_graphs import StitchGraph

ROUNDS = 4
"""How far from a panel the word sees; no garment has longer chains of panels that look alike."""


def topology_hash(graph: StitchGraph) -> str:
    """A hash of the panels and of how many seams and darts join which.

    Names, sizes and places do not matter. It is a Weisfeiler-Leman hash: garments that are sewn
    alike have equal words; those that are not nearly always have different ones.
    """
    seams: defaultdict[str, Counter[str]] = defaultdict(Counter)
    darts: Counter[str] = Counter()
    for k, m in graph.seams:
        a, b = graph.sides[k].panel, graph.sides[m].panel
        if a == b:
            darts[f"{a} {'dart' if graph.is_dart(k) else 'seam'}"] += 1
        else:
            seams[a][b] += 1
            seams[b][a] += 1
    words = {
        name: _short(node.loops, darts[f"{name} dart"], darts[f"{name} seam"])
        for name, node in graph.panels.items()
    }
    for _ in range(ROUNDS):
        words = {
            name: _short(word, sorted((words[b], n) for b, n in seams[name].items()))
            for name, word in words.items()
        }
    return _short(sorted(words.values()))


def _short(*facts: object) -> str:
    return hashlib.sha256(repr(facts).encode()).hexdigest()[:12]
