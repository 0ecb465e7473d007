"""Compiled parts of routing: departures round nodes, node places, paths that share no vertex."""

import numpy as np
from numba import njit

from garmentimage.geometry import drop_first, push

ROUNDS = 40
"""Rounds of rip-up and re-route before a drawing is given up."""
WRONG_TURN = 30.0
"""Cost of leaving a node in another direction than the cyclic order asks for."""
PULL = 0.6
"""Cost of a vertex, per squared distance from the target in fine units."""
FAR = 1e9
MOST_ENDS = 8
"""More arc ends than this round one node cannot be drawn: four on each layer."""


@njit(cache=True)
def snap_nodes(target, layers, on_axis, axis, order):
    """Nearest distinct lattice points for nodes; a free ring round each is preferred.

    A point lies at most 6 from its target in x and in y, which `MARGIN` leaves room for.
    """
    count = len(target)
    xy = np.zeros((count, 2), np.int64)
    placed = np.zeros(count, np.bool_)
    for i in order:
        cx, cy = int(np.floor(target[i, 0] + 0.5)), int(np.floor(target[i, 1] + 0.5))
        best, bx, by = 1e18, cx, cy
        for reach in range(7):
            for dx in range(-reach, reach + 1):
                for dy in range(-reach, reach + 1):
                    if max(abs(dx), abs(dy)) != reach:
                        continue
                    x, y = cx + dx, cy + dy
                    if axis >= 0 and ((on_axis[i] and x != axis) or (not on_axis[i] and x <= axis)):
                        continue
                    cost = (x - target[i, 0]) ** 2 + (y - target[i, 1]) ** 2
                    for j in range(count):
                        if placed[j] and layers[j] & layers[i]:
                            gx, gy = abs(xy[j, 0] - x), abs(xy[j, 1] - y)
                            if gx == 0 and gy == 0:
                                cost += 1e17
                            elif gx <= 1 and gy <= 1:
                                cost += 1.5
                    if cost < best:
                        best, bx, by = cost, x, y
            if reach >= 2 and best < 1e16:
                break
        xy[i, 0], xy[i, 1] = bx, by
        placed[i] = True
    return xy


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
def _shortest(
    start, goal, mask, leave, arrive, use, history, nodes, field, price, axis, on_axis, work
):  # fmt: skip
    """Shortest path in the corridor, as vertex numbers from goal back to start; count in [0]."""
    cost, previous, keys, items, out, layers = work
    height, width = field.shape
    cost[:] = FAR * FAR
    cost[start] = 0.0
    previous[start] = -1
    keys[0], items[0], size = 0.0, start, 1
    while size > 0:
        key, vertex = keys[0], items[0]
        size = drop_first(keys, items, size)
        if key > cost[vertex]:
            continue
        if vertex == goal:
            break
        x0, y0 = vertex % width, vertex // width
        for step in range(4):
            x = x0 + (1 if step == 0 else -1 if step == 2 else 0)
            y = y0 + (1 if step == 1 else -1 if step == 3 else 0)
            if x < 0 or y < 0 or x >= width or y >= height or field[y, x] >= FAR:
                continue
            other = y * width + x
            wrong_side = (x != axis) if on_axis else (x <= axis)
            if axis >= 0 and other != goal and wrong_side:
                continue
            extra = 0.0
            if vertex == start and leave >= 0 and step != leave:
                extra += WRONG_TURN
            if other == goal and arrive >= 0 and step != (arrive + 2) % 4:
                extra += WRONG_TURN
            if other != goal:
                blocked = False
                for layer in range(layers):
                    if mask >> layer & 1:
                        if nodes[layer, other]:
                            blocked = True
                        extra += price * use[layer, other] + history[layer, other]
                if blocked:
                    continue
            total = key + 1.0 + PULL * field[y, x] + extra
            if total < cost[other] - 1e-12:
                cost[other] = total
                previous[other] = vertex
                if size < len(keys):
                    size = push(keys, items, size, total, other)
    if cost[goal] >= FAR * FAR:
        return 0
    count, vertex = 0, goal
    while vertex >= 0:
        out[count] = vertex
        count += 1
        vertex = previous[vertex]
    return count


@njit(cache=True)
def route_all(
    order, tail, head, mask, on_axis, leaving, node_xy, node_layers, targets, starts, radius,
    width, height, axis, rounds,
):  # fmt: skip
    """Paths that share no vertex in a layer: (1, vertices, counts), or (0 or 2, none, counts).

    Nodes and targets lie on the lattice, 0 <= x < width and 0 <= y < height; an arc has two points
    or more. Paths have no loops, so a heap or a path never holds more than its array.
    """
    arcs, size, layers = len(tail), width * height, 2
    use = np.zeros((layers, size), np.int32)
    history = np.zeros((layers, size))
    nodes = np.zeros((layers, size), np.bool_)
    for n in range(len(node_xy)):
        for layer in range(layers):
            if node_layers[n] >> layer & 1:
                nodes[layer, node_xy[n, 1] * width + node_xy[n, 0]] = True
    fields = np.empty((arcs, height, width), np.float32)
    lens = np.zeros(arcs, np.int64)
    room = 4 * (width + height)
    paths = np.zeros((arcs, room), np.int32)
    work = (
        np.empty(size),
        np.empty(size, np.int32),
        np.empty(4 * size),
        np.empty(4 * size, np.int32),
        np.empty(size, np.int32),
        layers,
    )
    out = work[4]
    for i in range(arcs):
        line = targets[starts[i] : starts[i + 1]].copy()
        line[0, 0], line[0, 1] = node_xy[tail[i], 0], node_xy[tail[i], 1]
        line[-1, 0], line[-1, 1] = node_xy[head[i], 0], node_xy[head[i], 1]
        distance_field(line, radius, fields[i])
    price = 8.0
    again = np.ones(arcs, np.bool_)
    for _ in range(rounds):
        for i in order:
            if not again[i]:
                continue
            for k in range(1, lens[i] - 1):
                for layer in range(layers):
                    if mask[i] >> layer & 1:
                        use[layer, paths[i, k]] -= 1
            start = node_xy[tail[i], 1] * width + node_xy[tail[i], 0]
            goal = node_xy[head[i], 1] * width + node_xy[head[i], 0]
            count = _shortest(
                start, goal, mask[i], leaving[i, 0], leaving[i, 1], use, history, nodes,
                fields[i], price, axis, on_axis[i], work,
            )  # fmt: skip
            if count < 2 or count > room:
                return 0, np.zeros((0, 2), np.int64), lens
            lens[i] = count
            for k in range(count):
                paths[i, k] = out[count - 1 - k]
            for k in range(1, count - 1):
                for layer in range(layers):
                    if mask[i] >> layer & 1:
                        use[layer, paths[i, k]] += 1
        clash = False
        again[:] = False
        for i in range(arcs):
            for k in range(1, lens[i] - 1):
                for layer in range(layers):
                    if mask[i] >> layer & 1 and use[layer, paths[i, k]] > 1:
                        again[i] = True
                        clash = True
        if not clash:
            flat = np.empty((lens.sum(), 2), np.int64)
            at = 0
            for i in range(arcs):
                for k in range(lens[i]):
                    flat[at, 0], flat[at, 1] = paths[i, k] % width, paths[i, k] // width
                    at += 1
            return 1, flat, lens
        for layer in range(layers):
            for v in range(size):
                if use[layer, v] > 1:
                    history[layer, v] += 4.0
        price *= 1.5
    return 2, np.zeros((0, 2), np.int64), lens


@njit(cache=True)
def choose_departures(tail, head, layers, on_axis, node_on_axis, angles, nodes, has_axis):
    arcs = len(tail)
    out = np.full((arcs, 2), -1, np.int64)
    ends = np.empty((MOST_ENDS, 2), np.int64)
    for node in range(nodes):
        count = 0
        degree = np.zeros(2, np.int64)
        fits = True
        for arc in range(arcs):
            for end in range(2):
                if (tail[arc] if end == 0 else head[arc]) == node:
                    if count == MOST_ENDS:
                        fits = False
                        continue
                    ends[count, 0], ends[count, 1] = arc, end
                    count += 1
                    for layer in range(2):
                        degree[layer] += layers[arc] >> layer & 1
        if has_axis and node_on_axis[node]:
            for k in range(count):
                arc, end = ends[k]
                if on_axis[arc]:
                    out[arc, end] = 1 if np.sin(angles[arc, end]) > 0 else 3
                else:
                    out[arc, end] = 0
            continue
        if not fits or degree.max() <= 2 or degree.max() > 4:
            continue
        best = 1e18
        pick = np.zeros(count, np.int64)
        for code in range(4**count):
            rest, cost = code, 0.0
            taken = np.zeros((2, 4), np.bool_)
            good = True
            for k in range(count):
                d = rest % 4
                rest //= 4
                pick[k] = d
                arc, end = ends[k]
                for layer in range(2):
                    if layers[arc] >> layer & 1:
                        good = good and not taken[layer, d]
                        taken[layer, d] = True
                if not good:
                    break
                turn = angles[arc, end] - d * np.pi / 2
                cost += 1.0 - np.cos(turn)
                if cost >= best:
                    good = False
                    break
            if not good:
                continue
            for layer in range(2):
                if not _keeps_order(ends, pick, count, angles, layers, layer):
                    good = False
            if good:
                best = cost
                for k in range(count):
                    out[ends[k, 0], ends[k, 1]] = pick[k]
    return out


@njit(cache=True)
def _keeps_order(ends, pick, count, angles, layers, layer):
    """Whether directions and angles of one layer's arcs have the same cyclic order."""
    by_direction = np.full(4, -1.0)
    n = 0
    for k in range(count):
        if layers[ends[k, 0]] >> layer & 1:
            by_direction[pick[k]] = angles[ends[k, 0], ends[k, 1]] + 10.0
            n += 1
    if n < 3:
        return True
    falls = 0
    order = by_direction[by_direction > 0]
    for k in range(n):
        if order[(k + 1) % n] < order[k]:
            falls += 1
    return falls == 1
