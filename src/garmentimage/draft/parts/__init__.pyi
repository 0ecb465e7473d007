from .bodice import (
    BelowWaist as BelowWaist,
    BodiceBlock as BodiceBlock,
    BodiceDesign as BodiceDesign,
    CutoutDesign as CutoutDesign,
    HemDesign as HemDesign,
    NeckDesign as NeckDesign,
    below_waist as below_waist,
    to_waist as to_waist,
    trunk as trunk,
)
from .darts import (
    DartDesign as DartDesign,
)
from .hood import (
    HoodDesign as HoodDesign,
    add_hood as add_hood,
)
from .skirt import (
    SkirtDesign as SkirtDesign,
    add_skirt as add_skirt,
)
from .sleeve import (
    CuffDesign as CuffDesign,
    SleeveDesign as SleeveDesign,
    add_sleeves as add_sleeves,
)
from .trousers import (
    TrousersDesign as TrousersDesign,
    add_trousers as add_trousers,
    legs_below_waist as legs_below_waist,
)
from .waistband import (
    WaistbandDesign as WaistbandDesign,
    add_waistband as add_waistband,
)
