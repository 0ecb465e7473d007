from .bodice import (
    BelowWaist as BelowWaist,
    BodiceBlock as BodiceBlock,
    below_waist as below_waist,
    to_waist as to_waist,
    trunk as trunk,
)
from .collar import (
    add_collar as add_collar,
)
from .hood import (
    add_hood as add_hood,
)
from .peplum import (
    add_peplum as add_peplum,
)
from .pocket import (
    add_pockets as add_pockets,
)
from .skirt import (
    add_skirt as add_skirt,
)
from .sleeve import (
    add_sleeves as add_sleeves,
)
from .trousers import (
    add_trousers as add_trousers,
    legs_below_waist as legs_below_waist,
)
from .waistband import (
    add_waistband as add_waistband,
)
