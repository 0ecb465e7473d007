"""Data augmentation at the waist: garments with halves of two others, and cloth in other colours.

Waist mix (in the family of CutMix, Yun et al. 2019; not in the paper): all GarmentImages stand on
one grid, and all images of a recipe show one body, so both can be cut at the waist, the images
along the seam, so that no trace shows which garments were mixed. Where one garment has a waist seam
and another is as many cells wide there, the upper half of either, sewn to the lower half of the
other, is a garment again: the bodice of a dress above the legs of a top with trousers. So networks
do not learn that parts go together only as in the training set, and recolouring keeps them from
inferring kinds from colours.
"""

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from garmentimage.learn.data.images import ImagedGarments
from garmentimage.learn.data.rasters import LAYERS
from garmentimage.raster import EdgeType

WAIST_LINES = 0.5, 0.5625
"""Grid lines on which waist seams lie, as shares of the grid's height from below."""
MIN_CELLS = 2
"""Fewest cells of cloth in each layer along a waist seam."""
MAX_GAMMA = 0.9
"""Recoloured values are the old ones to the power of exp(-MAX_GAMMA) to exp(MAX_GAMMA), ..."""
MAX_TINT = 1.6
"""... times exp(-MAX_TINT) to 1 in each channel."""


def mix_at_waist(batch: ImagedGarments, share: float) -> tuple[ImagedGarments, Bool[Tensor, " n"]]:
    """A batch in which some garments have the upper or the lower half of another.

    A taker keeps one half and gets the other from a giver. The giver has a waist seam, and the
    taker's kept half has cloth in the same cells there; among all pairs that fit, one is drawn
    uniformly for each taker.

    Args:
        batch: garments with their images.
        share: of the garments that get another half, where one fits.

    Returns:
        The batch, and which of its garments are mixed.
    """
    count, grid = len(batch), batch.inside.shape[-1]
    device = batch.inside.device
    chosen = torch.rand(count, device=device) < share
    takes_upper = torch.rand(count, device=device) < 0.5
    lines = [round(height * grid) for height in WAIST_LINES]
    sewn = torch.stack([_is_sewn(batch, line) for line in lines])
    fits = torch.stack([_fitting(batch, line, takes_upper) for line in lines])
    # A taker with a seam at another line would keep it beside the new one.
    can_take = ~(sewn.sum(0) > sewn)
    is_other = ~torch.eye(count, dtype=torch.bool, device=device)
    # The seams of both must lie at one height in the images.
    height = batch.waist.float().median(1).values
    level = (height[:, None] == height) | ~sewn[:, :, None]
    pairs = fits & sewn[:, None] & can_take[:, :, None] & level & is_other  # line, taker, giver
    # The largest of uniform random numbers is at any pair with equal probability.
    keys = torch.rand(pairs.shape, device=device) * pairs
    best, which = keys.permute(1, 0, 2).flatten(1).max(1)
    is_mixed = chosen & (best > 0)
    giver = which % count
    line = torch.tensor(lines, device=device)[which // count]
    return _mixed(batch, giver, line, takes_upper, is_mixed), is_mixed


def _is_sewn(batch: ImagedGarments, line: int) -> Bool[Tensor, " n"]:
    """Which garments have a seam along a whole line of the grid, front and back."""
    above, below = (_cells(batch, row) for row in (line, line - 1))
    seam = (batch.types[:, ::2, line] == EdgeType.SIDE_BY_SIDE).flatten(1)
    wide: Tensor = (above.unflatten(1, (LAYERS, -1)).sum(2) >= MIN_CELLS).all(1)
    return (above == below).all(1) & (seam == above).all(1) & wide


def _fitting(
    batch: ImagedGarments, line: int, takes_upper: Bool[Tensor, " n"]
) -> Bool[Tensor, "taker giver"]:
    """Whether the half a taker keeps has cloth in the cells of a giver's half at a line."""
    above, below = (_cells(batch, row) for row in (line, line - 1))
    kept = torch.where(takes_upper[:, None], below, above)
    return (kept[:, None] == above[None]).all(2)


def _cells(batch: ImagedGarments, row: int) -> Bool[Tensor, "n column"]:
    """Cells of cloth in a row of the grid, front, then back."""
    return (batch.inside[:, :, row] > 0).flatten(1)


def _mixed(
    batch: ImagedGarments,
    giver: Int[Tensor, " n"],
    line: Int[Tensor, " n"],
    takes_upper: Bool[Tensor, " n"],
    is_mixed: Bool[Tensor, " n"],
) -> ImagedGarments:
    """The batch with halves of the givers in the mixed garments."""
    grid, pixels = batch.inside.shape[-1], batch.pictures.shape[-1]
    given = batch.batch(giver)
    rows = torch.arange(grid, device=line.device)
    is_upper = rows >= line[:, None]
    from_giver = (is_upper == takes_upper[:, None])[:, None, :, None]
    is_above = torch.arange(pixels, device=line.device)[:, None] >= given.waist[:, None]
    pixels_from_giver = (is_above == takes_upper[:, None, None])[:, None]
    # The bottom grid edges of the row above the line are the seam, which is always the giver's.
    seam = (rows == line[:, None])[:, None, :, None]
    bottom = torch.arange(2 * LAYERS, device=line.device)[:, None, None] % 2 == 0
    mixed = is_mixed[:, None, None, None]
    shown, taken = mixed & pixels_from_giver, mixed & from_giver
    return ImagedGarments(
        torch.where(shown, given.pictures, batch.pictures),
        torch.where(shown[:, 0], given.cloth, batch.cloth),
        torch.where(is_mixed[:, None], given.waist, batch.waist),
        torch.where(taken, given.inside, batch.inside),
        torch.where(taken | (mixed & seam & bottom), given.types, batch.types),
        torch.where(taken, given.vectors, batch.vectors),
    )


def recolour_cloth(
    batch: ImagedGarments, is_mixed: Bool[Tensor, " n"], share: float
) -> Float[Tensor, "n 3 pixel_row pixel_col"]:
    """Images with cloth in other colours; mixed garments get two, above and below the waist.

    Channels are permuted, made lighter or darker, and tinted. Otherwise colours would reveal kinds:
    brown is trousers where no skirt is brown.

    Args:
        batch: the garments.
        is_mixed: garments from `mix_at_waist`; all of them are recoloured.
        share: of the others that are recoloured.
    """
    images, device = batch.images(), is_mixed.device
    some = torch.where(is_mixed | (torch.rand(len(is_mixed), device=device) < share))[0]
    chosen, is_two = images[some], is_mixed[some]
    recoloured = _in_other_colours(chosen)
    rows = torch.arange(images.shape[-2], device=device)[:, None]
    below = (rows < batch.waist[some[is_two], None])[:, None]
    recoloured[is_two] = torch.where(below, _in_other_colours(chosen[is_two]), recoloured[is_two])
    cloth = batch.cloth[some, None]
    return images.index_copy(0, some, torch.where(cloth, recoloured, chosen))


def _in_other_colours(
    images: Float[Tensor, "n 3 pixel_row pixel_col"],
) -> Float[Tensor, "n 3 pixel_row pixel_col"]:
    count, device = len(images), images.device
    order = torch.rand(count, 3, device=device).argsort(1)[..., None, None]
    power = ((2 * torch.rand(count, 1, 1, 1, device=device) - 1) * MAX_GAMMA).exp()
    tint = (-MAX_TINT * torch.rand(count, 3, 1, 1, device=device)).exp()
    return images.gather(1, order.expand_as(images)).clamp(min=1e-4) ** power * tint
