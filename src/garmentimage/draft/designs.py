"""What can be chosen about each part of a garment: its parameters with ranges and units.

They import neither geometry nor numpy, so that `garmentimage draft KIND --help` is quick.
"""

from dataclasses import dataclass

from garmentimage.draft.parameters import choice, parameter

WAIST_DARTS = {"none": 0, "waist": 1, "side": 0, "waist-and-side": 1, "two-waist": 2}
"""Darts in the lower edge of each half."""


@dataclass(frozen=True)
class BodiceDesign:
    """Width and length of the trunk."""

    bust_ease: float = parameter(8.0, 2.0, 24.0, "cm", "room at the bust, all round")
    waist_shaping: float = parameter(
        0.5, 0.0, 1.0, "share", "how far the side seam follows the waist: 0 straight, 1 close"
    )
    armhole_ease: float = parameter(2.0, 0.0, 6.0, "cm", "how far the armhole lies below the arm")
    shoulder_reach: float = parameter(
        1.0, 0.8, 1.15, "shoulder length", "where the armhole meets the shoulder; above 1 it drops"
    )
    body_length: float = parameter(18.0, -4.0, 30.0, "cm", "from the waist down to the hem")
    panels_a_side: int = choice(1, (1, 2), "panels of front and of back; two have a centre seam")


@dataclass(frozen=True)
class NeckDesign:
    """The neckline."""

    neckline: str = choice("round", ("round", "v", "square", "boat"), "shape of the front neckline")
    neck_width: float = parameter(
        3.0, 1.0, 5.0, "cm", "how far the neckline lies from the neck along the shoulder"
    )
    neck_depth: float = parameter(
        11.0, 9.0, 18.0, "cm", "from the shoulder down to the front neckline"
    )
    back_neck_depth: float = parameter(
        3.0, 2.0, 8.0, "cm", "from the shoulder down to the back neckline"
    )


@dataclass(frozen=True)
class HemDesign:
    """The lower edge of a dress, a top or a skirt."""

    flare: float = parameter(
        0.15, 0.0, 0.5, "cm per cm", "how much wider each side gets on the way down from the hip"
    )
    hem_slant: float = parameter(
        0.0, -10.0, 10.0, "cm", "how much lower the hem hangs on the left, and higher on the right"
    )


@dataclass(frozen=True)
class DartDesign:
    """Darts of each half of the bodice."""

    front_darts: str = choice("waist", tuple(WAIST_DARTS), "darts of each front half")
    back_darts: str = choice("none", ("none", "waist"), "darts of each back half")
    dart_place: float = parameter(
        0.4, 0.3, 0.5, "half width", "from the middle to the first waist dart"
    )
    dart_width: float = parameter(2.0, 1.0, 3.0, "cm", "mouth of each waist dart")
    dart_reach: float = parameter(
        0.7, 0.4, 0.9, "way to the bust", "how high waist darts end above the lower edge"
    )
    side_dart_place: float = parameter(
        0.3, 0.15, 0.5, "side seam", "from the armpit down to the side dart"
    )
    side_dart_width: float = parameter(2.5, 1.5, 4.0, "cm", "mouth of the side dart")
    side_dart_reach: float = parameter(
        0.7, 0.4, 0.9, "way to the bust", "how far the side dart reaches in"
    )

    @property
    def intake(self) -> float:
        """The most that waist darts take out of one half [cm]."""
        most = max(WAIST_DARTS[self.front_darts], WAIST_DARTS[self.back_darts])
        return most * self.dart_width

    @property
    def has_side_dart(self) -> bool:
        """Whether a dart opens in the front side seam."""
        return self.front_darts in ("side", "waist-and-side")


@dataclass(frozen=True)
class CutoutDesign:
    """An oval hole in the middle of a panel."""

    cutout: str = choice("none", ("none", "front", "back"), "panel with a hole in it")
    cutout_width: float = parameter(9.0, 7.0, 13.0, "cm", "width of the hole")
    cutout_height: float = parameter(9.0, 7.0, 13.0, "cm", "height of the hole")
    cutout_place: float = parameter(
        0.45, 0.3, 0.6, "way to the neck", "from the waist up to the middle of the hole"
    )


@dataclass(frozen=True)
class SleeveDesign:
    """Set-in sleeves."""

    sleeves: str = choice("set-in", ("none", "set-in"), "with sleeves or without")
    sleeve_length: float = parameter(
        0.9, 0.4, 1.05, "arm length", "from the shoulder to the end of the sleeve"
    )
    cap_height: float = parameter(
        0.5, 0.3, 0.6, "half the armhole", "how far the cap rises over the underarm"
    )
    cap_fullness: float = parameter(
        1.0, 1.0, 1.4, "armhole", "length of the cap; above 1 it is gathered"
    )
    sleeve_taper: float = parameter(
        0.6, -0.2, 1.0, "share", "1 is close to the arm, 0 straight, less flares like a bell"
    )


@dataclass(frozen=True)
class CuffDesign:
    """Cuffs of their own at the ends of the sleeves."""

    cuffs: str = choice("none", ("none", "band", "turned-up"), "none, a band, or turned up")
    cuff_depth: float = parameter(6.0, 4.0, 10.0, "cm", "along the arm")
    cuff_fullness: float = parameter(
        1.2, 1.0, 1.8, "cuff", "width of the sleeve where it joins the band; above 1 it is gathered"
    )


@dataclass(frozen=True)
class HoodDesign:
    """A hood."""

    hood_height: float = parameter(
        0.62, 0.56, 0.72, "head girth", "from the neck edge to the highest point"
    )
    hood_room: float = parameter(
        3.0, 1.0, 7.0, "cm", "how far the hood stands out behind the neck edge"
    )


@dataclass(frozen=True)
class SkirtDesign:
    """A skirt that hangs from the waist."""

    gores: int = choice(2, (2, 4, 6, 8), "number of panels")
    skirt_length: float = parameter(0.55, 0.35, 0.9, "waist height", "from the waist to the hem")
    skirt_flare: float = parameter(
        0.2, 0.0, 0.5, "cm per cm", "how much wider each side gets on the way down from the hip"
    )
    skirt_fullness: float = parameter(
        1.0, 1.0, 2.0, "waist", "width of its top; above 1 it is gathered"
    )
    skirt_slant: float = parameter(
        0.0, -12.0, 12.0, "cm", "how much lower the hem hangs on the left, and higher on the right"
    )


@dataclass(frozen=True)
class TrousersDesign:
    """The legs of trousers, shorts and jumpsuits."""

    leg_length: float = parameter(
        1.0,
        0.15,
        1.05,
        "inside leg",
        "from the crotch to the hem: 0.15 are shorts, 1 reaches the ankle",
    )
    hip_ease: float = parameter(6.0, 3.0, 16.0, "cm", "room at the hip, all round")
    knee_ease: float = parameter(8.0, 3.0, 16.0, "cm", "room at the knee, all round")
    leg_flare: float = parameter(
        0.0, -4.0, 24.0, "cm", "how much wider the hem is than the knee: 0 straight, above 8 flared"
    )
    crotch_ease: float = parameter(1.5, 0.5, 4.0, "cm", "how far the crotch hangs below the body")


@dataclass(frozen=True)
class WaistbandDesign:
    """A band round the waist."""

    waistband: str = choice("band", ("none", "band"), "with a waistband or without")
    waistband_depth: float = parameter(4.0, 3.0, 8.0, "cm", "height of the waistband")


@dataclass(frozen=True)
class CollarDesign:
    """A collar: a stand round the neck, lapels that go on into one behind, or more on a stand."""

    collar: str = choice("stand", ("none", "stand", "lapels", "shirt", "turtle"), "collar")
    collar_height: float = parameter(4.0, 3.0, 5.5, "cm", "height of the collar behind the neck")
    lapel_width: float = parameter(7.0, 5.0, 8.5, "cm", "how far lapels reach from the neckline")
    lapel_shape: str = choice("notched", ("notched", "shawl"), "edge of the lapels")
    fall_reach: float = parameter(
        2.0, 1.0, 3.0, "cm", "how much higher than its stand the fall of a shirt collar is"
    )
    collar_point: float = parameter(7.5, 6.0, 9.5, "cm", "front edge of the fall of a shirt collar")
    turtle_height: float = parameter(
        9.0, 7.5, 11.0, "cm", "height of a turtle neck before it is turned down"
    )


@dataclass(frozen=True)
class PocketDesign:
    """Patch pockets."""

    pockets: str = choice("both", ("none", "left", "both"), "sides with a patch pocket")
    pocket_width: float = parameter(13.0, 10.0, 16.0, "cm", "width of the pockets")
    pocket_height: float = parameter(14.0, 10.0, 18.0, "cm", "height of the pockets")
    pocket_place: float = parameter(
        0.5, 0.0, 1.0, "share", "how low the pockets lie in the room that they have"
    )


@dataclass(frozen=True)
class PeplumDesign:
    """A short skirt sewn across front and back at the waist."""

    peplum_length: float = parameter(15.0, 8.0, 25.0, "cm", "from the waist down to its hem")
    peplum_flare: float = parameter(
        0.4, 0.0, 0.9, "cm per cm", "how much wider each side gets on the way down"
    )


@dataclass(frozen=True)
class PleatDesign:
    """Pressed pleats in the waist of a skirt."""

    pleats: str = choice("knife", ("knife", "box", "inverted"), "kind of the pleats")
    pleats_a_side: int = choice(1, (1, 2), "pleats in each half of the front, and of the back")
    pleat_depth: float = parameter(4.0, 2.5, 5.0, "cm", "cloth that each pleat folds under twice")
    pleat_pressed: float = parameter(
        0.3, 0.15, 0.5, "skirt length", "how far down the pleats are pressed"
    )


@dataclass(frozen=True)
class Design:
    """Everything that can be chosen about a garment, part by part."""

    bodice: BodiceDesign
    neck: NeckDesign
    hem: HemDesign
    darts: DartDesign
    cutout: CutoutDesign
    sleeve: SleeveDesign
    cuff: CuffDesign
    hood: HoodDesign
    skirt: SkirtDesign
    trousers: TrousersDesign
    waistband: WaistbandDesign
    collar: CollarDesign
    pocket: PocketDesign
    peplum: PeplumDesign
    pleat: PleatDesign
