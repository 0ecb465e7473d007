"""The garment as cloth: the flat panels as triangle meshes, and how they are sewn.

Words of this file:

- A **corner** is a mesh vertex of one flat panel. Corners of panel k come in one block, the
  boundary first.
- A **vertex** is what corners become once sewn: corners that a stitch joins are the same vertex.
- **Rest** shape is the flat panel; cloth in the plane of its panel is without strain.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int

from garmentimage.pattern import Pattern, Side


@dataclass(frozen=True, eq=False)
class Cloth:
    """A garment as one sewn triangle mesh, each panel flat at rest."""

    pattern: Pattern
    flat: Float[np.ndarray, "corner 2"]
    """Rest position in the panel's own coordinates [cm]; also the texture coordinates."""
    faces: Int[np.ndarray, "face 3"]
    """Corners of each triangle, turning as the outer loop of its panel does, so that the outer
    face is the one seen from outside the body."""
    panel: Int[np.ndarray, " corner"]  # number of the corner's panel in `pattern.panels`
    vertex: Int[np.ndarray, " corner"]  # the vertex that the corner is sewn into
    sides: Mapping[Side, Int[np.ndarray, " _"]]
    """Corners along each edge of each panel, from its start to its end, both ends included."""
    folds: Int[np.ndarray, "fold 2"] = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    """Vertices at both ends of the sides of triangles along which pleats are pressed."""

    @cached_property
    def vertex_count(self) -> int:
        """Vertices once sewn."""
        return int(self.vertex.max()) + 1

    @cached_property
    def vertex_faces(self) -> Int[np.ndarray, "face 3"]:
        """The triangles between vertices, in the order of `faces`."""
        vertices: np.ndarray = self.vertex[self.faces]
        return vertices

    @cached_property
    def face_panel(self) -> Int[np.ndarray, " face"]:
        """Number of each triangle's panel."""
        panels: np.ndarray = self.panel[self.faces[:, 0]]
        return panels

    def sewn(self, corners: Float[np.ndarray, "corner 3"]) -> Float[np.ndarray, "vertex 3"]:
        """Positions of the vertices: the mean over the corners sewn into each [cm]."""
        count = np.bincount(self.vertex, minlength=self.vertex_count)
        return np.stack([np.bincount(self.vertex, c) for c in corners.T], axis=1) / count[:, None]
