"""Compiled parts of routing: departures round nodes, node places, paths that share no vertex.

Routing is negotiated congestion (McMurchie and Ebeling, PathFinder, 1995). Every arc takes the
cheapest path through its corridor, where entering a vertex v costs

    1 + PULL dist²(v, target curve) + sum over the arc's layers (price use(v) + history(v))

and WRONG_TURN more where the first or last step breaks the cyclic order round its node. `use`
counts the other paths through v, `history` grows in each round in which v has more than one, and
`price` grows from round to round, so that arcs with another path leave a vertex that others need.

Vertices are numbered y * width + x, directions 0 right, 1 up, 2 left, 3 down, layers are bit masks.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from garmentimage.geometry import heap_pop, heap_push

WRONG_TURN = 30.0
"""Cost of leaving a node in another direction than the cyclic order wants."""
PULL = 0.6
"""Cost of a vertex, per squared distance from the target in fine units."""
FAR = 1e9
"""Farther than anything: outside a corridor."""
TAKEN, CROWDED = 1e17, 1.5
"""Cost of a vertex for a node where another node of its layers is, or is next to it."""
DX, DY = (1, 0, -1, 0), (0, 1, 0, -1)
"""Step along x and y in each direction."""


class Net(NamedTuple):
    """What is routed; read only."""

    tail: np.ndarray  # arc
    head: np.ndarray  # arc
    layers: np.ndarray  # arc
    on_axis: np.ndarray  # arc
    departures: np.ndarray  # arc 2: directions at tail and head, -1 for any
    node_xy: np.ndarray  # node 2
    corridors: np.ndarray  # arc y x: squared distance from the target, FAR outside
    axis: int
    """Column of the mirror axis, -1 without."""


class Traffic(NamedTuple):
    """What is on the vertices of the lattice."""

    is_node: np.ndarray  # layer vertex
    use: np.ndarray  # layer vertex: inner vertices of paths on it
    history: np.ndarray  # layer vertex: cost of past clashes


class Routes(NamedTuple):
    """The paths so far."""

    vertices: np.ndarray  # arc k: from tail to head
    lens: np.ndarray  # arc: vertices that each has, 0 before the first round


class Search(NamedTuple):
    """Scratch arrays of a search for the cheapest path."""

    cost: np.ndarray  # state
    previous: np.ndarray  # state
    keys: np.ndarray  # heap
    items: np.ndarray  # heap


@njit(cache=True)
def snap_nodes(target, layers, on_axis, axis, order):
    """Nearest distinct lattice points for nodes; a free ring round each is preferred.

    Greedy, in the given order: each node takes the vertex that minimises its squared distance plus
    penalties for nodes of its layers on it or next to it. A point lies at most 6 from its target in
    x and in y, which `MARGIN` leaves room for.

    Args:
        target: [node, 2] where nodes should lie.
        layers: [node] bit masks.
        on_axis: [node] whether a node must lie on the axis; others must lie right of it.
        axis: column of the mirror axis, -1 without.
        order: node numbers, those with the least freedom first.
    """
    count = len(target)
    xy = np.zeros((count, 2), np.int64)
    placed = np.zeros(count, np.bool_)
    for i in order:
        cx, cy = int(np.floor(target[i, 0] + 0.5)), int(np.floor(target[i, 1] + 0.5))
        best, bx, by = 1e18, cx, cy
        # Rings of vertices round the target, until one has room.
        for reach in range(7):
            for dx in range(-reach, reach + 1):
                for dy in range(-reach, reach + 1):
                    if max(abs(dx), abs(dy)) != reach:
                        continue
                    x, y = cx + dx, cy + dy
                    if _is_off_side(x, axis, on_axis[i]):
                        continue
                    cost = (x - target[i, 0]) ** 2 + (y - target[i, 1]) ** 2
                    cost = _with_crowding(cost, x, y, i, xy, placed, layers)
                    if cost < best:
                        best, bx, by = cost, x, y
            # Two rings at least: the nearest free vertex may be crowded.
            if reach >= 2 and best < TAKEN / 10:
                break
        xy[i, 0], xy[i, 1] = bx, by
        placed[i] = True
    return xy


@njit(cache=True)
def _with_crowding(cost, x, y, node, xy, placed, layers):
    """`cost` and what other nodes of a node's layers on a vertex, or next to it, cost."""
    for j in range(len(xy)):
        if placed[j] and layers[j] & layers[node]:
            gx, gy = abs(xy[j, 0] - x), abs(xy[j, 1] - y)
            # A neighbour leaves arcs too little room to turn, but is better than none.
            if gx == 0 and gy == 0:
                cost += TAKEN
            elif gx <= 1 and gy <= 1:
                cost += CROWDED
    return cost


@njit(cache=True)
def nearest_points(points, polyline):
    """Nearest point of a polyline to each point."""
    out = np.empty_like(points)
    for p in range(len(points)):
        best = 1e30
        for k in range(len(polyline) - 1):
            ax, ay = polyline[k, 0], polyline[k, 1]
            ex, ey = polyline[k + 1, 0] - ax, polyline[k + 1, 1] - ay
            size = ex * ex + ey * ey
            # Foot of the perpendicular, as a share of the segment; one that is a point has none.
            t = 0.0
            if size > 1e-12:
                t = ((points[p, 0] - ax) * ex + (points[p, 1] - ay) * ey) / size
                t = min(max(t, 0.0), 1.0)
            x, y = ax + t * ex, ay + t * ey
            d = (points[p, 0] - x) ** 2 + (points[p, 1] - y) ** 2
            if d < best:
                best, out[p, 0], out[p, 1] = d, x, y
    return out


@njit(cache=True)
def distance_field(polyline, radius, out):
    """Squared distance from each vertex of `out` [y, x] to the polyline, FAR beyond `radius`."""
    out[:] = FAR
    height, width = out.shape
    limit = radius * radius
    for k in range(len(polyline) - 1):
        ax, ay = polyline[k, 0], polyline[k, 1]
        bx, by = polyline[k + 1, 0], polyline[k + 1, 1]
        ex, ey = bx - ax, by - ay
        size = ex * ex + ey * ey
        # Only vertices within reach of the segment: its box, widened by the radius.
        x0 = max(int(np.floor(min(ax, bx) - radius)), 0)
        x1 = min(int(np.ceil(max(ax, bx) + radius)), width - 1)
        y0 = max(int(np.floor(min(ay, by) - radius)), 0)
        y1 = min(int(np.ceil(max(ay, by) + radius)), height - 1)
        for y in range(y0, y1 + 1):
            for x in range(x0, x1 + 1):
                t = 0.0
                if size > 1e-12:
                    t = min(max(((x - ax) * ex + (y - ay) * ey) / size, 0.0), 1.0)
                d = (x - ax - t * ex) ** 2 + (y - ay - t * ey) ** 2
                if d <= limit and d < out[y, x]:
                    out[y, x] = d


@njit(cache=True)
def reroute(order, chosen, net, traffic, price, routes, search, found):
    """Take out the paths of the chosen arcs, one by one, and find each a new one.

    Nodes and corridors lie on the lattice, 0 <= x < width and 0 <= y < height; an arc has two
    different nodes. Traffic and routes are changed in place.

    Args:
        order: arc numbers, in the order in which they are routed.
        chosen: [arc] which of them.
        net: a `Net`.
        traffic: a `Traffic`.
        price: cost of a vertex per path that uses it.
        routes: a `Routes`.
        search: a `Search` with a state for each vertex.
        found: [k] room for the longest path.

    Returns:
        False where an arc has no path, or none that fits `routes`.
    """
    width = net.corridors.shape[2]
    for arc in order:
        if not chosen[arc]:
            continue
        # Out first: a path costs its own arc nothing.
        _count_use(arc, net, traffic, routes, -1)
        tail, head = net.node_xy[net.tail[arc]], net.node_xy[net.head[arc]]
        start, goal = tail[1] * width + tail[0], head[1] * width + head[0]
        # Without a path, or with one that winds without end, the drawing fails.
        count = _shortest(start, goal, arc, net, traffic, price, search, found)
        if count < 2 or count > routes.vertices.shape[1]:
            return False
        routes.lens[arc] = count
        # A search is traced back from its goal.
        for k in range(count):
            routes.vertices[arc, k] = found[count - 1 - k]
        # Arcs routed after this one see where it runs, those before it in the next round.
        _count_use(arc, net, traffic, routes, 1)
    return True


@njit(cache=True)
def find_clashes(net, traffic, routes, clashing):
    """Mark in `clashing` the arcs that share an inner vertex with another of their layers."""
    clashing[:] = False
    for arc in range(len(clashing)):
        for k in range(1, routes.lens[arc] - 1):
            for layer in range(len(traffic.use)):
                # The arc's own use counts once.
                is_on = net.layers[arc] >> layer & 1
                if is_on and traffic.use[layer, routes.vertices[arc, k]] > 1:
                    clashing[arc] = True


@njit(cache=True)
def _count_use(arc, net, traffic, routes, change):
    """Add to the use of the inner vertices of an arc's path."""
    for k in range(1, routes.lens[arc] - 1):
        for layer in range(len(traffic.use)):
            if net.layers[arc] >> layer & 1:
                traffic.use[layer, routes.vertices[arc, k]] += change


@njit(cache=True)
def _shortest(start, goal, arc, net, traffic, price, search, found):
    """Cheapest path in an arc's corridor (Dijkstra 1959) into `found`, goal first.

    Returns the number of its vertices, 0 where there is no path.
    """
    cost, previous, keys, items = search
    is_node, use, history = traffic
    field, axis, on_axis, mask = net.corridors[arc], net.axis, net.on_axis[arc], net.layers[arc]
    leave, arrive = net.departures[arc, 0], net.departures[arc, 1]
    height, width = field.shape
    # No heap entry is ever changed: a vertex is pushed again where it gets cheaper, and
    # entries that cost more than their vertex are dropped.
    cost[:] = FAR * FAR
    cost[start] = 0.0
    previous[start] = -1
    keys[0], items[0], size = 0.0, start, 1
    while size > 0:
        key, vertex = keys[0], items[0]
        size = heap_pop(keys, items, size)
        if key > cost[vertex]:
            continue
        if vertex == goal:
            break
        x0, y0 = vertex % width, vertex // width
        for step in range(4):
            x, y = x0 + DX[step], y0 + DY[step]
            if x < 0 or y < 0 or x >= width or y >= height or field[y, x] >= FAR:
                continue
            other = y * width + x
            if other != goal and _is_off_side(x, axis, on_axis):
                continue
            # At both nodes a step may break the cyclic order; at the goal it is seen from there.
            extra = _turn_cost(step, leave) if vertex == start else 0.0
            if other == goal:
                extra += _turn_cost((step + 2) % 4, arrive)
            else:
                extra = _with_congestion(extra, other, mask, is_node, use, history, price)
            if extra < 0.0:
                continue
            total = key + 1.0 + PULL * field[y, x] + extra
            # The tolerance keeps the first of equal paths, whatever the rounding.
            if total < cost[other] - 1e-12:
                cost[other] = total
                previous[other] = vertex
                if size < len(keys):
                    size = heap_push(keys, items, size, total, other)
    return 0 if cost[goal] >= FAR * FAR else trace_back(goal, previous, found)


@njit(cache=True)
def trace_back(last, previous, found):
    """Write what leads to `last` into `found`, `last` first, as far as there is room; how many."""
    count = 0
    while last >= 0 and count < len(found):
        found[count] = last
        count += 1
        last = previous[last]
    return count


@njit(cache=True)
def _is_off_side(x, axis, on_axis):
    """Whether a column is off the axis where an arc runs along it, or else not right of it."""
    return axis >= 0 and ((x != axis) if on_axis else (x <= axis))


@njit(cache=True)
def _turn_cost(direction, wanted):
    """Cost of a direction at a node where another is wanted; any will do where that is -1."""
    return WRONG_TURN if wanted >= 0 and direction != wanted else 0.0


@njit(cache=True)
def _with_congestion(extra, vertex, mask, is_node, use, history, price):
    """`extra` and what the traffic on a vertex costs, or -1 where a node blocks it."""
    for layer in range(len(use)):
        if mask >> layer & 1:
            # Not reached for the goal, the one node that an arc may enter.
            if is_node[layer, vertex]:
                return -1.0
            extra += price * use[layer, vertex] + history[layer, vertex]
    return extra


@njit(cache=True)
def choose_directions(layers, angles, layer_count):
    """Directions in which arcs leave a node (see `rotation.departures`).

    Of all assignments of the four directions that give no two arcs of a layer one direction, and
    have on each layer the cyclic order of the angles, the one that turns the arcs least: the sum of
    1 - cos(angle - direction) is smallest. Found by branch and bound, the last end first; of equal
    ones the first in that order.

    Args:
        layers: [end] bit masks of the arcs that end at the node.
        angles: [end] in which their targets leave it [radians].
        layer_count: how many layers there are.

    Returns:
        [end] directions, -1 where none will do.
    """
    count = len(layers)
    best, out = FAR * FAR, np.full(count, -1)
    pick = np.full(count, -1)
    # Cost of the ends that have a direction, and the layers in which each direction is taken.
    cost = np.zeros(count + 1)
    taken = np.zeros((count + 1, 4), np.int64)
    k = count - 1
    while k < count:
        pick[k] += 1
        if pick[k] == 4:
            pick[k] = -1
            k += 1
            continue
        d = pick[k]
        # 0 along the angle, at most 2 against it.
        total = cost[k + 1] + 1.0 - np.cos(angles[k] - d * np.pi / 2)
        # With room for rounding: what is best is decided by sums in one order.
        if taken[k + 1, d] & layers[k] or total >= best + 1e-9:
            continue
        if k > 0:
            cost[k] = total
            taken[k] = taken[k + 1]
            taken[k, d] |= layers[k]
            k -= 1
            continue
        total = 0.0
        for i in range(count):
            total += 1.0 - np.cos(angles[i] - pick[i] * np.pi / 2)
        # The order is dearer to test than the cost, and most assignments fail by that.
        if total < best and _keeps_order(pick, layers, angles, layer_count):
            best = total
            out[:] = pick
    return out


@njit(cache=True)
def _keeps_order(pick, layers, angles, layer_count):
    """Whether directions and angles of each layer's arcs have the same cyclic order."""
    by_direction, is_taken = np.empty(4), np.empty(4, np.bool_)
    for layer in range(layer_count):
        is_taken[:] = False
        for k in range(len(layers)):
            if layers[k] >> layer & 1:
                # Adding 10 rounds the last bits off: angles that differ by them are in any order.
                by_direction[pick[k]] = angles[k] + 10.0
                is_taken[pick[k]] = True
        # The angles rise all the way round but for one place where they start again.
        ring = by_direction[is_taken]
        if len(ring) > 2 and (np.roll(ring, -1) < ring).sum() != 1:
            return False
    return True
