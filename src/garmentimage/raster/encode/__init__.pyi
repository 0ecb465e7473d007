from .encoder import (
    GRIDS as GRIDS,
    encode as encode,
)
