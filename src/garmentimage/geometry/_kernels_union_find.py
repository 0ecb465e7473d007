"""Merging of numbered things into classes, for compiled code.

`parent` maps every number to one of its class, a root to itself; it starts as `np.arange(count)`.
The root of a class is its smallest number. Numbers given are below `count`.
"""

from numba import njit


# Path halving (Tarjan and van Leeuwen 1984): every second node on the path gets its grandparent.
@njit(cache=True)
def find_root(parent, i):
    """The root of the class of `i`; shortens the path to it."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


# Linked by index instead of rank, so that a root is the smallest number of its class.
@njit(cache=True)
def union(parent, i, j):
    """Make the classes of `i` and `j` one."""
    a, b = find_root(parent, i), find_root(parent, j)
    parent[max(a, b)] = min(a, b)
