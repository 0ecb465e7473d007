"""Merging of numbered things into classes, for compiled code.

`parent` maps every number to one of its class, a root to itself; it starts as `np.arange(count)`.
The root of a class is its smallest number. Numbers given are below `count`.
"""

# mypy: allow-untyped-defs, allow-untyped-calls

from numba import njit


@njit(cache=True)
def root_of(parent, i):
    """The root of the class of `i`; shortens the way there."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit(cache=True)
def merge(parent, i, j):
    """Make the classes of `i` and `j` one."""
    a, b = root_of(parent, i), root_of(parent, j)
    parent[max(a, b)] = min(a, b)
