"""New garments from two of a batch: one above the waist, another below, sewn to each other.

All GarmentImages stand on one grid, and all pictures of a recipe on one body, so both can be cut
at the waist: pictures along the seam, so that nothing in them tells which were joined. Where one
garment has a waist seam and another is as many cells wide there, the upper half of either, sewn to
the lower half of the other, is a garment again: the bodice of a dress above the legs of a top with
trousers. Networks that are taught with such garments do not take it for granted that parts go
together only as they did in training; cloth in other colours keeps them from telling kinds by
colour. (Not in the paper.)
"""

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from garmentimage.learn.data.images import Pictured
from garmentimage.learn.data.rasters import LAYERS
from garmentimage.raster import EdgeType

LINES = 0.5, 0.5625
"""Grid lines that waist seams are on, as shares of the grid's height from below."""
LEAST_CELLS = 2
"""In each layer, at the waist."""
DARKER = 0.9
"""Colours shown anew are the old ones to the power of 1 / e^DARKER to e^DARKER."""
TINT = 1.6
"""And times 1 / e^TINT to 1, in each channel."""


def recombined(batch: Pictured, share: float) -> tuple[Pictured, Bool[Tensor, " n"]]:
    """A batch in which some garments have the upper or the lower half of another.

    Args:
        batch: garments with their pictures.
        share: of the garments that get another half, where there is one that fits.

    Returns:
        The batch, and which of them are new.
    """
    count, grid = len(batch), batch.inside.shape[-1]
    device = batch.inside.device
    chosen = torch.rand(count, device=device) < share
    takes_upper = torch.rand(count, device=device) < 0.5
    lines = [round(height * grid) for height in LINES]
    sewn = torch.stack([_is_sewn(batch, line) for line in lines])
    alike = torch.stack([_fitting(batch, line, takes_upper) for line in lines])
    # One that is sewn at another line would keep that seam beside the new one.
    takes = ~(sewn.sum(0) > sewn)
    other = ~torch.eye(count, dtype=torch.bool, device=device)
    # The seams of both must lie at one height in the pictures.
    height = batch.waist.float().median(1).values
    level = (height[:, None] == height) | ~sewn[:, :, None]
    fit = alike & sewn[:, None] & takes[:, :, None] & level & other  # line, taker, giver
    likely = torch.rand(fit.shape, device=device) * fit
    best, which = likely.permute(1, 0, 2).flatten(1).max(1)
    new = chosen & (best > 0)
    giver = which % count
    line = torch.tensor(lines, device=device)[which // count]
    return _joined(batch, giver, line, takes_upper, new), new


def _is_sewn(batch: Pictured, line: int) -> Bool[Tensor, " n"]:
    """Which garments have a seam along a whole line of the grid, in front and behind."""
    above, below = (_cells(batch, row) for row in (line, line - 1))
    seam = (batch.types[:, ::2, line] == EdgeType.SIDE_BY_SIDE).flatten(1)
    wide = (above.unflatten(1, (LAYERS, -1)).sum(2) >= LEAST_CELLS).all(1)
    return (above == below).all(1) & (seam == above).all(1) & wide


def _fitting(
    batch: Pictured, line: int, takes_upper: Bool[Tensor, " n"]
) -> Bool[Tensor, "taker giver"]:
    """Whether what a garment keeps is as wide at a line as another that is sewn there."""
    above, below = (_cells(batch, row) for row in (line, line - 1))
    stays = torch.where(takes_upper[:, None], below, above)
    return (stays[:, None] == above[None]).all(2)


def _cells(batch: Pictured, row: int) -> Bool[Tensor, "n column"]:
    """Cells with cloth in a row of the grid, front, then back."""
    return (batch.inside[:, :, row] > 0).flatten(1)


def _joined(
    batch: Pictured,
    giver: Int[Tensor, " n"],
    line: Int[Tensor, " n"],
    takes_upper: Bool[Tensor, " n"],
    new: Bool[Tensor, " n"],
) -> Pictured:
    grid, pixels = batch.inside.shape[-1], batch.pictures.shape[-1]
    given = batch.batch(giver)
    rows = torch.arange(grid, device=line.device)
    is_upper = rows >= line[:, None]
    taken = (is_upper == takes_upper[:, None])[:, None, :, None]
    seen = torch.arange(pixels, device=line.device)[:, None] >= given.waist[:, None]
    shown = (seen == takes_upper[:, None, None])[:, None]
    # The bottom edges of the row above the line are the seam: always of the giver.
    seam = (rows == line[:, None])[:, None, :, None]
    bottom = torch.arange(2 * LAYERS, device=line.device)[:, None, None] % 2 == 0
    one = new[:, None, None, None]
    return Pictured(
        torch.where(one & shown, given.pictures, batch.pictures),
        torch.where((one & shown)[:, 0], given.cloth, batch.cloth),
        torch.where(new[:, None], given.waist, batch.waist),
        torch.where(one & taken, given.inside, batch.inside),
        torch.where(one & (taken | (seam & bottom)), given.types, batch.types),
        torch.where(one & taken, given.vectors, batch.vectors),
    )


def repainted(
    batch: Pictured, new: Bool[Tensor, " n"], share: float
) -> Float[Tensor, "n 3 pixel_row pixel_col"]:
    """Pictures with cloth in other colours, that of new garments in two, above and below the waist.

    Channels are exchanged, made lighter or darker, and tinted. Else colours would tell what goes
    with what: brown is trousers, where no skirt was brown.

    Args:
        batch: the garments.
        new: which of them are joined from two; all of these have other colours.
        share: of the rest that have.
    """
    seen = batch.seen()
    some = torch.where(new | (torch.rand(len(new), device=new.device) < share))[0]
    here, joined = seen[some], new[some]
    other = _in_other_colours(here)
    rows = torch.arange(seen.shape[-2], device=new.device)[:, None]
    below = (rows < batch.waist[some[joined], None])[:, None]
    other[joined] = torch.where(below, _in_other_colours(here[joined]), other[joined])
    return seen.index_copy(0, some, torch.where(batch.cloth[some, None], other, here))


def _in_other_colours(
    seen: Float[Tensor, "n 3 pixel_row pixel_col"],
) -> Float[Tensor, "n 3 pixel_row pixel_col"]:
    count, device = len(seen), seen.device
    order = torch.rand(count, 3, device=device).argsort(1)[..., None, None]
    power = ((2 * torch.rand(count, 1, 1, 1, device=device) - 1) * DARKER).exp()
    tint = (-TINT * torch.rand(count, 3, 1, 1, device=device)).exp()
    return seen.gather(1, order.expand_as(seen)).clamp(min=1e-4) ** power * tint
