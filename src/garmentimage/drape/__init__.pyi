from .cloth import (
    Cloth as Cloth,
)
from .draping import (
    check_worn as check_worn,
    drape_pattern as drape_pattern,
)
from .fabric import (
    FABRICS as FABRICS,
    Fabric as Fabric,
    load_fabric as load_fabric,
)
from .fit import (
    AUTO as AUTO,
    best_fit as best_fit,
)
from .outfits import (
    outfit as outfit,
)
from .worn import (
    DrapeReport as DrapeReport,
    Worn as Worn,
)
