from .cloth import (
    Cloth as Cloth,
)
from .draped_garment import (
    DrapedGarment as DrapedGarment,
    DrapeReport as DrapeReport,
)
from .draping import (
    check_drape as check_drape,
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
