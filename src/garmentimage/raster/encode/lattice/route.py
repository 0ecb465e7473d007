"""Fine drawing: every arc as a lattice path, vertex-disjoint inside each layer.

The lattice is `fine` times finer than the image's. Paths are cheapest paths in a corridor round
their target; where paths meet, the vertices become dearer round by round until every path has
found its own (negotiated congestion, as circuits are routed; see `_kernels_route`).
"""

import numpy as np
from jaxtyping import Bool, Int

from garmentimage.errors import EncodeError
from garmentimage.raster.encode.lattice._kernels_route import (
    Net,
    Routes,
    Search,
    Traffic,
    distance_field,
    find_clashes,
    nearest_points,
    reroute,
    snap_nodes,
)
from garmentimage.raster.encode.lattice.drawing import Drawing, DrawnPaths, Path
from garmentimage.raster.encode.lattice.rotation import departures

MAX_ROUNDS = 40
"""Rounds of rip-up and re-route before a drawing is abandoned."""
FIRST_PRICE, DEARER = 8.0, 1.5
"""Cost of a vertex per other path on it, and by what factor it grows from round to round."""
CLASH_COST = 4.0
"""What is added to the cost of a vertex after each round in which paths met on it."""
MARGIN = 12
"""Free fine vertices round the drawing."""
MAX_VERTICES = 1_000_000
"""A drawing that spreads over more fine vertices than this is refused."""
MAX_CORRIDORS = 100_000_000
"""... or one with more vertices in the corridors of all its arcs, 4 bytes each."""
MAX_COORDINATE = 1e9
"""Targets lie nearer than this to the grid's corner [fine steps]."""


class CrossingError(EncodeError):
    """Arcs that cannot be kept apart."""


def route(drawing: Drawing, fine: int, radius: float, in_order: bool = True) -> DrawnPaths:
    """Draw every arc on the lattice that is `fine` times finer than the image.

    Args:
        drawing: what to draw.
        fine: fine steps per cell.
        radius: how far a path may leave its target [fine steps].
        in_order: arcs leave a node in the cyclic order of their targets; else as they find room.

    Raises:
        CrossingError: arcs cannot be kept apart; a finer lattice or another layout may help.
    """
    nodes, arcs = drawing.nodes, drawing.arcs
    low, width, height = _extent(drawing, fine)
    curves = [curve * fine - low for curve in arcs.curves]
    target = nodes.target * fine - low
    axis = -1 if drawing.axis is None else drawing.axis * fine - low[0]
    # Axis nodes have the least freedom, then nodes of most layers; place breaks ties.
    fewest = -np.bitwise_count(nodes.layers).astype(np.int64)
    first = np.lexsort((target[:, 0].round(), target[:, 1].round(), fewest, ~nodes.on_axis))
    node_xy = snap_nodes(target, nodes.layers, nodes.on_axis, axis, first)
    # A corridor is all that lies within `radius` of an arc's target.
    corridors = np.empty((len(arcs), height, width), np.float32)
    # Paths end where their nodes were put, not where the curves end.
    for i, curve in enumerate(curves):
        line = curve.copy()
        line[0], line[-1] = node_xy[arcs.tail[i]], node_xy[arcs.head[i]]
        distance_field(line, float(radius), corridors[i])
    leaving = departures(drawing) if in_order else np.full((len(arcs), 2), -1)
    net = Net(
        tail=arcs.tail,
        head=arcs.head,
        layers=arcs.layers,
        on_axis=arcs.on_axis,
        departures=leaving,
        node_xy=node_xy,
        corridors=corridors,
        axis=int(axis),
    )
    on_layer = np.stack([nodes.layers >> k & 1 for k in range(drawing.layer_count)]).astype(bool)
    paths = _disjoint_paths(net, on_layer, _routing_order(drawing, fine))
    # Every vertex wants to lie at the nearest point of its curve, its ends at their nodes.
    wanted = []
    for i, path in enumerate(paths):
        near = nearest_points(path.astype(np.float64), curves[i])
        near[0], near[-1] = target[arcs.tail[i]], target[arcs.head[i]]
        wanted.append((near + low) / fine)
    return DrawnPaths([path + low for path in paths], wanted)


def new_search(states: int) -> Search:
    """Room for a search; each of four neighbours may put a state on the heap."""
    cost, keys = np.empty(states), np.empty(4 * states)
    return Search(cost, np.empty(states, np.int32), keys, np.empty(4 * states, np.int32))


def _extent(drawing: Drawing, fine: int) -> tuple[Int[np.ndarray, " 2"], int, int]:
    """Lowest corner, width and height of the fine lattice round a drawing."""
    targets = np.concatenate(drawing.arcs.curves) * fine
    if not (np.isfinite(targets).all() and np.abs(targets).max() < MAX_COORDINATE):
        raise EncodeError("the garment has no place on the grid; check the placement of its panels")
    assert min(map(len, drawing.arcs.curves)) > 1
    low = np.floor(targets.min(axis=0)).astype(np.int64) - MARGIN
    high = np.ceil(targets.max(axis=0)).astype(np.int64) + MARGIN
    width, height = (high - low + 1).tolist()
    if width * height > MAX_VERTICES or width * height * len(drawing.arcs) > MAX_CORRIDORS:
        raise EncodeError(
            f"the garment spreads over {width // fine} x {height // fine} cells; "
            "check the units and the placement of its panels",
            remedy="pattern",
        )
    return low, width, height


def _routing_order(drawing: Drawing, fine: int) -> Int[np.ndarray, " arc"]:
    """Short arcs first: they have the least room. Rounding keeps the order under small changes."""
    curves = drawing.arcs.curves
    lengths = np.array([np.hypot(*np.diff(c * fine, axis=0).T).sum() for c in curves])
    middles = np.array([c[len(c) // 2] for c in curves]).round(1)
    # Powers of two: small changes of a garment hardly ever change the order.
    sizes = np.round(np.log2(np.maximum(lengths, 0.5)))
    return np.lexsort((middles[:, 0], middles[:, 1], sizes))


def _disjoint_paths(
    net: Net, on_layer: Bool[np.ndarray, "layer node"], order: Int[np.ndarray, " arc"]
) -> list[Path]:
    """Paths that share no inner vertex in a layer: rip-up and re-route until none clash."""
    count, height, width = net.corridors.shape
    size = width * height
    # A node blocks its vertex for all paths of its layers but its own.
    is_node = np.zeros((len(on_layer), size), bool)
    for layer, nodes in enumerate(on_layer):
        x, y = net.node_xy[nodes].T
        is_node[layer, y * width + x] = True
    traffic = Traffic(is_node, np.zeros(is_node.shape, np.int32), np.zeros(is_node.shape))
    # A longer path winds: it is refused.
    longest = 4 * (width + height)
    routes = Routes(np.zeros((count, longest), np.int32), np.zeros(count, np.int64))
    search, found = new_search(size), np.empty(size, np.int32)
    price = FIRST_PRICE
    clashing = np.ones(count, bool)
    for _ in range(MAX_ROUNDS):
        if not reroute(order, clashing, net, traffic, price, routes, search, found):
            break
        find_clashes(net, traffic, routes, clashing)
        if not clashing.any():
            is_used = np.arange(longest) < routes.lens[:, None]
            vertices = routes.vertices[is_used].astype(np.int64)
            points = np.stack([vertices % width, vertices // width], axis=1)
            return np.split(points, np.cumsum(routes.lens)[:-1])
        # Both costs grow: history remembers where paths met, price presses all of them.
        traffic.history[traffic.use > 1] += CLASH_COST
        price *= DEARER
    raise CrossingError("its seams cross or crowd each other on the grid")
