"""Compiled parts of polishing: coordinate descent on the energy of a lattice drawing.

The energy is a sum over arcs and nodes,

    E = sum over arcs   STEP_COST n + TOO_SHORT max(min_edges - n, 0)
                        + SHAPE_PULL w max(desired_edges - n, 0)²
                        + w sum over inner vertices  dist²(vertex, target curve)
      + sum over nodes  NODE_PULL w |vertex - target|²

with n the grid edges of an arc and w the weight of an arc or a node. Two moves lower it: an arc is
replaced by the cheapest free path between its nodes (Dijkstra 1959, on pairs of a vertex and a
path length), and a node steps to a neighbouring vertex while its arcs are drawn again one by one.
A move is undone unless the cyclic order of arcs round every node stays what it was at first.

Vertices are numbered y * width + x, ends of arcs 2 arc, + 1 at the head; layers are bit masks.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from garmentimage.geometry import heap_pop, heap_push
from garmentimage.raster.encode.lattice._kernels_route import (
    FAR,
    Search,
    distance_field,
    trace_back,
)

NODE_PULL = 4.0
"""Energy of a node, per squared distance from its target [cells²]."""
STEP_COST = 0.05
"""Energy of one grid edge: between equals the shorter path wins."""
SHAPE_PULL = 0.8
"""Energy of missing grid edges, per missing edge squared."""
TOO_SHORT = 20.0
"""Energy of each grid edge that an arc has less than the fewest it may have."""
REACH = 3.0
"""How far a path may leave its target [cells], unless it already has."""
MAX_SWEEPS = 12
MIN_GAIN = 1e-6
"""A move must lower the energy by this."""
MAX_LENGTH = 8
"""Path lengths that the search distinguishes: 0 .. MAX_LENGTH - 1 grid edges or more."""


class Graph(NamedTuple):
    """What is drawn, and where; read only."""

    tail: np.ndarray  # arc
    head: np.ndarray  # arc
    layers: np.ndarray  # arc
    on_axis: np.ndarray  # arc
    min_edges: np.ndarray  # arc
    desired_edges: np.ndarray  # arc
    weight: np.ndarray  # arc
    ends: np.ndarray  # the ends of arcs at each node, node by node
    arcs: np.ndarray  # the arcs of those ends
    first: np.ndarray  # node + 1: where those of each node begin, and the end
    node_target: np.ndarray  # node 2
    node_layers: np.ndarray  # node
    node_on_axis: np.ndarray  # node
    node_weight: np.ndarray  # node
    targets: np.ndarray  # point 2: the arcs' curves, one after the other
    starts: np.ndarray  # arc + 1: where each curve begins in `targets`, and the end
    width: int
    """Vertices of a row, and rows, of the lattice; paths run off its rim."""
    axis: int
    """Column of the mirror axis, -1 without."""


class State(NamedTuple):
    """The drawing, which the moves change in place, and what they need to search."""

    table: np.ndarray  # arc k: vertices of each path, from tail to head
    lens: np.ndarray  # arc: vertices that it has
    where: np.ndarray  # node: its vertex, -1 without arcs
    busy: np.ndarray  # layer vertex: taken by a node or the inside of a path
    energy: np.ndarray  # arc
    rotation: np.ndarray  # node layer 4: order of arc ends round each node, see `_rotation`
    search: Search
    found: np.ndarray  # k: the path that a search found


@njit(cache=True)
def minimise_energy(graph, state):
    """Lower the energy of a drawing until no move does, at most `MAX_SWEEPS` times.

    The paths of `state`, changed in place, are vertex-disjoint, of two vertices or more, and inside
    the lattice; the rest of it is filled in here.
    """
    cost = _vertex_costs(graph, state)
    for arc in range(len(state.lens)):
        _mark_path(graph, state, arc, True)
        state.energy[arc] = _energy(graph, state, cost, arc)
    for node in range(len(state.where)):
        if state.where[node] >= 0:
            _mark_node(graph, state, node, True)
            state.rotation[node] = _rotation(graph, state, node)
    for _ in range(MAX_SWEEPS):
        # In turn and in order, each move seen by the next: the result is the same every time.
        moved = False
        for arc in range(len(state.lens)):
            moved = _redraw_arc(graph, state, cost, arc) or moved
        for node in range(len(state.where)):
            # Every direction from where the node is by then; nodes without arcs stay unplaced.
            for step in (1, graph.width, -1, -graph.width):
                if state.where[node] >= 0:
                    goal = state.where[node] + step
                    moved = _move_node(graph, state, cost, node, goal) or moved
        if not moved:
            break


@njit(cache=True)
def _vertex_costs(graph, state):
    """[arc, vertex] energy of every vertex for every arc: its squared distance from the target.

    Vertices where the arc may not run or that are out of reach cost FAR; where a path is farther
    off already, its reach is that far.
    """
    arcs, width = len(state.lens), graph.width
    size = width * width
    cost = np.empty((arcs, size))
    grid = np.empty((width, width))
    for i in range(arcs):
        curve = graph.targets[graph.starts[i] : graph.starts[i + 1]]
        # Wide enough for every vertex of the lattice.
        distance_field(curve, 3.0 * width, grid)
        worst = REACH * REACH
        flat = grid.reshape(size)
        for k in range(state.lens[i]):
            worst = max(worst, flat[state.table[i, k]] + 1e-9)
        for v in range(size):
            is_near = flat[v] <= worst and _is_inside(v, graph, graph.on_axis[i])
            cost[i, v] = graph.weight[i] * flat[v] if is_near else FAR
    return cost


@njit(cache=True)
def _redraw_arc(graph, state, cost, arc):
    """Draw an arc again by its cheapest free path; whether it has changed."""
    # Its own path is in nobody's way while the search runs.
    _mark_path(graph, state, arc, False)
    count = _cheapest_path(graph, state, cost[arc], arc, state.energy[arc] - MIN_GAIN)
    is_better = count > 0
    # Cheaper by itself, but the arc may have gone round another's end.
    if is_better:
        before = state.table[arc, : state.lens[arc]].copy()
        _set_path(state, arc, state.found[:count])
        is_better = _keeps_rotations(graph, state, arc)
        if is_better:
            state.energy[arc] = _energy(graph, state, cost, arc)
        else:
            _set_path(state, arc, before)
    _mark_path(graph, state, arc, True)
    return is_better


@njit(cache=True)
def _move_node(graph, state, cost, node, goal):
    """Move a node to a neighbouring vertex, its arcs drawn again, if the energy falls."""
    if not _is_inside(goal, graph, graph.node_on_axis[node]):
        return False
    here, arcs = state.where[node], graph.arcs[graph.first[node] : graph.first[node + 1]]
    rise, total = _node_rise(graph, node, here, goal), 0.0
    for arc in arcs:
        total += state.energy[arc]
    # The arcs cannot get cheaper than nothing: most steps end here, before any search.
    if rise >= total:
        return False
    lens = state.lens[arcs]
    paths = state.table[:, : lens.max()][arcs]
    for arc in arcs:
        _mark_path(graph, state, arc, False)
    _mark_node(graph, state, node, False)
    # The arcs are out, so the node may also step along one of them.
    if not _is_busy(state, graph.node_layers[node], goal):
        state.where[node] = goal
        _mark_node(graph, state, node, True)
        if _redraw_star(graph, state, cost, arcs, rise, total):
            return True
        # Whichever arcs were drawn by then: all are taken out, with their old paths and with new.
        for arc in arcs:
            _mark_path(graph, state, arc, False)
        _mark_node(graph, state, node, False)
        state.where[node] = here
    _mark_node(graph, state, node, True)
    for k in range(len(arcs)):
        _set_path(state, arcs[k], paths[k, : lens[k]])
        _mark_path(graph, state, arcs[k], True)
    return False


@njit(cache=True)
def _redraw_star(graph, state, cost, arcs, spent, total):
    """Draw the arcs of a node that has moved, in turn; whether all fit and the energy falls.

    `arcs` are not drawn now and had the energy `total`; the node's own rises by `spent`.
    """
    for arc in arcs:
        # What the arcs before have left of the energy bounds the search for this one.
        count = _cheapest_path(graph, state, cost[arc], arc, total - spent)
        if count == 0:
            return False
        _set_path(state, arc, state.found[:count])
        _mark_path(graph, state, arc, True)
        spent += _energy(graph, state, cost, arc)
        if spent >= total - MIN_GAIN:
            return False
    # All are there again: only now do the orders round the nodes mean something.
    for arc in arcs:
        if not _keeps_rotations(graph, state, arc):
            return False
    for arc in arcs:
        state.energy[arc] = _energy(graph, state, cost, arc)
    return True


@njit(cache=True)
def _node_rise(graph, node, here, goal):
    """Energy of a node at `goal` less its energy at `here`."""
    # Only the pull of its target: what its arcs cost follows when they are drawn.
    width = graph.width
    gx, gy, hx, hy = goal % width, goal // width, here % width, here // width
    tx, ty = graph.node_target[node, 0], graph.node_target[node, 1]
    pull = NODE_PULL * graph.node_weight[node]
    return pull * ((gx - tx) ** 2 + (gy - ty) ** 2 - (hx - tx) ** 2 - (hy - ty) ** 2)


@njit(cache=True)
def _cheapest_path(graph, state, field, arc, limit):
    """Cheapest free path of an arc below `limit` into `state.found`; its vertices, or 0.

    Dijkstra over states (vertex, grid edges so far, up to MAX_LENGTH - 1), since what is missing
    to the desired length costs energy, too: a path may be long on purpose. Energy of the length is
    added at the goal. Costs are not negative, so what leaves the heap at or above the best path
    ends the search. `field` is the cost of each vertex.
    """
    cost, previous, keys, items = state.search
    start, goal = state.where[graph.tail[arc]], state.where[graph.head[arc]]
    mask, width = graph.layers[arc], graph.width
    desired, pull = graph.desired_edges[arc], SHAPE_PULL * graph.weight[arc]
    # A path starts with length 0; its own node is never entered again.
    cost[:] = FAR
    size = 1
    keys[0], items[0] = 0.0, start * MAX_LENGTH
    cost[items[0]] = 0.0
    previous[items[0]] = -1
    best, best_state = limit, -1
    while size > 0:
        key, here = keys[0], items[0]
        size = heap_pop(keys, items, size)
        # No entry is changed in the heap: one that is dearer than its state was pushed earlier.
        if key > cost[here] or key >= best:
            continue
        vertex, length = here // MAX_LENGTH, here % MAX_LENGTH
        longer = min(length + 1, MAX_LENGTH - 1)
        for step in (1, width, -1, -width):
            other = vertex + step
            # Only at the goal is the length known, and with it what it costs.
            if other == goal:
                missing = desired - longer
                total = key + STEP_COST + (pull * missing * missing if missing > 0 else 0.0)
                total += TOO_SHORT * max(graph.min_edges[arc] - longer, 0)
                if total < best - MIN_GAIN:
                    best = total
                    best_state = here
                continue
            if field[other] >= FAR or other == start or _is_busy(state, mask, other):
                continue
            total = key + STEP_COST + field[other]
            index = other * MAX_LENGTH + longer
            # The tolerance keeps the first of equal paths, whatever the rounding.
            if total < cost[index] - 1e-12 and size < len(keys):
                cost[index] = total
                previous[index] = here
                size = heap_push(keys, items, size, total, index)
    if best_state < 0:
        return 0
    return _traced(goal, best_state, previous, state.found)


@njit(cache=True)
def _traced(goal, last, previous, found):
    """Write the path that ends with `goal` after state `last`; its vertices, or 0 if unfit.

    States of one vertex differ by their length, so a path may cross itself: that one is refused,
    as is one that has no room.
    """
    count = trace_back(last, previous, found)
    if count + 1 >= len(found):
        return 0
    # From states, last first, to vertices.
    found[:count] = found[:count][::-1] // MAX_LENGTH
    found[count] = goal
    return count + 1 if len(np.unique(found[: count + 1])) == count + 1 else 0


@njit(cache=True)
def _energy(graph, state, cost, arc):
    """Energy of an arc's path."""
    n = state.lens[arc]
    total = STEP_COST * (n - 1) + TOO_SHORT * max(graph.min_edges[arc] - (n - 1), 0)
    # Its ends lie at nodes, whose place has an energy of its own.
    for k in range(1, n - 1):
        total += cost[arc, state.table[arc, k]]
    missing = graph.desired_edges[arc] - (n - 1)
    if missing > 0:
        total += SHAPE_PULL * graph.weight[arc] * missing * missing
    return total


@njit(cache=True)
def _is_inside(vertex, graph, on_axis):
    """Whether a vertex lies off the rim and on the proper side of the axis, or on it."""
    width, axis = graph.width, graph.axis
    x, y = vertex % width, vertex // width
    if min(x, y) < 1 or max(x, y) > width - 2:
        return False
    return axis < 0 or (x == axis if on_axis else x > axis)


@njit(cache=True)
def _is_busy(state, layers, vertex):
    """Whether a vertex is taken on one of the layers."""
    for layer in range(len(state.busy)):
        if layers >> layer & 1 and state.busy[layer, vertex]:
            return True
    return False


@njit(cache=True)
def _mark_node(graph, state, node, value):
    """Take or free the vertex of a node."""
    for layer in range(len(state.busy)):
        if graph.node_layers[node] >> layer & 1:
            state.busy[layer, state.where[node]] = value


@njit(cache=True)
def _mark_path(graph, state, arc, value):
    """Take or free the inner vertices of an arc's path."""
    for layer in range(len(state.busy)):
        if graph.layers[arc] >> layer & 1:
            for k in range(1, state.lens[arc] - 1):
                state.busy[layer, state.table[arc, k]] = value


@njit(cache=True)
def _set_path(state, arc, vertices):
    """Give an arc a path."""
    # What lies beyond in its row is never read.
    state.lens[arc] = len(vertices)
    state.table[arc, : len(vertices)] = vertices


@njit(cache=True)
def _keeps_rotations(graph, state, arc):
    """Whether the ends of arcs round both nodes of an arc are in the order of the beginning.

    For connected drawings, the same cyclic order round all nodes means the same faces.
    """
    for node in (graph.tail[arc], graph.head[arc]):
        if (_rotation(graph, state, node) != state.rotation[node]).any():
            return False
    return True


@njit(cache=True)
def _rotation(graph, state, node):
    """[layer, 4] ends of arcs counter-clockwise round a node, from the lowest on, then -1."""
    layers = len(state.busy)
    by_direction, out = np.full((layers, 4), -1), np.full((layers, 4), -1)
    width = graph.width
    for end in graph.ends[graph.first[node] : graph.first[node + 1]]:
        arc = end // 2
        # Direction of the first step away from the node: 0 right, 1 up, 2 left, 3 down.
        step = state.table[arc, state.lens[arc] - 2 if end % 2 else 1] - state.where[node]
        direction = 0 if step == 1 else 1 if step == width else 2 if step == -1 else 3
        for layer in range(layers):
            if graph.layers[arc] >> layer & 1:
                by_direction[layer, direction] = end
    # Begun at the lowest end, equal cyclic orders are equal rows.
    for layer in range(layers):
        ring = by_direction[layer][by_direction[layer] >= 0]
        lowest = ring.argmin() if len(ring) else 0
        for k in range(len(ring)):
            out[layer, k] = ring[(lowest + k) % len(ring)]
    return out
