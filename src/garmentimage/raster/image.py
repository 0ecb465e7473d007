"""GarmentImage: a garment as layers of cells on a grid (paper, Section 3.1).

Row 0 is at the bottom, column 0 at the left of a picture of the front. The back layer is seen
through the body: the same column is the same place. Cell (row, col) has the lattice corners
(col, row) .. (col + 1, row + 1).
"""

from dataclasses import dataclass, field, replace
from enum import IntEnum

import numpy as np
from jaxtyping import Bool, Float32, Int8

from garmentimage.errors import ImageError
from garmentimage.pattern import Point, Vector
from garmentimage.raster.channel_kind import ChannelKind, resolve_channel_kind
from garmentimage.raster.channels import (
    CONTRACT_1,
    CONTRACTS,
    MAX_LAYERS,
    Contract,
    check_channels,
    join_channels,
    one_hot,
    split_channels,
)
from garmentimage.raster.frame import BodyFrame


class EdgeType(IntEnum):
    """Type of a grid edge (paper, Section 3.1.3)."""

    NON_BOUNDARY = 0
    """Wholly inside a panel, or wholly outside."""
    NON_STITCH = 1
    """On the boundary of a panel, not sewn."""
    FRONT_TO_BACK = 2
    """Sewn to the grid edge at the same place of the opposite layer."""
    SIDE_BY_SIDE = 3
    """Sewn to the neighbouring cell of the same layer."""
    WRAP = 4
    """No seam: the cloth goes on, round the body, at the same place of the opposite layer."""
    SHEET = 5
    """Sewn to cloth of the other sheet: to the neighbouring cell on the same face of the body, else
    to the same place of the opposite face."""
    ONTO = 6
    """On the boundary of a panel of the outer sheet: sewn onto the cloth beneath it."""
    CREASE = 7
    """Inside a panel: a fold of a pressed pleat that is seen; the cloth goes on (the paper's future
    work calls it a tuck)."""


BOTTOM, LEFT = 0, 1
"""Second index of `edge_type`: a cell stores its bottom and its left grid edge."""

Division = tuple[int, int, int, tuple[float, ...]]
"""(row, column) of a cell, its side (0 bottom, 1 right, 2 top, 3 left), and the shares of that grid
edge, from its left or lower end, at which vertices lie inside an edge of the panel."""


@dataclass(frozen=True)
class PanelMark:
    """What the channels cannot say of a panel: its name and its own frame; no geometry."""

    name: str
    layer: int
    cell: tuple[int, int]
    """(row, column) of one cell of the panel."""
    matrix: tuple[Point, Point] = ((1.0, 0.0), (0.0, 1.0))
    """2 x 2 orthogonal, rows: raster frame = matrix @ panel frame."""
    anchor: Point = (0.0, 0.0)
    """The panel's centroid in the panel's own frame [cm]."""
    rotation: Vector | None = None
    """The panel's own placement, degrees; None where unknown."""
    translation: Vector | None = None
    """The panel's own placement [cm]; None where unknown."""
    split_of: str | None = None
    """Name of the panel that this one is a part of: decoding sews and joins the parts again."""
    label: str | None = None
    grain: Point | None = None
    """Unit direction of the warp in the panel's own frame."""
    divisions: tuple[Division, ...] = ()
    """Vertices of a traced outline, where the raster has one edge: decoding puts them back."""


_NOWHERE = np.zeros((0, 0, 0), bool)  # stands for flags that are all False


@dataclass(frozen=True)
class GarmentImage:
    """A garment on a grid: flags, edge types, deformation."""

    inside: Bool[np.ndarray, "layer row col"]
    edge_type: Int8[np.ndarray, "layer 2 row col"]
    """`EdgeType` of the bottom and left grid edge of each cell."""
    deformation: Float32[np.ndarray, "layer 4 2 row col"]
    """(dx, dy) of the bottom, right, top and left edge vectors of each cell [cm], 0 outside. Bottom
    and top point right, left and right point up."""
    frame: BodyFrame
    layer_names: tuple[str, ...] = ("front", "back")
    marks: tuple[PanelMark, ...] = ()
    name: str = field(default="", compare=False)
    turned: Bool[np.ndarray, "layer row col"] = field(default_factory=lambda: _NOWHERE)
    """The wrong side of the cloth is out, as drawn: a collar or lapel laid open. Default: nowhere.
    False outside."""

    def __post_init__(self) -> None:
        layers = len(self.inside)
        grid = self.frame.grid
        if self.turned is _NOWHERE:
            object.__setattr__(self, "turned", np.zeros_like(self.inside))
        arrays = (self.inside, self.turned, self.edge_type, self.deformation)
        shapes = tuple(array.shape for array in arrays)
        flag = (layers, grid, grid)
        wanted = (flag, flag, (layers, 2, grid, grid), (layers, 4, 2, grid, grid))
        if shapes != wanted:
            raise ImageError(f"arrays have shapes {shapes}; a {grid} x {grid} image needs {wanted}")
        if len(self.layer_names) != layers:
            raise ImageError(f"{layers} layers but {len(self.layer_names)} layer names")

    @property
    def grid(self) -> int:
        """Cells along each side, N."""
        return self.frame.grid

    @property
    def layers(self) -> int:
        """Number of layers."""
        return len(self.inside)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GarmentImage):
            return NotImplemented
        return (
            self.same_channels(other)
            and self.frame == other.frame
            and self.layer_names == other.layer_names
            and self.marks == other.marks
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        size = f"{self.grid} x {self.grid}, {self.layers} layers"
        return f"GarmentImage({self.name!r}, {size}, {int(self.inside.sum())} cells inside)"

    def same_channels(self, other: "GarmentImage") -> bool:
        """Equal in flags, edge types and deformation, whatever the metadata."""
        return (
            np.array_equal(self.inside, other.inside)
            and np.array_equal(self.turned, other.turned)
            and np.array_equal(self.edge_type, other.edge_type)
            and np.array_equal(self.deformation, other.deformation)
        )

    def without_marks(self) -> "GarmentImage":
        """The same image with all that is not in the channels forgotten."""
        return replace(self, marks=(), name="", frame=BodyFrame.standard(self.grid))

    @property
    def contract(self) -> Contract:
        """The smallest channel contract that holds it: 1 where nothing wraps, is turned or is sewn
        to another sheet.
        """
        plain = self.edge_type.max(initial=0) < CONTRACT_1.edge_type_count
        return 1 if plain and not self.turned.any() else 2

    def cut_at_wraps(self) -> "GarmentImage":
        """The image with a seam wherever cloth wraps round: such panels are two, front and back.

        It is how contract 1 has them.
        """
        wraps = self.edge_type == EdgeType.WRAP
        types = np.where(wraps, EdgeType.FRONT_TO_BACK, self.edge_type).astype(np.int8)
        return replace(self, edge_type=types)

    def to_channels(
        self, contract: Contract | None = None, *, layers: int | None = None
    ) -> Float32[np.ndarray, "channel row col"]:
        """The network's view: 17 channels a layer in contract 1, 26 in contract 2, front first.

        Inside flag; in contract 2, turned flag; bottom edge one-hot (in the order of `EdgeType`);
        left edge one-hot, same order; (dx, dy) of bottom, right, top, left edge vectors [cm].

        Args:
            contract: which of the two; default: `GarmentImage.contract`.
            layers: how many the array has, default: those of the image; more are empty. With
                contract 2 and 4 layers, arrays of all garments are alike in shape.

        Raises:
            ImageError: contract 1 does not hold the image, there is no such contract, or the image
                has more layers.
        """
        chosen = self.contract if contract is None else contract
        if chosen not in CONTRACTS:
            raise ImageError(f"no channel contract {chosen!r}; there are 1 and 2")
        if chosen < self.contract:
            remedy = "choose contract 2"
            if self.turned.any():
                what = "panels that are turned"
            elif np.isin(self.edge_type, (EdgeType.SHEET, EdgeType.ONTO)).any():
                what = "seams between sheets of cloth"
            elif (self.edge_type == EdgeType.CREASE).any():
                what = "creases"
            else:
                what = "panels that wrap round"
                remedy += ", or cut them first: image.cut_at_wraps()"
            raise ImageError(f"contract 1 has no channels for {what}; {remedy}")
        types = one_hot(self.edge_type, CONTRACTS[chosen].edge_type_count)
        turned = self.turned if chosen == 2 else None
        joined = join_channels(self.inside, types, self.deformation, turned).astype(np.float32)
        if layers is None or layers == self.layers:
            return joined
        if not self.layers < layers <= MAX_LAYERS:
            raise ImageError(
                f"the image has {self.layers} layers; an array of {layers} does not hold it (at "
                f"most {MAX_LAYERS})"
            )
        nothing = np.zeros((layers - self.layers, self.grid, self.grid), bool)
        none = one_hot(np.zeros((len(nothing), 2, *nothing.shape[1:]), np.int8), types.shape[2])
        vectors = np.zeros((len(nothing), *self.deformation.shape[1:]), np.float32)
        empty = join_channels(nothing, none, vectors, nothing if chosen == 2 else None)
        return np.concatenate([joined, empty.astype(np.float32)])

    @classmethod
    def from_channels(
        cls,
        array: np.ndarray,
        like: "GarmentImage | None" = None,
        *,
        kind: ChannelKind | None = None,
    ) -> "GarmentImage":
        """The image that `to_channels` would give `array` for; hard decisions, no repair.

        A cell is inside where its flag is over 0.5, of logits over 0, and turned likewise; of a
        grid edge's types the largest counts; deformation outside is cleared. It is the image that
        `decode` starts from.

        Args:
            array: [17 L, N, N] or [L, 17, N, N], or so with 26 (contract 2), any real type.
            like: where frame, layer names and marks come from; default: the standard frame.
            kind: what the numbers of flags and types are; default: judged by all of them together.

        Raises:
            ImageError: a wrong shape, values that are not finite, or no such kind.
        """
        parts = split_channels(check_channels(array))
        flags, types, vectors, _ = parts
        layers, grid = len(flags), flags.shape[-1]
        threshold = 0.0 if resolve_channel_kind(parts, kind) == "logits" else 0.5
        inside = flags > threshold
        has_turned = parts.turned is not None
        turned = inside & (parts.turned > threshold) if has_turned else np.zeros_like(inside)
        edge_type = types.argmax(axis=2).astype(np.int8)
        deformation = np.where(inside[:, None, None], vectors, 0.0).astype(np.float32)
        if like is None:
            names = default_layer_names(layers)
            frame = BodyFrame.standard(grid)
            return cls(inside, edge_type, deformation, frame, names, turned=turned)
        if (like.grid, like.layers) != (grid, layers):
            raise ImageError(
                f"`like` has {like.layers} layers of {like.grid} cells, "
                f"the array {layers} of {grid}"
            )
        return replace(
            like, inside=inside, edge_type=edge_type, deformation=deformation, turned=turned
        )


def default_layer_names(layers: int) -> tuple[str, ...]:
    """front, back, then numbered pairs for further cloth layers."""
    return tuple(
        ("front", "back")[k % 2] + ("" if k < 2 else f"-{k // 2 + 1}") for k in range(layers)
    )


def mirrored_channels(
    channels: Float32[np.ndarray, "n channel row col"],
) -> Float32[np.ndarray, "n channel row col"]:
    """Images as `to_channels` gives them, or probabilities, with left and right exchanged.

    The left edge of a cell is the right one of its mirror image; beyond the last column there is
    none, and the first column's stands in for it.
    """
    flags, types, vectors, turned = split_channels(channels[..., ::-1])
    left = types[:, :, LEFT]
    left = np.concatenate([left[..., :1], left[..., :-1]], axis=-1)
    edges = vectors[:, :, [0, 3, 2, 1]]
    across, upright = np.array([1, -1], np.float32), np.array([-1, 1], np.float32)
    edges = edges * np.stack([across, upright, across, upright])[:, :, None, None]
    return join_channels(flags, np.stack([types[:, :, BOTTOM], left], axis=2), edges, turned)
