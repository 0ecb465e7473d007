"""Repair of triangle meshes: closed surfaces with normals that point outwards.

Each side of a triangle has a direction. On a closed surface every edge is used as often in one
direction as in the other; where it is not lies the **rim** of a hole. A surface whose rims are
closed by caps has an inside everywhere, whatever other defects it has: lips that lie on each other,
vertices merged by rounding, parts that pass through each other. Which places are inside is decided
by the winding number (Jacobson, Kavan and Sorkine-Hornung 2013, "Robust inside-outside segmentation
using generalized winding numbers"), which `drape.solver` counts.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from garmentimage.body.body import Points3
from garmentimage.geometry import component_labels

WELDS = (1e-6, 1e-5, 1e-4, 5e-4)
"""Vertices along rims are one where they are nearer than the first of these shares of the
surface's size that closes the rims, or that leaves least open."""
SMALL_PART = 0.1  # parts smaller than this share of the whole are eyes, teeth and lashes
TWINNED = 0.5
"""Where more than this share of the triangles have a twin of opposite orientation, the surface
was written with two sides."""

Faces = Int[np.ndarray, "_ 3"]
Loops = list[Int[np.ndarray, " _"]]


@dataclass(frozen=True, eq=False)
class OpenSurface:
    """Triangles of a mesh file and the rims that they leave open."""

    points: Points3
    faces: Faces
    rims: Loops
    """Corners along each rim, in the direction in which the triangles go along it."""


def welded(points: Points3, faces: Faces) -> OpenSurface:
    """The surface with vertices of one place made one, and along rims those that nearly coincide.

    Points may be in any unit; triangles that look to different sides are made to agree.
    """
    places, number = np.unique(points, axis=0, return_inverse=True)
    best = agreeing(_without_twins(number.reshape(-1)[faces]))
    rim = _rim_edges(best)
    for share in WELDS:
        if not len(rim):
            break
        near = share * size(places[best].reshape(-1, 3))
        joined = agreeing(_without_twins(_joined(places, rim, near)[best]))
        closer = _rim_edges(joined)
        if len(closer) < len(rim):
            best, rim = joined, closer
    return OpenSurface(places, best, _loops(rim))


def parts(surface: OpenSurface) -> list[OpenSurface]:
    """The connected parts, those with most triangles first, their vertices numbered anew."""
    points, faces = surface.points, surface.faces
    label = component_labels(len(points), faces[:, [0, 1, 1, 2]].reshape(-1, 2))
    _, part, sizes = np.unique(label[faces[:, 0]], return_inverse=True, return_counts=True)
    found = []
    for k in np.argsort(-sizes, kind="stable").tolist():
        used, number = np.unique(faces[part == k], return_inverse=True)
        own = number.reshape(-1, 3)
        found.append(OpenSurface(points[used], own, _loops(_rim_edges(own))))
    return found


def united(surfaces: list[OpenSurface]) -> tuple[Points3, Faces]:
    """Several surfaces as one, each looking outwards, their rims closed by fans."""
    points, faces, first = [], [], 0
    for surface in surfaces:
        own_points, own = capped(surface)
        a, b, c = np.moveaxis(own_points[own] - own_points[0], 1, 0)
        volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
        points.append(own_points)
        faces.append((own if volume > 0 else own[:, ::-1]) + first)
        first += len(own_points)
    return np.concatenate(points), np.concatenate(faces)


def capped(surface: OpenSurface) -> tuple[Points3, Faces]:
    """The triangles, and for each rim a fan from its middle that closes it."""
    points, faces = [surface.points], [surface.faces]
    for k, rim in enumerate(surface.rims):
        middle = len(surface.points) + k
        points.append(surface.points[rim].mean(axis=0)[None])
        # The cap runs along the rim in the opposite direction.
        faces.append(np.stack([np.roll(rim, -1), rim, np.full(len(rim), middle)], axis=1))
    return np.concatenate(points), np.concatenate(faces)


def size(points: Points3) -> float:
    """Diagonal of the box round the points."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def _without_twins(faces: Faces) -> Faces:
    """The triangles without those of no extent and those that cancel each other.

    Two with the same corners and opposite orientation are a fold that rounding has closed. If most
    have such a twin, the surface was written with two sides, and the first of each two is kept.
    """
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    if not len(faces):
        return faces
    order = np.sort(faces, axis=1)
    ahead = faces[np.arange(len(faces)), (faces.argmin(axis=1) + 1) % 3] == order[:, 1]
    _, first, group = np.unique(order, axis=0, return_index=True, return_inverse=True)
    group = group.reshape(-1)
    forward, backward = (np.bincount(group, turned) for turned in (ahead, ~ahead))
    if (forward == backward).mean() > TWINNED:
        return faces[np.sort(first)]
    cancelled = np.minimum(forward, backward)[group]
    return faces[np.where(ahead, _rank(group, ahead), _rank(group, ~ahead)) >= cancelled]


def _rank(group: Int[np.ndarray, " n"], counted: Bool[np.ndarray, " n"]) -> Int[np.ndarray, " n"]:
    """How many of the same group that are counted come before each."""
    order = np.argsort(group, kind="stable")
    before = np.cumsum(counted[order]) - counted[order]
    starts = np.searchsorted(group[order], group[order])
    rank = np.empty(len(group), np.int64)
    rank[order] = before - before[starts]
    return rank


def mesh_edges(faces: Faces) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sorted ends of each edge, lower number first; the edge of each side; 1 or -1 as it runs.

    First come the first sides of all triangles, then the second and the third.
    """
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    ends = np.sort(sides, axis=1)
    number = ends[:, 0] * (int(faces.max(initial=0)) + 1) + ends[:, 1]
    _, first, edge = np.unique(number, return_index=True, return_inverse=True)
    return ends[first], edge.reshape(-1), np.where(sides[:, 0] < sides[:, 1], 1, -1)


def _rim_edges(faces: Faces) -> Int[np.ndarray, "edge 2"]:
    """Directed edges that are used more often in one direction, once for each surplus use."""
    ends, edge, direction = mesh_edges(faces)
    net = np.bincount(edge, direction, minlength=len(ends)).astype(int)
    edges = np.repeat(ends, np.abs(net), axis=0)
    backwards = np.repeat(net < 0, np.abs(net))
    edges[backwards] = edges[backwards][:, ::-1]
    return edges


def agreeing(faces: Faces) -> Faces:
    """The triangles turned so that neighbours look to the same side.

    Each triangle stands twice in a graph, as it is and turned over; neighbours that agree are
    joined as they stand, others crosswise. So the triangles that agree with each other are one
    connected part of it.
    """
    ends, edge, direction = mesh_edges(faces)
    paired = np.bincount(edge, minlength=len(ends)) == 2
    if not (paired & (np.bincount(edge, direction, minlength=len(ends)) != 0)).any():
        return faces
    order = np.argsort(edge, kind="stable")
    first, second = order[paired[edge[order]]].reshape(-1, 2).T
    count = len(faces)
    a, b = first % count, second % count
    across = np.where(direction[first] == direction[second], count, 0)
    joined = np.stack([np.r_[a, a + count], np.r_[b + across, b + count - across]], axis=1)
    part = component_labels(2 * count, joined)
    turned = part[:count] > part[count:]
    return np.where(turned[:, None], faces[:, ::-1], faces)


def _joined(
    points: Points3, ends: Int[np.ndarray, "edge 2"], near: float
) -> Int[np.ndarray, " vertex"]:
    """For each vertex the first one along the rims that lies so near, else itself."""
    from scipy.spatial import cKDTree

    rim = np.unique(ends)
    pairs = cKDTree(points[rim]).query_pairs(near, output_type="ndarray")
    label = component_labels(len(rim), pairs)
    _, first = np.unique(label, return_index=True)
    to = np.arange(len(points))
    to[rim] = rim[first[label]]
    return to


def _loops(ends: Int[np.ndarray, "edge 2"]) -> Loops:
    """Directed edges as simple loops, each once round."""
    follow: dict[int, list[int]] = {}
    for a, b in ends.tolist():
        follow.setdefault(a, []).append(b)
    loops = []
    for start in list(follow):
        path, place = [start], {start: 0}
        while follow[path[-1]]:
            following = follow[path[-1]].pop()
            if following not in place:
                place[following] = len(path)
                path.append(following)
                continue
            # Wherever the path meets itself, a loop is closed.
            start_of_loop = place[following]
            loops.append(np.array(path[start_of_loop:]))
            for vertex in path[start_of_loop + 1 :]:
                del place[vertex]
            del path[start_of_loop + 1 :]
    return loops
