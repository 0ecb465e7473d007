"""Compiled parts of polishing: coordinate descent on the energy of a lattice drawing.

The energy is a sum over arcs and nodes,

    E = sum over arcs   STEP_COST n + TOO_SHORT max(min_edges - n, 0)
                        + SHAPE_PULL w max(desired_edges - n, 0)²
                        + w sum over inner vertices  dist²(vertex, target curve)
      + sum over nodes  NODE_PULL w |vertex - target|²

with n the grid edges of an arc and w the weight of an arc or a node. Two moves lower it: an arc is
replaced by the cheapest free path between its nodes (Dijkstra 1959, on pairs of a vertex and a
path length), and a node steps to a neighbouring vertex while its arcs are drawn again one by one.

Vertices are numbered y * width + x, directions 0 right, 1 up, 2 left, 3 down, layers are bit masks.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from garmentimage.geometry import heap_pop, heap_push
from garmentimage.raster.encode.lattice._kernels_route import FAR, distance_field

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
    """What is drawn; read only."""

    tail: np.ndarray  # arc
    head: np.ndarray  # arc
    layers: np.ndarray  # arc
    on_axis: np.ndarray  # arc
    min_edges: np.ndarray  # arc
    desired_edges: np.ndarray  # arc
    weight: np.ndarray  # arc
    node_target: np.ndarray  # node 2
    node_layers: np.ndarray  # node
    node_on_axis: np.ndarray  # node
    node_weight: np.ndarray  # node
    targets: np.ndarray  # point 2: the arcs' curves, one after the other
    starts: np.ndarray  # arc + 1: where each curve begins in `targets`, and the end


class Lattice(NamedTuple):
    """Where paths may run."""

    width: int
    """Vertices of a row, and rows."""
    low: int
    high: int
    axis: int
    """Column of the mirror axis, -1 without."""


class State(NamedTuple):
    """The drawing, which the moves change in place, and what they need to undo a move."""

    table: np.ndarray  # arc k: vertices of each path, from tail to head
    lens: np.ndarray  # arc: vertices that it has
    where: np.ndarray  # node: its vertex, -1 without arcs
    busy: np.ndarray  # layer vertex: taken by a node or the inside of a path
    cost: np.ndarray  # arc vertex: energy of a path's vertex, FAR out of reach
    energy: np.ndarray  # arc
    star: np.ndarray  # node k: arcs at each node
    star_n: np.ndarray  # node: how many
    saved: np.ndarray  # k k: paths to restore
    saved_n: np.ndarray  # k
    rotation: np.ndarray  # layer direction: order of arcs round a node before a move
    rotations: np.ndarray  # k layer direction: the same for the nodes at the arcs' other ends
    rotation_now: np.ndarray  # layer direction: after the move
    search: tuple[np.ndarray, ...]
    """Cost and predecessor of every state of the search, and the heap's keys and items."""
    found: np.ndarray  # k: the path that a search found


@njit(cache=True)
def minimise_energy(graph, lattice, table, lens):
    """Lower the energy of a drawing until no move does, at most `MAX_SWEEPS` times.

    Args:
        graph: a `Graph`.
        lattice: a `Lattice`; 1 <= low <= high < width - 1, so that neighbours are inside.
        table: [arc, k] vertex-disjoint paths of two vertices or more, changed in place.
        lens: [arc] vertices of each path, changed in place.
    """
    state = _set_up(graph, lattice, table, lens)
    for _ in range(MAX_SWEEPS):
        arcs_moved = _improve_arcs(graph, lattice, state)
        nodes_moved = _improve_nodes(graph, lattice, state)
        if not (arcs_moved or nodes_moved):
            break


@njit(cache=True)
def _set_up(graph, lattice, table, lens):
    """The state of a drawing: what its vertices cost, and which are busy."""
    arcs, nodes, size = len(lens), len(graph.node_target), lattice.width * lattice.width
    where = np.full(nodes, -1, np.int64)
    degree = np.zeros(nodes, np.int64)
    for i in range(arcs):
        where[graph.tail[i]], where[graph.head[i]] = table[i, 0], table[i, lens[i] - 1]
        degree[graph.tail[i]] += 1
        degree[graph.head[i]] += 1
    most = max(degree.max(), 1)
    star = np.zeros((nodes, most), np.int64)
    star_n = np.zeros(nodes, np.int64)
    for i in range(arcs):
        for n in (graph.tail[i], graph.head[i]):
            star[n, star_n[n]] = i
            star_n[n] += 1
    room = table.shape[1]
    state = State(
        table, lens, where,
        np.zeros((2, size), np.bool_),
        _vertex_costs(graph, lattice, table, lens),
        np.empty(arcs),
        star, star_n,
        np.empty((most, room), np.int64),
        np.empty(most, np.int64),
        np.empty((2, 4), np.int64),
        np.empty((most, 2, 4), np.int64),
        np.empty((2, 4), np.int64),
        (
            np.empty(size * MAX_LENGTH),
            np.empty(size * MAX_LENGTH, np.int64),
            np.empty(4 * size * MAX_LENGTH),
            np.empty(4 * size * MAX_LENGTH, np.int64),
        ),
        np.empty(room, np.int64),
    )  # fmt: skip
    for i in range(arcs):
        _mark_path(graph, state, i, True)
        state.energy[i] = _energy(graph, state, i)
    for n in range(nodes):
        if where[n] >= 0:
            _mark_node(graph, state, n, True)
    return state


@njit(cache=True)
def _vertex_costs(graph, lattice, table, lens):
    """Energy of every vertex for every arc: its squared distance from the target curve.

    Vertices out of reach cost FAR; where a path is farther off already, its reach is that far.
    """
    arcs, width = len(lens), lattice.width
    size = width * width
    cost = np.empty((arcs, size))
    grid = np.empty((width, width))
    for i in range(arcs):
        curve = graph.targets[graph.starts[i] : graph.starts[i + 1]]
        distance_field(curve, 3.0 * width, grid)
        worst = REACH * REACH
        flat = grid.reshape(size)
        for k in range(lens[i]):
            worst = max(worst, flat[table[i, k]] + 1e-9)
        for v in range(size):
            cost[i, v] = graph.weight[i] * flat[v] if flat[v] <= worst else FAR
    return cost


@njit(cache=True)
def _improve_arcs(graph, lattice, state):
    """Draw every arc again by its cheapest free path; whether any has changed."""
    moved = False
    for arc in range(len(state.lens)):
        _mark_path(graph, state, arc, False)
        count = _cheapest_path(graph, lattice, state, arc, state.energy[arc] - MIN_GAIN)
        if count and _replace_path(graph, lattice, state, arc, count):
            state.energy[arc] = _energy(graph, state, arc)
            moved = True
        _mark_path(graph, state, arc, True)
    return moved


@njit(cache=True)
def _replace_path(graph, lattice, state, arc, count):
    """Give an arc the path found, unless it changes the order of arcs round one of its nodes."""
    tail, head = graph.tail[arc], graph.head[arc]
    _rotation(graph, lattice, state, tail, state.rotations[0])
    _rotation(graph, lattice, state, head, state.rotation)
    _save_path(state, arc, 0)
    _take_found(state, arc, count)
    _rotation(graph, lattice, state, tail, state.rotation_now)
    keeps = is_same_rotation(state.rotations[0], state.rotation_now)
    if keeps:
        _rotation(graph, lattice, state, head, state.rotation_now)
        keeps = is_same_rotation(state.rotation, state.rotation_now)
    if not keeps:
        _restore_path(state, arc, 0)
    return keeps


@njit(cache=True)
def _improve_nodes(graph, lattice, state):
    """Step every node in every direction that lowers the energy; whether any has moved."""
    moved = False
    for node in range(len(state.where)):
        if state.where[node] < 0:
            continue
        for direction in range(4):
            goal = _neighbour(state.where[node], direction, lattice.width)
            if not _is_allowed(goal, lattice, graph.node_on_axis[node]):
                continue
            spent = _node_gain(graph, lattice, state, node, goal)
            total = 0.0
            for q in range(state.star_n[node]):
                total += state.energy[state.star[node, q]]
            # The arcs cannot get cheaper than nothing.
            if spent < total and _move_node(graph, lattice, state, node, goal, spent, total):
                moved = True
    return moved


@njit(cache=True)
def _node_gain(graph, lattice, state, node, goal):
    """Energy of a node at `goal` less its energy where it is."""
    width = lattice.width
    gx, gy = goal % width, goal // width
    hx, hy = state.where[node] % width, state.where[node] // width
    tx, ty = graph.node_target[node, 0], graph.node_target[node, 1]
    pull = NODE_PULL * graph.node_weight[node]
    return pull * ((gx - tx) ** 2 + (gy - ty) ** 2 - (hx - tx) ** 2 - (hy - ty) ** 2)


@njit(cache=True)
def _move_node(graph, lattice, state, node, goal, spent, total):
    """Move a node to a neighbouring vertex, its arcs drawn again; undone unless energy falls.

    Args:
        graph: a `Graph`.
        lattice: a `Lattice`.
        state: changed in place.
        node: which one.
        goal: its new vertex.
        spent: what the node's own energy rises by.
        total: energy of its arcs before.
    """
    here = state.where[node]
    _snapshot(graph, lattice, state, node)
    _mark_node(graph, state, node, False)
    if _is_busy(state, graph.node_layers[node], goal):
        _restore(graph, state, node, here)
        return False
    state.where[node] = goal
    _mark_node(graph, state, node, True)
    drawn = 0
    for q in range(state.star_n[node]):
        arc = state.star[node, q]
        count = _cheapest_path(graph, lattice, state, arc, total - spent)
        if count == 0:
            break
        _take_found(state, arc, count)
        _mark_path(graph, state, arc, True)
        drawn = q + 1
        spent += _energy(graph, state, arc)
        if spent >= total - MIN_GAIN:
            break
    is_lower = drawn == state.star_n[node] and spent < total - MIN_GAIN
    if is_lower and _keeps_rotations(graph, lattice, state, node):
        for q in range(state.star_n[node]):
            arc = state.star[node, q]
            state.energy[arc] = _energy(graph, state, arc)
        return True
    _mark_drawn(graph, state, node, drawn, False)
    _mark_node(graph, state, node, False)
    _restore(graph, state, node, here)
    return False


@njit(cache=True)
def _snapshot(graph, lattice, state, node):
    """Save the arcs of a node and the orders round all their nodes; take the arcs out."""
    _rotation(graph, lattice, state, node, state.rotation)
    for q in range(state.star_n[node]):
        far = _far_end(graph, state.star[node, q], node)
        _rotation(graph, lattice, state, far, state.rotations[q])
    for q in range(state.star_n[node]):
        arc = state.star[node, q]
        _save_path(state, arc, q)
        _mark_path(graph, state, arc, False)


@njit(cache=True)
def _restore(graph, state, node, here):
    """Put a node back to `here`, and its arcs as the snapshot has them."""
    state.where[node] = here
    _mark_node(graph, state, node, True)
    for q in range(state.star_n[node]):
        _restore_path(state, state.star[node, q], q)
    _mark_drawn(graph, state, node, state.star_n[node], True)


@njit(cache=True)
def _keeps_rotations(graph, lattice, state, node):
    """Whether the arcs round a node, and round the other ends of its arcs, are in order still."""
    _rotation(graph, lattice, state, node, state.rotation_now)
    if not is_same_rotation(state.rotation, state.rotation_now):
        return False
    for q in range(state.star_n[node]):
        far = _far_end(graph, state.star[node, q], node)
        _rotation(graph, lattice, state, far, state.rotation_now)
        if not is_same_rotation(state.rotations[q], state.rotation_now):
            return False
    return True


@njit(cache=True)
def _cheapest_path(graph, lattice, state, arc, limit):
    """Cheapest free path of an arc below `limit` into `state.found`; its vertices, or 0.

    Dijkstra over states (vertex, grid edges so far, up to MAX_LENGTH - 1), since what is missing
    to the desired length costs energy, too: a path may be long on purpose. Energy of the length is
    added at the goal. Costs are not negative, so what leaves the heap at or above the best path
    ends the search.
    """
    cost, previous, keys, items = state.search
    field, busy, found = state.cost[arc], state.busy, state.found
    start, goal = state.where[graph.tail[arc]], state.where[graph.head[arc]]
    mask, on_axis = graph.layers[arc], graph.on_axis[arc]
    desired, pull = graph.desired_edges[arc], SHAPE_PULL * graph.weight[arc]
    width, low, high, axis = lattice
    cost[:] = FAR
    size = 1
    keys[0], items[0] = 0.0, start * MAX_LENGTH
    cost[items[0]] = 0.0
    previous[items[0]] = -1
    best, best_state = limit, -1
    cap = MAX_LENGTH - 1
    while size > 0:
        key, here = keys[0], items[0]
        size = heap_pop(keys, items, size)
        if key > cost[here] or key >= best:
            continue
        vertex, length = here // MAX_LENGTH, here % MAX_LENGTH
        longer = min(length + 1, cap)
        for direction in range(4):
            other = _neighbour(vertex, direction, width)
            if other == goal:
                missing = desired - longer
                total = key + STEP_COST + (pull * missing * missing if missing > 0 else 0.0)
                total += TOO_SHORT * max(graph.min_edges[arc] - longer, 0)
                if total < best - MIN_GAIN:
                    best = total
                    best_state = here
                continue
            if not _is_inside(other, width, low, high, axis, on_axis) or field[other] >= FAR:
                continue
            if (mask & 1 and busy[0, other]) or (mask & 2 and busy[1, other]) or other == start:
                continue
            total = key + STEP_COST + field[other]
            index = other * MAX_LENGTH + longer
            if total < cost[index] - 1e-12 and size < len(keys):
                cost[index] = total
                previous[index] = here
                size = heap_push(keys, items, size, total, index)
    if best_state < 0:
        return 0
    return _traced(goal, best_state, previous, found)


@njit(cache=True)
def _traced(goal, last, previous, found):
    """Write the path that ends with `goal` after state `last`; its vertices, or 0 if unfit.

    States of one vertex differ by their length, so a path may cross itself: that one is refused,
    as is one that has no room.
    """
    count, here = 1, last
    found[0] = goal
    while here >= 0:
        found[count] = here // MAX_LENGTH
        count += 1
        here = previous[here]
        if count >= len(found):
            return 0
    for k in range(count // 2):
        found[k], found[count - 1 - k] = found[count - 1 - k], found[k]
    for k in range(count):
        for j in range(k):
            if found[j] == found[k]:
                return 0
    return count


@njit(cache=True)
def _energy(graph, state, arc):
    """Energy of an arc's path."""
    table, field, n = state.table, state.cost, state.lens[arc]
    total = STEP_COST * (n - 1) + TOO_SHORT * max(graph.min_edges[arc] - (n - 1), 0)
    for k in range(1, n - 1):
        total += field[arc, table[arc, k]]
    missing = graph.desired_edges[arc] - (n - 1)
    if missing > 0:
        total += SHAPE_PULL * graph.weight[arc] * missing * missing
    return total


@njit(cache=True)
def _neighbour(vertex, direction, width):
    """The vertex one grid edge away."""
    if direction == 0:
        return vertex + 1
    if direction == 1:
        return vertex + width
    if direction == 2:
        return vertex - 1
    return vertex - width


@njit(cache=True)
def _direction(a, b, width):
    """Direction of the grid edge from `a` to `b`."""
    d = b - a
    if d == 1:
        return 0
    if d == width:
        return 1
    if d == -1:
        return 2
    return 3


@njit(cache=True)
def _is_allowed(vertex, lattice, on_axis):
    """Whether a node may lie on a vertex."""
    width, low, high, axis = lattice
    return _is_inside(vertex, width, low, high, axis, on_axis)


@njit(cache=True)
def _is_inside(vertex, width, low, high, axis, on_axis):
    """Whether a vertex lies inside the limits and on the proper side of the axis, or on it."""
    x, y = vertex % width, vertex // width
    if x < low or x > high or y < low or y > high:
        return False
    if axis < 0:
        return True
    return x == axis if on_axis else x > axis


@njit(cache=True)
def _is_busy(state, layers, vertex):
    """Whether a vertex is taken on one of the layers."""
    if layers & 1 and state.busy[0, vertex]:
        return True
    return bool(layers & 2) and state.busy[1, vertex]


@njit(cache=True)
def _mark_node(graph, state, node, value):
    """Take or free the vertex of a node."""
    for layer in range(2):
        if graph.node_layers[node] >> layer & 1:
            state.busy[layer, state.where[node]] = value


@njit(cache=True)
def _mark_path(graph, state, arc, value):
    """Take or free the inner vertices of an arc's path."""
    table, busy, mask = state.table, state.busy, graph.layers[arc]
    for k in range(1, state.lens[arc] - 1):
        if mask & 1:
            busy[0, table[arc, k]] = value
        if mask & 2:
            busy[1, table[arc, k]] = value


@njit(cache=True)
def _mark_drawn(graph, state, node, count, value):
    """Take or free the paths of the first `count` arcs of a node."""
    for q in range(count):
        _mark_path(graph, state, state.star[node, q], value)


@njit(cache=True)
def _save_path(state, arc, slot):
    """Keep an arc's path to be restored."""
    state.saved_n[slot] = state.lens[arc]
    for k in range(state.lens[arc]):
        state.saved[slot, k] = state.table[arc, k]


@njit(cache=True)
def _restore_path(state, arc, slot):
    """Give an arc the path saved in a slot."""
    state.lens[arc] = state.saved_n[slot]
    for k in range(state.saved_n[slot]):
        state.table[arc, k] = state.saved[slot, k]


@njit(cache=True)
def _take_found(state, arc, count):
    """Give an arc the path that a search found."""
    state.lens[arc] = count
    for k in range(count):
        state.table[arc, k] = state.found[k]


@njit(cache=True)
def _far_end(graph, arc, node):
    """The other node of an arc."""
    return graph.head[arc] if graph.tail[arc] == node else graph.tail[arc]


@njit(cache=True)
def _rotation(graph, lattice, state, node, out):
    """Arc ends round a node by direction: out[layer, direction] = arc * 2 + end, or -1."""
    out[:] = -1
    at = state.where[node]
    for q in range(state.star_n[node]):
        arc = state.star[node, q]
        is_tail = graph.tail[arc] == node
        other = state.table[arc, 1] if is_tail else state.table[arc, state.lens[arc] - 2]
        d = _direction(at, other, lattice.width)
        for layer in range(2):
            if graph.layers[arc] >> layer & 1:
                out[layer, d] = arc * 2 + (0 if is_tail else 1)


@njit(cache=True)
def is_same_rotation(a, b):
    """Whether two [layer, direction] tables name the same arc ends in the same cyclic order."""
    first, second = np.empty(4, np.int64), np.empty(4, np.int64)
    for layer in range(2):
        n, m = 0, 0
        for d in range(4):
            if a[layer, d] >= 0:
                first[n] = a[layer, d]
                n += 1
            if b[layer, d] >= 0:
                second[m] = b[layer, d]
                m += 1
        if n != m:
            return False
        if n == 0:
            continue
        shift = -1
        for k in range(n):
            if second[k] == first[0]:
                shift = k
        if shift < 0:
            return False
        for k in range(n):
            if second[(shift + k) % n] != first[k]:
                return False
    return True
