"""The waistband: a straight band in two panels."""

from garmentimage.body import BodyMeasurements
from garmentimage.draft.assemble import Assembly
from garmentimage.draft.designs import WaistbandDesign
from garmentimage.draft.panel import (
    ALONG,
    BACK,
    FACINGS,
    FRONT,
    Outline,
    Seam,
    layer_depth,
    lines,
    on_side,
    other,
    placed,
    plus_side,
)


def add_waistband(
    garment: Assembly,
    body: BodyMeasurements,
    design: WaistbandDesign,
    below: dict[str, Seam],
    fullness: float = 1.0,
) -> None:
    """Sew a waistband to a skirt or to trousers.

    Args:
        garment: has the panels below.
        body: measurements.
        design: the band.
        below: upper edges of what hangs from it, by facing.
        fullness: how many times as long as the band they are.
    """
    if design.waistband == "none":
        return
    bands = {}
    for facing in FACINGS:
        half = garment.length(below[facing]) / fullness / 2
        depth, plus = design.waistband_depth, plus_side(facing)
        outline: Outline = (
            *lines("band_lower", (-half, 0.0), (half, 0.0)),
            *on_side(lines("band_end", (half, 0.0), (half, depth)), plus),
            *lines("band_upper", (half, depth), (-half, depth)),
            *on_side(lines("band_end", (-half, depth), (-half, 0.0)), other(plus)),
        )
        origin = (0.0, body.waist_height, layer_depth(body))
        bands[facing] = placed(f"waistband_{facing}", outline, facing, origin, grain=ALONG)
        garment.add(bands[facing])
        garment.sew(below[facing], bands[facing].seam("band_lower"), fullness=fullness)
    garment.sew_pairs(bands[FRONT], bands[BACK], "band_end")
