"""What a solver needs to know of a cloth at rest, taken from the flat panels once.

An **edge** is a pair of vertices that sides of triangles join.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from garmentimage.body import mesh_edges
from garmentimage.drape.cloth import Cloth

STRAINED = 0.01  # share of the cloth whose stretch is ignored: corners, and where seams meet
GATHERED = 1.05
"""An edge whose two panels differ in length by more than this factor is gathered: it is as long as
the shorter side, and the longer one's cloth has to fold. Elsewhere it takes their mean."""


@dataclass(frozen=True, eq=False)
class Pressed:
    """What holds cloth that is pressed onto other cloth of its own, as pleats are."""

    vertices: Int[np.ndarray, " tie"]
    triangles: Int[np.ndarray, "tie 3"]
    """Vertices of the triangle over which each is held."""
    shares: Float[np.ndarray, "tie 3"]
    """Its place there as shares of their places."""
    heights: Float[np.ndarray, " tie"]
    """How far outward of the triangle; negative beneath it [cm]."""
    stiffness: Float[np.ndarray, " tie"]
    give: float
    """Of each tie [dyn/cm], and how far from its place it pulls with all its force [cm]."""
    raised: Float[np.ndarray, " vertex"]
    """How far every vertex is kept off the body for cloth that lies beneath it [cm]."""

    @classmethod
    def nothing(cls, count: int) -> "Pressed":
        """Nothing, of cloth with so many vertices."""
        none = np.zeros((0, 3))
        empty = np.zeros(0)
        return cls(empty.astype(int), none.astype(int), none, empty, empty, 0.0, np.zeros(count))

    def pull(self) -> Float[np.ndarray, " vertex"]:
        """The sum of stiffnesses that meet in each vertex [dyn/cm]."""
        ends = np.concatenate([self.vertices, self.triangles.ravel()])
        shares = np.concatenate([np.ones(len(self.vertices)), self.shares.ravel()])
        shares *= np.concatenate([self.stiffness, np.repeat(self.stiffness, 3)])
        return np.bincount(ends, shares, minlength=len(self.raised)).astype(float)


@dataclass(frozen=True, eq=False)
class Rest:
    """A cloth without strain. Lengths in cm, areas in cm²."""

    faces: Int[np.ndarray, "face 3"]  # vertices of each triangle, in the order of the cloth's faces
    edges: Int[np.ndarray, "edge 2"]  # vertices of each edge, the smaller number first; sorted
    length: Float[np.ndarray, " edge"]  # rest length of each edge
    area: Float[np.ndarray, " edge"]
    """Area of the triangles at each edge: a stretch stiffness is modulus x area / length²."""
    vertex_area: Float[np.ndarray, " vertex"]
    """Cloth that each vertex carries: a third of each triangle round it."""
    face_area: Float[np.ndarray, " face"]  # area of each triangle
    inverse: Float[np.ndarray, "face 2 2"]
    """Inverse of the matrix whose columns go from a flat triangle's first corner to the others."""
    folds: Int[np.ndarray, "fold 2"]  # ends of sides along which cloth is pressed to a fold
    pressed: Pressed | None = None

    def part(
        self, vertices: Int[np.ndarray, " n"], faces: Bool[np.ndarray, " face"] | None = None
    ) -> "Rest":
        """Only these vertices, in rising order, and the triangles whose corners are all of them.

        Of these only those that are marked in `faces`, where it is given.
        """
        number = np.full(len(self.vertex_area), -1)
        number[vertices] = np.arange(len(vertices))
        own_faces = (number[self.faces] >= 0).all(axis=1)
        if faces is not None:
            own_faces &= faces
        kept = number[self.faces[own_faces]]
        # An edge goes with its triangles.
        count = len(vertices)
        ends = number[self.edges]
        of_faces, _, _ = mesh_edges(kept)
        own_edges = (ends >= 0).all(axis=1)
        own_edges[own_edges] = np.isin(
            ends[own_edges] @ [count, 1], of_faces.astype(np.int64) @ [count, 1]
        )
        return Rest(
            faces=kept,
            edges=ends[own_edges],
            length=self.length[own_edges],
            area=self.area[own_edges],
            vertex_area=self.vertex_area[vertices],
            face_area=self.face_area[own_faces],
            inverse=self.inverse[own_faces],
            folds=number[self.folds][(number[self.folds] >= 0).all(axis=1)],
        )


def rest_of(cloth: Cloth) -> Rest:
    """Rest lengths, areas and matrices of a cloth."""
    faces = cloth.vertex_faces
    flat = cloth.flat[cloth.faces]
    # The matrix with columns u and v, its determinant and its inverse.
    u, v = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    doubled = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    inverse = np.stack([v[:, 1], -v[:, 0], -u[:, 1], u[:, 0]], axis=1) / doubled[:, None]
    face_area = np.abs(doubled) / 2
    edges, edge, _ = mesh_edges(faces)
    # In the order of `edge`: first sides of all triangles, then the second and the third.
    along = (flat[:, (1, 2, 0)] - flat).transpose(1, 0, 2).reshape(-1, 2)
    return Rest(
        faces=faces,
        edges=edges,
        length=_rest_length(edge, np.hypot(*along.T)),
        area=np.bincount(edge, np.tile(face_area, 3)),
        vertex_area=np.bincount(
            faces.ravel(), np.repeat(face_area / 3, 3), minlength=cloth.vertex_count
        ),
        face_area=face_area,
        inverse=inverse.reshape(-1, 2, 2),
        folds=cloth.folds,
    )


def strain(rest: Rest, points: Float[np.ndarray, "vertex 3"]) -> Float[np.ndarray, " face"]:
    """How much longer than at rest each triangle is in the direction that stretches most.

    0 at rest, 0.1 where a direction is 10 % longer; negative where all are shorter.
    """
    # The largest singular value of the deformation gradient F = (u v), less 1: that of F^T F is the
    # square of it, in closed form.
    x = points[rest.faces]
    first, second = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
    m = rest.inverse
    u = first * m[:, 0, 0, None] + second * m[:, 1, 0, None]
    v = first * m[:, 0, 1, None] + second * m[:, 1, 1, None]
    uu, vv, uv = ((a * b).sum(axis=1) for a, b in ((u, u), (v, v), (u, v)))
    stretch: np.ndarray = np.sqrt((uu + vv) / 2 + np.hypot((uu - vv) / 2, uv)) - 1
    return stretch


def peak_strain(rest: Rest, points: Float[np.ndarray, "vertex 3"]) -> float:
    """The stretch that all but `STRAINED` of the cloth keeps below.

    By area, not by number of triangles: those of narrow bands are small, so that their number
    would depend on how the cloth was cut into triangles.
    """
    stretch = strain(rest, points)
    order = np.argsort(-stretch, kind="stable")
    more = np.cumsum(rest.face_area[order])
    return float(stretch[order[np.searchsorted(more, STRAINED * more[-1])]])


def _rest_length(
    edge: Int[np.ndarray, " side"], length: Float[np.ndarray, " side"]
) -> Float[np.ndarray, " edge"]:
    """Mean length of each edge's sides; the least where they are gathered [cm]."""
    mean = np.bincount(edge, length) / np.bincount(edge)
    least, most = np.full(len(mean), np.inf), np.zeros(len(mean))
    np.minimum.at(least, edge, length)
    np.maximum.at(most, edge, length)
    return np.where(most > GATHERED * least, least, mean)
