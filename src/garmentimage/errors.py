"""Every error that a user can cause, as one tree.

    GarmentImageError
    ├── PatternError            a sewing pattern that cannot be what it says (ValueError)
    │   ├── PatternFileError    a file that is not a readable sewing pattern
    │   └── StitchError         a stitch that names nothing, or the wrong thing
    ├── ImageError              a raster that is not a GarmentImage (ValueError)
    ├── EncodeError             a pattern that does not fit the raster (ValueError)
    ├── DecodeError             a raster that no garment can be read from (ValueError)
    ├── DraftError              a body or a design that no garment can be drafted from (ValueError)
    ├── DrapeError              a garment that the body cannot wear, or a bad drape (ValueError)
    ├── RenderError             a picture that cannot be made as requested (ValueError)
    ├── DatasetError            a recipe, or a dataset that cannot be built or read (ValueError)
    ├── LearnError              an invalid training run, network or latent vector (ValueError)
    └── OutputError             a result that cannot be written where it should go (OSError)

Each message is one sentence or two: what is wrong, where (file, panel, edge), and a remedy.
"""

from typing import Literal

Remedy = Literal["grid", "either", "pattern"]
"""What may help where a pattern cannot be encoded: a finer grid, another pattern, or either."""


class GarmentImageError(Exception):
    """Root of everything that garmentimage raises on purpose."""


class PatternError(GarmentImageError, ValueError):
    """A sewing pattern that cannot be sewn as it stands."""


class PatternFileError(PatternError):
    """A file that is not a sewing pattern we can read."""


class StitchError(PatternError):
    """A stitch that does not join two edges of the pattern."""


class ImageError(GarmentImageError, ValueError):
    """An array or a file that is not a GarmentImage."""


class EncodeError(GarmentImageError, ValueError):
    """A pattern that cannot be drawn on the grid.

    `grid` is the smallest grid size that was found to work, or None if none was. `remedy` says
    what may help: no grid is tried for what only another pattern can mend.
    """

    def __init__(self, message: str, *, grid: int | None = None, remedy: Remedy = "grid") -> None:
        super().__init__(message)
        self.grid = grid
        self.remedy: Remedy = remedy


class DecodeError(GarmentImageError, ValueError):
    """An image from which no garment can be read."""


class DraftError(GarmentImageError, ValueError):
    """A body or a design that no garment can be drafted from."""


class DrapeError(GarmentImageError, ValueError):
    """A garment that cannot be worn by the body, or a drape that went wrong."""


class RenderError(GarmentImageError, ValueError):
    """A picture that cannot be made as requested."""


class DatasetError(GarmentImageError, ValueError):
    """An invalid recipe, or a dataset that cannot be built or read."""


class LearnError(GarmentImageError, ValueError):
    """An invalid training run, network or latent vector."""


class OutputError(GarmentImageError, OSError):
    """A result that cannot be written to the given path."""


class PatternWarning(UserWarning):
    """Something in a pattern that was repaired, or that its maker should look at."""


def check_type(value: object, wanted: type, remedy: str) -> None:
    """Refuse an argument of another type with a TypeError that says what to give instead."""
    if not isinstance(value, wanted):
        raise TypeError(
            f"wanted a {wanted.__name__}, not a value of type {type(value).__name__}; {remedy}"
        )


MAX_SHOWN_NAME = 40
"""Characters of a name that a message shows."""


def quoted(name: str) -> str:
    """A name from a file, fit for one line of a message: in quotes, escaped, shortened."""
    if len(name) > MAX_SHOWN_NAME:
        name = name[: MAX_SHOWN_NAME - 1] + "…"
    return repr(name)
