"""Merging of numbered things into classes, for compiled code.

`parent` maps every number to one of its class, a root to itself; it starts as `np.arange(count)`.
The root of a class is its smallest number. Numbers given are below `count`.
"""

# mypy: allow-untyped-defs, allow-untyped-calls

from numba import njit


@njit(cache=True)
def find_root(parent, i):
    """The root of the class of `i`; shortens the way there."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit(cache=True)
def union(parent, i, j):
    """Make the classes of `i` and `j` one."""
    a, b = find_root(parent, i), find_root(parent, j)
    parent[max(a, b)] = min(a, b)
