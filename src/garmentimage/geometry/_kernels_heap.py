"""A binary heap in two arrays, for shortest paths inside compiled code.

Whoever pushes sees to it that `size` is below the length of the arrays, whoever drops that it is
above 0; there is no check inside.
"""

from numba import njit


# A tree in an array: below the item at i are those at 2 i + 1 and 2 i + 2, with keys no smaller
# (Williams 1964, "Algorithm 232: Heapsort").
@njit(cache=True)
def heap_push(keys, items, size, key, item):
    """Add an item; the new size. The arrays must have room for it."""
    i = size
    keys[i], items[i] = key, item
    while i > 0:
        up = (i - 1) >> 1
        if keys[up] <= keys[i]:
            break
        keys[up], keys[i] = keys[i], keys[up]
        items[up], items[i] = items[i], items[up]
        i = up
    return size + 1


@njit(cache=True)
def heap_pop(keys, items, size):
    """Take the item with the smallest key (at 0) away; the new size."""
    size -= 1
    keys[0], items[0] = keys[size], items[size]
    i = 0
    while True:
        # Sinks below the smaller of its two followers until both have larger keys.
        small, left = i, 2 * i + 1
        if left < size and keys[left] < keys[small]:
            small = left
        if left + 1 < size and keys[left + 1] < keys[small]:
            small = left + 1
        if small == i:
            return size
        keys[small], keys[i] = keys[i], keys[small]
        items[small], items[i] = items[i], items[small]
        i = small
