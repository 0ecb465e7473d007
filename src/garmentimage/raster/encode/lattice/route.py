"""Fine drawing: every arc as a lattice path, vertex-disjoint inside each layer.

The lattice is `fine` times finer than the image's. Paths are shortest paths in a corridor round
their target; where paths meet, the vertices become dearer round by round until every path has
found its own (negotiated congestion, as circuits are routed).
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from garmentimage.errors import EncodeError
from garmentimage.geometry import drop_first, push
from garmentimage.raster.encode.lattice.drawing import Drawing, Path
from garmentimage.raster.encode.lattice.rotation import departures

ROUNDS = 40
"""Rounds of rip-up and re-route before a drawing is given up."""
MARGIN = 12
"""Free fine vertices round the drawing."""
WRONG_TURN = 30.0
"""Cost of leaving a node in another direction than the cyclic order asks for."""
PULL = 0.6
"""Cost of a vertex, per squared distance from the target in fine units."""
MOST_VERTICES = 1_000_000
"""A drawing that spreads over more fine vertices than this is refused."""
MOST_FIELDS = 100_000_000
"""... or one with more vertices in the corridors of all its arcs, 4 bytes each."""
FARTHEST = 1e9
"""Targets lie nearer than this to the grid's corner [fine steps]."""
FAR = 1e9


@dataclass(frozen=True)
class FinePaths:
    """Lattice paths on the fine lattice, and where their vertices would like to be."""

    paths: list[Path]
    """Per arc [n, 2], from tail to head, in fine lattice coordinates."""
    wanted: list[np.ndarray]
    """Per arc [n, 2]: target of each vertex, in (coarse) lattice coordinates."""


def route(drawing: Drawing, fine: int, radius: float, in_order: bool = True) -> FinePaths:
    """Draw every arc on the lattice that is `fine` times finer than the image.

    Args:
        drawing: what to draw.
        fine: fine steps per cell.
        radius: how far a path may leave its target [fine steps].
        in_order: arcs leave a node in the cyclic order of their targets; else as they find room.

    Raises:
        EncodeError: arcs cannot be kept apart; a finer lattice or another layout may help.
    """
    targets = np.concatenate(drawing.curves) * fine
    if not (np.isfinite(targets).all() and np.abs(targets).max() < FARTHEST):
        raise EncodeError("the garment has no place on the grid; check the placement of its panels")
    assert min(map(len, drawing.curves)) > 1
    low = np.floor(targets.min(axis=0)).astype(np.int64) - MARGIN
    high = np.ceil(targets.max(axis=0)).astype(np.int64) + MARGIN
    axis = -1
    if drawing.axis is not None:
        axis = drawing.axis * fine - low[0]
    width, height = (high - low + 1).tolist()
    if width * height > MOST_VERTICES or width * height * drawing.arc_count > MOST_FIELDS:
        raise EncodeError(
            f"the garment spreads over {width // fine} x {height // fine} cells; "
            "check the units and the placement of its panels",
            remedy="pattern",
        )
    starts = np.concatenate([[0], np.cumsum([len(c) for c in drawing.curves])])
    wished = drawing.node_target * fine - low
    # Axis nodes have the least freedom, then nodes of both layers; place breaks ties.
    first = np.lexsort(
        (
            wished[:, 0].round(),
            wished[:, 1].round(),
            drawing.node_layers != 3,
            ~drawing.node_on_axis,
        )
    )
    node_xy = snap_nodes(wished, drawing.node_layers, drawing.node_on_axis, axis, first)
    # Short arcs first: they have the least room. Rounding keeps the order under small changes.
    lengths = np.array([np.hypot(*np.diff(c * fine, axis=0).T).sum() for c in drawing.curves])
    middles = np.array([c[len(c) // 2] for c in drawing.curves]).round(1)
    order = np.lexsort((middles[:, 0], middles[:, 1], np.round(np.log2(np.maximum(lengths, 0.5)))))
    done, flat, lens = _route_all(
        order,
        drawing.tail,
        drawing.head,
        drawing.layers,
        drawing.on_axis,
        departures(drawing) if in_order else np.full((drawing.arc_count, 2), -1),
        node_xy,
        drawing.node_layers,
        targets - low,
        starts,
        float(radius),
        width,
        height,
        axis,
        ROUNDS,
    )
    if done != 1:
        raise EncodeError("its seams cross or crowd each other on the grid")
    ends = np.cumsum(lens)
    paths = [flat[e - n : e] for e, n in zip(ends, lens)]
    wanted = []
    for i, path in enumerate(paths):
        near = _nearest(path.astype(np.float64), targets[starts[i] : starts[i + 1]] - low)
        near[0] = drawing.node_target[drawing.tail[i]] * fine - low
        near[-1] = drawing.node_target[drawing.head[i]] * fine - low
        wanted.append((near + low) / fine)
    return FinePaths([p + low for p in paths], wanted)


@njit(cache=True)
def snap_nodes(target, layers, on_axis, axis, order):  # type: ignore[no-untyped-def]
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
def _nearest(points, polyline):  # type: ignore[no-untyped-def]
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
def distance_field(polyline, radius, out):  # type: ignore[no-untyped-def]
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
def _shortest(  # type: ignore[no-untyped-def]
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
def _route_all(  # type: ignore[no-untyped-def]
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
