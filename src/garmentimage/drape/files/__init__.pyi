from .export import (
    WORN_FORMATS as WORN_FORMATS,
    save_worn as save_worn,
    worn_bytes as worn_bytes,
)
from .glb import (
    load_worn as load_worn,
)
