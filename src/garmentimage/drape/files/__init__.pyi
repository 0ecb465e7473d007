from .export import (
    DRAPE_FORMATS as DRAPE_FORMATS,
    drape_bytes as drape_bytes,
    save_drape as save_drape,
)
from .glb import (
    load_drape as load_drape,
)
