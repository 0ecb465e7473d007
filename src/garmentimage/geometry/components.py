"""Connected components of graphs."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Int


def connected_components(count: int, pairs: Iterable[tuple[int, int]]) -> list[list[int]]:
    """Nodes that are joined by pairs, directly or through others (union-find).

    `scipy.sparse.csgraph` does the same, but to import it takes longer than to check a pattern of
    some twenty panels; for meshes use `component_labels`.

    Args:
        count: number of nodes, named 0 to `count` - 1.
        pairs: nodes that are joined.

    Returns:
        The nodes of each component in increasing order, components by their first node.

    Example:
        >>> connected_components(4, [(3, 0), (2, 2)])
        [[0, 3], [1], [2]]
    """
    parent = list(range(count))

    def root(node: int) -> int:
        while parent[node] != node:
            parent[node] = parent[parent[node]]
            node = parent[node]
        return node

    for a, b in pairs:
        low, high = sorted((root(a), root(b)))
        parent[high] = low
    members: dict[int, list[int]] = {}
    for node in range(count):
        members.setdefault(root(node), []).append(node)
    return list(members.values())


def component_labels(count: int, pairs: Int[np.ndarray, "pair 2"]) -> Int[np.ndarray, " node"]:
    """The number of each node's component, from 0 by their first nodes; quick on large graphs."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components as scipy_components

    joins = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(count, count))
    labels: np.ndarray = scipy_components(joins, directed=False)[1]
    return labels
