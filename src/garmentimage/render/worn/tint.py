"""Colours as users write them, and as light adds up: sRGB on screen, linear inside.

A **tint** is three numbers from 0 to 1 in sRGB, or a name or "#rrggbb". Light adds up only in
linear units (IEC 61966-2-1), so pictures are computed in those and encoded once at the end.
"""

from functools import cache

import numpy as np
from jaxtyping import Float, Float32, UInt8

from garmentimage.errors import RenderError, quoted
from garmentimage.render.worn._kernels_shade import encode_srgb

Tint = str | tuple[float, float, float]

_KNEE, _SLOPE, _OFFSET, _POWER = 0.04045, 12.92, 0.055, 2.4
"""The sRGB curve: linear up to the knee, a power beyond."""
_CODES = 8192
"""Entries of the table that encodes linear light; the square root taken before the look-up
spaces them so that no 8-bit level is skipped."""


def rgb(tint: Tint) -> Float[np.ndarray, " 3"]:
    """A tint as three sRGB numbers from 0 to 1.

    Raises:
        RenderError: it is not a colour.

    Example:
        >>> rgb("#ff0033").tolist()
        [1.0, 0.0, 0.2]
    """
    if isinstance(tint, str):
        from PIL import ImageColor

        try:
            levels: tuple[int, ...] = ImageColor.getrgb(tint)
        except ValueError:
            levels = ()
        if len(levels) != 3 or not all(0 <= level <= 255 for level in levels):
            raise RenderError(
                f"{quoted(tint)} is not a colour; write a name such as 'navy', or '#rrggbb'"
            )
        return np.array(levels) / 255
    values = np.asarray(tint, float)
    if values.shape != (3,) or not ((values >= 0) & (values <= 1)).all():
        raise RenderError(f"a colour is three numbers from 0 to 1, not {quoted(str(tint))}")
    return values


def linear(srgb: Float[np.ndarray, "*shape"]) -> Float32[np.ndarray, "*shape"]:
    """Linear light of sRGB numbers, both from 0 to 1."""
    srgb = np.asarray(srgb, float)
    curve = ((srgb + _OFFSET) / (1 + _OFFSET)) ** _POWER
    return np.where(srgb <= _KNEE, srgb / _SLOPE, curve).astype(np.float32)


def encoded(light: Float32[np.ndarray, "row col 3"]) -> UInt8[np.ndarray, "row col 3"]:
    """Linear light as 8-bit sRGB; more than 1 is white."""
    codes = np.empty(light.shape, np.uint8)
    encode_srgb(light, _table(), codes)
    return codes


@cache
def _table() -> UInt8[np.ndarray, " code"]:
    light = (np.arange(_CODES) / (_CODES - 1)) ** 2
    curve = (1 + _OFFSET) * light ** (1 / _POWER) - _OFFSET
    srgb = np.where(light <= _KNEE / _SLOPE, light * _SLOPE, curve)
    codes: np.ndarray = np.rint(255 * srgb).astype(np.uint8)
    return codes
